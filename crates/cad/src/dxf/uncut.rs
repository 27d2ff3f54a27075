//! Walls that a look at the height of the eyes does not meet: parapets below it, beams above it.
//!
//! Where walls are drawn with a thickness (group 39), that says how high they reach. Where none is, what lies higher above
//! the others than walls of a storey reach is none of them; what lies lower may be a slip of the pen.

use std::collections::{BTreeMap, HashSet};

use super::heights::Heights;
use super::storeys::{STOREY_M, Storeys, leave_out, length, walls};
use crate::curve::control_points;
use crate::drawing::{Drawing, Entity, Unit};
use crate::plane::box_of;
use crate::units::by_heights;
use enfilade_report::{Place, Report, counted};

/// Thicknesses tell how high walls are where this share of their length has one.
const THICK_MIN: f64 = 0.75;

/// Heights nearer than this share of the greatest thickness are one.
const SAME: f64 = 0.02;

/// What is flat and lies so far above the other walls, metres, is none of them: nobody snaps to it by mistake from a wall of
/// the storey. Higher up the heights mean something else.
const RAISED_M: [f64; 2] = [4.0, 30.0];

/// Walls lie at one height, apart from this share of their length.
const MISSED_MAX: f64 = 0.2;

/// Flat walls at heights no farther apart, metres, lie at one.
const FLAT_M: f64 = 0.01;

/// Walls that were left out, by their storey, their layer and whether they lie above the eyes.
#[derive(Default)]
pub(super) struct Uncut(BTreeMap<(usize, String, bool), usize>);

/// A wall with the heights it reaches from and to.
struct Standing<'d> {
    index: usize,
    wall: &'d Entity,
    low: f64,
    high: f64,
    is_thick: bool,
}

impl Uncut {
    /// Takes what is not cut out of a drawing and its storeys. `unit`: the drawing's as far as somebody states it; `above_m`:
    /// height of the cut above a floor.
    pub fn take(
        drawing: &mut Drawing,
        storeys: Option<&mut Storeys>,
        heights: &mut Heights<'_, '_>,
        (unit, above_m): (Option<Unit>, f64),
    ) -> Self {
        let mut of_storeys: BTreeMap<usize, Vec<Standing<'_>>> = BTreeMap::new();
        for index in walls(drawing) {
            let wall = &drawing.entities[index];
            let ([low, high], is_thick) = heights.reach(&wall.origin);
            let storey = storeys.as_ref().map_or(0, |s| s.of_entity(index));
            of_storeys.entry(storey).or_default().push(Standing { index, wall, low, high, is_thick });
        }
        let (mut gone, mut out) = (HashSet::new(), Self::default());
        for (storey, walls) in of_storeys {
            let missed = match is_thick(&walls) {
                true => missed(&walls, unit, above_m),
                false => raised(&walls, unit),
            };
            for (wall, is_above) in missed {
                gone.insert(wall.index);
                *out.0.entry((storey, wall.wall.layer.clone(), is_above)).or_default() += 1;
            }
        }
        if !gone.is_empty() {
            leave_out(&mut drawing.entities, &gone);
            if let Some(storeys) = storeys {
                storeys.leave_out(&gone);
            }
        }
        out
    }

    /// Lists what was left out of the storey that is read.
    pub fn report(&self, file: &str, storey: usize, report: &mut Report) {
        let own = self.0.iter().filter(|((of, ..), _)| *of == storey);
        let words = own.map(|((_, layer, is_above), n)| {
            let side = if *is_above { "above" } else { "below" };
            format!("{} {side} it on {layer:?}", counted(*n as u64, "wall"))
        });
        let words: Vec<String> = words.collect();
        if !words.is_empty() {
            let text = format!(
                "not at the height of the eyes: {}; left out of the plan, kept in the file",
                words.join(", ")
            );
            report.info("dxf-not-cut", Place::file(file), text);
        }
    }
}

/// Walls wholly below or above the cut, and whether they are above; none where thicknesses do not tell the height of a storey.
fn missed<'w, 'd>(
    walls: &'w [Standing<'d>],
    unit: Option<Unit>,
    above_m: f64,
) -> Vec<(&'w Standing<'d>, bool)> {
    let thick: Vec<&Standing<'_>> = walls.iter().filter(|w| w.is_thick).collect();
    let near = SAME * thick.iter().map(|w| w.high - w.low).fold(0.0, f64::max);
    let common =
        |of: fn(&Standing<'_>) -> f64| commonest(thick.iter().map(|w| (of(w), length(w.wall))), near);
    let (floor, top) = (common(|w| w.low), common(|w| w.high));
    let Some(unit) = unit.or_else(|| by_heights(&[top - floor])) else { return Vec::new() };
    if !(STOREY_M[0]..=STOREY_M[1]).contains(&((top - floor) * unit.metres)) {
        return Vec::new();
    }
    let cut = floor + above_m / unit.metres;
    let is_missed = |w: &&Standing<'_>| w.low > cut || w.is_thick && w.high < cut;
    let missed: Vec<&Standing<'_>> = walls.iter().filter(is_missed).collect();
    // More is a part of the building on a level of its own.
    let is_little = total(missed.iter().copied()) <= MISSED_MAX * total(walls.iter());
    missed.into_iter().filter(|_| is_little).map(|w| (w, w.low > cut)).collect()
}

fn total<'w, 'd: 'w>(walls: impl Iterator<Item = &'w Standing<'d>>) -> f64 {
    walls.map(|w| length(w.wall)).sum()
}

/// Whether thicknesses tell how high these walls are.
fn is_thick(walls: &[Standing<'_>]) -> bool {
    total(walls.iter().filter(|w| w.is_thick)) >= THICK_MIN * total(walls.iter())
        && walls.iter().any(|w| w.is_thick)
}

/// Flat walls that lie higher above the others than those reach, over their plan. Whether they join these is not asked: moves
/// change that, and a plan is read again as it was.
fn raised<'w, 'd>(walls: &'w [Standing<'d>], unit: Option<Unit>) -> Vec<(&'w Standing<'d>, bool)> {
    let Some(metre) = unit.map(|u| 1.0 / u.metres) else { return Vec::new() };
    let near = FLAT_M * metre;
    let floor = commonest(walls.iter().map(|w| (w.low, length(w.wall))), near);
    let (ground, others): (Vec<&Standing<'_>>, Vec<&Standing<'_>>) =
        walls.iter().partition(|w| w.low >= floor - near && w.high <= floor + near);
    let [own, all] = [total(others.iter().copied()), total(walls.iter())];
    let extent = box_of(ground.iter().flat_map(|w| control_points(&w.wall.shape)));
    let Some([lo, hi]) = extent.filter(|_| own <= MISSED_MAX * all) else { return Vec::new() };
    let is_high = |w: &&&Standing<'_>| {
        (RAISED_M[0] * metre..=RAISED_M[1] * metre).contains(&(w.low - floor))
            && control_points(&w.wall.shape).into_iter().all(|p| p.clamp(lo, hi) == p)
    };
    let high: HashSet<usize> = others.iter().filter(is_high).map(|w| w.index).collect();
    walls.iter().filter(|w| high.contains(&w.index)).map(|w| (w, true)).collect()
}

/// The height at which most length of walls begins or ends, the lowest of several.
fn commonest(heights: impl Iterator<Item = (f64, f64)>, near: f64) -> f64 {
    let mut all: Vec<(f64, f64)> = heights.collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let lengths = |group: &&[(f64, f64)]| group.iter().map(|g| g.1).sum::<f64>();
    let groups = all.chunk_by(|a, b| b.0 - a.0 <= near).rev();
    let most = groups.max_by(|a, b| lengths(a).total_cmp(&lengths(b)));
    most.map_or(0.0, |group| group[0].0)
}
