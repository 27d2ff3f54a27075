//! The settings' rules on the parameters: links, modules, pinned options; and why no option keeps the limits.

use crate::measure::limits;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::understand::understood::Understood;
use enfilade_config::{Aim, Bound, Follow, Held, Limit, Measure, Method, PairName, Penalty, Settings, Snap};
use enfilade_moves::control::{Breach, Control, Link, Rules};
use enfilade_moves::defaults::TURN_DEG;
use enfilade_moves::{Moves, Parameter};
use enfilade_overlay::measure::sentence_case;
use enfilade_overlay::words::listed as listed_and;
use enfilade_plan::markers::Kind;
use enfilade_report::{Error, Place, Report, counted};

/// Steps of default moves, metres of a person: five centimetres, two inches where the drawing is by the inch.
const STEP_M: f64 = 0.05;
const STEP_INCHES_M: f64 = 0.0508;

/// The turn by which what stood straight stands straight again.
const RIGHT_DEG: f64 = 90.0;

/// The parameters under the rules of the settings.
///
/// # Errors
/// [`Error::Usage`] where a link names an unknown group or an option has other parameters.
pub fn control(base: &Understood, settings: &Settings) -> Result<Control, Error> {
    controlled(base, &base.moves, settings)
}

fn controlled(base: &Understood, moves: &Moves, settings: &Settings) -> Result<Control, Error> {
    let link = |l: &enfilade_config::Link| Link {
        groups: l.groups.clone(),
        mirror: match l.follow {
            Follow::MirrorX => [-1.0, 1.0],
            Follow::MirrorY => [1.0, -1.0],
            Follow::Same | Follow::Equal => [1.0, 1.0],
        },
        is_row: l.follow == Follow::Equal,
    };
    let snap = steps(base, settings);
    let rules = Rules {
        links: settings.links.iter().filter(|l| !is_idle(base, l)).map(link).collect(),
        length_m: snap.length_m,
        angle_rad: snap.angle_deg.map(f64::to_radians),
        most_groups: settings.most_moves,
        like: settings.like.clone(),
        pinned: settings.pinned.clone(),
    };
    let count = base.moves.parameters.len();
    let control = match settings.warm.iter().find(|v| v.len() != count) {
        Some(v) => Err(format!(
            "warm: a layout of {}, the drawing has {count}",
            counted(v.len() as u64, "parameter")
        )),
        None => Control::new(moves, &rules),
    };
    control.map_err(|why| {
        Error::usage("rules", Place::file(&base.plan.file), format!("{why}; nothing was done"))
    })
}

/// The same with ways as far as they were stated, before anything ended them.
///
/// # Errors
/// As [`control`].
pub fn control_as_stated(base: &Understood, settings: &Settings) -> Result<Control, Error> {
    let mut moves = base.moves.clone();
    for p in &mut moves.parameters {
        p.clause = p.as_stated();
    }
    controlled(base, &moves, settings)
}

/// The modules that moves keep to: the user's, else of default moves what an architect draws by.
pub fn steps(base: &Understood, settings: &Settings) -> Snap {
    let is_ours = base.moves.are_default && settings.snap.is_none() && !settings.raw;
    if !is_ours || settings.method == Method::Paper || settings.allow.any_step {
        return settings.snap.unwrap_or_default();
    }
    let is_by_inches = matches!(base.plan.unit.unit.name, "in" | "ft");
    let step_m = if is_by_inches { STEP_INCHES_M } else { STEP_M } * base.plan.human_scale;
    let turns = base.moves.parameters.iter().filter(|p| matches!(p.clause.kind, Kind::Rotate(_)));
    // What turns askew turns less far; what turns by right angles may have a door on one of its ways.
    let is_right = turns.map(|p| p.clause.upper.max(-p.clause.lower)).fold(0.0, f64::max) > TURN_DEG;
    let mut snap = Snap::default();
    (snap.length_m, snap.angle_deg) = (Some(step_m), is_right.then_some(RIGHT_DEG));
    snap
}

/// Whether nothing that a link names moves: every group was left out as a whole.
fn is_idle(base: &Understood, link: &enfilade_config::Link) -> bool {
    let among = |list: &[Parameter], name: &String| list.iter().any(|p| p.group_name == *name);
    link.groups.iter().all(|g| among(&base.moves.left_out, g) && !among(&base.moves.parameters, g))
}

/// Says which rules cannot do what they seem to ask.
///
/// # Errors
/// As [`control`].
pub fn say_odd(base: &Understood, settings: &Settings, report: &mut Report) -> Result<(), Error> {
    let place = || Place::file(&base.plan.file);
    let stuck = control(base, settings)?.without_a_step();
    if !stuck.is_empty() && settings.snap.is_some() {
        let snap = settings.snap.map_or(String::new(), |s| format!("{s}{}", s.metres_words()));
        let text = format!(
            "snap {snap}: no step of the module fits within the bounds of {}; they stay as drawn",
            listed(base, &stuck)
        );
        report.warn("snap-too-wide", place(), text);
    }
    say_how_read(settings, &place, report);
    say_anew(settings, &place, report);
    Ok(())
}

/// Says how changes in per cent are read that could mean the other way as well.
fn say_how_read(settings: &Settings, place: &dyn Fn() -> Place, report: &mut Report) {
    for limit in &settings.limits {
        let Bound::Change(share) = limit.bound else { continue };
        let percent = (share.abs() * 1e8).round() / 1e6;
        let text = limit.to_string();
        let what = text.split_whitespace().next().unwrap_or_default();
        let text = match (limit.is_least, limit.held) {
            (true, _) if share < 0.0 && holds_less(limit, settings) => format!(
                "`{limit}` is read as a least: no option has over {percent} % less, although less of it is better; \
                 `{what} <= -{percent}%` asks for at least so much less, `{what} +{percent}%` for no more than so much more"
            ),
            (false, Held::Aim(_)) if share > 0.0 => format!(
                "`{limit}` is read as a most: no option has over {percent} % more; `{what} >= +{percent}%` asks for at least so much"
            ),
            _ => continue,
        };
        report.info("limit-read", place(), text);
    }
}

/// Says that changes in per cent count from an accepted drawing anew.
fn say_anew(settings: &Settings, place: &dyn Fn() -> Place, report: &mut Report) {
    let is_change = |l: &&Limit| matches!(l.bound, Bound::Change(_));
    let changes: Vec<String> = settings.limits.iter().filter(is_change).map(|l| format!("`{l}`")).collect();
    if let (Some(last), false) = (settings.lineage.last(), changes.is_empty()) {
        let text = format!(
            "{} {} from this drawing, as {} left it, not from the first of all",
            listed_and(&changes, "and"),
            if changes.len() == 1 { "counts" } else { "count" },
            if last.so_far { "the best so far".into() } else { format!("round {}", last.round) }
        );
        report.info("limit-anew", place(), text);
    }
}

/// Whether less of what a limit holds is better, by what it is or by what is asked for.
fn holds_less(limit: &Limit, settings: &Settings) -> bool {
    match limit.held {
        // Of what walls and rooms lose.
        Held::Penalty(Penalty::WallLength | Penalty::RoomArea) => false,
        Held::Penalty(_) => true,
        Held::Aim(Aim { measure: Measure::Penalty, .. }) => true,
        Held::Aim(aim) => {
            settings.objectives.iter().any(|o| o.measure == aim && !o.is_max)
                || settings.is_by_score() && settings.score.iter().any(|(a, w)| *a == aim && *w < 0.0)
        }
    }
}

/// What moves with each of some parameters, as `Screen 1 (x, y), Door 2 (along)`.
fn listed(base: &Understood, parameters: &[usize]) -> String {
    let mut names: Vec<(String, Vec<&str>)> = Vec::new();
    for p in parameters.iter().map(|p| &base.moves.parameters[*p]) {
        let (name, kind) = (sentence_case(&p.group_name), p.clause.kind.name());
        match names.last_mut().filter(|(last, _)| *last == name) {
            Some((_, kinds)) => kinds.push(kind),
            None => names.push((name, vec![kind])),
        }
    }
    names.iter().map(|(name, kinds)| format!("{name} ({})", kinds.join(", "))).collect::<Vec<_>>().join(", ")
}

/// Free parameters that are worth knowing before the search begins: the pinned first, as they are.
pub fn seeds(control: &Control, settings: &Settings) -> Vec<Vec<f64>> {
    let free = |v: &Vec<f64>| control.reduce(v);
    let mut out: Vec<Vec<f64>> = settings.pinned.iter().map(free).collect();
    for seed in settings.like.iter().chain(&settings.warm) {
        let seed = control.permit(&control.reduce(seed));
        if !out.contains(&seed) {
            out.push(seed);
        }
    }
    out
}

/// Which limits the layout that comes nearest misses, in words.
pub fn missed_words(
    study: &Study,
    settings: &Settings,
    control: &Control,
    nearest: (&[f64], &Worth),
) -> String {
    let all = broken(study, settings, control, nearest);
    let missed = if all.is_empty() { "a limit".into() } else { all.join(" and ") };
    let present = broken_limits(study, settings, &study.initial);
    match present.as_slice() {
        [] => format!("{missed}; the present layout keeps every limit"),
        all => format!("{missed}; the present layout misses {}", all.join(" and ")),
    }
}

/// The limits that a layout breaks, each with what it has.
pub fn broken_limits(study: &Study, settings: &Settings, worth: &Worth) -> Vec<String> {
    let missed = limits::missed(study, settings, worth);
    let words = |i: usize| {
        let (value, bound) = limits::held(study, settings, worth, i);
        let limit = settings.limits[i];
        let means = limit.change_words().map_or_else(String::new, |words| format!("{words}: "));
        format!("`{limit}` ({means}it has {}, the limit is {})", rounded(value), rounded(bound))
    };
    (0..missed.len()).filter(|&i| missed[i] != 0.0).map(words).collect()
}

/// What of the limits and rules a layout breaks, each in words: its parameters and what it is worth.
pub fn broken(
    study: &Study,
    settings: &Settings,
    control: &Control,
    (parameters, worth): (&[f64], &Worth),
) -> Vec<String> {
    let mut all = broken_limits(study, settings, worth);
    if worth.cut_off > 0.0 {
        all.push("that no space is cut off".into());
    }
    all.extend(worth.faults.words());
    let of = |pair: Option<PairName>| pair.map_or_else(|| "reference".into(), |name| format!("{name}"));
    let hidden = crate::search::judged::hidden(study, settings, worth).into_iter();
    all.extend(hidden.map(|pair| format!("that something of the region {} is seen", of(pair))));
    let rule = |breach: Breach| match breach {
        Breach::Bounds(which) => format!("its bounds (beyond them: {})", listed(&study.base, &which)),
        Breach::Module(which) => {
            let snap = settings.snap.map_or(String::new(), |s| format!("`snap {s}`{}", s.metres_words()));
            format!("{snap} (off the module: {})", listed(&study.base, &which))
        }
        Breach::Moves(moved) => {
            let most = settings.most_moves.unwrap_or_default();
            format!("`most-moves {most}` (moving: {})", counted(moved as u64, "group"))
        }
        Breach::Links(which) => {
            format!("what is linked (not along with the others: {})", listed(&study.base, &which))
        }
    };
    all.extend(control.breaches(parameters).into_iter().map(rule));
    all
}

fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}
