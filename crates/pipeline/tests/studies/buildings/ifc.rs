//! IFC: bad input has a place and a reason, limits hold, and nothing but the moved walls changes.

use std::collections::BTreeMap;

use enfilade_cad::drawing::{Drawing, Edit, Editable, RigidMotion, Shape};
use enfilade_cad::ifc::{self, ReadOptions};
use enfilade_report::{Error, Report};
use glam::DVec2;

use crate::buildings::building;

/// One wall of 4 by 0.2 m; `data` adds to the instances or replaces those of the same number.
fn file(data: &str) -> String {
    let default = "\
        #1=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n\
        #2=IFCUNITASSIGNMENT((#1));\n\
        #3=IFCCARTESIANPOINT((0.,0.,0.));\n\
        #4=IFCAXIS2PLACEMENT3D(#3,$,$);\n\
        #5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,$);\n\
        #6=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,(#5),#2);\n\
        #7=IFCLOCALPLACEMENT($,#4);\n\
        #8=IFCBUILDINGSTOREY('0000000000000000000002',$,'Ground',$,$,#7,$,$,.ELEMENT.,0.);\n\
        #9=IFCRELAGGREGATES('0000000000000000000003',$,$,$,#6,(#8));\n\
        #10=IFCWALL('0000000000000000000004',$,'W',$,$,#20,#30,'77',.SOLIDWALL.);\n\
        #11=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000005',$,$,$,(#10),#8);\n\
        #12=IFCDIRECTION((0.,0.,1.));\n\
        #20=IFCLOCALPLACEMENT(#7,#4);\n\
        #30=IFCPRODUCTDEFINITIONSHAPE($,$,(#31));\n\
        #31=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#32));\n\
        #32=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n\
        #33=IFCRECTANGLEPROFILEDEF(.AREA.,$,#34,4.,0.2);\n\
        #34=IFCAXIS2PLACEMENT2D(#35,$);\n\
        #35=IFCCARTESIANPOINT((0.,0.));\n";
    let number = |line: &str| line.split('=').next().unwrap_or_default().trim().to_string();
    let own: Vec<String> = data.lines().map(number).collect();
    let kept: Vec<&str> = default.lines().filter(|l| !own.contains(&number(l))).collect();
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{}\n{data}\nENDSEC;\nEND-ISO-10303-21;\n",
        kept.join("\n")
    )
}

fn read(text: &str) -> Result<(Drawing, Vec<String>), Error> {
    let mut report = Report::default();
    let drawing = ifc::read("w.ifc", text.as_bytes(), &ReadOptions::default(), &mut report)?;
    Ok((drawing, report.problems.iter().map(ToString::to_string).collect()))
}

/// What is said of a file that can be read.
fn said(data: &str) -> String {
    read(&file(data)).unwrap().1.join("\n")
}

/// What is said of a file that cannot.
fn refused(text: &str) -> String {
    read(text).unwrap_err().to_string()
}

fn walls(text: &str) -> usize {
    read(text).unwrap().0.entities.iter().filter(|e| e.layer == "IfcWall").count()
}

#[track_caller]
fn assert_says(said: &str, words: &[&str]) {
    for word in words {
        assert!(said.contains(word), "{word:?} is not in:\n{said}");
    }
}

#[test]
fn a_plain_wall_is_read() {
    let (drawing, said) = read(&file("")).unwrap();
    let wall = drawing.entities.iter().find(|e| e.layer == "IfcWall").unwrap();
    let Shape::Polyline { vertices, closed: true } = &wall.shape else { panic!("{:?}", wall.shape) };
    let (lo, hi) = vertices.iter().fold((DVec2::MAX, DVec2::MIN), |b, v| (b.0.min(v.at), b.1.max(v.at)));
    assert!(lo.distance(DVec2::new(-2.0, -0.1)) < 1e-9 && hi.distance(DVec2::new(2.0, 0.1)) < 1e-9);
    assert_eq!(wall.source.handle.as_deref(), Some("0000000000000000000004"));
    assert!(!said.iter().any(|s| s.contains("warning")), "{said:?}");
}

#[test]
fn placements_in_a_ring_are_named_and_long_chains_end() {
    let ring = said(
        "#20=IFCLOCALPLACEMENT(#21,#4);\n#21=IFCLOCALPLACEMENT(#22,#4);\n#22=IFCLOCALPLACEMENT(#20,#4);",
    );
    assert_says(&ring, &["w.ifc:", "#10 IfcWall", "#20>#21>#22>#20"]);
    let chain = |n: usize| -> String {
        let link = |i: usize| format!("#{}=IFCLOCALPLACEMENT(#{},#4);", 1000 + i, 1001 + i);
        let mut lines: Vec<String> = (0..n).map(link).collect();
        lines.push(format!("#{}=IFCLOCALPLACEMENT($,#4);", 1000 + n));
        lines.push("#20=IFCLOCALPLACEMENT(#1000,#4);".into());
        lines.join("\n")
    };
    assert_eq!(walls(&file(&chain(ifc::PLACEMENT_CHAIN_MAX - 10))), 1);
    assert_says(&said(&chain(ifc::PLACEMENT_CHAIN_MAX + 10)), &["more than 1000 placements", "left out"]);
    assert_eq!(walls(&file(&chain(200_000))), 0);
}

#[test]
fn damaged_instances_have_their_line_and_the_rest_is_read() {
    assert_says(&said("#40=IFCDIRECTION((0.,0.,1.);"), &["w.ifc:27", "left out"]);
    assert_says(
        &refused(&file("#40=IFCLABEL('no end);")),
        &["w.ifc:27", "closing quote", "nothing was done"],
    );
    assert_says(&said("#20=IFCLOCALPLACEMENT(#7,#999);"), &["#999", "does not exist", "left out"]);
    assert_says(&said("#4=IFCAXIS2PLACEMENT3D(#3,#40,$);\n#40=IFCDIRECTION((0.,0.,0.));"), &["no length"]);
    assert_eq!(walls(&file("").replace("IFCWALL(", "ifcwall(")), 1, "keywords in small letters");
    let twice = file("").replace("#35=", "#34=IFCAXIS2PLACEMENT2D(#35,$);\n#35=");
    let (drawing, said) = read(&twice).unwrap();
    assert_says(&said.join("\n"), &["#34 is given 2 times", "nothing can be moved"]);
    assert!(drawing.entities.iter().all(|e| matches!(e.editable, Editable::No(_))));
}

#[test]
fn nesting_is_bounded() {
    let nested = |n: usize| format!("#40=IFCLABEL({}1.{});", "(".repeat(n), ")".repeat(n));
    assert!(!said(&nested(ifc::NESTING_MAX - 1)).contains("nested"));
    assert_says(
        &said(&nested(ifc::NESTING_MAX + 2)),
        &["#40", "nested"].map(|w| if w == "#40" { "w.ifc:" } else { w }),
    );
    assert_says(&said(&nested(200_000)), &["nested"]);
}

#[test]
fn bodies_inside_bodies_end() {
    let clipped = |n: usize| -> String {
        let mut lines = vec![
            "#31=IFCSHAPEREPRESENTATION(#5,'Body','Clipping',(#1000));".to_string(),
            "#40=IFCPLANE(#41);".into(),
            "#41=IFCAXIS2PLACEMENT3D(#42,$,$);".into(),
            "#42=IFCCARTESIANPOINT((0.,0.,2.9));".into(),
            "#43=IFCHALFSPACESOLID(#40,.F.);".into(),
        ];
        let of = |i: usize| if i + 1 == n { "#32".to_string() } else { format!("#{}", 1001 + i) };
        lines.extend(
            (0..n).map(|i| format!("#{}=IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,{},#43);", 1000 + i, of(i))),
        );
        lines.join("\n")
    };
    assert_eq!(walls(&file(&clipped(5))), 1);
    assert_says(&said(&clipped(ifc::BODY_DEPTH_MAX + 5)), &["nested deeper than 200"]);
}

#[test]
fn outlines_and_faces_are_bounded() {
    let outline = |n: usize| -> String {
        let at = |i: usize| std::f64::consts::TAU * i as f64 / n as f64;
        let points: Vec<String> = (0..n)
            .map(|i| format!("#{}=IFCCARTESIANPOINT(({:.6},{:.6}));", 1000 + i, at(i).cos(), at(i).sin()))
            .collect();
        let refs: Vec<String> = (0..n).map(|i| format!("#{}", 1000 + i)).collect();
        format!(
            "{}\n#40=IFCPOLYLINE(({},#1000));\n#33=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#40);",
            points.join("\n"),
            refs.join(",")
        )
    };
    assert_eq!(walls(&file(&outline(100))), 1);
    assert_says(
        &said(&outline(ifc::OUTLINE_POINTS_MAX + 1)),
        &["corners, expected at most 20000", "left out"],
    );
    let faces = |n: usize| -> String {
        let list = vec!["(1,2,3)"; n].join(",");
        format!(
            "#31=IFCSHAPEREPRESENTATION(#5,'Body','Tessellation',(#40));\n\
             #40=IFCTRIANGULATEDFACESET(#41,$,.T.,({list}),$);\n\
             #41=IFCCARTESIANPOINTLIST3D(((0.,0.,0.),(4.,0.,0.),(0.,0.,3.)));"
        )
    };
    assert_says(&said(&faces(ifc::FACES_MAX + 1)), &["more than 400000 faces"]);
}

#[test]
fn schemas_and_other_files_are_told_apart() {
    for schema in ["IFC2X3", "IFC4", "IFC4X3_ADD2"] {
        assert_eq!(walls(&file("").replace("'IFC4'", &format!("'{schema}'"))), 1, "{schema}");
    }
    assert_says(
        &refused(&file("").replace("'IFC4'", "'AP214'")),
        &["AP214", "expected IFC2X3, IFC4 or IFC4X3"],
    );
    assert_says(&refused("<?xml version=\"1.0\"?><ifcXML/>"), &["XML", "export as IFC"]);
    let whole = file("");
    for cut in [whole.len() / 3, whole.len() / 2, whole.len() - 8] {
        assert_says(&refused(&whole[..cut]), &["w.ifc", "nothing was done"]);
        assert_ne!(ifc::completeness(&whole.as_bytes()[..cut]), ifc::Incomplete::No);
    }
}

/// A ZIP archive of one stored file that states any sizes.
fn zip(name: &str, data: &[u8], packed: u32, unpacked: u32) -> Vec<u8> {
    let mut crc = flate2::Crc::new();
    crc.update(data);
    let sizes = [crc.sum().to_le_bytes(), packed.to_le_bytes(), unpacked.to_le_bytes()].concat();
    let names = [(name.len() as u16).to_le_bytes(), 0u16.to_le_bytes()].concat();
    let mut out =
        [b"PK\x03\x04".as_slice(), &[20, 0, 0, 0, 0, 0, 0, 0, 0, 0], &sizes, &names, name.as_bytes(), data]
            .concat();
    let directory = out.len() as u32;
    let tail = [0u8; 14];
    out.extend(
        [b"PK\x01\x02".as_slice(), &[20, 0, 20, 0, 0, 0, 0, 0, 0, 0, 0, 0], &sizes, &names, &tail[..10]]
            .concat(),
    );
    out.extend(0u32.to_le_bytes());
    out.extend(name.as_bytes());
    let size = out.len() as u32 - directory;
    out.extend(
        [
            b"PK\x05\x06".as_slice(),
            &[0, 0, 0, 0, 1, 0, 1, 0],
            &size.to_le_bytes(),
            &directory.to_le_bytes(),
            &[0, 0],
        ]
        .concat(),
    );
    out
}

#[test]
fn archives_are_unpacked_within_limits() {
    let text = file("");
    let n = text.len() as u32;
    assert_eq!(ifc::unzip("w.ifczip", &zip("w.ifc", text.as_bytes(), n, n)).unwrap(), text.as_bytes());
    let says = |packed: u32, unpacked: u32| {
        ifc::unzip("w.ifczip", &zip("w.ifc", text.as_bytes(), packed, unpacked)).unwrap_err().to_string()
    };
    let mut flipped = zip("w.ifc", text.as_bytes(), n, n);
    flipped[60] ^= 1;
    let damaged = ifc::unzip("w.ifczip", &flipped).unwrap_err().to_string();
    assert_says(&damaged, &["w.ifc is damaged", "checksum"]);
    assert_says(&says(n, (ifc::UNZIPPED_MAX + 1) as u32), &["expected at most 2147483648 bytes"]);
    assert_says(&says(n, n * (ifc::ZIP_RATIO_MAX as u32 + 1) + (1 << 20)), &["200 times"]);
    let other = ifc::unzip("w.ifczip", &zip("readme.txt", b"", 0, 0)).unwrap_err().to_string();
    assert_says(&other, &["found 0 .ifc files", "expected one"]);
    assert!(ifc::unzip("w.ifczip", b"PK\x03\x04").is_err());
}

fn house() -> (String, Drawing) {
    let text = building::ifc(&building::house());
    let drawing =
        ifc::read("house.ifc", text.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap();
    (text, drawing)
}

fn ring_of(drawing: &Drawing, record: usize, layer: &str) -> Vec<DVec2> {
    let of = drawing.entities.iter().filter(|e| e.source.record == record && e.layer == layer);
    let points = of.flat_map(|e| match &e.shape {
        Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
        _ => Vec::new(),
    });
    points.collect()
}

#[test]
fn a_moved_wall_takes_its_door_and_the_room_beside_it_along_and_nothing_else_changes() {
    let (text, before) = house();
    let number = |line: &str| line.split_once('=').map(|l| l.0.to_string());
    let wall = text.lines().find(|l| l.contains("'Store'")).and_then(number).unwrap();
    let record: usize = wall.trim_start_matches('#').parse().unwrap();
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(350.0, 0.0) };
    let edits = [Edit::Insert { record, motion }];
    let after = ifc::patch("house.ifc", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap();
    let after = String::from_utf8(after).unwrap();
    let lines = |t: &str| -> BTreeMap<String, String> {
        t.lines().filter_map(|l| Some((number(l)?, l.to_string()))).filter(|l| l.0.starts_with('#')).collect()
    };
    let (old, new) = (lines(&text), lines(&after));
    let changed: Vec<&String> = old.iter().filter(|(k, v)| new.get(*k) != Some(v)).map(|(_, v)| v).collect();
    // Where it stands, and the two corners of the room at it.
    assert_eq!(changed.len(), 3, "{changed:#?}");
    let drawing =
        ifc::read("house.ifc", after.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap();
    let door = |d: &Drawing| -> usize {
        let doors: Vec<_> = d.entities.iter().filter(|e| e.layer == "IfcDoor").collect();
        let inner = |e: &&&enfilade_cad::drawing::Entity| match &e.shape {
            Shape::Polyline { vertices, .. } => vertices.iter().all(|v| v.at.y > 1000.0),
            _ => false,
        };
        doors.iter().find(inner).unwrap().source.record
    };
    for (record, layer) in [(record, "IfcWall"), (door(&before), "IfcDoor")] {
        let (was, is) = (ring_of(&before, record, layer), ring_of(&drawing, record, layer));
        assert_eq!(was.len(), is.len());
        let is_shifted = was.iter().zip(&is).all(|(p, q)| (*q - *p).distance(DVec2::new(350.0, 0.0)) < 1e-6);
        assert!(is_shifted, "{layer}: {was:?} {is:?}");
    }
    let others = |d: &Drawing| -> Vec<Vec<DVec2>> {
        let still =
            d.entities.iter().filter(|e| e.source.record != record && e.source.record != door(&before));
        let still = still.filter(|e| e.layer != "IfcSpace");
        still.map(|e| ring_of(d, e.source.record, &e.layer)).collect()
    };
    assert_eq!(others(&before), others(&drawing));
}

#[test]
fn a_wall_on_a_shared_point_moves_alone() {
    let data = "#15=IFCWALL('0000000000000000000006',$,'V',$,$,#21,#30,'78',.SOLIDWALL.);\n\
                #11=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000005',$,$,$,(#10,#15),#8);\n\
                #21=IFCLOCALPLACEMENT(#7,#4);";
    let text = file(data);
    let motion = RigidMotion { turn_rad: 0.3, shift: DVec2::new(1.0, 2.0) };
    let edits = [Edit::Insert { record: 10, motion }];
    let after = ifc::patch("w.ifc", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap();
    let (drawing, _) = read(&String::from_utf8(after).unwrap()).unwrap();
    let (before, _) = read(&text).unwrap();
    assert_eq!(ring_of(&drawing, 15, "IfcWall"), ring_of(&before, 15, "IfcWall"));
    let go = |p: &DVec2| DVec2::from_angle(0.3).rotate(*p) + DVec2::new(1.0, 2.0);
    let (was, is) = (ring_of(&before, 10, "IfcWall"), ring_of(&drawing, 10, "IfcWall"));
    assert!(was.iter().map(go).zip(&is).all(|(p, q)| p.distance(*q) < 1e-9), "{was:?} {is:?}");
}

#[test]
fn no_edit_is_no_change() {
    let (text, _) = house();
    let same = ifc::patch("house.ifc", text.as_bytes(), &ReadOptions::default(), &[], &[]).unwrap();
    assert_eq!(same, text.as_bytes());
}

#[test]
fn a_storey_that_is_not_there_is_told_with_those_that_are() {
    let options = ReadOptions { storey: Some("Attic".into()), ..ReadOptions::default() };
    let fault = ifc::read("w.ifc", file("").as_bytes(), &options, &mut Report::default()).unwrap_err();
    assert_says(&fault.to_string(), &["Attic", "\"Ground\""]);
}

#[test]
fn an_instance_longer_than_any_is_left_out() {
    let text = format!("#40=IFCLABEL('{}');", "x".repeat(ifc::INSTANCE_BYTES_MAX));
    let (drawing, said) = read(&file(&text)).unwrap();
    assert_says(&said.join("\n"), &["w.ifc:27", "left out"]);
    assert!(drawing.entities.iter().any(|e| e.layer == "IfcWall"));
}
