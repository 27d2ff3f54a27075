//! What a write-back did to a DXF, judged record by record without the program's own reader.

use std::collections::BTreeSet;

/// Layers on which the user draws for us: their entities are the user's, not ours.
const MARKERS: &[&str] = &["EF-QUERY", "EF-REFERENCE", "EF-MOVE", "EF-KEEP"];

/// What begins with a group 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    pub section: String,
    pub kind: String,
    /// Number in the file, from 0.
    pub index: usize,
    /// Index of the entity it belongs to: of the POLYLINE for a VERTEX, else its own.
    pub owner: usize,
    /// Group codes and values.
    pub pairs: Vec<(i32, String)>,
    /// As in the file, line ends included.
    pub raw: String,
}

impl Record {
    pub fn first(&self, code: i32) -> Option<&str> {
        self.pairs.iter().find(|p| p.0 == code).map(|p| p.1.as_str())
    }

    fn layer(&self) -> &str {
        self.first(8).unwrap_or_default()
    }

    /// An entity that the program drew.
    fn is_ours(&self) -> bool {
        self.section == "ENTITIES" && self.layer().starts_with("EF-") && !MARKERS.contains(&self.layer())
    }

    /// A table entry that the program needs.
    fn is_our_table_entry(&self) -> bool {
        let name = self.first(2).unwrap_or_default();
        self.section == "TABLES"
            && ((self.kind == "LAYER" && name.starts_with("EF-"))
                || (self.kind == "APPID" && name == "ENFILADE"))
    }
}

/// All records of a file.
pub fn records(text: &str) -> Vec<Record> {
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let mut records: Vec<Record> = vec![];
    let (mut section, mut owner) = (String::new(), 0);
    for (i, pair) in lines.chunks_exact(2).enumerate() {
        let code: i32 =
            pair[0].trim().parse().unwrap_or_else(|_| panic!("line {}: {:?}", 2 * i + 1, pair[0]));
        let value = pair[1].trim_end_matches(['\r', '\n']).to_owned();
        if code == 0 {
            let index = records.len();
            if !["VERTEX", "SEQEND"].contains(&value.as_str()) {
                owner = index;
            }
            let (kind, section) = (value.clone(), section.clone());
            records.push(Record { section, kind, index, owner, pairs: vec![], raw: String::new() });
        }
        let record = records.last_mut().expect("a file begins with group 0");
        if record.kind == "SECTION" && code == 2 {
            section = value.clone();
            record.section = value.clone();
        }
        record.pairs.push((code, value));
        record.raw += &pair.concat();
    }
    records
}

/// Records of `after` whose geometry differs, and everything that should not be: a record gone, out of
/// order or added elsewhere than on our layers, a change in more than geometry, or of an entity not in
/// `named` (record numbers of `before`).
pub fn compare(before: &str, after: &str, named: &BTreeSet<usize>) -> (usize, Vec<String>) {
    let (before, after) = (records(before), records(after));
    let known: BTreeSet<&str> =
        before.iter().filter(|r| r.is_our_table_entry()).filter_map(|r| r.first(2)).collect();
    let is_added = |r: &&Record| {
        r.is_ours() || (r.is_our_table_entry() && !known.contains(r.first(2).unwrap_or_default()))
    };
    let kept: Vec<&Record> = after.iter().filter(|r| !is_added(r)).collect();
    if kept.len() != before.len() {
        let words = format!("{} records that are not ours; there were {}", kept.len(), before.len());
        return (0, vec![words]);
    }
    let (mut moved, mut faults) = (0, vec![]);
    for (old, new) in before.iter().zip(kept).filter(|(old, new)| old.raw != new.raw) {
        let name = format!("{} record {} layer {:?}", old.kind, old.index, old.layer());
        if old.section == "ENTITIES" && differs_in_geometry_only(old, new) {
            moved += 1;
            if !named.contains(&old.owner) {
                faults.push(format!("{name} moved, but the result does not say so"));
            }
        } else if !may_differ(old, new) {
            faults.push(format!("{name} became {:?}", new.raw));
        }
    }
    (moved, faults)
}

fn differs_in_geometry_only(old: &Record, new: &Record) -> bool {
    let is_geometry =
        |code| (10..=18).contains(&code) || (20..=28).contains(&code) || [42, 50, 51].contains(&code);
    old.pairs.len() == new.pairs.len()
        && old.pairs.iter().zip(&new.pairs).all(|(p, q)| p.0 == q.0 && (p.1 == q.1 || is_geometry(p.0)))
}

/// The next free handle in the header, and the number of entries at a table's head.
fn may_differ(old: &Record, new: &Record) -> bool {
    let without_count = |r: &Record| r.pairs.iter().filter(|p| p.0 != 70).cloned().collect::<Vec<_>>();
    let without_seed = |r: &Record| {
        let mut pairs = r.pairs.clone();
        if let Some(at) = pairs.iter().position(|p| p.1 == "$HANDSEED") {
            pairs.drain(at..at + 2);
        }
        pairs
    };
    match (old.kind.as_str(), old.section.as_str()) {
        ("TABLE", _) => without_count(old) == without_count(new),
        ("SECTION", "HEADER") => without_seed(old) == without_seed(new),
        _ => false,
    }
}

#[test]
fn the_judge_finds_what_should_not_be() {
    let plan = |extra: &str, x: &str, layer: &str| {
        format!(
            "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n{layer}\n10\n{x}\n20\n0.0\n0\nLINE\n8\nWALL\n10\n5.0\n{extra}0\nENDSEC\n0\nEOF\n"
        )
    };
    let before = plan("", "1.0", "WALL");
    let named = BTreeSet::from([1]);
    let ours = "0\nPOLYLINE\n8\nEF-MOVED\n0\nVERTEX\n8\nEF-MOVED\n0\nSEQEND\n8\nEF-MOVED\n";
    assert_eq!(compare(&before, &before, &named), (0, vec![]));
    assert_eq!(compare(&before, &plan(ours, "2.0", "WALL"), &named), (1, vec![]));
    let faults =
        |after: &str, named: &[usize]| compare(&before, after, &named.iter().copied().collect()).1.len();
    assert_eq!(faults(&plan("", "2.0", "WALL"), &[2]), 1, "another entity moved");
    assert_eq!(faults(&plan("", "1.0", "OTHER"), &[1]), 1, "its layer changed");
    assert_eq!(
        faults(&plan("0\nPOINT\n8\nWALL\n", "1.0", "WALL"), &[1]),
        1,
        "something added on a layer of the user"
    );
    assert_eq!(faults(&before.replace("0\nLINE\n8\nWALL\n10\n5.0\n", ""), &[1]), 1, "something vanished");
}
