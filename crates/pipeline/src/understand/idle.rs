//! Clauses of the user's that move nothing: they are named, and no parameters.

use enfilade_cad::drawing::place_in;
use enfilade_config::Settings;
use enfilade_moves::idle::Idle;
use enfilade_moves::{MOVE_MIN_M, Moves, Parameter};
use enfilade_plan::Plan;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::Group;
use enfilade_report::{Place, Report};

/// The moves without the parameters that move nothing. Those of linked groups stay, since others follow them; where nothing
/// that is linked moves, the link is named.
pub(crate) fn without_idle<'a>(
    mut moves: Moves,
    groups: impl Iterator<Item = &'a Group> + Clone,
    (plan, graph): (&Plan, &Graph),
    settings: &Settings,
    report: &mut Report,
) -> Moves {
    let place = |name: &str| {
        let group = groups.clone().find(|g| g.name == name);
        group.map_or_else(|| Place::file(&plan.file), |g| place_in(&plan.file, &g.source))
    };
    let idle = moves.idle(plan, graph);
    let count = |group: usize| moves.parameters.iter().filter(|p| p.group == group).count();
    let idle_of = |group: usize| idle.iter().filter(|(i, _)| moves.parameters[*i].group == group).count();
    for (k, (i, why)) in idle.iter().enumerate() {
        let p = &moves.parameters[*i];
        let is_last = idle[k + 1..].iter().all(|(j, _)| moves.parameters[*j].group != p.group);
        let rest = match count(p.group) == idle_of(p.group) {
            true if is_last => "; nothing moves here",
            _ => "",
        };
        let text = format!("group {:?}: `{}` moves nothing: {}{rest}", p.group_name, p.clause, words(*why));
        report.warn("move-idle", place(&p.group_name), text);
    }
    let is_idle = |name: &String| {
        let mut own =
            (0..moves.parameters.len()).filter(|i| moves.parameters[*i].group_name == *name).peekable();
        own.peek().is_some() && own.all(|i| idle.iter().any(|(j, _)| *j == i))
    };
    let (without_effect, links): (Vec<_>, Vec<_>) =
        settings.links.iter().partition(|l| l.groups.iter().all(is_idle));
    for link in without_effect {
        let text = format!("link `{link}`: nothing that it names moves (see `move-idle`); it has no effect");
        report.warn("link-idle", Place::file(&plan.file), text);
    }
    let is_linked = |p: &Parameter| links.iter().any(|l| l.groups.contains(&p.group_name));
    let dropped: Vec<usize> =
        idle.iter().map(|(i, _)| *i).filter(|i| !is_linked(&moves.parameters[*i])).collect();
    moves.leave_out(&dropped);
    moves
}

fn words(why: Idle) -> String {
    match why {
        Idle::HeldByFaces => {
            "corners of thick walls stay on the faces they meet, and slide along them".into()
        }
        Idle::OnePoint => {
            "what stands here is one point, or round, and is turned or scaled about itself".into()
        }
        Idle::NoWay => format!("its bounds leave no way of {} mm or more", MOVE_MIN_M * 1e3),
    }
}
