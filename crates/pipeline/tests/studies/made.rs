//! Works of the list made in the drawing: read again they measure what the list says, and nothing else of the file changes.

use std::collections::BTreeMap;

use enfilade_config::{Partial, Settings};
use enfilade_fixtures::sample;
use enfilade_overlay::works::WorkEntry;
use enfilade_pipeline::works::{MadeWorks, make_works, works_of};
use enfilade_pipeline::{Input, works};
use enfilade_report::{Cancel, Error};

fn settings() -> Settings {
    Settings::new(Partial::default()).unwrap()
}

/// The best work of each kind.
fn of_each_kind(file: &str) -> (Vec<u8>, BTreeMap<String, WorkEntry>) {
    let bytes = std::fs::read(sample(file)).unwrap();
    let input = Input::new(file, &bytes, 1);
    let (listed, _) = works_of(&input, &settings(), &Cancel::default()).unwrap();
    let mut out = BTreeMap::new();
    for work in listed.result.works {
        out.entry(work.kind.clone()).or_insert(work);
    }
    (bytes, out)
}

fn made(file: &str, bytes: &[u8], ids: &[usize]) -> Result<MadeWorks, Error> {
    make_works(&Input::new(file, bytes, 1), &settings(), ids, &Cancel::default())
}

/// Each kind once, alone: list and file differ by a tenth of a percent at most.
fn as_listed(file: &str, in_the_file: &[&str]) {
    let (bytes, kinds) = of_each_kind(file);
    assert!(kinds.len() >= 5, "{:?}", kinds.keys());
    for (kind, work) in &kinds {
        let made = made(file, &bytes, &[work.id]).unwrap();
        assert!((made.expected - made.gain).abs() < 1e-3, "{file} {kind}: {} {}", made.expected, made.gain);
        let is_in_the_file = made.tables.is_empty();
        assert_eq!(is_in_the_file, in_the_file.contains(&kind.as_str()), "{file} {kind}");
        assert_eq!(made.bytes == bytes, !is_in_the_file, "{file} {kind}");
        assert_eq!(made.report.problems.iter().any(|p| p.code == "work-decided"), !is_in_the_file);
    }
}

#[test]
fn works_are_cut_into_a_drawing() {
    as_listed("flat.dxf", &["open", "door", "widen", "remove", "close", "rehang", "glaze"]);
}

#[test]
fn openings_and_removals_are_written_into_a_building() {
    as_listed("flat.ifc", &["open", "door", "widen", "remove", "close", "rehang", "glaze"]);
}

#[test]
fn what_a_scene_cannot_hold_is_decided_beside_it() {
    as_listed("flat.glb", &[]);
}

/// What is demolished goes to a layer of its own by one group; its other bytes stay.
#[test]
fn a_removal_changes_one_group_of_each_line() {
    let (bytes, kinds) = of_each_kind("flat.dxf");
    let made = made("flat.dxf", &bytes, &[kinds["remove"].id]).unwrap();
    let [old, new] = [&bytes, &made.bytes].map(|b| String::from_utf8_lossy(b).into_owned());
    let records = |text: &str, layer: &str| -> Vec<String> {
        let all = text.split("\n  0\n").map(str::to_owned);
        all.filter(|r| r.contains(&format!("\n  8\n{layer}\n"))).collect()
    };
    let gone = records(&new, "EF-DEMOLISHED");
    // Two faces of a partition with a door: its leaf and its swing go too; and the outline of it all.
    assert!(gone.len() >= 3, "{gone:?}");
    let lines: Vec<&String> = gone.iter().filter(|r| r.starts_with("LINE")).collect();
    assert!(lines.len() >= 2);
    for line in lines {
        let was = line.replace("\nEF-DEMOLISHED\n", "\nA-WALL-PART\n");
        assert!(old.contains(&was), "{line}");
    }
}

/// Undone by hand: what lies on the layer goes back to where it was, what was drawn anew goes.
#[test]
fn a_wall_put_back_measures_as_before() {
    let (bytes, kinds) = of_each_kind("flat.dxf");
    let work = &kinds["remove"];
    let made = made("flat.dxf", &bytes, &[work.id]).unwrap();
    let text = String::from_utf8(made.bytes).unwrap();
    let back =
        text.split_inclusive("\n  0\n")
            .map(|r| {
                if r.starts_with("LINE") {
                    r.replace("\nEF-DEMOLISHED\n", "\nA-WALL-PART\n")
                } else {
                    r.into()
                }
            })
            .collect::<String>();
    let input = Input::new("flat.dxf", back.as_bytes(), 1);
    let (again, _) = works::works_of(&input, &settings(), &Cancel::default()).unwrap();
    let same = |w: &&WorkEntry| w.kind == "remove" && w.stretch == work.stretch;
    let found = again.result.works.iter().find(same).unwrap();
    let share = |w: &WorkEntry| w.gain["visibility"].share;
    assert!((share(found) - share(work)).abs() < 2e-3, "{} {}", share(found), share(work));
}

#[test]
fn a_number_that_the_list_lacks_is_refused() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    for id in [0, 10_000] {
        assert!(matches!(made("flat.dxf", &bytes, &[id]), Err(Error::Usage(_))));
    }
    // Both cut the same wall.
    let (_, kinds) = of_each_kind("flat.dxf");
    let twice = kinds["open"].id;
    assert!(matches!(made("flat.dxf", &bytes, &[twice, twice]), Err(Error::Usage(_))));
}

/// What is demolished is no wall, whether it is still drawn or taken out.
#[test]
fn what_is_taken_out_changes_no_measure() {
    for file in ["flat.dxf", "flat.ifc"] {
        let (bytes, kinds) = of_each_kind(file);
        let made = made(file, &bytes, &[kinds["remove"].id]).unwrap().bytes;
        let (cleaned, count) = enfilade_cad::without_demolished(file, &made).unwrap();
        assert!(count > 0 && cleaned.len() < made.len(), "{file}");
        let mean = |bytes: &[u8]| {
            let input = Input::new(file, bytes, 1);
            enfilade_pipeline::analyse(&input, &settings(), &Cancel::default()).unwrap().0.result.mean
        };
        assert_eq!(mean(&cleaned), mean(&made), "{file}");
    }
}
