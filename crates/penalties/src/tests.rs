use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use cavalier_contours::polyline::{BooleanOp, PlineSource, PlineSourceMut, Polyline};
use glam::{DVec2, dvec2};
use proptest::prelude::*;

use super::clearance::RADIUS_M;
use super::pairs::{Aabb, BoxGrid, GRID_CELLS_MAX, sweep};
use super::rounded::{hull_overlap_m2, ring_overlap_m2};
use super::*;

/// Pieces from end points; ends at the same place (to 1 µm) are the same node.
fn pieces(walls: &[([f64; 4], bool)]) -> Vec<WallPiece> {
    let mut nodes = BTreeMap::new();
    let mut node = |p: DVec2| {
        let next = nodes.len() as u32;
        *nodes.entry([(p.x * 1e6).round() as i64, (p.y * 1e6).round() as i64]).or_insert(next)
    };
    let piece = |&([x0, y0, x1, y1], is_moving): &([f64; 4], bool)| {
        let (a, b) = (dvec2(x0, y0), dvec2(x1, y1));
        WallPiece {
            a,
            b,
            nodes: [node(a), node(b)],
            is_moving,
            solid: None,
            bar: None,
            body: None,
            half_m: 0.0,
        }
    };
    walls.iter().map(piece).collect()
}

fn moving(walls: &[[f64; 4]]) -> Vec<WallPiece> {
    pieces(&walls.iter().map(|&w| (w, true)).collect::<Vec<_>>())
}

fn overlap_m2(p: [DVec2; 2], q: [DVec2; 2], r: f64) -> f64 {
    hull_overlap_m2(&p, &q, r)
}

/// The outlines of solids that may move, as pieces.
fn solids(rings: &[&[[f64; 2]]]) -> Vec<WallPiece> {
    let mut all = vec![];
    for (k, ring) in rings.iter().enumerate() {
        let corner = |i: usize| DVec2::from(ring[i % ring.len()]);
        let walls: Vec<_> = (0..ring.len()).map(|i| [corner(i), corner(i + 1)]).collect();
        let first = all.len() as u32;
        all.extend(walls.iter().zip(0..).map(|(&[a, b], i)| WallPiece {
            a,
            b,
            nodes: [first + i, first + (i + 1) % ring.len() as u32],
            is_moving: true,
            solid: Some(k as u32),
            bar: None,
            body: None,
            half_m: 0.0,
        }));
    }
    all
}

fn slab(x: f64, y: f64, dx: f64, dy: f64) -> [[f64; 2]; 4] {
    [[x, y], [x + dx, y], [x + dx, y + dy], [x, y + dy]]
}

fn clearance_m2(p: &[WallPiece]) -> f64 {
    let layout = Layout { pieces: p };
    Clearance::new(&layout, RADIUS_M).measure_m2(&layout)
}

/// Area common to two discs of radius r, centres d apart.
fn lens_m2(d: f64, r: f64) -> f64 {
    2.0 * r * r * (d / (2.0 * r)).acos() - 0.5 * d * (4.0 * r * r - d * d).sqrt()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

#[test]
fn facing_walls_share_a_rectangle_and_a_lens() {
    for (d, length) in [(0.3, 4.0), (0.9, 1.0), (0.999, 7.0), (1e-3, 2.0)] {
        let expected = length * (1.0 - d) + lens_m2(d, 0.5);
        for turn in [0.0, 0.3, FRAC_PI_4, FRAC_PI_2, 2.0, PI] {
            let r = DVec2::from_angle(turn);
            let at = |x, y| dvec2(100.0, -40.0) + r.rotate(dvec2(x, y));
            let (p, q) = ([at(0.0, 0.0), at(length, 0.0)], [at(0.0, d), at(length, d)]);
            assert_near(overlap_m2(p, q, 0.5), expected, 1e-12);
            assert_near(overlap_m2(q, [p[1], p[0]], 0.5), expected, 1e-12);
        }
    }
}

#[test]
fn capsules_that_coincide_or_touch() {
    let (o, x, y) = (DVec2::ZERO, dvec2(3.0, 0.0), dvec2(0.0, 3.0));
    let whole = 3.0 + FRAC_PI_4;
    assert_near(overlap_m2([o, x], [o, x], 0.5), whole, 1e-12);
    assert_near(overlap_m2([o, x], [x, o], 0.5), whole, 1e-12);
    assert_near(overlap_m2([o, o], [o, o], 0.5), FRAC_PI_4, 1e-12);
    assert_near(overlap_m2([o, o], [x, o], 0.5), FRAC_PI_4, 1e-12);
    assert_near(overlap_m2([y, o], [o, o], 0.5), FRAC_PI_4, 1e-12);
    let beside = |d: f64| overlap_m2([o, x], [dvec2(0.0, d), dvec2(3.0, d)], 0.5);
    assert_eq!(beside(1.0), 0.0);
    assert_eq!(beside(1.0 + 1e-9), 0.0);
    assert_near(beside(1.0 - 1e-9), 3e-9, 1e-12);
    let in_line = |gap: f64| overlap_m2([o, x], [dvec2(3.0 + gap, 0.0), dvec2(9.0, 0.0)], 0.5);
    assert_near(in_line(0.4), lens_m2(0.4, 0.5), 1e-12);
    assert_eq!(in_line(1.0), 0.0);
    // A right-angled crossing: the square of side 2 r.
    let cross = overlap_m2([dvec2(-2.0, 0.0), dvec2(2.0, 0.0)], [dvec2(0.0, -2.0), dvec2(0.0, 2.0)], 0.5);
    assert_near(cross, 1.0, 1e-12);
}

fn capsule([a, b]: [DVec2; 2], r: f64) -> Polyline<f64> {
    let side = (b - a).try_normalize().unwrap_or(DVec2::X).perp() * r;
    let mut line = Polyline::new_closed();
    line.add(a.x - side.x, a.y - side.y, 0.0);
    line.add(b.x - side.x, b.y - side.y, 1.0);
    line.add(b.x + side.x, b.y + side.y, 0.0);
    line.add(a.x + side.x, a.y + side.y, 1.0);
    line
}

/// The common area by an independent library that clips native arcs. It takes positions within 1e-5 for
/// equal, so it gets enlarged walls.
fn oracle_m2(p: [DVec2; 2], q: [DVec2; 2], r: f64) -> f64 {
    const ENLARGED: f64 = 1000.0;
    let large = |s: [DVec2; 2]| capsule(s.map(|x| x * ENLARGED), r * ENLARGED);
    let common = large(p).boolean(&large(q), BooleanOp::And);
    let area = common.pos_plines.iter().map(|p| p.pline.area()).sum::<f64>()
        - common.neg_plines.iter().map(|p| p.pline.area().abs()).sum::<f64>();
    area / (ENLARGED * ENLARGED)
}

/// Ends on a coarse raster half of the time, so that parallel, collinear, equal and touching happen.
fn end() -> impl Strategy<Value = DVec2> {
    prop_oneof![
        (-4i32..=4, -4i32..=4).prop_map(|(x, y)| dvec2(f64::from(x), f64::from(y)) * 0.25),
        (-1.5f64..1.5, -1.5f64..1.5).prop_map(|(x, y)| dvec2(x, y)),
    ]
}

fn segment() -> impl Strategy<Value = [DVec2; 2]> {
    (end(), end()).prop_map(|(a, b)| [a, b])
}

/// Corners of a convex outline: points of an ellipse in order.
fn outline() -> impl Strategy<Value = Vec<DVec2>> {
    (prop::collection::vec(0.2f64..1.0, 3..9), 0.1f64..2.0, 0.1f64..2.0, -3.0f64..3.0).prop_map(
        |(steps, a, b, turn)| {
            let whole: f64 = steps.iter().sum();
            let angles = steps.iter().scan(0.0, |at, step| {
                *at += step / whole * 2.0 * PI;
                Some(*at)
            });
            angles.map(|t| DVec2::from_angle(turn).rotate(dvec2(a * t.cos(), b * t.sin()))).collect()
        },
    )
}

/// Shared area by counting lattice points, for the cases an independent library gets wrong.
fn counted_m2(p: [DVec2; 2], q: [DVec2; 2], r: f64, step: f64) -> f64 {
    let near = |s: [DVec2; 2], x: DVec2| distance_to_m(s, x) <= r;
    let n = (2.5 / step) as i32;
    let inside = (-n..n)
        .flat_map(|i| (-n..n).map(move |j| dvec2(f64::from(i) + 0.5, f64::from(j) + 0.5) * step))
        .filter(|&x| near(p, x) && near(q, x));
    inside.count() as f64 * step * step
}

/// The end of one wall lies on the axis of the other: a line touches an arc where two bounds swap.
#[test]
fn overlap_of_walls_that_meet_at_a_right_angle() {
    let (p, q) = ([dvec2(1.0, -1.0), dvec2(-0.5, 0.0)], [dvec2(0.25, -0.5), dvec2(0.75, 0.25)]);
    let turned = |s: [DVec2; 2]| [s[1], s[0]];
    for (p, q) in [(p, q), (q, p), (turned(p), q), (q, turned(p)), (p, turned(q))] {
        let found = overlap_m2(p, q, 0.5);
        assert!((found - counted_m2(p, q, 0.5, 1e-3)).abs() < 1e-3, "{p:?} {q:?}: {found}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, max_global_rejects: 40_000, ..ProptestConfig::default() })]

    /// Over the pairs that are summed; of capsules whose outlines coincide the library makes nothing.
    #[test]
    fn overlap_agrees_with_cavalier_contours(p in segment(), q in segment()) {
        prop_assume!(matches!(meeting(p, q), Meeting::Apart(_)));
        prop_assume!(p[0].distance(p[1]) > 1e-3 && q[0].distance(q[1]) > 1e-3);
        let (found, expected) = (overlap_m2(p, q, 0.5), oracle_m2(p, q, 0.5));
        prop_assert!((found - expected).abs() < 1e-6, "{p:?} {q:?}: found {found}, expected {expected}");
    }

    #[test]
    fn overlap_does_not_depend_on_order_frame_or_direction(
        p in segment(), q in segment(), turn in -4.0f64..4.0, shift in end(),
    ) {
        let found = overlap_m2(p, q, 0.5);
        let r = DVec2::from_angle(turn);
        let moved = |s: [DVec2; 2]| s.map(|x| r.rotate(x) + shift * 40.0);
        for other in [
            overlap_m2(q, p, 0.5),
            overlap_m2([p[1], p[0]], q, 0.5),
            overlap_m2(moved(p), moved(q), 0.5),
            overlap_m2(moved(q), moved([p[1], p[0]]), 0.5),
        ] {
            prop_assert!((found - other).abs() < 1e-9, "{p:?} {q:?}: {found} and {other}");
        }
    }

    /// Two independent ways to widen and clip convex outlines.
    #[test]
    fn convex_outlines_agree_with_cavalier_contours(p in outline(), q in outline(), gap in 0.01f64..1.2) {
        let far = p.iter().map(|p| p.x).fold(f64::MIN, f64::max) - q.iter().map(|q| q.x).fold(f64::MAX, f64::min);
        let q: Vec<DVec2> = q.iter().map(|&x| x + DVec2::X * (far + gap)).collect();
        let (found, expected) = (hull_overlap_m2(&p, &q, 0.5), ring_overlap_m2(&p, &q, 0.5));
        prop_assert!((found - expected).abs() < 1e-6, "{p:?} {q:?}: found {found}, expected {expected}");
    }

    #[test]
    fn sweep_and_grid_find_exactly_the_boxes_that_meet(
        segments in prop::collection::vec(segment(), 0..40), queries in prop::collection::vec(segment(), 1..5),
    ) {
        let boxes: Vec<Aabb> = segments.iter().map(|&s| Aabb::of_segment(s, 0.1)).collect();
        let mut swept = vec![];
        sweep(&boxes, |i, j| swept.push((i.min(j), i.max(j))));
        swept.sort_unstable();
        let all = (0..boxes.len()).flat_map(|i| (i + 1..boxes.len()).map(move |j| (i, j)));
        prop_assert_eq!(swept, all.filter(|&(i, j)| boxes[i].meets(&boxes[j])).collect::<Vec<_>>());
        let grid = BoxGrid::new(boxes.clone());
        for q in queries {
            let query = Aabb::of_segment(q, 0.2);
            let mut found = vec![];
            grid.visit(&query, |i| found.push(i));
            found.sort_unstable();
            prop_assert_eq!(found, (0..boxes.len()).filter(|&i| boxes[i].meets(&query)).collect::<Vec<_>>());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn overlap_agrees_with_counting_in_every_case(p in segment(), q in segment()) {
        let counted = counted_m2(p, q, 0.5, 0.01);
        let found = overlap_m2(p, q, 0.5);
        prop_assert!((found - counted).abs() < 0.02, "{p:?} {q:?}: found {found}, counted {counted}");
    }
}

#[test]
fn grid_spreads_many_boxes_over_its_most_cells() {
    let n = GRID_CELLS_MAX * GRID_CELLS_MAX * 4;
    let at = |i: usize| dvec2((i * 37 % 1000) as f64, (i * 61 % 1000) as f64);
    let grid = BoxGrid::new((0..n).map(|i| Aabb { min: at(i), max: at(i) }).collect());
    let everything = Aabb { min: dvec2(-1.0, -1.0), max: dvec2(1e3, 1e3) };
    let (mut seen, mut twice) = (vec![false; n], 0);
    grid.visit(&everything, |i| twice += usize::from(std::mem::replace(&mut seen[i], true)));
    assert_eq!((seen.iter().filter(|&&s| s).count(), twice), (n, 0));
}

#[test]
fn walls_that_touch_are_adjoining() {
    let (along, d) = ([0.0, 0.0, 4.0, 0.0], 0.4);
    assert_eq!(clearance_m2(&moving(&[along, [4.0, 0.0, 4.0, 3.0]])), 0.0, "corner");
    assert_eq!(clearance_m2(&moving(&[along, [2.0, 0.0, 2.0, 3.0]])), 0.0, "end on a wall");
    assert_eq!(clearance_m2(&moving(&[along, [2.0, 1e-6, 2.0, 3.0]])), 0.0, "rounded to a micrometre");
    assert_eq!(clearance_m2(&moving(&[along, [2.0, -1.0, 2.0, 3.0]])), 0.0, "crossing");
    assert_eq!(clearance_m2(&moving(&[along, [1.0, 0.0, 6.0, 0.0]])), 0.0, "along each other");
    assert_eq!(clearance_m2(&moving(&[along, [0.0, 1.0, 4.0, 1.0]])), 0.0, "just far enough");
    assert!(clearance_m2(&moving(&[along, [2.0, d, 2.0, 3.0]])) > 0.3, "a passage");
}

#[test]
fn pieces_in_line_are_one_wall_only_where_nothing_else_meets() {
    let facing = |y: f64, from: f64, to: f64| [from, y, to, y];
    let whole = clearance_m2(&moving(&[facing(0.0, 0.0, 4.0), facing(0.6, 0.0, 4.0)]));
    assert_near(whole, 4.0 * 0.4 + lens_m2(0.6, 0.5), 1e-12);
    let split = [facing(0.0, 0.0, 1.5), facing(0.0, 4.0, 1.5), facing(0.6, 0.0, 4.0)];
    assert_near(clearance_m2(&moving(&split)), whole, 1e-12);
    let mut with_stub = split.to_vec();
    with_stub.push([1.5, 0.0, 1.5, -3.0]);
    // Now two walls face the third, and the stub's end lies near it as well.
    assert!(clearance_m2(&moving(&with_stub)) > whole + 0.3);
}

#[test]
fn a_bent_chain_is_several_walls_and_a_ring_closes() {
    let square = [[0.0, 0.0, 4.0, 0.0], [4.0, 0.0, 4.0, 4.0], [4.0, 4.0, 0.0, 4.0], [0.0, 4.0, 0.0, 0.0]];
    // The same ring, beginning in the middle of a side.
    let begun_in_a_side = [
        [2.0, 0.0, 4.0, 0.0],
        [4.0, 0.0, 4.0, 4.0],
        [4.0, 4.0, 0.0, 4.0],
        [0.0, 4.0, 0.0, 0.0],
        [0.0, 0.0, 2.0, 0.0],
    ];
    let beside = [0.0, -0.6, 4.0, -0.6];
    let with = |ring: &[[f64; 4]]| clearance_m2(&moving(&[ring, &[beside]].concat()));
    assert_near(with(&begun_in_a_side), with(&square), 1e-12);
    assert!(with(&square) > 1.6);
}

#[test]
fn only_pairs_with_a_moving_wall_count() {
    let row = |y: f64, is_moving| ([0.0, y, 4.0, y], is_moving);
    assert_eq!(clearance_m2(&pieces(&[row(0.0, false), row(0.5, false)])), 0.0);
    let one = clearance_m2(&pieces(&[row(0.0, false), row(0.5, true)]));
    assert_near(one, 4.0 * 0.5 + lens_m2(0.5, 0.5), 1e-12);
    let three = clearance_m2(&pieces(&[row(0.0, false), row(0.5, true), row(1.0, false), row(1.5, false)]));
    assert_near(three, 2.0 * one, 1e-12);
}

#[test]
fn touching_is_judged_in_the_layout_measured() {
    let start = moving(&[[0.0, 0.0, 4.0, 0.0], [2.0, 0.0, 2.0, 3.0]]);
    let clearance = Clearance::new(&Layout { pieces: &start }, RADIUS_M);
    let mut now = start.clone();
    now[1].a.y = 0.2;
    assert_eq!(clearance.measure_m2(&Layout { pieces: &start }), 0.0);
    assert_near(
        clearance.measure_m2(&Layout { pieces: &now }),
        overlap_m2(now[0].ends(), now[1].ends(), 0.5),
        1e-12,
    );
}

/// The two long faces of a slab that lies along x, as faces of one thick wall.
fn faces(x: f64, y: f64, dx: f64, dy: f64, bar: u32) -> Vec<WallPiece> {
    let both = moving(&[[x, y, x + dx, y], [x, y + dy, x + dx, y + dy]]);
    let first = 100 * (bar + 1);
    let of_bar = |p: WallPiece| WallPiece { nodes: p.nodes.map(|n| n + first), bar: Some(bar), ..p };
    both.into_iter().map(of_bar).collect()
}

#[test]
fn a_wall_of_two_faces_counts_as_its_outline() {
    let facing = 4.0 * 0.6 + lens_m2(0.4, 0.5);
    let low = faces(0.0, 0.0, 4.0, 0.12, 0);
    assert_eq!(clearance_m2(&low), 0.0, "its own faces");
    let high = faces(0.0, 0.52, 4.0, 0.12, 1);
    assert_near(clearance_m2(&[low.clone(), high].concat()), facing, 1e-12);
    let outlines = solids(&[&slab(0.0, 0.0, 4.0, 0.12), &slab(0.0, 0.52, 4.0, 0.12)]);
    assert_near(clearance_m2(&outlines), facing, 1e-12);
    let single = moving(&[[0.0, 0.52, 4.0, 0.52]]);
    assert_near(clearance_m2(&[low.clone(), single].concat()), facing, 1e-12);
    // A partition that ends on one face adjoins the wall: its other face is no neighbour.
    let partition = moving(&[[1.0, 0.12, 1.0, 3.0]]);
    assert_eq!(clearance_m2(&[low, partition].concat()), 0.0);
}

#[test]
fn a_solid_is_one_wall_with_its_inside() {
    let (low, high) = (slab(0.0, 0.0, 4.0, 0.12), slab(0.0, 0.52, 4.0, 0.12));
    let facing = 4.0 * 0.6 + lens_m2(0.4, 0.5);
    assert_eq!(clearance_m2(&solids(&[&low])), 0.0, "its own faces");
    assert_near(clearance_m2(&solids(&[&low, &high])), facing, 1e-12);
    let mut reversed = high;
    reversed.reverse();
    assert_near(clearance_m2(&solids(&[&low, &reversed])), facing, 1e-12);
    let wall = moving(&[[0.0, 0.52, 4.0, 0.52]]);
    let with =
        |solid: &[[f64; 2]], walls: &[WallPiece]| clearance_m2(&[solids(&[solid]), walls.to_vec()].concat());
    assert_near(with(&low, &wall), facing, 1e-12);
    assert_eq!(with(&low, &moving(&[[1.0, 0.12, 1.0, 3.0]])), 0.0, "a wall that ends on it");
    assert_eq!(with(&slab(0.0, 0.0, 2.0, 2.0), &moving(&[[0.5, 1.0, 1.5, 1.0]])), 0.0, "a wall inside");
    // An angle, which is not convex, round the end of a wall.
    let angle = [[0.0, 0.0], [3.0, 0.0], [3.0, 0.2], [0.2, 0.2], [0.2, 3.0], [0.0, 3.0]];
    let wall = [dvec2(0.8, 0.9), dvec2(2.5, 2.5)];
    let near = |x: DVec2| {
        let corner = |i: usize| DVec2::from(angle[i % 6]);
        let ring: Vec<DVec2> = (0..6).map(corner).collect();
        is_inside(&ring, x) || (0..6).any(|i| distance_to_m([corner(i), corner(i + 1)], x) <= 0.5)
    };
    let step = 0.002;
    let dots = (0..2000).flat_map(|i| (0..2000).map(move |j| dvec2(f64::from(i), f64::from(j)) * step));
    let counted = dots.filter(|&x| distance_to_m(wall, x) <= 0.5 && near(x)).count() as f64 * step * step;
    let found = with(&angle, &moving(&[[wall[0].x, wall[0].y, wall[1].x, wall[1].y]]));
    assert!(counted > 0.3);
    assert_near(found, counted, 0.005);
}

#[test]
fn a_round_column_has_no_direction() {
    let round: Vec<[f64; 2]> =
        (0..24).map(|i| DVec2::from_angle(f64::from(i) * PI / 12.0).to_array()).collect();
    let frame = pieces(&[([9.0, 0.0, 50.0, 0.0], false), ([0.0, 9.0, 0.0, 50.0], false)]);
    let measure = |start: &[[f64; 2]], now: &[[f64; 2]]| {
        let [start, now] = [start, now].map(|ring| [solids(&[ring]), frame.clone()].concat());
        Alignment::new(&Layout { pieces: &start }).measure_rad2(&Layout { pieces: &now })
    };
    assert_eq!(measure(&round, &round), 0.0);
    let (square, turn) = (slab(0.0, 0.0, 1.0, 1.0), DVec2::from_angle(0.2));
    let turned = square.map(|c| turn.rotate(DVec2::from(c)).to_array());
    assert_near(measure(&square, &turned), 0.04, 1e-12);
}

#[test]
fn wall_length_is_the_change_either_way() {
    let start = moving(&[[0.0, 0.0, 3.0, 4.0], [0.0, 0.0, 2.0, 0.0]]);
    let penalty = WallLength::new(&Layout { pieces: &start });
    for (x, expected) in [(2.0, 0.0), (3.5, 1.5), (0.5, 1.5), (-2.0, 0.0)] {
        let mut now = start.clone();
        now[1].b.x = x;
        assert_near(penalty.measure_m(&Layout { pieces: &now }), expected, 1e-12);
    }
    assert_eq!(wall_length::total_m(&Layout { pieces: &start }), 7.0);
}

#[test]
fn main_directions_are_those_most_wall_runs_along() {
    let r = |deg: f64, length: f64| {
        let v = DVec2::from_angle(deg.to_radians()) * length;
        [0.0, 0.0, v.x, v.y]
    };
    let degrees = |walls: &[[f64; 4]]| -> Vec<f64> {
        let p = moving(walls);
        Alignment::new(&Layout { pieces: &p }).directions_rad().iter().map(|r| r.to_degrees()).collect()
    };
    let near = |found: &[f64], expected: &[f64]| {
        found.len() == expected.len() && found.iter().zip(expected).all(|(f, e)| (f - e).abs() < 1e-9)
    };
    assert!(near(&degrees(&[r(0.0, 10.0), r(90.0, 8.0), r(45.0, 1.0)]), &[0.0, 90.0]));
    assert!(near(&degrees(&[r(200.0, 10.0), r(65.0, 8.0), r(-115.0, 1.0)]), &[20.0, 65.0]));
    // Across the seam at 0 = 180 degrees: one band, its mean weighted by length.
    assert!(
        near(&degrees(&[r(179.5, 10.0), r(0.5, 10.0)]), &[0.0])
            || near(&degrees(&[r(179.5, 10.0), r(0.5, 10.0)]), &[180.0])
    );
    assert!(near(&degrees(&[r(30.0, 3.0), r(31.0, 1.0)]), &[30.25]));
    let round: Vec<_> = (0..18).map(|i| r(f64::from(i) * 10.0, 1.0)).collect();
    assert!(degrees(&round).is_empty(), "no direction holds the share");
    assert!(degrees(&[]).is_empty());
}

#[test]
fn alignment_weighs_the_squared_turn_by_length() {
    let turned = |deg: f64, length: f64| {
        let v = DVec2::from_angle(f64::to_radians(deg)) * length;
        [0.0, 0.0, v.x, v.y]
    };
    let frame = [([0.0, 0.0, 50.0, 0.0], false), ([0.0, 0.0, 0.0, 50.0], false)];
    let start = pieces(&[frame[0], frame[1], (turned(0.0, 2.0), true), (turned(90.0, 4.0), true)]);
    let penalty = Alignment::new(&Layout { pieces: &start });
    assert_eq!(penalty.measure_rad2(&Layout { pieces: &start }), 0.0);
    let now = pieces(&[frame[0], frame[1], (turned(9.0, 2.0), true), (turned(60.0, 4.0), true)]);
    let expected = (2.0 * 9f64.to_radians().powi(2) + 4.0 * 30f64.to_radians().powi(2)) / 6.0;
    assert_near(penalty.measure_rad2(&Layout { pieces: &now }), expected, 1e-12);
    // At 45 degrees both directions are equally far, and none is farther.
    let now = pieces(&[frame[0], frame[1], (turned(135.0, 2.0), true), (turned(-45.0, 4.0), true)]);
    assert_near(penalty.measure_rad2(&Layout { pieces: &now }), FRAC_PI_4.powi(2), 1e-12);
    let standing = pieces(&frame);
    let layout = Layout { pieces: &standing };
    assert_eq!(Alignment::new(&layout).measure_rad2(&layout), 0.0);
}

#[test]
fn overlap_counts_walls_that_newly_run_through_each_other() {
    let wall = [0.0, 0.0, 10.0, 0.0];
    let measure = |from: [f64; 4], to: [f64; 4]| {
        let start = pieces(&[(wall, false), (from, true)]);
        let now = pieces(&[(wall, false), (to, true)]);
        Overlap::new(&Layout { pieces: &start }).measure_m(&Layout { pieces: &now })
    };
    let apart = [5.0, 1.0, 5.0, 3.0];
    assert_eq!(measure(apart, [5.0, 0.0, 5.0, 2.0]), 0.0, "touching");
    assert_near(measure(apart, [5.0, -0.3, 5.0, 1.7]), 0.3, 1e-12);
    assert_near(measure(apart, [9.9, -1.0, 9.9, 1.0]), 0.1, 1e-12);
    assert_near(measure(apart, [8.0, 0.0, 12.0, 0.0]), 2.0, 1e-12);
    assert_eq!(measure([5.0, -1.0, 5.0, 1.0], [6.0, -1.0, 6.0, 1.0]), 0.0, "crossed from the start");
}

/// A solid that hides another crosses none of its faces, and stands in it all the same.
#[test]
fn overlap_counts_what_stands_in_a_solid() {
    let block = |x: f64, y: f64, w: f64, h: f64| [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    let column = block(0.0, 0.0, 0.4, 0.4);
    let measure = |other: &[[f64; 2]], shift: [f64; 2], now: &[[f64; 2]]| {
        let away: Vec<[f64; 2]> = other.iter().map(|p| [p[0] + shift[0], p[1] + shift[1]]).collect();
        let (start, now) = (solids(&[&column, &away]), solids(&[&column, now]));
        Overlap::new(&Layout { pieces: &start }).measure_m(&Layout { pieces: &now })
    };
    let screen = |x: f64, y: f64| block(x, y, 1.6, 0.8);
    let far = [10.0, 0.0];
    let at = |x: f64, y: f64| measure(&screen(x, y), far, &screen(x, y));
    assert_eq!(at(-1.6, 0.0), 0.0, "touching");
    assert_near(at(-0.6, -0.2), 0.6, 1e-12);
    assert_near(measure(&column, far, &column), 0.4, 1e-12);
    // From touching to wholly hidden there is no jump, whichever moves.
    let ways: Vec<f64> = (0..=1000).map(|i| at(-1.6 + f64::from(i) * 1e-3, -0.2)).collect();
    assert!(ways.windows(2).all(|w| (w[1] - w[0]).abs() < 0.01), "{ways:?}");
    assert!(ways[1..].iter().all(|m| *m > 0.0));
    // In the nook of an angle stands nothing; in its leg it does.
    let angle = |x: f64, y: f64| {
        [[0.0, 0.0], [3.0, 0.0], [3.0, 0.6], [0.6, 0.6], [0.6, 3.0], [0.0, 3.0]].map(|[u, v]| [u + x, v + y])
    };
    assert_eq!(measure(&angle(-1.0, -1.0), far, &angle(-1.0, -1.0)), 0.0);
    assert!(measure(&angle(-2.0, -0.1), far, &angle(-2.0, -0.1)) > 0.1);
    // What was hidden from the start is drawn so.
    assert_eq!(measure(&screen(-0.6, -0.2), [0.0, 0.0], &screen(-0.7, -0.2)), 0.0);
    // A wall of one line may be hidden too.
    let with_line = |y: f64| {
        let mut all = solids(&[&screen(0.0, 0.0)]);
        all.extend(moving(&[[0.4, y, 0.6, y]]).into_iter().map(|p| WallPiece { nodes: [90, 91], ..p }));
        all
    };
    let (start, now) = (with_line(5.0), with_line(0.3));
    assert_near(Overlap::new(&Layout { pieces: &start }).measure_m(&Layout { pieces: &now }), 0.3, 1e-12);
}

#[test]
fn meetings_have_names() {
    let s = |x0, y0, x1, y1| [dvec2(x0, y0), dvec2(x1, y1)];
    let wall = s(0.0, 0.0, 4.0, 0.0);
    assert_eq!(meeting(wall, s(0.0, 2.0, 4.0, 2.0)), Meeting::Apart(2.0));
    assert_eq!(meeting(wall, s(4.0, 0.0, 4.0, 2.0)), Meeting::Touch);
    assert_eq!(meeting(wall, s(2.0, 0.0, 2.0, 2.0)), Meeting::Touch);
    assert_eq!(meeting(wall, s(4.0, 0.0, 9.0, 0.0)), Meeting::Touch);
    assert_eq!(meeting(wall, s(2.0, -0.5, 2.0, 2.0)), Meeting::Cross { through_m: 0.5 });
    assert_eq!(meeting(wall, s(3.0, 0.0, 9.0, 0.0)), Meeting::Overlap { common_m: 1.0 });
    assert_eq!(meeting(s(1.0, 0.0, 1.0, 0.0), wall), Meeting::Touch);
    assert_eq!(meeting(s(1.0, 1.0, 1.0, 1.0), s(1.0, 3.0, 1.0, 3.0)), Meeting::Apart(2.0));
}

#[test]
fn disconnection_is_the_squared_share() {
    assert_eq!(disconnection(0, 24, 416), 0.0);
    assert_eq!(disconnection(24 * 416, 24, 416), 1.0);
    assert_eq!(disconnection(24 * 104, 24, 416), 0.0625);
    assert_eq!(disconnection(0, 0, 0), 0.0);
}

/// LINEs of layer WALLS and boxes of the EF-MOVE polylines; enough of DXF for the reference plans.
fn reference_pieces(dxf: &str) -> Vec<WallPiece> {
    let lines: Vec<&str> = dxf.lines().map(str::trim).collect();
    let pairs: Vec<(&str, &str)> = lines.chunks_exact(2).map(|c| (c[0], c[1])).collect();
    let (mut walls, mut boxes) = (vec![], vec![]);
    for record in pairs.chunk_by(|_, next| next.0 != "0") {
        let all = |code: &str| record.iter().filter(|p| p.0 == code).map(|p| p.1).collect::<Vec<_>>();
        let number = |code: &str| all(code).iter().map(|v| v.parse().unwrap()).collect::<Vec<f64>>();
        match (record[0].1, all("8").first()) {
            ("LINE", Some(&"WALLS")) => {
                walls.push([number("10")[0], number("20")[0], number("11")[0], number("21")[0]]);
            }
            ("LWPOLYLINE", Some(&"EF-MOVE")) => {
                let (x, y) = (number("10"), number("20"));
                let range = |v: &[f64]| v.iter().fold((f64::MAX, f64::MIN), |r, &x| (r.0.min(x), r.1.max(x)));
                boxes.push((range(&x), range(&y)));
            }
            _ => {}
        }
    }
    let inside = |x: f64, y: f64| boxes.iter().any(|&(h, v)| h.0 < x && x < h.1 && v.0 < y && y < v.1);
    let with_moving = |&w: &[f64; 4]| (w, inside(w[0], w[1]) || inside(w[2], w[3]));
    pieces(&walls.iter().map(with_moving).collect::<Vec<_>>())
}

#[test]
fn reference_plans_have_the_reference_penalties() {
    let Some(folder) = enfilade_fixtures::shared("reference") else { return };
    for name in ["maze_a", "simple_room", "large_room", "art_gallery"] {
        let read = |ext: &str| std::fs::read_to_string(folder.join(format!("{name}.{ext}"))).unwrap();
        let json: serde_json::Value = serde_json::from_str(&read("expected.json")).unwrap();
        let expected = &json.get("initial").map_or(&json, |i| &i[1])["penalty"];
        let walls = reference_pieces(&read("dxf"));
        let layout = Layout { pieces: &walls };
        assert_near(clearance_m2(&walls), expected["clearance"].as_f64().unwrap(), 1e-9);
        assert_near(wall_length::total_m(&layout), expected["wall_length"].as_f64().unwrap(), 1e-9);
        assert_eq!(WallLength::new(&layout).measure_m(&layout), 0.0);
        let none = Overlap::new(&layout).measure_m(&layout);
        assert!(none == 0.0 && none.is_sign_positive(), "{none}");
        assert_eq!(Alignment::new(&layout).measure_rad2(&layout), 0.0);
    }
}
