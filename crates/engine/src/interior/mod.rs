//! Where the building's interior is, when no region says so.
//!
//! The interior is a cut: the free ground is parted at its narrow places, and what walls surround is inside as far as the
//! ways out of it are narrow beside it. Real plans leave the entrance open, and glass fronts. Computed on a raster
//! of its own, because a lattice may be far coarser than a door.

mod cavity;
mod cut;
mod enclosure;
mod raster;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use crate::geometry::{PointUm, Segment, Side, UM_PER_M, side_of_ring};
use cut::{Parts, Terms};
use raster::Raster;

/// What is measured.
const MEASURED: Terms = Terms { hidden_min: 0.72, way: 0.25 };

/// What may belong to the building: floor that is inside by these alone counts as left out.
const MAY_BE: Terms = Terms { hidden_min: 0.6, way: 0.1 };

/// Widest door, metres of a person: what parts floor outdoors from a room without walls is no wider.
const DOOR_MAX_M: f64 = 1.3;

/// The interior of a plan on a raster.
#[derive(Clone, Debug)]
pub struct Interior {
    raster: Raster,
    is_as_drawn: bool,
    gap_m: f64,
    inside: Vec<bool>,
    cavity: Vec<bool>,
    /// What may belong to the building.
    outline: Vec<bool>,
    /// Distance of every pixel to what lies outside, once it is asked for.
    outside_far: OnceLock<Vec<f32>>,
    has_room: bool,
}

/// The floor round points of an interior.
struct Around {
    raster: Raster,
    before: Vec<bool>,
    parts: Parts,
}

impl Around {
    fn new(of: &Interior) -> Self {
        let raster = of.raster.clone();
        let parts = Parts::new(&raster, &raster.distance(&raster.wall));
        Self { raster, before: of.outline.clone(), parts }
    }

    /// Pixels as far as the cheapest cut reaches that has a point on its side.
    fn floor(&self, p: PointUm, is_inside: bool) -> Option<Vec<usize>> {
        let label = &self.parts.label;
        let at = self.raster.at(p).filter(|i| label[*i] != cut::NONE)?;
        let (said, _) = self.parts.inside(MEASURED, &BTreeMap::from([(label[at], is_inside)]));
        let mut seen = vec![false; self.before.len()];
        Some(self.raster.flood(at, &mut seen, |i| {
            !self.raster.wall[i] && said[label[i] as usize] == is_inside && (is_inside || self.before[i])
        }))
    }
}

impl Interior {
    /// Finds the interior of the walls as they stand. `closings`: lines across doors and windows, where they
    /// are known. `None` without walls. All lengths that mean a person's shrink with `human_scale`.
    pub fn new(walls: &[Segment], closings: &[Segment], human_scale: f64) -> Option<Self> {
        let mut raster = Raster::new(walls, closings, human_scale)?;
        raster.draw(walls);
        let open = raster.open_ground();
        // What glass or a door closes is no mass.
        let masses = raster.masses(human_scale);
        raster.draw(closings);
        let to_wall = raster.distance(&raster.wall);
        let parts = Parts::new(&raster, &to_wall);
        let (is_inside, widest) = parts.inside(MEASURED, &BTreeMap::new());
        let (may_be, _) = parts.inside(MAY_BE, &BTreeMap::new());
        let inside = parts.spread(&raster, &is_inside);
        let mut outline = parts.spread(&raster, &may_be);
        outline.iter_mut().zip(&inside).for_each(|(o, i)| *o |= i);
        let is_as_drawn = (0..inside.len()).all(|i| raster.wall[i] || inside[i] != open[i]);
        let mut cavity = raster.cavities(&inside, &to_wall, human_scale);
        cavity.iter_mut().zip(masses).for_each(|(c, is_mass)| *c |= is_mass);
        let gap_m = 2.0 * f64::from(widest) * raster.pixel_um as f64 / UM_PER_M;
        let out = Self {
            raster,
            is_as_drawn,
            gap_m,
            inside,
            cavity,
            outline,
            outside_far: OnceLock::new(),
            has_room: false,
        };
        Some(Self { is_as_drawn, ..out.counted_again() })
    }

    /// Whether the walls as drawn enclose the building, without any gap taken as closed.
    pub fn is_as_drawn(&self) -> bool {
        self.is_as_drawn
    }

    /// The same without the ground in some rings (drawing frame, micrometres), which lies outdoors.
    #[must_use]
    pub fn without(mut self, rings: &[Vec<PointUm>]) -> Self {
        let before = self.inside.iter().filter(|i| **i).count();
        for ring in rings {
            let bound = |k: usize, far: bool| {
                let ordinates = ring.iter().map(|p| p[k] - self.raster.origin_um[k]);
                let end = if far { ordinates.max() } else { ordinates.min() };
                let last = if k == 0 { self.raster.cols } else { self.raster.rows } as i64 - 1;
                end.unwrap_or(0).div_euclid(self.raster.pixel_um).clamp(0, last) as usize
            };
            let (cols, rows) = (bound(0, false)..=bound(0, true), bound(1, false)..=bound(1, true));
            for (c, r) in cols.flat_map(|c| rows.clone().map(move |r| (c, r))) {
                let middle = |k: usize, i: usize| {
                    self.raster.origin_um[k] + i as i64 * self.raster.pixel_um + self.raster.pixel_um / 2
                };
                if side_of_ring(ring, [middle(0, c), middle(1, r)]) == Side::Inside {
                    self.inside[c * self.raster.rows + r] = false;
                    self.outline[c * self.raster.rows + r] = false;
                }
            }
        }
        if self.inside.iter().filter(|i| **i).count() < before { self.counted_again() } else { self }
    }

    /// The same after some of its pixels were taken in or out.
    fn counted_again(mut self) -> Self {
        self.outside_far = OnceLock::new();
        self.has_room =
            (0..self.inside.len()).any(|i| self.inside[i] && !self.cavity[i] && !self.raster.wall[i]);
        self.is_as_drawn = false;
        self
    }

    /// The same with the floor round some points, and without that round others (drawing frame, micrometres): as far as the
    /// cheapest cut reaches that has the point on its side. Besides the points inside whose floor is open to the
    /// outside, by their index: they change nothing.
    #[must_use]
    pub fn corrected(mut self, inside: &[PointUm], outside: &[PointUm]) -> (Self, Vec<usize>) {
        let around = Around::new(&self);
        let is_open = |floor: &[usize]| floor.iter().any(|i| around.raster.is_border(*i));
        for p in outside {
            let own = around.raster.at(*p).filter(|i| self.outline[*i]);
            for i in own.and_then(|_| around.floor(*p, false)).into_iter().flatten() {
                (self.inside[i], self.outline[i]) = (false, false);
            }
        }
        let mut open = Vec::new();
        for (k, p) in inside.iter().enumerate() {
            match around.floor(*p, true).filter(|f| !is_open(f)) {
                Some(floor) => floor.into_iter().for_each(|i| {
                    (self.inside[i], self.outline[i], self.cavity[i]) = (true, true, false);
                }),
                None => open.push(k),
            }
        }
        (self.counted_again(), open)
    }

    /// The same without the floor round points that are called outdoors (drawing frame, micrometres), where walls, doors and
    /// gaps of a door's width part it from all other floor; not where one of `rooms` stands on it too, nor where nothing else
    /// is left. Besides the points without whose floor it is, by their index.
    #[must_use]
    pub fn without_called(
        self,
        outdoors: &[PointUm],
        rooms: &[PointUm],
        human_scale: f64,
    ) -> (Self, Vec<usize>) {
        if !outdoors.iter().any(|p| self.contains(*p)) {
            return (self, Vec::new());
        }
        let around = Around::new(&self);
        let taken: Vec<usize> = rooms.iter().filter_map(|p| around.raster.at(*p)).collect();
        let door = DOOR_MAX_M * human_scale * UM_PER_M / around.raster.pixel_um as f64;
        let (mut out, mut left) = (self.clone(), Vec::new());
        for (k, p) in outdoors.iter().enumerate().filter(|(_, p)| self.contains(**p)) {
            let Some(floor) = around.floor(*p, false) else { continue };
            if taken.iter().any(|room| floor.contains(room)) || out.border(&floor) as f64 > door {
                continue;
            }
            for i in floor {
                (out.inside[i], out.outline[i]) = (false, false);
            }
            left.push(k);
        }
        let out = out.counted_again();
        if out.has_room { (out, left) } else { (self, Vec::new()) }
    }

    /// How many pixels of other floor inside lie beside some.
    fn border(&self, floor: &[usize]) -> usize {
        let own: std::collections::HashSet<usize> = floor.iter().copied().collect();
        let is_other = |i: &usize| self.inside[*i] && !self.raster.wall[*i] && !own.contains(i);
        let rows = self.raster.rows;
        let beside = floor.iter().flat_map(|i| [i.wrapping_sub(rows), i + rows, i.wrapping_sub(1), i + 1]);
        beside.filter(|i| *i < self.inside.len()).filter(is_other).count()
    }

    /// The same, where parts of the drawn walls stop no sight: doors and windows that are drawn through.
    #[must_use]
    pub fn with_drawn_openings(self) -> Self {
        Self { is_as_drawn: false, ..self }
    }

    /// Width of the widest way that was taken as closed, beside known doors and windows.
    pub fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// Whether the point lies inside the building (walls included).
    pub fn contains(&self, p: PointUm) -> bool {
        self.raster.at(p).is_some_and(|i| self.inside[i])
    }

    /// Whether the point lies so near to a wall, or to what closes a gap in one, that [`Self::contains`] does not tell
    /// its two sides apart.
    pub fn is_at_wall(&self, p: PointUm) -> bool {
        self.raster.at(p).is_some_and(|i| self.raster.wall[i])
    }

    /// Whether the point lies in a cavity inside a wall.
    pub fn is_cavity(&self, p: PointUm) -> bool {
        self.raster.at(p).is_some_and(|i| self.cavity[i])
    }

    /// Two corners of the box round all that lies inside, drawing frame, micrometres; `None` where nothing does.
    pub fn extent_um(&self) -> Option<[PointUm; 2]> {
        let at = |i: usize| [i / self.raster.rows, i % self.raster.rows].map(|k| k as i64);
        let mut pixels = (0..self.inside.len()).filter(|i| self.inside[*i]).map(at);
        let first = pixels.next()?;
        let [lo, hi] = pixels.fold([first, first], |[lo, hi], p| {
            [[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]]
        });
        let corner = |p: [i64; 2]| [0, 1].map(|k| self.raster.origin_um[k] + p[k] * self.raster.pixel_um);
        Some([corner(lo), corner([hi[0] + 1, hi[1] + 1])])
    }

    /// Distance to the nearest point outside the building, metres; 0 outside.
    pub fn depth_m(&self, p: PointUm) -> f64 {
        let outside_far = self.outside_far.get_or_init(|| {
            let outside: Vec<bool> = self.inside.iter().map(|i| !i).collect();
            self.raster.distance(&outside)
        });
        let far = |i: usize| f64::from(outside_far[i]) * self.raster.pixel_um as f64 / UM_PER_M;
        self.raster.at(p).map_or(0.0, far)
    }

    /// Whether anything but walls and the cavities in them is enclosed.
    pub fn has_room(&self) -> bool {
        self.has_room
    }

    /// Enclosed area without cavities, m².
    pub fn area_m2(&self) -> f64 {
        let pixels = self.inside.iter().zip(&self.cavity).filter(|(i, c)| **i && !**c).count();
        pixels as f64 * (self.raster.pixel_um as f64 / UM_PER_M).powi(2)
    }

    /// Lower left corner of the raster, drawing frame, micrometres.
    pub fn origin_um(&self) -> PointUm {
        self.raster.origin_um
    }

    /// Side of a pixel, micrometres.
    pub fn pixel_um(&self) -> i64 {
        self.raster.pixel_um
    }

    /// Pixels of one column; pixel `c * rows + r` is the one at column `c` and row `r`.
    pub fn rows(&self) -> usize {
        self.raster.rows
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        self.inside.len()
    }

    /// Whether it has no pixel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether a pixel lies on a wall or on what closes a gap in one.
    pub fn is_wall(&self, pixel: usize) -> bool {
        self.raster.wall[pixel]
    }

    /// Whether a pixel is measured floor.
    pub fn is_floor(&self, pixel: usize) -> bool {
        self.inside[pixel] && !self.cavity[pixel] && !self.raster.wall[pixel]
    }

    /// Whether a pixel lies within the building's outline and is not measured.
    pub fn is_left_out(&self, pixel: usize) -> bool {
        self.outline[pixel] && !self.inside[pixel] && !self.raster.wall[pixel]
    }

    /// Whether a pixel lies outside what is measured, and on no wall.
    pub fn is_outside(&self, pixel: usize) -> bool {
        !self.inside[pixel] && !self.raster.wall[pixel]
    }

    /// The pixels beside one.
    pub fn beside(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        self.raster.around(pixel).map(|(j, _)| j)
    }

    /// Distance of every pixel to the nearest marked one, pixels.
    pub fn distance_px(&self, marked: &[bool]) -> Vec<f32> {
        self.raster.distance(marked)
    }
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

    /// A ring of walls 0.3 m thick, `w` by `h` centimetres, with a gap in its lower side.
    fn with_gap(w: i64, h: i64, gap: i64) -> Vec<Segment> {
        let mut out = Vec::new();
        for d in [0, 30] {
            let sides = rectangle(d, d, w - 2 * d, h - 2 * d);
            let at = |x: i64| [x * M / 100, d * M / 100];
            out.push(Segment { a: at(d), b: at((w - gap) / 2) });
            out.push(Segment { a: at((w + gap) / 2), b: at(w - d) });
            out.extend(&sides[1..]);
        }
        out
    }

    fn lies_inside(walls: &[Segment], [x, y]: [i64; 2]) -> bool {
        Interior::new(walls, &[], 1.0).unwrap().contains([x * M / 100, y * M / 100])
    }

    /// A gap is one beside what it opens, however large the building is.
    #[test]
    fn a_gap_in_the_outline_opens_no_building() {
        for scale in [1, 5, 30] {
            for (gap, is_inside) in [(0, true), (90, true), (180, true), (520, false)] {
                let walls = with_gap(600 * scale, 800 * scale, gap * scale);
                assert_eq!(lies_inside(&walls, [300 * scale, 400 * scale]), is_inside, "{gap} times {scale}");
            }
        }
    }

    /// The ground before a building with two wings is outside, and so is what an angle of walls leaves open.
    #[test]
    fn courts_that_are_open_to_one_side_lie_outside() {
        let bar = |x: i64, y: i64, w: i64, h: i64| {
            [rectangle(x, y, w, h), rectangle(x + 30, y + 30, w - 60, h - 60)].concat()
        };
        let wings = [bar(0, 0, 800, 3000), bar(2800, 0, 800, 3000), bar(770, 2200, 2060, 800)].concat();
        assert!(!lies_inside(&wings, [1800, 1000]) && lies_inside(&wings, [1800, 2600]));
        assert!(!lies_inside(&wings[8..], [400, 400]));
    }

    /// What the user says of one place reaches to the next narrow one.
    #[test]
    fn a_place_is_taken_in_or_out_with_the_floor_round_it() {
        let walls = with_gap(600, 800, 420);
        let at = [3 * M, 4 * M];
        let (taken_in, open) = Interior::new(&walls, &[], 1.0).unwrap().corrected(&[at], &[]);
        assert!(taken_in.contains(at) && open.is_empty());
        let (left_out, _) = taken_in.corrected(&[], &[at]);
        assert!(!left_out.contains(at));
        let (_, open) = left_out.corrected(&[[-M, -M]], &[]);
        assert_eq!(open, [0], "no wall is near it");
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
