//! Small pictures compared pixel by pixel with the ones kept beside the tests.
//!
//! `ENFILADE_BLESS=1` writes them anew; look at them before they are committed.

use std::path::PathBuf;

use enfilade_overlay::palette::{Palette, Scale};
use enfilade_overlay::picture::StrokeKind;
use enfilade_overlay::{
    HeatMap, Panel, Series, check_png, convergence_png, diversity_png, heat_map_png, resolution_png,
};

use super::plans::{self, pixels};

const SIDE_PX: u32 = 320;

fn compare(name: &str, png: &[u8]) {
    let path = enfilade_fixtures::repository("crates/overlay/tests/golden").join(name);
    if std::env::var_os("ENFILADE_BLESS").is_some() {
        std::fs::write(&path, png).unwrap();
    }
    let (kept, drawn) = (pixels(&std::fs::read(&path).unwrap()), pixels(png));
    assert_eq!((kept.0, kept.1), (drawn.0, drawn.1), "{name}: size");
    let differ = kept.2.iter().zip(&drawn.2).filter(|(a, b)| a != b).count();
    if differ > 0 {
        let now = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&now, png).unwrap();
        panic!("{name}: {differ} pixels differ; drawn now: {}", now.display());
    }
}

#[test]
fn a_heat_map() {
    let picture = plans::hall(12.0, 8.0);
    let (cells, spacing_m) = plans::cells(12.0, 8.0, 150.0);
    let map = HeatMap {
        picture: &picture,
        cells: &cells,
        spacing_m,
        scale: Scale { lo: 0.0, hi: 80.0 },
        title: "Visibility",
        subtitle: "hall.dxf · option 1",
        unit: "cells seen",
        no_value: "not measured",
        palette: Palette::Viridis,
    };
    compare("heat-map.png", &heat_map_png(&map, SIDE_PX).unwrap());
    let paper = HeatMap { palette: Palette::BlueToRed, ..map };
    compare("heat-map-paper.png", &heat_map_png(&paper, SIDE_PX).unwrap());
}

#[test]
fn what_was_understood() {
    compare("check.png", &check_png(&plans::hall(12.0, 8.0), "hall.dxf", "metres", SIDE_PX).unwrap());
}

#[test]
fn options_superimposed() {
    let at = |x: f64| vec![plans::stroke(&[[x, 1.0], [x + 0.5, 7.0]], StrokeKind::Moved)];
    let members = [at(6.5), at(7.5), at(8.5)];
    let labels = ["Option 1", "Option 2", "Option 3"].map(str::to_owned);
    let png = diversity_png(&plans::hall(12.0, 8.0), &members, &labels, SIDE_PX).unwrap();
    compare("diversity.png", &png);
}

#[test]
fn charts() {
    let points = (0..20).map(|i| (i * 10, (i as f64).sqrt())).collect();
    let series = [Series { name: "best score".to_owned(), points }];
    compare("convergence.png", &convergence_png(&series, SIDE_PX).unwrap());
    let sampled = vec![[0.5, 60.0, 1.0], [1.0, 58.0, 2.0], [2.0, 40.0, 6.0]];
    let points = vec![[0.5, 70.0, 0.0], [1.0, 69.0, 0.0], [2.0, 52.0, 0.0]];
    let panels = [Panel { name: "Visibility (degree)".to_owned(), points, sampled }];
    let legend = ["as it is", "sampled"].map(str::to_owned);
    compare("resolution.png", &resolution_png(&panels, &legend, Some(1.0), SIDE_PX).unwrap());
}
