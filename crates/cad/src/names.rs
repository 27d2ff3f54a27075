//! Names as people type them: the same whatever their case, their blanks and how their accents are stored.

use globset::{Error, GlobBuilder, GlobMatcher};
use unicode_normalization::UnicodeNormalization;
use unicode_normalization::char::is_combining_mark;

/// A name in the one form in which names are held against each other: accents joined to their letters (a Mac writes them
/// apart), lower case, one blank where there are several, none at the ends.
pub fn folded(name: &str) -> String {
    let lower = name.nfc().collect::<String>().to_lowercase();
    lower.nfc().collect::<String>().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Letters that no accent makes of plain ones, and how they are typed without them.
const PLAIN: [(char, &str); 9] = [
    ('ß', "ss"),
    ('æ', "ae"),
    ('œ', "oe"),
    ('ø', "o"),
    ('ł', "l"),
    ('đ', "d"),
    ('ð', "d"),
    ('þ', "th"),
    ('ı', "i"),
];

/// A name as somebody types it who has neither its accents nor its blanks at hand: `Erdgeschoß 1` is `erdgeschoss1`.
/// Names that differ may be one in this form, see [`Found`].
pub fn bare(name: &str) -> String {
    let letters =
        folded(name).nfkd().filter(|c| !is_combining_mark(*c) && !c.is_whitespace()).collect::<Vec<_>>();
    let mut out = String::with_capacity(name.len());
    for letter in letters.into_iter().flat_map(char::to_lowercase) {
        match PLAIN.iter().find(|(from, _)| *from == letter) {
            Some((_, to)) => out.push_str(to),
            None => out.push(letter),
        }
    }
    out
}

/// Which names somebody means: those that are the same as [`folded`], else those that are the same [`bare`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Places of the names that are meant.
    pub hits: Vec<usize>,
    /// Whether they are the same but for accents and blanks only.
    pub is_bare: bool,
    /// Different names that are one without accents and blanks: none of them is meant.
    pub rivals: Vec<String>,
}

impl Found {
    /// Looks for names; each of `all` is one thing with all that it is called.
    pub fn of(all: &[Vec<&str>], pattern: &Pattern) -> Self {
        let fits = |fits: &dyn Fn(&str) -> bool| -> Vec<(usize, String)> {
            let first =
                |(i, names): (usize, &Vec<&str>)| Some((i, (*names.iter().find(|n| fits(n))?).to_string()));
            all.iter().enumerate().filter_map(first).collect()
        };
        let same = fits(&|n| pattern.is_match(n));
        if !same.is_empty() {
            return Self { hits: same.into_iter().map(|f| f.0).collect(), ..Self::default() };
        }
        let alike = fits(&|n| pattern.is_bare_match(n));
        let mut rivals: Vec<String> = Vec::new();
        for (_, name) in &alike {
            if rivals.iter().all(|r| folded(r) != folded(name)) {
                rivals.push(name.clone());
            }
        }
        if rivals.len() > 1 && !pattern.is_many {
            return Self { rivals, ..Self::default() };
        }
        Self {
            is_bare: !alike.is_empty(),
            hits: alike.into_iter().map(|f| f.0).collect(),
            rivals: Vec::new(),
        }
    }
}

/// Names with `*` and `?` in them.
#[derive(Clone, Debug)]
pub struct Pattern {
    glob: GlobMatcher,
    letters: Letters,
    bare: Option<(GlobMatcher, Letters)>,
    /// Whether it may mean several names.
    is_many: bool,
}

impl Pattern {
    /// Reads a pattern; `\` takes what follows it to the letter.
    ///
    /// # Errors
    /// Where it is none, as `[`.
    pub fn new(glob: &str) -> Result<Self, Error> {
        let (given, glob) = (glob, folded(glob));
        let (is_many, bare) = (glob.contains(['*', '?', '[', '{']), matcher(&bare(given)).ok());
        let (glob, letters) = matcher(&glob)?;
        Ok(Self { glob, letters, bare, is_many })
    }

    /// The pattern that only this name fits.
    ///
    /// # Errors
    /// Never: every sign of a pattern is escaped.
    pub fn name(name: &str) -> Result<Self, Error> {
        Ok(Self { is_many: false, ..Self::new(&globset::escape(name))? })
    }

    /// Whether a name fits but for accents and blanks.
    fn is_bare_match(&self, name: &str) -> bool {
        self.bare.as_ref().is_some_and(|(glob, letters)| glob.is_match(letters.plain(&bare(name))))
    }

    /// Whether a name fits.
    pub fn is_match(&self, name: &str) -> bool {
        self.glob.is_match(self.letters.plain(&folded(name)))
    }
}

/// The matcher of a pattern in one form of names, and its letters.
fn matcher(glob: &str) -> Result<(GlobMatcher, Letters), Error> {
    let letters = Letters::of(glob);
    let built = GlobBuilder::new(&letters.plain(glob)).backslash_escape(true).build()?;
    Ok((built.compile_matcher(), letters))
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

/// The layer's name without the prefix of a bound (`xref$0$A-WALL`) or attached (`xref|A-WALL`)
/// external reference.
pub fn base_name(layer: &str) -> &str {
    let after_bar = layer.rsplit('|').next().unwrap_or(layer);
    match after_bar.rmatch_indices('$').next() {
        Some((i, _)) if after_bar[..i].contains('$') => &after_bar[i + 1..],
        _ => after_bar,
    }
}

/// The class alone of a layer that readers of buildings make: `IfcWall` of `IfcWall (window at knee height)`.
pub(super) fn class_name(layer: &str) -> &str {
    if layer.starts_with("Ifc") { layer.split(" (").next().unwrap_or(layer) } else { layer }
}

/// The words of a layer's name, lower case: runs of letters, parted where capitals begin.
pub fn words(name: &str) -> Vec<String> {
    let mut out = vec![String::new()];
    let mut last_lower = false;
    for c in name.chars() {
        if !c.is_alphabetic() {
            out.push(String::new());
        } else {
            if c.is_uppercase() && last_lower {
                out.push(String::new());
            }
            if let Some(word) = out.last_mut() {
                word.extend(c.to_lowercase());
            }
        }
        last_lower = c.is_lowercase();
    }
    out.retain(|w| !w.is_empty());
    out
}

/// Whether a word of a name is a listed one, both lower case. One that begins with `*` may end a longer word, and one of a
/// script that writes without blanks may stand anywhere in one.
pub fn is_word(word: &str, listed: &str) -> bool {
    match listed.strip_prefix('*') {
        Some(end) => word.ends_with(end),
        None => word == listed || (is_joined(listed) && word.contains(listed)),
    }
}

/// Words of what lies in the open air, lower case; those that begin with `*` may end a longer word.
const OUTDOORS: &str = "terrace terraces *terrasse terrasses *terrassen terraza terrazas terrazza terrazze terraco terraço \
                        terras taras balcony balconies *balkon balkone balkons balcon balcons balcones balcone balconi \
                        varanda varandas patio patios courtyard courtyards innenhof hof cour cortile garden gardens \
                        gardening lawn rasen wiese *garten jardin jardín giardino porch porches yard テラス バルコニー 庭 阳台 露台 \
                        терраса балкон";

/// Whether a name, of a layer or an element, says that it lies in the open air.
pub fn is_outdoors(name: &str) -> bool {
    let is_in_house = |word: &String| INDOORS.contains(&word.as_str());
    let says =
        |word: &String| OUTDOORS.split_whitespace().any(|known| is_word(word, known)) && !is_in_house(word);
    words(base_name(name)).iter().any(says)
}

/// Words that end as one of them does, and name what lies in a house.
const INDOORS: [&str; 2] = ["kindergarten", "wintergarten"];

/// Whether others join on to a word without a blank: Han characters, and kana or Hangul from two letters on.
pub fn is_joined(word: &str) -> bool {
    let is_han = |c: char| ('\u{4e00}'..='\u{9fff}').contains(&c);
    let is_syllable =
        |c: char| ('\u{3040}'..='\u{30ff}').contains(&c) || ('\u{ac00}'..='\u{d7a3}').contains(&c);
    word.chars().all(|c| is_han(c) || is_syllable(c))
        && (word.chars().any(is_han) || word.chars().nth(1).is_some())
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

    #[test]
    fn names_without_accents_and_blanks_are_found_where_none_is_the_same() {
        for (typed, name) in [
            ("gallerywest", "Gallery West"),
            ("erdgeschoss1", "Erdgeschoß  1"),
            ("ERDGESCHOß1", "Erdgeschoss 1"),
            ("buro", "Bu\u{308}ro"),
            ("SMORREBROD", "Smørrebrød"),
            ("etage2", "Étage\u{a0}２"),
        ] {
            assert_eq!(bare(typed), bare(name));
        }
        let found = |all: &[&str], typed: &str| {
            let all: Vec<Vec<&str>> = all.iter().map(|n| vec![*n]).collect();
            let found = Found::of(&all, &Pattern::new(typed).unwrap());
            (found.hits, found.rivals)
        };
        let none = Vec::<String>::new;
        assert_eq!(found(&["Büro", "Buro", "BÜRO"], "büro"), (vec![0, 2], none()));
        assert_eq!(found(&["Büro", "Buro"], "buro"), (vec![1], none()), "the same before the like");
        assert_eq!(found(&["Büro", "Flur"], "BURO"), (vec![0], none()));
        assert_eq!(found(&["Büro", "Burô"], "buro"), (vec![], vec!["Büro".into(), "Burô".into()]));
        assert_eq!(found(&["Büro 1", "Büro 2", "Flur"], "buro*"), (vec![0, 1], none()));
        assert_eq!(found(&["Büro", "Flur"], "bureau"), (vec![], none()));
        let (all, pattern) = (vec![vec!["101", "Büro"], vec!["102", "büro"]], Pattern::new("buro").unwrap());
        assert_eq!(Found::of(&all, &pattern).hits, [0, 1], "one name of two rooms");
        assert!(Pattern::name("a*[1]").unwrap().is_match("A*[1]"));
        assert!(!Pattern::name("a*").unwrap().is_match("ab"));
    }

    #[test]
    fn what_lies_in_the_open_air_is_known_by_its_name() {
        for name in [
            "Terrace",
            "A-BALKON",
            "Dachterrasse",
            "x$0$PATIO",
            "BALCONI",
            "Garten",
            "Gardening Area",
            "Rasen",
            "阳台",
        ] {
            assert!(is_outdoors(name), "{name}");
        }
        for name in
            ["Walls", "Kindergarten", "Wintergarten", "Decke", "Entrance", "Hofmann", "Yardstick", "0"]
        {
            assert!(!is_outdoors(name), "{name}");
        }
    }
}
