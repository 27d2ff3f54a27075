//! What the report says of joints that options open.

use std::collections::BTreeMap;

use crate::measure::study::Study;
use crate::understand::named;
use crate::write::made::Made;
use enfilade_cad::ifc::{Parting, UnseenJoint};
use enfilade_moves::opened::{Joints, Opened};
use enfilade_plan::Plan;
use enfilade_report::{Place, Report};

/// Joints that are told one by one.
const TOLD: usize = 12;

/// Names every joint of a building that an option opens, with the options and by how much at most.
pub(crate) fn say_opened(report: &mut Report, file: &str, study: &Study, made: &[Made]) {
    let plan = &study.base.plan;
    let joints = Joints::new(plan, &study.base.moves);
    let mut found: BTreeMap<(usize, usize), (Opened, Vec<usize>)> = BTreeMap::new();
    for (i, m) in made.iter().enumerate() {
        for joint in joints.opened(plan, &m.layout) {
            let (worst, options) =
                found.entry((joint.record, joint.other)).or_insert_with(|| (joint, Vec::new()));
            if joint.by_m > worst.by_m {
                *worst = joint;
            }
            options.push(i + 1);
        }
    }
    for (worst, options) in found.values().take(TOLD) {
        let Some(wall) = plan.walls.iter().find(|w| w.source.record == worst.record) else { continue };
        report.warn("joint-opens", named::place(file, plan, wall), words(plan, worst, options));
    }
    if found.len() > TOLD {
        let text = format!("{} more joints between walls open in the options", found.len() - TOLD);
        report.warn("joint-opens", Place::file(file), text);
    }
    say_unseen(report, file, study, made);
}

/// The same of joints with walls that the plan does not show and that stay.
fn say_unseen(report: &mut Report, file: &str, study: &Study, made: &[Made]) {
    let mut found: BTreeMap<(u64, u64), (&UnseenJoint, Vec<usize>)> = BTreeMap::new();
    for (i, m) in made.iter().enumerate() {
        for joint in &m.changed.unseen {
            let (worst, options) =
                found.entry((joint.id, joint.other)).or_insert_with(|| (joint, Vec::new()));
            if by_m(joint) > by_m(worst) {
                *worst = joint;
            }
            options.push(i + 1);
        }
    }
    for (worst, options) in found.values().take(TOLD) {
        let Some(wall) = study.base.plan.walls.iter().find(|w| w.source.record as u64 == worst.id) else {
            continue;
        };
        report.warn("joint-opens", named::place(file, &study.base.plan, wall), unseen_words(worst, options));
    }
    if found.len() > TOLD {
        let text = format!("{} more joints with walls that are not shown open", found.len() - TOLD);
        report.warn("joint-opens", Place::file(file), text);
    }
}

fn by_m(joint: &UnseenJoint) -> f64 {
    match joint.parting {
        Parting::Gap(by_m) | Parting::Through(by_m) => by_m,
        Parting::Unknown => 0.0,
    }
}

fn unseen_words(worst: &UnseenJoint, options: &[usize]) -> String {
    let storey = worst.storey.as_ref().map_or("no storey".into(), |name| format!("storey {name:?}"));
    let other = format!("the wall #{} on {storey} (not shown in this plan; it stays)", worst.other);
    let (of, up_to) = options_words(options);
    match worst.parting {
        Parting::Gap(by_m) => {
            format!("in {of} its joint with {other} opens by {up_to}{by_m:.2} m; narrower bounds hold it")
        }
        Parting::Through(by_m) => format!(
            "in {of} it and {other}, joined as drawn, run through each other by {up_to}{by_m:.2} m; narrower bounds \
             hold it"
        ),
        Parting::Unknown => format!(
            "in {of} it moves, and the file joins it to {other}; no end of either is found at the other: the joint may open"
        ),
    }
}

/// The names of options, and a word where they differ.
fn options_words(options: &[usize]) -> (String, &'static str) {
    let list: Vec<String> = options.iter().map(usize::to_string).collect();
    match list.as_slice() {
        [one] => (format!("option {one}"), ""),
        many => (format!("options {}", many.join(", ")), "up to "),
    }
}

fn words(plan: &Plan, worst: &Opened, options: &[usize]) -> String {
    let (options, up_to) = options_words(options);
    let Opened { other, by_m, is_through, .. } = worst;
    let other = named::words(plan, *other);
    let what = match is_through {
        true => {
            format!("it and {other}, joined as drawn, run through each other by {up_to}{by_m:.2} m")
        }
        false => format!("its joint with {other} opens by {up_to}{by_m:.2} m"),
    };
    format!("in {options} {what}; narrower bounds, or a mark of one name on both, hold it")
}
