//! What is said where nothing is a wall.

use std::collections::BTreeMap;

use crate::{LayerUse, choice};
use enfilade_cad::drawing::Drawing;
use enfilade_cad::own_layers;
use enfilade_report::{Error, Place, Problem, Report};

/// Problems of readers by which whole blocks are left out.
const BLOCKS_LEFT_OUT: [&str; 4] =
    ["dxf-block-cycle", "dxf-block-depth", "dxf-expansion-budget", "dxf-external-reference"];

/// Most of them that a refusal names.
const LEFT_OUT_TOLD: usize = 3;

/// What is said of an entity with coordinates that no plan can have.
const TOO_FAR: &str = "dxf-bad-coordinate";

/// The refusal: what is on which layer, and what would help.
pub(super) fn no_walls(drawing: &Drawing, chosen: &choice::Chosen, report: &Report) -> Error {
    let layers = &chosen.layers;
    let mut by_size: Vec<&LayerUse> =
        layers.iter().filter(|l| l.role != "own" && l.role != "marker").collect();
    by_size.sort_by_key(|l| std::cmp::Reverse(l.entities));
    let shown: Vec<String> =
        by_size.iter().take(LISTED_MAX).map(|l| format!("{} ({})", l.name, l.entities)).collect();
    let more = by_size.len().saturating_sub(LISTED_MAX);
    let mut list = if shown.is_empty() { "none".to_string() } else { shown.join(", ") };
    if more > 0 {
        list.push_str(&format!(" and {more} more"));
    }
    let hidden: Vec<&str> = layers.iter().filter(|l| l.role == "hidden").map(|l| l.name.as_str()).collect();
    let hint =
        if hidden.is_empty() { String::new() } else { format!(" (off or frozen: {})", hidden.join(", ")) };
    let remedy = match hidden[..] {
        [] => "name the layer of the walls with --wall-layer NAME",
        _ => {
            "switch what is off on and thaw what is frozen in the drawing, or name another layer with --wall-layer NAME"
        }
    };
    let (others, help) = undrawn_words(drawing);
    let mut left_out: Vec<&Problem> =
        report.problems.iter().filter(|p| BLOCKS_LEFT_OUT.contains(&p.code)).collect();
    left_out.dedup_by_key(|p| &p.text);
    let mut far = report.problems.iter().filter(|p| p.code == TOO_FAR);
    if let (true, Some(first)) = (left_out.is_empty(), far.next()) {
        let others = if far.next().is_some() { ", and so are others" } else { "" };
        let text = format!(
            "{}{others}; nothing was measured, since no other walls were found; move the drawing near its zero point",
            first.text
        );
        return Error::input("no-walls", first.place.clone(), text);
    }
    let told: Vec<&str> = left_out.iter().take(LEFT_OUT_TOLD).map(|p| p.text.as_str()).collect();
    let why = match told.len() {
        0 => String::new(),
        1 => format!("{}; besides it ", told[0]),
        _ => format!("{}; besides them ", told.join("; ")),
    };
    let place = left_out.first().map_or_else(|| Place::file(&drawing.file), |p| p.place.clone());
    let longer = if chosen.walls.is_empty() { "" } else { "longer than a millimetre " };
    let text = format!(
        "{why}no entity {longer}on a wall layer{hint}, layers present: {list}{others}; nothing was measured; {help}{remedy}"
    );
    Error::input("no-walls", place, text)
}

/// What is drawn and gives no lines of walls, by layer and kind, and what to do about it; empty where there is nothing.
fn undrawn_words(drawing: &Drawing) -> (String, String) {
    let mut counts: BTreeMap<(bool, &str, &str), usize> = BTreeMap::new();
    for u in &drawing.undrawn {
        *counts.entry((u.is_on_paper, &u.layer, &u.kind)).or_default() += u.count;
    }
    for fill in drawing.fills.iter().filter(|f| !own_layers::is_own(&f.layer)) {
        *counts.entry((false, &fill.layer, &fill.source.kind)).or_default() += 1;
    }
    let (mut words, mut help) = (String::new(), String::new());
    let told = [
        (false, "not lines", "explode filled areas, multilines and faces, or draw their outlines as lines; "),
        (true, "on a sheet of paper", "copy what is drawn on a sheet of paper to model space; "),
    ];
    for (on_paper, what, todo) in told {
        let of = counts.iter().filter(|((p, ..), _)| *p == on_paper);
        let list: Vec<String> = of.map(|((_, layer, kind), n)| format!("{n} {kind} on {layer}")).collect();
        if list.is_empty() {
            continue;
        }
        let more = list.len().saturating_sub(LISTED_MAX);
        words += &format!("; {what}: {}", list[..list.len() - more].join(", "));
        if more > 0 {
            words += &format!(" and {more} more kinds");
        }
        help += todo;
    }
    (words, help)
}

/// Most layers, or kinds on them, that are listed where no walls are found.
const LISTED_MAX: usize = 12;
