//! One job: lock the result folder, run, publish whole results.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant, SystemTime};

use serde_json::{Value, json};

use super::status::{SharedDisk, Standing, drawing_status, rfc3339};
use super::{Done, JobEvent, JobOutput, JobRequest, Notice, RunJob, is_reading};
use crate::store::{Home, Placing, SO_FAR, Written, round_name};
use enfilade_report::{Cancel, Error, Place, Problem};

/// `status.json` is not rewritten more often while a job runs.
const STATUS_PAUSE: Duration = Duration::from_millis(500);

/// What a running job tells.
pub(super) enum Told {
    Progress(Value),
    Analysis(PathBuf),
    Problem(Problem),
    /// How much processor time the job has taken.
    Worked(Duration),
}

impl Told {
    /// Whether the drawing may not be understood yet when this event comes.
    pub(super) fn is_reading(&self) -> bool {
        match self {
            Self::Progress(value) => is_reading(value),
            Self::Problem(_) | Self::Worked(_) => true,
            Self::Analysis(_) => false,
        }
    }

    /// Whether the search goes on, so that there is a best so far.
    pub(super) fn is_searching(&self) -> bool {
        let stage = |value: &Value| value["stage"].as_str().is_some_and(|s| s.starts_with("optimise"));
        matches!(self, Self::Progress(value) if stage(value))
    }

    /// Whether the best so far lies there now.
    pub(super) fn is_best(&self) -> bool {
        matches!(self, Self::Progress(value) if value["stage"] == SO_FAR)
    }

    /// What the user hears of it, if anything.
    pub(super) fn notice(self, drawing: &Path) -> Option<Notice> {
        let drawing = drawing.to_path_buf();
        match self {
            Self::Progress(value) => Some(Notice::Progress { drawing, value }),
            Self::Analysis(folder) => Some(Notice::Analysis { drawing, folder }),
            Self::Problem(problem) => Some(Notice::Problem { path: drawing, problem }),
            Self::Worked(_) => None,
        }
    }
}

/// Called with the folder that is about to appear and what is in it, before it appears.
pub(super) type BeforePublish<'a> = dyn FnMut(&Path, &[Written]) -> Result<(), Error> + 'a;

/// Runs a job and publishes its results. A panic becomes a failed job. After `cancel` nothing is published but the best so
/// far, where it is waited for; results of earlier jobs stay as they are.
pub(super) fn perform(
    disk: SharedDisk,
    request: &JobRequest,
    placing: &Placing,
    run: &RunJob,
    cancel: &Cancel,
    tell: &mut dyn FnMut(Told),
    before: &mut BeforePublish<'_>,
) -> Result<Done, Error> {
    let home = Home::open(disk, &request.drawing, placing)?;
    let mut desk = Desk {
        home: &home,
        request,
        since: rfc3339(SystemTime::now()),
        written: None,
        refused: None,
        is_measured_told: false,
        tell,
        cancel,
    };
    desk.write("running", None, None, None)?;
    let earlier = Arc::new(home.memory());
    let (round, results) = (home.next_round(), home.folder().into());
    let numbered = JobRequest { round, earlier, results, ..request.clone() };
    let output = catch_unwind(AssertUnwindSafe(|| run(&numbered, &mut |event| desk.take(event), cancel)))
        .unwrap_or_else(|payload| Err(panicked(request, &*payload)));
    if let Some(error) = desk.refused.take() {
        return Err(error);
    }
    let output = output.inspect_err(|e| {
        if matches!(e, Error::Input(_) | Error::Usage(_)) {
            home.forget();
        }
    })?;
    if cancel.is_stopped() {
        // It had ended by itself before it heard of it.
        if cancel.keeps_best() {
            desk.take(JobEvent::SoFar { files: output.files, progress: json!({ "stage": SO_FAR }) });
        }
        return Err(Error::Stopped);
    }
    let open = open_questions(&output);
    let done = publish(&home, output, cancel, before)?;
    home.forget();
    let round = done.round.map(round_name);
    desk.write("done", round.as_deref(), Some(&done.summary), open.as_ref())?;
    Ok(done)
}

/// What of its result a person should decide, as `{questions: […]}`.
fn open_questions(output: &JobOutput) -> Option<Value> {
    let file = output.files.iter().find(|f| f.path.as_os_str() == "result.json")?;
    let mut result: Value = serde_json::from_slice(&file.bytes).ok()?;
    let questions = result.get_mut("questions").map(Value::take)?;
    Some(json!({ "questions": questions }))
}

fn publish(
    home: &Home,
    output: JobOutput,
    cancel: &Cancel,
    before: &mut BeforePublish<'_>,
) -> Result<Done, Error> {
    let JobOutput { files, is_degraded, summary } = output;
    if files.is_empty() {
        return Ok(Done { folder: home.folder().into(), round: None, is_degraded, summary });
    }
    let staged = home.stage(&files)?;
    let number = home.next_round();
    before(&home.folder().join(round_name(number)), staged.written())?;
    cancel.check()?;
    let folder = staged.publish_round(number)?;
    home.drop_so_far();
    Ok(Done { folder, round: Some(number), is_degraded, summary })
}

/// Takes what the running job tells to the disk and to the user.
struct Desk<'a> {
    home: &'a Home,
    request: &'a JobRequest,
    since: String,
    /// When progress was last written.
    written: Option<Instant>,
    /// Why the disk refused early results: the job was stopped, as it could only fail in the end.
    refused: Option<Error>,
    /// Whether it was said that the present layout is measured: of a building the pictures come later.
    is_measured_told: bool,
    tell: &'a mut dyn FnMut(Told),
    cancel: &'a Cancel,
}

impl Desk<'_> {
    fn take(&mut self, event: JobEvent) {
        match event {
            JobEvent::Progress(value) => {
                let is_due = self.written.is_none_or(|t| t.elapsed() >= STATUS_PAUSE);
                if is_due && !self.cancel.is_stopped() {
                    self.written = Some(Instant::now());
                    // The job goes on: should the disk still refuse in the end, the job fails then.
                    let _ = self.write("running", None, None, Some(&value));
                }
                (self.tell)(Told::Progress(value));
            }
            JobEvent::Analysis(_) if self.cancel.is_stopped() => {}
            JobEvent::Analysis(files) => match self.home.publish_analysis(&files) {
                Ok(_) if std::mem::replace(&mut self.is_measured_told, true) => {}
                Ok(folder) => (self.tell)(Told::Analysis(folder)),
                Err(error) => {
                    self.refused = Some(error);
                    self.cancel.stop();
                }
            },
            JobEvent::SoFar { .. } if self.cancel.is_stopped() && !self.cancel.keeps_best() => {}
            JobEvent::SoFar { files, mut progress } => match self.home.publish_so_far(&files) {
                Ok(folder) => {
                    progress["folder"] = folder.to_string_lossy().into();
                    if !self.cancel.is_stopped() {
                        let _ = self.write("running", None, None, Some(&progress));
                    }
                    (self.tell)(Told::Progress(progress));
                }
                Err(error) => {
                    self.refused = Some(error);
                    self.cancel.stop();
                }
            },
            JobEvent::Worked(worked) => (self.tell)(Told::Worked(worked)),
            // What is not kept is measured again.
            JobEvent::Keep { bytes, is_anew } => drop(self.home.remember(&bytes, is_anew)),
        }
    }

    fn write(
        &self,
        state: &str,
        round: Option<&str>,
        summary: Option<&str>,
        progress: Option<&Value>,
    ) -> Result<(), Error> {
        let (sha256, content) = (&*self.request.sha256, &*self.request.content);
        let config = &*self.request.config;
        let standing = Standing { state, sha256, content, config, round, summary, problems: &[] };
        let status = drawing_status(&self.request.drawing, &self.since, &standing, progress);
        self.home.write_status(&status)
    }
}

fn panicked(request: &JobRequest, payload: &(dyn Any + Send)) -> Error {
    let words = payload.downcast_ref::<&str>().map(|s| (*s).to_owned());
    let words = words.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
    let name = request.drawing.file_name().unwrap_or_default().to_string_lossy();
    let text = format!("this is an error of the program, please report it with the drawing: {words}");
    Error::input("job-panicked", Place::file(name), text)
}
