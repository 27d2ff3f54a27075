//! Straight walls on one line that hang together, at nodes or by the openings between them.

use std::collections::BTreeMap;

use super::chain::{BESIDE_M, Chain};
use super::{Axial, PARALLEL_SIN};
use enfilade_plan::axes::Edge;

impl<'a> Axial<'a> {
    /// Straight thick walls on one line that hang together.
    pub(super) fn chains(&self) -> Vec<Chain> {
        let edges = &self.axes.edges;
        let mut root: Vec<u32> = (0..edges.len() as u32).collect();
        let find = |root: &Vec<u32>, mut i: u32| {
            while root[i as usize] != i {
                i = root[i as usize];
            }
            i
        };
        // A line by itself is a wall where all walls are.
        let is_single = edges.iter().all(|e| e.thickness_m == 0.0);
        let is_thick = |i: &u32| {
            let edge = &edges[*i as usize];
            edge.bulge == 0.0 && (is_single || edge.thickness_m > 0.0)
        };
        let thick: Vec<Vec<u32>> =
            self.at_node.iter().map(|list| list.iter().copied().filter(is_thick).collect()).collect();
        let mut pairs: Vec<(Option<u32>, [u32; 2])> = Vec::new();
        for around in &thick {
            let rest = |k: usize, i: u32| around[k + 1..].iter().map(move |j| (None, [i, *j]));
            pairs.extend(around.iter().enumerate().flat_map(|(k, i)| rest(k, *i)));
        }
        for (k, o) in self.axes.openings.iter().enumerate() {
            if let [Some(a), Some(b)] = o.jambs.map(|j| j.node) {
                let others = |i: u32| thick[b as usize].iter().map(move |j| (Some(k as u32), [i, *j]));
                pairs.extend(thick[a as usize].iter().flat_map(|i| others(*i)));
            }
        }
        pairs.retain(|(_, [i, j])| self.on_one_line(&edges[*i as usize], &edges[*j as usize]));
        for (_, [i, j]) in &pairs {
            let (a, b) = (find(&root, *i), find(&root, *j));
            root[a.max(b) as usize] = a.min(b);
        }
        let mut sets: BTreeMap<u32, (Vec<u32>, Vec<u32>)> = BTreeMap::new();
        for i in (0..edges.len() as u32).filter(is_thick) {
            sets.entry(find(&root, i)).or_default().1.push(i);
        }
        for (opening, [i, _]) in pairs {
            if let (Some(o), Some(set)) = (opening, sets.get_mut(&find(&root, i))) {
                set.0.push(o);
            }
        }
        sets.into_values().map(|(openings, set)| self.chain(openings, set)).collect()
    }

    fn chain(&self, openings: Vec<u32>, edges: Vec<u32>) -> Chain {
        let all = &self.axes.edges;
        let [origin, b] = self.axes.ends(&all[edges[0] as usize]);
        let along = (b - origin).normalize_or_zero();
        let ends = edges.iter().flat_map(|e| self.axes.ends(&all[*e as usize]));
        let places: Vec<f64> = ends.map(|p| (p - origin).dot(along)).collect();
        let thickness = edges.iter().map(|e| all[*e as usize].thickness_m).fold(0.0, f64::max);
        Chain {
            origin,
            along,
            from: places.iter().copied().fold(f64::MAX, f64::min),
            to: places.iter().copied().fold(f64::MIN, f64::max),
            thickness,
            edges,
            openings,
        }
    }

    /// Whether two straight walls lie on one line and are as thick.
    fn on_one_line(&self, e: &Edge, f: &Edge) -> bool {
        let ([a, b], [c, d]) = (self.axes.ends(e), self.axes.ends(f));
        let (u, v) = ((b - a).normalize_or_zero(), (d - c).normalize_or_zero());
        u.perp_dot(v).abs() < PARALLEL_SIN
            && [c, d].iter().all(|p| u.perp_dot(*p - a).abs() < BESIDE_M)
            && (e.thickness_m - f.thickness_m).abs() < BESIDE_M
    }
}
