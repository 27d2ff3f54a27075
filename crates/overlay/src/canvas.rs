//! A picture being drawn: pixels, paths and text over tiny-skia, PNG at the end.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform,
};

use super::font::{self, Weight};
use super::palette::Rgb;
use enfilade_report::{Error, Place};

/// Longest side of a picture, px: 6000 × 6000 takes 144 MB while it is drawn, and prints A2 at 250 dpi.
pub const MAX_SIDE_PX: u32 = 6000;
/// Shortest accepted longest side, px: less has no room for a legend.
pub const MIN_SIDE_PX: u32 = 160;

/// Where text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The point is the left end.
    Left,
    /// The point is the middle.
    Middle,
    /// The point is the right end.
    Right,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub struct Pen<'a> {
    /// Colour.
    pub rgb: Rgb,
    /// 0 (invisible) to 1.
    pub opacity: f32,
    /// Width, px.
    pub width_px: f32,
    /// Lengths of strokes and gaps, px; empty is solid.
    pub dash_px: &'a [f32],
}

impl Pen<'_> {
    /// A solid, opaque line.
    pub fn solid(rgb: Rgb, width_px: f32) -> Self {
        Self { rgb, opacity: 1.0, width_px, dash_px: &[] }
    }
}

/// A white sheet of pixels; y grows downwards.
pub struct Canvas {
    pixels: Pixmap,
}

impl Canvas {
    /// A white sheet.
    ///
    /// # Errors
    /// `picture-size` if a side is 0 or above [`MAX_SIDE_PX`].
    pub fn new(width_px: u32, height_px: u32) -> Result<Self, Error> {
        let fits = |side: u32| (1..=MAX_SIDE_PX).contains(&side);
        let pixels = if fits(width_px) && fits(height_px) { Pixmap::new(width_px, height_px) } else { None };
        let mut pixels = pixels.ok_or_else(|| size_error(width_px.max(height_px)))?;
        pixels.fill(Color::WHITE);
        Ok(Self { pixels })
    }

    /// Width and height, px.
    pub fn size(&self) -> [i32; 2] {
        [self.pixels.width() as i32, self.pixels.height() as i32]
    }

    /// Paints whole pixels: columns `x0..x1`, rows `y0..y1`, clipped to the sheet. `colour` gives the
    /// colour of each.
    pub fn block(&mut self, [x0, y0, x1, y1]: [i32; 4], colour: impl Fn(i32, i32) -> Rgb) {
        let [width, height] = self.size();
        let data = self.pixels.data_mut();
        for y in y0.max(0)..y1.min(height) {
            for x in x0.max(0)..x1.min(width) {
                let at = (y as usize * width as usize + x as usize) * 4;
                data[at..at + 3].copy_from_slice(&colour(x, y));
            }
        }
    }

    /// Paints whole pixels in one colour.
    pub fn rect(&mut self, [x0, y0, x1, y1]: [i32; 4], [r, g, b]: Rgb) {
        let [width, _] = self.size();
        let (x0, x1) = (x0.max(0), x1.min(width));
        if x0 >= x1 {
            return;
        }
        let (from, to) = (x0 as usize * 4, x1 as usize * 4);
        let rows = self.pixels.data_mut().chunks_exact_mut(width as usize * 4);
        for row in rows.take(y1.max(0) as usize).skip(y0.max(0) as usize) {
            row[from..to].as_chunks_mut().0.fill([r, g, b, u8::MAX]);
        }
    }

    /// Strokes a path.
    pub fn stroke(&mut self, path: &Path, pen: Pen<'_>) {
        let stroke = Stroke {
            width: pen.width_px,
            line_cap: if pen.dash_px.is_empty() { LineCap::Square } else { LineCap::Butt },
            line_join: LineJoin::Miter,
            dash: StrokeDash::new(pen.dash_px.to_vec(), 0.0),
            ..Stroke::default()
        };
        self.pixels.stroke_path(path, &paint(pen.rgb, pen.opacity), &stroke, Transform::identity(), None);
    }

    /// Fills a path (even-odd).
    pub fn fill(&mut self, path: &Path, rgb: Rgb, opacity: f32) {
        self.pixels.fill_path(path, &paint(rgb, opacity), FillRule::EvenOdd, Transform::identity(), None);
    }

    /// One line through points.
    pub fn line(&mut self, points: &[[f32; 2]], pen: Pen<'_>) {
        if let Some(path) = path_of([(points, false)]) {
            self.stroke(&path, pen);
        }
    }

    /// One line of text standing on the baseline through `at`; returns its width, px.
    pub fn text(
        &mut self,
        text: &str,
        at: [f32; 2],
        anchor: Anchor,
        (size_px, weight, rgb): (f32, Weight, Rgb),
    ) -> f32 {
        let wide = font::width_px(text, size_px, weight);
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Middle => at[0] - wide / 2.0,
            Anchor::Right => at[0] - wide,
        };
        let [width, height] = self.size();
        let data = self.pixels.data_mut();
        font::draw(text, [left, at[1]], size_px, weight, |x, y, coverage| {
            if (0..width).contains(&x) && (0..height).contains(&y) {
                let i = (y as usize * width as usize + x as usize) * 4;
                for (k, ink) in rgb.into_iter().enumerate() {
                    let under = f32::from(data[i + k]);
                    data[i + k] = (under + (f32::from(ink) - under) * coverage.min(1.0)).round() as u8;
                }
            }
        });
        wide
    }

    /// The picture as PNG (8-bit RGB).
    ///
    /// # Errors
    /// `png` if the encoder fails, which only a lack of memory can cause.
    pub fn into_png(self) -> Result<Vec<u8>, Error> {
        let pixels = self.pixels.data().as_chunks().0;
        let rgb: Vec<Rgb> = pixels.iter().map(|&[r, g, b, _]: &[u8; 4]| [r, g, b]).collect();
        encode_png(self.pixels.width(), self.pixels.height(), rgb.as_flattened())
    }
}

/// Encodes 8-bit RGB rows.
///
/// # Errors
/// `png` if the encoder fails.
pub fn encode_png(width_px: u32, height_px: u32, rgb: &[u8]) -> Result<Vec<u8>, Error> {
    let fail = |e: png::EncodingError| Error::environment("png", Place::default(), e.to_string());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width_px, height_px);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Paeth);
    let mut writer = encoder.write_header().map_err(fail)?;
    writer.write_image_data(rgb).map_err(fail)?;
    writer.finish().map_err(fail)?;
    Ok(bytes)
}

/// The picture at half its size (each pixel the mean of four), or `None` if its longest side would fall
/// below `least_px` or it is not an 8-bit RGB PNG.
pub fn shrink_png(png: &[u8], least_px: u32) -> Option<Vec<u8>> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().ok()?;
    let info = reader.info();
    let (width, height) = (info.width as usize, info.height as usize);
    let is_rgb = info.color_type == png::ColorType::Rgb && info.bit_depth == png::BitDepth::Eight;
    let (wide, high) = (width / 2, height / 2);
    let fits = wide > 0 && high > 0 && wide.max(high) >= least_px as usize;
    if !is_rgb || !fits || width.max(height) > MAX_SIDE_PX as usize {
        return None;
    }
    let mut from = vec![0; width * height * 3];
    reader.next_frame(&mut from).ok()?;
    let at = |x: usize, y: usize, k: usize| u16::from(from[(y * width + x) * 3 + k]);
    let mut to = Vec::with_capacity(wide * high * 3);
    for y in (0..high).map(|y| 2 * y) {
        for x in (0..wide).map(|x| 2 * x) {
            for k in 0..3 {
                let sum = at(x, y, k) + at(x + 1, y, k) + at(x, y + 1, k) + at(x + 1, y + 1, k);
                to.push(((sum + 2) / 4) as u8);
            }
        }
    }
    encode_png(wide as u32, high as u32, &to).ok()
}

/// The error for a picture size out of range.
pub fn size_error(side_px: u32) -> Error {
    let text = format!(
        "a picture of {side_px} px was asked for, expected {MIN_SIDE_PX} to {MAX_SIDE_PX} px on the longest side"
    );
    Error::usage("picture-size", Place::default(), text)
}

fn paint(rgb: Rgb, opacity: f32) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(rgb[0], rgb[1], rgb[2], (opacity.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

/// Many polylines (closed if told) as one path; points that do not exist are left out, and a line of
/// one point becomes a dot. `None` if nothing remains.
pub fn path_of<'a>(lines: impl IntoIterator<Item = (&'a [[f32; 2]], bool)>) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (points, closed) in lines {
        let mut finite = points.iter().filter(|p| p[0].is_finite() && p[1].is_finite());
        let Some(first) = finite.next() else { continue };
        builder.move_to(first[0], first[1]);
        let mut count = 1;
        for p in finite {
            builder.line_to(p[0], p[1]);
            count += 1;
        }
        if count == 1 {
            builder.line_to(first[0] + 0.01, first[1]);
        }
        if closed && count > 2 {
            builder.close();
        }
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_too_large_is_refused_and_not_allocated() {
        for (w, h) in [(MAX_SIDE_PX + 1, 10), (10, MAX_SIDE_PX + 1), (0, 5), (100_000, 100_000)] {
            assert!(matches!(Canvas::new(w, h), Err(Error::Usage(p)) if p.code == "picture-size"));
        }
        assert!(Canvas::new(MAX_SIDE_PX, 1).is_ok());
    }

    #[test]
    fn lines_of_nothing_draw_nothing() {
        let nan = [[f32::NAN, 0.0], [1.0, f32::INFINITY]];
        assert!(path_of([(&nan[..], true), (&[][..], false)]).is_none());
        assert!(path_of([(&[[3.0, 3.0]][..], true)]).is_some());
    }

    #[test]
    fn blocks_are_clipped_to_the_sheet() {
        let mut canvas = Canvas::new(4, 3).unwrap();
        canvas.rect([-5, -5, 2, 99], [1, 2, 3]);
        let png = canvas.into_png().unwrap();
        let back = Pixmap::decode_png(&png).unwrap();
        assert_eq!(back.pixel(1, 2).unwrap().red(), 1);
        assert_eq!(back.pixel(2, 2).unwrap().red(), 255);
    }
}
