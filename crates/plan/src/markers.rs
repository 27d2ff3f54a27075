//! What the user drew on our layers: regions, moves, what to keep (spec 9).

use enfilade_cad::drawing::place;
use enfilade_cad::own_layers::{KEEP, MOVE, QUERY, REFERENCE, pair_of};
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::PlanOptions;
use super::allowed::{self, Allowed, AllowedAt};
use super::asked::AskedMark;
use super::curve;
use super::frame::Frame;
use super::length::{length, number};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Shape, SourceRef, Text, Unit};
use enfilade_cad::own_layers;
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Side, side_of_ring};
use enfilade_report::{Place, Report};

/// Whether a layer begins like those of pairs and names none.
fn is_without_name(layer: &str, kind: &str) -> bool {
    let rest = layer.split_at_checked(kind.len()).filter(|(head, _)| head.eq_ignore_ascii_case(kind));
    rest.and_then(|(_, rest)| rest.strip_prefix(['-', ':', '_'])).is_some_and(|name| name.trim().is_empty())
}

/// A transformation `g_i` of the parametrisation (spec 2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Shift along x.
    X,
    /// Shift along y.
    Y,
    /// Shift along a direction, radians anticlockwise from +x.
    Along(f64),
    /// Turn about a point (drawing units), or about the centroid of the group's nodes.
    Rotate(Option<DVec2>),
    /// Scale about a point (drawing units), or about the centroid of the group's nodes.
    Scale(Option<DVec2>),
}

impl Kind {
    /// Name in result.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Along(_) => "along",
            Self::Rotate(_) => "rotate",
            Self::Scale(_) => "scale",
        }
    }

    /// The parameter value that changes nothing.
    pub fn identity(self) -> f64 {
        if matches!(self, Self::Scale(_)) { 1.0 } else { 0.0 }
    }
}

/// One clause of a group's text: a parameter with its bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Clause {
    /// The transformation.
    pub kind: Kind,
    /// Lower bound, in `unit`.
    pub lower: f64,
    /// Upper bound, in `unit`.
    pub upper: f64,
    /// `mm`, `m` … for shifts, `deg` for turns, empty for scales.
    pub unit: String,
    /// Metres, radians or 1 in one `unit`.
    pub si_per_unit: f64,
}

/// As it is written.
impl std::fmt::Display for Clause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        write!(f, "{} {}{unit} to {}{unit}", self.kind.name(), self.lower, self.upper)
    }
}

/// A group of nodes and how they may move.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Name given by the user, or `move-3`.
    pub name: String,
    /// The closed outline that encloses the nodes.
    pub outline: Region,
    /// Parameters in declared order.
    pub clauses: Vec<Clause>,
    /// The outline's entity.
    pub source: SourceRef,
}

/// The regions of a named pair.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pair {
    /// Name, lower case.
    pub name: String,
    /// `EF-QUERY-<name>`; empty: the unnamed region of query.
    pub query: Vec<Region>,
    /// `EF-REFERENCE-<name>`; empty: the unnamed region of reference.
    pub reference: Vec<Region>,
}

/// All marks of a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Markers {
    /// `EF-QUERY`.
    pub query: Vec<Region>,
    /// `EF-REFERENCE`.
    pub reference: Vec<Region>,
    /// `EF-KEEP`.
    pub keep: Vec<Region>,
    /// `EF-MOVE`, in the order of their outlines in the file.
    pub groups: Vec<Group>,
    /// Whether anything at all is drawn on `EF-MOVE`, or on a layer that was meant to be it or `EF-KEEP`, also where none
    /// of it can be read.
    pub is_move_drawn: bool,
    /// Named pairs of regions, by name.
    pub pairs: Vec<Pair>,
    /// Building works that marks allow, in the order of the file.
    pub allowed: Vec<Allowed>,
    /// What the user asks of rooms, in the order of the file.
    pub asked: Vec<AskedMark>,
}

impl Markers {
    /// That no mark says what moves: there is none, or those that there are allow works alone; `moves` is what such a mark
    /// is called in this format.
    pub fn unmarked_words(&self, moves: &str) -> String {
        match self.allowed.is_empty() {
            true => format!("no {moves}"),
            false => format!("{moves} allows building works and says nothing of moves"),
        }
    }

    /// The pair of a name (lower case), made where there is none yet.
    pub fn pair(&mut self, name: &str) -> &mut Pair {
        let at = match self.pairs.binary_search_by(|p| p.name.as_str().cmp(name)) {
            Ok(at) => at,
            Err(at) => {
                self.pairs.insert(at, Pair { name: name.to_owned(), ..Pair::default() });
                at
            }
        };
        &mut self.pairs[at]
    }

    /// What a pair is measured over: its own regions, else the unnamed ones, else none, which means the
    /// interior.
    pub fn regions_of<'a>(&'a self, pair: &'a Pair) -> [&'a [Region]; 2] {
        let own = |own: &'a Vec<Region>, other: &'a Vec<Region>| if own.is_empty() { other } else { own };
        [own(&pair.query, &self.query), own(&pair.reference, &self.reference)]
    }

    /// Whether the interior is measured: some region is not drawn.
    pub fn needs_interior(&self) -> bool {
        let unnamed = [self.query.as_slice(), self.reference.as_slice()];
        let named = self.pairs.iter().map(|p| self.regions_of(p));
        std::iter::once(unnamed).chain(named).any(|regions| regions.iter().any(|r| r.is_empty()))
    }

    /// Where is measured by the user's word.
    pub fn regions(&self) -> impl Iterator<Item = &Region> {
        let named = self.pairs.iter().flat_map(|p| p.query.iter().chain(&p.reference));
        self.query.iter().chain(&self.reference).chain(named)
    }

    /// Whether a mark lies inside the ring: such a ring is walls round a space.
    pub fn lies_in(&self, ring: &[PointUm]) -> bool {
        let regions = self.regions().chain(&self.keep);
        let groups = self.groups.iter().map(|g| &g.outline);
        regions.chain(groups).any(|r| r.outline().iter().all(|p| side_of_ring(ring, *p) == Side::Inside))
    }
}

/// Reads all marks but those of some records, which belong to drawings that are not read; what cannot be used is
/// reported and left out.
pub fn read(
    drawing: &Drawing,
    options: &PlanOptions,
    unused: &BTreeSet<usize>,
    frame: &Frame,
    report: &mut Report,
) -> Markers {
    let rest = (!unused.is_empty()).then(|| without(drawing, unused, frame));
    // Who asks for one drawing of the sheet does not speak of the moves on the others.
    let is_move_on = |l: &str| own_layers::bare(l).eq_ignore_ascii_case(MOVE);
    let moves_elsewhere = options.view.is_none()
        && drawing.entities.iter().any(|e| unused.contains(&e.source.record) && is_move_on(&e.layer));
    let drawing = rest.as_ref().unwrap_or(drawing);
    let query = options.query_layer.as_deref().unwrap_or(QUERY);
    let reference = options.reference_layer.as_deref().unwrap_or(REFERENCE);
    let mut out = Markers::default();
    let mut outlines: Vec<(Region, &Entity)> = Vec::new();
    let mut nameless: BTreeSet<&str> = BTreeSet::new();
    for e in &drawing.entities {
        let own = own_layers::bare(&e.layer);
        let on = |layer: &str| layer.eq_ignore_ascii_case(own) || layer.eq_ignore_ascii_case(&e.layer);
        let is_unnamed = on(query) || on(reference) || on(KEEP) || on(MOVE);
        let named = [QUERY, REFERENCE].map(|kind| pair_of(own, kind).filter(|_| !is_unnamed));
        if !is_unnamed && named.iter().all(Option::is_none) {
            if [QUERY, REFERENCE].iter().any(|kind| is_without_name(own, kind)) && nameless.insert(&e.layer) {
                let text = "found a layer of regions with a separator and no name behind it, expected EF-QUERY, or \
                            EF-QUERY-NAME; ignored";
                report.warn("marker-name", place(drawing, &e.source), text);
            }
            continue;
        }
        let Some(region) = region_of(e, frame) else {
            let text = "found an outline that is not closed, expected a closed polyline or a circle; ignored";
            report.warn("marker-open", place(drawing, &e.source), text);
            continue;
        };
        if region.crosses_itself() {
            let text = "found an outline that crosses itself, expected one that does not; what lies between its lines by turns \
                        inside and outside is taken so";
            report.warn("marker-crossed", place(drawing, &e.source), text);
        }
        if let [Some(name), _] = &named {
            out.pair(name).query.push(region);
            continue;
        }
        if let [_, Some(name)] = &named {
            out.pair(name).reference.push(region);
            continue;
        }
        match () {
            () if on(query) => out.query.push(region),
            () if on(reference) => out.reference.push(region),
            () if on(KEEP) => out.keep.push(region),
            () => outlines.push((region, e)),
        }
    }
    (out.groups, out.allowed) = groups(drawing, &outlines, frame, report);
    // Who marks works alone says nothing of moves.
    let is_of_works = !outlines.is_empty() && out.groups.is_empty() && out.allowed.len() == outlines.len();
    for (option, layer, found) in [
        ("--query-layer", &options.query_layer, !out.query.is_empty()),
        ("--reference-layer", &options.reference_layer, !out.reference.is_empty()),
    ] {
        if let Some(layer) = layer.as_deref().filter(|_| !found) {
            say_no_region(drawing, option, layer, report);
        }
    }
    let misnamed = say_misnamed(drawing, [query, reference], report);
    let is_drawn = layers_drawn_on(drawing).any(is_move_on) && !is_of_works;
    out.is_move_drawn = misnamed || moves_elsewhere || is_drawn;
    out
}

/// A drawing without the marks of some records, nor the texts that stand in outlines of moves among them.
fn without(drawing: &Drawing, unused: &BTreeSet<usize>, frame: &Frame) -> Drawing {
    let mut out = drawing.clone();
    let is_mark = |layer: &str| own_layers::bare(layer).eq_ignore_ascii_case(MOVE);
    let goes = |e: &Entity| unused.contains(&e.source.record);
    let own = drawing.entities.iter().filter(|e| is_mark(&e.layer));
    let (gone, left): (Vec<&Entity>, Vec<&Entity>) = own.partition(|e| goes(e));
    let [gone, left]: [Vec<Region>; 2] =
        [gone, left].map(|list| list.into_iter().filter_map(|e| region_of(e, frame)).collect());
    out.texts.retain(|t| {
        let at = frame.um_from_file(t.at);
        let lies_in = |list: &[Region]| list.iter().any(|r| r.contains(at));
        !is_mark(&t.layer) || !lies_in(&gone) || lies_in(&left)
    });
    out.entities.retain(|e| !goes(e));
    out
}

/// Layers of all that is drawn, read or not.
fn layers_drawn_on(drawing: &Drawing) -> impl Iterator<Item = &str> {
    let entities = drawing.entities.iter().chain(&drawing.fills).map(|e| e.layer.as_str());
    let others = drawing.texts.iter().map(|t| &t.layer).chain(drawing.undrawn.iter().map(|u| &u.layer));
    entities.chain(others.map(String::as_str))
}

/// Layers named where one that was asked for holds no region.
const LAYERS_SHOWN: usize = 12;

/// Says that a layer which the user named holds no region, and which layers are drawn on.
fn say_no_region(drawing: &Drawing, option: &str, layer: &str, report: &mut Report) {
    let layers: BTreeSet<&str> = layers_drawn_on(drawing).collect();
    let is_drawn = layers.iter().any(|l| l.eq_ignore_ascii_case(layer));
    let found =
        if is_drawn { "found no closed outline on that layer" } else { "found no such layer drawn on" };
    let shown: Vec<&str> = layers.iter().copied().take(LAYERS_SHOWN).collect();
    let more = if layers.len() > shown.len() {
        format!(" and {} more", layers.len() - shown.len())
    } else {
        String::new()
    };
    let text = format!(
        "{option} {layer:?}: {found}, expected a closed polyline or a circle there; nothing is left out for it, and the \
         interior is measured; layers drawn on: {}{more}",
        shown.join(", ")
    );
    report.warn("region-layer", Place::file(&drawing.file), text);
}

/// Names layers that were meant to be marks, each with the first that is drawn on it; whether one of them was meant to
/// say what moves or stays.
fn say_misnamed(drawing: &Drawing, chosen: [&str; 2], report: &mut Report) -> bool {
    let entities = drawing.entities.iter().chain(&drawing.fills).map(|e| (&e.layer, Some(&e.source)));
    let texts = drawing.texts.iter().map(|t| (&t.layer, Some(&t.source)));
    let undrawn = drawing.undrawn.iter().map(|u| (&u.layer, None));
    let mut first: BTreeMap<&str, Option<&SourceRef>> = BTreeMap::new();
    for (layer, source) in entities.chain(texts).chain(undrawn) {
        first.entry(layer).or_insert(source);
    }
    let mut holds_moves = false;
    for (layer, source) in
        first.into_iter().filter(|(l, _)| !chosen.iter().any(|c| c.eq_ignore_ascii_case(l)))
    {
        let nameless = [QUERY, REFERENCE].iter().any(|kind| is_without_name(own_layers::bare(layer), kind));
        let Some(right) = own_layers::meant(layer).filter(|_| !nameless) else { continue };
        let decides = [MOVE, KEEP].contains(&right);
        holds_moves |= decides;
        let then = if decides { "not read, and nothing moves by default" } else { "not read" };
        let text =
            format!("found the layer {layer:?}, expected {right}, spelt so; what is drawn there is {then}");
        let place = source.map_or_else(|| Place::file(&drawing.file), |s| place(drawing, s));
        report.warn("marker-misnamed", place, text);
    }
    holds_moves
}

fn region_of(entity: &Entity, frame: &Frame) -> Option<Region> {
    if let Shape::Circle { centre, radius } = &entity.shape {
        let radius_um = frame.um_from_file(DVec2::new(*radius, 0.0))[0];
        return Some(Region::Disc { centre: frame.um_from_file(*centre), radius_um });
    }
    let mut trace = curve::trace(&entity.shape, frame);
    if !trace.is_closed && trace.points.len() > 3 && trace.points.first() == trace.points.last() {
        trace.points.pop();
        trace.is_closed = true;
    }
    (trace.is_closed && trace.points.len() >= 3).then_some(Region::Ring(trace.points))
}

fn groups(
    drawing: &Drawing,
    outlines: &[(Region, &Entity)],
    frame: &Frame,
    report: &mut Report,
) -> (Vec<Group>, Vec<Allowed>) {
    let mut texts: Vec<Vec<&Text>> = vec![Vec::new(); outlines.len()];
    for text in drawing.texts.iter().filter(|t| own_layers::bare(&t.layer).eq_ignore_ascii_case(MOVE)) {
        let at = frame.um_from_file(text.at);
        let holder = (0..outlines.len()).filter(|i| outlines[*i].0.contains(at));
        match holder.min_by(|a, b| extent(outlines[*a].1).total_cmp(&extent(outlines[*b].1))) {
            Some(i) => texts[i].push(text),
            None => {
                let words = format!("{:?} stands inside no closed outline of the layer; ignored", text.text);
                report.warn("move-text-alone", place(drawing, &text.source), words);
            }
        }
    }
    let (mut out, mut works) = (Vec::new(), Vec::new());
    for (i, (outline, entity)) in outlines.iter().enumerate() {
        let mut group = Group {
            name: format!("move-{}", i + 1),
            outline: outline.clone(),
            clauses: Vec::new(),
            source: entity.source.clone(),
        };
        let mut of_works = Vec::new();
        for text in &texts[i] {
            for clause in text.text.split([';', '\n']).map(str::trim).filter(|c| !c.is_empty()) {
                let read = match allowed::is_work(clause) {
                    true => allowed::read(clause, frame.metres_per_unit).map(|work| of_works.push(work)),
                    false => read_clause(clause, frame, drawing, &mut group),
                };
                if let Err(why) = read {
                    let words = format!("{clause:?}: {why}; this clause is ignored");
                    report.warn("move-clause", place(drawing, &text.source), words);
                }
            }
        }
        let has_works = !of_works.is_empty();
        if has_works {
            works.push(Allowed { at: AllowedAt::Inside(outline.clone()), works: of_works });
        }
        if group.clauses.is_empty() && has_works {
            continue;
        }
        if group.clauses.is_empty() {
            let words = "found no text inside that can be read and says how the group moves, expected for example `x -1m 1m; rotate -15 15`; \
                         the group stays";
            report.warn("move-without-text", place(drawing, &entity.source), words);
        } else {
            out.push(group);
        }
    }
    tell_apart(&mut out, drawing, report);
    (out, works)
}

/// Gives every group a name of its own: of groups with one name (in any case) the first keeps it.
fn tell_apart(groups: &mut [Group], drawing: &Drawing, report: &mut Report) {
    let given: BTreeSet<String> = groups.iter().map(|g| g.name.to_lowercase()).collect();
    let mut taken = BTreeSet::new();
    for group in groups {
        let mut name = group.name.clone();
        if taken.contains(&name.to_lowercase()) {
            let next = (2..).map(|k| format!("{} {k}", group.name)).find(|n| {
                let n = n.to_lowercase();
                !given.contains(&n) && !taken.contains(&n)
            });
            name = next.unwrap_or(name);
            let words = format!(
                "found the name {:?}, which another group has; expected a name of its own; it is called {name:?} here",
                group.name
            );
            report.warn("move-name-twice", place(drawing, &group.source), words);
        }
        taken.insert(name.to_lowercase());
        group.name = name;
    }
}

/// Reads all clauses of a side-car's `moves`.
///
/// # Errors
/// What is wrong with the first bad clause.
pub fn read_clauses(text: &str, drawing: &Drawing, frame: &Frame) -> Result<Vec<Clause>, String> {
    let source = SourceRef { record: 0, handle: None, line: 0, kind: String::new(), layer: String::new() };
    let outline = Region::Ring(Vec::new());
    let mut group = Group { name: String::new(), outline, clauses: Vec::new(), source };
    let clauses = text.split([';', '\n']).map(str::trim);
    for clause in clauses.filter(|c| !c.is_empty() && !allowed::is_work(c)) {
        read_clause(clause, frame, drawing, &mut group).map_err(|why| format!("{clause:?}: {why}"))?;
    }
    if group.clauses.is_empty() { Err("`moves` is empty".into()) } else { Ok(group.clauses) }
}

/// Nodes of the graph at the given points (drawing units), ascending.
///
/// # Errors
/// The first point that has no node within `within_m`.
pub fn nodes_of(
    points: impl Iterator<Item = DVec2>,
    plan: &super::Plan,
    graph: &super::graph::Graph,
    within_m: f64,
) -> Result<Vec<u32>, DVec2> {
    let mut out = Vec::new();
    for p in points {
        let at = plan.frame.plan_from_file(p);
        let nearest = (0..graph.nodes.len()).min_by(|a, b| {
            graph.nodes[*a].distance_squared(at).total_cmp(&graph.nodes[*b].distance_squared(at))
        });
        match nearest.filter(|n| graph.nodes[*n].distance(at) <= within_m) {
            Some(n) => out.push(n as u32),
            None => return Err(p),
        }
    }
    out.sort_unstable();
    out.dedup();
    Ok(out)
}

fn extent(entity: &Entity) -> f64 {
    let points = control_points(&entity.shape).into_iter();
    let radius = if let Shape::Circle { radius, .. } = entity.shape { radius * 2.0 } else { 0.0 };
    enfilade_cad::plane::box_of(points).map_or(0.0, |[lo, hi]| (hi - lo).length()).max(radius)
}

fn read_clause(clause: &str, frame: &Frame, drawing: &Drawing, group: &mut Group) -> Result<(), String> {
    // Minus signs and dashes as word processors set them.
    let clause = clause.replace(['−', '–', '‒', '‐', '‑', '﹣', '－'], "-");
    let words: Vec<&str> = clause.split_whitespace().collect();
    let expected = "expected `x LOW HIGH`, `y LOW HIGH`, `along DEGREES LOW HIGH`, `rotate LOW HIGH [about X,Y]`, \
                    `scale LOW HIGH [about X,Y]`, `name WORD`, or a work such as `open 0.9m 2.4m`";
    let Some((head, rest)) = words.split_first() else { return Ok(()) };
    match (head.to_lowercase().as_str(), rest) {
        ("name", name) if !name.is_empty() => {
            group.name = name.join(" ");
            Ok(())
        }
        ("x", [low, high]) => shift(Kind::X, low, high, frame, drawing, group),
        ("y", [low, high]) => shift(Kind::Y, low, high, frame, drawing, group),
        ("along", [angle, low, high]) => {
            shift(Kind::Along(degrees(angle)?.to_radians()), low, high, frame, drawing, group)
        }
        ("rotate", [low, high, about @ ..]) => {
            let unit = ("deg".to_string(), 1f64.to_radians());
            push(Kind::Rotate(centre(about)?), degrees(low)?, degrees(high)?, unit, group)
        }
        ("scale", [low, high, about @ ..]) => {
            let (low, high) = (number(low)?, number(high)?);
            if low <= 0.0 {
                return Err(format!("found a factor of {low}, expected factors above 0"));
            }
            push(Kind::Scale(centre(about)?), low, high, (String::new(), 1.0), group)
        }
        _ => Err(expected.into()),
    }
}

fn shift(
    kind: Kind,
    low: &str,
    high: &str,
    frame: &Frame,
    drawing: &Drawing,
    group: &mut Group,
) -> Result<(), String> {
    let own = drawing_unit(frame, drawing);
    let (low, low_unit) = length(low)?;
    let (high, high_unit) = length(high)?;
    let unit = match (low_unit, high_unit) {
        // Two units: the drawing's own shows both alike.
        (Some(a), Some(b)) if a.metres != b.metres => own,
        _ => high_unit.or(low_unit).unwrap_or(own),
    };
    let to_unit =
        |v: f64, u: Option<Unit>| u.map_or(v * own.metres / unit.metres, |u| v * u.metres / unit.metres);
    let same = |u: Option<Unit>| u.unwrap_or(own).metres == unit.metres;
    let low = if same(low_unit) { low } else { to_unit(low, low_unit) };
    let high = if same(high_unit) { high } else { to_unit(high, high_unit) };
    push(kind, low, high, (unit.name.to_string(), unit.metres), group)
}

fn drawing_unit(frame: &Frame, drawing: &Drawing) -> Unit {
    let known = drawing.declared_unit.filter(|u| u.metres == frame.metres_per_unit);
    let named = || enfilade_cad::units::UNITS.into_iter().find(|u| u.metres == frame.metres_per_unit);
    known.or_else(named).unwrap_or(Unit { name: "units", metres: frame.metres_per_unit })
}

/// Bounds beyond this many metres (radians, factors) are a slip: no building is as large.
const BOUND_MAX: f64 = 1e5;

/// A group turns by a whole turn at most, degrees: more only repeats the same layouts.
const MAX_TURN_DEG: f64 = 360.0;

fn push(kind: Kind, lower: f64, upper: f64, unit: (String, f64), group: &mut Group) -> Result<(), String> {
    let reach = lower.abs().max(upper.abs()) * unit.1;
    if reach.is_nan() || reach > BOUND_MAX {
        return Err(format!(
            "found bounds {lower:e} … {upper:e}, expected at most {BOUND_MAX} m (degrees, times)"
        ));
    }
    if lower > upper {
        return Err(format!("found {lower} above {upper}, expected the lower bound first"));
    }
    if matches!(kind, Kind::Rotate(_)) && upper - lower > MAX_TURN_DEG {
        return Err(format!("found a turn of {}°, expected at most {MAX_TURN_DEG}°", upper - lower));
    }
    let identity = kind.identity();
    if !(lower..=upper).contains(&identity) {
        return Err(format!("bounds {lower} … {upper} leave out {identity}, the drawing as it is"));
    }
    group.clauses.push(Clause { kind, lower, upper, unit: unit.0, si_per_unit: unit.1 });
    Ok(())
}

fn centre(about: &[&str]) -> Result<Option<DVec2>, String> {
    match about {
        [] => Ok(None),
        [word, rest @ ..] if word.eq_ignore_ascii_case("about") => {
            let joined = rest.concat();
            let Some((x, y)) = joined.split_once(',') else {
                return Err(format!("found {joined:?}, expected `about X,Y` in drawing units"));
            };
            Ok(Some(DVec2::new(number(x)?, number(y)?)))
        }
        _ => Err(format!("found {:?}, expected `about X,Y`", about.join(" "))),
    }
}

/// An angle: `45`, `45°`, `45deg`.
fn degrees(s: &str) -> Result<f64, String> {
    number(s.trim_end_matches("deg").trim_end_matches('°'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_may_name_a_pair() {
        for (layer, name) in [
            ("EF-QUERY-Entrance", Some("entrance")),
            ("ef-query:main hall", Some("main-hall")),
            ("EF-QUERY_2", Some("2")),
            ("EF-QUERY-süd", Some("süd")),
            ("EF-QUERY", None),
            ("EF-QUERY-", None),
            ("EF-QUERYING", None),
            ("EF-REFERENCE-exit", None),
            ("Ünf-QUER", None),
        ] {
            assert_eq!(pair_of(layer, QUERY).as_deref(), name, "{layer}");
        }
        let is_marker = own_layers::is_marker;
        assert!(is_marker("EF-Reference-exit") && !is_marker("EF-MOVE-exit") && !is_marker("EF-HEAT-DEGREE"));
    }

    #[test]
    fn a_pair_borrows_the_regions_it_lacks() {
        let disc = |x: i64| Region::Disc { centre: [x, 0], radius_um: 5 };
        let mut marks = Markers { reference: vec![disc(1)], ..Markers::default() };
        marks.pair("exit").query.push(disc(2));
        marks.pair("art").reference.push(disc(3));
        marks.pair("exit").query.push(disc(4));
        assert_eq!(marks.pairs.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["art", "exit"]);
        assert_eq!(marks.regions_of(&marks.pairs[0]), [&[][..], &[disc(3)]]);
        assert_eq!(marks.regions_of(&marks.pairs[1]), [&[disc(2), disc(4)][..], &[disc(1)]]);
        assert!(marks.needs_interior());
        marks.query.push(disc(9));
        assert!(!marks.needs_interior());
    }

    /// Degrees are written alike after every word, and bounds in two units are shown in the drawing's.
    #[test]
    fn angles_and_mixed_units_are_read_as_people_write_them() {
        let drawing = Drawing::of(Vec::new());
        let frame = Frame::new(0.001, [DVec2::ZERO; 2]);
        let read = |text: &str| read_clauses(text, &drawing, &frame).unwrap().remove(0);
        for angle in ["45", "45°", "45deg"] {
            let clause = read(&format!("along {angle} -100 100"));
            assert!(
                matches!(clause.kind, Kind::Along(rad) if (rad - 45f64.to_radians()).abs() < 1e-12),
                "{angle}"
            );
        }
        let mixed = read("x -0.5m 2'-6\"");
        assert_eq!((mixed.unit.as_str(), mixed.lower), ("mm", -500.0));
        assert!((mixed.upper - 762.0).abs() < 1e-9, "{}", mixed.upper);
        let one = read("x -1' 2'-6\"");
        assert_eq!((one.unit.as_str(), one.lower, one.upper), ("ft", -1.0, 2.5));
    }

    #[test]
    fn bounds_beyond_any_building_are_refused() {
        let source =
            SourceRef { record: 0, handle: None, line: 0, kind: String::new(), layer: String::new() };
        let outline = Region::Ring(Vec::new());
        let mut group = Group { name: String::new(), outline, clauses: Vec::new(), source };
        let mut bound = |upper: f64| push(Kind::X, 0.0, upper, ("m".into(), 1.0), &mut group);
        assert!(bound(BOUND_MAX).is_ok());
        for far in [BOUND_MAX * 1.01, 1e308, f64::INFINITY, f64::NAN] {
            assert!(bound(far).is_err(), "{far}");
        }
        let unit = ("deg".to_string(), 1f64.to_radians());
        let mut turn = |upper| push(Kind::Rotate(None), 0.0, upper, unit.clone(), &mut group);
        assert!(turn(MAX_TURN_DEG).is_ok());
        assert!(turn(MAX_TURN_DEG + 1.0).is_err());
    }
}
