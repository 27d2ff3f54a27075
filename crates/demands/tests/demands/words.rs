//! Which rooms a word means.

use enfilade_demands::Verdict;

use crate::plan::{answer, first, flat};

#[test]
fn rooms_are_known_by_number_name_kind_and_nearly() {
    let flat = flat();
    for word in ["2", "#2", "kitchen", "Kitchen", "KITCHEN", "kichen", "Küche"] {
        let found = answer(&flat, &format!("{word} area min 1 m2"));
        let rooms: Vec<usize> = found.findings.iter().flat_map(|f| &f.rooms).map(|r| r.0).collect();
        assert_eq!(rooms, [1], "{word}");
    }
    assert_eq!(answer(&flat, "rooms area min 1 m2").findings.len(), 4);
    for word in ["9", "ballroom", "bedroom"] {
        let found = answer(&flat, &format!("{word} area min 1 m2"));
        assert_eq!(found.verdict, Verdict::Untold, "{word}");
        assert!(found.findings[0].note.is_some(), "{word}");
    }
}

/// A room that bears the name of its kind does not stand for all of them alone.
#[test]
fn a_kind_means_all_of_its_rooms() {
    let mut flat = flat();
    flat.rooms[3].kind = enfilade_plan::kinds::RoomKind::Bath;
    let found = answer(&flat, "bath area min 1 m2");
    let rooms: Vec<usize> = found.findings.iter().flat_map(|f| &f.rooms).map(|r| r.0).collect();
    assert_eq!(rooms, [2, 3]);
}

#[test]
fn a_guess_is_said() {
    let mut flat = flat();
    flat.rooms[2].is_sure = false;
    let found = answer(&flat, "bath area min 1 m2");
    assert!(found.findings[0].note.as_ref().unwrap().contains("Probably a bathroom"));
    assert_eq!(first(&flat, "kitchen seen-from nowhere").0, Verdict::Untold);
    assert_eq!(first(&flat, "doors area min 1 m2").0, Verdict::Untold);
}
