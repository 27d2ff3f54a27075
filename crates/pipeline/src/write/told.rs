//! What the report says of the options of a round: why there are fewer than wanted, why they are alike.

use std::collections::BTreeSet;

use crate::confirm::found::Found;
use crate::confirm::nothing::{GROUPS_TOLD, group_names, held_back, none_better, rules_clause};
use crate::measure::study::Study;
use crate::search::judged::{is_firm, pinned};
use crate::search::rules::broken_limits;
use crate::write::made::Made;
use enfilade_cad::drawing::Format;
use enfilade_config::{Method, Mode, Settings, Snap};
use enfilade_moves::Parameter;
use enfilade_overlay::measure::{number, numbers_apart, plain_name, sentence_case};
use enfilade_overlay::result::{Objective, Sense};
use enfilade_overlay::words::listed;
use enfilade_plan::markers::Kind;
use enfilade_report::{Place, Report, counted};

/// Code of what says that no option is better than the present layout.
pub(crate) const NONE_BETTER: &str = "none-better";

/// Says what pinned options break.
pub(crate) fn say_pinned(report: &mut Report, file: &str, made: &[Made]) {
    let broken = made.iter().map(|m| &m.explanation).enumerate().filter(|(_, e)| !e.breaks.is_empty());
    for (i, explanation) in broken {
        let text = format!(
            "Option {} is pinned, so it is kept although it breaks {}.",
            i + 1,
            explanation.breaks.join(" and ")
        );
        report.warn("pinned-breaks", Place::file(file), text);
    }
}

/// Says which objectives nothing is gained in without falling short of those before them.
pub(crate) fn say_out_of_reach(
    report: &mut Report,
    file: &str,
    (study, settings): (&Study, &Settings),
    found: &Found,
) {
    for o in out_of_reach(&found.objectives, &found.archive) {
        let text = format!(
            "{}: no layout gains in it and keeps the objectives before it. Put it before the others, or lower their \
             thresholds.{}",
            plain_name(&o.name),
            held_back(settings, group_names(study).len()) + &limits_words(study, settings, found)
        );
        report.warn("out-of-reach", Place::file(file), text);
    }
}

/// Objectives in which no layout that was measured gains and keeps those before them.
fn out_of_reach<'o>(objectives: &'o [Objective], archive: &[Vec<f64>]) -> Vec<&'o Objective> {
    let gains =
        |o: &Objective, value: f64| if o.sense == Sense::Max { value > o.initial } else { value < o.initial };
    // What was in reach when its stage began may have been surpassed since.
    let is_gained = |i: usize| {
        let before = |v: &Vec<f64>| (0..i).all(|j| objectives[j].keeps(v[j]));
        archive.iter().any(|v| before(v) && gains(&objectives[i], v[i]))
    };
    let is_lost = |(i, o): &(usize, &Objective)| {
        o.name != "penalty"
            && o.threshold > 0.0
            && o.reachable.is_some_and(|reachable| !gains(o, reachable))
            && !is_gained(*i)
    };
    objectives.iter().enumerate().filter(is_lost).map(|(_, o)| o).collect()
}

/// What the hard limits do, as numbers: how the present layout stands to them, how many layouts keep them, and what the
/// penalties cost there at least. Empty without limits, and where no layout keeps them, which is told by itself.
fn limits_words(study: &Study, settings: &Settings, found: &Found) -> String {
    if settings.limits.is_empty() || found.archive.is_empty() {
        return String::new();
    }
    let missed = broken_limits(study, settings, &study.initial);
    let present = match missed.as_slice() {
        [] => "The present layout keeps every hard limit".to_owned(),
        all => format!("The present layout misses {}", all.join(" and ")),
    };
    let penalty = found.objectives.iter().position(|o| o.name == "penalty");
    let least = penalty.map(|i| found.archive.iter().map(|v| v[i]).fold(f64::INFINITY, f64::min));
    let cost = match (least, penalty.map(|i| found.objectives[i].initial)) {
        (Some(least), Some(initial)) if least > initial => format!(
            " Each of these costs penalties of at least {}; the present layout costs {}. --penalty none counts none.",
            number(least),
            number(initial)
        ),
        _ => String::new(),
    };
    let kept = found.archive.len();
    format!(
        " {present}. Layouts that keep every hard limit and lose little: {kept} of {}.{cost}",
        found.evaluations
    )
}

/// Says which thresholds let options be worse than the present layout: so little is reachable, or so much do the objectives
/// before them cost. Firm thresholds beyond which nothing is gained are told by [`say_out_of_reach`].
pub(crate) fn say_below_present(report: &mut Report, file: &str, objectives: &[Objective], is_firm: bool) {
    for o in objectives.iter().filter(|o| o.name != "penalty" && o.name != "score" && o.threshold > 0.0) {
        let (Some(limit), Some(reachable)) = (o.limit, o.reachable) else { continue };
        let worse = if o.sense == Sense::Max { limit < o.initial } else { limit > o.initial };
        let gains = if o.sense == Sense::Max { reachable > o.initial } else { reachable < o.initial };
        if worse && (gains || !is_firm) {
            let [kept, present, reachable] = numbers_apart([limit, o.initial, reachable]);
            let text = format!(
                "{}: options may fall to {kept}; the present layout has {present}. At most {reachable} was in reach beside the \
                 objectives before it. Put it before the others to {} it.",
                plain_name(&o.name),
                if gains { "improve" } else { "keep" }
            );
            report.info("limit-below-present", Place::file(file), text);
        }
    }
}

/// Says why there are fewer options than wanted, where there are.
pub(crate) fn say_options(
    report: &mut Report,
    file: &str,
    study: &Study,
    settings: &Settings,
    (found, made, built, alike): (&Found, usize, usize, usize),
) {
    let place = || Place::file(file);
    if let Some(why) = &found.no_option {
        let text = why.clone() + &limits_words(study, settings, found);
        match built {
            0 => report.warn("no-option", place(), text),
            _ => report.info("no-move", place(), format!("Moves alone: {text}")),
        }
        return;
    }
    if found.unconfirmed > 0 {
        let text = format!(
            "Layouts left out because their gain was not confirmed on other lattices: {}.",
            found.unconfirmed
        );
        report.info("options-unconfirmed", place(), text);
    }
    if found.is_none_better {
        let text = format!(
            "{} The best of them is shown. {}{}",
            none_better(&counted(found.evaluations, "layout"), is_firm(settings)),
            more_words(study),
            held_back(settings, group_names(study).len()) + &limits_words(study, settings, found)
        );
        report.warn(NONE_BETTER, place(), text);
        return;
    }
    if found.unworthy > 0 {
        let text = format!(
            "Options left out because they are no better than the present layout: {}. {}",
            found.unworthy,
            more_words(study)
        );
        report.info("options-no-better", place(), text);
    }
    if settings.method == Method::Paper {
        let inside = found.members.iter().filter(|m| m.within_threshold).count();
        let wanted = if settings.mode == Mode::Best { 1 } else { settings.members };
        if inside < wanted {
            let text = format!(
                "{made} of {} found by the published method; {inside} of them inside all thresholds.",
                counted(wanted as u64, "option")
            );
            report.warn("few-options", place(), text);
        }
        return;
    }
    if found.alike + alike > 0 && made < settings.members {
        report.warn("options-left-out", place(), left_out_words(study, settings, made));
    } else if found.unworthy == 0 && settings.mode == Mode::Diverse && made < settings.members {
        let kept = pinned(settings).min(made);
        let inside = built + found.members.iter().skip(kept).filter(|m| m.within_threshold).count();
        let text = format!(
            "{inside} of {} found inside all thresholds{}. {}",
            counted(settings.members as u64, "option"),
            if kept > 0 { format!(", beside {kept} pinned") } else { String::new() },
            more_words(study)
        );
        report.warn("few-options", place(), text);
    }
}

/// What gives a search more to find.
fn more_words(study: &Study) -> String {
    let more = study.base.plan.format.marking().more;
    format!("More --evaluations, wider bounds or {more} may find more.")
}

/// Why there are fewer options than wanted, and how to get more.
fn left_out_words(study: &Study, settings: &Settings, made: usize) -> String {
    let names = group_names(study);
    let options = counted(made as u64, "option");
    let who = match names.as_slice() {
        few if few.len() <= GROUPS_TOLD => format!("Only {} may move.", listed(few, "and")),
        many => format!("{} groups may move.", many.len()),
    };
    format!(
        "{options} instead of {}: the other layouts look almost the same to a person. {who}{} {}",
        settings.members,
        rules_clause(settings, names.len()),
        more_words(study)
    )
}

/// The two options most alike.
pub(crate) struct Nearest {
    /// Their normalised distance, and what was wanted.
    pub(crate) distance: f64,
    pub(crate) wanted: f64,
    /// Whether the user pinned both.
    pub(crate) are_pinned: bool,
    /// Whether the search had its time to spread them.
    pub(crate) has_ended: bool,
}

/// Says that thresholds were lowered so that options differ.
pub(crate) fn say_lowered(report: &mut Report, file: &str, share: f64) {
    if share < 1.0 {
        let text = format!(
            "Thresholds were lowered to {:.0} % of what was asked, so that the options differ. `--thresholds firm` keeps them.",
            share * 100.0
        );
        report.info("thresholds-lowered", Place::file(file), text);
    }
}

/// Says where options stand nearer to each other than was wanted, as vectors.
pub(crate) fn say_alikeness(report: &mut Report, file: &str, settings: &Settings, nearest: Option<&Nearest>) {
    if let Some(nearest) = nearest.filter(|n| n.distance < n.wanted) {
        let text = format!(
            "The two options most alike stand {:.3} apart; {:.3} was wanted. {}",
            nearest.distance,
            nearest.wanted,
            remedy(settings, nearest)
        );
        report.info("options-alike", Place::file(file), text);
    }
}

/// Options whose maps of change correlate more than this, at the median, have the same idea in common.
const ALIKE: f64 = 0.5;

/// The moves that bring a part of the gain in every option.
pub(crate) fn shared_parts(made: &[Made]) -> Vec<String> {
    let Some((first, others)) = made.split_first() else { return Vec::new() };
    let is_shared =
        |name: &String| others.iter().all(|m| m.explanation.parts.iter().any(|p| p.name == *name));
    first
        .explanation
        .parts
        .iter()
        .map(|p| p.name.clone())
        .filter(is_shared)
        .map(|n| sentence_case(&n))
        .collect()
}

/// Says where options are alike to the people in them, and which moves make them so.
pub(crate) fn say_likeness(
    report: &mut Report,
    (file, format): (&str, Format),
    likeness: Option<f64>,
    shared: &[String],
) {
    let Some(likeness) = likeness.filter(|l| *l > ALIKE) else { return };
    let why = match shared {
        [] => String::new(),
        names => format!(" Each of them gains by {}.", listed(names, "and")),
    };
    let text = format!(
        "The options change much the same places: their maps correlate {likeness:.2}.{why} Lower thresholds, wider bounds \
         or {} make room for other ideas.",
        format.marking().more
    );
    report.info("options-alike", Place::file(file), text);
}

/// Names what moves on no module although one was asked for.
pub(crate) fn say_free_of_modules(report: &mut Report, file: &str, study: &Study, settings: &Settings) {
    let Some(snap) = settings.snap else { return };
    let free = free_of(&study.base.moves.parameters, snap);
    if !free.is_empty() {
        let text = format!(
            "--snap \"{snap}\"{} does not apply to {}: they move by any amount.",
            snap.metres_words(),
            listed(&free, "and")
        );
        report.info("snap-free", Place::file(file), text);
    }
}

/// What has no module of its own, each once.
fn free_of(parameters: &[Parameter], snap: Snap) -> Vec<String> {
    let is_free = |p: &&Parameter| match p.clause.kind {
        Kind::Scale(_) => true,
        Kind::Rotate(_) => snap.angle_deg.is_none(),
        _ => snap.length_m.is_none(),
    };
    let named = |p: &Parameter| format!("{} ({})", sentence_case(&p.group_name), p.clause.kind.name());
    let free: BTreeSet<String> = parameters.iter().filter(is_free).map(named).collect();
    free.into_iter().collect()
}

/// What makes options differ more, by what is asked for now.
fn remedy(settings: &Settings, nearest: &Nearest) -> &'static str {
    if nearest.are_pinned {
        return "Both are pinned.";
    }
    if !nearest.has_ended {
        return "The search spreads them as it ends.";
    }
    match settings.objectives.as_slice() {
        all if all.iter().all(|o| o.threshold == 0.0) => {
            "More --evaluations or wider bounds give options that differ more."
        }
        [_] => "A lower threshold, more --evaluations or wider bounds give options that differ more.",
        _ => {
            "Lower thresholds, fewer objectives or --objective \"score max 0.7\" give options that differ more."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_config::Partial;
    use enfilade_plan::markers::Clause;

    /// What was in reach when its stage began may have been surpassed since.
    #[test]
    fn what_is_gained_is_not_told_to_be_out_of_reach() {
        let objective = |name: &str, initial: f64, reachable: f64| Objective {
            name: name.into(),
            sense: Sense::Max,
            threshold: 0.7,
            initial,
            best: None,
            reachable: Some(reachable),
            limit: Some(initial),
            free: None,
        };
        let objectives = [objective("degree", 10.0, 12.0), objective("entropy", 1.0, 0.9)];
        let told = |archive: &[[f64; 2]]| -> Vec<String> {
            let archive: Vec<Vec<f64>> = archive.iter().map(|v| v.to_vec()).collect();
            out_of_reach(&objectives, &archive).into_iter().map(|o| o.name.clone()).collect()
        };
        assert_eq!(told(&[[11.0, 0.9]]), ["entropy"]);
        assert_eq!(told(&[[11.0, 0.9], [11.0, 1.1]]), Vec::<String>::new());
        // It gains, and falls short of the objective before.
        assert_eq!(told(&[[9.0, 1.1]]), ["entropy"]);
    }

    #[test]
    fn what_is_alike_is_told_with_what_can_be_done_about_it() {
        let settings = Settings::new(Partial::default()).unwrap();
        let told = |are_pinned: bool, has_ended: bool| {
            let nearest = Nearest { distance: 0.1, wanted: 0.5, are_pinned, has_ended };
            let mut report = Report::default();
            say_alikeness(&mut report, "plan.dxf", &settings, Some(&nearest));
            report.problems[0].text.clone()
        };
        let all = [told(true, true), told(false, false), told(false, true)];
        assert!(all[0] != all[1] && all[1] != all[2] && all[0] != all[2]);
        let mut report = Report::default();
        let far = Nearest { distance: 0.6, wanted: 0.5, are_pinned: true, has_ended: true };
        say_alikeness(&mut report, "plan.dxf", &settings, Some(&far));
        assert!(report.problems.is_empty());
    }

    #[test]
    fn a_limit_that_is_worse_than_the_present_is_told() {
        let of = |sense, initial, limit, reachable| Objective {
            name: "degree-min".into(),
            sense,
            threshold: 0.3,
            initial,
            best: Some(reachable),
            free: None,
            reachable: Some(reachable),
            limit: Some(limit),
        };
        let told_if = |o: Objective, is_firm: bool| {
            let mut report = Report::default();
            say_below_present(&mut report, "plan.dxf", &[o], is_firm);
            report.problems.first().map(|p| p.text.clone())
        };
        let told = |o: Objective| told_if(o, true);
        let holds = |text: &str, numbers: [&str; 3]| numbers.iter().all(|n| text.contains(n));
        let text = told(of(Sense::Max, 242.0, 240.6, 244.0)).unwrap();
        assert!(holds(&text, ["241", "242", "244"]), "{text}");
        let near = told(of(Sense::Max, 561.2, 560.9, 564.0)).unwrap();
        assert!(holds(&near, ["560.9", "561.2", "564.0"]), "{near}");
        assert!(told(of(Sense::Min, 2.0, 2.1, 1.9)).is_some());
        let far = of(Sense::Min, 2.82, 3.83, 3.5);
        assert!(told_if(far.clone(), false).is_some());
        assert_eq!(told(far), None, "told otherwise");
        assert_eq!(told(of(Sense::Max, 242.0, 243.0, 244.0)), None);
    }

    #[test]
    fn what_keeps_to_no_module_is_named() {
        let moved = |name: &str, kind: Kind| Parameter {
            group_name: name.into(),
            group: 0,
            stated: [-1.0, 1.0],
            clause: Clause { kind, lower: -1.0, upper: 1.0, unit: "m".into(), si_per_unit: 1.0 },
        };
        let all =
            [moved("door-1", Kind::X), moved("kiosk", Kind::Rotate(None)), moved("kiosk", Kind::Scale(None))];
        assert_eq!(free_of(&all, "0.1 m".parse().unwrap()), ["Kiosk (rotate)", "Kiosk (scale)"]);
        assert_eq!(free_of(&all, "5 deg".parse().unwrap()), ["Door 1 (x)", "Kiosk (scale)"]);
        assert_eq!(free_of(&all[..2], "0.1 m, 5 deg".parse().unwrap()), [""; 0]);
    }
}
