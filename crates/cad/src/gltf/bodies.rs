//! What a scene shows: meshes as bodies, what each is by its name, what moves together, and what is left out.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::{DAffine3, DVec3};

use super::body::Body;
use super::instances;
use super::json::Json;
use super::meshes::Why;
use super::motion::z_up;
use super::scene::{File, Shown};
use super::{ReadOptions, marks, values};
pub(super) use crate::ifc::SPACE_LAYER;
use crate::layers::WallLayers;
use enfilade_report::{Place, Report};

/// Layer of everything where no name says what is a wall.
pub(super) const SCENE_LAYER: &str = "scene";

/// Coordinates beyond this are slips or damage, units of the scene: a scene in millimetres that stands at its place on
/// the map has 1e10.
const COORDINATE_MAX: f64 = 1e12;

/// Glass and door leaves: they close a gap and do not block sight.
const DOOR_WORDS: [&str; 6] = ["door", "doors", "tür", "porte", "porta", "puerta"];
const WINDOW_WORDS: [&str; 7] = ["window", "windows", "fenster", "fenetre", "finestra", "ventana", "glass"];

/// What a scene shows, and which nodes show nothing though they have a mesh.
pub(super) struct Bodies<'f> {
    /// What it shows.
    pub list: Vec<Body<'f>>,
    /// Nodes that are left out: their meshes cannot be read, have no faces or stand nowhere.
    pub lost: BTreeSet<usize>,
}

/// Whether names are those of walls; each is looked at once.
#[derive(Default)]
struct Names(HashMap<String, bool>);

impl Names {
    fn is_wall(&mut self, layer: &str) -> bool {
        if let Some(known) = self.0.get(layer) {
            return *known;
        }
        let is_wall = WallLayers::new(&[]).ok().is_some_and(|w| w.reason(layer).is_some());
        self.0.insert(layer.to_string(), is_wall);
        is_wall
    }
}

/// Reads all meshes that are shown; what cannot be read is named and left out.
pub(super) fn bodies<'f>(
    scene: &File<'_>,
    shown: &'f [Shown],
    options: &ReadOptions,
    report: &mut Report,
) -> Bodies<'f> {
    let nodes = scene.json.list("nodes");
    let mut meshes: BTreeMap<usize, Result<Vec<[DVec3; 3]>, Why>> = BTreeMap::new();
    let mut out = Vec::new();
    let (mut lost, mut names) = (Lost::default(), Names::default());
    let (elements, mut many) = (Elements::new(scene, shown), instances::Count::default());
    for s in shown {
        let Some(mesh) = nodes[s.node].index("mesh").filter(|_| !s.is_own()) else {
            continue;
        };
        let layer = layer(scene, s, options, &mut names);
        let is_wall = names.is_wall(&layer);
        let triangles = match meshes.entry(mesh).or_insert_with(|| scene.triangles(mesh)) {
            Ok(triangles) => triangles,
            Err((pointer, why)) => {
                let why = format!("mesh {mesh} cannot be read: {pointer}: {why}");
                lost.unread.push((s, why));
                continue;
            }
        };
        if triangles.is_empty() {
            lost.lines.push((s, is_wall));
            continue;
        }
        let instances = match instances::places(scene, s.node, &mut many, triangles.len()) {
            Ok(instances) => instances,
            Err((pointer, why)) => {
                lost.unread.push((s, format!("its instances cannot be read: {pointer}: {why}")));
                continue;
            }
        };
        let (element, is_whole) = elements.of(s);
        let has_pieces = is_wall && !is_whole && !layer.starts_with("Ifc") && instances.is_none();
        let places = instances.unwrap_or_else(|| vec![DAffine3::IDENTITY]);
        for (piece, triangles) in in_pieces(scene, s.node, has_pieces, triangles) {
            for place in &places {
                match placed(&triangles, &(z_up() * s.world * *place)) {
                    Ok((triangles, [low, high])) => {
                        let (held, layer) = (elements.held(element).cloned(), layer.clone());
                        out.push(Body {
                            shown: s,
                            element,
                            held,
                            piece,
                            layer,
                            is_wall,
                            triangles,
                            low,
                            high,
                        });
                    }
                    Err(why) => lost.unread.push((s, why.into())),
                }
            }
        }
    }
    choose_layers(scene, &mut out, options, report);
    Bodies { list: out, lost: lost.state(scene, options, report) }
}

/// Faces of a mesh where a transform puts them, and between which heights.
type Placed = (Vec<[DVec3; 3]>, [f64; 2]);

/// A mesh in its place.
///
/// # Errors
/// Why it stands nowhere.
fn placed(triangles: &[[DVec3; 3]], to: &DAffine3) -> Result<Placed, &'static str> {
    let placed: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|p| to.transform_point3(p))).collect();
    if let Some(why) = without_place(triangles, &placed) {
        return Err(why);
    }
    let heights = || placed.iter().flatten().map(|p| p.z);
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    Ok((placed, [low, high]))
}

/// Why what was read of an element stands nowhere.
fn without_place(own: &[[DVec3; 3]], placed: &[[DVec3; 3]]) -> Option<&'static str> {
    let is_point = |triangles: &[[DVec3; 3]]| {
        let mut points = triangles.iter().flatten();
        points.next().is_some_and(|first| points.all(|p| p == first))
    };
    if placed.iter().flatten().any(|p| !p.is_finite() || p.abs().max_element() > COORDINATE_MAX) {
        Some("it stands beyond all buildings (a coordinate or a transform is too large)")
    } else if is_point(own) {
        Some("it has no size (all corners of its mesh are one point)")
    } else {
        is_point(placed).then_some("it has no size (a transform scales it to nothing)")
    }
}

/// Elements of which nothing is shown.
#[derive(Default)]
struct Lost<'f> {
    /// Each with the reason.
    unread: Vec<(&'f Shown, String)>,
    /// Points and lines alone, each with whether it is a wall.
    lines: Vec<(&'f Shown, bool)>,
}

impl Lost<'_> {
    /// Names those that stand in the storey that is read, or in none that is known; returns the nodes of all.
    fn state(self, scene: &File<'_>, options: &ReadOptions, report: &mut Report) -> BTreeSet<usize> {
        let nodes = self.unread.iter().map(|l| l.0.node).chain(self.lines.iter().map(|l| l.0.node)).collect();
        let (walls, others): (Vec<_>, Vec<_>) = self.lines.into_iter().partition(|(_, is_wall)| *is_wall);
        let walls =
            walls.into_iter().map(|(s, _)| (s, "its mesh has points and lines alone, no faces".into()));
        let is_elsewhere = options.elsewhere(scene);
        let told: Vec<(&Shown, String)> =
            self.unread.into_iter().chain(walls).filter(|l| !is_elsewhere(l.0)).collect();
        let more = told.len().saturating_sub(values::TOLD);
        for (shown, why) in told.into_iter().take(values::TOLD) {
            let place = Place::file(scene.name).entity(scene.named(shown.node));
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
                scene.named(first.node)
            );
            report.info("gltf-lines", Place::file(scene.name), text);
        }
        nodes
    }
}

/// What moves together: a node that says how it moves, with all that hangs on it, else every node for itself.
struct Elements<'f> {
    /// Node → where it is shown, and how often.
    places: BTreeMap<usize, (&'f Shown, usize)>,
    /// Node with a mesh → the node that it moves with.
    movers: BTreeMap<usize, usize>,
    /// Nodes that say how they move: each moves as one, whether its mesh has pieces or others hang on it.
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
            let mover = marks::mover(scene, &s.path());
            out.wholes.extend(mover);
            out.movers.insert(s.node, mover.unwrap_or(s.node));
        }
        let animated: BTreeSet<usize> = animated(&scene.json);
        for s in shown {
            let Some(mover) = out.movers.get(&s.node) else { continue };
            if [s.node, *mover].iter().any(|n| out.places.get(n).is_some_and(|p| p.1 > 1)) {
                out.held.insert(*mover, "its node hangs in the scene more than once".into());
            }
            let path = s.path();
            let from = path.iter().position(|n| n == mover).unwrap_or(0);
            if let Some(why) = held(scene, &path, from, &animated) {
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
    let is_unread = |n: &Json| {
        let odd =
            |key: &str, count: usize| n.get(key).is_some() && n.numbers(key).is_none_or(|v| v.len() != count);
        let is_odd_row = values::odd_row(n).is_some();
        is_odd_row || odd("matrix", 16) || odd("translation", 3) || odd("rotation", 4)
    };
    if marks::is_set(scene, path, "keep") {
        Some("extras.enfilade says keep".into())
    } else if path[from..].iter().any(|n| animated.contains(n)) {
        Some("it is animated".into())
    } else if of_element().any(|n| n.get("skin").is_some()) {
        Some("it follows a skeleton".into())
    } else if of_element().any(instances::is_many) {
        Some(instances::WHY.into())
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
    has_pieces: bool,
    triangles: &[[DVec3; 3]],
) -> Vec<(Option<usize>, Vec<[DVec3; 3]>)> {
    let Some(pieces) = has_pieces.then(|| scene.pieces(node, triangles)).flatten() else {
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
fn layer(scene: &File<'_>, shown: &Shown, options: &ReadOptions, walls: &mut Names) -> String {
    // What hangs on a wall and says itself what it is belongs to no class of the wall.
    let mut says_itself = false;
    let mut told =
        shown.names(scene).rev().take_while(|n| !std::mem::replace(&mut says_itself, n.starts_with("Ifc")));
    if let Some(class) = told.find_map(|n| options.known().classes.get(n)) {
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
    let path = shown.path();
    let of_wholes = path.iter().rev().filter_map(extras);
    let all: Vec<String> = named.chain(mesh_name).chain(materials).chain(of_wholes).collect();
    let mut says = |n: &&String| opening(n).is_some() || n.starts_with("Ifc") || walls.is_wall(n);
    all.iter().find(|n| says(n)).or(all.first()).cloned().unwrap_or_else(|| "unnamed".into())
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
    if options.is_by_user || bodies.iter().any(|b| b.is_wall) {
        return;
    }
    let is_id = |b: &&Body<'_>| b.shown.names(scene).any(is_global_id);
    let ids = bodies.iter().filter(is_id).count();
    let is_of_ifc = 2 * ids > bodies.len();
    let lacking = if is_of_ifc && options.known().classes.is_empty() {
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
    for body in bodies {
        let path = body.shown.path();
        let is_region = |key| marks::region(scene, &path, key).is_some();
        let is_room = ["query", "reference"].into_iter().any(is_region) || is_of_ifc && body.is_room();
        body.layer = if is_room { SPACE_LAYER } else { SCENE_LAYER }.into();
    }
}

/// Whether a name is the `GlobalId` of an element of an IFC: 22 letters of its own 64, the first of two bits.
pub fn is_global_id(name: &str) -> bool {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || "_$".contains(c);
    name.len() == 22 && name.starts_with(['0', '1', '2', '3']) && name.chars().all(is_letter)
}
