//! The sheet: where the plan lies on it, title, scale bar, north arrow, keys.

use super::canvas::{Anchor, Canvas, MAX_SIDE_PX, MIN_SIDE_PX, Pen, path_of, size_error};
use super::font::{Weight, fitted};
use super::measure::{nice_at_most, number};
use super::palette::{GREY, INK, PAPER, Rgb};
use enfilade_report::{Error, Place};

/// Sheet size for which all sizes below are meant; other sizes scale with it.
const NOMINAL_SIDE_PX: f32 = 1600.0;
/// Letters and margins never get smaller than this share of their nominal size.
const SMALLEST_SCALE: f32 = 0.38;
/// Narrowest sheet at nominal size: legend, scale bar and north arrow stand side by side.
const NARROWEST_PX: f32 = 820.0;
const MARGIN_PX: f32 = 44.0;
const HEADER_PX: f32 = 112.0;
/// Smallest side of the box shown, metres: a plan without extent still has a scale.
const SMALLEST_EXTENT_M: f64 = 0.1;

/// Largest coordinate and extent drawn, metres: beyond it 32-bit pixels lose the plan, and no building is
/// that far from its origin.
pub const LARGEST_M: f64 = 1e9;

/// How the plan lies on the sheet.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Sheet, px.
    pub size_px: [u32; 2],
    /// One nominal pixel of margins and letters, px.
    pub unit_px: f32,
    /// Width of a wall line, px.
    pub line_px: f32,
    /// Pixels a metre.
    pub px_per_m: f64,
    /// The plan's box: left, top, right, bottom, px.
    pub plan_px: [f32; 4],
    origin_m: [f64; 2],
    north_deg: f64,
}

impl Frame {
    /// Lays the box `bounds` (metres) on a sheet whose longest side is at most `longest_px`; the foot
    /// gets `foot` nominal pixels. The same bounds and texts give the same frame for every content.
    ///
    /// # Errors
    /// `picture-size` for a size out of range, `picture-bounds` for bounds that do not exist.
    pub fn fit(bounds: [[f64; 2]; 2], longest_px: u32, titled: bool, foot: f32) -> Result<Self, Error> {
        if !(MIN_SIDE_PX..=MAX_SIDE_PX).contains(&longest_px) {
            return Err(size_error(longest_px));
        }
        let extent = [0, 1].map(|k| (bounds[1][k] - bounds[0][k]).max(SMALLEST_EXTENT_M));
        if !extent.iter().chain(bounds.as_flattened()).all(|v| v.abs() <= LARGEST_M) {
            let text = format!(
                "a plan from {:?} to {:?} m, expected coordinates within {LARGEST_M:e} m; no picture is made",
                bounds[0], bounds[1]
            );
            return Err(Error::input("picture-bounds", Place::default(), text));
        }
        let side = longest_px as f32;
        let unit = (side / NOMINAL_SIDE_PX).max(SMALLEST_SCALE);
        let margin = MARGIN_PX * unit;
        let top = if titled { HEADER_PX * unit + margin } else { margin };
        let bottom = foot * unit + margin;
        let room = [side - 2.0 * margin, side - top - bottom].map(|r| f64::from(r.max(16.0)));
        let px_per_m = (room[0] / extent[0]).min(room[1] / extent[1]);
        let plan = extent.map(|e| (e * px_per_m) as f32);
        let width = (plan[0] + 2.0 * margin).max((NARROWEST_PX * unit).min(side)).ceil();
        let height = (plan[1] + top + bottom).ceil().min(side);
        let left = ((width - plan[0]) / 2.0).floor();
        let line_px = (0.09 * px_per_m as f32).clamp(2.0 * unit, 5.0 * unit);
        Ok(Self {
            size_px: [width as u32, height as u32],
            unit_px: unit,
            line_px,
            px_per_m,
            plan_px: [left, top, left + plan[0], top + plan[1]],
            north_deg: 0.0,
            origin_m: [
                (bounds[0][0] + bounds[1][0]) / 2.0 - extent[0] / 2.0,
                (bounds[0][1] + bounds[1][1]) / 2.0 + extent[1] / 2.0,
            ],
        })
    }

    /// Where a point of the plan lies on the sheet (y down).
    pub fn to_px(&self, p: [f64; 2]) -> [f32; 2] {
        let x = f64::from(self.plan_px[0]) + (p[0] - self.origin_m[0]) * self.px_per_m;
        let y = f64::from(self.plan_px[1]) + (self.origin_m[1] - p[1]) * self.px_per_m;
        [x as f32, y as f32]
    }

    /// The box of the plan that is drawn, metres: what is shown and a rim wider than any line.
    pub fn visible_m(&self) -> [[f64; 2]; 2] {
        let [left, top, right, bottom] = self.plan_px.map(f64::from);
        let rim = f64::from(64.0 * self.unit_px) / self.px_per_m;
        let [wide, high] = [right - left, bottom - top].map(|v| v / self.px_per_m);
        let [x, y] = self.origin_m;
        [[x - rim, y - high - rim], [x + wide + rim, y + rim]]
    }

    /// The same frame with everything drawn that many pixels to the right and down.
    pub fn shifted(&self, [right, down]: [f32; 2]) -> Self {
        let [x, y] = self.origin_m;
        let by = [f64::from(right) / self.px_per_m, f64::from(down) / self.px_per_m];
        Self { origin_m: [x - by[0], y + by[1]], ..self.clone() }
    }

    /// A white sheet of that size.
    ///
    /// # Errors
    /// As [`Canvas::new`].
    pub fn sheet(&self) -> Result<Canvas, Error> {
        Canvas::new(self.size_px[0], self.size_px[1])
    }

    /// Top of the foot and the left and right end of its content, px.
    pub fn foot(&self) -> [f32; 3] {
        let margin = MARGIN_PX * self.unit_px;
        [self.plan_px[3] + 0.55 * margin, margin, self.size_px[0] as f32 - margin]
    }

    /// Whitens what lies outside the plan's box, then writes title and subtitle.
    pub fn head(&self, canvas: &mut Canvas, title: &str, subtitle: &str) {
        let [width, height] = canvas.size();
        let slack = (2.0 * self.line_px).ceil() as i32;
        let [left, top, right, bottom] = self.plan_px.map(|v| v.round() as i32);
        canvas.rect([0, 0, width, top - slack], PAPER);
        canvas.rect([0, bottom + slack, width, height], PAPER);
        canvas.rect([0, 0, left - slack, height], PAPER);
        canvas.rect([right + slack, 0, width, height], PAPER);
        let u = self.unit_px;
        let [_, from, to] = self.foot();
        let mut write = |text: &str, baseline: f32, size: f32, weight, rgb| {
            let text = fitted(text, size * u, weight, to - from);
            canvas.text(&text, [from, baseline * u], Anchor::Left, (size * u, weight, rgb));
        };
        write(title, MARGIN_PX + 36.0, 40.0, Weight::Bold, INK);
        write(subtitle, MARGIN_PX + 76.0, 25.0, Weight::Regular, GREY);
    }

    /// Scale bar with its right end at `[right, top]`; returns its left end, px.
    pub fn scale_bar(&self, canvas: &mut Canvas, right: f32, top: f32) -> f32 {
        let u = self.unit_px;
        let [_, from, to] = self.foot();
        let most_px = f64::from((250.0 * u).min(0.26 * (to - from)));
        let length_m = nice_at_most(most_px / self.px_per_m);
        let length = (length_m * self.px_per_m) as f32;
        let left = right - length;
        let [x0, xm, x1] = [left, left + length / 2.0, right].map(|x| x.round() as i32);
        let (y0, y1) = (top.round() as i32, (top + 10.0 * u).round() as i32);
        let rule = (2.0 * u).round().max(1.0) as i32;
        canvas.rect([x0, y0, x1, y1], INK);
        canvas.rect([xm, y0 + rule, x1 - rule, y1 - rule], PAPER);
        let label = (22.0 * u, Weight::Regular, INK);
        let baseline = top + 36.0 * u;
        canvas.text(&bar_label(length_m), [right, baseline], Anchor::Right, label);
        canvas.text("0", [left, baseline], Anchor::Left, label);
        left
    }

    /// The same frame of a plan whose north is turned, degrees anticlockwise from up.
    pub fn with_north(self, north_deg: f64) -> Self {
        Self { north_deg, ..self }
    }

    /// North arrow: its right end at `right`, its foot at `bottom` where it points up; returns its left end, px.
    pub fn north(&self, canvas: &mut Canvas, right: f32, bottom: f32) -> f32 {
        let u = self.unit_px;
        let (sin, cos) = (self.north_deg.to_radians().sin() as f32, self.north_deg.to_radians().cos() as f32);
        // Turned, it needs as much room on every side as it has in length.
        let (size, beside) = if self.north_deg == 0.0 { (u, 12.0) } else { (0.75 * u, 30.0) };
        let (x, y) = (right - beside * u, bottom - 23.0 * u);
        let at = |[a, b]: [f32; 2]| [x + size * (a * cos + b * sin), y + size * (b * cos - a * sin)];
        let half = [[0.0, -23.0], [12.0, 23.0], [0.0, 14.0]];
        let other = half.map(|p| at([-p[0], p[1]]));
        let half = half.map(at);
        if let Some(path) = path_of([(&half[..], true)]) {
            canvas.fill(&path, INK, 1.0);
        }
        let pen = Pen::solid(INK, 1.6 * u);
        canvas.line(&[other[0], other[1], other[2]], pen);
        let [nx, ny] = at([0.0, -38.0]);
        canvas.text("N", [nx, ny + 7.0 * u], Anchor::Middle, (20.0 * size, Weight::Bold, INK));
        x - beside * u
    }

    /// Keys in rows from the left; each is drawn by its function into the box it is given (left, top,
    /// right, bottom, px) and followed by its word. Returns the number of rows.
    pub fn keys(&self, canvas: &mut Canvas, top: f32, keys: &[Key<'_>]) -> usize {
        let u = self.unit_px;
        let [_, left, right] = self.foot();
        let letters = (22.0 * u, Weight::Regular, INK);
        let (mut x, mut row) = (left, 0);
        for key in keys {
            let wide = 46.0 * u + super::font::width_px(&key.word, letters.0, letters.1);
            if x > left && x + wide > right {
                (x, row) = (left, row + 1);
            }
            let y = top + row as f32 * 36.0 * u;
            (key.draw)(canvas, [x, y, x + 36.0 * u, y + 20.0 * u]);
            let word = fitted(&key.word, letters.0, letters.1, right - x - 46.0 * u);
            canvas.text(&word, [x + 46.0 * u, y + 18.0 * u], Anchor::Left, letters);
            x += wide + 34.0 * u;
        }
        row + 1
    }

    /// How many rows the keys would take, without drawing them.
    pub fn key_rows(size_px: f32, unit_px: f32, words: &[&str]) -> usize {
        let width = size_px - 2.0 * MARGIN_PX * unit_px;
        let (mut x, mut rows) = (0.0, 1);
        for word in words {
            let wide = 46.0 * unit_px + super::font::width_px(word, 22.0 * unit_px, Weight::Regular);
            if x > 0.0 && x + wide > width {
                (x, rows) = (0.0, rows + 1);
            }
            x += wide + 34.0 * unit_px;
        }
        rows
    }
}

/// Draws a sample into a box: left, top, right, bottom, px.
pub type Sample<'a> = Box<dyn Fn(&mut Canvas, [f32; 4]) + 'a>;

/// One entry of the keys.
pub struct Key<'a> {
    /// What it means.
    pub word: String,
    /// Draws its sample.
    pub draw: Sample<'a>,
}

impl<'a> Key<'a> {
    /// A key with a line as its sample.
    pub fn line(word: impl Into<String>, pen: Pen<'a>) -> Self {
        let draw = move |canvas: &mut Canvas, [x0, y0, x1, y1]: [f32; 4]| {
            let y = f32::midpoint(y0, y1);
            canvas.line(&[[x0, y], [x1, y]], pen);
        };
        Self { word: word.into(), draw: Box::new(draw) }
    }

    /// A key with a filled patch as its sample.
    pub fn patch(word: impl Into<String>, colour: impl Fn(i32, i32) -> Rgb + 'a) -> Self {
        let draw = move |canvas: &mut Canvas, box_px: [f32; 4]| {
            canvas.block(box_px.map(|v| v.round() as i32), &colour);
        };
        Self { word: word.into(), draw: Box::new(draw) }
    }
}

fn bar_label(length_m: f64) -> String {
    if length_m < 1.0 {
        return format!("{} cm", number_plain(length_m * 100.0));
    }
    format!("{} m", number_plain(length_m))
}

fn number_plain(value: f64) -> String {
    if value >= 1.0 { super::measure::fixed(value, 0) } else { number(value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_extent_fits_the_sheet() {
        let cases = [[5.0, 5.0], [500.0, 500.0], [500.0, 3.0], [2.0, 300.0], [0.0, 0.0], [1e7, 1.0]];
        for [w, h] in cases {
            for side in [MIN_SIDE_PX, 400, 1600, MAX_SIDE_PX] {
                let frame = Frame::fit([[3.0, -7.0], [3.0 + w, -7.0 + h]], side, true, 180.0).unwrap();
                assert!(frame.size_px.iter().all(|s| *s <= side), "{w} {h} {side}: {:?}", frame.size_px);
                let corner = frame.to_px([3.0 + w / 2.0, -7.0 + h / 2.0]);
                let [l, t, r, b] = frame.plan_px;
                assert!((corner[0] - (l + r) / 2.0).abs() < 1.0 && (corner[1] - (t + b) / 2.0).abs() < 1.0);
            }
        }
    }

    #[test]
    fn bounds_that_do_not_exist_are_an_error() {
        for x in [f64::NAN, f64::INFINITY, -2.0 * LARGEST_M] {
            let bad = Frame::fit([[0.0, 0.0], [1.0, x]], 400, true, 0.0);
            assert!(matches!(bad, Err(Error::Input(p)) if p.code == "picture-bounds"), "{x}");
        }
        let large = Frame::fit([[0.0, 0.0], [1.0, 1.0]], MAX_SIDE_PX + 1, true, 0.0);
        assert!(matches!(large, Err(Error::Usage(p)) if p.code == "picture-size"));
    }

    #[test]
    fn the_arrow_points_where_north_is() {
        let frame = Frame::fit([[0.0, 0.0], [8.0, 5.0]], 800, true, 180.0).unwrap();
        let drawn = |north_deg: f64| {
            let mut canvas = frame.sheet().unwrap();
            let left = frame.clone().with_north(north_deg).north(&mut canvas, 700.0, 400.0);
            (left, canvas.into_png().unwrap())
        };
        let up = drawn(0.0);
        assert_eq!(drawn(0.0), up);
        for (a, b) in [(17.0, -17.0), (90.0, -90.0), (180.0, 0.0)] {
            assert_ne!(drawn(a).1, drawn(b).1, "{a} {b}");
        }
        assert!(drawn(90.0).0 < up.0, "it needs more room");
    }

    #[test]
    fn the_scale_bar_is_labelled_in_round_lengths() {
        assert_eq!(bar_label(0.5), "50 cm");
        assert_eq!(bar_label(20.0), "20 m");
        assert_eq!(bar_label(0.005), "0.50 cm");
    }
}
