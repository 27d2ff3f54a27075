//! Through vision: how many sight lines pass over a cell.

use enfilade_brief::{Measure, column_of};
use rayon::prelude::*;

use super::Lattice;
use super::graph::Graph;
use super::measures::Column;

/// `Sight Lines Through`: for every vertex the sight lines between two other vertices that pass over it, each pair
/// counted once. A line passes over one cell in each column (each row, if it is steeper than 45°) between its ends:
/// the nearest one, or both of two equally near ones. depthmapX's `Through vision` counts every pair both ways, no
/// diagonal lines, and where two cells are equally near either or both, as its sums are rounded.
pub fn through_vision_column(lattice: &Lattice, graph: &Graph) -> Column {
    through_vision_column_from(&sight_lines(lattice, graph, &(0..graph.len() as u32).collect::<Vec<u32>>()))
}

/// [`through_vision_column`] from the counts of all vertices.
pub fn through_vision_column_from(counts: &[u64]) -> Column {
    Column {
        name: column_of(Measure::ThroughVision).into(),
        values: counts.iter().map(|c| *c as f64).collect(),
    }
}

/// For every vertex the sight lines over it that begin at some vertices and end at later ones.
pub fn sight_lines(lattice: &Lattice, graph: &Graph, from: &[u32]) -> Vec<u64> {
    let n = graph.len();
    let one = |mut counts: Vec<u64>, v: &u32| {
        graph.for_each_neighbour(*v, |u| {
            if u > *v {
                let cells = [lattice.cells[*v as usize], lattice.cells[u as usize]];
                for_each_between(cells, |cell| {
                    if let Some(w) = vertex_at(lattice, graph, cell) {
                        counts[w] += 1;
                    }
                });
            }
        });
        counts
    };
    let add = |mut a: Vec<u64>, b: Vec<u64>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        a
    };
    let share = from.len().div_ceil(rayon::current_num_threads()).max(1);
    let counts = from.par_chunks(share).map(|own| own.iter().fold(vec![0; n], one));
    counts.reduce(|| vec![0; n], add)
}

fn vertex_at(lattice: &Lattice, graph: &Graph, cell: [i32; 2]) -> Option<usize> {
    if graph.tiles.grid.is_empty() {
        return lattice.cells.binary_search(&cell).ok();
    }
    graph.rank_at(cell).map(|rank| graph.tiles.vertex_of[rank] as usize)
}

/// Cells strictly between two, one a step along the longer side, or two where the line passes between them.
fn for_each_between([a, b]: [[i32; 2]; 2], mut visit: impl FnMut([i32; 2])) {
    let run = [0, 1].map(|k| i64::from(b[k]) - i64::from(a[k]));
    let steps = run[0].abs().max(run[1].abs());
    for i in 1..steps {
        // Halves are rounded up, and down.
        let up = [0, 1].map(|k| a[k] + (2 * i * run[k] + steps).div_euclid(2 * steps) as i32);
        let down = [0, 1].map(|k| a[k] + (2 * i * run[k] + steps - 1).div_euclid(2 * steps) as i32);
        visit(up);
        if down != up {
            visit(down);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Obstacles, fixtures, visibility};
    use super::*;

    #[test]
    fn a_row_of_five_is_seen_through_in_the_middle() {
        let lattice = fixtures::lattice(10, [0, 0], (0..5).map(|c| [c - 9, 3]).collect());
        let graph = visibility::visibility_graph(&lattice, &Obstacles::default());
        assert_eq!(through_vision_column(&lattice, &graph).values, [0.0, 3.0, 4.0, 3.0, 0.0]);
    }

    #[test]
    fn a_line_passes_over_one_cell_a_step_or_between_two() {
        let ends =
            [([5, 2], 4), ([-5, 2], 4), ([2, -7], 6), ([4, 4], 3), ([1, 0], 0), ([2, 1], 2), ([-6, 3], 8)];
        for (b, cells) in ends {
            let (mut there, mut back) = (Vec::new(), Vec::new());
            for_each_between([[0, 0], b], |c| there.push(c));
            for_each_between([b, [0, 0]], |c| back.push(c));
            [&mut there, &mut back].into_iter().for_each(|c| c.sort_unstable());
            assert_eq!(there, back);
            assert_eq!(there.len(), cells, "{b:?}");
        }
    }
}
