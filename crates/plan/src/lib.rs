//! The model: a plan in metres, and how it is understood from a drawing.
//!
//! Whoever holds a [`Plan`] need not think any more about: units, layers, blocks, codes of a format,
//! coordinates far from zero, curves (they are traced to straight pieces), or shapes of no size.
//!
//! A room of four walls, drawn in metres:
//!
//! ```
//! use enfilade_plan::{PlanOptions, understand};
//! use enfilade_report::Report;
//!
//! let corners = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]];
//! let line = |ends: &[[i32; 2]]| {
//!     let [[ax, ay], [bx, by]] = [ends[0], ends[1]];
//!     format!("0\nLINE\n8\nWALLS\n10\n{ax}\n20\n{ay}\n11\n{bx}\n21\n{by}\n")
//! };
//! let walls: String = corners.windows(2).map(line).collect();
//! let header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n";
//! let dxf = format!("{header}0\nSECTION\n2\nENTITIES\n{walls}0\nENDSEC\n0\nEOF\n");
//!
//! let mut report = Report::default();
//! let drawing = enfilade_cad::read("room.dxf", dxf.as_bytes(), &Default::default(), &mut report)?;
//! let plan = understand(&drawing, &PlanOptions::default(), &mut report)?;
//! assert_eq!(plan.walls.len(), 4);
//! # Ok::<(), enfilade_report::Error>(())
//! ```

pub mod allowed;
pub mod asked;
pub mod at_walls;
pub mod axes;
pub mod body_sides;
pub mod by_place;
mod choice;
mod crowd;
pub mod curve;
pub mod decided;
pub mod dots;
pub mod drawn;
pub mod far_off;
mod fills;
pub mod fittings;
pub mod floor;
pub mod frame;
pub mod graph;
pub mod hidden;
pub mod infill;
pub mod kinds;
pub mod labels;
mod leaves;
mod length;
pub mod markers;
pub mod obstacles;
mod on_sheet;
mod outdoors;
pub mod outline;
pub mod parallels;
mod paving;
pub mod reading;
mod repeats;
pub mod rooms;
mod rounds;
pub mod sight;
pub mod sizes;
pub mod slots;
mod stairs;
mod storeys;
pub mod structure;
mod understand;
pub mod units;
pub mod view_box;
pub mod view_names;
pub mod views;
pub mod wide;

use std::collections::BTreeMap;

use curve::Trace;
use enfilade_cad::bearing;
use enfilade_cad::drawing::{Editable, Format, Shape, Single, SourceRef, Unit};
use enfilade_engine::geometry::PointUm;
use frame::{Frame, UnitChoice};
use markers::Markers;
use reading::corrections::Corrections;
use views::View;

pub use understand::understand;

/// One drawn wall element: a line, an outline, an arc, a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// How it can be written back.
    pub editable: Editable,
    /// As drawn, drawing units.
    pub shape: Shape,
    /// As straight pieces, drawing frame, micrometres.
    pub trace: Trace,
    /// Whether its closed outline is filled: a column, or a wall drawn as an outline (spec 3).
    pub is_solid: bool,
    /// Width of a polyline that is drawn as wide as a wall is thick, micrometres; 0 of anything else ([`wide`]).
    pub width_um: i64,
    /// Where the file holds its corners in single precision once they move: in what frame.
    pub single: Option<Single>,
    /// What draws it.
    pub drawn_by: DrawnBy,
}

/// What draws a wall; of one that a decided work cuts, several walls have the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnBy {
    /// An entity: its place in [`Plan::picked`].
    Picked(usize),
    /// A mark on `EF-NEW`: the index of its entity in the drawing.
    Mark(usize),
}

/// What closes an opening of a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Plug {
    /// [`SourceRef::record`] of the wall.
    pub host: usize,
    /// Its outline.
    pub outline: Trace,
    /// The opening that it goes with, where that can slide: its place in [`Plan::slots`].
    pub slot: Option<usize>,
}

/// Layer of the doors of a building.
pub const DOOR_LAYER: &str = "IfcDoor";

/// Layer of a building's openings that nothing fills.
pub const OPENING_LAYER: &str = "IfcOpeningElement";

/// A door that the file calls so.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDoor {
    /// [`SourceRef::record`] of the wall it sits in, where the file says it.
    pub host: Option<usize>,
    /// What it closes.
    pub outline: Trace,
    /// The opening that it goes with, where that can slide: its place in [`Plan::slots`].
    pub slot: Option<usize>,
}

/// What became of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerUse {
    /// Decoded name.
    pub name: String,
    /// Shapes and texts on it; of a building its elements.
    pub entities: usize,
    /// `wall`, `low`, `marker`, `own`, `hidden` or `ignored`.
    pub role: &'static str,
    /// Why, in plain words.
    pub why: String,
}

/// A plan as understood. See the module page.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// File name to show in places.
    pub file: String,
    /// Format the drawing came from.
    pub format: Format,
    /// Version of the format in its own words.
    pub version: String,
    /// Unit and why.
    pub unit: UnitChoice,
    /// Drawing units ↔ drawing frame ↔ plan frame.
    pub frame: Frame,
    /// Wall elements in file order.
    pub walls: Vec<Wall>,
    /// Which entities the walls are: ordinals among the drawing's entities that are not on layers of
    /// ours. With them in [`PlanOptions::picked`] a changed copy gives the same walls.
    pub picked: Vec<usize>,
    /// The user's marks.
    pub markers: Markers,
    /// Building works that are decided; the walls are as they will be.
    pub decided: Vec<decided::Decided>,
    /// What became of every layer that holds something.
    pub layers: Vec<LayerUse>,
    /// The drawings of the sheet, at least one; one of them was read unless `--view all` was said.
    pub views: Vec<View>,
    /// Metres of the plan in one metre of a person; 1 unless the plan is far too small
    /// ([`frame::human_scale`]).
    pub human_scale: f64,
    /// Doors and windows in walls that the file names.
    pub plugs: Vec<Plug>,
    /// The doors of a building, where the file calls them so.
    pub doors: Vec<NamedDoor>,
    /// Openings that can slide along their walls.
    pub slots: Vec<slots::Slot>,
    /// Records of walls that stay unless somebody says otherwise, and why; empty where they may move as well.
    pub bearing: BTreeMap<usize, bearing::Bearing>,
    /// What stands in the rooms: what slides must not run into it.
    pub obstacles: Vec<obstacles::Obstacle>,
    /// Ground that layers say is outdoors, rings in the drawing frame, micrometres: no interior.
    pub outdoors: Vec<Vec<PointUm>>,
    /// What every entity was taken for, and how sure that is.
    pub reading: reading::Reading,
    /// The same of what is not ours, for [`PlanOptions::senses`].
    pub senses: Vec<reading::RoleSense>,
    /// Where north is: degrees anticlockwise from up.
    pub north_deg: f64,
}

/// The user's word on how to read a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanOptions {
    /// `--unit`.
    pub unit: Option<Unit>,
    /// `--wall-layer`, globs.
    pub wall_layers: Vec<String>,
    /// `--query-layer` instead of `EF-QUERY`.
    pub query_layer: Option<String>,
    /// `--reference-layer` instead of `EF-REFERENCE`.
    pub reference_layer: Option<String>,
    /// `--view`: name or number of a drawing on the sheet, `all`, or a box round it.
    pub view: Option<String>,
    /// `--level knee`: low walls and glazing block too.
    pub is_knee_level: bool,
    /// The walls by [`Plan::picked`] of an earlier reading; nothing is chosen then.
    pub picked: Option<Vec<usize>>,
    /// What everything was taken for in an earlier reading ([`reading::Reading::kept`]).
    pub senses: Option<Vec<reading::RoleSense>>,
    /// What the user says of entities and of the floor.
    pub corrections: Corrections,
}

impl PlanOptions {
    /// Whether a choice is ours: the user named no layers of walls, and nothing was chosen before.
    fn is_our_choice(&self) -> bool {
        self.picked.is_none() && self.wall_layers.is_empty() && !self.corrections.as_drawn
    }
}
