//! What the report says of joints that options open.

use std::collections::BTreeMap;

use super::{Made, named};
use crate::moves::opened::{Opened, opened};
use crate::pipeline::study::Study;
use crate::plan::Plan;
use crate::report::{Place, Report};

/// Joints that are told one by one.
const TOLD: usize = 12;

/// Names every joint of a building that an option opens, with the options and by how much at most.
pub(super) fn say_opened(report: &mut Report, file: &str, study: &Study, made: &[Made]) {
    let plan = &study.base.plan;
    let mut found: BTreeMap<(usize, usize), (Opened, Vec<usize>)> = BTreeMap::new();
    for (i, m) in made.iter().enumerate() {
        for joint in opened(plan, &m.layout) {
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
}

fn words(plan: &Plan, worst: &Opened, options: &[usize]) -> String {
    let list: Vec<String> = options.iter().map(usize::to_string).collect();
    let options = match list.as_slice() {
        [one] => format!("option {one}"),
        many => format!("options {}", many.join(", ")),
    };
    let up_to = if list.len() > 1 { "up to " } else { "" };
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
