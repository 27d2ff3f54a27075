//! Building works in a building: openings that void walls, and elements that are to go.

use glam::{DAffine3, DVec2, DVec3};

use super::ReadOptions;
use super::additions::{Writer, refs};
use super::alike::{Bar, Door};
use super::building::Building;
use super::geo::is_upright;
use super::number::real;
use super::placed::{Base, Body};
use super::standing::reach;
use super::step::Arg;
use crate::drawing::{Edit, EntityWork, Filling, Shape};
use crate::sizes::{BELOW_FLOOR_M, LEAF_M, OPENING_HEIGHT_M};
use crate::splice::Splice;
use crate::step_text::encode;
use enfilade_report::{Error, Place, Report};

/// What makes works.
pub(super) struct Written {
    /// New instances, each with its line end.
    pub added: Vec<u8>,
    /// Lists that name them: what is new has the type of what is like it.
    pub splices: Vec<Splice>,
    /// The next free number.
    pub next: u64,
}

/// What makes the works of some edits; the others are left to their own.
///
/// # Errors
/// [`Error::Input`] for a work that is not written in a building, and for an element that is not there.
pub(super) fn text(
    b: &Building<'_, '_>,
    options: &ReadOptions,
    next: u64,
    edits: &[Edit],
) -> Result<Written, Error> {
    if !edits.iter().any(Edit::is_work) {
        return Ok(Written { added: Vec::new(), splices: Vec::new(), next });
    }
    let storey = b.storey(options.storey.as_deref(), options.sight, &mut Report::default())?;
    let mut writer = Writer::new(b, next, storey.map_or(0.0, |s| s.floor));
    for edit in edits {
        let Edit::Work { record, work } = edit else { continue };
        let id = *record as u64;
        let fault = |why: &str| {
            let line = b.step.get(id).map(|i| b.step.line(i.span.start));
            let place = Place { file: b.file.into(), line, entity: b.geo.named(id) };
            Error::input("ifc-edit", place, format!("{why}; nothing was written"))
        };
        if b.step.get(id).is_none() {
            return Err(fault("found no such element, expected a wall"));
        }
        match work {
            EntityWork::Void { gone, filling } => {
                let door = Door::like(b, gone, storey.map(|s| s.id)).filter(|_| *filling == Filling::Door);
                let opening = writer.opening(id, gone, (*filling, door));
                writer.filled(opening, gone, (*filling, door), storey.map(|s| s.id));
            }
            EntityWork::Drop => writer.demolished(id),
            EntityWork::Build { shapes } => {
                let heights = reach(b, id).ok_or_else(|| fault("it has no height for a new wall"))?;
                for shape in shapes {
                    let ring = ring(shape).ok_or_else(|| fault("a new wall has no outline"))?;
                    writer.wall(id, (&ring, heights), storey.map(|s| s.id));
                }
            }
            EntityWork::Cut { .. } | EntityWork::Copy { .. } => {
                return Err(fault("an element of a building has no lines"));
            }
        }
    }
    let splices = writer.type_lists();
    let (added, next) = writer.into_parts();
    Ok(Written { added, splices, next })
}

/// The corners of a body as it stands on the floor.
fn ring(shape: &Shape) -> Option<Vec<DVec2>> {
    match shape {
        Shape::Polyline { vertices, closed: true } if vertices.len() > 2 => {
            Some(vertices.iter().map(|v| v.at).collect())
        }
        _ => None,
    }
}

/// Height of a new door: that of its like.
fn height_m(door: Option<Door>) -> f64 {
    door.map_or(OPENING_HEIGHT_M, |d| d.height_m)
}

/// Decimals of a coordinate that is turned into another frame: below them lies rounding.
const DECIMALS: f64 = 1e9;

/// A coordinate without the rounding of a turn.
fn rounded(v: f64) -> String {
    let short = (v * DECIMALS).round() / DECIMALS;
    real(if short.is_finite() { short + 0.0 } else { v })
}

impl Writer<'_, '_, '_> {
    /// The placement of an element or a storey, for what belongs to it; the world's where it lies askew.
    fn base(&self, id: u64) -> Base {
        let placement = self.b.step.args(id).get(5).and_then(Arg::id);
        let upright = |p: u64| {
            let world = self.b.geo.placement(p).ok().filter(is_upright)?;
            Some(Base { placement: Some(p), world })
        };
        placement.and_then(upright).unwrap_or(Base { placement: None, world: DAffine3::IDENTITY })
    }

    /// An upright body over a ring, placed by `base` about its first corner: coordinates of a map have too many digits for
    /// some programs.
    fn body(&mut self, base: Base, ring: &[DVec2], [z, top]: [f64; 2]) -> Body {
        let zero = base.world.inverse().transform_point3(ring[0].extend(z));
        self.body_at(base, DAffine3::from_translation(zero), ring, top - z)
    }

    /// The same in a frame of its own, relative to `base`.
    fn body_at(&mut self, base: Base, frame: DAffine3, ring: &[DVec2], height: f64) -> Body {
        let world = base.world * frame;
        let z = world.translation.z;
        let local = |p: &DVec2| world.inverse().transform_point3(p.extend(z));
        let mut corners: Vec<u64> = ring.iter().map(|p| self.flat(local(p).truncate())).collect();
        corners.push(corners[0]);
        let line = self.add(&format!("IFCPOLYLINE({})", refs(&corners)));
        let profile = self.add(&format!("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{line})"));
        let origin = self.add("IFCCARTESIANPOINT((0.,0.,0.))");
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
        let up = self.add("IFCDIRECTION((0.,0.,1.))");
        let item = self.add(&format!("IFCEXTRUDEDAREASOLID(#{profile},#{axes},#{up},{})", real(height)));
        let context = self.context.map_or("$".into(), |c| format!("#{c}"));
        let shown = self.add(&format!("IFCSHAPEREPRESENTATION({context},'Body','SweptSolid',(#{item}))"));
        let placement = self.placement(base, &frame);
        Body { placement, item, shown, base: Base { placement: Some(placement), world } }
    }

    /// A point of a flat curve.
    fn flat(&mut self, p: DVec2) -> u64 {
        self.add(&format!("IFCCARTESIANPOINT(({},{}))", rounded(p.x), rounded(p.y)))
    }

    /// An upright placement relative to another.
    fn placement(&mut self, base: Base, frame: &DAffine3) -> u64 {
        let at = frame.translation.to_array().map(rounded).join(",");
        let at = self.add(&format!("IFCCARTESIANPOINT(({at}))"));
        let x = frame.matrix3.x_axis;
        let turned = if x == DVec3::X {
            "$,$".into()
        } else {
            let up = self.add("IFCDIRECTION((0.,0.,1.))");
            let x = self.add(&format!("IFCDIRECTION(({},{},0.))", real(x.x), real(x.y)));
            format!("#{up},#{x}")
        };
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},{turned})"));
        let within = base.placement.map_or("$".into(), |p| format!("#{p}"));
        self.add(&format!("IFCLOCALPLACEMENT({within},#{axes})"))
    }

    /// The shape of an element.
    fn shape(&mut self, shown: &[u64]) -> u64 {
        self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,{})", refs(shown)))
    }

    /// Metres above the floor in file units.
    fn above(&self, m: f64) -> f64 {
        self.z + m / self.b.geo.metres
    }

    /// An opening through a wall, for a door as high as its like.
    fn opening(
        &mut self,
        wall: u64,
        gone: &[DVec2; 4],
        (filling, door): (Filling, Option<Door>),
    ) -> (u64, Base) {
        let [below, top] = [-BELOW_FLOOR_M, height_m(door)].map(|m| self.above(m));
        let whole = reach(self.b, wall).filter(|_| filling == Filling::Gone);
        let over = BELOW_FLOOR_M / self.b.geo.metres;
        let heights = whole.map_or([below, top], |[lo, hi]| [lo - over, hi + over]);
        let body = self.body(self.base(wall), gone, heights);
        let (placement, shape) = (body.placement, self.shape(&[body.shown]));
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { ",.OPENING." });
        let gid = self.global_id("opening");
        let made = self.add(&format!(
            "IFCOPENINGELEMENT('{gid}',{history},'Opening',$,$,#{placement},#{shape},${last})"
        ));
        let gid = self.global_id("voids");
        self.add(&format!("IFCRELVOIDSELEMENT('{gid}',{history},$,$,#{wall},#{made})"));
        self.status(made, "Pset_OpeningElementCommon", "NEW");
        (made, body.base)
    }

    /// A door or a window in an opening: a leaf or a pane in the middle of the wall.
    fn filled(
        &mut self,
        (opening, base): (u64, Base),
        gone: &[DVec2; 4],
        (filling, door): (Filling, Option<Door>),
        storey: Option<u64>,
    ) {
        // What a type says of its doors is left to it.
        let (keyword, name, set, last) = match filling {
            Filling::Nothing | Filling::Gone => return,
            Filling::Door if door.is_some() => ("IFCDOOR", "Door", "Pset_DoorCommon", ",$,$,$"),
            Filling::Door => ("IFCDOOR", "Door", "Pset_DoorCommon", ",.DOOR.,.NOTDEFINED.,$"),
            Filling::Glass => ("IFCWINDOW", "Window", "Pset_WindowCommon", ",.WINDOW.,.NOTDEFINED.,$"),
        };
        let [a, b, c, d] = *gone;
        let (right, left) = ((a + d) / 2.0, (b + c) / 2.0);
        let off = (d - a).normalize_or_zero() * (LEAF_M / 2.0 / self.b.geo.metres);
        let ring = [right - off, left - off, left + off, right + off];
        let heights = [self.above(0.0), self.above(height_m(door))];
        let body = self.body(base, &ring, heights);
        let (placement, shape) = (body.placement, self.shape(&[body.shown]));
        let (height, width) = (real(height_m(door) / self.b.geo.metres), real(right.distance(left)));
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { last });
        let gid = self.global_id("filling");
        let made = self.add(&format!(
            "{keyword}('{gid}',{history},'{name}',$,$,#{placement},#{shape},$,{height},{width}{last})"
        ));
        let gid = self.global_id("fills");
        self.add(&format!("IFCRELFILLSELEMENT('{gid}',{history},$,$,#{opening},#{made})"));
        self.stands(made, storey);
        if let Some(door) = door {
            self.typed(made, door.id);
            self.on_layer(body, door.id);
        }
        self.status(made, set, "NEW");
    }

    /// A wall as high as another and, if it is as thick, of its type and its layers.
    fn wall(&mut self, like: u64, (ring, heights): (&[DVec2], [f64; 2]), storey: Option<u64>) {
        let base = self.base(storey.unwrap_or(like));
        let bar = Bar::of(self.b, ring, like);
        let (body, shape) = match &bar {
            Some(bar) => self.bar(bar, base, heights, like),
            None => {
                let body = self.body(base, ring, heights);
                (body, self.shape(&[body.shown]))
            }
        };
        let placement = body.placement;
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { ",$" });
        let gid = self.global_id("wall");
        let made = self.add(&format!("IFCWALL('{gid}',{history},'Wall',$,$,#{placement},#{shape},${last})"));
        self.stands(made, storey);
        self.alike(made, like, bar.is_some_and(|bar| bar.is_as_thick));
        self.on_layer(body, like);
        self.status(made, "Pset_WallCommon", "NEW");
    }

    /// A straight wall along an axis of its own, which its layers lie about.
    fn bar(&mut self, bar: &Bar, base: Base, [z, top]: [f64; 2], like: u64) -> (Body, u64) {
        let body = self.body_at(base, bar.frame(base, z), &bar.ring, top - z);
        let mut shown = Vec::new();
        if let Some(context) = self.axis_context(like) {
            let ends = [DVec2::ZERO, DVec2::new(bar.length, 0.0)].map(|p| self.flat(p));
            let line = self.add(&format!("IFCPOLYLINE({})", refs(&ends)));
            shown.push(self.add(&format!("IFCSHAPEREPRESENTATION(#{context},'Axis','Curve2D',(#{line}))")));
        }
        shown.push(body.shown);
        (body, self.shape(&shown))
    }

    /// Puts an element into its storey.
    fn stands(&mut self, id: u64, storey: Option<u64>) {
        let Some(storey) = storey else { return };
        let (gid, history) = (self.global_id("stands"), self.history.clone());
        self.add(&format!("IFCRELCONTAINEDINSPATIALSTRUCTURE('{gid}',{history},$,$,(#{id}),#{storey})"));
    }

    /// Says of an element that it is to go.
    fn demolished(&mut self, id: u64) {
        let class = self.b.step.keyword(id);
        let common = match &*class {
            c if c.starts_with("IFCWALL") => "Pset_WallCommon",
            c if c.starts_with("IFCDOOR") => "Pset_DoorCommon",
            c if c.starts_with("IFCWINDOW") => "Pset_WindowCommon",
            c if c.starts_with("IFCCOLUMN") => "Pset_ColumnCommon",
            _ => "Pset_Enfilade_Works",
        };
        // Two sets of one name on an element are against the schema.
        let own = self.b.model.properties.get(&id).into_iter().flatten();
        let mut names = own.filter_map(|set| self.b.step.args(*set).get(2).and_then(|a| self.b.step.text(a)));
        let name = if names.any(|n| n == common) { "Pset_Enfilade_Works" } else { common };
        self.status(id, name, "DEMOLISH");
    }

    fn status(&mut self, id: u64, set: &str, status: &str) {
        let value =
            self.add(&format!("IFCPROPERTYENUMERATEDVALUE('Status',$,(IFCLABEL({})),$)", encode(status)));
        let history = self.history.clone();
        let gid = self.global_id("status");
        let set = self.add(&format!("IFCPROPERTYSET('{gid}',{history},'{set}',$,(#{value}))"));
        let gid = self.global_id("of");
        self.add(&format!("IFCRELDEFINESBYPROPERTIES('{gid}',{history},$,$,(#{id}),#{set})"));
    }
}
