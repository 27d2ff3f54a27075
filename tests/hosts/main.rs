//! What the program writes, opened by the programs it is meant for: ezdxf, LibreCAD, FreeCAD and a
//! browser. A program that is not installed skips its tests with a printed note, unless
//! `ENFILADE_HOSTS=required`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

mod records;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use serde_json::Value;

/// No host needs longer for drawings this small; LibreCAD waits for ever at a dialog it cannot show.
const HOST_SECONDS_MAX: u64 = 120;

/// A sample on which the program has done its main job.
struct Job {
    drawing: PathBuf,
    round: PathBuf,
    result: Value,
}

impl Job {
    fn run(name: &str) -> Self {
        let drawing = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.dxf"));
        let out = empty_folder(&format!("job-{name}"));
        let run = Command::new(env!("CARGO_BIN_EXE_enfilade"))
            .args(["run", "--quiet", "--evaluations", "60", "--seed", "1", "--spacing", "1", "--out"])
            .arg(&out)
            .arg(&drawing)
            .output()
            .expect("the program starts");
        assert!(matches!(run.status.code(), Some(0 | 1)), "{name}: {}", String::from_utf8_lossy(&run.stderr));
        let round = out.join(format!("{name}.enfilade/round-01"));
        let text = fs::read_to_string(round.join("result.json")).expect("result.json");
        Self { drawing, round, result: serde_json::from_str(&text).expect("JSON") }
    }

    /// Drawings of the round, each with the changes that the result names.
    fn drawings(&self) -> Vec<(PathBuf, &[Value])> {
        let candidates = self.result["candidates"].as_array().expect("candidates");
        assert!(!candidates.is_empty(), "{}: no candidate", self.drawing.display());
        let mut all = vec![(self.round.join("initial.dxf"), &[][..])];
        for candidate in candidates {
            let file = self.round.join(candidate["file"].as_str().expect("file"));
            all.push((file, candidate["changes"].as_array().expect("changes")));
        }
        all
    }
}

/// Single lines in metres; R12 without handles or units; outlines and MTEXT in millimetres.
static JOBS: LazyLock<Vec<Job>> = LazyLock::new(|| ["gallery", "maze", "office"].map(Job::run).into());

/// An empty folder of this test run.
fn empty_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hosts").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("folder");
    folder
}

/// The first of the programs that is installed; `None`, with a note, where none is.
fn host(programs: &[&str]) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let installed =
        programs.iter().flat_map(|p| folders.iter().map(move |f| f.join(p))).find(|p| p.is_file());
    if installed.is_none() {
        skip(programs[0]);
    }
    installed
}

fn skip(what: &str) {
    assert!(std::env::var_os("ENFILADE_HOSTS").is_none_or(|v| v != "required"), "{what} is not installed");
    println!("skipped: {what} is not installed (scripts/setup)");
}

/// Runs a host to its end: whether it ended well, and what it said.
fn finish(command: &mut Command) -> (bool, String) {
    let log = empty_folder(&format!("log-{:?}", std::thread::current().id())).join("log.txt");
    let file = fs::File::create(&log).expect("log");
    let both = file.try_clone().expect("log");
    let mut child = command.stdin(Stdio::null()).stdout(file).stderr(both).spawn().expect("the host starts");
    let start = Instant::now();
    let ended = loop {
        if let Some(status) = child.try_wait().expect("status") {
            break status.success();
        }
        if start.elapsed() > Duration::from_secs(HOST_SECONDS_MAX) {
            child.kill().expect("kill");
            child.wait().expect("wait");
            break false;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    (ended, String::from_utf8_lossy(&fs::read(&log).expect("log")).into_owned())
}

#[test]
fn candidates_change_only_what_the_result_names() {
    for job in &*JOBS {
        let before = fs::read_to_string(&job.drawing).unwrap();
        for (k, (file, changes)) in job.drawings().iter().enumerate() {
            let named: BTreeSet<usize> =
                changes.iter().filter_map(|c| c["element"]["record"].as_u64()).map(|r| r as usize).collect();
            let (moved, faults) = records::compare(&before, &fs::read_to_string(file).unwrap(), &named);
            assert!(faults.is_empty(), "{}:\n{}", file.display(), faults.join("\n"));
            assert_eq!(moved > 0, k > 0, "{}: {moved} records moved", file.display());
        }
    }
}

#[test]
fn ezdxf_finds_no_error() {
    const AUDIT: &str = "
import sys, ezdxf
faults = 0
for path in sys.argv[1:]:
    for error in ezdxf.readfile(path).audit().errors:
        print(path, error.code, error.message)
        faults += 1
sys.exit(1 if faults else 0)";
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/bin/python");
    let has_ezdxf = |python: &Path| {
        Command::new(python).args(["-c", "import ezdxf"]).output().is_ok_and(|o| o.status.success())
    };
    let named = std::env::var_os("ENFILADE_PYTHON").map(PathBuf::from);
    let Some(python) = named.into_iter().chain([own, "python3".into()]).find(|p| has_ezdxf(p)) else {
        return skip("ezdxf");
    };
    for job in &*JOBS {
        let files = job.drawings().into_iter().map(|d| d.0);
        let (is_clean, words) = finish(Command::new(&python).args(["-c", AUDIT]).args(files));
        assert!(is_clean, "{words}");
    }
}

#[test]
fn librecad_draws_every_drawing() {
    let (Some(librecad), Some(pdftoppm)) = (host(&["librecad"]), host(&["pdftoppm"])) else { return };
    let home = empty_folder("librecad");
    for job in &*JOBS {
        for (k, (file, _)) in job.drawings().iter().enumerate() {
            // LibreCAD writes beside the drawing whatever it is told.
            let name = format!("{}-{k}", job.drawing.file_stem().unwrap().to_string_lossy());
            fs::copy(file, home.join(format!("{name}.dxf"))).unwrap();
            let mut draw = Command::new(&librecad);
            draw.args(["dxf2pdf", "-a", "-m", "-p", "420x297"]).arg(format!("{name}.dxf")).current_dir(&home);
            let (is_done, words) = finish(draw.env("HOME", &home).env("QT_QPA_PLATFORM", "offscreen"));
            assert!(is_done, "{}: {words}", file.display());
            let mut paint = Command::new(&pdftoppm);
            paint.args(["-gray", "-singlefile", "-scale-to", "400"]).arg(format!("{name}.pdf")).arg(&name);
            let (is_done, words) = finish(paint.current_dir(&home));
            assert!(is_done, "{}: no PDF: {words}", file.display());
            let picture = fs::read(home.join(format!("{name}.pgm"))).unwrap();
            let dark = picture.iter().skip(20).filter(|&&grey| grey < 128).count();
            assert!(dark > 500, "{}: {dark} dark dots", file.display());
        }
    }
}

/// What FreeCAD reads on each layer that is not ours: edges and millimetres.
fn freecad_layers(freecad: &Path, home: &Path, drawing: &Path) -> Vec<(String, u64, f64)> {
    let out = home.join("lengths.txt");
    let _ = fs::remove_file(&out);
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hosts/freecad_lengths.py");
    let mut read = Command::new(freecad);
    read.arg(script).env("HOME", home).env("LANG", "C.UTF-8");
    let (is_done, words) = finish(read.env("ENFILADE_DXF", drawing).env("ENFILADE_OUT", &out));
    assert!(is_done, "{}: {words}", drawing.display());
    let text = fs::read_to_string(&out).unwrap();
    let layers = text.lines().map(|line| {
        let [name, edges, length] = line.split(' ').collect::<Vec<_>>()[..] else { panic!("{line}") };
        (name.to_owned(), edges.parse().unwrap(), length.parse().unwrap())
    });
    layers.filter(|l: &(String, u64, f64)| !l.0.starts_with("EF_")).collect()
}

#[test]
fn freecad_reads_the_same_walls() {
    let Some(freecad) = host(&["freecadcmd", "FreeCADCmd"]) else { return };
    let home = empty_folder("freecad");
    // Single lines in metres: the wall length is the length drawn.
    let job = &JOBS[0];
    let before = freecad_layers(&freecad, &home, &job.drawing);
    assert_eq!(before.len(), 1, "{before:?}");
    for (k, (file, _)) in job.drawings().iter().enumerate() {
        let after = freecad_layers(&freecad, &home, file);
        assert_eq!(after.len(), 1, "{}: {after:?}", file.display());
        assert_eq!((&after[0].0, after[0].1), (&before[0].0, before[0].1), "{}", file.display());
        let penalty = match k {
            0 => &job.result["initial"]["penalty"],
            k => &job.result["candidates"][k - 1]["penalty"],
        };
        let change_m = (after[0].2 - before[0].2).abs() / 1e3;
        let stated_m = penalty["wall_length_m"].as_f64().expect("wall_length_m");
        assert!((change_m - stated_m).abs() < 1e-5, "{}: {change_m} m, stated {stated_m}", file.display());
    }
}

#[test]
fn a_browser_shows_the_report_from_disk() {
    let Some(browser) = host(&["chromium", "chromium-browser", "google-chrome"]) else { return };
    let home = empty_folder("browser");
    let picture = home.join("report.png");
    let mut show = Command::new(browser);
    show.args([
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--hide-scrollbars",
        "--window-size=1200,1600",
    ]);
    show.arg("--enable-logging=stderr").arg(format!("--user-data-dir={}", home.display()));
    show.arg(format!("--screenshot={}", picture.display()));
    let (is_done, words) = finish(show.arg(JOBS[0].round.join("report.html")).env("HOME", &home));
    assert!(is_done, "{words}");
    let faults: Vec<_> = words.lines().filter(|l| l.contains("CONSOLE") || l.contains("ERR_")).collect();
    assert!(faults.is_empty(), "{faults:?}");
    // A blank page of this size compresses to less.
    assert!(fs::metadata(&picture).expect("screenshot").len() > 30_000);
}

#[test]
fn an_accepted_candidate_is_a_clean_drawing() {
    for name in ["gallery", "maze"] {
        let folder = empty_folder(&format!("accept-{name}"));
        let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples").join(format!("{name}.dxf"));
        let drawing = folder.join(format!("{name}.dxf"));
        fs::copy(&sample, &drawing).unwrap();
        let enfilade = |words: &[&str]| {
            let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
            command.arg(words[0]).arg(&drawing).args(&words[1..]);
            let (is_done, said) = finish(&mut command);
            assert!(is_done, "{words:?}: {said}");
        };
        enfilade(&[
            "run",
            "--quiet",
            "--members",
            "1",
            "--evaluations",
            "60",
            "--seed",
            "1",
            "--spacing",
            "1",
            "--raw",
        ]);
        enfilade(&["accept", "1"]);
        let before = fs::read_to_string(&sample).unwrap();
        let after = fs::read_to_string(folder.join(format!("{name}-r02.dxf"))).unwrap();
        let everything = (0..records::records(&before).len()).collect();
        let (moved, faults) = records::compare(&before, &after, &everything);
        assert!(faults.is_empty(), "{name}:\n{}", faults.join("\n"));
        assert!(moved > 0);
        for ours in ["EF-MOVED", "EF-BEFORE", "EF-NOTE", "EF-HEAT"] {
            assert!(!after.contains(ours), "{name}-r02.dxf holds {ours}");
        }
        assert_eq!(fs::read_to_string(&drawing).unwrap(), before, "the drawing itself was touched");
    }
}
