//! Walls that stand at the side of one whose end may go along it: an end that went past them would leave their joint
//! open.

use super::bars::Moving;
use super::followed::{ByRecord, Followed, Follower, direction_of, ends, records, worst};
use super::mitre::Refusal;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Editable;
use enfilade_engine::geometry::PointUm;
use enfilade_plan::Plan;

/// What stands this near to the end of a wall stands at its end.
const CORNER_M: f64 = 0.02;

/// Rounding of places, metres.
const NOISE_M: f64 = 1e-6;

/// A wall at the side of another.
pub(super) struct Beside {
    /// Its record.
    pub record: usize,
    /// How far the end may go into its wall without passing it, metres.
    pub gap_m: f64,
}

/// Everything that may stand at the side of a wall: the ends of walls that can change their length, and all corners of
/// the others, with their records.
pub(super) struct Standing(Vec<(usize, Vec<PointUm>)>);

impl Standing {
    /// Of a plan.
    pub fn new(plan: &Plan) -> Self {
        let own = ends(plan).into_iter().map(|e| (e.record, e.corners(plan)));
        let stiff = plan.walls.iter().filter(|w| !matches!(w.editable, Editable::Wall { .. }));
        Self(own.chain(stiff.map(|w| (w.source.record, w.trace.points.clone()))).collect())
    }

    /// What stands at the side of an end's wall, but for some records.
    pub fn beside(
        &self,
        plan: &Plan,
        by_record: &ByRecord<'_>,
        f: &Follower,
        but: impl Fn(usize) -> bool,
    ) -> Vec<Beside> {
        let Some(own) = Followed::new(by_record, f.record) else { return Vec::new() };
        let inward = if f.end == 0 { f.along } else { -f.along };
        let place = |p: PointUm| plan.frame.plan_from_um(p).dot(inward);
        let end = f.handles.iter().map(|h| {
            let at = control_points(&plan.walls[h.0 as usize].shape)[h.1 as usize];
            plan.frame.plan_from_file(at).dot(inward)
        });
        let end = end.fold(f64::NEG_INFINITY, f64::max);
        let of = |(record, corners): &(usize, Vec<PointUm>)| {
            let here = corners.iter().filter(|p| own.is_joined_at(std::slice::from_ref(*p)));
            let gap_m = here.map(|p| place(*p) - end).reduce(f64::min).filter(|g| *g > CORNER_M)?;
            Some(Beside { record: *record, gap_m })
        };
        self.0.iter().filter(|(record, _)| *record != f.record && !but(*record)).filter_map(of).collect()
    }
}

/// The first group that would take an end past a wall that stands at the side of its wall.
pub(super) fn parted(
    plan: &Plan,
    by_record: &ByRecord<'_>,
    followers: &[Follower],
    moving: Moving<'_>,
) -> Option<Refusal> {
    let standing = Standing::new(plan);
    let moved: Vec<_> = (0..moving.groups.len()).map(|g| records(plan, moving, g)).collect();
    for f in followers {
        let all = followers.iter().filter(|o| (o.record, o.end) == (f.record, f.end));
        let taken: f64 = all.map(|o| worst(o, moving)).sum();
        if taken <= NOISE_M {
            continue;
        }
        let outward = if f.end == 0 { -f.along } else { f.along };
        for beside in standing.beside(plan, by_record, f, |r| moved[f.group].contains(&r)) {
            let towards =
                |p: &&super::Parameter| p.group != f.group && moved[p.group].contains(&beside.record);
            let own = moving.parameters.iter().filter(towards).map(|p| {
                let step = direction_of(p.clause.kind).map_or(0.0, |d| d.dot(outward)) * p.clause.si_per_unit;
                (step * p.clause.lower).max(step * p.clause.upper).max(0.0)
            });
            if taken + own.sum::<f64>() > beside.gap_m + NOISE_M {
                let why = format!(
                    "would draw an end of the wall #{} back behind the wall #{} that stands at it",
                    f.record, beside.record
                );
                return Some(Refusal { group: f.group, why });
            }
        }
    }
    None
}
