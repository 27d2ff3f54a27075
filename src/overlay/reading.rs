//! `reading` of `enfilade.check/2`: what a drawing is taken for, as data.
//!
//! Points are in drawing units, lengths and areas in metres and square metres, confidences from 0 to 1.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::result::ElementRef;

/// What a drawing is taken for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// The unit and how sure it is.
    pub unit: UnitReading,
    /// The drawings of the sheet.
    pub views: Vec<ViewReading>,
    /// Every record that draws something, those of shown block definitions once each.
    pub entities: Vec<EntityReading>,
    /// Walls as understood.
    pub walls: Vec<WallReading>,
    /// Doors, windows and passages.
    pub openings: Vec<OpeningReading>,
    /// Rooms, from left to right in rows from the top.
    pub rooms: Vec<RoomReading>,
    /// The measured floor.
    pub interior: Vec<AreaReading>,
    /// Measured floor by the floor inside the building's outline; `null` where the walls have no outline.
    pub coverage: Option<f64>,
    /// What a person should decide, least certain first.
    pub questions: Vec<QuestionEntry>,
}

impl Reading {
    /// Mean confidence of what is taken as walls and columns; `None` without any.
    pub fn walls_confidence(&self) -> Option<f64> {
        let of_walls = self.entities.iter().filter(|e| matches!(e.role.as_str(), "wall" | "column"));
        let (sum, count) = of_walls.fold((0.0, 0.0), |(sum, n), e| (sum + e.confidence, n + 1.0));
        (count > 0.0).then(|| sum / count)
    }

    /// How sure the reading is in all: as sure as the least sure of unit, chosen views and walls.
    pub fn confidence(&self) -> f64 {
        let views = self.views.iter().filter(|v| v.chosen).map(|v| v.confidence);
        views.chain(self.walls_confidence()).fold(self.unit.confidence, f64::min)
    }

    /// How many openings are of a kind.
    pub fn count(&self, kind: &str) -> usize {
        self.openings.iter().filter(|o| o.kind == kind).count()
    }
}

/// The unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitReading {
    /// Metres in one unit.
    pub metres: f64,
    /// `mm`, `m`, `ft`, …
    pub name: String,
    /// How sure it is.
    pub confidence: f64,
    /// Codes of what spoke for it, the strongest first.
    pub reasons: Vec<String>,
    /// The next best.
    pub runner_up: Option<UnitRival>,
}

/// A unit that was not taken.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UnitRival {
    /// Metres in one unit.
    pub metres: f64,
    /// Its name.
    pub name: String,
    /// How likely it is.
    pub confidence: f64,
}

/// A drawing of the sheet.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ViewReading {
    /// Its title, or `drawing N`.
    pub name: String,
    /// `plan`, `section`, `elevation`, `detail`, `site`, `legend`, `title` or `other`.
    pub kind: String,
    /// xmin, ymin, xmax, ymax.
    #[serde(rename = "box")]
    pub extent: [f64; 4],
    /// Whether the plan is read from it.
    pub chosen: bool,
    /// How sure kind and box are.
    pub confidence: f64,
}

/// What a record is taken for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EntityReading {
    /// Which.
    pub element: ElementRef,
    /// `wall`, `column`, `door`, `window`, `stair`, `furniture`, `sanitary`, `railing`, `annotation`, `dimension`, `hatch`,
    /// `grid`, `outside`, `title` or `other`.
    pub role: String,
    /// How sure that is.
    pub confidence: f64,
}

/// A wall from joint to joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallReading {
    /// Its axis; a curved one as chords.
    pub axis: Vec<[f64; 2]>,
    /// Distance of its faces; 0 for a single line.
    pub thickness_m: f64,
    /// What draws it.
    pub elements: Vec<ElementRef>,
}

/// A door, a window or a passage.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OpeningReading {
    /// `door`, `window` or `passage`.
    pub kind: String,
    /// Its middle.
    pub at: [f64; 2],
    /// Clear width.
    pub width_m: f64,
    /// The wall it lies in: index into `walls`.
    pub wall: Option<usize>,
    /// What draws it.
    pub elements: Vec<ElementRef>,
}

/// A room.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoomReading {
    /// The text in it; empty where there is none.
    pub name: String,
    /// Its floor.
    pub area_m2: f64,
    /// Its outline.
    pub outline: Vec<[f64; 2]>,
    /// Doors and passages that lead into it: indices into `openings`.
    pub doors: Vec<usize>,
}

/// An area with holes.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AreaReading {
    /// Its outline.
    pub outline: Vec<[f64; 2]>,
    /// What is cut out of it.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// What a person should decide.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct QuestionEntry {
    /// `unit`, `view`, `walls` or `floor`.
    pub about: String,
    /// How sure the reading is of this.
    pub confidence: f64,
    /// The numbers and names that the question is about.
    #[serde(default)]
    pub values: Map<String, Value>,
    /// The question.
    pub text: String,
    /// The answers, that of the present reading first.
    pub answers: Vec<AnswerEntry>,
}

/// An answer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AnswerEntry {
    /// The answer.
    pub text: String,
    /// The correction that gives it, as in the side-car's `[reading]`.
    pub correction: Map<String, Value>,
    /// The same for the command line.
    pub option: String,
}
