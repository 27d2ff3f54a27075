//! Closed outlines of walls: what lies inside one is wall, what lies between two is air.

use std::collections::BTreeMap;

use glam::DVec2;

use super::carrier::Carrier;
use super::runs::Run;
use super::{Drawn, Path};
use crate::sizes::ZERO_M;
use enfilade_cad::plane::is_inside_ring;

/// Outlines whose area is at most this times half their length are walls; rooms are wider.
const WIDTH_MAX_M: f64 = 0.5;

/// What is known of a place between two faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    Wall,
    Air,
    Nothing,
}

/// Thin closed outlines by wall.
#[derive(Debug, Default)]
pub struct Solids {
    rings: BTreeMap<u32, Vec<DVec2>>,
}

impl Solids {
    pub fn new(drawn: &Drawn) -> Self {
        let mut rings: BTreeMap<u32, Vec<DVec2>> = BTreeMap::new();
        for f in drawn.faces.iter().filter(|f| f.is_closed) {
            let ring = rings.entry(f.wall).or_default();
            let points = match f.path {
                Path::Line { a, b } => vec![a, b],
                Path::Arc { .. } => {
                    let (carrier, span) = Carrier::of(&f.path);
                    carrier.points(span)
                }
            };
            // An arc knows no direction: the first piece is turned to meet the second.
            let touches = |p: Option<&DVec2>| {
                p.is_some_and(|p| {
                    [points[0], points[points.len() - 1]].iter().any(|q| p.distance(*q) < ZERO_M)
                })
            };
            if !touches(ring.last()) && touches(ring.first()) {
                ring.reverse();
            }
            let goes_on = ring.last().is_none_or(|l| l.distance(points[0]) < ZERO_M);
            let points = if goes_on { points } else { points.into_iter().rev().collect() };
            ring.extend(points);
        }
        rings.retain(|_, ring| is_thin(ring));
        Self { rings }
    }

    /// What lies at `p`, between the places `s` of two runs.
    pub fn between(&self, drawn: &Drawn, p: DVec2, runs: [(&Run, f64); 2]) -> Known {
        if self.rings.is_empty() {
            return Known::Nothing;
        }
        let walls = runs.map(|(run, s)| {
            let here = run.faces.iter().filter(|(_, span)| span[0] <= s && s <= span[1]);
            here.map(|(f, _)| drawn.faces[*f as usize].wall).collect::<Vec<u32>>()
        });
        let holds = |w: &u32| self.rings.get(w).is_some_and(|ring| is_inside_ring(ring, p));
        if walls[0].iter().any(|w| walls[1].contains(w) && holds(w)) {
            return Known::Wall;
        }
        let all_solid = walls.iter().all(|w| !w.is_empty() && w.iter().all(|w| self.rings.contains_key(w)));
        if all_solid && !walls.iter().flatten().any(holds) { Known::Air } else { Known::Nothing }
    }
}

fn is_thin(ring: &[DVec2]) -> bool {
    let next = |i: usize| ring[(i + 1) % ring.len()];
    let base = ring[0];
    let area: f64 = (0..ring.len()).map(|i| (ring[i] - base).perp_dot(next(i) - base) / 2.0).sum();
    let length: f64 = (0..ring.len()).map(|i| ring[i].distance(next(i))).sum();
    area.abs() <= WIDTH_MAX_M * length / 2.0
}
