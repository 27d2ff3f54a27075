//! Settings that are one of a few words.

use serde::{Deserialize, Serialize};

/// What happens where the thresholds leave no room for options that differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Thresholds {
    /// They stand as they were stated; the options may be alike, and the report says so.
    Firm,
    /// They are lowered together, step by step, until the options stand `distance` apart.
    Yielding,
}

/// What a round does with a drawing of which something should be asked first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unsure {
    /// The present layout is measured and the questions are shown; no option is made.
    #[default]
    Ask,
    /// The reading is taken as it is.
    Optimise,
}
