//! The table of sizes: what is built, what people need, and what slips of the hand leave, each with its reason. Metres of a
//! person. What only one step asks for stands beside it.

/// Drawn lengths below this are nothing: a click on the spot.
pub const ZERO_M: f64 = 0.001;

/// Two pieces this near to one line are one line: what snapping and rounding to whole millimetres or
/// sixteenths of an inch leave.
pub const COLLINEAR_M: f64 = 0.004;

/// A gap in a face or between the ends of two faces up to this width is a slip of the hand: no door,
/// no joint of a real wall is so narrow. Places nearer to one another are one.
pub const ERROR_GAP_M: f64 = 0.032;

/// A partition of boards on a stud, 75 to 125 mm: what is assumed where nothing says a thickness.
pub const THICKNESS_THIN_M: f64 = 0.1;

/// Thinnest wall that stands by itself: a board on a stud. Thinner stacks are layers of finish.
pub const THICKNESS_MIN_M: f64 = 0.03;

/// Thickest wall that is believed at all: old stone. The drawing's own limit is found below it.
pub const THICKNESS_MAX_M: f64 = 0.8;

/// Thickness up to which a pair of faces needs no company of equal pairs to be believed.
pub const THICKNESS_USUAL_M: f64 = 0.42;

/// Widest cavity between the two leaves of a wall: 50 to 150 mm are built.
pub const CAVITY_MAX_M: f64 = 0.15;

/// What a frame takes of a gap on each side at most: a leaf hangs at it, and is as much shorter. Lining and rebate of a timber
/// frame take up to 90 mm.
pub const JAMB_M: f64 = 0.09;

/// How far the hinge of a symbol lies from the end of the wall that it belongs to: the frame, and what the hand adds.
pub const FRAME_M: f64 = 0.15;

/// A layer up to this thickness beside a wall is its finish (plaster, boards, insulation strip).
pub const FINISH_MAX_M: f64 = 0.06;

/// A line this near to a wall's face, with nothing behind it, is a layer of that wall.
pub const LAYER_MAX_M: f64 = 0.2;

/// Thickest wall made by adding layers.
pub const LAYERED_MAX_M: f64 = 0.65;

/// Two faces that differ by up to this angle may be the sides of one wall (walls drawn by eye).
pub const SKEW_RAD: f64 = 0.06;

/// Two directions are at right angles where the sine between them is larger, 14 degrees, and one where the cosine is.
pub const SQUARE_SIN: f64 = 0.97;

/// Axis pieces whose lines differ by less than this angle are not crossed with each other.
pub const CROSSING_MIN_RAD: f64 = 0.12;

/// One face drawn through, the other interrupted by no more than this: a wall joins there, no door.
pub const ONE_SIDED_GAP_M: f64 = 0.45;

/// Narrowest gap that is an opening: a shaft door, a slit window.
pub const OPENING_MIN_M: f64 = 0.25;

/// Widest gap that is a passage without further evidence.
pub const PASSAGE_MAX_M: f64 = 3.0;

/// Widest opening with window lines or door leaves in it.
pub const OPENING_MAX_M: f64 = 8.0;

/// Widest opening between a wall's end and another wall's side.
pub const SIDE_OPENING_MAX_M: f64 = 1.3;

/// Largest side of a column.
pub const COLUMN_MAX_M: f64 = 1.5;

/// A closed box up to this ratio of its sides is a column, beyond it a piece of wall.
pub const COLUMN_ASPECT_MAX: f64 = 1.6;

/// Longest chord of a traced curve.
pub const CHORD_MAX_M: f64 = 1.6;

/// Circles whose centres are nearer than this are concentric: faces of one curved wall that were traced each by itself.
pub const CONCENTRIC_M: f64 = 0.06;

/// Largest turn between two chords of a traced curve (a circle of twelve chords).
pub const CHORD_TURN_MAX_RAD: f64 = 0.56;

/// How far a traced curve's corners may lie from the circle fitted to them.
pub const CIRCLE_FIT_M: f64 = 0.006;

/// How far a traced curve's chords may lie from the circle: coarse tracing.
pub const SAGITTA_MAX_M: f64 = 0.025;
