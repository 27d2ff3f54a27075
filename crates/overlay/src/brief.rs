//! The brief of rooms as JSON (`enfilade.brief/1`), in words, and as a picture.

use serde::{Deserialize, Serialize};

use super::brief_item::{BriefFinding, BriefItem, VERDICTS, colour};
use super::canvas::{Anchor, Canvas, Pen, path_of};
use super::font::Weight;
use super::frame::{Frame, Key};
use super::palette::INK;
use super::picture::{PlanPicture, draw_strokes, faint};
use super::result::Input;
use enfilade_report::Error;

/// Name of the form.
pub const BRIEF_SCHEMA: &str = "enfilade.brief/1";

/// Everything that `enfilade brief` found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BriefResult {
    /// [`BRIEF_SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// What was read.
    pub input: Input,
    /// The rooms.
    pub rooms: Vec<BriefRoom>,
    /// The items, in their order.
    pub items: Vec<BriefItem>,
}

/// A room.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BriefRoom {
    /// Its number, from 1.
    pub id: usize,
    /// What the drawing calls it.
    pub name: String,
    /// What it is for.
    pub kind: String,
}

impl BriefResult {
    /// How many items have a verdict.
    pub fn count(&self, verdict: &str) -> usize {
        count(&self.items, verdict)
    }

    /// `3 items pass, 1 fails, 2 cannot be told from a plan.`
    pub fn summary(&self) -> String {
        summary(&self.items)
    }
}

fn count(items: &[BriefItem], verdict: &str) -> usize {
    items.iter().filter(|i| i.verdict == verdict).count()
}

fn summary(items: &[BriefItem]) -> String {
    let [pass, untold, fail] = VERDICTS.map(|v| count(items, v.0));
    let all = |n: usize| if n == 1 { "1 item".to_owned() } else { format!("{n} items") };
    let s = |n: usize| if n == 1 { "s" } else { "" };
    format!(
        "{}: {pass} pass{}, {fail} fail{}, {untold} cannot be told from a plan.",
        all(items.len()),
        if pass == 1 { "es" } else { "" },
        s(fail)
    )
}

/// How strongly ground is shaded: what fails more than what passes.
const SHADES: [f32; 2] = [0.18, 0.40];

/// Width of a line on the picture, in nominal pixels.
const LINE_PX: f32 = 4.0;

/// Corners of a circle on the picture.
const CORNERS: usize = 64;

/// The plan with each place of the brief in the colour of its verdict. `to_plan` takes metres of the drawing frame to
/// those of the plan.
///
/// # Errors
/// As [`heat_map_png`](super::heat_map::heat_map_png).
pub fn brief_png(
    picture: &PlanPicture,
    brief: &[BriefItem],
    to_plan: &dyn Fn([f64; 2]) -> [f64; 2],
    longest_px: u32,
) -> Result<Vec<u8>, Error> {
    let frame = Frame::fit(picture.bounds, longest_px, true, 142.0)?.with_north(picture.north_deg);
    let mut canvas = frame.sheet()?;
    let px = |p: &[f64; 2]| frame.to_px(to_plan(*p));
    // What fails lies above what passes.
    for (name, ..) in VERDICTS {
        for f in brief.iter().flat_map(|i| &i.findings).filter(|f| f.verdict == name) {
            shade(&mut canvas, f, &px);
        }
    }
    draw_strokes(&mut canvas, &frame, &picture.strokes, faint);
    for (name, ..) in VERDICTS {
        for f in brief.iter().flat_map(|i| &i.findings).filter(|f| f.verdict == name) {
            outline(&mut canvas, &frame, f, &px);
        }
    }
    name_rooms(&mut canvas, &frame, picture);
    frame.head(&mut canvas, "The brief of rooms", &summary(brief));
    foot(&mut canvas, &frame);
    canvas.into_png()
}

fn shade(canvas: &mut Canvas, f: &BriefFinding, px: &dyn Fn(&[f64; 2]) -> [f32; 2]) {
    let rings: Vec<Vec<[f32; 2]>> = f.ground.iter().map(|r| r.iter().map(px).collect()).collect();
    if let Some(path) = path_of(rings.iter().map(|r| (&r[..], true))) {
        canvas.fill(&path, colour(&f.verdict), SHADES[usize::from(f.verdict != "pass")]);
    }
}

fn outline(canvas: &mut Canvas, frame: &Frame, f: &BriefFinding, px: &dyn Fn(&[f64; 2]) -> [f32; 2]) {
    let pen = Pen::solid(colour(&f.verdict), LINE_PX * frame.unit_px);
    for line in &f.lines {
        canvas.line(&line.iter().map(px).collect::<Vec<_>>(), pen);
    }
    for [x, y, r] in &f.circles {
        let corner = |k: usize| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / CORNERS as f64).sin_cos();
            px(&[x + r * cos, y + r * sin])
        };
        let ring: Vec<[f32; 2]> = (0..=CORNERS).map(corner).collect();
        canvas.line(&ring, Pen { width_px: LINE_PX / 2.0 * frame.unit_px, ..pen });
    }
}

/// Letters of a room's name, nominal pixels.
const LETTERS_PX: f32 = 17.0;

/// The words of each room, the first two lines, where the room is wide enough for them.
fn name_rooms(canvas: &mut Canvas, frame: &Frame, picture: &PlanPicture) {
    let size = LETTERS_PX * frame.unit_px;
    for room in &picture.floor {
        let [x, y] = frame.to_px(room.at);
        let across = room.rings.iter().flatten().map(|p| frame.to_px(*p)[0]);
        let (lo, hi) = across.fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
        let fits = |words: &&String| super::font::width_px(words, size, Weight::Regular) <= hi - lo;
        for (i, words) in room.words.iter().take(2).take_while(fits).enumerate() {
            let at = [x, y + i as f32 * 1.3 * size];
            canvas.text(words, at, Anchor::Middle, (size, Weight::Regular, INK));
        }
    }
}

fn foot(canvas: &mut Canvas, frame: &Frame) {
    let u = frame.unit_px;
    let [top, _, right] = frame.foot();
    let end = frame.north(canvas, right, top + 62.0 * u);
    frame.scale_bar(canvas, end - 36.0 * u, top + 14.0 * u);
    let words = ["passes", "cannot be told from a plan", "fails"];
    let keys: Vec<Key<'_>> =
        VERDICTS.iter().zip(words).map(|(v, word)| Key::line(word, Pen::solid(v.2, LINE_PX * u))).collect();
    frame.keys(canvas, top + 74.0 * u, &keys);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_counted() {
        let item = |verdict: &str| BriefItem { verdict: verdict.into(), ..BriefItem::default() };
        let result = BriefResult { items: vec![item("fail")], ..BriefResult::default() };
        assert_eq!(result.summary(), "1 item: 0 pass, 1 fails, 0 cannot be told from a plan.");
        let result = BriefResult { items: ["pass", "pass", "untold"].map(item).to_vec(), ..result };
        assert_eq!(result.summary(), "3 items: 2 pass, 0 fail, 1 cannot be told from a plan.");
    }
}
