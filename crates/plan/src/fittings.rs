//! Doors and windows as drawn: which entities sit in which opening, so that they move with its wall; and what else goes with
//! walls.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;

use super::Plan;
use super::axes::{AxisGraph, Opening, OpeningKind, Path, paths_of};
use super::curve;
use super::drawn::DrawnWalls;
use super::graph::Handle;
use super::rounds::as_arc;
use super::structure::{end_handles, face_handles};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Editable, Entity, Shape, SourceRef};
use enfilade_cad::roles::Role;
use enfilade_engine::geometry::PointUm;

/// One drawn part of a door or window, or something else that goes with a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// How it can be written back.
    pub editable: Editable,
    /// As drawn, drawing units.
    pub shape: Shape,
    /// Control points of the walls' ends that it sits between: those of one jamb, those of the other;
    /// empty where a jamb is the side of a wall.
    pub jambs: [Vec<Handle>; 2],
    /// The wall that it sits in, where the file says so, or on whose line it is drawn once more: an index into
    /// [`Plan::walls`]. It goes where that goes.
    pub host: Option<u32>,
    /// What it is.
    pub kind: FittingKind,
}

impl Fitting {
    /// Whether it is furniture, and no part of a door or window.
    pub fn is_furniture(&self) -> bool {
        matches!(self.kind, FittingKind::Furniture(_))
    }
}

/// What follows walls.
#[derive(Clone, Debug, PartialEq)]
pub enum FittingKind {
    /// A part of a door or window, or a line drawn once more on a wall's.
    Part,
    /// It lies in a plain passage and no name says that it is a door or window: a joint of the floor, a threshold. Where
    /// the sides of the passage part, it stays.
    Loose,
    /// Furniture at such sides of walls. It goes where any of them goes as a whole.
    Furniture(Vec<[Handle; 2]>),
}

/// A door's or window's parts lie no farther from its middle than this share of its width, and this many metres besides:
/// a leaf that slides along its wall, a leaf that stands open.
const REACH_SHARE: f64 = 1.6;
const REACH_M: f64 = 0.3;

/// How far from the middle of an opening its parts lie at most, metres of a person.
pub fn reach_m(opening: &Opening) -> f64 {
    REACH_SHARE * opening.width_m + REACH_M
}

/// Whether an entity lies all near an opening: what reaches farther is no part of a door or window.
pub fn is_near(plan: &Plan, e: &Entity, opening: &Opening) -> bool {
    let points = curve::trace(&e.shape, &plan.frame).points;
    let at = |p: &PointUm| plan.frame.plan_from_um(*p) / plan.human_scale;
    points.iter().all(|p| at(p).distance(opening.centre) <= reach_m(opening))
}

/// The fittings of all openings, and what the file says sits in a wall. `marked`: the entity of every [`super::axes::Mark`].
pub fn fittings(plan: &Plan, drawing: &Drawing, axes: &AxisGraph, marked: &[usize]) -> Vec<Fitting> {
    let mut by_record: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if let Some(record) = e.insert() {
            by_record.entry(record).or_default().push(i);
        }
    }
    // What one INSERT shows together with walls moves with them already.
    let walls: BTreeSet<usize> = plan.walls.iter().map(|w| w.source.record).collect();
    let mut out = hosted(plan, drawing);
    let mut whole: BTreeSet<usize> = BTreeSet::new();
    for opening in &axes.openings {
        let jambs = jambs_of(plan, axes, opening);
        if jambs.iter().all(Vec::is_empty) {
            continue;
        }
        for mark in &opening.marks {
            let entity = marked[*mark as usize];
            let record = drawing.entities[entity].source.record;
            let of_block = by_record.get(&record);
            let whole_mark = of_block.map_or(std::slice::from_ref(&entity), Vec::as_slice);
            if !whole_mark.iter().all(|i| is_near(plan, &drawing.entities[*i], opening)) {
                continue;
            }
            let is_told = drawing.hosts.contains_key(&record);
            if walls.contains(&record) || is_told || of_block.is_some() && !whole.insert(record) {
                continue;
            }
            let together = of_block.map_or_else(|| vec![entity], Clone::clone);
            for i in together {
                let e = &drawing.entities[i];
                let is_loose = opening.kind == OpeningKind::Passage
                    && !matches!(plan.reading.role(i), Role::Door | Role::Window | Role::Glazing);
                let kind = if is_loose { FittingKind::Loose } else { FittingKind::Part };
                out.entry(i).or_insert_with(|| Fitting { kind, ..fitting(e, &jambs) });
            }
        }
    }
    add_leaves(drawing, &walls, &mut out);
    let twin = |(i, wall): (usize, u32)| {
        (i, Fitting { host: Some(wall), ..fitting(&drawing.entities[i], &Default::default()) })
    };
    out.extend(twins(plan, drawing).into_iter().map(twin));
    out.into_values().collect()
}

/// What the file says sits in a wall of the plan, by entity.
fn hosted(plan: &Plan, drawing: &Drawing) -> BTreeMap<usize, Fitting> {
    let wall_of: BTreeMap<usize, u32> =
        plan.walls.iter().enumerate().rev().map(|(w, wall)| (wall.source.record, w as u32)).collect();
    let told = drawing.entities.iter().enumerate().filter(|(_, e)| !wall_of.contains_key(&e.source.record));
    let of = |(i, e): (usize, &Entity)| {
        let host = wall_of.get(drawing.hosts.get(&e.source.record)?)?;
        Some((i, Fitting { host: Some(*host), ..fitting(e, &Default::default()) }))
    };
    told.filter_map(of).collect()
}

fn fitting(e: &Entity, jambs: &[Vec<Handle>; 2]) -> Fitting {
    Fitting {
        source: e.source.clone(),
        editable: e.editable.clone(),
        shape: e.shape.clone(),
        jambs: jambs.clone(),
        host: None,
        kind: FittingKind::Part,
    }
}

/// Lines that are drawn once more on a wall's line, to the last digit and on its layer, and are no walls: a view under
/// its section. Each with its wall, without which it would stay where that was.
fn twins(plan: &Plan, drawing: &Drawing) -> Vec<(usize, u32)> {
    let bits = |p: DVec2| [p.x.to_bits(), p.y.to_bits()];
    let line = |shape: &Shape| match shape {
        Shape::Line { a, b } => Some([bits(*a).min(bits(*b)), bits(*a).max(bits(*b))]),
        _ => None,
    };
    let is_free = |editable: &Editable| *editable == Editable::Free;
    let free = plan.walls.iter().enumerate().filter(|(_, w)| is_free(&w.editable));
    let wall_of: HashMap<_, u32> =
        free.filter_map(|(i, w)| Some(((line(&w.shape)?, w.source.layer.as_str()), i as u32))).collect();
    let walls = DrawnWalls::new(plan, drawing);
    let others =
        drawing.entities.iter().enumerate().filter(|(i, e)| is_free(&e.editable) && !walls.contains(*i, e));
    others
        .filter_map(|(i, e)| Some((i, *wall_of.get(&(line(&e.shape)?, e.source.layer.as_str()))?)))
        .collect()
}

/// How far a leaf reaches beyond the sector that its door swings over, as a share of its width: its thickness.
const LEAF_SHARE: f64 = 0.1;

/// Leaves drawn as lines of their own: what lies on the layer of a door's swing and wholly in its sector belongs
/// to the same door.
fn add_leaves(drawing: &Drawing, walls: &BTreeSet<usize>, out: &mut BTreeMap<usize, Fitting>) {
    let swing = |i: &usize| {
        let e = &drawing.entities[*i];
        let arc = swing_of(&e.shape).filter(|_| e.insert().is_none())?;
        Some((*i, arc))
    };
    let swings: Vec<(usize, Shape)> = out.keys().filter_map(swing).collect();
    let layers: BTreeSet<&str> = swings.iter().map(|(i, _)| drawing.entities[*i].layer.as_str()).collect();
    // By layer, ascending along x.
    let mut loose: BTreeMap<&str, Vec<(f64, usize)>> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        let is_line = matches!(e.shape, Shape::Line { .. } | Shape::Polyline { .. });
        let is_free = e.insert().is_none() && !walls.contains(&e.source.record) && !out.contains_key(&i);
        if is_line && is_free && layers.contains(e.layer.as_str()) {
            let first = control_points(&e.shape).first().map(|p| p.x).filter(|x| x.is_finite());
            loose.entry(&e.layer).or_default().extend(first.map(|x| (x, i)));
        }
    }
    loose.values_mut().for_each(|list| list.sort_by(|a, b| a.0.total_cmp(&b.0)));
    for (swing, arc) in swings {
        let e = &drawing.entities[swing];
        let Shape::Arc { centre, radius, .. } = arc else { continue };
        let (Some(near), Some(jambs)) =
            (loose.get(e.layer.as_str()), out.get(&swing).map(|f| f.jambs.clone()))
        else {
            continue;
        };
        let reach = radius * (1.0 + LEAF_SHARE);
        let from = near.partition_point(|n| n.0 < centre.x - reach);
        for (_, i) in near[from..].iter().take_while(|n| n.0 <= centre.x + reach) {
            let leaf = &drawing.entities[*i];
            if control_points(&leaf.shape).into_iter().all(|p| is_in_sector(&arc, p)) {
                out.entry(*i).or_insert_with(|| fitting(leaf, &jambs));
            }
        }
    }
}

/// The arc that a swing is, or that the chords of one trace.
fn swing_of(shape: &Shape) -> Option<Shape> {
    match (shape, as_arc(&paths_of(shape, |p| p))?) {
        (Shape::Circle { .. }, _) => None,
        (_, Path::Arc { centre, radius, start_rad, sweep_rad }) => {
            Some(Shape::Arc { centre, radius, start_rad, end_rad: start_rad + sweep_rad })
        }
        _ => None,
    }
}

/// Whether a point lies in the sector of an arc, or no farther beside it than a leaf is thick.
fn is_in_sector(arc: &Shape, p: DVec2) -> bool {
    let Shape::Arc { centre, radius, start_rad, end_rad } = *arc else { return false };
    let (from, beside) = (p - centre, radius * LEAF_SHARE);
    let turn = |rad: f64| rad.rem_euclid(std::f64::consts::TAU);
    let is_within = turn(from.to_angle() - start_rad) <= turn(end_rad - start_rad);
    let is_beside = |rad: f64| {
        let along = DVec2::from_angle(rad);
        from.perp_dot(along).abs() <= beside && from.dot(along) >= -beside
    };
    from.length() <= radius + beside && (is_within || is_beside(start_rad) || is_beside(end_rad))
}

/// The control points of the wall ends at both jambs.
pub fn jambs_of(plan: &Plan, axes: &AxisGraph, opening: &Opening) -> [Vec<Handle>; 2] {
    opening.jambs.map(|jamb| {
        let Some(node) = jamb.node else { return Vec::new() };
        let mut out: Vec<Handle> = Vec::new();
        for edge in axes.edges.iter().filter(|e| e.nodes.contains(&node)) {
            out.extend(end_handles(plan, axes, edge, node));
        }
        let faces = &axes.nodes[node as usize].faces;
        out.extend(faces.iter().flat_map(|f| face_handles(plan, *f)));
        out.sort_unstable();
        out.dedup();
        out
    })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn a_leaf_lies_in_the_sector_of_its_swing() {
        let arc = |start_rad: f64, end_rad: f64| Shape::Arc {
            centre: DVec2::new(5.0, 2.0),
            radius: 0.9,
            start_rad,
            end_rad,
        };
        let quarter = arc(0.0, FRAC_PI_2);
        for (x, y, within) in [
            // The hinge, the tip of the open leaf, its far face beyond the hinge's side.
            (5.0, 2.0, true),
            (5.0, 2.9, true),
            (4.95, 2.9, true),
            (4.95, 1.95, true),
            (5.9, 2.0, true),
            (5.5, 2.5, true),
            // Beyond the swing, and on the other side of the wall.
            (5.8, 2.8, false),
            (4.5, 2.5, false),
            (5.3, 1.7, false),
            (5.0, 3.1, false),
        ] {
            assert_eq!(is_in_sector(&quarter, DVec2::new(x, y)), within, "{x} {y}");
        }
        // Over the direction from which angles count.
        let over = arc(-FRAC_PI_2 / 2.0, FRAC_PI_2 / 2.0);
        assert!(is_in_sector(&over, DVec2::new(5.8, 2.0)) && !is_in_sector(&over, DVec2::new(4.5, 2.0)));
        assert!(is_in_sector(&arc(PI, PI + FRAC_PI_2), DVec2::new(4.5, 1.7)));
    }
}
