//! The brief of rooms: items in words, and rule sets by their names.

use serde::{Deserialize, Serialize};

use enfilade_brief::demand::demands;
use enfilade_report::{Error, Place};

use super::is_none;

/// What a source of settings says of the brief: as one text, or as a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum BriefText {
    /// `kitchen area min 8 m2; rule=ways-out-35m`.
    Text(String),
    /// Items and rule sets, one by one.
    Table(BriefTable),
}

/// The brief as a table of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BriefTable {
    /// Items in words.
    #[serde(default)]
    pub items: Vec<String>,
    /// Names of rule sets.
    #[serde(default)]
    pub rules: Vec<String>,
}

/// Items and rules as they are written, one by one.
pub(crate) fn brief(said: Option<BriefText>) -> Result<Vec<String>, Error> {
    let text = match said {
        Some(BriefText::Text(text)) if !is_none(&text) => text,
        Some(BriefText::Table(table)) => {
            let rules = table.rules.iter().map(|r| format!("rule={r}"));
            table.items.iter().cloned().chain(rules).collect::<Vec<_>>().join(";")
        }
        _ => return Ok(Vec::new()),
    };
    let read = demands(&text).map_err(|why| {
        Error::usage("settings", Place::default(), format!("brief: {why}; nothing was done"))
    })?;
    Ok(read.iter().map(ToString::to_string).collect())
}

#[cfg(test)]
mod tests {
    use crate::{Partial, Settings};

    #[test]
    fn a_brief_is_a_text_or_a_table() {
        let of = |toml: &str| Partial::from_toml("x.toml", toml).and_then(Settings::new).map(|s| s.brief);
        let wanted = ["kitchen area min 8 m2", "rule=ways-out-35m"];
        assert_eq!(of("brief = \"kitchen area min 8m2; rule=ways-out-35m\"").unwrap(), wanted);
        let table = "[brief]\nitems = [\"kitchen area min 8 m2\"]\nrules = [\"ways-out-35m\"]";
        assert_eq!(of(table).unwrap(), wanted);
        assert!(of("").unwrap().is_empty() && of("brief = \"none\"").unwrap().is_empty());
        let wrong = of("seed = 1\nbrief = \"kitchen are min 8 m2\"").unwrap_err().to_string();
        assert!(wrong.contains("has-window") && wrong.contains("x.toml"), "{wrong}");
    }
}
