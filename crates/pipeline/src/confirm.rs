//! The fifth stage, from a search to options: measured again on other lattices, stripped and explained.

pub(crate) mod confirmed;
pub(crate) mod elsewhere;
pub(crate) mod explain;
pub(crate) mod found;
pub(crate) mod ideas;
pub(crate) mod nothing;
pub(crate) mod refined;
pub(crate) mod sound;
pub(crate) mod stripped;
pub(crate) mod withheld;

use crate::job::{Progress, Watch};
use crate::search::brief::Brief;
use crate::search::{Searched, TakeSoFar};
use enfilade_report::Error;
use found::{Found, found};

/// What a search found, and what is found without the moves that hide all else.
///
/// # Errors
/// [`Error::Stopped`], after `so_far` has had the best where that is to be kept; what `so_far` returns.
pub(crate) fn confirm(
    brief: &Brief<'_>,
    searched: &Searched<'_>,
    watch: &mut Watch<'_>,
    so_far: &mut TakeSoFar<'_>,
) -> Result<Found, Error> {
    let search = &searched.search;
    if searched.is_late {
        brief.study.hurry();
    }
    let others = watch.cancel.check().and_then(|()| {
        watch.progress(Progress { stage: "confirm".into(), ..searched.progress() });
        elsewhere::elsewhere(brief, &search.outcome(), watch.cancel)
    });
    if matches!(others, Err(Error::Stopped)) && watch.cancel.keeps_best() {
        so_far(search, searched.progress(), watch)?;
    }
    Ok(found(brief, search, &others?))
}
