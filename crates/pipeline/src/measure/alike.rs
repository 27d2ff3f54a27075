//! Whether a layout as written measures as it did in the search.

use crate::measure::seen::Seen;
use crate::measure::worth::Worth;
use enfilade_config::Penalty;

/// Areas and angles of a file differ by less where its numbers have seven digits, as those of a GLB do: a share, and what
/// stands for it beside zero.
const ROUNDING_SHARE: f64 = 1e-5;
const ROUNDING: f64 = 1e-6;
/// The same of penalties that are metres summed over all walls, beside zero. Within 128 m a number of seven digits is off by
/// up to 4 µm; what a dozen corners add up to is far less than any layout means.
const ROUNDING_M: f64 = 5e-5;

fn rounding(penalty: Penalty) -> f64 {
    match penalty {
        Penalty::WallLength | Penalty::Overlap | Penalty::Passage => ROUNDING_M,
        Penalty::Clearance | Penalty::Alignment | Penalty::RoomArea => ROUNDING,
    }
}

impl Worth {
    /// The names of what differs in another measurement, each with both values; empty where nothing does.
    pub fn differences(&self, other: &Self) -> Vec<(String, f64, f64)> {
        let seen = |a: &Seen, b: &Seen| {
            let (a, b) = (&a.means, &b.means);
            [("degree", a.degree, b.degree), ("depth", a.depth, b.depth), ("entropy", a.entropy, b.entropy)]
        };
        let of_pairs = self.pairs.iter().zip(&other.pairs).flat_map(|(a, b)| seen(a, b));
        let counted = seen(&self.seen, &other.seen).into_iter().chain(of_pairs);
        let counted = counted.chain([("disconnection", self.disconnection, other.disconnection)]);
        let penalties = Penalty::ALL.map(|p| ((p.name(), self.penalty(p), other.penalty(p)), rounding(p)));
        let aims = self.aims.iter().zip(&other.aims).map(|(a, b)| (("aim", *a, *b), ROUNDING));
        let measured = penalties.into_iter().chain(aims);
        let is_other = |((_, a, b), near): &((&str, f64, f64), f64)| {
            (a - b).abs() > ROUNDING_SHARE * a.abs().max(b.abs()) + near
        };
        let counted = counted.filter(|(_, a, b)| a != b);
        let all = counted.chain(measured.filter(is_other).map(|(found, _)| found));
        all.map(|(name, a, b)| (name.to_string(), a, b)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_of_a_file_is_no_difference() {
        let of = |length: f64, degree: f64, of_pair: f64| {
            let mut worth = Worth { pairs: vec![Seen::default()], ..Worth::default() };
            worth.penalties[1] = length;
            worth.seen.means.degree = degree;
            worth.pairs[0].means.degree = of_pair;
            worth
        };
        let named = |a: Worth| -> Vec<String> {
            a.differences(&of(0.382, 40.0, 7.0)).into_iter().map(|(name, ..)| name).collect()
        };
        assert!(named(of(0.382 + 7e-7, 40.0, 7.0)).is_empty(), "seven digits of a scene");
        assert_eq!(named(of(0.382 + 1e-4, 40.0, 7.0)), [Penalty::ALL[1].name()]);
        let beside_zero = |penalty: usize, found: f64| {
            let mut worth = Worth::default();
            worth.penalties[penalty] = found;
            let differs = worth.differences(&Worth::default());
            differs.into_iter().map(|(name, ..)| name).collect::<Vec<_>>()
        };
        for (i, penalty) in Penalty::ALL.into_iter().enumerate() {
            let near = rounding(penalty);
            assert!(beside_zero(i, near).is_empty(), "{penalty:?}");
            assert_eq!(beside_zero(i, 1.1 * near), [penalty.name()]);
        }
        assert!(beside_zero(1, 3.3e-6).is_empty(), "corners of a dozen walls");
        // What is counted is the same or it is not.
        assert_eq!(named(of(0.382, 40.0 + 1e-9, 7.0)), ["degree"]);
        assert_eq!(named(of(0.382, 40.0, 7.0 + 1e-9)), ["degree"]);
    }
}
