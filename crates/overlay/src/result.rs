//! `result.json`, `analyse --json` and `check --json`: the shapes that plugins and scripts rely on.
//!
//! Fields are written in the order of declaration and numbers in their shortest form that reads back
//! the same. A number that does not exist (not finite) is `null`. Lengths are metres, areas square
//! metres, angles radians, entropy bits; parameters are in the unit named by their move.

use std::collections::BTreeMap;

pub use enfilade_brief::Sense;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::built::OptionWork;
pub use super::element::ElementRef;
pub use super::front::FrontPoint;
pub use super::gain::{Gain, Gains, Interval, Numbers};
use super::measure::counts_cells;

/// `schema` of a [`RoundResult`].
pub const RESULT_SCHEMA: &str = "enfilade.result/1";
/// `schema` of an [`AnalysisResult`].
pub const ANALYSIS_SCHEMA: &str = "enfilade.analysis/1";
/// `schema` of a [`CheckResult`].
pub const CHECK_SCHEMA: &str = "enfilade.check/2";

/// What was read.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Path as the user would name it.
    pub path: String,
    /// Digest of the bytes, lower-case hexadecimal.
    pub sha256: String,
    /// Digest of the drawing without the time at which it was written: another save of it has the same.
    #[serde(default)]
    pub content: String,
    /// `dxf`, `ifc`, `gltf`, `glb`.
    pub format: String,
    /// Name of the length unit used.
    pub unit: String,
    /// Why that unit.
    pub unit_reason: String,
    /// Where the file says that north is: degrees anticlockwise from the plan's up; absent where that is up.
    #[serde(default, skip_serializing_if = "is_up")]
    pub north_deg: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_up(north_deg: &f64) -> bool {
    *north_deg == 0.0
}

impl Input {
    /// Its file as a command takes it: without folders, in quotation marks where a space stands in its name.
    pub fn argument(&self) -> String {
        let file = self.path.rsplit(['/', '\\']).next().unwrap_or_default();
        let quote = if file.contains(char::is_whitespace) { "\"" } else { "" };
        format!("{quote}{file}{quote}")
    }
}

/// How much there is of what.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Vertices of the visibility graph.
    pub vertices: u64,
    /// Those in the region of query.
    pub query: u64,
    /// Of these, those that a wall which may move covers now: they have no value and count in no mean.
    #[serde(default)]
    pub covered: u64,
    /// Those in the region of reference.
    pub reference: u64,
    /// Edges of the visibility graph, each pair once.
    pub edges: u64,
    /// Walls of the plan.
    pub walls: u64,
}

/// What a layout is worth.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Means over the query region by name: `degree`, `depth`, `entropy`, …
    pub mean: Numbers,
    /// Penalties by name: `clearance_m2`, `wall_length_m`, `disconnection`, …
    pub penalty: Numbers,
}

/// Along what a move moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum MoveKind {
    /// Shift to the east.
    X,
    /// Shift to the north.
    Y,
    /// Shift along a direction.
    Along,
    /// Turn, anticlockwise.
    Rotate,
    /// Scale about a point; 1 is the drawing as it is.
    Scale,
}

impl MoveKind {
    /// As in result.json.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Along => "along",
            Self::Rotate => "rotate",
            Self::Scale => "scale",
        }
    }

    /// The value that leaves the drawing as it is.
    pub fn identity(self) -> f64 {
        if self == Self::Scale { 1.0 } else { 0.0 }
    }
}

/// One clause of one group.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoveEntry {
    /// Name of the group, as the user gave it or as we counted it.
    pub name: String,
    /// What it does.
    pub kind: MoveKind,
    /// Lower bound, in `unit`.
    pub lower: f64,
    /// Upper bound, in `unit`.
    pub upper: f64,
    /// Unit of parameter and bounds: a length unit, `deg` or `rad` for a turn, empty for a scale.
    pub unit: String,
    /// Direction of an `along` move, degrees anticlockwise from east.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// What moves.
    pub elements: Vec<ElementRef>,
    /// Mark of the corners that move: another one where others move.
    #[serde(default)]
    pub geometry: String,
}

/// How one element stands otherwise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Which element.
    pub element: ElementRef,
    /// The element's id in the program that wrote the file: of an IFC its `Tag`, else its `GlobalId`; of a node of a glTF its
    /// name where that is a `GlobalId`; of a DXF where a plugin gave one.
    pub host_id: Option<String>,
    /// Axis points before, metres, drawing frame.
    pub from: Vec<[f64; 2]>,
    /// Axis points after.
    pub to: Vec<[f64; 2]>,
    /// Whether it goes with its wall, as hosts carry it along by themselves: a door, a window, a filled area.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub follows: bool,
}

/// One member of the diverse set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Candidate {
    /// File, relative to the round.
    pub file: String,
    /// `parameters[i]` belongs to `moves[i]`.
    pub parameters: Vec<f64>,
    /// Means of the measures.
    pub mean: Numbers,
    /// Penalties.
    pub penalty: Numbers,
    /// The composite score, where one was asked for.
    pub score: Option<f64>,
    /// Confirmed gains; empty where nothing was confirmed (`run --raw`).
    #[serde(default, skip_serializing_if = "Gains::is_empty")]
    pub gain: Gains,
    /// Whether it stays because somebody pinned it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub pinned: bool,
    /// Whether every threshold is met.
    pub within_threshold: bool,
    /// What moved and what it gains, in plain words.
    pub words: String,
    /// Which moves bring the gain, what else there is to know about it.
    #[serde(default)]
    pub explanation: Explanation,
    /// Every element that stands otherwise.
    pub changes: Vec<Change>,
    /// The building works of it, beside the moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub works: Vec<OptionWork>,
    /// What it has of the brief of rooms, read again from its file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub brief: Vec<super::brief_item::BriefItem>,
}

/// Why an option is good and how it differs. Distances are `dn` of the spec.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Explanation {
    /// What of the limits and rules a pinned option breaks, in words; no other option breaks any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub breaks: Vec<String>,
    /// The moves without which most of the gain is lost, those first.
    pub parts: Vec<Part>,
    /// Distance from the present layout.
    pub from_present: f64,
    /// Number, from 1, of the option that is most alike.
    pub nearest: Option<usize>,
    /// Distance from it.
    pub from_nearest: Option<f64>,
    /// For every objective the share of the best gain found that this option keeps.
    pub kept: Numbers,
}

/// What one move is worth in an option.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Name of the group; of linked groups the leader's.
    pub name: String,
    /// Groups that move with it, itself included.
    pub groups: u64,
    /// Share of the option's gain that is lost when this move alone is taken back.
    pub lost: f64,
}

/// The best layout found, with all its moves.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// File, relative to the round.
    #[serde(default)]
    pub file: String,
    /// `parameters[i]` belongs to `moves[i]`.
    pub parameters: Vec<f64>,
    /// Means of the measures.
    pub mean: Numbers,
    /// Penalties.
    pub penalty: Numbers,
    /// The composite score.
    pub score: Option<f64>,
    /// Confirmed gains; empty where nothing was confirmed.
    #[serde(default, skip_serializing_if = "Gains::is_empty")]
    pub gain: Gains,
    /// What moved and what it gains, in plain words.
    #[serde(default)]
    pub words: String,
    /// Which option it is, from 1; `null` where it is none.
    pub option: Option<usize>,
    /// Every element that stands otherwise.
    #[serde(default)]
    pub changes: Vec<Change>,
}

/// How far apart the members stand (`dn` of the spec).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Diversity {
    /// Smallest distance between two members.
    pub min_distance: Option<f64>,
    /// Mean distance over all pairs.
    pub mean_distance: Option<f64>,
    /// How alike they are to the people in them: the median correlation of their maps of change (what is seen, steps), −1 to 1.
    #[serde(default)]
    pub likeness: Option<f64>,
}

/// One objective with its threshold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Objective {
    /// Name of a measure, or `score`, or `penalty`.
    pub name: String,
    /// What is wanted.
    pub sense: Sense,
    /// z: the share of the reachable gain that a member must keep.
    pub threshold: f64,
    /// Value of the present layout.
    pub initial: f64,
    /// Best value of all layouts that keep the hard limits; `null` where none does.
    pub best: Option<f64>,
    /// What `threshold` is a share of: the best value of those that keep the thresholds of the objectives before this
    /// one too; unless thresholds are firm, as known when options began to differ and with thresholds as asked. `null`
    /// where none does.
    #[serde(default)]
    pub reachable: Option<f64>,
    /// The value members must not fall short of; `null` where nothing is reachable.
    pub limit: Option<f64>,
    /// Of `penalty`: a sum up to this counts as none, since written coordinates are rounded. Absent for others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free: Option<f64>,
}

impl Objective {
    /// Whether a value keeps the limit; so does any where there is none.
    pub fn keeps(&self, value: f64) -> bool {
        self.limit.is_none_or(|limit| if self.sense == Sense::Max { value >= limit } else { value <= limit })
    }

    /// The limit that some values keep too; `None` where there is none.
    pub fn limit_with(&self, values: impl Iterator<Item = f64>) -> Option<f64> {
        let worse = |a: f64, b: f64| if self.sense == Sense::Max { a.min(b) } else { a.max(b) };
        self.limit.map(|limit| values.fold(limit, worse))
    }
}

/// An earlier round of the same drawing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LineageEntry {
    /// File the round started from.
    pub drawing: String,
    /// Its number, from 1; of the best so far of a stopped search the number that its round would have had.
    pub round: u64,
    /// Whether it was no finished round but the best so far; absent otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub so_far: bool,
    /// Whether it was measured with another spacing or other regions than this round: not to be compared. Absent
    /// otherwise.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub other_ruler: bool,
    /// Which candidate the user accepted, 0 for the best layout; `null` for the first drawing.
    pub candidate: Option<u64>,
    /// Which point of its front was accepted instead; absent where none was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<u64>,
    /// Means of the layout the round started from.
    pub mean: Numbers,
    /// Its score, where one was asked for.
    pub score: Option<f64>,
}

/// A [`enfilade_report::Problem`] that can be read back.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProblemEntry {
    /// Stable identifier.
    pub code: String,
    /// `info`, `warning` or `error`.
    pub severity: String,
    /// `plan.dxf:1842 LWPOLYLINE 2F3 layer A-WALL`.
    pub place: String,
    /// What was found, what was expected, what was done.
    pub text: String,
}

impl From<&enfilade_report::Problem> for ProblemEntry {
    fn from(p: &enfilade_report::Problem) -> Self {
        let severity = match p.severity {
            enfilade_report::Severity::Info => "info",
            enfilade_report::Severity::Warning => "warning",
            enfilade_report::Severity::Error => "error",
        };
        Self {
            code: p.code.to_owned(),
            severity: severity.to_owned(),
            place: p.place.to_string(),
            text: enfilade_report::short_numbers(&p.text).into_owned(),
        }
    }
}

impl RoundResult {
    /// A mean in the unit in which people are told it: cells as area, m².
    pub fn told(&self, key: &str, mean: f64) -> f64 {
        if counts_cells(key) { mean * self.spacing_m * self.spacing_m } else { mean }
    }
}

/// `result.json` of one round.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoundResult {
    /// [`RESULT_SCHEMA`].
    pub schema: String,
    /// Of the program that wrote this, with its commit.
    #[serde(default)]
    pub version: String,
    /// What was read.
    pub input: Input,
    /// Everything that decides the outcome, seed included.
    pub settings: Map<String, Value>,
    /// How much there is of what.
    pub counts: Counts,
    /// Lattice spacing, metres.
    pub spacing_m: f64,
    /// Centre of some cell, metres, drawing frame.
    pub lattice_centre: [f64; 2],
    /// The present layout.
    pub initial: Layout,
    /// One entry a clause, groups in the order of their boxes in the file.
    pub moves: Vec<MoveEntry>,
    /// The objectives in order.
    #[serde(default)]
    pub objectives: Vec<Objective>,
    /// The diverse set, pinned ones first, then the best first.
    pub candidates: Vec<Candidate>,
    /// The best layout found.
    #[serde(default)]
    pub best: Option<Best>,
    /// How far apart they stand.
    pub diversity: Diversity,
    /// Layouts measured.
    pub evaluations: u64,
    /// Time taken.
    pub seconds: f64,
    /// Why the search ended.
    pub stopped_by: String,
    /// Earlier rounds, oldest first.
    #[serde(default)]
    pub lineage: Vec<LineageEntry>,
    /// What was left out or assumed.
    pub problems: Vec<ProblemEntry>,
    /// What a person should decide about how the drawing is read, least certain first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub questions: Vec<super::reading::QuestionEntry>,
    /// The brief of rooms, checked for the present layout.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub brief: Vec<super::brief_item::BriefItem>,
    /// What works together bring for what they cost, the cheapest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub front: Vec<FrontPoint>,
}

impl RoundResult {
    /// How many of the first options were pinned.
    pub fn pinned_count(&self) -> usize {
        self.candidates.iter().take_while(|c| c.pinned).count()
    }

    /// What there is to say of the option at `i` before its words, in brackets behind its number; else empty.
    pub fn mark(&self, i: usize) -> &'static str {
        let Some(option) = self.candidates.get(i) else { return "" };
        match (i < self.pinned_count(), option.explanation.breaks.is_empty(), option.within_threshold) {
            (_, false, _) => " (pinned; breaks a rule)",
            (true, true, false) => " (pinned; below a threshold)",
            (true, true, true) => " (pinned)",
            (false, true, false) => " (below a threshold)",
            (false, true, true) => "",
        }
    }
}

/// `analyse --json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AnalysisResult {
    /// [`ANALYSIS_SCHEMA`].
    pub schema: String,
    /// Of the program that wrote this, with its commit.
    #[serde(default)]
    pub version: String,
    /// What was read.
    pub input: Input,
    /// Lattice spacing, metres.
    pub spacing_m: f64,
    /// Centre of some cell, metres, drawing frame.
    pub lattice_centre: [f64; 2],
    /// How much there is of what.
    pub counts: Counts,
    /// Means over the query region.
    pub mean: Numbers,
    /// Means over the query region of the columns that were asked for, by their names.
    #[serde(default, skip_serializing_if = "Numbers::is_empty")]
    pub columns: Numbers,
    /// From how many breadth-first trees depth and entropy are estimated, where not from all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_from_roots: Option<u64>,
    /// Half the widths of the 95 % confidence intervals of the means that are estimated.
    #[serde(default, skip_serializing_if = "Numbers::is_empty")]
    pub mean_ci95: Numbers,
    /// Means over several shifted lattices with their 95 % intervals, by the names in `mean`: what holds beyond the one
    /// lattice of `mean`. Absent for floors of very many or very few cells, and with roots.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub estimate: BTreeMap<String, Interval>,
    /// Penalties of the layout.
    pub penalty: Numbers,
    /// What steps reach over the stairs, where they are counted so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub over_stairs: Option<OverStairs>,
    /// Every storey of a building that has several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub storeys: Vec<StoreyEntry>,
    /// What was left out or assumed.
    pub problems: Vec<ProblemEntry>,
}

/// Other storeys that steps lead to over the stairs of the measured one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OverStairs {
    /// Stairs of the measured storey that lead there.
    pub stairs: u64,
    /// The storeys, as `--storey` names them, from the lowest.
    pub storeys: Vec<String>,
    /// Cells that are counted there.
    pub cells: u64,
}

/// One storey of a building that has several.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StoreyEntry {
    /// Its name, as `--storey` takes it.
    pub name: String,
    /// The building that it belongs to, where the file has storeys of several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building: Option<String>,
    /// Height of its floor, metres.
    pub floor_m: f64,
    /// Folder of its files beside the result: `.` for the storey the result is about, none where nothing
    /// could be measured.
    pub folder: Option<String>,
    /// Walls cut.
    pub walls: u64,
    /// Doors and windows cut.
    pub openings: u64,
    /// Columns understood of what is cut.
    pub columns: u64,
    /// Means over its region of query; empty where it was not measured.
    pub mean: Numbers,
    /// Why nothing could be measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
    /// What was left out of this storey, where the result is about another one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub problems: Vec<ProblemEntry>,
}

/// Elements of a whole building by the classes of its file, subtypes counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct BuildingEntry {
    /// Storeys.
    pub storeys: u64,
    /// Walls.
    pub walls: u64,
    /// Columns.
    pub columns: u64,
    /// Doors.
    pub doors: u64,
    /// Windows.
    pub windows: u64,
    /// Spaces.
    pub spaces: u64,
}

/// A length unit and why it was taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitEntry {
    /// `mm`, `m`, `ft`, …
    pub name: String,
    /// Metres in one unit.
    pub metres: f64,
    /// Why.
    pub reason: String,
}

/// How a CAD layer was taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LayerEntry {
    /// Name.
    pub name: String,
    /// Entities on it; of a building its elements.
    pub entities: u64,
    /// `wall`, `marker`, `ignored`, …
    pub taken_as: String,
    /// Why.
    pub reason: String,
}

/// A region as understood.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RegionEntry {
    /// `query`, `reference`, `keep`.
    pub kind: String,
    /// Area, m².
    pub area_m2: f64,
    /// Where it was drawn; empty for the interior.
    pub place: String,
    /// The named pair it belongs to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<String>,
}

/// `check --json`: what the program understood.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CheckResult {
    /// [`CHECK_SCHEMA`].
    pub schema: String,
    /// Name of the file.
    pub file: String,
    /// Format.
    pub format: String,
    /// Version in the format's words.
    pub version: String,
    /// Unit and why.
    pub unit: UnitEntry,
    /// Elements that draw walls, as `wall_elements`: the two faces of a wall may be two of them.
    pub walls: u64,
    /// Elements that draw walls.
    #[serde(default)]
    pub wall_elements: u64,
    /// Walls understood from them, from joint to joint, as `statements` counts them.
    #[serde(default)]
    pub walls_understood: u64,
    /// Openings found: doors, windows and passages.
    pub openings: u64,
    /// Doors among them.
    pub doors: u64,
    /// Windows among them.
    pub windows: u64,
    /// Columns understood, as `statements` counts them.
    pub columns: u64,
    /// Elements whose outline is solid, among `wall_elements`.
    #[serde(default)]
    pub solids: u64,
    /// Regions.
    pub regions: Vec<RegionEntry>,
    /// Moves.
    pub moves: Vec<MoveEntry>,
    /// Every layer.
    pub layers: Vec<LayerEntry>,
    /// What the walls were understood as, in plain words.
    pub statements: Vec<String>,
    /// What the whole building has, where its file says so: all storeys, seen or not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub building: Option<BuildingEntry>,
    /// Every storey of a building that has several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub storeys: Vec<StoreyEntry>,
    /// What was left out or assumed.
    pub problems: Vec<ProblemEntry>,
    /// What everything is taken for, of the storey that the result is about.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reading: Option<super::reading::Reading>,
}

/// Numbers and points in one line, everything else indented, and a final newline.
///
/// # Errors
/// None for the types of this module; the signature is serde's.
pub fn to_json<T: Serialize>(value: &T) -> Result<String, enfilade_report::Error> {
    let fail = |e: serde_json::Error| {
        enfilade_report::Error::environment("json", enfilade_report::Place::default(), e.to_string())
    };
    let mut text = String::new();
    write_indented(&serde_json::to_value(value).map_err(fail)?, 0, &mut text);
    text.push('\n');
    Ok(text)
}

fn write_indented(value: &Value, depth: usize, out: &mut String) {
    let new_line = |out: &mut String, depth: usize| {
        out.push('\n');
        out.extend(std::iter::repeat_n("  ", depth));
    };
    match value {
        Value::Array(items) if !items.iter().all(is_point_like) => {
            for (i, item) in items.iter().enumerate() {
                out.push(if i == 0 { '[' } else { ',' });
                new_line(out, depth + 1);
                write_indented(item, depth + 1, out);
            }
            new_line(out, depth);
            out.push(']');
        }
        Value::Object(map) if !map.is_empty() => {
            for (i, (name, item)) in map.iter().enumerate() {
                out.push(if i == 0 { '{' } else { ',' });
                new_line(out, depth + 1);
                out.push_str(&Value::from(name.as_str()).to_string());
                out.push_str(": ");
                write_indented(item, depth + 1, out);
            }
            new_line(out, depth);
            out.push('}');
        }
        flat => out.push_str(&flat.to_string()),
    }
}

/// A scalar, or an array of scalars: what is written in one line.
fn is_point_like(value: &Value) -> bool {
    match value {
        Value::Array(items) => items.iter().all(|v| !v.is_array() && !v.is_object()),
        Value::Object(_) => false,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_stand_in_one_line_and_entries_below_each_other() {
        let value = serde_json::json!({"a": [[1.5, -2.0], [0.1, 3.0]], "b": [{"c": null}, {}], "d \"": []});
        let text = to_json(&value).unwrap();
        assert_eq!(
            text,
            "{\n  \"a\": [[1.5,-2.0],[0.1,3.0]],\n  \"b\": [\n    {\n      \"c\": null\n    },\n    {}\n  ],\n  \"d \\\"\": []\n}\n"
        );
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
    }

    #[test]
    fn numbers_keep_their_order_and_their_last_bit() {
        let numbers = Numbers::of([("z", 0.1 + 0.2), ("a", f64::NAN), ("m", 1e-300)]);
        let text = to_json(&numbers).unwrap();
        assert_eq!(text, "{\n  \"z\": 0.30000000000000004,\n  \"a\": null,\n  \"m\": 1e-300\n}\n");
        let back: Numbers = serde_json::from_str(&text).unwrap();
        assert_eq!((back.get("z"), back.get("m")), (Some(0.1 + 0.2), Some(1e-300)));
        assert!(back.get("a").unwrap().is_nan());
    }

    #[test]
    fn elements_are_told_apart_by_their_fields() {
        let elements = [
            ElementRef::Dxf { handle: None, record: 7 },
            ElementRef::Ifc { global_id: "2O2Fr".to_owned(), id: 4711 },
            ElementRef::Gltf { path: "/nodes/3".to_owned() },
        ];
        for element in elements {
            let text = to_json(&element).unwrap();
            assert_eq!(serde_json::from_str::<ElementRef>(&text).unwrap(), element, "{text}");
        }
    }
}
