//! Faces to axes and openings: from drawn wall lines to the architectural graph (spec 1).
//!
//! *Frame and unit.* Everything here is in metres of a person: the plan frame divided by
//! [`super::Plan::human_scale`]. Angles are radians, anticlockwise.
//!
//! *Method.* Drawn pieces on one line become runs (`runs`); chords of traced curves become arcs
//! (`curves`); two runs that face each other at a wall's thickness become a strip (`strips`); small
//! closed boxes become columns (`columns`); strips and single lines that meet become nodes and edges
//! (`joints`); gaps between wall ends become openings (`openings`). Nothing is random and nothing
//! depends on the order of the entities beyond the numbering of the result.
//!
//! There are no errors: what cannot be understood is a [`Leftover`] with its reason.

mod assembly;
mod axis;
mod carrier;
mod cell;
mod columns;
mod curves;
mod cuts;
mod doors_by_swing;
pub(super) mod evidence;
mod joints;
#[cfg(test)]
mod limits_tests;
pub(super) mod near;
mod offset;
mod openings;
#[cfg(test)]
mod openings_tests;
mod rows;
mod runs;
mod shell;
mod solids;
mod spans;
mod strips;
pub mod swing;
#[cfg(test)]
mod tests;

use glam::DVec2;

use crate::sizes::{ERROR_GAP_M, ZERO_M};
use enfilade_cad::curve::{bulge_arc, sweep_rad};
use enfilade_cad::drawing::Shape;
use enfilade_report::counted;
pub use evidence::PANE_COVER;

/// A straight or round piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// Straight.
    Line {
        /// One end.
        a: DVec2,
        /// The other end.
        b: DVec2,
    },
    /// Round, anticlockwise from `start_rad`.
    Arc {
        /// Centre.
        centre: DVec2,
        /// Radius, > 0.
        radius: f64,
        /// Where it starts.
        start_rad: f64,
        /// How far it turns, in (0, 2π].
        sweep_rad: f64,
    },
}

/// What a metre has of the grains that places are rounded to, counted from the corner of the walls: coordinates of
/// the same walls then carry the same errors of rounding wherever they stand.
const GRAINS_PER_M: f64 = 1e9;

impl Path {
    /// The points that say where it lies: both ends, or the centre.
    fn places(&self) -> [DVec2; 2] {
        match *self {
            Self::Line { a, b } => [a, b],
            Self::Arc { centre, .. } => [centre; 2],
        }
    }

    fn placed(&self, at: impl Fn(DVec2) -> DVec2) -> Self {
        match *self {
            Self::Line { a, b } => Self::Line { a: at(a), b: at(b) },
            Self::Arc { centre, radius, start_rad, sweep_rad } => {
                Self::Arc { centre: at(centre), radius, start_rad, sweep_rad }
            }
        }
    }

    /// Both ends, in order.
    pub fn ends(&self) -> [DVec2; 2] {
        match *self {
            Self::Line { a, b } => [a, b],
            Self::Arc { centre, radius, start_rad, sweep_rad } => {
                [start_rad, start_rad + sweep_rad].map(|t| centre + DVec2::from_angle(t) * radius)
            }
        }
    }

    /// Length.
    pub fn length_m(&self) -> f64 {
        match *self {
            Self::Line { a, b } => a.distance(b),
            Self::Arc { radius, sweep_rad, .. } => radius * sweep_rad,
        }
    }
}

/// What an entity was drawn as, as far as layers and blocks say it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// A wall of full height.
    Wall,
    /// A wall to look over.
    LowWall,
    /// A wall to look through.
    Glazing,
    /// A column.
    Column,
    /// Part of a door.
    Door,
    /// Part of a window.
    Window,
    /// Not said.
    Unknown,
}

/// One piece of a drawn wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// Index of the wall ([`super::Plan::walls`]).
    pub wall: u32,
    /// Which piece: from control point `part` to the next one (0 for lines, arcs and circles).
    pub part: u32,
    /// Where it runs.
    pub path: Path,
    /// `Wall`, `LowWall`, `Glazing` or `Column`.
    pub role: Role,
    /// Whether it belongs to a closed shape: a circle, a closed polyline, also one that is closed only by
    /// its last vertex lying on its first.
    pub is_closed: bool,
    /// Width with which it is drawn, where that is a wall's thickness, metres of a person; 0 of a line.
    pub width_m: f64,
}

/// A drawn entity that is no wall but may tell about one: a door leaf, a swing, a window line.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its pieces.
    pub paths: Vec<Path>,
    /// What its layer or block says.
    pub role: Role,
    /// Marks of one block insert have one number; others have numbers of their own.
    pub group: u32,
    /// Whether the name of its layer or block gave the role.
    pub is_named: bool,
}

/// What a plan is understood from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawn {
    /// Pieces of all walls.
    pub faces: Vec<Face>,
    /// Other entities worth looking at.
    pub marks: Vec<Mark>,
}

impl Drawn {
    /// The lower left corner of the walls' places; `None` without walls, or where one lies nowhere.
    fn corner(&self) -> Option<DVec2> {
        let places = self.faces.iter().flat_map(|f| f.path.places());
        places.reduce(DVec2::min).filter(|p| p.is_finite())
    }

    /// The same with every place put elsewhere.
    fn placed(&self, at: impl Fn(DVec2) -> DVec2) -> Self {
        let mut out = self.clone();
        let faces = out.faces.iter_mut().map(|f| &mut f.path);
        faces.chain(out.marks.iter_mut().flat_map(|m| &mut m.paths)).for_each(|p| *p = p.placed(&at));
        out
    }

    fn face_ref(&self, face: u32) -> FaceRef {
        let f = &self.faces[face as usize];
        (f.wall, f.part)
    }

    /// References of faces, ascending, each once.
    fn refs(&self, faces: &[u32]) -> Vec<FaceRef> {
        let mut out: Vec<FaceRef> = faces.iter().map(|f| self.face_ref(*f)).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Those faces that run along part of a span of a carrier.
    fn along(&self, faces: &[u32], carrier: &carrier::Carrier, span: spans::Span) -> Vec<u32> {
        let is_along = |f: &&u32| {
            let path = &self.faces[**f as usize].path;
            if path.length_m() <= ZERO_M {
                return false;
            }
            let (own, s) = carrier::Carrier::of(path);
            spans::overlap(carrier.span_of(&own, s), span).is_some_and(|o| spans::length(o) > ZERO_M)
        };
        faces.iter().filter(is_along).copied().collect()
    }
}

/// The pieces of a shape; `place` turns the shape's points into metres of a person (a similarity).
///
/// Pieces keep the shape's order, so that piece `k` of a polyline joins vertices `k` and `k + 1`.
pub fn paths_of(shape: &Shape, place: impl Fn(DVec2) -> DVec2) -> Vec<Path> {
    let scale = place(DVec2::X).distance(place(DVec2::ZERO));
    match shape {
        Shape::Line { a, b } => vec![Path::Line { a: place(*a), b: place(*b) }],
        Shape::Arc { centre, radius, start_rad, end_rad } => vec![Path::Arc {
            centre: place(*centre),
            radius: radius * scale,
            start_rad: *start_rad,
            sweep_rad: sweep_rad(*start_rad, *end_rad),
        }],
        Shape::Circle { centre, radius } => vec![Path::Arc {
            centre: place(*centre),
            radius: radius * scale,
            start_rad: 0.0,
            sweep_rad: std::f64::consts::TAU,
        }],
        Shape::Polyline { vertices, closed } => {
            let count = if *closed { vertices.len() } else { vertices.len().saturating_sub(1) };
            let piece = |k: usize| {
                let (v, next) = (vertices[k], vertices[(k + 1) % vertices.len()]);
                match bulge_arc(v.at, next.at, v.bulge) {
                    Some((centre, radius, start, sweep)) => Path::Arc {
                        centre: place(centre),
                        radius: radius * scale,
                        start_rad: if sweep < 0.0 { start + sweep } else { start },
                        sweep_rad: sweep.abs(),
                    },
                    None => Path::Line { a: place(v.at), b: place(next.at) },
                }
            };
            (0..count).map(piece).collect()
        }
    }
}

/// What a node is.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeKind {
    /// A wall ends here.
    End,
    /// Two walls meet at an angle, or one changes its thickness or curvature.
    Corner,
    /// One wall meets another's side.
    Tee,
    /// Two walls cross.
    Cross,
    /// More walls meet.
    Star,
    /// A column with its outline (ring of points, not repeated).
    Column(Vec<DVec2>),
}

/// A node of the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Position.
    pub at: DVec2,
    /// What it is.
    pub kind: NodeKind,
    /// Drawn pieces that belong to the node alone: a column's outline, an end's cap or jamb.
    pub faces: Vec<FaceRef>,
}

/// A drawn piece: `(wall, part)` of a [`Face`].
pub type FaceRef = (u32, u32);

/// A wall between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Node indices.
    pub nodes: [u32; 2],
    /// Distance of the two outer faces; 0 for a single line.
    pub thickness_m: f64,
    /// tan(sweep / 4) of the arc from the first to the second node, positive anticlockwise, 0: straight.
    pub bulge: f64,
    /// What the layer of its faces says.
    pub role: Role,
    /// Pieces of the left side, seen from the first node to the second, ascending.
    pub left: Vec<FaceRef>,
    /// Pieces of the right side.
    pub right: Vec<FaceRef>,
    /// Pieces between the sides: layers, window lines drawn on the wall layer.
    pub inner: Vec<FaceRef>,
}

/// What an opening is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum OpeningKind {
    /// Walkable, with a door.
    Door,
    /// Seen through at eye level, not walkable.
    Window,
    /// Walkable, with nothing in it.
    Passage,
}

/// What shows the kind of an opening.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The name of a layer or block.
    Name,
    /// The swing of a leaf.
    Swing,
    /// What its parts are taken for, by their shape alone.
    Shape,
    /// Lines along the wall between its jambs.
    Panes,
    /// Sashes along the wall, each over a part of its width.
    Sashes,
    /// Nothing is drawn in it.
    Nothing,
    /// The outlines of two rooms touch there.
    Rooms,
}

/// A gap in a wall that is meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// What it is.
    pub kind: OpeningKind,
    /// Middle of the gap on the axis.
    pub centre: DVec2,
    /// Clear width between the jambs.
    pub width_m: f64,
    /// Thickness of the wall it lies in.
    pub thickness_m: f64,
    /// The two jambs.
    pub jambs: [Jamb; 2],
    /// What shows its kind.
    pub shown: Shown,
    /// Indices of the [`Mark`]s that belong to it and move with it, ascending.
    pub marks: Vec<u32>,
    /// Drawn wall pieces that lie in it: sills and panes on the wall layer.
    pub faces: Vec<FaceRef>,
    /// Drawn wall pieces that run through it, because the wall was drawn without a gap: between the
    /// jambs they are no wall.
    pub through: Vec<FaceRef>,
}

/// One side of an opening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jamb {
    /// Where the axis meets it.
    pub at: DVec2,
    /// The node of the wall that ends here, or of the wall whose side it is.
    pub node: Option<u32>,
    /// The wall whose side the jamb is, if no wall ends here.
    pub edge: Option<u32>,
}

/// A slip of the hand that sight must not pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure {
    /// One end.
    pub a: DVec2,
    /// The other end.
    pub b: DVec2,
}

/// A wall piece that is not part of the graph.
#[derive(Clone, Debug, PartialEq)]
pub struct Leftover {
    /// Which.
    pub face: FaceRef,
    /// Why, in plain words.
    pub reason: &'static str,
}

/// A plan's walls as a graph. See the module page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisGraph {
    /// Wall ends, junctions, columns.
    pub nodes: Vec<Node>,
    /// Walls.
    pub edges: Vec<Edge>,
    /// Doors, windows, passages.
    pub openings: Vec<Opening>,
    /// Gaps of drawing error, to be closed for sight.
    pub closures: Vec<Closure>,
    /// Wall pieces that are seen through at eye level: window lines.
    pub see_through: Vec<FaceRef>,
    /// Wall pieces without a place in the graph.
    pub leftovers: Vec<Leftover>,
    /// Thicknesses found and how much wall has each, thinnest first: (thickness m, length m).
    pub thicknesses: Vec<(f64, f64)>,
    /// What was decided, in plain words, for the report.
    pub statements: Vec<String>,
}

/// What the statement that counts walls and openings has between the two.
const UNDERSTOOD: &str = " understood; ";

/// What the statement about thicknesses begins with.
pub const THICKNESSES: &str = "wall thicknesses: ";

impl AxisGraph {
    /// Understands drawn walls, in the same way wherever they stand on the sheet.
    pub fn new(drawn: &Drawn) -> Self {
        let Some(corner) = drawn.corner() else { return Self::of(drawn) };
        let grained = |p: DVec2| {
            let rounded = (p * GRAINS_PER_M).round() / GRAINS_PER_M;
            if rounded.is_finite() { rounded } else { p }
        };
        let mut out = Self::of(&drawn.placed(|p| grained(p - corner)));
        out.place(|p| p + corner);
        out
    }

    fn of(drawn: &Drawn) -> Self {
        let mut out = Self::default();
        let (boxes, rest) = columns::take(drawn, &mut out);
        let rest = curves::find(drawn, rest);
        let runs = runs::merge(drawn, rest, &mut out);
        let paired = strips::pair(drawn, runs);
        out.thicknesses.clone_from(&paired.thicknesses);
        let axes = assembly::axes(drawn, paired, &mut out);
        let joined = joints::join(drawn, &axes, boxes, &mut out);
        openings::find(drawn, &axes, &joined, &mut out);
        out.state();
        out
    }

    fn place(&mut self, at: impl Fn(DVec2) -> DVec2) {
        for node in &mut self.nodes {
            node.at = at(node.at);
            if let NodeKind::Column(ring) = &mut node.kind {
                ring.iter_mut().for_each(|p| *p = at(*p));
            }
        }
        for opening in &mut self.openings {
            opening.centre = at(opening.centre);
            opening.jambs.iter_mut().for_each(|j| j.at = at(j.at));
        }
        for closure in &mut self.closures {
            (closure.a, closure.b) = (at(closure.a), at(closure.b));
        }
    }

    /// Position of the ends of an edge.
    pub fn ends(&self, edge: &Edge) -> [DVec2; 2] {
        edge.nodes.map(|n| self.nodes[n as usize].at)
    }

    /// Says anew how many walls and openings there are, after some were taken out or added.
    pub fn count_again(&mut self) {
        let counted = self.counted();
        self.statements.iter_mut().filter(|s| s.contains(UNDERSTOOD)).for_each(|s| s.clone_from(&counted));
    }

    /// How many columns there are.
    pub fn columns(&self) -> usize {
        self.nodes.iter().filter(|n| matches!(n.kind, NodeKind::Column(_))).count()
    }

    /// How thick the walls are, and how long those of each thickness; `scale`: metres of the drawing in one of these.
    pub fn thickness_words(&self, scale: f64) -> String {
        let decimals = if scale < 1.0 { 3 } else { 2 };
        let one = |(t, l): &(f64, f64)| format!("{:.decimals$} m ({:.0} m long)", t * scale, l * scale);
        let thick: Vec<String> = self.thicknesses.iter().map(one).collect();
        format!("{THICKNESSES}{}", thick.join(", "))
    }

    fn counted(&self) -> String {
        let count = |kind| self.openings.iter().filter(|o| o.kind == kind).count() as u64;
        let columns = self.columns();
        format!(
            "{} and {}{UNDERSTOOD}{}, {}, {}",
            counted(self.edges.len() as u64, "wall"),
            counted(columns as u64, "column"),
            counted(count(OpeningKind::Door), "door"),
            counted(count(OpeningKind::Window), "window"),
            counted(count(OpeningKind::Passage), "passage"),
        )
    }

    fn state(&mut self) {
        let mut said = vec![self.counted()];
        if !self.thicknesses.is_empty() {
            said.push(self.thickness_words(1.0));
        }
        if !self.closures.is_empty() {
            let limit = ERROR_GAP_M;
            let gaps = counted(self.closures.len() as u64, "gap");
            said.push(format!("{gaps} of drawing error (up to {limit} m) closed"));
        }
        if !self.leftovers.is_empty() {
            let mut reasons: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
            self.leftovers.iter().for_each(|l| *reasons.entry(l.reason).or_default() += 1);
            let listed: Vec<String> = reasons.iter().map(|(why, n)| format!("{n} ({why})")).collect();
            said.push(format!(
                "{} left out: {}",
                counted(self.leftovers.len() as u64, "wall piece"),
                listed.join(", ")
            ));
        }
        self.statements.extend(said);
    }
}
