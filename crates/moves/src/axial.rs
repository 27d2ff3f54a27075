//! What may move of thick walls, by their axes: partitions slide between the walls they join, door gaps
//! slide along the wall they are in.
//!
//! A set of corners may shift in a direction if every drawn piece that has one end in the set runs in that
//! direction: it is stretched and stays where it is. How far is bounded by the pieces that grow short, by
//! the next joint, and by what stands in the way.

mod slots;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::doorways::CLEAR_MIN_M;
use super::followed::along;
use super::mitre::CROSSING_MIN_RAD;
use super::neighbours::{Neighbours, Piece};
use super::remains::REST_M;
use super::sizes::{DOOR_WIDTH_M, PARTITION_SLIDE_M, PARTITION_THICKNESS_MAX_M, SLIDE_M, SLIDE_MIN_M};
use super::sliding::{Sliding, clipped, upright, whole_mm};
use super::things::{AT_WALL_M, Things};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, Shape};
use enfilade_cad::plane::{box_of, distance_to_segment};
use enfilade_engine::interior::Interior;
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Edge, FaceRef, Jamb, NodeKind, Opening, OpeningKind};
use enfilade_plan::fittings::jambs_of;
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::obstacles::ObstacleKind;
use enfilade_plan::structure::{end_handles, face_handles, handle_at};

/// A wall that is so many times as thick as the drawing's inner walls mostly are carries too, if it is thicker than
/// [`CARRYING_MIN_M`].
const CARRYING_RATIO: f64 = 2.0;

/// No wall up to this thickness is taken to carry.
const CARRYING_MIN_M: f64 = 0.2;

/// A partition has the interior on both sides wherever it is looked at: every so many metres, but this far from its ends.
const LOOK_M: f64 = 0.5;

/// Shortest partition.
const PARTITION_LENGTH_MIN_M: f64 = 0.8;

/// What stays free between a sliding partition and the next thing beside it.
const PASSAGE_M: f64 = 0.8;

/// Pieces whose direction differs by less than this sine run in one direction.
const PARALLEL_SIN: f64 = 0.02;

/// Directions whose angle has a smaller sine are one: over the widest way they part by less than a tenth of a
/// millimetre.
const SAME_SIN: f64 = 1e-4;

/// How far from a wall's axis its own corners may lie beyond half its thickness.
const BESIDE_M: f64 = 0.06;

/// The end of a wall stands at a column that is no farther away than this, beyond half the wall's thickness.
const AT_COLUMN_M: f64 = 0.05;

/// No furniture at a wall is deeper.
const FURNITURE_MAX_M: f64 = 2.5;

/// What lies this far between a wall's faces stands in it.
const IN_WALL_M: f64 = 0.005;

/// How far from the middle of a door its two sides are looked at.
const BESIDE_DOOR_M: f64 = 0.8;

/// How far inside both sides of a wall must lie to be interior.
const INSIDE_M: f64 = 0.3;

/// Why a straight wall does not slide by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Stays {
    /// One side of it lies outside.
    Outer,
    /// Too thick for a partition: it carries.
    Thick,
    /// The drawing says that it carries, holds fire up or parts dwellings.
    Structure,
    /// It ends at no wall along which it could slide.
    Unheld,
    /// A joint of it would open or bend.
    Joined,
    /// One of its lines cannot be changed point by point.
    Unwritable,
    /// A part of a door or window in it would stay behind.
    Torn,
    /// Something stands in it or at it.
    Occupied,
    /// The next wall or joint is too near.
    Narrow,
}

impl Stays {
    /// In plain words, after a number.
    fn words(self) -> &'static str {
        match self {
            Self::Outer => "outer",
            Self::Thick => "thick enough to carry",
            Self::Structure => "of the structure (--allow structure frees them)",
            Self::Unheld => "without a wall to slide along",
            Self::Joined => "whose joints would open or bend",
            Self::Unwritable => "that cannot be changed (locked, in a block, or a multiline)",
            Self::Torn => "with a door or window that could not go along",
            Self::Occupied => "with something standing at them",
            Self::Narrow => "with too little room beside them",
        }
    }
}

/// How many straight walls stay by default, and why, in plain words; empty for none.
pub(super) fn told(stays: &[Stays]) -> String {
    let mut counts: BTreeMap<Stays, usize> = BTreeMap::new();
    stays.iter().for_each(|s| *counts.entry(*s).or_default() += 1);
    let parts: Vec<String> = counts.iter().map(|(s, n)| format!("{n} {}", s.words())).collect();
    if parts.is_empty() { String::new() } else { format!("straight walls: {}", parts.join(", ")) }
}

/// All that is needed to find what slides.
pub(super) struct Axial<'a> {
    plan: &'a Plan,
    graph: &'a Graph,
    axes: &'a AxisGraph,
    interior: &'a Interior,
    pieces: &'a [Piece],
    neighbours: &'a Neighbours,
    things: &'a Things<'a>,
    /// Walls thicker than this carry, metres of a person.
    carrying_m: f64,
    /// Whether the drawing shows how thick its partitions are.
    has_partitions: bool,
    /// Edges at every node of the axes.
    at_node: Vec<Vec<u32>>,
    /// Doors and windows of which the side of an edge is a jamb: edge, opening.
    jamb_sides: Vec<(u32, u32)>,
    /// Walls that move whole, by their record.
    whole: BTreeMap<usize, Vec<u32>>,
}

/// What moves with a chain.
struct Own {
    /// Its corners, and those of what ends at it.
    handles: BTreeSet<Handle>,
    /// Records of its walls that move whole.
    records: BTreeSet<usize>,
}

/// Edges on one line, joined at nodes or by openings.
struct Chain {
    edges: Vec<u32>,
    /// Openings between them.
    openings: Vec<u32>,
    /// Start, and unit vector along.
    origin: DVec2,
    along: DVec2,
    /// Ends along the line, from the origin.
    from: f64,
    to: f64,
    thickness: f64,
}

impl Chain {
    fn local(&self, p: DVec2) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.along), self.along.perp_dot(p - self.origin))
    }

    fn world(&self, x: f64, y: f64) -> DVec2 {
        self.origin + self.along * x + self.along.perp() * y
    }
}

impl<'a> Axial<'a> {
    /// Takes what is known.
    pub fn new(
        plan: &'a Plan,
        graph: &'a Graph,
        axes: &'a AxisGraph,
        interior: &'a Interior,
        (pieces, neighbours, things): (&'a [Piece], &'a Neighbours, &'a Things<'a>),
    ) -> Self {
        let mut at_node = vec![Vec::new(); axes.nodes.len()];
        for (i, e) in axes.edges.iter().enumerate() {
            e.nodes.iter().for_each(|n| at_node[*n as usize].push(i as u32));
        }
        let filled = (0u32..).zip(&axes.openings).filter(|(_, o)| o.kind != OpeningKind::Passage);
        let jamb_sides =
            filled.flat_map(|(i, o)| o.jambs.iter().filter_map(move |j| Some((j.edge?, i)))).collect();
        let (carrying_m, has_partitions) = (PARTITION_THICKNESS_MAX_M, false);
        let mut out = Self {
            plan,
            graph,
            axes,
            interior,
            pieces,
            neighbours,
            things,
            carrying_m,
            has_partitions,
            at_node,
            jamb_sides,
            whole: walls_by_record(plan),
        };
        if let Some(usual) = out.usual_thickness() {
            out.has_partitions = true;
            out.carrying_m = carrying_m.min((CARRYING_RATIO * usual).max(CARRYING_MIN_M));
        }
        out
    }

    /// The thickness that half the length of the inner walls does not exceed.
    fn usual_thickness(&self) -> Option<f64> {
        let inner = self.axes.edges.iter().filter(|e| {
            let [a, b] = self.axes.ends(e);
            let out = (b - a).normalize_or_zero().perp() * (e.thickness_m / 2.0 + 0.35);
            let is_partition = e.thickness_m > 0.0 && e.thickness_m <= PARTITION_THICKNESS_MAX_M;
            is_partition && [out, -out].iter().all(|o| self.is_inside(a.midpoint(b) + *o))
        });
        let mut inner: Vec<[f64; 2]> = inner.map(|e| [e.thickness_m, self.length(e)]).collect();
        inner.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let half = inner.iter().map(|e| e[1]).sum::<f64>() / 2.0;
        let mut sum = 0.0;
        inner
            .iter()
            .find(|e| {
                sum += e[1];
                sum >= half
            })
            .map(|e| e[0])
    }

    /// The edges at a node.
    fn around(&self, node: u32) -> impl Iterator<Item = (u32, &'a Edge)> + '_ {
        self.at_node[node as usize].iter().map(|i| (*i, &self.axes.edges[*i as usize]))
    }

    /// Partitions that may slide across their length, the longest first; and why the other straight walls stay.
    pub fn partitions(&self) -> (Vec<Sliding>, Vec<Stays>) {
        let (mut out, mut stays) = (Vec::new(), Vec::new());
        let chains = self.chains();
        for chain in chains.iter().filter(|c| c.to - c.from >= PARTITION_LENGTH_MIN_M) {
            match self.partition(chain) {
                Ok(sliding) => out.push(sliding),
                Err(why) => stays.push(why),
            }
        }
        out.sort_by(|a: &Sliding, b| b.size.total_cmp(&a.size).then_with(|| a.nodes.cmp(&b.nodes)));
        (out, stays)
    }

    /// Door gaps that may slide along their wall, from left to right; none in a wall that is thicker than
    /// the drawing's partitions.
    pub fn doors(&self) -> Vec<Sliding> {
        let doors = self.axes.openings.iter().filter(|o| o.kind != OpeningKind::Window);
        let wide = doors.filter(|o| (DOOR_WIDTH_M[0]..=DOOR_WIDTH_M[1]).contains(&o.width_m));
        let mut out: Vec<Sliding> = wide.filter_map(|o| self.door(o)).chain(self.slots()).collect();
        out.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
        out
    }

    fn door(&self, opening: &Opening) -> Option<Sliding> {
        if self.has_partitions && opening.thickness_m > self.carrying_m {
            return None;
        }
        let [a, b] = opening.jambs.map(|j| j.node);
        let along = (opening.jambs[1].at - opening.jambs[0].at).try_normalize()?;
        let (first, second) = (self.wall_at(a?, -along)?, self.wall_at(b?, along)?);
        if self.is_structure(first) || self.is_structure(second) {
            return None;
        }
        let mut handles: BTreeSet<Handle> =
            jambs_of(self.plan, self.axes, opening).concat().into_iter().collect();
        handles.extend(opening.faces.iter().flat_map(|f| face_handles(self.plan, *f)));
        let is_inside =
            [-1.0, 1.0].iter().all(|s| self.is_inside(opening.centre + along.perp() * (*s * BESIDE_DOOR_M)));
        if self.things.tears(opening) {
            return None;
        }
        let at = opening.jambs.map(|j| j.at);
        let room = self.things.room_along(at, opening.thickness_m, &handles, SLIDE_M);
        let own = Own { handles, records: BTreeSet::new() };
        let nodes = self.nodes(&own)?;
        // The sides of an opening in a wall that moves whole are its slot's.
        if own.handles.iter().any(|h| self.plan.walls[h.0 as usize].editable != Editable::Free) {
            return None;
        }
        let along = self.along_stretched(&nodes, along);
        let [lo, hi] = self.stretch(&nodes, along, &BTreeSet::new())?;
        let behind = |e: &Edge| self.length(e) - REST_M - self.joint_half(e);
        let lo = lo.max(-behind(first)).max(room[0]).min(0.0);
        let hi = hi.min(behind(second)).min(room[1]).max(0.0);
        let (lo, hi) = (-whole_mm(-lo), whole_mm(hi));
        (is_inside && hi - lo >= 2.0 * SLIDE_MIN_M).then(|| {
            let (direction, is_turned) = upright(along);
            let way = if is_turned { [-hi, -lo] } else { [lo, hi] };
            // No −0: it would be told so.
            let way = way.map(|v| v * self.plan.human_scale + 0.0);
            Sliding {
                nodes,
                direction,
                way,
                at: opening.centre,
                size: opening.width_m,
                slot: None,
                wall: None,
            }
        })
    }

    /// The straight thick wall that leaves a node in a direction.
    fn wall_at(&self, node: u32, out: DVec2) -> Option<&Edge> {
        let mut around = self.around(node).map(|(_, e)| e);
        around.find(|e| {
            let [a, b] = self.axes.ends(e);
            let d = if e.nodes[0] == node { b - a } else { a - b };
            e.bulge == 0.0 && e.thickness_m > 0.0 && d.normalize_or_zero().dot(out) > 0.99
        })
    }

    /// Half the thickness of the thickest wall that joins an edge at either end.
    fn joint_half(&self, edge: &Edge) -> f64 {
        edge.nodes.iter().map(|n| self.half_at(*n, edge)).fold(0.0, f64::max)
    }

    /// Half the thickness of the thickest wall that joins an edge at a node and does not go on along it.
    fn half_at(&self, node: u32, edge: &Edge) -> f64 {
        let along = |e: &Edge| {
            let [a, b] = self.axes.ends(e);
            (b - a).normalize_or_zero()
        };
        let crosses = |e: &Edge| along(e).perp_dot(along(edge)).abs() > PARALLEL_SIN;
        let joins = self.around(node).filter(|(_, e)| !std::ptr::eq(*e, edge) && crosses(e));
        joins.map(|(_, e)| e.thickness_m / 2.0).fold(0.0, f64::max)
    }

    /// Whether a drawn line of a wall is part of the structure.
    fn is_structure(&self, edge: &Edge) -> bool {
        let carries =
            |f: &FaceRef| self.plan.bearing.contains_key(&self.plan.walls[f.0 as usize].source.record);
        edge.left.iter().chain(&edge.right).any(carries)
    }

    fn length(&self, edge: &Edge) -> f64 {
        let [a, b] = self.axes.ends(edge);
        a.distance(b)
    }

    fn is_inside(&self, p: DVec2) -> bool {
        let scale = self.plan.human_scale;
        self.interior.depth_m(self.plan.frame.um_from_plan(p * scale)) > INSIDE_M * scale
    }

    fn partition(&self, chain: &Chain) -> Result<Sliding, Stays> {
        let length = chain.to - chain.from;
        if chain.thickness > self.carrying_m {
            return Err(Stays::Thick);
        }
        if chain.edges.iter().any(|e| self.is_structure(&self.axes.edges[*e as usize])) {
            return Err(Stays::Structure);
        }
        if !self.is_inner(chain) {
            return Err(Stays::Outer);
        }
        let direction = chain.along.perp();
        let mut oblique = BTreeSet::new();
        let joint = self.joint_way(chain, &mut oblique)?;
        let mut own = self.corners(chain).ok_or(Stays::Joined)?;
        // What moves whole keeps its ends as they are: no face is cut anew.
        if !oblique.is_empty() && !own.records.is_empty() {
            return Err(Stays::Joined);
        }
        let beside = self.take_doors_beside(chain, &mut own.handles).ok_or(Stays::Occupied)?;
        let nodes = self.nodes(&own).ok_or(Stays::Unwritable)?;
        if self.stretches_carrying(&nodes) {
            return Err(Stays::Thick);
        }
        if self.tears_a_door(chain, &nodes) {
            return Err(Stays::Joined);
        }
        if self.along_with(chain).any(|o| self.things.tears(o)) {
            return Err(Stays::Torn);
        }
        let direction = self.along_stretched(&nodes, direction);
        let stretch = self.stretch(&nodes, direction, &oblique).ok_or(Stays::Joined)?;
        let ends = self.ends_way(&own, direction);
        let mut free = self.free_way(chain, &nodes, &oblique).ok_or(Stays::Occupied)?;
        if !self.keep_off_things(chain, &own.handles, &mut free) {
            return Err(Stays::Occupied);
        }
        self.keep_furniture_off(chain, (&nodes, &own.handles), &mut free);
        let ways = [stretch, free, joint, beside, ends, [-PARTITION_SLIDE_M, PARTITION_SLIDE_M]];
        let [lo, hi] = ways.into_iter().fold([f64::MIN, f64::MAX], |[l, h], w| [l.max(w[0]), h.min(w[1])]);
        let whole_cm = |way: f64| (way.max(0.0) * 1e2 + 1e-6).floor() / 1e2;
        let (lo, hi) = (-whole_cm(-lo), whole_cm(hi));
        if hi - lo < 2.0 * SLIDE_MIN_M {
            return Err(Stays::Narrow);
        }
        let (direction, is_turned) = upright(direction);
        let way = if is_turned { [-hi, -lo] } else { [lo, hi] };
        Ok(Sliding {
            nodes,
            wall: self.axes.edges[chain.edges[0] as usize].left.first().map(|f| f.0),
            direction,
            way: way.map(|v| v * self.plan.human_scale),
            at: chain.world(f64::midpoint(chain.from, chain.to), 0.0),
            size: length,
            slot: None,
        })
    }

    /// Whether a wall that carries would grow longer or shorter: both its sides are stretched.
    fn stretches_carrying(&self, nodes: &[u32]) -> bool {
        let is_stretched = |faces: &[FaceRef]| {
            faces.iter().any(|f| match face_handles(self.plan, *f)[..] {
                [a, b] => self.has(nodes, a) != self.has(nodes, b),
                _ => false,
            })
        };
        let carrying = self.axes.edges.iter().filter(|e| e.thickness_m > self.carrying_m);
        carrying.into_iter().any(|e| is_stretched(&e.left) && is_stretched(&e.right))
    }

    /// Whether both sides of a chain lie inside wherever one looks, and no window is in it.
    fn is_inner(&self, chain: &Chain) -> bool {
        let length = chain.to - chain.from;
        let side = chain.thickness / 2.0 + 0.35;
        let steps = ((length / LOOK_M) as u32).saturating_sub(1);
        let steps = (0..steps).map(|i| LOOK_M * f64::from(i + 1));
        let looks: Vec<f64> = steps.chain([0.2, 0.5, 0.8].map(|t| length * t)).collect();
        let is_window = |o: &u32| self.axes.openings[*o as usize].kind == OpeningKind::Window;
        let is_side_inner = |y: &f64| {
            let places = looks.iter().map(|x| chain.world(chain.from + x, *y));
            let mut seen = places.filter(|p| !self.is_near_joined(chain, *p)).peekable();
            seen.peek().is_some() && seen.all(|p| self.is_inside(p))
        };
        !chain.openings.iter().any(is_window) && [-side, side].iter().all(is_side_inner)
    }

    /// Whether a place lies in or near a wall that ends at a chain: how far inside it is, is not to be told there.
    fn is_near_joined(&self, chain: &Chain, p: DVec2) -> bool {
        let nodes = chain.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes);
        let mut joined = nodes.flat_map(|n| self.around(n)).filter(|(i, _)| !chain.edges.contains(i));
        joined.any(|(_, e)| distance_to_segment(p, self.axes.ends(e)) <= e.thickness_m / 2.0 + INSIDE_M)
    }

    /// The openings that go along with a chain: those in it, and those that end at its side.
    fn along_with<'c>(&'c self, chain: &'c Chain) -> impl Iterator<Item = &'c Opening> {
        let beside = self.jamb_sides.iter().filter(|(e, _)| chain.edges.contains(e)).map(|(_, o)| o);
        chain.openings.iter().chain(beside).map(|o| &self.axes.openings[*o as usize])
    }

    /// Straight thick walls on one line that hang together.
    fn chains(&self) -> Vec<Chain> {
        let edges = &self.axes.edges;
        let mut root: Vec<u32> = (0..edges.len() as u32).collect();
        let find = |root: &Vec<u32>, mut i: u32| {
            while root[i as usize] != i {
                i = root[i as usize];
            }
            i
        };
        // A line by itself is a wall where all walls are.
        let is_single = edges.iter().all(|e| e.thickness_m == 0.0);
        let is_thick = |i: &u32| {
            let edge = &edges[*i as usize];
            edge.bulge == 0.0 && (is_single || edge.thickness_m > 0.0)
        };
        let thick: Vec<Vec<u32>> =
            self.at_node.iter().map(|list| list.iter().copied().filter(is_thick).collect()).collect();
        let mut pairs: Vec<(Option<u32>, [u32; 2])> = Vec::new();
        for around in &thick {
            let rest = |k: usize, i: u32| around[k + 1..].iter().map(move |j| (None, [i, *j]));
            pairs.extend(around.iter().enumerate().flat_map(|(k, i)| rest(k, *i)));
        }
        for (k, o) in self.axes.openings.iter().enumerate() {
            if let [Some(a), Some(b)] = o.jambs.map(|j| j.node) {
                let others = |i: u32| thick[b as usize].iter().map(move |j| (Some(k as u32), [i, *j]));
                pairs.extend(thick[a as usize].iter().flat_map(|i| others(*i)));
            }
        }
        pairs.retain(|(_, [i, j])| self.on_one_line(&edges[*i as usize], &edges[*j as usize]));
        for (_, [i, j]) in &pairs {
            let (a, b) = (find(&root, *i), find(&root, *j));
            root[a.max(b) as usize] = a.min(b);
        }
        let mut sets: BTreeMap<u32, (Vec<u32>, Vec<u32>)> = BTreeMap::new();
        for i in (0..edges.len() as u32).filter(is_thick) {
            sets.entry(find(&root, i)).or_default().1.push(i);
        }
        for (opening, [i, _]) in pairs {
            if let (Some(o), Some(set)) = (opening, sets.get_mut(&find(&root, i))) {
                set.0.push(o);
            }
        }
        sets.into_values().map(|(openings, set)| self.chain(openings, set)).collect()
    }

    fn chain(&self, openings: Vec<u32>, edges: Vec<u32>) -> Chain {
        let all = &self.axes.edges;
        let [origin, b] = self.axes.ends(&all[edges[0] as usize]);
        let along = (b - origin).normalize_or_zero();
        let ends = edges.iter().flat_map(|e| self.axes.ends(&all[*e as usize]));
        let places: Vec<f64> = ends.map(|p| (p - origin).dot(along)).collect();
        let thickness = edges.iter().map(|e| all[*e as usize].thickness_m).fold(0.0, f64::max);
        Chain {
            origin,
            along,
            from: places.iter().copied().fold(f64::MAX, f64::min),
            to: places.iter().copied().fold(f64::MIN, f64::max),
            thickness,
            edges,
            openings,
        }
    }

    fn on_one_line(&self, e: &Edge, f: &Edge) -> bool {
        let ([a, b], [c, d]) = (self.axes.ends(e), self.axes.ends(f));
        let (u, v) = ((b - a).normalize_or_zero(), (d - c).normalize_or_zero());
        u.perp_dot(v).abs() < PARALLEL_SIN
            && [c, d].iter().all(|p| u.perp_dot(*p - a).abs() < BESIDE_M)
            && (e.thickness_m - f.thickness_m).abs() < BESIDE_M
    }

    /// How far the joints at a chain's nodes let it slide: the walls that it ends at run across it, and the
    /// next joint on them stays. An error where a wall leaves it at another angle and does not go straight on
    /// beyond it, or it ends at a column. The faces of walls at another angle are added to `oblique`: the
    /// joint is mitred anew.
    fn joint_way(&self, chain: &Chain, oblique: &mut BTreeSet<FaceRef>) -> Result<[f64; 2], Stays> {
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

    /// Adds the wall ends beyond the doors and windows that end at a chain's side: they go along with it, or the door
    /// would be torn off. How far these walls let it slide, metres of a person; `None` where one cannot go along.
    fn take_doors_beside(&self, chain: &Chain, handles: &mut BTreeSet<Handle>) -> Option<[f64; 2]> {
        let mut way = [f64::MIN, f64::MAX];
        for (_, opening) in self.jamb_sides.iter().filter(|(e, _)| chain.edges.contains(e)) {
            let opening = &self.axes.openings[*opening as usize];
            let end = opening.jambs.iter().find(|j| j.node.is_some())?;
            let out = (end.at - opening.centre).try_normalize()?;
            let wall = self.wall_at(end.node?, out).filter(|_| out.dot(chain.along).abs() < PARALLEL_SIN)?;
            handles.extend(jambs_of(self.plan, self.axes, opening).concat());
            handles.extend(opening.faces.iter().flat_map(|f| face_handles(self.plan, *f)));
            let behind = (self.length(wall) - REST_M - self.joint_half(wall)).max(0.0);
            if out.dot(chain.along.perp()) > 0.0 {
                way[1] = way[1].min(behind);
            } else {
                way[0] = way[0].max(-behind);
            }
        }
        Some(way)
    }

    /// Whether a door or window that goes along with a chain would be torn: it lies on the chain's own line and its
    /// other jamb is none of the chain, or a line that stays ends in its gap (another wall's face, drawn into the
    /// doorway).
    fn tears_a_door(&self, chain: &Chain, nodes: &[u32]) -> bool {
        let of_chain: BTreeSet<u32> =
            chain.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes).collect();
        let is_at = |j: &Jamb| {
            j.node.is_some_and(|n| of_chain.contains(&n)) || j.edge.is_some_and(|e| chain.edges.contains(&e))
        };
        let goes_along = |o: &&Opening| o.kind != OpeningKind::Passage && o.jambs.iter().any(is_at);
        self.axes.openings.iter().filter(goes_along).any(|o| {
            let [a, b] = o.jambs.map(|j| j.at);
            let along = (b - a).normalize_or_zero();
            if along.perp_dot(chain.along).abs() < PARALLEL_SIN && !o.jambs.iter().all(is_at) {
                return true;
            }
            let is_within = |p: DVec2| {
                let s = (p - a).dot(along);
                s > BESIDE_M
                    && s < a.distance(b) - BESIDE_M
                    && along.perp_dot(p - a).abs() <= o.thickness_m / 2.0 + BESIDE_M
            };
            let near = self.neighbours.near(a.min(b), a.max(b)).into_iter().map(|i| &self.pieces[i as usize]);
            let ends = near.flat_map(|p| [(p.nodes[0], p.a), (p.nodes[1], p.b)]);
            ends.into_iter().any(|(n, p)| is_within(p) && nodes.binary_search(&n).is_err())
        })
    }

    /// Whether the end of a wall stands at a column.
    fn stands_at_column(&self, end: DVec2, thickness: f64) -> bool {
        let reach = thickness / 2.0 + AT_COLUMN_M;
        self.axes.nodes.iter().any(|n| match &n.kind {
            NodeKind::Column(ring) => {
                let sides = ring.iter().zip(ring.iter().cycle().skip(1));
                sides.into_iter().any(|(a, b)| distance_to_segment(end, [*a, *b]) <= reach)
            }
            _ => false,
        })
    }

    /// Whether a wall goes straight on beyond a node: a drawn face of it belongs to both its parts.
    fn goes_on(&self, node: u32, edge: &Edge) -> bool {
        let shares = |f: &Edge| {
            let mut faces = f.left.iter().chain(&f.right);
            !std::ptr::eq(f, edge) && faces.any(|f| edge.left.contains(f) || edge.right.contains(f))
        };
        self.around(node).any(|(_, f)| shares(f))
    }

    /// What moves with a chain. `None` where one of its faces runs on beyond it.
    fn corners(&self, chain: &Chain) -> Option<Own> {
        let (plan, axes) = (self.plan, self.axes);
        let reach = chain.thickness / 2.0 + BESIDE_M;
        let is_own = |h: &Handle| {
            let p = chain.local(handle_at(plan, *h));
            p.y.abs() <= reach && p.x >= chain.from - reach - BESIDE_M && p.x <= chain.to + reach + BESIDE_M
        };
        let mut out = Own { handles: BTreeSet::new(), records: BTreeSet::new() };
        for e in chain.edges.iter().map(|e| &axes.edges[*e as usize]) {
            for f in e.left.iter().chain(&e.right).chain(&e.inner) {
                let wall = &plan.walls[f.0 as usize];
                out.records.extend(wall.editable.moves_whole().then_some(wall.source.record));
                for h in face_handles(plan, *f) {
                    if !is_own(&h) {
                        return None;
                    }
                    out.handles.insert(h);
                }
            }
            for n in e.nodes {
                let caps = axes.nodes[n as usize].faces.iter().flat_map(|f| face_handles(plan, *f));
                out.handles.extend(caps.filter(is_own));
                let joined = self.around(n).filter(|(i, _)| !chain.edges.contains(i));
                let ends = joined.flat_map(|(_, f)| end_handles(plan, axes, f, n));
                out.handles.extend(ends.filter(is_own));
            }
        }
        for o in chain.openings.iter().map(|o| &axes.openings[*o as usize]) {
            out.handles.extend(o.faces.iter().flat_map(|f| face_handles(plan, *f)).filter(is_own));
        }
        // The end of another wall may lie on a face: of what moves whole, the chain has what lies in it altogether.
        let controls = |w: &u32| {
            (0..self.graph.control_nodes[*w as usize].len() as u32).map(|c| (*w, c)).collect::<Vec<_>>()
        };
        let all = |r: &usize| self.whole[r].iter().flat_map(controls).collect::<Vec<Handle>>();
        out.records.retain(|r| all(r).iter().all(is_own));
        out.handles.extend(out.records.iter().flat_map(all));
        Some(out)
    }

    /// The graph's nodes of what moves, if all that meets in them can be written: point by point, whole, or as an end that
    /// goes along its wall.
    fn nodes(&self, own: &Own) -> Option<Vec<u32>> {
        let node = |(w, c): &Handle| self.graph.control_nodes[*w as usize][*c as usize];
        let nodes: BTreeSet<u32> = own.handles.iter().map(node).collect();
        let mut met = nodes.iter().flat_map(|n| &self.graph.handles[*n as usize]);
        let is_writable = met.all(|(w, c)| {
            let wall = &self.plan.walls[*w as usize];
            match &wall.editable {
                Editable::Free => !matches!(wall.shape, Shape::Arc { .. }),
                Editable::No(_) => false,
                _ if own.records.contains(&wall.source.record) => true,
                Editable::Wall { ends, .. } => ends.iter().any(|end| end.contains(c)),
                Editable::WithInsert { .. } => false,
            }
        });
        (is_writable && !nodes.is_empty()).then(|| nodes.into_iter().collect())
    }

    /// How far the ends of walls that change their length with a chain let it slide: what of their bodies stays, at whatever
    /// height, ends their way. Metres of a person.
    fn ends_way(&self, own: &Own, direction: DVec2) -> [f64; 2] {
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
    fn stretch(&self, nodes: &[u32], direction: DVec2, oblique: &BTreeSet<FaceRef>) -> Option<[f64; 2]> {
        let mut way = [f64::MIN, f64::MAX];
        for w in self.walls_at(nodes) {
            let shape = &self.plan.walls[w as usize].shape;
            for (c, n) in self.pieces(w) {
                let ends = [c, (c + 1) % n];
                let moves = ends.map(|c| self.has(nodes, (w, c)));
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
    fn along_stretched(&self, nodes: &[u32], direction: DVec2) -> DVec2 {
        let mut sum = DVec2::ZERO;
        for w in self.walls_at(nodes) {
            for (c, n) in self.pieces(w) {
                let ends = [c, (c + 1) % n];
                let [first, second] = ends.map(|c| self.has(nodes, (w, c)));
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

    fn walls_at(&self, nodes: &[u32]) -> BTreeSet<u32> {
        nodes.iter().flat_map(|n| &self.graph.handles[*n as usize]).map(|h| h.0).collect()
    }

    fn has(&self, nodes: &[u32], (w, c): Handle) -> bool {
        nodes.binary_search(&self.graph.control_nodes[w as usize][c as usize]).is_ok()
    }

    /// The pieces of a wall: first control point of each, and the number of control points.
    fn pieces(&self, w: u32) -> impl Iterator<Item = (u32, u32)> + use<> {
        let shape = &self.plan.walls[w as usize].shape;
        let n = control_points(shape).len() as u32;
        let last =
            if matches!(shape, Shape::Polyline { closed: true, .. }) { n } else { n.saturating_sub(1) };
        (0..last).map(move |c| (c, n))
    }

    /// The faces of walls that end at a chain, and what closes their far ends: they grow longer or shorter with it.
    fn faces_of_joined(&self, chain: &Chain) -> Vec<FaceRef> {
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
    fn joints_of(&self, chain: &Chain) -> [f64; 2] {
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
    fn free_way(&self, chain: &Chain, nodes: &[u32], oblique: &BTreeSet<FaceRef>) -> Option<[f64; 2]> {
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
    fn keep_off_things(&self, chain: &Chain, moving: &BTreeSet<Handle>, way: &mut [f64; 2]) -> bool {
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

    /// Bounds a way by what stands before the furniture that goes along: other walls as far as a way, things, and the space
    /// before doors.
    fn keep_furniture_off(
        &self,
        chain: &Chain,
        (nodes, moving): (&[u32], &BTreeSet<Handle>),
        way: &mut [f64; 2],
    ) {
        let far = chain.thickness / 2.0 + PARTITION_SLIDE_M + FURNITURE_MAX_M + PASSAGE_M;
        let corners = [(chain.from, -far), (chain.to, -far), (chain.from, far), (chain.to, far)];
        let Some(around) = box_of(corners.into_iter().map(|(x, y)| chain.world(x, y))) else { return };
        let local = |[a, b]: [DVec2; 2]| [chain.local(a), chain.local(b)];
        let (along, still): (Vec<_>, Vec<_>) =
            self.things.near(around).partition(|t| self.things.goes_along(t, moving));
        let furniture = along.into_iter().filter(|t| self.things.is_furniture(t));
        let boxes: Vec<[DVec2; 2]> =
            furniture.filter_map(|t| box_of(t.pieces.iter().flat_map(|p| local(*p)))).collect();
        if boxes.is_empty() {
            return;
        }
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

/// The walls that move whole, by their record.
fn walls_by_record(plan: &Plan) -> BTreeMap<usize, Vec<u32>> {
    let mut out: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (w, wall) in (0u32..).zip(&plan.walls).filter(|(_, w)| w.editable.moves_whole()) {
        out.entry(wall.source.record).or_default().push(w);
    }
    out
}
