//! What we add to a building.

use super::ReadOptions;
use super::read::Building;
use crate::plan::drawing::{Addition, Edit};
use crate::report::Error;

/// The instances of our additions, numbered from `next`.
pub(super) fn text(
    _building: &Building<'_, '_>,
    _options: &ReadOptions,
    _next: u64,
    _edits: &[Edit],
    _own: &[Addition],
) -> Result<Vec<u8>, Error> {
    Ok(Vec::new())
}
