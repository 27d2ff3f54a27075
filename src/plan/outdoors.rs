//! Ground that the drawing says is outdoors: outlines on layers named after terraces, balconies, courtyards.

use std::collections::BTreeSet;

use super::curve;
use super::drawing::{Drawing, Entity, Format, Shape};
use super::frame::Frame;
use super::geometry::{PointUm, UM_PER_M};
use super::layers::{base_name, words};

/// Words of layers that hold outlines of open air, lower case; those that begin with `*` may end a longer word.
const WORDS: &str = "terrace terraces *terrasse terrasses *terrassen terraza terrazas terrazza terrazze terraco terraço \
                     terras taras balcony balconies *balkon balkone balkons balcon balcons balcones balcone balconi \
                     varanda varandas patio patios courtyard courtyards innenhof hof cour cortile garden *garten jardin \
                     jardín giardino porch porches yard テラス バルコニー 庭 阳台 露台 терраса балкон";

/// Smaller outlines are pots, tables and names, m² of a person.
const AREA_MIN_M2: f64 = 2.0;

/// Most outlines that are looked at.
const RINGS_MAX: usize = 500;

/// The closed outlines on such layers that are shown and no walls, drawing frame, micrometres.
pub(super) fn find(
    drawing: &Drawing,
    is_wall: impl Fn(usize) -> bool,
    frame: &Frame,
    human_scale: f64,
) -> Vec<Vec<PointUm>> {
    if drawing.format != Format::Dxf {
        return Vec::new();
    }
    let hidden: BTreeSet<&str> =
        drawing.layers.iter().filter(|l| l.is_off || l.is_frozen).map(|l| l.name.as_str()).collect();
    let is_outline = |(i, e): &(usize, &Entity)| {
        let is_closed = matches!(e.shape, Shape::Polyline { closed: true, .. } | Shape::Circle { .. });
        is_closed && !is_wall(*i) && is_outdoors(&e.layer) && !hidden.contains(e.layer.as_str())
    };
    let shown = drawing.entities.iter().enumerate().filter(is_outline);
    let rings = shown.map(|(_, e)| curve::trace(&e.shape, frame).points);
    let least = AREA_MIN_M2 * (human_scale * UM_PER_M).powi(2);
    rings.filter(|ring| ring.len() > 2 && area(ring) >= least).take(RINGS_MAX).collect()
}

/// Whether the name of a layer says that what is drawn on it lies in the open air.
fn is_outdoors(layer: &str) -> bool {
    let says = |word: &String| {
        WORDS.split_whitespace().any(|known| match known.strip_prefix('*') {
            Some(end) => word.ends_with(end),
            None => word == known,
        })
    };
    words(base_name(layer)).iter().any(says)
}

fn area(ring: &[PointUm]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    let at = |p: &PointUm| [0, 1].map(|k| (p[k] - ring[0][k]) as f64);
    let twice: f64 =
        ring.iter().zip(next).map(|(p, q)| (at(p), at(q))).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    twice.abs() / 2.0
}

#[cfg(test)]
mod tests {
    use super::is_outdoors;

    #[test]
    fn layers_of_open_air_are_known_by_their_names() {
        for name in ["Terrace", "A-BALKON", "Dachterrasse", "x$0$PATIO", "BALCONI", "Garten", "阳台"] {
            assert!(is_outdoors(name), "{name}");
        }
        for name in ["Walls", "Decke", "Entrance", "Hofmann", "Yardstick", "0"] {
            assert!(!is_outdoors(name), "{name}");
        }
    }
}
