//! Openings that can slide along their wall: the wall is alike on both sides of them, at every height that they reach.

use glam::{DAffine3, DVec2};

use super::super::geo::{Why, is_upright, plan_point};
use super::super::marks;
use super::super::model::{Product, product};
use super::{Closing, END_M, Frame, Reader};
use crate::drawing::Slot;
use crate::region::{Region, Rule};

/// Openings are looked at this far below their heads and above their sills, and at the height of the cut.
const WITHIN_M: f64 = 0.01;

/// So far beside an opening it is looked whether a room that reaches into it ends with it.
const BESIDE_M: f64 = 0.05;

/// What stands beside an opening at one height.
struct Beside {
    /// Whether the wall ends at both sides of it as at the height of the cut.
    is_alike: bool,
    /// How far the nearest corner of the wall is behind its first side and beyond its second one.
    free: [f64; 2],
}

impl<'b> Reader<'b, '_, '_> {
    /// Those of a wall. `region`: its cut in the world's plan, without what closes its openings.
    pub(super) fn slots(
        &self,
        wall: &'b Product,
        along: DVec2,
        region: &Region,
        closings: &[Closing<'b>],
    ) -> Vec<Slot> {
        let is_held = |id: u64| {
            marks::kept(self.b, id).is_some() || super::super::building::refusal(self.b, id).is_some()
        };
        if is_held(wall.id) {
            return Vec::new();
        }
        let doors = closings.iter().filter(|c| c.layer != "IfcWindow");
        let free =
            doors.filter_map(|c| Some((c, c.opening?))).filter(|(c, id)| !is_held(c.of.id) && !is_held(*id));
        free.filter_map(|(c, id)| self.slot((wall, region), along, c, id)).collect()
    }

    /// An opening stays where a room reaches into it and not into the wall beside it: the room would be left in the wall.
    pub(super) fn keep_reached(&mut self, room: &Region) {
        let Some([lo, hi]) = room.extent() else { return };
        let beside = BESIDE_M / self.b.geo.metres;
        self.slots.retain(|slot| {
            if !slot.outline.iter().any(|p| p.cmpge(lo).all() && p.cmple(hi).all()) {
                return true;
            }
            let shared = |by: f64| {
                let moved = slot.outline.iter().map(|p| (*p + slot.along * by).to_array()).collect();
                Region::ring(moved).combine(room, Rule::Intersection).area()
            };
            let places = || slot.outline.iter().map(|p| p.dot(slot.along));
            let width = places().fold(f64::MIN, f64::max) - places().fold(f64::MAX, f64::min);
            let own = shared(0.0);
            // Half of what a room loses that ends with the opening.
            [-beside, beside].iter().all(|by| own - shared(*by) <= own * (beside / width) / 2.0)
        });
    }

    fn slot(
        &self,
        (wall, region): (&'b Product, &Region),
        along: DVec2,
        closing: &Closing<'b>,
        opening: u64,
    ) -> Option<Slot> {
        let near = END_M / self.b.geo.metres;
        let mut rings = closing.region.rings();
        let outline: Vec<DVec2> = rings.next()?.iter().map(|p| DVec2::from(*p)).collect();
        if rings.next().is_some() {
            return None;
        }
        let places = || outline.iter().map(|p| p.dot(along));
        let sides = [places().fold(f64::MAX, f64::min), places().fold(f64::MIN, f64::max)];
        if outline.iter().any(|p| sides.iter().all(|s| (p.dot(along) - s).abs() > near)) {
            return None;
        }
        let mut jambs: [Vec<DVec2>; 2] = Default::default();
        for p in region.points().filter(|p| outline.iter().any(|q| q.distance(*p) <= near)) {
            jambs[usize::from((p.dot(along) - sides[1]).abs() <= near)].push(p);
        }
        if jambs.iter().any(|side| side.len() < 2) {
            return None;
        }
        let mut free = [f64::INFINITY; 2];
        for z in self.heights_of(opening, wall)? {
            let beside = self.beside(wall, opening, (along, sides), z).ok()?;
            if !beside.is_alike {
                return None;
            }
            free = [0, 1].map(|k| free[k].min(beside.free[k]));
        }
        Some(Slot {
            source: self.b.source(&product(self.b.step, opening, "IfcOpeningElement"), closing.layer),
            host: wall.id as usize,
            closing: self.b.source(closing.of, closing.layer),
            outline,
            jambs,
            along,
            free: [-free[0], free[1]],
        })
    }

    /// The heights at which an opening of a wall is looked at.
    fn heights_of(&self, opening: u64, wall: &Product) -> Option<[f64; 3]> {
        let hole = self.b.reach(&product(self.b.step, opening, "IfcOpeningElement"))?;
        let wall = self.b.reach(wall)?;
        let within = WITHIN_M / self.b.geo.metres;
        let [low, high] = [hole[0].max(wall[0]) + within, hole[1].min(wall[1]) - within];
        (low < self.cut && self.cut < high).then_some([low, self.cut, high])
    }

    /// What of a wall is beside one of its openings at a height.
    fn beside(
        &self,
        wall: &Product,
        opening: u64,
        (along, sides): (DVec2, [f64; 2]),
        z: f64,
    ) -> Result<Beside, Why> {
        let world = wall.placement.map_or(Ok(DAffine3::IDENTITY), |m| self.b.geo.placement(m))?;
        if !is_upright(&world) {
            return Err("it leans".into());
        }
        let frame = Frame { world, to: DAffine3::IDENTITY, z: z - world.translation.z };
        let mut region = self.body(wall, wall.shape.ok_or("it has no shape")?, &frame)?.0;
        for hole in self.b.model.openings.get(&wall.id).into_iter().flatten() {
            let (hole_there, missing) = self.opening(*hole, wall, &frame)?;
            if *hole == opening && !missing.is_empty() {
                return Err("its opening cannot be read".into());
            }
            region = region.combine(&hole_there, Rule::Difference);
        }
        let near = END_M / self.b.geo.metres;
        let places: Vec<f64> = region.points().map(|p| plan_point(&frame.world, p).dot(along)).collect();
        let at = |side: f64| places.iter().filter(|x| (**x - side).abs() <= near).count();
        let [first, second] = sides;
        let behind = places.iter().map(|x| first - x).filter(|d| *d > near);
        let beyond = places.iter().map(|x| x - second).filter(|d| *d > near);
        Ok(Beside {
            is_alike: at(first) >= 2
                && at(second) >= 2
                && !places.iter().any(|x| *x > first + near && *x < second - near),
            free: [behind.fold(f64::INFINITY, f64::min), beyond.fold(f64::INFINITY, f64::min)],
        })
    }
}
