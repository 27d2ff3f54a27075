//! Verdicts for results: numbers, words, places.

use crate::job::Input;
use crate::understand::understood::Understood;
use crate::write::show;
use enfilade_demands::{Answer, Building, Finding, Mark, Origin, RoomId, Verdict, bound_of};
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_overlay::brief::{BRIEF_SCHEMA, BriefResult, BriefRoom};
use enfilade_overlay::brief_item::{BriefFinding, BriefItem, BriefOrigin};

/// Everything as JSON has it.
pub(super) fn result(
    base: &Understood,
    input: &Input<'_>,
    building: &Building,
    answers: &[Answer],
) -> BriefResult {
    let room = |(k, r): (usize, &enfilade_demands::Room)| BriefRoom {
        id: k + 1,
        name: r.name.clone().unwrap_or_default(),
        kind: r.kind.name().into(),
    };
    BriefResult {
        schema: BRIEF_SCHEMA.into(),
        version: enfilade_config::VERSION.into(),
        input: show::input(&base.plan, input),
        rooms: building.rooms.iter().enumerate().map(room).collect(),
        items: answers.iter().enumerate().map(|(k, a)| item(building, k + 1, a)).collect(),
    }
}

fn item(building: &Building, id: usize, answer: &Answer) -> BriefItem {
    let demand = &answer.asked.demand;
    let (row, bound) = (demand.kind.entry(), bound_of(demand));
    BriefItem {
        id,
        ask: demand.to_string(),
        weight: demand.weight.name().into(),
        kind: row.word.into(),
        unit: Some(row.unit),
        wanted: bound.words(row.unit).unwrap_or_default(),
        least: bound.least,
        most: bound.most,
        verdict: verdict(answer.verdict).into(),
        origin: origin(&answer.asked.origin),
        findings: answer.findings.iter().map(|f| finding(building, answer, f)).collect(),
    }
}

fn origin(origin: &Origin) -> Option<BriefOrigin> {
    match origin {
        Origin::Said => None,
        Origin::Rule { rule, title, place } => {
            Some(BriefOrigin { name: rule.clone(), title: title.clone(), place: place.clone() })
        }
        Origin::Drawing(name) => Some(BriefOrigin { name: name.clone(), ..BriefOrigin::default() }),
    }
}

fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Pass => "pass",
        Verdict::Fail => "fail",
        Verdict::Untold => "untold",
    }
}

fn finding(building: &Building, answer: &Answer, found: &Finding) -> BriefFinding {
    let mut out = BriefFinding {
        verdict: verdict(found.verdict).into(),
        rooms: found.rooms.iter().map(|r| r.0 + 1).collect(),
        openings: found.openings.iter().map(|o| o.0).collect(),
        measured: found.measured.map(|v| (v * 1e6).round() / 1e6 + 0.0),
        words: words(building, answer, found),
        ..BriefFinding::default()
    };
    let ring = |r: &Vec<PointUm>| r.iter().map(|p| metres(*p)).collect();
    for mark in &found.marks {
        match mark {
            Mark::Ground(rings) => out.ground.extend(rings.iter().map(ring)),
            Mark::Line(line) => out.lines.push(ring(line)),
            Mark::Circle(at, radius) => {
                let [x, y] = metres(*at);
                out.circles.push([x, y, *radius as f64 / UM_PER_M]);
            }
        }
    }
    out
}

/// `Kitchen (room 9): area 7.20 m²; at least 8 m² wanted.`
fn words(building: &Building, answer: &Answer, found: &Finding) -> String {
    let demand = &answer.asked.demand;
    let row = demand.kind.entry();
    let rooms: Vec<String> = found.rooms.iter().map(|r| room_words(building, *r)).collect();
    let value = found.measured.map(|v| format!("{} {}", row.plain, row.unit.words(v)));
    // Where there is nothing to measure, the note says all.
    let is_bare = found.measured.is_none() && found.note.is_some();
    let wanted = bound_of(demand).words(row.unit).filter(|_| found.verdict != Verdict::Pass && !is_bare);
    let wanted = wanted.map(|w| format!("{w} wanted"));
    let facts: Vec<String> = [value, wanted].into_iter().flatten().collect();
    let said = match (rooms.is_empty(), facts.is_empty()) {
        (true, true) => String::new(),
        (true, false) => format!("{}.", facts.join("; ")),
        (false, true) => format!("{}.", rooms.join(", ")),
        (false, false) => format!("{}: {}.", rooms.join(", "), facts.join("; ")),
    };
    let note = found.note.clone().unwrap_or_default();
    format!("{said} {note}").trim().to_owned()
}

fn room_words(building: &Building, id: RoomId) -> String {
    let room = building.room(id);
    match &room.name {
        Some(name) => format!("{name} (room {})", id.0 + 1),
        None => format!("room {}", id.0 + 1),
    }
}

fn metres(p: PointUm) -> [f64; 2] {
    p.map(|v| (v as f64 / UM_PER_M * 1e3).round() / 1e3 + 0.0)
}

/// Metres of the drawing frame in the plan's.
pub(crate) fn plan_from_metres(base: &Understood, p: [f64; 2]) -> [f64; 2] {
    base.plan.frame.plan_from_um(p.map(|v| (v * UM_PER_M).round() as i64)).to_array()
}
