//! Where the storeys of a file stand: at which height, where it contradicts itself, and in which of several buildings.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use glam::DVec2;

use super::building::Building;
use super::model::Storey;
use super::standing::reach;
use crate::plane::{box_of, share_of_smaller};
use enfilade_report::{Place, Report, counted};

/// Two buildings whose boxes share this much of the smaller one are two models of one: of its structure, of its fittings.
const ONE_BUILDING_MIN: f64 = 0.5;

/// Walls so near to a height stand on the floor there, metres: above a plinth, below a build-up.
const NEAR_M: f64 = 0.6;

impl Building<'_, '_> {
    /// Takes another height for the floor of a storey that is placed where its walls do not stand: its elevation, if they
    /// stand there, else where they stand. Asked where the elevation says another height, or two storeys have one.
    pub(super) fn settle_floors(&mut self) {
        let near = NEAR_M / self.geo.metres;
        let all = &self.model.storeys;
        let is_doubtful = |s: &Storey| {
            let is_twin =
                |o: &Storey| o.id != s.id && o.building == s.building && (o.floor - s.floor).abs() < near;
            s.elevation.is_some() || all.iter().any(is_twin)
        };
        let believed = |s: &Storey| {
            let walls =
                self.model.products.iter().filter(|p| p.class.starts_with("IfcWall") && is_doubtful(s));
            let own = walls.filter(|p| self.model.storey_of(p.id) == Some(s.id));
            let mut lows: Vec<f64> = own.filter_map(|p| Some(reach(self, p.id)?[0])).collect();
            lows.sort_by(f64::total_cmp);
            let low = *lows.get(lows.len() / 2)?;
            if (low - s.floor).abs() <= near {
                return None;
            }
            Some(s.elevation.filter(|stated| (low - stated).abs() <= near).unwrap_or(low))
        };
        let all: Vec<Option<f64>> = self.model.storeys.iter().map(believed).collect();
        for (storey, floor) in self.model.storeys.iter_mut().zip(all) {
            if let Some(floor) = floor {
                storey.placed = Some(std::mem::replace(&mut storey.floor, floor));
            }
        }
        self.model.storeys.sort_by(|a, b| a.floor.total_cmp(&b.floor));
    }

    /// The name of a storey's building, where the file has storeys of several.
    pub(super) fn building_name(&self, storey: &Storey) -> Option<String> {
        let all: BTreeSet<u64> = self.model.storeys.iter().filter_map(|s| s.building).collect();
        let id = storey.building.filter(|_| all.len() > 1)?;
        let args = self.step.args(id);
        let said = [2, 7].into_iter().filter_map(|k| self.step.text(args.get(k)?));
        said.map(|n| n.trim().to_owned()).find(|n| !n.is_empty()).or_else(|| Some(format!("#{id}")))
    }

    /// The storeys of other buildings than that of a storey, which stand elsewhere.
    pub(super) fn storeys_beside(&self, storey: u64) -> HashSet<u64> {
        let building_of: BTreeMap<u64, u64> =
            self.model.storeys.iter().filter_map(|s| Some((s.id, s.building?))).collect();
        let all: BTreeSet<u64> = building_of.values().copied().collect();
        let Some(own) = building_of.get(&storey).filter(|_| all.len() > 1) else { return HashSet::new() };
        let mut points: BTreeMap<u64, Vec<DVec2>> = BTreeMap::new();
        for (id, wall) in self.standing() {
            let building = self.model.storey_of(*id).and_then(|s| building_of.get(&s));
            points.entry(*building.unwrap_or(own)).or_default().extend(wall.at.extent());
        }
        let ground = |building: &u64| box_of(points.get(building)?.iter().copied());
        let is_beside = |other: &u64| {
            let both = ground(own).zip(ground(other));
            both.is_some_and(|(own, other)| share_of_smaller(own, other) < ONE_BUILDING_MIN)
        };
        let others: BTreeSet<u64> = all.iter().copied().filter(|o| o != own && is_beside(o)).collect();
        building_of.into_iter().filter(|(_, of)| others.contains(of)).map(|(storey, _)| storey).collect()
    }

    /// Says what is taken of a storey's height, and which buildings beside it are left out.
    pub(super) fn state_floor(&self, storey: &Storey, beside: &HashSet<u64>, report: &mut Report) {
        if let Some(placed) = storey.placed {
            let [placed, floor] = [placed, storey.floor].map(|z| z * self.geo.metres);
            let stated = storey
                .elevation
                .map(|z| format!(" and states {:.3} m as its elevation", z * self.geo.metres));
            let text = format!(
                "storey \"{}\" is placed at {placed:.3} m{}; its walls stand at {floor:.3} m, so its floor is taken there",
                storey.name,
                stated.unwrap_or_default()
            );
            report.info("storey-floor", Place::file(self.file), text);
        }
        let mut others: BTreeMap<String, usize> = BTreeMap::new();
        for other in self.model.storeys.iter().filter(|s| beside.contains(&s.id)) {
            *others.entry(self.building_name(other).unwrap_or_default()).or_default() += other.walls;
        }
        if !others.is_empty() {
            let of =
                |(name, walls): (&String, &usize)| format!("\"{name}\" ({})", counted(*walls as u64, "wall"));
            let list: Vec<String> = others.iter().map(of).collect();
            let text = format!(
                "{} beside \"{}\" left out: {}; --storey NUMBER takes a storey of another",
                counted(list.len() as u64, "building"),
                self.building_name(storey).unwrap_or_default(),
                list.join(", ")
            );
            report.info("ifc-buildings", Place::file(self.file), text);
        }
    }
}
