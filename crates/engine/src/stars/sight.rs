//! Which cells of one tile see which of another.

use std::cmp::Reverse;

use super::super::graph::Graph;

/// What cells of a tile see of another.
#[derive(Clone, Copy)]
pub struct Near {
    /// Its views; none: every cell that sees anything of it sees all.
    pub first: u32,
    pub end: u32,
    /// Whether the views are those of its cells instead.
    pub is_turned: bool,
    /// What any cell sees of it.
    pub any: u64,
}

impl Near {
    /// Whether every cell that sees anything sees all of it.
    #[inline(always)]
    pub fn sees_all(&self) -> bool {
        self.first == self.end
    }
}

/// Views are padded to a multiple of this with empty ones, so that a vector holds some.
pub const VIEWS: usize = 4;

/// See the module page. A view is some cells of a tile that see the same cells of another; two tiles share theirs.
#[derive(Default)]
pub struct Sight {
    /// First entry of each tile in `tiles` and `near`, one more.
    start: Vec<u32>,
    /// Tiles seen, of which most is seen first.
    tiles: Vec<u32>,
    /// What is seen of each: apart, as the tiles alone are asked far more often.
    near: Vec<Near>,
    /// By view, the cells that have it.
    seeing: Vec<u64>,
    /// By view, the cells that they see.
    seen: Vec<u64>,
}

/// What the cells of one tile see of another, by bit.
type Rows = [u64; 64];

impl Sight {
    pub fn new(graph: &Graph) -> Self {
        let count = graph.tiles.count();
        let mut new = Self { start: vec![0], ..Self::default() };
        let mut sums = vec![0u32; count];
        let mut places = vec![0u32; count];
        let mut met = Vec::new();
        let mut squares: Vec<Rows> = Vec::new();
        // By tile, its entries for the tiles before it, which have made the views.
        let mut made: Vec<Vec<(u32, Near)>> = vec![Vec::new(); count];
        let seers = seers(graph);
        for t in 0..count {
            let ranks = graph.tiles.first_rank[t] as usize..graph.tiles.first_rank[t + 1] as usize;
            for rank in ranks.clone() {
                let (tiles, masks) = graph.row(rank);
                for (&to, mask) in tiles.iter().zip(masks) {
                    if sums[to as usize] == 0 {
                        met.push(to);
                    }
                    sums[to as usize] += mask.count_ones();
                }
            }
            met.sort_unstable_by_key(|&to| (Reverse(sums[to as usize]), to));
            for (i, &to) in (0u32..).zip(&met) {
                sums[to as usize] = 0;
                places[to as usize] = i;
            }
            squares.clear();
            squares.resize(met.len(), [0; 64]);
            for rank in ranks {
                let bit = graph.tiles.slot_of[rank].1;
                let (tiles, masks) = graph.row(rank);
                for (&to, &mask) in tiles.iter().zip(masks) {
                    // A cell may be read as seeing itself: what reaches it on a level has reached it on that level.
                    let own = if to as usize == t { 1 << bit } else { 0 };
                    squares[places[to as usize] as usize][usize::from(bit)] = mask | own;
                }
            }
            let views = std::mem::take(&mut made[t]);
            for (to, rows) in met.drain(..).zip(&squares) {
                let near = match views.binary_search_by_key(&to, |near| near.0) {
                    Ok(at) => Near { any: any_of(rows), ..views[at].1 },
                    Err(_) => new.view(rows, [seers[t], seers[to as usize]]),
                };
                if to as usize > t {
                    made[to as usize].push((t as u32, Near { is_turned: true, ..near }));
                }
                new.tiles.push(to);
                new.near.push(near);
            }
            new.start.push(new.tiles.len() as u32);
        }
        new
    }

    /// The entry of a tile that some cells see, and its views; `seers` are the cells of both that see anything.
    fn view(&mut self, rows: &Rows, seers: [u64; 2]) -> Near {
        let first = self.seen.len();
        for (bit, &row) in rows.iter().enumerate().filter(|row| *row.1 != 0) {
            // Neighbours by number mostly see the same.
            match self.seen[first..].iter().rposition(|seen| *seen == row) {
                Some(view) => self.seeing[first + view] |= 1 << bit,
                None => {
                    self.seen.push(row);
                    self.seeing.push(1 << bit);
                }
            }
        }
        if self.seeing[first..] == seers[..1] && self.seen[first..] == seers[1..] {
            self.seen.truncate(first);
        } else {
            self.seen.resize(first + (self.seen.len() - first).next_multiple_of(VIEWS), 0);
        }
        self.seeing.resize(self.seen.len(), 0);
        Near { first: first as u32, end: self.seen.len() as u32, is_turned: false, any: any_of(rows) }
    }

    /// The tiles that cells of a tile see.
    #[inline(always)]
    pub fn of(&self, tile: usize) -> &[u32] {
        &self.tiles[self.start[tile] as usize..self.start[tile + 1] as usize]
    }

    /// What the cells of a tile see of these.
    #[inline(always)]
    pub fn near(&self, tile: usize) -> &[Near] {
        &self.near[self.start[tile] as usize..self.start[tile + 1] as usize]
    }

    /// The views of a tile: who sees, and what.
    #[inline(always)]
    pub fn views(&self, near: &Near) -> (&[u64], &[u64]) {
        let views = near.first as usize..near.end as usize;
        let sides = [&self.seeing[views.clone()], &self.seen[views]];
        (sides[usize::from(near.is_turned)], sides[usize::from(!near.is_turned)])
    }
}

fn any_of(rows: &Rows) -> u64 {
    rows.iter().fold(0, |any, row| any | row)
}

/// By tile, the cells that see anything.
fn seers(graph: &Graph) -> Vec<u64> {
    let mut seers = vec![0; graph.tiles.count()];
    for ((tile, bit), degree) in graph.tiles.slot_of.iter().zip(&graph.degree) {
        seers[*tile as usize] |= u64::from(*degree > 0) << bit;
    }
    seers
}
