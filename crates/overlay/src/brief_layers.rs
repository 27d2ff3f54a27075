//! The brief of rooms in the architect's drawing: each item on a layer of its own, in the colour of its verdict.

use glam::DVec2;

use super::additions::{letter_height, plain};
use super::brief_item::{BriefFinding, BriefItem, colour, sign};
use enfilade_cad::drawing::{Addition, Mark};
use enfilade_cad::own_layers::BRIEF_PREFIX;

/// Corners of a circle.
const CORNERS: usize = 32;

/// Each item on its layer `EF-BRIEF-1`, …: ground, lines and circles of its places, and at each what was found. `to_plan`
/// takes metres of the drawing frame to those of the plan, in which `bounds` is the box of the plan.
pub fn brief_additions(
    items: &[BriefItem],
    to_plan: &dyn Fn([f64; 2]) -> [f64; 2],
    bounds: [[f64; 2]; 2],
) -> Vec<Addition> {
    let height = letter_height(bounds);
    let of = |item: &BriefItem| {
        let layer = format!("{BRIEF_PREFIX}{}", item.id);
        let places = item.findings.iter().flat_map(|finding| {
            let rgb = colour(&finding.verdict);
            let paths = paths_of(finding, to_plan);
            let middle = paths.first().map(|(points, _)| points.iter().sum::<DVec2>() / points.len() as f64);
            let words = middle.map(|at| Mark::Text { at, height, text: words_of(item, finding) });
            let paths = paths.into_iter().map(|(points, closed)| Mark::Path { points, closed });
            paths.chain(words).map(move |mark| (rgb, mark)).collect::<Vec<_>>()
        });
        places.map(|(rgb, mark)| Addition { layer: layer.clone(), rgb, mark }).collect::<Vec<_>>()
    };
    items.iter().flat_map(of).collect()
}

/// What is asked, and what was found there.
fn words_of(item: &BriefItem, finding: &BriefFinding) -> String {
    // Ticks and crosses are in no font of a CAD program that can be relied on.
    let verdict = match sign(&finding.verdict) {
        "✓" => "OK",
        "✗" => "NO",
        _ => "?",
    };
    plain(&format!("{verdict}: {} ({})", finding.words, item.ask))
}

/// Outlines of ground, lines, circles; each with whether it is closed.
fn paths_of(finding: &BriefFinding, to_plan: &dyn Fn([f64; 2]) -> [f64; 2]) -> Vec<(Vec<DVec2>, bool)> {
    let at = |p: &[f64; 2]| DVec2::from(to_plan(*p));
    let ground = finding.ground.iter().map(|ring| (ring.iter().map(at).collect(), true));
    let lines = finding.lines.iter().map(|line| (line.iter().map(at).collect(), false));
    let circles = finding.circles.iter().map(|[x, y, r]| {
        let corner = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
            at(&[x + r * cos, y + r * sin])
        };
        ((0..CORNERS).map(corner).collect(), true)
    });
    let all: Vec<(Vec<DVec2>, bool)> = ground.chain(lines).chain(circles).collect();
    all.into_iter().filter(|(points, _)| points.len() > 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_has_a_layer_with_its_places() {
        let place = |verdict: &str, ground: Vec<Vec<[f64; 2]>>| BriefFinding {
            verdict: verdict.into(),
            words: "kitchen: 7.5 m²".into(),
            ground,
            circles: vec![[1.0, 1.0, 0.75]],
            ..BriefFinding::default()
        };
        let item = |id: usize, findings| BriefItem {
            id,
            ask: "kitchen area min 8 m2".into(),
            findings,
            ..BriefItem::default()
        };
        let square = vec![vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]];
        let items = [
            item(1, vec![place("fail", square)]),
            item(7, vec![place("pass", Vec::new())]),
            item(8, Vec::new()),
        ];
        let shifted = |p: [f64; 2]| [p[0] + 10.0, p[1]];
        let made = brief_additions(&items, &shifted, [[0.0; 2], [20.0; 2]]);
        let layers: Vec<&str> = made.iter().map(|a| a.layer.as_str()).collect();
        assert_eq!(layers, ["EF-BRIEF-1", "EF-BRIEF-1", "EF-BRIEF-1", "EF-BRIEF-7", "EF-BRIEF-7"]);
        assert_ne!(made[0].rgb, made[3].rgb);
        let Mark::Path { points, closed: true } = &made[0].mark else { panic!("{:?}", made[0]) };
        assert_eq!(points[1], DVec2::new(12.0, 0.0));
        let Mark::Text { at, text, .. } = &made[2].mark else { panic!("{:?}", made[2]) };
        assert_eq!(
            (*at, text.as_str()),
            (DVec2::new(11.0, 1.0), "NO: kitchen: 7.5 m² (kitchen area min 8 m2)")
        );
    }
}
