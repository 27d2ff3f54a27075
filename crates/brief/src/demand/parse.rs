//! Items in words: `goal: kitchen area min 8 m2; bath not-seen-from hall; rule=ways-out-35m`.

use std::str::FromStr;

use super::{Bound, Clause, DEMANDS, Demand, DemandEntry, DemandKind, DemandUnit, From, Over, Wants, Weight};

/// Units of values with what one of them is in the unit of a kind.
const UNITS: [(&str, DemandUnit, f64); 22] = [
    ("m2", DemandUnit::M2, 1.0),
    ("m²", DemandUnit::M2, 1.0),
    ("sqm", DemandUnit::M2, 1.0),
    ("ft2", DemandUnit::M2, 0.092_903_04),
    ("ft²", DemandUnit::M2, 0.092_903_04),
    ("sqft", DemandUnit::M2, 0.092_903_04),
    ("m", DemandUnit::M, 1.0),
    ("cm", DemandUnit::M, 0.01),
    ("mm", DemandUnit::M, 0.001),
    ("ft", DemandUnit::M, 0.3048),
    ("in", DemandUnit::M, 0.0254),
    ("deg", DemandUnit::Deg, 1.0),
    ("°", DemandUnit::Deg, 1.0),
    ("degrees", DemandUnit::Deg, 1.0),
    ("%", DemandUnit::Share, 0.01),
    ("", DemandUnit::M2, 1.0),
    ("", DemandUnit::M, 1.0),
    ("", DemandUnit::Deg, 1.0),
    ("", DemandUnit::Ratio, 1.0),
    ("", DemandUnit::Share, 1.0),
    ("", DemandUnit::Count, 1.0),
    ("people", DemandUnit::Count, 1.0),
];

/// What one looks at without turning the head, degrees: half a turn.
const FIELD_DEG: f64 = 180.0;

/// All items and rules of a brief. Clauses stand apart by `;` or on lines of their own.
///
/// # Errors
/// The clause that cannot be read, and what was expected.
pub fn demands(text: &str) -> Result<Vec<Clause>, String> {
    let clauses = text.split([';', '\n']).map(str::trim).filter(|c| !c.is_empty());
    clauses.map(clause).collect()
}

fn clause(text: &str) -> Result<Clause, String> {
    match text.split_once('=').filter(|(head, _)| head.trim().eq_ignore_ascii_case("rule")) {
        Some((_, name)) if !name.trim().is_empty() => Ok(Clause::Rule(name.trim().to_lowercase())),
        Some(_) => Err(format!("{text:?}: expected the name of a rule set behind `rule=`")),
        None => text.parse().map(Clause::Demand),
    }
}

/// Words of a clause; what stands in quotation marks is one.
fn words(text: &str) -> Result<Vec<Word>, String> {
    let mut out = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let (text, is_quoted, next) = match rest.strip_prefix('"') {
            Some(inner) => {
                let (word, next) = inner
                    .split_once('"')
                    .ok_or_else(|| format!("{text:?}: a quotation mark is not closed"))?;
                (word, true, next)
            }
            None => {
                let (word, next) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                (word, false, next)
            }
        };
        out.push(Word { text: text.to_owned(), is_quoted });
        rest = next.trim_start();
    }
    Ok(out)
}

#[derive(Clone, Debug)]
struct Word {
    text: String,
    is_quoted: bool,
}

impl Word {
    fn is(&self, word: &str) -> bool {
        !self.is_quoted && self.text.eq_ignore_ascii_case(word)
    }
}

fn joined(words: &[Word]) -> String {
    words.iter().map(|w| w.text.as_str()).collect::<Vec<_>>().join(" ")
}

impl FromStr for Demand {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (weight, rest) = weight_of(text);
        let words = words(rest)?;
        let found = words.iter().enumerate().skip(1).find_map(|(i, w)| {
            let row = DEMANDS.iter().find(|e| w.is(e.word))?;
            Some((i, row))
        });
        let Some((at, row)) = found else { return Err(no_word(text)) };
        let mut out = Self {
            weight,
            subject: joined(&words[..at]),
            kind: row.kind,
            bound: Bound::default(),
            other: None,
            through: Vec::new(),
            is_shut: false,
            over: Over::default(),
            people: None,
        };
        let rest = &words[at + 1..];
        match row.wants {
            Wants::Nothing if rest.is_empty() => {}
            Wants::Nothing => return Err(format!("{text:?}: expected nothing behind `{}`", row.word)),
            Wants::Bound => bounded(rest, row, &mut out).map_err(|why| format!("{text:?}: {why}"))?,
            Wants::Other => other(rest, row, &mut out).map_err(|why| format!("{text:?}: {why}"))?,
            Wants::People => {
                out.people =
                    Some(people(rest).ok_or_else(|| {
                        format!("{text:?}: expected a number of people: `wide-for 60 people`")
                    })?)
            }
        }
        Ok(out)
    }
}

fn weight_of(text: &str) -> (Weight, &str) {
    let split = text.split_once(':').and_then(|(head, rest)| {
        let weight = Weight::ALL.into_iter().find(|w| w.name().eq_ignore_ascii_case(head.trim()))?;
        Some((weight, rest.trim()))
    });
    split.unwrap_or((Weight::Limit, text.trim()))
}

fn no_word(text: &str) -> String {
    let words: Vec<&str> = DEMANDS.iter().map(|e| e.word).collect();
    format!("{text:?}: expected `ROOM WORD …` with one of {}, or `rule=NAME`", words.join(", "))
}

fn people(words: &[Word]) -> Option<u32> {
    let count = words.first()?.text.parse().ok().filter(|n| *n > 0)?;
    let is_done = words.len() == 1 || words.len() == 2 && words[1].is("people");
    is_done.then_some(count)
}

/// `min 8 m2 max 12 m2`, `planned 10 m2`, `least min 14 deg`.
fn bounded(words: &[Word], row: &DemandEntry, out: &mut Demand) -> Result<(), String> {
    let over = words.first().and_then(|w| Over::ALL.into_iter().find(|o| w.is(o.name())));
    let is_over = row.kind == DemandKind::SightOut && over.is_some();
    out.over = over.filter(|_| is_over).unwrap_or_default();
    let rest = &words[usize::from(is_over)..];
    out.bound = bound(rest, row.unit)?;
    match out.bound == Bound::default() {
        true => Err(format!("expected `{} min NUMBER UNIT`, `max` or `planned`", row.word)),
        false => Ok(()),
    }
}

fn bound(words: &[Word], unit: DemandUnit) -> Result<Bound, String> {
    let mut out = Bound::default();
    let mut at = 0;
    while at < words.len() {
        let sense = words[at].text.to_lowercase();
        let taken = value(&words[at + 1..], unit)
            .ok_or_else(|| format!("expected a number with a unit behind `{}`", words[at].text))?;
        match sense.as_str() {
            "min" => out.least = Some(taken.0),
            "max" => out.most = Some(taken.0),
            "planned" => out = Bound::planned(taken.0),
            _ => return Err(format!("found `{}`, expected `min`, `max` or `planned`", words[at].text)),
        }
        at += 1 + taken.1;
    }
    match (out.least, out.most) {
        (Some(l), Some(m)) if l > m => Err("the least is more than the most".into()),
        _ => Ok(out),
    }
}

/// A number with its unit, in one word or in two, and how many words they are.
fn value(words: &[Word], unit: DemandUnit) -> Option<(f64, usize)> {
    let first = words.first().filter(|w| !w.is_quoted)?.text.as_str();
    let digits = first.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(first.len());
    let (number, glued) = first.split_at(digits);
    let number: f64 = number.parse().ok().filter(|n: &f64| n.is_finite())?;
    let by = |name: &str| {
        let name = name.to_lowercase();
        UNITS.iter().find(|u| u.0 == name && u.1 == unit).map(|u| u.2)
    };
    // To a millionth, so that it is written as it was said.
    let of = |by: f64| (number * by * 1e6).round() / 1e6;
    if !glued.is_empty() {
        return Some((of(by(glued)?), 1));
    }
    match words.get(1).and_then(|w| by(&w.text)) {
        Some(factor) => Some((of(factor), 2)),
        None => Some((of(by("")?), 1)),
    }
}

/// `hall`, `hall through corridor, stair`, `3.2,4.1 facing 90 field 120`, with `doors-shut` and a bound behind.
fn other(words: &[Word], row: &DemandEntry, out: &mut Demand) -> Result<(), String> {
    let is_key =
        |w: &Word| ["through", "facing", "field", "doors-shut", "min", "max"].iter().any(|k| w.is(k));
    let end = words.iter().position(is_key).unwrap_or(words.len());
    if end == 0 {
        return Err(format!("expected a room or a place behind `{}`", row.word));
    }
    let name = joined(&words[..end]);
    let is_sight = matches!(row.kind, DemandKind::SeenFrom | DemandKind::NotSeenFrom);
    let place = if end == 1 && !words[0].is_quoted { place(&name) } else { None };
    let (mut facing, mut field, mut at) = (None, FIELD_DEG, end);
    while at < words.len() {
        let next = |k: usize| words.get(k).and_then(|w| w.text.parse::<f64>().ok()).filter(|v| v.is_finite());
        let word = &words[at];
        if word.is("through") && !is_sight {
            let until = words[at + 1..].iter().position(is_key).map_or(words.len(), |k| at + 1 + k);
            let all = joined(&words[at + 1..until]);
            out.through = all.split(',').map(|r| r.trim().to_owned()).filter(|r| !r.is_empty()).collect();
            at = until;
        } else if word.is("facing") && place.is_some() {
            facing = Some(next(at + 1).ok_or("expected degrees behind `facing`")?);
            at += 2;
        } else if word.is("field") && facing.is_some() {
            let wide = next(at + 1).filter(|v| *v > 0.0 && *v <= 360.0);
            field = wide.ok_or("expected degrees from 1 to 360 behind `field`")?;
            at += 2;
        } else if word.is("doors-shut") && is_sight {
            out.is_shut = true;
            at += 1;
        } else if (word.is("min") || word.is("max")) && row.unit != DemandUnit::Count {
            out.bound = bound(&words[at..], row.unit)?;
            at = words.len();
        } else {
            return Err(format!("`{}` does not go with `{}`", word.text, row.word));
        }
    }
    if place.is_some() && !is_sight {
        return Err(format!("expected a room behind `{}`", row.word));
    }
    out.other = Some(match place {
        Some(at) => From::Place { at, facing: facing.map(|f| [f, field]) },
        None => From::Rooms(name),
    });
    Ok(())
}

fn place(text: &str) -> Option<[f64; 2]> {
    let (x, y) = text.split_once(',')?;
    let finite = |v: &str| v.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    Some([finite(x)?, finite(y)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_are_read_as_they_are_written() {
        for text in [
            "kitchen area min 8 m2",
            "goal: kitchen area min 8 m2 max 12 m2",
            "\"Living room\" area planned 24 m2",
            "bedroom width min 2.5 m",
            "note: rooms proportion max 2",
            "bath has-door",
            "kitchen next-to dining",
            "bedroom not-next-to kitchen",
            "bath reached-from hall through corridor, stair",
            "bath not-seen-from hall doors-shut",
            "ward seen-from 3.2,4.1 facing 90 field 180 min 50 %",
            "living sight-out least min 14 deg",
            "rooms way-out max 52.5 m",
            "doors clear-width min 0.9 m",
            "rooms wide-for 60 people",
        ] {
            let read: Demand = text.parse().unwrap();
            assert_eq!(read.to_string(), text);
            assert_eq!(read.to_string().parse(), Ok(read));
        }
    }

    #[test]
    fn units_are_turned_into_metres_and_shares() {
        let bound = |text: &str| text.parse::<Demand>().map(|d| (d.bound.least, d.bound.most));
        assert_eq!(bound("rooms way-out max 200 ft"), Ok((None, Some(60.96))));
        assert_eq!(bound("bedroom area min 70sqft"), Ok((Some(6.503_213), None)));
        assert_eq!(bound("bath not-seen-from hall max 5%"), Ok((None, Some(0.05))));
        assert_eq!(bound("doors clear-width min 900mm"), Ok((Some(0.9), None)));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for text in [
            "kitchen",
            "kitchen area",
            "area min 8 m2",
            "kitchen area min 8 deg",
            "kitchen area min x",
            "kitchen area min 8 m2 max 4 m2",
            "bath has-door twice",
            "bath seen-from",
            "bath next-to 1,2",
            "bath reached-from hall facing 90",
            "\"bath area min 8 m2",
            "rooms wide-for 0",
            "bath not-seen-from hall field 90",
        ] {
            assert!(text.parse::<Demand>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_brief_holds_items_and_rules() {
        let read = demands("kitchen area min 8 m2; rule=ways-out-35m;\nbath has-door").unwrap();
        assert_eq!(read.len(), 3);
        assert_eq!(read[1], Clause::Rule("ways-out-35m".into()));
        assert!(demands("rule=").is_err());
    }
}
