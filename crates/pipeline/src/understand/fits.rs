//! Whether layouts of an earlier round still fit the moves of the drawing: parameters are told apart by
//! name, kind, direction, unit and the corners they move, never by their place in a list.

use std::collections::BTreeMap;

use sha2::{Digest, Sha256};

use crate::understand::understood::Understood;
use enfilade_config::{KnownMove, Settings};
use enfilade_moves::Parameter;
use enfilade_overlay::result::MoveEntry;
use enfilade_plan::markers::Kind;
use enfilade_report::{Error, Place, Report, counted};

/// Letters of a geometry's mark.
const MARK_LETTERS: usize = 12;

/// A mark of the corners that a group moves, whole micrometres of the drawing frame: other corners, another
/// mark.
pub fn geometry_mark(base: &Understood, group: usize) -> String {
    let nodes = &base.moves.groups[group].nodes;
    let mut points: Vec<[i64; 2]> =
        nodes.iter().map(|n| base.plan.frame.um_from_plan(base.graph.nodes[*n as usize])).collect();
    points.sort_unstable();
    let mut digest = Sha256::new();
    points.iter().flatten().for_each(|v| digest.update(v.to_le_bytes()));
    let letters: String = digest.finalize().iter().map(|b| format!("{b:02x}")).collect();
    letters[..MARK_LETTERS].to_owned()
}

/// The moves of a drawing, as later rounds know them again.
pub fn known_moves(base: &Understood) -> Vec<KnownMove> {
    let known = |p: &Parameter| KnownMove {
        name: p.group_name.clone(),
        kind: p.clause.kind.name().to_owned(),
        unit: p.clause.unit.clone(),
        direction_deg: if let Kind::Along(rad) = p.clause.kind { Some(rad.to_degrees()) } else { None },
        geometry: geometry_mark(base, p.group),
    };
    base.moves.parameters.iter().map(known).collect()
}

/// The moves of an earlier round, from its result.
pub fn moves_of(entries: &[MoveEntry]) -> Vec<KnownMove> {
    let known = |e: &MoveEntry| KnownMove {
        name: e.name.clone(),
        kind: e.kind.name().to_owned(),
        unit: e.unit.clone(),
        direction_deg: e.direction_deg,
        geometry: e.geometry.clone(),
    };
    entries.iter().map(known).collect()
}

/// The settings with the layouts they hold (`pin`, `like`, `warm`) as the drawing's own parameters.
///
/// # Errors
/// [`Error::Usage`] where a pinned layout does not fit any more, with what does not.
pub fn fitted(base: &Understood, settings: &Settings, report: &mut Report) -> Result<Settings, Error> {
    let mut out = settings.clone();
    let now = known_moves(base);
    let place = || Place::file(&base.plan.file);
    let count = base.moves.parameters.len();
    let is_other = |n: &usize| settings.pin_moves.is_empty() && ![0, count].contains(n);
    if let Some(n) = settings.pinned_options.iter().map(|o| o.parameters.len()).find(is_other) {
        let text = format!(
            "pin-option: an option of {}, the drawing has {count}; nothing was done",
            counted(n as u64, "parameter")
        );
        return Err(Error::usage("pin", place(), text));
    }
    if !settings.pin_moves.is_empty() {
        let (pinned, wrong) = refit(base, &now, &settings.pin_moves, &settings.pinned);
        if !wrong.is_empty() {
            let text = format!(
                "a pinned option does not fit the drawing any more: {}; nothing was done",
                wrong.join("; ")
            );
            return Err(Error::usage("pin", place(), text));
        }
        say_idle_pins(settings, &pinned, base, report);
        out.pinned = pinned;
        for option in out.pinned_options.iter_mut().filter(|o| !o.parameters.is_empty()) {
            let (fitted, wrong) =
                refit(base, &now, &settings.pin_moves, std::slice::from_ref(&option.parameters));
            if !wrong.is_empty() {
                let text = format!(
                    "what moves beside the works of a pinned option does not fit the drawing as a whole: {}; the rest of it is kept",
                    wrong.join("; ")
                );
                report.warn("pin-works", place(), text);
            }
            option.parameters = fitted.into_iter().next().unwrap_or_default();
        }
        let like: Vec<Vec<f64>> = settings.like.iter().cloned().collect();
        let (like, wrong) = refit(base, &now, &settings.pin_moves, &like);
        if !wrong.is_empty() {
            let text = format!(
                "the option to stay near does not fit the drawing any more: {}; the rest of it is followed",
                wrong.join("; ")
            );
            report.warn("like-moves", place(), text);
        }
        out.like = like.into_iter().next();
        out.pin_moves.clone_from(&now);
    }
    if !settings.warm_moves.is_empty() {
        let (warm, wrong) = refit(base, &now, &settings.warm_moves, &settings.warm);
        if !wrong.is_empty() {
            let text = format!(
                "layouts known from an earlier round do not fit the drawing as a whole: {}; the search begins from the rest of them",
                wrong.join("; ")
            );
            report.info("warm-moves", place(), text);
        }
        out.warm = warm;
        out.warm_moves = now;
    }
    Ok(out)
}

/// Names pinned options that move only what moves nothing: they are the present layout.
fn say_idle_pins(settings: &Settings, fitted: &[Vec<f64>], base: &Understood, report: &mut Report) {
    let still = base.moves.identity();
    for (i, (then, now)) in settings.pinned.iter().zip(fitted).enumerate() {
        let identity = |m: &KnownMove| if m.kind == "scale" { 1.0 } else { 0.0 };
        let moved = settings.pin_moves.iter().zip(then).filter(|(m, v)| **v != identity(m));
        let names: Vec<String> = moved.map(|(m, _)| format!("{} ({})", m.name, m.kind)).collect();
        if !names.is_empty() && *now == still {
            let text = format!(
                "pin: of the pinned options number {} moves {} alone, which moves nothing (see `move-idle`); it is the present \
                 layout, and pinning it has no effect",
                i + 1,
                names.join(", ")
            );
            report.warn("pin-idle", Place::file(&base.plan.file), text);
        }
    }
}

/// A share of the room of a move that is rounding, not a place beyond it.
const ROUNDING: f64 = 1e-9;

/// Vectors over the moves of an earlier round as vectors over those of the drawing, and what of them does
/// not fit, in words. What may not move any more, or not so far, is left as drawn or at its bound.
fn refit(
    base: &Understood,
    now: &[KnownMove],
    then: &[KnownMove],
    vectors: &[Vec<f64>],
) -> (Vec<Vec<f64>>, Vec<String>) {
    let mut wrong: Vec<String> = Vec::new();
    let mut say = |text: String| {
        if !wrong.contains(&text) {
            wrong.push(text);
        }
    };
    let places = places(now, then);
    let mut out = Vec::new();
    for vector in vectors {
        if vector.len() != then.len() {
            say(format!(
                "{}, and {} they belong to",
                counted(vector.len() as u64, "number"),
                counted(then.len() as u64, "move")
            ));
            continue;
        }
        let mut fitted = base.moves.identity();
        for ((known, place), &value) in then.iter().zip(&places).zip(vector) {
            let identity = if known.kind == "scale" { 1.0 } else { 0.0 };
            if value == identity {
                continue;
            }
            let Some(j) = *place else {
                // What never moved anything is the same without it.
                let is_same =
                    |p: &&Parameter| p.group_name == known.name && p.clause.kind.name() == known.kind;
                if base.moves.left_out.iter().any(|p| is_same(&p)) {
                    continue;
                }
                say(format!("{} ({}) {}", known.name, known.kind, why_not(now, known)));
                continue;
            };
            if now[j].geometry != known.geometry {
                say(format!("{} ({}) moves other corners than then", known.name, known.kind));
            }
            let clause = &base.moves.parameters[j].clause;
            let noise = ROUNDING * (clause.upper - clause.lower);
            if !(clause.lower - noise..=clause.upper + noise).contains(&value) {
                let unit = &clause.unit;
                say(format!(
                    "{} ({}) stood at {} {unit}, and may now be between {} and {} {unit}",
                    known.name,
                    known.kind,
                    (value * 1e6).round() / 1e6,
                    clause.lower,
                    clause.upper
                ));
            }
            fitted[j] = value.clamp(clause.lower, clause.upper);
        }
        out.push(fitted);
    }
    (out, wrong)
}

/// Why a move of then has no place among those of now.
fn why_not(now: &[KnownMove], then: &KnownMove) -> String {
    let same = |m: &&KnownMove| m.name == then.name && m.kind == then.kind;
    match (now.iter().find(same), then.direction_deg) {
        (Some(m), Some(was)) if m.direction_deg.is_some_and(|d| d != was) => {
            let deg = m.direction_deg.map_or(was, f64::from);
            format!("moved along {was}°, and may now move along {deg}°")
        }
        (Some(m), _) if m.unit != then.unit => {
            format!("was measured in {}, and is now in {}", then.unit, m.unit)
        }
        (Some(_), _) => "has fewer moves than then".into(),
        (None, _) => "may not move any more".into(),
    }
}

/// For every move of then the one of now that is the same by name, kind, direction and unit; of several
/// alike the first is the first.
fn places(now: &[KnownMove], then: &[KnownMove]) -> Vec<Option<usize>> {
    let key = |m: &KnownMove| {
        let way = m.direction_deg.map(|d| (d * 1e6).round() as i64);
        (m.name.clone(), m.kind.clone(), way, m.unit.clone())
    };
    let mut found: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    now.iter().enumerate().rev().for_each(|(j, m)| found.entry(key(m)).or_default().push(j));
    then.iter().map(|m| found.get_mut(&key(m)).and_then(Vec::pop)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(name: &str, kind: &str) -> KnownMove {
        KnownMove {
            name: name.into(),
            kind: kind.into(),
            unit: "m".into(),
            direction_deg: None,
            geometry: String::new(),
        }
    }

    #[test]
    fn moves_are_known_by_what_they_are() {
        let then = [known("a", "x"), known("a", "y"), known("b", "x"), known("b", "x")];
        let now = [known("b", "x"), known("c", "x"), known("a", "y"), known("b", "x")];
        assert_eq!(places(&now, &then), [None, Some(2), Some(0), Some(3)]);
        let along = |deg| KnownMove { direction_deg: Some(deg), ..known("a", "along") };
        assert_eq!(places(&[along(30.0)], &[along(31.0), along(30.0)]), [None, Some(0)]);
        assert_eq!(why_not(&[along(30.0)], &along(31.0)), "moved along 31°, and may now move along 30°");
        let feet = KnownMove { unit: "ft".into(), ..known("a", "x") };
        assert_eq!(why_not(&[feet], &known("a", "x")), "was measured in m, and is now in ft");
        assert_eq!(why_not(&[known("b", "x")], &known("b", "x")), "has fewer moves than then");
        assert_eq!(why_not(&[known("b", "x")], &known("a", "x")), "may not move any more");
    }
}
