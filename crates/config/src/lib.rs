//! Settings: plain validated data, every number with its unit, one table of defaults.
//!
//! The same keys stand on the command line, in `<drawing>.enfilade.toml` and in `enfilade.toml` of the
//! folder; the first of them that names a key wins. Unknown keys are errors with line and column.
//!
//! ```
//! use enfilade_config::{Partial, Settings};
//!
//! let asked = Partial::from_toml("flat.enfilade.toml", "spacing = 0.25\nmembers = 3\n")?;
//! let usual = Partial::from_toml("enfilade.toml", "members = 8\nseed = 7\n")?;
//! let settings = Settings::new(asked.over(usual))?;
//! assert_eq!((settings.spacing_m, settings.members, settings.seed), (Some(0.25), 3, 7));
//! # Ok::<(), enfilade_report::Error>(())
//! ```

mod beside;
mod budget;
mod choices;
mod control;
mod files;
mod named;
mod pair;
mod reading;
mod rooms;
mod tables;
mod terms;
#[cfg(test)]
mod tests;
mod version;
mod watching;
mod wording;

use serde::{Deserialize, Serialize};

pub use beside::{Beside, Twin};
pub use budget::Budget;
pub use choices::{Allow, Colours, Overlay, Thresholds, Unsure};
pub use control::{Aggregate, Aim, Bound, Follow, Held, Limit, Link, Snap};
use enfilade_brief::WorkKind;
pub use enfilade_brief::{Measure, Method, Mode, Source};
use enfilade_report::{Error, Place, counted};
pub use files::{is_settings, settings_files, unread_side_cars};
pub use pair::{PAIR_NAME_BYTES, PairName};
pub use reading::{ReadingTable, RoomText, SelectorText, ViewText, for_folder};
pub use rooms::{BriefTable, BriefText};
pub use tables::{KnownMove, LineageTable, MoveTable, PinnedOption, PinnedWork, RegionTable, WorkTable};
use terms::{objectives, penalties, score_terms};
pub use version::{SETTINGS_VERSION, VERSION};
pub use watching::{DEPTH_MAX, JOB_SECS, WatchTable};

/// Members of the diverse set by default (paper: n = 5).
pub const MEMBERS_DEFAULT: usize = 5;
/// Most members of one set: the architect looks at every one.
pub const MEMBERS_MAX: usize = 50;
/// Most layouts asked for at once: as many fill a graphics card, and more learn too late from each other.
pub const TOGETHER_MAX: usize = 64;
/// Threshold z of every default objective.
pub const THRESHOLD_DEFAULT: f64 = 0.7;
/// Smallest distance of two members as a fraction of √n_p (spec 6).
pub const D_MIN_DEFAULT: f64 = 0.2;
/// Spacings that can be asked for, metres.
pub const SPACING_M: [f64; 2] = [0.001, 1000.0];
/// Farthest centre of a cell, metres: as far as coordinates of drawings go.
pub const LATTICE_CENTRE_MAX_M: f64 = 1e9;
/// Most evaluations of one study.
pub const EVALUATIONS_MAX: u64 = 100_000_000;
/// How often what was found so far may be written, seconds: a round takes about one to write.
pub const WRITE_EVERY_SECS: [f64; 2] = [1.0, 1e6];
/// Most threads.
pub const THREADS_MAX: usize = 1024;

/// At which height sight lines run (spec 1, openings).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// Windows are seen through.
    #[default]
    Eye,
    /// Windows block.
    Knee,
}

/// What computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Backend {
    /// The fastest there is.
    #[default]
    Auto,
    /// All cores.
    Cpu,
    /// The graphics card.
    Gpu,
}

/// Pictures are drawn where nobody says otherwise.
fn drawn() -> bool {
    true
}

/// One objective with its threshold (spec 7).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectiveSetting {
    /// What is measured.
    pub measure: Aim,
    /// Whether more is better.
    pub is_max: bool,
    /// z in [0, 1].
    pub threshold: f64,
}

/// A penalty of spec 5.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Penalty {
    /// clr², m⁴.
    Clearance,
    /// |S(new) − S(initial)|, m.
    WallLength,
    /// Mean squared angle to the main directions, rad².
    Alignment,
    /// Walls that cross now and did not.
    Overlap,
    /// Passages that have become too narrow, m.
    Passage,
    /// Floor that rooms have lost, m².
    RoomArea,
}

impl Penalty {
    /// Every penalty.
    pub const ALL: [Self; 6] =
        [Self::Clearance, Self::WallLength, Self::Alignment, Self::Overlap, Self::Passage, Self::RoomArea];

    /// Name as in settings and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clearance => "clearance",
            Self::WallLength => "wall-length",
            Self::Alignment => "alignment",
            Self::Overlap => "overlap",
            Self::Passage => "passage",
            Self::RoomArea => "room-area",
        }
    }
}

/// What one source of settings says; everything may be missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[allow(missing_docs)] // the keys are those of the command line, explained there and in `enfilade init`
pub struct Partial {
    pub unit: Option<String>,
    pub wall_layer: Option<Vec<String>>,
    pub query_layer: Option<String>,
    pub reference_layer: Option<String>,
    pub view: Option<String>,
    pub level: Option<Level>,
    pub spacing: Option<f64>,
    pub lattice_centre: Option<[f64; 2]>,
    pub seed_point: Option<Vec<[f64; 2]>>,
    pub backend: Option<Backend>,
    pub threads: Option<usize>,
    pub out: Option<String>,
    pub seed: Option<u64>,
    pub evaluations: Option<u64>,
    pub seconds: Option<f64>,
    pub write_every: Option<f64>,
    pub members: Option<usize>,
    pub mode: Option<Mode>,
    pub method: Option<Method>,
    pub objective: Option<String>,
    pub thresholds: Option<Thresholds>,
    pub unsure: Option<Unsure>,
    pub score: Option<String>,
    pub penalty: Option<String>,
    pub distance: Option<f64>,
    pub limit: Option<String>,
    pub link: Option<Vec<String>>,
    pub snap: Option<String>,
    pub most_moves: Option<usize>,
    pub only_marked: Option<bool>,
    pub allow: Option<String>,
    pub budget: Option<String>,
    pub brief: Option<BriefText>,
    pub least_gain: Option<String>,
    pub raw: Option<bool>,
    pub until_converged: Option<bool>,
    pub together: Option<usize>,
    pub pin: Option<Vec<Vec<f64>>>,
    pub like: Option<Vec<f64>>,
    pub warm: Option<Vec<Vec<f64>>>,
    pub colours: Option<Colours>,
    pub overlay: Option<Overlay>,
    pub pictures: Option<bool>,
    pub storey: Option<String>,
    /// Whether steps are counted over the stairs to the other storeys of the building.
    pub over_stairs: Option<bool>,
    /// The storey that moves, regions, works and pins belong to: on others they are not used.
    pub of_storey: Option<String>,
    pub query: Option<String>,
    pub accept_missing_eof: Option<bool>,
    pub ignore_move_markers: Option<bool>,
    #[serde(rename = "move", default)]
    pub moves: Vec<MoveTable>,
    #[serde(rename = "region", default)]
    pub regions: Vec<RegionTable>,
    #[serde(rename = "work", default)]
    pub works: Vec<WorkTable>,
    #[serde(default)]
    pub lineage: Vec<LineageTable>,
    /// Options that build and stay.
    #[serde(rename = "pin-option", default)]
    pub pin_options: Vec<PinnedOption>,
    /// The moves that the numbers of `pin`, `pin-option` and `like` belong to.
    #[serde(rename = "pin-move", default)]
    pub pin_moves: Vec<KnownMove>,
    /// Those of `warm`.
    #[serde(rename = "warm-move", default)]
    pub warm_moves: Vec<KnownMove>,
    /// Corrections; a unit and a view that stand there move to `unit` and `view`.
    #[serde(default, skip_serializing_if = "ReadingTable::is_empty")]
    pub reading: ReadingTable,
    #[serde(default)]
    pub watch: Option<WatchTable>,
    /// Belongs to the plugin that wrote it.
    #[serde(default)]
    pub host: Option<toml::Table>,
    /// Version of the file; newer ones are refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub version: Option<u64>,
}

impl Partial {
    /// Reads a settings file. `name` is shown in errors.
    ///
    /// # Errors
    /// [`Error::Usage`] with line and column.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, Error> {
        version::is_known(name, text)?;
        let mut read: Self = toml::from_str(text).map_err(|e| {
            let place =
                e.span().map_or_else(|| Place::file(name), |s| reading::place_in(name, text, s.start));
            let said = wording::plain(e.message());
            let key =
                e.span().filter(|_| said == "duplicate key").and_then(|s| wording::key_at(text, s.start));
            let said = key.map_or(said, |key| format!("`{key}` is set twice, expected once"));
            Error::usage("settings", place, format!("{said}; nothing of this file was used"))
        })?;
        read.version = None;
        read.unit = read.reading.unit.take().or(read.unit);
        read.view = read.reading.view.take().map(|v| v.to_string()).or(read.view);
        read.is_sound_alone(name, text)?;
        Ok(read)
    }

    /// What no other source can mend, with its place. How many options are pinned is right or wrong only
    /// beside the members wanted, which another source may say.
    fn is_sound_alone(&self, name: &str, text: &str) -> Result<(), Error> {
        let Err(Error::Usage(problem)) =
            Settings::new(Self { pin: None, pin_options: Vec::new(), ..self.clone() })
        else {
            return Ok(());
        };
        let line = problem.text.split(':').next().and_then(|key| wording::line_of_key(text, key));
        Err(Error::usage("settings", Place { line, ..Place::file(name) }, problem.text))
    }

    /// What decides a result: without what tells only where, how fast and by whom it is made.
    pub fn deciding(self) -> Self {
        Self { threads: None, backend: None, out: None, write_every: None, watch: None, host: None, ..self }
    }

    /// This source, with `base` where it says nothing.
    pub fn over(self, base: Self) -> Self {
        // Moves go with the numbers that belong to them.
        let pins = self.pin.is_some() || self.like.is_some() || !self.pin_options.is_empty();
        let pin_moves = if pins { self.pin_moves } else { base.pin_moves };
        let (pin, pin_options) = match self.pin_options.is_empty() {
            true if pins => (self.pin.or(base.pin), Vec::new()),
            true => (base.pin, base.pin_options),
            false => (self.pin, self.pin_options),
        };
        let warm_moves = if self.warm.is_some() { self.warm_moves } else { base.warm_moves };
        let tables = |mine: Vec<_>, theirs| if mine.is_empty() { theirs } else { mine };
        let is_other = matches!((&self.storey, &base.storey), (Some(own), Some(other)) if own != other);
        let of_base = base.of_storey.or_else(|| base.storey.clone().filter(|_| is_other));
        let of_storey = self.of_storey.or(of_base);
        Self {
            version: None,
            unit: self.unit.or(base.unit),
            wall_layer: self.wall_layer.or(base.wall_layer),
            query_layer: self.query_layer.or(base.query_layer),
            reference_layer: self.reference_layer.or(base.reference_layer),
            view: self.view.or(base.view),
            level: self.level.or(base.level),
            spacing: self.spacing.or(base.spacing),
            lattice_centre: self.lattice_centre.or(base.lattice_centre),
            seed_point: self.seed_point.or(base.seed_point),
            backend: self.backend.or(base.backend),
            threads: self.threads.or(base.threads),
            out: self.out.or(base.out),
            seed: self.seed.or(base.seed),
            evaluations: self.evaluations.or(base.evaluations),
            seconds: self.seconds.or(base.seconds),
            write_every: self.write_every.or(base.write_every),
            members: self.members.or(base.members),
            mode: self.mode.or(base.mode),
            method: self.method.or(base.method),
            objective: self.objective.or(base.objective),
            thresholds: self.thresholds.or(base.thresholds),
            unsure: self.unsure.or(base.unsure),
            score: self.score.or(base.score),
            penalty: self.penalty.or(base.penalty),
            distance: self.distance.or(base.distance),
            limit: self.limit.or(base.limit),
            link: self.link.or(base.link),
            snap: self.snap.or(base.snap),
            most_moves: self.most_moves.or(base.most_moves),
            only_marked: self.only_marked.or(base.only_marked),
            allow: self.allow.or(base.allow),
            budget: self.budget.or(base.budget),
            brief: self.brief.or(base.brief),
            least_gain: self.least_gain.or(base.least_gain),
            raw: self.raw.or(base.raw),
            until_converged: self.until_converged.or(base.until_converged),
            together: self.together.or(base.together),
            pin,
            like: self.like.or(base.like),
            warm: self.warm.or(base.warm),
            colours: self.colours.or(base.colours),
            overlay: self.overlay.or(base.overlay),
            pictures: self.pictures.or(base.pictures),
            storey: self.storey.or(base.storey),
            over_stairs: self.over_stairs.or(base.over_stairs),
            of_storey,
            query: self.query.or(base.query),
            accept_missing_eof: self.accept_missing_eof.or(base.accept_missing_eof),
            ignore_move_markers: self.ignore_move_markers.or(base.ignore_move_markers),
            moves: tables(self.moves, base.moves),
            regions: if self.regions.is_empty() { base.regions } else { self.regions },
            works: if self.works.is_empty() { base.works } else { self.works },
            lineage: if self.lineage.is_empty() { base.lineage } else { self.lineage },
            pin_options,
            pin_moves,
            warm_moves,
            reading: self.reading.over(base.reading),
            watch: self.watch.or(base.watch),
            host: self.host.or(base.host),
        }
    }
}

/// Validated settings of one job. Everything that decides the outcome, seed included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Unit that overrides the file.
    pub unit: Option<String>,
    /// Layers that carry walls (globs); empty: by their names.
    pub wall_layers: Vec<String>,
    /// Layer of the region of query.
    pub query_layer: Option<String>,
    /// Layer of the region of reference.
    pub reference_layer: Option<String>,
    /// Name or number of the drawing on the sheet, or `all`; `None`: the best plan.
    #[serde(default)]
    pub view: Option<String>,
    /// Height of the sight lines.
    pub level: Level,
    /// Spacing of the lattice; `None`: by the vertex budget.
    pub spacing_m: Option<f64>,
    /// A cell centre, drawing frame; `None`: the drawing's zero point.
    pub lattice_centre_m: Option<[f64; 2]>,
    /// Where a flood starts, drawing units.
    pub seed_points: Vec<[f64; 2]>,
    /// What computes. Never decides the outcome.
    #[serde(skip)]
    pub backend: Backend,
    /// Threads; `None`: all cores. Never decides the outcome.
    #[serde(skip)]
    pub threads: Option<usize>,
    /// Seed of the search.
    pub seed: u64,
    /// Budget in evaluations; `None`: by the size of the study.
    pub evaluations: Option<u64>,
    /// Budget in seconds; with it the outcome depends on the machine.
    pub seconds: Option<f64>,
    /// What was found so far is written this often, seconds; `None`: at the end alone. Never decides the outcome.
    #[serde(skip)]
    pub write_every_secs: Option<f64>,
    /// Members of the diverse set.
    pub members: usize,
    /// A set or one optimum.
    pub mode: Mode,
    /// How the search goes.
    pub method: Method,
    /// Objectives in order, without diversity.
    pub objectives: Vec<ObjectiveSetting>,
    /// Whether their thresholds may be lowered; by default where nobody stated any.
    pub thresholds: Thresholds,
    /// What happens where the reading of the drawing is unsure.
    pub unsure: Unsure,
    /// Weights w_k of `score`.
    pub score: Vec<(Aim, f64)>,
    /// Weights v_j of the penalties.
    pub penalties: Vec<(Penalty, f64)>,
    /// d_min as a fraction of √n_p.
    pub distance: f64,
    /// Hard limits: no option passes them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub limits: Vec<Limit>,
    /// Groups that move together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<Link>,
    /// Modules of shifts and turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub snap: Option<Snap>,
    /// Most groups that an option may move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_moves: Option<usize>,
    /// Whether nothing moves where nothing is marked, instead of the default moves.
    pub only_marked: bool,
    /// What options may do that none does otherwise.
    #[serde(default)]
    pub allow: Allow,
    /// What the building works of an option may cost.
    #[serde(default)]
    pub budget: Budget,
    /// The brief of rooms: items and rule sets as they are written.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub brief: Vec<String>,
    /// An option is shown if it surely gains at least so much in something that is asked for: a share of the present value.
    #[serde(default = "control::least_gain_default")]
    pub least_gain: f64,
    /// The bare problem, for comparisons: the given lattice alone, options by the distance of their parameters, nothing
    /// stripped, rounded or confirmed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub raw: bool,
    /// Whether the search ends when about 95 % of what it would converge to is reached; evaluations and seconds are
    /// then the most that it may take.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub until_converged: bool,
    /// Layouts asked for at once, 1 to [`TOGETHER_MAX`]; none: by what measuring one costs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub together: Option<usize>,
    /// Parameters of options that stay; the others are found unlike them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pinned: Vec<Vec<f64>>,
    /// Parameters of the option near which all are found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub like: Option<Vec<f64>>,
    /// Parameters of layouts worth knowing before the search begins.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warm: Vec<Vec<f64>>,
    /// Options that build and stay, behind those of `pinned`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pinned_options: Vec<PinnedOption>,
    /// The moves that the numbers of `pinned`, `pinned_options` and `like` belong to; empty: those of the drawing.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin_moves: Vec<KnownMove>,
    /// Those of `warm`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warm_moves: Vec<KnownMove>,
    /// Colours of heat maps.
    pub colours: Colours,
    /// Where heat maps, notes and traces are drawn.
    #[serde(default, skip_serializing_if = "Overlay::is_drawn")]
    pub overlay: Overlay,
    /// Whether pictures are drawn beside the numbers.
    #[serde(default = "drawn", skip_serializing_if = "Clone::clone")]
    pub pictures: bool,
    /// Storey of a building; `None`: the one with most walls.
    #[serde(default)]
    pub storey: Option<String>,
    /// Whether steps are counted over the stairs to the other storeys of the building.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub over_stairs: bool,
    /// The storey that moves, regions, works and pins belong to: on others they are not used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub of_storey: Option<String>,
    /// Why moves, regions, works and pins were left out.
    #[serde(skip)]
    pub tables_left: Option<String>,
    /// Spaces that are the region of query: `space:NAME*` or `zone:NAME*`.
    #[serde(default)]
    pub query: Option<String>,
    /// Whether a DXF without its end mark is read.
    pub accept_missing_eof: bool,
    /// Whether `EF-MOVE` in the drawing is left unread (the side-car names the moves).
    pub ignore_move_markers: bool,
    /// Groups named in the side-car.
    pub moves: Vec<MoveTable>,
    /// Regions named in the side-car.
    pub regions: Vec<RegionTable>,
    /// Decided works named in the side-car.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub works: Vec<WorkTable>,
    /// Earlier rounds of an accepted drawing.
    pub lineage: Vec<LineageTable>,
    /// Corrections of how the drawing is read; without unit and view.
    #[serde(default, skip_serializing_if = "ReadingTable::is_empty")]
    pub reading: ReadingTable,
    /// What else is read of files beside the drawing.
    #[serde(skip)]
    pub beside: Beside,
    /// Files beside the drawing that were meant as its settings and are not read: name found, name that is read.
    #[serde(skip)]
    pub unread: Vec<(String, String)>,
    /// Why `storey` was taken, where nobody named it.
    #[serde(skip)]
    pub storey_taken: Option<String>,
}

impl Settings {
    /// Validates; fills in the defaults.
    ///
    /// # Errors
    /// [`Error::Usage`] naming the key, what was found and what is expected.
    pub fn new(p: Partial) -> Result<Self, Error> {
        p.watch.as_ref().map_or(Ok(()), WatchTable::check)?;
        let score = score_terms(p.score.as_deref().unwrap_or("degree +1, depth -1, entropy +1"))?;
        let is_stated = p.objective.is_some();
        let usual = if p.method == Some(Method::Paper) { OBJECTIVES_PAPER } else { OBJECTIVES_DEFAULT };
        let objectives = objectives(p.objective.as_deref().unwrap_or(usual))?;
        let usual = if p.method == Some(Method::Paper) { PENALTY_PAPER } else { PENALTY_DEFAULT };
        let penalties = penalties(p.penalty.as_deref().unwrap_or(usual))?;
        let in_range = |key: &str, v: Option<f64>, lo: f64, hi: f64| match v {
            Some(v) if !(lo..=hi).contains(&v) => {
                Err(bad(key, &v.to_string(), &format!("a number from {lo} to {hi}")))
            }
            _ => Ok(v),
        };
        let count = |key: &str, v: usize, lo: usize, hi: usize| match v {
            v if (lo..=hi).contains(&v) => Ok(v),
            v if hi == usize::MAX => Err(bad(key, &v.to_string(), &format!("a number of {lo} or more"))),
            v => Err(bad(key, &v.to_string(), &format!("a number from {lo} to {hi}"))),
        };
        if let Some(v) = p.evaluations.filter(|v| !(1..=EVALUATIONS_MAX).contains(v)) {
            return Err(bad("evaluations", &v.to_string(), &format!("a number from 1 to {EVALUATIONS_MAX}")));
        }
        let beside = p.pin_options.iter().map(|o| &o.parameters);
        let vectors = p.pin.iter().chain(&p.warm).flatten().chain(&p.like).chain(beside);
        if let Some(v) = vectors.flatten().find(|v| !v.is_finite()) {
            return Err(bad("pin, like, warm", &v.to_string(), "finite parameters"));
        }
        let members = count("members", p.members.unwrap_or(MEMBERS_DEFAULT), 1, MEMBERS_MAX)?;
        let mut pinned: Vec<Vec<f64>> = Vec::new();
        for one in p.pin.into_iter().flatten() {
            // A layout pinned twice is one option; empty ones stand for options not looked up yet.
            if one.is_empty() || !pinned.contains(&one) {
                pinned.push(one);
            }
        }
        let mut pinned_options: Vec<PinnedOption> = Vec::new();
        for one in p.pin_options {
            let places = one.works.iter().flat_map(|w| &w.stretch).flatten();
            if let Some(v) = places.copied().find(|v| !v.is_finite()) {
                return Err(bad("pin-option", &v.to_string(), "finite places of works"));
            }
            if let Some(w) = one.works.iter().find(|w| WorkKind::of_name(&w.kind).is_none()) {
                let kinds = WorkKind::ALL.map(WorkKind::name).join(", ");
                return Err(bad("pin-option", &format!("{:?}", w.kind), &format!("a kind of work: {kinds}")));
            }
            if one.works.is_empty() {
                return Err(bad(
                    "pin-option",
                    "no works",
                    "the works of an option; `pin` keeps what moves alone",
                ));
            }
            if !pinned_options.contains(&one) {
                pinned_options.push(one);
            }
        }
        let pins = pinned.len() + pinned_options.len();
        if pins > 0 && pins >= members {
            let expected = format!("fewer than the {members} members wanted");
            return Err(bad("pin", &counted(pins as u64, "option"), &expected));
        }
        let one_or_paper = match (p.mode.unwrap_or_default(), p.method.unwrap_or_default()) {
            (Mode::Best, _) => Some("mode best, which gives one layout"),
            (_, Method::Paper) => Some("method paper, whose algorithms keep none"),
            _ => None,
        };
        if let Some(what) = one_or_paper.filter(|_| pins > 0) {
            let expected = format!("none with {what}");
            return Err(bad("pin", &counted(pins as u64, "option"), &expected));
        }
        let points = p.seed_point.iter().flatten().chain(&p.lattice_centre);
        let points = points.chain(&p.reading.inside).chain(&p.reading.outside);
        if let Some(v) = points.flatten().find(|v| !v.is_finite()) {
            let keys = "seed-point, lattice-centre, inside, outside";
            return Err(bad(keys, &v.to_string(), "finite coordinates"));
        }
        if let Some(v) = p.lattice_centre.iter().flatten().find(|v| v.abs() > LATTICE_CENTRE_MAX_M) {
            return Err(bad("lattice-centre", &format!("{v:e}"), "metres, at most 1e9 from 0"));
        }
        Ok(Self {
            unit: p.unit,
            wall_layers: p.wall_layer.unwrap_or_default(),
            query_layer: p.query_layer,
            reference_layer: p.reference_layer,
            view: p.view,
            level: p.level.unwrap_or_default(),
            spacing_m: in_range("spacing", p.spacing, SPACING_M[0], SPACING_M[1])?,
            lattice_centre_m: p.lattice_centre,
            seed_points: p.seed_point.unwrap_or_default(),
            backend: p.backend.unwrap_or_default(),
            threads: p.threads.map(|t| count("threads", t, 1, THREADS_MAX)).transpose()?,
            seed: seed(p.seed.unwrap_or(1))?,
            evaluations: p.evaluations,
            seconds: in_range("seconds", p.seconds, 0.1, 1e6)?,
            write_every_secs: in_range(
                "write-every",
                p.write_every,
                WRITE_EVERY_SECS[0],
                WRITE_EVERY_SECS[1],
            )?,
            members,
            mode: p.mode.unwrap_or_default(),
            method: p.method.unwrap_or_default(),
            objectives,
            unsure: p.unsure.unwrap_or_default(),
            thresholds: p.thresholds.unwrap_or(if is_stated {
                Thresholds::Firm
            } else {
                Thresholds::Yielding
            }),
            score,
            penalties,
            distance: in_range("distance", Some(p.distance.unwrap_or(D_MIN_DEFAULT)), 0.0, 1.0)?
                .unwrap_or(D_MIN_DEFAULT),
            limits: control::limits(p.limit.as_deref().filter(|t| !is_none(t)).unwrap_or_default())?,
            links: control::links(
                p.link.as_deref().filter(|l| !l.iter().all(|t| is_none(t))).unwrap_or_default(),
            )?,
            snap: p.snap.filter(|t| !is_none(t)).map(|t| control::snap(&t)).transpose()?,
            most_moves: p.most_moves.map(|n| count("most-moves", n, 1, usize::MAX)).transpose()?,
            only_marked: p.only_marked.unwrap_or(false),
            allow: p.allow.as_deref().map_or(Ok(Allow::default()), control::allow)?,
            budget: p.budget.as_deref().map_or(Ok(Budget::default()), control::budget)?,
            brief: rooms::brief(p.brief)?,
            least_gain: p.least_gain.as_deref().map_or(Ok(control::LEAST_GAIN), control::share)?,
            raw: p.raw.unwrap_or(false),
            until_converged: p.until_converged.unwrap_or(false),
            together: p.together.map(|n| count("together", n, 1, TOGETHER_MAX)).transpose()?,
            pinned,
            pinned_options,
            like: p.like,
            warm: p.warm.unwrap_or_default(),
            pin_moves: p.pin_moves,
            warm_moves: p.warm_moves,
            colours: p.colours.unwrap_or_default(),
            overlay: p.overlay.unwrap_or_default(),
            pictures: p.pictures.unwrap_or(true),
            storey: p.storey,
            over_stairs: p.over_stairs.unwrap_or(false),
            of_storey: p.of_storey,
            tables_left: None,
            query: p.query,
            accept_missing_eof: p.accept_missing_eof.unwrap_or(false),
            beside: Beside::default(),
            unread: Vec::new(),
            storey_taken: None,
            ignore_move_markers: p.ignore_move_markers.unwrap_or(false),
            moves: p.moves,
            regions: p.regions,
            works: p.works,
            lineage: p.lineage,
            reading: p.reading,
        })
    }

    /// The objectives as `--objective` would say them.
    pub fn objective_text(&self) -> String {
        let sense = |is_max| if is_max { "max" } else { "min" };
        let clause = |o: &ObjectiveSetting| format!("{} {} {}", o.measure, sense(o.is_max), o.threshold);
        self.objectives.iter().map(clause).collect::<Vec<_>>().join(", ")
    }

    /// The weights as `--score` would say them.
    pub fn score_text(&self) -> String {
        self.score.iter().map(|(m, w)| format!("{m} {w:+}")).collect::<Vec<_>>().join(", ")
    }

    /// The weights as `--penalty` would say them.
    pub fn penalty_text(&self) -> String {
        let terms: Vec<String> = self.penalties.iter().map(|(p, v)| format!("{} {v}", p.name())).collect();
        if terms.is_empty() { "none".into() } else { terms.join(", ") }
    }

    /// The hard limits as `--limit` would say them; empty where there are none.
    pub fn limit_text(&self) -> String {
        self.limits.iter().map(Limit::to_string).collect::<Vec<_>>().join(", ")
    }

    /// The brief of rooms as `--brief` would say it; nothing where nothing is asked.
    pub fn brief_text(&self) -> Option<BriefText> {
        (!self.brief.is_empty()).then(|| BriefText::Text(self.brief.join("; ")))
    }

    /// Without all that is said of places on one storey: moves, regions, works, pins, points, numbers of rooms.
    #[must_use]
    pub fn without_places(mut self) -> Self {
        self.ignore_move_markers = false;
        (self.moves, self.regions, self.works) = Default::default();
        (self.pinned, self.pinned_options, self.pin_moves) = Default::default();
        (self.like, self.warm, self.warm_moves) = Default::default();
        (self.seed_points, self.reading.rooms) = Default::default();
        (self.reading.inside, self.reading.outside) = Default::default();
        self
    }

    /// Whether `score` takes the place of the objectives and the separate penalty.
    pub fn is_by_score(&self) -> bool {
        self.objectives.iter().any(|o| o.measure.measure == Measure::Score)
    }
}

/// Penalties by default: nothing weighs, since default moves keep ways open by rules; and what the published method holds.
const PENALTY_DEFAULT: &str = "none";
const PENALTY_PAPER: &str = "clearance 1, wall-length 1";

/// The objectives of the published method.
const OBJECTIVES_PAPER: &str = "degree max 0.7, depth min 0.7, entropy max 0.7";
/// Those of the default method, whose gains can be promised: tree depth is a maximum in whole steps, and entropy changes
/// with the spacing.
const OBJECTIVES_DEFAULT: &str = "degree max 0.7, mean-depth min 0.7";

fn bad(key: &str, found: &str, expected: &str) -> Error {
    let text = format!("{key}: found {found}, expected {expected}; nothing was done");
    Error::usage("settings", Place::default(), text)
}

/// Largest seed: the largest whole number of a settings file, in which `accept` writes it down.
pub const SEED_MAX: u64 = i64::MAX as u64;

fn seed(value: u64) -> Result<u64, Error> {
    match value {
        0..=SEED_MAX => Ok(value),
        _ => Err(bad("seed", &value.to_string(), &format!("at most {SEED_MAX}"))),
    }
}

/// What lifts a rule taken over from a source farther off.
pub const NONE: &str = "none";

/// Whether a rule is stated as lifted.
fn is_none(text: &str) -> bool {
    matches!(text.trim(), "" | NONE)
}

fn clauses(text: &str) -> impl Iterator<Item = &str> {
    text.split(',').map(str::trim).filter(|c| !c.is_empty())
}
