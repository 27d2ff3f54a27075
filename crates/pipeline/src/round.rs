//! What is passed on from the study to the search, to what confirms and to what writes.

use std::time::Instant;

use crate::brief::checked;
use crate::job::Job;
use crate::measure::study::Study;
use crate::understand::rooms::rooms_with_kinds;
use crate::understand::sensed::Sensed;
use enfilade_config::Unsure;
use enfilade_overlay::brief_item::BriefItem;
use enfilade_report::{Error, Place, Report};

/// One round of a job: a study, and what is asked of it.
pub(crate) struct Round<'a> {
    /// The drawing, and the settings as they fit its moves.
    pub(crate) job: Job<'a>,
    /// On the lattice that is shown.
    pub(crate) study: &'a Study,
    /// What is sure of the reading.
    pub(crate) sensed: Sensed,
    /// When the job began.
    pub(crate) started: Instant,
    /// The brief of rooms, checked for the present layout.
    pub(crate) brief: Vec<BriefItem>,
}

impl<'a> Round<'a> {
    /// A round of a job that began at `started`; its settings fit the moves of the study.
    pub(crate) fn new(job: Job<'a>, study: &'a Study, started: Instant) -> Self {
        Self { job, study, sensed: Sensed::new(&study.base, job.settings), started, brief: Vec::new() }
    }

    /// Checks the brief of rooms.
    ///
    /// # Errors
    /// As [`checked`].
    pub(crate) fn check_brief(&mut self, report: &mut Report) -> Result<(), Error> {
        let Job { input, settings } = self.job;
        let rooms = rooms_with_kinds(&self.study.base, &self.sensed, settings)?;
        let found = checked((&self.study.base, &self.sensed, &rooms), input, settings, report)?;
        self.brief = found.map_or(Vec::new(), |f| f.items);
        Ok(())
    }

    /// Whether the reading is so unsure that somebody is asked before anything is searched.
    pub(crate) fn is_asked(&self) -> bool {
        !self.sensed.doubts.is_empty() && self.job.settings.unsure == Unsure::Ask
    }

    /// Whether there is anything to search.
    pub(crate) fn is_open(&self) -> bool {
        !self.study.base.moves.parameters.is_empty() && !self.is_asked()
    }

    /// Says that somebody is asked, where that is so.
    pub(crate) fn state_asked(&self, report: &mut Report) {
        if self.is_asked() {
            let text = "The reading is unsure, so no option was made. Answer the questions, or run it with --unsure optimise.";
            report.warn("unsure", Place::file(self.job.input.file()), text);
        }
    }
}
