//! What a format reader hands over: drawn entities in drawing units, each with its source.
//!
//! Read [`Drawing`] as follows: blocks are expanded, curves are as drawn, coordinates are finite and
//! in drawing units of the world coordinate system, entities stand in file order, layers off or
//! frozen are marked but their entities are present. Nothing about walls has been decided yet.

use enfilade_report::Place;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine2, DVec2};

use super::bearing::{Bearing, by_name};
use super::wish::Wish;

/// A file format a drawing can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Drawing exchange format.
    Dxf,
    /// Industry foundation classes, STEP.
    Ifc,
    /// glTF 2.0 as JSON text.
    Gltf,
    /// glTF 2.0 in its binary container.
    Glb,
}

impl Format {
    /// Name as in result.json and as file extension.
    pub fn name(self) -> &'static str {
        match self {
            Self::Dxf => "dxf",
            Self::Ifc => "ifc",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }

    /// The format of a name.
    pub fn named(name: &str) -> Option<Self> {
        [Self::Dxf, Self::Ifc, Self::Gltf, Self::Glb].into_iter().find(|f| f.name() == name)
    }

    /// Why what [`Editable::WithInsert`] says is not turnable does not turn.
    pub fn why_no_turn(self) -> &'static str {
        match self {
            Self::Dxf => "its INSERT has no rotation value to change",
            Self::Ifc => "its placement has no direction to change",
            Self::Gltf | Self::Glb => {
                "its node hangs below one that scales unevenly, under which a turn would skew it"
            }
        }
    }
}

/// The bytes an entity came from: the join between the plan and the file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SourceRef {
    /// Which group-0 record of the file it is, from 0 (for an entity of a block that moves as a whole: the
    /// INSERT that shows it; of one that is shown once: its own in the definition).
    pub record: usize,
    /// The entity's handle as written (upper case), if it has one.
    pub handle: Option<String>,
    /// Line of the file where the record starts, from 1; 0 where the file has no lines.
    pub line: usize,
    /// Record name: `LINE`, `LWPOLYLINE`, `INSERT`.
    pub kind: String,
    /// CAD layer, decoded.
    pub layer: String,
}

/// One vertex of a polyline; `bulge` = tan(included angle / 4) of the arc to the next vertex, positive
/// anticlockwise, 0 for a straight piece (DXF group 42).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position.
    pub at: DVec2,
    /// Bulge towards the next vertex.
    pub bulge: f64,
}

/// A drawn shape. Lengths in the unit of whoever holds it (drawing units in a [`Drawing`], metres of
/// the plan frame in a plan); angles in radians, anticlockwise from +x.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A straight piece.
    Line {
        /// Start.
        a: DVec2,
        /// End.
        b: DVec2,
    },
    /// Straight and bulged pieces; `closed` joins the last vertex with the first.
    Polyline {
        /// Vertices in order, at least one.
        vertices: Vec<Vertex>,
        /// Whether the last vertex is joined with the first.
        closed: bool,
    },
    /// A circular arc, anticlockwise from `start_rad` to `end_rad` (taken modulo a full turn).
    Arc {
        /// Centre.
        centre: DVec2,
        /// Radius, > 0.
        radius: f64,
        /// Start angle.
        start_rad: f64,
        /// End angle.
        end_rad: f64,
    },
    /// A full circle.
    Circle {
        /// Centre.
        centre: DVec2,
        /// Radius, > 0.
        radius: f64,
    },
}

/// How an entity may be written back.
#[derive(Clone, Debug, PartialEq)]
pub enum Editable {
    /// Its own coordinates can be spliced, vertex by vertex.
    Free,
    /// It is shown through one INSERT: it moves rigidly with everything that INSERT shows.
    /// `turnable` is false where the file has no rotation value to splice, or one would skew it.
    WithInsert {
        /// Whether the INSERT's rotation can be spliced.
        turnable: bool,
    },
    /// It moves rigidly with all that its record shows, and either end of that record's wall can also go along the
    /// wall's own axis: the wall changes its length.
    Wall {
        /// Control points of this shape that go with the first end, and with the second; empty where it does not
        /// reach that end.
        ends: [Vec<u32>; 2],
        /// How far each end may go into the wall before it passes a part of its body that stays, at whatever height,
        /// drawing units.
        free: [f64; 2],
    },
    /// It cannot be written back; the reason in plain words.
    No(String),
}

impl Editable {
    /// Whether it is moved by its record alone, with all that this shows.
    pub fn moves_whole(&self) -> bool {
        matches!(self, Self::WithInsert { .. } | Self::Wall { .. })
    }
}

/// An opening that can slide along its wall, with all that fills it: the wall itself stays as the file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// The opening.
    pub source: SourceRef,
    /// [`SourceRef::record`] of its wall.
    pub host: usize,
    /// What fills it, else its wall: as which it is shown closed.
    pub closing: SourceRef,
    /// What closes it, drawing units.
    pub outline: Vec<DVec2>,
    /// Corners of the wall's outlines at its first and its second side, drawing units.
    pub jambs: [Vec<DVec2>; 2],
    /// Unit vector along the wall, from the first side to the second.
    pub along: DVec2,
    /// How far it may go back (≤ 0) and forth (≥ 0) until a side of it meets a corner of the wall at any height of it,
    /// drawing units.
    pub free: [f64; 2],
}

/// One drawn entity of model space.
#[derive(Clone, Debug, PartialEq)]
pub struct Entity {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// Effective layer (an entity on layer 0 of a block has the INSERT's layer).
    pub layer: String,
    /// What was drawn.
    pub shape: Shape,
    /// How it can be written back.
    pub editable: Editable,
    /// Names of the blocks it was expanded from, outermost first; empty for a direct entity.
    pub blocks: Vec<String>,
    /// The record that draws it, in the definition where a block shows it.
    pub origin: Origin,
}

/// The record that draws an entity, and with which pen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Origin {
    /// Which group-0 record of the file it is, from 0.
    pub record: usize,
    /// Its handle as written (upper case), if it has one.
    pub handle: Option<String>,
    /// The pen by its own word.
    pub pen: Pen,
    /// Whether its type of line, or its layer's, has gaps.
    pub has_gaps: bool,
    /// Records of the INSERTs that show it, outermost first, as many as [`Entity::blocks`].
    pub inserts: Vec<usize>,
}

/// A pen by the word of one record; what the record leaves to its layer is 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pen {
    /// Colour index plus one.
    pub colour: u16,
    /// Line weight in hundredths of a millimetre, plus one.
    pub weight: u16,
    /// Whether it names a type of line of its own that is not continuous.
    pub is_own_line: bool,
}

impl Entity {
    /// Record of the INSERT with which it moves, where one shows it and it is not edited by itself.
    pub fn insert(&self) -> Option<usize> {
        (!self.blocks.is_empty() && self.source.kind == "INSERT").then_some(self.source.record)
    }
}

/// A TEXT or MTEXT of model space, formatting codes removed.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// Layer.
    pub layer: String,
    /// Insertion point, drawing units.
    pub at: DVec2,
    /// The text itself, lines joined by `\n`.
    pub text: String,
}

/// A layer as the file's table states it.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Decoded name.
    pub name: String,
    /// Switched off (negative colour).
    pub is_off: bool,
    /// Frozen (flag 1).
    pub is_frozen: bool,
    /// Locked (flag 4).
    pub is_locked: bool,
}

/// A length unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// `mm`, `cm`, `m`, `in`, `ft` or the format's own name for a rare one.
    pub name: &'static str,
    /// Metres in one unit.
    pub metres: f64,
}

/// Records of one kind on one layer that are drawn in the file and are no lines of the plan.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Undrawn {
    /// Layer, decoded.
    pub layer: String,
    /// Record name: `MLINE`.
    pub kind: String,
    /// Whether they stand on a sheet of paper instead of in model space.
    pub is_on_paper: bool,
    /// How many.
    pub count: usize,
}

/// A record of a file that draws something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Record {
    /// As in [`SourceRef::record`].
    pub record: usize,
    /// Handle as written (upper case), if it has one.
    pub handle: Option<String>,
    /// Record name: `TEXT`, `INSERT`.
    pub kind: String,
}

/// A straight dimension.
#[derive(Clone, Debug, PartialEq)]
pub struct Dimension {
    /// What it measures, drawing units, > 0.
    pub measured: f64,
    /// What is written at it, formatting codes removed: `3,50`, `12'-6"`; empty where nothing is.
    pub text: String,
}

/// What a drawing writes about lengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Written {
    /// Its straight dimensions, file order.
    pub dimensions: Vec<Dimension>,
    /// Heights of the letters of its texts, drawing units, > 0, file order.
    pub heights: Vec<f64>,
    /// Whether the file says that it is metric or imperial, without a unit.
    pub is_metric: Option<bool>,
}

/// Something that stands on the floor, as the file calls it.
#[derive(Clone, Debug, PartialEq)]
pub struct Called {
    /// Its names, those of its type, its class, parted by blanks: `wc-01 IfcSanitaryTerminal TOILETPAN`.
    pub words: String,
    /// The lower left and the upper right corner of its box, drawing units.
    pub extent: [DVec2; 2],
    /// Where it stands in the file, if it is furniture that can be moved.
    pub source: Option<SourceRef>,
}

/// What a file states of moves that the plan read of it cannot use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum IdleMarks {
    /// Nothing.
    #[default]
    None,
    /// Of other storeys alone, whose own plans use it.
    Elsewhere,
    /// Of this plan.
    Unusable,
}

/// A drawing as read, before anything is understood. See the module page.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// File name to show in places.
    pub file: String,
    /// Format it came from.
    pub format: Format,
    /// Version in the format's words: `AC1009 (R12)`.
    pub version: String,
    /// Unit the file declares, if it declares one that is known.
    pub declared_unit: Option<Unit>,
    /// What the header said about units, in words: `$INSUNITS 4`, `no $INSUNITS`.
    pub declared_unit_words: String,
    /// Unit in which a reader took heights where the file states none, or one in which the walls cannot be as high as
    /// they are; `None`: the declared one.
    pub unit_by_heights: Option<Unit>,
    /// Layer table, file order; layers used but not defined are appended.
    pub layers: Vec<Layer>,
    /// Drawn shapes of model space in file order.
    pub entities: Vec<Entity>,
    /// Filled areas of model space with one outline, in file order: in DXF what HATCH with a solid fill, SOLID and
    /// TRACE show. Where no line is drawn round them they may be columns.
    pub fills: Vec<Entity>,
    /// Texts of model space in file order.
    pub texts: Vec<Text>,
    /// Attributes that INSERTs of model space show, each on a layer that is named as its tag: room tags, title blocks.
    pub tags: Vec<Text>,
    /// Moves that the file states of its own elements.
    pub marked: Vec<MarkedMove>,
    /// What the file says besides of what should move or stay; it was named where it was read.
    pub idle_marks: IdleMarks,
    /// Records of doors and windows of which the file says in which record's wall they sit.
    pub hosts: BTreeMap<usize, usize>,
    /// Openings that can slide along their walls.
    pub slots: Vec<Slot>,
    /// Records that carry, hold fire up or part dwellings as far as the file says it or shows it.
    pub bearing: BTreeMap<usize, Bearing>,
    /// What stands on the floor of a building and is no line of its plan, since the cut passes over it: record and outline.
    pub things: Vec<(usize, Vec<DVec2>)>,
    /// What stands on the floor, with all that the file calls it: sanitary ware, furniture, machines.
    pub called: Vec<Called>,
    /// Records of polylines that are drawn in one width all along, with that width in the units of the model space or
    /// the block they stand in, > 0.
    pub widths: BTreeMap<usize, f64>,
    /// Records whose corners, once moved, the file holds in single precision.
    pub singles: BTreeMap<usize, Single>,
    /// What else is drawn, by layer and kind.
    pub undrawn: Vec<Undrawn>,
    /// External files that are shown and were not opened.
    pub unbound: usize,
    /// Records of model space and of the blocks it shows, ascending: shapes, texts, INSERTs, dimensions and the like.
    /// Empty for formats without such.
    pub records: Vec<Record>,
    /// What is written about lengths.
    pub written: Written,
    /// Where the file says that north is: degrees anticlockwise from the drawing's up; 0 where it says nothing.
    pub north_deg: f64,
    /// Records of walls that the file says are to be built.
    pub built: BTreeSet<usize>,
    /// What the file asks of its own rooms and doors.
    pub wishes: Vec<Wish>,
}

/// A frame of its own in which a file holds places in numbers of single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Single {
    to_file: DAffine2,
    from_file: DAffine2,
}

impl Single {
    /// `to_file`: from the frame to drawing units; `None` where it has no way back.
    pub fn new(to_file: DAffine2) -> Option<Self> {
        let from_file = to_file.inverse();
        (to_file.is_finite() && from_file.is_finite()).then_some(Self { to_file, from_file })
    }

    /// Where a point is once the file holds it, drawing units.
    pub fn held(&self, p: DVec2) -> DVec2 {
        self.to_file.transform_point2(self.from_file.transform_point2(p).as_vec2().as_dvec2())
    }
}

/// A move that the file states of one of its elements (`Pset_Enfilade` of a building).
#[derive(Clone, Debug, PartialEq)]
pub struct MarkedMove {
    /// Name of the group; elements that state one name and one move go together.
    pub name: String,
    /// Whether the name is stated with the move, else it is the element's own.
    pub is_named: bool,
    /// Clauses as on the `EF-MOVE` layer: `x -1 1; rotate -15 15`.
    pub text: String,
    /// [`SourceRef::record`] of the element.
    pub record: usize,
    /// Where it is stated.
    pub source: SourceRef,
}

/// A turn about the origin followed by a shift: `p' = R(turn_rad)·p + shift`, drawing units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Anticlockwise turn.
    pub turn_rad: f64,
    /// Shift after the turn.
    pub shift: DVec2,
}

/// What stands in an opening.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filling {
    /// Nothing; above it the wall goes on, as over a door.
    #[default]
    Nothing,
    /// Nothing from the floor to the top: the wall ends there.
    Gone,
    /// A leaf.
    Door,
    /// A pane.
    Glass,
}

/// A change of one drawn entity, in drawing units; only values that differ from the file are spliced.
#[derive(Clone, Debug, PartialEq)]
pub enum Edit {
    /// New geometry of the entity at `record`; same variant and same vertex count as read.
    Shape {
        /// [`SourceRef::record`].
        record: usize,
        /// The new geometry.
        shape: Shape,
    },
    /// Moves the INSERT at `record` rigidly.
    Insert {
        /// [`SourceRef::record`].
        record: usize,
        /// The motion.
        motion: RigidMotion,
    },
    /// Moves the ends of the wall at `record` along its axis: its length changes. Where the wall is moved as well,
    /// an [`Edit::Insert`] of its own says so.
    Ends {
        /// [`SourceRef::record`].
        record: usize,
        /// How far its first and its second end go, drawing units, positive from the first towards the second.
        by: [f64; 2],
    },
    /// New places of the points of the filled area at `record`, which goes along with the walls that it fills.
    Points {
        /// [`SourceRef::record`].
        record: usize,
        /// All that the file states: corners, centres of arcs and points inside, in its order.
        points: Vec<DVec2>,
    },
    /// A building work on the entity at `record`.
    Work {
        /// [`SourceRef::record`].
        record: usize,
        /// What is done.
        work: EntityWork,
    },
}

/// What a building work does to one entity; all in drawing units. A drawing knows lines and fills, a building elements: what
/// either cannot do it refuses.
#[derive(Clone, Debug, PartialEq)]
pub enum EntityWork {
    /// A drawn line is cut: the first part keeps the record, new ones behind it are alike. At least one.
    Cut {
        /// What stays, in the order of the line.
        parts: Vec<Shape>,
    },
    /// A stretch of a wall of a building, or of what fills a drawn one, goes.
    Void {
        /// The stretch with both faces, corners in ring order.
        gone: [DVec2; 4],
        /// What stands there afterwards.
        filling: Filling,
    },
    /// The entity is demolished: in a drawing it goes to [`own_layers::DEMOLISHED`](super::own_layers::DEMOLISHED).
    Drop,
    /// Another one of the block that an INSERT shows, behind it.
    Copy {
        /// Where it stands: that of the first one, moved.
        motion: RigidMotion,
    },
    /// Something new, behind the entity and with its properties.
    Build {
        /// In a drawing lines, in a building the outlines of bodies.
        shapes: Vec<Shape>,
    },
}

impl Edit {
    /// Whether it is a building work.
    pub fn is_work(&self) -> bool {
        matches!(self, Self::Work { .. })
    }

    /// [`SourceRef::record`] of what it changes.
    pub fn record(&self) -> usize {
        match self {
            Self::Shape { record, .. }
            | Self::Insert { record, .. }
            | Self::Ends { record, .. }
            | Self::Points { record, .. }
            | Self::Work { record, .. } => *record,
        }
    }

    /// Whether it moves something by nothing.
    pub fn is_still(&self) -> bool {
        match self {
            Self::Shape { .. } | Self::Points { .. } | Self::Work { .. } => false,
            Self::Insert { motion, .. } => motion.turn_rad == 0.0 && motion.shift == DVec2::ZERO,
            Self::Ends { by, .. } => *by == [0.0; 2],
        }
    }
}

/// Something of ours to add to a drawing, in drawing units, on a layer of ours.
#[derive(Clone, Debug, PartialEq)]
pub struct Addition {
    /// `EF-…` layer; made if the file lacks it.
    pub layer: String,
    /// Colour, sRGB; formats without true colour take the nearest index.
    pub rgb: [u8; 3],
    /// What to draw.
    pub mark: Mark,
}

/// The kinds of things we draw.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Straight pieces through the points.
    Path {
        /// Corners, at least two.
        points: Vec<DVec2>,
        /// Whether the last is joined with the first.
        closed: bool,
    },
    /// A filled quadrilateral, corners in ring order.
    Fill {
        /// Corners.
        corners: [DVec2; 4],
    },
    /// Text, lines separated by `\n`, starting at its lower left corner (first line).
    Text {
        /// Lower left corner of the first line.
        at: DVec2,
        /// Letter height, > 0.
        height: f64,
        /// Plain text.
        text: String,
    },
}

/// `LWPOLYLINE 2F3 layer EF-MOVE` at its line.
pub fn place(drawing: &Drawing, source: &SourceRef) -> Place {
    place_in(&drawing.file, source)
}

/// The place of an entity in a file shown as `file`.
pub fn place_in(file: &str, source: &SourceRef) -> Place {
    let handle = source.handle.as_deref().map(|h| format!(" {h}")).unwrap_or_default();
    let place = if source.line == 0 { Place::file(file) } else { Place::line(file, source.line) };
    place.entity(format!("{}{handle} layer {}", source.kind, source.layer))
}

impl Drawing {
    /// The structure by record: what the reader knows, then what layers say.
    pub fn structure(&self) -> BTreeMap<usize, Bearing> {
        let mut out = self.bearing.clone();
        for e in &self.entities {
            if let Some(bearing) = by_name(&e.layer) {
                out.entry(e.source.record).or_insert(bearing);
            }
        }
        out
    }

    /// A DXF of some entities that says nothing else.
    pub fn of(entities: Vec<Entity>) -> Self {
        Self {
            file: "plan.dxf".into(),
            format: Format::Dxf,
            version: String::new(),
            declared_unit: None,
            declared_unit_words: String::new(),
            unit_by_heights: None,
            layers: Vec::new(),
            entities,
            fills: Vec::new(),
            texts: Vec::new(),
            marked: Vec::new(),
            idle_marks: IdleMarks::None,
            hosts: BTreeMap::new(),
            slots: Vec::new(),
            bearing: BTreeMap::new(),
            things: Vec::new(),
            tags: Vec::new(),
            called: Vec::new(),
            widths: BTreeMap::new(),
            singles: BTreeMap::new(),
            undrawn: Vec::new(),
            unbound: 0,
            records: Vec::new(),
            written: Written::default(),
            north_deg: 0.0,
            wishes: Vec::new(),
            built: Default::default(),
        }
    }
}
