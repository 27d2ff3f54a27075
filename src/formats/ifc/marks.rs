//! What the marks of `Pset_Enfilade` say twice, or where it means nothing.

use std::collections::{BTreeMap, BTreeSet};

use super::model::Product;
use super::read::Building;
use crate::report::{Place, Report};

/// Most conflicts that are told one by one.
const TOLD: usize = 20;

/// The yes and no of a property, in lower case.
const YES: [&str; 4] = ["t", "true", "1", "yes"];
const NO: [&str; 7] = ["", "f", "false", "0", "no", "u", "unknown"];

/// Whether a set of properties is ours.
pub(super) fn is_ours(name: &str) -> bool {
    name.eq_ignore_ascii_case("Pset_Enfilade")
}

/// Whether a mark says yes; `None` where it says something else.
pub(super) fn is_yes(value: &str) -> Option<bool> {
    let value = value.trim().to_lowercase();
    if YES.contains(&value.as_str()) {
        return Some(true);
    }
    NO.contains(&value.as_str()).then_some(false)
}

/// What marks are for, by the class of their element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    /// `Move` and `Keep`: walls, and what may be named as one.
    Moves,
    /// `Query`, `Reference` and `Keep`: spaces.
    Region,
    /// `Keep`: doors and windows hold the wall that they sit in.
    Keeps,
    /// None.
    Nothing,
}

impl Use {
    /// Of a class that is read.
    pub fn of(class: &str) -> Self {
        match class {
            "IfcSpace" => Self::Region,
            "IfcDoor" | "IfcWindow" => Self::Keeps,
            _ => Self::Moves,
        }
    }

    /// Marks that mean nothing there.
    fn idle(self) -> &'static [&'static str] {
        match self {
            Self::Moves => &["query", "reference"],
            Self::Region => &["move"],
            Self::Keeps => &["move", "query", "reference"],
            Self::Nothing => &["move", "keep", "query", "reference"],
        }
    }
}

/// The marks of a space: what a zone says holds for its spaces, where they say nothing else.
pub(super) fn of_space(b: &Building<'_, '_>, id: u64) -> BTreeMap<String, String> {
    let mut marks = b.model.marks(b.step, id);
    for (key, value) in b.model.zones_of(id).iter().flat_map(|z| b.model.marks(b.step, *z)) {
        marks.entry(key).or_insert(value);
    }
    marks
}

/// Why marks hold an element: its own, or those of a door or window in it.
pub(super) fn kept(b: &Building<'_, '_>, id: u64) -> Option<String> {
    let says = |id: u64| b.model.marks(b.step, id).get("keep").is_some_and(|v| is_yes(v) != Some(false));
    if says(id) {
        return Some("Pset_Enfilade says Keep".into());
    }
    let openings = b.model.openings.get(&id).into_iter().flatten();
    let mut fillers = openings.filter_map(|o| b.model.fillings.get(o)).flatten();
    let held = fillers.find(|f| b.model.properties.contains_key(f) && says(**f))?;
    let class = b.model.filler(*held).map_or("element", |f| f.class);
    Some(format!("Pset_Enfilade says Keep of its {class} #{held}"))
}

/// An element with marks: its instance, class, place, and what they are for.
struct Marked {
    id: u64,
    class: String,
    place: Place,
    used: Use,
}

/// All elements of a storey that bear properties, in the order of the file; of what is not read those of all storeys.
fn marked(b: &Building<'_, '_>, storey: Option<u64>) -> Vec<Marked> {
    let of =
        |p: &Product| Marked { id: p.id, class: p.class.into(), place: b.place(p), used: Use::of(p.class) };
    let read = || b.model.products.iter().chain(&b.model.fillers);
    let sets: BTreeSet<u64> = b
        .step
        .all("IFCPROPERTYSET")
        .filter(|i| b.step.args_of(i).get(2).and_then(|a| b.step.text(a)).is_some_and(|n| is_ours(&n)))
        .map(|i| i.id)
        .collect();
    if sets.is_empty() {
        return Vec::new();
    }
    let hosts = b.model.hosts();
    let storey_of = |id: u64| b.model.storey_of(id).or_else(|| b.model.storey_of(*hosts.get(&id)?));
    let known: BTreeSet<u64> = read().map(|p| p.id).collect();
    let has = |id: u64| b.model.properties.get(&id).is_some_and(|of| of.iter().any(|s| sets.contains(s)));
    let mut out: Vec<Marked> = read().filter(|p| has(p.id) && storey_of(p.id) == storey).map(of).collect();
    let is_other = |id: &u64| has(*id) && !known.contains(id) && !b.model.is_zone(*id);
    let mut others: Vec<u64> = b.model.properties.keys().copied().filter(is_other).collect();
    others.sort_unstable();
    // No more are looked for through the whole file than are told one by one.
    let unread: BTreeSet<u64> =
        others.iter().copied().filter(|id| b.step.get(*id).is_none()).take(TOLD).collect();
    for id in others {
        let read = b.step.get(id).map(|i| (i.span.start, b.step.keyword(id).to_string()));
        let at = read.or_else(|| unread.contains(&id).then(|| raw(b, id))?);
        let (line, class) = at.map_or((None, String::new()), |(at, class)| (Some(b.step.line(at)), class));
        let place = Place { file: b.file.into(), line, entity: format!("#{id} {class}").trim_end().into() };
        out.push(Marked { id, class, place, used: Use::Nothing });
    }
    out
}

/// Where an instance that cannot be read begins, and what it is called.
fn raw(b: &Building<'_, '_>, id: u64) -> Option<(usize, String)> {
    let (bytes, name) = (b.step.bytes, format!("#{id}"));
    let blank = |from: usize| from + bytes[from..].iter().take_while(|c| c.is_ascii_whitespace()).count();
    memchr::memmem::find_iter(bytes, name.as_bytes()).find_map(|at| {
        let equals = blank(at + name.len());
        let from = blank(equals + 1).min(bytes.len());
        let class = bytes[from..].iter().take_while(|c| c.is_ascii_alphanumeric() || **c == b'_');
        let class = class.map(|c| char::from(c.to_ascii_uppercase())).collect::<String>();
        (bytes.get(equals) == Some(&b'=') && !class.is_empty()).then_some((at, class))
    })
}

/// Says which marks of a storey's elements contradict each other or are not used.
pub(super) fn state(b: &Building<'_, '_>, storey: Option<u64>, report: &mut Report) {
    let mut told: Vec<(Place, String)> = Vec::new();
    let mut named: BTreeMap<String, Vec<(u64, String)>> = BTreeMap::new();
    for p in marked(b, storey) {
        let stated = b.model.stated_marks(b.step, p.id);
        let mut by_key: BTreeMap<&str, Vec<(u64, &str)>> = BTreeMap::new();
        for (set, key, value) in &stated {
            by_key.entry(key).or_default().push((*set, value));
        }
        let said =
            |key: &str| by_key.get(key).and_then(|v| v.last()).map(|v| v.1.trim()).filter(|v| !v.is_empty());
        for (key, values) in &by_key {
            if let Some((set, value)) = values.last()
                && let Some(other) = values.iter().find(|v| v.1.trim() != value.trim())
            {
                told.push((
                    p.place.clone(),
                    format!(
                        "Pset_Enfilade states {key} twice, {:?} in #{} and {value:?} in #{set}; the last counts",
                        other.1, other.0
                    ),
                ));
            }
        }
        let moves = p.used == Use::Moves;
        if let Some(why) = kept(b, p.id).filter(|_| moves && said("move").is_some()) {
            let text = match said("keep").is_some_and(|v| is_yes(v) != Some(false)) {
                true => "Pset_Enfilade states both Move and Keep; it stays".into(),
                false => format!("Pset_Enfilade states Move, and {why}; it stays"),
            };
            told.push((p.place.clone(), text));
        }
        let idle = p.used.idle().iter().copied();
        let idle: Vec<&str> =
            idle.filter(|k| said(k).is_some_and(|v| *k == "move" || is_yes(v) != Some(false))).collect();
        if !idle.is_empty() {
            let text = format!(
                "Pset_Enfilade states {} of {}",
                idle.join(" and "),
                match (b.step.get(p.id).is_some(), p.class.as_str()) {
                    (true, class) => format!("an {class}, where it means nothing"),
                    (false, "") => "an instance that does not exist".into(),
                    (false, class) => format!("an {class} that cannot be read and is left out"),
                }
            );
            told.push((p.place.clone(), text));
        }
        if let (true, Some(name), Some(text)) = (moves, said("name"), said("move")) {
            named.entry(name.into()).or_default().push((p.id, text.into()));
        }
    }
    for (name, walls) in &named {
        let Some((first, text)) = walls.first() else { continue };
        if let Some((other, differs)) = walls.iter().find(|w| w.1 != *text) {
            let what = format!(
                "#{first} and #{other} are both named {name:?} by Pset_Enfilade and move differently, {text:?} and \
                 {differs:?}; each moves for itself"
            );
            told.push((Place::file(b.file), what));
        }
    }
    let more = told.len().saturating_sub(TOLD);
    for (place, text) in told.into_iter().take(TOLD) {
        report.warn("ifc-marks", place, text);
    }
    if more > 0 {
        report.warn(
            "ifc-marks",
            Place::file(b.file),
            format!("{more} more conflicts between marks of Pset_Enfilade"),
        );
    }
}
