//! `result.json` of a round.

use crate::confirm::found::Found;
use crate::job::Job;
use crate::measure::ruler::ruler;
use crate::measure::study::Study;
use crate::round::Round;
use crate::works::Offer;
use crate::write::changes::changes;
use crate::write::diversity::{distances, likeness};
use crate::write::made::Made;
use crate::write::{along, briefed, doors, leaving, show};
use enfilade_config::Settings;
use enfilade_overlay::result::{
    self, Best, Candidate, Diversity, FrontPoint, Gains, LineageEntry, MoveEntry, Numbers, Objective,
    RoundResult,
};
use enfilade_overlay::words;
use enfilade_report::Report;

pub(crate) fn round_result(
    round: &Round<'_>,
    report: &Report,
    (found, offer): (Option<&Found>, Option<&Offer>),
    (made, best): (&[Made], Option<&Made>),
) -> RoundResult {
    let Round { job: Job { input, settings }, study, started, .. } = *round;
    let moves = show::move_entries(&study.base);
    let settings_map = match serde_json::to_value(settings) {
        Ok(serde_json::Value::Object(map)) => map,
        _ => serde_json::Map::new(),
    };
    let initial = result::Layout {
        mean: show::mean_numbers(study, &study.initial),
        penalty: show::penalty_numbers(&study.initial),
    };
    let of = |m: &Made| candidate(round, &moves, &initial.mean, m);
    let candidates: Vec<Candidate> = made.iter().map(of).collect();
    let still = study.base.moves.identity();
    let option_of = |point: &FrontPoint| {
        let is = |c: &Candidate| c.works == point.works && c.parameters == still;
        candidates.iter().position(is).map(|i| i + 1)
    };
    let points = offer.into_iter().flat_map(|o| &o.front);
    let front = points.map(|p| FrontPoint { option: option_of(p), ..p.clone() }).collect();
    let all = made;
    let best = best.map(|made| {
        let of = candidate(round, &moves, &initial.mean, made);
        Best {
            file: of.file,
            parameters: of.parameters,
            mean: of.mean,
            penalty: of.penalty,
            score: of.score,
            gain: of.gain,
            words: of.words,
            option: same_as(made, all),
            changes: of.changes,
        }
    });
    RoundResult {
        schema: result::RESULT_SCHEMA.into(),
        version: enfilade_config::VERSION.into(),
        input: show::input(&study.base.plan, input),
        settings: settings_map,
        counts: show::counts(study, study.edges),
        spacing_m: study.spacing_m,
        lattice_centre: crate::write::show::lattice_centre(study),
        initial,
        moves,
        objectives: of_works(offer).unwrap_or_else(|| found.map_or(Vec::new(), |f| f.objectives.clone())),
        candidates,
        best,
        diversity: Diversity { likeness: likeness(study, made), ..distances(study, made) },
        evaluations: found.map_or(0, |f| f.evaluations),
        seconds: started.elapsed().as_secs_f64(),
        stopped_by: found
            .map_or("nothing may move: the present layout was measured".into(), |f| f.stopped_by.clone()),
        lineage: lineage(settings, &ruler(&study.base.plan, settings, study.spacing_m)),
        problems: report.problems.iter().map(Into::into).collect(),
        questions: Vec::new(),
        brief: round.brief.clone(),
        front,
    }
}

/// Which option a layout is, from 1.
fn same_as(layout: &Made, options: &[Made]) -> Option<usize> {
    let is = |m: &Made| m.built.is_none() && m.member.parameters == layout.member.parameters;
    options.iter().position(is).map(|i| i + 1)
}

/// What is asked for where works are options.
fn of_works(offer: Option<&Offer>) -> Option<Vec<Objective>> {
    offer.filter(|o| !o.options.is_empty()).map(|o| o.objectives.clone())
}

pub(crate) fn candidate(round: &Round<'_>, moves: &[MoveEntry], initial: &Numbers, made: &Made) -> Candidate {
    let (study, settings) = (round.study, round.job.settings);
    let mean = show::mean_numbers(study, &made.worth);
    let (explanation, gain) = (&made.explanation, made.gains.clone());
    let told = gains_words(study, initial, &mean, &gain);
    Candidate {
        file: format!("{}.{}", made.name, study.base.plan.format.name()),
        parameters: made.member.parameters.clone(),
        words: match &made.built {
            Some(built) => {
                let moves = built.moves_words(&words::by_north(moves, study.base.plan.north_deg));
                if moves.is_empty() { built.words(&told) } else { format!("{} {moves}.", built.words(&told)) }
            }
            None => words::words(
                &words::by_north(moves, study.base.plan.north_deg),
                &made.member.parameters,
                &told,
                explanation,
            ),
        } + &along::goes_along_words(&study.base, made)
            + &along::furniture_words(&study.base, &made.layout)
            + &along::unseen_words(made)
            + &leaving::leaving_words(&study.base.plan, &made.layout)
            + &doors::narrowed_words(&study.base, &made.layout)
            + &briefed::words(&round.brief, &made.brief)
            + &along::stays_words(&made.report),
        explanation: explanation.clone(),
        mean,
        penalty: show::penalty_numbers(&made.worth),
        score: Some(study.score(&made.worth, settings)),
        gain,
        pinned: made.is_pinned,
        within_threshold: made.member.within_threshold && explanation.breaks.is_empty(),
        changes: changes(study, made),
        works: made.built.as_ref().map_or(Vec::new(), |b| b.works.clone()),
        brief: made.brief.clone(),
    }
}

/// What is gained, in words: what was confirmed, else what was measured on the lattice shown.
pub(crate) fn gains_words(study: &Study, initial: &Numbers, mean: &Numbers, gain: &Gains) -> String {
    if gain.is_empty() {
        words::gains(&told(study, initial), &told(study, mean))
    } else {
        words::confirmed(initial, gain)
    }
}

/// What is told in words: the three of the paper, what each named pair sees, and what else was asked for.
pub(crate) fn told(study: &Study, mean: &Numbers) -> Numbers {
    let is_asked = |name: &str| study.aims.iter().any(|a| a.to_string() == name);
    let is_told = |name: &str| {
        let is_of_pair = name.contains('@');
        name != "degree_all" && (!is_of_pair || name.starts_with("degree@") || is_asked(name))
    };
    Numbers(mean.0.iter().filter(|(name, _)| is_told(name)).cloned().collect())
}

/// The rounds before, as this one, whose mark of spacing and regions is `ruler`, has them.
pub(crate) fn lineage(settings: &Settings, ruler: &str) -> Vec<LineageEntry> {
    let entry = |entry: &enfilade_config::LineageTable| LineageEntry {
        drawing: entry.drawing.clone(),
        round: u64::from(entry.round),
        so_far: entry.so_far,
        other_ruler: !entry.ruler.is_empty() && entry.ruler != ruler,
        candidate: Some(u64::from(entry.candidate)),
        point: entry.point.map(u64::from),
        mean: Numbers::of(entry.initial.iter().map(|(k, v)| (k.clone(), *v))),
        score: None,
    };
    settings.lineage.iter().map(entry).collect()
}
