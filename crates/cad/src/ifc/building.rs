//! A building as read: its file with geometry, products and units.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use super::footprint::StandingWall;
use super::geo::Geo;
use super::model::{Model, Product};
use super::step::{Arg, Step};
use super::units::Units;
use crate::drawing::{SourceRef, Unit};
use enfilade_report::Place;

/// A file ready to be cut.
pub(super) struct Building<'s, 'a> {
    /// Name to show.
    pub file: &'s str,
    /// The file.
    pub step: &'s Step<'a>,
    /// Its geometry.
    pub geo: Geo<'s, 'a>,
    /// Its products.
    pub model: Model,
    /// Its units.
    pub units: Units,
    /// Its unit of length by the heights of its walls, where nobody says one or they cannot be so high in it.
    pub unit_by_heights: Option<Unit>,
    /// Why the unit that the file states is doubted.
    pub unit_doubt: Option<String>,
    /// See [`Self::standing`].
    pub standing: OnceLock<BTreeMap<u64, StandingWall>>,
}

impl<'s, 'a> Building<'s, 'a> {
    /// The name of the storey in which an element stands.
    pub fn storey_name(&self, id: u64) -> Option<String> {
        let of = self.model.storey_of(id)?;
        self.model.storeys.iter().find(|s| s.id == of).map(|s| s.name.clone())
    }

    /// `house.ifc:12 #4711 IfcWall 2O2F…`.
    pub fn place(&self, p: &Product) -> Place {
        let line = self.step.get(p.id).map(|i| self.step.line(i.span.start));
        Place { file: self.file.into(), line, entity: format!("#{} {} {}", p.id, p.class, p.global_id) }
    }

    /// Where a product stands in the file, as of a layer.
    pub fn source(&self, p: &Product, layer: &str) -> SourceRef {
        SourceRef {
            record: p.id as usize,
            handle: Some(p.global_id.clone()).filter(|g| !g.is_empty()),
            line: self.step.get(p.id).map_or(0, |i| self.step.line(i.span.start)),
            kind: p.class.into(),
            layer: layer.into(),
        }
    }
}

/// Why a product cannot be moved, if so.
pub(super) fn refusal(b: &Building<'_, '_>, id: u64) -> Option<String> {
    if !b.step.duplicates.is_empty() {
        return Some("the file gives one number to several instances".into());
    }
    let global_id = b.step.args(id).first().and_then(|a| b.step.text(a)).unwrap_or_default();
    if b.model.twice.contains(&global_id) {
        return Some(format!("the file gives its GlobalId {global_id} to several elements"));
    }
    for follower in b.model.follows(id) {
        let Some(placement) = b.step.args(follower).get(5).and_then(Arg::id) else { continue };
        if let Err(why) = b.geo.placement(placement) {
            return Some(why);
        }
    }
    None
}
