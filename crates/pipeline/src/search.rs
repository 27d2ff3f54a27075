//! What the search works with, and what layouts are worth to it.

pub(crate) mod budget;
pub(crate) mod judged;
pub(crate) mod memory;
pub(crate) mod rules;
