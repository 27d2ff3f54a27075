//! Colours of values, and the colours that tell things apart.

/// sRGB.
pub type Rgb = [u8; 3];

/// How a value becomes a colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Viridis: even steps of lightness, safe for colour-blind readers and in grey print.
    #[default]
    Viridis,
    /// Blue (low) to red (high), as in the paper's figures.
    BlueToRed,
    /// The same colour at both ends: for directions.
    Cyclic,
    /// Brown (worse) by white (as it was) to green (better): for changes.
    Change,
    /// The same where less is better.
    ChangeDown,
}

/// Viridis at eighths (van der Walt and Smith, matplotlib 2.0, CC0).
const VIRIDIS: [Rgb; 9] = [
    [0x44, 0x01, 0x54],
    [0x47, 0x2c, 0x7a],
    [0x3b, 0x51, 0x8b],
    [0x2c, 0x71, 0x8e],
    [0x21, 0x90, 0x8d],
    [0x27, 0xad, 0x81],
    [0x5c, 0xc8, 0x63],
    [0xaa, 0xdc, 0x32],
    [0xfd, 0xe7, 0x25],
];

const BLUE_TO_RED: [Rgb; 7] = [
    [0x24, 0x35, 0xb4],
    [0x26, 0x7d, 0xe0],
    [0x35, 0xbf, 0xd0],
    [0x7f, 0xd3, 0x8a],
    [0xf2, 0xde, 0x4f],
    [0xf3, 0x8b, 0x2b],
    [0xc8, 0x1a, 0x1f],
];

/// Brown by white to green, which colour-blind readers tell apart (Brewer's BrBG).
const CHANGE: [Rgb; 7] = [
    [0x8c, 0x51, 0x0a],
    [0xd8, 0xb3, 0x65],
    [0xf6, 0xe8, 0xc3],
    [0xf8, 0xf8, 0xf8],
    [0xc7, 0xea, 0xe5],
    [0x5a, 0xb4, 0xac],
    [0x01, 0x66, 0x5e],
];

/// Light, blue, dark, red, light: four quarters of a turn that grey print tells apart by pairs.
const CYCLIC: [Rgb; 9] = [
    [0xe6, 0xe0, 0xe8],
    [0x9a, 0xbc, 0xd4],
    [0x4f, 0x7f, 0xc0],
    [0x4a, 0x44, 0x98],
    [0x2e, 0x16, 0x3c],
    [0x86, 0x26, 0x4c],
    [0xc4, 0x5a, 0x48],
    [0xdc, 0xa8, 0x90],
    [0xe6, 0xe0, 0xe8],
];

impl Palette {
    /// The colour at a fraction of the scale, clamped to `[0, 1]`.
    pub fn at(self, fraction: f64) -> Rgb {
        match self {
            Self::Viridis => blend(&VIRIDIS, fraction),
            Self::BlueToRed => blend(&BLUE_TO_RED, fraction),
            Self::Cyclic => blend(&CYCLIC, fraction),
            Self::Change => blend(&CHANGE, fraction),
            Self::ChangeDown => blend(&CHANGE, 1.0 - fraction),
        }
    }

    /// A colour for what moved that stands out on every colour of the palette (with a white rim).
    pub fn accent(self) -> Rgb {
        match self {
            Self::Viridis | Self::Cyclic | Self::Change | Self::ChangeDown => [0xd5, 0x00, 0x5f],
            Self::BlueToRed => [0x8a, 0x00, 0xc8],
        }
    }
}

fn blend(stops: &[Rgb], fraction: f64) -> Rgb {
    let last = stops.len() - 1;
    let at = if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 } * last as f64;
    let low = (at as usize).min(last - 1);
    let part = at - low as f64;
    let mix = |k: usize| {
        let (a, b) = (f64::from(stops[low][k]), f64::from(stops[low + 1][k]));
        (a + (b - a) * part).round() as u8
    };
    [mix(0), mix(1), mix(2)]
}

/// The range a palette spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// Value at the low end.
    pub lo: f64,
    /// Value at the high end.
    pub hi: f64,
}

impl Scale {
    /// The range of all finite values; `[0, 1]` if there are none. Layouts that are compared share
    /// one scale.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let range = values
            .into_iter()
            .filter(|v| v.is_finite())
            .fold(None, |r: Option<(f64, f64)>, v| Some(r.map_or((v, v), |(lo, hi)| (lo.min(v), hi.max(v)))));
        range.map_or(Self { lo: 0.0, hi: 1.0 }, |(lo, hi)| Self { lo, hi })
    }

    /// The range about 0 that holds all finite values.
    pub fn of_changes(values: impl IntoIterator<Item = f64>) -> Self {
        let most = values.into_iter().filter(|v| v.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
        Self { lo: -most, hi: most }
    }

    /// Where a value lies between the ends, clamped; the middle if the ends coincide.
    pub fn fraction(&self, value: f64) -> f64 {
        let span = self.hi - self.lo;
        if span > 0.0 { ((value - self.lo) / span).clamp(0.0, 1.0) } else { 0.5 }
    }
}

/// Colours that tell options apart: Okabe and Ito (2008), without black and yellow, which walls and
/// paper need; then two of Tol's.
pub const OPTION_COLOURS: [Rgb; 8] = [
    [0x00, 0x72, 0xb2],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
    [0x88, 0x22, 0x55],
    [0x44, 0x66, 0x22],
];

/// Dash patterns that tell options apart without colour, in line widths; empty is solid.
pub const OPTION_DASHES: [&[f32]; 5] =
    [&[], &[6.0, 3.0], &[2.0, 2.0], &[9.0, 3.0, 2.0, 3.0], &[5.0, 2.0, 1.5, 2.0, 1.5, 2.0]];

/// Colour and dash of the i-th option; 40 differ.
pub fn option_style(i: usize) -> (Rgb, &'static [f32]) {
    (OPTION_COLOURS[i % OPTION_COLOURS.len()], OPTION_DASHES[i % OPTION_DASHES.len()])
}

/// `#rrggbb`.
pub fn hex(rgb: Rgb) -> String {
    format!("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2])
}

/// Ink of walls.
pub(super) const INK: Rgb = [0x16, 0x18, 0x1c];

/// Ink of secondary text and thin lines.
pub(super) const GREY: Rgb = [0x6a, 0x6f, 0x78];

/// Paper.
pub(super) const PAPER: Rgb = [0xff, 0xff, 0xff];

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(c: Rgb) -> f64 {
        let linear = |v: u8| (f64::from(v) / 255.0).powf(2.2);
        0.2126 * linear(c[0]) + 0.7152 * linear(c[1]) + 0.0722 * linear(c[2])
    }

    #[test]
    fn viridis_gets_lighter_all_the_way() {
        let steps: Vec<f64> = (0..=64).map(|i| luminance(Palette::Viridis.at(f64::from(i) / 64.0))).collect();
        assert!(steps.windows(2).all(|w| w[0] < w[1]), "{steps:?}");
    }

    /// 359° and 1° look alike, opposite directions do not.
    #[test]
    fn a_full_turn_ends_in_the_colour_it_began_with() {
        let far = |a: f64, b: f64| {
            let [a, b] = [a, b].map(|degrees| Palette::Cyclic.at(degrees / 360.0));
            (0..3).map(|k| a[k].abs_diff(b[k]) as u32).sum::<u32>()
        };
        assert_eq!(far(0.0, 360.0), 0);
        assert!(far(359.0, 1.0) < 12, "{}", far(359.0, 1.0));
        assert!((0..180).all(|d| far(f64::from(d), f64::from(d + 180)) > 90));
    }

    #[test]
    fn odd_fractions_and_scales_have_a_colour() {
        assert_eq!(Palette::Viridis.at(-3.0), VIRIDIS[0]);
        assert_eq!(Palette::Viridis.at(7.0), VIRIDIS[8]);
        assert_eq!(Palette::Viridis.at(f64::NAN), VIRIDIS[0]);
        assert_eq!(Scale::of([f64::NAN]), Scale { lo: 0.0, hi: 1.0 });
        let flat = Scale::of([4.0, 4.0]);
        assert_eq!(flat.fraction(4.0), 0.5);
    }

    #[test]
    fn neighbouring_options_differ_in_colour_and_dash() {
        for i in 0..39 {
            let (a, b) = (option_style(i), option_style(i + 1));
            assert!(a.0 != b.0 && a.1 != b.1);
        }
    }
}
