//! Whether a scene looks as if Z were up, as modellers have it that leave the exporter's "+Y up" unticked.

use glam::DVec3;

use super::bodies::SCENE_LAYER;
use super::body::Body;
use enfilade_report::{Place, Report};

/// Fewer walls say nothing.
const WALLS_MIN: usize = 4;
/// So many of the walls are as deep as the middle one, as walls of a storey are alike in height; and fewer as high.
const ALIKE_SHARE: f64 = 0.6;
/// They differ from it by less than this share.
const ALIKE_WITHIN: f64 = 0.1;
/// At least so many of the walls lie like plates, and as many stand.
const EACH_WAY_SHARE: f64 = 0.2;
/// What is thin in a direction measures less than this share of what it measures in either other.
const THIN_SHARE: f64 = 0.4;
/// A wall lying like a plate is at least so long, as a share of how deep it is: a coping is not.
const LENGTH_SHARE: f64 = 0.5;
/// What lies level in every building.
const LEVEL_WORDS: [&str; 8] = ["slab", "floor", "ceiling", "roof", "decke", "boden", "dalle", "plancher"];

/// Says so where the named walls of a scene lie on their sides.
pub(super) fn state(file: &str, bodies: &[Body<'_>], report: &mut Report) {
    let walls: Vec<DVec3> =
        bodies.iter().filter(|b| b.is_wall && b.layer != SCENE_LAYER).map(extent).collect();
    let levels: Vec<DVec3> = bodies.iter().filter(|b| is_level_by_name(&b.layer)).map(extent).collect();
    let Some(depth) = lying(&walls, &levels) else { return };
    let text = format!(
        "the scene looks as if Z were up: most of its {} walls measure {depth:.2} along Z and some lie like plates, \
         expected Y up as glTF has it; read as it stands, export it again with +Y up",
        walls.len()
    );
    report.warn("gltf-up", Place::file(file), text);
}

/// What a body measures, Z up.
fn extent(body: &Body<'_>) -> DVec3 {
    let points = || body.triangles.iter().flatten().copied();
    points().fold(DVec3::NEG_INFINITY, DVec3::max) - points().fold(DVec3::INFINITY, DVec3::min)
}

fn is_level_by_name(layer: &str) -> bool {
    let lower = layer.to_lowercase();
    lower.starts_with("ifcslab")
        || lower.split(|c: char| !c.is_alphabetic()).any(|w| LEVEL_WORDS.contains(&w))
}

/// How far the walls reach along the file's Z, where that is plainly their height; by what they and slabs measure, each
/// with the file's Z as `y` and its Y as `z`.
fn lying(walls: &[DVec3], levels: &[DVec3]) -> Option<f64> {
    if walls.len() < WALLS_MIN {
        return None;
    }
    let depth = middle(walls.iter().map(|e| e.y));
    let height = middle(walls.iter().map(|e| e.z));
    let is_near = |v: f64, middle: f64| (v - middle).abs() < ALIKE_WITHIN * middle;
    let alike: Vec<&DVec3> = walls.iter().filter(|e| is_near(e.y, depth)).collect();
    let as_high = walls.iter().filter(|e| is_near(e.z, height)).count();
    let is_plate = |e: &DVec3| e.z < THIN_SHARE * e.x.min(e.y) && e.x >= LENGTH_SHARE * depth;
    let stands = |e: &DVec3| e.x < THIN_SHARE * e.y.min(e.z);
    let share = |n: usize, of: usize| n as f64 / of as f64;
    let plates = share(alike.iter().filter(|e| is_plate(e)).count(), walls.len());
    let standing = share(alike.iter().filter(|e| stands(e)).count(), walls.len());
    // A slab that lies as it should speaks against it.
    let is_upright = |e: &&DVec3| e.y < THIN_SHARE * e.x.min(e.z);
    let upright = levels.iter().filter(is_upright).count();
    let is_plain = share(alike.len(), walls.len()) >= ALIKE_SHARE
        && as_high < alike.len()
        && plates.min(standing) >= EACH_WAY_SHARE
        && 2 * upright >= levels.len();
    is_plain.then_some(depth)
}

fn middle(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_walls_that_plainly_lie_on_their_sides_are_told() {
        let walls = |e: &[[f64; 3]]| e.iter().map(|e| DVec3::from(*e)).collect::<Vec<_>>();
        // The file's X, Z and Y: a hall of 8 by 6 by 2.8 m with a screen, Z up.
        let hall = [[8.0, 2.8, 0.2], [8.0, 2.8, 0.2], [0.2, 2.8, 6.0], [0.2, 2.8, 6.0], [3.0, 2.0, 0.1]];
        assert_eq!(lying(&walls(&hall), &[]), Some(2.8));
        assert_eq!(lying(&walls(&hall), &walls(&[[8.0, 0.3, 6.0]])), Some(2.8));
        assert_eq!(lying(&walls(&hall), &walls(&[[8.0, 6.0, 0.3]])), None, "its slab lies level");
        assert_eq!(lying(&walls(&hall[..3]), &[]), None, "too few");
        // The same with Y up; parallel screens of different heights; the same with copings on them.
        let up = hall.map(|[x, z, y]| [x, y, z]);
        assert_eq!(lying(&walls(&up), &[]), None);
        let screens: Vec<[f64; 3]> = (0..8).map(|i| [0.1, 3.0, 2.0 + f64::from(i)]).collect();
        assert_eq!(lying(&walls(&screens), &[]), None);
        let copings: Vec<[f64; 3]> = (0..8).map(|_| [0.3, 3.0, 0.05]).collect();
        assert_eq!(lying(&walls(&[screens, copings].concat()), &[]), None);
        // Square halls and cubes say nothing.
        assert_eq!(lying(&walls(&[[3.0, 3.0, 3.0]; 6]), &[]), None);
    }
}
