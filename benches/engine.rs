//! Thread-CPU times of the spatial engine, beside a plain pairwise-and-queue baseline in the same run.
//!
//! `cargo bench --bench engine [-- FILTER]`; `-- stars` compares stars with waves, `-- million` takes a million
//! vertices. Plans come from `../shared/reference` (or the folder named
//! by ENFILADE_SHARED) where it is there, otherwise from the generator below.
//!
//! Where ENFILADE_PEER names a command, it measures the same plans in the same run (name the plans: a peer
//! may take hours). It is called as
//!
//! ```text
//! COMMAND STEP PLAN.dxf SPACING X,Y
//! ```
//!
//! once for each STEP (`graph`, `global`, `local`, `isovist`, `metric`, `angular`) with a drawing of lines in
//! metres on layer WALLS, the spacing of the cells in metres and the point to fill from. It makes the
//! graph, does the step, prints the number of its cells last, and ends with 0, or with another status for a step it
//! does not have. Its user CPU seconds count, those of `graph` alone taken off the other steps. `scripts/peer-depthmapx`
//! is such a command for depthmapXcli.

#![allow(clippy::expect_used)]

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use enfilade_engine::evaluator::Evaluator;
use enfilade_engine::geometry::{Segment, segments_touch};
use enfilade_engine::paths::{Paths, Turning};
use enfilade_engine::visibility::{Graph, visibility_graph};
use enfilade_engine::{Lattice, Obstacles, forest, isovist, measures, sampled};
use rayon::prelude::*;
use rustix::time::{ClockId, clock_gettime};

/// Plans up to this size are also measured with the baseline.
const BASELINE_LIMIT: usize = 3_000;

fn main() {
    let filter: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wanted = |name: &str| filter.is_empty() || filter.iter().any(|f| name.contains(f.as_str()));
    println!("one thread: thread-CPU seconds, median; wall: wall-clock seconds on 2 threads");
    println!(
        "{:<28}{:>8}{:>8} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}",
        "plan", "N", "degree", "graph", "global", "local", "sum", "wall", "peak MB"
    );
    for (name, metres, spacing_um) in [
        ("b40", 40, 1_333_300),
        ("b67", 67, 1_333_300),
        ("b133", 133, 1_333_300),
        ("b40 dense", 40, 400_000),
        ("b40 local", 40, 800_000),
        ("b267", 267, 1_333_300),
        ("b421 generated", 421, 1_333_300),
    ] {
        if wanted(name) {
            plan_row(name, metres, spacing_um);
        }
    }
    for (name, metres, spacing_um) in
        [("b40", 40, 1_333_300), ("b67", 67, 1_333_300), ("b133", 133, 1_333_300)]
    {
        if wanted(name) {
            polygon_and_path_row(name, metres, spacing_um);
        }
    }
    if filter.iter().any(|f| f == "stars") {
        star_rows();
    }
    if filter.iter().any(|f| f == "million") {
        million_row();
    }
    if wanted("tate") {
        tate_row();
    }
    if wanted("art_gallery") {
        evaluation_row();
    }
}

/// Isovists; metric and angular paths where they do not take minutes.
fn polygon_and_path_row(name: &str, metres: i64, spacing_um: i64) {
    let walls = shared_walls(&format!("bench/b{metres}_r12.dxf")).unwrap_or_else(|| building(metres));
    let lattice = flood(&walls, spacing_um, [2_000_000, 2_000_000]);
    let obstacles = Obstacles { segments: walls, blind: vec![] };
    let n = lattice.cells.len();
    let one = pool(1);
    let (isovist_secs, _) = median(&one, 3, || isovist::isovist_columns(&lattice, &obstacles));
    print!("{name:<28}{n:>8} isovist {isovist_secs:.4}");
    if n <= 3_000 {
        let graph = visibility_graph(&lattice, &obstacles);
        let paths = Paths::new(&lattice, &graph, &obstacles, Turning::AtWalls);
        let (metric_secs, _) = median(&one, 1, || paths.metric_columns(None));
        let (angular_secs, _) = median(&one, 1, || paths.angular_columns(None));
        println!(" metric {metric_secs:.3} angular {angular_secs:.3}");
        let ours = [("isovist", isovist_secs), ("metric", metric_secs), ("angular", angular_secs)];
        peer_row(&obstacles.segments, spacing_um, n, &ours);
    } else {
        println!();
        peer_row(&obstacles.segments, spacing_um, n, &[("isovist", isovist_secs)]);
    }
}

/// Depths of all as they are computed, and by waves alone, in turns on one thread; the least of three. Values are equal,
/// or it ends.
fn star_rows() {
    let b =
        |metres: i64| shared_walls(&format!("bench/b{metres}_r12.dxf")).unwrap_or_else(|| building(metres));
    let plans = [
        ("rooms 170", rooms(170), 1_333_300),
        ("rooms 200", rooms(200), 1_333_300),
        ("b133 at 0.8", b(133), 800_000),
        ("b67 at 0.4", b(67), 400_000),
        ("city 140", city(140), 1_000_000),
        ("b267", b(267), 1_333_300),
        ("rooms 421", rooms(421), 1_333_300),
        ("b421 generated", building(421), 1_333_300),
        ("b133 at 0.4", b(133), 400_000),
        ("city 300", city(300), 1_000_000),
    ];
    let one = pool(1);
    for (name, walls, spacing_um) in plans {
        let lattice = flood(&walls, spacing_um, [2_000_000, 2_000_000]);
        let obstacles = Obstacles { segments: walls, blind: vec![] };
        let graph = one.install(|| visibility_graph(&lattice, &obstacles));
        let n = graph.len();
        let (mut waves_secs, mut secs) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..if n < 50_000 { 3 } else { 1 } {
            let (by_waves, waves) = median(&one, 1, || forest::levels_by_waves(&graph, &lattice.query));
            let (by_any, tally) = median(&one, 1, || forest::tally(&lattice, &graph, None));
            assert!(waves.concat() == tally.levels, "{name}: stars and waves disagree");
            (waves_secs, secs) = (waves_secs.min(by_waves), secs.min(by_any));
        }
        println!(
            "stars: {name:<16}{n:>8} vertices, degree {:>8.1}: waves {waves_secs:.4} now {secs:.4}, {:.2} times as fast",
            2.0 * graph.edge_count() as f64 / n as f64,
            waves_secs / secs
        );
    }
}

/// Tate Britain as drawn (every line stops sight, one unit is taken for a metre): local, global and isovist.
fn tate_row() {
    let Some(text) = shared_text("../data/dxf/gallery_depthmapx.dxf") else {
        println!("tate: the drawing is not here, skipped");
        return;
    };
    let (lines, rings) = entities(&text);
    let of_ring = |r: OnLayer<Ring>| r.1.windows(2).map(|w| Segment { a: w[0], b: w[1] }).collect::<Vec<_>>();
    let walls: Vec<Segment> =
        lines.into_iter().map(|l| l.1).chain(rings.into_iter().flat_map(of_ring)).collect();
    let lattice = flood(&walls, 40_000, [3_000_000, 6_300_000]);
    let obstacles = Obstacles { segments: walls, blind: vec![] };
    let one = pool(1);
    let (graph_secs, graph) = median(&one, 9, || visibility_graph(&lattice, &obstacles));
    let (global_secs, _) = median(&one, 9, || forest::tally(&lattice, &graph, None));
    let (local_secs, _) = median(&one, 9, || measures::local_columns(&lattice, &graph));
    let (isovist_secs, _) = median(&one, 9, || isovist::isovist_columns(&lattice, &obstacles));
    println!(
        "tate: {} vertices, degree {:.1}: graph {graph_secs:.4} global {global_secs:.4} local {local_secs:.4} isovist {isovist_secs:.4}, all {:.4}",
        graph.len(),
        2.0 * graph.edge_count() as f64 / graph.len() as f64,
        graph_secs + global_secs + local_secs + isovist_secs
    );
}

/// A million vertices: the graph, and global measures from 5,120 sampled roots; wall-clock seconds.
fn million_row() {
    let walls = building(1_330);
    let lattice = flood(&walls, 1_333_300, [2_000_000, 2_000_000]);
    let obstacles = Obstacles { segments: walls, blind: vec![] };
    let started = Instant::now();
    let graph = visibility_graph(&lattice, &obstacles);
    let graph_secs = started.elapsed().as_secs_f64();
    let columns = sampled::sampled_columns(&graph, 5_120, 1).columns;
    println!(
        "million{:>29} vertices, degree {:.1}: graph {graph_secs:.2} s wall, with sampled measures {:.2} s wall, peak {} MB, first interval {:.3}",
        graph.len(),
        2.0 * graph.edge_count() as f64 / graph.len() as f64,
        started.elapsed().as_secs_f64(),
        peak_mb(),
        columns[7].values[0]
    );
}

fn plan_row(name: &str, metres: i64, spacing_um: i64) {
    let walls = shared_walls(&format!("bench/b{metres}_r12.dxf")).unwrap_or_else(|| building(metres));
    let lattice = flood(&walls, spacing_um, [2_000_000, 2_000_000]);
    let obstacles = Obstacles { segments: walls, blind: vec![] };
    let n = lattice.cells.len();
    let repeats = (200_000 / n.max(1)).clamp(1, 15);
    let one = pool(1);
    let (graph_secs, graph) = median(&one, repeats, || visibility_graph(&lattice, &obstacles));
    let (global_secs, tally) = median(&one, repeats, || forest::tally(&lattice, &graph, None));
    let (local_secs, _) = median(&one, repeats.min(5), || measures::local_columns(&lattice, &graph));
    let two = pool(2);
    let started = Instant::now();
    two.install(|| {
        let graph = visibility_graph(&lattice, &obstacles);
        forest::tally(&lattice, &graph, None)
    });
    let wall_secs = started.elapsed().as_secs_f64();
    let degree = 2.0 * graph.edge_count() as f64 / n as f64;
    println!(
        "{name:<28}{n:>8}{degree:>8.1} {graph_secs:>9.4} {global_secs:>9.4} {local_secs:>9.4} {:>9.4} {wall_secs:>9.4} {:>9}",
        graph_secs + global_secs,
        peak_mb()
    );
    let ours = [("graph", graph_secs), ("global", global_secs), ("local", local_secs)];
    peer_row(&obstacles.segments, spacing_um, n, &ours);
    if n <= BASELINE_LIMIT {
        baseline_row(&lattice, &obstacles, &graph, &tally, graph_secs + global_secs);
    }
}

/// The command of ENFILADE_PEER beside our seconds, step by step.
fn peer_row(walls: &[Segment], spacing_um: i64, cells: usize, ours: &[(&str, f64)]) {
    let Some(command) = std::env::var_os("ENFILADE_PEER") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let plan = folder.path().join("plan.dxf");
    std::fs::write(&plan, drawing(walls)).expect("the plan");
    let run = |step: &str| {
        let before = children_secs();
        let mut peer = std::process::Command::new(&command);
        let metres = format!("{}", spacing_um as f64 * 1e-6);
        let out =
            peer.arg(step).arg(&plan).args([metres.as_str(), "2,2"]).output().expect("the peer's command");
        let secs = children_secs() - before;
        let text = String::from_utf8_lossy(&out.stdout).into_owned();
        let found = text.split_whitespace().last().and_then(|n| n.parse::<usize>().ok());
        out.status.success().then_some((secs, found))
    };
    let Some((graph_secs, _)) = run("graph") else {
        println!("{:<28}the peer fails on this plan", "");
        return;
    };
    for &(step, secs) in ours {
        let Some((all_secs, found)) = run(step) else {
            println!("{:<28}peer, {step}: none", "");
            continue;
        };
        let theirs = if step == "graph" { all_secs } else { all_secs - graph_secs };
        let same = match found {
            Some(n) if n == cells => "the same cells".to_string(),
            Some(n) => format!("{n} cells, not the same"),
            None => "cells not told".to_string(),
        };
        println!("{:<28}peer, {step}: {theirs:.2} s, {:.0} times ours; {same}", "", theirs / secs);
    }
}

/// User CPU seconds of the commands that have been run.
fn children_secs() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let fields = stat.rsplit(')').next().unwrap_or("");
    let ticks = fields.split_whitespace().nth(13).and_then(|t| t.parse::<f64>().ok());
    ticks.unwrap_or(f64::NAN) / 100.0
}

/// Walls as LINEs in metres, DXF R12.
fn drawing(walls: &[Segment]) -> String {
    let mut text = String::from("0\nSECTION\n2\nENTITIES\n");
    for w in walls {
        let [a, b] = [w.a, w.b].map(|p| p.map(|v| v as f64 * 1e-6));
        text += &format!(
            "0\nLINE\n8\nWALLS\n10\n{:.6}\n20\n{:.6}\n30\n0.0\n11\n{:.6}\n21\n{:.6}\n31\n0.0\n",
            a[0], a[1], b[0], b[1]
        );
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

fn baseline_row(
    lattice: &Lattice,
    obstacles: &Obstacles,
    graph: &Graph,
    tally: &enfilade_engine::Tally,
    ours: f64,
) {
    let (secs, (lists, levels)) = median(&pool(1), 1, || {
        let lists = baseline_graph(lattice, obstacles);
        let levels = baseline_levels(&lists);
        (lists, levels)
    });
    assert_eq!(lists.iter().map(|l| l.len() as u64).sum::<u64>(), 2 * graph.edge_count());
    assert_eq!(levels.concat(), tally.levels, "the baseline disagrees");
    println!("{:<28}pairwise test and queue: {secs:.3} s, {:.0} times the sum above", "", secs / ours);
}

/// Every pair against every wall, bounding boxes first.
fn baseline_graph(lattice: &Lattice, obstacles: &Obstacles) -> Vec<Vec<u32>> {
    let n = lattice.cells.len();
    let sees = |u: usize, v: usize| {
        let (a, b) = (lattice.centre_um(u), lattice.centre_um(v));
        let apart = |s: &Segment, k: usize| {
            s.a[k].max(s.b[k]) < a[k].min(b[k]) || s.a[k].min(s.b[k]) > a[k].max(b[k])
        };
        let blocks = |s: &&Segment| !apart(s, 0) && !apart(s, 1) && segments_touch(Segment { a, b }, **s);
        !obstacles.segments.iter().any(|s| blocks(&s))
    };
    let above: Vec<Vec<u32>> = (0..n)
        .into_par_iter()
        .map(|u| (u + 1..n).filter(|&v| sees(u, v)).map(|v| v as u32).collect())
        .collect();
    let mut lists = above.clone();
    for (u, list) in above.iter().enumerate() {
        list.iter().for_each(|&v| lists[v as usize].push(u as u32));
    }
    lists
}

/// One queue a root.
fn baseline_levels(lists: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let from = |root: usize| {
        let mut level = vec![u32::MAX; lists.len()];
        let mut counts = Vec::new();
        let mut queue = VecDeque::from([root as u32]);
        level[root] = 0;
        while let Some(u) = queue.pop_front() {
            let next = level[u as usize] + 1;
            for &v in &lists[u as usize] {
                if level[v as usize] == u32::MAX {
                    level[v as usize] = next;
                    counts.resize(next as usize, 0);
                    counts[next as usize - 1] += 1;
                    queue.push_back(v);
                }
            }
        }
        counts
    };
    (0..lists.len()).into_par_iter().map(from).collect()
}

/// One evaluation of the gallery's objective, as the optimiser asks for it.
fn evaluation_row() {
    let Some(text) = shared_text("art_gallery.dxf") else {
        println!("art_gallery: no reference values here, skipped");
        return;
    };
    let gallery = Gallery::read(&text);
    let lattice = Arc::new(gallery.lattice());
    let evaluator = Evaluator::new(lattice.clone(), &gallery.fixed, &gallery.layout(0), None);
    let means = measures::means(evaluator.initial(), 0);
    // The reference values of the drawing as it is.
    assert!((means.degree - 5.397260273972603).abs() < 1e-12, "{means:?}");
    assert!((means.degree_all - 291.4109589041096).abs() < 1e-10, "{means:?}");
    assert!((means.depth - 3.7831050228310503).abs() < 1e-12, "{means:?}");
    assert!((means.entropy - 1.8446879876435331).abs() < 1e-12, "{means:?}");
    let mut scratch = evaluator.scratch();
    let layouts: Vec<Obstacles> = (0..200).map(|seed| gallery.layout(seed)).collect();
    let mut times: Vec<f64> = Vec::new();
    let mut sum = 0;
    for layout in &layouts {
        let started = thread_secs();
        let tally = evaluator.evaluate(layout, &mut scratch);
        times.push(thread_secs() - started);
        sum += tally.depth.iter().sum::<u32>();
    }
    times.sort_by(f64::total_cmp);
    println!(
        "art_gallery: {} vertices, {} roots, {} moving segments: {:.3} ms an evaluation (median of {}; best {:.3}; depth sum {sum})",
        lattice.cells.len(),
        lattice.query.len(),
        gallery.moving.len(),
        times[times.len() / 2] * 1e3,
        times.len(),
        times[0] * 1e3
    );
}

type Ring = Vec<[i64; 2]>;

/// A layer's name and something drawn on it.
type OnLayer<T> = (String, T);

/// The reference gallery: walls inside a move box shift together.
struct Gallery {
    fixed: Vec<Segment>,
    moving: Vec<Segment>,
    group: Vec<usize>,
    query: Vec<Ring>,
    reference: Vec<Ring>,
}

impl Gallery {
    fn read(text: &str) -> Self {
        let (lines, rings) = entities(text);
        let of = |layer: &str| rings.iter().filter(|r| r.0 == layer).map(|r| r.1.clone()).collect::<Vec<_>>();
        let boxes = of("EF-MOVE");
        let mut new = Self {
            fixed: vec![],
            moving: vec![],
            group: vec![],
            query: of("EF-QUERY"),
            reference: of("EF-REFERENCE"),
        };
        for (layer, wall) in lines {
            let holder = boxes.iter().position(|b| inside(b, wall.a) && inside(b, wall.b));
            match holder {
                _ if layer != "WALLS" => {}
                Some(g) => {
                    new.moving.push(wall);
                    new.group.push(g);
                }
                None => new.fixed.push(wall),
            }
        }
        new
    }

    fn lattice(&self) -> Lattice {
        let (spacing_um, origin_um) = (2_000_000, [1_000_000, 1_000_000]);
        let (mut cells, mut query, mut is_reference) = (vec![], vec![], vec![]);
        for cell in (-5..120).flat_map(|c| (-5..120).map(move |r| [c, r])) {
            let at = [0, 1].map(|k| origin_um[k] + i64::from(cell[k]) * spacing_um);
            let within = |rings: &[Ring]| rings.iter().any(|r| inside(r, at));
            let (q, r) = (within(&self.query), within(&self.reference));
            if q {
                query.push(cells.len() as u32);
            }
            if q || r {
                cells.push(cell);
                is_reference.push(r);
            }
        }
        Lattice { spacing_um, origin_um, cells, query, is_reference, beyond: None }
    }

    /// Moves every group by up to a metre each way; seed 0 is the drawing.
    fn layout(&self, seed: u64) -> Obstacles {
        let by = |g: usize, k: u64| {
            if seed == 0 { 0 } else { (mix(seed * 1000 + g as u64 * 2 + k) % 2_000_001) as i64 - 1_000_000 }
        };
        let moved = |(s, &g): (&Segment, &usize)| s.shifted([by(g, 0), by(g, 1)]);
        Obstacles { segments: self.moving.iter().zip(&self.group).map(moved).collect(), blind: vec![] }
    }
}

fn inside(ring: &Ring, p: [i64; 2]) -> bool {
    enfilade_engine::geometry::side_of_ring(ring, p) != enfilade_engine::geometry::Side::Outside
}

/// Runs on the pool's thread and takes the median of its CPU time.
fn median<T: Send>(pool: &rayon::ThreadPool, repeats: usize, work: impl Fn() -> T + Sync) -> (f64, T) {
    let once = || {
        let started = thread_secs();
        let value = work();
        (thread_secs() - started, value)
    };
    let mut runs: Vec<(f64, T)> = pool.install(|| (0..repeats).map(|_| once()).collect());
    runs.sort_by(|a, b| a.0.total_cmp(&b.0));
    runs.swap_remove(repeats / 2)
}

fn thread_secs() -> f64 {
    let t = clock_gettime(ClockId::ThreadCPUTime);
    t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
}

fn peak_mb() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|l| l.starts_with("VmHWM")).unwrap_or("");
    let kb = line.split_whitespace().nth(1).and_then(|v| v.parse::<u64>().ok());
    kb.map_or("?".into(), |kb| (kb / 1024).to_string())
}

fn shared_text(path: &str) -> Option<String> {
    let shared = std::env::var_os("ENFILADE_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    std::fs::read_to_string(shared.join("reference").join(path)).ok()
}

fn shared_walls(path: &str) -> Option<Vec<Segment>> {
    let (lines, _) = entities(&shared_text(path)?);
    Some(lines.into_iter().filter(|l| l.0 == "WALLS").map(|l| l.1).collect())
}

/// LINEs and LWPOLYLINEs (closed ones end where they begin) with their layers, of a drawing in metres.
fn entities(text: &str) -> (Vec<OnLayer<Segment>>, Vec<OnLayer<Ring>>) {
    let tags: Vec<&str> = text.lines().map(str::trim).collect();
    let um = |v: &str| (v.parse::<f64>().expect("a number") * 1e6).round() as i64;
    let (mut lines, mut rings) = (vec![], Vec::<(String, Ring)>::new());
    let records = tags.chunks_exact(2).fold(Vec::<Vec<(&str, &str)>>::new(), |mut all, tag| {
        if tag[0] == "0" {
            all.push(vec![]);
        }
        if let Some(record) = all.last_mut() {
            record.push((tag[0], tag[1]));
        }
        all
    });
    for record in records {
        let get = |code: &str| record.iter().find(|t| t.0 == code).map(|t| t.1);
        let at = |x, y| [um(get(x).expect("x")), um(get(y).expect("y"))];
        let layer = get("8").unwrap_or("0").to_string();
        match record[0].1 {
            "LINE" => lines.push((layer, Segment { a: at("10", "20"), b: at("11", "21") })),
            "LWPOLYLINE" => {
                let of = |code: &'static str| record.iter().filter(move |t| t.0 == code).map(|t| um(t.1));
                let mut ring: Ring = of("10").zip(of("20")).map(|(x, y)| [x, y]).collect();
                if get("70").is_some_and(|flags| flags == "1" || flags == "129") {
                    ring.push(ring[0]);
                }
                rings.push((layer, ring));
            }
            _ => {}
        }
    }
    (lines, rings)
}

/// depthmapX's fill: eight neighbours, a step refused where the line between the centres touches a wall.
fn flood(walls: &[Segment], spacing_um: i64, seed_um: [i64; 2]) -> Lattice {
    let mut near: HashMap<[i64; 2], Vec<Segment>> = HashMap::new();
    let index = |v: i64| v.div_euclid(spacing_um);
    for wall in walls {
        let lo = [0, 1].map(|k| index(wall.a[k].min(wall.b[k])) - 1);
        let hi = [0, 1].map(|k| index(wall.a[k].max(wall.b[k])) + 1);
        for at in (lo[0]..=hi[0]).flat_map(|c| (lo[1]..=hi[1]).map(move |r| [c, r])) {
            near.entry(at).or_default().push(*wall);
        }
    }
    let centre = |c: [i64; 2]| c.map(|v| v * spacing_um);
    let free = |a: [i64; 2], b: [i64; 2]| {
        let step = Segment { a: centre(a), b: centre(b) };
        near.get(&a).is_none_or(|walls| walls.iter().all(|w| !segments_touch(step, *w)))
    };
    let seed = seed_um.map(|v| (v + spacing_um / 2).div_euclid(spacing_um));
    let mut cells = HashSet::from([seed]);
    let mut queue = VecDeque::from([seed]);
    while let Some(at) = queue.pop_front() {
        for next in (-1..=1).flat_map(|c| (-1..=1).map(move |r| [at[0] + c, at[1] + r])) {
            if !cells.contains(&next) && free(at, next) {
                cells.insert(next);
                queue.push_back(next);
            }
        }
    }
    let mut cells: Vec<[i32; 2]> = cells.into_iter().map(|c| c.map(|v| v as i32)).collect();
    cells.sort_unstable();
    Lattice {
        spacing_um,
        origin_um: [0, 0],
        query: (0..cells.len() as u32).collect(),
        is_reference: vec![true; cells.len()],
        beyond: None,
        cells,
    }
}

/// A square building of rooms with doors: halves split across until the rooms are small.
fn building(metres: i64) -> Vec<Segment> {
    let mut walls = outline(metres);
    let side = metres * 1_000_000;
    split([0, 0], [side, side], 1, &mut walls);
    walls
}

fn split(lo: [i64; 2], hi: [i64; 2], seed: u64, walls: &mut Vec<Segment>) {
    let m = 1_000_000;
    let k = usize::from(hi[1] - lo[1] > hi[0] - lo[0]);
    let length = hi[k] - lo[k];
    if length < 17 * m {
        return;
    }
    let at = lo[k] + length / 2 + (mix(seed) % (length / 4) as u64) as i64 - length / 8;
    let point = |along: i64| if k == 0 { [at, along] } else { [along, at] };
    let mut from = lo[1 - k];
    let mut door = from + 2 * m + (mix(seed + 7) % (4 * m as u64)) as i64;
    while door + 2 * m < hi[1 - k] {
        walls.push(Segment { a: point(from), b: point(door) });
        from = door + 3 * m / 2;
        door = from + 6 * m + (mix(door as u64) % (12 * m as u64)) as i64;
    }
    walls.push(Segment { a: point(from), b: point(hi[1 - k]) });
    let (mut low_hi, mut high_lo) = (hi, lo);
    low_hi[k] = at;
    high_lo[k] = at;
    split(lo, low_hi, seed * 2 + 1, walls);
    split(high_lo, hi, seed * 2 + 2, walls);
}

/// A square building of rooms of 6 to 13 metres, with a door in every wall and another for each 60 metres.
fn rooms(metres: i64) -> Vec<Segment> {
    let mut walls = outline(metres);
    let side = metres * 1_000_000;
    part([0, 0], [side, side], 1, &mut walls);
    walls
}

fn part(lo: [i64; 2], hi: [i64; 2], seed: u64, walls: &mut Vec<Segment>) {
    let m = 1_000_000;
    let k = usize::from(hi[1] - lo[1] > hi[0] - lo[0]);
    let length = hi[k] - lo[k];
    if length < 13 * m {
        return;
    }
    let at = lo[k] + length / 2 + (mix(seed) % (length / 4) as u64) as i64 - length / 8;
    let point = |along: i64| if k == 0 { [at, along] } else { [along, at] };
    let across = hi[1 - k] - lo[1 - k];
    let doors = 1 + across / (60 * m);
    let mut from = lo[1 - k];
    for i in 0..doors {
        let free = (across / doors - 4 * m) as u64;
        let door = lo[1 - k] + across * i / doors + 2 * m + (mix(seed + 7 + i as u64) % free) as i64;
        walls.push(Segment { a: point(from), b: point(door) });
        from = door + 3 * m / 2;
    }
    walls.push(Segment { a: point(from), b: point(hi[1 - k]) });
    let (mut low_hi, mut high_lo) = (hi, lo);
    low_hi[k] = at;
    high_lo[k] = at;
    part(lo, low_hi, seed * 2 + 1, walls);
    part(high_lo, hi, seed * 2 + 2, walls);
}

/// Houses of 8 to 16 metres every 25 metres, a quarter of them left out.
fn city(metres: i64) -> Vec<Segment> {
    let m = 1_000_000;
    let mut walls = outline(metres);
    for x in (25..metres - 16).step_by(25) {
        for y in (25..metres - 16).step_by(25) {
            let seed = mix((x * 7_919 + y) as u64);
            let size = [seed >> 8, seed >> 32].map(|s| 8 * m + (s % 8_000_000) as i64);
            let [a, b] = [[x * m + 17, y * m + 31], [x * m + 17 + size[0], y * m + 31 + size[1]]];
            if !seed.is_multiple_of(4) {
                let ring = [a, [b[0], a[1]], b, [a[0], b[1]], a];
                walls.extend(ring.windows(2).map(|w| Segment { a: w[0], b: w[1] }));
            }
        }
    }
    walls
}

fn outline(metres: i64) -> Vec<Segment> {
    let side = metres * 1_000_000;
    let corners = [[0, 0], [side, 0], [side, side], [0, side]];
    (0..4).map(|i| Segment { a: corners[i], b: corners[(i + 1) % 4] }).collect()
}

/// splitmix64.
fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
