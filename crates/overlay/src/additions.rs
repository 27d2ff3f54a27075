//! What is added to the architect's drawing, on layers of ours: coloured cells, what moved, notes.
//!
//! Everything is in metres of the plan frame; the pipeline converts to drawing units.

use std::collections::BTreeMap;

use glam::DVec2;

use super::measure::{fixed, number};
use super::palette::{Palette, Rgb, Scale};
use super::picture::{Cell, Stroke, bounds_of};
use enfilade_cad::drawing::{Addition, Mark};
use enfilade_cad::own_layers::{
    BEFORE as BEFORE_LAYER, BEFORE_RGB, HEAT_PREFIX as HEAT_LAYER_PREFIX, MOVED as MOVED_LAYER, MOVED_RGB,
    NOTE as NOTE_LAYER, NOTE_RGB,
};

/// Colours a heat map is reduced to in a drawing: neighbouring cells of one colour become one
/// rectangle, so that 10,000 cells stay a few thousand entities. More are hard to tell apart.
pub const MAX_HEAT_COLOURS: usize = 16;

/// Letter height of notes as a share of the plan's diagonal: about 4 mm on an A3 sheet.
const NOTE_HEIGHT_SHARE: f64 = 0.011;
/// Letter height bounds, metres.
const NOTE_HEIGHT_M: [f64; 2] = [0.05, 5.0];
/// Barbs of an arrow as a share of its length, if they are not as large as letters.
const ARROW_HEAD_SHARE: f64 = 0.3;
/// Cells farther than this from the first are left out: no lattice of a drawing is that wide, and
/// numbers stay whole.
const MAX_LATTICE_INDEX: f64 = 1e9;
/// Swatches of a legend.
const LEGEND_SWATCHES: usize = 6;
/// Letters a line of a note holds.
const NOTE_LINE_LETTERS: usize = 64;

/// Longest name of a layer in the oldest versions of DXF, characters.
const MAX_LAYER_NAME: usize = 31;

/// The layer of a measure: `EF-HEAT-DEGREE`; a name too long for old versions is cut off.
pub fn heat_layer(measure: &str) -> String {
    let name: String = measure
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c.to_ascii_uppercase() } else { '-' })
        .collect();
    format!("{HEAT_LAYER_PREFIX}{name}").chars().take(MAX_LAYER_NAME).collect()
}

/// Coloured rectangles for the cells that have a value, on `layer`.
///
/// Values are reduced to [`MAX_HEAT_COLOURS`] steps of the scale; equal neighbours are merged, first
/// along rows, then equal runs of neighbouring rows. The union of the rectangles is exactly the union
/// of the cells.
pub fn heat_additions(
    layer: &str,
    cells: &[Cell],
    spacing_m: f64,
    scale: Scale,
    palette: Palette,
) -> Vec<Addition> {
    let Some(origin) = cells.first().map(|c| c.centre).filter(|_| spacing_m > 0.0) else { return Vec::new() };
    let rectangles = merged(&steps_of(cells, origin, spacing_m, scale));
    let corner = |col: i64, row: i64| {
        let at = |k: usize, i: i64| origin[k] + (i as f64 - 0.5) * spacing_m;
        DVec2::new(at(0, col), at(1, row))
    };
    let fill = |r: Rectangle| Addition {
        layer: layer.to_owned(),
        rgb: palette.at((f64::from(r.step) + 0.5) / MAX_HEAT_COLOURS as f64),
        mark: Mark::Fill {
            corners: [
                corner(r.cols[0], r.rows[0]),
                corner(r.cols[1], r.rows[0]),
                corner(r.cols[1], r.rows[1]),
                corner(r.cols[0], r.rows[1]),
            ],
        },
    };
    rectangles.into_iter().map(fill).collect()
}

/// Colour step by row and column of the cells with a value.
fn steps_of(cells: &[Cell], origin: [f64; 2], spacing_m: f64, scale: Scale) -> BTreeMap<(i64, i64), u8> {
    let index = |c: &Cell, k: usize| {
        let i = ((c.centre[k] - origin[k]) / spacing_m).round();
        (i.abs() <= MAX_LATTICE_INDEX).then_some(i as i64)
    };
    let step = |v: f64| {
        let steps = MAX_HEAT_COLOURS as f64;
        (scale.fraction(v) * steps).min(steps - 1.0) as u8
    };
    let valued = cells.iter().filter_map(|c| Some((c, c.value.filter(|v| v.is_finite())?)));
    valued.filter_map(|(c, v)| Some(((index(c, 1)?, index(c, 0)?), step(v)))).collect()
}

/// Cells of one colour: columns and rows from the first up to, not including, the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Rectangle {
    rows: [i64; 2],
    cols: [i64; 2],
    step: u8,
}

/// Rectangles of one colour, each as large as it gets from its lower left cell, grown along the row first
/// or along the column first, whichever covers more.
fn merged(steps: &BTreeMap<(i64, i64), u8>) -> Vec<Rectangle> {
    let mut free = steps.clone();
    let mut done = Vec::new();
    while let Some((&(row, col), &step)) = free.first_key_value() {
        let is_alike = |row: i64, col: i64| free.get(&(row, col)) == Some(&step);
        let wide = (1..).take_while(|i| is_alike(row, col + i)).count() as i64 + 1;
        let high = (1..).take_while(|i| is_alike(row + i, col)).count() as i64 + 1;
        let rows = (1..high).take_while(|r| (0..wide).all(|c| is_alike(row + r, col + c))).count() as i64 + 1;
        let cols = (1..wide).take_while(|c| (0..high).all(|r| is_alike(row + r, col + c))).count() as i64 + 1;
        let [rows, cols] = if rows * wide >= high * cols { [rows, wide] } else { [high, cols] };
        for r in row..row + rows {
            for c in col..col + cols {
                free.remove(&(r, c));
            }
        }
        done.push(Rectangle { rows: [row, row + rows], cols: [col, col + cols], step });
    }
    done
}

/// Traces what moved and where it stood, and places the note beside the plan (right of it, its top
/// line level with the plan's top). `bounds` is the box of the plan, metres.
pub fn moved_additions(
    moved: &[Stroke],
    before: &[Stroke],
    note_lines: &[String],
    bounds: [[f64; 2]; 2],
) -> Vec<Addition> {
    let trace = |layer: &'static str, rgb: Rgb| {
        move |s: &Stroke| {
            let points: Vec<DVec2> = s.points.iter().map(|p| DVec2::from(*p)).collect();
            let mark = Mark::Path { points, closed: s.closed };
            Addition { layer: layer.to_owned(), rgb, mark }
        }
    };
    let drawn = |s: &&Stroke| s.points.len() > 1;
    let mut out: Vec<Addition> = before.iter().filter(drawn).map(trace(BEFORE_LAYER, BEFORE_RGB)).collect();
    out.extend(moved.iter().filter(drawn).map(trace(MOVED_LAYER, MOVED_RGB)));
    let everything = moved.iter().chain(before).flat_map(|s| s.points.iter().copied());
    let whole = bounds_of(everything.chain(bounds));
    out.extend(note(note_lines, bounds, whole));
    out
}

/// Arrows from where things stood to where they stand, each with its length in metres. `bounds` is the box of the plan,
/// metres.
pub fn arrow_additions(arrows: &[[DVec2; 2]], bounds: [[f64; 2]; 2]) -> Vec<Addition> {
    let height = letter_height(bounds);
    let of = |[from, to]: &[DVec2; 2]| {
        let along = (*to - *from).normalize_or_zero();
        let barb = (from.distance(*to) * ARROW_HEAD_SHARE).min(height);
        let side = |s: f64| *to - (along + along.perp() * s) * barb;
        let points = vec![*from, *to, side(0.5), *to, side(-0.5)];
        let shaft = Mark::Path { points, closed: false };
        let text = plain(&format!("{} m", fixed(from.distance(*to), 2)));
        let beside = from.midpoint(*to) + along.perp().abs() * (height * 0.5);
        [
            Addition { layer: MOVED_LAYER.to_owned(), rgb: MOVED_RGB, mark: shaft },
            Addition {
                layer: NOTE_LAYER.to_owned(),
                rgb: NOTE_RGB,
                mark: Mark::Text { at: beside, height, text },
            },
        ]
    };
    arrows.iter().flat_map(of).collect()
}

fn note(lines: &[String], bounds: [[f64; 2]; 2], whole: [[f64; 2]; 2]) -> Option<Addition> {
    let text = lines.iter().flat_map(|l| wrapped(l, NOTE_LINE_LETTERS)).collect::<Vec<_>>().join("\n");
    let text = plain(&text);
    if text.is_empty() {
        return None;
    }
    let height = letter_height(bounds);
    let at = DVec2::new(whole[1][0] + 4.0 * height, bounds[1][1] - height);
    Some(Addition { layer: NOTE_LAYER.to_owned(), rgb: NOTE_RGB, mark: Mark::Text { at, height, text } })
}

/// Height of letters in proportion to the plan, metres.
pub(super) fn letter_height([lo, hi]: [[f64; 2]; 2]) -> f64 {
    let diagonal = (hi[0] - lo[0]).hypot(hi[1] - lo[1]);
    (diagonal * NOTE_HEIGHT_SHARE).clamp(NOTE_HEIGHT_M[0], NOTE_HEIGHT_M[1])
}

/// Signs that old code pages and CAD fonts lack, written otherwise.
pub(super) fn plain(text: &str) -> String {
    text.replace(['−', '–'], "-").replace('\u{202f}', " ").replace('…', "...")
}

/// A legend for coloured cells on their own layer: swatches below the plan with their values, and what
/// they count (`Visibility (degree), cells seen`).
pub fn heat_legend(
    layer: &str,
    scale: Scale,
    palette: Palette,
    caption: &str,
    bounds: [[f64; 2]; 2],
) -> Vec<Addition> {
    let height = letter_height(bounds);
    let (side, top) = (4.0 * height, bounds[0][1] - 4.0 * height);
    let add = |rgb, mark| Addition { layer: layer.to_owned(), rgb, mark };
    let text = |x: f64, y: f64, text: &str| {
        add(NOTE_RGB, Mark::Text { at: DVec2::new(x, y), height, text: plain(text) })
    };
    let mut out = vec![text(bounds[0][0], top + 0.8 * height, caption)];
    for i in 0..LEGEND_SWATCHES {
        let part = (i as f64 + 0.5) / LEGEND_SWATCHES as f64;
        let (x, y) = (bounds[0][0] + i as f64 * side, top - height);
        let corners = [[x, y], [x + side, y], [x + side, top], [x, top]].map(DVec2::from);
        out.push(add(palette.at(part), Mark::Fill { corners }));
        out.push(text(x, y - 1.6 * height, &number(scale.lo + part * (scale.hi - scale.lo))));
    }
    out
}

/// Breaks a line at spaces so that no part is longer than `most` letters, unless one word is.
fn wrapped(line: &str, most: usize) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut letters = 0;
    for word in line.split(' ') {
        let wide = word.chars().count();
        match out.last_mut() {
            Some(last) if letters + 1 + wide <= most => {
                last.push(' ');
                last.push_str(word);
                letters += 1 + wide;
            }
            _ => {
                out.push(word.to_owned());
                letters = wide;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::picture::StrokeKind;
    use super::*;

    const SCALE: Scale = Scale { lo: 0.0, hi: 10.0 };

    fn square(n: i32, value: impl Fn(i32, i32) -> Option<f64>) -> Vec<Cell> {
        let cell = |c: i32, r: i32| Cell {
            centre: [0.47 + f64::from(c) * 0.5, -3.1 + f64::from(r) * 0.5],
            value: value(c, r),
        };
        (0..n).flat_map(|c| (0..n).map(move |r| (c, r))).map(|(c, r)| cell(c, r)).collect()
    }

    fn area(a: &Addition) -> f64 {
        let Mark::Fill { corners } = &a.mark else { panic!("a fill") };
        let diagonal = corners[2] - corners[0];
        assert!(diagonal.x > 0.0 && diagonal.y > 0.0);
        diagonal.x * diagonal.y
    }

    #[test]
    fn equal_cells_become_one_rectangle() {
        let fills =
            heat_additions("EF-HEAT-DEGREE", &square(40, |_, _| Some(4.0)), 0.5, SCALE, Palette::Viridis);
        assert_eq!(fills.len(), 1);
        assert!((area(&fills[0]) - 400.0).abs() < 1e-9);
    }

    #[test]
    fn ten_thousand_smooth_cells_stay_few() {
        let smooth = |c: i32, r: i32| {
            Some(5.0 + 3.0 * (f64::from(c) / 17.0).sin() + 2.0 * (f64::from(r) / 11.0).cos())
        };
        let fills = heat_additions("X", &square(100, smooth), 0.5, SCALE, Palette::Viridis);
        assert!(fills.len() < 2000, "{}", fills.len());
    }

    #[test]
    fn no_more_colours_than_the_limit() {
        let fills = heat_additions(
            "X",
            &square(30, |c, r| Some(f64::from(c * 30 + r) / 90.0)),
            0.5,
            SCALE,
            Palette::Viridis,
        );
        let colours: std::collections::BTreeSet<_> = fills.iter().map(|f| f.rgb).collect();
        assert_eq!(colours.len(), MAX_HEAT_COLOURS);
    }

    proptest! {
        #[test]
        fn rectangles_cover_each_cell_once_in_its_colour(
            values in proptest::collection::vec(proptest::option::of(0u8..4), 81)
        ) {
            let value = |c: i32, r: i32| values[(c * 9 + r) as usize].map(|v| f64::from(v) * 3.0);
            let cells = square(9, value);
            let fills = heat_additions("X", &cells, 0.5, SCALE, Palette::Viridis);
            for cell in &cells {
                let at = DVec2::from(cell.centre);
                let hits: Vec<Rgb> = fills.iter().filter(|f| {
                    let Mark::Fill { corners } = &f.mark else { return false };
                    at.cmpgt(corners[0]).all() && at.cmplt(corners[2]).all()
                }).map(|f| f.rgb).collect();
                let expected = cell.value.map(|v| {
                    let step = (SCALE.fraction(v) * MAX_HEAT_COLOURS as f64).min(MAX_HEAT_COLOURS as f64 - 1.0);
                    Palette::Viridis.at((step.floor() + 0.5) / MAX_HEAT_COLOURS as f64)
                });
                prop_assert_eq!(hits, expected.into_iter().collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn the_note_stands_beside_everything_drawn() {
        let far = Stroke {
            points: vec![[1.0, 1.0], [14.0, 2.0]],
            closed: false,
            filled: false,
            kind: StrokeKind::Moved,
        };
        let lines = ["Door 3 slides 1.2 m east".to_owned(), "visibility +18 %".to_owned()];
        let out = moved_additions(&[far], &[], &lines, [[0.0, 0.0], [12.0, 9.0]]);
        let Mark::Text { at, height, text } = &out[1].mark else { panic!("a text") };
        assert!(at.x > 14.0 && at.y < 9.0 && *height > 0.0);
        assert_eq!(text.lines().count(), 2);
        assert_eq!((out[0].layer.as_str(), out[1].layer.as_str()), (MOVED_LAYER, NOTE_LAYER));
    }

    #[test]
    fn a_legend_stands_below_the_plan_in_letters_every_program_has() {
        let bounds = [[0.0, 0.0], [12.0, 9.0]];
        let legend =
            heat_legend("EF-HEAT-SCORE", Scale { lo: -2.0, hi: 4.0 }, Palette::Viridis, "Score", bounds);
        assert_eq!(legend.len(), 1 + 2 * LEGEND_SWATCHES);
        for a in &legend {
            match &a.mark {
                Mark::Text { at, text, .. } => assert!(at.y < 0.0 && text.is_ascii(), "{text}"),
                Mark::Fill { corners } => assert!(corners.iter().all(|c| c.y < 0.0)),
                Mark::Path { .. } => panic!("no path expected"),
            }
        }
    }

    #[test]
    fn cells_that_are_nowhere_are_left_out() {
        let at = |x: f64| Cell { centre: [x, 0.0], value: Some(1.0) };
        let cells = [at(0.0), at(f64::NAN), at(1e300), at(0.5 * (MAX_LATTICE_INDEX + 1.0))];
        assert_eq!(heat_additions("X", &cells, 0.5, SCALE, Palette::Viridis).len(), 1);
        assert_eq!(heat_additions("X", &cells, 0.0, SCALE, Palette::Viridis), []);
    }

    #[test]
    fn layers_of_measures_have_plain_names() {
        assert_eq!(heat_layer("degree"), "EF-HEAT-DEGREE");
        assert_eq!(heat_layer("degree-entrance of the north"), "EF-HEAT-DEGREE-ENTRANCE-OF-THE-");
        assert_eq!(heat_layer("max radial*"), "EF-HEAT-MAX-RADIAL-");
    }
}
