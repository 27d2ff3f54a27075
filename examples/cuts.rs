//! The cuts of a building as JSON, metres: `cargo run --release --example cuts -- FILE [STOREY]`. What
//! `scripts/compare-cuts` holds against IfcOpenShell's geometry.

use enfilade_cad::ReadOptions;
use enfilade_cad::drawing::Shape;
use enfilade_report::Report;
use serde_json::json;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let file = args.next().ok_or("expected a file")?;
    let bytes = std::fs::read(&file)?;
    let base = ReadOptions::default();
    let all = enfilade_cad::storeys(&file, &bytes, &base);
    let wanted: Vec<Option<String>> = match args.next() {
        Some(name) => vec![Some(name)],
        None if all.is_empty() => vec![None],
        None => all.iter().map(|s| Some(s.name.clone())).collect(),
    };
    let mut storeys = Vec::new();
    for name in wanted {
        let mut report = Report::default();
        let options = ReadOptions { storey: name.clone(), ..base.clone() };
        let floor_m = all.iter().find(|s| Some(&s.name) == name.as_ref()).map(|s| s.floor_m);
        let drawing = match enfilade_cad::read(&file, &bytes, &options, &mut report) {
            Ok(drawing) => drawing,
            // A storey without walls at its cut shows none.
            Err(e) if e.problem().is_some_and(|p| p.code == "no-walls") => {
                let nothing: [u8; 0] = [];
                storeys.push(
                    json!({"name": name, "floor_m": floor_m, "cuts": nothing, "refused": e.to_string()}),
                );
                continue;
            }
            Err(e) => return Err(e.into()),
        };
        let metres = drawing.declared_unit.map_or(1.0, |u| u.metres);
        let ring = |shape: &Shape| match shape {
            Shape::Polyline { vertices, .. } => {
                vertices.iter().map(|v| (v.at * metres).to_array()).collect::<Vec<_>>()
            }
            _ => Vec::new(),
        };
        let cuts: Vec<_> = drawing
            .entities
            .iter()
            .map(|e| json!({"global_id": e.source.handle, "layer": e.layer, "ring": ring(&e.shape)}))
            .collect();
        let problems: Vec<String> = report.problems.iter().map(ToString::to_string).collect();
        storeys.push(json!({"name": name, "floor_m": floor_m, "cuts": cuts, "problems": problems}));
    }
    println!("{}", json!({"storeys": storeys}));
    Ok(())
}
