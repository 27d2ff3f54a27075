//! What was found, measured again on other lattices and explained.

pub(crate) mod confirmed;
pub(crate) mod elsewhere;
pub(crate) mod explain;
pub(crate) mod found;
pub(crate) mod ideas;
pub(crate) mod refined;
pub(crate) mod sound;
pub(crate) mod stripped;
pub(crate) mod withheld;
