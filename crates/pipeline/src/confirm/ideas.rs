//! Which layouts are ideas of their own: people experience them otherwise, and their walls stand elsewhere.

use std::collections::BTreeMap;

use crate::measure::aims::cell_values;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use enfilade_cad::curve::control_points;
use enfilade_config::Measure;
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_moves::Layout;
use enfilade_overlay::words;

/// Walls nearer than this stand at the same place to anybody, metres of a person.
pub(crate) const SAME_PLACE_M: f64 = 0.1;

/// Layouts whose maps of what is gained correlate more than this are one idea.
pub(crate) const SAME_MAPS: f64 = 0.8;

/// What a layout changes at every cell that both it and the present layout leave free: what is seen, and steps.
#[derive(Clone)]
pub(crate) struct Experience([Vec<f64>; 2]);

impl Experience {
    pub(crate) fn of(study: &Study, worth: &Worth) -> Self {
        let change = |measure| {
            let [now, present] = [worth, &study.initial].map(|w| cell_values(&w.seen, measure));
            now.iter().zip(&present).map(|(now, present)| now - present).collect()
        };
        Self([Measure::Degree, Measure::MeanDepth].map(change))
    }

    /// How alike two layouts are to the people in them: the larger correlation of their maps of sight and of steps, −1 to 1.
    pub(crate) fn likeness(&self, other: &Self) -> f64 {
        let both = self.0.iter().zip(&other.0).map(|(a, b)| correlation(a, b));
        both.fold(-1.0, f64::max)
    }
}

/// Pearson's correlation of two lists where both have a value; 0 where one does not vary.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let pairs: Vec<[f64; 2]> =
        a.iter().zip(b).filter(|(a, b)| a.is_finite() && b.is_finite()).map(|(a, b)| [*a, *b]).collect();
    let n = pairs.len().max(1) as f64;
    let mean = [0, 1].map(|k| pairs.iter().map(|p| p[k]).sum::<f64>() / n);
    let moment = |i: usize, j: usize| pairs.iter().map(|p| (p[i] - mean[i]) * (p[j] - mean[j])).sum::<f64>();
    let spread = (moment(0, 0) * moment(1, 1)).sqrt();
    if spread > 0.0 { moment(0, 1) / spread } else { 0.0 }
}

/// The pieces of all walls that may move as they stand in a layout, and the blocks that only move whole.
pub(crate) struct Stance {
    pieces: Vec<[PointUm; 2]>,
    tolerance_um: i64,
}

impl Stance {
    pub(crate) fn of(study: &Study, layout: &Layout) -> Self {
        let base = &study.base;
        let mut pieces: Vec<[PointUm; 2]> =
            layout.walls.iter().flat_map(|w| w.trace.segments().map(|(_, _, s)| [s.a, s.b])).collect();
        let fittings = base.fittings.iter().filter_map(|fitting| {
            let enfilade_moves::carried::Carried::Moves(shape, _) =
                enfilade_moves::carried::carried(&base.plan, fitting, layout)
            else {
                return None;
            };
            let at = control_points(&shape).first().map(|p| base.plan.frame.um_from_file(*p))?;
            Some([at, at])
        });
        pieces.extend(fittings);
        let tolerance_um = (SAME_PLACE_M * base.plan.human_scale * UM_PER_M) as i64;
        Self { pieces, tolerance_um }
    }

    /// Whether the walls of two layouts lie on each other within a tolerance, whichever wall it is and whichever way it
    /// is drawn: a screen turned by half a turn stands where it stood, and so do two of one length that change places.
    pub(crate) fn overlays(&self, other: &Self) -> bool {
        self.overlays_within(other, self.tolerance_um)
    }

    /// The same to a millimetre.
    pub(crate) fn is(&self, other: &Self) -> bool {
        self.overlays_within(other, 1_000)
    }

    fn overlays_within(&self, other: &Self, tolerance_um: i64) -> bool {
        if self.pieces.len() != other.pieces.len() {
            return false;
        }
        // Pieces by the coarse place of their middles, so that few are compared.
        let cell = |p: &[PointUm; 2]| [0, 1].map(|k| (p[0][k] + p[1][k]).div_euclid(4 * tolerance_um.max(1)));
        let mut free: BTreeMap<PointUm, Vec<[PointUm; 2]>> = BTreeMap::new();
        other.pieces.iter().for_each(|p| free.entry(cell(p)).or_default().push(*p));
        let near = |a: PointUm, b: PointUm| (0..2).all(|k| (a[k] - b[k]).abs() <= tolerance_um);
        let is_same = |p: &[PointUm; 2], q: &[PointUm; 2]| {
            near(p[0], q[0]) && near(p[1], q[1]) || near(p[0], q[1]) && near(p[1], q[0])
        };
        self.pieces.iter().all(|p| {
            let [x, y] = cell(p);
            let around = (x - 1..=x + 1).flat_map(|x| (y - 1..=y + 1).map(move |y| [x, y]));
            for at in around {
                let Some(list) = free.get_mut(&at) else { continue };
                if let Some(i) = list.iter().position(|q| is_same(p, q)) {
                    list.swap_remove(i);
                    return true;
                }
            }
            false
        })
    }
}

/// Whether some parameter has moved by so much that the words would tell it.
pub(crate) fn moves_visibly(study: &Study, parameters: &[f64]) -> bool {
    let (bounds, identity) = (study.base.moves.bounds(), study.base.moves.identity());
    let ways = parameters.iter().zip(&identity).zip(&bounds);
    ways.into_iter().any(|((p, still), [lo, hi])| (p - still).abs() >= words::SMALLEST_SHARE * (hi - lo))
}

/// The options that differ in the drawing: what stands on the same lines to a millimetre, a screen turned by half
/// a turn or two of one length exchanged, is one option.
pub(crate) fn apart(study: &Study, members: Vec<enfilade_search::Member>) -> Vec<enfilade_search::Member> {
    let mut out: Vec<(Stance, enfilade_search::Member)> = Vec::new();
    for m in members {
        let base = &study.base;
        let stance = Stance::of(study, &base.moves.apply(&base.plan, &base.graph, &m.parameters));
        if out.iter().all(|(other, _)| !other.is(&stance)) {
            out.push((stance, m));
        }
    }
    out.into_iter().map(|(_, m)| m).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_alike_by_their_shape() {
        let map = [1.0, 2.0, f64::NAN, 4.0];
        assert!((correlation(&map, &[2.0, 4.0, 9.0, 8.0]) - 1.0).abs() < 1e-12);
        assert!((correlation(&map, &[-1.0, -2.0, 0.0, -4.0]) + 1.0).abs() < 1e-12);
        assert_eq!(correlation(&map, &[3.0; 4]), 0.0);
    }

    #[test]
    fn walls_are_matched_by_where_they_stand() {
        let stance = |pieces: &[[PointUm; 2]]| Stance { pieces: pieces.to_vec(), tolerance_um: 100_000 };
        let (a, b) = ([[0, 0], [2_000_000, 0]], [[0, 5_000_000], [2_000_000, 5_000_000]]);
        let drawn = stance(&[a, b]);
        // Turned by half a turn, exchanged, and 8 cm aside.
        let same = stance(&[b, [[2_000_000, 80_000], [0, 80_000]]]);
        assert!(drawn.overlays(&same) && !drawn.is(&same));
        assert!(!drawn.overlays(&stance(&[a, [[0, 5_200_000], [2_000_000, 5_200_000]]])));
        assert!(!drawn.overlays(&stance(&[a, a])), "one wall stands for one");
        assert!(drawn.is(&stance(&[b, a])));
    }
}
