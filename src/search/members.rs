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

/// The two members that stand closest, as positions, and their distance; of the first `fixed`, which
/// never move, no two.
pub(super) fn closest_pair(
    archive: &Archive,
    members: &[usize],
    fixed: usize,
) -> Option<(usize, usize, f64)> {
    let mut found: Option<(usize, usize, f64)> = None;
    for a in 0..members.len() {
        for b in (a + 1).max(fixed)..members.len() {
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
    closest_pair(archive, members, 0).map_or(0.0, |(_, _, d)| d)
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
        let Some((a, b, _)) = closest_pair(archive, members, fixed) else { return };
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

/// Sets up to this size are searched for three members that change places together, larger ones for two.
const FEW_MEMBERS: usize = 8;
/// Most points that are looked through for two places and for three: the newest are kept.
const MOST_SURVIVORS: [usize; 2] = [600, 200];

/// Exchanges two or three members at once for pool points, as long as the shortest distance grows: a set from
/// which no single exchange leads on is often one of these steps short of a wider one. The first `fixed` stay.
pub(super) fn improve_together(archive: &Archive, pool: &[usize], members: &mut [usize], fixed: usize) {
    let most_together = if members.len() <= FEW_MEMBERS { 3 } else { 2 };
    for _ in 0..MOST_SWAPS {
        let Some((a, b, least)) = closest_pair(archive, members, fixed) else { return };
        let free: Vec<usize> = (fixed..members.len()).collect();
        let wider = (2..=most_together).find_map(|size| {
            let leaving = subsets(&free, size).into_iter().filter(|s| s.contains(&a) || s.contains(&b));
            leaving.into_iter().find_map(|s| replacements(archive, pool, members, &s, least).map(|r| (s, r)))
        });
        let Some((leaving, coming)) = wider else { return };
        for (m, i) in leaving.into_iter().zip(coming) {
            members[m] = i;
        }
        improve_by_swaps(archive, pool, members, fixed);
    }
}

/// All subsets of `size` elements, in order.
fn subsets(of: &[usize], size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![vec![]];
    }
    let with_first = |k: usize| {
        let rest = subsets(&of[k + 1..], size - 1);
        rest.into_iter().map(move |r| std::iter::once(of[k]).chain(r).collect())
    };
    (0..of.len()).flat_map(with_first).collect()
}

/// As many pool points as there are `leaving`, all farther than `least` from the members that stay and from
/// each other.
fn replacements(
    archive: &Archive,
    pool: &[usize],
    members: &[usize],
    leaving: &[usize],
    least: f64,
) -> Option<Vec<usize>> {
    let beyond = (least + LEAST_GAIN) * (least + LEAST_GAIN);
    let is_far = |i: usize, j: usize| square_distance(archive.unit(i), archive.unit(j)) > beyond;
    let staying: Vec<usize> =
        (0..members.len()).filter(|m| !leaving.contains(m)).map(|m| members[m]).collect();
    let most = MOST_SURVIVORS[leaving.len().min(3) - 2];
    let survives = |i: &usize| staying.iter().all(|&s| is_far(*i, s));
    let mut survivors: Vec<usize> = pool.iter().rev().copied().filter(survives).take(most).collect();
    survivors.reverse();
    mutually(&survivors, leaving.len(), &is_far)
}

/// Growth of the shortest distance that is worth an exchange.
const LEAST_GAIN: f64 = 1e-9;

/// The first `count` points that are all far from each other.
fn mutually(points: &[usize], count: usize, is_far: &impl Fn(usize, usize) -> bool) -> Option<Vec<usize>> {
    if count == 0 {
        return Some(vec![]);
    }
    points.iter().enumerate().find_map(|(k, &first)| {
        let rest: Vec<usize> = if count == 1 {
            vec![]
        } else {
            points[k + 1..].iter().copied().filter(|&i| is_far(first, i)).collect()
        };
        let found = (rest.len() + 1 >= count).then(|| mutually(&rest, count - 1, is_far)).flatten()?;
        Some(std::iter::once(first).chain(found).collect())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::Evaluation;

    fn archive(points: &[[f64; 2]]) -> Archive {
        let mut archive = Archive::new(2, 0);
        for p in points {
            archive.push(p, p.to_vec(), &Evaluation::default(), &[]);
        }
        archive
    }

    #[test]
    fn two_move_together_where_no_single_exchange_helps() {
        // Two at the middles of opposite sides; the two others, close to the first, block the corners.
        let points = [
            [0.5, 0.0],
            [0.5, 1.0],
            [0.0, 0.5],
            [0.45, 0.45],
            [0.0, 0.0],
            [1.0, 1.0],
            [0.0, 1.0],
            [1.0, 0.0],
        ];
        let archive = archive(&points);
        let pool: Vec<usize> = (0..points.len()).collect();
        let mut members = vec![0, 1, 2, 3];
        improve_together(&archive, &pool, &mut members, 0);
        assert!((min_distance(&archive, &members) - 1.0).abs() < 1e-12, "{members:?}");
        let mut members = vec![0, 1, 2, 3];
        improve_together(&archive, &pool, &mut members, 1);
        assert_eq!(members[0], 0);
        assert!(min_distance(&archive, &members) > 0.499, "{members:?}");
    }

    #[test]
    fn subsets_are_all_there() {
        assert_eq!(subsets(&[1, 2, 3], 2), [[1, 2], [1, 3], [2, 3]]);
        assert_eq!(subsets(&[1], 2), Vec::<Vec<usize>>::new());
    }
}
