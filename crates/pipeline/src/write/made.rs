//! Options made real: the drawing patched, read again, and what differs in it.

use crate::read;
use std::collections::{BTreeMap, HashSet};

use glam::DVec2;

use crate::job::Input;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::understand::understood::Understood;
use crate::write::show;
use crate::write::{bounded, told};
use enfilade_cad::drawing::place_in;
use enfilade_cad::drawing::{Edit, RigidMotion};
use enfilade_cad::gltf;
use enfilade_config::Settings;
use enfilade_engine::geometry::UM_PER_M;
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_overlay::result::{self, ElementRef};
use enfilade_plan::Plan;
use enfilade_report::{Error, Place, Report};

/// A member made real: its layout, its bytes without our layers, and what these are worth.
pub(crate) struct Made {
    pub(crate) layout: Layout,
    pub(crate) member: enfilade_search::Member,
    pub(crate) worth: Worth,
    pub(crate) edits: Vec<Edit>,
    /// Those of filled areas that go along.
    pub(crate) following: Vec<enfilade_cad::dxf::Following>,
    /// What the edits change in the file.
    pub(crate) changed: enfilade_cad::Changes,
    /// Ids of the host program, by record.
    pub(crate) host_ids: BTreeMap<u64, String>,
    pub(crate) report: Report,
    pub(crate) name: String,
}

impl Made {
    /// What people call it.
    pub(crate) fn title(&self) -> String {
        self.name.strip_prefix("candidate-").map_or("best layout".to_owned(), |n| format!("option {n}"))
    }
}

/// Patches the drawing, reads it again and measures from scratch: what is reported is what is written.
pub(crate) fn make(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    name: &str,
    member: &enfilade_search::Member,
) -> Result<Made, Error> {
    let layout = study.base.moves.apply(&study.base.plan, &study.base.graph, &member.parameters);
    let options = read::read_options(settings);
    let mut edits = edits_of(&study.base, &layout);
    let tied = tied(input, settings, &study.base, &edits)?;
    edits.extend(tied.following.iter().map(|f| f.edit.clone()));
    let changed = enfilade_cad::changes(input.file(), &input.bytes, &options, &edits)?;
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &edits, &[])?;
    let worth = study.measure_written(&bytes, &layout, settings)?;
    let name = name.to_owned();
    let mut report = Report::default();
    let records: Vec<usize> = edits.iter().map(Edit::record).collect();
    let unseen = changed.records.iter().flatten().filter(|c| c.outlines.is_some()).map(|c| c.of.record);
    let rooms = changed.rooms.iter().map(|r| r.id as usize);
    let named: Vec<usize> = records.iter().copied().chain(unseen).chain(rooms).collect();
    let ids = enfilade_cad::host_ids(input.file(), &input.bytes, &named);
    let host_ids = named.iter().zip(ids).filter_map(|(r, id)| Some((*r as u64, id?))).collect();
    told::say_stale(&mut report, input.file(), &tied.stale);
    bounded::say(&mut report, input.file(), &changed);
    state_left_behind(&study.base, &layout, &mut report);
    let searched = study.measure(&member.parameters, &mut study.bench());
    let differs = worth.differences(&searched);
    if !differs.is_empty() {
        let differs: Vec<String> =
            differs.into_iter().map(|(what, new, old)| format!("{what} {new} instead of {old}")).collect();
        let text = format!(
            "{name} read again does not measure as in the search: {}; the values of the file are reported",
            differs.join(", ")
        );
        report.warn("written-differs", Place::file(input.file()), text);
    }
    let following = tied.following;
    Ok(Made { layout, member: member.clone(), worth, edits, following, changed, host_ids, report, name })
}

/// The changes of the file that make a layout; blocks once for all that they show.
pub(crate) fn edits_of(base: &Understood, layout: &Layout) -> Vec<Edit> {
    let mut out: Vec<Edit> = Vec::new();
    for moved in layout.walls.iter().filter(|w| w.is_changed) {
        let wall = &base.plan.walls[moved.wall as usize];
        let record = wall.source.record;
        if !wall.editable.moves_whole() {
            out.push(Edit::Shape { record, shape: moved.shape.clone() });
            continue;
        }
        let motion = moved.motion.map(|motion| Edit::Insert { record, motion });
        let slid = moved.slid.iter().map(|s| Edit::Insert {
            record: base.plan.slots[s.slot].source.record,
            motion: RigidMotion { turn_rad: 0.0, shift: s.shift },
        });
        for edit in motion.into_iter().chain(moved.ends.map(|by| Edit::Ends { record, by })).chain(slid) {
            if !out.contains(&edit) {
                out.push(edit);
            }
        }
    }
    for fitting in &base.fittings {
        let record = fitting.source.record;
        let Carried::Moves(shape, motion) = carried(&base.plan, fitting, layout) else { continue };
        let edit = match fitting.editable.moves_whole() {
            true => Edit::Insert { record, motion },
            false => Edit::Shape { record, shape },
        };
        if !out.contains(&edit) {
            out.push(edit);
        }
    }
    out
}

/// What hangs on what the edits of a layout change; what the plan understood otherwise stays as that has it.
pub(crate) fn tied(
    input: &Input<'_>,
    settings: &Settings,
    base: &Understood,
    edits: &[Edit],
) -> Result<enfilade_cad::dxf::Tied, Error> {
    let walls = base.plan.walls.iter().map(|w| w.source.record);
    let held: HashSet<usize> = walls.chain(base.fittings.iter().map(|f| f.source.record)).collect();
    enfilade_cad::tied(input.file(), &input.bytes, &read::read_options(settings), edits, &held)
}

/// Doors and windows that cannot go with their wall.
fn state_left_behind(base: &Understood, layout: &Layout, report: &mut Report) {
    for fitting in &base.fittings {
        if let Carried::Stale(why) = carried(&base.plan, fitting, layout) {
            let text = format!(
                "is part of a door or window whose wall moves in an option, but {why}; it stays as drawn"
            );
            report.info(told::OPENING_STAYS, place_in(&base.plan.file, &fitting.source), text);
        }
    }
    told::say_labels(base, layout, report);
}

/// `changes` of a candidate, each with the records of the file that differ.
pub(crate) fn changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let mut out = show::changes(&study.base, &made.layout);
    for change in &mut out {
        if let ElementRef::Gltf { path } = &change.element {
            let fitted = study.base.fittings.iter().map(|f| &f.source);
            let all = study.base.plan.walls.iter().map(|w| &w.source).chain(fitted);
            let named = all.filter(|s| s.handle.as_deref() == Some(path)).map(|s| &s.kind);
            change.host_id = named.into_iter().find(|name| gltf::is_global_id(name)).cloned();
            continue;
        }
        let (ElementRef::Dxf { record, .. } | ElementRef::Ifc { id: record, .. }) = change.element else {
            continue;
        };
        change.host_id = made.host_ids.get(&record).cloned();
        let edit = made.edits.iter().position(|e| e.record() as u64 == record);
        let Some(changed) = edit.and_then(|i| made.changed.records.get(i)) else { continue };
        if changed.len() == 1 {
            continue;
        }
        let mut all = vec![change.element.clone()];
        for c in changed.iter().filter(|c| c.outlines.is_none()) {
            let element = show::element_of(study.base.plan.format, c.of.handle.clone(), c.of.record);
            if !all.contains(&element) {
                all.push(element);
            }
        }
        if all.len() != 1 {
            change.element = ElementRef::Several(all);
        }
    }
    out.extend(unseen_changes(study, made));
    out.extend(following_changes(study, made));
    out.extend(bounded::changes(study, made));
    out
}

/// Filled areas that go along with their walls.
fn following_changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let plan = &study.base.plan;
    let of = |(f, changed): (&enfilade_cad::dxf::Following, &Vec<enfilade_cad::Changed>)| {
        let of = &changed.first()?.of;
        let [from, to] = f.corners.each_ref().map(|c| metres(plan, c));
        let element = show::element_of(plan.format, of.handle.clone(), of.record);
        Some(result::Change { element, host_id: None, from, to, follows: true })
    };
    let first = made.edits.len() - made.following.len();
    made.following.iter().zip(&made.changed.records[first..]).filter_map(of).collect()
}

/// Points of a file in metres of the drawing frame.
pub(crate) fn metres(plan: &Plan, points: &[DVec2]) -> Vec<[f64; 2]> {
    points.iter().map(|p| plan.frame.um_from_file(*p).map(|v| v as f64 / UM_PER_M)).collect()
}

/// Walls that the plan does not show and that go along by their length: each with its own places.
fn unseen_changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let plan = &study.base.plan;
    let of = |c: &enfilade_cad::Changed| {
        let [from, to] = c.outlines.as_ref()?.each_ref().map(|points| metres(plan, points));
        let element = show::element_of(plan.format, c.of.handle.clone(), c.of.record);
        let host_id = made.host_ids.get(&(c.of.record as u64)).cloned();
        Some(result::Change { element, host_id, from, to, follows: false })
    };
    made.changed.records.iter().flatten().filter_map(of).collect()
}
