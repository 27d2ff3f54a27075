mod studies;

use proptest::prelude::*;

use super::*;

fn objective(name: &str, sense: Sense, is_score: bool) -> Objective {
    Objective { name: name.into(), sense, threshold: 0.7, is_score, is_penalty: false }
}

fn study(dims: usize, evaluations: u64) -> Study {
    Study {
        bounds: vec![[-2.0, 3.0]; dims],
        start: vec![0.0; dims],
        objectives: vec![objective("score", Sense::Max, true)],
        members: 5,
        d_min: 0.25,
        least_share: 1.0,
        seed: 1,
        evaluations: Some(evaluations),
        method: Method::Default,
        mode: Mode::Diverse,
        batch: 1,
        seeds: vec![],
        pinned: 0,
    }
}

/// A hill with steps and a forbidden corner.
fn hill(p: &[f64]) -> Evaluation {
    let square: f64 = p.iter().map(|x| (x - 1.0).powi(2)).sum();
    let score = 3.0 - ((square / p.len().max(1) as f64) * 8.0).round() / 8.0;
    let forbidden = p.first().is_some_and(|x| *x > 2.0);
    Evaluation { values: vec![score], violation: if forbidden { 0.01 } else { 0.0 }, at: None }
}

/// Runs to the end; returns the search and everything asked.
fn run(study: Study, f: impl Fn(&[f64]) -> Evaluation) -> (Search, Vec<Vec<f64>>) {
    let mut search = Search::new(study).unwrap();
    let mut all = vec![];
    loop {
        let asked = search.ask();
        if asked.is_empty() {
            break;
        }
        let told: Vec<Evaluation> = asked.iter().map(|p| f(p)).collect();
        search.tell(&told);
        all.extend(asked);
    }
    (search, all)
}

fn assert_sound(search: &Search, study: &Study) {
    let outcome = search.outcome();
    let inside = |p: &[f64]| p.iter().zip(&study.bounds).all(|(x, [lower, upper])| x >= lower && x <= upper);
    assert!(outcome.archive.iter().all(|p| inside(&p.parameters)));
    assert!(outcome.members.len() <= study.members);
    assert_eq!(outcome.evaluations as usize, outcome.archive.len());
    for member in &outcome.members {
        assert!(inside(&member.parameters));
        if study.method == Method::Default {
            assert!(member.within_threshold && member.violation == 0.0, "{member:?}");
        }
    }
}

/// What is pinned is measured and kept whatever is spent: fewer evaluations are refused, not taken from the pins.
#[test]
fn fewer_evaluations_than_pinned_members_are_refused() {
    let with = |evaluations| {
        let base = study(4, evaluations);
        let seeds = vec![base.start.clone(); 3];
        Search::new(Study { seeds, pinned: 3, ..base })
    };
    let refused = with(3).err().and_then(|e| e.problem().map(|p| p.text.clone())).unwrap();
    assert!(refused.contains("expected at least 4: the present layout and the pinned ones"), "{refused}");
    assert!(with(4).is_ok());
}

#[test]
fn the_first_ask_is_the_start_and_the_budget_is_kept_exactly() {
    for (method, batch) in
        [(Method::Default, 1), (Method::Default, 7), (Method::Paper, 1), (Method::Paper, 4)]
    {
        let study = Study { method, batch, ..study(4, 203) };
        let (search, all) = run(study.clone(), hill);
        assert_eq!(all[0], study.start);
        assert_eq!(search.stop_reason(), Some(Stop::Budget));
        assert_eq!(all.len(), 203);
        assert_sound(&search, &study);
    }
}

#[test]
fn five_members_inside_their_threshold_stand_apart() {
    let study = study(6, 300);
    let (search, _) = run(study.clone(), hill);
    let outcome = search.outcome();
    assert_eq!(outcome.members.len(), 5);
    assert!(outcome.best.values[0] >= 2.75, "{:?}", outcome.best);
    assert!((outcome.thresholds[0] - 0.7 * outcome.best.values[0]).abs() < 1e-12);
    for (i, a) in outcome.members.iter().enumerate() {
        for b in &outcome.members[i + 1..] {
            let distance = normalised_distance(&study.bounds, &a.parameters, &b.parameters);
            assert!(distance > 0.4, "{distance}");
        }
    }
}

#[test]
fn the_same_seed_asks_the_same_and_another_seed_does_not() {
    for method in [Method::Default, Method::Paper] {
        let make = |seed| run(Study { seed, method, batch: 3, ..study(5, 160) }, hill).1;
        let bits = |all: &[Vec<f64>]| all.iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&make(1)), bits(&make(1)));
        assert_ne!(bits(&make(1)), bits(&make(2)));
    }
}

#[test]
fn asking_twice_gives_the_same_batch() {
    let mut search = Search::new(study(3, 50)).unwrap();
    search.ask();
    search.tell(&[hill(&[0.0; 3])]);
    assert_eq!(search.ask(), search.ask());
}

#[test]
fn values_that_are_no_numbers_make_a_point_infeasible() {
    let odd = |p: &[f64]| {
        if p[0] > 0.5 {
            Evaluation {
                values: vec![if p[1] > 0.0 { f64::NAN } else { f64::INFINITY }],
                violation: 0.0,
                ..Evaluation::default()
            }
        } else {
            hill(p)
        }
    };
    for method in [Method::Default, Method::Paper] {
        let study = Study { method, ..study(4, 150) };
        let (search, _) = run(study.clone(), odd);
        assert_sound(&search, &study);
        assert!(search.outcome().best.values[0].is_finite());
        let (search, _) = run(study, |_| Evaluation {
            values: vec![f64::NAN],
            violation: f64::NAN,
            ..Evaluation::default()
        });
        assert!(search.outcome().best.violation > 0.0);
    }
}

#[test]
fn told_too_little_counts_as_infeasible() {
    let mut search = Search::new(Study { batch: 3, ..study(3, 50) }).unwrap();
    search.ask();
    search.tell(&[hill(&[0.0; 3])]);
    search.ask();
    search.tell(&[]);
    let outcome = search.outcome();
    assert_eq!(outcome.evaluations, 4);
    assert!(outcome.archive[1..].iter().all(|p| p.violation == f64::INFINITY));
}

#[test]
fn without_room_to_move_only_the_start_is_asked() {
    for dims in [0, 2] {
        let study = Study { bounds: vec![[1.0, 1.0]; dims], start: vec![1.0; dims], ..study(dims, 50) };
        let (search, all) = run(study, hill);
        assert_eq!(all.len(), 1);
        assert_eq!(search.stop_reason(), Some(Stop::NothingToMove));
        assert_eq!(search.outcome().members.len(), 1);
    }
}

#[test]
fn a_parameter_without_room_keeps_its_value() {
    let mut study = study(4, 80);
    study.bounds[2] = [0.25, 0.25];
    study.start[2] = 0.25;
    let (_, all) = run(study, hill);
    assert!(all.iter().all(|p| p[2] == 0.25));
}

#[test]
fn best_mode_and_a_set_of_one_give_the_best_point() {
    for study in [Study { mode: Mode::Best, ..study(4, 200) }, Study { members: 1, ..study(4, 200) }] {
        let (search, _) = run(study, hill);
        let outcome = search.outcome();
        assert_eq!(outcome.members.len(), 1);
        assert_eq!(outcome.members[0].parameters, outcome.best.parameters);
    }
}

#[test]
fn where_nothing_is_feasible_there_are_no_members() {
    let never =
        |p: &[f64]| Evaluation { values: vec![1.0], violation: 1.0 + p[0].abs(), ..Evaluation::default() };
    let (search, _) = run(study(3, 120), never);
    let outcome = search.outcome();
    assert!(outcome.members.is_empty());
    assert!(outcome.best.violation < 1.1, "{}", outcome.best.violation);
}

#[test]
fn a_small_feasible_region_is_found_from_outside() {
    let ring = |p: &[f64]| {
        let square: f64 = p.iter().map(|x| (x - 2.0).powi(2)).sum();
        Evaluation { values: vec![1.0 + p[0]], violation: (square - 1.0).max(0.0), ..Evaluation::default() }
    };
    let study = study(4, 300);
    let (search, _) = run(study.clone(), ring);
    assert_sound(&search, &study);
    assert_eq!(search.outcome().members.len(), 5);
}

#[test]
fn objectives_keep_their_order_and_thresholds() {
    let two = |p: &[f64]| Evaluation {
        values: vec![p.iter().map(|x| (x - 1.0).powi(2)).sum(), p.iter().sum()],
        violation: 0.0,
        at: None,
    };
    let objectives = vec![objective("penalty", Sense::Min, false), objective("degree", Sense::Max, false)];
    let study = Study { objectives, ..study(4, 500) };
    let (search, _) = run(study.clone(), two);
    assert_sound(&search, &study);
    let outcome = search.outcome();
    let (penalty, degree) = (outcome.thresholds[0], outcome.thresholds[1]);
    // From 4 at the start to about 0: a member may have 30 % of it.
    assert!((1.2..1.5).contains(&penalty), "{penalty}");
    assert!(degree > 2.0, "{degree}");
    assert_eq!(outcome.members.len(), 5);
    assert!(outcome.best.values[0] <= penalty && outcome.best.values[1] > 5.0, "{:?}", outcome.best);
}

/// Two aims that pull apart, in four dimensions: few layouts serve both.
fn torn(p: &[f64]) -> Evaluation {
    let from = |a: f64| -p.iter().map(|x| (x - a).powi(2)).sum::<f64>();
    Evaluation { values: vec![from(0.5), from(1.5)], violation: 0.0, at: None }
}

#[test]
fn thresholds_yield_where_members_would_be_alike_and_nowhere_else() {
    let objectives = vec![objective("degree", Sense::Max, false), objective("depth", Sense::Max, false)];
    let torn_study = Study { objectives, ..study(4, 600) };
    let at = |least_share: f64, d_min: f64| {
        let study = Study { least_share, d_min, ..torn_study.clone() };
        let (search, _) = run(study.clone(), torn);
        assert_sound(&search, &study);
        let outcome = search.outcome();
        let apart = outcome.stages.last().map_or(0.0, |s| s.min_distance);
        (outcome.threshold_share, apart, outcome.thresholds)
    };
    let (firm_share, firm, firm_limits) = at(1.0, 0.25);
    let (share, apart, limits) = at(0.3, 0.25);
    assert_eq!(firm_share, 1.0);
    assert!((0.3..1.0).contains(&share) && apart > 1.2 * firm, "{share} {apart} {firm}");
    assert!(
        limits.iter().zip(&firm_limits).all(|(yielded, firm)| yielded < firm),
        "{limits:?} {firm_limits:?}"
    );
    assert_eq!(at(0.3, firm / 4.0).0, 1.0);
}

#[test]
fn members_too_alike_are_one_option_and_that_is_the_best() {
    // Better towards 0 along the one parameter, and good enough only in a sliver there.
    let sliver = |p: &[f64]| Evaluation { values: vec![1.0 - 40.0 * p[0].abs()], violation: 0.0, at: None };
    let (search, _) = run(study(1, 200), sliver);
    let outcome = search.outcome();
    assert_eq!((outcome.members.len(), outcome.alike), (1, 4));
    assert_eq!(outcome.members[0].parameters, outcome.best.parameters);
    // Wide enough for a few of them, half of the distance wanted apart.
    let wide = |p: &[f64]| Evaluation { values: vec![1.0 - 0.3 * p[0].abs()], violation: 0.0, at: None };
    let (search, _) = run(study(1, 200), wide);
    let outcome = search.outcome();
    assert!((2..5).contains(&outcome.members.len()), "{}", outcome.members.len());
    assert_eq!(outcome.members.len() + outcome.alike, 5);
    let apart = |a: &Member, b: &Member| (a.parameters[0] - b.parameters[0]).abs() / 5.0;
    for (i, a) in outcome.members.iter().enumerate() {
        assert!(outcome.members[i + 1..].iter().all(|b| apart(a, b) >= 0.125));
    }
    // With many parameters only what is almost the same is one option.
    let many = |p: &[f64]| Evaluation {
        values: vec![1.0 - 40.0 * p.iter().map(|x| x * x).sum::<f64>()],
        violation: 0.0,
        at: None,
    };
    let (search, _) = run(study(6, 300), many);
    let outcome = search.outcome();
    assert!(outcome.members.len() < 5 && outcome.alike > 0, "{outcome:?}");
    // Pinned ones stay, however alike they are.
    let pins = Study { seeds: vec![vec![0.001], vec![0.002]], pinned: 2, ..study(1, 200) };
    let (search, _) = run(pins, sliver);
    let outcome = search.outcome();
    let found: Vec<f64> = outcome.members.iter().map(|m| m.parameters[0]).collect();
    assert_eq!(found, [0.001, 0.002]);
}

#[test]
fn an_objective_at_its_best_already_leaves_room() {
    let lengths = |p: &[f64]| Evaluation {
        values: vec![p.iter().map(|x| x.abs()).sum(), p.iter().sum()],
        violation: 0.0,
        at: None,
    };
    let objectives = vec![objective("penalty", Sense::Min, false), objective("degree", Sense::Max, false)];
    // Near each other in the little room there is: what is alike is another matter.
    let study = Study { objectives, d_min: 0.0, ..study(4, 400) };
    let (search, _) = run(study.clone(), lengths);
    assert_sound(&search, &study);
    assert_eq!(search.outcome().members.len(), 5);
}

#[test]
fn without_a_budget_it_converges() {
    for mode in [Mode::Diverse, Mode::Best] {
        let study = Study { evaluations: None, mode, ..study(4, 1) };
        let (search, all) = run(study.clone(), hill);
        assert_eq!(search.stop_reason(), Some(Stop::Converged));
        assert!((120..5000).contains(&all.len()), "{}", all.len());
        assert_sound(&search, &study);
    }
}

#[test]
fn finishing_early_gives_the_best_so_far() {
    for method in [Method::Default, Method::Paper] {
        let mut search = Search::new(Study { method, ..study(4, 1000) }).unwrap();
        assert!(search.outcome().members.is_empty());
        for _ in 0..30 {
            let told: Vec<Evaluation> = search.ask().iter().map(|p| hill(p)).collect();
            search.tell(&told);
        }
        search.finish(Stop::Asked);
        assert_eq!(search.stop_reason(), Some(Stop::Asked));
        assert!(search.ask().is_empty());
        let outcome = search.outcome();
        assert!(outcome.best.violation == 0.0 && !outcome.stages.is_empty());
        assert!(!outcome.members.is_empty());
    }
}

#[test]
fn studies_that_make_no_sense_are_refused() {
    let good = study(2, 10);
    let bad = [
        Study { bounds: vec![[1.0, 0.0]; 2], ..good.clone() },
        Study { bounds: vec![[0.0, f64::NAN]; 2], ..good.clone() },
        Study { bounds: vec![[-1e308, 1e308]; 2], ..good.clone() },
        Study { start: vec![0.0], ..good.clone() },
        Study { start: vec![9.0; 2], ..good.clone() },
        Study { start: vec![f64::NAN; 2], ..good.clone() },
        Study { objectives: vec![], ..good.clone() },
        Study { members: 0, ..good.clone() },
        Study { batch: 0, ..good.clone() },
        Study { evaluations: Some(0), ..good.clone() },
        Study { d_min: -1.0, ..good.clone() },
        Study { least_share: 1.5, ..good.clone() },
    ];
    for study in bad {
        let error = Search::new(study.clone()).err();
        assert!(matches!(error, Some(Error::Usage(_))), "{study:?}");
    }
    assert!(Search::new(good).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn members_keep_bounds_and_hard_limits_in_any_study(
        seed in any::<u64>(),
        dims in 1usize..6,
        members in 1usize..5,
        batch in 1usize..9,
        evaluations in 1u64..90,
        cut in -1.0f64..3.0,
        is_score in any::<bool>(),
        sense in prop_oneof![Just(Sense::Max), Just(Sense::Min)],
        method in prop_oneof![Just(Method::Default), Just(Method::Paper)],
    ) {
        let objectives = vec![objective("a", sense, is_score), objective("b", Sense::Max, false)];
        let study = Study { seed, members, batch, objectives, method, ..study(dims, evaluations) };
        let f = |p: &[f64]| Evaluation {
            values: vec![p.iter().map(|x| x.sin()).sum(), p[0] * p[p.len() - 1]],
            violation: (p[0] - cut).max(0.0),
            at: None,
        };
        let (search, all) = run(study.clone(), f);
        assert_sound(&search, &study);
        prop_assert_eq!(all.len() as u64, evaluations);
    }
}

#[test]
fn pinned_points_are_members_and_the_others_stand_off() {
    let pins = vec![vec![1.0; 4], vec![0.5, 1.5, 1.0, 1.0]];
    let pinned = Study { seeds: pins.clone(), pinned: 2, ..study(4, 400) };
    let (search, asked) = run(pinned, hill);
    assert_eq!(asked[1..3], pins[..]);
    let outcome = search.outcome();
    let found: Vec<&Vec<f64>> = outcome.members.iter().map(|m| &m.parameters).collect();
    assert_eq!(found.len(), 5);
    assert_eq!(found[..2], [&pins[0], &pins[1]]);
    let bounds = vec![[-2.0, 3.0]; 4];
    for other in &found[2..] {
        let near = pins.iter().map(|p| normalised_distance(&bounds, p, other)).fold(f64::INFINITY, f64::min);
        assert!(near > 0.1, "{other:?} is like a pinned one");
    }
    for (pins, count) in [(vec![vec![9.0; 4]], 1), (vec![vec![0.0; 4]; 5], 5), (vec![], 1)] {
        assert!(Search::new(Study { seeds: pins, pinned: count, ..study(4, 400) }).is_err());
    }
}

#[test]
fn members_stand_where_the_caller_measured() {
    let module = |p: &[f64]| -> Vec<f64> { p.iter().map(|x| (x * 4.0).round() / 4.0).collect() };
    let (search, _) = run(study(4, 300), |p| {
        let at = module(p);
        Evaluation { at: Some(at.clone()), ..hill(&at) }
    });
    let outcome = search.outcome();
    assert_eq!(outcome.members.len(), 5);
    assert!(outcome.archive.iter().all(|p| module(&p.parameters) == p.parameters));
    assert!(outcome.members.iter().all(|m| hill(&m.parameters).values == m.values));
}
