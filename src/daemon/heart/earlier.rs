//! What is known of a content from before: results beside the drawing, and how its job ended by the journal.

use super::super::status::result_of;
use super::*;
use crate::watch::{bytes_of, sha256_hex};

impl Heart {
    /// Whether the newest results beside a drawing are of another content, made while its folder lay elsewhere or by
    /// hand: what the journal knows of the drawing is older.
    pub(super) fn has_results_of_another(&self, drawing: &Path, of: &Content) -> bool {
        let folder = present_folder(drawing, &self.placing_of(drawing));
        folder.and_then(|f| content_of_results(&f)).is_some_and(|found| found != of.key && found != of.sha256)
    }

    /// Takes what the results beside a drawing say of it into the journal, which knows nothing of it: it was lost, or
    /// could not be read.
    pub(super) fn rebuild(&mut self, drawing: &Path, of: &Content, show: &mut dyn FnMut(Notice)) {
        let (Some(journal), below) = (self.journal_of(drawing), self.below(drawing)) else { return };
        if open_journal(&journal).knows(&below) {
            return;
        }
        let folder = present_folder(drawing, &self.placing_of(drawing));
        let found = folder.and_then(|f| result_of(&f, &of.sha256, &of.config));
        let Some((summary, round)) = found else { return };
        let files = std::fs::read_dir(&round).into_iter().flatten().flatten().map(|e| e.path());
        let outputs =
            files.filter(|p| is_output_name(p)).filter_map(|p| bytes_of(&p)).map(|b| sha256_hex(&b));
        let what = Waiting::new(drawing.into(), of.clone(), Asked::default());
        self.note(&what, &Step::Publishing { folder: round.clone(), outputs: outputs.collect() }, show);
        self.note(&what, &Step::Finished(summary), show);
    }

    /// Says how the job of this content and these settings ended, instead of doing it again; `is_mended`: the settings
    /// seen last could not be read, and what failed for that is over.
    pub(super) fn ended_before(
        &mut self,
        drawing: PathBuf,
        end: Ended,
        is_mended: bool,
        show: &mut dyn FnMut(Notice),
    ) {
        match end {
            Ended::Finished(summary) => {
                let (placing, content) = (self.placing_of(&drawing), self.contents.get(&drawing));
                let states: &[&str] = if is_mended { &UNFINISHED_OR_FAILED } else { &UNFINISHED };
                let of = (content.map_or("", |c| &*c.sha256), &*summary);
                settle(&*self.disk, &drawing, &placing, states, of);
                let folder = present_folder(&drawing, &placing);
                show(Notice::UpToDate { drawing, folder, summary });
            }
            Ended::Cancelled => {
                self.cancelled.insert(drawing.clone());
                if is_mended {
                    settle_stopped(
                        &*self.disk,
                        &drawing,
                        &self.placing_of(&drawing),
                        &["failed"],
                        BY_THE_USER,
                    );
                }
                self.say_results(&drawing, show);
                show(Notice::Stopped { drawing, why: CANCELLED_BEFORE });
            }
            Ended::Failed(problem) => {
                self.fail(&drawing, &problem);
                self.say_results(&drawing, show);
                show(Notice::Failed { drawing, problem, retry_secs: None });
            }
        }
    }
}
