//! The unit cube the search works in: every movable parameter scaled by its bounds to `[0, 1]`.

use enfilade_report::{Error, Place};

/// The map between a study's parameters and the unit cube of those that can move.
///
/// A parameter whose bounds coincide has no room; it keeps its only value and is no coordinate.
#[derive(Clone, Debug)]
pub(super) struct Space {
    bounds: Vec<[f64; 2]>,
    movable: Vec<usize>,
}

impl Space {
    /// Checks the bounds: finite, lower ≤ upper, their width finite too.
    pub(super) fn new(bounds: &[[f64; 2]]) -> Result<Self, Error> {
        for (i, [lower, upper]) in bounds.iter().enumerate() {
            if !(lower.is_finite() && upper.is_finite() && lower <= upper && (upper - lower).is_finite()) {
                let text =
                    format!("bounds of parameter {i}, found {lower} .. {upper}, expected lower ≤ upper");
                return Err(Error::usage("search-bounds", Place::default(), text));
            }
        }
        let movable = (0..bounds.len()).filter(|&i| bounds[i][0] < bounds[i][1]).collect();
        Ok(Self { bounds: bounds.to_vec(), movable })
    }

    /// Number of coordinates of the unit cube.
    pub(super) fn dims(&self) -> usize {
        self.movable.len()
    }

    /// Parameters in the study's own units, inside the bounds whatever `unit` holds.
    pub(super) fn parameters(&self, unit: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = self.bounds.iter().map(|b| b[0]).collect();
        for (&i, &u) in self.movable.iter().zip(unit) {
            let [lower, upper] = self.bounds[i];
            out[i] = (lower + u * (upper - lower)).clamp(lower, upper);
        }
        out
    }

    /// The point of the unit cube that stands for `parameters`.
    pub(super) fn unit(&self, parameters: &[f64]) -> Vec<f64> {
        let scaled = |&i: &usize| {
            let [lower, upper] = self.bounds[i];
            ((parameters[i] - lower) / (upper - lower)).clamp(0.0, 1.0)
        };
        self.movable.iter().map(scaled).collect()
    }
}

/// Distance `dn` of two parameter vectors: Euclidean after scaling each parameter by its bounds to
/// `[0, 1]` (spec section 6). Between 0 and √n; parameters without room add nothing.
pub fn normalised_distance(bounds: &[[f64; 2]], a: &[f64], b: &[f64]) -> f64 {
    let square = |((bound, x), y): ((&[f64; 2], &f64), &f64)| {
        let width = bound[1] - bound[0];
        if width > 0.0 { ((x - y) / width).powi(2) } else { 0.0 }
    };
    bounds.iter().zip(a).zip(b).map(square).sum::<f64>().sqrt()
}

/// Folds a coordinate back into `[0, 1]` at the faces of the cube.
pub(super) fn reflect(u: f64) -> f64 {
    let folded = u.rem_euclid(2.0);
    let inside = if folded > 1.0 { 2.0 - folded } else { folded };
    if inside.is_finite() { inside.clamp(0.0, 1.0) } else { 0.5 }
}

/// Squared Euclidean distance.
pub(super) fn square_distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}
