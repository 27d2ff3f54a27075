//! The program itself, killed while it searches: it goes on where it was, and what comes out is what would have
//! come out undisturbed, byte for byte. And a job that wants more than it may have is ended alone.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use serde_json::Value;

/// How often the daemon is killed; more by `ENFILADE_KILLS`.
const KILLS: usize = 8;
const PATIENCE: Duration = Duration::from_secs(300);

fn sample() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples/gallery.dxf")
}

fn watch(root: &Path, more: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["watch", "--backend", "cpu", "--evaluations", "400"])
        .args(more)
        .arg(root)
        .env("HOME", root)
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

/// The files of the first round with their bytes; the time taken is left out, as it is in digests of jobs.
fn round(home: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(home.join("round-01")).unwrap().map(|e| e.unwrap().path());
    let read = |path: PathBuf| {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let mut bytes = fs::read(&path).unwrap();
        if name == "result.json" {
            let mut value: Value = serde_json::from_slice(&bytes).unwrap();
            value["seconds"] = Value::Null;
            value["input"]["path"] = Value::Null;
            bytes = value.to_string().into_bytes();
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

/// Hazard 22.
#[test]
fn a_killed_search_goes_on_and_ends_in_the_same_bytes() {
    let kills = std::env::var("ENFILADE_KILLS").ok().and_then(|n| n.parse().ok()).unwrap_or(KILLS);
    let (_one, calm) = folder();
    let child = watch(&calm, &[]);
    let calm = calm.join("gallery.enfilade");
    until("the undisturbed round", || status(&calm)["state"] == "done");
    kill(child);

    let (_two, root) = folder();
    let home = root.join("gallery.enfilade");
    let remembered = || fs::metadata(home.join(".search")).map_or(0, |m| m.len());
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(22);
    let (mut known, mut killed) = (0, 0);
    while killed < kills && !home.join("round-01").exists() {
        let child = watch(&root, &[]);
        // At any instant: of the start, of what is told again, and while new layouts are measured.
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
    assert!(killed > 1, "the job was done before it could be disturbed");
    let child = watch(&root, &[]);
    until("the round after all kills", || status(&home)["state"] == "done" && remembered() == 0);
    kill(child);
    println!("killed {killed} times, {known} bytes remembered");
    let (want, got) = (round(&calm), round(&home));
    assert_eq!(want.keys().collect::<Vec<_>>(), got.keys().collect::<Vec<_>>());
    for (name, bytes) in &want {
        assert!(*bytes == got[name], "{name} differs after {killed} kills");
    }
    assert!(!home.join("round-02").exists());
}

/// Hazard 23: what asks for more memory or time than it may have is ended with its reason; the next is done.
#[test]
fn a_job_over_its_limits_is_ended_alone() {
    let (_dir, root) = folder();
    let lines: String = (0..400_000)
        .map(|i| format!("0\nLINE\n8\nWALL\n10\n{i}\n20\n0\n11\n{i}\n21\n{}\n", 10 + i % 7))
        .collect();
    let huge = format!("0\nSECTION\n2\nENTITIES\n{lines}0\nENDSEC\n0\nEOF\n");
    fs::write(root.join("a-huge.dxf"), huge).unwrap();
    fs::copy(sample(), root.join("b-long.dxf")).unwrap();
    fs::write(root.join("b-long.enfilade.toml"), "evaluations = 100000000\n").unwrap();
    fs::write(root.join("enfilade.toml"), "[watch]\njob-memory-mb = 192\njob-limit-secs = 20.0\n").unwrap();
    // The command line would win over the side-car.
    let child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .args(["watch", "--backend", "cpu", "--threads", "2"])
        .arg(&root)
        .env("HOME", &root)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let home = |name: &str| root.join(format!("{name}.enfilade"));
    until("the good drawing", || {
        matches!(status(&home("gallery"))["state"].as_str(), Some("done" | "failed"))
    });
    until("the long one", || status(&home("b-long"))["state"] == "failed");
    kill(child);
    let code = |name: &str| status(&home(name))["problems"][0]["code"].as_str().map(str::to_owned);
    assert_eq!(code("a-huge").as_deref(), Some("job-out-of-memory"), "{}", status(&home("a-huge")));
    assert_eq!(code("b-long").as_deref(), Some("job-too-long"), "{}", status(&home("b-long")));
    assert_eq!(status(&home("gallery"))["state"], "done", "{}", status(&home("gallery")));
}
