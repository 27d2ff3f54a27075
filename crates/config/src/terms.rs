//! Terms of what is asked for, as people write them: `degree max 0.7`, `clearance 1`.

use enfilade_brief::Measure;
use enfilade_report::Error;

use super::control::Aim;
use super::{ObjectiveSetting, Penalty, THRESHOLD_DEFAULT, bad, clauses};

/// What is asked for: measures with a sense and a threshold.
pub(super) fn objectives(text: &str) -> Result<Vec<ObjectiveSetting>, Error> {
    let expected = format!(
        "`MEASURE max|min THRESHOLD`, separated by commas; MEASURE is one of {}; with -min, -max or -p1 to -p99 behind \
         it for other than the mean, and @NAME for the regions of a named pair; THRESHOLD from 0 to 1",
        Measure::all_names()
    );
    let mut out: Vec<ObjectiveSetting> = Vec::new();
    for clause in clauses(text) {
        let words: Vec<&str> = clause.split_whitespace().collect();
        let measure = words.first().and_then(|w| w.parse::<Aim>().ok());
        let sense = words.get(1).map(|s| s.to_lowercase());
        let threshold = words.get(2).map_or(Some(THRESHOLD_DEFAULT), |t| t.parse().ok());
        match (measure, sense.as_deref(), threshold) {
            (Some(measure), Some(sense @ ("max" | "min")), Some(threshold))
                if words.len() <= 3 && (0.0..=1.0).contains(&threshold) =>
            {
                out.push(ObjectiveSetting { measure, is_max: sense == "max", threshold });
            }
            (Some(_), Some("max" | "min"), Some(wrong)) if words.len() <= 3 => {
                let found = format!("the threshold {wrong} in {clause:?}");
                return Err(bad("objective", &found, "a share from 0 to 1 of the gain that is reachable"));
            }
            _ => return Err(bad("objective", &format!("{clause:?}"), &expected)),
        }
    }
    let twice = (0..out.len()).find(|i| out[..*i].iter().any(|o| o.measure == out[*i].measure));
    if out.is_empty() || twice.is_some() {
        return Err(bad("objective", &format!("{text:?}"), "at least one measure, each once"));
    }
    if out.iter().any(|o| o.measure.measure == Measure::Score) && out.len() > 1 {
        return Err(bad("objective", &format!("{text:?}"), "`score` alone: it holds the others"));
    }
    Ok(out)
}

/// Measures with their weights in the composite score.
pub(super) fn score_terms(text: &str) -> Result<Vec<(Aim, f64)>, Error> {
    if text.trim().is_empty() {
        return Err(bad("score", "nothing", "measures with weights: `degree +1, depth -1`"));
    }
    let mut out = Vec::new();
    for clause in clauses(text) {
        let term = clause.split_once(char::is_whitespace).and_then(|(name, weight)| {
            let measure = name.parse::<Aim>().ok().filter(|a| a.measure.is_of_cells())?;
            Some((measure, weight.trim().parse::<f64>().ok().filter(|w| w.is_finite())?))
        });
        match term {
            Some((m, w)) if out.iter().all(|(o, _)| *o != m) => out.push((m, w)),
            _ => {
                return Err(bad(
                    "score",
                    &format!("{clause:?}"),
                    "`degree +1, depth -1, degree@entrance +1`, each once",
                ));
            }
        }
    }
    Ok(out)
}

/// Penalties with their weights.
pub(super) fn penalties(text: &str) -> Result<Vec<(Penalty, f64)>, Error> {
    let names = Penalty::ALL.map(Penalty::name).join(", ");
    let mut out = Vec::new();
    for clause in clauses(text).filter(|c| *c != "none") {
        let term = clause.split_once(char::is_whitespace).and_then(|(name, weight)| {
            let penalty = Penalty::ALL.into_iter().find(|p| p.name() == name)?;
            Some((penalty, weight.trim().parse::<f64>().ok().filter(|w| w.is_finite() && *w >= 0.0)?))
        });
        match term {
            Some((p, w)) if out.iter().all(|(o, _)| *o != p) => out.push((p, w)),
            _ => {
                let expected =
                    format!("`NAME WEIGHT` with a weight of 0 or more, each once; names: {names}; or `none`");
                return Err(bad("penalty", &format!("{clause:?}"), &expected));
            }
        }
    }
    Ok(out)
}
