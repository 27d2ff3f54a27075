//! Plans and brute force for the tests of this module.

use std::collections::HashMap;
use std::path::PathBuf;

use proptest::prelude::*;

use crate::geometry::{Segment, segments_touch};

use super::{Lattice, Obstacles};

/// The folder of reference values, if it is there.
pub fn reference() -> Option<PathBuf> {
    enfilade_fixtures::shared("reference")
}

/// LINEs of layer WALLS of an R12 drawing in metres.
pub fn walls_of(dxf: &str) -> Vec<Segment> {
    let lines: Vec<&str> = dxf.lines().map(str::trim).collect();
    let mut walls = Vec::new();
    let mut fields: HashMap<&str, &str> = HashMap::new();
    let um = |text: &str| (text.parse::<f64>().unwrap() * 1e6).round() as i64;
    for pair in lines.chunks_exact(2) {
        if pair[0] == "0" {
            if fields.get("0") == Some(&"LINE") && fields.get("8") == Some(&"WALLS") {
                let at = |x, y| [um(fields[x]), um(fields[y])];
                walls.push(Segment { a: at("10", "20"), b: at("11", "21") });
            }
            fields.clear();
        }
        fields.insert(pair[0], pair[1]);
    }
    walls
}

/// Header and rows of a table of numbers.
pub fn csv(text: &str) -> (Vec<String>, Vec<Vec<f64>>) {
    let mut lines = text.lines();
    let header = lines.next().unwrap().split(',').map(String::from).collect();
    (header, lines.map(|l| l.split(',').map(|v| v.parse().unwrap()).collect()).collect())
}

/// A lattice whose vertices are all query and reference, sorted by column, then row.
pub fn lattice(spacing_um: i64, origin_um: [i64; 2], mut cells: Vec<[i32; 2]>) -> Lattice {
    cells.sort_unstable();
    cells.dedup();
    Lattice {
        spacing_um,
        origin_um,
        query: (0..cells.len() as u32).collect(),
        is_reference: vec![true; cells.len()],
        beyond: None,
        cells,
    }
}

/// Numbers of a table.
type Rows = Vec<Vec<f64>>;

/// depthmapX's 900 cells, its walls, and its table.
pub fn n900() -> Option<(Lattice, Obstacles, Vec<String>, Rows)> {
    let folder = reference()?.join("depthmapx-n900");
    let read = |name| std::fs::read_to_string(folder.join(name)).unwrap();
    let (header, rows) = csv(&read("cells.csv"));
    let cells = rows.iter().map(|r| [(r[0] as i64 >> 16) as i32, (r[0] as i64 & 0xffff) as i32]).collect();
    let obstacles = Obstacles { segments: walls_of(&read("plan.dxf")), blind: vec![] };
    let lattice = lattice(1_333_300, [0, 0], cells);
    Some((lattice, obstacles, header, rows))
}

/// Whether two cells see each other, by the definition.
pub fn sees(lattice: &Lattice, obstacles: &Obstacles, u: usize, v: usize) -> bool {
    let sight = Segment { a: lattice.centre_um(u), b: lattice.centre_um(v) };
    let blind = |w: usize| obstacles.blind.contains(&(w as u32));
    u != v && !blind(u) && !blind(v) && !obstacles.segments.iter().any(|s| segments_touch(sight, *s))
}

/// Wall ends on a grid of `1 / parts` cells and, now and then, a micrometre beside it.
fn walls(spacing: i64, parts: i64, span: i64) -> impl Strategy<Value = Vec<Segment>> {
    let part = (-2..=span * parts + 2, -1i64..=1, 0..12u8)
        .prop_map(move |(k, off, odd)| k * spacing / parts + if odd == 0 { off } else { 0 });
    let point = [part.clone(), part];
    let wall = (point.clone(), point, 0..6u8).prop_map(|(a, b, kind)| match kind {
        0 => Segment { a, b: [b[0], a[1]] },
        1 => Segment { a, b: [a[0], b[1]] },
        2 => Segment { a, b: [b[0], a[1] + (b[0] - a[0])] },
        3 => Segment { a, b: [b[0], a[1] - (b[0] - a[0])] },
        4 if (a[0] ^ b[1]) & 3 == 0 => Segment { a, b: a },
        _ => Segment { a, b },
    });
    prop::collection::vec(wall, 0..14)
}

/// Plans full of degenerate cases: walls on lattice lines, ends on centres, collinear, touching, 45°,
/// points, a micrometre off; some far from the origin.
pub fn plans() -> impl Strategy<Value = (Lattice, Obstacles)> {
    let shape = (1i64..4, 1i32..14, 1i32..14, any::<u64>(), 0..4u8, any::<bool>());
    shape.prop_flat_map(|(parts, w, h, holes, blind, far)| {
        let spacing = 12;
        let origin = if far { [1_750_000_000_000, -44_000_000_000_017] } else { [0, 0] };
        walls(spacing, parts, i64::from(w.max(h))).prop_map(move |segments| {
            let keep = |c: i32, r: i32| holes.rotate_left((c * 7 + r * 13) as u32 & 63) & 5 != 0;
            let cells: Vec<_> = (0..w).flat_map(|c| (0..h).map(move |r| [c - 3, r + 2])).collect();
            let cells: Vec<_> = cells.into_iter().filter(|c| keep(c[0] + 3, c[1])).collect();
            let blind = (0..u32::from(blind)).filter(|&v| (v as usize) < cells.len()).collect();
            let lattice = lattice(spacing, origin, cells);
            let by = [origin[0] - 3 * spacing, origin[1] + 2 * spacing];
            (lattice, Obstacles { segments: segments.into_iter().map(|s| s.shifted(by)).collect(), blind })
        })
    })
}

/// A square of cells with some holes, and straight walls that leave ways round them.
pub fn mazes(side: i64) -> impl Strategy<Value = (Lattice, Obstacles)> {
    let post = (0..side, 0..side, 0..2u8, 1i64..9);
    prop::collection::vec(post, 0..(2 * side) as usize).prop_map(move |posts| {
        let wall = |(x, y, k, l): (i64, i64, u8, i64)| {
            let (a, l) = ([x * 10 + 5, y * 10 + 5], l * 10);
            Segment { a, b: if k == 0 { [a[0] + l, a[1]] } else { [a[0], a[1] + l] } }
        };
        let side = side as i32;
        let cells = (0..side).flat_map(|c| (0..side - 1).map(move |r| [c, r]));
        let lattice = lattice(10, [0, 0], cells.filter(|c| c[0] * c[1] % 17 != 5).collect());
        (lattice, Obstacles { segments: posts.into_iter().map(wall).collect(), blind: vec![3] })
    })
}

/// Rooms of 8 by 7 cells, so many each way, with a door of one cell in every wall but some.
pub fn rooms(columns: i64, rows: i64) -> (Lattice, Obstacles) {
    let mut segments = Vec::new();
    for column in 0..columns {
        for row in 0..rows {
            let (left, low) = (column * 80 - 5, row * 70 - 5);
            let door = 10 * ((column * 5 + row * 3) % 6 + 1);
            let is_closed = (column * 7 + row * 4) % 9 == 8;
            let gap = if is_closed { 0 } else { 10 };
            segments.push(Segment { a: [left, low], b: [left + door, low] });
            segments.push(Segment { a: [left + door + gap, low], b: [left + 80, low] });
            segments.push(Segment { a: [left, low], b: [left, low + door] });
            segments.push(Segment { a: [left, low + door + 10], b: [left, low + 70] });
        }
    }
    let (width, height) = (columns as i32 * 8, rows as i32 * 7);
    let cells = (0..width).flat_map(|c| (0..height).map(move |r| [c, r])).collect();
    (lattice(10, [0, 0], cells), Obstacles { segments, blind: vec![] })
}
