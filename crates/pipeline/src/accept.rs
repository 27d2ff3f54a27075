//! `enfilade accept`: a candidate becomes a new clean drawing, the next round's present layout.
//!
//! The drawing gets the moves and nothing else; what the next round needs to know (moves with the
//! bounds that are left, settings, where it came from) stands in its side-car.

use std::borrow::Cow;
use std::collections::BTreeSet;

use toml::{Table, Value};

use crate::job::{Input, Job};
use crate::measure::ruler::ruler;
use crate::read;
use crate::understand::edits::{edits_of, tied};
use crate::understand::understood;
use crate::understand::understood::Understood;
use crate::understand::{fits, marked};
use crate::works::of_option;
use enfilade_cad::drawing::{Format, Unit};
use enfilade_cad::units::unit_by_name;
use enfilade_config::{
    Beside, KnownMove, LineageTable, NONE, Partial, SETTINGS_VERSION, Settings, Thresholds,
};
use enfilade_moves::{Layout, NodeGroup, Parameter, enclosed};
use enfilade_overlay::built::OptionWork;
use enfilade_overlay::result::{Numbers, RoundResult};
use enfilade_plan::Wall;
use enfilade_plan::graph::Handle;
use enfilade_plan::markers::{Clause, Group, Kind};
use enfilade_report::{Error, Place, Report, counted};

/// A new drawing with its side-car.
#[derive(Clone, Debug, PartialEq)]
pub struct Accepted {
    /// Bytes of the drawing.
    pub drawing: Vec<u8>,
    /// Text of `<drawing>.enfilade.toml`.
    pub side_car: String,
}

/// What is accepted of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Its round; of the best so far the number that its round would have.
    pub round: u32,
    /// Whether it is the best so far of a search that goes on or was stopped.
    pub is_so_far: bool,
}

impl std::fmt::Display for Origin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.is_so_far { f.write_str("the best so far") } else { write!(f, "round {}", self.round) }
    }
}

/// What of a round is accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Chosen {
    /// The best layout found.
    Best,
    /// An option, from 1.
    Option(usize),
    /// A point of the front of gain against effort, from 1.
    Point(usize),
}

impl Chosen {
    /// An option by its number; 0 is the best layout.
    pub fn numbered(number: usize) -> Self {
        if number == 0 { Self::Best } else { Self::Option(number) }
    }
}

impl std::fmt::Display for Chosen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Best => f.write_str("the best layout"),
            Self::Option(n) => write!(f, "option {n}"),
            Self::Point(n) => write!(f, "point {n}"),
        }
    }
}

/// What is taken of a round.
struct Taken<'r> {
    parameters: Cow<'r, [f64]>,
    mean: &'r Numbers,
    works: &'r [OptionWork],
}

/// What is chosen of a round, if it has that; a point moves nothing.
fn taken(result: &RoundResult, chosen: Chosen) -> Option<Taken<'_>> {
    match chosen {
        Chosen::Best => {
            let best = result.best.as_ref()?;
            Some(Taken { parameters: (&best.parameters[..]).into(), mean: &best.mean, works: &[] })
        }
        Chosen::Option(n) => {
            let c = result.candidates.get(n.checked_sub(1)?)?;
            Some(Taken { parameters: (&c.parameters[..]).into(), mean: &c.mean, works: &c.works })
        }
        Chosen::Point(n) => {
            let point = result.front.get(n.checked_sub(1)?)?;
            let still: Vec<f64> = result.moves.iter().map(|m| m.kind.identity()).collect();
            Some(Taken { parameters: still.into(), mean: &point.mean, works: &point.works })
        }
    }
}

/// Why a round does not have what is chosen.
fn has_none(result: &RoundResult, origin: Origin, chosen: Chosen) -> String {
    let n = result.candidates.len();
    let none = result.problems.iter().find(|p| p.code == "no-option");
    match chosen {
        Chosen::Point(_) if result.front.is_empty() => {
            format!("{origin} has no works to choose a point of, found {chosen}; nothing was written")
        }
        Chosen::Point(_) => {
            format!("{origin} has points 1 to {}, found {chosen}; nothing was written", result.front.len())
        }
        Chosen::Best if none.is_some() => {
            let why = none.map_or("", |p| p.text.as_str());
            format!("{origin} has no best layout: {why}; nothing was written")
        }
        Chosen::Best => format!("{origin} found no layout better than the present one; nothing was written"),
        Chosen::Option(number) if n == 0 => {
            format!("{origin} has no options, found number {number}; nothing was written")
        }
        Chosen::Option(number) => format!(
            "{origin} has options 1 to {n} (0 is the best layout found), found number {number}; nothing was written"
        ),
    }
}

/// Makes the drawing of what is chosen of a round; `beside` as in [`Settings::beside`].
///
/// # Errors
/// [`Error::Usage`] when there is no such candidate; [`Error::Input`] when the drawing is not the one the
/// round was made from, or a parameter lies outside its bounds.
pub fn accept(
    input: &Input<'_>,
    beside: Beside,
    result: &RoundResult,
    origin: Origin,
    chosen: Chosen,
) -> Result<Accepted, Error> {
    let place = || Place::file(input.file());
    let Some(Taken { parameters, mean, works }) = taken(result, chosen) else {
        return Err(Error::usage("candidate", place(), has_none(result, origin, chosen)));
    };
    let parameters = &parameters[..];
    let is_saved_again = || !result.input.content.is_empty() && input.content() == result.input.content;
    if input.sha256() != result.input.sha256 && !is_saved_again() {
        let text = format!(
            "the drawing has changed since {origin} was made; nothing was written; run it again and accept from the new round"
        );
        return Err(Error::input("drawing-changed", place(), text));
    }
    let settings: Settings = serde_json::from_value(serde_json::Value::Object(result.settings.clone()))
        .map_err(|e| {
            Error::input(
                "result-settings",
                place(),
                format!("result.json of {origin}: {e}; nothing was written"),
            )
        })?;
    let mut settings = Settings { beside, ..settings };
    settings.of_storey = read::storey::key_read(input, &settings);
    let mut report = Report::default();
    let base = understood(
        &read::drawing(input.file(), &input.bytes, &settings, &mut report)?,
        &settings,
        &mut report,
    )?;
    if base.moves.parameters.len() != parameters.len() {
        let text = format!(
            "{origin} has {}, the drawing {}; run it again",
            counted(parameters.len() as u64, "parameter"),
            base.moves.parameters.len()
        );
        return Err(Error::input("parameters", place(), text));
    }
    judge_parameters(&base, parameters).map_err(|(name, text)| {
        let text = format!("{origin}: {text}; nothing was written");
        Error::input("parameters", place().entity(name), text)
    })?;
    let layout = base.moves.apply(&base.plan, &base.graph, parameters);
    let drawing = if works.is_empty() {
        moved((input, &settings), &base, &layout)?
    } else {
        let made = of_option(Job { input, settings: &settings }, works, parameters)?;
        // What the drawing cannot hold is decided beside it.
        settings.works.extend(made.written.tables);
        made.bytes
    };
    let lineage = LineageTable {
        drawing: input.file().into(),
        round: origin.round,
        so_far: origin.is_so_far,
        ruler: ruler(&base.plan, &settings, result.spacing_m),
        candidate: if let Chosen::Option(n) = chosen { n as u32 } else { 0 },
        point: if let Chosen::Point(n) = chosen { Some(n as u32) } else { None },
        initial: pairs(&result.initial.mean),
        accepted: pairs(mean),
    };
    let mut table = side_car(&base, &settings, result, (parameters, &layout), lineage)?;
    // Nothing has moved, and what moves by default is found anew where walls have gone.
    let is_anew = !works.is_empty() && base.moves.are_default;
    if is_anew {
        ["move", "warm", "ignore-move-markers"].iter().for_each(|key| drop(table.remove(*key)));
    }
    if table.contains_key("warm") {
        let known = moves_again(input, &drawing, &table, &settings)?;
        let known = known.into_iter().map(Value::try_from).collect::<Result<Vec<_>, _>>();
        table.insert("warm-move".into(), known.map_err(toml_failed)?.into());
    }
    let text = toml::to_string(&table).map_err(toml_failed)?;
    let counted = "# Moves count from the drawing as it is now; EF-MOVE in the drawing is left unread. Delete this file to\n\
                   # start afresh from the markers.\n";
    let counted = if is_anew { "" } else { counted };
    let side_car = format!(
        "# Written by `enfilade accept`: what the next round of this drawing needs to know.\n{counted}{text}"
    );
    Ok(Accepted { drawing, side_car })
}

/// The drawing with what a layout moves.
fn moved(
    (input, settings): (&Input<'_>, &Settings),
    base: &Understood,
    layout: &Layout,
) -> Result<Vec<u8>, Error> {
    let mut edits = edits_of(base, layout);
    edits.extend(tied(Job { input, settings }, base, &edits)?.following.into_iter().map(|f| f.edit));
    enfilade_cad::patch(input.file(), &input.bytes, &read::read_options(settings), &edits, &[])
}

/// Each parameter lies within the bounds of its move, within rounding; else the name of the group and what is wrong.
fn judge_parameters(base: &Understood, parameters: &[f64]) -> Result<(), (String, String)> {
    const SLACK: f64 = 1e-9;
    for (p, value) in base.moves.parameters.iter().zip(parameters) {
        let Clause { lower, upper, unit, .. } = &p.clause;
        let slack = SLACK * lower.abs().max(upper.abs());
        if !(lower - slack..=upper + slack).contains(value) {
            let text = format!("found parameter {value} {unit}, expected {lower} to {upper}");
            return Err((p.group_name.clone(), text));
        }
    }
    Ok(())
}

/// The moves of the new drawing with its side-car: what the numbers of `warm` belong to.
fn moves_again(
    input: &Input<'_>,
    drawing: &[u8],
    side_car: &Table,
    settings: &Settings,
) -> Result<Vec<KnownMove>, Error> {
    let text = toml::to_string(side_car).map_err(toml_failed)?;
    let again =
        Settings { beside: settings.beside.clone(), ..Settings::new(Partial::from_toml("", &text)?)? };
    let base = understood(
        &read::drawing(input.file(), drawing, &again, &mut Report::default())?,
        &again,
        &mut Report::default(),
    )?;
    Ok(fits::known_moves(&base))
}

fn pairs(numbers: &Numbers) -> std::collections::BTreeMap<String, f64> {
    numbers.0.iter().cloned().collect()
}

/// Where nodes stand after the move, drawing units.
fn positions(base: &Understood, layout: &Layout, group: &[Handle], nodes: &[u32]) -> Vec<[f64; 2]> {
    let of_node = |n: &u32| {
        let handles = &base.graph.handles[*n as usize];
        let (w, c) = handles.iter().find(|h| group.binary_search(h).is_ok()).or(handles.first())?;
        let moved = base.moves.walls.binary_search(w).ok().map(|i| &layout.walls[i].shape);
        let shape = moved.unwrap_or(&base.plan.walls[*w as usize].shape);
        enfilade_cad::curve::control_points(shape).get(*c as usize).map(|p| p.to_array())
    };
    nodes.iter().filter_map(of_node).collect()
}

/// What the next round needs to know. Every key of the settings stands here, so that none is forgotten, also where it is
/// the default or nothing, since the folder's settings may say otherwise: `None` is what decides no outcome, belongs to one
/// round alone, or is the default that objectives stated later replace.
fn side_car(
    base: &Understood,
    settings: &Settings,
    result: &RoundResult,
    (parameters, layout): (&[f64], &Layout),
    last: LineageTable,
) -> Result<Table, Error> {
    let is_default = settings.thresholds == Thresholds::Yielding
        && Settings::new(Partial::default()).is_ok_and(|s| s.objectives == settings.objectives);
    let known = others(base, result, parameters);
    let some = |list: &Vec<String>| (!list.is_empty()).then(|| list.clone());
    let links: Vec<String> = settings.links.iter().map(ToString::to_string).collect();
    let none = || NONE.to_owned();
    let said = Partial {
        version: Some(SETTINGS_VERSION),
        unit: Some(unit_words(base.plan.unit.unit)),
        wall_layer: some(&settings.wall_layers),
        query_layer: settings.query_layer.clone(),
        reference_layer: settings.reference_layer.clone(),
        view: settings.view.clone(),
        level: Some(settings.level),
        spacing: Some(result.spacing_m),
        lattice_centre: settings.lattice_centre_m,
        seed_point: (!settings.seed_points.is_empty()).then(|| settings.seed_points.clone()),
        backend: None,
        threads: None,
        out: None,
        seed: Some(settings.seed),
        evaluations: settings.evaluations,
        seconds: settings.seconds,
        write_every: None,
        members: Some(settings.members),
        mode: Some(settings.mode),
        method: Some(settings.method),
        objective: (!is_default).then(|| settings.objective_text()),
        unsure: Some(settings.unsure),
        thresholds: (!is_default).then_some(settings.thresholds),
        score: Some(settings.score_text()),
        penalty: Some(settings.penalty_text()),
        distance: Some(settings.distance),
        limit: Some(settings.limit_text()).filter(|t| !t.is_empty()).or_else(|| Some(none())),
        link: some(&links).or_else(|| Some(vec![none()])),
        snap: Some(settings.snap.map_or_else(none, |s| s.to_string())),
        most_moves: settings.most_moves,
        only_marked: Some(settings.only_marked),
        allow: Some(settings.allow.to_string()),
        budget: Some(settings.budget.to_string()),
        brief: settings.brief_text(),
        least_gain: Some(settings.least_gain.to_string()),
        raw: Some(settings.raw),
        until_converged: Some(settings.until_converged),
        together: settings.together,
        pin: None,
        pin_options: Vec::new(),
        like: None,
        warm: (!known.is_empty()).then_some(known),
        colours: Some(settings.colours),
        overlay: Some(settings.overlay),
        pictures: None,
        storey: settings.storey.clone(),
        over_stairs: settings.over_stairs.then_some(true),
        of_storey: settings.of_storey.clone(),
        query: settings.query.clone(),
        accept_missing_eof: Some(settings.accept_missing_eof),
        ignore_move_markers: Some(true),
        moves: Vec::new(),
        regions: settings.regions.clone(),
        works: settings.works.clone(),
        lineage: settings.lineage.iter().cloned().chain(std::iter::once(last)).collect(),
        pin_moves: Vec::new(),
        warm_moves: Vec::new(),
        reading: settings.reading.clone(),
        watch: None,
        host: None,
    };
    let mut out = Table::try_from(said).map_err(toml_failed)?;
    out.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
    let mut tables: Vec<Table> =
        (0..base.moves.groups.len()).map(|g| group_table(base, g, parameters, layout)).collect();
    tables.extend(tables_that_stay(base, settings, layout)?);
    out.insert("move".into(), tables.into_iter().map(Value::Table).collect::<Vec<_>>().into());
    Ok(out)
}

/// The tables of what was stated and moves nothing: what is said of it is said in the next round too.
fn tables_that_stay(base: &Understood, settings: &Settings, layout: &Layout) -> Result<Vec<Table>, Error> {
    let all = base.moves.parameters.iter().chain(&base.moves.left_out);
    let known: BTreeSet<&String> = all.map(|p| &p.group_name).collect();
    if !settings.moves.is_empty() {
        let others = settings.moves.iter().filter(|m| m.name.as_ref().is_none_or(|n| !known.contains(n)));
        return others.map(|m| Table::try_from(m).map_err(toml_failed)).collect();
    }
    let is_stated = !settings.ignore_move_markers && !base.moves.are_default;
    let others = base.plan.markers.groups.iter().filter(|g| is_stated && !known.contains(&g.name));
    let table = |marker: &Group| {
        let nodes = positions(base, layout, &[], &enclosed(&base.plan, &base.graph, marker));
        let clauses: Vec<String> = marker.clauses.iter().map(stated).collect();
        Table::from_iter([
            ("moves".into(), clauses.join("; ").into()),
            ("marker".into(), marked::marker_words(&base.plan, marker).into()),
            ("name".into(), marker.name.clone().into()),
            ("nodes".into(), points(&nodes).into()),
        ])
    };
    Ok(others.map(table).collect())
}

/// A unit as `--unit` takes it: by its name, else by its length.
pub(crate) fn unit_words(unit: Unit) -> String {
    let is_known = unit_by_name(unit.name).is_some();
    if is_known { unit.name.into() } else { format!("{}m", unit.metres) }
}

/// The other options of the round and the best layout, as they stand from the accepted one: where the
/// next search may begin.
fn others(base: &Understood, result: &RoundResult, accepted: &[f64]) -> Vec<Vec<f64>> {
    let best = result.best.iter().map(|b| &b.parameters);
    let all = result.candidates.iter().map(|c| &c.parameters).chain(best);
    let mut known: Vec<Vec<f64>> = Vec::new();
    for p in all.filter(|p| p.len() == accepted.len() && p[..] != *accepted) {
        let from = |((p, a), parameter): ((&f64, &f64), &Parameter)| match parameter.clause.kind {
            Kind::Scale(_) => p / a,
            _ => p - a,
        };
        let vector: Vec<f64> = p.iter().zip(accepted).zip(&base.moves.parameters).map(from).collect();
        if !known.contains(&vector) && vector.iter().all(|v| v.is_finite()) {
            known.push(vector);
        }
    }
    known
}

fn toml_failed(e: impl std::fmt::Display) -> Error {
    Error::environment("side-car", Place::default(), format!("the side-car could not be written: {e}"))
}

fn points(list: &[[f64; 2]]) -> Vec<Value> {
    list.iter().map(|p| Value::from(vec![Value::from(p[0]), Value::from(p[1])])).collect()
}

fn group_table(base: &Understood, group: usize, parameters: &[f64], layout: &Layout) -> Table {
    let moving =
        base.moves.parameters.iter().zip(parameters).map(|(p, value)| (p, clause(&p.as_stated(), *value)));
    let idle = base.moves.left_out.iter().map(|p| (p, stated(&p.as_stated())));
    let (mut name, mut clauses) = (String::new(), Vec::new());
    for (p, clause) in moving.chain(idle).filter(|(p, _)| p.group == group) {
        name.clone_from(&p.group_name);
        clauses.push(clause);
    }
    let NodeGroup { nodes, handles: own, .. } = &base.moves.groups[group];
    let nodes = positions(base, layout, own, nodes);
    let mut out = Table::new();
    out.insert("moves".into(), clauses.join("; ").into());
    if let Some(marker) = base.plan.markers.groups.iter().find(|g| g.name == name) {
        out.insert("marker".into(), marked::marker_words(&base.plan, marker).into());
    }
    out.insert("name".into(), name.into());
    match handles(base, group) {
        Some(handles) => out.insert("handles".into(), handles.into()),
        None => out.insert("nodes".into(), points(&nodes).into()),
    };
    out
}

/// The elements of a building that a group moves, where their ids name nothing else: what merely shares a corner with
/// them stays in the next round too.
fn handles(base: &Understood, group: usize) -> Option<Vec<String>> {
    let walls = &base.plan.walls;
    if base.plan.format == Format::Dxf {
        return None;
    }
    let slots = &base.moves.groups[group].slots;
    if !slots.is_empty() {
        return slots.iter().map(|s| base.plan.slots[*s].source.handle.clone()).collect();
    }
    let own: BTreeSet<usize> =
        base.moves.groups[group].handles.iter().map(|h| walls[h.0 as usize].source.record).collect();
    let named = walls.iter().filter(|w| own.contains(&w.source.record)).map(|w| w.source.handle.clone());
    let handles: BTreeSet<String> = named.collect::<Option<_>>()?;
    let is_named = |w: &&Wall| w.source.handle.as_ref().is_some_and(|h| handles.contains(h));
    let are_own = walls.iter().filter(is_named).all(|w| own.contains(&w.source.record));
    are_own.then(|| handles.into_iter().collect())
}

/// What a bound is rounded to, in its own unit, as a number of decimals: a micrometre or less of a shift, what takes a corner
/// 50 m away no farther than that in a turn or a scaling.
fn finest(c: &Clause) -> i32 {
    const SHIFT_M: f64 = 1e-6;
    const SHARE: f64 = 2e-8;
    let step = if matches!(c.kind, Kind::Rotate(_) | Kind::Scale(_)) { SHARE } else { SHIFT_M };
    (c.si_per_unit / step).log10().ceil().clamp(0.0, DECIMALS_MAX) as i32
}

/// Decimals beyond which no number of a drawing says anything.
const DECIMALS_MAX: f64 = 12.0;

/// The number of so many decimals that is nearest, never −0.
fn shortest(value: f64, decimals: i32) -> f64 {
    let by = 10_f64.powi(decimals);
    (value * by).round() / by + 0.0
}

/// A clause with the bounds that it has.
fn stated(c: &Clause) -> String {
    clause(c, c.kind.identity())
}

/// The clause with the bounds that are left once `value` is the new zero.
fn clause(c: &Clause, value: f64) -> String {
    let identity = c.kind.identity();
    let left = |bound: f64| {
        let left = if matches!(c.kind, Kind::Scale(_)) { bound / value } else { bound - value };
        shortest(left, finest(c))
    };
    let (low, high) = (left(c.lower).min(identity), left(c.upper).max(identity));
    let about = |at: Option<glam::DVec2>| at.map_or(String::new(), |p| format!(" about {},{}", p.x, p.y));
    let named = unit_by_name(&c.unit).is_some();
    let unit = if named { c.unit.as_str() } else { "" };
    match c.kind {
        Kind::X => format!("x {low}{unit} {high}{unit}"),
        Kind::Y => format!("y {low}{unit} {high}{unit}"),
        Kind::Along(rad) => format!("along {} {low}{unit} {high}{unit}", rad.to_degrees()),
        Kind::Rotate(at) => format!("rotate {low} {high}{}", about(at)),
        Kind::Scale(at) => format!("scale {low} {high}{}", about(at)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is left of the bounds is written short, and read back as what it was to a micrometre.
    #[test]
    fn bounds_are_written_as_short_as_they_are() {
        let of = |kind, unit: &str, si_per_unit, [lower, upper]: [f64; 2], value| {
            super::clause(&Clause { kind, lower, upper, unit: unit.into(), si_per_unit }, value)
        };
        assert_eq!(of(Kind::X, "m", 1.0, [-1.2, 1.2], -1.0), "x -0.2m 2.2m");
        assert_eq!(of(Kind::X, "m", 1.0, [-1.2, 1.2], 0.1234567891), "x -1.323457m 1.076543m");
        assert_eq!(of(Kind::Y, "mm", 0.001, [-300.0, 300.0], 299.9999999), "y -600mm 0mm");
        assert_eq!(of(Kind::X, "ft", 0.3048, [-1.0, 1.0], 0.7), "x -1.7ft 0.3ft");
        let degree = 1.0_f64.to_radians();
        assert_eq!(of(Kind::Rotate(None), "deg", degree, [-15.0, 15.0], 4.9), "rotate -19.9 10.1");
        assert_eq!(of(Kind::Scale(None), "", 1.0, [0.8, 1.2], 1.1), "scale 0.72727273 1.09090909");
    }
}
