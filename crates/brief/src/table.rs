//! The one table of measures: whatever is said of a measure anywhere is said here.

mod isovist;
mod sight;
mod ways;
mod whole;

use super::{Growth, Heading, Measure, Sense, Source};

/// How something that is measured is named to an architect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wording {
    /// Name in settings and in result.json.
    pub key: &'static str,
    /// In plain words.
    pub plain: &'static str,
    /// The technical term.
    pub technical: &'static str,
    /// What one unit of it is.
    pub unit: &'static str,
    /// One sentence for the glossary.
    pub meaning: &'static str,
    /// What more of it means, and less, in two or three words; empty where nothing can be said.
    pub more_less: [&'static str; 2],
}

impl Wording {
    /// The unit without what its values are of: `m²` of `m² seen`.
    pub fn bare_unit(&self) -> &'static str {
        self.unit.trim_end_matches(" seen")
    }
}

/// One measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Which one.
    pub measure: Measure,
    /// Its name, unit and meaning.
    pub words: Wording,
    /// Which way is better as a rule; `None` if that depends on the brief.
    pub better: Option<Sense>,
    /// The formula, with the signs of `docs/measures.md`.
    pub definition: &'static str,
    /// Who defined it, as `docs/measures.md` lists its sources.
    pub origin: &'static str,
    /// What it is computed from, and so what it costs.
    pub source: Source,
    /// How it grows as cells become smaller.
    pub growth: Growth,
}

/// A measure and its column in the table of cells. Some columns are no measure to ask for, and what is of the layout
/// as a whole has no column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// In the table of cells, if it stands there.
    pub column: Option<Heading>,
    /// In settings and results, if it can be asked for.
    pub measure: Option<Entry>,
}

impl Row {
    /// A column that is no measure to ask for.
    const fn column(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self { column: Some(Heading { name, unit, meaning }), measure: None }
    }
}

/// Every row, by families in the order of their columns: sight and the views it takes, the polygon seen, walking and
/// turning, the region of reference and the layout as a whole.
pub const TABLE: [&[Row]; 4] = [sight::ROWS, isovist::ROWS, ways::ROWS, whole::ROWS];

/// How many measures there are.
const MEASURES: usize = Measure::Penalty as usize + 1;

/// By measure, in the order of [`Measure`]. A measure without a row, or with two, does not compile.
pub(super) const ENTRIES: [&Entry; MEASURES] = by_measure();

const fn by_measure() -> [&'static Entry; MEASURES] {
    let Some(first) = &TABLE[0][0].measure else { panic!("the first row is of a measure") };
    let (mut out, mut known) = ([first; MEASURES], [false; MEASURES]);
    let (mut family, mut count) = (0, 0);
    while family < TABLE.len() {
        let mut row = 0;
        while row < TABLE[family].len() {
            if let Some(entry) = &TABLE[family][row].measure {
                let at = entry.measure as usize;
                assert!(!known[at], "a measure has two rows");
                (out[at], known[at], count) = (entry, true, count + 1);
            }
            row += 1;
        }
        family += 1;
    }
    assert!(count == MEASURES, "a measure has no row");
    out
}

/// The column of a measure of cells, where the compiler can ask for it: a measure without one does not compile.
pub const fn column_of(measure: Measure) -> &'static str {
    let mut family = 0;
    while family < TABLE.len() {
        let mut row = 0;
        while row < TABLE[family].len() {
            if let Row { column: Some(column), measure: Some(entry) } = &TABLE[family][row]
                && entry.measure as usize == measure as usize
            {
                return column.name;
            }
            row += 1;
        }
        family += 1;
    }
    panic!("the measure has no column")
}

/// Every row in the order of the table.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    TABLE.into_iter().flatten()
}

/// Every column in the order of the table.
pub fn columns() -> impl Iterator<Item = &'static Heading> {
    rows().filter_map(|row| row.column.as_ref())
}

/// Every measure in the order of [`Measure`].
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    ENTRIES.into_iter()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_measure_has_a_name_and_what_is_of_cells_a_column() {
        for (i, entry) in entries().enumerate() {
            let measure = entry.measure;
            assert_eq!((measure as usize, Measure::by_name(measure.name())), (i, Some(measure)));
            assert_eq!(measure.is_of_cells(), measure.column().is_some(), "{measure:?}");
            assert!(measure.column().is_none_or(|c| c == column_of(measure)));
        }
    }

    #[test]
    fn no_name_stands_twice() {
        let names: Vec<_> = entries().map(|e| e.words.key).chain(columns().map(|c| c.name)).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len());
    }

    #[test]
    fn nothing_is_left_unsaid() {
        for Entry { words: w, definition, origin, .. } in entries() {
            let said = [w.key, w.plain, w.technical, w.meaning, definition, origin];
            assert!(said.iter().all(|text| !text.is_empty()), "{}", w.key);
            assert!(w.meaning.ends_with('.'), "{}", w.meaning);
        }
        assert!(columns().all(|c| c.meaning.ends_with('.')));
    }
}
