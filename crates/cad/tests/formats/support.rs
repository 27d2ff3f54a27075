//! What the DXF tests share: the drawings beside the repository, and edits made by a seed.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "each test crate uses a part; a failing helper fails the test"
)]

use std::collections::BTreeSet;
use std::path::PathBuf;

use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Entity, Mark, RigidMotion, Shape, Vertex};
use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_cad::own_layers::{BEFORE_RGB, MOVED_RGB, NOTE_RGB};
use enfilade_report::Report;
use glam::DVec2;

/// The folder of shared material, by `ENFILADE_SHARED` or beside the repository.
pub fn shared() -> PathBuf {
    std::env::var_os("ENFILADE_SHARED")
        .map_or_else(|| enfilade_fixtures::repository("../shared"), PathBuf::from)
}

/// The drawings of the shared folder, sorted by path; empty, with a note, where they are absent.
pub fn corpus() -> Vec<(String, Vec<u8>)> {
    let folders = ["data/dxf", "reference", "reference/bench", "reference/depthmapx-n900"];
    let mut files: Vec<PathBuf> = folders
        .iter()
        .filter_map(|folder| std::fs::read_dir(shared().join(folder)).ok())
        .flat_map(|folder| folder.filter_map(|entry| Some(entry.ok()?.path())))
        .filter(|path| path.extension().is_some_and(|extension| extension == "dxf"))
        .collect();
    files.sort();
    if files.is_empty() {
        eprintln!("skipped: no drawings in {}", shared().display());
    }
    let named = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (named(path), std::fs::read(path).unwrap())).collect()
}

/// Reads a drawing that must be readable.
pub fn read_whole(name: &str, bytes: &[u8]) -> (Drawing, Report) {
    let mut report = Report::default();
    let drawing = read(name, bytes, &ReadOptions::default(), &mut report);
    (drawing.unwrap_or_else(|error| panic!("{name}: {error}")), report)
}

/// A point under a rigid motion.
pub fn moved(p: DVec2, motion: &RigidMotion) -> DVec2 {
    DVec2::from_angle(motion.turn_rad).rotate(p) + motion.shift
}

/// A shape under a rigid motion.
pub fn moved_shape(shape: &Shape, motion: &RigidMotion) -> Shape {
    let at = |p: DVec2| moved(p, motion);
    match shape {
        Shape::Line { a, b } => Shape::Line { a: at(*a), b: at(*b) },
        Shape::Polyline { vertices, closed } => Shape::Polyline {
            vertices: vertices.iter().map(|v| Vertex { at: at(v.at), bulge: v.bulge }).collect(),
            closed: *closed,
        },
        Shape::Arc { centre, radius, start_rad, end_rad } => Shape::Arc {
            centre: at(*centre),
            radius: *radius,
            start_rad: start_rad + motion.turn_rad,
            end_rad: end_rad + motion.turn_rad,
        },
        Shape::Circle { centre, radius } => Shape::Circle { centre: at(*centre), radius: *radius },
    }
}

/// Moves every `step`-th free entity and every `step`-th movable INSERT (turned where it can be).
pub fn edits_of(drawing: &Drawing, step: usize, motion: RigidMotion) -> Vec<Edit> {
    let free = drawing.entities.iter().filter(|e| e.editable == Editable::Free).step_by(step);
    let shapes = free.map(|e| Edit::Shape { record: e.source.record, shape: moved_shape(&e.shape, &motion) });
    let turnable = |e: &Entity| match e.editable {
        Editable::WithInsert { turnable } => Some((e.source.record, turnable)),
        _ => None,
    };
    let inserts: BTreeSet<(usize, bool)> = drawing.entities.iter().filter_map(turnable).collect();
    let inserts = inserts.into_iter().step_by(step).map(|(record, turnable)| Edit::Insert {
        record,
        motion: RigidMotion { turn_rad: if turnable { motion.turn_rad } else { 0.0 }, ..motion },
    });
    shapes.chain(inserts).collect()
}

/// One of each thing we draw, over a drawing's place and of a fitting size.
pub fn additions_for(drawing: &Drawing) -> Vec<Addition> {
    let points = drawing.entities.iter().filter_map(|e| match &e.shape {
        Shape::Line { a, .. } => Some(*a),
        Shape::Polyline { vertices, .. } => vertices.first().map(|v| v.at),
        _ => None,
    });
    let (lo, hi) = points.fold((DVec2::MAX, DVec2::MIN), |(lo, hi), p| (lo.min(p), hi.max(p)));
    let s = ((hi - lo).length() / 100.0).max(1e-3);
    let at = |x: f64, y: f64| lo + DVec2::new(x, y) * s;
    let add = |layer: &str, rgb: [u8; 3], mark: Mark| Addition { layer: layer.into(), rgb, mark };
    vec![
        add("EF-MOVED", MOVED_RGB, Mark::Path { points: vec![at(0.0, 0.0), at(5.0, 0.0)], closed: false }),
        add(
            "EF-BEFORE",
            BEFORE_RGB,
            Mark::Path { points: vec![at(0.0, 0.0), at(5.0, 0.0), at(5.0, 5.0)], closed: true },
        ),
        add(
            "EF-HEAT-DEGREE",
            [255, 255, 0],
            Mark::Fill { corners: [at(9.0, 0.0), at(12.0, 0.0), at(12.0, 3.0), at(9.0, 3.0)] },
        ),
        add(
            "EF-NOTE",
            NOTE_RGB,
            Mark::Text {
                at: at(0.0, 9.0),
                height: s,
                text: "Tür 3: +0.50 m → 100 %\n壁 %%d ^ \\U+00FC".into(),
            },
        ),
    ]
}
