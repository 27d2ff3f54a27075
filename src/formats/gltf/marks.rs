//! What nodes say of themselves in `extras.enfilade`, and for all that hangs on them.

use super::json::{Json, Value};
use super::scene::{File, Shown};
use super::values::TOLD;
use crate::plan::layers;
use crate::report::{Place, Report};

/// What may be said there, and as what.
const KEYS: [(&str, &str); 5] = [
    ("move", "a text such as \"x -1 1\""),
    ("name", "a text"),
    ("keep", "true or false"),
    ("query", "true, false or the name of a pair"),
    ("reference", "true, false or the name of a pair"),
];

/// Members of what we write on nodes of ours.
const OWN_KEYS: [&str; 2] = ["layer", "note"];

/// What a node itself says.
fn told<'j>(scene: &'j File<'_>, node: usize) -> Option<&'j Json> {
    scene.json.list("nodes").get(node)?.get("extras")?.get("enfilade")
}

/// One thing that a node says: the nearest word on the way from the node to the root counts.
fn nearest<'j>(scene: &'j File<'_>, path: &[usize], key: &str) -> Option<&'j Json> {
    path.iter().rev().find_map(|n| told(scene, *n)?.get(key))
}

/// Whether a node, or what it hangs on, says yes.
pub(super) fn is_set(scene: &File<'_>, path: &[usize], key: &str) -> bool {
    nearest(scene, path, key).is_some_and(|v| v.value == Value::Bool(true))
}

/// The text that a node, or what it hangs on, says.
pub(super) fn text<'j>(scene: &'j File<'_>, path: &[usize], key: &str) -> Option<&'j str> {
    let Value::Text(text) = &nearest(scene, path, key)?.value else { return None };
    Some(text.trim()).filter(|t| !t.is_empty())
}

/// How a node itself says that it moves. A text in place of the object is the move: programs whose properties are
/// flat can say it so. Something else than a text is told as it stands, so that it is named and not made up for.
pub(super) fn own_move(scene: &File<'_>, node: usize) -> Option<String> {
    let told = told(scene, node)?;
    let said = match &told.value {
        Value::Text(text) => text.clone(),
        _ => match &told.get("move")?.value {
            Value::Text(text) => text.clone(),
            _ => told.get("move")?.words(),
        },
    };
    Some(said).filter(|t| !t.trim().is_empty())
}

/// The name that a node gives its move.
pub(super) fn own_name<'j>(scene: &'j File<'_>, node: usize) -> Option<&'j str> {
    told(scene, node)?.text("name").filter(|t| !t.trim().is_empty())
}

/// The first node on the way from the root that says how it moves: all that hangs on it moves with it.
pub(super) fn mover(scene: &File<'_>, path: &[usize]) -> Option<usize> {
    path.iter().copied().find(|n| own_move(scene, *n).is_some())
}

/// Says which marks cannot be read, and which are not used; `moved`: nodes whose moves are.
pub(super) fn state(scene: &File<'_>, shown: &[Shown], moved: &[usize], report: &mut Report) {
    let mut odd: Vec<(usize, String)> = Vec::new();
    let mut elsewhere: Vec<usize> = Vec::new();
    for s in shown.iter().filter(|s| !s.names(scene).any(layers::is_own)) {
        let Some(found) = told(scene, s.node) else { continue };
        match &found.value {
            Value::Object(members) => members.iter().for_each(|(key, value)| {
                odd.extend(unread(key, value).map(|text| (s.node, text)));
            }),
            Value::Text(_) => {}
            _ => odd.push((
                s.node,
                format!(
                    "extras.enfilade: found {}, expected an object such as {{\"move\": \"x -1 1\"}}; nothing is marked by it",
                    found.words()
                ),
            )),
        }
        if own_move(scene, s.node).is_none() || moved.contains(&s.node) {
            continue;
        }
        match mover(scene, &s.path).filter(|m| *m != s.node) {
            Some(other) => odd.push((
                s.node,
                format!(
                    "the move that extras.enfilade states is not used: it hangs on {}, which moves by a mark of its own",
                    scene.named(other)
                ),
            )),
            None => elsewhere.push(s.node),
        }
    }
    state_elsewhere(scene, &elsewhere, moved.is_empty(), report);
    let more = odd.len().saturating_sub(TOLD);
    for (node, text) in odd.into_iter().take(TOLD) {
        report.warn("gltf-marks", Place::file(scene.name).entity(scene.named(node)), text);
    }
    if more > 0 {
        let text = format!("{more} more marks in extras.enfilade cannot be used");
        report.warn("gltf-marks", Place::file(scene.name), text);
    }
}

/// Names the nodes whose moves are not used because nothing of them stands at the cut: those of another storey, or all.
fn state_elsewhere(scene: &File<'_>, nodes: &[usize], are_all: bool, report: &mut Report) {
    if nodes.is_empty() {
        return;
    }
    let named: Vec<String> = nodes.iter().take(TOLD).map(|n| scene.named(*n)).collect();
    let more = if nodes.len() > named.len() { ", …" } else { "" };
    let text = format!(
        "the moves that extras.enfilade states of {}{more} are not used: nothing of them stands as a wall at the height of the cut",
        named.join(", ")
    );
    let place = Place::file(scene.name);
    if are_all { report.warn("gltf-marks", place, text) } else { report.info("gltf-marks", place, text) }
}

/// Why one member cannot be read.
fn unread(key: &str, value: &Json) -> Option<String> {
    let known = KEYS.iter().find(|(k, _)| *k == key);
    let Some((_, expected)) = known else {
        let names: Vec<&str> = KEYS.iter().map(|(k, _)| *k).collect();
        let is_ours = OWN_KEYS.contains(&key);
        return (!is_ours).then(|| {
            format!("extras.enfilade says {key:?}, expected one of {}; it is not used", names.join(", "))
        });
    };
    let is_read = match (&value.value, key) {
        (Value::Text(_), "move" | "name" | "query" | "reference") => true,
        (Value::Bool(_), "keep" | "query" | "reference") => true,
        // A move that is no text is told where moves are read.
        (_, "move") => true,
        _ => false,
    };
    (!is_read).then(|| {
        format!("extras.enfilade.{key}: found {}, expected {expected}; it is not used", value.words())
    })
}
