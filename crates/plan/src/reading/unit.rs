//! Which unit a drawing is in, as a sum of evidence: for every unit how much likelier what is drawn becomes by it.
//!
//! Every term is the logarithm of a likelihood, up to what all units share; their sum with the header's word gives a
//! probability for every unit. Middles and widths of the bells are those of the doors, walls, letters and buildings in 20
//! labelled drawings by 15 authors; the shares were set by hand, with 24 more by 11 authors and 124 drawn from IFC in view.

use super::clues::{Clues, Gap, Stated};
use super::lengths::Length;
use super::{Rival, UnitSense};
use crate::frame::{SMALL_PLAN_M, scales};
use enfilade_cad::drawing::Unit;
use enfilade_cad::units::UNITS;

/// Codes of the terms, in their order, as [`UnitSense::reasons`] names them.
pub const CODES: [&str; 9] =
    ["header", "size", "walls", "doors", "dimensions", "areas", "letters", "imperial", "usual"];

/// The place of the doors' term in [`CODES`].
const DOORS: usize = 3;

/// What every term counts, since they are not quite independent: fitted for the probability of the right unit in 124
/// drawings made from IFC; 32 drawings by 22 authors ask for between 0.5 and 1.
const TEMPER: f64 = 0.7;

/// How many plans are drawn in the size of their paper, and how long that is at least, metres.
const PRINTED_SHARE: f64 = 0.001;
const PAPER_M: f64 = 0.05;

/// Of what is measured this share is taken to be something else, spread evenly over [`SPREAD`] powers of e.
const OTHER: f64 = 0.15;
const SPREAD: f64 = 8.0;

/// Terms of many pieces count with the square root of their number, up to so many.
const PIECES_MAX: f64 = 9.0;

/// A bell over the logarithm of a length: its middle, metres, its width and its share.
type Bell = (f64, f64, f64);

/// Leaves of doors; of cupboards and of gates.
const LEAF: [Bell; 2] = [(0.84, 0.16, 0.85), (0.5, 0.25, 0.15)];
/// Walls: partitions, brick, masonry; …
const GAP: [Bell; 3] = [(0.11, 0.25, 0.45), (0.2, 0.25, 0.38), (0.35, 0.3, 0.17)];
/// … rooms, and the share of plans that are drawn with single lines, so that rooms lie between them.
const ROOM: [Bell; 1] = [(2.5, 0.7, 1.0)];
const SINGLE_SHARE: f64 = 0.1;
/// Longer side of a building.
const SIZE: [Bell; 2] = [(15.0, 0.5, 0.55), (50.0, 1.0, 0.45)];
/// Plans that are drawn at no known scale, smaller than a building: two of the 35 drawings of `data` and `reading`.
const SCALELESS_SHARE: f64 = 0.05;
/// Letters as printed 2 to 5 mm high at 1:50 to 1:200.
const LETTERS: [Bell; 1] = [(0.2, 0.6, 1.0)];
/// What is dimensioned.
const DIMENSION: [Bell; 1] = [(1.6, 1.1, 1.0)];

/// A room's free width by height beside the area that is written in it: the width of the logarithm of their ratio.
const ROOM_WIDTH: f64 = 0.5;
/// The same for a closed line round it.
const RING_WIDTH: f64 = 0.04;

/// Dimensions are written to the digits that they have: so near is the measured length to the written one.
const WRITTEN_WIDTH: f64 = 0.02;

/// Faces farther apart than this share of the walls' extent, in the middle, are those of rooms.
const THICK_SHARE_MAX: f64 = 0.06;
/// Nor are they those of walls where more than this share of the plan lies between them.
const BETWEEN_SHARE_MAX: f64 = 0.3;
/// Fewest faces, and their least share of all length, that say how thick walls are.
const PAIRS_MIN: usize = 8;
const PAIRS_SHARE: f64 = 0.25;

/// How likely a unit is where nothing is known.
const USUAL: [(&str, f64); 5] = [("m", 0.3), ("mm", 0.43), ("cm", 0.16), ("in", 0.08), ("ft", 0.03)];

/// The same of any other unit.
const UNUSUAL: f64 = 0.002;

/// How often a declared unit is right: that of programs' empty drawings less often than one that somebody chose.
const DECLARED: [(&str, f64); 5] = [("m", 0.9), ("mm", 0.7), ("cm", 0.9), ("in", 0.5), ("ft", 0.7)];
const DECLARED_ELSE: f64 = 0.3;

/// `$MEASUREMENT` is right so often.
const SYSTEM_RIGHT: f64 = 0.6;

/// How likely it is that a drawing that writes feet and inches is in a metric unit.
const IMPERIAL_METRIC: f64 = 0.1;

/// What the file says of its unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Said {
    /// The unit that its header declares.
    pub declared: Option<Unit>,
    /// Whether its header says that it is metric, if it says anything.
    pub is_metric: Option<bool>,
}

/// A unit with the evidence for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighed {
    /// The unit.
    pub unit: Unit,
    /// How likely it is, 0 to 1.
    pub probability: f64,
    /// Logarithms of likelihoods in the order of [`CODES`], weighted.
    pub terms: [f64; CODES.len()],
}

impl Weighed {
    /// It beside the unit that is taken. Doors speak for it where their term is above 0; where none is drawn it is 0.
    fn rival(&self) -> Rival {
        Rival { unit: self.unit, probability: self.probability, has_doors: self.terms[DOORS] > 0.0 }
    }
}

/// Every unit that has a name, and the declared one, with the evidence for it; the likeliest first.
pub fn weigh(clues: &Clues, said: Said) -> Vec<Weighed> {
    let odd = said.declared.filter(|d| UNITS.iter().all(|u| u.name != d.name));
    let units = UNITS.into_iter().chain(odd);
    let mut out: Vec<Weighed> = units
        .map(|unit| {
            let terms = terms(clues, said, unit).map(|t| t * TEMPER);
            Weighed { unit, probability: 0.0, terms }
        })
        .collect();
    let sum = |w: &Weighed| w.terms.iter().sum::<f64>();
    let best = out.iter().map(sum).fold(f64::NEG_INFINITY, f64::max);
    let total: f64 = out.iter().map(|w| (sum(w) - best).exp()).sum();
    out.iter_mut().for_each(|w| w.probability = (sum(w) - best).exp() / total);
    out.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    out
}

/// How sure the first of some units is, and why: the terms that set it apart from the second.
pub fn sense(weighed: &[Weighed]) -> UnitSense {
    let [first, second, ..] = weighed else { return UnitSense::default() };
    let mut apart: Vec<(f64, &'static str)> =
        (0..CODES.len()).map(|k| (first.terms[k] - second.terms[k], CODES[k])).collect();
    apart.sort_by(|a, b| b.0.total_cmp(&a.0));
    UnitSense {
        confidence: first.probability,
        reasons: apart.into_iter().filter(|(by, _)| *by > REASON_MIN).map(|(_, code)| code).collect(),
        runner_up: Some(second.rival()),
    }
}

/// How sure a unit is that is taken although another one is likelier.
pub fn sense_of(weighed: &[Weighed], taken: Unit) -> UnitSense {
    let confidence = weighed.iter().find(|w| w.unit == taken).map_or(0.0, |w| w.probability);
    UnitSense { confidence, reasons: vec![CODES[0]], runner_up: weighed.first().map(Weighed::rival) }
}

/// What sets two units apart by less is no reason.
const REASON_MIN: f64 = 0.5;

/// The terms of a unit, as drawn or at the scale of its paper: whichever makes it likelier.
fn terms(clues: &Clues, said: Said, unit: Unit) -> [f64; CODES.len()] {
    let plain = terms_at(clues, said, unit, 1.0);
    let is_paper = (PAPER_M..SMALL_PLAN_M).contains(&(clues.extent * unit.metres))
        && said.declared.is_some_and(|d| d.name == unit.name);
    if !is_paper {
        return plain;
    }
    // What is as small and says its scale is as likely printed as drawn so: its sizes decide.
    let written = clues.scales.iter().map(|scale| (*scale, 1.0));
    let listed = scales(unit).into_iter().filter(|_| !clues.leaves().is_empty());
    let printed = written.chain(listed.map(|scale| (scale, PRINTED_SHARE))).map(|(scale, share)| {
        let mut terms = terms_at(clues, said, unit, scale);
        terms[CODES.len() - 1] += share.ln();
        terms
    });
    let sum = |t: &[f64; CODES.len()]| t.iter().sum::<f64>();
    printed.fold(plain, |best, next| if sum(&next) > sum(&best) { next } else { best })
}

fn terms_at(clues: &Clues, said: Said, unit: Unit, scale: f64) -> [f64; CODES.len()] {
    let metres = unit.metres * scale;
    let is_imperial = matches!(unit.name, "in" | "ft");
    let size = match clues.largest * metres {
        0.0 => 0.0,
        small if small < SMALL_PLAN_M && clues.extent * metres < SMALL_PLAN_M => SCALELESS_SHARE.ln(),
        size => fit(&SIZE, size),
    };
    let letters = clues.letters.map_or(0.0, |l| fit(&LETTERS, l * metres));
    let imperial = match clues.imperial {
        0 => 0.0,
        _ if is_imperial => (1.0 - IMPERIAL_METRIC).ln(),
        _ => IMPERIAL_METRIC.ln(),
    };
    let system = said.is_metric.map_or(0.0, |metric| {
        if metric != is_imperial { SYSTEM_RIGHT.ln() } else { (1.0 - SYSTEM_RIGHT).ln() }
    });
    [
        header(said, unit),
        size,
        walls(clues, metres),
        doors(clues, metres),
        dimensions(&clues.stated, metres),
        areas(clues, metres),
        letters,
        imperial,
        usual(unit).ln() + system,
    ]
}

/// Whether the lines beside faces say how thick the walls are.
pub fn says_thickness(clues: &Clues) -> bool {
    clues.between_share <= BETWEEN_SHARE_MAX
        && clues.middle_gap().is_some_and(|t| t <= THICK_SHARE_MAX * clues.extent)
        && clues.gaps.len() >= PAIRS_MIN
        && clues.paired_share >= PAIRS_SHARE
}

/// Whether one drawing unit of so many metres makes of what is drawn a building: its doors, if it has any, and none of walls
/// and size speaks against it.
pub fn is_building(clues: &Clues, metres: f64) -> bool {
    (clues.leaves().is_empty() || doors(clues, metres) > 0.0)
        && walls(clues, metres) >= 0.0
        && fit(&SIZE, clues.largest * metres) > AGAINST
}

/// A size that is this much less likely than any is against a unit.
const AGAINST: f64 = -1.5;

fn header(said: Said, unit: Unit) -> f64 {
    let Some(declared) = said.declared else { return 0.0 };
    let right = DECLARED.iter().find(|d| d.0 == declared.name).map_or(DECLARED_ELSE, |d| d.1);
    // Units come with their own frequency ([`USUAL`]), which a header that is right knows already.
    let usual = usual(declared);
    if unit.name == declared.name { (right / usual).ln() } else { ((1.0 - right) / (1.0 - usual)).ln() }
}

fn usual(unit: Unit) -> f64 {
    USUAL.iter().find(|u| u.0 == unit.name).map_or(UNUSUAL, |u| u.1)
}

/// Logarithm of the density of a length under some bells, against one that may be anything.
fn fit(bells: &[Bell], metres: f64) -> f64 {
    ((1.0 - OTHER) * density(bells, metres) * SPREAD + OTHER).ln()
}

/// Density over the logarithm.
fn density(bells: &[Bell], metres: f64) -> f64 {
    let of = |(middle, width, share): &Bell| {
        let off = (metres / middle).ln() / width;
        share * (-off * off / 2.0).exp() / (width * (std::f64::consts::TAU).sqrt())
    };
    bells.iter().map(of).sum()
}

/// The mean of some weighted terms, times the root of how many speak.
fn pooled(terms: impl Iterator<Item = (f64, f64)>, count: f64) -> f64 {
    let (sum, weight) = terms.fold((0.0, 0.0), |(s, w), (term, weight)| (s + term * weight, w + weight));
    if weight > 0.0 { sum / weight * count.min(PIECES_MAX).sqrt() } else { 0.0 }
}

fn walls(clues: &Clues, metres: f64) -> f64 {
    if !says_thickness(clues) {
        return 0.0;
    }
    let of = |bells: &[Bell], g: &Gap| {
        let beyond = g.beyond.iter().map(|d| fit(bells, d * metres) - 0.5);
        beyond.fold(fit(bells, g.nearest * metres), f64::max)
    };
    let all = |bells: &[Bell], count: f64| pooled(clues.gaps.iter().map(|g| (of(bells, g), g.length)), count);
    let thick = all(&GAP, clues.gaps.len() as f64 / 4.0) + (1.0 - SINGLE_SHARE).ln();
    // A plan is drawn one way or the other. Rooms of one building are as wide as each other: they speak once.
    thick.max(all(&ROOM, 1.0) + SINGLE_SHARE.ln())
}

/// How much likelier doors are in it than something else as large, a logarithm.
pub fn doors(clues: &Clues, metres: f64) -> f64 {
    let with_leaf = clues.swings.iter().any(|(s, _)| s.has_leaf);
    let used = clues.swings.iter().filter(|(s, _)| s.has_leaf == with_leaf);
    let used: Vec<(f64, f64)> =
        used.map(|(s, n)| (fit(&LEAF, s.radius * metres), (*n as f64).sqrt())).collect();
    let count = used.iter().map(|u| u.1).sum::<f64>() * if with_leaf { 1.0 } else { 0.3 };
    pooled(used.into_iter(), count)
}

/// In which unit a bare number is written: by its decimals, and by how long that makes what is dimensioned.
fn written_in(decimals: usize, middle: f64) -> [(f64, f64); 5] {
    let by_decimals = match decimals {
        0 => [0.08, 0.52, 0.2, 0.17, 0.03],
        1 => [0.35, 0.1, 0.35, 0.15, 0.05],
        _ => [0.86, 0.02, 0.03, 0.05, 0.04],
    };
    let mut out = [0, 1, 2, 3, 4].map(|k| {
        let metres = UNITS[k].metres;
        (metres, by_decimals[k] * (density(&DIMENSION, middle * metres) + 0.002))
    });
    let total: f64 = out.iter().map(|o| o.1).sum();
    out.iter_mut().for_each(|o| o.1 /= total);
    out
}

fn dimensions(stated: &[Stated], in_unit: f64) -> f64 {
    let mut bare: Vec<(f64, usize)> = Vec::new();
    for s in stated {
        if let Length::Bare { value, decimals } = s.written {
            bare.push((value, decimals));
        }
    }
    bare.sort_by(|a, b| a.0.total_cmp(&b.0));
    let middle = bare.get(bare.len() / 2).map_or(1.0, |b| b.0);
    let mut decimals: Vec<usize> = bare.iter().map(|b| b.1).collect();
    decimals.sort_unstable();
    // What most write: one that ends in a zero by chance says nothing.
    let decimals = decimals.get(decimals.len() * 3 / 4).copied().unwrap_or(0);
    let units = written_in(decimals, middle);
    let is_near = |metres: f64, s: &Stated| (metres / (s.measured * in_unit)).ln().abs() < WRITTEN_WIDTH;
    let of = |s: &Stated| {
        let right = match s.written {
            Length::Metres(m) => f64::from(u8::from(is_near(m, s))),
            Length::Bare { value, .. } => {
                units.iter().filter(|(metres, _)| is_near(value * metres, s)).map(|u| u.1).sum()
            }
        };
        ((1.0 - OTHER) * right + 0.02).ln()
    };
    pooled(stated.iter().map(|s| (of(s), 1.0)), stated.len() as f64)
}

fn areas(clues: &Clues, metres: f64) -> f64 {
    let square = metres * metres;
    let near = |area: f64, of: f64, width: f64| {
        let bell = [(of, width, 1.0)];
        fit(&bell, area * square)
    };
    let of = |room: &super::clues::Room| {
        let ring = room.rings.iter().map(|a| near(*a, room.area_m2, RING_WIDTH)).reduce(f64::max);
        let round = room.round_text.map(|a| near(a, room.area_m2, ROOM_WIDTH));
        ring.into_iter().chain(round).reduce(f64::max)
    };
    let spoken: Vec<f64> = clues.rooms.iter().filter_map(of).collect();
    let count = spoken.len() as f64;
    pooled(spoken.into_iter().map(|t| (t, 1.0)), count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::clues::{Room, Swing};
    use enfilade_cad::units::unit_by_name;

    fn unit(name: &str) -> Unit {
        unit_by_name(name).unwrap()
    }

    /// A house with walls 0.2 m thick and door leaves of 0.9 m, drawn in the unit.
    fn house(u: Unit) -> Clues {
        let scale = 1.0 / u.metres;
        Clues {
            swings: vec![(Swing { radius: 0.9 * scale, has_leaf: true }, 5)],
            gaps: vec![Gap { nearest: 0.2 * scale, beyond: Vec::new(), length: 4.0 * scale }; 20],
            paired_share: 0.9,
            extent: 14.0 * scale,
            largest: 14.0 * scale,
            ..Clues::default()
        }
    }

    fn found(clues: &Clues, declared: Option<&str>) -> (&'static str, f64) {
        let best = &weigh(clues, Said { declared: declared.map(unit), is_metric: None })[0];
        (best.unit.name, best.probability)
    }

    #[test]
    fn every_unit_is_found_and_defended() {
        for drawn in UNITS {
            let seen = house(drawn);
            assert_eq!(found(&seen, None).0, drawn.name);
            for declared in UNITS {
                let (name, probability) = found(&seen, Some(declared.name));
                assert!(name == drawn.name && probability > 0.7, "{} for {}", declared.name, drawn.name);
            }
        }
    }

    /// Where nothing is drawn that has a size, the header is believed, and not much.
    #[test]
    fn the_header_alone_is_believed() {
        for declared in UNITS {
            let (name, probability) = found(&Clues::default(), Some(declared.name));
            assert_eq!(name, declared.name);
            assert!(probability < 0.95, "{name} {probability}");
        }
        let plan = Clues { largest: 30.0, extent: 30.0, ..Clues::default() };
        assert_eq!(found(&plan, Some("m")).0, "m");
    }

    /// Rooms of 5 m drawn with single lines, 267 m long: their width is no thickness in inches.
    #[test]
    fn what_covers_much_of_the_plan_is_no_wall() {
        let rooms = Clues {
            gaps: vec![Gap { nearest: 5.0, beyond: Vec::new(), length: 20.0 }; 30],
            paired_share: 0.56,
            between_share: 0.36,
            extent: 267.0,
            largest: 267.0,
            ..Clues::default()
        };
        assert_eq!(found(&rooms, None).0, "m");
    }

    #[test]
    fn what_is_written_decides() {
        let bare = |measured: f64, value: f64, decimals| Stated {
            measured,
            written: Length::Bare { value, decimals },
        };
        let dims = |stated: Vec<Stated>| Clues { stated, ..Clues::default() };
        assert_eq!(
            found(&dims(vec![bare(350.0, 3.5, 2), bare(120.0, 1.2, 1), bare(85.0, 0.85, 2)]), Some("mm")).0,
            "cm"
        );
        assert_eq!(found(&dims(vec![bare(3500.0, 3500.0, 0), bare(1200.0, 1200.0, 0)]), None).0, "mm");
        let room = Room { area_m2: 12.0, round_text: Some(120_000.0), rings: vec![118_000.0, 4e6] };
        assert_eq!(found(&Clues { rooms: vec![room; 3], ..Clues::default() }, Some("in")).0, "cm");
    }

    #[test]
    fn the_reasons_are_the_strongest_terms() {
        let said = Said { declared: Some(unit("mm")), is_metric: Some(true) };
        assert_eq!(CODES[DOORS], "doors");
        let sense = sense(&weigh(&house(unit("m")), said));
        assert!(sense.confidence > 0.8 && sense.reasons.contains(&"doors"), "{sense:?}");
        assert!(sense.runner_up.is_some_and(|r| r.unit.name != "m" && r.probability < 0.2));
    }
}
