//! The user's word on what entities are. Each correction changes what it names and nothing else.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::str::FromStr;

use glam::DVec2;

use super::super::hidden::Hidden;
use enfilade_cad::drawing::{Drawing, Entity};
use enfilade_cad::names::base_name;
use enfilade_cad::names::{Pattern, folded};
use enfilade_cad::own_layers::is_own;
use enfilade_cad::roles::Role;
use enfilade_report::{Place, Report};

/// By what a [`Selector`] names entities; what comes later is more specific.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum By {
    Layer,
    Block,
    Handle,
}

/// Names entities: `handle:2F3`, `layer:A-FURN*`, `block:SINK-*`. Case does not count in names of layers and blocks, nor
/// in handles with `*` or `?`.
#[derive(Clone, Debug)]
pub struct Selector {
    by: By,
    name: String,
    pattern: Pattern,
}

impl PartialEq for Selector {
    fn eq(&self, other: &Self) -> bool {
        (self.by, &self.name) == (other.by, &other.name)
    }
}

impl fmt::Display for Selector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let by = match self.by {
            By::Layer => "layer",
            By::Block => "block",
            By::Handle => "handle",
        };
        write!(f, "{by}:{}", self.name)
    }
}

impl FromStr for Selector {
    type Err = String;

    /// # Errors
    /// What was found and what is expected.
    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, name) = text.split_once(':').unwrap_or_default();
        let by = match kind {
            "layer" => By::Layer,
            "block" => By::Block,
            "handle" => By::Handle,
            _ => return Err(format!("found {text:?}, expected handle:NAME, layer:NAME or block:NAME")),
        };
        let pattern = Pattern::new(name).map_err(|e| format!("found {text:?}: {e}"))?;
        Ok(Self { by, name: name.into(), pattern })
    }
}

impl Selector {
    fn is_glob(&self) -> bool {
        self.name.contains(['*', '?', '[', '{'])
    }

    /// How closely it names what it names.
    fn rank(&self) -> (By, bool, usize) {
        (self.by, !self.is_glob(), self.name.len())
    }

    /// Whether it names an entity.
    pub fn is_match(&self, e: &Entity) -> bool {
        match self.by {
            By::Layer => [e.layer.as_str(), base_name(&e.layer)].iter().any(|n| self.pattern.is_match(n)),
            By::Block => e.blocks.iter().any(|b| self.pattern.is_match(b)),
            By::Handle if self.is_glob() => {
                e.source.handle.as_ref().is_some_and(|h| self.pattern.is_match(h))
            }
            // Identifiers of a building differ by case alone.
            By::Handle => {
                e.source.handle.as_ref().is_some_and(|h| *h == self.name || *h == self.name.to_uppercase())
            }
        }
    }
}

/// The user's word on how a drawing is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Corrections {
    /// These stop sight as walls.
    pub wall: Vec<Selector>,
    /// These are no walls.
    pub not_wall: Vec<Selector>,
    /// These show doors.
    pub door: Vec<Selector>,
    /// These show windows.
    pub window: Vec<Selector>,
    /// The floor round these is measured, drawing units.
    pub inside: Vec<DVec2>,
    /// The floor round these is not, drawing units.
    pub outside: Vec<DVec2>,
    /// Every visible line of the chosen layers stops sight; nothing is interpreted.
    pub as_drawn: bool,
}

/// What a correction could not do.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// It names nothing; the nearest name there is.
    Unmatched {
        /// The selector.
        selector: String,
        /// A layer's or a block's name.
        nearest: Option<String>,
    },
    /// All it names as walls is off or frozen.
    Hidden {
        /// The selector.
        selector: String,
    },
    /// The floor round a point inside is open to the outside.
    Open {
        /// The point, drawing units.
        at: [f64; 2],
    },
    /// Regions or seed points say what is measured, so points inside and outside change nothing.
    Overruled,
}

impl Finding {
    /// Says it in the report of a drawing.
    pub fn tell(&self, file: &str, report: &mut Report) {
        let (code, text) = match self {
            Self::Unmatched { selector, nearest } => {
                let near =
                    nearest.as_ref().map_or_else(String::new, |n| format!(" The nearest name is {n:?}."));
                (
                    "correction-unmatched",
                    format!("Correction {selector} matches nothing. It was ignored.{near}"),
                )
            }
            Self::Hidden { selector } => {
                let text = format!(
                    "All that correction {selector} names is off or frozen. Switch it on or thaw it."
                );
                ("correction-hidden", text)
            }
            Self::Open { at: [x, y] } => {
                let text = format!(
                    "The floor round the inside point {x},{y} is open to the outside. The point was ignored. Close \
                     the walls or draw EF-QUERY."
                );
                ("correction-open", text)
            }
            Self::Overruled => {
                let text =
                    "Regions or seed points say what is measured. Inside and outside points were ignored.";
                ("correction-overruled", text.into())
            }
        };
        report.warn(code, Place::file(file), text);
    }
}

/// Roles that the user states, by the index of the entity.
pub type Said = BTreeMap<usize, Role>;

impl Corrections {
    fn lists(&self) -> [(&[Selector], Role); 4] {
        [
            (&self.wall, Role::Wall),
            (&self.door, Role::Door),
            (&self.window, Role::Window),
            (&self.not_wall, Role::Unknown),
        ]
    }

    /// What the user says an entity is; [`Role::Unknown`]: no wall. A handle overrules a block, a block a layer, a name one
    /// with `*`, a longer name a shorter one, and what the list of not-walls says all others.
    pub fn role_of(&self, e: &Entity) -> Option<Role> {
        let lists = self.lists();
        let all = lists.iter().flat_map(|(list, role)| list.iter().map(move |s| (s, *role)));
        let fitting = all.filter(|(s, _)| s.is_match(e));
        fitting.max_by_key(|(s, _)| s.rank()).map(|(_, role)| role)
    }

    /// What the user says of every entity of which he says something.
    pub fn said(&self, drawing: &Drawing) -> Said {
        if self.lists().iter().all(|(list, _)| list.is_empty()) {
            return Said::new();
        }
        let foreign = drawing.entities.iter().enumerate().filter(|(_, e)| !is_own(&e.layer));
        foreign.filter_map(|(i, e)| Some((i, self.role_of(e)?))).collect()
    }

    /// Whether the user names this very entity as a wall, wherever it stands.
    pub fn insists_on(&self, e: &Entity) -> bool {
        self.role_of(e) == Some(Role::Wall) && self.wall.iter().any(|s| s.by == By::Handle && s.is_match(e))
    }

    /// What of them names nothing that is there.
    pub fn idle(&self, drawing: &Drawing) -> Vec<Finding> {
        let hidden = Hidden::new(drawing);
        let foreign = || drawing.entities.iter().chain(&drawing.fills).filter(|e| !is_own(&e.layer));
        let mut out = Vec::new();
        for (list, role) in self.lists() {
            for selector in list {
                let mut named = foreign().filter(|e| selector.is_match(e)).peekable();
                let text = selector.to_string();
                if named.peek().is_none() {
                    out.push(Finding::Unmatched { selector: text, nearest: nearest(selector, drawing) });
                } else if role == Role::Wall && named.all(|e| hidden.entity(e)) {
                    out.push(Finding::Hidden { selector: text });
                }
            }
        }
        out
    }
}

/// The name of a layer or a block that is most like the one a selector looks for.
fn nearest(selector: &Selector, drawing: &Drawing) -> Option<String> {
    let entities = drawing.entities.iter().filter(|e| !is_own(&e.layer));
    let names: BTreeSet<&str> = match selector.by {
        By::Layer => entities.map(|e| e.layer.as_str()).collect(),
        By::Block => entities.flat_map(|e| e.blocks.iter().map(String::as_str)).collect(),
        By::Handle => return None,
    };
    let wanted = folded(&selector.name);
    let edits = |name: &&&str| strsim::damerau_levenshtein(&wanted, &folded(name));
    names.iter().min_by_key(edits).map(ToString::to_string)
}

/// Takes out of `walls` (ascending indices of entities) what the user calls something else.
pub(crate) fn without_others(said: &Said, walls: &mut Vec<usize>) {
    walls.retain(|i| said.get(i).is_none_or(|role| *role == Role::Wall));
}

/// Puts into `walls` (ascending) what the user calls walls, of those that `may` be.
pub(crate) fn with_walls(said: &Said, walls: &mut Vec<usize>, may: impl Fn(usize) -> bool) {
    if !said.is_empty() {
        walls.extend(said.iter().filter(|(i, role)| **role == Role::Wall && may(**i)).map(|(i, _)| *i));
        walls.sort_unstable();
        walls.dedup();
    }
}
