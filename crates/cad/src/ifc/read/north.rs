//! Where a building's file says that north is.

use glam::DVec2;

use super::Building;
use crate::ifc::step::{Arg, Instance};
use enfilade_report::{Place, Report};

/// A north that is turned by less is up, degrees.
const NORTH_NOISE_DEG: f64 = 0.05;

/// `TrueNorth` of the context of the model, of which sub-contexts have theirs: degrees anticlockwise from the plan's up.
/// Where that context states none, what another one states, else the map.
pub(super) fn north_deg(b: &Building<'_, '_>) -> f64 {
    let stated = |i: &Instance| {
        let args = b.step.args_of(i);
        let way = b.geo.direction(args.get(5).and_then(Arg::id)?).ok()?.truncate().try_normalize()?;
        let is_model = args.get(1).and_then(|a| b.step.text(a)).is_some_and(|t| t == "Model");
        Some((is_model, way))
    };
    let all: Vec<(bool, DVec2)> =
        b.step.all("IFCGEOMETRICREPRESENTATIONCONTEXT").filter_map(stated).collect();
    let found = all.iter().find(|s| s.0).or(all.first()).map(|s| s.1).or_else(|| north_of_map(b));
    let deg = found.map_or(0.0, |way| DVec2::Y.angle_to(way).to_degrees());
    if deg.abs() < NORTH_NOISE_DEG { 0.0 } else { deg }
}

/// North of the map that the file is placed on: `XAxisAbscissa` and `XAxisOrdinate` say where the plan's x runs on it.
fn north_of_map(b: &Building<'_, '_>) -> Option<DVec2> {
    const AXIS: [usize; 2] = [5, 6];
    let along = |i: &Instance| {
        let args = b.step.args_of(i);
        let number = |k: usize| args.get(k).and_then(Arg::number);
        DVec2::new(number(AXIS[0])?, number(AXIS[1])?).try_normalize()
    };
    let x = b.step.all("IFCMAPCONVERSION").find_map(along)?;
    Some(DVec2::new(x.y, x.x))
}

/// Says where a stated north is no direction in the plan.
pub(super) fn state_north(b: &Building<'_, '_>, report: &mut Report) {
    for i in b.step.all("IFCGEOMETRICREPRESENTATIONCONTEXT") {
        let Some(id) = b.step.args_of(i).get(5).and_then(Arg::id) else { continue };
        let way = b.geo.direction(id).ok().and_then(|d| d.truncate().try_normalize());
        if way.is_none() {
            let place = Place::line(b.file, b.step.line(i.span.start));
            let text = format!(
                "found {} as TrueNorth, expected a direction in the plan; it is not used, and north is the plan's up unless \
                 another context says it",
                b.geo.named(id)
            );
            report.info("true-north", place, text);
        }
    }
}
