//! Storeys of a building, and which of them is meant by what somebody types.

use crate::names::{Found, Pattern, folded};
use crate::step_text::decoded;
use enfilade_report::{Error, Place, Report, counted};

/// A storey of a building.
#[derive(Clone, Debug, PartialEq)]
pub struct StoreyInfo {
    /// Its name, as `--storey` takes it.
    pub name: String,
    /// The building that it belongs to, where the file has storeys of several.
    pub building: Option<String>,
    /// Height of its floor, metres.
    pub floor_m: f64,
    /// Walls that stand in it.
    pub walls: usize,
    /// Height of the highest point of its own walls and columns, metres, below everything where it has none; none where that
    /// is not known or no other storey begins below the eyes of who stands in it.
    pub top_m: Option<f64>,
}

/// A storey that begins so near above another one is that one.
const SAME_FLOOR_M: f64 = 0.05;

/// The storey that begins so low above the floor of another one that a cut at `above_m` shows it, and none of that one's own
/// walls: footings, a crawl space.
pub fn shown_instead(storeys: &[StoreyInfo], index: usize, above_m: f64) -> Option<&StoreyInfo> {
    let own = storeys.get(index)?;
    let cut = own.floor_m + above_m;
    own.top_m.filter(|top| *top <= cut)?;
    storeys.iter().find(|s| s.walls > 0 && is_over(own.floor_m, s.floor_m, above_m))
}

/// Whether a floor lies over another one, and below a cut above that.
pub(super) fn is_over(floor_m: f64, other_m: f64, above_m: f64) -> bool {
    other_m > floor_m + SAME_FLOOR_M && other_m <= floor_m + above_m
}

/// The storey that is read where none is named: of those whose own walls are cut the one with most, the highest of several.
pub fn main_storey(storeys: &[StoreyInfo], above_m: f64) -> Option<usize> {
    let worth = |i: &usize| (shown_instead(storeys, *i, above_m).is_none(), storeys[*i].walls);
    (0..storeys.len()).rev().max_by_key(worth)
}

/// Refuses a storey of which a cut at `above_m` shows another one alone.
pub(super) fn refuse_without_own(
    file: &str,
    storeys: &[StoreyInfo],
    index: usize,
    above_m: f64,
) -> Result<(), Error> {
    let Some((own, other)) = storeys.get(index).zip(shown_instead(storeys, index, above_m)) else {
        return Ok(());
    };
    let lacks = match own.top_m.filter(|t| t.is_finite()) {
        Some(top) => format!("its own walls end at {top:.2} m and do not reach"),
        None => "it has no walls of its own at".into(),
    };
    let text = format!(
        "storey \"{}\": {lacks} the cut at {:.2} m, {above_m:.2} m above its floor; what stands there is of \"{}\", whose floor is \
         at {:.2} m; nothing was measured; --storey \"{}\" shows that one",
        own.name,
        own.floor_m + above_m,
        other.name,
        other.floor_m,
        storey_key(storeys, storeys.iter().position(|s| s == other).unwrap_or(index))
    );
    Err(Error::input("no-walls", Place::file(file), text))
}

/// Which of the storeys is meant, names from the lowest: by its name to the letter, else by its name whatever its
/// case, way of storing accents and STEP escapes, else by its number from 1 or its folder (`storey-1`), else by its name
/// without accents and blanks where that is only one's. Of several of one name the lowest, see [`storeys_at`].
pub fn storey_at<'n>(names: impl Iterator<Item = &'n str>, wanted: &str) -> Option<usize> {
    storeys_at(&names.collect::<Vec<_>>(), wanted).first().copied()
}

/// All the storeys that a name or number fits as [`storey_at`] finds them, from the lowest: several where they have one
/// name.
pub fn storeys_at(names: &[&str], wanted: &str) -> Vec<usize> {
    let all = |fits: &dyn Fn(&str) -> bool| -> Vec<usize> {
        (0..names.len()).filter(|i| fits(names[*i])).collect()
    };
    let by_name = |wanted: &str| {
        let wanted = folded(wanted);
        all(&|n| folded(n) == wanted)
    };
    let number = || -> Vec<usize> {
        let number = folded(wanted).trim_start_matches("storey-").parse::<usize>().ok();
        number.and_then(|n| n.checked_sub(1)).filter(|i| *i < names.len()).into_iter().collect()
    };
    let exact = all(&|n| n == wanted);
    let mut ways = [exact, by_name(wanted), by_name(&decoded(wanted)), number()].into_iter();
    ways.find(|found| !found.is_empty()).unwrap_or_else(|| alike(names, wanted).hits)
}

/// The storeys whose names are those wanted but for accents and blanks.
fn alike(names: &[&str], wanted: &str) -> Found {
    let all: Vec<Vec<&str>> = names.iter().map(|n| vec![*n]).collect();
    Pattern::name(&decoded(wanted)).map_or_else(|_| Found::default(), |p| Found::of(&all, &p))
}

/// Why no storey is meant by a name, with those that there are; `none` where there are none.
pub fn no_storey(storeys: &[StoreyInfo], wanted: &str, none: &str) -> String {
    let names: Vec<&str> = storeys.iter().map(|s| s.name.as_str()).collect();
    let rivals = alike(&names, wanted).rivals;
    let found = match rivals.is_empty() {
        true => "no such storey".to_string(),
        false => format!("found several that are so called without accents and blanks ({})", quoted(&rivals)),
    };
    let present = if storeys.is_empty() { none.to_string() } else { listed(storeys) };
    format!("{found}, storeys present, by number and name: {present}; nothing was done")
}

/// Names in quotes, one after the other.
pub fn quoted(names: &[String]) -> String {
    names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(", ")
}

/// How `--storey` names one of the storeys and no other: by its name, by its number where others have the same name.
pub fn storey_key(storeys: &[StoreyInfo], index: usize) -> String {
    let names: Vec<&str> = storeys.iter().map(|s| s.name.as_str()).collect();
    let name = names.get(index).copied().unwrap_or_default();
    let ways = [name.to_string(), format!("storey-{}", index + 1), (index + 1).to_string()];
    ways.into_iter().find(|way| storeys_at(&names, way) == [index]).unwrap_or_else(|| name.into())
}

/// Says which of several storeys is read where none was named.
pub(super) fn state_taken(file: &str, storeys: &[StoreyInfo], taken: &StoreyInfo, report: &mut Report) {
    let text = format!(
        "storeys: {}; {} has the most walls and was taken, --storey NAME takes another",
        listed(storeys),
        called(taken)
    );
    report.info("storey", Place::file(file), text);
}

/// Says where a storey is cut: so many metres above its floor, which is at a height in metres.
pub(super) fn state_cut(file: &str, name: &str, [above_m, floor_m]: [f64; 2], report: &mut Report) {
    let text = format!("storey \"{name}\" cut {above_m:.2} m above its floor at {floor_m:.3} m");
    report.info("storey-cut", Place::file(file), text);
}

/// Says so where a storey was named that others share the name of.
pub(super) fn state_shared_name(file: &str, storeys: &[StoreyInfo], wanted: &str, report: &mut Report) {
    let names: Vec<&str> = storeys.iter().map(|s| s.name.as_str()).collect();
    let found = storeys_at(&names, wanted);
    if found.len() < 2 {
        return;
    }
    let keys: Vec<String> = found
        .iter()
        .map(|i| {
            let of =
                storeys[*i].building.as_ref().map_or_else(String::new, |name| format!("of \"{name}\", "));
            format!("{} ({of}floor {:.3} m)", storey_key(storeys, *i), storeys[*i].floor_m)
        })
        .collect();
    let text = format!(
        "--storey \"{wanted}\": found {} storeys of that name, expected one; the lowest was taken; by number: {}",
        found.len(),
        keys.join(", ")
    );
    report.warn("storey-name", Place::file(file), text);
}

/// A storey as messages name it, with its building where there are several.
fn called(StoreyInfo { name, building, .. }: &StoreyInfo) -> String {
    building.as_ref().map_or_else(|| format!("\"{name}\""), |of| format!("\"{name}\" of \"{of}\""))
}

/// Storeys as a message lists them: the number and the name, both as `--storey` takes them.
pub fn listed(storeys: &[StoreyInfo]) -> String {
    let of = |(i, s): (usize, &StoreyInfo)| {
        let name = called(s);
        format!("{} {name} (floor {:.3} m, {})", i + 1, s.floor_m, counted(s.walls as u64, "wall"))
    };
    storeys.iter().enumerate().map(of).collect::<Vec<_>>().join(", ")
}
