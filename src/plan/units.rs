//! Which unit a drawing is in, by what is drawn: door leaves, wall thicknesses, the building's size.

use std::collections::BTreeMap;

use glam::DVec2;

use super::curve::{bulge_arc, sweep_rad};
use super::drawing::{Drawing, Entity, Format, Shape, Unit};
use super::frame::{BUILT_SIZE_M, SMALL_PLAN_M, UNITS, UnitChoice, human_scale, two_digits};
use super::parallels::{Piece, parallels, pieces};

/// Widths of door leaves, metres.
const LEAF_M: [f64; 2] = [0.55, 1.25];

/// Thicknesses of walls, metres: a board to old masonry.
const THICK_M: [f64; 2] = [0.06, 0.65];

/// Thicknesses of plaster and boards, metres: their lines lie inside a wall's faces, and behind them the core is
/// these many times as thick.
const FINISH_M: [f64; 2] = [0.006, 0.05];
const CORE_TIMES: [f64; 2] = [2.5, 20.0];

/// How many lines to either side of a face are looked at: a finish, the core, the other finish.
const LINES_OF_WALL: usize = 3;

/// Sizes of buildings that are believed, metres, and those that are likely.
const SIZE_M: [f64; 2] = [2.5, 2_000.0];
const LIKELY_SIZE_M: [f64; 2] = [4.0, 400.0];

/// Sizes by which a missing unit is chosen where nothing else speaks: narrower, so that exactly one of
/// neighbouring units fits most buildings.
const USUAL_SIZE_M: [f64; 2] = [8.0, 400.0];

/// Swings that make doors a witness, and those that decide against a declared unit. One that fills a gap between
/// two wall ends does both.
const SWINGS_MIN: usize = 2;
const SWINGS_SURE: usize = 4;

/// How near a swing's hinge and latch are to ends of walls, as a share of the leaf.
const HUNG_SLACK: f64 = 0.35;

/// Paired pieces, and their share of all length, that make wall thickness a witness.
const PAIRS_MIN: usize = 8;
const PAIRS_SHARE: f64 = 0.25;

/// Faces farther apart than this share of the walls' extent, in the middle, are those of rooms: the walls are
/// drawn with one line and tell no thickness.
const THICK_SHARE_MAX: f64 = 0.06;

/// Walls thicker than this are none in the unit that makes them so, if so large a share of all length has a second face
/// that they are no rooms drawn with single lines.
const MASONRY_MAX_M: f64 = 2.5;
const PAIRS_SURE_SHARE: f64 = 0.75;

/// Nor are they those of walls where more than this share of the plan lies between them.
const BETWEEN_SHARE_MAX: f64 = 0.3;

/// A swing sweeps about a quarter turn.
const SWING_RAD: [f64; 2] = [1.0, 1.75];

/// How near a leaf's length and foot are to radius and centre, as a share of the radius.
const LEAF_SLACK: f64 = 0.12;

/// What `$MEASUREMENT` counts (programs write it without asking: little), and what metric units count
/// where nothing is said: programs of imperial countries do say it.
const SYSTEM_SAID: f64 = 0.05;
const METRIC_USUAL: f64 = 0.6;

/// A witness speaks against a unit up to this support, and for it from this on.
const AGAINST: f64 = 0.15;
const FOR: f64 = 0.5;

/// What was measured, drawing units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Witnesses {
    /// Radii of door swings that have a leaf.
    pub leaves: Vec<f64>,
    /// Whether one of them fills a gap between ends of walls.
    pub is_hung: bool,
    /// Distances of wall faces with the length they are seen along.
    pub thicknesses: Vec<(f64, f64)>,
    /// For each of them the distances to the next lines beyond the nearest, of which one may be the wall's
    /// other face.
    pub beyond: Vec<Vec<f64>>,
    /// Share of the walls' length that has a second face.
    pub paired_share: f64,
    /// Share of the walls' box that lies between neighbouring faces.
    pub between_share: f64,
    /// Longer side of the walls.
    pub extent: f64,
}

impl Witnesses {
    /// Looks at the walls, and at the whole drawing for door swings.
    pub fn new(drawing: &Drawing, walls: &[&Entity], extent: f64) -> Self {
        let found = pieces(walls.iter().copied());
        let distances = parallels(&found, extent * 1e-6, LINES_OF_WALL);
        let total: f64 = found.iter().map(Piece::length).sum();
        let (mut thicknesses, mut beyond) = (Vec::new(), Vec::new());
        for (piece, mut lines) in found.iter().zip(distances) {
            lines.sort_by(f64::total_cmp);
            // A face is longer than its wall is thick.
            if let Some(nearest) = lines.first().filter(|d| piece.length() > **d) {
                thicknesses.push((*nearest, piece.length()));
                beyond.push(lines[1..].to_vec());
            }
        }
        let paired: f64 = thicknesses.iter().map(|t| t.1).sum();
        let paired_share = if total > 0.0 { paired / total } else { 0.0 };
        let ends = found.iter().flat_map(|p| [p.a, p.b]);
        let ground = super::box_of(ends).map_or(0.0, |[lo, hi]| (hi - lo).element_product());
        let between = thicknesses.iter().map(|(d, length)| d * length).sum::<f64>() / 2.0;
        let between_share = if ground > 0.0 { between / ground } else { 0.0 };
        let swings = swings(drawing);
        // Where there are many, each need not be looked at.
        let is_hung = swings.len() < SWINGS_SURE && swings.iter().any(|s| s.is_hung(&found));
        let leaves = swings.iter().map(|s| s.radius).collect();
        Self { leaves, is_hung, thicknesses, beyond, paired_share, between_share, extent }
    }

    fn doors(&self, unit: Unit) -> Option<f64> {
        let fit = self.leaves.iter().filter(|r| is_in(**r * unit.metres, LEAF_M)).count();
        let speaks = self.is_hung || self.leaves.len() >= SWINGS_MIN;
        speaks.then(|| fit as f64 / self.leaves.len() as f64)
    }

    /// Whether doors alone can decide.
    fn has_sure_doors(&self) -> bool {
        self.is_hung || self.leaves.len() >= SWINGS_SURE
    }

    /// Whether the lines beside a face are those of a wall: its other face, or finish and then the other face.
    fn is_wall(&self, face: usize, unit: Unit) -> bool {
        let nearest = self.thicknesses[face].0;
        let is_core = |d: &f64| {
            is_in(d / nearest, CORE_TIMES)
                && is_in(d * unit.metres, THICK_M)
                && *d <= THICK_SHARE_MAX * self.extent
        };
        let has_finish = is_in(nearest * unit.metres, FINISH_M);
        is_in(nearest * unit.metres, THICK_M)
            || has_finish && self.beyond.get(face).is_some_and(|lines| lines.iter().any(is_core))
    }

    fn walls(&self, unit: Unit) -> Option<f64> {
        let total: f64 = self.thicknesses.iter().map(|t| t.1).sum();
        let walls = (0..self.thicknesses.len()).filter(|i| self.is_wall(*i, unit));
        let fit: f64 = walls.map(|i| self.thicknesses[i].1).sum();
        let is_thickness = self.between_share <= BETWEEN_SHARE_MAX
            && self.middle_thickness().is_some_and(|t| t <= THICK_SHARE_MAX * self.extent);
        let speaks = is_thickness && self.thicknesses.len() >= PAIRS_MIN && self.paired_share >= PAIRS_SHARE;
        speaks.then(|| fit / total)
    }

    fn size(&self, unit: Unit) -> f64 {
        let size = self.extent * unit.metres;
        if is_in(size, LIKELY_SIZE_M) {
            1.0
        } else if is_in(size, SIZE_M) {
            0.5
        } else {
            0.0
        }
    }

    /// Support of each witness that speaks.
    fn supports(&self, unit: Unit) -> Vec<f64> {
        self.doors(unit).into_iter().chain(self.walls(unit)).chain([self.size(unit)]).collect()
    }

    /// The middle thickness of the walls, weighted by length; drawing units.
    fn middle_thickness(&self) -> Option<f64> {
        let mut by_length = self.thicknesses.clone();
        by_length.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = by_length.iter().map(|t| t.1).sum::<f64>() / 2.0;
        let mut sum = 0.0;
        let middle = by_length.iter().find(|t| {
            sum += t.1;
            sum >= half
        });
        middle.map(|t| t.0)
    }

    /// The scale at which a plan that is drawn as large as its paper is printed, where doors speak: the one that makes
    /// their leaves as wide as usual, if walls and size are then those of a building.
    fn printed_at(&self, unit: Unit) -> Option<f64> {
        let mut leaves = self.leaves.clone();
        leaves.sort_by(f64::total_cmp);
        let leaf_m = leaves.get(leaves.len() / 2)? * unit.metres;
        let off = |scale: &f64| (leaf_m * scale / USUAL_LEAF_M).ln().abs();
        let scale = scales(unit).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let full = Unit { name: unit.name, metres: unit.metres * scale };
        let is_right = self.doors(full)? >= FOR && self.supports(full).iter().all(|s| *s >= FOR);
        is_right.then_some(scale)
    }

    /// Whether the walls have two faces for sure, and are thicker in this unit than any masonry.
    fn is_too_thick(&self, unit: Unit) -> bool {
        let is_thick = |t: f64| t * unit.metres > MASONRY_MAX_M;
        self.walls(unit).is_some_and(|s| s <= AGAINST)
            && self.paired_share >= PAIRS_SURE_SHARE
            && self.middle_thickness().is_some_and(is_thick)
    }

    /// What speaks for a unit, in plain words.
    fn words(&self, unit: Unit) -> String {
        let size = self.extent * unit.metres;
        let mut words = vec![format!("the walls are {size:.1} m long")];
        if let Some(d) = self.walls(unit).and_then(|_| self.middle_thickness()) {
            words.push(format!("wall faces {:.2} m apart", d * unit.metres));
        }
        if self.doors(unit).is_some() {
            let mut leaves = self.leaves.clone();
            leaves.sort_by(f64::total_cmp);
            let middle = leaves[leaves.len() / 2] * unit.metres;
            words.push(match leaves.len() {
                1 => format!("1 door leaf of about {middle:.2} m"),
                n => format!("{n} door leaves of about {middle:.2} m"),
            });
        }
        words.join(", ")
    }
}

/// Heights of walls, metres: those of which a stated unit is believed, and those by which one is found.
pub(super) const HEIGHT_BELIEVED_M: [f64; 2] = [0.3, 60.0];
const HEIGHT_USUAL_M: [f64; 2] = [2.0, 6.0];

/// The height that walls have where none of the units makes them as high as usual.
const HEIGHT_M: f64 = 2.7;

/// The unit of a building by the heights of its walls (file units): the first in which the middle one is usual, else
/// the one in which it comes nearest to a storey. `None` without heights.
pub fn by_heights(heights: &[f64]) -> Option<Unit> {
    let middle = middle_height(heights)?;
    let off = |u: &Unit| (middle * u.metres / HEIGHT_M).ln().abs();
    let usual = UNITS.into_iter().find(|u| is_in(middle * u.metres, HEIGHT_USUAL_M));
    usual.or_else(|| UNITS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))))
}

/// The unit by the heights of walls where they cannot be as high as the stated one makes them.
pub fn implausible_by_heights(heights: &[f64], stated: Unit) -> Option<Unit> {
    let middle = middle_height(heights).filter(|h| !is_in(h * stated.metres, HEIGHT_BELIEVED_M))?;
    by_heights(&[middle]).filter(|u| is_in(middle * u.metres, HEIGHT_BELIEVED_M))
}

fn middle_height(heights: &[f64]) -> Option<f64> {
    let mut known: Vec<f64> = heights.iter().copied().filter(|h| h.is_finite() && *h > 0.0).collect();
    known.sort_by(f64::total_cmp);
    known.get(known.len() / 2).copied()
}

/// Plans longer than this are never taken at an unknown scale.
const SCALELESS_MAX_M: f64 = 30.0;

/// Walls thinner than this are drawn at another scale.
const THIN_M: f64 = 0.03;

/// The thickness that walls drawn at another scale are taken to have.
const USUAL_WALL_M: f64 = 0.15;

/// Scales at which plans are printed: how many metres one metre on paper stands for, in metric and in imperial countries.
const SCALES_METRIC: [f64; 9] = [10.0, 20.0, 25.0, 50.0, 100.0, 200.0, 250.0, 500.0, 1000.0];
const SCALES_IMPERIAL: [f64; 9] = [12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0, 128.0, 192.0];

/// The width that a leaf is taken to have where the scale is found by it.
const USUAL_LEAF_M: f64 = 0.9;

/// Faces in pairs, and their share of all length, by which even a small drawing shows how thick its walls are.
const PAIRS_FEW: usize = 4;
const PAIRS_FEW_SHARE: f64 = 0.6;

/// Metres of the plan in one metre of a person, for plans drawn at an unknown scale (illustrations): decided by
/// the scale at which its doors are as wide as doors in a plan smaller than a building, by the thickness of the walls
/// where they are drawn with one, else by the plan's size ([`human_scale`]). What an IFC or a glTF says is believed
/// from the length of one wall on.
pub fn person_scale(drawing: &Drawing, walls: &[&Entity], extent_units: f64, unit: Unit) -> f64 {
    let size_m = extent_units * unit.metres;
    let is_stated = drawing.format != Format::Dxf && size_m >= BUILT_SIZE_M[0];
    if size_m >= SCALELESS_MAX_M || is_stated {
        return 1.0;
    }
    let seen = Witnesses::new(drawing, walls, extent_units);
    if let Some(scale) =
        seen.printed_at(unit).filter(|_| size_m < SMALL_PLAN_M && drawing.format == Format::Dxf)
    {
        return 1.0 / scale;
    }
    let is_thick = seen.thicknesses.len() >= PAIRS_FEW && seen.paired_share >= PAIRS_FEW_SHARE;
    let has_thickness = is_thick || seen.walls(unit).is_some();
    let thickness_m = seen.middle_thickness().filter(|_| has_thickness).map(|t| t * unit.metres);
    match thickness_m {
        Some(t) if is_in(t, THICK_M) => 1.0,
        Some(t) if t > 0.0 && t < THIN_M && size_m >= SMALL_PLAN_M => two_digits(t / USUAL_WALL_M),
        _ => human_scale(size_m),
    }
}

/// Whether plans drawn in this unit are printed at this scale.
pub(super) fn is_printed(unit: Unit, scale: f64) -> bool {
    unit.name != "units" && scales(unit).contains(&scale)
}

fn scales(unit: Unit) -> [f64; 9] {
    if matches!(unit.name, "in" | "ft") { SCALES_IMPERIAL } else { SCALES_METRIC }
}

fn is_in(value: f64, range: [f64; 2]) -> bool {
    (range[0]..=range[1]).contains(&value)
}

/// Decides the unit: the user's word, else the file's unless what is drawn speaks strongly against it,
/// else what fits the drawing best.
///
/// `extent_units` is the longer side of the drawn walls in drawing units.
pub fn choose(drawing: &Drawing, user: Option<Unit>, walls: &[&Entity], extent_units: f64) -> UnitChoice {
    let said = &drawing.declared_unit_words;
    if let Some(unit) = user {
        let what = match unit.name {
            "units" => format!("one drawing unit is {} m", unit.metres),
            name => name.into(),
        };
        let reason = format!("{what} as --unit or the settings file says (the file: {said})");
        return UnitChoice { unit, reason, is_assumed: false };
    }
    let seen = Witnesses::new(drawing, walls, extent_units);
    if let Some(unit) = drawing.unit_by_heights {
        let words = seen.words(unit);
        let reason = format!(
            "{} assumed by the height of the walls ({said}): then {words}; --unit overrides it",
            unit.name
        );
        return UnitChoice { unit, reason, is_assumed: true };
    }
    let Some(declared) = drawing.declared_unit else {
        let unit = best(&seen, said);
        let words = seen.words(unit);
        let reason = format!("{} assumed ({said}): then {words}; --unit overrides it", unit.name);
        return UnitChoice { unit, reason, is_assumed: true };
    };
    let spoken_for = overruled(&seen, declared, said);
    // A building's heights were taken in the unit that its file or its format states.
    let is_building = drawing.format != Format::Dxf;
    match spoken_for.filter(|_| !is_building) {
        Some(unit) => {
            let (then, else_words) = (seen.words(unit), seen.words(declared));
            let reason = format!(
                "{} assumed although the file says {} ({said}): then {then}; in {} {else_words}; --unit overrides it",
                unit.name, declared.name, declared.name
            );
            UnitChoice { unit, reason, is_assumed: true }
        }
        None => {
            let agree = seen.supports(declared).iter().filter(|s| **s >= FOR).count();
            let words = match spoken_for {
                Some(unit) => format!(
                    "; {}, in {} {}: --unit {} reads it so",
                    seen.words(declared),
                    unit.name,
                    seen.words(unit),
                    unit.name
                ),
                None if agree >= 2 => format!("; {} fit", seen.words(declared)),
                None => String::new(),
            };
            let reason = format!("{} by {said}{words}", declared.name);
            UnitChoice { unit: declared, reason, is_assumed: false }
        }
    }
}

/// The likeliest unit of a drawing that declares none.
fn best(seen: &Witnesses, said: &str) -> Unit {
    let score = |unit: Unit| {
        let usual = if is_in(seen.extent * unit.metres, USUAL_SIZE_M) { 1.0 } else { 0.0 };
        let doors = seen.doors(unit).unwrap_or(0.0);
        let walls = seen.walls(unit).unwrap_or(0.0);
        let of_system = match system(unit, said) {
            Some(is_of_it) => f64::from(u8::from(is_of_it)) * SYSTEM_SAID,
            None => f64::from(u8::from(!matches!(unit.name, "in" | "ft"))) * METRIC_USUAL,
        };
        seen.size(unit) + usual + 2.0 * doors + 2.0 * walls + of_system
    };
    // The first of equals: the order of UNITS is by how usual they are.
    UNITS.into_iter().rev().max_by(|a, b| score(*a).total_cmp(&score(*b))).unwrap_or(UNITS[0])
}

/// Whether the unit belongs to the system of measures the header names, if it names one.
fn system(unit: Unit, said: &str) -> Option<bool> {
    let is_imperial = matches!(unit.name, "in" | "ft");
    if said.contains("no $MEASUREMENT") {
        None
    } else if said.contains("$MEASUREMENT 0") {
        Some(is_imperial)
    } else {
        said.contains("$MEASUREMENT 1").then_some(!is_imperial)
    }
}

/// The unit that what is drawn speaks for, where it speaks strongly against the declared one: two
/// witnesses against it, several door leaves of an impossible width, or walls thicker than any; and nothing against the
/// other.
fn overruled(seen: &Witnesses, declared: Unit, said: &str) -> Option<Unit> {
    let against = seen.supports(declared).iter().filter(|s| **s <= AGAINST).count();
    let impossible_doors = seen.has_sure_doors() && seen.doors(declared).is_some_and(|s| s <= AGAINST);
    if against < 2 && !impossible_doors && !seen.is_too_thick(declared) {
        return None;
    }
    let unit = best(seen, said);
    let supports = seen.supports(unit);
    let is_agreed = supports.len() >= 2 && supports.iter().all(|s| *s >= FOR);
    let by_doors = seen.doors(unit).is_some_and(|s| s >= FOR) && seen.size(unit) >= FOR;
    let is_sure = is_agreed || impossible_doors && by_doors;
    (is_sure && unit.metres != declared.metres).then_some(unit)
}

/// An arc that sweeps about a quarter turn, drawing units.
struct Swing {
    centre: DVec2,
    radius: f64,
    ends: [DVec2; 2],
}

impl Swing {
    fn new(centre: DVec2, radius: f64, from_rad: f64, sweep_rad: f64) -> Self {
        let ends = [from_rad, from_rad + sweep_rad].map(|t| centre + DVec2::from_angle(t) * radius);
        Self { centre, radius, ends }
    }

    /// Whether its leaf fills a gap: its hinge and its latch are at ends of walls.
    fn is_hung(&self, walls: &[Piece]) -> bool {
        let slack = HUNG_SLACK * self.radius;
        let is_end = |p: DVec2| walls.iter().any(|w| w.a.distance(p) < slack || w.b.distance(p) < slack);
        is_end(self.centre) && self.ends.iter().any(|p| is_end(*p))
    }
}

/// Arcs that sweep about a quarter turn and have a leaf: a straight piece from the centre to the arc, as long as
/// the radius.
fn swings(drawing: &Drawing) -> Vec<Swing> {
    let arcs: Vec<Swing> = drawing.entities.iter().flat_map(arcs_of).collect();
    if arcs.is_empty() {
        return Vec::new();
    }
    // Pieces by their length in steps of 5 %, so that an arc looks only at those as long as it is wide.
    let step = |length: f64| (length.ln() / 0.05).floor() as i64;
    let mut by_length: BTreeMap<i64, Vec<Piece>> = BTreeMap::new();
    let radii: std::collections::BTreeSet<i64> =
        arcs.iter().flat_map(|a| (-3..=3).map(|k| step(a.radius) + k)).collect();
    for piece in pieces(drawing.entities.iter()) {
        let length = piece.length();
        if length > 0.0 && radii.contains(&step(length)) {
            by_length.entry(step(length)).or_default().push(piece);
        }
    }
    let has_leaf = |centre: DVec2, radius: f64| {
        let slack = LEAF_SLACK * radius;
        let near = (-3..=3).filter_map(|k| by_length.get(&(step(radius) + k))).flatten();
        let mut leaves = near.filter(|p| (p.length() - radius).abs() <= slack);
        leaves.any(|p| p.a.distance(centre) <= slack || p.b.distance(centre) <= slack)
    };
    arcs.into_iter().filter(|s| has_leaf(s.centre, s.radius)).collect()
}

fn arcs_of(e: &Entity) -> Vec<Swing> {
    let is_swing = |sweep: f64| is_in(sweep.abs(), SWING_RAD);
    match &e.shape {
        Shape::Arc { centre, radius, start_rad, end_rad } if is_swing(sweep_rad(*start_rad, *end_rad)) => {
            vec![Swing::new(*centre, *radius, *start_rad, sweep_rad(*start_rad, *end_rad))]
        }
        Shape::Polyline { vertices, .. } => {
            let arcs = vertices.windows(2).filter_map(|v| bulge_arc(v[0].at, v[1].at, v[0].bulge));
            arcs.filter(|arc| is_swing(arc.3))
                .map(|(c, r, from, sweep)| Swing::new(c, r, from, sweep))
                .collect()
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(name: &str) -> Unit {
        super::super::frame::unit_by_name(name).unwrap()
    }

    /// A house with walls 0.2 m thick and door leaves of 0.9 m, drawn in the unit.
    fn house(u: Unit) -> Witnesses {
        let scale = 1.0 / u.metres;
        Witnesses {
            leaves: vec![0.9 * scale; 5],
            thicknesses: vec![(0.2 * scale, 4.0 * scale); 20],
            paired_share: 0.9,
            extent: 14.0 * scale,
            ..Witnesses::default()
        }
    }

    #[test]
    fn every_unit_is_found_and_defended() {
        for drawn in UNITS {
            let seen = house(drawn);
            assert_eq!(best(&seen, "$INSUNITS 0").name, drawn.name);
            for declared in UNITS {
                let expected = (declared.name != drawn.name).then_some(drawn.name);
                assert_eq!(overruled(&seen, declared, "").map(|u| u.name), expected, "{}", declared.name);
            }
        }
    }

    #[test]
    fn the_height_of_walls_tells_the_unit() {
        for (heights, expected) in [
            (vec![2.6, 2.6, 5.0], "m"),
            (vec![3200.0, 2700.0, 400.0], "mm"),
            (vec![270.0], "cm"),
            (vec![120.0], "in"),
            (vec![9.0, 9.0, f64::NAN, 0.0], "ft"),
        ] {
            assert_eq!(by_heights(&heights).map(|u| u.name), Some(expected), "{heights:?}");
        }
        assert_eq!(by_heights(&[0.0, f64::INFINITY]), None);
        let doubted = |h: f64| implausible_by_heights(&[h], unit("m")).map(|u| u.name);
        assert_eq!((doubted(2700.0), doubted(1.0), doubted(40.0)), (Some("mm"), None, None));
        assert_eq!(doubted(0.027), None, "no unit makes a model as high as a house");
    }

    /// Rooms of 5 m drawn with single lines, 267 m long: their width is no thickness in inches.
    #[test]
    fn what_covers_much_of_the_plan_is_no_wall() {
        let rooms = |between_share: f64| Witnesses {
            thicknesses: vec![(5.0, 20.0); 30],
            paired_share: 0.56,
            between_share,
            extent: 267.0,
            ..Witnesses::default()
        };
        assert_eq!(best(&rooms(0.36), "no $INSUNITS").name, "m");
        assert_eq!(best(&rooms(0.1), "no $INSUNITS").name, "in");
    }

    /// A plan without doors, its walls in millimetres: in inches or centimetres they would be thicker than any masonry.
    #[test]
    fn walls_thicker_than_any_speak_against_a_unit() {
        let plan = |paired_share: f64| Witnesses {
            thicknesses: vec![(300.0, 9000.0); 12],
            paired_share,
            extent: 10_000.0,
            ..Witnesses::default()
        };
        for declared in ["in", "cm", "ft"] {
            let found =
                |paired_share: f64| overruled(&plan(paired_share), unit(declared), "").map(|u| u.name);
            assert_eq!(found(0.9), Some("mm"), "{declared}");
        }
        // Rooms of 3 m in a large plan of single lines; walls of a castle.
        assert_eq!(overruled(&plan(0.6), unit("cm"), ""), None);
        let castle = Witnesses {
            thicknesses: vec![(2.4, 20.0); 12],
            paired_share: 0.9,
            extent: 60.0,
            ..Witnesses::default()
        };
        assert_eq!(overruled(&castle, unit("m"), ""), None);
    }

    /// A plan in the millimetres of its paper: the scale is that which makes doors as wide as doors.
    #[test]
    fn doors_tell_the_scale_of_a_printed_plan() {
        for (scale, name) in
            [(50.0, "mm"), (100.0, "mm"), (200.0, "mm"), (100.0, "cm"), (96.0, "in"), (48.0, "in")]
        {
            let mut seen = house(Unit { name: "units", metres: unit(name).metres * scale });
            assert_eq!(seen.printed_at(unit(name)), Some(scale), "{scale} {name}");
            seen.leaves.clear();
            assert_eq!(seen.printed_at(unit(name)), None);
        }
    }

    #[test]
    fn a_single_witness_never_overrules() {
        let maze = Witnesses {
            thicknesses: vec![(2.0, 10.0); 30],
            paired_share: 1.0,
            extent: 20.0,
            ..Witnesses::default()
        };
        assert_eq!(overruled(&maze, unit("m"), ""), None);
        let tiny = Witnesses { extent: 0.9, ..Witnesses::default() };
        assert_eq!(overruled(&tiny, unit("m"), ""), None);
    }
}
