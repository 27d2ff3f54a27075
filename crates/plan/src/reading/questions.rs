//! What a person should decide before anything is optimised: typed questions, least certain first.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{Rival, RoleSense};
use crate::Plan;
use crate::axes::{AxisGraph, OpeningKind};
use crate::floor::Floor;
use crate::kinds::{RoomKind, RoomKindFound};
use enfilade_cad::drawing::Unit;
use enfilade_cad::units::UNITS;

/// Below these the reading asks. To be calibrated on labelled drawings.
pub const UNIT_SURE: f64 = 0.8;
/// See [`UNIT_SURE`]: of the drawing that is read, on a sheet with several.
pub const VIEW_SURE: f64 = 0.6;
/// See [`UNIT_SURE`]: mean confidence of what draws the walls, by length.
pub const WALLS_SURE: f64 = 0.45;
/// See [`UNIT_SURE`]: share of the floor inside the building's outline that is measured.
pub const COVERAGE_SURE: f64 = 0.78;

/// Most questions at a time: those that decide most.
const QUESTIONS_MAX: usize = 2;

/// Most answers to a question.
const ANSWERS_MAX: usize = 4;

/// Sizes of plans that make a unit an answer where no rival is known, metres: from a bath with its walls.
const SIZE_M: [f64; 2] = [3.0, 1_000.0];

/// What shows how long a unit is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Witness {
    /// The width of a door.
    Door,
    /// The thickness of a wall.
    Wall,
    /// The length of the whole plan.
    Plan,
}

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// How long is it?
    Unit {
        /// What is looked at.
        witness: Witness,
        /// Its length, drawing units.
        length: f64,
        /// The units that may be meant, the one taken first.
        units: Vec<Unit>,
    },
    /// Which drawing of the sheet is meant?
    View {
        /// Numbers and names of those that may be, the one taken first.
        views: Vec<(usize, String)>,
    },
    /// Are these lines walls?
    Walls {
        /// The layer they are drawn on.
        layer: String,
        /// How many elements are taken as walls there.
        count: usize,
    },
    /// Is this floor inside?
    Floor {
        /// A point of it, drawing units.
        at: DVec2,
        /// Its size, m².
        area_m2: f64,
    },
    /// What is this room for?
    Room {
        /// Its number, from 1.
        number: usize,
        /// Its size, m².
        area_m2: f64,
        /// What it is taken for.
        kind: RoomKind,
    },
}

/// A correction that answers a question.
#[derive(Clone, Debug, PartialEq)]
pub enum Correction {
    /// `unit`.
    Unit(Unit),
    /// `view`, by its number.
    View(usize),
    /// `wall`.
    Wall(String),
    /// `not_wall`.
    NotWall(String),
    /// `inside`, drawing units.
    Inside(DVec2),
    /// `outside`, drawing units.
    Outside(DVec2),
    /// `rooms`: the room's number and its kind.
    Room(usize, RoomKind),
}

/// A question and how sure the reading is of what it asks.
#[derive(Clone, Debug, PartialEq)]
pub struct Doubt {
    /// 0 to 1.
    pub confidence: f64,
    /// What is asked.
    pub question: Question,
}

impl Question {
    /// The answers, that of the present reading first.
    pub fn corrections(&self) -> Vec<Correction> {
        match self {
            Self::Unit { units, .. } => units.iter().map(|u| Correction::Unit(*u)).collect(),
            Self::View { views } => views.iter().map(|(number, _)| Correction::View(*number)).collect(),
            Self::Walls { layer, .. } => {
                let selector = format!("layer:{layer}");
                vec![Correction::Wall(selector.clone()), Correction::NotWall(selector)]
            }
            Self::Floor { at, .. } => vec![Correction::Outside(*at), Correction::Inside(*at)],
            Self::Room { number, kind, .. } => {
                [*kind, instead_of(*kind)].map(|kind| Correction::Room(*number, kind)).to_vec()
            }
        }
    }
}

/// What a person has settled already: it is asked no more.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settled {
    /// The unit.
    pub unit: bool,
    /// Which drawing is meant.
    pub view: bool,
    /// Which lines are walls.
    pub walls: bool,
    /// What is measured: regions are drawn, or points say what lies inside.
    pub floor: bool,
}

/// The one or two questions that decide most, least certain first; none where the reading is sure enough.
///
/// `walls`: the sense of every wall of the plan, with the length it draws.
pub fn questions(
    plan: &Plan,
    axes: &AxisGraph,
    walls: &[(RoleSense, f64)],
    floor: Option<&Floor>,
    settled: Settled,
) -> Vec<Doubt> {
    let unit = (!settled.unit).then(|| unit(plan, axes)).flatten();
    let view = (!settled.view).then(|| view(plan)).flatten();
    let walls = (!settled.walls).then(|| doubtful_walls(plan, walls)).flatten();
    let floor = (!settled.floor).then(|| left_out(plan, floor?)).flatten();
    // How far below its threshold each is.
    let mut found: Vec<(f64, Doubt)> =
        [(UNIT_SURE, unit), (VIEW_SURE, view), (WALLS_SURE, walls), (COVERAGE_SURE, floor)]
            .into_iter()
            .filter_map(|(sure, doubt)| doubt.map(|d| (d.confidence / sure, d)))
            .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    // In another unit nothing else is as it seems.
    found.sort_by_key(|(_, d)| !matches!(d.question, Question::Unit { .. }));
    found.truncate(QUESTIONS_MAX);
    found.into_iter().map(|f| f.1).collect()
}

/// Most questions about rooms at a time.
const ROOM_QUESTIONS_MAX: usize = 3;

/// What is no larger decides nothing: no opening into it brings anything, m² of the plan.
const DECIDING_M2: f64 = 5.0;

/// A guess at a room's kind is right about so often.
const GUESS_SURE: f64 = 0.6;

/// What a room of which a kind is guessed most likely is else: public where the guess is private, and the other way round.
fn instead_of(kind: RoomKind) -> RoomKind {
    match kind {
        RoomKind::Bedroom => RoomKind::Living,
        RoomKind::Living | RoomKind::Dining | RoomKind::Kitchen => RoomKind::Bedroom,
        RoomKind::Bath | RoomKind::Wc => RoomKind::Kitchen,
        RoomKind::Hall | RoomKind::Corridor => RoomKind::Storage,
        RoomKind::Office => RoomKind::Storage,
        _ => RoomKind::Office,
    }
}

/// What should be asked about rooms without a name, of which the kind is a guess: the largest first. Areas in m² of the
/// plan; these questions hold nothing up but what depends on the kinds of rooms.
pub fn room_questions(rooms: &[(f64, bool, &RoomKindFound)]) -> Vec<Doubt> {
    let is_asked = |(area_m2, is_named, found): &(f64, bool, &RoomKindFound)| {
        !is_named && !found.is_sure && found.kind != RoomKind::Other && *area_m2 >= DECIDING_M2
    };
    let mut asked: Vec<_> = rooms.iter().enumerate().filter(|(_, room)| is_asked(room)).collect();
    asked.sort_by(|a, b| b.1.0.total_cmp(&a.1.0));
    let doubt = |(k, (area_m2, _, found)): (usize, &(f64, bool, &RoomKindFound))| Doubt {
        confidence: GUESS_SURE,
        question: Question::Room { number: k + 1, area_m2: *area_m2, kind: found.kind },
    };
    asked.into_iter().take(ROOM_QUESTIONS_MAX).map(doubt).collect()
}

fn unit(plan: &Plan, axes: &AxisGraph) -> Option<Doubt> {
    let (taken, sense) = (plan.unit.unit, &plan.reading.unit);
    if sense.confidence >= UNIT_SURE {
        return None;
    }
    let from_person = plan.human_scale / taken.metres;
    let mut doors: Vec<f64> =
        axes.openings.iter().filter(|o| o.kind == OpeningKind::Door).map(|o| o.width_m).collect();
    doors.sort_by(f64::total_cmp);
    let thickest =
        axes.thicknesses.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map(|t| t.0).filter(|t| *t > 0.0);
    let size = extent(plan)?;
    let (witness, length) = match (doors.get(doors.len() / 2), thickest) {
        (Some(width), _) => (Witness::Door, width * from_person),
        (None, Some(thickness)) => (Witness::Wall, thickness * from_person),
        (None, None) => (Witness::Plan, size),
    };
    // Nobody drew it in a unit that the file does not state, in which the plan is smaller than a room and no door fits.
    let is_absurd = |r: &Rival| size * r.unit.metres < SIZE_M[0] && !r.has_doors;
    if !plan.unit.is_assumed && sense.runner_up.as_ref().is_some_and(is_absurd) {
        return None;
    }
    let mut units = vec![taken];
    units.extend(sense.runner_up.map(|r| r.unit));
    if units.len() < 2 {
        let fits =
            |u: &Unit| u.metres != taken.metres && (SIZE_M[0]..=SIZE_M[1]).contains(&(size * u.metres));
        units.extend(UNITS.into_iter().filter(fits));
    }
    units.truncate(ANSWERS_MAX);
    let question = Question::Unit { witness, length, units };
    Some(Doubt { confidence: sense.confidence, question })
}

/// The longer side of the walls, drawing units.
fn extent(plan: &Plan) -> Option<f64> {
    let points = plan.walls.iter().flat_map(|w| &w.trace.points).map(|p| plan.frame.file_from_um(*p));
    enfilade_cad::plane::box_of(points).map(|[lo, hi]| (hi - lo).max_element())
}

fn view(plan: &Plan) -> Option<Doubt> {
    let chosen: Vec<_> = plan.views.iter().filter(|v| v.is_chosen).collect();
    let [taken] = chosen[..] else { return None };
    if plan.views.len() < 2 || taken.confidence >= VIEW_SURE {
        return None;
    }
    let mut others: Vec<_> = plan.views.iter().filter(|v| !v.is_chosen && v.wall_pieces > 0).collect();
    others.sort_by_key(|v| std::cmp::Reverse(v.wall_pieces));
    let views: Vec<(usize, String)> =
        std::iter::once(taken).chain(others).map(|v| (v.number, v.name.clone())).take(ANSWERS_MAX).collect();
    (views.len() > 1).then_some(Doubt { confidence: taken.confidence, question: Question::View { views } })
}

/// The layer with most length in doubt, where the walls are unsure on the whole.
fn doubtful_walls(plan: &Plan, walls: &[(RoleSense, f64)]) -> Option<Doubt> {
    let length: f64 = walls.iter().map(|w| w.1).sum();
    let sure: f64 = walls.iter().map(|(s, length)| f64::from(s.confidence) * length).sum();
    if length <= 0.0 || sure / length >= WALLS_SURE {
        return None;
    }
    let mut layers: BTreeMap<&str, (f64, usize)> = BTreeMap::new();
    for (wall, (sense, length)) in plan.walls.iter().zip(walls) {
        let of = layers.entry(&wall.source.layer).or_default();
        *of = (of.0 + (1.0 - f64::from(sense.confidence)) * length, of.1 + 1);
    }
    let (layer, (_, count)) = layers.into_iter().max_by(|a, b| a.1.0.total_cmp(&b.1.0))?;
    let question = Question::Walls { layer: layer.to_owned(), count };
    Some(Doubt { confidence: sure / length, question })
}

fn left_out(plan: &Plan, floor: &Floor) -> Option<Doubt> {
    let part = floor.left_out.first().filter(|_| floor.coverage < COVERAGE_SURE)?;
    let question = Question::Floor { at: plan.frame.file_from_um(part.at), area_m2: part.area_m2 };
    Some(Doubt { confidence: floor.coverage, question })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::Area;
    use crate::{PlanOptions, understand};
    use enfilade_cad::drawing::{Drawing, Editable, Entity, Shape, SourceRef};
    use enfilade_cad::roles::Role;
    use enfilade_report::Report;

    /// Two thick walls of 10 units, 0.2 apart, on a layer of walls and one without a name.
    fn plan() -> Plan {
        let line = |record: usize, y: f64, layer: &str| Entity {
            source: SourceRef { record, handle: None, line: 0, kind: "LINE".into(), layer: layer.into() },
            layer: layer.into(),
            shape: Shape::Line { a: DVec2::new(0.0, y), b: DVec2::new(10.0, y) },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        };
        let lines = [(0.0, "WALL"), (0.2, "WALL"), (6.0, "WALL-X"), (6.2, "WALL-X")];
        let lines = lines.iter().enumerate().map(|(i, (y, layer))| line(i, *y, layer)).collect();
        let options = PlanOptions { unit: Some(UNITS[0]), ..PlanOptions::default() };
        understand(&Drawing::of(lines), &options, &mut Report::default()).unwrap()
    }

    fn asked(plan: &Plan, walls: [f32; 4], floor: Option<&Floor>, settled: Settled) -> Vec<Doubt> {
        let walls = walls.map(|confidence| (RoleSense { role: Role::Wall, confidence }, 10.0));
        let axes = AxisGraph { thicknesses: vec![(0.2, 20.0)], ..AxisGraph::default() };
        questions(plan, &axes, &walls, floor, settled)
    }

    #[test]
    fn unsure_rooms_without_a_name_are_asked_the_largest_first() {
        let found = |kind, is_sure| RoomKindFound { kind, is_sure, evidence: Vec::new(), dwelling: None };
        let (bedroom, living) = (found(RoomKind::Bedroom, false), found(RoomKind::Living, false));
        let sure = found(RoomKind::Bath, true);
        let rooms = [
            (12.3, false, &bedroom),
            (25.0, true, &living),
            (6.0, false, &sure),
            (21.0, false, &living),
            (3.0, false, &bedroom),
        ];
        let asked: Vec<Question> = room_questions(&rooms).into_iter().map(|d| d.question).collect();
        let room = |number, area_m2, kind| Question::Room { number, area_m2, kind };
        assert_eq!(asked, [room(4, 21.0, RoomKind::Living), room(1, 12.3, RoomKind::Bedroom)]);
        assert_eq!(
            asked[1].corrections(),
            [Correction::Room(1, RoomKind::Bedroom), Correction::Room(1, RoomKind::Living)]
        );
        assert_eq!(room_questions(&[(9.0, false, &bedroom); 7]).len(), ROOM_QUESTIONS_MAX);
    }

    #[test]
    fn what_is_sure_is_not_asked() {
        assert_eq!(asked(&plan(), [0.9; 4], None, Settled::default()), []);
    }

    /// A plan of 10 m whose file states metres is 0.1 m long in centimetres.
    #[test]
    fn a_rival_smaller_than_a_room_is_asked_about_where_doors_speak_for_it() {
        let mut plan = plan();
        plan.reading.unit.confidence = UNIT_SURE - 0.1;
        let mut is_asked = |rival: &str, has_doors: bool, is_assumed: bool| {
            let unit = enfilade_cad::units::unit_by_name(rival).unwrap();
            plan.reading.unit.runner_up = Some(Rival { unit, probability: 0.1, has_doors });
            plan.unit.is_assumed = is_assumed;
            !asked(&plan, [1.0; 4], None, Settled::default()).is_empty()
        };
        assert!(!is_asked("cm", false, false));
        assert!(is_asked("cm", true, false));
        assert!(is_asked("cm", false, true));
        assert!(is_asked("ft", false, false));
    }

    #[test]
    fn an_unsure_unit_asks_how_thick_a_wall_is() {
        let mut plan = plan();
        plan.reading.unit.confidence = UNIT_SURE - 0.3;
        plan.reading.unit.runner_up = Some(Rival { unit: UNITS[4], probability: 0.4, has_doors: false });
        let doubts = asked(&plan, [0.9; 4], None, Settled::default());
        let [Doubt { question, .. }] = &doubts[..] else { panic!("{doubts:?}") };
        assert!(
            matches!(question, Question::Unit { witness: Witness::Wall, length, .. } if (length - 0.2).abs() < 1e-9)
        );
        assert_eq!(question.corrections(), [Correction::Unit(UNITS[0]), Correction::Unit(UNITS[4])]);
        assert_eq!(asked(&plan, [0.9; 4], None, Settled { unit: true, ..Settled::default() }), []);
    }

    /// The layer with most in doubt; the unit stands first, for in another one nothing else is as it seems.
    #[test]
    fn doubtful_walls_and_floor_are_asked_by_how_doubtful_they_are() {
        let mut plan = plan();
        let doubtful = [0.4, 0.4, 0.1, 0.1];
        let part = Area { at: [3_000_000, 4_000_000], area_m2: 60.0, ..Area::default() };
        let floor = Floor { left_out: vec![part], coverage: 0.1, ..Floor::default() };
        let doubts = asked(&plan, doubtful, Some(&floor), Settled::default());
        let walls = Question::Walls { layer: "WALL-X".into(), count: 2 };
        let floor_asked = Question::Floor { at: DVec2::new(3.0, 4.0), area_m2: 60.0 };
        assert_eq!(doubts.iter().map(|d| &d.question).collect::<Vec<_>>(), [&floor_asked, &walls]);
        let selector = "layer:WALL-X".to_owned();
        assert_eq!(walls.corrections(), [Correction::Wall(selector.clone()), Correction::NotWall(selector)]);
        plan.reading.unit.confidence = UNIT_SURE - 0.01;
        let doubts = asked(&plan, doubtful, Some(&floor), Settled::default());
        assert_eq!(doubts.len(), QUESTIONS_MAX);
        assert!(matches!(doubts[0].question, Question::Unit { .. }));
        let settled = Settled { unit: true, walls: true, floor: true, ..Settled::default() };
        assert_eq!(asked(&plan, doubtful, Some(&floor), settled), []);
    }
}
