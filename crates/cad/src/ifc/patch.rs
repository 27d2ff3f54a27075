//! Moves to bytes: placements and profiles are spliced, and copied first where others use them.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::ReadOptions;
use super::building::{Building, refusal};
use super::geo::Why;
use super::length;
use super::number::real;
use super::reshape::{Change, Node};
use super::rooms::{self, Room};
use super::step::{Arg, Step};
use super::unseen::{Tail, Tails, taken};
use crate::drawing::{Edit, RigidMotion};
use crate::splice::Splice;
use enfilade_report::{Error, Place};

/// Differences below this many rounding steps of the coordinates are what changing frames leaves behind.
const NOISE_STEPS: f64 = 16.0;

/// Ratios of a direction that differ less than this are the same.
const NOISE_RATIO: f64 = 1e-14;

/// What an edit changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moved {
    /// Products that stand elsewhere or have another length afterwards, the moved one first.
    pub products: Vec<u64>,
    /// Unseen walls that it takes along.
    pub tails: Vec<Tail>,
    /// Stated figures that stay, though their element changes its length.
    pub figures: length::Figures,
}

/// Splices of existing bytes, new instances, and what moved.
pub(super) struct Mover<'b, 's, 'a> {
    b: &'b Building<'s, 'a>,
    users: HashMap<u64, Vec<u64>>,
    next: u64,
    done: HashSet<u64>,
    /// What other edits carry: it goes with them, whichever comes first.
    carried: HashSet<u64>,
    /// What goes with openings that slide.
    slides: HashMap<u64, (u64, DVec2)>,
    /// Instances changed in place below a wall that changes its length, and those copied for it.
    changed: HashSet<u64>,
    copies: Vec<(Node, u64)>,
    /// The shape that changes.
    shape: Option<u64>,
    /// Unseen walls that go along.
    tails: Tails,
    /// Rooms that moved walls bound.
    rooms: Vec<Room>,
    /// Changes of existing bytes.
    pub splices: Vec<Splice>,
    /// New instances, each with its line end.
    pub added: Vec<u8>,
}

impl<'b, 's, 'a> Mover<'b, 's, 'a> {
    /// Starts without a change; `edits`: those that will be made.
    pub fn new(b: &'b Building<'s, 'a>, options: &ReadOptions, edits: &[Edit]) -> Self {
        let longer = edits.iter().filter(|e| matches!(e, Edit::Ends { .. })).map(|e| e.record() as u64);
        let tails = taken(b, options, edits).tails;
        let rooms = rooms::bounded(b, edits, &tails);
        let longer = longer.chain(tails.values().flatten().map(|t| t.id));
        let longer = longer.flat_map(|id| length::grows(b, id)).chain(rooms.iter().map(|r| r.id));
        let stated = rooms.iter().flat_map(|r| &r.stated).flat_map(|set| &set.changes);
        let stated = stated.filter_map(|(_, change)| Some(change.instance()?.id));
        Self {
            b,
            users: users(b.step, longer, stated),
            tails,
            rooms,
            next: b.step.largest_id() + 1,
            done: HashSet::new(),
            carried: edits.iter().filter_map(moved_whole).flat_map(|id| carried(b, id)).collect(),
            slides: slides(b, edits),
            changed: HashSet::new(),
            copies: Vec::new(),
            shape: None,
            splices: Vec::new(),
            added: Vec::new(),
        }
    }

    /// The next free instance number.
    pub fn next_id(&self) -> u64 {
        self.next
    }

    fn fault(&self, id: u64, why: &str) -> Error {
        let place = self.b.step.get(id).map(|i| self.b.step.line(i.span.start));
        let place = Place { file: self.b.file.into(), line: place, entity: self.b.geo.named(id) };
        Error::input("ifc-edit", place, format!("cannot be moved: {why}; nothing was written"))
    }

    /// Makes one edit.
    pub fn edit(&mut self, edit: &Edit) -> Result<Moved, Error> {
        let id = edit.record() as u64;
        if self.b.step.get(id).is_none() {
            return Err(self.fault(id, "no such instance"));
        }
        if let Some(why) = refusal(self.b, id) {
            return Err(self.fault(id, &why));
        }
        let motion = match edit {
            Edit::Insert { motion, .. } => motion,
            Edit::Ends { by, .. } => {
                self.lengthen(id, *by).map_err(|why| self.fault(id, &why))?;
                let (products, figures) = (length::grows(self.b, id), length::figures(self.b, id));
                return Ok(Moved { products, figures, ..Moved::default() });
            }
            Edit::Shape { .. } | Edit::Points { .. } | Edit::Work { .. } => {
                return Err(self.fault(id, "an element of a building moves as a whole"));
            }
        };
        if !motion.turn_rad.is_finite() || !motion.shift.is_finite() {
            return Err(self.fault(id, "the motion is not finite"));
        }
        let follows = self.b.model.follows(id);
        let set: HashSet<u64> = follows.iter().copied().collect();
        let mut here: HashSet<u64> = HashSet::new();
        let goes_itself = !self.carried.contains(&id);
        let mut slid = Slid::default();
        for follower in follows.iter().filter(|_| goes_itself) {
            if self.done.insert(*follower) {
                let gone = match self.slides.get(follower).filter(|s| s.0 != id).copied() {
                    Some(own) => self.sliding(*follower, motion, own, (&here, &mut slid)),
                    None => self.product(*follower, motion, &set, &mut here),
                };
                gone.map_err(|why| self.fault(*follower, &why))?;
            }
        }
        let mut tails = self.tails.remove(&id).unwrap_or_default();
        tails.retain(|t| self.lengthen(t.id, t.by).is_ok());
        let figures = tails.iter().flat_map(|t| length::figures(self.b, t.id)).collect();
        Ok(Moved { products: follows, tails, figures })
    }

    /// Takes along the rooms that the moved walls bound, after all edits.
    pub fn rooms(&mut self) -> Vec<Room> {
        let mut rooms = std::mem::take(&mut self.rooms);
        for room in &mut rooms {
            if let Some(why) = refusal(self.b, room.id).filter(|_| room.shape.is_some()) {
                (room.outlines, room.shape) = (Err(why), None);
                room.stated.clear();
            }
            room.shape.iter().for_each(|shape| self.below(shape));
            room.stated.iter().for_each(|set| self.below(set));
        }
        rooms
    }

    /// Moves the ends of a wall along its axis.
    fn lengthen(&mut self, id: u64, by: [f64; 2]) -> Result<(), Why> {
        if !by.iter().all(|v| v.is_finite()) {
            return Err("the motion is not finite".into());
        }
        let bar = length::bar(self.b, id)?;
        if bar.inner[1] + by[1] <= bar.inner[0] + by[0] {
            return Err("nothing would be left of it".into());
        }
        let changes = bar.change(self.b, id, by)?;
        changes.iter().for_each(|change| self.below(change));
        Ok(())
    }

    /// Changes what lies below a product, each instance once.
    fn below(&mut self, product: &Node) {
        self.copies.clear();
        self.shape = product.changes.iter().find_map(|(_, c)| c.instance()).map(|n| n.id);
        let own = self.own(product);
        self.in_place_below(product, &own);
    }

    /// The instances below a product that are used nowhere else, in one way: the others are copied. Of several products that
    /// change the last keeps what they shared: nothing is left that nobody uses, as rules of the schema forbid of shapes and
    /// representations.
    fn own(&self, product: &Node) -> HashSet<u64> {
        let (mut ways, mut slots, mut names) = (BTreeMap::new(), HashMap::new(), HashMap::new());
        let mut open = vec![product];
        while let Some(node) = open.pop() {
            for arg in self.b.step.args(node.id) {
                for id in arg.id().map_or_else(|| arg.ids(), |id| vec![id]) {
                    *names.entry((node.id, id)).or_insert(0) += 1;
                }
            }
            for child in node.changes.iter().filter_map(|(_, c)| c.instance()) {
                *slots.entry((node.id, child.id)).or_insert(0) += 1;
                let known: &mut Vec<&Node> = ways.entry(child.id).or_default();
                if !known.contains(&child) {
                    known.push(child);
                    open.push(child);
                }
            }
        }
        let mut own: HashSet<u64> = ways.iter().filter(|(_, w)| w.len() == 1).map(|(id, _)| *id).collect();
        loop {
            let is_shared = |id: &u64| {
                let users = self.users.get(id).map(Vec::as_slice).unwrap_or_default();
                users.iter().filter(|u| !self.is_label(**u)).any(|u| {
                    let is_within = *u == product.id || own.contains(u);
                    !is_within || slots.get(&(*u, *id)) != names.get(&(*u, *id))
                })
            };
            let shared: Vec<u64> = own.iter().copied().filter(is_shared).collect();
            if shared.is_empty() {
                return own;
            }
            own.retain(|id| !shared.contains(id));
        }
    }

    /// Changes an instance where it stands; what it refers to as well, or copies of that.
    fn in_place_below(&mut self, node: &Node, own: &HashSet<u64>) {
        for (span, change) in &node.changes {
            match change {
                Change::Text(text) => self.splices.push(Splice::new(span.clone(), text.as_str())),
                Change::Instance(child) if own.contains(&child.id) => {
                    if self.changed.insert(child.id) {
                        self.in_place_below(child, own);
                    }
                }
                Change::Instance(child) => {
                    let copy = self.copied(child);
                    self.release(child.id, node.id);
                    self.splices.push(Splice::new(span.clone(), format!("#{copy}")));
                }
            }
        }
    }

    /// A copy of an instance with its changes, made once for a wall; its style and its CAD layer go with it.
    fn copied(&mut self, node: &Node) -> u64 {
        if let Some((_, copy)) = self.copies.iter().find(|(of, _)| of == node) {
            return *copy;
        }
        let with = node.changes.iter().map(|(span, change)| {
            let text = match change {
                Change::Text(text) => text.clone(),
                Change::Instance(child) => format!("#{}", self.copied(child)),
            };
            (span.clone(), text)
        });
        let with: Vec<_> = with.collect();
        let text = self.written_with(node.id, with);
        let copy = self.add(&text);
        self.copies.push((node.clone(), copy));
        self.use_also(node, copy);
        let mut labels = self.users.get(&node.id).cloned().unwrap_or_default();
        labels.retain(|l| self.is_label(*l));
        for label in labels {
            let keyword = self.b.step.keyword(label);
            let at = match &*keyword {
                "IFCSHAPEREPRESENTATION" => {
                    self.show_instead(label, [node.id, copy]);
                    continue;
                }
                "IFCPRESENTATIONLAYERASSIGNMENT" | "IFCPRESENTATIONLAYERWITHSTYLE" => 2,
                "IFCSHAPEASPECT" => 4,
                _ => 0,
            };
            if let Some(slot) = self.b.step.args(label).get(at) {
                let one = if at == 2 { format!("(#{copy})") } else { format!("#{copy}") };
                let text = self.written_with(label, vec![(slot.span.clone(), one)]);
                self.add(&text);
            }
        }
        copy
    }

    /// A part of the shape that changes shows a copy from now on.
    fn show_instead(&mut self, aspect: u64, [old, copy]: [u64; 2]) {
        if self.b.model.aspect_of.get(&aspect).copied() != self.shape {
            return;
        }
        for item in self.b.step.args(aspect).get(3).map(Arg::list).unwrap_or_default() {
            if item.id() == Some(old) {
                self.splices.push(Splice::new(item.span.clone(), format!("#{copy}")));
            }
        }
    }

    /// An instance's text after `#12=`, with other arguments.
    fn written_with(&self, id: u64, mut with: Vec<(Range<usize>, String)>) -> String {
        let Some(instance) = self.b.step.get(id) else { return String::new() };
        let (mut out, mut at) = (Vec::new(), instance.keyword.start);
        with.sort_by_key(|w| w.0.start);
        for (span, text) in with {
            out.extend_from_slice(&self.b.step.bytes[at..span.start]);
            out.extend_from_slice(text.as_bytes());
            at = span.end;
        }
        out.extend_from_slice(&self.b.step.bytes[at..=instance.args.end]);
        String::from_utf8_lossy(&out).into_owned()
    }

    /// Whether an instance says of others only how they look, or of which part of a shape they are.
    fn is_label(&self, id: u64) -> bool {
        LABELS.contains(&&*self.b.step.keyword(id)) || self.b.model.aspect_of.contains_key(&id)
    }

    /// An instance uses a copy from now on.
    fn release(&mut self, id: u64, by: u64) {
        self.users.entry(id).or_default().retain(|u| *u != by);
    }

    /// What a copy has in common with its original has one user more.
    fn use_also(&mut self, node: &Node, copy: u64) {
        let replaced: HashSet<u64> =
            node.changes.iter().filter_map(|(_, c)| c.instance()).map(|n| n.id).collect();
        for used in self.b.step.args(node.id) {
            for id in used.id().map_or_else(|| used.ids(), |id| vec![id]) {
                if !replaced.contains(&id) {
                    self.users.entry(id).or_default().push(copy);
                }
            }
        }
    }

    fn product(
        &mut self,
        id: u64,
        motion: &RigidMotion,
        set: &HashSet<u64>,
        here: &mut HashSet<u64>,
    ) -> Result<(), Why> {
        let args = self.b.step.args(id);
        let Some(slot) = args.get(5) else { return Ok(()) };
        let Some(placement) = slot.id() else {
            if args.get(6).and_then(Arg::id).is_some() {
                let axes = self.new_axes(&moved_axes(&DAffine3::IDENTITY, &DAffine3::IDENTITY, motion));
                let made = self.add(&format!("IFCLOCALPLACEMENT($,#{axes})"));
                self.splices.push(Splice::new(slot.span.clone(), format!("#{made}")));
            }
            return Ok(());
        };
        if self.has_moved(placement, here)? {
            return Ok(());
        }
        let parent = self.b.geo.parent(placement)?;
        let base = parent.map_or(Ok(DAffine3::IDENTITY), |p| self.b.geo.placement(p))?;
        let own = self.b.geo.own_placement(placement)?;
        let new = moved_axes(&base, &own, motion);
        if self.is_only_for(placement, set) {
            here.insert(placement);
            return self.in_place(placement, &own, &new);
        }
        let axes = self.new_axes(&new);
        let parent_id = parent;
        let parent = parent.map_or("$".to_string(), |p| format!("#{p}"));
        let made = self.add(&format!("IFCLOCALPLACEMENT({parent},#{axes})"));
        self.splices.push(Splice::new(slot.span.clone(), format!("#{made}")));
        self.release(placement, id);
        if let Some(parent) = parent_id {
            self.users.entry(parent).or_default().push(made);
        }
        Ok(())
    }

    /// Moves what goes with an opening that slides in a wall that moves: first along the wall, then with it.
    fn sliding(
        &mut self,
        id: u64,
        wall: &RigidMotion,
        (opening, shift): (u64, DVec2),
        (here, slid): (&HashSet<u64>, &mut Slid),
    ) -> Result<(), Why> {
        let placement = self.b.step.args(id).get(5).and_then(Arg::id);
        let is_on_wall = placement.map_or(Ok(false), |p| self.has_moved(p, here))?;
        let motion = match is_on_wall {
            true => RigidMotion { turn_rad: 0.0, shift },
            false => {
                RigidMotion { shift: DVec2::from_angle(wall.turn_rad).rotate(shift) + wall.shift, ..*wall }
            }
        };
        let set: HashSet<u64> = self.b.model.follows(opening).into_iter().collect();
        self.product(id, &motion, &set, slid.entry(opening).or_default())
    }

    /// Whether a placement stands on one that was moved already.
    fn has_moved(&self, placement: u64, here: &HashSet<u64>) -> Result<bool, Why> {
        let mut at = Some(placement);
        for _ in 0..super::limits::PLACEMENT_CHAIN_MAX {
            match at {
                Some(p) if here.contains(&p) => return Ok(true),
                Some(p) => at = self.b.geo.parent(p)?,
                None => break,
            }
        }
        Ok(false)
    }

    /// Whether everything that stands on a placement moves with it.
    fn is_only_for(&self, placement: u64, set: &HashSet<u64>) -> bool {
        let mut open = vec![placement];
        let mut seen = HashSet::new();
        while let Some(at) = open.pop() {
            if !seen.insert(at) {
                continue;
            }
            for user in self.users.get(&at).into_iter().flatten() {
                if self.b.step.keyword(*user) == "IFCLOCALPLACEMENT" {
                    open.push(*user);
                } else if !set.contains(user) {
                    return false;
                }
            }
        }
        true
    }

    fn is_used_once(&self, id: u64) -> bool {
        self.users.get(&id).is_some_and(|u| u.len() == 1)
    }

    fn in_place(&mut self, placement: u64, old: &DAffine3, new: &DAffine3) -> Result<(), Why> {
        let args = self.b.step.args(placement);
        let slot = args.get(1).ok_or("it has no relative placement")?;
        let axes = slot.id().ok_or("it has no relative placement")?;
        if !self.is_used_once(axes) || self.b.step.keyword(axes) != "IFCAXIS2PLACEMENT3D" {
            let made = self.new_axes(new);
            self.splices.push(Splice::new(slot.span.clone(), format!("#{made}")));
            return Ok(());
        }
        let of = self.b.step.args(axes);
        let location = of.first().ok_or("it has no location")?;
        self.location(location, old.translation, new.translation)?;
        let turned = |a: DVec3, b: DVec3| (a - b).abs().max_element() > NOISE_RATIO;
        let [x, z] = [(old.matrix3.x_axis, new.matrix3.x_axis), (old.matrix3.z_axis, new.matrix3.z_axis)];
        if !turned(x.0, x.1) && !turned(z.0, z.1) {
            return Ok(());
        }
        let (Some(axis), Some(reference)) = (of.get(1), of.get(2)) else {
            return Err("its axes are incomplete".into());
        };
        if axis.id().is_none() || turned(z.0, z.1) {
            self.direction(axis, new.matrix3.z_axis)?;
        }
        self.direction(reference, new.matrix3.x_axis)
    }

    fn location(&mut self, slot: &Arg, old: DVec3, new: DVec3) -> Result<(), Why> {
        let point = slot.id().ok_or("it has no location")?;
        let noise = NOISE_STEPS * f64::EPSILON * old.abs().max_element().max(new.abs().max_element());
        let differs = |i: usize| (old[i] - new[i]).abs() > noise;
        if !(0..3).any(differs) {
            return Ok(());
        }
        let args = self.b.step.args(point);
        let slots = args.first().map(Arg::list).unwrap_or_default();
        if self.is_used_once(point) && (slots.len() == 3 || !differs(2)) {
            for (i, coordinate) in slots.iter().enumerate().filter(|(i, _)| differs(*i)) {
                self.splices.push(Splice::new(coordinate.span.clone(), real(new[i])));
            }
            return Ok(());
        }
        let texts: Vec<String> = (0..3)
            .map(|i| match slots.get(i) {
                Some(c) if !differs(i) => {
                    String::from_utf8_lossy(&self.b.step.bytes[c.span.clone()]).into_owned()
                }
                _ => real(new[i]),
            })
            .collect();
        let made = self.add(&format!("IFCCARTESIANPOINT(({}))", texts.join(",")));
        self.splices.push(Splice::new(slot.span.clone(), format!("#{made}")));
        Ok(())
    }

    fn direction(&mut self, slot: &Arg, new: DVec3) -> Result<(), Why> {
        if let Some(id) = slot.id().filter(|id| self.is_used_once(*id)) {
            let args = self.b.step.args(id);
            let list = args.first().map(Arg::list).unwrap_or_default();
            if list.len() == 3 {
                for (i, ratio) in list.iter().enumerate() {
                    self.splices.push(Splice::new(ratio.span.clone(), real(new[i])));
                }
                return Ok(());
            }
        }
        let made = self.new_direction(new);
        self.splices.push(Splice::new(slot.span.clone(), format!("#{made}")));
        Ok(())
    }

    fn new_direction(&mut self, v: DVec3) -> u64 {
        self.add(&format!("IFCDIRECTION({})", triple(v)))
    }

    fn new_axes(&mut self, m: &DAffine3) -> u64 {
        let at = self.add(&format!("IFCCARTESIANPOINT({})", triple(m.translation)));
        let (z, x) = (m.matrix3.z_axis, m.matrix3.x_axis);
        if z == DVec3::Z && x == DVec3::X {
            return self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},$,$)"));
        }
        let (z, x) = (self.new_direction(z), self.new_direction(x));
        self.add(&format!("IFCAXIS2PLACEMENT3D(#{at},#{z},#{x})"))
    }

    fn add(&mut self, text: &str) -> u64 {
        let id = self.next;
        self.next += 1;
        self.added.extend_from_slice(format!("#{id}={text};").as_bytes());
        self.added.extend_from_slice(super::line_end(self.b.step.bytes));
        id
    }
}

/// By opening that slides in a wall that moves: placements of its own that were moved.
type Slid = HashMap<u64, HashSet<u64>>;

/// Of all that goes with openings that have an edit of their own: the opening, and how far it slides.
fn slides(b: &Building<'_, '_>, edits: &[Edit]) -> HashMap<u64, (u64, DVec2)> {
    let mut out = HashMap::new();
    for edit in edits {
        let Edit::Insert { record, motion } = edit else { continue };
        let opening = *record as u64;
        if b.model.openings.values().flatten().any(|id| *id == opening) {
            out.extend(b.model.follows(opening).into_iter().map(|id| (id, (opening, motion.shift))));
        }
    }
    out
}

/// What an edit moves as a whole.
fn moved_whole(edit: &Edit) -> Option<u64> {
    matches!(edit, Edit::Insert { .. }).then_some(edit.record() as u64)
}

/// What goes with an element; nothing that the element goes with as well.
fn carried(b: &Building<'_, '_>, id: u64) -> Vec<u64> {
    let mut all = b.model.follows(id);
    all.retain(|of| !b.model.follows(*of).contains(&id));
    all
}

/// A relative placement after a motion of the world.
fn moved_axes(base: &DAffine3, own: &DAffine3, motion: &RigidMotion) -> DAffine3 {
    let to_base = base.matrix3.inverse();
    let shift = motion.shift.extend(0.0);
    if motion.turn_rad == 0.0 {
        return DAffine3::from_mat3_translation(own.matrix3, own.translation + to_base * shift);
    }
    let turn = DMat3::from_rotation_z(motion.turn_rad);
    let world = *base * *own;
    let at = turn * world.translation + shift;
    let round =
        |v: DVec3| DVec3::from_array(v.to_array().map(|c| if c.abs() < NOISE_RATIO { 0.0 } else { c }));
    let matrix = to_base * turn * base.matrix3 * own.matrix3;
    let matrix = DMat3::from_cols(round(matrix.x_axis), round(matrix.y_axis), round(matrix.z_axis));
    let mut at = to_base * (at - base.translation);
    // A turn about the vertical keeps heights to the bit where the parent stands upright.
    if super::geo::is_upright(base) {
        at.z = own.translation.z;
    }
    DAffine3::from_mat3_translation(matrix, at)
}

/// Instances that name others to say how these look, or what their parts are.
pub(super) const LABELS: [&str; 5] = [
    "IFCSHAPEASPECT",
    "IFCSTYLEDITEM",
    "IFCINDEXEDCOLOURMAP",
    "IFCPRESENTATIONLAYERASSIGNMENT",
    "IFCPRESENTATIONLAYERWITHSTYLE",
];

/// References from a shape to the coordinates of its body, under as many cuts as one may have.
const SHAPE_DEPTH: usize = 8 + super::limits::BODY_DEPTH_MAX;

/// Who refers to placements, their axes, points and directions, to what the shapes of `longer` are made of, and to `others`.
fn users(
    step: &Step<'_>,
    longer: impl Iterator<Item = u64>,
    others: impl Iterator<Item = u64>,
) -> HashMap<u64, Vec<u64>> {
    let mut wanted: HashMap<u64, Vec<u64>> = others.map(|id| (id, Vec::new())).collect();
    for product in longer {
        let mut level: Vec<u64> = step.args(product).get(6).and_then(Arg::id).into_iter().collect();
        for _ in 0..SHAPE_DEPTH {
            level.retain(|id| wanted.insert(*id, Vec::new()).is_none());
            let below = level.iter().flat_map(|id| step.args(*id));
            level = below.flat_map(|a| a.id().map_or_else(|| a.ids(), |id| vec![id])).collect();
        }
    }
    for i in step.all("IFCLOCALPLACEMENT") {
        wanted.entry(i.id).or_default();
        let axes = step.args_of(i).get(1).and_then(Arg::id);
        if let Some(axes) = axes {
            wanted.entry(axes).or_default();
            for part in step.args(axes).iter().filter_map(Arg::id) {
                wanted.entry(part).or_default();
            }
        }
    }
    for i in &step.instances {
        let text = &step.bytes[i.args.clone()];
        let mut at = 0;
        while let Some(hash) = text[at..].iter().position(|b| *b == b'#') {
            at += hash + 1;
            let digits = text[at..].iter().take_while(|b| b.is_ascii_digit()).count();
            let id = std::str::from_utf8(&text[at..at + digits]).ok().and_then(|t| t.parse::<u64>().ok());
            if let Some(list) = id.and_then(|id| wanted.get_mut(&id)).filter(|l| l.last() != Some(&i.id)) {
                list.push(i.id);
            }
        }
    }
    wanted
}

fn triple(v: DVec3) -> String {
    format!("({},{},{})", real(v.x), real(v.y), real(v.z))
}
