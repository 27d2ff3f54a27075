//! What of a layout is shown as maps over its cells.

use crate::measure::aims::cell_values;
use crate::measure::study::{Study, divisor};
use crate::measure::worth::Worth;
use enfilade_config::{Aggregate, Aim, Colours, Measure, PairName, Settings};
use enfilade_engine::measures::{Column, UNDEFINED};
use enfilade_overlay::Palette;
use enfilade_overlay::picture::Cell;

/// What a heat map shows: a measure over the cells of a pair of regions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Map {
    /// The measure.
    pub measure: Measure,
    /// The named pair; `None`: the unnamed one.
    pub pair: Option<PairName>,
}

impl Map {
    /// Name in result.json: `degree`, `degree@entrance`.
    pub fn key(self) -> String {
        Aim { measure: self.measure, aggregate: Aggregate::Mean, pair: self.pair }.to_string()
    }

    /// The same as part of a file's name.
    pub fn file(self) -> String {
        self.key().replace('@', "-")
    }
}

/// The heat maps of a round: those of every round, what each named pair sees, and what else is asked for.
pub fn maps(study: &Study) -> Vec<Map> {
    let mut out: Vec<Map> = SHOWN.map(|measure| Map { measure, pair: None }).to_vec();
    let degrees = study.pairs().iter().map(|p| Map { measure: Measure::Degree, pair: Some(p.name) });
    let asked = study.aims.iter().map(|a| Map { measure: a.measure, pair: a.pair });
    for map in degrees.chain(asked) {
        if !out.contains(&map) {
            out.push(map);
        }
    }
    out
}

/// Colours of the settings.
pub fn palette(settings: &Settings) -> Palette {
    match settings.colours {
        Colours::Safe => Palette::Viridis,
        Colours::BlueToRed => Palette::BlueToRed,
    }
}

/// Values of a map per query vertex of its pair, as people are told them. `Score`: Σ w_k (f_k(i) − F_k⁰)/|F_k⁰| over its terms of the
/// unnamed pair, F⁰ the present mean.
pub fn values(study: &Study, worth: &Worth, map: Map, settings: &Settings) -> Vec<f64> {
    if map.measure.is_of_cells() {
        let factor = map.factor(study);
        let values = cell_values(study.seen_of(worth, map.pair), map.measure);
        return values.into_iter().map(|v| v * factor).collect();
    }
    let mut out = vec![0.0; study.lattice.query.len()];
    for (aim, w) in settings.score.iter().filter(|(aim, _)| aim.pair.is_none()) {
        let zero = study.value(&study.initial, *aim);
        for (sum, v) in out.iter_mut().zip(cell_values(&worth.seen, aim.measure)) {
            *sum += w * (v - zero) / divisor(zero);
        }
    }
    out
}

/// All vertices of a pair as cells, those of its region of query with their values; plan frame.
pub fn cells(study: &Study, pair: Option<PairName>, values: &[f64]) -> Vec<Cell> {
    let named = study.pairs().iter().find(|p| Some(p.name) == pair);
    let lattice = named.map_or(&*study.lattice, |p| p.lattice());
    let centre = |v: usize| study.base.plan.frame.plan_from_um(lattice.centre_um(v)).to_array();
    let mut out: Vec<Cell> =
        (0..lattice.cells.len()).map(|v| Cell { centre: centre(v), value: None }).collect();
    for (v, value) in lattice.query.iter().zip(values) {
        out[*v as usize].value = Some(*value).filter(|v| v.is_finite());
    }
    out
}

/// All vertices as cells with the values of a column; none where it is undefined. Plan frame.
pub fn column_cells(study: &Study, column: &Column) -> Vec<Cell> {
    let lattice = &study.lattice;
    let value = |v: f64| (v != UNDEFINED && v.is_finite()).then_some(v);
    let centre = |v: usize| study.base.plan.frame.plan_from_um(lattice.centre_um(v)).to_array();
    column.values.iter().enumerate().map(|(v, x)| Cell { centre: centre(v), value: value(*x) }).collect()
}

/// A column's name as a file name: `Visual Integration [HH]` is `visual-integration-hh`.
pub fn slug(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty());
    words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
}

/// The measures of which heat maps are always made, in the order in which they are shown.
const SHOWN: [Measure; 4] = [Measure::Degree, Measure::Depth, Measure::Entropy, Measure::Score];
