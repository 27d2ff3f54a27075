use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

use super::forest::{CardForest, LEVELS_PER_SUBMISSION, MATRIX_BYTES_MAX, ORDINATE_UM_MAX, Shape};
use super::*;
use crate::Lattice;
use crate::evaluator::Evaluator;
use crate::fixtures;
use crate::visibility::visibility_graph;

/// Whatever adapter there is; in CI there must be one.
fn adapter() -> Option<Arc<Gpu>> {
    match Gpu::shared(true) {
        Ok(gpu) => Some(gpu),
        Err(why) => {
            assert!(std::env::var_os("CI").is_none(), "{why}");
            eprintln!("skipped: {why}");
            None
        }
    }
}

#[test]
fn loops_stay_below_the_limit() {
    // 65,535 is where Mesa stops them.
    const { assert!(LOOP_ITERATIONS_MAX < 65_535) };
    // The walls, and 32 cells for each; the words of a block, and 32 rows for each.
    const { assert!(SEGMENTS_PER_PASS + SEGMENTS_PER_PASS * 32 <= LOOP_ITERATIONS_MAX) };
    const { assert!(ROWS_PER_PASS / 32 + ROWS_PER_PASS <= LOOP_ITERATIONS_MAX) };
    // The start-up test needs more in all than an adapter may stop at.
    const { assert!(TEST_SEGMENTS * 33 > 65_535) };
    let shape = Shape::new(3_000_000, 10, 1, 1 << 40, u32::MAX);
    assert_eq!(shape.rows, ROWS_PER_PASS);
}

#[test]
fn parameters_lie_where_the_shaders_read_them() {
    let module = wgpu::naga::front::wgsl::parse_str(PARAMS_WGSL).unwrap();
    let (_, found) = module.types.iter().find(|t| t.1.name.as_deref() == Some("Params")).unwrap();
    let wgpu::naga::TypeInner::Struct { members, span } = &found.inner else { panic!("not a struct") };
    let read: Vec<(&str, u32)> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset)).collect();
    macro_rules! written {
        ($($field:ident)*) => { vec![$((stringify!($field), std::mem::offset_of!(Params, $field) as u32)),*] };
    }
    let written = written!(words first_row rows first_segment segments is_first layouts roots first_root
        level slot_before slot vertices);
    assert_eq!(read, written);
    assert_eq!(*span as usize, size_of::<Params>());
    const { assert!(size_of::<Params>() <= PARAMS_STRIDE) };
    for (name, source, _) in STAGES {
        assert!(source.contains(&format!("@workgroup_size({GROUP})")), "{name}");
    }
}

#[test]
fn a_matrix_that_is_too_large_stays_on_the_cores() {
    let Some(gpu) = adapter() else { return };
    let n = 140_000;
    const { assert!(140_000 * 140_000 / 8 > MATRIX_BYTES_MAX) };
    let lattice = Lattice {
        spacing_um: 1_000_000,
        origin_um: [0, 0],
        cells: (0..n).map(|i| [i % 400, i / 400]).collect(),
        query: vec![0],
        is_reference: vec![true; n as usize],
        beyond: None,
    };
    let why = CardForest::new(gpu, Arc::new(lattice), &[], None, 1).err().unwrap();
    assert!(why.contains("140000 cells"), "{why}");
}

proptest! {
    #[test]
    fn no_buffer_passes_the_limit(
        n in 1u32..300_000,
        roots in 1u32..300_000,
        layouts in 1u32..40,
        mebibytes in 8u64..4096,
    ) {
        let bytes = mebibytes << 20;
        let shape = Shape::new(n, roots.min(n), layouts, bytes, 65_535);
        let row = u64::from(shape.words) * 4;
        prop_assert!(u64::from(shape.layouts) * u64::from(shape.rows) * row <= bytes);
        prop_assert!(u64::from(shape.layouts) * u64::from(shape.roots) * row <= bytes);
        prop_assert!((shape.roots * shape.words).div_ceil(GROUP) <= 65_535);
        prop_assert!(shape.rows.is_multiple_of(32) && shape.rows <= ROWS_PER_PASS);
        let rows: u32 = shape.blocks().map(|b| b.1).sum();
        prop_assert_eq!(rows, n);
        prop_assert!(shape.layouts == 1 || shape.blocks().count() == 1);
    }
}

/// The card's graph and tally of one layout against the cores'.
fn compare(
    gpu: &Arc<Gpu>,
    lattice: Lattice,
    obstacles: Obstacles,
    rows: Option<u32>,
) -> Result<(), TestCaseError> {
    let n = lattice.cells.len() as u32;
    if n == 0 {
        return Ok(());
    }
    let lattice = Arc::new(lattice);
    let mut shape = Shape::new(n, lattice.query.len() as u32, 1, 1 << 27, 65_535);
    if let Some(rows) = rows {
        (shape.rows, shape.roots) = (rows.min(shape.words * 32), 7);
    }
    let on_card =
        |fixed: &[Segment]| CardForest::with_shape(Arc::clone(gpu), Arc::clone(&lattice), fixed, None, shape);
    let graph = visibility_graph(&lattice, &obstacles);
    let expected = tally(&lattice, &graph, None);
    let found = on_card(&[]).and_then(|f| f.tallies(std::slice::from_ref(&obstacles)));
    prop_assert_eq!(found, Ok(vec![expected]), "{:?} {:?}", &obstacles, shape);
    let unblind = Obstacles { blind: vec![], ..obstacles };
    let graph = visibility_graph(&lattice, &unblind);
    let found = on_card(&unblind.segments).and_then(|f| f.fixed_graph()).map_err(TestCaseError::fail)?;
    prop_assert_eq!(&found.entry_tile, &graph.entry_tile);
    prop_assert_eq!(&found.entry_mask, &graph.entry_mask);
    prop_assert_eq!(found.degree, graph.degree);
    Ok(())
}

/// Walls on lattice lines, ends on centres, collinear, touching, 45°, points, a micrometre off; in one
/// block and in several.
#[test]
fn degenerate_plans_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let mut runner =
        proptest::test_runner::TestRunner::new(ProptestConfig { cases: 300, ..Default::default() });
    let blocks = prop_oneof![Just(None), Just(Some(32))];
    let plans = (fixtures::plans(), blocks);
    runner.run(&plans, |((lattice, obstacles), rows)| compare(&gpu, lattice, obstacles, rows)).unwrap();
}

/// Coordinates as large as the card takes them: products of nearly 2^62.
#[test]
fn the_largest_plans_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let far = ORDINATE_UM_MAX - 3;
    let s = 2 * far / 6;
    let cells = (0..7).flat_map(|c| (0..7).map(move |r| [c, r])).collect();
    let lattice = fixtures::lattice(s, [-3 * s, -3 * s], cells);
    let wall = |a: [i64; 2], b: [i64; 2]| Segment { a, b };
    let diagonal = |off: i64| wall([-far, -far + off], [far - off, far]);
    for segments in [
        vec![diagonal(0)],
        vec![diagonal(1)],
        vec![diagonal(2), wall([-far, far], [far, -far + 1])],
        vec![wall([-far, 1], [far, 2]), wall([s / 2 - 1, -far], [s / 2, far])],
        vec![wall([-s + 1, -2 * s], [2 * s, s + 1]), wall([0, 0], [0, 0])],
    ] {
        compare(&gpu, lattice.clone(), Obstacles { segments, blind: vec![] }, None).unwrap();
    }
    let beyond = [Segment { a: [-2 * far, 0], b: [0, 5] }];
    let refused = CardForest::new(gpu, Arc::new(lattice), &beyond, None, 1);
    assert!(refused.is_err_and(|why| why.contains("more than 1073 m")));
}

#[test]
fn plans_above_the_loop_limit_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let (lattice, obstacles) = test_plan();
    assert!(obstacles.segments.len() as u32 > SEGMENTS_PER_PASS);
    let graph = visibility_graph(&lattice, &obstacles);
    let fewer = Obstacles {
        segments: obstacles.segments[..SEGMENTS_PER_PASS as usize].to_vec(),
        ..obstacles.clone()
    };
    assert_ne!(graph.edge_count(), visibility_graph(&lattice, &fewer).edge_count(), "the last walls decide");
    let forest = CardForest::new(gpu, Arc::clone(&lattice), &[], None, 1).unwrap();
    assert_eq!(forest.tallies(&[obstacles]).unwrap(), [tally(&lattice, &graph, None)]);
}

#[test]
fn trees_deeper_than_a_submission_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let cells: Vec<[i32; 2]> = (0..120).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
    let wall = |i: i64| {
        let (lo, hi) = if i % 2 == 0 { (-1, 25) } else { (5, 31) };
        Segment { a: [i * 10 + 5, lo], b: [i * 10 + 5, hi] }
    };
    let lattice = fixtures::lattice(10, [0, 0], cells);
    let obstacles = Obstacles { segments: (0..119).map(wall).collect(), blind: vec![] };
    let graph = visibility_graph(&lattice, &obstacles);
    let deepest = tally(&lattice, &graph, None).depth.into_iter().max();
    assert!(deepest > Some(2 * LEVELS_PER_SUBMISSION));
    compare(&gpu, lattice, obstacles, Some(64)).unwrap();
}

/// A population on the card against one layout after the other on the cores, cut-off vertices included.
#[test]
fn a_population_equals_the_cores() {
    let Some(gpu) = adapter() else { return };
    let cells: Vec<[i32; 2]> = (0..13).flat_map(|c| (0..11).map(move |r| [c, r])).collect();
    let mut lattice = fixtures::lattice(12, [0, 0], cells);
    lattice.query.retain(|v| v % 3 != 1);
    lattice.is_reference.iter_mut().enumerate().for_each(|(v, r)| *r = v % 5 != 2);
    let fixed = [Segment { a: [42, -5], b: [42, 90] }, Segment { a: [42, 90], b: [100, 92] }];
    let layout = |k: i64| Obstacles {
        segments: vec![
            Segment { a: [42, 90 + k], b: [42, 200] },
            Segment { a: [60 + 6 * k, -9], b: [60 + 6 * k, 30 + 12 * k] },
        ],
        blind: if k % 3 == 0 { vec![5, 77] } else { vec![] },
    };
    let mut evaluator = Evaluator::new(Arc::new(lattice), &fixed, &layout(4), None);
    let layouts: Vec<Obstacles> = (0..9).map(layout).collect();
    let mut scratch = evaluator.scratch();
    let expected: Vec<_> = layouts.iter().map(|l| evaluator.evaluate(l, &mut scratch)).collect();
    assert!(expected.iter().any(|t| t.disconnected > 0) && expected.iter().any(|t| t.disconnected == 0));
    assert!(evaluator.evaluate_on_card(&layouts).is_none());
    evaluator.attach(gpu, &layout(4), 4).unwrap();
    assert_eq!(evaluator.evaluate_on_card(&layouts), Some(Ok(expected)));
}
