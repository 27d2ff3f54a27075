//! What a round says on the terminal: what was read, a table of options, what to do next.

use std::path::Path;

use super::{ask, counted};
use crate::cli::RunArgs;
use crate::output::say;
use enfilade_overlay::measure::{plain_name, trimmed};
use enfilade_overlay::options::{OptionLine, option_lines, told_measures};
use enfilade_overlay::result::RoundResult;
use enfilade_report::{Report, Severity};

/// Notes that stand in the short summary too: they qualify what the table says.
const QUALIFYING: [&str; 1] = ["thresholds-lowered"];

/// Notes that stand there where there is no option: what may move and how to say it better, what would help instead.
const INSTEAD: [&str; 4] = ["default-moves", "work-allowed", "work-forbidden", "works-tried"];

/// The summary of a round, `folder` being where its files are.
pub(super) fn summary(result: &RoundResult, args: &RunArgs, folder: &Path) {
    let drawing = &args.file;
    ask(&result.questions);
    say(&read_line(result, drawing));
    say(&format!(
        "{} measured in {:.1} s; {}",
        counted(result.evaluations, "layout"),
        result.seconds,
        result.stopped_by
    ));
    let rows = table(result);
    if rows.len() > 1 {
        say("");
        aligned(&rows).iter().for_each(|line| say(line));
        say("");
    }
    if args.verbose {
        let options = result.candidates.iter().enumerate();
        options.for_each(|(i, c)| say(&format!("option {}{}: {}", i + 1, result.mark(i), c.words)));
        result.best.iter().filter(|b| b.option.is_none()).for_each(|b| say(&format!("best: {}", b.words)));
    }
    let what = if result.candidates.is_empty() { "The present layout" } else { "Compare them" };
    say(&format!("{what}: {}", folder.join("report.html").display()));
    let first = match (&result.best, result.candidates.is_empty()) {
        (_, false) => "1",
        (Some(_), true) => "best",
        _ => return,
    };
    let out = args.common.out.as_ref().map(|out| format!(" --out {}", out.display())).unwrap_or_default();
    say(&format!("Take one: enfilade accept {} {first}{out}", drawing.display()));
}

/// The findings that the short summary shows, and how many notes it leaves out.
pub(super) fn shown(report: &Report, is_verbose: bool, has_options: bool) -> (Report, usize) {
    let is_shown = |code: &str, severity: Severity| {
        let is_wanted = QUALIFYING.contains(&code) || (!has_options && INSTEAD.contains(&code));
        is_verbose || severity > Severity::Info || is_wanted
    };
    let mut out = report.clone();
    out.problems.retain(|p| is_shown(p.code, p.severity));
    let left = report.problems.len() - out.problems.len();
    (out, left)
}

/// `gallery.dxf: unit m, 204 m² measured, 18 walls, 7 may move`.
fn read_line(result: &RoundResult, drawing: &Path) -> String {
    let mut names: Vec<&str> = result.moves.iter().map(|m| m.name.as_str()).collect();
    names.dedup();
    let area_m2 = result.counts.vertices as f64 * result.spacing_m * result.spacing_m;
    format!(
        "{}: unit {}, {} m² measured, {}, {} may move",
        drawing.file_name().unwrap_or_default().to_string_lossy(),
        result.input.unit,
        trimmed(area_m2, 0),
        counted(result.counts.walls, "wall"),
        counted(names.len() as u64, "group"),
    )
}

/// A heading and a line for every option; the best layout found has one where it is no option.
fn table(result: &RoundResult) -> Vec<Vec<String>> {
    let keys = told_measures(result);
    let heading = keys.iter().map(|k| plain_name(k));
    let heading = std::iter::once(String::new()).chain(heading);
    let line = |line: OptionLine<'_>| {
        let gained: Vec<String> = keys.iter().map(|key| line.gained(result, key)).collect();
        let rebuilt = format!("{} m", trimmed(line.rebuilt_m, 1));
        std::iter::once(line.name).chain(gained).chain([rebuilt, line.movers]).collect()
    };
    let heading = heading.chain(["Rebuilt".to_owned(), "What changes".to_owned()]).collect();
    std::iter::once(heading).chain(option_lines(result).into_iter().map(line)).collect()
}

/// Rows with their columns under one another.
fn aligned(rows: &[Vec<String>]) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
    let width = |k: usize| rows.iter().filter_map(|r| r.get(k)).map(|c| c.chars().count()).max();
    let widths: Vec<usize> = (0..columns).filter_map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_overlay::result::{Best, Candidate, Gain, Gains, MoveEntry, MoveKind, Numbers, Sense};
    use enfilade_report::Place;

    fn moved(name: &str) -> MoveEntry {
        MoveEntry {
            name: name.into(),
            kind: MoveKind::X,
            lower: -1.0,
            upper: 1.0,
            unit: "m".into(),
            direction_deg: None,
            elements: Vec::new(),
            geometry: String::new(),
        }
    }

    #[test]
    fn options_stand_in_a_table_with_their_confirmed_gains() {
        let gain = |share: f64, sense| Gain { share, low: share - 0.02, high: share + 0.02, sense };
        let gains = Gains::from([
            ("mean-depth".to_owned(), gain(0.06, Sense::Min)),
            ("degree".to_owned(), gain(0.34, Sense::Max)),
        ]);
        let result = RoundResult {
            initial: enfilade_overlay::result::Layout {
                mean: Numbers::of([("degree", 400.0), ("depth", 3.0), ("mean-depth", 2.0)]),
                ..Default::default()
            },
            moves: ["a", "b", "c", "d", "e", "f"].map(moved).to_vec(),
            candidates: vec![Candidate {
                parameters: vec![0.1, 0.0, 0.4, 0.3, 0.5, 0.2],
                gain: gains.clone(),
                within_threshold: true,
                ..Default::default()
            }],
            best: Some(Best {
                parameters: vec![0.0, 0.5, 0.0, 0.0, 0.0, 0.0],
                gain: gains,
                ..Default::default()
            }),
            ..Default::default()
        };
        assert_eq!(
            aligned(&table(&result)),
            [
                "      Visibility          Steps              Rebuilt  What changes",
                "1     +34 % (32 to 36 %)  −6 % (−8 to −4 %)  0 m      E, C, D, F and 1 more",
                "best  +34 % (32 to 36 %)  −6 % (−8 to −4 %)  0 m      B",
            ]
        );
    }

    #[test]
    fn notes_wait_for_verbose_but_for_those_that_qualify_the_table() {
        let mut report = Report::default();
        report.info("spacing", Place::default(), "spacing 0.4 m");
        report.info("thresholds-lowered", Place::default(), "lowered");
        report.warn("fewer", Place::default(), "3 options instead of 5");
        let codes = |r: &Report| r.problems.iter().map(|p| p.code).collect::<Vec<_>>();
        let (short, left) = shown(&report, false, true);
        assert_eq!((codes(&short), left), (vec!["thresholds-lowered", "fewer"], 1));
        report.info("work-allowed", Place::default(), "An opening of 1.8 m between Kitchen and Living room");
        report.info("default-moves", Place::default(), "nothing may move: draw EF-MOVE");
        assert_eq!(codes(&shown(&report, false, true).0).len(), 2);
        let instead = ["thresholds-lowered", "fewer", "work-allowed", "default-moves"];
        assert_eq!(codes(&shown(&report, false, false).0), instead);
        assert_eq!(shown(&report, true, true), (report, 0));
    }
}
