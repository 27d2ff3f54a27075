//! Doors that nothing but their swings show, because no two ends of a wall face each other: between sides of walls,
//! in corners, between columns. A leaf, or two that meet, closes the way from what stands beside its hinge to what
//! stands beyond its tip.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::carrier::Carrier;
use super::evidence::{Evidence, trace};
use super::near::Buckets;
use super::swing::Swing;
use super::{AxisGraph, Drawn, Edge, Jamb, NodeKind, Opening, OpeningKind, Path, Shown};
use crate::sizes::{ERROR_GAP_M, FINISH_MAX_M, FRAME_M, OPENING_MIN_M, SQUARE_SIN, THICKNESS_THIN_M};
use enfilade_cad::curve::bulge_arc;
use enfilade_cad::plane::{distance_to_segment, is_inside_ring};

/// How far beyond a hinge or a tip its jamb may stand: the frame.
const JAMB_BEYOND_M: f64 = 0.2;
/// Swings may end this far before their leaves are closed.
const AJAR_RAD: f64 = 0.35;
/// Leaves that meet are alike up to this share.
const LIKE_SHARE: f64 = 0.15;
/// Half the thickness of a wall drawn as one line.
const SINGLE_HALF_M: f64 = 0.02;
/// Ends of an open leaf's line are this near to hinge and tip, as a share of its length.
const LEAF_SHARE: f64 = 0.12;
/// Openings whose middles are nearer than this share of the leaf are one.
const SAME_PLACE_SHARE: f64 = 0.5;

/// A way in which a leaf may close.
#[derive(Clone, Copy)]
struct Leaf {
    mark: u32,
    hinge: DVec2,
    tip: DVec2,
}

impl Leaf {
    fn length(&self) -> f64 {
        self.hinge.distance(self.tip)
    }

    /// Whether the two close one opening: each as long as half the way from hinge to hinge, and along it.
    fn meets(&self, other: &Self) -> bool {
        let (a, b, way) = (self.length(), other.length(), other.hinge - self.hinge);
        let is_along = |l: &Self, way: DVec2| (l.tip - l.hinge).angle_to(way).abs() <= AJAR_RAD;
        (a - b).abs() <= LIKE_SHARE * a
            && (way.length() - a - b).abs() <= LIKE_SHARE * a
            && is_along(self, way)
            && is_along(other, -way)
    }
}

/// What a door may hang at.
enum Body {
    Wall(u32),
    Column(u32),
}

/// The doors that the openings found so far do not hold.
pub fn find(evidence: &Evidence<'_>, graph: &AxisGraph, found: &[Opening]) -> Vec<Opening> {
    let scene = Scene::new(evidence, graph);
    let mut claimed: BTreeSet<u32> = found.iter().flat_map(|o| o.marks.iter().copied()).collect();
    let leaves = leaves(evidence.drawn, &claimed);
    let mut out: Vec<Opening> = Vec::new();
    let mut take = |opening: Option<Opening>, claimed: &mut BTreeSet<u32>| {
        let Some(o) = opening else { return };
        let is_new = |p: &Opening| {
            let reach = SAME_PLACE_SHARE * o.width_m.min(p.width_m);
            p.centre.distance(o.centre) > reach
        };
        if found.iter().chain(&out).all(is_new) {
            claimed.extend(&o.marks);
            out.push(o);
        }
    };
    for (a, b) in twins(&leaves) {
        if !claimed.contains(&a.mark) && !claimed.contains(&b.mark) {
            take(scene.door([a.hinge, b.hinge], &[a.mark, b.mark]), &mut claimed);
        }
    }
    for of_arc in leaves.chunk_by(|a, b| a.mark == b.mark && a.hinge == b.hinge) {
        if claimed.contains(&of_arc[0].mark) {
            continue;
        }
        let closes = |l: &&Leaf| scene.door([l.hinge, l.tip], &[l.mark]).is_some();
        let mut may: Vec<&Leaf> = of_arc.iter().filter(closes).collect();
        if may.len() > 1 {
            may.retain(|l| !scene.has_leaf_at(l));
        }
        if let [l] = may[..] {
            take(scene.door([l.hinge, l.tip], &[l.mark]), &mut claimed);
        }
    }
    out
}

/// The ways in which the swings close that belong to no opening yet; those of one swing follow each other.
fn leaves(drawn: &Drawn, claimed: &BTreeSet<u32>) -> Vec<Leaf> {
    let mut out: Vec<Leaf> = Vec::new();
    let mut seen: BTreeSet<[i64; 4]> = BTreeSet::new();
    for (m, mark) in drawn.marks.iter().enumerate() {
        if claimed.contains(&(m as u32)) {
            continue;
        }
        for swing in mark.paths.iter().filter_map(Swing::of) {
            // The parts of a swing that was drawn in parts have one arc.
            let is_new = |l: &Leaf| {
                let mm = [l.hinge.x, l.hinge.y, l.tip.x, l.tip.y].map(|v| (v * 1e3).round() as i64);
                seen.insert(mm)
            };
            let ways = swing.tips().into_iter().map(|tip| Leaf { mark: m as u32, hinge: swing.hinge, tip });
            out.extend(ways.filter(is_new));
        }
    }
    out
}

/// Where the leaves of double doors meet, by mark: hinge and tip. Their other ends are where they stand open.
pub fn meeting(drawn: &Drawn) -> BTreeMap<u32, Vec<[DVec2; 2]>> {
    let leaves = leaves(drawn, &BTreeSet::new());
    let mut out: BTreeMap<u32, Vec<[DVec2; 2]>> = BTreeMap::new();
    for (a, b) in twins(&leaves) {
        [a, b].iter().for_each(|l| out.entry(l.mark).or_default().push([l.hinge, l.tip]));
    }
    out
}

/// Leaves that close one opening together.
fn twins(leaves: &[Leaf]) -> Vec<(Leaf, Leaf)> {
    let mut near = Buckets::new(2.0);
    leaves.iter().enumerate().for_each(|(i, l)| near.add(i as u32, &[l.tip]));
    let mut out = Vec::new();
    for (i, a) in leaves.iter().enumerate() {
        let later = near.near(a.tip, a.tip).into_iter().map(|j| j as usize).filter(|j| *j > i);
        out.extend(later.map(|j| leaves[j]).filter(|b| a.meets(b)).map(|b| (*a, b)));
    }
    out
}

struct Scene<'a> {
    evidence: &'a Evidence<'a>,
    graph: &'a AxisGraph,
    bodies: Vec<(Body, Vec<DVec2>)>,
    near: Buckets,
}

impl<'a> Scene<'a> {
    fn new(evidence: &'a Evidence<'a>, graph: &'a AxisGraph) -> Self {
        let walls = graph.edges.iter().enumerate().map(|(i, e)| (Body::Wall(i as u32), outline(graph, e)));
        let columns = graph.nodes.iter().enumerate().filter_map(|(i, n)| match &n.kind {
            NodeKind::Column(ring) => Some((Body::Column(i as u32), ring.clone())),
            _ => None,
        });
        let bodies: Vec<(Body, Vec<DVec2>)> = walls.chain(columns).collect();
        let mut near = Buckets::new(1.0);
        for (i, (_, ring)) in bodies.iter().enumerate() {
            sides(ring).for_each(|s| near.add(i as u32, &s));
        }
        Self { evidence, graph, bodies, near }
    }

    /// Whether a line is drawn from hinge to tip: the leaf stands open there.
    fn has_leaf_at(&self, leaf: &Leaf) -> bool {
        let near = LEAF_SHARE * leaf.length();
        self.evidence.drawn.marks.iter().flat_map(|m| &m.paths).any(|p| {
            let [a, b] = p.ends();
            let is_along =
                |from: DVec2, to: DVec2| from.distance(leaf.hinge) <= near && to.distance(leaf.tip) <= near;
            matches!(p, Path::Line { .. }) && (is_along(a, b) || is_along(b, a))
        })
    }

    /// The door whose leaves, closed, reach from one place to the other, if something stands at both.
    fn door(&self, [p, q]: [DVec2; 2], marks: &[u32]) -> Option<Opening> {
        let along = (q - p).try_normalize()?;
        let (first, last) = (self.stands_at(p, -along)?, self.stands_at(q, along)?);
        let placed = [(p, -along, first), (q, along, last)].map(|(at, out, (s, body))| {
            let (jamb, wall) = self.jamb(body, at + out * s, along);
            (at + out * s, jamb, wall)
        });
        // On the axis of the walls in line with it.
        let beside = |wall: &Option<(&Edge, DVec2)>| wall.map(|(_, axis)| along.perp_dot(axis - p));
        let offsets: Vec<f64> = placed.iter().filter_map(|(_, _, wall)| beside(wall)).collect();
        let offset = offsets.iter().sum::<f64>() / offsets.len().max(1) as f64;
        let walls = placed.iter().filter_map(|(_, _, wall)| *wall);
        let thickness_m = walls.map(|(e, _)| e.thickness_m).fold(0.0, f64::max);
        let thickness_m = if thickness_m > 0.0 { thickness_m } else { THICKNESS_THIN_M };
        let [a, b] = placed.map(|(at, jamb, _)| Jamb { at: at + along.perp() * offset, ..jamb });
        let width_m = (b.at - a.at).dot(along);
        if width_m < OPENING_MIN_M.max(p.distance(q) - 2.0 * FRAME_M) || !self.is_clear(a.at, b.at) {
            return None;
        }
        let seen = self.evidence.look(&Carrier::line(a.at, b.at), thickness_m, [0.0, width_m]);
        let mut all: Vec<u32> = seen.marks.into_iter().chain(marks.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        Some(Opening {
            kind: OpeningKind::Door,
            centre: a.at.midpoint(b.at),
            width_m,
            thickness_m,
            jambs: [a, b],
            shown: Shown::Swing,
            marks: all,
            faces: self.evidence.drawn.refs(&seen.faces),
            through: Vec::new(),
        })
    }

    /// The nearest body that begins beside a place in a direction, and how far from it.
    fn stands_at(&self, at: DVec2, out: DVec2) -> Option<(f64, usize)> {
        let (from, to) = (at - out * FRAME_M, at + out * JAMB_BEYOND_M);
        let mut best: Option<(f64, usize)> = None;
        for i in self.near.near(from.min(to) - FINISH_MAX_M, from.max(to) + FINISH_MAX_M) {
            for side in sides(&self.bodies[i as usize].1) {
                for beside in [0.0, -FINISH_MAX_M, FINISH_MAX_M] {
                    let ray = [from, to].map(|p| p + out.perp() * beside);
                    let s = crossing(ray, side).map(|share| share * (FRAME_M + JAMB_BEYOND_M) - FRAME_M);
                    if let Some(s) = s.filter(|s| best.is_none_or(|b| *s < b.0 - 1e-9)) {
                        best = Some((s, i as usize));
                    }
                }
            }
        }
        best
    }

    /// The jamb that a body makes at a place, and the wall with a point of its axis if it runs along the door.
    fn jamb(&self, body: usize, at: DVec2, along: DVec2) -> (Jamb, Option<(&Edge, DVec2)>) {
        let jamb = |node, edge| Jamb { at, node, edge };
        let wall = match self.bodies[body].0 {
            Body::Column(node) => return (jamb(Some(node), None), None),
            Body::Wall(wall) => wall,
        };
        let edge = &self.graph.edges[wall as usize];
        let ends = self.graph.ends(edge);
        let is_along =
            edge.bulge == 0.0 && (ends[1] - ends[0]).normalize_or_zero().dot(along).abs() > SQUARE_SIN;
        let near = usize::from(ends[1].distance(at) < ends[0].distance(at));
        if is_along && ends[near].distance(at) <= edge.thickness_m + JAMB_BEYOND_M {
            (jamb(Some(edge.nodes[near]), None), Some((edge, ends[near])))
        } else {
            (jamb(None, Some(wall)), None)
        }
    }

    /// Whether no wall and no column stands between two jambs, or runs along the line between them.
    fn is_clear(&self, a: DVec2, b: DVec2) -> bool {
        let near = self.near.near(a.min(b) - ERROR_GAP_M, a.max(b) + ERROR_GAP_M);
        [0.15, 0.3, 0.5, 0.7, 0.85].into_iter().all(|t| {
            let p = a.lerp(b, t);
            near.iter().all(|i| {
                let ring = &self.bodies[*i as usize].1;
                !is_inside_ring(ring, p) && sides(ring).all(|s| distance_to_segment(p, s) > ERROR_GAP_M)
            })
        })
    }
}

/// The ground that a wall stands on.
fn outline(graph: &AxisGraph, edge: &Edge) -> Vec<DVec2> {
    let [a, b] = graph.ends(edge);
    let half = if edge.thickness_m > 0.0 { edge.thickness_m / 2.0 } else { SINGLE_HALF_M };
    let axis = match bulge_arc(a, b, edge.bulge) {
        Some((centre, radius, start_rad, sweep)) => trace(&Path::Arc {
            centre,
            radius,
            start_rad: if sweep < 0.0 { start_rad + sweep } else { start_rad },
            sweep_rad: sweep.abs(),
        }),
        None => vec![a, b],
    };
    let n = axis.len() - 1;
    let side =
        |k: usize| (axis[(k + 1).min(n)] - axis[k.saturating_sub(1)]).normalize_or_zero().perp() * half;
    let left = (0..=n).map(|k| axis[k] + side(k));
    let right = (0..=n).rev().map(|k| axis[k] - side(k));
    left.chain(right).collect()
}

fn sides(ring: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// Where on a ray, as a share of it, a segment crosses it.
fn crossing([p, q]: [DVec2; 2], [a, b]: [DVec2; 2]) -> Option<f64> {
    let (u, v) = (q - p, b - a);
    let turn = u.perp_dot(v);
    let (s, t) = ((a - p).perp_dot(v) / turn, (a - p).perp_dot(u) / turn);
    ((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)).then_some(s)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::super::Role;
    use super::super::swing::{BOTH_WAYS_RAD, TURN_END_RAD};
    use super::super::tests::{lines, mark};
    use super::*;

    fn swing(x: f64, y: f64, radius: f64, start_rad: f64, sweep_rad: f64) -> Path {
        Path::Arc { centre: DVec2::new(x, y), radius, start_rad, sweep_rad }
    }

    /// Two walls 0.2 m thick along x, their faces towards each other at y = 0 and y = 1.8, and a wall across at x = 8.
    fn corridor(marks: &[Path]) -> Drawn {
        let mut out = lines(&[
            [0.0, 0.0, 8.0, 0.0],
            [0.0, -0.2, 8.0, -0.2],
            [0.0, 1.8, 8.0, 1.8],
            [0.0, 2.0, 8.0, 2.0],
            [8.0, -0.2, 8.0, 2.0],
            [8.2, -0.2, 8.2, 2.0],
        ]);
        out.marks = marks.iter().map(|p| mark(*p, Role::Unknown)).collect();
        out
    }

    fn doors(drawn: &Drawn) -> Vec<Opening> {
        AxisGraph::new(drawn).openings.into_iter().filter(|o| o.kind == OpeningKind::Door).collect()
    }

    #[test]
    fn two_leaves_close_the_way_between_the_sides_of_two_walls() {
        let one_way = [swing(3.0, 0.05, 0.85, 0.0, FRAC_PI_2), swing(3.0, 1.75, 0.85, -FRAC_PI_2, FRAC_PI_2)];
        let both_ways = [swing(3.0, 0.0, 0.9, 0.0, PI), swing(3.0, 1.8, 0.9, PI, PI)];
        for leaves in [one_way, both_ways] {
            let found = doors(&corridor(&leaves));
            assert_eq!(found.len(), 1, "{leaves:?}");
            let door = &found[0];
            assert!(door.centre.distance(DVec2::new(3.0, 0.9)) < 0.01 && (door.width_m - 1.8).abs() < 0.01);
            assert_eq!(door.marks, [0, 1]);
            assert!(door.jambs.iter().all(|j| j.node.is_none() && j.edge.is_some()), "{:?}", door.jambs);
        }
    }

    #[test]
    fn how_far_a_leaf_turns_says_where_it_closes() {
        // It stands open both ways along the walls: only the middle of its turn closes the way.
        let turned = |sweep: f64| {
            let leaves = [(0.0, FRAC_PI_2), (1.8, -FRAC_PI_2)];
            leaves.map(|(y, middle)| swing(3.0, y, 0.9, middle - sweep / 2.0, sweep))
        };
        for (sweep, count) in [
            (BOTH_WAYS_RAD + 0.01, 1),
            (BOTH_WAYS_RAD - 0.01, 0),
            (TURN_END_RAD - 0.01, 1),
            (TURN_END_RAD, 0),
        ] {
            assert_eq!(doors(&corridor(&turned(sweep))).len(), count, "{sweep}");
        }
    }

    #[test]
    fn a_leaf_closes_the_way_between_a_wall_and_a_column() {
        let mut drawn = corridor(&[swing(3.0, 0.14, 0.8, 0.0, FRAC_PI_2)]);
        let column = lines(&[[2.8, 0.95, 3.2, 0.95], [3.2, 0.95, 3.2, 1.35], [3.2, 1.35, 2.8, 1.35]]);
        drawn.faces.extend(column.faces);
        drawn.faces.extend(lines(&[[2.8, 1.35, 2.8, 0.95]]).faces);
        (0..drawn.faces.len()).for_each(|i| drawn.faces[i].wall = i as u32);
        let found = doors(&drawn);
        assert_eq!(found.len(), 1);
        assert!((found[0].width_m - 0.95).abs() < 0.01, "{}", found[0].width_m);
        assert!(found[0].jambs[0].edge.is_some() && found[0].jambs[1].node.is_some());
    }

    #[test]
    fn what_is_round_in_a_corner_or_in_the_middle_of_a_room_is_no_door() {
        for round in [swing(8.0, 0.0, 0.9, FRAC_PI_2, FRAC_PI_2), swing(4.0, 0.9, 0.6, 0.0, FRAC_PI_2)] {
            assert_eq!(doors(&corridor(&[round])), [], "{round:?}");
        }
    }
}
