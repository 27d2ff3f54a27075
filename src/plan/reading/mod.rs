//! What a drawing is taken for: its unit, the role of every entity, and how sure that is.
//!
//! A [`Reading`] is decided once, before anything is understood, and never changed afterwards.

pub mod clues;
pub mod corrections;
pub mod lengths;
pub mod questions;
pub mod unit;

use std::collections::BTreeSet;

use super::drawing::{Drawing, Unit};
use super::roles::{Role, role_by_name};
use corrections::{Finding, Said};

/// What an entity is taken for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sense {
    /// Its role.
    pub role: Role,
    /// How sure that is, 0 to 1: of the entities with a confidence of 0.9 about 90 % are what they are taken for.
    pub confidence: f32,
}

/// How sure the unit is, and why.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UnitSense {
    /// 0 to 1.
    pub confidence: f64,
    /// Codes of the evidence that sets it apart from the next best, the strongest first: `user`, `heights` or those of
    /// [`unit::CODES`].
    pub reasons: Vec<&'static str>,
    /// The next best unit and how likely it is.
    pub runner_up: Option<(Unit, f64)>,
}

/// What a drawing is taken for. See the module page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The unit's confidence; the unit itself is [`super::Plan::unit`].
    pub unit: UnitSense,
    /// Of every entity of the drawing, in its order.
    pub senses: Vec<Sense>,
    /// Roles that the user states, by the index of the entity.
    pub said: Said,
    /// Walls, by their index in [`super::Plan::walls`], that the user calls so.
    pub firm: BTreeSet<u32>,
    /// What corrections could not do.
    pub findings: Vec<Finding>,
}

impl Reading {
    /// By the names of layers alone.
    pub fn by_names(drawing: &Drawing) -> Self {
        let sense = |layer: &str| {
            let role = role_by_name(layer).0;
            Sense { role, confidence: if role == Role::Unknown { 0.5 } else { 1.0 } }
        };
        let unit = UnitSense { confidence: 1.0, ..UnitSense::default() };
        let senses = drawing.entities.iter().map(|e| sense(&e.layer)).collect();
        Self { unit, senses, ..Self::default() }
    }

    /// The same with what the user says; `walls`: indices of the entities that are walls, in the plan's order.
    #[must_use]
    pub fn corrected(mut self, said: Said, walls: &[usize]) -> Self {
        for (i, role) in &said {
            if let Some(sense) = self.senses.get_mut(*i) {
                *sense = Sense { role: *role, confidence: 1.0 };
            }
        }
        let is_firm = |(_, i): &(usize, &usize)| said.get(*i) == Some(&Role::Wall);
        self.firm = walls.iter().enumerate().filter(is_firm).map(|(w, _)| w as u32).collect();
        self.said = said;
        self
    }

    /// The role of an entity, by its index in [`Drawing::entities`].
    pub fn role(&self, entity: usize) -> Role {
        self.senses.get(entity).map_or(Role::Unknown, |s| s.role)
    }
}
