//! The floor above which a scene is cut.

use super::ReadOptions;
use super::bodies::SCENE_LAYER;
use super::body::Body;
use super::levels::{FLOOR_M, Levels, STOREY_HIGH_M};
use crate::storeys::{refuse_without_own, state_cut, state_shared_name, state_taken};
use crate::{StoreyInfo, listed, no_storey};
use enfilade_report::{Error, Place, Report};

/// The floor above which a scene is cut, units of the scene: that of the storey that is read where storeys are known, else the
/// one above which most walls are cut.
///
/// # Errors
/// [`Error::Usage`] for a storey that is not there, [`Error::Input`] for one that shows another one's walls alone.
pub(super) fn chosen_floor(
    file: &str,
    bodies: &[Body<'_>],
    options: &ReadOptions,
    (levels, metres): (&Levels, f64),
    report: &mut Report,
) -> Result<f64, Error> {
    let above = options.above_m();
    let storeys = levels.storeys(options);
    let wanted = options.storey.as_deref();
    if let Some(name) = wanted {
        state_shared_name(file, storeys, name, report);
    }
    let Some(chosen) = options.chosen_of(storeys) else {
        if let Some(name) = wanted {
            return Err(without_storey(file, options, storeys, name));
        }
        let floor = floor(bodies, metres, above / metres);
        let text =
            format!("no storeys in glTF; cut {above} m above the floor found at {:.3} m", floor * metres);
        report.info("gltf-cut", Place::file(file), text);
        return Ok(floor);
    };
    refuse_without_own(file, storeys, chosen, above)?;
    let storey = &storeys[chosen];
    if options.known().storeys.is_empty() {
        if wanted.is_none() {
            state_taken(file, storeys, storey, report);
        }
        state_cut(file, &storey.name, [above, storey.floor_m], report);
    } else {
        let text = format!(
            "storeys by the IFC beside it: {}; \"{}\" cut {above} m above its floor at {:.3} m",
            listed(storeys),
            storey.name,
            storey.floor_m
        );
        report.info("storey-cut", Place::file(file), text);
    }
    Ok(storey.floor_m / metres)
}

/// Why no storey is meant by a name.
fn without_storey(file: &str, options: &ReadOptions, storeys: &[StoreyInfo], name: &str) -> Error {
    let none = match options.twin.is_some() {
        false => {
            "none (no node is named after a storey, and no walls stand on two floors; the .ifc of the same name beside it may have some)"
        }
        true => "none (glTF has none, and the .ifc of the same name beside it is not used or has none)",
    };
    let why = no_storey(storeys, name, none);
    Error::usage("storey", Place::file(file), format!("--storey \"{name}\": {why}"))
}

/// The height above which most walls are cut: where walls start most often; `above` in units of the scene.
fn floor(bodies: &[Body<'_>], metres: f64, above: f64) -> f64 {
    let is_wall = |b: &&Body<'_>| b.layer == SCENE_LAYER || b.is_wall;
    let walls: Vec<&Body<'_>> = bodies.iter().filter(is_wall).collect();
    let walls: Vec<&Body<'_>> = if walls.is_empty() { bodies.iter().collect() } else { walls };
    // Where no name tells, what is as high as a storey does: furniture and footings do not.
    let is_unnamed = walls.iter().any(|b| b.layer == SCENE_LAYER);
    let high = |b: &&Body<'_>| (b.high - b.low) * metres >= STOREY_HIGH_M;
    let tall: Vec<&Body<'_>> = walls.iter().copied().filter(|b| is_unnamed && high(b)).collect();
    let walls = if tall.is_empty() { walls } else { tall };
    let sorted = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values
    };
    let below = |values: &[f64], z: f64| values.partition_point(|v| *v < z);
    // What is flat is nowhere cut; of the rest all that ends at a height or below it starts below it.
    let solid = || walls.iter().filter(|b| b.low < b.high);
    let (lows, highs) = (sorted(solid().map(|b| b.low).collect()), sorted(solid().map(|b| b.high).collect()));
    let cut = |floor: f64| {
        let z = floor + above;
        below(&lows, z) - highs.partition_point(|v| *v <= z)
    };
    let mut floors = sorted(walls.iter().map(|b| b.low).collect());
    let all = floors.clone();
    let near = |floor: f64| {
        let slack = FLOOR_M / metres;
        below(&all, floor + slack) - all.partition_point(|v| *v <= floor - slack)
    };
    floors.dedup_by(|a, b| (*a - *b).abs() < 1e-6 / metres);
    floors
        .into_iter()
        .max_by(|a, b| (cut(*a), near(*a)).cmp(&(cut(*b), near(*b))).then(b.total_cmp(a)))
        .unwrap_or(0.0)
}
