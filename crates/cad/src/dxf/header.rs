//! The HEADER section: version, units, code page.

use glam::DVec2;

use super::text::CodePage;
use super::tokens::{Pair, Tokens};
use crate::drawing::Unit;

/// The code of a unit in `$INSUNITS`; 0 where it has none.
pub(super) fn code_of(unit: Unit) -> usize {
    UNITS.iter().position(|u| *u == Some(unit)).unwrap_or(0)
}

/// Units of `$INSUNITS`, index = code (DXF reference, header variables); 0 is "unitless".
const UNITS: [Option<Unit>; 25] = {
    const fn unit(name: &'static str, metres: f64) -> Option<Unit> {
        Some(Unit { name, metres })
    }
    [
        None,
        unit("in", 0.0254),
        unit("ft", 0.3048),
        unit("mi", 1609.344),
        unit("mm", 0.001),
        unit("cm", 0.01),
        unit("m", 1.0),
        unit("km", 1000.0),
        unit("microinch", 2.54e-8),
        unit("mil", 2.54e-5),
        unit("yd", 0.9144),
        unit("angstrom", 1e-10),
        unit("nm", 1e-9),
        unit("micron", 1e-6),
        unit("dm", 0.1),
        unit("dam", 10.0),
        unit("hm", 100.0),
        unit("Gm", 1e9),
        unit("au", 149_597_870_700.0),
        unit("ly", 9_460_730_472_580_800.0),
        unit("pc", 30_856_775_814_913_673.0),
        unit("US survey ft", 1200.0 / 3937.0),
        unit("US survey in", 100.0 / 3937.0),
        unit("US survey yd", 3600.0 / 3937.0),
        unit("US survey mi", 6_336_000.0 / 3937.0),
    ]
};

/// What the reader and the patcher need of the header.
pub(super) struct Header {
    /// `$ACADVER`, `AC1009` where it is missing.
    pub version: String,
    /// Whether `$ACADVER` is there.
    pub has_version: bool,
    /// `$DWGCODEPAGE`.
    pub code_page: Option<String>,
    /// `$INSUNITS`.
    pub insunits: Option<i64>,
    /// `$MEASUREMENT`: 0 imperial, 1 metric.
    pub measurement: Option<i64>,
    /// `$HANDSEED`: index of its value pair.
    pub handseed: Option<usize>,
    /// Whether `$HANDLING` is 1 (R12 and older).
    pub has_handling: bool,
}

impl Header {
    /// Reads the header variables; a file without a HEADER section has none.
    pub fn read(tokens: &Tokens<'_>) -> Self {
        let mut header = Self {
            version: "AC1009".into(),
            has_version: false,
            code_page: None,
            insunits: None,
            measurement: None,
            handseed: None,
            has_handling: false,
        };
        let section = (0..tokens.records.len()).find(|&r| tokens.is_section(r, b"HEADER"));
        let Some(span) = section.map(|record| tokens.span(record)) else { return header };
        for i in span.clone() {
            let (name, next) = (&tokens.pairs[i], i + 1);
            if name.code == 9 && span.contains(&next) {
                header.take(tokens, tokens.value(name), next, &tokens.pairs[next]);
            }
        }
        header
    }

    fn take(&mut self, tokens: &Tokens<'_>, name: &[u8], index: usize, value: &Pair) {
        let text = || String::from_utf8_lossy(tokens.value(value)).into_owned();
        match name {
            b"$ACADVER" => (self.version, self.has_version) = (text().to_ascii_uppercase(), true),
            b"$DWGCODEPAGE" => self.code_page = Some(text()),
            b"$INSUNITS" => self.insunits = tokens.integer(value),
            b"$MEASUREMENT" => self.measurement = tokens.integer(value),
            b"$HANDSEED" if value.code == 5 => self.handseed = Some(index),
            b"$HANDLING" => self.has_handling = tokens.integer(value) == Some(1),
            _ => {}
        }
    }

    /// `AC1009 (R12)`.
    pub fn version_words(&self) -> String {
        if !self.has_version {
            return "no $ACADVER (read as R12)".into();
        }
        let is_older = self.version.as_str() < "AC1009";
        let name = release_of(&self.version).unwrap_or(if is_older { "before R12" } else { "unknown" });
        format!("{} ({name})", self.version)
    }

    /// The declared unit.
    pub fn unit(&self) -> Option<Unit> {
        *UNITS.get(usize::try_from(self.insunits?).ok()?)?
    }

    /// `$INSUNITS 4, $MEASUREMENT 1`.
    pub fn unit_words(&self) -> String {
        let words = |name: &str, value: Option<i64>| match value {
            Some(value) => format!("{name} {value}"),
            None => format!("no {name}"),
        };
        format!("{}, {}", words("$INSUNITS", self.insunits), words("$MEASUREMENT", self.measurement))
    }

    /// Largest coordinate in drawing units that is no mistake: `max_m` in the declared unit, never
    /// stricter than in metres nor wider than in millimetres.
    pub fn max_coordinate(&self, unit: Option<Unit>, max_m: f64) -> f64 {
        let metres = unit.or(self.unit()).map_or(1.0, |unit| unit.metres);
        max_m / metres.clamp(0.001, 1.0)
    }

    /// Code page of the file's strings.
    pub fn page(&self, tokens: &Tokens<'_>) -> CodePage {
        let is_text = |p: &&Pair| matches!(p.code, 1..=3 | 6..=8);
        let samples = tokens.pairs.iter().filter(is_text).map(|p| tokens.value(p)).filter(|v| !v.is_ascii());
        super::text::code_page(&self.version, self.code_page.as_deref(), samples)
    }
}

/// Whether both coordinates are finite and within the limit.
pub(super) fn is_sane(p: DVec2, max_coordinate: f64) -> bool {
    p.is_finite() && p.abs().max_element() <= max_coordinate
}

/// The release that a version number of DXF or DWG stands for: `AC1009` is R12.
pub(crate) fn release_of(version: &str) -> Option<&'static str> {
    Some(match version {
        "AC1006" => "R10",
        "AC1009" => "R12",
        "AC1012" => "R13",
        "AC1014" => "R14",
        "AC1015" => "R2000",
        "AC1018" => "R2004",
        "AC1021" => "R2007",
        "AC1024" => "R2010",
        "AC1027" => "R2013",
        "AC1032" => "R2018",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_their_lengths() {
        for (code, metres) in [(1, 0.0254), (2, 0.3048), (4, 0.001), (5, 0.01), (6, 1.0)] {
            assert_eq!(UNITS[code].map(|u| u.metres), Some(metres));
        }
        assert_eq!(UNITS[21].map(|u| u.metres), Some(1200.0 / 3937.0));
        assert_eq!(UNITS[24].map(|u| (u.metres * 1e6).round() / 1e6), Some(1609.347219));
    }
}
