//! A mesh shown in the scene, or one piece of it.

use glam::DVec3;

use super::scene::Shown;
use crate::sizes::SOLID_HALF_WIDTH_M;

/// A mesh shown in the scene, Z up, or one piece of it.
pub(super) struct Body<'f> {
    /// Where it is shown.
    pub shown: &'f Shown,
    /// What moves with it: the node itself, or the one that it hangs on and that says how it moves.
    pub element: &'f Shown,
    /// Why the element cannot move.
    pub held: Option<String>,
    /// The piece, where several walls share the mesh.
    pub piece: Option<usize>,
    /// What it is.
    pub layer: String,
    /// Whether that is a wall.
    pub is_wall: bool,
    /// Its faces, units of the scene.
    pub triangles: Vec<[DVec3; 3]>,
    /// Its lowest point.
    pub low: f64,
    /// Its highest point.
    pub high: f64,
}

impl Body<'_> {
    /// Whether it fills a room: as high as one, and wider than what is solid in a plan. Programs that make scenes of an IFC
    /// write the bodies of its spaces among the others.
    pub fn is_room(&self) -> bool {
        let origin = self.triangles.first().map_or(DVec3::ZERO, |t| t[0]);
        let (mut volume, mut surface) = (0.0, 0.0);
        for [a, b, c] in self.triangles.iter().map(|t| t.map(|p| p - origin)) {
            volume += a.dot(b.cross(c)) / 6.0;
            surface += (b - a).cross(c - a).length() / 2.0;
        }
        // As of an upright prism: its ground by half of what goes round it is how wide a long one is.
        let high = self.high - self.low;
        let ground = volume.abs() / high;
        let round = (surface - 2.0 * ground) / high;
        high >= ROOM_HIGH_M && 2.0 * ground > 2.0 * SOLID_HALF_WIDTH_M * round
    }
}

/// No room is lower, metres.
const ROOM_HIGH_M: f64 = 2.0;
