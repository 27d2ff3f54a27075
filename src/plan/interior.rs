//! Where the building's interior is, when no region says so.
//!
//! The interior is what cannot be reached from outside. Real plans leave the entrance open, so the
//! outline is closed for a disc that is too wide for doors: the smallest of [`CLOSING_M`] that encloses
//! a building. Computed on a raster of its own, because a lattice may be far coarser than a door.

use crate::plan::geometry::{PointUm, Segment, Side, UM_PER_M, side_of_ring};

/// Half widths of the openings that count as closed, metres, tried in order; 0 is the exact flood.
pub const CLOSING_M: [f64; 4] = [0.0, 0.6, 1.25, 2.0];

/// A closing is enough when it encloses this share of what the widest one encloses.
const ENOUGH: f64 = 0.7;

/// An enclosed part that is nowhere farther than this from a wall is a cavity inside a wall.
pub const CAVITY_HALF_WIDTH_M: f64 = 0.3;

/// A mass is nowhere farther than this from its outline: no room is so narrow that nothing says how it is entered.
pub const MASS_HALF_WIDTH_M: f64 = 0.8;

/// Half the width of a thick wall where it turns a corner: what is nowhere wider is a wall and no room.
const CORNER_HALF_WIDTH_M: f64 = 0.36;

/// Share of the lines round the rooms behind which there is a wall's thickness, from which on a plan draws its walls
/// with two faces; in others a line is a wall, and what lines enclose is a room.
const TWO_FACED: f64 = 0.6;

/// Share of a mass's outline beyond which there is a room, or the outside, at once.
const BARE: f64 = 0.9;

/// Pixels that a line is thick at most, however it runs.
const LINE_PX: usize = 3;

/// Finest pixel, metres of a person.
const PIXEL_MIN_M: f64 = 0.05;

/// Pixels along the longer side.
const PIXELS_ALONG: f64 = 900.0;

/// The interior of a plan on a raster.
#[derive(Clone, Debug)]
pub struct Interior {
    origin_um: PointUm,
    pixel_um: i64,
    cols: usize,
    rows: usize,
    is_as_drawn: bool,
    closing_m: f64,
    wall: Vec<bool>,
    inside: Vec<bool>,
    cavity: Vec<bool>,
    /// What the widest closing encloses: the building's outline.
    outline: Vec<bool>,
    outside_far: Vec<f32>,
    has_room: bool,
}

impl Interior {
    /// Finds the interior of the walls as they stand. `closings`: lines across doors and windows, where they
    /// are known. `None` without walls. All lengths that mean a person's shrink with `human_scale`.
    pub fn new(walls: &[Segment], closings: &[Segment], human_scale: f64) -> Option<Self> {
        let mut raster = Raster::new(walls, closings, human_scale)?;
        raster.draw(walls);
        let as_drawn = raster.enclosed(&[], 0.0);
        // What glass or a door closes is no mass.
        let masses = raster.masses(human_scale);
        raster.draw(closings);
        let to_wall = distance_px(&raster.wall, raster.cols, raster.rows);
        let steps = CLOSING_M.iter().map(|c| c * human_scale);
        let closed: Vec<(f64, Vec<bool>)> = steps.map(|c| (c, raster.enclosed(&to_wall, c))).collect();
        let count =
            |inside: &[bool]| inside.iter().zip(&to_wall).filter(|(i, d)| **i && **d > 0.0).count() as f64;
        let widest = closed.last().map_or(0.0, |e| count(&e.1));
        let is_enough = |inside: &[bool]| count(inside) >= ENOUGH * widest;
        let is_as_drawn = is_enough(&as_drawn);
        let outline = closed.last().map_or_else(Vec::new, |e| e.1.clone());
        let (closing_m, inside) =
            if is_as_drawn { (0.0, as_drawn) } else { closed.into_iter().find(|e| is_enough(&e.1))? };
        let mut cavity = raster.cavities(&inside, &to_wall, CAVITY_HALF_WIDTH_M * human_scale);
        cavity.iter_mut().zip(masses).for_each(|(c, is_mass)| *c |= is_mass);
        let is_room = |i: usize| inside[i] && !cavity[i] && to_wall[i] > 0.0;
        let has_room = (0..inside.len()).any(is_room);
        let outside: Vec<bool> = inside.iter().map(|i| !i).collect();
        let outside_far = distance_px(&outside, raster.cols, raster.rows);
        Some(Self {
            origin_um: raster.origin_um,
            pixel_um: raster.pixel_um,
            cols: raster.cols,
            rows: raster.rows,
            is_as_drawn,
            closing_m,
            wall: raster.wall,
            inside,
            cavity,
            outline,
            outside_far,
            has_room,
        })
    }

    /// Whether the walls as drawn enclose the building, without any gap taken as closed.
    pub fn is_as_drawn(&self) -> bool {
        self.is_as_drawn
    }

    /// The same without the ground in some rings (drawing frame, micrometres), which is told to be outdoors.
    #[must_use]
    pub fn without(mut self, rings: &[Vec<PointUm>]) -> Self {
        let before = self.inside.iter().filter(|i| **i).count();
        for ring in rings {
            let bound = |k: usize, far: bool| {
                let ordinates = ring.iter().map(|p| p[k] - self.origin_um[k]);
                let end = if far { ordinates.max() } else { ordinates.min() };
                let last = if k == 0 { self.cols } else { self.rows } as i64 - 1;
                end.unwrap_or(0).div_euclid(self.pixel_um).clamp(0, last) as usize
            };
            let (cols, rows) = (bound(0, false)..=bound(0, true), bound(1, false)..=bound(1, true));
            for (c, r) in cols.flat_map(|c| rows.clone().map(move |r| (c, r))) {
                let middle =
                    |k: usize, i: usize| self.origin_um[k] + i as i64 * self.pixel_um + self.pixel_um / 2;
                if side_of_ring(ring, [middle(0, c), middle(1, r)]) == Side::Inside {
                    self.inside[c * self.rows + r] = false;
                    self.outline[c * self.rows + r] = false;
                }
            }
        }
        if self.inside.iter().filter(|i| **i).count() < before { self.counted_again() } else { self }
    }

    /// The same after some of its pixels were taken in or out.
    fn counted_again(mut self) -> Self {
        let outside: Vec<bool> = self.inside.iter().map(|i| !i).collect();
        self.outside_far = distance_px(&outside, self.cols, self.rows);
        self.has_room = (0..self.inside.len()).any(|i| self.inside[i] && !self.cavity[i] && !self.wall[i]);
        self.is_as_drawn = false;
        self
    }

    /// The same with the floor round some points, and without that round others, as far as walls and closed openings
    /// (drawing frame, micrometres). Besides the points inside whose floor is open to the outside, by their index: they
    /// change nothing. Gaps are closed as far as [`CLOSING_M`] needs for a point.
    #[must_use]
    pub fn corrected(
        mut self,
        inside: &[PointUm],
        outside: &[PointUm],
        human_scale: f64,
    ) -> (Self, Vec<usize>) {
        let raster = Raster {
            origin_um: self.origin_um,
            pixel_um: self.pixel_um,
            cols: self.cols,
            rows: self.rows,
            wall: self.wall.clone(),
        };
        let to_wall = distance_px(&self.wall, self.cols, self.rows);
        let closings = CLOSING_M.map(|c| raster.enclosed(&to_wall, c * human_scale));
        let floor_at = |p: PointUm, of: &[bool]| -> Option<Vec<usize>> {
            let start = self.pixel(p).filter(|i| of[*i] && !raster.wall[*i])?;
            let mut is_seen = vec![false; of.len()];
            is_seen[start] = true;
            let (mut floor, mut next) = (vec![start], 0);
            while next < floor.len() {
                for (j, _) in around(floor[next], raster.cols, raster.rows) {
                    if of[j] && !raster.wall[j] && !is_seen[j] {
                        is_seen[j] = true;
                        floor.push(j);
                    }
                }
                next += 1;
            }
            Some(floor)
        };
        let left: Vec<usize> = outside.iter().filter_map(|p| floor_at(*p, &self.inside)).flatten().collect();
        let floors: Vec<Option<Vec<usize>>> =
            inside.iter().map(|p| closings.iter().find_map(|of| floor_at(*p, of))).collect();
        let open = (0..inside.len()).filter(|i| floors[*i].is_none()).collect();
        for i in floors.into_iter().flatten().flatten() {
            (self.inside[i], self.cavity[i]) = (true, false);
        }
        left.into_iter().for_each(|i| self.inside[i] = false);
        (self.counted_again(), open)
    }

    /// The same, where parts of the drawn walls stop no sight: doors and windows that are drawn through.
    #[must_use]
    pub fn with_drawn_openings(self) -> Self {
        Self { is_as_drawn: false, ..self }
    }

    /// Half width of the openings that were taken as closed, beside known doors and windows.
    pub fn closing_m(&self) -> f64 {
        self.closing_m
    }

    /// Whether the point lies inside the building (walls included).
    pub fn contains(&self, p: PointUm) -> bool {
        self.pixel(p).is_some_and(|i| self.inside[i])
    }

    /// Whether the point lies so near to a wall, or to what closes a gap in one, that [`Self::contains`] does not tell
    /// its two sides apart.
    pub fn is_at_wall(&self, p: PointUm) -> bool {
        self.pixel(p).is_some_and(|i| self.wall[i])
    }

    /// Whether the point lies in a cavity inside a wall.
    pub fn is_cavity(&self, p: PointUm) -> bool {
        self.pixel(p).is_some_and(|i| self.cavity[i])
    }

    /// Two corners of the box round all that lies inside, drawing frame, micrometres; `None` where nothing does.
    pub fn extent_um(&self) -> Option<[PointUm; 2]> {
        let at = |i: usize| [i / self.rows, i % self.rows].map(|k| k as i64);
        let mut pixels = (0..self.inside.len()).filter(|i| self.inside[*i]).map(at);
        let first = pixels.next()?;
        let [lo, hi] = pixels.fold([first, first], |[lo, hi], p| {
            [[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]]
        });
        let corner = |p: [i64; 2]| [0, 1].map(|k| self.origin_um[k] + p[k] * self.pixel_um);
        Some([corner(lo), corner([hi[0] + 1, hi[1] + 1])])
    }

    /// Distance to the nearest point outside the building, metres; 0 outside.
    pub fn depth_m(&self, p: PointUm) -> f64 {
        self.pixel(p).map_or(0.0, |i| f64::from(self.outside_far[i]) * self.pixel_um as f64 / UM_PER_M)
    }

    /// Whether anything but walls and the cavities in them is enclosed.
    pub fn has_room(&self) -> bool {
        self.has_room
    }

    /// Enclosed area without cavities, m².
    pub fn area_m2(&self) -> f64 {
        let pixels = self.inside.iter().zip(&self.cavity).filter(|(i, c)| **i && !**c).count();
        pixels as f64 * (self.pixel_um as f64 / UM_PER_M).powi(2)
    }

    /// Lower left corner of the raster, drawing frame, micrometres.
    pub(super) fn origin_um(&self) -> PointUm {
        self.origin_um
    }

    /// Side of a pixel, micrometres.
    pub(super) fn pixel_um(&self) -> i64 {
        self.pixel_um
    }

    /// Pixels of one column; pixel `c * rows + r` is the one at column `c` and row `r`.
    pub(super) fn rows(&self) -> usize {
        self.rows
    }

    /// Number of pixels.
    pub(super) fn len(&self) -> usize {
        self.inside.len()
    }

    /// Whether a pixel lies on a wall or on what closes a gap in one.
    pub(super) fn is_wall(&self, pixel: usize) -> bool {
        self.wall[pixel]
    }

    /// Whether a pixel is measured floor.
    pub(super) fn is_floor(&self, pixel: usize) -> bool {
        self.inside[pixel] && !self.cavity[pixel] && !self.wall[pixel]
    }

    /// Whether a pixel lies within the building's outline and is not measured.
    pub(super) fn is_left_out(&self, pixel: usize) -> bool {
        self.outline[pixel] && !self.inside[pixel] && !self.wall[pixel]
    }

    /// Whether a pixel lies outside what is measured, and on no wall.
    pub(super) fn is_outside(&self, pixel: usize) -> bool {
        !self.inside[pixel] && !self.wall[pixel]
    }

    /// The pixels beside one.
    pub(super) fn beside(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        around(pixel, self.cols, self.rows).map(|(j, _)| j)
    }

    /// Distance of every pixel to the nearest marked one, pixels.
    pub(super) fn distance_px(&self, marked: &[bool]) -> Vec<f32> {
        distance_px(marked, self.cols, self.rows)
    }

    fn pixel(&self, p: PointUm) -> Option<usize> {
        let k = |k: usize| (p[k] - self.origin_um[k]).div_euclid(self.pixel_um);
        let (c, r) = (k(0), k(1));
        let inside = c >= 0 && r >= 0 && c < self.cols as i64 && r < self.rows as i64;
        inside.then(|| c as usize * self.rows + r as usize)
    }
}

struct Raster {
    origin_um: PointUm,
    pixel_um: i64,
    cols: usize,
    rows: usize,
    wall: Vec<bool>,
}

impl Raster {
    fn new(walls: &[Segment], closings: &[Segment], human_scale: f64) -> Option<Self> {
        let (mut lo, mut hi) = ([i64::MAX; 2], [i64::MIN; 2]);
        for p in walls.iter().chain(closings).flat_map(|w| [w.a, w.b]) {
            for k in 0..2 {
                lo[k] = lo[k].min(p[k]);
                hi[k] = hi[k].max(p[k]);
            }
        }
        if walls.is_empty() {
            return None;
        }
        let long = (hi[0] - lo[0]).max(hi[1] - lo[1]) as f64;
        let pixel_um = (long / PIXELS_ALONG).max(PIXEL_MIN_M * human_scale * UM_PER_M).max(1.0) as i64;
        // Room for the widest disc all round.
        let pad = (CLOSING_M[CLOSING_M.len() - 1] * human_scale * UM_PER_M) as i64 / pixel_um + 3;
        let size = |k: usize| ((hi[k] - lo[k]) / pixel_um + 2 * pad + 1) as usize;
        let (cols, rows) = (size(0), size(1));
        let origin_um = [lo[0] - pad * pixel_um, lo[1] - pad * pixel_um];
        Some(Self { origin_um, pixel_um, cols, rows, wall: vec![false; cols * rows] })
    }

    fn draw(&mut self, walls: &[Segment]) {
        for w in walls {
            let d = [(w.b[0] - w.a[0]) as f64, (w.b[1] - w.a[1]) as f64];
            let steps = (d[0].abs().max(d[1].abs()) / self.pixel_um as f64 * 2.0).ceil().max(1.0) as i64;
            for i in 0..=steps {
                let t = i as f64 / steps as f64;
                let at = |k: usize| {
                    (w.a[k] + (d[k] * t) as i64 - self.origin_um[k]).div_euclid(self.pixel_um) as usize
                };
                let (c, r) = (at(0), at(1));
                self.wall[c * self.rows + r] = true;
            }
        }
    }

    /// Pixels that a disc of radius `closing_m` rolling in from the border never covers.
    fn enclosed(&self, to_wall: &[f32], closing_m: f64) -> Vec<bool> {
        let radius_px = (closing_m * UM_PER_M / self.pixel_um as f64) as f32;
        let free = |i: usize| !self.wall[i] && to_wall.get(i).is_none_or(|d| *d > radius_px);
        let mut outside = vec![false; self.wall.len()];
        let mut stack = vec![0usize];
        outside[0] = true;
        while let Some(i) = stack.pop() {
            for (j, _) in around(i, self.cols, self.rows) {
                if !outside[j] && free(j) {
                    outside[j] = true;
                    stack.push(j);
                }
            }
        }
        if closing_m == 0.0 {
            return outside.iter().map(|o| !o).collect();
        }
        let to_outside = distance_px(&outside, self.cols, self.rows);
        to_outside.iter().map(|d| *d > radius_px).collect()
    }

    /// Enclosed parts that are nowhere far from a wall.
    fn cavities(&self, inside: &[bool], to_wall: &[f32], half_width_m: f64) -> Vec<bool> {
        let reach = (half_width_m * UM_PER_M / self.pixel_um as f64) as f32;
        let mut cavity = vec![false; inside.len()];
        let mut seen = vec![false; inside.len()];
        let open = |i: usize| inside[i] && !self.wall[i];
        for start in 0..inside.len() {
            if seen[start] || !open(start) {
                continue;
            }
            let (mut part, mut next, mut widest) = (vec![start], 0, 0.0_f32);
            seen[start] = true;
            while next < part.len() {
                let i = part[next];
                next += 1;
                widest = widest.max(to_wall[i]);
                for (j, _) in around(i, self.cols, self.rows) {
                    if !seen[j] && open(j) {
                        seen[j] = true;
                        part.push(j);
                    }
                }
            }
            if widest <= reach {
                part.iter().for_each(|i| cavity[*i] = true);
            }
        }
        cavity
    }

    /// Narrow parts that bare lines enclose in a plan whose walls have two faces: thick walls where they meet, piers,
    /// chimneys. What lies beyond their outline is a room or the outside and not a wall's thickness.
    fn masses(&self, human_scale: f64) -> Vec<bool> {
        let (label, widest) = self.parts(&distance_px(&self.wall, self.cols, self.rows));
        let reaches = |half_width_m: f64, part: u32| {
            let reach = (half_width_m * human_scale * UM_PER_M / self.pixel_um as f64) as f32;
            widest[part as usize] > reach
        };
        let is_wide = |part: u32| reaches(MASS_HALF_WIDTH_M, part);
        let is_wall = |part: u32| !reaches(CORNER_HALF_WIDTH_M, part);
        let mut outlines = vec![Outline::default(); widest.len()];
        for i in (0..self.wall.len()).filter(|i| !self.wall[*i]) {
            for (j, step) in around(i, self.cols, self.rows).filter(|(j, _)| self.wall[*j]) {
                let beyond = self.beyond(j, step).map(|k| label[k]);
                if beyond != Some(label[i]) {
                    let outline = &mut outlines[label[i] as usize];
                    outline.all += 1;
                    outline.wide += u64::from(beyond.is_some_and(is_wide));
                    outline.wall += u64::from(beyond.is_some_and(is_wall));
                }
            }
        }
        if !is_two_faced(&outlines, is_wide) {
            return vec![false; self.wall.len()];
        }
        let is_mass = |part: u32| {
            let outline = outlines[part as usize];
            !is_wide(part) && outline.wide as f64 >= BARE * outline.all as f64
        };
        (0..self.wall.len()).map(|i| !self.wall[i] && is_mass(label[i])).collect()
    }

    /// The first pixel behind a line that a step leads onto; none where it is thicker than a line.
    fn beyond(&self, onto: usize, step: isize) -> Option<usize> {
        let at = |n: usize| onto.checked_add_signed(step * n as isize).filter(|i| *i < self.wall.len());
        (1..=LINE_PX).map_while(at).find(|i| !self.wall[*i])
    }

    /// The part between lines that each pixel lies in, the outside first, and how far each reaches from the nearest line,
    /// pixels.
    fn parts(&self, to_wall: &[f32]) -> (Vec<u32>, Vec<f32>) {
        let (mut label, mut widest) = (vec![u32::MAX; self.wall.len()], Vec::new());
        for start in 0..label.len() {
            if self.wall[start] || label[start] != u32::MAX {
                continue;
            }
            let part = widest.len() as u32;
            let (mut stack, mut far) = (vec![start], 0.0_f32);
            label[start] = part;
            while let Some(i) = stack.pop() {
                far = far.max(to_wall[i]);
                for (j, _) in around(i, self.cols, self.rows) {
                    if !self.wall[j] && label[j] == u32::MAX {
                        label[j] = part;
                        stack.push(j);
                    }
                }
            }
            widest.push(far);
        }
        (label, widest)
    }
}

/// What lies beyond the outline of a part between lines, pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Outline {
    /// Its length.
    all: u64,
    /// How much of it leads to what is as wide as a room.
    wide: u64,
    /// How much of it leads to what is as thin as a wall.
    wall: u64,
}

/// Whether a plan draws its walls with two faces: rooms lead to their thickness. Where none is enclosed the outside
/// tells, the first part.
fn is_two_faced(outlines: &[Outline], is_wide: impl Fn(u32) -> bool) -> bool {
    let rooms = outlines.iter().enumerate().skip(1).filter(|(part, _)| is_wide(*part as u32));
    let [all, wide] = rooms.fold([0, 0], |[all, wide], (_, o)| [all + o.all, wide + o.wide]);
    match outlines.first() {
        _ if all > 0 => wide as f64 <= (1.0 - TWO_FACED) * all as f64,
        Some(outside) => outside.wall as f64 >= TWO_FACED * outside.all.max(1) as f64,
        None => false,
    }
}

/// The neighbours of a pixel, each with the step that leads on from there.
fn around(i: usize, cols: usize, rows: usize) -> impl Iterator<Item = (usize, isize)> {
    let (c, r, row) = (i / rows, i % rows, rows as isize);
    let all = [(c > 0, -row), (c + 1 < cols, row), (r > 0, -1), (r + 1 < rows, 1)];
    all.into_iter().filter(|a| a.0).map(move |(_, step)| (i.wrapping_add_signed(step), step))
}

/// Distance of every pixel to the nearest marked one, in pixels (Felzenszwalb & Huttenlocher 2012).
fn distance_px(marked: &[bool], cols: usize, rows: usize) -> Vec<f32> {
    let far = ((cols + rows) * (cols + rows)) as f64;
    let mut grid: Vec<f64> = marked.iter().map(|m| if *m { 0.0 } else { far }).collect();
    for column in grid.chunks_mut(rows) {
        let squared = lower_envelope(column);
        column.copy_from_slice(&squared);
    }
    let mut line = vec![0.0; cols];
    for r in 0..rows {
        for c in 0..cols {
            line[c] = grid[c * rows + r];
        }
        for (c, v) in lower_envelope(&line).into_iter().enumerate() {
            grid[c * rows + r] = v;
        }
    }
    grid.into_iter().map(|v| v.sqrt() as f32).collect()
}

fn lower_envelope(f: &[f64]) -> Vec<f64> {
    let n = f.len();
    let (mut v, mut z) = (vec![0usize; n], vec![0.0; n + 1]);
    let mut k = 0;
    (z[0], z[1]) = (f64::NEG_INFINITY, f64::INFINITY);
    let crossing = |q: usize, p: usize| {
        ((f[q] + (q * q) as f64) - (f[p] + (p * p) as f64)) / (2.0 * q as f64 - 2.0 * p as f64)
    };
    for q in 1..n {
        let mut s = crossing(q, v[k]);
        while s <= z[k] {
            k -= 1;
            s = crossing(q, v[k]);
        }
        k += 1;
        v[k] = q;
        z[k] = s;
        z[k + 1] = f64::INFINITY;
    }
    k = 0;
    (0..n)
        .map(|q| {
            while z[k + 1] < q as f64 {
                k += 1;
            }
            (q as f64 - v[k] as f64).powi(2) + f[v[k]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const M: i64 = 1_000_000;

    /// The sides of a rectangle, its corner and its extent in centimetres.
    fn rectangle(x: i64, y: i64, w: i64, h: i64) -> Vec<Segment> {
        let at = |x: i64, y: i64| [x * M / 100, y * M / 100];
        let ring = [at(x, y), at(x + w, y), at(x + w, y + h), at(x, y + h)];
        (0..4).map(|i| Segment { a: ring[i], b: ring[(i + 1) % 4] }).collect()
    }

    fn is_cavity(walls: &[Vec<Segment>], x: i64, y: i64) -> bool {
        let interior = Interior::new(&walls.concat(), &[], 1.0).unwrap();
        let at = [x * M / 100, y * M / 100];
        assert!(interior.contains(at));
        interior.is_cavity(at)
    }

    #[test]
    fn a_pier_wider_than_a_wall_is_a_mass_where_walls_have_two_faces() {
        let [outer, inner] = [rectangle(0, 0, 900, 700), rectangle(40, 40, 820, 620)];
        let pier = rectangle(300, 200, 130, 320);
        let room = [outer.clone(), inner.clone(), pier.clone()];
        assert!(is_cavity(&room, 360, 300) && !is_cavity(&room, 200, 300));
        // In a plan of single lines it may be a room, and so it may where it is as wide as one.
        assert!(!is_cavity(&[inner.clone(), pier], 360, 300));
        assert!(!is_cavity(&[outer.clone(), inner.clone(), rectangle(300, 200, 180, 320)], 390, 300));
        // Where no room is enclosed the walls beside it tell.
        let bars = [rectangle(0, 0, 600, 30), rectangle(700, 0, 30, 500), rectangle(0, 200, 130, 320)];
        let lone = |walls: &[Vec<Segment>]| {
            let mut interior = Interior::new(&walls.concat(), &[], 1.0).unwrap();
            interior.inside.fill(true);
            interior.is_cavity([600_000, 3_600_000])
        };
        assert!(lone(&bars) && !lone(&bars[2..]));
        // A closet as narrow behind walls of its own.
        let closet = [rectangle(300, 200, 130, 320), rectangle(285, 185, 160, 350)];
        assert!(!is_cavity(&[vec![outer, inner], closet.to_vec()].concat(), 360, 300));
    }

    /// A slot behind glass is open to the eye.
    #[test]
    fn what_glass_closes_is_no_mass() {
        let [outer, inner] = [rectangle(0, 0, 900, 700), rectangle(40, 40, 820, 620)];
        let mut slot = rectangle(300, 200, 130, 320);
        let glass = slot.remove(1);
        let walls = [outer, inner, slot].concat();
        let interior = Interior::new(&walls, &[glass], 1.0).unwrap();
        assert!(!interior.is_cavity([3_600_000, 3_000_000]));
    }

    /// Half a metre thick, walls are wider than a cavity where they meet, and cells in them are no floor.
    #[test]
    fn thick_walls_are_no_room_where_they_meet() {
        let walls = [rectangle(0, 0, 900, 700), rectangle(55, 55, 790, 590)];
        assert!(is_cavity(&walls, 27, 27) && !is_cavity(&walls, 300, 300));
    }
}
