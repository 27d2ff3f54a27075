//! Lines over axes: how the search went on.

use super::canvas::{Anchor, Canvas, Pen};
use super::font::{Weight, width_px};
use super::frame::Key;
use super::measure::{tick_labels, ticks};
use super::palette::{Rgb, option_style};
use super::picture::{GREY, INK, PAPER};
use crate::report::Error;

const GRID: Rgb = [0xe4, 0xe6, 0xea];
/// Height of a chart over its width.
const ASPECT: f32 = 0.56;

/// One line of a chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// What it shows.
    pub name: String,
    /// Points in order of x; y that are not finite interrupt the line.
    pub points: Vec<(u64, f64)>,
}

/// Words of a chart.
#[derive(Clone, Copy, Debug)]
pub struct Words<'a> {
    /// Headline.
    pub title: &'a str,
    /// What x counts.
    pub x: &'a str,
    /// What y shows.
    pub y: &'a str,
}

/// The best value found over the number of layouts measured, as PNG.
///
/// # Errors
/// `picture-size` for a size out of range, `png` if the encoder fails.
pub fn convergence_png(series: &[Series], longest_px: u32) -> Result<Vec<u8>, Error> {
    let words = Words { title: "How the search went on", x: "layouts measured", y: "" };
    let lines: Vec<Line<'_>> = series
        .iter()
        .map(|s| Line { name: &s.name, points: s.points.iter().map(|(x, y)| (*x as f64, *y)).collect() })
        .collect();
    chart_png(&lines, words, longest_px)
}

/// A named line in real numbers.
#[derive(Clone, Debug)]
pub(super) struct Line<'a> {
    pub name: &'a str,
    pub points: Vec<(f64, f64)>,
}

/// Draws lines over axes.
pub(super) fn chart_png(lines: &[Line<'_>], words: Words<'_>, longest_px: u32) -> Result<Vec<u8>, Error> {
    if longest_px < super::canvas::MIN_SIDE_PX {
        return Err(super::canvas::size_error(longest_px));
    }
    let mut canvas = Canvas::new(longest_px, (longest_px as f32 * ASPECT) as u32)?;
    let axes = Axes::over(lines, &canvas);
    axes.draw(&mut canvas, words);
    for (i, line) in lines.iter().enumerate() {
        axes.draw_line(&mut canvas, i, line);
    }
    axes.draw_keys(&mut canvas, lines);
    canvas.into_png()
}

struct Axes {
    unit: f32,
    /// Left, top, right, bottom, px.
    area: [f32; 4],
    x: [f64; 2],
    y: [f64; 2],
}

impl Axes {
    fn over(lines: &[Line<'_>], canvas: &Canvas) -> Self {
        let points = || lines.iter().flat_map(|l| &l.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        let span = |values: &mut dyn Iterator<Item = f64>| {
            let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
            if lo > hi {
                [0.0, 1.0]
            } else if lo == hi {
                [lo - 0.5, lo + 0.5]
            } else {
                [lo, hi]
            }
        };
        let x = span(&mut points().map(|p| p.0));
        let [lo, hi] = span(&mut points().map(|p| p.1));
        let pad = (hi - lo) * 0.06;
        let [width, height] = canvas.size().map(|s| s as f32);
        let unit = (width / 1600.0).max(0.5);
        let area = [120.0 * unit, 120.0 * unit, width - 50.0 * unit, height - 130.0 * unit];
        Self { unit, area, x, y: [lo - pad, hi + pad] }
    }

    fn to_px(&self, (x, y): (f64, f64)) -> [f32; 2] {
        let [left, top, right, bottom] = self.area;
        let fx = ((x - self.x[0]) / (self.x[1] - self.x[0])) as f32;
        let fy = ((y - self.y[0]) / (self.y[1] - self.y[0])) as f32;
        [left + fx * (right - left), bottom - fy * (bottom - top)]
    }

    fn draw(&self, canvas: &mut Canvas, words: Words<'_>) {
        let u = self.unit;
        let [left, top, right, bottom] = self.area;
        let letters = (22.0 * u, Weight::Regular, GREY);
        let values = ticks(self.y[0], self.y[1], 6);
        for (value, label) in values.iter().zip(tick_labels(&values)) {
            let y = self.to_px((self.x[0], *value))[1];
            canvas.line(&[[left, y], [right, y]], Pen::solid(GRID, 1.5 * u));
            canvas.text(&label, [left - 14.0 * u, y + 8.0 * u], Anchor::Right, letters);
        }
        let values = ticks(self.x[0], self.x[1], 8);
        for (value, label) in values.iter().zip(tick_labels(&values)) {
            let x = self.to_px((*value, self.y[0]))[0];
            canvas.line(&[[x, bottom], [x, bottom + 8.0 * u]], Pen::solid(GREY, 1.5 * u));
            canvas.text(&label, [x, bottom + 34.0 * u], Anchor::Middle, letters);
        }
        canvas.line(&[[left, bottom], [right, bottom]], Pen::solid(GREY, 2.0 * u));
        let title = (34.0 * u, Weight::Bold, INK);
        canvas.text(words.title, [44.0 * u, 60.0 * u], Anchor::Left, title);
        canvas.text(words.y, [44.0 * u, top - 16.0 * u], Anchor::Left, letters);
        canvas.text(words.x, [right, bottom + 66.0 * u], Anchor::Right, letters);
    }

    fn draw_line(&self, canvas: &mut Canvas, i: usize, line: &Line<'_>) {
        let (rgb, dash) = option_style(i);
        let width_px = 4.0 * self.unit;
        let dash: Vec<f32> = dash.iter().map(|d| d * width_px * 0.7).collect();
        let pen = Pen { dash_px: &dash, ..Pen::solid(rgb, width_px) };
        for run in line.points.split(|p| !p.1.is_finite()).filter(|run| !run.is_empty()) {
            let px: Vec<[f32; 2]> = run.iter().map(|p| self.to_px(*p)).collect();
            canvas.line(&px, Pen::solid(PAPER, width_px * 1.8));
            canvas.line(&px, pen);
        }
    }

    fn draw_keys(&self, canvas: &mut Canvas, lines: &[Line<'_>]) {
        let u = self.unit;
        let mut x = self.area[0];
        let y = self.area[3] + 92.0 * u;
        for (i, line) in lines.iter().enumerate() {
            let (rgb, dash) = option_style(i);
            let dash: Vec<f32> = dash.iter().map(|d| d * 2.2 * u).collect();
            let key = Key::line(line.name, Pen { dash_px: &dash, ..Pen::solid(rgb, 4.0 * u) });
            (key.draw)(canvas, [x, y - 18.0 * u, x + 36.0 * u, y + 2.0 * u]);
            canvas.text(&key.word, [x + 46.0 * u, y], Anchor::Left, (22.0 * u, Weight::Regular, INK));
            x += 80.0 * u + width_px(&key.word, 22.0 * u, Weight::Regular);
        }
    }
}
