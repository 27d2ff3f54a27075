//! What a side-car names one by one: groups that move, regions, works, where an accepted drawing came from.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A group of nodes named in a side-car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct MoveTable {
    /// Name shown in results.
    #[serde(default)]
    pub name: Option<String>,
    /// `x -1 1; rotate -15 15`, as in a marker's text.
    pub moves: String,
    /// Wall ends, drawing units.
    #[serde(default)]
    pub nodes: Vec<[f64; 2]>,
    /// Handles of whole entities.
    #[serde(default)]
    pub handles: Vec<String>,
    /// Layers (globs) whose wall entities belong to the group.
    #[serde(default)]
    pub layers: Vec<String>,
    /// What the group's marker in the drawing says that `moves` replaces, as `accept` found it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub marker: Option<String>,
}

/// A region named in a side-car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct RegionTable {
    /// `query`, `reference` or `keep`.
    pub kind: String,
    /// The pair that a region of query or of reference belongs to; none: the unnamed one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pair: Option<String>,
    /// Corners of a closed polygon, drawing units.
    pub points: Vec<[f64; 2]>,
}

/// A building work that is decided, named in a side-car.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct WorkTable {
    /// `open`, `remove` or `new`, as the layers `EF-OPEN`, `EF-REMOVE` and `EF-NEW`.
    pub kind: String,
    /// Corners of a closed polygon, of what is new also the ends of a line; drawing units.
    pub points: Vec<[f64; 2]>,
    /// What a text beside it would say: `door 0.9m`, `glass`, `0.1m`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
}

/// An option that stays though it builds: its works, and how what moves beside them stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PinnedOption {
    /// Its parameters, as those of `pin`; empty: nothing moves.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<f64>,
    /// What it builds.
    pub works: Vec<PinnedWork>,
}

/// A building work, as result.json names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct PinnedWork {
    /// `open`, `widen`, `remove`, …
    pub kind: String,
    /// Ends of its stretch of wall, drawing frame, metres.
    pub stretch: [[f64; 2]; 2],
}

/// A move that the numbers of a layout belong to, as result.json names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct KnownMove {
    /// Name of the group.
    pub name: String,
    /// `x`, `y`, `along`, `rotate` or `scale`.
    pub kind: String,
    /// Unit of the number.
    pub unit: String,
    /// Direction of `along`, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction_deg: Option<f64>,
    /// Mark of the corners it moves.
    pub geometry: String,
}

/// Where an accepted drawing came from: one earlier round.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub struct LineageTable {
    /// Name of the drawing measured in that round.
    pub drawing: String,
    /// Round number; of the best so far of a stopped search the number that its round would have had.
    pub round: u32,
    /// Whether it was no finished round but the best so far.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub so_far: bool,
    /// Candidate that was accepted, from 1; 0: the best layout.
    pub candidate: u32,
    /// The point of its front that was accepted instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<u32>,
    /// Mark of spacing and regions: values of others are not compared. Empty where it is not known.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub ruler: String,
    /// Means of the present layout of that round.
    pub initial: BTreeMap<String, f64>,
    /// Means of the accepted candidate.
    pub accepted: BTreeMap<String, f64>,
}
