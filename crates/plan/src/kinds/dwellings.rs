//! Which rooms make one dwelling: those that doors join without a way that several share.

use std::collections::{BTreeMap, BTreeSet};

use super::super::axes::OpeningKind;
use super::super::floor::Beside;
use super::words::dwelling_of_name;
use super::{RoomKind, RoomKindFound, RoomsKnown};

/// The dwelling of every room, from 0 in the order of their first rooms.
pub(super) fn dwellings(known: &RoomsKnown<'_>, found: &[RoomKindFound]) -> Vec<Option<usize>> {
    let joins = joins(known);
    let named = by_names(known, found, &joins);
    let of = if named.iter().flatten().collect::<BTreeSet<_>>().len() > 1 {
        named
    } else {
        by_doors(found, &joins)
    };
    numbered(&of)
}

/// Which rooms each room is joined with.
type Joins = Vec<BTreeSet<usize>>;

fn joins(known: &RoomsKnown<'_>) -> Joins {
    let mut out = vec![BTreeSet::new(); known.rooms.len()];
    for way in known.ways.iter().filter(|w| w.kind != OpeningKind::Window) {
        if let [Beside::Room(a), Beside::Room(b)] = way.beside
            && a.max(b) < out.len()
            && a != b
        {
            out[a].insert(b);
            out[b].insert(a);
        }
    }
    out
}

/// Groups numbered in the order of their first rooms.
fn numbered(of: &[Option<usize>]) -> Vec<Option<usize>> {
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    of.iter()
        .map(|group| {
            group.map(|g| {
                let next = numbers.len();
                *numbers.entry(g).or_insert(next)
            })
        })
        .collect()
}

/// Groups by what is written in the rooms, `Flat B`; rooms without go with those that they alone are joined with.
fn by_names(known: &RoomsKnown<'_>, found: &[RoomKindFound], joins: &Joins) -> Vec<Option<usize>> {
    let mut names: Vec<String> = Vec::new();
    let mut group = |texts: &Vec<String>| {
        let name = texts.iter().find_map(|t| dwelling_of_name(t))?;
        let at = names.iter().position(|n| *n == name);
        Some(at.unwrap_or_else(|| {
            names.push(name);
            names.len() - 1
        }))
    };
    let mut of: Vec<Option<usize>> = known.texts.iter().map(&mut group).collect();
    of.resize(known.rooms.len(), None);
    // A room joined with two dwellings is shared by them.
    loop {
        let open = |r: &usize| of[*r].is_none() && found[*r].kind != RoomKind::Stair;
        let next = (0..of.len()).filter(open).find_map(|r| {
            let beside: BTreeSet<usize> = joins[r].iter().filter_map(|j| of[*j]).collect();
            (beside.len() == 1).then(|| Some((r, *beside.first()?))).flatten()
        });
        let Some((room, dwelling)) = next else { return of };
        of[room] = Some(dwelling);
    }
}

/// The parts that rooms fall into when some are left out.
fn parts(joins: &Joins, without: &BTreeSet<usize>) -> Vec<Option<usize>> {
    let mut of = vec![None; joins.len()];
    for start in 0..joins.len() {
        if of[start].is_some() || without.contains(&start) {
            continue;
        }
        let mut stack = vec![start];
        of[start] = Some(start);
        while let Some(room) = stack.pop() {
            for next in joins[room].iter().filter(|n| !without.contains(*n)) {
                if of[*next].is_none() {
                    of[*next] = Some(start);
                    stack.push(*next);
                }
            }
        }
    }
    of
}

/// How many cook and wash in a group.
#[derive(Clone, Copy, Debug, Default)]
struct Homely {
    rooms: usize,
    kitchens: usize,
    baths: usize,
    beds: usize,
}

impl Homely {
    /// Whether somebody can live there.
    fn is_whole(self) -> bool {
        self.kitchens > 0 && self.baths > 0
    }

    /// Whether it is the sleeping storey of a dwelling.
    fn is_upper(self) -> bool {
        self.beds > 0 && self.baths > 0 && self.rooms >= UPPER_ROOMS
    }
}

/// A part of a floor that no door joins with the rest, and that has no kitchen, is a storey of a dwelling from so many rooms
/// on.
const UPPER_ROOMS: usize = 3;

fn homely(found: &[RoomKindFound], of: &[Option<usize>]) -> BTreeMap<usize, Homely> {
    let mut out: BTreeMap<usize, Homely> = BTreeMap::new();
    for (group, room) in of.iter().zip(found) {
        let Some(group) = group else { continue };
        let h = out.entry(*group).or_default();
        h.rooms += 1;
        match room.kind {
            RoomKind::Kitchen if room.is_sure => h.kitchens += 1,
            RoomKind::Bath | RoomKind::Wc if room.is_sure => h.baths += 1,
            RoomKind::Bedroom | RoomKind::Living => h.beds += 1,
            _ => {}
        }
    }
    out
}

/// Groups that doors join; where leaving out one way, or the stairs, leaves several of which each has a kitchen and a bath,
/// these are dwellings.
fn by_doors(found: &[RoomKindFound], joins: &Joins) -> Vec<Option<usize>> {
    let dwells = found.iter().filter(|f| f.kind.is_of_dwelling()).count();
    let works = found.iter().filter(|f| f.kind.is_of_work()).count();
    if dwells == 0 || works > dwells {
        return vec![None; found.len()];
    }
    let stairs: BTreeSet<usize> = (0..found.len()).filter(|r| found[*r].kind == RoomKind::Stair).collect();
    let whole = |of: &Vec<Option<usize>>| homely(found, of).values().filter(|h| h.is_whole()).count();
    let is_way = |r: &usize| {
        matches!(found[*r].kind, RoomKind::Hall | RoomKind::Corridor | RoomKind::Other | RoomKind::Outside)
    };
    let one_less = (0..found.len()).filter(is_way).map(|r| {
        let mut without = stairs.clone();
        without.insert(r);
        without
    });
    let tries = [BTreeSet::new(), stairs.clone()].into_iter().chain(one_less).map(|w| parts(joins, &w));
    let best = tries.enumerate().max_by_key(|(k, of)| (whole(of), std::cmp::Reverse(*k))).map(|t| t.1);
    let Some(of) = best else { return vec![None; found.len()] };
    let lives = homely(found, &of);
    let apart = parts(joins, &stairs);
    let uppers = homely(found, &apart);
    if lives.values().all(|h| !h.is_whole()) && uppers.values().filter(|h| h.is_upper()).count() > 1 {
        return apart.into_iter().map(|g| g.filter(|g| uppers[g].is_upper())).collect();
    }
    if lives.values().filter(|h| h.is_whole()).count() > 1 {
        return of.into_iter().map(|g| g.filter(|g| lives[g].is_whole())).collect();
    }
    // One dwelling, as far as is known: with all that is inside.
    found.iter().map(|f| (f.kind != RoomKind::Outside).then_some(0)).collect()
}
