//! The options of a round in lines: one home for the table on the terminal and the one on the page.

use std::collections::BTreeSet;

use super::built::titles;
use super::measure::percent_change;
use super::result::{Best, Candidate, Change, Gains, Numbers, RoundResult};
use super::words::{gain_words, movers};

/// Movers named in a line; the rest is counted.
const MOVERS_NAMED: usize = 4;
/// Points nearer to each other than this, metres, are the same: files are written in tenths of a millimetre.
const SAME_M: f64 = 1e-4;

/// One option, or the best layout found where it is none.
pub struct OptionLine<'a> {
    /// Which option it is, from 0; none for the best layout found.
    pub option: Option<usize>,
    /// `1`, `2 (pinned)`, `best`.
    pub name: String,
    /// `Screen 1, Door west and 3 more`, the largest moves first; works by their names.
    pub movers: String,
    /// Metres of wall that stand elsewhere than now, are gone or are new.
    pub rebuilt_m: f64,
    /// Means of the measures.
    pub mean: &'a Numbers,
    /// Confirmed gains.
    pub gain: &'a Gains,
}

/// A line an option, in their order; the best layout found last where it is no option.
pub fn option_lines<'a>(result: &'a RoundResult) -> Vec<OptionLine<'a>> {
    let option = |(i, c): (usize, &'a Candidate)| OptionLine {
        option: Some(i),
        name: format!("{}{}", i + 1, result.mark(i)),
        movers: changes_of(result, c),
        rebuilt_m: rebuilt_m(&c.changes) + c.works.iter().map(|w| w.effort.length_m()).sum::<f64>(),
        mean: &c.mean,
        gain: &c.gain,
    };
    let best = |b: &'a Best| OptionLine {
        option: None,
        name: "best".into(),
        movers: movers_of(result, &b.parameters),
        rebuilt_m: rebuilt_m(&b.changes),
        mean: &b.mean,
        gain: &b.gain,
    };
    let options = result.candidates.iter().enumerate().map(option);
    options.chain(result.best.iter().filter(|b| b.option.is_none()).map(best)).collect()
}

impl OptionLine<'_> {
    /// The confirmed gain in a measure in words, else its change as measured.
    pub fn gained(&self, result: &RoundResult, key: &str) -> String {
        let change = || {
            let both = result.initial.mean.get(key).zip(self.mean.get(key));
            both.and_then(|(from, to)| percent_change(from, to)).unwrap_or_else(|| "–".to_owned())
        };
        self.gain.get(key).map_or_else(change, |gain| gain_words(key, gain))
    }
}

/// The measures that lines tell, in the order in which the present layout has them: those with confirmed gains, else the
/// objectives.
pub fn told_measures(result: &RoundResult) -> Vec<String> {
    let gains = result.candidates.iter().map(|c| &c.gain).chain(result.best.iter().map(|b| &b.gain));
    let confirmed: BTreeSet<&String> = gains.flat_map(Gains::keys).collect();
    if confirmed.is_empty() {
        let objectives = result.objectives.iter().map(|o| &o.name);
        return objectives.filter(|name| result.initial.mean.get(name).is_some()).cloned().collect();
    }
    let known = result.initial.mean.0.iter().map(|(key, _)| key).filter(|key| confirmed.contains(key));
    let others = confirmed.iter().copied().filter(|key| result.initial.mean.get(key).is_none());
    known.chain(others).cloned().collect()
}

fn changes_of(result: &RoundResult, of: &Candidate) -> String {
    let all = [titles(&of.works), movers_of(result, &of.parameters)];
    all.into_iter().filter(|m| !m.is_empty()).collect::<Vec<_>>().join("; ")
}

fn movers_of(result: &RoundResult, parameters: &[f64]) -> String {
    let names = movers(&result.moves, parameters);
    let named = names.iter().take(MOVERS_NAMED).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MOVERS_NAMED) {
        0 => named,
        more => format!("{named} and {more} more"),
    }
}

/// Metres of wall that stand elsewhere than now; of a wall that only grows or shrinks, what is added or taken away.
fn rebuilt_m(changes: &[Change]) -> f64 {
    changes.iter().filter(|c| !c.follows).map(|c| rebuilt_of(&c.from, &c.to)).sum()
}

fn rebuilt_of(from: &[[f64; 2]], to: &[[f64; 2]]) -> f64 {
    let apart = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let length = |line: &[[f64; 2]]| line.windows(2).map(|s| apart(s[0], s[1])).sum::<f64>();
    if from.len() != to.len() {
        return length(to);
    }
    let piece = |(old, new): (&[[f64; 2]], &[[f64; 2]])| {
        let [was, now] = [apart(old[0], old[1]), apart(new[0], new[1])];
        let along = [0, 1].map(|k| if was > SAME_M { (old[1][k] - old[0][k]) / was } else { 0.0 });
        // Both new ends on the old line: it slid or grew along itself.
        let beside = |p: [f64; 2]| ((p[0] - old[0][0]) * along[1] - (p[1] - old[0][1]) * along[0]).abs();
        let stands = |p: [f64; 2]| (p[0] - old[0][0]) * along[0] + (p[1] - old[0][1]) * along[1];
        if was <= SAME_M || beside(new[0]) > SAME_M || beside(new[1]) > SAME_M {
            return now;
        }
        let (a, b) = (stands(new[0]), stands(new[1]));
        let kept = (a.max(b).min(was) - a.min(b).max(0.0)).max(0.0);
        (was - kept).max(now - kept)
    };
    from.windows(2).zip(to.windows(2)).map(piece).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_rebuilt_is_what_stands_elsewhere() {
        let wall = [[0.0, 0.0], [4.0, 0.0]];
        for (to, metres) in [
            ([[0.0, 0.0], [4.0, 0.0]], 0.0),
            ([[0.0, 1.0], [4.0, 1.0]], 4.0),
            // It grows, shrinks, slides along itself.
            ([[0.0, 0.0], [5.5, 0.0]], 1.5),
            ([[0.0, 0.0], [3.0, 0.0]], 1.0),
            ([[1.0, 0.0], [5.0, 0.0]], 1.0),
            ([[9.0, 0.0], [13.0, 0.0]], 4.0),
        ] {
            assert!((rebuilt_of(&wall, &to) - metres).abs() < 1e-9, "{to:?}");
        }
        // One corner of a long outline.
        let outline = [[0.0, 0.0], [10.0, 0.0], [10.0, 3.0], [0.0, 3.0]];
        let moved = [[0.0, 0.0], [10.0, 0.0], [10.0, 3.5], [0.0, 3.5]];
        assert!((rebuilt_of(&outline, &moved) - 10.5).abs() < 1e-9);
        assert_eq!(rebuilt_of(&[], &[[0.0, 0.0], [2.0, 0.0]]), 2.0);
    }
}
