//! Whether an element is there, is to be built or is to go: `Status` of the property sets of the standard, and what the two
//! programs that most architects draw buildings with write of their phases.

use super::model::Model;
use super::step::{Arg, Step, Value};
use crate::phase::Phase;

/// What one property says.
fn said(set: &str, name: &str, value: &str) -> Option<Phase> {
    let is_status = set.starts_with("Pset_") && name.eq_ignore_ascii_case("Status");
    // ArchiCAD: `AC_Pset_RenovationAndPhasing`.
    let is_renovation = name.eq_ignore_ascii_case("Renovation Status");
    let value = value.trim().to_lowercase();
    match () {
        () if is_status || is_renovation => match value.as_str() {
            "demolish" | "to be demolished" | "demolished" => Some(Phase::Demolished),
            "new" => Some(Phase::New),
            "temporary" => Some(Phase::Temporary),
            _ => None,
        },
        // Revit: the phase in which it goes, where there is one.
        () if name.eq_ignore_ascii_case("Phase Demolished") => {
            (!matches!(value.as_str(), "" | "none" | "-1")).then_some(Phase::Demolished)
        }
        () => None,
    }
}

/// The words of a value, of a list the first.
fn words(step: &Step<'_>, arg: &Arg) -> String {
    match &arg.value {
        Value::List(list) => list.first().map(|a| words(step, a)).unwrap_or_default(),
        Value::Typed(_, inner) => inner.first().map(|a| words(step, a)).unwrap_or_default(),
        Value::Enum(e) => e.clone(),
        _ => step.text(arg).unwrap_or_default(),
    }
}

/// The phase of an element by its own property sets, else by those of its type. What was built and is to go has both.
pub(super) fn phase(step: &Step<'_>, model: &Model, id: u64) -> Phase {
    let of = |set: &u64| {
        let args = step.args(*set);
        let name = args.get(2).and_then(|a| step.text(a)).unwrap_or_default();
        let mut properties = args.get(4).map(Arg::ids).unwrap_or_default().into_iter();
        properties.find_map(|property| {
            let of = step.args(property);
            let key = of.first().and_then(|a| step.text(a))?;
            said(&name, key.trim(), &words(step, of.get(2)?))
        })
    };
    for sets in [model.properties.get(&id), model.of_types.get(&id)].into_iter().flatten() {
        let found: Vec<Phase> = sets.iter().filter_map(of).collect();
        let is_gone = found.contains(&Phase::Demolished).then_some(Phase::Demolished);
        if let Some(phase) = is_gone.or(found.first().copied()) {
            return phase;
        }
    }
    Phase::Existing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phases_are_said_in_three_ways() {
        for (set, name, value, phase) in [
            ("Pset_WallCommon", "Status", "DEMOLISH", Some(Phase::Demolished)),
            ("Pset_WallCommon", "Status", "NEW", Some(Phase::New)),
            ("Pset_DoorCommon", "Status", "EXISTING", None),
            ("Pset_WallCommon", "Status", "TEMPORARY", Some(Phase::Temporary)),
            ("Mine", "Status", "DEMOLISH", None),
            (
                "AC_Pset_RenovationAndPhasing",
                "Renovation Status",
                "To be demolished",
                Some(Phase::Demolished),
            ),
            ("Phasing", "Phase Demolished", "New Construction", Some(Phase::Demolished)),
            ("Phasing", "Phase Demolished", "None", None),
            ("Phasing", "Phase Created", "Existing", None),
        ] {
            assert_eq!(said(set, name, value), phase, "{set} {name} {value}");
        }
    }
}
