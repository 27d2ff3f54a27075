//! Building works in a building: openings that void walls, and elements that are to go.

use glam::DVec2;

use super::ReadOptions;
use super::additions::{Writer, refs};
use super::building::Building;
use super::number::real;
use crate::drawing::Edit;
use crate::step_text::encode;
use enfilade_report::{Error, Place, Report};

/// Height of an opening above the floor, metres: that of a door (DIN 18100: 2.125 and less).
const OPENING_HEIGHT_M: f64 = 2.1;
/// How far below the floor of the storey it begins, metres: walls stand on the slab, floors on a screed.
const BELOW_FLOOR_M: f64 = 0.1;

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
        let id = edit.record() as u64;
        let fault = |why: &str| {
            let line = b.step.get(id).map(|i| b.step.line(i.span.start));
            let place = Place { file: b.file.into(), line, entity: b.geo.named(id) };
            Error::input("ifc-edit", place, format!("{why}; nothing was written"))
        };
        if edit.is_work() && b.step.get(id).is_none() {
            return Err(fault("found no such element, expected a wall"));
        }
        match edit {
            Edit::Cut { gone, .. } => writer.opening(id, gone),
            Edit::Drop { .. } => writer.demolished(id),
            Edit::Build { .. } => return Err(fault("new walls are not written in a building")),
            _ => {}
        }
    }
    Ok(writer.into_parts())
}

impl Writer<'_, '_, '_> {
    /// An opening through a wall.
    fn opening(&mut self, wall: u64, gone: &[DVec2; 4]) {
        let metres = self.b.geo.metres;
        let (z, height) = (self.z - BELOW_FLOOR_M / metres, (OPENING_HEIGHT_M + BELOW_FLOOR_M) / metres);
        let flat = |p: DVec2| format!("IFCCARTESIANPOINT(({},{}))", real(p.x), real(p.y));
        // Coordinates about the first corner: those of a map have too many digits for some programs.
        let zero = gone[0];
        let mut ring: Vec<u64> = gone.iter().map(|p| self.add(&flat(*p - zero))).collect();
        ring.push(ring[0]);
        let line = self.add(&format!("IFCPOLYLINE({})", refs(&ring)));
        let profile = self.add(&format!("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{line})"));
        let origin = self.add("IFCCARTESIANPOINT((0.,0.,0.))");
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
        let up = self.add("IFCDIRECTION((0.,0.,1.))");
        let body = self.add(&format!("IFCEXTRUDEDAREASOLID(#{profile},#{axes},#{up},{})", real(height)));
        let context = self.context.map_or("$".into(), |c| format!("#{c}"));
        let shown = self.add(&format!("IFCSHAPEREPRESENTATION({context},'Body','SweptSolid',(#{body}))"));
        let shape = self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,(#{shown}))"));
        let at = format!("IFCCARTESIANPOINT(({},{},{}))", real(zero.x), real(zero.y), real(z));
        let at = self.add(&at);
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},$,$)"));
        let placement = self.add(&format!("IFCLOCALPLACEMENT($,#{axes})"));
        let (history, last) = (self.history.clone(), if self.is_old() { "" } else { ",.OPENING." });
        let gid = self.global_id("opening");
        let made = self.add(&format!(
            "IFCOPENINGELEMENT('{gid}',{history},'Opening',$,$,#{placement},#{shape},${last})"
        ));
        let gid = self.global_id("voids");
        self.add(&format!("IFCRELVOIDSELEMENT('{gid}',{history},$,$,#{wall},#{made})"));
        self.status(made, "Pset_OpeningElementCommon", "NEW");
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
