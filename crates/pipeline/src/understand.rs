//! The second stage, from a drawing to what is understood of it: its plan, its axes, what may move.

pub(crate) mod behind;
pub(crate) mod building;
pub(crate) mod carrying;
pub(crate) mod edits;
pub(crate) mod far;
pub(crate) mod faults;
pub(crate) mod fits;
pub(crate) mod gaps;
pub(crate) mod idle;
pub(crate) mod jambs;
pub(crate) mod marked;
pub(crate) mod moves;
pub(crate) mod named;
pub(crate) mod options;
pub(crate) mod pieces;
pub(crate) mod reach;
pub(crate) mod regions;
pub(crate) mod rooms;
pub(crate) mod sensed;
pub(crate) mod senses;
pub(crate) mod sureness;
pub(crate) mod understood;

use glam::DVec2;

use enfilade_cad::drawing::Drawing;
use enfilade_cad::own_layers;
use enfilade_cad::plane::box_of;
use enfilade_cad::units::unit_by_name;
use enfilade_config::{Level, Settings};
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_engine::interior::Interior;
use enfilade_plan::at_walls::furniture_at_walls;
use enfilade_plan::axes::{AxisGraph, Opening};
use enfilade_plan::curve::{Trace, trace};
use enfilade_plan::graph::Graph;
use enfilade_plan::hidden::Hidden;
use enfilade_plan::sight::Sight;
use enfilade_plan::{Plan, PlanOptions, fittings, infill, labels, structure, understand, view_box};
use enfilade_report::{Error, Place, Problem, Report, Severity};
use moves::{Known, moves};
use options::plan_options;
use regions::{add_regions, corrected, state_unused_seeds, without_called_outdoors};
use understood::{Understood, faces};

/// Where no wall was read, says why the first could not be, rather than how to name a layer.
fn with_cause(error: Error, report: &Report) -> Error {
    const CAUSES: [&str; 3] = ["ifc-element", "gltf-mesh", "unit-doubt"];
    let mut causes =
        report.problems.iter().filter(|p| CAUSES.contains(&p.code) && p.severity == Severity::Warning);
    match (error, causes.next()) {
        (Error::Input(problem), Some(first)) if problem.code == "no-walls" => {
            let others = match causes.count() {
                0 => String::new(),
                1 => "; 1 more element cannot be read either".into(),
                n => format!("; {n} more elements cannot be read either"),
            };
            let text = format!("no wall can be read: {}{others}; nothing was measured", first.text);
            Error::Input(Problem { text, place: first.place.clone(), ..problem })
        }
        (other, _) => other,
    }
}

/// Says which storey has no walls.
fn within_storey(error: Error, settings: &Settings) -> Error {
    match (error, &settings.storey) {
        (Error::Input(problem), Some(storey)) if problem.code == "no-walls" => {
            Error::Input(Problem { text: format!("storey {storey:?}: {}", problem.text), ..problem })
        }
        (other, _) => other,
    }
}

/// Understands a drawing that was read.
///
/// # Errors
/// What [`understand`] returns; [`Error::Usage`] for settings that do not fit the drawing.
pub fn understood(drawing: &Drawing, settings: &Settings, report: &mut Report) -> Result<Understood, Error> {
    let unit = match &settings.unit {
        Some(name) => Some(unit_by_name(name).ok_or_else(|| {
            let text = format!("unit, by --unit or a settings file: found {name:?}, expected mm, cm, m, in or ft; nothing was done");
            Error::usage("unit", Place::default(), text)
        })?),
        None => None,
    };
    let drawing = &*view_box::within(drawing, settings.view.as_deref());
    let options = PlanOptions { unit, ..plan_options(settings) };
    let understood = understand(drawing, &options, report);
    let mut plan = understood.map_err(|e| within_storey(with_cause(e, report), settings))?;
    add_regions(&mut plan, settings)?;
    building::add_spaces(drawing, &mut plan, settings)?;
    state_unused_seeds(&plan, settings, report);
    if settings.allow.structure {
        plan.bearing.clear();
    }
    let graph = Graph::new(&plan);
    let of_side_car = marked::side_car_works(&plan, &graph, settings, report)?;
    plan.markers.allowed.extend(of_side_car);
    let as_drawn = settings.reading.as_drawn == Some(true);
    let (axes, marked) = if as_drawn { Default::default() } else { structure::axes(&plan, drawing) };
    let bodies = structure::bodies(&plan, &axes);
    let mut sight = Sight::new(&plan, &axes, settings.level == Level::Knee);
    if settings.level == Level::Knee {
        sight.closed.extend(infill::glass_lines(&plan, drawing, &axes));
    }
    sight.close(|wall| building::closes(&plan.walls[wall as usize]));
    let mut fittings = fittings::fittings(&plan, drawing, &axes, &marked);
    let labels = labels::labels(&plan, drawing, &fittings);
    fittings.extend(furniture_at_walls(&plan, drawing, &axes));
    let all = faces(&plan);
    let (mut closings, mut infill) = (Vec::new(), Vec::new());
    if !as_drawn {
        closings = building::closings(drawing, &plan);
        closings.extend(opening_lines(&plan, &axes));
        infill = infill::infill_lines(&plan, drawing, &axes);
        closings.extend(&infill);
    }
    let interior = Interior::new(&all, &closings, plan.human_scale).map(|i| i.without(&plan.outdoors));
    let interior = interior.map(|i| if sight.has_open() { i.with_drawn_openings() } else { i });
    let interior = interior.map(|i| without_called_outdoors(i, drawing, &plan, report));
    let interior = corrected(interior, &mut plan, settings, report);
    if let Some(interior) = interior.as_ref().filter(|_| settings.seed_points.is_empty()) {
        let is_marked = |p: PointUm| plan.markers.regions().any(|r| r.contains(p));
        let is_beside = |p: PointUm| !interior.is_at_wall(p) && !interior.is_cavity(p);
        let side = |p: PointUm| is_beside(p).then(|| interior.contains(p) || is_marked(p));
        sight.end_outdoors(&closings, plan.human_scale, side);
    }
    let known = Known {
        plan: &plan,
        graph: &graph,
        axes: &axes,
        interior: interior.as_ref(),
        fittings: &fittings,
        infill: &infill,
    };
    marked::state_idle_keeps(drawing, &plan, report);
    let (moves, groups) = moves(drawing, &known, settings, report)?;
    let openings = building::named_openings(drawing, &plan);
    let left_out = left_out(&plan, drawing);
    let entities = sensed::entities_of_walls(&plan, drawing);
    let (sure_of_walls, sure_of_whole) = (sureness::of_walls(&plan, drawing), sureness::of_whole(drawing));
    let (things, spaces) =
        (enfilade_plan::kinds::find_things(drawing, &plan), building::named_spaces(drawing, &plan));
    let space_rings = building::space_rings(drawing, &plan);
    let mut base = Understood {
        plan,
        graph,
        axes,
        bodies,
        sight,
        fittings,
        left_out,
        labels,
        moves,
        interior,
        openings,
        texts: drawing.texts.iter().chain(&drawing.tags).cloned().collect(),
        things,
        spaces,
        space_rings,
        wishes: drawing.wishes.clone(),
        closings,
        entities,
        sure_of_walls,
        sure_of_whole,
        marked,
    };
    if !groups.is_empty() {
        base.moves = marked::taken_up(&mut base, &groups, settings, report);
    } else if base.moves.are_default {
        base.moves = reach::defaults_within_reach(&base, settings, report);
    }
    gaps::state_closed(&base, report);
    Ok(base)
}

/// What closes doors, windows and passages: for finding out what lies inside, not for sight.
fn opening_lines(plan: &Plan, axes: &AxisGraph) -> Vec<Segment> {
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    let line = |o: &Opening| Segment { a: um(o.jambs[0].at), b: um(o.jambs[1].at) };
    axes.openings.iter().map(line).collect()
}

/// Most shapes left out that are kept for the picture.
const LEFT_OUT_MAX: usize = 20_000;

/// Visible shapes within the plan that are neither walls nor marks of ours.
fn left_out(plan: &Plan, drawing: &Drawing) -> Vec<(Trace, bool)> {
    let points = plan.walls.iter().flat_map(|w| &w.trace.points);
    let Some([lo, hi]) = box_of(points.map(|p| DVec2::new(p[0] as f64, p[1] as f64))) else {
        return Vec::new();
    };
    let hidden = Hidden::new(drawing);
    let all = drawing.entities.iter().enumerate();
    let foreign = all.filter(|(_, e)| !own_layers::is_own(&e.layer)).enumerate();
    let free = foreign.filter(|(k, (_, e))| plan.picked.binary_search(k).is_err() && !hidden.entity(e));
    let traces = free.map(|(_, (i, e))| (trace(&e.shape, &plan.frame), infill::is_glass(plan, i)));
    let is_within = |(t, _): &(Trace, bool)| {
        t.points.iter().all(|p| {
            let p = DVec2::new(p[0] as f64, p[1] as f64);
            p.cmpge(lo).all() && p.cmple(hi).all()
        })
    };
    traces.filter(is_within).take(LEFT_OUT_MAX).collect()
}
