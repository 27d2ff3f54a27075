//! The sample building, changed: what is far off, names that are typed otherwise, names given twice, the IFC beside a scene.

use std::sync::Arc;

use enfilade_cad::ReadOptions;
use enfilade_config::{Beside, Partial, Settings, Twin};
use enfilade_overlay::result::{AnalysisResult, CheckResult};
use enfilade_pipeline::{Input, Outcome};
use enfilade_report::{Cancel, Error, Report};
use serde_json::{Value, json};

const IFC: &str = include_str!("../../../../../samples/pavilion.ifc");
const GLB: &[u8] = include_bytes!("../../../../../samples/pavilion.glb");

fn with(instances: &str) -> String {
    IFC.replace("ENDSEC;\nEND-ISO", &format!("{instances}ENDSEC;\nEND-ISO"))
}

/// The scene with its JSON changed.
fn scene(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(GLB[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&GLB[20..20 + length]).unwrap();
    change(&mut json);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let rest = &GLB[20 + length..];
    let total = (20 + text.len() + rest.len()) as u32;
    [&GLB[..8], &total.to_le_bytes(), &(text.len() as u32).to_le_bytes(), b"JSON", &text, rest].concat()
}

fn check(
    file: &str,
    bytes: &[u8],
    partial: Partial,
    twin: Option<&[u8]>,
) -> Result<Outcome<CheckResult>, Error> {
    let beside = Beside { twin: twin.map(Twin::from), ..Beside::default() };
    let settings = Settings { beside, ..Settings::new(partial).unwrap() };
    enfilade_pipeline::check(&Input::new(file, bytes, 1), &settings)
}

fn told(report: &Report, code: &str) -> Vec<String> {
    report.problems.iter().filter(|p| p.code == code).map(ToString::to_string).collect()
}

/// A wall of 4 m on the ground floor, millimetres.
fn wall(x: f64) -> String {
    format!(
        "#9000=IFCCARTESIANPOINT(({x:?},5000.,0.));\n#9001=IFCAXIS2PLACEMENT3D(#9000,$,$);\n\
         #9002=IFCLOCALPLACEMENT(#17,#9001);\n#9003=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,4000.,200.);\n\
         #9004=IFCDIRECTION((0.,0.,1.));\n#9005=IFCEXTRUDEDAREASOLID(#9003,$,#9004,3000.);\n\
         #9006=IFCSHAPEREPRESENTATION(#7,'Body','SweptSolid',(#9005));\n#9007=IFCPRODUCTDEFINITIONSHAPE($,$,(#9006));\n\
         #9008=IFCWALL('0FarWallOfThePavilion1',$,'far',$,$,#9002,#9007,'1',$);\n\
         #9009=IFCRELCONTAINEDINSPATIALSTRUCTURE('0FarWallOfThePavilion2',$,$,$,(#9008),#18);\n"
    )
}

/// One wall far from all others is a slip and leaves the rest as it is, in either format.
#[test]
fn a_wall_far_off_is_left_out_by_name() {
    let plain = check("p.ifc", IFC.as_bytes(), Partial::default(), None).unwrap().result;
    for (km, is_far) in [(0.1, false), (0.4, true), (1e3, true)] {
        let ifc = with(&wall(km * 1e6));
        let mut far_node = String::new();
        let glb = scene(|j| {
            let n = j["nodes"].as_array().unwrap().len();
            far_node = format!("IfcWall/far /nodes/{n}");
            j["nodes"]
                .as_array_mut()
                .unwrap()
                .push(json!({"name": "IfcWall/far", "mesh": 6, "translation": [km * 1e3, 0, -5]}));
            j["scenes"][0]["nodes"].as_array_mut().unwrap().push(n.into());
        });
        for (file, bytes, name) in
            [("p.ifc", ifc.as_bytes(), "IfcWall 0FarWallOfThePavilion1"), ("p.glb", &glb, &far_node)]
        {
            let done = check(file, bytes, Partial::default(), None).unwrap();
            let said = told(&done.report, "far-wall");
            assert_eq!(said.len(), usize::from(is_far), "{km} {said:?}");
            assert!(
                !is_far || said[0].contains(name) && said[0].contains("--view all takes it in"),
                "{said:?}"
            );
            assert_eq!(done.result.regions.len(), plain.regions.len());
        }
        let all = Partial { view: Some("all".into()), ..Partial::default() };
        let done = check("p.ifc", ifc.as_bytes(), all, None).unwrap();
        assert!(told(&done.report, "far-wall").is_empty());
    }
}

/// Names are the same whatever their case and however accents are stored.
#[test]
fn spaces_and_storeys_are_found_however_they_are_typed() {
    let ifc =
        IFC.replace("'Gallery'", r"'K\X2\00FC\X0\che  S\X2\00DC\X0\D'").replace("'Upper floor'", "'Étage'");
    let ifc = ifc.replace("Étage", r"\X2\00C9\X0\tage");
    for query in
        ["space:küche süd", "space:KÜCHE*", "space:ku\u{308}che su\u{308}d", r"space:K\X2\00FC\X0\che *"]
    {
        let partial = Partial { query: Some(query.into()), ..Partial::default() };
        let done = check("p.ifc", ifc.as_bytes(), partial, None);
        assert!(done.is_ok(), "{query}: {:?}", done.err());
    }
    for storey in ["étage", "ÉTAGE ", "e\u{301}tage"] {
        let partial = Partial { storey: Some(storey.into()), ..Partial::default() };
        assert!(check("p.ifc", ifc.as_bytes(), partial, None).is_ok(), "{storey}");
    }
}

/// Storeys of one name are both shown, and a name that fits both is said to.
#[test]
fn storeys_of_one_name_are_told_apart_by_number() {
    let ifc = IFC.replace("'Upper floor'", "'Ground floor'");
    let done = check("p.ifc", ifc.as_bytes(), Partial::default(), None).unwrap();
    let floors: Vec<f64> = done.result.storeys.iter().map(|s| s.floor_m).collect();
    assert_eq!(floors, [0.0, 3.2]);
    let walls: Vec<u64> = done.result.storeys.iter().map(|s| s.walls).collect();
    assert!(walls[0] != walls[1], "{walls:?}");
    let named = |storey: &str| {
        let partial = Partial { storey: Some(storey.into()), ..Partial::default() };
        check("p.ifc", ifc.as_bytes(), partial, None).unwrap().report
    };
    let said = told(&named("ground floor"), "storey-name");
    assert!(
        said.len() == 1
            && said[0].contains("found 2 storeys of that name, expected one; the lowest was taken"),
        "{said:?}"
    );
    assert!(said[0].contains("by number: storey-1 (floor 0.000 m), storey-2 (floor 3.200 m)"), "{said:?}");
    let upper = named("storey-2");
    assert!(told(&upper, "storey-name").is_empty());
    assert!(told(&upper, "storey-cut")[0].contains("floor at 3.200 m"), "{upper:?}");
}

/// A scene whose nodes bear GlobalIds knows its spaces by the names that the IFC beside it gives them.
#[test]
fn a_scene_knows_spaces_by_the_ifc_beside_it() {
    let id = "0PavilionOfEnfilade075";
    assert!(IFC.contains(&format!("=IFCSPACE('{id}',$,'Gallery'")));
    let ifc = with(
        "#9001=IFCZONE('3ZoneGlobalId000000001',$,'Public',$,$);\n\
         #9002=IFCRELASSIGNSTOGROUP('3ZoneGlobalId000000003',$,$,$,(#512),$,#9001);\n",
    );
    let glb = scene(|j| j["nodes"][13]["name"] = id.into());
    let area = |query: &str| {
        let partial = Partial { query: Some(query.into()), ..Partial::default() };
        let done = check("p.glb", &glb, partial, Some(ifc.as_bytes()))?;
        Ok::<f64, Error>(done.result.regions.iter().filter(|r| r.kind == "query").map(|r| r.area_m2).sum())
    };
    let whole = area("space:gallery").unwrap();
    assert!(whole > 100.0);
    for query in [&format!("space:{id}"), "zone:public", "space:GALL*"] {
        assert_eq!(area(query).unwrap(), whole, "{query}");
    }
    // A space by its own name is in the zones of the one space of that name.
    let partial = Partial { query: Some("zone:Public".into()), ..Partial::default() };
    let done = check("p.glb", GLB, partial, Some(ifc.as_bytes())).unwrap();
    assert_eq!(
        done.result.regions.iter().filter(|r| r.kind == "query").map(|r| r.area_m2).sum::<f64>(),
        whole
    );
}

/// An IFC that is of another building is told once and gives no storeys.
#[test]
fn an_ifc_of_another_building_gives_no_storeys() {
    let glb = scene(|j| {
        for (i, node) in j["nodes"].as_array_mut().unwrap().iter_mut().enumerate() {
            node["name"] = format!("1AnotherBuildingNode{i:02}").into();
        }
    });
    let options = ReadOptions {
        twin: Some(Arc::new(enfilade_cad::ifc::inventory(IFC.as_bytes(), None))),
        ..ReadOptions::default()
    };
    assert!(enfilade_cad::storeys("p.glb", &glb, &options).is_empty());
    assert_eq!(enfilade_cad::storeys("p.glb", GLB, &options).len(), 2);
    let done = check("p.glb", &glb, Partial::default(), Some(IFC.as_bytes())).unwrap();
    assert!(done.result.storeys.is_empty() && done.result.building.is_none(), "{:?}", done.result.storeys);
    assert_eq!(told(&done.report, "gltf-ifc").len(), 1);
    let partial = Partial { storey: Some("Upper floor".into()), ..Partial::default() };
    let error = check("p.glb", &glb, partial, Some(IFC.as_bytes())).unwrap_err().to_string();
    assert!(
        error.contains("none (glTF has none, and the .ifc of the same name beside it is not used"),
        "{error}"
    );
}

/// A mark on a door or window holds its wall; what means nothing is told, whatever bears it.
#[test]
fn marks_on_doors_and_others_are_told() {
    let set = |id: usize, name: &str, value: &str, of: usize| {
        format!(
            "#{id}=IFCPROPERTYSINGLEVALUE('{name}',$,{value},$);\n\
             #{}=IFCPROPERTYSET('S{id}',$,'Pset_Enfilade',$,(#{id}));\n\
             #{}=IFCRELDEFINESBYPROPERTIES('D{id}',$,$,$,(#{of}),#{});\n",
            id + 1,
            id + 2,
            id + 1
        )
    };
    let marks = |added: &str| {
        let done = check("p.ifc", with(added).as_bytes(), Partial::default(), None).unwrap();
        (told(&done.report, "ifc-marks"), done.result.moves.len())
    };
    let (none, all) = marks("");
    assert!(none.is_empty(), "{none:?}");
    // The door of the cloakroom, whose wall says how it moves.
    let (kept, left) = marks(&set(9000, "Keep", "IFCBOOLEAN(.T.)", 377));
    let words = "Pset_Enfilade states Move, and Pset_Enfilade says Keep of its IfcDoor #377; it stays";
    assert!(kept.len() == 1 && kept[0].contains(words), "{kept:?}");
    assert_eq!(left, all - 1);
    let (moved, left) = marks(&set(9000, "Move", "IFCLABEL('x -1m 1m')", 377));
    assert!(moved.is_empty(), "{moved:?}");
    assert_eq!(left, all + 1, "the door slides in its wall, which moves too");
    let (storey, _) = marks(&set(9000, "Keep", "IFCBOOLEAN(.T.)", 18));
    assert!(storey.len() == 1 && storey[0].contains("states keep of an IFCBUILDINGSTOREY"), "{storey:?}");
}

/// Elements that bear one name of their own move each by itself; only a stated name joins them.
#[test]
fn only_a_stated_name_joins_moves() {
    let same = IFC
        .replace("'screen-2',$,$,#404", "'screen-1',$,$,#404")
        .replace("'x -1.5m 1.5m; rotate -25 25'", "'x -1m 1m; y -1.2m 1.5m'");
    let names = |text: &str| -> Vec<String> {
        let done = check("p.ifc", text.as_bytes(), Partial::default(), None).unwrap();
        let mut names: Vec<String> = done.result.moves.iter().map(|m| m.name.clone()).collect();
        names.dedup();
        names.into_iter().filter(|n| n.starts_with("screen-1") || n.starts_with("screen-2")).collect()
    };
    let stated = same.replace("'Name',$,IFCLABEL('screen-2')", "'Name',$,IFCLABEL('screen-1')");
    assert_eq!(names(&stated), ["screen-1"]);
    let own = same.replace("'Name',$,IFCLABEL('screen-2')", "'Nick',$,IFCLABEL('-')");
    let own = own.replace("'Name',$,IFCLABEL('screen-1')", "'Nick',$,IFCLABEL('-')");
    assert_eq!(names(&own), ["screen-1", "screen-1 2"]);
}

/// The IFC beside a scene is understood once, however often the scene is read and changed.
#[test]
fn the_ifc_beside_a_scene_is_read_once() {
    let beside = Beside { twin: Some(Twin::from(IFC.as_bytes())), ..Beside::default() };
    let settings = Settings { beside, ..Settings::new(Partial::default()).unwrap() };
    let [first, again] =
        [&settings, &settings.clone()].map(|s| enfilade_pipeline::read_options(s).twin.unwrap());
    assert!(Arc::ptr_eq(&first, &again), "read again");
    assert_eq!(*first, enfilade_cad::ifc::inventory(IFC.as_bytes(), None));
    let done = enfilade_pipeline::check(&Input::new("p.glb", GLB, 1), &settings).unwrap();
    assert_eq!(done.result.storeys.len(), 2);
    assert!(Arc::strong_count(&first) > 2, "the settings keep what was read");
}

fn measured(file: &str, bytes: &[u8], storey: Option<&str>) -> AnalysisResult {
    let partial = Partial {
        storey: storey.map(str::to_string),
        spacing: Some(0.5),
        lattice_centre: Some([0.25, 0.25]),
        only_marked: Some(true),
        ..Partial::default()
    };
    let beside =
        Beside { twin: file.ends_with("glb").then(|| Twin::from(IFC.as_bytes())), ..Beside::default() };
    let settings = Settings { beside, ..Settings::new(partial).unwrap() };
    enfilade_pipeline::analyse(&Input::new(file, bytes, 1), &settings, &Cancel::default()).unwrap().0.result
}

/// The three files of the sample show one building: every storey measures the same in each of them.
#[test]
fn the_samples_of_one_building_measure_the_same() {
    let dxf = measured("pavilion.dxf", include_bytes!("../../../../../samples/pavilion.dxf"), None);
    for storey in ["Ground floor", "Upper floor"] {
        let ifc = measured("pavilion.ifc", IFC.as_bytes(), Some(storey));
        let glb = measured("pavilion.glb", GLB, Some(storey));
        let others = [Some(&glb), (storey == "Ground floor").then_some(&dxf)];
        for other in others.into_iter().flatten() {
            let name = format!("{storey}: {} {}", ifc.input.path, other.input.path);
            assert_eq!(ifc.counts.vertices, other.counts.vertices, "{name}");
            for key in ["degree", "depth", "entropy"] {
                let [a, b] = [&ifc, other].map(|r| r.mean.get(key).unwrap());
                assert!((a - b).abs() <= 1e-9 * a.abs(), "{name}: {key} {a} {b}");
            }
        }
    }
}
