//! The architectural graph of what a drawing is taken for.

use crate::understand::sensed::{OpenGap, Sensed};
use crate::understand::understood::Understood;
use crate::write::places::{Places, round_mm};
use crate::write::reading::{axis, opening_kind};
use enfilade_overlay::graph::{GRAPH_SCHEMA, Joint, OpeningEdge, PlanGraph, RoomNode, WallEdge};
use enfilade_plan::axes::{Edge, Node, NodeKind};
use enfilade_plan::floor::{Area, Beside};

/// Joints, walls, openings and rooms.
pub(crate) fn graph(base: &Understood, sensed: &Sensed, names: &[Option<String>]) -> PlanGraph {
    let at = Places::new(&base.plan);
    let joint = |n: &Node| Joint { at: at.person(n.at), kind: joint_kind(&n.kind).into() };
    let wall = |e: &Edge| WallEdge {
        nodes: e.nodes.map(|n| n as usize),
        axis: axis(base, e).into_iter().map(|p| at.person(p)).collect(),
        thickness_m: round_mm(e.thickness_m * base.plan.human_scale),
    };
    let room = |(k, a): (usize, &Area)| RoomNode {
        name: names.get(k).cloned().flatten().unwrap_or_default(),
        area_m2: Some((a.area_m2 * 100.0).round() / 100.0),
        at: Some(at.um(a.at)),
    };
    let side = |b: Beside| match b {
        Beside::Room(room) => Some(room + 1),
        Beside::Outside => Some(0),
        Beside::Nothing => None,
    };
    let beside = |k: usize| {
        let known = sensed.floor.as_ref().and_then(|f| f.beside.get(k));
        known.map_or([None; 2], |b| b.map(side))
    };
    let opening = |(k, g): (usize, &OpenGap)| OpeningEdge {
        kind: opening_kind(g.kind).into(),
        at: at.um(g.middle()),
        width_m: round_mm(g.width_m),
        wall: g.edge.map(|e| e as usize),
        rooms: beside(k),
    };
    let outside = RoomNode { name: "outside".into(), area_m2: None, at: None };
    let rooms = sensed.floor.iter().flat_map(|f| &f.rooms).enumerate();
    PlanGraph {
        schema: GRAPH_SCHEMA.into(),
        file: base.plan.file.clone(),
        metres_per_unit: base.plan.unit.unit.metres,
        nodes: base.axes.nodes.iter().map(joint).collect(),
        walls: base.axes.edges.iter().map(wall).collect(),
        openings: sensed.gaps.iter().enumerate().map(opening).collect(),
        rooms: std::iter::once(outside).chain(rooms.map(room)).collect(),
    }
}

fn joint_kind(kind: &NodeKind) -> &'static str {
    match kind {
        NodeKind::End => "end",
        NodeKind::Corner => "corner",
        NodeKind::Tee => "tee",
        NodeKind::Cross => "cross",
        NodeKind::Star => "star",
        NodeKind::Column(_) => "column",
    }
}
