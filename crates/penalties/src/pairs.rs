//! Which walls are near which: boxes in a grid for walls that stand, a sweep for those that move.

use glam::DVec2;

/// Cells along the longer side of the grid at most: beyond that a cell holds few walls anyway.
pub const GRID_CELLS_MAX: usize = 48;

/// An axis-aligned box, metres, corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner.
    pub max: DVec2,
}

impl Aabb {
    /// The box of a segment, widened by `margin_m` on all sides.
    pub fn of_segment([a, b]: [DVec2; 2], margin_m: f64) -> Self {
        Self { min: a.min(b) - margin_m, max: a.max(b) + margin_m }
    }

    /// The box of some points, widened by `margin_m` on all sides; empty for no points.
    pub fn of_points(points: &[DVec2], margin_m: f64) -> Self {
        let (min, max) = points
            .iter()
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(min, max), &p| (min.min(p), max.max(p)));
        Self { min: min - margin_m, max: max + margin_m }
    }

    /// Whether two closed boxes share a point.
    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

/// Boxes that stand still, filed by the grid cells they cover.
#[derive(Clone, Debug)]
pub struct BoxGrid {
    boxes: Vec<Aabb>,
    origin: DVec2,
    cell_m: f64,
    /// Columns and rows.
    size: [usize; 2],
    /// `filed[starts[c]..starts[c + 1]]` are the boxes over cell c = row · columns + column.
    starts: Vec<u32>,
    filed: Vec<u32>,
}

impl BoxGrid {
    /// Files the boxes; they keep their order.
    pub fn new(boxes: Vec<Aabb>) -> Self {
        let Some(hull) =
            boxes.iter().copied().reduce(|p, q| Aabb { min: p.min.min(q.min), max: p.max.max(q.max) })
        else {
            return Self {
                boxes,
                origin: DVec2::ZERO,
                cell_m: 1.0,
                size: [0, 0],
                starts: vec![0],
                filed: vec![],
            };
        };
        let extent = hull.max - hull.min;
        let along = (boxes.len() as f64).sqrt().ceil().clamp(1.0, GRID_CELLS_MAX as f64);
        let cell_m = (extent.max_element() / along).max(f64::MIN_POSITIVE);
        let count = |m: f64| ((m / cell_m) as usize).min(GRID_CELLS_MAX) + 1;
        let mut grid = Self {
            boxes,
            origin: hull.min,
            cell_m,
            size: [count(extent.x), count(extent.y)],
            starts: vec![],
            filed: vec![],
        };
        grid.file();
        grid
    }

    fn file(&mut self) {
        let mut entries: Vec<(u32, u32)> = Vec::new();
        for (i, b) in self.boxes.iter().enumerate() {
            let [c0, r0] = self.cell_of(b.min);
            let [c1, r1] = self.cell_of(b.max);
            for row in r0..=r1 {
                entries.extend((c0..=c1).map(|col| ((row * self.size[0] + col) as u32, i as u32)));
            }
        }
        entries.sort_unstable();
        let cells = self.size[0] * self.size[1];
        self.starts = (0..=cells).map(|c| entries.partition_point(|e| (e.0 as usize) < c) as u32).collect();
        self.filed = entries.into_iter().map(|e| e.1).collect();
    }

    /// The cell a point lies in, or the nearest one.
    fn cell_of(&self, p: DVec2) -> [usize; 2] {
        let at = (p - self.origin) / self.cell_m;
        let clamp = |x: f64, n: usize| (x.max(0.0) as usize).min(n - 1);
        [clamp(at.x, self.size[0]), clamp(at.y, self.size[1])]
    }

    /// Calls `visit` once for every filed box that meets `query`, in a fixed order.
    pub fn visit(&self, query: &Aabb, mut visit: impl FnMut(usize)) {
        if self.boxes.is_empty() {
            return;
        }
        let [c0, r0] = self.cell_of(query.min);
        let [c1, r1] = self.cell_of(query.max);
        for row in r0..=r1 {
            for col in c0..=c1 {
                let cell = row * self.size[0] + col;
                for &i in &self.filed[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                    let b = &self.boxes[i as usize];
                    // A pair lies in several cells; it counts in the one of its common lower left corner.
                    if b.meets(query) && self.cell_of(b.min.max(query.min)) == [col, row] {
                        visit(i as usize);
                    }
                }
            }
        }
    }
}

/// Calls `visit(i, j)` once for every pair of boxes that meet, in a fixed order.
pub fn sweep(boxes: &[Aabb], mut visit: impl FnMut(usize, usize)) {
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    order.sort_unstable_by(|&i, &j| {
        boxes[i as usize].min.x.total_cmp(&boxes[j as usize].min.x).then(i.cmp(&j))
    });
    for (k, &i) in order.iter().enumerate() {
        let p = &boxes[i as usize];
        for &j in &order[k + 1..] {
            let q = &boxes[j as usize];
            if q.min.x > p.max.x {
                break;
            }
            if p.meets(q) {
                visit(i as usize, j as usize);
            }
        }
    }
}
