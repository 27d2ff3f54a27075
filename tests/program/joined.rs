//! One long search on many machines: `jobs --seeds` lists, `run-job` does each, `join` begins one more with what they found.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use super::jobs::enfilade_in as enfilade;

fn lines(output: &Output) -> Vec<Value> {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

fn warm(job: &Value) -> Vec<Value> {
    job["settings"]["warm"].as_array().cloned().unwrap_or_default()
}

/// The result of a finished job.
fn result(dir: &Path, job: &Value) -> Value {
    let file = dir.join("enfilade-jobs").join(job["id"].as_str().unwrap()).join("result/result.json");
    serde_json::from_slice(&fs::read(file).unwrap()).unwrap()
}

#[test]
fn searches_are_joined_into_one_that_begins_with_what_they_found() {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    fs::copy(enfilade_fixtures::repository("samples/maze.dxf"), dir.join("maze.dxf")).unwrap();
    let raw =
        ["--raw", "--no-pictures", "--evaluations", "40", "--spacing", "1", "--objective", "degree max 0.5"];
    let list = ["jobs", "maze.dxf", "--seeds", "3,1,2", "-o", "searches.jsonl", "-q"];
    assert!(enfilade(dir, &[&list[..], &raw].concat(), "").status.success());
    let jobs = fs::read_to_string(dir.join("searches.jsonl")).unwrap();
    let jobs: Vec<&str> = jobs.lines().collect();
    let join = ["join", "searches.jsonl", "--missing", "left.jsonl"];

    for job in &jobs[..2] {
        assert!(enfilade(dir, &["run-job", "-"], job).status.success());
    }
    let early = enfilade(dir, &join, "");
    assert_eq!((early.status.code(), early.stdout.len()), (Some(75), 0));
    assert!(String::from_utf8_lossy(&early.stderr).contains("line 3"), "{early:?}");
    let left = fs::read_to_string(dir.join("left.jsonl")).unwrap();
    assert_eq!(left.trim_end(), jobs[2]);
    assert!(enfilade(dir, &["run-job", "-"], &left).status.success());

    let joined = lines(&enfilade(dir, &join, ""));
    assert_eq!((joined.len(), &joined[0]["settings"]["seed"]), (1, &Value::from(3)));
    let found: Vec<Value> = jobs.iter().map(|job| result(dir, &serde_json::from_str(job).unwrap())).collect();
    let options = |r: &Value| r["candidates"].as_array().unwrap().clone();
    assert!(warm(&joined[0]).len() > options(&found[0]).len(), "{:?}", warm(&joined[0]));
    for first in found.iter().map(|r| &r["candidates"][0]["parameters"]) {
        assert!(warm(&joined[0])[..3].contains(first));
    }
    assert!(enfilade(dir, &["run-job", "-"], &joined[0].to_string()).status.success());
    // What was found is measured again among what is found now.
    let degree = |r: &Value| {
        options(r).iter().map(|c| c["mean"]["degree"].as_f64().unwrap()).fold(f64::NEG_INFINITY, f64::max)
    };
    let best = found.iter().map(degree).fold(f64::NEG_INFINITY, f64::max);
    let last = result(dir, &joined[0]);
    assert!(last["best"]["mean"]["degree"].as_f64().unwrap_or_else(|| degree(&last)) >= best - 1e-12);

    // A damaged result does not count.
    let damaged = jobs[0].parse::<Value>().unwrap()["id"].as_str().unwrap().to_owned();
    fs::write(dir.join("enfilade-jobs").join(damaged).join("result/result.json"), "{}").unwrap();
    assert_eq!(enfilade(dir, &join, "").status.code(), Some(75));

    assert!(enfilade(dir, &["parts", "maze.dxf", "--parts", "2", "-o", "parts.jsonl"], "").status.success());
    let wrong = enfilade(dir, &["join", "parts.jsonl"], "");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&wrong.stderr).contains("merge"));
}
