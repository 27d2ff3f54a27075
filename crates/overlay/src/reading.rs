//! `reading` of `enfilade.check/2`: what a drawing is taken for, as data.
//!
//! Points are in drawing units, lengths and areas in metres and square metres, confidences from 0 to 1.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::element::ElementRef;
use enfilade_report::counted;

/// What a drawing is taken for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// How sure it is in all: as sure as the least sure part.
    pub confidence: f64,
    /// How sure each part is.
    #[serde(default)]
    pub sure: SureReading,
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
    /// What a person may decide about rooms of which the kind is a guess, the largest first. They hold up nothing but what
    /// depends on it.
    #[serde(default)]
    pub room_questions: Vec<QuestionEntry>,
}

/// What the first line of `check` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Headline<'a> {
    /// How sure the reading is in all, 0 to 1.
    pub confidence: f64,
    /// Name of the unit.
    pub unit: &'a str,
    /// Drawings that are read, walls and doors understood.
    pub counts: [usize; 3],
    /// As [`Reading::coverage`].
    pub coverage: Option<f64>,
}

impl Headline<'_> {
    /// How sure the reading is and what is not covered, in one sentence.
    pub fn words(&self) -> String {
        let unit = match self.unit {
            "m" => "metres",
            "mm" => "millimetres",
            "cm" => "centimetres",
            "in" => "inches",
            "ft" => "feet",
            other => other,
        };
        let [plans, walls, doors] = self.counts.map(|n| n as u64);
        let counts = [counted(plans, "plan"), counted(walls, "wall"), counted(doors, "door")].join(", ");
        let share = self.coverage.map_or(String::new(), |c| {
            format!("; {:.0} % of the floor inside the outline is measured", c * 100.0)
        });
        format!("Read with {:.0} % confidence: {unit}, {counts}{share}.", self.confidence * 100.0)
    }
}

impl Reading {
    /// The first line of `check`.
    pub fn headline(&self) -> Headline<'_> {
        let plans = self.views.iter().filter(|v| v.chosen).count();
        let doors = self.openings.iter().filter(|o| o.kind == "door").count();
        Headline {
            confidence: self.confidence,
            unit: &self.unit.name,
            counts: [plans, self.walls.len(), doors],
            coverage: self.coverage,
        }
    }
}

/// How sure each part of a reading is, 0 to 1; `null` where it is not in question.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SureReading {
    /// The unit.
    pub unit: f64,
    /// The drawing of the sheet that is read.
    pub view: Option<f64>,
    /// What is a wall, and what is not.
    pub walls: Option<f64>,
    /// The rooms: whether somebody can enter them.
    pub rooms: Option<f64>,
    /// Whether all of the drawing is there.
    pub whole: Option<f64>,
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
    /// What it is for: `bath`, `bedroom`, `corridor`, …; `other` where that is unknown.
    #[serde(default)]
    pub kind: String,
    /// Whether nothing is opened into it unless somebody says so.
    #[serde(default)]
    pub is_private: bool,
    /// Whether its kind is more than a guess.
    #[serde(default)]
    pub is_sure: bool,
    /// The dwelling that it is part of, from 0.
    #[serde(default)]
    pub dwelling: Option<usize>,
}

impl RoomReading {
    /// The room in a line: `3: Bad, bath, private, 6.6 m²`.
    pub fn words(&self, number: usize) -> String {
        let kind = match (self.kind.as_str(), self.is_sure) {
            ("other" | "", _) => "kind unknown".to_owned(),
            (kind, true) => kind.to_owned(),
            (kind, false) => format!("probably {kind}"),
        };
        let name = Some(self.name.clone()).filter(|n| !n.is_empty());
        let private = self.is_private.then(|| "private".to_owned());
        let dwelling = self.dwelling.map(|d| format!("dwelling {}", d + 1));
        let words: Vec<String> = name.into_iter().chain([kind]).chain(private).chain(dwelling).collect();
        format!("{number}: {}, {:.1} m²", words.join(", "), self.area_m2)
    }
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
    /// `unit`, `view`, `walls`, `floor` or `room`.
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
