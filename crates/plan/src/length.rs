//! Numbers and lengths as people write them into marks.

use enfilade_cad::drawing::Unit;
use enfilade_cad::units::unit_by_name;

/// A number as people write one, with a point or a comma.
pub(super) fn number(s: &str) -> Result<f64, String> {
    // A decimal comma.
    let plain =
        if s.matches(',').count() == 1 && !s.contains('.') { s.replace(',', ".") } else { s.to_owned() };
    plain
        .parse::<f64>()
        .ok()
        .filter(|v| v.is_finite())
        .ok_or_else(|| format!("found {s:?}, expected a number"))
}

/// A length as people write one: `0.5`, `-0,5m`, `18in`, `2'`, `18"`, `-2'-6"`.
pub(super) fn length(s: &str) -> Result<(f64, Option<Unit>), String> {
    let plain = s.replace(['′', '’'], "'").replace(['″', '”'], "\"").replace("''", "\"");
    if plain.contains(['\'', '"']) {
        return feet_and_inches(&plain).ok_or_else(|| {
            format!("found {s:?}, expected feet and inches such as 2', 18\", -2'-6\" or 2.5ft")
        });
    }
    let split = plain.find(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E').unwrap_or(plain.len());
    let (digits, suffix) = plain.split_at(split);
    let value = number(digits).map_err(|_| {
        format!("found {s:?}, expected a length such as 0.5, 50cm, 1.5m, 18in, 2ft or 2'-6\"")
    })?;
    if suffix.is_empty() {
        return Ok((value, None));
    }
    let unit = unit_by_name(&suffix.to_lowercase());
    unit.map(|u| (value, Some(u)))
        .ok_or_else(|| format!("found the unit {suffix:?}, expected mm, cm, m, in or ft"))
}

/// `2'`, `18"`, `2'-6"`, `2'6"`, with a sign before all of it.
fn feet_and_inches(text: &str) -> Option<(f64, Option<Unit>)> {
    let (sign, size) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let size = size.trim_start_matches('+');
    let value = |s: &str| s.parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0);
    let Some((feet, rest)) = size.split_once('\'') else {
        return Some((sign * value(size.strip_suffix('"')?)?, unit_by_name("in")));
    };
    let rest = rest.trim_start_matches('-').trim_end_matches('"');
    let inches = if rest.is_empty() { 0.0 } else { value(rest)? };
    Some((sign * (value(feet)? + inches / 12.0), unit_by_name("ft")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_as_people_write_them() {
        for (text, expected) in [
            ("0.5", Some((0.5, None))),
            ("-0,5m", Some((-0.5, Some("m")))),
            ("18in", Some((18.0, Some("in")))),
            ("2'", Some((2.0, Some("ft")))),
            ("-2'-6\"", Some((-2.5, Some("ft")))),
            ("2'6", Some((2.5, Some("ft")))),
            ("+3′", Some((3.0, Some("ft")))),
            ("-18”", Some((-18.0, Some("in")))),
            ("6''", Some((6.0, Some("in")))),
            ("1,000.5", None),
            ("'", None),
            ("2'-x\"", None),
            ("--2'", None),
            ("1e999", None),
        ] {
            let found = length(text).ok().map(|(v, u)| (v, u.map(|u| u.name)));
            assert_eq!(found, expected, "{text}");
        }
        assert_eq!((number("-15,5"), number("2.5")), (Ok(-15.5), Ok(2.5)));
        assert!(number("1,5.0").is_err() && number("1,5,0").is_err());
        assert!(length("2'x").unwrap_err().contains("such as 2', 18\""));
        assert!(length("wide").unwrap_err().contains("2ft or 2'-6\""));
    }
}
