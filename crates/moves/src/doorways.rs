//! The space before doors: what moves by default leaves it free on both sides.
//!
//! Before a door nothing comes nearer than the door is wide, or [`CLEAR_MIN_M`] before a narrower one, unless it
//! stood nearer at the start: then it comes no nearer. The ways of a group are shortened until this holds at every
//! place that is tried, also for doors that go along with a group, and for doors that another group may have moved.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::remains::Ledger;
use super::sides::Side;
use super::sizes::{DOOR_WIDTH_M, SLIDE_MIN_M};
use super::sliding::clipped;
use super::things::{AT_WALL_M, Piece, Things, gap};
use super::{Layout, Moves};
use enfilade_cad::curve::control_points;
use enfilade_cad::plane::box_of;
use enfilade_plan::axes::{AxisGraph, FaceRef, Opening, OpeningKind};
use enfilade_plan::curve::Trace;
use enfilade_plan::fittings::jambs_of;
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::markers::{Clause, Group, Kind};
use enfilade_plan::{NamedDoor, Plan, Wall};
use enfilade_report::Report;

/// What stays free before a narrow door, metres of a person.
pub const CLEAR_MIN_M: f64 = 0.9;

/// What reaches this little past a jamb stands beside the door, not before it.
const BESIDE_M: f64 = 0.02;

/// What lies this near to a wall's faces lies in the wall: sills, panes, reveals.
const IN_WALL_M: f64 = 0.06;

/// Depths that differ by less are one.
const SAME_M: f64 = 1e-3;

/// Places tried to either side of the start: of a group with one parameter, and of one with several.
const STEPS_ONE: usize = 20;
const STEPS_MANY: usize = 4;

/// Places between those that are tried reach no farther than this beyond the hull of the outermost ones.
const BETWEEN_M: f64 = 0.3;

/// Least turn that is worth a parameter, degrees.
const TURN_MIN_DEG: f64 = 1.0;

/// What a door goes along with.
enum Hangs {
    /// Its two jambs.
    Jambs([Side; 2]),
    /// The wall that the file says it sits in, and its opening where that can slide.
    Wall(u32, Option<usize>),
    /// Nothing that is known.
    Free,
}

/// A door and what is to stay free before it; metres of a person.
pub(super) struct Doorway {
    /// Both jambs on the axis.
    pub at: Piece,
    /// What it goes along with.
    hangs: Hangs,
    /// Half the thickness of its wall.
    pub half: f64,
    /// Depth that is to stay free on each side.
    wanted: f64,
    /// Drawn pieces that lie in it or run through it and are no wall there.
    drawn_in: Vec<FaceRef>,
}

impl Doorway {
    /// How deep the space before the door is free of some pieces, on its right and its left side; at most as deep as
    /// is wanted.
    fn clear<'p>(&self, [a, b]: Piece, pieces: impl Iterator<Item = &'p Piece>) -> [f64; 2] {
        let (along, width) = ((b - a).normalize_or_zero(), a.distance(b));
        let local = |p: DVec2| DVec2::new((p - a).dot(along), along.perp_dot(p - a));
        let mut out = [self.wanted; 2];
        for [p, q] in pieces {
            let Some([lo, hi]) = clipped(local(*p), local(*q), BESIDE_M, width - BESIDE_M) else { continue };
            if hi > self.half + IN_WALL_M {
                out[1] = out[1].min((lo - self.half).max(0.0));
            }
            if lo < -self.half - IN_WALL_M {
                out[0] = out[0].min((-hi - self.half).max(0.0));
            }
        }
        out
    }

    /// Box round the door and the space before it.
    fn reach(&self, at: Piece) -> [DVec2; 2] {
        let far = DVec2::splat(self.half + self.wanted);
        [at[0].min(at[1]) - far, at[0].max(at[1]) + far]
    }

    /// Whether a piece of a wall, drawn where the door is, is no wall there.
    pub fn is_own_piece(&self, piece: FaceRef) -> bool {
        self.drawn_in.contains(&piece)
    }

    /// Whether the file says that it sits in this wall.
    pub fn is_own_wall(&self, plan: &Plan, wall: u32) -> bool {
        let record = |w: u32| plan.walls[w as usize].source.record;
        matches!(self.hangs, Hangs::Wall(host, _) if record(host) == record(wall))
    }

    /// The walls that end at its jambs, or on which they stand.
    pub fn jamb_walls(&self) -> impl Iterator<Item = u32> + '_ {
        let jambs = match &self.hangs {
            Hangs::Jambs(jambs) => jambs.as_slice(),
            Hangs::Wall(..) | Hangs::Free => &[],
        };
        jambs.iter().flat_map(Side::walls)
    }

    /// Where its jambs stand in a layout.
    pub fn place(&self, plan: &Plan, layout: &Layout) -> Piece {
        let jambs = match &self.hangs {
            Hangs::Jambs(jambs) => jambs,
            Hangs::Free => return self.at,
            Hangs::Wall(host, slot) => {
                let motion = layout.walls.iter().find(|m| m.wall == *host).and_then(|m| m.motion);
                let motion = super::after_sliding(motion, slot.and_then(|s| layout.slid(s)));
                let Some(m) = motion else { return self.at };
                let (turn, scale) = (DVec2::from_angle(m.turn_rad), plan.human_scale);
                return self.at.map(|p| {
                    let moved = turn.rotate(plan.frame.file_from_plan(p * scale)) + m.shift;
                    plan.frame.plan_from_file(moved) / scale
                });
            }
        };
        let moved = |(w, c): &Handle| {
            let wall = layout.walls.iter().find(|m| m.wall == *w)?;
            let at = |s| plan.frame.plan_from_file(control_points(s)[*c as usize]);
            Some((at(&wall.shape) - at(&plan.walls[*w as usize].shape)) / plan.human_scale)
        };
        let [a, b] = jambs;
        [self.at[0] + a.step(&moved, b), self.at[1] + b.step(&moved, a)]
    }
}

/// A group that was taken: what it can put where.
struct Taken {
    /// Doors that go along with it.
    doors: BTreeSet<usize>,
    /// Its walls.
    walls: BTreeSet<u32>,
    /// Its pieces at all places tried, with their walls, and their box.
    pieces: Vec<(u32, Piece)>,
    hull: [DVec2; 2],
}

/// Keeps the space before doors free while groups are taken one by one.
pub(super) struct Doorways<'a> {
    plan: &'a Plan,
    graph: &'a Graph,
    axes: &'a AxisGraph,
    things: &'a Things<'a>,
    doors: Vec<Doorway>,
    /// All pieces as drawn, with their walls.
    drawn: Vec<(u32, Piece)>,
    /// Where the groups taken so far can put each door, and which of them.
    places: BTreeMap<usize, Vec<(usize, Piece)>>,
    taken: Vec<Taken>,
    /// What the groups taken so far leave of the sides of walls.
    ledger: Ledger,
    /// How many groups were shortened, and how many stay for it.
    pub told: [usize; 2],
}

impl<'a> Doorways<'a> {
    /// The doors of a plan.
    pub fn new(plan: &'a Plan, graph: &'a Graph, axes: &'a AxisGraph, things: &'a Things<'a>) -> Self {
        let of_wall =
            |(w, t): (usize, &Trace)| pieces_of(plan, t).map(move |p| (w as u32, p)).collect::<Vec<_>>();
        Self {
            plan,
            graph,
            axes,
            things,
            doors: doors(plan, axes),
            drawn: plan.walls.iter().map(|w| &w.trace).enumerate().flat_map(of_wall).collect(),
            places: BTreeMap::new(),
            taken: Vec::new(),
            ledger: Ledger::default(),
            told: [0; 2],
        }
    }

    /// The group with its ways shortened so that the space before doors stays free; `None` where nothing is left.
    pub fn shortened(&mut self, group: &Group, nodes: &[u32]) -> Option<Group> {
        let is_element = group.clauses.len() > 1;
        if self.doors.is_empty() && (self.things.is_empty() || !is_element) {
            return Some(group.clone());
        }
        let mut alone = self.alone(group, nodes);
        let shorter = self.within_walls(group, &alone);
        if shorter.clauses != group.clauses {
            if !shorter.clauses.iter().all(|c| is_worth_moving(c, self.plan.human_scale)) {
                self.told[1] += 1;
                return None;
            }
            alone = self.alone(&shorter, nodes);
        }
        let grid = Grid::new(&alone);
        let trial = Trial::new(self, &alone, &grid);
        // What slides was kept off things when it was found.
        let around = if is_element { self.things_near(trial.hull) } else { Vec::new() };
        if around.iter().any(|t| trial.start.iter().any(|p| gap(*p, *t) < AT_WALL_M)) {
            self.told[1] += 1;
            return None;
        }
        let (mut lo, mut hi) = grid.all();
        if !(trial.is_far() && around.is_empty()) {
            let bad: Vec<Vec<usize>> = grid
                .points(&lo, &hi)
                .into_iter()
                .filter(|at| {
                    let p = grid.values(at);
                    !self.is_clear(&trial, &p) || self.runs_into(&trial, &p, &around)
                })
                .collect();
            grid.shrink(&bad, &mut lo, &mut hi);
        }
        let out = grid.bounded(&shorter, &lo, &hi, self.plan.human_scale);
        let is_shorter = out.as_ref().is_some_and(|g| g.clauses != group.clauses);
        self.told[0] += usize::from(is_shorter);
        self.told[1] += usize::from(out.is_none());
        if let Some(found) = &out {
            let taken = self
                .taken(&trial, &grid.points(&lo, &hi).iter().map(|at| grid.values(at)).collect::<Vec<_>>());
            self.taken.push(taken);
            if let [clause] = found.clauses.as_slice() {
                let [low, high] =
                    [clause.lower, clause.upper].map(|v| alone.shrunk(self.plan, self.graph, v));
                let most: Vec<f64> = low.iter().zip(&high).map(|(a, b)| a.max(*b)).collect();
                self.ledger.take(&alone.stretches, &most);
            }
        }
        out
    }

    /// The group with its way shortened so that enough is left of each wall between its joints and its openings, wherever
    /// the groups taken so far take those.
    fn within_walls(&self, group: &Group, alone: &Moves) -> Group {
        let mut out = group.clone();
        let ([clause], [_]) = (out.clauses.as_mut_slice(), alone.parameters.as_slice()) else { return out };
        for bound in [&mut clause.lower, &mut clause.upper] {
            let shrunk = alone.shrunk(self.plan, self.graph, *bound);
            let share = self.ledger.share(&alone.stretches, &shrunk);
            if share < 1.0 {
                // No −0: it would be told so.
                *bound = (*bound * share * 1e3).trunc() / 1e3 + 0.0;
            }
        }
        out
    }

    /// Of one group alone.
    fn alone(&self, group: &Group, nodes: &[u32]) -> Moves {
        let groups = [(group.clone(), nodes.to_vec())];
        Moves::new(self.plan, self.graph, self.axes, &groups, &mut Report::default())
    }

    /// What was shortened, in plain words after a comma; empty for nothing.
    pub fn words(&self) -> String {
        let shorter = match self.told[0] {
            0 => String::new(),
            n => format!(", {n} of them less far than that"),
        };
        match self.told {
            [0, 0] => String::new(),
            [_, 0] => format!("{shorter} so that doors and what stands there stay free"),
            [_, n] => format!("{shorter}; {n} more stay so that doors and what stands there stay free"),
        }
    }

    /// The pieces of things that may reach into a box.
    fn things_near(&self, hull: [DVec2; 2]) -> Vec<Piece> {
        let pieces = self.things.near(hull).flat_map(|t| &t.pieces).copied();
        pieces.filter(|[a, b]| meet([a.min(*b), a.max(*b)], hull)).collect()
    }

    /// Whether a wall of a group comes to stand at one of some pieces.
    fn runs_into(&self, trial: &Trial<'_>, p: &[f64], around: &[Piece]) -> bool {
        if around.is_empty() {
            return false;
        }
        let layout = trial.moves.apply(self.plan, self.graph, p);
        walls_of(self.plan, &layout).any(|(_, own)| around.iter().any(|t| gap(own, *t) < AT_WALL_M))
    }

    /// Whether a group leaves the space before all doors free at one place.
    fn is_clear(&self, trial: &Trial<'_>, p: &[f64]) -> bool {
        let layout = trial.moves.apply(self.plan, self.graph, p);
        let own: Vec<(u32, Piece)> = walls_of(self.plan, &layout).collect();
        let keeps = |now: [f64; 2], kept: [f64; 2]| now.iter().zip(kept).all(|(n, k)| *n >= k - SAME_M);
        let before = trial.near.iter().all(|d| {
            let door = &self.doors[*d];
            let kept = door.clear(door.at, trial.start.iter());
            let mut elsewhere = self.places.get(d).into_iter().flatten();
            keeps(door.clear(door.at, own.iter().map(|o| &o.1)), kept)
                && elsewhere.all(|(by, at)| {
                    // The door's own wall went there with it.
                    let goes_along = &self.taken[*by].walls;
                    let others = own.iter().filter(|o| !goes_along.contains(&o.0));
                    keeps(door.clear(*at, others.map(|o| &o.1)), kept)
                })
        });
        before
            && trial.along.iter().all(|d| {
                let door = &self.doors[*d];
                let at = door.place(self.plan, &layout);
                let reach = door.reach(at);
                let ghosts = self.taken.iter().filter(|t| !t.doors.contains(d) && meet(t.hull, reach));
                let ghosts = ghosts.flat_map(|t| &t.pieces);
                let ghosts = ghosts.filter(|g| trial.moves.walls.binary_search(&g.0).is_err());
                let others = trial.others.iter().chain(ghosts.map(|g| &g.1));
                keeps(door.clear(at, others), door.clear(door.at, trial.others.iter()))
            })
    }

    /// What a group can put where, within its new bounds.
    fn taken(&mut self, trial: &Trial<'_>, places: &[Vec<f64>]) -> Taken {
        let mut pieces = Vec::new();
        for p in places {
            let layout = trial.moves.apply(self.plan, self.graph, p);
            pieces.extend(walls_of(self.plan, &layout));
            for d in &trial.along {
                let place = self.doors[*d].place(self.plan, &layout);
                self.places.entry(*d).or_default().push((self.taken.len(), place));
            }
        }
        let hull = box_of(pieces.iter().flat_map(|p| p.1)).unwrap_or_default();
        Taken {
            doors: trial.along.iter().copied().collect(),
            walls: trial.moves.walls.iter().copied().collect(),
            pieces,
            hull,
        }
    }
}

/// One group on trial.
struct Trial<'m> {
    moves: &'m Moves,
    /// Its pieces as drawn.
    start: Vec<Piece>,
    /// The pieces that stay, near the doors that go along.
    others: Vec<Piece>,
    /// Doors that stay, before which it may come.
    near: Vec<usize>,
    /// Doors that go along with it.
    along: Vec<usize>,
    /// Box round all its outermost places.
    hull: [DVec2; 2],
}

impl<'m> Trial<'m> {
    fn new(of: &Doorways<'_>, moves: &'m Moves, grid: &Grid<'_>) -> Self {
        let handles: BTreeSet<&Handle> = moves.handles().collect();
        let is_along = |d: &Doorway| match &d.hangs {
            Hangs::Jambs(jambs) => jambs.iter().any(|j| j.ends_in(&handles)),
            Hangs::Wall(host, slot) => {
                let is_own = |g: &super::NodeGroup| slot.is_some_and(|s| g.slots.contains(&s));
                moves.groups.iter().any(|g| is_own(g) || g.handles.iter().any(|h| h.0 == *host))
            }
            Hangs::Free => false,
        };
        let (along, rest): (Vec<usize>, Vec<usize>) =
            (0..of.doors.len()).partition(|d| is_along(&of.doors[*d]));
        let corners: Vec<Layout> = grid.corners().iter().map(|p| moves.apply(of.plan, of.graph, p)).collect();
        let reached =
            corners.iter().flat_map(|l| &l.walls).flat_map(|w| pieces_of(of.plan, &w.trace)).flatten();
        let [lo, hi] = box_of(reached).unwrap_or_default();
        let hull = [lo - BETWEEN_M, hi + BETWEEN_M];
        let is_near = |d: &usize| {
            let door = &of.doors[*d];
            let places = of.places.get(d).into_iter().flatten().map(|p| p.1).chain([door.at]);
            places.into_iter().any(|at| meet(door.reach(at), hull))
        };
        let is_own = |w: &u32| moves.walls.binary_search(w).is_ok();
        let far = DVec2::splat(DOOR_WIDTH_M[1]);
        let reach: Vec<[DVec2; 2]> = along
            .iter()
            .map(|d| {
                let door = &of.doors[*d];
                let places = corners.iter().map(|l| door.place(of.plan, l)).chain([door.at]);
                let [lo, hi] = box_of(places.flatten()).unwrap_or_default();
                [lo - far, hi + far]
            })
            .collect();
        let around = |p: &Piece| {
            let own = [p[0].min(p[1]), p[0].max(p[1])];
            reach.iter().any(|r| meet(*r, own))
        };
        let others = of.drawn.iter().filter(|(w, p)| !is_own(w) && around(p)).map(|d| d.1).collect();
        Self {
            moves,
            start: of.drawn.iter().filter(|(w, _)| is_own(w)).map(|d| d.1).collect(),
            others,
            near: rest.into_iter().filter(is_near).collect(),
            along,
            hull,
        }
    }

    /// Whether no door is concerned.
    fn is_far(&self) -> bool {
        self.near.is_empty() && self.along.is_empty()
    }
}

/// The places of a group that are tried: per parameter some steps to either side of the start.
struct Grid<'m> {
    parameters: Vec<&'m Clause>,
    steps: usize,
}

impl<'m> Grid<'m> {
    fn new(moves: &'m Moves) -> Self {
        let parameters: Vec<&Clause> = moves.parameters.iter().map(|p| &p.clause).collect();
        let steps = if parameters.len() > 1 { STEPS_MANY } else { STEPS_ONE };
        Self { parameters, steps }
    }

    /// The first and the last step of every parameter.
    fn all(&self) -> (Vec<usize>, Vec<usize>) {
        let n = self.parameters.len();
        (vec![0; n], vec![2 * self.steps; n])
    }

    fn value(&self, clause: &Clause, step: usize) -> f64 {
        let identity = clause.kind.identity();
        let far = if step < self.steps { clause.lower } else { clause.upper };
        let share = step.abs_diff(self.steps) as f64 / self.steps as f64;
        let value = identity + (far - identity) * share;
        // No −0: it would be told so.
        if value == 0.0 { 0.0 } else { value }
    }

    fn values(&self, at: &[usize]) -> Vec<f64> {
        self.parameters.iter().zip(at).map(|(c, step)| self.value(c, *step)).collect()
    }

    /// All places within some steps.
    fn points(&self, lo: &[usize], hi: &[usize]) -> Vec<Vec<usize>> {
        let mut out = vec![Vec::new()];
        for (from, to) in lo.iter().zip(hi) {
            let longer = |p: Vec<usize>| (*from..=*to).map(move |s| [p.clone(), vec![s]].concat());
            out = out.into_iter().flat_map(longer).collect();
        }
        out
    }

    /// The start and the outermost places.
    fn corners(&self) -> Vec<Vec<f64>> {
        let ends = vec![vec![0, self.steps, 2 * self.steps]; self.parameters.len()];
        let mut out: Vec<Vec<usize>> = vec![Vec::new()];
        for steps in ends {
            out = out
                .into_iter()
                .flat_map(|p| steps.iter().map(move |s| [p.clone(), vec![*s]].concat()).collect::<Vec<_>>())
                .collect();
        }
        out.iter().map(|at| self.values(at)).collect()
    }

    /// Takes steps off until no bad place is left: always off that side on which most of them lie.
    fn shrink(&self, bad: &[Vec<usize>], lo: &mut [usize], hi: &mut [usize]) {
        loop {
            let within = |at: &&Vec<usize>| at.iter().enumerate().all(|(k, s)| (lo[k]..=hi[k]).contains(s));
            let left: Vec<&Vec<usize>> = bad.iter().filter(within).collect();
            let on = |k: usize, is_up: bool| {
                left.iter().filter(|at| if is_up { at[k] > self.steps } else { at[k] < self.steps }).count()
            };
            let sides = (0..lo.len()).flat_map(|k| [(on(k, false), k, false), (on(k, true), k, true)]);
            match sides.rev().max_by_key(|s| s.0) {
                Some((n, k, true)) if n > 0 => hi[k] -= 1,
                Some((n, k, false)) if n > 0 => lo[k] += 1,
                _ => return,
            }
        }
    }

    /// The group within these steps; `None` where no way is left that is worth a parameter.
    fn bounded(&self, group: &Group, lo: &[usize], hi: &[usize], scale: f64) -> Option<Group> {
        let mut out = group.clone();
        for (k, clause) in out.clauses.iter_mut().enumerate() {
            if lo.get(k).is_some_and(|s| *s > 0) {
                clause.lower = self.value(self.parameters[k], lo[k]);
            }
            if hi.get(k).is_some_and(|s| *s < 2 * self.steps) {
                clause.upper = self.value(self.parameters[k], hi[k]);
            }
        }
        let was_less = |k: usize| !is_worth_moving(&group.clauses[k], scale);
        let mut k = 0;
        out.clauses.retain(|c| {
            k += 1;
            is_worth_moving(c, scale) || was_less(k - 1)
        });
        (!out.clauses.is_empty()).then_some(out)
    }
}

/// Whether the way of a default clause is worth a parameter.
pub fn is_worth_moving(clause: &Clause, human_scale: f64) -> bool {
    let least = if matches!(clause.kind, Kind::Rotate(_)) { TURN_MIN_DEG } else { SLIDE_MIN_M * human_scale };
    clause.upper - clause.lower >= least
}

/// The doors that the file names, else those that are understood from what is drawn.
pub(super) fn doors(plan: &Plan, axes: &AxisGraph) -> Vec<Doorway> {
    if plan.doors.is_empty() { seen(plan, axes, OpeningKind::Door) } else { named_doors(plan) }
}

/// The doors that the file calls so, each along the longest side of its wall, else of its own.
fn named_doors(plan: &Plan) -> Vec<Doorway> {
    let of = |d: &NamedDoor| {
        let is_host = |w: &&Wall| d.host.is_some_and(|host| w.source.record == host);
        let sides = plan.walls.iter().filter(is_host).flat_map(|w| pieces_of(plan, &w.trace));
        let own: Vec<Piece> = pieces_of(plan, &d.outline).collect();
        let longest = |pieces: &mut dyn Iterator<Item = Piece>| {
            pieces.map(|[a, b]| b - a).max_by(|a, b| a.length().total_cmp(&b.length()))
        };
        let along =
            longest(&mut sides.into_iter()).or_else(|| longest(&mut own.iter().copied()))?.try_normalize()?;
        let local = |p: DVec2| DVec2::new(p.dot(along), along.perp_dot(p));
        let [lo, hi] = box_of(own.iter().flatten().map(|p| local(*p)))?;
        let (size, y) = (hi - lo, f64::midpoint(lo.y, hi.y));
        Some(Doorway {
            at: [lo.x, hi.x].map(|x| along * x + along.perp() * y),
            hangs: match plan.walls.iter().position(|w| is_host(&w)) {
                Some(wall) => Hangs::Wall(wall as u32, d.slot),
                None => Hangs::Free,
            },
            half: size.y / 2.0,
            wanted: size.x.clamp(CLEAR_MIN_M, DOOR_WIDTH_M[1]),
            drawn_in: Vec::new(),
        })
    };
    plan.doors.iter().filter_map(of).collect()
}

/// The openings of a kind that are understood from what is drawn.
pub(super) fn seen(plan: &Plan, axes: &AxisGraph, kind: OpeningKind) -> Vec<Doorway> {
    let openings = axes.openings.iter().filter(|o| o.kind == kind);
    let of = |o: &Opening| Doorway {
        at: o.jambs.map(|j| j.at),
        hangs: Hangs::Jambs(sides_of(plan, axes, o)),
        half: o.thickness_m / 2.0,
        wanted: o.width_m.clamp(CLEAR_MIN_M, DOOR_WIDTH_M[1]),
        drawn_in: [o.faces.as_slice(), &o.through].concat(),
    };
    openings.map(of).collect()
}

fn sides_of(plan: &Plan, axes: &AxisGraph, opening: &Opening) -> [Side; 2] {
    let [a, b] = jambs_of(plan, axes, opening);
    let [on_a, on_b] = &opening.jambs;
    [Side::new(plan, axes, on_a, a), Side::new(plan, axes, on_b, b)]
}

/// Whether two boxes meet.
pub(super) fn meet([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    a.cmple(d).all() && c.cmple(b).all()
}

/// The straight pieces of a layout's walls.
fn walls_of<'p>(plan: &'p Plan, layout: &'p Layout) -> impl Iterator<Item = (u32, Piece)> + 'p {
    layout.walls.iter().flat_map(move |w| pieces_of(plan, &w.trace).map(move |p| (w.wall, p)))
}

/// The straight pieces of an outline, metres of a person.
fn pieces_of<'p>(plan: &'p Plan, trace: &'p Trace) -> impl Iterator<Item = Piece> + 'p {
    let at = |p| plan.frame.plan_from_um(p) / plan.human_scale;
    trace.segments().map(move |(_, _, s)| [at(s.a), at(s.b)])
}
