//! How far apart the options of a round stand, and how alike they are.

use crate::confirm::ideas::Experience;
use crate::measure::study::Study;
use crate::write::made::Made;
use enfilade_overlay::result::Diversity;
use enfilade_search::normalised_distance;

/// How alike the options are to the people in them: the median correlation of their maps of change.
pub(crate) fn likeness(study: &Study, made: &[Made]) -> Option<f64> {
    let maps: Vec<Experience> = made.iter().map(|m| Experience::of(study, &m.worth)).collect();
    let after = |i: usize| maps[i + 1..].iter().map(move |b| (i, b));
    let mut all: Vec<f64> = (0..maps.len()).flat_map(after).map(|(i, b)| maps[i].likeness(b)).collect();
    all.sort_by(f64::total_cmp);
    let (low, high) = (all.get((all.len().max(1) - 1) / 2)?, all.get(all.len() / 2)?);
    Some((low + high) / 2.0)
}

/// How far apart the options stand, every pair once.
pub(crate) fn pairs(study: &Study, made: &[Made]) -> Vec<([usize; 2], f64)> {
    let bounds = study.base.moves.bounds();
    let apart = |i: usize, j: usize| {
        normalised_distance(&bounds, &made[i].member.parameters, &made[j].member.parameters)
    };
    // Works have no parameters by which they could stand apart.
    let moving: Vec<usize> = (0..made.len()).filter(|i| made[*i].built.is_none()).collect();
    let after = |(k, i): (usize, &usize)| moving[k + 1..].iter().map(|j| [*i, *j]).collect::<Vec<_>>();
    moving.iter().enumerate().flat_map(after).map(|[i, j]| ([i, j], apart(i, j))).collect()
}

pub(crate) fn distances(study: &Study, made: &[Made]) -> Diversity {
    let all: Vec<f64> = pairs(study, made).into_iter().map(|(_, apart)| apart).collect();
    let min_distance = all.iter().copied().reduce(f64::min);
    let mean_distance = (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64);
    Diversity { min_distance, mean_distance, likeness: None }
}

/// The two options most alike, and how far apart they stand.
pub(crate) fn nearest(study: &Study, made: &[Made]) -> Option<([usize; 2], f64)> {
    pairs(study, made).into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}
