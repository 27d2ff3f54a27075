//! What is too much for an IFC file, each with its reason.

use super::instance::Fault;

/// Parentheses inside one instance: the schemas nest four deep, a file of parentheses alone would fill the stack.
pub const NESTING_MAX: usize = 48;

/// Placements from a product to the world: buildings have five or six.
pub const PLACEMENT_CHAIN_MAX: usize = 1_000;

/// Mapped items and boolean operands inside each other.
pub const BODY_DEPTH_MAX: usize = 200;

/// Mapped items and boolean operands of one shape, each counted as often as it is shown: a shape that shows everything
/// twice at each of a few levels would never end.
pub const BODY_ITEMS_MAX: u64 = 10_000;

/// Corners of one cut, so that a sculpture does not stand in for a wall.
pub const OUTLINE_POINTS_MAX: usize = 20_000;

/// Faces of one body looked at.
pub const FACES_MAX: usize = 400_000;

/// Bytes of an `.ifczip` when unpacked.
pub const UNZIPPED_MAX: u64 = 2 << 30;

/// Unpacked bytes per packed byte: STEP text packs to a tenth, a bomb to a thousandth.
pub const ZIP_RATIO_MAX: u64 = 200;

/// Bytes of an instance's text: face sets of large sites have megabytes, nothing has more.
pub const INSTANCE_BYTES_MAX: usize = 64 << 20;

/// Largest number of an instance: there must be room for those that are added.
pub const INSTANCE_MAX: u64 = u64::MAX / 4 - 1;

/// What is said of a larger one.
pub(super) const LARGE_ID: &str = "a number after `#` of 19 digits or more, expected at most 4611686018427387902; export the file with smaller numbers";

/// Most instances taken: each takes a hundred bytes, and the largest building seen has a tenth of them.
const INSTANCES_MAX: usize = 20_000_000;

/// Whether so many instances are taken, at a byte.
pub(super) fn within(count: usize, at: usize) -> Result<(), Fault> {
    if count <= INSTANCES_MAX {
        return Ok(());
    }
    let text = format!("found more than {INSTANCES_MAX} instances, expected at most so many (INSTANCES_MAX)");
    Err(Fault { at, text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_instances_are_refused_by_the_name_of_the_limit() {
        assert_eq!(within(INSTANCES_MAX, 0), Ok(()));
        assert!(within(INSTANCES_MAX + 1, 7).unwrap_err().text.contains("INSTANCES_MAX"));
    }
}
