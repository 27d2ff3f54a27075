//! Building works that are decided: what the user drew on `EF-OPEN`, `EF-REMOVE` and `EF-NEW`, or says beside the drawing.
//!
//! The plan is read as it will be: pieces of wall are gone, openings stand in walls, walls are built. What is gone stays
//! known, so that a picture can show it.

mod cut;

use glam::DVec2;
use std::collections::{BTreeMap, BTreeSet};

use super::axes::{Path, Role};
use super::curve::{self, Trace};
use super::frame::Frame;
use super::{Plan, Wall};
use crate::sizes::THICKNESS_THIN_M;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Editable, Entity, Shape, SourceRef, Vertex, place};
use enfilade_cad::own_layers::{self, NEW, OPEN, REMOVE};
use enfilade_cad::plane::{box_of, distance_to_segment, is_inside_ring};
use enfilade_engine::geometry::Segment;
use enfilade_report::{Place, Report, counted};

/// What stands in an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Fill {
    /// Nothing.
    #[default]
    Nothing,
    /// A leaf.
    Door,
    /// Glass: people see through it and cannot walk.
    Glass,
}

/// What a decided work does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DecidedKind {
    /// A stretch of wall is opened.
    Open(Fill),
    /// Pieces of wall go.
    Remove,
    /// A wall is built.
    New,
}

impl DecidedKind {
    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Open(Fill::Nothing) => "open",
            Self::Open(Fill::Door) => "door",
            Self::Open(Fill::Glass) => "glaze",
            Self::Remove => "remove",
            Self::New => "add",
        }
    }
}

/// A decided work with what it did to the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided {
    /// What it does.
    pub kind: DecidedKind,
    /// Where it is drawn.
    pub source: SourceRef,
    /// Index of its entity in the drawing.
    pub entity: usize,
    /// The ground on which walls went, drawing units; empty of what is built.
    pub ground: Vec<DVec2>,
    /// Middles of the two sides of an opening, drawing units.
    pub jambs: Option<[DVec2; 2]>,
    /// Pieces of wall that are gone.
    pub demolished: Vec<Trace>,
    /// What is built: walls, the leaf of a door, glass.
    pub built: Vec<Trace>,
}

/// How far beside a new wall the text may stand that says its thickness, metres of a person.
const TEXT_BESIDE_M: f64 = 1.0;

/// A mark as drawn.
struct Drawn<'a> {
    entity: usize,
    e: &'a Entity,
    layer: &'static str,
    text: String,
}

/// The marks of decided works, in the order of the file; not those of some records.
fn drawn<'a>(drawing: &'a Drawing, unused: &BTreeSet<usize>, unit_m: f64) -> Vec<Drawn<'a>> {
    let on = |layer: &str| {
        let bare = own_layers::bare(layer);
        [OPEN, REMOVE, NEW].into_iter().find(|l| l.eq_ignore_ascii_case(bare))
    };
    let entities = drawing.entities.iter().enumerate().filter(|(_, e)| !unused.contains(&e.source.record));
    let mut out: Vec<Drawn<'_>> = entities
        .filter_map(|(entity, e)| Some(Drawn { entity, e, layer: on(&e.layer)?, text: String::new() }))
        .collect();
    for text in &drawing.texts {
        let Some(layer) = on(&text.layer) else { continue };
        // A text belongs to the smallest box that it stands in, else to the nearest wall to be built.
        let distance = |d: &Drawn<'_>| {
            let points = control_points(&d.e.shape);
            let size = box_of(points.iter().copied()).map_or(0.0, |[lo, hi]| (hi - lo).length());
            match layer == NEW && !is_closed(&d.e.shape) {
                true => points
                    .windows(2)
                    .map(|w| distance_to_segment(text.at, [w[0], w[1]]))
                    .fold(f64::MAX, f64::min),
                false if is_inside_ring(&points, text.at) => -1.0 / (1.0 + size),
                false => f64::MAX,
            }
        };
        let near = out.iter().enumerate().filter(|(_, d)| d.layer == layer).map(|(i, d)| (distance(d), i));
        let near = near.filter(|(far, _)| far * unit_m <= TEXT_BESIDE_M);
        if let Some((_, i)) = near.min_by(|a, b| a.0.total_cmp(&b.0)) {
            out[i].text = text.text.clone();
        }
    }
    out
}

fn is_closed(shape: &Shape) -> bool {
    match shape {
        Shape::Circle { .. } => true,
        Shape::Polyline { vertices, closed } => {
            *closed || vertices.len() > 3 && vertices.first().map(|v| v.at) == vertices.last().map(|v| v.at)
        }
        _ => false,
    }
}

/// The outline of a closed mark, drawing units.
fn outline(shape: &Shape, frame: &Frame) -> Option<Vec<DVec2>> {
    let trace = curve::trace(shape, frame);
    let mut points: Vec<DVec2> = match shape {
        Shape::Polyline { vertices, .. } if vertices.iter().all(|v| v.bulge == 0.0) => {
            vertices.iter().map(|v| v.at).collect()
        }
        _ => trace.points.iter().map(|p| frame.file_from_um(*p)).collect(),
    };
    if points.len() > 3 && points.first() == points.last() {
        points.pop();
    }
    (is_closed(shape) && points.len() > 2).then_some(points)
}

/// What the text of an opening says.
struct Said {
    fill: Fill,
    width_m: Option<f64>,
}

/// Reads `door`, `door 0.9m`, `glass`, `0.9m`; lengths without a unit are in drawing units.
fn said(text: &str, unit_m: f64) -> Result<Said, String> {
    let mut out = Said { fill: Fill::Nothing, width_m: None };
    for word in text.split_whitespace() {
        match word.to_lowercase().trim_end_matches([',', ';']) {
            "door" => out.fill = Fill::Door,
            "glass" => out.fill = Fill::Glass,
            "open" | "opening" => {}
            other => out.width_m = Some(length_m(other, unit_m)?),
        }
    }
    Ok(out)
}

/// A length above 0 as a text of a mark says it, metres.
fn length_m(text: &str, unit_m: f64) -> Result<f64, String> {
    let (value, unit) = super::length::length(text)?;
    let metres = value * unit.map_or(unit_m, |u| u.metres);
    match metres > 0.0 {
        true => Ok(metres),
        false => Err(format!("found {text:?}, expected a length above 0")),
    }
}

/// Frame and size in which works are applied.
#[derive(Clone, Copy)]
pub(super) struct Scale<'a> {
    /// Drawing units and metres.
    pub frame: &'a Frame,
    /// Metres of the plan in a metre of a person.
    pub human_scale: f64,
}

impl Scale<'_> {
    /// Metres of a person in one drawing unit.
    fn unit_m(&self) -> f64 {
        self.frame.metres_per_unit / self.human_scale
    }
}

/// Takes what is opened or removed out of the walls. Marks that cannot be read, and those that meet no wall, are reported.
pub(super) fn demolish(
    walls: &mut Vec<Wall>,
    drawing: &Drawing,
    unused: &BTreeSet<usize>,
    scale: Scale<'_>,
    report: &mut Report,
) -> Vec<Decided> {
    let unit_m = scale.unit_m();
    let mut out = Vec::new();
    for mark in drawn(drawing, unused, unit_m).into_iter().filter(|m| m.layer != NEW) {
        let at = place(drawing, &mark.e.source);
        let Some(outline) = outline(&mark.e.shape, scale.frame) else {
            let text = "found an outline that is not closed, expected a closed polyline or a circle; ignored";
            report.warn("marker-open", at, text);
            continue;
        };
        let said = match (mark.layer == OPEN).then(|| said(&mark.text, unit_m)).transpose() {
            Ok(said) => said.unwrap_or(Said { fill: Fill::Nothing, width_m: None }),
            Err(why) => {
                let text = format!("{:?}: {why}; the stretch is opened as it is drawn", mark.text);
                report.warn("decided-text", at.clone(), text);
                Said { fill: Fill::Nothing, width_m: None }
            }
        };
        let stretch = (mark.layer == OPEN)
            .then(|| cut::stretch(walls, &outline, said.width_m.map(|w| w / unit_m), scale.frame))
            .flatten();
        let ground = stretch.as_ref().map_or_else(|| outline.clone(), |s| s.ground.clone());
        let gone = cut::cut(walls, &ground, mark.layer, scale);
        if gone.pieces.is_empty() {
            let why = if gone.is_inside { "reaches through no wall" } else { "meets no wall" };
            let text = format!(
                "found an outline on {} that {why}, expected one across a wall; nothing is changed for it",
                mark.layer
            );
            report.warn("decided-idle", at, text);
            continue;
        }
        let kind = if mark.layer == OPEN { DecidedKind::Open(said.fill) } else { DecidedKind::Remove };
        let jambs = stretch.map(|s| s.jambs);
        let across = jambs.filter(|_| said.fill != Fill::Nothing).map(|[a, b]| Shape::Line { a, b });
        out.push(Decided {
            kind,
            source: mark.e.source.clone(),
            entity: mark.entity,
            ground,
            jambs,
            demolished: gone.pieces,
            built: across.iter().map(|s| curve::trace(s, scale.frame)).collect(),
        });
    }
    out
}

/// Builds what is drawn on `EF-NEW` and adds it to the plan; says what is decided altogether.
pub(super) fn build(plan: &mut Plan, drawing: &Drawing, unused: &BTreeSet<usize>, report: &mut Report) {
    let (frame, human_scale) = (plan.frame, plan.human_scale);
    let scale = Scale { frame: &frame, human_scale };
    let unit_m = scale.unit_m();
    let marks = drawn(drawing, unused, unit_m);
    let mut usual_m = None;
    for mark in marks.into_iter().filter(|m| m.layer == NEW) {
        let mut thickness_m = None;
        for word in mark.text.split_whitespace() {
            match length_m(word, unit_m) {
                Ok(m) => thickness_m = Some(m),
                Err(why) => report.warn(
                    "decided-text",
                    place(drawing, &mark.e.source),
                    format!("{:?}: {why}; the wall is as thick as the partitions are", mark.text),
                ),
            }
        }
        let rings: Vec<Vec<DVec2>> = match outline(&mark.e.shape, scale.frame) {
            Some(ring) => vec![ring],
            None => {
                let thick_m = thickness_m
                    .unwrap_or_else(|| *usual_m.get_or_insert_with(|| usual_thickness_m(plan, drawing)));
                bars(&mark.e.shape, scale.frame, thick_m / unit_m)
            }
        };
        let shape = |ring: Vec<DVec2>| {
            let vertices = ring.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect();
            Shape::Polyline { vertices, closed: true }
        };
        let shapes: Vec<Shape> = rings.into_iter().map(shape).collect();
        let traces: Vec<Trace> = shapes.iter().map(|s| curve::trace(s, &frame)).collect();
        for (shape, trace) in shapes.into_iter().zip(&traces) {
            plan.walls.push(Wall {
                source: mark.e.source.clone(),
                editable: Editable::No("it is drawn on EF-NEW".into()),
                shape,
                trace: trace.clone(),
                is_solid: true,
                width_um: 0,
                single: None,
                drawn_by: super::DrawnBy::Mark(mark.entity),
            });
        }
        plan.decided.push(Decided {
            kind: DecidedKind::New,
            source: mark.e.source.clone(),
            entity: mark.entity,
            ground: Vec::new(),
            jambs: None,
            demolished: Vec::new(),
            built: traces,
        });
    }
    told(plan, drawing, unused);
    plan.decided.sort_by_key(|d| d.entity);
    state(plan, report);
}

/// What the file itself says of its elements: those that are to go, already no walls, and those that are to be built.
fn told(plan: &mut Plan, drawing: &Drawing, unused: &BTreeSet<usize>) {
    let mut by_record: BTreeMap<usize, Decided> = BTreeMap::new();
    let new = |kind: DecidedKind, source: &SourceRef, entity: usize| Decided {
        kind,
        source: source.clone(),
        entity,
        ground: Vec::new(),
        jambs: None,
        demolished: Vec::new(),
        built: Vec::new(),
    };
    let gone = drawing.entities.iter().enumerate().filter(|(_, e)| own_layers::is_demolished(&e.layer));
    for (i, e) in gone.filter(|(_, e)| !unused.contains(&e.source.record)) {
        let work = by_record.entry(e.source.record).or_insert_with(|| new(DecidedKind::Remove, &e.source, i));
        work.demolished.push(curve::trace(&e.shape, &plan.frame));
    }
    for wall in plan.walls.iter().filter(|w| drawing.built.contains(&w.source.record)) {
        let entity = drawing.entities.iter().position(|e| e.source == wall.source).unwrap_or(usize::MAX);
        let work = by_record
            .entry(wall.source.record)
            .or_insert_with(|| new(DecidedKind::New, &wall.source, entity));
        work.built.push(wall.trace.clone());
    }
    plan.decided.extend(by_record.into_values());
}

/// A bar of a thickness along every piece of a line, drawing units.
fn bars(shape: &Shape, frame: &Frame, thickness: f64) -> Vec<Vec<DVec2>> {
    let trace = curve::trace(shape, frame);
    let bar = |(_, _, s): (usize, usize, Segment)| {
        let [a, b] = [s.a, s.b].map(|p| frame.file_from_um(p));
        let half = (b - a).try_normalize()?.perp() * (thickness / 2.0);
        Some(vec![a + half, a - half, b - half, b + half])
    };
    trace.segments().filter_map(bar).collect()
}

/// The thickness that half of the plan's thinner walls have at most, by length, metres of a person.
fn usual_thickness_m(plan: &Plan, drawing: &Drawing) -> f64 {
    let (axes, _) = super::structure::axes(plan, drawing);
    let thick = axes.edges.iter().filter(|e| e.thickness_m > 0.0);
    let mut known: Vec<(f64, f64)> = thick
        .map(|e| {
            let [a, b] = axes.ends(e);
            (e.thickness_m, a.distance(b))
        })
        .collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = known.iter().map(|k| k.1).sum();
    let mut before = 0.0;
    // The thinner half of all walls are the partitions, and the middle of these is usual.
    let usual = known.iter().find(|(_, length)| {
        before += length;
        before >= all / 4.0
    });
    usual.map_or(THICKNESS_THIN_M, |k| k.0)
}

/// Says what is decided.
fn state(plan: &Plan, report: &mut Report) {
    if plan.decided.is_empty() {
        return;
    }
    let count = |name: &str| match name {
        "remove" => removals(plan),
        _ => plan.decided.iter().filter(|d| d.kind.name() == name).count() as u64,
    };
    let named = [
        ("open", "opening"),
        ("door", "door"),
        ("glaze", "stretch of glass"),
        ("remove", "removal"),
        ("add", "new wall"),
    ];
    let words: Vec<String> = named
        .iter()
        .map(|(name, word)| (count(name), word))
        .filter(|c| c.0 > 0)
        .map(|(n, word)| counted(n, word))
        .collect();
    let text = format!("{} decided: the plan is read as it will be", words.join(", "));
    report.info("decided-works", Place::file(&plan.file), text);
}

/// Pieces that are demolished this near to each other are one removal, metres of a person: both faces of a wall, its ends,
/// its doors.
const TOGETHER_M: f64 = 0.3;

/// How many removals there are: each mark of the user is one, and so are pieces that lie together.
fn removals(plan: &Plan) -> u64 {
    let all = plan.decided.iter().filter(|d| d.kind == DecidedKind::Remove);
    let (marked, told): (Vec<&Decided>, Vec<&Decided>) = all.partition(|d| !d.ground.is_empty());
    let reach = DVec2::splat(TOGETHER_M * plan.human_scale);
    let points = |d: &Decided| -> Vec<DVec2> {
        d.demolished.iter().flat_map(|t| &t.points).map(|p| plan.frame.plan_from_um(*p)).collect()
    };
    let mut groups: Vec<Vec<[DVec2; 2]>> = Vec::new();
    for [lo, hi] in told.iter().filter_map(|d| box_of(points(d).into_iter())) {
        let is_near = |[a, b]: &[DVec2; 2]| (lo - reach).cmple(*b).all() && (hi + reach).cmpge(*a).all();
        let (near, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| g.iter().any(is_near));
        groups = apart;
        groups.push(near.into_iter().flatten().chain([[lo, hi]]).collect());
    }
    (marked.len() + groups.len()) as u64
}

/// Whether an entity goes with the walls that works take away: what fills an opening and hangs or ends there.
pub(super) fn is_gone(works: &[Decided], e: &Entity) -> bool {
    let grounds = || works.iter().map(|d| &d.ground).filter(|g| !g.is_empty());
    let lies_in = |p: DVec2| grounds().any(|g| is_inside_ring(g, p));
    match &e.shape {
        Shape::Arc { centre, .. } | Shape::Circle { centre, .. } => lies_in(*centre),
        shape => grounds().next().is_some() && control_points(shape).into_iter().any(lies_in),
    }
}

impl Plan {
    /// Whether an entity goes with the walls that decided works take away: what fills an opening and hangs or ends there.
    pub fn is_gone(&self, e: &Entity) -> bool {
        is_gone(&self.decided, e)
    }

    /// What decided works put into their openings, as marks of the axis graph see it: line in metres of a person, role,
    /// index of the entity that says so.
    pub(super) fn decided_fills(&self) -> impl Iterator<Item = (Path, Role, usize)> {
        let place = |p: DVec2| self.frame.plan_from_file(p) / self.human_scale;
        self.decided.iter().filter_map(move |d| {
            let role = match d.kind {
                DecidedKind::Open(Fill::Door) => Role::Door,
                DecidedKind::Open(Fill::Glass) => Role::Window,
                _ => return None,
            };
            let [a, b] = d.jambs?.map(place);
            Some((Path::Line { a, b }, role, d.entity))
        })
    }
}

#[cfg(test)]
mod tests;
