//! What is said on standard output, and what to do where it takes nothing.

use std::io::Write;
use std::sync::OnceLock;

use enfilade_report::{Error, Place, one_line, short_numbers};

/// Why standard output did not take all that was said.
static UNSAID: OnceLock<String> = OnceLock::new();

/// The error of a standard output that takes nothing, but for a closed pipe, which is the reader's wish.
pub fn unsaid(why: &str) -> Error {
    let place = Place::file("standard output");
    Error::environment("standard-output", place, format!("{why}; what was to be said there is not whole"))
}

/// One line: line ends in names are shown, not obeyed.
pub fn say(line: &str) {
    print(&format!("{}\n", one_line(&short_numbers(line.trim_end_matches('\n')))));
}

/// Standard output may be a closed pipe: that is no reason to fail. Anything else is kept for the end.
pub fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    if let Err(e) = out.write_all(text.as_bytes()).and_then(|()| out.flush())
        && e.kind() != std::io::ErrorKind::BrokenPipe
    {
        let _ = UNSAID.set(e.to_string());
    }
}

/// The error of what was said and not taken; none where all was.
pub fn fault() -> Option<Error> {
    UNSAID.get().map(|why| unsaid(why))
}
