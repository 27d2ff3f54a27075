//! `reading` of `enfilade.check/2`.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::measure::spacing;
use crate::understand::rooms::{self, Room};
use crate::understand::sensed::{OpenGap, Sensed, length, ways_into};
use crate::understand::senses::of_entity;
use crate::understand::sureness::Sureness;
use crate::understand::understood::Understood;
use crate::write::asked;
use crate::write::places::{Places, round_mm, share};
use crate::write::show::element_of;
use enfilade_cad::curve::bulge_arc;
use enfilade_cad::drawing::{Drawing, Entity, Format};
use enfilade_cad::own_layers;
use enfilade_cad::roles::Role;
use enfilade_engine::Region;
use enfilade_overlay::reading::{
    AreaReading, EntityReading, Headline, OpeningReading, Reading, RoomReading, SureReading, UnitReading,
    UnitRival, ViewReading, WallReading,
};
use enfilade_overlay::result::ElementRef;
use enfilade_plan::Plan;
use enfilade_plan::axes::{Edge, OpeningKind};
use enfilade_plan::by_place::Entities;
use enfilade_plan::floor::Area;
use enfilade_plan::reading::RoleSense;
use enfilade_plan::view_names::Title;

/// Chords of a curved wall's axis turn by at most this, radians.
const CHORD_RAD: f64 = 0.2;

/// What a drawing is taken for.
pub(crate) fn reading(base: &Understood, drawing: &Drawing, (sensed, rooms): (&Sensed, &[Room])) -> Reading {
    let plan = &base.plan;
    let at = Places::new(plan);
    let sense = &plan.reading.unit;
    Reading {
        confidence: share(sensed.sure.least()),
        sure: sure(&sensed.sure),
        unit: UnitReading {
            metres: plan.unit.unit.metres,
            name: plan.unit.unit.name.into(),
            confidence: share(sense.confidence),
            reasons: sense.reasons.iter().map(|r| (*r).to_owned()).collect(),
            runner_up: sense.runner_up.map(|rival| UnitRival {
                metres: rival.unit.metres,
                name: rival.unit.name.into(),
                confidence: share(rival.probability),
            }),
        },
        views: views(plan, drawing, &at),
        entities: entities(plan, drawing, &sensed.panes),
        walls: base.axes.edges.iter().map(|e| wall(base, drawing, e, &at)).collect(),
        openings: sensed.gaps.iter().map(|g| opening(base, drawing, g, &at)).collect(),
        rooms: room_readings(sensed, rooms, &at),
        interior: interior(plan, sensed, &at),
        coverage: coverage(plan, sensed),
        questions: sensed.doubts.iter().map(|d| asked::entry(d, plan)).collect(),
        room_questions: rooms::questions(rooms).iter().map(|d| asked::entry(d, plan)).collect(),
    }
}

fn sure(of: &Sureness) -> SureReading {
    let [view, walls, rooms, whole] = [of.view, of.walls, of.rooms, of.whole].map(|v| v.map(share));
    SureReading { unit: share(of.unit), view, walls, rooms, whole }
}

/// The first line of `check`.
pub(crate) fn headline<'a>(base: &'a Understood, sensed: &Sensed) -> Headline<'a> {
    let plans = base.plan.views.iter().filter(|v| v.is_chosen).count();
    let doors = sensed.gaps.iter().filter(|g| g.kind == OpeningKind::Door).count();
    Headline {
        confidence: sensed.sure.least(),
        unit: base.plan.unit.unit.name,
        counts: [plans, base.axes.edges.len(), doors],
        coverage: coverage(&base.plan, sensed).filter(|_| base.plan.markers.query.is_empty()),
    }
}

fn views(plan: &Plan, drawing: &Drawing, at: &Places<'_>) -> Vec<ViewReading> {
    let drawn = Entities::new(drawing.entities.iter().filter(|e| !own_layers::is_own(&e.layer)));
    let of = |v: &enfilade_plan::views::View| {
        let [lo, hi] = drawn.tight(&v.extent).map(|p| at.file(p));
        ViewReading {
            name: v.name.clone(),
            kind: kind_of(v.kind).into(),
            extent: [lo[0], lo[1], hi[0], hi[1]],
            chosen: v.is_chosen,
            confidence: share(v.confidence),
        }
    };
    plan.views.iter().map(of).collect()
}

/// The kind of a drawing as the schema names it.
fn kind_of(title: Title) -> &'static str {
    match title {
        Title::GroundFloor | Title::Plan | Title::Unknown => "plan",
        Title::Services => "other",
        Title::Outside => "site",
        Title::Beside => "legend",
        Title::NoPlan => "section",
    }
}

/// The record that draws an entity, as results name it.
pub(crate) fn element(format: Format, e: &Entity) -> ElementRef {
    match format {
        Format::Dxf => element_of(format, e.origin.handle.clone(), e.origin.record),
        _ => element_of(format, e.source.handle.clone(), e.source.record),
    }
}

/// What of a record is taken for what: by role the length and the length times the confidence.
#[derive(Default)]
pub(crate) struct Tally {
    of_role: BTreeMap<&'static str, [f64; 2]>,
}

/// Lengths below this count as much, drawing units: what draws a point says something too.
const LENGTH_MIN: f64 = 1e-9;

impl Tally {
    fn add(&mut self, sense: RoleSense, length: f64) {
        let [sum, sure] = self.of_role.entry(sense.role.code()).or_default();
        let length = length.max(LENGTH_MIN);
        (*sum, *sure) = (*sum + length, *sure + length * f64::from(sense.confidence));
    }

    /// The role of most of it, and how sure that is.
    fn most(&self) -> Option<(&'static str, f64)> {
        let (role, [_, sure]) = self.of_role.iter().max_by(|a, b| a.1[0].total_cmp(&b.1[0]))?;
        let all: f64 = self.of_role.values().map(|v| v[0]).sum();
        Some((role, sure / all))
    }
}

fn entities(plan: &Plan, drawing: &Drawing, panes: &BTreeMap<usize, RoleSense>) -> Vec<EntityReading> {
    let is_dxf = drawing.format == Format::Dxf;
    let mut tallies: BTreeMap<usize, (Tally, Option<&Entity>)> = BTreeMap::new();
    let mut ordinal = 0;
    for (i, e) in drawing.entities.iter().enumerate() {
        let is_own = own_layers::is_own(&e.layer);
        let is_picked = !is_own && plan.picked.binary_search(&ordinal).is_ok();
        ordinal += usize::from(!is_own);
        let sense = panes.get(&i).copied().unwrap_or_else(|| of_entity(plan, i, is_picked));
        let length = length(e);
        let record = if is_dxf { e.origin.record } else { e.source.record };
        let of_record = tallies.entry(record).or_default();
        of_record.0.add(sense, length);
        of_record.1 = Some(e);
        e.origin.inserts.iter().for_each(|r| tallies.entry(*r).or_default().0.add(sense, length));
    }
    for (k, fill) in drawing.fills.iter().enumerate() {
        let sense = match plan.picked.binary_search(&(ordinal + k)) {
            Ok(_) => RoleSense { role: Role::Column, confidence: 0.9 },
            Err(_) => RoleSense { role: Role::Hatch, confidence: 0.9 },
        };
        let (tally, shows) = tallies.entry(fill.origin.record).or_default();
        tally.add(sense, length(fill));
        shows.get_or_insert(fill);
    }
    if !is_dxf {
        let of =
            |(tally, e): &(Tally, Option<&Entity>)| read_as(element(drawing.format, (*e)?), tally.most()?);
        return tallies.values().filter_map(of).collect();
    }
    let mut out: Vec<EntityReading> = Vec::with_capacity(drawing.records.len());
    for r in &drawing.records {
        let most = tallies.get(&r.record).and_then(|t| t.0.most()).unwrap_or_else(|| by_kind(&r.kind));
        out.extend(read_as(element_of(Format::Dxf, r.handle.clone(), r.record), most));
    }
    out
}

fn read_as(element: ElementRef, (role, confidence): (&str, f64)) -> Option<EntityReading> {
    Some(EntityReading { element, role: role.into(), confidence: share(confidence) })
}

/// What a record is that draws no line of a plan.
fn by_kind(kind: &str) -> (&'static str, f64) {
    match kind {
        "TEXT" | "MTEXT" | "LEADER" | "MLEADER" | "MULTILEADER" | "TOLERANCE" => ("annotation", 1.0),
        "HATCH" | "MPOLYGON" => ("hatch", 1.0),
        _ if kind.ends_with("DIMENSION") => ("dimension", 1.0),
        _ => ("other", 0.5),
    }
}

fn wall(base: &Understood, drawing: &Drawing, edge: &Edge, at: &Places<'_>) -> WallReading {
    let faces = edge.left.iter().chain(&edge.right).chain(&edge.inner);
    let mut walls: Vec<u32> = faces.map(|f| f.0).collect();
    walls.sort_unstable();
    walls.dedup();
    WallReading {
        axis: axis(base, edge).into_iter().map(|p| at.person(p)).collect(),
        thickness_m: round_mm(edge.thickness_m * base.plan.human_scale),
        elements: walls.into_iter().filter_map(|w| wall_element(base, drawing, w)).collect(),
    }
}

/// The record that draws a wall.
fn wall_element(base: &Understood, drawing: &Drawing, wall: u32) -> Option<ElementRef> {
    let entity = base.entities.get(wall as usize)?;
    let lines = drawing.entities.len();
    let e = drawing.entities.get(*entity).or_else(|| drawing.fills.get(entity.checked_sub(lines)?))?;
    Some(element(drawing.format, e))
}

/// The axis of a wall, metres of a person; a curved one as chords.
pub(crate) fn axis(base: &Understood, edge: &Edge) -> Vec<DVec2> {
    let [a, b] = base.axes.ends(edge);
    let Some((centre, radius, start, sweep)) = bulge_arc(a, b, edge.bulge) else { return vec![a, b] };
    let chords = (sweep.abs() / CHORD_RAD).ceil().max(1.0) as usize;
    let on = |k: usize| centre + DVec2::from_angle(start + sweep * k as f64 / chords as f64) * radius;
    std::iter::once(a).chain((1..chords).map(on)).chain([b]).collect()
}

/// The kind of an opening as the schema names it.
pub(crate) fn opening_kind(kind: OpeningKind) -> &'static str {
    match kind {
        OpeningKind::Door => "door",
        OpeningKind::Window => "window",
        OpeningKind::Passage => "passage",
    }
}

fn opening(base: &Understood, drawing: &Drawing, g: &OpenGap, at: &Places<'_>) -> OpeningReading {
    let marks = g.opening.map_or(&[][..], |k| &base.axes.openings[k].marks);
    let drawn = marks.iter().filter_map(|m| drawing.entities.get(*base.marked.get(*m as usize)?));
    let named = g.named.and_then(|r| drawing.entities.iter().find(|e| e.source.record == r));
    let mut elements: Vec<ElementRef> = Vec::new();
    for e in drawn.chain(named) {
        let element = element(drawing.format, e);
        if !elements.contains(&element) {
            elements.push(element);
        }
    }
    OpeningReading {
        kind: opening_kind(g.kind).into(),
        at: at.um(g.middle()),
        width_m: round_mm(g.width_m),
        wall: g.edge.map(|e| e as usize),
        elements,
    }
}

fn room_readings(sensed: &Sensed, rooms: &[Room], at: &Places<'_>) -> Vec<RoomReading> {
    let Some(floor) = &sensed.floor else { return Vec::new() };
    let of = |(k, room): (usize, &Room)| RoomReading {
        name: room.name.clone().unwrap_or_default(),
        area_m2: (room.area.area_m2 * 100.0).round() / 100.0,
        outline: at.ring(&room.area.outline),
        doors: ways_into(floor, &sensed.gaps, k).collect(),
        kind: room.found.kind.name().into(),
        is_private: room.found.is_private(),
        is_sure: room.found.is_sure,
        dwelling: room.found.dwelling,
    };
    rooms.iter().enumerate().map(of).collect()
}

fn interior(plan: &Plan, sensed: &Sensed, at: &Places<'_>) -> Vec<AreaReading> {
    if !plan.markers.query.is_empty() {
        let of = |r: &Region| AreaReading { outline: at.ring(&r.outline()), holes: Vec::new() };
        return plan.markers.query.iter().map(of).collect();
    }
    let rooms = sensed.floor.iter().flat_map(|f| &f.rooms);
    let of = |a: &Area| AreaReading {
        outline: at.ring(&a.outline),
        holes: a.holes.iter().map(|h| at.ring(h)).collect(),
    };
    rooms.map(of).collect()
}

fn coverage(plan: &Plan, sensed: &Sensed) -> Option<f64> {
    let floor = sensed.floor.as_ref().filter(|f| !f.rooms.is_empty() || !f.left_out.is_empty())?;
    if plan.markers.query.is_empty() {
        return Some(share(floor.coverage));
    }
    let all: f64 =
        floor.rooms.iter().map(|r| r.area_m2).chain(floor.left_out.iter().map(|l| l.area_m2)).sum();
    let drawn: f64 = plan.markers.query.iter().map(spacing::region_m2).sum();
    (all > 0.0).then(|| share((drawn / all).min(1.0)))
}
