//! Settings by name and value, as another program hands them over: the names of the command line, as words.

use serde_json::{Map, Value};

use super::{Partial, wording};
use enfilade_report::{Error, Place};

/// What a settings file alone may say: the command line has other words for it, or none.
const OF_FILES: [&str; 11] = [
    "ignore-move-markers",
    "pin",
    "like",
    "warm",
    "lineage",
    "pin-option",
    "pin-move",
    "warm-move",
    "reading",
    "watch",
    "host",
];

/// Corrections of how a drawing is read, which stand among the others on the command line.
const OF_READING: [&str; 8] = ["wall", "not-wall", "door", "window", "inside", "outside", "room", "as-drawn"];

/// Options that the command line takes several times: of these one value is a list of one.
const REPEATABLE: [&str; 10] =
    ["wall-layer", "seed-point", "link", "wall", "not-wall", "door", "window", "inside", "outside", "room"];

impl Partial {
    /// Reads settings of these names and values. The names are those of the command line's options, words joined by
    /// `_` or `-`; a value of an option that may be repeated may stand alone. `null` says nothing.
    ///
    /// # Errors
    /// [`Error::Usage`], `settings`, with the nearest name that is known, or with what a value should be.
    pub fn from_named(named: &Map<String, Value>) -> Result<Self, Error> {
        let known = known();
        let mut all = Map::new();
        let mut reading = Map::new();
        for (given, value) in named.iter().filter(|(_, v)| !v.is_null()) {
            let name = given.replace('_', "-");
            let name = known.iter().find(|k| **k == name).ok_or_else(|| refused(&unknown(given, &known)))?;
            let value = as_list(name, value);
            let target =
                if OF_READING.contains(&name.as_str()) || name == "view" { &mut reading } else { &mut all };
            // Alone, so that what is wrong can be said with its name.
            read(name, &value)?;
            target.insert(key_of(name), value);
        }
        all.insert("reading".into(), Value::Object(reading));
        let mut out: Self =
            serde_json::from_value(Value::Object(all)).map_err(|e| refused(&e.to_string()))?;
        out.view = out.reading.view.take().map(|v| v.to_string());
        Ok(out)
    }
}

/// Names of all settings that may be given, in the order in which they are declared.
fn known() -> Vec<String> {
    let Ok(Value::Object(all)) = serde_json::to_value(Partial::default()) else { return Vec::new() };
    let own = all.into_iter().map(|(key, _)| key).filter(|key| !OF_FILES.contains(&key.as_str()));
    own.chain(OF_READING.map(String::from)).collect()
}

fn unknown(given: &str, known: &[String]) -> String {
    let known: Vec<String> = known.iter().map(|k| k.replace('-', "_")).collect();
    wording::unknown_key(&given.replace('-', "_"), &known.iter().map(String::as_str).collect::<Vec<_>>())
}

/// As the table of corrections spells it.
fn key_of(name: &str) -> String {
    if OF_READING.contains(&name) { name.replace('-', "_") } else { name.to_owned() }
}

fn as_list(name: &str, value: &Value) -> Value {
    let is_one = match value {
        Value::Array(items) => items.first().is_some_and(Value::is_number),
        _ => true,
    };
    if is_one && REPEATABLE.contains(&name) { Value::Array(vec![value.clone()]) } else { value.clone() }
}

/// Whether a value fits its name.
fn read(name: &str, value: &Value) -> Result<(), Error> {
    let alone = || Map::from_iter([(key_of(name), value.clone())]);
    let whole = if OF_READING.contains(&name) || name == "view" {
        Map::from_iter([("reading".to_owned(), Value::Object(alone()))])
    } else {
        alone()
    };
    let fail = |e: serde_json::Error| {
        refused(&format!("{}: {}", name.replace('-', "_"), wording::plain(&e.to_string())))
    };
    serde_json::from_value::<Partial>(Value::Object(whole)).map(drop).map_err(fail)
}

fn refused(text: &str) -> Error {
    Error::usage("settings", Place::default(), format!("{text}; nothing was done"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn named(value: Value) -> Result<Partial, String> {
        let Value::Object(map) = value else { panic!("{value}") };
        Partial::from_named(&map).map_err(|e| e.to_string())
    }

    #[test]
    fn the_command_lines_names_are_taken() {
        let said = json!({
            "unit": "m", "spacing": 1, "wall_layer": "A-WALL", "not-wall": ["layer:A-FURN"], "inside": [1, 2.5],
            "seed_point": [[1, 2], [3, 4]], "view": 2, "as_drawn": true, "threads": null, "unsure": "optimise",
        });
        let p = named(said).unwrap();
        assert_eq!((p.unit.as_deref(), p.spacing, p.view.as_deref()), (Some("m"), Some(1.0), Some("2")));
        assert_eq!(p.wall_layer, Some(vec!["A-WALL".to_owned()]));
        assert_eq!(p.seed_point, Some(vec![[1.0, 2.0], [3.0, 4.0]]));
        assert_eq!((p.reading.inside, p.reading.as_drawn, p.threads), (vec![[1.0, 2.5]], Some(true), None));
        assert_eq!(p.reading.not_wall[0].as_str(), "layer:A-FURN");
    }

    #[test]
    fn a_wrong_name_gets_the_nearest() {
        for (wrong, right) in
            [("spacin", "`spacing`"), ("wal_layer", "`wall_layer`"), ("not-wal", "`not_wall`")]
        {
            let said = named(json!({ wrong: 1 })).unwrap_err();
            assert!(said.contains(&format!("did you mean {right}?")), "{said}");
        }
        for of_files in OF_FILES {
            assert!(named(json!({ of_files: [] })).is_err(), "{of_files}");
        }
    }

    #[test]
    fn a_wrong_value_is_told_with_its_name() {
        let said = [
            (json!({"spacing": "wide"}), "spacing: found string"),
            (json!({"seed": -1}), "seed: found"),
            (json!({"level": "hip"}), "level: unknown variant"),
            (json!({"wall": "A-WALL"}), "wall: found"),
            (json!({"inside": [1]}), "inside: "),
        ];
        for (value, begins) in said {
            let found = named(value).unwrap_err();
            assert!(found.starts_with(begins) && found.ends_with("nothing was done"), "{found}");
        }
    }
}
