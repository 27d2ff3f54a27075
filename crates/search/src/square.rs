//! Square matrices of a few dozen rows, and their eigen-decomposition by Jacobi's rotations.

use std::ops::{Index, IndexMut};

/// A square matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Square {
    rows: usize,
    values: Vec<f64>,
}

/// Eigenvalues, and eigenvectors as columns in the same order.
pub struct Eigen {
    pub values: Vec<f64>,
    pub vectors: Square,
}

/// Rounds over all pairs. Convergence is quadratic: well-kept codes stop at 30 to 50 (Numerical Recipes, 11.1).
const ROUNDS_MAX: usize = 50;

impl Square {
    /// Ones on the diagonal.
    pub fn identity(rows: usize) -> Self {
        let mut new = Self { rows, values: vec![0.0; rows * rows] };
        (0..rows).for_each(|i| new[(i, i)] = 1.0);
        new
    }

    /// Eigen-decomposition of a symmetric matrix (Golub and Van Loan, algorithm 8.5.3); `None` where it holds a number
    /// that is not finite.
    pub fn eigen(&self) -> Option<Eigen> {
        if self.values.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let mut a = self.clone();
        let mut vectors = Self::identity(self.rows);
        for _ in 0..ROUNDS_MAX {
            let mut has_turned = false;
            for p in 0..self.rows {
                for q in p + 1..self.rows {
                    has_turned |= a.annihilate(p, q, &mut vectors);
                }
            }
            if !has_turned {
                break;
            }
        }
        // Ascending, so that each random number keeps its axis from one decomposition to the next.
        let mut order: Vec<usize> = (0..self.rows).collect();
        order.sort_by(|i, j| a[(*i, *i)].total_cmp(&a[(*j, *j)]));
        let mut sorted = vectors.clone();
        for (to, from) in order.iter().enumerate() {
            (0..self.rows).for_each(|row| sorted[(row, to)] = vectors[(row, *from)]);
        }
        Some(Eigen { values: order.iter().map(|i| a[(*i, *i)]).collect(), vectors: sorted })
    }

    /// Turns rows and columns `p` and `q` so that their common entry is zero, unless it is already as small as rounding.
    fn annihilate(&mut self, p: usize, q: usize, vectors: &mut Self) -> bool {
        let (app, aqq, apq) = (self[(p, p)], self[(q, q)], self[(p, q)]);
        if apq.abs() <= f64::EPSILON * (app.abs() * aqq.abs()).sqrt() || apq == 0.0 {
            return false;
        }
        let tau = (aqq - app) / (2.0 * apq);
        let t = tau.signum() / (tau.abs() + tau.hypot(1.0));
        let cos = 1.0 / t.hypot(1.0);
        let sin = t * cos;
        for k in 0..self.rows {
            let (kp, kq) = (self[(k, p)], self[(k, q)]);
            self[(k, p)] = cos * kp - sin * kq;
            self[(k, q)] = sin * kp + cos * kq;
        }
        for k in 0..self.rows {
            let (pk, qk) = (self[(p, k)], self[(q, k)]);
            self[(p, k)] = cos * pk - sin * qk;
            self[(q, k)] = sin * pk + cos * qk;
            let (vp, vq) = (vectors[(k, p)], vectors[(k, q)]);
            vectors[(k, p)] = cos * vp - sin * vq;
            vectors[(k, q)] = sin * vp + cos * vq;
        }
        self[(p, q)] = 0.0;
        self[(q, p)] = 0.0;
        true
    }
}

impl Index<(usize, usize)> for Square {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.values[row * self.rows + column]
    }
}

impl IndexMut<(usize, usize)> for Square {
    fn index_mut(&mut self, (row, column): (usize, usize)) -> &mut f64 {
        &mut self.values[row * self.rows + column]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// `V Λ Vᵀ` is the matrix, `Vᵀ V` the identity, also for values of very different size.
        #[test]
        fn values_and_vectors_give_the_matrix_again(
            n in 1usize..12,
            entries in prop::collection::vec(-1.0f64..1.0, 144),
            sizes in prop::collection::vec(-6i32..6, 12),
        ) {
            let mut a = Square::identity(n);
            for i in 0..n {
                for j in 0..=i {
                    let v = entries[i * 12 + j] * 10f64.powi(sizes[i] + sizes[j]);
                    a[(i, j)] = v;
                    a[(j, i)] = v;
                }
            }
            let e = a.eigen().unwrap();
            let largest = a.values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for i in 0..n {
                for j in 0..n {
                    let again: f64 = (0..n).map(|k| e.vectors[(i, k)] * e.values[k] * e.vectors[(j, k)]).sum();
                    prop_assert!((again - a[(i, j)]).abs() <= 1e-13 * largest * n as f64, "{again} {}", a[(i, j)]);
                    let product: f64 = (0..n).map(|k| e.vectors[(k, i)] * e.vectors[(k, j)]).sum();
                    prop_assert!((product - f64::from(u8::from(i == j))).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn what_is_no_number_has_no_decomposition() {
        let mut a = Square::identity(2);
        a[(0, 1)] = f64::NAN;
        assert!(a.eigen().is_none());
    }
}
