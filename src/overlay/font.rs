//! Letters: DejaVu Sans, embedded, one size for every machine.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, ScaleFont};

/// How heavy letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// Book.
    Regular,
    /// Bold.
    Bold,
}

static REGULAR: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(dejavu::sans::regular()).ok());
static BOLD: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(dejavu::sans::bold()).ok());

fn face(weight: Weight) -> Option<&'static FontRef<'static>> {
    match weight {
        Weight::Regular => REGULAR.as_ref(),
        Weight::Bold => BOLD.as_ref(),
    }
}

/// `size_px` is the nominal size (em); ab_glyph scales by ascent + descent instead.
fn px_scale(font: &FontRef<'_>, size_px: f32) -> f32 {
    let em = font.units_per_em().unwrap_or(2048.0);
    size_px * font.height_unscaled() / em
}

/// Width of one line of text, px.
pub fn width_px(text: &str, size_px: f32, weight: Weight) -> f32 {
    let Some(font) = face(weight) else { return 0.0 };
    let scaled = font.as_scaled(px_scale(font, size_px));
    text.chars().filter(|c| !c.is_control()).map(|c| scaled.h_advance(font.glyph_id(c))).sum()
}

/// Calls `dot(x, y, coverage)` for every covered pixel of a line of text whose left end stands at
/// `[x, baseline]`. A letter that the font lacks is its empty box; control characters are left out.
pub fn draw(text: &str, at: [f32; 2], size_px: f32, weight: Weight, mut dot: impl FnMut(i32, i32, f32)) {
    let Some(font) = face(weight) else { return };
    let scale = px_scale(font, size_px);
    let scaled = font.as_scaled(scale);
    let mut x = at[0];
    for c in text.chars().filter(|c| !c.is_control()) {
        let id = font.glyph_id(c);
        let glyph = id.with_scale_and_position(scale, ab_glyph::point(x, at[1]));
        if let Some(outline) = font.outline_glyph(glyph) {
            let box_px = outline.px_bounds();
            let (left, top) = (box_px.min.x as i32, box_px.min.y as i32);
            outline.draw(|gx, gy, coverage| dot(left + gx as i32, top + gy as i32, coverage));
        }
        x += scaled.h_advance(id);
    }
}

/// The text, shortened with `…` until it is at most `most_px` wide.
pub fn fitted(text: &str, size_px: f32, weight: Weight, most_px: f32) -> String {
    if width_px(text, size_px, weight) <= most_px {
        return text.to_owned();
    }
    let letters: Vec<char> = text.chars().collect();
    let fits = |n: usize| {
        let short: String = letters[..n].iter().collect::<String>().trim_end().to_owned() + "…";
        (width_px(&short, size_px, weight) <= most_px).then_some(short)
    };
    let (mut low, mut high) = (0, letters.len());
    while low + 1 < high {
        let middle = usize::midpoint(low, high);
        if fits(middle).is_some() { low = middle } else { high = middle }
    }
    fits(low).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_that_is_too_wide_ends_in_an_ellipsis() {
        let long = "Grundriss Erdgeschoss, Variante B, überarbeitet";
        let short = fitted(long, 20.0, Weight::Bold, 200.0);
        assert!(short.ends_with('…') && width_px(&short, 20.0, Weight::Bold) <= 200.0);
        assert_eq!(fitted("Plan", 20.0, Weight::Bold, 200.0), "Plan");
        assert_eq!(fitted("Plan", 20.0, Weight::Bold, 1.0), "");
    }

    #[test]
    fn a_letter_that_the_font_lacks_is_drawn_as_a_box() {
        let mut dots = 0;
        draw("図", [0.0, 20.0], 20.0, Weight::Regular, |_, _, c| dots += usize::from(c > 0.5));
        assert!(dots > 10);
    }
}
