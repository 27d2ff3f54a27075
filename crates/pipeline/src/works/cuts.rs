//! What stays of a wall's line where a building work cuts it.

use glam::DVec2;

use crate::measure::written::SAME_CORNER_UM;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Shape, Vertex};
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::{Plan, Wall};
use enfilade_works::change::{Quad, inside};

/// Whether a wall's line has a length in what goes.
pub(super) fn meets(wall: &Wall, gone: &[Quad]) -> bool {
    wall.trace.segments().any(|(_, _, s)| is_met(s, gone))
}

fn is_met(s: Segment, gone: &[Quad]) -> bool {
    gone.iter().any(|q| inside(s, q).is_some())
}

/// Whether a point lies in what goes, or on its rim.
pub(super) fn holds(gone: &Quad, p: PointUm) -> bool {
    let at = |p: PointUm| DVec2::new(p[0] as f64, p[1] as f64);
    let [a, b, _, d] = gone.map(at);
    [b - a, d - a].into_iter().all(|side| {
        let along = (at(p) - a).dot(side.normalize_or_zero());
        (-SAME_CORNER_UM..=side.length() + SAME_CORNER_UM).contains(&along)
    })
}

/// What stays of a wall's line, drawing units; nothing: it goes as a whole. An outline that is cut through is closed along
/// its jambs, which are then no lines of their own.
///
/// # Errors
/// Why the line is not cut: it is round there.
pub(super) fn parts(
    plan: &Plan,
    wall: &Wall,
    gone: &[Quad],
    jambs: &mut Vec<Segment>,
) -> Result<Vec<Shape>, String> {
    match &wall.shape {
        Shape::Line { a, b } => {
            let part = |[from, to]: [f64; 2]| Shape::Line {
                a: between(plan, [*a, *b], from),
                b: between(plan, [*a, *b], to),
            };
            Ok(staying(plan, [*a, *b], gone).into_iter().map(part).collect())
        }
        Shape::Polyline { vertices, closed } => {
            let chains = chains(plan, wall, (vertices, *closed), gone)?;
            let one = |chain: Vec<Vertex>| {
                let ends = [chain[0].at, chain[chain.len() - 1].at].map(|p| plan.frame.um_from_file(p));
                let jamb = jambs.iter().position(|j| *closed && chain.len() > 2 && is_same(*j, ends));
                jamb.map(|j| jambs.remove(j));
                Shape::Polyline { vertices: chain, closed: jamb.is_some() }
            };
            Ok(chains.into_iter().map(one).collect())
        }
        Shape::Arc { .. } | Shape::Circle { .. } => Err(format!("{} is round", wall.source.kind)),
    }
}

/// What stays of a polyline, piece by piece joined again.
fn chains(
    plan: &Plan,
    wall: &Wall,
    (vertices, is_closed): (&[Vertex], bool),
    gone: &[Quad],
) -> Result<Vec<Vec<Vertex>>, String> {
    let count = vertices.len();
    let pieces = if is_closed { count } else { count.saturating_sub(1) };
    let mut chains: Vec<Vec<Vertex>> = Vec::new();
    // Whether the last chain goes on at the next vertex.
    let mut goes_on = false;
    for k in 0..pieces {
        let (v, w) = (vertices[k], vertices[(k + 1) % count]);
        if v.bulge != 0.0 && is_bulge_met(plan, wall, k, gone) {
            return Err(format!("{} is round where it would be cut", wall.source.kind));
        }
        let whole = vec![[0.0, 1.0]];
        let spans = if v.bulge == 0.0 { staying(plan, [v.at, w.at], gone) } else { whole };
        goes_on &= spans.first().is_some_and(|s| s[0] == 0.0);
        for [from, to] in spans {
            let start = Vertex { at: between(plan, [v.at, w.at], from), bulge: v.bulge };
            match chains.last_mut().and_then(|c| c.last_mut()).filter(|_| goes_on && from == 0.0) {
                Some(last) => *last = start,
                None => chains.push(vec![start]),
            }
            let end = Vertex { at: between(plan, [v.at, w.at], to), bulge: 0.0 };
            chains.last_mut().into_iter().for_each(|c| c.push(end));
            goes_on = to == 1.0;
        }
    }
    let is_round = is_closed && goes_on && chains.len() > 1 && chains[0][0].at == vertices[0].at;
    if let Some(mut last) = chains.pop_if(|_| is_round) {
        last.pop();
        last.append(&mut chains[0]);
        chains[0] = last;
    }
    Ok(chains)
}

/// The parts of a line that stay, drawing units, as shares of its length, ascending; none shorter than one corner.
fn staying(plan: &Plan, [a, b]: [DVec2; 2], gone: &[Quad]) -> Vec<[f64; 2]> {
    let [a, b] = [a, b].map(|p| plan.frame.um_from_file(p));
    let length_um = ((b[0] - a[0]) as f64).hypot((b[1] - a[1]) as f64);
    let mut spans: Vec<[f64; 2]> = gone.iter().filter_map(|q| inside(Segment { a, b }, q)).collect();
    spans.sort_by(|p, q| p[0].total_cmp(&q[0]));
    let (mut from, mut out) = (0.0, Vec::new());
    for [lo, hi] in spans.into_iter().chain([[1.0, 1.0]]) {
        if (lo - from) * length_um > SAME_CORNER_UM {
            out.push([from, lo]);
        }
        from = f64::max(from, hi);
    }
    out
}

/// A point of a line by its share of the length; the ends to the bit.
fn between(plan: &Plan, [a, b]: [DVec2; 2], share: f64) -> DVec2 {
    match share {
        0.0 => a,
        1.0 => b,
        _ => plan.frame.written(a + (b - a) * share),
    }
}

/// Whether what goes meets the round piece that begins at a vertex: the trace has it in several.
fn is_bulge_met(plan: &Plan, wall: &Wall, piece: usize, gone: &[Quad]) -> bool {
    let points = control_points(&wall.shape);
    let [from, to] = [piece, (piece + 1) % points.len()].map(|k| plan.frame.um_from_file(points[k]));
    let ring = &wall.trace.points;
    let Some(start) = ring.iter().position(|p| *p == from) else { return true };
    for k in 0..ring.len() {
        let (a, b) = (ring[(start + k) % ring.len()], ring[(start + k + 1) % ring.len()]);
        if is_met(Segment { a, b }, gone) {
            return true;
        }
        if b == to {
            break;
        }
    }
    false
}

fn is_same(s: Segment, [p, q]: [PointUm; 2]) -> bool {
    let near = |a: PointUm, b: PointUm| ((a[0] - b[0]) as f64).hypot((a[1] - b[1]) as f64) <= SAME_CORNER_UM;
    near(s.a, p) && near(s.b, q) || near(s.a, q) && near(s.b, p)
}
