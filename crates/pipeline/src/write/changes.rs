//! What differs in the drawing of an option, element by element.

use crate::measure::study::Study;
use crate::write::bounded;
use crate::write::made::Made;
use crate::write::show::{self, metres};
use enfilade_cad::gltf;
use enfilade_overlay::result::{self, ElementRef};

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
pub(crate) fn following_changes(study: &Study, made: &Made) -> Vec<result::Change> {
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

/// Walls that the plan does not show and that go along by their length: each with its own places.
pub(crate) fn unseen_changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let plan = &study.base.plan;
    let of = |c: &enfilade_cad::Changed| {
        let [from, to] = c.outlines.as_ref()?.each_ref().map(|points| metres(plan, points));
        let element = show::element_of(plan.format, c.of.handle.clone(), c.of.record);
        let host_id = made.host_ids.get(&(c.of.record as u64)).cloned();
        Some(result::Change { element, host_id, from, to, follows: false })
    };
    made.changed.records.iter().flatten().filter_map(of).collect()
}
