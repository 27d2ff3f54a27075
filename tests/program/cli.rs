//! The program as a user runs it.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn enfilade(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enfilade")).args(args).output().unwrap()
}

fn sample(name: &str) -> String {
    enfilade_fixtures::repository("samples").join(name).to_string_lossy().into_owned()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// All files below a folder with their bytes; result.json without the time it took.
fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut out: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| {
            let path = e.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let mut bytes = std::fs::read(&path).unwrap();
            if name == "result.json" {
                let mut value = json(&path);
                value["seconds"] = Value::Null;
                bytes = value.to_string().into_bytes();
            }
            (name, bytes)
        })
        .collect();
    out.sort();
    out
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_one_and_two_threads() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, threads: &str| {
        let out = folder.path().join(name);
        let out_text = out.to_string_lossy().into_owned();
        let args = [
            "run",
            &sample("gallery.dxf"),
            "--evaluations",
            "200",
            "--seed",
            "3",
            "--threads",
            threads,
            "--out",
            &out_text,
            "-q",
        ];
        let output = enfilade(&args);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
        files(&out.join("gallery.enfilade/round-01"))
    };
    let (a, b, c) = (run("a", "1"), run("b", "2"), run("c", "2"));
    let names: Vec<&String> = a.iter().map(|f| &f.0).collect();
    for expected in [
        "result.json",
        "report.html",
        "initial.dxf",
        "candidate-2.dxf",
        "best.dxf",
        "candidate-1-score.png",
        "candidate-1-degree-change.png",
        "diversity.png",
        "convergence.png",
    ] {
        assert!(names.iter().any(|n| *n == expected), "{expected} is missing in {names:?}");
    }
    for ((x, y), z) in a.iter().zip(&b).zip(&c) {
        assert!(x == y && y == z, "{} differs", x.0);
    }
}

#[test]
fn what_is_reported_is_what_the_written_drawing_measures() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let output = enfilade(&[
        "run",
        &sample("gallery.dxf"),
        "--spacing",
        "0.5",
        "--evaluations",
        "80",
        "--out",
        &out,
        "-q",
    ]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
    let round = folder.path().join("gallery.enfilade/round-01");
    let result = json(&round.join("result.json"));
    assert_eq!(result["schema"], "enfilade.result/1");
    for candidate in result["candidates"].as_array().unwrap() {
        let file = round.join(candidate["file"].as_str().unwrap());
        let output = enfilade(&[
            "analyse",
            &file.to_string_lossy(),
            "--spacing",
            "0.5",
            "--json",
            "-",
            "-q",
            "--out",
            &out,
        ]);
        let again: Value = serde_json::from_slice(&output.stdout).unwrap();
        for key in ["degree", "depth", "entropy", "degree_all"] {
            assert_eq!(again["mean"][key], candidate["mean"][key], "{key}");
        }
        for (i, p) in candidate["parameters"].as_array().unwrap().iter().enumerate() {
            let (lo, hi) = (
                result["moves"][i]["lower"].as_f64().unwrap(),
                result["moves"][i]["upper"].as_f64().unwrap(),
            );
            assert!((lo..=hi).contains(&p.as_f64().unwrap()));
        }
    }
}

#[test]
fn an_accepted_option_is_the_next_rounds_present_layout() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.dxf");
    std::fs::copy(sample("gallery.dxf"), &plan).unwrap();
    let plan_text = plan.to_string_lossy().into_owned();
    let output = enfilade(&["run", &plan_text, "--spacing", "0.5", "--evaluations", "100", "-q"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
    let result = json(&folder.path().join("plan.enfilade/round-01/result.json"));
    let before = std::fs::read(&plan).unwrap();
    let output = enfilade(&["accept", &plan_text, "1"]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
    assert_eq!(std::fs::read(&plan).unwrap(), before, "the drawing was touched");
    let next = folder.path().join("plan-r02.dxf").to_string_lossy().into_owned();
    // All that was stated is left, also where nothing can be built any more.
    let allow = "open-joints, crossings, narrow-ways, things";
    let output = enfilade(&["run", &next, "--evaluations", "30", "-q", "--allow", allow]);
    assert!(matches!(output.status.code(), Some(0 | 1)), "{}", text(&output.stderr));
    let again = json(&folder.path().join("plan-r02.enfilade/round-01/result.json"));
    for key in ["degree", "depth", "entropy"] {
        assert_eq!(again["initial"]["mean"][key], result["candidates"][0]["mean"][key], "{key}");
    }
    assert_eq!(again["lineage"][0]["drawing"], "plan.dxf");
    for (i, p) in result["candidates"][0]["parameters"].as_array().unwrap().iter().enumerate() {
        let width =
            |r: &Value| r["moves"][i]["upper"].as_f64().unwrap() - r["moves"][i]["lower"].as_f64().unwrap();
        assert!((width(&result) - width(&again)).abs() < 1e-9);
        let left = result["moves"][i]["upper"].as_f64().unwrap() - p.as_f64().unwrap();
        // Written to the micrometre, as walls are.
        let now = again["moves"][i]["upper"].as_f64().unwrap();
        assert!(
            (now - left.max(0.0)).abs() < 0.6e-6 && ((now * 1e8).round() / 1e8 - now).abs() < 1e-15,
            "{now}"
        );
    }
    let output = enfilade(&["accept", &plan_text, "9"]);
    assert_eq!(output.status.code(), Some(3));
}

/// Units that have no name for `--unit` (decimetres, yards, a scale) hold in the next round too.
#[test]
fn an_accepted_option_keeps_a_unit_without_a_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("gallery.dxf");
    std::fs::copy(sample("gallery.dxf"), &file).unwrap();
    let at = file.to_string_lossy().into_owned();
    let options =
        ["--unit", "0.9144m", "--evaluations", "12", "--members", "1", "--spacing", "2", "-q", "--raw"];
    let done = enfilade(&[&["run", &at], &options[..]].concat());
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", text(&done.stderr));
    assert_eq!(enfilade(&["accept", &at, "1"]).status.code(), Some(0));
    let next = folder.path().join("gallery-r02.dxf").to_string_lossy().into_owned();
    let checked = enfilade(&["check", &next, "--json", "-"]);
    assert!(!checked.stdout.is_empty(), "{}", text(&checked.stderr));
    let told: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(told["unit"]["metres"], 0.9144, "{}", told["unit"]);
}

/// A scene that was read by the building beside it is read by it again once an option is accepted.
#[test]
fn an_accepted_scene_keeps_its_building() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["pavilion.glb", "pavilion.ifc"] {
        std::fs::copy(sample(name), folder.path().join(name)).unwrap();
    }
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let brief = ["--evaluations", "12", "--members", "1", "-q", "--raw"];
    let first = enfilade(&[&["run", &path("pavilion.glb"), "--storey", "2"], &brief[..]].concat());
    assert!(matches!(first.status.code(), Some(0 | 1)), "{}", text(&first.stderr));
    assert_eq!(enfilade(&["accept", &path("pavilion.glb"), "1"]).status.code(), Some(0));
    let next = enfilade(&[&["run", &path("pavilion-r02.glb")], &brief[..]].concat());
    assert!(matches!(next.status.code(), Some(0 | 1)), "{}", text(&next.stderr));
    let of = |name: &str| json(&folder.path().join(format!("{name}.enfilade/round-01/result.json")));
    assert_eq!(of("pavilion")["counts"]["vertices"], of("pavilion-r02")["counts"]["vertices"]);
}

/// A building has elements, each counted once whatever it shows on a layer; its walls fall to pieces where it is cut.
#[test]
fn check_says_what_it_counts() {
    let folder = tempfile::tempdir().unwrap();
    let says = |name: &str| {
        let file = folder.path().join(name);
        std::fs::copy(sample(name), &file).unwrap();
        text(&enfilade(&["check", &file.to_string_lossy()]).stdout)
    };
    for name in ["pavilion.ifc", "pavilion.glb"] {
        let said = says(name);
        let spaces = said.lines().find(|l| l.starts_with("layer IfcSpace ")).unwrap();
        assert!(spaces.contains("  2 elements  ignored"), "{said}");
        assert!(said.contains(" pieces of walls at the cut (") && !said.contains("wall elements"), "{said}");
    }
    let drawn = says("gallery.dxf");
    assert!(drawn.contains(" wall elements (") && drawn.contains(" entities  "), "{drawn}");
}

#[test]
fn a_zone_is_a_region_of_query() {
    let folder = tempfile::tempdir().unwrap();
    let house = std::fs::read_to_string(sample("pavilion.ifc")).unwrap();
    let space = house.lines().find(|l| l.contains("IFCSPACE(")).unwrap().split('=').next().unwrap();
    let zone = format!(
        "#90001=IFCZONE('3ZoneGlobalId000000001',$,'Public',$,$);\n\
         #90003=IFCRELASSIGNSTOGROUP('3ZoneGlobalId000000003',$,$,$,({space}),$,#90001);\nENDSEC;\nEND-ISO"
    );
    let file = folder.path().join("house.ifc");
    std::fs::write(&file, house.replace("ENDSEC;\nEND-ISO", &zone)).unwrap();
    let at = file.to_string_lossy().into_owned();
    let done = enfilade(&["check", &at, "--query", "zone:pub*", "--json", "-"]);
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", text(&done.stderr));
    let told: Value = serde_json::from_slice(&done.stdout).unwrap();
    let regions = told["regions"].as_array().unwrap().iter().filter(|r| r["kind"] == "query");
    let areas: Vec<f64> = regions.map(|r| r["area_m2"].as_f64().unwrap()).collect();
    assert!(matches!(areas[..], [a] if (a - 75.24).abs() < 0.01), "{}", told["regions"]);
    let done = enfilade(&["check", &at, "--query", "zone:private"]);
    assert_eq!(done.status.code(), Some(3));
    assert!(
        text(&done.stderr).contains("no such zone, zones present on \"Ground floor\": Public"),
        "{}",
        text(&done.stderr)
    );
    let done = enfilade(&["check", &at, "--query", "room:1"]);
    assert!(text(&done.stderr).contains("expected space:NAME or zone:NAME"), "{}", text(&done.stderr));
}

#[test]
fn exit_codes_and_messages() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        path.to_string_lossy().into_owned()
    };
    let no_walls = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nROOF\n10\n0\n20\n0\n11\n5\n21\n0\n0\nLINE\n8\nEAVES\n10\n0\n20\n0\n11\n5\n21\n0\n0\nENDSEC\n0\nEOF\n";
    let cut = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nWALL\n10\n0\n";
    for (args, code, part) in [
        (vec!["analyse", &write("none.dxf", no_walls)], 2, "EAVES (1)"),
        (vec!["analyse", &write("cut.dxf", cut)], 2, "cut.dxf"),
        (vec!["analyse", &write("empty.dxf", "")], 2, "empty"),
        (vec!["run", "no-such-file.dxf"], 2, "no such file"),
        (vec!["run", &sample("gallery.dxf"), "--objective", "beauty max 1"], 3, "beauty"),
        (vec!["run", &sample("gallery.dxf"), "--nonsense"], 3, "--nonsense"),
        (vec!["analyse", &sample("gallery.dxf"), "--unit", "yard"], 3, "yard"),
        (vec!["init", "no-such-folder"], 4, "the folder is not there: make it\n"),
        (vec!["watch", "--json", "x.json", "."], 3, "`enfilade status --json`"),
        (vec!["check", "--out", "x", &sample("gallery.dxf")], 3, "--preview"),
        (vec!["check", "--query-layer", "NOPE", &sample("gallery.dxf")], 1, "found no such layer drawn on"),
        (vec!["check", "--reference-layer", "0", &sample("gallery.dxf")], 1, "--reference-layer \"0\""),
        (vec!["resolution", "--spacing", "1", &sample("gallery.dxf")], 3, "--spacings"),
        (vec!["jobs", "--json", "x.json", &sample("gallery.dxf")], 3, "--output"),
        (vec!["jobs", "--threads", "2", &sample("gallery.dxf")], 3, "`run-job`"),
        (vec!["jobs", "--write-every", "9", &sample("gallery.dxf")], 3, "when it ends"),
        (vec!["jobs", "--progress", "json", &sample("gallery.dxf")], 3, "`run-job --progress`"),
        (vec!["jobs", "--seed", "9", "--seeds", "1,2", &sample("gallery.dxf")], 3, "--seed"),
        (vec!["--version"], 0, ""),
    ] {
        let output = enfilade(&args);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {said}");
        assert!(said.contains(part), "{args:?}: {said}");
    }
}

/// What could not be said is not done in silence; a reader that has gone is no fault.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_said() {
    let plan = sample("gallery.dxf");
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path().to_string_lossy().into_owned();
    for args in [
        vec!["jobs", &plan],
        vec!["status", &here],
        vec!["status", "--json", &here],
        vec!["man"],
        vec!["completions", "bash"],
        vec!["--help"],
    ] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let program = env!("CARGO_BIN_EXE_enfilade");
        let output = Command::new(program).args(&args).stdout(full).output().unwrap();
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{args:?}: {said}");
        assert!(said.contains("standard output"), "{args:?}: {said}");
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(program).args(&args).stdout(writer).output().unwrap();
        assert_eq!((output.status.code(), text(&output.stderr)), (Some(0), String::new()), "{args:?}");
    }
}

/// A folder that takes no state of the daemon's is found by whoever asks, and has one daemon.
#[test]
fn a_daemon_with_its_state_elsewhere_is_found() {
    use std::io::BufRead as _;
    let dir = tempfile::tempdir().unwrap();
    let plans = dir.path().join("plans");
    std::fs::create_dir(&plans).unwrap();
    std::fs::write(plans.join(".enfilade"), "").unwrap();
    let call = |args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
        command.args(args).arg(&plans).env("HOME", dir.path()).env_remove("XDG_STATE_HOME");
        command.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped());
        command
    };
    let at = |name: &str| dir.path().join(name).to_string_lossy().into_owned();
    let mut daemon = call(&["watch", "--fallback", &at("first")]).spawn().unwrap();
    let mut lines = std::io::BufReader::new(daemon.stdout.take().unwrap()).lines();
    assert!(lines.any(|l| l.unwrap().starts_with("watching")));
    let said = [
        call(&["status"]).output().unwrap(),
        call(&["doctor"]).output().unwrap(),
        call(&["watch", "--fallback", &at("second")]).output().unwrap(),
    ];
    daemon.kill().unwrap();
    daemon.wait().unwrap();
    let [status, doctor, second] = &said;
    let (status, doctor) = (text(&status.stdout), text(&doctor.stdout));
    assert!(status.contains(": watched\n") && status.contains(&at("first")), "{status}");
    assert!(doctor.contains("watched now") && doctor.contains(&at("first")), "{doctor}");
    let refusal = text(&second.stderr);
    assert_eq!(second.status.code(), Some(4), "{refusal}");
    assert!(refusal.contains(&at("first")) && !dir.path().join("second").exists(), "{refusal}");
}

/// A limit on the size of files is told like a full disk; the system would end the program without a word.
#[cfg(unix)]
#[test]
fn a_limit_on_the_size_of_files_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("plan.dxf");
    std::fs::copy(sample("gallery.dxf"), &plan).unwrap();
    let output = Command::new("sh")
        .args(["-c", "ulimit -f 8; exec \"$0\" analyse \"$1\"", env!("CARGO_BIN_EXE_enfilade")])
        .arg(&plan)
        .output()
        .unwrap();
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{:?}: {said}", output.status);
    assert!(said.contains("free some space"), "{said}");
    let home = folder.path().join("plan.enfilade");
    let left: Vec<_> = std::fs::read_dir(home).unwrap().map(|e| e.unwrap().file_name()).collect();
    assert!(left.iter().all(|n| !n.to_string_lossy().starts_with(".tmp-")), "{left:?}");
}

/// A name with line ends forges no line of what is said.
#[cfg(unix)]
#[test]
fn a_name_is_one_line_of_the_status() {
    let folder = tempfile::tempdir().unwrap();
    let state = folder.path().join(".enfilade");
    std::fs::create_dir(&state).unwrap();
    let forged = "a\n/plans/b.dxf: running\t\u{1b}[2J.dxf";
    let overview = serde_json::json!({"waiting": [forged], "waiting_count": 1, "failed": [], "ignored": []});
    std::fs::write(state.join("status.json"), overview.to_string()).unwrap();
    let said = text(&enfilade(&["status", &folder.path().to_string_lossy()]).stdout);
    assert_eq!(said.lines().count(), 2, "{said}");
    assert!(said.contains(r"a\n/plans/b.dxf: running\t\u{1b}[2J.dxf: waiting"), "{said}");
}

/// Whoever may write into a shared folder decides nothing outside of it (hazards, section 3).
#[test]
fn settings_files_send_results_below_themselves_alone() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("in/gallery.dxf");
    std::fs::create_dir(dir.path().join("in")).unwrap();
    std::fs::copy(sample("gallery.dxf"), &drawing).unwrap();
    let run = |said: &str| {
        std::fs::write(dir.path().join("in/enfilade.toml"), said).unwrap();
        enfilade(&["run", &drawing.to_string_lossy(), "--evaluations", "8", "--members", "1", "-q"])
    };
    let away = dir.path().join("away").to_string_lossy().replace('\\', "/");
    for said in [
        "out = \"../away\"",
        "out = \"r/../../away\"",
        &format!("out = \"{away}\""),
        "[watch]\nfallback = \"..\"",
    ] {
        let refused = run(said);
        let why = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(3), "{said}: {why}");
        assert!(why.contains("enfilade.toml") && why.contains("--out, --fallback"), "{why}");
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    assert!(matches!(run("out = \"./r/s\"").status.code(), Some(0 | 1)));
    assert!(dir.path().join("in/r/s/gallery.enfilade/round-01").is_dir());
}

#[test]
fn a_side_car_of_another_name_is_not_read_in_silence() {
    for sample_name in ["pavilion.glb", "pavilion.ifc", "gallery.dxf"] {
        let folder = tempfile::tempdir().unwrap();
        let drawing = folder.path().join(sample_name);
        std::fs::copy(sample(sample_name), &drawing).unwrap();
        let stem = sample_name.split('.').next().unwrap();
        let check = || enfilade(&["check", &drawing.to_string_lossy()]);
        std::fs::write(folder.path().join(format!("{sample_name}.enfilade.toml")), "seed = 3\n").unwrap();
        let told = check();
        let expected = format!("{sample_name}.enfilade.toml lies beside it and is not read");
        assert!(text(&told.stderr).contains(&expected), "{}", text(&told.stderr));
        assert!(text(&told.stderr).contains(&format!("a file named {stem}.enfilade.toml; rename it")));
        assert_eq!(told.status.code(), Some(1));
    }
}

#[test]
fn every_measure_has_a_column_and_a_heat_map() {
    let folder = tempfile::tempdir().unwrap();
    let (out, csv) = (folder.path().join("out"), folder.path().join("cells.csv"));
    let (out, csv) = (out.to_string_lossy(), csv.to_string_lossy());
    let gallery = folder.path().join("gallery.dxf").to_string_lossy().into_owned();
    std::fs::copy(sample("gallery.dxf"), &gallery).unwrap();
    let analyse = |more: &[&str]| {
        enfilade(&[&["analyse", &gallery, "--spacing", "1", "--out", &out, "--quiet"], more].concat())
    };
    let done = analyse(&["--measures", "Isovist Area, through", "--step-from", "2,2", "--cells", &csv]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let table = std::fs::read_to_string(&*csv).unwrap();
    let head = table.lines().next().unwrap();
    assert_eq!(
        head,
        "Ref,x,y,Isovist Area,Sight Lines Through,Visual Step Depth,Metric Step Shortest-Path Turn,\
         Metric Step Shortest-Path Length,Angular Step Depth,Degree,Depth,Entropy"
    );
    let here = table.lines().find(|l| l.contains(",2,2,")).unwrap();
    assert_eq!(here.split(',').nth(5), Some("0"), "the step point is 0 steps from itself: {here}");
    let made = PathBuf::from(&*out).join("gallery.enfilade/analysis");
    for name in ["isovist-area", "sight-lines-through", "visual-step-depth", "angular-step-depth"] {
        assert!(made.join(format!("{name}.png")).is_file(), "{name}");
    }
    let told = |said: &[u8]| serde_json::from_slice::<Value>(said).unwrap();
    let columns = told(&analyse(&["--measures", "isovist", "--json", "-"]).stdout)["columns"].clone();
    assert!(columns["Isovist Area"].as_f64().is_some_and(|area| area > 1.0), "{columns}");
    // Another analysis of the same drawing takes nothing away, one of another drawing old pictures alone.
    std::fs::write(made.join("mine.csv"), "1").unwrap();
    analyse(&[]);
    assert!(made.join("isovist-area.png").is_file() && made.join("mine.csv").is_file());
    std::fs::copy(sample("maze.dxf"), &gallery).unwrap();
    analyse(&[]);
    assert!(!made.join("isovist-area.png").is_file() && made.join("mine.csv").is_file());
    for (args, code, says) in [
        (["--measures", "daylight"], 3, "expected all, graph"),
        (["--measures", "daylight"], 3, "Isovist Area, "),
        (["--lattice-centre", "1e300,0"], 3, "found 1e300"),
        (["--step-from", "900,2"], 3, "no measured cell there"),
    ] {
        let refused = analyse(&args);
        assert_eq!(refused.status.code(), Some(code));
        assert!(text(&refused.stderr).contains(says), "{}", text(&refused.stderr));
    }
}

/// An R12 drawing of lines, each with its layer.
fn drawing_of(lines: &[(&str, [f64; 4])]) -> String {
    let record = |(layer, [x, y, u, v]): &(&str, [f64; 4])| {
        format!("0\nLINE\n8\n{layer}\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n")
    };
    let lines: String = lines.iter().map(record).collect();
    format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n")
}

/// Two rooms with a doorway, thick walls, nothing marked.
fn two_rooms() -> String {
    let around = |[x, y, u, v]: [f64; 4]| {
        [[x, y, u, y], [u, y, u, v], [u, v, x, v], [x, v, x, y]].map(|l| ("WALL", l))
    };
    let mut lines = around([0.0, 0.0, 10.0, 6.0]).to_vec();
    lines.extend(around([0.3, 0.3, 9.7, 5.7]));
    for x in [4.8, 5.2] {
        lines.push(("WALL", [x, 0.3, x, 2.5]));
        lines.push(("WALL", [x, 3.5, x, 5.7]));
    }
    drawing_of(&lines)
}

#[test]
fn only_what_is_marked_moves_where_the_architect_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let plan = folder.path().join("house.dxf");
    std::fs::write(&plan, two_rooms()).unwrap();
    let moves = || {
        let done = enfilade(&["check", &plan.to_string_lossy(), "--unit", "m", "--json"]);
        let check: Value = serde_json::from_slice(&done.stdout).unwrap();
        check["moves"].as_array().unwrap().len()
    };
    assert!(moves() > 0, "the doorway slides by default");
    std::fs::write(folder.path().join("house.enfilade.toml"), "only-marked = true\n").unwrap();
    assert_eq!(moves(), 0);
}

#[test]
fn nobody_stands_inside_a_wall_although_its_ends_are_open() {
    let folder = tempfile::tempdir().unwrap();
    let (plan, csv) = (folder.path().join("house.dxf"), folder.path().join("cells.csv"));
    std::fs::write(&plan, two_rooms()).unwrap();
    let side_car = "[[region]]\nkind = \"keep\"\npoints = [[-1, -1], [11, -1], [11, 7], [-1, 7]]\n";
    std::fs::write(folder.path().join("house.enfilade.toml"), side_car).unwrap();
    let (plan, csv) = (plan.to_string_lossy(), csv.to_string_lossy());
    let args = ["analyse", &plan, "--unit", "m", "--spacing", "0.1", "--lattice-centre", "0.05,0.05"];
    let done = enfilade(&[&args[..], &["--cells", &csv, "--quiet"]].concat());
    assert!(done.status.success(), "{}", text(&done.stderr));
    let cells = std::fs::read_to_string(&*csv).unwrap();
    let places = cells.lines().skip(1).map(|l| {
        let at: Vec<f64> = l.split(',').skip(1).take(2).map(|v| v.parse().unwrap()).collect();
        (at[0], at[1])
    });
    let between: Vec<(f64, f64)> = places.filter(|(x, _)| (4.8..5.2).contains(x)).collect();
    assert_eq!(between.len(), 4 * 10, "the doorway and nothing else: {between:?}");
    assert!(between.iter().all(|(_, y)| (2.5..3.5).contains(y)));
}

#[test]
fn the_shortest_time_gives_a_layout() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy();
    let done = enfilade(&["run", &sample("gallery.dxf"), "--seconds", "0.1", "--out", &out, "-q"]);
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", text(&done.stderr));
    let result = json(&folder.path().join("gallery.enfilade/round-01/result.json"));
    assert!(result["evaluations"].as_u64().unwrap() > 0);
    // So few layouts may hold none that is better than the present one: then that is said.
    let says_none = result["problems"].as_array().unwrap().iter().any(|p| p["code"] == "no-option");
    assert_eq!(result["candidates"].as_array().unwrap().is_empty(), says_none);
}

#[test]
fn the_resolution_study_makes_a_plot_and_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let args = [
        "resolution",
        &sample("gallery.dxf"),
        "--spacings",
        "2,1,0.5",
        "--samples",
        "3",
        "--out",
        &out,
        "--json",
        "-",
    ];
    let done = enfilade(&args);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let result: Value = serde_json::from_slice(&done.stdout).unwrap();
    let spacings: Vec<f64> =
        result["rows"].as_array().unwrap().iter().map(|r| r["spacing_m"].as_f64().unwrap()).collect();
    assert_eq!(spacings, [2.0, 1.0, 0.5]);
    assert!(result["rows"][0]["depth"]["deviation"].as_f64().unwrap() > 0.0, "moves are sampled");
    let made = folder.path().join("gallery.enfilade/resolution");
    for name in ["resolution.json", "resolution.csv", "resolution.png"] {
        assert!(made.join(name).is_file(), "{name}");
    }
    let refused = enfilade(&["resolution", &sample("gallery.dxf"), "--spacings", "0", "--out", &out]);
    assert_eq!(refused.status.code(), Some(3));
}

/// Runs the gallery with further arguments; the newest result and the exit code.
fn gallery(folder: &Path, round: u32, more: &[&str]) -> (Value, Option<i32>) {
    let out = folder.to_string_lossy().into_owned();
    let drawing = sample("gallery.dxf");
    let base = ["run", &drawing, "--spacing", "1", "--evaluations", "150", "--out", &out, "-q"];
    let output = enfilade(&[&base[..], more].concat());
    let at = folder.join(format!("gallery.enfilade/round-{round:02}/result.json"));
    assert!(at.exists(), "{more:?}: {}", text(&output.stderr));
    (json(&at), output.status.code())
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}

#[test]
fn options_keep_what_the_architect_decides() {
    let folder = tempfile::tempdir().unwrap();
    let (result, _) = gallery(
        folder.path(),
        1,
        &[
            "--objective",
            "degree-p10 max 0.5, isovist-area max 0.5",
            "--snap",
            "0.1 m, 5 deg",
            "--most-moves",
            "2",
            "--limit",
            "degree -2%, passage 0.6 m",
        ],
    );
    let present = result["initial"]["mean"]["degree"].as_f64().unwrap();
    let moves = result["moves"].as_array().unwrap();
    assert!(!result["candidates"].as_array().unwrap().is_empty());
    for c in result["candidates"].as_array().unwrap() {
        assert!(c["mean"]["degree"].as_f64().unwrap() >= 0.98 * present - 1e-6);
        assert!(
            c["mean"]["degree-p10"].is_number() && c["mean"]["isovist-area"].is_number(),
            "{}",
            c["mean"]
        );
        let mut moved = std::collections::BTreeSet::new();
        for (m, p) in moves.iter().zip(numbers(&c["parameters"])) {
            let step = match (m["kind"].as_str().unwrap(), m["unit"].as_str().unwrap()) {
                ("rotate", _) => 5.0,
                (_, "mm") => 100.0,
                (_, "cm") => 10.0,
                _ => 0.1,
            };
            assert!(((p / step).round() * step - p).abs() < 1e-6, "{m} {p}");
            if p != 0.0 {
                moved.insert(m["name"].to_string());
            }
        }
        assert!(moved.len() <= 2, "{moved:?}");
        assert!(c["explanation"]["from_present"].as_f64().unwrap() >= 0.0);
    }
}

#[test]
fn a_limit_that_nothing_keeps_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (result, code) = gallery(folder.path(), 1, &["--limit", "degree +0%, degree >= 100000"]);
    assert_eq!(code, Some(1));
    assert!(result["candidates"].as_array().unwrap().is_empty());
    assert!(result["stopped_by"].as_str().unwrap().contains("no layout keeps every hard limit"));
    let problems = result["problems"].as_array().unwrap();
    let why = problems.iter().find(|p| p["code"] == "no-option").unwrap();
    assert!(why["text"].as_str().unwrap().contains("degree >= 100000"), "{why}");
}

#[test]
fn a_pinned_option_stays_and_another_can_be_followed() {
    let folder = tempfile::tempdir().unwrap();
    let (first, _) = gallery(folder.path(), 1, &[]);
    let second = numbers(&first["candidates"][1]["parameters"]);
    let (pinned, _) = gallery(folder.path(), 2, &["--pin", "2"]);
    assert_eq!(numbers(&pinned["candidates"][0]["parameters"]), second);
    let pinned_first = numbers(&pinned["candidates"][0]["parameters"]);
    let (like, _) = gallery(folder.path(), 3, &["--like", "1"]);
    for c in like["candidates"].as_array().unwrap() {
        for ((p, q), m) in
            numbers(&c["parameters"]).iter().zip(&pinned_first).zip(like["moves"].as_array().unwrap())
        {
            let width = m["upper"].as_f64().unwrap() - m["lower"].as_f64().unwrap();
            assert!((p - q).abs() <= 0.15 * width + 1e-9, "{m}");
        }
    }
    let drawing = sample("gallery.dxf");
    let out = folder.path().to_string_lossy().into_owned();
    assert_eq!(enfilade(&["run", &drawing, "--out", &out, "--pin", "99", "-q"]).status.code(), Some(3));
    let link = ["run", &drawing, "--out", &out, "--link", "same: nobody, none", "-q"];
    assert_eq!(enfilade(&link).status.code(), Some(3));
}

#[test]
fn a_scene_whose_data_lie_beside_it_takes_them_along() {
    let folder = tempfile::tempdir().unwrap();
    let glb = std::fs::read(sample("pavilion.glb")).unwrap();
    let len = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let data = &glb[28 + len..];
    let images = [
        "textures/wood%201.png",
        "../outside.png",
        "Initial-degree.png",
        "textures/gone.png",
        "textures/huge.png",
    ];
    let images: Vec<String> = images.iter().map(|uri| format!("{{\"uri\":\"{uri}\"}}")).collect();
    let scene = text(&glb[20..20 + len]).replace(
        "\"buffers\":[{",
        &format!("\"images\":[{}],\"buffers\":[{{\"uri\":\"walls%201.bin\",", images.join(",")),
    );
    let (gltf, bin) = (folder.path().join("house.gltf"), folder.path().join("walls 1.bin"));
    std::fs::write(&gltf, scene).unwrap();
    let at = gltf.to_string_lossy().into_owned();
    let missing = enfilade(&["check", &at]);
    assert!(
        text(&missing.stderr)
            .contains("names \"walls 1.bin\", expected a file of at most 1073741824 bytes beside"),
        "{}",
        text(&missing.stderr)
    );
    // A link that leads out of the folder is not followed.
    let elsewhere = tempfile::tempdir().unwrap();
    let outside = elsewhere.path().join("secret.bin");
    std::fs::write(&outside, data).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&outside, &bin).unwrap();
        assert!(text(&enfilade(&["check", &at]).stderr).contains("names \"walls 1.bin\""));
        std::fs::remove_file(&bin).unwrap();
    }
    let most = enfilade_cad::gltf::OUTER_MAX;
    std::fs::File::create(&bin).unwrap().set_len(most + 1).unwrap();
    assert!(
        text(&enfilade(&["check", &at]).stderr).contains(&format!("a file of at most {most} bytes beside"))
    );
    std::fs::write(&bin, data).unwrap();
    std::fs::create_dir(folder.path().join("textures")).unwrap();
    for (name, picture) in [("textures/wood 1.png", "wood"), ("Initial-degree.png", "theirs")] {
        std::fs::write(folder.path().join(name), picture).unwrap();
    }
    let huge = std::fs::File::create(folder.path().join("textures/huge.png")).unwrap();
    huge.set_len(enfilade_cad::gltf::PICTURES_MAX + 1).unwrap();
    let lost = text(&enfilade(&["check", &at]).stderr);
    for (image, why) in
        [(1, "lies elsewhere"), (3, "is not there or too large"), (4, "is not there or too large")]
    {
        let place = format!("/images/{image}");
        assert!(lost.lines().any(|l| l.contains(&place) && l.contains(why)), "{lost}");
    }
    assert_eq!(lost.matches("/images/").count(), 3, "{lost}");
    let done = enfilade(&["run", &at, "--evaluations", "12", "--members", "1", "--spacing", "2", "-q"]);
    assert!(matches!(done.status.code(), Some(0 | 1)), "{}", text(&done.stderr));
    let round = folder.path().join("house.enfilade/round-01");
    assert!(std::fs::read(round.join("walls 1.bin")).unwrap() == data);
    assert_eq!(std::fs::read(round.join("textures/wood 1.png")).unwrap(), b"wood");
    assert!(!round.join("Initial-degree.png").exists() && !round.join("textures/gone.png").exists());
    assert!(std::fs::read(round.join("initial-degree.png")).unwrap().starts_with(b"\x89PNG"));
    for name in ["initial.gltf", "candidate-1.gltf"] {
        let said = text(&enfilade(&["check", &round.join(name).to_string_lossy()]).stderr);
        assert!(!said.contains("walls 1.bin"), "{name}: {said}");
    }
}

/// The building beside a scene is found whatever the case of its ending, packed too.
#[test]
fn the_building_beside_a_scene_is_found_in_any_dress() {
    let (name, data) = (b"house.ifc", std::fs::read(sample("pavilion.ifc")).unwrap());
    let of = |start: &[u8], fields: &[(u32, usize)]| {
        let numbers = fields.iter().flat_map(|(v, n)| v.to_le_bytes()[..*n].to_vec());
        [start.to_vec(), numbers.collect()].concat()
    };
    let n = data.len() as u32;
    let mut crc = flate2::Crc::new();
    crc.update(&data);
    // Stored as it is: version, flags, method, time, check, sizes, lengths of names.
    let about = [(20, 2), (0, 2), (0, 2), (0, 4), (crc.sum(), 4), (n, 4), (n, 4), (9, 2), (0, 2)];
    let local = of(b"PK\x03\x04", &about);
    let entry =
        of(b"PK\x01\x02", &[&[(20, 2)], &about[..], &[(0, 2), (0, 2), (0, 2), (0, 4), (0, 4)]].concat());
    let at = (local.len() + name.len()) as u32 + n;
    let size = (entry.len() + name.len()) as u32;
    let end = of(b"PK\x05\x06", &[(0, 4), (1, 2), (1, 2), (size, 4), (at, 4), (0, 2)]);
    let zip = [&local[..], name, &data, &entry, name, &end].concat();
    for (file, bytes) in
        [("house.IFC", &data), ("house.Ifc", &data), ("house.ifczip", &zip), ("house.IFCZIP", &zip)]
    {
        let folder = tempfile::tempdir().unwrap();
        let glb = folder.path().join("house.glb");
        std::fs::copy(sample("pavilion.glb"), &glb).unwrap();
        std::fs::write(folder.path().join(file), bytes).unwrap();
        std::fs::write(folder.path().join("other.ifc"), b"nothing").unwrap();
        let said = text(&enfilade(&["check", &glb.to_string_lossy()]).stderr);
        assert!(said.contains("storeys by the IFC beside it: 1 \"Ground floor\""), "{file}: {said}");
    }
}
