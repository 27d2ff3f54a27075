//! When an element of a building stands: a conversion keeps, builds and demolishes.

/// When an element stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Today and after the works; what says nothing.
    #[default]
    Existing,
    /// After the works.
    New,
    /// Until the works.
    Demolished,
    /// While the works last: neither today nor after them.
    Temporary,
}
