//! Items as they are written.

use std::fmt;

use super::{Bound, Clause, Demand, DemandKind, DemandUnit, From, Over, Weight};

impl DemandUnit {
    /// Behind a number in an item.
    pub fn word(self) -> &'static str {
        match self {
            Self::M2 => " m2",
            Self::M => " m",
            Self::Deg => " deg",
            Self::Share => " %",
            Self::Ratio | Self::Count => "",
        }
    }

    /// A value in words, rounded to what is known: `8.2 m²`, `14.0°`, `5 %`.
    pub fn words(self, value: f64) -> String {
        match self {
            Self::M2 => format!("{value:.2} m²"),
            Self::M => format!("{value:.2} m"),
            Self::Deg => format!("{value:.1}°"),
            Self::Share => format!("{:.1} %", 100.0 * value),
            Self::Ratio => format!("{value:.2}"),
            Self::Count => format!("{value:.0}"),
        }
    }

    fn shown(self, value: f64) -> f64 {
        let by = if self == Self::Share { 100.0 } else { 1.0 };
        (value * by * 1e6).round() / 1e6
    }
}

impl Bound {
    /// `at least 8 m²`, `8 to 12 m²`; `None` where nothing is bounded.
    pub fn words(self, unit: DemandUnit) -> Option<String> {
        let value = |v: f64| {
            let number = format!("{}{}", unit.shown(v), unit.word());
            number.replace(" m2", " m²").replace(" deg", "°")
        };
        match (self.planned, self.least, self.most) {
            (Some(p), ..) => Some(format!("planned {}", value(p))),
            (_, Some(l), Some(m)) => Some(format!("{} to {}", value(l), value(m))),
            (_, Some(l), None) => Some(format!("at least {}", value(l))),
            (_, None, Some(m)) => Some(format!("at most {}", value(m))),
            _ => None,
        }
    }

    fn clause(self, unit: DemandUnit) -> String {
        let part = |word: &str, v: Option<f64>| {
            v.map(|v| format!(" {word} {}{}", unit.shown(v), unit.word())).unwrap_or_default()
        };
        match self.planned {
            Some(_) => part("planned", self.planned),
            None => part("min", self.least) + &part("max", self.most),
        }
    }
}

/// A name that several words make stands in quotation marks where a word of it could be read as something else.
fn quoted(name: &str) -> String {
    let is_plain = !name.contains(char::is_whitespace) || name.starts_with("doors of ");
    if is_plain { name.to_owned() } else { format!("\"{name}\"") }
}

impl fmt::Display for Demand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.weight != Weight::Limit {
            write!(f, "{}: ", self.weight.name())?;
        }
        let row = self.kind.entry();
        write!(f, "{} {}", quoted(&self.subject), row.word)?;
        match &self.other {
            Some(From::Rooms(name)) => write!(f, " {}", quoted(name))?,
            Some(From::Place { at, facing }) => {
                write!(f, " {},{}", at[0], at[1])?;
                if let Some([direction, field]) = facing {
                    write!(f, " facing {direction} field {field}")?;
                }
            }
            None => {}
        }
        if !self.through.is_empty() {
            write!(f, " through {}", self.through.join(", "))?;
        }
        if self.is_shut {
            f.write_str(" doors-shut")?;
        }
        if self.kind == DemandKind::SightOut && self.over != Over::default() {
            write!(f, " {}", self.over.name())?;
        }
        if let Some(people) = self.people {
            write!(f, " {people} people")?;
        }
        f.write_str(&self.bound.clause(row.unit))
    }
}

impl fmt::Display for Clause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Demand(demand) => demand.fmt(f),
            Self::Rule(name) => write!(f, "rule={name}"),
        }
    }
}
