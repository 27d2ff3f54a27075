//! The leaf of a new door and the panes of new glass, drawn as the drawing's own are.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Edit, Editable, RigidMotion, Shape};
use enfilade_plan::axes::{Opening, OpeningKind};
use enfilade_works::Work;
use enfilade_works::walls::Wall;

/// Panes lie so far from the axis, as a share of the thickness.
const PANE_SHARE: f64 = 1.0 / 6.0;

/// An entity that shows such an opening, a line or a block: what is drawn anew has its layer and its looks.
fn like(base: &Understood, drawing: &Drawing, kind: OpeningKind) -> Option<usize> {
    let of = |o: &Opening| {
        let marks = o.marks.iter().filter_map(|m| drawing.entities.get(*base.marked.get(*m as usize)?));
        let mut shown = marks.filter(|e| !matches!(e.editable, Editable::No(_)));
        shown.next().map(|e| e.source.record)
    };
    base.axes.openings.iter().filter(|o| o.kind == kind).find_map(of)
}

/// A block fits where width and thickness differ by no more, metres of a person.
const FITS_M: f64 = 0.01;

/// The drawing's own block of a door or a window of the same width in a wall as thick, as it would stand in a new opening;
/// `None` where it has none.
fn block(
    base: &Understood,
    drawing: &Drawing,
    (wall, work): (&Wall, &Work),
    kind: OpeningKind,
) -> Option<Edit> {
    let (plan, scale) = (&base.plan, base.plan.human_scale);
    let [p, q] = work.stretch;
    let is_near = |a: f64, b: f64| (a - b).abs() <= FITS_M * scale;
    let fits = |o: &&Opening| {
        o.kind == kind
            && is_near(o.width_m * scale, p.distance(q))
            && is_near(o.thickness_m * scale, wall.thickness_m)
    };
    let of = |o: &Opening| {
        let entities = o.marks.iter().filter_map(|m| drawing.entities.get(*base.marked.get(*m as usize)?));
        let records: BTreeSet<usize> = entities
            .filter(|e| e.editable == Editable::WithInsert { turnable: true })
            .map(|e| e.source.record)
            .collect();
        // One block shows the whole of it.
        let (Some(record), true) = (records.first(), records.len() == 1) else { return None };
        let [a, b] = o.jambs.map(|j| plan.frame.file_from_plan(j.at * scale));
        let [c, d] = [p, q].map(|x| plan.frame.file_from_plan(x));
        let turn_rad = (b - a).angle_to(d - c);
        let shift = (c + d) / 2.0 - DVec2::from_angle(turn_rad).rotate((a + b) / 2.0);
        Some(Edit::Copy { record: *record, motion: RigidMotion { turn_rad, shift } })
    };
    base.axes.openings.iter().filter(fits).find_map(of)
}

/// The leaf of a new door with its swing; `None` where the drawing has no door drawn so.
pub(super) fn leaf(base: &Understood, drawing: &Drawing, walls: &[Wall], work: &Work) -> Option<Edit> {
    let wall = walls.get(work.walls.first()?.0)?;
    if let Some(own) = block(base, drawing, (wall, work), OpeningKind::Door) {
        return Some(own);
    }
    let record = like(base, drawing, OpeningKind::Door)?;
    let [p, q] = work.stretch;
    let along = (q - p).try_normalize()?;
    // Hung on the jamb nearer to the wall's end: open, the leaf lies before a wall.
    let from_start = |x: DVec2| (x - wall.at).dot(wall.along);
    let near = |x: DVec2| from_start(x).min(wall.length_m - from_start(x));
    let (hinge, to_lock) = if near(p) <= near(q) { (p, along) } else { (q, -along) };
    // Into a room rather than into what leads to it: the smaller side of the two is passed through.
    let side = if work.rooms[0].is_some() || work.rooms[1].is_none() { -1.0 } else { 1.0 };
    let into = wall.along.perp() * side;
    let at = hinge + into * (wall.thickness_m / 2.0);
    let width = p.distance(q);
    let frame = &base.plan.frame;
    let [centre, tip] = [at, at + into * width].map(|x| frame.file_from_plan(x));
    let radius = centre.distance(tip);
    let [open, shut] = [into, to_lock].map(|d| d.y.atan2(d.x));
    let is_left = to_lock.perp_dot(into) > 0.0;
    let (start_rad, end_rad) = if is_left { (shut, open) } else { (open, shut) };
    let shapes = vec![Shape::Line { a: centre, b: tip }, Shape::Arc { centre, radius, start_rad, end_rad }];
    Some(Edit::Build { record, shapes })
}

/// The panes of new glass between its jambs; `None` where the drawing has no window drawn so.
pub(super) fn panes(base: &Understood, drawing: &Drawing, walls: &[Wall], work: &Work) -> Option<Edit> {
    let wall = walls.get(work.walls.first()?.0)?;
    if let Some(own) = block(base, drawing, (wall, work), OpeningKind::Window) {
        return Some(own);
    }
    let record = like(base, drawing, OpeningKind::Window)?;
    let [p, q] = work.stretch;
    let off = wall.along.perp() * (wall.thickness_m * PANE_SHARE);
    let line = |by: DVec2| Shape::Line {
        a: base.plan.frame.file_from_plan(p + by),
        b: base.plan.frame.file_from_plan(q + by),
    };
    let shapes = if wall.thickness_m > 0.0 { vec![line(off), line(-off)] } else { vec![line(DVec2::ZERO)] };
    Some(Edit::Build { record, shapes })
}
