//! The report page of a round, from the round's own files.

use crate::confirm::found::Found;
use crate::job::{Input, Job};
use crate::works::Listed;
use crate::write::made::Made;
use crate::write::maps::Map;
use enfilade_config::{
    Allow, Backend, Budget, Colours, Level, Method, Mode, NONE, Overlay, PinnedWork, Settings, Thresholds,
    Unsure,
};
use enfilade_overlay::measure::CHANGE;
use enfilade_overlay::page::{ArchivePoint, ReportInput, View, report_html};
use enfilade_overlay::result::{RoundResult, Sense};
use enfilade_report::OutFile;

/// Most layouts of the archive that the page shows.
const ARCHIVE_SHOWN_MAX: usize = 400;

/// `report.html`.
pub(crate) fn page(
    job: Job<'_>,
    result: &RoundResult,
    (files, maps): (&[OutFile], &[Map]),
    (understood, works): (Option<&[u8]>, Option<&Listed>),
    (found, made): (Option<&Found>, &[Made]),
) -> String {
    let Job { input, settings } = job;
    let png = |name: &str| files.iter().find(|f| f.path.as_os_str() == name).map(|f| f.bytes.as_slice());
    let changed = |m: &Map| [(m.key(), m.file()), (m.key() + CHANGE, m.file() + CHANGE)];
    let names: Vec<(String, String)> = maps.iter().flat_map(changed).collect();
    let views = |stem: &str| {
        let view = |(key, file)| Some(View { measure: key, png: png(&format!("{stem}-{file}.png"))? });
        names.iter().map(|(k, f)| (k.as_str(), f.as_str())).filter_map(view).collect::<Vec<_>>()
    };
    let stems = (1..=result.candidates.len()).map(|i| format!("candidate-{i}"));
    let (archive_axes, archive) = archive(result, found, made);
    report_html(&ReportInput {
        result,
        round: input.round,
        present: views("initial"),
        candidates: stems.map(|s| views(&s)).collect(),
        best: views("best"),
        diversity: png("diversity.png").filter(|_| !result.candidates.is_empty()),
        convergence: png("convergence.png").filter(|_| found.is_some()),
        understood,
        brief_picture: png("brief.png"),
        works: works.map(|w| &w.result),
        works_picture: works.and_then(|w| w.picture.as_deref()),
        archive_axes,
        archive,
        command: &command(input, settings, result),
        program: &format!("Enfilade {}", enfilade_config::VERSION),
    })
}

/// Layouts among which the Pareto front is looked for at most: every one is compared with every other.
const FRONT_AMONG_MAX: usize = 4_000;

/// An even sample of what was measured, the Pareto front and the members.
fn archive(result: &RoundResult, found: Option<&Found>, made: &[Made]) -> (Vec<String>, Vec<ArchivePoint>) {
    let Some(found) = found else { return (Vec::new(), Vec::new()) };
    let axes: Vec<String> = result.objectives.iter().map(|o| o.name.clone()).collect();
    let spread = |most: usize| found.archive.iter().step_by(found.archive.len().div_ceil(most).max(1));
    let among: Vec<&Vec<f64>> = spread(FRONT_AMONG_MAX).collect();
    let signs: Vec<f64> =
        result.objectives.iter().map(|o| if o.sense == Sense::Max { 1.0 } else { -1.0 }).collect();
    let point =
        |values: &Vec<f64>, is_front| ArchivePoint { values: values.clone(), candidate: None, is_front };
    let mut out: Vec<ArchivePoint> = spread(ARCHIVE_SHOWN_MAX).map(|v| point(v, false)).collect();
    out.extend(front(&among, &signs).into_iter().map(|v| point(v, true)));
    for (i, m) in made.iter().enumerate() {
        out.push(ArchivePoint { values: m.member.values.clone(), candidate: Some(i), is_front: false });
    }
    (axes, out)
}

/// The layouts that no other beats: as good in everything and better in something. `signs`: 1 where more is
/// better, −1 where less is.
fn front<'a>(among: &[&'a Vec<f64>], signs: &[f64]) -> Vec<&'a Vec<f64>> {
    let beats = |a: &[f64], b: &[f64]| {
        let ahead = |a: &[f64], b: &[f64]| a.iter().zip(b).zip(signs).any(|((x, y), s)| s * x > s * y);
        ahead(a, b) && !ahead(b, a)
    };
    among.iter().filter(|v| !among.iter().any(|other| beats(other, v))).copied().collect()
}

/// The command line that gives the same round again in the drawing's folder, wherever that has been moved to, whatever the
/// settings there say; of a search by the clock, what comes nearest to it.
fn command(input: &Input<'_>, settings: &Settings, result: &RoundResult) -> String {
    let mut out = format!("enfilade run {}", quoted(&as_an_argument(input.file())));
    let mut add = |key: &str, value: String| out.push_str(&format!(" --{key} {}", quoted(&value)));
    let optional = [
        ("unit", &settings.unit),
        ("query-layer", &settings.query_layer),
        ("reference-layer", &settings.reference_layer),
        ("view", &settings.view),
        ("storey", &settings.storey),
        ("query", &settings.query),
    ];
    for (key, value) in optional {
        if let Some(v) = value {
            add(key, v.clone());
        }
    }
    settings.wall_layers.iter().for_each(|l| add("wall-layer", l.clone()));
    settings.reading.options().into_iter().for_each(|(key, value)| add(key, value));
    add("spacing", result.spacing_m.to_string());
    if let Some(c) = settings.lattice_centre_m {
        add("lattice-centre", format!("{},{}", c[0], c[1]));
    }
    settings.seed_points.iter().for_each(|p| add("seed-point", format!("{},{}", p[0], p[1])));
    add("level", if settings.level == Level::Knee { "knee" } else { "eye" }.into());
    if settings.backend == Backend::Gpu {
        add("backend", "gpu".into());
    }
    add("objective", settings.objective_text());
    add("thresholds", if settings.thresholds == Thresholds::Yielding { "yielding" } else { "firm" }.into());
    if settings.unsure == Unsure::Optimise {
        add("unsure", "optimise".into());
    }
    add("score", settings.score_text());
    add("penalty", settings.penalty_text());
    rules(settings).into_iter().for_each(|(key, text)| add(key, text));
    if let Some(most) = settings.most_moves {
        add("most-moves", most.to_string());
    }
    if let Some(together) = settings.together {
        add("together", together.to_string());
    }
    add("least-gain", settings.least_gain.to_string());
    if settings.allow != Allow::default() {
        add("allow", settings.allow.to_string());
    }
    if !settings.brief.is_empty() {
        add("brief", settings.brief.join("; "));
    }
    if settings.budget != Budget::default() {
        add("budget", settings.budget.to_string());
    }
    if settings.over_stairs {
        out.push_str(" --over-stairs");
    }
    if settings.accept_missing_eof {
        out.push_str(" --accept-missing-eof");
    }
    if settings.reading.as_drawn == Some(true) {
        out.push_str(" --as-drawn");
    }
    if settings.only_marked {
        out.push_str(" --only-marked");
    }
    if settings.raw {
        out.push_str(" --raw");
    }
    if settings.until_converged {
        out.push_str(" --until-converged");
    }
    if settings.overlay == Overlay::Attach {
        out.push_str(" --overlay attach");
    }
    let mut add = |key: &str, value: String| out.push_str(&format!(" --{key} {}", quoted(&value)));
    add("mode", if settings.mode == Mode::Best { "best" } else { "diverse" }.into());
    add("method", if settings.method == Method::Paper { "paper" } else { "default" }.into());
    add("members", settings.members.to_string());
    add("distance", settings.distance.to_string());
    add("colours", if settings.colours == Colours::BlueToRed { "blue-to-red" } else { "safe" }.into());
    if result.evaluations > 0 {
        add("evaluations", result.evaluations.to_string());
    }
    add("seed", settings.seed.to_string());
    let by_clock = settings.seconds.is_some() && !settings.until_converged;
    let clock = match settings.seconds.filter(|_| by_clock) {
        Some(seconds) => format!(
            "\n# the round planned by the clock (--seconds {seconds}), as far as it came: planned by a number it may find other options"
        ),
        None => String::new(),
    };
    out + &clock + &in_a_settings_file(settings)
}

/// Limits, links and modules; what a file of settings may ask for is lifted where it did not hold.
fn rules(settings: &Settings) -> Vec<(&'static str, String)> {
    let none = || NONE.to_owned();
    let limit = Some(settings.limit_text()).filter(|t| !t.is_empty()).unwrap_or_else(none);
    let mut links: Vec<String> = settings.links.iter().map(ToString::to_string).collect();
    if links.is_empty() {
        links.push(none());
    }
    let snap = settings.snap.map_or_else(none, |s| s.to_string());
    [("limit", limit), ("snap", snap)].into_iter().chain(links.into_iter().map(|l| ("link", l))).collect()
}

/// What the command line cannot say: layouts by their parameters.
fn in_a_settings_file(settings: &Settings) -> String {
    let lists = [("pin", &settings.pinned), ("warm", &settings.warm)];
    let lists = lists.into_iter().filter(|l| !l.1.is_empty()).map(|(key, v)| format!("{key} = {v:?}"));
    let like = settings.like.iter().map(|v| format!("like = {v:?}"));
    let options = settings.pinned_options.iter().map(|o| {
        let work = |w: &PinnedWork| format!("{{ kind = {:?}, stretch = {:?} }}", w.kind, w.stretch);
        let works: Vec<String> = o.works.iter().map(work).collect();
        format!("[[pin-option]]\nparameters = {:?}\nworks = [{}]", o.parameters, works.join(", "))
    });
    let lines: Vec<String> = lists.chain(like).chain(options).collect();
    if lines.is_empty() {
        String::new()
    } else {
        format!(
            "\n# with these lines in the side-car beside the drawing (NAME.enfilade.toml):\n{}",
            lines.join("\n")
        )
    }
}

/// A file of the folder one is in, so that no program takes its name for an option.
fn as_an_argument(file: &str) -> String {
    if file.starts_with('-') { format!("./{file}") } else { file.into() }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:+=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.into()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Section 3 of the hazards, rule 10.
    #[test]
    fn names_are_arguments_never_options_nor_commands() {
        let argument = |file| quoted(&as_an_argument(file));
        assert_eq!(argument("plan.dxf"), "plan.dxf");
        assert_eq!(argument("-o.dxf"), "./-o.dxf");
        assert_eq!(argument("a$(x) 'b'.dxf"), r"'a$(x) '\''b'\''.dxf'");
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let all = [vec![1.0, 5.0], vec![2.0, 5.0], vec![3.0, 9.0], vec![2.0, 5.0], vec![0.0, 9.5]];
        let among: Vec<&Vec<f64>> = all.iter().collect();
        assert_eq!(front(&among, &[1.0, -1.0]), [&all[1], &all[2], &all[3]]);
        assert_eq!(front(&among, &[1.0, 1.0]), [&all[2], &all[4]]);
    }
}
