//! Regions in which places are measured or seen.

use crate::geometry::{PointUm, Side, cross_um, side_of_ring};

/// A region drawn by the user, drawing frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// A closed polygon; its outline belongs to it.
    Ring(Vec<PointUm>),
    /// A disc; its outline belongs to it.
    Disc {
        /// Centre.
        centre: PointUm,
        /// Radius, micrometres.
        radius_um: i64,
    },
}

/// Most corners of an outline of which it is asked whether it crosses itself.
const CROSSED_MAX: usize = 1000;

impl Region {
    /// Whether `p` lies in the region or on its outline. Exact.
    pub fn contains(&self, p: PointUm) -> bool {
        match self {
            Self::Ring(ring) => side_of_ring(ring, p) != Side::Outside,
            Self::Disc { centre, radius_um } => {
                let (dx, dy) = ((p[0] - centre[0]) as i128, (p[1] - centre[1]) as i128);
                dx * dx + dy * dy <= i128::from(*radius_um) * i128::from(*radius_um)
            }
        }
    }

    /// Whether two sides cross; not looked for in an outline of more than `CROSSED_MAX` corners.
    pub fn crosses_itself(&self) -> bool {
        let Self::Ring(ring) = self else { return false };
        if ring.len() > CROSSED_MAX {
            return false;
        }
        let side = |i: usize| [ring[i], ring[(i + 1) % ring.len()]];
        let parts = |[a, b]: [PointUm; 2], [p, q]: [PointUm; 2]| {
            cross_um(a, b, p).signum() * cross_um(a, b, q).signum() < 0
        };
        let crosses = |s, t| parts(s, t) && parts(t, s);
        (0..ring.len()).any(|i| (0..i).any(|j| crosses(side(i), side(j))))
    }

    /// The outline as points to draw, drawing frame.
    pub fn outline(&self) -> Vec<PointUm> {
        match self {
            Self::Ring(ring) => ring.clone(),
            Self::Disc { centre, radius_um } => (0..64)
                .map(|i| {
                    let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 64.0).sin_cos();
                    let at = |share: f64| (share * *radius_um as f64).round() as i64;
                    [centre[0] + at(cos), centre[1] + at(sin)]
                })
                .collect(),
        }
    }
}
