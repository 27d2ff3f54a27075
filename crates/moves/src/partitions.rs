//! Partitions of a building that may slide between the walls they abut.
//!
//! An element that moves as a whole can shift across its length without opening a joint if it touches other
//! walls at its two ends only, and these go straight on beyond it, or if those that end at it run the same way and can
//! change their length with it.

use std::collections::BTreeSet;

use glam::DVec2;

use super::abutting::Standing;
use super::followed::{ByRecord, Followed, Follower, direction_of, ends, room_beside};
use super::sizes::{PARTITION_SLIDE_M, PARTITION_THICKNESS_MAX_M, SLIDE_MIN_M, TOUCH_M};
use enfilade_cad::plane::box_of;
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Segment, segments_touch};
use enfilade_engine::interior::Interior;
use enfilade_plan::Plan;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Group, Kind};

/// Steps in which the way of a partition is tried.
const STEP_M: f64 = 0.1;

/// A partition is at least this many times as long as thick.
const SLENDER: f64 = 3.0;

/// What stays free before the next wall.
const AHEAD_M: f64 = 0.5;

/// Walls whose direction differs by less than this sine run the way a partition slides.
const SAME_WAY_SIN: f64 = 0.02;

/// Most partitions of one building.
const PARTITIONS_MAX: usize = 24;

/// One element: its walls, its longest direction, its box along and across.
struct Element {
    walls: Vec<u32>,
    /// Ends of other walls that go along with it.
    followers: Vec<Follower>,
    along: DVec2,
    lo: DVec2,
    hi: DVec2,
}

/// A partition found.
struct Found {
    length: f64,
    /// Record of its wall.
    record: usize,
    group: Group,
    nodes: Vec<u32>,
    /// The ends that go along.
    followers: Vec<Follower>,
}

/// Groups of one clause each, the longest partition first.
pub(super) fn partitions(plan: &Plan, graph: &Graph, interior: &Interior) -> Vec<(Group, Vec<u32>)> {
    let mut found: Vec<Found> = Vec::new();
    let takes_structure = |e: &Element| e.followers.iter().any(|f| plan.bearing.contains_key(&f.record));
    let (drawn, by_record) = (Drawn::new(plan), ByRecord::new(plan));
    for element in elements(plan, &by_record) {
        let (from, to) = way(plan, interior, (&drawn, &by_record), &element);
        if to - from < SLIDE_MIN_M * plan.human_scale || takes_structure(&element) {
            continue;
        }
        let mut nodes: Vec<u32> =
            element.walls.iter().flat_map(|w| graph.control_nodes[*w as usize].clone()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let across = element.along.perp();
        let (across, from, to) =
            if across.x + across.y < 0.0 { (-across, -to, -from) } else { (across, from, to) };
        let kind = if across.y.abs() < 1e-6 {
            Kind::X
        } else if across.x.abs() < 1e-6 {
            Kind::Y
        } else {
            Kind::Along(across.to_angle())
        };
        let clause =
            Clause { kind, lower: from.min(0.0), upper: to.max(0.0), unit: "m".into(), si_per_unit: 1.0 };
        let source = plan.walls[element.walls[0] as usize].source.clone();
        let group =
            Group { name: String::new(), outline: Region::Ring(Vec::new()), clauses: vec![clause], source };
        let (length, record) = (element.hi.x - element.lo.x, group.source.record);
        found.push(Found { length, record, group, nodes, followers: element.followers });
    }
    found.sort_by(|a, b| b.length.total_cmp(&a.length).then_with(|| a.nodes.cmp(&b.nodes)));
    // One end goes along with one wall: the other would leave it.
    let mut taken: BTreeSet<(usize, usize)> = BTreeSet::new();
    found.retain(|f| {
        let ends = || f.followers.iter().map(|e| (e.record, e.end));
        let is_free = ends().all(|e| !taken.contains(&e));
        taken.extend(ends().filter(|_| is_free));
        is_free
    });
    found.truncate(PARTITIONS_MAX);
    hold_back(plan, &by_record, &mut found);
    let named = found.into_iter().enumerate().map(|(i, mut f)| {
        f.group.name = format!("wall-{}", i + 1);
        (f.group, f.nodes)
    });
    named.collect()
}

/// Shortens ways on which an end that goes along would be drawn back behind a wall that stands at its wall; where that
/// wall slides towards the end too, each gets half.
fn hold_back(plan: &Plan, by_record: &ByRecord<'_>, found: &mut Vec<Found>) {
    let standing = Standing::new(plan);
    for i in 0..found.len() {
        for f in found[i].followers.clone() {
            let inward = if f.end == 0 { f.along } else { -f.along };
            for beside in standing.beside(plan, by_record, &f, |r| r == found[i].record) {
                let other = found.iter().position(|o| o.record == beside.record);
                let drawn = reach(&mut found[i], inward).map_or(0.0, |way| way.abs());
                let comes = other.and_then(|o| reach(&mut found[o], -inward)).map_or(0.0, |way| way.abs());
                if drawn + comes <= beside.gap_m {
                    continue;
                }
                let tenths = |room: f64| (room.max(0.0) * 10.0 + 1e-6).floor() / 10.0;
                let own = drawn.min(tenths(beside.gap_m - comes.min(beside.gap_m / 2.0)));
                if let Some(way) = reach(&mut found[i], inward) {
                    *way = way.signum() * own + 0.0;
                }
                if let Some(way) = other.and_then(|o| reach(&mut found[o], -inward)) {
                    *way = way.signum() * comes.min(tenths(beside.gap_m - own)) + 0.0;
                }
            }
        }
    }
    let least = SLIDE_MIN_M * plan.human_scale;
    found.retain(|f| f.group.clauses.iter().all(|c| c.upper - c.lower >= least));
}

/// The bound of a partition's way that leads in a direction, where its way runs so.
fn reach(found: &mut Found, direction: DVec2) -> Option<&mut f64> {
    let clause = found.group.clauses.first_mut()?;
    let along = direction_of(clause.kind)?.dot(direction);
    match along.abs() > 1.0 - SAME_WAY_SIN {
        true if along > 0.0 => Some(&mut clause.upper),
        true => Some(&mut clause.lower),
        false => None,
    }
}

/// All drawn pieces with their records, doors and windows with those of their walls, ascending by their lowest x.
struct Drawn {
    pieces: Vec<(usize, Segment)>,
    /// The longest piece's extent in x, micrometres.
    widest: i64,
}

impl Drawn {
    fn new(plan: &Plan) -> Self {
        let walls = plan.walls.iter().map(|w| (w.source.record, &w.trace));
        let all = walls.chain(plan.plugs.iter().map(|p| (p.host, &p.outline)));
        let mut pieces: Vec<(usize, Segment)> =
            all.flat_map(|(record, t)| t.segments().map(move |s| (record, s.2))).collect();
        pieces.sort_by_key(|(_, s)| s.a[0].min(s.b[0]));
        let widest = pieces.iter().map(|(_, s)| (s.a[0] - s.b[0]).abs()).max().unwrap_or(0);
        Self { pieces, widest }
    }

    /// The pieces of other records that reach into a box, each place once.
    fn near(&self, [lo, hi]: [PointUm; 2], but: impl Fn(usize) -> bool) -> Vec<Segment> {
        let from = self.pieces.partition_point(|(_, s)| s.a[0].min(s.b[0]) < lo[0] - self.widest);
        let in_x = self.pieces[from..].iter().take_while(|(_, s)| s.a[0].min(s.b[0]) <= hi[0]);
        let is_near = |s: &Segment| {
            s.a[0].max(s.b[0]) >= lo[0] && s.a[1].max(s.b[1]) >= lo[1] && s.a[1].min(s.b[1]) <= hi[1]
        };
        let mut out: Vec<Segment> =
            in_x.filter(|(record, s)| is_near(s) && !but(*record)).map(|(_, s)| *s).collect();
        out.sort_unstable();
        out.dedup();
        out
    }
}

/// Elements of several outlines or one that are long and thin.
fn elements(plan: &Plan, by_record: &ByRecord<'_>) -> Vec<Element> {
    let mut movable: std::collections::BTreeMap<usize, Vec<u32>> = std::collections::BTreeMap::new();
    for (w, wall) in plan.walls.iter().enumerate() {
        if wall.editable.moves_whole() {
            movable.entry(wall.source.record).or_default().push(w as u32);
        }
    }
    let ends: Vec<(Follower, Vec<PointUm>)> = ends(plan)
        .into_iter()
        .map(|e| {
            let corners = e.corners(plan);
            (e, corners)
        })
        .collect();
    let found = movable.into_iter().filter_map(|(record, walls)| {
        let element = element(plan, by_record, walls).filter(|_| !plan.bearing.contains_key(&record))?;
        let own = Followed::new(by_record, record);
        let followers = own.map_or_else(Vec::new, |w| followers(&w, &ends, record, element.along.perp()));
        Some(Element { followers, ..element })
    });
    found.collect()
}

/// The ends, each with its corners, that stand at an element and can go along with it across its length.
fn followers(
    own: &Followed,
    ends: &[(Follower, Vec<PointUm>)],
    record: usize,
    across: DVec2,
) -> Vec<Follower> {
    let goes_along = |(e, corners): &&(Follower, Vec<PointUm>)| {
        e.record != record && e.along.perp_dot(across).abs() < SAME_WAY_SIN && own.is_joined_at(corners)
    };
    ends.iter().filter(goes_along).map(|(e, _)| e.clone()).collect()
}

fn element(plan: &Plan, by_record: &ByRecord<'_>, walls: Vec<u32>) -> Option<Element> {
    let segments = walls.iter().flat_map(|w| plan.walls[*w as usize].trace.segments().map(|s| s.2));
    let longest = segments.map(|s| plan.frame.plan_from_um(s.b) - plan.frame.plan_from_um(s.a));
    let longest = longest.max_by(|a, b| a.length().total_cmp(&b.length()))?;
    let along = longest.try_normalize()?;
    let local = |p: DVec2| DVec2::new(p.dot(along), p.dot(along.perp()));
    let record = plan.walls[*walls.first()? as usize].source.record;
    let plugs = by_record.plugs(record).flat_map(|p| &p.outline.points);
    let points = walls.iter().flat_map(|w| &plan.walls[*w as usize].trace.points).chain(plugs);
    let [lo, hi] = box_of(points.map(|p| local(plan.frame.plan_from_um(*p))))?;
    let is_slender = (hi.x - lo.x) >= SLENDER * (hi.y - lo.y);
    let is_thin = hi.y - lo.y <= PARTITION_THICKNESS_MAX_M * plan.human_scale + 1e-6;
    (is_slender && is_thin).then_some(Element { walls, followers: Vec::new(), along, lo, hi })
}

/// How far an element can slide backwards and forwards with its ends on the walls they abut.
fn way(
    plan: &Plan,
    interior: &Interior,
    (drawn, by_record): (&Drawn, &ByRecord<'_>),
    e: &Element,
) -> (f64, f64) {
    let scale = plan.human_scale;
    let world = |x: f64, y: f64| e.along * x + e.along.perp() * y;
    let um = |p: DVec2| plan.frame.um_from_plan(p);
    let reach = DVec2::new(TOUCH_M, PARTITION_SLIDE_M + AHEAD_M + TOUCH_M) * scale;
    let (low, high) = (e.lo - reach, e.hi + reach);
    let corners =
        [(low.x, low.y), (high.x, low.y), (high.x, high.y), (low.x, high.y)].map(|(x, y)| world(x, y));
    let own = plan.walls[e.walls[0] as usize].source.record;
    let goes_along = |record: usize| record == own || e.followers.iter().any(|f| f.record == record);
    let around = box_of(corners.into_iter()).unwrap_or_default().map(um);
    let others = drawn.near(around, goes_along);
    let room = room_beside(plan, by_record, &e.followers, e.along.perp());
    let touches = |a: DVec2, b: DVec2| {
        let probe = Segment { a: um(a), b: um(b) };
        others.iter().any(|s| segments_touch(probe, *s))
    };
    let (reach, inset) = (TOUCH_M * scale, TOUCH_M * scale);
    // An end that abuts: a feeler lengthwise from it meets a wall, at both edges of the element.
    let abuts = |x: f64, out: f64, from: f64, to: f64| {
        [from, to].iter().all(|y| touches(world(x - out * 0.01 * scale, *y), world(x + out * reach, *y)))
    };
    let (lo, hi) = (e.lo, e.hi);
    let rim = 0.002 * scale;
    let ends = [(lo.x, -1.0), (hi.x, 1.0)].map(|(x, out)| (x, out, abuts(x, out, lo.y + rim, hi.y - rim)));
    let is_free = |from: f64, to: f64| !touches(world(lo.x + inset, from), world(hi.x - inset, to));
    let is_inside = |y: f64| {
        [0.25, 0.5, 0.75]
            .iter()
            .all(|t| interior.depth_m(um(world(lo.x + (hi.x - lo.x) * t, y))) > 0.3 * scale)
    };
    let is_bound = ends.iter().any(|e| e.2) || !e.followers.is_empty();
    let sides_free = [lo.y - rim, hi.y + rim].iter().all(|y| is_free(*y, *y));
    // A face of another wall in it or at its side all along: it is that one's lining.
    let is_lining = [0.1, 0.3, 0.5, 0.7, 0.9].iter().all(|t| {
        let x = lo.x + (hi.x - lo.x) * t;
        touches(world(x, lo.y - rim), world(x, hi.y + rim))
    });
    if !is_bound
        || is_lining
        || !sides_free
        || !is_inside(lo.y - 0.35 * scale)
        || !is_inside(hi.y + 0.35 * scale)
    {
        return (0.0, 0.0);
    }
    let go = |sign: f64| {
        let (mut d, step) = (0.0, STEP_M * scale);
        let near = if sign < 0.0 { lo.y - rim } else { hi.y + rim };
        let most = (PARTITION_SLIDE_M * scale).min(room[usize::from(sign < 0.0)]);
        while d + step <= most + 1e-9 {
            let next = d + step;
            let ahead = near + sign * (next + AHEAD_M * scale);
            let mut joined = ends.iter().filter(|e| e.2);
            let keeps =
                joined.all(|(x, out, _)| abuts(*x, *out, lo.y + rim + sign * next, hi.y - rim + sign * next));
            let ends_free =
                ends.iter().filter(|e| !e.2).all(|(x, ..)| !touches(world(*x, near), world(*x, ahead)));
            let open = [0.1, 0.3, 0.5, 0.7, 0.9].iter().all(|t| {
                let x = lo.x + inset + (hi.x - lo.x - 2.0 * inset) * t;
                !touches(world(x, near), world(x, ahead))
            });
            if !keeps
                || !open
                || !ends_free
                || !is_free(near + sign * next, near + sign * next)
                || !is_inside(ahead)
            {
                break;
            }
            d = next;
        }
        (d * 10.0).round() / 10.0
    };
    (-go(-1.0), go(1.0))
}
