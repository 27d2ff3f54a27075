//! Whether what options gain is the plan's or the grid's: a wall that just uncovers a row of cells lets all others see
//! them, and by a centimetre's move a measure may rise by several per cent. Held against a second grid.

use rayon::prelude::*;

use super::Made;
use super::judged::{evaluation, objectives};
use crate::config::Settings;
use crate::overlay::measure::{fixed, plain_name};
use crate::pipeline::study::{Study, Worth};
use crate::report::{Place, Report};
use crate::search::Sense;

/// A gain from here on is looked at again: a share of the present value, of a score the difference.
const LOOKED_AT: f64 = 0.01;

/// What is left of a gain on the other grid from which on it is the plan's.
const KEPT: f64 = 0.5;

/// More vertices are not measured a second time: the difference that one row makes is small there, and the time is not.
const SECOND_LOOK_MAX: usize = 20_000;

/// Says which options gain on this grid much more than on one that is shifted by half a cell both ways.
pub(super) fn say_gridded(
    report: &mut Report,
    file: &str,
    settings: &Settings,
    study: &Study,
    made: &[Made],
) {
    if made.is_empty() || study.lattice.cells.len() > SECOND_LOOK_MAX {
        return;
    }
    let centre = settings.lattice_centre_m.unwrap_or_default().map(|v| v + study.spacing_m / 2.0);
    let shifted = Settings { lattice_centre_m: Some(centre), ..settings.clone() };
    let Ok(other) = Study::new(study.base.clone(), &shifted, &mut Report::default()) else { return };
    let aims = objectives(settings);
    let values = |on: &Study, worth: &Worth| evaluation(on, settings, &aims, worth).values;
    let present = [values(study, &study.initial), values(&other, &other.initial)];
    let told: Vec<String> = (made.par_iter().enumerate())
        .filter_map(|(i, m)| {
            let now =
                [study, &other].map(|on| values(on, &on.measure(&m.member.parameters, &mut on.bench())));
            let lost: Vec<String> = (aims.iter().enumerate())
                .filter(|(_, (_, o))| !o.is_penalty)
                .filter_map(|(j, (_, o))| {
                    let gains = [0, 1].map(|on| gain(present[on][j], now[on][j], o.sense, o.is_score));
                    lost_words(&o.name, gains, o.is_score)
                })
                .collect();
            (!lost.is_empty()).then(|| format!("option {} {}", i + 1, lost.join(", ")))
        })
        .collect();
    if !told.is_empty() {
        let text = format!(
            "measured again on a grid shifted by half a cell (--lattice-centre {},{}), less than half of a gain is left: \
             {}; a wall that uncovers a whole row of cells counts for much on a coarse grid, and a smaller --spacing for less",
            centre[0],
            centre[1],
            told.join("; ")
        );
        report.info("grid-gains", Place::file(file), text);
    }
}

/// By how much a value is better than the present one: a share of that, of a score the difference.
fn gain(present: f64, now: f64, sense: Sense, is_score: bool) -> f64 {
    let better = if sense == Sense::Maximise { now - present } else { present - now };
    if is_score {
        better
    } else if present == 0.0 {
        0.0
    } else {
        better / present.abs()
    }
}

/// `visibility 4.4 % (there 0.5 %)` where most of a gain is not on the other grid.
fn lost_words(name: &str, [here, there]: [f64; 2], is_score: bool) -> Option<String> {
    let is_lost = here >= LOOKED_AT && there < KEPT * here;
    let amount = |v: f64| if is_score { fixed(v, 2) } else { format!("{} %", fixed(100.0 * v, 1)) };
    is_lost.then(|| format!("{} {} (there {})", plain_name(name).to_lowercase(), amount(here), amount(there)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_that_another_grid_does_not_know_is_told() {
        let told = |here, there, is_score| lost_words("degree", [here, there], is_score);
        assert_eq!(told(0.044, 0.005, false).as_deref(), Some("visibility 4.4 % (there 0.5 %)"));
        assert_eq!(told(0.3, -0.1, true).as_deref(), Some("visibility 0.30 (there −0.10)"));
        assert_eq!(told(0.044, 0.03, false), None);
        assert_eq!(told(0.009, 0.0, false), None);
        assert_eq!(gain(2.0, 1.5, Sense::Minimise, false), 0.25);
        assert_eq!(gain(-2.0, -1.5, Sense::Maximise, false), 0.25);
        assert_eq!(gain(0.0, 1.5, Sense::Maximise, true), 1.5);
        assert_eq!(gain(0.0, 1.5, Sense::Maximise, false), 0.0);
    }
}
