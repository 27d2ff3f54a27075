//! Sizes by which walls and doors are known, and how far they slide by default.

/// How far a door gap slides along its wall.
pub const SLIDE_M: f64 = 0.5;

/// Widths of a gap that counts as a door.
pub const DOOR_WIDTH_M: [f64; 2] = [0.6, 2.0];

/// Wall pieces nearer than this are one element.
pub const TOUCH_M: f64 = 0.05;

/// A door that could slide less than this stays.
pub(super) const SLIDE_MIN_M: f64 = 0.1;

/// How far a partition slides at most.
pub const PARTITION_SLIDE_M: f64 = 0.6;

/// Thickest wall that is a partition; thicker ones carry.
pub(super) const PARTITION_THICKNESS_MAX_M: f64 = 0.3;

/// Parallel faces nearer than this are the two sides of one wall.
pub const WALL_THICKNESS_MAX_M: f64 = 0.6;
