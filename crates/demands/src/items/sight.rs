//! What is seen of a room, and how wide the outside is seen from it.

use enfilade_brief::demand::{Demand, From, Over};
use enfilade_engine::geometry::PointUm;
use enfilade_plan::axes::OpeningKind;
use glam::DVec2;

use super::{ROUNDING, judged};
use crate::answer::{Finding, Mark, Verdict};
use crate::building::{OpeningId, RoomId};
use crate::polygon::Polygon;
use crate::select;
use crate::site::Site;
use crate::view::{Field, Scene};

/// Places of a room lie on a grid of this, metres …
const PLACES_M: f64 = 0.3;

/// … and there are no more than this: half a metre apart in a hall of 100 m².
const PLACES_MAX: f64 = 400.0;

/// Beside an opening one stands this far inside the room, metres: what is seen from there is seen from nowhere else.
const BESIDE_M: f64 = 0.01;

/// What is seen of a room by less than this is not seen, as a share: a strip that eyes do not find.
const SEEN_MIN: f64 = 0.001;

/// The places of a floor: on a grid whose middle is that of its box.
fn places(floor: &Polygon) -> Vec<DVec2> {
    let Some([lo, hi]) = floor.bounds() else { return Vec::new() };
    let step = PLACES_M.max((floor.area_m2() / PLACES_MAX).sqrt());
    let counts = ((hi - lo) / step + ROUNDING).floor().max(DVec2::ONE);
    let first = lo.midpoint(hi) - (counts - DVec2::ONE) * step / 2.0;
    let all = (0..counts.x as usize).flat_map(|i| (0..counts.y as usize).map(move |j| [i, j]));
    all.map(|[i, j]| first + DVec2::new(i as f64, j as f64) * step).filter(|p| floor.holds(*p)).collect()
}

pub(super) fn seen(
    site: &Site<'_>,
    demand: &Demand,
    rooms: &[RoomId],
    others: &[RoomId],
) -> Result<Vec<Finding>, String> {
    let looks = Looks::new(site, demand, others)?;
    Ok(rooms.iter().map(|r| seen_one(site, demand, Some(*r), &site.rooms[r.0], &looks)).collect())
}

/// The ground of a mark, seen from the rooms that it names.
pub(super) fn ground_seen(
    site: &Site<'_>,
    demand: &Demand,
    ground: &[PointUm],
) -> Result<Vec<Finding>, String> {
    let Some(From::Rooms(word)) = &demand.other else { return Err("The mark names no room.".into()) };
    let ring: Vec<DVec2> = ground.iter().map(|p| site.at(*p)).collect();
    let looks = Looks::new(site, demand, &select::rooms(site.building, word)?)?;
    let floor = Polygon::new(&ring, &[]).within(&looks.floor);
    if floor.is_empty() {
        return Err("The mark lies on no floor.".into());
    }
    Ok(vec![seen_one(site, demand, None, &floor, &looks)])
}

/// From where one looks, over what.
struct Looks {
    floor: Polygon,
    scene: Scene,
    places: Vec<DVec2>,
    field: Option<Field>,
}

impl Looks {
    fn new(site: &Site<'_>, demand: &Demand, others: &[RoomId]) -> Result<Self, String> {
        let is_open = |id: OpeningId| {
            let o = &site.building.openings[id.0];
            let is_inner = (0..2).all(|side| site.building.beyond(id, side).is_some());
            is_inner && (o.kind != OpeningKind::Door || !demand.is_shut)
        };
        let floor = site.joined(is_open);
        let scene = Scene::new(&floor);
        let (places, field) = match &demand.other {
            Some(From::Place { at, facing }) => {
                let at = site.place(*at);
                if !floor.holds(at) {
                    return Err("The place from which one looks lies in no room.".into());
                }
                (vec![at], facing.map(|f| f.map(f64::to_radians)))
            }
            _ => (others.iter().flat_map(|o| standing(site, *o, &is_open)).collect(), None),
        };
        Ok(Self { floor, scene, places, field })
    }
}

/// Where one stands in a room: on its grid, and close to what it is open by.
fn standing(site: &Site<'_>, room: RoomId, is_open: &dyn Fn(OpeningId) -> bool) -> Vec<DVec2> {
    let floor = &site.rooms[room.0];
    let mut out = places(floor);
    for (id, side) in site.building.openings_of(room).filter(|o| is_open(o.0)) {
        let [a, b] = site.jambs(id);
        let half = site.building.openings[id.0].thickness_m / 2.0 + BESIDE_M;
        let into = (b - a).normalize_or_zero().perp() * half * if side == 0 { 1.0 } else { -1.0 };
        let beside = [0.02, 0.25, 0.5, 0.75, 0.98].map(|t| a.lerp(b, t) + into);
        out.extend(beside.into_iter().filter(|p| floor.holds(*p)));
    }
    out
}

fn seen_one(
    site: &Site<'_>,
    demand: &Demand,
    room: Option<RoomId>,
    floor: &Polygon,
    looks: &Looks,
) -> Finding {
    let seen = |p: &DVec2| looks.scene.seen(*p, looks.field).within(floor);
    let views: Vec<Polygon> = looks.places.iter().map(seen).collect();
    let seen = Polygon::union(views.iter().filter(|v| !v.is_empty()));
    let share = (seen.area_m2() / floor.area_m2().max(f64::MIN_POSITIVE)).min(1.0);
    let mut bound = demand.bound;
    match demand.kind.is_negative() {
        _ if bound.least.is_some() || bound.most.is_some() => {}
        true => bound.most = Some(SEEN_MIN),
        false => bound.least = Some(SEEN_MIN),
    }
    let mark = if seen.is_empty() { floor } else { &seen };
    let verdict = judged(bound, share);
    let found = room.map_or_else(
        || Finding::of_ground(verdict, share),
        |room| Finding::of_room(verdict, room, Some(share)),
    );
    found.at([site.ground_mark(mark)])
}

/// The horizontal angle of window that is seen from the places of a room.
pub(super) fn out(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let windows = site.outer_windows(room);
    let value = angle_deg(site, room, &windows, demand.over);
    let mut verdict = judged(demand.bound, value);
    let lines: Vec<Mark> = windows.iter().map(|id| site.line_mark(&site.jambs(*id))).collect();
    let ground = site.ground_mark(&site.rooms[room.0]);
    let doors = site.outer_doors(room);
    let with_doors = [windows.as_slice(), &doors].concat();
    let is_doubtful = verdict == Verdict::Fail
        && !doors.is_empty()
        && judged(demand.bound, angle_deg(site, room, &with_doors, demand.over)) == Verdict::Pass;
    if is_doubtful {
        verdict = Verdict::Untold;
    }
    let found = Finding::of_room(verdict, room, Some(value)).through(windows).at([ground]).at(lines);
    if is_doubtful { found.noted("It holds if the door to the outside is glazed.") } else { found }
}

fn angle_deg(site: &Site<'_>, room: RoomId, windows: &[OpeningId], over: Over) -> f64 {
    let floor = &site.rooms[room.0];
    let lines: Vec<[DVec2; 2]> = windows.iter().filter_map(|id| site.outer_line(*id)).collect();
    if lines.is_empty() {
        return 0.0;
    }
    let scene = Scene::new(&site.with_openings(room, windows));
    let mut angles: Vec<f64> =
        places(floor).iter().map(|p| scene.width_rad(*p, &lines).to_degrees()).collect();
    angles.sort_by(f64::total_cmp);
    let at = match over {
        Over::Least => 0,
        Over::Median => angles.len().saturating_sub(1) / 2,
        Over::Best => angles.len().saturating_sub(1),
    };
    angles.get(at).copied().unwrap_or(0.0)
}
