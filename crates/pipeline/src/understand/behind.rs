//! Doors and windows that cannot go as their wall is marked to go: told at the mark, before anything is searched.

use std::collections::BTreeMap;

use enfilade_cad::drawing::{Editable, Format, place_in};
use enfilade_moves::Moves;
use enfilade_moves::carried::{Carried, carried};
use enfilade_plan::Plan;
use enfilade_plan::fittings::Fitting;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::Group;
use enfilade_report::{Place, Report};

/// Parts that are named one by one.
const TOLD: usize = 3;

/// Where on its way a parameter is tried, as shares.
const TRIED: [f64; 2] = [0.0, 1.0];

/// Names for each mark the parts of doors and windows that stay behind at a bound of its, since the file has nothing to change
/// for them. That the sides of an opening move apart is what a mark of one jamb asks for.
pub(crate) fn state_left_behind<'a>(
    moves: &Moves,
    groups: impl Iterator<Item = &'a Group> + Clone,
    (plan, graph): (&Plan, &Graph),
    fittings: &[Fitting],
    report: &mut Report,
) {
    let is_stiff =
        |f: &&Fitting| matches!(f.editable, Editable::No(_) | Editable::WithInsert { turnable: false });
    let stiff: Vec<&Fitting> = fittings.iter().filter(is_stiff).collect();
    if stiff.is_empty() {
        return;
    }
    let mut told: BTreeMap<&str, BTreeMap<usize, (&Fitting, String)>> = BTreeMap::new();
    for (i, parameter) in moves.parameters.iter().enumerate() {
        for share in TRIED {
            let mut at = moves.identity();
            at[i] = parameter.clause.lower + share * (parameter.clause.upper - parameter.clause.lower);
            let layout = moves.apply(plan, graph, &at);
            for fitting in &stiff {
                if let Carried::Stale(why) = carried(plan, fitting, &layout) {
                    let own = told.entry(&parameter.group_name).or_default();
                    own.entry(fitting.source.record).or_insert((*fitting, why));
                }
            }
        }
    }
    for (group, parts) in told {
        let source = groups.clone().find(|g| g.name == group).map(|g| &g.source);
        let place = source.map_or_else(|| Place::file(&plan.file), |s| place_in(&plan.file, s));
        report.warn("move-leaves-behind", place, words(plan, group, parts.into_values().collect()));
    }
}

fn words(plan: &Plan, group: &str, parts: Vec<(&Fitting, String)>) -> String {
    let name = |(f, why): &(&Fitting, String)| {
        let handle = f.source.handle.as_ref().map_or_else(String::new, |h| format!(" {h}"));
        let line = if f.source.line > 0 { format!(" in line {}", f.source.line) } else { String::new() };
        format!("{}{handle} of layer {}{line} ({why})", f.source.kind, f.source.layer)
    };
    let named: Vec<String> = parts.iter().take(TOLD).map(name).collect();
    let more = match parts.len().saturating_sub(TOLD) {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    let has_no_rotation = plan.format == Format::Dxf
        && parts.iter().any(|(f, _)| matches!(f.editable, Editable::WithInsert { turnable: false }));
    let help = if has_no_rotation {
        "give it a rotation other than 0° in CAD (0.001° will do), so that the file has a value to change, or explode it"
    } else {
        "change it in CAD so that it can go along, or leave its wall out of the mark"
    };
    format!(
        "group {group:?}: part of a door or window would stay as drawn while its wall moves: {}{more}; {help}",
        named.join(", ")
    )
}
