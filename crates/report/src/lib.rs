//! What went wrong or was assumed, and where.
//!
//! Odd input never stops the program: it becomes a [`Problem`] with a [`Place`], the best reading
//! goes on, and the [`Report`] is shown beside the result. Only a job that cannot go on at all
//! returns an [`Error`]. These are the only error types of the house.
//!
//! ```
//! use enfilade_report::{Place, Report};
//!
//! let mut report = Report::default();
//! let wall = Place::line("plan.dxf", 1842).entity("LINE 2F3 layer A-WALL");
//! report.warn("dxf-bad-number", wall, "length is `12,5`, expected a number; the wall was left out");
//! assert!(report.is_degraded());
//! let said = report.problems[0].to_string();
//! assert!(said.starts_with("plan.dxf:1842 LINE 2F3 layer A-WALL: length is"), "{said}");
//! ```

use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::Duration;

use serde::{Serialize, Serializer};

/// Text of foreign origin for a terminal, a log or a page: control characters, and those that turn the direction of
/// writing, are shown as what they are (`\u{1b}`) instead of being obeyed. Line ends and tabs stay.
pub fn printable(text: &str) -> String {
    let is_harmless = |c: char| matches!(c, '\n' | '\t') || !is_obeyed(c);
    text.chars()
        .map(|c| if is_harmless(c) { c.to_string() } else { c.escape_default().to_string() })
        .collect()
}

/// One line on standard error. Where that takes nothing, the command goes on.
pub fn complain(line: impl fmt::Display) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Numbers with more digits than anybody reads, in short: `1.000e308`. A slip of the pen in a drawing has up to 309.
pub fn short_numbers(text: &str) -> Cow<'_, str> {
    const DIGITS_MAX: usize = 20;
    let digits = |s: &str| s.bytes().take_while(u8::is_ascii_digit).count();
    let mut out = String::new();
    let (mut done, mut at) = (0, 0);
    while let Some(next) = text[at..].find(|c: char| c.is_ascii_digit()) {
        let from = at + next;
        let whole = digits(&text[from..]);
        let point = usize::from(text[from + whole..].starts_with('.'));
        let parts = digits(text.get(from + whole + point..).unwrap_or_default());
        let end = from + whole + if parts > 0 { point + parts } else { 0 };
        if whole.max(parts) > DIGITS_MAX
            && let Ok(number) = text[from..end].parse::<f64>()
        {
            out.push_str(&text[done..from]);
            out.push_str(&format!("{number:.3e}"));
            done = end;
        }
        at = end;
    }
    if done == 0 {
        return Cow::Borrowed(text);
    }
    Cow::Owned(out + &text[done..])
}

/// A number of things in words: `1 layout`, `2 layouts`.
pub fn counted(n: u64, one: &str) -> String {
    if n == 1 { format!("1 {one}") } else { format!("{n} {one}s") }
}

/// As [`printable`], with line ends and tabs shown too: a name that tries to look like more lines does not.
pub fn one_line(text: &str) -> String {
    text.chars().map(|c| if is_obeyed(c) { c.escape_default().to_string() } else { c.to_string() }).collect()
}

/// Whether a terminal does something other than showing the character.
fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Where in which file something was found: `plan.dxf:1842 LWPOLYLINE 2F3 layer A-WALL`.
///
/// Every part may be missing; the file is a name to show, not a path to open.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// File name as shown to the user; empty when the whole run is meant.
    pub file: String,
    /// Line of the file, counted from 1.
    pub line: Option<usize>,
    /// The entity in the words of its format: `LWPOLYLINE 2F3 layer A-WALL`.
    pub entity: String,
}

impl Place {
    /// The whole file.
    pub fn file(file: impl Into<String>) -> Self {
        Self { file: file.into(), ..Self::default() }
    }

    /// One line of a file.
    pub fn line(file: impl Into<String>, line: usize) -> Self {
        Self { file: file.into(), line: Some(line), entity: String::new() }
    }

    /// The same place, naming an entity.
    pub fn entity(mut self, entity: impl Into<String>) -> Self {
        self.entity = entity.into();
        self
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&one_line(&self.file))?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.entity.is_empty() {
            let gap = if self.file.is_empty() { "" } else { " " };
            write!(f, "{gap}{}", one_line(&self.entity))?;
        }
        Ok(())
    }
}

/// How much a [`Problem`] matters to the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// An assumption or a decision worth stating; nothing was left out.
    Info,
    /// Something was left out or read differently than drawn; exit code 1.
    Warning,
    /// The job could not go on.
    Error,
}

/// One finding: what was found, what was expected, what was done about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Stable identifier, kebab-case: `unit-assumed`, `dxf-bad-number`.
    pub code: &'static str,
    /// How much it matters.
    pub severity: Severity,
    /// Where it was found.
    pub place: Place,
    /// `…, found …, expected …; what we did`.
    pub text: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place.to_string();
        let text = printable(&short_numbers(&self.text));
        if place.is_empty() { f.write_str(&text) } else { write!(f, "{place}: {text}") }
    }
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut out = serializer.serialize_struct("Problem", 4)?;
        out.serialize_field("code", self.code)?;
        out.serialize_field("severity", &self.severity)?;
        out.serialize_field("place", &self.place.to_string())?;
        out.serialize_field("text", &*short_numbers(&self.text))?;
        out.end()
    }
}

/// The findings of one job, in the order they were made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// All findings so far.
    pub problems: Vec<Problem>,
}

impl Report {
    /// Adds one finding. The same code at the same place with the same text is kept once.
    pub fn add(&mut self, code: &'static str, severity: Severity, place: Place, text: impl Into<String>) {
        let problem = Problem { code, severity, place, text: text.into() };
        if !self.problems.contains(&problem) {
            self.problems.push(problem);
        }
    }

    /// An assumption or decision.
    pub fn info(&mut self, code: &'static str, place: Place, text: impl Into<String>) {
        self.add(code, Severity::Info, place, text);
    }

    /// Something left out.
    pub fn warn(&mut self, code: &'static str, place: Place, text: impl Into<String>) {
        self.add(code, Severity::Warning, place, text);
    }

    /// Appends all findings of another report.
    pub fn extend(&mut self, other: Report) {
        for p in other.problems {
            self.add(p.code, p.severity, p.place, p.text);
        }
    }

    /// Whether something was left out: the job ends with exit code 1.
    pub fn is_degraded(&self) -> bool {
        self.problems.iter().any(|p| p.severity >= Severity::Warning)
    }
}

/// Findings alike that are shown one by one; the others are gathered behind the last of them.
pub const SHOWN_ALIKE: usize = 3;

/// What to show of many findings: each that is shown, and behind the last of its kind those that are
/// not, in their order. Findings are alike where `kind` says the same of them.
pub fn gathered<'a, T, K: Eq + std::hash::Hash>(
    findings: impl IntoIterator<Item = &'a T>,
    kind: impl Fn(&'a T) -> K,
) -> Vec<(&'a T, Vec<&'a T>)> {
    let mut out: Vec<(&T, Vec<&T>)> = vec![];
    let mut seen: HashMap<K, (usize, usize)> = HashMap::new();
    for finding in findings {
        let (count, last) = seen.entry(kind(finding)).or_default();
        *count += 1;
        if *count > SHOWN_ALIKE {
            out[*last].1.push(finding);
        } else {
            *last = out.len();
            out.push((finding, vec![]));
        }
    }
    out
}

/// Codes of what a limit of time or memory ended: another limit may do, with the same drawing.
pub const LIMITS: [&str; 3] = ["reading-too-long", "job-too-long", "job-out-of-memory"];

/// Why a job cannot go on. The variant decides the exit code.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Error {
    /// The drawing cannot be used (exit code 2), or took more than a limit of time or memory (5).
    #[error("{0}")]
    Input(Problem),
    /// Wrong options or configuration (exit code 3).
    #[error("{0}")]
    Usage(Problem),
    /// Disk, permission or device failed (exit code 4).
    #[error("{0}")]
    Environment(Problem),
    /// The user, or a newer save, stopped the job (exit code 130).
    #[error("stopped")]
    Stopped,
}

impl Error {
    /// A drawing that cannot be used.
    pub fn input(code: &'static str, place: Place, text: impl Into<String>) -> Self {
        Self::Input(Problem { code, severity: Severity::Error, place, text: text.into() })
    }

    /// Wrong options or configuration.
    pub fn usage(code: &'static str, place: Place, text: impl Into<String>) -> Self {
        Self::Usage(Problem { code, severity: Severity::Error, place, text: text.into() })
    }

    /// A failing environment.
    pub fn environment(code: &'static str, place: Place, text: impl Into<String>) -> Self {
        Self::Environment(Problem { code, severity: Severity::Error, place, text: text.into() })
    }

    /// The problem carried, if any.
    pub fn problem(&self) -> Option<&Problem> {
        match self {
            Self::Input(p) | Self::Usage(p) | Self::Environment(p) => Some(p),
            Self::Stopped => None,
        }
    }

    /// Process exit code (`0` and `1` belong to finished jobs).
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Input(p) if LIMITS.contains(&p.code) => 5,
            Self::Input(_) => 2,
            Self::Usage(_) => 3,
            Self::Environment(_) => 4,
            Self::Stopped => 130,
        }
    }
}

/// How long one who stops a search waits for the best that it found so far.
pub const KEEP_GRACE: Duration = Duration::from_secs(60);

/// A request to stop, shared between the one who asks and the one who works.
///
/// Long loops look at it at least every 50 ms.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicU8>, Option<Arc<AtomicU8>>);

impl Cancel {
    const KEEP: u8 = 1;
    const STOP: u8 = 2;

    /// Asks to stop at once; cannot be taken back.
    pub fn stop(&self) {
        self.0.fetch_max(Self::STOP, Ordering::Relaxed);
    }

    /// Asks to stop, and for the best that was found so far; [`Self::stop`] may follow.
    pub fn stop_keeping(&self) {
        self.0.fetch_max(Self::KEEP, Ordering::Relaxed);
    }

    fn asked(&self) -> u8 {
        let of = |asked: &Arc<AtomicU8>| asked.load(Ordering::Relaxed);
        of(&self.0).max(self.1.as_ref().map_or(0, of))
    }

    /// Whether somebody asked to stop.
    pub fn is_stopped(&self) -> bool {
        self.asked() > 0
    }

    /// Whether who asked to stop waits for the best that was found so far.
    pub fn keeps_best(&self) -> bool {
        self.asked() == Self::KEEP
    }

    /// A request that is made when either of the two is; to stop it stops `self` alone.
    pub fn also(&self, other: &Cancel) -> Self {
        Self(self.0.clone(), Some(other.0.clone()))
    }

    /// [`Error::Stopped`] when somebody asked to stop.
    pub fn check(&self) -> Result<(), Error> {
        if self.is_stopped() { Err(Error::Stopped) } else { Ok(()) }
    }
}

/// A file that a job hands out, to be written by whoever runs the job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutFile {
    /// Relative to the folder the job's results go to.
    pub path: PathBuf,
    /// Its whole content.
    pub bytes: Vec<u8>,
}

impl OutFile {
    /// A file of that name.
    pub fn new(path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { path: path.into(), bytes: bytes.into() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nobody_reads_309_digits() {
        let far = format!("lies at {}, {}; 2 walls", 1e308, -12.5);
        assert_eq!(short_numbers(&far), "lies at 1.000e308, -12.5; 2 walls");
        assert_eq!(short_numbers(&format!("{}…{}", -1e300, 1.5e-300)), "-1.000e300…1.500e-300");
        for text in
            ["", "no number", "plan-2026.dxf:1842", "12345678901234567890", "3.", "0.1234567890123456", "é7"]
        {
            assert_eq!(short_numbers(text), text);
        }
        let problem = Problem { code: "c", severity: Severity::Info, place: Place::default(), text: far };
        assert!(problem.to_string().len() < 60 && serde_json::to_string(&problem).unwrap().len() < 140);
    }

    #[test]
    fn one_is_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "layout")), ["0 layouts", "1 layout", "2 layouts"]);
    }

    #[test]
    fn many_findings_alike_are_gathered_behind_the_third() {
        let mut report = Report::default();
        for line in 1..=6 {
            report.info("stale", Place::line("plan.dxf", line), "is tied");
            report.info("stale", Place::line("plan.dxf", 10 * line), format!("is other {line}"));
        }
        let shown = gathered(&report.problems, |p| (p.code, &p.text));
        assert_eq!(shown.len(), 6 + SHOWN_ALIKE);
        let lines = |found: &[&Problem]| found.iter().map(|p| p.place.line).collect::<Vec<_>>();
        let behind: Vec<_> = shown.iter().filter(|(_, others)| !others.is_empty()).collect();
        assert_eq!(behind.len(), 1);
        assert_eq!((behind[0].0.place.line, lines(&behind[0].1)), (Some(3), vec![Some(4), Some(5), Some(6)]));
    }
}
