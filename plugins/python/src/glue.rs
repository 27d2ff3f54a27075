//! What Python calls: values in and out, signals looked at while the program works. All else is `enfilade::commands::library`
//! on one side and the Python files beside this on the other.

use std::path::PathBuf;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Serialize;
use serde_json::{Map, Value, json};

use enfilade::commands::library;
use enfilade::daemon::Asked;
use enfilade_config::Partial;
use enfilade_overlay::StrokeKind;
use enfilade_pipeline::Progress;
use enfilade_pipeline::cells::CellOptions;
use enfilade_report::{Cancel, Error, Place, Problem};

/// How often Ctrl-C is looked for while the program works.
const SIGNAL_PAUSE: Duration = Duration::from_millis(50);
/// Who does not see the stop request in this time is left behind: everything stored appears whole or not at all.
const STOP_GRACE: Duration = Duration::from_secs(1);
/// Colours of a scale.
const COLOURS: usize = 256;

/// Numbers of a table in the memory of the program.
type Floats<'py> = Bound<'py, PyArray1<f64>>;

/// What a worker says.
enum Said<T> {
    Progress(Progress),
    Done(Result<T, Error>),
}

/// What is wrong with a value, as Python sees it.
fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let Some(p) = error.problem() else { return PyKeyboardInterrupt::new_err("stopped") };
    let place = (&p.place.file, p.place.line, &p.place.entity);
    let made = || {
        let class = py.import("enfilade._error")?.getattr("Error")?;
        class.call1((p.to_string(), p.code, place.0, place.1, place.2))
    };
    made().map_or_else(|e| e, PyErr::from_value)
}

/// Findings as a list of objects, each part of its place by itself.
fn findings(problems: &[Problem]) -> String {
    let one = |p: &Problem| {
        let Place { file, line, entity } = &p.place;
        json!({"code": p.code, "severity": p.severity, "file": file, "line": line, "entity": entity, "text": p.text})
    };
    Value::from_iter(problems.iter().map(one)).to_string()
}

fn to_json<T: Serialize>(value: &T) -> Result<String, Error> {
    serde_json::to_string(value).map_err(|e| Error::environment("json", Place::default(), e.to_string()))
}

/// Settings by name, as JSON.
fn settings(json: &str) -> Result<Partial, Error> {
    let named: Map<String, Value> =
        serde_json::from_str(json).map_err(|e| Error::usage("settings", Place::default(), e.to_string()))?;
    Partial::from_named(&named)
}

/// Works beside the interpreter, which is free meanwhile: `progress` hears of it with a line of JSON, and a signal or an
/// exception of `progress` stops it.
fn beside<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&mut (dyn FnMut(Progress) + Send), &Cancel) -> Result<T, Error> + Send + 'static,
) -> PyResult<T> {
    let cancel = Cancel::default();
    let stop = cancel.clone();
    let (say, heard) = mpsc::channel();
    thread::spawn(move || {
        // Nobody hears any more once the call was given up.
        let done = work(&mut |p| drop(say.send(Said::Progress(p))), &stop);
        drop(say.send(Said::Done(done)));
    });
    let heard = Mutex::new(heard);
    loop {
        let found = match next(py, &heard, SIGNAL_PAUSE) {
            Ok(Said::Done(done)) => return done.map_err(|e| raised(py, &e)),
            Ok(Said::Progress(p)) => progress.map_or(Ok(()), |f| tell(py, f, &p)),
            Err(RecvTimeoutError::Timeout) => Ok(()),
            Err(RecvTimeoutError::Disconnected) => Err(raised(py, &failed())),
        };
        if let Err(error) = found.and_then(|()| py.check_signals()) {
            cancel.stop_keeping();
            let until = Instant::now() + STOP_GRACE;
            let left = || until.saturating_duration_since(Instant::now());
            while !left().is_zero() && matches!(next(py, &heard, left()), Ok(Said::Progress(_))) {}
            return Err(error);
        }
    }
}

/// Waits for a word of the worker; the interpreter is free meanwhile.
fn next<T: Send>(py: Python<'_>, heard: &Mutex<Receiver<T>>, pause: Duration) -> Result<T, RecvTimeoutError> {
    py.detach(|| heard.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(pause))
}

fn tell(py: Python<'_>, progress: &Bound<'_, PyAny>, p: &Progress) -> PyResult<()> {
    let line = to_json(p).map_err(|e| raised(py, &e))?;
    progress.call1((line,)).map(drop)
}

fn failed() -> Error {
    let text = "the program failed; what it said stands on standard error; please report it with the drawing";
    Error::environment("job-panicked", Place::default(), text)
}

/// A drawing that was opened.
#[pyclass(frozen, module = "enfilade._enfilade")]
struct Drawing(Arc<library::Drawing>);

#[pymethods]
impl Drawing {
    #[new]
    fn new(py: Python<'_>, path: PathBuf, named: &str) -> PyResult<Self> {
        let opened = settings(named).and_then(|said| library::Drawing::open(&path, said));
        opened.map(|d| Self(Arc::new(d))).map_err(|e| raised(py, &e))
    }

    /// The check, its findings, the graph as JSON and as GraphML.
    fn check(&self, py: Python<'_>) -> PyResult<(String, String, String, String)> {
        let drawing = Arc::clone(&self.0);
        beside(py, None, move |_, _| {
            let outcome = drawing.check()?;
            let file = |name: &str| {
                let found = outcome.files.iter().find(|f| f.path.as_os_str() == name);
                found.map(|f| String::from_utf8_lossy(&f.bytes).into_owned()).unwrap_or_default()
            };
            let graphs = (file("graph.json"), file("graph.graphml"));
            Ok((to_json(&outcome.result)?, findings(&outcome.report.problems), graphs.0, graphs.1))
        })
    }

    fn measure(
        &self,
        py: Python<'_>,
        named: &str,
        roots: Option<usize>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Present> {
        let more = settings(named).map_err(|e| raised(py, &e))?;
        let drawing = Arc::clone(&self.0);
        let made = beside(py, progress, move |tell, cancel| drawing.measure(more, roots, tell, cancel))?;
        Ok(Present(Arc::new(made)))
    }

    /// The result, its findings, the folder and the number of the round.
    fn optimise(
        &self,
        py: Python<'_>,
        named: &str,
        pin: Vec<usize>,
        like: Option<usize>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(String, String, PathBuf, Option<u32>)> {
        let more = settings(named).map_err(|e| raised(py, &e))?;
        let asked = Asked { pin, like, ..Asked::default() };
        let drawing = Arc::clone(&self.0);
        beside(py, progress, move |tell, cancel| {
            let round = drawing.optimise(more, &asked, tell, cancel)?;
            Ok((to_json(&round.result)?, findings(&round.report.problems), round.folder, round.number))
        })
    }

    fn accept(
        &self,
        py: Python<'_>,
        round: u32,
        number: usize,
        out: Option<PathBuf>,
    ) -> PyResult<(PathBuf, bool)> {
        let drawing = Arc::clone(&self.0);
        beside(py, None, move |_, _| {
            let new = drawing.accept(round, number, out)?;
            Ok((new.path, new.is_new))
        })
    }
}

/// The present layout, measured.
#[pyclass(frozen, module = "enfilade._enfilade")]
struct Present(Arc<library::Present>);

/// A column: name, values, unit, ends of its scale, its colours.
type ColumnParts<'py> = (String, Floats<'py>, &'static str, [f64; 2], Bound<'py, PyBytes>);
/// A table: `Ref`, x, y, columns.
type TableParts<'py> = (Bound<'py, PyArray1<i64>>, Floats<'py>, Floats<'py>, Vec<ColumnParts<'py>>);

#[pymethods]
impl Present {
    #[getter]
    fn spacing_m(&self) -> f64 {
        self.0.study.spacing_m
    }

    #[getter]
    fn findings(&self) -> String {
        findings(&self.0.report.problems)
    }

    /// The table; the memory of its columns is handed over, not copied.
    fn cells<'py>(
        &self,
        py: Python<'py>,
        measures: Vec<String>,
        radius: Option<f64>,
        step_from: Vec<[f64; 2]>,
        in_metres: bool,
    ) -> PyResult<TableParts<'py>> {
        let present = Arc::clone(&self.0);
        let options = CellOptions { measures, radius, step_from, ..CellOptions::default() };
        let (cells, centres) = beside(py, None, move |_, _| {
            let mut cells = present.cells(options)?;
            cells.undefined_as(f64::NAN);
            let centres = cells.places(&present.study, in_metres);
            Ok((cells, centres))
        })?;
        let columns = cells.columns.into_iter().map(|column| {
            let look = enfilade_pipeline::column_look(&column.name, &column.values, &self.0.settings);
            let at = |k: usize| look.palette.at(k as f64 / (COLOURS - 1) as f64);
            let colours: Vec<u8> = (0..COLOURS).flat_map(at).collect();
            let scale = [look.scale.lo, look.scale.hi];
            (column.name, column.values.into_pyarray(py), look.unit, scale, PyBytes::new(py, &colours))
        });
        let [x, y] = centres.map(|v| v.into_pyarray(py));
        Ok((cells.reference.into_pyarray(py), x, y, columns.collect()))
    }

    /// `Ref` of the rows, where the entries of each row begin, and what is seen.
    #[allow(clippy::type_complexity)]
    fn views<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i32>>)> {
        let present = Arc::clone(&self.0);
        let (cells, views) = beside(py, None, move |_, _| present.views())?;
        Ok((cells.reference.into_pyarray(py), views.start.into_pyarray(py), views.seen.into_pyarray(py)))
    }

    /// Walls: corners in metres of the drawing, whether closed, whether filled, whether they may move.
    fn walls(&self) -> Vec<(Vec<[f64; 2]>, bool, bool, bool)> {
        let frame = self.0.study.base.plan.frame;
        let strokes = enfilade_pipeline::picture(&self.0.study).strokes.into_iter();
        let metres = |p: [f64; 2]| frame.drawing_m_from_plan(p.into());
        let one = |s: enfilade_overlay::Stroke| {
            let points = s.points.into_iter().map(metres).collect();
            (points, s.closed, s.filled, s.kind == StrokeKind::Movable)
        };
        strokes.map(one).collect()
    }
}

/// Enfilade for Python; see the package `enfilade`.
#[pymodule]
fn _enfilade(m: &Bound<'_, PyModule>) -> PyResult<()> {
    m.add("VERSION", enfilade_config::VERSION)?;
    m.add_class::<Drawing>()?;
    m.add_class::<Present>()
}
