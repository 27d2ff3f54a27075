//! How far a chain may slide: what grows short, the next joint, what stands in the way.

use std::collections::BTreeSet;

use glam::DVec2;

use super::super::doorways::CLEAR_MIN_M;
use super::super::joined::CROSSING_MIN_RAD;
use super::super::joined::along;
use super::super::neighbours::Piece;
use super::super::sizes::PARTITION_SLIDE_M;
use super::super::sliding::clipped;
use super::super::things::{AT_WALL_M, Thing};
use super::chain::{BESIDE_M, Chain, Own};
use super::{Axial, PARALLEL_SIN, REST_M, Stays};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, Shape};
use enfilade_cad::plane::box_of;
use enfilade_plan::axes::{Edge, FaceRef, NodeKind, OpeningKind};
use enfilade_plan::graph::Handle;
use enfilade_plan::obstacles::ObstacleKind;
use enfilade_plan::structure::{face_handles, handle_at};

/// What stays free between a sliding partition and the next thing beside it.
const PASSAGE_M: f64 = 0.8;

/// Directions whose angle has a smaller sine are one: over the widest way they part by less than a tenth of a
/// millimetre.
const SAME_SIN: f64 = 1e-4;

/// What lies this far between a wall's faces stands in it.
const IN_WALL_M: f64 = 0.005;

impl<'a> Axial<'a> {
    /// How far the joints at a chain's nodes let it slide: the walls that it ends at run across it, and the
    /// next joint on them stays. An error where a wall leaves it at another angle and does not go straight on
    /// beyond it, or it ends at a column. The faces of walls at another angle are added to `oblique`: the
    /// joint is mitred anew.
    pub(super) fn joint_way(
        &self,
        chain: &Chain,
        oblique: &mut BTreeSet<FaceRef>,
    ) -> Result<[f64; 2], Stays> {
        let mut way = [f64::MIN, f64::MAX];
        let nodes: BTreeSet<u32> =
            chain.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes).collect();
        let mut is_held = false;
        for n in nodes {
            if self.stands_at_column(self.axes.nodes[n as usize].at, chain.thickness) {
                return Err(Stays::Joined);
            }
            for (_, e) in self.around(n).filter(|(i, _)| !chain.edges.contains(i)) {
                let other = e.nodes[usize::from(e.nodes[0] == n)];
                let y = chain.local(self.axes.nodes[other as usize].at).y;
                let to = self.axes.nodes[other as usize].at - self.axes.nodes[n as usize].at;
                let is_across =
                    e.bulge == 0.0 && to.normalize_or_zero().dot(chain.along).abs() < PARALLEL_SIN;
                if !is_across {
                    let sin = to.normalize_or_zero().perp_dot(chain.along).abs();
                    if e.bulge != 0.0 || sin < CROSSING_MIN_RAD.sin() || !self.goes_on(n, e) {
                        return Err(Stays::Joined);
                    }
                    oblique.extend(e.left.iter().chain(&e.right));
                }
                is_held = true;
                let rest = REST_M + chain.thickness / 2.0 + self.half_at(other, e);
                if y > 0.0 { way[1] = way[1].min(y - rest) } else { way[0] = way[0].max(y + rest) }
            }
        }
        if is_held { Ok(way) } else { Err(Stays::Unheld) }
    }

    /// Whether a wall goes straight on beyond a node: a drawn face of it belongs to both its parts.
    pub(super) fn goes_on(&self, node: u32, edge: &Edge) -> bool {
        let shares = |f: &Edge| {
            let mut faces = f.left.iter().chain(&f.right);
            !std::ptr::eq(f, edge) && faces.any(|f| edge.left.contains(f) || edge.right.contains(f))
        };
        self.around(node).any(|(_, f)| shares(f))
    }

    /// How far the ends of walls that change their length with a chain let it slide: what of their bodies stays, at whatever
    /// height, ends their way. Metres of a person.
    pub(super) fn ends_way(&self, own: &Own, direction: DVec2) -> [f64; 2] {
        let mut way = [f64::MIN, f64::MAX];
        let per_unit = self.plan.frame.metres_per_unit / self.plan.human_scale;
        for (w, c) in &own.handles {
            let wall = &self.plan.walls[*w as usize];
            let Editable::Wall { ends, free } = &wall.editable else { continue };
            let record = wall.source.record;
            let Some(along) = self.whole.get(&record).and_then(|all| along(self.plan, all)) else { continue };
            for end in (0..2).filter(|end| !own.records.contains(&record) && ends[*end].contains(c)) {
                let inward = if end == 0 { along } else { -along };
                let rest = (free[end] * per_unit - REST_M).max(0.0);
                if inward.dot(direction) > 0.0 {
                    way[1] = way[1].min(rest);
                } else {
                    way[0] = way[0].max(-rest);
                }
            }
        }
        way
    }

    /// How far nodes may shift in a direction until a stretched piece grows too short, metres of a person.
    /// `None` where a piece would turn that is none of the `oblique` ones, which keep their line.
    pub(super) fn stretch(
        &self,
        taken: &BTreeSet<Handle>,
        direction: DVec2,
        oblique: &BTreeSet<FaceRef>,
    ) -> Option<[f64; 2]> {
        let mut way = [f64::MIN, f64::MAX];
        for w in walls_of(taken) {
            let shape = &self.plan.walls[w as usize].shape;
            for (c, n) in self.pieces(w) {
                let ends = [c, (c + 1) % n];
                let moves = ends.map(|c| taken.contains(&(w, c)));
                if moves[0] == moves[1] {
                    continue;
                }
                let is_round =
                    matches!(shape, Shape::Polyline { vertices, .. } if vertices[c as usize].bulge != 0.0);
                let [at, to] = ends.map(|c| handle_at(self.plan, (w, c)));
                let d = if moves[0] { to - at } else { at - to };
                let turns = d.normalize_or_zero().perp_dot(direction).abs() > PARALLEL_SIN;
                if is_round || turns && !oblique.contains(&(w, c)) {
                    return None;
                }
                let y = d.dot(direction);
                let rest = (y.abs() - REST_M).max(0.0);
                if y > 0.0 { way[1] = way[1].min(rest) } else { way[0] = way[0].max(-rest) }
            }
        }
        Some(way)
    }

    /// The direction in which the pieces run that a shift of nodes stretches, near `direction`: a joint that slides
    /// along them leaves no bend in them, however askew they were drawn.
    pub(super) fn along_stretched(&self, taken: &BTreeSet<Handle>, direction: DVec2) -> DVec2 {
        let mut sum = DVec2::ZERO;
        for w in walls_of(taken) {
            for (c, n) in self.pieces(w) {
                let ends = [c, (c + 1) % n];
                let [first, second] = ends.map(|c| taken.contains(&(w, c)));
                let [a, b] = ends.map(|c| handle_at(self.plan, (w, c)));
                let sine = (b - a).normalize_or_zero().perp_dot(direction);
                if first != second && sine.abs() <= PARALLEL_SIN {
                    sum += (b - a) * (b - a).dot(direction).signum();
                }
            }
        }
        let mean = sum.try_normalize().unwrap_or(direction);
        if mean.perp_dot(direction).abs() < SAME_SIN { direction } else { mean }
    }

    /// The pieces of a wall: first control point of each, and the number of control points.
    pub(super) fn pieces(&self, w: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        let shape = &self.plan.walls[w as usize].shape;
        let n = control_points(shape).len() as u32;
        let last =
            if matches!(shape, Shape::Polyline { closed: true, .. }) { n } else { n.saturating_sub(1) };
        (0..last).map(move |c| (c, n))
    }

    /// The faces of walls that end at a chain, and what closes their far ends: they grow longer or shorter with it.
    pub(super) fn faces_of_joined(&self, chain: &Chain) -> Vec<FaceRef> {
        let mut out = Vec::new();
        for n in chain.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes) {
            for (_, e) in self.around(n).filter(|(i, _)| !chain.edges.contains(i)) {
                let far = &self.axes.nodes[e.nodes[usize::from(e.nodes[0] == n)] as usize];
                let caps = if matches!(far.kind, NodeKind::End) { far.faces.as_slice() } else { &[] };
                out.extend(e.left.iter().chain(&e.right).chain(&e.inner).chain(caps));
            }
        }
        out
    }

    /// How far the joints at a chain's ends reach into it: half its own thickness, or half that of a wall it ends at, whose
    /// side may be drawn past the joint.
    pub(super) fn joints_of(&self, chain: &Chain) -> [f64; 2] {
        let mut out = [chain.thickness / 2.0; 2];
        for n in chain.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes) {
            let x = chain.local(self.axes.nodes[n as usize].at).x;
            let others = self.around(n).filter(|(i, _)| !chain.edges.contains(i));
            let half = others.map(|(_, e)| e.thickness_m / 2.0).fold(0.0, f64::max);
            for (end, at) in [chain.from, chain.to].into_iter().enumerate() {
                if (x - at).abs() < BESIDE_M {
                    out[end] = out[end].max(half);
                }
            }
        }
        out
    }

    /// How far a chain may slide until something stands too near; walls at another angle that it slides along are
    /// no hindrance. `None` where a piece that stays lies in
    /// the wall.
    pub(super) fn free_way(
        &self,
        chain: &Chain,
        nodes: &[u32],
        oblique: &BTreeSet<FaceRef>,
    ) -> Option<[f64; 2]> {
        let node = |h: Handle| self.graph.control_nodes[h.0 as usize][h.1 as usize];
        let ends = |f: &FaceRef| face_handles(self.plan, *f).into_iter().map(node).collect();
        let of_joined = self.faces_of_joined(chain);
        let joined: BTreeSet<Vec<u32>> = oblique.iter().chain(&of_joined).map(ends).collect();
        let (own, [first, last]) = (chain.thickness / 2.0, self.joints_of(chain));
        let (from, to) = (chain.from + first + BESIDE_M, chain.to - last - BESIDE_M);
        let mut way = [f64::MIN, f64::MAX];
        let reach = own + PARTITION_SLIDE_M + PASSAGE_M;
        let corners = [(from, -reach), (to, -reach), (from, reach), (to, reach)];
        let corners = corners.map(|(x, y)| chain.world(x, y));
        let [lo, hi] = box_of(corners.into_iter())?;
        for p in self.neighbours.near(lo, hi).into_iter().map(|i| &self.pieces[i as usize]) {
            let is_own = p.nodes.iter().any(|n| nodes.binary_search(n).is_ok());
            if is_own || joined.contains(&p.nodes[..]) {
                continue;
            }
            let Some([lo, hi]) = clipped(chain.local(p.a), chain.local(p.b), from, to) else { continue };
            if lo <= own && hi >= -own {
                return None;
            }
            let room = |gap: f64| (gap - own - PASSAGE_M).max(0.0);
            if lo > 0.0 { way[1] = way[1].min(room(lo)) } else { way[0] = way[0].max(-room(-hi)) }
        }
        Some(way)
    }

    /// Bounds a way by the things on it; `false` where one stands in the wall or at it: the wall stays. What is part of
    /// a door that goes along is no hindrance; what is part of another only ends the way.
    pub(super) fn keep_off_things(
        &self,
        chain: &Chain,
        moving: &BTreeSet<Handle>,
        way: &mut [f64; 2],
    ) -> bool {
        let own = chain.thickness / 2.0;
        let reach = own + PARTITION_SLIDE_M + AT_WALL_M;
        let corners = [(chain.from, -reach), (chain.to, -reach), (chain.from, reach), (chain.to, reach)];
        let Some(around) = box_of(corners.into_iter().map(|(x, y)| chain.world(x, y))) else { return true };
        for thing in self.things.near(around).filter(|t| !self.things.goes_along(t, moving)) {
            let is_of_door = thing.kind == ObstacleKind::Door || self.things.is_fitted(thing);
            let inset = if is_of_door { own + BESIDE_M } else { 0.0 };
            for [a, b] in &thing.pieces {
                let [a, b] = [a, b].map(|p| chain.local(*p));
                let Some([lo, hi]) = clipped(a, b, chain.from + inset, chain.to - inset) else { continue };
                let gap = lo.max(-hi) - own;
                let is_held = if is_of_door { gap < -IN_WALL_M } else { gap < AT_WALL_M };
                if is_held {
                    return false;
                }
                let room = (gap - AT_WALL_M).max(0.0);
                if lo > -hi { way[1] = way[1].min(room) } else { way[0] = way[0].max(-room) }
            }
        }
        true
    }

    /// Bounds a way by what stands before the furniture that follows: other walls as far as a way, things, and the space
    /// before doors.
    pub(super) fn keep_furniture_off(
        &self,
        chain: &Chain,
        (nodes, moving): (&[u32], &BTreeSet<Handle>),
        way: &mut [f64; 2],
    ) {
        let beside = chain.thickness / 2.0 + AT_WALL_M;
        let corners = [(chain.from, -beside), (chain.to, -beside), (chain.from, beside), (chain.to, beside)];
        let Some(at_chain) = box_of(corners.into_iter().map(|(x, y)| chain.world(x, y))) else { return };
        let local = |[a, b]: [DVec2; 2]| [chain.local(a), chain.local(b)];
        let furniture = |t: &&Thing| self.things.is_furniture(t) && self.things.goes_along(t, moving);
        let along: Vec<&Thing> = self.things.near(at_chain).filter(furniture).collect();
        let Some([lo, hi]) = box_of(along.iter().flat_map(|t| &t.pieces).flatten().copied()) else { return };
        let around = [lo - (PARTITION_SLIDE_M + PASSAGE_M), hi + (PARTITION_SLIDE_M + PASSAGE_M)];
        let boxes: Vec<[DVec2; 2]> =
            along.iter().filter_map(|t| box_of(t.pieces.iter().flat_map(|p| local(*p)))).collect();
        let still: Vec<&Thing> =
            self.things.near(around).filter(|t| !self.things.goes_along(t, moving)).collect();
        let is_own = |p: &&Piece| p.nodes.iter().any(|n| nodes.binary_search(n).is_ok());
        let walls = self.neighbours.near(around[0], around[1]).into_iter().map(|i| &self.pieces[i as usize]);
        let walls = walls.filter(|p| !is_own(p)).map(|p| ([p.a, p.b], PASSAGE_M));
        let things = still.iter().flat_map(|t| &t.pieces).map(|p| (*p, AT_WALL_M));
        let doors = (0u32..).zip(&self.axes.openings).filter(|(_, o)| o.kind != OpeningKind::Window);
        let others = doors.filter(|(i, _)| !chain.openings.contains(i));
        let before = others.flat_map(|(_, o)| {
            let [a, b] = o.jambs.map(|j| j.at);
            let deep =
                (b - a).normalize_or_zero().perp() * (o.thickness_m / 2.0 + o.width_m.max(CLEAR_MIN_M));
            let ring = [a + deep, b + deep, b - deep, a - deep];
            (0..4).map(move |k| ([ring[k], ring[(k + 1) % 4]], 0.0))
        });
        for (piece, clear) in walls.chain(things).chain(before) {
            for [lo, hi] in &boxes {
                let [a, b] = local(piece);
                let Some([near, far]) = clipped(a, b, lo.x + BESIDE_M, hi.x - BESIDE_M) else { continue };
                // What is narrow already may not become narrower.
                if near >= hi.y - BESIDE_M {
                    way[1] = way[1].min((near - hi.y - clear).max(0.0));
                } else if far <= lo.y + BESIDE_M {
                    way[0] = way[0].max(-(lo.y - far - clear).max(0.0));
                }
            }
        }
    }
}

/// The walls of some control points.
fn walls_of(taken: &BTreeSet<Handle>) -> BTreeSet<u32> {
    taken.iter().map(|h| h.0).collect()
}
