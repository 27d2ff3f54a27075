//! The leaf of a new door and the pane of new glass, drawn as the drawing's own are.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Edit, Editable, Entity, EntityWork, RigidMotion, Shape};
use enfilade_plan::Plan;
use enfilade_plan::axes::{Opening, OpeningKind};
use enfilade_plan::fittings::is_near;
use enfilade_works::walls::Wall;
use enfilade_works::{Work, WorkKind};

/// A block fits an opening of which neither width nor thickness differs by more, metres of a person: a tenth of the step of
/// places ([`STEP_M`](enfilade_works::counts::STEP_M)).
const FITS_M: f64 = enfilade_works::counts::STEP_M / 10.0;

/// What draws an opening: leaves, swings, frames, panes; not what only runs past it.
pub(super) fn shown<'a>(
    base: &'a Understood,
    drawing: &'a Drawing,
    opening: &'a Opening,
) -> impl Iterator<Item = &'a Entity> {
    let entity = |m: &u32| base.marked.get(*m as usize).and_then(|e| drawing.entities.get(*e));
    opening.marks.iter().filter_map(entity).filter(|e| is_near(&base.plan, e, opening))
}

/// The leaf or the pane of a work that has one; `None` where the drawing shows no door or window whose like could be drawn.
pub(super) fn fitting(base: &Understood, drawing: &Drawing, walls: &[Wall], work: &Work) -> Option<Edit> {
    let kind = match work.kind {
        WorkKind::Door | WorkKind::Rehang => OpeningKind::Door,
        WorkKind::Glaze => OpeningKind::Window,
        _ => return None,
    };
    let wall = walls.get(work.walls.first()?.0)?;
    let own = base.axes.openings.iter().filter(|o| o.kind == kind);
    let block = own.clone().find_map(|o| block(base, drawing, (wall, work), o));
    let (record, work) = block.or_else(|| {
        let writable = |e: &&Entity| !matches!(e.editable, Editable::No(_));
        let like = own.clone().find_map(|o| shown(base, drawing, o).find(writable))?;
        let shapes = match kind {
            OpeningKind::Door => leaf(&base.plan, wall, work)?,
            _ => vec![pane(&base.plan, work)],
        };
        Some((like.source.record, EntityWork::Build { shapes }))
    })?;
    Some(Edit::Work { record, work })
}

/// The block that shows an opening of the same width in a wall as thick, as it would stand in the new one.
fn block(
    base: &Understood,
    drawing: &Drawing,
    (wall, work): (&Wall, &Work),
    of: &Opening,
) -> Option<(usize, EntityWork)> {
    let (plan, scale) = (&base.plan, base.plan.human_scale);
    let [p, q] = work.stretch;
    let is_near = |a: f64, b: f64| (a - b).abs() <= FITS_M * scale;
    if !is_near(of.width_m * scale, p.distance(q)) || !is_near(of.thickness_m * scale, wall.thickness_m) {
        return None;
    }
    let records: BTreeSet<usize> = shown(base, drawing, of)
        .filter(|e| e.editable == Editable::WithInsert { turnable: true })
        .map(|e| e.source.record)
        .collect();
    // One block shows the whole of it.
    let (Some(record), 1) = (records.first(), records.len()) else { return None };
    let [a, b] = of.jambs.map(|j| plan.frame.file_from_plan(j.at * scale));
    let [c, d] = [p, q].map(|x| plan.frame.file_from_plan(x));
    let turn_rad = (b - a).angle_to(d - c);
    let shift = (c + d) / 2.0 - DVec2::from_angle(turn_rad).rotate((a + b) / 2.0);
    Some((*record, EntityWork::Copy { motion: RigidMotion { turn_rad, shift } }))
}

/// A leaf that stands open at a right angle, and its swing.
fn leaf(plan: &Plan, wall: &Wall, work: &Work) -> Option<Vec<Shape>> {
    let [p, q] = work.stretch;
    let along = (q - p).try_normalize()?;
    // Hung on the jamb nearer to the wall's end: open, the leaf lies before a wall.
    let from_start = |x: DVec2| (x - wall.at).dot(wall.along);
    let near = |x: DVec2| from_start(x).min(wall.length_m - from_start(x));
    let (hinge, to_lock) = if near(p) <= near(q) { (p, along) } else { (q, -along) };
    // Into the room on the right of the wall, where there is one.
    let side = if work.rooms[0].is_some() { -1.0 } else { 1.0 };
    let into = wall.along.perp() * side;
    let at = hinge + into * (wall.thickness_m / 2.0);
    let [centre, tip] =
        [at, at + into * p.distance(q)].map(|x| plan.frame.written(plan.frame.file_from_plan(x)));
    let [open, shut] = [into, to_lock].map(|d| d.y.atan2(d.x));
    let is_left = to_lock.perp_dot(into) > 0.0;
    let (start_rad, end_rad) = if is_left { (shut, open) } else { (open, shut) };
    let swing = Shape::Arc { centre, radius: centre.distance(tip), start_rad, end_rad };
    Some(vec![Shape::Line { a: centre, b: tip }, swing])
}

/// A pane on the axis of the wall, from jamb to jamb.
fn pane(plan: &Plan, work: &Work) -> Shape {
    let [a, b] = work.stretch.map(|p| plan.frame.written(plan.frame.file_from_plan(p)));
    Shape::Line { a, b }
}
