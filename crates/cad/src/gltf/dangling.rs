//! References to what a scene does not have. Damaged scenes have some; what we add must not take their place.

use super::json::{Json, Value};

/// Lists of the root, and the members whose number is an index into them.
const NAMED: [(&str, &[&str]); 6] = [
    ("buffers", &["buffer"]),
    ("accessors", &["indices", "input", "output", "inverseBindMatrices"]),
    ("bufferViews", &["bufferView"]),
    ("materials", &["material"]),
    ("meshes", &["mesh"]),
    ("nodes", &["node", "skeleton"]),
];
/// Members whose items are nodes.
const NODES: [&str; 3] = ["children", "joints", "nodes"];

/// The first reference to an item that `list` lacks now and has once `count` more are put behind it: its index.
pub(super) fn taken(root: &Json, list: &'static str, count: usize) -> Option<usize> {
    let first = root.list(list).len();
    let mut found = None;
    let mut see = |name: &'static str, index: f64| {
        let is_taken = index >= first as f64 && index < (first + count) as f64;
        if name == list && is_taken {
            found.get_or_insert(index as usize);
        }
    };
    walk(root, "", &mut see);
    found
}

/// Whether a view reaches beyond so many bytes of the first buffer: a longer one would have what it lacks now.
pub(super) fn reaches_beyond(root: &Json, bytes: usize) -> bool {
    root.list("bufferViews").iter().any(|view| {
        let at = |key: &str| view.get(key).and_then(Json::number).unwrap_or(0.0);
        at("buffer") == 0.0 && at("byteOffset") + at("byteLength") > bytes as f64
    })
}

/// Tells every reference below a value that stands under `key`: the list of the root, and the index.
fn walk(json: &Json, key: &str, see: &mut dyn FnMut(&'static str, f64)) {
    match &json.value {
        Value::Number(n) => {
            if let Some((list, _)) = NAMED.iter().find(|(_, keys)| keys.contains(&key)) {
                see(list, *n);
            }
        }
        Value::Array(items) if NODES.contains(&key) => {
            items.iter().filter_map(Json::number).for_each(|n| see("nodes", n));
            items.iter().filter(|i| i.number().is_none()).for_each(|i| walk(i, "", see));
        }
        Value::Array(items) if key == "targets" => items.iter().for_each(|i| walk(i, "attributes", see)),
        Value::Array(items) => items.iter().for_each(|i| walk(i, "", see)),
        Value::Object(members) if key == "attributes" => {
            members.iter().filter_map(|(_, v)| v.number()).for_each(|n| see("accessors", n));
        }
        Value::Object(members) => members.iter().for_each(|(key, value)| walk(value, key, see)),
        Value::Null | Value::Bool(_) | Value::Text(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::super::json::parse;
    use super::*;

    #[test]
    fn a_view_beyond_its_buffer_is_found() {
        let beyond = |text: &str| reaches_beyond(&parse(text.as_bytes()).unwrap(), 100);
        assert!(beyond(r#"{"bufferViews":[{"buffer":0,"byteOffset":5,"byteLength":96}]}"#));
        assert!(beyond(r#"{"bufferViews":[{"byteLength":101}]}"#));
        assert!(!beyond(r#"{"bufferViews":[{"buffer":0,"byteOffset":4,"byteLength":96}]}"#));
        assert!(!beyond(r#"{"bufferViews":[{"buffer":1,"byteLength":101}]}"#));
    }

    #[test]
    fn what_would_be_taken_is_found_wherever_it_is_named() {
        let of = |text: &str, list| taken(&parse(text.as_bytes()).unwrap(), list, 2);
        for (text, list) in [
            (r#"{"accessors":[{"sparse":{"indices":{"bufferView":1}}}]}"#, "bufferViews"),
            (r#"{"meshes":[{"primitives":[{"attributes":{"POSITION":1}}]}]}"#, "accessors"),
            (r#"{"meshes":[{"primitives":[{"targets":[{"NORMAL":1}]}]}]}"#, "accessors"),
            (r#"{"meshes":[{"primitives":[{"indices":1,"attributes":{}}]}]}"#, "accessors"),
            (r#"{"nodes":[{"mesh":1}]}"#, "meshes"),
            (r#"{"nodes":[{}],"scenes":[{"nodes":[0,1]}]}"#, "nodes"),
            (r#"{"nodes":[{"children":[1]}]}"#, "nodes"),
            (r#"{"meshes":[{"primitives":[{"material":1}]}]}"#, "materials"),
        ] {
            assert_eq!(of(text, list), Some(1), "{text}");
            assert_eq!(of(&text.replace('1', "9"), list), None, "beyond ours: {text}");
        }
        assert_eq!(of(r#"{"bufferViews":[{},{}],"images":[{"bufferView":1}]}"#, "bufferViews"), None);
    }
}
