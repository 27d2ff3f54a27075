//! Several drawings on one sheet: which there are, which are plans, which one is taken.
//!
//! Everything visible is drawn into coarse cells; what hangs together is one drawing. Small pieces
//! belong to the drawing they lie in or beside, so that columns and furniture split nothing.

use std::collections::BTreeMap;

use glam::DVec2;

use super::box_of;
use super::curve::control_points;
use super::drawing::{Drawing, Entity, Shape, Text};
use super::parallels::pieces;
use super::roles::{Role, role_by_name};
use super::view_names::{Title, is_first_floor, title_of};

/// Side of a cell, metres: drawings on a sheet stand farther apart than one to two of these, the parts
/// of one building that do are joined by [`NEAR_M`].
const CELL_M: f64 = 1.5;

/// Cells along the longer side at most; keeps the raster small where the drawing is huge.
const CELLS_MAX: f64 = 4_000.0;

/// A drawing of its own has walls of at least this many pieces and is this large both ways.
const OWN_PIECES: usize = 8;
const OWN_SIZE_M: f64 = 3.0;

/// What is smaller than this share of the drawing that it is nearer to than this is a part of it (a garage
/// beside the house), unless a title of its own stands by it.
const PART_SHARE: f64 = 0.25;
const NEAR_M: f64 = 8.0;

/// A line this long against the sheet that is no wall is a frame or a construction line.
const FRAME_SHARE: f64 = 0.3;

/// Titles are looked for this far around a drawing, metres.
const TITLE_M: f64 = 4.0;

/// Columns are cut in plans alone: where so many pieces of them are drawn in one view, an untitled view without any is
/// worth less by [`NO_COLUMNS`].
const COLUMN_PIECES_MIN: usize = 16;
const NO_COLUMNS: f64 = 1.0;

/// Stands for no view.
pub const STRAY: usize = usize::MAX;

/// One drawing of the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Number from 1, in reading order: left to right in rows from the top.
    pub number: usize,
    /// Its title, or `drawing N`.
    pub name: String,
    /// Box, drawing units.
    pub extent: [DVec2; 2],
    /// Straight pieces of walls in it.
    pub wall_pieces: usize,
    /// Those of them that lie on layers named after columns.
    pub column_pieces: usize,
    /// What it was judged to be.
    pub kind: Title,
    /// Whether the plan was read from it.
    pub is_chosen: bool,
    /// What it was judged by, in plain words.
    pub why: String,
}

/// The drawings of a sheet and which wall lies in which.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The drawings in reading order.
    pub views: Vec<View>,
    /// For each wall the index of its view; [`STRAY`] where it lies far from every drawing.
    pub of_wall: Vec<usize>,
}

/// Splits a sheet. `walls` are the entities taken as walls, `is_seen` says which others count,
/// `keeps` are points (drawing units) that must not be parted: the user's marks.
pub fn split(
    drawing: &Drawing,
    walls: &[&Entity],
    is_seen: &dyn Fn(&Entity) -> bool,
    keeps: &[DVec2],
    metres_per_unit: f64,
) -> Sheet {
    let parts = parts(drawing, walls, is_seen, metres_per_unit);
    let mut boxes = groups(drawing, parts, metres_per_unit);
    if boxes.is_empty() {
        boxes.extend(box_of(walls.iter().flat_map(|w| control_points(&w.shape))));
    }
    let near = NEAR_M / metres_per_unit;
    let view_of = |p: DVec2| {
        let i = nearest(&boxes, p);
        if boxes.get(i).is_some_and(|b| gap(b, &[p, p]) > near) { STRAY } else { i }
    };
    let mut of_wall: Vec<usize> = walls.iter().map(|w| view_of(middle(&w.shape))).collect();
    let marked: Vec<usize> = keeps.iter().map(|p| nearest(&boxes, *p)).collect();
    if marked.windows(2).any(|m| m[0] != m[1]) {
        of_wall = vec![0; walls.len()];
        boxes = box_of(boxes.into_iter().flatten()).into_iter().collect();
    }
    let mut sheet = Sheet { views: views(drawing, &boxes, metres_per_unit), of_wall };
    count_walls(&mut sheet, walls);
    choose(&mut sheet, keeps.first());
    sheet
}

/// A part of all walls smaller than this, farther off than [`NEAR_M`] twice, is no part of the building.
const STRAY_SHARE: f64 = 0.01;

/// Which walls stand far from all others and are next to nothing: pieces forgotten on the sheet.
pub fn strays(walls: &[&Entity], metres_per_unit: f64) -> Vec<bool> {
    let pieces = pieces(walls.iter().copied());
    let Some([lo, hi]) = box_of(pieces.iter().flat_map(|p| [p.a, p.b])) else {
        return vec![false; walls.len()];
    };
    let cell = (NEAR_M / metres_per_unit).max((hi - lo).max_element() / CELLS_MAX);
    let mut raster = Raster { lo, cell, cells: BTreeMap::new() };
    pieces.iter().for_each(|p| raster.draw(p.a, p.b, 1));
    let few = (STRAY_SHARE * pieces.len() as f64).min(OWN_PIECES as f64);
    let far: Vec<[DVec2; 2]> =
        raster.parts().into_iter().filter(|p| (p.wall_pieces as f64) < few).map(|p| p.extent).collect();
    let is_in = |p: DVec2| far.iter().any(|b| gap(b, &[p, p]) <= 0.0);
    walls.iter().map(|w| is_in(middle(&w.shape))).collect()
}

/// In a building a wall is a slip if it stands this many times farther from the middle of most than most of them reach,
/// and farther than [`FAR_M`].
const FAR_TIMES: f64 = 20.0;
/// What stands nearer to the middle of a building is never far off, metres: sites with several houses are smaller.
pub const FAR_M: f64 = 250.0;

/// The share of a building's outlines, the nearest first, that say how far it reaches; fewer than so many say nothing.
const REACHED_SHARE: f64 = 0.75;
const OUTLINES_MIN: usize = 4;

/// Which walls of a building stand where nothing else of it is: one would stretch everything until the building is a dot.
pub fn far_off(walls: &[&Entity], metres_per_unit: f64) -> Vec<bool> {
    let middles: Vec<DVec2> = walls.iter().map(|w| middle(&w.shape)).collect();
    if middles.len() < OUTLINES_MIN {
        return vec![false; walls.len()];
    }
    let at = |share: f64, mut values: Vec<f64>| {
        let k = ((values.len() - 1) as f64 * share) as usize;
        *values.select_nth_unstable_by(k, f64::total_cmp).1
    };
    let pick = |pick: fn(&DVec2) -> f64| at(0.5, middles.iter().map(pick).collect());
    let centre = DVec2::new(pick(|p| p.x), pick(|p| p.y));
    let boxes = || walls.iter().map(|w| box_of(control_points(&w.shape).into_iter()));
    let farthest =
        |[lo, hi]: [DVec2; 2]| (centre - lo).abs().max((hi - centre).abs()).length() * metres_per_unit;
    let reach = at(REACHED_SHARE, boxes().flatten().map(farthest).collect());
    let limit = (FAR_TIMES * reach).max(FAR_M);
    let nearest = |[lo, hi]: [DVec2; 2]| (centre.clamp(lo, hi) - centre).length() * metres_per_unit;
    boxes().map(|b| b.is_some_and(|b| nearest(b) > limit)).collect()
}

/// What hangs together: box and number of wall pieces.
struct Part {
    extent: [DVec2; 2],
    wall_pieces: usize,
}

fn parts(
    drawing: &Drawing,
    walls: &[&Entity],
    is_seen: &dyn Fn(&Entity) -> bool,
    metres_per_unit: f64,
) -> Vec<Part> {
    let seen: Vec<&Entity> = drawing.entities.iter().filter(|e| is_seen(e)).collect();
    let all = walls.iter().chain(&seen).flat_map(|e| control_points(&e.shape));
    let Some([lo, hi]) = box_of(all) else { return Vec::new() };
    let extent = (hi - lo).max_element();
    let cell = (CELL_M / metres_per_unit).max(extent / CELLS_MAX);
    let mut raster = Raster { lo, cell, cells: BTreeMap::new() };
    for piece in pieces(walls.iter().copied()) {
        raster.draw(piece.a, piece.b, 1);
    }
    let frame = extent * FRAME_SHARE;
    for piece in pieces(seen.iter().copied()).into_iter().filter(|p| p.length() < frame) {
        raster.draw(piece.a, piece.b, 0);
    }
    raster.parts()
}

struct Raster {
    lo: DVec2,
    cell: f64,
    /// Wall pieces that start in each touched cell.
    cells: BTreeMap<[i64; 2], usize>,
}

impl Raster {
    fn draw(&mut self, a: DVec2, b: DVec2, walls: usize) {
        let steps = (a.distance(b) / self.cell * 2.0).ceil().max(1.0) as usize;
        for i in 0..=steps {
            let p = (a.lerp(b, i as f64 / steps as f64) - self.lo) / self.cell;
            let count = self.cells.entry([p.x.floor() as i64, p.y.floor() as i64]).or_default();
            *count += if i == 0 { walls } else { 0 };
        }
    }

    /// Connected sets of touched cells, neighbours by side or corner.
    fn parts(mut self) -> Vec<Part> {
        let mut out = Vec::new();
        while let Some((&start, _)) = self.cells.first_key_value() {
            let mut wall_pieces = self.cells.remove(&start).unwrap_or(0);
            let (mut stack, mut lo, mut hi) = (vec![start], start, start);
            while let Some([x, y]) = stack.pop() {
                (lo, hi) = ([lo[0].min(x), lo[1].min(y)], [hi[0].max(x), hi[1].max(y)]);
                for next in (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j])) {
                    if let Some(n) = self.cells.remove(&next) {
                        wall_pieces += n;
                        stack.push(next);
                    }
                }
            }
            let at = |c: [i64; 2], add: f64| {
                self.lo + DVec2::new(c[0] as f64 + add, c[1] as f64 + add) * self.cell
            };
            out.push(Part { extent: [at(lo, 0.0), at(hi, 1.0)], wall_pieces });
        }
        out
    }
}

/// Joins parts to whole drawings; their boxes.
fn groups(drawing: &Drawing, parts: Vec<Part>, metres_per_unit: f64) -> Vec<[DVec2; 2]> {
    let is_own = |p: &Part| {
        let size = (p.extent[1] - p.extent[0]) * metres_per_unit;
        p.wall_pieces >= OWN_PIECES && size.min_element() >= OWN_SIZE_M
    };
    let mut boxes: Vec<[DVec2; 2]> = parts.iter().filter(|p| is_own(p)).map(|p| p.extent).collect();
    let near = NEAR_M / metres_per_unit;
    if let [only] = boxes[..] {
        let beside = parts.iter().filter(|p| gap(&p.extent, &only) <= near);
        return box_of(beside.flat_map(|p| p.extent)).into_iter().collect();
    }
    if boxes.is_empty() {
        return box_of(parts.iter().flat_map(|p| p.extent)).into_iter().collect();
    }
    let area = |b: &[DVec2; 2]| (b[1] - b[0]).element_product();
    loop {
        let joined = (0..boxes.len()).find_map(|i| {
            let other = (0..boxes.len()).find(|&j| {
                let gap = gap(&boxes[i], &boxes[j]);
                let is_part = area(&boxes[i]) < PART_SHARE * area(&boxes[j])
                    && gap < near
                    && !has_title_near(drawing, &boxes[i], metres_per_unit);
                i != j && (gap <= 0.0 || is_part)
            })?;
            Some((i, other))
        });
        let Some((i, j)) = joined else { return boxes };
        boxes[j] = [boxes[i][0].min(boxes[j][0]), boxes[i][1].max(boxes[j][1])];
        boxes.swap_remove(i);
    }
}

/// Distance of two boxes, 0 where they overlap.
fn gap(a: &[DVec2; 2], b: &[DVec2; 2]) -> f64 {
    (a[0] - b[1]).max(b[0] - a[1]).max(DVec2::ZERO).length()
}

fn nearest(boxes: &[[DVec2; 2]], p: DVec2) -> usize {
    let distance = |b: &[DVec2; 2]| gap(b, &[p, p]);
    (0..boxes.len()).min_by(|i, j| distance(&boxes[*i]).total_cmp(&distance(&boxes[*j]))).unwrap_or(0)
}

fn middle(shape: &Shape) -> DVec2 {
    box_of(control_points(shape).into_iter()).map_or(DVec2::ZERO, |b| (b[0] + b[1]) / 2.0)
}

/// Whether a title stands in a drawing's box or beside it.
fn has_title_near(drawing: &Drawing, extent: &[DVec2; 2], metres_per_unit: f64) -> bool {
    let reach = TITLE_M / metres_per_unit;
    drawing.texts.iter().any(|t| gap(extent, &[t.at, t.at]) <= reach && title_of(&t.text).is_some())
}

/// The box of what is drawn in a box of cells.
fn tight(drawing: &Drawing, [lo, hi]: &[DVec2; 2]) -> [DVec2; 2] {
    let is_in = |p: &DVec2| p.cmpge(*lo).all() && p.cmple(*hi).all();
    let points = drawing.entities.iter().flat_map(|e| control_points(&e.shape));
    box_of(points.filter(is_in)).unwrap_or([*lo, *hi])
}

/// The title of every drawing, if one stands in it or beside it: the nearest pairs first, each title for one drawing.
fn titles(drawing: &Drawing, boxes: &[[DVec2; 2]], metres_per_unit: f64) -> Vec<Option<(Title, String)>> {
    let reach = TITLE_M / metres_per_unit;
    let texts: Vec<(Title, &Text)> =
        drawing.texts.iter().filter_map(|t| Some((title_of(&t.text)?, t))).collect();
    let boxes: Vec<[DVec2; 2]> = boxes.iter().map(|b| tight(drawing, b)).collect();
    let far = |b: usize, t: usize| gap(&boxes[b], &[texts[t].1.at, texts[t].1.at]);
    let pairs = (0..boxes.len()).flat_map(|b| (0..texts.len()).map(move |t| (b, t)));
    let mut near: Vec<(f64, usize, usize)> =
        pairs.map(|(b, t)| (far(b, t), b, t)).filter(|p| p.0 <= reach).collect();
    // Where two drawings are as near, it stands under one of them.
    let is_over = |b: usize, t: usize| texts[t].1.at.y > boxes[b][0].midpoint(boxes[b][1]).y;
    near.sort_by(|p, q| p.0.total_cmp(&q.0).then(is_over(p.1, p.2).cmp(&is_over(q.1, q.2))));
    let mut out = vec![None; boxes.len()];
    let mut is_taken = vec![false; texts.len()];
    for (_, b, t) in near {
        if out[b].is_none() && !is_taken[t] {
            is_taken[t] = true;
            let (kind, text) = texts[t];
            out[b] = Some((kind, text.text.trim().lines().next().unwrap_or_default().to_owned()));
        }
    }
    out
}

fn views(drawing: &Drawing, boxes: &[[DVec2; 2]], metres_per_unit: f64) -> Vec<View> {
    let titles = if boxes.len() > 1 { titles(drawing, boxes, metres_per_unit) } else { vec![None] };
    let mut out: Vec<View> = Vec::new();
    for (extent, title) in boxes.iter().zip(titles) {
        let (kind, name) = title.unwrap_or((Title::Unknown, String::new()));
        let why = if name.is_empty() { "no title by it".into() } else { format!("titled {name:?}") };
        let (number, wall_pieces, column_pieces, is_chosen) = (0, 0, 0, false);
        out.push(View { number, name, extent: *extent, wall_pieces, column_pieces, kind, is_chosen, why });
    }
    tell_first_floor(&mut out);
    out
}

/// Where a ground floor is drawn too, the first floor lies above it.
fn tell_first_floor(views: &mut [View]) {
    let is_first = |v: &View| v.kind == Title::GroundFloor && is_first_floor(&v.name);
    if views.iter().any(|v| v.kind == Title::GroundFloor && !is_first(v)) {
        views.iter_mut().filter(|v| is_first(v)).for_each(|v| v.kind = Title::Plan);
    }
}

/// Numbers the views in reading order and counts their walls.
fn count_walls(sheet: &mut Sheet, walls: &[&Entity]) {
    let is_column: Vec<bool> = walls.iter().map(|w| role_by_name(&w.layer).0 == Role::Column).collect();
    for piece in pieces(walls.iter().copied()) {
        let view = sheet.of_wall[piece.entity];
        if view != STRAY {
            sheet.views[view].wall_pieces += 1;
            sheet.views[view].column_pieces += usize::from(is_column[piece.entity]);
        }
    }
    let mut order: Vec<usize> = (0..sheet.views.len()).collect();
    let top = |i: usize| sheet.views[i].extent[1].y;
    order.sort_by(|a, b| top(*b).total_cmp(&top(*a)));
    // Rows: a view that begins below the middle of the row's first one starts the next row.
    let mut rows: Vec<Vec<usize>> = Vec::new();
    for i in order {
        let same = rows.last().and_then(|r| r.first()).is_some_and(|first| {
            let [lo, hi] = sheet.views[*first].extent;
            top(i) > (lo.y + hi.y) / 2.0
        });
        match rows.last_mut() {
            Some(row) if same => row.push(i),
            _ => rows.push(vec![i]),
        }
    }
    let left = |i: &usize| sheet.views[*i].extent[0].x;
    for row in &mut rows {
        row.sort_by(|a, b| left(a).total_cmp(&left(b)));
    }
    let order: Vec<usize> = rows.into_iter().flatten().collect();
    let mut place = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        place[*old] = new;
    }
    sheet.of_wall.iter_mut().filter(|v| **v != STRAY).for_each(|v| *v = place[*v]);
    sheet.views = order.iter().map(|old| sheet.views[*old].clone()).collect();
    for (i, view) in sheet.views.iter_mut().enumerate() {
        view.number = i + 1;
        if view.name.is_empty() {
            view.name = format!("drawing {}", i + 1);
        }
    }
}

/// Marks the view to take: the one with the user's marks, else the best plan.
fn choose(sheet: &mut Sheet, mark: Option<&DVec2>) {
    let most = sheet.views.iter().map(|v| v.wall_pieces).max().unwrap_or(0) as f64;
    let has_columns = sheet.views.iter().any(|v| v.column_pieces >= COLUMN_PIECES_MIN);
    let score = |v: &View| {
        let lacks_columns = has_columns && v.column_pieces == 0 && v.kind == Title::Unknown;
        v.wall_pieces as f64 / most.max(1.0) + v.kind.worth() - if lacks_columns { NO_COLUMNS } else { 0.0 }
    };
    let boxes: Vec<[DVec2; 2]> = sheet.views.iter().map(|v| v.extent).collect();
    let best = match mark {
        Some(p) => nearest(&boxes, *p),
        None => {
            let order = (0..boxes.len()).rev();
            let by_score = |a: &usize, b: &usize| score(&sheet.views[*a]).total_cmp(&score(&sheet.views[*b]));
            order.max_by(by_score).unwrap_or(0)
        }
    };
    if let Some(view) = sheet.views.get_mut(best) {
        view.is_chosen = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drawing::SourceRef;

    fn view(number: usize, wall_pieces: usize, column_pieces: usize, kind: Title) -> View {
        View {
            number,
            name: String::new(),
            extent: [DVec2::ZERO, DVec2::ONE],
            wall_pieces,
            column_pieces,
            kind,
            is_chosen: false,
            why: String::new(),
        }
    }

    /// In America the first floor is the ground floor; not where the ground floor is drawn beside it.
    #[test]
    fn the_first_floor_lies_above_a_ground_floor() {
        let kinds = |names: [&str; 2]| {
            let titled = |name: &str| View {
                name: name.into(),
                ..view(1, 60, 0, title_of(name).unwrap_or(Title::Unknown))
            };
            let mut views = names.map(titled);
            tell_first_floor(&mut views);
            views.map(|v| v.kind)
        };
        let both = kinds(["FIRST FLOOR PLAN 1:100", "GROUND FLOOR PLAN 1:100"]);
        assert_eq!(both, [Title::Plan, Title::GroundFloor]);
        let american = kinds(["FIRST FLOOR PLAN", "SECOND FLOOR PLAN"]);
        assert_eq!(american, [Title::GroundFloor, Title::Plan]);
    }

    #[test]
    fn a_view_without_columns_is_worth_less_where_enough_are_drawn() {
        let chosen = |columns: usize, kind: Title| {
            let views = vec![view(1, 60, columns, Title::Unknown), view(2, 100, 0, kind)];
            let mut sheet = Sheet { views, of_wall: Vec::new() };
            choose(&mut sheet, None);
            sheet.views.iter().position(|v| v.is_chosen)
        };
        assert_eq!(chosen(COLUMN_PIECES_MIN, Title::Unknown), Some(0));
        assert_eq!(chosen(COLUMN_PIECES_MIN - 1, Title::Unknown), Some(1));
        assert_eq!(chosen(COLUMN_PIECES_MIN, Title::Plan), Some(1), "what its title says goes first");
    }

    /// Two plans one above the other, each with its title below it: the lower one lies nearer to the title of the upper.
    #[test]
    fn a_title_is_that_of_one_drawing() {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "TEXT".into(), layer: "0".into() };
        let text = |words: &str, y: f64| Text {
            source: source.clone(),
            layer: "0".into(),
            at: DVec2::new(4.0, y),
            text: words.into(),
        };
        let boxes = [[0.0, 9.0], [12.0, 21.0]].map(|[lo, hi]| [DVec2::new(0.0, lo), DVec2::new(14.0, hi)]);
        let named = |texts: &[(&str, f64)]| {
            let texts = texts.iter().map(|(words, y)| text(words, *y)).collect();
            let drawing = Drawing { texts, ..Drawing::of(Vec::new()) };
            titles(&drawing, &boxes, 1.0)
                .into_iter()
                .map(|t| t.map_or(String::new(), |t| t.1))
                .collect::<Vec<_>>()
        };
        let both = named(&[("GROUND FLOOR", -2.5), ("UPPER FLOOR", 11.0)]);
        assert_eq!(both, ["GROUND FLOOR", "UPPER FLOOR"]);
        assert_eq!(named(&[("UPPER FLOOR", 11.0)]), ["", "UPPER FLOOR"]);
        assert_eq!(named(&[("GROUND FLOOR", -2.5), ("UPPER FLOOR", 10.5)]), both, "as near to both");
    }
}
