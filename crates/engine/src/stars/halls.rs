//! The graph in other tiles: cells that one of them sees, rather than squares of the lattice. No wall runs through
//! such a tile, so that its cells are reached alike, and it sees fewer others.

use std::cmp::Reverse;
use std::collections::VecDeque;

use super::super::graph::{Graph, for_each_bit};
use super::super::tiles::Tiles;

/// Cells of a tile.
const FULL: usize = 64;

/// Groups smaller than this look for another to join.
const SMALL: usize = 48;

const NONE: u32 = u32::MAX;

/// The same graph in tiles whose cells are joined by sight within the tile: steps to them from anywhere differ by
/// less than 64. Places of the tiles are not kept.
pub fn by_halls(graph: &Graph) -> Graph {
    let groups = gather(graph);
    let mut halls: Vec<Vec<u32>> = Vec::new();
    let mut hall_of = vec![NONE; groups.len()];
    let joined = join(graph, &groups);
    for (i, group) in groups.into_iter().enumerate() {
        let hall = &mut hall_of[joined[i] as usize];
        if *hall == NONE {
            *hall = halls.len() as u32;
            halls.push(Vec::with_capacity(FULL));
        }
        halls[*hall as usize].extend(group);
    }
    renumber(graph, &halls)
}

/// Every rank in one group: the nearest to a seed, on foot, of those that it sees and no group has.
fn gather(graph: &Graph) -> Vec<Vec<u32>> {
    let mut groups: Vec<Vec<u32>> = Vec::new();
    // The last seed that met a rank, and whether a group has it.
    let mut met = vec![(NONE, false); graph.len()];
    let mut border = VecDeque::new();
    let mut queue = VecDeque::new();
    let mut all = 0..graph.len() as u32;
    while let Some(seed) = border.pop_front().or_else(|| all.next()) {
        if met[seed as usize].1 {
            continue;
        }
        let (tiles, masks) = graph.row(seed as usize);
        let mut group = Vec::with_capacity(FULL);
        queue.push_back(seed);
        while let Some(at) = queue.pop_front() {
            if group.len() == FULL {
                border.push_back(at);
                continue;
            }
            met[at as usize].1 = true;
            group.push(at);
            graph.for_each_beside(at as usize, |to| {
                let (by, is_taken) = met[to];
                if is_taken || by == seed {
                    return;
                }
                met[to].0 = seed;
                let (tile, bit) = graph.tiles.slot_of[to];
                let is_seen = tiles.binary_search(&tile).is_ok_and(|i| masks[i] >> bit & 1 == 1);
                if is_seen { &mut queue } else { &mut border }.push_back(to as u32);
            });
        }
        groups.push(group);
    }
    groups
}

/// For every group the one that stands for it: small ones join the group of which they see most and that has room.
fn join(graph: &Graph, groups: &[Vec<u32>]) -> Vec<u32> {
    let mut group_of = vec![0; graph.len()];
    for (i, group) in (0u32..).zip(groups) {
        group.iter().for_each(|&rank| group_of[rank as usize] = i);
    }
    let mut joined: Vec<u32> = (0..groups.len() as u32).collect();
    let mut size: Vec<usize> = groups.iter().map(Vec::len).collect();
    let mut seen = vec![0u32; groups.len()];
    let mut touched = Vec::new();
    let mut small: Vec<u32> = joined.iter().copied().filter(|&i| size[i as usize] < SMALL).collect();
    small.sort_by_key(|&i| size[i as usize]);
    for i in small {
        let own = stands_for(&joined, i);
        for &rank in &groups[i as usize] {
            graph.for_each_rank(rank as usize, |other| {
                let h = stands_for(&joined, group_of[other]);
                if seen[h as usize] == 0 {
                    touched.push(h);
                }
                seen[h as usize] += 1;
            });
        }
        let has_room = |&h: &u32| h != own && size[h as usize] + size[own as usize] <= FULL;
        let best = touched.iter().copied().filter(has_room).max_by_key(|&h| (seen[h as usize], Reverse(h)));
        touched.drain(..).for_each(|h| seen[h as usize] = 0);
        if let Some(best) = best {
            joined[own as usize] = best;
            size[best as usize] += size[own as usize];
        }
    }
    (0..groups.len() as u32).map(|i| stands_for(&joined, i)).collect()
}

fn stands_for(joined: &[u32], mut group: u32) -> u32 {
    while joined[group as usize] != group {
        group = joined[group as usize];
    }
    group
}

fn renumber(graph: &Graph, halls: &[Vec<u32>]) -> Graph {
    let old = &graph.tiles;
    let mut tiles = Tiles { rank_of: vec![0; graph.len()], ..Tiles::default() };
    // New tile and bit of every old tile and bit, six bits a bit.
    let mut slot = vec![0u32; old.count() * 64];
    for (t, hall) in (0u32..).zip(halls) {
        tiles.occupied.push(u64::MAX >> (FULL - hall.len()));
        tiles.first_rank.push(tiles.vertex_of.len() as u32);
        for (bit, &rank) in (0u8..).zip(hall) {
            let (old_tile, old_bit) = old.slot_of[rank as usize];
            slot[old_tile as usize * 64 + usize::from(old_bit)] = t << 6 | u32::from(bit);
            let v = old.vertex_of[rank as usize];
            tiles.rank_of[v as usize] = tiles.vertex_of.len() as u32;
            tiles.vertex_of.push(v);
            tiles.slot_of.push((t, bit));
        }
    }
    tiles.first_rank.push(graph.len() as u32);
    let mut new = Graph { tiles: tiles.into(), start: vec![0], ..Graph::default() };
    let mut masks = vec![0u64; halls.len()];
    let mut touched = Vec::new();
    for &rank in halls.iter().flatten() {
        let (tiles, seen) = graph.row(rank as usize);
        for (&t, &mask) in tiles.iter().zip(seen) {
            for_each_bit(mask, |bit| {
                let slot = slot[t as usize * 64 + bit as usize];
                let mask = &mut masks[(slot >> 6) as usize];
                if *mask == 0 {
                    touched.push(slot >> 6);
                }
                *mask |= 1 << (slot & 63);
            });
        }
        touched.sort_unstable();
        for t in touched.drain(..) {
            new.entry_tile.push(t);
            new.entry_mask.push(std::mem::take(&mut masks[t as usize]));
        }
        new.start.push(new.entry_tile.len());
        new.degree.push(graph.degree[rank as usize]);
    }
    new
}
