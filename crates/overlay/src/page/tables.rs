//! The numbers: measures, thresholds, moves, problems, and how to repeat the round.

use serde_json::{Map, Value};

use super::super::html::Html;
use super::super::measure::{number, parts, plain_name, sentence_case, short, trimmed, wording};
use super::super::options::{option_lines, told_measures};
use super::super::result::{Candidate, MoveEntry, Objective, ProblemEntry, RoundResult, Sense};
use super::super::words::{directions, parameter, range};
use super::cards::{change, delta};
use super::{ReportInput, is_by_score, names, option_name, wanted};
use enfilade_report::gathered;

/// Moves shown at once; a longer table is folded.
const MOVES_UNFOLDED: usize = 30;

/// A line an option: what moves, what is surely gained, how much is rebuilt.
pub fn options(html: &mut Html, result: &RoundResult) {
    let lines = option_lines(result);
    if lines.is_empty() {
        return;
    }
    let keys = told_measures(result);
    html.raw("<section>\n<h2>The options</h2>\n<div class=\"scroll\"><table class=\"options\">\n<thead><tr>");
    for heading in ["Option", "What changes"] {
        html.element("th", &[("scope", "col")], heading);
    }
    for heading in keys.iter().map(|k| plain_name(k)).chain(["Rebuilt".to_owned()]) {
        html.element("th", &[("scope", "col")], &heading);
    }
    html.raw("</tr></thead>\n<tbody>\n");
    for line in &lines {
        let card = line.option.map_or_else(|| "best".to_owned(), |o| o.to_string());
        html.raw("<tr><th scope=\"row\">").element("a", &[("href", &format!("#card-{card}"))], &line.name);
        html.raw("</th>").element("td", &[], &line.movers);
        for key in &keys {
            html.raw("<td>");
            match (result.initial.mean.get(key), line.mean.get(key)) {
                (Some(from), Some(now)) => change(html, (from, now), line.gain, (key, wanted(result, key))),
                _ => drop(html.text(&line.gained(result, key))),
            }
            html.raw("</td>");
        }
        html.raw("<td>").text(&trimmed(line.rebuilt_m, 1)).raw("\u{a0}m</td></tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n<p class=\"note\">Gains with their 95 % intervals, measured again on lattices that the search had not used. ▲ better, ▼ worse than the present layout. Rebuilt: metres of wall that stand elsewhere, are gone or are new.</p>\n</section>\n");
}

/// Every measure and penalty of every layout.
pub fn numbers(html: &mut Html, result: &RoundResult) {
    html.raw("<section>\n<h2>The numbers</h2>\n<details><summary>Every measure of every layout</summary>\n");
    html.raw("<div class=\"scroll\"><table class=\"numbers\">\n<thead><tr><th></th>");
    let means: Vec<&str> = result.initial.mean.0.iter().map(|(key, _)| key.as_str()).collect();
    let (penalties, zeros): (Vec<&str>, Vec<&str>) = result
        .initial
        .penalty
        .0
        .iter()
        .map(|(key, _)| key.as_str())
        .partition(|key| is_ever_set(result, key));
    let has_score = is_by_score(result);
    for key in means.iter().chain(has_score.then_some(&"score")).chain(&penalties) {
        let (plain, technical) = names(key);
        html.raw("<th scope=\"col\">").text(&plain).raw("<small>").text(&technical).raw("</small><small>");
        html.text(wording(parts(key).0).map_or("", |w| w.unit)).raw("</small></th>");
    }
    html.raw("</tr></thead>\n<tbody>\n<tr><th scope=\"row\">Present layout</th>");
    for key in &means {
        cell(html, result.initial.mean.get(key).map(|v| result.told(key, v)), None, None);
    }
    if has_score {
        cell(html, present_score(result), None, None);
    }
    for key in &penalties {
        cell(html, result.initial.penalty.get(key), None, None);
    }
    html.raw("</tr>\n");
    for (o, c) in result.candidates.iter().enumerate() {
        html.raw("<tr>").element("th", &[("scope", "row")], &option_name(o));
        for key in &means {
            let [now, from] = [&c.mean, &result.initial.mean].map(|mean| mean.get(key));
            html.raw("<td>").text(&now.map_or_else(|| "–".into(), |v| number(result.told(key, v))));
            if let (Some(now), Some(from)) = (now, from) {
                html.raw(" ");
                change(html, (from, now), &c.gain, (key, wanted(result, key)));
            }
            html.raw("</td>");
        }
        if has_score {
            cell(html, c.score, None, None);
        }
        for key in &penalties {
            cell(html, c.penalty.get(key), result.initial.penalty.get(key), wanted(result, key));
        }
        html.raw("</tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n");
    html.raw("<p class=\"note\">Means over the region of query; <a href=\"#measures\">every measure in plain words</a>. ▲ better, ▼ worse than the present layout.");
    if !zeros.is_empty() {
        let names: Vec<String> = zeros.iter().map(|key| plain_name(key).to_lowercase()).collect();
        html.raw(" Zero in every layout: ").text(&names.join(", ")).raw(".");
    }
    html.raw("</p>\n</details>\n</section>\n");
}

/// Whether a penalty differs from zero in any layout.
fn is_ever_set(result: &RoundResult, key: &str) -> bool {
    let all = result.candidates.iter().map(|c| &c.penalty).chain([&result.initial.penalty]);
    all.filter_map(|p| p.get(key)).any(|v| v.abs() > 1e-12)
}

/// The score of the present layout: its penalties, since it gains nothing over itself.
fn present_score(result: &RoundResult) -> Option<f64> {
    result.objectives.iter().find(|o| o.name == "score").map(|o| o.initial)
}

fn cell(html: &mut Html, value: Option<f64>, from: Option<f64>, sense: Option<Sense>) {
    html.raw("<td>").text(&value.map_or_else(|| "–".to_owned(), number));
    if let (Some(value), Some(from)) = (value, from) {
        html.raw(" ");
        delta(html, from, value, sense);
    }
    html.raw("</td>");
}

/// What was asked for and who keeps it.
pub fn thresholds(html: &mut Html, result: &RoundResult) {
    if result.objectives.is_empty() {
        return;
    }
    html.raw("<section>\n<h2>What was asked for</h2>\n<div class=\"scroll\"><table>\n<thead><tr>");
    html.raw("<th scope=\"col\">Objective</th><th scope=\"col\">Wanted</th><th scope=\"col\">Present</th>");
    // The search that reaches for thresholds only moves.
    let builds = result.candidates.iter().any(|c| !c.works.is_empty());
    let best = if builds { "Best by moves" } else { "Best found" };
    html.element("th", &[("scope", "col")], best).element("th", &[("scope", "col")], "Threshold");
    for o in 0..result.candidates.len() {
        html.element("th", &[("scope", "col"), ("class", "tick")], &option_name(o));
    }
    html.raw("</tr></thead>\n<tbody>\n");
    let is_firm = result.settings.get("thresholds").is_some_and(|t| t == "firm");
    for objective in &result.objectives {
        threshold_row(html, result, objective, is_firm);
    }
    html.raw("</tbody>\n</table></div>\n<p class=\"note\">A threshold keeps a share of the way from the present layout to the best one found that keeps the objectives above it; options may differ freely as long as they stay on its good side.");
    if !is_firm {
        html.raw(" It is set when the search turns to options that differ: what is found later turns none of them out.");
    }
    html.raw("</p>\n</section>\n");
}

fn threshold_row(html: &mut Html, result: &RoundResult, objective: &Objective, is_firm: bool) {
    let number = |value: f64| number(result.told(&objective.name, value));
    let (plain, technical) = names(&objective.name);
    html.raw("<tr><th scope=\"row\">").text(&plain).raw(" <small>").text(&technical).raw("</small></th>");
    let (wanted, bound) = match objective.sense {
        Sense::Max => ("more", "at least"),
        Sense::Min => ("less", "at most"),
    };
    html.element("td", &[("class", "word")], wanted);
    html.element("td", &[], &number(objective.initial));
    let or_none = |value: Option<f64>| value.map_or_else(|| "–".into(), number);
    html.raw("<td>").text(&or_none(objective.best));
    if let Some(reachable) = objective.reachable.filter(|r| objective.best.is_some_and(|b| b != *r)) {
        let what = if is_firm { "with the objectives above kept" } else { "when the threshold was set" };
        html.raw(" <small>").text(&number(reachable)).raw(" ").raw(what).raw("</small>");
    }
    html.raw("</td>");
    match objective.limit {
        Some(limit) => html.raw("<td>").text(bound).raw(" ").text(&number(limit)).raw(" <small>"),
        None => html.raw("<td>– <small>"),
    };
    html.text(&share_words(objective)).raw("</small></td>");
    for candidate in &result.candidates {
        match is_met(objective, candidate) {
            Some(true) => html.raw("<td class=\"tick met\">✓<span class=\"sr\"> met</span></td>"),
            Some(false) => html.raw("<td class=\"tick missed\">✗<span class=\"sr\"> missed</span></td>"),
            None => html.raw("<td class=\"tick\">–</td>"),
        };
    }
    html.raw("</tr>\n");
}

/// What a threshold asks for: a share of the gain, or of the little that the objectives above it leave.
fn share_words(objective: &Objective) -> String {
    let is_below_present = match objective.sense {
        Sense::Max => objective.limit.is_some_and(|limit| limit < objective.initial),
        Sense::Min => objective.limit.is_some_and(|limit| limit > objective.initial),
    };
    let of_gain = objective
        .limit
        .zip(objective.reachable)
        .map(|(limit, reachable)| (limit - objective.initial) / (reachable - objective.initial));
    let [asked, kept] = [objective.threshold, of_gain.unwrap_or(f64::NAN)].map(|share| short(share * 100.0));
    match (objective.threshold == 0.0, is_below_present) {
        (true, _) => "about as it is".into(),
        (false, true) => format!("{asked} % of the room that the objectives above leave; less than today"),
        (false, false) if of_gain.is_some_and(f64::is_finite) => format!("{kept} % of the gain"),
        (false, false) => format!("{asked} % of the gain"),
    }
}

/// Whether a candidate keeps an objective's threshold; `None` if its value is not among its numbers.
fn is_met(objective: &Objective, candidate: &Candidate) -> Option<bool> {
    let value = match objective.name.as_str() {
        // Thresholds are of means over several lattices, `mean` is of one: what is not surely missed is met.
        name if candidate.gain.contains_key(name) => {
            let turned = if objective.sense == Sense::Max { 1.0 } else { -1.0 };
            let present = if objective.initial == 0.0 { 1.0 } else { objective.initial.abs() };
            objective.initial + turned * candidate.gain[name].high * present
        }
        "score" => candidate.score?,
        name => candidate.mean.get(name).or_else(|| candidate.penalty.get(name))?,
    };
    let limit = objective.limit?;
    let slack = 1e-9 * limit.abs().max(1.0);
    Some(match objective.sense {
        Sense::Max => value >= limit - slack,
        Sense::Min => value <= limit + slack,
    })
}

/// How far each move goes in each option.
pub fn moves(html: &mut Html, result: &RoundResult) {
    if result.moves.is_empty() || result.candidates.is_empty() {
        return;
    }
    html.raw("<section>\n<h2>What moves, and by how much</h2>\n");
    let folded = result.moves.len() > MOVES_UNFOLDED;
    if folded {
        html.raw("<details><summary>").text(&result.moves.len().to_string()).raw(" moves</summary>\n");
    }
    html.raw(
        "<div class=\"scroll\"><table class=\"moves\">\n<thead><tr><th></th><th scope=\"col\" class=\"range\">may go</th>",
    );
    for o in 0..result.candidates.len() {
        html.element("th", &[("scope", "col")], &option_name(o));
    }
    html.raw("</tr></thead>\n<tbody>\n");
    for (i, entry) in result.moves.iter().enumerate() {
        html.raw("<tr><th scope=\"row\">").text(&sentence_case(&entry.name)).raw(" <small>");
        html.text(&way(entry, result.input.north_deg)).raw("</small></th>");
        html.element("td", &[("class", "range")], &range(entry));
        for candidate in &result.candidates {
            gauge(html, entry, candidate.parameters.get(i).copied());
        }
        html.raw("</tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n").raw(if folded { "</details>\n" } else { "" }).raw("</section>\n");
}

fn way(entry: &MoveEntry, north_deg: f64) -> String {
    use super::super::result::MoveKind;
    let toward = |deg: f64| {
        let [there, back] = directions(deg - north_deg);
        format!("{there} (+) or {back} (−)")
    };
    match entry.kind {
        MoveKind::X => toward(0.0),
        MoveKind::Y => toward(90.0),
        MoveKind::Along => "along its line".into(),
        MoveKind::Rotate => "turns, anticlockwise (+)".into(),
        MoveKind::Scale => "grows or shrinks".into(),
    }
}

/// A value with a bar from the present place to the new one within the bounds.
fn gauge(html: &mut Html, entry: &MoveEntry, value: Option<f64>) {
    let Some(value) = value else {
        html.raw("<td>–</td>");
        return;
    };
    let span = entry.upper - entry.lower;
    let place = |v: f64| if span > 0.0 { ((v - entry.lower) / span * 100.0).clamp(0.0, 100.0) } else { 50.0 };
    let (zero, now) = (place(entry.kind.identity()), place(value));
    let bar = format!("left:{:.1}%;width:{:.1}%", zero.min(now), (zero - now).abs());
    let mark = format!("left:{zero:.1}%");
    html.raw("<td><span class=\"value\">").text(&parameter(entry, value)).raw("</span>");
    html.raw("<span class=\"gauge\" aria-hidden=\"true\">").open("i", &[("style", &bar)]).raw("</i>");
    html.open("b", &[("style", &mark)]).raw("</b></span></td>");
}

/// What a person should decide, each answer with the option that gives it.
pub fn questions(html: &mut Html, result: &RoundResult) {
    if result.questions.is_empty() {
        return;
    }
    html.raw("<section class=\"questions\">\n<h2>Questions</h2>\n");
    for q in &result.questions {
        html.element("p", &[], &q.text).raw("<ul>\n");
        for a in &q.answers {
            html.raw("<li>").text(&a.text).raw(" ").element("code", &[], &a.option).raw("</li>\n");
        }
        html.raw("</ul>\n");
    }
    html.raw("</section>\n");
}

/// What was left out or assumed.
pub fn problems(html: &mut Html, input: &ReportInput<'_>) {
    let result = input.result;
    html.raw("<section>\n<h2>What was assumed or left out</h2>\n");
    html.raw("<p>Lengths are read in <b>").text(&result.input.unit).raw("</b>: ");
    html.text(&result.input.unit_reason).raw(".</p>\n");
    if result.problems.is_empty() {
        html.raw("<p>Nothing was left out.</p>\n</section>\n");
        return;
    }
    html.raw("<div class=\"scroll\"><table class=\"problems\">\n<tbody>\n");
    for severity in ["error", "warning", "info"] {
        // Works have a section of their own.
        let is_shown = |p: &&ProblemEntry| input.works.is_some() && p.code.starts_with("work");
        let of_severity = result.problems.iter().filter(|p| kind_of(p) == severity && !is_shown(p));
        for (p, others) in gathered(of_severity, |p| (&p.code, &p.text)) {
            html.open("tr", &[("class", severity)]).element("th", &[("scope", "row")], word_of(severity));
            html.raw("<td class=\"word\">").words(&p.text);
            if !p.place.is_empty() {
                html.raw("<code>").text(&p.place).raw("</code>");
            }
            places_of(html, &others);
            html.raw("</td>").element("td", &[("class", "code")], &p.code).raw("</tr>\n");
        }
    }
    html.raw("</tbody>\n</table></div>\n</section>\n");
}

/// The places of findings like the one before, folded away.
fn places_of(html: &mut Html, others: &[&ProblemEntry]) {
    if others.is_empty() {
        return;
    }
    html.raw("<details><summary>").text(&format!("{} more like it", others.len())).raw("</summary>");
    for p in others {
        html.raw("<code>").text(&p.place).raw("</code>");
    }
    html.raw("</details>");
}

fn kind_of(p: &ProblemEntry) -> &'static str {
    match p.severity.as_str() {
        "error" => "error",
        "warning" => "warning",
        _ => "info",
    }
}

fn word_of(severity: &str) -> &'static str {
    match severity {
        "error" => "Failed",
        "warning" => "Left out",
        _ => "Assumed",
    }
}

/// The command and the settings that make the same again.
pub fn repeat(html: &mut Html, input: &ReportInput<'_>) {
    html.raw("<section>\n<h2>To make the same again</h2>\n<p class=\"note\">In the drawing's folder:</p>\n<pre class=\"command\"><code>");
    html.text(input.command).raw("</code></pre>\n<details><summary>All settings</summary>\n");
    html.raw("<div class=\"scroll\"><table class=\"settings\">\n<tbody>\n");
    let mut rows = Vec::new();
    flatten("", &input.result.settings, &mut rows);
    rows.push(("sha256 of the drawing".to_owned(), input.result.input.sha256.clone()));
    for (name, value) in &rows {
        html.raw("<tr>").element("th", &[("scope", "row")], name).element("td", &[("class", "word")], value);
        html.raw("</tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n</details>\n</section>\n");
}

fn flatten(prefix: &str, map: &Map<String, Value>, rows: &mut Vec<(String, String)>) {
    for (key, value) in map {
        let name = if prefix.is_empty() { key.clone() } else { format!("{prefix}.{key}") };
        match value {
            Value::Object(inner) => flatten(&name, inner, rows),
            Value::String(text) => rows.push((name, text.clone())),
            Value::Null => rows.push((name, "–".to_owned())),
            other => rows.push((name, other.to_string())),
        }
    }
}
