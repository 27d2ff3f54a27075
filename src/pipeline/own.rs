//! Drawings that come back with our result layers: a candidate used as the new plan.

use std::borrow::Cow;

use super::Input;
use crate::formats::dxf;
use crate::report::Error;

/// The drawing without our result layers; its markers stay.
///
/// # Errors
/// What [`dxf::strip_own`] returns.
pub(super) fn without<'a>(input: &Input<'a>) -> Result<Cow<'a, [u8]>, Error> {
    dxf::strip_own(input.file(), input.bytes)
}
