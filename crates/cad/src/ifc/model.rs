//! Products and how they hang together.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use super::geo::{Geo, Why};
use super::step::{Arg, Step};

/// Classes that are read as shapes: keyword, name of their layer.
const CLASSES: &[(&str, &str)] = &[
    ("IFCWALL", "IfcWall"),
    ("IFCWALLSTANDARDCASE", "IfcWallStandardCase"),
    ("IFCWALLELEMENTEDCASE", "IfcWallElementedCase"),
    ("IFCCURTAINWALL", "IfcCurtainWall"),
    ("IFCCOLUMN", "IfcColumn"),
    ("IFCCOLUMNSTANDARDCASE", "IfcColumnStandardCase"),
    ("IFCRAILING", "IfcRailing"),
    ("IFCFURNISHINGELEMENT", "IfcFurnishingElement"),
    ("IFCFURNITURE", "IfcFurniture"),
    ("IFCSYSTEMFURNITUREELEMENT", "IfcSystemFurnitureElement"),
    ("IFCBUILDINGELEMENTPROXY", "IfcBuildingElementProxy"),
    ("IFCCHIMNEY", "IfcChimney"),
    ("IFCSTAIR", "IfcStair"),
    ("IFCSTAIRFLIGHT", "IfcStairFlight"),
    ("IFCMEMBER", "IfcMember"),
    ("IFCPLATE", "IfcPlate"),
    ("IFCSPACE", "IfcSpace"),
];

/// Classes that fill openings.
const FILLERS: &[(&str, &str, bool)] = &[
    ("IFCDOOR", "IfcDoor", true),
    ("IFCDOORSTANDARDCASE", "IfcDoor", true),
    ("IFCWINDOW", "IfcWindow", false),
    ("IFCWINDOWSTANDARDCASE", "IfcWindow", false),
];

/// Classes that gather spaces.
const ZONES: [&str; 2] = ["IFCZONE", "IFCSPATIALZONE"];

/// Zones of one space, each in others: a room is in one of a dozen kinds at most.
const ZONES_MAX: usize = 1_000;

/// A product with what is needed of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Product {
    /// Instance.
    pub id: u64,
    /// Layer its shapes stand on: the class as written in the standard.
    pub class: &'static str,
    /// `GlobalId`.
    pub global_id: String,
    /// `Name`.
    pub name: String,
    /// `LongName` of a space.
    pub long_name: String,
    /// `Tag`: in files of Revit the element's id there.
    pub tag: Option<String>,
    /// `ObjectPlacement`.
    pub placement: Option<u64>,
    /// `Representation`.
    pub shape: Option<u64>,
}

/// A storey.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Storey {
    /// Instance.
    pub id: u64,
    /// `Name`, else `#id`.
    pub name: String,
    /// Height of its floor, file units.
    pub floor: f64,
    /// `Elevation`, file units, where its placement says another height.
    pub elevation: Option<f64>,
    /// Where it is placed, file units, where the floor was taken from its elevation instead.
    pub placed: Option<f64>,
    /// The building that it is a storey of.
    pub building: Option<u64>,
    /// Walls that stand in it.
    pub walls: usize,
    /// Highest point of its own walls and columns, file units, see [`StoreyInfo::top_m`].
    ///
    /// [`StoreyInfo::top_m`]: crate::StoreyInfo::top_m
    pub top: Option<f64>,
}

/// Relations of one file.
#[derive(Clone, Debug, Default)]
pub(super) struct Model {
    /// Products that are read as shapes, file order.
    pub products: Vec<Product>,
    /// Doors and windows, file order.
    pub fillers: Vec<Product>,
    /// Element → its openings.
    pub openings: HashMap<u64, Vec<u64>>,
    /// Opening → what fills it.
    pub fillings: HashMap<u64, Vec<u64>>,
    /// Whole → parts.
    pub parts: HashMap<u64, Vec<u64>>,
    /// Part → whole.
    pub whole: HashMap<u64, u64>,
    /// Element → spatial structure.
    pub inside: HashMap<u64, u64>,
    /// Element → its coverings.
    pub coverings: HashMap<u64, Vec<u64>>,
    /// Element → property sets.
    pub properties: HashMap<u64, Vec<u64>>,
    /// Element → property sets of its type.
    pub of_types: HashMap<u64, Vec<u64>>,
    /// Space or zone → the zones it is in.
    zones: HashMap<u64, Vec<u64>>,
    /// Element → materials.
    pub materials: HashMap<u64, u64>,
    /// Storeys from the lowest.
    pub storeys: Vec<Storey>,
    /// Elements that are parts of themselves, each with the ring: `#12>#14>#12`.
    pub part_rings: Vec<(u64, String)>,
    /// Shape → representations that show parts of it by themselves.
    pub aspects: HashMap<u64, Vec<u64>>,
    /// The same the other way round.
    pub aspect_of: HashMap<u64, u64>,
    /// `GlobalId`s of several products.
    pub twice: BTreeSet<String>,
    /// Instance → place in `products`.
    product_at: HashMap<u64, usize>,
    /// Instance → place in `fillers`.
    filler_at: HashMap<u64, usize>,
    /// Instances of `storeys`.
    storey_ids: HashSet<u64>,
}

impl Model {
    /// Doors and windows by the wall in whose opening they sit, instances; of several the first.
    pub fn hosts(&self) -> BTreeMap<u64, u64> {
        let mut out = BTreeMap::new();
        for (wall, openings) in &self.openings {
            for filler in openings.iter().filter_map(|o| self.fillings.get(o)).flatten() {
                let host = out.entry(*filler).or_insert(*wall);
                *host = (*host).min(*wall);
            }
        }
        out
    }

    /// Reads relations, products and storeys.
    pub fn read(step: &Step<'_>, geo: &Geo<'_, '_>) -> Self {
        let mut out = Self::default();
        out.relations(step);
        out.products = products(step, CLASSES.iter().copied());
        out.fillers = products(step, FILLERS.iter().map(|f| (f.0, f.1)));
        out.fill_by_placement(step);
        out.product_at = out.products.iter().enumerate().map(|(i, p)| (p.id, i)).collect();
        out.filler_at = out.fillers.iter().enumerate().map(|(i, p)| (p.id, i)).collect();
        out.storeys = out.storeys(step, geo);
        out.storey_ids = out.storeys.iter().map(|s| s.id).collect();
        let mut seen = HashSet::new();
        for p in out.products.iter().chain(&out.fillers).filter(|p| !p.global_id.is_empty()) {
            if !seen.insert(&p.global_id) {
                out.twice.insert(p.global_id.clone());
            }
        }
        out
    }

    fn relations(&mut self, step: &Step<'_>) {
        for (one, many) in pairs(step, "IFCRELVOIDSELEMENT", 4, 5) {
            self.openings.entry(one).or_default().extend(many);
        }
        for (one, many) in pairs(step, "IFCRELFILLSELEMENT", 4, 5) {
            self.fillings.entry(one).or_default().extend(many);
        }
        // What is added to a wall, a pier or a chimney breast, is a part of it as it stands.
        let wholes = ["IFCRELAGGREGATES", "IFCRELNESTS", "IFCRELPROJECTSELEMENT"];
        for (one, many) in wholes.into_iter().flat_map(|relation| pairs(step, relation, 4, 5)) {
            self.whole.extend(many.iter().map(|m| (*m, one)));
            self.parts.entry(one).or_default().extend(many);
        }
        self.open_rings();
        for (one, many) in pairs(step, "IFCRELCONTAINEDINSPATIALSTRUCTURE", 5, 4) {
            self.inside.extend(many.iter().map(|m| (*m, one)));
        }
        for (one, many) in pairs(step, "IFCRELCOVERSBLDGELEMENTS", 4, 5) {
            self.coverings.entry(one).or_default().extend(many);
        }
        for (set, many) in pairs(step, "IFCRELDEFINESBYPROPERTIES", 5, 4) {
            many.iter().for_each(|m| self.properties.entry(*m).or_default().push(set));
        }
        for (kind, many) in pairs(step, "IFCRELDEFINESBYTYPE", 5, 4) {
            let sets = step.args(kind).get(5).map(Arg::ids).unwrap_or_default();
            many.iter().for_each(|m| self.of_types.entry(*m).or_default().extend(&sets));
        }
        let in_groups = pairs(step, "IFCRELASSIGNSTOGROUP", 6, 4);
        let in_spatial = pairs(step, "IFCRELREFERENCEDINSPATIALSTRUCTURE", 5, 4);
        for (zone, many) in in_groups.into_iter().chain(in_spatial) {
            if ZONES.contains(&&*step.keyword(zone)) {
                many.iter().for_each(|m| self.zones.entry(*m).or_default().push(zone));
            }
        }
        for (shape, parts) in pairs(step, "IFCSHAPEASPECT", 4, 0) {
            self.aspect_of.extend(parts.iter().map(|part| (*part, shape)));
            self.aspects.entry(shape).or_default().extend(parts);
        }
        for (material, many) in pairs(step, "IFCRELASSOCIATESMATERIAL", 5, 4) {
            self.materials.extend(many.iter().map(|m| (*m, material)));
        }
    }

    /// What is placed on an opening fills it, where no relation says what a door or window fills.
    fn fill_by_placement(&mut self, step: &Step<'_>) {
        let placement = |id: u64| step.args(id).get(5).and_then(Arg::id);
        let openings: HashMap<u64, u64> =
            self.openings.values().flatten().filter_map(|o| Some((placement(*o)?, *o))).collect();
        let known: HashSet<u64> = self.fillings.values().flatten().copied().collect();
        for p in self.fillers.iter().filter(|p| !known.contains(&p.id)) {
            let on = p.placement.and_then(|own| step.args(own).first().and_then(Arg::id));
            if let Some(opening) = on.and_then(|on| openings.get(&on)) {
                self.fillings.entry(*opening).or_default().push(p.id);
            }
        }
    }

    /// Takes apart what is, by way of its parts, a part of itself: every element of such a ring stands for itself.
    fn open_rings(&mut self) {
        let mut starts: Vec<u64> = self.whole.keys().copied().collect();
        starts.sort_unstable();
        let mut done: HashSet<u64> = HashSet::new();
        for start in starts {
            let (mut chain, mut at) = (Vec::new(), start);
            while !done.contains(&at) && !chain.contains(&at) {
                chain.push(at);
                match self.whole.get(&at) {
                    Some(next) => at = *next,
                    None => break,
                }
            }
            if let Some(from) = chain.iter().position(|c| *c == at).filter(|_| self.whole.contains_key(&at)) {
                let ring: Vec<u64> = chain[from..].to_vec();
                let words: Vec<String> = ring.iter().chain([&at]).map(|id| format!("#{id}")).collect();
                for id in &ring {
                    if let Some(whole) = self.whole.remove(id) {
                        self.parts.entry(whole).or_default().retain(|p| p != id);
                    }
                }
                self.part_rings.push((at, words.join(">")));
            }
            done.extend(chain);
        }
        self.parts.retain(|_, parts| !parts.is_empty());
    }

    /// Parts of an element, and their parts, each once.
    pub fn parts_of(&self, id: u64) -> Vec<u64> {
        let (mut out, mut next) = (self.parts.get(&id).cloned().unwrap_or_default(), 0);
        let mut seen: HashSet<u64> = out.iter().copied().chain([id]).collect();
        out.dedup();
        while let Some(at) = out.get(next).copied() {
            out.extend(self.parts.get(&at).into_iter().flatten().filter(|p| seen.insert(**p)));
            next += 1;
        }
        out
    }

    /// The zones that a space is in, those of its zones after them, each once.
    pub fn zones_of(&self, space: u64) -> Vec<u64> {
        let mut out: Vec<u64> = Vec::new();
        let (mut at, mut next) = (space, 0);
        loop {
            for zone in self.zones.get(&at).into_iter().flatten() {
                if !out.contains(zone) && out.len() < ZONES_MAX {
                    out.push(*zone);
                }
            }
            let Some(zone) = out.get(next) else { return out };
            (at, next) = (*zone, next + 1);
        }
    }

    /// The sets of quantities of an element, each once.
    pub fn quantity_sets(&self, step: &Step<'_>, id: u64) -> BTreeSet<u64> {
        let sets = self.properties.get(&id).into_iter().flatten().copied();
        sets.filter(|set| step.keyword(*set) == "IFCELEMENTQUANTITY").collect()
    }

    /// Whether several elements have a property set.
    pub fn is_shared_set(&self, set: u64) -> bool {
        self.properties.values().chain(self.of_types.values()).filter(|sets| sets.contains(&set)).count() > 1
    }

    /// Whether an instance gathers spaces.
    pub fn is_zone(&self, id: u64) -> bool {
        self.zones.values().any(|zones| zones.contains(&id))
    }

    /// Whether an element is a part of another element.
    pub fn is_part(&self, id: u64) -> bool {
        self.whole.get(&id).is_some_and(|w| !self.storey_ids.contains(w))
    }

    /// The product of an instance.
    pub fn product(&self, id: u64) -> Option<&Product> {
        self.product_at.get(&id).map(|i| &self.products[*i])
    }

    /// The door or window of an instance.
    pub fn filler(&self, id: u64) -> Option<&Product> {
        self.filler_at.get(&id).map(|i| &self.fillers[*i])
    }

    /// The storey an element stands in.
    pub fn storey_of(&self, id: u64) -> Option<u64> {
        let mut at = id;
        for _ in 0..32 {
            if self.storey_ids.contains(&at) {
                return Some(at);
            }
            at = *self.inside.get(&at).or_else(|| self.whole.get(&at))?;
        }
        None
    }

    /// The building that a storey, or a part of one, belongs to.
    fn building_of(&self, step: &Step<'_>, storey: u64) -> Option<u64> {
        let mut up = std::iter::successors(Some(storey), |at| self.whole.get(at).copied()).take(32);
        up.find(|at| step.keyword(*at) == "IFCBUILDING")
    }

    fn storeys(&self, step: &Step<'_>, geo: &Geo<'_, '_>) -> Vec<Storey> {
        let mut out: Vec<Storey> = step
            .all("IFCBUILDINGSTOREY")
            .map(|i| {
                let args = step.args_of(i);
                let name = args.get(2).and_then(|a| step.text(a)).filter(|n| !n.trim().is_empty());
                let placed = args.get(5).and_then(Arg::id).and_then(|p| geo.placement(p).ok());
                let stated = args.get(9).and_then(Arg::number);
                let placed = placed.map(|m| m.translation.z);
                Storey {
                    id: i.id,
                    name: name.unwrap_or_else(|| format!("#{}", i.id)),
                    floor: placed.or(stated).unwrap_or(0.0),
                    elevation: stated.filter(|s| placed.is_some_and(|p| p != *s)),
                    placed: None,
                    building: self.building_of(step, i.id),
                    walls: 0,
                    top: None,
                }
            })
            .collect();
        out.sort_by(|a, b| a.floor.total_cmp(&b.floor));
        let index: HashMap<u64, usize> = out.iter().enumerate().map(|(i, s)| (s.id, i)).collect();
        for p in self.products.iter().filter(|p| p.class.starts_with("IfcWall")) {
            let mut at = p.id;
            for _ in 0..32 {
                if let Some(i) = index.get(&at) {
                    out[*i].walls += 1;
                    break;
                }
                match self.inside.get(&at).or_else(|| self.whole.get(&at)) {
                    Some(next) => at = *next,
                    None => break,
                }
            }
        }
        out
    }

    /// Everything that moves with an element: its openings, what fills them, its parts and coverings.
    pub fn follows(&self, id: u64) -> Vec<u64> {
        let mut out = vec![id];
        let mut seen: HashSet<u64> = HashSet::from([id]);
        let mut i = 0;
        while i < out.len() {
            let at = out[i];
            for map in [&self.openings, &self.fillings, &self.parts, &self.coverings] {
                for next in map.get(&at).into_iter().flatten() {
                    if seen.insert(*next) {
                        out.push(*next);
                    }
                }
            }
            i += 1;
        }
        out
    }

    /// Properties of `Pset_Enfilade` on an element, names in lower case; of several of one name the last.
    pub fn marks(&self, step: &Step<'_>, id: u64) -> BTreeMap<String, String> {
        self.stated_marks(step, id).into_iter().map(|(_, key, value)| (key, value)).collect()
    }

    /// The same one by one, each with its set; first those of its type that it does not state itself.
    pub fn stated_marks(&self, step: &Step<'_>, id: u64) -> Vec<(u64, String, String)> {
        let own = self.marks_in(step, self.properties.get(&id));
        let mut out = self.marks_in(step, self.of_types.get(&id));
        out.retain(|(_, key, _)| own.iter().all(|(_, k, _)| k != key));
        out.extend(own);
        out
    }

    fn marks_in(&self, step: &Step<'_>, sets: Option<&Vec<u64>>) -> Vec<(u64, String, String)> {
        let mut out = Vec::new();
        for set in sets.into_iter().flatten() {
            for property in own_properties(step, *set) {
                let of = step.args(property);
                let name = of.first().and_then(|a| step.text(a)).unwrap_or_default().trim().to_lowercase();
                let value = of.get(2).filter(|_| step.keyword(property) == ONE_VALUE);
                let value = value.map(|v| step.text(v).unwrap_or_else(|| enum_text(v))).unwrap_or_default();
                out.push((*set, name, value));
            }
        }
        out
    }

    /// What an element, or else its type, states as a property of `Pset_WallCommon`; of a flag `T` or `F`.
    pub fn wall_common(&self, step: &Step<'_>, id: u64, key: &str) -> Option<String> {
        let sets = [&self.properties, &self.of_types].into_iter().filter_map(|of| of.get(&id)).flatten();
        let all = sets.flat_map(|set| properties_of(step, *set, |name| name == "Pset_WallCommon"));
        let value = |property: u64| {
            let args = step.args(property);
            let is_it = args.first().and_then(|a| step.text(a)).is_some_and(|name| name.trim() == key);
            let value = args.get(2).filter(|_| is_it && step.keyword(property) == ONE_VALUE)?;
            Some(step.text(value).unwrap_or_else(|| enum_text(value)))
        };
        all.into_iter().find_map(value)
    }

    /// Properties of `Pset_Enfilade` on an element or its type that are of another kind than one value, by name, with that
    /// kind.
    pub fn odd_marks(&self, step: &Step<'_>, id: u64) -> Vec<(String, String)> {
        let sets = [&self.of_types, &self.properties].into_iter().filter_map(|of| of.get(&id)).flatten();
        let odd = sets.flat_map(|set| own_properties(step, *set)).filter_map(|property| {
            let name = step.args(property).first().and_then(|a| step.text(a)).unwrap_or_default();
            let kind = step.keyword(property).to_string();
            (kind != ONE_VALUE && !kind.is_empty()).then_some((name, kind))
        });
        odd.collect()
    }
}

/// The one kind of property that marks are read from.
const ONE_VALUE: &str = "IFCPROPERTYSINGLEVALUE";

/// The properties of a set, if it is ours.
fn own_properties(step: &Step<'_>, set: u64) -> Vec<u64> {
    properties_of(step, set, is_ours)
}

/// The properties of a set that has a name as wanted.
fn properties_of(step: &Step<'_>, set: u64, is_wanted: impl Fn(&str) -> bool) -> Vec<u64> {
    let args = step.args(set);
    let name = args.get(2).and_then(|a| step.text(a)).unwrap_or_default();
    args.get(4).filter(|_| is_wanted(&name)).map(Arg::ids).unwrap_or_default()
}

fn enum_text(arg: &Arg) -> String {
    match &arg.value {
        super::step::Value::Enum(e) => e.clone(),
        super::step::Value::Typed(_, inner) => inner.first().map(enum_text).unwrap_or_default(),
        super::step::Value::Number(n) => n.to_string(),
        _ => String::new(),
    }
}

/// The one and the many of a relation.
pub(super) fn pairs(step: &Step<'_>, keyword: &str, one: usize, many: usize) -> Vec<(u64, Vec<u64>)> {
    let of = |i| {
        let args: Vec<Arg> = step.args_of(i);
        let many = args.get(many)?;
        let list = many.id().map_or_else(|| many.ids(), |id| vec![id]);
        Some((args.get(one)?.id()?, list))
    };
    step.all(keyword).filter_map(of).collect()
}

fn products(step: &Step<'_>, classes: impl Iterator<Item = (&'static str, &'static str)>) -> Vec<Product> {
    let mut out: Vec<(usize, Product)> = Vec::new();
    for (keyword, class) in classes {
        out.extend(step.all(keyword).map(|i| (i.span.start, product(step, i.id, class))));
    }
    out.sort_by_key(|(at, _)| *at);
    out.into_iter().map(|(_, p)| p).collect()
}

/// Reads the attributes every product has.
pub(super) fn product(step: &Step<'_>, id: u64, class: &'static str) -> Product {
    let args = step.args(id);
    let text = |i: usize| args.get(i).and_then(|a| step.text(a)).unwrap_or_default();
    let is_space = class == "IfcSpace";
    Product {
        id,
        class,
        global_id: text(0),
        name: text(2),
        long_name: if is_space { text(7) } else { String::new() },
        tag: if is_space { None } else { Some(text(7)).filter(|t| !t.is_empty()) },
        placement: args.get(5).and_then(Arg::id),
        shape: args.get(6).and_then(Arg::id),
    }
}

/// Kinds of representation that are no body.
const NO_BODY: &[&str] = &[
    "Curve2D",
    "GeometricCurveSet",
    "BoundingBox",
    "Annotation2D",
    "GeometricSet",
    "Curve3D",
    "Point",
    "PointCloud",
];

/// Items of a product's body, or why there is none.
pub(super) fn body_items(step: &Step<'_>, shape: u64) -> Result<Vec<u64>, Why> {
    if step.get(shape).is_none() {
        return Err(format!("#{shape}, named as its representation, does not exist"));
    }
    let lists = representations(step, shape);
    let body = lists.iter().find(|(name, kind, _)| name == "Body" && !NO_BODY.contains(&kind.as_str()));
    let other = || {
        let is_body = |(name, kind, _): &&(String, String, Vec<u64>)| {
            !["Axis", "Box", "FootPrint", "Annotation", "Clearance", "Profile"].contains(&name.as_str())
                && !NO_BODY.contains(&kind.as_str())
        };
        lists.iter().find(is_body)
    };
    let found = body.or_else(other).map(|(_, _, items)| items.clone());
    let dangling = || {
        let listed = step.args(shape).get(2).map(Arg::ids).unwrap_or_default();
        listed.into_iter().find(|id| step.get(*id).is_none())
    };
    found.filter(|i| !i.is_empty()).ok_or_else(|| match dangling() {
        Some(id) => format!("#{id}, named as a representation in #{shape}, does not exist"),
        None => format!("#{shape} has no body"),
    })
}

/// The item of a product's axis.
pub(super) fn axis_item(step: &Step<'_>, shape: u64) -> Option<u64> {
    representations(step, shape).into_iter().find(|(name, _, _)| name == "Axis")?.2.first().copied()
}

/// Identifier, type and items of every representation.
fn representations(step: &Step<'_>, shape: u64) -> Vec<(String, String, Vec<u64>)> {
    let list = step.args(shape).get(2).map(Arg::ids).unwrap_or_default();
    let of = |id: u64| {
        let args = step.args(id);
        let text = |i: usize| args.get(i).and_then(|a| step.text(a)).unwrap_or_default();
        (text(1), text(2), args.get(3).map(Arg::ids).unwrap_or_default())
    };
    list.into_iter().map(of).collect()
}

/// Thickness and offset of a wall by its material layers: how far it reaches to the right and to the left
/// of its axis, file units.
pub(super) fn layer_reach(step: &Step<'_>, model: &Model, id: u64) -> Option<[f64; 2]> {
    let usage = *model.materials.get(&id)?;
    let args = step.args(usage);
    let (set, offset, negative) = match &*step.keyword(usage) {
        "IFCMATERIALLAYERSETUSAGE" => (
            args.first()?.id()?,
            args.get(3).and_then(Arg::number),
            args.get(2).is_some_and(|s| s.is("NEGATIVE")),
        ),
        "IFCMATERIALLAYERSET" => (usage, None, false),
        _ => return None,
    };
    let layers = step.args(set).first()?.ids();
    let total: f64 = layers.iter().filter_map(|l| step.args(*l).get(1)?.number()).sum();
    let offset = offset.unwrap_or(-total / 2.0);
    let other = if negative { offset - total } else { offset + total };
    (total > 0.0).then(|| [offset.min(other), offset.max(other)])
}

/// Whether a set of properties is ours.
pub(super) fn is_ours(name: &str) -> bool {
    name.eq_ignore_ascii_case("Pset_Enfilade")
}
