//! What the values of two rounds must have in common to be compared: the cells that they are means over.

use sha2::{Digest, Sha256};

use crate::plan::Region;
use crate::plan::markers::Markers;

/// A mark of the spacing and of the regions drawn: other marks, other means. What is measured where no region is drawn,
/// the interior, follows the walls and is no part of it.
pub(super) fn ruler(markers: &Markers, spacing_m: f64) -> String {
    let mut hash = Sha256::new();
    hash.update(spacing_m.to_le_bytes());
    let mut add = |what: &str, regions: &[Region]| {
        hash.update(what.as_bytes());
        for region in regions {
            hash.update([0]);
            region.outline().iter().flatten().for_each(|v| hash.update(v.to_le_bytes()));
        }
        hash.update([1]);
    };
    add("query", &markers.query);
    add("reference", &markers.reference);
    for pair in &markers.pairs {
        add(&pair.name, &pair.query);
        add(&pair.name, &pair.reference);
    }
    hash.finalize()[..8].iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spacing_and_regions_make_the_ruler() {
        let region = |x: i64| Region::Ring(vec![[x, 0], [x + 10, 0], [x, 10]]);
        let of = |query: Vec<Region>, reference: Vec<Region>, spacing: f64| {
            ruler(&Markers { query, reference, ..Markers::default() }, spacing)
        };
        let first = of(vec![region(0)], vec![], 0.5);
        assert_eq!(first, of(vec![region(0)], vec![], 0.5));
        for other in [
            of(vec![region(0)], vec![], 0.4),
            of(vec![region(1)], vec![], 0.5),
            of(vec![], vec![region(0)], 0.5),
            of(vec![region(0), region(5)], vec![], 0.5),
            of(vec![], vec![], 0.5),
        ] {
            assert_ne!(first, other);
        }
    }
}
