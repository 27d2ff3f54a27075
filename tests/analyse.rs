//! `analyse`: where its tables go, and what it says of estimates.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn enfilade(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enfilade")).args(args).output().unwrap()
}

fn sample(name: &str) -> String {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples").join(name).to_string_lossy().into_owned()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Tables may go into the folder of the heat maps, which is put in place whole, and to standard output.
#[test]
fn tables_stay_where_they_are_sent() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let made = folder.path().join("gallery.enfilade/analysis");
    let (cells, edges) = (made.join("c.csv"), made.join("e.csv"));
    let gallery = sample("gallery.dxf");
    let analyse = |more: &[&str]| {
        let done = enfilade(&[&["analyse", &gallery, "--spacing", "1", "--out", &out], more].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stdout)
    };
    for _ in 0..2 {
        analyse(&["--cells", &cells.to_string_lossy(), "--edges", &edges.to_string_lossy()]);
        assert!(made.join("degree.png").is_file() && edges.is_file());
        let told = analyse(&["--cells", "-"]);
        assert!(!cells.is_file(), "the folder is put in place whole");
        assert!(told.starts_with("Ref,x,y,") && !told.contains("heat maps"), "{told}");
    }
    assert!(!Path::new("-").exists());
}

/// What is estimated says so: on standard output, in the result, with its interval beside it.
#[test]
fn estimates_are_called_estimates() {
    let folder = tempfile::tempdir().unwrap();
    let [out, csv, result] =
        ["", "cells.csv", "a.json"].map(|n| folder.path().join(n).to_string_lossy().into_owned());
    let gallery = sample("gallery.dxf");
    let args = ["analyse", &gallery, "--spacing", "0.5", "--out", &out, "--cells", &csv];
    let on_card = enfilade(&[&args[..], &["--roots", "20", "--backend", "gpu"]].concat());
    assert!(text(&on_card.stderr).contains("no graphics card was asked"), "{}", text(&on_card.stderr));
    let json_to = format!("--json={result}");
    let roots = ["--roots", "20", "--measures", "Visual Mean Depth", &json_to];
    let told = enfilade(&[&args[..], &roots].concat());
    assert!(told.status.success(), "{}", text(&told.stderr));
    assert!(text(&told.stdout).contains("depth and entropy estimated from "), "{}", text(&told.stdout));
    let found = json(Path::new(&result));
    let roots = found["estimated_from_roots"].as_u64().unwrap();
    assert!((15..40).contains(&roots), "{roots}");
    let table = std::fs::read_to_string(&csv).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("Ref,x,y,Visual Mean Depth,Visual Mean Depth CI95,Degree,Depth,Entropy"));
    let walked = lines.filter(|l| !l.ends_with(",,")).count() as u64;
    assert_eq!(walked, roots, "only roots have a tree of their own");
    assert!(enfilade(&[&args[..], &[&json_to]].concat()).status.success());
    let exact = json(Path::new(&result));
    assert!(exact.get("estimated_from_roots").is_none() && exact.get("mean_ci95").is_none());
    for key in ["depth", "entropy"] {
        let off = (found["mean"][key].as_f64().unwrap() - exact["mean"][key].as_f64().unwrap()).abs();
        assert!(off <= 2.0 * found["mean_ci95"][key].as_f64().unwrap(), "{key}: {off}");
    }
    assert_eq!(found["mean"]["degree"], exact["mean"]["degree"]);
}
