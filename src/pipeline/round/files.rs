//! The pictures and drawings of a round.

use std::collections::BTreeSet;

use super::super::show::{self, Map};
use super::super::study::{self, Study};
use super::super::{Input, heat_map, rayon_map};
use super::{Found, Made, told};
use crate::config::Settings;
use crate::formats;
use crate::overlay::additions::heat_layer;
use crate::overlay::heat_map::DEFAULT_SIDE_PX;
use crate::overlay::result::RoundResult;
use crate::overlay::words::{by_north, explained, note_lines};
use crate::overlay::{Scale, convergence_png, diversity_png, heat_additions, moved_additions};
use crate::plan::drawing::Addition;
use crate::report::{Error, OutFile};

/// Values of every shown measure for the present layout and every member, with one scale a measure.
struct Shown {
    map: Map,
    scale: Scale,
    initial: Vec<f64>,
    members: Vec<Vec<f64>>,
}

fn shown(settings: &Settings, study: &Study, made: &[Made]) -> Vec<Shown> {
    let of = |map: Map| {
        let initial = show::values(study, &study.initial, map, settings);
        let members: Vec<Vec<f64>> =
            made.iter().map(|m| show::values(study, &m.worth, map, settings)).collect();
        let all = initial.iter().chain(members.iter().flatten()).copied();
        Shown { map, scale: Scale::of(all.filter(|v| v.is_finite())), initial, members }
    };
    show::maps(study).into_iter().map(of).collect()
}

pub(super) fn pictures(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    made: &[Made],
) -> Result<Vec<OutFile>, Error> {
    let shown = shown(settings, study, made);
    let present = show::picture(&study.base);
    let moved: Vec<_> = made.iter().map(|m| show::moved_picture(&study.base, &m.layout)).collect();
    let jobs: Vec<(usize, usize)> =
        (0..shown.len()).flat_map(|s| (0..=made.len()).map(move |m| (s, m))).collect();
    let files = rayon_map(&jobs, |(s, m)| {
        let of = &shown[*s];
        let (name, picture, values, subtitle) = match m.checked_sub(1) {
            None => ("initial".to_string(), &present, &of.initial, format!("{}, as drawn", input.file())),
            Some(i) => {
                let name = made[i].name.clone();
                let subtitle = format!("{}, option {m}", input.file());
                (name, &moved[i], &of.members[i], subtitle)
            }
        };
        let png = heat_map(study, settings, picture, values, of.map, of.scale, &subtitle)?;
        Ok(OutFile::new(format!("{name}-{}.png", of.map.file()), png))
    });
    files.into_iter().collect()
}

/// `initial.dxf` and the candidates: the drawing's own bytes with the moves and our layers.
pub(super) fn drawings(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    made: &[Made],
    result: &RoundResult,
) -> Result<Vec<OutFile>, Error> {
    let mut shown = shown(settings, study, made);
    // Layer names are short in old versions: two maps may come to the same.
    let layers: Vec<String> = shown.iter().map(|s| heat_layer(&s.map.file())).collect();
    let mut places = 0..;
    shown.retain(|_| places.next().is_some_and(|i: usize| !layers[..i].contains(&layers[i])));
    let bounds = show::picture(&study.base).bounds;
    let heat = |member: Option<usize>| -> Vec<Addition> {
        let of = |s: &Shown| {
            let values = member.map_or(&s.initial, |i| &s.members[i]);
            let layer = heat_layer(&s.map.file());
            heat_additions(
                &layer,
                &show::cells(study, s.map.pair, values),
                study.spacing_m,
                s.scale,
                show::palette(settings),
            )
        };
        shown.iter().flat_map(of).collect()
    };
    let jobs: Vec<Option<usize>> = std::iter::once(None).chain((0..made.len()).map(Some)).collect();
    rayon_map(&jobs, |job| {
        let mut additions = heat(*job);
        let (name, edits) = match job {
            None => ("initial".to_string(), Vec::new()),
            Some(i) => {
                let m = &made[*i];
                let (now, before) = show::moved_strokes(&study.base, &m.layout);
                let candidate = &result.candidates[*i];
                let mut lines = vec![format!("Option {} of {}", i + 1, input.file())];
                lines.extend(note_lines(
                    &by_north(&result.moves, result.input.north_deg),
                    &m.member.parameters,
                    &told(study, &result.initial.mean),
                    &told(study, &candidate.mean),
                    &candidate.explanation.parts,
                ));
                lines.extend(explained(&candidate.explanation));
                additions.extend(moved_additions(&now, &before, &lines, bounds));
                (m.name.clone(), m.edits.clone())
            }
        };
        let additions = show::to_drawing_units(&study.base.plan, additions);
        let options = study::read_options(settings);
        let bytes = formats::patch(input.file(), &input.bytes, &options, &edits, &additions)?;
        Ok(OutFile::new(format!("{name}.{}", study.base.plan.format.name()), bytes))
    })
    .into_iter()
    .collect()
}

/// What scenes name as lying beside them, to lie beside these too; what is named as a file of a round is not copied.
pub(super) fn lying_beside(settings: &Settings, files: &[OutFile]) -> Vec<OutFile> {
    let folded = |name: &str| name.to_lowercase();
    let ours: BTreeSet<String> = files.iter().map(|f| folded(&f.path.to_string_lossy())).collect();
    let named = settings.beside.buffers.iter().chain(&settings.beside.pictures);
    let free = named.filter(|(name, _)| !ours.contains(&folded(name)));
    free.map(|(name, data)| OutFile::new(name.as_str(), data.to_vec())).collect()
}

pub(super) fn convergence(found: Option<&Found>) -> Result<Vec<u8>, Error> {
    convergence_png(found.map_or(&[], |f| &f.series), DEFAULT_SIDE_PX)
}

pub(super) fn diversity(study: &Study, made: &[Made]) -> Result<Vec<u8>, Error> {
    let strokes: Vec<_> = made.iter().map(|m| show::moved_strokes(&study.base, &m.layout).0).collect();
    let labels: Vec<String> = (1..=made.len()).map(|i| format!("option {i}")).collect();
    diversity_png(&show::picture(&study.base), &strokes, &labels, DEFAULT_SIDE_PX)
}
