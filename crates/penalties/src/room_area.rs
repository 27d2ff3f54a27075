//! Room area: floor that rooms lose when walls move.
//!
//! A room is a stretch of floor that walls and closed doors, windows and passages enclose, large enough to
//! hold a person. Areas are counted on a raster that is turned against the walls by an angle of irrational
//! tangent, so that a wall passes its cells one by one and the area changes evenly as it moves.

use std::collections::VecDeque;

use glam::DVec2;

use super::Layout;

/// Cells of the raster, about.
const CELLS: f64 = 20_000.0;
/// Tangent of the raster's angle: the golden section, the number worst met by fractions.
const TURN: f64 = 0.618_033_988_749_894_9;
/// What encloses less is a cupboard or a cavity.
pub const ROOM_MIN_M2: f64 = 1.5;
/// A room holds a disc of this radius, metres: the inside of a wall does not.
pub const ROOM_REACH_M: f64 = 0.3;
/// What lies this far from all walls, metres, is the middle of a room, or half as far in as the room reaches.
const MIDDLE_M: f64 = 1.0;
/// How far a door's jamb lies from the wall end it goes with, metres, at most.
const JAMB_REACH_M: f64 = 0.6;

/// The link of a cell to its right neighbour is cut.
const RIGHT: u8 = 1;
/// The link to the upper one.
const UP: u8 = 2;
const NONE: u32 = u32::MAX;

/// Measures the rooms of the initial layout in any other.
///
/// A room's floor is what can be reached from its middle without passing a wall or a closed door. Where a
/// wall comes off and two rooms become one, each keeps the floor that is nearer to its own middle: the
/// areas have no jump as a gap opens.
#[derive(Clone, Debug)]
pub struct RoomArea {
    raster: Raster,
    /// Cut links of what stays.
    fixed: Vec<u8>,
    moving: Vec<usize>,
    closings: Vec<[Anchor; 2]>,
    /// Areas in the initial layout, m².
    initial_m2: Vec<f64>,
    /// The middle cells of every room, then those of the outside.
    cores: Vec<Vec<u32>>,
}

/// A point that goes with a wall end.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    /// Piece and whether its end is `b`; none: it stays.
    end: Option<(usize, bool)>,
    offset: DVec2,
}

impl RoomArea {
    /// `closings` close doors, windows and passages of the initial layout, plan frame, metres; `scale` is
    /// the metres of the plan in one metre of a person.
    pub fn new(initial: &Layout<'_>, closings: &[[DVec2; 2]], scale: f64) -> Self {
        let pieces = initial.pieces;
        let raster = Raster::over(pieces.iter().flat_map(|p| p.ends()));
        let mut fixed = vec![0; raster.cols * raster.rows];
        let (moving, still): (Vec<usize>, Vec<usize>) = (0..pieces.len()).partition(|&i| pieces[i].is_moving);
        still.iter().for_each(|&i| raster.cut(&mut fixed, pieces[i].ends()));
        let mut going = Vec::new();
        for ends in closings {
            let anchors = ends.map(|p| Anchor::new(initial, p, JAMB_REACH_M * scale));
            if anchors.iter().any(|a| a.end.is_some_and(|(i, _)| pieces[i].is_moving)) {
                going.push(anchors);
            } else {
                raster.cut(&mut fixed, *ends);
            }
        }
        let mut new =
            Self { raster, fixed, moving, closings: going, initial_m2: Vec::new(), cores: Vec::new() };
        new.find_rooms(initial, scale);
        new
    }

    fn find_rooms(&mut self, initial: &Layout<'_>, scale: f64) {
        let links = self.links(initial);
        let (labels, sizes) = self.raster.components(&links);
        let depths = self.raster.depths(&links);
        let mut deepest = vec![0u32; sizes.len()];
        for (label, depth) in labels.iter().zip(&depths) {
            deepest[*label as usize] = deepest[*label as usize].max(*depth);
        }
        let outside = labels.first().copied().unwrap_or(NONE);
        let cell_m2 = self.raster.pitch_m * self.raster.pitch_m;
        let is_room = |l: usize| {
            l as u32 != outside
                && f64::from(sizes[l]) * cell_m2 >= ROOM_MIN_M2 * scale * scale
                && f64::from(deepest[l]) * self.raster.pitch_m >= ROOM_REACH_M * scale
        };
        let rooms: Vec<usize> = (0..sizes.len()).filter(|l| is_room(*l)).collect();
        self.initial_m2 = rooms.iter().map(|l| f64::from(sizes[*l]) * cell_m2).collect();
        let core = |l: usize| {
            let least = f64::from(deepest[l] / 2).min(MIDDLE_M * scale / self.raster.pitch_m) as u32;
            let is_middle = |i: &usize| labels[*i] as usize == l && depths[*i] >= least;
            (0..labels.len()).filter(is_middle).map(|i| i as u32).collect::<Vec<u32>>()
        };
        self.cores = rooms.into_iter().map(core).collect();
        if outside != NONE {
            self.cores.push(core(outside as usize));
        }
    }

    /// Areas of the rooms as drawn, m².
    pub fn initial_m2(&self) -> &[f64] {
        &self.initial_m2
    }

    /// Areas of the same rooms in a layout, m²; 0 for a room that is no more. `now` lists the pieces of the
    /// initial layout in the same order.
    pub fn areas_m2(&self, now: &Layout<'_>) -> Vec<f64> {
        let links = self.links(now);
        let (labels, sizes) = self.raster.components(&links);
        let homes: Vec<u32> = self.cores.iter().map(|core| home(core, &labels)).collect();
        let cell_m2 = self.raster.pitch_m * self.raster.pitch_m;
        let mut counts = vec![0u32; self.cores.len()];
        for (k, home) in homes.iter().enumerate().filter(|h| *h.1 != NONE) {
            let together: Vec<usize> = (0..homes.len()).filter(|o| homes[*o] == *home).collect();
            if together.len() == 1 {
                counts[k] = sizes[*home as usize];
            } else if together[0] == k {
                self.share(&links, &labels, *home, &together, &mut counts);
            }
        }
        counts[..self.initial_m2.len()].iter().map(|n| f64::from(*n) * cell_m2).collect()
    }

    /// Floor that rooms have lost, m², ≥ 0; what others gain does not make up for it.
    pub fn lost_m2(&self, areas_m2: &[f64]) -> f64 {
        self.initial_m2.iter().zip(areas_m2).map(|(was, is)| (was - is).max(0.0)).sum()
    }

    /// Change of the room that has lost most of its area, and of the one that has gained most, as shares of
    /// what they had; 0 without rooms.
    pub fn extremes(&self, areas_m2: &[f64]) -> [f64; 2] {
        let shares = self.initial_m2.iter().zip(areas_m2).map(|(was, is)| is / was - 1.0);
        shares.fold([0.0, 0.0], |[lo, hi], s| [lo.min(s), hi.max(s)])
    }

    fn links(&self, now: &Layout<'_>) -> Vec<u8> {
        let mut links = self.fixed.clone();
        self.moving.iter().for_each(|&i| self.raster.cut(&mut links, now.pieces[i].ends()));
        for closing in &self.closings {
            self.raster.cut(&mut links, closing.map(|a| a.at(now)));
        }
        links
    }

    /// Deals one stretch of floor out to the rooms that have become one: each cell to the nearest middle,
    /// by steps.
    fn share(&self, links: &[u8], labels: &[u32], label: u32, rooms: &[usize], counts: &mut [u32]) {
        let mut owner = vec![NONE; labels.len()];
        let mut queue = VecDeque::new();
        for &k in rooms {
            for &i in self.cores[k].iter().filter(|i| labels[**i as usize] == label) {
                owner[i as usize] = k as u32;
                queue.push_back(i as usize);
            }
        }
        while let Some(i) = queue.pop_front() {
            counts[owner[i] as usize] += 1;
            self.raster.for_each_linked(links, i, |j| {
                if owner[j] == NONE {
                    owner[j] = owner[i];
                    queue.push_back(j);
                }
            });
        }
    }
}

/// The stretch of floor that holds most of a room's middle: what a wall has passed over counts no more.
fn home(core: &[u32], labels: &[u32]) -> u32 {
    let mut found: Vec<u32> = core.iter().map(|i| labels[*i as usize]).collect();
    found.sort_unstable();
    let runs = found.chunk_by(|a, b| a == b).map(|run| (run.len(), run[0]));
    runs.reduce(|a, b| if b.0 > a.0 { b } else { a }).map_or(NONE, |run| run.1)
}

impl Anchor {
    fn new(initial: &Layout<'_>, at: DVec2, reach_m: f64) -> Self {
        let ends = initial.pieces.iter().enumerate().flat_map(|(i, p)| [(i, false, p.a), (i, true, p.b)]);
        let nearest = ends.reduce(|x, y| if y.2.distance(at) < x.2.distance(at) { y } else { x });
        match nearest.filter(|n| n.2.distance(at) <= reach_m) {
            Some((i, is_b, end)) => Self { end: Some((i, is_b)), offset: at - end },
            None => Self { end: None, offset: at },
        }
    }

    fn at(&self, now: &Layout<'_>) -> DVec2 {
        let end = |(i, is_b): (usize, bool)| if is_b { now.pieces[i].b } else { now.pieces[i].a };
        self.end.map_or(DVec2::ZERO, end) + self.offset
    }
}

/// A square raster turned against the plan; cells are numbered row by row.
#[derive(Clone, Debug)]
struct Raster {
    /// Direction of its rows.
    axis: DVec2,
    /// Its first cell, in turned metres.
    origin: DVec2,
    pitch_m: f64,
    cols: usize,
    rows: usize,
}

impl Raster {
    fn over(points: impl Iterator<Item = DVec2>) -> Self {
        let axis = DVec2::new(1.0, TURN).normalize();
        let turned = points.map(|p| DVec2::new(axis.dot(p), axis.perp_dot(p)));
        let [lo, hi] = enfilade_cad::plane::box_of(turned).unwrap_or_default();
        let size = hi - lo;
        let pitch_m = (size.x * size.y / CELLS).sqrt().max(size.max_element() / CELLS).max(1e-3);
        let count = |length_m: f64| (length_m / pitch_m).ceil() as usize + 5;
        Self { axis, origin: lo - 2.0 * pitch_m, pitch_m, cols: count(size.x), rows: count(size.y) }
    }

    /// Cuts the links that a line crosses.
    fn cut(&self, links: &mut [u8], ends: [DVec2; 2]) {
        let turned =
            |p: DVec2| (DVec2::new(self.axis.dot(p), self.axis.perp_dot(p)) - self.origin) / self.pitch_m;
        let [a, b] = ends.map(turned);
        let mut mark = |col: f64, row: f64, link: u8| {
            if col >= 0.0 && row >= 0.0 && col < self.cols as f64 && row < self.rows as f64 {
                links[row as usize * self.cols + col as usize] |= link;
            }
        };
        let within = |x: f64, y: f64, most: usize| {
            let first = x.min(y).ceil().max(0.0) as usize;
            let last = x.max(y).floor().min(most as f64);
            first..if last < 0.0 { 0 } else { last as usize + 1 }
        };
        for col in within(a.x, b.x, self.cols) {
            let t = (col as f64 - a.x) / (b.x - a.x);
            if t.is_finite() {
                mark(col as f64, (a.y + t * (b.y - a.y)).floor(), UP);
            }
        }
        for row in within(a.y, b.y, self.rows) {
            let t = (row as f64 - a.y) / (b.y - a.y);
            if t.is_finite() {
                mark((a.x + t * (b.x - a.x)).floor(), row as f64, RIGHT);
            }
        }
    }

    fn for_each_linked(&self, links: &[u8], i: usize, mut visit: impl FnMut(usize)) {
        let col = i % self.cols;
        if col + 1 < self.cols && links[i] & RIGHT == 0 {
            visit(i + 1);
        }
        if i + self.cols < links.len() && links[i] & UP == 0 {
            visit(i + self.cols);
        }
        if col > 0 && links[i - 1] & RIGHT == 0 {
            visit(i - 1);
        }
        if i >= self.cols && links[i - self.cols] & UP == 0 {
            visit(i - self.cols);
        }
    }

    /// The stretches of floor that nothing parts: the number of each cell's, and how many cells each has.
    /// Number 0 is the outside.
    fn components(&self, links: &[u8]) -> (Vec<u32>, Vec<u32>) {
        let mut labels = vec![NONE; links.len()];
        let mut sizes = Vec::new();
        let mut stack = Vec::new();
        for start in 0..links.len() {
            if labels[start] != NONE {
                continue;
            }
            let label = sizes.len() as u32;
            labels[start] = label;
            stack.push(start);
            let mut size = 0;
            while let Some(i) = stack.pop() {
                size += 1;
                self.for_each_linked(links, i, |j| {
                    if labels[j] == NONE {
                        labels[j] = label;
                        stack.push(j);
                    }
                });
            }
            sizes.push(size);
        }
        (labels, sizes)
    }

    /// Steps from every cell to the nearest that a wall touches or that lies at the border.
    fn depths(&self, links: &[u8]) -> Vec<u32> {
        let mut depths = vec![NONE; links.len()];
        let mut queue = VecDeque::new();
        for (i, depth) in depths.iter_mut().enumerate() {
            let mut linked = 0;
            self.for_each_linked(links, i, |_| linked += 1);
            if linked < 4 {
                *depth = 0;
                queue.push_back(i);
            }
        }
        while let Some(i) = queue.pop_front() {
            self.for_each_linked(links, i, |j| {
                if depths[j] == NONE {
                    depths[j] = depths[i] + 1;
                    queue.push_back(j);
                }
            });
        }
        depths
    }
}

#[cfg(test)]
mod tests {
    use super::super::WallPiece;
    use super::*;

    fn wall(a: [f64; 2], b: [f64; 2], is_moving: bool) -> WallPiece {
        WallPiece {
            a: a.into(),
            b: b.into(),
            nodes: [0, 1],
            is_moving,
            solid: None,
            bar: None,
            body: None,
            half_m: 0.0,
        }
    }

    fn around([x, y, u, v]: [f64; 4]) -> Vec<WallPiece> {
        let corners = [[x, y], [u, y], [u, v], [x, v]];
        (0..4).map(|i| wall(corners[i], corners[(i + 1) % 4], false)).collect()
    }

    /// 10 × 6 m, parted at x = 4 by a wall whose upper end stands `off` further to the right.
    fn parted(x: f64, off: f64) -> Vec<WallPiece> {
        let mut all = around([0.0, 0.0, 10.0, 6.0]);
        all.push(wall([x, 0.0], [x + off, 6.0], true));
        all
    }

    fn areas(initial: &[WallPiece], now: &[WallPiece], closings: &[[DVec2; 2]]) -> (RoomArea, Vec<f64>) {
        let rooms = RoomArea::new(&Layout { pieces: initial }, closings, 1.0);
        let areas = rooms.areas_m2(&Layout { pieces: now });
        (rooms, areas)
    }

    #[test]
    fn a_wall_that_slides_takes_floor_evenly() {
        let drawn = parted(4.0, 0.0);
        for step in 0..=100 {
            let x = 4.0 - f64::from(step) * 0.02;
            let (rooms, now) = areas(&drawn, &parted(x, 0.0), &[]);
            assert_eq!(now.len(), 2);
            let lost = rooms.lost_m2(&now);
            assert!((lost - (4.0 - x) * 6.0).abs() < 0.1, "{x}: {lost}");
            let [least, most] = rooms.extremes(&now);
            assert!((least + (4.0 - x) / 4.0).abs() < 0.01 && (most - (4.0 - x) / 6.0).abs() < 0.01, "{x}");
        }
    }

    #[test]
    fn a_door_goes_with_its_wall() {
        let with_door = |x: f64| {
            let mut all = around([0.0, 0.0, 10.0, 6.0]);
            all.push(wall([x, 0.0], [x, 2.0], true));
            all.push(wall([x, 3.0], [x, 6.0], true));
            all
        };
        let door = [DVec2::new(4.0, 2.0), DVec2::new(4.0, 3.0)];
        let (rooms, now) = areas(&with_door(4.0), &with_door(3.0), &[door]);
        assert_eq!(rooms.initial_m2().len(), 2);
        let mut sorted = now.clone();
        sorted.sort_by(f64::total_cmp);
        assert!((sorted[0] - 18.0).abs() < 0.1 && (sorted[1] - 42.0).abs() < 0.1, "{now:?}");
    }

    #[test]
    fn a_gap_that_opens_makes_no_jump() {
        let drawn = parted(4.0, 0.0);
        let opened = |gap: f64| {
            let mut all = around([0.0, 0.0, 10.0, 6.0]);
            all.push(wall([4.0, 0.0], [4.0, 6.0 - gap], true));
            all
        };
        let mut last: Option<Vec<f64>> = None;
        for step in 0..=60 {
            let (rooms, now) = areas(&drawn, &opened(f64::from(step) * 0.1), &[]);
            assert!((now.iter().sum::<f64>() - 60.0).abs() < 0.5, "{now:?}");
            if let Some(last) = last {
                assert!((now[0] - last[0]).abs() < 0.8, "{step}: {last:?} {now:?}");
            }
            assert!(rooms.lost_m2(&now) < 4.0, "without its wall either keeps its own half: {now:?}");
            last = Some(now);
        }
    }

    #[test]
    fn a_room_that_opens_to_the_outside_keeps_about_its_own() {
        let house = |off: f64| {
            let mut all = around([0.0, 0.0, 10.0, 6.0]);
            all[1].is_moving = true;
            all[1].a.x += off;
            all[1].b.x += off;
            all.extend(around([-5.0, -5.0, -4.0, 11.0]));
            all
        };
        let (rooms, now) = areas(&house(0.0), &house(0.3), &[]);
        let drawn = rooms.initial_m2()[0].max(*rooms.initial_m2().last().unwrap());
        assert!((drawn - 60.0).abs() < 0.3);
        assert!(now.iter().any(|a| (a - 60.0).abs() < 4.0), "{now:?}");
    }

    #[test]
    fn the_inside_of_a_wall_is_no_room() {
        let mut all = around([0.0, 0.0, 10.0, 6.0]);
        all.extend(around([4.0, 0.0, 4.3, 6.0]));
        let (rooms, _) = areas(&all, &all, &[]);
        assert_eq!(rooms.initial_m2().len(), 2);
        assert_eq!(areas(&[], &[], &[]).1, Vec::<f64>::new());
    }
}
