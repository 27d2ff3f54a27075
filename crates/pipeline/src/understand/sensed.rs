//! What a drawing is taken for, as a whole: its floor and rooms, its openings, and what a person should decide.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::understand::building;
use crate::understand::senses::{in_windows, of_entity};
use crate::understand::sureness::{SURE_WITHOUT_WALLS, Sureness, Ways};
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Entity, Format};
use enfilade_cad::own_layers;
use enfilade_cad::roles::Role;
use enfilade_config::Settings;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::axes::{Opening, OpeningKind};
use enfilade_plan::floor::{Beside, Floor, Gap};
use enfilade_plan::reading::RoleSense;
use enfilade_plan::reading::questions::{Doubt, Settled, questions};
use enfilade_plan::{DrawnBy, Plan, Wall};
use enfilade_report::{Place, Report, counted};

/// For every wall of a plan the index of the entity that draws it; filled areas come behind what is drawn.
pub(crate) fn entities_of_walls(plan: &Plan, drawing: &Drawing) -> Vec<usize> {
    let lines = drawing.entities.len();
    let foreign: Vec<usize> = (0..lines)
        .filter(|i| !own_layers::is_own(&drawing.entities[*i].layer))
        .chain(lines..lines + drawing.fills.len())
        .collect();
    let of = |w: &Wall| match w.drawn_by {
        DrawnBy::Mark(entity) => entity,
        DrawnBy::Picked(k) => plan.picked.get(k).and_then(|k| foreign.get(*k)).copied().unwrap_or(usize::MAX),
    };
    plan.walls.iter().map(of).collect()
}

/// An opening with what is known of it.
#[derive(Clone, Debug)]
pub(crate) struct OpenGap {
    /// What it is.
    pub kind: OpeningKind,
    /// Where it is.
    pub gap: Gap,
    /// Clear width, metres of the plan.
    pub width_m: f64,
    /// The edge of the axes that it lies in.
    pub edge: Option<u32>,
    /// Index of the opening among those of the axes.
    pub opening: Option<usize>,
    /// Record of the door or window, where the file calls it so.
    pub named: Option<usize>,
}

impl OpenGap {
    /// Its middle, drawing frame.
    pub fn middle(&self) -> PointUm {
        let [a, b] = self.gap.jambs;
        [i64::midpoint(a[0], b[0]), i64::midpoint(a[1], b[1])]
    }
}

/// What a drawing is taken for beyond its walls.
#[derive(Clone, Debug)]
pub(crate) struct Sensed {
    /// Doors, windows, passages.
    pub gaps: Vec<OpenGap>,
    /// The floor; `None` where the walls have no outline.
    pub floor: Option<Floor>,
    /// What looks like a wall and is a pane, by entity.
    pub panes: BTreeMap<usize, RoleSense>,
    /// How sure it is.
    pub sure: Sureness,
    /// The ways into its rooms, where they are in question.
    pub ways: Option<Ways>,
    /// What a person should decide, least certain first.
    pub doubts: Vec<Doubt>,
}

impl Sensed {
    /// Finds it.
    pub fn new(base: &Understood, settings: &Settings) -> Self {
        let plan = &base.plan;
        let gaps = gaps(base);
        let mut lines: Vec<Segment> = base.faces();
        lines.extend(&base.closings);
        let all: Vec<Gap> = gaps.iter().map(|g| g.gap).collect();
        let floor = base.interior.as_ref().map(|i| Floor::new(i, &lines, &all, plan.human_scale));
        let length = |w: usize| -> f64 {
            let pieces = plan.walls[w].trace.segments();
            pieces.map(|(_, _, s)| ((s.b[0] - s.a[0]) as f64).hypot((s.b[1] - s.a[1]) as f64)).sum()
        };
        let panes = in_windows(base);
        let sense = |i: &usize| panes.get(i).copied().unwrap_or_else(|| of_entity(plan, *i, true));
        let walls = base.entities.iter().enumerate().map(|(w, i)| (sense(i), length(w)));
        let walls: Vec<(RoleSense, f64)> = walls.collect();
        let settled = Settled {
            unit: settings.unit.is_some(),
            view: settings.view.is_some(),
            walls: !settings.wall_layers.is_empty()
                || !settings.reading.wall.is_empty()
                || !settings.reading.not_wall.is_empty()
                || settings.reading.as_drawn == Some(true),
            floor: !plan.markers.needs_interior()
                || !settings.seed_points.is_empty()
                || !settings.reading.inside.is_empty()
                || !settings.reading.outside.is_empty(),
        };
        let is_floor_said = settled.floor;
        let sure_of_walls = base.sure_of_walls.filter(|_| !settled.walls);
        let doubts = questions(plan, &base.axes, &walls, floor.as_ref(), settled);
        let is_walled = walls.iter().any(|(sense, of)| sense.role != Role::Column && *of > 0.0);
        let is_open = base.interior.as_ref().is_some_and(|i| i.gap_m() >= WAY_IN_M * plan.human_scale);
        let rooms = floor.as_ref().filter(|_| !is_floor_said);
        let ways = rooms.map(|f| ways(f, &gaps, (plan.human_scale, is_open)));
        let rooms = ways.and_then(|w| sure_of_rooms(&w, plan.format != Format::Dxf));
        let views = plan.views.iter().filter(|v| v.is_chosen).map(|v| v.confidence);
        let sure = Sureness {
            unit: plan.reading.unit.confidence,
            view: views.reduce(f64::min),
            walls: if is_walled { sure_of_walls } else { Some(SURE_WITHOUT_WALLS) },
            rooms,
            whole: base.sure_of_whole,
        };
        Self { gaps, floor, panes, sure, ways, doubts }
    }

    /// Says what speaks against the ways into the rooms, where nothing else is less sure.
    pub fn tell(&self, file: &str, report: &mut Report) {
        let is_least = self.sure.rooms.is_some_and(|sure| sure < TOLD_BELOW && sure <= self.sure.least());
        let Some(ways) = self.ways.filter(|_| is_least) else { return };
        let of = |n: usize, text: String| (n > 0).then_some(text);
        let said: Vec<String> = [
            of(
                ways.shut,
                format!("nobody can enter {} of {}", ways.shut, counted(ways.rooms as u64, "room")),
            ),
            of(ways.empty, format!("{} of {} have no door", ways.empty, counted(ways.all as u64, "opening"))),
            of(ways.odd, format!("{} are narrower than 0.6 m or wider than 2.2 m", ways.odd)),
        ]
        .into_iter()
        .flatten()
        .collect();
        let text = format!(
            "doors may be missing, or gaps taken for ways in by mistake: {}; look at the picture (--preview); --door, \
             --window, --wall and --not-wall correct it",
            said.join(", ")
        );
        report.info("ways-in-doubt", Place::file(file), text);
    }
}

/// How sure rooms without any door or passage are rooms. In 10 of 19 drawings and buildings of strangers in which nobody
/// enters any room, they are; the others are plots, gears, gardens, or have their doors missed.
const SURE_OF_SHUT: f64 = 0.53;

/// Somebody walks in through a gap of the outline that is at least so wide, metres of a person.
const WAY_IN_M: f64 = 0.6;

/// Widths of ways that nobody wonders at, metres of a person: from the narrowest leaf to a double door.
const USUAL_WAY_M: [f64; 2] = [0.6, 2.2];

/// The ways into the rooms. Where the outline of the building is open, its largest room is entered. `metres`: of the plan in
/// one of a person.
fn ways(floor: &Floor, gaps: &[OpenGap], (metres, is_open): (f64, bool)) -> Ways {
    let rooms = floor.rooms.len();
    let by_area = |a: &usize, b: &usize| floor.rooms[*a].area_m2.total_cmp(&floor.rooms[*b].area_m2);
    let largest = (0..rooms).max_by(by_area).filter(|_| is_open);
    let is_shut = |room: &usize| largest != Some(*room) && ways_into(floor, gaps, *room).next().is_none();
    let walked = || gaps.iter().filter(|g| g.kind != OpeningKind::Window);
    let is_usual = |g: &&OpenGap| (USUAL_WAY_M[0]..=USUAL_WAY_M[1]).contains(&(g.width_m / metres));
    let all = walked().count();
    let empty = walked().filter(|g| g.kind == OpeningKind::Passage).count();
    Ways {
        rooms,
        shut: (0..rooms).filter(is_shut).count(),
        all,
        empty: if empty < all { empty } else { 0 },
        odd: all - walked().filter(is_usual).count(),
    }
}

/// How sure the rooms are; nothing without rooms. `is_said`: the file calls its doors so.
fn sure_of_rooms(ways: &Ways, is_said: bool) -> Option<f64> {
    let shut = ways.shut as f64 / ways.rooms.max(1) as f64;
    let sure = if is_said || ways.all == 0 { 1.0 - (1.0 - SURE_OF_SHUT) * shut } else { ways.sure() };
    (ways.rooms > 0).then_some(sure)
}

/// Of drawings whose ways are less sure than this, a third is right (`BENCHMARKS.md`, "Ways into rooms").
const TOLD_BELOW: f64 = 0.65;

/// Doors and passages that lead into a room, by their places among the openings.
pub(crate) fn ways_into(floor: &Floor, gaps: &[OpenGap], room: usize) -> impl Iterator<Item = usize> {
    let all = gaps.iter().zip(&floor.beside).enumerate();
    let leads = move |(_, (gap, beside)): &(usize, (&OpenGap, &[Beside; 2]))| {
        gap.kind != OpeningKind::Window && beside.contains(&Beside::Room(room))
    };
    all.filter(leads).map(|(k, _)| k)
}

/// Doors and windows that the file calls so, in the gaps of walls where these show them; and the other gaps.
fn gaps(base: &Understood) -> Vec<OpenGap> {
    let (plan, axes) = (&base.plan, &base.axes);
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    let mut taken = std::collections::BTreeSet::new();
    let mut out: Vec<OpenGap> = Vec::new();
    for (k, opening) in axes.openings.iter().enumerate() {
        let named = base.openings.iter().find(|n| building::is_named(opening, std::slice::from_ref(n), plan));
        taken.extend(named.map(|n| n.record));
        let kind = match named {
            Some(n) if n.is_door => OpeningKind::Door,
            Some(_) => OpeningKind::Window,
            None if base.openings.is_empty() => opening.kind,
            None => OpeningKind::Passage,
        };
        let thickness_um = opening.thickness_m * plan.human_scale * 1e6;
        out.push(OpenGap {
            kind,
            gap: Gap { jambs: opening.jambs.map(|j| um(j.at)), thickness_um },
            width_m: opening.width_m * plan.human_scale,
            edge: edge_of(base, opening),
            opening: Some(k),
            named: named.map(|n| n.record),
        });
    }
    let mut outlines: BTreeMap<usize, (bool, Vec<DVec2>)> = BTreeMap::new();
    for n in base.openings.iter().filter(|n| !taken.contains(&n.record)) {
        let points = n.outline.points.iter().map(|p| plan.frame.plan_from_um(*p));
        outlines.entry(n.record).or_insert((n.is_door, Vec::new())).1.extend(points);
    }
    for (record, (is_door, points)) in outlines {
        let Some((jambs, across)) = along(&points) else { continue };
        let kind = if is_door { OpeningKind::Door } else { OpeningKind::Window };
        out.push(OpenGap {
            kind,
            gap: Gap { jambs: jambs.map(|p| plan.frame.um_from_plan(p)), thickness_um: across * 1e6 },
            width_m: jambs[0].distance(jambs[1]),
            edge: edge_of_host(base, record),
            opening: None,
            named: Some(record),
        });
    }
    out
}

/// The longer axis of the box along the longest side of an outline, and how far the box reaches across.
fn along(points: &[DVec2]) -> Option<([DVec2; 2], f64)> {
    let sides = points.windows(2).map(|w| w[1] - w[0]);
    let direction =
        sides.max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?.try_normalize()?;
    let turned = points.iter().map(|p| DVec2::new(direction.dot(*p), direction.perp_dot(*p)));
    let [lo, hi] = enfilade_cad::plane::box_of(turned)?;
    let back = |q: DVec2| direction * q.x + direction.perp() * q.y;
    let (middle, size) = (lo.midpoint(hi), hi - lo);
    let ends = match size.x >= size.y {
        true => [DVec2::new(lo.x, middle.y), DVec2::new(hi.x, middle.y)],
        false => [DVec2::new(middle.x, lo.y), DVec2::new(middle.x, hi.y)],
    };
    Some((ends.map(back), size.min_element()))
}

/// The wall in whose line an opening lies, or in whose side.
fn edge_of(base: &Understood, opening: &Opening) -> Option<u32> {
    let axes = &base.axes;
    let [from, to] = opening.jambs.map(|j| j.at);
    let along = (to - from).normalize_or_zero();
    let runs = |edge: u32| {
        let [a, b] = axes.ends(&axes.edges[edge as usize]);
        (b - a).normalize_or_zero().dot(along).abs()
    };
    let of_node = |node: u32| {
        let edges =
            (0..axes.edges.len() as u32).filter(move |e| axes.edges[*e as usize].nodes.contains(&node));
        edges.max_by(|a, b| runs(*a).total_cmp(&runs(*b)))
    };
    let ending = opening.jambs.iter().filter_map(|j| of_node(j.node?));
    ending.max_by(|a, b| runs(*a).total_cmp(&runs(*b))).or_else(|| opening.jambs.iter().find_map(|j| j.edge))
}

/// The wall that the file says a door or window sits in.
fn edge_of_host(base: &Understood, record: usize) -> Option<u32> {
    let host = base.fittings.iter().find(|f| f.source.record == record).and_then(|f| f.host)?;
    let shows = |e: &enfilade_plan::axes::Edge| e.left.iter().chain(&e.right).any(|f| f.0 == host);
    base.axes.edges.iter().position(shows).map(|e| e as u32)
}

/// Length of what an entity draws, drawing units.
pub(crate) fn length(e: &Entity) -> f64 {
    enfilade_plan::axes::paths_of(&e.shape, |p| p).iter().map(enfilade_plan::axes::Path::length_m).sum()
}
