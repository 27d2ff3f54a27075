//! `--backend`: what measures the layouts. All give the same bits; the report says which did, and why.

use crate::job::Input;
use crate::measure::study::Study;
use enfilade_config::Backend;
use enfilade_engine::gpu::{Gpu, Refusal};
use enfilade_report::{Place, Report};

/// Cells from which `auto` asks for a graphics card: with fewer, a core is done before a card has answered.
pub const AUTO_CELLS_MIN: usize = 512;

/// Says that no graphics card is asked where one was wanted and estimates are made.
pub(crate) fn state_unused(backend: Backend, input: &Input<'_>, report: &mut Report) {
    if backend == Backend::Gpu {
        let text = "--roots walks few trees, on the cores: no graphics card was asked; leave --roots away for all trees on it";
        report.info("backend-gpu", Place::file(input.file()), text);
    }
}

/// Gives the study a graphics card where one is wanted, there is one and it agrees with the cores.
pub(crate) fn choose(study: &mut Study, backend: Backend, input: &Input<'_>, report: &mut Report) {
    let is_auto = backend == Backend::Auto;
    let is_small = study.lattice.cells.len() < AUTO_CELLS_MIN;
    // Steps over stairs are counted on the cores.
    if backend == Backend::Cpu || (is_auto && (is_small || study.lattice.beyond.is_some())) {
        return;
    }
    let place = Place::file(input.file());
    let on_cores = |why: &str| format!("{why}; the cores measure, with the same result");
    let gpu = match Gpu::shared(!is_auto) {
        Ok(gpu) => gpu,
        Err(Refusal::Absent(_)) if is_auto => return,
        Err(why) => return report.warn("backend-gpu", place, on_cores(&why.to_string())),
    };
    let name = gpu.name().to_string();
    let is_software = gpu.is_software();
    match study.attach(gpu) {
        Err(why) => report.warn("backend-gpu", place, on_cores(&why)),
        // Never with `auto`, which opens real cards alone.
        Ok(()) if is_software => {
            let text = format!(
                "{name} measures the layouts: an adapter in software, exact, but no faster than the cores (--backend cpu)"
            );
            report.warn("backend-software", place, text);
        }
        Ok(()) if is_auto => match study.card_pays() {
            // One note for both: which it is hangs on the moment, and the same job says the same.
            Ok(pays) => {
                if !pays {
                    study.detach();
                }
                let text = format!(
                    "{name} or the cores measure the layouts, whichever took less time for some (--backend gpu or cpu decides)"
                );
                report.info("backend", place, text);
            }
            Err(why) => {
                study.detach();
                report.warn("backend-gpu", place, on_cores(&why));
            }
        },
        Ok(()) => report.info("backend", place, format!("{name} measures the layouts")),
    }
}
