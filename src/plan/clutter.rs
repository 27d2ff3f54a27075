//! What is no wall although it lies on a layer of walls: stairs, paving, what is seen below the cut, hatches
//! drawn as lines, leaves of doors, bowls and basins.

use std::collections::{BTreeMap, HashSet};

use glam::DVec2;

use super::drawing::{Drawing, Entity, Shape};
use super::fixtures::{self, Item};
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

/// Takes stairs, paving and fittings out of `walls` (indices of the drawing's entities) and says so; `human_scale`
/// as [`super::Plan::human_scale`]. What of it stands in the way of a wall that slides, stairs and sanitary
/// objects, is returned, ascending.
pub(super) fn leave_out_fittings(
    drawing: &Drawing,
    walls: &mut Vec<usize>,
    metres_per_unit: f64,
    human_scale: f64,
    report: &mut Report,
) -> Vec<usize> {
    let lines = lines(drawing, walls, metres_per_unit);
    let of = |lines: &[Straight], found: Vec<usize>| -> Vec<usize> {
        found.into_iter().map(|i| lines[i].entity).collect()
    };
    let is_paving = paving::find(&lines);
    let rest: Vec<Straight> =
        (0..lines.len()).filter(|i| is_paving.binary_search(i).is_err()).map(|i| lines[i]).collect();
    let stairs = of(&rest, stairs::find(&rest));
    let mut leave = |found: &[usize], what: &str| self::leave(drawing, walls, found, what, report);
    leave(
        &of(&lines, is_paving),
        "lines on wall layers draw a grid of small equal cells: paving or a ceiling",
    );
    leave(&stairs, "lines on wall layers draw stairs: equal treads in a row and what lies between them");
    let fixtures = fixtures::find(&items(drawing, walls, metres_per_unit / human_scale));
    let mut leave = |found: &[usize], what: &str| self::leave(drawing, walls, found, what, report);
    leave(&fixtures.doors, "pieces on wall layers draw leaves of doors and their swings");
    leave(&fixtures.sanitary, "pieces on wall layers draw bowls, basins and what belongs to them");
    leave(&fixtures.crosses, "lines on wall layers draw crosses from corner to corner: shafts or lifts");
    let mut standing: Vec<usize> = stairs.into_iter().chain(fixtures.sanitary).collect();
    standing.sort_unstable();
    standing
}

/// The walls as drawn things, metres.
fn items(drawing: &Drawing, walls: &[usize], metres_per_unit: f64) -> Vec<Item> {
    let origin = walls.iter().find_map(|i| line_of(&drawing.entities[*i])).map_or(DVec2::ZERO, |l| l.0);
    let place = |p: DVec2| (p - origin) * metres_per_unit;
    walls.iter().filter_map(|i| Item::new(*i, &drawing.entities[*i], place)).collect()
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

/// Takes `found` (ascending) out of `walls` and says so.
fn leave(drawing: &Drawing, walls: &mut Vec<usize>, found: &[usize], what: &str, report: &mut Report) {
    if found.is_empty() {
        return;
    }
    walls.retain(|w| found.binary_search(w).is_err());
    let text = format!("{} {what}; left out of the walls, --wall-layer takes them in", found.len());
    report.info("clutter", Place::file(&drawing.file), text);
}

/// A section has at most this share of the lines of the view that it lies over: less, and nothing is seen
/// below it.
const SECTION_SHARE: f64 = 0.5;

/// Keeps of `walls` the section alone where it lies over the view it was cut from, and says so: programs that
/// draw plans of solids write what is seen as one block and what is cut as another over it, all on one layer.
/// Then every line of the section is a line of the view too, to the last digit.
pub(super) fn leave_section(drawing: &Drawing, walls: &mut Vec<usize>, report: &mut Report) {
    let mut blocks: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for i in walls.iter() {
        blocks.entry(drawing.entities[*i].blocks.first().map_or("", String::as_str)).or_default().push(*i);
    }
    let bits = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
    let line = |i: &usize| {
        let (a, b) = line_of(&drawing.entities[*i])?;
        Some([bits(a).min(bits(b)), bits(a).max(bits(b))])
    };
    let lies_over = |section: &[usize], view: &[usize]| {
        let drawn: HashSet<[[u64; 2]; 2]> = view.iter().filter_map(line).collect();
        section.iter().all(|i| line(i).is_some_and(|l| drawn.contains(&l)))
    };
    let pairs = blocks.iter().flat_map(|s| blocks.iter().map(move |v| (s, v)));
    let mut fitting = pairs.filter(|(s, v)| {
        s.1.len() >= ENTITIES_MIN
            && s.1.len() as f64 <= SECTION_SHARE * v.1.len() as f64
            && s.1.len() + v.1.len() == walls.len()
    });
    let Some(((section, cut), (view, _))) = fitting.find(|(s, v)| lies_over(s.1, v.1)) else { return };
    let text = format!(
        "all {} lines of block {section:?} are drawn in {view:?} too: a section over the view it was cut from; the \
         section alone was taken as walls",
        cut.len()
    );
    report.info("section-over-view", Place::file(&drawing.file), text);
    *walls = cut.clone();
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
    use crate::plan::drawing::{Editable, SourceRef};

    #[test]
    fn treads_are_a_row_and_rooms_are_none() {
        let rung = |index: usize, offset: f64, length: f64| Rung { index, offset, middle: 0.0, length };
        let treads: Vec<Rung> = (0..9).map(|i| rung(i, 0.28 * i as f64, 1.2)).collect();
        assert_eq!(ladders(treads).len(), 9);
        let rooms: Vec<Rung> = (0..9).map(|i| rung(i, 3.0 * i as f64, 4.0)).collect();
        assert!(ladders(rooms).is_empty());
    }
    #[test]
    fn a_section_over_its_view_is_what_stands() {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: "0".into() };
        let line = |i: usize, block: &str| Entity {
            source: source.clone(),
            layer: "0".into(),
            shape: Shape::Line { a: DVec2::new(i as f64 / 3.0, 0.1), b: DVec2::new(i as f64 / 3.0, 2.0) },
            editable: Editable::No("it stands in a block".into()),
            blocks: vec![block.into()],
            origin: Default::default(),
        };
        let drawing = |shift: usize| {
            let view = (0..2 * ENTITIES_MIN).map(|i| line(i, "view"));
            let cut = (0..ENTITIES_MIN).map(|i| line(i + shift, "cut"));
            Drawing::of(view.chain(cut).collect())
        };
        let left = |shift: usize| {
            let mut walls: Vec<usize> = (0..3 * ENTITIES_MIN).collect();
            leave_section(&drawing(shift), &mut walls, &mut Report::default());
            walls.len()
        };
        assert_eq!((left(0), left(ENTITIES_MIN + 1)), (ENTITIES_MIN, 3 * ENTITIES_MIN));
    }
}
