//! Test problems for the search: the maze, and synthetic ones, so that nothing is tuned to one plan.

/// A score over a box, as the optimiser sees a plan.
pub trait Problem: Sync {
    fn name(&self) -> &'static str;
    fn bounds(&self) -> Vec<[f64; 2]>;
    fn start(&self) -> Vec<f64>;
    fn worth(&self, p: &[f64]) -> Worth;
    /// What every vertex sees at a point, NaN where it is covered; empty for a problem that is not a plan.
    fn map(&self, _p: &[f64]) -> Vec<f64> {
        vec![]
    }
}

/// What a point is worth.
pub struct Worth {
    /// The composite score: more is better.
    pub score: f64,
    /// The hard violation; 0: feasible.
    pub violation: f64,
    /// What the score is made of, for methods of several objectives: degree, depth, entropy, penalties.
    /// Empty for a problem that is not a plan.
    pub parts: Vec<f64>,
}

impl Worth {
    /// Of a problem that is not a plan.
    pub fn plain(score: f64, violation: f64) -> Self {
        Self { score, violation, parts: vec![] }
    }
}

/// Rooms in a row, each with a good and a better position, in steps; a wall of cliffs between them;
/// neighbours must not come close: multi-modal, stepped, with cliffs.
pub struct Steps {
    pub dims: usize,
}

impl Problem for Steps {
    fn name(&self) -> &'static str {
        if self.dims == 9 { "steps9" } else { "steps17" }
    }
    fn bounds(&self) -> Vec<[f64; 2]> {
        (0..self.dims).map(|d| if d % 3 == 2 { [-15.0, 15.0] } else { [-1.5, 2.5] }).collect()
    }
    fn start(&self) -> Vec<f64> {
        vec![0.0; self.dims]
    }
    fn worth(&self, p: &[f64]) -> Worth {
        let u: Vec<f64> = p.iter().zip(self.bounds()).map(|(x, b)| (x - b[0]) / (b[1] - b[0])).collect();
        let n = self.dims;
        let mut gain = 0.0;
        let mut cliff: f64 = 0.0;
        for d in 0..n {
            let next = u[(d + 1) % n];
            let wave = (7.0 * u[d] + 3.0 * next + d as f64).sin() + 0.5 * (13.0 * u[d] - 5.0 * next).cos();
            gain += (wave * 8.0).round() / 8.0;
            let gap = (u[d] + next - 1.1).abs();
            cliff += (0.06 - gap).max(0.0) * 12.0;
        }
        let locked = if u[0] > 0.9 && u[n - 1] > 0.9 { 1e-4 } else { 0.0 };
        Worth::plain(2.5 * gain / n as f64 - cliff * cliff, locked)
    }
}

/// Smooth and multi-modal: a rotated sum of Gaussian hills of several heights in a box.
pub struct Hills {
    pub dims: usize,
}

impl Problem for Hills {
    fn name(&self) -> &'static str {
        if self.dims == 9 { "hills9" } else { "hills17" }
    }
    fn bounds(&self) -> Vec<[f64; 2]> {
        vec![[-1.0, 1.0]; self.dims]
    }
    fn start(&self) -> Vec<f64> {
        vec![0.1; self.dims]
    }
    fn worth(&self, p: &[f64]) -> Worth {
        let mut best = f64::NEG_INFINITY;
        for h in 0..12 {
            let mut square = 0.0;
            for (d, x) in p.iter().enumerate() {
                let centre = ((h * 31 + d * 17) as f64 * 1.618).sin() * 0.8;
                let stretch = 0.3 + ((h * 13 + d * 7) as f64).cos().abs();
                square += ((x - centre) * stretch).powi(2);
            }
            let height = 3.0 - 0.12 * h as f64;
            best = best.max(height - 2.0 * square.sqrt());
        }
        Worth::plain(best, 0.0)
    }
}
