//! What the search reaches for a number of evaluations, and what it costs.
//!
//! `cargo bench --bench search -- --problem maze --evaluations 700,2000 --seeds 5 [--set name=value …]`
//!
//! `--points` prints every run's archive and options as a line of JSON instead; `--serve` measures the points
//! that come as lines of JSON on the standard input. Both are for `peers.py` beside this file. `--cma` counts what
//! CMA-ES alone needs on two standard functions.

// A bench that cannot read its problem has nothing better to do than to stop.
#![allow(clippy::unwrap_used)]

mod cma;
mod maze;
mod plan;
mod problem;

use std::io::{BufRead, Write};
use std::path::PathBuf;
use std::time::Instant;

use enfilade_search::{
    Evaluation, Method, Mode, Objective, Outcome, Search, Sense, Study, Tuning, normalised_distance,
};
use problem::{Hills, Problem, Steps};
use serde_json::json;

struct Options {
    problems: Vec<String>,
    evaluations: Vec<u64>,
    seeds: u64,
    first_seed: u64,
    batch: usize,
    method: Method,
    tuning: Tuning,
    verbose: bool,
    serves: bool,
    points: bool,
    cma: bool,
}

struct Run {
    best: f64,
    inside: usize,
    min: f64,
    mean: f64,
    score: f64,
    search_ms: f64,
    total_ms: f64,
    /// Name, budget, seed, bounds, every point evaluated with score and violation, the options: JSON.
    points: String,
}

fn main() {
    let options = options();
    if options.cma {
        cma::print(options.seeds);
        return;
    }
    for name in &options.problems {
        let problem = make(name);
        if options.serves {
            serve(problem.as_ref());
            return;
        }
        for &evaluations in &options.evaluations {
            let seeds = options.first_seed..options.first_seed + options.seeds;
            let runs: Vec<Run> = std::thread::scope(|scope| {
                let seeds: Vec<u64> = seeds.collect();
                let (a, b) = seeds.split_at(seeds.len() / 2);
                let work = |part: &[u64]| -> Vec<Run> {
                    part.iter().map(|&s| run(problem.as_ref(), &options, evaluations, s)).collect()
                };
                let (a, b) = (a.to_vec(), b.to_vec());
                let first = scope.spawn(move || work(&a));
                let second = work(&b);
                let mut all = first.join().unwrap();
                all.extend(second);
                all
            });
            if options.points {
                runs.iter().for_each(|r| println!("{}", r.points));
                continue;
            }
            print(problem.name(), evaluations, &runs, options.verbose);
        }
    }
}

fn make(name: &str) -> Box<dyn Problem> {
    let shared = std::env::var("ENFILADE_SHARED").unwrap_or_else(|_| "../shared".into());
    match name {
        "maze" => {
            let maze = maze::Maze::read(&PathBuf::from(shared).join("reference"));
            maze.check();
            Box::new(maze)
        }
        "steps9" => Box::new(Steps { dims: 9 }),
        "steps17" => Box::new(Steps { dims: 17 }),
        "hills9" => Box::new(Hills { dims: 9 }),
        "hills17" => Box::new(Hills { dims: 17 }),
        other => match plan::PlanProblem::read(other, &PathBuf::from(shared)) {
            Some(plan) => Box::new(plan),
            None => panic!("no problem {other}"),
        },
    }
}

fn run(problem: &dyn Problem, options: &Options, evaluations: u64, seed: u64) -> Run {
    let bounds = problem.bounds();
    let study = Study {
        bounds: bounds.clone(),
        start: problem.start(),
        objectives: vec![Objective {
            name: "score".into(),
            sense: Sense::Max,
            threshold: 0.7,
            is_score: true,
            is_penalty: false,
        }],
        members: 5,
        d_min: 0.25,
        least_share: 1.0,
        seed,
        evaluations: Some(evaluations),
        method: options.method,
        mode: Mode::Diverse,
        batch: options.batch,
        seeds: vec![],
        pinned: 0,
    };
    let begin = Instant::now();
    let cpu_begin = cpu_seconds();
    let mut evaluating = 0.0;
    let mut search = Search::with_tuning(study, options.tuning.clone()).unwrap();
    loop {
        let asked = search.ask();
        if asked.is_empty() {
            break;
        }
        let start = cpu_seconds();
        let told: Vec<Evaluation> = asked
            .iter()
            .map(|p| {
                let worth = problem.worth(p);
                Evaluation { values: vec![worth.score], violation: worth.violation, at: None }
            })
            .collect();
        evaluating += cpu_seconds() - start;
        search.tell(&told);
    }
    let outcome = search.outcome();
    let total = begin.elapsed().as_secs_f64();
    let searching = cpu_seconds() - cpu_begin - evaluating;
    let best = outcome.best.values[0];
    let members = &outcome.members;
    let mut distances = vec![];
    for (i, a) in members.iter().enumerate() {
        for b in &members[i + 1..] {
            distances.push(normalised_distance(&bounds, &a.parameters, &b.parameters));
        }
    }
    let inside = members.iter().filter(|m| m.values[0] >= 0.7 * best && m.violation == 0.0).count();
    let count = members.len().max(1) as f64;
    Run {
        best,
        inside,
        min: distances.iter().copied().fold(f64::INFINITY, f64::min),
        mean: distances.iter().sum::<f64>() / distances.len().max(1) as f64,
        score: members.iter().map(|m| m.values[0]).sum::<f64>() / count,
        search_ms: searching * 1e3 / evaluations as f64,
        total_ms: total * 1e3,
        points: if options.points { points(problem, &outcome, evaluations, seed) } else { String::new() },
    }
}

/// A run as a line of JSON; scores that are no numbers become null.
fn points(problem: &dyn Problem, outcome: &Outcome<'_>, evaluations: u64, seed: u64) -> String {
    let archive = outcome.archive.iter().map(|p| json!([p.parameters, p.values[0], p.violation]));
    let members = outcome.members.iter().map(|m| json!([m.parameters, m.values[0], m.violation]));
    json!({
        "problem": problem.name(),
        "evaluations": evaluations,
        "seed": seed,
        "bounds": problem.bounds(),
        "points": archive.collect::<Vec<_>>(),
        "members": members.collect::<Vec<_>>(),
    })
    .to_string()
}

/// What is asked of a problem that is served.
#[derive(serde::Deserialize)]
#[serde(untagged)]
enum Asked {
    /// What points are worth.
    Points(Vec<Vec<f64>>),
    /// What is seen at points.
    Maps { maps: Vec<Vec<f64>> },
}

/// Says what the problem is, then answers each line with a line: a list of points with what each is worth (score,
/// violation, parts), `{"maps": points}` with what every vertex sees at each.
fn serve(problem: &dyn Problem) {
    let mut out = std::io::stdout().lock();
    let head = json!({ "problem": problem.name(), "bounds": problem.bounds(), "start": problem.start() });
    writeln!(out, "{head}").unwrap();
    out.flush().unwrap();
    for line in std::io::stdin().lock().lines() {
        let worth = |p: &Vec<f64>| {
            let w = problem.worth(p);
            json!([w.score, w.violation, w.parts])
        };
        let told: Vec<serde_json::Value> = match serde_json::from_str(&line.unwrap()).unwrap() {
            Asked::Points(points) => points.iter().map(worth).collect(),
            Asked::Maps { maps } => maps.iter().map(|p| json!(problem.map(p))).collect(),
        };
        writeln!(out, "{}", serde_json::Value::from(told)).unwrap();
        out.flush().unwrap();
    }
}

/// CPU time of this thread; wall time means little on a shared machine.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split_whitespace().next().and_then(|t| t.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

fn print(name: &str, evaluations: u64, runs: &[Run], verbose: bool) {
    let column = |f: fn(&Run) -> f64| {
        let mut v: Vec<f64> = runs.iter().map(f).collect();
        v.sort_by(f64::total_cmp);
        let median = (v[(v.len() - 1) / 2] + v[v.len() / 2]) / 2.0;
        format!("{median:.3} [{:.3}, {:.3}]", v[0], v[v.len() - 1])
    };
    let inside = runs.iter().filter(|r| r.inside >= 5).count();
    println!(
        "{name:8} {evaluations:5}  best {}  all inside {inside}/{}  min dn {}  mean dn {}  mean score {}  search {} ms/ev  total {} ms",
        column(|r| r.best),
        runs.len(),
        column(|r| r.min),
        column(|r| r.mean),
        column(|r| r.score),
        column(|r| r.search_ms),
        column(|r| r.total_ms),
    );
    if verbose {
        for r in runs {
            println!(
                "    best {:.3} inside {} min {:.3} mean {:.3} score {:.3}",
                r.best, r.inside, r.min, r.mean, r.score
            );
        }
    }
}

fn options() -> Options {
    let mut options = Options {
        problems: vec!["maze".into()],
        evaluations: vec![700, 2000, 5000],
        seeds: 5,
        first_seed: 1,
        batch: 1,
        method: Method::Default,
        tuning: Tuning::default(),
        verbose: false,
        serves: false,
        points: false,
        cma: false,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().unwrap();
        match argument.as_str() {
            "--problem" => options.problems = value().split(',').map(String::from).collect(),
            "--evaluations" => options.evaluations = value().split(',').map(|v| v.parse().unwrap()).collect(),
            "--seeds" => options.seeds = value().parse().unwrap(),
            "--first-seed" => options.first_seed = value().parse().unwrap(),
            "--batch" => options.batch = value().parse().unwrap(),
            "--paper" => options.method = Method::Paper,
            "--cma" => options.cma = true,
            "--serve" => options.serves = true,
            "--points" => options.points = true,
            "--verbose" => options.verbose = true,
            "--set" => set(&mut options.tuning, &value()),
            _ => {}
        }
    }
    options
}

fn set(tuning: &mut Tuning, assignment: &str) {
    let (name, value) = assignment.split_once('=').unwrap();
    let number: f64 = value.parse().unwrap();
    match name {
        "climb_share" => tuning.climb_share = number,
        "late_climb" => tuning.late_climb = number,
        "fade_from" => tuning.fade_from = number,
        "margin" => tuning.margin = number,
        "neighbours" => tuning.neighbours = number as usize,
        "spread_neighbours" => tuning.spread_neighbours = number as usize,
        "candidates" => tuning.candidates = number as usize,
        "spread_candidates" => tuning.spread_candidates = number as usize,
        "raw_share" => tuning.raw_share = number,
        "coordinate_share" => tuning.coordinate_share = number,
        "first_step" => tuning.first_step = number,
        "last_step" => tuning.last_step = number,
        "floor_share" => tuning.floor_share = number,
        "any_member" => tuning.any_member = number,
        "keep_best" => tuning.keep_best = number > 0.0,
        "acceptance" => tuning.acceptance = number,
        "polish" => tuning.polish = number,
        "late_polish" => tuning.late_polish = number,
        "nugget" => tuning.nugget = number,
        "differences" => tuning.differences = number,
        "patience" => tuning.patience = number,
        other => panic!("no setting {other}"),
    }
}
