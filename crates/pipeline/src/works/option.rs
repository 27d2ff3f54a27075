//! An option that builds, and what it is judged by.

use super::made::Moved;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::brief::Aims;
use enfilade_cad::drawing::{Addition, Edit};
use enfilade_config::WorkTable;
use enfilade_overlay::built::{Effort, OptionWork, SHOWS_PRIVATE, above_words};
use enfilade_overlay::picture::{PlanPicture, Stroke};
use enfilade_overlay::result::{Gains, MoveEntry, Objective};
use enfilade_overlay::words;
use enfilade_report::Report;

/// An option that builds.
pub(crate) struct BuildingOption {
    /// Its works, as `result.json` has them.
    pub(crate) works: Vec<OptionWork>,
    /// Their names in one line.
    pub(crate) title: String,
    /// Whether more of a private room is seen while its door stands open.
    pub(super) shows_private: bool,
    /// Whether it stays because somebody pinned it.
    pub(crate) is_pinned: bool,
    /// What of the limits and rules it breaks, in words: only what is pinned may.
    pub(crate) breaks: Vec<String>,
    /// Whether it is the least that brings half of what the best set does.
    pub(crate) is_least: bool,
    /// What they cost together.
    pub(crate) effort: Effort,
    /// What moves beside them.
    pub(crate) moved: Moved,
    /// Of the objectives, as the layouts of the search have them.
    pub(crate) values: Vec<f64>,
    /// Whether it keeps the thresholds of the search.
    pub(crate) is_within: bool,
    /// Confirmed gains.
    pub(crate) gains: Gains,
    /// What the file is worth, read again.
    pub(crate) worth: Worth,
    /// How the works are written.
    pub(crate) edits: Vec<Edit>,
    /// What was demolished, drawing units.
    pub(crate) additions: Vec<Addition>,
    /// What the drawing cannot hold: decided in the side-car.
    pub(crate) tables: Vec<WorkTable>,
    /// What goes, and what is built, plan frame.
    pub(crate) strokes: Vec<Stroke>,
    /// The plan with the works.
    pub(crate) picture: PlanPicture,
    /// What there is to say.
    pub(crate) report: Report,
}

/// Said of the least change.
const IS_LEAST: &str = "No cheaper works bring half of what the best do";

impl BuildingOption {
    /// `An opening of 1.8 m between kitchen and living room; visibility +9 % (8 to 10 %). 1.8 m of wall goes.`
    pub(crate) fn words(&self, gains: &str) -> String {
        let first = [self.title.as_str(), gains].into_iter().filter(|l| !l.is_empty());
        let first = first.collect::<Vec<_>>().join("; ");
        std::iter::once(first).chain(self.costs()).map(|s| s + ".").collect::<Vec<_>>().join(" ")
    }

    /// The same in lines for the note in the drawing.
    pub(crate) fn note_lines(&self, gains: &str) -> Vec<String> {
        let first = [self.title.as_str(), gains].into_iter().filter(|l| !l.is_empty()).map(str::to_owned);
        first.chain(self.costs()).collect()
    }

    /// What moves beside them, told; empty where nothing does.
    pub(crate) fn moves_words(&self, moves: &[MoveEntry]) -> String {
        if self.moved.is_any() { words::moved(moves, &self.moved.parameters, &[]) } else { String::new() }
    }

    /// What it costs.
    fn costs(&self) -> impl Iterator<Item = String> {
        let private = if self.shows_private { SHOWS_PRIVATE } else { "" };
        let least = if self.is_least { IS_LEAST } else { "" };
        [self.effort.words(), above_words(&self.works), least.to_owned(), private.to_owned()]
            .into_iter()
            .filter(|s| !s.is_empty())
    }
}

/// What options that build are judged by.
#[derive(Clone, Copy)]
pub(crate) struct Judges<'a> {
    /// On the lattice that is shown.
    pub(crate) study: &'a Study,
    /// On the lattices that are searched on.
    pub(crate) trial: &'a Study,
    /// What is asked for.
    pub(crate) objectives: &'a Aims,
    /// The same as results tell it, with what options keep.
    pub(crate) told: &'a [Objective],
}
