//! The class of every entity, by the votes of trees over the pieces that it draws.

use rayon::prelude::*;

use super::Sense;
use super::features::Features;
use super::scene::Scene;
use super::trees::{CLASSES, Votes, model};
use crate::plan::drawing::Drawing;
use crate::plan::roles::{Role, role_by_name};

/// What each entity is taken for, if `metres` are those of a drawing unit; `None` for an entity that is not looked at:
/// hidden, or of no length.
pub fn classify(drawing: &Drawing, metres: f64) -> Vec<Option<Sense>> {
    let mut out = vec![None; drawing.entities.len()];
    let Some((scene, model)) = Scene::new(drawing, metres).zip(model()) else { return out };
    let features = Features::new(&scene);
    let votes_of = |i: usize| {
        let row = features.row(i);
        model.forest.votes(&model.picks.iter().map(|k| row[*k]).collect::<Vec<f32>>())
    };
    let votes: Vec<Votes> = (0..scene.pieces.len()).into_par_iter().map(votes_of).collect();
    for thing in &scene.things {
        let mut sums = [0.0; CLASSES];
        for i in thing.pieces.start as usize..thing.pieces.end as usize {
            let share = scene.pieces[i].length / thing.length;
            sums.iter_mut().zip(&votes[i]).for_each(|(s, v)| *s += v * share);
        }
        let e = &drawing.entities[thing.entity as usize];
        out[thing.entity as usize] = Some(sense(&sums, role_by_name(&e.layer).0));
    }
    out
}

/// The class with most votes, the first of equals; the name tells what kind of it.
fn sense(votes: &Votes, named: Role) -> Sense {
    let best = (0..CLASSES).max_by(|i, j| votes[*i].total_cmp(&votes[*j]).then(j.cmp(i))).unwrap_or(0);
    let kinds: &[Role] = match best {
        0 => &[Role::Wall, Role::Column, Role::LowWall],
        1 => &[Role::Window, Role::Glazing],
        2 => &[Role::Door],
        3 => &[Role::Stair],
        4 => &[Role::Furniture],
        5 => &[Role::Text, Role::Dimension, Role::Hatch, Role::Grid],
        _ => &[Role::Unknown, Role::Site, Role::Roof, Role::Foundation, Role::Room],
    };
    let role = kinds.iter().copied().find(|r| *r == named).unwrap_or(kinds[0]);
    Sense { role, confidence: votes[best] as f32 }
}
