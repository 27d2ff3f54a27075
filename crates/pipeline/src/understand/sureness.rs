//! How sure a reading is in all: what may be wrong with it, each part by itself.

use std::collections::{BTreeMap, BTreeSet};

use crate::understand::senses::of_entity;
use enfilade_cad::drawing::{Drawing, Format};
use enfilade_cad::own_layers;
use enfilade_plan::Plan;

/// What is less sure than this on a layer of walls is doubtful.
const DOUBTFUL_BELOW: f64 = 0.8;

/// A layer with this share of what draws walls is one of walls.
const LAYER_SHARE: f64 = 0.1;

/// Log odds that a reading is right, by the share of doubtful things on the layers of its walls: at none, and how they fall.
/// Fitted to 186 drawings by 31 authors and owners of buildings, no author fitted and judged at once (`BENCHMARKS.md`, "As
/// sure as it says").
const RIGHT: [f64; 2] = [2.36, -4.04];

/// How sure a plan of columns alone is one. Like [`SURE_IN_PART`] it has a reason and no fit.
pub(crate) const SURE_WITHOUT_WALLS: f64 = 0.4;

/// How sure a plan is all there of which a part lies in a file that was not opened: what it holds nobody knows.
const SURE_IN_PART: f64 = 0.6;

/// How sure each part of a reading is, 0 to 1; nothing where it is not in question.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sureness {
    /// The unit.
    pub unit: f64,
    /// The drawing of the sheet.
    pub view: Option<f64>,
    /// What is a wall, and what is not.
    pub walls: Option<f64>,
    /// The rooms: whether the ways into them are found.
    pub rooms: Option<f64>,
    /// Whether all of the drawing is there.
    pub whole: Option<f64>,
}

impl Sureness {
    /// The whole is as sure as its least sure part.
    pub fn least(&self) -> f64 {
        [self.view, self.walls, self.rooms, self.whole].into_iter().flatten().fold(self.unit, f64::min)
    }
}

/// How sure what is a wall is, where the drawing does not say so itself: by what else lies on the layers of the walls.
pub(crate) fn of_walls(plan: &Plan, drawing: &Drawing) -> Option<f64> {
    if drawing.format != Format::Dxf {
        return None;
    }
    Some(right(doubtful_share(&things(plan, drawing))))
}

/// How sure it is that all of a drawing is there.
pub(crate) fn of_whole(drawing: &Drawing) -> Option<f64> {
    (drawing.unbound > 0).then_some(SURE_IN_PART)
}

fn right(doubtful: f64) -> f64 {
    1.0 / (1.0 + (-RIGHT[0] - RIGHT[1] * doubtful).exp())
}

/// Log odds that the ways into rooms are right: where nothing of [`Ways`] speaks against it, and how they fall with each, up
/// to [`SHARE_MAX`]. Fitted to 308 drawings of buildings by 22 owners, no owner fitted and judged at once (`BENCHMARKS.md`,
/// "Ways into rooms").
const WAYS_RIGHT: [f64; 4] = [1.48, -4.02, -3.62, -3.60];

/// A larger share of [`Ways`] says no more. On owners not fitted this is within 0.001 of the best of twelve limits tried.
const SHARE_MAX: f64 = 0.35;

/// The ways into rooms, doors and passages, and what speaks against them: how many there are of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Ways {
    /// Rooms.
    pub rooms: usize,
    /// Of these, those that no way leads into.
    pub shut: usize,
    /// Doors and passages.
    pub all: usize,
    /// Of these, those in which nothing is drawn; 0 where no way has a door: such drawings show gaps alone.
    pub empty: usize,
    /// Of these, those narrower or wider than doors.
    pub odd: usize,
}

impl Ways {
    /// How sure it is that they are found.
    pub fn sure(&self) -> f64 {
        let share = |part: usize, all: usize| (part as f64 / all.max(1) as f64).min(SHARE_MAX);
        let shares = [share(self.empty, self.all), share(self.shut, self.rooms), share(self.odd, self.all)];
        let [base, weights @ ..] = WAYS_RIGHT;
        let against: f64 = weights.iter().zip(shares).map(|(weight, share)| weight * share).sum();
        1.0 / (1.0 + (-base - against).exp())
    }
}

/// A record that draws something: its layer, whether it is a wall, and how sure that is.
struct Thing<'a> {
    layer: &'a str,
    is_wall: bool,
    /// Sum over its entities, and their number.
    sure: [f64; 2],
}

fn things<'a>(plan: &Plan, drawing: &'a Drawing) -> Vec<Thing<'a>> {
    let mut out: BTreeMap<usize, Thing<'a>> = BTreeMap::new();
    let foreign = drawing.entities.iter().enumerate().filter(|(_, e)| !own_layers::is_own(&e.layer));
    for (ordinal, (i, e)) in foreign.enumerate() {
        let is_picked = plan.picked.binary_search(&ordinal).is_ok();
        let sense = of_entity(plan, i, is_picked);
        let is_wall = is_picked || sense.role.stops_sight();
        let thing =
            out.entry(e.origin.record).or_insert(Thing { layer: &e.layer, is_wall, sure: [0.0, 0.0] });
        thing.is_wall |= is_wall;
        thing.sure = [thing.sure[0] + f64::from(sense.confidence), thing.sure[1] + 1.0];
    }
    out.into_values().collect()
}

/// Share of the things on the layers of walls that are doubtful; all of them where nothing is a wall.
fn doubtful_share(things: &[Thing<'_>]) -> f64 {
    let mut walls: BTreeMap<&str, usize> = BTreeMap::new();
    things.iter().filter(|t| t.is_wall).for_each(|t| *walls.entry(t.layer).or_default() += 1);
    let all: usize = walls.values().sum();
    let layers: BTreeSet<&str> =
        walls.into_iter().filter(|(_, n)| *n as f64 >= LAYER_SHARE * all as f64).map(|(l, _)| l).collect();
    let beside: Vec<&Thing<'_>> = things.iter().filter(|t| layers.contains(t.layer)).collect();
    let doubtful = beside.iter().filter(|t| t.sure[0] / t.sure[1] < DOUBTFUL_BELOW).count();
    if beside.is_empty() { 1.0 } else { doubtful as f64 / beside.len() as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn thing(layer: &str, is_wall: bool, sure: f64) -> Thing<'_> {
        Thing { layer, is_wall, sure: [sure, 1.0] }
    }

    #[test]
    fn what_lies_on_the_layers_of_walls_says_how_sure_they_are() {
        let walls = || (0..10).map(|_| thing("A", true, 0.97));
        let with = |others: Vec<Thing<'static>>| doubtful_share(&walls().chain(others).collect::<Vec<_>>());
        assert_eq!(with(Vec::new()), 0.0);
        assert_eq!(with((0..10).map(|_| thing("A", false, 0.6)).collect()), 0.5);
        assert_eq!(with((0..10).map(|_| thing("B", false, 0.6)).collect()), 0.0, "another layer");
        assert_eq!(with(vec![thing("B", true, 0.6)]), 0.0, "a layer with few walls");
        assert_eq!(doubtful_share(&[thing("A", false, 0.9)]), 1.0, "no wall");
    }

    #[test]
    fn said_and_right_are_those_of_the_fit() {
        for (doubtful, said) in [(0.0, 91), (0.2, 83), (0.5, 58), (1.0, 16)] {
            assert_eq!((100.0 * right(doubtful)).round() as i32, said, "{doubtful}");
        }
    }

    #[test]
    fn each_doubt_about_the_ways_counts_as_fitted() {
        let said = |empty, shut, odd| {
            let ways = Ways { rooms: 100, all: 100, empty, shut, odd };
            (100.0 * ways.sure()).round() as i32
        };
        let each = [[0; 3], [20, 0, 0], [0, 20, 0], [0, 0, 20], [100, 0, 0]];
        assert_eq!(each.map(|[empty, shut, odd]| said(empty, shut, odd)), [81, 66, 68, 68, 52]);
        assert_eq!(said((100.0 * SHARE_MAX) as usize, 0, 0), said(100, 0, 0));
        assert_eq!((100.0 * Ways::default().sure()).round() as i32, 81, "nothing to count");
    }

    #[test]
    fn the_least_sure_part_counts() {
        let all = Sureness { unit: 0.9, walls: Some(0.8), whole: Some(0.6), ..Sureness::default() };
        assert_eq!((all.least(), Sureness { whole: None, ..all }.least()), (0.6, 0.8));
    }
}
