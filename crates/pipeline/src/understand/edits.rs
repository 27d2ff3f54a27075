//! The changes of a file that make a layout.

use std::collections::HashSet;

use crate::job::Job;
use crate::read;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Edit, RigidMotion};
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_report::Error;

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
    job: Job<'_>,
    base: &Understood,
    edits: &[Edit],
) -> Result<enfilade_cad::dxf::Tied, Error> {
    let Job { input, settings } = job;
    let walls = base.plan.walls.iter().map(|w| w.source.record);
    let held: HashSet<usize> = walls.chain(base.fittings.iter().map(|f| f.source.record)).collect();
    enfilade_cad::tied(input.file(), &input.bytes, &read::read_options(settings), edits, &held)
}
