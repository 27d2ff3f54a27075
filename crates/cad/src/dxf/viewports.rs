//! Layers that the sheets of paper do not show: frozen in every viewport through which the plan is seen.

use std::collections::BTreeSet;

use glam::DVec2;

use super::fields::{Fields, handle_of, own_pairs};
use super::reader::Reader;
use crate::own_layers::is_own;
use crate::roles::role_by_name;

/// Bit of group 90 of a viewport that is off.
const OFF: i64 = 0x2_0000;

/// The number (69) of the viewport that stands for the sheet of paper itself.
const SHEET: i64 = 1;

/// A view whose direction leans no more than this looks straight down.
const LEANING_MAX: f64 = 1e-6;

impl Reader<'_, '_> {
    /// Freezes the layers that are frozen in every viewport which shows the plan; `extent`: the box of model space.
    ///
    /// A viewport without any layer of walls shows something else, and has no say.
    pub fn freeze_by_viewports(&mut self, extent: Option<[DVec2; 2]>) {
        let views: Vec<usize> = self.viewports().filter(|v| self.shows_plan(*v, extent)).collect();
        if views.is_empty() {
            return;
        }
        let walls = self.layers_of_walls();
        let frozen = views.into_iter().map(|v| self.frozen_in(v));
        let of_plan = frozen.filter(|f| walls.is_empty() || !walls.is_subset(f));
        let everywhere = of_plan.reduce(|all, one| all.intersection(&one).copied().collect());
        for layer in everywhere.unwrap_or_default() {
            // Marks are hidden on sheets of paper as a matter of course.
            let layer = &mut self.layers.list[layer as usize];
            layer.is_frozen |= !is_own(&layer.name);
        }
    }

    /// The viewports of all sheets: of the one on top among the entities, of the others in blocks.
    fn viewports(&self) -> impl Iterator<Item = usize> {
        let sections = [&b"BLOCKS"[..], b"ENTITIES"].into_iter().filter_map(|name| self.tokens.section(name));
        sections.flatten().filter(|r| self.tokens.name(*r) == b"VIEWPORT")
    }

    /// Whether a viewport is switched on, looks straight down, and has the plan before it.
    fn shows_plan(&self, viewport: usize, extent: Option<[DVec2; 2]>) -> bool {
        let fields = Fields::of(self.tokens, viewport);
        let int = |code: i32| fields.pair(code).and_then(|p| self.tokens.integer(p));
        let number = |code: i32| fields.pair(code).and_then(|p| self.tokens.number(p));
        let flags = own_pairs(self.tokens, viewport).find(|(_, p)| p.code == 90);
        let flags = flags.and_then(|(_, p)| self.tokens.integer(p));
        // Group 68 of a sheet that is not on top says nothing where flags are written.
        let is_off = flags.map_or(int(68) == Some(0), |flags| flags & OFF != 0);
        let point = |code: i32| DVec2::new(number(code).unwrap_or(0.0), number(code + 10).unwrap_or(0.0));
        let leans = point(16).abs().max_element() > LEANING_MAX || number(36).is_some_and(|z| z <= 0.0);
        if is_off || leans || int(69) == Some(SHEET) {
            return false;
        }
        let (Some(height), Some([lo, hi])) = (number(45).filter(|h| *h > 0.0), extent) else { return true };
        let wide = number(40).zip(number(41)).map_or(1.0, |(width, height)| width / height);
        let reach = DVec2::new(wide, 1.0).length() * height / 2.0;
        let twist = DVec2::from_angle(-number(51).unwrap_or(0.0).to_radians());
        let centre = point(17) + twist.rotate(point(12));
        let off = centre.distance(centre.clamp(lo, hi));
        // What cannot be told counts as shown.
        off.is_nan() || reach.is_nan() || off <= reach
    }

    /// Layers frozen in a viewport: by their handles, in old files by their names.
    fn frozen_in(&self, viewport: usize) -> BTreeSet<u32> {
        let own = own_pairs(self.tokens, viewport).filter(|(_, p)| matches!(p.code, 331 | 341));
        let handles: BTreeSet<String> =
            own.map(|(_, p)| String::from_utf8_lossy(self.tokens.value(p)).to_ascii_uppercase()).collect();
        let names = self.tokens.record(viewport).iter().filter(|p| p.code == 1003);
        let names: BTreeSet<String> =
            names.map(|p| self.page.decode(self.tokens.value(p)).to_uppercase()).collect();
        let mut out = BTreeSet::new();
        if handles.is_empty() && names.is_empty() {
            return out;
        }
        for record in self.tokens.section(b"TABLES").into_iter().flatten() {
            let Some(name) = Fields::of(self.tokens, record).value(2) else { continue };
            if self.tokens.name(record) != b"LAYER" {
                continue;
            }
            let name = self.page.decode(name).to_uppercase();
            let is_frozen = handle_of(self.tokens, record).is_some_and(|h| handles.contains(&h));
            if is_frozen || names.contains(&name) {
                out.extend(self.layers.of_name(&name));
            }
        }
        out
    }

    /// Layers named after walls that show something anywhere.
    fn layers_of_walls(&self) -> BTreeSet<u32> {
        let sections = [&b"BLOCKS"[..], b"ENTITIES"].into_iter().filter_map(|name| self.tokens.section(name));
        let used = sections.flatten().filter_map(|r| Fields::of(self.tokens, r).value(8));
        let used: BTreeSet<&[u8]> = used.collect();
        let all =
            used.into_iter().filter_map(|name| self.layers.of_name(&self.page.decode(name).to_uppercase()));
        let is_wall = |layer: &u32| {
            let layer = &self.layers.list[*layer as usize];
            !layer.is_off && !layer.is_frozen && role_by_name(&layer.name).0.stops_sight()
        };
        all.filter(is_wall).collect()
    }
}
