//! Heat maps and diagrams.

use enfilade_overlay::palette::{Palette, Scale};
use enfilade_overlay::picture::{PlanPicture, StrokeKind};
use enfilade_overlay::{
    Cell, HeatMap, Panel, Series, check_png, convergence_png, diversity_png, heat_map_png, resolution_png,
};

use super::plans::{self, look, pixels};

fn heat<'a>(picture: &'a PlanPicture, cells: &'a [Cell], spacing_m: f64) -> HeatMap<'a> {
    HeatMap {
        picture,
        cells,
        spacing_m,
        scale: Scale::of(cells.iter().filter_map(|c| c.value)),
        title: "Visibility",
        subtitle: "plan.dxf · present layout · how much of the reference region each spot sees",
        unit: "cells seen",
        no_value: "not measured",
        palette: Palette::Viridis,
    }
}

#[test]
fn heat_maps_of_every_size_show_their_cells() {
    let cases = [
        ("hall-5", 5.0, 4.0, 100.0, 1600),
        ("hall-20", 20.0, 14.0, 1000.0, 1600),
        ("hall-500", 500.0, 400.0, 40_000.0, 1600),
        ("long", 300.0, 12.0, 4000.0, 1600),
        ("tall", 9.0, 120.0, 3000.0, 1600),
        ("small", 20.0, 14.0, 300.0, 320),
    ];
    for (name, wide, high, count, side) in cases {
        let picture = plans::hall(wide, high);
        let (cells, spacing_m) = plans::cells(wide, high, count);
        let map = heat(&picture, &cells, spacing_m);
        let png = heat_map_png(&map, side).unwrap();
        let (w, h, rgb) = pixels(&png);
        assert!(w.max(h) <= side as usize, "{name}: {w} x {h}");
        let best = cells.iter().filter_map(|c| c.value).fold(f64::MIN, f64::max);
        let colour = Palette::Viridis.at(map.scale.fraction(best));
        assert!(rgb.contains(&colour), "{name}: the highest cell is not visible");
        look(&format!("{name}.png"), &png);
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig { failure_persistence: None, ..proptest::prelude::ProptestConfig::with_cases(64) })]
    #[test]
    fn odd_plans_never_stop_the_program(
        points in proptest::collection::vec(proptest::array::uniform2(odd_number()), 0..12),
        bounds in proptest::array::uniform2(proptest::array::uniform2(odd_number())),
        value in odd_number(),
        spacing_m in odd_number(),
        closed: bool,
        filled: bool,
    ) {
        let kinds = [StrokeKind::Fixed, StrokeKind::Before, StrokeKind::Ignored];
        let strokes =
            kinds.map(|kind| enfilade_overlay::Stroke { points: points.clone(), closed, filled, kind });
        let picture = PlanPicture { strokes: strokes.to_vec(), bounds, ..PlanPicture::default() };
        let cells: Vec<Cell> = points.iter().map(|p| Cell { centre: *p, value: Some(value) }).collect();
        let drawn = heat_map_png(&heat(&picture, &cells, spacing_m), 160);
        let is_small = |v: &f64| v.abs() < 1e8;
        if bounds.iter().flatten().all(is_small) && points.iter().flatten().all(is_small) && is_small(&spacing_m) {
            proptest::prop_assert!(drawn.is_ok());
        }
        let _ = check_png(&picture, "odd", "", 160);
        let _ = enfilade_overlay::heat_additions("X", &cells, spacing_m, Scale::of([value]), Palette::Viridis);
    }
}

fn odd_number() -> impl proptest::strategy::Strategy<Value = f64> {
    proptest::prop_oneof![
        6 => -30.0..30.0f64,
        1 => -1e7..1e7f64,
        1 => proptest::sample::select(vec![f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300, -1e-300, 0.0]),
    ]
}

#[test]
fn one_cell_in_a_large_plan_is_visible() {
    let picture = plans::hall(500.0, 500.0);
    let cells = [Cell { centre: [400.0, 250.0], value: Some(1.0) }];
    let map = HeatMap { scale: Scale { lo: 0.0, hi: 1.0 }, ..heat(&picture, &cells, 0.1) };
    let (w, h, rgb) = pixels(&heat_map_png(&map, 800).unwrap());
    let plan = &rgb[..w * h * 4 / 5];
    assert!(plan.iter().filter(|p| **p == Palette::Viridis.at(1.0)).count() >= 4);
}

#[test]
fn layouts_of_the_same_bounds_lie_over_each_other() {
    let present = plans::hall(20.0, 14.0);
    let mut other = present.clone();
    other.strokes.retain(|s| !matches!(s.kind, StrokeKind::Moved | StrokeKind::Before));
    let (cells, spacing_m) = plans::cells(20.0, 14.0, 500.0);
    let valued: Vec<Cell> = cells.iter().map(|c| Cell { value: Some(1.0), ..*c }).collect();
    let a = pixels(&heat_map_png(&heat(&present, &cells, spacing_m), 800).unwrap());
    let b = pixels(&heat_map_png(&heat(&other, &valued, spacing_m), 800).unwrap());
    assert_eq!((a.0, a.1), (b.0, b.1));
}

#[test]
fn the_check_picture_names_what_is_there() {
    let picture = plans::hall(20.0, 14.0);
    let png = check_png(&picture, "hall.dxf", "DXF AC1032, metres ($INSUNITS 6)", 1600).unwrap();
    look("check.png", &png);
    let bare = PlanPicture { regions: Vec::new(), ..picture };
    assert_ne!(png, check_png(&bare, "hall.dxf", "DXF AC1032, metres ($INSUNITS 6)", 1600).unwrap());
}

#[test]
fn options_differ_in_the_diversity_picture() {
    let present = plans::hall(20.0, 14.0);
    let members: Vec<_> = (0..5)
        .map(|i| {
            let x = 12.0 + f64::from(i) * 0.9;
            vec![plans::stroke(&[[x, 3.0], [x + 0.4, 11.0]], StrokeKind::Moved)]
        })
        .collect();
    let labels: Vec<String> = (1..=5).map(|i| format!("Option {i}")).collect();
    let png = diversity_png(&present, &members, &labels, 1600).unwrap();
    look("diversity.png", &png);
    let (_, _, rgb) = pixels(&png);
    for i in 0..5 {
        let colour = enfilade_overlay::palette::option_style(i).0;
        assert!(rgb.iter().filter(|p| **p == colour).count() > 100, "option {i}");
    }
}

#[test]
fn convergence_is_drawn() {
    let rise = |top: f64| (0..100u64).map(|i| (i * 20, top * (1.0 - (-(i as f64) / 20.0).exp()))).collect();
    let series = [
        Series { name: "best score".to_owned(), points: rise(3.1) },
        Series { name: "worst member".to_owned(), points: rise(2.2) },
    ];
    let png = convergence_png(&series, 1600).unwrap();
    look("convergence.png", &png);
    assert!(pixels(&png).0 <= 1600);
    assert!(convergence_png(&[], 400).is_ok());
}

#[test]
fn reference_drawings_look_right() {
    let (Some((maze, maze_cells)), Some((building, cells))) =
        (plans::maze(), plans::building("Connectivity"))
    else {
        println!("skipped: no reference drawings on this machine");
        return;
    };
    look("maze.png", &heat_map_png(&heat(&maze, &maze_cells, 1.0), 1600).unwrap());
    look("maze-check.png", &check_png(&maze, "maze_a.dxf", "metres", 1600).unwrap());
    let map = heat(&building, &cells, 1.3333);
    look("building.png", &heat_map_png(&map, 1600).unwrap());
    let paper = HeatMap { palette: Palette::BlueToRed, ..map };
    look("building-paper.png", &heat_map_png(&paper, 1600).unwrap());
    let (_, entropy) = plans::building("Visual Entropy").unwrap();
    let map = HeatMap { title: "Evenness", unit: "bits", ..heat(&building, &entropy, 1.3333) };
    look("building-entropy.png", &heat_map_png(&map, 1600).unwrap());
}

#[test]
fn the_resolution_study_is_drawn() {
    let panel = |name: &str, top: f64| Panel {
        name: name.to_owned(),
        points: [0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8]
            .map(|s: f64| [s, top * (1.0 - 0.05 * s * s), 0.02 * top * s])
            .to_vec(),
        sampled: [0.25, 0.7, 2.8].map(|s: f64| [s, top * (0.9 - 0.04 * s * s), 0.02 * top * s]).to_vec(),
    };
    let legend = ["the drawing as it is", "mean of 10 layouts moved at random"].map(str::to_owned);
    let panels = [
        panel("Visibility (degree)", 120.0),
        panel("Accessibility (tree depth)", 4.0),
        panel("Evenness (entropy)", 2.4),
    ];
    let png = resolution_png(&panels, &legend, Some(0.7), 1600).unwrap();
    look("resolution.png", &png);
    assert_ne!(png, resolution_png(&panels, &legend, None, 1600).unwrap());
    assert_ne!(png, resolution_png(&panels, &legend[..1], Some(0.7), 1600).unwrap(), "no legend");
    let present = panels.clone().map(|p| Panel { sampled: Vec::new(), ..p });
    assert_ne!(png, resolution_png(&present, &legend, Some(0.7), 1600).unwrap(), "no line of the samples");
    let many = vec![panels[0].clone(); enfilade_overlay::chart::MAX_PANELS + 1];
    assert!(resolution_png(&many, &legend, None, 1600).is_err());
    assert!(resolution_png(&[], &legend, None, 1600).is_ok());
}
