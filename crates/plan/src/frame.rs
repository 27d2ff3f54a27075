//! Units and frames: drawing units, the drawing frame in metres or micrometres, the plan frame.

use glam::DVec2;

use enfilade_cad::drawing::Unit;
use enfilade_engine::geometry::{PointUm, UM_PER_M};

/// Beyond this distance from the drawing's zero point the plan frame gets an origin of its own, so
/// that products of coordinates keep their digits.
pub const FAR_ORIGIN_M: f64 = 10_000.0;

/// Building sizes (longer side of the walls' box) that are believed without a word.
pub const PLAUSIBLE_SIZE_M: [f64; 2] = [SMALL_PLAN_M, 2_000.0];

/// The same where the file states its unit for sure, as buildings of an IFC or a glTF do: one wall may be all of it.
pub const BUILT_SIZE_M: [f64; 2] = [1.0, 2_000.0];

/// Plans smaller than this (longer side) are taken as drawn at an unknown scale: what is measured in
/// human sizes (doors, wall thickness, default moves) shrinks with them. The smallest houses are as long.
pub const SMALL_PLAN_M: f64 = 5.0;

/// The size that a plan of unknown scale is taken to stand for.
const USUAL_PLAN_M: f64 = 40.0;

/// Metres of the plan in one metre of a person: 1, but less in plans smaller than [`SMALL_PLAN_M`].
pub fn human_scale(size_m: f64) -> f64 {
    if size_m <= 0.0 || size_m >= SMALL_PLAN_M {
        return 1.0;
    }
    two_digits(size_m / USUAL_PLAN_M)
}

/// Rounded to two digits, so that what is derived from it reads well.
pub(super) fn two_digits(exact: f64) -> f64 {
    // By its digits: a product would read 0.0013000000000000002.
    format!("{exact:.1e}").parse().unwrap_or(exact)
}

/// Which unit the drawing is read in, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct UnitChoice {
    /// The unit.
    pub unit: Unit,
    /// Why, in plain words.
    pub reason: String,
    /// Whether the file did not say it and nobody confirmed it.
    pub is_assumed: bool,
}

/// How drawing units, the drawing frame and the plan frame relate.
///
/// *Drawing frame*: the file's coordinates times the unit; exact on whole micrometres. *Plan frame*:
/// the drawing frame minus [`Frame::origin_um`], in metres; the same as the drawing frame unless the
/// drawing lies farther than [`FAR_ORIGIN_M`] from its zero point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Metres in one drawing unit.
    pub metres_per_unit: f64,
    /// Plan-frame zero in the drawing frame.
    pub origin_um: PointUm,
}

/// What new points are written to, metres: a thousandth of what points are read to.
const WRITTEN_M: f64 = 1e-9;
/// Decimals beyond which no number of a drawing says anything.
const DECIMALS_MAX: f64 = 12.0;
/// Whole numbers up to this have no gaps: 2^53.
const WHOLE_MAX: f64 = 9_007_199_254_740_992.0;
/// Logarithms nearer to a whole number are that number.
const LOG_NOISE: f64 = 1e-9;

impl Frame {
    /// A frame whose origin lies near the box `[lo, hi]` (drawing units) if that is far away.
    pub fn new(metres_per_unit: f64, box_units: [DVec2; 2]) -> Self {
        let far = (box_units[0].abs().max(box_units[1].abs()) * metres_per_unit).max_element() > FAR_ORIGIN_M;
        let metre = |v: f64| ((v * metres_per_unit).floor() as i64).saturating_mul(UM_PER_M as i64);
        let origin_um = if far { [metre(box_units[0].x), metre(box_units[0].y)] } else { [0, 0] };
        Self { metres_per_unit, origin_um }
    }

    /// Drawing units to the drawing frame, snapped to whole micrometres.
    pub fn um_from_file(&self, p: DVec2) -> PointUm {
        let snap = |v: f64| (v * self.metres_per_unit * UM_PER_M).round() as i64;
        [snap(p.x), snap(p.y)]
    }

    /// Drawing frame to drawing units: reads back as the same micrometres.
    pub fn file_from_um(&self, p: PointUm) -> DVec2 {
        DVec2::new(
            p[0] as f64 / UM_PER_M / self.metres_per_unit,
            p[1] as f64 / UM_PER_M / self.metres_per_unit,
        )
    }

    /// A new point, drawing units, as it is written: to a nanometre or the next finer decimal, without the noise of sums.
    pub fn written(&self, p: DVec2) -> DVec2 {
        let decimals =
            ((self.metres_per_unit / WRITTEN_M).log10() - LOG_NOISE).ceil().clamp(0.0, DECIMALS_MAX);
        let by = 10_f64.powi(decimals as i32);
        let shortest = |v: f64| {
            let steps = v * by;
            if steps.abs() < WHOLE_MAX { steps.round() / by } else { v }
        };
        DVec2::new(shortest(p.x), shortest(p.y))
    }

    /// Drawing frame to plan frame, metres.
    pub fn plan_from_um(&self, p: PointUm) -> DVec2 {
        let m = |k: usize| p[k].saturating_sub(self.origin_um[k]) as f64 / UM_PER_M;
        DVec2::new(m(0), m(1))
    }

    /// Plan frame to drawing frame, snapped to whole micrometres.
    pub fn um_from_plan(&self, p: DVec2) -> PointUm {
        let um = |v: f64, k: usize| ((v * UM_PER_M).round() as i64).saturating_add(self.origin_um[k]);
        [um(p.x, 0), um(p.y, 1)]
    }

    /// Drawing units to plan frame, metres, snapped.
    pub fn plan_from_file(&self, p: DVec2) -> DVec2 {
        self.plan_from_um(self.um_from_file(p))
    }

    /// Plan frame to drawing units.
    pub fn file_from_plan(&self, p: DVec2) -> DVec2 {
        self.file_from_um(self.um_from_plan(p))
    }

    /// Plan frame to the drawing frame in metres, as result.json states points.
    pub fn drawing_m_from_plan(&self, p: DVec2) -> [f64; 2] {
        let um = self.um_from_plan(p);
        [um[0] as f64 / UM_PER_M, um[1] as f64 / UM_PER_M]
    }
}

/// Scales at which plans are printed: how many metres one metre on paper stands for, in metric and in imperial countries.
const SCALES_METRIC: [f64; 9] = [10.0, 20.0, 25.0, 50.0, 100.0, 200.0, 250.0, 500.0, 1000.0];

const SCALES_IMPERIAL: [f64; 9] = [12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 96.0, 128.0, 192.0];

/// The scales at which plans in this unit are printed.
pub(super) fn scales(unit: Unit) -> [f64; 9] {
    if matches!(unit.name, "in" | "ft") { SCALES_IMPERIAL } else { SCALES_METRIC }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_read_as_two_digits() {
        for (exact, read) in
            [(0.05 / 40.0, "0.0013"), (0.00251, "0.0025"), (0.0999, "0.1"), (0.2, "0.2"), (123.0, "120")]
        {
            assert_eq!(two_digits(exact).to_string(), read);
        }
    }

    /// One row a case: metres of a unit, what comes of sums, what is written.
    #[test]
    fn new_points_are_written_short() {
        for (unit, sum, written) in [
            (0.001, 3_299.999_999_999_5, "3300"),
            (0.001, 0.1 + 0.2, "0.3"),
            (0.001, 12.345_678_9, "12.345679"),
            (1.0, 5_400_000.123_456_789, "5400000.123456789"),
            (1.0, 1.200_000_000_4, "1.2"),
            (0.0254, 39.370_078_740_157_48, "39.37007874"),
            (1.0, 1e17, "100000000000000000"),
        ] {
            let frame = Frame::new(unit, [DVec2::ZERO; 2]);
            assert_eq!(frame.written(DVec2::new(sum, -sum)).x.to_string(), written, "{unit} {sum}");
            assert_eq!(frame.written(DVec2::new(sum, -sum)).y.to_string(), format!("-{written}"));
        }
        assert!(Frame::new(1.0, [DVec2::ZERO; 2]).written(DVec2::splat(f64::NAN)).is_nan());
    }

    /// What lies beyond whole micrometres ends at their last one.
    #[test]
    fn no_coordinate_overflows() {
        for far in [1e300, -1e300, f64::INFINITY, f64::NAN, 1e13] {
            let frame = Frame::new(1.0, [DVec2::splat(-far), DVec2::splat(far)]);
            for p in [far, -far].map(DVec2::splat) {
                assert!(frame.plan_from_file(p).is_finite());
                assert!(frame.file_from_plan(frame.plan_from_file(p)).is_finite());
            }
        }
    }
}
