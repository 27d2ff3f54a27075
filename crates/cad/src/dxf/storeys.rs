//! Storeys that a drawing shows over one another, each at its own height.

use std::collections::HashSet;

use glam::DVec2;

use super::heights::Heights;
use crate::curve::control_points;
use crate::drawing::{Drawing, Entity, Shape, Text, Unit};
use crate::own_layers::{is_marker, is_own};
use crate::plane::{box_of, distance_to_segment, share_of_smaller};
use crate::roles::{Role, role_by_name};
use crate::storeys::{StoreyInfo, main_storey, no_storey, state_taken, storey_at};
use crate::units::by_heights;
use enfilade_report::{Error, Place, Report};

/// Heights this near to one another, metres, are one floor: platforms and slips of the pen.
const SAME_M: f64 = 0.1;

/// Heights of storeys, metres: below them something stands on the floor, above them the heights are no storeys'.
pub(super) const STOREY_M: [f64; 2] = [2.0, 12.0];

/// The walls of a storey have at least this share of the length and of the corners of those of the largest.
const SHARE_MIN: f64 = 0.25;

/// Fewest corners and ends of the walls of a storey.
const CORNERS_MIN: usize = 8;

/// Storeys lie over one another where their boxes share this much of the smaller one.
const SHARED_MIN: f64 = 0.5;

/// Storeys stand over one another where this share of the walls of the upper one stands over walls of the lower. What is
/// drawn at two heights by slips makes one plan together: its walls meet and do not cover each other.
const STACKED_MIN: f64 = 0.25;

/// A wall stands over another one where it is no farther from it in plan, metres.
const STACKED_M: f64 = 0.3;

/// Points of the upper walls at which it is asked.
const STACKED_POINTS: usize = 400;

/// The share of lines of walls that rise, above which this is no pile of plans but a model, or its heights are slips.
const RISING_MAX: f64 = 0.05;

/// The storeys of a drawing, two or more.
pub(super) struct Storeys {
    /// What they are called and have, from the lowest.
    pub list: Vec<StoreyInfo>,
    /// Heights of their floors, drawing units.
    floors: Vec<f64>,
    /// The storey of each entity, fill, text and tag.
    of: [Vec<usize>; 4],
    /// Whether all marks are drawn on the ground, whichever storey they mean.
    are_marks_flat: bool,
}

/// Walls at one height.
struct Floor<'d> {
    walls: Vec<&'d Entity>,
    /// Drawing units.
    z: f64,
    extent: [DVec2; 2],
    length: f64,
    corners: usize,
}

impl Storeys {
    /// Finds the storeys; `unit` is the drawing's as far as somebody states it.
    pub fn of(drawing: &Drawing, heights: &mut Heights<'_, '_>, unit: Option<Unit>) -> Option<Self> {
        let all: Vec<[f64; 2]> = drawing.entities.iter().map(|e| heights.of(&e.origin)).collect();
        let walls = walls(drawing);
        let rising = walls.iter().filter(|i| all[**i][1] > all[**i][0]).count();
        if rising as f64 > RISING_MAX * walls.len() as f64 {
            return None;
        }
        let drawn = walls.iter().map(|i| (all[*i][0], &drawing.entities[*i]));
        let (floors, metres) = floors(drawn.collect(), unit)?;
        let near = SAME_M / metres;
        let storey_of = |z: f64| floors.partition_point(|floor| *floor <= z + near).saturating_sub(1);
        let of_entities: Vec<usize> = all.iter().map(|z| storey_of(z[0])).collect();
        let info = |(i, z): (usize, &f64)| StoreyInfo {
            building: None,
            name: format!("floor {}", i + 1),
            // Without the sign of a zero.
            floor_m: z * metres + 0.0,
            walls: walls.iter().filter(|w| of_entities[**w] == i).count(),
            top_m: None,
        };
        let list = floors.iter().enumerate().map(info).collect();
        let of_fills = drawing.fills.iter().map(|e| storey_of(heights.of(&e.origin)[0])).collect();
        let mut of_texts =
            |texts: &[Text]| texts.iter().map(|t| storey_of(heights.of_text(t))).collect::<Vec<_>>();
        let (texts, tags) = (of_texts(&drawing.texts), of_texts(&drawing.tags));
        let is_flat = |i: usize| !is_marker(&drawing.entities[i].layer) || all[i] == [0.0; 2];
        let are_marks_flat = (0..all.len()).all(is_flat)
            && drawing.texts.iter().all(|t| !is_marker(&t.layer) || heights.of_text(t) == 0.0);
        Some(Self { list, floors, of: [of_entities, of_fills, texts, tags], are_marks_flat })
    }

    /// The storey of an entity.
    pub fn of_entity(&self, index: usize) -> usize {
        self.of[0][index]
    }

    /// Forgets entities that the drawing has no more.
    pub fn leave_out(&mut self, gone: &HashSet<usize>) {
        leave_out(&mut self.of[0], gone);
    }

    /// The storey that is asked for, else the one with most walls, the lowest of several.
    pub fn chosen(&self, wanted: Option<&str>) -> Option<usize> {
        match wanted {
            Some(name) => storey_at(self.list.iter().map(|s| s.name.as_str()), name),
            None => main_storey(&self.list, 0.0),
        }
    }

    /// The height of the floor that is read, drawing units.
    pub fn floor(&self, wanted: Option<&str>) -> Option<f64> {
        self.chosen(wanted).map(|i| self.floors[i])
    }

    /// Leaves one storey in the drawing: the one that is asked for, else the one with most walls, the lowest of several.
    ///
    /// # Errors
    /// [`Error::Usage`] for a storey that is not there.
    pub fn keep_one(
        self,
        drawing: &mut Drawing,
        wanted: Option<&str>,
        report: &mut Report,
    ) -> Result<(), Error> {
        let place = Place::file(&drawing.file);
        let storey = self.chosen(wanted);
        let storey = match (wanted, storey) {
            (_, None) => {
                let name = wanted.unwrap_or_default();
                let why = format!("--storey \"{name}\": {}", no_storey(&self.list, name, "none"));
                return Err(Error::usage("storey", place, why));
            }
            (Some(_), Some(storey)) => storey,
            (None, Some(most)) => {
                state_taken(&drawing.file, &self.list, &self.list[most], report);
                most
            }
        };
        let [entities, fills, texts, tags] = self.of;
        // Who marks the plan on the ground may mean any storey.
        let is_flat = self.are_marks_flat;
        let stays = |layer: &str, of: usize| of == storey || is_flat && is_marker(layer);
        keep(&mut drawing.entities, &entities, |e, of| stays(&e.layer, of));
        keep(&mut drawing.fills, &fills, |e, of| stays(&e.layer, of));
        keep(&mut drawing.texts, &texts, |t, of| stays(&t.layer, of));
        keep(&mut drawing.tags, &tags, |_, of| of == storey);
        Ok(())
    }
}

/// Keeps those of a list whose storeys are so.
fn keep<T>(list: &mut Vec<T>, storeys: &[usize], stays: impl Fn(&T, usize) -> bool) {
    let mut next = storeys.iter();
    list.retain(|one| next.next().is_some_and(|storey| stays(one, *storey)));
}

/// The entities that are walls by the names of their layers; where none is so named those on layers whose names say nothing.
pub(super) fn walls(drawing: &Drawing) -> Vec<usize> {
    let on = |is_it: fn(Role) -> bool| -> Vec<usize> {
        let layers = drawing.layers.iter().map(|l| l.name.as_str());
        let named: HashSet<&str> = layers.filter(|l| !is_own(l) && is_it(role_by_name(l).0)).collect();
        let is_on = |i: &usize| named.contains(drawing.entities[*i].layer.as_str());
        (0..drawing.entities.len()).filter(is_on).collect()
    };
    let by_name = on(Role::stops_sight);
    if by_name.is_empty() { on(|role| role == Role::Unknown) } else { by_name }
}

/// Heights of the floors, drawing units, and metres in one of these; nothing where the walls stand on one floor. `walls`: with
/// their heights.
fn floors(mut walls: Vec<(f64, &Entity)>, unit: Option<Unit>) -> Option<(Vec<f64>, f64)> {
    walls.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Without a unit the heights tell it; until then only what is equal is one height.
    let gathered = |near: f64| -> Vec<Floor<'_>> {
        let mut all: Vec<Floor<'_>> = walls.chunk_by(|a, b| b.0 - a.0 <= near).filter_map(floor).collect();
        let most = |of: fn(&Floor<'_>) -> f64| all.iter().map(of).fold(0.0, f64::max);
        let [length, corners] = [most(|f| f.length), most(|f| f.corners as f64)].map(|most| SHARE_MIN * most);
        all.retain(|f| f.corners >= CORNERS_MIN && f.length >= length && f.corners as f64 >= corners);
        all
    };
    let gaps = |floors: &[Floor<'_>]| floors.windows(2).map(|w| w[1].z - w[0].z).collect::<Vec<f64>>();
    let metres = unit.or_else(|| by_heights(&gaps(&gathered(0.0))))?.metres;
    let mut floors: Vec<Floor<'_>> = Vec::new();
    for next in gathered(SAME_M / metres) {
        let rise_m = floors.last().map_or(f64::INFINITY, |last| (next.z - last.z) * metres);
        // What stands on a floor belongs to it.
        if rise_m >= STOREY_M[0] {
            floors.push(next);
        }
    }
    let is_over = |w: &[Floor<'_>]| {
        (w[1].z - w[0].z) * metres <= STOREY_M[1]
            && share_of_smaller(w[0].extent, w[1].extent) >= SHARED_MIN
            && stacked(&w[1].walls, &w[0].walls, STACKED_M / metres) >= STACKED_MIN
    };
    let are_storeys = floors.len() > 1 && floors.windows(2).all(is_over);
    are_storeys.then(|| (floors.iter().map(|f| f.z).collect(), metres))
}

/// The share of some points of the upper walls that lie over lower ones.
fn stacked(upper: &[&Entity], lower: &[&Entity], near: f64) -> f64 {
    let segments = |of: &[&Entity]| -> Vec<[DVec2; 2]> {
        let ends = |e: &&Entity| -> Vec<[DVec2; 2]> {
            let mut points = control_points(&e.shape);
            let is_closed = matches!(e.shape, Shape::Polyline { closed: true, .. });
            points.extend(points.first().copied().filter(|_| is_closed));
            points.windows(2).map(|w| [w[0], w[1]]).collect()
        };
        of.iter().flat_map(ends).collect()
    };
    let (upper, lower) = (segments(upper), segments(lower));
    let total: f64 = upper.iter().map(|[a, b]| a.distance(*b)).sum();
    let step = total / STACKED_POINTS as f64;
    let (mut over, mut count, mut next) = (0_usize, 0_usize, step / 2.0);
    for [a, b] in upper {
        let length = a.distance(b);
        while next < length {
            let p = a.lerp(b, next / length);
            over += usize::from(lower.iter().any(|s| distance_to_segment(p, *s) <= near));
            count += 1;
            next += step;
        }
        next -= length;
    }
    over as f64 / count.max(1) as f64
}

/// The walls of a height together.
fn floor<'d>(walls: &[(f64, &'d Entity)]) -> Option<Floor<'d>> {
    let points = || walls.iter().flat_map(|w| control_points(&w.1.shape));
    Some(Floor {
        walls: walls.iter().map(|w| w.1).collect(),
        z: walls.first()?.0,
        extent: box_of(points())?,
        length: walls.iter().map(|w| length(w.1)).sum(),
        corners: points().count(),
    })
}

/// How long a shape is from corner to corner, drawing units.
pub(super) fn length(e: &Entity) -> f64 {
    control_points(&e.shape).windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Leaves those of some places out of a list.
pub(super) fn leave_out<T>(list: &mut Vec<T>, gone: &HashSet<usize>) {
    let mut next = 0..;
    list.retain(|_| next.next().is_none_or(|i| !gone.contains(&i)));
}
