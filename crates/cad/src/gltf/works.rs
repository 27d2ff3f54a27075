//! Building works in a scene: walls are cut, nodes leave the scene, boxes are built.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::ReadOptions;
use super::append::{Append, Home, joined};
use super::bodies::{SCENE_LAYER, SPACE_LAYER};
use super::body::Body;
use super::boxes::{self, Look, NewBox};
use super::cutter::{Cut, Cutter};
use super::heights::{clear, is_standing, reach};
use super::instances;
use super::lists::{self, Lists};
use super::motion::z_up;
use super::read::{Standing, standing};
use super::record::{of_record, record};
use super::rewrite::changed;
use super::scene::{File, Shown};
use super::soup::{Blob, Part, parts, refusal};
use crate::drawing::{Edit, EntityWork, Filling, Shape};
use crate::plane::{box_of, is_inside_ring};
use crate::sizes::{BELOW_FLOOR_M, LEAF_M, OPENING_HEIGHT_M};
use crate::splice::Splice;
use enfilade_report::{Error, Place, Report};

/// What lies nearer to a side of a cut than this lies in it, metres: single precision tells less in a building of 100 m.
const NEAR_M: f64 = 2e-5;

/// Why a work is not written.
type Why = String;

/// Splices of the JSON text (counted from its start) that make works, and bytes to append to the binary chunk.
///
/// # Errors
/// [`Error::Input`] for a work that the scene cannot hold; as reading.
pub(super) fn made(
    scene: &File<'_>,
    options: &ReadOptions,
    edits: &[Edit],
) -> Result<(Vec<Splice>, Vec<u8>), Error> {
    let shown = scene.shown();
    let standing = standing(scene, &shown, options, &mut Report::default())?;
    let cut = standing.floor + options.above_m() / standing.metres;
    let mut maker = Maker {
        scene,
        shown: &shown,
        standing: &standing,
        cut,
        parts: BTreeMap::new(),
        gone: BTreeSet::new(),
        lists: Lists::default(),
        append: Append::default(),
        blob: Blob::new(scene),
    };
    for edit in edits {
        maker.edit(edit).map_err(|why| fault(scene, edit.record(), &why))?;
    }
    let first = edits.first().map_or(0, Edit::record);
    maker.into_parts().map_err(|why| fault(scene, first, &why))?.written(scene)
}

fn fault(scene: &File<'_>, record: usize, why: &str) -> Error {
    let place = Place::file(scene.name).entity(scene.named(of_record(record).0));
    Error::input("gltf-edit", place, format!("{why}; nothing was written"))
}

/// Works, gathered.
struct Maker<'m, 'a> {
    scene: &'m File<'a>,
    shown: &'m [Shown],
    standing: &'m Standing<'m>,
    /// Height at which the scene is cut to a plan, its units.
    cut: f64,
    /// Nodes of which meshes are cut, and what is left of these.
    parts: BTreeMap<usize, Vec<Part>>,
    /// Nodes that leave the scene.
    gone: BTreeSet<usize>,
    lists: Lists,
    append: Append,
    blob: Blob,
}

/// All that is to be written.
struct Written {
    splices: Vec<Splice>,
    append: Append,
    blob: Blob,
}

impl Written {
    fn written(mut self, scene: &File<'_>) -> Result<(Vec<Splice>, Vec<u8>), Error> {
        let mut home = Home::new(scene);
        if !self.blob.data.is_empty() {
            let from = home.take(&scene.json, &mut self.append, "works", &self.blob.data);
            self.blob.state(&scene.json, &mut self.append, from);
        }
        self.splices.extend(self.append.splices(scene)?);
        self.splices.extend(home.stated(&scene.json));
        Ok((joined(self.splices), home.data))
    }
}

impl<'m> Maker<'m, '_> {
    fn edit(&mut self, edit: &Edit) -> Result<(), Why> {
        let Edit::Work { record, work } = edit else { return Ok(()) };
        match work {
            EntityWork::Void { gone, filling } => self.void(*record, gone, *filling),
            EntityWork::Drop => self.drop(*record),
            EntityWork::Build { shapes } => shapes.iter().try_for_each(|s| self.wall(*record, s)),
            EntityWork::Cut { .. } | EntityWork::Copy { .. } => Err("a mesh has no lines".into()),
        }
    }

    /// What is shown of a record: where parts of it are called walls, these.
    fn bodies(&self, of: usize) -> Vec<&'m Body<'m>> {
        let own = |b: &&Body<'_>| record(b.element.node, b.piece) == of;
        let all: Vec<&Body<'_>> = self.standing.bodies.iter().filter(own).collect();
        let walls: Vec<&Body<'_>> = all.iter().copied().filter(|b| b.is_wall).collect();
        if walls.is_empty() { all } else { walls }
    }

    /// Cuts a stretch out of a wall, and puts in what stands there.
    fn void(&mut self, of: usize, gone: &[DVec2; 4], filling: Filling) -> Result<(), Why> {
        let bodies = self.bodies(of);
        let mut is_met = false;
        for body in &bodies {
            if let Some(why) = &body.held {
                return Err(why.clone());
            }
            is_met |= self.cut_out(body, gone, filling)?;
        }
        let like = bodies.first().filter(|_| is_met).ok_or("no wall of its mesh stands there")?;
        self.clear(gone)?;
        self.filled(like, gone, filling)
    }

    /// The mesh of a body, taken apart.
    fn taken(&mut self, body: &Body<'_>) -> Result<&mut Vec<Part>, Why> {
        let node = body.shown.node;
        if !self.parts.contains_key(&node) {
            let mesh = self.scene.json.list("nodes").get(node).and_then(|n| n.index("mesh"));
            let mesh = mesh.ok_or("it has no mesh")?;
            if let Some(why) = refusal(self.scene, mesh) {
                return Err(why);
            }
            self.parts.insert(node, parts(self.scene, mesh)?);
        }
        self.parts.get_mut(&node).ok_or_else(|| "it has no mesh".into())
    }

    /// Cuts a stretch out of one mesh, of what stands in it at the height of the cut; whether anything does.
    fn cut_out(&mut self, body: &Body<'_>, gone: &[DVec2; 4], filling: Filling) -> Result<bool, Why> {
        let (metres, floor, cut) = (self.standing.metres, self.standing.floor, self.cut);
        let to_world = z_up() * body.shown.world;
        let near = NEAR_M / metres;
        let parts = self.taken(body)?;
        // Heights of this one count from 0, as those of the scene do.
        let all = Cutter::over(gone, [0.0, 1.0]).ok_or("the stretch has no size")?;
        let met = is_standing(parts, body.piece, (&all, all.to_box * to_world), (cut, near, filling));
        let Some((pieces, [low, high])) = met else { return Ok(false) };
        let below = BELOW_FLOOR_M / metres;
        let bottom = if low < floor - below { floor } else { low.min(floor) - below };
        let heights = match filling {
            Filling::Gone => [low - below, high + below],
            _ => [bottom, floor + OPENING_HEIGHT_M / metres],
        };
        let cutter = Cutter::over(gone, heights).ok_or("the stretch has no size")?;
        let to_box = cutter.to_box * to_world;
        if !to_box.inverse().is_finite() {
            return Err("it has no size".into());
        }
        let is_mirrored = to_box.matrix3.determinant() < 0.0;
        let made = Cut { cutter: &cutter, to_box, is_mirrored, near };
        made.make(parts, &|piece| pieces.contains(&piece), cut - heights[0])?;
        Ok(true)
    }

    /// A leaf or a pane in the middle of a stretch.
    fn filled(&mut self, like: &Body<'_>, gone: &[DVec2; 4], filling: Filling) -> Result<(), Why> {
        let (layer, short) = match filling {
            Filling::Nothing | Filling::Gone => return Ok(()),
            Filling::Door => ("IfcDoor", "Door"),
            Filling::Glass => ("IfcWindow", "Glass"),
        };
        if like.layer == SCENE_LAYER {
            return Err("names do not tell its walls from doors and windows".into());
        }
        let metres = self.standing.metres;
        let [a, b, c, d] = *gone;
        let (right, left) = ((a + d) / 2.0, (b + c) / 2.0);
        let off = (d - a).normalize_or_zero() * (LEAF_M / 2.0 / metres);
        let ring = [right - off, left - off, left + off, right + off];
        let floor = self.standing.floor;
        let heights = [floor, like.high.min(floor + OPENING_HEIGHT_M / metres)];
        let name = if like.layer.starts_with("Ifc") { format!("{layer}/{short}") } else { short.into() };
        let look = self.look_of(layer);
        self.build(like, (ring, heights), (Some(&name), look));
        Ok(())
    }

    /// What doors or windows of the scene are made of; a new transparent material for panes where the scene has no window.
    fn look_of(&mut self, layer: &str) -> Look {
        let found = self.standing.bodies.iter().find(|b| b.layer == layer);
        let mesh = found.and_then(|b| self.scene.json.list("nodes").get(b.shown.node)?.index("mesh"));
        match mesh {
            Some(mesh) => Look::of(self.scene, mesh),
            None if layer == "IfcWindow" => {
                let material = self.append.push(&self.scene.json, "materials", GLASS.into());
                Look { material: Some(material), pictures: 0 }
            }
            None => Look::default(),
        }
    }

    /// A wall as high as another, of what that is made of, over an outline.
    fn wall(&mut self, of: usize, shape: &Shape) -> Result<(), Why> {
        let corners: Vec<DVec2> = match shape {
            Shape::Polyline { vertices, closed: true } => vertices.iter().map(|v| v.at).collect(),
            _ => Vec::new(),
        };
        let ring: [DVec2; 4] = corners.try_into().map_err(|_| "a new wall has no outline")?;
        let bodies = self.bodies(of);
        let middle = ring.iter().sum::<DVec2>() / 4.0;
        let like = bodies.iter().find_map(|b| Some((*b, reach(b, middle, self.cut)?)));
        let (like, heights) = like.ok_or("it has no height for a new wall")?;
        let walls = self.standing.bodies.iter().filter(|b| b.is_wall || b.layer == SCENE_LAYER);
        let heights = clear(walls, middle, (heights, self.cut));
        let mesh = self.scene.json.list("nodes").get(like.shown.node).and_then(|n| n.index("mesh"));
        let look = mesh.map_or(Look::default(), |mesh| Look::of(self.scene, mesh));
        let name = (like.layer != SCENE_LAYER).then_some(like.layer.as_str());
        self.build(like, (ring, heights), (name, look));
        self.clear(&ring)
    }

    /// What hung where something else comes leaves the scene.
    fn clear(&mut self, ring: &[DVec2; 4]) -> Result<(), Why> {
        let standing = self.standing;
        let (floor, head) = (standing.floor, standing.floor + OPENING_HEIGHT_M / standing.metres);
        // Some programs show the voids of walls as bodies: reading takes them out of what stands there.
        let is_opening = |b: &&Body<'_>| OPENINGS.contains(&b.layer.as_str());
        let is_here = |b: &&Body<'_>| {
            let points = b.triangles.iter().flatten().map(|p| p.truncate());
            let middle = box_of(points).map(|[lo, hi]| lo.midpoint(hi));
            b.low < head && b.high > floor && middle.is_some_and(|p| is_inside_ring(ring, p))
        };
        let mut hung = standing.bodies.iter().filter(is_opening).filter(is_here);
        hung.try_for_each(|b| self.leave(b.shown.node))
    }

    /// Adds a box beside what it is like.
    fn build(&mut self, like: &Body<'_>, at: ([DVec2; 4], [f64; 2]), (name, look): (Option<&str>, Look)) {
        let own = like.element.parent;
        let parent = lists::above(like.element).filter(|_| own.inverse().is_finite());
        let parent_at = if parent.is_some() { own } else { glam::DAffine3::IDENTITY };
        let new = NewBox { name, ring: at.0, heights: at.1, parent: parent_at, look };
        let node = boxes::add(&self.scene.json, &mut self.append, &mut self.blob, &new);
        self.lists.add(parent, node);
    }

    /// Takes an element out of the scene, or a piece out of its mesh.
    fn drop(&mut self, of: usize) -> Result<(), Why> {
        let (node, piece) = of_record(of);
        let Some(piece) = piece else { return self.leave(node) };
        let own = |b: &&Body<'_>| record(b.element.node, b.piece) == of;
        let body = self.standing.bodies.iter().find(own).ok_or("no such piece")?;
        for part in self.taken(body)? {
            let before = part.faces.len();
            part.faces.retain(|f| f.piece != piece);
            part.is_changed |= part.faces.len() != before;
        }
        Ok(())
    }

    /// A node leaves the list that it hangs in.
    fn leave(&mut self, node: usize) -> Result<(), Why> {
        let mut places = self.shown.iter().filter(|s| s.node == node);
        let (Some(place), None) = (places.next(), places.next()) else {
            return Err("it is not shown exactly once".into());
        };
        if instances::is_many(&self.scene.json.list("nodes")[node]) {
            return Err(instances::WHY.into());
        }
        let hangs = |b: &&Body<'_>| b.element.node != node && b.shown.path().contains(&node);
        if self.standing.bodies.iter().filter(hangs).any(|b| b.is_wall || b.layer == SPACE_LAYER) {
            return Err("other walls hang on it".into());
        }
        if self.gone.insert(node) {
            self.lists.remove(lists::above(place), node);
        }
        Ok(())
    }

    fn into_parts(mut self) -> Result<Written, Why> {
        let is_gone = |parts: &[Part]| !parts.is_empty() && parts.iter().all(Part::is_gone);
        let gone: Vec<usize> = self.parts.iter().filter(|(_, p)| is_gone(p)).map(|(n, _)| *n).collect();
        gone.into_iter().try_for_each(|node| self.leave(node))?;
        let root = &self.scene.json;
        let mut splices = Vec::new();
        for (node, parts) in self.parts.iter().filter(|(n, _)| !self.gone.contains(*n)) {
            splices.extend(changed(self.scene, (&mut self.append, &mut self.blob), *node, parts)?);
        }
        for node in &self.gone {
            let place = self.shown.iter().find(|s| s.node == *node);
            let from = Lists::pointer(root, place.and_then(lists::above));
            splices
                .extend(root.list("nodes").get(*node).into_iter().flat_map(|n| lists::demolished(n, &from)));
        }
        splices.extend(self.lists.splices(self.scene).ok_or("the scene has no list of its nodes")?);
        Ok(Written { splices, append: self.append, blob: self.blob })
    }
}

/// Layers of what hangs in walls.
const OPENINGS: [&str; 3] = ["IfcDoor", "IfcWindow", "IfcOpeningElement"];

/// Glass, where a scene has no window.
const GLASS: &str = r#"{"name":"Glass","pbrMetallicRoughness":{"baseColorFactor":[0.7,0.85,0.95,0.35],"metallicFactor":0},"alphaMode":"BLEND"}"#;
