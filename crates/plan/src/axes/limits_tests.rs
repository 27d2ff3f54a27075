//! Every limit of [`crate::sizes`] from both sides.

use super::tests::{lines, mark};
use super::*;
use crate::sizes::{
    CHORD_MAX_M, CHORD_TURN_MAX_RAD, COLUMN_ASPECT_MAX, COLUMN_MAX_M, FINISH_MAX_M, LAYER_MAX_M,
    LAYERED_MAX_M, OPENING_MAX_M, PASSAGE_MAX_M, SAGITTA_MAX_M, SIDE_OPENING_MAX_M, THICKNESS_MAX_M,
};

fn thickest(all: &[[f64; 4]]) -> f64 {
    thickest_of(&lines(all))
}

fn thickest_of(drawn: &Drawn) -> f64 {
    AxisGraph::new(drawn).edges.iter().map(|e| e.thickness_m).fold(0.0, f64::max)
}

/// Parallel lines 6 m long at these heights.
fn stack(heights: &[f64]) -> Vec<[f64; 4]> {
    heights.iter().map(|y| [0.0, *y, 6.0, *y]).collect()
}

/// A wall drawn as a closed box, with a line beside it.
fn closed_beside(wall: f64, layer: f64) -> Drawn {
    let line = [0.0, wall + layer, 6.0, wall + layer];
    let mut drawn = lines(&[
        [0.0, 0.0, 6.0, 0.0],
        [6.0, 0.0, 6.0, wall],
        [6.0, wall, 0.0, wall],
        [0.0, wall, 0.0, 0.0],
        line,
    ]);
    for (part, f) in drawn.faces[..4].iter_mut().enumerate() {
        (f.wall, f.part, f.is_closed) = (0, part as u32, true);
    }
    drawn
}

fn is(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

#[test]
fn thickness_and_layers() {
    assert!(is(thickest(&stack(&[0.0, THICKNESS_MAX_M - 0.01])), THICKNESS_MAX_M - 0.01));
    assert!(is(thickest(&stack(&[0.0, THICKNESS_MAX_M + 0.01])), 0.0));
    assert!(is(thickest(&stack(&[0.0, 0.05, 0.05 + FINISH_MAX_M - 0.002])), 0.05 + FINISH_MAX_M - 0.002));
    assert!(is(thickest(&stack(&[0.0, 0.05, 0.05 + FINISH_MAX_M + 0.02])), 0.05));
    // The thinner cell is the wall, the other its layer: up to a thickness of its own and one of both.
    let both = |wall: f64, layer: f64| thickest(&stack(&[0.0, wall, wall + layer]));
    assert!(is(both(0.12, 0.121), 0.12) && 0.121 < LAYER_MAX_M);
    let shut = |wall: f64, layer: f64| thickest_of(&closed_beside(wall, layer));
    assert!(is(shut(0.4, LAYER_MAX_M - 0.01), 0.4 + LAYER_MAX_M - 0.01));
    assert!(is(shut(0.4, LAYER_MAX_M + 0.01), 0.4));
    assert!(is(shut(LAYERED_MAX_M - 0.14, 0.13), LAYERED_MAX_M - 0.01));
    assert!(is(shut(LAYERED_MAX_M - 0.12, 0.13), LAYERED_MAX_M - 0.12));
}

/// Width of the only opening, 0 for none.
fn opening(all: &[[f64; 4]], marks: Vec<Mark>) -> f64 {
    let graph = AxisGraph::new(&Drawn { marks, ..lines(all) });
    graph.openings.first().map_or(0.0, |o| o.width_m)
}

fn gap(width: f64) -> Vec<[f64; 4]> {
    [[-6.0, 0.0], [width, width + 6.0]]
        .iter()
        .flat_map(|x| [[x[0], 0.0, x[1], 0.0], [x[0], 0.2, x[1], 0.2]])
        .collect()
}

#[test]
fn widths_of_openings() {
    assert!(is(opening(&gap(PASSAGE_MAX_M - 0.1), vec![]), PASSAGE_MAX_M - 0.1));
    assert!(is(opening(&gap(PASSAGE_MAX_M + 0.1), vec![]), 0.0));
    for (width, found) in [(OPENING_MAX_M - 0.1, OPENING_MAX_M - 0.1), (OPENING_MAX_M + 0.1, 0.0)] {
        let pane = Path::Line { a: DVec2::new(0.0, 0.1), b: DVec2::new(width, 0.1) };
        assert!(is(opening(&gap(width), vec![mark(pane, Role::Window)]), found), "{width}");
    }
    // A wall that is joined at its other end, in front of another's side.
    let beside = |w: f64| {
        opening(
            &[
                [-3.0, 0.0, 3.0, 0.0],
                [-3.0, 0.2, 3.0, 0.2],
                [0.0, 0.2 + w, 0.0, 4.0],
                [0.1, 0.2 + w, 0.1, 4.0],
                [-3.0, 4.0, 3.0, 4.0],
                [-3.0, 4.2, 3.0, 4.2],
            ],
            vec![],
        )
    };
    assert!(is(beside(SIDE_OPENING_MAX_M - 0.1), SIDE_OPENING_MAX_M - 0.1));
    assert!(is(beside(SIDE_OPENING_MAX_M + 0.1), 0.0));
}

#[test]
fn sizes_of_columns() {
    let is_column = |w: f64, h: f64| {
        let mut drawn = lines(&[[0.0, 0.0, w, 0.0], [w, 0.0, w, h], [w, h, 0.0, h], [0.0, h, 0.0, 0.0]]);
        for (part, f) in drawn.faces.iter_mut().enumerate() {
            (f.wall, f.part, f.is_closed) = (0, part as u32, true);
        }
        AxisGraph::new(&drawn).nodes.iter().any(|n| matches!(n.kind, NodeKind::Column(_)))
    };
    assert!(is_column(COLUMN_MAX_M - 0.01, COLUMN_MAX_M - 0.01));
    assert!(!is_column(COLUMN_MAX_M + 0.01, COLUMN_MAX_M + 0.01));
    assert!(is_column(0.5, 0.5 * (COLUMN_ASPECT_MAX - 0.05)));
    assert!(!is_column(0.5, 0.5 * (COLUMN_ASPECT_MAX + 0.05)));
}

#[test]
fn coarseness_of_traced_curves() {
    let is_arc = |radius: f64, step: f64| {
        let at = |k: u32| DVec2::from_angle(step * f64::from(k)) * radius;
        let chords: Vec<[f64; 4]> = (0..6).map(|k| [at(k).x, at(k).y, at(k + 1).x, at(k + 1).y]).collect();
        AxisGraph::new(&lines(&chords)).edges.iter().all(|e| e.bulge != 0.0)
    };
    let step_of = |chord: f64, radius: f64| 2.0 * (chord / 2.0 / radius).asin();
    assert!(is_arc(60.0, step_of(CHORD_MAX_M - 0.05, 60.0)));
    assert!(!is_arc(60.0, step_of(CHORD_MAX_M + 0.05, 60.0)));
    assert!(is_arc(0.3, CHORD_TURN_MAX_RAD - 0.01));
    assert!(!is_arc(0.3, CHORD_TURN_MAX_RAD + 0.02));
    let sagitta = |s: f64| 2.0 * (1.0 - s / 2.0).acos();
    assert!(is_arc(2.0, sagitta(SAGITTA_MAX_M - 0.003)));
    assert!(!is_arc(2.0, sagitta(SAGITTA_MAX_M + 0.003)));
}
