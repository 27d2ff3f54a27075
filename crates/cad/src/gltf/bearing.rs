//! Which walls of a scene carry or hold fire up: what their nodes, or what these hang on, say in `extras` by the names that
//! IFC has for it.

use std::collections::BTreeMap;

use super::body::Body;
use super::json::{Json, Value};
use super::record::record;
use super::scene::File;
use crate::bearing::Bearing;

/// The structure by record.
pub(super) fn bearing(scene: &File<'_>, bodies: &[Body<'_>]) -> BTreeMap<usize, Bearing> {
    let walls = bodies.iter().filter(|b| b.is_wall);
    let one = |b: &Body<'_>| Some((record(b.element.node, b.piece), stated(scene, &b.shown.path())?));
    walls.filter_map(one).collect()
}

fn stated(scene: &File<'_>, path: &[usize]) -> Option<Bearing> {
    let nearest = |key: &str| {
        let nodes = scene.json.list("nodes");
        path.iter().rev().find_map(|n| nodes.get(*n)?.get("extras")?.get(key))
    };
    if nearest("LoadBearing").is_some_and(is_yes) {
        return Some(Bearing::Stated);
    }
    let is_rated = |j: &Json| j.words().contains(|c: char| ('1'..='9').contains(&c));
    nearest("FireRating").is_some_and(is_rated).then_some(Bearing::Fire)
}

/// Whether a flag is set, however the program that wrote it writes flags.
fn is_yes(json: &Json) -> bool {
    match &json.value {
        Value::Bool(yes) => *yes,
        Value::Number(n) => *n == 1.0,
        Value::Text(text) => ["true", "t", ".t.", "yes", "1"].contains(&&*text.trim().to_lowercase()),
        _ => false,
    }
}
