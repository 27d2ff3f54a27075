//! Building works as JSON (`works.json`), in words, and as a picture.

use std::collections::BTreeMap;

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::built::Effort;
use super::canvas::{Anchor, Canvas, Pen};
use super::font::Weight;
use super::frame::Frame;
use super::heat_map::{HeatMap, draw_foot};
use super::palette::{GREY, Palette, Rgb, Scale};
use super::picture::{PlanPicture, draw_strokes, faint};
use super::result::{ElementRef, Input, Interval};
use enfilade_cad::drawing::{Addition, Mark};
use enfilade_cad::own_layers;
use enfilade_report::Error;

/// Name of the form.
pub const WORKS_SCHEMA: &str = "enfilade.works/1";

/// Everything that `enfilade works` found.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WorksResult {
    /// [`WORKS_SCHEMA`].
    pub schema: String,
    /// Version of the program.
    pub version: String,
    /// What was read.
    pub input: Input,
    /// Distance of the cells, metres.
    pub spacing_m: f64,
    /// How many there are.
    pub cells: usize,
    /// The rooms.
    pub rooms: Vec<RoomEntry>,
    /// The works, those that bring most first.
    pub works: Vec<WorkEntry>,
    /// The best allowed work, and among how many it was looked for.
    pub best: BestEntry,
}

/// A room.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RoomEntry {
    /// Its number in this list, from 1.
    pub id: usize,
    /// What the drawing calls it.
    pub name: String,
    /// What it is for.
    pub kind: String,
    /// Whether no more of it may be seen from elsewhere.
    pub is_private: bool,
    /// Its dwelling, from 1, where there are several.
    pub dwelling: Option<usize>,
    /// Its area.
    pub area_m2: f64,
    /// A point inside, metres in the drawing frame.
    pub at: [f64; 2],
}

/// One building work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WorkEntry {
    /// Its number, from 1.
    pub id: usize,
    /// `open`, `door`, `widen`, `close`, `rehang`, `end`, `remove`, `glaze`, `add`.
    pub kind: String,
    /// What draws its wall.
    pub wall: Vec<ElementRef>,
    /// Ends of the stretch on the wall's axis, metres in the drawing frame.
    pub stretch: [[f64; 2]; 2],
    /// Clear width, or length, metres.
    pub width_m: f64,
    /// The rooms on both sides, by `id`; `null`: none.
    pub rooms: [Option<usize>; 2],
    /// What it brings, as a share of the present value: above 0 is better, whatever the measure.
    pub gain: BTreeMap<String, WorkGain>,
    /// What it costs.
    pub effort: Effort,
    /// Whether no rule forbids it.
    pub is_allowed: bool,
    /// Whether more of a private room is seen while that room's doors stand open.
    pub shows_through_doors: bool,
    /// Codes of the rules that forbid it.
    pub forbidden_by: Vec<String>,
}

/// A gain; the interval only where it was measured again on other lattices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WorkGain {
    /// Share of the present value.
    pub share: f64,
    /// Low end of the 95 % interval.
    pub low: Option<f64>,
    /// High end.
    pub high: Option<f64>,
}

impl From<Interval> for WorkGain {
    fn from(i: Interval) -> Self {
        Self { share: i.value, low: Some(i.low), high: Some(i.high) }
    }
}

/// The best single work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BestEntry {
    /// Its `id`; `null` where no allowed work brings anything.
    pub single: Option<usize>,
    /// Places that were measured.
    pub tried: usize,
    /// Those of them that no rule forbids.
    pub legal: usize,
}

/// Name of the measure of sight in [`WorkEntry::gain`].
pub const VISIBILITY: &str = "visibility";
/// Name of the measure of turns.
pub const STEPS: &str = "steps";

impl WorksResult {
    /// The command that draws a work of the list.
    pub fn making(&self, number: &str) -> String {
        format!("enfilade works {} --make {number}", self.input.argument())
    }

    /// What a room is called in a sentence: its name, else its kind, else its number.
    pub fn room_words(&self, id: Option<usize>) -> String {
        let Some(room) = id.and_then(|id| self.rooms.iter().find(|r| r.id == id)) else {
            return "outside".into();
        };
        match (without_area(&room.name), room.kind.as_str()) {
            ("", "" | "unknown" | "other") => format!("room {}", room.id),
            ("", kind) => format!("{kind} {}", room.id),
            (name, _) => name.into(),
        }
    }

    /// `An opening of 1.8 m between kitchen and living room`.
    pub fn title(&self, work: &WorkEntry) -> String {
        let [a, b] = work.rooms.map(|r| self.room_words(r));
        let where_ = if a == b { format!("in {a}") } else { format!("between {a} and {b}") };
        let m = format!("{:.1} m", work.width_m);
        match work.kind.as_str() {
            "door" => format!("A door of {m} {where_}"),
            "glaze" => format!("Glass of {m} {where_}"),
            "widen" => format!("The opening {where_} widened to {m}"),
            "close" => format!("The opening of {m} {where_} walled up"),
            "rehang" => format!("The door of {m} {where_} moved along its wall"),
            "end" => format!("The end of the wall {where_} taken back by {m}"),
            // Openings in it are gone already.
            "remove" => format!("The wall {where_} removed ({:.1} m)", work.effort.demolished_m),
            "add" => format!("A wall of {m} {where_}"),
            _ => format!("An opening of {m} {where_}"),
        }
    }

    /// `visibility +17 % (15 to 18), steps −3.7 %`: what changes, as the measure itself changes.
    pub fn gain_words(work: &WorkEntry) -> String {
        let mut out = Vec::new();
        if let Some(g) = work.gain.get(VISIBILITY) {
            let interval = match (g.low, g.high) {
                (Some(low), Some(high)) => {
                    format!(" ({} to {})", number(low.min(g.share)), number(high.max(g.share)))
                }
                _ => String::new(),
            };
            out.push(format!("visibility {}{interval}", percent(g.share)));
        }
        if let Some(g) = work.gain.get(STEPS).filter(|g| g.share.abs() >= 0.0005) {
            // Fewer steps are better: the number falls.
            out.push(format!("steps {}", percent(-g.share)));
        }
        out.join(", ")
    }

    /// One line: title, gain, effort, and the rule of what is forbidden.
    pub fn line(&self, work: &WorkEntry) -> String {
        let mut line = format!("{}: {}{}", self.title(work), Self::gain_words(work), self.whole(work));
        if work.is_allowed && work.shows_through_doors {
            line += "; it shows more of a private room while that room's door stands open";
        }
        if !work.is_allowed {
            line += &format!("; not offered: {}", self.rule_words(work));
        }
        line
    }

    /// Why a work is not offered.
    pub fn rule_words(&self, work: &WorkEntry) -> String {
        let private = || {
            let of = work.rooms.iter().flatten().filter_map(|id| self.rooms.iter().find(|r| r.id == *id));
            let of = of.filter(|r| r.is_private).map(|r| self.room_words(Some(r.id))).collect::<Vec<_>>();
            let verb = if of.len() == 1 { "stays" } else { "stay" };
            format!("{} {verb}", of.join(" and "))
        };
        let one = |code: &String| match code.as_str() {
            "private-room" => format!("{} private", private()),
            "shows-private-room" => "more of a private room would be seen".into(),
            "thick-wall" => "the wall is thick enough to carry".into(),
            "bearing-wall" => "the wall is load-bearing".into(),
            "stacked-wall" => "it stands over or under a wall of another storey".into(),
            "party-wall" | "between-dwellings" => "the wall parts two dwellings".into(),
            "fire-wall" => "the wall is a fire wall".into(),
            "core-wall" => "the wall stands at a stair or a lift".into(),
            "outer-wall" => "the wall is an outer wall".into(),
            "last-door" => "the room would lose its last door".into(),
            "kept" => "a mark keeps the wall".into(),
            "not-marked" => "no mark allows it".into(),
            "blocked" => "something that stays stands before it".into(),
            other => other.to_owned(),
        };
        let mut all: Vec<String> = Vec::new();
        for words in work.forbidden_by.iter().map(one) {
            if !all.contains(&words) {
                all.push(words);
            }
        }
        all.join("; ")
    }

    /// The best of each pair of rooms, allowed or not, at most so many. A whole wall stands for its pair only where nothing
    /// smaller does: it always shows more, and costs more than most people want.
    pub fn different(&self, is_allowed: bool, most: usize) -> Vec<&WorkEntry> {
        self.different_of(most, |w| w.is_allowed == is_allowed)
    }

    /// The same of works that a caller takes.
    pub fn different_of(&self, most: usize, is_taken: impl Fn(&WorkEntry) -> bool) -> Vec<&WorkEntry> {
        let pair = |w: &WorkEntry| {
            let mut pair = w.rooms;
            pair.sort_unstable();
            pair
        };
        let share = |w: &WorkEntry| w.gain.get(VISIBILITY).map_or(0.0, |g| g.share);
        let (small, whole): (Vec<&WorkEntry>, Vec<&WorkEntry>) =
            self.gaining(is_taken).into_iter().partition(|w| w.kind != "remove");
        let mut out: Vec<&WorkEntry> = Vec::new();
        for work in small.into_iter().chain(whole) {
            if !out.iter().any(|o| pair(o) == pair(work)) {
                out.push(work);
            }
        }
        out.sort_by(|a, b| share(b).total_cmp(&share(a)));
        out.truncate(most);
        out
    }

    /// The works that a caller takes and that bring something, those that bring most first. Glass always shows more and joins
    /// nothing: it is among them where it is all that may be done.
    pub fn gaining(&self, is_taken: impl Fn(&WorkEntry) -> bool) -> Vec<&WorkEntry> {
        let is_all_glass = self.works.iter().filter(|w| is_taken(w)).all(|w| w.kind == "glaze");
        let share = |w: &WorkEntry| w.gain.get(VISIBILITY).map_or(0.0, |g| g.share);
        let may =
            |w: &&WorkEntry| is_taken(w) && (is_all_glass || w.kind != "glaze") && share(w) > LEAST_SHOWN;
        self.works.iter().filter(may).collect()
    }

    /// What no wall at all would bring between the same rooms, where that is allowed and another work was named.
    fn whole(&self, work: &WorkEntry) -> String {
        let is_of = |w: &WorkEntry| w.wall.iter().any(|e| work.wall.contains(e)) || work.wall.is_empty();
        let same = |w: &&WorkEntry| w.kind == "remove" && w.is_allowed && w.rooms == work.rooms && is_of(w);
        match self.works.iter().find(same).filter(|w| w.id != work.id).and_then(|w| w.gain.get(VISIBILITY)) {
            Some(g) if work.is_allowed => format!(" (without the wall {})", percent(g.share)),
            _ => String::new(),
        }
    }

    /// `Of 212 legal places, none brings more.`
    pub fn proof(&self) -> String {
        match self.best.single {
            Some(_) if self.best.legal == 0 => format!("{} places were tried.", self.best.tried),
            Some(_) => {
                format!("Of {} legal places of {} tried, none brings more.", self.best.legal, self.best.tried)
            }
            None => format!("{} places were tried; none is both allowed and better.", self.best.tried),
        }
    }
}

/// A name without the area and the number that stand behind it: `Kitchen` of `Kitchen 9.9 m2`.
fn without_area(name: &str) -> &str {
    let area = name
        .split_whitespace()
        .skip(1)
        .find(|w| w.contains(['.', ',']) && w.chars().next().is_some_and(|c| c.is_ascii_digit()));
    area.and_then(|w| name.find(w)).map_or(name, |at| name[..at].trim_end())
}

/// Gains below this are trifles: half of what is offered as an option.
pub const LEAST_SHOWN: f64 = 0.005;

fn percent(share: f64) -> String {
    let sign = if share < 0.0 { "−" } else { "+" };
    format!("{sign}{} %", number(share.abs()))
}

/// Per cent, as many digits as are read.
fn number(share: f64) -> String {
    let p = share * 100.0;
    if p.abs() < 9.95 { format!("{p:.1}").replace('-', "−") } else { format!("{p:.0}").replace('-', "−") }
}

/// A wall in the picture of works.
#[derive(Clone, Debug, PartialEq)]
pub struct ColouredWall {
    /// Ends of its axis, metres, plan frame.
    pub ends: [[f64; 2]; 2],
    /// Thickness, metres.
    pub thickness_m: f64,
    /// The best that an opening there brings, a share.
    pub share: f64,
    /// Whether that is allowed.
    pub is_allowed: bool,
}

/// The walls as filled bars on `EF-WORKS`, each in the colour of the best that an opening in it would bring.
pub fn works_additions(walls: &[ColouredWall]) -> Vec<Addition> {
    let scale = scale_of(walls);
    let bar = |wall: &ColouredWall| {
        let [a, b] = wall.ends.map(DVec2::from);
        let half = (b - a).try_normalize()?.perp() * (wall.thickness_m.max(BAR_LEAST_M) / 2.0);
        let rgb = colour_of(wall, scale);
        let mark = Mark::Fill { corners: [a + half, a - half, b - half, b + half] };
        Some(Addition { layer: own_layers::WORKS.to_owned(), rgb, mark })
    };
    walls.iter().filter_map(bar).collect()
}

/// Least width of a bar in a drawing, metres: a wall of one line is seen too.
const BAR_LEAST_M: f64 = 0.05;

/// From nothing to the best that is allowed, per cent.
fn scale_of(walls: &[ColouredWall]) -> Scale {
    Scale::of([0.0, walls.iter().filter(|w| w.is_allowed).map(|w| 100.0 * w.share).fold(1.0, f64::max)])
}

fn colour_of(wall: &ColouredWall, scale: Scale) -> Rgb {
    if wall.is_allowed { PALETTE.at(scale.fraction(100.0 * wall.share)) } else { FORBIDDEN }
}

/// Colours of gains.
const PALETTE: Palette = Palette::Viridis;

/// Colour of walls in which nothing is allowed.
const FORBIDDEN: Rgb = [0xa8, 0xad, 0xb5];
/// Least width of a coloured wall on the sheet, in nominal px: thin partitions are what the picture is about.
const WALL_LEAST_PX: f32 = 9.0;

/// The plan with each wall in the colour of the best that an opening in it would bring.
///
/// # Errors
/// As [`heat_map_png`](super::heat_map_png).
pub fn works_png(
    picture: &PlanPicture,
    walls: &[ColouredWall],
    (title, subtitle): (&str, &str),
    longest_px: u32,
) -> Result<Vec<u8>, Error> {
    let scale = scale_of(walls);
    let map = HeatMap {
        picture,
        cells: &[],
        spacing_m: 0.0,
        scale,
        title,
        subtitle,
        unit: "% more visibility by one opening; grey: not allowed",
        no_value: "not allowed",
        palette: PALETTE,
    };
    let frame = Frame::fit(picture.bounds, longest_px, true, 142.0)?.with_north(picture.north_deg);
    let mut canvas = frame.sheet()?;
    draw_strokes(&mut canvas, &frame, &picture.strokes, faint);
    let (lo, hi) = (frame.to_px([0.0, 0.0]), frame.to_px([1.0, 0.0]));
    let px_per_m = (hi[0] - lo[0]).hypot(hi[1] - lo[1]);
    let mut order: Vec<&ColouredWall> = walls.iter().collect();
    order.sort_by(|a, b| {
        (a.is_allowed, a.share).partial_cmp(&(b.is_allowed, b.share)).unwrap_or(std::cmp::Ordering::Equal)
    });
    for wall in order {
        let rgb = colour_of(wall, scale);
        let width = (wall.thickness_m as f32 * px_per_m).max(WALL_LEAST_PX * frame.unit_px);
        canvas.line(&wall.ends.map(|p| frame.to_px(p)), Pen::solid(GREY, width + 3.0 * frame.unit_px));
        canvas.line(&wall.ends.map(|p| frame.to_px(p)), Pen::solid(rgb, width));
    }
    name_rooms(&mut canvas, &frame, picture);
    frame.head(&mut canvas, title, subtitle);
    draw_foot(&mut canvas, &frame, &map);
    canvas.into_png()
}

/// The words of each room, the first two lines, where the room is wide enough for them.
fn name_rooms(canvas: &mut Canvas, frame: &Frame, picture: &PlanPicture) {
    let size = 19.0 * frame.unit_px;
    for room in &picture.floor {
        let [x, y] = frame.to_px(room.at);
        let across = room.rings.iter().flatten().map(|p| frame.to_px(*p)[0]);
        let (lo, hi) = across.fold((f32::INFINITY, f32::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)));
        let fits = |words: &&String| super::font::width_px(words, size, Weight::Regular) <= hi - lo;
        for (i, words) in room.words.iter().take(2).take_while(fits).enumerate() {
            let at = [x, y + i as f32 * 1.3 * size];
            canvas.text(words, at, Anchor::Middle, (size, Weight::Regular, GREY));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn result() -> WorksResult {
        let room = |id, name: &str, kind: &str, is_private| RoomEntry {
            id,
            name: name.into(),
            kind: kind.into(),
            is_private,
            ..Default::default()
        };
        let work = |kind: &str, rooms, share, forbidden: &[&str]| WorkEntry {
            kind: kind.into(),
            width_m: 1.8,
            rooms,
            gain: BTreeMap::from([
                (VISIBILITY.to_owned(), WorkGain { share, low: Some(0.15), high: Some(0.18) }),
                (STEPS.to_owned(), WorkGain { share: 0.037, low: None, high: None }),
            ]),
            is_allowed: forbidden.is_empty(),
            forbidden_by: forbidden.iter().map(|c| (*c).to_owned()).collect(),
            ..Default::default()
        };
        WorksResult {
            rooms: vec![
                room(1, "Kitchen", "kitchen", false),
                room(2, "Living room", "living", false),
                room(3, "", "bedroom", true),
            ],
            works: vec![
                work("open", [Some(3), Some(2)], 0.3, &["private-room"]),
                work("open", [Some(1), Some(2)], 0.17, &[]),
                work("door", [Some(2), Some(1)], 0.1, &[]),
            ],
            ..Default::default()
        }
    }

    #[test]
    fn a_work_in_a_line() {
        let r = result();
        assert_eq!(
            r.line(&r.works[1]),
            "An opening of 1.8 m between Kitchen and Living room: visibility +17 % (15 to 18), steps −3.7 %"
        );
        assert!(r.line(&r.works[0]).ends_with("not offered: bedroom 3 stays private"));
    }

    #[test]
    fn one_of_each_pair_of_rooms_is_shown() {
        let r = result();
        assert_eq!(r.different(true, 5).len(), 1);
        assert_eq!(r.different(false, 5).len(), 1);
    }
}
