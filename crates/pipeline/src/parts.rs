//! One analysis in parts, for several machines: what begins at every cell by itself is done in shares, and joined.
//!
//! A part reads the drawing, lays its cells and finds who sees whom, as every other does; trees, ways, isovists and sight
//! lines begin at the cells of its share alone. Joined, the parts are what one machine measures, bit for bit.

mod bytes;

use std::sync::Arc;

use crate::job::{Input, Job};
use crate::measure::cells::CellOptions;
use crate::measure::known::{Forest, Known, Print};
use crate::measure::study::Study;
use crate::storey::measure_storey;
use crate::{read, storeys};
use bytes::Scene;
use enfilade_config::Settings;
use enfilade_engine::shares::Share;
use enfilade_engine::walked::{Joining, Wanted, part as part_of};
use enfilade_report::{Cancel, Error, Place};

/// What a part has made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// Its values, to be given to [`join`].
    pub bytes: Vec<u8>,
    /// Cells of all lattices, of which it did its share.
    pub cells: u64,
}

/// Refuses what cannot be asked for, before anything is done.
///
/// # Errors
/// [`Error::Usage`] for a measure that does not exist and a radius of no whole steps.
pub fn judge(asked: &CellOptions) -> Result<(), Error> {
    asked.wanted().map(drop)
}

/// Measures what is asked for of the cells, as [`measure_cells`](crate::cells::measure_cells) is asked, at a share of them:
/// part `number`, from 1, of `count`.
///
/// # Errors
/// As [`analyse`](crate::analyse), and for measures that do not exist; [`Error::Stopped`].
pub fn part(
    input: &Input<'_>,
    settings: &Settings,
    asked: &CellOptions,
    (number, count): (u32, u32),
    cancel: &Cancel,
) -> Result<Part, Error> {
    let wanted = asked.wanted()?;
    let share = number.checked_sub(1).and_then(|n| Share::new(n, count)).unwrap_or(Share::WHOLE);
    let settings = &*read::query::for_its_storey(input, settings)?;
    let job = Job { input, settings };
    let (shown, _) = measure_storey(job, (Forest::Nobody, None), &mut || {}, cancel)?;
    let mut scenes = Vec::new();
    add(&mut scenes, &shown, &wanted, share, cancel)?;
    for study in storeys::views(job, &shown, cancel)? {
        add(&mut scenes, &study, &Wanted::default(), share, cancel)?;
    }
    let cells = scenes.iter().map(|s| s.vertices as u64).sum();
    Ok(Part { bytes: bytes::written(&scenes), cells })
}

/// Adds the shares of a study; `wanted` of its unnamed pair of regions, trees alone of the others.
fn add(
    scenes: &mut Vec<Scene>,
    study: &Study,
    wanted: &Wanted,
    share: Share,
    cancel: &Cancel,
) -> Result<(), Error> {
    let obstacles = study.initial_obstacles();
    for (i, scene) in study.scenes().enumerate() {
        cancel.check()?;
        let print = scene.print.unwrap_or_default();
        if scenes.iter().any(|s| s.print == print) {
            continue;
        }
        let wanted = if i == 0 { *wanted } else { Wanted::default() };
        let lattice = &*scene.lattice;
        let part =
            scene.evaluator.with_present(|_, graph| part_of((lattice, graph, &obstacles), &wanted, share));
        scenes.push(Scene { print, vertices: lattice.cells.len(), part });
    }
    Ok(())
}

/// Joins the bytes of all parts, each with its number, in any order.
///
/// # Errors
/// [`Error::Input`], `parts-other`, for what is no part, or a part of other cells than the first; what `parts` returns.
pub fn join(parts: impl IntoIterator<Item = Result<(u32, Vec<u8>), Error>>) -> Result<Known, Error> {
    let other =
        |text: String| Error::input("parts-other", Place::default(), format!("{text}; nothing was written"));
    let mut all: Vec<(Print, Joining)> = Vec::new();
    let mut first = None;
    for part in parts {
        let (number, bytes) = part?;
        let scenes =
            bytes::read(&bytes).ok_or_else(|| other(format!("part {number} is damaged; do it again")))?;
        if first.is_none() {
            all = scenes.iter().map(|s| (s.print, Joining::new(s.vertices))).collect();
        }
        let is_like = |s: &Scene, known: &(Print, Joining)| s.print == known.0;
        let are_alike =
            scenes.len() == all.len() && scenes.iter().zip(&all).all(|(s, known)| is_like(s, known));
        if !are_alike || !scenes.into_iter().zip(&mut all).all(|(own, (_, joining))| joining.add(own.part)) {
            return Err(other(format!(
                "part {number} is of other cells or walls than part {}: made by another build of the program, or on \
                 another kind of machine; do it again",
                first.unwrap_or(number)
            )));
        }
        first.get_or_insert(number);
    }
    Ok(Known(all.into_iter().map(|(print, joining)| (print, Arc::new(joining.joined()))).collect()))
}
