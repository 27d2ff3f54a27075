//! What shows itself again and again.

use super::*;

/// A body that shows everything twice at each of thirty levels would never be cut.
#[test]
fn bodies_that_double_at_every_level_are_left_out() {
    let text = pavilion();
    let whole = read(text.as_bytes()).entities.len();
    let solid = text.lines().find(|l| l.contains("=IFCEXTRUDEDAREASOLID(")).unwrap();
    let solid: u64 = solid[1..].split('=').next().unwrap().parse().unwrap();
    let shown = format!(",(#{solid}));");
    assert_eq!(text.matches(&shown).count(), 1);
    for (levels, is_shown) in [(3, true), (30, false)] {
        assert_eq!(1 << levels <= ifc::BODY_ITEMS_MAX, is_shown);
        let of = |k: u64| if k == 0 { solid } else { 90_000 + k };
        let booleans: String = (0..levels)
            .map(|k| format!("#{}=IFCBOOLEANRESULT(.UNION.,#{},#{});\n", of(k + 1), of(k), of(k)))
            .collect();
        let changed = text.replace(&shown, &format!(",(#{}));", of(levels)));
        let (drawing, report) =
            read_with(with_instances(&changed, &booleans).as_bytes(), &ReadOptions::default());
        let said = report.problems.iter().any(|p| p.text.contains("items, those that are shown again"));
        assert_eq!((drawing.unwrap().entities.len() == whole, said), (is_shown, !is_shown), "{levels}");
    }
}

#[test]
fn a_ring_of_placements_above_the_storey_is_told_as_such() {
    let text = pavilion().replace("#12=IFCLOCALPLACEMENT($,#11);", "#12=IFCLOCALPLACEMENT(#17,#11);");
    let settings = Settings::new(Partial::default()).unwrap();
    let error =
        enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &settings).unwrap_err();
    assert_eq!(error.problem().map(|p| p.code), Some("no-walls"), "{error}");
    let said = error.to_string();
    assert!(said.contains("placements are relative to each other in a ring: #17>#12>#17"), "{said}");
    assert!(said.contains("more elements cannot be read either"), "{said}");
}
