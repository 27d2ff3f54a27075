//! Sets of works that are made together: each work alone, all pairs of the best, longer ones by beam.
//!
//! What a set shows is counted exactly: what each shows alone, and what is seen through two of them, as often as there are two.
//! Two openings in line show more than both alone, and two into one room less.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use rayon::prelude::*;

use enfilade_config::Budget;
use enfilade_report::{Cancel, Error};
use enfilade_works::counts::{Shows, more_together};
use enfilade_works::{Change, RoomId, Site, Work};

/// Works of which all pairs are counted, the best of each pair of rooms: what a longer list adds, nobody would build.
pub(super) const BEST: usize = 100;
/// … fewer on floors where a look through a work takes long: pairs times edges of the visibility graph, for speed alone.
const PAIR_EDGES: f64 = 6.0e8;
/// Pairs to which a third work is added, the best: for speed alone.
const BEAM: usize = 8;
/// Works that an option has at most: four or more make another plan, and no architect reads them as one idea.
pub(super) const MOST: usize = 3;

/// A set of works with what it shows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Counted {
    /// Places in the list of works, ascending.
    pub works: Vec<usize>,
    /// Ordered pairs of cells that see each other afterwards and do not now, less those lost.
    pub gained: i64,
    /// Wall that goes and wall that is built, metres.
    pub effort_m: f64,
}

/// Where sets are looked for.
#[derive(Clone, Copy)]
pub(super) struct Sets<'a> {
    /// The present layout.
    pub site: &'a Site<'a>,
    /// All works, those that bring most first.
    pub works: &'a [Work],
    /// What they may cost together.
    pub budget: Budget,
    /// What each of them shows alone, counted as a whole once it is asked for.
    pub alone: &'a [OnceLock<i64>],
}

impl Sets<'_> {
    /// Each of some works alone, and all sets of them that were counted, whatever they cost; those that show most first.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn all(&self, among: &[usize], cancel: &Cancel) -> Result<Vec<Counted>, Error> {
        let singles = self.singles(among);
        let edges = self.site.present.graph.edge_count().max(1) as f64;
        let afforded = (2.0 * PAIR_EDGES / edges).sqrt() as usize;
        let best: Vec<usize> = among.iter().copied().take(BEST.min(afforded)).collect();
        let behind = |set: &Counted| match set.works.last() {
            Some(last) => best.iter().position(|w| w == last).map_or(best.len(), |i| i + 1),
            None => 0,
        };
        let firsts: Vec<&Counted> = singles.iter().filter(|s| best.contains(&s.works[0])).collect();
        let pairs = firsts
            .par_iter()
            .flat_map_iter(|first| self.with_one_more(first, &best[behind(first)..], cancel));
        let mut pairs: Vec<Counted> = pairs.collect();
        cancel.check()?;
        sort(&mut pairs);
        let longer =
            pairs.par_iter().take(BEAM).flat_map_iter(|pair| self.with_one_more(pair, &best, cancel));
        let mut out: Vec<Counted> = longer.collect();
        cancel.check()?;
        out.extend(pairs);
        out.extend(singles);
        sort(&mut out);
        let mut seen = BTreeSet::new();
        out.retain(|s| seen.insert(s.works.clone()));
        Ok(out)
    }

    /// The same set in other sizes: each of its works in any that join the same rooms, by the place in the set.
    ///
    /// # Errors
    /// [`Error::Stopped`].
    pub fn sizes(&self, sizes: &[Vec<usize>], cancel: &Cancel) -> Result<Vec<Counted>, Error> {
        let mut out: Vec<Counted> = Vec::new();
        for (k, own) in sizes.iter().enumerate() {
            out = match k {
                0 => self.singles(own),
                _ => out.par_iter().flat_map_iter(|set| self.with_one_more(set, own, cancel)).collect(),
            };
            cancel.check()?;
        }
        Ok(out)
    }

    /// Whether the budget holds a set.
    pub fn is_within(&self, set: &Counted) -> bool {
        self.budget.holds(set.works.len(), set.effort_m)
    }

    /// Whether two works join the same rooms.
    pub fn joins_same(&self, a: usize, b: usize) -> bool {
        pair_of(&self.works[a]) == pair_of(&self.works[b])
    }

    /// The first of sets that join the same rooms.
    pub fn different(&self, sets: impl IntoIterator<Item = Counted>) -> Vec<Counted> {
        let mut seen = BTreeSet::new();
        let pairs = |s: &Counted| {
            let mut all: Vec<_> = s.works.iter().map(|w| pair_of(&self.works[*w])).collect();
            all.sort_unstable();
            all
        };
        sets.into_iter().filter(|s| seen.insert(pairs(s))).collect()
    }

    /// Each of some works alone.
    pub fn singles(&self, among: &[usize]) -> Vec<Counted> {
        among.iter().map(|w| self.alone(*w)).collect()
    }

    fn alone(&self, place: usize) -> Counted {
        let work = &self.works[place];
        Counted { works: vec![place], gained: work.gained, effort_m: work.demolished_m + work.built_m }
    }

    /// A set with each of some works that go together with it.
    fn with_one_more(&self, set: &Counted, more: &[usize], cancel: &Cancel) -> Vec<Counted> {
        let more: Vec<Counted> =
            more.iter().map(|w| self.alone(*w)).filter(|one| self.may_have(set, one)).collect();
        if more.is_empty() || cancel.check().is_err() {
            return Vec::new();
        }
        let present = &self.site.present;
        let before = self.change(&set.works);
        let together = |one: Counted| {
            let place = one.works[0];
            let change = &self.works[place].change;
            // Nothing is looked at while the place is locked: whoever waits there may be handed a set that wants it too.
            let known = self.alone[place].get().copied();
            let alone = known.unwrap_or_else(|| present.gained(&present.difference(change)));
            let added = self.alone[place].get_or_init(|| alone)
                + more_together(present.vista, present.is_query, [&before, change]);
            let mut works = [&set.works[..], &one.works].concat();
            works.sort_unstable();
            Counted { works, gained: set.gained + added, effort_m: set.effort_m + one.effort_m }
        };
        more.into_iter().map(together).collect()
    }

    fn may_have(&self, set: &Counted, one: &Counted) -> bool {
        let count = set.works.len() + 1;
        count <= MOST && set.works.iter().all(|w| self.go_together(*w, one.works[0]))
    }

    /// Whether two works touch neither the same wall nor join the same rooms.
    fn go_together(&self, a: usize, b: usize) -> bool {
        let apart = |a: &Work, b: &Work| a.walls.iter().all(|w| !b.walls.contains(w));
        apart(&self.works[a], &self.works[b]) && !self.joins_same(a, b)
    }

    /// All that a set does.
    fn change(&self, works: &[usize]) -> Change {
        works.iter().fold(Change::default(), |all, w| all.and(&self.works[*w].change))
    }

    /// Whether works together show of a private room what none of them shows alone, though its doors are shut.
    pub fn show_more_together(&self, works: &[usize]) -> bool {
        let present = &self.site.present;
        if works.len() < 2 {
            return false;
        }
        let alone = works.iter().flat_map(|w| present.difference(&self.works[*w].change).seen);
        let alone: BTreeSet<[u32; 2]> = alone.collect();
        let all = present.difference(&self.change(works)).seen;
        all.iter().any(|p| !alone.contains(p) && present.shows(p[0], p[1]) == Shows::Openly)
    }
}

/// The rooms that a work joins, whichever is named first.
fn pair_of(work: &Work) -> [Option<RoomId>; 2] {
    let mut pair = work.rooms;
    pair.sort_unstable();
    pair
}

/// Those that show most first; of two that show alike the smaller.
pub(super) fn sort(sets: &mut [Counted]) {
    sets.sort_by(|a, b| b.gained.cmp(&a.gained).then_with(|| a.works.cmp(&b.works)));
}

/// Those of sets in which each work more brings a share of what all bring.
pub(super) fn paying(sets: Vec<Counted>, share: f64) -> Vec<Counted> {
    let gained: BTreeMap<Vec<usize>, i64> = sets.iter().map(|s| (s.works.clone(), s.gained)).collect();
    let without = |set: &Counted, k: usize| {
        let mut less = set.works.clone();
        less.remove(k);
        gained.get(&less).copied().unwrap_or(0)
    };
    let pays = |set: &Counted| {
        let most = (0..set.works.len()).map(|k| without(set, k)).fold(0, i64::max);
        set.gained as f64 * (1.0 - share) >= most as f64
    };
    sets.into_iter().filter(|s| s.gained > 0 && pays(s)).collect()
}

/// The front of gain against effort, the cheapest first: no other set shows as much for less wall. Steps of less than a share
/// of the most are left out.
pub(super) fn front(sets: &[Counted], step: f64, most: usize) -> Vec<Counted> {
    let mut all: Vec<&Counted> = sets.iter().filter(|s| s.gained > 0).collect();
    // To the centimetre: who takes down seven metres counts no millimetres.
    let cost = |s: &Counted| (s.effort_m * 100.0).round() as i64;
    all.sort_by(|a, b| cost(a).cmp(&cost(b)).then_with(|| b.gained.cmp(&a.gained)));
    let best = all.iter().map(|s| s.gained).max().unwrap_or(0) as f64;
    let mut out: Vec<Counted> = Vec::new();
    for set in all {
        let known = out.last().map_or(0, |l| l.gained) as f64;
        if set.gained as f64 > known
            && (set.gained as f64 - known >= step * best || set.gained as f64 == best)
        {
            out.push(set.clone());
        }
    }
    while out.len() > most {
        // The one whose going is felt least.
        let rise = |k: usize| out[k + 1].gained - out[k - 1].gained;
        let least = (1..out.len() - 1).min_by_key(|k| rise(*k)).unwrap_or(0);
        out.remove(least);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(works: &[usize], gained: i64, effort_m: f64) -> Counted {
        Counted { works: works.to_vec(), gained, effort_m }
    }

    #[test]
    fn the_front_has_what_nothing_cheaper_reaches() {
        let all = [
            counted(&[0], 100, 2.0),
            counted(&[1], 90, 1.0),
            counted(&[2], 95, 3.0),
            counted(&[3], 101, 4.0),
            counted(&[0, 1], 180, 3.0),
            counted(&[4], -5, 0.1),
        ];
        let places = |step, most| -> Vec<Vec<usize>> {
            front(&all, step, most).into_iter().map(|s| s.works).collect()
        };
        assert_eq!(places(0.0, 9), [vec![1], vec![0], vec![0, 1]]);
        assert_eq!(places(0.2, 9), [vec![1], vec![0, 1]]);
        assert_eq!(places(0.0, 2), [vec![1], vec![0, 1]]);
    }

    #[test]
    fn a_work_more_must_bring_its_share() {
        let all = vec![counted(&[0, 1], 108, 3.0), counted(&[0], 100, 2.0), counted(&[1], 20, 1.0)];
        let left: Vec<usize> = paying(all, 0.1).iter().map(|s| s.works.len()).collect();
        assert_eq!(left, [1, 1]);
    }
}
