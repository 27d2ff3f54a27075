//! Several drawings on one sheet: which there are, which are plans, which one is taken.
//!
//! Everything visible is drawn into coarse cells; what hangs together is one drawing. Small pieces
//! belong to the drawing they lie in or beside, so that columns and furniture split nothing.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::by_place::{ByPlace, area, gap, is_in, union, wider};
use super::on_sheet::{OnSheet, middle};
use super::parallels::{Piece, pieces};
use super::repeats::{APART_STOREYS_M, has_storeys};
use super::view_names::{Title, is_first_floor};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity};
use enfilade_cad::plane::box_of;
use enfilade_cad::roles::{Role, role_by_name};

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

/// A mark that covers this share of two drawings, or lies with it in both, says that they are one.
const SPANNED_SHARE: f64 = 0.25;

/// A line this long against the sheet that is no wall is a frame or a construction line.
const FRAME_SHARE: f64 = 0.3;

/// Columns are cut and doors swing in plans alone: where so many of them are drawn in one view, an untitled view without any is
/// worth less by [`NOTHING_CUT`]. Framing and roofs are drawn over the same outline. One arc may be a table, or a sample.
const COLUMN_PIECES_MIN: usize = 16;
const SWINGS_MIN: usize = 2;
const NOTHING_CUT: f64 = 1.0;

/// How often the drawing that is taken is a plan and its box that of one, where its title or that it is alone says so: in
/// 41 of 45 drawings by 24 authors.
pub const BOX_RIGHT: f64 = 0.91;

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
    /// Swings of doors in it.
    pub swings: usize,
    /// What it was judged to be.
    pub kind: Title,
    /// Whether the plan was read from it.
    pub is_chosen: bool,
    /// What it was judged by, in plain words.
    pub why: String,
    /// How sure it is that this is the plan that is meant, with its box, 0 to 1; 0 of one that is not taken.
    pub confidence: f64,
}

impl View {
    /// Whether it shows no rooms from above: what is drawn in it is no wall, door or window of a plan. Where as many doors swing
    /// as in the plan that is read, the title may be another's.
    fn is_no_plan(&self, swings_read: usize) -> bool {
        let is_titled = matches!(self.kind, Title::Outside | Title::NoPlan | Title::Beside);
        is_titled && !self.is_chosen && self.swings < SWINGS_MIN.max(swings_read)
    }
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

/// Which entities are drawn in views that are no plans, and in no other.
pub fn beside_plans(drawing: &Drawing, views: &[View]) -> Vec<bool> {
    let swings_read = views.iter().filter(|v| v.is_chosen).map(|v| v.swings).max().unwrap_or(0);
    let (beside, plans): (Vec<&View>, Vec<&View>) = views.iter().partition(|v| v.is_no_plan(swings_read));
    let lies_in = |of: &[&View], e: &Entity| of.iter().any(|v| is_in(&v.extent)(&middle(&e.shape)));
    drawing.entities.iter().map(|e| lies_in(&beside, e) && !lies_in(&plans, e)).collect()
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
pub fn split<'d>(
    drawing: &'d Drawing,
    walls: &[&'d Entity],
    is_seen: &dyn Fn(&Entity) -> bool,
    (marks, is_told): (&[SheetMark], bool),
    metres_per_unit: f64,
) -> Sheet {
    let on_sheet = OnSheet::new(drawing, walls, metres_per_unit);
    let mut boxes = groups(&on_sheet, parts(drawing, walls, is_seen, &on_sheet));
    if boxes.is_empty() {
        boxes.extend(box_of(walls.iter().flat_map(|w| control_points(&w.shape))));
    }
    if !is_told {
        join_spanned(&on_sheet, &mut boxes, marks);
    }
    let near = NEAR_M / metres_per_unit;
    let places = ByPlace::new(boxes.clone());
    let view_of = |p: DVec2| {
        let distance = |i: usize| gap(&boxes[i], &[p, p]);
        let around =
            places.touching(&wider(&[p, p], 1.01 * near)).into_iter().filter(|i| distance(*i) <= near);
        around.min_by(|i, j| distance(*i).total_cmp(&distance(*j))).unwrap_or(STRAY)
    };
    let of_wall: Vec<usize> = walls.iter().map(|w| view_of(middle(&w.shape))).collect();
    let mut sheet = Sheet { views: views(&on_sheet, &boxes), of_wall, of_mark: Vec::new() };
    count_walls(&mut sheet, walls);
    hug(&mut sheet, walls);
    let boxes: Vec<[DVec2; 2]> = sheet.views.iter().map(|v| v.extent).collect();
    sheet.of_mark = marks.iter().map(|m| m.holder(&boxes)).collect();
    choose(&mut sheet, marks);
    sheet
}

/// Joins the boxes of drawings over which one mark reaches, but for those that their titles say are no plans.
fn join_spanned(on_sheet: &OnSheet<'_>, boxes: &mut Vec<[DVec2; 2]>, marks: &[SheetMark]) {
    if boxes.len() < 2 || marks.is_empty() {
        return;
    }
    let titles = on_sheet.titles(boxes);
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
    let far = raster.parts().into_iter().filter(|p| (p.wall_pieces as f64) < few).map(|p| p.extent);
    let far = ByPlace::new(far.collect());
    let is_far = |p: DVec2| !far.touching(&[p, p]).is_empty();
    walls.iter().map(|w| is_far(middle(&w.shape))).collect()
}

/// What hangs together: box and number of wall pieces.
struct Part {
    extent: [DVec2; 2],
    wall_pieces: usize,
}

/// A piece, with 1 where it draws a wall.
type Drawn = (Piece, usize);

fn parts(
    drawing: &Drawing,
    walls: &[&Entity],
    is_seen: &dyn Fn(&Entity) -> bool,
    on_sheet: &OnSheet<'_>,
) -> Vec<Part> {
    let seen: Vec<&Entity> = drawing.entities.iter().filter(|e| is_seen(e)).collect();
    let all = walls.iter().chain(&seen).flat_map(|e| control_points(&e.shape));
    let Some([lo, hi]) = box_of(all) else { return Vec::new() };
    let extent = (hi - lo).max_element();
    let cell = (CELL_M / on_sheet.metres_per_unit).max(extent / CELLS_MAX);
    let frame = extent * FRAME_SHARE;
    let drawn = pieces(walls.iter().copied()).into_iter().map(|p| (p, 1));
    let others = pieces(seen.iter().copied()).into_iter().filter(|p| p.length() < frame).map(|p| (p, 0));
    let drawn: Vec<Drawn> = drawn.chain(others).collect();
    let places = ByPlace::new(drawn.iter().map(|(p, _)| [p.a.min(p.b), p.a.max(p.b)]).collect());
    let inside = |part: &Part| -> Vec<&Drawn> {
        let is_in = is_in(&part.extent);
        let inside = places.touching(&part.extent).into_iter().map(|i| &drawn[i]);
        inside.filter(|(p, _)| is_in(&p.a) && is_in(&p.b)).collect()
    };
    let nearer = |inside: &[&Drawn]| rastered(inside.iter().copied(), lo, cell / NEARER);
    let one = |part: Part| {
        if on_sheet.says_no_plan_by(&part.extent) {
            parted(on_sheet, nearer(&inside(&part)), part)
        } else {
            vec![part]
        }
    };
    let parts = rastered(drawn.iter(), lo, cell).into_iter();
    parts.flat_map(|part| storeys(on_sheet, &inside(&part), &nearer, part)).flat_map(one).collect()
}

/// A part in which storeys of one building stand side by side as one part each, with what stands nearest to it; any other as
/// it is. `drawn`: the pieces in it, with those of walls counted; `nearer`: these in smaller cells.
fn storeys(
    on_sheet: &OnSheet<'_>,
    drawn: &[&Drawn],
    nearer: &dyn Fn(&[&Drawn]) -> Vec<Part>,
    part: Part,
) -> Vec<Part> {
    if part.wall_pieces < 2 * OWN_PIECES {
        return vec![part];
    }
    // Nothing at all is drawn from one to the other: wings of a building are joined by glass, doors and paving.
    let mut own = nearer(drawn);
    let pieces: Vec<&Piece> = drawn.iter().filter(|(_, walls)| *walls > 0).map(|(p, _)| p).collect();
    own.retain(|p| p.is_own(on_sheet.metres_per_unit));
    // As wide as their walls, without the cells round these.
    let tight = |p: &Part| {
        let is_in = is_in(&p.extent);
        box_of(pieces.iter().flat_map(|w| [w.a, w.b]).filter(|p| is_in(p)))
    };
    let mut boxes: Vec<[DVec2; 2]> = own.iter().filter_map(tight).collect();
    let before = |i: usize, _: usize| 0..i;
    let near = APART_STOREYS_M / on_sheet.metres_per_unit;
    join_all(&mut boxes, before, |a, b| gap(a, b) < near, |joined, gone| *joined = union(joined, &gone));
    if boxes.len() < 2 || !has_storeys(&boxes, &pieces, on_sheet.metres_per_unit) {
        return vec![part];
    }
    let mut out: Vec<Part> = boxes.iter().map(|b| Part { extent: *b, wall_pieces: 0 }).collect();
    for piece in pieces {
        out[nearest(&boxes, piece.a.midpoint(piece.b))].wall_pieces += 1;
    }
    out
}

fn rastered<'a>(drawn: impl Iterator<Item = &'a Drawn>, lo: DVec2, cell: f64) -> Vec<Part> {
    let mut raster = Raster { lo, cell, cells: BTreeMap::new() };
    drawn.for_each(|(piece, walls)| raster.draw(piece.a, piece.b, *walls));
    raster.parts()
}

/// What stands so near together in a part that it seemed one, where a title says that some of it is no plan; `nearer`: it
/// in smaller cells.
fn parted(on_sheet: &OnSheet<'_>, nearer: Vec<Part>, part: Part) -> Vec<Part> {
    let mut rest = nearer;
    let before = |i: usize, _: usize| 0..i;
    join_all(
        &mut rest,
        before,
        |p, q| gap(&p.extent, &q.extent) <= 0.0,
        |joined, gone| {
            joined.extent = union(&joined.extent, &gone.extent);
            joined.wall_pieces += gone.wall_pieces;
        },
    );
    let mut out = Vec::new();
    while let Some(i) = (0..rest.len()).find(|i| is_other(on_sheet, &rest, *i)) {
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
fn is_other(on_sheet: &OnSheet<'_>, parts: &[Part], i: usize) -> bool {
    let others = parts.iter().enumerate().filter(|(j, _)| *j != i);
    let Some(rest) = box_of(others.flat_map(|(_, p)| p.extent)) else { return false };
    let own = &parts[i].extent;
    if parts[i].wall_pieces < APART_PIECES || gap(own, &rest) <= 0.0 || area(own) > area(&rest) {
        return false;
    }
    let is_room = ((own[1] - own[0]) * on_sheet.metres_per_unit).min_element() >= OWN_SIZE_M;
    let kind = |title: &Option<(Title, String)>| title.as_ref().map(|t| t.0);
    let titles = on_sheet.titles(&[*own, rest]);
    match (kind(&titles[0]), kind(&titles[1])) {
        (_, Some(Title::NoPlan | Title::Beside)) => false,
        (Some(Title::Beside), _) => true,
        (Some(Title::NoPlan), _) => is_room,
        _ => false,
    }
}

/// Joins the first of some things that is to be with one of its partners to the first of these, until none is; what was
/// looked at, and has not changed since, is not looked at again.
fn join_all<T>(
    all: &mut Vec<T>,
    partners: impl Fn(usize, usize) -> Range<usize>,
    is_joined: impl Fn(&T, &T) -> bool,
    join: impl Fn(&mut T, T),
) {
    // Those before have no partner, but for the one that has changed.
    let (mut looked, mut changed) = (0, None);
    loop {
        let found = (0..all.len()).find_map(|i| {
            let own = partners(i, all.len());
            let own = match changed {
                Some(j) if i < looked && i != j => own.start.max(j)..own.end.min(j + 1),
                _ => own,
            };
            own.into_iter().find(|j| *j != i && is_joined(&all[i], &all[*j])).map(|j| (i, j))
        });
        let Some((i, j)) = found else { return };
        let gone = all.swap_remove(i);
        let j = if j == all.len() { i } else { j };
        join(&mut all[j], gone);
        (looked, changed) = (i, Some(j));
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
fn groups(on_sheet: &OnSheet<'_>, mut parts: Vec<Part>) -> Vec<[DVec2; 2]> {
    let mut is_apart = apart(on_sheet, &parts).into_iter();
    let mut out: Vec<[DVec2; 2]> = Vec::new();
    parts.retain(|p| {
        let goes = is_apart.next() == Some(true);
        out.extend(goes.then_some(p.extent));
        !goes
    });
    out.extend(floors(on_sheet, &parts, &out));
    out
}

/// Joins parts to drawings, without those that were set apart.
fn floors(on_sheet: &OnSheet<'_>, parts: &[Part], apart: &[[DVec2; 2]]) -> Vec<[DVec2; 2]> {
    let own = parts.iter().filter(|p| p.is_own(on_sheet.metres_per_unit));
    let mut boxes: Vec<[DVec2; 2]> = own.map(|p| p.extent).collect();
    let near = NEAR_M / on_sheet.metres_per_unit;
    if let [only] = boxes[..] {
        let is_beside = |p: &&Part| {
            let distance = gap(&p.extent, &only);
            distance <= near && apart.iter().all(|b| gap(&p.extent, b) >= distance)
        };
        return box_of(parts.iter().filter(is_beside).flat_map(|p| p.extent)).into_iter().collect();
    }
    if boxes.is_empty() {
        return box_of(parts.iter().flat_map(|p| p.extent)).into_iter().collect();
    }
    let is_joined = |a: &[DVec2; 2], b: &[DVec2; 2]| {
        let gap = gap(a, b);
        let is_part = || {
            area(a) < PART_SHARE * area(b)
                && gap < near
                && !on_sheet.has_title_by(a)
                && on_sheet.title_block(a).is_none()
        };
        gap <= 0.0 || is_part()
    };
    join_all(&mut boxes, |_, count| 0..count, is_joined, |joined, gone| *joined = union(joined, &gone));
    boxes
}

/// Which small parts are no floor of the drawing beside them: what its title calls an elevation, a legend or the like, the
/// block of the sheet's title, and what is closed and shows no way in.
fn apart(on_sheet: &OnSheet<'_>, parts: &[Part]) -> Vec<bool> {
    let metres_per_unit = on_sheet.metres_per_unit;
    let (own, others): (Vec<usize>, Vec<usize>) =
        (0..parts.len()).partition(|i| parts[*i].is_own(metres_per_unit));
    let places = ByPlace::new(own.iter().map(|i| parts[*i].extent).collect());
    // Metres to the nearest of those, where one is nearer than it may be.
    let to_own = |extent: &[DVec2; 2]| {
        let near = places.touching(&wider(extent, 1.01 * APART_M / metres_per_unit)).into_iter();
        near.map(|k| gap(extent, &parts[own[k]].extent)).fold(f64::INFINITY, f64::min) * metres_per_unit
    };
    let mut may_be = others;
    may_be.retain(|i| parts[*i].wall_pieces >= APART_PIECES && to_own(&parts[*i].extent) > 0.0);
    let boxes: Vec<[DVec2; 2]> = own.iter().chain(&may_be).map(|i| parts[*i].extent).collect();
    let titles = on_sheet.titles(&boxes);
    let mut out = vec![false; parts.len()];
    for (i, title) in may_be.into_iter().zip(&titles[own.len()..]) {
        let extent = &parts[i].extent;
        let is_no_plan = title.as_ref().is_some_and(|t| matches!(t.0, Title::NoPlan | Title::Beside));
        out[i] = is_no_plan
            || !own.is_empty() && to_own(extent) >= APART_M && on_sheet.is_closed(extent, OWN_SIZE_M);
    }
    // What is left must be a drawing.
    let has_rest = parts.iter().zip(&out).any(|(p, apart)| !apart && p.wall_pieces > 0);
    if has_rest { out } else { vec![false; parts.len()] }
}

fn nearest(boxes: &[[DVec2; 2]], p: DVec2) -> usize {
    let distance = |b: &[DVec2; 2]| gap(b, &[p, p]);
    (0..boxes.len()).min_by(|i, j| distance(&boxes[*i]).total_cmp(&distance(&boxes[*j]))).unwrap_or(0)
}

fn views(on_sheet: &OnSheet<'_>, boxes: &[[DVec2; 2]]) -> Vec<View> {
    let titles = if boxes.len() > 1 { on_sheet.titles(boxes) } else { vec![None] };
    let mut out: Vec<View> = Vec::new();
    for (extent, title) in boxes.iter().zip(titles) {
        let (mut kind, name) = title.unwrap_or((Title::Unknown, String::new()));
        let mut why = if name.is_empty() { "no title by it".into() } else { format!("titled {name:?}") };
        if let Some(layer) = on_sheet.elevation(extent).filter(|_| boxes.len() > 1) {
            (kind, why) = (Title::NoPlan, format!("drawn on layer {layer:?}"));
        }
        let (number, wall_pieces, column_pieces, is_chosen) = (0, 0, 0, false);
        let swings = if boxes.len() > 1 { on_sheet.swings_in(extent) } else { 0 };
        out.push(View {
            number,
            name,
            extent: *extent,
            wall_pieces,
            column_pieces,
            swings,
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
    let mut around: Vec<Option<[DVec2; 2]>> = vec![None; sheet.views.len()];
    for (wall, view) in walls.iter().zip(&sheet.of_wall).filter(|(_, v)| **v != STRAY) {
        let known = around[*view].into_iter().flatten();
        around[*view] = box_of(known.chain(control_points(&wall.shape)));
    }
    for (view, around) in sheet.views.iter_mut().zip(around).filter(|(v, _)| v.wall_pieces >= OWN_PIECES) {
        view.extent = around.unwrap_or(view.extent);
    }
}

/// Marks the view to take: the one with the user's regions, else with most that moves or stays, else the best plan.
fn choose(sheet: &mut Sheet, marks: &[SheetMark]) {
    let most = sheet.views.iter().map(|v| v.wall_pieces).max().unwrap_or(0) as f64;
    let has = |enough: fn(&View) -> bool| sheet.views.iter().any(enough);
    let has_columns = has(|v| v.column_pieces >= COLUMN_PIECES_MIN);
    let has_swings = has(|v| v.swings >= SWINGS_MIN);
    let less = |v: &View, lacks: bool| if lacks && v.kind == Title::Unknown { NOTHING_CUT } else { 0.0 };
    let by_walls = |v: &View| {
        let lacks_columns = has_columns && v.column_pieces == 0;
        v.wall_pieces as f64 / most.max(1.0) + v.kind.worth() - less(v, lacks_columns)
    };
    let score = |v: &View| by_walls(v) - less(v, has_swings && v.swings == 0);
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
    // A mark says which one is meant, and a title what it is; of others those that are worth as much are as likely. That
    // a plan shows no swings decides and convinces nobody: some draw a storey without doors.
    let is_untitled = |v: &View| v.kind == Title::Unknown;
    let weight = |v: &View| match is_untitled(&sheet.views[best]) {
        true if is_untitled(v) => ((by_walls(v) - by_walls(&sheet.views[best])) / WORTH_APART).min(0.0).exp(),
        _ => 0.0,
    };
    let others: f64 = (0..sheet.views.len()).filter(|i| *i != best).map(|i| weight(&sheet.views[i])).sum();
    sheet.views[best].confidence = if marks.is_empty() { BOX_RIGHT / (1.0 + others) } else { 1.0 };
    sheet.views[best].is_chosen = true;
}

#[cfg(test)]
mod tests {
    use super::super::by_place::looked;
    use super::super::view_names::title_of;
    use super::*;
    use enfilade_cad::drawing::{Editable, Shape, SourceRef};

    fn view(number: usize, wall_pieces: usize, column_pieces: usize, kind: Title) -> View {
        View {
            number,
            name: String::new(),
            extent: [DVec2::ZERO, DVec2::ONE],
            wall_pieces,
            column_pieces,
            swings: 0,
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

    #[test]
    fn a_view_without_doors_is_worth_less_where_enough_are_drawn() {
        let chosen = |swings: usize, kind: Title| {
            let views = vec![View { swings, ..view(1, 60, 0, Title::Unknown) }, view(2, 100, 0, kind)];
            let mut sheet = Sheet { views, of_wall: Vec::new(), of_mark: Vec::new() };
            choose(&mut sheet, &[]);
            let taken = sheet.views.iter().position(|v| v.is_chosen);
            (taken, taken.map(|k| sheet.views[k].confidence < 0.5))
        };
        assert_eq!(chosen(SWINGS_MIN, Title::Unknown), (Some(0), Some(true)), "it is asked");
        assert_eq!(chosen(SWINGS_MIN - 1, Title::Unknown).0, Some(1));
        assert_eq!(chosen(SWINGS_MIN, Title::Plan).0, Some(1), "what its title says goes first");
    }

    /// As looking at all pairs again after every joining.
    #[test]
    fn what_was_looked_at_is_joined_no_otherwise() {
        let meets = |a: &[u32; 2], b: &[u32; 2]| a[0] <= b[1] && b[0] <= a[1];
        let join = |into: &mut [u32; 2], gone: [u32; 2]| *into = [into[0].min(gone[0]), into[1].max(gone[1])];
        // Larger than the other half of what it meets, so that it matters which of two joins which.
        let is_less = |a: &[u32; 2], b: &[u32; 2]| meets(a, b) && a[1] - a[0] <= b[1] - b[0];
        for k in 0..60_u32 {
            let from = |i: u32| (i * 7919 + k * 104_729) % (40 + 20 * k);
            let made: Vec<[u32; 2]> = (0..40).map(|i| [from(i), from(i) + (i * i + k) % 23]).collect();
            let plain = |partners: fn(usize, usize) -> Range<usize>| {
                let mut all = made.clone();
                while let Some((i, j)) = (0..all.len()).find_map(|i| {
                    let own = partners(i, all.len()).filter(|j| *j != i);
                    own.into_iter().find(|j| is_less(&all[i], &all[*j])).map(|j| (i, j))
                }) {
                    let gone = all[i];
                    join(&mut all[j], gone);
                    all.swap_remove(i);
                }
                all
            };
            for partners in [|i, _| 0..i, |_, n| 0..n] as [fn(usize, usize) -> Range<usize>; 2] {
                let mut all = made.clone();
                join_all(&mut all, partners, is_less, join);
                assert_eq!(all, plain(partners), "{k}");
            }
        }
    }

    /// Drawings of a field are held against each other, never their walls: 200,000 of these took an hour.
    #[test]
    fn no_wall_is_held_against_all_others() {
        let line = |at: DVec2, to: DVec2| Entity {
            source: SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: "WALL".into() },
            layer: "WALL".into(),
            shape: Shape::Line { a: at, b: at + to },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        };
        // Rooms of four walls, 30 m apart.
        let room = |i: usize, side: usize| {
            let lo = DVec2::new((i % side) as f64, (i / side) as f64) * 30.0;
            let wall = move |from: [f64; 2], to: [f64; 2]| {
                let (from, to) = (DVec2::from(from), DVec2::from(to));
                [0.0, 0.2].map(|d| line(lo + from + to.perp().normalize() * d, to))
            };
            [
                ([0.0, 0.0], [6.0, 0.0]),
                ([6.0, 0.0], [0.0, 5.0]),
                ([6.0, 5.0], [-6.0, 0.0]),
                ([0.0, 5.0], [0.0, -5.0]),
            ]
            .into_iter()
            .flat_map(move |(from, to)| wall(from, to))
        };
        let side = 50;
        let drawing = Drawing::of((0..side * side).flat_map(|i| room(i, side)).collect());
        let walls: Vec<&Entity> = drawing.entities.iter().collect();
        looked::pairs();
        let sheet = split(&drawing, &walls, &|_| true, (&[], false), 1.0);
        let (views, pairs) = (sheet.views.len(), looked::pairs());
        assert_eq!(views, side * side);
        // Eight walls a room held against all others would be 32 times as many.
        assert!(0 < pairs && pairs < 2 * views * views, "{pairs}");
    }
}
