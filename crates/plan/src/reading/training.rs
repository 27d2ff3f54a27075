//! What the classifier sees of a drawing, for `scripts/reading/train.py`.

use super::features::Features;
use super::scene::Scene;
use enfilade_cad::drawing::Drawing;

/// A straight piece or an arc of an entity, as the classifier sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Index of its entity in [`Drawing::entities`].
    pub entity: u32,
    /// Which of the drawing's layers it lies on, counted from 0 in the order of their first use.
    pub layer: u32,
    /// Length, metres.
    pub length_m: f32,
    /// Its features, in the order of [`feature_names`].
    pub features: Vec<f32>,
}

/// The pieces of a drawing that are shown and no marks of ours; `metres`: those of a drawing unit.
pub fn samples(drawing: &Drawing, metres: f64) -> Vec<Sample> {
    let Some(scene) = Scene::new(drawing, metres) else { return Vec::new() };
    let features = Features::new(&scene);
    let sample = |(i, piece): (usize, &super::scene::Piece)| {
        let thing = &scene.things[piece.thing as usize];
        Sample {
            entity: thing.entity,
            layer: thing.layer,
            length_m: piece.length as f32,
            features: features.row(i),
        }
    };
    scene.pieces.iter().enumerate().map(sample).collect()
}

/// Names of the features.
pub fn feature_names() -> Vec<String> {
    Features::names()
}
