//! Values of options, as people type them.

/// A number of things.
pub(super) fn whole<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("found {text:?}, expected a whole number from 0"))
}

/// A place.
pub(super) fn point(text: &str) -> Result<[f64; 2], String> {
    let number = |s: &str| s.trim().parse::<f64>().ok().filter(|v| v.is_finite());
    text.split_once(',')
        .and_then(|(x, y)| Some([number(x)?, number(y)?]))
        .ok_or_else(|| format!("found {text:?}, expected X,Y"))
}

/// How far something counts.
pub(super) fn radius(text: &str) -> Result<f64, String> {
    let found =
        text.trim().parse::<f64>().ok().filter(|v| v.is_finite() && *v >= 0.0 && *v <= f64::from(u32::MAX));
    found.ok_or_else(|| format!("found {text:?}, expected a number from 0"))
}

/// Where a graph goes: the ending says how it is written.
pub(super) fn graph_file(text: &str) -> Result<std::path::PathBuf, String> {
    let path = std::path::PathBuf::from(text);
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    let is_known = matches!(ending.as_str(), "graphml" | "json");
    if is_known {
        Ok(path)
    } else {
        Err(format!("found {text:?}, expected a name that ends in .graphml or .json"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_may_have_decimals() {
        assert_eq!(radius(" 2.5"), Ok(2.5));
        assert_eq!(radius("3"), Ok(3.0));
        for wrong in ["-1", "nan", "inf", "1e300", "far"] {
            assert!(radius(wrong).is_err_and(|why| why.contains("from 0")), "{wrong}");
        }
    }
}
