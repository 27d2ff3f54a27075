//! Whether a layout can be offered: what only the file and all its doors say.

use crate::job::Job;
use crate::read;
use crate::search::brief::Brief;
use crate::understand::edits::{edits_of, tied};
use crate::understand::faults::is_gated;
use enfilade_moves::narrowed::Doors;

/// Whether no joint with a wall that the plan does not show opens, and no door becomes narrower. What the search holds
/// every layout to is not asked again.
pub(crate) fn is_sound(brief: &Brief<'_>, parameters: &[f64]) -> bool {
    let (base, settings, input) = (&brief.study.base, brief.settings, brief.input);
    if !is_gated(base, settings) {
        return true;
    }
    let layout = base.moves.apply(&base.plan, &base.graph, parameters);
    if !settings.allow.narrow_ways && !Doors::new(&base.plan, &base.axes).narrowed(&layout).is_empty() {
        return false;
    }
    if settings.allow.open_joints {
        return true;
    }
    let mut edits = edits_of(base, &layout);
    let Ok(tied) = tied(Job { input, settings }, base, &edits) else { return true };
    edits.extend(tied.following.into_iter().map(|f| f.edit));
    // What cannot be written is told when it is.
    let changes = enfilade_cad::changes(input.file(), &input.bytes, &read::read_options(settings), &edits);
    changes.map_or(true, |c| c.unseen.is_empty())
}
