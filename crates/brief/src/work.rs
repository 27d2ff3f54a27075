//! Kinds of building works.

/// What a work does (`docs/works.md`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum WorkKind {
    /// An opening without a leaf is made in a wall.
    Open,
    /// An opening with a leaf is made.
    Door,
    /// An opening or a door grows to one side.
    Widen,
    /// A door or an opening is walled up.
    Close,
    /// One door is walled up, another is made: the same room stays reached.
    Rehang,
    /// A wall's free end goes back.
    End,
    /// A whole partition goes, between its joints, with its doors.
    Remove,
    /// A stretch becomes glass: sight and no way.
    Glaze,
    /// A partition is built between two walls.
    Add,
}

impl WorkKind {
    /// All, in the order of the documents.
    pub const ALL: [Self; 9] = [
        Self::Open,
        Self::Door,
        Self::Widen,
        Self::Close,
        Self::Rehang,
        Self::End,
        Self::Remove,
        Self::Glaze,
        Self::Add,
    ];

    /// As written in marks and JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Door => "door",
            Self::Widen => "widen",
            Self::Close => "close",
            Self::Rehang => "rehang",
            Self::End => "end",
            Self::Remove => "remove",
            Self::Glaze => "glaze",
            Self::Add => "add",
        }
    }

    /// The kind of a name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|k| k.name() == name)
    }
}
