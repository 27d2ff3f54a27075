//! What messages call the walls of a plan.

use enfilade_cad::drawing::{Format, SourceRef, place_in};
use enfilade_cad::plane::box_of;
use enfilade_plan::{Plan, Wall};
use enfilade_report::Place;

/// Where a wall stands in its file; of walls that one node of a scene shows, also where it is drawn.
pub(crate) fn place(file: &str, plan: &Plan, wall: &Wall) -> Place {
    let handle = wall.source.handle.as_ref().map(|node| format!("{node}{}", standing(plan, wall)));
    place_in(file, &SourceRef { handle, ..wall.source.clone() })
}

/// The wall of a record as a message names it: by the number of its instance in an IFC, by node and name in a scene.
pub(crate) fn words(plan: &Plan, record: usize) -> String {
    let wall = plan.walls.iter().find(|w| w.source.record == record);
    match wall.map(|wall| (wall, wall.source.handle.as_deref())) {
        Some((wall, Some(node))) if matches!(plan.format, Format::Gltf | Format::Glb) => {
            format!("the wall {}{}", format!("{node} {}", wall.source.kind).trim_end(), standing(plan, wall))
        }
        _ => format!("the wall #{record}"),
    }
}

/// A wall in a sentence about another of the same file: its kind and handle in a drawing, else as [`words`] has it.
pub(crate) fn short(plan: &Plan, wall: &Wall) -> String {
    match (&wall.source.handle, plan.format) {
        (Some(handle), Format::Dxf) => format!("{} {handle}", wall.source.kind),
        (None, Format::Dxf) => format!("{} in line {}", wall.source.kind, wall.source.line),
        _ => words(plan, wall.source.record),
    }
}

/// Of a wall that shares its node with others: the middle of what it shows, in the drawing's own coordinates.
fn standing(plan: &Plan, wall: &Wall) -> String {
    let own = &wall.source;
    let shares = |w: &Wall| w.source.handle == own.handle && w.source.record != own.record;
    if own.handle.is_none() || !plan.walls.iter().any(shares) {
        return String::new();
    }
    let points = plan.walls.iter().filter(|w| w.source.record == own.record).flat_map(|w| &w.trace.points);
    let Some([lo, hi]) = box_of(points.map(|p| plan.frame.file_from_um(*p))) else { return String::new() };
    let [x, y] = lo.midpoint(hi).to_array().map(|v| (v * 100.0).round() / 100.0 + 0.0);
    format!(" at {x}, {y}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_cad::ReadOptions;
    use enfilade_plan::{PlanOptions, understand};
    use enfilade_report::Report;

    /// Two walls of one node and one of another, drawn as lines; `format`: of which format they are then said to be.
    fn plan(format: Format) -> Plan {
        let line = |y: f64| format!("0\nLINE\n8\nWALL\n10\n0\n20\n{y}\n11\n12\n21\n{y}\n");
        let lines: String = [0.0, 4.0, 9.0].map(line).concat();
        let text = format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n");
        let mut report = Report::default();
        let drawing =
            enfilade_cad::read("a.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        let options = PlanOptions { unit: enfilade_cad::units::unit_by_name("m"), ..PlanOptions::default() };
        let mut plan = understand(&drawing, &options, &mut report).unwrap();
        plan.format = format;
        let told = [(1, "/nodes/1", "Walls"), (1 + (11 << 32), "/nodes/1", "Walls"), (8, "/nodes/8", "")];
        for (wall, (record, node, kind)) in plan.walls.iter_mut().zip(told) {
            let layer = wall.source.layer.clone();
            wall.source = SourceRef { record, handle: Some(node.into()), line: 0, kind: kind.into(), layer };
        }
        plan
    }

    /// A number within the program says nothing to whoever drew the scene.
    #[test]
    fn walls_of_a_scene_are_nodes_with_names_and_places() {
        let scene = plan(Format::Glb);
        assert_eq!(words(&scene, 1), "the wall /nodes/1 Walls at 6, 0");
        assert_eq!(words(&scene, 1 + (11 << 32)), "the wall /nodes/1 Walls at 6, 4");
        assert_eq!(words(&scene, 8), "the wall /nodes/8");
        let places: Vec<String> = scene.walls.iter().map(|w| place("a.glb", &scene, w).to_string()).collect();
        assert!(places[1].ends_with("Walls /nodes/1 at 6, 4 layer WALL"), "{places:?}");
        assert!(places[2].ends_with("/nodes/8 layer WALL"), "{places:?}");
        assert_eq!(words(&plan(Format::Ifc), 8), "the wall #8");
    }
}
