//! Batches: `jobs` lists, `run-job` does each once and the same everywhere.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn enfilade(args: &[&str], input: &str) -> Output {
    enfilade_in(Path::new("."), args, input)
}

/// What the program says in a folder to arguments and its standard input.
pub fn enfilade_in(folder: &Path, args: &[&str], input: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
        .current_dir(folder)
        .args(args)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

fn sample() -> PathBuf {
    enfilade_fixtures::repository("samples/gallery.dxf")
}

/// Lines of `jobs` for these plans.
fn list(plans: &[&Path], more: &[&str], out: &Path) -> Vec<String> {
    let plans = plans.iter().map(|p| text(p));
    let args: Vec<&str> =
        ["jobs"].into_iter().chain(plans).chain(["--out", text(out), "--evaluations", "60"]).collect();
    let output = enfilade(&[&args[..], more].concat(), "");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap().lines().map(str::to_owned).collect()
}

fn finished(output: &Output) -> Value {
    let words = String::from_utf8_lossy(&output.stderr);
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {words}"))
}

#[test]
fn a_job_is_done_once_and_the_same_wherever_it_is_done() {
    let dir = tempfile::tempdir().unwrap();
    let (out, other) = (dir.path().join("out"), dir.path().join("other"));
    let jobs = list(&[&sample()], &["--seeds", "3..4", "--embed"], &out);
    assert_eq!(jobs.len(), 2);
    let first = finished(&enfilade(&["run-job", &jobs[0]], ""));
    let result = out.join(first["id"].as_str().unwrap()).join("result");
    let report = fs::metadata(result.join("report.html")).unwrap().modified().unwrap();
    // Again: nothing is done, the same is said.
    assert_eq!(finished(&enfilade(&["run-job", "-"], &jobs[0])), first);
    assert_eq!(fs::metadata(result.join("report.html")).unwrap().modified().unwrap(), report);
    // What is gone or was changed is made again, as it was.
    let option = result.join("candidate-1.dxf");
    let bytes = fs::read(&option).unwrap();
    for spoil in [|p: &Path| fs::remove_file(p), |p: &Path| fs::write(p, "junk")] {
        spoil(&option).unwrap();
        assert_eq!(finished(&enfilade(&["run-job", &jobs[0]], ""))["digest"], first["digest"]);
        assert_eq!(fs::read(&option).unwrap(), bytes);
    }
    // Another machine: other folders, other threads, no drawing.
    let moved = jobs[0].replace(text(sample().parent().unwrap()), "/nowhere");
    assert_ne!(moved, jobs[0]);
    let there = finished(&enfilade(&["run-job", "-", "--out", text(&other), "--threads", "1"], &moved));
    assert_eq!(there["digest"], first["digest"]);
    let second = finished(&enfilade(&["run-job", &jobs[1], "--out", text(&other)], ""));
    assert_ne!(second["digest"], first["digest"]);
}

/// More threads than cores hand each other work while they wait: whoever waited in a lock for it waited for himself.
#[test]
fn many_threads_make_what_one_makes() {
    let dir = tempfile::tempdir().unwrap();
    let jobs = list(&[&enfilade_fixtures::repository("samples/flat.dxf")], &["--seeds", "5..5"], dir.path());
    let with = |threads: &str| {
        let out = dir.path().join(threads);
        finished(&enfilade(&["run-job", &jobs[0], "--out", text(&out), "--threads", threads], ""))
    };
    let [many, one] = ["16", "1"].map(with);
    assert_eq!(many["digest"], one["digest"]);
}

#[test]
fn bad_jobs_end_with_2_and_a_busy_one_asks_for_another_try() {
    let dir = tempfile::tempdir().unwrap();
    let (out, drawing) = (dir.path().join("out"), dir.path().join("plan.dxf"));
    fs::copy(sample(), &drawing).unwrap();
    let job = list(&[&drawing], &[], &out).remove(0);
    let code = |job: &str| enfilade(&["run-job", job], "").status.code();
    for bad in ["", "{}", "no json", &job.replace("\"seed\":1", "\"seed\":2")] {
        assert_eq!(code(bad), Some(2), "{bad}");
    }
    let id = serde_json::from_str::<Value>(&job).unwrap()["id"].as_str().unwrap().to_owned();
    fs::create_dir_all(out.join(&id)).unwrap();
    let lock = fs::File::create(out.join(&id).join(".lock")).unwrap();
    lock.lock().unwrap();
    assert_eq!(code(&job), Some(75));
    drop(lock);
    fs::write(&drawing, b"changed meanwhile").unwrap();
    assert_eq!(code(&job), Some(2));
    fs::remove_file(&drawing).unwrap();
    assert_eq!(code(&job), Some(2));
}

/// No further try takes a link out of the place of results.
#[cfg(unix)]
#[test]
fn a_link_in_the_place_of_results_asks_for_no_other_try() {
    let dir = tempfile::tempdir().unwrap();
    let (out, elsewhere) = (dir.path().join("out"), dir.path().join("elsewhere"));
    fs::create_dir(&elsewhere).unwrap();
    let job = list(&[&sample()], &[], &out).remove(0);
    let id: Value = serde_json::from_str(&job).unwrap();
    let folder = out.join(id["id"].as_str().unwrap());
    fs::create_dir_all(&folder).unwrap();
    std::os::unix::fs::symlink(&elsewhere, folder.join("result")).unwrap();
    let ended = enfilade(&["run-job", &job], "");
    let said = String::from_utf8_lossy(&ended.stderr);
    assert!(ended.status.code() == Some(4) && said.contains("link"), "{ended:?}");
    assert_eq!(fs::read_dir(&elsewhere).unwrap().count(), 0);
}

#[test]
fn a_job_named_twice_is_listed_once() {
    let dir = tempfile::tempdir().unwrap();
    let jobs = list(&[&sample(), &sample()], &["--seeds", "3,1..3,3"], dir.path());
    let seeds: Vec<Value> =
        jobs.iter().map(|j| serde_json::from_str::<Value>(j).unwrap()["settings"]["seed"].clone()).collect();
    assert_eq!(seeds, [3, 1, 2]);
}

#[test]
fn storeys_are_jobs_and_what_cannot_be_listed_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    assert_eq!(list(&[&sample()], &["--storeys", "all", "--seeds", "1,5"], &out).len(), 2);
    let pavilion = sample().with_file_name("pavilion.ifc");
    let named = list(&[&pavilion], &["--storeys", "Ground floor, upper floor,GROUND FLOOR"], &out);
    let storeys: Vec<Value> = named
        .iter()
        .map(|j| serde_json::from_str::<Value>(j).unwrap()["settings"]["storey"].clone())
        .collect();
    assert_eq!(storeys, ["Ground floor", "Upper floor"], "as the building writes them");
    for bad in [["--seeds", "5..1"], ["--members", "999"], ["--storeys", "A,B"]] {
        let output = enfilade(&[&["jobs", text(&sample())][..], &bad[..]].concat(), "");
        assert_eq!(output.status.code(), Some(3), "{bad:?}");
    }
    let output = enfilade(&["jobs", text(&pavilion), "--storeys", "Ground floor,Attic"], "");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(
        said.contains("\"Attic\"")
            && said.contains("1 \"Ground floor\"")
            && said.contains("2 \"Upper floor\""),
        "{said}"
    );
    let listed = dir.path().join("jobs.jsonl");
    fs::write(&listed, "{\"schema\": \"enfilade.job/1\"}\n").unwrap();
    let output = enfilade(&["jobs", text(&listed)], "");
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A scene has the storeys of the IFC beside it, and is worked on with it wherever that is; another IFC is another job.
#[test]
fn a_scene_is_listed_and_worked_on_with_the_ifc_beside_it() {
    let dir = tempfile::tempdir().unwrap();
    let [out, far] = ["out", "far"].map(|name| dir.path().join(name));
    let here = |name: &str| dir.path().join(name);
    let (scene, twin) = (here("house.glb"), here("house.ifc"));
    fs::copy(sample().with_file_name("pavilion.glb"), &scene).unwrap();
    let of =
        |jobs: &[String]| -> Vec<Value> { jobs.iter().map(|j| serde_json::from_str(j).unwrap()).collect() };
    let alone = of(&list(&[&scene], &["--storeys", "all"], &out));
    assert!(alone.len() == 2 && alone[0].get("beside").is_none(), "{alone:?}");
    let building = fs::read_to_string(sample().with_file_name("pavilion.ifc")).unwrap();
    fs::write(&twin, &building).unwrap();
    let jobs = list(&[&scene], &["--storeys", "all"], &out);
    let storeys: Vec<Value> = of(&jobs).iter().map(|j| j["settings"]["storey"].clone()).collect();
    assert_eq!(storeys, ["Ground floor", "Upper floor"]);
    let embedded = list(&[&scene], &["--storeys", "2", "--embed"], &out);
    assert_eq!(of(&embedded)[0]["id"], of(&jobs)[1]["id"], "the same job, carried");
    let first = finished(&enfilade(&["run-job", &jobs[1]], ""));
    assert_eq!(first["storey"], "Upper floor");
    // Storeys of one name are named by number.
    fs::write(&twin, building.replace("'Upper floor'", "'Ground floor'")).unwrap();
    let same = of(&list(&[&scene], &["--storeys", "1,2"], &out));
    let storeys: Vec<Value> = same.iter().map(|j| j["settings"]["storey"].clone()).collect();
    assert_eq!(storeys, ["storey-1", "storey-2"]);
    let output = enfilade(&["run-job", &jobs[0]], "");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("what lies beside it"), "{said}");
    // A job that carries all needs neither file.
    fs::remove_file(&scene).unwrap();
    fs::remove_file(&twin).unwrap();
    let away = finished(&enfilade(&["run-job", &embedded[0], "--out", text(&far)], ""));
    assert_eq!(away["digest"], first["digest"]);
}
