//! What was asked, and what was found.

use enfilade_brief::demand::{Demand, DemandKind};
use enfilade_engine::geometry::PointUm;
use serde::{Deserialize, Serialize};

use crate::building::{OpeningId, RoomId};

/// Whether an item holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// It holds.
    Pass,
    /// A plan cannot tell.
    Untold,
    /// It does not hold.
    Fail,
}

/// Who asks.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// The brief.
    Said,
    /// A rule set: its title with edition, and what it says there.
    Rule {
        /// Name of the set.
        rule: String,
        /// Title and edition.
        title: String,
        /// Where it stands in the source.
        place: String,
    },
    /// The drawing: the name of its property or layer.
    Drawing(String),
}

/// An item with who asks it.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The item.
    pub demand: Demand,
    /// Who asks.
    pub origin: Origin,
    /// Ground of a mark that is asked of instead of a room, drawing frame, micrometres.
    pub ground: Option<Vec<PointUm>>,
}

impl Asked {
    /// An item of the brief itself.
    pub fn said(demand: Demand) -> Self {
        Self { demand, origin: Origin::Said, ground: None }
    }
}

/// Something to be shown on a map; drawing frame, micrometres.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Ground: outlines and holes.
    Ground(Vec<Vec<PointUm>>),
    /// A way or a stretch.
    Line(Vec<PointUm>),
    /// A circle: its middle and radius, micrometres.
    Circle(PointUm, i64),
}

/// What was found at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Whether the item holds here.
    pub verdict: Verdict,
    /// Rooms that it is about; the first is the subject.
    pub rooms: Vec<RoomId>,
    /// Doors and openings that it is about.
    pub openings: Vec<OpeningId>,
    /// The value, in the unit of the kind.
    pub measured: Option<f64>,
    /// Where.
    pub marks: Vec<Mark>,
    /// What else is to be known: why a plan cannot tell, what was assumed.
    pub note: Option<String>,
}

impl Finding {
    /// About a room.
    pub fn of_room(verdict: Verdict, room: RoomId, measured: Option<f64>) -> Self {
        Self { verdict, rooms: vec![room], openings: Vec::new(), measured, marks: Vec::new(), note: None }
    }

    /// About ground of a mark.
    pub(crate) fn of_ground(verdict: Verdict, measured: f64) -> Self {
        let (rooms, openings, marks) = Default::default();
        Self { verdict, rooms, openings, measured: Some(measured), marks, note: None }
    }

    /// What a plan cannot tell.
    pub fn untold(note: impl Into<String>) -> Self {
        let note = Some(note.into());
        let verdict = Verdict::Untold;
        Self { verdict, rooms: Vec::new(), openings: Vec::new(), measured: None, marks: Vec::new(), note }
    }

    pub(crate) fn at(mut self, marks: impl IntoIterator<Item = Mark>) -> Self {
        self.marks.extend(marks);
        self
    }

    pub(crate) fn through(mut self, openings: impl IntoIterator<Item = OpeningId>) -> Self {
        self.openings.extend(openings);
        self
    }

    pub(crate) fn noted(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }
}

/// An item with what was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// The item.
    pub asked: Asked,
    /// The worst of the findings.
    pub verdict: Verdict,
    /// What was found, place by place.
    pub findings: Vec<Finding>,
}

impl Answer {
    /// Of an item.
    pub fn new(asked: Asked, findings: Vec<Finding>) -> Self {
        let worst = findings.iter().map(|f| f.verdict).max();
        Self { asked, verdict: worst.unwrap_or(Verdict::Untold), findings }
    }

    /// What is asked.
    pub fn kind(&self) -> DemandKind {
        self.asked.demand.kind
    }
}
