//! What a drawing is taken for: its unit, the role of every entity, and how sure that is.
//!
//! A [`Reading`] is decided once, before anything is understood, and never changed afterwards.

mod classify;
pub mod clues;
pub mod corrections;
mod features;
pub mod lengths;
pub mod questions;
mod scene;
pub(super) mod section;
pub mod training;
mod trees;
pub mod unit;

use std::collections::BTreeSet;

use crate::views::BOX_RIGHT;
pub(super) use classify::Names;
use corrections::{Finding, Said};
use enfilade_cad::drawing::{Drawing, Format, Unit};
use enfilade_cad::own_layers;
use enfilade_cad::roles::{Role, role_by_name};

/// What an entity is taken for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoleSense {
    /// Its role.
    pub role: Role,
    /// How sure that is, 0 to 1: of the entities with a confidence of 0.9 about 90 % are what they are taken for.
    pub confidence: f32,
}

/// How sure an outline of a room is a wall: below [`questions::WALLS_SURE`], so that it is asked. Two drawings only.
const OUTLINE_SURE: f32 = 0.4;

/// How sure the unit is, and why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitSense {
    /// 0 to 1.
    pub confidence: f64,
    /// Codes of the evidence that sets it apart from the next best, the strongest first: `user`, `heights` or those of
    /// [`unit::CODES`].
    pub reasons: Vec<&'static str>,
    /// The next best unit, or the best where another one is stated.
    pub runner_up: Option<Rival>,
}

/// A unit that the drawing may be in as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rival {
    /// The unit.
    pub unit: Unit,
    /// How likely it is, 0 to 1.
    pub probability: f64,
    /// Whether doors are drawn that speak for it.
    pub has_doors: bool,
}

/// What a drawing is taken for. See the module page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The unit's confidence; the unit itself is [`super::Plan::unit`].
    pub unit: UnitSense,
    /// Of every entity of the drawing, in its order.
    pub senses: Vec<RoleSense>,
    /// Roles that the user states, by the index of the entity.
    pub said: Said,
    /// Walls, by their index in [`super::Plan::walls`], that the user calls so.
    pub firm: BTreeSet<u32>,
    /// What corrections could not do.
    pub findings: Vec<Finding>,
}

impl Reading {
    /// Decides what every entity is. `metres`: of a person, in a drawing unit. What is no drawing of lines says by its
    /// classes what it is.
    pub fn new(drawing: &Drawing, metres: f64) -> Self {
        match drawing.format {
            Format::Dxf => Self::of_classes(drawing, classify::classify(drawing, metres)),
            _ => Self::by_names(drawing),
        }
    }

    /// By the names of layers alone.
    pub fn by_names(drawing: &Drawing) -> Self {
        Self::of_classes(drawing, vec![None; drawing.entities.len()])
    }

    fn of_classes(drawing: &Drawing, classes: Vec<Option<RoleSense>>) -> Self {
        let by_name = |layer: &str| {
            let role = role_by_name(layer).0;
            RoleSense { role, confidence: if role == Role::Unknown { 0.5 } else { 1.0 } }
        };
        let entities = drawing.entities.iter().zip(classes);
        let senses = entities.map(|(e, class)| class.unwrap_or_else(|| by_name(&e.layer))).collect();
        Self { senses, ..Self::default() }
    }

    /// The same with what the user says; `walls`: indices of the entities that are walls, in the plan's order.
    #[must_use]
    pub fn corrected(mut self, said: Said, walls: &[usize]) -> Self {
        for (i, role) in &said {
            if let Some(sense) = self.senses.get_mut(*i) {
                *sense = RoleSense { role: *role, confidence: 1.0 };
            }
        }
        let is_firm = |(_, i): &(usize, &usize)| said.get(*i) == Some(&Role::Wall);
        self.firm = walls.iter().enumerate().filter(is_firm).map(|(w, _)| w as u32).collect();
        self.said = said;
        self
    }

    /// Without what is drawn beside the plans of a sheet: a section cuts no wall of theirs. That is as sure as the boxes of
    /// drawings are right.
    #[must_use]
    pub(super) fn without_beside(mut self, is_beside: &[bool]) -> Self {
        let senses = self.senses.iter_mut().zip(is_beside).filter(|(_, is_beside)| **is_beside);
        senses.for_each(|(s, _)| *s = RoleSense { role: Role::Unknown, confidence: BOX_RIGHT as f32 });
        self
    }

    /// Where nothing is a wall, what draws rooms says where they end: their outlines are the walls.
    #[must_use]
    pub(super) fn with_rooms_as_walls(mut self) -> Self {
        if self.senses.iter().any(|s| matches!(s.role, Role::Wall | Role::Column | Role::LowWall)) {
            return self;
        }
        let rooms = self.senses.iter_mut().filter(|s| s.role == Role::Room);
        rooms.for_each(|s| *s = RoleSense { role: Role::Wall, confidence: OUTLINE_SURE });
        self
    }

    /// The role of an entity, by its index in [`Drawing::entities`].
    pub fn role(&self, entity: usize) -> Role {
        self.senses.get(entity).map_or(Role::Unknown, |s| s.role)
    }

    /// The senses of what is not ours, in the order of [`super::Plan::picked`]: with them a changed copy is read alike.
    pub fn kept(&self, drawing: &Drawing) -> Vec<RoleSense> {
        let foreign =
            drawing.entities.iter().zip(&self.senses).filter(|(e, _)| !own_layers::is_own(&e.layer));
        foreign.map(|(_, s)| *s).collect()
    }

    /// The reading of a changed copy of a drawing, from what was [`kept`](Self::kept) of it.
    pub fn again(drawing: &Drawing, kept: &[RoleSense]) -> Self {
        let mut next = kept.iter().copied();
        let other = RoleSense { role: Role::Unknown, confidence: 1.0 };
        let of = |layer: &str| if own_layers::is_own(layer) { other } else { next.next().unwrap_or(other) };
        let senses = drawing.entities.iter().map(|e| e.layer.as_str()).map(of).collect();
        Self { senses, ..Self::default() }
    }
}
