//! Options that take one of a few words.

use clap::ValueEnum;

use enfilade_config::{Backend, Colours, Level, Method, Mode, Overlay, Thresholds, Unsure};

macro_rules! choice {
    ($(#[$doc:meta])* $name:ident for $target:ident { $($variant:ident),+ }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, ValueEnum)]
        #[allow(missing_docs)]
        pub enum $name { $($variant),+ }
        impl From<$name> for $target {
            fn from(v: $name) -> Self {
                match v { $($name::$variant => Self::$variant),+ }
            }
        }
    };
}

choice!(
    /// See [`Level`].
    LevelArg for Level { Eye, Knee }
);
choice!(
    /// See [`Backend`].
    BackendArg for Backend { Auto, Cpu, Gpu }
);
choice!(
    /// See [`Colours`].
    ColoursArg for Colours { Safe, BlueToRed }
);
choice!(
    /// See [`Mode`].
    ModeArg for Mode { Diverse, Best }
);
choice!(
    /// See [`Method`].
    MethodArg for Method { Default, Paper }
);
choice!(
    /// See [`Thresholds`].
    ThresholdsArg for Thresholds { Firm, Yielding }
);
choice!(
    /// See [`Unsure`].
    UnsureArg for Unsure { Ask, Optimise }
);
choice!(
    /// See [`Overlay`].
    OverlayArg for Overlay { Drawn, Attach }
);
