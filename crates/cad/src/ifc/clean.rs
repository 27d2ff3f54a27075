//! Takes what was demolished out of a building, with what stands only for it.

use std::collections::{BTreeSet, HashMap};

use super::building::Building;
use super::patch::LABELS;
use super::phase::phase;
use super::step::{Arg, Instance, Step, Value};
use crate::phase::Phase;
use crate::splice::{Splice, apply};
use enfilade_report::{Error, Place};

/// Slots of a boundary of a room from here on name other boundaries, and may be empty.
const OTHER_BOUNDARIES: usize = 9;
/// Letters of a `GlobalId`.
const GLOBAL_ID_LETTERS: usize = 22;
/// Rooted, and of use only to the element that has it.
const OF_ELEMENTS: [&str; 2] = ["IFCPROPERTYSET", "IFCELEMENTQUANTITY"];
/// Of use also where nothing names it: what others may be drawn with, or be made of.
const LIBRARY: [&str; 3] =
    ["IFCMATERIAL", "IFCGEOMETRICREPRESENTATIONCONTEXT", "IFCGEOMETRICREPRESENTATIONSUBCONTEXT"];

/// The building without the elements that are demolished, and how many those were. Openings in them, what fills these, and parts go too; relations no longer name them.
///
/// # Errors
/// [`Error::Input`] where one number is given twice, or the bytes cannot be changed so.
pub(super) fn without_demolished(b: &Building<'_, '_>) -> Result<(Vec<u8>, usize), Error> {
    let demolished = demolished(b);
    if demolished.is_empty() {
        return Ok((b.step.bytes.to_vec(), 0));
    }
    if let Some(id) = b.step.duplicates.first() {
        let text = format!(
            "#{id} is the number of several instances, so nothing can be taken out; nothing was written; \
             save it with another program"
        );
        return Err(Error::input("ifc-clean", Place::file(b.file), text));
    }
    let mut cleaning = Cleaning::new(b.step);
    demolished.iter().for_each(|id| cleaning.take(*id));
    cleaning.go_on();
    let bytes = apply(b.file, "ifc-edit-twice", b.step.bytes, cleaning.splices())?;
    let is_opening = |id: &&u64| b.step.keyword(**id).starts_with("IFCOPENING");
    Ok((bytes, demolished.iter().filter(|id| !is_opening(id)).count()))
}

/// Elements that are demolished, with what goes along.
fn demolished(b: &Building<'_, '_>) -> BTreeSet<u64> {
    let known = b.model.products.iter().chain(&b.model.fillers).map(|p| p.id);
    let stated = b.model.properties.keys().chain(b.model.of_types.keys()).copied();
    let all: BTreeSet<u64> = known.chain(stated).filter(|id| is_element(b.step, *id)).collect();
    let gone = all.into_iter().filter(|id| phase(b.step, &b.model, *id) == Phase::Demolished);
    gone.flat_map(|id| b.model.follows(id)).collect()
}

/// Whether an instance is an element that stands somewhere: no room, no storey, no opening.
fn is_element(step: &Step<'_>, id: u64) -> bool {
    let class = step.keyword(id);
    let is_space =
        ["IFCSPACE", "IFCSITE", "IFCBUILDING", "IFCBUILDINGSTOREY", "IFCSPATIALZONE"].contains(&&*class);
    let placement = step.args(id).get(5).and_then(Arg::id);
    let stands = placement.is_some_and(|p| step.keyword(p).ends_with("PLACEMENT"));
    stands && !is_space && !class.starts_with("IFCOPENING")
}

/// What goes.
struct Cleaning<'s, 'a> {
    step: &'s Step<'a>,
    /// Instance → those that name it.
    users: HashMap<u64, Vec<u64>>,
    gone: BTreeSet<u64>,
    /// Instances that stay and name what goes.
    shortened: BTreeSet<u64>,
    open: Vec<u64>,
}

/// What becomes of one argument.
enum Fate {
    Stays,
    Shorter(String),
    Goes,
}

impl<'s, 'a> Cleaning<'s, 'a> {
    fn new(step: &'s Step<'a>) -> Self {
        let mut users: HashMap<u64, Vec<u64>> = HashMap::new();
        for i in &step.instances {
            for id in named(step, i) {
                users.entry(id).or_default().push(i.id);
            }
        }
        Self { step, users, gone: BTreeSet::new(), shortened: BTreeSet::new(), open: Vec::new() }
    }

    fn take(&mut self, id: u64) {
        if self.gone.insert(id) {
            self.open.push(id);
        }
    }

    /// Takes what follows from what goes.
    fn go_on(&mut self) {
        while let Some(id) = self.open.pop() {
            for user in self.users.get(&id).cloned().unwrap_or_default() {
                if self.gone.contains(&user) {
                    continue;
                }
                if self.fates(user).iter().any(|(_, fate)| matches!(fate, Fate::Goes)) {
                    self.take(user);
                } else {
                    self.shortened.insert(user);
                }
            }
            let Some(instance) = self.step.get(id) else { continue };
            for used in named(self.step, instance) {
                if !self.gone.contains(&used) && !self.is_of_use(used) {
                    self.take(used);
                }
            }
        }
    }

    /// Whether something that stays needs an instance.
    fn is_of_use(&self, id: u64) -> bool {
        let class = self.step.keyword(id);
        let is_kept =
            LIBRARY.contains(&&*class) || is_rooted(self.step, id) && !OF_ELEMENTS.contains(&&*class);
        let users = self.users.get(&id).map(Vec::as_slice).unwrap_or_default();
        let needs = |user: &u64| !self.gone.contains(user) && !LABELS.contains(&&*self.step.keyword(*user));
        is_kept || users.iter().any(needs)
    }

    /// What becomes of the arguments of an instance that stays, each with its place.
    fn fates(&self, id: u64) -> Vec<(Arg, Fate)> {
        let class = self.step.keyword(id);
        let is_tie = class.starts_with("IFCREL") || LABELS.contains(&&*class);
        let is_boundary = class.starts_with("IFCRELSPACEBOUNDARY");
        let args = self.step.args(id).into_iter().enumerate();
        args.map(|(k, arg)| {
            let may_be_empty = !is_tie || is_boundary && k >= OTHER_BOUNDARIES;
            let fate = self.fate(&arg, may_be_empty);
            (arg, fate)
        })
        .collect()
    }

    fn fate(&self, arg: &Arg, may_be_empty: bool) -> Fate {
        let is_gone = |arg: &Arg| arg.id().is_some_and(|id| self.gone.contains(&id));
        let items = arg.list();
        match &arg.value {
            Value::Ref(_) if is_gone(arg) && may_be_empty => Fate::Shorter("$".into()),
            Value::Ref(_) if is_gone(arg) => Fate::Goes,
            Value::List(_) if items.iter().any(is_gone) => {
                let left = items.iter().filter(|a| !is_gone(a));
                let left =
                    left.map(|a| String::from_utf8_lossy(&self.step.bytes[a.span.clone()]).into_owned());
                let left: Vec<String> = left.collect();
                let is_empty = left.is_empty() && !may_be_empty;
                if is_empty { Fate::Goes } else { Fate::Shorter(format!("({})", left.join(","))) }
            }
            _ => Fate::Stays,
        }
    }

    fn splices(&self) -> Vec<Splice> {
        let gone = self.step.instances.iter().filter(|i| self.gone.contains(&i.id));
        let mut out: Vec<Splice> = gone.map(|i| Splice::new(line_of(self.step.bytes, i), "")).collect();
        for id in self.shortened.difference(&self.gone) {
            for (arg, fate) in self.fates(*id) {
                if let Fate::Shorter(text) = fate {
                    out.push(Splice::new(arg.span, text));
                }
            }
        }
        out
    }
}

/// An instance with its line end, where it has its lines to itself.
fn line_of(bytes: &[u8], instance: &Instance) -> std::ops::Range<usize> {
    let (start, mut end) = (instance.span.start, instance.span.end);
    let is_begun = start > 0 && !matches!(bytes[start - 1], b'\n' | b'\r');
    if !is_begun && bytes.get(end) == Some(&b'\r') {
        end += 1;
    }
    if !is_begun && bytes.get(end) == Some(&b'\n') {
        end += 1;
    }
    start..end
}

/// The instances that one names, each once; not those in its texts.
fn named(step: &Step<'_>, instance: &Instance) -> Vec<u64> {
    let text = &step.bytes[instance.args.clone()];
    let (mut out, mut is_text, mut at) = (Vec::new(), false, 0);
    while at < text.len() {
        match text[at] {
            b'\'' => is_text = !is_text,
            b'#' if !is_text => {
                let digits = text[at + 1..].iter().take_while(|b| b.is_ascii_digit()).count();
                let id = std::str::from_utf8(&text[at + 1..at + 1 + digits]).ok();
                out.extend(id.and_then(|t| t.parse::<u64>().ok()));
                at += digits;
            }
            _ => {}
        }
        at += 1;
    }
    out.sort_unstable();
    out.dedup();
    out
}

/// Whether an instance has a `GlobalId`: it begins with a digit from 0 to 3.
fn is_rooted(step: &Step<'_>, id: u64) -> bool {
    let text = step.args(id).first().and_then(|a| step.text(a)).unwrap_or_default();
    text.len() == GLOBAL_ID_LETTERS
        && text.starts_with(['0', '1', '2', '3'])
        && text.bytes().all(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'$'))
}
