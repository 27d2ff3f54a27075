//! What is asked: by the brief, and by the rule sets that it names.

use crate::understand::understood::Understood;
use enfilade_brief::demand::{Clause, demands};
use enfilade_config::Settings;
use enfilade_demands::{Asked, rule_set};
use enfilade_report::{Error, Place, Report};

/// All items, those of the brief first in its order.
pub(super) fn asked(
    base: &Understood,
    settings: &Settings,
    report: &mut Report,
) -> Result<Vec<Asked>, Error> {
    let refused = |why: String| {
        Error::usage("brief", Place::file(&base.plan.file), format!("brief: {why}; nothing was done"))
    };
    let mut out = Vec::new();
    for clause in demands(&settings.brief.join(";")).map_err(refused)? {
        match clause {
            Clause::Demand(demand) => out.push(Asked::said(demand)),
            Clause::Rule(name) => {
                let set = rule_set(&name).map_err(refused)?;
                let text =
                    format!("{}, {} ({}). Left out: {}", set.title, set.edition, set.source, set.leaves_out);
                report.info("brief-rule", Place::file(&base.plan.file), text);
                out.extend(set.asked().map_err(refused)?);
            }
        }
    }
    Ok(out)
}
