//! What the values of two rounds must have in common to be compared: the cells that they are means over.

use sha2::{Digest, Sha256};

use enfilade_config::Settings;
use enfilade_engine::Region;
use enfilade_plan::Plan;
use enfilade_plan::markers::Markers;

/// A mark of the unit, of the lattice, of the height of sight, of the drawing on the sheet and the storey asked for, and of the
/// regions drawn or flooded: other marks, other means. What is measured where no region is drawn, the interior, follows the
/// walls and is no part of it.
pub(crate) fn ruler(plan: &Plan, settings: &Settings, spacing_m: f64) -> String {
    mark(&plan.markers, plan.unit.unit.metres, settings, spacing_m)
}

fn mark(markers: &Markers, metres: f64, settings: &Settings, spacing_m: f64) -> String {
    let mut hash = Sha256::new();
    hash.update(spacing_m.to_le_bytes());
    hash.update(metres.to_le_bytes());
    hash.update(format!("{:?}", (settings.level, &settings.view, &settings.storey, &settings.query)));
    hash.update(format!("{:?}", (settings.lattice_centre_m, &settings.seed_points)));
    let reading = &settings.reading;
    if reading.as_drawn == Some(true) || !reading.inside.is_empty() || !reading.outside.is_empty() {
        hash.update(format!("{:?}", (reading.as_drawn, &reading.inside, &reading.outside)));
    }
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
    use enfilade_config::{Level, Partial};

    #[test]
    fn spacing_and_regions_make_the_ruler() {
        let region = |x: i64| Region::Ring(vec![[x, 0], [x + 10, 0], [x, 10]]);
        let of = |query: Vec<Region>, reference: Vec<Region>, spacing: f64| {
            let settings = Settings::new(Partial::default()).unwrap();
            mark(&Markers { query, reference, ..Markers::default() }, 1.0, &settings, spacing)
        };
        let of_unit = |metres, said| mark(&Markers::default(), metres, &Settings::new(said).unwrap(), 0.5);
        let asked = |said: Partial| of_unit(1.0, said);
        let plain = asked(Partial::default());
        assert_ne!(plain, asked(Partial { level: Some(Level::Knee), ..Partial::default() }));
        assert_ne!(plain, asked(Partial { view: Some("3".into()), ..Partial::default() }));
        assert_ne!(plain, asked(Partial { storey: Some("Upper".into()), ..Partial::default() }));
        assert_ne!(plain, asked(Partial { lattice_centre: Some([0.5, 0.5]), ..Partial::default() }));
        assert_ne!(plain, asked(Partial { seed_point: Some(vec![[0.5, 0.5]]), ..Partial::default() }));
        assert_ne!(plain, of_unit(0.3048, Partial::default()));
        assert_eq!(plain, asked(Partial { seed: Some(7), ..Partial::default() }));
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
