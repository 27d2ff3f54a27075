//! The sentences of what a person should decide, and the answers as corrections.

use serde_json::{Map, Value, json};

use crate::write::places::{Places, share};
use enfilade_cad::drawing::Unit;
use enfilade_overlay::reading::{AnswerEntry, QuestionEntry};
use enfilade_plan::Plan;
use enfilade_plan::reading::questions::{Correction, Doubt, Question, Witness};

/// A question as the page, the results and `check --json` show it.
pub(crate) fn entry(doubt: &Doubt, plan: &Plan) -> QuestionEntry {
    let at = Places::new(plan);
    let question = &doubt.question;
    let answers = question.corrections().into_iter().map(|c| {
        let (key, value, option) = correction(&c, &at);
        AnswerEntry {
            text: answer(question, &c, plan),
            correction: Map::from_iter([(key.to_owned(), value)]),
            option,
        }
    });
    let (about, text) = sentence(question, plan);
    QuestionEntry {
        about: about.into(),
        confidence: share(doubt.confidence),
        values: values(question, &at),
        text,
        answers: answers.collect(),
    }
}

fn values(question: &Question, at: &Places<'_>) -> Map<String, Value> {
    let values = match question {
        Question::Unit { witness, length, units } => json!({
            "witness": match witness { Witness::Door => "door", Witness::Wall => "wall", Witness::Plan => "plan" },
            "length": length,
            "lengths_m": units.iter().map(|u| crate::write::places::round_mm(length * u.metres)).collect::<Vec<_>>(),
        }),
        Question::View { views } => json!({ "views": views.iter().map(|v| &v.1).collect::<Vec<_>>() }),
        Question::Walls { layer, count } => json!({ "layer": layer, "count": count }),
        Question::Floor { at: p, area_m2 } => json!({ "at": at.file(*p), "area_m2": share(*area_m2) }),
        Question::Room { number, area_m2, kind } => {
            json!({ "room": number, "area_m2": share(*area_m2), "kind": kind.name() })
        }
    };
    values.as_object().cloned().unwrap_or_default()
}

/// Key and value of a correction, and the option of the command line that says the same.
fn correction(c: &Correction, at: &Places<'_>) -> (&'static str, Value, String) {
    let named = |key: &'static str, option: &str, value: String| {
        let said = format!("{option} {}", quoted(&value));
        (key, Value::from(value), said)
    };
    let point = |key: &'static str, p| {
        let [x, y] = at.file(p);
        (key, json!([[x, y]]), format!("--{key}={x},{y}"))
    };
    let listed = |key: &'static str, option: &str, value: &String| {
        (key, json!([value]), format!("{option} {}", quoted(value)))
    };
    match c {
        Correction::Unit(unit) => named("unit", "--unit", unit_text(*unit)),
        Correction::View(number) => ("view", Value::from(*number), format!("--view {number}")),
        Correction::Wall(selector) => listed("wall", "--wall", selector),
        Correction::NotWall(selector) => listed("not_wall", "--not-wall", selector),
        Correction::Inside(p) => point("inside", *p),
        Correction::Outside(p) => point("outside", *p),
        Correction::Room(number, kind) => {
            let value = format!("{number}={kind}");
            ("rooms", json!([value]), format!("--room {value}"))
        }
    }
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let is_plain = word.chars().all(|c| c.is_ascii_alphanumeric() || "-_:./".contains(c));
    if is_plain { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

/// A unit as `--unit` takes it.
fn unit_text(unit: Unit) -> String {
    if unit.name == "units" { format!("{}m", unit.metres) } else { unit.name.to_owned() }
}

fn sentence(question: &Question, plan: &Plan) -> (&'static str, String) {
    match question {
        Question::Unit { witness, length, units } => {
            let thing = match witness {
                Witness::Door => "this door",
                Witness::Wall => "this wall",
                Witness::Plan => "the plan",
            };
            let wide = match witness {
                Witness::Door => "wide",
                Witness::Wall => "thick",
                Witness::Plan => "long",
            };
            let [first, rest @ ..] = &units.iter().map(|u| metres(length * u.metres)).collect::<Vec<_>>()[..]
            else {
                return ("unit", String::new());
            };
            ("unit", format!("Is {thing} {first} {wide}, or {}?", rest.join(" or ")))
        }
        Question::View { views } => {
            let names: Vec<String> = views.iter().map(|(number, name)| view_text(*number, name)).collect();
            ("view", format!("Which drawing is the plan: {}?", names.join(" or ")))
        }
        Question::Walls { layer, count } => {
            ("walls", format!("Does layer {layer} show walls? {count} of its elements stop sight."))
        }
        Question::Room { number, area_m2, kind } => {
            ("room", format!("Is room {number} ({area_m2:.1} m²) {}?", kind.words()))
        }
        Question::Floor { at, area_m2 } => {
            let [x, y] = Places::new(plan).file(*at);
            (
                "floor",
                format!(
                    "Is the floor round {x}, {y} inside the building? It has {area_m2:.0} m² and is not measured."
                ),
            )
        }
    }
}

fn answer(question: &Question, c: &Correction, plan: &Plan) -> String {
    match (question, c) {
        (Question::Unit { length, .. }, Correction::Unit(unit)) => {
            format!("{}: the drawing is in {}", metres(length * unit.metres), unit_text(*unit))
        }
        (Question::View { views }, Correction::View(number)) => {
            let name = views.iter().find(|v| v.0 == *number).map_or("", |v| v.1.as_str());
            view_text(*number, name)
        }
        (_, Correction::Wall(_)) => "Yes, walls".into(),
        (_, Correction::NotWall(_)) => "No, no walls".into(),
        (_, Correction::Inside(_)) => "Inside: measure it".into(),
        (_, Correction::Outside(_)) => "Outside".into(),
        (Question::Room { kind, .. }, Correction::Room(_, said)) if kind == said => "Yes".into(),
        (_, Correction::Room(_, kind)) => format!("No, {}", kind.words()),
        (_, Correction::Unit(unit)) => unit_text(*unit),
        (_, Correction::View(number)) => {
            view_text(*number, plan.views.get(number - 1).map_or("", |v| &v.name))
        }
    }
}

fn view_text(number: usize, name: &str) -> String {
    let own = format!("drawing {number}");
    if name.is_empty() || name == own { own } else { format!("{number} ({name})") }
}

/// A length, rounded to three digits.
fn metres(length_m: f64) -> String {
    let digits = (2 - length_m.abs().max(1e-9).log10().floor() as i32).clamp(0, 4) as usize;
    let text = format!("{length_m:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} m")
}
