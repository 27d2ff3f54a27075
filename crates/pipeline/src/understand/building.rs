//! What a building's file knows beyond outlines: spaces, openings, moves stated of its elements.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::read::query::{Asked, SPACE_LAYER};
use enfilade_cad::drawing::{Drawing, Entity, MarkedMove};
use enfilade_cad::ifc::CLOSING_LAYERS;
use enfilade_cad::own_layers::name_in;
use enfilade_cad::plane::{box_of, distance_to_segment, is_inside_ring};
use enfilade_config::{MoveTable, Settings};
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::allowed::is_of_works_alone;
use enfilade_plan::axes::Opening;
use enfilade_plan::curve::{self, Trace};
use enfilade_plan::far_off::FAR_M;
use enfilade_plan::{DOOR_LAYER, Plan, Wall};
use enfilade_report::{Error, Place};

/// Takes the spaces that `--query` names, by their own names or by those of their zones, as the region of query.
///
/// # Errors
/// [`Error::Usage`] where no space or zone has such a name, with those there are.
pub(crate) fn add_spaces(drawing: &Drawing, plan: &mut Plan, settings: &Settings) -> Result<(), Error> {
    let Some(query) = &settings.query else { return Ok(()) };
    let asked = Asked::new(query, &drawing.file)?;
    let hits = asked.hits(drawing);
    let rings = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER && hits.contains(&e.source.record));
    let regions: Vec<Region> = rings.filter_map(|e| ring(e, plan)).collect();
    if regions.is_empty() {
        let (what, names) = (asked.what, asked.names(drawing));
        let why = asked.several(&asked.found(drawing).rivals);
        let why = why.unwrap_or_else(|| format!("no such {what}, {what}s present: {names}"));
        let text = format!("--query {query:?}: {why}; nothing was done");
        return Err(Error::usage("query", Place::file(&drawing.file), text));
    }
    plan.markers.query = regions;
    Ok(())
}

fn ring(entity: &Entity, plan: &Plan) -> Option<Region> {
    let points: Vec<PointUm> = enfilade_cad::curve::control_points(&entity.shape)
        .into_iter()
        .map(|p| plan.frame.um_from_file(p))
        .collect();
    (points.len() > 2).then_some(Region::Ring(points))
}

/// What closes doors and windows: for finding out what lies inside a building, not for sight. What belongs to a wall far off
/// closes nothing.
pub(crate) fn closings(drawing: &Drawing, plan: &Plan) -> Vec<Segment> {
    let closes = |e: &&Entity| CLOSING_LAYERS.contains(&e.layer.as_str()) && !plan.is_gone(e);
    let plugs = drawing.entities.iter().filter(closes);
    let walls = plan.walls.iter().flat_map(|w| w.trace.points.iter().map(|p| plan.frame.plan_from_um(*p)));
    let extent = box_of(walls);
    let is_near = |s: &Segment| {
        let p = plan.frame.plan_from_um(s.a);
        extent.is_none_or(|[lo, hi]| p.distance(p.clamp(lo, hi)) <= FAR_M)
    };
    plugs
        .flat_map(|e| curve::trace(&e.shape, &plan.frame).segments().map(|s| s.2).collect::<Vec<_>>())
        .filter(is_near)
        .collect()
}

/// Whether a wall is what closes a door or window: the user named such a class as one of walls, so it stops sight.
pub(crate) fn closes(wall: &Wall) -> bool {
    CLOSING_LAYERS.contains(&wall.source.layer.as_str())
}

/// A door or window that the file calls so.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedOpening {
    /// [`SourceRef::record`] of the element.
    ///
    /// [`SourceRef::record`]: enfilade_cad::drawing::SourceRef::record
    pub record: usize,
    /// A door, else a window.
    pub is_door: bool,
    /// What it closes.
    pub outline: Trace,
}

/// The doors and windows that the file calls so, each with all its outlines.
pub(crate) fn named_openings(drawing: &Drawing, plan: &Plan) -> Vec<NamedOpening> {
    let of = |e: &Entity| {
        let is_door = e.layer == DOOR_LAYER;
        let outline = curve::trace(&e.shape, &plan.frame);
        (is_door || e.layer == "IfcWindow").then_some(NamedOpening {
            record: e.source.record,
            is_door,
            outline,
        })
    };
    drawing.entities.iter().filter(|e| !plan.is_gone(e)).filter_map(of).collect()
}

/// How far before a wall's face a door or window in a gap of it may stand.
const BEFORE_M: f64 = 0.06;

/// Whether a gap in a wall is that of a door or window which the file calls so: it is counted by that name.
pub(crate) fn is_named(gap: &Opening, named: &[NamedOpening], plan: &Plan) -> bool {
    let near = gap.thickness_m / 2.0 + BEFORE_M;
    named.iter().any(|o| {
        let points: Vec<DVec2> =
            o.outline.points.iter().map(|p| plan.frame.plan_from_um(*p) / plan.human_scale).collect();
        let sides = points.windows(2).any(|s| distance_to_segment(gap.centre, [s[0], s[1]]) <= near);
        sides || is_inside_ring(&points, gap.centre)
    })
}

/// How many different doors, or windows, there are among them.
pub(crate) fn count(openings: &[NamedOpening], are_doors: bool) -> u64 {
    let of_kind = openings.iter().filter(|o| o.is_door == are_doors);
    of_kind.map(|o| o.record).collect::<BTreeSet<usize>>().len() as u64
}

/// The marks of elements that say of moves; not those of works alone.
pub(crate) fn movers(drawing: &Drawing) -> impl Iterator<Item = &MarkedMove> {
    drawing.marked.iter().filter(|m| !is_of_works_alone(&m.text))
}

/// The moves that elements state of themselves: those that state one name and one move go together, every other by itself,
/// under a name of its own.
pub(crate) fn marked_moves(drawing: &Drawing) -> Vec<MoveTable> {
    let mut out: Vec<MoveTable> = Vec::new();
    let mut together: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    // A name that is stated by itself stands before one among the clauses.
    let own = |m: &MarkedMove| name_in(&m.text).filter(|_| !m.is_named);
    let names: Vec<(String, bool)> = movers(drawing)
        .map(|m| own(m).map_or_else(|| (m.name.clone(), m.is_named), |name| (name, true)))
        .collect();
    let given: BTreeSet<&str> = names.iter().map(|n| n.0.as_str()).collect();
    let mut taken: BTreeSet<String> = BTreeSet::new();
    for (marked, (own, is_named)) in movers(drawing).zip(&names) {
        let handle = marked.source.handle.clone().unwrap_or_default();
        let key = (own.as_str(), marked.text.as_str());
        if let Some(at) = together.get(&key).filter(|_| *is_named) {
            out[*at].handles.push(handle);
            continue;
        }
        if *is_named {
            together.insert(key, out.len());
        }
        let mut name = own.clone();
        if taken.contains(&name) {
            let mut others = (2..).map(|k| format!("{own} {k}"));
            name = others.find(|n| !given.contains(n.as_str()) && !taken.contains(n)).unwrap_or(name);
        }
        taken.insert(name.clone());
        out.push(MoveTable {
            name: Some(name).filter(|n| !n.is_empty()),
            moves: marked.text.clone(),
            nodes: Vec::new(),
            handles: vec![handle],
            layers: Vec::new(),
            marker: None,
        });
    }
    out
}
/// Outlines of all spaces with their records, drawing frame, micrometres.
pub(crate) fn space_rings(drawing: &Drawing, plan: &Plan) -> Vec<(usize, Vec<PointUm>)> {
    let spaces = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER);
    spaces.map(|e| (e.source.record, curve::trace(&e.shape, &plan.frame).points)).collect()
}

/// Outlines of the spaces that have a name, drawing frame, micrometres.
pub(crate) fn named_spaces(drawing: &Drawing, plan: &Plan) -> Vec<(Vec<PointUm>, String)> {
    let texts = drawing.texts.iter().filter(|t| t.layer == SPACE_LAYER);
    let names: BTreeMap<usize, String> =
        texts.filter_map(|t| Some((t.source.record, enfilade_plan::floor::name_in(&t.text)?))).collect();
    let spaces = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER);
    let named = spaces.filter_map(|e| Some((e, names.get(&e.source.record)?)));
    named.map(|(e, name)| (curve::trace(&e.shape, &plan.frame).points, name.clone())).collect()
}
