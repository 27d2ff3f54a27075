//! Decided works that settings name, as marks of the drawing.

use glam::DVec2;

use enfilade_cad::drawing::{Drawing, Editable, Entity, Shape, SourceRef, Text, Vertex};
use enfilade_cad::own_layers::{NEW, OPEN, REMOVE};
use enfilade_config::{Settings, WorkTable};
use enfilade_report::{Error, Place};

/// Adds them behind all that is drawn, so that indices of entities stay.
///
/// # Errors
/// [`Error::Usage`] for a kind that there is not, and an outline of too few points.
pub(crate) fn add(drawing: &mut Drawing, settings: &Settings) -> Result<(), Error> {
    let last = drawing.entities.iter().map(|e| e.source.record).max().unwrap_or(0);
    for (k, table) in settings.works.iter().enumerate() {
        let (layer, is_closed) = shown(table)?;
        let source = SourceRef {
            record: last + 1 + k,
            handle: None,
            line: 0,
            kind: "[[work]]".into(),
            layer: layer.into(),
        };
        let points: Vec<DVec2> = table.points.iter().map(|p| DVec2::from(*p)).collect();
        if let Some(text) = &table.text {
            let at = points.iter().sum::<DVec2>() / points.len() as f64;
            drawing.texts.push(Text { source: source.clone(), layer: layer.into(), at, text: text.clone() });
        }
        let vertices = points.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect();
        drawing.entities.push(Entity {
            source,
            layer: layer.into(),
            shape: Shape::Polyline { vertices, closed: is_closed },
            editable: Editable::No("the settings name it".into()),
            blocks: Vec::new(),
            origin: Default::default(),
        });
    }
    Ok(())
}

/// The layer on which a work would be drawn, and whether as an outline.
fn shown(table: &WorkTable) -> Result<(&'static str, bool), Error> {
    let wrong =
        |text: String| Error::usage("work", Place::default(), format!("[[work]] {text}; nothing was done"));
    let layer = match table.kind.as_str() {
        "open" => OPEN,
        "remove" => REMOVE,
        "new" => NEW,
        other => return Err(wrong(format!("kind {other:?}: expected open, remove or new"))),
    };
    let count = table.points.len();
    let least = if layer == NEW { 2 } else { 3 };
    match count < least {
        true => Err(wrong(format!("{}: found {count} points, expected at least {least}", table.kind))),
        false => Ok((layer, layer != NEW || count > 2)),
    }
}
