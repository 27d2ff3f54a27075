//! Cutting a box out of the faces of a mesh.

use glam::DVec3;

use super::caps::Slice;
use super::cutter::Cut;
use super::soup::{Face, Part};

/// A wall is no wall that goes on beside more of its stretch than this: others that meet it there take less.
const BESIDE_SHARE: f64 = 0.5;

impl Cut<'_> {
    /// Takes what lies in the box out of the faces of some pieces, and closes what was closed. `cut`: the height in the box at
    /// which the scene is seen.
    ///
    /// # Errors
    /// Where the box does not go through: a face that looks like a thin wall bounds something solid.
    pub fn make(&self, parts: &mut [Part], is_met: &dyn Fn(usize) -> bool, cut: f64) -> Result<(), String> {
        let sides = self.cutter.sides();
        let slices: Vec<Slice> = sides.iter().map(|s| self.slice(parts, is_met, *s)).collect();
        let most = self.size().x * BESIDE_SHARE;
        if slices.iter().zip(sides).any(|(slice, side)| side.0 == 1 && slice.solid_at(self, cut) > most) {
            return Err("its mesh goes on beside the stretch, so that a cut does not go through it".into());
        }
        let mut is_cut = false;
        for part in parts.iter_mut() {
            let faces = std::mem::take(&mut part.faces);
            for face in faces {
                let kept = if is_met(face.piece) { self.face(part, face) } else { None };
                match kept {
                    Some(kept) => {
                        (part.is_changed, is_cut) = (true, true);
                        part.faces.extend(kept);
                    }
                    None => part.faces.push(face),
                }
            }
        }
        if is_cut {
            slices.iter().for_each(|slice| slice.close(self, parts));
        }
        Ok(())
    }

    fn at(&self, part: &Part, v: u32) -> DVec3 {
        self.to_box.transform_point3(part.at(v))
    }

    /// What is left of a face; `None`: it stays as it is.
    fn face(&self, part: &mut Part, face: Face) -> Option<Vec<Face>> {
        let mut inner: Vec<u32> = face.corners.to_vec();
        let mut outer: Vec<Vec<u32>> = Vec::new();
        let points = face.corners.map(|v| self.at(part, v));
        let mut normal = (points[1] - points[0]).cross(points[2] - points[0]);
        if self.is_mirrored {
            normal = -normal;
        }
        for (axis, at, out) in self.cutter.sides() {
            let over: Vec<f64> = inner.iter().map(|v| self.over(part, *v, (axis, at, out))).collect();
            let (is_out, is_in) = (over.iter().any(|s| *s > 0.0), over.iter().any(|s| *s < 0.0));
            // A face in a side bounds what stands on its other side, or what goes.
            let is_kept = is_out || normal[axis] * out < 0.0;
            if !is_in && is_kept {
                inner.clear();
                break;
            }
            if is_out {
                let [outside, inside] = self.split(part, &inner, &over);
                outer.push(outside);
                inner = inside;
            }
        }
        if inner.len() < 3 {
            return None;
        }
        let fan = outer.iter().flat_map(|p| (2..p.len()).map(|k| [p[0], p[k - 1], p[k]]));
        let faces = fan.map(|corners| Face { corners, piece: face.piece });
        Some(faces.filter(|f| self.has_area(part, f)).collect())
    }

    fn has_area(&self, part: &Part, face: &Face) -> bool {
        let [a, b, c] = face.corners.map(|v| self.at(part, v));
        (b - a).cross(c - a).length() > self.near * self.near
    }

    /// How far a vertex lies beyond a side; nothing where it lies in it.
    fn over(&self, part: &Part, v: u32, (axis, at, out): (usize, f64, f64)) -> f64 {
        let over = (self.at(part, v)[axis] - at) * out;
        if over.abs() <= self.near { 0.0 } else { over }
    }

    /// A polygon outside a side and inside it.
    fn split(&self, part: &mut Part, polygon: &[u32], over: &[f64]) -> [Vec<u32>; 2] {
        let mut halves = [Vec::new(), Vec::new()];
        for k in 0..polygon.len() {
            let next = (k + 1) % polygon.len();
            let (v, s, t) = (polygon[k], over[k], over[next]);
            if s >= 0.0 {
                halves[0].push(v);
            }
            if s <= 0.0 {
                halves[1].push(v);
            }
            if s * t < 0.0 {
                let vertex = crossing(part, [v, polygon[next]], [s, t]);
                let new = part.push(&vertex);
                halves.iter_mut().for_each(|h| h.push(new));
            }
        }
        halves
    }

    /// Where the faces cross a side, just inside it and just outside it.
    fn slice(&self, parts: &[Part], is_met: &dyn Fn(usize) -> bool, side: (usize, f64, f64)) -> Slice {
        let mut slice = Slice::new(side);
        for (p, part) in parts.iter().enumerate() {
            for face in part.faces.iter().filter(|f| is_met(f.piece)) {
                let over = face.corners.map(|v| self.over(part, v, side));
                let inside = self.ends(part, face.corners, over.map(|s| (s, s < 0.0)));
                let outside = self.ends(part, face.corners, over.map(|s| (s, s <= 0.0)));
                let is_one = over.iter().all(|s| *s != 0.0);
                if let Some(ends) = inside {
                    slice.add(self, p, face.piece, ends, [true, is_one]);
                }
                if let Some(ends) = outside.filter(|_| !is_one) {
                    slice.add(self, p, face.piece, ends, [false, true]);
                }
            }
        }
        slice
    }

    /// Where a face leaves the half of which its corners are told to be, and where it comes back.
    fn ends(&self, part: &Part, corners: [u32; 3], over: [(f64, bool); 3]) -> Option<[Vec<f64>; 2]> {
        let mut ends = [None, None];
        for k in 0..3 {
            let next = (k + 1) % 3;
            let ((s, is_in), (t, goes_in)) = (over[k], over[next]);
            if is_in == goes_in {
                continue;
            }
            let end = match () {
                () if s == 0.0 => part.vertex(corners[k]).to_vec(),
                () if t == 0.0 => part.vertex(corners[next]).to_vec(),
                () => crossing(part, [corners[k], corners[next]], [s, t]),
            };
            ends[usize::from(goes_in)] = Some(end);
        }
        let [a, b] = ends;
        Some([a?, b?])
    }
}

/// What a vertex carries where an edge crosses a side; the same whichever way the edge is gone.
fn crossing(part: &Part, [a, b]: [u32; 2], [s, t]: [f64; 2]) -> Vec<f64> {
    let is_turned = part.at(a).to_array() > part.at(b).to_array();
    let ([a, b], [s, t]) = if is_turned { ([b, a], [t, s]) } else { ([a, b], [s, t]) };
    part.between(part.vertex(a), part.vertex(b), s / (s - t))
}
