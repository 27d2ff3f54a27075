//! Lists for many machines: what may be listed, and where a list goes.

use std::path::Path;

use crate::output::{print, say};
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
