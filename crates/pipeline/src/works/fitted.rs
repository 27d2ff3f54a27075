//! The leaf of a new door and the panes of new glass, drawn as the drawing's own are.

use glam::DVec2;

use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Edit, Editable, Shape};
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

/// The leaf of a new door with its swing; `None` where the drawing has no door drawn so.
pub(super) fn leaf(base: &Understood, drawing: &Drawing, walls: &[Wall], work: &Work) -> Option<Edit> {
    let record = like(base, drawing, OpeningKind::Door)?;
    let wall = walls.get(work.walls.first()?.0)?;
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
    let record = like(base, drawing, OpeningKind::Window)?;
    let wall = walls.get(work.walls.first()?.0)?;
    let [p, q] = work.stretch;
    let off = wall.along.perp() * (wall.thickness_m * PANE_SHARE);
    let line = |by: DVec2| Shape::Line {
        a: base.plan.frame.file_from_plan(p + by),
        b: base.plan.frame.file_from_plan(q + by),
    };
    let shapes = if wall.thickness_m > 0.0 { vec![line(off), line(-off)] } else { vec![line(DVec2::ZERO)] };
    Some(Edit::Build { record, shapes })
}
