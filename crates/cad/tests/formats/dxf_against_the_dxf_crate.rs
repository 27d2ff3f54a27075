//! Direct entities, counted by kind and summed up, against the `dxf` crate where it takes the file.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::collections::BTreeMap;

use crate::support::{corpus, read_whole};
use dxf::entities::EntityType;
use enfilade_cad::drawing::Shape;
use glam::DVec2;

/// Number and sum of coordinates of one kind of entity on one layer.
type Sums = BTreeMap<(String, String), (usize, DVec2)>;

fn add(sums: &mut Sums, kind: &str, layer: &str, points: impl IntoIterator<Item = DVec2>) {
    let entry = sums.entry((kind.to_owned(), layer.to_uppercase())).or_default();
    entry.0 += 1;
    entry.1 += points.into_iter().sum::<DVec2>();
}

/// What the crate reads; `None` where it refuses the file or has entities in other planes.
fn theirs(bytes: &[u8]) -> Option<Sums> {
    let drawing = dxf::Drawing::load(&mut &bytes[..]).ok()?;
    let mut sums = Sums::new();
    for entity in drawing.entities().filter(|e| !e.common.is_in_paper_space && e.common.is_visible) {
        let layer = &entity.common.layer;
        let at = |p: &dxf::Point| DVec2::new(p.x, p.y);
        let flat = |n: &dxf::Vector| n.x == 0.0 && n.y == 0.0 && n.z == 1.0;
        match &entity.specific {
            EntityType::Line(line) => add(&mut sums, "LINE", layer, [at(&line.p1), at(&line.p2)]),
            EntityType::Circle(circle) if flat(&circle.normal) => {
                add(&mut sums, "CIRCLE", layer, [at(&circle.center)])
            }
            EntityType::Arc(arc) if flat(&arc.normal) => add(&mut sums, "ARC", layer, [at(&arc.center)]),
            EntityType::LwPolyline(line) if flat(&line.extrusion_direction) => {
                let points = line.vertices.iter().map(|v| DVec2::new(v.x, v.y));
                add(&mut sums, "LWPOLYLINE", layer, points);
            }
            EntityType::Circle(_) | EntityType::Arc(_) | EntityType::LwPolyline(_) => return None,
            _ => {}
        }
    }
    Some(sums)
}

#[test]
fn kinds_layers_and_coordinates_agree() {
    let own = ["shapes", "blocks"].map(|name| {
        let path =
            format!("{}/crates/cad/tests/data/{name}.dxf", enfilade_fixtures::repository("").display());
        (name.to_owned(), std::fs::read(path).unwrap())
    });
    let mut compared = Vec::new();
    for (name, bytes) in own.into_iter().chain(corpus()) {
        let Some(theirs) = theirs(&bytes) else { continue };
        let mut ours = Sums::new();
        for e in read_whole(&name, &bytes).0.entities.iter().filter(|e| e.blocks.is_empty()) {
            match &e.shape {
                Shape::Line { a, b } => add(&mut ours, "LINE", &e.layer, [*a, *b]),
                Shape::Circle { centre, .. } => add(&mut ours, "CIRCLE", &e.layer, [*centre]),
                Shape::Arc { centre, .. } => add(&mut ours, "ARC", &e.layer, [*centre]),
                Shape::Polyline { vertices, .. } if e.source.kind == "LWPOLYLINE" => {
                    add(&mut ours, "LWPOLYLINE", &e.layer, vertices.iter().map(|v| v.at));
                }
                Shape::Polyline { .. } => {}
            }
        }
        let is_latin = ours.keys().all(|(_, layer)| layer.is_ascii());
        if is_latin {
            assert_eq!(ours, theirs, "{name}");
            compared.push(name);
        }
    }
    assert!(compared.iter().any(|name| name == "blocks"), "{compared:?}");
    eprintln!("agreed: {}", compared.join(" "));
}
