//! Openings that can slide along their walls, by the corners of the walls that go with them.

use glam::DVec2;

use super::Wall;
use super::frame::Frame;
use super::graph::Handle;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{self, Drawing, Entity, SourceRef};

/// An opening that can slide along its wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Slot {
    /// The opening.
    pub source: SourceRef,
    /// [`SourceRef::record`] of its wall.
    pub host: usize,
    /// What fills it, else its wall: as which it is shown closed.
    pub closing: SourceRef,
    /// What closes it, drawing units.
    pub outline: Vec<DVec2>,
    /// The corners of the wall that go with its first and its second side.
    pub jambs: [Vec<Handle>; 2],
    /// The middle of either side, metres, plan frame.
    pub at: [DVec2; 2],
    /// Unit vector along the wall, from the first side to the second.
    pub along: DVec2,
    /// Thickness of the wall, metres.
    pub thickness_m: f64,
    /// How far it may go back (≤ 0) and forth (≥ 0) until it meets a corner of the wall, metres.
    pub free_m: [f64; 2],
}

impl Slot {
    /// Whether the file gives this name to the opening, or to what fills it.
    pub fn is_named(&self, is_name: impl Fn(&String) -> bool) -> bool {
        let filler = Some(&self.closing).filter(|c| c.record != self.host);
        [Some(&self.source), filler].into_iter().flatten().filter_map(|s| s.handle.as_ref()).any(is_name)
    }
}

/// The openings that slide in walls of the plan.
pub(super) fn of(drawing: &Drawing, walls: &[Wall], frame: &Frame) -> Vec<Slot> {
    drawing.slots.iter().filter_map(|s| slot(s, walls, frame)).collect()
}

fn slot(s: &drawing::Slot, walls: &[Wall], frame: &Frame) -> Option<Slot> {
    let own: Vec<(u32, Vec<DVec2>)> = (0..)
        .zip(walls)
        .filter(|(_, w)| w.source.record == s.host && w.editable.moves_whole())
        .map(|(i, w)| (i, control_points(&w.shape)))
        .collect();
    let handles = |p: &DVec2| {
        let of_wall =
            |(w, points): &(u32, Vec<DVec2>)| points.iter().position(|q| q == p).map(|c| (*w, c as u32));
        own.iter().find_map(of_wall)
    };
    let side = |corners: &Vec<DVec2>| corners.iter().map(handles).collect::<Option<Vec<Handle>>>();
    let [first, second] = s.jambs.each_ref().map(side);
    let across = s.along.perp();
    let place = |corners: &Vec<DVec2>| {
        let middle = corners.iter().sum::<DVec2>() / corners.len() as f64;
        frame.plan_from_file(middle)
    };
    let deep = s.jambs.iter().flatten().map(|p| p.dot(across));
    let [low, high] = deep.fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(v), h.max(v)]);
    Some(Slot {
        source: s.source.clone(),
        host: s.host,
        closing: s.closing.clone(),
        outline: s.outline.clone(),
        jambs: [first?, second?],
        at: s.jambs.each_ref().map(place),
        along: s.along,
        thickness_m: (high - low) * frame.metres_per_unit,
        free_m: s.free.map(|way| way * frame.metres_per_unit),
    })
}

/// The opening that an entity closes.
pub(super) fn closed_by(slots: &[Slot], entity: &Entity) -> Option<usize> {
    let closes =
        |s: &Slot| s.closing.record == entity.source.record && control_points(&entity.shape) == s.outline;
    slots.iter().position(closes)
}
