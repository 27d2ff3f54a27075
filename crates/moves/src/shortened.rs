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
        let mut holds = |ends: [End; 2]| {
            tried[at].marker.clauses = drawn.iter().map(|c| shortened(c, ends)).collect();
            !Moves::mitred(plan, graph, axes, &tried).is_err_and(|refusal| refusal.group == at)
        };
        let mut found = [End::inward(0.0); 2];
        for end in 0..2 {
            let only = |to: End| if end == 0 { [to, End::inward(0.0)] } else { [found[0], to] };
            let (mut good, mut bad) = if holds(only(End::inward(1.0))) { (1.0, 1.0) } else { (0.0, 1.0) };
            for _ in 0..if good < bad { HALVINGS } else { 0 } {
                let middle = f64::midpoint(good, bad);
                *(if holds(only(End::inward(middle))) { &mut good } else { &mut bad }) = middle;
            }
            let outward = End { share: good, is_outward: true };
            found[end] = if good < bad && holds(only(outward)) { outward } else { End::inward(good) };
        }
        found
    };
    let is_whole = |ends: &[End; 2]| ends.iter().all(|e| e.share == 1.0);
    let alone = farthest(vec![held[at].clone()], 0);
    let ends = if is_whole(&alone) { farthest(held.to_vec(), at) } else { alone };
    let is_some = ends.iter().any(|e| e.share > LEAST_SHARE) && !is_whole(&ends);
    is_some.then(|| drawn.iter().map(|c| shortened(c, ends)).collect())
}

/// Where a way ends.
#[derive(Clone, Copy)]
struct End {
    /// Share of the way that was stated.
    share: f64,
    /// Whether it is rounded to the next thousandth of its unit outwards; else inwards.
    is_outward: bool,
}

impl End {
    fn inward(share: f64) -> Self {
        Self { share, is_outward: false }
    }
}

/// A clause with its ends at a share of their ways, rounded to thousandths of its unit.
fn shortened(clause: &Clause, [lower, upper]: [End; 2]) -> Clause {
    let still = clause.kind.identity();
    let way = |end: f64, to: End| {
        let thousandths = (end - still) * to.share * 1e3;
        match to {
            _ if to.share == 1.0 => end,
            // Never beyond what was stated.
            End { is_outward: true, .. } => {
                let out = (thousandths.abs().ceil() / 1e3).min((end - still).abs());
                still + thousandths.signum() * out
            }
            _ => still + thousandths.trunc() / 1e3,
        }
    };
    Clause { lower: way(clause.lower, lower), upper: way(clause.upper, upper), ..clause.clone() }
}
