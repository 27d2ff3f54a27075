//! What a new element has of one that is like it: its type, its material, its CAD layer.

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::additions::Writer;
use super::building::Building;
use super::footprint::Footprint;
use super::geo::is_upright;
use super::model::{axis_item, layer_reach};
use super::placed::{Base, Body};
use super::step::Arg;
use crate::splice::Splice;

/// Sizes that differ by less are the same, metres: plans are written to the millimetre.
const SAME_M: f64 = 1e-3;

/// Heights of doors that a person goes through, metres: a hatch is no like of a door, nor is a gate.
const DOOR_HEIGHTS_M: [f64; 2] = [1.9, 2.5];

/// A straight new wall as its layers lie in it.
pub(super) struct Bar {
    /// Its corners, world.
    pub ring: [DVec2; 4],
    /// Its length.
    pub length: f64,
    /// Where its reference line begins, world, and the way it runs: as that of its like, so that the layers go on.
    start: DVec2,
    along: DVec2,
    /// Whether it is as thick as its like.
    pub is_as_thick: bool,
}

impl Bar {
    /// Of the corners of a wall, its first side along it.
    pub fn of(b: &Building<'_, '_>, ring: &[DVec2], like: u64) -> Option<Self> {
        let ring: [DVec2; 4] = ring.try_into().ok()?;
        let [mut start, mut end] = [(ring[0] + ring[3]) / 2.0, (ring[1] + ring[2]) / 2.0];
        let way = b.model.product(like)?.placement.and_then(|p| b.geo.placement(p).ok());
        let way = way.filter(is_upright).map(|m| m.matrix3.x_axis.truncate());
        if way.is_some_and(|way| way.dot(end - start) < 0.0) {
            (start, end) = (end, start);
        }
        let (thickness, along) = (ring[0].distance(ring[3]), (end - start).try_normalize()?);
        let is_same = |t: f64| (t - thickness).abs() * b.geo.metres < SAME_M;
        let is_as_thick = thicknesses(b, like).is_some_and(|all| all.into_iter().all(is_same));
        let middle = layers(b, like).filter(|_| is_as_thick).map_or(0.0, |[lo, hi]| f64::midpoint(lo, hi));
        let start = start - along.perp() * middle;
        Some(Self { ring, length: ring[0].distance(ring[1]), start, along, is_as_thick })
    }

    /// Its frame, relative to an upright one.
    pub fn frame(&self, base: Base, z: f64) -> DAffine3 {
        let to_base = base.world.inverse();
        let x = to_base.transform_vector3(self.along.extend(0.0)).truncate().normalize_or(DVec2::X);
        let turn = DMat3::from_cols(x.extend(0.0), x.perp().extend(0.0), DVec3::Z);
        DAffine3::from_mat3_translation(turn, to_base.transform_point3(self.start.extend(z)))
    }
}

/// How far the layers of a wall reach from its reference line, where they lie about an upright one.
fn layers(b: &Building<'_, '_>, wall: u64) -> Option<[f64; 2]> {
    let usage = b.model.materials.get(&wall)?;
    b.step.args(*usage).get(1).filter(|way| way.is("AXIS2"))?;
    layer_reach(b.step, &b.model, wall)
}

/// How thick a wall is by its own layers and by those of its type, or else by what it covers.
fn thicknesses(b: &Building<'_, '_>, wall: u64) -> Option<Vec<f64>> {
    let kind = relation(b, wall).map(|(_, kind)| kind);
    let stated = [Some(wall), kind].into_iter().flatten().filter_map(|id| layer_reach(b.step, &b.model, id));
    let stated: Vec<f64> = stated.map(|[lo, hi]| hi - lo).collect();
    if stated.is_empty() { Some(vec![breadth(&Footprint::of(b, wall)?)?]) } else { Some(stated) }
}

/// The breadth of what a wall covers, across its longest side.
fn breadth(at: &Footprint) -> Option<f64> {
    let sides = at.rings().iter().flat_map(|r| r.iter().zip(r.iter().cycle().skip(1))).map(|(a, b)| *b - *a);
    let across = sides.max_by(|a, b| a.length().total_cmp(&b.length()))?.try_normalize()?.perp();
    let all = || at.rings().iter().flatten().map(|p| p.dot(across));
    Some(all().fold(f64::MIN, f64::max) - all().fold(f64::MAX, f64::min))
}

/// The relation that gives an element its type, and the type.
fn relation(b: &Building<'_, '_>, id: u64) -> Option<(u64, u64)> {
    b.step.all("IFCRELDEFINESBYTYPE").find_map(|i| {
        let args = b.step.args_of(i);
        let kind = args.get(5).and_then(Arg::id)?;
        args.get(4).filter(|a| a.ids().contains(&id)).map(|_| (i.id, kind))
    })
}

/// A door that is like a new one: as wide, and of a type.
#[derive(Clone, Copy)]
pub(super) struct Door {
    pub id: u64,
    pub height_m: f64,
}

impl Door {
    /// One as wide as a stretch, if there is one in the storey there, else anywhere.
    pub fn like(b: &Building<'_, '_>, gone: &[DVec2; 4], storey: Option<u64>) -> Option<Self> {
        let width_m = gone[0].distance(gone[1]) * b.geo.metres;
        let fits = |id: u64| {
            let args = b.step.args(id);
            let [height_m, width] = [8, 9].map(|k| args.get(k).and_then(Arg::number));
            let (height_m, width) = (height_m? * b.geo.metres, width? * b.geo.metres);
            let is_high = (DOOR_HEIGHTS_M[0]..=DOOR_HEIGHTS_M[1]).contains(&height_m);
            let is_like = is_high && (width - width_m).abs() < SAME_M && relation(b, id).is_some();
            is_like.then_some(Self { id, height_m })
        };
        let doors = b.model.fillers.iter().filter(|f| f.class == "IfcDoor");
        let all: Vec<Self> = doors.filter_map(|f| fits(f.id)).collect();
        let here = all.iter().find(|d| storey.is_some() && b.model.storey_of(d.id) == storey);
        here.or(all.first()).copied()
    }
}

impl Writer<'_, '_, '_> {
    /// Gives a new wall what its like has: a type and layers only to one as thick; a plain material holds of any.
    pub(super) fn alike(&mut self, made: u64, like: u64, is_as_thick: bool) {
        if is_as_thick {
            self.typed(made, like);
        }
        let Some(material) = self.b.model.materials.get(&like).copied() else { return };
        let holds = match &*self.b.step.keyword(material) {
            "IFCMATERIAL" | "IFCMATERIALLIST" => true,
            "IFCMATERIALLAYERSETUSAGE" => is_as_thick && layers(self.b, like).is_some(),
            "IFCMATERIALLAYERSET" | "IFCMATERIALCONSTITUENTSET" => is_as_thick,
            _ => false,
        };
        if holds {
            let (gid, history) = (self.global_id("material"), self.history.clone());
            self.add(&format!("IFCRELASSOCIATESMATERIAL('{gid}',{history},$,$,(#{made}),#{material})"));
        }
    }

    /// Gives a new element the type of its like: a type has one relation at most, so its list grows.
    pub(super) fn typed(&mut self, made: u64, like: u64) {
        if let Some((relation, _)) = relation(self.b, like) {
            self.of_types.entry(relation).or_default().push(made);
        }
    }

    /// The lists of types, each with what is new of it.
    pub(super) fn type_lists(&self) -> Vec<Splice> {
        let of = |(relation, made): (&u64, &Vec<u64>)| {
            let end = self.b.step.args(*relation).get(4)?.list().last()?.span.end;
            let text: String = made.iter().map(|id| format!(",#{id}")).collect();
            Some(Splice::new(end..end, text))
        };
        self.of_types.iter().filter_map(of).collect()
    }

    /// Puts a new body onto the CAD layer of its like, by a record of its own.
    pub(super) fn on_layer(&mut self, body: Body, like: u64) {
        let shape = self.b.model.product(like).or_else(|| self.b.model.filler(like)).and_then(|p| p.shape);
        let Some(shape) = shape else { return };
        let shown = self.b.step.args(shape).get(2).map(Arg::ids).unwrap_or_default();
        let items: Vec<u64> = shown
            .iter()
            .flat_map(|s| self.b.step.args(*s).get(3).map(Arg::ids).unwrap_or_default())
            .collect();
        for keyword in ["IFCPRESENTATIONLAYERASSIGNMENT", "IFCPRESENTATIONLAYERWITHSTYLE"] {
            let found = self.b.step.all(keyword).find_map(|label| {
                let slot = self.b.step.args_of(label).get(2)?.clone();
                let named = slot.ids();
                let has = |ids: &[u64]| ids.iter().any(|id| named.contains(id));
                let made = if has(&shown) { body.shown } else { has(&items).then_some(body.item)? };
                Some((label, slot.span, made))
            });
            let Some((label, slot, made)) = found else { continue };
            let bytes = self.b.step.bytes;
            let [head, tail] = [label.keyword.start..slot.start, slot.end..label.args.end + 1];
            let [head, tail] = [head, tail].map(|r| String::from_utf8_lossy(&bytes[r]).into_owned());
            self.add(&format!("{head}(#{made}){tail}"));
            return;
        }
    }

    /// The context of the axis of a wall that shows one.
    pub(super) fn axis_context(&self, wall: u64) -> Option<u64> {
        let shape = self.b.model.product(wall)?.shape?;
        axis_item(self.b.step, shape)?;
        let shown = self.b.step.args(shape).get(2).map(Arg::ids)?;
        shown.into_iter().find_map(|id| {
            let args = self.b.step.args(id);
            let is_axis = args.get(1).and_then(|a| self.b.step.text(a)).is_some_and(|t| t == "Axis");
            args.first().and_then(Arg::id).filter(|_| is_axis)
        })
    }
}
