//! What the marks of `Pset_Enfilade` say twice, or where it means nothing.

use std::collections::BTreeMap;

use super::model::Product;
use super::read::Building;
use crate::report::{Place, Report};

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

/// Says which marks of a storey's elements contradict each other or are not used.
pub(super) fn state(b: &Building<'_, '_>, storey: Option<u64>, report: &mut Report) {
    let here = |p: &&Product| b.model.storey_of(p.id) == storey;
    let mut told: Vec<(Place, String)> = Vec::new();
    let mut named: BTreeMap<String, Vec<(u64, String)>> = BTreeMap::new();
    for p in b.model.products.iter().filter(here).filter(|p| b.model.properties.contains_key(&p.id)) {
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
                    b.place(p),
                    format!(
                        "Pset_Enfilade states {key} twice, {:?} in #{} and {value:?} in #{set}; the last counts",
                        other.1, other.0
                    ),
                ));
            }
        }
        let is_wall = p.class.starts_with("IfcWall") || p.class.starts_with("IfcColumn");
        let keeps = said("keep").is_some_and(|v| is_yes(v) != Some(false));
        if is_wall && keeps && said("move").is_some() {
            told.push((b.place(p), "Pset_Enfilade states both Move and Keep; it stays".into()));
        }
        let idle = if is_wall { ["query", "reference"].as_slice() } else { &["move"] };
        let idle: Vec<&str> =
            idle.iter().copied().filter(|k| said(k).is_some_and(|v| is_yes(v) != Some(false))).collect();
        if !idle.is_empty() {
            let text = format!(
                "Pset_Enfilade states {} of an {}, where it means nothing",
                idle.join(" and "),
                p.class
            );
            told.push((b.place(p), text));
        }
        if let (true, Some(name), Some(text)) = (is_wall, said("name"), said("move")) {
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
