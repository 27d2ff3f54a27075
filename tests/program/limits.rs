//! Limits hold on the command line as they do in the watcher: time, size, number, and no waiting for pipes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// A command that has not ended by then waits for something.
const PATIENCE: Duration = Duration::from_secs(900);

fn enfilade(folder: &Path, args: &[&str]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(args)
        .current_dir(folder)
        .env("HOME", folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if began.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("{args:?} waits");
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().unwrap()
}

fn sample(folder: &Path) -> PathBuf {
    let to = folder.join("gallery.dxf");
    fs::copy(enfilade_fixtures::repository("samples/gallery.dxf"), &to).unwrap();
    to
}

/// What is said on standard error, of a command that must refuse.
fn refusal(folder: &Path, args: &[&str]) -> String {
    let out = enfilade(folder, args);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(matches!(out.status.code(), Some(2..=5)), "{args:?}: {:?} {said}", out.status);
    said
}

/// Every command that takes a drawing, with this one.
fn commands(file: &str) -> Vec<Vec<&str>> {
    let of = |words: &[&'static str]| words.iter().copied().chain([file]).collect::<Vec<_>>();
    let mut all: Vec<Vec<&str>> =
        [&["check"][..], &["analyse"], &["resolution"], &["run"], &["jobs"]].map(of).into();
    all.push(vec!["accept", file, "1"]);
    all
}

/// One limit for reading a drawing, one for the whole, each stated when it is hit; nothing is left behind.
#[test]
fn commands_have_the_limits_of_jobs() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    for command in ["check", "analyse", "run"] {
        let said = refusal(folder.path(), &[command, "gallery.dxf", "--read-limit-secs", "0.0001"]);
        assert!(
            said.contains("reading the drawing took longer than the limit of 0.0001 s"),
            "{command}: {said}"
        );
    }
    let long = ["run", "gallery.dxf", "--evaluations", "100000000", "--job-limit-secs", "3"];
    assert_eq!(enfilade(folder.path(), &long).status.code(), Some(5), "a class of its own for scripts");
    let said = refusal(folder.path(), &long);
    assert!(said.contains("the job took longer than the limit of 3 s (--job-limit-secs"), "{said}");
    assert!(!folder.path().join("gallery.enfilade/round-01").exists());
    // The folder's settings say the same to both.
    fs::write(folder.path().join("enfilade.toml"), "[watch]\njob-limit-secs = 1.0\n").unwrap();
    let said = refusal(folder.path(), &["run", "gallery.dxf", "--evaluations", "100000000"]);
    assert!(said.contains("the limit of 1 s"), "{said}");
    for wrong in ["0", "-1", "nan", "1e9"] {
        assert!(
            refusal(folder.path(), &["check", "gallery.dxf", "--job-limit-secs", wrong]).contains("seconds")
        );
    }
}

/// A pipe in the place of a drawing, of its settings, of its folder's, of a scene or its data holds up no command.
#[cfg(unix)]
#[test]
fn no_command_waits_for_a_pipe() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = |name: &str| {
        let path = folder.path().join(name);
        assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
        path
    };
    fs::create_dir(folder.path().join("folder.dxf")).unwrap();
    for name in ["pipe.dxf", "pipe.gltf", "pipe.ifc"] {
        pipe(name);
    }
    for name in ["pipe.dxf", "pipe.gltf", "pipe.ifc", "folder.dxf"] {
        for command in commands(name) {
            refusal(folder.path(), &command);
        }
    }
    sample(folder.path());
    for name in ["gallery.enfilade.toml", "enfilade.toml"] {
        let planted = pipe(name);
        for command in commands("gallery.dxf") {
            let said = refusal(folder.path(), &command);
            assert!(said.contains(name) && said.contains("no file"), "{command:?}: {said}");
        }
        fs::remove_file(planted).unwrap();
    }
    let scene = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"data.bin","byteLength":4}]}"#;
    fs::write(folder.path().join("scene.gltf"), scene).unwrap();
    pipe("data.bin");
    pipe("scene.ifc");
    for command in commands("scene.gltf") {
        enfilade(folder.path(), &command);
    }
}

/// Files beyond a limit are refused by its name, before anything is made of them.
#[test]
fn files_beyond_a_limit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let huge =
        |name: &str, bytes: u64| File::create(folder.path().join(name)).unwrap().set_len(bytes).unwrap();
    huge("huge.dxf", enfilade::watch::MAX_DRAWING_BYTES + 1);
    for command in commands("huge.dxf") {
        let said = refusal(folder.path(), &command);
        assert!(said.contains("2048 MB") || said.contains("no round yet"), "{command:?}: {said}");
    }
    sample(folder.path());
    huge("gallery.enfilade.toml", 1 << 30);
    for command in commands("gallery.dxf") {
        let said = refusal(folder.path(), &command);
        assert!(said.contains("SETTINGS_BYTES_MAX"), "{command:?}: {said}");
    }
    // A million lines took 5.1 GB.
    for (count, limit) in [(2_000_001, "MAX_RECORDS"), (900_000, "MAX_ENTITIES")] {
        let lines = "0\nLINE\n8\nW\n10\n1\n20\n2\n11\n3\n21\n4\n".repeat(count);
        let text = format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n");
        fs::write(folder.path().join("many.dxf"), text).unwrap();
        for command in [&["check", "many.dxf"], &["run", "many.dxf"]] {
            let said = refusal(folder.path(), command);
            assert!(said.contains(limit), "{said}");
        }
    }
}

/// Ctrl-C ends a search, not what it has found: that is written whole and can be accepted.
#[cfg(unix)]
#[test]
fn a_stopped_run_leaves_its_best_so_far() {
    use std::io::{BufRead as _, BufReader};
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["run", "gallery.dxf", "--evaluations", "100000000", "--progress", "json"])
        .current_dir(folder.path())
        .env("HOME", folder.path())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    assert!(said.any(|line| line.contains("optimise")), "the search begins");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let rest: Vec<String> = said.collect();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest:?}");
    let results = folder.path().join("gallery.enfilade");
    assert!(rest.iter().any(|line| line.contains("the best so far: ")), "{rest:?}");
    assert!(results.join("so-far/result.json").is_file() && !results.join("round-01").exists());
    let accepted = enfilade(folder.path(), &["accept", "gallery.dxf", "best", "--so-far"]);
    assert!(accepted.status.success(), "{accepted:?}");
    assert!(folder.path().join("gallery-r02.dxf").is_file());
}

/// A standard error that takes nothing changes no outcome.
#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_error_ends_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let plan = sample(folder.path()).to_string_lossy().into_owned();
    for (args, code) in [
        (vec!["check", &plan], 0),
        (vec!["check", "/nowhere/plan.dxf"], 2),
        (vec!["check", &plan, "--json=/nowhere/plan.enfilade.toml"], 3),
    ] {
        let full = File::options().write(true).open("/dev/full").unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_enfilade")).args(&args).stderr(full).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{args:?}");
    }
}

/// A budget that no clock can hold is refused like any other out of range.
#[test]
fn seconds_out_of_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let plan = sample(folder.path()).to_string_lossy().into_owned();
    for seconds in ["nan", "inf", "1e20", "1e300", "-1", "0"] {
        let said = refusal(folder.path(), &["run", &plan, "--seconds", seconds]);
        assert!(said.contains("0.1 to 1000000"), "{seconds}: {said}");
    }
}
