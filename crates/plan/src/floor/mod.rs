//! The measured floor, room by room: what doors, windows and walls part, and what is left out of it.
//!
//! Read off the raster of the [`Interior`], with every opening closed over the thickness of its wall; outlines are put
//! back onto the drawn lines.

mod contour;
mod names;

use enfilade_cad::plane::ring_area;
use glam::DVec2;

use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use enfilade_engine::interior::Interior;
pub use names::{name_in, name_of_rooms, texts_in_rooms};

/// What is smaller than this is no room, m² of a person; or nowhere farther than this from what bounds it, metres.
const ROOM_MIN_M2: f64 = 0.4;
const ROOM_HALF_WIDTH_M: f64 = 0.2;

/// Floor left out in one piece is worth a word from this size on, m² of a person.
const LEFT_OUT_MIN_M2: f64 = 1.5;

/// How far beside an opening the rooms are looked for that it joins, metres of a person.
const BESIDE_M: f64 = 0.6;

/// Where an opening is, as far as rooms are concerned; drawing frame, micrometres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Its jambs, on the axis of its wall.
    pub jambs: [PointUm; 2],
    /// Thickness of its wall, micrometres.
    pub thickness_um: f64,
}

/// What lies on one side of an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beside {
    /// A room, by its index.
    Room(usize),
    /// The outside.
    Outside,
    /// Neither: masonry, or floor that is no room.
    Nothing,
}

/// An outline with holes, drawing frame, micrometres; the outline anticlockwise, holes clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Area {
    /// Outline.
    pub outline: Vec<PointUm>,
    /// What is cut out of it: columns, courtyards.
    pub holes: Vec<Vec<PointUm>>,
    /// Area without holes, m² of the plan.
    pub area_m2: f64,
    /// A point well inside.
    pub at: PointUm,
}

/// The floor of a plan. See the module page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Floor {
    /// The rooms, from left to right in rows from the top.
    pub rooms: Vec<Area>,
    /// What every opening joins: its left and its right side, seen from its first to its second jamb.
    pub beside: Vec<[Beside; 2]>,
    /// Floor inside the building's outline that is left out, the largest part first.
    pub left_out: Vec<Area>,
    /// Share of the floor inside the building's outline that is measured, 0 to 1.
    pub coverage: f64,
}

impl Floor {
    /// Finds it. `walls`: everything that bounds floor, closings of openings too; lengths that mean a person's shrink
    /// with `human_scale`.
    pub fn new(interior: &Interior, walls: &[Segment], gaps: &[Gap], human_scale: f64) -> Self {
        let grid = Grid {
            interior,
            pixel_m: interior.pixel_um() as f64 / UM_PER_M,
            rows: interior.rows(),
            human_scale,
        };
        let quads: Vec<Option<[DVec2; 4]>> = gaps.iter().map(|g| grid.quad(g)).collect();
        let faces = quads.iter().flatten().flat_map(|[a, b, c, d]| [[*a, *b], [*c, *d]]);
        let lines: Vec<[DVec2; 2]> =
            walls.iter().map(|s| [grid.px(s.a), grid.px(s.b)]).chain(faces).collect();
        let mut line = vec![0; interior.len()];
        lines.iter().enumerate().for_each(|(k, l)| grid.draw(*l, k as u32 + 1, &mut line));
        let mut is_bound: Vec<bool> = (0..line.len()).map(|i| line[i] > 0 || interior.is_wall(i)).collect();
        quads.iter().flatten().for_each(|quad| grid.fill(quad, &mut is_bound));
        let is_floor: Vec<bool> = (0..line.len()).map(|i| !is_bound[i] && interior.is_floor(i)).collect();
        let is_left: Vec<bool> = (0..line.len()).map(|i| !is_bound[i] && interior.is_left_out(i)).collect();
        let (part, found) = grid.parts(&is_floor);
        let (rooms, room_of) = grid.rooms(&part, &found, ROOM_MIN_M2, (&line, &lines));
        let (part_left, left) = grid.parts(&is_left);
        let (mut left_out, _) = grid.rooms(&part_left, &left, LEFT_OUT_MIN_M2, (&line, &lines));
        left_out.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
        let sum = |areas: &[Area]| areas.iter().map(|a| a.area_m2).sum::<f64>();
        let (measured, all) = (sum(&rooms), sum(&rooms) + sum(&left_out));
        let beside = gaps.iter().map(|g| grid.beside(g, &part, &room_of)).collect();
        Self { rooms, beside, left_out, coverage: if all > 0.0 { measured / all + 0.0 } else { 0.0 } }
    }
}

struct Grid<'a> {
    interior: &'a Interior,
    pixel_m: f64,
    rows: usize,
    human_scale: f64,
}

/// A part of the raster.
struct Part {
    area_m2: f64,
    /// The pixel farthest from its edge, and how far that is.
    deepest: DVec2,
    reach_m: f64,
}

impl Grid<'_> {
    fn px(&self, p: PointUm) -> DVec2 {
        let [o, size] = [self.interior.origin_um(), [self.interior.pixel_um(); 2]];
        DVec2::new((p[0] - o[0]) as f64 / size[0] as f64, (p[1] - o[1]) as f64 / size[1] as f64)
    }

    fn um(&self, p: DVec2) -> PointUm {
        let o = self.interior.origin_um();
        [0, 1].map(|k| o[k] + (p[k] * self.interior.pixel_um() as f64).round() as i64)
    }

    fn index(&self, p: DVec2) -> Option<usize> {
        let cols = self.interior.len() / self.rows.max(1);
        let is_in = p.cmpge(DVec2::ZERO).all() && p.x < cols as f64 && p.y < self.rows as f64;
        is_in.then(|| p.x as usize * self.rows + p.y as usize)
    }

    fn draw(&self, [a, b]: [DVec2; 2], mark: u32, out: &mut [u32]) {
        let steps = ((b - a).abs().max_element() * 2.0).ceil().max(1.0) as usize;
        for k in 0..=steps {
            if let Some(i) = self.index(a.lerp(b, k as f64 / steps as f64)) {
                out[i] = mark;
            }
        }
    }

    /// The ground of an opening between the faces of its wall, pixels; `None` in a single line.
    fn quad(&self, gap: &Gap) -> Option<[DVec2; 4]> {
        let [a, b] = gap.jambs.map(|p| self.px(p));
        let across =
            (b - a).normalize_or_zero().perp() * gap.thickness_um / self.interior.pixel_um() as f64 / 2.0;
        (across.length() > 0.5).then(|| [a + across, b + across, b - across, a - across])
    }

    fn fill(&self, quad: &[DVec2; 4], out: &mut [bool]) {
        let Some([lo, hi]) = enfilade_cad::plane::box_of(quad.iter().copied()) else { return };
        let (mut x, end) = (lo.floor().x, hi.ceil());
        while x <= end.x {
            let mut y = lo.floor().y;
            while y <= end.y {
                let middle = DVec2::new(x + 0.5, y + 0.5);
                if let Some(i) =
                    self.index(middle).filter(|_| enfilade_cad::plane::is_inside_ring(quad, middle))
                {
                    out[i] = true;
                }
                y += 1.0;
            }
            x += 1.0;
        }
    }

    /// Connected parts of what is marked: the part of every pixel (0: none, else its index + 1), and the parts.
    fn parts(&self, marked: &[bool]) -> (Vec<u32>, Vec<Part>) {
        if !marked.contains(&true) {
            return (vec![0; marked.len()], Vec::new());
        }
        let outside: Vec<bool> = marked.iter().map(|m| !m).collect();
        let depth = self.interior.distance_px(&outside);
        let (mut part, mut found) = (vec![0; marked.len()], Vec::new());
        for start in (0..marked.len()).filter(|i| marked[*i]) {
            if part[start] > 0 {
                continue;
            }
            let (mut stack, mut count, mut deepest) = (vec![start], 0_usize, start);
            part[start] = found.len() as u32 + 1;
            while let Some(i) = stack.pop() {
                count += 1;
                deepest = if depth[i] > depth[deepest] { i } else { deepest };
                for j in self.interior.beside(i) {
                    if marked[j] && part[j] == 0 {
                        part[j] = part[start];
                        stack.push(j);
                    }
                }
            }
            let middle = DVec2::new((deepest / self.rows) as f64 + 0.5, (deepest % self.rows) as f64 + 0.5);
            found.push(Part {
                area_m2: count as f64 * self.pixel_m.powi(2),
                deepest: middle,
                reach_m: f64::from(depth[deepest]) * self.pixel_m,
            });
        }
        (part, found)
    }

    /// The parts that are rooms, in reading order, and for each part which room it is.
    fn rooms(
        &self,
        part: &[u32],
        found: &[Part],
        least_m2: f64,
        (line, lines): (&[u32], &[[DVec2; 2]]),
    ) -> (Vec<Area>, Vec<Option<usize>>) {
        let traced = contour::Traced { rows: self.rows, part, line, lines };
        let is_room = |p: &Part| {
            p.area_m2 >= least_m2 * self.human_scale.powi(2)
                && p.reach_m >= ROOM_HALF_WIDTH_M * self.human_scale
        };
        let outlines = contour::outlines(&traced, found.len()).into_iter().enumerate();
        let mut rooms: Vec<(usize, Area)> = outlines
            .filter(|(k, _)| is_room(&found[*k]))
            .map(|(k, rings)| (k, self.area(rings, &found[k])))
            .collect();
        let place = |a: &Area| {
            let top = a.outline.iter().map(|p| p[1]).max().unwrap_or(0);
            (-(top as f64 / UM_PER_M / self.human_scale).round() as i64, a.outline.iter().map(|p| p[0]).min())
        };
        rooms.sort_by_key(|(k, a)| (place(a), *k));
        let mut room_of = vec![None; found.len()];
        rooms.iter().enumerate().for_each(|(room, (k, _))| room_of[*k] = Some(room));
        (rooms.into_iter().map(|r| r.1).collect(), room_of)
    }

    fn area(&self, mut rings: contour::Rings, part: &Part) -> Area {
        let px_m2 = self.pixel_m.powi(2);
        let outer = (0..rings.len()).max_by(|i, j| ring_area(&rings[*i]).total_cmp(&ring_area(&rings[*j])));
        let outline = outer.map(|k| rings.swap_remove(k)).unwrap_or_default();
        rings.retain(|r| ring_area(r) < 0.0);
        let area = ring_area(&outline) + rings.iter().map(|r| ring_area(r)).sum::<f64>();
        let um = |ring: &Vec<DVec2>| ring.iter().map(|p| self.um(*p)).collect::<Vec<_>>();
        let holes = rings.iter().map(um).collect();
        Area { outline: um(&outline), holes, area_m2: area.max(0.0) * px_m2, at: self.um(part.deepest) }
    }

    fn beside(&self, gap: &Gap, part: &[u32], room_of: &[Option<usize>]) -> [Beside; 2] {
        let [a, b] = gap.jambs.map(|p| self.px(p));
        let across = (b - a).normalize_or_zero().perp();
        let from = gap.thickness_um / self.interior.pixel_um() as f64 / 2.0;
        let reach = from + BESIDE_M * self.human_scale / self.pixel_m;
        let look = |side: f64, share: f64| {
            let middle = a.lerp(b, share);
            let mut off = from;
            while off <= reach {
                let Some(i) = self.index(middle + across * side * off) else { return Beside::Outside };
                match part[i].checked_sub(1).map(|k| room_of[k as usize]) {
                    Some(Some(room)) => return Beside::Room(room),
                    None if self.interior.is_outside(i) => return Beside::Outside,
                    _ => {}
                }
                off += 0.5;
            }
            Beside::Nothing
        };
        [1.0, -1.0].map(|side| {
            let seen = [0.5, 0.25, 0.75].map(|share| look(side, share));
            seen.into_iter().find(|s| *s != Beside::Nothing).unwrap_or(Beside::Nothing)
        })
    }
}
