//! Building works in a building: openings that void walls, and elements that are to go.

use glam::{DAffine3, DVec2, DVec3};

use super::ReadOptions;
use super::additions::{Writer, refs};
use super::building::Building;
use super::geo::is_upright;
use super::number::real;
use super::standing::reach;
use super::step::Arg;
use crate::drawing::{Edit, EntityWork, Filling, Shape};
use crate::sizes::{BELOW_FLOOR_M, LEAF_M, OPENING_HEIGHT_M};
use crate::step_text::encode;
use enfilade_report::{Error, Place, Report};

/// Instances that make the works of some edits; the others are left to their own. The next free number follows.
///
/// # Errors
/// [`Error::Input`] for a work that is not written in a building, and for an element that is not there.
pub(super) fn text(
    b: &Building<'_, '_>,
    options: &ReadOptions,
    next: u64,
    edits: &[Edit],
) -> Result<(Vec<u8>, u64), Error> {
    if !edits.iter().any(Edit::is_work) {
        return Ok((Vec::new(), next));
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
                let opening = writer.opening(id, gone, *filling);
                writer.filled(opening, gone, *filling, storey.map(|s| s.id));
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
    Ok(writer.into_parts())
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

/// What a new body is placed by: a placement that stands upright, and where that is in the world.
#[derive(Clone, Copy)]
struct Base {
    placement: Option<u64>,
    world: DAffine3,
}

/// A new body.
struct Body {
    placement: u64,
    shape: u64,
    /// For what is placed by it.
    base: Base,
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

    /// An upright body over a ring, placed by `base`.
    fn body(&mut self, base: Base, ring: &[DVec2], [z, top]: [f64; 2]) -> Body {
        let flat = |p: DVec3| format!("IFCCARTESIANPOINT(({},{}))", rounded(p.x), rounded(p.y));
        // Coordinates about the first corner: those of a map have too many digits for some programs.
        let local = |p: DVec2| base.world.inverse().transform_point3(p.extend(z));
        let zero = local(ring[0]);
        let mut corners: Vec<u64> = ring.iter().map(|p| self.add(&flat(local(*p) - zero))).collect();
        corners.push(corners[0]);
        let line = self.add(&format!("IFCPOLYLINE({})", refs(&corners)));
        let profile = self.add(&format!("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{line})"));
        let origin = self.add("IFCCARTESIANPOINT((0.,0.,0.))");
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
        let up = self.add("IFCDIRECTION((0.,0.,1.))");
        let body = self.add(&format!("IFCEXTRUDEDAREASOLID(#{profile},#{axes},#{up},{})", real(top - z)));
        let context = self.context.map_or("$".into(), |c| format!("#{c}"));
        let shown = self.add(&format!("IFCSHAPEREPRESENTATION({context},'Body','SweptSolid',(#{body}))"));
        let shape = self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,(#{shown}))"));
        let at = [zero.x, zero.y, zero.z].map(rounded).join(",");
        let at = self.add(&format!("IFCCARTESIANPOINT(({at}))"));
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},$,$)"));
        let within = base.placement.map_or("$".into(), |p| format!("#{p}"));
        let placement = self.add(&format!("IFCLOCALPLACEMENT({within},#{axes})"));
        let world = base.world * DAffine3::from_translation(zero);
        Body { placement, shape, base: Base { placement: Some(placement), world } }
    }

    /// Metres above the floor in file units.
    fn above(&self, m: f64) -> f64 {
        self.z + m / self.b.geo.metres
    }

    /// An opening through a wall.
    fn opening(&mut self, wall: u64, gone: &[DVec2; 4], filling: Filling) -> (u64, Base) {
        let [below, top] = [-BELOW_FLOOR_M, OPENING_HEIGHT_M].map(|m| self.above(m));
        let whole = reach(self.b, wall).filter(|_| filling == Filling::Gone);
        let over = BELOW_FLOOR_M / self.b.geo.metres;
        let heights = whole.map_or([below, top], |[lo, hi]| [lo - over, hi + over]);
        let Body { placement, shape, base } = self.body(self.base(wall), gone, heights);
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { ",.OPENING." });
        let gid = self.global_id("opening");
        let made = self.add(&format!(
            "IFCOPENINGELEMENT('{gid}',{history},'Opening',$,$,#{placement},#{shape},${last})"
        ));
        let gid = self.global_id("voids");
        self.add(&format!("IFCRELVOIDSELEMENT('{gid}',{history},$,$,#{wall},#{made})"));
        self.status(made, "Pset_OpeningElementCommon", "NEW");
        (made, base)
    }

    /// A door or a window in an opening: a leaf or a pane in the middle of the wall.
    fn filled(
        &mut self,
        (opening, base): (u64, Base),
        gone: &[DVec2; 4],
        filling: Filling,
        storey: Option<u64>,
    ) {
        let (keyword, name, set, last) = match filling {
            Filling::Nothing | Filling::Gone => return,
            Filling::Door => ("IFCDOOR", "Door", "Pset_DoorCommon", ",.DOOR.,.NOTDEFINED.,$"),
            Filling::Glass => ("IFCWINDOW", "Window", "Pset_WindowCommon", ",.WINDOW.,.NOTDEFINED.,$"),
        };
        let [a, b, c, d] = *gone;
        let (right, left) = ((a + d) / 2.0, (b + c) / 2.0);
        let off = (d - a).normalize_or_zero() * (LEAF_M / 2.0 / self.b.geo.metres);
        let ring = [right - off, left - off, left + off, right + off];
        let heights = [self.above(0.0), self.above(OPENING_HEIGHT_M)];
        let Body { placement, shape, .. } = self.body(base, &ring, heights);
        let (height, width) = (real(OPENING_HEIGHT_M / self.b.geo.metres), real(right.distance(left)));
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { last });
        let gid = self.global_id("filling");
        let made = self.add(&format!(
            "{keyword}('{gid}',{history},'{name}',$,$,#{placement},#{shape},$,{height},{width}{last})"
        ));
        let gid = self.global_id("fills");
        self.add(&format!("IFCRELFILLSELEMENT('{gid}',{history},$,$,#{opening},#{made})"));
        self.stands(made, storey);
        self.status(made, set, "NEW");
    }

    /// A wall as high as another, of its material.
    fn wall(&mut self, like: u64, (ring, heights): (&[DVec2], [f64; 2]), storey: Option<u64>) {
        let base = self.base(storey.unwrap_or(like));
        let Body { placement, shape, .. } = self.body(base, ring, heights);
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { ",$" });
        let gid = self.global_id("wall");
        let made = self.add(&format!("IFCWALL('{gid}',{history},'Wall',$,$,#{placement},#{shape},${last})"));
        self.stands(made, storey);
        let material = self.b.step.all("IFCRELASSOCIATESMATERIAL").find_map(|i| {
            let args = self.b.step.args_of(i);
            args.get(4).filter(|a| a.ids().contains(&like)).and_then(|_| args.get(5)?.id())
        });
        // Layers are those of a wall of their thickness and place; a plain material holds of any.
        let is_plain = |id: &u64| self.b.step.keyword(*id) == "IFCMATERIAL";
        if let Some(material) = material.filter(is_plain) {
            let gid = self.global_id("material");
            self.add(&format!("IFCRELASSOCIATESMATERIAL('{gid}',{history},$,$,(#{made}),#{material})"));
        }
        self.status(made, "Pset_WallCommon", "NEW");
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
