//! Building works in a drawing: what is cut, what goes, what is drawn anew, in every version and in binary too.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use crate::dxf_patch::{ascii, distance, pairs, variants};
use crate::support::{moved_shape, read_whole};
use enfilade_cad::drawing::{
    Addition, Drawing, Edit, Entity, EntityWork, Filling, Mark, RigidMotion, Shape, Vertex,
};
use enfilade_cad::dxf::{Completeness, Probe, fills_at, is_complete, patch};
use enfilade_cad::own_layers::DEMOLISHED;
use glam::DVec2;

fn at(x: f64, y: f64) -> DVec2 {
    DVec2::new(x, y)
}

fn open(points: &[DVec2]) -> Shape {
    let vertices = points.iter().map(|at| Vertex { at: *at, bulge: 0.0 }).collect();
    Shape::Polyline { vertices, closed: false }
}

fn quad(a: DVec2, b: DVec2) -> [DVec2; 4] {
    [a, at(b.x, a.y), b, at(a.x, b.y)]
}

fn work(record: usize, work: EntityWork) -> Edit {
    Edit::Work { record, work }
}

fn void(record: usize, gone: [DVec2; 4]) -> Edit {
    work(record, EntityWork::Void { gone, filling: Filling::Gone })
}

/// Cuts, drops and builds of one drawing, by the kind and place of its entities.
fn edits(drawing: &Drawing) -> Vec<Edit> {
    let record =
        |is: &dyn Fn(&Entity) -> bool| drawing.entities.iter().find(|e| is(e)).unwrap().source.record;
    let line = record(&|e| e.source.kind == "LINE" && e.layer == "WALL");
    let lightweight = record(&|e| e.source.kind == "LWPOLYLINE");
    let old = record(&|e| e.source.kind == "POLYLINE");
    let arc = record(&|e| e.source.kind == "ARC");
    let two = vec![
        Shape::Line { a: at(1.5, -2.0), b: at(2.0, -1.6) },
        Shape::Line { a: at(3.0, -0.9), b: at(4.25, 0.1) },
    ];
    let chains = vec![open(&[at(0.0, 0.0), at(3.0, 0.0)]), open(&[at(3.0, 1.5), at(3.0, 2.0), at(0.0, 0.0)])];
    let halves = vec![open(&[at(5.0, 5.0), at(5.25, 5.0)]), open(&[at(5.75, 5.0), at(6.0, 5.0)])];
    vec![
        work(line, EntityWork::Cut { parts: two }),
        work(lightweight, EntityWork::Cut { parts: chains }),
        work(old, EntityWork::Cut { parts: halves }),
        work(arc, EntityWork::Drop),
        work(line, EntityWork::Build { shapes: vec![Shape::Line { a: at(2.0, -1.6), b: at(2.1, -1.5) }] }),
    ]
}

/// What goes gets a layer; with it comes one addition, as every work has.
fn outline() -> Addition {
    let points = quad(at(2.0, -2.0), at(3.0, 1.0)).to_vec();
    Addition { layer: DEMOLISHED.into(), rgb: [242, 181, 0], mark: Mark::Path { points, closed: true } }
}

#[test]
fn what_stays_is_as_it_was_and_what_is_new_is_alike() {
    for (name, bytes) in variants() {
        let (before, _) = read_whole(&name, &bytes);
        let edits = edits(&before);
        let written = patch(&name, &bytes, &edits, &[outline()]).unwrap();
        assert_eq!(is_complete(&written), Completeness::Whole, "{name}");
        let (after, report) = read_whole(&name, &written);
        assert!(!report.is_degraded(), "{name}: {:?}", report.problems);
        let shapes = |d: &Drawing, layer: &str| -> Vec<Shape> {
            d.entities.iter().filter(|e| e.layer == layer).map(|e| e.shape.clone()).collect()
        };
        for edit in &edits {
            let wanted: &[Shape] = match edit {
                Edit::Work { work: EntityWork::Cut { parts }, .. } => parts,
                Edit::Work { work: EntityWork::Build { shapes }, .. } => shapes,
                _ => continue,
            };
            for shape in wanted {
                assert!(shapes(&after, "WALL").contains(shape), "{name}: {shape:?}");
            }
        }
        // Three lines more on the walls' layer, and the new one; one door less, which lies with what went.
        assert_eq!(shapes(&after, "WALL").len(), shapes(&before, "WALL").len() + 4, "{name}");
        assert_eq!(shapes(&after, "DOOR").len() + 1, shapes(&before, "DOOR").len(), "{name}");
        assert_eq!(shapes(&after, DEMOLISHED).len(), 2, "{name}");
        let changed: Vec<usize> = edits.iter().map(Edit::record).collect();
        for e in before.entities.iter().filter(|e| !changed.contains(&e.source.record)) {
            let same =
                |a: &&Entity| a.source.handle == e.source.handle && a.shape == e.shape && a.layer == e.layer;
            assert!(after.entities.iter().any(|a| same(&a)), "{name}: {:?}", e.source);
        }
        let handles: Vec<_> = after.entities.iter().filter_map(|e| e.source.handle.clone()).collect();
        let mut once = handles.clone();
        once.sort();
        once.dedup();
        // A block's lines are shown more than once.
        assert!(once.len() + 3 >= handles.len(), "{name}");
    }
}

#[test]
fn what_fills_a_wall_ends_at_its_opening_and_a_floor_does_not() {
    let hatch = |handle: &str, ring: [[f64; 2]; 4]| {
        let points: String = ring.iter().map(|[x, y]| format!("|10|{x:.1}|20|{y:.1}")).collect();
        format!(
            "0|HATCH|5|{handle}|100|AcDbEntity|8|POCHE|100|AcDbHatch|10|0.0|20|0.0|30|0.0|210|0.0|220|0.0|230|1.0\
             |2|SOLID|70|1|71|0|91|1|92|3|72|0|73|1|93|4{points}|97|0|75|0|76|1|98|0|"
        )
    };
    let wall = hatch("B1", [[0.0, 0.0], [5.0, 0.0], [5.0, 0.2], [0.0, 0.2]]);
    let floor = hatch("B2", [[-1.0, -3.0], [6.0, -3.0], [6.0, 3.0], [-1.0, 3.0]]);
    let solid = "0|SOLID|5|B3|100|AcDbEntity|8|POCHE|100|AcDbTrace|10|0.0|20|0.0|30|0.0|11|5.0|21|0.0|31|0.0|12|0.0|22|0.2|32|0.0|13|5.0|23|0.2|33|0.0|";
    let head = "0|SECTION|2|HEADER|9|$ACADVER|1|AC1015|9|$INSUNITS|70|6|9|$HANDSEED|5|C0|0|ENDSEC|0|SECTION|2|ENTITIES|";
    let bytes = ascii(&pairs(&format!("{head}{wall}{floor}{solid}0|ENDSEC|0|EOF")), "\n");
    let probe = Probe { inside: at(2.5, 0.1), beside: [at(2.5, -0.15), at(2.5, 0.35)] };
    let found = fills_at("plan.dxf", &bytes, probe).unwrap();
    assert_eq!(found.len(), 2, "the wall's hatch and its solid");
    let gone = quad(at(2.0, -0.02), at(3.0, 0.22));
    let cuts: Vec<Edit> = found.iter().map(|r| void(*r, gone)).collect();
    let written = patch("plan.dxf", &bytes, &cuts, &[outline()]).unwrap();
    let inside = |x: f64| {
        let probe = Probe { inside: at(x, 0.1), beside: [at(x, -0.15), at(x, 0.35)] };
        fills_at("plan.dxf", &written, probe).unwrap().len()
    };
    assert_eq!([0.5, 1.9, 2.1, 2.9, 3.1, 4.5].map(inside), [2, 2, 0, 0, 2, 2]);
    // Nothing left of it: it goes as a whole.
    let all = quad(at(-1.0, -1.0), at(6.0, 1.0));
    let gone = patch("plan.dxf", &bytes, &[void(found[0], all)], &[]);
    assert!(String::from_utf8(gone.unwrap()).unwrap().contains(DEMOLISHED));
}

/// Another one of a block stands where the first one would after the motion, without its attributes.
#[test]
fn a_block_is_shown_once_more() {
    let motion = RigidMotion { turn_rad: 0.5, shift: at(3.0, -1.0) };
    for (name, bytes) in variants() {
        let (before, _) = read_whole(&name, &bytes);
        let is_block = |e: &&Entity| e.source.kind == "INSERT" || !e.blocks.is_empty();
        let first = before.entities.iter().find(is_block).unwrap();
        let copy = work(first.source.record, EntityWork::Copy { motion });
        let written = patch(&name, &bytes, &[copy], &[]).unwrap();
        let (after, _) = read_whole(&name, &written);
        assert_eq!(after.entities.len(), before.entities.len() + 1, "{name}");
        let wanted = moved_shape(&first.shape, &motion);
        assert!(after.entities.iter().any(|e| distance(&e.shape, &wanted) < 1e-9), "{name}: {wanted:?}");
    }
}
