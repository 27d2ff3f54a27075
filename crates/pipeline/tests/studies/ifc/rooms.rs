//! Rooms beside a wall that moves: outlines and stated areas follow, and what does not is named.

use enfilade_cad::ifc::BoundedRoom;

use super::told::house;
use super::*;

const WALL: usize = 9000;
const WEST: usize = 9200;
const EAST: usize = 9300;
const SOUTH: usize = 9400;

/// A house of 6 m × 6 m parted by a wall: to the west a room with a rectangle, to the east one with a polyline, a third
/// one over the eastern one with a plinth in it.
fn parted() -> String {
    let data = "#9000=IFCWALL('W000000000000000009000',$,'parting',$,$,#9003,#9004,$,$);\n\
         #9001=IFCCARTESIANPOINT((3.,0.1,0.));\n#9002=IFCAXIS2PLACEMENT3D(#9001,#8,#9);\n\
         #9003=IFCLOCALPLACEMENT(#53,#9002);\n#9004=IFCPRODUCTDEFINITIONSHAPE($,$,(#9006));\n\
         #9006=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9007));\n\
         #9007=IFCEXTRUDEDAREASOLID(#9008,$,#8,2.8);\n#9008=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9009,5.8,0.2);\n\
         #9009=IFCAXIS2PLACEMENT2D(#9010,$);\n#9010=IFCCARTESIANPOINT((2.9,0.));\n\
         #9020=IFCRELCONTAINEDINSPATIALSTRUCTURE('R000000000000000000009',$,$,$,(#9000),#50);\n\
         #9200=IFCSPACE('W000000000000000009200',$,'1',$,$,#9203,#9204,'West',.ELEMENT.,.INTERNAL.,$);\n\
         #9203=IFCLOCALPLACEMENT(#53,#4);\n#9204=IFCPRODUCTDEFINITIONSHAPE($,$,(#9206));\n\
         #9206=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9207));\n\
         #9207=IFCEXTRUDEDAREASOLID(#9208,$,#8,2.7);\n#9208=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9209,2.8,5.8);\n\
         #9209=IFCAXIS2PLACEMENT2D(#9210,$);\n#9210=IFCCARTESIANPOINT((1.5,3.));\n\
         #9220=IFCQUANTITYAREA('NetFloorArea',$,$,16.24);\n#9221=IFCQUANTITYAREA('NetWallArea',$,$,46.);\n\
         #9222=IFCQUANTITYLENGTH('Height',$,$,2.7);\n#9223=IFCQUANTITYVOLUME('NetVolume',$,$,43.848);\n\
         #9224=IFCELEMENTQUANTITY('R000000000000000000024',$,'Base',$,$,(#9220,#9221,#9222,#9223));\n\
         #9225=IFCRELDEFINESBYPROPERTIES('R000000000000000000025',$,$,$,(#9200),#9224);\n\
         #9226=IFCRELSPACEBOUNDARY('R000000000000000000026',$,$,$,#9200,#9000,$,.PHYSICAL.,.INTERNAL.);\n\
         #9227=IFCRELSPACEBOUNDARY('R000000000000000000027',$,$,$,#9200,#100,$,.PHYSICAL.,.EXTERNAL.);\n\
         #9300=IFCSPACE('W000000000000000009300',$,'2',$,$,#9303,#9304,'East',.ELEMENT.,.INTERNAL.,$);\n\
         #9303=IFCLOCALPLACEMENT(#53,#4);\n#9304=IFCPRODUCTDEFINITIONSHAPE($,$,(#9306));\n\
         #9306=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9307));\n\
         #9307=IFCEXTRUDEDAREASOLID(#9308,$,#8,2.7);\n#9308=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#9309);\n\
         #9309=IFCPOLYLINE((#9310,#9311,#9312,#9313,#9310));\n#9310=IFCCARTESIANPOINT((3.1,0.1));\n\
         #9311=IFCCARTESIANPOINT((5.9,0.1));\n#9312=IFCCARTESIANPOINT((5.9,5.9));\n\
         #9313=IFCCARTESIANPOINT((3.1,5.9));\n\
         #9400=IFCSPACE('W000000000000000009400',$,'3',$,$,#9403,#9404,'Vault',.ELEMENT.,.INTERNAL.,$);\n\
         #9403=IFCLOCALPLACEMENT(#53,#4);\n#9404=IFCPRODUCTDEFINITIONSHAPE($,$,(#9406));\n\
         #9406=IFCSHAPEREPRESENTATION(#5,'Body','CSG',(#9407));\n\
         #9407=IFCBOOLEANRESULT(.DIFFERENCE.,#9307,#9408);\n\
         #9408=IFCEXTRUDEDAREASOLID(#9409,$,#8,0.5);\n#9409=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9410,0.5,0.5);\n\
         #9410=IFCAXIS2PLACEMENT2D(#9411,$);\n#9411=IFCCARTESIANPOINT((4.5,3.));\n\
         #9420=IFCRELAGGREGATES('R000000000000000000420',$,$,$,#50,(#9200,#9300,#9400));\n";
    with_instances(&house(&[]), data)
}

fn moved(turn_rad: f64, shift: DVec2) -> [Edit; 1] {
    [Edit::Insert { record: WALL, motion: RigidMotion { turn_rad, shift } }]
}

fn rooms(text: &str, edits: &[Edit]) -> Vec<BoundedRoom> {
    enfilade_cad::changes("house.ifc", text.as_bytes(), &lower(), edits).unwrap().rooms
}

fn lower() -> ReadOptions {
    ReadOptions { storey: Some("Lower".into()), ..ReadOptions::default() }
}

fn ring(bytes: &[u8], record: usize) -> Vec<DVec2> {
    let drawing = read_with(bytes, &lower()).0.unwrap();
    let spaces = drawing.entities.iter().filter(|e| e.source.record == record && e.layer == "IfcSpace");
    let mut all: Vec<DVec2> = spaces.flat_map(points).collect();
    all.sort_by(|a, b| (a.x, a.y).partial_cmp(&(b.x, b.y)).unwrap());
    all.dedup();
    all
}

fn is_near(found: &[DVec2], wanted: &[[f64; 2]]) -> bool {
    found.len() == wanted.len() && found.iter().zip(wanted).all(|(p, q)| p.distance((*q).into()) < 1e-9)
}

#[test]
fn rooms_follow_the_wall_between_them() {
    let text = parted();
    let edits = moved(0.0, DVec2::new(0.5, 0.0));
    let written = enfilade_cad::patch("house.ifc", text.as_bytes(), &lower(), &edits, &[]).unwrap();
    let [west, east] = [WEST, EAST].map(|r| ring(&written, r));
    assert!(is_near(&west, &[[0.1, 0.1], [0.1, 5.9], [3.4, 0.1], [3.4, 5.9]]), "{west:?}");
    assert!(is_near(&east, &[[3.6, 0.1], [3.6, 5.9], [5.9, 0.1], [5.9, 5.9]]), "{east:?}");
    assert_eq!(ring(&written, SOUTH), ring(text.as_bytes(), SOUTH));
    let written = String::from_utf8(written).unwrap();
    let value = |id: u64| -> f64 {
        let line = written.lines().find(|l| l.starts_with(&format!("#{id}="))).unwrap();
        line.rsplit(',').next().unwrap().trim_end_matches(");").parse().unwrap()
    };
    // The area and the volume were those of the outline; the wall's area and the height were not.
    assert!((value(9220) - 3.3 * 5.8).abs() < 1e-9 && (value(9223) - 3.3 * 5.8 * 2.7).abs() < 1e-9);
    assert_eq!([value(9221), value(9222)], [46.0, 2.7]);
}

#[test]
fn what_does_not_follow_is_named() {
    let found = rooms(&parted(), &moved(0.0, DVec2::new(0.5, 0.0)));
    let [west, east, vault] = &found[..] else { panic!("{found:?}") };
    assert!(west.outlines.is_ok() && east.outlines.is_ok());
    assert_eq!((west.quantities.as_slice(), west.boundaries), (&["NetWallArea".to_owned()][..], 1));
    assert!(vault.outlines.as_ref().unwrap_err().contains("within its outline"), "{vault:?}");
    // A rectangle cannot follow a wall that turns; a polyline can.
    let turned = rooms(&parted(), &moved(0.05, DVec2::ZERO));
    assert!(turned[0].outlines.as_ref().unwrap_err().contains("no rectangle any more"));
    assert!(turned[1].outlines.is_ok());
    // Another wall bounds other rooms, and none is told where nothing moves.
    assert!(rooms(&parted(), &[]).is_empty());
}

#[test]
fn a_room_that_would_be_gone_stays() {
    let found = rooms(&parted(), &moved(0.0, DVec2::new(2.79, 0.0)));
    assert!(found[1].outlines.as_ref().unwrap_err().contains("would be gone"), "{found:?}");
    assert!(found[0].outlines.is_ok());
}

/// Two rooms that state one area: the one that follows states its own, and the other one nothing new.
#[test]
fn a_figure_that_rooms_share_stays_that_of_the_other_room() {
    let both = "#9324=IFCELEMENTQUANTITY('R000000000000000000324',$,'Base',$,$,(#9220,#9223));\n\
                #9325=IFCRELDEFINESBYPROPERTIES('R000000000000000000325',$,$,$,(#9300),#9324);\n";
    let text = with_instances(&parted(), both);
    let stated = |written: &str, set: u64| -> Vec<f64> {
        let line = |id: &str| written.lines().find(|l| l.starts_with(&format!("#{id}="))).unwrap().to_owned();
        let set = line(&set.to_string());
        let ids = set.rsplit('(').next().unwrap().trim_end_matches("));").split(',');
        let value =
            |id: &str| line(id.trim_start_matches('#')).rsplit(',').next().map(str::to_owned).unwrap();
        ids.map(|id| value(id).trim_end_matches(");").parse().unwrap()).collect()
    };
    let patched = |text: &str| {
        let edits = moved(0.0, DVec2::new(0.5, 0.0));
        let bytes = enfilade_cad::patch("house.ifc", text.as_bytes(), &lower(), &edits, &[]).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    let near = |found: &[f64], wanted: &[f64]| found.iter().zip(wanted).all(|(p, q)| (p - q).abs() < 1e-9);
    let written = patched(&text);
    let (west, east) = (stated(&written, 9224), stated(&written, 9324));
    assert!(near(&west, &[3.3 * 5.8, 46.0, 2.7, 3.3 * 5.8 * 2.7]), "{west:?}");
    assert!(near(&east, &[2.3 * 5.8, 2.3 * 5.8 * 2.7]), "{east:?}");
    // A set that both have stays, and its figures are named.
    let one = text.replace("(#9300),#9324", "(#9300),#9224");
    assert!(near(&stated(&patched(&one), 9224), &[16.24, 46.0, 2.7, 43.848]));
    for room in &rooms(&one, &moved(0.0, DVec2::new(0.5, 0.0)))[..2] {
        assert_eq!(room.quantities, ["NetFloorArea", "NetWallArea", "NetVolume"]);
    }
}
