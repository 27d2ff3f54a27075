//! Spaces and zones that `--query` names, and the storey on which they are.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::job::Input;
use crate::read::read_options;
use crate::read::storey::{storey_read, without_others};
use enfilade_cad::Opened;
use enfilade_cad::drawing::Drawing;
pub(crate) use enfilade_cad::ifc::SPACE_LAYER;
use enfilade_cad::ifc::ZONE_LAYER;
use enfilade_cad::names::{Found, Pattern};
use enfilade_config::Settings;
use enfilade_report::{Error, Place, Report};

/// What `--query` may name: the word before the name, what is meant, and the layer of the names.
const NAMED: [(&str, &str, &str); 2] = [("space:", "space", SPACE_LAYER), ("zone:", "zone", ZONE_LAYER)];

/// What `--query` asks for.
pub(crate) struct Asked {
    /// Names that are meant.
    pub(crate) names: Pattern,
    /// A space or a zone, in words.
    pub(crate) what: &'static str,
    /// The layer of their names.
    pub(crate) layer: &'static str,
}

impl Asked {
    pub(crate) fn new(query: &str, file: &str) -> Result<Self, Error> {
        let usage = |text: String| Error::usage("query", Place::file(file), text);
        let asked =
            NAMED.iter().find_map(|(word, what, layer)| Some((query.strip_prefix(word)?, what, layer)));
        let Some((pattern, what, layer)) = asked else {
            return Err(usage(format!(
                "--query {query:?}: expected space:NAME or zone:NAME, * and ? may stand in NAME; nothing was done"
            )));
        };
        let names = match pattern.contains(r"\X") {
            // As somebody copies a name out of a STEP file.
            true => Pattern::new(&enfilade_cad::ifc::decoded(pattern)),
            false => Pattern::new(pattern),
        };
        let names = names.map_err(|e| usage(format!("--query {query:?}: {e}; nothing was done")))?;
        Ok(Self { names, what, layer })
    }

    /// What of a drawing is meant, its places among the names there.
    pub(crate) fn found(&self, drawing: &Drawing) -> Found {
        let named = drawing.texts.iter().filter(|t| t.layer == self.layer);
        let all: Vec<Vec<&str>> = named.map(|t| t.text.lines().collect()).collect();
        Found::of(&all, &self.names)
    }

    /// Records of the spaces that are meant.
    pub(crate) fn hits(&self, drawing: &Drawing) -> Vec<usize> {
        let hits = self.found(drawing).hits;
        let named: Vec<_> = drawing.texts.iter().filter(|t| t.layer == self.layer).collect();
        hits.into_iter().map(|i| named[i].source.record).collect()
    }

    /// Why none is meant though several are called so, where that is so.
    pub(crate) fn several(&self, rivals: &[String]) -> Option<String> {
        let what = self.what;
        (rivals.len() > 1).then(|| {
            format!(
                "found several {what}s that are so called without accents and blanks ({}), expected one; name it as it stands there",
                enfilade_cad::quoted(rivals)
            )
        })
    }

    /// Names that there are, each once.
    pub(crate) fn names(&self, drawing: &Drawing) -> String {
        let named = drawing.texts.iter().filter(|t| t.layer == self.layer);
        let mut names: Vec<String> = named.map(|t| t.text.replace('\n', " / ")).collect();
        let mut seen = BTreeSet::new();
        names.retain(|n| seen.insert(n.clone()));
        if names.is_empty() { "none".into() } else { names.join(", ") }
    }
}

/// The settings as they hold for the storey that is read: without what they say of places on another one, and with the
/// storey on which the space that `--query` names is.
///
/// # Errors
/// As [`on_storey_of_query`].
pub(crate) fn for_its_storey<'s>(
    input: &Input<'_>,
    settings: &'s Settings,
) -> Result<Cow<'s, Settings>, Error> {
    let own = without_others(input, settings);
    Ok(on_storey_of_query(input, &own)?.map_or(own, Cow::Owned))
}

/// The settings with the storey on which the space that `--query` names is, where nobody names one and the one with most
/// walls has no such space; none where they hold as they are.
///
/// # Errors
/// [`Error::Usage`] where a storey is named and the space is on another, or on none of several.
fn on_storey_of_query(input: &Input<'_>, settings: &Settings) -> Result<Option<Settings>, Error> {
    let same = Ok(None);
    let Some(query) = &settings.query else { return same };
    let asked = Asked::new(query, input.file())?;
    let Ok(opened) = Opened::new(input.file(), &input.bytes) else { return same };
    let options = read_options(settings);
    let storeys = opened.building(&options).0;
    let Some(own) = storey_read(&storeys, settings).filter(|_| storeys.len() > 1) else { return same };
    let key = |i: usize| enfilade_cad::storey_key(&storeys, i);
    let of = |i: usize| enfilade_cad::ReadOptions { storey: Some(key(i)), ..options.clone() };
    let found = |(drawing, _): &(Result<Drawing, Error>, Report)| {
        drawing.as_ref().map_or_else(|_| Found::default(), |d| asked.found(d))
    };
    let here = opened.read_all(&[of(own)]).first().map(found).unwrap_or_default();
    if !here.hits.is_empty() && (!here.is_bare || settings.storey.is_some()) {
        return same;
    }
    let read = opened.read_all(&(0..storeys.len()).map(of).collect::<Vec<_>>());
    let all: Vec<Found> = read.iter().map(found).collect();
    let is_same = |f: &&Found| !f.hits.is_empty() && !f.is_bare;
    let is_elsewhere = all.iter().any(|f| is_same(&f));
    // The same name on another storey stands before one that is only like it here.
    if !is_elsewhere && (!here.hits.is_empty() || !here.rivals.is_empty()) {
        return same;
    }
    let position = all.iter().position(|f| if is_elsewhere { is_same(&f) } else { !f.hits.is_empty() });
    let (what, here) = (asked.what, key(own));
    let usage = |text: String| Error::usage("query", Place::file(input.file()), text + "; nothing was done");
    let Some(other) = position.map(key) else {
        if let Some(why) = all.iter().find_map(|f| asked.several(&f.rivals)) {
            return Err(usage(format!("--query {query:?}: {why}")));
        }
        let names = read.iter().enumerate().filter_map(|(i, (drawing, _))| {
            Some(format!("on \"{}\": {}", key(i), asked.names(drawing.as_ref().ok()?)))
        });
        let names = names.collect::<Vec<_>>().join("; ");
        return Err(usage(format!("--query {query:?}: no such {what}, {what}s present {names}")));
    };
    if settings.storey.is_some() {
        return Err(usage(format!(
            "--query {query:?}: no such {what} on storey \"{here}\", it is on \"{other}\": --storey \"{other}\""
        )));
    }
    let why = format!(
        "--query {query:?} names a {what} of storey \"{other}\", which is taken; \"{here}\" has more walls and no such {what}"
    );
    Ok(Some(Settings { storey: Some(other.clone()), storey_taken: Some(why), ..settings.clone() }))
}
