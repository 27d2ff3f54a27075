//! Rows of equal lines: treads of a stair, boards, tiles. They are no walls.

use super::cell::Cell;
use super::spans;

/// Fewest cells of a row.
const CELLS_MIN: usize = 4;
/// Widest cell of a row: a tread.
const CELL_MAX_M: f64 = 0.45;
/// How much cells of a row may differ.
const LIKE_SHARE: f64 = 0.12;
/// How much of its neighbour a line of a row faces.
const COVER: f64 = 0.7;

/// Marks the runs that stand in rows of equal lines. `lengths` are those of the runs.
pub fn find(lengths: &[f64], cells: &[Cell]) -> Vec<bool> {
    let mut beside: Vec<[Option<u32>; 2]> = vec![[None; 2]; lengths.len()];
    for (c, cell) in cells.iter().enumerate() {
        let shared = spans::length(cell.span);
        if cell.t <= CELL_MAX_M && cell.runs.iter().all(|r| shared >= COVER * lengths[*r as usize]) {
            for k in 0..2 {
                beside[cell.runs[k] as usize][cell.side[k]] = Some(c as u32);
            }
        }
    }
    let mut out = vec![false; lengths.len()];
    for (r, sides) in beside.iter().enumerate() {
        if let (Some(c), None) | (None, Some(c)) = (sides[0], sides[1]) {
            mark_rows(r as u32, c, cells, &beside, &mut out);
        }
    }
    out
}

/// Walks from line to line; marks each stretch of like cells that is long enough.
fn mark_rows(first: u32, cell: u32, cells: &[Cell], beside: &[[Option<u32>; 2]], out: &mut [bool]) {
    let mut row = vec![first];
    let mut t = cells[cell as usize].t;
    let (mut at, mut next) = (first, Some(cell));
    while let Some(c) = next {
        let cell = &cells[c as usize];
        if (cell.t - t).abs() > LIKE_SHARE * t {
            mark(&row, out);
            row = vec![at];
            t = cell.t;
        }
        let far = usize::from(cell.runs[0] == at);
        at = cell.runs[far];
        if row.contains(&at) {
            break;
        }
        row.push(at);
        next = beside[at as usize][1 - cell.side[far]];
    }
    mark(&row, out);
}

fn mark(row: &[u32], out: &mut [bool]) {
    if row.len() > CELLS_MIN {
        row.iter().for_each(|r| out[*r as usize] = true);
    }
}
