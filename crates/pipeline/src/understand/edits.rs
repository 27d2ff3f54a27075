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
    let held = (&held, base.plan.frame.metres_per_unit);
    enfilade_cad::tied(input.file(), &input.bytes, &read::read_options(settings), edits, held)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::understand::understood;
    use enfilade_config::{Partial, Settings};
    use enfilade_plan::kinds::furniture;
    use enfilade_report::Report;

    /// Furniture stands in the written file where its wall took it, to the micrometre; all other furniture where it stood.
    #[test]
    fn furniture_is_written_where_its_wall_took_it() {
        for name in ["flat.dxf", "flat.ifc"] {
            let bytes = std::fs::read(enfilade_fixtures::sample(name)).unwrap();
            let settings = Settings::new(Partial::default()).unwrap();
            let mut report = Report::default();
            let drawing = read::drawing(name, &bytes, &settings, &mut report).unwrap();
            let base = understood(&drawing, &settings, &mut report).unwrap();
            let mut went = 0;
            for (i, [lower, upper]) in base.moves.bounds().into_iter().enumerate() {
                let mut p = base.moves.identity();
                p[i] = if upper > -lower { upper } else { lower };
                let layout = base.moves.apply(&base.plan, &base.graph, &p);
                let options = read::read_options(&settings);
                let now =
                    enfilade_cad::patch(name, &bytes, &options, &edits_of(&base, &layout), &[]).unwrap();
                let again = read::drawing(name, &now, &settings, &mut Report::default()).unwrap();
                let places = |d| {
                    let all = furniture(d, &base.plan).into_iter();
                    all.map(|(thing, source, _)| (source.handle, thing.extent)).collect::<Vec<_>>()
                };
                for ((handle, was), (other, is)) in places(&drawing).into_iter().zip(places(&again)) {
                    assert_eq!(handle, other, "{name}");
                    let own = base.fittings.iter().find(|f| f.source.handle == handle && f.is_furniture());
                    let shift = match own.map(|f| carried(&base.plan, f, &layout)) {
                        Some(Carried::Moves(_, motion)) => motion.shift * base.plan.frame.metres_per_unit,
                        _ => glam::DVec2::ZERO,
                    };
                    went += usize::from(shift.length() > 0.1);
                    let off = |k: usize, c: usize| (is[k][c] - was[k][c]) as f64 - shift[c] * 1e6;
                    assert!(
                        [0, 1].iter().all(|k| off(*k, 0).abs() < 2.0 && off(*k, 1).abs() < 2.0),
                        "{name} {handle:?}"
                    );
                }
            }
            assert!(went > 0, "{name}");
        }
    }
}
