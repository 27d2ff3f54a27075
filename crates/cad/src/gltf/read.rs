//! A scene as a plan: meshes cut at the height of the eyes.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::ops::Range;

use glam::{DAffine2, DAffine3, DMat2, DMat3, DVec2, DVec3};

use super::bearing::bearing;
use super::bodies::{Bodies, SCENE_LAYER, SPACE_LAYER, bodies, is_global_id};
use super::body::Body;
use super::floors::chosen_floor;
use super::levels::Levels;
use super::motion::z_up;
use super::record::{of_record, record};
use super::scale::{METRE, Scale};
use super::scene::{File, Shown, Walked};
use super::{ReadOptions, marks, twin, upright, values};
use crate::StoreyInfo;
use crate::curve::control_points;
use crate::drawing::{
    Called, Drawing, Editable, Entity, Format, Layer, MarkedMove, Shape, Single, SourceRef, Text, Vertex,
};
use crate::ifc::ZONE_LAYER;
use crate::own_layers::DEMOLISHED;
use crate::phase::Phase;
use crate::region::{Region, slice};
use enfilade_report::{Error, Place, Report};

/// Reads a scene.
///
/// # Errors
/// [`Error::Input`] where the bytes are no glTF 2.0, or nothing in it can be cut.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    let scene = File::open(file, bytes, &options.buffers)?;
    let Walked { shown, odd, hidden } = scene.walked();
    for text in odd {
        report.warn("gltf-nodes", Place::file(file), text);
    }
    state_hidden(&scene, &hidden, report);
    values::state(&scene, &shown, report);
    let options = &*twin::taken(&scene, &shown, options, report);
    twin::state_marks(file, options, report);
    let Bodies { list: bodies, lost } = bodies(&scene, &shown, options, report);
    let missing = scene.buffers.iter().enumerate().find_map(|(i, b)| Some((i, b.as_ref().err()?)));
    if let (Some((i, why)), true) = (missing, bodies.is_empty()) {
        let place = Place::file(file).entity(format!("/buffers/{i}"));
        return Err(Error::input("gltf-buffer", place, format!("{why}; nothing was done")));
    }
    for (i, text) in super::outer::missing_pictures(&scene.json, &options.pictures) {
        report.info("gltf-picture", Place::file(file).entity(format!("/images/{i}")), text);
    }
    if let Some(version) = scene.odd_version() {
        let text = format!(
            "found version {version:?}, expected \"2.0\"; read as glTF 2.0 because it is laid out so"
        );
        report.info("gltf-version", Place::file(file).entity("/asset/version"), text);
    }
    upright::state(file, &bodies, report);
    let scale = Scale::of(&bodies, options);
    if let Some(doubt) = &scale.doubt {
        report.warn(
            "unit-doubt",
            Place::file(file),
            format!("unit: {doubt}; read in metres as the standard says"),
        );
    }
    let above = options.above_m() / scale.metres;
    let levels = Levels::of(&scene, &bodies, options, scale.metres);
    let floor = chosen_floor(file, &bodies, options, (&levels, scale.metres), report)?;
    let (mut entities, mut regions) = (Vec::new(), BTreeSet::new());
    let (mut built, mut gone, mut said) = (BTreeSet::new(), BTreeSet::new(), Vec::new());
    let (by_ifc, by_scene) = (options.elsewhere(&scene), levels.elsewhere(options));
    let is_elsewhere = |s: &Shown| by_ifc(s) || by_scene(s);
    let mut flat: Vec<(usize, &str)> = Vec::new();
    for body in &bodies {
        let before = entities.len();
        show(&scene, body, floor + above, options, &mut entities, &mut regions);
        let path = body.shown.path();
        let own = record(body.element.node, body.piece);
        match marks::status(&scene, &path) {
            _ if entities.len() == before => {}
            Phase::Existing | Phase::Temporary if body.is_wall => {}
            Phase::Existing | Phase::Temporary => {
                said.extend(show_work(&scene, &path, &mut entities[before..]))
            }
            Phase::New => {
                built.insert(own);
            }
            Phase::Demolished => {
                gone.insert(own);
                on_layer(&mut entities[before..], DEMOLISHED);
            }
        }
        let why = without_extent(body, floor + above, entities.len() > before);
        flat.extend(why.filter(|_| !is_elsewhere(body.shown)).map(|why| (body.shown.node, why)));
    }
    state_flat(&scene, flat, report);
    state_low(&scene, &bodies, [floor, floor + above], &is_elsewhere, report);
    let hosts = hosts(&scene, &bodies, options);
    // What sits in a wall goes with it.
    let stays = |e: &Entity| hosts.get(&e.source.record).is_none_or(|host| !gone.contains(host));
    entities.retain(stays);
    let (mut texts, marked) =
        (space_names(&scene, &bodies, &entities, options), marked_moves(&scene, &entities));
    texts.extend(said);
    let used = marks::Used::new(&bodies, lost, &entities, &marked, regions);
    let idle_marks = marks::state(&scene, &shown, &used, &is_elsewhere, report);
    let mut names: Vec<Layer> = Vec::new();
    let mut seen = BTreeSet::new();
    for e in &entities {
        if seen.insert(e.layer.as_str()) {
            names.push(Layer { name: e.layer.clone(), is_off: false, is_frozen: false, is_locked: false });
        }
    }
    Ok(Drawing {
        file: file.into(),
        format: if scene.chunks.is_empty() { Format::Gltf } else { Format::Glb },
        version: "glTF 2.0".into(),
        declared_unit: Some(METRE),
        declared_unit_words: scale.words,
        unit_by_heights: scale.by_heights,
        layers: names,
        entities,
        texts,
        marked,
        idle_marks,
        hosts,
        slots: Vec::new(),
        bearing: bearing(&scene, &bodies),
        things: Vec::new(),
        tags: Vec::new(),
        called: called(&scene, &bodies, [floor, floor + above]),
        widths: Default::default(),
        singles: singles(&bodies),
        north_deg: 0.0,
        wishes: Vec::new(),
        built,
        undrawn: Vec::new(),
        unbound: 0,
        records: Vec::new(),
        written: Default::default(),
        fills: Vec::new(),
    })
}

/// Says how many nodes are left out because the file hides them.
fn state_hidden(scene: &File<'_>, hidden: &BTreeSet<usize>, report: &mut Report) {
    let Some(first) = hidden.first() else { return };
    let first = scene.named(*first);
    let text = match hidden.len() {
        1 => {
            format!("1 node with a mesh is left out because the file hides it (KHR_node_visibility): {first}")
        }
        n => format!(
            "{n} nodes with meshes are left out because the file hides them (KHR_node_visibility), {first} is the first"
        ),
    };
    report.info("gltf-hidden", Place::file(scene.name), text);
}

/// What stands between two heights and is no wall, by the names of its nodes.
fn called(scene: &File<'_>, bodies: &[Body<'_>], [low, high]: [f64; 2]) -> Vec<Called> {
    let is_here = |b: &&Body<'_>| !b.is_wall && b.layer != SPACE_LAYER && b.low < high && b.high > low;
    let one = |b: &Body<'_>| {
        let name = b.shown.names(scene).rev().find(|n| !n.is_empty())?;
        let class = if b.layer.starts_with("Ifc") { b.layer.as_str() } else { "" };
        let points = b.triangles.iter().flatten().map(|p| p.truncate());
        Some(Called { words: format!("{name} {class}"), extent: crate::plane::box_of(points)?, source: None })
    };
    bodies.iter().filter(is_here).filter_map(one).collect()
}

/// Doors and windows by the wall in which they sit, records: where the IFC beside the scene says so, and the wall is a node
/// of its own, which moves as a whole.
fn hosts(scene: &File<'_>, bodies: &[Body<'_>], options: &ReadOptions) -> BTreeMap<usize, usize> {
    let of = |body: &Body<'_>| record(body.element.node, body.piece);
    let mut wall_of: BTreeMap<&str, usize> = BTreeMap::new();
    let is_host: BTreeSet<&str> = options.known().hosts.values().map(String::as_str).collect();
    for body in bodies.iter().filter(|b| b.piece.is_none()) {
        for name in body.element.names(scene).filter(|n| is_host.contains(n)) {
            wall_of.entry(name).or_insert(of(body));
        }
    }
    let host = |body: &Body<'_>| {
        let wall = body.shown.names(scene).find_map(|n| options.known().hosts.get(n))?;
        wall_of.get(wall.as_str()).copied()
    };
    let told = bodies.iter().filter_map(|b| Some((of(b), host(b)?)));
    told.filter(|(filler, wall)| filler != wall).collect()
}

/// Pieces of meshes, records: their vertices are written anew, each by itself.
fn singles(bodies: &[Body<'_>]) -> BTreeMap<usize, Single> {
    let of = |b: &Body<'_>| Some((record(b.element.node, b.piece), single(&(z_up() * b.shown.world))?));
    bodies.iter().filter(|b| b.piece.is_some()).filter_map(of).collect()
}

/// The frame in the plan of vertices that `placed` takes to the world, Z up, where one of their axes is upright: what is
/// cut of an upright edge is then a vertex, seen from above.
fn single(placed: &DAffine3) -> Option<Single> {
    let columns = [placed.x_axis, placed.y_axis, placed.z_axis];
    let is_upright = |c: &DVec3| c.truncate().length() <= UPRIGHT_SHARE * c.length();
    let upright = columns.iter().position(is_upright)?;
    let mut level = (0..3).filter(|k| *k != upright).map(|k| columns[k].truncate());
    let axes = DMat2::from_cols(level.next()?, level.next()?);
    Single::new(DAffine2::from_mat2_translation(axes, placed.translation.truncate()))
}

/// An axis is upright that goes aside by no more than this share of its length: what turns of double precision leave.
const UPRIGHT_SHARE: f64 = 1e-12;

/// Names of spaces and of their zones, each at the middle of its outline; where the IFC beside the scene knows the space,
/// by its names there too.
fn space_names(
    scene: &File<'_>,
    bodies: &[Body<'_>],
    entities: &[Entity],
    options: &ReadOptions,
) -> Vec<Text> {
    let mut first: HashMap<usize, &Entity> = HashMap::new();
    entities.iter().for_each(|e| {
        first.entry(e.source.record).or_insert(e);
    });
    let mut out = Vec::new();
    for body in bodies.iter().filter(|b| b.layer == SPACE_LAYER) {
        let Some(own) = first.get(&record(body.element.node, body.piece)) else { continue };
        let Shape::Polyline { vertices, .. } = &own.shape else { continue };
        let Some([lo, hi]) = crate::plane::box_of(vertices.iter().map(|v| v.at)) else { continue };
        let name = body.shown.names(scene).rev().find(|n| !n.is_empty()).unwrap_or_default();
        let name = name.strip_prefix("IfcSpace/").unwrap_or(name);
        let known = body.shown.names(scene).rev().find_map(|n| options.known().spaces.get(n));
        let known = known.or_else(|| options.space_of_name(name));
        let is_told = known.is_some() || !is_global_id(name);
        let mut names: Vec<&str> = is_told.then_some(name).into_iter().collect();
        names.extend(known.iter().flat_map(|k| &k.names).map(String::as_str));
        let zones: Vec<&str> = known.iter().flat_map(|k| &k.zones).map(String::as_str).collect();
        for (layer, names) in [(SPACE_LAYER, names), (ZONE_LAYER, zones)] {
            let mut seen = BTreeSet::new();
            let names: Vec<&str> = names.into_iter().filter(|n| seen.insert(*n)).collect();
            if !names.is_empty() {
                let (source, text) = (own.source.clone(), names.join("\n"));
                out.push(Text { source, layer: layer.into(), at: lo.midpoint(hi), text });
            }
        }
    }
    out
}

/// Moves that nodes state of themselves: `"extras": {"enfilade": {"move": "x -1 1", "name": "screen"}}`.
fn marked_moves(scene: &File<'_>, entities: &[Entity]) -> Vec<MarkedMove> {
    let (mut out, mut seen) = (Vec::new(), HashSet::new());
    for e in entities.iter().filter(|e| seen.insert(e.source.record)) {
        let node = of_record(e.source.record).0;
        let Some(text) = marks::own_move(scene, node) else { continue };
        let own = marks::own_name(scene, node);
        out.push(MarkedMove {
            name: own.unwrap_or(&e.source.kind).into(),
            is_named: own.is_some(),
            text,
            record: e.source.record,
            source: e.source.clone(),
        });
    }
    out
}

/// Height of the floor that the walls stand on, units of the scene; and metres in one of these.
pub(super) fn floor_of(
    scene: &File<'_>,
    shown: &[Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Result<(f64, f64), Error> {
    standing(scene, shown, options, report).map(|s| (s.floor, s.metres))
}

/// What stands in a scene.
pub(super) struct Standing<'f> {
    /// What it shows.
    pub bodies: Vec<Body<'f>>,
    /// Height of the floor that the walls stand on, units of the scene.
    pub floor: f64,
    /// Metres in one unit.
    pub metres: f64,
}

/// What stands in a scene, as it is read.
pub(super) fn standing<'f>(
    scene: &File<'_>,
    shown: &'f [Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Result<Standing<'f>, Error> {
    let options = &*twin::taken(scene, shown, options, report);
    let bodies = bodies(scene, shown, options, report).list;
    let scale = Scale::of(&bodies, options);
    let levels = Levels::of(scene, &bodies, options, scale.metres);
    let floor = chosen_floor(scene.name, &bodies, options, (&levels, scale.metres), report)?;
    Ok(Standing { bodies, floor, metres: scale.metres })
}

/// Storeys that a scene shows by itself, from the lowest, without an IFC beside it; none where it cannot be read.
pub fn storeys(file: &str, bytes: &[u8], options: &ReadOptions) -> Vec<StoreyInfo> {
    let Ok(scene) = File::open(file, bytes, &options.buffers) else { return Vec::new() };
    let (shown, report) = (scene.shown(), &mut Report::default());
    let options = &*twin::taken(&scene, &shown, options, report);
    let bodies = bodies(&scene, &shown, options, report).list;
    let metres = Scale::of(&bodies, options).metres;
    Levels::of(&scene, &bodies, options, metres).storeys(options).to_vec()
}

/// Why a wall that should stand at a height shows nothing there: it is flat.
fn without_extent(body: &Body<'_>, z: f64, is_shown: bool) -> Option<&'static str> {
    let is_scaled = body.shown.world.matrix3.determinant() == 0.0;
    if is_shown || !body.is_wall {
        None
    } else if body.low == body.high {
        is_scaled.then_some("it has no height (a transform scales it by 0 in one direction)")
    } else if body.low >= z || body.high <= z {
        None
    } else if is_scaled {
        Some("it has no width (a transform scales it by 0 in one direction)")
    } else {
        Some("its cut encloses nothing: its faces lie on one another")
    }
}

/// Names the walls that are flat, each node once.
fn state_flat(scene: &File<'_>, mut flat: Vec<(usize, &str)>, report: &mut Report) {
    flat.dedup();
    let more = flat.len().saturating_sub(values::TOLD);
    for (node, why) in flat.into_iter().take(values::TOLD) {
        let place = Place::file(scene.name).entity(scene.named(node));
        report.warn("gltf-mesh", place, format!("{why}, expected a solid or a face; it is left out"));
    }
    if more > 0 {
        report.warn(
            "gltf-mesh",
            Place::file(scene.name),
            format!("{more} more walls are flat and are left out"),
        );
    }
}

/// Names the walls of the storey that end below the cut.
fn state_low(
    scene: &File<'_>,
    bodies: &[Body<'_>],
    [floor, cut]: [f64; 2],
    is_elsewhere: &dyn Fn(&Shown) -> bool,
    report: &mut Report,
) {
    let is_low = |b: &&Body<'_>| b.low < b.high && b.low < cut && b.high > floor && b.high <= cut;
    let low = bodies.iter().filter(|b| b.is_wall).filter(is_low);
    let low: Vec<&Body<'_>> = low.filter(|b| !is_elsewhere(b.shown)).collect();
    if low.is_empty() {
        return;
    }
    let named: Vec<String> = low.iter().take(values::TOLD).map(|b| scene.named(b.shown.node)).collect();
    let more = if low.len() > named.len() { ", …" } else { "" };
    let text = format!(
        "{} the height of the cut and {} not block sight: {}{more}",
        if low.len() == 1 {
            "1 wall does not reach".into()
        } else {
            format!("{} walls do not reach", low.len())
        },
        if low.len() == 1 { "does" } else { "do" },
        named.join(", ")
    );
    report.info("gltf-not-cut", Place::file(scene.name), text);
}

/// Shows what of a body is cut, and gathers in `regions` the nodes whose word makes a region of it, each with the word.
fn show(
    scene: &File<'_>,
    body: &Body<'_>,
    z: f64,
    options: &ReadOptions,
    out: &mut Vec<Entity>,
    regions: &mut BTreeSet<(usize, &'static str)>,
) {
    if body.low >= z || body.high <= z {
        return;
    }
    let faces: Vec<Vec<Vec<DVec3>>> = body.triangles.iter().map(|t| vec![t.to_vec()]).collect();
    let mut region = slice(&faces, z);
    let is_opening = ["IfcDoor", "IfcWindow"].contains(&body.layer.as_str());
    if is_opening && let Some(corners) = region.box_along() {
        region = Region::ring(corners.map(|c| c.to_array()).to_vec());
    }
    let layer = if body.layer == "IfcWindow" && options.is_knee {
        "IfcWall (window at knee height)"
    } else {
        &body.layer
    };
    let names = body.element.names(scene).rev();
    let source = SourceRef {
        record: record(body.element.node, body.piece),
        handle: Some(format!("/nodes/{}", body.element.node)),
        line: 0,
        kind: { names }.find(|n| !n.is_empty()).unwrap_or_default().into(),
        layer: layer.into(),
    };
    let (editable, first) = (editable(scene, body), out.len());
    let rings = region.rings().filter(|r| r.len() > 2).map(|r| (r, true));
    for (ring, closed) in rings.chain(region.lines.iter().filter(|l| l.len() > 1).map(|l| (l, false))) {
        let vertices = ring.iter().map(|p| Vertex { at: DVec2::from(*p), bulge: 0.0 }).collect();
        out.push(Entity {
            source: source.clone(),
            layer: layer.into(),
            shape: Shape::Polyline { vertices, closed },
            editable: editable.clone(),
            blocks: Vec::new(),
            origin: Default::default(),
        });
    }
    let (path, shown) = (&body.shown.path(), first..out.len());
    let is_room = !body.is_wall && !is_opening && body.layer != SCENE_LAYER;
    for (key, mark) in [("query", "EF-QUERY"), ("reference", "EF-REFERENCE")] {
        let Some((node, name)) = marks::region(scene, path, key).filter(|_| is_room && !shown.is_empty())
        else {
            continue;
        };
        copy(out, &shown, &name.map_or_else(|| mark.into(), |name| format!("{mark}-{name}")));
        regions.insert((node, key));
    }
    if body.layer == "IfcSpace" && marks::is_set(scene, path, "keep") {
        copy(out, &shown, "EF-KEEP");
    }
}

fn on_layer(which: &mut [Entity], layer: &str) {
    for e in which {
        e.layer = layer.into();
        e.source.layer = layer.into();
    }
}

/// Shows outlines as the mark of a decided work, if their node says so, with what it says of it.
fn show_work(scene: &File<'_>, path: &[usize], which: &mut [Entity]) -> Option<Text> {
    let (layer, text) = marks::work(scene, path)?;
    on_layer(which, layer);
    let first = which.first()?;
    let [lo, hi] = crate::plane::box_of(control_points(&first.shape).into_iter())?;
    let at = lo.midpoint(hi);
    Some(Text { source: first.source.clone(), layer: layer.into(), at, text: text?.into() })
}

/// Shows the same outlines on another layer too.
fn copy(out: &mut Vec<Entity>, which: &Range<usize>, layer: &str) {
    let copies: Vec<Entity> =
        out[which.clone()].iter().map(|e| Entity { layer: layer.into(), ..e.clone() }).collect();
    out.extend(copies);
}

fn editable(scene: &File<'_>, body: &Body<'_>) -> Editable {
    if let Some(why) = &body.held {
        return Editable::No(why.clone());
    }
    if body.piece.is_some() {
        return Editable::WithInsert { turnable: true };
    }
    let m = body.element.parent.matrix3;
    let det = m.determinant();
    if det == 0.0 || !det.is_finite() {
        return Editable::No("its parent has no size".into());
    }
    let node = &scene.json.list("nodes")[body.element.node];
    Editable::WithInsert { turnable: node.get("matrix").is_some() || takes_turns(&m) }
}

/// Whether what hangs below a matrix, mirrored or not, can turn about the height and is not skewed: all that lies level is
/// scaled alike in all directions.
fn takes_turns(m: &DMat3) -> bool {
    let spread = *m * m.transpose();
    let size = spread.x_axis.x;
    let is_nothing = |v: f64| v.abs() < 1e-9 * size;
    is_nothing(spread.z_axis.z - size)
        && [spread.y_axis.x, spread.z_axis.x, spread.z_axis.y].into_iter().all(is_nothing)
}
