use super::*;
use std::path::Path;

#[test]
fn defaults_are_valid_and_stated() {
    let s = Settings::new(Partial::default()).unwrap();
    assert_eq!(s.objective_text(), "degree max 0.7, mean-depth min 0.7");
    let paper = Partial { method: Some(Method::Paper), ..Partial::default() };
    assert_eq!(Settings::new(paper).unwrap().objectives.len(), 3);
    assert!((s.least_gain - 0.01).abs() < 1e-12);
    for (text, share) in [("2 %", 0.02), ("0.5%", 0.005), ("0.03", 0.03), ("0", 0.0)] {
        let s = Settings::new(Partial { least_gain: Some(text.into()), ..Partial::default() }).unwrap();
        assert!((s.least_gain - share).abs() < 1e-12, "{text}");
    }
    assert!(Settings::new(Partial { least_gain: Some("much".into()), ..Partial::default() }).is_err());
    assert_eq!(
        s.score,
        [(Measure::Degree, 1.0), (Measure::Depth, -1.0), (Measure::Entropy, 1.0)]
            .map(|(m, w)| (Aim::mean(m), w))
    );
    assert!(s.penalties.is_empty());
}

#[test]
fn what_is_wrong_is_named() {
    let with = |f: fn(&mut Partial)| {
        let mut p = Partial::default();
        f(&mut p);
        Settings::new(p).unwrap_err().to_string()
    };
    for (message, part) in [
        (
            with(|p| p.limit = Some("degree >= 40, depth <= 9, degree <= 30".into())),
            "degree >= 40 and degree <= 30",
        ),
        (with(|p| p.objective = Some("beauty max 1".into())), "beauty"),
        (with(|p| p.objective = Some("degree max 1.5".into())), "expected a share from 0 to 1"),
        (with(|p| p.snap = Some("5".into())), "each above 0 with its unit"),
        (with(|p| p.objective = Some("score max, degree max".into())), "alone"),
        (with(|p| p.score = Some("degree".into())), "\"degree\""),
        (with(|p| p.penalty = Some("clearance -1".into())), "clearance -1"),
        (with(|p| p.limit = Some("degree 40".into())), "degree 40"),
        (with(|p| p.link = Some(vec!["same: a, b".into(), "equal: b, c, d".into()])), "twice"),
        (with(|p| p.snap = Some("0".into())), "snap"),
        (with(|p| p.most_moves = Some(0)), "most-moves"),
        (with(|p| p.together = Some(TOGETHER_MAX + 1)), "together"),
        (with(|p| p.budget = Some("4 yd".into())), "budget"),
        (with(|p| p.seed = Some(SEED_MAX + 1)), "at most 9223372036854775807"),
        (with(|p| p.pin = Some(vec![vec![]; 5])), "pin"),
        (with(|p| p.like = Some(vec![f64::NAN])), "finite"),
        (with(|p| p.write_every = Some(0.5)), "write-every"),
        (with(|p| p.objective = Some("degree@a@b max".into())), "degree@a@b"),
        (with(|p| p.spacing = Some(0.0)), "spacing"),
        (with(|p| p.spacing = Some(f64::NAN)), "spacing"),
        (with(|p| p.members = Some(0)), "members"),
        (with(|p| p.members = Some(MEMBERS_MAX + 1)), "members"),
        (with(|p| p.threads = Some(THREADS_MAX + 1)), "threads"),
        (with(|p| p.evaluations = Some(EVALUATIONS_MAX + 1)), "evaluations"),
    ] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn unknown_keys_are_errors_with_line_and_column() {
    let e = Partial::from_toml("enfilade.toml", "seed = 3\n  colour = 1\n").unwrap_err();
    assert!(
        e.to_string().starts_with(
            "enfilade.toml:2 column 3: unknown key `colour`; did you mean `colours`? known are unit, "
        ),
        "{e}"
    );
}

#[test]
fn the_nearer_source_wins() {
    let folder = Partial::from_toml("a", "seed = 3\nmembers = 2").unwrap();
    let drawing = Partial::from_toml("b", "seed = 4").unwrap();
    let s = Settings::new(drawing.over(folder)).unwrap();
    assert_eq!((s.seed, s.members), (4, 2));
}

#[test]
fn rules_of_a_source_farther_off_are_lifted() {
    let carried = || {
        let text = "limit = \"wall-length -5%\"\nlink = [\"same: a, b\"]\nsnap = \"0.1 m\"\n";
        Partial::from_toml("plan.enfilade.toml", text).unwrap()
    };
    for none in ["none", " none ", ""] {
        let lift = Partial {
            limit: Some(none.into()),
            link: Some(vec![none.into()]),
            snap: Some(none.into()),
            ..Partial::default()
        };
        let s = Settings::new(lift.over(carried())).unwrap();
        assert_eq!((s.limits.len(), s.links.len(), s.snap), (0, 0, None), "{none:?}");
    }
    let both = Partial { link: Some(vec!["none".into(), "same: a, b".into()]), ..Partial::default() };
    assert!(Settings::new(both).is_err(), "none, and one");
}

#[test]
fn a_value_that_makes_no_sense_names_file_and_line() {
    let e = Partial::from_toml("plan.enfilade.toml", "seed = 3\nobjective = \"degree up\"\n").unwrap_err();
    assert!(e.to_string().starts_with("plan.enfilade.toml:2: objective: found \"degree up\""), "{e}");
}

#[test]
fn numbers_of_a_layout_keep_the_moves_they_belong_to() {
    let of = |name: &str| {
        let text = "pin = [[1.0]]\nwarm = [[2.0]]\n[[pin-move]]\nname = \"N\"\nkind = \"x\"\nunit = \"m\"\ngeometry = \"0\"\n";
        Partial::from_toml("a", &text.replace('N', name)).unwrap()
    };
    let asked = Partial { like: Some(vec![0.5]), ..Partial::default() };
    assert_eq!(asked.over(of("a")).pin_moves, []);
    assert_eq!(Partial::default().over(of("a")).pin_moves[0].name, "a");
    assert_eq!(of("b").over(of("a")).pin_moves[0].name, "b");
}

#[test]
fn a_side_car_that_is_named_otherwise_is_told_apart() {
    let found = |names: &[&str]| {
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        unread_side_cars(Path::new("offices/plan.glb"), &names)
    };
    for name in
        ["plan.glb.enfilade.toml", "plan.enfilade.toml.txt", "Plan.enfilade.TOML", "plan-enfilade.toml"]
    {
        assert_eq!(found(&[name]), [(name.to_string(), "plan.enfilade.toml".to_string())]);
    }
    assert_eq!(found(&["Enfilade.toml"]), [("Enfilade.toml".to_string(), "enfilade.toml".to_string())]);
    let read = ["plan.glb", "plan.enfilade.toml", "enfilade.toml", "other.glb.enfilade.toml", "plan.toml"];
    assert_eq!(found(&read), []);
}

#[test]
fn a_layout_pinned_twice_is_one() {
    let pinned = |pin: &[&[f64]]| {
        let pin = Some(pin.iter().map(|p| p.to_vec()).collect());
        Settings::new(Partial { pin, ..Partial::default() }).unwrap().pinned
    };
    assert_eq!(pinned(&[&[1.0, 2.0], &[0.5, 2.0], &[1.0, 2.0]]), [[1.0, 2.0], [0.5, 2.0]]);
    // Options that are not looked up yet are as many as are named.
    assert_eq!(pinned(&[&[], &[]]).len(), 2);
}

/// Beyond what coordinates can be, a centre would silently become another.
#[test]
fn a_lattice_centre_lies_where_drawings_can() {
    let at = |x: f64| Settings::new(Partial { lattice_centre: Some([0.0, x]), ..Partial::default() });
    assert!(at(-LATTICE_CENTRE_MAX_M).is_ok());
    for far in [LATTICE_CENTRE_MAX_M * 1.01, -1e300] {
        let Err(Error::Usage(refused)) = at(far) else { panic!("{far}") };
        assert!(refused.text.contains("lattice-centre") && refused.text.len() < 120, "{}", refused.text);
    }
}
