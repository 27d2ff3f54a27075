//! How a layout stands to hard limits.

use crate::measure::study::{Study, divisor};
use crate::measure::worth::Worth;
use enfilade_config::{Aim, Bound, Held, Limit, Measure, Penalty, Settings};

/// A limit passed by less than this share of it is kept: written coordinates are rounded to 1 µm.
pub const LIMIT_TOLERANCE: f64 = 1e-6;

/// What a layout has of what a limit holds, and where the limit lies; both in the limit's own unit.
pub fn held(study: &Study, settings: &Settings, worth: &Worth, index: usize) -> (f64, f64) {
    let limit = &settings.limits[index];
    let value = |w: &Worth| match (limit.held, limit.bound) {
        (Held::Aim(Aim { measure: Measure::Score, .. }), _) => study.score(w, settings),
        (Held::Aim(Aim { measure: Measure::Penalty, .. }), _) => study.penalty(w, settings),
        (Held::Aim(aim), _) => study.value(w, aim),
        (Held::Penalty(Penalty::Clearance), _) => w.clearance_m2,
        (Held::Penalty(Penalty::WallLength), Bound::Change(_)) => w.wall_total_m,
        (Held::Penalty(penalty), _) => w.penalty(penalty),
    };
    match (limit.held, limit.bound) {
        (Held::Penalty(Penalty::Passage), Bound::At(width_m)) => {
            let is_passage = |l: &&Limit| l.held == limit.held;
            let nth = settings.limits[..index].iter().filter(is_passage).count() + 1;
            (width_m - worth.passages_m.get(nth).copied().unwrap_or(0.0), width_m)
        }
        (Held::Penalty(Penalty::RoomArea), Bound::Change(share)) => {
            let [least, most] = study.room_extremes(worth);
            (if limit.is_least { least } else { most }, share)
        }
        (_, Bound::At(at)) => (value(worth), at),
        (_, Bound::Change(share)) => {
            let present = value(&study.initial);
            (value(worth), present + share * divisor(present))
        }
    }
}

/// By how much a layout misses every limit, relative to it; 0: kept.
pub fn missed(study: &Study, settings: &Settings, worth: &Worth) -> Vec<f64> {
    let of = |index: usize| {
        let (value, bound) = held(study, settings, worth, index);
        let lacks = if settings.limits[index].is_least { bound - value } else { value - bound };
        let share = lacks / divisor(bound);
        if share > LIMIT_TOLERANCE || share.is_nan() { share } else { 0.0 }
    };
    (0..settings.limits.len()).map(of).collect()
}
