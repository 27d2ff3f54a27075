//! What a CAD program does not show, apart from layers that are off or frozen: left out, and listed.

use std::collections::HashSet;

use super::fields::Fields;
use super::reader::{Reader, Unseen};
use crate::drawing::Entity;
use crate::roles::{Role, role_by_name};
use enfilade_report::Severity;

/// Kinds that may draw a wall.
const DRAWN: [&[u8]; 9] =
    [b"LINE", b"LWPOLYLINE", b"POLYLINE", b"ARC", b"CIRCLE", b"ELLIPSE", b"SPLINE", b"MLINE", b"INSERT"];

/// Layers that are listed, at most.
const LISTED: usize = 8;

impl Reader<'_, '_> {
    /// Counts a record that is invisible (group 60) and may be a wall. In blocks the states of dynamic ones are hidden so
    /// by the hundred: there only what is named after walls counts.
    pub(super) fn count_invisible(&mut self, fields: &Fields<'_, '_>, layer: u32) {
        let is_own = self.tokens.section(b"ENTITIES").is_some_and(|s| s.contains(&fields.record));
        let role = role_by_name(self.layers.name(layer)).0;
        let is_counted = is_wall(role) || is_own && role == Role::Unknown;
        if is_counted && DRAWN.contains(&self.tokens.name(fields.record)) {
            *self.unseen.invisible.entry(layer).or_default() += 1;
        }
    }

    /// Counts an INSERT within a block that a frozen layer hides.
    pub(super) fn count_frozen_insert(&mut self, layer: u32) {
        if may_be_wall(self.layers.name(layer)) {
            *self.unseen.in_blocks.entry(layer).or_default() += 1;
        }
    }

    /// Lists what is hidden and may be a wall; `entities`: all of model space.
    pub(super) fn note_hidden(&mut self, entities: &[Entity]) {
        let mut counted = HashSet::new();
        for e in entities.iter().filter(|e| e.blocks.iter().all(|b| may_be_wall(b))) {
            let (Some(insert), Some(layer)) = (e.origin.inserts.first(), self.hiding(e)) else { continue };
            if counted.insert((*insert, layer)) {
                *self.unseen.in_blocks.entry(layer).or_default() += 1;
            }
        }
        let Unseen { invisible, in_blocks } = std::mem::take(&mut self.unseen);
        let of =
            |(layer, n): (&u32, &usize), what: &str| format!("{n} {what} {:?}", self.layers.name(*layer));
        let mut all: Vec<String> = invisible.iter().map(|of_layer| of(of_layer, "invisible on")).collect();
        all.extend(in_blocks.iter().map(|of_layer| of(of_layer, "in blocks on the hidden layer")));
        if all.is_empty() {
            return;
        }
        let more = if all.len() > LISTED { ", …" } else { "" };
        all.truncate(LISTED);
        let text = format!(
            "the drawing hides what may be walls: {}{more}; left out of the plan; show it if it should be measured",
            all.join(", ")
        );
        self.note_file("dxf-hidden", Severity::Info, text);
    }

    /// The layer of the INSERT that hides an entity of a block which may be a wall, where its own layer is not one of walls
    /// that is hidden: that is said of the layer.
    fn hiding(&self, e: &Entity) -> Option<u32> {
        let of = |name: &str| self.layers.of_name(&name.to_uppercase());
        let layer = |i: u32| &self.layers.list[i as usize];
        let (insert, own) = (of(&e.source.layer)?, of(&e.layer)?);
        let is_hidden = layer(own).is_off || layer(own).is_frozen;
        // What is drawn on layer 0 is shown on the layer of its INSERT.
        let is_by_block = Fields::of(self.tokens, e.origin.record).value(8).is_none_or(|name| name == b"0");
        let role = role_by_name(&e.layer).0;
        match is_hidden {
            true => (is_by_block && role == Role::Unknown).then_some(own),
            false if layer(insert).is_frozen => {
                let may_be = is_wall(role) || role == Role::Unknown && may_be_wall(&layer(insert).name);
                may_be.then_some(insert)
            }
            false => None,
        }
    }
}

/// Whether a layer is named after walls, or after nothing that is known.
fn may_be_wall(layer: &str) -> bool {
    let role = role_by_name(layer).0;
    is_wall(role) || role == Role::Unknown
}

fn is_wall(role: Role) -> bool {
    role.stops_sight() || role == Role::LowWall
}
