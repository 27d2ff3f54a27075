//! What is read, compared with what ezdxf draws: no point of one may be far from the other.
//!
//! The expected curves of `tests/data/dxf` come from `make_golden.py`; with `ENFILADE_PYTHON` set (an
//! interpreter with ezdxf) the shared drawings are compared the same way.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::collections::HashMap;
use std::f64::consts::TAU;
use std::path::PathBuf;

use crate::support::{corpus, read_whole, shared};
use enfilade_cad::drawing::{Drawing, Shape};
use glam::{DVec2, IVec2};

/// Pieces of a full turn when arcs are sampled.
const ARC_PIECES: f64 = 720.0;

fn data(name: &str) -> PathBuf {
    enfilade_fixtures::repository("crates/cad/tests/data").join(name)
}

fn arc(centre: DVec2, radius: f64, start: f64, sweep: f64) -> Vec<DVec2> {
    let pieces = (sweep.abs() / TAU * ARC_PIECES).ceil().max(2.0);
    (0..=pieces as usize)
        .map(|i| centre + radius * DVec2::from_angle(start + sweep * i as f64 / pieces))
        .collect()
}

fn points(shape: &Shape) -> Vec<DVec2> {
    match shape {
        Shape::Line { a, b } => vec![*a, *b],
        Shape::Circle { centre, radius } => arc(*centre, *radius, 0.0, TAU),
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            let sweep = (end_rad - start_rad).rem_euclid(TAU);
            arc(*centre, *radius, *start_rad, if sweep == 0.0 { TAU } else { sweep })
        }
        Shape::Polyline { vertices, closed } => {
            let mut out = vec![vertices[0].at];
            let count = if *closed { vertices.len() } else { vertices.len() - 1 };
            for i in 0..count {
                let (v, next) = (vertices[i], vertices[(i + 1) % vertices.len()].at);
                if v.bulge != 0.0 && next != v.at {
                    let side = (next - v.at).perp() * ((1.0 - v.bulge * v.bulge) / (4.0 * v.bulge));
                    let centre = (v.at + next) / 2.0 + side;
                    let from = v.at - centre;
                    out.extend(arc(centre, from.length(), from.y.atan2(from.x), 4.0 * v.bulge.atan()));
                }
                out.push(next);
            }
            out
        }
    }
}

fn expected(text: &str) -> Vec<Vec<DVec2>> {
    let point = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        DVec2::new(x.parse().unwrap(), y.parse().unwrap())
    };
    text.lines().map(|line| line.split(' ').map(point).collect()).collect()
}

/// Segments in square buckets.
struct Buckets {
    size: f64,
    segments: HashMap<IVec2, Vec<[DVec2; 2]>>,
}

impl Buckets {
    fn new(curves: &[Vec<DVec2>], size: f64) -> Self {
        let mut segments: HashMap<IVec2, Vec<[DVec2; 2]>> = HashMap::new();
        for w in curves.iter().flat_map(|curve| curve.windows(2)) {
            let (lo, hi) = (w[0].min(w[1]) / size, w[0].max(w[1]) / size);
            for x in lo.x.floor() as i32 - 1..=hi.x.floor() as i32 + 1 {
                for y in lo.y.floor() as i32 - 1..=hi.y.floor() as i32 + 1 {
                    segments.entry(IVec2::new(x, y)).or_default().push([w[0], w[1]]);
                }
            }
        }
        Self { size, segments }
    }

    fn distance(&self, p: DVec2) -> f64 {
        let near = self.segments.get(&(p / self.size).floor().as_ivec2());
        let to = |[a, b]: &[DVec2; 2]| {
            let chord = *b - *a;
            let t = (p - *a).dot(chord) / chord.length_squared().max(1e-300);
            p.distance(*a + chord * t.clamp(0.0, 1.0))
        };
        near.into_iter().flatten().map(to).fold(f64::INFINITY, f64::min)
    }
}

/// Samples of `curves`, at most `step` apart.
fn samples(curves: &[Vec<DVec2>], step: f64) -> impl Iterator<Item = DVec2> {
    curves.iter().flat_map(|curve| curve.windows(2)).flat_map(move |w| {
        let count = (w[0].distance(w[1]) / step).ceil().clamp(1.0, 50.0) as usize;
        (0..=count).map(move |i| w[0].lerp(w[1], i as f64 / count as f64))
    })
}

fn compare(name: &str, drawing: &Drawing, theirs: &[Vec<DVec2>], tolerance: f64) {
    let origin = theirs[0][0];
    let local = |curves: &[Vec<DVec2>]| -> Vec<Vec<DVec2>> {
        curves.iter().map(|curve| curve.iter().map(|p| *p - origin).collect()).collect()
    };
    let ours: Vec<Vec<DVec2>> = drawing.entities.iter().map(|e| points(&e.shape)).collect();
    let (ours, theirs) = (local(&ours), local(theirs));
    let all = || theirs.iter().flatten();
    let size = all().fold(DVec2::MIN, |m, p| m.max(*p)) - all().fold(DVec2::MAX, |m, p| m.min(*p));
    let (bucket, allowed) = (size.max_element() / 400.0, tolerance.max(size.max_element() * 1e-8));
    for (what, from, to) in [("ours", &ours, &theirs), ("ezdxf's", &theirs, &ours)] {
        let buckets = Buckets::new(to, bucket);
        let far = samples(from, bucket).map(|p| (buckets.distance(p), p)).max_by(|a, b| a.0.total_cmp(&b.0));
        let (distance, at) = far.unwrap();
        assert!(
            distance <= allowed,
            "{name}: {what} {} is {distance} away from the other's, allowed {allowed}",
            at + origin
        );
    }
}

#[test]
fn shapes_and_blocks_are_where_ezdxf_puts_them() {
    for name in ["shapes", "blocks"] {
        let bytes = std::fs::read(data(&format!("{name}.dxf"))).unwrap();
        let (drawing, report) = read_whole(name, &bytes);
        assert_eq!(report.problems, [], "{name}");
        let theirs = expected(&std::fs::read_to_string(data(&format!("{name}.expected.txt"))).unwrap());
        compare(name, &drawing, &theirs, 0.02);
    }
}

#[test]
fn real_drawings_are_where_ezdxf_puts_them() {
    let Some(python) = std::env::var_os("ENFILADE_PYTHON") else {
        eprintln!("skipped: ENFILADE_PYTHON is not set");
        return;
    };
    for (name, bytes) in corpus() {
        let script = data("make_golden.py");
        let folder = ["data/dxf", "reference", "reference/bench", "reference/depthmapx-n900"];
        let path = folder.iter().map(|f| shared().join(f).join(&name)).find(|p| p.exists()).unwrap();
        let output = std::process::Command::new(&python).arg(script).arg(&path).output().unwrap();
        if !output.status.success() {
            eprintln!(
                "{name}: ezdxf gave up: {}",
                String::from_utf8_lossy(&output.stderr).lines().last().unwrap()
            );
            continue;
        }
        let (drawing, _) = read_whole(&name, &bytes);
        let theirs = expected(&String::from_utf8_lossy(&output.stdout));
        eprintln!("{name}: {} shapes, ezdxf {}", drawing.entities.len(), theirs.len());
        let unit = drawing.declared_unit.map_or(0.001, |unit| unit.metres);
        compare(&name, &drawing, &theirs, (0.01 / unit).min(20.0));
    }
}
