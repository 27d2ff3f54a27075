//! What is understood of small plans. Whole plans in the styles of offices: `tests/understanding.rs`.

use super::*;

/// Lines of a wall each.
fn lines(all: &[[f64; 4]]) -> Drawn {
    let face = |(i, l): (usize, &[f64; 4])| Face {
        wall: i as u32,
        part: 0,
        path: Path::Line { a: DVec2::new(l[0], l[1]), b: DVec2::new(l[2], l[3]) },
        role: Role::Wall,
        is_closed: false,
    };
    Drawn { faces: all.iter().enumerate().map(face).collect(), marks: Vec::new() }
}

fn at(graph: &AxisGraph, x: f64, y: f64) -> &Node {
    let p = DVec2::new(x, y);
    graph
        .nodes
        .iter()
        .find(|n| n.at.distance(p) < 1e-6)
        .unwrap_or_else(|| panic!("no node at {p}: {graph:#?}"))
}

#[test]
fn a_corner_of_two_faces() {
    let graph = AxisGraph::new(&lines(&[
        [0.0, 0.0, 5.0, 0.0],
        [0.2, 0.2, 5.0, 0.2],
        [0.0, 0.0, 0.0, 4.0],
        [0.2, 0.2, 0.2, 4.0],
        [5.0, 0.0, 5.0, 0.2],
        [0.0, 4.0, 0.2, 4.0],
    ]));
    assert_eq!(at(&graph, 0.1, 0.1).kind, NodeKind::Corner);
    assert_eq!(at(&graph, 5.0, 0.1).faces, [(4, 0)]);
    assert_eq!((graph.nodes.len(), graph.edges.len(), graph.openings.len()), (3, 2, 0));
    assert!(graph.edges.iter().all(|e| (e.thickness_m - 0.2).abs() < 1e-9));
    assert_eq!(graph.leftovers, []);
}

#[test]
fn a_tee_whose_stem_interrupts_one_face() {
    let graph = AxisGraph::new(&lines(&[
        [0.0, 0.0, 6.0, 0.0],
        [0.0, 0.3, 2.0, 0.3],
        [2.1, 0.3, 6.0, 0.3],
        [2.0, 0.3, 2.0, 3.0],
        [2.1, 0.3, 2.1, 3.0],
    ]));
    assert_eq!(at(&graph, 2.05, 0.15).kind, NodeKind::Tee);
    assert_eq!((graph.nodes.len(), graph.edges.len()), (4, 3));
}

#[test]
fn a_gap_of_a_hand_is_closed_and_a_passage_stays() {
    let faces = |gap: f64| {
        [[0.0, 0.0, 3.0, 0.0], [0.0, 0.1, 3.0, 0.1], [3.0 + gap, 0.0, 6.0, 0.0], [3.0 + gap, 0.1, 6.0, 0.1]]
    };
    let slip = AxisGraph::new(&lines(&faces(0.015)));
    assert_eq!((slip.edges.len(), slip.openings.len(), slip.closures.len()), (1, 0, 2));
    let passage = AxisGraph::new(&lines(&faces(0.9)));
    assert_eq!((passage.edges.len(), passage.openings.len()), (2, 1));
    assert_eq!(passage.openings[0].kind, OpeningKind::Passage);
    assert!((passage.openings[0].width_m - 0.9).abs() < 1e-9);
}

#[test]
fn nothing_drawn_gives_nothing() {
    let graph = AxisGraph::new(&Drawn::default());
    assert_eq!((graph.nodes.len(), graph.edges.len()), (0, 0));
}
