//! Storeys of a scene without an IFC: by the names of the nodes that hold its walls, and by the heights at which walls stand.

use std::collections::{BTreeMap, BTreeSet};

use super::ReadOptions;
use super::bodies::SCENE_LAYER;
use super::body::Body;
use super::scene::{File, Shown};
use crate::StoreyInfo;
use crate::names::base_name;
use crate::plane::box_of;
use crate::roles::{Role, role_by_name};
use crate::storey_words::storey_name;
use crate::storeys::is_over;

/// Floors nearer than this are one.
pub(super) const FLOOR_M: f64 = 0.05;

/// What is this high may be a wall; and no storey is lower.
pub(super) const STOREY_HIGH_M: f64 = 2.0;

/// Storeys of different names are one where their floors are nearer than this: half a flight of stairs parts them, a step or
/// a plinth does not.
const STEP_M: f64 = 1.0;

/// Walls of one floor stand no farther from it than this: on a step, on a plinth, on the slab and not on the screed.
const GATHERED_M: f64 = 0.3;

/// Fewer walls that stand at a height make no storey that no name tells of.
const WALLS_MIN: usize = 3;

/// No building has more floors; a scene that does is one that is made to keep a program busy.
const FLOORS_MOST: usize = 300;

/// How programs that make scenes of an IFC begin the names of its storeys.
const STOREY_CLASS: &str = "IfcBuildingStorey/";

/// Storeys of a scene, and what stands in which.
#[derive(Debug, Default)]
pub(super) struct Levels {
    /// From the lowest; none where there are not several, or the IFC beside the scene knows them.
    own: Vec<StoreyInfo>,
    /// Nodes named after a storey that hold walls → its place in `own`.
    of_group: BTreeMap<usize, usize>,
    /// Nodes that show something → the storey in which that stands; none of a mesh with pieces in several.
    of_body: BTreeMap<usize, Option<usize>>,
}

impl Levels {
    /// Finds them; `metres`: in one unit of the scene.
    pub fn of(scene: &File<'_>, bodies: &[Body<'_>], options: &ReadOptions, metres: f64) -> Self {
        if !options.known().storeys.is_empty() {
            return Self::default();
        }
        let high_m = |b: &Body<'_>| (b.high - b.low) * metres;
        let walls = walls(bodies, metres);
        let named = Named::of(scene, &walls);
        let mut floors = named.floors(&walls, metres);
        let is_telling = |b: &&&Body<'_>| named.unit(b.shown).is_none() && high_m(b) >= STOREY_HIGH_M;
        let tall: Vec<&Body<'_>> = walls.iter().filter(is_telling).copied().collect();
        let mut other = gathered(tall.iter().map(|b| b.low * metres).collect(), &floors);
        // Where no name says what is a wall, what stands at a height may be anything, unless another height repeats it.
        if tall.iter().any(|b| !b.is_wall) {
            other = repeated(&other, &tall, metres);
        }
        floors.extend(other.into_iter().map(Floor::unnamed));
        floors.sort_by(|a, b| a.floor_m.total_cmp(&b.floor_m));
        if floors.len() < 2 {
            Self::default()
        } else {
            Self::filled(bodies, &walls, &named, &floors, (options, metres))
        }
    }

    fn filled(
        bodies: &[Body<'_>],
        walls: &[&Body<'_>],
        named: &Named<'_>,
        floors: &[Floor],
        (options, metres): (&ReadOptions, f64),
    ) -> Self {
        let of_unit: BTreeMap<&Unit, usize> =
            floors.iter().enumerate().flat_map(|(i, f)| f.units.iter().map(move |u| (u, i))).collect();
        let by_height = |low: f64| {
            let begun = low * metres + GATHERED_M;
            floors.partition_point(|f| f.floor_m <= begun).saturating_sub(1)
        };
        let place = |b: &Body<'_>| {
            let unit = named.unit(b.shown);
            unit.and_then(|u| of_unit.get(&u).copied()).unwrap_or_else(|| by_height(b.low))
        };
        let mut of_body: BTreeMap<usize, Option<usize>> = BTreeMap::new();
        for body in bodies {
            let at = Some(place(body));
            of_body.entry(body.shown.node).and_modify(|of| *of = of.filter(|_| *of == at)).or_insert(at);
        }
        let group =
            |(unit, at): (&&Unit, &usize)| if let Unit::Group(n) = unit { Some((*n, *at)) } else { None };
        let mut standing: Vec<Vec<&Body<'_>>> = vec![Vec::new(); floors.len()];
        walls.iter().for_each(|b| standing[place(b)].push(b));
        let own = (0..floors.len()).map(|i| info(floors, i, &standing[i], (options, metres))).collect();
        Self { own, of_group: of_unit.iter().filter_map(group).collect(), of_body }
    }

    /// Storeys that a scene has, by the IFC beside it or by itself.
    pub fn storeys<'s>(&'s self, options: &'s ReadOptions) -> &'s [StoreyInfo] {
        let known = &options.known().storeys;
        if known.is_empty() { &self.own } else { known }
    }

    /// Says of what is shown whether it stands in another storey than the one that is read, by the scene itself.
    pub fn elsewhere(&self, options: &ReadOptions) -> impl Fn(&Shown) -> bool + '_ {
        let chosen = options.chosen_of(&self.own);
        move |shown| {
            let group = shown.path().iter().find_map(|n| self.of_group.get(n).copied());
            let of = group.or_else(|| self.of_body.get(&shown.node).copied().flatten());
            chosen.is_some_and(|chosen| of.is_some_and(|of| of != chosen))
        }
    }
}

/// What is known of a storey by the walls that stand in it.
fn info(
    floors: &[Floor],
    i: usize,
    walls: &[&Body<'_>],
    (options, metres): (&ReadOptions, f64),
) -> StoreyInfo {
    let Floor { floor_m, name, .. } = &floors[i];
    let is_near = floors.iter().any(|other| is_over(*floor_m, other.floor_m, options.above_m()));
    let top = || walls.iter().fold(f64::NEG_INFINITY, |top, b| top.max(b.high * metres));
    StoreyInfo {
        building: None,
        name: name.clone().unwrap_or_else(|| format!("floor {}", i + 1)),
        floor_m: *floor_m,
        walls: walls.len(),
        top_m: is_near.then(top),
    }
}

/// Walls that stand, without columns; where no name says what is a wall, what is high enough to be one.
fn walls<'b, 'f>(bodies: &'b [Body<'f>], metres: f64) -> Vec<&'b Body<'f>> {
    let layers: BTreeSet<&str> = bodies.iter().map(|b| b.layer.as_str()).collect();
    let columns: BTreeSet<&str> =
        layers.into_iter().filter(|layer| role_by_name(layer).0 == Role::Column).collect();
    let is_wall = |b: &&Body<'_>| match b.layer.as_str() {
        SCENE_LAYER => (b.high - b.low) * metres >= STOREY_HIGH_M,
        layer => b.is_wall && !columns.contains(layer),
    };
    bodies.iter().filter(is_wall).filter(|b| b.low < b.high).collect()
}

/// What a name puts in a storey.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Unit {
    /// All that hangs on a node.
    Group(usize),
    /// All walls whose own names have these words for a storey, lower case.
    Word(String),
}

/// A floor that walls stand on.
#[derive(Debug)]
struct Floor {
    /// Its height, metres.
    floor_m: f64,
    /// What its storey is called.
    name: Option<String>,
    /// What stands on it by name.
    units: Vec<Unit>,
}

impl Floor {
    fn unnamed(floor_m: f64) -> Self {
        Self { floor_m, name: None, units: Vec::new() }
    }
}

/// Which names of nodes part the walls of a scene into storeys.
struct Named<'s> {
    /// Nodes named after a storey → the name, and the words for the storey in it.
    called: BTreeMap<usize, (&'s str, String)>,
    /// What holds some of the walls, not all: those; of all others a name says nothing.
    walls: BTreeMap<Unit, Vec<usize>>,
}

impl<'s> Named<'s> {
    fn of(scene: &'s File<'_>, walls: &[&Body<'_>]) -> Self {
        let all = scene.json.list("nodes").iter().enumerate();
        let called = all.filter_map(|(n, node)| Some((n, called(node.text("name")?)?))).collect();
        let mut out = Self { called, walls: BTreeMap::new() };
        let mut holding: BTreeMap<Unit, usize> = BTreeMap::new();
        for unit in walls.iter().flat_map(|b| out.all(b.shown)) {
            *holding.entry(unit).or_default() += 1;
        }
        holding.retain(|_, count| *count < walls.len());
        out.walls.extend(holding.into_keys().map(|unit| (unit, Vec::new())));
        for (i, wall) in walls.iter().enumerate() {
            let unit = out.unit(wall.shown);
            if let Some(of) = unit.and_then(|u| out.walls.get_mut(&u)) {
                of.push(i);
            }
        }
        out.walls.retain(|_, walls| !walls.is_empty());
        out
    }

    /// All that names on the way to something put it in, from the root.
    fn all(&self, shown: &Shown) -> Vec<Unit> {
        let unit = |n: &usize| {
            let (_, storey) = self.called.get(n)?;
            Some(if *n == shown.node { Unit::Word(storey.to_lowercase()) } else { Unit::Group(*n) })
        };
        shown.path().iter().filter_map(unit).collect()
    }

    /// What names put something in: the first from the root that does not hold all walls.
    fn unit(&self, shown: &Shown) -> Option<Unit> {
        self.all(shown).into_iter().find(|u| self.walls.contains_key(u))
    }

    /// Floors of the storeys that names tell of, metres; those of one storey are one, those of most walls first.
    fn floors(&self, walls: &[&Body<'_>], metres: f64) -> Vec<Floor> {
        let mut all: Vec<(&Unit, &Vec<usize>)> = self.walls.iter().collect();
        all.sort_by_key(|(_, walls)| std::cmp::Reverse(walls.len()));
        let mut out: Vec<(Floor, String)> = Vec::new();
        for (unit, own) in all {
            let own: Vec<&Body<'_>> = own.iter().map(|i| walls[*i]).collect();
            let tall: Vec<f64> = own
                .iter()
                .filter(|b| (b.high - b.low) * metres >= STOREY_HIGH_M)
                .map(|b| b.low * metres)
                .collect();
            let lows = if tall.is_empty() { own.iter().map(|b| b.low * metres).collect() } else { tall };
            let floor_m = commonest(lows);
            let (name, word) = self.words(unit, own[0].shown.node);
            let is_same = |(floor, of): &&mut (Floor, String)| {
                let apart = (floor.floor_m - floor_m).abs();
                apart < STEP_M || apart < STOREY_HIGH_M && of.to_lowercase() == word.to_lowercase()
            };
            match out.iter_mut().find(is_same) {
                Some((floor, word)) => {
                    if floor.name.as_ref() != Some(&name) {
                        floor.name = Some(word.clone());
                    }
                    floor.units.push(unit.clone());
                }
                None => out.push((Floor { floor_m, name: Some(name), units: vec![unit.clone()] }, word)),
            }
        }
        out.into_iter().map(|(floor, _)| floor).collect()
    }

    /// What a storey is called by what is in it, and the words for it alone; `first`: a node that is in it.
    fn words(&self, unit: &Unit, first: usize) -> (String, String) {
        let (node, is_group) = if let Unit::Group(n) = unit { (*n, true) } else { (first, false) };
        let (name, word) = self.called.get(&node).cloned().unwrap_or_default();
        (if is_group { name.to_string() } else { word.clone() }, word)
    }
}

/// What a node of a name is called as a storey, and the words for the storey in that.
fn called(name: &str) -> Option<(&str, String)> {
    if let Some(own) = name.strip_prefix(STOREY_CLASS) {
        return Some((own.trim(), own.trim().to_string()));
    }
    let name = base_name(name).trim();
    let found = storey_name(name).filter(|s| s.is_sure || s.rest.is_empty())?;
    Some((name, found.storey))
}

/// The height at which most of some things begin, the lowest of several.
fn commonest(mut lows: Vec<f64>) -> f64 {
    lows.sort_by(f64::total_cmp);
    let near = |low: f64, slack: f64| {
        lows.partition_point(|l| *l <= low + slack) - lows.partition_point(|l| *l < low - slack)
    };
    let most =
        lows.iter().copied().max_by(|a, b| near(*a, FLOOR_M).cmp(&near(*b, FLOOR_M)).then(b.total_cmp(a)));
    most.unwrap_or(0.0)
}

/// Those of some floors above which the same stands as above another of them.
fn repeated(floors: &[f64], bodies: &[&Body<'_>], metres: f64) -> Vec<f64> {
    let above: Vec<Vec<Corners>> = floors.iter().map(|f| footprints(*f, bodies, metres)).collect();
    let is_again = |i: &usize| (0..floors.len()).any(|j| j != *i && are_alike(&above[*i], &above[j]));
    (0..floors.len()).filter(is_again).map(|i| floors[i]).collect()
}

/// The lower left and the upper right corner of a footprint in cells of [`GATHERED_M`].
type Corners = [i64; 4];

/// Footprints of what stands on a floor, each once, sorted.
fn footprints(floor_m: f64, bodies: &[&Body<'_>], metres: f64) -> Vec<Corners> {
    let on = bodies.iter().filter(|b| (b.low * metres - floor_m).abs() <= GATHERED_M);
    let of = |b: &&Body<'_>| {
        let [lo, hi] = box_of(b.triangles.iter().flatten().map(|p| p.truncate()))?;
        Some([lo.x, lo.y, hi.x, hi.y].map(|v| (v * metres / GATHERED_M).round() as i64))
    };
    let mut out: Vec<Corners> = on.filter_map(of).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// Whether most footprints of the floor with fewer are those of the other, a cell more or less.
fn are_alike(a: &[Corners], b: &[Corners]) -> bool {
    let (few, many) = if a.len() < b.len() { (a, b) } else { (b, a) };
    let is_same = |p: &Corners, q: &Corners| p.iter().zip(q).all(|(p, q)| p.abs_diff(*q) <= 1);
    let near = |p: &Corners| {
        let from = many.partition_point(|q| q[0] < p[0].saturating_sub(1));
        many[from..].iter().take_while(|q| q[0] <= p[0].saturating_add(1)).any(|q| is_same(p, q))
    };
    let same = few.iter().filter(|p| near(p)).count();
    same >= WALLS_MIN && 2 * same > few.len()
}

/// Heights at which several walls stand, a storey from each other and from the floors that are known.
fn gathered(mut lows: Vec<f64>, known: &[Floor]) -> Vec<f64> {
    let mut out: Vec<f64> = Vec::new();
    let is_near = |low: f64, floor: f64| (low - floor).abs() < STOREY_HIGH_M;
    lows.retain(|low| known.iter().all(|f| !is_near(*low, f.floor_m)));
    lows.sort_by(f64::total_cmp);
    while !lows.is_empty() && out.len() < FLOORS_MOST {
        let range = |low: f64| {
            lows.partition_point(|l| *l < low - GATHERED_M)..lows.partition_point(|l| *l <= low + GATHERED_M)
        };
        let ranges = lows.iter().map(|low| range(*low));
        // The lowest of several with as many.
        let Some(most) = ranges.rev().max_by_key(ExactSizeIterator::len).filter(|r| r.len() >= WALLS_MIN)
        else {
            break;
        };
        let floor = commonest(lows[most].to_vec());
        lows.retain(|low| !is_near(*low, floor));
        out.push(floor);
    }
    out
}
