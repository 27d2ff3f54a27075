//! What every opening in a wall would bring, by one look through the wall.
//!
//! The wall is thought away between two of its places. Who then sees whom and did not before sees through it: the line of
//! sight crosses its two faces at two places. An opening joins the two if and only if both places lie between its jambs.
//! So the gain of all openings in the wall, of any place and width, is counted from one list of such pairs: complete, at
//! the cost of one visibility graph a wall.

use enfilade_engine::forest::tally_of;
use enfilade_engine::geometry::{PointUm, Segment, segments_touch};
use enfilade_engine::graph::Graph;
use enfilade_engine::visibility::{Vista, Window};
use enfilade_engine::{Lattice, Obstacles};
use enfilade_plan::Plan;

use crate::change::Change;
use crate::rooms::{Room, RoomId};
use crate::walls::Wall;

/// Steps of places along a wall, metres of a person (`docs/works.md`).
pub const STEP_M: f64 = 0.1;

/// A line of sight nearer than this to a jamb touches it, metres: jambs stand on whole micrometres.
const TOUCH_M: f64 = 1e-7;

/// Two vertices that see each other through a wall, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Through {
    /// The part of the wall's axis between the two faces that the line of sight crosses, metres along the wall.
    pub span_m: [f64; 2],
    /// How many ordered pairs of a vertex of query and one of reference this is: 1 or 2, or 0.
    pub weight: u32,
    /// What it shows of private rooms to somebody who is not in them.
    pub shows: Shows,
}

/// What a view shows of private rooms to somebody who is not in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Nothing.
    Nothing,
    /// Something while their doors stand open.
    ThroughDoors,
    /// Something whether or not their doors are shut.
    Openly,
}

/// The present layout as it is seen.
#[derive(Clone, Copy)]
pub struct Present<'a> {
    /// Its plan.
    pub plan: &'a Plan,
    /// Its cells.
    pub lattice: &'a Lattice,
    /// What stops sight, on the same cells.
    pub vista: &'a Vista,
    /// Who sees whom.
    pub graph: &'a Graph,
    /// Its rooms.
    pub rooms: &'a [Room],
    /// The room of every vertex.
    pub room_of: &'a [Option<RoomId>],
    /// Whether each vertex is one of query.
    pub is_query: &'a [bool],
    /// The doors of private rooms, shut; drawing frame.
    pub shut: &'a [Segment],
}

impl Present<'_> {
    /// Ordered pairs of a vertex of query and one of reference that see each other: the sum of degrees.
    pub fn degrees(&self) -> u64 {
        degrees(self.lattice, self.graph)
    }

    /// What a view between two vertices shows of private rooms.
    pub fn shows(&self, u: u32, v: u32) -> Shows {
        if !self.shows_private(u, v) {
            return Shows::Nothing;
        }
        let [a, b] = [u, v].map(|x| self.lattice.centre_um(x as usize));
        let passes = |door: &Segment| segments_touch(*door, Segment { a, b });
        if self.shut.iter().any(passes) { Shows::ThroughDoors } else { Shows::Openly }
    }

    fn shows_private(&self, u: u32, v: u32) -> bool {
        let [a, b] = [u, v].map(|x| self.room_of[x as usize]);
        let is_private = |r: Option<RoomId>| r.is_some_and(|r| self.rooms[r.0].kind.is_private());
        a != b && (is_private(a) || is_private(b))
    }

    /// The graph after a change.
    pub fn changed(&self, change: &Change) -> Graph {
        self.vista.changed(self.graph, &after(self.vista, change))
    }

    /// Everybody who sees somebody through a stretch of a wall once it is gone, and does not see him now.
    pub fn through(&self, wall: &Wall, stretch_m: [f64; 2]) -> Vec<Through> {
        let gone = Change { demolished: vec![wall.quad(self.plan, stretch_m)], built: Vec::new() };
        let one = |&[u, v]: &[u32; 2]| {
            let [a, b] = [u, v].map(|x| self.lattice.centre_um(x as usize));
            let span_m = crossing(self.plan, wall, a, b);
            Through { span_m, weight: weight(self.lattice, self.is_query, u, v), shows: self.shows(u, v) }
        };
        self.difference(&gone).seen.iter().map(one).collect()
    }

    /// Who sees whom after a change and does not now, and the other way round.
    pub fn difference(&self, change: &Change) -> Difference {
        difference(self.vista, self.graph, change)
    }

    /// What a change adds to [`Self::degrees`].
    pub fn gained(&self, difference: &Difference) -> i64 {
        difference.gained(self.lattice, self.is_query)
    }

    /// What a change adds to the ordered pairs that show a private room to somebody who is not in it.
    pub fn gained_private(&self, difference: &Difference) -> i64 {
        difference.sum(|u, v| 2 * i64::from(self.shows_private(u, v)))
    }
}

/// Pairs of vertices, each once, the smaller first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Difference {
    /// Those that see each other afterwards and do not now.
    pub seen: Vec<[u32; 2]>,
    /// Those that see each other now and do not afterwards.
    pub hidden: Vec<[u32; 2]>,
}

impl Difference {
    /// Of what each pair counts: those gained less those lost.
    pub fn sum(&self, of: impl Fn(u32, u32) -> i64) -> i64 {
        let all = |pairs: &[[u32; 2]]| pairs.iter().map(|&[u, v]| of(u, v)).sum::<i64>();
        all(&self.seen) - all(&self.hidden)
    }

    /// What is added to the sum of degrees.
    pub fn gained(&self, lattice: &Lattice, is_query: &[bool]) -> i64 {
        self.sum(|u, v| i64::from(weight(lattice, is_query, u, v)))
    }
}

/// What stops sight after a change.
fn after(now: &Vista, change: &Change) -> Obstacles {
    let Obstacles { segments, blind } = now.obstacles();
    Obstacles { segments: change.apply(segments), blind: blind.clone() }
}

/// What a change does to who sees whom on a lattice, at the cost of the view through it: what is gained is seen through what
/// is demolished, what is lost is hidden by what is built.
pub fn difference(now: &Vista, graph: &Graph, change: &Change) -> Difference {
    let mut out = Difference::default();
    if !change.demolished.is_empty() {
        out.seen = now.other(after(now, change)).through(&[&holes(change)]).beyond(graph);
    }
    if !change.built.is_empty() {
        let lattice = now.lattice();
        let through = now.through(&[&fillings(change)]);
        for u in 0..through.len() as u32 {
            through.for_each_neighbour(u, |v| {
                let [a, b] = [u, v].map(|x| lattice.centre_um(x as usize));
                if u < v && change.built.iter().any(|s| segments_touch(*s, Segment { a, b })) {
                    out.hidden.push([u, v]);
                }
            });
        }
    }
    out
}

fn holes(change: &Change) -> Vec<Window> {
    change.demolished.iter().map(|q| q.to_vec()).collect()
}

fn fillings(change: &Change) -> Vec<Window> {
    change.built.iter().map(|s| vec![s.a, s.b]).collect()
}

/// How much more two changes add to the sum of degrees together than each alone: nobody but who looks through both can tell.
pub fn more_together(now: &Vista, is_query: &[bool], changes: [&Change; 2]) -> i64 {
    let windows = changes.map(|c| [holes(c), fillings(c)].concat());
    let windows = windows.each_ref().map(Vec::as_slice);
    // Where nobody looks through both with both taken down and nothing built, nobody does otherwise.
    let both = changes[0].clone().and(changes[1]);
    let bare = Change { demolished: both.demolished.clone(), built: Vec::new() };
    if now.other(after(now, &bare)).through(&windows).edge_count() == 0 {
        return 0;
    }
    let sum = |of: &Vista| pairs_seen(of.lattice(), &of.through(&windows), is_query);
    let with = |change: &Change| sum(&now.other(after(now, change)));
    sum(now) + with(&both) - with(changes[0]) - with(changes[1])
}

/// Ordered pairs of a vertex of query and one of reference that see each other in a part of a graph.
fn pairs_seen(lattice: &Lattice, graph: &Graph, is_query: &[bool]) -> i64 {
    let mut sum = 0;
    for u in 0..graph.len() as u32 {
        graph.for_each_neighbour(u, |v| {
            if u < v {
                sum += i64::from(weight(lattice, is_query, u, v));
            }
        });
    }
    sum
}

/// How many of the two ways round a pair is one of a vertex of query and one of reference: 0 to 2.
fn weight(lattice: &Lattice, is_query: &[bool], u: u32, v: u32) -> u32 {
    let sees = |a: u32, b: u32| is_query[a as usize] && lattice.is_reference[b as usize];
    u32::from(sees(u, v)) + u32::from(sees(v, u))
}

/// Ordered pairs of a vertex of query and one of reference that see each other.
pub fn degrees(lattice: &Lattice, graph: &Graph) -> u64 {
    tally_of(lattice, graph, Some(&[]), None).degree.iter().map(|d| u64::from(*d)).sum()
}

/// Where a line crosses the two faces of a wall, metres along its axis, ascending.
fn crossing(plan: &Plan, wall: &Wall, a: PointUm, b: PointUm) -> [f64; 2] {
    let [a, b] = [a, b].map(|p| {
        let d = plan.frame.plan_from_um(p) - wall.at;
        [d.dot(wall.along), wall.along.perp_dot(d)]
    });
    let half = wall.thickness_m / 2.0;
    let at = |v: f64| {
        let share = ((v - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0);
        a[0] + (b[0] - a[0]) * share
    };
    if a[1] == b[1] {
        return [a[0].min(b[0]), a[0].max(b[0])];
    }
    let [s, t] = [at(-half), at(half)];
    [s.min(t), s.max(t)]
}

/// What all openings of one width in a wall would bring, by their first jamb.
#[derive(Clone, Debug, PartialEq)]
pub struct Counts {
    /// Pairs gained, ordered, for each place.
    pub gained: Vec<u64>,
    /// Those that show a private room though its doors are shut.
    pub openly: Vec<u64>,
    /// Those that show one while its doors stand open.
    pub through_doors: Vec<u64>,
}

/// Counts for openings of a width whose first jamb stands at `from_m + k · step_m`, for `places` places. An opening joins
/// what crosses strictly between its jambs: a line that touches a jamb does not pass.
pub fn counts(through: &[Through], from_m: f64, step_m: f64, places: usize, width_m: f64) -> Counts {
    // Rises where places begin to join a pair, falls behind the last.
    let mut rise = vec![[0i64; 3]; places + 1];
    for t in through.iter().filter(|t| t.weight > 0 || t.shows != Shows::Nothing) {
        // from + k step < span[0] and span[1] < from + k step + width.
        let last = ((t.span_m[0] - TOUCH_M - from_m) / step_m).ceil() as i64 - 1;
        let first = ((t.span_m[1] + TOUCH_M - width_m - from_m) / step_m).floor() as i64 + 1;
        let (first, last) = (first.max(0), last.min(places as i64 - 1));
        if first <= last {
            let is = |shows| i64::from(t.shows == shows);
            let by = [i64::from(t.weight), is(Shows::Openly), is(Shows::ThroughDoors)];
            for k in 0..3 {
                rise[first as usize][k] += by[k];
                rise[last as usize + 1][k] -= by[k];
            }
        }
    }
    let mut sums = [0i64; 3];
    let mut out = [const { Vec::new() }; 3];
    for r in &rise[..places] {
        for k in 0..3 {
            sums[k] += r[k];
            out[k].push(sums[k].max(0) as u64);
        }
    }
    let [gained, openly, through_doors] = out;
    Counts { gained, openly, through_doors }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Each place counted for itself gives the same.
        #[test]
        fn all_places_at_once_as_one_by_one(
            pairs in prop::collection::vec((0.0f64..6.0, 0.0f64..2.0, 0u32..3), 0..60),
            width in 1usize..30,
        ) {
            let through: Vec<Through> = pairs
                .iter()
                .map(|&(s, d, weight)| Through { span_m: [s, s + d], weight, shows: Shows::Nothing })
                .collect();
            let width = width as f64 * 0.1;
            let all = counts(&through, 0.35, 0.1, 40, width);
            for k in 0..40 {
                let (from, to) = (0.35 + k as f64 * 0.1, 0.35 + k as f64 * 0.1 + width);
                let joins = |t: &&Through| from < t.span_m[0] - 2e-7 && t.span_m[1] + 2e-7 < to;
                let least: u64 = through.iter().filter(joins).map(|t| u64::from(t.weight)).sum();
                let nearly = |t: &&Through| from < t.span_m[0] && t.span_m[1] < to + 1e-9;
                let most: u64 = through.iter().filter(nearly).map(|t| u64::from(t.weight)).sum();
                prop_assert!((least..=most).contains(&all.gained[k]), "{least} {most} {}", all.gained[k]);
            }
        }
    }
}
