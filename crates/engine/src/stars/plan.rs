//! Which stars cover the roots: greedily, each round a leader that an earlier star has covered.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::super::graph::{Graph, for_each_bit};
use super::super::shares::Share;

/// Roots that one leader sees (and itself, if it is one), walked together.
pub struct Star {
    /// Rank of the cell from which the levels are counted.
    pub leader: u32,
    /// Ranks of the roots, ascending.
    pub lanes: Vec<u32>,
    /// Stars whose leaders are lanes of this one.
    pub children: Vec<u32>,
}

/// Trees of stars; each root that sees anything is a lane of one star.
#[derive(Default)]
pub struct Plan {
    pub stars: Vec<Star>,
    /// The stars whose leaders are no lanes.
    pub seeds: Vec<u32>,
    /// Star of every rank that is a lane.
    pub star_of: Vec<u32>,
}

struct Cover<'a> {
    graph: &'a Graph,
    lanes: usize,
    /// Roots without a star, by tile.
    open: Vec<u64>,
    /// Leaders by the roots they would add, when they were last counted.
    heap: BinaryHeap<(usize, Reverse<u32>)>,
    plan: Plan,
}

impl Plan {
    /// Stars of at most `lanes` roots, or nothing if there would have to be more than `stars_max`.
    pub fn new(graph: &Graph, roots: &[u32], lanes: usize, stars_max: usize) -> Option<Self> {
        let mut cover = Cover {
            graph,
            lanes,
            open: vec![0; graph.tiles.count()],
            heap: BinaryHeap::new(),
            plan: Self { star_of: vec![u32::MAX; graph.len()], ..Self::default() },
        };
        let rank_of = |&v: &u32| graph.tiles.rank_of[v as usize];
        let mut ranks: Vec<u32> =
            roots.iter().map(rank_of).filter(|&r| graph.degree[r as usize] > 0).collect();
        ranks.sort_unstable();
        for &rank in &ranks {
            let (tile, bit) = graph.tiles.slot_of[rank as usize];
            cover.open[tile as usize] |= 1 << bit;
        }
        for &seed in &ranks {
            if cover.is_open(seed) {
                cover.plan.seeds.push(cover.plan.stars.len() as u32);
                cover.add(seed);
            }
            while let Some((was, Reverse(leader))) = cover.heap.pop() {
                let gain = cover.gain(leader);
                if gain == was {
                    let parent = cover.plan.star_of[leader as usize] as usize;
                    let star = cover.plan.stars.len() as u32;
                    cover.plan.stars[parent].children.push(star);
                    cover.add(leader);
                } else if gain > 0 {
                    cover.heap.push((gain, Reverse(leader)));
                }
            }
            if cover.plan.stars.len() > stars_max {
                return None;
            }
        }
        Some(cover.plan)
    }

    /// Whether each star is of a share. They follow each other as trees are walked, a star before its children: a cut
    /// leaves few of them without the star that gives their leader's levels.
    pub fn share(&self, share: Share) -> Vec<bool> {
        let mut left: Vec<u32> = self.seeds.iter().rev().copied().collect();
        let mut order = Vec::with_capacity(self.stars.len());
        while let Some(star) = left.pop() {
            order.push(star);
            left.extend(self.stars[star as usize].children.iter().rev());
        }
        let mut is_own = vec![false; self.stars.len()];
        share.of(&order).iter().for_each(|star| is_own[*star as usize] = true);
        is_own
    }
}

impl Cover<'_> {
    fn is_open(&self, rank: u32) -> bool {
        let (tile, bit) = self.graph.tiles.slot_of[rank as usize];
        self.open[tile as usize] >> bit & 1 == 1
    }

    /// Lanes that a star with this leader would have, itself not counted.
    fn gain(&self, leader: u32) -> usize {
        let (tiles, masks) = self.graph.row(leader as usize);
        let seen = tiles.iter().zip(masks).map(|(&t, m)| (m & self.open[t as usize]).count_ones() as usize);
        seen.sum::<usize>().min(self.lanes)
    }

    /// The star of a leader: of the roots that it sees those in the nearest tiles by number, which follow the plan.
    fn add(&mut self, leader: u32) {
        let tiles = &self.graph.tiles;
        let own = tiles.slot_of[leader as usize].0;
        let mut lanes = Vec::new();
        if self.is_open(leader) {
            lanes.push((0, leader));
        }
        let (seen, masks) = self.graph.row(leader as usize);
        for (&t, &mask) in seen.iter().zip(masks) {
            for_each_bit(mask & self.open[t as usize], |bit| {
                lanes.push((t.abs_diff(own), tiles.rank(t, bit) as u32));
            });
        }
        if lanes.len() > self.lanes {
            lanes.select_nth_unstable(self.lanes);
            lanes.truncate(self.lanes);
        }
        let mut lanes: Vec<u32> = lanes.into_iter().map(|lane| lane.1).collect();
        lanes.sort_unstable();
        for &rank in &lanes {
            let (tile, bit) = tiles.slot_of[rank as usize];
            self.open[tile as usize] &= !(1 << bit);
            self.plan.star_of[rank as usize] = self.plan.stars.len() as u32;
        }
        let is_lane = self.plan.star_of[leader as usize] != u32::MAX;
        let again = (is_lane && lanes.binary_search(&leader).is_err()).then_some(leader);
        for &rank in lanes.iter().chain(&again) {
            let gain = self.gain(rank);
            if gain > 0 {
                self.heap.push((gain, Reverse(rank)));
            }
        }
        self.plan.stars.push(Star { leader, lanes, children: Vec::new() });
    }
}
