//! All works that a plan allows, and those that a rule forbids, with what each brings.

use std::collections::BTreeMap;

use enfilade_engine::geometry::Segment;
use enfilade_plan::axes::AxisGraph;
use rayon::prelude::*;

use crate::change::Change;
use crate::counts::{Counts, Present, STEP_M, Shows, Through, counts};
use crate::kind::WorkKind;
use crate::rooms::{Room, RoomId};
use crate::rule::{Rule, Thickness, between};
use crate::walls::{Chain, Wall, WallEnd, WallId, chains, is_way};

/// Clear widths of openings that are tried, metres of a person: a door, a wide door, a wide opening, half a room.
pub const WIDTHS_M: [f64; 4] = [0.9, 1.2, 1.8, 2.4];
/// Clear width of a new door.
pub const DOOR_M: f64 = 0.9;
/// Least width of glass worth a frame.
pub const GLASS_M: f64 = 1.2;
/// How far a free end goes back.
pub const ENDS_M: [f64; 2] = [0.5, 1.0];

/// The rooms on both sides of a stretch.
pub type Pair = [Option<RoomId>; 2];

/// One building work, and what it does to sight.
#[derive(Clone, Debug, PartialEq)]
pub struct Work {
    /// What it is.
    pub kind: WorkKind,
    /// The walls that it changes; the first holds the stretch.
    pub walls: Vec<WallId>,
    /// The door or opening that it changes, by its place in [`AxisGraph::openings`].
    pub opening: Option<usize>,
    /// Ends of the stretch on the wall's axis, metres in the plan frame.
    pub stretch: [glam::DVec2; 2],
    /// Clear width of what is open afterwards, or length of what goes or is built, metres.
    pub width_m: f64,
    /// The rooms on both sides.
    pub rooms: Pair,
    /// What it does.
    pub change: Change,
    /// Wall that is demolished, metres.
    pub demolished_m: f64,
    /// Wall that is built, metres.
    pub built_m: f64,
    /// Change of the sum of degrees over the present cells, where it was counted.
    pub gained: i64,
    /// Whether it shows more of a private room while that room's doors stand open.
    pub shows_through_doors: bool,
    /// What forbids it; empty: allowed.
    pub forbidden_by: Vec<Rule>,
}

/// What was looked at, and what was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Works {
    /// The best place for each kind, width, wall and pair of rooms; those that bring most first.
    pub works: Vec<Work>,
    /// Places that were measured, of every width.
    pub tried: usize,
    /// Those of them that no rule forbids.
    pub legal: usize,
}

/// Everything that works are looked for in.
pub struct Site<'a> {
    /// How the present layout is seen.
    pub present: Present<'a>,
    /// Its walls as a graph.
    pub axes: &'a AxisGraph,
    /// Its straight walls.
    pub walls: &'a [Wall],
    /// Whether a mark keeps each wall.
    pub is_kept: &'a [bool],
}

/// Finds and counts them all. `is_stopped` is asked between walls; what is found by then is returned.
pub fn works(site: &Site<'_>, is_stopped: &(dyn Fn() -> bool + Sync)) -> Works {
    let chains = chains(site.walls, site.axes);
    let inner: Vec<&Wall> = site.walls.iter().filter(|w| is_inner(site, w)).collect();
    let thickness = Thickness::new(site.present.plan, &inner);
    let finder = Finder { site, thickness };
    let of_walls = (0..site.walls.len()).into_par_iter().map(|w| match is_stopped() {
        true => Works::default(),
        false => finder.in_wall(WallId(w)),
    });
    let of_chains = chains.par_iter().map(|c| match is_stopped() {
        true => Works::default(),
        false => finder.in_chain(c),
    });
    let mut out = Works::default();
    for part in of_walls.chain(of_chains).collect::<Vec<_>>() {
        out.works.extend(part.works);
        out.tried += part.tried;
        out.legal += part.legal;
    }
    out.works.sort_by(|a, b| b.gained.cmp(&a.gained).then_with(|| order(a).cmp(&order(b))));
    out
}

fn order(w: &Work) -> (WorkKind, &[WallId], Option<usize>) {
    (w.kind, &w.walls, w.opening)
}

fn is_inner(site: &Site<'_>, wall: &Wall) -> bool {
    let p = &site.present;
    wall.rooms_at(p.plan, p.rooms, wall.length_m / 2.0).iter().all(Option::is_some)
}

struct Finder<'a> {
    site: &'a Site<'a>,
    thickness: Thickness,
}

/// A run of places along a wall: their first jamb stands at `from_m + k · step_m`.
struct Run<'a> {
    wall: &'a Wall,
    from_m: f64,
    step_m: f64,
    width_m: f64,
}

impl Run<'_> {
    fn stretch(&self, k: usize) -> [f64; 2] {
        let from = self.from_m + k as f64 * self.step_m;
        [from, from + self.width_m]
    }
}

impl Finder<'_> {
    fn scale(&self) -> f64 {
        self.site.present.plan.human_scale
    }

    fn rooms(&self) -> &[Room] {
        self.site.present.rooms
    }

    fn rules(&self, walls: &[WallId], pair: Pair) -> Vec<Rule> {
        let of = |w: &WallId| {
            between(&self.site.walls[w.0], &self.thickness, self.site.is_kept[w.0], self.rooms(), pair)
        };
        let mut all: Vec<Rule> = walls.iter().flat_map(of).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The pair of rooms beside a stretch, if it is one all along.
    fn pair(&self, wall: &Wall, [from, to]: [f64; 2]) -> Option<Pair> {
        let p = &self.site.present;
        let inset = 0.05 * self.scale();
        let steps = ((to - from) / (STEP_M * self.scale())).ceil().max(1.0) as usize;
        let at = |i: usize| from + inset + (to - from - 2.0 * inset) * i as f64 / steps as f64;
        let first = wall.rooms_at(p.plan, p.rooms, at(0));
        (1..=steps).all(|i| wall.rooms_at(p.plan, p.rooms, at(i)) == first).then_some(first)
    }

    /// Openings, doors, glass in one wall, and its free ends.
    fn in_wall(&self, id: WallId) -> Works {
        let wall = &self.site.walls[id.0];
        let mut out = Works::default();
        let [lo, hi] = wall.free(self.scale());
        if hi - lo >= WIDTHS_M[0] * self.scale() - 1e-9 && self.is_between_rooms(wall, [lo, hi]) {
            let through = self.site.present.through(wall, [lo, hi]);
            for width_m in WIDTHS_M.map(|w| w * self.scale()) {
                let run = Run { wall, from_m: lo, step_m: STEP_M * self.scale(), width_m };
                self.openings(id, &run, hi, &through, &mut out);
            }
        }
        for end in 0..2 {
            if wall.ends[end] == WallEnd::Free {
                self.free_end(id, end, &mut out);
            }
        }
        out
    }

    /// Whether there is any room beside a wall: else nobody looks through it.
    fn is_between_rooms(&self, wall: &Wall, [lo, hi]: [f64; 2]) -> bool {
        let p = &self.site.present;
        let steps = ((hi - lo) / (0.3 * self.scale())).ceil() as usize;
        (0..=steps).any(|i| {
            let at = lo + (hi - lo) * i as f64 / steps.max(1) as f64;
            wall.rooms_at(p.plan, p.rooms, at).iter().all(Option::is_some)
        })
    }

    /// The best place of one width for each pair of rooms.
    fn openings(&self, id: WallId, run: &Run<'_>, hi: f64, through: &[Through], out: &mut Works) {
        let room = hi - run.from_m - run.width_m;
        if room < -1e-9 {
            return;
        }
        let places = (room / run.step_m + 1e-6).floor() as usize + 1;
        let found = counts(through, run.from_m, run.step_m, places, run.width_m);
        let mut by_pair: BTreeMap<Pair, Vec<usize>> = BTreeMap::new();
        for k in 0..places {
            if let Some(pair) = self.pair(run.wall, run.stretch(k)) {
                by_pair.entry(pair).or_default().push(k);
            }
        }
        for (pair, ks) in by_pair.into_iter().filter(|(pair, _)| pair.iter().all(Option::is_some)) {
            let rules = self.rules(&[id], pair);
            out.tried += ks.len();
            if rules.is_empty() {
                out.legal += ks.iter().filter(|k| found.openly[**k] == 0).count();
            }
            let Some((k, shows)) = best(&found, &ks) else { continue };
            let mut forbidden_by = rules;
            if shows == Shows::Openly && forbidden_by.iter().all(|r| !matches!(r, Rule::Private(_))) {
                forbidden_by.push(Rule::ShowsPrivate);
            }
            let gained = found.gained[k] as i64;
            self.push_opening(id, run, run.stretch(k), pair, (gained, shows, &forbidden_by), out);
        }
    }

    fn push_opening(
        &self,
        id: WallId,
        run: &Run<'_>,
        stretch: [f64; 2],
        rooms: Pair,
        (gained, shows, forbidden_by): (i64, Shows, &[Rule]),
        out: &mut Works,
    ) {
        let plan = self.site.present.plan;
        let jambs = run.wall.jambs(plan, stretch).to_vec();
        let change = Change { demolished: vec![run.wall.quad(plan, stretch)], built: jambs };
        let width = run.width_m / self.scale();
        let mut kinds = vec![(WorkKind::Open, 0.0)];
        if (width - DOOR_M).abs() < 1e-6 {
            kinds.push((WorkKind::Door, 0.0));
        }
        if width >= GLASS_M - 1e-6 {
            kinds.push((WorkKind::Glaze, run.width_m));
        }
        out.works.extend(kinds.into_iter().map(|(kind, built_m)| Work {
            kind,
            walls: vec![id],
            opening: None,
            stretch: stretch.map(|t| run.wall.point(t, 0.0)),
            width_m: run.width_m,
            rooms,
            change: change.clone(),
            demolished_m: run.width_m,
            built_m,
            gained,
            shows_through_doors: shows == Shows::ThroughDoors,
            forbidden_by: forbidden_by.to_vec(),
        }));
    }

    /// A free end that goes back.
    fn free_end(&self, id: WallId, end: usize, out: &mut Works) {
        let wall = flipped(&self.site.walls[id.0], end == 0);
        let scale = self.scale();
        let [lo, _] = wall.free(scale);
        let most = wall.length_m - lo;
        let beyond = 0.05 * scale;
        let plan = self.site.present.plan;
        if most < ENDS_M[0] * scale {
            return;
        }
        let through = self.site.present.through(&wall, [lo, wall.length_m + beyond]);
        for back in ENDS_M.map(|b| b * scale).into_iter().filter(|b| *b <= most) {
            let from = wall.length_m - back;
            // Sight passes where it crosses beyond the new end.
            let found = counts(&through, from, STEP_M * scale, 1, f64::from(u32::MAX));
            let stretch = [from, wall.length_m];
            let Some(pair) = self.pair(&wall, stretch) else { continue };
            let mut forbidden_by = self.rules(&[id], pair);
            if found.openly[0] > 0 {
                forbidden_by.push(Rule::ShowsPrivate);
            }
            out.tried += 1;
            out.legal += usize::from(forbidden_by.is_empty());
            out.works.push(Work {
                kind: WorkKind::End,
                walls: vec![id],
                opening: None,
                stretch: stretch.map(|t| wall.point(t, 0.0)),
                width_m: back,
                rooms: pair,
                change: Change {
                    demolished: vec![wall.quad(plan, [from, wall.length_m + beyond])],
                    built: vec![wall.across(plan, from)],
                },
                demolished_m: back,
                built_m: 0.0,
                gained: found.gained[0] as i64,
                shows_through_doors: found.through_doors[0] > 0,
                forbidden_by,
            });
        }
    }

    /// What is done to a whole partition: it goes, its doors grow, close, or hang elsewhere.
    fn in_chain(&self, chain: &Chain) -> Works {
        let mut out = Works::default();
        let line = self.line(chain);
        self.removed(chain, &line, &mut out);
        for &opening in &chain.openings {
            self.changed_opening(chain, &line, opening, &mut out);
        }
        out
    }

    /// A chain as one wall: from its first end to its last.
    fn line(&self, chain: &Chain) -> Wall {
        let walls = self.site.walls;
        let [(a, ae), (b, be)] = chain.ends;
        let end_of = |w: WallId, e: usize| {
            let wall = &walls[w.0];
            (wall.point(if e == 0 { 0.0 } else { wall.length_m }, 0.0), wall.ends[e])
        };
        let ((at, first), (to, last)) = (end_of(a, ae), end_of(b, be));
        let thickness_m = chain.walls.iter().map(|w| walls[w.0].thickness_m).fold(0.0, f64::max);
        Wall {
            at,
            along: (to - at).normalize_or(walls[a.0].along),
            length_m: at.distance(to),
            thickness_m,
            ends: [first, last],
            ..walls[a.0].clone()
        }
    }

    fn removed(&self, chain: &Chain, line: &Wall, out: &mut Works) {
        let plan = self.site.present.plan;
        let keep = |end: WallEnd| if let WallEnd::Joint(reach) = end { reach } else { -0.05 * self.scale() };
        let stretch = [keep(line.ends[0]), line.length_m - keep(line.ends[1])];
        if stretch[1] - stretch[0] < WIDTHS_M[0] * self.scale() || !self.is_between_rooms(line, stretch) {
            return;
        }
        let Some(pair) = self.main_pair(line, stretch) else { return };
        let through = self.site.present.through(line, stretch);
        let mut forbidden_by = self.rules(&chain.walls, pair);
        if through.iter().any(|t| t.shows == Shows::Openly)
            && !forbidden_by.iter().any(|r| matches!(r, Rule::Private(_)))
        {
            forbidden_by.push(Rule::ShowsPrivate);
        }
        let open: f64 =
            chain.openings.iter().map(|o| self.site.axes.openings[*o].width_m * self.scale()).sum();
        let length = stretch[1] - stretch[0];
        out.tried += 1;
        out.legal += usize::from(forbidden_by.is_empty());
        out.works.push(Work {
            kind: WorkKind::Remove,
            walls: chain.walls.clone(),
            opening: None,
            stretch: stretch.map(|t| line.point(t, 0.0)),
            width_m: length,
            rooms: pair,
            // Where it met other walls, their faces are made good.
            change: Change {
                demolished: vec![line.quad(plan, stretch)],
                built: line.jambs(plan, stretch).to_vec(),
            },
            demolished_m: length - open,
            built_m: 0.0,
            gained: through.iter().map(|t| i64::from(t.weight)).sum(),
            shows_through_doors: through.iter().any(|t| t.shows == Shows::ThroughDoors),
            forbidden_by,
        });
    }

    /// The pair of rooms that most of a stretch has; none where a private one or none stands at any of it.
    fn main_pair(&self, line: &Wall, [from, to]: [f64; 2]) -> Option<Pair> {
        let p = &self.site.present;
        let steps = ((to - from) / (STEP_M * self.scale())).ceil().max(1.0) as usize;
        let mut counted: BTreeMap<Pair, usize> = BTreeMap::new();
        for i in 0..steps {
            let at = from + (to - from) * (i as f64 + 0.5) / steps as f64;
            *counted.entry(line.rooms_at(p.plan, p.rooms, at)).or_default() += 1;
        }
        let is_private = |r: &Option<RoomId>| r.is_some_and(|r| p.rooms[r.0].is_private);
        let rank = |pair: &Pair, n: usize| (pair.iter().any(Option::is_none), pair.iter().any(is_private), n);
        // A short piece at a private room forbids the whole.
        let worst = counted.iter().filter(|(_, n)| **n * 10 > steps).max_by_key(|(pair, n)| rank(pair, **n));
        worst.map(|(pair, _)| *pair)
    }

    fn changed_opening(&self, chain: &Chain, line: &Wall, index: usize, out: &mut Works) {
        let (scale, plan) = (self.scale(), self.site.present.plan);
        let opening = &self.site.axes.openings[index];
        if !is_way(opening.kind) {
            return;
        }
        let along = |p: glam::DVec2| (p * scale - line.at).dot(line.along);
        let [mut from, mut to] = opening.jambs.map(|j| along(j.at));
        if from > to {
            (from, to) = (to, from);
        }
        let Some(pair) = self.pair(line, [from, to]) else { return };
        self.widened(chain, line, (index, [from, to]), pair, out);
        let [Some(a), Some(b)] = pair else { return };
        let faces = |v: f64| Segment {
            a: plan.frame.um_from_plan(line.point(from, v)),
            b: plan.frame.um_from_plan(line.point(to, v)),
        };
        let half = line.thickness_m / 2.0;
        let mut built = vec![faces(half)];
        if half > 0.0 {
            built.push(faces(-half));
        }
        let change = Change { demolished: Vec::new(), built };
        let after = self.site.present.changed(&change);
        let degrees =
            |of: &enfilade_engine::graph::Graph| Present { graph: of, ..self.present() }.degrees() as i64;
        let lost = degrees(&after) - degrees(self.site.present.graph);
        let ways = |r: RoomId| self.ways(r);
        let forbidden_by: Vec<Rule> =
            [a, b].into_iter().filter(|r| ways(*r) <= 1).map(Rule::LastDoor).collect();
        out.tried += 1;
        out.legal += usize::from(forbidden_by.is_empty());
        out.works.push(Work {
            kind: WorkKind::Close,
            walls: chain.walls.clone(),
            opening: Some(index),
            stretch: [line.point(from, 0.0), line.point(to, 0.0)],
            width_m: to - from,
            rooms: pair,
            change: change.clone(),
            demolished_m: 0.0,
            built_m: to - from,
            gained: lost,
            shows_through_doors: false,
            forbidden_by,
        });
        self.rehung(chain, (index, [from, to]), pair, (&change, lost), out);
    }

    fn present(&self) -> Present<'_> {
        Present { ..self.site.present }
    }

    /// Doors and passages of a room.
    fn ways(&self, room: RoomId) -> usize {
        let p = &self.site.present;
        let (axes, scale) = (self.site.axes, self.scale());
        let off = |o: &enfilade_plan::axes::Opening| {
            let [a, b] = o.jambs.map(|j| j.at * scale);
            let across = (b - a).normalize_or_zero().perp() * (o.thickness_m / 2.0 + 0.25) * scale;
            let middle = a.midpoint(b);
            [middle + across, middle - across]
                .map(|q| crate::rooms::room_at(p.rooms, p.plan.frame.um_from_plan(q)))
        };
        axes.openings.iter().filter(|o| is_way(o.kind)).filter(|o| off(o).contains(&Some(room))).count()
    }

    fn widened(&self, chain: &Chain, line: &Wall, at: (usize, [f64; 2]), pair: Pair, out: &mut Works) {
        let (index, [from, to]) = at;
        let (scale, plan) = (self.scale(), self.site.present.plan);
        // Wall that may go to either side: up to what is kept at the far end of the piece beside the opening.
        let limits = self.limits(chain, line, [from, to]);
        if limits[1] - limits[0] < to - from + 0.2 * scale {
            return;
        }
        let through = self.site.present.through(line, limits);
        for width_m in WIDTHS_M.map(|w| w * scale).into_iter().filter(|w| *w > to - from + 0.15 * scale) {
            let step_m = STEP_M * scale;
            let least = (to - width_m).max(limits[0]);
            // From the present jamb on in whole steps, so that one side can stay.
            let first = from - ((from - least) / step_m + 1e-6).floor() * step_m;
            let most = from.min(limits[1] - width_m);
            if most < first - 1e-9 {
                continue;
            }
            let places = ((most - first) / step_m + 1e-6).floor() as usize + 1;
            let found = counts(&through, first, step_m, places, width_m);
            let rules = self.rules(&chain.walls, pair);
            out.tried += places;
            out.legal += if rules.is_empty() { found.openly.iter().filter(|p| **p == 0).count() } else { 0 };
            let ks: Vec<usize> = (0..places).collect();
            let Some((k, shows)) = best(&found, &ks) else { continue };
            let start = first + k as f64 * step_m;
            let stretch = [start, start + width_m];
            let mut forbidden_by = rules;
            if shows == Shows::Openly && !forbidden_by.iter().any(|r| matches!(r, Rule::Private(_))) {
                forbidden_by.push(Rule::ShowsPrivate);
            }
            out.works.push(Work {
                kind: WorkKind::Widen,
                walls: chain.walls.clone(),
                opening: Some(index),
                stretch: stretch.map(|t| line.point(t, 0.0)),
                width_m,
                rooms: pair,
                change: Change {
                    demolished: vec![line.quad(plan, stretch)],
                    built: line.jambs(plan, stretch).to_vec(),
                },
                demolished_m: width_m - (to - from),
                built_m: 0.0,
                gained: found.gained[k] as i64,
                shows_through_doors: shows == Shows::ThroughDoors,
                forbidden_by,
            });
        }
    }

    /// Between where and where an opening may grow.
    fn limits(&self, chain: &Chain, line: &Wall, [from, to]: [f64; 2]) -> [f64; 2] {
        let scale = self.scale();
        let mut limits = [from, to];
        for w in &chain.walls {
            let wall = &self.site.walls[w.0];
            let mut ends = [0.0, wall.length_m].map(|t| (wall.point(t, 0.0) - line.at).dot(line.along));
            let is_turned = ends[0] > ends[1];
            if is_turned {
                ends.swap(0, 1);
            }
            let free = wall.free(scale);
            let free = if is_turned { [wall.length_m - free[1], wall.length_m - free[0]] } else { free };
            let near = 0.05 * scale;
            if (ends[1] - from).abs() < near {
                limits[0] = (ends[0] + free[0]).min(from);
            }
            if (ends[0] - to).abs() < near {
                limits[1] = (ends[0] + free[1]).max(to);
            }
        }
        limits
    }

    /// A door that goes to another place of its wall.
    fn rehung(
        &self,
        chain: &Chain,
        (index, [from, to]): (usize, [f64; 2]),
        pair: Pair,
        (closed, lost): (&Change, i64),
        out: &mut Works,
    ) {
        let plan = self.site.present.plan;
        let width_m = to - from;
        let mut found: Option<Work> = None;
        for id in &chain.walls {
            let wall = &self.site.walls[id.0];
            let [lo, hi] = wall.free(self.scale());
            if hi - lo < width_m {
                continue;
            }
            let through = self.site.present.through(wall, [lo, hi]);
            let step_m = STEP_M * self.scale();
            let places = ((hi - lo - width_m) / step_m + 1e-6).floor() as usize + 1;
            let all = counts(&through, lo, step_m, places, width_m);
            let run = Run { wall, from_m: lo, step_m, width_m };
            let ks: Vec<usize> = (0..places)
                .filter(|k| self.pair(wall, run.stretch(*k)).is_some_and(|p| same(p, pair)))
                .collect();
            out.tried += ks.len();
            let Some(k) = ks.into_iter().max_by_key(|k| (all.gained[*k], usize::MAX - k)) else { continue };
            let stretch = run.stretch(k);
            let opened = Change {
                demolished: vec![wall.quad(plan, stretch)],
                built: wall.jambs(plan, stretch).to_vec(),
            };
            let work = Work {
                kind: WorkKind::Rehang,
                walls: vec![*id],
                opening: Some(index),
                stretch: stretch.map(|t| wall.point(t, 0.0)),
                width_m,
                rooms: pair,
                change: opened.and(closed),
                demolished_m: width_m,
                built_m: width_m,
                gained: lost + all.gained[k] as i64,
                shows_through_doors: false,
                forbidden_by: Vec::new(),
            };
            if found.as_ref().is_none_or(|f| f.gained < work.gained) {
                found = Some(work);
            }
        }
        let Some(mut work) = found else { return };
        self.judge_rehung(&mut work, &chain.walls);
        out.legal += usize::from(work.forbidden_by.is_empty());
        out.works.push(work);
    }

    /// A re-hung door is measured as a whole: what both doors show is not their sum. A private room keeps its door, but no
    /// more of it may be seen.
    fn judge_rehung(&self, work: &mut Work, walls: &[WallId]) {
        let p = &self.site.present;
        let after = p.changed(&work.change);
        let shown =
            |graph: &enfilade_engine::graph::Graph| Present { graph, ..self.present() }.shown_private();
        let degrees =
            |graph: &enfilade_engine::graph::Graph| Present { graph, ..self.present() }.degrees() as i64;
        work.gained = degrees(&after) - degrees(p.graph);
        let rules = self.rules(walls, work.rooms);
        work.forbidden_by = rules.into_iter().filter(|r| !matches!(r, Rule::Private(_))).collect();
        if shown(&after) > shown(p.graph) {
            work.forbidden_by.push(Rule::ShowsPrivate);
        }
    }
}

/// The best of some places: of those that show no private room at all, else of those that show one only through its
/// doors, else of all; and what it shows.
fn best(found: &Counts, ks: &[usize]) -> Option<(usize, Shows)> {
    let most = |of: &dyn Fn(usize) -> bool| {
        ks.iter().copied().filter(|k| of(*k)).max_by_key(|k| (found.gained[*k], usize::MAX - k))
    };
    let gains = |k: &usize| found.gained[*k] > 0;
    let quiet = most(&|k| found.openly[k] == 0 && found.through_doors[k] == 0).filter(gains);
    let shut = || most(&|k| found.openly[k] == 0).filter(gains).map(|k| (k, Shows::ThroughDoors));
    let any =
        || most(&|_| true).map(|k| (k, if found.openly[k] > 0 { Shows::Openly } else { Shows::Nothing }));
    quiet.map(|k| (k, Shows::Nothing)).or_else(shut).or_else(any)
}

fn same(a: Pair, b: Pair) -> bool {
    a == b || a == [b[1], b[0]]
}

/// The same wall seen from its other end.
fn flipped(wall: &Wall, is_turned: bool) -> Wall {
    if !is_turned {
        return wall.clone();
    }
    Wall {
        at: wall.point(wall.length_m, 0.0),
        along: -wall.along,
        ends: [wall.ends[1], wall.ends[0]],
        ..wall.clone()
    }
}
