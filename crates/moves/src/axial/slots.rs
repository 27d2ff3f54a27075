//! Doors of a building that slide along their walls with their openings.

use std::collections::BTreeSet;

use super::super::sizes::{DOOR_WIDTH_M, SLIDE_M, SLIDE_MIN_M};
use super::super::sliding::{Sliding, upright, whole_mm};
use super::{Axial, BESIDE_DOOR_M, REST_M};
use enfilade_plan::graph::Handle;
use enfilade_plan::slots::Slot;

impl Axial<'_> {
    /// The openings that may slide; none in a wall that is thicker than the drawing's partitions, or carries.
    pub(super) fn slots(&self) -> impl Iterator<Item = Sliding> {
        (0..self.plan.slots.len()).filter_map(|s| self.slot(s))
    }

    fn slot(&self, index: usize) -> Option<Sliding> {
        let (slot, scale) = (&self.plan.slots[index], self.plan.human_scale);
        let at = slot.at.map(|p| p / scale);
        let (width, thickness) = (at[0].distance(at[1]), slot.thickness_m / scale);
        let carries = self.plan.bearing.contains_key(&slot.host);
        let is_thick = self.has_partitions && thickness > self.carrying_m;
        if carries || is_thick || !(DOOR_WIDTH_M[0]..=DOOR_WIDTH_M[1]).contains(&width) {
            return None;
        }
        let centre = at[0].midpoint(at[1]);
        let sides = [-1.0, 1.0].map(|s| centre + slot.along.perp() * (s * BESIDE_DOOR_M));
        if !sides.iter().all(|p| self.is_inside(*p)) {
            return None;
        }
        let handles: BTreeSet<Handle> = slot.jambs.iter().flatten().copied().collect();
        let room = self.things.room_along(at, thickness, &handles, SLIDE_M);
        let [lo, hi] = self.free_of_others(index);
        let way = [-whole_mm((-lo.max(room[0])).max(0.0)), whole_mm(hi.min(room[1]).max(0.0))];
        let mut nodes: Vec<u32> =
            handles.iter().map(|(w, c)| self.graph.control_nodes[*w as usize][*c as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        (way[1] - way[0] >= 2.0 * SLIDE_MIN_M).then(|| {
            let (direction, is_turned) = upright(slot.along);
            let way = if is_turned { [-way[1], -way[0]] } else { way };
            // No −0: it would be told so.
            let way = way.map(|v| v * scale + 0.0);
            Sliding { nodes, direction, way, at: centre, size: width, slot: Some(index), wall: None }
        })
    }

    /// How far an opening may go until too little of its wall is left beside it, metres of a person. Where the next
    /// opening may slide too, each has half of what is between them.
    fn free_of_others(&self, index: usize) -> [f64; 2] {
        let (slots, scale) = (&self.plan.slots, self.plan.human_scale);
        let slot = &slots[index];
        let place = |s: &Slot, end: usize| s.at[end].dot(slot.along);
        let rest = |free: f64| (free / scale - REST_M).max(0.0);
        let [mut back, mut forth] = [rest(-slot.free_m[0]), rest(slot.free_m[1])];
        for other in slots.iter().filter(|o| o.host == slot.host && o.source != slot.source) {
            let is_alike = other.along.dot(slot.along) > 0.0;
            let [first, last] = if is_alike { [0, 1] } else { [1, 0] };
            let half = |gap: f64| (gap / scale - REST_M).max(0.0) / 2.0;
            let (before, behind) =
                (place(slot, 0) - place(other, last), place(other, first) - place(slot, 1));
            if before > 0.0 {
                back = back.min(half(before));
            }
            if behind > 0.0 {
                forth = forth.min(half(behind));
            }
        }
        [-back, forth]
    }
}
