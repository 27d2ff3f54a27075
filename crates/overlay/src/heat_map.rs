//! A measure as colours over the plan.

use super::canvas::{Anchor, Canvas, Pen};
use super::font::Weight;
use super::frame::{Frame, Key};
use super::measure::{tick_labels, ticks};
use super::palette::{GREY, INK, Palette, Rgb, Scale};
use super::picture::{
    BUILT_LOOK, Cell, DEMOLISHED_LOOK, Look, PlanPicture, RegionKind, StrokeKind, bounds_of, draw_region,
    draw_strokes,
};
use enfilade_report::Error;

/// Longest side of the pictures of a round, px.
pub const DEFAULT_SIDE_PX: u32 = 1600;
/// Nominal height of legend and keys.
const FOOT_PX: f32 = 142.0;
/// Smallest side of a cell on the sheet, px: a single cell of a large plan stays visible.
const SMALLEST_CELL_PX: i32 = 2;

/// What a heat map shows.
#[derive(Clone, Debug)]
pub struct HeatMap<'a> {
    /// The plan on top of the cells.
    pub picture: &'a PlanPicture,
    /// The cells.
    pub cells: &'a [Cell],
    /// Side of a cell, metres.
    pub spacing_m: f64,
    /// Range of the colours, shared by all layouts that are compared.
    pub scale: Scale,
    /// Headline: `Visibility`.
    pub title: &'a str,
    /// Line below: drawing and layout.
    pub subtitle: &'a str,
    /// What the numbers of the legend count: `cells seen`, `steps`, `bits`, `score`.
    pub unit: &'a str,
    /// What a cell without a value is called in the legend: `not measured`.
    pub no_value: &'a str,
    /// Colours.
    pub palette: Palette,
}

/// Draws a heat map as PNG. Pictures with the same bounds and cells have the same size and lie exactly
/// over each other.
///
/// # Errors
/// `picture-size`, `picture-bounds`: a size or coordinates out of range; `png` if the encoder fails.
pub fn heat_map_png(map: &HeatMap<'_>, longest_px: u32) -> Result<Vec<u8>, Error> {
    let titled = !(map.title.is_empty() && map.subtitle.is_empty());
    let frame = Frame::fit(shown_box(map), longest_px, titled, FOOT_PX)?.with_north(map.picture.north_deg);
    let mut canvas = frame.sheet()?;
    draw_cells(&mut canvas, &frame, map);
    for region in &map.picture.regions {
        if let Some(look) = region_look(region.kind) {
            draw_region(&mut canvas, &frame, region, look, None);
        }
    }
    draw_strokes(&mut canvas, &frame, &map.picture.strokes, |kind| stroke_look(kind, map.palette));
    frame.head(&mut canvas, map.title, map.subtitle);
    draw_foot(&mut canvas, &frame, map);
    canvas.into_png()
}

/// The plan's box and every cell. The lattice is that of the present layout, so layouts of one drawing
/// still share their frame.
fn shown_box(map: &HeatMap<'_>) -> [[f64; 2]; 2] {
    let half = map.spacing_m / 2.0;
    let corners = map.cells.iter().flat_map(|c| [-half, half].map(|d| [c.centre[0] + d, c.centre[1] + d]));
    bounds_of(corners.chain(map.picture.bounds))
}

fn draw_cells(canvas: &mut Canvas, frame: &Frame, map: &HeatMap<'_>) {
    let half = map.spacing_m / 2.0;
    for cell in map.cells {
        let lo = frame.to_px([cell.centre[0] - half, cell.centre[1] + half]);
        let hi = frame.to_px([cell.centre[0] + half, cell.centre[1] - half]);
        if !lo.iter().chain(&hi).all(|v| v.is_finite()) {
            continue;
        }
        let [x0, y0] = lo.map(|v| v.round() as i32);
        let [x1, y1] =
            [0, 1].map(|k| (hi[k].round() as i32).max([x0, y0][k].saturating_add(SMALLEST_CELL_PX)));
        match cell.value.filter(|v| v.is_finite()) {
            Some(value) => canvas.rect([x0, y0, x1, y1], map.palette.at(map.scale.fraction(value))),
            None => canvas.block([x0, y0, x1, y1], unmeasured),
        }
    }
}

/// Light grey with dots: in the graph, but not measured. (A hatch would take six times the bytes.)
fn unmeasured(x: i32, y: i32) -> Rgb {
    let is_dot = x.rem_euclid(20) < 2 && y.rem_euclid(20) < 2;
    if is_dot { [0xb4, 0xb8, 0xbf] } else { [0xee, 0xef, 0xf1] }
}

fn stroke_look(kind: StrokeKind, palette: Palette) -> Option<Look> {
    Some(match kind {
        StrokeKind::Doubtful => return None,
        StrokeKind::Demolished => DEMOLISHED_LOOK,
        StrokeKind::Built => BUILT_LOOK,
        StrokeKind::Ignored => Look { opacity: 0.45, ..Look::solid(GREY, 0.4, 0.0) },
        StrokeKind::Opening | StrokeKind::Door | StrokeKind::Window => {
            Look { opacity: 0.7, ..Look::solid(INK, 0.4, 0.0).dashed(&[3.0, 3.0]) }
        }
        StrokeKind::Fixed | StrokeKind::Movable => Look::solid(INK, 1.0, 0.35),
        StrokeKind::Before => Look::solid(INK, 0.6, 0.6).dashed(&[4.0, 3.0]),
        StrokeKind::Moved => Look::solid(palette.accent(), 1.5, 0.7),
    })
}

fn region_look(kind: RegionKind) -> Option<Look> {
    match kind {
        RegionKind::Query => Some(Look::solid(INK, 1.6, 0.0).dashed(&[6.0, 4.0])),
        RegionKind::Reference => Some(Look::solid(GREY, 1.4, 0.0).dashed(&[2.0, 4.0])),
        RegionKind::Keep | RegionKind::Move => None,
    }
}

pub(super) fn draw_foot(canvas: &mut Canvas, frame: &Frame, map: &HeatMap<'_>) {
    let u = frame.unit_px;
    let [top, left, right] = frame.foot();
    let wide = (430.0 * u).min((right - left) * 0.42);
    draw_legend(canvas, frame, map, [left, top, left + wide, top + 24.0 * u]);
    let end = frame.north(canvas, right, top + 62.0 * u);
    frame.scale_bar(canvas, end - 36.0 * u, top + 14.0 * u);
    frame.keys(canvas, top + 98.0 * u, &keys_of(frame, map));
}

/// The bar of colours with round numbers below and the unit beside it.
fn draw_legend(canvas: &mut Canvas, frame: &Frame, map: &HeatMap<'_>, [x0, y0, x1, y1]: [f32; 4]) {
    let u = frame.unit_px;
    let span = (x1 - x0).max(1.0);
    let few = few_values(map);
    canvas.block([x0, y0, x1, y1].map(|v| v.round() as i32), |x, _| {
        let at = f64::from((x as f32 + 0.5 - x0) / span);
        match few.as_deref() {
            Some(values) => {
                let near = |v: &&f64| (map.scale.fraction(**v) - at).abs();
                let nearest = values.iter().min_by(|a, b| near(a).total_cmp(&near(b)));
                map.palette.at(nearest.map_or(at, |v| map.scale.fraction(*v)))
            }
            None => map.palette.at(at),
        }
    });
    let values = match &few {
        Some(values) => values.clone(),
        None if map.scale.hi > map.scale.lo => ticks(map.scale.lo, map.scale.hi, 5),
        None => vec![map.scale.lo],
    };
    let letters = (22.0 * u, Weight::Regular, INK);
    let mut free_from = f32::NEG_INFINITY;
    for (value, label) in values.iter().zip(tick_labels(&values)) {
        let x = x0 + map.scale.fraction(*value) as f32 * span;
        canvas.line(&[[x, y1], [x, y1 + 6.0 * u]], Pen::solid(INK, 1.5 * u));
        let wide = super::font::width_px(&label, letters.0, letters.1);
        let middle = x.max(x0 + wide / 2.0);
        if middle - wide / 2.0 > free_from {
            canvas.text(&label, [middle, y1 + 28.0 * u], Anchor::Middle, letters);
            free_from = middle + wide / 2.0 + 10.0 * u;
        }
    }
    canvas.text(map.unit, [x1 + 16.0 * u, y1 - 3.0 * u], Anchor::Left, (22.0 * u, Weight::Regular, GREY));
}

/// Whole values, where the cells have so few of them that shades between would stand for nothing.
fn few_values(map: &HeatMap<'_>) -> Option<Vec<f64>> {
    let mut out: Vec<f64> = Vec::new();
    for value in map.cells.iter().filter_map(|c| c.value.filter(|v| v.is_finite())) {
        if !out.contains(&value) {
            out.push(value);
        }
        if out.len() > FEW_VALUES || value.fract() != 0.0 {
            return None;
        }
    }
    out.sort_by(f64::total_cmp);
    (out.len() > 1).then_some(out)
}

/// See [`few_values`].
const FEW_VALUES: usize = 6;

fn keys_of<'a>(frame: &Frame, map: &HeatMap<'_>) -> Vec<Key<'a>> {
    let u = frame.unit_px;
    let mut keys = Vec::new();
    if map.picture.has(StrokeKind::Moved) {
        keys.push(Key::line("moved", Pen::solid(map.palette.accent(), 5.0 * u)));
    }
    if map.picture.has(StrokeKind::Before) {
        let dash: &'static [f32] = if u < 1.0 { &[5.0, 3.5] } else { &[9.0, 6.0] };
        keys.push(Key::line("stood here before", Pen { dash_px: dash, ..Pen::solid(INK, 2.4 * u) }));
    }
    if map.cells.iter().any(|c| c.value.is_none()) {
        keys.push(Key::patch(map.no_value, unmeasured));
    }
    keys
}
