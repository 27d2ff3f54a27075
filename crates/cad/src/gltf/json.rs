//! JSON as values with their places in the text, so that one number can be changed and nothing else.

use std::ops::Range;

use super::limits::NESTING_MAX;

/// Letters of a text that a message shows.
const WORDS_MAX: usize = 40;

/// A value with its bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Json {
    /// Where it stands, white space excluded.
    pub span: Range<usize>,
    /// What it is.
    pub value: Value,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    Array(Vec<Json>),
    Object(Vec<(String, Json)>),
}

impl Json {
    /// Member of an object.
    pub fn get(&self, key: &str) -> Option<&Json> {
        match &self.value {
            Value::Object(members) => members.iter().find(|(k, _)| k == key).map(|(_, v)| v),
            _ => None,
        }
    }

    /// Items of an array member; none where it is missing.
    pub fn list(&self, key: &str) -> &[Json] {
        self.get(key).map_or(&[], Json::items)
    }

    /// Items of an array.
    pub fn items(&self) -> &[Json] {
        if let Value::Array(items) = &self.value { items } else { &[] }
    }

    /// A number.
    pub fn number(&self) -> Option<f64> {
        if let Value::Number(n) = self.value { Some(n) } else { None }
    }

    /// A number that is an index or a count.
    pub fn as_index(&self) -> Option<usize> {
        let n = self.number()?;
        (n >= 0.0 && n.fract() == 0.0 && n < 9e15).then_some(n as usize)
    }

    /// A member that is an index or a count.
    pub fn index(&self, key: &str) -> Option<usize> {
        self.get(key)?.as_index()
    }

    /// The value in a message: short, whatever it is.
    pub fn words(&self) -> String {
        match &self.value {
            Value::Null => "null".into(),
            Value::Bool(b) => b.to_string(),
            Value::Number(n) => format!("{n:?}").trim_end_matches(".0").to_string(),
            Value::Text(t) => format!("{:?}", t.chars().take(WORDS_MAX).collect::<String>()),
            Value::Array(items) if items.len() <= 4 && items.iter().all(|i| i.items().is_empty()) => {
                let items: Vec<String> = items.iter().map(Json::words).collect();
                format!("[{}]", items.join(", "))
            }
            Value::Array(items) => format!("a list of {}", items.len()),
            Value::Object(_) => "an object".into(),
        }
    }

    /// A text member.
    pub fn text(&self, key: &str) -> Option<&str> {
        if let Value::Text(t) = &self.get(key)?.value { Some(t) } else { None }
    }

    /// Numbers of an array member.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        self.get(key)?.items().iter().map(Json::number).collect()
    }
}

/// What is wrong, at a byte.
pub(super) type Fault = (usize, &'static str);

/// Parses a whole text.
pub(super) fn parse(text: &[u8]) -> Result<Json, Fault> {
    let mut at = if text.starts_with(b"\xEF\xBB\xBF") { 3 } else { 0 };
    let value = value(text, &mut at, 0)?;
    blank(text, &mut at);
    match text.get(at) {
        None | Some(0) => Ok(value),
        Some(_) => Err((at, "text after the end of the JSON")),
    }
}

fn blank(text: &[u8], at: &mut usize) {
    while text.get(*at).is_some_and(|b| b" \t\r\n".contains(b)) {
        *at += 1;
    }
}

fn value(text: &[u8], at: &mut usize, depth: usize) -> Result<Json, Fault> {
    if depth > NESTING_MAX {
        return Err((*at, "JSON nested deeper than any scene is"));
    }
    blank(text, at);
    let start = *at;
    let value = match text.get(start) {
        None => return Err((start, "the end of the file where a value must stand")),
        Some(b'{') => Value::Object(object(text, at, depth)?),
        Some(b'[') => Value::Array(array(text, at, depth)?),
        Some(b'"') => Value::Text(string(text, at)?),
        Some(_) => word(text, at)?,
    };
    Ok(Json { span: start..*at, value })
}

fn object(text: &[u8], at: &mut usize, depth: usize) -> Result<Vec<(String, Json)>, Fault> {
    let mut out = Vec::new();
    *at += 1;
    blank(text, at);
    if text.get(*at) == Some(&b'}') {
        *at += 1;
        return Ok(out);
    }
    loop {
        blank(text, at);
        let key = string(text, at)?;
        blank(text, at);
        if text.get(*at) != Some(&b':') {
            return Err((*at, "no `:` after the name of a member"));
        }
        *at += 1;
        out.push((key, value(text, at, depth + 1)?));
        if end_or_comma(text, at, b'}')? {
            return Ok(out);
        }
    }
}

fn array(text: &[u8], at: &mut usize, depth: usize) -> Result<Vec<Json>, Fault> {
    let mut out = Vec::new();
    *at += 1;
    blank(text, at);
    if text.get(*at) == Some(&b']') {
        *at += 1;
        return Ok(out);
    }
    loop {
        out.push(value(text, at, depth + 1)?);
        if end_or_comma(text, at, b']')? {
            return Ok(out);
        }
    }
}

fn end_or_comma(text: &[u8], at: &mut usize, end: u8) -> Result<bool, Fault> {
    blank(text, at);
    let found = text.get(*at).copied();
    *at += 1;
    match found {
        Some(b) if b == end => Ok(true),
        Some(b',') => Ok(false),
        _ => Err((*at - 1, "neither a comma nor the end of a list")),
    }
}

fn string(text: &[u8], at: &mut usize) -> Result<String, Fault> {
    let start = *at;
    if text.get(start) != Some(&b'"') {
        return Err((start, "no `\"` where a text must start"));
    }
    let mut end = start + 1;
    loop {
        match text.get(end) {
            None => return Err((start, "a text that does not end")),
            Some(b'"') => break,
            Some(b'\\') => end += 2,
            Some(_) => end += 1,
        }
    }
    *at = end + 1;
    serde_json::from_slice(text.get(start..=end).unwrap_or_default())
        .map_err(|_| (start, "a text with a wrong escape"))
}

fn word(text: &[u8], at: &mut usize) -> Result<Value, Fault> {
    let start = *at;
    while text.get(*at).is_some_and(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b)) {
        *at += 1;
    }
    match &text[start..*at] {
        b"null" => Ok(Value::Null),
        b"true" => Ok(Value::Bool(true)),
        b"false" => Ok(Value::Bool(false)),
        number => {
            let n = std::str::from_utf8(number).ok().and_then(|t| t.parse::<f64>().ok());
            let starts_well = number.first().is_some_and(|b| b.is_ascii_digit() || *b == b'-');
            n.filter(|n| n.is_finite() && starts_well)
                .map(Value::Number)
                .ok_or((start, "something that is no JSON value"))
        }
    }
}
