//! Several drawings on one sheet: which there are, which are plans, which one is taken.
//!
//! Everything visible is drawn into coarse cells; what hangs together is one drawing. Small pieces
//! belong to the drawing they lie in or beside, so that columns and furniture split nothing.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use glam::DVec2;

use super::curve::control_points;
use super::drawing::{Drawing, Entity, Shape, Text};
use super::parallels::{Piece, pieces};
use super::roles::{Role, role_by_name};
use super::view_names::{Title, is_first_floor, is_of_title_block, title_of};
use super::{box_of, distance_to_segment};

/// Side of a cell, metres: drawings on a sheet stand farther apart than one to two of these, the parts
/// of one building that do are joined by [`NEAR_M`].
const CELL_M: f64 = 1.5;

/// How many times smaller the cells are in which drawings are told apart where titles say that there are several.
const NEARER: f64 = 4.0;

/// Cells along the longer side at most; keeps the raster small where the drawing is huge.
const CELLS_MAX: f64 = 4_000.0;

/// A drawing of its own has walls of at least this many pieces and is this large both ways.
const OWN_PIECES: usize = 8;
const OWN_SIZE_M: f64 = 3.0;

/// What is smaller than this share of the drawing that it is nearer to than this is a part of it (a garage
/// beside the house), unless a title of its own stands by it.
const PART_SHARE: f64 = 0.25;
const NEAR_M: f64 = 8.0;

/// Fewest straight pieces of walls in what is set apart from the drawing beside it: fewer outline nothing.
const APART_PIECES: usize = 4;
/// So far from a building nothing is a part of it that is closed and shows no door, metres.
const APART_M: f64 = 2.0;
/// Lines that end nearer to others than this are closed, metres.
const SAME_M: f64 = 0.01;
/// Radii of the swings of doors, metres.
const SWING_M: RangeInclusive<f64> = 0.5..=1.4;

/// Legends, key plans and title blocks are smaller than this share of the largest drawing.
const BESIDE_SHARE: f64 = 0.4;

/// A mark that covers this share of two drawings, or lies with it in both, says that they are one.
const SPANNED_SHARE: f64 = 0.25;

/// A line this long against the sheet that is no wall is a frame or a construction line.
const FRAME_SHARE: f64 = 0.3;

/// Titles are looked for this far around a drawing, metres.
const TITLE_M: f64 = 4.0;

/// Columns are cut in plans alone: where so many pieces of them are drawn in one view, an untitled view without any is
/// worth less by [`NO_COLUMNS`].
const COLUMN_PIECES_MIN: usize = 16;
const NO_COLUMNS: f64 = 1.0;

/// How often the drawing that is taken is a plan and its box that of one, where its title or that it is alone says so: in
/// 41 of 45 drawings by 24 authors.
const BOX_RIGHT: f64 = 0.91;

/// Of several without titles one that is worth so much less than another is the plan that is meant e times less often: one
/// with 0.7 of the walls of the other in 27 % of cases.
const WORTH_APART: f64 = 0.3;

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
    /// How sure it is that this is the plan that is meant, with its box, 0 to 1; 0 of one that is not taken.
    pub confidence: f64,
}

/// What a mark of the user says, the one with the most say last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MarkKind {
    /// What stays.
    Keep,
    /// What moves.
    Move,
    /// Where is measured.
    Region,
}

/// A mark of the user.
#[derive(Clone, Debug, PartialEq)]
pub struct SheetMark {
    /// Box, drawing units.
    pub extent: [DVec2; 2],
    /// What it says.
    pub kind: MarkKind,
}

impl SheetMark {
    fn common(&self, other: &[DVec2; 2]) -> f64 {
        let [lo, hi] = [self.extent[0].max(other[0]), self.extent[1].min(other[1])];
        (hi - lo).max(DVec2::ZERO).element_product()
    }

    /// The box it lies in: of those that it covers parts of the one of which it covers the most, else the nearest.
    fn holder(&self, boxes: &[[DVec2; 2]]) -> usize {
        let covers = (0..boxes.len()).rev().filter(|i| self.common(&boxes[*i]) > 0.0);
        let most = covers.max_by(|i, j| self.common(&boxes[*i]).total_cmp(&self.common(&boxes[*j])));
        most.unwrap_or_else(|| nearest(boxes, self.extent[0].midpoint(self.extent[1])))
    }

    /// Whether so much of it lies in a box, or so much of the box in it, that it speaks of that drawing.
    fn spans(&self, other: &[DVec2; 2]) -> bool {
        let common = self.common(other);
        common > 0.0 && common >= SPANNED_SHARE * area(&self.extent).min(area(other))
    }
}

/// The drawings of a sheet and which wall lies in which.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// The drawings in reading order.
    pub views: Vec<View>,
    /// For each wall the index of its view; [`STRAY`] where it lies far from every drawing.
    pub of_wall: Vec<usize>,
    /// For each mark the index of its view.
    pub of_mark: Vec<usize>,
}

/// Splits a sheet. `walls` are the entities taken as walls, `is_seen` says which others count. Drawings over which one
/// of the `marks` reaches are one, unless the user says which drawing is meant (`is_told`).
pub fn split(
    drawing: &Drawing,
    walls: &[&Entity],
    is_seen: &dyn Fn(&Entity) -> bool,
    (marks, is_told): (&[SheetMark], bool),
    metres_per_unit: f64,
) -> Sheet {
    let parts = parts(drawing, walls, is_seen, metres_per_unit);
    let mut boxes = groups(drawing, walls, parts, metres_per_unit);
    if boxes.is_empty() {
        boxes.extend(box_of(walls.iter().flat_map(|w| control_points(&w.shape))));
    }
    if !is_told {
        join_spanned(drawing, &mut boxes, marks, metres_per_unit);
    }
    let near = NEAR_M / metres_per_unit;
    let view_of = |p: DVec2| {
        let i = nearest(&boxes, p);
        if boxes.get(i).is_some_and(|b| gap(b, &[p, p]) > near) { STRAY } else { i }
    };
    let of_wall: Vec<usize> = walls.iter().map(|w| view_of(middle(&w.shape))).collect();
    let mut sheet = Sheet { views: views(drawing, &boxes, metres_per_unit), of_wall, of_mark: Vec::new() };
    count_walls(&mut sheet, walls);
    hug(&mut sheet, walls);
    let boxes: Vec<[DVec2; 2]> = sheet.views.iter().map(|v| v.extent).collect();
    sheet.of_mark = marks.iter().map(|m| m.holder(&boxes)).collect();
    choose(&mut sheet, marks);
    sheet
}

/// Joins the boxes of drawings over which one mark reaches, but for those that their titles say are no plans.
fn join_spanned(drawing: &Drawing, boxes: &mut Vec<[DVec2; 2]>, marks: &[SheetMark], metres_per_unit: f64) {
    if boxes.len() < 2 || marks.is_empty() {
        return;
    }
    let titles = titles(drawing, boxes, metres_per_unit);
    let is_plan = |t: &Option<(Title, String)>| {
        !t.as_ref().is_some_and(|t| matches!(t.0, Title::NoPlan | Title::Beside))
    };
    let mut plans: Vec<[DVec2; 2]> =
        boxes.iter().zip(&titles).filter(|(_, t)| is_plan(t)).map(|(b, _)| *b).collect();
    let mut joined =
        boxes.iter().zip(&titles).filter(|(_, t)| !is_plan(t)).map(|(b, _)| *b).collect::<Vec<_>>();
    for mark in marks {
        let (spanned, rest): (Vec<_>, Vec<_>) = plans.iter().partition(|b| mark.spans(b));
        if spanned.len() > 1 {
            plans = rest;
            plans.extend(box_of(spanned.into_iter().flatten()));
        }
    }
    joined.extend(plans);
    *boxes = joined;
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
    let frame = extent * FRAME_SHARE;
    let drawn = pieces(walls.iter().copied()).into_iter().map(|p| (p, 1));
    let others = pieces(seen.iter().copied()).into_iter().filter(|p| p.length() < frame).map(|p| (p, 0));
    let drawn: Vec<(Piece, usize)> = drawn.chain(others).collect();
    let parts = rastered(drawn.iter(), lo, cell);
    parts.into_iter().flat_map(|p| parted(drawing, p, &drawn, (lo, cell), metres_per_unit)).collect()
}

fn rastered<'a>(drawn: impl Iterator<Item = &'a (Piece, usize)>, lo: DVec2, cell: f64) -> Vec<Part> {
    let mut raster = Raster { lo, cell, cells: BTreeMap::new() };
    drawn.for_each(|(piece, walls)| raster.draw(piece.a, piece.b, *walls));
    raster.parts()
}

/// A part, or what stands so near together in it that it seemed one: where a title says that some of it is no plan, it is
/// looked at in smaller cells.
fn parted(
    drawing: &Drawing,
    part: Part,
    drawn: &[(Piece, usize)],
    (lo, cell): (DVec2, f64),
    metres_per_unit: f64,
) -> Vec<Part> {
    let reach = TITLE_M / metres_per_unit;
    let says = |t: &Text| {
        matches!(title_of(&t.text), Some(Title::NoPlan | Title::Beside)) || is_of_title_block(&t.text)
    };
    if !drawing.texts.iter().any(|t| gap(&part.extent, &[t.at, t.at]) <= reach && says(t)) {
        return vec![part];
    }
    let is_in = |p: DVec2| p.cmpge(part.extent[0]).all() && p.cmple(part.extent[1]).all();
    let inside = drawn.iter().filter(|(p, _)| is_in(p.a) && is_in(p.b));
    let mut rest = overlapping_joined(rastered(inside, lo, cell / NEARER));
    let mut out = Vec::new();
    while let Some(i) = (0..rest.len()).find(|i| is_other(drawing, &rest, *i, metres_per_unit)) {
        out.push(rest.swap_remove(i));
    }
    let wall_pieces = rest.iter().map(|p| p.wall_pieces).sum();
    let extent = match out.is_empty() {
        true => Some(part.extent),
        false => box_of(rest.iter().flat_map(|p| p.extent)),
    };
    out.extend(extent.map(|extent| Part { extent, wall_pieces }));
    out
}

/// Whether one of some parts stands clear of the others and is by its own title what they are not.
fn is_other(drawing: &Drawing, parts: &[Part], i: usize, metres_per_unit: f64) -> bool {
    let others = parts.iter().enumerate().filter(|(j, _)| *j != i);
    let Some(rest) = box_of(others.flat_map(|(_, p)| p.extent)) else { return false };
    let own = &parts[i].extent;
    if parts[i].wall_pieces < APART_PIECES || gap(own, &rest) <= 0.0 || area(own) > area(&rest) {
        return false;
    }
    let is_room = ((own[1] - own[0]) * metres_per_unit).min_element() >= OWN_SIZE_M;
    let kind = |title: &Option<(Title, String)>| title.as_ref().map(|t| t.0);
    let titles = titles(drawing, &[*own, rest], metres_per_unit);
    match (kind(&titles[0]), kind(&titles[1])) {
        (_, Some(Title::NoPlan | Title::Beside)) => false,
        (Some(Title::Beside), _) => true,
        (Some(Title::NoPlan), _) => is_room,
        _ => false,
    }
}

/// Joins parts whose boxes overlap.
fn overlapping_joined(mut parts: Vec<Part>) -> Vec<Part> {
    loop {
        let over = (0..parts.len())
            .find_map(|i| (0..i).find(|j| gap(&parts[i].extent, &parts[*j].extent) <= 0.0).map(|j| (i, j)));
        let Some((i, j)) = over else { return parts };
        let gone = parts.swap_remove(i);
        let joined = &mut parts[j];
        joined.extent = [joined.extent[0].min(gone.extent[0]), joined.extent[1].max(gone.extent[1])];
        joined.wall_pieces += gone.wall_pieces;
    }
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

impl Part {
    /// Whether it is as large as a drawing.
    fn is_own(&self, metres_per_unit: f64) -> bool {
        let size = (self.extent[1] - self.extent[0]) * metres_per_unit;
        self.wall_pieces >= OWN_PIECES && size.min_element() >= OWN_SIZE_M
    }
}

/// Joins parts to whole drawings; their boxes. What is no floor of any comes first: it keeps what lies in its box.
fn groups(
    drawing: &Drawing,
    walls: &[&Entity],
    mut parts: Vec<Part>,
    metres_per_unit: f64,
) -> Vec<[DVec2; 2]> {
    let is_apart = apart(drawing, walls, &parts, metres_per_unit);
    let mut is_apart = is_apart.into_iter();
    let mut out: Vec<[DVec2; 2]> = Vec::new();
    parts.retain(|p| {
        let goes = is_apart.next() == Some(true);
        out.extend(goes.then_some(p.extent));
        !goes
    });
    out.extend(floors(drawing, &parts, &out, metres_per_unit));
    out
}

/// Joins parts to drawings, without those that were set apart.
fn floors(drawing: &Drawing, parts: &[Part], apart: &[[DVec2; 2]], metres_per_unit: f64) -> Vec<[DVec2; 2]> {
    let own = parts.iter().filter(|p| p.is_own(metres_per_unit));
    let mut boxes: Vec<[DVec2; 2]> = own.map(|p| p.extent).collect();
    let near = NEAR_M / metres_per_unit;
    if let [only] = boxes[..] {
        let reach = |p: &Part| apart.iter().map(|b| gap(&p.extent, b)).fold(near, f64::min);
        let beside = parts.iter().filter(|p| gap(&p.extent, &only) <= reach(p));
        return box_of(beside.flat_map(|p| p.extent)).into_iter().collect();
    }
    if boxes.is_empty() {
        return box_of(parts.iter().flat_map(|p| p.extent)).into_iter().collect();
    }
    loop {
        let joined = (0..boxes.len()).find_map(|i| {
            let other = (0..boxes.len()).find(|&j| {
                let gap = gap(&boxes[i], &boxes[j]);
                let is_part = area(&boxes[i]) < PART_SHARE * area(&boxes[j])
                    && gap < near
                    && !has_title_near(drawing, &boxes[i], metres_per_unit)
                    && title_block(drawing, &boxes[i]).is_none();
                i != j && (gap <= 0.0 || is_part)
            })?;
            Some((i, other))
        });
        let Some((i, j)) = joined else { return boxes };
        boxes[j] = [boxes[i][0].min(boxes[j][0]), boxes[i][1].max(boxes[j][1])];
        boxes.swap_remove(i);
    }
}

/// Which small parts are no floor of the drawing beside them: what its title calls an elevation, a legend or the like, the
/// block of the sheet's title, and what is closed and shows no way in.
fn apart(drawing: &Drawing, walls: &[&Entity], parts: &[Part], metres_per_unit: f64) -> Vec<bool> {
    let is_own: Vec<bool> = parts.iter().map(|p| p.is_own(metres_per_unit)).collect();
    let to_own = |p: &Part| {
        let own = parts.iter().zip(&is_own).filter(|(_, own)| **own);
        own.map(|(q, _)| gap(&p.extent, &q.extent)).fold(f64::INFINITY, f64::min) * metres_per_unit
    };
    let may_be: Vec<usize> = (0..parts.len())
        .filter(|i| !is_own[*i] && parts[*i].wall_pieces >= APART_PIECES && to_own(&parts[*i]) > 0.0)
        .collect();
    let listed: Vec<usize> = (0..parts.len()).filter(|i| is_own[*i]).chain(may_be.iter().copied()).collect();
    let boxes: Vec<[DVec2; 2]> = listed.iter().map(|i| parts[*i].extent).collect();
    let titles = titles(drawing, &boxes, metres_per_unit);
    let is_no_plan = |i: usize| {
        let k = listed.iter().position(|j| *j == i);
        let title = k.and_then(|k| titles[k].as_ref());
        title.is_some_and(|t| matches!(t.0, Title::NoPlan | Title::Beside))
    };
    let mut out = vec![false; parts.len()];
    for i in may_be {
        let part = &parts[i];
        let distance = to_own(part);
        let is_body = distance.is_finite()
            && distance >= APART_M
            && is_closed(drawing, walls, &part.extent, metres_per_unit);
        out[i] = is_no_plan(i) || is_body;
    }
    // What is left must be a drawing.
    let has_rest = parts.iter().zip(&out).any(|(p, apart)| !apart && p.wall_pieces > 0);
    if has_rest { out } else { vec![false; parts.len()] }
}

/// Whether all lines of walls in a box as large as a room end at others, and none is a door there.
fn is_closed(drawing: &Drawing, walls: &[&Entity], extent: &[DVec2; 2], metres_per_unit: f64) -> bool {
    let tight = tight(drawing, extent);
    if ((tight[1] - tight[0]) * metres_per_unit).min_element() < OWN_SIZE_M {
        return false;
    }
    let is_in = |p: &DVec2| p.cmpge(extent[0]).all() && p.cmple(extent[1]).all();
    let lines: Vec<Piece> =
        pieces(walls.iter().copied()).into_iter().filter(|p| is_in(&p.a) && is_in(&p.b)).collect();
    let same = SAME_M / metres_per_unit;
    let ends_at = |i: usize, p: DVec2| {
        let others = lines.iter().enumerate().filter(|(j, _)| *j != i);
        others.into_iter().any(|(_, q)| distance_to_segment(p, [q.a, q.b]) <= same)
    };
    let is_door = |e: &Entity| {
        let named = e.blocks.iter().map(String::as_str).chain([e.layer.as_str()]);
        let swings = match e.shape {
            Shape::Arc { radius, .. } => SWING_M.contains(&(radius * metres_per_unit)),
            _ => false,
        };
        swings || named.map(|n| role_by_name(n).0).any(|r| r == Role::Door)
    };
    let mut inside = drawing.entities.iter().filter(|e| is_in(&middle(&e.shape)));
    (0..lines.len()).all(|i| ends_at(i, lines[i].a) && ends_at(i, lines[i].b)) && !inside.any(is_door)
}

fn area([lo, hi]: &[DVec2; 2]) -> f64 {
    (hi - lo).element_product()
}

/// Distance of two boxes, 0 where they overlap.
pub(super) fn gap(a: &[DVec2; 2], b: &[DVec2; 2]) -> f64 {
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
    let largest = boxes.iter().map(area).fold(0.0, f64::max);
    let is_small = |b: usize| area(&boxes[b]) < BESIDE_SHARE * largest;
    let mut near: Vec<(f64, usize, usize)> = pairs
        .filter(|(b, t)| texts[*t].0 != Title::Beside || is_small(*b))
        .map(|(b, t)| (far(b, t), b, t))
        .filter(|p| p.0 <= reach)
        .collect();
    // Where two drawings are as near, it stands under one of them.
    let is_over = |b: usize, t: usize| texts[t].1.at.y > boxes[b][0].midpoint(boxes[b][1]).y;
    near.sort_by(|p, q| p.0.total_cmp(&q.0).then(is_over(p.1, p.2).cmp(&is_over(q.1, q.2))));
    let mut out = vec![None; boxes.len()];
    let mut is_taken = vec![false; texts.len()];
    for (_, b, t) in near {
        if out[b].is_none() && !is_taken[t] {
            is_taken[t] = true;
            let (kind, text) = texts[t];
            out[b] = Some((kind, first_line(text)));
        }
    }
    for b in (0..boxes.len()).filter(|b| is_small(*b)) {
        if out[b].is_none() {
            out[b] = title_block(drawing, &boxes[b]).map(|words| (Title::Beside, words));
        }
    }
    out
}

fn first_line(text: &Text) -> String {
    text.text.trim().lines().next().unwrap_or_default().to_owned()
}

/// What stands in a box that only the title of a whole sheet says.
fn title_block(drawing: &Drawing, [lo, hi]: &[DVec2; 2]) -> Option<String> {
    let is_in = |t: &&Text| t.at.cmpge(*lo).all() && t.at.cmple(*hi).all();
    drawing.texts.iter().filter(is_in).find(|t| is_of_title_block(&t.text)).map(first_line)
}

fn views(drawing: &Drawing, boxes: &[[DVec2; 2]], metres_per_unit: f64) -> Vec<View> {
    let titles = if boxes.len() > 1 { titles(drawing, boxes, metres_per_unit) } else { vec![None] };
    let mut out: Vec<View> = Vec::new();
    for (extent, title) in boxes.iter().zip(titles) {
        let (kind, name) = title.unwrap_or((Title::Unknown, String::new()));
        let why = if name.is_empty() { "no title by it".into() } else { format!("titled {name:?}") };
        let (number, wall_pieces, column_pieces, is_chosen) = (0, 0, 0, false);
        out.push(View {
            number,
            name,
            extent: *extent,
            wall_pieces,
            column_pieces,
            kind,
            is_chosen,
            why,
            confidence: 0.0,
        });
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

/// Takes as the box of every drawing that of its walls, without the cells round it and what is noted beside it. A drawing
/// of few walls is more than these show.
fn hug(sheet: &mut Sheet, walls: &[&Entity]) {
    let of_wall = &sheet.of_wall;
    for (i, view) in sheet.views.iter_mut().enumerate().filter(|(_, v)| v.wall_pieces >= OWN_PIECES) {
        let own = walls.iter().zip(of_wall).filter(|(_, v)| **v == i).map(|(w, _)| *w);
        view.extent = box_of(own.flat_map(|w| control_points(&w.shape))).unwrap_or(view.extent);
    }
}

/// Marks the view to take: the one with the user's regions, else with most that moves or stays, else the best plan.
fn choose(sheet: &mut Sheet, marks: &[SheetMark]) {
    let most = sheet.views.iter().map(|v| v.wall_pieces).max().unwrap_or(0) as f64;
    let has_columns = sheet.views.iter().any(|v| v.column_pieces >= COLUMN_PIECES_MIN);
    let score = |v: &View| {
        let lacks_columns = has_columns && v.column_pieces == 0 && v.kind == Title::Unknown;
        v.wall_pieces as f64 / most.max(1.0) + v.kind.worth() - if lacks_columns { NO_COLUMNS } else { 0.0 }
    };
    let marked = |view: usize| {
        let own = || marks.iter().zip(&sheet.of_mark).filter(|(_, v)| **v == view).map(|(m, _)| m.kind);
        [MarkKind::Region, MarkKind::Move, MarkKind::Keep].map(|kind| own().filter(|k| *k == kind).count())
    };
    let order = (0..sheet.views.len()).rev();
    let best = match marks.is_empty() {
        false => order.max_by_key(|v| marked(*v)),
        true => order.max_by(|a, b| score(&sheet.views[*a]).total_cmp(&score(&sheet.views[*b]))),
    };
    let Some(best) = best else { return };
    // A mark says which one is meant, and a title what it is; of others those that are worth as much are as likely.
    let is_untitled = |v: &View| v.kind == Title::Unknown;
    let weight = |v: &View| match is_untitled(&sheet.views[best]) {
        true if is_untitled(v) => ((score(v) - score(&sheet.views[best])) / WORTH_APART).exp(),
        _ => 0.0,
    };
    let others: f64 = (0..sheet.views.len()).filter(|i| *i != best).map(|i| weight(&sheet.views[i])).sum();
    sheet.views[best].confidence = if marks.is_empty() { BOX_RIGHT / (1.0 + others) } else { 1.0 };
    sheet.views[best].is_chosen = true;
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
            confidence: 1.0,
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
            let mut sheet = Sheet { views, of_wall: Vec::new(), of_mark: Vec::new() };
            choose(&mut sheet, &[]);
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
