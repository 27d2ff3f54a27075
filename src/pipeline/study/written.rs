//! A drawing as it was written, read again and measured from scratch.

use super::{Seen, Study, Worth, closed_that_stay, cover_bodies, pieces_of, plan_options, read_options};
use crate::analysis::Obstacles;
use crate::analysis::forest::{Initial, tally};
use crate::analysis::lattice::CellIndex;
use crate::analysis::visibility::visibility_graph;
use crate::config::Settings;
use crate::formats;
use crate::plan::curve::trace_like;
use crate::plan::geometry::Segment;
use crate::plan::{Plan, PlanOptions, understand};
use crate::report::{Error, Place, Report};

impl Study {
    /// Measures a drawing that this study wrote, from its bytes and from scratch, on the study's lattice.
    ///
    /// # Errors
    /// What reading returns: the written file must be readable.
    pub fn measure_written(&self, bytes: &[u8], settings: &Settings) -> Result<Worth, Error> {
        let plan = &self.base.plan;
        let again = self.read_again(bytes, settings)?;
        let mut segments: Vec<Segment> = Vec::new();
        for (w, wall) in again.walls.iter().enumerate() {
            for (s, part, _) in pieces_of(&wall.trace, None) {
                segments.extend(self.base.sight.blocking((w as u32, part), s));
            }
        }
        segments.extend(closed_that_stay(&self.base));
        let mut pieces = self.pieces.clone();
        for (w, range) in self.base.moves.walls.iter().zip(&self.piece_ranges) {
            let trace =
                trace_like(&again.walls[*w as usize].shape, &plan.walls[*w as usize].trace, &plan.frame);
            self.place(&mut pieces[range.0..range.1], &trace);
        }
        let seen = |scene: &super::seen::Scene| -> Seen {
            let obstacles =
                Obstacles { segments: segments.clone(), blind: self.blind_again(&again, &scene.cells) };
            let graph = visibility_graph(&scene.lattice, &obstacles);
            let initial = Initial { components: &scene.components, covered: &obstacles.blind };
            scene.seen(tally(&scene.lattice, &graph, Some(initial)), || obstacles.clone())
        };
        let pairs = self.pairs.iter().map(|p| seen(&p.scene)).collect();
        Ok(self.worth(seen(&self.main), pairs, &pieces))
    }

    fn read_again(&self, bytes: &[u8], settings: &Settings) -> Result<Plan, Error> {
        let plan = &self.base.plan;
        let mut report = Report::default();
        let drawing = formats::read(&plan.file, bytes, &read_options(settings), &mut report)?;
        let picked = Some(plan.picked.clone());
        let options = PlanOptions { unit: Some(plan.unit.unit), picked, ..plan_options(settings) };
        let again = understand(&drawing, &options, &mut report)?;
        if again.walls.len() != plan.walls.len() {
            let text = format!(
                "{} wall elements after writing, {} before; nothing was written",
                again.walls.len(),
                plan.walls.len()
            );
            return Err(Error::input("written-walls", Place::file(&plan.file), text));
        }
        Ok(again)
    }

    /// Vertices that what can move covers in a plan read again.
    fn blind_again(&self, again: &Plan, cells: &CellIndex) -> Vec<u32> {
        let mut out = Vec::new();
        for w in &self.base.moves.walls {
            if self.base.plan.walls[*w as usize].is_solid {
                cells.vertices_in(&again.walls[*w as usize].trace.points, &mut out);
            }
        }
        let shape = |w: u32| again.walls.get(w as usize).map(|w| &w.shape);
        cover_bodies(&self.base, &shape, cells, &mut out);
        out.sort_unstable();
        out.dedup();
        out
    }
}
