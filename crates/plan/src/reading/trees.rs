//! Boosted decision trees: the trained part of the reading. The table is made by `scripts/reading/train.py`.

use std::sync::LazyLock;

/// The table: what may be told apart, which features are asked for, and the trees.
const TABLE: &str = include_str!("model.txt");

/// Classes that the trees tell apart, in the order of the table.
pub const CLASSES: usize = 7;

/// Values of one piece, one a class.
pub type Votes = [f64; CLASSES];

/// A node: a split, or a leaf, which leads to itself.
#[derive(Clone, Copy)]
struct Node {
    feature: u16,
    /// Where a value up to the threshold goes, and where one above it.
    next: [u16; 2],
    /// Threshold, or the leaf's value.
    value: f32,
}

/// Rows that go through a tree together: their ways do not wait for one another.
pub const TOGETHER: usize = 16;

/// Trees of the classes in turn.
pub struct Forest {
    nodes: Vec<Node>,
    /// Where each tree begins, and how many splits its longest way has.
    starts: Vec<(u32, u16)>,
    features: usize,
}

/// The trained part.
pub struct Model {
    /// Which features the trees ask for.
    pub picks: Vec<usize>,
    /// The trees.
    pub forest: Forest,
}

/// The model that comes with the program; `None` if its table cannot be read, which a test excludes.
pub fn model() -> Option<&'static Model> {
    static MODEL: LazyLock<Option<Model>> = LazyLock::new(|| Model::parse(TABLE));
    MODEL.as_ref()
}

impl Model {
    fn parse(table: &str) -> Option<Self> {
        let mut lines = table.lines();
        let classes = lines.next()?.strip_prefix("classes ")?;
        let picks = lines.next()?.strip_prefix("features ")?;
        let picks: Vec<usize> = picks.split(' ').map(|w| w.parse().ok()).collect::<Option<_>>()?;
        let model = Self { picks, forest: Forest::parse(&mut lines)? };
        let is_whole = classes.split(' ').count() == CLASSES && model.picks.len() == model.forest.features;
        is_whole.then_some(model)
    }
}

impl Forest {
    fn parse<'t>(lines: &mut impl Iterator<Item = &'t str>) -> Option<Self> {
        let mut words = lines.next()?.split(' ');
        let mut number = |name: &str| (words.next()? == name).then(|| words.next()?.parse::<usize>().ok())?;
        let (trees, features) = (number("trees")?, number("features")?);
        let mut out = Self { nodes: Vec::new(), starts: Vec::with_capacity(trees), features };
        for line in lines.take(trees) {
            let start = u32::try_from(out.nodes.len()).ok()?;
            let depth = out.add(line)?;
            out.starts.push((start, depth));
        }
        (out.starts.len() == trees && trees.is_multiple_of(CLASSES)).then_some(out)
    }

    /// Adds a tree in pre-order; how many splits its longest way has.
    fn add(&mut self, line: &str) -> Option<u16> {
        let first = self.nodes.len();
        // Splits whose right side is still to come, with how many are above that side.
        let mut open: Vec<(usize, u16)> = Vec::new();
        let (mut above, mut deepest) = (0, 0);
        for word in line.split(' ') {
            let at = u16::try_from(self.nodes.len() - first).ok()?;
            if let Some(value) = word.strip_prefix('=') {
                self.nodes.push(Node { feature: 0, next: [at, at], value: value.parse().ok()? });
                deepest = deepest.max(above);
                if let Some((split, beside)) = open.pop() {
                    self.nodes[split].next[1] = at.checked_add(1)?;
                    above = beside;
                }
            } else {
                let (feature, threshold) = word.split_once(':')?;
                let feature: u16 = feature.parse().ok()?;
                if usize::from(feature) >= self.features {
                    return None;
                }
                let next = at.checked_add(1)?;
                self.nodes.push(Node { feature, next: [next, 0], value: threshold.parse().ok()? });
                above += 1;
                open.push((self.nodes.len() - 1, above));
            }
        }
        open.is_empty().then_some(deepest)
    }

    /// How likely each class is, 0 to 1, together 1, for some rows one after the other: the features of each, as many as
    /// the table says.
    pub fn votes(&self, rows: &[f32]) -> Vec<Votes> {
        let mut out = Vec::with_capacity(rows.len() / self.features.max(1));
        let mut block = vec![0.0; self.features * TOGETHER];
        for rows in rows.chunks(self.features * TOGETHER) {
            block[..rows.len()].copy_from_slice(rows);
            out.extend(self.sums(&block).into_iter().take(rows.len() / self.features).map(shares));
        }
        out
    }

    /// Sums of the leaves of each class for [`TOGETHER`] rows.
    fn sums(&self, rows: &[f32]) -> [Votes; TOGETHER] {
        let mut sums = [[0.0; CLASSES]; TOGETHER];
        for (tree, (start, depth)) in self.starts.iter().enumerate() {
            let nodes = &self.nodes[*start as usize..];
            let mut at = [0; TOGETHER];
            for _ in 0..*depth {
                for (row, at) in rows.chunks_exact(self.features).zip(&mut at) {
                    let node = nodes[usize::from(*at)];
                    let is_left = row[usize::from(node.feature)] <= node.value;
                    *at = node.next[usize::from(!is_left)];
                }
            }
            for (sums, at) in sums.iter_mut().zip(at) {
                sums[tree % CLASSES] += f64::from(nodes[usize::from(at)].value);
            }
        }
        sums
    }
}

/// Sums as shares of one.
fn shares(sums: Votes) -> Votes {
    let most = sums.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let parts = sums.map(|s| exp(s - most));
    let all: f64 = parts.iter().sum();
    parts.map(|p| p / all)
}

/// e^x for x ≤ 0 by additions and multiplications alone: the same bits on every machine. Off by less than 1e-7.
fn exp(x: f64) -> f64 {
    let x = (x * std::f64::consts::LOG2_E).max(-60.0);
    let whole = x.round();
    let rest = (x - whole) * std::f64::consts::LN_2;
    let terms = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
    let power = terms.iter().fold(0.0, |sum, term| sum * rest + term);
    power * f64::from_bits(((1023 + whole as i64) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_read_whole() {
        let model = model().unwrap();
        let known = super::super::features::Features::names().len();
        assert!(model.picks.iter().all(|p| *p < known));
        let votes = model.forest.votes(&vec![0.0; model.picks.len()])[0];
        assert!((votes.iter().sum::<f64>() - 1.0).abs() < 1e-12 && votes.iter().all(|v| *v >= 0.0));
    }

    #[test]
    fn a_value_up_to_the_threshold_goes_left() {
        let tree = "0:1.5 1:0 =1 =2 =3";
        let lines = format!("trees 7 features 2\n{}", [tree; 7].join("\n"));
        let forest = Forest::parse(&mut lines.lines()).unwrap();
        let leaf = |row: [f32; 2]| {
            let rows = [row; TOGETHER].concat();
            forest.sums(&rows)[TOGETHER - 1][0]
        };
        assert_eq!([leaf([1.5, 0.0]), leaf([1.5, 0.1]), leaf([1.6, 0.0])], [1.0, 2.0, 3.0]);
        assert!(Forest::parse(&mut "trees 7 features 2\n0:1 =1".lines()).is_none());
    }

    #[test]
    fn powers_are_those_of_e() {
        for x in [0.0, -0.3, -1.0, -7.7, -30.0] {
            assert!((exp(x) - f64::exp(x)).abs() < 1e-7, "{x}");
        }
    }
}
