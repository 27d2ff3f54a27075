//! Walls of other storeys at a wall that moves: they go along where they stand at it, and what opens is told.

use enfilade_overlay::result::{ElementRef, RoundResult};

use super::told::house;
use super::*;

/// A house of two storeys with a wall (9000) across the middle of both that slides, and on the lower storey a spur (9100)
/// of 2 m that starts `from` metres east of that wall and is joined to it `as stated`. With a door in the wall, low down.
fn spurred(from: f64, way: f64, stated: &str, opening: &str) -> String {
    let data = format!(
        "#9000=IFCWALL('W000000000000000009000',$,'tall',$,$,#9003,#9004,$,$);\n\
         #9001=IFCCARTESIANPOINT((3.,0.1,0.));\n#9002=IFCAXIS2PLACEMENT3D(#9001,#8,#9);\n\
         #9003=IFCLOCALPLACEMENT(#53,#9002);\n#9004=IFCPRODUCTDEFINITIONSHAPE($,$,(#9006));\n\
         #9006=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9007));\n\
         #9007=IFCEXTRUDEDAREASOLID(#9008,$,#8,5.8);\n#9008=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9009,4.,0.2);\n\
         #9009=IFCAXIS2PLACEMENT2D(#9010,$);\n#9010=IFCCARTESIANPOINT((2.,0.));\n\
         #9100=IFCWALL('W000000000000000009100',$,'spur',$,$,#9103,#9104,'T9100',$);\n\
         #9101=IFCCARTESIANPOINT(({from:?},3.,0.));\n#9102=IFCAXIS2PLACEMENT3D(#9101,#8,#9111);\n\
         #9103=IFCLOCALPLACEMENT(#53,#9102);\n#9104=IFCPRODUCTDEFINITIONSHAPE($,$,(#9105,#9106));\n\
         #9105=IFCSHAPEREPRESENTATION(#5,'Axis','Curve2D',(#9112));\n#9112=IFCPOLYLINE((#11,#9113));\n\
         #9113=IFCCARTESIANPOINT((2.,0.));\n#9111=IFCDIRECTION(({way:?},0.,0.));\n\
         #9106=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9107));\n\
         #9107=IFCEXTRUDEDAREASOLID(#9108,$,#8,2.8);\n#9108=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9109,2.,0.2);\n\
         #9109=IFCAXIS2PLACEMENT2D(#9110,$);\n#9110=IFCCARTESIANPOINT((1.,0.));\n\
         #9120=IFCRELCONTAINEDINSPATIALSTRUCTURE('R000000000000000000009',$,$,$,(#9000,#9100),#50);\n\
         #9121=IFCRELCONNECTSPATHELEMENTS('R000000000000000000010',$,$,$,$,#9000,#9100,(),(),{stated},.ATPATH.);\n\
         #9122=IFCPROPERTYSINGLEVALUE('Move',$,IFCLABEL('x -0.5m 0.5m'),$);\n\
         #9123=IFCPROPERTYSET('R000000000000000000011',$,'Pset_Enfilade',$,(#9122));\n\
         #9124=IFCRELDEFINESBYPROPERTIES('R000000000000000000012',$,$,$,(#9000),#9123);\n\
         #9130=IFCOPENINGELEMENT('W000000000000000009130',$,$,$,$,#9131,#9134,$,$);\n\
         #9131=IFCLOCALPLACEMENT(#9003,#9132);\n#9132=IFCAXIS2PLACEMENT3D(#9133,$,$);\n\
         #9133=IFCCARTESIANPOINT((1.,0.,0.));\n#9134=IFCPRODUCTDEFINITIONSHAPE($,$,(#9135));\n\
         #9135=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9136));\n\
         #9136=IFCEXTRUDEDAREASOLID(#9137,$,#8,2.);\n#9137=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,0.9,0.4);\n\
         #9138=IFCRELVOIDSELEMENT('R000000000000000000013',$,$,$,#9000,#9130);\n\
         #9139=IFCDOOR('W000000000000000009139',$,'door',$,$,#9140,$,$,2.,0.9,$,$,$);\n\
         #9140=IFCLOCALPLACEMENT(#9131,#4);\n\
         #9141=IFCRELFILLSELEMENT('R000000000000000000014',$,$,$,#9130,#9139);\n{opening}"
    );
    with_instances(&house(&[]), &data)
}

fn run(text: &str) -> enfilade_pipeline::Outcome<RoundResult> {
    let with = Partial {
        storey: Some("Upper".into()),
        evaluations: Some(20),
        spacing: Some(0.5),
        seed: Some(2),
        members: Some(1),
        objective: Some("degree max 0.01".into()),
        penalty: Some("none".into()),
        // Joints may open here: the report must name them.
        allow: Some("open-joints, crossings, things, narrow-ways".into()),
        ..Partial::default()
    };
    let silent = &mut |_| ();
    let (input, settings) = (Input::new("house.ifc", text.as_bytes(), 1), Settings::new(with).unwrap());
    enfilade_pipeline::run(&input, &settings, std::time::Instant::now(), silent, &Cancel::default()).unwrap()
}

fn told(done: &enfilade_pipeline::Outcome<RoundResult>) -> Vec<String> {
    let opened = done.report.problems.iter().filter(|p| p.code == "joint-opens");
    opened.map(ToString::to_string).collect()
}

#[test]
fn an_unseen_wall_follows_by_the_end_that_stands_at_the_wall() {
    // The file names the right end, the wrong one, and the right one of a wall drawn the other way round.
    for (from, way, stated) in [(3.1, 1.0, ".ATSTART."), (3.1, 1.0, ".ATEND."), (5.1, -1.0, ".ATEND.")] {
        let done = run(&spurred(from, way, stated, ""));
        assert_eq!(told(&done), [""; 0]);
        let option = &done.result.candidates[0];
        let is_spur =
            |e: &ElementRef| serde_json::to_string(e).is_ok_and(|t| t.contains("W000000000000000009100"));
        let own: Vec<_> = option.changes.iter().filter(|c| is_spur(&c.element)).collect();
        assert_eq!(own.len(), 1, "named once, by itself: {:?}", option.changes);
        let ElementRef::Ifc { id: 9100, .. } = own[0].element else { panic!("{:?}", own[0]) };
        assert_eq!(own[0].host_id.as_deref(), Some("T9100"));
        let span = |at: &[[f64; 2]]| {
            let xs = at.iter().map(|p| p[0]);
            [xs.clone().fold(f64::INFINITY, f64::min), xs.fold(f64::NEG_INFINITY, f64::max)]
        };
        let (was, is) = (span(&own[0].from), span(&own[0].to));
        assert_eq!(was.map(|v| (v * 1e6).round()), [3_100_000.0, 5_100_000.0]);
        let tall = option.changes.iter().find(|c| !is_spur(&c.element)).unwrap();
        let by = tall.to[0][0] - tall.from[0][0];
        assert!(
            by.abs() > 0.05 && (is[0] - was[0] - by).abs() < 1e-6 && is[1] == was[1],
            "{by} {was:?} {is:?}"
        );
        assert!(option.words.contains("layer IfcDoor; 1 of them not shown in this plan"), "{}", option.words);
        let unseen = " One wall that this plan does not show (storey Lower) changes its length too.";
        assert!(option.words.contains(unseen), "{}", option.words);
    }
}

#[test]
fn a_joint_with_an_unseen_wall_that_stays_is_told() {
    // A wall that is cut by an opening cannot follow; one that stands elsewhere is joined by the file's word alone.
    let cut = "#9150=IFCOPENINGELEMENT('W000000000000000009150',$,$,$,$,$,$,$,$);\n\
               #9151=IFCRELVOIDSELEMENT('R000000000000000000015',$,$,$,#9100,#9150);\n";
    let gap = told(&run(&spurred(3.1, 1.0, ".ATSTART.", cut)));
    assert_eq!(gap.len(), 1, "{gap:?}");
    for part in [
        "IfcWall",
        "in option 1 it",
        "the wall #9100 on storey \"Lower\" (not shown in this plan; it stays)",
        "0.",
    ] {
        assert!(gap[0].contains(part), "{part}: {gap:?}");
    }
    let apart = spurred(3.5, 1.0, ".ATSTART.", "");
    let told = told(&run(&apart));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].contains("no end of either is found at the other") && told[0].contains("may open"),
        "{told:?}"
    );
    let shift = [shift(9000, 0.45, 0.0)];
    let options = ifc::ReadOptions { storey: Some("Upper".into()), ..ifc::ReadOptions::default() };
    let after = ifc::patch("house.ifc", apart.as_bytes(), &options, &shift, &[]).unwrap();
    assert!(String::from_utf8(after).unwrap().contains(",#9109,2.,0.2)"), "it keeps its length");
}

/// A wall of 1 m by 0.2 m on the lower storey, northwards from a place.
fn standing_at(x: f64, y: f64) -> String {
    format!(
        "#9200=IFCWALL('W000000000000000009200',$,'tail',$,$,#9203,#9204,$,$);\n\
         #9201=IFCCARTESIANPOINT(({x:?},{y:?},0.));\n#9202=IFCAXIS2PLACEMENT3D(#9201,#8,#9);\n\
         #9203=IFCLOCALPLACEMENT(#53,#9202);\n#9204=IFCPRODUCTDEFINITIONSHAPE($,$,(#9206));\n\
         #9206=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9207));\n\
         #9207=IFCEXTRUDEDAREASOLID(#9208,$,#8,2.8);\n#9208=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9209,1.,0.2);\n\
         #9209=IFCAXIS2PLACEMENT2D(#9210,$);\n#9210=IFCCARTESIANPOINT((0.5,0.));\n\
         #9220=IFCRELCONTAINEDINSPATIALSTRUCTURE('R000000000000000000020',$,$,$,(#9200),#50);\n"
    )
}

/// No end of a wall that is not shown is drawn back behind a wall that stands at it, nor through one, nor moved at all
/// where a mark keeps it.
#[test]
fn an_unseen_wall_that_is_barred_or_kept_stays() {
    let keep = "#9230=IFCPROPERTYSINGLEVALUE('Keep',$,IFCBOOLEAN(.T.),$);\n\
                #9231=IFCPROPERTYSET('R000000000000000000021',$,'Pset_Enfilade',$,(#9230));\n\
                #9232=IFCRELDEFINESBYPROPERTIES('R000000000000000000022',$,$,$,(#9100),#9231);\n";
    let options = ifc::ReadOptions { storey: Some("Upper".into()), ..ifc::ReadOptions::default() };
    for (by, with, stays) in [
        (0.45, String::new(), false),
        (-0.45, String::new(), false),
        (0.45, keep.into(), true),
        (0.45, standing_at(3.4, 3.1), true),
        (-0.45, standing_at(3.4, 3.1), false),
        (-0.45, standing_at(2.8, 2.5), true),
        (0.45, standing_at(2.8, 2.5), false),
        (0.45, standing_at(4.5, 3.1), false),
    ] {
        let text = spurred(3.1, 1.0, ".ATSTART.", &with);
        let after = ifc::patch("house.ifc", text.as_bytes(), &options, &[shift(9000, by, 0.0)], &[]).unwrap();
        let is_kept = String::from_utf8(after).unwrap().contains(",#9109,2.,0.2)");
        assert_eq!(is_kept, stays, "{by} {with}");
    }
}

/// As many programs write them: without `IfcRelConnectsPathElements`.
#[test]
fn an_unseen_wall_that_stands_at_the_wall_follows_without_a_stated_joint() {
    let options = ifc::ReadOptions { storey: Some("Upper".into()), ..ifc::ReadOptions::default() };
    let unstated = |from: f64, way: f64, with: &str| {
        let text = spurred(from, way, ".ATSTART.", with);
        text.lines().filter(|l| !l.starts_with("#9121=")).collect::<Vec<_>>().join("\n")
    };
    for (from, way, follows) in [(3.1, 1.0, true), (5.1, -1.0, true), (3.5, 1.0, false)] {
        let text = unstated(from, way, "");
        let after =
            ifc::patch("house.ifc", text.as_bytes(), &options, &[shift(9000, 0.45, 0.0)], &[]).unwrap();
        let is_shorter = String::from_utf8(after).unwrap().contains(",1.55,0.2)");
        assert_eq!(is_shorter, follows, "{from} {way}");
        assert_eq!(told(&run(&text)), [""; 0], "{from} {way}");
    }
    let cut = "#9150=IFCOPENINGELEMENT('W000000000000000009150',$,$,$,$,$,$,$,$);\n\
               #9151=IFCRELVOIDSELEMENT('R000000000000000000015',$,$,$,#9100,#9150);\n";
    let told = told(&run(&unstated(3.1, 1.0, cut)));
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].contains("the wall #9100 on storey \"Lower\" (not shown in this plan; it stays)"),
        "{told:?}"
    );
}

/// A space of the lower storey, `from` to `to` along x and 2 m wide, with marks.
fn space(from: f64, to: f64, mark: &str) -> String {
    format!(
        "#9300=IFCSPACE('W000000000000000009300',$,'K',$,$,#9303,#9304,$,.ELEMENT.,.INTERNAL.,$);\n\
         #9301=IFCCARTESIANPOINT(({from:?},2.,0.));\n#9302=IFCAXIS2PLACEMENT3D(#9301,$,$);\n\
         #9303=IFCLOCALPLACEMENT(#53,#9302);\n#9304=IFCPRODUCTDEFINITIONSHAPE($,$,(#9306));\n\
         #9306=IFCSHAPEREPRESENTATION(#5,'Body','SweptSolid',(#9307));\n\
         #9307=IFCEXTRUDEDAREASOLID(#9308,$,#8,2.8);\n\
         #9308=IFCRECTANGLEPROFILEDEF(.AREA.,$,#9309,{:?},2.);\n\
         #9309=IFCAXIS2PLACEMENT2D(#9310,$);\n#9310=IFCCARTESIANPOINT(({:?},1.));\n\
         #9320=IFCRELAGGREGATES('R000000000000000000030',$,$,$,#50,(#9300));\n\
         #9321=IFCPROPERTYSINGLEVALUE('{mark}',$,IFCBOOLEAN(.T.),$);\n\
         #9322=IFCPROPERTYSET('R000000000000000000031',$,'Pset_Enfilade',$,(#9321));\n\
         #9323=IFCRELDEFINESBYPROPERTIES('R000000000000000000032',$,$,$,(#9300),#9322);\n",
        to - from,
        (to - from) / 2.0
    )
}

/// Nothing inside a space that a mark keeps moves, whether or not the cut shows it, and the joint that opens is told.
#[test]
fn an_unseen_wall_in_a_kept_space_stays() {
    let options = ifc::ReadOptions { storey: Some("Upper".into()), ..ifc::ReadOptions::default() };
    for (from, to, mark, stays) in [
        (3.1, 5.5, "Keep", true),
        (2.8, 5.5, "Keep", true),
        (3.1, 5.5, "Query", false),
        (4.0, 5.5, "Keep", false),
    ] {
        let text = spurred(3.1, 1.0, ".ATSTART.", &space(from, to, mark));
        let after =
            ifc::patch("house.ifc", text.as_bytes(), &options, &[shift(9000, 0.45, 0.0)], &[]).unwrap();
        let is_kept = String::from_utf8(after).unwrap().contains(",#9109,2.,0.2)");
        assert_eq!(is_kept, stays, "{from} {to} {mark}");
        let shifted = [shift(9000, 0.45, 0.0)];
        let effects = ifc::effects("house.ifc", text.as_bytes(), &options, &shifted).unwrap();
        assert_eq!(effects.unseen.iter().any(|u| u.other == 9100), stays, "{from} {to} {mark}");
    }
}

/// The same house and wall, with the wish to move stated of a low wall instead.
fn marked_unseen(storey: u64, key: &str) -> String {
    let text = spurred(3.1, 1.0, ".ATSTART.", &standing_at(1.5, 2.0));
    let text =
        text.replace("(#9000),#9123", "(#9200),#9123").replace("(#9200),#50", &format!("(#9200),#{storey}"));
    text.replace("IFCPROPERTYSINGLEVALUE('Move'", key)
}

/// Nobody who marks a wall means all the others, also where the plan does not show that wall or the mark is not read.
#[test]
fn a_wish_to_move_that_the_plan_does_not_show_is_told_and_holds_the_others() {
    let as_stated = "IFCPROPERTYSINGLEVALUE('Move'";
    let low = Partial { storey: Some("Lower".into()), ..Partial::default() };
    let high = Partial { storey: Some("Upper".into()), ..Partial::default() };
    for (text, with, code, says) in [
        (
            marked_unseen(60, as_stated),
            &high,
            "ifc-marks",
            "states move of it, and nothing of it of storey \"Upper\" is shown",
        ),
        (
            marked_unseen(50, as_stated),
            &high,
            "marks-elsewhere",
            "on storey \"Lower\", which this plan does not show: --storey \"Lower\" takes it",
        ),
        (
            marked_unseen(50, "IFCPROPERTYSINGLEVALUE('Moves'"),
            &low,
            "ifc-marks",
            "says \"moves\", expected one of Move,",
        ),
        (
            marked_unseen(50, "IFCPROPERTYSINGLEVALUE('Shift'"),
            &low,
            "ifc-marks",
            "says \"shift\", expected one of Move,",
        ),
        (
            marked_unseen(50, "IFCPROPERTYLISTVALUE('Move'"),
            &low,
            "ifc-marks",
            "states Move as IFCPROPERTYLISTVALUE, expected",
        ),
    ] {
        let settings = Settings::new(with.clone()).unwrap();
        let done = enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &settings).unwrap();
        let told: Vec<String> =
            done.report.problems.iter().filter(|p| p.code == code).map(ToString::to_string).collect();
        let line = text.lines().position(|l| l.starts_with("#9200=")).unwrap() + 1;
        assert!(
            told.iter().any(|t| t.contains(says) && t.contains(&format!("house.ifc:{line} "))),
            "{says}: {told:?} {:?}",
            done.report
        );
        assert!(done.result.moves.is_empty(), "{says}: {:?}", done.result.moves);
        assert!(done.report.problems.iter().all(|p| p.code != "default-moves"), "{says}");
        let is_fault = code == "ifc-marks";
        assert_eq!(done.report.problems.iter().any(|p| p.code == "moves-unread"), is_fault, "{says}");
    }
    // What is marked elsewhere for looking alone holds nothing.
    let asks = marked_unseen(50, "IFCPROPERTYSINGLEVALUE('Quary'");
    let settings = Settings::new(low.clone()).unwrap();
    let done = enfilade_pipeline::check(
        &Input::new("house.ifc", asks.replace("x -0.5m 0.5m", "hall").as_bytes(), 1),
        &settings,
    );
    let done = done.unwrap();
    assert!(done.report.problems.iter().any(|p| p.text.contains("says \"quary\", expected one of")));
    assert!(done.report.problems.iter().any(|p| p.code == "default-moves"), "{:?}", done.report);
}

/// Two walls of one name and one move, of which the plan shows one.
#[test]
fn a_partner_that_the_plan_does_not_show_is_named() {
    let named = "#9240=IFCPROPERTYSINGLEVALUE('Name',$,IFCLABEL('pair'),$);\n";
    let text = spurred(3.1, 1.0, ".ATSTART.", &(standing_at(1.5, 2.0) + named));
    let text = text.replace("(#9000),#9123", "(#9000,#9200),#9123").replace("(#9122));", "(#9122,#9240));");
    let with = Partial { storey: Some("Upper".into()), ..Partial::default() };
    let done =
        enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &Settings::new(with).unwrap())
            .unwrap();
    let told: Vec<String> =
        done.report.problems.iter().filter(|p| p.code == "ifc-marks").map(ToString::to_string).collect();
    assert!(told.len() == 1 && told[0].contains("#9200 IfcWall"), "{told:?}");
    assert!(
        told[0].contains("named \"pair\" by Pset_Enfilade as #9000 is, and stands on storey \"Lower\""),
        "{told:?}"
    );
    assert!(!done.result.moves.is_empty());
}

/// What a type says holds for its elements, unless these say something else.
#[test]
fn marks_of_a_type_hold_for_its_elements() {
    let of_type = "#9250=IFCWALLTYPE('W000000000000000009250',$,'T',$,$,(#9123),$,$,$,.STANDARD.);\n\
                   #9251=IFCRELDEFINESBYTYPE('R000000000000000000040',$,$,$,(#9000),#9250);\n";
    let other = "#9260=IFCPROPERTYSINGLEVALUE('Move',$,IFCLABEL('x -0.2m 0m'),$);\n\
                 #9261=IFCPROPERTYSET('R000000000000000000041',$,'Pset_Enfilade',$,(#9260));\n\
                 #9262=IFCRELDEFINESBYPROPERTIES('R000000000000000000042',$,$,$,(#9000),#9261);\n";
    for (with, lower) in [(of_type.to_owned(), -0.5), (format!("{of_type}{other}"), -0.2)] {
        let text = spurred(3.1, 1.0, ".ATSTART.", &with);
        let text: String =
            text.lines().filter(|l| !l.starts_with("#9124=")).map(|l| format!("{l}\n")).collect();
        let with = Partial { storey: Some("Upper".into()), ..Partial::default() };
        let done = enfilade_pipeline::check(
            &Input::new("house.ifc", text.as_bytes(), 1),
            &Settings::new(with).unwrap(),
        )
        .unwrap();
        let moves: Vec<(String, f64)> = done.result.moves.iter().map(|m| (m.name.clone(), m.lower)).collect();
        assert_eq!(moves.len(), 1, "{moves:?} {:?}", done.report);
        assert_eq!(moves[0].1, lower);
        assert!(done.report.problems.iter().all(|p| p.code != "ifc-marks"), "{:?}", done.report);
    }
}

/// What is no wall would not move anyway.
#[test]
fn a_mark_that_keeps_what_is_no_wall_is_told() {
    let keep = "#9230=IFCPROPERTYSINGLEVALUE('Keep',$,IFCBOOLEAN(.T.),$);\n\
                #9231=IFCPROPERTYSET('R000000000000000000021',$,'Pset_Enfilade',$,(#9230));\n\
                #9232=IFCRELDEFINESBYPROPERTIES('R000000000000000000022',$,$,$,(#9200),#9231);\n";
    let text = spurred(3.1, 1.0, ".ATSTART.", &(standing_at(1.5, 2.0) + keep));
    let text = text.replace("#9200=IFCWALL(", "#9200=IFCMEMBER(");
    let with = Partial { storey: Some("Lower".into()), ..Partial::default() };
    let done =
        enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &Settings::new(with).unwrap())
            .unwrap();
    let told = done.report.problems.iter().filter(|p| p.code == "ifc-marks").map(ToString::to_string);
    let told: Vec<String> = told.collect();
    assert!(
        told.len() == 1 && told[0].contains("IfcMember") && told[0].contains("it is no wall of this plan"),
        "{told:?}"
    );
}

/// Axis and outline as lists of points, as IFC4 has them, and placements on their head: read and written back.
#[test]
fn ends_follow_whatever_says_how_long_a_wall_is() {
    let options = ifc::ReadOptions { storey: Some("Upper".into()), ..ifc::ReadOptions::default() };
    let axis = "#9112=IFCINDEXEDPOLYCURVE(#9114,$,.F.);\n#9114=IFCCARTESIANPOINTLIST2D(((0.,0.),(2.,0.)));\n";
    let by_index = axis
        .replace("#9114,$,", "#9114,(IFCLINEINDEX((2,1))),")
        .replace("(0.,0.),(2.,0.)", "(2.,0.),(0.,0.)");
    let outline = "#9108=IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#9115);\n\
                   #9115=IFCINDEXEDPOLYCURVE(#9116,(IFCLINEINDEX((1,2,3)),IFCLINEINDEX((3,4,1))),.F.);\n\
                   #9116=IFCCARTESIANPOINTLIST2D(((0.,-0.1),(2.,-0.1),(2.,0.1),(0.,0.1)));\n";
    let shared = "#9118=IFCINDEXEDPOLYCURVE(#9114,$,.F.);\n#9119=IFCTRIMMEDCURVE(#9118);\n";
    let on_its_head = "#9102=IFCAXIS2PLACEMENT3D(#9101,#9117,#9111);\n#9117=IFCDIRECTION((0.,0.,-1.));\n\
                       #9101=IFCCARTESIANPOINT((3.1,3.,2.8));\n";
    for (other, says, kept) in [
        (axis.to_owned(), vec!["LIST2D(((0.45,0.),(2.,0.)))", ",1.55,0.2)"], None),
        (by_index, vec!["LIST2D(((2.,0.),(0.45,0.)))"], None),
        (format!("{axis}{outline}"), vec!["((0.45,-0.1),(2.,-0.1),(2.,0.1),(0.45,0.1))"], None),
        (format!("{axis}{shared}"), vec!["LIST2D(((0.45,0.),(2.,0.)))"], Some("LIST2D(((0.,0.),(2.,0.)))")),
        (on_its_head.into(), vec!["IFCCARTESIANPOINT((0.45,0.))", ",1.55,0.2)"], None),
    ] {
        let plain = spurred(3.1, 1.0, ".ATSTART.", "");
        let key = |l: &str| l.split('=').next().unwrap().to_string();
        let mut text = plain.clone();
        for line in other.lines() {
            let own = format!("{}=", key(line));
            text = text.lines().filter(|l| !l.starts_with(&own)).map(|l| format!("{l}\n")).collect();
        }
        let text = with_instances(&text, &other);
        let after =
            ifc::patch("house.ifc", text.as_bytes(), &options, &[shift(9000, 0.45, 0.0)], &[]).unwrap();
        let after = String::from_utf8(after).unwrap();
        for part in says.into_iter().chain(kept) {
            assert!(after.contains(part), "{part} {other}: {after}");
        }
        let reach = |text: &str| {
            let low = ifc::ReadOptions { storey: Some("Lower".into()), ..ifc::ReadOptions::default() };
            let (drawing, _) =
                read_with(text.as_bytes(), &ReadOptions { storey: low.storey, ..ReadOptions::default() });
            let drawing = drawing.unwrap();
            let spur = drawing.entities.iter().filter(|e| e.source.record == 9100);
            let xs: Vec<f64> = spur.flat_map(points).map(|p| p.x).collect();
            [
                xs.iter().copied().fold(f64::INFINITY, f64::min),
                xs.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ]
            .map(|v| (v * 1e6).round() / 1e6)
        };
        assert_eq!([reach(&text), reach(&after)], [[3.1, 5.1], [3.55, 5.1]], "{other}");
    }
}

/// The wall of an assembly keeps its length, for that reason, unless all of it are walls.
#[test]
fn a_part_of_an_assembly_is_called_so() {
    let told = |parts: &str| {
        let whole = format!(
            "#9150=IFCELEMENTASSEMBLY('W000000000000000009150',$,$,$,$,$,$,$,$,$);\n\
             #9151=IFCRELAGGREGATES('R000000000000000000015',$,$,$,#9150,({parts}));\n\
             #9152=IFCMEMBER('W000000000000000009152',$,$,$,$,$,$,$);\n"
        );
        let options = ReadOptions { storey: Some("Lower".into()), ..ReadOptions::default() };
        let (_, report) = read_with(spurred(3.1, 1.0, ".ATSTART.", &whole).as_bytes(), &options);
        report.problems.iter().find(|p| p.code == "ifc-length").map(ToString::to_string)
    };
    let why = told("#9100,#9152").unwrap();
    assert!(why.contains("it is a part of #9150 IFCELEMENTASSEMBLY"), "{why}");
    assert_eq!(told("#9100,#9000"), None);
}

/// A wall stays for the reason that holds it, beside one that can do no more than shift.
#[test]
fn what_stays_says_what_holds_it() {
    let with = Partial { storey: Some("Lower".into()), ..Partial::default() };
    let settings = Settings::new(with).unwrap();
    for (added, wall, says) in [
        (space(3.1, 5.5, "Keep"), 9100, "a space that says Keep holds it"),
        (standing_at(3.0, 4.1), 9200, "is joined to a wall that may shift, but it moves only as a whole"),
    ] {
        let text = spurred(3.1, 1.0, ".ATSTART.", &added);
        let done = enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &settings).unwrap();
        let line = text.lines().position(|l| l.starts_with(&format!("#{wall}="))).unwrap() + 1;
        let told = done.report.problems.iter().filter(|p| p.code == "joint-stays").map(ToString::to_string);
        let told: Vec<String> = told.collect();
        let own = told.iter().find(|t| t.contains(&format!("house.ifc:{line} ")));
        assert!(own.is_some_and(|t| t.contains(says)), "{says}: {told:?}");
    }
}

fn checked(text: &str) -> enfilade_pipeline::Outcome<enfilade_overlay::result::CheckResult> {
    let with = Partial { storey: Some("Upper".into()), ..Partial::default() };
    enfilade_pipeline::check(&Input::new("house.ifc", text.as_bytes(), 1), &Settings::new(with).unwrap())
        .unwrap()
}

fn said(problems: &[enfilade_report::Problem], code: &str) -> Vec<String> {
    problems.iter().filter(|p| p.code == code).map(ToString::to_string).collect()
}

/// A point to turn about that is meant in other coordinates takes a wall out of the building.
#[test]
fn a_turn_about_a_point_far_off_is_told() {
    let turning = |about: &str| {
        spurred(3.1, 1.0, ".ATSTART.", "").replace("x -0.5m 0.5m", &format!("rotate -30 30 about {about}"))
    };
    assert_eq!(said(&checked(&turning("3,2")).report.problems, "move-far-centre"), [""; 0]);
    let told = said(&checked(&turning("-1000,3")).report.problems, "move-far-centre");
    assert_eq!(told.len(), 1, "{told:?}");
    for part in ["IfcWall", "about -1000, 3, which is 1000 m west of the building", "whose middle is at 3, 3"]
    {
        assert!(told[0].contains(part), "{part}: {told:?}");
    }
    let done = run(&turning("-1000,3"));
    let far: Vec<String> = said(&done.report.problems, "options-leaving");
    assert!(!far.is_empty(), "{:?}", done.report);
    let words = &done.result.candidates[0].words;
    assert!(words.contains("What moves is thrown out of the building"), "{words}");
}

/// `name WORD` among the clauses of a `Move` names its group, where `Name` says nothing.
#[test]
fn a_name_within_a_move_names_its_group() {
    let named = "#9240=IFCPROPERTYSINGLEVALUE('Name',$,IFCLABEL('bar'),$);\n";
    for (own, name, is_told) in [("", "foo", false), (named, "bar", true)] {
        let text = spurred(3.1, 1.0, ".ATSTART.", own).replace("x -0.5m 0.5m", "x -0.5m 0.5m; name foo");
        let text = if own.is_empty() { text } else { text.replace("(#9122));", "(#9122,#9240));") };
        let done = checked(&text);
        assert_eq!(done.result.moves[0].name, name);
        let told = said(&done.report.problems, "ifc-marks");
        let is_named = told.iter().any(|t| t.contains("names it \"bar\" as Name and \"foo\" within Move"));
        assert_eq!(is_named, is_told, "{told:?}");
    }
}

/// A north that is no direction in the plan is told.
#[test]
fn a_north_that_is_none_is_told() {
    let plain = spurred(3.1, 1.0, ".ATSTART.", "");
    let with = |way: &str| {
        let text = plain.replace(
            "#5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,$)",
            "#5=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#4,#9400)",
        );
        assert_ne!(text, plain);
        let text = with_instances(&text, &format!("#9400=IFCDIRECTION({way});\n"));
        let told = said(&checked(&text).report.problems, "true-north");
        told.iter()
            .filter(|t| t.contains("found #9400 IFCDIRECTION as TrueNorth, expected a direction"))
            .count()
    };
    assert_eq!(["(0.,0.)", "(0.,0.,1.)", "(0.,1.)", "(1.,0.,0.)"].map(with), [1, 1, 0, 0]);
}
