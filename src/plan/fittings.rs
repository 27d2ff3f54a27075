//! Doors and windows as drawn: which entities sit in which opening, so that they move with its wall.

use std::collections::{BTreeMap, BTreeSet};

use super::Plan;
use super::axes::{AxisGraph, Opening};
use super::drawing::{Drawing, Editable, Shape, SourceRef};
use super::graph::Handle;
use super::structure::{end_handles, face_handles};

/// One drawn part of a door or window.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// How it can be written back.
    pub editable: Editable,
    /// As drawn, drawing units.
    pub shape: Shape,
    /// Control points of the walls' ends that it sits between: those of one jamb, those of the other;
    /// empty where a jamb is the side of a wall.
    pub jambs: [Vec<Handle>; 2],
}

/// The fittings of all openings. `marked`: the entity of every [`super::axes::Mark`].
pub fn fittings(plan: &Plan, drawing: &Drawing, axes: &AxisGraph, marked: &[usize]) -> Vec<Fitting> {
    let mut by_record: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate().filter(|(_, e)| !e.blocks.is_empty()) {
        by_record.entry(e.source.record).or_default().push(i);
    }
    // What one INSERT shows together with walls moves with them already.
    let walls: BTreeSet<usize> = plan.walls.iter().map(|w| w.source.record).collect();
    let mut out: BTreeMap<usize, Fitting> = BTreeMap::new();
    let mut whole: BTreeSet<usize> = BTreeSet::new();
    for opening in &axes.openings {
        let jambs = jambs_of(plan, axes, opening);
        if jambs.iter().all(Vec::is_empty) {
            continue;
        }
        for mark in &opening.marks {
            let entity = marked[*mark as usize];
            let record = drawing.entities[entity].source.record;
            let of_block = by_record.get(&record);
            if walls.contains(&record) || of_block.is_some() && !whole.insert(record) {
                continue;
            }
            let together = of_block.map_or_else(|| vec![entity], Clone::clone);
            for i in together {
                let e = &drawing.entities[i];
                out.entry(i).or_insert_with(|| Fitting {
                    source: e.source.clone(),
                    editable: e.editable.clone(),
                    shape: e.shape.clone(),
                    jambs: jambs.clone(),
                });
            }
        }
    }
    out.into_values().collect()
}

/// The control points of the wall ends at both jambs.
pub fn jambs_of(plan: &Plan, axes: &AxisGraph, opening: &Opening) -> [Vec<Handle>; 2] {
    opening.jambs.map(|jamb| {
        let Some(node) = jamb.node else { return Vec::new() };
        let mut out: Vec<Handle> = Vec::new();
        for edge in axes.edges.iter().filter(|e| e.nodes.contains(&node)) {
            out.extend(end_handles(plan, axes, edge, node));
        }
        let faces = &axes.nodes[node as usize].faces;
        out.extend(faces.iter().flat_map(|f| face_handles(plan, *f)));
        out.sort_unstable();
        out.dedup();
        out
    })
}
