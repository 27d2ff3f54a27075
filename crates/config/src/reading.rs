//! Corrections of how a drawing is read: the `[reading]` table and the options of the same names.

use std::fmt;
use std::str::FromStr;

use globset::GlobBuilder;
use serde::{Deserialize, Serialize};
use toml::{Spanned, Value};

use enfilade_report::{Error, Place};

/// What a selector may begin with.
const KINDS: [&str; 3] = ["handle", "layer", "block"];

/// Names entities: `handle:2F3`, `layer:A-FURN*`, `block:SINK-*`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct SelectorText(String);

impl SelectorText {
    /// As stated.
    pub fn as_str(&self) -> &str {
        &self.0
    }

    fn is_handle(&self) -> bool {
        self.0.starts_with("handle:")
    }

    /// Whether all that another one names is named here too.
    fn covers(&self, other: &Self) -> bool {
        let glob = GlobBuilder::new(&self.0.to_lowercase()).backslash_escape(true).build();
        let (mine, theirs) = (self.0.to_lowercase(), other.0.to_lowercase());
        mine == theirs || glob.is_ok_and(|g| g.compile_matcher().is_match(&theirs))
    }
}

impl FromStr for SelectorText {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (kind, glob) = text.split_once(':').unwrap_or_default();
        let is_known = KINDS.contains(&kind.trim()) && !glob.trim().is_empty();
        let is_glob = GlobBuilder::new(glob).backslash_escape(true).build().is_ok();
        match is_known && is_glob {
            true => Ok(Self(format!("{}:{}", kind.trim(), glob.trim()))),
            false => Err(format!(
                "found {text:?}, expected handle:NAME, layer:NAME or block:NAME; * and ? may stand in NAME"
            )),
        }
    }
}

impl TryFrom<String> for SelectorText {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<SelectorText> for String {
    fn from(selector: SelectorText) -> Self {
        selector.0
    }
}

impl fmt::Display for SelectorText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A drawing of a sheet: its name, its number, or a box round it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ViewText {
    /// Name, number or box as `--view` takes them.
    Name(String),
    /// Its number.
    Number(u32),
    /// xmin, ymin, xmax, ymax in drawing units.
    Box([f64; 4]),
}

impl fmt::Display for ViewText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Number(number) => write!(f, "{number}"),
            Self::Box([x0, y0, x1, y1]) => write!(f, "{x0},{y0},{x1},{y1}"),
        }
    }
}

/// What a room is for: `3=bath`, by the number that `check` shows.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct RoomText {
    number: usize,
    kind: String,
}

impl RoomText {
    /// The room's number, from 1.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The kind, as stated.
    pub fn kind(&self) -> &str {
        &self.kind
    }
}

impl FromStr for RoomText {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (number, kind) = text.split_once('=').unwrap_or_default();
        match (number.trim().parse(), kind.trim()) {
            (Ok(number), kind) if number > 0 && !kind.is_empty() => Ok(Self { number, kind: kind.into() }),
            _ => Err(format!("found {text:?}, expected NUMBER=KIND, as 3=bath")),
        }
    }
}

impl TryFrom<String> for RoomText {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<RoomText> for String {
    fn from(room: RoomText) -> Self {
        room.to_string()
    }
}

impl fmt::Display for RoomText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.number, self.kind)
    }
}

/// Corrections. Each changes what it names and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ReadingTable {
    /// As `unit` outside the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
    /// As `view` outside the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<ViewText>,
    /// These stop sight as walls.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall: Vec<SelectorText>,
    /// These are no walls.
    #[serde(skip_serializing_if = "Vec::is_empty", alias = "not-wall")]
    pub not_wall: Vec<SelectorText>,
    /// These show doors.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub door: Vec<SelectorText>,
    /// These show windows.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub window: Vec<SelectorText>,
    /// The floor round these is measured, drawing units.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub inside: Vec<[f64; 2]>,
    /// The floor round these is not, drawing units.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<[f64; 2]>,
    /// What rooms are for.
    #[serde(skip_serializing_if = "Vec::is_empty", alias = "room")]
    pub rooms: Vec<RoomText>,
    /// Every line of the chosen layers stops sight; nothing is interpreted.
    #[serde(skip_serializing_if = "Option::is_none", alias = "as-drawn")]
    pub as_drawn: Option<bool>,
}

impl ReadingTable {
    /// Whether it says nothing.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// This source's corrections and those of `base`, where none of this source contradicts them.
    #[must_use]
    pub fn over(self, mut base: Self) -> Self {
        let mine = [&self.wall, &self.not_wall, &self.door, &self.window];
        let theirs = [&mut base.wall, &mut base.not_wall, &mut base.door, &mut base.window];
        for (k, list) in theirs.into_iter().enumerate() {
            let others = || mine.iter().enumerate().filter(|(j, _)| *j != k).flat_map(|(_, l)| l.iter());
            list.retain(|s| !mine[k].contains(s) && !others().any(|o| o.covers(s)));
        }
        base.inside.retain(|p| !self.outside.contains(p) && !self.inside.contains(p));
        base.outside.retain(|p| !self.inside.contains(p) && !self.outside.contains(p));
        base.rooms.retain(|r| self.rooms.iter().all(|own| own.number != r.number));
        fn joined<T>(mine: Vec<T>, theirs: Vec<T>) -> Vec<T> {
            mine.into_iter().chain(theirs).collect()
        }
        Self {
            unit: self.unit.or(base.unit),
            view: self.view.or(base.view),
            wall: joined(self.wall, base.wall),
            not_wall: joined(self.not_wall, base.not_wall),
            door: joined(self.door, base.door),
            window: joined(self.window, base.window),
            inside: joined(self.inside, base.inside),
            outside: joined(self.outside, base.outside),
            rooms: joined(self.rooms, base.rooms),
            as_drawn: self.as_drawn.or(base.as_drawn),
        }
    }

    /// The options of the command line that say the same: name and value.
    pub fn options(&self) -> Vec<(&'static str, String)> {
        let lists = [
            ("wall", &self.wall),
            ("not-wall", &self.not_wall),
            ("door", &self.door),
            ("window", &self.window),
        ];
        let points = [("inside", &self.inside), ("outside", &self.outside)];
        let named = lists.into_iter().flat_map(|(key, list)| list.iter().map(move |s| (key, s.to_string())));
        let placed = points
            .into_iter()
            .flat_map(|(key, list)| list.iter().map(move |[x, y]| (key, format!("{x},{y}"))));
        let rooms = self.rooms.iter().map(|r| ("room", r.to_string()));
        named.chain(placed).chain(rooms).collect()
    }
}

/// What of `[reading]` is of one drawing alone, with its place in the file.
#[derive(Default, Deserialize)]
#[serde(default)]
struct OfOneDrawing {
    wall: Vec<Spanned<SelectorText>>,
    #[serde(alias = "not-wall")]
    not_wall: Vec<Spanned<SelectorText>>,
    door: Vec<Spanned<SelectorText>>,
    window: Vec<Spanned<SelectorText>>,
    view: Option<Spanned<Value>>,
    inside: Option<Spanned<Value>>,
    outside: Option<Spanned<Value>>,
    #[serde(alias = "room")]
    rooms: Option<Spanned<Value>>,
}

/// Refuses corrections in a folder's settings that can mean one drawing alone: handles, points, a view.
///
/// # Errors
/// [`Error::Usage`], `reading-of-one-drawing`, with line and column.
pub fn for_folder(name: &str, text: &str) -> Result<(), Error> {
    #[derive(Deserialize)]
    struct File {
        #[serde(default)]
        reading: OfOneDrawing,
    }
    let Ok(File { reading: r }) = toml::from_str(text) else { return Ok(()) };
    let handles = [r.wall, r.not_wall, r.door, r.window].into_iter().flatten();
    let handle = handles.filter(|s| s.get_ref().is_handle()).map(|s| (s.span(), "a handle"));
    let points = [r.inside, r.outside].into_iter().flatten().map(|p| (p.span(), "a point"));
    let view = r.view.map(|v| (v.span(), "a view"));
    let rooms = r.rooms.map(|v| (v.span(), "a room"));
    let Some((span, what)) = handle.chain(points).chain(view).chain(rooms).min_by_key(|(span, _)| span.start)
    else {
        return Ok(());
    };
    let text_of = format!("[reading]: {what} belongs to one drawing; move it to <drawing>.enfilade.toml");
    Err(Error::usage("reading-of-one-drawing", place_in(name, text, span.start), text_of))
}

/// Line and column of a byte of a settings file.
pub(super) fn place_in(name: &str, text: &str, byte: usize) -> Place {
    let before = &text[..byte.min(text.len())];
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    Place::line(name, before.matches('\n').count() + 1).entity(format!("column {column}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Partial, Settings};

    fn selectors(list: &[&str]) -> Vec<SelectorText> {
        list.iter().map(|s| s.parse().unwrap()).collect()
    }

    #[test]
    fn selectors_are_read() {
        assert_eq!(selectors(&["layer: A-* "])[0].as_str(), "layer:A-*");
        for wrong in ["A-WALL", "layer:", "colour:3", "layer:[a"] {
            assert!(wrong.parse::<SelectorText>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn rooms_are_read_and_the_nearer_source_counts() {
        let room = |text: &str| text.parse::<RoomText>();
        assert_eq!(room(" 3 = bath ").map(|r| r.to_string()), Ok("3=bath".into()));
        for wrong in ["bath", "0=bath", "3=", "x=bath", "-1=bath"] {
            assert!(room(wrong).is_err(), "{wrong}");
        }
        let table = |rooms: &[&str]| ReadingTable {
            rooms: rooms.iter().map(|r| r.parse().unwrap()).collect(),
            ..ReadingTable::default()
        };
        assert_eq!(table(&["3=bath"]).over(table(&["3=wc", "4=hall"])), table(&["3=bath", "4=hall"]));
        assert_eq!(table(&["3=bath"]).options(), [("room", "3=bath".to_owned())]);
    }

    #[test]
    fn wrong_ones_have_line_and_column() {
        let at = |text: &str| match Partial::from_toml("plan.enfilade.toml", text).unwrap_err() {
            Error::Usage(p) => (p.place.line, p.place.entity),
            other => panic!("{other}"),
        };
        assert_eq!(at("[reading]\nwall = [\"layer:A\", \"B\"]\n"), (Some(2), "column 8".into()));
        assert_eq!(at("[reading]\n  walls = []\n"), (Some(2), "column 3".into()));
    }

    #[test]
    fn unit_and_view_stand_in_the_table_too() {
        for (view, text) in [("2", "2"), ("\"Floor 1\"", "Floor 1"), ("[0, -1.5, 20, 10]", "0,-1.5,20,10")] {
            let p = Partial::from_toml("a", &format!("[reading]\nunit = \"mm\"\nview = {view}\n")).unwrap();
            assert_eq!((p.unit.as_deref(), p.view.as_deref()), (Some("mm"), Some(text)));
            assert!(p.reading.is_empty());
        }
    }

    #[test]
    fn nearer_sources_add_and_overrule() {
        let folder = Partial::from_toml(
            "enfilade.toml",
            "[reading]\nnot_wall = [\"layer:A-FURN\", \"block:SINK*\"]\nwall = [\"layer:A-WALL\"]\nas_drawn = true\n",
        )
        .unwrap();
        let drawing = Partial::from_toml(
            "plan.enfilade.toml",
            "[reading]\nwall = [\"layer:a-furn\", \"handle:2F\"]\ninside = [[1.0, 2.0]]\n",
        )
        .unwrap();
        let said = Partial {
            reading: ReadingTable { not_wall: selectors(&["layer:A-W*"]), ..ReadingTable::default() },
            ..Partial::default()
        };
        let all = Settings::new(said.over(drawing.over(folder))).unwrap().reading;
        assert_eq!(all.wall, selectors(&["layer:a-furn", "handle:2F"]));
        assert_eq!(all.not_wall, selectors(&["layer:A-W*", "block:SINK*"]));
        assert_eq!((all.inside.as_slice(), all.as_drawn), (&[[1.0, 2.0]][..], Some(true)));
        let carried = serde_json::to_string(&all).unwrap();
        assert_eq!(serde_json::from_str::<ReadingTable>(&carried).unwrap(), all);
    }

    #[test]
    fn a_folder_names_layers_and_blocks_alone() {
        let at = |text: &str| match for_folder("enfilade.toml", &format!("[reading]\n{text}\n")) {
            Err(Error::Usage(p)) => Some((p.code, p.place.line.unwrap(), p.place.entity)),
            _ => None,
        };
        let refused = |column: &str| Some(("reading-of-one-drawing", 2, format!("column {column}")));
        assert_eq!(at("wall = [\"layer:A*\", \"handle:2F\"]"), refused("21"));
        assert_eq!(at("inside = [[1, 2]]"), refused("10"));
        assert_eq!(at("view = 1"), refused("8"));
        assert_eq!(at("rooms = [\"3=bath\"]"), refused("9"));
        assert_eq!(at("unit = \"mm\"\nas_drawn = true\nnot_wall = [\"block:SINK\"]"), None);
    }
}
