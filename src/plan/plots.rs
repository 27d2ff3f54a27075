//! Borders of sheets and plots drawn as one line round a building, on the layer of its walls: they are no walls.
//!
//! A rectangle may well be the outer wall of a gallery with screens in it. It is a border only where what lies in it is a
//! building of its own: walls of two faces, with windows, that enclose rooms.

use glam::DVec2;

use super::PlanOptions;
use super::axes::{AxisGraph, Drawn, Mark, OpeningKind, paths_of};
use super::borders::Border;
use super::box_of;
use super::choice::Chosen;
use super::curve::{control_points, trace};
use super::drawing::{Drawing, Entity, Format};
use super::frame::Frame;
use super::geometry::Segment;
use super::interior::Interior;
use super::own_layers::is_own;
use super::parallels::{Piece, pieces};
use super::structure::{faces_of, mark_role, swing_or};
use super::views::gap;
use crate::plan::markers;
use crate::report::Report;

/// Ends this near, as a share of the longer side, are one corner.
const SAME_SHARE: f64 = 1e-4;

/// Most borders one in another.
const BORDERS_MAX: usize = 3;

/// A line nearer than this is the second face of a wall, metres.
const SECOND_FACE_M: f64 = 0.45;

/// The building keeps farther than this from the border round it, metres: no wall is so thick.
const CLEAR_M: f64 = 0.8;

/// Least ground that a building encloses, square metres.
const GROUND_MIN_M2: f64 = 10.0;

/// Takes such borders out of the walls, and says so; whether there were any.
pub(super) fn leave_out(
    drawing: &Drawing,
    options: &PlanOptions,
    chosen: &mut Chosen,
    metres_per_unit: f64,
    report: &mut Report,
) -> bool {
    if drawing.format != Format::Dxf || !options.is_our_choice() {
        return false;
    }
    let mut left = chosen.walls.clone();
    let mut borders: Vec<Rectangle> = Vec::new();
    while borders.len() < BORDERS_MAX {
        let Some(border) = Rectangle::round(drawing, &left) else { break };
        left.retain(|i| !border.entities.contains(i));
        borders.push(border);
    }
    // The innermost one may be a wall of the building: then those round it are looked at alone.
    let least = |k: usize, count: usize| if k + 1 == count { CLEAR_M } else { SECOND_FACE_M };
    let is_clear = |count: usize| (0..count).all(|k| borders[k].clear * metres_per_unit > least(k, count));
    let rest = |count: usize| -> Vec<usize> {
        let is_border = |i: &usize| borders[..count].iter().any(|b| b.entities.contains(i));
        chosen.walls.iter().copied().filter(|i| !is_border(i)).collect()
    };
    let mut doubted = None;
    for count in (1..=borders.len()).rev() {
        let innermost = &borders[count - 1];
        if innermost.clear * metres_per_unit <= CLEAR_M {
            continue;
        }
        let within = rest(count);
        let found = building(drawing, &within, metres_per_unit);
        if found == Building::Whole && is_clear(count) {
            borders[..count].iter().for_each(|b| b.say(drawing, metres_per_unit, report));
            chosen.walls = within;
            return true;
        }
        if found != Building::None {
            doubted.get_or_insert(innermost);
        }
    }
    if let Some(border) = doubted {
        border.doubt(drawing, metres_per_unit, report);
    }
    false
}

/// A rectangle of single lines round all other walls, which touches none of them, and the block of a title that hangs on it.
struct Rectangle {
    size: DVec2,
    /// One polyline, or four lines, and what hangs on them.
    entities: Vec<usize>,
    /// How many hang on it.
    hanging: usize,
    /// How far from it the next line is, drawing units.
    clear: f64,
}

impl Rectangle {
    fn round(drawing: &Drawing, walls: &[usize]) -> Option<Self> {
        let [lo, hi] = box_of(walls.iter().flat_map(|i| control_points(&drawing.entities[*i].shape)))?;
        let same = SAME_SHARE * (hi - lo).max_element();
        let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
        let is_side = |p: &Piece, k: usize| {
            let side = [corners[k], corners[(k + 1) % 4]];
            let runs = |a: DVec2, b: DVec2| a.distance(side[0]) <= same && b.distance(side[1]) <= same;
            runs(p.a, p.b) || runs(p.b, p.a)
        };
        let mut sides = [0; 4];
        let mut entities = Vec::new();
        for i in walls {
            let own = pieces(std::iter::once(&drawing.entities[*i]));
            let of = |p: &Piece| (0..4).find(|k| is_side(p, *k));
            let found: Vec<usize> = own.iter().filter_map(of).collect();
            if !found.is_empty() && found.len() == own.len() {
                found.iter().for_each(|k| sides[*k] += 1);
                entities.push(*i);
            }
        }
        let sides_alone = entities.len();
        let all: Vec<&Entity> = walls.iter().map(|i| &drawing.entities[*i]).collect();
        let block = Border::find(&all).filter(|b| !b.blocks.is_empty());
        if let Some(block) = &block {
            let takes = |k: &usize| block.takes(*k, all[*k]) && !entities.contains(&walls[*k]);
            let hanging: Vec<usize> = (0..walls.len()).filter(takes).map(|k| walls[k]).collect();
            entities.extend(hanging);
        }
        let others = || walls.iter().filter(|i| !entities.contains(i)).map(|i| &drawing.entities[*i]);
        let [low, high] = box_of(others().flat_map(|e| control_points(&e.shape)))?;
        let clear = (low - lo).min_element().min((hi - high).min_element());
        let clear = others()
            .filter_map(|e| box_of(control_points(&e.shape).into_iter()))
            .flat_map(|e| block.iter().flat_map(|b| &b.blocks).map(move |b| gap(&e, b)))
            .fold(clear, f64::min);
        let hanging = entities.len() - sides_alone;
        (sides == [1; 4]).then_some(Self { size: hi - lo, entities, hanging, clear })
    }

    fn say(&self, drawing: &Drawing, metres_per_unit: f64, report: &mut Report) {
        let Some(first) = self.entities.first() else { return };
        let size = self.size * metres_per_unit;
        let what =
            if self.entities.len() - self.hanging == 1 { "it draws" } else { "it and three lines more draw" };
        let hanging = match self.hanging {
            0 => String::new(),
            1 => ", left out with 1 line that hangs on it".to_owned(),
            n => format!(", left out with {n} lines that hang on it"),
        };
        let text = format!(
            "{what} a rectangle of {:.1} x {:.1} m round the building, which touches no wall and has no second face: the \
             border of a sheet or a plot{hanging}; left out of the walls, --wall-layer takes it in",
            size.x, size.y
        );
        report.info("plot-border", markers::place(drawing, &drawing.entities[*first].source), text);
    }

    /// Says that it may be a border, and how to say so.
    fn doubt(&self, drawing: &Drawing, metres_per_unit: f64, report: &mut Report) {
        let Some(first) = self.entities.first() else { return };
        let size = self.size * metres_per_unit;
        let text = format!(
            "found a closed outline of {:.1} x {:.1} m round a building that it does not touch, with no way through; it is \
             taken as a wall, and what it encloses as floor; if it is the border of a sheet or a plot, put it on a layer of \
             its own and name that of the walls with --wall-layer, or draw EF-QUERY round the rooms",
            size.x, size.y
        );
        report.warn("border-or-wall", markers::place(drawing, &drawing.entities[*first].source), text);
    }
}

/// What walls make by themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Building {
    /// No walls of two faces that enclose rooms.
    None,
    /// Such walls without windows.
    Blind,
    /// Such walls with windows.
    Whole,
}

fn building(drawing: &Drawing, walls: &[usize], metres_per_unit: f64) -> Building {
    let entities: Vec<&Entity> = walls.iter().map(|i| &drawing.entities[*i]).collect();
    let Some(extent) = box_of(entities.iter().flat_map(|e| control_points(&e.shape))) else {
        return Building::None;
    };
    let frame = Frame::new(metres_per_unit, extent);
    let place = |p: DVec2| frame.plan_from_file(p);
    let faces = entities.iter().enumerate().flat_map(|(w, e)| faces_of(&e.shape, w as u32, place)).collect();
    let is_other = |i: &usize| walls.binary_search(i).is_err() && !is_own(&drawing.entities[*i].layer);
    let marks = (0..drawing.entities.len()).filter(is_other).filter_map(|i| {
        let e = &drawing.entities[i];
        let paths = swing_or(paths_of(&e.shape, place));
        let (role, word) = mark_role(None, e, &paths)?;
        Some(Mark { paths, role, group: i as u32, word })
    });
    let axes = AxisGraph::new(&Drawn { faces, marks: marks.collect() });
    if axes.thicknesses.is_empty() {
        return Building::None;
    }
    let um = |p: DVec2| frame.um_from_plan(p);
    let openings: Vec<Segment> =
        axes.openings.iter().map(|o| Segment { a: um(o.jambs[0].at), b: um(o.jambs[1].at) }).collect();
    let traces: Vec<_> = entities.iter().map(|e| trace(&e.shape, &frame)).collect();
    let lines: Vec<Segment> = traces.iter().flat_map(|t| t.segments().map(|s| s.2)).collect();
    let inside = Interior::new(&lines, &openings, 1.0);
    let encloses = inside.is_some_and(|i| i.closing_m() == 0.0 && i.area_m2() >= GROUND_MIN_M2);
    match axes.openings.iter().any(|o| o.kind == OpeningKind::Window) {
        _ if !encloses => Building::None,
        true => Building::Whole,
        false => Building::Blind,
    }
}
