//! Lines that cross too often to be the walls of a building.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Wall;
use enfilade_engine::geometry::{PointUm, cross_um};
use enfilade_report::{Error, Place};

/// Most crossings of wall lines. Each is a joint to be understood, so that time and memory grow with them; walls that
/// are drawn through one another as a lattice of 400 by 400 have fewer.
pub const CROSSINGS_MAX: usize = 200_000;

/// Most pairs of lines that are looked at: beyond, it is not known how often they cross.
const PAIRS_MAX: usize = 100_000_000;

/// Squares along the longer side are the root of the number of lines, and at most so many.
const SQUARES_MAX: f64 = 1024.0;

type Piece = [PointUm; 2];

/// Refuses walls whose lines cross more than [`CROSSINGS_MAX`] times.
///
/// # Errors
/// [`Error::Input`] that names the limit.
pub(super) fn refuse(walls: &[Wall], file: &str) -> Result<(), Error> {
    let of = |w: &Wall| w.trace.segments().map(|(_, _, s)| [s.a.min(s.b), s.a.max(s.b)]).collect::<Vec<_>>();
    let mut pieces: Vec<Piece> = walls.iter().flat_map(of).collect();
    pieces.sort_unstable();
    pieces.dedup();
    if crossings(&pieces, CROSSINGS_MAX) <= CROSSINGS_MAX {
        return Ok(());
    }
    let text = format!(
        "its {} wall lines, found more than {CROSSINGS_MAX} crossings, expected at most {CROSSINGS_MAX} (CROSSINGS_MAX); \
         not read. Say which layers hold the walls (--wall-layer), or leave out hatches that are drawn line by line",
        pieces.len()
    );
    Err(Error::input("too-many-crossings", Place::file(file), text))
}

/// How many pairs of pieces cross in their inside; counting ends once there are more than `most`.
fn crossings(pieces: &[Piece], most: usize) -> usize {
    let Some([lo, hi]) = enfilade_cad::plane::box_of(pieces.iter().flatten().map(|p| place(*p))) else {
        return 0;
    };
    let side = (hi - lo).max_element() / (pieces.len() as f64).sqrt().clamp(1.0, SQUARES_MAX);
    let square = |p: DVec2| ((p - lo) / side.max(1.0)).floor().as_i64vec2().to_array();
    let mut squares: BTreeMap<[i64; 2], Vec<u32>> = BTreeMap::new();
    for (i, piece) in pieces.iter().enumerate() {
        let [a, b] = piece.map(place);
        let steps = (2.0 * a.distance(b) / side.max(1.0)).ceil().max(1.0) as usize;
        for k in 0..=steps {
            let own = squares.entry(square(a.lerp(b, k as f64 / steps as f64))).or_default();
            if own.last() != Some(&(i as u32)) {
                own.push(i as u32);
            }
        }
    }
    let (mut found, mut looked) = (0, 0);
    for (at, own) in &squares {
        for (k, i) in own.iter().enumerate() {
            let p = pieces[*i as usize];
            let beyond = own[k + 1..].iter().map(|j| pieces[*j as usize]);
            found += beyond.filter(|q| crossing(p, *q).is_some_and(|c| square(c) == *at)).count();
            looked += own.len() - k;
            if found > most || looked > PAIRS_MAX {
                return found;
            }
        }
    }
    found
}

fn place(p: PointUm) -> DVec2 {
    DVec2::new(p[0] as f64, p[1] as f64)
}

/// Where two pieces cross, if each has its ends on both sides of the other.
fn crossing(p: Piece, q: Piece) -> Option<DVec2> {
    let sides = |[a, b]: Piece, at: Piece| at.map(|c| cross_um(a, b, c));
    let ([c, d], [e, f]) = (sides(p, q), sides(q, p));
    if c.signum() * d.signum() >= 0 || e.signum() * f.signum() >= 0 {
        return None;
    }
    Some(place(q[0]).lerp(place(q[1]), c as f64 / (c as f64 - d as f64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_counted_and_touching_is_none() {
        let lattice = |n: i64| -> Vec<Piece> {
            let row = |k: i64| [[0, 1_000 * k], [1_000 * n, 1_000 * k]];
            let column = |k: i64| [[1_000 * k + 500, -1], [1_000 * k + 500, 1_000 * n]];
            (0..n).flat_map(|k| [row(k), column(k)]).collect()
        };
        assert_eq!(crossings(&lattice(30), usize::MAX), 900);
        assert!((101..900).contains(&crossings(&lattice(30), 100)), "counting ends");
        let corner = [[[0, 0], [9, 0]], [[9, 0], [9, 9]], [[4, 0], [4, 5]]];
        assert_eq!(crossings(&corner, usize::MAX), 0);
        assert_eq!(crossings(&[], usize::MAX), 0);
        let is_refused = |n: i64| crossings(&lattice(n), CROSSINGS_MAX) > CROSSINGS_MAX;
        assert!(!is_refused(447) && is_refused(448), "a lattice of 447 by 447 has 199,809 crossings");
    }
}
