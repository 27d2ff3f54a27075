//! What is cut out of a mesh: a box over a stretch of wall.

use glam::{DAffine3, DMat3, DVec2, DVec3};

/// What is to go: a box about an upright axis, in units of the scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cutter {
    /// From the world, Z up, to the box: along the wall, across it, and up.
    pub to_box: DAffine3,
    /// What it measures there, from the origin.
    pub size: DVec3,
}

impl Cutter {
    /// Over a stretch of wall, corners in ring order, along the wall first; between two heights. `None` where it has no size.
    pub fn over(gone: &[DVec2; 4], [low, high]: [f64; 2]) -> Option<Self> {
        let [a, b, _, d] = *gone;
        let (along, across) = ((b - a).try_normalize()?, (d - a).try_normalize()?);
        let axes = DMat3::from_cols(along.extend(0.0), across.extend(0.0), DVec3::Z);
        let from_box = DAffine3::from_mat3_translation(axes, a.extend(low));
        let to_box = from_box.inverse();
        let size = DVec3::new(a.distance(b), a.distance(d), high - low);
        (to_box.is_finite() && size.min_element() > 0.0).then_some(Self { to_box, size })
    }

    /// Its sides: the axis, where on it, and which way is out.
    pub fn sides(&self) -> [(usize, f64, f64); 6] {
        // The jambs first: what is cut at the height of a head is then cut between them alone.
        let s = self.size;
        [(0, 0.0, -1.0), (0, s.x, 1.0), (2, 0.0, -1.0), (2, s.z, 1.0), (1, 0.0, -1.0), (1, s.y, 1.0)]
    }
}

/// A cut: of what, into what, and how exactly.
pub(super) struct Cut<'c> {
    /// What goes.
    pub cutter: &'c Cutter,
    /// From coordinates of the mesh to the box.
    pub to_box: DAffine3,
    /// Whether that, or what viewers make of a mirrored node, turns faces inside out.
    pub is_mirrored: bool,
    /// What lies nearer to a side than this lies in it, units of the scene.
    pub near: f64,
}

impl Cut<'_> {
    /// The size of the box.
    pub fn size(&self) -> DVec3 {
        self.cutter.size
    }
}
