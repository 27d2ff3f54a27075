//! What a room shows without a name: what stands in it, its size, its doors, its place.

use std::collections::BTreeMap;

use enfilade_cad::plane::distance_to_segment;
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use glam::DVec2;

use super::super::axes::OpeningKind;
use super::super::floor::{Area, Beside};
use super::{Evidence, RoomKind, RoomKindFound, RoomsKnown};
use enfilade_cad::things::ThingKind;

/// What a room shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct RoomSeen {
    /// m² of a person.
    pub area_m2: f64,
    /// Sides of the rectangle of its area and girth, the longer first, metres of a person.
    pub sides_m: [f64; 2],
    /// Rooms that doors and passages lead to, each once, and how many lead outside.
    pub to: Vec<usize>,
    pub out: usize,
    pub doors: usize,
    pub windows: usize,
    pub things: BTreeMap<ThingKind, usize>,
    /// Share of its floor under stairs.
    pub stair_share: f64,
}

impl RoomSeen {
    fn has(&self, kind: ThingKind) -> usize {
        self.things.get(&kind).copied().unwrap_or(0)
    }

    fn shape(&self) -> Evidence {
        Evidence::Shape { area_m2: self.area_m2, doors: self.doors, windows: self.windows }
    }
}

/// What all rooms show.
pub(super) fn seen(known: &RoomsKnown<'_>) -> Vec<RoomSeen> {
    let mut out: Vec<RoomSeen> = known.rooms.iter().map(|r| of_area(r, known.human_scale)).collect();
    for way in known.ways {
        let sides = [way.beside, [way.beside[1], way.beside[0]]];
        for [here, there] in sides {
            let Beside::Room(room) = here else { continue };
            let Some(seen) = out.get_mut(room).filter(|_| here != there) else { continue };
            match (way.kind, there) {
                (OpeningKind::Window, _) => seen.windows += 1,
                (_, Beside::Room(other)) => {
                    seen.doors += 1;
                    if !seen.to.contains(&other) {
                        seen.to.push(other);
                    }
                }
                (_, Beside::Outside) => (seen.doors, seen.out) = (seen.doors + 1, seen.out + 1),
                (_, Beside::Nothing) => seen.doors += 1,
            }
        }
    }
    let boxes: Vec<[PointUm; 2]> = known.rooms.iter().map(box_um).collect();
    for thing in known.things {
        let at = thing.at();
        let is_here = |(k, room): &(usize, &Area)| {
            let [lo, hi] = boxes[*k];
            (0..2).all(|i| lo[i] <= at[i] && at[i] <= hi[i]) && room.holds(at)
        };
        let Some((k, room)) = known.rooms.iter().enumerate().find(is_here) else { continue };
        *out[k].things.entry(thing.kind).or_default() += 1;
        if thing.kind == ThingKind::Stair {
            let [lo, hi] = thing.extent;
            let ground_m2 = (hi[0] - lo[0]) as f64 * (hi[1] - lo[1]) as f64 / 1e12;
            out[k].stair_share += ground_m2 / room.area_m2.max(0.1);
        }
    }
    out
}

fn box_um(room: &Area) -> [PointUm; 2] {
    let fold = |of: fn(i64, i64) -> i64, start: i64| {
        room.outline.iter().fold([start; 2], |b, p| [of(b[0], p[0]), of(b[1], p[1])])
    };
    [fold(i64::min, i64::MAX), fold(i64::max, i64::MIN)]
}

fn of_area(room: &Area, human_scale: f64) -> RoomSeen {
    let ring = room.outline.iter().zip(room.outline.iter().cycle().skip(1));
    let girth_um: f64 = ring.map(|(a, b)| ((b[0] - a[0]) as f64).hypot((b[1] - a[1]) as f64)).sum();
    let (half, area_m2) = (girth_um / 2e6 / human_scale, room.area_m2 / human_scale.powi(2));
    let root = (half * half - 4.0 * area_m2).max(0.0).sqrt();
    // An outline with many corners has a long girth: nowhere narrower than the circle that fits in.
    let wide = ((half - root) / 2.0).max(2.0 * reach_m(room) / human_scale);
    RoomSeen { area_m2, sides_m: [(half + root) / 2.0, wide], ..RoomSeen::default() }
}

/// How far the middle of a room is from its outline, metres of the plan.
fn reach_m(room: &Area) -> f64 {
    let point = |p: &PointUm| DVec2::new(p[0] as f64, p[1] as f64) / UM_PER_M;
    let sides = room.outline.iter().zip(room.outline.iter().cycle().skip(1));
    let far = sides.map(|(a, b)| distance_to_segment(point(&room.at), [point(a), point(b)]));
    far.min_by(f64::total_cmp).unwrap_or(0.0)
}

/// In a larger room a toilet, a tub or a bed says no more what the room is for: walls round it were not read.
const BATH_MAX_M2: f64 = 30.0;
const BEDROOM_MAX_M2: f64 = 45.0;

/// A toilet cubicle and a row of them; what is larger and has a tub somewhere is a bath.
const WC_MAX_M2: f64 = 9.0;

/// Stairs over this share of a room make it one.
const STAIR_SHARE: f64 = 0.3;

/// Places to sit of a room to teach in.
const CLASS_CHAIRS: usize = 14;

/// Closets, metres of a person.
const CLOSET_M2: f64 = 5.0;

/// A room with so many ways to others is there to be passed.
const HALL_WAYS: usize = 5;

/// What the things in a room say; `None` where they say nothing.
pub(super) fn by_things(seen: &RoomSeen) -> Option<RoomKindFound> {
    use ThingKind as T;
    let has = |kind: T| seen.has(kind) > 0;
    let found = |kind: RoomKind, is_sure: bool, by: &[T]| {
        let things = by.iter().filter(|t| has(**t)).map(|t| Evidence::Things(*t, seen.has(*t)));
        Some(RoomKindFound::new(kind, is_sure, things.chain([seen.shape()]).collect()))
    };
    let (is_small, cooks) = (seen.area_m2 <= BATH_MAX_M2, has(T::Kitchen) || has(T::Fridge));
    let (sits, sleeps) = (has(T::Sofa), has(T::Bed) && seen.area_m2 <= BEDROOM_MAX_M2);
    let washes = has(T::Toilet) || has(T::Tub) || has(T::Urinal);
    if washes && is_small && !sleeps && !cooks && !sits {
        let kind = if has(T::Tub) { RoomKind::Bath } else { RoomKind::Wc };
        return found(kind, true, &[T::Tub, T::Toilet, T::Urinal, T::Basin]);
    }
    if sleeps {
        return found(RoomKind::Bedroom, !cooks && !washes, &[T::Bed, T::Kitchen]);
    }
    if has(T::Car) {
        return found(RoomKind::Garage, true, &[T::Car]);
    }
    if cooks && seen.area_m2 <= 2.0 * BEDROOM_MAX_M2 {
        let kind = if sits { RoomKind::Living } else { RoomKind::Kitchen };
        let is_sure = has(T::Kitchen) || sits || has(T::Sink);
        return found(kind, is_sure && !washes, &[T::Kitchen, T::Fridge, T::Sofa, T::Sink]);
    }
    if has(T::Lift) && seen.area_m2 <= CLOSET_M2 {
        return found(RoomKind::Plant, true, &[T::Lift]);
    }
    if seen.stair_share >= STAIR_SHARE {
        return found(RoomKind::Stair, true, &[T::Stair]);
    }
    if sits {
        return found(RoomKind::Living, seen.has(T::Sofa) > 1 || has(T::Table), &[T::Sofa, T::Table]);
    }
    if seen.has(T::Chair) >= CLASS_CHAIRS && (has(T::Board) || seen.has(T::Table) + seen.has(T::Desk) >= 6) {
        return found(RoomKind::Class, has(T::Board), &[T::Chair, T::Table, T::Desk, T::Board]);
    }
    if has(T::Desk) && !has(T::Wardrobe) {
        // In a larger room with desks people may be taught.
        let is_sure = seen.area_m2 <= OFFICE_MAX_M2 && (seen.has(T::Desk) > 1 || has(T::Chair));
        return found(RoomKind::Office, is_sure, &[T::Desk, T::Chair]);
    }
    if has(T::Table) && seen.has(T::Chair) >= 4 {
        return found(RoomKind::Dining, true, &[T::Table, T::Chair]);
    }
    if has(T::Wardrobe) {
        let kind = if seen.area_m2 <= CLOSET_M2 { RoomKind::Storage } else { RoomKind::Bedroom };
        let (kind, is_sure) = match seen.to.len() {
            0..=2 => (kind, false),
            ways => (RoomKind::Hall, ways >= HALL_WAYS),
        };
        return found(kind, is_sure, &[T::Wardrobe, T::Desk]);
    }
    if has(T::Machine) && !has(T::Sink) {
        return found(RoomKind::Plant, false, &[T::Machine]);
    }
    if seen.area_m2 <= BATH_MAX_M2 / 2.0 && (has(T::Basin) || has(T::Sanitary) || has(T::Sink)) {
        let kind = if seen.area_m2 <= WC_MAX_M2 / 3.0 { RoomKind::Wc } else { RoomKind::Bath };
        return found(kind, false, &[T::Basin, T::Sanitary, T::Sink]);
    }
    None
}

/// What a building is used for, as far as its other rooms say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Usage {
    is_dwelling: bool,
    has_windows: bool,
    /// Floor of the two largest rooms, m² of a person.
    largest_m2: [f64; 2],
}

/// A floor of which no room says anything is one of a dwelling where it has no more rooms, and no more floor, m².
const DWELLING_ROOMS: usize = 20;
const DWELLING_M2: f64 = 350.0;

impl Usage {
    /// By what is known of some of the rooms.
    pub fn of(found: &[Option<RoomKindFound>], seen: &[RoomSeen]) -> Self {
        let count = |is: fn(RoomKind) -> bool| found.iter().flatten().filter(|f| is(f.kind)).count();
        let (dwell, work) = (count(RoomKind::is_of_dwelling), count(RoomKind::is_of_work));
        let all_m2: f64 = seen.iter().map(|s| s.area_m2).sum();
        let is_small = seen.len() <= DWELLING_ROOMS && all_m2 <= DWELLING_M2;
        let mut areas: Vec<f64> = seen.iter().map(|s| s.area_m2).collect();
        areas.sort_by(|a, b| b.total_cmp(a));
        Self {
            is_dwelling: if dwell == work { is_small } else { dwell > work },
            has_windows: seen.iter().any(|s| s.windows > 0),
            largest_m2: [0, 1].map(|k| areas.get(k).copied().unwrap_or(0.0)),
        }
    }
}

impl Usage {
    /// What furniture means in such a building: a sofa where people work is for those who wait, a table with chairs for those
    /// who meet.
    pub fn adapted(&self, found: RoomKindFound) -> RoomKindFound {
        let is_by_things = matches!(found.evidence.first(), Some(Evidence::Things(..)));
        let kind = match found.kind {
            RoomKind::Living => RoomKind::Reception,
            RoomKind::Dining => RoomKind::Meeting,
            kind => kind,
        };
        let is_other = is_by_things && !self.is_dwelling && kind != found.kind;
        if is_other { RoomKindFound { kind, is_sure: false, ..found } } else { found }
    }
}

/// Closets without a window.
const STORAGE_MAX_M2: f64 = 3.0;

/// Baths and the smallest bedrooms.
const BATH_USUAL_M2: f64 = 6.5;

/// Largest usual bedroom, and what a room has over the next that is the one to live in.
const BEDROOM_USUAL_M2: f64 = 20.0;
const LIVING_SHARE: f64 = 1.25;

/// A way is no wider, and its sides differ by more than this.
const CORRIDOR_WIDE_M: f64 = 2.6;
const CORRIDOR_RATIO: f64 = 2.5;

/// A room with the door of the house, without a window.
const ENTRANCE_MAX_M2: f64 = 10.0;

/// An office is no larger, m².
const OFFICE_MAX_M2: f64 = 40.0;

/// What size, doors and place make likely.
pub(super) fn by_shape(seen: &RoomSeen, usage: &Usage) -> RoomKindFound {
    let guess = |kind: RoomKind, is_sure: bool| RoomKindFound::new(kind, is_sure, vec![seen.shape()]);
    let [long, wide] = seen.sides_m;
    let is_narrow = wide <= CORRIDOR_WIDE_M && long >= CORRIDOR_RATIO * wide;
    let (ways, is_dark) = (seen.to.len() + seen.out.min(1), usage.has_windows && seen.windows == 0);
    if is_narrow && ways >= 4 {
        return guess(RoomKind::Corridor, true);
    }
    if is_narrow && ways >= 2 && (ways >= 3 || is_dark) && seen.area_m2 > STORAGE_MAX_M2 {
        return guess(RoomKind::Corridor, false);
    }
    if !usage.is_dwelling {
        return match seen.area_m2 {
            a if a <= STORAGE_MAX_M2 => guess(RoomKind::Storage, false),
            a if a <= OFFICE_MAX_M2 && !is_dark && ways <= 3 => guess(RoomKind::Office, false),
            a if a <= 2.0 * BATH_USUAL_M2 && is_dark && ways == 1 => guess(RoomKind::Storage, false),
            _ if ways >= 4 => guess(RoomKind::Hall, false),
            _ => guess(RoomKind::Other, false),
        };
    }
    let is_largest = seen.area_m2 >= LIVING_SHARE * usage.largest_m2[1];
    match (seen.area_m2, ways) {
        (a, HALL_WAYS..) if a <= BEDROOM_USUAL_M2 => guess(RoomKind::Hall, true),
        (a, 3..) if a <= BEDROOM_USUAL_M2 && (is_dark || ways >= 4) => guess(RoomKind::Hall, false),
        (a, _) if a <= STORAGE_MAX_M2 => guess(RoomKind::Storage, false),
        (a, 2) if a <= ENTRANCE_MAX_M2 && is_dark && seen.out > 0 => guess(RoomKind::Hall, false),
        (a, 2) if a <= BATH_USUAL_M2 => guess(if is_dark { RoomKind::Hall } else { RoomKind::Bath }, false),
        (a, _) if a <= BATH_USUAL_M2 => guess(RoomKind::Bath, false),
        (a, _) if a > BEDROOM_USUAL_M2 && (is_largest || ways >= 2) => guess(RoomKind::Living, false),
        (a, 2..) if is_largest && a > 0.7 * BEDROOM_USUAL_M2 => guess(RoomKind::Living, false),
        (_, 0..=1) if is_dark => guess(RoomKind::Storage, false),
        _ => guess(RoomKind::Bedroom, false),
    }
}
