//! Partitions that marks allow to be built: each divides a room, straight across from one of its walls to the next.

use std::collections::BTreeMap;

use enfilade_brief::WorkKind;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use glam::DVec2;

use super::{Finder, Work, Works};
use crate::change::Change;
use crate::marks::Word;
use crate::rooms::{RoomId, room_at};
use crate::walls::{Wall, WallId};

/// Steps of places for a partition, metres of a person: whoever divides a room does not ask for centimetres.
const STEP_M: f64 = 0.5;
/// Thickness of a new partition, metres of a person.
pub const PARTITION_M: f64 = 0.1;
/// Least width of what a partition leaves beside it, metres of a person: a way.
const SIDE_M: f64 = 0.9;
/// Lengths of partitions, metres of a person: less is a pier, more crosses a hall.
const LENGTH_M: [f64; 2] = [0.9, 12.0];

impl Finder<'_> {
    /// The partition in each room that takes least from sight.
    pub(super) fn added(&self) -> Works {
        let p = &self.site.present;
        let mut out = Works::default();
        let allows_any =
            p.plan.markers.allowed.iter().flat_map(|m| &m.works).any(|w| w.kind == WorkKind::Add);
        if !allows_any {
            return out;
        }
        let mut best: BTreeMap<RoomId, Work> = BTreeMap::new();
        for id in (0..self.site.walls.len()).map(WallId) {
            for stretch in self.across(&self.site.walls[id.0]) {
                let length = stretch[0].distance(stretch[1]);
                let middle = p.plan.frame.um_from_plan(stretch[0].midpoint(stretch[1]));
                let Some(room) = room_at(p.rooms, middle) else { continue };
                if !self.is_free(stretch, room)
                    || self.word(WorkKind::Add, length, stretch, &[id]) != Word::Granted
                {
                    continue;
                }
                out.tried += 1;
                out.legal += 1;
                let change = Change { demolished: Vec::new(), built: self.faces(stretch) };
                let gained = p.gained(&p.difference(&change));
                if best.get(&room).is_some_and(|b| b.gained >= gained) {
                    continue;
                }
                let work = Work {
                    kind: WorkKind::Add,
                    walls: vec![id],
                    opening: None,
                    stretch,
                    width_m: length,
                    rooms: [Some(room); 2],
                    change,
                    demolished_m: 0.0,
                    built_m: length,
                    gained,
                    shows_through_doors: false,
                    forbidden_by: Vec::new(),
                };
                best.insert(room, work);
            }
        }
        out.works.extend(best.into_values());
        out
    }

    /// Straight ways from a wall's faces to what stops sight first.
    fn across(&self, wall: &Wall) -> Vec<[DVec2; 2]> {
        let (scale, plan) = (self.scale(), self.site.present.plan);
        let steps = (wall.length_m / (STEP_M * scale)).floor() as usize;
        let places = (1..=steps).map(|k| k as f64 * STEP_M * scale).filter(|t| *t < wall.length_m);
        let from = places.flat_map(|t| [1.0, -1.0].map(|side| (t, side)));
        let ray = |(t, side): (f64, f64)| {
            let at = wall.point(t, side * wall.thickness_m / 2.0);
            let towards = wall.along.perp() * side;
            // A little off the face that it starts at.
            let start = at + towards * 0.01 * scale;
            let end = start + towards * LENGTH_M[1] * scale;
            let hits = self.site.present.vista.obstacles().segments.iter();
            let share = hits
                .filter_map(|s| crossing(plan.frame.um_from_plan(start), plan.frame.um_from_plan(end), *s));
            let nearest = share.fold(f64::INFINITY, f64::min);
            let to = (nearest < 1.0).then(|| start.lerp(end, nearest))?;
            (at.distance(to) >= LENGTH_M[0] * scale).then_some([at, to])
        };
        from.filter_map(ray).collect()
    }

    /// Whether a room goes on at both sides of a partition, so far that people walk there.
    fn is_free(&self, [a, b]: [DVec2; 2], room: RoomId) -> bool {
        let (p, beside) = (&self.site.present, (b - a).normalize_or_zero().perp() * SIDE_M * self.scale());
        let is_room = |at: DVec2| room_at(p.rooms, p.plan.frame.um_from_plan(at)) == Some(room);
        [0.1, 0.5, 0.9].iter().all(|t| [beside, -beside].iter().all(|off| is_room(a.lerp(b, *t) + *off)))
    }

    fn faces(&self, [a, b]: [DVec2; 2]) -> Vec<Segment> {
        let plan = self.site.present.plan;
        let half = (b - a).normalize_or_zero().perp() * (PARTITION_M * self.scale() / 2.0);
        [half, -half]
            .map(|h| Segment { a: plan.frame.um_from_plan(a + h), b: plan.frame.um_from_plan(b + h) })
            .to_vec()
    }
}

/// How far along a way a segment crosses it, as a share.
fn crossing(from: PointUm, to: PointUm, s: Segment) -> Option<f64> {
    let m = |p: PointUm| DVec2::new((p[0] - from[0]) as f64, (p[1] - from[1]) as f64) / UM_PER_M;
    let (d, a, e) = (m(to), m(s.a), m(s.b) - m(s.a));
    let cross = d.perp_dot(e);
    if cross == 0.0 {
        return None;
    }
    let (share, along) = (a.perp_dot(e) / cross, a.perp_dot(d) / cross);
    ((0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&along)).then_some(share)
}
