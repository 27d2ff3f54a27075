//! Rule sets: lists of items with name, edition and source, as data.

use enfilade_brief::demand::{Clause, demands};
use serde::Deserialize;

use crate::answer::{Asked, Origin};

/// The files.
const FILES: [(&str, &str); 6] = [
    ("ways-out-35m", include_str!("../rules/ways-out-35m.toml")),
    ("ways-out-200ft", include_str!("../rules/ways-out-200ft.toml")),
    ("barrier-free", include_str!("../rules/barrier-free.toml")),
    ("barrier-free-wheelchair", include_str!("../rules/barrier-free-wheelchair.toml")),
    ("habitable-irc", include_str!("../rules/habitable-irc.toml")),
    ("view-out", include_str!("../rules/view-out.toml")),
];

/// A rule set.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RuleSet {
    /// What it is called in a brief.
    pub name: String,
    /// Its title in words.
    pub title: String,
    /// The edition that it follows.
    pub edition: String,
    /// Where that is published.
    pub source: String,
    /// What it leaves out.
    pub leaves_out: String,
    /// Its items.
    pub item: Vec<RuleItem>,
}

/// An item of a rule set.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RuleItem {
    /// The item, as in a brief.
    pub ask: String,
    /// Where it stands in the source.
    pub place: String,
}

/// Names of all rule sets.
pub fn rule_names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|f| f.0)
}

/// A rule set by its name.
///
/// # Errors
/// An unknown name, with those that are known; what is wrong with its file.
pub fn rule_set(name: &str) -> Result<RuleSet, String> {
    let file = FILES.iter().find(|f| f.0 == name).ok_or_else(|| {
        let names: Vec<&str> = rule_names().collect();
        format!("there is no rule set `{name}`, expected one of {}", names.join(", "))
    })?;
    toml::from_str(file.1).map_err(|e| format!("{name}: {e}"))
}

impl RuleSet {
    /// Its items, ready to be checked.
    ///
    /// # Errors
    /// What of an item cannot be read.
    pub fn asked(&self) -> Result<Vec<Asked>, String> {
        let mut out = Vec::new();
        for item in &self.item {
            for clause in demands(&item.ask)? {
                let Clause::Demand(demand) = clause else {
                    return Err(format!("{}: a rule set holds no rule sets", self.name));
                };
                let title = format!("{}, {}", self.title, self.edition);
                let origin = Origin::Rule { rule: self.name.clone(), title, place: item.place.clone() };
                out.push(Asked { demand, origin, ground: None });
            }
        }
        Ok(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_set_can_be_read() {
        for name in rule_names() {
            let set = rule_set(name).unwrap();
            assert_eq!(set.name, name);
            assert!(!set.asked().unwrap().is_empty(), "{name}");
            assert!(!set.edition.is_empty() && !set.source.is_empty() && !set.leaves_out.is_empty());
            // A plan shows one of the three things that EN 17037 asks of a view.
            assert!(!set.title.to_lowercase().contains("passed"));
        }
        assert!(rule_set("none-such").unwrap_err().contains("ways-out-35m"));
    }
}
