//! Ground that a building's file says lies in the open air: spaces outside it, slabs named after gardens and terraces.

use glam::DVec2;

use super::Reader;
use crate::ifc::footprint::Footprint;
use crate::ifc::model::{Product, product};
use crate::ifc::step::Value;
use crate::ifc::structure::height_of;
use crate::names::is_outdoors;
use crate::plane::{box_of, share_of_smaller};
use crate::region::Region;
use crate::storey_words::storey_name;
use enfilade_report::Report;

/// Layer of ground that lies in the open air.
pub const OUTDOORS_LAYER: &str = "IfcSlab";

/// Ground so near to the height of a storey's floor is on it: a step, a build-up.
const FLOOR_M: f64 = 0.6;

/// A slab that covers so much of the box round all walls is ground that the building stands on.
const GROUND_MIN: f64 = 0.5;

impl Reader<'_, '_, '_> {
    /// Shows the slabs at the storey's floor that are named after what lies in the open air, and says so.
    pub(super) fn outdoors(&mut self, report: &mut Report) {
        let walls = self.entities.iter().filter(|e| e.layer.starts_with("IfcWall"));
        let Some(building) = box_of(walls.flat_map(|e| crate::curve::control_points(&e.shape))) else {
            return;
        };
        let keywords = ["IFCSLAB", "IFCSLABSTANDARDCASE"];
        let all = keywords.into_iter().flat_map(|keyword| self.b.step.all(keyword));
        let slabs: Vec<Product> = all
            .map(|i| product(self.b.step, i.id, "IfcSlab"))
            .filter(|p| is_outdoors(&p.name) && storey_name(&p.name).is_none())
            .filter(|p| self.b.model.storey_of(p.id) == self.storey && self.is_at_floor(p))
            .collect();
        for slab in slabs {
            let mut is_shown = false;
            for ground in Footprint::slices(self.b, &slab, 1) {
                if is_part_of(ground.extent(), building) {
                    is_shown = true;
                    let ring = |ring: &Vec<DVec2>| ring.iter().map(|p| p.to_array()).collect();
                    self.emit(
                        &slab,
                        OUTDOORS_LAYER,
                        &Region::even_odd(ground.rings().iter().map(ring).collect()),
                    );
                }
            }
            if is_shown {
                let text = format!(
                    "{:?} is named after what lies in the open air; the ground on it is not measured; --inside X,Y takes it in",
                    slab.name
                );
                report.info("ifc-outdoors", self.b.place(&slab), text);
            }
        }
    }

    /// Whether a slab lies where the storey's floor is.
    fn is_at_floor(&self, slab: &Product) -> bool {
        let near = FLOOR_M / self.b.geo.metres;
        height_of(self.b, slab)
            .is_some_and(|[low, high]| low <= self.floor + near && high >= self.floor - near)
    }

    /// Says of a space that lies outside the building by its own word that it is not measured.
    pub(super) fn state_external(&self, space: &Product, region: &Region, report: &mut Report) {
        if region.extent().is_none() || !self.is_external(space) {
            return;
        }
        let name = self.b.space_names(space).names.join(" ");
        let text = format!(
            "space {name:?} is EXTERNAL, in the open air; the ground on it is not measured; --inside X,Y takes it in"
        );
        report.info("ifc-outdoors", self.b.place(space), text);
    }

    /// Whether a space lies outside the building by its own word.
    pub(super) fn is_external(&self, space: &Product) -> bool {
        const KIND: usize = 9;
        let kind = self.b.step.args(space.id);
        matches!(kind.get(KIND).map(|a| &a.value), Some(Value::Enum(word)) if word.eq_ignore_ascii_case("EXTERNAL"))
    }
}

/// Whether a slab is a part of the ground of a building: not beside it, and not what all of it stands on.
fn is_part_of(slab: [DVec2; 2], building: [DVec2; 2]) -> bool {
    let area = |[low, high]: [DVec2; 2]| (high - low).element_product();
    share_of_smaller(slab, building) > 0.0 && area(slab) < GROUND_MIN * area(building)
}
