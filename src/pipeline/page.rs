//! The report page of a round, from the round's own files.

use super::Input;
use super::round::Found;
use super::show::SHOWN;
use crate::config::{Backend, Level, Method, Mode, Settings, Thresholds};
use crate::overlay::page::{ArchivePoint, ReportInput, View, report_html};
use crate::overlay::result::RoundResult;
use crate::report::OutFile;

/// Most layouts of the archive that the page shows.
const ARCHIVE_SHOWN_MAX: usize = 400;

/// `report.html`.
pub(super) fn page(
    input: &Input<'_>,
    settings: &Settings,
    result: &RoundResult,
    files: &[OutFile],
    understood: &[u8],
    found: Option<&Found>,
) -> String {
    let png = |name: &str| files.iter().find(|f| f.path.as_os_str() == name).map(|f| f.bytes.as_slice());
    let views = |stem: &str| {
        let view = |m: &crate::config::Measure| {
            let png = png(&format!("{stem}-{}.png", m.name()))?;
            Some(View { measure: m.name(), png })
        };
        SHOWN.iter().filter_map(view).collect::<Vec<_>>()
    };
    let stems = (1..=result.candidates.len()).map(|i| format!("candidate-{i}"));
    let (archive_axes, archive) = archive(result, found);
    report_html(&ReportInput {
        result,
        round: input.round,
        present: views("initial"),
        candidates: stems.map(|s| views(&s)).collect(),
        diversity: png("diversity.png").filter(|_| !result.candidates.is_empty()),
        convergence: png("convergence.png").filter(|_| found.is_some()),
        understood: Some(understood),
        archive_axes,
        archive,
        command: &command(input, settings, result),
        program: concat!("Enfilade ", env!("CARGO_PKG_VERSION")),
    })
}

/// An even sample of what was measured, and the members.
fn archive(result: &RoundResult, found: Option<&Found>) -> (Vec<String>, Vec<ArchivePoint>) {
    let Some(found) = found else { return (Vec::new(), Vec::new()) };
    let axes: Vec<String> = result.objectives.iter().map(|o| o.name.clone()).collect();
    let step = found.archive.len().div_ceil(ARCHIVE_SHOWN_MAX).max(1);
    let mut out: Vec<ArchivePoint> = found
        .archive
        .iter()
        .step_by(step)
        .map(|values| ArchivePoint { values: values.clone(), candidate: None })
        .collect();
    for (i, member) in found.members.iter().enumerate() {
        out.push(ArchivePoint { values: member.values.clone(), candidate: Some(i) });
    }
    (axes, out)
}

/// The command line that gives the same round again: what differs from the defaults, and the budget.
fn command(input: &Input<'_>, settings: &Settings, result: &RoundResult) -> String {
    let mut out = format!("enfilade run {}", quoted(input.path));
    let mut add = |key: &str, value: String| out.push_str(&format!(" --{key} {}", quoted(&value)));
    let optional = [
        ("unit", &settings.unit),
        ("query-layer", &settings.query_layer),
        ("reference-layer", &settings.reference_layer),
        ("view", &settings.view),
    ];
    for (key, value) in optional {
        if let Some(v) = value {
            add(key, v.clone());
        }
    }
    settings.wall_layers.iter().for_each(|l| add("wall-layer", l.clone()));
    add("spacing", result.spacing_m.to_string());
    if let Some(c) = settings.lattice_centre_m {
        add("lattice-centre", format!("{},{}", c[0], c[1]));
    }
    settings.seed_points.iter().for_each(|p| add("seed-point", format!("{},{}", p[0], p[1])));
    if settings.level == Level::Knee {
        add("level", "knee".into());
    }
    if settings.backend == Backend::Gpu {
        add("backend", "gpu".into());
    }
    add("objective", settings.objective_text());
    if settings.thresholds == Thresholds::Yielding {
        add("thresholds", "yielding".into());
    }
    add("score", settings.score_text());
    add("penalty", settings.penalty_text());
    let limits = settings.limit_text();
    if !limits.is_empty() {
        add("limit", limits);
    }
    settings.links.iter().for_each(|l| add("link", l.to_string()));
    if let Some(snap) = settings.snap {
        add("snap", snap.to_string());
    }
    if let Some(most) = settings.most_moves {
        add("most-moves", most.to_string());
    }
    if settings.only_marked {
        out.push_str(" --only-marked");
    }
    let mut add = |key: &str, value: String| out.push_str(&format!(" --{key} {}", quoted(&value)));
    if settings.mode == Mode::Best {
        add("mode", "best".into());
    }
    if settings.method == Method::Paper {
        add("method", "paper".into());
    }
    add("members", settings.members.to_string());
    add("evaluations", result.evaluations.to_string());
    add("seed", settings.seed.to_string());
    out + &in_a_settings_file(settings)
}

/// What the command line cannot say: layouts by their parameters.
fn in_a_settings_file(settings: &Settings) -> String {
    let lists = [("pin", &settings.pinned), ("warm", &settings.warm)];
    let lists = lists.into_iter().filter(|l| !l.1.is_empty()).map(|(key, v)| format!("{key} = {v:?}"));
    let lines: Vec<String> = lists.chain(settings.like.iter().map(|v| format!("like = {v:?}"))).collect();
    if lines.is_empty() {
        String::new()
    } else {
        format!(
            "\n# with these lines in the side-car beside the drawing (NAME.enfilade.toml):\n{}",
            lines.join("\n")
        )
    }
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
