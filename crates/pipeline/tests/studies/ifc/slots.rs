//! Openings that slide along their walls, with the doors in them.

use enfilade_cad::drawing::Slot;

use super::*;

fn slots_in(drawing: &Drawing, wall: usize) -> Vec<&Slot> {
    drawing.slots.iter().filter(|s| s.host == wall).collect()
}

/// How far every corner of a drawing goes to another state of it, which has the same entities.
fn steps<'d>(before: &'d Drawing, after: &Drawing) -> Vec<(&'d Entity, DVec2, DVec2)> {
    assert_eq!(before.entities.len(), after.entities.len());
    let both = before.entities.iter().zip(&after.entities);
    both.flat_map(|(a, b)| {
        let (from, to) = (points(a), points(b));
        assert_eq!(from.len(), to.len(), "{:?}", a.source);
        from.into_iter().zip(to).map(move |(p, q)| (a, p, q - p)).collect::<Vec<_>>()
    })
    .collect()
}

#[test]
fn doors_slide_as_far_as_their_wall_is_alike() {
    let text = pavilion();
    let drawing = read(text.as_bytes());
    assert!(drawing.slots.iter().all(|s| s.source.layer != "IfcWindow"));
    let [cloakroom] = slots_in(&drawing, named(&text, "cloakroom"))[..] else { panic!("one door") };
    // From 2.6 m to 3.6 m of a wall of 6.6 m.
    assert!((cloakroom.free[0] + 2600.0).abs() < 1e-6 && (cloakroom.free[1] - 3000.0).abs() < 1e-6);
    assert!(cloakroom.along.distance(DVec2::X) < 1e-9);
    let hall = slots_in(&drawing, named(&text, "hall"));
    // From 1.2 m to 2.6 m, and from 9 m to 10 m of a wall of 11.4 m: each ends at the other.
    let free: Vec<[f64; 2]> = hall.iter().map(|s| s.free.map(|v| (v * 1e3).round() / 1e3)).collect();
    assert_eq!(free, [[-1200.0, 6400.0], [-6400.0, 1400.0]]);
}

/// A room that ends with an opening would be left in the wall; one that covers the wall beside it as well would not.
#[test]
fn an_opening_into_which_a_room_reaches_stays() {
    let text = pavilion();
    let wall = named(&text, "cloakroom");
    let door = slots_in(&read(text.as_bytes()), wall)[0].outline.clone();
    let [lo, hi] = [DVec2::min, DVec2::max].map(|of| door.iter().copied().reduce(of).unwrap());
    for (beside, slots) in [(0.0, 0), (500.0, 1)] {
        // Up to the middle of the wall.
        let size = DVec2::new(hi.x - lo.x + 2.0 * beside, 500.0);
        let middle = DVec2::new(lo.midpoint(hi).x, lo.midpoint(hi).y + 250.0);
        let room = format!(
            "#90001=IFCCARTESIANPOINT(({:?},{:?}));\n#90002=IFCAXIS2PLACEMENT2D(#90001,$);\n\
             #90003=IFCRECTANGLEPROFILEDEF(.AREA.,$,#90002,{:?},{:?});\n#90004=IFCDIRECTION((0.,0.,1.));\n\
             #90005=IFCEXTRUDEDAREASOLID(#90003,$,#90004,2900.);\n\
             #90006=IFCSHAPEREPRESENTATION(#7,'Body','SweptSolid',(#90005));\n\
             #90007=IFCPRODUCTDEFINITIONSHAPE($,$,(#90006));\n\
             #90008=IFCSPACE('0PavilionOfEnfilade900',$,'Lobby',$,$,#17,#90007,$,.ELEMENT.,.INTERNAL.,$);\n\
             #90009=IFCRELAGGREGATES('0PavilionOfEnfilade901',$,$,$,#18,(#90008));\n",
            middle.x, middle.y, size.x, size.y
        );
        let drawing = read(with_instances(&text, &room).as_bytes());
        assert_eq!(slots_in(&drawing, wall).len(), slots, "{beside} mm beside it");
    }
}

#[test]
fn a_door_slides_alone_and_with_its_wall_however_it_is_placed() {
    for in_world in [false, true] {
        let text = sample::building(in_world);
        let wall = named(&text, "cloakroom");
        let before = read(text.as_bytes());
        let slot = slots_in(&before, wall)[0];
        let slide = shift(slot.source.record, 300.0, 0.0);
        let whole = shift(wall, 250.0, 500.0);
        for (edits, with_wall) in [
            (vec![slide.clone()], DVec2::ZERO),
            (vec![whole.clone(), slide.clone()], DVec2::new(250.0, 500.0)),
            (vec![slide, whole], DVec2::new(250.0, 500.0)),
        ] {
            let after = read(&patch(text.as_bytes(), &edits, &[]).unwrap());
            let mut slid = 0;
            for (e, from, step) in steps(&before, &after) {
                let is_side =
                    slot.jambs.iter().flatten().any(|p| *p == from) || e.source.record == slot.closing.record;
                let is_own = e.source.record == wall || e.source.record == slot.closing.record;
                let own = if is_own { with_wall } else { DVec2::ZERO };
                let expected = own + if is_own && is_side { DVec2::X * 300.0 } else { DVec2::ZERO };
                assert!(step.distance(expected) < 1e-6, "in_world {in_world}: {:?} by {step}", e.source);
                slid += usize::from(is_own && is_side);
            }
            assert_eq!(slid, 8, "four corners of the wall, four of its door");
        }
        let edits = [shift(slot.source.record, 1.0, 0.0)];
        let changed =
            enfilade_cad::changes("house.ifc", text.as_bytes(), &ReadOptions::default(), &edits).unwrap();
        assert_eq!(changed.records[0].len(), 2, "opening and door: {changed:?}");
    }
}

/// A wall that turns takes a door along that slid in it: it stands in the wall afterwards.
#[test]
fn a_door_slides_in_a_wall_that_turns() {
    for in_world in [false, true] {
        let text = sample::building(in_world);
        let wall = named(&text, "cloakroom");
        let before = read(text.as_bytes());
        let slot = slots_in(&before, wall)[0];
        let turned = RigidMotion { turn_rad: 0.3, shift: DVec2::new(2000.0, -1500.0) };
        let edits = [Edit::Insert { record: wall, motion: turned }, shift(slot.source.record, -200.0, 0.0)];
        let after = read(&patch(text.as_bytes(), &edits, &[]).unwrap());
        let closing = |d: &Drawing| {
            let e = d.entities.iter().find(|e| e.source.record == slot.closing.record).map(points).unwrap();
            e.iter().sum::<DVec2>() / e.len() as f64
        };
        let expected = DVec2::from_angle(0.3).rotate(closing(&before) - DVec2::X * 200.0) + turned.shift;
        assert!(closing(&after).distance(expected) < 1e-6, "{} {expected}", closing(&after));
        assert_eq!(slots_in(&after, wall).len(), 1, "it slides on");
    }
}

#[test]
fn what_is_kept_does_not_slide() {
    let text = pavilion();
    let slot = slots_in(&read(text.as_bytes()), named(&text, "cloakroom"))[0].clone();
    for of in [slot.closing.record, slot.host] {
        let kept = with_instances(
            &text,
            &format!(
                "#900001=IFCPROPERTYSINGLEVALUE('Keep',$,IFCBOOLEAN(.T.),$);\n\
                 #900002=IFCPROPERTYSET('0K00000000000000000001',$,'Pset_Enfilade',$,(#900001));\n\
                 #900003=IFCRELDEFINESBYPROPERTIES('0K00000000000000000002',$,$,$,(#{of}),#900002);\n"
            ),
        );
        assert!(slots_in(&read(kept.as_bytes()), slot.host).is_empty(), "#{of}");
    }
}
