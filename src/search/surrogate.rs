//! Cubic radial basis functions with a linear tail on the points near a centre, grown point by point.
//!
//! The interpolant is `s(x) = Σ α_i |x − x_i|³ + q(x)`, q linear (Regis & Shoemaker 2013). Its
//! saddle-point system is indefinite; here the cubic is made positive definite by taking out linear
//! functions at a fixed simplex of anchors, `K(x, y) = ⟨λ_x, λ_y⟩` with
//! `λ_x = δ_x − Σ p_j(x) δ_{a_j}`, so that one Cholesky factor serves and a new point is one new row
//! of it: O(k²) instead of O(k³). The interpolant does not depend on the anchors.

use super::archive::Archive;
use super::space::square_distance;

/// Distance of the anchors from the centre, in widths of the unit cube.
const ANCHOR_STEP: f64 = 0.5;
/// Added to the diagonal: duplicates and cliffs between close points stay bounded.
const NUGGET: f64 = 1e-6;
/// Ridge of the linear tail while there are fewer points than it has coefficients.
const TAIL_RIDGE: f64 = 1e-8;

/// A factorised set of archive points around a centre, and the interpolants fitted to it.
#[derive(Clone, Debug, Default)]
pub(super) struct Surrogate {
    dims: usize,
    capacity: usize,
    centre: Vec<f64>,
    /// Squared distance from the centre beyond which points do not matter.
    reach: f64,
    members: Vec<usize>,
    synced: usize,
    /// Coordinates of the members, one column of `capacity` values a dimension.
    columns: Vec<f64>,
    /// Rows of the lower Cholesky factor, row `i` at `i * capacity`.
    factor: Vec<f64>,
    /// `|x_i − a_j|³`, anchors contiguous.
    to_anchors: Vec<f64>,
    between_anchors: Vec<f64>,
    /// `L⁻¹ P`, `dims + 1` values a member; `P` holds the anchor coordinates `p_j(x_i)`.
    tail: Vec<f64>,
    tail_basis: Vec<f64>,
    /// Per fitted value: α (member order) and the linear function (constant, then slopes).
    weights: Vec<Vec<f64>>,
    linear: Vec<Vec<f64>>,
}

impl Surrogate {
    /// Brings the factor up to date with the archive around `centre`: new points near it are added;
    /// it is rebuilt from the `size` nearest when it is full or the centre has gone elsewhere.
    pub(super) fn sync(&mut self, archive: &Archive, centre: &[f64], size: usize) {
        let moved = if self.centre.len() == centre.len() {
            square_distance(&self.centre, centre)
        } else {
            f64::INFINITY
        };
        if moved > 0.25 * self.reach || self.dims == 0 || !self.grow(archive) {
            self.rebuild(archive, centre, size);
        }
    }

    fn grow(&mut self, archive: &Archive) -> bool {
        while self.synced < archive.len() {
            let i = self.synced;
            if square_distance(archive.unit(i), &self.centre) <= self.reach {
                if self.members.len() == self.capacity {
                    return false;
                }
                self.append(archive, i);
            }
            self.synced += 1;
        }
        true
    }

    fn rebuild(&mut self, archive: &Archive, centre: &[f64], size: usize) {
        let mut near: Vec<(f64, usize)> =
            (0..archive.len()).map(|i| (square_distance(archive.unit(i), centre), i)).collect();
        let by_distance = |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        self.reach = f64::INFINITY;
        if near.len() > size {
            near.select_nth_unstable_by(size - 1, by_distance);
            near.truncate(size);
            self.reach = near[size - 1].0;
        }
        near.sort_by_key(|&(_, i)| i);
        self.reset(archive.dims(), centre, size + size / 3);
        for (_, i) in near {
            self.append(archive, i);
        }
        self.synced = archive.len();
    }

    fn reset(&mut self, dims: usize, centre: &[f64], capacity: usize) {
        self.dims = dims;
        self.centre = centre.to_vec();
        self.members.clear();
        self.to_anchors.clear();
        self.tail.clear();
        self.tail_basis.clear();
        if self.capacity != capacity || self.columns.len() != dims * capacity {
            self.capacity = capacity;
            self.columns = vec![0.0; dims * capacity];
            self.factor = vec![0.0; capacity * capacity];
        }
        let anchors: Vec<Vec<f64>> = (0..=dims).map(|j| self.anchor(j)).collect();
        self.between_anchors =
            anchors.iter().flat_map(|a| anchors.iter().map(|b| cube_distance(a, b))).collect();
    }

    fn anchor(&self, j: usize) -> Vec<f64> {
        let mut at = self.centre.clone();
        if j > 0 {
            at[j - 1] += ANCHOR_STEP;
        }
        at
    }

    /// Adds one row to the factor.
    fn append(&mut self, archive: &Archive, i: usize) {
        let x = archive.unit(i);
        let n = self.members.len();
        let width = self.dims + 1;
        for (d, &u) in x.iter().enumerate() {
            self.columns[d * self.capacity + n] = u;
        }
        let basis = self.anchor_coordinates(x);
        let anchored: Vec<f64> = (0..width).map(|j| cube_distance(x, &self.anchor(j))).collect();
        let mut row = self.cubes(x, n + 1);
        for (m, value) in row.iter_mut().enumerate() {
            let (other, other_basis) = if m == n {
                (&anchored[..], &basis[..])
            } else {
                (&self.to_anchors[m * width..][..width], &self.tail_basis[m * width..][..width])
            };
            *value -= dot(&basis, other) + dot(other_basis, &anchored);
            for (a, &p) in basis.iter().enumerate() {
                *value += p * dot(other_basis, &self.between_anchors[a * width..][..width]);
            }
        }
        self.to_anchors.extend_from_slice(&anchored);
        self.tail_basis.extend_from_slice(&basis);
        for m in 0..n {
            let (done, rest) = row.split_at_mut(m);
            let factor = &self.factor[m * self.capacity..][..=m];
            rest[0] = (rest[0] - dot(done, &factor[..m])) / factor[m];
        }
        let left = row[n] - dot(&row[..n], &row[..n]);
        row[n] = (left.max(0.0) + NUGGET).sqrt();
        self.factor[n * self.capacity..][..=n].copy_from_slice(&row);
        let mut tail = basis;
        for (m, &l) in row[..n].iter().enumerate() {
            for (t, &above) in tail.iter_mut().zip(&self.tail[m * width..][..width]) {
                *t -= l * above;
            }
        }
        self.tail.extend(tail.iter().map(|t| t / row[n]));
        self.members.push(i);
    }

    fn anchor_coordinates(&self, x: &[f64]) -> Vec<f64> {
        let mut basis = vec![1.0];
        basis.extend(x.iter().zip(&self.centre).map(|(u, c)| (u - c) / ANCHOR_STEP));
        basis[0] -= basis[1..].iter().sum::<f64>();
        basis
    }

    /// `|x − x_m|³` of the first `count` members.
    fn cubes(&self, x: &[f64], count: usize) -> Vec<f64> {
        let mut out = vec![0.0; count];
        self.squares(x, &mut out);
        out.iter_mut().for_each(|v| *v *= v.sqrt());
        out
    }

    fn squares(&self, x: &[f64], out: &mut [f64]) {
        for (d, &u) in x.iter().enumerate() {
            let column = &self.columns[d * self.capacity..][..out.len()];
            for (o, &c) in out.iter_mut().zip(column) {
                *o += (u - c) * (u - c);
            }
        }
    }

    /// Fits one interpolant for each of `count` values; `value(i, j)` is the j-th of archive point `i`.
    pub(super) fn fit(&mut self, count: usize, value: impl Fn(usize, usize) -> f64) {
        let (n, width) = (self.members.len(), self.dims + 1);
        let mut gram = vec![0.0; width * width];
        for row in self.tail.chunks_exact(width) {
            for (a, &p) in row.iter().enumerate() {
                for (g, &q) in gram[a * width..][..=a].iter_mut().zip(row) {
                    *g += p * q;
                }
            }
        }
        let ridge = TAIL_RIDGE * (0..width).map(|a| gram[a * width + a]).fold(0.0, f64::max);
        (0..width).for_each(|a| gram[a * width + a] += ridge);
        cholesky(&mut gram, width);
        self.weights.resize(count, vec![]);
        self.linear.resize(count, vec![]);
        for j in 0..count {
            let values: Vec<f64> = self.members.iter().map(|&i| value(i, j)).collect();
            let mean = values.iter().sum::<f64>() / n.max(1) as f64;
            let mut w: Vec<f64> = values.iter().map(|v| v - mean).collect();
            for m in 0..n {
                let (done, rest) = w.split_at_mut(m);
                let row = &self.factor[m * self.capacity..][..=m];
                rest[0] = (rest[0] - dot(done, &row[..m])) / row[m];
            }
            let mut beta = vec![0.0; width];
            for (row, &v) in self.tail.chunks_exact(width).zip(&w) {
                beta.iter_mut().zip(row).for_each(|(b, &t)| *b += t * v);
            }
            solve(&gram, width, &mut beta);
            for (row, v) in self.tail.chunks_exact(width).zip(&mut w) {
                *v -= dot(row, &beta);
            }
            for m in (0..n).rev() {
                let (before, rest) = w.split_at_mut(m);
                let row = &self.factor[m * self.capacity..][..=m];
                rest[0] /= row[m];
                let at = rest[0];
                before.iter_mut().zip(row).for_each(|(b, &l)| *b -= at * l);
            }
            self.linear[j] = self.linear_function(&beta, &w, mean);
            self.weights[j] = w;
        }
    }

    /// The linear part as constant and slopes around the centre: its values at the anchors are β less
    /// what the cubes already give there.
    fn linear_function(&self, beta: &[f64], weights: &[f64], mean: f64) -> Vec<f64> {
        let width = self.dims + 1;
        let mut at_anchor = beta.to_vec();
        for (row, &w) in self.to_anchors.chunks_exact(width).zip(weights) {
            at_anchor.iter_mut().zip(row).for_each(|(a, &c)| *a -= w * c);
        }
        let origin = at_anchor[0];
        let mut out = vec![origin + mean];
        out.extend(at_anchor[1..].iter().map(|a| (a - origin) / ANCHOR_STEP));
        out
    }

    /// Predicted values at `x` into `out`; returns the squared distance to the nearest member.
    pub(super) fn predict(&self, x: &[f64], scratch: &mut Vec<f64>, out: &mut [f64]) -> f64 {
        let n = self.members.len();
        scratch.clear();
        scratch.resize(n, 0.0);
        self.squares(x, scratch);
        let nearest = scratch.iter().copied().fold(f64::INFINITY, f64::min);
        scratch.iter_mut().for_each(|v| *v *= v.sqrt());
        for ((o, weights), linear) in out.iter_mut().zip(&self.weights).zip(&self.linear) {
            let tail =
                linear[1..].iter().zip(x).zip(&self.centre).map(|((s, u), c)| s * (u - c)).sum::<f64>();
            *o = dot(weights, scratch) + tail + linear[0];
        }
        nearest
    }
}

fn cube_distance(a: &[f64], b: &[f64]) -> f64 {
    let square = square_distance(a, b);
    square * square.sqrt()
}

/// Dot product in eight lanes: the same bits whatever the machine, and quick.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let mut lanes = [0.0; LANES];
    let (head_a, tail_a) = a.as_chunks::<LANES>();
    let (head_b, tail_b) = b.as_chunks::<LANES>();
    for (x, y) in head_a.iter().zip(head_b) {
        for l in 0..LANES {
            lanes[l] += x[l] * y[l];
        }
    }
    let tail: f64 = tail_a.iter().zip(tail_b).map(|(x, y)| x * y).sum();
    let halves = [lanes[0] + lanes[4], lanes[1] + lanes[5], lanes[2] + lanes[6], lanes[3] + lanes[7]];
    (halves[0] + halves[2]) + (halves[1] + halves[3]) + tail
}

/// In-place lower Cholesky factor of a small matrix, row-major.
fn cholesky(a: &mut [f64], n: usize) {
    for i in 0..n {
        for j in 0..=i {
            let sum: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let left = a[i * n + j] - sum;
            a[i * n + j] = if i == j { left.max(f64::MIN_POSITIVE).sqrt() } else { left / a[j * n + j] };
        }
    }
}

fn solve(factor: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let sum: f64 = (0..i).map(|k| factor[i * n + k] * b[k]).sum();
        b[i] = (b[i] - sum) / factor[i * n + i];
    }
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|k| factor[k * n + i] * b[k]).sum();
        b[i] = (b[i] - sum) / factor[i * n + i];
    }
}
