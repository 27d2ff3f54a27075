//! Drawings without what is demolished, and without layers of ours: `accept --clean`, `run --overlay attach`.

use crate::desk::{Desk, Plan, enfilade, hall, json, text};

fn with_demolished() -> Plan {
    hall(["x -2 2", "x -2 2", "x -2 2"]).ring("EF-DEMOLISHED", [8.0, 8.0, 9.0, 9.0])
}

/// Of a drawing alone: the next one has all but what is demolished, and the same settings beside it.
#[test]
fn what_is_demolished_is_taken_out_of_a_copy() {
    let desk = Desk::new(&with_demolished());
    desk.side_car("unit = \"m\"\n");
    let drawing = desk.drawing().to_string_lossy().into_owned();
    let before = std::fs::read(desk.drawing()).unwrap();
    let clean = |file: &str| {
        let done = enfilade(&["accept", file, "--clean"]);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    };
    clean(&drawing);
    let next = desk.folder.path().join("plan-r02.dxf");
    let plain = hall(["x -2 2", "x -2 2", "x -2 2"]).text();
    assert_eq!(std::fs::read_to_string(&next).unwrap(), plain);
    assert_eq!(std::fs::read(desk.drawing()).unwrap(), before);
    let side_car = std::fs::read_to_string(desk.folder.path().join("plan-r02.enfilade.toml")).unwrap();
    assert_eq!(side_car.trim(), "unit = \"m\"");
    // Again, and of what has nothing: no other file.
    clean(&drawing);
    clean(&next.to_string_lossy());
    let files = std::fs::read_dir(desk.folder.path()).unwrap().count();
    assert_eq!(files, 4);
    assert_eq!(enfilade(&["accept", &drawing]).status.code(), Some(3));
    assert_eq!(enfilade(&["accept", &drawing, "--clean", "--round", "1"]).status.code(), Some(3));
}

/// Of an option: it is cleaned as it is accepted.
#[test]
fn an_option_is_accepted_without_what_is_demolished() {
    let desk = Desk::new(&with_demolished());
    desk.run(1, &[]);
    let drawing = desk.drawing().to_string_lossy().into_owned();
    let accepted = |more: &[&str], name: &str| {
        let done = enfilade(&[&["accept", &drawing, "1"], more].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
        std::fs::read_to_string(desk.folder.path().join(name)).unwrap()
    };
    let whole = accepted(&[], "plan-r02.dxf");
    let cleaned = accepted(&["--clean"], "plan-r03.dxf");
    assert!(whole.contains("EF-DEMOLISHED") && !cleaned.contains("EF-DEMOLISHED"));
    let [x, y] = ["plan-r02", "plan-r03"]
        .map(|n| std::fs::read_to_string(desk.folder.path().join(format!("{n}.enfilade.toml"))).unwrap());
    assert_eq!(x, y);
}

/// Overlays in a drawing of their own: the drawings have none, and the option is the same.
#[test]
fn overlays_lie_in_drawings_of_their_own() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let drawn = desk.run(1, &[]);
    let apart = desk.run(2, &["--overlay", "attach"]);
    let read = |folder: &std::path::Path, name: &str| std::fs::read_to_string(folder.join(name)).unwrap();
    let ours = ["EF-NOTE", "EF-HEAT-DEGREE", "EF-MOVED"];
    let (option, notes) = (read(&apart, "candidate-1.dxf"), read(&apart, "candidate-1-notes.dxf"));
    for layer in ours {
        assert!(!option.contains(layer) && notes.contains(layer), "{layer}");
        assert!(read(&drawn, "candidate-1.dxf").contains(layer), "{layer}");
    }
    assert_eq!(read(&apart, "initial.dxf"), std::fs::read_to_string(desk.drawing()).unwrap());
    assert!(!drawn.join("candidate-1-notes.dxf").exists());
    let settings =
        |folder: &std::path::Path| json(&folder.join("result.json"))["settings"]["overlay"].clone();
    assert_eq!([settings(&drawn), settings(&apart)], [serde_json::Value::Null, "attach".into()]);
    // A drawing of notes is none to work on.
    let notes = apart.join("candidate-1-notes.dxf").to_string_lossy().into_owned();
    assert_eq!(enfilade(&["check", &notes]).status.code(), Some(2));
    let done = enfilade(&["accept", &desk.drawing().to_string_lossy(), "1"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
}
