//! Lines over axes: how the search went on, and what the spacing of the lattice changes.

use super::canvas::{Anchor, Canvas, MIN_SIDE_PX, Pen, size_error};
use super::font::{Weight, fitted, width_px};
use super::measure::{short, tick_labels, ticks};
use super::palette::{GREY, INK, PAPER, Rgb, option_style};
use enfilade_report::Error;

const GRID: Rgb = [0xe4, 0xe6, 0xea];
const CRITICAL: Rgb = INK;
/// Height of one panel over the width.
const PANEL_ASPECT: f32 = 0.22;
/// Width of a sheet that its letters and lines are made for.
const SHEET_PX: f32 = 1600.0;
/// Panels of a sheet at most: what fits a sheet.
pub const MAX_PANELS: usize = 8;

/// One value over the course of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it shows.
    pub name: String,
    /// Layouts measured and the value from then on, in order; values that are not finite interrupt the line.
    pub points: Vec<(u64, f64)>,
}

/// The values over the number of layouts measured, a panel and an axis each, as PNG; no more than
/// [`MAX_PANELS`] are drawn.
///
/// # Errors
/// `picture-size` for a size out of range, `png` if the encoder fails.
pub fn convergence_png(series: &[Series], longest_px: u32) -> Result<Vec<u8>, Error> {
    let series = &series[..series.len().min(MAX_PANELS)];
    let (head, foot) = (0.065, 0.08);
    let aspect = head + series.len().max(1) as f32 * PANEL_ASPECT + foot;
    let mut canvas = sheet((longest_px as f32 / aspect.max(1.0)) as u32, aspect)?;
    let width = canvas.size()[0] as f32;
    let u = unit_px(&canvas);
    heading(&mut canvas, "How the search went");
    let last = series.iter().flat_map(|s| &s.points).map(|p| p.0).max().unwrap_or(1).max(1);
    let values = ticks(0.0, last as f64, 8);
    let marks: Vec<(f64, String)> = values.iter().copied().zip(tick_labels(&values)).collect();
    for (i, one) in series.iter().enumerate() {
        let top = (head + i as f32 * PANEL_ASPECT) * width;
        let area = [140.0 * u, top + 56.0 * u, width - 50.0 * u, top + PANEL_ASPECT * width - 14.0 * u];
        let line = stairs(&one.points, last);
        let axes = Axes { x: [0.0, last as f64], ..Axes::over(line.iter(), area, u) };
        axes.draw(&mut canvas, 4);
        canvas.text(&one.name, [area[0], area[1] - 16.0 * u], Anchor::Left, (22.0 * u, Weight::Bold, INK));
        if i + 1 == series.len() {
            axes.draw_foot(&mut canvas, &marks, "layouts measured");
        }
        axes.draw_line(&mut canvas, &line, option_style(0));
    }
    canvas.into_png()
}

/// A value stays until the next one, and the last to the end.
fn stairs(points: &[(u64, f64)], last: u64) -> Vec<[f64; 2]> {
    let until = points.iter().skip(1).map(|p| p.0).chain([last]);
    points.iter().zip(until).flat_map(|((x, y), until)| [[*x as f64, *y], [until as f64, *y]]).collect()
}

/// One measure of a resolution study.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Name: `Visibility (degree)`.
    pub name: String,
    /// Spacing (metres, > 0), value and deviation (0 for one layout).
    pub points: Vec<[f64; 3]>,
    /// The same of layouts beside it, if there are any.
    pub sampled: Vec<[f64; 3]>,
}

impl Panel {
    /// Both lines, the one that is named second below.
    fn lines(&self) -> [&[[f64; 3]]; 2] {
        [&self.points, &self.sampled]
    }
}

/// The measures over the spacing of the lattice (logarithmic), one panel each, with deviations as
/// bars, as PNG. `legend` names the lines, in the order of a panel; `critical_m` is the coarsest spacing from which
/// they no longer change, if any.
///
/// # Errors
/// `picture-size` for a size out of range or more than [`MAX_PANELS`] panels, `png` if the encoder
/// fails.
pub fn resolution_png(
    panels: &[Panel],
    legend: &[String],
    critical_m: Option<f64>,
    longest_px: u32,
) -> Result<Vec<u8>, Error> {
    if panels.len() > MAX_PANELS {
        return Err(size_error(u32::MAX));
    }
    let count = panels.len().max(1) as f32;
    let (head, foot) = (0.115, 0.075);
    let aspect = head + count * PANEL_ASPECT + foot;
    let wide = (longest_px as f32 / aspect.max(1.0)) as u32;
    let mut canvas = sheet(wide, aspect)?;
    let [width, _] = canvas.size().map(|s| s as f32);
    let u = unit_px(&canvas);
    let subtitle = critical_m.map_or_else(
        || "No spacing studied is fine enough: the measures still change.".to_owned(),
        |s| format!("From {} m on, a finer lattice changes no measure by more than the tolerance.", short(s)),
    );
    heading(&mut canvas, "Critical resolution");
    let subtitle = fitted(&subtitle, 22.0 * u, Weight::Regular, width - 88.0 * u);
    canvas.text(&subtitle, [44.0 * u, 96.0 * u], Anchor::Left, (22.0 * u, Weight::Regular, GREY));
    draw_legend(&mut canvas, legend, critical_m.is_some());
    let x = log_range(panels);
    for (i, panel) in panels.iter().enumerate() {
        let top = (head + i as f32 * PANEL_ASPECT) * width;
        let area = [140.0 * u, top + 56.0 * u, width - 50.0 * u, top + PANEL_ASPECT * width - 14.0 * u];
        let is_last = i + 1 == panels.len();
        draw_panel(&mut canvas, panel, x, area, critical_m, is_last);
    }
    canvas.into_png()
}

/// What the lines are, in a row below the subtitle.
fn draw_legend(canvas: &mut Canvas, names: &[String], has_critical: bool) {
    let u = unit_px(canvas);
    // On a sheet whose letters are wider than its lines there is no room for it.
    if u * SHEET_PX > canvas.size()[0] as f32 {
        return;
    }
    let (y, size_px) = (138.0 * u, 22.0 * u);
    let critical = has_critical.then_some(("coarsest that is fine enough", CRITICAL, vec![8.0 * u, 6.0 * u]));
    let lines = names.iter().enumerate().map(|(i, name)| {
        let (colour, dash) = option_style(i);
        (name.as_str(), colour, dash_px(dash, 4.0 * u))
    });
    let mut x = 44.0 * u;
    for (name, colour, dash) in lines.chain(critical) {
        let pen = Pen { dash_px: &dash, ..Pen::solid(colour, 4.0 * u) };
        canvas.line(&[[x, y - 8.0 * u], [x + 48.0 * u, y - 8.0 * u]], pen);
        x += 60.0 * u;
        canvas.text(name, [x, y], Anchor::Left, (size_px, Weight::Regular, INK));
        x += width_px(name, size_px, Weight::Regular) + 40.0 * u;
    }
}

fn log_range(panels: &[Panel]) -> [f64; 2] {
    let spacings =
        panels.iter().flat_map(|p| p.lines()).flatten().map(|p| p[0].log10()).filter(|v| v.is_finite());
    let [lo, hi] = range(spacings);
    let pad = (hi - lo) * 0.03;
    [lo - pad, hi + pad]
}

fn draw_panel(
    canvas: &mut Canvas,
    panel: &Panel,
    x: [f64; 2],
    area: [f32; 4],
    critical_m: Option<f64>,
    is_last: bool,
) {
    let u = unit_px(canvas);
    let ends = panel.lines().into_iter().flatten();
    let ends: Vec<[f64; 2]> =
        ends.flat_map(|p| [[p[0].log10(), p[1] - p[2]], [p[0].log10(), p[1] + p[2]]]).collect();
    let axes = Axes { x, ..Axes::over(ends.iter(), area, u) };
    axes.draw(canvas, 4);
    canvas.text(&panel.name, [area[0], area[1] - 16.0 * u], Anchor::Left, (22.0 * u, Weight::Bold, INK));
    let seldom = panel.points.len().div_ceil(10).max(1);
    let marks: Vec<(f64, String)> =
        panel.points.iter().step_by(seldom).map(|p| (p[0].log10(), short(p[0]))).collect();
    if is_last {
        axes.draw_foot(canvas, &marks, "spacing of the lattice, m (finer to the left)");
    }
    if let Some(at) = critical_m.map(|s| axes.to_px([s.log10(), axes.y[0]])[0]).filter(|x| x.is_finite()) {
        let dash = [8.0 * u, 6.0 * u];
        let pen = Pen { dash_px: &dash, ..Pen::solid(CRITICAL, 3.0 * u) };
        canvas.line(&[[at, area[1]], [at, area[3]]], pen);
    }
    for bar in ends.chunks_exact(2) {
        canvas.line(&[axes.to_px(bar[0]), axes.to_px(bar[1])], Pen::solid(GREY, 2.0 * u));
    }
    // The drawing as it is lies on top.
    for (i, points) in panel.lines().into_iter().enumerate().rev() {
        let line: Vec<[f64; 2]> = points.iter().map(|p| [p[0].log10(), p[1]]).collect();
        let colour = option_style(i).0;
        axes.draw_line(canvas, &line, option_style(i));
        for p in &line {
            let [px, py] = axes.to_px(*p);
            canvas.line(&[[px - 2.0 * u, py], [px + 2.0 * u, py]], Pen::solid(colour, 9.0 * u));
        }
    }
}

/// Dashes of a line of some width.
fn dash_px(dash: &[f32], width_px: f32) -> Vec<f32> {
    dash.iter().map(|d| d * width_px * 0.7).collect()
}

fn sheet(width: u32, aspect: f32) -> Result<Canvas, Error> {
    if width < MIN_SIDE_PX {
        return Err(size_error(width));
    }
    Canvas::new(width, (width as f32 * aspect) as u32)
}

fn unit_px(canvas: &Canvas) -> f32 {
    (canvas.size()[0] as f32 / SHEET_PX).max(0.38)
}

fn heading(canvas: &mut Canvas, text: &str) {
    let u = unit_px(canvas);
    canvas.text(text, [44.0 * u, 60.0 * u], Anchor::Left, (34.0 * u, Weight::Bold, INK));
}

/// Smallest and largest finite value, apart from each other; `[0, 1]` if there are none.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite());
    let (lo, hi) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    match hi - lo {
        span if span > 0.0 => [lo, hi],
        0.0 => [lo - 0.5, hi + 0.5],
        _ => [0.0, 1.0],
    }
}

struct Axes {
    unit: f32,
    /// Left, top, right, bottom, px.
    area: [f32; 4],
    x: [f64; 2],
    y: [f64; 2],
}

impl Axes {
    fn over<'a>(points: impl Iterator<Item = &'a [f64; 2]> + Clone, area: [f32; 4], unit: f32) -> Self {
        let finite = points.filter(|p| p[0].is_finite() && p[1].is_finite());
        let x = range(finite.clone().map(|p| p[0]));
        let [lo, hi] = range(finite.map(|p| p[1]));
        let pad = (hi - lo) * 0.06;
        Self { unit, area, x, y: [lo - pad, hi + pad] }
    }

    fn to_px(&self, [x, y]: [f64; 2]) -> [f32; 2] {
        let [left, top, right, bottom] = self.area;
        let fx = ((x - self.x[0]) / (self.x[1] - self.x[0])) as f32;
        let fy = ((y - self.y[0]) / (self.y[1] - self.y[0])) as f32;
        [left + fx * (right - left), bottom - fy * (bottom - top)]
    }

    /// Horizontal rules with their values, and the line at the bottom.
    fn draw(&self, canvas: &mut Canvas, rules: usize) {
        let u = self.unit;
        let [left, _, right, bottom] = self.area;
        let values = ticks(self.y[0], self.y[1], rules);
        for (value, label) in values.iter().zip(tick_labels(&values)) {
            let y = self.to_px([self.x[0], *value])[1];
            canvas.line(&[[left, y], [right, y]], Pen::solid(GRID, 1.5 * u));
            let at = [left - 14.0 * u, y + 8.0 * u];
            canvas.text(&label, at, Anchor::Right, (22.0 * u, Weight::Regular, GREY));
        }
        canvas.line(&[[left, bottom], [right, bottom]], Pen::solid(GREY, 2.0 * u));
    }

    /// Marks below the bottom line and what they count; a label that would touch the one before is
    /// left out.
    fn draw_foot(&self, canvas: &mut Canvas, marks: &[(f64, String)], name: &str) {
        let u = self.unit;
        let [_, _, right, bottom] = self.area;
        let letters = (22.0 * u, Weight::Regular, GREY);
        let mut free_from = f32::NEG_INFINITY;
        for (value, label) in marks {
            let x = self.to_px([*value, self.y[0]])[0];
            canvas.line(&[[x, bottom], [x, bottom + 8.0 * u]], Pen::solid(GREY, 1.5 * u));
            let half = width_px(label, letters.0, letters.1) / 2.0;
            if x - half > free_from {
                canvas.text(label, [x, bottom + 34.0 * u], Anchor::Middle, letters);
                free_from = x + half + 8.0 * u;
            }
        }
        canvas.text(name, [right, bottom + 66.0 * u], Anchor::Right, letters);
    }

    fn draw_line(&self, canvas: &mut Canvas, line: &[[f64; 2]], (rgb, dash): (Rgb, &[f32])) {
        let width_px = 4.0 * self.unit;
        let dash = dash_px(dash, width_px);
        let pen = Pen { dash_px: &dash, ..Pen::solid(rgb, width_px) };
        for run in line.split(|p| !p[1].is_finite()).filter(|run| !run.is_empty()) {
            let px: Vec<[f32; 2]> = run.iter().map(|p| self.to_px(*p)).collect();
            canvas.line(&px, Pen::solid(PAPER, width_px * 1.8));
            canvas.line(&px, pen);
        }
    }
}
