//! Ways that end where the joints of a group's walls still hold.

use super::{Moves, NodeGroup};
use enfilade_cad::drawing::place_in;
use enfilade_plan::Plan;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Group};
use enfilade_report::Report;

/// A group with what it holds.
#[derive(Clone)]
pub(super) struct Holding {
    /// As it is marked, with bounds that may have been shortened.
    pub marker: Group,
    /// The bounds of its clauses as they were stated.
    pub stated: Vec<[f64; 2]>,
    /// What it holds.
    pub nodes: NodeGroup,
}

impl Holding {
    /// With the bounds as they are stated.
    pub fn new(marker: &Group, nodes: NodeGroup) -> Self {
        let stated = marker.clauses.iter().map(|c| [c.lower, c.upper]).collect();
        Self { marker: marker.clone(), stated, nodes }
    }
}

/// Halvings between what holds and what does not: 2⁻¹⁰, to less than a thousandth of the way.
const HALVINGS: usize = 10;

/// A group whose way is shortened to less than this share of what was stated stays: it would move by millimetres.
const LEAST_SHARE: f64 = 0.01;

/// The parametrisation with ways that end where a joint would break; a group with no way left stays. The report says both.
pub(super) fn as_far_as_joints_hold(
    known: (&Plan, &Graph, &AxisGraph),
    mut held: Vec<Holding>,
    report: &mut Report,
) -> Moves {
    let (plan, graph, axes) = known;
    loop {
        let refusal = match Moves::mitred(plan, graph, axes, &held) {
            Ok(out) => return out,
            Err(refusal) => refusal,
        };
        let at = refusal.group;
        let place = place_in(&plan.file, &held[at].marker.source);
        let name = held[at].marker.name.clone();
        match shorter(known, &held, at) {
            Some(clauses) => {
                let now: Vec<String> = clauses.iter().map(|c| format!("`{c}`")).collect();
                held[at].marker.clauses = clauses;
                let text = format!(
                    "group {name:?} {} at its bounds; it moves by {} alone",
                    refusal.why,
                    now.join("; ")
                );
                report.info("move-shortened", place, text);
            }
            None => {
                held.remove(at);
                let text = format!(
                    "group {name:?} {} within its bounds; the group stays; narrower bounds or another outline let it move",
                    refusal.why
                );
                report.warn("move-mitre", place, text);
            }
        }
    }
}

/// The clauses of a group with both their ends as far out as its joints hold, all else as drawn, or where it holds alone,
/// all others at their bounds; none where no way is left, or where it was shortened before.
fn shorter(
    (plan, graph, axes): (&Plan, &Graph, &AxisGraph),
    held: &[Holding],
    at: usize,
) -> Option<Vec<Clause>> {
    let drawn = &held[at].marker.clauses;
    let is_as_stated = drawn.iter().zip(&held[at].stated).all(|(c, s)| [c.lower, c.upper] == *s);
    let is_from_still = drawn.iter().all(|c| (c.lower..=c.upper).contains(&c.kind.identity()));
    if !is_as_stated || !is_from_still {
        return None;
    }
    let farthest = |mut tried: Vec<Holding>, at: usize| {
        let mut holds = |shares: [f64; 2]| {
            tried[at].marker.clauses = drawn.iter().map(|c| shortened(c, shares)).collect();
            !Moves::mitred(plan, graph, axes, &tried).is_err_and(|refusal| refusal.group == at)
        };
        let mut shares = [0.0; 2];
        for end in 0..2 {
            let only = |share: f64| if end == 0 { [share, 0.0] } else { [shares[0], share] };
            let (mut good, mut bad) = if holds(only(1.0)) { (1.0, 1.0) } else { (0.0, 1.0) };
            for _ in 0..if good < bad { HALVINGS } else { 0 } {
                let middle = f64::midpoint(good, bad);
                *(if holds(only(middle)) { &mut good } else { &mut bad }) = middle;
            }
            shares[end] = good;
        }
        shares
    };
    let alone = farthest(vec![held[at].clone()], 0);
    let shares = if alone == [1.0; 2] { farthest(held.to_vec(), at) } else { alone };
    let is_some = shares.iter().any(|s| *s > LEAST_SHARE) && shares != [1.0; 2];
    is_some.then(|| drawn.iter().map(|c| shortened(c, shares)).collect())
}

/// A clause with its ends at a share of their ways, rounded inwards to thousandths of its unit.
fn shortened(clause: &Clause, [lower, upper]: [f64; 2]) -> Clause {
    let still = clause.kind.identity();
    let way = |end: f64, share: f64| match share {
        1.0 => end,
        _ => still + ((end - still) * share * 1e3).trunc() / 1e3,
    };
    Clause { lower: way(clause.lower, lower), upper: way(clause.upper, upper), ..clause.clone() }
}
