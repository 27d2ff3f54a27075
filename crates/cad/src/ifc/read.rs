//! One storey of a building as a plan: every element cut at the height of the eyes.

mod covered;
mod north;
mod outdoors;
mod slots;
mod told;

use std::collections::{BTreeSet, HashSet};
use std::sync::OnceLock;

use glam::{DAffine3, DVec2};
use rayon::prelude::*;

use super::building::{Building, refusal};
use super::geo::{Geo, Why, is_upright, plan_point};
use super::heights::{heights, sizes, wall_spans};
use super::length;
use super::limits::OUTLINE_POINTS_MAX;
use super::model::{Model, Product, Storey, axis_item, body_items, layer_reach};
use super::phase::phase;
use super::step::Step;
use super::units::units;
use super::{CUT_EYE_M, ReadOptions, Sight};
use crate::drawing::{
    Drawing, Editable, Entity, Format, IdleMarks, Layer, MarkedMove, Shape, Slot, Text, Unit, Vertex,
};
use crate::own_layers::DEMOLISHED;
use crate::phase::Phase;
use crate::region::{Region, Rule};
use crate::sizes::Verdict;
use crate::storeys::{is_over, refuse_without_own, state_cut, state_shared_name, state_taken};
use crate::units::by_heights;
use crate::{SpaceNames, main_storey, no_storey, storey_at};
use enfilade_report::{Error, Place, Report};
use north::{north_deg, state_north};
pub use outdoors::OUTDOORS_LAYER;
use told::Standing;

/// Layer of everything that closes a gap without blocking sight: plugs of door and window openings.
pub const CLOSING_LAYERS: [&str; 4] = ["IfcDoor", "IfcWindow", "IfcOpeningElement", "IfcCurtainWall"];

/// Layer of spaces and their names.
pub const SPACE_LAYER: &str = "IfcSpace";

/// Layer of the names of zones, each at the middle of one of its spaces.
pub const ZONE_LAYER: &str = "IfcZone";

/// Layer of a window without a wall at the height where windows block.
const KNEE_WINDOW_LAYER: &str = "IfcWall (window at knee height)";

/// A wall this thin behind an opening is what rounding left, no wall.
const SLIVER_M: f64 = 0.01;

/// Corners of a cut this near to an end of the wall belong to it.
const END_M: f64 = 1e-5;

impl<'s, 'a> Building<'s, 'a> {
    /// Reads units, products and relations. `wanted` is the user's word for the unit; where neither the user nor the
    /// file says one, the heights of the walls do.
    pub fn new(file: &'s str, step: &'s Step<'a>, wanted: Option<Unit>) -> Self {
        let units = units(step);
        let known = wanted.or(units.length);
        let geo = Geo::new(step, known.map_or(1.0, |u| u.metres), units.radians);
        let model = Model::read(step, &geo);
        let (unit_by_heights, unit_doubt, standing) = (None, None, OnceLock::new());
        let mut out = Self { file, step, geo, model, units, unit_by_heights, unit_doubt, standing };
        match (wanted, out.units.length) {
            (Some(_), _) => {}
            (None, None) => {
                let heights: Vec<f64> = wall_spans(&out, usize::MAX).iter().map(|s| s[1] - s[0]).collect();
                out.unit_by_heights = by_heights(&heights);
                out.geo.metres = out.unit_by_heights.map_or(1.0, |u| u.metres);
            }
            (None, Some(stated)) => out.hold_against_sizes(stated),
        }
        out.settle_floors();
        out.measure_tops();
        out
    }

    /// Measures how high the own walls of those storeys reach over which another one begins below the eyes.
    fn measure_tops(&mut self) {
        let storeys = super::storeys(self);
        let has_other_over = |i: usize| {
            let floor = storeys[i].floor_m;
            storeys.iter().any(|s| s.walls > 0 && is_over(floor, s.floor_m, CUT_EYE_M))
        };
        let tops = (0..storeys.len()).map(|i| if has_other_over(i) { self.top(i) } else { None });
        let tops: Vec<Option<f64>> = tops.collect();
        self.model.storeys.iter_mut().zip(tops).for_each(|(s, top)| s.top = top);
    }

    /// The highest point of a storey's own walls and columns; none where it is not known.
    fn top(&self, storey: usize) -> Option<f64> {
        let id = self.model.storeys[storey].id;
        let own =
            self.model.products.iter().filter(|p| told::is_wall(p) && self.model.storey_of(p.id) == Some(id));
        own.map(|p| self.reach(p).map(|r| r[1])).try_fold(f64::NEG_INFINITY, |top, high| Some(top.max(high?)))
    }

    /// Whether what the building's elements measure can be in the unit that the file states; else takes the one in which
    /// it can.
    fn hold_against_sizes(&mut self, stated: Unit) {
        match sizes(self).verdict(stated) {
            Verdict::Believed => {}
            Verdict::Instead(unit, against) => {
                self.units.length_words += &format!(", in which it has {against}");
                self.unit_by_heights = Some(unit);
                self.geo.metres = unit.metres;
            }
            Verdict::Doubted(text) => self.unit_doubt = Some(text),
        }
    }

    /// Lowest and highest point of an element's body; none where a part of it cannot be read.
    fn reach(&self, p: &Product) -> Option<[f64; 2]> {
        let world = p.placement.map_or(Ok(DAffine3::IDENTITY), |m| self.geo.placement(m)).ok()?;
        let items = body_items(self.step, p.shape?).ok()?;
        let reach = |item: &u64| self.geo.reach(*item, &world, 0).ok().filter(|r| r[1].is_finite());
        let all = items.iter().map(reach).collect::<Option<Vec<_>>>()?;
        all.into_iter().reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// What a space is called, and its zones.
    pub fn space_names(&self, p: &Product) -> SpaceNames {
        let args_of = |zone: &u64| self.step.args(*zone);
        let name_of = |zone: &u64| args_of(zone).get(2).and_then(|a| self.step.text(a)).unwrap_or_default();
        let some = |names: Vec<String>| {
            let names = names.iter().map(|n| n.trim()).filter(|n| !n.is_empty());
            names.map(String::from).collect()
        };
        let zones = self.model.zones_of(p.id).iter().map(name_of).collect();
        SpaceNames { names: some(vec![p.name.clone(), p.long_name.clone()]), zones: some(zones) }
    }

    /// The storey that is meant, and why. `None` in a building without storeys.
    pub fn storey(
        &self,
        wanted: Option<&str>,
        sight: Sight,
        report: &mut Report,
    ) -> Result<Option<&Storey>, Error> {
        let list = &self.model.storeys;
        if let Some(name) = wanted {
            state_shared_name(self.file, &super::storeys(self), name, report);
            let found = storey_at(list.iter().map(|s| s.name.as_str()), name);
            return found.map(|i| Some(&list[i])).ok_or_else(|| {
                let why = no_storey(&super::storeys(self), name, "none");
                Error::usage("storey", Place::file(self.file), format!("--storey \"{name}\": {why}"))
            });
        }
        let all = super::storeys(self);
        let most = main_storey(&all, sight.above_m());
        if let Some(chosen) = most.filter(|_| all.len() > 1) {
            state_taken(self.file, &all, &all[chosen], report);
        }
        Ok(most.map(|i| &list[i]))
    }
}

/// Reads one storey.
///
/// # Errors
/// [`Error::Usage`] for a storey that is not there.
pub(super) fn read_storey(
    building: &Building<'_, '_>,
    options: &ReadOptions,
    report: &mut Report,
) -> Result<Drawing, Error> {
    let file = building.file;
    state_broken(file, building.step, report);
    for global_id in &building.model.twice {
        let text = format!(
            "GlobalId {global_id} is given to several elements, expected one; they are read and stay as drawn"
        );
        report.warn("ifc-duplicate-global-id", Place::file(file), text);
    }
    for (id, ring) in &building.model.part_rings {
        let line = building.step.get(*id).map(|i| building.step.line(i.span.start));
        let place = Place { file: file.into(), line, entity: building.geo.named(*id) };
        let text = format!(
            "it is a part of itself ({ring}), expected a whole of its own; each of these stands for itself"
        );
        report.warn("ifc-part-ring", place, text);
    }
    if let Some(doubt) = &building.unit_doubt {
        let text = format!("unit: {doubt}; read as the file says");
        report.warn("unit-doubt", Place::file(file), text);
    }
    let storey = building.storey(options.storey.as_deref(), options.sight, report)?;
    if let Some(index) = building.model.storeys.iter().position(|s| storey.is_some_and(|own| own.id == s.id))
    {
        refuse_without_own(file, &super::storeys(building), index, options.sight.above_m())?;
    }
    let mut reader = Reader::new(building, storey, options);
    if let Some(storey) = storey {
        building.state_floor(storey, &reader.beside, report);
    }
    reader.walls(report);
    reader.spaces(report);
    reader.outdoors(report);
    let shown: HashSet<u64> = reader.entities.iter().map(|e| e.source.record as u64).collect();
    reader.idle_marks = super::marks::state(building, reader.storey, &shown, report);
    let height = reader.cut - reader.floor;
    if let Some(storey) = storey {
        let heights = [height, storey.floor].map(|h| h * building.geo.metres);
        state_cut(file, &storey.name, heights, report);
    } else {
        let metres = building.geo.metres;
        let (height, floor) = (height * metres, reader.floor * metres);
        let text = format!("no storeys in the file; cut {height:.2} m above the floor found at {floor:.3} m");
        report.info("ifc-cut", Place::file(file), text);
    }
    reader.state_left_out(report);
    state_north(building, report);
    let drawing = reader.drawing();
    if drawing.north_deg != 0.0 {
        let way = if drawing.north_deg > 0.0 { "left" } else { "right" };
        let text = format!(
            "its true north is {:.1}° to the {way} of the plan's up; arrows and words of direction follow it",
            drawing.north_deg.abs()
        );
        report.info("true-north", Place::file(file), text);
    }
    Ok(drawing)
}

fn state_broken(file: &str, step: &Step<'_>, report: &mut Report) {
    for fault in step.broken.iter().take(20) {
        let place = Place::line(file, step.line(fault.at));
        report.warn(
            "ifc-instance",
            place,
            format!("byte {}: {}; the instance is left out", fault.at, fault.text),
        );
    }
    if step.broken.len() > 20 {
        let text = format!("{} more instances cannot be read and are left out", step.broken.len() - 20);
        report.warn("ifc-instance", Place::file(file), text);
    }
    if let Some(id) = step.duplicates.first() {
        let text = format!(
            "#{id} is given {} times, expected each number once; read with the last one, nothing can be moved in this file",
            step.instances.iter().filter(|i| i.id == *id).count()
        );
        report.warn("ifc-duplicate-id", Place::file(file), text);
    }
}

struct Reader<'b, 's, 'a> {
    b: &'b Building<'s, 'a>,
    options: &'b ReadOptions,
    floor: f64,
    cut: f64,
    storey: Option<u64>,
    /// Storeys of buildings that stand elsewhere.
    beside: HashSet<u64>,
    entities: Vec<Entity>,
    texts: Vec<Text>,
    marked: Vec<MarkedMove>,
    /// Moves that are stated of elements that are not shown, or in a way that is not read.
    idle_marks: IdleMarks,
    below: HashSet<u64>,
    plugged: HashSet<u64>,
    /// The element shown now where it can change its length, and the corners of what closes its openings, world.
    bar: Option<(length::Bar, Vec<DVec2>)>,
    /// Openings that can slide.
    slots: Vec<Slot>,
    /// Walls that keep their length, and why.
    stiff: Vec<(u64, Why)>,
    /// Elements that are to be built.
    built: BTreeSet<usize>,
    /// Elements that stand only while the works last.
    temporary: Vec<u64>,
    /// Walls and columns of other storeys of which a part cannot be read.
    elsewhere: Vec<u64>,
}

/// An element cut at the height of the eyes, world coordinates.
#[derive(Default)]
struct ElementCut<'p> {
    /// What blocks sight.
    region: Region,
    /// Why a part of it is missing.
    missing: Vec<Why>,
    /// What stands for a body that cannot be read, and why.
    instead: Option<Why>,
    /// What closes its openings without blocking sight.
    closings: Vec<Closing<'p>>,
    /// Doors and windows that stand in one of its openings.
    plugged: Vec<u64>,
    /// Of a wall, how it changes its length, or why it does not.
    bar: Option<Result<length::Bar, Why>>,
    /// Its openings that can slide.
    slots: Vec<Slot>,
}

/// What closes an opening.
struct Closing<'p> {
    /// Whose it is.
    of: &'p Product,
    layer: &'static str,
    region: Region,
    /// The opening; none for glass of a curtain wall.
    opening: Option<u64>,
}

/// A product's frame: how its own plane lies in the world, and at which height of it to cut.
struct Frame {
    /// The product's placement; the identity where it has none or leans.
    world: DAffine3,
    /// From the placement to the frame that is cut: the identity, or the placement itself where it leans.
    to: DAffine3,
    z: f64,
}

impl<'b, 's, 'a> Reader<'b, 's, 'a> {
    fn new(b: &'b Building<'s, 'a>, storey: Option<&Storey>, options: &'b ReadOptions) -> Self {
        let (floor, cut) = heights(b, storey, options.sight);
        Self {
            b,
            options,
            floor,
            cut,
            storey: storey.map(|s| s.id),
            beside: storey.map(|s| b.storeys_beside(s.id)).unwrap_or_default(),
            entities: Vec::new(),
            texts: Vec::new(),
            marked: Vec::new(),
            idle_marks: IdleMarks::None,
            below: HashSet::new(),
            plugged: HashSet::new(),
            bar: None,
            slots: Vec::new(),
            stiff: Vec::new(),
            built: BTreeSet::new(),
            temporary: Vec::new(),
            elsewhere: Vec::new(),
        }
    }

    fn frame(&self, placement: Option<u64>) -> Result<Frame, Why> {
        let world = placement.map_or(Ok(DAffine3::IDENTITY), |p| self.b.geo.placement(p))?;
        if is_upright(&world) {
            Ok(Frame { world, to: DAffine3::IDENTITY, z: self.cut - world.translation.z })
        } else {
            Ok(Frame { world: DAffine3::IDENTITY, to: world, z: self.cut })
        }
    }

    fn walls(&mut self, report: &mut Report) {
        let b = self.b;
        let is_shown =
            |p: &&Product| p.class != "IfcSpace" && !self.is_part_of_shown(p) && !self.is_beside(p.id);
        let shown: Vec<&'b Product> = b.model.products.iter().filter(is_shown).collect();
        let cuts: Vec<Result<ElementCut<'b>, Why>> = shown.par_iter().map(|p| self.element(p)).collect();
        self.state_covered(&shown, &cuts, report);
        for (p, cut) in shown.into_iter().zip(cuts) {
            match cut {
                Ok(cut) => self.show(p, cut, report),
                Err(why) => self.state_missing(p, &why, report),
            }
        }
        self.loose_fillers();
    }

    fn show(&mut self, p: &Product, cut: ElementCut<'_>, report: &mut Report) {
        match phase(self.b.step, &self.b.model, p.id) {
            Phase::Existing => {}
            Phase::New => {
                self.built.insert(p.id as usize);
            }
            Phase::Demolished => {
                let closings = cut.closings.iter().map(|c| &c.region);
                let whole = closings.fold(cut.region, |all, c| all.combine(c, Rule::Union));
                self.plugged.extend(cut.plugged);
                self.emit(p, DEMOLISHED, &whole);
                return;
            }
            Phase::Temporary => {
                self.plugged.extend(cut.plugged);
                if !cut.region.is_empty() {
                    self.temporary.push(p.id);
                }
                return;
            }
        }
        for closing in &cut.closings {
            self.emit(closing.of, closing.layer, &closing.region);
        }
        self.slots.extend(cut.slots);
        self.plugged.extend(cut.plugged);
        for why in cut.missing {
            self.state_missing(p, &why, report);
        }
        if let Some(text) = cut.instead {
            report.warn("ifc-axis", self.b.place(p), text);
        }
        let size = cut.region.size();
        if cut.region.is_empty() {
            self.below.insert(p.id);
        } else if size > OUTLINE_POINTS_MAX {
            let why = format!("its cut has {size} corners, expected at most {OUTLINE_POINTS_MAX}");
            self.state_missing(p, &why, report);
        } else {
            let holes = || cut.closings.iter().flat_map(|c| c.region.points()).collect();
            match cut.bar {
                Some(Ok(bar)) => self.bar = Some((bar, holes())),
                Some(Err(why)) => self.stiff.push((p.id, why)),
                None => {}
            }
            self.emit(p, p.class, &cut.region);
            self.bar = None;
        }
    }

    /// Whether an element belongs to a building that stands elsewhere.
    fn is_beside(&self, id: u64) -> bool {
        !self.beside.is_empty() && self.b.model.storey_of(id).is_some_and(|s| self.beside.contains(&s))
    }

    /// Members and plates of a curtain wall are shown with it.
    fn is_part_of_shown(&self, p: &Product) -> bool {
        let whole = self.b.model.whole.get(&p.id);
        whole.and_then(|w| self.b.model.product(*w)).is_some_and(|q| q.class != "IfcSpace")
    }

    /// What of an element stands at the height of the cut, in world coordinates.
    fn element(&self, p: &'b Product) -> Result<ElementCut<'b>, Why> {
        let frame = self.frame(p.placement)?;
        let mut out = ElementCut::default();
        match p.shape {
            Some(shape) => match self.body(p, shape, &frame) {
                Ok((body, whys)) => (out.region, out.missing) = (body, whys),
                Err(why) => match self.strip_along_axis(p, shape, &frame) {
                    Some((strip, thick)) => {
                        out.region = strip;
                        let thick = told::metres(thick * self.b.geo.metres);
                        out.instead = Some(format!(
                            "{why}, expected a body to cut; taken from its axis and layers, {thick} m thick, as if it reached the height of the cut"
                        ));
                    }
                    None => return Err(why),
                },
            },
            None if self.b.model.parts.contains_key(&p.id) => {}
            None => return Err("it has no shape".into()),
        }
        self.take_openings_out(p, &frame, &mut out);
        let mut region = out.region.map(|q| plan_point(&frame.world, q));
        let mut failed: Vec<(u64, Why)> = Vec::new();
        for part in &self.b.model.parts_of(p.id) {
            let class = self.b.model.product(*part).map(|q| q.class);
            let is_wall = self.options.is_glass_wall && p.class == "IfcCurtainWall";
            let is_seen_through = self.options.sight == Sight::Eye && !is_wall;
            let is_glass = class == Some("IfcPlate") && is_seen_through;
            // A door in it is shown by itself, and a window as long as it is seen through.
            match self.b.model.filler(*part).map(|f| f.class) {
                Some("IfcDoor") => continue,
                Some(_) if is_seen_through => continue,
                _ => {}
            }
            let cut = match self.part(*part) {
                Ok(cut) => cut,
                Err(why) => {
                    failed.push((*part, why));
                    continue;
                }
            };
            if is_glass {
                out.closings.push(Closing { of: p, layer: "IfcWindow", region: cut, opening: None })
            } else {
                region = region.combine(&cut, Rule::Union)
            }
        }
        if let Some((part, why)) = failed.first() {
            let more = failed.len() - 1;
            let others = if more > 0 { format!(" and {more} more") } else { String::new() };
            out.missing.push(format!("its part #{part}{others}: {why}"));
        }
        if !region.is_within_reach() {
            return Err("it lies beyond all buildings".into());
        }
        out.closings.retain(|c| c.region.is_within_reach());
        let is_wall = p.class.starts_with("IfcWall") && !region.is_empty();
        let bar = is_wall.then(|| length::bar(self.b, p.id));
        let slots = bar.iter().flatten().flat_map(|bar| self.slots(p, bar.along, &region, &out.closings));
        let slots = slots.collect();
        Ok(ElementCut { region, bar, slots, ..out })
    }

    fn part(&self, id: u64) -> Result<Region, Why> {
        let p = super::model::product(self.b.step, id, "IfcMember");
        let frame = self.frame(p.placement)?;
        // A part that shows nothing is missing nowhere.
        let Some(shape) = p.shape else { return Ok(Region::default()) };
        let cut = self.b.geo.cut_items(&body_items(self.b.step, shape)?, &frame.to, frame.z);
        Ok(cut.region.map(|q| plan_point(&frame.world, q)))
    }

    fn body(&self, p: &Product, shape: u64, frame: &Frame) -> Result<(Region, Vec<Why>), Why> {
        let items = body_items(self.b.step, shape)?;
        let cut = self.b.geo.cut_items(&items, &frame.to, frame.z);
        if cut.region.is_empty() && !cut.missing.is_empty() {
            return Err(cut.missing[0].clone());
        }
        if cut.region.is_empty() && self.standing(p) == Standing::Here {
            let mut whys = items.iter().filter_map(|i| self.b.geo.without_width(*i, 0));
            if let Some(why) = whys.next() {
                return Err(why);
            }
        }
        Ok((cut.region, cut.missing))
    }

    /// A strip along the axis, as thick as the material layers, and how thick that is.
    fn strip_along_axis(&self, p: &Product, shape: u64, frame: &Frame) -> Option<(Region, f64)> {
        let axis = self.b.geo.curve(axis_item(self.b.step, shape)?, 0).ok()?;
        let [left, right] = layer_reach(self.b.step, &self.b.model, p.id)?;
        let is_here = self.b.model.storey_of(p.id) == self.storey;
        let region = super::body::strip(&axis, left, right);
        let is_shown = is_here && !region.is_empty();
        is_shown.then(|| (region.map(|q| plan_point(&frame.to, q)), right - left))
    }

    /// Takes the openings out; what closes them is shown on the layer of its class.
    fn take_openings_out(&self, p: &'b Product, frame: &Frame, out: &mut ElementCut<'b>) {
        for opening in self.b.model.openings.get(&p.id).into_iter().flatten() {
            let (hole, whys) =
                self.opening(*opening, p, frame).unwrap_or_else(|why| (Region::default(), vec![why]));
            out.missing.extend(whys.iter().map(|why| format!("its opening #{opening}: {why}")));
            let filler = self.filler(*opening);
            let hole = hole.through(&out.region, SLIVER_M / self.b.geo.metres);
            let plug = out.region.clone().combine(&hole, Rule::Intersection);
            if plug.is_empty() {
                continue;
            }
            out.plugged.extend(filler.map(|f| f.id));
            let class = filler.map_or("IfcOpeningElement", |f| f.class);
            if class == "IfcWindow" && self.options.sight == Sight::Knee {
                continue;
            }
            out.region = std::mem::take(&mut out.region).combine(&hole, Rule::Difference);
            let world = plug.map(|q| plan_point(&frame.world, q));
            out.closings.push(Closing {
                of: filler.unwrap_or(p),
                layer: class,
                region: world,
                opening: Some(*opening),
            });
        }
    }

    fn filler(&self, opening: u64) -> Option<&'b Product> {
        let ids = self.b.model.fillings.get(&opening)?;
        ids.iter().find_map(|id| self.b.model.filler(*id))
    }

    /// An opening in the frame of its wall, and why parts of it are missing.
    fn opening(&self, id: u64, wall: &Product, frame: &Frame) -> Result<(Region, Vec<Why>), Why> {
        let p = super::model::product(self.b.step, id, "IfcOpeningElement");
        let shape = p.shape.ok_or("it has no shape")?;
        let m = match (p.placement, wall.placement) {
            (Some(inner), Some(outer)) => self.b.geo.relative(inner, outer)?,
            (Some(inner), None) => self.b.geo.placement(inner)?,
            (None, _) => frame.world.inverse(),
        };
        let cut = self.b.geo.cut_items(&body_items(self.b.step, shape)?, &(frame.to * m), frame.z);
        Ok((cut.region, cut.missing))
    }

    /// Doors and windows that fill no opening: a box round their cut.
    fn loose_fillers(&mut self) {
        for p in &self.b.model.fillers {
            if self.plugged.contains(&p.id) || self.is_beside(p.id) {
                continue;
            }
            let Some(Ok(frame)) = p.shape.map(|_| self.frame(p.placement)) else { continue };
            let Some(Ok((region, _))) = p.shape.map(|s| self.body(p, s, &frame)) else { continue };
            if let Some(corners) = region.box_along() {
                let ring = corners.map(|c| c.to_array()).to_vec();
                let blocks = p.class == "IfcWindow" && self.options.sight == Sight::Knee;
                self.emit(
                    p,
                    if blocks { KNEE_WINDOW_LAYER } else { p.class },
                    &Region::ring(ring).map(|q| plan_point(&frame.world, q)),
                );
            }
        }
    }

    fn spaces(&mut self, report: &mut Report) {
        for p in self.b.model.products.iter().filter(|p| p.class == "IfcSpace") {
            let is_here = self.b.model.storey_of(p.id) == self.storey;
            let Some(shape) = p.shape.filter(|_| is_here) else { continue };
            let cut = self.frame(p.placement).and_then(|frame| {
                let (region, _) = self.body(p, shape, &frame)?;
                Ok(region.map(|q| plan_point(&frame.world, q)))
            });
            match cut {
                Ok(region) => {
                    self.state_external(p, &region, report);
                    self.space(p, &region);
                }
                Err(why) => {
                    report.info("ifc-space", self.b.place(p), format!("{why}; the space is left out"))
                }
            }
        }
    }

    fn space(&mut self, p: &Product, region: &Region) {
        let Some([lo, hi]) = region.extent() else { return };
        self.keep_reached(region);
        self.emit(p, "IfcSpace", region);
        if self.is_external(p) {
            self.emit(p, OUTDOORS_LAYER, region);
        }
        let SpaceNames { names, zones: of_zones } = self.b.space_names(p);
        for (layer, names) in [("IfcSpace", names), (ZONE_LAYER, of_zones)] {
            if layer == "IfcSpace" || !names.is_empty() {
                let (source, text) = (self.b.source(p, layer), names.join("\n"));
                self.texts.push(Text { source, layer: layer.into(), at: lo.midpoint(hi), text });
            }
        }
        let marks = super::marks::of_space(self.b, p.id);
        let said = |key: &str| marks.get(key).map_or_else(String::new, |v| v.trim().to_lowercase());
        for (key, layer) in [("query", "EF-QUERY"), ("reference", "EF-REFERENCE"), ("keep", "EF-KEEP")] {
            match (super::marks::is_yes(&said(key)), key) {
                (Some(true), _) => self.emit(p, layer, region),
                (Some(false), _) | (None, "keep") => {}
                (None, _) => self.emit(p, &format!("{layer}-{}", said(key)), region),
            }
        }
    }

    fn emit(&mut self, p: &Product, layer: &str, region: &Region) {
        let source = self.b.source(p, layer);
        let mut editable = self.editable(p);
        if super::marks::Use::of(p.class) == super::marks::Use::Moves {
            let marks = self.b.model.marks(self.b.step, p.id);
            if let Some(text) = marks.get("move").filter(|t| !t.trim().is_empty())
                && self.marked.iter().all(|m| m.record != source.record)
            {
                let own = marks.get("name").map(|n| n.trim()).filter(|n| !n.is_empty());
                self.marked.push(MarkedMove {
                    name: own.unwrap_or(p.name.trim()).into(),
                    is_named: own.is_some(),
                    text: text.clone(),
                    record: source.record,
                    source: source.clone(),
                });
            }
            if let Some(why) = super::marks::kept(self.b, p.id) {
                editable = Editable::No(why);
            }
        }
        let bar = self.bar.clone().filter(|_| layer == p.class && editable.moves_whole());
        let closed = region.rings().filter(|r| r.len() > 2).map(|r| (r, true));
        for (ring, closed) in closed.chain(region.lines.iter().filter(|l| l.len() > 1).map(|l| (l, false))) {
            let vertices = ring.iter().map(|p| Vertex { at: DVec2::from(*p), bulge: 0.0 }).collect();
            self.entities.push(Entity {
                source: source.clone(),
                layer: layer.into(),
                shape: Shape::Polyline { vertices, closed },
                editable: bar
                    .as_ref()
                    .map_or_else(|| editable.clone(), |(bar, holes)| self.with_ends(bar, holes, ring)),
                blocks: Vec::new(),
                origin: Default::default(),
            });
        }
    }

    /// An outline of a wall that can change its length; an end that an opening reaches stays.
    fn with_ends(&self, bar: &length::Bar, holes: &[DVec2], ring: &[[f64; 2]]) -> Editable {
        let near = END_M / self.b.geo.metres;
        let is_at = |end: usize, p: DVec2| match end {
            0 => p.dot(bar.along) <= bar.inner[0] + near,
            _ => p.dot(bar.along) >= bar.inner[1] - near,
        };
        let ends = [0, 1].map(|end| {
            let is_open = holes.iter().any(|p| is_at(end, *p));
            let corners = ring.iter().enumerate().filter(|(_, p)| !is_open && is_at(end, DVec2::from(**p)));
            corners.map(|(c, _)| c as u32).collect()
        });
        Editable::Wall { ends, free: bar.free }
    }

    fn editable(&self, p: &Product) -> Editable {
        match refusal(self.b, p.id) {
            Some(why) => Editable::No(why),
            None => Editable::WithInsert { turnable: true },
        }
    }

    fn drawing(self) -> Drawing {
        let hosts = self.b.model.hosts().iter().map(|(f, w)| (*f as usize, *w as usize)).collect();
        let mut layers: Vec<Layer> = Vec::new();
        for e in &self.entities {
            if layers.iter().all(|l| l.name != e.layer) {
                layers.push(Layer {
                    name: e.layer.clone(),
                    is_off: false,
                    is_frozen: false,
                    is_locked: false,
                });
            }
        }
        let things = super::structure::things(self.b, [self.floor, self.cut]);
        Drawing {
            file: self.b.file.into(),
            format: Format::Ifc,
            version: self.b.step.schema.clone(),
            declared_unit: self.b.units.length,
            declared_unit_words: self.b.units.length_words.clone(),
            unit_by_heights: self.b.unit_by_heights,
            layers,
            entities: self.entities,
            hosts,
            slots: self.slots,
            texts: self.texts,
            fills: Vec::new(),
            marked: self.marked,
            idle_marks: self.idle_marks,
            bearing: super::structure::of_storey(self.b, self.storey, self.cut),
            called: super::structure::called(self.b, &things),
            things,
            tags: Vec::new(),
            widths: Default::default(),
            singles: Default::default(),
            undrawn: Vec::new(),
            unbound: 0,
            records: Vec::new(),
            written: Default::default(),
            north_deg: north_deg(self.b),
            built: self.built,
            wishes: super::wishes::wishes(self.b),
        }
    }
}
