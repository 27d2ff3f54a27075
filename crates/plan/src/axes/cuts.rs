//! Cuts: openings in walls that were drawn without a gap, where lines across the wall, a door swing or a
//! door or window by layer or block show them.

use glam::DVec2;

use super::axis::{Axis, Spare};
use super::carrier::Carrier;
use super::evidence::{Band, Evidence, ordered, trace};
use super::near::Buckets;
use super::spans::{self, Span};
use super::swing::{LEAF_M, Swing};
use super::{Drawn, Mark, OpeningKind, Path, Role, doors_by_swing};
use crate::sizes::{COLLINEAR_M, ERROR_GAP_M, JAMB_M, OPENING_MIN_M};

/// Widest opening between two lines across a wall.
const CUT_MAX_M: f64 = 5.0;
/// What must be left of a wall beside a cut; less goes to the cut.
const REST_M: f64 = 0.02;
/// Narrowest opening that a mark alone makes.
const MARK_MIN_M: f64 = 0.4;

/// Cuts axes where openings show; pieces of one axis keep its row.
pub fn cut(axes: Vec<Axis>, spares: &[Spare], evidence: &Evidence<'_>) -> Vec<Axis> {
    let mut gaps: Vec<Vec<Span>> = vec![Vec::new(); axes.len()];
    let near = places(&axes);
    between_jambs(&axes, spares, evidence, &near, &mut gaps);
    at_marks(&axes, evidence, &near, &mut gaps);
    let mut out = Vec::new();
    for (a, gaps) in axes.into_iter().zip(gaps) {
        let gaps = spans::joined(gaps, ERROR_GAP_M);
        if gaps.is_empty() {
            out.push(a);
            continue;
        }
        for span in spans::without(a.span, &gaps).into_iter().filter(|s| spans::length(*s) > REST_M) {
            out.push(Axis { span, ..a.clone() });
        }
    }
    out
}

/// Where lines across them stand on axes, in order.
fn jambs(axes: &[Axis], spares: &[Spare], near: &Buckets) -> Vec<Vec<f64>> {
    let mut jambs: Vec<Vec<f64>> = vec![Vec::new(); axes.len()];
    for spare in spares.iter().filter(|s| s.is_cap) {
        let middle = spare.carrier.at((spare.span[0] + spare.span[1]) / 2.0);
        for a in near.near(middle, middle) {
            let axis = &axes[a as usize];
            let s = axis.carrier.s_of(middle);
            let is_on = axis.carrier.offset_of(middle).abs() < axis.thickness / 4.0 + COLLINEAR_M;
            let is_across = (spans::length(spare.span) - axis.thickness).abs() < 2.0 * ERROR_GAP_M;
            if is_on && is_across && s > axis.span[0] - REST_M && s < axis.span[1] + REST_M {
                jambs[a as usize].push(s);
            }
        }
    }
    jambs.iter_mut().for_each(|at| at.sort_by(f64::total_cmp));
    jambs
}

/// What lies between neighbouring jambs and is as wide as an opening.
fn between(jambs: &[f64]) -> impl Iterator<Item = Span> {
    let gaps = jambs.windows(2).map(|w| [w[0], w[1]]);
    gaps.filter(|gap| (OPENING_MIN_M..=CUT_MAX_M).contains(&spans::length(*gap)))
}

/// Layers that begin and end at two lines across a wall which goes on beyond both are no layers: the panes of a window, drawn
/// as far apart as layers or partitions.
pub fn free_panes(drawn: &Drawn, axes: &mut [Axis], spares: &mut Vec<Spare>) {
    let jambs = jambs(axes, spares, &places(axes));
    for (axis, at) in axes.iter_mut().zip(jambs) {
        let goes_on = |gap: &Span| axis.span[0] < gap[0] - ERROR_GAP_M && axis.span[1] > gap[1] + ERROR_GAP_M;
        for gap in between(&at).filter(goes_on) {
            let (panes, layers): (Vec<u32>, Vec<u32>) = axis.inner.iter().partition(|f| {
                let (carrier, span) = Carrier::of(&drawn.faces[**f as usize].path);
                let own = axis.carrier.span_of(&carrier, span);
                (0..2).all(|k| (own[k] - gap[k]).abs() <= ERROR_GAP_M)
            });
            axis.inner = layers;
            spares.extend(panes.into_iter().map(|f| {
                let (carrier, span) = Carrier::of(&drawn.faces[f as usize].path);
                Spare { carrier, span, faces: vec![f], is_cap: false }
            }));
        }
    }
}

fn places(axes: &[Axis]) -> Buckets {
    let mut near = Buckets::new(1.0);
    for (i, a) in axes.iter().enumerate() {
        near.add(i as u32, &a.carrier.points(a.span));
    }
    near
}

/// Between two lines across a wall with something of a door or window between them.
fn between_jambs(
    axes: &[Axis],
    spares: &[Spare],
    evidence: &Evidence<'_>,
    near: &Buckets,
    gaps: &mut [Vec<Span>],
) {
    for (a, at) in jambs(axes, spares, near).into_iter().enumerate() {
        for gap in between(&at) {
            let axis = &axes[a];
            if evidence.look(&axis.carrier, axis.thickness, gap).verdict().0 != OpeningKind::Passage {
                gaps[a].push(gap);
            }
        }
    }
}

/// Where a swing closes onto a wall, or a window lies in one.
fn at_marks(axes: &[Axis], evidence: &Evidence<'_>, near: &Buckets, gaps: &mut [Vec<Span>]) {
    let meeting = doors_by_swing::meeting(evidence.drawn);
    let mut doors: Vec<Vec<Side>> = vec![Vec::new(); axes.len()];
    for (m, mark) in evidence.drawn.marks.iter().enumerate() {
        for path in &mark.paths {
            let around = near.along(&trace(path), *LEAF_M.start());
            if let Some(swing) = Swing::of(path) {
                let tips = closed_tips(&swing, meeting.get(&(m as u32)));
                let of = |a: &u32| Some((*a, swing_gap(&axes[*a as usize], &swing, &tips)?));
                let in_walls: Vec<(u32, Span)> = around.iter().filter_map(of).collect();
                // A leaf that opens against another wall touches two walls: which one it is in, is not said.
                if let [(a, gap)] = in_walls.as_slice()
                    && !around.iter().any(|b| ends_at_hinge(&axes[*b as usize], &swing))
                    && is_within(*gap, axes[*a as usize].span)
                {
                    gaps[*a as usize].push(as_wide_as_leaf(&axes[*a as usize], evidence, &swing, *gap));
                }
            }
            for a in &around {
                let axis = &axes[*a as usize];
                if let Some(gap) = pane_gap(axis, mark, path).filter(|g| is_within(*g, axis.span)) {
                    gaps[*a as usize].push(gap);
                }
                doors[*a as usize]
                    .extend(door_side(axis, mark, path).filter(|d| is_within(d.gap, axis.span)));
            }
        }
    }
    for (sides, gaps) in doors.iter().zip(gaps) {
        let is_across = |a: &Side, b: &Side| (0..2).all(|k| (a.gap[k] - b.gap[k]).abs() <= ERROR_GAP_M);
        let left = sides.iter().filter(|s| s.is_left);
        gaps.extend(left.filter(|l| sides.iter().any(|r| !r.is_left && is_across(l, r))).map(|l| l.gap));
    }
}

/// A line of a door along the face of a wall.
#[derive(Clone, Copy)]
struct Side {
    gap: Span,
    is_left: bool,
}

/// Along which face of a wall a line of a door lies: a box over the wall has one along both.
fn door_side(axis: &Axis, mark: &Mark, path: &Path) -> Option<Side> {
    if mark.role != Role::Door || !matches!(path, Path::Line { .. }) || !axis.carrier.is_line() {
        return None;
    }
    let (carrier, span) = Carrier::of(path);
    let [a, b] = path.ends().map(|e| axis.carrier.offset_of(e));
    let is_on_face = |offset: f64| (offset.abs() - axis.thickness / 2.0).abs() <= ERROR_GAP_M;
    let gap = axis.carrier.span_of(&carrier, span);
    (is_on_face(a) && is_on_face(b) && a * b > 0.0).then_some(Side { gap, is_left: a > 0.0 })
}

/// Whether a wall ends at a swing's hinge and looks to where its leaf closes or opens: there is a gap.
fn ends_at_hinge(axis: &Axis, swing: &Swing) -> bool {
    let Swing { hinge, radius, .. } = *swing;
    (0..2).any(|e| {
        let out = axis.carrier.tangent(axis.span[e]) * if e == 1 { 1.0 } else { -1.0 };
        let looks = |p: DVec2| (p - hinge).dot(out) > 0.9 * radius;
        axis.carrier.at(axis.span[e]).distance(hinge) < axis.thickness / 2.0 + 2.0 * JAMB_M
            && swing.ends().into_iter().any(looks)
    })
}

fn is_within(gap: Span, span: Span) -> bool {
    gap[0] > span[0] - REST_M && gap[1] < span[1] + REST_M && spans::length(gap) >= MARK_MIN_M
}

/// Where the leaf of a swing may close; `meeting`: where it meets its twin, if it has one.
fn closed_tips(swing: &Swing, meeting: Option<&Vec<[DVec2; 2]>>) -> Vec<DVec2> {
    let own = meeting.into_iter().flatten().filter(|l| l[0] == swing.hinge);
    let met: Vec<DVec2> = own.map(|l| l[1]).collect();
    if met.is_empty() { swing.tips() } else { met }
}

/// From a swing's hinge to where its leaf closes.
fn swing_gap(axis: &Axis, swing: &Swing, tips: &[DVec2]) -> Option<Span> {
    let band = Band { carrier: axis.carrier, gap: axis.span, half: axis.thickness / 2.0 };
    if !band.has(swing.hinge, JAMB_M) {
        return None;
    }
    let from = axis.carrier.s_of(swing.hinge);
    let closed = tips.iter().copied().filter(|e| band.has(*e, JAMB_M));
    let far = closed.map(|e| axis.carrier.s_of(e)).find(|s| (s - from).abs() > 0.9 * swing.radius)?;
    Some(ordered(from, far))
}

/// From a swing's hinge as far as the closed leaf is drawn, where that is farther: some draw the swing at half its size.
fn as_wide_as_leaf(axis: &Axis, evidence: &Evidence<'_>, swing: &Swing, gap: Span) -> Span {
    let Swing { hinge, radius, .. } = *swing;
    let band = Band { carrier: axis.carrier, gap: axis.span, half: axis.thickness / 2.0 };
    let is_leaf = |p: &&Path| {
        let ends = p.ends();
        matches!(p, Path::Line { .. })
            && p.length_m() <= 2.0 * radius + ERROR_GAP_M
            && ends.iter().any(|e| e.distance(hinge) <= ERROR_GAP_M)
            && ends.iter().all(|e| band.has(*e, JAMB_M))
    };
    let of_doors = evidence.drawn.marks.iter().filter(|m| m.role == Role::Door);
    let leaves = of_doors.flat_map(|m| &m.paths).filter(is_leaf);
    let spans = leaves.map(|p| {
        let [a, b] = p.ends().map(|e| axis.carrier.s_of(e));
        ordered(a, b)
    });
    let holds =
        |s: &Span| s[0] <= gap[0] + ERROR_GAP_M && s[1] >= gap[1] - ERROR_GAP_M && is_within(*s, axis.span);
    let widest = spans.filter(holds).max_by(|a, b| spans::length(*a).total_cmp(&spans::length(*b)));
    widest.unwrap_or(gap)
}

/// Along a line of a window that lies between the faces.
fn pane_gap(axis: &Axis, mark: &Mark, path: &Path) -> Option<Span> {
    if !matches!(mark.role, Role::Window) || matches!(path, Path::Line { .. }) != axis.carrier.is_line() {
        return None;
    }
    let (carrier, span) = Carrier::of(path);
    if !path.ends().iter().all(|e| axis.carrier.offset_of(*e).abs() <= axis.thickness / 2.0 + ERROR_GAP_M) {
        return None;
    }
    let gap = axis.carrier.span_of(&carrier, span);
    (spans::length(gap) > 0.95 * path.length_m()).then_some(gap)
}
