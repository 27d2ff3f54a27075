//! Breadth-first levels from many roots, by *stars*: a leader, and as lanes of a word the roots that it sees. Steps
//! from a root then differ from steps from the leader by -1, 0 or 1 at every cell. Two planes of words say it all, in
//! the order of the leader's levels `l`, and nothing is visited twice:
//!
//! ```text
//! nearer(v) = OR of nearer(w), w seen by v, l(w) = l(v) - 1
//! within(v) = OR of within(w), the same w, and of nearer(w), w seen by v, l(w) = l(v)
//! ```
//!
//! Far away all cells have one word. A tile *rests* on it while all tiles that it sees have that word or none yet:
//! then nothing else can come, and none of its cells is looked at. Leaders are lanes of other stars, whose planes
//! give their levels.

mod halls;
mod levels;
mod plan;
mod planes;
mod sight;
#[cfg(test)]
mod tests;
mod walk;

use std::sync::Mutex;

use self::levels::Levels;
use self::plan::Plan;
use self::planes::WORD;
use self::sight::Sight;
use self::walk::Walk;
use super::graph::Graph;
use super::lanes::Path;
use super::shares::Share;

/// Lanes that a star must have on average: with fewer, as where most cells see nobody, stars would be too many.
const LANES_MIN: usize = 8;

/// Vertices from which on stars are faster than waves, by a factor of 1.3 to 1.7 at 15,000 to 28,000 vertices of
/// degree 60 to 6,200, and more from there on; at 10,000 they take half to 1.5 times as long. Measured: BENCHMARKS.md,
/// "Stars".
const VERTICES_MIN: usize = 15_000;

/// Roots from which on the views and halls are worth their making: that takes as long as eight waves.
const ROOTS_MIN: usize = 4_096;

/// Mean degree from which on stars have 512 lanes rather than 64: twice as many lanes as the short word holds.
const WIDE_DEGREE: usize = 128;

/// Mean degree from which on halls cost more than they save. All takes 1.26 to 1.8 times as long with them at 6,200 to
/// 9,700, and 0.84 times as long at 720.
const PLAIN_DEGREE: usize = 2_000;

/// Levels from which on squares of a lattice may have cells more than 63 levels apart.
const LEVELS_MAX: u32 = 31;

/// How the stars of a graph are walked.
#[derive(Clone, Copy, Debug)]
struct Way {
    path: Path,
    /// Roots of a star: 64 or 512.
    lanes: usize,
    /// Whether tiles follow the rooms; without, only graphs of few levels are walked.
    by_halls: bool,
    /// Stars must have so many lanes on average.
    lanes_min: usize,
}

/// Vertices on level 1, 2, … of the roots (distinct) of a share, by their places among all roots; nothing where waves are
/// faster. A share is of stars, in an order in which most follow the one that gives their leader's levels.
///
/// The same on any number of threads. Memory: the graph once more, if its mean degree is below 2,000; 16 bytes for
/// each view between two tiles, 12 views a pair on average; for every star that waits for a thread 16 bytes a tile and
/// 8 for each level of it (100,000 vertices of degree 70: at most 40 wait, of 70 kB each); and for every thread as much
/// as ten of these.
pub(super) fn level_counts(graph: &Graph, roots: &[u32], share: Share) -> Option<Vec<(u32, Vec<u32>)>> {
    if graph.len() < VERTICES_MIN || roots.len() < ROOTS_MIN {
        return None;
    }
    let degree = (2 * graph.edge_count()) as usize / graph.len();
    let lanes = if degree < WIDE_DEGREE { 64 } else { 512 };
    level_counts_by(
        Way { path: Path::best(), lanes, by_halls: degree < PLAIN_DEGREE, lanes_min: LANES_MIN },
        graph,
        roots,
        share,
    )
}

fn level_counts_by(way: Way, graph: &Graph, roots: &[u32], share: Share) -> Option<Vec<(u32, Vec<u32>)>> {
    let halls = way.by_halls.then(|| halls::by_halls(graph));
    let graph = halls.as_ref().unwrap_or(graph);
    let plan = Plan::new(graph, roots, way.lanes, roots.len() / way.lanes_min + 1)?;
    let is_shallow = |&seed: &u32| {
        let leader = plan.stars[seed as usize].leader;
        way.by_halls || Levels::from(graph, leader, LEVELS_MAX).is_some()
    };
    if !plan.seeds.iter().all(is_shallow) {
        return None;
    }
    let own = plan.share(share);
    let sky = Sky { path: way.path, graph, sight: Sight::new(graph), plan, own };
    let mut by_rank = if way.lanes == WORD { sky.by_rank::<1>() } else { sky.by_rank::<8>() };
    let place_of = |(&v, place): (&u32, u32)| {
        let rank = graph.tiles.rank_of[v as usize];
        // Who sees nobody has no star.
        let is_own = if graph.degree[rank as usize] == 0 {
            share.is_first()
        } else {
            sky.own[sky.plan.star_of[rank as usize] as usize]
        };
        is_own.then(|| (place, std::mem::take(&mut by_rank[rank as usize])))
    };
    Some(roots.iter().zip(0..).filter_map(place_of).collect())
}

/// What all stars share.
struct Sky<'a> {
    path: Path,
    graph: &'a Graph,
    sight: Sight,
    plan: Plan,
    /// Whether each star is walked.
    own: Vec<bool>,
}

/// Walks that no thread uses, and levels by rank.
struct Work<'a, const W: usize> {
    idle: Mutex<Vec<Walk<'a, W>>>,
    levels: Mutex<Vec<Vec<u32>>>,
}

impl Sky<'_> {
    fn by_rank<const W: usize>(&self) -> Vec<Vec<u32>> {
        let levels = Mutex::new(vec![Vec::new(); self.graph.len()]);
        let work = &Work::<W> { idle: Mutex::default(), levels };
        rayon::scope(|scope| {
            for first in self.firsts() {
                scope.spawn(move |scope| {
                    let leader = self.plan.stars[first as usize].leader;
                    if let Some(levels) = Levels::from(self.graph, leader, u32::MAX) {
                        self.walk(scope, work, first, levels);
                    }
                });
            }
        });
        work.levels.lock().map(|mut levels| std::mem::take(&mut *levels)).unwrap_or_default()
    }

    /// Stars that are walked and whose leader's levels no other gives that is.
    fn firsts(&self) -> Vec<u32> {
        let mut is_given = vec![false; self.own.len()];
        let walked = self.plan.stars.iter().zip(&self.own).filter(|(_, is_own)| **is_own);
        walked.flat_map(|(star, _)| &star.children).for_each(|child| is_given[*child as usize] = true);
        let all = 0..self.own.len() as u32;
        all.filter(|s| self.own[*s as usize] && !is_given[*s as usize]).collect()
    }

    /// Walks a star, and leaves its children to this thread or an idle one.
    fn walk<'s, const W: usize>(
        &'s self,
        scope: &rayon::Scope<'s>,
        work: &'s Work<'s, W>,
        star: u32,
        levels: Levels,
    ) {
        let star = &self.plan.stars[star as usize];
        let taken = work.idle.lock().ok().and_then(|mut walks| walks.pop());
        let mut walk = taken.unwrap_or_else(|| Walk::new(self));
        walk.star(star, levels);
        let counts: Vec<Vec<u32>> = (0..star.lanes.len()).map(|lane| walk.counts_of(lane)).collect();
        if let Ok(mut levels) = work.levels.lock() {
            star.lanes.iter().zip(counts).for_each(|(&rank, counts)| levels[rank as usize] = counts);
        }
        for &child in star.children.iter().filter(|child| self.own[**child as usize]) {
            let leader = self.plan.stars[child as usize].leader;
            let Ok(lane) = star.lanes.binary_search(&leader) else { continue };
            let levels = walk.levels_of(lane);
            scope.spawn(move |scope| self.walk(scope, work, child, levels));
        }
        if let Ok(mut walks) = work.idle.lock() {
            walks.push(walk);
        }
    }
}
