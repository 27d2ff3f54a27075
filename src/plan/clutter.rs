//! What is no wall although it lies on a layer of walls: stairs, paving, hatches drawn as lines.

use std::collections::BTreeMap;

use glam::DVec2;

use super::drawing::{Drawing, Entity, Shape};
use super::parallels::Straight;
use super::{paving, stairs};
use crate::report::{Place, Report};

/// Lines in a row, equally long and equally far apart, from which they are treads or a hatch.
const ROW_MIN: usize = 7;

/// How equal lengths and distances are, as a share of the distance.
const EQUAL_SHARE: f64 = 0.02;

/// The lines of a row are at least this many times as long as they are apart.
const SLENDER: f64 = 1.5;

/// At least this many entities must lie on the layer: what is small is a sketch of walls alone.
const ENTITIES_MIN: usize = 150;

/// Takes stairs and paving out of `walls` (indices of the drawing's entities) and says so.
pub(super) fn leave_out_stairs_and_paving(
    drawing: &Drawing,
    walls: &mut Vec<usize>,
    metres_per_unit: f64,
    report: &mut Report,
) {
    let lines = lines(drawing, walls, metres_per_unit);
    let is_paving = paving::find(&lines);
    state(
        drawing,
        walls,
        &lines,
        &is_paving,
        "draw a grid of small equal cells: paving or a ceiling",
        report,
    );
    let rest: Vec<Straight> =
        (0..lines.len()).filter(|i| is_paving.binary_search(i).is_err()).map(|i| lines[i]).collect();
    let is_stair = stairs::find(&rest);
    state(
        drawing,
        walls,
        &rest,
        &is_stair,
        "draw stairs: equal treads in a row and what lies between them",
        report,
    );
}

/// The entities among `walls` that are one straight line each.
fn lines(drawing: &Drawing, walls: &[usize], metres_per_unit: f64) -> Vec<Straight> {
    let origin = walls.iter().find_map(|i| line_of(&drawing.entities[*i])).map_or(DVec2::ZERO, |l| l.0);
    let line = |entity: &usize| {
        let (a, b) = line_of(&drawing.entities[*entity])?;
        let [a, b] = [a, b].map(|p| (p - origin) * metres_per_unit);
        Some(Straight { entity: *entity, a, b })
    };
    walls.iter().filter_map(line).collect()
}

/// Takes `found` of `lines` out of `walls` and says so.
fn state(
    drawing: &Drawing,
    walls: &mut Vec<usize>,
    lines: &[Straight],
    found: &[usize],
    what: &str,
    report: &mut Report,
) {
    if found.is_empty() {
        return;
    }
    // `lines` are in the order of `walls`, and so ascending.
    walls.retain(|w| found.binary_search_by(|f| lines[*f].entity.cmp(w)).is_err());
    let text = format!(
        "{} lines on wall layers {what}; left out of the walls, --wall-layer takes them in",
        found.len()
    );
    report.info("clutter", Place::file(&drawing.file), text);
}

/// Takes treads and hatch lines out of `walls` (indices of the drawing's entities) and says so.
pub(super) fn leave_out(drawing: &Drawing, walls: &mut Vec<usize>, report: &mut Report) {
    if walls.len() < ENTITIES_MIN {
        return;
    }
    let rows = rows(drawing, walls);
    if rows.is_empty() {
        return;
    }
    let before = walls.len();
    walls.retain(|i| rows.binary_search(i).is_err());
    let text = format!(
        "{} lines in rows of {ROW_MIN} or more, equally long and equally far apart: treads or a hatch, left out of the \
         walls",
        before - walls.len()
    );
    report.info("clutter", Place::file(&drawing.file), text);
}

/// A line by what a row has in common: direction, length and both along ends; and its offset.
struct Rung {
    index: usize,
    offset: f64,
    middle: f64,
    length: f64,
}

fn rows(drawing: &Drawing, walls: &[usize]) -> Vec<usize> {
    let mut by_direction: BTreeMap<i64, Vec<Rung>> = BTreeMap::new();
    let origin = walls.iter().find_map(|i| line_of(&drawing.entities[*i])).map_or(DVec2::ZERO, |l| l.0);
    for &index in walls {
        let Some((a, b)) = line_of(&drawing.entities[index]) else { continue };
        let degrees = (b - a).to_angle().to_degrees().rem_euclid(180.0).round() as i64 % 180;
        let along = DVec2::from_angle((degrees as f64).to_radians());
        let middle = (a + b) / 2.0 - origin;
        by_direction.entry(degrees).or_default().push(Rung {
            index,
            offset: along.perp().dot(middle),
            middle: along.dot(middle),
            length: a.distance(b),
        });
    }
    let mut out: Vec<usize> = by_direction.into_values().flat_map(ladders).collect();
    out.sort_unstable();
    out
}

/// Indices of the rungs that stand in rows; all of one direction.
fn ladders(mut rungs: Vec<Rung>) -> Vec<usize> {
    // Same length and same place along: rungs of one ladder come to stand beside each other.
    let key = |r: &Rung| ((r.length.ln() / EQUAL_SHARE).round() as i64, quantum(r.middle, r.length));
    rungs.sort_by(|x, y| key(x).cmp(&key(y)).then(x.offset.total_cmp(&y.offset)).then(x.index.cmp(&y.index)));
    let mut out = Vec::new();
    for same in rungs.chunk_by(|x, y| key(x) == key(y)) {
        let mut from = 0;
        while from + 1 < same.len() {
            let step = same[from + 1].offset - same[from].offset;
            let mut to = from + 1;
            while to + 1 < same.len()
                && (same[to + 1].offset - same[to].offset - step).abs() <= EQUAL_SHARE * step
            {
                to += 1;
            }
            if to - from + 1 >= ROW_MIN && step > 0.0 && same[from].length >= SLENDER * step {
                out.extend(same[from..=to].iter().map(|r| r.index));
            }
            from = to;
        }
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// A value in steps of a small share of `length`.
fn quantum(value: f64, length: f64) -> i64 {
    (value / (EQUAL_SHARE * length).max(f64::MIN_POSITIVE)).round() as i64
}

fn line_of(e: &Entity) -> Option<(DVec2, DVec2)> {
    match &e.shape {
        Shape::Line { a, b } if a != b => Some((*a, *b)),
        Shape::Polyline { vertices, closed: false } if vertices.len() == 2 => {
            Some((vertices[0].at, vertices[1].at))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn treads_are_a_row_and_rooms_are_none() {
        let rung = |index: usize, offset: f64, length: f64| Rung { index, offset, middle: 0.0, length };
        let treads: Vec<Rung> = (0..9).map(|i| rung(i, 0.28 * i as f64, 1.2)).collect();
        assert_eq!(ladders(treads).len(), 9);
        let rooms: Vec<Rung> = (0..9).map(|i| rung(i, 3.0 * i as f64, 4.0)).collect();
        assert!(ladders(rooms).is_empty());
    }
}
