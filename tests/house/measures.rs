//! What documents, the sample settings and the plugins say of measures is what the table says.

#![allow(clippy::expect_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use enfilade::sample_settings;
use enfilade_brief::{Entry, Measure, Sense, column_of, entries};

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).expect(path)
}

/// A measure as `docs/measures.md` says it: name, in words, formula, unit, what more of it means, source, cost.
fn row(entry: &Entry) -> String {
    let or_none = |text: &str| if text.is_empty() { "–".to_owned() } else { text.to_owned() };
    let words = entry.words;
    let arrow = match entry.better {
        Some(Sense::Max) => "▲",
        Some(Sense::Min) => "▼",
        None => "",
    };
    let more = format!("{arrow} {}", words.more_less[0]);
    let mut plain = words.plain.chars();
    let plain: String = plain.next().into_iter().flat_map(char::to_lowercase).chain(plain).collect();
    format!(
        "| `{}` | {plain} | {} | {} | {} | {} | {} |",
        words.key,
        entry.definition,
        or_none(words.bare_unit()),
        or_none(more.trim()),
        entry.origin,
        or_none(entry.source.cost_in_short().unwrap_or_default()),
    )
}

#[test]
fn the_document_has_the_table() {
    let page = read("docs/measures.md");
    let written: BTreeSet<&str> = page.lines().filter(|l| l.starts_with("| `")).collect();
    let rows: Vec<String> = entries().map(row).collect();
    let missing: Vec<&String> = rows.iter().filter(|r| !written.contains(r.as_str())).collect();
    assert!(missing.is_empty(), "docs/measures.md lacks\n{}", rows.join("\n"));
    assert_eq!(written.len(), rows.len(), "docs/measures.md has rows of no measure");
    for entry in entries() {
        let mut origins = entry.origin.split(", ");
        assert!(origins.all(|o| page.contains(&format!("\n- {o}: "))), "docs/measures.md: {}", entry.origin);
    }
}

/// The names in a list such as `integration (-p-value, -tekl), isovist-area, -perimeter`: what begins with `-` follows
/// the first word of the name before it.
fn names(list: &str) -> BTreeSet<String> {
    let mut stem = "";
    let mut found = BTreeSet::new();
    for word in list.split([',', ' ', '(', ')']).filter(|w| !w.is_empty()) {
        if word.starts_with('-') {
            found.insert(format!("{stem}{word}"));
        } else {
            stem = word.split('-').next().unwrap_or_default();
            found.insert(word.to_owned());
        }
    }
    found
}

#[test]
fn the_sample_settings_list_every_measure_of_cells() {
    let text = sample_settings::TEXT.replace("\n# ", " ");
    let list = text.split("Measures: ").nth(1).and_then(|rest| rest.split('.').next()).expect("a list");
    let (quick, slow) = list.split_once("; and, slower, ").expect("two lists");
    let wanted = |is_slow: bool| -> BTreeSet<String> {
        let asked = |e: &&Entry| e.measure.is_of_cells() && e.source.is_of_graph() == is_slow;
        entries().filter(asked).map(|e| e.words.key.to_owned()).collect()
    };
    assert_eq!((names(quick.trim_end_matches(';')), names(slow)), (wanted(false), wanted(true)));
}

/// What the plugins offer is a measure, and the column they read is that of the table.
#[test]
fn the_plugins_name_measures_as_the_table_does() {
    let model = read("plugins/common/enfilade_common/model.py");
    let offered = model.lines().find_map(|l| l.strip_prefix("MEASURES = ")).expect("MEASURES");
    for name in offered.split('"').skip(1).step_by(2) {
        assert!(Measure::by_name(name).is_some(), "{name}");
    }
    let results = read("plugins/common/enfilade_common/results.py");
    let columns = results.lines().find_map(|l| l.strip_prefix("COLUMNS = ")).expect("COLUMNS");
    let quoted: Vec<&str> = columns.split('"').skip(1).step_by(2).collect();
    for pair in quoted.chunks(2) {
        let measure = Measure::by_name(pair[0]).expect(pair[0]);
        assert_eq!(pair[1], column_of(measure));
    }
}
