//! Which spacing the lattice gets when the user names none (spec 3): by a vertex budget, but never so
//! wide that a door is missed while the study stays small.

use super::study::Understood;
use crate::config::Settings;
use crate::plan::Region;
use crate::plan::geometry::{PointUm, UM_PER_M};
use crate::report::{Place, Report};

/// Vertices a study gets by default.
pub const VERTEX_BUDGET: f64 = 1_500.0;

/// Widest spacing that still finds the way through an ordinary door.
pub const DOOR_SPACING_M: f64 = 0.75;

/// Vertices up to which [`DOOR_SPACING_M`] is kept.
pub const VERTICES_FOR_DOORS: f64 = 12_000.0;

/// Spacings that are offered, finest first.
pub(super) const SERIES_M: [f64; 20] = [
    0.005, 0.01, 0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0,
    10.0,
];

/// Decides the spacing, metres.
pub fn choose_m(base: &Understood, settings: &Settings) -> f64 {
    if let Some(spacing_m) = settings.spacing_m {
        return spacing_m;
    }
    let area_m2 = area_m2(base);
    let fits = |s: &&f64, vertices: f64| area_m2 / (**s * **s) <= vertices;
    let by_budget =
        SERIES_M.iter().find(|s| fits(s, VERTEX_BUDGET)).copied().unwrap_or(SERIES_M[SERIES_M.len() - 1]);
    let by_doors = SERIES_M.iter().find(|s| fits(s, VERTICES_FOR_DOORS)).copied().unwrap_or(by_budget);
    let door_m = DOOR_SPACING_M * base.plan.human_scale * 1.001;
    let for_doors = SERIES_M.iter().rev().find(|s| **s <= door_m).copied().unwrap_or(SERIES_M[0]);
    by_budget.min(by_doors.max(for_doors))
}

/// Says which spacing was chosen and how many of its cells are measured; nothing where the user named it.
pub fn state(base: &Understood, settings: &Settings, spacing_m: f64, cells: usize, report: &mut Report) {
    if settings.spacing_m.is_some() {
        return;
    }
    // What query and reference share is measured once.
    let area_m2 = cells as f64 * spacing_m * spacing_m;
    let text = format!(
        "spacing {spacing_m} m: {cells} vertices are measured on {area_m2:.0} m²; --spacing overrides it"
    );
    report.info("spacing", Place::file(&base.plan.file), text);
    if spacing_m > DOOR_SPACING_M {
        let text = format!(
            "a spacing of {spacing_m} m may miss doors narrower than that; a smaller --spacing takes longer"
        );
        report.info("spacing-coarse", Place::file(&base.plan.file), text);
    }
}

/// Area by which a spacing is chosen, m²: the regions drawn (of the largest pair, where some are named), the
/// interior, or the drawing's box. Floor that lies in two regions counts twice.
pub(super) fn area_m2(base: &Understood) -> f64 {
    let markers = &base.plan.markers;
    let area = |regions: [&[Region]; 2]| {
        let drawn: f64 = regions.iter().flat_map(|r| r.iter()).map(region_m2).sum();
        let open = regions.iter().any(|r| r.is_empty());
        drawn + if open { base.interior.as_ref().map_or(0.0, |i| i.area_m2()) } else { 0.0 }
    };
    let named = markers.pairs.iter().map(|p| area(markers.regions_of(p)));
    let area = named.fold(area([&markers.query, &markers.reference]), f64::max);
    let whole = || {
        let points = base.plan.walls.iter().flat_map(|w| w.trace.points.iter().copied());
        let (lo, hi) = points.fold(([i64::MAX; 2], [i64::MIN; 2]), |(lo, hi), p| {
            ([lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])])
        });
        (hi[0] - lo[0]) as f64 / UM_PER_M * ((hi[1] - lo[1]) as f64 / UM_PER_M)
    };
    if area > 0.0 { area } else { whole() }
}

/// Area of a region.
pub fn region_m2(region: &Region) -> f64 {
    let ring: Vec<PointUm> = region.outline();
    let m = |v: i64| v as f64 / UM_PER_M;
    let o = ring.first().copied().unwrap_or_default();
    let cross = |a: PointUm, b: PointUm| m(a[0] - o[0]) * m(b[1] - o[1]) - m(b[0] - o[0]) * m(a[1] - o[1]);
    (0..ring.len()).map(|i| cross(ring[i], ring[(i + 1) % ring.len()])).sum::<f64>().abs() / 2.0
}
