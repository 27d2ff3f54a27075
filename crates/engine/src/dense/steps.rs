//! Steps from some vertices, in rows of bits.

use super::super::graph::for_each_bit;
use super::super::stairs::NEVER;
use super::{Dense, DenseScratch};

impl Dense {
    /// As [`Graph::steps_from`](super::super::Graph::steps_from) of those that see anybody, in the layout that was
    /// evaluated last.
    pub fn steps_from(&self, first: &[u32], scratch: &DenseScratch) -> Vec<u32> {
        let k = self.stride;
        let row = |cell: usize| &scratch.rows[cell * k..][..k];
        let mut steps = vec![NEVER; self.viewers.len()];
        let mut unseen = vec![u64::MAX; k * 8];
        let cells = first.iter().map(|v| self.cell_of[*v as usize] as usize);
        let mut front: Vec<usize> = cells.filter(|c| row(*c).iter().any(|r| r.0 != [0; 8])).collect();
        let mut step = 0;
        while !front.is_empty() {
            let mut next = vec![0u64; k * 8];
            for cell in front.drain(..) {
                unseen[cell / 64] &= !(1 << (cell % 64));
                steps[self.vertex_of[cell] as usize] = step;
                let words = row(cell).iter().flat_map(|r| r.0);
                next.iter_mut().zip(words).for_each(|(next, seen)| *next |= seen);
            }
            for (w, (word, unseen)) in next.iter().zip(&unseen).enumerate() {
                for_each_bit(word & unseen, |bit| front.push(w * 64 + bit as usize));
            }
            step += 1;
        }
        steps
    }
}
