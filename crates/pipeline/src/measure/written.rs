//! A drawing as it was written, read again and measured from scratch.

use std::collections::BTreeMap;

use crate::measure::look::{Look, SeenOn};
use crate::measure::obstacles::{blind, cover_bodies, cover_wide, stopping};
use crate::measure::seen::{Scene, Seen};
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::read;
use crate::understand::options::plan_options;
use crate::understand::pieces::pieces_of;
use crate::understand::understood::closed_that_stay;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Shape;
use enfilade_config::Settings;
use enfilade_engine::Obstacles;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use enfilade_engine::lattice::CellIndex;
use enfilade_moves::{Layout, MovedWall};
use enfilade_plan::{Plan, PlanOptions, understand};
use enfilade_report::{Error, Place, Report, counted};

impl Study {
    /// Measures a drawing that this study wrote of a layout, from its bytes and from scratch, on the study's
    /// lattice.
    ///
    /// # Errors
    /// What reading returns: the written file must be readable.
    pub fn measure_written(
        &self,
        bytes: &[u8],
        layout: &Layout,
        settings: &Settings,
    ) -> Result<Worth, Error> {
        let plan = &self.base.plan;
        let again = self.read_again(bytes, settings)?;
        let meant = meant_shapes(plan, layout);
        let mut segments: Vec<Segment> = Vec::new();
        for (w, wall) in again.walls.iter().enumerate() {
            for (s, part, _) in pieces_of(&wall.trace, None) {
                let drawn = &plan.walls[w];
                let parts = self.base.sight.blocking((w as u32, part), s);
                segments.extend(parts.flat_map(|s| drawn.with_sides(s)));
            }
        }
        segments.extend(closed_that_stay(&self.base));
        let mut pieces = self.pieces.drawn.clone();
        for (i, w) in self.base.moves.walls.iter().enumerate() {
            let shape = as_cornered(plan, &again.walls[*w as usize].shape, meant[w]);
            self.pieces.place_wall(&self.base, i, shape, &mut pieces);
        }
        let seen =
            self.seen_through(&segments, &|scene| self.blind_again(&again, &meant, &scene.cells, &segments));
        let written = |moved: &MovedWall| MovedWall {
            trace: again.walls[moved.wall as usize].trace.clone(),
            ..moved.clone()
        };
        let written = Layout { walls: layout.walls.iter().map(written).collect() };
        Ok(self.worth(seen, &pieces, &written))
    }

    /// Measures other lines of walls than the drawn ones: of a plan in which works were made, and walls have moved besides.
    /// Over the cells of the study that neither the present layout nor this one covers.
    pub(crate) fn measure_built(&self, layout: &Layout, segments: &[Segment]) -> Worth {
        let base = &self.base;
        let identity = base.moves.apply(&base.plan, &base.graph, &base.moves.identity());
        let covered = |scene: &Scene| {
            let mut all = blind(base, layout, &scene.cells, segments);
            if *layout != identity {
                all.extend(blind(base, &identity, &scene.cells, &[]));
                all.sort_unstable();
                all.dedup();
            }
            all
        };
        let seen = self.seen_through(segments, &covered);
        let mut worth = self.worth(seen, &self.pieces.placed(base, layout), layout);
        let length_m = |of: &[Segment]| -> f64 {
            let one = |s: &Segment| ((s.b[0] - s.a[0]) as f64).hypot((s.b[1] - s.a[1]) as f64);
            of.iter().map(one).sum::<f64>() / UM_PER_M
        };
        worth.built(length_m(segments) - length_m(&stopping(base, &identity)));
        worth
    }

    /// What is seen where these lines stop sight and those vertices are covered.
    fn seen_through(
        &self,
        segments: &[Segment],
        covered: &(dyn Fn(&Scene) -> Vec<u32> + Sync),
    ) -> Vec<SeenOn> {
        let seen = |scene: &Scene| -> Seen {
            let obstacles = Obstacles { segments: segments.to_vec(), blind: covered(scene) };
            let tally = scene.evaluator.evaluate_walls(&obstacles);
            scene.seen(tally, &obstacles.blind, || obstacles.clone())
        };
        let of = |look: &Look| SeenOn {
            main: seen(&look.main),
            pairs: look.pairs.iter().map(|p| seen(&p.scene)).collect(),
        };
        self.looks.iter().map(of).collect()
    }

    fn read_again(&self, bytes: &[u8], settings: &Settings) -> Result<Plan, Error> {
        let plan = &self.base.plan;
        let mut report = Report::default();
        let drawing = read::drawing(&plan.file, bytes, settings, &mut report)?;
        let picked = Some(plan.picked.clone());
        let senses = Some(plan.senses.clone());
        let options = PlanOptions { unit: Some(plan.unit.unit), picked, senses, ..plan_options(settings) };
        let again = understand(&drawing, &options, &mut report)?;
        if again.walls.len() != plan.walls.len() {
            let text = format!(
                "{} after writing, {} before; nothing was written",
                counted(again.walls.len() as u64, "wall element"),
                plan.walls.len()
            );
            return Err(Error::input("written-walls", Place::file(&plan.file), text));
        }
        Ok(again)
    }

    /// Vertices that what can move covers or touches in a plan read again.
    fn blind_again(
        &self,
        again: &Plan,
        meant: &BTreeMap<u32, &Shape>,
        cells: &CellIndex,
        segments: &[Segment],
    ) -> Vec<u32> {
        let mut out = Vec::new();
        for w in &self.base.moves.walls {
            if self.base.plan.walls[*w as usize].is_solid {
                cells.vertices_in(&again.walls[*w as usize].trace.points, &mut out);
            }
        }
        let shape =
            |w: u32| Some(as_cornered(&self.base.plan, &again.walls.get(w as usize)?.shape, meant.get(&w)?));
        cover_bodies(&self.base, &shape, cells, &mut out);
        for w in &self.base.moves.walls {
            cover_wide(&self.base, *w, &again.walls[*w as usize].trace, cells, &mut out);
        }
        segments.iter().for_each(|s| cells.vertices_on(*s, &mut out));
        out.sort_unstable();
        out.dedup();
        out
    }
}

/// Where a layout means every wall to stand.
fn meant_shapes<'a>(plan: &'a Plan, layout: &'a Layout) -> BTreeMap<u32, &'a Shape> {
    let mut out: BTreeMap<u32, &Shape> =
        plan.walls.iter().enumerate().map(|(w, wall)| (w as u32, &wall.shape)).collect();
    out.extend(layout.walls.iter().map(|w| (w.wall, &w.shape)));
    out
}

/// Corners nearer than this are the same one, micrometres.
pub(crate) const SAME_CORNER_UM: f64 = 1_000.0;

/// A shape as written where its corners are those that were meant, one by one, else the shape that was meant:
/// the cut through a turned mesh may start at another corner, or have one more on a straight face.
fn as_cornered<'a>(plan: &Plan, written: &'a Shape, meant: &'a Shape) -> &'a Shape {
    let corners = |s: &Shape| -> Vec<PointUm> {
        control_points(s).into_iter().map(|p| plan.frame.um_from_file(p)).collect()
    };
    let (a, b) = (corners(written), corners(meant));
    let near =
        |(p, q): (&PointUm, &PointUm)| ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64) <= SAME_CORNER_UM;
    if a.len() == b.len() && a.iter().zip(&b).all(near) { written } else { meant }
}
