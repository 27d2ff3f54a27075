//! What a building's file knows beyond outlines: spaces, openings, moves stated of its elements.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::Input;
use crate::measure::study;
use enfilade_cad::Opened;
use enfilade_cad::drawing::{Drawing, Entity, MarkedMove};
use enfilade_cad::ifc::{CLOSING_LAYERS, ZONE_LAYER};
use enfilade_cad::names::{Found, Pattern};
use enfilade_cad::own_layers::name_in;
use enfilade_cad::plane::{box_of, distance_to_segment, is_inside_ring};
use enfilade_config::{MoveTable, Settings};
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::axes::Opening;
use enfilade_plan::curve::Trace;
use enfilade_plan::views::FAR_M;
use enfilade_plan::{DOOR_LAYER, Plan, Wall, curve};
use enfilade_report::{Error, Place, Report};

/// Layer of spaces.
const SPACE_LAYER: &str = "IfcSpace";

/// What `--query` may name: the word before the name, what is meant, and the layer of the names.
const NAMED: [(&str, &str, &str); 2] = [("space:", "space", SPACE_LAYER), ("zone:", "zone", ZONE_LAYER)];

/// What `--query` asks for.
struct Asked {
    /// Names that are meant.
    names: Pattern,
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
        let names = match pattern.contains(r"\X") {
            // As somebody copies a name out of a STEP file.
            true => Pattern::new(&enfilade_cad::ifc::decoded(pattern)),
            false => Pattern::new(pattern),
        };
        let names = names.map_err(|e| usage(format!("--query {query:?}: {e}; nothing was done")))?;
        Ok(Self { names, what, layer })
    }

    /// What of a drawing is meant, its places among the names there.
    fn found(&self, drawing: &Drawing) -> Found {
        let named = drawing.texts.iter().filter(|t| t.layer == self.layer);
        let all: Vec<Vec<&str>> = named.map(|t| t.text.lines().collect()).collect();
        Found::of(&all, &self.names)
    }

    /// Records of the spaces that are meant.
    fn hits(&self, drawing: &Drawing) -> Vec<usize> {
        let hits = self.found(drawing).hits;
        let named: Vec<_> = drawing.texts.iter().filter(|t| t.layer == self.layer).collect();
        hits.into_iter().map(|i| named[i].source.record).collect()
    }

    /// Why none is meant though several are called so, where that is so.
    fn several(&self, rivals: &[String]) -> Option<String> {
        let what = self.what;
        (rivals.len() > 1).then(|| {
            format!(
                "found several {what}s that are so called without accents and blanks ({}), expected one; name it as it stands there",
                enfilade_cad::quoted(rivals)
            )
        })
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

/// The settings with the storey on which the space that `--query` names is, where nobody names one and the one with most
/// walls has no such space.
///
/// # Errors
/// [`Error::Usage`] where a storey is named and the space is on another, or on none of several.
pub(crate) fn on_storey_of_query<'s>(
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
        Some(name) => enfilade_cad::storey_at(storeys.iter().map(|s| s.name.as_str()), name),
        None => enfilade_cad::main_storey(&storeys, options.cut_m()),
    };
    let Some(own) = own.filter(|_| storeys.len() > 1) else { return same };
    let key = |i: usize| enfilade_cad::storey_key(&storeys, i);
    let of = |i: usize| enfilade_cad::ReadOptions { storey: Some(key(i)), ..options.clone() };
    let found = |(drawing, _): &(Result<Drawing, Error>, Report)| {
        drawing.as_ref().map_or_else(|_| Found::default(), |d| asked.found(d))
    };
    let here = opened.read_all(&[of(own)]).first().map(found).unwrap_or_default();
    if !here.hits.is_empty() && (!here.is_bare || settings.storey.is_some()) {
        return same;
    }
    let read = opened.read_all(&(0..storeys.len()).map(of).collect::<Vec<_>>());
    let all: Vec<Found> = read.iter().map(found).collect();
    let is_same = |f: &&Found| !f.hits.is_empty() && !f.is_bare;
    let is_elsewhere = all.iter().any(|f| is_same(&f));
    // The same name on another storey stands before one that is only like it here.
    if !is_elsewhere && (!here.hits.is_empty() || !here.rivals.is_empty()) {
        return same;
    }
    let position = all.iter().position(|f| if is_elsewhere { is_same(&f) } else { !f.hits.is_empty() });
    let (what, here) = (asked.what, key(own));
    let usage = |text: String| Error::usage("query", Place::file(input.file()), text + "; nothing was done");
    let Some(other) = position.map(key) else {
        if let Some(why) = all.iter().find_map(|f| asked.several(&f.rivals)) {
            return Err(usage(format!("--query {query:?}: {why}")));
        }
        let names = read.iter().enumerate().filter_map(|(i, (drawing, _))| {
            Some(format!("on \"{}\": {}", key(i), asked.names(drawing.as_ref().ok()?)))
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
    let points: Vec<PointUm> = enfilade_cad::curve::control_points(&entity.shape)
        .into_iter()
        .map(|p| plan.frame.um_from_file(p))
        .collect();
    (points.len() > 2).then_some(Region::Ring(points))
}

/// What closes doors and windows: for finding out what lies inside a building, not for sight. What belongs to a wall far off
/// closes nothing.
pub(crate) fn closings(drawing: &Drawing, plan: &Plan) -> Vec<Segment> {
    let plugs = drawing.entities.iter().filter(|e| CLOSING_LAYERS.contains(&e.layer.as_str()));
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
    drawing.entities.iter().filter_map(of).collect()
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

/// The moves that elements state of themselves: those that state one name and one move go together, every other by itself,
/// under a name of its own.
pub(crate) fn marked_moves(drawing: &Drawing) -> Vec<MoveTable> {
    let mut out: Vec<MoveTable> = Vec::new();
    let mut together: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    // A name that is stated by itself stands before one among the clauses.
    let own = |m: &MarkedMove| name_in(&m.text).filter(|_| !m.is_named);
    let names: Vec<(String, bool)> = drawing
        .marked
        .iter()
        .map(|m| own(m).map_or_else(|| (m.name.clone(), m.is_named), |name| (name, true)))
        .collect();
    let given: BTreeSet<&str> = names.iter().map(|n| n.0.as_str()).collect();
    let mut taken: BTreeSet<String> = BTreeSet::new();
    for (marked, (own, is_named)) in drawing.marked.iter().zip(&names) {
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
