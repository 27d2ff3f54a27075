//! Drawings as test problems: the program's own reader, moves, engine and penalties.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use enfilade::config::{Backend, Partial, Settings};
use enfilade::pipeline::{self, Input, Study};
use enfilade::report::Cancel;

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

/// A drawing, read and ready to be measured.
pub struct PlanProblem {
    name: &'static str,
    bounds: Vec<[f64; 2]>,
    start: Vec<f64>,
    measure: Measure,
}

impl PlanProblem {
    /// Reads the drawing of that name; `None` where there is no such name.
    pub fn read(name: &str, shared: &Path) -> Option<Self> {
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
        let (_, study) = pipeline::analyse(&input, &settings, &Cancel::default()).unwrap();
        let moves = &study.base.moves;
        let (bounds, start) = (moves.bounds(), moves.identity());
        Some(Self { name: source.name, bounds, start, measure: measure(study, settings) })
    }
}

fn measure(study: Study, settings: Settings) -> Measure {
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
}
