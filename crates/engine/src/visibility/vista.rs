//! A layout that others are compared with: what a change does to sight is looked at where it changes anything.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::windows::Window;
use super::{pairwise_graph, swept};
use crate::geometry::{PointUm, Segment, cross_um};
use crate::graph::Graph;
use crate::strips::Strips;
use crate::tiles::Tiles;
use crate::{Lattice, Obstacles};

/// Where more walls change than this share of all, everything is looked at: three looks through as many windows take no less.
/// A large house takes 35 s either way from a twelfth to a quarter, and 46 s where everything is always looked at.
const CHANGED_SHARE: f64 = 0.25;

/// A layout that is looked at again and again: its walls are cut once.
pub struct Vista {
    lattice: Arc<Lattice>,
    obstacles: Obstacles,
    tiles: Arc<Tiles>,
    strips: Option<Strips>,
}

impl Vista {
    /// A layout of a lattice.
    pub fn new(lattice: Arc<Lattice>, obstacles: Obstacles) -> Self {
        let tiles = Arc::new(Tiles::new(&lattice));
        let strips = Strips::new(&lattice, &tiles, &obstacles);
        Self { lattice, obstacles, tiles, strips }
    }

    /// Another layout of the same lattice.
    pub fn other(&self, obstacles: Obstacles) -> Self {
        let strips = Strips::new(&self.lattice, &self.tiles, &obstacles);
        Self { lattice: Arc::clone(&self.lattice), obstacles, tiles: Arc::clone(&self.tiles), strips }
    }

    /// Its lattice.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// What stops sight in it.
    pub fn obstacles(&self) -> &Obstacles {
        &self.obstacles
    }

    /// As [`visibility_graph`](super::visibility_graph).
    pub fn graph(&self) -> Graph {
        self.looked(None)
    }

    /// Those pairs of [`graph`](Self::graph) whose line of sight meets a window of each group, and maybe others of it, the same
    /// ones whatever stands there: what an obstacle in the windows hides or would hide, at the cost of the view through them.
    pub fn through(&self, windows: &[&[Window]]) -> Graph {
        self.looked(Some(windows))
    }

    fn looked(&self, windows: Option<&[&[Window]]>) -> Graph {
        match &self.strips {
            Some(strips) => swept((&self.lattice, Arc::clone(&self.tiles)), strips, windows),
            None => pairwise_graph(&self.lattice, &self.obstacles),
        }
    }

    /// The graph of another layout, from this one's: equal to that of its own, bit for bit.
    pub fn changed(&self, graph: &Graph, obstacles: &Obstacles) -> Graph {
        let windows = self.windows_to(obstacles);
        let few = CHANGED_SHARE * self.obstacles.segments.len() as f64;
        let then = self.other(obstacles.clone());
        let many = windows.iter().map(Vec::len).sum::<usize>() as f64 > few;
        if many { then.graph() } else { self.seen_otherwise(graph, &then, &windows) }
    }

    /// [`changed`](Self::changed), however much differs.
    #[cfg(test)]
    pub(super) fn changed_where(&self, graph: &Graph, obstacles: &Obstacles) -> Graph {
        self.seen_otherwise(graph, &self.other(obstacles.clone()), &self.windows_to(obstacles))
    }

    fn seen_otherwise(&self, graph: &Graph, then: &Self, [gone, come]: &[Vec<Window>; 2]) -> Graph {
        if self.strips.is_none() || then.strips.is_none() {
            return then.graph();
        }
        // What comes hides some of what is seen where it stands; what goes hides nothing any more.
        let [before, after] = [self, then].map(|of| of.through(&[come]));
        graph.replaced(&before, &after).with(&then.through(&[gone]))
    }

    /// What stops a line of sight in this layout alone, and what in another alone.
    fn windows_to(&self, then: &Obstacles) -> [Vec<Window>; 2] {
        let mut windows = windows_between(&self.obstacles, then);
        let covered = [&self.obstacles, then].map(|o| o.blind.iter().copied().collect::<BTreeSet<u32>>());
        let centre = |v: &u32| vec![self.lattice.centre_um(*v as usize); 2];
        windows[0].extend(covered[0].difference(&covered[1]).map(centre));
        windows[1].extend(covered[1].difference(&covered[0]).map(centre));
        windows
    }
}

/// Where walls of the first of two layouts stand and none of the other, and the other way round.
fn windows_between(now: &Obstacles, then: &Obstacles) -> [Vec<Window>; 2] {
    let [before, after] = [now, then].map(|o| o.segments.iter().copied().map(lower_first).collect());
    let (before, after): (BTreeSet<Segment>, BTreeSet<Segment>) = (before, after);
    let window = |a: PointUm, b: PointUm| vec![a, b];
    let mut come: Vec<Segment> = after.difference(&before).copied().collect();
    let mut gone: Vec<Window> = Vec::new();
    for whole in before.difference(&after) {
        let (mut left, others): (Vec<Segment>, Vec<Segment>) =
            come.into_iter().partition(|part| [part.a, part.b].iter().all(|p| is_on(*whole, *p)));
        come = others;
        left.sort_unstable();
        let mut from = whole.a;
        for part in left {
            gone.extend((from < part.a).then(|| window(from, part.a)));
            from = from.max(part.b);
        }
        gone.extend((from < whole.b).then(|| window(from, whole.b)));
        gone.extend((whole.a == whole.b).then(|| window(whole.a, whole.b)));
    }
    [gone, come.into_iter().map(|s| window(s.a, s.b)).collect()]
}

fn lower_first(s: Segment) -> Segment {
    if s.b < s.a { Segment { a: s.b, b: s.a } } else { s }
}

/// Whether a point lies on a segment.
fn is_on(s: Segment, p: PointUm) -> bool {
    let within = |k: usize| (s.a[k].min(s.b[k])..=s.a[k].max(s.b[k])).contains(&p[k]);
    cross_um(s.a, s.b, p) == 0 && within(0) && within(1)
}
