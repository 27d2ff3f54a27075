//! The other storeys of a building: each checked and measured by itself, in a folder of its own.

use std::collections::BTreeSet;

use super::study::Understood;
use super::{Input, Study, analyse_storey, check_picture, show, study};
use crate::config::Settings;
use crate::formats::{self, StoreyInfo};
use crate::overlay::result::{Numbers, StoreyEntry};
use crate::report::{Cancel, Error, OutFile, Report};

/// Most storeys of one building that are measured.
pub const STOREYS_MAX: usize = 64;

/// Storeys with walls, each with its folder (`storey-1` is the lowest) and the settings that read it; none
/// where the settings name one, or there is only one.
fn others(input: &Input<'_>, settings: &Settings) -> Vec<(StoreyInfo, String, Settings)> {
    if settings.storey.is_some() {
        return Vec::new();
    }
    let found = formats::storeys(input.file(), &input.bytes, &study::read_options(settings));
    let of = |(i, s): (usize, StoreyInfo)| {
        let own = Settings { storey: Some(s.name.clone()), ..settings.clone() };
        (s, format!("storey-{}", i + 1), own)
    };
    // Storeys of one name are one: `--storey` takes the lowest.
    let mut names = BTreeSet::new();
    let walled = found.into_iter().enumerate().filter(|(_, s)| s.walls > 0 && names.insert(s.name.clone()));
    let out: Vec<_> = walled.map(of).take(STOREYS_MAX).collect();
    if out.len() < 2 { Vec::new() } else { out }
}

/// The storey that is read where none is named.
fn main_of(list: &[(StoreyInfo, String, Settings)]) -> Option<usize> {
    (0..list.len()).rev().max_by_key(|i| list[*i].0.walls)
}

fn entry(storey: &StoreyInfo, base: &Understood, folder: &str, mean: Numbers) -> StoreyEntry {
    StoreyEntry {
        name: storey.name.clone(),
        floor_m: storey.floor_m,
        folder: Some(folder.into()),
        walls: base.plan.walls.len() as u64,
        openings: base.openings,
        columns: base.plan.walls.iter().filter(|w| w.is_solid).count() as u64,
        mean,
        problem: None,
    }
}

fn failed(storey: &StoreyInfo, error: &Error) -> StoreyEntry {
    StoreyEntry {
        name: storey.name.clone(),
        floor_m: storey.floor_m,
        problem: Some(error.to_string()),
        ..StoreyEntry::default()
    }
}

/// Every storey of a building with several; adds `storey-N/check.png`.
pub(super) fn check(
    input: &Input<'_>,
    settings: &Settings,
    shown: &Understood,
    files: &mut Vec<OutFile>,
) -> Vec<StoreyEntry> {
    let list = others(input, settings);
    let main = main_of(&list);
    let mut out = Vec::new();
    for (i, (storey, folder, own)) in list.iter().enumerate() {
        if Some(i) == main {
            out.push(entry(storey, shown, ".", Numbers::default()));
            continue;
        }
        let mut report = Report::default();
        let read = study::read(input.file(), &input.bytes, own, &mut report);
        let made = read.and_then(|base| {
            let result = show::check(&base, &report);
            Ok((check_picture(&base, &result)?, base))
        });
        out.push(match made {
            Ok((png, base)) => {
                files.push(OutFile::new(format!("{folder}/check.png"), png));
                entry(storey, &base, folder, Numbers::default())
            }
            Err(error) => failed(storey, &error),
        });
    }
    out
}

/// Measures every storey of a building with several; adds the files of `analysis/` for each, `storey-N/…`.
///
/// # Errors
/// [`Error::Stopped`].
pub(super) fn analyse(
    input: &Input<'_>,
    settings: &Settings,
    shown: &Study,
    files: &mut Vec<OutFile>,
    cancel: &Cancel,
) -> Result<Vec<StoreyEntry>, Error> {
    let list = others(input, settings);
    let main = main_of(&list);
    let mut out = Vec::new();
    for (i, (storey, folder, own)) in list.iter().enumerate() {
        cancel.check()?;
        if Some(i) == main {
            out.push(entry(storey, &shown.base, ".", show::mean_numbers(&shown.initial)));
            continue;
        }
        out.push(match analyse_storey(input, own, cancel) {
            Ok((outcome, study)) => {
                let inside =
                    |f: OutFile| OutFile { path: format!("{folder}/{}", f.path.display()).into(), ..f };
                files.extend(outcome.files.into_iter().map(inside));
                entry(storey, &study.base, folder, show::mean_numbers(&study.initial))
            }
            Err(error @ Error::Stopped) => return Err(error),
            Err(error) => failed(storey, &error),
        });
    }
    Ok(out)
}
