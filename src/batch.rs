//! Jobs for many machines: a drawing and its settings as one line of JSON, worked on anywhere, once.
//!
//! A job is content-addressed: its id is the SHA-256 of the program's version, the drawing's name and bytes
//! and the settings. The same id means the same result, so that it is done once wherever results are shared,
//! and may be done again anywhere without harm. A job makes a round, or measures a part of an analysis. Results lie in
//! `OUT/<id>/result/`, whole or not at all.

mod beside;
mod joined;
mod part;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::store::{Home, SystemDisk, led_to, read_named};
pub use beside::{FileBeside, Kind};
use enfilade_config::{Beside, Partial, Settings};
use enfilade_overlay::result::{RoundResult, to_json};
use enfilade_pipeline::Outcome;
use enfilade_report::{Error, OutFile, Place};
pub use part::{FinishedPart, PART_SCHEMA, PartOf};

/// `schema` of a [`Job`].
pub const JOB_SCHEMA: &str = "enfilade.job/1";
/// `schema` of a [`Finished`].
pub const FINISHED_SCHEMA: &str = "enfilade.job-result/1";
/// Most seeds that one command lists: a mistyped range is refused.
pub const SEEDS_MAX: usize = 100_000;
/// The folder of a job's results that appears whole.
const RESULT: &str = "result";
/// What a job leaves to be found by the next that asks for the same.
const FINISHED: &str = "job.json";

/// One job.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// [`JOB_SCHEMA`].
    pub schema: String,
    /// See `Job::id_of`.
    pub id: String,
    /// Where the drawing lies; only its name counts where `content` is given.
    pub drawing: PathBuf,
    /// SHA-256 of the drawing's bytes, lower-case hexadecimal.
    pub sha256: String,
    /// All settings, those of side-cars included, as in `enfilade.toml`.
    pub settings: Partial,
    /// Results go below this folder.
    pub out: PathBuf,
    /// The drawing's bytes in base64, where machines share no folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
    /// What lies beside a scene and is read with it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub beside: Vec<FileBeside>,
    /// Which part of an analysis it is; none: a round.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<PartOf>,
}

/// What a finished job says of itself: one line on standard output, and `job.json` among its results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finished {
    /// [`FINISHED_SCHEMA`].
    pub schema: String,
    /// Id of the job.
    pub id: String,
    /// Name of the drawing.
    pub drawing: String,
    /// Seed of the search.
    pub seed: u64,
    /// Storey, if one was named.
    pub storey: Option<String>,
    /// SHA-256 over names and bytes of all files of the result, the time taken left out: equal on every
    /// machine.
    pub digest: String,
    /// 0, or 1 where something was left out.
    pub exit_code: u8,
    /// Options found.
    pub options: usize,
    /// Layouts measured.
    pub evaluations: u64,
    /// Time taken.
    pub seconds: f64,
    /// Means of the present layout.
    pub initial: Value,
    /// Means of the first option; null where there is none.
    pub best: Value,
    /// The first option in plain words.
    pub words: String,
}

impl Job {
    /// A job on a drawing's bytes. What never decides the outcome is left out of its settings.
    ///
    /// # Errors
    /// [`Error::Usage`] for settings out of their ranges.
    pub fn new(
        drawing: &Path,
        bytes: &[u8],
        settings: Partial,
        out: &Path,
        embed: bool,
    ) -> Result<Self, Error> {
        Settings::new(settings.clone())?;
        let settings = settings.deciding();
        let mut job = Self {
            schema: JOB_SCHEMA.into(),
            id: String::new(),
            drawing: drawing.into(),
            sha256: sha256_hex(bytes),
            settings,
            out: out.into(),
            content: embed.then(|| BASE64.encode(bytes)),
            beside: Vec::new(),
            part: None,
        };
        job.id = job.id_of();
        Ok(job)
    }

    /// The job with what lies beside its drawing, which decides its result too.
    pub fn with_beside(mut self, beside: &Beside) -> Self {
        self.beside = beside::listed(beside, self.content.is_some());
        self.id = self.id_of();
        self
    }

    /// What lies beside the drawing: what the job carries, else `found` there, which must be what was meant.
    ///
    /// # Errors
    /// [`Error::Input`] where it is missing or is other.
    pub fn beside(&self, found: impl FnOnce() -> Beside) -> Result<Beside, Error> {
        let place = || Place::file(self.drawing.to_string_lossy());
        if self.content.is_some() {
            return beside::carried(&self.beside).map_err(|text| Error::input("job", place(), text));
        }
        let found = found();
        if beside::listed(&found, false) != self.beside {
            let text = "what lies beside it (an .ifc of its name, files of data, pictures) is not what was meant: it \
                        changed since the job was made; nothing was done";
            return Err(Error::input("drawing-changed", place(), text));
        }
        Ok(found)
    }

    /// Reads a job.
    ///
    /// # Errors
    /// [`Error::Input`] for anything but a job whose id belongs to it.
    pub fn from_json(text: &str) -> Result<Self, Error> {
        let bad = |text: String| Error::input("job", Place::file("job"), format!("{text}; nothing was done"));
        let job: Self = serde_json::from_str(text).map_err(|e| bad(e.to_string()))?;
        if job.schema != JOB_SCHEMA {
            return Err(bad(format!("found schema {:?}, expected {JOB_SCHEMA:?}", job.schema)));
        }
        if job.id != job.id_of() {
            let text = "its id does not belong to it: made by another version of the program, or changed";
            return Err(bad(text.into()));
        }
        Ok(job)
    }

    /// One line of JSON.
    ///
    /// # Errors
    /// [`Error::Environment`] where the drawing's path is no text.
    pub fn to_line(&self) -> Result<String, Error> {
        let mut value = serde_json::to_value(self)
            .map_err(|e| Error::environment("job", Place::default(), e.to_string()))?;
        value["settings"] = self.settings_said();
        Ok(value.to_string())
    }

    /// The settings that say something.
    fn settings_said(&self) -> Value {
        let mut value = serde_json::to_value(&self.settings).unwrap_or_default();
        if let Some(settings) = value.as_object_mut() {
            settings.retain(|_, v| !v.is_null() && v.as_array().is_none_or(|a| !a.is_empty()));
        }
        value
    }

    /// Lower-case hexadecimal SHA-256 of everything that decides the result.
    fn id_of(&self) -> String {
        // Values of JSON with preserved order: the fields stand as declared.
        let settings = self.settings_said().to_string();
        let name = self.name();
        let mut parts = vec![enfilade_config::VERSION, &name, &self.sha256, &settings];
        parts.extend(self.beside.iter().flat_map(|f| [f.kind.name(), &f.name, &f.sha256]));
        let part = self.part.as_ref().map(|part| serde_json::to_string(&part.deciding()).unwrap_or_default());
        parts.extend(part.as_deref());
        sha256_hex(parts.join("\n").as_bytes())
    }

    /// The drawing's name, which the results show.
    pub fn name(&self) -> String {
        self.drawing.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The drawing's bytes: those it carries, else those of the file, which must be the ones meant.
    ///
    /// # Errors
    /// [`Error::Input`] where they are missing or are others; [`Error::Environment`] where the file cannot be
    /// read now.
    pub fn bytes(&self) -> Result<Vec<u8>, Error> {
        let place = || Place::file(self.drawing.to_string_lossy());
        let bytes = match &self.content {
            Some(text) => BASE64
                .decode(text)
                .map_err(|e| Error::input("job", place(), format!("content is no base64: {e}")))?,
            None => read_named(&self.drawing).map_err(|e| match e.kind() {
                std::io::ErrorKind::NotFound => {
                    Error::input("no-such-file", place(), "there is no such file")
                }
                std::io::ErrorKind::InvalidInput => {
                    Error::input("no-file", place(), "found no file, or one too large, expected a drawing")
                }
                _ => Error::environment("unreadable", place(), format!("cannot be read: {e}")),
            })?,
        };
        if sha256_hex(&bytes) != self.sha256 {
            let text =
                "is not the drawing that was meant: it changed since the job was made; nothing was done";
            return Err(Error::input("drawing-changed", place(), text));
        }
        Ok(bytes)
    }

    /// The job's place among the results, held against other processes.
    ///
    /// # Errors
    /// `drawing-busy` while another process works on the same job; else from the disk.
    pub fn home(&self) -> Result<Home, Error> {
        Home::at(Arc::new(SystemDisk), &led_to(&self.out).join(&self.id))
    }

    /// What an earlier run of the same job left, if it did and every file is there as it was written.
    pub fn finished(&self, home: &Home) -> Option<Finished> {
        self.finished_in(&home.folder().join(RESULT))
    }

    fn finished_in(&self, folder: &Path) -> Option<Finished> {
        let text = fs::read(folder.join(FINISHED)).ok()?;
        let found: Finished = serde_json::from_slice(&text).ok()?;
        let is_whole = || digest_of(folder).is_some_and(|d| d == found.digest);
        (found.id == self.id && is_whole()).then_some(found)
    }

    /// Stores a finished job.
    ///
    /// # Errors
    /// From the disk.
    pub fn publish(&self, home: &Home, outcome: &Outcome<RoundResult>, seed: u64) -> Result<Finished, Error> {
        let r = &outcome.result;
        let first = r.candidates.first();
        let finished = Finished {
            schema: FINISHED_SCHEMA.into(),
            id: self.id.clone(),
            drawing: self.name(),
            seed,
            storey: self.settings.storey.clone(),
            digest: digest(&outcome.files, r)?,
            exit_code: u8::from(outcome.report.is_degraded()),
            options: r.candidates.len(),
            evaluations: r.evaluations,
            seconds: r.seconds,
            initial: json!(r.initial.mean),
            best: first.map_or(Value::Null, |c| json!(c.mean)),
            words: first.map_or_else(|| r.stopped_by.clone(), |c| c.words.clone()),
        };
        let mut files = outcome.files.clone();
        files.push(OutFile::new(FINISHED, to_json(&finished)?));
        home.publish_folder(RESULT, &files)?;
        Ok(finished)
    }
}

/// Digest of what lies in a job's result folder; `None` where it cannot be read or a link is planted.
fn digest_of(folder: &Path) -> Option<String> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).ok()? {
            let entry = entry.ok()?;
            let (kind, path) = (entry.file_type().ok()?, entry.path());
            if kind.is_dir() {
                folders.push(path);
            } else if kind.is_file() {
                let name = path.strip_prefix(folder).ok()?.to_path_buf();
                files.push(OutFile { bytes: fs::read(&path).ok()?, path: name });
            } else {
                return None;
            }
        }
    }
    files.retain(|f| f.path.as_os_str() != FINISHED);
    let result = files.iter().find(|f| f.path.as_os_str() == "result.json")?;
    let result: RoundResult = serde_json::from_slice(&result.bytes).ok()?;
    digest(&files, &result).ok()
}

/// Digest of a round that does not depend on the time it took.
fn digest(files: &[OutFile], result: &RoundResult) -> Result<String, Error> {
    let timeless = to_json(&RoundResult { seconds: 0.0, ..result.clone() })?;
    let mut lines: Vec<String> = files
        .iter()
        .map(|f| {
            let is_result = f.path.as_os_str() == "result.json";
            let bytes = if is_result { timeless.as_bytes() } else { &f.bytes };
            format!("{} {}", sha256_hex(bytes), f.path.display())
        })
        .collect();
    lines.sort();
    Ok(sha256_hex(lines.join("\n").as_bytes()))
}

/// Seeds of a list like `1..20` (both ends included), `7` or `1,5,8..10`.
///
/// # Errors
/// What was found and what is expected.
pub fn seeds(text: &str) -> Result<Vec<u64>, String> {
    let bad =
        |part: &str| format!("found {part:?}, expected seeds like 1..20 or 1,5,9 (at most {SEEDS_MAX})");
    let mut out = Vec::new();
    for part in text.split(',').map(str::trim) {
        let (first, last) = part.split_once("..").unwrap_or((part, part));
        let last = last.trim_start_matches('=');
        let (Ok(a), Ok(b)) = (first.trim().parse::<u64>(), last.trim().parse::<u64>()) else {
            return Err(bad(part));
        };
        if a > b || b - a >= (SEEDS_MAX - out.len()) as u64 {
            return Err(bad(part));
        }
        out.extend(a..=b);
    }
    Ok(out)
}

fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_ranges_and_lists() {
        assert_eq!(seeds("1..4"), Ok(vec![1, 2, 3, 4]));
        assert_eq!(seeds("7, 9..=10"), Ok(vec![7, 9, 10]));
        for bad in ["", "a", "4..1", "1..", "-1", "1...3", "0..18446744073709551615"] {
            assert!(seeds(bad).is_err(), "{bad:?}");
        }
        assert_eq!(seeds(&format!("1..{SEEDS_MAX}")).map(|s| s.len()), Ok(SEEDS_MAX));
        assert!(seeds(&format!("0..{SEEDS_MAX}")).is_err());
    }

    #[test]
    fn a_job_survives_its_line_and_its_id_follows_what_decides() {
        let partial = Partial { seed: Some(3), spacing: Some(0.5), ..Partial::default() };
        let job = |p: &Partial, bytes: &[u8], name: &str| {
            Job::new(Path::new(name), bytes, p.clone(), Path::new("out"), true).unwrap()
        };
        let one = job(&partial, b"abc", "x/plan.dxf");
        let back = Job::from_json(&one.to_line().unwrap()).unwrap();
        assert_eq!(back, one);
        assert_eq!(back.bytes().unwrap(), b"abc");
        let empty = job(&Partial { warm: Some(vec![]), ..partial.clone() }, b"abc", "plan.dxf");
        assert_eq!(Job::from_json(&empty.to_line().unwrap()).unwrap().id, empty.id);
        let same = Partial { threads: Some(2), out: Some("elsewhere".into()), ..partial.clone() };
        assert_eq!(job(&same, b"abc", "y/plan.dxf").id, one.id);
        let other = Partial { seed: Some(4), ..partial.clone() };
        let ids = [
            job(&other, b"abc", "plan.dxf"),
            job(&partial, b"abd", "plan.dxf"),
            job(&partial, b"abc", "p.dxf"),
        ];
        assert!(ids.iter().all(|j| j.id != one.id));
    }

    #[test]
    fn what_is_no_job_is_refused() {
        let job = Job::new(Path::new("p.dxf"), b"abc", Partial::default(), Path::new("out"), true).unwrap();
        let line = job.to_line().unwrap();
        for (from, to) in
            [("enfilade.job/1", "enfilade.job/2"), ("\"id\":\"", "\"id\":\"0"), ("\"out\"", "\"run\"")]
        {
            let error = Job::from_json(&line.replacen(from, to, 1)).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{error}");
        }
        let changed = Job { content: Some(BASE64.encode(b"abd")), ..job };
        assert_eq!(changed.bytes().unwrap_err().exit_code(), 2);
    }
}
