//! What was made from which content, across crashes: one JSON object a line, only ever appended. Each line says by
//! which version of the journal it was written; what this program does not know is named and not obeyed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};

use super::own::refuse_link;
use super::{Disk, disk_error, path_from_bytes, read_own, replace_file};
use enfilade_report::{Error, Place, Problem, Severity};

/// A journal longer than this is rewritten at the next start with what still counts.
const COMPACT_BYTES: usize = 1 << 20;
/// Kinds of what is not known that are named.
const UNKNOWN_MAX: usize = 8;

/// Version of what is written. Lines without one are of the first.
pub const JOURNAL_VERSION: u64 = 2;
/// The events that are known.
const EVENTS: [&str; 8] =
    ["outputs", "queued", "started", "publishing", "finished", "failed", "stopped", "cancelled"];

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
    /// What was not understood, each kind once, with its number.
    unknown: BTreeMap<String, usize>,
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
        let (last, outputs, unknown) = Default::default();
        let mut journal = Self { disk, path, last, outputs, is_torn, unknown };
        for line in text.split(|b| *b == b'\n') {
            if let Ok(value) = serde_json::from_slice::<Value>(line) {
                journal.read(&value);
            }
        }
        journal.settle_published();
        if text.len() > COMPACT_BYTES && journal.unknown.is_empty() {
            journal.compact()?;
        }
        Ok(journal)
    }

    /// Obeys a line, or counts it where it is of a later version or an event that is not known.
    fn read(&mut self, line: &Value) {
        let (version, event) = (line["v"].as_u64().unwrap_or(1), line["event"].as_str().unwrap_or_default());
        let why = if version > JOURNAL_VERSION {
            format!("version {version}")
        } else if EVENTS.contains(&event) {
            return self.replay(line);
        } else {
            format!("event {:?}", event.chars().take(40).collect::<String>())
        };
        // However many kinds there are, a few are named.
        if self.unknown.len() < UNKNOWN_MAX || self.unknown.contains_key(&why) {
            *self.unknown.entry(why).or_default() += 1;
        }
    }

    /// What was not understood when the journal was read.
    pub fn unread(&self) -> Option<Problem> {
        if self.unknown.is_empty() {
            return None;
        }
        let named: Vec<String> = self.unknown.iter().map(|(why, n)| format!("{why} ({n} lines)")).collect();
        let text = format!(
            "found {}, expected events of version {JOURNAL_VERSION}; these lines were left as they are. Drawings with \
             results beside them are not done again",
            named.join(", ")
        );
        let place = Place::file(self.path.display().to_string());
        Some(Problem { code: "journal-unknown", severity: Severity::Warning, place, text })
    }

    /// Whether anything is known of a drawing.
    pub fn knows(&self, drawing: &Path) -> bool {
        self.last.contains_key(drawing)
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
        let mut text =
            format!("{}\n", json!({"v": JOURNAL_VERSION, "event": "outputs", "outputs": self.outputs}));
        for (drawing, l) in &self.last {
            let mut line = json!({
                "v": JOURNAL_VERSION, "event": l.event, "drawing": path_to_json(drawing), "sha256": l.sha256, "config": l.config,
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
            "v": JOURNAL_VERSION, "time": time, "event": event, "drawing": path_to_json(drawing), "sha256": sha256, "config": config,
        });
        if let (Some(line), Value::Object(more)) = (line.as_object_mut(), more) {
            line.extend(more);
        }
        self.replay(&line);
        let is_durable = !matches!(step, Step::Queued | Step::Started | Step::Stopped);
        // The folder may have become a link since.
        self.path.parent().map_or(Ok(()), refuse_link)?;
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

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::store::SystemDisk;

    const TIME: &str = "2026-01-01T00:00:00Z";

    /// A link in the journal's place, also one that is planted while it is written, or in its folder's, leads nowhere.
    #[cfg(unix)]
    #[test]
    fn no_journal_is_kept_through_a_link() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().unwrap();
        let [folder, aside, drawing] = [".enfilade", "aside", "plan.dxf"].map(|n| dir.path().join(n));
        fs::create_dir(&folder).unwrap();
        fs::write(&drawing, "a drawing").unwrap();
        let path = folder.join("journal.jsonl");
        let mut journal = Journal::open(Arc::new(SystemDisk), &folder).unwrap();
        let note = |journal: &mut Journal| journal.append(Path::new("a.dxf"), "s", "c", TIME, &Step::Queued);
        note(&mut journal).unwrap();
        fs::remove_file(&path).unwrap();
        symlink(&drawing, &path).unwrap();
        let code = |error: Error| error.problem().unwrap().code;
        assert_eq!(code(note(&mut journal).unwrap_err()), "output-is-link");
        assert_eq!(code(Journal::open(Arc::new(SystemDisk), &folder).err().unwrap()), "output-is-link");
        fs::remove_file(&path).unwrap();
        fs::rename(&folder, &aside).unwrap();
        symlink(&aside, &folder).unwrap();
        assert_eq!(code(note(&mut journal).unwrap_err()), "output-is-link");
        assert_eq!(fs::read_dir(&aside).unwrap().count(), 0);
        assert_eq!(fs::read(&drawing).unwrap(), b"a drawing");
    }

    /// What a later program wrote is named and not obeyed, and stays where it is.
    #[test]
    fn unknown_events_are_named_and_not_obeyed() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.jsonl");
        let (a, b) = (Path::new("a.dxf"), Path::new("b.dxf"));
        let mut journal = Journal::open(Arc::new(SystemDisk), dir.path()).unwrap();
        journal.append(a, "s", "c", TIME, &Step::Finished(String::new())).unwrap();
        assert_eq!(journal.unread(), None);
        let mut text = fs::read_to_string(&path).unwrap();
        assert!(text.contains("\"v\":2"), "{text}");
        text.push_str(
            "{\"v\":2,\"event\":\"postponed\",\"drawing\":\"a.dxf\",\"sha256\":\"s\",\"config\":\"c\"}\n",
        );
        text.push_str(
            "{\"v\":3,\"event\":\"finished\",\"drawing\":\"b.dxf\",\"sha256\":\"s\",\"config\":\"c\"}\n",
        );
        // The first version had none.
        text.push_str("{\"event\":\"finished\",\"drawing\":\"old.dxf\",\"sha256\":\"s\",\"config\":\"c\"}\n");
        fs::write(&path, &text).unwrap();
        let journal = Journal::open(Arc::new(SystemDisk), dir.path()).unwrap();
        let said = journal.unread().unwrap();
        assert!(said.text.contains("postponed") && said.text.contains("version 3"), "{said}");
        assert!(journal.end_of(a, "s", "c").is_some() && journal.end_of(b, "s", "c").is_none());
        assert!(journal.end_of(Path::new("old.dxf"), "s", "c").is_some());
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
}
