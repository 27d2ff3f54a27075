//! Columns of the table of cells, under depthmapX's names where it has them.

/// What stands at the head of a column: its name, what a unit of it is, what it tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heading {
    /// Name of the column, without the radius.
    pub name: &'static str,
    /// What one unit is; empty for plain numbers.
    pub unit: &'static str,
    /// In plain words.
    pub meaning: &'static str,
}

/// Unit of a direction.
pub const DEGREES: &str = "°";

/// Evenness without the cells that see nothing; the measure `entropy` is 0 there.
pub const VISUAL_ENTROPY: &str = "Visual Entropy";
/// Beside an estimated mean depth: half the width of its interval.
pub const MEAN_DEPTH_INTERVAL: &str = "Visual Mean Depth CI95";
/// Where most of the polygon seen lies.
pub const DRIFT_ANGLE: &str = "Isovist Drift Angle";
/// Cells that the metric means are taken over.
pub const METRIC_NODE_COUNT: &str = "Metric Node Count";
/// Cells that the angular means are taken over.
pub const ANGULAR_NODE_COUNT: &str = "Angular Node Count";
/// Views from chosen points.
pub const VISUAL_STEP_DEPTH: &str = "Visual Step Depth";
/// Turning on the shortest way from chosen points.
pub const METRIC_STEP_TURN: &str = "Metric Step Shortest-Path Turn";
/// Length of the shortest way from chosen points.
pub const METRIC_STEP_LENGTH: &str = "Metric Step Shortest-Path Length";
/// Least turning from chosen points.
pub const ANGULAR_STEP_DEPTH: &str = "Angular Step Depth";
