//! The storeys of a building as one: which there are, and where stairs join them.

use std::sync::Arc;

use rayon::prelude::*;

use crate::job::Job;
use crate::measure::floors::{Building, Floor, Floors, Footprint};
use crate::measure::study::Study;
use crate::read::read_options;
use crate::read::storey::storey_read;
use crate::understand::rooms::rooms_with_kinds;
use crate::understand::sensed::Sensed;
use crate::understand::understood;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::Format;
use enfilade_cad::things::ThingKind;
use enfilade_cad::{Opened, StoreyInfo};
use enfilade_config::{Partial, Settings};
use enfilade_engine::geometry::PointUm;
use enfilade_overlay::result::OverStairs;
use enfilade_plan::kinds::RoomKind;
use enfilade_report::{Error, Place, Report, counted};

/// Most storeys that are joined; of more the nearest ones. Every lattice is laid on each of them.
const TOGETHER_MAX: usize = 12;

/// The storeys that steps lead to over the stairs of the one that was understood, where the settings ask for them; says what is
/// joined, or why nothing is.
///
/// # Errors
/// Where the file cannot be opened; a storey that cannot be read is left out.
pub(crate) fn floors(job: Job<'_>, base: &Understood, report: &mut Report) -> Result<Option<Floors>, Error> {
    let Job { input, settings } = job;
    if !settings.over_stairs {
        return Ok(None);
    }
    let place = Place::file(input.file());
    let options = read_options(settings);
    let opened = Opened::new(input.file(), &input.bytes)?;
    let found = opened.building(&options).0;
    let list =
        storey_read(&found, settings).map(|own| (own, near(&found, own))).filter(|(_, list)| list.len() > 1);
    let Some((own, list)) = list else {
        let sheet =
            if base.plan.format == Format::Dxf { " (drawings of one sheet are not joined)" } else { "" };
        let text = format!(
            "--over-stairs: there is no other storey with walls{sheet}; steps are counted on this one"
        );
        report.warn("stairs-none", place, text);
        return Ok(None);
    };
    let read =
        opened.read_all(&list.iter().map(|i| read_options(&plain(settings, &found, *i))).collect::<Vec<_>>());
    let floor = |(i, (drawing, mut silent)): (&usize, (Result<_, Error>, Report))| {
        let settings = plain(settings, &found, *i);
        let understood = understood(&drawing?, &settings, &mut silent)?;
        let ways_up = ways_up(if *i == own { base } else { &understood }, &settings)?;
        let key = enfilade_cad::storey_key(&found, *i);
        Ok((*i, Floor { key, base: Arc::new(understood), settings }, ways_up))
    };
    let made: Vec<Result<_, Error>> =
        list.iter().zip(read).collect::<Vec<_>>().into_par_iter().map(floor).collect();
    // Roofs and foundations have no rooms.
    let made: Vec<(usize, Floor, Vec<Ring>)> = made.into_iter().flatten().collect();
    let Some(own_at) = made.iter().position(|m| m.0 == own) else { return Ok(None) };
    let mut stairs = Vec::new();
    for (lower, pair) in made.windows(2).enumerate() {
        // Over a storey that was left out nobody climbs.
        let is_next = list.windows(2).any(|next| next == [pair[0].0, pair[1].0]);
        if is_next {
            let storeys = [lower, lower + 1];
            stairs.extend(pair[0].2.iter().map(|ring| Footprint { storeys, ring: ring.clone() }));
        }
    }
    let floors = made.into_iter().map(|m| m.1).collect();
    let is_whole = near(&found, own).len() == walled(&found, own).len();
    Ok(Some(Floors::new(Arc::new(Building { floors, stairs, is_whole }), own_at)))
}

type Ring = Vec<PointUm>;

/// Where one goes up from a storey: its flights, else its rooms of stairs.
fn ways_up(base: &Understood, settings: &Settings) -> Result<Vec<Ring>, Error> {
    let flights: Vec<_> =
        base.things.iter().filter(|t| t.kind == ThingKind::Stair).map(|t| t.extent).collect();
    if !flights.is_empty() {
        let ring = |[lo, hi]: [PointUm; 2]| vec![lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]];
        return Ok(flights_of(flights).into_iter().map(ring).collect());
    }
    let sensed = Sensed::new(base, settings);
    let rooms = rooms_with_kinds(base, &sensed, settings)?;
    Ok(rooms.into_iter().filter(|r| r.found.kind == RoomKind::Stair).map(|r| r.area.outline).collect())
}

/// The storey above the one that was understood, with what `--storey` calls it; none above the highest with walls, nor where
/// it cannot be read.
pub(crate) fn above(job: Job<'_>, study: &Study) -> Option<(String, Arc<Understood>)> {
    if let Some(floors) = &study.floors {
        return floors.above();
    }
    let Job { input, settings } = job;
    let options = read_options(settings);
    let opened = Opened::new(input.file(), &input.bytes).ok()?;
    let found = opened.building(&options).0;
    let own = storey_read(&found, settings)?;
    let next = near(&found, own).into_iter().find(|i| *i > own)?;
    let settings = plain(settings, &found, next);
    let mut silent = Report::default();
    let drawing = opened.read(&read_options(&settings), &mut silent).ok()?;
    let above = understood(&drawing, &settings, &mut silent).ok()?;
    Some((enfilade_cad::storey_key(&found, next), Arc::new(above)))
}

/// What steps of a study reach over the stairs; none where they stay on its storey.
pub(crate) fn over_stairs(study: &Study) -> Option<OverStairs> {
    let beyond = study.lattice.beyond.as_ref()?;
    let floors = study.floors.as_ref()?;
    Some(OverStairs {
        stairs: beyond.stairs.iter().filter(|s| !s.is_empty()).count() as u64,
        storeys: floors.reached().into_iter().map(Into::into).collect(),
        cells: beyond.vertices(),
    })
}

/// Says what the stairs of a measured storey join it to.
pub(crate) fn state(study: &Study, report: &mut Report) {
    let Some(floors) = &study.floors else { return };
    let place = Place::file(&study.base.plan.file);
    match over_stairs(study) {
        Some(over) => {
            let (to, cells) = (over.storeys.join(", "), counted(over.cells, "cell"));
            report.info("stairs", place, format!("steps are counted over the stairs to {to}: {cells} there"));
        }
        None => {
            let why = if floors.has_stairs() {
                "no measured cell lies on the stairs to another storey, here or there (a smaller --spacing has more cells)"
            } else {
                "no stair was found on this storey or the one below that leads to another one with rooms"
            };
            report.warn(
                "stairs-none",
                place,
                format!("--over-stairs: {why}; steps are counted on this storey"),
            );
        }
    }
}

/// The walled storeys of the building of `own`, and it, from the lowest.
fn walled(found: &[StoreyInfo], own: usize) -> Vec<usize> {
    let Some(building) = found.get(own).map(|s| &s.building) else { return Vec::new() };
    let is_walled = |i: &usize| *i == own || (found[*i].walls > 0 && found[*i].building == *building);
    (0..found.len()).filter(is_walled).collect()
}

/// Of [`walled`] it and the nearest others, at most [`TOGETHER_MAX`].
fn near(found: &[StoreyInfo], own: usize) -> Vec<usize> {
    let all = walled(found, own);
    let at = all.iter().position(|i| *i == own).unwrap_or(0);
    let last = (at + TOGETHER_MAX.div_ceil(2)).clamp(TOGETHER_MAX.min(all.len()), all.len());
    all[last - TOGETHER_MAX.min(all.len())..last].to_vec()
}

/// What reads another storey as it is drawn, and as it would be measured itself: nothing is asked of it, and no place on
/// another storey is one on it.
fn plain(settings: &Settings, found: &[StoreyInfo], storey: usize) -> Settings {
    let usual = Settings::new(Partial::default()).unwrap_or_else(|_| settings.clone());
    Settings {
        storey: Some(enfilade_cad::storey_key(found, storey)),
        over_stairs: false,
        query: None,
        objectives: usual.objectives,
        score: usual.score,
        penalties: usual.penalties,
        limits: usual.limits,
        ..settings.clone().without_places()
    }
}

/// The boxes of flights that hold no other's: a stair that turns has a box that reaches into rooms beside it, its flights
/// have none.
fn flights_of(mut boxes: Vec<[PointUm; 2]>) -> Vec<[PointUm; 2]> {
    let area = |[lo, hi]: &[PointUm; 2]| (hi[0] - lo[0]).saturating_mul(hi[1] - lo[1]);
    boxes.sort_by_key(|b| (area(b), *b));
    let mut out: Vec<[PointUm; 2]> = Vec::new();
    for [lo, hi] in boxes {
        let holds = |[l, h]: &[PointUm; 2]| (0..2).all(|k| lo[k] <= l[k] && h[k] <= hi[k]);
        if !out.iter().any(holds) {
            out.push([lo, hi]);
        }
    }
    out.sort_unstable();
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_engine::geometry::UM_PER_M;

    fn storeys(buildings: &[&str]) -> Vec<StoreyInfo> {
        let of = |(i, b): (usize, &&str)| StoreyInfo {
            name: format!("S{i}"),
            building: Some((*b).to_owned()),
            floor_m: 3.0 * i as f64,
            walls: 4,
            top_m: None,
        };
        buildings.iter().enumerate().map(of).collect()
    }

    #[test]
    fn the_nearest_storeys_of_one_building_are_joined() {
        let few = storeys(&["A", "B", "A", "A"]);
        assert_eq!(near(&few, 2), [0, 2, 3]);
        assert_eq!(near(&few, 1), [1]);
        let tower = storeys(&vec!["A"; TOGETHER_MAX + 10]);
        for own in 0..tower.len() {
            let list = near(&tower, own);
            assert_eq!(list.len(), TOGETHER_MAX);
            assert!(list.contains(&own) && list.windows(2).all(|w| w[1] == w[0] + 1), "{own}: {list:?}");
        }
        assert_eq!(near(&tower, 11), (5..17).collect::<Vec<_>>());
    }

    #[test]
    fn flights_are_taken_and_not_what_holds_them() {
        let m = |x: f64| (x * UM_PER_M) as i64;
        let of = |x0: f64, x1: f64| [[m(x0), 0], [m(x1), m(3.0)]];
        let beside = vec![of(0.0, 1.0), of(1.2, 2.2), of(0.0, 2.2), of(9.0, 10.0), of(9.0, 10.0)];
        assert_eq!(flights_of(beside), [of(0.0, 1.0), of(1.2, 2.2), of(9.0, 10.0)]);
    }
}
