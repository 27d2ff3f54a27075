//! What the rules of default moves hold back: better layouts that a builder would refuse, and structure that stays.

use super::Brief;
use super::judged::{evaluation, gained};
use crate::config::{Allow, Settings};
use crate::pipeline::study::{Faults, Worth};
use crate::report::counted;

/// Where in its bounds each move is tried alone, from the lower to the upper.
const TRIED_AT: [f64; 4] = [0.0, 0.25, 0.75, 1.0];

/// What of the rules keeps moves from options, with the word that permits it; empty where nothing does.
///
/// Each move is tried alone on the lattice shown. Counted are those that gain what an option must and break just one of
/// these rules and nothing else: the word that permits it is then enough.
pub(super) fn words(brief: &Brief<'_>) -> String {
    let Brief { study, settings, objectives, control, .. } = brief;
    if !study.base.moves.are_default {
        return String::new();
    }
    let start = control.start();
    let alone = |(i, [lo, hi]): (usize, [f64; 2])| {
        let at = |t: f64| {
            let mut q = start.clone();
            q[i] = lo + t * (hi - lo);
            control.expand(&control.permit(&q))
        };
        TRIED_AT.map(at)
    };
    let vectors: Vec<Vec<f64>> = control.bounds().into_iter().enumerate().flat_map(alone).collect();
    let crossing = Settings { allow: Allow { crossings: true, ..settings.allow }, ..(*settings).clone() };
    let mut held = [0_usize; 4];
    for worth in study.measure_all(&vectors) {
        let lawful = Worth { faults: Faults::default(), ..worth.clone() };
        let is_kept_else = evaluation(study, &crossing, objectives, &lawful).violation == 0.0;
        if !is_kept_else || gained(study, settings, objectives, &worth) < settings.least_gain {
            continue;
        }
        let crosses = evaluation(study, settings, objectives, &lawful).violation > 0.0;
        let Faults { opened_m, narrowed_m, struck } = worth.faults;
        let broken = [opened_m > 0.0, crosses, narrowed_m > 0.0, struck > 0];
        if let [rule] = (0..broken.len()).filter(|i| broken[*i]).collect::<Vec<_>>()[..] {
            held[rule] += 1;
        }
    }
    let whys = [
        ("open a joint", "open-joints"),
        ("run walls through each other", "crossings"),
        ("leave a way below 0.9 m", "narrow-ways"),
        ("run into something that stands there", "things"),
    ];
    let mut out = String::new();
    for ((why, word), n) in whys.into_iter().zip(held).filter(|(_, n)| *n > 0) {
        out += &format!(
            " {} that may gain enough would {why}. `--allow {word}` permits that.",
            counted(n as u64, "single move")
        );
    }
    let structure = study.base.plan.bearing.len();
    if structure > 0 {
        out += &format!(" Walls of the structure that stay: {structure}. `--allow structure` frees them.");
    }
    out
}
