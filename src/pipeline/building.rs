//! What a building's file knows beyond outlines: spaces, openings, moves stated of its elements.

use std::collections::BTreeSet;

use globset::GlobBuilder;

use crate::config::{MoveTable, Settings};
use crate::formats::ifc::{CLOSING_LAYERS, ZONE_LAYER};
use crate::plan::curve::Trace;
use crate::plan::drawing::{Drawing, Entity};
use crate::plan::geometry::{PointUm, Segment};
use crate::plan::{DOOR_LAYER, Plan, Region, Wall, curve};
use crate::report::{Error, Place};

/// Layer of spaces.
const SPACE_LAYER: &str = "IfcSpace";

/// What `--query` may name: the word before the name, what is meant, and the layer of the names.
const NAMED: [(&str, &str, &str); 2] = [("space:", "space", SPACE_LAYER), ("zone:", "zone", ZONE_LAYER)];

/// Takes the spaces that `--query` names, by their own names or by those of their zones, as the region of query.
///
/// # Errors
/// [`Error::Usage`] where no space or zone has such a name, with those there are.
pub(super) fn add_spaces(drawing: &Drawing, plan: &mut Plan, settings: &Settings) -> Result<(), Error> {
    let Some(query) = &settings.query else { return Ok(()) };
    let usage = |text: String| Error::usage("query", Place::file(&drawing.file), text);
    let asked = NAMED.iter().find_map(|(word, what, layer)| Some((query.strip_prefix(word)?, what, layer)));
    let Some((pattern, what, layer)) = asked else {
        return Err(usage(format!(
            "--query {query:?}: expected space:NAME or zone:NAME, * and ? may stand in NAME; nothing was done"
        )));
    };
    let glob = GlobBuilder::new(pattern).case_insensitive(true).build();
    let glob =
        glob.map_err(|e| usage(format!("--query {query:?}: {e}; nothing was done")))?.compile_matcher();
    let named = drawing.texts.iter().filter(|t| t.layer == *layer);
    let hits: Vec<usize> =
        named.clone().filter(|t| t.text.lines().any(|l| glob.is_match(l))).map(|t| t.source.record).collect();
    let rings = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER && hits.contains(&e.source.record));
    let regions: Vec<Region> = rings.filter_map(|e| ring(e, plan)).collect();
    if regions.is_empty() {
        let mut names: Vec<String> = named.map(|t| t.text.replace('\n', " / ")).collect();
        let mut seen = BTreeSet::new();
        names.retain(|n| seen.insert(n.clone()));
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        return Err(usage(format!(
            "--query {query:?}: no such {what}, {what}s present: {names}; nothing was done"
        )));
    }
    plan.markers.query = regions;
    Ok(())
}

fn ring(entity: &Entity, plan: &Plan) -> Option<Region> {
    let points: Vec<PointUm> =
        curve::control_points(&entity.shape).into_iter().map(|p| plan.frame.um_from_file(p)).collect();
    (points.len() > 2).then_some(Region::Ring(points))
}

/// What closes doors and windows: for finding out what lies inside a building, not for sight.
pub(super) fn closings(drawing: &Drawing, plan: &Plan) -> Vec<Segment> {
    let plugs = drawing.entities.iter().filter(|e| CLOSING_LAYERS.contains(&e.layer.as_str()));
    plugs
        .flat_map(|e| curve::trace(&e.shape, &plan.frame).segments().map(|s| s.2).collect::<Vec<_>>())
        .collect()
}

/// Whether a wall is what closes a door or window: the user named such a class as one of walls, so it stops sight.
pub(super) fn closes(wall: &Wall) -> bool {
    CLOSING_LAYERS.contains(&wall.source.layer.as_str())
}

/// A door or window that the file calls so.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedOpening {
    /// [`SourceRef::record`] of the element.
    ///
    /// [`SourceRef::record`]: crate::plan::drawing::SourceRef::record
    pub record: usize,
    /// A door, else a window.
    pub is_door: bool,
    /// What it closes.
    pub outline: Trace,
}

/// The doors and windows that the file calls so, each with all its outlines.
pub(super) fn named_openings(drawing: &Drawing, plan: &Plan) -> Vec<NamedOpening> {
    let of = |e: &Entity| {
        let is_door = e.layer == DOOR_LAYER;
        let outline = curve::trace(&e.shape, &plan.frame);
        (is_door || e.layer == "IfcWindow").then_some(NamedOpening {
            record: e.source.record,
            is_door,
            outline,
        })
    };
    drawing.entities.iter().filter_map(of).collect()
}

/// How many different doors, or windows, there are among them.
pub(super) fn count(openings: &[NamedOpening], are_doors: bool) -> u64 {
    let of_kind = openings.iter().filter(|o| o.is_door == are_doors);
    of_kind.map(|o| o.record).collect::<BTreeSet<usize>>().len() as u64
}

/// The moves that elements state of themselves, those of one name together.
pub(super) fn marked_moves(drawing: &Drawing) -> Vec<MoveTable> {
    let mut out: Vec<MoveTable> = Vec::new();
    for marked in &drawing.marked {
        let handle = marked.source.handle.clone().unwrap_or_default();
        let same = |t: &&mut MoveTable| {
            t.name.as_deref() == Some(&marked.name) && !marked.name.is_empty() && t.moves == marked.text
        };
        match out.iter_mut().find(same) {
            Some(table) => table.handles.push(handle),
            None => out.push(MoveTable {
                name: Some(marked.name.clone()).filter(|n| !n.is_empty()),
                moves: marked.text.clone(),
                nodes: Vec::new(),
                handles: vec![handle],
                layers: Vec::new(),
            }),
        }
    }
    out
}
