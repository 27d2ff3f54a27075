//! `enfilade works`: every building work measured, ranked, the best confirmed.

mod builder;
mod cuts;
mod edits;
mod fitted;
mod made;
pub(crate) mod option;
pub(crate) mod options;
mod overhead;
mod pinned;
mod sets;
mod shown;
mod with_moves;

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use crate::analyse::measure;
use crate::job::{Input, Job, Outcome};
use crate::measure::estimate::{Sampled, interval};
use crate::measure::lattices;
use crate::measure::study::Study;
use crate::understand::rooms::{Room as KnownRoom, rooms_with_kinds};
use crate::understand::sensed::Sensed;
use crate::write::show;
use enfilade_config::Settings;
use enfilade_engine::Lattice;
use enfilade_engine::forest::tally;
use enfilade_engine::geometry::{Segment, UM_PER_M};
use enfilade_engine::graph::Graph;
use enfilade_engine::measures::mean_depth;
use enfilade_engine::visibility::Vista;
use enfilade_overlay::built::Effort;
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::result::{self, FrontPoint, Interval, Objective};
use enfilade_overlay::works::{
    BestEntry, ColouredWall, RoomEntry, STEPS, VISIBILITY, WORKS_SCHEMA, WorkEntry, WorkGain, WorksResult,
    works_png,
};
use enfilade_plan::Plan;
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::floor::Beside;
use enfilade_report::{Cancel, Error, OutFile, Place, Report};
use enfilade_works::counts::{Present, STEP_M, degrees, difference};
use enfilade_works::rooms::rooms_of;
use enfilade_works::walls::{Wall, walls};
use enfilade_works::{Change, Room, RoomId, Site, Work, WorkKind, Works, works};
pub(crate) use made::{Drawn, Moved, of_option};
pub use made::{MadeWorks, make_works};
use option::BuildingOption;

/// Works of which steps are counted too: by trees of all cells.
const WITH_STEPS: usize = 24;
/// Works that are confirmed on other lattices: those that somebody reads first.
const CONFIRMED: usize = 6;
/// Works that are listed at most, allowed and forbidden each: more than anybody reads.
const LISTED: usize = 200;
/// Works that the report of a round names, allowed and forbidden.
const SAID: usize = 3;
const SAID_FORBIDDEN: usize = 2;
/// How much further the mean of a gain may lie than two lattices show: extrapolation from one spacing to half of it.
const REACH: f64 = 1.0;
/// Lattices of either spacing with which somebody else would measure again.
const AGAIN: f64 = 2.0;

/// Measures all works of a drawing. Files: `works.json`, `works.png`.
///
/// # Errors
/// As [`measure`]; [`Error::Stopped`].
pub fn works_of(
    input: &Input<'_>,
    settings: &Settings,
    cancel: &Cancel,
) -> Result<(Outcome<WorksResult>, Study), Error> {
    let (study, report) = measure(input, settings, None, &mut || {}, cancel)?;
    let listed = of_study(Job { input, settings }, &study, cancel)?;
    let files = listed.files()?;
    Ok((Outcome { result: listed.result, files, report }, study))
}

/// The works of a study as a round has them.
pub(crate) struct Listed {
    /// The list.
    pub result: WorksResult,
    /// `works.png`, where pictures are drawn.
    pub picture: Option<Vec<u8>>,
    /// Every wall with the best that an opening in it would bring.
    pub walls: Vec<ColouredWall>,
    /// What they were looked for on.
    floor: Floor,
    /// The works of the list, in its order.
    found: Vec<Work>,
}

/// The works of a round: the list, and the options that build.
pub(crate) struct Offer {
    /// All works.
    pub listed: Listed,
    /// Those that are options, the best first.
    pub options: Vec<Arc<BuildingOption>>,
    /// What works together bring for what they cost.
    pub front: Vec<FrontPoint>,
    /// What is asked for, with the present layout's values.
    pub objectives: Vec<Objective>,
}

impl Listed {
    /// `works.json` and `works.png`.
    ///
    /// # Errors
    /// Where the list cannot be written as JSON.
    pub fn files(&self) -> Result<Vec<OutFile>, Error> {
        let picture = self.picture.iter().map(|png| OutFile::new("works.png", png.clone()));
        let json = OutFile::new("works.json", result::to_json(&self.result)?);
        Ok(std::iter::once(json).chain(picture).collect())
    }
}

/// A floor as works are looked for on it.
pub(crate) struct Floor {
    sensed: Sensed,
    known: Vec<KnownRoom>,
    rooms: Vec<Room>,
    walls: Vec<Wall>,
    kept_m: Vec<Vec<[f64; 2]>>,
    vista: Vista,
    graph: Graph,
    room_of: Vec<Option<RoomId>>,
    is_query: Vec<bool>,
    shut: Vec<Segment>,
}

impl Floor {
    /// The present floor of a study.
    fn of(study: &Study, settings: &Settings) -> Result<Self, Error> {
        let (base, lattice) = (&study.base, &study.lattice);
        let sensed = Sensed::new(base, settings);
        let known = rooms_with_kinds(base, &sensed, settings)?;
        let rooms: Vec<Room> = known.iter().map(room).collect();
        let walls = walls(&base.plan, &base.axes);
        let vista = Vista::new(Arc::clone(lattice), study.initial_obstacles());
        Ok(Self {
            kept_m: walls.iter().map(|w| kept_m(&base.plan, w)).collect(),
            graph: vista.graph(),
            room_of: rooms_of(lattice, &rooms),
            is_query: is_query(lattice),
            shut: doors_of_private(&sensed, &rooms),
            sensed,
            known,
            rooms,
            walls,
            vista,
        })
    }

    fn site<'a>(&'a self, study: &'a Study) -> Site<'a> {
        let present = Present {
            plan: &study.base.plan,
            lattice: &study.lattice,
            vista: &self.vista,
            graph: &self.graph,
            rooms: &self.rooms,
            room_of: &self.room_of,
            is_query: &self.is_query,
            shut: &self.shut,
        };
        Site { present, axes: &study.base.axes, walls: &self.walls, kept_m: &self.kept_m }
    }

    /// All works, measured.
    fn works(&self, study: &Study, cancel: &Cancel) -> Result<Works, Error> {
        let found = works(&self.site(study), &|| cancel.check().is_err());
        cancel.check()?;
        Ok(found)
    }
}

/// The works of a study, with their picture where pictures are drawn.
///
/// # Errors
/// [`Error::Stopped`]; where the picture cannot be drawn.
pub(crate) fn of_study(
    Job { input, settings }: Job<'_>,
    study: &Study,
    cancel: &Cancel,
) -> Result<Listed, Error> {
    let floor = Floor::of(study, settings)?;
    let found = floor.works(study, cancel)?;
    let (base, site) = (&study.base, &floor.site(study));
    let listed = listed(&found.works);
    let entries = entries(study, settings, site, &listed);
    cancel.check()?;
    let single =
        entries.iter().find(|e| e.is_allowed && e.gain.get(VISIBILITY).is_some_and(|g| g.share > 0.0));
    let result = WorksResult {
        schema: WORKS_SCHEMA.into(),
        version: enfilade_config::VERSION.into(),
        input: show::input(&base.plan, input),
        spacing_m: study.spacing_m,
        cells: study.lattice.cells.len(),
        rooms: room_entries(&floor.rooms),
        best: BestEntry { single: single.map(|e| e.id), tried: found.tried, legal: found.legal },
        works: entries,
    };
    let walls = coloured(site, &found.works);
    let drawn = || {
        let shown = show::check_picture(base, &floor.sensed, &floor.known);
        works_png(&shown, &walls, ("What an opening would bring", input.file()), DEFAULT_SIDE_PX)
    };
    let picture = settings.pictures.then(drawn).transpose()?;
    let found = listed.into_iter().cloned().collect();
    Ok(Listed { result, picture, walls, floor, found })
}

/// A room with what it is for.
fn room(r: &KnownRoom) -> Room {
    Room {
        area: r.area.clone(),
        name: r.name.clone().unwrap_or_default(),
        kind: r.found.kind,
        dwelling: r.found.dwelling,
    }
}

/// Says the best works in the report of a round: where no layout helps, this does.
pub(crate) fn say_best(result: &WorksResult, file: &str, report: &mut Report) {
    let place = || Place::file(file);
    for work in result.different(true, SAID) {
        report.info("work-allowed", place(), format!("{}.", result.line(work)));
    }
    for work in result.different(false, SAID_FORBIDDEN) {
        report.info("work-forbidden", place(), format!("{}.", result.line(work)));
    }
    report.info("works-tried", place(), result.proof());
}

/// The doors of private rooms, shut: whoever wants to be alone shuts the door.
fn doors_of_private(sensed: &Sensed, rooms: &[Room]) -> Vec<Segment> {
    let is_private =
        |b: &Beside| matches!(b, Beside::Room(r) if rooms.get(*r).is_some_and(|r| r.kind.is_private()));
    let beside = sensed.floor.iter().flat_map(|f| &f.beside);
    let doors = sensed
        .gaps
        .iter()
        .zip(beside)
        .filter(|(g, b)| g.kind == OpeningKind::Door && b.iter().any(is_private));
    doors.map(|(g, _)| Segment { a: g.gap.jambs[0], b: g.gap.jambs[1] }).collect()
}

fn room_entries(rooms: &[Room]) -> Vec<RoomEntry> {
    let m = |v: i64| (v as f64 / UM_PER_M * 1e3).round() / 1e3;
    let entry = |(i, room): (usize, &Room)| RoomEntry {
        id: i + 1,
        name: room.name.clone(),
        kind: room.kind.name().into(),
        is_private: room.kind.is_private(),
        dwelling: room.dwelling.map(|d| d + 1),
        area_m2: (room.area.area_m2 * 100.0).round() / 100.0,
        at: room.area.at.map(m),
    };
    rooms.iter().enumerate().map(entry).collect()
}

/// Stretches of a wall that a mark keeps, metres along it: round the places on its axis that lie in one.
fn kept_m(plan: &Plan, wall: &Wall) -> Vec<[f64; 2]> {
    let step_m = STEP_M / 2.0 * plan.human_scale;
    let count = (wall.length_m / step_m).ceil().max(1.0);
    let is_kept = |at_m: f64| {
        let p = plan.frame.um_from_plan(wall.point(at_m, 0.0));
        plan.markers.keep.iter().any(|r| r.contains(p))
    };
    let at = |i: usize| wall.length_m * i as f64 / count;
    let kept = (0..=count as usize).map(at).filter(|m| !plan.markers.keep.is_empty() && is_kept(*m));
    kept.map(|m| [m - step_m, m + step_m]).collect()
}

fn is_query(lattice: &Lattice) -> Vec<bool> {
    let mut out = vec![false; lattice.cells.len()];
    lattice.query.iter().for_each(|v| out[*v as usize] = true);
    out
}

/// The works to tell of: the best of either sort, in their order.
fn listed(all: &[Work]) -> Vec<&Work> {
    let mut left = [LISTED; 2];
    let take = |w: &&Work| {
        let left = &mut left[usize::from(w.forbidden_by.is_empty())];
        let is_taken = *left > 0;
        *left = left.saturating_sub(1);
        is_taken
    };
    all.iter().filter(take).collect()
}

fn entries(study: &Study, settings: &Settings, site: &Site<'_>, works: &[&Work]) -> Vec<WorkEntry> {
    let present = &site.present;
    let all = present.degrees().max(1) as f64;
    let steps_now = steps(present.lattice, present.graph);
    let confirmed = confirmed(study, settings, works);
    // The best of either sort have their steps counted.
    let most = WITH_STEPS / study.thinned();
    let mut seen = [0usize; 2];
    let with_steps: Vec<bool> = works
        .iter()
        .map(|w| {
            let n = &mut seen[usize::from(w.forbidden_by.is_empty())];
            *n += 1;
            *n <= most
        })
        .collect();
    let one = |(i, work): (usize, &&Work)| {
        let mut gain = BTreeMap::new();
        let share = work.gained as f64 / all;
        let sure = confirmed.get(&i).copied().map_or(WorkGain { share, low: None, high: None }, |c| c.into());
        gain.insert(VISIBILITY.to_owned(), sure);
        if with_steps[i] {
            let steps = steps(present.lattice, &present.changed(&work.change));
            if let (Some(now), Some(then)) = (steps_now, steps) {
                let share = (now - then) / now;
                gain.insert(STEPS.to_owned(), WorkGain { share, low: None, high: None });
            }
        }
        entry(study, site, i, work, gain)
    };
    works.par_iter().enumerate().map(one).collect()
}

/// Metres to whole millimetres, never −0.
fn whole_mm(v: f64) -> f64 {
    (v * 1e3).round() / 1e3 + 0.0
}

fn entry(
    study: &Study,
    site: &Site<'_>,
    index: usize,
    work: &Work,
    gain: BTreeMap<String, WorkGain>,
) -> WorkEntry {
    let plan = &study.base.plan;
    let sources = work.walls.iter().flat_map(|w| &site.walls[w.0].records);
    let mut wall: Vec<result::ElementRef> = Vec::new();
    for record in sources {
        let source = plan.walls.iter().map(|w| &w.source).find(|s| s.record == *record);
        let element = source.map(|s| show::element(plan.format, s));
        wall.extend(element.filter(|e| !wall.contains(e)));
    }
    let mut forbidden_by: Vec<String> = work.forbidden_by.iter().map(|r| r.code().to_owned()).collect();
    forbidden_by.dedup();
    WorkEntry {
        id: index + 1,
        kind: work.kind.name().into(),
        wall,
        stretch: work.stretch.map(|p| plan.frame.drawing_m_from_plan(p).map(whole_mm)),
        width_m: whole_mm(work.width_m),
        rooms: work.rooms.map(|r| r.map(|r| r.0 + 1)),
        gain,
        effort: Effort { demolished_m: whole_mm(work.demolished_m), built_m: whole_mm(work.built_m) },
        is_allowed: work.forbidden_by.is_empty(),
        shows_through_doors: work.shows_through_doors,
        forbidden_by,
    }
}

/// Mean number of steps from a cell to all that it reaches, over the cells of query; `None` without trees.
fn steps(lattice: &Lattice, graph: &Graph) -> Option<f64> {
    let tally = tally(lattice, graph, None);
    let (mut sum, mut count, mut at) = (0.0, 0usize, 0);
    for &depth in &tally.depth {
        let levels = &tally.levels[at..at + depth as usize];
        at += depth as usize;
        if !levels.is_empty() {
            sum += mean_depth(levels);
            count += 1;
        }
    }
    (count > 0 && sum > 0.0).then(|| sum / count as f64)
}

/// Gains in visibility with their intervals, by the place in the list: the best allowed and the best forbidden, each pair
/// of rooms once.
fn confirmed(study: &Study, settings: &Settings, works: &[&Work]) -> BTreeMap<usize, Interval> {
    let mut chosen: Vec<usize> = Vec::new();
    for is_allowed in [true, false] {
        let mut pairs = Vec::new();
        for (i, w) in works.iter().enumerate() {
            let mut pair = w.rooms;
            pair.sort_unstable();
            let is_small = !matches!(w.kind, WorkKind::Glaze | WorkKind::Remove);
            let is_new = !pairs.contains(&pair) && is_small;
            let most = if is_allowed { CONFIRMED } else { CONFIRMED / 2 };
            if w.forbidden_by.is_empty() == is_allowed && w.gained > 0 && is_new && pairs.len() < most {
                pairs.push(pair);
                chosen.push(i);
            }
        }
    }
    let changes: Vec<&Change> = chosen.iter().map(|i| &works[*i].change).collect();
    let [coarse, fine] = lattices::confirming(study, settings).each_ref().map(|all| {
        let gains = all.par_iter().map(|on| on_one(on, &changes));
        gains.collect::<Vec<Vec<f64>>>()
    });
    let of = |(k, i): (usize, usize)| {
        let values = |of: &[Vec<f64>]| Sampled::of(of.iter().map(|l| l[k]).collect());
        Some((i, interval(&values(&coarse)?, &values(&fine)?, REACH, AGAIN)))
    };
    chosen.into_iter().enumerate().filter_map(of).collect()
}

/// The gain in visibility of each change on one lattice.
fn on_one(on: &Study, changes: &[&Change]) -> Vec<f64> {
    let is_query = is_query(&on.lattice);
    on.with_present(|vista, graph| {
        let now = degrees(&on.lattice, graph).max(1) as f64;
        let gain = |c: &&Change| difference(vista, graph, c).gained(&on.lattice, &is_query) as f64 / now;
        changes.iter().map(gain).collect()
    })
}

/// Every wall in the colour of the best opening in it.
fn coloured(site: &Site<'_>, works: &[Work]) -> Vec<ColouredWall> {
    let all = site.present.degrees().max(1) as f64;
    let mut best: BTreeMap<usize, (bool, i64)> = BTreeMap::new();
    for work in works.iter().filter(|w| matches!(w.kind, WorkKind::Open)) {
        for w in &work.walls {
            let here = (work.forbidden_by.is_empty(), work.gained);
            let known = best.entry(w.0).or_insert(here);
            *known = (*known).max(here);
        }
    }
    let coloured = |(w, (is_allowed, gained)): (&usize, &(bool, i64))| {
        let wall = &site.walls[*w];
        ColouredWall {
            ends: [0.0, wall.length_m].map(|t| wall.point(t, 0.0).to_array()),
            thickness_m: wall.thickness_m,
            share: *gained as f64 / all,
            is_allowed: *is_allowed,
        }
    };
    best.iter().map(coloured).collect()
}
