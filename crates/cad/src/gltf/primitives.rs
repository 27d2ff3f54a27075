//! Values of meshes that the standard does not allow and that are read all the same, each told at the first node that shows
//! the mesh.

use std::collections::BTreeMap;

use glam::DVec3;

use super::component::{FAN, TRIANGLES, WHOLE};
use super::json::{Json, Value};
use super::scene::{File, Shown};

/// How far stated bounds may be from the data by rounding, a share of the largest coordinate.
const BOUND_SLACK: f64 = 1e-5;

/// Where, what, and whether nothing stands elsewhere for it.
type Told = (String, String, bool);

/// What is odd of the meshes that are shown.
pub(super) fn odd(scene: &File<'_>, shown: &[Shown]) -> Vec<Told> {
    let nodes = scene.json.list("nodes");
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    for s in shown {
        if let Some(mesh) = nodes[s.node].index("mesh") {
            first.entry(mesh).or_insert(s.node);
        }
    }
    let mut out = Vec::new();
    for (mesh, node) in first {
        let primitives =
            scene.json.list("meshes").get(mesh).map(|m| m.list("primitives")).unwrap_or_default();
        for (i, primitive) in primitives.iter().enumerate() {
            let texts = of_primitive(scene, &format!("/meshes/{mesh}/primitives/{i}"), primitive);
            out.extend(texts.into_iter().map(|(text, is_harmless)| (scene.named(node), text, is_harmless)));
        }
    }
    out
}

fn of_primitive(scene: &File<'_>, pointer: &str, primitive: &Json) -> Vec<(String, bool)> {
    let accessor = |index: Option<usize>| Some((index?, scene.json.list("accessors").get(index?)?));
    let position = accessor(primitive.get("attributes").and_then(|a| a.index("POSITION")));
    let indices = accessor(primitive.index("indices"));
    let mut out = Vec::new();
    let is_indexed = primitive.get("indices").is_some();
    let corners = if is_indexed { indices } else { position }.and_then(|(_, a)| a.index("count"));
    let what = if is_indexed { "indices" } else { "vertices" };
    let mode = primitive.index("mode").unwrap_or(TRIANGLES);
    match corners {
        Some(n) if mode == TRIANGLES && n % 3 != 0 => {
            let left = if n % 3 == 1 { "the last one is" } else { "the last two are" };
            let text = format!("{pointer}: found {n} {what}, expected a multiple of 3; {left} left out");
            out.push((text, false));
        }
        Some(n) if (TRIANGLES + 1..=FAN).contains(&mode) && n < 3 => {
            let text = format!("{pointer}: found {n} {what}, expected 3 at least; it shows nothing");
            out.push((text, false));
        }
        _ => {}
    }
    if let Some((i, a)) = position.filter(|(_, a)| is_normalised(a)) {
        let kind = a.index("componentType").unwrap_or(0);
        if !WHOLE.contains(&kind) {
            let text = format!(
                "/accessors/{i}: found `normalized` on component type {kind}, expected it on whole numbers of one or two bytes; \
                 read as plain numbers"
            );
            out.push((text, true));
        }
    }
    if let Some((i, _)) = indices.filter(|(_, a)| is_normalised(a)) {
        let text =
            format!("/accessors/{i}: found `normalized` on indices, expected plain numbers; read as such");
        out.push((text, true));
    }
    out.extend(position.and_then(|(i, a)| bounds(scene, i, a)).map(|text| (text, false)));
    out
}

fn is_normalised(accessor: &Json) -> bool {
    accessor.get("normalized").is_some_and(|n| n.value == Value::Bool(true))
}

/// What is said of stated bounds that are not those of the data.
fn bounds(scene: &File<'_>, index: usize, accessor: &Json) -> Option<String> {
    let stated = ["min", "max"].map(|key| accessor.numbers(key).filter(|v| v.len() == 3));
    if is_normalised(accessor) || stated == [None, None] {
        return None;
    }
    let points = scene.points(index).ok().filter(|p| !p.is_empty())?;
    let lo = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let hi = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let slack = BOUND_SLACK * lo.abs().max(hi.abs()).max_element();
    let of = |stated: &Option<Vec<f64>>, own: DVec3, key: &str| {
        let stated = DVec3::from_slice(stated.as_ref()?);
        let is_wrong = (stated - own).abs().max_element() > slack;
        let words = |v: DVec3| format!("{:?}", v.as_vec3().to_array());
        is_wrong.then(|| format!("{key} {}, expected {}", words(stated), words(own)))
    };
    let wrong: Vec<String> =
        [of(&stated[0], lo, "min"), of(&stated[1], hi, "max")].into_iter().flatten().collect();
    let list = wrong.join(" and ");
    (!wrong.is_empty()).then(|| format!("/accessors/{index}: found {list}; the data counts"))
}
