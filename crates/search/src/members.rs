//! The diverse set: how far apart its members stand, and the best set an archive can give.

use super::archive::Archive;
use super::space::square_distance;

/// Sharpness of the soft minimum: with 30 the nearest neighbour decides, the others break ties.
const SHARPNESS: i32 = 30;

/// Soft minimum of distances, `(Σ d^-30)^(-1/30)`; 0 if one is 0.
pub(super) fn soft_minimum(distances: impl Iterator<Item = f64> + Clone) -> f64 {
    let least = distances.clone().fold(f64::INFINITY, f64::min);
    if least <= 0.0 || !least.is_finite() {
        return least.max(0.0);
    }
    let sum: f64 = distances.map(|d| (least / d).powi(SHARPNESS)).sum();
    least * sum.powf(-1.0 / f64::from(SHARPNESS))
}

/// How far point `i` stands from all members but the `skip`-th.
pub(super) fn key(archive: &Archive, members: &[usize], skip: usize, i: usize) -> f64 {
    let others = members.iter().enumerate().filter(|&(m, _)| m != skip);
    soft_minimum(others.map(|(_, &member)| archive.distance(i, member)))
}

/// [`key`] of point `i` if it exceeds `least`: most points fail on one distance already.
pub(super) fn key_above(
    archive: &Archive,
    members: &[usize],
    skip: usize,
    i: usize,
    least: f64,
) -> Option<f64> {
    let others = members.iter().enumerate().filter(|&(m, _)| m != skip);
    let near = |(_, &member): (usize, &usize)| {
        square_distance(archive.unit(i), archive.unit(member)) > least * least
    };
    if !others.into_iter().all(near) {
        return None;
    }
    Some(key(archive, members, skip, i)).filter(|&k| k > least)
}

/// The two members that stand closest, as positions, and their distance; of two at least one may move.
pub(super) fn closest_pair(
    archive: &Archive,
    members: &[usize],
    moves: impl Fn(usize) -> bool,
) -> Option<(usize, usize, f64)> {
    let mut found: Option<(usize, usize, f64)> = None;
    for a in 0..members.len() {
        for b in (a + 1..members.len()).filter(|&b| moves(a) || moves(b)) {
            let distance = archive.distance(members[a], members[b]);
            if found.is_none_or(|(_, _, least)| distance < least) {
                found = Some((a, b, distance));
            }
        }
    }
    found
}

/// Smallest distance between two members; 0 for fewer than two.
pub(super) fn min_distance(archive: &Archive, members: &[usize]) -> f64 {
    closest_pair(archive, members, |_| true).map_or(0.0, |(_, _, d)| d)
}

/// Chooses up to `count` of `pool` that stand far apart: greedy max-min from `fixed`, which stay and are
/// at least one, then swaps as long as they help. Points at the same place as a member are never added.
pub(super) fn select(archive: &Archive, pool: &[usize], fixed: &[usize], count: usize) -> Vec<usize> {
    let mut members = fixed.to_vec();
    let to_fixed = |&i: &usize| fixed.iter().map(|&f| archive.distance(i, f)).fold(f64::INFINITY, f64::min);
    let mut nearest: Vec<f64> = pool.iter().map(to_fixed).collect();
    while members.len() < count {
        let far = (0..pool.len()).reduce(|a, b| if nearest[b] > nearest[a] { b } else { a });
        let Some(far) = far.filter(|&f| nearest[f] > 0.0) else { break };
        members.push(pool[far]);
        for (near, &i) in nearest.iter_mut().zip(pool) {
            *near = near.min(archive.distance(i, pool[far]));
        }
    }
    improve_by_swaps(archive, pool, &mut members, fixed.len());
    members
}

/// Most swaps one call makes: each lengthens the shortest distance, so few are ever needed.
const MOST_SWAPS: usize = 40;

/// Exchanges one of the closest pair for a pool point that stands farther off, until none does.
/// The first `fixed` members stay.
pub(super) fn improve_by_swaps(archive: &Archive, pool: &[usize], members: &mut [usize], fixed: usize) {
    for _ in 0..MOST_SWAPS {
        let Some((a, b, _)) = closest_pair(archive, members, |m| m >= fixed) else { return };
        let mut gain: Option<(usize, usize, f64)> = None;
        for m in [a, b].into_iter().filter(|&m| m >= fixed) {
            let now = key(archive, members, m, members[m]);
            for &i in pool {
                let than = now + gain.map_or(0.0, |g| g.2).max(1e-12);
                if let Some(key) = key_above(archive, members, m, i, than) {
                    gain = Some((m, i, key - now));
                }
            }
        }
        let Some((m, i, _)) = gain else { return };
        members[m] = i;
    }
}
