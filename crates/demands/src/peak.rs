//! The highest value over a floor of what changes by no more than a metre a metre.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;

/// How near the highest value is found, metres: half of what is promised.
pub(crate) const NEAR_M: f64 = 0.005;

/// Most squares that are looked at: a floor of a hectare is done with a tenth of them.
const SQUARES_MAX: usize = 200_000;

struct Square {
    at: DVec2,
    half: f64,
    most: f64,
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Square {}

impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Square {
    fn cmp(&self, other: &Self) -> Ordering {
        let place = |s: &Self| (s.at.x, s.at.y);
        let by_place =
            place(other).0.total_cmp(&place(self).0).then(place(other).1.total_cmp(&place(self).1));
        self.most.total_cmp(&other.most).then(by_place)
    }
}

/// A point of the floor near to where one looked, and the value there.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    /// The point.
    pub at: DVec2,
    /// Its value; what is not reached has minus infinity.
    pub value: f64,
}

/// Where a value is highest in a box, and how high, to within `near_m`. `look` takes a point to the nearest of the floor.
pub(crate) fn peak(
    [lo, hi]: [DVec2; 2],
    first_m: f64,
    near_m: f64,
    start: Option<Look>,
    look: impl Fn(DVec2) -> Option<Look>,
) -> Option<Look> {
    let mut best = start;
    let mut squares = BinaryHeap::new();
    let open = |at: DVec2, half: f64, best: &mut Option<Look>| {
        let found = look(at)?;
        let (reach, far) = (half * std::f64::consts::SQRT_2, found.at.distance(at));
        if best.is_none_or(|b| found.value > b.value) {
            *best = Some(found);
        }
        (far <= reach).then_some(Square { at, half, most: found.value + far + reach })
    };
    let counts = ((hi - lo) / first_m).ceil().max(DVec2::ONE);
    for i in 0..counts.x as usize {
        for j in 0..counts.y as usize {
            let at = lo + DVec2::new(i as f64 + 0.5, j as f64 + 0.5) * first_m;
            squares.extend(open(at, first_m / 2.0, &mut best));
        }
    }
    for _ in 0..SQUARES_MAX {
        let Some(square) = squares.pop() else { break };
        if best.is_some_and(|b| square.most <= b.value + near_m) {
            break;
        }
        let half = square.half / 2.0;
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            squares.extend(open(square.at + DVec2::new(x, y) * half, half, &mut best));
        }
    }
    best
}
