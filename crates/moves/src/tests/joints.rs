//! Joints of a building: who holds whom, who is carried, and which open.

use super::*;
use crate::joined::Stuck;
use crate::opened::{Joints, Opened};
use crate::say_stuck;
use enfilade_plan::OPENING_LAYER;
use enfilade_report::Severity;

/// A partition at x = 8 between two walls, and a wall that stands at its east side at y = 5.
fn beside(has_opening: bool) -> Drawing {
    let mut d = building(&[(1, [8.0, 8.2], [0.0, 10.0]), (2, [9.4, 12.0], [5.0, 5.2])]);
    d.entities.last_mut().unwrap().editable =
        Editable::Wall { ends: [vec![], vec![1, 2]], free: [f64::INFINITY; 2] };
    if has_opening {
        d.ring(OPENING_LAYER, &[[8.2, 5.0], [9.4, 5.0], [9.4, 5.2], [8.2, 5.2]]);
        d.entities.last_mut().unwrap().source.record = 2;
    }
    d
}

/// What stands at a partition with an opening in its end cannot follow: the partition stays, on both sides.
#[test]
fn an_opening_at_a_joint_holds_a_partition() {
    for (has_opening, slides) in [(true, false), (false, true)] {
        let (plan, _, moves) = by_default(&beside(has_opening));
        assert_eq!(plan.plugs.len(), usize::from(has_opening));
        assert_eq!(bounds_of(&plan, &moves, 1).is_some_and(|b| b[0] < 0.0), slides, "{has_opening}");
    }
}

/// A wall in two pieces, and in the opening between them another that the file relates to nothing.
#[test]
fn what_merely_shares_corners_with_a_named_wall_is_not_carried() {
    let d = building(&[
        (1, [3.0, 5.0], [4.0, 4.2]),
        (1, [7.0, 15.0], [4.0, 4.2]),
        (2, [5.0, 7.0], [4.0, 4.2]),
        (3, [15.0, 17.0], [4.0, 4.2]),
    ]);
    let (mut plan, graph, named, _) = moved_by(&d, 1, &[(Kind::X, 0.0, 0.9)]);
    plan.format = Format::Ifc;
    let marker = Group {
        name: "partition".into(),
        outline: enfilade_engine::Region::Ring(Vec::new()),
        clauses: named.parameters.iter().map(|p| p.clause.clone()).collect(),
        source: source(1, "WALLS"),
    };
    let groups = [(marker, named.groups[0].nodes.clone())];
    let (axes, _) = structure::axes(&plan, &d);
    let at = |records: &[Option<BTreeSet<usize>>], record: usize| {
        let moves = Moves::of_records(&plan, &graph, &axes, (&groups, records), &mut Report::default());
        box_of_record(&plan, &moves.apply(&plan, &graph, &[0.9]), record)
    };
    let own = [Some(BTreeSet::from([1]))];
    assert_near(at(&own, 1), [3.9, 15.9, 4.0, 4.2]);
    assert_near(at(&own, 2), [5.0, 7.0, 4.0, 4.2]);
    // The end of a wall beyond follows: its joint holds.
    assert_near(at(&own, 3), [15.9, 17.0, 4.0, 4.2]);
    assert_near(at(&[], 2), [5.9, 7.9, 4.0, 4.2]);
}

#[test]
fn joints_that_open_are_found_and_no_others() {
    let mut d = joined();
    let of = |d: &Drawing, format: Format, by: f64| {
        let (mut plan, graph, moves, _) = moved_by(d, 1, &[(Kind::X, -1.0, 1.0)]);
        plan.format = format;
        Joints::new(&plan, &moves).opened(&plan, &moves.apply(&plan, &graph, &[by]))
    };
    assert_eq!(of(&d, Format::Ifc, 0.75), [], "both follow");
    for e in d.entities.iter_mut().filter(|e| e.source.record > 1) {
        e.editable = Editable::WithInsert { turnable: true };
    }
    let found = of(&d, Format::Ifc, 0.75);
    let meant = [
        Opened { record: 1, other: 2, by_m: 0.75, is_through: false },
        Opened { record: 1, other: 3, by_m: 0.55, is_through: true },
    ];
    assert_eq!(found.len(), 2, "{found:?}");
    for (f, m) in found.iter().zip(meant) {
        assert!((f.by_m - m.by_m).abs() < 1e-6, "{found:?}");
        assert_eq!(Opened { by_m: m.by_m, ..*f }, m);
    }
    // An end within the wall that shifts is still joined; a hand's breadth of air is not.
    assert_eq!(of(&d, Format::Ifc, 0.0), []);
    assert_eq!(of(&d, Format::Ifc, 0.019).len(), 0);
    assert_eq!(of(&d, Format::Ifc, 0.03).len(), 1);
    assert_eq!(of(&d, Format::Dxf, 0.75).len(), 2, "lines of a drawing meet as well");
}

/// A wall that keeps its length beside one that slides is a note; beside one that turns, its joint breaks.
#[test]
fn what_does_not_follow_is_told_as_it_is() {
    let (mut plan, ..) = moved_by(&joined(), 1, &[(Kind::X, -1.0, 1.0)]);
    let mut said = |format: Format, turns: bool| {
        plan.format = format;
        let mut report = Report::default();
        say_stuck(
            &plan,
            &Stuck { wall: 0, turns, may: if turns { "turn" } else { "shift" }, why: "it cannot".into() },
            &mut report,
        );
        let p = report.problems.remove(0);
        (p.severity, p.text.contains("may turn"), p.text.contains("may shift"))
    };
    assert_eq!(said(Format::Ifc, false), (Severity::Info, false, true));
    assert_eq!(said(Format::Ifc, true), (Severity::Warning, true, false));
    assert_eq!(said(Format::Dxf, false), (Severity::Warning, false, true));
}
