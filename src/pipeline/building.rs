//! What a building's file knows beyond outlines: spaces, openings, moves stated of its elements.

use globset::GlobBuilder;

use crate::config::{MoveTable, Settings};
use crate::formats::ifc::CLOSING_LAYERS;
use crate::plan::drawing::{Drawing, Entity};
use crate::plan::geometry::{PointUm, Segment};
use crate::plan::{Plan, Region, curve};
use crate::report::{Error, Place};

/// Layer of spaces.
const SPACE_LAYER: &str = "IfcSpace";

/// Takes the spaces that `--query` names as the region of query.
///
/// # Errors
/// [`Error::Usage`] where no space has such a name, with those there are.
pub(super) fn add_spaces(drawing: &Drawing, plan: &mut Plan, settings: &Settings) -> Result<(), Error> {
    let Some(query) = &settings.query else { return Ok(()) };
    let usage = |text: String| Error::usage("query", Place::file(&drawing.file), text);
    let Some(pattern) = query.strip_prefix("space:") else {
        return Err(usage(format!(
            "--query {query:?}: expected space:NAME, * and ? may stand in NAME; nothing was done"
        )));
    };
    let glob = GlobBuilder::new(pattern).case_insensitive(true).build();
    let glob =
        glob.map_err(|e| usage(format!("--query {query:?}: {e}; nothing was done")))?.compile_matcher();
    let named = drawing.texts.iter().filter(|t| t.layer == SPACE_LAYER);
    let hits: Vec<usize> =
        named.clone().filter(|t| t.text.lines().any(|l| glob.is_match(l))).map(|t| t.source.record).collect();
    let rings = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER && hits.contains(&e.source.record));
    let regions: Vec<Region> = rings.filter_map(|e| ring(e, plan)).collect();
    if regions.is_empty() {
        let names: Vec<String> = named.map(|t| t.text.replace('\n', " / ")).collect();
        let names = if names.is_empty() { "none".into() } else { names.join(", ") };
        return Err(usage(format!(
            "--query {query:?}: no such space, spaces present: {names}; nothing was done"
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

/// How many doors and windows there are.
pub(super) fn openings(drawing: &Drawing) -> u64 {
    let mut records: Vec<usize> = drawing
        .entities
        .iter()
        .filter(|e| ["IfcDoor", "IfcWindow"].contains(&e.layer.as_str()))
        .map(|e| e.source.record)
        .collect();
    records.sort_unstable();
    records.dedup();
    records.len() as u64
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
