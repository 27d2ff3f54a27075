use proptest::prelude::*;

use super::*;
use crate::fixtures;

fn assert_equals_brute_force(lattice: &Lattice, obstacles: &Obstacles) {
    let graph = visibility_graph(lattice, obstacles);
    for u in 0..lattice.cells.len() {
        let mut neighbours = Vec::new();
        graph.for_each_neighbour(u as u32, |v| neighbours.push(v));
        neighbours.sort_unstable();
        let expected: Vec<u32> = (0..lattice.cells.len())
            .filter(|&v| fixtures::sees(lattice, obstacles, u, v))
            .map(|v| v as u32)
            .collect();
        let cell = lattice.cells[u];
        assert_eq!(neighbours, expected, "viewer {cell:?} of {lattice:?} {:?}", obstacles.segments);
        assert_eq!(graph.degree(u as u32) as usize, expected.len());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, max_shrink_iters: 4000, ..ProptestConfig::default() })]

    /// Walls on lattice lines, ends on centres, collinear, touching, 45°, points, a micrometre off.
    #[test]
    fn sweep_equals_pairwise_test((lattice, obstacles) in fixtures::plans()) {
        assert_equals_brute_force(&lattice, &obstacles);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, max_shrink_iters: 4000, ..ProptestConfig::default() })]

    /// All that meets a window of each group is seen through them, nothing that is not seen at all, and of what another layout
    /// shows the same.
    #[test]
    fn through_windows_all_is_seen_that_they_would_hide(
        (lattice, mut obstacles) in fixtures::plans(),
        counts in prop::collection::vec(1usize..3, 1..3),
    ) {
        let groups: Vec<Vec<Segment>> = counts.iter().map(|count| {
            let count = obstacles.segments.len().min(*count);
            obstacles.segments.split_off(obstacles.segments.len() - count)
        }).collect();
        let windows: Vec<Vec<Window>> =
            groups.iter().map(|g| g.iter().map(|s| vec![s.a, s.b]).collect()).collect();
        let windows: Vec<&[Window]> = windows.iter().map(Vec::as_slice).collect();
        let vista = Vista::new(lattice.clone().into(), obstacles.clone());
        let bare = vista.other(Obstacles { segments: vec![], blind: obstacles.blind.clone() });
        let [all, through, open] = [vista.graph(), vista.through(&windows), bare.through(&windows)];
        for u in 0..lattice.cells.len() as u32 {
            for v in 0..u {
                let [a, b] = [u, v].map(|x| lattice.centre_um(x as usize));
                let meets = groups.iter().all(|g| g.iter().any(|s| segments_touch(*s, Segment { a, b })));
                prop_assert!(!through.sees(u, v) || all.sees(u, v));
                prop_assert!(!(meets && all.sees(u, v)) || through.sees(u, v), "{u} {v} {windows:?}");
                prop_assert_eq!(through.sees(u, v), open.sees(u, v) && all.sees(u, v), "{} {} {:?}", u, v, &windows);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, max_shrink_iters: 4000, ..ProptestConfig::default() })]

    /// Walls that go, come, are cut on their own line and beside it, and cells that are covered.
    #[test]
    fn a_changed_layout_equals_its_own_graph(
        (lattice, obstacles) in fixtures::plans(),
        fates in prop::collection::vec((0u8..12, 0i64..5, -1i64..2), 60),
        blind in prop::collection::vec(0u32..40, 0..3),
    ) {
        prop_assume!(!lattice.cells.is_empty());
        let mut then = Obstacles { segments: vec![], blind: obstacles.blind.clone() };
        for (s, (fate, share, off)) in obstacles.segments.iter().zip(&fates) {
            let at = |share: i64, off: i64| [0, 1].map(|k| s.a[k] + (s.b[k] - s.a[k]) * share / 4 + off * k as i64);
            match fate {
                0 => {}
                1 => then.segments.push(Segment { a: at(*share, 0), b: s.b }),
                2 => then.segments.extend([Segment { a: s.a, b: at(*share, *off) }, Segment { a: at(*share, 0), b: s.b }]),
                3 => then.segments.extend([Segment { a: s.b, b: s.a }, Segment { a: s.a, b: at(*share, 9 * off) }]),
                _ => then.segments.push(*s),
            }
        }
        then.blind.extend(blind.into_iter().filter(|v| (*v as usize) < lattice.cells.len()));
        then.blind.sort_unstable();
        then.blind.dedup();
        let vista = Vista::new(lattice.clone().into(), obstacles);
        let found = vista.changed_where(&vista.graph(), &then);
        let whole = visibility_graph(&lattice, &then);
        prop_assert_eq!((found.start, found.entry_tile, found.entry_mask, found.degree),
            (whole.start, whole.entry_tile, whole.entry_mask, whole.degree));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn fractions_compare_exactly(a in -1000i128..1000, b in 1i128..50, c in -1000i128..1000, d in 1i128..50) {
        let (x, y) = (Fraction { num: a, den: b }, Fraction { num: c, den: d });
        prop_assert_eq!(x.compare(y), (a * d).cmp(&(c * b)));
        let big = 1i128 << 100;
        let (x, y) = (Fraction { num: a * big, den: b * big }, Fraction { num: c * big, den: d * big });
        prop_assert_eq!(x.compare(y), (a * d).cmp(&(c * b)));
    }
}

#[test]
fn lattices_beyond_the_limits_are_compared_pair_by_pair() {
    let far = crate::strips::MAX_COORDINATE_UM * 2;
    let wall = Segment { a: [-far, 15], b: [far, 15] };
    let cells = (0..4).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
    assert_equals_brute_force(
        &fixtures::lattice(10, [0, 0], cells),
        &Obstacles { segments: vec![wall], blind: vec![] },
    );
    let sparse = fixtures::lattice(10, [0, 0], vec![[0, 0], [i32::MAX, 5], [i32::MIN, 9], [4, i32::MAX]]);
    assert_equals_brute_force(&sparse, &Obstacles::default());
    assert_eq!(visibility_graph(&sparse, &Obstacles::default()).edge_count(), 6);
    let tall = fixtures::lattice(10, [0, 0], vec![[0, 0], [0, crate::strips::MAX_ROWS as i32]]);
    assert_equals_brute_force(&tall, &Obstacles::default());
    let wide = fixtures::lattice(10, [0, 0], vec![[0, 0], [(1 << 23) + 1, 0]]);
    assert_equals_brute_force(&wide, &Obstacles::default());
}

#[test]
fn no_vertices_no_graph() {
    let graph = visibility_graph(&fixtures::lattice(10, [0, 0], vec![]), &Obstacles::default());
    assert!(graph.is_empty());
    assert_eq!(graph.edge_count(), 0);
    assert!(graph.components().is_empty());
}

#[test]
fn edges_equal_depthmapx() {
    let Some((lattice, obstacles, _, rows)) = fixtures::n900() else { return };
    let graph = visibility_graph(&lattice, &obstacles);
    assert_eq!(graph.edge_count(), 27_839);
    let text =
        std::fs::read_to_string(fixtures::reference().unwrap().join("depthmapx-n900/edges.csv")).unwrap();
    let vertex = |reference: f64| rows.iter().position(|r| r[0] == reference).unwrap() as u32;
    let (_, edges) = fixtures::csv(&text);
    assert_eq!(edges.len(), 27_839);
    for edge in edges {
        assert!(graph.sees(vertex(edge[0]), vertex(edge[1])), "{edge:?}");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let Some((lattice, obstacles, ..)) = fixtures::n900() else { return };
    let serial = visibility_graph_serial(&lattice, &obstacles);
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let graph = pool.install(|| visibility_graph(&lattice, &obstacles));
        assert_eq!((graph.start, graph.entry_mask), (serial.start.clone(), serial.entry_mask.clone()));
        assert_eq!(graph.entry_tile, serial.entry_tile);
    }
}

#[test]
fn components_are_labelled_by_their_smallest_vertex() {
    let cells = (0..6).map(|c| [c, 0]).collect();
    let wall = Segment { a: [25, -5], b: [25, 5] };
    let obstacles = Obstacles { segments: vec![wall], blind: vec![4] };
    let graph = visibility_graph(&fixtures::lattice(10, [0, 0], cells), &obstacles);
    assert_eq!(graph.components(), [0, 0, 0, 3, 4, 3]);
}

/// Bytes of all that is made on the way to a graph, and of the graph.
fn bytes_made(lattice: &Lattice, obstacles: &Obstacles) -> usize {
    let tiles = Tiles::new(lattice);
    let strips = Strips::new(lattice, &tiles, obstacles).unwrap();
    let (mut sweep, mut squares) = (Sweep::new(&strips, &tiles), Vec::new());
    let halves: Vec<Half> = (0..tiles.count()).map(|t| sweep.half(t)).collect();
    let in_halves: u64 = halves.iter().map(|half| half.sizes()[0] * 64 * 8).sum();
    let halves = Halves::new(&tiles, halves);
    let chunks: Vec<RowChunk> = (0..tiles.count()).map(|t| halves.rows(t, &mut squares)).collect();
    let in_chunks: usize = chunks.iter().map(|c| c.tile.capacity() * 4 + c.mask.capacity() * 8).sum();
    let in_graph: usize = chunks.iter().map(|c| c.tile.len() * 12).sum();
    in_halves as usize + in_chunks + in_graph
}

/// What a graph takes is foreseen from some of its tiles, and what fits in any case is not looked at.
#[test]
fn memory_of_a_graph_is_foreseen() {
    let cells: Vec<[i32; 2]> = (0..200).flat_map(|c| (0..200).map(move |r| [c, r])).collect();
    let lattice = fixtures::lattice(10, [0, 0], cells);
    // Rooms of 40 × 40 cells.
    let wall = |k: i64, turned: bool| {
        let [a, b] = [[-5, 400 * k - 5], [1995, 400 * k - 5]];
        let turn = |p: [i64; 2]| if turned { [p[1], p[0]] } else { p };
        Segment { a: turn(a), b: turn(b) }
    };
    let rooms: Vec<Segment> = (0..=5).flat_map(|k| [wall(k, false), wall(k, true)]).collect();
    let mut taken = Vec::new();
    for (segments, is_open) in [(Vec::new(), true), (rooms, false)] {
        let obstacles = Obstacles { segments, blind: Vec::new() };
        let needed = bytes_beyond(&lattice, &obstacles, 1).unwrap();
        let made = bytes_made(&lattice, &obstacles);
        assert!((1.0..1.7).contains(&(needed as f64 / made as f64)), "{is_open}: {needed} for {made}");
        assert_eq!(bytes_beyond(&lattice, &obstacles, needed), None);
        assert_eq!(bytes_beyond(&lattice, &obstacles, needed - 1), Some(needed));
        taken.push(needed);
    }
    assert!(taken[0] > 10 * taken[1], "{taken:?}");
}

/// A hall of some metres each way with a screen every 25 m, at a spacing of 1.1 m.
fn mill(side: i64) -> (Lattice, Obstacles) {
    const M: i64 = 1_000_000;
    let mut segments = Vec::new();
    for i in (0..side).step_by(25) {
        for j in (0..side).step_by(25) {
            let pieces =
                [[i, j, i + 10, j], [i + 15, j, i + 25, j], [i, j, i, j + 10], [i, j + 15, i, j + 25]];
            segments.extend(pieces.map(|[a, b, c, d]| Segment { a: [a * M, b * M], b: [c * M, d * M] }));
        }
    }
    let spacing_um = 1_100_000;
    let n = (side * M / spacing_um) as i32;
    let cells = (0..n).flat_map(|c| (0..n).map(move |r| [c, r])).collect();
    (fixtures::lattice(spacing_um, [550_001, 550_003], cells), Obstacles { segments, blind: vec![] })
}

/// So with screens in a hall, where most tiles are seen in part.
#[test]
fn memory_of_a_mill_is_foreseen() {
    let (lattice, obstacles) = mill(150);
    let needed = bytes_beyond(&lattice, &obstacles, 1).unwrap();
    let made = bytes_made(&lattice, &obstacles);
    assert!((1.0..1.7).contains(&(needed as f64 / made as f64)), "{needed} for {made}");
}
