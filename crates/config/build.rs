//! Tells the program which commit it is built from: `ENFILADE_COMMIT`, else what git says, else nothing. Only git is asked
//! in builds for users: a build for tests would be out of date with every commit.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-env-changed=ENFILADE_COMMIT");
    let stated = std::env::var("ENFILADE_COMMIT").ok();
    let is_for_users = std::env::var("PROFILE").is_ok_and(|p| p == "release");
    let commit = stated.or_else(|| {
        // The log grows with every commit, wherever HEAD points.
        let log = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|_| is_for_users)?;
        if Path::new(&log).exists() {
            println!("cargo::rerun-if-changed={log}");
        }
        git(&["rev-parse", "--short=9", "HEAD"])
    });
    println!("cargo::rerun-if-changed=build.rs");
    let suffix = commit.filter(|c| !c.is_empty()).map_or(String::new(), |c| format!(" ({c})"));
    println!("cargo::rustc-env=ENFILADE_COMMIT_SUFFIX={suffix}");
}

fn git(arguments: &[&str]) -> Option<String> {
    let done = Command::new("git").args(arguments).output().ok().filter(|done| done.status.success())?;
    Some(String::from_utf8(done.stdout).ok()?.trim().to_owned())
}
