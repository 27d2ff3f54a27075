//! Values that the standard does not allow and that are read all the same: which, and as what.

use std::collections::BTreeSet;

use super::instances;
use super::json::{Json, Value};
use super::scene::{File, Shown, visible};
use enfilade_report::{Place, Report};

/// Most of them that are told one by one.
pub(super) const TOLD: usize = 20;

/// Extensions that change nothing of where a mesh stands, or that are read: whole names, and how they begin.
const HARMLESS: [&str; 6] = [
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_xmp_json_ld",
    "KHR_xmp",
    "KHR_node_visibility",
    instances::EXTENSION,
];
const HARMLESS_STARTS: [&str; 5] =
    ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "MSFT_texture_"];

/// Squared length of a rotation that is one of length one, within rounding.
const UNIT_SLACK: f64 = 1e-3;

/// Says which values were read as something else.
pub(super) fn state(scene: &File<'_>, shown: &[Shown], report: &mut Report) {
    let mut odd = Odd { scene, told: Vec::new() };
    odd.root();
    let nodes: BTreeSet<usize> = shown.iter().map(|s| s.node).collect();
    nodes.into_iter().for_each(|n| odd.node(n));
    odd.views();
    odd.twice(shown);
    odd.told.extend(super::primitives::odd(scene, shown));
    let more = odd.told.len().saturating_sub(TOLD);
    for (place, text, is_harmless) in odd.told.into_iter().take(TOLD) {
        let place = Place::file(scene.name).entity(place);
        if is_harmless {
            report.info("gltf-value", place, text);
        } else {
            report.warn("gltf-value", place, text);
        }
    }
    if more > 0 {
        let text = format!("{more} more values are not what the standard allows");
        report.warn("gltf-value", Place::file(scene.name), text);
    }
}

/// What was found: the place, the words, and whether nothing stands elsewhere for it.
struct Odd<'s, 'a> {
    scene: &'s File<'a>,
    told: Vec<(String, String, bool)>,
}

impl Odd<'_, '_> {
    fn say(&mut self, place: String, value: &Json, expected: &str, done: &str, is_harmless: bool) {
        self.told.push((place, format!("found {}, expected {expected}; {done}", value.words()), is_harmless));
    }

    fn root(&mut self) {
        let json = &self.scene.json;
        if let Some(version) = json.get("asset").and_then(|a| a.get("minVersion"))
            && !matches!(&version.value, Value::Text(v) if v.starts_with("2.0"))
        {
            let place = "/asset/minVersion".to_string();
            self.say(place, version, "2.0 at most", "read as glTF 2.0, what is newer is not seen", false);
        }
        if let Some(scene) = json.get("scene") {
            let found = scene.as_index().filter(|i| *i < json.list("scenes").len());
            if found.is_none() {
                let done = match json.list("scenes").first().filter(|_| scene.as_index().is_none()) {
                    Some(_) => "the first scene is shown",
                    None => "every node that hangs in no other is shown",
                };
                self.say("/scene".into(), scene, "a scene of the file", done, false);
            }
        }
        let shown = json.index("scene").unwrap_or(0);
        if let Some(nodes) = json.list("scenes").get(shown).and_then(|s| s.get("nodes")) {
            self.indices(&format!("/scenes/{shown}/nodes"), "", nodes);
        }
        for (i, buffer) in json.list("buffers").iter().enumerate() {
            let Some(length) = buffer.get("byteLength") else { continue };
            let needed = needed(json, i);
            let expected = match length.as_index() {
                None => "a number of bytes".to_string(),
                Some(stated) if stated < needed => format!("at least the {needed} bytes that its views take"),
                Some(_) => continue,
            };
            let place = format!("/buffers/{i}/byteLength");
            self.say(place, length, &expected, "all the data there is counts", true);
        }
        for (i, required) in json.list("extensionsRequired").iter().enumerate() {
            let is_known =
                |name: &str| HARMLESS.contains(&name) || HARMLESS_STARTS.iter().any(|s| name.starts_with(s));
            if !matches!(&required.value, Value::Text(name) if is_known(name)) {
                let place = format!("/extensionsRequired/{i}");
                let done = "read without it: what it says is not seen";
                self.say(place, required, "an extension that is known here", done, false);
            }
        }
    }

    /// A list of nodes, under the node of that name.
    fn indices(&mut self, pointer: &str, name: &str, list: &Json) {
        if !matches!(list.value, Value::Array(_)) {
            self.say(named(pointer, name), list, "a list of nodes", "nothing hangs there", false);
        }
        for (i, item) in list.items().iter().enumerate().filter(|(_, item)| item.as_index().is_none()) {
            let place = named(&format!("{pointer}/{i}"), name);
            self.say(place, item, "the number of a node", "left out", false);
        }
    }

    fn node(&mut self, n: usize) {
        let node = &self.scene.json.list("nodes")[n];
        if !matches!(node.value, Value::Object(_)) {
            self.say(format!("/nodes/{n}"), node, "a node", "it shows nothing", false);
            return;
        }
        let name = node.text("name").unwrap_or_default();
        let place = |key: &str| named(&format!("/nodes/{n}/{key}"), name);
        if let Some(found) = node.get("name").filter(|v| !matches!(v.value, Value::Text(_))) {
            self.say(place("name"), found, "a text", "the node has no name", true);
        }
        if let Some(found) = node.get("mesh").filter(|v| v.as_index().is_none()) {
            self.say(place("mesh"), found, "the number of a mesh", "the node shows nothing", false);
        }
        if let Some(list) = node.get("children") {
            self.indices(&format!("/nodes/{n}/children"), name, list);
        }
        if let Some(found) = visible(node).filter(|v| !matches!(v.value, Value::Bool(_))) {
            let place = place("extensions/KHR_node_visibility/visible");
            self.say(place, found, "true or false", "the node is shown", false);
        }
        let is_read = node.numbers("matrix").is_some_and(|m| m.len() == 16);
        if let Some(found) = node.get("matrix").filter(|_| !is_read) {
            self.say(place("matrix"), found, "16 numbers", "read as if it were not there", false);
        }
        if let Some(row) = odd_row(node) {
            let text = format!(
                "found a last row of {}, {}, {}, {}, expected 0, 0, 0, 1; read as if it were so, it stays where it is",
                row[0], row[1], row[2], row[3]
            );
            self.told.push((place("matrix"), text, false));
        }
        for (key, count) in [("translation", 3), ("rotation", 4), ("scale", 3)] {
            let Some(found) = node.get(key) else { continue };
            let place = place(key);
            let numbers = node.numbers(key).filter(|v| v.len() == count);
            let squared = numbers.as_ref().map(|v| v.iter().map(|x| x * x).sum::<f64>());
            let is_turn = key == "rotation";
            match squared {
                _ if is_read => self.say(place, found, "nothing beside a matrix", "the matrix counts", true),
                None => {
                    let expected = format!("{count} numbers");
                    self.say(place, found, &expected, "read as if it were not there", false);
                }
                Some(0.0) if is_turn => {
                    self.say(place, found, "a rotation of length one", "read as no rotation", false);
                }
                Some(s) if is_turn && (s - 1.0).abs() > UNIT_SLACK => {
                    self.say(
                        place,
                        found,
                        "a rotation of length one",
                        "read as the same turn of length one",
                        true,
                    );
                }
                Some(_) => {}
            }
        }
    }

    /// Nodes that hang in several others, told once.
    fn twice(&mut self, shown: &[Shown]) {
        let again: BTreeSet<usize> =
            shown.windows(2).filter(|s| s[0].node == s[1].node).map(|s| s[0].node).collect();
        if let Some(first) = again.first() {
            let more = again.len() - 1;
            let text = match more {
                0 => "hangs in several nodes, expected one; shown at every place, it does not move".into(),
                _ => format!(
                    "hangs in several nodes, expected one, and so do {more} more; shown at every place, none of them moves"
                ),
            };
            self.told.push((self.scene.named(*first), text, false));
        }
    }

    fn views(&mut self) {
        for (i, view) in self.scene.json.list("bufferViews").iter().enumerate() {
            if let Some(stride) = view.get("byteStride").filter(|s| s.as_index() == Some(0)) {
                let place = format!("/bufferViews/{i}/byteStride");
                self.say(place, stride, "4 to 252", "its values are read one after the other", true);
            }
        }
    }
}

/// How many bytes of a buffer its views take.
fn needed(json: &Json, buffer: usize) -> usize {
    let of = |view: &Json| {
        let start = view.index("byteOffset").unwrap_or(0);
        start.saturating_add(view.index("byteLength").unwrap_or(0))
    };
    let views = json.list("bufferViews").iter().filter(|v| v.index("buffer") == Some(buffer));
    views.map(of).max().unwrap_or(0)
}

/// The last row of a node's matrix, where it is not that of a turn, a scale and a shift.
pub(super) fn odd_row(node: &Json) -> Option<[f64; 4]> {
    let m = node.numbers("matrix").filter(|m| m.len() == 16)?;
    let row = [m[3], m[7], m[11], m[15]];
    let is_odd = row.iter().zip([0.0, 0.0, 0.0, 1.0]).any(|(v, meant)| (v - meant).abs() > ROW_SLACK);
    is_odd.then_some(row)
}

/// How far the last row of a matrix may be from 0, 0, 0, 1 by rounding.
const ROW_SLACK: f64 = 1e-6;

/// A pointer and the name of what it points into.
fn named(pointer: &str, name: &str) -> String {
    format!("{pointer} {name}").trim_end().to_string()
}
