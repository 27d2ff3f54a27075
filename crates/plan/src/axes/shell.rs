//! Inside and outside: whether walls stand round a place on all sides, openings taken as closed.

use glam::DVec2;

use super::evidence::trace;
use super::near::Buckets;
use super::{Drawn, Opening, OpeningKind, Shown};
use crate::sizes::ERROR_GAP_M;

/// How far from a wall's face the place beside it lies.
const BESIDE_M: f64 = 0.35;

/// Looks from a place, spread over the half turn away from the wall.
const LOOKS: usize = 15;

/// Looks that may meet nothing although the place is inside: gaps that were not understood.
const LOST_MAX: usize = 1;

/// How far a look goes.
const FAR_M: f64 = 60.0;

/// Length of the steps in which it goes.
const STEP_M: f64 = 2.0;

/// The walls of a drawing with their openings closed.
pub struct Shell {
    pieces: Vec<[DVec2; 2]>,
    near: Buckets,
}

impl Shell {
    pub fn new(drawn: &Drawn, openings: &[Opening]) -> Self {
        let mut pieces: Vec<[DVec2; 2]> = Vec::new();
        for face in &drawn.faces {
            pieces.extend(trace(&face.path).windows(2).map(|w| [w[0], w[1]]));
        }
        pieces.extend(openings.iter().map(|o| o.jambs.map(|j| j.at)));
        let mut near = Buckets::new(STEP_M);
        pieces.iter().enumerate().for_each(|(i, p)| near.add(i as u32, p));
        Self { pieces, near }
    }

    /// Whether rooms lie on both sides of an opening.
    fn is_between_rooms(&self, o: &Opening) -> bool {
        let Some(along) = (o.jambs[1].at - o.jambs[0].at).try_normalize() else { return false };
        let away = o.thickness_m / 2.0 + BESIDE_M;
        [along.perp(), -along.perp()].into_iter().all(|out| self.is_room(o.centre + out * away, out))
    }

    /// Whether nearly all looks from `p` away from a wall meet another.
    fn is_room(&self, p: DVec2, out: DVec2) -> bool {
        let looks = (0..LOOKS).map(|k| {
            let share = (k as f64 + 0.5) / LOOKS as f64 - 0.5;
            DVec2::from_angle(share * 0.9 * std::f64::consts::PI).rotate(out)
        });
        looks.filter(|d| !self.meets(p, *d)).count() <= LOST_MAX
    }

    fn meets(&self, p: DVec2, direction: DVec2) -> bool {
        let mut at = p;
        for _ in 0..(FAR_M / STEP_M) as usize {
            let to = at + direction * STEP_M;
            let near = self.near.near(at.min(to), at.max(to));
            if near.into_iter().any(|i| cross(at, to, self.pieces[i as usize])) {
                return true;
            }
            at = to;
        }
        false
    }
}

/// Whether two segments share a point.
pub fn cross(a: DVec2, b: DVec2, [c, d]: [DVec2; 2]) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) >= 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

/// Of windows that no name calls so, sashes with rooms on both sides are sliding or folding doors; so are other lines along
/// the wall if the wall is an inner one.
///
/// Inner walls are thinner than most of those with windows to the outside; where there is no such window, all are.
pub fn tell_sliding_doors(drawn: &Drawn, openings: &mut [Opening]) {
    let is_unsure = |o: &Opening| matches!(o.shown, Shown::Panes | Shown::Sashes);
    let windows: Vec<usize> =
        (0..openings.len()).filter(|i| openings[*i].kind == OpeningKind::Window).collect();
    if !windows.iter().any(|i| is_unsure(&openings[*i])) {
        return;
    }
    let shell = Shell::new(drawn, openings);
    let between: Vec<bool> = windows.iter().map(|i| shell.is_between_rooms(&openings[*i])).collect();
    let outer = windows.iter().zip(&between).filter(|(_, b)| !**b);
    let mut outer: Vec<f64> = outer.map(|(i, _)| openings[*i].thickness_m).collect();
    outer.sort_by(f64::total_cmp);
    let outer_m = outer.get(outer.len() / 2).copied().unwrap_or(f64::MAX);
    for (i, is_between) in windows.into_iter().zip(between) {
        let o = &mut openings[i];
        let is_inner = o.shown == Shown::Sashes || o.thickness_m < outer_m - ERROR_GAP_M;
        if is_between && is_unsure(o) && is_inner {
            o.kind = OpeningKind::Door;
        }
    }
}
