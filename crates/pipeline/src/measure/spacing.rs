//! Which spacing the lattice gets when the user names none (spec 3): by a vertex budget, but never so
//! wide that a door is missed while the study stays small.

use i_overlay::core::fill_rule::FillRule;
use i_overlay::float::simplify::SimplifyShape;

use crate::understand::understood::Understood;
use enfilade_config::Settings;
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_engine::interior::Interior;
use enfilade_report::{Place, Report};

/// Vertices a study gets by default.
pub const VERTEX_BUDGET: f64 = 1_500.0;

/// Widest spacing that still finds the way through an ordinary door.
pub const DOOR_SPACING_M: f64 = 0.75;

/// Vertices up to which [`DOOR_SPACING_M`] is kept.
pub const VERTICES_FOR_DOORS: f64 = 12_000.0;

/// Spacings that are offered, finest first.
pub(crate) const SERIES_M: [f64; 20] = [
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

/// Says which spacing was chosen and how many of its cells are measured, of which walls that may move cover `blind`
/// now; nothing where the user named it.
pub fn state(
    base: &Understood,
    settings: &Settings,
    spacing_m: f64,
    [cells, blind]: [usize; 2],
    report: &mut Report,
) {
    if settings.spacing_m.is_some() {
        return;
    }
    // What query and reference share is measured once.
    let area_m2 = cells as f64 * spacing_m * spacing_m;
    let under = match blind {
        0 => String::new(),
        n => format!(", {n} of them now under walls that may move"),
    };
    let text = format!(
        "spacing {spacing_m} m: {cells} vertices are measured on {area_m2:.0} m²{under}; --spacing overrides it"
    );
    report.info("spacing", Place::file(&base.plan.file), text);
    if spacing_m > DOOR_SPACING_M {
        let text = format!(
            "a spacing of {spacing_m} m may miss doors narrower than that; a smaller --spacing takes longer"
        );
        report.info("spacing-coarse", Place::file(&base.plan.file), text);
    }
}

/// Points a side of the grid by which a drawn region is held against the interior.
const PROBES: i64 = 32;

/// Area by which a spacing is chosen, m²: the regions drawn (of the largest pair, where some are named), the
/// interior, or the drawing's box. Floor that lies in two regions counts once, as its vertices are measured once.
pub(crate) fn area_m2(base: &Understood) -> f64 {
    let markers = &base.plan.markers;
    let area = |regions: [&[Region]; 2]| {
        let all = || regions.iter().flat_map(|r| r.iter());
        match base.interior.as_ref().filter(|_| regions.iter().any(|r| r.is_empty())) {
            Some(interior) => {
                let beside = |r: &Region| region_m2(r) * share_outside(interior, r);
                interior.area_m2() + all().map(beside).sum::<f64>()
            }
            None => covered_m2(all()),
        }
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

/// Area that regions cover together, m².
fn covered_m2<'a>(regions: impl Iterator<Item = &'a Region>) -> f64 {
    let rings: Vec<Vec<PointUm>> = regions.map(Region::outline).filter(|r| r.len() >= 3).collect();
    let Some(origin) = rings.first().and_then(|r| r.first()).copied() else { return 0.0 };
    let metres = |p: &PointUm| [0, 1].map(|k| (p[k] - origin[k]) as f64 / UM_PER_M);
    // All turn the same way: else two of opposite ways would cancel where they overlap.
    let turned = |ring: &Vec<PointUm>| {
        let mut ring: Vec<[f64; 2]> = ring.iter().map(metres).collect();
        if signed_m2(&ring) < 0.0 {
            ring.reverse();
        }
        ring
    };
    let rings: Vec<Vec<[f64; 2]>> = rings.iter().map(turned).collect();
    let shapes = rings.simplify_shape_as::<i64>(FillRule::NonZero);
    shapes.iter().flatten().map(|ring| signed_m2(ring)).sum::<f64>().abs()
}

/// Share of a region that lies outside the building, by a grid of points over its box.
fn share_outside(interior: &Interior, region: &Region) -> f64 {
    let outline = region.outline();
    let Some(first) = outline.first().copied() else { return 0.0 };
    let (lo, hi) = outline.iter().fold((first, first), |(lo, hi), p| {
        ([lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])])
    });
    let at = |i: i64, k: usize| lo[k] + (hi[k] - lo[k]) / (2 * PROBES) * (2 * i + 1);
    let points = (0..PROBES).flat_map(|i| (0..PROBES).map(move |j| [at(i, 0), at(j, 1)]));
    let inside: Vec<PointUm> = points.filter(|p| region.contains(*p)).collect();
    let outside = inside.iter().filter(|p| !interior.contains(**p)).count();
    outside as f64 / inside.len().max(1) as f64
}

/// Area within a ring, positive where it turns left.
fn signed_m2(ring: &[[f64; 2]]) -> f64 {
    let Some(o) = ring.first() else { return 0.0 };
    let cross = |a: [f64; 2], b: [f64; 2]| (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
    (0..ring.len()).map(|i| cross(ring[i], ring[(i + 1) % ring.len()])).sum::<f64>() / 2.0
}

/// Area of a region, m².
pub fn region_m2(region: &Region) -> f64 {
    let ring: Vec<[f64; 2]> =
        region.outline().iter().map(|p| [0, 1].map(|k| p[k] as f64 / UM_PER_M)).collect();
    signed_m2(&ring).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rectangle([x, y]: [i64; 2], [w, h]: [i64; 2], is_left: bool) -> Region {
        let mut ring: Vec<PointUm> = vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        if !is_left {
            ring.reverse();
        }
        Region::Ring(ring.into_iter().map(|p| p.map(|v| v * 1_000_000)).collect())
    }

    #[test]
    fn what_regions_share_is_covered_once() {
        let [room, same, beside, across] = [
            rectangle([0, 0], [4, 3], true),
            rectangle([0, 0], [4, 3], false),
            rectangle([10, 0], [2, 2], true),
            rectangle([2, -1], [1, 10], false),
        ];
        let far = rectangle([69_000_000, -69_000_000], [4, 3], true);
        for (regions, m2) in [
            (vec![], 0.0),
            (vec![&room], 12.0),
            (vec![&room, &same], 12.0),
            (vec![&room, &beside], 16.0),
            (vec![&room, &same, &beside, &across], 23.0),
            (vec![&far], 12.0),
        ] {
            let found = covered_m2(regions.iter().copied());
            assert!((found - m2).abs() < 1e-3, "{found} {regions:?}");
        }
        assert_eq!(region_m2(&far), 12.0);
    }
}
