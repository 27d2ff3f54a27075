//! Which entities are the walls: layers by name and geometry, the user's word, one view of the sheet.

use std::collections::{BTreeMap, BTreeSet};

use super::far_off::far_off;
use super::hidden::Hidden;
use super::reading::corrections::{Said, with_walls, without_others};
use super::reading::{Reading, section};
use super::views::{MarkKind, STRAY, Sheet, SheetMark, View, split, strays};
use super::{LayerUse, PlanOptions, dots, view_box};
use enfilade_cad::drawing::{Drawing, Entity, Format};
use enfilade_cad::layers::WallLayers;
use enfilade_cad::own_layers;
use enfilade_cad::roles::{Role, role_by_name};
use enfilade_report::{Error, Place, Report, counted};

/// The walls of all views, and what became of the layers.
pub(super) struct Chosen {
    /// Indices of [`Drawing::entities`], ascending.
    pub walls: Vec<usize>,
    /// What became of every layer.
    pub layers: Vec<LayerUse>,
}

/// Why a layer is taken that no name says to be of walls.
const ASSUMED: &str = "no layer shown is named after walls and this is the only one with lines";

/// Of a building the records on every layer: an element may show several outlines there, and its name.
fn elements(drawing: &Drawing) -> BTreeMap<&str, BTreeSet<usize>> {
    let shapes = drawing.entities.iter().map(|e| (&e.layer, e.source.record));
    let texts = drawing.texts.iter().map(|t| (&t.layer, t.source.record));
    let mut out: BTreeMap<&str, BTreeSet<usize>> = BTreeMap::new();
    for (layer, record) in shapes.chain(texts).filter(|_| drawing.format != Format::Dxf) {
        out.entry(layer).or_default().insert(record);
    }
    out
}

/// Chooses the walls.
///
/// # Errors
/// [`Error::Usage`] for a layer pattern that cannot be read.
pub(super) fn choose_walls(
    drawing: &Drawing,
    (options, said): (&PlanOptions, &Said),
    report: &mut Report,
) -> Result<Chosen, Error> {
    let by_name = match options.corrections.as_drawn && options.wall_layers.is_empty() {
        true => WallLayers::new(&["*".to_owned()])?,
        false => WallLayers::new(&options.wall_layers)?,
    };
    let by_name = if drawing.format == Format::Dxf { by_name } else { by_name.of_building() };
    let hidden = Hidden::new(drawing);
    let counts = counts(drawing);
    let elements = elements(drawing);
    let only = only_layer(&counts, &by_name, &hidden).filter(|_| !lacks_a_file(report));
    let mut layers: Vec<LayerUse> = counts
        .iter()
        .map(|(name, (shapes, texts))| {
            let (role, why) = layer_use(name, options, &by_name, &hidden, only);
            let entities = elements.get(name).map_or(shapes + texts, BTreeSet::len);
            LayerUse { name: (*name).to_string(), entities, role, why }
        })
        .collect();
    say_corrected(drawing, said, &mut layers);
    if let Some(picked) = &options.picked {
        let all: Vec<usize> = (0..drawing.entities.len())
            .filter(|i| !own_layers::is_own(&drawing.entities[*i].layer))
            .collect();
        let walls = picked.iter().filter_map(|k| all.get(*k).copied()).collect();
        return Ok(Chosen { walls, layers });
    }
    let is_taken = |l: &&LayerUse| l.role == "wall" || l.role == "low" && options.is_knee_level;
    let taken: BTreeSet<&str> = layers.iter().filter(is_taken).map(|l| l.name.as_str()).collect();
    let mut walls: Vec<usize> = (0..drawing.entities.len())
        .filter(|i| {
            let e = &drawing.entities[*i];
            taken.contains(e.layer.as_str()) && !hidden.entity(e)
        })
        .collect();
    state_hidden(drawing, &layers, only, report);
    correct(drawing, said, &mut walls);
    Ok(Chosen { walls, layers })
}

/// Adds to the layers how many of their entities the user calls what.
fn say_corrected(drawing: &Drawing, said: &Said, layers: &mut [LayerUse]) {
    let mut counts: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (i, role) in said {
        let what = if *role == Role::Unknown { "no walls" } else { role.words() };
        *counts.entry((&drawing.entities[*i].layer, what)).or_default() += 1;
    }
    for ((layer, what), n) in counts {
        layers
            .iter_mut()
            .filter(|l| l.name == layer)
            .for_each(|l| l.why += &format!("; corrected: {n} {what}"));
    }
}

/// Makes `walls` (ascending) what the user says, as far as it is shown and has a size.
pub(super) fn correct(drawing: &Drawing, said: &Said, walls: &mut Vec<usize>) {
    let hidden = Hidden::new(drawing);
    without_others(said, walls);
    with_walls(said, walls, |i| !hidden.entity(&drawing.entities[i]));
    walls.retain(|i| !dots::is_dot(&drawing.entities[*i].shape));
}

/// Entities by their indices.
pub(super) fn entities<'d>(drawing: &'d Drawing, indices: &[usize]) -> Vec<&'d Entity> {
    indices.iter().map(|i| &drawing.entities[*i]).collect()
}

/// What tells the unit before walls are known: all that is shown, unless the walls were chosen for us.
pub(super) fn for_size(drawing: &Drawing, options: &PlanOptions, chosen: &Chosen) -> Vec<usize> {
    if drawing.format != Format::Dxf || !options.is_our_choice() {
        return chosen.walls.clone();
    }
    let (hidden, below) = (Hidden::new(drawing), section::seen_below(drawing));
    let is_shown = |i: &usize| {
        let e = &drawing.entities[*i];
        !own_layers::is_own(&e.layer) && !hidden.entity(e) && below.binary_search(i).is_err()
    };
    (0..drawing.entities.len()).filter(is_shown).collect()
}

/// The walls by what everything was taken for, unless the user or an earlier reading chose them; where none was found,
/// those by name stay.
pub(super) fn take_read(drawing: &Drawing, options: &PlanOptions, reading: &Reading, chosen: &mut Chosen) {
    if drawing.format != Format::Dxf || !options.is_our_choice() {
        return;
    }
    let hidden = Hidden::new(drawing);
    let is_wall = |i: &usize| {
        let e = &drawing.entities[*i];
        let stops = match reading.role(*i) {
            role if role.stops_sight() => true,
            Role::LowWall => options.is_knee_level,
            _ => false,
        };
        stops && !own_layers::is_own(&e.layer) && !hidden.entity(e)
    };
    let walls: Vec<usize> = (0..drawing.entities.len()).filter(is_wall).collect();
    if walls.is_empty() {
        return;
    }
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    walls.iter().for_each(|i| *counts.entry(&drawing.entities[*i].layer).or_default() += 1);
    let are_rooms = counts.keys().all(|layer| role_by_name(layer).0 == Role::Room);
    for layer in chosen.layers.iter_mut().filter(|l| matches!(l.role, "wall" | "low" | "ignored")) {
        match counts.get(layer.name.as_str()) {
            Some(n) => {
                layer.role = "wall";
                layer.why = match are_rooms {
                    true => "outlines of rooms, since nothing is drawn as a wall".into(),
                    false => format!("{n} of its {} elements look like walls", layer.entities),
                };
            }
            None if layer.role == "wall" => {
                layer.role = "ignored";
                layer.why = "none of its elements looks like a wall; --wall-layer takes it in".into();
            }
            None => {}
        }
    }
    chosen.walls = walls;
}

fn counts(drawing: &Drawing) -> BTreeMap<&str, (usize, usize)> {
    let mut counts: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for e in &drawing.entities {
        counts.entry(&e.layer).or_default().0 += 1;
    }
    for t in &drawing.texts {
        counts.entry(&t.layer).or_default().1 += 1;
    }
    counts
}

fn layer_use(
    name: &str,
    options: &PlanOptions,
    by_name: &WallLayers,
    hidden: &Hidden<'_>,
    only: Option<&str>,
) -> (&'static str, String) {
    if options.query_layer.as_deref() == Some(name) {
        return ("marker", "--query-layer".into());
    }
    if options.reference_layer.as_deref() == Some(name) {
        return ("marker", "--reference-layer".into());
    }
    if own_layers::is_marker(name) {
        return ("marker", "our marker layer".into());
    }
    if let Some(right) = own_layers::meant(name) {
        return ("ignored", format!("looks like our marker layer {right}, and is not spelt so"));
    }
    if own_layers::is_own(name) {
        return ("own", "our result layer".into());
    }
    if let Some(why) = by_name.reason(name).or_else(|| (only == Some(name)).then(|| ASSUMED.into())) {
        return match hidden.layer(name) {
            true => ("hidden", "named after walls, but off or frozen".into()),
            false => ("wall", why),
        };
    }
    if by_name.is_by_user() {
        return ("ignored", "--wall-layer does not name it".into());
    }
    match role_by_name(name) {
        (role, why) if role.is_low() => {
            ("low", format!("{why}: stops the way, not the look at eye level; --level knee takes it in"))
        }
        (_, why) => ("ignored", format!("{why}; --wall-layer takes it in")),
    }
}

/// The layer taken as walls without a name that says so: the only one with lines, unless its name says what else it holds.
fn only_layer<'a>(
    counts: &BTreeMap<&'a str, (usize, usize)>,
    by_name: &WallLayers,
    hidden: &Hidden<'_>,
) -> Option<&'a str> {
    if by_name.is_by_user() || counts.keys().any(|l| by_name.reason(l).is_some() && !hidden.layer(l)) {
        return None;
    }
    let is_open = |l: &str| !own_layers::is_own(l) && !hidden.layer(l) && !is_class(l);
    let mut drawn = counts.iter().filter(|(l, (shapes, _))| *shapes > 0 && is_open(l)).map(|(l, _)| *l);
    let only = drawn.next().filter(|l| role_by_name(l).0 == Role::Unknown);
    only.filter(|_| drawn.next().is_none())
}

/// Whether a file that the drawing refers to was left out: the walls may stand there.
fn lacks_a_file(report: &Report) -> bool {
    report.problems.iter().any(|p| p.code == "dxf-external-reference")
}

/// Classes of a building say outright what is a wall: none is taken for one by its looks.
fn is_class(layer: &str) -> bool {
    layer.starts_with("Ifc")
}

/// Layers of walls that are off or frozen, with something on them.
fn hidden_walls(layers: &[LayerUse]) -> impl Iterator<Item = &LayerUse> {
    layers.iter().filter(|l| l.role == "hidden" && l.entities > 0)
}

/// Names the layers of walls that are left out because they are off or frozen: aloud where nothing else is named after walls.
fn state_hidden(drawing: &Drawing, layers: &[LayerUse], only: Option<&str>, report: &mut Report) {
    let hidden: Vec<String> = hidden_walls(layers)
        .map(|l| format!("{:?} ({})", l.name, counted(l.entities as u64, "element")))
        .collect();
    if hidden.is_empty() {
        return;
    }
    let is = if hidden.len() == 1 { "layer of walls is" } else { "layers of walls are" };
    let text = format!(
        "{} {is} off or frozen and left out: {}; switch on or thaw what should be measured",
        hidden.len(),
        hidden.join(", ")
    );
    // Taken for its name, or by the user.
    let is_chosen = |l: &LayerUse| l.role == "wall" && only != Some(l.name.as_str());
    if layers.iter().any(is_chosen) {
        report.info("walls-hidden", Place::file(&drawing.file), text);
    } else {
        report.warn("walls-hidden", Place::file(&drawing.file), text);
    }
}

/// What is read of a sheet.
pub(super) struct Taken {
    /// Indices of [`Drawing::entities`] that are walls of it, ascending.
    pub walls: Vec<usize>,
    /// All drawings.
    pub views: Vec<View>,
    /// Records of the marks on drawings that are not read: these are not used.
    pub unused_marks: BTreeSet<usize>,
}

/// The walls of the view to read, all views, and which marks are not used.
///
/// # Errors
/// [`Error::Usage`] for a view that is not there.
pub(super) fn choose_view(
    drawing: &Drawing,
    options: &PlanOptions,
    chosen: &Chosen,
    metres_per_unit: f64,
    report: &mut Report,
) -> Result<Taken, Error> {
    let all_used = |walls, views| Ok(Taken { walls, views, unused_marks: BTreeSet::new() });
    if drawing.format != Format::Dxf {
        let (walls, views) = of_building(drawing, options, chosen, metres_per_unit, report);
        return all_used(walls, views);
    }
    let walls: Vec<&Entity> = chosen.walls.iter().map(|i| &drawing.entities[*i]).collect();
    let marks = marks(drawing, options);
    let Sheet { mut views, of_wall, of_mark } =
        sheet(drawing, (options, chosen), &walls, &marks, metres_per_unit);
    if options.picked.is_some() {
        return all_used(chosen.walls.clone(), views);
    }
    if let Some(stated) = view_box::stated(options.view.as_deref()) {
        let beside = marks.iter().filter(|m| !view_box::meets(&stated, &m.mark.extent));
        let unused_marks = beside.map(|m| m.record).collect();
        let views = vec![view_box::view(stated, views.iter().map(|v| v.wall_pieces).sum())];
        return Ok(Taken { walls: chosen.walls.clone(), views, unused_marks });
    }
    let takes_all = takes_all(options);
    if views.len() < 2 {
        say_unused_view(drawing, &views, options, report);
        let far = strays(&walls, metres_per_unit);
        let is_near = |i: &usize| {
            takes_all || of_wall[*i] != STRAY && !far[*i] || options.corrections.insists_on(walls[*i])
        };
        let near: Vec<usize> = (0..walls.len()).filter(is_near).map(|i| chosen.walls[i]).collect();
        state_strays(drawing, chosen.walls.len() - near.len(), report);
        return all_used(near, views);
    }
    match options.view.as_deref().map(str::trim) {
        None if !takes_all => {}
        None => views.iter_mut().for_each(|v| v.is_chosen = true),
        Some(all) if all.eq_ignore_ascii_case("all") => {
            views.iter_mut().for_each(|v| v.is_chosen = true);
        }
        Some(word) => {
            let Some(found) = find(&views, word) else { return Err(no_view(drawing, &views, word)) };
            views.iter_mut().for_each(|v| v.is_chosen = v.number == found);
        }
    }
    if options.view.is_some() {
        views.iter_mut().for_each(|v| v.confidence = f64::from(u8::from(v.is_chosen)));
    }
    state_views(drawing, &views, metres_per_unit, report);
    let walls = chosen.walls.iter().zip(&of_wall);
    let is_taken = |v: usize| takes_all || views.get(v).is_some_and(|v| v.is_chosen);
    let picked = walls.filter(|(_, v)| is_taken(**v)).map(|w| *w.0).collect();
    let elsewhere: Vec<(&UserMark, usize)> =
        marks.iter().zip(of_mark).filter(|(_, v)| !views[*v].is_chosen).collect();
    state_marks(drawing, &views, &elsewhere, options.view.is_some(), report);
    let unused_marks = elsewhere.iter().map(|(m, _)| m.record).collect();
    Ok(Taken { walls: picked, views, unused_marks })
}

/// The drawings of a sheet.
fn sheet(
    drawing: &Drawing,
    (options, chosen): (&PlanOptions, &Chosen),
    walls: &[&Entity],
    marks: &[UserMark],
    metres_per_unit: f64,
) -> Sheet {
    let hidden = Hidden::new(drawing);
    let passive: BTreeSet<&str> = chosen
        .layers
        .iter()
        .filter(|l| {
            let role = role_by_name(&l.name).0;
            l.role != "wall" && matches!(role, Role::Text | Role::Dimension | Role::Site)
                || own_layers::is_own(&l.name)
        })
        .map(|l| l.name.as_str())
        .collect();
    let is_seen = |e: &Entity| !hidden.entity(e) && !passive.contains(e.layer.as_str());
    let marks: Vec<SheetMark> = marks.iter().map(|m| m.mark.clone()).collect();
    split(drawing, walls, &is_seen, (&marks, options.view.is_some()), metres_per_unit)
}

/// Whether everything on the sheet is to be read.
fn takes_all(options: &PlanOptions) -> bool {
    match options.view.as_deref() {
        Some(view) => view.trim().eq_ignore_ascii_case("all"),
        None => options.corrections.as_drawn,
    }
}

/// A storey is one plan, however many buildings stand on it; without the walls that stand where none of them is.
fn of_building(
    drawing: &Drawing,
    options: &PlanOptions,
    chosen: &Chosen,
    metres_per_unit: f64,
    report: &mut Report,
) -> (Vec<usize>, Vec<View>) {
    let all: Vec<&Entity> = chosen.walls.iter().map(|i| &drawing.entities[*i]).collect();
    let far = match options.picked.is_some() || takes_all(options) {
        true => vec![false; all.len()],
        false => far_off(&all, metres_per_unit),
    };
    let mut named = BTreeSet::new();
    let slips: Vec<&Entity> = all
        .iter()
        .zip(&far)
        .filter(|(e, far)| **far && named.insert(e.source.record))
        .map(|(e, _)| *e)
        .collect();
    for e in slips.iter().take(FAR_TOLD) {
        let text = "it stands far from all the others; left out of the plan, kept in the file; --view all takes it in";
        report.warn("far-wall", enfilade_cad::drawing::place(drawing, &e.source), text);
    }
    if slips.len() > FAR_TOLD {
        let text = format!("{} more walls stand as far off and are left out", slips.len() - FAR_TOLD);
        report.warn("far-wall", Place::file(&drawing.file), text);
    }
    let taken: Vec<usize> =
        chosen.walls.iter().zip(&far).filter(|(_, far)| !**far).map(|(i, _)| *i).collect();
    let walls: Vec<&Entity> = taken.iter().map(|i| &drawing.entities[*i]).collect();
    let marks = marks(drawing, options);
    let mut views = sheet(drawing, (options, chosen), &walls, &marks, metres_per_unit).views;
    views.truncate(1);
    views.iter_mut().for_each(|v| v.confidence = 1.0);
    say_unused_view(drawing, &views, options, report);
    (taken, views)
}

/// Most walls far off that are named one by one.
const FAR_TOLD: usize = 20;

fn state_strays(drawing: &Drawing, count: usize, report: &mut Report) {
    if count > 0 {
        let text = match count {
            1 => "1 wall element lies far from the plan and is left out; --view all takes it in".to_owned(),
            n => {
                format!("{n} wall elements lie far from the plan and are left out; --view all takes them in")
            }
        };
        report.info("stray-walls", Place::file(&drawing.file), text);
    }
}

/// Says so where columns were found and no walls.
pub(super) fn state_columns_only(
    drawing: &Drawing,
    options: &PlanOptions,
    walls: &[&Entity],
    report: &mut Report,
) {
    let is_column = |e: &&Entity| role_by_name(&e.layer).0 == Role::Column;
    if drawing.format == Format::Dxf && options.is_our_choice() && walls.iter().all(is_column) {
        let text = "columns were found and no walls; --wall-layer NAME says which layer the walls are on, \
                    --view which drawing of the sheet is meant";
        report.warn("columns-only", Place::file(&drawing.file), text);
    }
}

/// A mark of the user on the sheet.
struct UserMark {
    mark: SheetMark,
    layer: String,
    record: usize,
}

/// The user's marks: they lie in the drawing that is meant.
fn marks(drawing: &Drawing, options: &PlanOptions) -> Vec<UserMark> {
    let named: Vec<&str> =
        [&options.query_layer, &options.reference_layer].into_iter().filter_map(|l| l.as_deref()).collect();
    let of = |e: &Entity| {
        let is_named = named.iter().any(|l| l.eq_ignore_ascii_case(&e.layer));
        let bare = own_layers::bare(&e.layer);
        let kind = match () {
            () if is_named => MarkKind::Region,
            () if !own_layers::is_marker(&e.layer) => return None,
            () if bare.eq_ignore_ascii_case(own_layers::MOVE) => MarkKind::Move,
            () if bare.eq_ignore_ascii_case(own_layers::KEEP) => MarkKind::Keep,
            () => MarkKind::Region,
        };
        let extent = view_box::extent(e)?;
        Some(UserMark { mark: SheetMark { extent, kind }, layer: bare.to_owned(), record: e.source.record })
    };
    drawing.entities.iter().filter_map(of).collect()
}

/// Names the drawings that are not read although something is marked on them.
fn state_marks(
    drawing: &Drawing,
    views: &[View],
    elsewhere: &[(&UserMark, usize)],
    is_told: bool,
    report: &mut Report,
) {
    if elsewhere.is_empty() {
        return;
    }
    let mut counts: BTreeMap<(usize, &str), usize> = BTreeMap::new();
    elsewhere.iter().for_each(|(m, v)| *counts.entry((*v, m.layer.as_str())).or_default() += 1);
    let of = |v: usize| {
        let own = counts.iter().filter(|((view, _), _)| *view == v);
        own.map(|((_, layer), n)| format!("{n} on {layer}")).collect::<Vec<_>>().join(", ")
    };
    let marked: BTreeSet<usize> = elsewhere.iter().map(|(_, v)| *v).collect();
    let named: Vec<String> =
        marked.into_iter().map(|v| format!("{} {:?} ({})", views[v].number, views[v].name, of(v))).collect();
    let read: Vec<String> =
        views.iter().filter(|v| v.is_chosen).map(|v| format!("{} {:?}", v.number, v.name)).collect();
    let text = format!(
        "found marks on a drawing that is not read: {}; they are not used; read: {}; --view NAME reads another drawing, \
         --view all reads all as one",
        named.join("; "),
        read.join(", ")
    );
    match is_told {
        true => report.info("marks-elsewhere", Place::file(&drawing.file), text),
        false => report.warn("marks-elsewhere", Place::file(&drawing.file), text),
    }
}

/// Says that a view was asked for where there is but one plan, unless it is that one.
fn say_unused_view(drawing: &Drawing, views: &[View], options: &PlanOptions, report: &mut Report) {
    let Some(word) = options.view.as_deref().map(str::trim) else { return };
    let is_it = word == "1"
        || view_box::stated(Some(word)).is_some()
        || word.eq_ignore_ascii_case("all")
        || find(views, word).is_some();
    if !is_it {
        let text = format!("view {word:?} was asked for, but this is one drawing alone; it is read");
        report.warn("view-unused", Place::file(&drawing.file), text);
    }
}

/// Number of the view of this number or name: the whole name, else a part of it.
fn find(views: &[View], word: &str) -> Option<usize> {
    if let Ok(number) = word.parse::<usize>() {
        return views.iter().find(|v| v.number == number).map(|v| v.number);
    }
    let word = word.to_lowercase();
    let whole = views.iter().find(|v| v.name.to_lowercase() == word);
    whole.or_else(|| views.iter().find(|v| v.name.to_lowercase().contains(&word))).map(|v| v.number)
}

fn list(views: &[View], metres_per_unit: f64) -> String {
    let one = |v: &View| {
        let size = (v.extent[1] - v.extent[0]) * metres_per_unit;
        format!(
            "{} {:?} {:.0} x {:.0} m, {}, {}",
            v.number,
            v.name,
            size.x,
            size.y,
            counted(v.wall_pieces as u64, "wall piece"),
            v.kind.words()
        )
    };
    views.iter().map(one).collect::<Vec<_>>().join("; ")
}

fn no_view(drawing: &Drawing, views: &[View], word: &str) -> Error {
    let names: Vec<String> = views.iter().map(|v| format!("{} {:?}", v.number, v.name)).collect();
    let text = format!("--view {word:?}: expected all or one of {}; nothing was done", names.join(", "));
    Error::usage("view", Place::file(&drawing.file), text)
}

fn state_views(drawing: &Drawing, views: &[View], metres_per_unit: f64, report: &mut Report) {
    let taken: Vec<String> =
        views.iter().filter(|v| v.is_chosen).map(|v| format!("{} {:?}", v.number, v.name)).collect();
    let text = format!(
        "{} drawings on the sheet, read: {}; --view chooses another. They are: {}",
        views.len(),
        taken.join(", "),
        list(views, metres_per_unit)
    );
    report.info("views", Place::file(&drawing.file), text);
}

/// [`super::Plan::picked`] of some entities.
pub(super) fn ordinals(drawing: &Drawing, picked: &[usize]) -> Vec<usize> {
    let mut next = picked.iter().copied().peekable();
    let mut out = Vec::with_capacity(picked.len());
    let foreign = drawing.entities.iter().enumerate().filter(|(_, e)| !own_layers::is_own(&e.layer));
    for (ordinal, (i, _)) in foreign.enumerate() {
        if next.next_if_eq(&i).is_some() {
            out.push(ordinal);
        }
    }
    out
}
