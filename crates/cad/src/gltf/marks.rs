//! What nodes say of themselves in `extras.enfilade`, and for all that hangs on them.

use std::collections::{BTreeMap, BTreeSet};

use super::body::Body;
use super::json::{Json, Value};
use super::record::of_record;
use super::scene::{File, Shown};
use super::values::TOLD;
use crate::drawing::{Entity, IdleMarks, MarkedMove};
use crate::own_layers;
use crate::phase::Phase;
use enfilade_report::{Place, Report};

/// What may be said there, and as what.
const KEYS: [(&str, &str); 9] = [
    ("move", "a text such as \"x -1 1\""),
    ("name", "a text"),
    ("keep", "true or false"),
    ("query", "true, false or the name of a pair"),
    ("reference", "true, false or the name of a pair"),
    ("open", "true, \"door\", \"door 0.9m\" or \"glass\""),
    ("remove", "true or false"),
    ("new", "true or false"),
    ("status", "\"existing\", \"new\" or \"demolish\""),
];

/// Marks of decided works, each with its layer.
const WORKS: [(&str, &str); 3] =
    [("open", own_layers::OPEN), ("remove", own_layers::REMOVE), ("new", own_layers::NEW)];

/// The decided work that a node marks with its outline: its layer, and what is said of it.
pub(super) fn work<'j>(scene: &'j File<'_>, path: &[usize]) -> Option<(&'static str, Option<&'j str>)> {
    WORKS.iter().find_map(|(key, layer)| Some((*layer, region(scene, path, key)?.1)))
}

/// What a node, or what it hangs on, says of when it stands.
pub(super) fn status(scene: &File<'_>, path: &[usize]) -> Phase {
    let said = nearest(scene, path, "status").and_then(|(_, v)| word(v));
    match said.as_deref() {
        Some("demolish") => Phase::Demolished,
        Some("new") => Phase::New,
        _ => Phase::Existing,
    }
}

fn word(json: &Json) -> Option<String> {
    if let Value::Text(text) = &json.value { Some(text.trim().to_lowercase()) } else { None }
}

/// Whether what something says of itself is that it was demolished.
fn is_demolished(told: &Json) -> bool {
    told.get("status").and_then(word).as_deref() == Some("demolish")
}

/// Members of what we write on nodes of ours.
const OWN_KEYS: [&str; 2] = ["layer", "note"];

/// What a node itself says, then what its mesh does: programs write marks of an object's data there.
fn tellers<'j>(scene: &'j File<'_>, node: usize) -> impl Iterator<Item = &'j Json> {
    let node = scene.json.list("nodes").get(node);
    let mesh = node.and_then(|n| scene.json.list("meshes").get(n.index("mesh")?));
    [node, mesh].into_iter().flatten().filter_map(teller)
}

/// One thing that a node says, and that node: the nearest word on the way from the node to the root counts.
fn nearest<'j>(scene: &'j File<'_>, path: &[usize], key: &str) -> Option<(usize, &'j Json)> {
    path.iter().rev().find_map(|n| Some((*n, tellers(scene, *n).find_map(|t| t.get(key))?)))
}

/// Whether a node, or what it hangs on, says yes.
pub(super) fn is_set(scene: &File<'_>, path: &[usize], key: &str) -> bool {
    nearest(scene, path, key).is_some_and(|(_, v)| v.value == Value::Bool(true))
}

/// Whether a node, or what it hangs on, makes it a region: the node that says so, and the name of the pair.
pub(super) fn region<'j>(scene: &'j File<'_>, path: &[usize], key: &str) -> Option<(usize, Option<&'j str>)> {
    let (node, said) = nearest(scene, path, key)?;
    match &said.value {
        Value::Bool(true) => Some((node, None)),
        Value::Text(text) => Some(text.trim()).filter(|t| !t.is_empty()).map(|t| (node, Some(t))),
        _ => None,
    }
}

/// How a node itself says that it moves. A text in place of the object is the move: programs whose properties are
/// flat can say it so. Something else than a text is told as it stands, so that it is named and not made up for.
pub(super) fn own_move(scene: &File<'_>, node: usize) -> Option<String> {
    let said = tellers(scene, node).find_map(|told| match &told.value {
        Value::Text(text) => Some(text.clone()),
        _ => match &told.get("move")?.value {
            Value::Text(text) => Some(text.clone()),
            _ => Some(told.get("move")?.words()),
        },
    })?;
    Some(said).filter(|t| !t.trim().is_empty())
}

/// The name that a node gives its move.
pub(super) fn own_name<'j>(scene: &'j File<'_>, node: usize) -> Option<&'j str> {
    tellers(scene, node).find_map(|t| t.text("name")).map(str::trim).filter(|t| !t.is_empty())
}

/// The first node on the way from the root that says how it moves: all that hangs on it moves with it.
pub(super) fn mover(scene: &File<'_>, path: &[usize]) -> Option<usize> {
    path.iter().copied().find(|n| own_move(scene, *n).is_some())
}

/// What became of the marks.
pub(super) struct Used {
    /// Nodes whose moves are used.
    moved: BTreeSet<usize>,
    /// Nodes that show something, by themselves or by what hangs on them, at whatever height.
    standing: BTreeSet<usize>,
    /// Those of them that are cut.
    cut: BTreeSet<usize>,
    /// Nodes of which what is shown cannot be read.
    lost: BTreeSet<usize>,
    /// Nodes that say that they are regions, each with the word, of which regions were made.
    regions: BTreeSet<(usize, &'static str)>,
}

impl Used {
    /// Gathers it.
    pub fn new(
        bodies: &[Body<'_>],
        lost: BTreeSet<usize>,
        entities: &[Entity],
        marked: &[MarkedMove],
        regions: BTreeSet<(usize, &'static str)>,
    ) -> Self {
        let node = |record: usize| of_record(record).0;
        Self {
            moved: marked.iter().map(|m| node(m.record)).collect(),
            standing: bodies.iter().flat_map(|b| b.shown.path()).collect(),
            cut: entities.iter().map(|e| node(e.source.record)).collect(),
            lost,
            regions,
        }
    }
}

/// Says which marks cannot be read, and which are not used, of what does not stand in another storey; whether one of
/// them says, or was meant to say, what moves or stays and cannot be used.
pub(super) fn state(
    scene: &File<'_>,
    shown: &[Shown],
    used: &Used,
    is_elsewhere: &dyn Fn(&Shown) -> bool,
    report: &mut Report,
) -> IdleMarks {
    let mut idle = Idle::default();
    idle.add_elsewhere(scene);
    idle.add_unshown(scene, shown);
    idle.add_misspelt(scene);
    let is_lost = |s: &&Shown| used.lost.contains(&s.node);
    let lost: BTreeSet<usize> = shown.iter().filter(is_lost).flat_map(Shown::path).collect();
    let mut seen = BTreeSet::new();
    for s in shown.iter().filter(|s| !s.is_own() && seen.insert(s.node)) {
        if tellers(scene, s.node).next().is_some() && !is_elsewhere(s) {
            idle.add_node(scene, s, used, &lost);
        }
    }
    state_away(scene, &idle.away, used.moved.is_empty(), report);
    let mut odd = idle.odd;
    odd.extend(same_names(scene, used));
    let more = odd.len().saturating_sub(TOLD);
    for (place, text) in odd.into_iter().take(TOLD) {
        report.warn("gltf-marks", Place::file(scene.name).entity(place), text);
    }
    if more > 0 {
        let text = format!("{more} more marks in extras.enfilade cannot be used");
        report.warn("gltf-marks", Place::file(scene.name), text);
    }
    if idle.decides { IdleMarks::Unusable } else { IdleMarks::None }
}

/// Marks that are not used.
#[derive(Default)]
struct Idle {
    /// Places, each with what is wrong there.
    odd: Vec<(String, String)>,
    /// Nodes that say how they move and of which nothing is cut.
    away: Vec<usize>,
    /// Whether one of all these says what moves or stays, or was meant to.
    decides: bool,
}

impl Idle {
    fn add(&mut self, place: String, text: String, decides: bool) {
        self.odd.push((place, text));
        self.decides |= decides;
    }

    /// What a node says and what is not used of it.
    fn add_node(&mut self, scene: &File<'_>, s: &Shown, used: &Used, lost: &BTreeSet<usize>) {
        for told in tellers(scene, s.node) {
            self.decides |= is_unclear(told);
            self.odd.extend(unreadable(told).into_iter().map(|text| (scene.named(s.node), text)));
        }
        self.odd.extend(idle_regions(scene, s, used).into_iter().map(|text| (scene.named(s.node), text)));
        if own_move(scene, s.node).is_none() || used.moved.contains(&s.node) {
            return;
        }
        self.decides = true;
        let why = match mover(scene, &s.path()).filter(|m| *m != s.node) {
            Some(other) => {
                format!("it hangs on {}, which moves by a mark of its own", scene.named(other))
            }
            None if used.standing.contains(&s.node) => {
                self.away.push(s.node);
                return;
            }
            None if lost.contains(&s.node) => "what it shows is left out".into(),
            None => "neither it nor what hangs on it shows a mesh".into(),
        };
        let text = format!("the move that extras.enfilade states is not used: {why}");
        self.odd.push((scene.named(s.node), text));
    }

    /// Marks on what is neither a node nor a mesh.
    fn add_elsewhere(&mut self, scene: &File<'_>) {
        let mut found: Vec<(String, &Json)> = Vec::new();
        for list in ["scenes", "materials", "cameras", "skins", "animations", "textures", "images"] {
            let all = scene.json.list(list).iter().enumerate();
            found.extend(all.filter_map(|(i, j)| Some((format!("/{list}/{i}"), teller(j)?))));
        }
        for (i, mesh) in scene.json.list("meshes").iter().enumerate() {
            let all = mesh.list("primitives").iter().enumerate();
            let place = |k: usize| format!("/meshes/{i}/primitives/{k}");
            found.extend(all.filter_map(|(k, p)| Some((place(k), teller(p)?))));
        }
        let text = "found extras.enfilade, expected it on a node or on its mesh; nothing is marked by it";
        found.into_iter().for_each(|(place, told)| self.add(place, text.into(), decides(told)));
    }

    /// Marks on nodes and meshes that the scene does not show.
    fn add_unshown(&mut self, scene: &File<'_>, shown: &[Shown]) {
        let nodes = scene.json.list("nodes");
        let of_scene: BTreeSet<usize> = shown.iter().map(|s| s.node).collect();
        let meshes: BTreeSet<usize> = of_scene.iter().filter_map(|n| nodes[*n].index("mesh")).collect();
        let text = "found extras.enfilade where the scene shows nothing; nothing is marked by it";
        for (i, told) in nodes.iter().enumerate().filter_map(|(i, n)| Some((i, teller(n)?))) {
            // What was demolished hangs in no list any more.
            let is_gone = is_demolished(told);
            let is_own = own_layers::is_own(nodes[i].text("name").unwrap_or_default());
            if !of_scene.contains(&i) && !is_own && !is_gone {
                self.add(scene.named(i), text.into(), decides(told));
            }
        }
        let all = scene.json.list("meshes").iter().enumerate().filter(|(i, _)| !meshes.contains(i));
        for (i, told) in all.filter_map(|(i, m)| Some((i, teller(m)?))) {
            self.add(format!("/meshes/{i}"), text.into(), decides(told));
        }
    }

    /// Members of `extras` that were meant to be ours: `Enfilade`, `enfilade_move`.
    fn add_misspelt(&mut self, scene: &File<'_>) {
        for list in ["nodes", "meshes"] {
            for (i, j) in scene.json.list(list).iter().enumerate() {
                let Some(Value::Object(members)) = j.get("extras").map(|e| &e.value) else { continue };
                let own = |key: &&String| *key != "enfilade" && is_meant(key);
                for key in members.iter().map(|(key, _)| key).filter(own) {
                    let place = if list == "nodes" { scene.named(i) } else { format!("/meshes/{i}") };
                    let text =
                        format!("extras says {key:?}, expected \"enfilade\", spelt so; it is not read");
                    self.add(place, text, true);
                }
            }
        }
    }
}

/// What something itself says.
fn teller(json: &Json) -> Option<&Json> {
    json.get("extras")?.get("enfilade")
}

/// Whether a key was meant to be ours.
fn is_meant(key: &str) -> bool {
    let letters: String = key.chars().filter(|c| c.is_alphanumeric()).collect();
    letters.to_lowercase().starts_with("enfilade")
}

/// Whether what cannot be read may have been meant to say what moves or stays.
fn is_unclear(told: &Json) -> bool {
    let is_of_moves = |key: &str| !["name", "query", "reference"].contains(&key);
    match &told.value {
        Value::Object(members) => members.iter().any(|(k, v)| is_of_moves(k) && unread(k, v).is_some()),
        Value::Text(_) => false,
        _ => true,
    }
}

/// Whether something says, or was meant to say, what moves or stays.
fn decides(told: &Json) -> bool {
    let is_said = matches!(&told.value, Value::Text(text) if !text.trim().is_empty());
    is_said || ["move", "keep"].iter().any(|key| told.get(key).is_some()) || is_unclear(told)
}

/// What of a node's marks cannot be read.
fn unreadable(told: &Json) -> Vec<String> {
    match &told.value {
        Value::Object(members) => members.iter().filter_map(|(key, value)| unread(key, value)).collect(),
        Value::Text(_) => Vec::new(),
        _ => vec![format!(
            "extras.enfilade: found {}, expected an object such as {{\"move\": \"x -1 1\"}}; nothing is marked by it",
            told.words()
        )],
    }
}

/// Regions that a node states and that there are none of.
fn idle_regions(scene: &File<'_>, shown: &Shown, used: &Used) -> Vec<String> {
    let mut out = Vec::new();
    for key in ["query", "reference"] {
        let own = [shown.node];
        let is_stated = region(scene, &own, key).is_some_and(|(n, _)| !used.regions.contains(&(n, key)));
        if !is_stated {
            continue;
        }
        let why = match () {
            () if used.cut.contains(&shown.node) => "it is a wall, a door or a window, expected a space",
            () if used.standing.contains(&shown.node) => "nothing of it is a space at the height of the cut",
            () => "neither it nor what hangs on it shows a space that can be read",
        };
        out.push(format!("the {key} that extras.enfilade states is not used: {why}"));
    }
    out
}

/// Nodes that give one name to different moves.
fn same_names(scene: &File<'_>, used: &Used) -> Vec<(String, String)> {
    let mut by_name: BTreeMap<&str, Vec<(usize, String)>> = BTreeMap::new();
    for n in &used.moved {
        if let (Some(name), Some(text)) = (own_name(scene, *n), own_move(scene, *n)) {
            by_name.entry(name).or_default().push((*n, text));
        }
    }
    let differs = |(name, nodes): (&str, Vec<(usize, String)>)| {
        let (first, text) = nodes.first()?;
        let (other, differs) = nodes.iter().find(|(_, t)| t != text)?;
        let words = format!(
            "it and {} are both named {name:?} by extras.enfilade and move differently, {text:?} and {differs:?}; each moves \
             for itself",
            scene.named(*other)
        );
        Some((scene.named(*first), words))
    };
    by_name.into_iter().filter_map(differs).collect()
}

/// Names the nodes whose moves are not used because nothing of them stands at the cut: those of another storey, or all.
fn state_away(scene: &File<'_>, nodes: &[usize], are_all: bool, report: &mut Report) {
    if nodes.is_empty() {
        return;
    }
    let named: Vec<String> = nodes.iter().take(TOLD).map(|n| scene.named(*n)).collect();
    let more = if nodes.len() > named.len() { ", …" } else { "" };
    let what = if nodes.len() == 1 { "the move" } else { "the moves" };
    let are = if nodes.len() == 1 { "is" } else { "are" };
    let text = format!(
        "{what} that extras.enfilade states of {}{more} {are} not used: nothing of it reaches the height of the cut",
        named.join(", ")
    );
    let place = Place::file(scene.name);
    if are_all { report.warn("gltf-marks", place, text) } else { report.info("gltf-marks", place, text) }
}

/// Why one member cannot be read.
fn unread(key: &str, value: &Json) -> Option<String> {
    let known = KEYS.iter().find(|(k, _)| *k == key);
    let Some((_, expected)) = known else {
        let names: Vec<&str> = KEYS.iter().map(|(k, _)| *k).collect();
        let is_ours = OWN_KEYS.contains(&key);
        return (!is_ours).then(|| {
            format!("extras.enfilade says {key:?}, expected one of {}; it is not used", names.join(", "))
        });
    };
    let is_read = match (&value.value, key) {
        (Value::Text(_), "move" | "name" | "query" | "reference" | "open" | "status") => true,
        (Value::Bool(_), "keep" | "query" | "reference" | "open" | "remove" | "new") => true,
        // A move that is no text is told where moves are read.
        (_, "move") => true,
        _ => false,
    };
    (!is_read).then(|| {
        format!("extras.enfilade.{key}: found {}, expected {expected}; it is not used", value.words())
    })
}
