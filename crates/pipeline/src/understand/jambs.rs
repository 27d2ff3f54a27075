//! Moves end before a door becomes narrower: those of marks at its jambs, with a warning; default moves wherever it would.

use enfilade_cad::drawing::place_in;
use enfilade_moves::jambs::Shortened;
use enfilade_moves::{Marked, Moves, Parameter};
use enfilade_plan::Plan;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::Group;
use enfilade_report::{Place, Report, counted};

/// Names that are told one by one.
const TOLD: usize = 6;

/// The moves of marks with their ways ending at the jambs of doors, each that ends earlier told at its mark.
pub(crate) fn ending_at_jambs<'a>(
    mut moves: Moves,
    groups: impl Iterator<Item = &'a Group> + Clone,
    (plan, graph, axes): (&Plan, &Graph, &AxisGraph),
    report: &mut Report,
) -> Moves {
    for shorter in moves.keep_doors_wide(plan, graph, axes) {
        let p = &moves.parameters[shorter.parameter];
        let group = groups.clone().find(|g| g.name == p.group_name);
        let place = group.map_or_else(|| Place::file(&plan.file), |g| place_in(&plan.file, &g.source));
        report.warn("move-shortened", place, jamb_words(p, &shorter));
    }
    moves
}

/// What a way is shortened to, and by which door.
fn jamb_words(p: &Parameter, shorter: &Shortened) -> String {
    format!(
        "group {:?}: `{}` would take a wall past a jamb of {}, {:.2} m wide, and leave it narrower; it moves by `{}` alone; \
         an outline that takes the door's jambs in too moves the door along, `--allow narrow-ways` takes it on",
        p.group_name,
        shorter.stated,
        shorter.door.place_words(),
        shorter.door.was_m,
        p.clause
    )
}

/// The default groups with their ways ending before any door becomes narrower; those with no way left stay. One line says
/// which.
pub(crate) fn keeping_doors(
    drawn: Vec<Marked>,
    (plan, graph, axes): (&Plan, &Graph, &AxisGraph),
    report: &mut Report,
) -> Vec<Marked> {
    let mut groups = drawn.clone();
    loop {
        let mut moves = Moves::new(plan, graph, axes, &groups, &mut Report::default());
        let kept = moves.keep_doors_as_drawn(plan, graph, axes);
        for i in &kept.shorter {
            let p = &moves.parameters[*i];
            let is_out = kept.without_way.contains(i);
            for (group, _) in groups.iter_mut().filter(|g| g.0.name == p.group_name) {
                group.clauses.retain(|c| !is_out || c.kind != p.clause.kind);
                let own = group.clauses.iter_mut().filter(|c| c.kind == p.clause.kind);
                own.for_each(|c| *c = p.clause.clone());
            }
        }
        groups.retain(|g| !g.0.clauses.is_empty());
        // Without what stays, other joints follow.
        if kept.without_way.is_empty() {
            break;
        }
    }
    say_kept(&drawn, &groups, plan, report);
    groups
}

/// Says in one line which default moves go less far, and which stay.
fn say_kept(drawn: &[Marked], groups: &[Marked], plan: &Plan, report: &mut Report) {
    let now = |g: &Group| groups.iter().find(|other| other.0.name == g.name).map(|other| &other.0.clauses);
    let named = |is_such: &dyn Fn(&Group) -> bool| {
        let names: Vec<&str> = drawn.iter().filter(|g| is_such(&g.0)).map(|g| g.0.name.as_str()).collect();
        let more = if names.len() > TOLD { ", …" } else { "" };
        (names.len(), format!("{}{more}", names[..names.len().min(TOLD)].join(", ")))
    };
    let (shorter, names_shorter) = named(&|g| now(g).is_some_and(|c| *c != g.clauses));
    let (stay, names_stay) = named(&|g| now(g).is_none());
    let verb = |n: usize, one: &'static str, more: &'static str| if n == 1 { one } else { more };
    let moves = |n: usize| counted(n as u64, "default move");
    let end = verb(shorter, "ends", "end");
    let remain = verb(stay, "stays", "stay");
    let told = match [shorter, stay] {
        [0, 0] => return,
        [_, 0] => format!("{} {end} earlier ({names_shorter})", moves(shorter)),
        [0, _] => format!("{} {remain} ({names_stay})", moves(stay)),
        _ => format!("{} {end} earlier ({names_shorter}), {stay} {remain} ({names_stay})", moves(shorter)),
    };
    let text = format!("{told}, so that no door and no window becomes narrower than it is drawn");
    report.info("default-moves-doors", Place::file(&plan.file), text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;
    use crate::understand::understood;
    use enfilade_config::{Partial, Settings};
    use enfilade_moves::narrowed::Doors;

    /// Places between the bounds that are tried beside the bounds of any two.
    const TRIED: u64 = 100;

    /// Doors of real drawings stay as wide as they are drawn, with any two default moves at their bounds and with all of them
    /// anywhere; what narrows nothing moves on.
    #[test]
    fn default_moves_leave_no_door_narrower() {
        let Some(data) = enfilade_fixtures::shared("data") else { return };
        let drawings = [
            ("dxf/ensal.dxf", 12, ""),
            ("ifc/ac11_institute_var2.ifc", 0, ""),
            ("ifc/duplex_a.ifc", 9, "end earlier (door-2, door-"),
            ("ifc/archilogic_fl39.ifc", 12, "1 default move ends earlier (wall-7), 1 stays (door-2), so"),
            ("dxf/gama_house_librecad.dxf", 6, ""),
        ];
        for (name, parameters, says) in drawings {
            let bytes = std::fs::read(data.join(name)).unwrap();
            let settings = Settings::new(Partial::default()).unwrap();
            let mut report = Report::default();
            let base = understood(
                &read::drawing(name, &bytes, &settings, &mut report).unwrap(),
                &settings,
                &mut report,
            )
            .unwrap();
            let told: Vec<&str> = report
                .problems
                .iter()
                .filter(|p| p.code == "default-moves-doors")
                .map(|p| p.text.as_str())
                .collect();
            assert!(told.concat().contains(says) && told.is_empty() == says.is_empty(), "{name}: {told:?}");
            assert_eq!(base.moves.parameters.len(), parameters, "{name}");
            let said =
                report.problems.iter().find(|p| p.code == "default-moves").map_or("", |p| p.text.as_str());
            let stay = ["fl39", "gama"].iter().any(|n| name.contains(n));
            assert_eq!(said.contains("left: "), stay, "{name}: {said}");
            let doors = Doors::and_windows(&base.plan, &base.axes);
            for at in places(&base.moves) {
                let found = doors.narrowed(&base.moves.apply(&base.plan, &base.graph, &at));
                assert_eq!(found, [], "{name} {at:?}");
            }
        }
    }

    fn places(moves: &Moves) -> Vec<Vec<f64>> {
        let (bounds, identity) = (moves.bounds(), moves.identity());
        let at = |set: [(usize, usize); 2]| {
            let mut p = identity.clone();
            set.iter().for_each(|(i, end)| p[*i] = bounds[*i][*end]);
            p
        };
        let ends = || (0..bounds.len()).flat_map(|i| [(i, 0), (i, 1)]);
        let pairs = ends().flat_map(|a| ends().filter(move |b| a.0 <= b.0).map(move |b| at([a, b])));
        let anywhere = (0..TRIED).map(|k| {
            let share = |i: usize| ((k * 7919 + i as u64 * 104_729) % 1009) as f64 / 1008.0;
            bounds.iter().enumerate().map(|(i, [lo, hi])| lo + share(i) * (hi - lo)).collect()
        });
        pairs.chain(anywhere).collect()
    }
}
