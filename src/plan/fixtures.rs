//! What is fitted into a building but drawn on the layers of its walls: leaves of doors with their swings,
//! bowls and basins, crosses over shafts. None of it is wall.

use std::collections::{BTreeSet, HashMap};

use glam::DVec2;

use super::axes::near::Buckets;
use super::axes::{Path, paths_of};
use super::distance_to_segment;
use super::drawing::{Entity, Shape};
use super::leaves;
use super::rounds::as_arc;

/// Radii of leaves, metres.
const LEAF_M: [f64; 2] = [0.5, 1.3];

/// How far a leaf turns, radians; from the second on to both sides.
const SWING_RAD: [f64; 3] = [1.0, 2.2, 3.3];

/// How far beside the line from hinge to tip a leaf's lines lie: its thickness and its frame, metres.
const LEAF_BESIDE_M: f64 = 0.08;

/// Shortest line of a leaf, as a share of the swing's radius.
const LEAF_SHARE: f64 = 0.75;

/// What is short is part of a leaf only beyond this share of it: before lies the wall's end.
const CAP_SHARE: f64 = 0.3;

/// Fewest leaves without swings: a house has more than one door, and one line may be the stub of a wall.
const LEAVES_MIN: usize = 2;

/// Shortest cross over a shaft, metres.
const CROSS_MIN_M: f64 = 0.3;

/// How exactly a cross is one, metres.
const CROSS_M: f64 = 0.02;

/// Most lines with one middle among which a cross is looked for.
const MIDDLES_MAX: usize = 16;

/// A cross runs from corner to corner: at no end along a wall, by the sine of the angle.
const OBLIQUE_SIN: f64 = 0.17;

/// Ends nearer than this meet, metres.
const JOINED_M: f64 = 0.004;

/// Sanitary objects and their parts are no larger, metres.
const OBJECT_MAX_M: f64 = 0.75;

/// And no smaller.
const OBJECT_MIN_M: f64 = 0.08;

/// Chords up to this length draw something round, metres, and the cosine of the most they turn.
const CHORD_M: f64 = 0.05;
const TURN_COS: f64 = 0.8;

/// Fewest and most pieces that draw a bowl, of which this share is round.
const BOWL_PIECES_MIN: usize = 8;
const BOWL_PIECES_MAX: usize = 1000;
const ROUND_SHARE: f64 = 0.5;

/// Corners at distances from the middle that differ by less, as a share, are those of a round column.
const COLUMN_SHARE: f64 = 0.08;

/// A cistern stands this near to its bowl, metres.
const CISTERN_M: f64 = 0.12;

/// Things within a basin that show that it is one, and the size of its tap, metres.
const WITHIN_MIN: usize = 3;
const TAP_M: f64 = 0.12;

/// A drawn thing, metres.
pub(super) struct Item {
    entity: usize,
    paths: Vec<Path>,
    points: Vec<DVec2>,
    is_ring: bool,
    lo: DVec2,
    hi: DVec2,
}

impl Item {
    /// An entity with its number; `None` for what has no size.
    pub fn new(entity: usize, drawn: &Entity, place: impl Fn(DVec2) -> DVec2) -> Option<Self> {
        let paths = paths_of(&drawn.shape, place);
        let points: Vec<DVec2> = paths.iter().flat_map(points_of).collect();
        let [lo, hi] = super::box_of(points.iter().copied()).filter(|b| b.iter().all(|p| p.is_finite()))?;
        let meets = |p: &[DVec2]| p.len() > 3 && p[0].distance(p[p.len() - 1]) < JOINED_M;
        let is_ring = matches!(drawn.shape, Shape::Circle { .. }) || meets(&points);
        Some(Self { entity, paths, points, is_ring, lo, hi })
    }

    fn size(&self) -> f64 {
        (self.hi - self.lo).max_element()
    }

    fn line(&self) -> Option<[DVec2; 2]> {
        match self.paths[..] {
            [Path::Line { a, b }] => Some([a, b]),
            _ => None,
        }
    }

    fn ends(&self) -> [DVec2; 2] {
        [self.points[0], self.points[self.points.len() - 1]]
    }

    fn is_within(&self, lo: DVec2, hi: DVec2) -> bool {
        self.lo.cmpge(lo).all() && self.hi.cmple(hi).all()
    }
}

/// Points along a piece.
fn points_of(path: &Path) -> Vec<DVec2> {
    match *path {
        Path::Line { a, b } => vec![a, b],
        Path::Arc { centre, radius, start_rad, sweep_rad } => (0..=12)
            .map(|k| centre + DVec2::from_angle(start_rad + sweep_rad * f64::from(k) / 12.0) * radius)
            .collect(),
    }
}

/// What was found: numbers of entities, ascending, each in one list.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Fixtures {
    /// Leaves of doors and their swings.
    pub doors: Vec<usize>,
    /// Bowls, basins and what belongs to them.
    pub sanitary: Vec<usize>,
    /// Crosses over shafts and lifts.
    pub crosses: Vec<usize>,
}

/// Finds what is fitted.
pub(super) fn find(items: &[Item]) -> Fixtures {
    let mut near = Buckets::new(1.0);
    for (i, item) in items.iter().enumerate() {
        near.add(i as u32, &item.points);
    }
    let scene = Scene { items, near };
    let mut taken: BTreeSet<usize> = BTreeSet::new();
    let mut fresh = |found: BTreeSet<usize>| -> Vec<usize> {
        let mut out: Vec<usize> =
            found.into_iter().filter(|i| taken.insert(*i)).map(|i| items[i].entity).collect();
        out.sort_unstable();
        out
    };
    Fixtures {
        doors: fresh(scene.doors()),
        sanitary: fresh(scene.sanitary()),
        crosses: fresh(scene.crosses()),
    }
}

struct Scene<'a> {
    items: &'a [Item],
    near: Buckets,
}

impl Scene<'_> {
    fn around(&self, lo: DVec2, hi: DVec2, reach: f64) -> impl Iterator<Item = usize> + '_ {
        self.near.near(lo - reach, hi + reach).into_iter().map(|i| i as usize)
    }

    fn doors(&self) -> BTreeSet<usize> {
        let mut out = BTreeSet::new();
        for (i, item) in self.items.iter().enumerate() {
            let Some(Path::Arc { centre, radius, sweep_rad, .. }) = as_arc(&item.paths) else { continue };
            if !(LEAF_M[0]..=LEAF_M[1]).contains(&radius)
                || !(SWING_RAD[0]..=SWING_RAD[2]).contains(&sweep_rad)
            {
                continue;
            }
            let tips = item.ends();
            let behind_m = if sweep_rad > SWING_RAD[1] { radius } else { 0.0 };
            let leaves = tips.map(|tip| self.leaf(centre, tip, behind_m, i));
            let which = match leaves.each_ref().map(|l| !l.is_empty()) {
                [false, false] => continue,
                [true, false] => Some(0),
                [false, true] => Some(1),
                // The open leaf hangs free; the threshold ends at the other jamb.
                [true, true] => self.freer(tips, &leaves, i),
            };
            out.insert(i);
            out.extend(which.into_iter().flat_map(|k| leaves[k].iter().copied()));
        }
        out.extend(self.leaves_alone(&out));
        out
    }

    /// Leaves without swings.
    fn leaves_alone(&self, taken: &BTreeSet<usize>) -> Vec<usize> {
        let others = (0..self.items.len()).filter(|i| !taken.contains(i));
        let of = |i: usize| {
            let pieces = self.items[i].points.windows(2);
            pieces.map(move |w| leaves::Piece { ends: [w[0], w[1]], thing: i, is_wall: true })
        };
        let pieces = leaves::Pieces::new(others.clone().flat_map(of));
        let found: Vec<usize> =
            others.filter(|i| pieces.swing(&self.items[*i].paths, *i).is_some()).collect();
        if found.len() >= LEAVES_MIN { found } else { Vec::new() }
    }

    /// The lines of a leaf from its hinge to its tip; it may begin `behind_m` behind the hinge, drawn twice.
    fn leaf(&self, hinge: DVec2, tip: DVec2, behind_m: f64, swing: usize) -> Vec<usize> {
        let radius = hinge.distance(tip);
        let along = (tip - hinge) / radius;
        let local = |p: &DVec2| DVec2::new((*p - hinge).dot(along), along.perp_dot(*p - hinge));
        let mut out = Vec::new();
        let mut reaches = false;
        for j in self.around(hinge.min(tip), hinge.max(tip), LEAF_BESIDE_M + behind_m) {
            let item = &self.items[j];
            let [lo, hi] = super::box_of(item.points.iter().map(local)).unwrap_or_default();
            let is_beside = lo.y.min(-hi.y) >= -LEAF_BESIDE_M
                && lo.x >= -1.5 * LEAF_BESIDE_M - behind_m
                && hi.x <= radius + LEAF_BESIDE_M;
            let is_long = hi.x - lo.x >= LEAF_SHARE * radius;
            if j != swing && is_beside && (is_long || lo.x >= CAP_SHARE * radius) {
                out.push(j);
                reaches |= is_long && hi.x >= radius - LEAF_BESIDE_M;
            }
        }
        if reaches { out } else { Vec::new() }
    }

    /// Which of two tips fewer other pieces end at; `None` where they are equal.
    fn freer(&self, tips: [DVec2; 2], leaves: &[Vec<usize>; 2], swing: usize) -> Option<usize> {
        let [a, b] = tips.map(|tip| {
            let ends_here = |j: &usize| self.items[*j].ends().iter().any(|e| e.distance(tip) < LEAF_BESIDE_M);
            let others = self.around(tip, tip, LEAF_BESIDE_M);
            others.filter(|j| *j != swing && !leaves.concat().contains(j)).filter(ends_here).count()
        });
        (a != b).then_some(usize::from(b < a))
    }

    /// Pairs of lines that halve each other and run from corner to corner.
    fn crosses(&self) -> BTreeSet<usize> {
        let cell = |p: DVec2| (p / CROSS_M).floor().as_i64vec2().to_array();
        let lines = self.items.iter().enumerate().filter_map(|(i, item)| Some((i, item.line()?)));
        let lines: Vec<(usize, [DVec2; 2])> =
            lines.filter(|(_, [a, b])| a.distance(*b) >= CROSS_MIN_M).collect();
        let mut by_middle: HashMap<[i64; 2], Vec<(usize, [DVec2; 2])>> = HashMap::new();
        for (i, [a, b]) in &lines {
            by_middle.entry(cell(a.midpoint(*b))).or_default().push((*i, [*a, *b]));
        }
        let mut out = BTreeSet::new();
        for (i, first) in &lines {
            let [x, y] = cell(first[0].midpoint(first[1]));
            let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
            let near = around.filter_map(|key| by_middle.get(&key));
            // Where many lines have one middle they are a hatch.
            let others = near.filter(|list| list.len() <= MIDDLES_MAX).flatten();
            for (j, second) in others.filter(|(j, _)| j > i) {
                if self.is_cross([*i, *j], *first, *second) {
                    out.extend([*i, *j]);
                }
            }
        }
        out
    }

    fn is_cross(&self, lines: [usize; 2], [a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
        let ends = [(a, b - a), (b, b - a), (c, d - c), (d, d - c)];
        a.midpoint(b).distance(c.midpoint(d)) <= CROSS_M
            && (a.distance(b) - c.distance(d)).abs() <= CROSS_M
            && sin(b - a, d - c) > OBLIQUE_SIN
            && ends.into_iter().all(|(p, along)| self.is_corner(p, along, lines))
    }

    /// Whether two lines meet at a point, neither of them along a direction.
    fn is_corner(&self, p: DVec2, along: DVec2, but: [usize; 2]) -> bool {
        let mut seen: Vec<DVec2> = Vec::new();
        for j in self.around(p, p, CROSS_M).filter(|j| !but.contains(j)) {
            for path in &self.items[j].paths {
                if let Path::Line { a, b } = *path
                    && distance_to_segment(p, [a, b]) <= CROSS_M
                    && sin(b - a, along) > OBLIQUE_SIN
                {
                    seen.push(b - a);
                }
            }
        }
        seen.iter().any(|u| sin(*u, seen[0]) > OBLIQUE_SIN)
    }

    fn sanitary(&self) -> BTreeSet<usize> {
        let mut out: BTreeSet<usize> = self.bowls();
        for (i, ring) in self.items.iter().enumerate() {
            let is_basin = ring.is_ring && (2.0 * OBJECT_MIN_M..=OBJECT_MAX_M).contains(&ring.size());
            if !is_basin {
                continue;
            }
            let within = self.around(ring.lo, ring.hi, 0.0);
            let within = within.filter(|j| *j != i && self.items[*j].is_within(ring.lo, ring.hi));
            let within: Vec<usize> = within.collect();
            let is_tap = |j: &usize| {
                let item = &self.items[*j];
                item.size() <= TAP_M || item.paths.iter().any(|p| matches!(p, Path::Arc { .. }))
            };
            if within.len() >= WITHIN_MIN && within.iter().any(is_tap) {
                out.insert(i);
                out.extend(within);
            }
        }
        out
    }

    /// Closed round things that are no column, with what lies in them and the cistern behind.
    fn bowls(&self) -> BTreeSet<usize> {
        let mut out = BTreeSet::new();
        for group in self.small_groups() {
            let points = || group.iter().flat_map(|i| self.items[*i].points.iter().copied());
            let [lo, hi] = super::box_of(points()).unwrap_or_default();
            if !(OBJECT_MIN_M..=OBJECT_MAX_M).contains(&(hi - lo).max_element()) || !self.is_bowl(&group) {
                continue;
            }
            let slack = DVec2::splat(CHORD_M);
            let around = self.around(lo, hi, CISTERN_M);
            let is_part = |j: &usize| {
                let item = &self.items[*j];
                let is_beside = || {
                    let near = |p: DVec2| item.paths.iter().any(|q| is_near(q, p, CISTERN_M));
                    item.is_ring && item.size() <= OBJECT_MAX_M && points().any(near)
                };
                item.is_within(lo - slack, hi + slack) || is_beside()
            };
            out.extend(around.filter(is_part));
            out.extend(group);
        }
        out
    }

    /// Small things that hang together by their ends, each group with at least one closed way round.
    fn small_groups(&self) -> Vec<Vec<usize>> {
        let cell = |p: DVec2| (p / JOINED_M).floor().as_i64vec2().to_array();
        let mut nodes: HashMap<[i64; 2], Vec<(DVec2, usize)>> = HashMap::new();
        let mut points: Vec<DVec2> = Vec::new();
        let mut node = |p: DVec2| -> usize {
            let [x, y] = cell(p);
            for key in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy])) {
                let here = nodes.get(&key).into_iter().flatten();
                if let Some((_, n)) = here.into_iter().find(|(q, _)| q.distance(p) <= JOINED_M) {
                    return *n;
                }
            }
            points.push(p);
            nodes.entry([x, y]).or_default().push((p, points.len() - 1));
            points.len() - 1
        };
        let small: Vec<usize> =
            (0..self.items.len()).filter(|i| self.items[*i].size() <= OBJECT_MAX_M).collect();
        let ends: Vec<[usize; 2]> = small.iter().map(|i| self.items[*i].ends().map(&mut node)).collect();
        let mut root: Vec<usize> = (0..points.len()).collect();
        fn find(root: &mut [usize], mut i: usize) -> usize {
            while root[i] != i {
                root[i] = root[root[i]];
                i = root[i];
            }
            i
        }
        for [a, b] in &ends {
            let (a, b) = (find(&mut root, *a), find(&mut root, *b));
            root[a.max(b)] = a.min(b);
        }
        let mut groups: Vec<(Vec<usize>, BTreeSet<usize>)> = vec![Default::default(); points.len()];
        for (i, e) in small.iter().zip(&ends) {
            let group = &mut groups[find(&mut root, e[0])];
            group.0.push(*i);
            group.1.extend(e);
        }
        groups.into_iter().filter(|(items, nodes)| items.len() >= nodes.len().max(1)).map(|g| g.0).collect()
    }

    fn is_bowl(&self, group: &[usize]) -> bool {
        let paths: Vec<&Path> = group.iter().flat_map(|i| &self.items[*i].paths).collect();
        if !(BOWL_PIECES_MIN..=BOWL_PIECES_MAX).contains(&paths.len()) {
            return false;
        }
        let is_round = |p: &&&Path| matches!(p, Path::Arc { .. }) || is_chord(p, &paths);
        let round_m: f64 = paths.iter().filter(is_round).map(|p| p.length_m()).sum();
        if round_m < ROUND_SHARE * paths.iter().map(|p| p.length_m()).sum::<f64>() {
            return false;
        }
        let points = || group.iter().flat_map(|i| self.items[*i].points.iter().copied());
        let [lo, hi] = super::box_of(points()).unwrap_or_default();
        let from_middle = points().map(|p| p.distance(lo.midpoint(hi)));
        let (least, most) = from_middle.fold((f64::MAX, 0.0f64), |(lo, hi), d| (lo.min(d), hi.max(d)));
        most - least > COLUMN_SHARE * most
    }
}

/// Whether a short piece goes on at both ends with little turn: a chord of something round, no corner of a post.
fn is_chord(path: &Path, all: &[&Path]) -> bool {
    let Path::Line { a, b } = *path else { return false };
    let goes_on = |from: DVec2, to: DVec2| {
        all.iter().any(|q| {
            let Path::Line { a: c, b: d } = **q else { return false };
            let out = if c.distance(to) <= JOINED_M { d - c } else { c - d };
            let meets = c.distance(to) <= JOINED_M || d.distance(to) <= JOINED_M;
            meets && out.normalize_or_zero().dot((to - from).normalize_or_zero()) > TURN_COS
        })
    };
    path.length_m() <= CHORD_M && goes_on(a, b) && goes_on(b, a)
}

/// Sine of the angle between two directions.
fn sin(u: DVec2, v: DVec2) -> f64 {
    u.normalize_or_zero().perp_dot(v.normalize_or_zero()).abs()
}

fn is_near(path: &Path, p: DVec2, reach: f64) -> bool {
    points_of(path).windows(2).any(|w| distance_to_segment(p, [w[0], w[1]]) <= reach)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drawing::{Editable, SourceRef, Vertex};
    use std::f64::consts::{FRAC_PI_2, TAU};

    fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Shape {
        Shape::Line { a: DVec2::new(x0, y0), b: DVec2::new(x1, y1) }
    }

    fn ring(points: &[[f64; 2]]) -> Shape {
        let vertices = points.iter().map(|p| Vertex { at: DVec2::from(*p), bulge: 0.0 }).collect();
        Shape::Polyline { vertices, closed: true }
    }

    fn box_at(x: f64, y: f64, dx: f64, dy: f64) -> Shape {
        ring(&[[x, y], [x + dx, y], [x + dx, y + dy], [x, y + dy]])
    }

    /// An ellipse in short chords, as programs write bowls.
    fn bowl(x: f64, y: f64, rx: f64, ry: f64) -> Vec<Shape> {
        let at = |k: u32| {
            let t = TAU * f64::from(k) / 48.0;
            (x + rx * t.cos(), y + ry * t.sin())
        };
        let chord = |k: u32| {
            let ((x0, y0), (x1, y1)) = (at(k), at((k + 1) % 48));
            line(x0, y0, x1, y1)
        };
        (0..48).map(chord).collect()
    }

    fn found(shapes: &[Shape], turn_rad: f64) -> Fixtures {
        let entity = |shape: &Shape| Entity {
            source: SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: "W".into() },
            layer: "W".into(),
            shape: shape.clone(),
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        };
        let place = |p: DVec2| DVec2::from_angle(turn_rad).rotate(p) + DVec2::new(40.0, -7.0);
        let items = shapes.iter().enumerate().filter_map(|(i, s)| {
            // Arcs turn with their angles; only points pass through `place`.
            let turned = match s {
                Shape::Arc { centre, radius, start_rad, end_rad } => Shape::Arc {
                    centre: *centre,
                    radius: *radius,
                    start_rad: start_rad + turn_rad,
                    end_rad: end_rad + turn_rad,
                },
                other => other.clone(),
            };
            Item::new(i, &entity(&turned), place)
        });
        find(&items.collect::<Vec<_>>())
    }

    /// Two rooms with a door of 0.9 m between them, and how many pieces that is.
    fn rooms() -> Vec<Shape> {
        vec![
            line(0.0, 0.0, 8.0, 0.0),
            line(0.0, 6.0, 8.0, 6.0),
            line(0.0, 0.0, 0.0, 6.0),
            line(8.0, 0.0, 8.0, 6.0),
            line(4.0, 0.0, 4.0, 2.0),
            line(4.1, 0.0, 4.1, 2.0),
            line(4.0, 2.9, 4.0, 6.0),
            line(4.1, 2.9, 4.1, 6.0),
            line(4.0, 2.0, 4.1, 2.0),
            line(4.0, 2.9, 4.1, 2.9),
        ]
    }

    #[test]
    fn leaves_bowls_basins_and_crosses_are_found_at_any_angle() {
        let mut shapes = rooms();
        let walls = shapes.len();
        let arc =
            Shape::Arc { centre: DVec2::new(4.1, 2.0), radius: 0.9, start_rad: 0.0, end_rad: FRAC_PI_2 };
        shapes.extend([arc, box_at(4.1, 2.0, 0.9, 0.04)]);
        let doors: Vec<usize> = (walls..shapes.len()).collect();
        shapes.extend(bowl(1.0, 0.5, 0.19, 0.25));
        shapes.push(box_at(0.75, 0.1, 0.5, 0.12));
        shapes.extend([box_at(2.0, 0.02, 0.5, 0.4), box_at(2.04, 0.06, 0.42, 0.3)]);
        shapes.extend([
            Shape::Circle { centre: DVec2::new(2.25, 0.1), radius: 0.02 },
            line(2.25, 0.1, 2.25, 0.2),
        ]);
        let sanitary: Vec<usize> = (doors[1] + 1..shapes.len()).collect();
        shapes.extend([line(4.1, 5.0, 5.1, 5.0), line(5.1, 5.0, 5.1, 6.0)]);
        let crosses = vec![shapes.len(), shapes.len() + 1];
        shapes.extend([line(4.1, 5.0, 5.1, 6.0), line(4.1, 6.0, 5.1, 5.0)]);
        for turn in [0.0, 0.4, 2.0] {
            let all = Fixtures { doors: doors.clone(), sanitary: sanitary.clone(), crosses: crosses.clone() };
            assert_eq!(found(&shapes, turn), all, "turned by {turn}");
        }
    }

    #[test]
    fn round_corners_columns_and_crossing_walls_stay() {
        let mut shapes = rooms();
        // A rounded corner of a stairwell, its walls along the arc's ends.
        shapes.push(Shape::Arc {
            centre: DVec2::new(1.0, 5.0),
            radius: 0.9,
            start_rad: FRAC_PI_2,
            end_rad: 2.0 * FRAC_PI_2,
        });
        shapes.extend([line(1.0, 5.9, 3.0, 5.9), line(0.1, 5.0, 0.1, 3.0)]);
        shapes.extend(bowl(6.0, 3.0, 0.3, 0.3));
        shapes.push(Shape::Circle { centre: DVec2::new(7.0, 3.0), radius: 0.2 });
        shapes.push(box_at(5.0, 1.0, 0.4, 0.4));
        let arm = [[0.04, 0.02], [0.15, 0.02], [0.15, -0.02], [0.04, -0.02]];
        let corners: Vec<DVec2> = (0..4)
            .flat_map(|k| arm.map(|p| DVec2::from_angle(f64::from(k) * -FRAC_PI_2).rotate(DVec2::from(p))))
            .collect();
        let post = |k: usize| {
            let [a, b] = [corners[k], corners[(k + 1) % corners.len()]].map(|p| p + DVec2::new(2.0, 4.0));
            Shape::Line { a, b }
        };
        shapes.extend((0..corners.len()).map(post));
        shapes.extend([line(1.0, 2.0, 3.0, 2.0), line(2.0, 1.0, 2.0, 3.0)]);
        assert_eq!(found(&shapes, 0.3), Fixtures::default());
    }
}
