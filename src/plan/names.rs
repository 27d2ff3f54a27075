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
pub struct Pattern {
    glob: GlobMatcher,
    letters: Letters,
}

impl Pattern {
    /// Reads a pattern; `\` takes what follows it to the letter.
    ///
    /// # Errors
    /// Where it is none, as `[`.
    pub fn new(glob: &str) -> Result<Self, Error> {
        let glob = folded(glob);
        let letters = Letters::of(&glob);
        let built = GlobBuilder::new(&letters.plain(&glob)).backslash_escape(true).build()?;
        Ok(Self { glob: built.compile_matcher(), letters })
    }

    /// Whether a name fits.
    pub fn is_match(&self, name: &str) -> bool {
        self.glob.is_match(self.letters.plain(&folded(name)))
    }
}

/// Letters of a pattern beyond ASCII, by code point: globs count bytes, and `?` is one letter.
#[derive(Clone, Debug)]
struct Letters(Vec<char>);

/// What stands for letters beyond ASCII: one each for those of the pattern, one for all others. No name has any of them.
const STAND_INS: usize = 31;
const OTHER: char = '\u{7f}';

impl Letters {
    fn of(pattern: &str) -> Self {
        let mut letters: Vec<char> = pattern.chars().filter(|c| !c.is_ascii()).collect();
        letters.sort_unstable();
        letters.dedup();
        Self(letters)
    }

    /// A text in which every letter is one byte; as it is where the pattern has more letters than there are stand-ins.
    fn plain(&self, text: &str) -> String {
        if self.0.len() > STAND_INS {
            return text.to_string();
        }
        let stand_in = |c: char| match self.0.binary_search(&c) {
            _ if c.is_ascii() => c,
            Ok(at) => char::from(at as u8 + 1),
            Err(_) => OTHER,
        };
        text.chars().map(stand_in).collect()
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
        let many: String = (0..40).filter_map(|i| char::from_u32('а' as u32 + i)).collect();
        assert!(Pattern::new(&format!("{many}*")).unwrap().is_match(&format!("{many} 1")));
        assert!(
            !Pattern::new("s?d").unwrap().is_match("suüd") && Pattern::new("s?d").unwrap().is_match("SÜD")
        );
        assert!(!Pattern::new("süd").unwrap().is_match("söd"));
        assert!(!Pattern::new("kuche*").unwrap().is_match(composed));
        assert!(Pattern::new("[").is_err());
    }
}
