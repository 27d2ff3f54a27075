//! How an architect moves what stands free: rows as one, askew only where the plan is.

use std::f64::consts::FRAC_PI_2;

use glam::DVec2;

use enfilade_cad::drawing::SourceRef;
use enfilade_plan::Plan;
use enfilade_plan::markers::Kind;

/// Walls that run in two directions at right angles: the share of their length from which a plan is one of right angles.
const ORTHOGONAL_SHARE: f64 = 0.95;

/// Directions that differ by less than this sine are one.
const SAME_WAY_SIN: f64 = 0.02;

/// Sizes and lines of a row differ by less, metres of a person.
const ALIKE_M: f64 = 0.05;

/// What stands no farther from the next of its kind is in a row with it: an aisle, metres of a person.
const AISLE_M: f64 = 1.5;

/// Something that stands free.
#[derive(Clone, Debug)]
pub(super) struct Element {
    /// Two corners of its box, metres, plan frame.
    pub bounds: [DVec2; 2],
    /// Its nodes, ascending.
    pub nodes: Vec<u32>,
    /// How far it turns, degrees, if at all.
    pub turn_deg: Option<f64>,
    /// What it is told at.
    pub source: SourceRef,
}

/// The two directions at right angles in which nearly all walls of a plan run, the one nearer to x first; none in
/// others.
pub(super) fn right_angles(plan: &Plan) -> Option<[DVec2; 2]> {
    let runs: Vec<DVec2> = plan
        .walls
        .iter()
        .flat_map(|w| w.trace.segments().map(|s| s.2))
        .map(|s| plan.frame.plan_from_um(s.b) - plan.frame.plan_from_um(s.a))
        .collect();
    // Four times an angle is the same for directions at right angles.
    let folded = |v: &DVec2| {
        v.try_normalize().map_or(DVec2::ZERO, |u| DVec2::from_angle(4.0 * u.to_angle()) * v.length())
    };
    let main = runs.iter().map(folded).sum::<DVec2>().try_normalize()?;
    let main = DVec2::from_angle(main.to_angle() / 4.0);
    let total: f64 = runs.iter().map(|v| v.length()).sum();
    let is_along = |v: &&DVec2| v.dot(main).abs().min(v.perp_dot(main).abs()) <= SAME_WAY_SIN * v.length();
    let along: Vec<DVec2> = runs.iter().filter(is_along).copied().collect();
    let share = along.iter().map(|v| v.length()).sum::<f64>() / total;
    // The longest tells its direction best.
    let longest = along.into_iter().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))?;
    let quarters = (longest.to_angle() / FRAC_PI_2).round();
    let x = DVec2::from_angle(longest.to_angle() - quarters * FRAC_PI_2);
    (share >= ORTHOGONAL_SHARE).then_some([x, x.perp()])
}

/// How what stands free shifts: with the walls of the plan, by x and y where they run so or in all directions.
pub(super) fn shifts(walls: Option<[DVec2; 2]>) -> [Kind; 2] {
    match walls.filter(|[x, _]| x.y.abs() > SAME_WAY_SIN) {
        Some(ways) => ways.map(|way| Kind::Along(way.to_angle())),
        None => [Kind::X, Kind::Y],
    }
}

/// The elements with those of one row as one, which does not turn.
pub(super) fn in_rows(elements: Vec<Element>, scale: f64) -> Vec<Element> {
    let (alike, aisle) = (ALIKE_M * scale, AISLE_M * scale);
    let size = |e: &Element| e.bounds[1] - e.bounds[0];
    let is_next = |a: &Element, b: &Element| {
        let is_same = (size(a) - size(b)).abs().max_element() <= alike;
        let apart = (a.bounds[0] - b.bounds[0]).abs();
        let gap = apart - size(a);
        is_same && (apart.x <= alike && gap.y <= aisle || apart.y <= alike && gap.x <= aisle)
    };
    let mut rows: Vec<Vec<Element>> = Vec::new();
    for element in elements {
        let (near, mut rest): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|row: &Vec<Element>| row.iter().any(|e| is_next(e, &element)));
        rest.push(near.into_iter().flatten().chain([element]).collect());
        rows = rest;
    }
    rows.into_iter().filter_map(as_one).collect()
}

/// A row as one element.
fn as_one(row: Vec<Element>) -> Option<Element> {
    let is_alone = row.len() == 1;
    let join = |mut a: Element, b: Element| {
        a.bounds = [a.bounds[0].min(b.bounds[0]), a.bounds[1].max(b.bounds[1])];
        a.nodes.extend(b.nodes);
        a
    };
    let mut out = row.into_iter().reduce(join)?;
    out.nodes.sort_unstable();
    out.nodes.dedup();
    out.turn_deg = out.turn_deg.filter(|_| is_alone);
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_one() {
        let at = |x: f64, y: f64, width: f64| Element {
            bounds: [DVec2::new(x, y), DVec2::new(x + width, y + 0.4)],
            nodes: vec![(x * 10.0 + y * 1000.0) as u32],
            turn_deg: Some(90.0),
            source: SourceRef { record: 0, handle: None, line: 0, kind: String::new(), layer: String::new() },
        };
        // Three shelves with aisles of a metre, one far away, one of another width beside them.
        let all = vec![
            at(0.0, 0.0, 3.0),
            at(0.0, 2.8, 3.0),
            at(0.0, 1.4, 3.0),
            at(0.0, 9.0, 3.0),
            at(4.0, 0.0, 2.0),
        ];
        let mut rows: Vec<(usize, Option<f64>)> =
            in_rows(all, 1.0).iter().map(|e| (e.nodes.len(), e.turn_deg)).collect();
        rows.sort_by_key(|r| r.0);
        assert_eq!(rows, [(1, Some(90.0)), (1, Some(90.0)), (3, None)]);
    }
}
