//! What stands in rooms and tells what they are for: sanitary ware, furniture, machines, by what the file calls it.

use std::collections::{BTreeMap, HashMap};

use glam::DVec2;

use super::super::Plan;
use super::super::hidden::Hidden;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Editable, SourceRef};
use enfilade_cad::own_layers::is_own;
use enfilade_cad::plane::box_of;
use enfilade_cad::roles::Role;
use enfilade_cad::things::ThingKind;
use enfilade_engine::geometry::PointUm;

/// Something that stands in a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thing {
    /// What it is.
    pub kind: ThingKind,
    /// The lower left and the upper right corner of its box, drawing frame, micrometres.
    pub extent: [PointUm; 2],
}

impl Thing {
    /// The middle of its box.
    pub fn at(&self) -> PointUm {
        let [lo, hi] = self.extent;
        [i64::midpoint(lo[0], hi[0]), i64::midpoint(lo[1], hi[1])]
    }
}

/// What is longer than this is no thing that stands in a room, metres of a person.
const LONGEST_M: f64 = 6.5;

/// A straight stair is no longer than this, metres of a person: 25 treads of 0.29 m climb a storey of 4.4 m, and a landing of
/// 1.2 m parts them (DIN 18065 wants one after 18 risers).
const LONGEST_FLIGHT_M: f64 = 9.0;

/// What is shorter than this tells nothing, metres of a person: a symbol on a sheet.
const SHORTEST_M: f64 = 0.15;

/// Something found, by its box in drawing units.
struct Found {
    kind: ThingKind,
    extent: [DVec2; 2],
    /// Where it stands in the file and how it is written back, if it is drawn as one.
    whole: Option<(SourceRef, Editable)>,
}

/// What INSERTs show, by the records that show it.
type Boxes = BTreeMap<Vec<usize>, Found>;

/// Pieces drawn without a block that lie no farther from one another are of one thing, metres of a person.
const BESIDE_M: f64 = 0.1;

/// Where so many pieces of one kind lie loose they are not counted: there is one of them in a room, or none.
const LOOSE_MAX: usize = 1_500;

/// What stands in the rooms of a plan, by names of blocks and layers, and by what the file calls it.
pub fn find(drawing: &Drawing, plan: &Plan) -> Vec<Thing> {
    found(drawing, plan).iter().filter_map(|f| thing(plan, f)).collect()
}

/// Furniture that the file has as one and that can stand elsewhere: what it is, where it stands in the file, and how it is
/// written back.
pub fn furniture(drawing: &Drawing, plan: &Plan) -> Vec<(Thing, SourceRef, Editable)> {
    let of = |f: &Found| {
        let (source, editable) = f.whole.clone().filter(|_| f.kind.is_furniture())?;
        Some((thing(plan, f)?, source, editable))
    };
    found(drawing, plan).iter().filter_map(of).collect()
}

fn found(drawing: &Drawing, plan: &Plan) -> Vec<Found> {
    let hidden = Hidden::new(drawing);
    let mut kinds: HashMap<&str, Option<ThingKind>> = HashMap::new();
    let mut blocks = Boxes::new();
    let mut loose: BTreeMap<ThingKind, Vec<[DVec2; 2]>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if is_own(&e.layer) || hidden.entity(e) {
            continue;
        }
        let Some(extent) = box_of(control_points(&e.shape).into_iter()) else { continue };
        let mut kind_of = |name| *kinds.entry(name).or_insert_with(|| ThingKind::of_name(name));
        let shown = e.blocks.iter().enumerate().find_map(|(k, b)| Some((k, kind_of(b.as_str())?)));
        if let Some((k, kind)) = shown.filter(|(k, _)| e.origin.inserts.len() > *k) {
            // What the outermost INSERT shows moves with it.
            let whole = (k == 0 && e.editable.moves_whole()).then(|| (e.source.clone(), e.editable.clone()));
            let new = || Found { kind, extent, whole };
            let of = blocks.entry(e.origin.inserts[..=k].to_vec()).or_insert_with(new);
            of.extent = [of.extent[0].min(extent[0]), of.extent[1].max(extent[1])];
            continue;
        }
        let is_stair = plan.reading.role(i) == Role::Stair;
        let kind = if is_stair { Some(ThingKind::Stair) } else { kind_of(e.layer.as_str()) };
        kind.iter().for_each(|kind| loose.entry(*kind).or_default().push(extent));
    }
    let metres = plan.frame.metres_per_unit / plan.human_scale;
    let loose = loose.into_iter().flat_map(|(kind, pieces)| {
        let boxes = joined(pieces, BESIDE_M / metres).into_iter();
        boxes.map(move |extent| Found { kind, extent, whole: None })
    });
    let called = drawing.called.iter().filter_map(|c| {
        let whole = c.source.clone().map(|source| (source, Editable::WithInsert { turnable: true }));
        Some(Found { kind: ThingKind::of_name(&c.words)?, extent: c.extent, whole })
    });
    blocks.into_values().chain(called).chain(loose).collect()
}

/// Boxes that lie no farther than `near` from one another as one.
fn joined(mut pieces: Vec<[DVec2; 2]>, near: f64) -> Vec<[DVec2; 2]> {
    let mut at = 0;
    while pieces.len() <= LOOSE_MAX && at < pieces.len() {
        let [lo, hi] = pieces[at];
        let is_beside = |[l, h]: &[DVec2; 2]| (*l - near).cmple(hi).all() && (*h + near).cmpge(lo).all();
        match (at + 1..pieces.len()).find(|k| is_beside(&pieces[*k])) {
            Some(other) => {
                let [l, h] = pieces.swap_remove(other);
                pieces[at] = [lo.min(l), hi.max(h)];
            }
            None => at += 1,
        }
    }
    pieces
}

fn thing(plan: &Plan, &Found { kind, extent, .. }: &Found) -> Option<Thing> {
    let longer_m = (extent[1] - extent[0]).max_element() * plan.frame.metres_per_unit / plan.human_scale;
    let longest_m = if kind == ThingKind::Stair { LONGEST_FLIGHT_M } else { LONGEST_M };
    let is_thing = (SHORTEST_M..=longest_m).contains(&longer_m);
    is_thing.then_some(Thing { kind, extent: extent.map(|p| plan.frame.um_from_file(p)) })
}
