//! Letters, embedded, the same on every machine: DejaVu Sans, and for scripts that it lacks the dots of GNU Unifont.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, GlyphId, ScaleFont};

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

/// A letter to draw.
enum Letter {
    Outline(GlyphId),
    /// Of a script that DejaVu Sans has no letters of.
    Dots(&'static unifont::Glyph),
}

/// Dots of an em, and how many of them stand above the baseline.
const DOTS: [f32; 2] = [16.0, 14.0];

/// The letters of a text; control characters are left out, and a letter that neither font has is an empty box.
fn letters(text: &str, font: &FontRef<'static>) -> impl Iterator<Item = Letter> {
    text.chars().filter(|c| !c.is_control()).map(|c| match (font.glyph_id(c), unifont::get_glyph(c)) {
        (GlyphId(0), Some(dots)) => Letter::Dots(dots),
        (id, _) => Letter::Outline(id),
    })
}

/// Calls `dot` for every pixel that the dots of a letter cover in part; `origin`: its left upper corner.
fn draw_dots(glyph: &unifont::Glyph, origin: [f32; 2], dot_px: f32, dot: &mut impl FnMut(i32, i32, f32)) {
    let first = origin.map(f32::floor);
    let side = (DOTS[0] * dot_px).ceil() as usize + 2;
    let mut covered = vec![0.0_f32; side * side];
    let shares = |from: f32| {
        let pixels = from.floor() as usize..(from + dot_px).ceil() as usize;
        pixels.map(move |i| (i, (from + dot_px).min(i as f32 + 1.0) - from.max(i as f32)))
    };
    for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))).filter(|(x, y)| glyph.get_pixel(*x, *y))
    {
        let [left, top] = [(x, 0), (y, 1)].map(|(n, k)| origin[k] - first[k] + n as f32 * dot_px);
        for ((i, wide), (j, high)) in shares(left).flat_map(|c| shares(top).map(move |r| (c, r))) {
            covered[j * side + i] += wide * high;
        }
    }
    for (at, share) in covered.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
        dot(first[0] as i32 + (at % side) as i32, first[1] as i32 + (at / side) as i32, share.min(1.0));
    }
}

/// Width of one line of text, px.
pub fn width_px(text: &str, size_px: f32, weight: Weight) -> f32 {
    let Some(font) = face(weight) else { return 0.0 };
    let scaled = font.as_scaled(px_scale(font, size_px));
    let wide = |letter| match letter {
        Letter::Outline(id) => scaled.h_advance(id),
        Letter::Dots(glyph) => glyph.get_width() as f32 * size_px / DOTS[0],
    };
    letters(text, font).map(wide).sum()
}

/// Calls `dot(x, y, coverage)` for every covered pixel of a line of text whose left end stands at
/// `[x, baseline]`.
pub fn draw(text: &str, at: [f32; 2], size_px: f32, weight: Weight, mut dot: impl FnMut(i32, i32, f32)) {
    let Some(font) = face(weight) else { return };
    let scale = px_scale(font, size_px);
    let scaled = font.as_scaled(scale);
    let mut x = at[0];
    let dot_px = size_px / DOTS[0];
    for letter in letters(text, font) {
        let id = match letter {
            Letter::Outline(id) => id,
            Letter::Dots(glyph) => {
                draw_dots(glyph, [x, at[1] - DOTS[1] * dot_px], dot_px, &mut dot);
                x += glyph.get_width() as f32 * dot_px;
                continue;
            }
        };
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
    fn letters_of_any_script_are_drawn() {
        let drawn = |text: &str, size_px: f32| {
            let mut dots = std::collections::BTreeMap::new();
            draw(text, [3.4, 20.0], size_px, Weight::Regular, |x, y, c| {
                assert!(dots.insert((x, y), c).is_none_or(|_| text.chars().count() > 1) && c < 1.001);
            });
            dots
        };
        let all = ["図", "墙", "벽", "عرض", "Å", "\u{e123}"];
        for (i, text) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|other| drawn(text, 20.0) != drawn(other, 20.0)), "{text}");
        }
        let [lo, hi] =
            [f32::min, f32::max].map(|of| drawn("口", 32.0).keys().map(|k| k.0 as f32).reduce(of).unwrap());
        assert!((16.0..=33.0).contains(&(hi - lo)), "{lo} {hi}");
        // At one pixel a dot, the dots themselves: as many as the glyph has.
        let glyph = unifont::get_glyph('墙').unwrap();
        let dots = (0..256).filter(|n| glyph.get_pixel(n % 16, n / 16)).count() as f32;
        assert!((drawn("墙", 16.0).values().sum::<f32>() - dots).abs() < 1e-3);
        assert_eq!(width_px("墙A", 32.0, Weight::Bold), 32.0 + width_px("A", 32.0, Weight::Bold));
    }
}
