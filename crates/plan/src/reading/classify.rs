//! The class of every entity, by the votes of trees over the pieces that it draws.

use std::collections::HashMap;

use rayon::prelude::*;

use super::RoleSense;
use super::features::Features;
use super::scene::{Scene, Thing};
use super::trees::{CLASSES, TOGETHER, Votes, model};
use crate::axes::Path;
use crate::leaves;
use crate::parallels::Straight;
use crate::stairs;
use enfilade_cad::drawing::{Drawing, Entity};
use enfilade_cad::roles::{Role, is_of_windows_too, role_by_name};

/// What each entity is taken for, if `metres` are those of a drawing unit; `None` for an entity that is not looked at:
/// hidden, or of no length.
pub fn classify(drawing: &Drawing, metres: f64) -> Vec<Option<RoleSense>> {
    let mut out = vec![None; drawing.entities.len()];
    let Some((scene, model)) = Scene::new(drawing, metres).zip(model()) else { return out };
    let features = Features::new(&scene);
    let count = scene.pieces.len();
    let votes_of = |block: usize| {
        let mut rows = Vec::with_capacity(TOGETHER * model.picks.len());
        for i in block * TOGETHER..count.min((block + 1) * TOGETHER) {
            let row = features.row(i);
            rows.extend(model.picks.iter().map(|k| row[*k]));
        }
        model.forest.votes(&rows)
    };
    let votes: Vec<Votes> = (0..count.div_ceil(TOGETHER)).into_par_iter().flat_map_iter(votes_of).collect();
    let votes_of = |thing: &Thing| {
        let mut sums = [0.0; CLASSES];
        let own = thing.pieces.start as usize..thing.pieces.end as usize;
        for (piece, votes) in scene.pieces[own.clone()].iter().zip(&votes[own]) {
            let share = piece.length / thing.length;
            sums.iter_mut().zip(votes).for_each(|(s, v)| *s += v * share);
        }
        sums
    };
    let mut named = Names::default();
    let kind = match () {
        () if count < PIECES_TRAINED => Kind::Unknown,
        () if count < PIECES_OF_PLANS => Kind::Sketch,
        () => Kind::Plan,
    };
    let votes: Vec<Votes> = scene.things.iter().map(votes_of).collect();
    let mut walls = [0.0; 2];
    for (thing, votes) in scene.things.iter().zip(&votes) {
        let name = named.of(&drawing.entities[thing.entity as usize]);
        let sense = sense(votes, name, kind);
        if class_of(sense.role) == WALL {
            walls[usize::from(name.role != Role::Unknown)] += thing.length;
        }
        out[thing.entity as usize] = Some(sense);
    }
    if walls[1] > 0.0 && (kind == Kind::Sketch || walls[1] >= NAMED_SHARE * (walls[0] + walls[1])) {
        for (thing, votes) in scene.things.iter().zip(&votes) {
            let is_named = named.of(&drawing.entities[thing.entity as usize]).role != Role::Unknown;
            let is_doubtful = !is_named
                && likeliest(votes) == WALL
                && (kind == Kind::Sketch || votes[WALL] < WALL_BESIDE_NAMED);
            if is_doubtful {
                let confidence = (1.0 - votes[WALL]) as f32;
                out[thing.entity as usize] = Some(RoleSense { role: Role::Unknown, confidence });
            }
        }
    }
    without_dashed(&scene, drawing, &mut named, &mut out);
    with_flights(&scene, &mut out);
    with_leaves(&scene, |t| named.of(&drawing.entities[t.entity as usize]).role, &mut out);
    out
}

/// How sure a leaf is that hangs at the jamb of a gap as wide as it is long; nothing is one of which the trees are surer. Of
/// mixtures and hard drawings 20 doors more are found so, and every door found before.
const LEAF_SURE: f32 = 0.9;

/// Leaves without a swing are known by the gap that they hang at, whatever their lines alone look like.
fn with_leaves(scene: &Scene, mut name_of: impl FnMut(&Thing) -> Role, senses: &mut [Option<RoleSense>]) {
    let sense = |t: &Thing| senses[t.entity as usize];
    let own = |t: &Thing| &scene.pieces[t.pieces.start as usize..t.pieces.end as usize];
    let is_wall = |t: &Thing| sense(t).is_some_and(|s| s.role.stops_sight());
    let mut may_be = |t: &Thing| {
        let is_doubtful = sense(t).is_some_and(|s| s.confidence < LEAF_SURE && s.role != Role::Door);
        is_doubtful
            && matches!(own(t).len(), 1 | 4)
            && own(t).iter().all(|p| p.arc.is_none())
            && matches!(name_of(t), Role::Unknown | Role::Wall | Role::Door)
    };
    let paths = |t: &Thing| own(t).iter().map(|p| Path::Line { a: p.a, b: p.b }).collect::<Vec<Path>>();
    let things = scene.things.iter().enumerate();
    let may: Vec<(usize, Vec<Path>)> =
        things.clone().filter(|(_, t)| may_be(t)).map(|(i, t)| (i, paths(t))).collect();
    if may.is_empty() {
        return;
    }
    let pieces = things.flat_map(|(thing, t)| {
        let is_wall = is_wall(t);
        let lines = own(t).iter().filter(|p| p.arc.is_none());
        lines.map(move |p| leaves::Piece { ends: [p.a, p.b], thing, is_wall })
    });
    let mut found = leaves::hung(pieces, &may);
    // A line by itself may as well be a short wall beside the gap.
    let may_be_wall = |t: &Thing| own(t).len() == 1 && is_wall(t);
    found.retain(|(of, _)| of.len() > 1 || !may_be_wall(&scene.things[of[0]]));
    for thing in found.into_iter().flat_map(|f| f.0) {
        let entity = scene.things[thing].entity as usize;
        senses[entity] = Some(RoleSense { role: Role::Door, confidence: LEAF_SURE });
    }
}

/// In the labelled corpus every line found so that is labelled as a wall draws steps on the layer of the walls, but for at
/// most one. Fewer drawings than a finer figure would need.
const FLIGHT_SURE: f32 = 0.99;
/// What draws treads for more than this share of its length is part of a stair.
const TREADS_SHARE: f64 = 0.5;

/// Stairs are known by the row that their treads stand in, whatever layer they lie on: nobody builds walls in such rows.
fn with_flights(scene: &Scene, senses: &mut [Option<RoleSense>]) {
    let may_be = |thing: &Thing| {
        let role = senses[thing.entity as usize].map(|s| s.role);
        matches!(role, Some(Role::Wall | Role::LowWall | Role::Stair | Role::Furniture | Role::Unknown))
    };
    let of = |(i, thing): (usize, &Thing)| {
        let own = &scene.pieces[thing.pieces.start as usize..thing.pieces.end as usize];
        own.iter().filter(|p| p.arc.is_none()).map(move |p| Straight { entity: i, a: p.a, b: p.b })
    };
    let lines: Vec<Straight> =
        scene.things.iter().enumerate().filter(|(_, t)| may_be(t)).flat_map(of).collect();
    let mut found = vec![0.0; scene.things.len()];
    stairs::find(&lines).into_iter().for_each(|l| found[lines[l].entity] += lines[l].length());
    for (thing, found) in scene.things.iter().zip(found) {
        if found > TREADS_SHARE * thing.length {
            senses[thing.entity as usize] = Some(RoleSense { role: Role::Stair, confidence: FLIGHT_SURE });
        }
    }
}

/// What is drawn with gaps lies above or below, or is to go, and is no wall: unless most of the walls are drawn so, or a whole
/// layer that is named after walls is.
fn without_dashed<'d>(
    scene: &Scene,
    drawing: &'d Drawing,
    named: &mut Names<'d>,
    senses: &mut [Option<RoleSense>],
) {
    let walls =
        scene.things.iter().filter(|t| senses[t.entity as usize].is_some_and(|s| s.role == Role::Wall));
    let (dashed, drawn): (Vec<&Thing>, Vec<&Thing>) = walls.partition(|t| {
        let e = &drawing.entities[t.entity as usize];
        e.origin.has_gaps && (e.origin.pen.is_own_line || class_of(named.of(e).role) != WALL)
    });
    let length = |of: &[&Thing]| of.iter().map(|t| t.length).sum::<f64>();
    if length(&dashed) < length(&drawn) {
        for thing in dashed {
            senses[thing.entity as usize] = Some(RoleSense { role: Role::Unknown, confidence: 0.5 });
        }
    }
}

/// How much the trees know of drawings of a size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// They saw none.
    Unknown,
    /// They saw sketches.
    Sketch,
    /// They saw plans.
    Plan,
}

/// A name is believed unless the trees are so sure of another class.
const OTHER_SURE: f64 = 0.9;
/// The smallest sketch of those that the trees were trained on has 5 pieces: of smaller drawings only names are believed.
const PIECES_TRAINED: usize = 5;
/// The same of plans, which have 81 and more: in smaller drawings names are believed wherever there are some.
const PIECES_OF_PLANS: usize = 81;
/// Doors and stairs are often drawn on the layer of the walls: the trees are believed earlier there. None of those
/// drawings is read otherwise by it. Furniture is not: what stands free on such a layer may be a partition.
const BESIDE_WALLS: [usize; 2] = [DOOR, STAIR];
/// See [`BESIDE_WALLS`].
const BESIDE_WALLS_SURE: f64 = 0.5;
/// Where so much of the length of the walls lies on layers that are named after walls, what no name calls anything is a
/// wall from [`WALL_BESIDE_NAMED`] on.
const NAMED_SHARE: f64 = 0.5;
/// See [`NAMED_SHARE`].
const WALL_BESIDE_NAMED: f64 = 0.9;

/// Places of the classes in the table.
const WALL: usize = 0;
const WINDOW: usize = 1;
const DOOR: usize = 2;
const STAIR: usize = 3;
const FURNITURE: usize = 4;

/// What the names of an entity's blocks and layer say, the innermost block's first: a window in a wall is a window.
#[derive(Clone, Copy)]
pub struct Name {
    /// What they call it; [`Role::Unknown`] where they say nothing.
    pub role: Role,
    /// Whether it names windows as well as doors.
    is_both: bool,
}

/// What names say, looked up once each.
#[derive(Default)]
pub struct Names<'d> {
    known: HashMap<&'d str, Name>,
}

impl<'d> Names<'d> {
    /// Of an entity.
    pub fn of(&mut self, e: &'d Entity) -> Name {
        let mut last = Name { role: Role::Unknown, is_both: false };
        for name in e.blocks.iter().rev().map(String::as_str).chain([e.layer.as_str()]) {
            last = *self.known.entry(name).or_insert_with(|| {
                let role = role_by_name(name).0;
                Name { role, is_both: role == Role::Door && is_of_windows_too(name) }
            });
            if last.role != Role::Unknown {
                break;
            }
        }
        last
    }
}

/// The class of a role; of one that says nothing none.
fn class_of(role: Role) -> usize {
    match role {
        Role::Wall | Role::Column | Role::LowWall => WALL,
        Role::Window | Role::Glazing => WINDOW,
        Role::Door => DOOR,
        Role::Stair => STAIR,
        Role::Furniture => FURNITURE,
        Role::Text | Role::Dimension | Role::Hatch | Role::Grid => 5,
        Role::Site | Role::Roof | Role::Foundation | Role::Room => 6,
        Role::Unknown => CLASSES,
    }
}

/// The class with most votes, the first of equals.
fn likeliest(votes: &Votes) -> usize {
    (0..CLASSES).max_by(|i, j| votes[*i].total_cmp(&votes[*j]).then(j.cmp(i))).unwrap_or(WALL)
}

/// What the name says, unless the votes speak strongly against it, in a drawing of a kind that the trees know; without a
/// name what most votes say.
fn sense(votes: &Votes, name: Name, kind: Kind) -> RoleSense {
    let best = likeliest(votes);
    if let Some(own) = votes.get(class_of(name.role)) {
        let own = if name.is_both { own + votes[WINDOW] } else { *own };
        let is_on_walls = class_of(name.role) == WALL && BESIDE_WALLS.contains(&best);
        let may_stand_free = class_of(name.role) == WALL && best == FURNITURE;
        let is_other =
            votes[best] >= OTHER_SURE && !may_stand_free || is_on_walls && votes[best] >= BESIDE_WALLS_SURE;
        if !(kind == Kind::Plan && is_other) {
            let is_window = name.is_both && votes[WINDOW] > votes[DOOR];
            let role = if is_window { Role::Window } else { name.role };
            return RoleSense { role, confidence: own.max(1.0 - votes[best]) as f32 };
        }
    }
    let role = match best {
        _ if kind == Kind::Unknown => Role::Unknown,
        WALL => Role::Wall,
        WINDOW => Role::Window,
        DOOR => Role::Door,
        STAIR => Role::Stair,
        FURNITURE => Role::Furniture,
        5 => Role::Text,
        _ => Role::Unknown,
    };
    RoleSense { role, confidence: votes[best] as f32 }
}
