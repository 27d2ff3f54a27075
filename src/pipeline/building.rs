//! What a building's file knows beyond outlines: spaces, openings, moves stated of its elements.

use std::borrow::Cow;
use std::collections::BTreeSet;

use globset::{GlobBuilder, GlobMatcher};

use super::{Input, study};
use crate::config::{MoveTable, Settings};
use crate::formats::ifc::{CLOSING_LAYERS, ZONE_LAYER};
use crate::formats::{self, Opened, StoreyInfo};
use crate::plan::curve::Trace;
use crate::plan::drawing::{Drawing, Entity};
use crate::plan::geometry::{PointUm, Segment};
use crate::plan::{DOOR_LAYER, Plan, Region, Wall, curve};
use crate::report::{Error, Place, Report};

/// Layer of spaces.
const SPACE_LAYER: &str = "IfcSpace";

/// What `--query` may name: the word before the name, what is meant, and the layer of the names.
const NAMED: [(&str, &str, &str); 2] = [("space:", "space", SPACE_LAYER), ("zone:", "zone", ZONE_LAYER)];

/// What `--query` asks for.
struct Asked {
    /// Names that are meant.
    glob: GlobMatcher,
    /// A space or a zone, in words.
    what: &'static str,
    /// The layer of their names.
    layer: &'static str,
}

impl Asked {
    fn new(query: &str, file: &str) -> Result<Self, Error> {
        let usage = |text: String| Error::usage("query", Place::file(file), text);
        let asked =
            NAMED.iter().find_map(|(word, what, layer)| Some((query.strip_prefix(word)?, what, layer)));
        let Some((pattern, what, layer)) = asked else {
            return Err(usage(format!(
                "--query {query:?}: expected space:NAME or zone:NAME, * and ? may stand in NAME; nothing was done"
            )));
        };
        let glob = GlobBuilder::new(pattern).case_insensitive(true).build();
        let glob = glob.map_err(|e| usage(format!("--query {query:?}: {e}; nothing was done")))?;
        Ok(Self { glob: glob.compile_matcher(), what, layer })
    }

    /// Records of the spaces that are meant.
    fn hits(&self, drawing: &Drawing) -> Vec<usize> {
        let named = drawing.texts.iter().filter(|t| t.layer == self.layer);
        let meant = named.filter(|t| t.text.lines().any(|l| self.glob.is_match(l)));
        meant.map(|t| t.source.record).collect()
    }

    /// Names that there are, each once.
    fn names(&self, drawing: &Drawing) -> String {
        let named = drawing.texts.iter().filter(|t| t.layer == self.layer);
        let mut names: Vec<String> = named.map(|t| t.text.replace('\n', " / ")).collect();
        let mut seen = BTreeSet::new();
        names.retain(|n| seen.insert(n.clone()));
        if names.is_empty() { "none".into() } else { names.join(", ") }
    }
}

/// Takes the spaces that `--query` names, by their own names or by those of their zones, as the region of query.
///
/// # Errors
/// [`Error::Usage`] where no space or zone has such a name, with those there are.
pub(super) fn add_spaces(drawing: &Drawing, plan: &mut Plan, settings: &Settings) -> Result<(), Error> {
    let Some(query) = &settings.query else { return Ok(()) };
    let asked = Asked::new(query, &drawing.file)?;
    let hits = asked.hits(drawing);
    let rings = drawing.entities.iter().filter(|e| e.layer == SPACE_LAYER && hits.contains(&e.source.record));
    let regions: Vec<Region> = rings.filter_map(|e| ring(e, plan)).collect();
    if regions.is_empty() {
        let (what, names) = (asked.what, asked.names(drawing));
        let text = format!("--query {query:?}: no such {what}, {what}s present: {names}; nothing was done");
        return Err(Error::usage("query", Place::file(&drawing.file), text));
    }
    plan.markers.query = regions;
    Ok(())
}

/// The settings with the storey on which the space that `--query` names is, where nobody names one and the one with most
/// walls has no such space.
///
/// # Errors
/// [`Error::Usage`] where a storey is named and the space is on another, or on none of several.
pub(super) fn on_storey_of_query<'s>(
    input: &Input<'_>,
    settings: &'s Settings,
) -> Result<Cow<'s, Settings>, Error> {
    let same = Ok(Cow::Borrowed(settings));
    let Some(query) = &settings.query else { return same };
    let asked = Asked::new(query, input.file())?;
    let Ok(opened) = Opened::new(input.file(), &input.bytes) else { return same };
    let options = study::read_options(settings);
    let storeys = opened.building(&options).0;
    let own = match &settings.storey {
        Some(name) => formats::storey_at(storeys.iter().map(|s| s.name.as_str()), name),
        None => (0..storeys.len()).rev().max_by_key(|i| storeys[*i].walls),
    };
    let Some(own) = own.filter(|_| storeys.len() > 1) else { return same };
    let of = |s: &StoreyInfo| formats::ReadOptions { storey: Some(s.name.clone()), ..options.clone() };
    let has = |(drawing, _): &(Result<Drawing, Error>, Report)| {
        drawing.as_ref().is_ok_and(|d| !asked.hits(d).is_empty())
    };
    if opened.read_all(&[of(&storeys[own])]).iter().any(has) {
        return same;
    }
    let read = opened.read_all(&storeys.iter().map(of).collect::<Vec<_>>());
    let (what, here) = (asked.what, &storeys[own].name);
    let usage = |text: String| Error::usage("query", Place::file(input.file()), text + "; nothing was done");
    let Some(other) = read.iter().position(has).map(|i| &storeys[i].name) else {
        let names = storeys.iter().zip(&read).filter_map(|(s, (drawing, _))| {
            Some(format!("on \"{}\": {}", s.name, asked.names(drawing.as_ref().ok()?)))
        });
        let names = names.collect::<Vec<_>>().join("; ");
        return Err(usage(format!("--query {query:?}: no such {what}, {what}s present {names}")));
    };
    if settings.storey.is_some() {
        return Err(usage(format!(
            "--query {query:?}: no such {what} on storey \"{here}\", it is on \"{other}\": --storey \"{other}\""
        )));
    }
    let why = format!(
        "--query {query:?} names a {what} of storey \"{other}\", which is taken; \"{here}\" has more walls and no such {what}"
    );
    Ok(Cow::Owned(Settings { storey: Some(other.clone()), storey_taken: Some(why), ..settings.clone() }))
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
