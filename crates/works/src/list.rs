//! All works that a plan allows, and those that a rule forbids, with what each brings.

mod added;
mod partition;

use std::collections::BTreeMap;

pub use added::PARTITION_M;
use enfilade_brief::WorkKind;
use enfilade_plan::axes::AxisGraph;
use rayon::prelude::*;

use crate::blocked::{blocked_m, free_run_m};
use crate::change::Change;
use crate::counts::{Counts, Present, STEP_M, Shows, Through, counts};
use crate::marks::{Word, widths_m, word};
use crate::rooms::{Room, RoomId};
use crate::rule::{Rule, Thickness, between};
use crate::walls::{Wall, WallEnd, WallId, chains};

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
    /// Stretches of each wall that a mark keeps, metres along it.
    pub kept_m: &'a [Vec<[f64; 2]>],
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
    let parts: Vec<Works> = of_walls.chain(of_chains).collect();
    let added = if is_stopped() { Works::default() } else { finder.added() };
    for part in parts.into_iter().chain([added]) {
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

    /// Widths that are tried, ascending: the usual ones, and those that marks name.
    fn widths_m(&self) -> Vec<f64> {
        let usual = WIDTHS_M.map(|w| w * self.scale());
        let mut all: Vec<f64> = usual.into_iter().chain(widths_m(self.site.present.plan)).collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        all
    }

    /// What marks say of a work.
    fn word(&self, kind: WorkKind, size_m: f64, stretch: [glam::DVec2; 2], walls: &[WallId]) -> Word {
        let walls: Vec<&Wall> = walls.iter().map(|w| &self.site.walls[w.0]).collect();
        word(self.site.present.plan, kind, size_m, stretch, &walls)
    }

    /// Whether a mark keeps any of a wall, or of a stretch of it.
    fn is_kept(&self, wall: WallId, stretch: Option<[f64; 2]>) -> bool {
        let meets = |[from, to]: &[f64; 2]| stretch.is_none_or(|[a, b]| *from < b && a < *to);
        self.site.kept_m[wall.0].iter().any(meets)
    }

    /// What forbids to change whole walls.
    fn rules(&self, walls: &[WallId], pair: Pair) -> Vec<Rule> {
        self.rules_at(walls, pair, None)
    }

    /// The same of a stretch of them, metres along the first: marks keep what they enclose.
    fn rules_at(&self, walls: &[WallId], pair: Pair, stretch: Option<[f64; 2]>) -> Vec<Rule> {
        let of = |w: &WallId| {
            let is_kept = self.is_kept(*w, stretch);
            between(&self.site.walls[w.0], &self.thickness, is_kept, self.rooms(), pair)
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
            for width_m in self.widths_m() {
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
        let pairs = (0..places).filter_map(|k| Some((k, self.pair(run.wall, run.stretch(k))?)));
        let pairs: Vec<(usize, Pair)> = pairs.filter(|(_, p)| p.iter().all(Option::is_some)).collect();
        let width = run.width_m / self.scale();
        let (is_door, is_glass) = ((width - DOOR_M).abs() < 1e-6, width >= GLASS_M - 1e-6);
        let kinds = [(WorkKind::Open, true), (WorkKind::Door, is_door), (WorkKind::Glaze, is_glass)];
        let blocked = blocked_m(self.site.present.plan, run.wall);
        for kind in kinds.into_iter().filter(|(_, is_tried)| *is_tried).map(|(kind, _)| kind) {
            let mut alike: BTreeMap<(Word, [bool; 2], Pair), Vec<usize>> = BTreeMap::new();
            for (k, pair) in &pairs {
                let ends = run.stretch(*k).map(|t| run.wall.point(t, 0.0));
                let is_blocked = kind != WorkKind::Glaze && self.is_blocked(&blocked, run.stretch(*k));
                let word = self.word(kind, run.width_m, ends, &[id]);
                let is_kept = self.is_kept(id, Some(run.stretch(*k)));
                alike.entry((word, [is_kept, is_blocked], *pair)).or_default().push(*k);
            }
            for ((word, [_, is_blocked], pair), ks) in alike {
                let here = ks.first().map(|k| run.stretch(*k));
                let by_default = self.rules_at(&[id], pair, here).into_iter();
                let by_default = by_default.chain(is_blocked.then_some(Rule::Blocked));
                let rules = word.rules(by_default.collect());
                // A place counts once, whatever is made there.
                if kind == WorkKind::Open {
                    let is_legal =
                        |k: &usize| rules.is_empty() && (word == Word::Granted || found.openly[*k] == 0);
                    out.tried += ks.len();
                    out.legal += ks.iter().filter(|k| is_legal(k)).count();
                }
                let Some((k, shows)) = best(&found, &ks) else { continue };
                let mut forbidden_by = rules;
                let is_said = forbidden_by.iter().any(|r| matches!(r, Rule::Private(_)));
                if shows == Shows::Openly && word != Word::Granted && !is_said {
                    forbidden_by.push(Rule::ShowsPrivate);
                }
                let gained = found.gained[k] as i64;
                let work = self.opening((kind, id), run, run.stretch(k), pair, (gained, shows, forbidden_by));
                out.works.push(work);
            }
        }
    }

    /// Whether nobody could go through a stretch for what stands before it.
    fn is_blocked(&self, blocked: &[[f64; 2]], stretch: [f64; 2]) -> bool {
        let wanted = (stretch[1] - stretch[0]).min(DOOR_M * self.scale());
        free_run_m(blocked, stretch) < wanted - 1e-6
    }

    fn opening(
        &self,
        (kind, id): (WorkKind, WallId),
        run: &Run<'_>,
        stretch: [f64; 2],
        rooms: Pair,
        (gained, shows, forbidden_by): (i64, Shows, Vec<Rule>),
    ) -> Work {
        let plan = self.site.present.plan;
        let jambs = run.wall.jambs(plan, stretch).to_vec();
        Work {
            kind,
            walls: vec![id],
            opening: None,
            stretch: stretch.map(|t| run.wall.point(t, 0.0)),
            width_m: run.width_m,
            rooms,
            change: Change { demolished: vec![run.wall.quad(plan, stretch)], built: jambs },
            demolished_m: run.width_m,
            built_m: if kind == WorkKind::Glaze { run.width_m } else { 0.0 },
            gained,
            shows_through_doors: shows == Shows::ThroughDoors,
            forbidden_by,
        }
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
            let word = self.word(WorkKind::End, back, stretch.map(|t| wall.point(t, 0.0)), &[id]);
            let mut forbidden_by = word.rules(self.rules(&[id], pair));
            if found.openly[0] > 0 && word != Word::Granted {
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
