//! Values of options, as people type them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use enfilade_config::DEPTH_MAX;

/// A number of things.
pub(super) fn whole<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("found {text:?}, expected a whole number from 0"))
}

/// Levels of folders below a watched one.
pub(super) fn levels(text: &str) -> Result<usize, String> {
    let found = text.trim().parse().ok().filter(|n| *n <= DEPTH_MAX);
    found.ok_or_else(|| format!("found {text:?}, expected levels from 0 to {DEPTH_MAX}"))
}

/// A place.
pub(super) fn point(text: &str) -> Result<[f64; 2], String> {
    let number = |s: &str| s.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    text.split_once(',')
        .and_then(|(x, y)| Some([number(x)?, number(y)?]))
        .ok_or_else(|| format!("found {text:?}, expected X,Y"))
}

/// How far something counts.
pub(super) fn radius(text: &str) -> Result<f64, String> {
    let found =
        text.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0 && *v <= f64::from(u32::MAX));
    found.ok_or_else(|| format!("found {text:?}, expected a number from 0"))
}

/// Where a graph goes: the ending says how it is written.
pub(super) fn graph_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, &["graphml", "json"])
}

/// Where a picture goes.
pub(super) fn picture_file(text: &str) -> Result<PathBuf, String> {
    ending_in(text, &["png"])
}

/// Where JSON goes; a name without an ending, as of a pipe, promises no other format.
pub(super) fn json_file(text: &str) -> Result<PathBuf, String> {
    if Path::new(text).extension().is_none() { Ok(text.into()) } else { ending_in(text, &["json"]) }
}

/// A name whose ending says the format that is written: any other would promise what is not there.
fn ending_in(text: &str, endings: &[&str]) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_known = |e: &OsStr| endings.iter().any(|known| e.eq_ignore_ascii_case(known));
    if path.extension().is_some_and(is_known) {
        return Ok(path);
    }
    let listed: Vec<String> = endings.iter().map(|e| format!(".{e}")).collect();
    Err(format!("found {text:?}, expected a name that ends in {}", listed.join(" or ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_says_the_format() {
        for name in ["a.png", "a.PNG", "b/c.d.png"] {
            assert!(picture_file(name).is_ok(), "{name}");
        }
        for name in ["a.jpg", "a", ".png", "a.png.gz", "a.dxf", ""] {
            assert!(picture_file(name).is_err_and(|why| why.contains("ends in .png")), "{name}");
        }
        for (name, is_taken) in
            [("-", true), ("a.Json", true), ("a", true), ("a.yaml", false), ("a.csv", false)]
        {
            assert_eq!(json_file(name).is_ok(), is_taken, "{name}");
        }
        assert!(graph_file("g.json").is_ok() && graph_file("g.graphml").is_ok());
        assert!(graph_file("g.xml").is_err_and(|why| why.contains(".graphml or .json")));
    }

    #[test]
    fn a_radius_may_have_decimals() {
        assert_eq!(radius(" 2.5"), Ok(2.5));
        assert_eq!(radius("3"), Ok(3.0));
        for wrong in ["-1", "nan", "inf", "1e300", "far"] {
            assert!(radius(wrong).is_err_and(|why| why.contains("from 0")), "{wrong}");
        }
    }
}
