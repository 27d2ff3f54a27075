//! What shows an opening, and what only lies near one.

use super::tests::{lines, mark};
use super::*;

fn line([ax, ay, bx, by]: [f64; 4]) -> Path {
    Path::Line { a: DVec2::new(ax, ay), b: DVec2::new(bx, by) }
}

/// The four sides of a box.
fn sides([x, y, to_x, to_y]: [f64; 4]) -> [[f64; 4]; 4] {
    [[x, y, to_x, y], [to_x, y, to_x, to_y], [to_x, to_y, x, to_y], [x, to_y, x, y]]
}

/// Closed outlines of walls.
fn outlines(boxes: &[[f64; 4]]) -> Drawn {
    let mut out = Drawn::default();
    for (wall, corners) in boxes.iter().enumerate() {
        let of = sides(*corners).into_iter().enumerate();
        out.faces.extend(of.map(|(part, side)| Face {
            wall: wall as u32,
            part: part as u32,
            path: line(side),
            role: Role::Wall,
            is_closed: true,
            width_m: 0.0,
        }));
    }
    out
}

/// A mark of several lines.
fn of_lines(all: &[[f64; 4]], role: Role) -> Mark {
    Mark { paths: all.iter().copied().map(line).collect(), ..mark(line(all[0]), role) }
}

fn kinds(graph: &AxisGraph) -> Vec<(OpeningKind, f64)> {
    graph.openings.iter().map(|o| (o.kind, (o.width_m * 100.0).round())).collect()
}

/// Two windows with frames on either side of a short pier: the pier stays.
#[test]
fn the_frame_of_the_next_window_does_not_open_a_pier() {
    let mut drawn = outlines(&[[0.0, 0.0, 3.0, 0.3], [4.0, 0.0, 4.5, 0.3], [5.5, 0.0, 9.0, 0.3]]);
    for from in [3.0, 4.5] {
        drawn.marks.push(mark(line([from, 0.15, from + 1.0, 0.15]), Role::Window));
        for jamb in [from, from + 0.95] {
            drawn.marks.push(of_lines(&sides([jamb, 0.1, jamb + 0.05, 0.2]), Role::Window));
        }
    }
    let graph = AxisGraph::new(&drawn);
    assert_eq!(kinds(&graph), [(OpeningKind::Window, 100.0); 2]);
    assert_eq!(graph.edges.len(), 3);
}

/// The outline of a room runs just beside the face of a wall between two jambs; a pane runs between its faces.
#[test]
fn the_outline_of_a_room_is_no_pane() {
    for (beside, found) in [(0.015, 0), (-0.015, 1)] {
        let mut drawn = outlines(&[[0.0, 0.0, 4.0, 0.2]]);
        drawn.marks.push(mark(line([0.02, 0.2 + beside, 3.98, 0.2 + beside]), Role::Unknown));
        assert_eq!(
            AxisGraph::new(&drawn).openings.len() + 1 - AxisGraph::new(&drawn).edges.len(),
            found,
            "{beside}"
        );
    }
}

/// Boards on both faces of a wall are its finish; the same thickness by itself is a wall.
#[test]
fn a_finish_on_both_faces_is_no_wall() {
    let faces = [0.0, 0.05, 0.25, 0.3].map(|y| [0.0, y, 6.0, y]);
    let thick = |drawn: &Drawn| {
        let graph = AxisGraph::new(drawn);
        graph.edges.iter().map(|e| (e.thickness_m * 100.0).round()).collect::<Vec<_>>()
    };
    assert_eq!(thick(&lines(&faces)), [30.0]);
    assert_eq!(thick(&lines(&faces[..2])), [5.0]);
}

/// The steps of a reveal, and those of its finish, are no walls beside the window's jamb.
#[test]
fn steps_of_a_reveal_are_no_walls() {
    let end = |x: f64, out: f64| {
        let s = x + out * 0.02;
        let t = x + out * 0.03;
        vec![
            [x, 0.0, x, 0.1],
            [x, 0.1, s, 0.1],
            [s, 0.1, s, 0.2],
            [t, 0.02, t, 0.08],
            [t, 0.08, t + out * 0.02, 0.08],
            [t + out * 0.02, 0.08, t + out * 0.02, 0.14],
        ]
    };
    let mut all =
        vec![[0.0, 0.0, 2.0, 0.0], [0.0, 0.2, 1.98, 0.2], [3.0, 0.0, 6.0, 0.0], [3.02, 0.2, 6.0, 0.2]];
    all.extend(end(2.0, -1.0));
    all.extend(end(3.0, 1.0));
    let mut drawn = lines(&all);
    drawn.marks.push(mark(line([2.0, 0.05, 3.0, 0.05]), Role::Window));
    let graph = AxisGraph::new(&drawn);
    assert_eq!(graph.openings.iter().map(|o| o.kind).collect::<Vec<_>>(), [OpeningKind::Window]);
    assert!(graph.edges.iter().all(|e| (e.thickness_m - 0.2).abs() < 0.01), "{:?}", graph.edges);
}

/// The empty gap in the second leaf of a wall, behind a window in the first, is part of it.
#[test]
fn a_window_goes_through_both_leaves_of_a_wall() {
    let mut drawn =
        outlines(&[[0.0, 0.0, 2.0, 0.2], [0.0, 0.3, 2.0, 0.5], [3.0, 0.0, 6.0, 0.2], [3.0, 0.3, 6.0, 0.5]]);
    drawn.marks.push(mark(line([2.0, 0.1, 3.0, 0.1]), Role::Window));
    let graph = AxisGraph::new(&drawn);
    assert_eq!(kinds(&graph), [(OpeningKind::Window, 100.0); 2]);
    assert_eq!(graph.edges.len(), 4);
}

/// Two sashes between rooms are a sliding door, the same to the open air a window; so is glass over the whole width.
#[test]
fn sashes_between_rooms_are_a_sliding_door() {
    let sashes = [[2.0, 0.08, 3.1, 0.08], [2.9, 0.12, 4.0, 0.12]];
    let glass = [[2.0, 0.08, 4.0, 0.08], [2.0, 0.12, 4.0, 0.12]];
    let room = |sign: f64| {
        let y = [0.1 + sign * 0.1, 0.1 + sign * 3.1, 0.1 + sign * 3.3];
        vec![
            [0.0, y[0], 0.0, y[2]],
            [-0.2, y[0], -0.2, y[2]],
            [6.0, y[0], 6.0, y[2]],
            [6.2, y[0], 6.2, y[2]],
            [0.0, y[1], 6.0, y[1]],
            [-0.2, y[2], 6.2, y[2]],
        ]
    };
    let between = [[-0.2, 0.0, 2.0, 0.0], [-0.2, 0.2, 2.0, 0.2], [4.0, 0.0, 6.2, 0.0], [4.0, 0.2, 6.2, 0.2]];
    for (panes, both, expected) in [
        (sashes, true, OpeningKind::Door),
        (sashes, false, OpeningKind::Window),
        (glass, true, OpeningKind::Window),
    ] {
        let mut all = between.to_vec();
        all.extend(room(1.0));
        all.extend(room(-1.0).into_iter().filter(|_| both));
        let mut drawn = lines(&all);
        drawn.marks.extend(panes.map(|p| mark(line(p), Role::Window)));
        // A window of the outer walls, as thick as the inner one.
        let graph = AxisGraph::new(&drawn);
        let at = graph.openings.iter().find(|o| o.centre.distance(DVec2::new(3.0, 0.1)) < 0.1);
        assert_eq!(at.map(|o| o.kind), Some(expected), "{panes:?} {both}");
    }
}
