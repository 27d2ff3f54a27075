//! DXF: bytes to a drawing, and edits to bytes.
//!
//! The file stays bytes. [`read`] groups them into code/value pairs and interprets what a plan needs;
//! [`patch`] splices changed values and our own additions into the same bytes. Whatever is not understood
//! – code pages, comments, XDATA, unknown objects, bytes after EOF – stays as it is because nobody writes
//! it again. ASCII R10 to R2018 and binary DXF; blocks are unfolded, curves that no plan can hold become
//! polylines within 5 mm.
//!
//! Records are counted as the group-0 pairs of the file from 0 ([`SourceRef::record`]); a binary file has no lines, so
//! its places are bytes.
//!
//! [`SourceRef::record`]: crate::drawing::SourceRef::record

mod additions;
mod attached;
mod blocks;
mod boundary;
mod clean;
mod clip;
mod clipped;
mod colour;
mod complete;
mod curves;
mod cut;
mod cut_multiline;
mod entity;
mod fields;
mod fill;
mod ground;
mod header;
mod heights;
mod hidden;
mod limits;
mod links;
mod multiline;
mod opened;
mod patch;
mod poche;
mod read;
mod reader;
mod refill;
mod rooms;
mod sheet;
mod showing;
mod storeys;
mod strip;
mod text;
mod tokens;
mod uncut;
mod viewports;
mod written;

pub use attached::sheet;
pub use clean::without_demolished;
pub use complete::{Completeness, is_complete};
pub use limits::*;
pub use links::{Tied, host_ids, tied};
pub use patch::{ChangedRecord, changed_records, patch, patch_read};
pub use poche::Following;
pub use read::{read, storeys};
pub use refill::{Probe, fills_at};
pub use strip::strip_own;

pub(super) use header::release_of;
pub(super) use tokens::BINARY_SENTINEL;

use crate::drawing::Unit;
use crate::ifc::Sight;

/// How to read a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Takes files of programs that never write `0/EOF`; off, because a cut file looks the same.
    pub accept_missing_eof: bool,
    /// The unit the user stated, if any; only limits and tolerances use it, coordinates stay as drawn.
    pub unit: Option<Unit>,
    /// The unit in which heights are taken, where the user stated one.
    pub unit_of_heights: Option<Unit>,
    /// The storey to read where several are drawn over one another at heights of their own, by its name or number; `None`:
    /// the one with most walls.
    pub storey: Option<String>,
    /// Height at which the walls are cut, where they are drawn with one.
    pub sight: Sight,
    /// Limits, named one by one in [`Limits`].
    pub limits: Limits,
}
