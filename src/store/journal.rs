//! What was made from which content, across crashes: one JSON object a line, only ever appended.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};

use super::{Disk, disk_error, path_from_bytes, read_own, replace_file};
use crate::report::{Error, Place, Problem, Severity};

/// A journal longer than this is rewritten at the next start with what still counts.
const COMPACT_BYTES: usize = 1 << 20;

/// One step in the life of a job.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The content waits for its turn.
    Queued,
    /// The job runs.
    Started,
    /// The results are about to appear as this folder: where it exists after a crash, the job is done.
    Publishing {
        /// The folder that appears.
        folder: PathBuf,
        /// SHA-256 of the drawings in it, by which copies of them are known.
        outputs: Vec<String>,
    },
    /// The job is done; the text says what came of it.
    Finished(String),
    /// The content cannot be used; it is not tried again.
    Failed(Problem),
    /// The job was given up: a newer save, the drawing removed, or the end of the daemon.
    Stopped,
    /// The user gave the job up: this content is taken up again only when asked for.
    Cancelled,
}

/// The journal of one watched root.
pub struct Journal {
    disk: Arc<dyn Disk>,
    path: PathBuf,
    last: BTreeMap<PathBuf, Last>,
    outputs: BTreeSet<String>,
    is_torn: bool,
}

#[derive(Clone, Debug, PartialEq)]
struct Last {
    sha256: String,
    config: String,
    event: String,
    folder: Option<PathBuf>,
    /// What came of it, or why it failed.
    words: String,
    /// Where it failed.
    place: String,
}

/// How the last job of a content ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// Results were made; in a sentence, as far as it is remembered.
    Finished(String),
    /// The content cannot be used.
    Failed(Problem),
    /// The user gave it up.
    Cancelled,
}

impl Journal {
    /// Reads `journal.jsonl` in `folder`. A torn last line is what a crash leaves; it is passed over.
    ///
    /// # Errors
    /// From the disk, when the journal is there but cannot be read.
    pub fn open(disk: Arc<dyn Disk>, folder: &Path) -> Result<Self, Error> {
        let path = folder.join("journal.jsonl");
        let text = match read_own(&path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(e) => return Err(disk_error("reading", &path, &e)),
        };
        let is_torn = text.last().is_some_and(|b| *b != b'\n');
        let mut journal = Self { disk, path, last: BTreeMap::new(), outputs: BTreeSet::new(), is_torn };
        for line in text.split(|b| *b == b'\n') {
            if let Ok(value) = serde_json::from_slice::<Value>(line) {
                journal.replay(&value);
            }
        }
        journal.settle_published();
        if text.len() > COMPACT_BYTES {
            journal.compact()?;
        }
        Ok(journal)
    }

    fn replay(&mut self, line: &Value) {
        let text = |key: &str| line.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
        if let Some(outputs) = line.get("outputs").and_then(Value::as_array) {
            self.outputs.extend(outputs.iter().filter_map(Value::as_str).map(str::to_owned));
        }
        let Some(drawing) = line.get("drawing").and_then(path_from_json) else { return };
        let folder = line.get("folder").and_then(path_from_json);
        let problem = |key: &str| line["problem"][key].as_str().map(str::to_owned);
        let last = Last {
            sha256: text("sha256"),
            config: text("config"),
            event: text("event"),
            folder,
            words: problem("text").unwrap_or_else(|| text("summary")),
            place: problem("place").unwrap_or_default(),
        };
        self.last.insert(drawing, last);
    }

    /// A crash between the appearing of the results and the word about it: the folder decides.
    fn settle_published(&mut self) {
        for last in self.last.values_mut().filter(|l| l.event == "publishing") {
            let is_there = last.folder.as_ref().is_some_and(|f| f.is_dir());
            last.event = if is_there { "finished" } else { "started" }.into();
        }
    }

    fn compact(&mut self) -> Result<(), Error> {
        let mut text = format!("{}\n", json!({"event": "outputs", "outputs": self.outputs}));
        for (drawing, l) in &self.last {
            let mut line = json!({
                "event": l.event, "drawing": path_to_json(drawing), "sha256": l.sha256, "config": l.config,
            });
            if l.event == "failed" {
                line["problem"] = json!({"place": l.place, "text": l.words});
            } else {
                line["summary"] = json!(l.words);
            }
            text.push_str(&format!("{line}\n"));
        }
        replace_file(&*self.disk, &self.path, text.as_bytes())?;
        self.is_torn = false;
        Ok(())
    }

    /// Adds a step for `drawing` (relative to the root) with this content and this configuration, at
    /// this time (RFC 3339). Steps that decide whether a job is done are durable when this returns.
    ///
    /// # Errors
    /// From the disk; the step then counts until the next start only.
    pub fn append(
        &mut self,
        drawing: &Path,
        sha256: &str,
        config: &str,
        time: &str,
        step: &Step,
    ) -> Result<(), Error> {
        let (event, more) = match step {
            Step::Queued => ("queued", json!({})),
            Step::Started => ("started", json!({})),
            Step::Publishing { folder, outputs } => {
                ("publishing", json!({"folder": path_to_json(folder), "outputs": outputs}))
            }
            Step::Finished(summary) => ("finished", json!({"summary": summary})),
            Step::Failed(problem) => ("failed", json!({"problem": problem})),
            Step::Stopped => ("stopped", json!({})),
            Step::Cancelled => ("cancelled", json!({})),
        };
        let mut line = json!({
            "time": time, "event": event, "drawing": path_to_json(drawing), "sha256": sha256, "config": config,
        });
        if let (Some(line), Value::Object(more)) = (line.as_object_mut(), more) {
            line.extend(more);
        }
        self.replay(&line);
        let is_durable = !matches!(step, Step::Queued | Step::Started | Step::Stopped);
        let lead = if std::mem::take(&mut self.is_torn) { "\n" } else { "" };
        let written = self.disk.append(&self.path, format!("{lead}{line}\n").as_bytes(), is_durable);
        written.map_err(|e| {
            // The line may stand there in part.
            self.is_torn = true;
            disk_error("writing", &self.path, &e)
        })
    }

    /// How the job of this content ended; `None` where something is left to do.
    pub fn end_of(&self, drawing: &Path, sha256: &str, config: &str) -> Option<Ended> {
        let last = self.last.get(drawing).filter(|l| l.sha256 == sha256 && l.config == config)?;
        match last.event.as_str() {
            "finished" => Some(Ended::Finished(last.words.clone())),
            "cancelled" => Some(Ended::Cancelled),
            "failed" => Some(Ended::Failed(Problem {
                code: "failed-before",
                severity: Severity::Error,
                place: Place::file(last.place.clone()),
                text: last.words.clone(),
            })),
            _ => None,
        }
    }

    /// Whether these bytes are a drawing that we wrote.
    pub fn is_output(&self, sha256: &str) -> bool {
        self.outputs.contains(sha256)
    }

    /// Drawings with their last event, in the order of their names.
    pub fn drawings(&self) -> impl Iterator<Item = (&Path, &str)> {
        self.last.iter().map(|(path, last)| (path.as_path(), last.event.as_str()))
    }
}

/// A path as JSON: a string, or an object with its bytes in hexadecimal where it is no text.
pub(super) fn path_to_json(path: &Path) -> Value {
    match path.to_str() {
        Some(text) => json!(text),
        None => {
            let bytes = path.as_os_str().as_encoded_bytes();
            json!({"hex": bytes.iter().map(|b| format!("{b:02x}")).collect::<String>()})
        }
    }
}

fn path_from_json(value: &Value) -> Option<PathBuf> {
    if let Some(text) = value.as_str() {
        return Some(text.into());
    }
    let hex = value.get("hex")?.as_str()?;
    let pairs = (0..hex.len() / 2).map(|i| u8::from_str_radix(hex.get(2 * i..2 * i + 2)?, 16).ok());
    Some(path_from_bytes(&pairs.collect::<Option<Vec<u8>>>()?))
}
