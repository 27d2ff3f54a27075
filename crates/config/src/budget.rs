//! What the building works of an option may cost together: `2 works, 4 m`.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::NONE;

/// Sums of lengths that differ by less are one, metres.
const ROUNDING_M: f64 = 1e-9;

/// Units of a length, with their metres.
const UNITS: [(&str, f64); 5] = [("m", 1.0), ("metres", 1.0), ("cm", 0.01), ("mm", 0.001), ("ft", 0.3048)];

/// What the building works of one option may cost; `None` where nobody says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Budget {
    /// Works at most.
    pub works: Option<usize>,
    /// Wall that is demolished or built at most, metres.
    pub length_m: Option<f64>,
}

impl Budget {
    /// Whether so many works that demolish and build so much wall, metres, may be had for it.
    pub fn holds(self, works: usize, length_m: f64) -> bool {
        // Lengths are shown to the decimetre: the number shown is enough to have what it is shown with.
        let shown_m = (length_m * 10.0).round() / 10.0;
        self.works.is_none_or(|most| works <= most)
            && self.length_m.is_none_or(|most| length_m.min(shown_m) <= most + ROUNDING_M)
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let works = self.works.map(|n| if n == 1 { "1 work".to_owned() } else { format!("{n} works") });
        let said: Vec<String> = works.into_iter().chain(self.length_m.map(|m| format!("{m} m"))).collect();
        f.write_str(if said.is_empty() { NONE } else { "" })?;
        f.write_str(&said.join(", "))
    }
}

impl FromStr for Budget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut out = Self::default();
        let text = text.to_lowercase();
        for part in text.split(',').map(str::trim).filter(|p| !p.is_empty() && *p != NONE) {
            let unknown = || part.to_owned();
            let digits = part.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(unknown)?;
            let (number, unit) = (&part[..digits], part[digits..].trim());
            match unit {
                "work" | "works" if out.works.is_none() => {
                    out.works = Some(number.parse().ok().filter(|n| *n > 0).ok_or_else(unknown)?);
                }
                _ => {
                    let known = UNITS.iter().find(|u| u.0 == unit && out.length_m.is_none());
                    let metres = known.ok_or_else(unknown)?.1;
                    let length: f64 = number.parse().map_err(|_| unknown())?;
                    // To the micrometre, so that it is written as it was said.
                    let length_m = (length * metres * 1e6).round() / 1e6;
                    out.length_m = Some(length_m).filter(|m| *m > 0.0 && m.is_finite());
                    out.length_m.ok_or_else(unknown)?;
                }
            }
        }
        Ok(out)
    }
}

impl From<Budget> for String {
    fn from(budget: Budget) -> Self {
        budget.to_string()
    }
}

impl TryFrom<String> for Budget {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_read_as_it_is_written() {
        for text in ["2 works", "1 work", "4 m", "2 works, 4.5 m", "none"] {
            assert_eq!(text.parse::<Budget>().map(|b| b.to_string()), Ok(text.to_owned()));
        }
        let others =
            [("3works,0.9m", "3 works, 0.9 m"), ("2 WORKS, 400cm", "2 works, 4 m"), ("10 ft", "3.048 m")];
        for (text, read) in others {
            assert_eq!(text.parse::<Budget>().map(|b| b.to_string()), Ok(read.to_owned()));
        }
        for wrong in
            ["2", "works", "0 works", "-1 m", "0 m", "1.5 works", "2 works, 3 works", "4 yd", "1..2 m"]
        {
            assert!(wrong.parse::<Budget>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn both_limits_hold() {
        let budget: Budget = "2 works, 4 m".parse().unwrap_or_default();
        let cases = [(1, 4.0, true), (2, 4.049, true), (2, 4.06, false), (3, 1.0, false)];
        for (works, length_m, holds) in cases {
            assert_eq!(budget.holds(works, length_m), holds, "{works} {length_m}");
        }
        assert!(Budget::default().holds(99, 99.0));
    }
}
