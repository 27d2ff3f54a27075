//! A scene as a plan: meshes cut at the height of the eyes.

use std::collections::BTreeMap;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::json::{Json, Value};
use super::pieces::{of_record, record};
use super::scene::{File, Shown};
use super::{CUT_EYE_M, CUT_KNEE_M, ReadOptions};
use crate::formats::StoreyInfo;
use crate::formats::region::{Region, slice};
use crate::plan::drawing::{
    Drawing, Editable, Entity, Format, Layer, MarkedMove, Shape, SourceRef, Text, Unit, Vertex,
};
use crate::plan::layers::{self, WallLayers};
use crate::plan::units::implausible_by_heights;
use crate::report::{Error, Place, Report};

/// Layer of everything where no name says what is a wall.
const SCENE_LAYER: &str = "scene";

/// The unit of the standard.
const METRE: Unit = Unit { name: "m", metres: 1.0 };

/// Floors nearer than this are one.
const FLOOR_M: f64 = 0.05;

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
    /// Whether the node hangs in the scene at one place alone, as the standard wants.
    is_once: bool,
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
        report.warn("gltf-nodes", Place::file(file), format!("{text}; left out"));
    }
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
    let above = above(options) / scale.metres;
    let floor = chosen_floor(file, &bodies, options, &scale, report)?;
    let mut entities = Vec::new();
    for body in &bodies {
        show(&scene, body, floor + above, options, &mut entities);
    }
    let (texts, marked) = (space_names(&bodies, &entities), marked_moves(&scene, &entities));
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
        declared_unit_words: "the standard (metres, Y up)".into(),
        unit_by_heights: scale.by_heights,
        layers: names,
        entities,
        texts,
        marked,
        hosts: BTreeMap::new(),
        undrawn: Vec::new(),
        fills: Vec::new(),
    })
}

/// In what a scene measures.
struct Scale {
    /// Metres in one unit.
    metres: f64,
    /// The unit, where the walls cannot be as high as they are in metres.
    by_heights: Option<Unit>,
}

impl Scale {
    fn of(bodies: &[Body<'_>], options: &ReadOptions) -> Self {
        if let Some(unit) = options.unit {
            return Self { metres: unit.metres, by_heights: None };
        }
        let by_name = WallLayers::new(&[]).ok();
        let is_wall = |b: &&Body<'_>| by_name.as_ref().is_some_and(|w| w.reason(&b.layer).is_some());
        let heights: Vec<f64> = bodies.iter().filter(is_wall).map(|b| b.high - b.low).collect();
        let by_heights = implausible_by_heights(&heights, METRE);
        Self { metres: by_heights.unwrap_or(METRE).metres, by_heights }
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
    let shown = |s: &StoreyInfo| format!("{:?} (floor {:.3} m, {} walls)", s.name, s.floor_m, s.walls);
    let names = options.storeys.iter().map(shown).collect::<Vec<_>>().join(", ");
    let wanted = options.storey.as_deref();
    let found = match wanted {
        Some(name) => options.storeys.iter().find(|s| s.name.eq_ignore_ascii_case(name)),
        None => options.storeys.iter().rev().max_by_key(|s| s.walls),
    };
    if let (None, Some(name)) = (found, wanted) {
        let names = if names.is_empty() {
            "none (glTF has none; the .ifc of the same name beside it has)"
        } else {
            &names
        };
        let text = format!("--storey {name:?}: no such storey, storeys present: {names}; nothing was done");
        return Err(Error::usage("storey", Place::file(file), text));
    }
    Ok(match found {
        Some(storey) => {
            let text = format!(
                "storeys by the IFC beside it: {names}; {:?} cut {above} m above its floor at {:.3} m",
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
fn space_names(bodies: &[Body<'_>], entities: &[Entity]) -> Vec<Text> {
    let mut out = Vec::new();
    for body in bodies.iter().filter(|b| b.layer == "IfcSpace") {
        let Some(own) = entities.iter().find(|e| e.source.record == body.shown.node) else { continue };
        let Shape::Polyline { vertices, .. } = &own.shape else { continue };
        let Some([lo, hi]) = crate::plan::box_of(vertices.iter().map(|v| v.at)) else { continue };
        let name = body.shown.names.last().map_or("", |n| n.strip_prefix("IfcSpace/").unwrap_or(n));
        out.push(Text {
            source: own.source.clone(),
            layer: "IfcSpace".into(),
            at: lo.midpoint(hi),
            text: name.into(),
        });
    }
    out
}

/// What a node says of itself in `extras.enfilade`.
fn told(node: &Json) -> Option<&Json> {
    node.get("extras")?.get("enfilade")
}

fn is_set(told: Option<&Json>, key: &str) -> bool {
    told.and_then(|t| t.get(key)).is_some_and(|v| v.value == Value::Bool(true))
}

/// Moves that nodes state of themselves: `"extras": {"enfilade": {"move": "x -1 1", "name": "screen"}}`.
fn marked_moves(scene: &File<'_>, entities: &[Entity]) -> Vec<MarkedMove> {
    let nodes = scene.json.list("nodes");
    let mut out: Vec<MarkedMove> = Vec::new();
    for e in entities {
        let told = told(&nodes[of_record(e.source.record).0]);
        let Some(text) = told.and_then(|t| t.text("move")).filter(|t| !t.trim().is_empty()) else { continue };
        if out.iter().any(|m| m.record == e.source.record) {
            continue;
        }
        let name = told.and_then(|t| t.text("name")).unwrap_or(&e.source.kind);
        out.push(MarkedMove {
            name: name.into(),
            text: text.into(),
            record: e.source.record,
            source: e.source.clone(),
        });
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
    let mut meshes: BTreeMap<usize, Vec<[DVec3; 3]>> = BTreeMap::new();
    let mut out = Vec::new();
    let mut times: BTreeMap<usize, usize> = BTreeMap::new();
    shown.iter().for_each(|s| *times.entry(s.node).or_default() += 1);
    for s in shown {
        let Some(mesh) = nodes[s.node].index("mesh") else { continue };
        if s.names.iter().any(|n| layers::is_own(n)) {
            continue;
        }
        if let std::collections::btree_map::Entry::Vacant(slot) = meshes.entry(mesh) {
            match scene.triangles(mesh) {
                Ok(t) => drop(slot.insert(t)),
                Err((pointer, why)) => {
                    let place = Place::file(scene.name).entity(pointer);
                    report.warn("gltf-mesh", place, format!("{why}; mesh {mesh} is left out"));
                    slot.insert(Vec::new());
                }
            }
        }
        let layer = layer(scene, s, options);
        let m = z_up() * s.world;
        for (piece, triangles) in in_pieces(scene, s.node, &layer, &meshes[&mesh]) {
            let triangles: Vec<[DVec3; 3]> =
                triangles.into_iter().map(|t| t.map(|p| m.transform_point3(p))).collect();
            let heights = || triangles.iter().flatten().map(|p| p.z);
            let (low, high) =
                (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
            if low.is_finite() && high.is_finite() {
                let is_once = times[&s.node] == 1;
                out.push(Body { shown: s, is_once, piece, layer: layer.clone(), triangles, low, high });
            }
        }
    }
    out
}

/// A mesh whole, or, where it is named after walls and no class says that it is one element, its pieces.
fn in_pieces(
    scene: &File<'_>,
    node: usize,
    layer: &str,
    triangles: &[[DVec3; 3]],
) -> Vec<(Option<usize>, Vec<[DVec3; 3]>)> {
    let by_name = WallLayers::new(&[]).ok();
    let is_walls = !layer.starts_with("Ifc") && by_name.is_some_and(|w| w.reason(layer).is_some());
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
    if let Some(class) = shown.names.iter().rev().find_map(|n| options.classes.get(n)) {
        return class_of(class);
    }
    let node = &scene.json.list("nodes")[shown.node];
    let mesh = node.index("mesh").and_then(|m| scene.json.list("meshes").get(m));
    let extras = ["ifcClass", "ifc_class", "IfcClass", "class", "type", "layer", "category"];
    let told = extras.iter().find_map(|k| node.get("extras")?.text(k));
    if let Some(told) = told {
        return class_of(told);
    }
    let named = shown.names.iter().rev().filter(|n| !n.is_empty()).map(|n| class_of(n));
    let mesh_name = mesh.and_then(|m| m.text("name")).map(class_of);
    let materials =
        mesh.map(|m| m.list("primitives")).unwrap_or_default().iter().filter_map(|p| {
            scene.json.list("materials").get(p.index("material")?)?.text("name").map(class_of)
        });
    let all: Vec<String> = named.chain(mesh_name).chain(materials).collect();
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
    let text = "no node, mesh or material is named after walls; everything that is cut blocks sight; --wall-layer NAME picks by name";
    report.info("walls-assumed", Place::file(scene.name), text);
    bodies.iter_mut().for_each(|b| b.layer = SCENE_LAYER.into());
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
    let source = SourceRef {
        record: record(body.shown.node, body.piece),
        handle: Some(format!("/nodes/{}", body.shown.node)),
        line: 0,
        kind: body.shown.names.iter().rev().find(|n| !n.is_empty()).cloned().unwrap_or_default(),
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
    let (marks, shown) = (told(&scene.json.list("nodes")[body.shown.node]), first..out.len());
    for (key, mark) in [("query", "EF-QUERY"), ("reference", "EF-REFERENCE"), ("keep", "EF-KEEP")] {
        if is_set(marks, key) && (key != "keep" || body.layer == "IfcSpace") {
            let copies = out[shown.clone()].iter().map(|e| Entity { layer: mark.into(), ..e.clone() });
            let copies: Vec<Entity> = copies.collect();
            out.extend(copies);
        }
        let pair = marks.and_then(|t| t.text(key)).map(str::trim).filter(|n| !n.is_empty() && key != "keep");
        if let Some(name) = pair {
            let layer = format!("{mark}-{name}");
            let copies = out[shown.clone()].iter().map(|e| Entity { layer: layer.clone(), ..e.clone() });
            let copies: Vec<Entity> = copies.collect();
            out.extend(copies);
        }
    }
}

fn editable(scene: &File<'_>, body: &Body<'_>) -> Editable {
    let node = &scene.json.list("nodes")[body.shown.node];
    let animated = scene
        .json
        .list("animations")
        .iter()
        .flat_map(|a| a.list("channels"))
        .any(|c| c.get("target").and_then(|t| t.index("node")) == Some(body.shown.node));
    if is_set(told(node), "keep") {
        return Editable::No("extras.enfilade says keep".into());
    }
    if !body.is_once {
        return Editable::No("its node hangs in the scene more than once".into());
    }
    if animated {
        return Editable::No("it is animated".into());
    }
    if node.get("skin").is_some() {
        return Editable::No("it follows a skeleton".into());
    }
    if node.get("extensions").is_some_and(|e| e.get("EXT_mesh_gpu_instancing").is_some()) {
        return Editable::No("it is drawn many times by one node".into());
    }
    if body.piece.is_some() {
        return Editable::WithInsert { turnable: true };
    }
    let m = body.shown.parent.matrix3;
    let det = m.determinant();
    if det == 0.0 || !det.is_finite() {
        return Editable::No("its parent has no size".into());
    }
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
