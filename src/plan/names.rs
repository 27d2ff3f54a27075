//! Names as people type them: the same whatever their case, their blanks and how their accents are stored.

use globset::{Error, GlobBuilder, GlobMatcher};
use unicode_normalization::UnicodeNormalization;

/// A name in the one form in which names are held against each other: accents joined to their letters (a Mac writes them
/// apart), lower case, one blank where there are several, none at the ends.
pub fn folded(name: &str) -> String {
    let lower = name.nfc().collect::<String>().to_lowercase();
    lower.nfc().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Names with `*` and `?` in them.
#[derive(Clone, Debug)]
pub struct Pattern(GlobMatcher);

impl Pattern {
    /// Reads a pattern; `\` takes what follows it to the letter.
    ///
    /// # Errors
    /// Where it is none, as `[`.
    pub fn new(glob: &str) -> Result<Self, Error> {
        let built = GlobBuilder::new(&folded(glob)).backslash_escape(true).build()?;
        Ok(Self(built.compile_matcher()))
    }

    /// Whether a name fits.
    pub fn is_match(&self, name: &str) -> bool {
        self.0.is_match(folded(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_one_however_they_are_typed() {
        let (composed, apart) = ("Küche Süd", "Ku\u{308}che  Su\u{308}d ");
        assert_ne!(composed, apart);
        assert_eq!(folded(composed), folded(apart));
        assert_eq!(folded(" ÉTAGE\u{a0}1\t"), "étage 1");
        for (pattern, name) in [
            ("KÜCHE*", apart),
            ("ku\u{308}che s?d", composed),
            (" küche   süd ", composed),
            ("*ОФИС*", "офис 12"),
            (r"raum \[1\]", "Raum [1]"),
        ] {
            assert!(Pattern::new(pattern).unwrap().is_match(name), "{pattern} {name}");
        }
        assert!(!Pattern::new("kuche*").unwrap().is_match(composed));
        assert!(Pattern::new("[").is_err());
    }
}
