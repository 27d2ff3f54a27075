//! What is known of a content from before: results beside the drawing, and how its job ended by the journal.

use super::*;

impl Heart {
    /// Whether the newest results beside a drawing are of another content, made while its folder lay elsewhere or by
    /// hand: what the journal knows of the drawing is older.
    pub(super) fn has_results_of_another(&self, drawing: &Path, sha256: &str) -> bool {
        let folder = present_folder(drawing, &self.placing_of(drawing));
        folder.and_then(|f| content_of_results(&f)).is_some_and(|of| of != sha256)
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
                let of = (content.map_or("", |c| &*c.0), &*summary);
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
