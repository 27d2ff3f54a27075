//! What the marks of `Pset_Enfilade` say twice, where it means nothing, and where it is not shown.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::building::Building;
use super::model::{Product, is_ours};
use crate::drawing::IdleMarks;
use crate::own_layers;
use crate::own_layers::{CLAUSES, KEEP, MOVE, name_in};
use crate::storey_key;
use enfilade_report::{Place, Report};

/// What a mark may be called.
const KEYS: [&str; 5] = ["Move", "Name", "Keep", "Query", "Reference"];

/// Why an element stays that its own mark keeps.
pub const KEEPS: &str = "Pset_Enfilade says Keep";

/// Most conflicts that are told one by one.
const TOLD: usize = 20;

/// The yes and no of a property, in lower case.
const YES: [&str; 4] = ["t", "true", "1", "yes"];
const NO: [&str; 7] = ["", "f", "false", "0", "no", "u", "unknown"];

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
    /// `Move` and `Keep`: walls and what may be named as one, and doors, which also hold the wall that they sit in.
    Moves,
    /// `Query`, `Reference` and `Keep`: spaces.
    Region,
    /// `Keep`: windows hold the wall that they sit in.
    Keeps,
    /// None.
    Nothing,
}

impl Use {
    /// Of a class that is read.
    pub fn of(class: &str) -> Self {
        match class {
            "IfcSpace" => Self::Region,
            "IfcWindow" => Self::Keeps,
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
        return Some(KEEPS.into());
    }
    let openings = b.model.openings.get(&id).into_iter().flatten();
    let mut fillers = openings.filter_map(|o| b.model.fillings.get(o)).flatten();
    let held = fillers.find(|f| b.model.properties.contains_key(f) && says(**f))?;
    let class = b.model.filler(*held).map_or("element", |f| f.class);
    Some(format!("Pset_Enfilade says Keep of its {class} #{held}"))
}

/// An element with marks: its instance, class, place, storey, and what they are for.
struct Marked {
    id: u64,
    class: String,
    place: Place,
    used: Use,
    storey: Option<u64>,
    /// Whether the plan shows it.
    is_shown: bool,
}

/// All elements that bear marks, in the order of the file, those that are not read last.
fn marked(b: &Building<'_, '_>, shown: &HashSet<u64>) -> Vec<Marked> {
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
    let of = |p: &Product| Marked {
        id: p.id,
        class: p.class.into(),
        place: b.place(p),
        used: Use::of(p.class),
        storey: storey_of(p.id),
        is_shown: shown.contains(&p.id),
    };
    let read = || b.model.products.iter().chain(&b.model.fillers);
    let known: BTreeSet<u64> = read().map(|p| p.id).collect();
    let is_in = |of: Option<&Vec<u64>>| of.is_some_and(|of| of.iter().any(|s| sets.contains(s)));
    let has = |id: u64| is_in(b.model.properties.get(&id)) || is_in(b.model.of_types.get(&id));
    let mut out: Vec<Marked> = read().filter(|p| has(p.id)).map(of).collect();
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
        out.push(Marked { id, class, place, used: Use::Nothing, storey: None, is_shown: true });
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

/// Values by name, in the order of the file, each with its set.
type Stated = Vec<(u64, String, String)>;

/// The last value of a name, where it is not empty.
fn said<'s>(stated: &'s Stated, key: &str) -> Option<&'s str> {
    let last = stated.iter().rev().find(|s| s.1 == key)?;
    Some(last.2.trim()).filter(|v| !v.is_empty())
}

/// What moves is meant to be said by: `Move`, whatever it says, and what was meant as that or as `Keep`.
fn is_wish(stated: &Stated, odd: &[(String, String)]) -> bool {
    let is_near =
        |key: &str| own_layers::meant(&format!("EF-{key}")).is_some_and(|k| [MOVE, KEEP].contains(&k));
    let begins =
        |value: &str| value.split_whitespace().next().is_some_and(|w| CLAUSES.contains(&&*w.to_lowercase()));
    said(stated, "move").is_some()
        || odd.iter().any(|(key, _)| ["move", "keep"].contains(&key.trim().to_lowercase().as_str()))
        || stated.iter().any(|(_, key, value)| !is_known(key) && (is_near(key) || begins(value)))
}

fn is_known(key: &str) -> bool {
    KEYS.iter().any(|k| k.eq_ignore_ascii_case(key))
}

/// Says which marks of a storey's elements contradict each other, are not used or not shown, and on which other storeys there
/// are more. Returns what wishes to move no element of the plan bears.
pub(super) fn state(
    b: &Building<'_, '_>,
    storey: Option<u64>,
    shown: &HashSet<u64>,
    report: &mut Report,
) -> IdleMarks {
    let mut told: Vec<(Place, String)> = Vec::new();
    let mut here: Vec<(Marked, Stated)> = Vec::new();
    let mut elsewhere: BTreeMap<u64, Vec<(Marked, Stated)>> = BTreeMap::new();
    let mut wishes = IdleMarks::None;
    for p in marked(b, shown) {
        let stated = b.model.stated_marks(b.step, p.id);
        let odd = b.model.odd_marks(b.step, p.id);
        let is_away = !p.is_shown && p.storey.is_some() && p.storey != storey;
        if is_wish(&stated, &odd) {
            wishes = wishes.max(if is_away { IdleMarks::Elsewhere } else { IdleMarks::Unusable });
        }
        if let Some(of) = p.storey.filter(|_| is_away) {
            elsewhere.entry(of).or_default().push((p, stated));
            continue;
        }
        told.extend(faults(b, &p, &stated, &odd).into_iter().map(|text| (p.place.clone(), text)));
        here.push((p, stated));
    }
    told.extend(named_apart(b, &here));
    told.extend(partners(b, &here, &elsewhere));
    let more = told.len().saturating_sub(TOLD);
    for (place, text) in told.into_iter().take(TOLD) {
        report.warn("ifc-marks", place, text);
    }
    if more > 0 {
        let text = format!("{more} more marks of Pset_Enfilade that contradict each other or are not used");
        report.warn("ifc-marks", Place::file(b.file), text);
    }
    state_elsewhere(b, &elsewhere, report);
    wishes
}

/// What is wrong with the marks of one element.
fn faults(b: &Building<'_, '_>, p: &Marked, stated: &Stated, odd: &[(String, String)]) -> Vec<String> {
    let mut out = Vec::new();
    let mut by_key: BTreeMap<&str, Vec<(u64, &str)>> = BTreeMap::new();
    for (set, key, value) in stated {
        by_key.entry(key).or_default().push((*set, value));
    }
    for (key, values) in &by_key {
        if let Some((set, value)) = values.last()
            && let Some(other) = values.iter().find(|v| v.1.trim() != value.trim())
        {
            out.push(format!(
                "Pset_Enfilade states {key} twice, {:?} in #{} and {value:?} in #{set}; the last counts",
                other.1, other.0
            ));
        }
        if !is_known(key) && !key.is_empty() {
            out.push(format!(
                "Pset_Enfilade says {key:?}, expected one of {}; it is not used",
                KEYS.join(", ")
            ));
        }
    }
    for (key, kind) in odd {
        out.push(format!(
            "Pset_Enfilade states {key} as {kind}, expected IFCPROPERTYSINGLEVALUE; it is not used"
        ));
    }
    let moves = p.used == Use::Moves;
    if let (true, Some(name), Some(other)) = (
        moves,
        said(stated, "name"),
        said(stated, "move").and_then(name_in).filter(|n| said(stated, "name") != Some(n)),
    ) {
        out.push(format!("Pset_Enfilade names it {name:?} as Name and {other:?} within Move; Name counts"));
    }
    if let Some(why) = kept(b, p.id).filter(|_| moves && said(stated, "move").is_some()) {
        out.push(match said(stated, "keep").is_some_and(|v| is_yes(v) != Some(false)) {
            true => "Pset_Enfilade states both Move and Keep; it stays".into(),
            false => format!("Pset_Enfilade states Move, and {why}; it stays"),
        });
    }
    let says = |k: &&str| said(stated, k).is_some_and(|v| *k == "move" || is_yes(v) != Some(false));
    let idle: Vec<&str> = p.used.idle().iter().copied().filter(says).collect();
    if !idle.is_empty() {
        out.push(format!(
            "Pset_Enfilade states {} of {}",
            idle.join(" and "),
            match (b.step.get(p.id).is_some(), p.class.as_str()) {
                (true, class) => format!("an {class}, where it means nothing"),
                (false, "") => "an instance that does not exist".into(),
                (false, class) => format!("an {class} that cannot be read and is left out"),
            }
        ));
    }
    let shown: &[&str] = match p.used {
        Use::Moves => &["move"],
        Use::Region => &["query", "reference"],
        Use::Keeps | Use::Nothing => &[],
    };
    let unseen: Vec<&str> = shown.iter().copied().filter(|k| !p.is_shown && says(k)).collect();
    if !unseen.is_empty() {
        let of = b.storey_name(p.id).map_or_else(String::new, |s| format!(" of storey \"{s}\""));
        let then = if p.used == Use::Moves { "nothing moves by it" } else { "it is not used" };
        out.push(format!(
            "Pset_Enfilade states {} of it, and nothing of it{of} is shown at the height of the cut; {then}",
            unseen.join(" and ")
        ));
    }
    out
}

/// Elements that state one name and different moves.
fn named_apart(b: &Building<'_, '_>, here: &[(Marked, Stated)]) -> Vec<(Place, String)> {
    let mut named: BTreeMap<&str, Vec<(u64, &str)>> = BTreeMap::new();
    for (p, stated) in here.iter().filter(|(p, _)| p.used == Use::Moves) {
        if let (Some(name), Some(text)) = (said(stated, "name"), said(stated, "move")) {
            named.entry(name).or_default().push((p.id, text));
        }
    }
    let differs = |(name, walls): (&str, Vec<(u64, &str)>)| {
        let (first, text) = walls.first()?;
        let (other, differs) = walls.iter().find(|w| w.1 != *text)?;
        let what = format!(
            "#{first} and #{other} are both named {name:?} by Pset_Enfilade and move differently, {text:?} and \
             {differs:?}; each moves for itself"
        );
        Some((Place::file(b.file), what))
    };
    named.into_iter().filter_map(differs).collect()
}

/// Elements of other storeys that state the name and the move of one that moves here.
fn partners(
    b: &Building<'_, '_>,
    here: &[(Marked, Stated)],
    elsewhere: &BTreeMap<u64, Vec<(Marked, Stated)>>,
) -> Vec<(Place, String)> {
    let words = |stated: &Stated| Some((said(stated, "name")?.to_owned(), said(stated, "move")?.to_owned()));
    let moves = here.iter().filter(|(p, _)| p.used == Use::Moves && p.is_shown);
    let moving: Vec<(u64, (String, String))> = moves.filter_map(|(p, s)| Some((p.id, words(s)?))).collect();
    let others = elsewhere.values().flatten().filter(|(p, _)| p.used == Use::Moves);
    let of = |(p, stated): &(Marked, Stated)| {
        let own = words(stated)?;
        let (first, (name, _)) = moving.iter().find(|(_, w)| *w == own)?;
        let storey = b.model.storeys.iter().find(|s| Some(s.id) == p.storey)?;
        let text = format!(
            "is named {name:?} by Pset_Enfilade as #{first} is, and stands on storey \"{}\", which this plan does not show; \
             that one moves without it",
            storey.name
        );
        Some((p.place.clone(), text))
    };
    others.filter_map(of).collect()
}

/// Says on which other storeys there are marks.
fn state_elsewhere(
    b: &Building<'_, '_>,
    elsewhere: &BTreeMap<u64, Vec<(Marked, Stated)>>,
    report: &mut Report,
) {
    let storeys = super::storeys(b);
    for (i, of) in b.model.storeys.iter().enumerate() {
        let Some(marks) = elsewhere.get(&of.id) else { continue };
        let Some((first, _)) = marks.first() else { continue };
        let keys: BTreeSet<&str> = marks.iter().flat_map(|(_, s)| s).map(|s| s.1.as_str()).collect();
        let keys: Vec<&str> = KEYS.into_iter().filter(|k| keys.contains(k.to_lowercase().as_str())).collect();
        let more = if marks.len() > 1 { format!(" (and {} more)", marks.len() - 1) } else { String::new() };
        let text = format!(
            "Pset_Enfilade states {} of it{more} on storey \"{}\", which this plan does not show: --storey \"{}\" takes it",
            if keys.is_empty() { "nothing that is read".into() } else { keys.join(", ") },
            of.name,
            storey_key(&storeys, i)
        );
        report.info("marks-elsewhere", first.place.clone(), text);
    }
}
