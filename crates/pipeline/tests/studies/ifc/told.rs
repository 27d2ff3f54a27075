//! What is said of elements that cannot be read, and on which storey: two storeys of four walls each.

use super::*;

/// A wall whose body, profile or direction is not what it should be.
pub(super) struct Broken {
    /// Instances that replace those of the wall, `$` for its number.
    data: &'static str,
    /// What is said.
    says: &'static str,
}

/// Two storeys, 3 m high, of four walls of 6 m each; of those with a number in `broken` the instances are others.
pub(super) fn house(broken: &[(u64, &Broken)]) -> String {
    let mut data = String::from(
        "#1=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n#2=IFCUNITASSIGNMENT((#1));\n\
         #3=IFCCARTESIANPOINT((0.,0.,0.));\n#4=IFCAXIS2PLACEMENT3D(#3,$,$);\n\
         #5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,$);\n\
         #6=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,(#5),#2);\n#7=IFCLOCALPLACEMENT($,#4);\n\
         #8=IFCDIRECTION((0.,0.,1.));\n#9=IFCDIRECTION((0.,1.,0.));\n#11=IFCCARTESIANPOINT((0.,0.));\n\
         #12=IFCCARTESIANPOINT((6.,0.));\n#13=IFCPOLYLINE((#11,#12));\n#14=IFCCARTESIANPOINT((3.,0.));\n\
         #15=IFCAXIS2PLACEMENT2D(#14,$);\n#16=IFCMATERIALLAYER($,0.2,$);\n#17=IFCMATERIALLAYERSET((#16),$);\n\
         #18=IFCMATERIALLAYERSETUSAGE(#17,.AXIS2.,.POSITIVE.,-0.1);\n",
    );
    let mut all = Vec::new();
    for (k, name) in ["Lower", "Upper"].iter().enumerate() {
        let (s, z) = (50 + 10 * k as u64, 3.0 * k as f64);
        data += &format!(
            "#{}=IFCCARTESIANPOINT((0.,0.,{z:?}));\n#{}=IFCAXIS2PLACEMENT3D(#{},$,$);\n\
             #{}=IFCLOCALPLACEMENT($,#{});\n\
             #{s}=IFCBUILDINGSTOREY('S00000000000000000000{k}',$,'{name}',$,$,#{},$,$,.ELEMENT.,{z:?});\n",
            s + 1,
            s + 2,
            s + 1,
            s + 3,
            s + 2,
            s + 3
        );
        let ids: Vec<u64> = (0..4).map(|i| 100 * (1 + 4 * k as u64 + i)).collect();
        for (w, (x, y, along)) in
            ids.iter().zip([(0.0, 0.0, "$"), (0.0, 6.0, "$"), (0.0, 0.0, "#9"), (6.0, 0.0, "#9")])
        {
            let own = format!(
                "#{w}=IFCWALL('W00000000000000000{w:04}',$,'w{w}',$,$,#$3,#$4,$,$);\n\
                 #$1=IFCCARTESIANPOINT(({x:?},{y:?},0.));\n#$2=IFCAXIS2PLACEMENT3D(#$1,#8,{along});\n\
                 #$3=IFCLOCALPLACEMENT(#{},#$2);\n#$4=IFCPRODUCTDEFINITIONSHAPE($,$,(#$5,#$6));\n\
                 #$5=IFCSHAPEREPRESENTATION(#5,'Axis','Curve2D',(#13));\n\
                 #$6=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#$7));\n\
                 #$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,3.);\n#$8=IFCRECTANGLEPROFILEDEF(.AREA.,$,#15,6.,0.2);\n",
                s + 3
            );
            let mut lines: Vec<String> = own.lines().map(String::from).collect();
            for (_, other) in broken.iter().filter(|b| b.0 == *w) {
                for line in other.data.lines() {
                    let key = |l: &str| l.split('=').next().unwrap().to_string();
                    lines.retain(|l| key(l) != key(line));
                    lines.extend(line.contains("=IFC").then(|| line.to_string()));
                }
            }
            data +=
                &lines.iter().map(|l| format!("{}\n", l.replace("#$", &format!("#{w}")))).collect::<String>();
        }
        let list: Vec<String> = ids.iter().map(|w| format!("#{w}")).collect();
        all.push(format!(
            "#{}=IFCRELASSOCIATESMATERIAL('M00000000000000000000{k}',$,$,$,({}),#18);\n",
            s + 5,
            list.join(",")
        ));
        all.push(format!(
            "#{}=IFCRELCONTAINEDINSPATIALSTRUCTURE('R00000000000000000000{k}',$,$,$,({}),#{s});\n",
            s + 4,
            list.join(",")
        ));
    }
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{data}{}ENDSEC;\nEND-ISO-10303-21;\n",
        all.concat()
    )
}

/// Each way in which a body can be unreadable beside an axis that is not.
const WAYS: [Broken; 6] = [
    Broken { data: "#$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,-3.);", says: "IFCEXTRUDEDAREASOLID has no depth" },
    Broken { data: "#$8=", says: "8 does not exist" },
    Broken { data: "#$7=IFCSURFACECURVESWEPTAREASOLID(#$8,$);", says: "is a kind of body that is not read" },
    Broken { data: "#$8=IFCRECTANGLEPROFILEDEF(.AREA.,$,#15,6.,0.);", says: "has no width or no length" },
    Broken { data: "#$6=", says: "6, named as a representation in #" },
    Broken { data: "#$8=IFCCENTERLINEPROFILEDEF(.AREA.,$,#13,0.2);", says: "is a profile that is not read" },
];

fn check(text: &str) -> enfilade_pipeline::Outcome<enfilade_overlay::result::CheckResult> {
    let input = Input::new("house.ifc", text.as_bytes(), 1);
    enfilade_pipeline::check(&input, &Settings::new(Partial::default()).unwrap()).unwrap()
}

/// A wall that is taken from its axis is told where it stands, on the storey that is shown or on another, and nowhere else.
#[test]
fn a_wall_taken_from_its_axis_is_told_on_its_own_storey() {
    assert!(!check(&house(&[])).report.is_degraded());
    for way in &WAYS {
        for (wall, is_shown) in [(200, true), (600, false)] {
            let text = house(&[(wall, way)]);
            let line = text.lines().position(|l| l.starts_with(&format!("#{wall}="))).unwrap() + 1;
            let done = check(&text);
            let of = |problems: &[enfilade_overlay::result::ProblemEntry]| -> Vec<String> {
                let told = problems.iter().filter(|p| p.code == "ifc-axis" && p.text.contains(way.says));
                told.map(|p| format!("{} {} {}", p.severity, p.place, p.text)).collect()
            };
            let [lower, upper] = [&done.result.problems, &done.result.storeys[1].problems].map(|p| of(p));
            let (own, other) = if is_shown { (lower, upper) } else { (upper, lower) };
            assert_eq!((own.len(), other.len()), (1, 0), "{} {own:?} {other:?}", way.data);
            for part in [
                format!("warning house.ifc:{line} #{wall} IfcWall W"),
                "taken from its axis and layers, 0.2 m thick".into(),
            ] {
                assert!(own[0].contains(&part), "{part}: {own:?}");
            }
            assert!(!own[0].contains("left out"), "{own:?}");
            assert!(done.report.is_degraded(), "{}", way.data);
            let walls = done.result.storeys.iter().map(|s| s.walls).collect::<Vec<_>>();
            assert_eq!(walls, [4, 4], "{}", way.data);
        }
    }
}

/// Without an axis the wall is missing: its own storey says so, the other one only that it may be missing there.
#[test]
fn a_wall_that_is_missing_is_missed_on_its_own_storey() {
    let bare = Broken { data: "#$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,-3.);\n#$5=", says: "" };
    for (wall, own) in [(200, 0), (600, 1)] {
        let text = house(&[(wall, &bare)]);
        for storey in [0, 1] {
            let name = ["Lower", "Upper"][storey];
            let options = ReadOptions { storey: Some(name.into()), ..ReadOptions::default() };
            let (drawing, report) = read_with(text.as_bytes(), &options);
            let count = |code: &str| report.problems.iter().filter(|p| p.code == code).count();
            let codes = (count("ifc-element"), count("ifc-other-storey"));
            assert_eq!(codes, if storey == own { (1, 0) } else { (0, 1) }, "{name} {:?}", report.problems);
            assert_eq!(on(&drawing.unwrap(), "IfcWall").len(), if storey == own { 3 } else { 4 });
        }
        let said = check(&text).report.problems;
        let warned: Vec<String> =
            said.iter().filter(|p| p.code == "ifc-element").map(ToString::to_string).collect();
        assert_eq!(warned.len(), 1, "{warned:?}");
        assert_eq!(warned[0].contains("storey \"Upper\": "), own == 1, "{warned:?}");
    }
}

/// An opening that cannot be read leaves its wall closed there, which the wall says.
#[test]
fn an_opening_that_cannot_be_read_is_told() {
    let hole = "#900=IFCOPENINGELEMENT('O000000000000000000001',$,'gap',$,$,#2003,#901,$,$);\n\
         #901=IFCPRODUCTDEFINITIONSHAPE($,$,(#902));\n\
         #902=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#903));\n\
         #903=IFCEXTRUDEDAREASOLID(#904,$,#8,2.);\n#904=IFCRECTANGLEPROFILEDEF(.AREA.,$,#15,1.,1.);\n\
         #905=IFCRELVOIDSELEMENT('V000000000000000000001',$,$,$,#200,#900);\n";
    let told = |from: &str, to: &str| {
        let data = hole.replace(from, to);
        let text = house(&[]).replace("ENDSEC;\nEND-ISO", &format!("{data}ENDSEC;\nEND-ISO"));
        let (drawing, report) = read_with(text.as_bytes(), &ReadOptions::default());
        let said: Vec<String> = report.problems.iter().map(ToString::to_string).collect();
        (on(&drawing.unwrap(), "IfcOpeningElement").len(), said.join("\n"))
    };
    let (gaps, said) = told("", "");
    assert!(gaps > 0 && !said.contains("its opening"), "{gaps} {said}");
    for (from, to, why) in [
        ("#901=IFCPRODUCTDEFINITIONSHAPE($,$,(#902));\n", "", "901"),
        (
            "IFCEXTRUDEDAREASOLID(#904,$,#8,2.)",
            "IFCSURFACECURVESWEPTAREASOLID(#904,$)",
            "a kind of body that is not read",
        ),
        ("#2003,#901", "#2003,$", "it has no shape"),
    ] {
        let (gaps, said) = told(from, to);
        assert_eq!(gaps, 0, "{said}");
        let line = said.lines().find(|l| l.contains("#200 IfcWall")).unwrap_or_default();
        assert!(line.contains("its opening #900: ") && line.contains(why), "{said}");
    }
}

/// A storey of footings below one that begins 1 m above it: a cut at eye height would show the other one's walls.
#[test]
fn a_storey_of_footings_does_not_show_the_one_above() {
    let low = Broken { data: "#$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,0.8);", says: "" };
    let bare = Broken { data: "#$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,-3.);\n#$5=", says: "" };
    let lowered = |last: &Broken| {
        let text = house(&[(100, &low), (200, &low), (300, &low), (400, last)]);
        let above = "#61=IFCCARTESIANPOINT((0.,0.,3.0));";
        assert!(text.contains(above));
        text.replace(above, &above.replace("3.0", "1.0"))
    };
    let text = lowered(&low);
    let done = check(&text);
    let said = done.result.storeys[0].problem.clone().unwrap_or_default();
    for part in [
        "its own walls end at 0.80 m and do not reach the cut at 1.50 m",
        "what stands there is of \"Upper\", whose floor is at 1.00 m",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    assert_eq!((done.result.storeys[0].walls, done.result.storeys[1].walls), (0, 4));
    assert_eq!(done.result.storeys[1].folder.as_deref(), Some("."), "what is shown where none is named");
    let walls = |text: &str, sight: ifc::Sight| {
        let options = ReadOptions { storey: Some("Lower".into()), sight, ..ReadOptions::default() };
        read_with(text.as_bytes(), &options).0.map(|d| on(&d, "IfcWall").len()).map_err(|e| e.to_string())
    };
    assert!(walls(&text, ifc::Sight::Eye).unwrap_err().contains("--storey \"Upper\" shows that one"));
    assert_eq!(walls(&text, ifc::Sight::Knee), Ok(4), "below the other storey");
    // Of a wall that cannot be read nobody knows how high it is.
    assert!(walls(&lowered(&bare), ifc::Sight::Eye).is_ok());
    // Where the own walls reach the cut both storeys are shown: a split level.
    let split = Broken { data: "#$7=IFCEXTRUDEDAREASOLID(#$8,$,#8,2.);", says: "" };
    assert!(walls(&lowered(&split), ifc::Sight::Eye).is_ok());
}

/// Numbers that no program could read, in front of an instance and within one.
#[test]
fn a_number_too_large_is_called_so() {
    let text = house(&[]);
    let said =
        "a number after `#` of 19 digits or more, expected at most 4611686018427387902; export the file";
    let largest = ifc::INSTANCE_MAX.to_string();
    assert!(said.contains(&largest));
    let last = text.replace("#1008=", &format!("#{largest}=")).replace("(#1008,", &format!("(#{largest},"));
    let (_, report) = read_with(last.as_bytes(), &ReadOptions::default());
    assert!(!report.is_degraded(), "{:?}", report.problems);
    for large in ["4611686018427387903", "18446744073709551616", "99999999999999999999999999"] {
        let (_, report) =
            read_with(text.replace("#1008=", &format!("#{large}=")).as_bytes(), &ReadOptions::default());
        assert!(report.problems.iter().any(|p| p.text.contains(said)), "{large} {:?}", report.problems);
    }
    let within = text.replace("(#1008,", "(#99999999999999999999999999,");
    let (_, report) = read_with(within.as_bytes(), &ReadOptions::default());
    assert!(report.problems.iter().any(|p| p.text.contains(said)), "{:?}", report.problems);
}

/// Sizes and places of an archive that stand in records of ZIP64.
#[test]
fn sizes_as_zip64_are_called_so() {
    let plain = zipped(house(&[]).as_bytes(), None);
    let at = |mark: &[u8]| plain.windows(4).rposition(|w| w == mark).unwrap();
    let (entry, end) = (at(b"PK\x01\x02"), at(b"PK\x05\x06"));
    for (place, len, says) in [
        (entry + 20, 4, "with its sizes as ZIP64"),
        (entry + 24, 4, "with its sizes as ZIP64"),
        (end + 10, 2, "with its directory as ZIP64"),
        (end + 16, 4, "with its directory as ZIP64"),
    ] {
        let mut bytes = plain.clone();
        bytes[place..place + len].fill(0xff);
        let error = read_with(&bytes, &ReadOptions::default()).0.unwrap_err().to_string();
        assert!(error.contains(says) && error.contains("unpack it and take the .ifc inside"), "{error}");
    }
}

#[test]
fn marks_that_contradict_each_other_are_told() {
    let text = pavilion();
    let [a, b] = ["screen-1", "screen-2"].map(|n| named(&text, n));
    let space = text.split('\n').find(|l| l.contains("=IFCSPACE(")).unwrap();
    let space: usize = space[1..].split('=').next().unwrap().parse().unwrap();
    let set = |id: usize, values: &[(&str, &str)], of: &[usize]| {
        let property = |(i, (name, value)): (usize, &(&str, &str))| {
            format!("#{}=IFCPROPERTYSINGLEVALUE('{name}',$,{value},$);\n", id + 2 + i)
        };
        let own: String = values.iter().enumerate().map(property).collect();
        let list = |ids: Vec<usize>| ids.iter().map(|i| format!("#{i}")).collect::<Vec<_>>().join(",");
        let properties = list((0..values.len()).map(|i| id + 2 + i).collect());
        let of = list(of.to_vec());
        format!(
            "{own}#{id}=IFCPROPERTYSET('S{id}',$,'Pset_Enfilade',$,({properties}));\n\
             #{}=IFCRELDEFINESBYPROPERTIES('D{id}',$,$,$,({of}),#{id});\n",
            id + 1
        )
    };
    let told = |added: &str| -> Vec<String> {
        let (drawing, report) = read_with(with_instances(&text, added).as_bytes(), &ReadOptions::default());
        drawing.unwrap();
        report.problems.into_iter().filter(|p| p.code == "ifc-marks").map(|p| p.to_string()).collect()
    };
    assert_eq!(told(""), Vec::<String>::new());
    let label = |v: &str| format!("IFCLABEL('{v}')");
    let shared = set(90000, &[("Move", &label("x -2 2"))], &[a, b]);
    let twice = told(&shared);
    assert_eq!(twice.len(), 2, "{twice:?}");
    assert!(
        twice[0].contains("states move twice") && twice[0].contains("\"x -2 2\" in #90000; the last counts")
    );
    let kept = told(&set(90000, &[("Keep", "IFCBOOLEAN(.T.)")], &[a, b]));
    assert!(kept.len() == 2 && kept[0].contains("both Move and Keep; it stays"), "{kept:?}");
    assert_eq!(told(&set(90000, &[("Keep", "IFCBOOLEAN(.F.)")], &[a])), Vec::<String>::new());
    let idle = told(&set(90000, &[("Query", "IFCBOOLEAN(.T.)")], &[a]));
    assert!(idle.len() == 1 && idle[0].contains("states query of an IfcWall"), "{idle:?}");
    let idle = told(&set(90000, &[("Move", &label("x -2 2"))], &[space]));
    assert!(idle.len() == 1 && idle[0].contains("states move of an IfcSpace"), "{idle:?}");
    let both =
        |id: usize, way: &str, of: usize| set(id, &[("Name", &label("both")), ("Move", &label(way))], &[of]);
    let named = told(&(both(90000, "x -2 2", a) + &both(90010, "y -1 1", b)));
    assert!(named.iter().any(|t| t.contains("are both named \"both\"")), "{named:?}");
    let alike = told(&(both(90000, "x -2 2", a) + &both(90010, "x -2 2", b)));
    assert!(!alike.iter().any(|t| t.contains("are both named")), "{alike:?}");
}
