//! The program itself, killed while it searches: it goes on where it was, and what comes out is what would have
//! come out undisturbed, byte for byte. The same through every bad habit of writers. And a job that wants more than
//! it may have is ended alone.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use enfilade_config::{Backend, Partial, Settings};
use enfilade_pipeline::{Event, Input};
use enfilade_report::Cancel;
use rand::{RngExt, SeedableRng};
use serde_json::Value;

/// How often the daemon is killed; more by `ENFILADE_KILLS`.
const KILLS: usize = 8;
const PATIENCE: Duration = Duration::from_secs(900);

fn sample() -> PathBuf {
    enfilade_fixtures::repository("samples/gallery.dxf")
}

fn watch(root: &Path, more: &[&str]) -> Child {
    start(root, &[&["--backend", "cpu", "--evaluations", "400"], more].concat())
}

fn start(root: &Path, options: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .arg("watch")
        .args(options)
        .arg(root)
        .env("HOME", root.join(".home"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

fn kill(mut child: Child) {
    child.kill().unwrap();
    child.wait().unwrap();
}

fn until(what: &str, is_so: impl Fn() -> bool) {
    let start = Instant::now();
    while !is_so() {
        assert!(start.elapsed() < PATIENCE, "never: {what}");
        thread::sleep(Duration::from_millis(5));
    }
}

fn status(home: &Path) -> Value {
    fs::read(home.join("status.json")).ok().and_then(|b| serde_json::from_slice(&b).ok()).unwrap_or_default()
}

/// The files of a round with their bytes, but for the time taken, the folder and the number of the round.
fn round(home: &Path, of: &str) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(home.join(of)).unwrap().map(|e| e.unwrap().path());
    let read = |path: PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let mut bytes = fs::read(&path).unwrap();
        if ["result.json", "works.json"].contains(&name.as_str()) {
            let mut value: Value = serde_json::from_slice(&bytes).unwrap();
            value.as_object_mut().unwrap().remove("seconds");
            value["input"]["path"] = Value::Null;
            bytes = value.to_string().into_bytes();
        } else if name == "report.html" {
            let number: u32 = of.trim_start_matches("round-").parse().unwrap();
            let text = String::from_utf8(bytes).unwrap();
            bytes = text.replace(&format!("round {number}"), "round N").into_bytes();
        }
        (name, bytes)
    };
    files.map(read).collect()
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    fs::copy(sample(), root.join("gallery.dxf")).unwrap();
    (dir, root)
}

/// Hazard 22. As many studies as are needed for all the kills: a fast machine ends each after a few.
#[test]
fn a_killed_search_goes_on_and_ends_in_the_same_bytes() {
    let kills = std::env::var("ENFILADE_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(KILLS);
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(22);
    let (mut killed, mut studies) = (0, 0);
    while killed < kills {
        studies += 1;
        killed += killed_and_compared(&studies.to_string(), kills - killed, &mut rng);
    }
    println!("killed {killed} times in {studies} studies");
}

/// One study, undisturbed and killed at most so often, at any instant: of the start, of what is told again, and
/// while new layouts are measured. Says how often.
fn killed_and_compared(seed: &str, kills: usize, rng: &mut rand_chacha::ChaCha8Rng) -> usize {
    let options = ["--seed", seed];
    let (_one, calm) = folder();
    let child = watch(&calm, &options);
    let calm = calm.join("gallery.enfilade");
    until("the undisturbed round", || calm.join("round-01").exists());
    kill(child);

    let (_two, root) = folder();
    let home = root.join("gallery.enfilade");
    let remembered = || fs::metadata(home.join(".search")).map_or(0, |m| m.len());
    let (mut known, mut killed) = (0, 0);
    while killed < kills && !home.join("round-01").exists() {
        let child = watch(&root, &options);
        if rng.random_range(0..3) > 0 {
            until("news of the search", || remembered() > known || home.join("round-01").exists());
        }
        thread::sleep(Duration::from_millis(rng.random_range(0..250)));
        kill(child);
        killed += 1;
        let now = remembered();
        assert!(now >= known || home.join("round-01").exists(), "{now} bytes known after {known}");
        known = now.max(known);
    }
    let child = watch(&root, &options);
    until("the round after all kills", || home.join("round-01").exists());
    kill(child);
    println!("seed {seed}: killed {killed} times, {known} bytes remembered");
    let (want, got) = (round(&calm, "round-01"), round(&home, "round-01"));
    assert_eq!(want.keys().collect::<Vec<_>>(), got.keys().collect::<Vec<_>>());
    for (name, bytes) in &want {
        assert!(*bytes == got[name], "{name} differs after {killed} kills");
    }
    assert!(!home.join("round-02").exists());
    killed
}

/// How long the soak lasts; longer by `ENFILADE_SOAK_SECS`.
const SOAK_SECS: u64 = 20;
/// What the soak does follows from this; another by `ENFILADE_SOAK_SEED`.
const SOAK_SEED: u64 = 17;
/// What every drawing of the soak is measured with.
const SOAKED: [&str; 6] = ["--backend", "cpu", "--evaluations", "30", "--threads", "1"];
/// What fills a disk leaves this much: the drawings fit, a round does not.
const LEFT_ON_DISK: u64 = 300_000;

fn soaked(root: &Path) -> Child {
    start(root, &[&["--depth", "2"], &SOAKED[..]].concat())
}

/// A drawing like no other: one of two samples with a comment.
fn drawing(step: usize, rng: &mut rand_chacha::ChaCha8Rng) -> Vec<u8> {
    let sample = sample().with_file_name(["gallery.dxf", "maze.dxf"][rng.random_range(0..2)]);
    [format!("999\nstep {step}\n").as_bytes(), &fs::read(sample).unwrap()].concat()
}

fn drawings(root: &Path) -> Vec<PathBuf> {
    let folders = ["", "sub", "moved"].map(|f| root.join(f));
    let files = folders.iter().filter_map(|f| fs::read_dir(f).ok()).flatten().map(|e| e.unwrap().path());
    files.filter(|p| p.extension().is_some_and(|e| e == "dxf")).collect()
}

/// The newest round of a drawing, if it is one of its last content.
fn newest(path: &Path) -> Option<(PathBuf, String)> {
    let home = path.with_extension("enfilade");
    let names = fs::read_dir(&home).ok()?.map(|e| e.unwrap().file_name().into_string().unwrap());
    let number = |n: &String| n.strip_prefix("round-")?.parse::<u32>().ok();
    let name = names.filter(|n| number(n).is_some()).max_by_key(number)?;
    let result: Value = serde_json::from_slice(&fs::read(home.join(&name).join("result.json")).ok()?).ok()?;
    let is_of_it = result["input"]["sha256"] == enfilade::watch::sha256_hex(&fs::read(path).ok()?).as_str();
    is_of_it.then_some((home, name))
}

/// What one run over a drawing of these bytes writes, in a folder where nothing else is.
fn undisturbed(path: &Path) -> BTreeMap<String, Vec<u8>> {
    let dir = tempfile::tempdir().unwrap();
    let alone = fs::canonicalize(dir.path()).unwrap().join(path.file_name().unwrap());
    fs::copy(path, &alone).unwrap();
    let run =
        Command::new(env!("CARGO_BIN_EXE_enfilade")).arg("run").args(SOAKED).arg(&alone).output().unwrap();
    let home = alone.with_extension("enfilade");
    assert!(home.join("round-01").exists(), "{}", String::from_utf8_lossy(&run.stderr));
    round(&home, "round-01")
}

/// What two files say around their first difference.
fn first_difference(got: Option<&Vec<u8>>, want: Option<&Vec<u8>>) -> [String; 2] {
    let [got, want] = [got, want].map(|b| b.map_or(&[][..], Vec::as_slice));
    let at = got.iter().zip(want).take_while(|(a, b)| a == b).count();
    [got, want].map(|b| {
        String::from_utf8_lossy(&b[at.saturating_sub(80).min(b.len())..(at + 80).min(b.len())]).into()
    })
}

fn fill_and_free(root: &Path, whole_ms: u64) {
    let filler = root.join("filler.bin");
    let mut file = fs::File::create(&filler).unwrap();
    let block = vec![0; LEFT_ON_DISK as usize];
    while file.write_all(&block).is_ok() {}
    let size = file.metadata().unwrap().len();
    file.set_len(size.saturating_sub(LEFT_ON_DISK)).unwrap();
    thread::sleep(Duration::from_millis(whole_ms));
    drop(fs::remove_file(filler));
}

/// One bad habit. The disk is filled only where `ENFILADE_SOAK_DIR` names one that may be.
fn disturb(root: &Path, step: usize, daemon: &mut Child, rng: &mut rand_chacha::ChaCha8Rng) {
    let folder = root.join(["", "sub", "moved"][rng.random_range(0..3)]);
    let path = folder.join(format!("p{}.dxf", rng.random_range(0..3)));
    let may_fill = std::env::var_os("ENFILADE_SOAK_DIR").is_some();
    match rng.random_range(0..20) {
        0 => drop(fs::remove_file(&path)),
        1 => drop(fs::rename(root.join("sub"), root.join("moved"))),
        2 => drop(fs::rename(root.join("moved"), root.join("sub"))),
        3 => drop(fs::rename(&path, folder.join("p9.dxf"))),
        4 => {
            let round = newest(&path).map(|(home, name)| home.join(name));
            drop(round.map(|r| fs::copy(r.join("candidate-1.dxf"), folder.join("taken.dxf"))));
        }
        5 => {
            daemon.kill().unwrap();
            daemon.wait().unwrap();
            *daemon = soaked(root);
        }
        6 if may_fill => fill_and_free(root, rng.random_range(0..3000)),
        _ if folder.is_dir() => crate::chaos::save(&path, &drawing(step, rng), rng),
        _ => {}
    }
    thread::sleep(Duration::from_millis(rng.random_range(0..1500)));
}

/// Chaos by a fixed seed around the program itself: in the end the newest round of every drawing is, byte for byte,
/// what a single run over its last content writes, and nothing of the program's own was taken for a drawing.
#[test]
fn what_is_left_after_chaos_is_what_one_run_writes() {
    let stated = |key: &str, default| std::env::var(key).ok().and_then(|s| s.parse().ok()).unwrap_or(default);
    let secs = stated("ENFILADE_SOAK_SECS", SOAK_SECS);
    let dir = match std::env::var_os("ENFILADE_SOAK_DIR") {
        Some(parent) => tempfile::tempdir_in(parent).unwrap(),
        None => tempfile::tempdir().unwrap(),
    };
    let root = fs::canonicalize(dir.path()).unwrap();
    fs::create_dir(root.join("sub")).unwrap();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(stated("ENFILADE_SOAK_SEED", SOAK_SEED));
    let mut daemon = soaked(&root);
    let (start, mut steps) = (Instant::now(), 0);
    while start.elapsed() < Duration::from_secs(secs) {
        steps += 1;
        disturb(&root, steps, &mut daemon, &mut rng);
    }
    fs::write(root.join("p0.dxf"), drawing(steps + 1, &mut rng)).unwrap();
    until("all drawings of last content done", || drawings(&root).iter().all(|d| newest(d).is_some()));
    kill(daemon);
    let ends = drawings(&root);
    println!("{steps} steps, {} drawings", ends.len());
    for path in ends {
        let (home, name) = newest(&path).unwrap();
        let (got, want) = (round(&home, &name), undisturbed(&path));
        let others: Vec<&String> =
            got.keys().chain(want.keys()).filter(|f| got.get(*f) != want.get(*f)).collect();
        let first = others.first().map(|f| first_difference(got.get(*f), want.get(*f)));
        assert!(others.is_empty(), "in {name} of {} are others: {others:?}: {first:?}", path.display());
        let own = fs::read_dir(&home).unwrap().map(|e| e.unwrap().path());
        let inner =
            own.filter(|p| p.is_dir()).flat_map(|p| fs::read_dir(p).unwrap()).map(|e| e.unwrap().path());
        assert!(
            inner.into_iter().all(|p| p.extension().is_none_or(|e| e != "enfilade")),
            "own output was a drawing"
        );
    }
}

/// A folder that is moved and moved back takes its rounds along, those made elsewhere too: what they say of the
/// drawing holds wherever it lies.
#[test]
fn a_round_made_elsewhere_is_what_one_run_writes() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    let (here, there) = (root.join("sub"), root.join("moved"));
    fs::create_dir(&here).unwrap();
    fs::copy(sample(), here.join("plan.dxf")).unwrap();
    let daemon = soaked(&root);
    until("a round", || here.join("plan.enfilade/round-01").exists());
    fs::rename(&here, &there).unwrap();
    // What is only moved is known by its results; what is saved there is a new round.
    let drawn = fs::read_to_string(there.join("plan.dxf")).unwrap();
    fs::write(there.join("plan.dxf"), format!("999\nsaved elsewhere\n{drawn}")).unwrap();
    until("a round elsewhere", || there.join("plan.enfilade/round-02").exists());
    fs::rename(&there, &here).unwrap();
    kill(daemon);
    let (home, name) = newest(&here.join("plan.dxf")).unwrap();
    assert_eq!(name, "round-02");
    assert!(round(&home, &name) == undisturbed(&here.join("plan.dxf")));
}

/// A budget of seconds goes on too: what was measured before is told again with its pace, and counts as spent.
#[test]
fn a_killed_search_under_a_budget_of_seconds_goes_on() {
    let bytes = fs::read(sample()).unwrap();
    let stated = Partial { evaluations: Some(400), seconds: Some(1e6), ..Partial::default() };
    let settings = Settings::new(Partial { backend: Some(Backend::Cpu), ..stated }).unwrap();
    let run = |earlier: &[u8]| {
        let mut input = Input::new("gallery.dxf", &bytes, 1);
        input.earlier = earlier;
        let mut kept = Vec::new();
        let mut show = |event: Event| {
            if let Event::Keep(keep) = event {
                if keep.is_anew {
                    kept.clear();
                }
                kept.extend(keep.bytes);
            }
        };
        let outcome =
            enfilade_pipeline::run(&input, &settings, Instant::now(), &mut show, &Cancel::default()).unwrap();
        let found = outcome.result.candidates.iter().map(|c| c.parameters.clone()).collect::<Vec<_>>();
        (kept, found)
    };
    let (kept, found) = run(&[]);
    let (again, same) = run(&kept);
    assert_eq!(found, same);
    // The first batch takes its own time; had anything behind it been measured again, its time would be another.
    let half = kept.len() / 2;
    assert!(again[half..kept.len()] == kept[half..], "measured again although it was known");
}

/// What is no drawing is named and not waited for, also where it takes the place of one that is being worked on.
#[test]
fn garbage_saved_over_a_drawing_is_named() {
    let (_dir, root) = folder();
    let home = root.join("gallery.enfilade");
    let log = root.join(".log/watch.log");
    fs::write(root.join("gallery.enfilade.toml"), "evaluations = 100000000\n").unwrap();
    let child = watch(&root, &["--log", log.to_str().unwrap()]);
    let said = || fs::read_to_string(&log).unwrap_or_default();
    until("the job", || status(&home)["state"] == "running");
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
    let noise: Vec<u8> = (0..50_000).map(|_| rng.random()).collect();
    for (bytes, what) in
        [(noise.clone(), "binary data"), ([b"\x89PNG\r\n\x1a\n", &noise[..]].concat(), "a PNG picture")]
    {
        fs::write(root.join("gallery.dxf"), bytes).unwrap();
        until(what, || status(&home)["problems"][0]["text"].as_str().is_some_and(|t| t.contains(what)));
        assert_eq!(status(&home)["state"], "failed");
        until(what, || said().contains(what));
    }
    kill(child);
    let said = said();
    assert!(said.contains("gallery.dxf stopped: a newer save, or other settings, take its place"), "{said}");
    assert!(!said.contains('\u{fffd}') && !said.contains(|c: char| c.is_control() && c != '\n'), "{said:?}");
}

/// Drawings worked on by one daemon under the limits of `[watch]`, until all have ended: their states.
fn under_limits(root: &Path, limits: &str, names: &[&str]) -> Vec<Value> {
    fs::write(root.join("enfilade.toml"), format!("[watch]\n{limits}\n")).unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["watch", "--backend", "cpu", "--threads", "2"])
        .arg(root)
        .env("HOME", root.join(".home"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let of = |name: &str| status(&root.join(format!("{name}.enfilade")));
    let has_ended = |name: &&str| matches!(of(name)["state"].as_str(), Some("done" | "failed"));
    until(limits, || names.iter().all(has_ended));
    kill(child);
    names.iter().map(|n| of(n)).collect()
}

/// Hazard 23: what asks for more memory or time than it may have is ended with its reason; the next is done.
#[test]
fn a_job_over_its_limits_is_ended_alone() {
    let (_one, root) = folder();
    let line = |i: usize| format!("0\nLINE\n8\nWALL\n10\n{i}\n20\n0\n11\n{i}\n21\n{}\n", 10 + i % 7);
    let lines: String = (0..400_000).map(line).collect();
    let huge = format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n");
    fs::write(root.join("a-huge.dxf"), huge).unwrap();
    fs::write(root.join("gallery.enfilade.toml"), "evaluations = 60\n").unwrap();
    let ends = under_limits(&root, "job-memory-mb = 192", &["a-huge", "gallery"]);
    assert_eq!(ends[0]["problems"][0]["code"], "job-out-of-memory", "{}", ends[0]);
    assert_eq!(ends[1]["state"], "done", "{}", ends[1]);

    let (_two, root) = folder();
    fs::write(root.join("gallery.enfilade.toml"), "evaluations = 100000000\n").unwrap();
    let ends = under_limits(&root, "job-limit-secs = 3.0", &["gallery"]);
    assert_eq!(ends[0]["problems"][0]["code"], "job-too-long", "{}", ends[0]);
    // A slow machine may not have begun to search by then.
    let is_kept = ends[0]["problems"][0]["text"].as_str().unwrap().contains("its best so far is kept");
    assert_eq!(is_kept, root.join("gallery.enfilade/so-far/result.json").exists(), "{}", ends[0]);
}
