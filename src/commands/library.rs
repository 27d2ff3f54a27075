//! The commands for another program: a drawing opened once and asked often, with values as answers.
//!
//! Settings have the names of the command line ([`Partial::from_named`]). Those of the drawing's side-car and of its
//! folder hold where the caller says nothing, as for a command.

use std::path::{Path, PathBuf};

use super::{Accepted, Choice, Which, accept_option, hold, one_round, open, results_of, settings_for};
use crate::daemon::{Asked, Notice};
use enfilade_config::{Partial, Settings};
use enfilade_overlay::result::{CheckResult, RoundResult};
use enfilade_pipeline::accept::Chosen;
use enfilade_pipeline::cells::{self, CellOptions, Cells, Measured};
use enfilade_pipeline::{Extras, Input, Outcome, Progress, Study};
use enfilade_report::{Cancel, Error, Place, Report};

/// A drawing with what its caller said of it.
#[derive(Clone, Debug)]
pub struct Drawing {
    file: PathBuf,
    shown: String,
    bytes: Vec<u8>,
    said: Partial,
}

/// The present layout, measured.
pub struct Present {
    /// The study.
    pub study: Study,
    /// The settings that it was made with.
    pub settings: Settings,
    /// What was left out or assumed.
    pub report: Report,
}

/// A round that was written.
#[derive(Clone, Debug)]
pub struct Round {
    /// Its folder; the result folder where no round was made.
    pub folder: PathBuf,
    /// Its number, from 1; none where no round was made.
    pub number: Option<u32>,
    /// What it found, as in `result.json`.
    pub result: RoundResult,
    /// What was left out or assumed.
    pub report: Report,
}

/// An option that is a drawing of its own now.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NewDrawing {
    /// The drawing, beside the one it follows.
    pub path: PathBuf,
    /// Whether it was not there before.
    pub is_new: bool,
}

impl Drawing {
    /// Reads a file. `said` holds for everything asked of it.
    ///
    /// # Errors
    /// [`Error::Input`] where there is no such file or it is too large, [`Error::Environment`] where it cannot be read.
    pub fn open(file: &Path, said: Partial) -> Result<Self, Error> {
        let (shown, bytes) = open(file)?;
        Ok(Self { file: file.into(), shown, bytes, said })
    }

    /// What the program understands of it, with `graph.json` and `graph.graphml` among the files.
    ///
    /// # Errors
    /// [`Error::Input`] when it cannot be read as a drawing, [`Error::Usage`] for settings that are wrong.
    pub fn check(&self) -> Result<Outcome<CheckResult>, Error> {
        let settings = settings_for(&self.file, self.said.clone())?.0;
        let extras = Extras { picture: false, graph: true };
        enfilade_pipeline::on_threads(&settings, || {
            enfilade_pipeline::check_with(&self.input(), &settings, extras)
        })
    }

    /// Measures the present layout. `more` goes before what was said at first; with `roots` depth and entropy are
    /// estimated from about so many cells. `tell` hears of each stage: `read`, `measure`.
    ///
    /// # Errors
    /// As [`enfilade_pipeline::analyse`]; [`Error::Usage`] for fewer than two roots.
    pub fn measure(
        &self,
        more: Partial,
        roots: Option<usize>,
        tell: &mut (dyn FnMut(Progress) + Send),
        cancel: &Cancel,
    ) -> Result<Present, Error> {
        if let Some(few) = roots.filter(|n| *n < 2) {
            return Err(out_of("roots", &few.to_string(), "a whole number of 2 or more"));
        }
        let settings = settings_for(&self.file, more.over(self.said.clone()))?.0;
        let mut stage = |name: &str| tell(Progress { stage: name.into(), ..Progress::default() });
        stage("read");
        let (study, report) = enfilade_pipeline::on_threads(&settings, || {
            enfilade_pipeline::measure(&self.input(), &settings, roots, &mut || stage("measure"), cancel)
        })?;
        Ok(Present { study, settings, report })
    }

    /// Makes the next round and writes it into the result folder. `tell` hears how far it is.
    ///
    /// # Errors
    /// As [`enfilade_pipeline::run`]; [`Error::Usage`] for an option to pin that there is none of, [`Error::Environment`] where
    /// results cannot be written.
    pub fn optimise(
        &self,
        more: Partial,
        asked: &Asked,
        tell: &mut dyn FnMut(Progress),
        cancel: &Cancel,
    ) -> Result<Round, Error> {
        let mut partial = more.over(self.said.clone());
        if *asked != Asked::default() {
            let results = results_of(&self.file, partial.out.clone().map(PathBuf::from))?;
            hold(&mut partial, &results, asked, Which::Newest)?;
        }
        let (settings, out) = settings_for(&self.file, partial)?;
        let mut show = |notice: Notice| {
            if let Notice::Progress { value, .. } = notice
                && let Ok(progress) = serde_json::from_value(value)
            {
                tell(progress);
            }
        };
        let (done, finished) = one_round(&self.file, settings, out, &mut show, cancel)?;
        let (result, report) = finished.unwrap_or_default();
        Ok(Round { folder: done.folder, number: done.round, result, report })
    }

    /// Makes an option of a round a new drawing beside this one, with a side-car that carries moves and settings on;
    /// 0 is the best layout. `out` as the round was told.
    ///
    /// # Errors
    /// [`Error::Usage`] where there is no such round or option, [`Error::Input`] where the drawing has changed since,
    /// [`Error::Environment`] where it cannot be written.
    pub fn accept(&self, round: u32, number: usize, out: Option<PathBuf>) -> Result<NewDrawing, Error> {
        let results = results_of(&self.file, out.or(self.said.out.clone().map(PathBuf::from)))?;
        let choice = Choice { of: Which::Round(round), chosen: Chosen::numbered(number), is_clean: false };
        let Accepted { next, is_new, .. } = accept_option(&self.file, &results, choice)?;
        Ok(NewDrawing { path: next, is_new })
    }

    fn input(&self) -> Input<'_> {
        Input::new(&self.shown, &self.bytes, 1)
    }
}

impl Present {
    /// The columns asked for, by cell; `options.roots` and `options.seed` are those of the study.
    ///
    /// # Errors
    /// As [`cells::measure_cells`]; [`Error::Usage`] for a radius below 0.
    pub fn cells(&self, options: CellOptions) -> Result<Cells, Error> {
        let is_radius = |r: f64| (0.0..=f64::from(u32::MAX)).contains(&r);
        if let Some(radius) = options.radius.filter(|r| !is_radius(*r)) {
            return Err(out_of("radius", &radius.to_string(), "a number from 0"));
        }
        let options = CellOptions { roots: self.study.roots, seed: self.settings.seed, ..options };
        let Measured { columns, .. } =
            enfilade_pipeline::on_threads(&self.settings, || cells::measure_cells(&self.study, &options))?;
        Ok(cells::cells(&self.study, columns))
    }

    /// Who sees whom among the cells.
    ///
    /// # Errors
    /// [`Error::Environment`] when the threads cannot be started.
    pub fn views(&self) -> Result<(Cells, cells::Views), Error> {
        enfilade_pipeline::on_threads(&self.settings, || {
            let all = cells::cells(&self.study, Vec::new());
            let views = cells::views(&self.study, &all);
            Ok((all, views))
        })
    }
}

fn out_of(what: &'static str, found: &str, expected: &str) -> Error {
    let text = format!("{what}: found {found}, expected {expected}; nothing was done");
    Error::usage(what, Place::default(), text)
}
