//! A storey in metres, with the polygons that its items share.

use std::cell::OnceCell;

use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::kinds::RoomKind;
use glam::DVec2;

use crate::answer::Mark;
use crate::building::{Building, Exit, OpeningId, RoomId};
use crate::polygon::{Polygon, quad};
use crate::walk::Ground;

/// How far an opening is drawn into its rooms so that they are one floor, metres: outlines of rooms are exact to less.
const INTO_ROOM_M: f64 = 0.03;

/// Thickness of an opening in a wall that is a line, metres.
const LINE_M: f64 = 0.0002;

/// Corners of a leaf lie this near to the outline of the room that it takes ground from, metres.
const AT_LEAF_M: f64 = 0.005;

/// A storey in metres from a point of its own, so that products keep their digits.
pub(crate) struct Site<'a> {
    /// As it was handed over.
    pub building: &'a Building,
    origin: PointUm,
    /// Floor of every room, with the ground under leaves.
    pub rooms: Vec<Polygon>,
    ground: OnceCell<Option<Ground>>,
    exits: OnceCell<Vec<ExitLine>>,
}

/// An exit in metres.
#[derive(Clone, Debug)]
pub(crate) struct ExitLine {
    pub line: [DVec2; 2],
    pub opening: Option<OpeningId>,
}

impl<'a> Site<'a> {
    /// Of a storey.
    pub fn new(building: &'a Building) -> Self {
        let origin = building.rooms.first().map(|r| r.area.at).unwrap_or_default();
        let mut out =
            Self { building, origin, rooms: Vec::new(), ground: OnceCell::new(), exits: OnceCell::new() };
        out.rooms = building.rooms.iter().map(|r| out.outline(&r.area)).collect();
        out.give_back_leaves();
        out
    }

    fn outline(&self, area: &enfilade_plan::floor::Area) -> Polygon {
        let ring = |r: &[PointUm]| r.iter().map(|p| self.at(*p)).collect::<Vec<_>>();
        let holes: Vec<Vec<DVec2>> = area.holes.iter().map(|h| ring(h)).collect();
        Polygon::new(&ring(&area.outline), &holes)
    }

    /// A leaf that stands open takes no floor: it goes back to the room whose outline runs round it.
    fn give_back_leaves(&mut self) {
        for opening in &self.building.openings {
            for leaf in opening.leaves.iter().filter(|l| l.len() > 2) {
                let ring: Vec<DVec2> = leaf.iter().map(|p| self.at(*p)).collect();
                let near =
                    |room: &Polygon| ring.iter().filter(|p| room.depth_m(**p).abs() < AT_LEAF_M).count();
                let best = (0..self.rooms.len()).max_by_key(|r| (near(&self.rooms[*r]), usize::MAX - r));
                if let Some(r) = best.filter(|r| near(&self.rooms[*r]) > 1) {
                    self.rooms[r] = self.rooms[r].with(&Polygon::new(&ring, &[]));
                }
            }
        }
    }

    /// Metres of a point.
    pub fn at(&self, p: PointUm) -> DVec2 {
        DVec2::new((p[0] - self.origin[0]) as f64, (p[1] - self.origin[1]) as f64) / UM_PER_M
    }

    /// A point as results give it.
    pub fn um(&self, p: DVec2) -> PointUm {
        [0, 1].map(|k| self.origin[k] + (p[k] * UM_PER_M).round() as i64)
    }

    /// A place of the brief.
    pub fn place(&self, at: [f64; 2]) -> DVec2 {
        let by = if self.building.um_per_unit > 0.0 { self.building.um_per_unit } else { UM_PER_M };
        self.at(at.map(|v| (v * by).round() as i64))
    }

    /// The floor of a room for a map.
    pub fn ground_mark(&self, floor: &Polygon) -> Mark {
        Mark::Ground(floor.rings().map(|r| r.iter().map(|p| self.um(*p)).collect()).collect())
    }

    /// A line for a map.
    pub fn line_mark(&self, line: &[DVec2]) -> Mark {
        Mark::Line(line.iter().map(|p| self.um(*p)).collect())
    }

    /// The jambs of an opening.
    pub fn jambs(&self, id: OpeningId) -> [DVec2; 2] {
        self.building.openings[id.0].jambs.map(|p| self.at(p))
    }

    /// The ground of an opening, drawn into the rooms on both sides.
    fn opening(&self, id: OpeningId) -> Polygon {
        let half = self.building.openings[id.0].thickness_m.max(LINE_M) / 2.0;
        let into = |side: usize| half + if self.has_room(id, side) { INTO_ROOM_M } else { 0.0 };
        quad(self.jambs(id), [into(0), into(1)])
    }

    fn has_room(&self, id: OpeningId, side: usize) -> bool {
        matches!(self.building.openings[id.0].beside[side], enfilade_plan::floor::Beside::Room(_))
    }

    /// Where an outer opening ends: the line along the outer face.
    pub fn outer_line(&self, id: OpeningId) -> Option<[DVec2; 2]> {
        let opening = &self.building.openings[id.0];
        let side = (0..2).find(|s| opening.beside[*s] == enfilade_plan::floor::Beside::Outside)?;
        let [a, b] = self.jambs(id);
        let half = opening.thickness_m.max(LINE_M) / 2.0;
        let out = (b - a).normalize_or_zero().perp() * half * if side == 0 { 1.0 } else { -1.0 };
        Some([a + out, b + out])
    }

    /// Rooms with those of their openings that are open, as one floor.
    pub fn joined(&self, is_open: impl Fn(OpeningId) -> bool) -> Polygon {
        let ids = (0..self.building.openings.len()).map(OpeningId);
        let openings: Vec<Polygon> = ids.filter(|id| is_open(*id)).map(|id| self.opening(id)).collect();
        Polygon::union(self.rooms.iter().chain(&openings))
    }

    /// What one walks on; `None` where it has too many corners.
    pub fn ground(&self) -> Option<&Ground> {
        let new = || Ground::new(&self.joined(|id| self.building.openings[id.0].is_way()));
        self.ground.get_or_init(new).as_ref()
    }

    /// Where the storey is left: as the drawing says, else by its outer doors, else by the doors of its stairs.
    pub fn exits(&self) -> &[ExitLine] {
        self.exits.get_or_init(|| {
            let line = |e: &Exit| ExitLine { line: e.line.map(|p| self.at(p)), opening: e.opening };
            if !self.building.exits.is_empty() {
                return self.building.exits.iter().map(line).collect();
            }
            let ids = || (0..self.building.openings.len()).map(OpeningId);
            let of = |id: OpeningId| ExitLine { line: self.jambs(id), opening: Some(id) };
            let is_out = |id: &OpeningId| {
                let o = &self.building.openings[id.0];
                o.is_outer() && o.is_way()
            };
            let outer: Vec<ExitLine> = ids().filter(is_out).map(of).collect();
            if !outer.is_empty() {
                return outer;
            }
            ids().filter(|id| self.leads_to_stair(*id)).map(of).collect()
        })
    }

    fn leads_to_stair(&self, id: OpeningId) -> bool {
        let is_stair = |side: usize| {
            self.building.beyond(id, side).is_some_and(|r| self.building.room(r).kind == RoomKind::Stair)
        };
        self.building.openings[id.0].is_way() && (is_stair(0) != is_stair(1))
    }

    /// Windows of a room to the outside; no plan tells glazed doors.
    pub fn outer_windows(&self, room: RoomId) -> Vec<OpeningId> {
        let is_one = |id: &OpeningId| {
            let o = &self.building.openings[id.0];
            o.kind == OpeningKind::Window && o.is_outer()
        };
        self.building.openings_of(room).map(|o| o.0).filter(is_one).collect()
    }

    /// Doors of a room to the outside, which may be glazed.
    pub fn outer_doors(&self, room: RoomId) -> Vec<OpeningId> {
        let is_one = |id: &OpeningId| {
            let o = &self.building.openings[id.0];
            o.kind == OpeningKind::Door && o.is_outer()
        };
        self.building.openings_of(room).map(|o| o.0).filter(is_one).collect()
    }

    /// A room with some of its openings.
    pub fn with_openings(&self, room: RoomId, openings: &[OpeningId]) -> Polygon {
        let openings: Vec<Polygon> = openings.iter().map(|id| self.opening(*id)).collect();
        Polygon::union(std::iter::once(&self.rooms[room.0]).chain(&openings))
    }
}
