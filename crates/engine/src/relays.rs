//! The rows of the graph as a wave reads them: aligned blocks of cells, shared by neighbouring readers.
//!
//! Readers stand in groups of 4 × 2 cells. What all of a group see is listed once, as blocks (cell,
//! pair, four, row of eight, whole tile); what only some see is listed for each.

use super::graph::{Graph, for_each_bit};

/// Words of a tile: 64 cells, 32 pairs, 16 fours, 8 rows, the tile; the rest is padding.
pub(super) const BLOCK: usize = 128;
pub(super) const PAIRS: usize = 64;
pub(super) const FOURS: usize = 96;
pub(super) const ROWS: usize = 112;
pub(super) const WHOLE: usize = 120;

/// Cells of the lowest group of a tile, and where the groups start.
const GROUP: u64 = 0x0f0f;
const GROUP_BITS: [u32; 8] = [0, 4, 16, 20, 32, 36, 48, 52];

/// Readers that share a list.
pub(super) struct Group {
    /// Cells of the tile that belong to it and see anything at all.
    pub members: u64,
    /// End of its shared list; it starts where the previous one ends.
    pub end: u32,
}

/// See the module page. A block's number is `tile * BLOCK + block`.
pub(super) struct Relays<'a> {
    pub graph: &'a Graph,
    /// Groups in the order of the tiles.
    pub groups: Vec<Group>,
    /// First group of each tile, one entry more.
    pub first_group: Vec<u32>,
    /// Blocks that all members of a group read.
    pub shared: Vec<u32>,
    /// First of each rank's own blocks, one entry more.
    pub own_start: Vec<u32>,
    /// Blocks that a rank reads besides.
    pub own: Vec<u32>,
    /// Component of each rank: its smallest rank.
    pub component: Vec<u32>,
}

/// Per tile, what all members may read so far.
struct Common {
    mask: Vec<u64>,
    hits: Vec<u32>,
}

impl<'a> Relays<'a> {
    pub fn new(graph: &'a Graph) -> Self {
        let tiles = graph.tiles.count();
        let mut new = Self {
            graph,
            groups: Vec::with_capacity(tiles * 8),
            first_group: Vec::with_capacity(tiles + 1),
            shared: Vec::with_capacity(graph.entry_tile.len()),
            own_start: vec![0; graph.len() + 1],
            own: Vec::with_capacity(graph.entry_tile.len() * 2),
            component: graph.rank_components(),
        };
        // Cells that see nothing are never on a frontier, so blocks may cover them.
        let mut active = graph.tiles.occupied.clone();
        for (rank, &(tile, bit)) in graph.tiles.slot_of.iter().enumerate() {
            if graph.degree[rank] == 0 {
                active[tile as usize] &= !(1 << bit);
            }
        }
        let mut common = Common { mask: vec![0; tiles], hits: vec![0; tiles] };
        // Ranks of a tile are not in the order of its groups: own lists are made by group, then moved.
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); 64];
        for t in 0..tiles {
            new.first_group.push(new.groups.len() as u32);
            for group in GROUP_BITS.map(|bit| active[t] & (GROUP << bit)).into_iter().filter(|g| *g != 0) {
                new.add_group(t, group, &active, &mut common, &mut lists);
            }
            for rank in graph.tiles.first_rank[t] as usize..graph.tiles.first_rank[t + 1] as usize {
                let list = &mut lists[usize::from(graph.tiles.slot_of[rank].1)];
                new.own.append(list);
                new.own_start[rank + 1] = new.own.len() as u32;
            }
        }
        new.first_group.push(new.groups.len() as u32);
        new
    }

    fn add_group(
        &mut self,
        t: usize,
        group: u64,
        active: &[u64],
        common: &mut Common,
        lists: &mut [Vec<u32>],
    ) {
        let graph = self.graph;
        let members = group.count_ones();
        let rank_of = |bit: u32| graph.tiles.rank(t as u32, bit);
        // A reader never misses what it is itself the frontier of: it may read itself.
        let own_cell = |bit: u32, tile: u32| if tile as usize == t { 1u64 << bit } else { 0 };
        for_each_bit(group, |bit| {
            let (tiles, masks) = graph.row(rank_of(bit));
            for (&tile, &mask) in tiles.iter().zip(masks) {
                let i = tile as usize;
                let allowed = mask | own_cell(bit, tile) | !active[i];
                common.mask[i] = if common.hits[i] == 0 { allowed } else { common.mask[i] & allowed };
                common.hits[i] += 1;
            }
        });
        let first = group.trailing_zeros();
        let (tiles, _) = graph.row(rank_of(first));
        for &tile in tiles {
            let i = tile as usize;
            if common.hits[i] == members {
                cover(tile, common.mask[i], common.mask[i] & active[i], &mut self.shared);
            }
        }
        for_each_bit(group, |bit| {
            let (tiles, masks) = graph.row(rank_of(bit));
            for (&tile, &mask) in tiles.iter().zip(masks) {
                let i = tile as usize;
                let shared = if common.hits[i] == members { common.mask[i] } else { 0 };
                let allowed = mask | own_cell(bit, tile) | !active[i];
                cover(tile, allowed, mask & !shared, &mut lists[bit as usize]);
            }
        });
        for_each_bit(group, |bit| {
            graph.row(rank_of(bit)).0.iter().for_each(|&tile| common.hits[tile as usize] = 0);
        });
        self.groups.push(Group { members: group, end: self.shared.len() as u32 });
    }
}

/// Few aligned blocks of a tile within `allowed` that cover `needed`.
fn cover(tile: u32, allowed: u64, needed: u64, blocks: &mut Vec<u32>) {
    let base = tile * BLOCK as u32;
    if allowed == u64::MAX && needed != 0 {
        blocks.push(base + WHOLE as u32);
        return;
    }
    // Bit k of each: the block of that size that starts at cell k lies within `allowed`.
    let pairs = allowed & (allowed >> 1) & 0x5555_5555_5555_5555;
    let fours = pairs & (pairs >> 2) & 0x1111_1111_1111_1111;
    let rows = fours & (fours >> 4) & 0x0101_0101_0101_0101;
    let mut left = needed;
    while left != 0 {
        let bit = left.trailing_zeros();
        let (block, covered) = if rows >> (bit & !7) & 1 == 1 {
            (ROWS as u32 + bit / 8, 0xffu64 << (bit & !7))
        } else if fours >> (bit & !3) & 1 == 1 {
            (FOURS as u32 + bit / 4, 0xf << (bit & !3))
        } else if pairs >> (bit & !1) & 1 == 1 {
            (PAIRS as u32 + bit / 2, 0x3 << (bit & !1))
        } else {
            (bit, 1 << bit)
        };
        blocks.push(base + block);
        left &= !covered;
    }
}
