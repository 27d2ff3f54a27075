//! AutoCAD colour indices.

/// Indices 1–9, which follow no rule.
const FIRST: [u32; 9] =
    [0xff0000, 0xffff00, 0x00ff00, 0x00ffff, 0x0000ff, 0xff00ff, 0xffffff, 0x808080, 0xc0c0c0];

/// Greys 250–255. 250 is drawn black.
const GREYS: [u32; 6] = [0x000000, 0x656565, 0x666666, 0x999999, 0xcccccc, 0xffffff];

/// sRGB of a colour index from 1 to 255. From 10 to 249: 24 hues of 15° in five levels of brightness,
/// odd indices half as saturated.
fn colour_of(index: u8) -> [u8; 3] {
    let plain = match index {
        0 => 0,
        1..=9 => FIRST[usize::from(index) - 1],
        250..=255 => GREYS[usize::from(index) - 250],
        _ => return hue_colour(index),
    };
    [(plain >> 16) as u8, (plain >> 8) as u8, plain as u8]
}

fn hue_colour(index: u8) -> [u8; 3] {
    let hue = f64::from(index / 10 - 1) / 4.0;
    let high = [255.0, 165.0, 127.0, 76.0, 38.0][usize::from(index % 10) / 2];
    let low = if index % 2 == 1 { high / 2.0 } else { 0.0 };
    let parts = [(hue - 3.0).abs() - 1.0, 2.0 - (hue - 2.0).abs(), 2.0 - (hue - 4.0).abs()];
    parts.map(|part| (low + (high - low) * part.clamp(0.0, 1.0)) as u8)
}

/// The index whose colour is nearest; never 7, which is black or white as the background wants.
pub(super) fn nearest_index(rgb: [u8; 3]) -> u8 {
    let distance = |&index: &u8| {
        let parts = colour_of(index).into_iter().zip(rgb);
        parts.map(|(a, b)| i32::from(a).abs_diff(i32::from(b)).pow(2)).sum::<u32>()
    };
    (1..=255).filter(|&index| index != 7).min_by_key(distance).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_have_their_colours() {
        let expected = [
            (1, 0xff0000),
            (10, 0xff0000),
            (11, 0xff7f7f),
            (12, 0xa50000),
            (13, 0xa55252),
            (19, 0x261313),
            (20, 0xff3f00),
            (21, 0xff9f7f),
            (34, 0x7f3f00),
            (250, 0),
            (254, 0xcccccc),
        ];
        for (index, colour) in expected {
            let [r, g, b] = colour_of(index).map(u32::from);
            assert_eq!(r << 16 | g << 8 | b, colour, "index {index}");
        }
    }

    #[test]
    fn the_nearest_index_is_taken() {
        assert_eq!(
            [[250, 3, 2], [0, 0, 0], [255, 255, 255], [128, 128, 128]].map(nearest_index),
            [1, 250, 255, 8]
        );
    }
}
