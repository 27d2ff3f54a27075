//! The front of gain against effort, of works together.

use serde::{Deserialize, Serialize};

use super::built::{Effort, OptionWork};
use super::gain::{Gains, Numbers};

/// A point of the front of gain against effort: no other works that were counted bring as much for less wall.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FrontPoint {
    /// Its number, from 1, the cheapest first.
    pub point: usize,
    /// The names of its works.
    pub words: String,
    /// Confirmed gains, by measure.
    pub gain: Gains,
    /// Means of the layout with them.
    pub mean: Numbers,
    /// What its works cost together.
    pub effort: Effort,
    /// Whether more of a private room is seen while that room's door stands open.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub shows_private: bool,
    /// The option that has these works and moves nothing, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub option: Option<usize>,
    /// Its works.
    pub works: Vec<OptionWork>,
}
