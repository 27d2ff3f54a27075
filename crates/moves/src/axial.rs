//! What may move of thick walls, by their axes: partitions slide between the walls they join, door gaps
//! slide along the wall they are in.
//!
//! A set of corners may shift in a direction if every drawn piece that has one end in the set runs in that
//! direction: it is stretched and stays where it is. How far is bounded by the pieces that grow short, by
//! the next joint, and by what stands in the way.

mod chain;
mod own;
mod rows;
mod slots;
mod ways;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::neighbours::{Neighbours, Piece};
use super::remains::REST_M;
use super::sizes::{DOOR_WIDTH_M, PARTITION_SLIDE_M, PARTITION_THICKNESS_MAX_M, SLIDE_M, SLIDE_MIN_M};
use super::sliding::{Sliding, upright, whole_mm};
use super::things::Things;
use chain::{BESIDE_M, Chain, Own, walls_by_record};
use enfilade_cad::drawing::{Editable, Format};
use enfilade_cad::plane::distance_to_segment;
use enfilade_engine::interior::Interior;
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Edge, FaceRef, Jamb, NodeKind, Opening, OpeningKind};
use enfilade_plan::fittings::jambs_of;
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::structure::face_handles;

/// A wall that is so many times as thick as the drawing's inner walls mostly are carries too, if it is thicker than
/// [`CARRYING_MIN_M`].
const CARRYING_RATIO: f64 = 2.0;

/// No wall up to this thickness is taken to carry.
const CARRYING_MIN_M: f64 = 0.2;

/// A partition has the interior on both sides wherever it is looked at: every so many metres, but this far from its ends.
const LOOK_M: f64 = 0.5;

/// Shortest partition.
const PARTITION_LENGTH_MIN_M: f64 = 0.8;

/// Pieces whose direction differs by less than this sine run in one direction.
const PARALLEL_SIN: f64 = 0.02;

/// The end of a wall stands at a column that is no farther away than this, beyond half the wall's thickness.
const AT_COLUMN_M: f64 = 0.05;

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
        let taken = self.taken(&own, &nodes);
        let along = self.along_stretched(&taken, along);
        let [lo, hi] = self.stretch(&taken, along, &BTreeSet::new())?;
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
        if self.axes.closures.iter().any(|c| chain.has_gap([c.a, c.b])) {
            return Err(Stays::Joined);
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
        let taken = self.taken(&own, &nodes);
        if self.stretches_carrying(&taken) {
            return Err(Stays::Thick);
        }
        if self.tears_a_door(chain, &nodes) {
            return Err(Stays::Joined);
        }
        // Of a building the file says what sits in a wall.
        let is_drawn = self.plan.format == Format::Dxf;
        if is_drawn && self.along_with(chain).any(|o| self.things.tears(o)) {
            return Err(Stays::Torn);
        }
        let direction = self.along_stretched(&taken, direction);
        let stretch = self.stretch(&taken, direction, &oblique).ok_or(Stays::Joined)?;
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
    fn stretches_carrying(&self, taken: &BTreeSet<Handle>) -> bool {
        let is_stretched = |faces: &[FaceRef]| {
            faces.iter().any(|f| match face_handles(self.plan, *f)[..] {
                [a, b] => taken.contains(&a) != taken.contains(&b),
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
}
