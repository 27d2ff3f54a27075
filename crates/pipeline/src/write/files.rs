//! The pictures and drawings of a round.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::brief::told::plan_from_metres;
use crate::confirm::found::Found;
use crate::job::Job;
use crate::measure::study::Study;
use crate::read;
use crate::works::Listed;
use crate::write::heat_maps::{MapLook, heat_map};
use crate::write::made::Made;
use crate::write::maps::{self, Map};
use crate::write::round_result::gains_words;
use crate::write::show;
use crate::write::traces::{self, Traces};
use enfilade_cad::drawing::Addition;
use enfilade_config::{Measure, Overlay, PairName, Settings};
use enfilade_overlay::additions::heat_layer;
use enfilade_overlay::brief_layers::brief_additions;
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::measure::{CHANGE, sentence_case};
use enfilade_overlay::result::{Explanation, RoundResult};
use enfilade_overlay::words::{by_north, explained, note_lines};
use enfilade_overlay::works::works_additions;
use enfilade_overlay::{
    Palette, Scale, arrow_additions, convergence_png, diversity_png, heat_additions, moved_additions,
};
use enfilade_report::{Error, OutFile, Place};

/// Values of one map for the present layout and every member, with one scale for all.
struct Shown {
    pair: Option<PairName>,
    /// Part of a file's name.
    file: String,
    look: MapLook,
    /// None of a map of changes: the present layout changes nothing.
    initial: Option<Vec<f64>>,
    members: Vec<Vec<f64>>,
}

fn shown(settings: &Settings, study: &Study, made: &[&Made]) -> Vec<Shown> {
    let of = |map: Map| {
        let initial = maps::values(study, &study.initial, map, settings);
        let members: Vec<Vec<f64>> =
            made.iter().map(|m| maps::values(study, &m.worth, map, settings)).collect();
        let all = initial.iter().chain(members.iter().flatten()).copied();
        let scale = Scale::of(all.filter(|v| v.is_finite()));
        let look = MapLook { title: map.title(), unit: map.unit(), scale, palette: maps::palette(settings) };
        let change = change(settings, map, &initial, &members);
        let own = Shown { pair: map.pair, file: map.file(), look, initial: Some(initial), members };
        std::iter::once(own).chain(change)
    };
    maps::maps(study).into_iter().flat_map(of).collect()
}

/// What becomes better where, and what worse: of what is asked for and of what is seen.
fn change(settings: &Settings, map: Map, initial: &[f64], members: &[Vec<f64>]) -> Option<Shown> {
    let asked =
        settings.objectives.iter().find(|o| o.measure.measure == map.measure && o.measure.pair == map.pair);
    let is_more_better = asked.is_none_or(|o| o.is_max);
    let is_seen = map.measure == Measure::Degree && map.pair.is_none();
    if !map.measure.is_of_cells() || members.is_empty() || asked.is_none() && !is_seen {
        return None;
    }
    let less = |now: &Vec<f64>| now.iter().zip(initial).map(|(now, before)| now - before).collect();
    let members: Vec<Vec<f64>> = members.iter().map(less).collect();
    let look = MapLook {
        title: format!("Change of {}", map.title().to_lowercase()),
        unit: map.unit(),
        scale: Scale::of_changes(members.iter().flatten().copied()),
        palette: if is_more_better { Palette::Change } else { Palette::ChangeDown },
    };
    Some(Shown { pair: map.pair, file: map.file() + CHANGE, look, initial: None, members })
}

pub(crate) fn pictures(job: Job<'_>, study: &Study, made: &[&Made]) -> Result<Vec<OutFile>, Error> {
    let Job { input, settings } = job;
    let shown = shown(settings, study, made);
    let present = show::picture(&study.base);
    let picture = |m: &&Made| match &m.built {
        Some(built) => built.picture.clone(),
        None => traces::moved_picture(&study.base, &m.layout),
    };
    let moved: Vec<_> = made.iter().map(picture).collect();
    let jobs: Vec<(usize, usize)> =
        (0..shown.len()).flat_map(|s| (0..=made.len()).map(move |m| (s, m))).collect();
    let files = jobs.par_iter().map(|(s, m)| {
        let of = &shown[*s];
        let (name, picture, values, subtitle) = match m.checked_sub(1) {
            None => {
                let values = of.initial.as_ref()?;
                ("initial".to_string(), &present, values, format!("{}, as drawn", input.file()))
            }
            Some(i) => {
                let subtitle = format!("{}, {}", input.file(), made[i].title());
                (made[i].name.clone(), &moved[i], &of.members[i], subtitle)
            }
        };
        let png = heat_map(study, picture, (of.pair, values), &of.look, &subtitle);
        Some(png.map(|png| OutFile::new(format!("{name}-{}.png", of.file), png)))
    });
    files.collect::<Vec<_>>().into_iter().flatten().collect()
}

/// `initial.dxf` and the candidates: the drawing's own bytes with the moves and our layers; or, where these are to be
/// attached, without them, and beside each a drawing of its overlays in the same frame and unit.
pub(crate) fn drawings(
    job: Job<'_>,
    study: &Study,
    (made, works): (&[&Made], Option<&Listed>),
    result: &RoundResult,
) -> Result<Vec<OutFile>, Error> {
    let Job { input, settings } = job;
    let mut shown = shown(settings, study, made);
    // Layer names are short in old versions: two maps may come to the same.
    let layers: Vec<String> = shown.iter().map(|s| heat_layer(&s.file)).collect();
    let mut places = 0..;
    shown.retain(|_| places.next().is_some_and(|i: usize| !layers[..i].contains(&layers[i])));
    let bounds = show::picture(&study.base).bounds;
    let heat = |member: Option<usize>| -> Vec<Addition> {
        let of = |s: &Shown| {
            let values = member.map_or(s.initial.as_ref(), |i| s.members.get(i));
            let Some(values) = values else { return Vec::new() };
            let (cells, look) = (maps::cells(study, s.pair, values), &s.look);
            heat_additions(&heat_layer(&s.file), &cells, study.spacing_m, look.scale, look.palette)
        };
        shown.iter().flat_map(of).collect()
    };
    let to_plan = |p: [f64; 2]| plan_from_metres(&study.base, p);
    let jobs: Vec<Option<usize>> = std::iter::once(None).chain((0..made.len()).map(Some)).collect();
    let files = jobs.par_iter().map(|of| {
        let mut additions = heat(*of);
        let (name, edits) = match of {
            None => {
                additions.extend(works.into_iter().flat_map(|w| works_additions(&w.walls)));
                additions.extend(brief_additions(&result.brief, &to_plan, bounds));
                ("initial".to_string(), Vec::new())
            }
            Some(i) => {
                let m = &made[*i];
                let traces = traces::of(&study.base, &m.layout);
                let candidate = result.candidates.get(*i);
                let none = Explanation::default();
                let explanation = candidate.map_or(&none, |c| &c.explanation);
                let best = result.best.as_ref().map(|b| (&b.mean, &b.gain));
                let Some((mean, gain)) = candidate.map(|c| (&c.mean, &c.gain)).or(best) else {
                    return Err(Error::usage("best", Place::file(input.file()), "no best layout".to_owned()));
                };
                let mut lines = vec![format!("{} of {}", sentence_case(&m.title()), input.file())];
                let gains = gains_words(study, &result.initial.mean, mean, gain);
                lines.extend(match &m.built {
                    Some(built) => {
                        let moves = by_north(&result.moves, result.input.north_deg);
                        let moved = Some(built.moves_words(&moves)).filter(|w| !w.is_empty());
                        built.note_lines(&gains).into_iter().chain(moved).collect()
                    }
                    None => note_lines(
                        &by_north(&result.moves, result.input.north_deg),
                        &m.member.parameters,
                        &gains,
                        &explanation.parts,
                    ),
                });
                lines.extend(explained(explanation));
                let Traces { now, before, arrows } = &traces;
                additions.extend(moved_additions(now, before, &lines, bounds));
                additions.extend(arrow_additions(arrows, bounds));
                additions.extend(brief_additions(&m.brief, &to_plan, bounds));
                (m.name.clone(), m.all_edits())
            }
        };
        let mut additions = show::to_drawing_units(&study.base.plan, additions);
        let is_apart = settings.overlay == Overlay::Attach;
        let apart = is_apart.then(|| std::mem::take(&mut additions));
        // What was demolished lies in the drawing's own units already.
        let built = of.and_then(|i| made[i].built.as_ref());
        additions.extend(built.into_iter().flat_map(|b| b.additions.iter().cloned()));
        let options = read::read_options(settings);
        let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &edits, &additions)?;
        let drawing = OutFile::new(format!("{name}.{}", study.base.plan.format.name()), bytes);
        let notes =
            apart.map(|notes| enfilade_cad::dxf::sheet(study.base.plan.unit.unit, &notes)).transpose()?;
        let notes = notes.map(|bytes| OutFile::new(format!("{name}-notes.dxf"), bytes));
        Ok([Some(drawing), notes].into_iter().flatten().collect::<Vec<_>>())
    });
    let files: Vec<Vec<OutFile>> = files.collect::<Vec<_>>().into_iter().collect::<Result<_, Error>>()?;
    Ok(files.into_iter().flatten().collect())
}

/// What scenes name as lying beside them, to lie beside these too; what is named as a file of a round is not copied.
pub(crate) fn lying_beside(settings: &Settings, files: &[OutFile]) -> Vec<OutFile> {
    let folded = |name: &str| name.to_lowercase();
    let ours: BTreeSet<String> = files.iter().map(|f| folded(&f.path.to_string_lossy())).collect();
    let named = settings.beside.buffers.iter().chain(&settings.beside.pictures);
    let free = named.filter(|(name, _)| !ours.contains(&folded(name)));
    free.map(|(name, data)| OutFile::new(name.as_str(), data.to_vec())).collect()
}

pub(crate) fn convergence(found: Option<&Found>) -> Result<Vec<u8>, Error> {
    convergence_png(found.map_or(&[], |f| &f.series), DEFAULT_SIDE_PX)
}

pub(crate) fn diversity(study: &Study, made: &[Made]) -> Result<Vec<u8>, Error> {
    let strokes = |m: &Made| match &m.built {
        Some(built) => built.strokes.clone(),
        None => traces::of(&study.base, &m.layout).now,
    };
    let strokes: Vec<_> = made.iter().map(strokes).collect();
    let labels: Vec<String> = (1..=made.len()).map(|i| format!("option {i}")).collect();
    diversity_png(&show::picture(&study.base), &strokes, &labels, DEFAULT_SIDE_PX)
}
