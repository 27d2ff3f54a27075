//! Decided works: what is drawn or said to be built and demolished is measured as what `works` promises of it.

use enfilade_config::{MoveTable, Partial, Settings, WorkTable};
use enfilade_engine::Obstacles;
use enfilade_engine::visibility::visibility_graph;
use enfilade_fixtures::sample;
use enfilade_overlay::result::ElementRef;
use enfilade_overlay::works::{VISIBILITY, WorkEntry, WorksResult};
use enfilade_pipeline::{Input, Study, works};
use enfilade_report::{Cancel, Error};

fn settings(works: Vec<WorkTable>) -> Settings {
    Settings { works, ..Settings::new(Partial::default()).unwrap() }
}

/// The study of a sample of the flat with some works decided, and what each other work would bring.
fn flat(file: &str, tables: Vec<WorkTable>) -> (WorksResult, Study) {
    let bytes = std::fs::read(sample(file)).unwrap();
    let input = Input::new(file, &bytes, 1);
    let (outcome, study) = works::works_of(&input, &settings(tables), &Cancel::default()).unwrap();
    (outcome.result, study)
}

/// The box that decides a work of the list, drawing units.
fn table(work: &WorkEntry, metres: f64) -> WorkTable {
    let [a, b] = work.stretch;
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    let across = [-(b[1] - a[1]) / length * 0.4, (b[0] - a[0]) / length * 0.4];
    let corner = |p: [f64; 2], side: f64| [0, 1].map(|k| (p[k] + side * across[k]) / metres);
    WorkTable {
        kind: "open".into(),
        points: vec![corner(a, 1.0), corner(b, 1.0), corner(b, -1.0), corner(a, -1.0)],
        text: (work.kind == "glaze").then(|| "glass".into()),
    }
}

/// Pairs of present cells that see each other.
fn sights(present: &Study, obstacles: &Obstacles) -> f64 {
    let segments = obstacles.segments.clone();
    let obstacles = Obstacles { segments, blind: present.initial_obstacles().blind };
    let graph = visibility_graph(&present.lattice, &obstacles);
    (0..present.lattice.cells.len() as u32).map(|v| f64::from(graph.degree(v))).sum()
}

/// Works of the list that open a wall, decided one by one: the plan as it will be has the gain that was promised.
fn as_promised(file: &str, metres: f64) {
    let (listed, present) = flat(file, Vec::new());
    let now = sights(&present, &present.initial_obstacles());
    let opens = |w: &&WorkEntry| matches!(w.kind.as_str(), "open" | "glaze");
    let (confirmed, counted): (Vec<&WorkEntry>, Vec<&WorkEntry>) =
        listed.works.iter().filter(opens).partition(|w| w.gain[VISIBILITY].low.is_some());
    assert!(confirmed.len() > 1 && counted.len() > 4, "{} {}", confirmed.len(), counted.len());
    for work in confirmed.into_iter().take(2).chain(counted.into_iter().take(5)) {
        let (_, after) = flat(file, vec![table(work, metres)]);
        let gain = sights(&present, &after.initial_obstacles()) / now - 1.0;
        let promised = work.gain[VISIBILITY];
        let what = format!("{file}: {} {:?} {gain} {promised:?}", work.kind, work.stretch);
        match (promised.low, promised.high) {
            (Some(low), Some(high)) => assert!((low - 0.005..=high + 0.005).contains(&gain), "{what}"),
            // Jambs of the list stand on whole micrometres, those said here on millimetres.
            _ => assert!((gain - promised.share).abs() < 2e-3, "{what}"),
        }
    }
}

#[test]
fn a_decided_opening_brings_what_the_list_promised_in_a_drawing() {
    as_promised("flat.dxf", 0.001);
}

#[test]
fn a_decided_opening_brings_what_the_list_promised_in_a_building() {
    as_promised("flat.ifc", 0.001);
}

#[test]
fn a_decided_opening_brings_what_the_list_promised_in_a_scene() {
    as_promised("flat.glb", 1.0);
}

/// Every command reads the same: `check` too.
#[test]
fn a_side_car_allows_works_as_marks_do() {
    let (free, present) = flat("flat.dxf", Vec::new());
    let best = free.works.iter().find(|w| w.is_allowed && w.kind == "open").unwrap();
    let handle = |e: &ElementRef| match e {
        ElementRef::Dxf { handle, .. } => handle.clone(),
        _ => None,
    };
    let handles = best.wall.iter().filter_map(handle).collect();
    let table = MoveTable {
        name: None,
        moves: format!("open {}m", best.width_m),
        nodes: Vec::new(),
        handles,
        layers: Vec::new(),
        marker: None,
    };
    let (listed, study) = allowed_by(table.clone()).unwrap();
    let allowed: Vec<_> = listed.works.iter().filter(|w| w.is_allowed).collect();
    assert!(!allowed.is_empty());
    for work in allowed {
        assert_eq!((work.kind.as_str(), work.width_m, &work.wall), ("open", best.width_m, &best.wall));
    }
    // It says nothing of moves.
    assert_eq!(study.base.moves.parameters.len(), present.base.moves.parameters.len());
    let wrong = allowed_by(MoveTable { moves: "open wide".into(), ..table });
    assert!(matches!(wrong, Err(Error::Usage(_))));
}

/// The list where a table of the side-car allows works.
fn allowed_by(table: MoveTable) -> Result<(WorksResult, Study), Error> {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let settings = Settings { moves: vec![table], ..settings(Vec::new()) };
    let found = works::works_of(&Input::new("flat.dxf", &bytes, 1), &settings, &Cancel::default());
    found.map(|(outcome, study)| (outcome.result, study))
}

#[test]
fn what_is_decided_is_shown_and_said_by_check() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let corners = vec![[8900.0, 1460.0], [9700.0, 1460.0], [9700.0, 3860.0], [8900.0, 3860.0]];
    let table = WorkTable { kind: "open".into(), points: corners, text: None };
    let input = Input::new("flat.dxf", &bytes, 1);
    let done = enfilade_pipeline::check(&input, &settings(vec![table])).unwrap();
    assert!(done.report.problems.iter().any(|p| p.code == "decided-works"));
    let before = enfilade_pipeline::check(&input, &settings(Vec::new())).unwrap();
    assert_ne!(done.files[0].bytes, before.files[0].bytes);
}

/// A wall that goes by a mark, by its property set or by the extras of its node is no wall for anybody.
#[test]
fn what_is_to_be_demolished_is_gone_in_every_format() {
    let share = |file: &str, before: &Study, after: &Study| {
        let now = sights(before, &before.initial_obstacles());
        let gain = sights(before, &after.initial_obstacles()) / now - 1.0;
        assert!(gain > 0.05, "{file}: {gain}");
        assert!(!after.base.plan.decided.is_empty(), "{file}");
        gain
    };
    let (listed, dxf) = flat("flat.dxf", Vec::new());
    let removed = listed.works.iter().find(|w| w.kind == "remove" && w.is_allowed).unwrap();
    let box_of = WorkTable { kind: "remove".into(), ..table(removed, 0.001) };
    let by_box = share("flat.dxf", &dxf, &flat("flat.dxf", vec![box_of]).1);

    let (listed, ifc) = flat("flat.ifc", Vec::new());
    let same = |w: &&WorkEntry| {
        let far = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
        let [a, b] = removed.stretch;
        w.kind == "remove"
            && (far(w.stretch[0], a).max(far(w.stretch[1], b)) < 0.3
                || far(w.stretch[0], b).max(far(w.stretch[1], a)) < 0.3)
    };
    let twin = listed.works.iter().find(same).unwrap();
    let guid = |w: &ElementRef| match w {
        ElementRef::Ifc { global_id, .. } => global_id.clone(),
        other => panic!("{other:?}"),
    };
    let guids: Vec<String> = twin.wall.iter().map(guid).collect();
    let text = std::fs::read_to_string(sample("flat.ifc")).unwrap();
    let text = with_status(&text, &guids);
    let input = Input::new("flat.ifc", text.as_bytes(), 1);
    let gone = works::works_of(&input, &settings(Vec::new()), &Cancel::default()).unwrap().1;
    let by_status = share("flat.ifc", &ifc, &gone);
    assert!((by_box - by_status).abs() < 0.03, "{by_box} {by_status}");
}

/// The file with `Status` DEMOLISH on some walls, as `Pset_WallCommon` states it.
fn with_status(text: &str, guids: &[String]) -> String {
    let id_of = |guid: &String| {
        let line = text.lines().find(|l| l.contains(&format!("('{guid}'"))).unwrap();
        line.split('=').next().unwrap().trim().to_owned()
    };
    let walls: Vec<String> = guids.iter().map(id_of).collect();
    let added = format!(
        "#900001=IFCPROPERTYENUMERATEDVALUE('Status',$,(IFCLABEL('DEMOLISH')),$);\n\
         #900002=IFCPROPERTYSET('0aaaaaaaaaaaaaaaaaaaa1',$,'Pset_WallCommon',$,(#900001));\n\
         #900003=IFCRELDEFINESBYPROPERTIES('0aaaaaaaaaaaaaaaaaaaa2',$,$,$,({}),#900002);\n",
        walls.join(",")
    );
    let end = text.rfind("ENDSEC").unwrap();
    format!("{}{added}{}", &text[..end], &text[end..])
}
