//! Which storey is read, and what the settings say of others.

use std::borrow::Cow;

use super::read_options;
use crate::job::Input;
use enfilade_cad::StoreyInfo;
use enfilade_config::Settings;

/// Which of the storeys of a building the settings take: the one that they name, else the one with most walls; none of
/// none, or of another name.
pub(crate) fn storey_read(found: &[StoreyInfo], settings: &Settings) -> Option<usize> {
    match &settings.storey {
        Some(name) => named(found, name),
        None => enfilade_cad::main_storey(found, read_options(settings).cut_m()),
    }
}

fn named(found: &[StoreyInfo], name: &str) -> Option<usize> {
    enfilade_cad::storey_at(found.iter().map(|s| s.name.as_str()), name)
}

/// How `--storey` names the storey that is read, of several, so that what is said of its places is not taken for others.
pub(crate) fn key_read(input: &Input<'_>, settings: &Settings) -> Option<String> {
    let found = enfilade_cad::storeys(input.file(), &input.bytes, &read_options(settings));
    let own = storey_read(&found, settings).filter(|_| found.len() > 1)?;
    Some(enfilade_cad::storey_key(&found, own))
}

/// The settings without what they say of places on another storey than the one that is read.
pub(super) fn without_others<'s>(input: &Input<'_>, settings: &'s Settings) -> Cow<'s, Settings> {
    let same = Cow::Borrowed(settings);
    let Some(of) = &settings.of_storey else { return same };
    let found = enfilade_cad::storeys(input.file(), &input.bytes, &read_options(settings));
    let (Some(theirs), Some(ours)) = (named(&found, of), storey_read(&found, settings)) else { return same };
    if theirs == ours {
        return same;
    }
    let [theirs, ours] = [theirs, ours].map(|i| enfilade_cad::storey_key(&found, i));
    let left = format!(
        "the settings beside the drawing are of storey {theirs:?}: their moves, regions, works, pins and points are not used \
         on {ours:?}"
    );
    Cow::Owned(Settings { of_storey: None, tables_left: Some(left), ..settings.clone().without_places() })
}
