//! How far apart options should stand.

use crate::measure::study::Study;
use enfilade_config::Settings;
use enfilade_moves::Parameter;
use enfilade_moves::control::LIKE_SHARE;

/// How far apart options should stand, as a share of √n: where all stay near one, or few walls may move at once, the
/// same share of the room there is.
pub(crate) fn distance(study: &Study, settings: &Settings) -> f64 {
    let near = if settings.like.is_some() { 2.0 * LIKE_SHARE } else { 1.0 };
    let few = settings.most_moves.map_or(1.0, |most| share_of_two(study, most));
    settings.distance * near * few
}

/// The largest distance of two layouts that move at most so many groups each, as a share of the largest of all: in a
/// group that both move they may stand at opposite ends of its ranges, in others one of them stands as drawn.
pub(crate) fn share_of_two(study: &Study, most: usize) -> f64 {
    let parameters = &study.base.moves.parameters;
    // Largest squares with so many of the moves of both used up.
    let mut best = vec![0.0_f64; 2 * most.min(parameters.len()) + 1];
    for of in parameters.chunk_by(|a, b| a.group_name == b.group_name) {
        let from_drawn = |p: &Parameter| {
            let (identity, range) = (p.clause.kind.identity(), p.clause.upper - p.clause.lower);
            let most = (p.clause.upper - identity).max(identity - p.clause.lower);
            if range > 0.0 { (most / range).powi(2) } else { 0.0 }
        };
        let (both, one) = (of.len() as f64, of.iter().map(from_drawn).sum::<f64>());
        for used in (1..best.len()).rev() {
            let with_both = if used > 1 { best[used - 2] + both } else { 0.0 };
            best[used] = best[used].max(best[used - 1] + one).max(with_both);
        }
    }
    (best.last().copied().unwrap_or(0.0) / parameters.len().max(1) as f64).sqrt().min(1.0)
}
