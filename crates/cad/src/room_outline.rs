//! The outline of a room goes with the walls on which its sides lie: each side as its wall goes, and the corners between are
//! where the sides then meet. The same for outlines of a drawing and of a building.

use glam::DVec2;

use crate::drawing::RigidMotion;

/// A side of a room this near to a wall, or within it, lies on it, metres.
pub(crate) const ON_WALL_M: f64 = 0.02;

/// Sides and faces whose directions differ by a smaller sine are parallel: half a degree.
pub(crate) const PARALLEL_SIN: f64 = 0.01;

/// Places along a side at which it is asked on which wall it lies.
const PLACES: u32 = 40;

/// A side of which less lies on walls that move stays: it ends at their faces.
const STAYS_SHARE: f64 = 0.1;

/// A side of which more lies on them goes with them. Between the two nobody can tell, and the room stays.
const GOES_SHARE: f64 = 0.9;

/// A side goes with a wall only where at least this share of it lies on walls.
const ON_WALLS_SHARE: f64 = 0.5;

/// A side that would become shorter than this would be gone, metres.
const SIDE_MIN_M: f64 = 0.05;

/// Coordinates that differ less are one, metres.
const ROUNDING_M: f64 = 1e-9;

/// Ways that take a side to places that differ less are one, metres: faces of one wall are written to whole micrometres.
const SAME_WAY_M: f64 = 1e-5;

/// How a place on a wall goes: along the wall where that becomes longer or shorter, and then with the wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Way {
    /// Shift before the motion.
    pub along: DVec2,
    /// What the wall does; nothing where it stands.
    pub motion: Option<RigidMotion>,
}

impl Way {
    /// Where a place goes.
    pub fn of(self, p: DVec2) -> DVec2 {
        let p = p + self.along;
        self.motion.map_or(p, |m| DVec2::from_angle(m.turn_rad).rotate(p) + m.shift)
    }
}

/// The walls beside a room.
pub(crate) trait Walls {
    /// How the wall goes on which a place of a side with a direction lies; `None` where no wall is.
    fn way(&self, at: DVec2, along: DVec2) -> Option<Way>;
}

/// The sides of a ring.
pub(crate) fn sides(ring: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// How a side of a room goes; `None` where it stays.
///
/// # Errors
/// In words, where it lies only in part on what moves.
pub(crate) fn way([a, b]: [DVec2; 2], walls: &impl Walls, metres: f64) -> Result<Option<Way>, String> {
    let Some(along) = (b - a).try_normalize() else { return Ok(None) };
    let is_same = |v: &Way, w: &Way| {
        v == w || [a, b].iter().all(|p| v.of(*p).distance(w.of(*p)) * metres <= SAME_WAY_M)
    };
    let mut shares: Vec<(Way, u32)> = Vec::new();
    for k in 0..PLACES {
        let at = a.lerp(b, (f64::from(k) + 0.5) / f64::from(PLACES));
        let Some(way) = walls.way(at, along) else { continue };
        match shares.iter_mut().find(|s| is_same(&s.0, &way)) {
            Some(share) => share.1 += 1,
            None => shares.push((way, 1)),
        }
    }
    let on_walls: u32 = shares.iter().map(|s| s.1).sum();
    shares.retain(|s| s.0 != Way::default());
    let Some((way, most)) = shares.iter().max_by_key(|s| s.1).copied() else { return Ok(None) };
    let is_certain = f64::from(on_walls) >= ON_WALLS_SHARE * f64::from(PLACES);
    match f64::from(most) / f64::from(on_walls) {
        share if share >= GOES_SHARE && is_certain => Ok(Some(way)),
        _ if f64::from(most) <= STAYS_SHARE * f64::from(PLACES) => Ok(None),
        _ => Err("a side of it lies only in part on the wall that moves".into()),
    }
}

/// The corners of a ring after its sides went.
///
/// # Errors
/// In words, why it stays.
pub(crate) fn followed(ring: &[DVec2], walls: &impl Walls, metres: f64) -> Result<Vec<DVec2>, String> {
    let (corners, of) = distinct(ring, metres);
    let now = corners_of(&corners, walls, metres)?;
    Ok(of.into_iter().zip(ring).map(|(i, p)| if now[i] == corners[i] { *p } else { now[i] }).collect())
}

/// The corners of a ring without those drawn twice, and by corner of the ring which of them it is.
fn distinct(ring: &[DVec2], metres: f64) -> (Vec<DVec2>, Vec<usize>) {
    let is_same = |p: DVec2, q: DVec2| p.distance(q) * metres <= ROUNDING_M;
    let (mut corners, mut of): (Vec<DVec2>, Vec<usize>) = (Vec::new(), Vec::new());
    for p in ring {
        if corners.last().is_none_or(|last| !is_same(*last, *p)) {
            corners.push(*p);
        }
        of.push(corners.len() - 1);
    }
    if corners.len() > 1 && is_same(corners[0], corners[corners.len() - 1]) {
        corners.pop();
        of.iter_mut().filter(|i| **i == corners.len()).for_each(|i| *i = 0);
    }
    (corners, of)
}

fn corners_of(ring: &[DVec2], walls: &impl Walls, metres: f64) -> Result<Vec<DVec2>, String> {
    let ways: Vec<Option<Way>> = sides(ring).map(|s| way(s, walls, metres)).collect::<Result<_, _>>()?;
    let n = ring.len();
    let go = |i: usize, p: DVec2| ways[i].map_or(p, |w| w.of(p));
    let corner = |i: usize| {
        let before = (i + n - 1) % n;
        let [p, q] = [before, i].map(|k| [go(k, ring[k]), go(k, ring[(k + 1) % n])]);
        if ways[before] == ways[i] {
            return Ok(go(i, ring[i]));
        }
        let ([along, across], between) = ([p[1] - p[0], q[1] - q[0]], q[0] - p[0]);
        let turn = along.perp_dot(across);
        if turn.abs() <= PARALLEL_SIN * along.length() * across.length() {
            return Err("its outline would need one more corner".to_owned());
        }
        Ok(settled(p[0] + along * (between.perp_dot(across) / turn), ring[i], metres))
    };
    let now: Vec<DVec2> = (0..n).map(corner).collect::<Result<_, _>>()?;
    let keeps = |(old, new): ([DVec2; 2], [DVec2; 2])| {
        let (old, new) = (old[1] - old[0], new[1] - new[0]);
        new.length() >= (SIDE_MIN_M / metres).min(old.length()) && old.dot(new) > 0.0
    };
    let are_kept = sides(ring).zip(sides(&now)).all(keeps);
    are_kept.then_some(now).ok_or_else(|| "a side of it would be gone".into())
}

/// A place with what of it is as drawn, but for rounding.
fn settled(p: DVec2, drawn: DVec2, metres: f64) -> DVec2 {
    DVec2::from_array(
        [0, 1].map(|k| if (p[k] - drawn[k]).abs() * metres <= ROUNDING_M { drawn[k] } else { p[k] }),
    )
}
