//! A section over the view it was cut from: programs that draw plans of solids write what is seen as one block and what is
//! cut as another over it. Every line of the section is then a line of the view too, to the last digit.

use std::collections::{BTreeMap, HashSet};

use glam::DVec2;

use enfilade_cad::drawing::{Drawing, Shape};

/// A section has at most this share of the lines of the view that it lies over: less, and nothing is seen below it.
const SHARE_MAX: f64 = 0.5;

/// Fewer lines may lie over others by chance: a doubled wall, a column drawn again.
const LINES_MIN: usize = 12;

/// Entities of the view below its section, ascending; empty where no block lies over another. What is drawn outside the
/// two blocks is in neither.
pub fn seen_below(drawing: &Drawing) -> Vec<usize> {
    let mut blocks: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if let Some(block) = e.blocks.first() {
            blocks.entry(block).or_default().push(i);
        }
    }
    let bits = |p: &DVec2| [p.x.to_bits(), p.y.to_bits()];
    let line = |i: &usize| match &drawing.entities[*i].shape {
        Shape::Line { a, b } => Some([bits(a).min(bits(b)), bits(a).max(bits(b))]),
        _ => None,
    };
    let lies_over = |section: &[usize], view: &[usize]| {
        let drawn: HashSet<[[u64; 2]; 2]> = view.iter().filter_map(line).collect();
        section.iter().all(|i| line(i).is_some_and(|l| drawn.contains(&l)))
    };
    let larger = |section: &[usize], view: &[usize]| {
        section.len() >= LINES_MIN && section.len() as f64 <= SHARE_MAX * view.len() as f64
    };
    let sections: Vec<&Vec<usize>> =
        blocks.values().filter(|b| b.iter().all(|i| line(i).is_some())).collect();
    let is_view = |view: &Vec<usize>| sections.iter().any(|s| larger(s, view) && lies_over(s, view));
    let mut below: Vec<usize> = blocks.values().filter(|v| is_view(v)).flatten().copied().collect();
    below.sort_unstable();
    below
}
