//! Inside and outside as the cheapest cut: the floor is parted at its narrow places, and a part is inside where walls
//! surround it, unless the way from it to the outside is too wide to be a gap.

use std::collections::{BTreeMap, VecDeque};

use super::enclosure::LOOKS;
use super::raster::Raster;

/// Two parts are one where the way between them is at least this share as wide as the narrower of them.
const NECK_SHARE: f64 = 0.9;

/// No label.
pub const NONE: u32 = u32::MAX;

/// The free ground, parted at its narrow places.
pub struct Parts {
    /// The part of every pixel; [`NONE`] on walls.
    pub label: Vec<u32>,
    /// Of every part its size, pixels, and the share of the horizon that walls hide from it, on average.
    area: Vec<f64>,
    hidden: Vec<f64>,
    /// Whether it reaches the border.
    is_border: Vec<bool>,
    /// What part touches what, the lower first: along how many pixels, and how wide the way is there.
    ways: BTreeMap<[u32; 2], Way>,
}

#[derive(Clone, Copy, Default)]
struct Way {
    length: f64,
    half_width: f32,
}

/// How much may lie open.
#[derive(Clone, Copy)]
pub struct Terms {
    /// Ground is rather inside from this share of the horizon on that is hidden by walls.
    pub hidden_min: f64,
    /// What a way costs that is cut, in the area that it would take if it were as long as wide.
    pub way: f64,
}

impl Parts {
    /// Parts the ground; `to_wall`: distance of every pixel from the walls.
    pub fn new(raster: &Raster, to_wall: &[f32]) -> Self {
        let (mut label, count) = basins(raster, to_wall);
        let enclosure = raster.enclosure();
        let mut out = Self {
            label: Vec::new(),
            area: vec![0.0; count],
            hidden: vec![0.0; count],
            is_border: vec![false; count],
            ways: BTreeMap::new(),
        };
        for i in (0..label.len()).filter(|i| label[*i] != NONE) {
            let part = label[i] as usize;
            out.area[part] += 1.0;
            out.hidden[part] += f64::from(enclosure[i]) / LOOKS.len() as f64;
            out.is_border[part] |= raster.is_border(i);
            for (j, step) in raster.around(i) {
                if step > 0 && label[j] != NONE && label[j] != label[i] {
                    let way = out.ways.entry(ordered(label[i], label[j])).or_default();
                    way.length += 1.0;
                    way.half_width = way.half_width.max(to_wall[i].min(to_wall[j]));
                }
            }
        }
        out.hidden.iter_mut().zip(&out.area).for_each(|(h, a)| *h /= a);
        out.label = std::mem::take(&mut label);
        out
    }

    /// Which parts lie inside, and the half width of the widest way that is cut for it, pixels. `said`: what is told of
    /// some parts.
    pub fn inside(&self, terms: Terms, said: &BTreeMap<u32, bool>) -> (Vec<bool>, f32) {
        let count = self.area.len();
        let [source, sink] = [count, count + 1];
        let mut flow = Flow::new(count + 2);
        let gain = |part: usize| match said.get(&(part as u32)) {
            Some(true) => CERTAIN,
            Some(false) => -CERTAIN,
            None if self.is_border[part] => -CERTAIN,
            None => self.area[part] * (self.hidden[part] - terms.hidden_min),
        };
        for part in 0..count {
            let gain = gain(part);
            if gain > 0.0 { flow.join(source, part, gain, 0.0) } else { flow.join(part, sink, -gain, 0.0) }
        }
        for ([a, b], way) in &self.ways {
            let cost = terms.way * way.length * f64::from(2.0 * way.half_width).max(1.0);
            flow.join(*a as usize, *b as usize, cost, cost);
        }
        let mut inside = flow.source_side(source, sink);
        inside.truncate(count);
        let cut = self.ways.iter().filter(|([a, b], _)| inside[*a as usize] != inside[*b as usize]);
        let widest = cut.map(|(_, way)| way.half_width).fold(0.0, f32::max);
        (inside, widest)
    }

    /// The pixels of some parts, and the walls round them.
    pub fn spread(&self, raster: &Raster, of: &[bool]) -> Vec<bool> {
        let label = &self.label;
        let is_in = |i: usize| label[i] != NONE && of[label[i] as usize];
        let is_beside = |i: usize| {
            let (c, r) = (i / raster.rows, i % raster.rows);
            let cols = c.saturating_sub(1)..=(c + 1).min(raster.cols - 1);
            cols.flat_map(|c| {
                (r.saturating_sub(1)..=(r + 1).min(raster.rows - 1)).map(move |r| c * raster.rows + r)
            })
            .any(is_in)
        };
        (0..label.len()).map(|i| if raster.wall[i] { is_beside(i) } else { is_in(i) }).collect()
    }
}

/// Stands for a capacity that no cut can afford: larger than any plan.
const CERTAIN: f64 = 1e12;

fn ordered(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Watersheds of the distance from the walls: a part for every place that is wider than what leads to it. Their number too.
fn basins(raster: &Raster, to_wall: &[f32]) -> (Vec<u32>, usize) {
    let order = farthest_first(raster, to_wall);
    let mut label = vec![NONE; to_wall.len()];
    let (mut root, mut peak): (Vec<u32>, Vec<f32>) = (Vec::new(), Vec::new());
    for i in order {
        let here = to_wall[i as usize];
        let mut own = NONE;
        for (j, _) in raster.around(i as usize) {
            if label[j] == NONE {
                continue;
            }
            let other = find(&mut root, label[j]);
            if own == NONE {
                own = other;
                continue;
            }
            let [low, high] = match peak[own as usize] < peak[other as usize] {
                true => [own, other],
                false => [other, own],
            };
            if low != high && f64::from(here) >= NECK_SHARE * f64::from(peak[low as usize]) {
                root[low as usize] = high;
            }
            own = if low == high || root[low as usize] == high { high } else { own };
        }
        if own == NONE {
            own = root.len() as u32;
            root.push(own);
            peak.push(here);
        }
        label[i as usize] = own;
    }
    let mut number = vec![NONE; root.len()];
    let mut count = 0;
    for l in label.iter_mut().filter(|l| **l != NONE) {
        let top = find(&mut root, *l) as usize;
        if number[top] == NONE {
            number[top] = count;
            count += 1;
        }
        *l = number[top];
    }
    (label, count as usize)
}

/// The free pixels, those farthest from the walls first, of equal ones the first: sorted by counting, as the squares of
/// distances are whole and small.
fn farthest_first(raster: &Raster, to_wall: &[f32]) -> Vec<u32> {
    let square = |i: usize| f64::from(to_wall[i]).powi(2).round() as usize;
    let free = || (0..to_wall.len()).filter(|i| !raster.wall[*i]);
    let mut starts = vec![0_u32; free().map(square).max().map_or(0, |most| most + 1)];
    free().for_each(|i| starts[square(i)] += 1);
    let mut sum = 0;
    for start in starts.iter_mut().rev() {
        (*start, sum) = (sum, sum + *start);
    }
    let mut order = vec![0; sum as usize];
    for i in free() {
        let start = &mut starts[square(i)];
        order[*start as usize] = i as u32;
        *start += 1;
    }
    order
}

fn find(root: &mut [u32], mut i: u32) -> u32 {
    while root[i as usize] != i {
        root[i as usize] = root[root[i as usize] as usize];
        i = root[i as usize];
    }
    i
}

/// A network whose largest flow is its cheapest cut (Dinic 1970).
struct Flow {
    edges: Vec<Edge>,
    of_node: Vec<Vec<u32>>,
}

struct Edge {
    to: u32,
    left: f64,
}

/// What is left of a capacity below this is rounding.
const LEFT_MIN: f64 = 1e-9;

impl Flow {
    fn new(nodes: usize) -> Self {
        Self { edges: Vec::new(), of_node: vec![Vec::new(); nodes] }
    }

    fn join(&mut self, a: usize, b: usize, there: f64, back: f64) {
        for (from, to, left) in [(a, b, there), (b, a, back)] {
            self.of_node[from].push(self.edges.len() as u32);
            self.edges.push(Edge { to: to as u32, left });
        }
    }

    fn levels(&self, source: usize) -> Vec<u32> {
        let mut level = vec![NONE; self.of_node.len()];
        level[source] = 0;
        let mut queue = VecDeque::from([source]);
        while let Some(node) = queue.pop_front() {
            for e in self.of_node[node].iter().map(|e| &self.edges[*e as usize]) {
                if e.left > LEFT_MIN && level[e.to as usize] == NONE {
                    level[e.to as usize] = level[node] + 1;
                    queue.push_back(e.to as usize);
                }
            }
        }
        level
    }

    /// The nodes on the source's side of the cheapest cut; of several the smallest side.
    fn source_side(mut self, source: usize, sink: usize) -> Vec<bool> {
        loop {
            let level = self.levels(source);
            if level[sink] == NONE {
                return level.iter().map(|l| *l != NONE).collect();
            }
            let mut next = vec![0; self.of_node.len()];
            while self.push(source, sink, &level, &mut next) {}
        }
    }

    /// Pushes as much as one way takes; whether there was one.
    fn push(&mut self, source: usize, sink: usize, level: &[u32], next: &mut [usize]) -> bool {
        let mut way: Vec<u32> = Vec::new();
        let mut node = source;
        while node != sink {
            let open = self.of_node[node][next[node]..].iter().position(|e| {
                let edge = &self.edges[*e as usize];
                edge.left > LEFT_MIN && level[edge.to as usize] == level[node] + 1
            });
            match open {
                Some(skipped) => {
                    next[node] += skipped;
                    way.push(self.of_node[node][next[node]]);
                    node = self.edges[way[way.len() - 1] as usize].to as usize;
                }
                None => {
                    next[node] = self.of_node[node].len();
                    let Some(last) = way.pop() else { return false };
                    node = self.edges[(last ^ 1) as usize].to as usize;
                    next[node] += 1;
                }
            }
        }
        let most = way.iter().map(|e| self.edges[*e as usize].left).fold(f64::INFINITY, f64::min);
        for e in way {
            self.edges[e as usize].left -= most;
            self.edges[(e ^ 1) as usize].left += most;
        }
        true
    }
}
