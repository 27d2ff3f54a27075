//! A plan with works as it is shown: what goes in one colour, what is built in another.

use glam::DVec2;

use super::edits::{built_axis, outlines, thickness_m};
use super::made::Moved;
use crate::understand::understood::Understood;
use crate::write::traces;
use enfilade_engine::geometry::Segment;
use enfilade_overlay::picture::{PlanPicture, Stroke, StrokeKind};
use enfilade_works::change::Quad;
use enfilade_works::walls::Wall;
use enfilade_works::{Change, Work};

/// What goes and what is built, plan frame.
pub(super) fn strokes(base: &Understood, walls: &[Wall], works: &[&Work]) -> Vec<Stroke> {
    let ring = |points: [DVec2; 4], kind| Stroke {
        points: points.map(|p| p.to_array()).to_vec(),
        closed: true,
        filled: true,
        kind,
    };
    let of = |work: &&Work| {
        let gone = outlines(base, walls, work).into_iter().map(|o| ring(o, StrokeKind::Demolished));
        let built = built_axis(base, work).map(|[a, b]| {
            let off = (b - a).normalize_or_zero().perp() * (thickness_m(base, walls, work) / 2.0);
            ring([a - off, b - off, b + off, a + off], StrokeKind::Built)
        });
        gone.chain(built).collect::<Vec<_>>()
    };
    works.iter().flat_map(of).collect()
}

/// The plan with works, and with what moves beside them.
pub(super) fn picture(base: &Understood, walls: &[Wall], works: &[&Work], moved: &Moved) -> PlanPicture {
    let mut out = traces::moved_picture(base, &moved.layout);
    let gone: Vec<Quad> = works.iter().flat_map(|w| w.change.demolished.iter().copied()).collect();
    let change = Change { demolished: gone, built: Vec::new() };
    let drawn = std::mem::take(&mut out.strokes);
    out.strokes = drawn.into_iter().flat_map(|s| cut(base, s, &change)).collect();
    out.strokes.extend(strokes(base, walls, works));
    out
}

/// What a change leaves of a stroke; a filled one as it is, since what goes lies over it.
fn cut(base: &Understood, stroke: Stroke, change: &Change) -> Vec<Stroke> {
    let frame = &base.plan.frame;
    let um: Vec<_> = stroke.points.iter().map(|p| frame.um_from_plan(DVec2::from(*p))).collect();
    let back = stroke.closed.then(|| (um.last().copied(), um.first().copied()));
    let back = back.and_then(|(a, b)| Some(Segment { a: a?, b: b? }));
    let drawn: Vec<Segment> = um.windows(2).map(|w| Segment { a: w[0], b: w[1] }).chain(back).collect();
    let left = change.apply(&drawn);
    if stroke.filled || left == drawn {
        return vec![stroke];
    }
    let piece = |s: &Segment| Stroke {
        points: [s.a, s.b].map(|p| frame.plan_from_um(p).to_array()).to_vec(),
        closed: false,
        filled: false,
        kind: stroke.kind,
    };
    left.iter().map(piece).collect()
}
