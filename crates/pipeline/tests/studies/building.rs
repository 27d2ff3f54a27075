//! Options that build: made in the drawing, told as they are, taken like any other, and gone on from.

use std::collections::BTreeSet;
use std::time::Instant;

use enfilade_config::{Beside, Partial, Settings};
use enfilade_fixtures::sample;
use enfilade_overlay::built::{OptionWork, titles};
use enfilade_overlay::result::{Candidate, FrontPoint, RoundResult};
use enfilade_overlay::works::{WorkEntry, WorksResult};
use enfilade_pipeline::accept::{Accepted, Chosen, Origin, accept};
use enfilade_pipeline::works::works_of;
use enfilade_pipeline::{Input, Outcome, analyse, run};
use enfilade_report::{Cancel, Error, OutFile};

/// Works need no long search.
const FEW: &str = "evaluations = 30\nseed = 1\n";

fn round(file: &str, bytes: &[u8], more: &str) -> Outcome<RoundResult> {
    let settings = Settings::new(Partial::from_toml("", &format!("{FEW}{more}")).unwrap()).unwrap();
    run(&Input::new(file, bytes, 1), &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap()
}

fn of_sample(file: &str) -> (Vec<u8>, Outcome<RoundResult>) {
    let bytes = std::fs::read(sample(file)).unwrap();
    let round = round(file, &bytes, "");
    (bytes, round)
}

fn building(result: &RoundResult) -> Vec<(usize, &Candidate)> {
    (1..).zip(&result.candidates).filter(|(_, c)| !c.works.is_empty()).collect()
}

fn chosen(file: &str, bytes: &[u8], result: &RoundResult, what: Chosen) -> Result<Accepted, Error> {
    let origin = Origin { round: 1, is_so_far: false };
    accept(&Input::new(file, bytes, 1), Beside::default(), result, origin, what)
}

fn taken(file: &str, bytes: &[u8], result: &RoundResult, number: usize) -> Accepted {
    chosen(file, bytes, result, Chosen::numbered(number)).unwrap()
}

/// Mean visibility of a drawing with its side-car.
fn sight(file: &str, bytes: &[u8], side_car: &str) -> f64 {
    let settings = Settings::new(Partial::from_toml("", side_car).unwrap()).unwrap();
    let (outcome, _) = analyse(&Input::new(file, bytes, 2), &settings, &Cancel::default()).unwrap();
    outcome.result.mean.get("degree").unwrap()
}

/// Somebody else measures on the floor of the new drawing, which is larger by what stood in the way.
const ELSEWHERE: f64 = 0.02;

fn claims_hold(file: &str) {
    let (bytes, Outcome { result, .. }) = of_sample(file);
    let options = building(&result);
    assert!(!options.is_empty(), "{:?}", result.problems);
    let now = sight(file, &bytes, "");
    for (number, option) in options {
        let new = taken(file, &bytes, &result, number);
        let gain = sight(file, &new.drawing, &new.side_car) / now - 1.0;
        let claim = option.gain["degree"];
        let holds = (claim.low - ELSEWHERE..=claim.high + ELSEWHERE).contains(&gain);
        assert!(holds, "{file} {}: {gain}, {claim:?}", option.words);
        assert!(option.words.contains(&option.works[0].words), "{}", option.words);
        assert!(!new.side_car.contains("EF-MOVE"), "{}", new.side_car);
    }
}

/// The file of each option with the side-car beside it measures what the round says of it, to the last digit.
fn repeats(file: &str) {
    let (_, Outcome { result, files, .. }) = of_sample(file);
    repeats_in(&result, &files, file);
}

fn repeats_in(result: &RoundResult, files: &[OutFile], file: &str) {
    let named = |name: String| files.iter().find(|f| f.path.ends_with(&name)).unwrap();
    let ending = file.rsplit_once('.').unwrap().1;
    let best = result.best.iter().map(|b| ("best".to_owned(), &b.mean));
    let options = (1..).zip(&result.candidates).map(|(i, c)| (format!("candidate-{i}"), &c.mean));
    for (name, claimed) in options.chain(best) {
        let side_car = String::from_utf8(named(format!("{name}.enfilade.toml")).bytes.clone()).unwrap();
        let settings = Settings::new(Partial::from_toml("", &side_car).unwrap()).unwrap();
        let name = format!("{name}.{ending}");
        let input = Input::new(&name, &named(name.clone()).bytes, 2);
        let (again, _) = analyse(&input, &settings, &Cancel::default()).unwrap();
        assert_eq!(again.result.mean, *claimed, "{file}: {name}");
    }
}

#[test]
fn an_option_measures_what_the_round_says() {
    ["flat.dxf", "flat.ifc", "flat.glb", "gallery.dxf"].into_iter().for_each(repeats);
}

#[test]
fn what_a_drawing_gains_by_works_is_measured_again() {
    claims_hold("flat.dxf");
}

#[test]
fn what_a_building_gains_by_works_is_measured_again() {
    claims_hold("flat.ifc");
}

#[test]
fn what_a_scene_gains_by_works_is_measured_again() {
    claims_hold("flat.glb");
}

/// Each point brings more than the one before for more wall, keeps the budget, and is a drawing that measures as promised.
#[test]
fn points_of_the_front_can_be_taken() {
    let (bytes, Outcome { result, .. }) = of_sample("flat.dxf");
    let front = &result.front;
    assert!(front.len() > 2, "{front:?}");
    assert!(front.iter().enumerate().all(|(i, p)| p.point == i + 1 && p.works.len() <= 3));
    assert!(front.is_sorted_by(|a, b| a.effort.length_m() < b.effort.length_m()), "{front:?}");
    assert!(front.is_sorted_by(|a, b| a.gain["degree"].share < b.gain["degree"].share), "{front:?}");
    let now = sight("flat.dxf", &bytes, "");
    for point in [&front[0], &front[front.len() - 1]] {
        let new = chosen("flat.dxf", &bytes, &result, Chosen::Point(point.point)).unwrap();
        assert!(new.side_car.contains(&format!("point = {}", point.point)), "{}", new.side_car);
        let gain = sight("flat.dxf", &new.drawing, &new.side_car) / now - 1.0;
        let claim = point.gain["degree"];
        assert!((claim.low - ELSEWHERE..=claim.high + ELSEWHERE).contains(&gain), "{gain}, {claim:?}");
    }
    let beyond = chosen("flat.dxf", &bytes, &result, Chosen::Point(front.len() + 1)).unwrap_err().to_string();
    assert!(beyond.contains(&format!("has points 1 to {}", front.len())), "{beyond}");
    let small = round("flat.dxf", &bytes, "budget = \"1 m\"\n").result.front;
    assert!(small.iter().all(|p| p.effort.length_m() <= 1.0), "{small:?}");
}

/// Moves of the search go with works where they bring their share; the file has both, and so has the accepted drawing.
#[test]
fn works_and_moves_go_together() {
    let bytes = std::fs::read(sample("small-office.dxf")).unwrap();
    let text = "evaluations = 120\nseed = 1\nbudget = \"1 m\"\n";
    let settings = Settings::new(Partial::from_toml("", text).unwrap()).unwrap();
    let input = Input::new("small-office.dxf", &bytes, 1);
    let Outcome { result, files, .. } =
        run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap();
    let still: Vec<f64> = result.moves.iter().map(|m| m.kind.identity()).collect();
    let both = building(&result).into_iter().find(|(_, c)| c.parameters != still);
    let (number, option) = both.expect("an option that builds and moves");
    let moved = option.parameters.iter().zip(&still).filter(|(p, s)| p != s).count();
    assert!((1..=5).contains(&moved) && !option.changes.is_empty(), "{option:?}");
    assert!(option.works.iter().map(|w| w.effort.length_m()).sum::<f64>() <= 1.0, "{option:?}");
    // Its works alone are a point of the front, unless others bring more for as much.
    if let Some(alone) = result.front.iter().find(|p| p.works == option.works) {
        let [with, without] = [&option.gain, &alone.gain].map(|g| g["degree"].share);
        assert!(with > without, "{with} {without}");
    }
    let now = sight("small-office.dxf", &bytes, "");
    let new = taken("small-office.dxf", &bytes, &result, number);
    let gain = sight("small-office.dxf", &new.drawing, &new.side_car) / now - 1.0;
    let claim = option.gain["degree"];
    assert!((claim.low - ELSEWHERE..=claim.high + ELSEWHERE).contains(&gain), "{gain}, {claim:?}");
    repeats_in(&result, &files, "small-office.dxf");
}

/// The front reaches what the options bring, also under a budget: sizes of works are joined to fit it.
#[test]
fn the_front_reaches_the_best_option() {
    let bytes = std::fs::read(sample("school-wing.dxf")).unwrap();
    for budget in ["none", "2 works, 4 m"] {
        let Outcome { result, .. } = round("school-wing.dxf", &bytes, &format!("budget = {budget:?}\n"));
        let gain = |g: &enfilade_overlay::result::Gains| g["degree"].share;
        let best = building(&result).iter().map(|(_, c)| gain(&c.gain)).fold(0.0, f64::max);
        let last = result.front.last().expect("a point");
        assert!(gain(&last.gain) > best - 0.01, "{budget}: {best} {last:?}");
        assert!(last.works.len() > 1, "{budget}: {last:?}");
        let cost = |c: &Candidate| c.works.iter().map(|w| w.effort.length_m()).sum::<f64>();
        let within = |m: f64| budget == "none" || m < 4.05;
        assert!(building(&result).iter().all(|(_, c)| within(cost(c))), "{:?}", result.candidates);
        assert!(result.front.iter().all(|p| within(p.effort.length_m())), "{:?}", result.front);
    }
}

/// An option has at most three works, each of which brings its share; no two options look alike but the least change.
#[test]
fn sets_of_works_are_few_and_differ() {
    let (_, Outcome { result, .. }) = of_sample("small-office.dxf");
    let sets: Vec<usize> = building(&result).iter().map(|(_, c)| c.works.len()).collect();
    assert!(sets.iter().all(|n| (1..=3).contains(n)) && sets.iter().any(|n| *n > 1), "{sets:?}");
    let least =
        building(&result).iter().filter(|(_, c)| c.words.contains("No cheaper works bring half")).count();
    assert!(least <= 1, "{:?}", result.candidates);
}

/// The list of the round has every work of its options as allowed; the options stand in the order of what they gain.
#[test]
fn options_are_of_what_is_allowed() {
    let (_, Outcome { result, files, .. }) = of_sample("flat.dxf");
    let works = files.iter().find(|f| f.path.ends_with("works.json")).unwrap();
    let works: WorksResult = serde_json::from_slice(&works.bytes).unwrap();
    for work in building(&result).iter().flat_map(|(_, c)| &c.works) {
        let listed = works.works.iter().find(|w| w.kind == work.kind && w.stretch == work.stretch);
        assert!(listed.is_some_and(|w| w.is_allowed), "{work:?}");
        let gone: f64 = work.demolished.iter().map(|q| (q[0][0] - q[1][0]).hypot(q[0][1] - q[1][1])).sum();
        assert!((gone - work.effort.demolished_m).abs() < 2e-3, "{work:?}");
    }
    let gains: Vec<f64> =
        result.candidates.iter().map(|c| c.gain.values().map(|g| g.share).sum::<f64>()).collect();
    assert!(gains.is_sorted_by(|a, b| a >= b), "{gains:?}");
}

/// No option breaks a limit of the brief that the present layout keeps; its words name a goal that it breaks.
#[test]
fn options_keep_the_brief() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let opens = |o: &Outcome<RoundResult>| {
        o.result.candidates.iter().filter(|c| c.words.contains("between Kitchen and Living room")).count()
    };
    let under = |ask: &str| round("flat.dxf", &bytes, &format!("[brief]\nitems = [\"{ask}\"]\n"));
    let left_out = |o: &Outcome<RoundResult>| o.report.problems.iter().any(|p| p.code == "options-brief");
    let limit = under("kitchen not-reached-from living");
    let opens_kitchen = |p: &FrontPoint| p.words.contains("etween Kitchen and Living room");
    let front = &limit.result.front;
    assert!(
        !front.iter().any(opens_kitchen) && front.iter().enumerate().all(|(i, p)| p.point == i + 1),
        "{front:?}"
    );
    assert_eq!((opens(&limit), left_out(&limit)), (0, true), "{:?}", limit.result.candidates);
    assert!(!limit.result.candidates.is_empty() && limit.result.candidates[0].file == "candidate-1.dxf");
    let goal = under("goal: kitchen not-reached-from living");
    assert!(opens(&goal) > 0 && !left_out(&goal), "{:?}", goal.result.candidates);
    let told = goal.result.candidates.iter().find(|c| c.words.contains("Kitchen and Living room")).unwrap();
    assert!(
        told.words.contains("It no longer meets `goal: kitchen not-reached-from living`"),
        "{}",
        told.words
    );
    assert_eq!(told.brief[0].verdict, "fail");
    let wish = under("kitchen reached-from living");
    assert_eq!(wish.result.brief[0].verdict, "fail");
    let met = wish.result.candidates.iter().find(|c| c.words.contains("Kitchen and Living room")).unwrap();
    assert!(met.words.contains("It meets `kitchen reached-from living` of the brief now"), "{}", met.words);
}

/// Whoever says what may move is offered nothing else.
#[test]
fn marks_of_moves_are_obeyed() {
    let (_, Outcome { result, .. }) = of_sample("gallery.dxf");
    assert!(building(&result).is_empty() && !result.candidates.is_empty());
}

/// Whoever lets nothing move but what is marked, and marks nothing, is offered works alone.
#[test]
fn where_nothing_moves_works_are_offered() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let Outcome { result, .. } = round("flat.dxf", &bytes, "only-marked = true\n");
    assert!(result.moves.is_empty() && !result.candidates.is_empty());
    assert_eq!(building(&result).len(), result.candidates.len());
    assert_eq!(result.stopped_by, "nothing may move: building works were measured");
    // The page and the table have what is asked for, with the present layout's values.
    assert!(result.objectives.iter().all(|o| o.initial > 0.0) && !result.objectives.is_empty());
}

/// One thread or many, the same options.
#[test]
fn options_that_build_are_the_same_on_any_number_of_threads() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let on = |threads: usize| {
        let settings = format!("{FEW}threads = {threads}\n");
        let settings = Settings::new(Partial::from_toml("", &settings).unwrap()).unwrap();
        let input = Input::new("flat.dxf", &bytes, 1);
        let round = enfilade_pipeline::on_threads(&settings, || {
            run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default())
        });
        round.unwrap().result.candidates
    };
    assert_eq!(on(1), on(3));
}

/// A mark that keeps a part of a wall keeps openings off that part, and leaves the rest.
#[test]
fn what_is_kept_of_a_wall_is_not_opened() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let listed = |more: &str| {
        let settings = Settings::new(Partial::from_toml("", more).unwrap()).unwrap();
        works_of(&Input::new("flat.dxf", &bytes, 1), &settings, &Cancel::default()).unwrap().0.result
    };
    let kept =
        "[[region]]\nkind = \"keep\"\npoints = [[9100, 2400], [9450, 2400], [9450, 2900], [9100, 2900]]\n";
    let at_the_box = |w: &&WorkEntry| {
        let [a, b] = w.stretch;
        let is_on_the_wall = (a[0] - 9.29).abs() < 0.05 && (b[0] - 9.29).abs() < 0.05;
        is_on_the_wall && a[1].min(b[1]) < 2.9 && a[1].max(b[1]) > 2.4
    };
    let free = listed("");
    assert!(free.works.iter().filter(at_the_box).any(|w| w.is_allowed));
    let held = listed(kept);
    let held_there: Vec<&WorkEntry> = held.works.iter().filter(at_the_box).collect();
    assert!(held_there.iter().all(|w| !w.is_allowed), "{held_there:?}");
    assert!(held_there.iter().any(|w| w.forbidden_by.contains(&"kept".to_owned())));
    // Beside the box the same wall is opened.
    let is_beside =
        |w: &&WorkEntry| (w.stretch[0][0] - 9.29).abs() < 0.05 && w.is_allowed && w.kind == "open";
    assert!(held.works.iter().any(|w| is_beside(&w)));
}

/// Who holds the length of walls is offered nothing that changes it.
#[test]
fn works_are_held_to_the_length_of_walls() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let Outcome { result, .. } = round("flat.dxf", &bytes, "limit = \"wall-length -0.1%\"\n");
    assert!(building(&result).is_empty(), "{:?}", result.candidates);
    // A penalty counts moves alone: each work states its own cost.
    let Outcome { result, .. } = round("flat.dxf", &bytes, "penalty = \"wall-length 1\"\n");
    assert!(!building(&result).is_empty());
}

/// One option is the best there is, and so is the one of mode best.
#[test]
fn the_one_option_is_the_best() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    for more in ["members = 1\n", "mode = \"best\"\n"] {
        let Outcome { result, .. } = round("flat.dxf", &bytes, more);
        let [one] = &result.candidates[..] else { panic!("{more}: {:?}", result.candidates) };
        assert!(one.works.len() > 1 && one.gain["degree"].low > 0.2, "{more}: {}", one.words);
    }
}

/// No option costs more than the budget holds, and what costs more is named.
/// The last option that builds, as a side-car keeps it.
fn pin(result: &RoundResult) -> (&Candidate, String) {
    let (_, option) = building(result).pop().unwrap();
    let work = |w: &OptionWork| format!("{{ kind = {:?}, stretch = {:?} }}", w.kind, w.stretch);
    let works: Vec<String> = option.works.iter().map(work).collect();
    let text =
        format!("[[pin-option]]\nparameters = {:?}\nworks = [{}]\n", option.parameters, works.join(", "));
    (option, text)
}

/// A pinned option that builds stands first, the same to the last digit, and the others are unlike it.
#[test]
fn an_option_that_builds_can_be_pinned() {
    let stated = |o: &Candidate| (o.mean.clone(), o.gain.clone(), o.works.clone());
    for file in ["flat.dxf", "flat.ifc"] {
        let (bytes, first) = of_sample(file);
        let (option, pin) = pin(&first.result);
        assert_eq!(first.result.pinned_count(), 0);
        let next = round(file, &bytes, &pin).result;
        assert_eq!(next.pinned_count(), 1, "{file}: {:?}", next.problems);
        assert_eq!(stated(&next.candidates[0]), stated(option), "{file}");
        assert!(next.candidates[1..].iter().all(|c| c.works != option.works));
        let moved = next.settings["pinned_options"][0]["works"].as_array().map(Vec::len);
        assert_eq!(moved, Some(option.works.len()));
    }
}

/// What a pinned option breaks by now is told, and it stays; a place that is gone is told, and the round goes on.
#[test]
fn what_a_pinned_option_that_builds_breaks_is_told() {
    let (bytes, first) = of_sample("flat.dxf");
    let (option, pin) = pin(&first.result);
    let has = |result: &RoundResult, code: &str| result.problems.iter().any(|p| p.code == code);
    let broken = round("flat.dxf", &bytes, &format!("budget = \"1 work, 0.2 m\"\n{pin}")).result;
    assert_eq!(broken.candidates[0].works, option.works);
    assert_eq!(broken.candidates[0].explanation.breaks.len(), 1);
    assert!(has(&broken, "pinned-breaks") && !broken.candidates[0].within_threshold);
    // Both of one stretch, and more numbers than moves.
    let twice = pin.replacen("works = [", "works = [{ kind = \"open\", stretch = STRETCH }, ", 1);
    let [[a, b], [c, d]] = option.works[0].stretch;
    let twice = twice.replace("STRETCH", &format!("[[{a:?}, {b:?}], [{c:?}, {d:?}]]"));
    let twice = round("flat.dxf", &bytes, &twice).result;
    assert!(has(&twice, "pin-works") && twice.pinned_count() == 0);
    let longer = pin.replacen("parameters = [", "parameters = [0.0, ", 1);
    let settings = Settings::new(Partial::from_toml("", &format!("{FEW}{longer}")).unwrap()).unwrap();
    let input = Input::new("flat.dxf", &bytes, 1);
    let refused = run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default());
    assert!(matches!(refused, Err(Error::Usage(_))));
    let unknown = pin.replace("\"widen\"", "\"blow-up\"").replace("\"open\"", "\"blow-up\"");
    assert!(Partial::from_toml("", &unknown).and_then(Settings::new).is_err());
    let [x, y] = option.works[0].stretch[0];
    let elsewhere = pin.replacen(&format!("[{x:?}, {y:?}]"), "[-50.0, 0.0]", 1);
    assert_ne!(elsewhere, pin);
    let gone = round("flat.dxf", &bytes, &elsewhere).result;
    assert!(has(&gone, "pin-works") && gone.pinned_count() == 0 && !gone.candidates.is_empty());
}

#[test]
fn options_keep_to_the_budget() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let of = |budget: &str| round("flat.dxf", &bytes, &format!("budget = {budget:?}\n"));
    let (free, one, short) = (of("none"), of("1 work"), of("1 m"));
    let most = |o: &Outcome<RoundResult>| o.result.candidates.iter().map(|c| c.works.len()).max();
    assert_eq!([most(&free), most(&one), most(&short)], [Some(2), Some(1), Some(1)]);
    let length = |c: &Candidate| c.works.iter().map(|w| w.effort.length_m()).sum::<f64>();
    assert!(short.result.candidates.iter().all(|c| length(c) <= 1.0));
    assert!(free.result.candidates.iter().any(|c| length(c) > 1.0));
    let named = |o: &Outcome<RoundResult>| o.report.problems.iter().any(|p| p.code == "works-budget");
    assert_eq!([&free, &one, &short].map(named), [false, false, true]);
}

/// Rooms of one name: options between them say where they are, and only these.
#[test]
fn options_of_one_name_say_where_they_are() {
    let bytes = std::fs::read(sample("small-office.dxf")).unwrap();
    let mut text = String::from_utf8(bytes).unwrap();
    (1..=9).for_each(|n| text = text.replace(&format!("Office {n}"), "Office"));
    let Outcome { result, .. } = round("plan.dxf", text.as_bytes(), "members = 8\n");
    let options = building(&result);
    let names: Vec<String> = options.iter().map(|(_, c)| titles(&c.works)).collect();
    let once: BTreeSet<&String> = names.iter().collect();
    assert_eq!(once.len(), names.len(), "{names:?}");
    let works: Vec<_> = options.iter().flat_map(|(_, c)| &c.works).collect();
    let is_placed: Vec<bool> = works.iter().map(|w| w.words.ends_with(&w.place_words())).collect();
    assert!(is_placed.contains(&true) && is_placed.contains(&false), "{names:?}");
    let is_ambiguous = |w: &&OptionWork| w.words.contains(" in Office");
    assert!(works.iter().zip(&is_placed).all(|(w, placed)| is_ambiguous(w) == *placed), "{names:?}");
}
