//! Several drawings on one sheet: which is the plan, what is none of its floor, and whose marks count.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;

use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;
use enfilade_plan::view_names::Title;
use enfilade_plan::{Plan, PlanOptions, understand};
use enfilade_report::{Cancel, Report};

/// A drawing in metres with `entities`, in lines joined by `|`.
fn drawing(entities: &str) -> String {
    let text = format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|6|0|ENDSEC|0|SECTION|2|ENTITIES|{entities}0|ENDSEC|0|EOF|"
    );
    text.replace('|', "\n")
}

fn lines(layer: &str, at: [f64; 2], lines: &[[f64; 4]]) -> String {
    let [x, y] = at;
    let line = |[x0, y0, x1, y1]: &[f64; 4]| {
        format!("0|LINE|8|{layer}|10|{}|20|{}|11|{}|21|{}|", x + x0, y + y0, x + x1, y + y1)
    };
    lines.iter().map(line).collect()
}

fn ring(layer: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    let mut out = format!("0|LWPOLYLINE|8|{layer}|90|4|70|1|");
    for [x, y] in [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] {
        write!(out, "10|{x}|20|{y}|").unwrap();
    }
    out
}

fn text(layer: &str, [x, y]: [f64; 2], words: &str) -> String {
    format!("0|TEXT|8|{layer}|10|{x}|20|{y}|40|0.3|1|{words}|")
}

/// Straight pieces of the walls of a house.
const WALLS: [[f64; 4]; 24] = [
    // Outside, with the front door from 6 to 7 and a window above from 1 to 2.5.
    [0.0, 0.0, 6.0, 0.0],
    [7.0, 0.0, 10.0, 0.0],
    [10.0, 0.0, 10.0, 7.0],
    [10.0, 7.0, 2.5, 7.0],
    [1.0, 7.0, 0.0, 7.0],
    [0.0, 7.0, 0.0, 0.0],
    // Inside, with a wall between two rooms from 3.94 to 4.06 that has a door from 1 to 1.9.
    [0.3, 0.3, 3.94, 0.3],
    [4.06, 0.3, 6.0, 0.3],
    [7.0, 0.3, 9.7, 0.3],
    [9.7, 0.3, 9.7, 6.7],
    [9.7, 6.7, 4.06, 6.7],
    [3.94, 6.7, 2.5, 6.7],
    [1.0, 6.7, 0.3, 6.7],
    [0.3, 6.7, 0.3, 0.3],
    [3.94, 0.3, 3.94, 1.0],
    [3.94, 1.9, 3.94, 6.7],
    [4.06, 0.3, 4.06, 1.0],
    [4.06, 1.9, 4.06, 6.7],
    [3.94, 1.0, 4.06, 1.0],
    [3.94, 1.9, 4.06, 1.9],
    [6.0, 0.0, 6.0, 0.3],
    [7.0, 0.0, 7.0, 0.3],
    [1.0, 6.7, 1.0, 7.0],
    [2.5, 6.7, 2.5, 7.0],
];

/// What a person stands on in it, square metres.
const FLOOR_M2: f64 = 59.0;

fn house_on(layers: [&str; 3], [x, y]: [f64; 2], title: &str) -> String {
    let [wall, glass, door] = layers;
    let panes = [[1.0, 6.7, 2.5, 6.7], [1.0, 6.85, 2.5, 6.85], [1.0, 7.0, 2.5, 7.0]];
    let leaves = [[6.0, 0.3, 6.0, 1.3], [4.06, 1.0, 4.96, 1.0]];
    let swing =
        |[cx, cy]: [f64; 2], r: f64| format!("0|ARC|8|{door}|10|{}|20|{}|40|{r}|50|0|51|90|", x + cx, y + cy);
    let title = if title.is_empty() { String::new() } else { text("TEXT", [x, y - 0.9], title) };
    lines(wall, [x, y], &WALLS)
        + &lines(glass, [x, y], &panes)
        + &lines(door, [x, y], &leaves)
        + &swing([6.0, 0.3], 1.0)
        + &swing([4.06, 1.0], 0.9)
        + &title
}

fn house(at: [f64; 2], title: &str) -> String {
    house_on(["A-WALL", "A-GLAZ", "A-DOOR"], at, title)
}

/// A house a fifth as large.
fn small_house([x, y]: [f64; 2], title: &str) -> String {
    let walls = WALLS.map(|l| l.map(|v| v / 5.0));
    lines("A-WALL", [x, y], &walls) + &text("TEXT", [x, y - 0.2], title)
}

/// A front of four lines with windows.
fn elevation([x, y]: [f64; 2], title: &str) -> String {
    let windows = [1.0, 4.0, 7.0].map(|w| ring("A-GLAZ", [x + w, y + 1.0, x + w + 1.0, y + 2.4]));
    let title = if title.is_empty() { String::new() } else { text("TEXT", [x, y - 0.9], title) };
    ring("A-WALL", [x, y, x + 10.0, y + 6.0]) + &windows.concat() + &title
}

/// Samples of a wall, and of a door and a window in one.
fn legend([x, y]: [f64; 2]) -> String {
    let sample = |at: f64| {
        ring("A-WALL", [x, y + at, x + 0.4, y + at + 0.2])
            + &ring("A-WALL", [x + 1.3, y + at, x + 1.7, y + at + 0.2])
    };
    let door = format!("0|ARC|8|A-DOOR|10|{}|20|{}|40|0.9|50|0|51|90|", x + 0.4, y + 0.2);
    ring("A-WALL", [x, y + 1.0, x + 1.5, y + 1.2])
        + &(sample(0.0) + &door + &sample(-1.2))
        + &text("TEXT", [x, y + 2.0], "LEGEND")
}

fn title_block([x, y]: [f64; 2]) -> String {
    let rows: Vec<[f64; 4]> = (1..6).map(|i| [0.0, 0.5 * f64::from(i), 6.0, 0.5 * f64::from(i)]).collect();
    ring("A-WALL", [x, y, x + 6.0, y + 3.0])
        + &lines("A-WALL", [x, y], &rows)
        + &text("TEXT", [x + 0.1, y + 2.6], "HOUSE X")
        + &text("TEXT", [x + 0.1, y + 0.1], "SCALE: 1:100")
}

struct Read {
    plan: Plan,
    report: Report,
}

impl Read {
    fn of(entities: &str, view: Option<&str>) -> Self {
        let mut report = Report::default();
        let text = drawing(entities);
        let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        let options = PlanOptions { view: view.map(Into::into), ..PlanOptions::default() };
        let plan = understand(&drawing, &options, &mut report).unwrap();
        Self { plan, report }
    }

    fn names(&self) -> Vec<&str> {
        self.plan.views.iter().map(|v| v.name.as_str()).collect()
    }

    fn taken(&self) -> Vec<&str> {
        self.plan.views.iter().filter(|v| v.is_chosen).map(|v| v.name.as_str()).collect()
    }

    fn said(&self, code: &str) -> Vec<String> {
        self.report.problems.iter().filter(|p| p.code == code).map(ToString::to_string).collect()
    }
}

/// What is measured as floor, square metres.
fn floor_m2(entities: &str, view: Option<&str>) -> f64 {
    let settings =
        Settings::new(Partial { spacing: Some(0.25), view: view.map(Into::into), ..Partial::default() });
    let text = drawing(entities);
    let input = Input::new("plan.dxf", text.as_bytes(), 1);
    let done = enfilade_pipeline::analyse(&input, &settings.unwrap(), &Cancel::default()).unwrap();
    done.0.result.counts.vertices as f64 / 16.0
}

/// A flight on the layer of the walls, cut by a line: it is no wall, and the walls round it are.
#[test]
fn treads_on_the_layer_of_the_walls_are_no_walls() {
    let right = [1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.5, 1.2, 0.9];
    let treads: Vec<[f64; 4]> = right
        .iter()
        .zip(0..)
        .map(|(x, i)| (x, 2.0 + 0.28 * f64::from(i)))
        .map(|(x, y)| [0.3, y, *x, y])
        .collect();
    let arrow = [[0.9, 1.9, 0.9, 3.8], [0.9, 3.8, 0.8, 3.6], [0.9, 3.8, 1.0, 3.6]];
    let stair = lines("A-WALL", [0.0, 0.0], &treads) + &lines("A-WALL", [0.0, 0.0], &arrow);
    let understood = |entities: &str| {
        let settings = Settings::new(Partial::default()).unwrap();
        let text = drawing(entities);
        let done = enfilade_pipeline::check(&Input::new("plan.dxf", text.as_bytes(), 1), &settings).unwrap();
        let stairs = done.result.reading.unwrap().entities.iter().filter(|e| e.role == "stair").count();
        (done.result.walls_understood, stairs)
    };
    let (walls, _) = understood(&house([0.0, 0.0], ""));
    assert_eq!(understood(&(house([0.0, 0.0], "") + &stair)), (walls, treads.len() + arrow.len()));
}

/// What its title calls an elevation or a legend is no floor of the plan near it, however few lines draw it.
#[test]
fn what_is_titled_otherwise_is_no_floor() {
    let alone = floor_m2(&house([0.0, 0.0], "FLOOR PLAN"), None);
    assert!((alone - FLOOR_M2).abs() < 2.0, "{alone}");
    for below in [4.0, 9.0, 20.0] {
        for title in ["NORTH ELEVATION", "Nordansicht", "Section A-A"] {
            let sheet = house([0.0, 0.0], "FLOOR PLAN") + &elevation([0.0, -below - 6.0], title);
            let read = Read::of(&sheet, None);
            assert_eq!(
                (read.names(), read.taken()),
                (vec!["FLOOR PLAN", title], vec!["FLOOR PLAN"]),
                "{below}"
            );
            assert_eq!(read.plan.walls.len(), WALLS.len(), "{below} {title}");
            assert_eq!(floor_m2(&sheet, None), alone, "{below} {title}");
        }
    }
    for beside in [3.0, 6.0, 20.0] {
        let read = Read::of(&(house([0.0, 0.0], "FLOOR PLAN") + &legend([10.0 + beside, 2.0])), None);
        assert_eq!((read.names(), read.plan.walls.len()), (vec!["FLOOR PLAN", "LEGEND"], WALLS.len()));
    }
}

/// What is closed, shows no door and stands metres off is none either; what can be entered is a part of the building.
#[test]
fn what_nobody_can_enter_is_no_floor() {
    let plan = house([0.0, 0.0], "");
    let walls = |more: &str| Read::of(&(plan.clone() + more), None).plan.walls.len() - WALLS.len();
    let closed = ring("A-WALL", [14.0, 0.0, 20.0, 5.0]);
    assert_eq!(walls(&closed), 0);
    assert_eq!(walls(&ring("A-WALL", [11.5, 0.0, 17.5, 5.0])), 1, "it stands at the house");
    assert_eq!(walls(&ring("A-WALL", [14.0, 0.0, 16.0, 2.0])), 1, "a pier");
    let swing = "0|ARC|8|A-DOOR|10|15|20|0|40|0.9|50|0|51|90|";
    assert_eq!(walls(&(closed + swing)), 1, "it has a door");
    let open = [[0.0, 0.0, 2.0, 0.0], [3.0, 0.0, 6.0, 0.0], [6.0, 0.0, 6.0, 5.0], [6.0, 5.0, 0.0, 5.0]];
    assert_eq!(walls(&lines("A-WALL", [14.0, 0.0], &open)), 4, "it is open");
}

/// What stands a metre from the plan, with a title of its own, is told from it too.
#[test]
fn what_stands_near_is_told_by_its_title() {
    let plan = house([0.0, 0.0], "FLOOR PLAN");
    for (other, name) in [
        (elevation([0.0, -7.8], "NORTH ELEVATION"), "NORTH ELEVATION"),
        (title_block([11.0, 0.0]), "SCALE: 1:100"),
        (small_house([11.0, 5.0], "KEY PLAN"), "KEY PLAN"),
    ] {
        let read = Read::of(&(plan.clone() + &other), None);
        let mut names = read.names();
        names.sort_unstable();
        let mut expected = vec!["FLOOR PLAN", name];
        expected.sort_unstable();
        assert_eq!((names, read.taken()), (expected, vec!["FLOOR PLAN"]));
        assert_eq!(read.plan.walls.len(), WALLS.len(), "{name}");
    }
    let wing = Read::of(&(plan + &elevation([0.0, -7.8], "")), None);
    assert_eq!(wing.plan.views.len(), 1, "without a title it is a part");
}

/// The clean plan is read where another drawing has an elevation, a legend and a title block round it.
#[test]
fn a_full_sheet_falls_into_its_drawings() {
    let sheet = house([0.0, 0.0], "GROUND FLOOR PLAN")
        + &house([15.0, 0.0], "FIRST FLOOR PLAN")
        + &elevation([15.0, -13.0], "NORTH ELEVATION")
        + &legend([30.0, 1.0])
        + &title_block([29.0, -13.0]);
    let read = Read::of(&sheet, None);
    let kinds: Vec<Title> = read.plan.views.iter().map(|v| v.kind).collect();
    let expected = [Title::GroundFloor, Title::Plan, Title::Beside, Title::NoPlan, Title::Beside];
    assert_eq!(kinds, expected, "{:?}", read.names());
    assert_eq!((read.taken(), read.plan.walls.len()), (vec!["GROUND FLOOR PLAN"], WALLS.len()));
}

/// A plan of rooms goes before plans that show something else, and an untitled plan before a roof or the site.
#[test]
fn the_plan_of_the_rooms_is_read() {
    let row = |titles: &[&str]| -> String {
        titles.iter().enumerate().map(|(i, t)| house([15.0 * i as f64, 0.0], t)).collect()
    };
    let taken = |titles: &[&str]| Read::of(&row(titles), None).taken().join(" ");
    assert_eq!(taken(&["REFLECTED CEILING PLAN", "FOUNDATION PLAN", "FURNITURE PLAN"]), "FURNITURE PLAN");
    assert_eq!(taken(&["ROOF PLAN", "REFLECTED CEILING PLAN"]), "REFLECTED CEILING PLAN");
    for other in ["Dachaufsicht", "Lageplan", "Längsschnitt", "SEC. A-A", "ELEV. NORTH"] {
        assert_eq!(taken(&[other, ""]), "drawing 2", "{other}");
    }
}

/// Of drawings without titles the one with doors is the plan, though framing drawn over the same outline has more lines.
#[test]
fn framing_without_doors_is_no_plan() {
    let beams: Vec<[f64; 4]> = [1.1, 2.3, 3.2, 4.9, 5.5, 6.1].iter().map(|y| [0.3, *y, 3.94, *y]).collect();
    let framing = lines("A-WALL", [15.0, 0.0], &WALLS) + &lines("A-WALL", [15.0, 0.0], &beams);
    let walls = lines("A-WALL", [0.0, 0.0], &WALLS);
    assert_eq!(Read::of(&(house([0.0, 0.0], "") + &framing), None).taken(), ["drawing 1"]);
    assert_eq!(Read::of(&(walls + &framing), None).taken(), ["drawing 2"], "no doors at all");
}

/// What lies in a section is taken for nothing of the plan; what lies in another floor is taken for what it is.
#[test]
fn a_section_cuts_no_wall_of_the_plan() {
    let plan = house([0.0, 0.0], "FLOOR PLAN");
    let walls = |more: &str| {
        let read = Read::of(&(plan.clone() + more), None);
        let senses = &read.plan.reading.senses;
        senses.iter().filter(|s| s.role.stops_sight()).count()
    };
    let alone = walls("");
    for title in ["SECTION A-A", "ROOF PLAN", "SITE PLAN"] {
        let lines = lines("A-WALL", [15.0, 0.0], &WALLS) + &text("TEXT", [15.0, -0.9], title);
        assert_eq!(walls(&lines), alone, "{title}");
        assert_eq!(
            walls(&house([15.0, 0.0], title)),
            2 * alone,
            "{title}: doors swing, it may be another's title"
        );
    }
    assert_eq!(walls(&house([15.0, 0.0], "FIRST FLOOR PLAN")), 2 * alone);
}

fn marked(layer: &str, extent: [f64; 4], words: &str) -> String {
    let words =
        if words.is_empty() { String::new() } else { text(layer, [extent[0] + 0.1, extent[1] + 0.1], words) };
    ring(layer, extent) + &words
}

/// Two floors beside each other, 10 m apart, and marks.
fn floors(marks: &str) -> String {
    house([0.0, 0.0], "GROUND FLOOR PLAN") + &house([20.0, 0.0], "FIRST FLOOR PLAN") + marks
}

/// Marks on two floors never make one floor of them; the user's word goes first, and what is not used is told.
#[test]
fn marks_on_two_floors_mix_none() {
    let [low, high] = [0.0, 20.0].map(|x| [x + 3.5, 0.2, x + 4.5, 6.8]);
    let both = marked("EF-MOVE", low, "x -0.5 0.5; name a") + &marked("EF-MOVE", high, "x -0.5 0.5; name b");
    let groups = |read: &Read| read.plan.markers.groups.iter().map(|g| g.name.clone()).collect::<Vec<_>>();
    for (view, taken, names, warns) in [
        (None, "GROUND FLOOR PLAN", vec!["a"], true),
        (Some("FIRST FLOOR PLAN"), "FIRST FLOOR PLAN", vec!["b"], false),
        (Some("1"), "GROUND FLOOR PLAN", vec!["a"], false),
        (Some("all"), "GROUND FLOOR PLAN FIRST FLOOR PLAN", vec!["a", "b"], false),
    ] {
        let read = Read::of(&floors(&both), view);
        let floors = taken.split("PLAN").count() - 1;
        assert_eq!(
            (read.taken().join(" "), groups(&read).join(" ")),
            (taken.to_owned(), names.join(" ")),
            "{view:?}"
        );
        assert_eq!(read.plan.walls.len(), floors * WALLS.len(), "{view:?}");
        assert_eq!(read.said("marks-elsewhere").len(), 2 - floors, "{view:?}");
        let problems = &read.report.problems;
        let warned = problems.iter().filter(|p| p.severity == enfilade_report::Severity::Warning);
        assert_eq!(warned.count() > 0, warns, "{view:?} {problems:?}");
    }
    let told = Read::of(&floors(&both), None).said("marks-elsewhere");
    let expected = "plan.dxf: found marks on a drawing that is not read: 2 \"FIRST FLOOR PLAN\" (1 on EF-MOVE); they are not \
                    used; read: 1 \"GROUND FLOOR PLAN\"; --view NAME reads another drawing, --view all reads all as one";
    assert_eq!(told, [expected]);
}

/// The drawing with the regions is read, else the one with most that moves; a mark over both makes them one.
#[test]
fn regions_go_before_moves_and_these_before_what_stays() {
    let moves = marked("EF-MOVE", [3.5, 0.2, 4.5, 6.8], "x -0.5 0.5");
    let region = marked("EF-QUERY", [20.4, 0.4, 29.0, 6.6], "");
    let read = Read::of(&floors(&(moves.clone() + &region)), None);
    assert_eq!((read.taken(), read.plan.markers.query.len()), (vec!["FIRST FLOOR PLAN"], 1));
    assert!(read.plan.markers.groups.is_empty() && read.plan.markers.is_move_drawn, "nothing moves unasked");
    let read = Read::of(&floors(&(moves.clone() + &region)), Some("2"));
    assert!(!read.plan.markers.is_move_drawn, "the other floor is not spoken of");
    let keep = [19.5, 25.0].map(|x| marked("EF-KEEP", [x, -0.5, x + 5.0, 7.5], "")).concat();
    let read = Read::of(&floors(&(keep.clone() + &moves)), None);
    assert_eq!((read.taken(), read.plan.markers.keep.len()), (vec!["GROUND FLOOR PLAN"], 0));
    assert_eq!(Read::of(&floors(&keep), None).taken(), ["FIRST FLOOR PLAN"]);
    let over_both = marked("EF-QUERY", [0.4, 0.4, 29.0, 6.6], "");
    let read = Read::of(&floors(&over_both), None);
    assert_eq!((read.plan.views.len(), read.plan.walls.len()), (1, 2 * WALLS.len()));
    let read = Read::of(&floors(&over_both), Some("first floor plan"));
    assert_eq!((read.taken(), read.plan.walls.len()), (vec!["FIRST FLOOR PLAN"], WALLS.len()));
}
