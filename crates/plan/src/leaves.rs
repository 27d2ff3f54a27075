//! Leaves of doors drawn without their swings: a line, or a slip as thin as a leaf, that hangs at the jamb of a gap in a
//! wall's face, is as long as that gap is wide, and ends free.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::ops::RangeInclusive;

use glam::DVec2;

use super::axes::Path;
use super::axes::near::Buckets;
use super::axes::swing::LEAF_M;
use crate::sizes::{COLLINEAR_M, ERROR_GAP_M, FINISH_MAX_M, JAMB_M, THICKNESS_USUAL_M};
use enfilade_cad::plane::distance_to_segment;

/// Thickest leaf, metres.
const THICK_M: f64 = 0.07;

/// How far a leaf stands open, radians.
const OPEN_RAD: [f64; 2] = [0.4, 2.0];

/// The face goes on beyond the gap in one line: the cosine.
const ALONG_COS: f64 = 0.985;

/// How far behind the face of its wall a leaf may hang: in the middle of a usual one.
const BEHIND_M: f64 = THICKNESS_USUAL_M / 2.0;

/// Shortest piece of face that tells where a gap begins, metres.
const FACE_MIN_M: f64 = 0.05;

/// Where more ends than this lie in a square of half a metre, nothing is a leaf: hatches, lines drawn over one another. It
/// keeps their time linear.
const CROWD: u32 = 200;

/// Squares of half a metre, by how many ends lie in them.
#[derive(Default)]
struct Crowd(HashMap<[i64; 2], u32>);

impl Crowd {
    fn new(ends: impl Iterator<Item = DVec2>) -> Self {
        let mut out = Self::default();
        ends.for_each(|p| *out.0.entry(Self::square(p)).or_default() += 1);
        out
    }

    fn square(p: DVec2) -> [i64; 2] {
        [(p.x * 2.0).floor() as i64, (p.y * 2.0).floor() as i64]
    }

    fn is_at(&self, p: DVec2) -> bool {
        let [x, y] = Self::square(p);
        let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
        around.into_iter().any(|square| self.0.get(&square).is_some_and(|n| *n > CROWD))
    }
}

/// A straight piece.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    pub ends: [DVec2; 2],
    /// The number of the thing that draws it.
    pub thing: usize,
    /// Whether it may be the face of a wall.
    pub is_wall: bool,
}

/// Straight pieces by place.
struct Pieces {
    all: Vec<Piece>,
    near: Buckets,
    crowd: Crowd,
}

impl Pieces {
    /// Files them.
    fn new(pieces: impl Iterator<Item = Piece>) -> Self {
        let mut out = Self { all: Vec::new(), near: Buckets::new(0.5), crowd: Crowd::default() };
        for piece in pieces.filter(|p| p.ends.iter().all(|e| e.is_finite())) {
            out.near.add(out.all.len() as u32, &piece.ends);
            out.all.push(piece);
        }
        out.crowd = Crowd::new(out.all.iter().flat_map(|p| p.ends));
        out
    }

    /// Those near a box that another thing draws.
    fn others(&self, lo: DVec2, hi: DVec2, own: usize) -> impl Iterator<Item = Piece> + '_ {
        let near = self.near.near(lo, hi).into_iter().map(|i| self.all[i as usize]);
        near.filter(move |p| p.thing != own)
    }

    /// Those of them that are walls.
    fn walls(&self, lo: DVec2, hi: DVec2, own: usize) -> impl Iterator<Item = [DVec2; 2]> + '_ {
        self.others(lo, hi, own).filter(|p| p.is_wall).map(|p| p.ends)
    }

    /// The swing of the leaf that a thing draws, from where it stands open to where it closes.
    fn swing(&self, paths: &[Path], own: usize) -> Option<Path> {
        let sides = sides(paths);
        if sides.iter().flatten().any(|end| self.crowd.is_at(*end)) {
            return None;
        }
        let ways = sides.iter().flat_map(|[a, b]| [[*a, *b], [*b, *a]]);
        ways.into_iter().find_map(|[hinge, end]| {
            let length = hinge.distance(end);
            let tip = self.tip(hinge, end, own)?;
            let at_end =
                |p: &Piece| distance_to_segment(end, p.ends) <= ERROR_GAP_M && !is_chord(p.ends, [end, tip]);
            if self.others(end - ERROR_GAP_M, end + ERROR_GAP_M, own).any(|p| at_end(&p)) {
                return None;
            }
            let turn = (end - hinge).angle_to(tip - hinge);
            let start = if turn > 0.0 { end - hinge } else { tip - hinge };
            let (start_rad, sweep_rad) = (start.to_angle(), turn.abs());
            Some(Path::Arc { centre: hinge, radius: length, start_rad, sweep_rad })
        })
    }

    /// Where a leaf closes: at the other jamb of the gap that begins at its hinge, or halfway there, where its twin meets it.
    fn tip(&self, hinge: DVec2, end: DVec2, own: usize) -> Option<DVec2> {
        let length = hinge.distance(end);
        let jambs = self.walls(hinge - BEHIND_M, hinge + BEHIND_M, own);
        let jambs = jambs.filter_map(|s| FaceEnd::at(s, hinge));
        jambs.into_iter().find_map(|jamb| {
            let open = jamb.out.angle_to(end - hinge);
            if !(OPEN_RAD[0]..=OPEN_RAD[1]).contains(&open.abs()) {
                return None;
            }
            let [at, far] = [1.0, 2.0].map(|leaves| hinge + jamb.out * length * leaves);
            let mirrored = DVec2::from_angle(PI - 2.0 * open).rotate(end - hinge);
            let has_twin = || self.goes_on(&jamb, far, own) && self.has_leaf(far, far + mirrored, own);
            let closes = self.goes_on(&jamb, at, own) || has_twin();
            (closes && self.is_clear(hinge, at, own)).then_some(at)
        })
    }

    /// Whether a face goes on at a place, in line with where it ends.
    fn goes_on(&self, jamb: &FaceEnd, at: DVec2, own: usize) -> bool {
        let FaceEnd { out, near } = *jamb;
        let mut faces = self.walls(at - BEHIND_M, at + BEHIND_M, own).filter_map(|s| FaceEnd::at(s, at));
        faces.any(|other| {
            let is_in_line = out.perp_dot(other.near - near).abs() <= ERROR_GAP_M;
            other.out.dot(out) < -ALONG_COS && is_in_line
        })
    }

    /// Whether something straight runs from a hinge to where a leaf's end would be: the twin of a leaf, in a mirror.
    fn has_leaf(&self, hinge: DVec2, end: DVec2, own: usize) -> bool {
        let is_at = |a: DVec2, b: DVec2| a.distance(hinge) <= JAMB_M && b.distance(end) <= JAMB_M;
        self.others(hinge - JAMB_M, hinge + JAMB_M, own).any(|p| {
            let [a, b] = p.ends;
            is_at(a, b) || is_at(b, a)
        })
    }

    /// Whether no wall crosses the way of a leaf from its hinge to where it closes.
    fn is_clear(&self, hinge: DVec2, at: DVec2, own: usize) -> bool {
        let frame = (at - hinge).normalize() * FINISH_MAX_M;
        let [a, b] = [hinge + frame, at - frame];
        let parts = |[p, q]: [DVec2; 2], [c, d]: [DVec2; 2]| {
            (d - c).perp_dot(p - c).signum() * (d - c).perp_dot(q - c).signum() < 0.0
        };
        // What lies along the gap is its wall's face.
        let runs_along = |[c, d]: [DVec2; 2]| {
            [c, d].iter().all(|p| (b - a).normalize().perp_dot(*p - a).abs() <= ERROR_GAP_M)
        };
        let mut others = self.walls(a.min(b), a.max(b), own).filter(|s| !runs_along(*s));
        !others.any(|s| parts([a, b], s) && parts(s, [a, b]))
    }
}

/// The leaves among things that may be one, each with the things that draw it (one, or the four lines of a slip) and with
/// the swing that it has not. `pieces`: all that is drawn near them, metres of a person.
pub(super) fn hung(
    pieces: impl Iterator<Item = Piece>,
    may: &[(usize, Vec<Path>)],
) -> Vec<(Vec<usize>, Path)> {
    let line = |(thing, paths): &(usize, Vec<Path>)| match paths[..] {
        [Path::Line { a, b }] => Some((*thing, [a, b])),
        _ => None,
    };
    let (things, lines): (Vec<usize>, Vec<[DVec2; 2]>) = may.iter().filter_map(line).unzip();
    let slips = slips(&lines);
    let members = slips.iter().flat_map(|(of, _)| of.map(|k| (things[k], things[of[0]])));
    let whole: HashMap<usize, usize> = members.collect();
    let whole_of = |thing: usize| whole.get(&thing).copied().unwrap_or(thing);
    let pieces = Pieces::new(pieces.map(|p| Piece { thing: whole_of(p.thing), ..p }));
    let side = |ring: &[DVec2; 4], k: usize| Path::Line { a: ring[k], b: ring[(k + 1) % ring.len()] };
    let of_slips = slips
        .iter()
        .map(|(of, ring)| (of.map(|k| things[k]).to_vec(), (0..ring.len()).map(|k| side(ring, k)).collect()));
    let alone = may.iter().filter(|(thing, _)| !whole.contains_key(thing));
    let alone = alone.map(|(thing, paths)| (vec![*thing], paths.clone()));
    let all = of_slips.chain(alone);
    all.filter_map(|(of, paths): (Vec<usize>, Vec<Path>)| {
        let swing = pieces.swing(&paths, whole_of(of[0]))?;
        Some((of, swing))
    })
    .collect()
}

/// Slips that are drawn by lines of their own, four each: the places of these among `lines`, and the corners in order, the
/// first line between the first two.
fn slips(lines: &[[DVec2; 2]]) -> Vec<([usize; 4], [DVec2; 4])> {
    let mut near = Buckets::new(0.25);
    lines.iter().enumerate().for_each(|(i, s)| near.add(i as u32, s));
    let crowd = Crowd::new(lines.iter().flatten().copied());
    let length = |s: [DVec2; 2]| s[0].distance(s[1]);
    // The other end of a line that ends here, and which it is.
    let on = |at: DVec2, reach: RangeInclusive<f64>, but: usize| {
        let ending = if crowd.is_at(at) { Vec::new() } else { near.near(at - COLLINEAR_M, at + COLLINEAR_M) };
        let ending = ending.into_iter();
        let ending = ending.map(|i| i as usize).filter(move |i| *i != but);
        ending.filter(move |i| reach.contains(&length(lines[*i]))).filter_map(move |i| {
            let [a, b] = lines[i];
            let meets = |p: DVec2| p.distance(at) <= COLLINEAR_M;
            if meets(a) { Some((i, b)) } else { meets(b).then_some((i, a)) }
        })
    };
    let edge = COLLINEAR_M..=THICK_M;
    let mut out = Vec::new();
    for (first, [a, b]) in lines.iter().copied().enumerate().filter(|(_, s)| LEAF_M.contains(&length(*s))) {
        let found = on(b, edge.clone(), first).find_map(|(second, c)| {
            let (third, d) = on(c, LEAF_M, first).find(|(_, d)| d.distance(a) <= THICK_M + COLLINEAR_M)?;
            let (fourth, _) = on(d, edge.clone(), third).find(|(_, e)| e.distance(a) <= COLLINEAR_M)?;
            (first < third).then_some(([first, second, third, fourth], [a, b, c, d]))
        });
        out.extend(found);
    }
    out
}

/// Whether a piece runs from where a leaf stands open to where it closes: its swing, drawn straight.
fn is_chord(piece: [DVec2; 2], [end, tip]: [DVec2; 2]) -> bool {
    let meets = |[p, q]: [DVec2; 2]| p.distance(end) <= ERROR_GAP_M && q.distance(tip) <= JAMB_M;
    meets(piece) || meets([piece[1], piece[0]])
}

/// Where the face of a wall ends beside a gap, and the direction out of it.
struct FaceEnd {
    out: DVec2,
    near: DVec2,
}

impl FaceEnd {
    /// That of a face at a place in the gap, between the faces of its wall or at one of them; none of what is too short to
    /// tell.
    fn at([a, b]: [DVec2; 2], at: DVec2) -> Option<Self> {
        let (far, near) = if a.distance(at) < b.distance(at) { (b, a) } else { (a, b) };
        let out = (near - far).try_normalize().filter(|_| far.distance(near) >= FACE_MIN_M)?;
        let beside = at - near;
        let is_at = out.dot(beside).abs() <= JAMB_M && out.perp_dot(beside).abs() <= BEHIND_M;
        is_at.then_some(Self { out, near })
    }
}

/// The long sides of what may be a leaf: one line, or a slip of four.
fn sides(paths: &[Path]) -> Vec<[DVec2; 2]> {
    let lines: Vec<[DVec2; 2]> = paths.iter().map(Path::ends).collect();
    let is_long = |s: &[DVec2; 2]| LEAF_M.contains(&s[0].distance(s[1]));
    let is_straight = paths.iter().all(|p| matches!(p, Path::Line { .. }));
    match lines[..] {
        _ if !is_straight => Vec::new(),
        [one] => [one].into_iter().filter(is_long).collect(),
        [a, b, c, d] => {
            let [p, q] =
                if a[0].distance(a[1]) > b[0].distance(b[1]) { [[a, c], [b, d]] } else { [[b, d], [a, c]] };
            let is_slip = p.iter().all(is_long)
                && q.iter().all(|s| s[0].distance(s[1]) <= THICK_M)
                && (p[0][1] - p[0][0]).angle_to(p[1][0] - p[1][1]).abs() < PI / 36.0;
            if is_slip { p.to_vec() } else { Vec::new() }
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The two faces of a wall along x with a gap of 0.9 m, and what is given beside them, number 9 last.
    fn closes(leaf: &[[f64; 4]], others: &[[f64; 4]]) -> Option<[i64; 2]> {
        let piece = |[x0, y0, x1, y1]: [f64; 4], thing: usize| Piece {
            ends: [DVec2::new(x0, y0), DVec2::new(x1, y1)],
            thing,
            is_wall: thing == 0,
        };
        let wall = [[0.0, 0.0, 2.0, 0.0], [2.9, 0.0, 5.0, 0.0], [0.0, 0.1, 2.0, 0.1], [2.9, 0.1, 5.0, 0.1]];
        let caps = [[2.0, 0.0, 2.0, 0.1], [2.9, 0.0, 2.9, 0.1]];
        let fixed = wall.into_iter().chain(caps).chain(others.iter().copied()).map(|s| piece(s, 0));
        let own = leaf.iter().map(|s| piece(*s, 9));
        let paths: Vec<Path> = own.clone().map(|p| Path::Line { a: p.ends[0], b: p.ends[1] }).collect();
        let Path::Arc { centre, sweep_rad, .. } = Pieces::new(fixed.chain(own)).swing(&paths, 9)? else {
            return None;
        };
        Some([(centre.x * 10.0).round() as i64, sweep_rad.to_degrees().round() as i64])
    }

    #[test]
    fn a_leaf_is_as_long_as_the_gap_it_hangs_at() {
        let slanting = 0.9 * std::f64::consts::FRAC_1_SQRT_2;
        for (leaf, expected) in [
            ([2.0, 0.1, 2.0, 1.0], Some([20, 90])),
            ([2.9, 1.0, 2.9, 0.1], Some([29, 90])),
            ([2.0, 0.0, 2.0 + slanting, -slanting], Some([20, 45])),
            ([2.0, 0.1, 2.0, 1.0 + JAMB_M + 0.02], None),
            ([2.0, 0.1, 2.0, 0.9 - JAMB_M], None),
            ([2.0, 0.05, 2.0, 0.95], Some([20, 90])),
            ([2.0, 0.1 + BEHIND_M + 0.02, 2.0, 1.0 + BEHIND_M + 0.02], None),
            ([2.0, 0.1, 2.89, 0.2], None),
            ([1.5, 0.1, 1.5, 1.0], None),
        ] {
            assert_eq!(closes(&[leaf], &[]), expected, "{leaf:?}");
        }
        let slip = |t: f64| {
            [
                [2.0, 0.1, 2.0, 1.0],
                [2.0, 1.0, 2.0 + t, 1.0],
                [2.0 + t, 1.0, 2.0 + t, 0.1],
                [2.0 + t, 0.1, 2.0, 0.1],
            ]
        };
        assert_eq!(closes(&slip(0.04), &[]), Some([20, 90]));
        assert_eq!(closes(&slip(0.1), &[]), None);
    }

    #[test]
    fn four_lines_round_a_slip_are_one_leaf() {
        let corners = [[2.0, 0.1], [2.0, 1.0], [2.04, 1.0], [2.04, 0.1]].map(DVec2::from);
        let mut lines: Vec<[DVec2; 2]> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        lines[2].swap(0, 1);
        lines.rotate_left(1);
        let wide: Vec<[DVec2; 2]> = lines.iter().map(|s| s.map(|p| DVec2::new(p.x * 3.0, p.y))).collect();
        let found = slips(&lines);
        assert_eq!(found.len(), 1);
        let mut of = found[0].0.to_vec();
        of.sort_unstable();
        assert_eq!(of, [0, 1, 2, 3]);
        assert_eq!(slips(&wide).len(), 0, "too thick");
        assert_eq!(slips(&lines[..3]).len(), 0, "open");
    }

    #[test]
    fn what_ends_at_something_or_hangs_at_no_gap_is_no_leaf() {
        let leaf = [2.0, 0.1, 2.0, 1.0];
        // The face of a wall that goes on; a wall in the gap.
        assert_eq!(closes(&[leaf], &[[2.0, 1.0, 2.1, 1.0]]), None);
        assert_eq!(closes(&[leaf], &[[2.4, -1.0, 2.4, 1.0]]), None);
        assert_eq!(closes(&[leaf], &[[5.0, 0.0, 5.0, 1.0]]), Some([20, 90]));
        // Its swing as a chord, to the jamb and to no place.
        assert_eq!(closes(&[leaf], &[[2.0, 1.0, 2.9, 0.1]]), Some([20, 90]));
        assert_eq!(closes(&[leaf], &[[2.0, 1.0, 2.5, 0.1]]), None);
    }

    #[test]
    fn two_leaves_meet_in_the_middle_of_a_gap() {
        let piece = |[x0, y0, x1, y1]: [f64; 4], thing: usize| Piece {
            ends: [DVec2::new(x0, y0), DVec2::new(x1, y1)],
            thing,
            is_wall: thing == 0,
        };
        let wall = [[0.0, 0.0, 2.0, 0.0], [3.6, 0.0, 6.0, 0.0], [0.0, 0.1, 2.0, 0.1], [3.6, 0.1, 6.0, 0.1]];
        let leaves = [[2.0, 0.1, 2.4, 0.1 + 0.48_f64.sqrt()], [3.6, 0.1, 3.2, 0.1 + 0.48_f64.sqrt()]];
        let leaning = [3.6, 0.1, 3.6, 0.9];
        let closes = |twin: Option<[f64; 4]>| {
            let all = wall.iter().map(|w| piece(*w, 0)).chain([piece(leaves[0], 8)]);
            let pieces = Pieces::new(all.chain(twin.map(|t| piece(t, 9))));
            let [a, b] = piece(leaves[0], 8).ends;
            let Path::Arc { radius, sweep_rad, .. } = pieces.swing(&[Path::Line { a, b }], 8)? else {
                return None;
            };
            Some([(radius * 10.0).round() as i64, sweep_rad.to_degrees().round() as i64])
        };
        assert_eq!(closes(Some(leaves[1])), Some([8, 60]));
        assert_eq!(closes(Some(leaning)), None);
        assert_eq!(closes(None), None);
    }
}
