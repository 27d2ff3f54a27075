//! Features of drawn pieces with the classes that labels give them, for `scripts/reading/train.py`.
//!
//! `reading_features names` prints the names of the features. `reading_features LIST OUT` reads lines of
//! `DRAWING<tab>LABELS<tab>AUTHOR/NAME`; LABELS is JSON: `{"unit_m": 0.001, "labels": {HANDLE: CLASS}}`.

use std::error::Error;
use std::fs;

use enfilade_cad::dxf::{self, ReadOptions};
use enfilade_plan::reading::training::{feature_names, samples};
use enfilade_report::Report;

/// Place of a label among the classes of the trainer; 255 for what is not known.
fn class(label: &str) -> u8 {
    match label {
        "wall" | "column" => 0,
        "window" => 1,
        "door" => 2,
        "stair" => 3,
        "furniture" | "sanitary" | "railing" => 4,
        "annotation" | "dimension" | "hatch" | "grid" | "title" => 5,
        "outside" | "other" => 6,
        _ => 255,
    }
}

/// One drawing as the trainer reads it: name, counts, features, classes, lengths, entities, layers; little-endian.
fn dump(line: &str) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut words = line.split('\t');
    let mut word = || words.next().ok_or("expected a drawing, its labels and a name, with tabs between them");
    let (drawing, labels, name) = (word()?, word()?, word()?);
    let labels: serde_json::Value = serde_json::from_slice(&fs::read(labels)?)?;
    let metres = labels["unit_m"].as_f64().ok_or("unit_m, expected a number")?;
    let read = dxf::read(drawing, &fs::read(drawing)?, &ReadOptions::default(), &mut Report::default());
    let drawing = read.map_err(|e| e.to_string())?;
    let pieces = samples(&drawing, metres);
    let class_of = |entity: u32| {
        let handle = drawing.entities[entity as usize].origin.handle.as_ref();
        let label = handle.and_then(|h| labels["labels"].get(h)?.as_str());
        label.map_or(255, class)
    };
    let mut out = Vec::new();
    let count = |n: usize| u32::try_from(n).map(u32::to_le_bytes);
    out.extend(count(name.len())?);
    out.extend(name.as_bytes());
    out.extend(count(pieces.len())?);
    out.extend(count(feature_names().len())?);
    out.extend(pieces.iter().flat_map(|p| &p.features).flat_map(|v| v.to_le_bytes()));
    out.extend(pieces.iter().map(|p| class_of(p.entity)));
    out.extend(pieces.iter().flat_map(|p| p.length_m.to_le_bytes()));
    out.extend(pieces.iter().flat_map(|p| p.entity.to_le_bytes()));
    out.extend(pieces.iter().flat_map(|p| p.layer.to_le_bytes()));
    Ok(out)
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match &args[..] {
        [names] if names == "names" => println!("{}", feature_names().join("\n")),
        [list, to] => {
            let mut out = Vec::new();
            for line in fs::read_to_string(list)?.lines() {
                match dump(line) {
                    Ok(bytes) => out.extend(bytes),
                    Err(e) => eprintln!("{line}: {e}; left out"),
                }
            }
            fs::write(to, out)?;
        }
        _ => return Err("usage: reading_features names | reading_features LIST OUT".into()),
    }
    Ok(())
}
