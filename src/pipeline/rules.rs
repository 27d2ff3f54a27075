//! The settings' rules on the parameters: links, modules, pinned options; and why no option keeps the limits.

use super::aims;
use super::study::{Study, Understood, Worth};
use crate::config::{Follow, Settings};
use crate::moves::control::{Control, Link, Rules};
use crate::report::{Error, Place};

/// The parameters under the rules of the settings.
///
/// # Errors
/// [`Error::Usage`] where a link names an unknown group or an option has other parameters.
pub fn control(base: &Understood, settings: &Settings) -> Result<Control, Error> {
    let link = |l: &crate::config::Link| Link {
        groups: l.groups.clone(),
        mirror: match l.follow {
            Follow::MirrorX => [-1.0, 1.0],
            Follow::MirrorY => [1.0, -1.0],
            Follow::Same | Follow::Equal => [1.0, 1.0],
        },
        is_row: l.follow == Follow::Equal,
    };
    let snap = settings.snap.unwrap_or_default();
    let rules = Rules {
        links: settings.links.iter().map(link).collect(),
        length_m: snap.length_m,
        angle_rad: snap.angle_deg.map(f64::to_radians),
        most_groups: settings.most_moves,
        like: settings.like.clone(),
        pinned: settings.pinned.clone(),
    };
    let count = base.moves.parameters.len();
    let control = match settings.warm.iter().find(|v| v.len() != count) {
        Some(v) => Err(format!("warm: a layout of {} parameters, the drawing has {count}", v.len())),
        None => Control::new(&base.moves, &rules),
    };
    control.map_err(|why| {
        Error::usage("rules", Place::file(&base.plan.file), format!("{why}; nothing was done"))
    })
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
pub fn missed_words(study: &Study, settings: &Settings, nearest: &Worth) -> String {
    let missed = aims::missed(study, settings, nearest);
    let words = |i: usize| {
        let (value, bound) = aims::held(study, settings, nearest, i);
        format!("`{}` (it has {}, the limit is {})", settings.limits[i], rounded(value), rounded(bound))
    };
    let mut all: Vec<String> = (0..missed.len()).filter(|&i| missed[i] != 0.0).map(words).collect();
    if nearest.seen.tally.disconnected > 0 {
        all.push("that no space is cut off".into());
    }
    if all.is_empty() { "a limit".into() } else { all.join(" and ") }
}

fn rounded(value: f64) -> f64 {
    (value * 1e3).round() / 1e3
}
