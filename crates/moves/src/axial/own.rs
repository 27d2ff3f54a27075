//! What moves with a chain, and whether all of that can be written.

use std::collections::BTreeSet;

use super::chain::{BESIDE_M, Chain, Own};
use super::{Axial, PARALLEL_SIN, REST_M};
use enfilade_cad::drawing::{Editable, Format, Shape};
use enfilade_plan::fittings::jambs_of;
use enfilade_plan::graph::Handle;
use enfilade_plan::structure::{end_handles, face_handles, handle_at};

impl<'a> Axial<'a> {
    /// Adds the wall ends beyond the doors and windows that end at a chain's side: they follow it, or the door would be
    /// torn off. How far these walls let it slide, metres of a person; `None` where one cannot follow.
    pub(super) fn take_doors_beside(
        &self,
        chain: &Chain,
        handles: &mut BTreeSet<Handle>,
    ) -> Option<[f64; 2]> {
        let mut way = [f64::MIN, f64::MAX];
        for (_, opening) in self.jamb_sides.iter().filter(|(e, _)| chain.edges.contains(e)) {
            let opening = &self.axes.openings[*opening as usize];
            let end = opening.jambs.iter().find(|j| j.node.is_some())?;
            let out = (end.at - opening.centre).try_normalize()?;
            let wall = self.wall_at(end.node?, out).filter(|_| out.dot(chain.along).abs() < PARALLEL_SIN)?;
            handles.extend(jambs_of(self.plan, self.axes, opening).concat());
            handles.extend(opening.faces.iter().flat_map(|f| face_handles(self.plan, *f)));
            let behind = (self.length(wall) - REST_M - self.joint_half(wall)).max(0.0);
            if out.dot(chain.along.perp()) > 0.0 {
                way[1] = way[1].min(behind);
            } else {
                way[0] = way[0].max(-behind);
            }
        }
        Some(way)
    }

    /// What moves with a chain. `None` where one of its faces runs on beyond it.
    pub(super) fn corners(&self, chain: &Chain) -> Option<Own> {
        let (plan, axes) = (self.plan, self.axes);
        let reach = chain.thickness / 2.0 + BESIDE_M;
        let is_own = |h: &Handle| {
            let p = chain.local(handle_at(plan, *h));
            p.y.abs() <= reach && p.x >= chain.from - reach - BESIDE_M && p.x <= chain.to + reach + BESIDE_M
        };
        let mut out = Own { handles: BTreeSet::new(), records: BTreeSet::new() };
        for e in chain.edges.iter().map(|e| &axes.edges[*e as usize]) {
            for f in e.left.iter().chain(&e.right).chain(&e.inner) {
                let wall = &plan.walls[f.0 as usize];
                out.records.extend(wall.editable.moves_whole().then_some(wall.source.record));
                for h in face_handles(plan, *f) {
                    if !is_own(&h) {
                        return None;
                    }
                    out.handles.insert(h);
                }
            }
            for n in e.nodes {
                let caps = axes.nodes[n as usize].faces.iter().flat_map(|f| face_handles(plan, *f));
                out.handles.extend(caps.filter(is_own));
                let joined = self.around(n).filter(|(i, _)| !chain.edges.contains(i));
                let ends = joined.flat_map(|(_, f)| end_handles(plan, axes, f, n));
                out.handles.extend(ends.filter(is_own));
            }
        }
        for o in chain.openings.iter().map(|o| &axes.openings[*o as usize]) {
            out.handles.extend(o.faces.iter().flat_map(|f| face_handles(plan, *f)).filter(is_own));
        }
        // The end of another wall may lie on a face: of what moves whole, the chain has what lies in it altogether.
        let controls = |w: &u32| {
            (0..self.graph.control_nodes[*w as usize].len() as u32).map(|c| (*w, c)).collect::<Vec<_>>()
        };
        let all = |r: &usize| self.whole[r].iter().flat_map(controls).collect::<Vec<Handle>>();
        out.records.retain(|r| all(r).iter().all(is_own));
        out.handles.extend(out.records.iter().flat_map(all));
        Some(out)
    }

    /// The graph's nodes of what moves, if all that meets in them can be written: point by point, whole, or as an end that
    /// slides on its own wall. What merely shares a corner of a building stays.
    pub(super) fn nodes(&self, own: &Own) -> Option<Vec<u32>> {
        let node = |(w, c): &Handle| self.graph.control_nodes[*w as usize][*c as usize];
        let nodes: BTreeSet<u32> = own.handles.iter().map(node).collect();
        let mut met = nodes.iter().flat_map(|n| &self.graph.handles[*n as usize]);
        let is_building = self.plan.format != Format::Dxf;
        let is_writable = met.all(|h| {
            let wall = &self.plan.walls[h.0 as usize];
            let is_arc = wall.editable == Editable::Free && matches!(wall.shape, Shape::Arc { .. });
            !is_arc && (self.goes(own, *h) || is_building && wall.editable.moves_whole())
        });
        (is_writable && !nodes.is_empty()).then(|| nodes.into_iter().collect())
    }

    /// The corners at some nodes that follow what moves.
    pub(super) fn taken(&self, own: &Own, nodes: &[u32]) -> BTreeSet<Handle> {
        let all = nodes.iter().flat_map(|n| &self.graph.handles[*n as usize]).copied();
        all.filter(|h| self.goes(own, *h)).collect()
    }

    /// Whether a corner follows what moves.
    fn goes(&self, own: &Own, (w, c): Handle) -> bool {
        let wall = &self.plan.walls[w as usize];
        match &wall.editable {
            Editable::Free => true,
            Editable::No(_) => false,
            _ if own.records.contains(&wall.source.record) => true,
            Editable::Wall { ends, .. } => ends.iter().any(|end| end.contains(&c)),
            Editable::WithInsert { .. } => false,
        }
    }
}
