//! All options superimposed on the present layout.

use super::canvas::{Canvas, Pen};
use super::frame::{Frame, Key};
use super::palette::{Rgb, option_style};
use super::picture::{Look, PlanPicture, Stroke, StrokeKind, draw_alike, draw_strokes};
use enfilade_report::{Error, counted};

/// How far apart the options are drawn, in line widths, so that none hides another.
const ASIDE: f32 = 0.8;
const PRESENT: Rgb = [0x9a, 0x9e, 0xa6];

/// Draws the present layout in grey and what each member moves in its own colour and dash, as PNG.
/// `members[i]` are the strokes to show of the i-th option (what moved), `labels[i]` its name.
///
/// # Errors
/// As [`heat_map_png`](super::heat_map::heat_map_png).
pub fn diversity_png(
    present: &PlanPicture,
    members: &[Vec<Stroke>],
    labels: &[String],
    longest_px: u32,
) -> Result<Vec<u8>, Error> {
    let draft = Frame::fit(present.bounds, longest_px, true, 110.0)?;
    let words: Vec<&str> =
        std::iter::once("present layout").chain(labels.iter().map(String::as_str)).collect();
    let rows = Frame::key_rows(draft.size_px[0] as f32, draft.unit_px, &words);
    let frame = Frame::fit(present.bounds, longest_px, true, 80.0 + 36.0 * rows as f32)?
        .with_north(present.north_deg);
    let mut canvas = frame.sheet()?;
    draw_strokes(&mut canvas, &frame, &present.strokes, present_look);
    for (i, member) in members.iter().enumerate() {
        let (rgb, dash) = option_style(i);
        let aside = (i as f32 - (members.len() - 1) as f32 / 2.0) * ASIDE * frame.line_px;
        draw_alike(
            &mut canvas,
            &frame.shifted([aside, aside]),
            member.iter(),
            Look::solid(rgb, 1.0, 0.2).dashed(dash),
        );
    }
    let title = format!("{} over the present layout", counted(members.len() as u64, "option"));
    frame.head(&mut canvas, &title, "What moves is in colour. Lines that coincide are drawn side by side.");
    draw_foot(&mut canvas, &frame, members.len(), labels);
    canvas.into_png()
}

fn present_look(kind: StrokeKind) -> Option<Look> {
    match kind {
        StrokeKind::Fixed | StrokeKind::Movable | StrokeKind::Moved | StrokeKind::Built => {
            Some(Look::solid(PRESENT, 0.9, 0.0))
        }
        StrokeKind::Ignored
        | StrokeKind::Opening
        | StrokeKind::Door
        | StrokeKind::Window
        | StrokeKind::Doubtful
        | StrokeKind::Demolished
        | StrokeKind::Before => None,
    }
}

fn draw_foot(canvas: &mut Canvas, frame: &Frame, members: usize, labels: &[String]) {
    let u = frame.unit_px;
    let [top, _, right] = frame.foot();
    let end = frame.north(canvas, right, top + 62.0 * u);
    frame.scale_bar(canvas, end - 36.0 * u, top + 14.0 * u);
    let dashes: Vec<Vec<f32>> =
        (0..members).map(|i| option_style(i).1.iter().map(|d| d * 2.2 * u).collect()).collect();
    let present = Key::line("present layout", Pen::solid(PRESENT, 4.0 * u));
    let options = dashes.iter().zip(labels).enumerate().map(|(i, (dash, label))| {
        let pen = Pen { dash_px: dash, ..Pen::solid(option_style(i).0, 4.5 * u) };
        Key::line(label.as_str(), pen)
    });
    let keys: Vec<Key<'_>> = std::iter::once(present).chain(options).collect();
    frame.keys(canvas, top + 74.0 * u, &keys);
}
