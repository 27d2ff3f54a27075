//! A drawing as the classifier looks at it: straight pieces and arcs in metres of one hypothesis of the unit, turned so
//! that most of them run along x or y, with an index by place.

use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

use glam::DVec2;

use super::section;
use crate::hidden::Hidden;
use enfilade_cad::curve::bulge_arc;
use enfilade_cad::drawing::{Drawing, Entity, Pen, Shape};
use enfilade_cad::own_layers;
use enfilade_cad::roles::{Role, role_by_name};

/// Drawings larger than so many cells along a side are looked at in larger ones.
const CELLS_MAX: f64 = 1024.0;

/// Side of a cell, metres: thicker than walls are, so that both faces lie in neighbouring cells.
pub const CELL_M: f64 = 0.7;

/// Most pieces of one cell that are looked at; keeps hatches linear.
const IN_CELL_MAX: usize = 48;

/// No index.
pub const NONE: u32 = u32::MAX;

/// An arc, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    pub centre: DVec2,
    pub radius: f64,
    pub sweep_rad: f64,
}

/// A straight piece or an arc of one entity, metres.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub thing: u32,
    pub a: DVec2,
    pub b: DVec2,
    pub length: f64,
    pub arc: Option<Arc>,
    along: DVec2,
}

impl Piece {
    /// Its direction; zero of a circle.
    pub fn along(&self) -> DVec2 {
        self.along
    }

    pub fn middle(&self) -> DVec2 {
        self.a.midpoint(self.b)
    }
}

/// An entity that is shown.
#[derive(Clone, Debug)]
pub struct Thing {
    /// Index in [`Drawing::entities`].
    pub entity: u32,
    pub pieces: Range<u32>,
    pub is_closed: bool,
    pub is_circle: bool,
    pub extent: [DVec2; 2],
    pub length: f64,
    /// Area of a closed one, m².
    pub area: f64,
    /// The arc that a row of chords traces, or that it is.
    pub arc: Option<Arc>,
    /// Layer, pen and whether it is shown by a block: lines drawn alike.
    pub group: u32,
    pub layer: u32,
    /// Which INSERT of model space shows it, counted from 0; [`NONE`] where none does.
    pub block: u32,
    pub depth: u32,
}

/// An INSERT of model space, or entities of one layer: what hangs together for another reason than its place.
#[derive(Clone, Debug, Default)]
pub struct Family {
    pub things: u32,
    pub pieces: u32,
    pub arcs: u32,
    pub length: f64,
    pub extent: Option<[DVec2; 2]>,
    /// INSERTs that show the same block.
    pub copies: u32,
    /// What its name says.
    pub role: Option<Role>,
    /// Texts and filled areas on a layer.
    pub texts: u32,
    pub fills: u32,
}

/// A drawing to be classified. See the module page.
pub struct Scene {
    pub things: Vec<Thing>,
    pub pieces: Vec<Piece>,
    pub groups: Vec<Family>,
    pub layers: Vec<Family>,
    pub blocks: Vec<Family>,
    pub extent: [DVec2; 2],
    pub length: f64,
    /// Texts: where, and whether they begin with a digit.
    pub texts: Vec<(DVec2, bool)>,
    /// Filled areas, corners.
    pub fills: Vec<Vec<DVec2>>,
    grid: Grid,
}

struct Grid {
    origin: DVec2,
    cell: f64,
    cols: usize,
    rows: usize,
    starts: Vec<u32>,
    pieces: Vec<u32>,
}

/// Turns drawing units to metres of the scene.
#[derive(Clone, Copy)]
struct Place {
    origin: DVec2,
    along: DVec2,
    metres: f64,
}

impl Place {
    fn of(&self, p: DVec2) -> DVec2 {
        let d = (p - self.origin) * self.metres;
        DVec2::new(d.dot(self.along), d.dot(self.along.perp()))
    }
}

impl Scene {
    /// `metres`: those of a drawing unit. `None` where nothing is drawn.
    pub fn new(drawing: &Drawing, metres: f64) -> Option<Self> {
        let (hidden, below) = (Hidden::new(drawing), section::seen_below(drawing));
        let is_shown = |(i, e): &(usize, &Entity)| {
            !own_layers::is_own(&e.layer) && !hidden.entity(e) && below.binary_search(i).is_err()
        };
        let shown: Vec<(u32, &Entity)> =
            drawing.entities.iter().enumerate().filter(is_shown).map(|(i, e)| (i as u32, e)).collect();
        let place = Place { origin: first_point(&shown)?, along: main_direction(&shown), metres };
        let mut out = Self {
            things: Vec::with_capacity(shown.len()),
            pieces: Vec::new(),
            groups: Vec::new(),
            layers: Vec::new(),
            blocks: Vec::new(),
            extent: [DVec2::ZERO; 2],
            length: 0.0,
            texts: Vec::new(),
            fills: Vec::new(),
            grid: Grid {
                origin: DVec2::ZERO,
                cell: 1.0,
                cols: 0,
                rows: 0,
                starts: vec![0],
                pieces: Vec::new(),
            },
        };
        let layers = out.add_things(&shown, &place);
        out.extent = bounds(out.things.iter().flat_map(|t| t.extent))?;
        out.length = out.pieces.iter().map(|p| p.length).sum();
        out.texts = drawing
            .texts
            .iter()
            .map(|t| (place.of(t.at), t.text.trim_start().starts_with(|c: char| c.is_ascii_digit())))
            .collect();
        for t in &drawing.texts {
            if let Some(l) = layers.get(t.layer.as_str()) {
                out.layers[*l as usize].texts += 1;
            }
        }
        for fill in &drawing.fills {
            if let Some(l) = layers.get(fill.layer.as_str()) {
                out.layers[*l as usize].fills += 1;
            }
            if let Shape::Polyline { vertices, .. } = &fill.shape {
                out.fills.push(vertices.iter().map(|v| place.of(v.at)).collect());
            }
        }
        out.grid = Grid::new(&out.pieces, out.extent);
        Some(out)
    }

    /// The pieces of things, their families; layers by name.
    fn add_things<'e>(&mut self, shown: &[(u32, &'e Entity)], place: &Place) -> HashMap<&'e str, u32> {
        let mut layers: HashMap<&str, u32> = HashMap::new();
        let mut groups: BTreeMap<(u32, Pen, bool), u32> = BTreeMap::new();
        let mut blocks: HashMap<usize, u32> = HashMap::new();
        let mut copies: HashMap<&str, Vec<u32>> = HashMap::new();
        for (entity, e) in shown {
            let first = self.pieces.len() as u32;
            let thing = self.things.len() as u32;
            let is_closed = self.add_pieces(&e.shape, thing, place);
            let pieces = first..self.pieces.len() as u32;
            let own = &self.pieces[first as usize..];
            let Some(extent) = bounds(own.iter().flat_map(ends_of_box)) else { continue };
            let layer = *layers.entry(&e.layer).or_insert_with(|| {
                let role = role_by_name(&e.layer).0;
                self.layers.push(Family { role: Some(role), ..Family::default() });
                self.layers.len() as u32 - 1
            });
            let next = self.groups.len() as u32;
            let group = *groups.entry((layer, e.origin.pen, !e.blocks.is_empty())).or_insert(next);
            if group == next {
                self.groups.push(Family::default());
            }
            let block = match e.blocks.first() {
                None => NONE,
                Some(name) => *blocks.entry(top_record(e)).or_insert_with(|| {
                    self.blocks.push(Family::default());
                    let block = self.blocks.len() as u32 - 1;
                    copies.entry(name).or_default().push(block);
                    block
                }),
            };
            if block != NONE {
                let of_names = e.blocks.iter().map(|b| role_by_name(b).0).find(|r| *r != Role::Unknown);
                let family = &mut self.blocks[block as usize];
                family.role = family.role.or(of_names);
            }
            let length = own.iter().map(|p| p.length).sum();
            let arc = match own {
                [only] => only.arc,
                many if many.iter().any(|p| p.arc.is_some()) => None,
                [first, ..] => {
                    let corners: Vec<DVec2> = [first.a].into_iter().chain(own.iter().map(|p| p.b)).collect();
                    chord_arc(&corners, is_closed)
                }
                [] => None,
            };
            let area = if is_closed { ring_area(own) } else { 0.0 };
            let is_circle = matches!(e.shape, Shape::Circle { .. });
            let depth = e.blocks.len() as u32;
            let arcs = own.iter().filter(|p| p.arc.is_some()).count() as u32;
            let mut families = vec![&mut self.layers[layer as usize], &mut self.groups[group as usize]];
            families.extend(self.blocks.get_mut(block as usize));
            for family in families {
                family.things += 1;
                family.pieces += pieces.end - pieces.start;
                family.arcs += arcs;
                family.length += length;
                family.extent = bounds(family.extent.into_iter().flatten().chain(extent));
            }
            self.things.push(Thing {
                entity: *entity,
                pieces,
                is_closed,
                is_circle,
                extent,
                length,
                area,
                arc,
                group,
                layer,
                block,
                depth,
            });
        }
        for same in copies.into_values() {
            for block in &same {
                self.blocks[*block as usize].copies = same.len() as u32;
            }
        }
        layers
    }

    /// Adds the pieces of a shape; whether it is closed.
    fn add_pieces(&mut self, shape: &Shape, thing: u32, place: &Place) -> bool {
        let mut push = |a: DVec2, b: DVec2, arc: Option<Arc>| {
            let length = arc.map_or_else(|| a.distance(b), |arc| arc.radius * arc.sweep_rad);
            if length > 0.0 && length.is_finite() {
                self.pieces.push(Piece { thing, a, b, length, arc, along: (b - a).normalize_or_zero() });
            }
        };
        match shape {
            Shape::Line { a, b } => push(place.of(*a), place.of(*b), None),
            Shape::Polyline { vertices, closed } => {
                let n = vertices.len();
                let last = if *closed && n > 1 { n } else { n.saturating_sub(1) };
                for i in 0..last {
                    let (from, to) = (vertices[i], vertices[(i + 1) % n]);
                    let [a, b] = [from.at, to.at].map(|p| place.of(p));
                    match bulge_arc(from.at, to.at, from.bulge) {
                        None => push(a, b, None),
                        Some((centre, radius, _, sweep)) => {
                            let (centre, radius) = (place.of(centre), radius * place.metres);
                            let [a, b] = if sweep < 0.0 { [b, a] } else { [a, b] };
                            push(a, b, Some(Arc { centre, radius, sweep_rad: sweep.abs() }));
                        }
                    }
                }
                let ends = vertices.first().zip(vertices.last());
                return n > 2
                    && (*closed || ends.is_some_and(|(p, q)| p.at.distance(q.at) * place.metres < 0.001));
            }
            Shape::Arc { centre, radius, start_rad, end_rad } => {
                let sweep_rad = enfilade_cad::curve::sweep_rad(*start_rad, *end_rad);
                let at = |t: f64| place.of(*centre + DVec2::from_angle(t) * *radius);
                let arc = Arc { centre: place.of(*centre), radius: radius * place.metres, sweep_rad };
                push(at(*start_rad), at(*end_rad), Some(arc));
            }
            Shape::Circle { centre, radius } => {
                let arc = Arc {
                    centre: place.of(*centre),
                    radius: radius * place.metres,
                    sweep_rad: std::f64::consts::TAU,
                };
                let a = arc.centre + DVec2::X * arc.radius;
                push(a, a, Some(arc));
                return true;
            }
        }
        false
    }

    /// Calls with the pieces in the cells round a point, at most [`IN_CELL_MAX`] a cell, some twice.
    pub fn around(&self, p: DVec2, mut call: impl FnMut(u32)) {
        let g = &self.grid;
        let [c, r] = g.cell_of(p);
        for c in c.saturating_sub(1)..(c + 2).min(g.cols) {
            for r in r.saturating_sub(1)..(r + 2).min(g.rows) {
                g.in_cell(c, r).iter().for_each(|i| call(*i));
            }
        }
    }

    /// Calls with the pieces in the cell of a point.
    pub fn at(&self, p: DVec2, mut call: impl FnMut(u32)) {
        let [c, r] = self.grid.cell_of(p);
        self.grid.in_cell(c, r).iter().for_each(|i| call(*i));
    }

    /// Side of a cell of the index, metres.
    pub fn cell(&self) -> f64 {
        self.grid.cell
    }
}

/// The record that model space has of it.
fn top_record(e: &Entity) -> usize {
    e.source.record
}

fn ends_of_box(p: &Piece) -> [DVec2; 2] {
    match p.arc {
        Some(arc) if p.a == p.b => [arc.centre - arc.radius, arc.centre + arc.radius],
        _ => [p.a, p.b],
    }
}

/// The box round points.
pub fn bounds(points: impl IntoIterator<Item = DVec2>) -> Option<[DVec2; 2]> {
    points
        .into_iter()
        .fold(None, |b: Option<[DVec2; 2]>, p| Some(b.map_or([p, p], |[lo, hi]| [lo.min(p), hi.max(p)])))
}

fn first_point(shown: &[(u32, &Entity)]) -> Option<DVec2> {
    shown.iter().find_map(|(_, e)| enfilade_cad::curve::control_points(&e.shape).first().copied())
}

/// Directions are counted in steps of so many to a quarter turn.
const DIRECTIONS: usize = 90;

/// The direction along or across which most is drawn, by length.
fn main_direction(shown: &[(u32, &Entity)]) -> DVec2 {
    let mut sums = [0.0; DIRECTIONS];
    let mut best: [(f64, DVec2); DIRECTIONS] = [(0.0, DVec2::X); DIRECTIONS];
    let mut add = |a: DVec2, b: DVec2| {
        let d = b - a;
        // Into the first quarter.
        let d = match (d.x > 0.0, d.y >= 0.0) {
            (true, true) => d,
            (false, true) => DVec2::new(d.y, -d.x),
            (false, false) => -d,
            (true, false) => DVec2::new(-d.y, d.x),
        };
        let length = d.length();
        let angle = d.y.atan2(d.x).to_degrees();
        if length > 0.0 && angle.is_finite() {
            let k = (angle.round() as usize) % DIRECTIONS;
            sums[k] += length;
            if length > best[k].0 {
                best[k] = (length, if angle > 89.5 { DVec2::new(d.y, -d.x) } else { d } / length);
            }
        }
    };
    for (_, e) in shown {
        match &e.shape {
            Shape::Line { a, b } => add(*a, *b),
            Shape::Polyline { vertices, .. } => vertices.windows(2).for_each(|w| add(w[0].at, w[1].at)),
            _ => {}
        }
    }
    let most = (0..DIRECTIONS).max_by(|i, j| sums[*i].total_cmp(&sums[*j]).then(j.cmp(i))).unwrap_or(0);
    best[most].1
}

/// Fewest chords that are an arc.
const CHORDS_MIN: usize = 5;

/// The arc that the chords of a line trace through its corners, a leaf at either end left aside.
pub fn chord_arc(corners: &[DVec2], is_closed: bool) -> Option<Arc> {
    let lengths: Vec<f64> = corners.windows(2).map(|w| w[0].distance(w[1])).collect();
    let (n, long) = (lengths.len(), |k: usize, chord: usize| lengths[k] > 3.0 * lengths[chord]);
    let chords = match n {
        // A sector: two radii and the arc between them.
        _ if is_closed && n >= CHORDS_MIN + 2 && long(0, 1) && long(n - 1, 1) => 1..n - 1,
        _ if n > CHORDS_MIN && long(0, 1) => 1..n,
        _ if n > CHORDS_MIN && long(n - 1, 0) => 0..n - 1,
        _ if n >= CHORDS_MIN => 0..n,
        _ => return None,
    };
    let on = &corners[chords.start..=chords.end];
    let (a, m, b) = (on[0], on[chords.len() / 2], on[chords.len() - 1]);
    let (u, v) = (m - a, b - a);
    let cross = 2.0 * u.perp_dot(v);
    if cross == 0.0 {
        return None;
    }
    let (uu, vv) = (u.length_squared(), v.length_squared());
    let centre = a + DVec2::new(v.y * uu - u.y * vv, u.x * vv - v.x * uu) / cross;
    let radius = a.distance(centre);
    let sweep_rad = lengths[chords].iter().sum::<f64>() / radius;
    let is_on = |p: &DVec2| (p.distance(centre) - radius).abs() <= 0.02 * radius;
    (radius.is_finite() && sweep_rad < 6.0 && on.iter().all(is_on)).then_some(Arc {
        centre,
        radius,
        sweep_rad,
    })
}

fn ring_area(pieces: &[Piece]) -> f64 {
    if let [Piece { arc: Some(arc), .. }] = pieces {
        return std::f64::consts::PI * arc.radius * arc.radius;
    }
    let origin = pieces[0].a;
    pieces.iter().map(|p| (p.a - origin).perp_dot(p.b - origin)).sum::<f64>().abs() / 2.0
}

impl Grid {
    fn new(pieces: &[Piece], [lo, hi]: [DVec2; 2]) -> Self {
        let size = hi - lo;
        let cell = CELL_M.max(size.max_element() / CELLS_MAX);
        let count = |s: f64| (s / cell) as usize + 1;
        let mut grid = Self {
            origin: lo,
            cell,
            cols: count(size.x),
            rows: count(size.y),
            starts: Vec::new(),
            pieces: Vec::new(),
        };
        // What nobody looks at is not kept: lines across all of a large drawing lie in a thousand cells each.
        let mut held = vec![(NONE, 0); grid.cols * grid.rows];
        let mut cells: Vec<(u32, u32)> = Vec::new();
        for (i, p) in pieces.iter().enumerate() {
            let steps = (p.length / (cell * 0.5)).ceil().max(1.0) as usize;
            let (from, sweep) = match p.arc {
                Some(arc) => (p.a - arc.centre, arc.sweep_rad),
                None => (DVec2::ZERO, 0.0),
            };
            for k in 0..=steps {
                let t = k as f64 / steps as f64;
                let at = match p.arc {
                    None => p.a.lerp(p.b, t),
                    Some(arc) => arc.centre + DVec2::from_angle(sweep * t).rotate(from),
                };
                let [c, r] = grid.cell_of(at);
                let cell = c * grid.rows + r;
                let (last, count) = &mut held[cell];
                if *last != i as u32 && *count < IN_CELL_MAX {
                    (*last, *count) = (i as u32, *count + 1);
                    cells.push((cell as u32, i as u32));
                }
            }
        }
        cells.sort_unstable();
        grid.starts = vec![0; grid.cols * grid.rows + 1];
        for (cell, _) in &cells {
            grid.starts[*cell as usize + 1] += 1;
        }
        for i in 1..grid.starts.len() {
            grid.starts[i] += grid.starts[i - 1];
        }
        grid.pieces = cells.into_iter().map(|c| c.1).collect();
        grid
    }

    fn cell_of(&self, p: DVec2) -> [usize; 2] {
        let k = |v: f64, n: usize| ((v / self.cell).max(0.0) as usize).min(n.saturating_sub(1));
        let d = p - self.origin;
        [k(d.x, self.cols), k(d.y, self.rows)]
    }

    fn in_cell(&self, c: usize, r: usize) -> &[u32] {
        let i = c * self.rows + r;
        &self.pieces[self.starts[i] as usize..self.starts[i + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines across all of a large drawing, drawn over one another, took a gigabyte that nobody looked at.
    #[test]
    fn no_cell_keeps_more_than_is_looked_at() {
        let piece = |i: u32| {
            let (a, b) = (DVec2::new(0.0, f64::from(i % 7)), DVec2::new(500.0, f64::from(i % 5)));
            Piece { thing: i, a, b, length: a.distance(b), arc: None, along: DVec2::X }
        };
        let pieces: Vec<Piece> = (0..2000).map(piece).collect();
        let grid = Grid::new(&pieces, [DVec2::ZERO, DVec2::new(500.0, 7.0)]);
        assert!(grid.pieces.len() <= grid.cols * grid.rows * IN_CELL_MAX);
        let first = grid.in_cell(0, 0);
        assert!(first.len() == IN_CELL_MAX && first.is_sorted_by(|a, b| a < b), "{first:?}");
        assert_eq!(first.last(), Some(&((IN_CELL_MAX as u32 - 1) * 7)), "the first that lie there");
    }
}
