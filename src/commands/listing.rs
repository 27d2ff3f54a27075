//! Lists for many machines: what may be listed, and where a list goes.

use std::ops::RangeInclusive;
use std::path::Path;

use super::absolute;
use crate::batch::Job;
use crate::output::{print, say};
use crate::store::read_named;
use enfilade_report::{Error, Place, Report, counted};

/// Try again later: the exit code of `sysexits.h` that batch systems know.
pub(super) const TRY_AGAIN: u8 = 75;

/// Writes a list where it is wanted; says how many of what it has.
pub(super) fn hand_lines(to: Option<&Path>, lines: &str, of: Option<&str>) -> Result<(), Error> {
    let Some(to) = to.filter(|to| !super::is_standard_output(to)) else {
        print(lines);
        return Ok(());
    };
    super::write(to, lines.as_bytes())?;
    if let Some(of) = of {
        say(&format!("{}: {}", to.display(), counted(lines.lines().count() as u64, of)));
    }
    Ok(())
}

/// Files of other endings are listed only if they are drawings: a list of jobs is none.
pub(super) fn is_drawing(file: &Path, shown: &str, bytes: &[u8]) -> Result<(), Error> {
    let ending = file.extension().unwrap_or_default();
    if enfilade_cad::ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)) {
        return Ok(());
    }
    let read =
        enfilade_cad::read(shown, bytes, &enfilade_cad::ReadOptions::default(), &mut Report::default());
    read.map(drop).map_err(|_| {
        let text = format!(
            "is no drawing, found the ending {:?}, expected one of {}; nothing was done",
            ending.to_string_lossy(),
            enfilade_cad::ENDINGS.join(", ")
        );
        Error::input("no-drawing", Place::file(shown), text)
    })
}

/// A line of a list of jobs.
pub(super) struct ListedJob {
    /// From 1.
    pub line: usize,
    pub text: String,
    pub job: Job,
}

/// The jobs of a list, whose results lie `below` this folder where one is named; `code` says which list it should be.
///
/// # Errors
/// [`Error::Input`] for a list that cannot be read, and for a line that is no job.
pub(super) fn jobs_in(
    list: &Path,
    below: Option<&Path>,
    code: &'static str,
) -> Result<Vec<ListedJob>, Error> {
    let refused = |text: String| Error::input(code, Place::file(list.to_string_lossy()), text);
    let bytes = read_named(list).map_err(|e| refused(format!("cannot be read: {e}; nothing was done")))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| refused("is no text, expected one job a line; nothing was done".into()))?;
    let lines = text.lines().enumerate().filter(|(_, text)| !text.trim().is_empty());
    let listed = |(line, text): (usize, &str)| {
        let mut job = Job::from_json(text).map_err(|e| refused(format!("line {}: {e}", line + 1)))?;
        if let Some(below) = below {
            job.out = absolute(below);
        }
        Ok(ListedJob { line: line + 1, text: text.into(), job })
    };
    let found = lines.map(listed).collect::<Result<Vec<_>, Error>>()?;
    if found.is_empty() {
        return Err(refused("has no job in it, expected one a line; nothing was done".into()));
    }
    Ok(found)
}

/// `3, 7 to 9`, of ascending numbers.
pub(super) fn numbers(all: &[u32]) -> String {
    let mut runs: Vec<RangeInclusive<u32>> = Vec::new();
    for &n in all {
        match runs.last_mut() {
            Some(last) if *last.end() + 1 == n => *last = *last.start()..=n,
            _ => runs.push(n..=n),
        }
    }
    let words = runs.iter().map(|r| match (r.start(), r.end()) {
        (a, b) if a == b => a.to_string(),
        (a, b) if a + 1 == *b => format!("{a}, {b}"),
        (a, b) => format!("{a} to {b}"),
    });
    words.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    #[test]
    fn numbers_are_said_in_runs() {
        let said = |all: &[u32]| super::numbers(all);
        assert_eq!(said(&[3, 7, 8, 9, 12, 13]), "3, 7 to 9, 12, 13");
        assert_eq!(said(&[1]), "1");
    }
}
