//! Boosted decision trees: the trained part of the reading. The table is made by `scripts/reading/train.py`.

use std::sync::LazyLock;

/// The table: what may be told apart, which features are asked for, and the trees.
const TABLE: &str = include_str!("model.txt");

/// Classes that the trees tell apart, in the order of the table.
pub const CLASSES: usize = 7;

/// Values of one piece, one a class.
pub type Votes = [f64; CLASSES];

/// A node: a split, or a leaf where `right` is 0.
#[derive(Clone, Copy)]
struct Node {
    feature: u16,
    /// Where a value above the threshold goes; one up to it goes on to the next node.
    right: u16,
    /// Threshold, or the leaf's value.
    value: f32,
}

/// Trees of the classes in turn.
pub struct Forest {
    nodes: Vec<Node>,
    starts: Vec<u32>,
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
            out.starts.push(u32::try_from(out.nodes.len()).ok()?);
            out.add(line)?;
        }
        (out.starts.len() == trees && trees.is_multiple_of(CLASSES)).then_some(out)
    }

    /// Adds a tree in pre-order.
    fn add(&mut self, line: &str) -> Option<()> {
        let first = self.nodes.len();
        // Splits whose right side is still to come.
        let mut open: Vec<usize> = Vec::new();
        for word in line.split(' ') {
            let at = self.nodes.len();
            if let Some(value) = word.strip_prefix('=') {
                self.nodes.push(Node { feature: 0, right: 0, value: value.parse().ok()? });
                if let Some(split) = open.pop() {
                    self.nodes[split].right = u16::try_from(at + 1 - first).ok()?;
                }
            } else {
                let (feature, threshold) = word.split_once(':')?;
                let feature: u16 = feature.parse().ok()?;
                if usize::from(feature) >= self.features {
                    return None;
                }
                self.nodes.push(Node { feature, right: 0, value: threshold.parse().ok()? });
                open.push(at);
            }
        }
        open.is_empty().then_some(())
    }

    /// How likely each class is, 0 to 1, together 1. `row`: the features, as many as the table says.
    pub fn votes(&self, row: &[f32]) -> Votes {
        let mut sums = [0.0; CLASSES];
        for (tree, start) in self.starts.iter().enumerate() {
            let nodes = &self.nodes[*start as usize..];
            let mut at = 0;
            while nodes[at].right != 0 {
                let node = nodes[at];
                at = if row[usize::from(node.feature)] <= node.value {
                    at + 1
                } else {
                    usize::from(node.right)
                };
            }
            sums[tree % CLASSES] += f64::from(nodes[at].value);
        }
        let most = sums.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let parts = sums.map(|s| exp(s - most));
        let all: f64 = parts.iter().sum();
        parts.map(|p| p / all)
    }
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
        let votes = model.forest.votes(&vec![0.0; model.picks.len()]);
        assert!((votes.iter().sum::<f64>() - 1.0).abs() < 1e-12 && votes.iter().all(|v| *v >= 0.0));
    }

    #[test]
    fn a_value_up_to_the_threshold_goes_left() {
        let tree = "0:1.5 1:0 =1 =2 =3";
        let lines = format!("trees 7 features 2\n{}", [tree; 7].join("\n"));
        let forest = Forest::parse(&mut lines.lines()).unwrap();
        let leaf = |row: [f32; 2]| {
            let mut at = 0;
            while forest.nodes[at].right != 0 {
                let n = forest.nodes[at];
                at = if row[usize::from(n.feature)] <= n.value { at + 1 } else { usize::from(n.right) };
            }
            forest.nodes[at].value
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
