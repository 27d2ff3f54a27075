//! Numbers as STEP writes them.

/// A number as STEP writes it: always with a point, shortest text that reads back the same.
pub(super) fn real(v: f64) -> String {
    if v == 0.0 {
        return "0.".into();
    }
    let text = format!("{v:?}");
    let (mantissa, exponent) = text.split_once('e').map_or((text.as_str(), None), |(m, e)| (m, Some(e)));
    let mantissa = match mantissa.strip_suffix(".0") {
        Some(whole) => format!("{whole}."),
        None if mantissa.contains('.') => mantissa.to_string(),
        None => format!("{mantissa}."),
    };
    exponent.map_or(mantissa.clone(), |e| format!("{mantissa}E{e}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_point_and_read_back() {
        for v in [0.0, 1.0, -2.5, 1e-7, 1e22, 0.1 + 0.2, 5774347.227, -1e-300] {
            let text = real(v);
            assert!(text.contains('.'), "{text}");
            assert_eq!(text.parse::<f64>().unwrap(), v);
        }
        assert_eq!((real(1.0), real(1e-7)), ("1.".to_string(), "1.E-7".to_string()));
    }
}
