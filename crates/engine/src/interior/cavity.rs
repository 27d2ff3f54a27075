//! What is enclosed and no floor: cavities in walls, piers and chimneys that bare lines draw.

use super::raster::Raster;
use crate::geometry::UM_PER_M;

/// An enclosed part that is nowhere farther than this from a wall is a cavity inside a wall.
const CAVITY_HALF_WIDTH_M: f64 = 0.3;

/// A mass is nowhere farther than this from its outline: no room is so narrow that nothing says how it is entered.
const MASS_HALF_WIDTH_M: f64 = 0.8;

/// Half the width of a thick wall where it turns a corner: what is nowhere wider is a wall and no room.
const CORNER_HALF_WIDTH_M: f64 = 0.36;

/// Share of the lines round the rooms behind which there is a wall's thickness, from which on a plan draws its walls
/// with two faces; in others a line is a wall, and what lines enclose is a room.
const TWO_FACED: f64 = 0.6;

/// Share of a mass's outline beyond which there is a room, or the outside, at once.
const BARE: f64 = 0.9;

/// Pixels that a line is thick at most, however it runs.
const LINE_PX: usize = 3;

impl Raster {
    /// Enclosed parts that are nowhere far from a wall.
    pub fn cavities(&self, inside: &[bool], to_wall: &[f32], human_scale: f64) -> Vec<bool> {
        let reach = (CAVITY_HALF_WIDTH_M * human_scale * UM_PER_M / self.pixel_um as f64) as f32;
        let mut cavity = vec![false; inside.len()];
        let mut seen = vec![false; inside.len()];
        let open = |i: usize| inside[i] && !self.wall[i];
        for start in 0..inside.len() {
            if seen[start] || !open(start) {
                continue;
            }
            let part = self.flood(start, &mut seen, open);
            let widest = part.iter().map(|i| to_wall[*i]).fold(0.0, f32::max);
            if widest <= reach {
                part.iter().for_each(|i| cavity[*i] = true);
            }
        }
        cavity
    }

    /// Narrow parts that bare lines enclose in a plan whose walls have two faces: thick walls where they meet, piers,
    /// chimneys. What lies beyond their outline is a room or the outside and not a wall's thickness.
    pub fn masses(&self, human_scale: f64) -> Vec<bool> {
        let (label, widest) = self.parts(&self.distance(&self.wall));
        let reaches = |half_width_m: f64, part: u32| {
            let reach = (half_width_m * human_scale * UM_PER_M / self.pixel_um as f64) as f32;
            widest[part as usize] > reach
        };
        let is_wide = |part: u32| reaches(MASS_HALF_WIDTH_M, part);
        let is_wall = |part: u32| !reaches(CORNER_HALF_WIDTH_M, part);
        let mut outlines = vec![Outline::default(); widest.len()];
        for i in (0..self.wall.len()).filter(|i| !self.wall[*i]) {
            for (j, step) in self.around(i).filter(|(j, _)| self.wall[*j]) {
                let beyond = self.beyond(j, step).map(|k| label[k]);
                if beyond != Some(label[i]) {
                    let outline = &mut outlines[label[i] as usize];
                    outline.all += 1;
                    outline.wide += u64::from(beyond.is_some_and(is_wide));
                    outline.wall += u64::from(beyond.is_some_and(is_wall));
                }
            }
        }
        if !is_two_faced(&outlines, is_wide) {
            return vec![false; self.wall.len()];
        }
        let is_mass = |part: u32| {
            let outline = outlines[part as usize];
            !is_wide(part) && outline.wide as f64 >= BARE * outline.all as f64
        };
        (0..self.wall.len()).map(|i| !self.wall[i] && is_mass(label[i])).collect()
    }

    /// The first pixel behind a line that a step leads onto; none where it is thicker than a line.
    fn beyond(&self, onto: usize, step: isize) -> Option<usize> {
        let at = |n: usize| onto.checked_add_signed(step * n as isize).filter(|i| *i < self.wall.len());
        (1..=LINE_PX).map_while(at).find(|i| !self.wall[*i])
    }

    /// The part between lines that each pixel lies in, the outside first, and how far each reaches from the nearest line,
    /// pixels.
    fn parts(&self, to_wall: &[f32]) -> (Vec<u32>, Vec<f32>) {
        let (mut label, mut widest) = (vec![u32::MAX; self.wall.len()], Vec::new());
        let mut seen = self.wall.clone();
        for start in 0..label.len() {
            if seen[start] {
                continue;
            }
            let part = self.flood(start, &mut seen, |_| true);
            part.iter().for_each(|i| label[*i] = widest.len() as u32);
            widest.push(part.iter().map(|i| to_wall[*i]).fold(0.0, f32::max));
        }
        (label, widest)
    }
}

/// What lies beyond the outline of a part between lines, pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Outline {
    /// Its length.
    all: u64,
    /// How much of it leads to what is as wide as a room.
    wide: u64,
    /// How much of it leads to what is as thin as a wall.
    wall: u64,
}

/// Whether a plan draws its walls with two faces: rooms lead to their thickness. Where none is enclosed the outside
/// tells, the first part.
fn is_two_faced(outlines: &[Outline], is_wide: impl Fn(u32) -> bool) -> bool {
    let rooms = outlines.iter().enumerate().skip(1).filter(|(part, _)| is_wide(*part as u32));
    let [all, wide] = rooms.fold([0, 0], |[all, wide], (_, o)| [all + o.all, wide + o.wide]);
    match outlines.first() {
        _ if all > 0 => wide as f64 <= (1.0 - TWO_FACED) * all as f64,
        Some(outside) => outside.wall as f64 >= TWO_FACED * outside.all.max(1) as f64,
        None => false,
    }
}
