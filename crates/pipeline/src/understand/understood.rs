//! A drawing as understood.

use glam::DVec2;

use crate::understand::building::NamedOpening;
use enfilade_cad::drawing::Text;
use enfilade_cad::wish::Wish;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_engine::interior::Interior;
use enfilade_moves::Moves;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::curve::Trace;
use enfilade_plan::fittings::Fitting;
use enfilade_plan::graph::Graph;
use enfilade_plan::kinds::Thing;
use enfilade_plan::labels::Label;
use enfilade_plan::sight::Sight;
use enfilade_plan::structure::{self, Body};
use enfilade_plan::{Plan, Wall};

/// A drawing as understood, with what may move; the part of a study that needs no lattice.
#[derive(Clone, Debug)]
pub struct Understood {
    /// The plan.
    pub plan: Plan,
    /// Its drawn pieces and where they meet.
    pub graph: Graph,
    /// Its walls as axes with thickness, openings, columns.
    pub axes: AxisGraph,
    /// Its thick walls, by the control points of their faces.
    pub bodies: Vec<Body>,
    /// Which of it stops sight.
    pub sight: Sight,
    /// Doors and windows as drawn.
    pub fittings: Vec<Fitting>,
    /// Shapes that were not taken as walls, for the picture; whether they are windows or glass by name.
    pub left_out: Vec<(Trace, bool)>,
    /// Texts at parts of doors and windows.
    pub labels: Vec<Label>,
    /// What may move.
    pub moves: Moves,
    /// The building's interior, where it was needed.
    pub interior: Option<Interior>,
    /// Doors and windows, where the file calls them so.
    pub openings: Vec<NamedOpening>,
    /// Texts of the drawing, attributes too.
    pub texts: Vec<Text>,
    /// What stands in the rooms and tells what they are for.
    pub things: Vec<Thing>,
    /// Outlines of a building's spaces with what they are called, drawing frame.
    pub spaces: Vec<(Vec<PointUm>, String)>,
    /// Outlines of all spaces, with their records, drawing frame.
    pub space_rings: Vec<(usize, Vec<PointUm>)>,
    /// What the file asks of its own spaces and doors.
    pub wishes: Vec<Wish>,
    /// What closes doors and windows when it is asked what lies inside.
    pub closings: Vec<Segment>,
    /// For every wall of the plan the index of its entity; filled areas come behind what is drawn.
    pub entities: Vec<usize>,
    /// How sure what is a wall is, where no class of the file says so.
    pub sure_of_walls: Option<f64>,
    /// How sure it is that all of the drawing is there, where something is missing.
    pub sure_of_whole: Option<f64>,
    /// For every mark of the axes the index of its entity.
    pub marked: Vec<usize>,
}

impl Understood {
    /// All faces of its walls.
    pub fn faces(&self) -> Vec<Segment> {
        faces(&self.plan)
    }
}

/// All faces of the walls of a plan.
pub(crate) fn faces(plan: &Plan) -> Vec<Segment> {
    let sided = |w: &'_ Wall| w.trace.segments().flat_map(|s| w.with_sides(s.2)).collect::<Vec<_>>();
    plan.walls.iter().flat_map(sided).collect()
}

/// How near a moving wall's end must be to a closed gap for the gap to be its own.
pub(crate) const CLOSED_REACH_M: f64 = 0.1;

/// What stops sight although nothing is drawn, where no moving wall ends: a gap beside a moving wall is
/// no slip any more once it moves. The building ends where it did.
pub(crate) fn closed_that_stay(base: &Understood) -> Vec<Segment> {
    let ends: Vec<DVec2> = base.moves.handles().map(|h| structure::handle_at(&base.plan, *h)).collect();
    let at = |p: PointUm| base.plan.frame.plan_from_um(p) / base.plan.human_scale;
    let stays =
        |s: &&Segment| [s.a, s.b].iter().all(|p| ends.iter().all(|e| e.distance(at(*p)) > CLOSED_REACH_M));
    let closed = base.sight.closed.iter().filter(stays);
    closed.chain(&base.sight.ends).copied().collect()
}
