//! Drawings as test problems: the program's own reader, moves, engine and penalties.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use enfilade_config::{Backend, Partial, Settings};
use enfilade_pipeline::{Input, LatticeAt, Study, Use};
use enfilade_report::Cancel;

use super::problem::{Problem, Worth};

/// A drawing to compare on.
struct Source {
    name: &'static str,
    /// Relative to `reference/` of the shared folder, or to `samples/` of the repository.
    file: &'static str,
    is_reference: bool,
    spacing_m: f64,
    centre_m: [f64; 2],
    score: &'static str,
}

const OPENING: &str = "degree +1, depth -1, entropy +1";

/// The paper's maze, the three rooms of the reference, and three samples.
const SOURCES: [Source; 7] = [
    Source {
        name: "maze_a",
        file: "maze_a.dxf",
        is_reference: true,
        spacing_m: 1.0,
        centre_m: [0.47, 0.37],
        score: "degree +1, depth -1, entropy -1",
    },
    room("simple_room", "simple_room.dxf"),
    room("large_room", "large_room.dxf"),
    room("art_gallery", "art_gallery.dxf"),
    sample("gallery", "gallery.dxf"),
    sample("library", "library.dxf"),
    sample("station", "station.dxf"),
];

const fn room(name: &'static str, file: &'static str) -> Source {
    Source { name, file, is_reference: true, spacing_m: 2.0, centre_m: [1.0, 1.0], score: OPENING }
}

const fn sample(name: &'static str, file: &'static str) -> Source {
    Source { name, file, is_reference: false, spacing_m: 1.0, centre_m: [0.5, 0.5], score: OPENING }
}

/// Measures one parameter vector.
type Measure = Box<dyn Fn(&[f64]) -> Worth + Sync>;
/// What every vertex sees with one parameter vector; not a number where a wall covers it.
type Maps = Box<dyn Fn(&[f64]) -> Vec<f64> + Sync>;

/// A drawing, read and ready to be measured.
pub struct PlanProblem {
    name: &'static str,
    bounds: Vec<[f64; 2]>,
    start: Vec<f64>,
    measure: Measure,
    seen: Maps,
}

/// Objective of a drawing that is named by its file.
const ROBUST: &str = "degree +1, mean-depth -1";
/// Shifted lattices over which it is measured, …
const LATTICES: u32 = 4;
/// … so much wider than the one that maps are of.
const WIDER: f64 = std::f64::consts::SQRT_2;

impl PlanProblem {
    /// Reads the drawing of that name; `None` where there is no such name.
    pub fn read(name: &str, shared: &Path) -> Option<Self> {
        if name.ends_with(".dxf") {
            return Some(Self::robust(name));
        }
        let source = SOURCES.iter().find(|s| s.name == name)?;
        let samples = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("samples");
        let folder = if source.is_reference { shared.join("reference") } else { samples };
        let bytes = std::fs::read(folder.join(source.file)).unwrap();
        let partial = Partial {
            spacing: Some(source.spacing_m),
            lattice_centre: Some(source.centre_m),
            score: Some(source.score.into()),
            backend: Some(Backend::Cpu),
            ..Partial::default()
        };
        let settings = Settings::new(partial).unwrap();
        let input = Input::new(source.file, &bytes, 1);
        let (_, study) = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap();
        let moves = &study.base.moves;
        let (bounds, start) = (moves.bounds(), moves.identity());
        let study = Arc::new(study);
        Some(Self { name: source.name, bounds, start, seen: seen(&study), measure: measure(study, settings) })
    }

    /// A drawing at its default spacing, measured over several lattices.
    fn robust(path: &str) -> Self {
        let bytes = std::fs::read(path).unwrap();
        let partial = Partial {
            score: Some(ROBUST.into()),
            penalty: Some("none".into()),
            backend: Some(Backend::Cpu),
            ..Partial::default()
        };
        let settings = Settings::new(partial).unwrap();
        let (_, study) =
            enfilade_pipeline::analyse(&Input::new(path, &bytes, 1), &settings, &Cancel::default()).unwrap();
        let spacing_um = (study.spacing_m * WIDER * 1e6).round() as i64;
        let at = |i: u32| {
            let turn = |k: u32| spacing_um * i64::from(k % LATTICES) / i64::from(LATTICES);
            LatticeAt { spacing_um, centre_um: [turn(i), turn(3 * i)] }
        };
        let lattices: Vec<LatticeAt> = (0..LATTICES).map(at).collect();
        let trial = study.on_lattices(&settings, &lattices, Use::Search(None)).unwrap();
        let moves = &study.base.moves;
        let (bounds, start) = (moves.bounds(), moves.identity());
        let seen = seen(&Arc::new(study));
        Self { name: "drawing", bounds, start, seen, measure: measure(Arc::new(trial), settings) }
    }
}

/// What every vertex sees.
fn seen(study: &Arc<Study>) -> Maps {
    let study = Arc::clone(study);
    Box::new(move |p| {
        let seen = study.measure(p, &mut study.bench()).seen;
        let mut map: Vec<f64> = seen.tally.degree.iter().map(|d| f64::from(*d)).collect();
        seen.covered.iter().for_each(|&i| map[i as usize] = f64::NAN);
        map
    })
}

fn measure(study: Arc<Study>, settings: Settings) -> Measure {
    let idle = Mutex::new(vec![study.bench()]);
    let pairs = study.lattice.cells.len() as f64 * study.lattice.query.len() as f64;
    Box::new(move |p| {
        let kept = idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut bench = kept.unwrap_or_else(|| study.bench());
        let worth = study.measure(p, &mut bench);
        idle.lock().unwrap_or_else(PoisonError::into_inner).push(bench);
        let means = worth.seen.means;
        Worth {
            score: study.score(&worth, &settings),
            violation: worth.seen.tally.disconnected as f64 / pairs,
            parts: vec![means.degree, means.depth, means.entropy, study.penalty(&worth, &settings)],
        }
    })
}

impl Problem for PlanProblem {
    fn name(&self) -> &'static str {
        self.name
    }
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.bounds.clone()
    }
    fn start(&self) -> Vec<f64> {
        self.start.clone()
    }
    fn worth(&self, p: &[f64]) -> Worth {
        (self.measure)(p)
    }
    fn map(&self, p: &[f64]) -> Vec<f64> {
        (self.seen)(p)
    }
}
