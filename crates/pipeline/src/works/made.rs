//! Works of the list made real: written, read again, measured from scratch.

use std::collections::BTreeSet;

use super::edits::{Written, beside, written};
use super::{Floor, listed};
use crate::analyse::measure;
use crate::job::{Input, Job};
use crate::measure::obstacles::stopping;
use crate::measure::study::Study;
use crate::read;
use crate::understand::edits::{edits_of, tied};
use crate::understand::understood;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Edit, EntityWork, Format, Shape};
use enfilade_config::{Settings, WorkTable};
use enfilade_engine::Obstacles;
use enfilade_engine::geometry::Segment;
use enfilade_moves::Layout;
use enfilade_overlay::built::OptionWork;
use enfilade_overlay::works::LEAST_SHOWN;
use enfilade_plan::view_box;
use enfilade_report::{Cancel, Error, Place, Report};
use enfilade_works::counts::degrees;
use enfilade_works::{Work, WorkKind};

/// Works of a drawing as they were made.
#[derive(Clone, Debug)]
pub struct MadeWorks {
    /// The drawing with them.
    pub bytes: Vec<u8>,
    /// Works that the drawing cannot hold, for the side-car of the new drawing.
    pub tables: Vec<WorkTable>,
    /// What the list leads to expect of them together, a share of the visible area.
    pub expected: f64,
    /// What they bring, of the file read again, over the cells of the layout before.
    pub gain: f64,
    /// What there is to say.
    pub report: Report,
}

/// Makes works of the list by their numbers, all in one drawing.
///
/// # Errors
/// [`Error::Usage`] for a number that the list does not have, and for works that change the same entity; as [`measure`].
pub fn make_works(
    input: &Input<'_>,
    settings: &Settings,
    ids: &[usize],
    cancel: &Cancel,
) -> Result<MadeWorks, Error> {
    let (study, mut report) = measure(input, settings, None, &mut || {}, cancel)?;
    let floor = Floor::of(&study, settings)?;
    let found = floor.works(&study, cancel)?;
    let listed = listed(&found.works);
    let works = ids.iter().map(|id| {
        let work = id.checked_sub(1).and_then(|i| listed.get(i).copied());
        work.map(|work| (*id, work)).ok_or_else(|| {
            let text = format!("--make {id}: the list has works 1 to {}; nothing was written", listed.len());
            Error::usage("work", Place::default(), text)
        })
    });
    let works = works.collect::<Result<Vec<_>, _>>()?;
    for (i, (id, work)) in works.iter().enumerate() {
        if let Some((other, _)) = works[..i].iter().find(|(_, o)| overlap(o, work)) {
            let text =
                format!("works {other} and {id} change the same stretch of a wall; nothing was written");
            return Err(Error::usage("work", Place::default(), text));
        }
        if !work.forbidden_by.is_empty() {
            let rules: Vec<&str> = work.forbidden_by.iter().map(|r| r.code()).collect();
            let text = format!("Work {id} is made, though it would not be offered: {}.", rules.join(", "));
            report.warn("work-forbidden", Place::file(input.file()), text);
        }
    }
    let still = Moved::none(&study.base);
    let made = Together::make(Job { input, settings }, (&study, &floor), &works, &still)?;
    report.extend(made.report.clone());
    let [expected, gain] = made.gains((&study, &floor));
    if let Some(text) = differs([expected, gain]) {
        let text = format!("{text} Compare `check` of both.");
        report.warn("work-differs", Place::file(input.file()), text);
    }
    Ok(MadeWorks { bytes: made.bytes, tables: made.written.tables, expected, gain, report })
}

/// Said where a drawing is read otherwise than meant.
fn differs([expected, gain]: [f64; 2]) -> Option<String> {
    ((gain - expected).abs() >= LEAST_SHOWN).then(|| {
        format!(
            "The program reads the new drawing differently also where nothing changed: visibility {:+.1} %, \
             expected {:+.1} %.",
            100.0 * gain,
            100.0 * expected
        )
    })
}

/// Whether the door of a work is an opening alone in a drawing: nothing is built or copied but its jambs.
fn is_bare_door(format: Format, work: &Work, written: &Written) -> bool {
    let is_door = matches!(work.kind, WorkKind::Door | WorkKind::Rehang);
    let has_arc = |shapes: &[Shape]| shapes.iter().any(|s| matches!(s, Shape::Arc { .. }));
    let is_leaf = |e: &Edit| match e {
        Edit::Work { work: EntityWork::Copy { .. }, .. } => true,
        Edit::Work { work: EntityWork::Build { shapes }, .. } => has_arc(shapes),
        _ => false,
    };
    format == Format::Dxf && is_door && !written.edits.iter().any(is_leaf)
}

/// Whether two works change the same stretch of one wall.
pub(super) fn overlap(a: &Work, b: &Work) -> bool {
    let [p, q] = a.stretch;
    let along = (q - p).normalize_or_zero();
    let [s, e] = b.stretch.map(|x| (x - p).dot(along));
    a.walls.iter().any(|w| b.walls.contains(w)) && s.min(e) < p.distance(q) && s.max(e) > 0.0
}

/// What moves where works are made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Moved {
    /// Of the moves of the drawing.
    pub(crate) parameters: Vec<f64>,
    /// What they make of it.
    pub(crate) layout: Layout,
}

impl Moved {
    /// Moves of a drawing.
    pub(crate) fn new(base: &Understood, parameters: Vec<f64>) -> Self {
        Self { layout: base.moves.apply(&base.plan, &base.graph, &parameters), parameters }
    }

    /// As drawn.
    pub(crate) fn none(base: &Understood) -> Self {
        Self::new(base, base.moves.identity())
    }

    /// Whether anything stands elsewhere.
    pub(crate) fn is_any(&self) -> bool {
        self.layout.walls.iter().any(|w| w.is_changed)
    }

    /// The changes of the file.
    ///
    /// # Errors
    /// As [`tied`].
    fn edits(&self, job: Job<'_>, base: &Understood) -> Result<Vec<Edit>, Error> {
        let mut edits = edits_of(base, &self.layout);
        if !edits.is_empty() {
            edits.extend(tied(job, base, &edits)?.following.into_iter().map(|f| f.edit));
        }
        Ok(edits)
    }
}

/// A drawing with works.
pub(crate) struct Drawn {
    /// Its bytes, without layers of ours but that of what was demolished.
    pub(crate) bytes: Vec<u8>,
    /// What it cannot hold, for its side-car.
    pub(crate) tables: Vec<WorkTable>,
}

/// Works made in one drawing, which was read again.
pub(crate) struct Together {
    /// How they are written.
    pub(crate) written: Written,
    /// The drawing with them, without layers of ours but that of what was demolished.
    pub(crate) bytes: Vec<u8>,
    /// What is to stop sight in it.
    pub(super) meant: Vec<Segment>,
    /// What does, of the file read again.
    pub(super) lines: Vec<Segment>,
    /// What there is to say.
    pub(super) report: Report,
}

impl Together {
    /// Makes works of a floor, each with its number in the list.
    ///
    /// # Errors
    /// [`Error::Usage`] for works that change the same entity; what writing and reading return.
    pub(crate) fn make(
        Job { input, settings }: Job<'_>,
        (study, floor): (&Study, &Floor),
        works: &[(usize, &Work)],
        moved: &Moved,
    ) -> Result<Self, Error> {
        let mut report = Report::default();
        let written = together((input, settings), (study, floor), works, &mut report)?;
        let options = read::read_options(settings);
        let mut edits = moved.edits(Job { input, settings }, &study.base)?;
        let shifted: BTreeSet<usize> = edits.iter().map(Edit::record).collect();
        if written.edits.iter().any(|e| shifted.contains(&e.record())) {
            let text = "what works change would move as well; nothing was written".to_owned();
            return Err(Error::usage("work", Place::file(input.file()), text));
        }
        edits.extend(written.edits.iter().cloned());
        let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &edits, &written.additions)?;
        let settings =
            Settings { works: [&settings.works[..], &written.tables].concat(), ..settings.clone() };
        let own = Input::new(input.path, &bytes, input.round);
        let mut silent = Report::default();
        let drawing = read::drawing(own.file(), &own.bytes, &settings, &mut silent)?;
        let base = understood(&drawing, &settings, &mut silent)?;
        let identity = base.moves.apply(&base.plan, &base.graph, &base.moves.identity());
        let lines = stopping(&base, &identity);
        drop(own);
        let drawn = stopping(&study.base, &moved.layout);
        let meant = works.iter().fold(drawn, |segments, (_, work)| work.change.apply(&segments));
        Ok(Self { written, bytes, meant, lines, report })
    }
}

impl Together {
    /// Gains in sight over the cells of the layout before: of what is meant, and of the file read again.
    fn gains(&self, (study, floor): (&Study, &Floor)) -> [f64; 2] {
        let sights = |segments: &[Segment]| {
            let blind = floor.vista.obstacles().blind.clone();
            let obstacles = Obstacles { segments: segments.to_vec(), blind };
            degrees(&study.lattice, &floor.vista.changed(&floor.graph, &obstacles)) as f64
        };
        let before = (degrees(&study.lattice, &floor.graph) as f64).max(1.0);
        [&self.meant, &self.lines].map(|segments| sights(segments) / before - 1.0)
    }
}

/// The drawing with the works of an option, which the list of the same drawing has too.
///
/// # Errors
/// [`Error::Input`] where the list has one of them no longer, and where the new drawing is read otherwise than meant; as
/// [`Together::make`].
pub(crate) fn of_option(job: Job<'_>, wanted: &[OptionWork], parameters: &[f64]) -> Result<Together, Error> {
    let Job { input, settings } = job;
    let cancel = Cancel::default();
    let (study, _) = measure(input, settings, None, &mut || {}, &cancel)?;
    let floor = Floor::of(&study, settings)?;
    let found = floor.works(&study, &cancel)?;
    let listed = listed(&found.works);
    let frame = &study.base.plan.frame;
    let is_near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) <= SAME_M;
    let is = |work: &Work, wanted: &OptionWork| {
        let ends = work.stretch.map(|p| frame.drawing_m_from_plan(p));
        work.kind.name() == wanted.kind && (0..2).all(|k| is_near(ends[k], wanted.stretch[k]))
    };
    let works = wanted.iter().map(|wanted| {
        let place = listed.iter().position(|work| is(work, wanted));
        place.map(|i| (i + 1, listed[i])).ok_or_else(|| {
            let text = format!(
                "{}: the drawing no longer has this place; nothing was written; run it again and accept from the new round",
                wanted.words
            );
            Error::input("works-changed", Place::file(input.file()), text)
        })
    });
    let works = works.collect::<Result<Vec<_>, _>>()?;
    let made = Together::make(job, (&study, &floor), &works, &Moved::new(&study.base, parameters.to_vec()))?;
    match differs(made.gains((&study, &floor))) {
        Some(text) => {
            let text =
                format!("{text} Nothing was written; `enfilade works` makes its works one after the other.");
            Err(Error::input("work-differs", Place::file(input.file()), text))
        }
        None => Ok(made),
    }
}

/// Ends of a stretch are written in whole millimetres: nearer ones are the same, metres.
const SAME_M: f64 = 1e-3;

/// All works as one set of changes.
fn together(
    (input, settings): (&Input<'_>, &Settings),
    (study, floor): (&Study, &Floor),
    works: &[(usize, &Work)],
    report: &mut Report,
) -> Result<Written, Error> {
    let drawing = read::drawing(input.file(), &input.bytes, settings, &mut Report::default())?;
    // As it was understood: marks name its entities by their place.
    let drawing = view_box::within(&drawing, settings.view.as_deref());
    let options = read::read_options(settings);
    let in_file = |works: &[&Work]| {
        let written = written(&study.base, (&drawing, &input.bytes), &floor.walls, works)?;
        let patched = enfilade_cad::patch(input.file(), &input.bytes, &options, &written.edits, &[]);
        patched.map(|_| written).map_err(|e| e.to_string())
    };
    let (mut held, mut tables): (Vec<&Work>, Vec<WorkTable>) = (Vec::new(), Vec::new());
    for (id, work) in works {
        match in_file(&[*work]) {
            Ok(written) => {
                if is_bare_door(study.base.plan.format, work, &written) {
                    let text = format!(
                        "Work {id} has no leaf: the drawing shows no door whose like could be drawn."
                    );
                    report.info("work-leaf", Place::file(input.file()), text);
                }
                held.push(*work);
            }
            Err(why) => {
                let text = format!("The side-car of the new drawing decides work {id}: {why}.");
                report.info("work-decided", Place::file(input.file()), text);
                tables.extend(beside(&study.base, &floor.walls, work));
            }
        }
    }
    if held.is_empty() {
        return Ok(Written { tables, ..Written::default() });
    }
    let written = in_file(&held).map_err(|why| {
        let text = format!("the works cannot be made together ({why}); make one after the other");
        Error::usage("work", Place::default(), text)
    })?;
    Ok(Written { tables, ..written })
}
