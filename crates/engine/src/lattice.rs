//! Stage "lattice": which cells take part (spec 3).
//!
//! Cells that touch or lie inside something that cannot move are dropped once; where no region is
//! drawn the region is the interior of the building, or what a flood from seed points reaches.

mod seeds;

use std::collections::HashSet;
use std::ops::Range;

use super::Lattice;
use crate::Region;
use crate::geometry::{PointUm, Segment, Side, segments_touch, side_of_ring};
use crate::interior::Interior;
use enfilade_report::{Error, Place, Report, counted};

/// Most cells of the lattice's box; more means a spacing far too small for the drawing.
pub const CELLS_MAX: usize = 40_000_000;

/// Most vertices of one study.
pub const VERTICES_MAX: usize = 4_000_000;

/// What the lattice is made from. Coordinates: drawing frame, micrometres.
#[derive(Clone, Debug)]
pub struct Ground<'a> {
    /// File name for places.
    pub file: &'a str,
    /// Distance of cell centres, > 0.
    pub spacing_um: i64,
    /// A cell centre.
    pub centre_um: PointUm,
    /// Region of query, empty if none is drawn.
    pub query: &'a [Region],
    /// Region of reference, empty if none is drawn.
    pub reference: &'a [Region],
    /// Where a flood starts instead of the interior.
    pub seeds_um: &'a [PointUm],
    /// Whether a flood starts from the cell that holds its seed, whatever is drawn between them, as depthmapX does.
    pub seeds_by_cell: bool,
    /// What the user calls each seed: its coordinates as they were typed.
    pub seed_names: &'a [String],
    /// Sight-blocking pieces that cannot move.
    pub fixed: &'a [Segment],
    /// Sight-blocking pieces that can move, where they stand now.
    pub movable: &'a [Segment],
    /// Solid outlines that cannot move.
    pub fixed_solids: &'a [Vec<PointUm>],
    /// The building's interior where no region is drawn and no seed given.
    pub interior: Option<&'a Interior>,
    /// Where the interior is the region: a sealed spot at most this large across is solid, a pier or a shaft.
    pub solid_across_um: i64,
}

/// Chooses the cells.
///
/// # Errors
/// [`Error::Input`] when a limit is passed or no cell is left in either region.
pub fn lattice(ground: &Ground<'_>, report: &mut Report) -> Result<Lattice, Error> {
    let needs_inside = ground.query.is_empty() || ground.reference.is_empty();
    // Under walls that may move there are cells; they are no room.
    if needs_inside && ground.seeds_um.is_empty() && ground.interior.is_some_and(|i| !i.has_room()) {
        let text = "the walls enclose no room, and no region says where people stand; nothing was measured; draw \
                    EF-QUERY and EF-REFERENCE, or write [[region]] tables in the side-car";
        return Err(Error::input("no-room", Place::file(ground.file), text));
    }
    let field = Field::new(ground)?;
    let mut inside = if needs_inside { field.inside(ground, report)? } else { Vec::new() };
    if ground.interior.is_some() && ground.seeds_um.is_empty() {
        field.fill_sealed_spots(ground, &mut inside, report);
    }
    let in_regions = |regions: &[Region], i: usize, p: PointUm| {
        if regions.is_empty() { inside[i] } else { regions.iter().any(|r| r.contains(p)) }
    };
    let mut out = Lattice {
        spacing_um: ground.spacing_um,
        origin_um: ground.centre_um,
        cells: Vec::new(),
        query: Vec::new(),
        is_reference: Vec::new(),
        beyond: None,
    };
    let dropped = field.dropped(ground);
    for col in 0..field.cols {
        for row in 0..field.rows {
            let i = field.index(col, row);
            let p = field.centre(col, row);
            if dropped[i] {
                continue;
            }
            let (q, r) = (in_regions(ground.query, i, p), in_regions(ground.reference, i, p));
            if !(q || r) {
                continue;
            }
            if q {
                out.query.push(out.cells.len() as u32);
            }
            out.cells.push([field.first[0] + col as i32, field.first[1] + row as i32]);
            out.is_reference.push(r);
        }
    }
    check(&out, ground)?;
    Ok(out)
}

fn check(lattice: &Lattice, ground: &Ground<'_>) -> Result<(), Error> {
    let spacing_m = ground.spacing_um as f64 / 1e6;
    let fail = |code, text: String| Err(Error::input(code, Place::file(ground.file), text));
    if lattice.cells.len() > VERTICES_MAX {
        let n = lattice.cells.len();
        return fail(
            "vertices-max",
            format!(
                "spacing {spacing_m} m gives {n} vertices, expected at most {VERTICES_MAX}; choose a larger --spacing"
            ),
        );
    }
    if lattice.query.is_empty() || !lattice.is_reference.contains(&true) {
        let which = if lattice.query.is_empty() { "query" } else { "reference" };
        return fail(
            "no-cells",
            format!(
                "no cell centre lies in the region of {which} at spacing {spacing_m} m; nothing was measured; choose a smaller --spacing or draw EF-QUERY and EF-REFERENCE"
            ),
        );
    }
    Ok(())
}

/// Sealed spots that make more than this share of the inside are no piers: the plan is not what it seems.
const FILLED_MAX: f64 = 0.3;

const ON_WALL: u8 = 1;
const LINKS: [([i32; 2], u8); 4] = [([1, 0], 2), ([0, 1], 4), ([1, 1], 8), ([-1, 1], 16)];

/// Dense cells of the drawing's box, with links between neighbours.
struct Field {
    first: [i32; 2],
    cols: usize,
    rows: usize,
    spacing_um: i64,
    origin_um: PointUm,
    flags: Vec<u8>,
    on_fixed: Vec<bool>,
    /// Cells with a link that something movable cuts.
    beside_movable: Vec<bool>,
}

impl Field {
    fn new(ground: &Ground<'_>) -> Result<Self, Error> {
        let (s, o) = (ground.spacing_um, ground.centre_um);
        let walls = ground.fixed.iter().chain(ground.movable).flat_map(|g| [g.a, g.b]);
        let regions = ground.query.iter().chain(ground.reference).flat_map(Region::outline);
        let (mut lo, mut hi) = ([i64::MAX; 2], [i64::MIN; 2]);
        let inside = ground.interior.and_then(Interior::extent_um).into_iter().flatten();
        for p in walls.chain(regions).chain(ground.seeds_um.iter().copied()).chain(inside) {
            for k in 0..2 {
                lo[k] = lo[k].min(p[k]);
                hi[k] = hi[k].max(p[k]);
            }
        }
        let cell = |v: i64, k: usize| (v - o[k]).div_euclid(s);
        let first = [cell(lo[0], 0) - 1, cell(lo[1], 1) - 1];
        let size = [cell(hi[0], 0) + 2 - first[0] + 1, cell(hi[1], 1) + 2 - first[1] + 1];
        if size[0].saturating_mul(size[1]) > CELLS_MAX as i64 {
            let text = format!(
                "spacing {} m lays {} × {} cells over the drawing, expected at most {CELLS_MAX} in all; choose a larger --spacing",
                s as f64 / 1e6,
                size[0],
                size[1]
            );
            return Err(Error::input("cells-max", Place::file(ground.file), text));
        }
        let (cols, rows) = (size[0] as usize, size[1] as usize);
        let origin_um = [o[0] + first[0] * s, o[1] + first[1] * s];
        let mut field = Self {
            first: [first[0] as i32, first[1] as i32],
            cols,
            rows,
            spacing_um: s,
            origin_um,
            flags: vec![0; cols * rows],
            on_fixed: vec![false; cols * rows],
            beside_movable: vec![false; cols * rows],
        };
        ground.fixed.iter().for_each(|g| field.cut(*g, true));
        ground.movable.iter().for_each(|g| field.cut(*g, false));
        Ok(field)
    }

    fn index(&self, col: usize, row: usize) -> usize {
        col * self.rows + row
    }

    fn centre(&self, col: usize, row: usize) -> PointUm {
        [self.origin_um[0] + col as i64 * self.spacing_um, self.origin_um[1] + row as i64 * self.spacing_um]
    }

    /// Marks the cells a wall piece touches and the links it cuts.
    fn cut(&mut self, wall: Segment, is_fixed: bool) {
        let (s, o) = (self.spacing_um, self.origin_um);
        let (left, right) = if wall.a[0] <= wall.b[0] { (wall.a, wall.b) } else { (wall.b, wall.a) };
        let col_of = |x: i64| (x - o[0]).div_euclid(s);
        let row_of = |y: i64| (y - o[1]).div_euclid(s);
        let (n_cols, n_rows) = (self.cols, self.rows);
        let clamp = |v: i64, n: usize| v.clamp(0, n as i64 - 1) as usize;
        let cols = (clamp(col_of(left[0]) - 1, n_cols), clamp(col_of(right[0]) + 2, n_cols));
        for col in cols.0..=cols.1 {
            let x = o[0] + col as i64 * s;
            let (y0, y1) = heights_between(left, right, x - s, x + s);
            let rows = (clamp(row_of(y0) - 1, n_rows), clamp(row_of(y1) + 2, n_rows));
            for row in rows.0..=rows.1 {
                self.cut_at(col, row, wall, is_fixed);
            }
        }
    }

    fn cut_at(&mut self, col: usize, row: usize, wall: Segment, is_fixed: bool) {
        let (i, a) = (self.index(col, row), self.centre(col, row));
        if segments_touch(Segment { a, b: a }, wall) {
            self.flags[i] |= ON_WALL;
            self.on_fixed[i] |= is_fixed;
        }
        for ([dc, dr], bit) in LINKS {
            let b = [a[0] + i64::from(dc) * self.spacing_um, a[1] + i64::from(dr) * self.spacing_um];
            if segments_touch(Segment { a, b }, wall) {
                self.flags[i] |= bit;
                self.beside_movable[i] |= !is_fixed;
                let (c, r) = (col as i64 + i64::from(dc), row as i64 + i64::from(dr));
                if !is_fixed && c >= 0 && c < self.cols as i64 && r < self.rows as i64 {
                    let other = self.index(c as usize, r as usize);
                    self.beside_movable[other] = true;
                }
            }
        }
    }

    /// Cells that touch or lie inside something that cannot move.
    fn dropped(&self, ground: &Ground<'_>) -> Vec<bool> {
        let mut out = self.on_fixed.clone();
        for ring in ground.fixed_solids {
            for_each_cell_in(ring, self.spacing_um, self.origin_um, [self.cols, self.rows], |col, row| {
                out[self.index(col, row)] = true;
            });
        }
        out
    }

    /// Visits the cells joined with `i` by a free link.
    fn for_each_linked(&self, col: usize, row: usize, mut visit: impl FnMut(usize, usize)) {
        for ([dc, dr], bit) in LINKS {
            for sign in [1, -1] {
                let (c, r) = (col as i64 + i64::from(sign * dc), row as i64 + i64::from(sign * dr));
                if c < 0 || r < 0 || c >= self.cols as i64 || r >= self.rows as i64 {
                    continue;
                }
                let (c, r) = (c as usize, r as usize);
                let holder = if sign == 1 { self.index(col, row) } else { self.index(c, r) };
                if self.flags[holder] & bit == 0 {
                    visit(c, r);
                }
            }
        }
    }

    /// What an 8-neighbour flood reaches from the given cells (those on walls excepted).
    fn flood(&self, seeds: impl Iterator<Item = (usize, usize)>) -> Vec<bool> {
        let mut reached = vec![false; self.flags.len()];
        let mut stack: Vec<(usize, usize)> =
            seeds.filter(|s| self.flags[self.index(s.0, s.1)] & ON_WALL == 0).collect();
        stack.iter().for_each(|s| reached[self.index(s.0, s.1)] = true);
        while let Some((col, row)) = stack.pop() {
            self.for_each_linked(col, row, |c, r| {
                let i = self.index(c, r);
                if !reached[i] {
                    reached[i] = true;
                    stack.push((c, r));
                }
            });
        }
        reached
    }

    fn inside(&self, ground: &Ground<'_>, report: &mut Report) -> Result<Vec<bool>, Error> {
        if !ground.seeds_um.is_empty() {
            return self.flood_from_seeds(ground, report);
        }
        let is_border = |c: usize, r: usize| c == 0 || r == 0 || c + 1 == self.cols || r + 1 == self.rows;
        let cells = (0..self.cols).flat_map(|c| (0..self.rows).map(move |r| (c, r)));
        let outside = self.flood(cells.clone().filter(|(c, r)| is_border(*c, *r)));
        let mut inside: Vec<bool> = outside.iter().map(|o| !o).collect();
        if let Some(interior) = ground.interior {
            for (c, r) in cells {
                let (i, p) = (self.index(c, r), self.centre(c, r));
                let enclosed = if interior.is_as_drawn() { inside[i] } else { interior.contains(p) };
                let is_cavity = || self.flags[i] & ON_WALL == 0 && interior.is_cavity(p);
                inside[i] = enclosed && (self.beside_movable[i] || !is_cavity());
            }
            if !interior.is_as_drawn() {
                self.leave_outer_side(interior, &mut inside);
            }
        }
        Ok(inside)
    }

    /// Takes out cells just beyond the outer side of a wall: nearer to it than the interior tells its sides apart,
    /// joined with the outside and with nothing that surely lies inside.
    fn leave_outer_side(&self, interior: &Interior, inside: &mut [bool]) {
        let is_at_wall = |c: usize, r: usize| interior.is_at_wall(self.centre(c, r));
        let lies_outside = |i: &usize| {
            let (col, row) = (i / self.rows, i % self.rows);
            let (mut is_sure, mut meets_outside) = (false, false);
            self.for_each_linked(col, row, |c, r| {
                let is_inside = inside[self.index(c, r)];
                meets_outside |= !is_inside;
                is_sure |= is_inside && !is_at_wall(c, r);
            });
            meets_outside && !is_sure
        };
        let near = (0..inside.len()).filter(|i| inside[*i] && self.flags[*i] & ON_WALL == 0);
        let near = near.filter(|i| is_at_wall(i / self.rows, i % self.rows));
        let beyond: Vec<usize> = near.filter(lies_outside).collect();
        beyond.into_iter().for_each(|i| inside[i] = false);
    }

    /// Takes small spots that fixed walls seal out of the inside, as solid outlines are (spec 3).
    fn fill_sealed_spots(&self, ground: &Ground<'_>, inside: &mut [bool], report: &mut Report) {
        let mut is_seen: Vec<bool> =
            inside.iter().zip(&self.flags).map(|(i, f)| !i || f & ON_WALL != 0).collect();
        let (mut spots, mut filled) = (0, Vec::new());
        for start in 0..is_seen.len() {
            if is_seen[start] {
                continue;
            }
            is_seen[start] = true;
            let mut spot = vec![start];
            let mut next = 0;
            while next < spot.len() {
                let (col, row) = (spot[next] / self.rows, spot[next] % self.rows);
                self.for_each_linked(col, row, |c, r| {
                    let i = self.index(c, r);
                    if !is_seen[i] {
                        is_seen[i] = true;
                        spot.push(i);
                    }
                });
                next += 1;
            }
            if self.across_um(&spot) <= ground.solid_across_um
                && !spot.iter().any(|i| self.beside_movable[*i])
            {
                spots += 1;
                filled.append(&mut spot);
            }
        }
        let count = inside.iter().filter(|i| **i).count();
        if filled.is_empty() || filled.len() as f64 > FILLED_MAX * count as f64 {
            return;
        }
        filled.iter().for_each(|i| inside[*i] = false);
        let across_m = ground.solid_across_um as f64 / 1e6;
        let text = format!(
            "{} that walls seal, at most {across_m} m across, with {}, taken as solid; \
             EF-QUERY says exactly what is measured",
            counted(spots, "spot"),
            counted(filled.len() as u64, "cell")
        );
        report.info("sealed-spots", Place::file(ground.file), text);
    }

    /// Diagonal of the box of some cells.
    fn across_um(&self, cells: &[usize]) -> i64 {
        let extent = |of: &dyn Fn(usize) -> usize| {
            let (lo, hi) = cells.iter().fold((usize::MAX, 0), |(lo, hi), i| (lo.min(of(*i)), hi.max(of(*i))));
            (hi + 1 - lo) as f64 * self.spacing_um as f64
        };
        extent(&|i| i / self.rows).hypot(extent(&|i| i % self.rows)).round() as i64
    }
}

/// Lowest and highest y of the part of `left → right` between two x, a cell of slack not included.
fn heights_between(left: PointUm, right: PointUm, x0: i64, x1: i64) -> (i64, i64) {
    let width = (right[0] - left[0]) as f64;
    if width == 0.0 {
        return (left[1].min(right[1]), left[1].max(right[1]));
    }
    let at = |x: i64| {
        let t = ((x - left[0]) as f64 / width).clamp(0.0, 1.0);
        left[1] + (t * (right[1] - left[1]) as f64).round() as i64
    };
    let (a, b) = (at(x0), at(x1));
    (a.min(b) - 1, a.max(b) + 1)
}

/// Calls `visit(col, row)` for the cells whose centre lies in the ring or on it. Exact.
fn for_each_cell_in(
    ring: &[PointUm],
    spacing_um: i64,
    origin_um: PointUm,
    size: [usize; 2],
    mut visit: impl FnMut(usize, usize),
) {
    let range = |k: usize| {
        let lo = ring.iter().map(|p| p[k]).min().unwrap_or(0) - origin_um[k];
        let hi = ring.iter().map(|p| p[k]).max().unwrap_or(0) - origin_um[k];
        let first = lo.div_euclid(spacing_um).max(0) as usize;
        let last = hi.div_euclid(spacing_um).min(size[k] as i64 - 1);
        first..(last + 1).max(0) as usize
    };
    for col in range(0) {
        for row in range(1) {
            let p = [origin_um[0] + col as i64 * spacing_um, origin_um[1] + row as i64 * spacing_um];
            if side_of_ring(ring, p) != Side::Outside {
                visit(col, row);
            }
        }
    }
}

/// Finds vertices by place, for solids that move.
#[derive(Clone, Debug)]
pub struct CellIndex {
    spacing_um: i64,
    origin_um: PointUm,
    size: [usize; 2],
    vertex: Vec<u32>,
}

impl CellIndex {
    /// Indexes all vertices.
    pub fn new(lattice: &Lattice) -> Self {
        let fold =
            |k: usize, f: fn(i32, i32) -> i32| lattice.cells.iter().map(|c| c[k]).reduce(f).unwrap_or(0);
        let first = [fold(0, i32::min), fold(1, i32::min)];
        let size = [(fold(0, i32::max) - first[0] + 1) as usize, (fold(1, i32::max) - first[1] + 1) as usize];
        let at = |k: usize| lattice.origin_um[k] + i64::from(first[k]) * lattice.spacing_um;
        let mut vertex = vec![u32::MAX; size[0] * size[1]];
        for (v, c) in lattice.cells.iter().enumerate() {
            vertex[(c[0] - first[0]) as usize * size[1] + (c[1] - first[1]) as usize] = v as u32;
        }
        Self { spacing_um: lattice.spacing_um, origin_um: [at(0), at(1)], size, vertex }
    }

    /// Appends the vertices that lie in the ring or on it.
    pub fn vertices_in(&self, ring: &[PointUm], out: &mut Vec<u32>) {
        for_each_cell_in(ring, self.spacing_um, self.origin_um, self.size, |col, row| {
            let v = self.vertex[col * self.size[1] + row];
            if v != u32::MAX {
                out.push(v);
            }
        });
    }

    /// Appends the vertices that a segment touches: they see nothing.
    pub fn vertices_on(&self, s: Segment, out: &mut Vec<u32>) {
        let [cols, rows] = self.size.map(|n| n as i64);
        for_each_cell_on(s, self.spacing_um, self.origin_um, [cols, rows].map(|n| 0..n), |cell| {
            let v = self.vertex[cell[0] as usize * self.size[1] + cell[1] as usize];
            if v != u32::MAX {
                out.push(v);
            }
        });
    }
}

/// How many cells have their centre on one of the segments and are vertices or stand beside one: floor that cannot be
/// measured.
pub fn floor_on_walls(lattice: &Lattice, segments: &[Segment]) -> usize {
    let floor: HashSet<[i64; 2]> = lattice.cells.iter().map(|c| c.map(i64::from)).collect();
    let range = |k: usize| {
        let all = || lattice.cells.iter().map(|c| i64::from(c[k]));
        all().min().unwrap_or(0) - 1..all().max().unwrap_or(0) + 2
    };
    let bounds = [range(0), range(1)];
    let is_floor =
        |c: [i64; 2]| (-1..=1).any(|dx| (-1..=1).any(|dy| floor.contains(&[c[0] + dx, c[1] + dy])));
    let mut found = HashSet::new();
    for s in segments {
        for_each_cell_on(*s, lattice.spacing_um, lattice.origin_um, bounds.clone(), |cell| {
            if is_floor(cell) {
                found.insert(cell);
            }
        });
    }
    found.len()
}

/// Calls `visit` for the cells within bounds whose centre lies on a segment. Exact.
fn for_each_cell_on(
    s: Segment,
    spacing_um: i64,
    origin_um: PointUm,
    bounds: [Range<i64>; 2],
    mut visit: impl FnMut([i64; 2]),
) {
    let [a, b] = [s.a, s.b].map(|p| [0, 1].map(|k| i128::from(p[k]) - i128::from(origin_um[k])));
    let step = i128::from(spacing_um);
    // Along the axis on which it reaches farther there is at most one cell a line.
    let k = usize::from((b[1] - a[1]).abs() > (b[0] - a[0]).abs());
    let (lo, hi) = (a[k].min(b[k]), a[k].max(b[k]));
    let first = (lo + step - 1).div_euclid(step).max(i128::from(bounds[k].start));
    let last = hi.div_euclid(step).min(i128::from(bounds[k].end) - 1);
    for line in first..=last {
        let way = b[k] - a[k];
        let rise = (b[1 - k] - a[1 - k]) * (line * step - a[k]);
        let is_whole = way == 0 || rise % way == 0;
        let across = a[1 - k] + if way == 0 { 0 } else { rise / way };
        let other = across.div_euclid(step);
        let other_bounds = i128::from(bounds[1 - k].start)..i128::from(bounds[1 - k].end);
        if is_whole && across.rem_euclid(step) == 0 && other_bounds.contains(&other) {
            let cell = if k == 0 { [line, other] } else { [other, line] };
            visit(cell.map(|i| i as i64));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::visibility::visibility_graph;
    use crate::{Obstacles, fixtures};

    /// What a segment touches is what sees nothing because of it.
    #[test]
    fn vertices_that_a_segment_touches_are_found() {
        let cells: Vec<[i32; 2]> =
            (0..9).flat_map(|c| (0..7).map(move |r| [c, r])).filter(|c| *c != [4, 4]).collect();
        let lattice = fixtures::lattice(12, [5, -7], cells);
        let index = CellIndex::new(&lattice);
        let at = |c: i64, r: i64| [5 + 12 * c, -7 + 12 * r];
        let segments = [
            (at(1, 1), at(1, 5)),
            (at(6, 2), at(2, 2)),
            (at(0, 0), at(6, 6)),
            (at(8, 1), at(2, 4)),
            ([5 + 12 * 3, -7 - 100], [5 + 12 * 3, -7 + 1000]),
            ([5 - 500, -7 + 3], [5 + 500, -7 + 3]),
            (at(3, 3), at(3, 3)),
            ([5 + 1, -7 + 1], [5 + 25, -7 + 49]),
        ];
        for (a, b) in segments {
            let wall = Segment { a, b };
            let mut found = Vec::new();
            index.vertices_on(wall, &mut found);
            found.sort_unstable();
            let graph = visibility_graph(&lattice, &Obstacles { segments: vec![wall], blind: vec![] });
            let deaf: Vec<u32> = (0..lattice.cells.len() as u32).filter(|v| graph.degree(*v) == 0).collect();
            assert_eq!(found, deaf, "{wall:?}");
        }
    }

    #[test]
    fn floor_under_walls_on_lattice_lines_is_counted() {
        let cells: Vec<[i32; 2]> =
            (0..9).filter(|c| *c != 4).flat_map(|c| (0..7).map(move |r| [c, r])).collect();
        let lattice = fixtures::lattice(12, [5, -7], cells);
        let at = |c: i64, r: i64| [5 + 12 * c, -7 + 12 * r];
        let wall = |a, b| Segment { a, b };
        let count = |walls: &[Segment]| floor_on_walls(&lattice, walls);
        assert_eq!(count(&[wall(at(4, -3), at(4, 20))]), 9, "all of the column, and a cell beside each end");
        assert_eq!(count(&[wall(at(4, 0), at(4, 3)), wall(at(2, 3), at(6, 3))]), 8, "each once");
        assert_eq!(count(&[wall([5 + 49, -100], [5 + 49, 100])]), 0, "between the lines");
        assert_eq!(count(&[wall(at(20, 0), at(20, 6))]), 0, "far from the floor");
    }

    pub(super) fn ring(points: &[[i64; 2]]) -> Vec<Segment> {
        (0..points.len()).map(|i| Segment { a: points[i], b: points[(i + 1) % points.len()] }).collect()
    }

    pub(super) fn ground(fixed: &[Segment]) -> Ground<'_> {
        Ground {
            file: "plan.dxf",
            spacing_um: 1_000_000,
            centre_um: [500_000, 500_000],
            query: &[],
            reference: &[],
            seeds_um: &[],
            seeds_by_cell: false,
            seed_names: &[],
            fixed,
            movable: &[],
            fixed_solids: &[],
            interior: None,
            solid_across_um: 0,
        }
    }

    pub(super) const M: i64 = 1_000_000;

    #[test]
    fn the_interior_is_what_the_outside_does_not_reach() {
        let walls = ring(&[[0, 0], [4 * M, 0], [4 * M, 3 * M], [0, 3 * M]]);
        let l = lattice(&ground(&walls), &mut Report::default()).unwrap();
        assert_eq!((l.cells.len(), l.query.len()), (12, 12));
        let mut open = walls.clone();
        open[0].b[0] = 2 * M;
        assert!(lattice(&ground(&open), &mut Report::default()).is_err(), "an open outline has no interior");
        let seeded = Ground { seeds_um: &[[M, M]], ..ground(&walls) };
        assert_eq!(lattice(&seeded, &mut Report::default()).unwrap().cells.len(), 12);
    }

    #[test]
    fn cells_on_what_stays_are_dropped_and_on_what_moves_are_kept() {
        let walls = ring(&[[0, 0], [4 * M, 0], [4 * M, 3 * M], [0, 3 * M]]);
        let through = [Segment { a: [M / 2, M / 2], b: [M / 2, 2 * M + M / 2] }];
        let fixed: Vec<Segment> = walls.iter().chain(&through).copied().collect();
        assert_eq!(lattice(&ground(&fixed), &mut Report::default()).unwrap().cells.len(), 9);
        let movable = Ground { movable: &through, ..ground(&walls) };
        assert_eq!(lattice(&movable, &mut Report::default()).unwrap().cells.len(), 12);
        let solids = [vec![[M, M], [3 * M, M], [3 * M, 2 * M], [M, 2 * M]]];
        let solid = Ground { fixed_solids: &solids, ..ground(&walls) };
        assert_eq!(lattice(&solid, &mut Report::default()).unwrap().cells.len(), 10);
    }

    #[test]
    fn small_sealed_spots_are_solid_unless_something_beside_them_moves() {
        let walls = ring(&[[0, 0], [9 * M, 0], [9 * M, 5 * M], [0, 5 * M]]);
        let pier = ring(&[[0, 0], [M, 0], [M, M], [0, M]]);
        let fixed: Vec<Segment> = walls.iter().chain(&pier).copied().collect();
        let interior = Interior::new(&walls, &[], 1.0);
        let of = |fixed: &[Segment], movable: &[Segment], solid_across_um: i64| {
            let ground = Ground { movable, interior: interior.as_ref(), solid_across_um, ..ground(fixed) };
            lattice(&ground, &mut Report::default()).unwrap().cells.len()
        };
        assert_eq!(of(&fixed, &[], 2 * M), 44);
        assert_eq!(of(&fixed, &[], M), 45, "wider than allowed");
        assert_eq!(of(&walls, &pier, 2 * M), 45, "it may open");
        assert_eq!(of(&walls, &[], 99 * M), 45, "so much is no pier");
    }

    /// Cells a hair beyond a wall's outer side are no floor, however coarsely the interior is known; those in a doorway
    /// and beside inner walls are.
    #[test]
    fn cells_that_touch_the_outer_side_of_a_wall_almost_are_outside() {
        let (hair, wide) = (M / 2000, 6 * M - M / 2000);
        let mut walls = ring(&[[hair, hair], [wide, hair], [wide, 4 * M - M / 2], [hair, 4 * M - M / 2]]);
        let door = Segment { a: [wide, M + M / 2], b: [wide, 2 * M + M / 2] };
        walls[1].b = door.a;
        walls.push(Segment { a: door.b, b: [wide, 4 * M - M / 2] });
        walls.push(Segment { a: [3 * M + hair, M + M / 2], b: [3 * M + hair, 4 * M - M / 2] });
        let interior = Interior::new(&walls, &[door], 1.0);
        let ground = Ground { interior: interior.as_ref(), centre_um: [0, 0], ..ground(&walls) };
        let l = lattice(&ground, &mut Report::default()).unwrap();
        let mut expected: Vec<[i32; 2]> = (1..6).flat_map(|c| (1..4).map(move |r| [c, r])).collect();
        // In the doorway.
        expected.push([6, 2]);
        assert_eq!(l.cells, expected);
    }

    #[test]
    fn walls_round_no_room_are_told_from_a_lattice_too_coarse() {
        let code = |walls: &[Segment]| {
            let interior = Interior::new(walls, &[], 1.0);
            let ground = Ground { centre_um: [0, 0], interior: interior.as_ref(), ..ground(walls) };
            let error = lattice(&ground, &mut Report::default()).unwrap_err();
            error.problem().map_or("", |p| p.code)
        };
        let outline = |w: i64, h: i64| ring(&[[M / 10, M / 10], [w, M / 10], [w, h], [M / 10, h]]);
        assert_eq!(code(&outline(5 * M, 3 * M / 10)), "no-room");
        assert_eq!(code(&outline(9 * M / 10, 9 * M / 10)), "no-cells");
        // A thick wall that may move: there are cells under it, and no room.
        let wall = outline(5 * M, 3 * M / 10);
        let interior = Interior::new(&wall, &[], 1.0);
        let under = |seeds_um: &[PointUm]| {
            let ground = Ground { spacing_um: M / 20, seeds_um, movable: &wall, ..ground(&[]) };
            lattice(&Ground { interior: interior.as_ref(), ..ground }, &mut Report::default())
        };
        let code = under(&[]).unwrap_err();
        assert_eq!(code.problem().map(|p| p.code), Some("no-room"));
        assert!(under(&[[M, 2 * M / 10]]).is_ok(), "a seed says where people stand");
    }

    #[test]
    fn one_region_drawn_the_other_is_the_interior() {
        let walls = ring(&[[0, 0], [4 * M, 0], [4 * M, 3 * M], [0, 3 * M]]);
        let query = [Region::Ring(vec![[0, 0], [2 * M, 0], [2 * M, M], [0, M]])];
        let l = lattice(&Ground { query: &query, ..ground(&walls) }, &mut Report::default()).unwrap();
        assert_eq!((l.query.len(), l.is_reference.iter().filter(|r| **r).count()), (2, 12));
        let disc = [Region::Disc { centre: [M, M], radius_um: 800_000 }];
        let l = lattice(&Ground { query: &disc, ..ground(&walls) }, &mut Report::default()).unwrap();
        assert_eq!(l.query.len(), 4);
    }

    #[test]
    fn limits_are_errors_with_a_remedy() {
        let walls = ring(&[[0, 0], [400 * M, 0], [400 * M, 400 * M], [0, 400 * M]]);
        let fails = |spacing_um: i64| {
            let g = Ground { spacing_um, ..ground(&walls) };
            lattice(&g, &mut Report::default()).unwrap_err().to_string()
        };
        assert!(fails(10_000).contains(&CELLS_MAX.to_string()));
        assert!(fails(150_000).contains(&VERTICES_MAX.to_string()));
    }

    #[test]
    fn vertices_are_found_by_place() {
        let walls = ring(&[[0, 0], [4 * M, 0], [4 * M, 3 * M], [0, 3 * M]]);
        let l = lattice(&ground(&walls), &mut Report::default()).unwrap();
        let mut found = Vec::new();
        CellIndex::new(&l).vertices_in(&[[M, 0], [3 * M, 0], [3 * M, M], [M, M]], &mut found);
        let cells: Vec<[i32; 2]> = found.iter().map(|v| l.cells[*v as usize]).collect();
        assert_eq!(cells, [[1, 0], [2, 0]]);
    }
}
