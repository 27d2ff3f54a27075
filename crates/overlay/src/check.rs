//! What was understood of a drawing, as a picture: floor and rooms, walls, solids, openings, regions, moves, what is
//! doubtful and what was left out.

use super::canvas::{Anchor, Canvas, Pen, path_of};
use super::font::{Weight, width_px};
use super::frame::{Frame, Key};
use super::palette::{GREY, INK, PAPER, Rgb};
use super::picture::{
    BUILT_LOOK, DEMOLISHED_LOOK, FloorShape, Look, PlanPicture, RegionKind, Stroke, StrokeKind, draw_alike,
    draw_region, draw_strokes,
};
use enfilade_report::Error;

const SOLID: Rgb = [0x8c, 0x91, 0x9a];
const MOVABLE: Rgb = [0x00, 0x72, 0xb2];
const PASSAGE: Rgb = [0x00, 0x9e, 0x73];
const DOOR: Rgb = [0xcc, 0x79, 0xa7];
const WINDOW: Rgb = [0x56, 0xb4, 0xe9];
const LEFT_OUT: Rgb = [0xc4, 0xc7, 0xcc];
const DOUBTFUL: Rgb = [0xf0, 0xc0, 0x20];
const FLOOR: Rgb = [0x8f, 0xbf, 0xd9];
const NOT_MEASURED: Rgb = [0xd9, 0x7a, 0x6a];
const MOVE_BOX: Rgb = [0xd5, 0x5e, 0x00];
const QUERY: Rgb = [0xe6, 0x9f, 0x00];
const REFERENCE: Rgb = [0x56, 0xb4, 0xe9];
const KEEP: Rgb = [0x88, 0x22, 0x55];

/// Draws what was taken as what, with keys for the kinds that are present, as PNG.
///
/// # Errors
/// As [`heat_map_png`](super::heat_map::heat_map_png).
pub fn check_png(
    picture: &PlanPicture,
    title: &str,
    subtitle: &str,
    longest_px: u32,
) -> Result<Vec<u8>, Error> {
    let draft = Frame::fit(picture.bounds, longest_px, true, 110.0)?;
    let samples = samples_of(picture);
    let words: Vec<&str> = samples.iter().map(|s| s.word).collect();
    let rows = Frame::key_rows(draft.size_px[0] as f32, draft.unit_px, &words);
    let frame = Frame::fit(picture.bounds, longest_px, true, 80.0 + 36.0 * rows as f32)?
        .with_north(picture.north_deg);
    let mut canvas = frame.sheet()?;
    draw_plan(&mut canvas, &frame, picture);
    frame.head(&mut canvas, title, subtitle);
    draw_foot(&mut canvas, &frame, &samples);
    canvas.into_png()
}

fn draw_plan(canvas: &mut Canvas, frame: &Frame, picture: &PlanPicture) {
    use RegionKind::{Keep, Move, Query, Reference};
    picture.floor.iter().for_each(|f| shade(canvas, frame, f));
    for kind in [Reference, Query, Keep, Move] {
        for region in picture.regions.iter().filter(|r| r.kind == kind) {
            let (look, tint) = region_look(kind);
            draw_region(canvas, frame, region, look, tint);
        }
    }
    draw_strokes(canvas, frame, &picture.strokes, stroke_look);
    draw_fixed(canvas, frame, picture);
    let movable = picture.strokes.iter().filter(|s| s.kind == StrokeKind::Movable);
    draw_alike(canvas, frame, movable, MOVABLE_LOOK);
    // A new wall is a wall too: in red it lies on its black.
    let built = picture.strokes.iter().filter(|s| s.kind == StrokeKind::Built);
    draw_alike(canvas, frame, built, BUILT_LOOK);
    draw_in_walls(canvas, frame, picture);
    picture.floor.iter().for_each(|f| name(canvas, frame, f));
}

/// Doors and windows in walls that are drawn through them: seen through all the same, so the wall is white there.
fn draw_in_walls(canvas: &mut Canvas, frame: &Frame, picture: &PlanPicture) {
    for (kind, look) in [(StrokeKind::Window, WINDOW_LOOK), (StrokeKind::Door, DOOR_LOOK)] {
        let all = picture.strokes.iter().filter(|s| s.kind == kind && s.filled);
        draw_alike(canvas, frame, all.clone(), Look::solid(PAPER, 1.0, 0.0));
        let outlines: Vec<Stroke> = all.map(|s| Stroke { filled: false, ..s.clone() }).collect();
        draw_alike(canvas, frame, outlines.iter(), look);
    }
}

/// How strongly floor is shaded.
const SHADE: f32 = 0.28;

fn shade(canvas: &mut Canvas, frame: &Frame, floor: &FloorShape) {
    let rgb = match floor.is_measured {
        Some(true) => FLOOR,
        Some(false) => NOT_MEASURED,
        None => return,
    };
    let rings: Vec<Vec<[f32; 2]>> =
        floor.rings.iter().map(|r| r.iter().map(|p| frame.to_px(*p)).collect()).collect();
    if let Some(path) = path_of(rings.iter().map(|r| (&r[..], true))) {
        canvas.fill(&path, rgb, SHADE);
    }
}

/// Letters of a room's name: the largest, and the smallest that are still read, nominal pixels.
const LETTERS_PX: [f32; 2] = [20.0, 11.0];

/// Writes into a room what it is called, as large as fits; where nothing fits, nothing.
fn name(canvas: &mut Canvas, frame: &Frame, floor: &FloorShape) {
    let u = frame.unit_px;
    let Some(room_px) = chord_m(floor).map(|m| (m * frame.px_per_m) as f32) else { return };
    let wide =
        |size: f32| floor.words.iter().map(move |w| width_px(w, size, Weight::Regular)).fold(0.0, f32::max);
    let size = LETTERS_PX[0] * u * (0.9 * room_px / wide(LETTERS_PX[0] * u).max(1.0)).min(1.0);
    let is_legible = size >= LETTERS_PX[1] * u;
    let words: &[String] =
        if is_legible { &floor.words } else { &floor.words[floor.words.len().saturating_sub(1)..] };
    let size = if is_legible { size } else { LETTERS_PX[1] * u };
    let all = words.iter().map(|w| width_px(w, size, Weight::Regular)).fold(0.0, f32::max);
    if all > room_px {
        return;
    }
    let [x, y] = frame.to_px(floor.at);
    let top = y - size * 1.2 * (words.len() as f32 - 1.0) / 2.0 + size * 0.35;
    for (k, word) in words.iter().enumerate() {
        let ink = if k + 1 == words.len() { GREY } else { INK };
        canvas.text(word, [x, top + size * 1.2 * k as f32], Anchor::Middle, (size, Weight::Regular, ink));
    }
}

/// How far a room reaches to both sides of its middle alike, metres.
fn chord_m(floor: &FloorShape) -> Option<f64> {
    let [x, y] = floor.at;
    let sides = floor.rings.iter().flat_map(|r| r.iter().zip(r.iter().cycle().skip(1)));
    let crossed = sides.filter(|(a, b)| (a[1] > y) != (b[1] > y));
    let off = crossed.map(|(a, b)| (a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) - x).abs());
    off.min_by(f64::total_cmp).map(|half| 2.0 * half)
}

/// Walls in ink; solids in grey with an outline, so that a column is told from a wall.
fn draw_fixed(canvas: &mut Canvas, frame: &Frame, picture: &PlanPicture) {
    let fixed = || picture.strokes.iter().filter(|s| s.kind == StrokeKind::Fixed);
    draw_alike(canvas, frame, fixed().filter(|s| s.filled), Look::solid(SOLID, 1.0, 0.0));
    let outlines: Vec<Stroke> =
        fixed().filter(|s| s.filled).map(|s| Stroke { filled: false, ..s.clone() }).collect();
    draw_alike(canvas, frame, outlines.iter(), Look::solid(INK, 0.5, 0.0));
    draw_alike(canvas, frame, fixed().filter(|s| !s.filled), FIXED_LOOK);
}

const FIXED_LOOK: Look = Look::solid(INK, 1.2, 0.0);
const MOVABLE_LOOK: Look = Look::solid(MOVABLE, 1.5, 0.4);
const PASSAGE_LOOK: Look = Look::solid(PASSAGE, 1.6, 0.0).dashed(&[2.0, 2.0]);
const DOOR_LOOK: Look = Look::solid(DOOR, 2.0, 0.0);
const WINDOW_LOOK: Look = Look::solid(WINDOW, 2.0, 0.0);
const DOUBTFUL_LOOK: Look = Look::solid(DOUBTFUL, 3.5, 0.0);
const IGNORED_LOOK: Look = Look::solid(LEFT_OUT, 0.5, 0.0);

/// Looks of what is neither fixed nor movable.
fn stroke_look(kind: StrokeKind) -> Option<Look> {
    match kind {
        StrokeKind::Fixed | StrokeKind::Movable | StrokeKind::Built => None,
        StrokeKind::Opening => Some(PASSAGE_LOOK),
        StrokeKind::Door => Some(DOOR_LOOK),
        StrokeKind::Window => Some(WINDOW_LOOK),
        StrokeKind::Ignored => Some(IGNORED_LOOK),
        StrokeKind::Doubtful => Some(DOUBTFUL_LOOK),
        StrokeKind::Demolished => Some(DEMOLISHED_LOOK),
        StrokeKind::Before => Some(Look::solid(GREY, 0.6, 0.0).dashed(&[4.0, 3.0])),
        StrokeKind::Moved => Some(MOVABLE_LOOK),
    }
}

fn region_look(kind: RegionKind) -> (Look, Option<f32>) {
    match kind {
        RegionKind::Query => (Look::solid(QUERY, 2.0, 0.0), Some(0.22)),
        RegionKind::Reference => (Look::solid(REFERENCE, 2.0, 0.0).dashed(&[5.0, 3.0]), Some(0.16)),
        RegionKind::Keep => (Look::solid(KEEP, 2.0, 0.0).dashed(&[8.0, 3.0, 2.0, 3.0]), Some(0.10)),
        RegionKind::Move => (Look::solid(MOVE_BOX, 2.0, 0.0).dashed(&[5.0, 4.0]), None),
    }
}

/// A kind that is present, its word and its colour; `tint` for regions.
struct Sample {
    word: &'static str,
    look: Look,
    tint: Option<f32>,
}

fn samples_of(picture: &PlanPicture) -> Vec<Sample> {
    let fixed =
        |filled: bool| picture.strokes.iter().any(|s| s.kind == StrokeKind::Fixed && s.filled == filled);
    let strokes = [
        (fixed(false), "wall, stays", FIXED_LOOK),
        (fixed(true), "solid, stays", Look::solid(SOLID, 2.2, 0.0)),
        (picture.has(StrokeKind::Movable), "may move", MOVABLE_LOOK),
        (picture.has(StrokeKind::Door), "door", DOOR_LOOK),
        (picture.has(StrokeKind::Window), "window", WINDOW_LOOK),
        (picture.has(StrokeKind::Opening), "passage", PASSAGE_LOOK),
        (picture.has(StrokeKind::Doubtful), "doubtful wall", DOUBTFUL_LOOK),
        (picture.has(StrokeKind::Demolished), "to be demolished", DEMOLISHED_LOOK),
        (picture.has(StrokeKind::Built), "to be built", BUILT_LOOK),
        (picture.has(StrokeKind::Ignored), "drawn, no wall", IGNORED_LOOK),
    ];
    let regions = [
        (RegionKind::Query, "measured here (query)"),
        (RegionKind::Reference, "to be seen (reference)"),
        (RegionKind::Move, "moves together"),
        (RegionKind::Keep, "stays as it is (keep)"),
    ];
    let strokes = strokes.into_iter().filter(|(is_there, ..)| *is_there);
    let strokes = strokes.map(|(_, word, look)| Sample { word, look, tint: None });
    let regions = regions.into_iter().filter(|(kind, _)| picture.regions.iter().any(|r| r.kind == *kind));
    let regions = regions.map(|(kind, word)| {
        let (look, tint) = region_look(kind);
        Sample { word, look, tint }
    });
    let floor = [(true, "measured floor", FLOOR), (false, "inside, not measured", NOT_MEASURED)];
    let floor = floor.into_iter().filter(|(is, ..)| picture.floor.iter().any(|f| f.is_measured == Some(*is)));
    let floor =
        floor.map(|(_, word, rgb)| Sample { word, look: Look::solid(rgb, 0.0, 0.0), tint: Some(SHADE) });
    floor.chain(strokes).chain(regions).collect()
}

fn draw_foot(canvas: &mut Canvas, frame: &Frame, samples: &[Sample]) {
    let u = frame.unit_px;
    let [top, _, right] = frame.foot();
    let end = frame.north(canvas, right, top + 62.0 * u);
    frame.scale_bar(canvas, end - 36.0 * u, top + 14.0 * u);
    let keys: Vec<Key<'_>> = samples.iter().map(|s| key_of(s, u)).collect();
    frame.keys(canvas, top + 74.0 * u, &keys);
}

fn key_of<'a>(sample: &Sample, u: f32) -> Key<'a> {
    let (look, tint) = (sample.look, sample.tint);
    let draw = move |canvas: &mut Canvas, [x0, y0, x1, y1]: [f32; 4]| {
        let width_px = (look.width * 3.0 * u).clamp(2.0 * u, 5.0 * u);
        let dash: Vec<f32> = look.dash.iter().map(|d| d * width_px.min(2.5 * u)).collect();
        let pen = Pen { dash_px: &dash, ..Pen::solid(look.rgb, width_px) };
        let middle = f32::midpoint(y0, y1);
        if let Some(opacity) = tint {
            let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
            if let Some(path) = super::canvas::path_of([(&corners[..], true)]) {
                canvas.fill(&path, look.rgb, opacity);
                canvas.stroke(&path, Pen { width_px: 2.0 * u, ..pen });
            }
        } else {
            canvas.line(&[[x0, middle], [x1, middle]], pen);
        }
    };
    Key { word: sample.word.to_owned(), draw: Box::new(draw) }
}
