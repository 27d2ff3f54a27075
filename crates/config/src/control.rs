//! What the architect decides beyond objectives: how a measure is taken together, hard limits, links,
//! modules. Each has one text form, the same on the command line, in TOML and in result.json.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{Allow, Budget, Measure, PairName, Penalty, bad, clauses};
use enfilade_report::Error;

/// How the values of the cells become one number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Aggregate {
    /// Their mean.
    #[default]
    Mean,
    /// The least.
    Min,
    /// The most.
    Max,
    /// The value that this many per cent of the cells do not exceed, 1 to 99.
    Percentile(u8),
}

/// A measure taken together over a region of query: `degree`, `degree-p10`, `depth-max@entrance`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Aim {
    /// What is measured in every cell.
    pub measure: Measure,
    /// How the cells become one number.
    pub aggregate: Aggregate,
    /// The named pair of regions it is measured over; `None`: the unnamed one.
    pub pair: Option<PairName>,
}

impl Aim {
    /// The mean of a measure over the unnamed pair.
    pub const fn mean(measure: Measure) -> Self {
        Self { measure, aggregate: Aggregate::Mean, pair: None }
    }

    /// Whether it is the mean of one of the paper's three measures, which every layout has.
    pub fn is_basic(self) -> bool {
        self.aggregate == Aggregate::Mean && Measure::MEAN.contains(&self.measure) && self.pair.is_none()
    }
}

impl fmt::Display for Aim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = self.measure.name();
        match self.aggregate {
            Aggregate::Mean => f.write_str(name),
            Aggregate::Min => write!(f, "{name}-min"),
            Aggregate::Max => write!(f, "{name}-max"),
            Aggregate::Percentile(p) => write!(f, "{name}-p{p}"),
        }?;
        self.pair.map_or(Ok(()), |pair| write!(f, "@{pair}"))
    }
}

impl FromStr for Aim {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (what, pair) = match text.split_once('@') {
            Some((what, name)) => (what, Some(name.parse::<PairName>()?)),
            None => (text, None),
        };
        let whole = || Measure::by_name(what).map(|measure| (measure, Aggregate::Mean));
        let parts = || {
            let (name, how) = what.rsplit_once('-')?;
            let measure = Measure::by_name(name).filter(|m| m.is_of_cells())?;
            let percent = || how.strip_prefix('p')?.parse::<u8>().ok().filter(|p| (1..=99).contains(p));
            let aggregate = match how {
                "mean" => Aggregate::Mean,
                "min" => Aggregate::Min,
                "max" => Aggregate::Max,
                _ => Aggregate::Percentile(percent()?),
            };
            Some((measure, aggregate))
        };
        let (measure, aggregate) = whole().or_else(parts).ok_or_else(|| format!("{text:?} is no measure"))?;
        if pair.is_some() && !measure.is_of_cells() {
            return Err(format!("{text:?}: {what} is of the whole layout, not of a pair of regions"));
        }
        Ok(Self { measure, aggregate, pair })
    }
}

/// What a hard limit holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// A measure, or `score`.
    Aim(Aim),
    /// A penalty: clr (m²), wall length (m), alignment (rad²), overlap (m), floor that rooms have lost (m²); for
    /// a passage its width (m).
    Penalty(Penalty),
}

/// Where a hard limit lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// At this value.
    At(f64),
    /// At this change against the present layout, as a share: −0.05 is 5 % less.
    Change(f64),
}

/// A hard limit: no option passes it. `wall-length -5%`, `clearance 3`, `passage@lobby 1.2 m`, `degree >= 40`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Limit {
    /// What is held.
    pub held: Held,
    /// Whether the bound is the least that is allowed, not the most.
    pub is_least: bool,
    /// The bound.
    pub bound: Bound,
    /// Of a passage: only those that reach into the regions of this name; `None`: everywhere.
    pub place: Option<PairName>,
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.held {
            Held::Aim(aim) => write!(f, "{aim}")?,
            Held::Penalty(p) => f.write_str(p.name())?,
        }
        if let Some(place) = self.place {
            write!(f, "@{place}")?;
        }
        match self.bound {
            Bound::Change(share) => {
                let way = match (self.is_least, share.is_sign_negative()) {
                    (true, false) => " >=",
                    (false, true) => " <=",
                    _ => "",
                };
                // Shortest digits of the per cent, not of the share.
                write!(f, "{way} {:+}%", (share * 1e8).round() / 1e6)
            }
            Bound::At(v) if self.held == Held::Penalty(Penalty::Passage) => {
                // Feet and inches as metres, without the last digits.
                write!(f, " {} m", (v * 1e6).round() / 1e6)
            }
            Bound::At(v) => write!(f, " {} {v}", if self.is_least { ">=" } else { "<=" }),
        }
    }
}

impl Limit {
    /// What a change in per cent allows, in words: `at most 20 % less than at present`.
    pub fn change_words(&self) -> Option<String> {
        let Bound::Change(share) = self.bound else { return None };
        let percent = (share.abs() * 1e8).round() / 1e6;
        Some(match (self.is_least, share) {
            (true, 0.0) => "no less than at present".into(),
            (false, 0.0) => "no more than at present".into(),
            (true, s) if s < 0.0 => format!("at most {percent} % less than at present"),
            (true, _) => format!("at least {percent} % more than at present"),
            (false, s) if s < 0.0 => format!("at least {percent} % less than at present"),
            (false, _) => format!("at most {percent} % more than at present"),
        })
    }

    /// Whether no value keeps both: at least more than at most.
    pub fn contradicts(&self, other: &Self) -> bool {
        let (least, most) = if self.is_least { (self, other) } else { (other, self) };
        let is_pair = self.is_least != other.is_least && self.held == other.held && self.place == other.place;
        let is_empty = match (least.bound, most.bound) {
            (Bound::At(least), Bound::At(most)) | (Bound::Change(least), Bound::Change(most)) => least > most,
            // How the present value stands to a fixed one is known by the drawing alone.
            _ => false,
        };
        is_pair && is_empty
    }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no limit");
        let (name, rest) = text.trim().split_once(char::is_whitespace).ok_or_else(wrong)?;
        let (what, place) = match name.split_once('@') {
            Some(("passage", place)) => ("passage", Some(place.parse::<PairName>()?)),
            _ => (name, None),
        };
        let penalty = Penalty::ALL.into_iter().find(|p| p.name() == what);
        let held = match penalty {
            Some(p) => Held::Penalty(p),
            None => Held::Aim(name.parse().map_err(|_| wrong())?),
        };
        let rest = rest.trim();
        let number = |t: &str| t.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        if held == Held::Penalty(Penalty::Passage) {
            let (width, unit) = quantity(rest).ok_or_else(wrong)?;
            let width_m = metres(unit).map(|m| width * m).filter(|w| *w > 0.0).ok_or_else(wrong)?;
            return Ok(Self { held, is_least: true, bound: Bound::At(width_m), place });
        }
        let (way, value) = match (rest.strip_prefix(">="), rest.strip_prefix("<=")) {
            (Some(v), _) => (Some(true), v),
            (_, Some(v)) => (Some(false), v),
            _ => (None, rest),
        };
        if let Some(percent) = value.strip_suffix('%') {
            // As written: no more than 5 % lost, no more than 5 % gained.
            let is_least = way.unwrap_or(percent.trim_start().starts_with('-'));
            let share = number(percent).ok_or_else(wrong)? / 100.0;
            return Ok(Self { held, is_least, bound: Bound::Change(share), place: None });
        }
        let (is_least, value) = match way {
            Some(is_least) => (is_least, value),
            // A bare number is the most of a penalty; of a measure nobody knows which way.
            _ if penalty.is_some() => (false, rest),
            _ => return Err(wrong()),
        };
        let value = number(value).ok_or_else(wrong)?;
        // A penalty is 0 or more: nothing could keep less.
        if penalty.is_some() && value < 0.0 {
            return Err(wrong());
        }
        Ok(Self { held, is_least, bound: Bound::At(value), place: None })
    }
}

/// How linked groups follow each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// The same shift and turn.
    Same,
    /// Mirrored left to right: shifts along x and turns are opposite.
    MirrorX,
    /// Mirrored top to bottom: shifts along y and turns are opposite.
    MirrorY,
    /// In a row: what lies between the first and the last keeps its share of the way between them.
    Equal,
}

/// Groups that move together: `same: door-1, door-2`, `mirror-x: left, right`, `equal: a, b, c`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Link {
    /// How.
    pub follow: Follow,
    /// Names of the groups, the first leads; at least two, for a row at least three.
    pub groups: Vec<String>,
}

impl fmt::Display for Link {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let follow = match self.follow {
            Follow::Same => "same",
            Follow::MirrorX => "mirror-x",
            Follow::MirrorY => "mirror-y",
            Follow::Equal => "equal",
        };
        write!(f, "{follow}: {}", self.groups.join(", "))
    }
}

impl FromStr for Link {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no link");
        let (how, names) = text.split_once(':').ok_or_else(wrong)?;
        let follow = match how.trim() {
            "same" => Follow::Same,
            "mirror-x" => Follow::MirrorX,
            "mirror-y" => Follow::MirrorY,
            "equal" => Follow::Equal,
            _ => return Err(wrong()),
        };
        let groups: Vec<String> = names.split(',').map(|n| n.trim().to_owned()).collect();
        let least = if follow == Follow::Equal { 3 } else { 2 };
        let is_twice = (0..groups.len()).any(|i| groups[..i].contains(&groups[i]));
        if groups.len() < least || is_twice || groups.iter().any(String::is_empty) {
            return Err(wrong());
        }
        Ok(Self { follow, groups })
    }
}

/// Modules that shifts and turns keep to, counted from the drawing as it is: `0.1 m, 5 deg`, `brick`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Snap {
    /// Of shifts, metres, > 0.
    pub length_m: Option<f64>,
    /// Of turns, degrees, > 0.
    pub angle_deg: Option<f64>,
    /// The length as it was stated, where that was not in metres: the number and its unit.
    stated: Option<(f64, &'static str)>,
}

impl PartialEq for Snap {
    fn eq(&self, other: &Self) -> bool {
        self.length_m == other.length_m && self.angle_deg == other.angle_deg
    }
}

impl Snap {
    /// The metres of a length that was stated in another unit, in brackets behind it: ` (0.6096 m)`; else empty.
    pub fn metres_words(&self) -> String {
        let other = self.length_m.filter(|_| self.stated.is_some());
        other.map_or_else(String::new, |m| format!(" ({} m)", (m * 1e6).round() / 1e6))
    }
}

impl fmt::Display for Snap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let in_metres = || self.length_m.map(|v| format!("{v} m"));
        let length = self.stated.map(|(v, unit)| format!("{v} {unit}")).or_else(in_metres);
        let angle = self.angle_deg.map(|v| format!("{v} deg"));
        f.write_str(&length.into_iter().chain(angle).collect::<Vec<_>>().join(", "))
    }
}

impl FromStr for Snap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("{text:?} is no module");
        let mut out = Self::default();
        for clause in text.split(',').map(str::trim).filter(|c| !c.is_empty()) {
            let clause =
                MODULES.into_iter().find(|m| m.0.eq_ignore_ascii_case(clause)).map_or(clause, |m| m.1);
            // A bare 5 may be millimetres, metres or degrees.
            let has_unit = clause.ends_with(|c: char| c.is_ascii_alphabetic());
            let (value, unit) = quantity(clause).filter(|q| has_unit && q.0 > 0.0).ok_or_else(wrong)?;
            let slot = if unit == "deg" { &mut out.angle_deg } else { &mut out.length_m };
            let size = if unit == "deg" { value } else { value * metres(unit).ok_or_else(wrong)? };
            if unit != "deg" {
                let known = UNITS.into_iter().find(|u| u.0 == unit && u.0 != "m");
                out.stated = known.map(|u| (value, u.0));
            }
            if slot.replace(size).is_some() {
                return Err(wrong());
            }
        }
        Ok(out)
    }
}

/// Modules by name: half a brick with its joint (DIN 4172), the basic module (ISO 2848).
const MODULES: [(&str, &str); 2] = [("brick", "0.125 m"), ("module", "0.1 m")];

/// A number and the unit behind it, `m` where there is none.
fn quantity(text: &str) -> Option<(f64, &str)> {
    let at = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let value = text[..at].trim().parse::<f64>().ok().filter(|v| v.is_finite())?;
    let unit = text[at..].trim();
    Some((value, if unit.is_empty() { "m" } else { unit }))
}

/// Units of length, metres each.
const UNITS: [(&str, f64); 5] = [("mm", 0.001), ("cm", 0.01), ("m", 1.0), ("in", 0.0254), ("ft", 0.3048)];

fn metres(unit: &str) -> Option<f64> {
    UNITS.into_iter().find(|u| u.0 == unit).map(|u| u.1)
}

macro_rules! text_form {
    ($($name:ident),+) => {$(
        impl From<$name> for String {
            fn from(v: $name) -> Self {
                v.to_string()
            }
        }
        impl TryFrom<String> for $name {
            type Error = String;
            fn try_from(text: String) -> Result<Self, String> {
                text.parse()
            }
        }
    )+};
}
text_form!(Aim, Limit, Link, Snap);

/// Hard limits of `--limit`.
pub(super) fn limits(text: &str) -> Result<Vec<Limit>, Error> {
    let expected = "`wall-length -5%`, `room-area -5%`, `clearance <= 3` (0 or more), `passage 0.9 m`, `degree-p10 >= 40` or `degree >= +10%`, separated by commas";
    // The minus that reports print.
    let text = text.replace('\u{2212}', "-");
    let parsed = clauses(&text).map(|c| c.parse().map_err(|_| bad("limit", &format!("{c:?}"), expected)));
    let out: Vec<Limit> = parsed.collect::<Result<_, _>>()?;
    let clash = |a: &Limit| out.iter().find(|b| a.contradicts(b)).map(|b| format!("{a} and {b}"));
    match out.iter().find_map(clash) {
        Some(both) => {
            Err(bad("limit", &format!("{both}, which no layout keeps"), "bounds that leave a range"))
        }
        None => Ok(out),
    }
}

/// Links of `--link`.
pub(super) fn links(texts: &[String]) -> Result<Vec<Link>, Error> {
    let expected = "`same: door-1, door-2`, `mirror-x: a, b`, `mirror-y: a, b` or `equal: a, b, c`, each group in one link";
    let out: Vec<Link> = texts
        .iter()
        .map(|t| t.parse().map_err(|_| bad("link", &format!("{t:?}"), expected)))
        .collect::<Result<_, _>>()?;
    let mut names: Vec<&String> = out.iter().flat_map(|l| &l.groups).collect();
    names.sort();
    match names.windows(2).find(|w| w[0] == w[1]) {
        Some(twice) => Err(bad("link", &format!("{:?} twice", twice[0]), expected)),
        None => Ok(out),
    }
}

/// The modules of `--snap`.
pub(super) fn snap(text: &str) -> Result<Snap, Error> {
    text.parse().map_err(|_| {
        bad(
            "snap",
            &format!("{text:?}"),
            "`0.1 m`, `brick` (0.125 m), `module` (0.1 m), `5 deg`, or a length and an angle, each above 0 with its unit",
        )
    })
}

/// Words of `--allow`.
pub(super) fn allow(text: &str) -> Result<Allow, Error> {
    let expected = "structure, open-joints, crossings, narrow-ways, things, any-step, or none";
    text.parse().map_err(|word: String| bad("allow", &format!("{word:?}"), expected))
}

/// Words of `--budget`.
pub(super) fn budget(text: &str) -> Result<Budget, Error> {
    let expected = "`2 works, 4 m`, either of them, or none";
    text.parse().map_err(|part: String| bad("budget", &format!("{part:?}"), expected))
}

/// Gains smaller than this nobody would rebuild a wall for.
pub(super) const LEAST_GAIN: f64 = 0.01;

pub(super) fn least_gain_default() -> f64 {
    LEAST_GAIN
}

/// `1%`, `1 %` or `0.01`.
pub(super) fn share(text: &str) -> Result<f64, Error> {
    let (number, unit) = text.trim().strip_suffix('%').map_or((text, 1.0), |n| (n, 0.01));
    let share = number.trim().parse::<f64>().ok().map(|v| v * unit);
    share
        .filter(|v| (0.0..1.0).contains(v))
        .ok_or_else(|| bad("least-gain", text, "a share such as 1% or 0.01"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_forms_read_back() {
        for text in [
            "degree",
            "degree-p10",
            "depth-max",
            "isovist-area-min",
            "mean-depth-p90",
            "isovist-max-radial",
            "integration-p-value-p5",
            "degree@entrance",
            "metric-distance-max@main-hall",
        ] {
            assert_eq!(text.parse::<Aim>().unwrap().to_string(), text);
        }
        for text in [
            "wall-length -5%",
            "wall-length +2.5%",
            "clearance <= 3",
            "passage 0.9 m",
            "passage@main-hall 1.2 m",
            "room-area -5%",
            "room-area <= 2",
            "degree-p10 >= 40",
            "degree@exit >= 40",
            "score >= 0",
            "depth +0%",
            "degree >= +20%",
            "depth <= -10%",
        ] {
            assert_eq!(text.parse::<Limit>().unwrap().to_string(), text);
        }
        for (text, words) in [
            ("depth -20%", Some("at most 20 % less than at present")),
            ("depth <= -20%", Some("at least 20 % less than at present")),
            ("depth +12.5%", Some("at most 12.5 % more than at present")),
            ("degree >= +10%", Some("at least 10 % more than at present")),
            ("depth +0%", Some("no more than at present")),
            ("degree >= 40", None),
        ] {
            assert_eq!(text.parse::<Limit>().unwrap().change_words().as_deref(), words, "{text}");
        }
        for text in ["same: door-1, door 2", "mirror-x: a, b", "mirror-y: a, b", "equal: a, b, c"] {
            assert_eq!(text.parse::<Link>().unwrap().to_string(), text);
        }
        assert_eq!("100mm, 5 deg".parse::<Snap>().unwrap().to_string(), "100 mm, 5 deg");
        let feet: Snap = "2 ft".parse().unwrap();
        assert_eq!((feet.to_string(), feet.metres_words()), ("2 ft".into(), " (0.6096 m)".into()));
        assert_eq!(feet.to_string().parse::<Snap>().unwrap().to_string(), "2 ft");
        assert_eq!("0.1 m".parse::<Snap>().unwrap().metres_words(), "");
        assert_eq!("Brick, 5 deg".parse::<Snap>().unwrap().to_string(), "0.125 m, 5 deg");
        assert_eq!("module".parse(), "100 mm".parse::<Snap>());
        assert!("brick, 0.1 m".parse::<Snap>().is_err());
        assert_eq!("passage 3 ft".parse::<Limit>().unwrap().to_string(), "passage 0.9144 m");
        assert_eq!(limits("degree \u{2212}5%").unwrap(), limits("degree -5%").unwrap());
        assert_eq!("passage 900mm".parse::<Limit>().unwrap().bound, Bound::At(0.9));
        assert_eq!("degree@Main".parse::<Aim>().unwrap().to_string(), "degree@main");
        assert_eq!("clearance 3".parse(), "clearance <= 3".parse::<Limit>());
    }

    #[test]
    fn limits_that_nothing_keeps_are_known() {
        for (a, b, want) in [
            ("degree >= 40", "degree <= 30", true),
            ("degree <= 30", "degree >= 40", true),
            ("degree >= +20%", "degree <= +10%", true),
            ("degree >= 30", "degree <= 30", false),
            ("degree >= 40", "depth <= 30", false),
            ("degree >= 40", "degree@exit <= 30", false),
            ("degree >= 40", "degree <= +10%", false),
            ("degree >= 40", "degree >= 30", false),
        ] {
            let [a, b] = [a, b].map(|t| t.parse::<Limit>().unwrap());
            assert_eq!(a.contradicts(&b), want, "{a}, {b}");
        }
    }

    #[test]
    fn what_says_nothing_is_refused() {
        for text in [
            "beauty",
            "degree-p0",
            "degree-p100",
            "score-min",
            "degree-",
            "-p10",
            "degree@",
            "degree@a,b",
            "score@exit",
            "@exit",
        ] {
            assert!(text.parse::<Aim>().is_err(), "{text}");
        }
        for text in [
            "degree 40",
            "passage",
            "passage -1",
            "passage@ 1 m",
            "overlap@hall <= 0",
            "clearance@hall 3",
            "passage 3 deg",
            "clearance",
            "depth >= x",
            "depth %",
            "clearance -1",
            "clearance <= -1",
            "overlap >= -0.5",
            "degree > +5%",
        ] {
            assert!(text.parse::<Limit>().is_err(), "{text}");
        }
        for text in ["same: a", "same: a, a", "equal: a, b", "other: a, b", "same a b", "same: a,,b"] {
            assert!(text.parse::<Link>().is_err(), "{text}");
        }
        for text in ["0 m", "-1", "5 deg, 3 deg", "1 yd"] {
            assert!(text.parse::<Snap>().is_err(), "{text}");
        }
    }
}
