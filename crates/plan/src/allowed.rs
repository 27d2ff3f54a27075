//! Building works that marks allow, beside the moves: `open 0.9m 2.4m; remove` in the text of an `EF-MOVE` box, or as the
//! move that an element states.

use enfilade_brief::WorkKind;
use enfilade_cad::drawing::{Drawing, place};
use enfilade_engine::Region;
use enfilade_report::Report;

use super::length::length;

/// A kind of work that a mark allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllowedWork {
    /// The kind.
    pub kind: WorkKind,
    /// Clear widths that are allowed, metres; of an end how far it may go back and forth. `None`: any.
    pub range_m: Option<[f64; 2]>,
}

/// Where a mark allows works.
#[derive(Clone, Debug, PartialEq)]
pub enum AllowedAt {
    /// On stretches of wall inside an outline.
    Inside(Region),
    /// On the walls of a record.
    Record(usize),
}

/// What one mark allows.
#[derive(Clone, Debug, PartialEq)]
pub struct Allowed {
    /// Where.
    pub at: AllowedAt,
    /// What.
    pub works: Vec<AllowedWork>,
}

/// Whether a clause is one of works.
pub fn is_work(clause: &str) -> bool {
    clause.split_whitespace().next().and_then(kind_of).is_some()
}

/// Whether a text allows works and says no move: then all else moves as it would without it.
pub fn is_of_works_alone(text: &str) -> bool {
    let mut clauses = clauses(text).filter(|c| !is_name(c)).peekable();
    clauses.peek().is_some() && clauses.all(is_work)
}

/// The kind that a word names, in any case.
fn kind_of(word: &str) -> Option<WorkKind> {
    WorkKind::of_name(&word.to_lowercase())
}

fn is_name(clause: &str) -> bool {
    clause.split_whitespace().next().is_some_and(|w| w.eq_ignore_ascii_case("name"))
}

fn clauses(text: &str) -> impl Iterator<Item = &str> {
    text.split([';', '\n']).map(str::trim).filter(|c| !c.is_empty())
}

/// The works of a text; lengths without a unit are in drawing units of `unit_m` metres.
///
/// # Errors
/// What is wrong with the first clause of works that cannot be read.
pub fn works_in(text: &str, unit_m: f64) -> Result<Vec<AllowedWork>, String> {
    clauses(text).filter(|c| is_work(c)).map(|c| read(c, unit_m)).collect()
}

/// Reads `open`, `open 0.9m`, `open 0.9m 2.4m`, `end -1m 0`.
pub(super) fn read(clause: &str, unit_m: f64) -> Result<AllowedWork, String> {
    let clause = clause.replace(['−', '–'], "-");
    let mut words = clause.split_whitespace();
    let kind = words
        .next()
        .and_then(kind_of)
        .ok_or_else(|| format!("expected one of {}", WorkKind::ALL.map(WorkKind::name).join(", ")))?;
    let metres = |word: &str| length(word).map(|(v, unit)| v * unit.map_or(unit_m, |u| u.metres));
    let lengths: Vec<f64> = words.map(metres).collect::<Result<_, _>>()?;
    let is_width = kind != WorkKind::End;
    let range_m = match lengths[..] {
        [] => None,
        [only] if is_width => Some([only, only]),
        [only] => Some([only.min(0.0), only.max(0.0)]),
        [low, high] if low <= high => Some([low, high]),
        [low, high] => return Err(format!("found {low} m above {high} m, expected the smaller first")),
        _ => return Err("expected one width, or the smallest and the largest".into()),
    };
    match range_m {
        Some([low, _]) if is_width && low <= 0.0 => Err("expected a width above 0".into()),
        _ => Ok(AllowedWork { kind, range_m }),
    }
}

/// What elements of a building state of works; what cannot be read is reported.
pub(super) fn stated(drawing: &Drawing, unit_m: f64, report: &mut Report) -> Vec<Allowed> {
    let mut out = Vec::new();
    for mark in &drawing.marked {
        match works_in(&mark.text, unit_m) {
            Ok(works) if works.is_empty() => {}
            Ok(works) => out.push(Allowed { at: AllowedAt::Record(mark.record), works }),
            Err(why) => {
                let text = format!("{:?}: {why}; no work of it is allowed", mark.text);
                report.warn("move-clause", place(drawing, &mark.source), text);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn works_are_read_as_people_write_them() {
        for (text, kind, range) in [
            ("open 0.9m 2.4m", WorkKind::Open, Some([0.9, 2.4])),
            ("Open 900mm", WorkKind::Open, Some([0.9, 0.9])),
            ("remove", WorkKind::Remove, None),
            ("end −1m 0", WorkKind::End, Some([-1.0, 0.0])),
            ("end -0.5m", WorkKind::End, Some([-0.5, 0.0])),
            ("widen 1800", WorkKind::Widen, Some([1.8, 1.8])),
        ] {
            assert_eq!(read(text, 0.001), Ok(AllowedWork { kind, range_m: range }), "{text}");
        }
        for wrong in ["open 2m 1m", "open -1m", "open wide", "open 1 2 3"] {
            assert!(read(wrong, 1.0).is_err(), "{wrong}");
        }
        assert_eq!(works_in("x -1 1; open; name a", 1.0).unwrap().len(), 1);
        assert!(is_of_works_alone("open 1m\nremove; name a") && !is_of_works_alone("open; x -1 1"));
        assert!(!is_of_works_alone("name a") && !is_of_works_alone(""));
    }
}
