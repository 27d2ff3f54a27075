//! Columns that are drawn as filled areas alone: a hatch or a solid on a layer of walls or columns, with no line
//! round it.

use std::borrow::Cow;

use glam::DVec2;

use super::PlanOptions;
use super::choice::Chosen;
use super::hidden::Hidden;
use super::parallels::{Piece, pieces};
use crate::sizes::{COLUMN_MAX_M, ERROR_GAP_M};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Shape};
use enfilade_cad::plane::box_of;
use enfilade_cad::{layers, own_layers};
use enfilade_report::{Error, Place, Report};

/// Least ground of a column, square metres: frames and jambs have less.
const COLUMN_M2: f64 = 0.04;
/// Square of a column's outline as a multiple of its ground, at most: 16 for a square, more for what is long.
const COLUMN_COMPACT: f64 = 18.0;

/// Most comparisons of areas with lines of walls; beyond them nothing is taken.
const COMPARED_MAX: usize = 50_000_000;

/// The drawing with its filled areas behind what it draws: where an earlier reading picked some of them.
pub(super) fn joined<'a>(drawing: &'a Drawing, options: &PlanOptions) -> Cow<'a, Drawing> {
    let foreign = drawing.entities.iter().filter(|e| !own_layers::is_own(&e.layer)).count();
    let picks_fills = options.picked.as_ref().is_some_and(|p| p.last().is_some_and(|last| *last >= foreign));
    if picks_fills { Cow::Owned(with_fills(drawing)) } else { Cow::Borrowed(drawing) }
}

fn with_fills(drawing: &Drawing) -> Drawing {
    let mut whole = drawing.clone();
    whole.entities.append(&mut whole.fills);
    whole
}

/// Takes such columns into `picked` (ascending) and says so; the drawing then has its filled areas behind what it draws.
///
/// # Errors
/// What [`layers::WallLayers::new`] returns.
pub(super) fn take<'a>(
    drawing: Cow<'a, Drawing>,
    options: &PlanOptions,
    chosen: &mut Chosen,
    picked: &mut Vec<usize>,
    metres_per_unit: f64,
    report: &mut Report,
) -> Result<Cow<'a, Drawing>, Error> {
    if options.picked.is_some() || options.corrections.as_drawn || drawing.fills.is_empty() {
        return Ok(drawing);
    }
    let walls = pieces(picked.iter().map(|i| &drawing.entities[*i]));
    let Some([lo, hi]) = box_of(walls.iter().flat_map(|p| [p.a, p.b])) else { return Ok(drawing) };
    let by_name = layers::WallLayers::new(&options.wall_layers)?;
    let is_of_walls = |layer: &str| {
        let listed = chosen.layers.iter().find(|l| l.name == layer);
        listed.map_or_else(|| by_name.reason(layer).is_some(), |l| l.role == "wall")
    };
    let hidden = Hidden::new(&drawing);
    let is_like_column = |e: &Entity| {
        let points = outline(e);
        points.iter().all(|p| p.cmpge(lo).all() && p.cmple(hi).all())
            && is_of_walls(&e.layer)
            && !hidden.entity(e)
            && is_small(&points, metres_per_unit)
    };
    let mut columns: Vec<usize> =
        (0..drawing.fills.len()).filter(|k| is_like_column(&drawing.fills[*k])).collect();
    if columns.len() * walls.len().max(picked.len()) > COMPARED_MAX {
        columns.clear();
    }
    let near = ERROR_GAP_M / metres_per_unit;
    columns.retain(|k| !is_drawn_round(&drawing.fills[*k], &drawing, picked, &walls, near));
    say_left(&drawing, columns.len(), report);
    if columns.is_empty() {
        return Ok(drawing);
    }
    let names: std::collections::BTreeSet<&str> =
        columns.iter().map(|k| drawing.fills[*k].layer.as_str()).collect();
    let text = format!(
        "{} filled areas on {} are as small as columns and have no line round them: columns; they stop sight and stay",
        columns.len(),
        names.into_iter().map(|n| format!("{n:?}")).collect::<Vec<_>>().join(", ")
    );
    report.info("columns-filled", Place::file(&drawing.file), text);
    let first = drawing.entities.len();
    picked.extend(columns.iter().map(|k| first + k));
    Ok(Cow::Owned(with_fills(&drawing)))
}

fn say_left(drawing: &Drawing, taken: usize, report: &mut Report) {
    let left = drawing.fills.len() - taken;
    if left > 0 {
        let text =
            format!("{left} filled areas (HATCH, SOLID, TRACE) draw no walls; not used, kept in the file");
        report.info("fills-left-out", Place::file(&drawing.file), text);
    }
}

/// Corners of an area; of a round one the four ends of its axes.
fn outline(e: &Entity) -> Vec<DVec2> {
    match &e.shape {
        Shape::Circle { centre, radius } => {
            [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y].map(|d| *centre + d * *radius).to_vec()
        }
        shape => control_points(shape),
    }
}

fn is_small(points: &[DVec2], metres_per_unit: f64) -> bool {
    let Some(origin) = points.first() else { return false };
    let ring: Vec<DVec2> = points.iter().map(|p| (*p - *origin) * metres_per_unit).collect();
    box_of(ring.iter().copied()).is_some_and(|[lo, hi]| (hi - lo).max_element() <= COLUMN_MAX_M)
        && is_column(&ring)
}

/// Whether lines of walls run along an area's sides, or a ring is drawn round it.
fn is_drawn_round(e: &Entity, drawing: &Drawing, picked: &[usize], walls: &[Piece], near: f64) -> bool {
    if let Shape::Circle { centre, radius } = e.shape {
        let is_same = |i: &usize| match &drawing.entities[*i].shape {
            Shape::Circle { centre: c, radius: r } | Shape::Arc { centre: c, radius: r, .. } => {
                c.distance(centre) <= near && (r - radius).abs() <= near
            }
            _ => false,
        };
        return picked.iter().any(is_same);
    }
    let points = outline(e);
    let sides = points.iter().zip(points.iter().cycle().skip(1));
    sides.into_iter().any(|(a, b)| walls.iter().any(|w| runs_along([*a, *b], w, near)))
}

/// Whether a wall's line covers the middle of a side, as near as that, and in its direction.
fn runs_along([a, b]: [DVec2; 2], wall: &Piece, near: f64) -> bool {
    let (side, line) = (b - a, wall.b - wall.a);
    let along = line.normalize_or_zero();
    let middle = a.midpoint(b) - wall.a;
    side.normalize_or_zero().perp_dot(along).abs() < 0.05
        && along.perp_dot(middle).abs() <= near
        && (0.0..=line.length()).contains(&middle.dot(along))
}

/// Whether an outline, in metres, is that of a column and of no leaf, frame or sector of a swing.
fn is_column(ring: &[DVec2]) -> bool {
    let sides = || (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]);
    let length: f64 = sides().map(|[a, b]| a.distance(b)).sum();
    let ground = sides().map(|[a, b]| (a - ring[0]).perp_dot(b - ring[0]) / 2.0).sum::<f64>().abs();
    let Some([lo, hi]) = box_of(ring.iter().copied()) else { return false };
    let opposite = |p: &DVec2| lo + hi - *p;
    ground >= COLUMN_M2
        && length * length <= COLUMN_COMPACT * ground
        && ring.iter().all(|p| ring.iter().any(|q| q.distance(opposite(p)) <= ERROR_GAP_M))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::understand;
    use enfilade_cad::drawing::{Editable, SourceRef, Unit, Vertex};

    fn entity(layer: &str, shape: Shape) -> Entity {
        Entity {
            source: SourceRef { record: 0, handle: None, line: 1, kind: "LINE".into(), layer: layer.into() },
            layer: layer.into(),
            shape,
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        }
    }

    fn square(at: [f64; 2], side: f64) -> Shape {
        let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        let vertices = corners.map(|c| Vertex { at: DVec2::from(at) + DVec2::from(c), bulge: 0.0 });
        Shape::Polyline { vertices: vertices.to_vec(), closed: true }
    }

    /// A house of 12 by 12 m with areas in it, metres.
    fn house(fills: Vec<Entity>) -> Drawing {
        let mut d = Drawing::of(vec![
            entity("WALLS", square([0.0, 0.0], 12.0)),
            entity("WALLS", square([0.3, 0.3], 11.4)),
            entity("COLS", square([9.0, 9.0], 0.4)),
        ]);
        d.declared_unit = Some(Unit { name: "m", metres: 1.0 });
        d.fills = fills;
        d
    }

    fn walls_of(d: &Drawing) -> Vec<Shape> {
        let plan = understand(d, &PlanOptions::default(), &mut Report::default()).unwrap();
        // An earlier choice is found again, areas among it.
        let again = PlanOptions { picked: Some(plan.picked.clone()), ..PlanOptions::default() };
        let again = understand(d, &again, &mut Report::default()).unwrap();
        assert_eq!(again.walls, plan.walls);
        plan.walls.into_iter().map(|w| w.shape).collect()
    }

    #[test]
    fn small_areas_without_a_line_round_them_are_columns() {
        let cases = [
            ("square", entity("COLS", square([3.0, 3.0], 0.4)), 1),
            ("round", entity("COLS", Shape::Circle { centre: DVec2::new(5.0, 5.0), radius: 0.2 }), 1),
            ("on a layer of walls", entity("WALLS", square([3.0, 3.0], 0.4)), 1),
            ("on another layer", entity("FURNITURE", square([3.0, 3.0], 0.4)), 0),
            ("drawn round", entity("COLS", square([9.0, 9.0], 0.4)), 0),
            ("too wide", entity("COLS", square([3.0, 3.0], COLUMN_MAX_M + 0.1)), 0),
            ("as wide as a column", entity("COLS", square([3.0, 3.0], COLUMN_MAX_M - 0.1)), 1),
            ("outside", entity("COLS", square([13.0, 3.0], 0.4)), 0),
            ("a fill between a wall's faces", entity("WALLS", square([0.0, 3.0], 0.3)), 0),
        ];
        for (what, fill, more) in cases {
            assert_eq!(walls_of(&house(vec![fill])).len(), 3 + more, "{what}");
        }
    }

    #[test]
    fn too_many_areas_are_none() {
        let one = entity("COLS", square([3.0, 3.0], 0.4));
        let squares = 650;
        let mut d = house(vec![one; COMPARED_MAX / (4 * squares) + 1]);
        let mut picked = vec![0; squares];
        let mut chosen = Chosen { walls: vec![], layers: vec![] };
        let before = picked.len();
        let mut taken = |d: &Drawing| {
            let drawing = Cow::Borrowed(d);
            let options = PlanOptions::default();
            let taken =
                take(drawing, &options, &mut chosen, &mut picked, 1.0, &mut Report::default()).unwrap();
            (matches!(taken, Cow::Borrowed(_)), picked.len() - before)
        };
        assert_eq!(taken(&d), (true, 0));
        d.fills.truncate(2);
        assert_eq!(taken(&d), (false, 2));
    }
}
