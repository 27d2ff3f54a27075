//! What is looked through, as a viewer has it above: the slopes between which his sight is swept.

use crate::geometry::PointUm;
use crate::strips::Fraction;

/// The corners of a convex polygon, at least two; drawing frame, whole micrometres.
pub type Window = Vec<PointUm>;

/// A line that passes a window by less passes through it, micrometres: what is cut at a window ends on whole ones.
const RIM_UM: f64 = 2.0;

/// Slopes of views are whole multiples of one over this, rounded outwards: they compare exactly with those of walls.
const SLOPES: f64 = (1u64 << 20) as f64;

/// Groups of windows: a line of sight meets one of each.
pub(super) struct Windows {
    groups: Vec<Vec<Vec<[f64; 2]>>>,
    /// Slopes beyond this count as infinite.
    steep: f64,
}

/// What one viewer looks at.
#[derive(Default)]
pub(super) struct Views {
    /// Slopes from and to, ascending, apart from each other; infinite ones where a view reaches down to his own row.
    pub above: Vec<[f64; 2]>,
    /// Whether any group has none on his own row.
    pub is_row_closed: bool,
    more: [Vec<[f64; 2]>; 2],
}

impl Windows {
    /// `low_um` is the zero point of the frame of viewers.
    pub fn new(groups: &[&[Window]], low_um: PointUm, steep: f64) -> Self {
        let local = |p: &PointUm| [0, 1].map(|k| p[k] as f64 - low_um[k] as f64);
        let group = |g: &&[Window]| g.iter().map(|w| w.iter().map(local).collect()).collect();
        Self { groups: groups.iter().map(group).collect(), steep }
    }

    /// Finds the views of viewers in a box, its lower left and upper right corner: of one viewer exactly, of several all that any
    /// has.
    pub fn look(&self, from: [[f64; 2]; 2], views: &mut Views) {
        views.is_row_closed = false;
        for (i, group) in self.groups.iter().enumerate() {
            let [found, both] = &mut views.more;
            found.clear();
            let mut is_on_row = false;
            for window in group {
                found.extend(self.view(window, from));
                is_on_row |= reaches_rows(window, from.map(|p| p[1]));
            }
            views.is_row_closed |= !is_on_row;
            found.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
            found.dedup_by(|next, last| {
                let is_joined = next[0] <= last[1];
                if is_joined {
                    last[1] = last[1].max(next[1]);
                }
                is_joined
            });
            if i == 0 {
                views.above.clone_from(found);
            } else {
                both.clear();
                let pairs = views.above.iter().flat_map(|a| found.iter().map(move |b| (a, b)));
                both.extend(pairs.map(|(a, b)| [a[0].max(b[0]), a[1].min(b[1])]).filter(|v| v[0] < v[1]));
                std::mem::swap(&mut views.above, both);
            }
            if views.above.is_empty() && views.is_row_closed {
                return;
            }
        }
    }

    /// The slopes between which a window lies above a viewer's row, or on it.
    fn view(&self, window: &[[f64; 2]], [low, high]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
        let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut is_above, mut is_below) = (false, false);
        for [x, y] in window {
            // Of the square of a rim round the corner, as anybody has it.
            let [left, right] = [x - high[0] - RIM_UM, x - low[0] + RIM_UM];
            let [near, far] = [y - high[1] - RIM_UM, y - low[1] + RIM_UM];
            is_above |= far > 0.0;
            is_below |= near <= 0.0;
            if far > 0.0 {
                from = from.min(match left > 0.0 {
                    true => left / far,
                    false if near > 0.0 => left / near,
                    false => f64::NEG_INFINITY,
                });
                to = to.max(match right > 0.0 {
                    true if near > 0.0 => right / near,
                    true => f64::INFINITY,
                    false => right / far,
                });
            }
        }
        if !is_above {
            return None;
        }
        // A window that reaches below is seen to the horizon on the sides on which it lies there.
        if is_below && window.iter().any(|[x, _]| x - high[0] < RIM_UM) {
            from = f64::NEG_INFINITY;
        }
        if is_below && window.iter().any(|[x, _]| x - low[0] > -RIM_UM) {
            to = f64::INFINITY;
        }
        let (from, to) = ((from * SLOPES).floor() / SLOPES, (to * SLOPES).ceil() / SLOPES);
        let from = if from < -self.steep { f64::NEG_INFINITY } else { from };
        let to = if to > self.steep { f64::INFINITY } else { to };
        // What lies beyond all columns on one side is seen by nobody.
        (from < self.steep && to > -self.steep).then_some([from, to])
    }
}

/// Whether a window meets any of the rows from one on to another.
fn reaches_rows(window: &[[f64; 2]], [low, high]: [f64; 2]) -> bool {
    window.iter().any(|[_, y]| y - low > -RIM_UM) && window.iter().any(|[_, y]| y - high < RIM_UM)
}

impl Views {
    /// The slope of an end of a view, exactly: from and to of the first, of the second …
    pub fn slope(&self, end: usize) -> Fraction {
        let slope = self.above[end / 2][end % 2];
        Fraction { num: (slope * SLOPES) as i128, den: SLOPES as i128 }
    }
}
