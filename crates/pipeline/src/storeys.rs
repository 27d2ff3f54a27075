//! The other storeys of a building: each checked and measured by itself, in a folder of its own.

pub(crate) mod together;

use rayon::prelude::*;

use crate::job::Job;
use crate::measure::known::Forest;
use crate::measure::study::Study;
use crate::read;
use crate::storey::{analyse_storey, measure_storey};
use crate::understand::building;
use crate::understand::rooms::rooms_with_kinds;
use crate::understand::sensed::Sensed;
use crate::understand::understood;
use crate::understand::understood::Understood;
use crate::write::check_picture::check_picture;
use crate::write::show;
use enfilade_cad::{Opened, StoreyInfo};
use enfilade_config::Settings;
use enfilade_overlay::result::{BuildingEntry, Numbers, ProblemEntry, StoreyEntry};
use enfilade_report::{Cancel, Error, OutFile, Report, Severity};

/// Most storeys of one building that are measured.
pub const STOREYS_MAX: usize = 64;

/// Codes of what is left out of a storey, and of what was not joined to it.
const OF_ELEMENTS: [&str; 8] = [
    "stairs-none",
    "ifc-element",
    "ifc-other-element",
    "ifc-axis",
    "ifc-not-cut",
    "ifc-space",
    "gltf-mesh",
    "gltf-not-cut",
];

/// Of the storeys found those with walls, each with its folder (`storey-1` is the lowest) and the settings that read it; none
/// where the settings name one, or there is only one.
fn others(found: &[StoreyInfo], settings: &Settings) -> Vec<(StoreyInfo, String, Settings)> {
    if settings.storey.is_some() {
        return Vec::new();
    }
    let of = |(i, s): (usize, &StoreyInfo)| {
        let settings = settings.clone();
        // Whose places are known are not of all.
        let settings = if settings.of_storey.is_some() { settings.without_places() } else { settings };
        let mut own = Settings { storey: Some(enfilade_cad::storey_key(found, i)), ..settings };
        // Rooms are numbered on the storey that is read.
        own.reading.rooms.clear();
        (s.clone(), folder_of(i), own)
    };
    let walled = found.iter().enumerate().filter(|(_, s)| s.walls > 0);
    let out: Vec<_> = walled.map(of).take(STOREYS_MAX).collect();
    if out.len() < 2 { Vec::new() } else { out }
}

/// The storey that is read where none is named.
fn main_of(
    found: &[StoreyInfo],
    list: &[(StoreyInfo, String, Settings)],
    settings: &Settings,
) -> Option<usize> {
    let main = enfilade_cad::main_storey(found, read::read_options(settings).cut_m())?;
    let folder = folder_of(main);
    list.iter().position(|(_, own, _)| *own == folder)
}

fn folder_of(index: usize) -> String {
    format!("storey-{}", index + 1)
}

fn entry(storey: &StoreyInfo, base: &Understood, folder: &str, mean: Numbers) -> StoreyEntry {
    StoreyEntry {
        name: storey.name.clone(),
        building: storey.building.clone(),
        floor_m: storey.floor_m,
        folder: Some(folder.into()),
        walls: base.plan.walls.len() as u64,
        openings: [true, false].map(|d| building::count(&base.openings, d)).iter().sum(),
        columns: base.axes.columns() as u64,
        mean,
        ..StoreyEntry::default()
    }
}

/// What is said of a storey's elements; warnings of it go to the report on the whole building too.
fn of_elements(storey: &StoreyInfo, own: &Report, whole: &mut Report) -> Vec<ProblemEntry> {
    let told = || own.problems.iter().filter(|p| OF_ELEMENTS.contains(&p.code));
    for p in told().filter(|p| p.severity == Severity::Warning) {
        whole.warn(p.code, p.place.clone(), format!("storey {:?}: {}", storey.name, p.text));
    }
    told().map(ProblemEntry::from).collect()
}

fn failed(storey: &StoreyInfo, error: &Error) -> StoreyEntry {
    StoreyEntry {
        name: storey.name.clone(),
        building: storey.building.clone(),
        floor_m: storey.floor_m,
        problem: Some(error.to_string()),
        ..StoreyEntry::default()
    }
}

/// What a building has, and every storey where it has several; adds `storey-N/check.png` to `files`.
pub(crate) fn check(
    opened: &Opened<'_>,
    settings: &Settings,
    shown: &Understood,
    mut files: Option<&mut Vec<OutFile>>,
    report: &mut Report,
) -> (Option<BuildingEntry>, Vec<StoreyEntry>) {
    let (found, elements) = opened.building(&read::read_options(settings));
    let list = others(&found, settings);
    let main = main_of(&found, &list, settings);
    let others = list.iter().enumerate().filter(|(i, _)| Some(*i) != main).map(|(_, (_, _, own))| own);
    let options: Vec<_> = others.clone().map(read::read_options).collect();
    let drawings = opened.read_all(&options);
    let others: Vec<_> = others.zip(&drawings).collect();
    let is_drawn = files.is_some();
    let made = others.par_iter().map(|(own, (drawing, report))| {
        let mut report = report.clone();
        let drawing = drawing.as_ref().map_err(Clone::clone)?;
        let base = understood(drawing, own, &mut report)?;
        let picture = || {
            let sensed = Sensed::new(&base, own);
            check_picture(&base, &sensed, &rooms_with_kinds(&base, &sensed, own)?)
        };
        let png = is_drawn.then(picture).transpose()?;
        Ok((png, base, report))
    });
    let mut made = made.collect::<Vec<Result<_, Error>>>().into_iter();
    let mut out = Vec::new();
    for (i, (storey, folder, _)) in list.iter().enumerate() {
        if Some(i) == main {
            out.push(entry(storey, shown, ".", Numbers::default()));
            continue;
        }
        out.push(match made.next() {
            Some(Ok((png, base, own))) => {
                if let (Some(files), Some(png)) = (&mut files, png) {
                    files.push(OutFile::new(format!("{folder}/check.png"), png));
                }
                let problems = of_elements(storey, &own, report);
                StoreyEntry { problems, ..entry(storey, &base, folder, Numbers::default()) }
            }
            Some(Err(error)) => failed(storey, &error),
            None => break,
        });
    }
    (elements.map(building_entry), out)
}

fn building_entry(e: enfilade_cad::ifc::Elements) -> BuildingEntry {
    BuildingEntry {
        storeys: e.storeys,
        walls: e.walls,
        columns: e.columns,
        doors: e.doors,
        windows: e.windows,
        spaces: e.spaces,
    }
}

/// Studies of the storeys of a building beside the one that is shown, without a tree; of those that can be read.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn views(job: Job<'_>, shown: &Study, cancel: &Cancel) -> Result<Vec<Study>, Error> {
    let Job { input, settings } = job;
    let found = enfilade_cad::storeys(input.file(), &input.bytes, &read::read_options(settings));
    let list = others(&found, settings);
    let main = main_of(&found, &list, settings);
    let mut out = Vec::new();
    for (_, (_, _, own)) in list.iter().enumerate().filter(|(i, _)| Some(*i) != main) {
        cancel.check()?;
        let floors = shown.floors.as_ref().and_then(|f| f.on(own.storey.as_deref()?));
        match measure_storey(Job { input, settings: own }, (Forest::Nobody, floors), &mut || {}, cancel) {
            Ok((study, _)) => out.push(study),
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(_) => {}
        }
    }
    Ok(out)
}

/// Measures every storey of a building with several; adds the files of `analysis/` for each, `storey-N/…`.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn analyse(
    job: Job<'_>,
    (shown, forest): (&Study, Forest<'_>),
    files: &mut Vec<OutFile>,
    report: &mut Report,
    cancel: &Cancel,
) -> Result<Vec<StoreyEntry>, Error> {
    let Job { input, settings } = job;
    let found = enfilade_cad::storeys(input.file(), &input.bytes, &read::read_options(settings));
    let list = others(&found, settings);
    let main = main_of(&found, &list, settings);
    let mut out = Vec::new();
    for (i, (storey, folder, own)) in list.iter().enumerate() {
        cancel.check()?;
        if Some(i) == main {
            out.push(entry(storey, &shown.base, ".", show::mean_numbers(shown, &shown.initial)));
            continue;
        }
        let floors = shown.floors.as_ref().and_then(|f| f.on(own.storey.as_deref()?));
        let job = Job { input, settings: own };
        out.push(match analyse_storey(job, (forest, floors), &mut || {}, cancel) {
            Ok((outcome, study)) => {
                let inside =
                    |f: OutFile| OutFile { path: format!("{folder}/{}", f.path.display()).into(), ..f };
                files.extend(outcome.files.into_iter().map(inside));
                let problems = of_elements(storey, &outcome.report, report);
                let means = show::mean_numbers(&study, &study.initial);
                StoreyEntry { problems, ..entry(storey, &study.base, folder, means) }
            }
            Err(error @ Error::Stopped) => return Err(error),
            Err(error) => failed(storey, &error),
        });
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;
    use crate::read;
    use enfilade_config::Partial;

    /// A tower: one wall a storey.
    fn tower(storeys: usize) -> String {
        let mut data = String::from(
            "#1=IFCSIUNIT(*,.LENGTHUNIT.,$,.METRE.);\n#2=IFCUNITASSIGNMENT((#1));\n\
             #3=IFCCARTESIANPOINT((0.,0.,0.));\n#4=IFCAXIS2PLACEMENT3D(#3,$,$);\n\
             #6=IFCPROJECT('0000000000000000000001',$,'P',$,$,$,$,$,#2);\n#7=IFCLOCALPLACEMENT($,#4);\n",
        );
        for i in 0..storeys {
            let (s, id) = (100 + 10 * i, |k: usize| format!("00000000000000000{i:04}{k}"));
            let (a, b, c) = (id(1), id(2), id(3));
            let _ = write!(
                data,
                "#{s}=IFCBUILDINGSTOREY('{a}',$,'S{i}',$,$,#7,$,$,.ELEMENT.,{i}.);\n\
                 #{}=IFCWALL('{b}',$,'W',$,$,#7,$,$,$);\n\
                 #{}=IFCRELCONTAINEDINSPATIALSTRUCTURE('{c}',$,$,$,(#{}),#{s});\n",
                s + 1,
                s + 2,
                s + 1
            );
        }
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n{data}ENDSEC;\nEND-ISO-10303-21;\n"
        )
    }

    #[test]
    fn a_tower_has_its_lowest_storeys_measured() {
        let settings = Settings::new(Partial::default()).unwrap();
        let found =
            |n: usize| enfilade_cad::storeys("t.ifc", tower(n).as_bytes(), &read::read_options(&settings));
        let count = |n: usize| others(&found(n), &settings).len();
        assert_eq!((count(1), count(3), count(STOREYS_MAX + 2)), (0, 3, STOREYS_MAX));
    }
}
