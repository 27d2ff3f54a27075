//! What is said of elements that are not shown as they are, on the storey in which they stand.

use std::collections::HashSet;

use super::{Product, Reader};
use enfilade_report::{Place, Report, counted};

/// Walls that keep their length, or cannot be read and stand in other storeys, and are told one by one.
const TOLD: usize = 4;

/// Where an element stands as seen from the storey that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// In that storey.
    Here,
    /// In another one.
    Elsewhere,
    /// In none that the file names.
    Nowhere,
}

impl Reader<'_, '_, '_> {
    pub(super) fn standing(&self, p: &Product) -> Standing {
        match self.b.model.storey_of(p.id) {
            of if of == self.storey => Standing::Here,
            None => Standing::Nowhere,
            Some(_) => Standing::Elsewhere,
        }
    }

    /// Says that a part of an element is missing, where it stands: a reader of another storey cannot know whether
    /// what is missing would reach up or down to it.
    pub(super) fn state_missing(&mut self, p: &Product, why: &str, report: &mut Report) {
        let is_wall = is_wall(p);
        let code = if is_wall { "ifc-element" } else { "ifc-other-element" };
        let text = format!("{why}; this part of it is left out");
        match (self.standing(p), is_wall) {
            (Standing::Here | Standing::Nowhere, true) => report.warn(code, self.b.place(p), text),
            (Standing::Here | Standing::Nowhere, false) => report.info(code, self.b.place(p), text),
            (Standing::Elsewhere, true) => self.elsewhere.push(p.id),
            (Standing::Elsewhere, false) => {}
        }
    }

    /// Says which walls do not reach the cut, which cannot be read elsewhere and which keep their length.
    pub(super) fn state_left_out(&self, report: &mut Report) {
        let place = Place::file(self.b.file);
        let shown: HashSet<usize> = self.entities.iter().map(|e| e.source.record).collect();
        let walls = self
            .b
            .model
            .products
            .iter()
            .filter(|p| p.class.contains("Wall") || p.class.starts_with("IfcColumn"));
        let short: Vec<String> = walls
            .filter(|p| self.standing(p) == Standing::Here)
            .filter(|p| !shown.contains(&(p.id as usize)) && self.below.contains(&p.id))
            .map(|p| format!("#{}", p.id))
            .collect();
        if !short.is_empty() {
            let text = format!(
                "{} walls or columns of the storey do not reach the height of the cut and do not block sight: {}",
                short.len(),
                short.join(", ")
            );
            report.info("ifc-not-cut", place.clone(), text);
        }
        self.state_temporary(&place, report);
        self.state_elsewhere(&place, report);
        self.state_stiff(place, report);
    }

    /// Lists what is left out because it stands only while the works last.
    fn state_temporary(&self, place: &Place, report: &mut Report) {
        let name = |id: &u64| {
            let name = self.b.model.product(*id).map_or("", |p| p.name.trim());
            if name.is_empty() { format!("#{id}") } else { format!("#{id} {name:?}") }
        };
        let told: Vec<String> = self.temporary.iter().take(TOLD).map(name).collect();
        if told.is_empty() {
            return;
        }
        let more = if self.temporary.len() > TOLD { ", …" } else { "" };
        let count = counted(self.temporary.len() as u64, "element");
        let text = format!(
            "{count} with the Status TEMPORARY left out: {}{more}; another Status takes them in",
            told.join(", ")
        );
        report.info("ifc-temporary", place.clone(), text);
    }

    fn state_elsewhere(&self, place: &Place, report: &mut Report) {
        let mut ids = self.elsewhere.clone();
        ids.dedup();
        let Some(first) = ids.first() else { return };
        let told: Vec<String> = ids.iter().take(TOLD).map(|id| format!("#{id}")).collect();
        let more = if ids.len() > TOLD { ", …" } else { "" };
        let storeys = &self.b.model.storeys;
        let of = self.b.model.storey_of(*first).and_then(|id| storeys.iter().find(|s| s.id == id));
        let of = of.map_or_else(String::new, |s| format!(", as \"{}\"", s.name));
        let text = format!(
            "{} walls or columns of other storeys{of} cannot be read whole, whether they reach this one is not known: {}{more}; \
             their own storeys say why",
            ids.len(),
            told.join(", ")
        );
        report.info("ifc-other-storey", place.clone(), text);
    }

    fn state_stiff(&self, place: Place, report: &mut Report) {
        if self.stiff.is_empty() {
            return;
        }
        let told = self.stiff.iter().take(TOLD).map(|(id, why)| format!("#{id} ({why})"));
        let more = if self.stiff.len() > TOLD { ", …" } else { "" };
        let text = format!(
            "{} where another that it ends at moves: {}{more}",
            match self.stiff.len() {
                1 => "1 wall keeps its length".to_string(),
                n => format!("{n} walls keep their length, each"),
            },
            told.collect::<Vec<_>>().join(", ")
        );
        report.info("ifc-length", place, text);
    }
}

/// Whether it is a wall, a column or a curtain wall.
pub(super) fn is_wall(p: &Product) -> bool {
    ["IfcWall", "IfcColumn", "IfcCurtainWall"].iter().any(|c| p.class.starts_with(c))
}

/// A length as a message shows it: to the millimetre.
pub(super) fn metres(length: f64) -> f64 {
    (length * 1e3).round() / 1e3
}
