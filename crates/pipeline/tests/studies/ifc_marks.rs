//! Marks of `Pset_Enfilade` that cannot be read.

#![allow(clippy::unwrap_used)]

use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;

#[test]
fn a_mark_that_cannot_be_read_holds_its_wall_alone() {
    let text = std::fs::read_to_string(enfilade_fixtures::sample("pavilion.ifc")).unwrap();
    let check = |text: &str| {
        let settings = Settings::new(Partial::default()).unwrap();
        enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &settings).unwrap()
    };
    let groups = check(&text).result.moves.len();
    let line = text.lines().find(|l| l.contains("IFCPROPERTYSINGLEVALUE('Move'")).unwrap();
    let stated = line.split('\'').nth(3).unwrap();
    for (mark, says) in [("hello", "\"hello\": expected `x LOW HIGH`"), ("rotate 5 -5", "\"rotate 5 -5\"")] {
        let outcome = check(&text.replace(line, &line.replace(stated, mark)));
        let told = outcome.report.problems.iter().filter(|p| p.code == "move-clause");
        let told: Vec<String> = told.map(|p| p.to_string()).collect();
        assert_eq!(told.len(), 1, "{:?}", outcome.report);
        assert!(told[0].contains("house.ifc:") && told[0].contains("IfcWall"), "{told:?}");
        assert!(told[0].contains("Move of Pset_Enfilade") && told[0].contains(says), "{told:?}");
        let left = outcome.result.moves.len();
        assert!(0 < left && left < groups, "{left} of {groups}");
    }
}
