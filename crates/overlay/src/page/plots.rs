//! Vector plots of the page: the layouts that were measured, and the course over the rounds.

use super::super::html::Html;
use super::super::measure::{is_told, number, plain_name, tick_labels, ticks};
use super::super::palette::{hex, option_style};
use super::super::result::{LineageEntry, Numbers, RoundResult};
use super::cards::delta;
use super::{ArchivePoint, Fitted, is_by_score, names, option_name, wanted};

/// Layouts drawn at most; a larger archive is thinned evenly, candidates stay.
pub const MAX_ARCHIVE_POINTS: usize = 500;
/// Axes drawn at most.
const MAX_AXES: usize = 8;
/// Area of a plot in its own units: width, height, margins left, top, right, bottom.
const WIDE: f64 = 720.0;
const HIGH: f64 = 330.0;
const LEFT: f64 = 56.0;
const TOP: f64 = 30.0;
const RIGHT: f64 = 20.0;
const BOTTOM: f64 = 46.0;

/// Values to places along one direction.
#[derive(Clone, Copy, Debug)]
struct Axis {
    lo: f64,
    hi: f64,
    /// Places of `lo` and `hi`.
    at: [f64; 2],
}

impl Axis {
    fn over(values: impl Iterator<Item = f64>, at: [f64; 2]) -> Self {
        let finite = values.filter(|v| v.is_finite());
        let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        match hi - lo {
            span if span > 0.0 => Self { lo: lo - span * 0.04, hi: hi + span * 0.04, at },
            0.0 => Self { lo: lo - 0.5, hi: hi + 0.5, at },
            _ => Self { lo: 0.0, hi: 1.0, at },
        }
    }

    fn place(&self, value: f64) -> f64 {
        self.at[0] + (value - self.lo) / (self.hi - self.lo) * (self.at[1] - self.at[0])
    }
}

fn px(value: f64) -> String {
    format!("{value:.1}")
}

fn open_svg(html: &mut Html, label: &str) {
    let view = format!("0 0 {WIDE} {HIGH}");
    html.open("svg", &[("viewBox", &view), ("role", "img"), ("aria-label", label), ("class", "plot")]);
    html.raw("\n");
}

fn line(html: &mut Html, class: &str, [x1, y1, x2, y2]: [f64; 4]) {
    let at = [x1, y1, x2, y2].map(px);
    html.open("line", &[("class", class), ("x1", &at[0]), ("y1", &at[1]), ("x2", &at[2]), ("y2", &at[3])]);
    html.raw("</line>\n");
}

fn label(html: &mut Html, class: &str, [x, y]: [f64; 2], text: &str) {
    html.element("text", &[("class", class), ("x", &px(x)), ("y", &px(y))], text);
}

fn polyline(html: &mut Html, class: &str, style: &str, points: &[[f64; 2]]) {
    let list: Vec<String> = points.iter().map(|p| format!("{},{}", px(p[0]), px(p[1]))).collect();
    html.open("polyline", &[("class", class), ("style", style), ("points", &list.join(" "))]);
    html.raw("</polyline>\n");
}

fn option_stroke(i: usize) -> String {
    let (rgb, dash) = option_style(i);
    let dash: Vec<String> = dash.iter().map(|d| px(f64::from(*d) * 2.0)).collect();
    let dash = if dash.is_empty() { "none".to_owned() } else { dash.join(" ") };
    format!("stroke:{};stroke-dasharray:{dash}", hex(rgb))
}

/// How the search went: its course, and every layout that was measured.
pub fn search(html: &mut Html, fitted: &Fitted<'_>) {
    let input = fitted.input;
    let axes = input.archive_axes.len().min(MAX_AXES);
    let has_archive = axes >= 2 && input.archive.len() >= 2;
    if fitted.convergence.is_none() && !has_archive {
        return;
    }
    html.raw("<section>\n<h2>How the search went</h2>\n<div class=\"pair\">\n");
    if let Some(png) = fitted.convergence {
        html.raw("<figure>\n").picture(png, "sheet", "Best values over the number of layouts measured");
        html.raw("</figure>\n");
    }
    if has_archive {
        let points = thinned(&input.archive);
        for [x, y] in plotted(&input.archive_axes[..axes]) {
            html.raw("<figure>\n");
            scatter(html, &points, [x, y], &input.archive_axes);
            html.raw(FRONT_WORDS).raw("</figure>\n");
        }
        html.raw("<figure class=\"wide\">\n");
        parallel(html, &points, &input.archive_axes[..axes]);
        html.raw("<figcaption>One line for each layout, one upright for each number.</figcaption>\n");
        keys(html, input.result.candidates.len());
        html.raw("</figure>\n");
    }
    html.raw("</div>\n</section>\n");
}

/// What a picture of two objectives shows.
const FRONT_WORDS: &str = "<figcaption>One dot for each layout that keeps the hard limits; a ring where none other is as good in \
    everything and better in something (the Pareto front); the options in colour.</figcaption>\n";

/// Pairs of objectives that are drawn against each other: of the first three that are no penalty, else the
/// first two.
fn plotted(axes: &[String]) -> Vec<[usize; 2]> {
    let wanted: Vec<usize> = (0..axes.len()).filter(|i| axes[*i] != "penalty").take(3).collect();
    match wanted[..] {
        [a, b, c] => vec![[a, b], [a, c], [b, c]],
        [a, b] => vec![[a, b]],
        _ => vec![[0, 1]],
    }
}

/// At most [`MAX_ARCHIVE_POINTS`] evenly spread points, then the front, candidates last (on top).
fn thinned(archive: &[ArchivePoint]) -> Vec<&ArchivePoint> {
    let spread = |is_front: bool| {
        let is_meant = |p: &&ArchivePoint| p.candidate.is_none() && p.is_front == is_front;
        let all: Vec<&ArchivePoint> = archive.iter().filter(is_meant).collect();
        let kept = all.len().min(MAX_ARCHIVE_POINTS);
        (0..kept).map(|i| all[i * all.len() / kept]).collect::<Vec<_>>()
    };
    let mut out = spread(false);
    out.extend(spread(true));
    out.extend(archive.iter().filter(|p| p.candidate.is_some()));
    out
}

fn keys(html: &mut Html, options: usize) {
    html.raw("<ul class=\"keys\">\n");
    for o in 0..options {
        html.raw("<li><svg viewBox=\"0 0 36 10\" aria-hidden=\"true\">");
        polyline(html, "option", &option_stroke(o), &[[1.0, 5.0], [35.0, 5.0]]);
        html.raw("</svg>").text(&option_name(o)).raw("</li>\n");
    }
    html.raw("</ul>\n");
}

fn scatter(html: &mut Html, points: &[&ArchivePoint], shown: [usize; 2], names: &[String]) {
    let value = |p: &ArchivePoint, k: usize| p.values.get(shown[k]).copied().unwrap_or(f64::NAN);
    let x = Axis::over(points.iter().map(|p| value(p, 0)), [LEFT, WIDE - RIGHT]);
    let y = Axis::over(points.iter().map(|p| value(p, 1)), [HIGH - BOTTOM, TOP]);
    let [name_x, name_y] = shown.map(|k| plain_name(&names[k]));
    open_svg(html, &format!("{name_y} over {name_x} of all layouts measured"));
    grid(html, x, y);
    label(html, "end", [WIDE - RIGHT, HIGH - 8.0], &name_x);
    label(html, "start", [LEFT, TOP - 12.0], &name_y);
    for p in points.iter().filter(|p| value(p, 0).is_finite() && value(p, 1).is_finite()) {
        let (cx, cy) = (px(x.place(value(p, 0))), px(y.place(value(p, 1))));
        let (class, r, style) = match p.candidate {
            Some(i) => ("chosen", "7", format!("fill:{}", hex(option_style(i).0))),
            None if p.is_front => ("front", "3.6", String::new()),
            None => ("dot", "2.6", String::new()),
        };
        html.open("circle", &[("class", class), ("cx", &cx), ("cy", &cy), ("r", r), ("style", &style)]);
        html.raw("</circle>\n");
    }
    html.raw("</svg>\n");
}

fn grid(html: &mut Html, x: Axis, y: Axis) {
    let values = ticks(y.lo, y.hi, 5);
    for (value, text) in values.iter().zip(tick_labels(&values)) {
        let at = y.place(*value);
        line(html, "rule", [x.at[0], at, x.at[1], at]);
        label(html, "end", [x.at[0] - 8.0, at + 4.0], &text);
    }
    let values = ticks(x.lo, x.hi, 6);
    for (value, text) in values.iter().zip(tick_labels(&values)) {
        let at = x.place(*value);
        line(html, "mark", [at, y.at[0], at, y.at[0] + 5.0]);
        label(html, "middle", [at, y.at[0] + 19.0], &text);
    }
    line(html, "mark", [x.at[0], y.at[0], x.at[1], y.at[0]]);
}

fn parallel(html: &mut Html, points: &[&ArchivePoint], names: &[String]) {
    let step = (WIDE - 2.0 * LEFT) / (names.len() - 1) as f64;
    let at = |k: usize| LEFT + step * k as f64;
    let axes: Vec<Axis> = (0..names.len())
        .map(|k| Axis::over(points.iter().filter_map(|p| p.values.get(k).copied()), [HIGH - BOTTOM, TOP]))
        .collect();
    open_svg(html, "All numbers of all layouts measured, side by side");
    for p in points {
        let places: Vec<[f64; 2]> = axes
            .iter()
            .zip(&p.values)
            .enumerate()
            .filter(|(_, (_, v))| v.is_finite())
            .map(|(k, (axis, v))| [at(k), axis.place(*v)])
            .collect();
        match p.candidate {
            Some(i) => polyline(html, "option", &option_stroke(i), &places),
            None => polyline(html, "thread", "", &places),
        }
    }
    for (k, (axis, name)) in axes.iter().zip(names).enumerate() {
        line(html, "mark", [at(k), TOP, at(k), HIGH - BOTTOM]);
        label(html, "middle", [at(k), TOP - 12.0], &number(axis.hi));
        label(html, "middle", [at(k), HIGH - BOTTOM + 16.0], &number(axis.lo));
        label(html, "middle strong", [at(k), HIGH - 8.0], &plain_name(name));
    }
    html.raw("</svg>\n");
}

/// One layout on the way from the first drawing to now.
struct Stop<'a> {
    what: String,
    mean: &'a Numbers,
    score: Option<f64>,
}

/// The course of the measures over the rounds, against the first drawing; nothing in a first round.
pub fn lineage(html: &mut Html, result: &RoundResult) {
    if result.lineage.is_empty() {
        return;
    }
    let mut stops: Vec<Stop<'_>> =
        result.lineage.iter().map(|l| Stop { what: from_words(l), mean: &l.mean, score: l.score }).collect();
    stops.push(Stop { what: "This round’s drawing".to_owned(), mean: &result.initial.mean, score: None });
    if let Some(best) = result.candidates.first() {
        stops.push(Stop { what: "Option 1 of this round".to_owned(), mean: &best.mean, score: best.score });
    }
    html.raw("<section>\n<h2>The course over the rounds</h2>\n");
    let is_one_ruler = result.lineage.iter().all(|l| !l.other_ruler);
    if is_one_ruler {
        lineage_plot(html, &stops);
    } else {
        html.raw("<p class=\"note\">Spacing or regions have changed since, or grid, unit, storey, height or drawing on the sheet are asked for otherwise: values of earlier rounds are means over other places, and are not compared.</p>\n");
    }
    lineage_table(html, result, &stops, is_one_ruler);
    html.raw("</section>\n");
}

fn from_words(l: &LineageEntry) -> String {
    let (drawing, round) = (&l.drawing, l.round);
    let of = if l.so_far { "Best so far of a stopped search".to_owned() } else { format!("Round {round}") };
    if let Some(point) = l.point {
        return format!("{of}: {drawing} (point {point} accepted)");
    }
    match l.candidate {
        Some(0) => format!("{of}: {drawing} (best layout accepted)"),
        Some(c) => format!("{of}: {drawing} (option {c} accepted)"),
        None => format!("{of}: {drawing}"),
    }
}

/// A measure's change over the stops, in per cent of the first.
struct Course<'a> {
    key: &'a str,
    points: Vec<[f64; 2]>,
}

fn courses<'a>(stops: &[Stop<'a>]) -> Vec<Course<'a>> {
    let told = stops[0].mean.0.iter().filter(|(key, from)| is_told(key) && *from != 0.0);
    told.map(|(key, from)| {
        let change = |(i, stop): (usize, &Stop<'_>)| {
            Some([i as f64, (stop.mean.get(key)? - from) / from.abs() * 100.0])
        };
        let points = stops.iter().enumerate().filter_map(change).filter(|p| p[1].is_finite()).collect();
        Course { key, points }
    })
    .collect()
}

fn lineage_plot(html: &mut Html, stops: &[Stop<'_>]) {
    let courses = courses(stops);
    let x = Axis { lo: 0.0, hi: (stops.len() - 1) as f64, at: [LEFT, WIDE - 190.0] };
    let y = Axis::over(courses.iter().flat_map(|c| &c.points).map(|p| p[1]), [HIGH - BOTTOM, TOP]);
    open_svg(html, "Change of the measures over the rounds, in per cent of the first drawing");
    let values = ticks(y.lo, y.hi, 5);
    for (value, text) in values.iter().zip(tick_labels(&values)) {
        let (at, class) = (y.place(*value), if *value == 0.0 { "mark" } else { "rule" });
        line(html, class, [x.at[0], at, x.at[1], at]);
        label(html, "end", [x.at[0] - 8.0, at + 4.0], &text);
    }
    label(html, "start", [LEFT, TOP - 12.0], "% against the first drawing");
    for i in 0..stops.len() {
        label(html, "middle", [x.place(i as f64), HIGH - BOTTOM + 20.0], &(i + 1).to_string());
    }
    let mut taken: Vec<f64> = Vec::new();
    for (i, course) in courses.iter().enumerate() {
        let places: Vec<[f64; 2]> = course.points.iter().map(|p| [x.place(p[0]), y.place(p[1])]).collect();
        polyline(html, "option", &option_stroke(i), &places);
        if let Some(last) = places.last() {
            course_name(html, course.key, i, *last, &mut taken);
        }
    }
    html.raw("</svg>\n");
}

/// Writes a measure's name at the end of its line, below the names that are `taken` already.
fn course_name(html: &mut Html, key: &str, i: usize, end: [f64; 2], taken: &mut Vec<f64>) {
    let mut y = end[1] + 4.0;
    while taken.iter().any(|t| (t - y).abs() < 15.0) {
        y += 3.0;
    }
    taken.push(y);
    let style = format!("fill:{}", hex(option_style(i).0));
    let (plain, technical) = names(key);
    html.open("text", &[("x", &px(end[0] + 10.0)), ("y", &px(y)), ("style", &style)]).text(&plain);
    html.raw(" <tspan>").text(&technical).raw("</tspan>").close("text");
}

fn lineage_table(html: &mut Html, result: &RoundResult, stops: &[Stop<'_>], is_one_ruler: bool) {
    html.raw("<div class=\"scroll\"><table class=\"numbers\">\n<thead><tr><th></th><th></th>");
    let mut keys: Vec<&String> = Vec::new();
    for (key, _) in stops.iter().flat_map(|s| &s.mean.0) {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    for key in &keys {
        html.element("th", &[("scope", "col")], &plain_name(key));
    }
    let has_score = is_by_score(result);
    if has_score {
        html.raw("<th scope=\"col\">Score</th>");
    }
    html.raw("</tr></thead>\n<tbody>\n");
    for (i, stop) in stops.iter().enumerate() {
        html.raw("<tr>").element("td", &[], &(i + 1).to_string());
        html.element("th", &[("scope", "row")], &stop.what);
        for key in &keys {
            let (value, first) = (stop.mean.get(key), stops[0].mean.get(key));
            html.raw("<td>").text(&value.map_or_else(|| "–".to_owned(), number));
            if let (Some(value), Some(first), true) = (value, first, i > 0 && is_one_ruler) {
                html.raw(" ");
                delta(html, first, value, wanted(result, key));
            }
            html.raw("</td>");
        }
        if has_score {
            html.element("td", &[], &stop.score.map_or_else(|| "–".to_owned(), number));
        }
        html.raw("</tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objectives_are_drawn_against_each_other() {
        let axes = |names: &[&str]| plotted(&names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>());
        assert_eq!(axes(&["penalty", "degree", "depth", "entropy", "reach"]), [[1, 2], [1, 3], [2, 3]]);
        assert_eq!(axes(&["degree", "depth"]), [[0, 1]]);
        assert_eq!(axes(&["penalty", "degree"]), [[0, 1]]);
    }

    #[test]
    fn a_large_archive_is_thinned_but_keeps_the_options() {
        let mut archive = vec![ArchivePoint::default(); MAX_ARCHIVE_POINTS + 70];
        archive[3].candidate = Some(0);
        let shown = thinned(&archive);
        assert_eq!(shown.len(), MAX_ARCHIVE_POINTS + 1);
        assert_eq!(shown.last().map(|p| p.candidate), Some(Some(0)));
    }
}
