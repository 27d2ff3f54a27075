//! The architectural graph: joints and walls, and which openings lead from which room into which. As JSON and as GraphML.
//!
//! Points are in drawing units, lengths and areas in metres and square metres.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

/// `schema` of a [`PlanGraph`].
pub const GRAPH_SCHEMA: &str = "enfilade.graph/1";

/// A plan as a graph.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanGraph {
    /// [`GRAPH_SCHEMA`].
    pub schema: String,
    /// Name of the file.
    pub file: String,
    /// Metres in one drawing unit.
    pub metres_per_unit: f64,
    /// Where walls end and meet.
    pub nodes: Vec<Joint>,
    /// Walls between them.
    pub walls: Vec<WallEdge>,
    /// Doors, windows, passages.
    pub openings: Vec<OpeningEdge>,
    /// Rooms; the first is the outside.
    pub rooms: Vec<RoomNode>,
}

/// Where walls end or meet, or a column.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Position.
    pub at: [f64; 2],
    /// `end`, `corner`, `tee`, `cross`, `star` or `column`.
    pub kind: String,
}

/// A wall.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallEdge {
    /// Indices into `nodes`.
    pub nodes: [usize; 2],
    /// Its axis; a curved one as chords.
    pub axis: Vec<[f64; 2]>,
    /// Distance of its faces; 0 for a single line.
    pub thickness_m: f64,
}

/// An opening.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OpeningEdge {
    /// `door`, `window` or `passage`.
    pub kind: String,
    /// Its middle.
    pub at: [f64; 2],
    /// Clear width.
    pub width_m: f64,
    /// Index into `walls`.
    pub wall: Option<usize>,
    /// Indices into `rooms` of what lies on its two sides; `null` where no room does.
    pub rooms: [Option<usize>; 2],
}

/// A room, or the outside.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoomNode {
    /// What it is called; `outside` of the first.
    pub name: String,
    /// Its floor; `null` for the outside.
    pub area_m2: Option<f64>,
    /// A point well inside; `null` for the outside.
    pub at: Option<[f64; 2]>,
}

/// Keys of GraphML: name, what has it, type.
const KEYS: [(&str, &str, &str); 8] = [
    ("kind", "all", "string"),
    ("name", "node", "string"),
    ("x", "node", "double"),
    ("y", "node", "double"),
    ("area_m2", "node", "double"),
    ("width_m", "node", "double"),
    ("wall", "node", "string"),
    ("thickness_m", "edge", "double"),
];

impl PlanGraph {
    /// The same as GraphML: joints, rooms and openings are nodes, walls join joints, `leads` an opening with a room.
    pub fn to_graphml(&self) -> String {
        let mut out = String::from(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
        );
        for (name, of, kind) in KEYS {
            let _ = writeln!(
                out,
                "  <key id=\"{name}\" for=\"{of}\" attr.name=\"{name}\" attr.type=\"{kind}\"/>"
            );
        }
        let _ = writeln!(out, "  <graph id=\"{}\" edgedefault=\"undirected\">", escaped(&self.file));
        for (i, n) in self.nodes.iter().enumerate() {
            node(
                &mut out,
                &format!("n{i}"),
                &[("kind", n.kind.clone()), ("x", n.at[0].to_string()), ("y", n.at[1].to_string())],
            );
        }
        for (i, r) in self.rooms.iter().enumerate() {
            let mut data = vec![("kind", "room".to_owned()), ("name", r.name.clone())];
            data.extend(r.area_m2.map(|a| ("area_m2", a.to_string())));
            data.extend(r.at.iter().flat_map(|p| [("x", p[0].to_string()), ("y", p[1].to_string())]));
            node(&mut out, &format!("r{i}"), &data);
        }
        for (i, o) in self.openings.iter().enumerate() {
            let mut data =
                vec![("kind", o.kind.clone()), ("x", o.at[0].to_string()), ("y", o.at[1].to_string())];
            data.push(("width_m", o.width_m.to_string()));
            data.extend(o.wall.map(|w| ("wall", format!("w{w}"))));
            node(&mut out, &format!("o{i}"), &data);
        }
        for (i, w) in self.walls.iter().enumerate() {
            let ends = w.nodes.map(|n| format!("n{n}"));
            edge(
                &mut out,
                &format!("w{i}"),
                &ends,
                &[("kind", "wall".into()), ("thickness_m", w.thickness_m.to_string())],
            );
        }
        for (i, o) in self.openings.iter().enumerate() {
            for (side, room) in o.rooms.iter().enumerate().filter_map(|(side, r)| Some((side, (*r)?))) {
                let ends = [format!("o{i}"), format!("r{room}")];
                edge(&mut out, &format!("o{i}-{side}"), &ends, &[("kind", "leads".into())]);
            }
        }
        out.push_str("  </graph>\n</graphml>\n");
        out
    }
}

fn node(out: &mut String, id: &str, data: &[(&str, String)]) {
    let _ = writeln!(out, "    <node id=\"{id}\">{}</node>", data_of(data));
}

fn edge(out: &mut String, id: &str, [from, to]: &[String; 2], data: &[(&str, String)]) {
    let _ = writeln!(out, "    <edge id=\"{id}\" source=\"{from}\" target=\"{to}\">{}</edge>", data_of(data));
}

fn data_of(data: &[(&str, String)]) -> String {
    data.iter().map(|(key, value)| format!("<data key=\"{key}\">{}</data>", escaped(value))).collect()
}

/// Text as XML takes it: what XML cannot hold at all is left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c < ' ' && !"\t\n\r".contains(c) => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_escaped_and_ends_exist() {
        let graph = PlanGraph {
            nodes: vec![Joint { at: [0.5, -1.0], kind: "end".into() }; 2],
            walls: vec![WallEdge { nodes: [0, 1], axis: Vec::new(), thickness_m: 0.1 }],
            openings: vec![OpeningEdge {
                kind: "door".into(),
                rooms: [Some(0), None],
                ..OpeningEdge::default()
            }],
            rooms: vec![RoomNode { name: "a<b & \"c\"\u{1}".into(), ..RoomNode::default() }],
            ..PlanGraph::default()
        };
        let text = graph.to_graphml();
        assert!(text.contains("<data key=\"name\">a&lt;b &amp; &quot;c&quot;</data>"), "{text}");
        assert!(text.contains("<edge id=\"w0\" source=\"n0\" target=\"n1\">"), "{text}");
        assert_eq!(text.matches("source=\"o0\"").count(), 1);
    }
}
