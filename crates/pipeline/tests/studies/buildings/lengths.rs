//! IFC walls that change their length: by profile and axis, in place or in copies, with their openings where they were.

use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Mark, RigidMotion, Shape};
use enfilade_cad::ifc::{self, ReadOptions};
use enfilade_report::Report;
use glam::DVec2;

/// Lines of a file with one storey; walls hang at #7. `#33` to `#35`: a rectangle of 4 by 0.2 m round its middle.
fn file(data: &str) -> String {
    let head = "\
        #1=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n\
        #2=IFCUNITASSIGNMENT((#1));\n\
        #3=IFCCARTESIANPOINT((0.,0.,0.));\n\
        #4=IFCAXIS2PLACEMENT3D(#3,$,$);\n\
        #5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,$);\n\
        #6=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,(#5),#2);\n\
        #7=IFCLOCALPLACEMENT($,#4);\n\
        #8=IFCBUILDINGSTOREY('0000000000000000000002',$,'Ground',$,$,#7,$,$,.ELEMENT.,0.);\n\
        #9=IFCRELAGGREGATES('0000000000000000000003',$,$,$,#6,(#8));\n\
        #12=IFCDIRECTION((0.,0.,1.));\n";
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n\
         FILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{head}{data}\nENDSEC;\nEND-ISO-10303-21;\n"
    )
}

/// A wall of 4 by 0.2 m that starts at (1, 2) and runs north-east (3, 4 to 5), with an axis and a window from 1 to
/// 2 m; `#33` is its profile, `#37` its body.
fn wall(profile: &str) -> String {
    file(&format!(
        "#10=IFCWALL('0000000000000000000004',$,'W',$,$,#20,#30,'77',.SOLIDWALL.);\n\
         #11=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000005',$,$,$,(#10),#8);\n\
         #20=IFCLOCALPLACEMENT(#7,#21);\n\
         #21=IFCAXIS2PLACEMENT3D(#22,#12,#23);\n\
         #22=IFCCARTESIANPOINT((1.,2.,0.));\n\
         #23=IFCDIRECTION((0.6,0.8,0.));\n\
         #30=IFCPRODUCTDEFINITIONSHAPE($,$,(#31,#36));\n\
         #31=IFCSHAPEREPRESENTATION(#5,'Axis','Curve2D',(#32));\n\
         #32=IFCPOLYLINE((#38,#39));\n\
         #36=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#37));\n\
         #37=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n\
         #38=IFCCARTESIANPOINT((0.,0.));\n\
         #39=IFCCARTESIANPOINT((4.,0.));\n\
         #50=IFCOPENINGELEMENT('0000000000000000000006',$,'O',$,$,#51,#54,$,.OPENING.);\n\
         #51=IFCLOCALPLACEMENT(#20,#52);\n\
         #52=IFCAXIS2PLACEMENT3D(#53,$,$);\n\
         #53=IFCCARTESIANPOINT((1.5,0.,0.5));\n\
         #54=IFCPRODUCTDEFINITIONSHAPE($,$,(#55));\n\
         #55=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#56));\n\
         #56=IFCEXTRUDEDAREASOLID(#57,$,#12,2.);\n\
         #57=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,1.,0.6);\n\
         #58=IFCRELVOIDSELEMENT('0000000000000000000007',$,$,$,#10,#50);\n\
         #60=IFCWINDOW('0000000000000000000008',$,'F',$,$,#61,$,'78',1.,1.,$,$,$);\n\
         #61=IFCLOCALPLACEMENT(#51,#4);\n\
         #62=IFCRELFILLSELEMENT('0000000000000000000009',$,$,$,#50,#60);\n\
         {profile}"
    ))
}

const RECTANGLE: &str = "#33=IFCRECTANGLEPROFILEDEF(.AREA.,$,#34,4.,0.2);\n\
                         #34=IFCAXIS2PLACEMENT2D(#35,$);\n\
                         #35=IFCCARTESIANPOINT((2.,0.));\n";

/// Mitred at its second end, its first corner stated again at the end.
const RING: &str = "#33=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#34);\n\
                    #34=IFCPOLYLINE((#40,#41,#42,#43,#40));\n\
                    #40=IFCCARTESIANPOINT((0.,-0.1));\n\
                    #41=IFCCARTESIANPOINT((3.9,-0.1));\n\
                    #42=IFCCARTESIANPOINT((4.1,0.1));\n\
                    #43=IFCCARTESIANPOINT((0.,0.1));\n";

fn read(text: &str) -> Drawing {
    ifc::read("w.ifc", text.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap()
}

fn patched(text: &str, edits: &[Edit], own: &[Addition]) -> String {
    let bytes = ifc::patch("w.ifc", text.as_bytes(), &ReadOptions::default(), edits, own).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn corners(drawing: &Drawing, record: usize) -> Vec<DVec2> {
    let of = drawing.entities.iter().filter(|e| e.source.record == record);
    let points = of.flat_map(|e| match &e.shape {
        Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
        _ => Vec::new(),
    });
    points.collect()
}

/// Where the corners of a wall should stand after its ends went along it.
fn expected(drawing: &Drawing, record: usize, along: DVec2, by: [f64; 2]) -> Vec<DVec2> {
    let mut out = Vec::new();
    for e in drawing.entities.iter().filter(|e| e.source.record == record) {
        let Shape::Polyline { vertices, .. } = &e.shape else { continue };
        let Editable::Wall { ends, .. } = &e.editable else { panic!("{:?}", e.editable) };
        out.extend(vertices.iter().enumerate().map(|(c, v)| {
            let way = (0..2).filter(|k| ends[*k].contains(&(c as u32))).map(|k| by[k]).sum::<f64>();
            v.at + along * way
        }));
    }
    out
}

#[track_caller]
fn assert_at(found: &[DVec2], meant: &[DVec2]) {
    assert_eq!(found.len(), meant.len());
    let worst = found.iter().zip(meant).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{found:?}\n{meant:?}");
}

/// Lines of the old text that the new one has not.
fn changed<'t>(old: &'t str, new: &str) -> Vec<&'t str> {
    old.lines().filter(|l| !new.lines().any(|n| n == *l)).collect()
}

#[test]
fn a_wall_grows_at_either_end_and_its_window_stays() {
    let along = DVec2::new(0.6, 0.8);
    for profile in [RECTANGLE, RING] {
        let text = wall(profile);
        let before = read(&text);
        assert_eq!(corners(&before, 10).len(), 8, "two pieces beside the window");
        for by in [[-0.5, 0.0], [0.0, 0.75], [0.25, -0.5], [-1.0, 1.0]] {
            let after = patched(&text, &[Edit::Ends { record: 10, by }], &[]);
            let drawing = read(&after);
            assert_at(&corners(&drawing, 10), &expected(&before, 10, along, by));
            assert_at(&corners(&drawing, 60), &corners(&before, 60));
            let lines = changed(&text, &after);
            let is_shape = |l: &&str| l.contains("IFCCARTESIANPOINT((") || l.contains("RECTANGLE");
            assert!(lines.iter().all(is_shape) && lines.len() <= 6, "{lines:#?}");
            let axis = |t: &str, id: &str| t.lines().find(|l| l.starts_with(id)).unwrap().to_string();
            assert_eq!(axis(&after, "#38=") == axis(&text, "#38="), by[0] == 0.0);
            assert_eq!(axis(&after, "#39=") == axis(&text, "#39="), by[1] == 0.0);
        }
        let still = patched(&text, &[Edit::Ends { record: 10, by: [0.0; 2] }], &[]);
        assert_eq!(read(&still).entities, before.entities);
    }
}

/// A profile whose plane looks down, extruded upwards in the wall's frame, is as upright as any.
#[test]
fn a_wall_extruded_from_above_changes_its_length_too() {
    let along = DVec2::new(0.6, 0.8);
    for profile in [RECTANGLE, RING] {
        let down = "#97=IFCAXIS2PLACEMENT3D(#98,#99,#100);\n#98=IFCCARTESIANPOINT((4.,0.,3.));\n\
                    #99=IFCDIRECTION((0.,0.,-1.));\n#100=IFCDIRECTION((-1.,0.,0.));\n";
        let text = wall(&format!("{profile}{down}")).replace("(#33,#4,#12,3.)", "(#33,#97,#12,3.)");
        let before = read(&text);
        for by in [[-0.5, 0.0], [0.0, 0.75], [0.25, -0.5]] {
            let drawing = read(&patched(&text, &[Edit::Ends { record: 10, by }], &[]));
            assert_at(&corners(&drawing, 10), &expected(&before, 10, along, by));
        }
    }
}

#[test]
fn what_others_use_is_copied_with_its_style() {
    // A second wall on the same profile, and a third on the same shape.
    let more = "#70=IFCWALL('000000000000000000000A',$,'V',$,$,#71,#74,'79',.SOLIDWALL.);\n\
                #71=IFCLOCALPLACEMENT(#7,#4);\n\
                #74=IFCPRODUCTDEFINITIONSHAPE($,$,(#75));\n\
                #75=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#76));\n\
                #76=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n\
                #80=IFCWALL('000000000000000000000B',$,'U',$,$,#81,#30,'80',.SOLIDWALL.);\n\
                #81=IFCLOCALPLACEMENT(#7,#82);\n\
                #82=IFCAXIS2PLACEMENT3D(#83,$,$);\n\
                #83=IFCCARTESIANPOINT((0.,9.,0.));\n\
                #85=IFCRELCONTAINEDINSPATIALSTRUCTURE('000000000000000000000C',$,$,$,(#70,#80),#8);\n\
                #90=IFCSTYLEDITEM(#37,(#91),$);\n\
                #91=IFCSURFACESTYLE($,.BOTH.,(#92));\n\
                #92=IFCSURFACESTYLESHADING(#93,$);\n\
                #93=IFCCOLOURRGB($,1.,0.,0.);\n\
                #94=IFCPRESENTATIONLAYERASSIGNMENT('A-WALL',$,(#36,#75),$);\n";
    for profile in [RECTANGLE, RING] {
        let text = wall(&format!("{profile}{more}"));
        let before = read(&text);
        let by = [-0.5, 0.5];
        let after = patched(&text, &[Edit::Ends { record: 10, by }], &[]);
        let drawing = read(&after);
        assert_at(&corners(&drawing, 10), &expected(&before, 10, DVec2::new(0.6, 0.8), by));
        for other in [70, 80] {
            assert_at(&corners(&drawing, other), &corners(&before, other));
        }
        // Only the wall itself names another shape.
        assert_eq!(changed(&text, &after), [text.lines().find(|l| l.starts_with("#10=")).unwrap()]);
        let added: Vec<&str> = after.lines().filter(|l| !text.contains(l)).collect();
        let of = |class: &str| added.iter().filter(|l| l.contains(&format!("={class}("))).count();
        let styles = [of("IFCEXTRUDEDAREASOLID"), of("IFCSTYLEDITEM"), of("IFCPRESENTATIONLAYERASSIGNMENT")];
        assert_eq!(styles, [1, 1, 1], "{added:#?}");
    }
}

/// Of walls that share a shape, or a place, and all move, the last keeps it: a shape that shows nothing is against the schema.
#[test]
fn what_walls_share_that_all_move_is_left_to_the_last() {
    let more = "#80=IFCWALL('000000000000000000000B',$,'U',$,$,#81,#30,'80',.SOLIDWALL.);\n\
                #81=IFCLOCALPLACEMENT(#7,#82);\n\
                #82=IFCAXIS2PLACEMENT3D(#83,$,$);\n\
                #83=IFCCARTESIANPOINT((0.,9.,0.));\n\
                #70=IFCWALL('000000000000000000000A',$,'V',$,$,#81,#74,'79',.SOLIDWALL.);\n\
                #74=IFCPRODUCTDEFINITIONSHAPE($,$,(#31,#36));\n\
                #85=IFCRELCONTAINEDINSPATIALSTRUCTURE('000000000000000000000C',$,$,$,(#70,#80),#8);\n";
    let used = |text: &str, id: &str| {
        let names = |l: &str| [",", ")"].iter().any(|end| l.contains(&format!("{id}{end}")));
        text.lines().any(|l| !l.starts_with(&format!("{id}=")) && names(l))
    };
    let shift = |record: usize| {
        let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.3, 0.1) };
        Edit::Insert { record, motion }
    };
    for profile in [RECTANGLE, RING] {
        let text = wall(&format!("{profile}{more}"));
        let before = read(&text);
        let ways = [
            (10, DVec2::new(0.6, 0.8), [-0.5, 0.0]),
            (80, DVec2::X, [0.0, 0.5]),
            (70, DVec2::X, [-0.2, 0.1]),
        ];
        let edits: Vec<Edit> =
            ways.iter().map(|(record, _, by)| Edit::Ends { record: *record, by: *by }).collect();
        let after = patched(&text, &edits, &[]);
        let drawing = read(&after);
        for (record, along, by) in ways {
            assert_at(&corners(&drawing, record), &expected(&before, record, along, by));
        }
        for id in ["#30", "#31", "#36", "#74", "#37", "#33"] {
            assert!(used(&after, id), "{id} is left over:\n{after}");
        }
        let after = patched(&text, &[shift(70), shift(80)], &[]);
        assert!(used(&after, "#81") && used(&after, "#82"), "{after}");
        let drawing = read(&after);
        for record in [70, 80] {
            let meant: Vec<DVec2> =
                corners(&before, record).into_iter().map(|p| p + DVec2::new(0.3, 0.1)).collect();
            assert_at(&corners(&drawing, record), &meant);
        }
        let alone = read(&patched(&text, &[shift(70)], &[]));
        assert_at(&corners(&alone, 80), &corners(&before, 80));
    }
}

#[test]
fn a_wall_that_shifts_and_grows_is_told_once() {
    let text = wall(RECTANGLE);
    let (before, along) = (read(&text), DVec2::new(0.6, 0.8));
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.3, -0.2) };
    let by = [0.1, 0.2];
    let edits = [Edit::Insert { record: 10, motion }, Edit::Ends { record: 10, by }];
    let mark = Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false };
    let own = [Addition { layer: "EF-MOVED".into(), rgb: [0, 0, 0], mark }];
    let after = patched(&text, &edits, &own);
    let meant: Vec<DVec2> = expected(&before, 10, along, by).into_iter().map(|p| p + motion.shift).collect();
    assert_at(&corners(&read(&after), 10), &meant);
    let told =
        ["ShiftX", "FirstEndShift", "SecondEndShift"].map(|n| after.matches(&format!("'{n}'")).count());
    assert_eq!((told, after.matches("'Pset_Enfilade_Result'").count()), ([1, 1, 1], 1));
}

#[test]
fn what_is_not_certain_moves_as_a_whole_alone() {
    let with = |from: &str, to: &str| {
        let text = wall(RECTANGLE);
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let cases = [
        (with("#33=IFCRECTANGLEPROFILEDEF(", "#33=IFCROUNDEDRECTANGLEPROFILEDEF("), "cannot become longer"),
        (
            with("#39=IFCCARTESIANPOINT((4.,0.))", "#39=IFCCARTESIANPOINT((4.,0.5))"),
            "has no two sides along it",
        ),
        (
            with(
                "#12=IFCDIRECTION((0.,0.,1.));",
                "#12=IFCDIRECTION((0.,0.,1.));\n#96=IFCSHAPEASPECT((#55),$,$,.F.,#30);",
            ),
            "aspects of their own",
        ),
        (
            with("(#33,#4,#12,3.)", "(#33,#4,#97,3.)")
                .replace("#57=", "#97=IFCDIRECTION((0.1,0.,1.));\n#57="),
            "would not stay a plain extrusion",
        ),
    ];
    for (text, says) in cases {
        let mut report = Report::default();
        let drawing = ifc::read("w.ifc", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        let wall = drawing.entities.iter().find(|e| e.source.record == 10).unwrap();
        assert_eq!(wall.editable, Editable::WithInsert { turnable: true }, "{says}");
        let told = report.problems.iter().find(|p| p.code == "ifc-length").unwrap();
        assert!(told.text.starts_with("1 wall keeps its length") && told.text.contains(says), "{told}");
        let edits = [Edit::Ends { record: 10, by: [0.0, 0.5] }];
        let error = ifc::patch("w.ifc", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap_err();
        assert!(error.to_string().contains(says), "{says}: {error}");
    }
    let text = wall(RECTANGLE);
    let edits = [Edit::Ends { record: 10, by: [3.0, -2.0] }];
    let error = ifc::patch("w.ifc", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap_err();
    assert!(error.to_string().contains("nothing would be left of it"), "{error}");
}

/// The corners of a wall as a body of faces, 4 by 0.2 m, as high as said at both ends; mitred at its second end.
fn prism(high: [f64; 2]) -> [[f64; 3]; 8] {
    let ground = [[0.0, -0.1], [3.9, -0.1], [4.1, 0.1], [0.0, 0.1]];
    std::array::from_fn(|i| {
        let [x, y] = ground[i % 4];
        [x, y, if i < 4 { 0.0 } else { high[usize::from(x > 2.0)] }]
    })
}

/// Its faces, by their corners.
const FACES: [&[usize]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

/// The body `#37` in every way in which faces are written.
fn of_faces(high: [f64; 2]) -> Vec<String> {
    let corners = prism(high);
    let list = |of: &[usize]| of.iter().map(|i| (i + 1).to_string()).collect::<Vec<_>>().join(",");
    let rows: Vec<String> = corners.iter().map(|[x, y, z]| format!("({x:?},{y:?},{z:?})")).collect();
    let points = format!("#200=IFCCARTESIANPOINTLIST3D(({}));\n", rows.join(","));
    let triangles = FACES.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    let triangles: Vec<String> = triangles.map(|t| format!("({})", list(&t))).collect();
    let polygons: String = (FACES.iter().zip(210..))
        .map(|(f, i)| format!("#{i}=IFCINDEXEDPOLYGONALFACE(({}));\n", list(f)))
        .collect();
    let single: String =
        rows.iter().zip(220..).map(|(row, i)| format!("#{i}=IFCCARTESIANPOINT({row});\n")).collect();
    let named =
        |from: usize, n: usize| (from..from + n).map(|i| format!("#{i}")).collect::<Vec<_>>().join(",");
    let loops = FACES.iter().enumerate().map(|(k, f)| {
        let corners: Vec<String> = f.iter().map(|i| format!("#{}", 220 + i)).collect();
        let [a, b, c] = [230 + k, 240 + k, 250 + k];
        format!(
            "#{a}=IFCPOLYLOOP(({}));\n#{b}=IFCFACEOUTERBOUND(#{a},.T.);\n#{c}=IFCFACE((#{b}));\n",
            corners.join(",")
        )
    });
    let loops: String = loops.collect();
    vec![
        format!("{points}#37=IFCTRIANGULATEDFACESET(#200,$,.T.,({}),$);\n", triangles.join(",")),
        format!("{points}{polygons}#37=IFCPOLYGONALFACESET(#200,.T.,({}),$);\n", named(210, 6)),
        format!("{single}{loops}#201=IFCCLOSEDSHELL(({}));\n#37=IFCFACETEDBREP(#201);\n", named(250, 6)),
        format!(
            "{single}{loops}#201=IFCOPENSHELL(({}));\n#37=IFCSHELLBASEDSURFACEMODEL((#201));\n",
            named(250, 6)
        ),
    ]
}

/// The wall with another body.
fn with_body(body: &str) -> String {
    let text = wall(RECTANGLE);
    text.replace("#37=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n", body).replace("'SweptSolid'", "'Brep'")
}

/// Other ways to say what a wall is.
fn other_ways() -> Vec<String> {
    let with = |from: &str, to: &str| {
        let text = wall(RECTANGLE);
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    };
    let solid = "#37=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n";
    // As pieces of lines, one of them trimmed.
    let composite = "#33=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#34);\n\
                     #34=IFCCOMPOSITECURVE((#44,#45,#46),.F.);\n\
                     #44=IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#47);\n\
                     #45=IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#48);\n\
                     #46=IFCCOMPOSITECURVESEGMENT(.CONTINUOUS.,.T.,#49);\n\
                     #47=IFCTRIMMEDCURVE(#90,(IFCPARAMETERVALUE(0.)),(IFCPARAMETERVALUE(3.9)),.T.,.PARAMETER.);\n\
                     #90=IFCLINE(#212,#91);\n#212=IFCCARTESIANPOINT((0.,-0.1));\n#91=IFCVECTOR(#92,1.);\n#92=IFCDIRECTION((1.,0.));\n\
                     #48=IFCPOLYLINE((#41,#42));\n#49=IFCPOLYLINE((#42,#43,#40));\n";
    let points: String = RING.lines().filter(|l| !l.starts_with("#33") && !l.starts_with("#34")).collect();
    // Drawn from the side, and pushed through its thickness.
    let side = "#37=IFCEXTRUDEDAREASOLID(#93,#94,#12,0.2);\n#93=IFCRECTANGLEPROFILEDEF(.AREA.,$,#99,4.,3.);\n\
                #99=IFCAXIS2PLACEMENT2D(#202,$);\n#202=IFCCARTESIANPOINT((2.,1.5));\n\
                #94=IFCAXIS2PLACEMENT3D(#95,#96,#97);\n#95=IFCCARTESIANPOINT((0.,0.1,0.));\n\
                #96=IFCDIRECTION((0.,-1.,0.));\n#97=IFCDIRECTION((1.,0.,0.));\n";
    // Cut askew at its second end by an upright plane, and by one that is bounded by the whole wall.
    let cut = |tool: &str| {
        format!(
            "#37=IFCBOOLEANCLIPPINGRESULT(.DIFFERENCE.,#203,#204);\n#203=IFCEXTRUDEDAREASOLID(#33,#4,#12,3.);\n{tool}\
             #205=IFCPLANE(#206);\n#206=IFCAXIS2PLACEMENT3D(#207,#208,#12);\n\
             #207=IFCCARTESIANPOINT((3.7,0.,0.));\n#208=IFCDIRECTION((1.,1.,0.));\n"
        )
    };
    let bounded = "#204=IFCPOLYGONALBOUNDEDHALFSPACE(#205,.F.,#4,#209);\n\
                   #209=IFCPOLYLINE((#270,#271,#272,#273,#270));\n#270=IFCCARTESIANPOINT((-1.,-1.));\n\
                   #271=IFCCARTESIANPOINT((5.,-1.));\n#272=IFCCARTESIANPOINT((5.,1.));\n\
                   #273=IFCCARTESIANPOINT((-1.,1.));\n";
    let mut out = of_faces([3.0; 2]);
    out.extend([side.into(), cut("#204=IFCHALFSPACESOLID(#205,.F.);\n"), cut(bounded)]);
    let mut out: Vec<String> = out.iter().map(|body| with_body(body)).collect();
    out.extend([
        wall(&format!("{composite}{points}\n")),
        // Two layers, each with an aspect of its own.
        with("'SweptSolid',(#37))", "'SweptSolid',(#37,#98))").replace(
            "#57=",
            "#98=IFCEXTRUDEDAREASOLID(#33,#4,#12,0.2);\n#96=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#98));\n\
             #97=IFCSHAPEASPECT((#96),$,$,.F.,#30);\n#57=",
        ),
        with("'Axis'", "'FootPrint'"),
        with("#32=IFCPOLYLINE((#38,#39));", "#32=IFCPOLYLINE((#38,#213,#39));\n#213=IFCCARTESIANPOINT((2.,0.));"),
        with(solid, &format!("{solid}#211=IFCINDEXEDCOLOURMAP(#37,1.,$,(1));\n")),
    ]);
    out
}

#[test]
fn a_wall_grows_however_its_shape_is_written() {
    let along = DVec2::new(0.6, 0.8);
    for text in other_ways() {
        let before = read(&text);
        assert!(corners(&before, 10).len() >= 8, "two pieces beside the window: {text}");
        for by in [[-0.5, 0.0], [0.0, 0.75], [0.25, -0.5]] {
            let after = patched(&text, &[Edit::Ends { record: 10, by }], &[]);
            assert_at(&corners(&read(&after), 10), &expected(&before, 10, along, by));
            assert_eq!(after.lines().count(), text.lines().count(), "nothing is written anew:\n{after}");
        }
    }
}

#[test]
fn what_others_share_of_a_body_stays_theirs() {
    let other = "#280=IFCBUILDINGELEMENTPROXY('000000000000000000000P',$,'P',$,$,#281,#284,'80',$);\n\
                 #281=IFCLOCALPLACEMENT(#7,#282);\n#282=IFCAXIS2PLACEMENT3D(#283,#12,#23);\n\
                 #283=IFCCARTESIANPOINT((9.,2.,0.));\n#284=IFCPRODUCTDEFINITIONSHAPE($,$,(#285));\n\
                 #285=IFCSHAPEREPRESENTATION(#5,'Body','Brep',(#286));\n#286=IFCFACETEDBREP(#201);\n";
    let along = DVec2::new(0.6, 0.8);
    for body in of_faces([3.0; 2]).into_iter().skip(2).take(1) {
        let text = with_body(&format!("{body}{other}"));
        let before = read(&text);
        let after = patched(&text, &[Edit::Ends { record: 10, by: [0.0, 0.75] }], &[]);
        let drawing = read(&after);
        assert_at(&corners(&drawing, 10), &expected(&before, 10, along, [0.0, 0.75]));
        assert_at(&corners(&drawing, 280), &corners(&before, 280));
        // Of eight corners the four of one end are written anew, and no more.
        let points = |t: &str| t.matches("=IFCCARTESIANPOINT(").count();
        assert_eq!(points(&after), points(&text) + 4);
    }
}

#[test]
fn coverings_and_parts_grow_with_their_wall() {
    for relation in ["IFCRELCOVERSBLDGELEMENTS", "IFCRELAGGREGATES"] {
        let covering = format!(
            "#280={relation}('000000000000000000000P',$,$,$,#10,(#281));\n\
             #281=IFCCOVERING('000000000000000000000Q',$,'C',$,$,#282,#283,'80',$);\n\
             #282=IFCLOCALPLACEMENT(#20,#4);\n#283=IFCPRODUCTDEFINITIONSHAPE($,$,(#284));\n\
             #284=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#285));\n\
             #285=IFCEXTRUDEDAREASOLID(#286,#4,#12,3.);\n#286=IFCRECTANGLEPROFILEDEF(.AREA.,$,#287,4.,0.02);\n\
             #287=IFCAXIS2PLACEMENT2D(#288,$);\n#288=IFCCARTESIANPOINT((2.,-0.11));\n"
        );
        let text = wall(&[RECTANGLE, &covering].concat());
        let edits = [Edit::Ends { record: 10, by: [0.0, 0.75] }];
        let after = patched(&text, &edits, &[]);
        assert!(after.contains("#286=IFCRECTANGLEPROFILEDEF(.AREA.,$,#287,4.75,0.02)"), "{after}");
        assert!(after.contains("#288=IFCCARTESIANPOINT((2.375,-0.11))"), "{after}");
        let effects = ifc::effects("w.ifc", text.as_bytes(), &ReadOptions::default(), &edits).unwrap();
        assert_eq!(effects.moved[0].iter().map(|p| p.id).collect::<Vec<_>>(), [10, 281]);
    }
}

/// A wall with a pocket for a beam near its second end, which the cut at the height of the eyes does not show.
#[test]
fn no_end_passes_a_part_of_the_body_that_stays() {
    let body = "#33=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#90);\n\
                #90=IFCPOLYLINE((#91,#92,#93,#94,#95,#96,#97,#98,#91));\n\
                #91=IFCCARTESIANPOINT((0.,0.));\n#92=IFCCARTESIANPOINT((4.,0.));\n\
                #93=IFCCARTESIANPOINT((4.,3.));\n#94=IFCCARTESIANPOINT((3.5,3.));\n\
                #95=IFCCARTESIANPOINT((3.5,2.5));\n#96=IFCCARTESIANPOINT((3.2,2.5));\n\
                #97=IFCCARTESIANPOINT((3.2,3.));\n#98=IFCCARTESIANPOINT((0.,3.));\n\
                #99=IFCAXIS2PLACEMENT3D(#100,#101,#102);\n#100=IFCCARTESIANPOINT((0.,0.1,0.));\n\
                #101=IFCDIRECTION((0.,-1.,0.));\n#102=IFCDIRECTION((1.,0.,0.));\n";
    let text = wall(body).replace("(#33,#4,#12,3.)", "(#33,#99,#12,0.2)");
    let drawing = read(&text);
    let wall = drawing.entities.iter().find(|e| e.source.record == 10).unwrap();
    let Editable::Wall { free, .. } = wall.editable else { panic!("{:?}", wall.editable) };
    assert!((free[0] - 3.2).abs() < 1e-9 && (free[1] - 0.5).abs() < 1e-9, "{free:?}");
    let lengthened = |by: [f64; 2]| {
        let edits = [Edit::Ends { record: 10, by }];
        ifc::patch("w.ifc", text.as_bytes(), &ReadOptions::default(), &edits, &[])
    };
    assert!(lengthened([0.0, 2.0]).is_ok() && lengthened([0.0, -0.4]).is_ok());
    let refused = lengthened([0.0, -0.6]).unwrap_err().to_string();
    assert!(refused.contains("a part of its body that stays"), "{refused}");
}

/// What hangs on a door's wall goes once, whichever of several edits comes first.
#[test]
fn what_a_wall_carries_goes_once() {
    let text = wall(RECTANGLE);
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.3, 0.1) };
    let one = |record| Edit::Insert { record, motion };
    let alone = read(&patched(&text, &[one(10)], &[])).entities;
    for edits in [[one(10), one(60)], [one(60), one(10)]] {
        assert_eq!(read(&patched(&text, &edits, &[])).entities, alone);
    }
}

/// Figures that another length makes wrong are named, and how thick and high the wall is remains true.
#[test]
fn figures_of_another_length_are_named() {
    let stated = "#90=IFCQUANTITYLENGTH('Length',$,$,4.);\n#91=IFCQUANTITYLENGTH('Width',$,$,0.2);\n\
                  #92=IFCQUANTITYLENGTH('Height',$,$,3.);\n#93=IFCQUANTITYAREA('NetSideArea',$,$,10.);\n\
                  #94=IFCELEMENTQUANTITY('000000000000000000000T',$,'Base',$,$,(#90,#91,#92,#93));\n\
                  #95=IFCRELDEFINESBYPROPERTIES('000000000000000000000U',$,$,$,(#10),#94);\n";
    let text = wall(&[RECTANGLE, stated].concat());
    let named = |edits: &[Edit]| {
        let effects = ifc::effects("w.ifc", text.as_bytes(), &ReadOptions::default(), edits).unwrap();
        effects.figures.into_iter().map(|f| (f.id, f.names.join(", "))).collect::<Vec<_>>()
    };
    let longer = [Edit::Ends { record: 10, by: [0.0, 0.75] }];
    assert_eq!(named(&longer), [(10, "Length, NetSideArea".to_owned())]);
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.3, 0.1) };
    assert!(named(&[Edit::Insert { record: 10, motion }]).is_empty());
    let title = Mark::Text { at: DVec2::ZERO, height: 0.2, text: "t".into() };
    let own = Addition { layer: "EF-NOTE".into(), rgb: [0; 3], mark: title };
    assert!(patched(&text, &longer, &[own]).contains("'Stale',$,IFCTEXT('Length, NetSideArea')"));
}

#[test]
fn no_slope_of_a_roof_is_bent() {
    for body in of_faces([3.0, 2.0]) {
        let mut report = Report::default();
        let text = with_body(&body);
        ifc::read("w.ifc", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        let told = report.problems.iter().find(|p| p.code == "ifc-length").unwrap();
        assert!(told.text.contains("has a slope that would be bent"), "{told}");
    }
}

#[test]
fn an_end_that_an_opening_reaches_stays() {
    let text = wall(RECTANGLE).replace("((1.5,0.,0.5))", "((0.5,0.,0.5))");
    let drawing = read(&text);
    let wall = drawing.entities.iter().find(|e| e.source.record == 10).unwrap();
    let Editable::Wall { ends, .. } = &wall.editable else { panic!("{:?}", wall.editable) };
    assert!(ends[0].is_empty() && ends[1].len() == 2, "{ends:?}");
    assert_eq!(drawing.hosts.get(&60), Some(&10), "the file says in which wall the window sits");
}

/// Wall 70, 0.4 m high, 3 m long, which stands at right angles at the side of wall 10 with its first end.
const LOW: &str = "#70=IFCWALL('000000000000000000000L',$,'L',$,$,#71,#75,'79',.SOLIDWALL.);\n\
                   #71=IFCLOCALPLACEMENT(#7,#72);\n\
                   #72=IFCAXIS2PLACEMENT3D(#73,#12,#74);\n\
                   #73=IFCCARTESIANPOINT((2.28,3.54,0.));\n\
                   #74=IFCDIRECTION((0.8,-0.6,0.));\n\
                   #75=IFCPRODUCTDEFINITIONSHAPE($,$,(#83,#76));\n\
                   #83=IFCSHAPEREPRESENTATION(#5,'Axis','Curve2D',(#84));\n\
                   #84=IFCPOLYLINE((#85,#86));\n\
                   #85=IFCCARTESIANPOINT((0.,0.));\n\
                   #86=IFCCARTESIANPOINT((3.,0.));\n\
                   #76=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#77));\n\
                   #77=IFCEXTRUDEDAREASOLID(#78,#4,#12,0.4);\n\
                   #78=IFCRECTANGLEPROFILEDEF(.AREA.,$,#79,3.,0.2);\n\
                   #79=IFCAXIS2PLACEMENT2D(#80,$);\n\
                   #80=IFCCARTESIANPOINT((1.5,0.));\n\
                   #81=IFCRELCONNECTSPATHELEMENTS('000000000000000000000M',$,$,$,$,#10,#70,(),(),.ATSTART.,.ATPATH.);\n";

#[test]
fn walls_of_another_height_go_along() {
    let text = wall(&[RECTANGLE, LOW].concat());
    let shift = DVec2::new(0.3, -0.2);
    let by =
        |turn_rad: f64, shift: DVec2| Edit::Insert { record: 10, motion: RigidMotion { turn_rad, shift } };
    // Where the low wall stands after: seen by making it as high as the others.
    let high = |text: &str| text.replace("(#78,#4,#12,0.4)", "(#78,#4,#12,3.)");
    let after = |text: &str, edits: &[Edit]| corners(&read(&high(&patched(text, edits, &[]))), 70);
    let drawn = corners(&read(&high(&text)), 70);
    let along = DVec2::new(0.8, -0.6);
    let start = |p: &DVec2| (p - DVec2::new(2.28, 3.54)).dot(along) < 1.0;
    let shorter: Vec<DVec2> = drawn.iter().map(|p| if start(p) { p + along * 0.36 } else { *p }).collect();
    assert_at(&after(&text, &[by(0.0, shift)]), &shorter);
    // What covers it goes along, and is named.
    let covering = "#90=IFCRELCOVERSBLDGELEMENTS('000000000000000000000R',$,$,$,#70,(#91));\n\
                    #91=IFCCOVERING('000000000000000000000S',$,'C',$,$,#71,#92,$,$);\n\
                    #92=IFCPRODUCTDEFINITIONSHAPE($,$,(#76));\n";
    let covered = text.replace("#60=", &format!("{covering}#60="));
    let effects = ifc::effects("w.ifc", covered.as_bytes(), &ReadOptions::default(), &[by(0.0, shift)]);
    let ids: Vec<u64> = effects.unwrap().moved[0].iter().map(|p| p.id).collect();
    assert_eq!(ids, [10, 50, 60, 91, 70]);
    // Named with the wall that takes it, and every other instance stays.
    let effects = ifc::effects("w.ifc", text.as_bytes(), &ReadOptions::default(), &[by(0.0, shift)]).unwrap();
    assert!(effects.unseen.is_empty(), "the joint holds: {effects:?}");
    let ids: Vec<u64> = effects.moved[0].iter().map(|p| p.id).collect();
    assert_eq!(ids, [10, 50, 60, 70]);
    let told = |line: &&str| line.starts_with("#7") || line.starts_with("#8");
    let (old, new) = (text.clone(), patched(&text, &[by(0.0, shift)], &[]));
    let changed: Vec<&str> = old.lines().filter(told).filter(|l| !new.contains(l)).collect();
    assert_eq!(changed.len(), 3, "its rectangle, where that lies, its axis: {changed:?}");

    // What the file says of the joint is not needed: it stands there.
    for text in [
        text.replace("(),(),.ATSTART.,.ATPATH.", "(),(),.ATPATH.,.ATEND."),
        text.lines().filter(|l| !l.starts_with("#81=")).collect::<Vec<_>>().join("\n"),
    ] {
        assert_at(&after(&text, &[by(0.0, shift)]), &shorter);
    }

    let opening = "#82=IFCRELVOIDSELEMENT('000000000000000000000N',$,$,$,#70,#99);\n#60=";
    for (text, edit) in [
        (text.clone(), by(0.1, shift)),
        (text.clone(), by(0.0, along * 2.95)),
        (text.clone(), by(0.0, DVec2::new(0.6, 0.8))),
        (text.replace("((2.28,3.54,0.))", "((2.36,3.48,0.))"), by(0.0, shift)),
        (text.replace("#60=", opening), by(0.0, shift)),
        (text.replace("(#83,#76)", "(#76)"), by(0.0, shift)),
        (text.replace("#12,0.4)", "#12,1.6)"), by(0.0, shift)),
    ] {
        let seen = text.replace("(#78,#4,#12,1.6)", "(#78,#4,#12,0.4)");
        let drawn = corners(&read(&high(&seen)), 70);
        let found = corners(&read(&high(&patched(&text, &[edit], &[]).replace("#12,1.6)", "#12,0.4)"))), 70);
        assert_at(&found, &drawn);
    }
}
