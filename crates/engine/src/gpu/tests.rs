use proptest::prelude::*;
use proptest::test_runner::{TestCaseError, TestRunner};

use super::forest::CardForest;
use super::shape::{Extent, LEVELS_MAX, SLOTS, SQUARE, SUMS, Shape, step_iterations};
use super::store::ORDINATE_UM_MAX;
use super::*;
use crate::Tally;
use crate::evaluator::Evaluator;
use crate::fixtures;
use crate::forest::{Initial, tally_of};
use crate::geometry::Segment;
use crate::graph::Graph;
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
    const { assert!(SEGMENTS_PER_PASS * (1 + 2 * 64) <= LOOP_ITERATIONS_MAX) };
    // The start-up test needs more in all than an adapter may stop at.
    const { assert!(TEST_SEGMENTS * 129 > 65_535) };
    let most = u64::from(LOOP_ITERATIONS_MAX);
    for (row, near) in [(1, 1), (20, 40), (300, 400), (20_000, 20_000)] {
        let of = Extent { tiles: near, roots: 1, squares: 1, row, near };
        let shape = Shape::new(of, 1, (1 << 30, most)).unwrap();
        assert!(step_iterations(of, shape.pass_squares) <= most, "{row} {near}");
        assert!(shape.pass_squares * shape.passes >= row && shape.pass_squares <= row);
    }
    let hall = Extent { tiles: 30_000, roots: 1, squares: 1, row: 30_000, near: 30_000 };
    assert_eq!(Shape::new(hall, 1, (1 << 30, u64::MAX)).unwrap().passes, 1);
    assert!(Shape::new(hall, 1, (1 << 30, most)).is_err_and(|why| why.contains("see 30000 tiles")));
}

#[test]
fn numbers_are_those_of_the_shaders() {
    let module = wgpu::naga::front::wgsl::parse_str(PARAMS_WGSL).unwrap();
    let (_, found) = module.types.iter().find(|t| t.1.name.as_deref() == Some("Params")).unwrap();
    let wgpu::naga::TypeInner::Struct { members, span } = &found.inner else { panic!("not a struct") };
    let read: Vec<(&str, u32)> = members.iter().map(|m| (m.name.as_deref().unwrap(), m.offset)).collect();
    macro_rules! written {
        ($($field:ident)*) => { vec![$((stringify!($field), std::mem::offset_of!(Params, $field) as u32)),*] };
    }
    let written = written!(vertices tiles layouts first_tile block_tiles squares squares_at roots first_root
        all_roots words level first_square pass_squares is_last slot first_segment segments spacing);
    assert_eq!(read, written);
    assert_eq!(*span as usize, size_of::<Params>());
    const { assert!(size_of::<Params>() <= PARAMS_STRIDE) };
    for (name, number) in [("LINE", LINE), ("SLOTS", SLOTS), ("SUMS", SUMS), ("SQUARE", SQUARE as u64)] {
        assert!(PARAMS_WGSL.contains(&format!("const {name}: u32 = {number}u;")), "{name}");
    }
    for (name, source, _) in STAGES {
        assert!(source.contains(&format!("@workgroup_size({GROUP})")), "{name}");
    }
}

proptest! {
    #[test]
    fn no_buffer_passes_the_limit(
        tiles in 1u32..20_000,
        roots in 1u32..1_000_000,
        squares in 1u64..300_000,
        layouts in 1u32..80,
        mebibytes in 32u64..4096,
    ) {
        let bytes = mebibytes << 20;
        let of = Extent { tiles, roots, squares, row: 9, near: 30 };
        let shape = Shape::new(of, layouts, (bytes, u64::MAX)).unwrap();
        let words = u64::from(shape.layouts) * u64::from(shape.words);
        prop_assert!((1..=layouts).contains(&shape.layouts) && shape.words >= 1);
        prop_assert!(words * u64::from(tiles) * SLOTS * 4 <= bytes);
        prop_assert!(words * 32 * u64::from(shape.levels + 1) * 4 <= bytes);
        prop_assert!(shape.layouts == 1 || u64::from(shape.layouts) * squares * SQUARE as u64 * 8 <= bytes);
        prop_assert!(shape.layouts == 1 || shape.roots() >= roots);
        prop_assert!((2..=LEVELS_MAX).contains(&shape.levels));
        let [x, y, z] = groups(u64::from(tiles) * u64::from(shape.words), shape.layouts);
        prop_assert!(x.max(y).max(z) <= 65_535);
        prop_assert!(u64::from(x) * u64::from(GROUP) * u64::from(z) >= u64::from(tiles) * u64::from(shape.words));
    }
}

/// How a small plan is cut, so that all passes are taken: bytes of a buffer, and squares of a pass.
#[derive(Clone, Copy, Debug)]
struct Cut {
    bytes: u64,
    squares: u32,
}

const WHOLE: Cut = Cut { bytes: 1 << 27, squares: u32::MAX };

fn on_card(
    gpu: &Arc<Gpu>,
    lattice: &Arc<Lattice>,
    graph: &Graph,
    components: Option<&[u32]>,
    (layouts, cut): (u32, Cut),
) -> Result<CardForest, String> {
    let by = |shape: Shape| {
        let pass_squares = shape.pass_squares.min(cut.squares);
        let passes = (shape.pass_squares * shape.passes).div_ceil(pass_squares);
        Shape { pass_squares, passes, ..shape }
    };
    CardForest::with_bytes(Arc::clone(gpu), Arc::clone(lattice), graph, components, (layouts, cut.bytes), by)
}

/// Tallies of layouts on the card and on the cores; the first layout is the present one.
fn compare(
    gpu: &Arc<Gpu>,
    lattice: &Arc<Lattice>,
    fixed: &[Segment],
    layouts: &[Obstacles],
    cut: Cut,
) -> Result<(), TestCaseError> {
    let whole = |layout: &Obstacles| Obstacles {
        segments: [fixed, &layout.segments].concat(),
        blind: layout.blind.clone(),
    };
    let components = visibility_graph(lattice, &whole(&layouts[0])).components();
    let expected: Vec<Tally> = layouts
        .iter()
        .map(|layout| {
            let initial = Initial { components: &components, covered: &layout.blind };
            tally_of(lattice, &visibility_graph(lattice, &whole(layout)), None, Some(initial))
        })
        .collect();
    let unmoved = visibility_graph(lattice, &Obstacles { segments: fixed.to_vec(), blind: vec![] });
    let forest = on_card(gpu, lattice, &unmoved, Some(&components), (layouts.len() as u32, cut));
    let found = forest.and_then(|f| f.tallies(layouts));
    prop_assert_eq!(found, Ok(expected), "{:?} {:?} {:?}", fixed, layouts, cut);
    Ok(())
}

/// Walls on lattice lines, ends on centres, collinear, touching, 45°, points, a micrometre off, shared out between those
/// that stay and those that move by layout; solids; parts of the cells as regions; in one block and pass and in several.
#[test]
fn degenerate_plans_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let mut runner = TestRunner::new(ProptestConfig { cases: 300, ..Default::default() });
    let cut = prop_oneof![
        Just(WHOLE),
        Just(Cut { bytes: 4096, squares: 1 }),
        Just(Cut { bytes: 9000, squares: 2 })
    ];
    let plans = (fixtures::plans(), any::<u64>(), 1u32..4, 1u32..4, cut);
    runner
        .run(&plans, |((mut lattice, obstacles), share, every, layouts, cut)| {
            lattice.query.retain(|v| v.wrapping_add(share as u32).is_multiple_of(every));
            prop_assume!(!lattice.query.is_empty());
            lattice.is_reference.iter_mut().enumerate().for_each(|(v, r)| *r = v % 5 != 2);
            let stands = |layout: u32, wall: usize| share.rotate_left(7 * layout + wall as u32) & 3 == 0;
            let part = |layout: u32| -> Vec<Segment> {
                let chosen = obstacles.segments.iter().enumerate().filter(|(i, _)| stands(layout, *i));
                chosen.map(|(_, s)| *s).collect()
            };
            let blind = |layout: u32| -> Vec<u32> {
                obstacles.blind.iter().copied().filter(|v| (v + layout).is_multiple_of(2)).collect()
            };
            let moving: Vec<Obstacles> =
                (1..=layouts).map(|l| Obstacles { segments: part(l), blind: blind(l) }).collect();
            compare(&gpu, &Arc::new(lattice), &part(0), &moving, cut)
        })
        .unwrap();
}

/// Mazes of some hundred cells: many tiles, areas that are cut off in one layout and not in the other.
#[test]
fn mazes_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let mut runner = TestRunner::new(ProptestConfig { cases: 12, ..Default::default() });
    let cut = prop_oneof![Just(WHOLE), Just(Cut { bytes: 40_000, squares: 3 })];
    runner
        .run(&(fixtures::mazes(30), cut, 1usize..60), |((lattice, obstacles), cut, moving)| {
            let stays = obstacles.segments.len().saturating_sub(moving);
            let (fixed, moving) = obstacles.segments.split_at(stays);
            let layout = |segments: &[Segment], blind: &[u32]| Obstacles {
                segments: segments.to_vec(),
                blind: blind.to_vec(),
            };
            let half = moving.len() / 2;
            let layouts =
                [layout(moving, &[3]), layout(&moving[..half], &[]), layout(&moving[half..], &[7, 9])];
            compare(&gpu, &Arc::new(lattice), fixed, &layouts, cut)
        })
        .unwrap();
}

/// Coordinates as large as the card takes them where walls move: products of nearly 2^62.
#[test]
fn the_largest_plans_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let far = ORDINATE_UM_MAX - 3;
    let s = 2 * far / 9;
    let cells = (0..7).flat_map(|c| (0..7).map(move |r| [c, r])).collect();
    let lattice = Arc::new(fixtures::lattice(s, [-3 * s, -3 * s], cells));
    let wall = |a: [i64; 2], b: [i64; 2]| Segment { a, b };
    let diagonal = |off: i64| wall([-far, -far + off], [far - off, far]);
    for segments in [
        vec![diagonal(0)],
        vec![diagonal(1)],
        vec![diagonal(2), wall([-far, far], [far, -far + 1])],
        vec![wall([-far, 1], [far, 2]), wall([s / 2 - 1, -far], [s / 2, far])],
        vec![wall([-s + 1, -2 * s], [2 * s, s + 1]), wall([0, 0], [0, 0])],
    ] {
        compare(&gpu, &lattice, &[], &[Obstacles { segments, blind: vec![] }], WHOLE).unwrap();
    }
    let open = visibility_graph(&lattice, &Obstacles::default());
    let forest = CardForest::new(Arc::clone(&gpu), Arc::clone(&lattice), &open, None, 1).unwrap();
    let beyond = Obstacles { segments: vec![wall([-2 * far, 0], [0, 5])], blind: vec![] };
    assert!(forest.tallies(&[beyond]).is_err_and(|why| why.contains("more than 1073 m")));
    // What does not move may reach as far as it likes.
    let cells = (0..40).flat_map(|c| (0..3).map(move |r| [c, r])).collect();
    let wide = Arc::new(fixtures::lattice(1 << 29, [5, 7], cells));
    let fixed = [wall([3 << 30, -9], [3 << 30, 1 << 29]), wall([9 << 30, 1 << 28], [9 << 30, 1 << 34])];
    compare(&gpu, &wide, &fixed, &[Obstacles::default()], WHOLE).unwrap();
}

#[test]
fn plans_above_the_loop_limit_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let (lattice, obstacles) = test_plan();
    assert!(obstacles.segments.len() as u32 > SEGMENTS_PER_PASS);
    let edges = |segments: &[Segment]| {
        let some = Obstacles { segments: segments.to_vec(), ..obstacles.clone() };
        visibility_graph(&lattice, &some).edge_count()
    };
    let all = &obstacles.segments;
    assert_ne!(edges(all), edges(&all[..SEGMENTS_PER_PASS as usize]), "the last walls decide");
    compare(&gpu, &lattice, &[], &[obstacles], WHOLE).unwrap();
}

#[test]
fn trees_deeper_than_a_submission_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let cells: Vec<[i32; 2]> = (0..300).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
    let wall = |i: i64| {
        let (lo, hi) = if i % 2 == 0 { (-1, 25) } else { (5, 31) };
        Segment { a: [i * 10 + 5, lo], b: [i * 10 + 5, hi] }
    };
    let mut lattice = fixtures::lattice(10, [0, 0], cells);
    lattice.query.retain(|v| v % 40 == 0);
    let lattice = Arc::new(lattice);
    let fixed: Vec<Segment> = (0..299).map(wall).collect();
    let graph = visibility_graph(&lattice, &Obstacles { segments: fixed.clone(), blind: vec![] });
    let deepest = tally(&lattice, &graph, None).depth.into_iter().max();
    assert!(deepest > Some(2 * LEVELS_MAX));
    let shut = Segment { a: [1505, -1], b: [1505, 31] };
    let layouts = [vec![], vec![shut]].map(|segments| Obstacles { segments, blind: vec![] });
    compare(&gpu, &lattice, &fixed, &layouts, WHOLE).unwrap();
}

/// A matrix of so many cells would take 200 MB; and a hall where nothing stands takes several passes.
#[test]
fn large_lattices_equal_the_cores() {
    let Some(gpu) = adapter() else { return };
    let (mut lattice, obstacles) = fixtures::rooms(25, 29);
    assert!(lattice.cells.len() > 40_000);
    lattice.query.retain(|v| v % 4999 == 7);
    compare(&gpu, &Arc::new(lattice), &obstacles.segments, &[Obstacles::default()], WHOLE).unwrap();
    let cells = (0..80).flat_map(|c| (0..80).map(move |r| [c, r])).collect();
    let mut hall = fixtures::lattice(10, [0, 0], cells);
    hall.query.retain(|v| v % 601 == 7);
    let screens = [Segment { a: [300, 205], b: [305, 600] }, Segment { a: [115, 400], b: [555, 395] }];
    let layouts = [0, 1].map(|i| Obstacles { segments: screens[i..].to_vec(), blind: vec![44] });
    let open = visibility_graph(&hall, &Obstacles::default());
    let hall = Arc::new(hall);
    let forest = on_card(&gpu, &hall, &open, None, (2, WHOLE)).unwrap();
    assert!(forest.shape().passes > 1);
    compare(&gpu, &hall, &[], &layouts, WHOLE).unwrap();
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
    let lattice = Arc::new(lattice);
    let mut evaluator = Evaluator::new(Arc::clone(&lattice), &fixed, &layout(4), None);
    let walked = Evaluator::on_card(&gpu, lattice, &fixed, &layout(4)).unwrap();
    assert_eq!(walked.initial(), evaluator.initial());
    let layouts: Vec<Obstacles> = (0..9).map(layout).collect();
    let mut scratch = evaluator.scratch();
    let expected: Vec<_> = layouts.iter().map(|l| evaluator.evaluate(l, &mut scratch)).collect();
    assert!(expected.iter().any(|t| t.disconnected > 0) && expected.iter().any(|t| t.disconnected == 0));
    assert!(evaluator.evaluate_on_card(&layouts).is_none());
    evaluator.attach(gpu, &layout(4), 4).unwrap();
    assert_eq!(evaluator.evaluate_on_card(&layouts), Some(Ok(expected)));
}
