//! Settings that are one of a few words.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What happens where the thresholds leave no room for options that differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Thresholds {
    /// They stand as they were stated; the options may be alike, and the report says so.
    Firm,
    /// They are lowered together, step by step, until the options stand `distance` apart.
    Yielding,
}

/// What a round does with a drawing of which something should be asked first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unsure {
    /// The present layout is measured and the questions are shown; no option is made.
    #[default]
    Ask,
    /// The reading is taken as it is.
    Optimise,
}

/// What options may do that none does otherwise: `structure, open-joints`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Allow {
    /// Move by default what carries, what holds fire up, and what parts dwellings.
    pub structure: bool,
    /// Open joints that are closed as drawn.
    pub open_joints: bool,
    /// Run walls through each other.
    pub crossings: bool,
    /// Leave ways and doors narrower than they must be.
    pub narrow_ways: bool,
    /// Move walls into stairs, furniture and fixtures.
    pub things: bool,
    /// Move by default by any length, not in steps.
    pub any_step: bool,
}

impl Allow {
    fn words(&mut self) -> [(&'static str, &mut bool); 6] {
        [
            ("structure", &mut self.structure),
            ("open-joints", &mut self.open_joints),
            ("crossings", &mut self.crossings),
            ("narrow-ways", &mut self.narrow_ways),
            ("things", &mut self.things),
            ("any-step", &mut self.any_step),
        ]
    }
}

impl fmt::Display for Allow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut own = *self;
        let said: Vec<&str> = own.words().into_iter().filter(|w| *w.1).map(|w| w.0).collect();
        f.write_str(if said.is_empty() { "none" } else { "" })?;
        f.write_str(&said.join(", "))
    }
}

impl FromStr for Allow {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut out = Self::default();
        for word in text.split(',').map(str::trim).filter(|w| !w.is_empty() && *w != "none") {
            let known = out.words().into_iter().find(|w| w.0 == word);
            *known.ok_or_else(|| word.to_owned())?.1 = true;
        }
        Ok(out)
    }
}

impl From<Allow> for String {
    fn from(allow: Allow) -> Self {
        allow.to_string()
    }
}

impl TryFrom<String> for Allow {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

/// Colours of heat maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colours {
    /// Safe for colour-blind eyes.
    #[default]
    Safe,
    /// The paper's blue to red.
    BlueToRed,
}

/// Where heat maps, notes and traces of a round are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Overlay {
    /// In the drawings, on layers of ours.
    #[default]
    Drawn,
    /// In a drawing of their own beside each, to be attached as a reference.
    Attach,
}

impl Overlay {
    /// Whether they are drawn in the drawings.
    pub fn is_drawn(&self) -> bool {
        *self == Self::Drawn
    }
}
