//! What hangs on a node or in the scene: nodes leave these lists and come into them, and the other items keep their bytes.

use std::collections::{BTreeMap, BTreeSet};

use super::json::{Json, Value};
use super::scene::{File, Shown};
use crate::splice::Splice;

/// Changes of lists of nodes, by the node that has the list; `None`: the scene.
#[derive(Default)]
pub(super) struct Lists(BTreeMap<Option<usize>, Change>);

/// What leaves a list and what comes into it, indices of nodes.
#[derive(Default)]
struct Change {
    gone: BTreeSet<usize>,
    new: Vec<usize>,
}

/// The node that something hangs on.
pub(super) fn above(shown: &Shown) -> Option<usize> {
    shown.path().iter().rev().nth(1).copied()
}

impl Lists {
    /// Takes a node out.
    pub fn remove(&mut self, from: Option<usize>, node: usize) {
        self.0.entry(from).or_default().gone.insert(node);
    }

    /// Puts a node in.
    pub fn add(&mut self, to: Option<usize>, node: usize) {
        self.0.entry(to).or_default().new.push(node);
    }

    /// JSON pointer of a list.
    pub fn pointer(root: &Json, of: Option<usize>) -> String {
        match of {
            Some(node) => format!("/nodes/{node}/children"),
            None => format!("/scenes/{}/nodes", root.index("scene").unwrap_or(0)),
        }
    }

    /// Splices of the JSON text that make all changes; `None` where the scene has no such list.
    pub fn splices(&self, scene: &File<'_>) -> Option<Vec<Splice>> {
        let root = &scene.json;
        let mut out = Vec::new();
        for (of, change) in &self.0 {
            let (owner, key) = match of {
                Some(node) => (root.list("nodes").get(*node)?, "children"),
                None => (root.list("scenes").get(root.index("scene").unwrap_or(0))?, "nodes"),
            };
            let Value::Object(members) = &owner.value else { return None };
            match owner.get(key) {
                Some(list) if matches!(list.value, Value::Array(_)) => {
                    out.extend(change.splices(scene.text(), owner, list, key));
                }
                Some(_) => return None,
                None if !change.gone.is_empty() => return None,
                None => {
                    let (at, comma) = (owner.span.start + 1, if members.is_empty() { "" } else { "," });
                    out.push(Splice::new(at..at, format!("\"{key}\":[{}]{comma}", change.items())));
                }
            }
        }
        Some(out)
    }
}

impl Change {
    fn items(&self) -> String {
        self.new.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
    }

    fn splices(&self, text: &[u8], owner: &Json, list: &Json, key: &str) -> Vec<Splice> {
        let is_gone = |j: &Json| j.as_index().is_some_and(|n| self.gone.contains(&n));
        let gone: Vec<usize> = (0..list.items().len()).filter(|i| is_gone(&list.items()[*i])).collect();
        if gone.len() == list.items().len() {
            // An empty list is against the standard.
            return match self.new.is_empty() {
                true => vec![without_member(text, owner, key)],
                false => vec![Splice::new(list.span.clone(), format!("[{}]", self.items()))],
            };
        }
        let mut out = without_items(list, &gone);
        if let (false, Some(last)) = (self.new.is_empty(), list.items().last()) {
            out.push(Splice::new(last.span.end..last.span.end, format!(",{}", self.items())));
        }
        out
    }
}

/// Takes items out of a list of which some stay, each with one comma.
pub(super) fn without_items(list: &Json, gone: &[usize]) -> Vec<Splice> {
    let items = list.items();
    let first_kept = (0..items.len()).find(|i| !gone.contains(i)).unwrap_or_default();
    let one = |i: &usize| match *i < first_kept {
        true => Splice::new(items[*i].span.start..items[*i + 1].span.start, ""),
        false => Splice::new(items[*i - 1].span.end..items[*i].span.end, ""),
    };
    gone.iter().map(one).collect()
}

/// Takes a member out of an object, with its comma.
fn without_member(text: &[u8], owner: &Json, key: &str) -> Splice {
    let Value::Object(members) = &owner.value else { return Splice::new(0..0, "") };
    let at = members.iter().position(|(k, _)| k == key).unwrap_or_default();
    let end = members[at].1.span.end;
    if at > 0 {
        return Splice::new(members[at - 1].1.span.end..end, "");
    }
    // The first one: with the comma behind it, where another follows.
    let from = owner.span.start + 1;
    let comma = text[end..owner.span.end].iter().position(|b| *b == b',').filter(|_| members.len() > 1);
    Splice::new(from..comma.map_or(end, |c| end + c + 1), "")
}

/// Says of a node that it was demolished, and where it hung.
pub(super) fn demolished(node: &Json, from: &str) -> Vec<Splice> {
    let note = format!("\"note\":\"hung in {from}\"");
    let said = format!("\"status\":\"demolish\",{note}");
    let first = |owner: &Json, member: String| {
        let is_empty = matches!(&owner.value, Value::Object(m) if m.is_empty());
        let at = owner.span.start + 1;
        vec![Splice::new(at..at, format!("{member}{}", if is_empty { "" } else { "," }))]
    };
    let Some(extras) = node.get("extras") else {
        return first(node, format!("\"extras\":{{\"enfilade\":{{{said}}}}}"));
    };
    if !matches!(extras.value, Value::Object(_)) {
        return vec![Splice::new(extras.span.clone(), format!("{{\"enfilade\":{{{said}}}}}"))];
    }
    let Some(told) = extras.get("enfilade") else {
        return first(extras, format!("\"enfilade\":{{{said}}}"));
    };
    match (&told.value, told.get("status")) {
        (Value::Object(_), Some(status)) => vec![Splice::new(status.span.clone(), "\"demolish\"")],
        (Value::Object(_), None) if told.get("note").is_some() => {
            first(told, "\"status\":\"demolish\"".into())
        }
        (Value::Object(_), None) => first(told, said),
        _ => vec![Splice::new(told.span.clone(), format!("{{{said}}}"))],
    }
}
