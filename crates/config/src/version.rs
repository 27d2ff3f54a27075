//! The versions of the program and of its settings files.

use enfilade_report::{Error, Place};

/// Version of the program, with the commit that it was built from where that is known: `0.1.0 (1f2e3d4c5)`. Builds for
/// tests leave the commit out, or each commit would build everything anew.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("ENFILADE_COMMIT_SUFFIX"));

/// Version of the settings files that are written.
pub const SETTINGS_VERSION: u64 = 1;

/// What a later program wrote is not half understood, whatever else stands there.
pub(super) fn is_known(name: &str, text: &str) -> Result<(), Error> {
    let table: Option<toml::Table> = text.parse().ok();
    let found = table.and_then(|t| t.get("version").cloned());
    match found.as_ref().map(|v| v.as_integer()) {
        None => Ok(()),
        Some(Some(v)) if (1..=SETTINGS_VERSION as i64).contains(&v) => Ok(()),
        _ => {
            let text = format!(
                "version: found {}, expected {SETTINGS_VERSION} or none: a later enfilade wrote this file; nothing of \
                 it was used",
                found.map_or_else(String::new, |v| v.to_string())
            );
            Err(Error::usage("settings-version", Place::file(name), text))
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::Partial;

    /// Settings of a later program are not half understood.
    #[test]
    fn settings_of_a_later_version_are_refused() {
        let read = |text: &str| Partial::from_toml("a.enfilade.toml", text);
        assert_eq!(read("version = 1\nseed = 2\n").unwrap(), read("seed = 2\n").unwrap());
        for text in ["version = 2\nnew-key = 1\n", "version = 0\n", "version = \"x\"\n"] {
            let error = read(text).unwrap_err();
            assert_eq!(error.problem().unwrap().code, "settings-version", "{error}");
        }
    }
}
