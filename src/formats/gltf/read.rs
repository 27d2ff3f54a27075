//! A scene as a plan: meshes cut at the height of the eyes.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::json::Json;
use super::meshes::Why;
use super::pieces::{of_record, record};
use super::scene::{File, Shown};
use super::{CUT_EYE_M, CUT_KNEE_M, ReadOptions, marks, values};
use crate::formats::region::{Region, slice};
use crate::formats::{listed, storey_at};
use crate::plan::drawing::{
    Drawing, Editable, Entity, Format, Layer, MarkedMove, Shape, SourceRef, Text, Unit, Vertex,
};
use crate::plan::layers::{self, WallLayers};
use crate::plan::sizes::{Sizes, Verdict};
use crate::report::{Error, Place, Report};

/// Layer of everything where no name says what is a wall.
const SCENE_LAYER: &str = "scene";

/// The unit of the standard.
const METRE: Unit = Unit { name: "m", metres: 1.0 };

/// Floors nearer than this are one.
const FLOOR_M: f64 = 0.05;

/// Coordinates beyond this are slips or damage, units of the scene: a scene in millimetres that stands at its place on
/// the map has 1e10.
const COORDINATE_MAX: f64 = 1e12;

/// What is this high may be a wall.
const STOREY_HIGH_M: f64 = 2.0;

/// Glass and door leaves: they close a gap and do not block sight.
const DOOR_WORDS: [&str; 6] = ["door", "doors", "tür", "porte", "porta", "puerta"];
const WINDOW_WORDS: [&str; 7] = ["window", "windows", "fenster", "fenetre", "finestra", "ventana", "glass"];

/// Y up to Z up, as seen from above.
pub(super) fn z_up() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y))
}

/// A mesh shown in the scene, Z up, or one piece of it.
struct Body<'f> {
    shown: &'f Shown,
    /// What moves with it: the node itself, or the one that it hangs on and that says how it moves.
    element: &'f Shown,
    /// Why the element cannot move.
    held: Option<String>,
    /// The piece, where several walls share the mesh.
    piece: Option<usize>,
    layer: String,
    triangles: Vec<[DVec3; 3]>,
    low: f64,
    high: f64,
}

/// Reads a scene.
///
/// # Errors
/// [`Error::Input`] where the bytes are no glTF 2.0, or nothing in it can be cut.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    let scene = File::open(file, bytes, &options.buffers)?;
    let (shown, odd) = scene.shown();
    for text in odd {
        report.warn("gltf-nodes", Place::file(file), text);
    }
    values::state(&scene, &shown, report);
    let has = |is_it: &dyn Fn(&str) -> bool| shown.iter().any(|s| s.names(&scene).any(is_it));
    let is_other = has(&is_global_id) && !has(&|n| options.classes.contains_key(n));
    let other = (options.has_twin && (options.classes.is_empty() || is_other)).then(|| {
        let why = if options.classes.is_empty() {
            "cannot be read, or holds no element"
        } else {
            "has none of the GlobalIds that its nodes are named by: it is of another building"
        };
        let text = format!("the .ifc of the same name beside it {why}; the scene was read without it");
        report.warn("gltf-ifc", Place::file(file), text);
        let (classes, hosts, storeys) = Default::default();
        ReadOptions { classes, hosts, storeys, ..options.clone() }
    });
    let options = other.as_ref().unwrap_or(options);
    let bodies = named_bodies(&scene, &shown, options, report);
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
    let scale = Scale::of(&bodies, options);
    if let Some(doubt) = &scale.doubt {
        report.warn(
            "unit-doubt",
            Place::file(file),
            format!("unit: {doubt}; read in metres as the standard says"),
        );
    }
    let above = above(options) / scale.metres;
    let floor = chosen_floor(file, &bodies, options, &scale, report)?;
    let mut entities = Vec::new();
    for body in &bodies {
        show(&scene, body, floor + above, options, &mut entities);
    }
    state_low(&scene, &bodies, [floor, floor + above], report);
    let (texts, marked) = (space_names(&scene, &bodies, &entities), marked_moves(&scene, &entities));
    let moved: Vec<usize> = marked.iter().map(|m| of_record(m.record).0).collect();
    marks::state(&scene, &shown, &moved, report);
    let mut names: Vec<Layer> = Vec::new();
    for e in &entities {
        if names.iter().all(|l| l.name != e.layer) {
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
        hosts: hosts(&scene, &bodies, options),
        widths: Default::default(),
        undrawn: Vec::new(),
        fills: Vec::new(),
    })
}

/// Doors and windows by the wall in which they sit, records: where the IFC beside the scene says so, and the wall is a node
/// of its own, which moves as a whole.
fn hosts(scene: &File<'_>, bodies: &[Body<'_>], options: &ReadOptions) -> BTreeMap<usize, usize> {
    let of = |body: &Body<'_>| record(body.element.node, body.piece);
    let mut wall_of: BTreeMap<&str, usize> = BTreeMap::new();
    let is_host: BTreeSet<&str> = options.hosts.values().map(String::as_str).collect();
    for body in bodies.iter().filter(|b| b.piece.is_none()) {
        for name in body.element.names(scene).filter(|n| is_host.contains(n)) {
            wall_of.entry(name).or_insert(of(body));
        }
    }
    let host = |body: &Body<'_>| {
        let wall = body.shown.names(scene).find_map(|n| options.hosts.get(n))?;
        wall_of.get(wall.as_str()).copied()
    };
    let told = bodies.iter().filter_map(|b| Some((of(b), host(b)?)));
    told.filter(|(filler, wall)| filler != wall).collect()
}

/// In what a scene measures.
struct Scale {
    /// Metres in one unit.
    metres: f64,
    /// The unit, where the walls cannot be as high as they are in metres.
    by_heights: Option<Unit>,
    /// The standard's words for its unit, and what stands against it.
    words: String,
    /// Why metres are doubted.
    doubt: Option<String>,
}

impl Scale {
    fn of(bodies: &[Body<'_>], options: &ReadOptions) -> Self {
        let words = "the standard (metres, Y up)".to_string();
        let believed = Self { metres: 1.0, by_heights: None, words: words.clone(), doubt: None };
        if let Some(unit) = options.unit {
            return Self { metres: unit.metres, ..believed };
        }
        match sizes(bodies).verdict(METRE) {
            Verdict::Believed => believed,
            Verdict::Instead(unit, against) => Self {
                metres: unit.metres,
                by_heights: Some(unit),
                words: format!("{words}, in which it has {against}"),
                ..believed
            },
            Verdict::Doubted(text) => Self { doubt: Some(text), ..believed },
        }
    }
}

/// What elements measure, units of the scene.
fn sizes(bodies: &[Body<'_>]) -> Sizes {
    let by_name = WallLayers::new(&[]).ok();
    let is_wall = |b: &&Body<'_>| by_name.as_ref().is_some_and(|w| w.reason(&b.layer).is_some());
    let is_scene = bodies.iter().any(|b| b.layer == SCENE_LAYER);
    let points = || bodies.iter().flat_map(|b| b.triangles.iter().flatten());
    let low = points().fold(DVec3::INFINITY, |lo, p| lo.min(*p));
    let size = points().fold(DVec3::NEG_INFINITY, |hi, p| hi.max(*p)) - low;
    // The width of a door is the diagonal of its box, whichever way it stands; its depth is little beside it.
    let width = |b: &Body<'_>| {
        let points = b.triangles.iter().flatten().map(|p| p.truncate());
        crate::plan::box_of(points).map(|[lo, hi]| hi.distance(lo))
    };
    Sizes {
        wall_heights: bodies.iter().filter(is_wall).map(|b| b.high - b.low).collect(),
        door_widths: bodies.iter().filter(|b| b.layer == "IfcDoor").filter_map(width).collect(),
        scene: is_scene.then_some([size.z, size.x.max(size.y)]),
        ..Sizes::default()
    }
}

/// Height of the storey's floor where storeys are known, else the one above which most walls are cut; units of the
/// scene.
fn chosen_floor(
    file: &str,
    bodies: &[Body<'_>],
    options: &ReadOptions,
    scale: &Scale,
    report: &mut Report,
) -> Result<f64, Error> {
    let above = above(options);
    let names = listed(&options.storeys);
    let wanted = options.storey.as_deref();
    let found = match wanted {
        Some(name) => {
            storey_at(options.storeys.iter().map(|s| s.name.as_str()), name).map(|i| &options.storeys[i])
        }
        None => options.storeys.iter().rev().max_by_key(|s| s.walls),
    };
    if let (None, Some(name)) = (found, wanted) {
        let names = if names.is_empty() {
            "none (glTF has none; the .ifc of the same name beside it has)"
        } else {
            &names
        };
        let text = format!(
            "--storey \"{name}\": no such storey, storeys present, by number and name: {names}; nothing was done"
        );
        return Err(Error::usage("storey", Place::file(file), text));
    }
    Ok(match found {
        Some(storey) => {
            let text = format!(
                "storeys by the IFC beside it: {names}; \"{}\" cut {above} m above its floor at {:.3} m",
                storey.name, storey.floor_m
            );
            report.info("storey-cut", Place::file(file), text);
            storey.floor_m / scale.metres
        }
        None => {
            let floor = floor(bodies, scale.metres, above / scale.metres);
            let text = format!(
                "no storeys in glTF; cut {above} m above the floor found at {:.3} m",
                floor * scale.metres
            );
            report.info("gltf-cut", Place::file(file), text);
            floor
        }
    })
}

/// Names of spaces, each at the middle of its outline.
fn space_names(scene: &File<'_>, bodies: &[Body<'_>], entities: &[Entity]) -> Vec<Text> {
    let mut out = Vec::new();
    for body in bodies.iter().filter(|b| b.layer == "IfcSpace") {
        let Some(own) = entities.iter().find(|e| e.source.record == body.shown.node) else { continue };
        let Shape::Polyline { vertices, .. } = &own.shape else { continue };
        let Some([lo, hi]) = crate::plan::box_of(vertices.iter().map(|v| v.at)) else { continue };
        let name = body.shown.names(scene).next_back().unwrap_or_default();
        let name = name.strip_prefix("IfcSpace/").unwrap_or(name);
        out.push(Text {
            source: own.source.clone(),
            layer: "IfcSpace".into(),
            at: lo.midpoint(hi),
            text: name.into(),
        });
    }
    out
}

/// Moves that nodes state of themselves: `"extras": {"enfilade": {"move": "x -1 1", "name": "screen"}}`.
fn marked_moves(scene: &File<'_>, entities: &[Entity]) -> Vec<MarkedMove> {
    let mut out: Vec<MarkedMove> = Vec::new();
    for e in entities {
        let node = of_record(e.source.record).0;
        let Some(text) = marks::own_move(scene, node) else { continue };
        if out.iter().any(|m| m.record == e.source.record) {
            continue;
        }
        let name = marks::own_name(scene, node).unwrap_or(&e.source.kind);
        out.push(MarkedMove { name: name.into(), text, record: e.source.record, source: e.source.clone() });
    }
    out
}

/// Height of the cut above the floor, metres.
fn above(options: &ReadOptions) -> f64 {
    if options.is_knee { CUT_KNEE_M } else { CUT_EYE_M }
}

fn named_bodies<'f>(
    scene: &File<'_>,
    shown: &'f [Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Vec<Body<'f>> {
    let mut out = bodies(scene, shown, options, report);
    choose_layers(scene, &mut out, options, report);
    out
}

/// Height of the floor that the walls stand on, units of the scene; and metres in one of these.
pub(super) fn floor_of(
    scene: &File<'_>,
    shown: &[Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Result<(f64, f64), Error> {
    let bodies = named_bodies(scene, shown, options, report);
    let scale = Scale::of(&bodies, options);
    Ok((chosen_floor(scene.name, &bodies, options, &scale, report)?, scale.metres))
}

fn bodies<'f>(
    scene: &File<'_>,
    shown: &'f [Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Vec<Body<'f>> {
    let nodes = scene.json.list("nodes");
    let mut meshes: BTreeMap<usize, Result<Vec<[DVec3; 3]>, Why>> = BTreeMap::new();
    let mut out = Vec::new();
    let mut lost = Lost::default();
    let elements = Elements::new(scene, shown);
    for s in shown {
        let Some(mesh) = nodes[s.node].index("mesh").filter(|_| !s.names(scene).any(layers::is_own)) else {
            continue;
        };
        let layer = layer(scene, s, options);
        let triangles = match meshes.entry(mesh).or_insert_with(|| scene.triangles(mesh)) {
            Ok(triangles) => triangles,
            Err((pointer, why)) => {
                lost.unread.push((s.node, format!("mesh {mesh} cannot be read: {pointer}: {why}")));
                continue;
            }
        };
        if triangles.is_empty() {
            lost.lines.push((s.node, layer));
            continue;
        }
        let (element, is_whole) = elements.of(s);
        let m = z_up() * s.world;
        for (piece, triangles) in in_pieces(scene, s.node, &layer, is_whole, triangles) {
            let triangles: Vec<[DVec3; 3]> =
                triangles.into_iter().map(|t| t.map(|p| m.transform_point3(p))).collect();
            if let Some(why) = without_place(&triangles) {
                lost.unread.push((s.node, why.into()));
                continue;
            }
            let heights = || triangles.iter().flatten().map(|p| p.z);
            let (low, high) =
                (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
            let held = elements.held(element).cloned();
            out.push(Body { shown: s, element, held, piece, layer: layer.clone(), triangles, low, high });
        }
    }
    lost.state(scene, report);
    out
}

/// Why what was read of an element stands nowhere.
fn without_place(triangles: &[[DVec3; 3]]) -> Option<&'static str> {
    let mut points = triangles.iter().flatten();
    let first = points.next()?;
    if triangles.iter().flatten().any(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_MAX) {
        return Some("it stands beyond all buildings (a coordinate or a transform is too large)");
    }
    points.all(|p| p == first).then_some("it has no size (a transform scales it to nothing)")
}

/// Elements of which nothing is shown.
#[derive(Default)]
struct Lost {
    /// Each with the reason.
    unread: Vec<(usize, String)>,
    /// Points and lines alone, each with its layer.
    lines: Vec<(usize, String)>,
}

impl Lost {
    fn state(self, scene: &File<'_>, report: &mut Report) {
        let by_name = WallLayers::new(&[]).ok();
        let is_wall = |layer: &str| by_name.as_ref().is_some_and(|w| w.reason(layer).is_some());
        let (walls, others): (Vec<_>, Vec<_>) = self.lines.into_iter().partition(|(_, l)| is_wall(l));
        let walls =
            walls.into_iter().map(|(n, _)| (n, "its mesh has points and lines alone, no faces".into()));
        let told: Vec<(usize, String)> = self.unread.into_iter().chain(walls).collect();
        let more = told.len().saturating_sub(values::TOLD);
        for (node, why) in told.into_iter().take(values::TOLD) {
            let place = Place::file(scene.name).entity(scene.named(node));
            report.warn("gltf-mesh", place, format!("{why}; it is left out"));
        }
        if more > 0 {
            let text = format!("{more} more elements cannot be read and are left out");
            report.warn("gltf-mesh", Place::file(scene.name), text);
        }
        if let Some((first, _)) = others.first() {
            let text = format!(
                "{} nodes have points and lines alone and are not shown, {} is the first",
                others.len(),
                scene.named(*first)
            );
            report.info("gltf-lines", Place::file(scene.name), text);
        }
    }
}

/// Names the walls of the storey that end below the cut.
fn state_low(scene: &File<'_>, bodies: &[Body<'_>], [floor, cut]: [f64; 2], report: &mut Report) {
    let by_name = WallLayers::new(&[]).ok();
    let is_wall = |b: &&Body<'_>| by_name.as_ref().is_some_and(|w| w.reason(&b.layer).is_some());
    let is_low = |b: &&Body<'_>| b.low < cut && b.high > floor && b.high <= cut;
    let low: Vec<&Body<'_>> = bodies.iter().filter(is_wall).filter(is_low).collect();
    if low.is_empty() {
        return;
    }
    let named: Vec<String> = low.iter().take(values::TOLD).map(|b| scene.named(b.shown.node)).collect();
    let more = if low.len() > named.len() { ", …" } else { "" };
    let text = format!(
        "{} walls do not reach the height of the cut and do not block sight: {}{more}",
        low.len(),
        named.join(", ")
    );
    report.info("gltf-not-cut", Place::file(scene.name), text);
}

/// What moves together: a node that says how it moves, with all that hangs on it, else every node for itself.
struct Elements<'f> {
    /// Node → where it is shown, and how often.
    places: BTreeMap<usize, (&'f Shown, usize)>,
    /// Node with a mesh → the node that it moves with.
    movers: BTreeMap<usize, usize>,
    /// Movers of more than themselves.
    wholes: BTreeSet<usize>,
    /// Elements that cannot move, and why.
    held: BTreeMap<usize, String>,
}

impl<'f> Elements<'f> {
    fn new(scene: &File<'_>, shown: &'f [Shown]) -> Self {
        let nodes = scene.json.list("nodes");
        let mut out = Self {
            places: BTreeMap::new(),
            movers: BTreeMap::new(),
            wholes: BTreeSet::new(),
            held: BTreeMap::new(),
        };
        for s in shown {
            out.places.entry(s.node).or_insert((s, 0)).1 += 1;
            if nodes[s.node].index("mesh").is_none() {
                continue;
            }
            let mover = marks::mover(scene, &s.path).unwrap_or(s.node);
            if mover != s.node {
                out.wholes.insert(mover);
            }
            out.movers.insert(s.node, mover);
        }
        let animated: BTreeSet<usize> = animated(&scene.json);
        for s in shown {
            let Some(mover) = out.movers.get(&s.node) else { continue };
            if [s.node, *mover].iter().any(|n| out.places.get(n).is_some_and(|p| p.1 > 1)) {
                out.held.insert(*mover, "its node hangs in the scene more than once".into());
            }
            let from = s.path.iter().position(|n| n == mover).unwrap_or(0);
            if let Some(why) = held(scene, &s.path, from, &animated) {
                out.held.entry(*mover).or_insert(why);
            }
        }
        out
    }

    /// The element that a node belongs to, and whether it moves as a whole.
    fn of(&self, s: &'f Shown) -> (&'f Shown, bool) {
        let mover = self.movers.get(&s.node).copied().unwrap_or(s.node);
        let place = self.places.get(&mover).map_or(s, |p| p.0);
        (place, self.wholes.contains(&mover))
    }

    fn held(&self, element: &Shown) -> Option<&String> {
        self.held.get(&element.node)
    }
}

/// Nodes that an animation moves.
fn animated(json: &Json) -> BTreeSet<usize> {
    let channels = json.list("animations").iter().flat_map(|a| a.list("channels"));
    channels.filter_map(|c| c.get("target")?.index("node")).collect()
}

/// Why what is shown at the end of a path cannot move with the node at `from` of it.
fn held(scene: &File<'_>, path: &[usize], from: usize, animated: &BTreeSet<usize>) -> Option<String> {
    let nodes = scene.json.list("nodes");
    let of_element = || path[from..].iter().map(|n| &nodes[*n]);
    let is_many = |n: &Json| n.get("extensions").is_some_and(|e| e.get("EXT_mesh_gpu_instancing").is_some());
    let is_unread = |n: &Json| {
        let odd =
            |key: &str, count: usize| n.get(key).is_some() && n.numbers(key).is_none_or(|v| v.len() != count);
        odd("matrix", 16) || odd("translation", 3) || odd("rotation", 4)
    };
    if marks::is_set(scene, path, "keep") {
        Some("extras.enfilade says keep".into())
    } else if path[from..].iter().any(|n| animated.contains(n)) {
        Some("it is animated".into())
    } else if of_element().any(|n| n.get("skin").is_some()) {
        Some("it follows a skeleton".into())
    } else if of_element().any(is_many) {
        Some("it is drawn many times by one node".into())
    } else if is_unread(&nodes[path[from]]) {
        Some("its transform cannot be read".into())
    } else {
        None
    }
}

/// A mesh whole, or, where it is named after walls and no class says that it is one element, its pieces.
fn in_pieces(
    scene: &File<'_>,
    node: usize,
    layer: &str,
    is_whole: bool,
    triangles: &[[DVec3; 3]],
) -> Vec<(Option<usize>, Vec<[DVec3; 3]>)> {
    let by_name = WallLayers::new(&[]).ok();
    let is_walls =
        !is_whole && !layer.starts_with("Ifc") && by_name.is_some_and(|w| w.reason(layer).is_some());
    let Some(pieces) = is_walls.then(|| scene.pieces(node, triangles)).flatten() else {
        return vec![(None, triangles.to_vec())];
    };
    let mut out: Vec<(Option<usize>, Vec<[DVec3; 3]>)> =
        (0..pieces.count).map(|p| (Some(p), Vec::new())).collect();
    for t in triangles {
        if let Some(of) = pieces.of(t[0]) {
            out[of].1.push(*t);
        }
    }
    out
}

/// What a node's name, its mesh's, its material's or its extras say it is.
fn layer(scene: &File<'_>, shown: &Shown, options: &ReadOptions) -> String {
    if let Some(class) = shown.names(scene).rev().find_map(|n| options.classes.get(n)) {
        return class_of(class);
    }
    let node = &scene.json.list("nodes")[shown.node];
    let mesh = node.index("mesh").and_then(|m| scene.json.list("meshes").get(m));
    let extras = |n: &usize| {
        let keys = ["ifcClass", "ifc_class", "IfcClass", "class", "type", "layer", "category"];
        let told = scene.json.list("nodes").get(*n)?.get("extras")?;
        keys.iter().find_map(|k| told.text(k)).map(class_of)
    };
    if let Some(told) = extras(&shown.node) {
        return told;
    }
    let named = shown.names(scene).rev().filter(|n| !n.is_empty()).map(class_of);
    let mesh_name = mesh.and_then(|m| m.text("name")).map(class_of);
    let materials =
        mesh.map(|m| m.list("primitives")).unwrap_or_default().iter().filter_map(|p| {
            scene.json.list("materials").get(p.index("material")?)?.text("name").map(class_of)
        });
    let of_wholes = shown.path.iter().rev().filter_map(extras);
    let all: Vec<String> = named.chain(mesh_name).chain(materials).chain(of_wholes).collect();
    let by_name = WallLayers::new(&[]).ok();
    let says = |n: &&String| {
        opening(n).is_some()
            || n.starts_with("Ifc")
            || by_name.as_ref().is_some_and(|w| w.reason(n).is_some())
    };
    all.iter().find(says).or(all.first()).cloned().unwrap_or_else(|| "unnamed".into())
}

/// `IfcWall` of `IfcWall/Wall_12`, `Cube` of `Cube.003`.
fn class_of(name: &str) -> String {
    let base = if name.starts_with("Ifc") { name.split('/').next().unwrap_or(name) } else { name };
    let short = base.trim_end_matches(|c: char| c.is_ascii_digit() || "._- ".contains(c));
    let class = if short.is_empty() { base } else { short };
    opening(class).map_or(class.to_string(), String::from)
}

fn opening(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let has = |words: &[&str]| lower.split(|c: char| !c.is_alphabetic()).any(|w| words.contains(&w));
    if lower.starts_with("ifcdoor") || has(&DOOR_WORDS) {
        Some("IfcDoor")
    } else if lower.starts_with("ifcwindow") || has(&WINDOW_WORDS) {
        Some("IfcWindow")
    } else {
        None
    }
}

/// Where no name says what is a wall and the user did not, the whole scene is what blocks sight.
fn choose_layers(scene: &File<'_>, bodies: &mut [Body<'_>], options: &ReadOptions, report: &mut Report) {
    let by_name = WallLayers::new(&[]).ok();
    let is_wall = |b: &Body<'_>| by_name.as_ref().is_some_and(|w| w.reason(&b.layer).is_some());
    if options.is_by_user || bodies.iter().any(is_wall) {
        return;
    }
    let is_id = |b: &&Body<'_>| b.shown.names(scene).any(is_global_id);
    let ids = bodies.iter().filter(is_id).count();
    let lacking = if 2 * ids > bodies.len() && options.classes.is_empty() {
        format!(
            "; {ids} of {} nodes are named by GlobalIds of an IFC and by nothing else: with that .ifc beside it under the same \
             name walls, doors, windows, spaces and storeys are known, without it none of them",
            bodies.len()
        )
    } else {
        String::new()
    };
    let text = format!(
        "no node, mesh or material is named after walls; everything that is cut blocks sight{lacking}; --wall-layer NAME picks \
         by name"
    );
    let place = Place::file(scene.name);
    if lacking.is_empty() {
        report.info("walls-assumed", place, text);
    } else {
        report.warn("walls-assumed", place, text);
    }
    bodies.iter_mut().for_each(|b| b.layer = SCENE_LAYER.into());
}

/// Whether a name is the `GlobalId` of an element of an IFC: 22 letters of its own 64, the first of two bits.
pub fn is_global_id(name: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || "_$".contains(c);
    name.len() == 22 && name.starts_with(['0', '1', '2', '3']) && name.chars().all(is_letter)
}

/// The height above which most walls are cut: where walls start most often; `above` in units of the scene.
fn floor(bodies: &[Body<'_>], metres: f64, above: f64) -> f64 {
    let by_name = WallLayers::new(&[]).ok();
    let is_wall = |b: &&Body<'_>| {
        b.layer == SCENE_LAYER || by_name.as_ref().is_some_and(|w| w.reason(&b.layer).is_some())
    };
    let walls: Vec<&Body<'_>> = bodies.iter().filter(is_wall).collect();
    let walls: Vec<&Body<'_>> = if walls.is_empty() { bodies.iter().collect() } else { walls };
    // Where no name tells, what is as high as a storey does: furniture and footings do not.
    let is_unnamed = walls.iter().any(|b| b.layer == SCENE_LAYER);
    let high = |b: &&Body<'_>| (b.high - b.low) * metres >= STOREY_HIGH_M;
    let tall: Vec<&Body<'_>> = walls.iter().copied().filter(|b| is_unnamed && high(b)).collect();
    let walls = if tall.is_empty() { walls } else { tall };
    let cut = |floor: f64| walls.iter().filter(|b| b.low < floor + above && b.high > floor + above).count();
    let near = |floor: f64| walls.iter().filter(|b| (b.low - floor).abs() < FLOOR_M / metres).count();
    let mut floors: Vec<f64> = walls.iter().map(|b| b.low).collect();
    floors.sort_by(f64::total_cmp);
    floors.dedup_by(|a, b| (*a - *b).abs() < 1e-6 / metres);
    floors
        .into_iter()
        .max_by(|a, b| (cut(*a), near(*a)).cmp(&(cut(*b), near(*b))).then(b.total_cmp(a)))
        .unwrap_or(0.0)
}

fn show(scene: &File<'_>, body: &Body<'_>, z: f64, options: &ReadOptions, out: &mut Vec<Entity>) {
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
        });
    }
    let (path, shown) = (&body.shown.path, first..out.len());
    for (key, mark) in [("query", "EF-QUERY"), ("reference", "EF-REFERENCE"), ("keep", "EF-KEEP")] {
        if marks::is_set(scene, path, key) && (key != "keep" || body.layer == "IfcSpace") {
            let copies = out[shown.clone()].iter().map(|e| Entity { layer: mark.into(), ..e.clone() });
            let copies: Vec<Entity> = copies.collect();
            out.extend(copies);
        }
        if let Some(name) = marks::text(scene, path, key).filter(|_| key != "keep") {
            let layer = format!("{mark}-{name}");
            let copies = out[shown.clone()].iter().map(|e| Entity { layer: layer.clone(), ..e.clone() });
            let copies: Vec<Entity> = copies.collect();
            out.extend(copies);
        }
    }
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
    Editable::WithInsert { turnable: node.get("matrix").is_some() || is_similar(&m) }
}

/// Whether a matrix turns and scales alike in all directions.
fn is_similar(m: &DMat3) -> bool {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let size = x.length();
    let even = (y.length() - size).abs() < 1e-9 * size && (z.length() - size).abs() < 1e-9 * size;
    let square = [x.dot(y), y.dot(z), z.dot(x)].iter().all(|d| d.abs() < 1e-9 * size * size);
    even && square && m.determinant() > 0.0
}
