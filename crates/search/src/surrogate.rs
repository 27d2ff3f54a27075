//! Cubic radial basis functions with a linear tail on the points near a centre, grown point by point.
//!
//! The interpolant is `s(x) = Σ α_i φ(x − x_i) + q(x)`, q linear (Regis & Shoemaker 2013), with
//! `φ(v) = |v|³ + Σ_d |v_d|³`: what each parameter does by itself, whatever the others do, is learnt from all
//! points at once (an additive kernel, Duvenaud et al. 2011), the cube of the whole distance adds how they act
//! together. Its saddle-point system is indefinite; here the cubic is made positive definite by taking out linear
//! functions at a fixed simplex of anchors, `K(x, y) = ⟨λ_x, λ_y⟩` with
//! `λ_x = δ_x − Σ p_j(x) δ_{a_j}`, so that one Cholesky factor serves and a new point is one new row
//! of it: O(k²) instead of O(k³). The interpolant does not depend on the anchors.

use super::archive::Archive;
use super::lanes::{LANES, add_multiple, dot, radials};
use super::space::square_distance;

/// Distance of the anchors from the centre, in widths of the unit cube.
const ANCHOR_STEP: f64 = 0.5;
/// Least pivot of the factor, for a point evaluated twice without smoothing.
const LEAST_PIVOT: f64 = 1e-12;
/// Squared distance that stands in where a slice is padded; its weight is 0.
const FAR: f64 = 1e3;
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
    /// Added to the diagonal: 0 interpolates, more smooths duplicates, stairs and cliffs.
    nugget: f64,
    members: Vec<usize>,
    synced: usize,
    /// Archive points known, and how many values they had, when it was fitted last.
    fitted: Option<(usize, usize)>,
    /// Coordinates of the members, one column of `capacity` values a dimension.
    columns: Vec<f64>,
    /// Rows of the lower Cholesky factor, row `i` at `i * capacity`.
    factor: Vec<f64>,
    /// `φ(x_i − a_j)`, anchors contiguous.
    to_anchors: Vec<f64>,
    between_anchors: Vec<f64>,
    /// `L⁻¹ P`, `dims + 1` values a member; `P` holds the anchor coordinates `p_j(x_i)`.
    tail: Vec<f64>,
    tail_basis: Vec<f64>,
    /// Per fitted value: α (member order) and the linear function (constant, then slopes).
    weights: Vec<Vec<f64>>,
    linear: Vec<Vec<f64>>,
    /// Where predictions are made from: the point, its squared distances, the cubes of its differences summed
    /// over the coordinates, and its differences.
    aim: Vec<f64>,
    aim_squares: Vec<f64>,
    aim_cubes: Vec<f64>,
    aim_columns: Vec<f64>,
}

impl Surrogate {
    /// Whether points around `at` are inside what this surrogate knows.
    pub(super) fn serves(&self, archive: &Archive, at: &[f64]) -> bool {
        self.dims == archive.dims() && self.distance(at) <= 0.25 * self.reach
    }

    /// Squared distance of `at` from the centre; infinite before the first use.
    pub(super) fn distance(&self, at: &[f64]) -> f64 {
        if self.centre.len() == at.len() { square_distance(&self.centre, at) } else { f64::INFINITY }
    }

    /// Brings the factor up to date with the archive around `centre`: new points near it are added;
    /// it is rebuilt from the `size` nearest when it is full or the centre has gone elsewhere.
    pub(super) fn sync(&mut self, archive: &Archive, centre: &[f64], size: usize, nugget: f64) {
        self.nugget = nugget;
        if !self.serves(archive, centre) || !self.grow(archive) {
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
        self.reset(archive.dims(), centre, (size + size / 3).next_multiple_of(LANES));
        for (_, i) in near {
            self.append(archive, i);
        }
        self.synced = archive.len();
    }

    fn reset(&mut self, dims: usize, centre: &[f64], capacity: usize) {
        self.dims = dims;
        self.centre = centre.to_vec();
        self.members.clear();
        self.fitted = None;
        self.to_anchors.clear();
        self.tail.clear();
        self.tail_basis.clear();
        if self.capacity != capacity || self.columns.len() != dims * capacity {
            self.capacity = capacity;
            self.columns = vec![0.0; dims * capacity];
            self.factor = vec![0.0; capacity * capacity];
        }
        let anchors: Vec<Vec<f64>> = (0..=dims).map(|j| self.anchor(j)).collect();
        self.between_anchors = anchors.iter().flat_map(|a| anchors.iter().map(|b| radial(a, b))).collect();
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
        let anchored: Vec<f64> = (0..width).map(|j| radial(x, &self.anchor(j))).collect();
        // K(x, y) = φ(x − y) − p(x)·c(y) − p(y)·(c(x) − B p(x)), c: φ to the anchors, B: between them.
        let mut turned = anchored.clone();
        for (t, between) in turned.iter_mut().zip(self.between_anchors.chunks_exact(width)) {
            *t -= dot(&basis, between);
        }
        let mut row = self.radials(x, n);
        let others = self.to_anchors.chunks_exact(width).zip(self.tail_basis.chunks_exact(width));
        for (value, (cubes, other)) in row.iter_mut().zip(others) {
            *value -= dot(&basis, cubes) + dot(other, &turned);
        }
        row.push(-dot(&basis, &anchored) - dot(&basis, &turned));
        self.to_anchors.extend_from_slice(&anchored);
        self.tail_basis.extend_from_slice(&basis);
        for m in 0..n {
            let (done, rest) = row.split_at_mut(m);
            let factor = &self.factor[m * self.capacity..][..=m];
            rest[0] = (rest[0] - dot(done, &factor[..m])) / factor[m];
        }
        let left = row[n] - dot(&row[..n], &row[..n]);
        row[n] = (left.max(LEAST_PIVOT) + self.nugget).sqrt();
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

    /// `φ(x − x_m)` of the first `count` members.
    fn radials(&self, x: &[f64], count: usize) -> Vec<f64> {
        let mut out = vec![0.0; count];
        let mut squares = vec![0.0; count];
        for (d, &u) in x.iter().enumerate() {
            let column = &self.columns[d * self.capacity..][..count];
            for ((o, square), &c) in out.iter_mut().zip(&mut squares).zip(column) {
                let away = (u - c).abs();
                *square += away * away;
                *o += away * away * away;
            }
        }
        out.iter_mut().zip(squares).for_each(|(o, square)| *o += square * square.sqrt());
        out
    }

    /// As [`Surrogate::fit`], unless nothing was learnt since: values change only as points are added.
    pub(super) fn fit_once(&mut self, count: usize, value: impl Fn(usize, usize) -> f64) {
        if self.fitted != Some((self.synced, count)) {
            self.fit(count, value);
            self.fitted = Some((self.synced, count));
        }
    }

    /// Fits one interpolant for each of `count` values; `value(i, j)` is the j-th of archive point `i`.
    fn fit(&mut self, count: usize, value: impl Fn(usize, usize) -> f64) {
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
                add_multiple(before, -at, row);
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

    /// Makes ready to predict near `at`: see [`Surrogate::predict`].
    pub(super) fn aim(&mut self, at: &[f64]) {
        let n = self.members.len();
        let padded = n.next_multiple_of(LANES);
        self.aim = at.to_vec();
        self.aim_squares.clear();
        self.aim_squares.resize(n, 0.0);
        self.aim_cubes.clear();
        self.aim_cubes.resize(n, 0.0);
        self.aim_columns.clear();
        self.aim_columns.resize(self.dims * self.capacity, 0.0);
        for (d, &u) in at.iter().enumerate() {
            let columns = &self.columns[d * self.capacity..][..n];
            let away = &mut self.aim_columns[d * self.capacity..][..n];
            let sums = self.aim_squares.iter_mut().zip(&mut self.aim_cubes);
            for ((a, &c), (square, cube)) in away.iter_mut().zip(columns).zip(sums) {
                *a = u - c;
                *square += *a * *a;
                *cube += (*a * *a * *a).abs();
            }
        }
        self.aim_squares.resize(padded, FAR);
        self.aim_cubes.resize(padded, 0.0);
        self.weights.iter_mut().for_each(|w| w.resize(padded, 0.0));
    }

    /// Predicted values at `x` into `out`; returns the squared distance to the nearest member. Only
    /// coordinates in which `x` differs from where the surrogate is aimed cost anything.
    pub(super) fn predict(&self, x: &[f64], scratch: &mut Vec<f64>, out: &mut [f64]) -> f64 {
        scratch.resize(self.aim_squares.len(), 0.0);
        let mut shift = 0.0;
        let mut moved: Vec<(f64, &[f64])> = Vec::with_capacity(self.dims);
        for (d, (&u, &a)) in x.iter().zip(&self.aim).enumerate() {
            let step = u - a;
            if step != 0.0 {
                shift += step * step;
                moved.push((step, &self.aim_columns[d * self.capacity..][..scratch.len()]));
            }
        }
        let nearest = radials([&self.aim_squares, &self.aim_cubes], &moved, shift, scratch);
        for ((o, weights), linear) in out.iter_mut().zip(&self.weights).zip(&self.linear) {
            let tail =
                linear[1..].iter().zip(x).zip(&self.centre).map(|((s, u), c)| s * (u - c)).sum::<f64>();
            *o = dot(weights, scratch) + tail + linear[0];
        }
        nearest
    }
}

/// `φ(a − b)`.
fn radial(a: &[f64], b: &[f64]) -> f64 {
    let square = square_distance(a, b);
    let alone: f64 = a.iter().zip(b).map(|(x, y)| (x - y).abs().powi(3)).sum();
    square * square.sqrt() + alone
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

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::{Evaluation, Objective, Sense};

    fn archive(count: usize, dims: usize, f: impl Fn(&[f64]) -> f64) -> Archive {
        let objective = Objective {
            name: "f".into(),
            sense: Sense::Max,
            threshold: 0.7,
            is_score: true,
            is_penalty: false,
        };
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut archive = Archive::new(dims, 1);
        for _ in 0..count {
            let u: Vec<f64> = (0..dims).map(|_| rng.random::<f64>()).collect();
            let told = Evaluation { values: vec![f(&u)], violation: 0.0, ..Evaluation::default() };
            archive.push(&u, u.clone(), &told, std::slice::from_ref(&objective));
        }
        archive
    }

    fn predict(surrogate: &Surrogate, x: &[f64]) -> (f64, f64) {
        let mut out = [0.0];
        let nearest = surrogate.predict(x, &mut vec![], &mut out);
        (out[0], nearest)
    }

    #[test]
    fn a_linear_function_is_known_everywhere() {
        let plane = |u: &[f64]| 2.0 + u.iter().enumerate().map(|(i, v)| (i as f64 - 1.5) * v).sum::<f64>();
        let archive = archive(60, 4, plane);
        let mut surrogate = Surrogate::default();
        surrogate.sync(&archive, &[0.5; 4], 60, 1e-6);
        surrogate.fit_once(1, |i, j| archive.gains(i)[j]);
        surrogate.aim(&[0.5; 4]);
        let far = [0.1, 0.95, 0.3, 0.7];
        assert!((predict(&surrogate, &far).0 - plane(&far)).abs() < 1e-5);
    }

    #[test]
    fn it_passes_through_its_points_however_it_was_grown() {
        let bowl = |u: &[f64]| u.iter().map(|v| (7.0 * v).sin()).sum::<f64>();
        let all = archive(90, 5, bowl);
        let mut grown = Surrogate::default();
        let mut part = Archive::new(5, 1);
        for i in 0..all.len() {
            let objective = [Objective {
                name: "f".into(),
                sense: Sense::Max,
                threshold: 0.7,
                is_score: true,
                is_penalty: false,
            }];
            let told = Evaluation { values: all.gains(i).to_vec(), violation: 0.0, ..Evaluation::default() };
            part.push(all.unit(i), vec![], &told, &objective);
            grown.sync(&part, &[0.2; 5], 80, 1e-6);
        }
        let mut built = Surrogate::default();
        built.sync(&all, &[0.6; 5], 90, 1e-6);
        for surrogate in [&mut grown, &mut built] {
            surrogate.fit_once(1, |i, j| all.gains(i)[j]);
            surrogate.aim(all.unit(3));
        }
        for i in [0, 3, 40, 89] {
            let (value, nearest) = predict(&grown, all.unit(i));
            assert!((value - bowl(all.unit(i))).abs() < 1e-3, "{value}");
            assert!(nearest < 1e-12);
        }
        let elsewhere = [0.3, 0.8, 0.5, 0.1, 0.6];
        assert!((predict(&grown, &elsewhere).0 - predict(&built, &elsewhere).0).abs() < 1e-4);
    }

    #[test]
    fn what_each_parameter_does_alone_is_learnt_from_few_points() {
        let waves = |u: &[f64]| u.iter().map(|v| (6.0 * v).sin()).sum::<f64>();
        let known = archive(80, 8, waves);
        let asked = archive(200, 8, waves);
        let mut surrogate = Surrogate::default();
        surrogate.sync(&known, &[0.5; 8], 80, 1e-6);
        surrogate.fit_once(1, |i, j| known.gains(i)[j]);
        surrogate.aim(&[0.5; 8]);
        let place = |i: usize| -> Vec<f64> { asked.unit(i).iter().map(|u| 0.1 + 0.8 * (1.0 - u)).collect() };
        let square = |i: usize| (predict(&surrogate, &place(i)).0 - waves(&place(i))).powi(2);
        let error = ((0..asked.len()).map(square).sum::<f64>() / asked.len() as f64).sqrt();
        assert!(error < 1.0, "{error}");
    }
}
