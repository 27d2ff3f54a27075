//! The tables of `analyse` as GeoJSON: cells as squares, sight lines as lines, in the drawing's own coordinates.
//!
//! No drawing's coordinate reference system is known, so none is written; a GIS asks for it or takes that of its
//! project. Numbers are those of the CSV, digit for digit; what has no value there is `null`.

use std::collections::HashMap;
use std::fmt::Write;

use crate::measure::cells::{Cells, cells_csv, edges_csv, references};
use crate::measure::study::Study;
use enfilade_engine::geometry::UM_PER_M;

/// [`cells_csv`] with every cell as a square of the spacing.
pub fn cells_geojson(study: &Study, cells: &Cells) -> String {
    let half = study.lattice.spacing_um as f64 / UM_PER_M / study.base.plan.frame.metres_per_unit / 2.0;
    let square = |row: &[&str]| {
        let [x, y] = [1, 2].map(|k: usize| row.get(k).and_then(|v| v.parse().ok()).unwrap_or(0.0));
        let corner = |[right, up]: [f64; 2]| format!("[{},{}]", x + right * half, y + up * half);
        let ring = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]].map(corner);
        format!(r#"{{"type":"Polygon","coordinates":[[{}]]}}"#, ring.join(","))
    };
    collection(study, &cells_csv(study, cells), square)
}

/// [`edges_csv`] with every pair as a line between its centres.
pub fn edges_geojson(study: &Study) -> String {
    let frame = &study.base.plan.frame;
    let centre = |v: usize| frame.file_from_um(study.lattice.centre_um(v));
    let place = |(v, reference): (usize, i64)| (reference.to_string(), centre(v));
    let places: HashMap<String, glam::DVec2> = references(study).into_iter().enumerate().map(place).collect();
    let line = |row: &[&str]| {
        let ends = row.iter().filter_map(|name| places.get(*name)).map(|p| format!("[{},{}]", p.x, p.y));
        format!(r#"{{"type":"LineString","coordinates":[{}]}}"#, ends.collect::<Vec<_>>().join(","))
    };
    collection(study, &edges_csv(study), line)
}

/// A table as features; names of columns and values have no comma, quote or backslash.
fn collection(study: &Study, csv: &str, shape: impl Fn(&[&str]) -> String) -> String {
    let mut lines = csv.lines();
    let names: Vec<&str> = lines.next().unwrap_or("").split(',').collect();
    let spacing_m = study.lattice.spacing_um as f64 / UM_PER_M;
    let unit_m = study.base.plan.frame.metres_per_unit;
    let mut out = format!(
        r#"{{"type":"FeatureCollection","spacing_m":{spacing_m},"metres_per_unit":{unit_m},"features":["#
    );
    for (i, line) in lines.enumerate() {
        let row: Vec<&str> = line.split(',').collect();
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(out, "{comma}\n{{\"type\":\"Feature\",\"geometry\":{},\"properties\":{{", shape(&row));
        for (k, (name, value)) in names.iter().zip(&row).enumerate() {
            let comma = if k == 0 { "" } else { "," };
            let value = if value.parse::<f64>().is_ok_and(f64::is_finite) { value } else { "null" };
            let _ = write!(out, r#"{comma}"{name}":{value}"#);
        }
        out.push_str("}}");
    }
    out.push_str("\n]}\n");
    out
}
