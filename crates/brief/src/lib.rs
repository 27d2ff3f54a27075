//! What a brief can ask for: the measures, all in one [table](TABLE), which way is better, and how options are looked
//! for.
//!
//! Plain values below all other crates. Nothing is computed here: the engine measures, the search looks.
//!
//! ```
//! use enfilade_brief::{Measure, Sense, entries};
//!
//! let depth = entries().find(|e| e.measure == Measure::MeanDepth).expect("every measure has an entry");
//! assert_eq!((depth.words.plain, depth.words.unit), ("Steps", "steps"));
//! assert_eq!(depth.better, Some(Sense::Min));
//! ```

pub mod column;
pub mod demand;
mod measure;
mod table;
mod work;

use serde::{Deserialize, Serialize};

pub use column::Heading;
pub use measure::{Growth, Measure, Source};
pub use table::{Entry, Row, TABLE, Wording, column_of, columns, entries, rows};
pub use work::WorkKind;

/// Whether more or less of something is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sense {
    /// More is better.
    Max,
    /// Less is better.
    Min,
}

impl Sense {
    /// The value turned so that more is better (its own inverse).
    pub fn gain(self, value: f64) -> f64 {
        match self {
            Self::Max => value,
            Self::Min => -value,
        }
    }
}

/// What is wanted of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Several layouts, all good, really different.
    #[default]
    Diverse,
    /// The single optimum.
    Best,
}

/// How a search goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// What reaches most: a surrogate-led climb, then feasible spreading.
    #[default]
    Default,
    /// Algorithms 1 and 2 as published, for comparison.
    Paper,
}
