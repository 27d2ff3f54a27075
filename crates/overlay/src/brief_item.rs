//! An item of the brief of rooms with its verdict, as JSON and in words.

use serde::{Deserialize, Serialize};

use super::palette::{GREY, Rgb};
use enfilade_brief::demand::{DemandUnit, Weight};

/// Verdicts as they are named in JSON, with their sign and their colour: safe for colour-blind eyes.
pub(super) const VERDICTS: [(&str, &str, Rgb); 3] = [
    ("pass", "✓", [0x00, 0x9e, 0x73]),
    ("untold", "?", [0xe6, 0x9f, 0x00]),
    ("fail", "✗", [0xc8, 0x1e, 0x1e]),
];

/// An item with its verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BriefItem {
    /// Its number, from 1.
    pub id: usize,
    /// As it is written in a brief.
    pub ask: String,
    /// `limit`, `goal` or `note`.
    pub weight: String,
    /// The word of its kind.
    pub kind: String,
    /// Unit of its values.
    pub unit: Option<DemandUnit>,
    /// What is wanted, in words; empty where nothing is bounded.
    pub wanted: String,
    /// The least and the most that are wanted.
    pub least: Option<f64>,
    /// See `least`.
    pub most: Option<f64>,
    /// `pass`, `fail` or `untold`.
    pub verdict: String,
    /// The rule set, or the property or layer of the drawing, that asks; nothing where the brief does.
    pub origin: Option<BriefOrigin>,
    /// What was found, place by place.
    pub findings: Vec<BriefFinding>,
}

/// Who asks.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BriefOrigin {
    /// Name of the rule set, of the property or of the layer.
    pub name: String,
    /// Title and edition of the rule set.
    pub title: String,
    /// Where it stands in the source.
    pub place: String,
}

/// What was found at one place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BriefFinding {
    /// `pass`, `fail` or `untold`.
    pub verdict: String,
    /// Ids of the rooms; the first is the one that is judged.
    pub rooms: Vec<usize>,
    /// Doors and openings, as indices into `reading.openings` of `check`.
    pub openings: Vec<usize>,
    /// The value.
    pub measured: Option<f64>,
    /// In words.
    pub words: String,
    /// Ground: outlines and holes, metres of the drawing frame.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub ground: Vec<Vec<[f64; 2]>>,
    /// Lines: ways, walls, doors.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub lines: Vec<Vec<[f64; 2]>>,
    /// Circles: middle and radius.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub circles: Vec<[f64; 3]>,
}

/// Places of an item that are said one by one; more are counted.
const SAID_MAX: usize = 6;

impl BriefItem {
    /// `✗ kitchen area min 8 m2`, and a line for every place that does not pass, or for all where few do.
    pub fn lines(&self) -> Vec<String> {
        let weight = if self.weight == Weight::Limit.name() { "" } else { self.weight.as_str() };
        let by = self.origin.as_ref().map(|o| match o.place.is_empty() {
            true => o.name.clone(),
            false => format!("{}: {}", o.name, o.place),
        });
        let said: Vec<&str> =
            [Some(weight), by.as_deref()].into_iter().flatten().filter(|s| !s.is_empty()).collect();
        let tail = if said.is_empty() { String::new() } else { format!(" ({})", said.join("; ")) };
        let ask = self.ask.strip_prefix(&format!("{}: ", self.weight)).unwrap_or(&self.ask);
        let mut out = vec![format!("{} {ask}{tail}", sign(&self.verdict))];
        let is_worst = |f: &&BriefFinding| self.verdict == "pass" || f.verdict != "pass";
        let told: Vec<&BriefFinding> = self.findings.iter().filter(is_worst).collect();
        out.extend(told.iter().take(SAID_MAX).map(|f| format!("    {} {}", sign(&f.verdict), f.words)));
        if told.len() > SAID_MAX {
            out.push(format!("    and {} more", told.len() - SAID_MAX));
        }
        out
    }
}

pub(super) fn sign(verdict: &str) -> &'static str {
    VERDICTS.iter().find(|v| v.0 == verdict).map_or("?", |v| v.1)
}

pub(super) fn colour(verdict: &str) -> Rgb {
    VERDICTS.iter().find(|v| v.0 == verdict).map_or(GREY, |v| v.2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_item_is_said_with_its_places() {
        let finding = |verdict: &str, words: &str| BriefFinding {
            verdict: verdict.into(),
            words: words.into(),
            ..BriefFinding::default()
        };
        let item = BriefItem {
            ask: "goal: bedroom area min 10 m2".into(),
            weight: "goal".into(),
            verdict: "fail".into(),
            findings: vec![finding("pass", "Bedroom 1: 12.00 m²"), finding("fail", "Bedroom 2: 9.00 m²")],
            ..BriefItem::default()
        };
        assert_eq!(item.lines(), ["✗ bedroom area min 10 m2 (goal)", "    ✗ Bedroom 2: 9.00 m²"]);
    }
}
