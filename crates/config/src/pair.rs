//! Names of pairs of regions: `entrance` in `EF-QUERY-entrance` and `degree@entrance`.

use std::fmt;
use std::str::FromStr;

/// Longest name of a pair, bytes of UTF-8.
pub const PAIR_NAME_BYTES: usize = 40;

/// Name of a pair: lower case, a plain value like the measures it goes with.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PairName {
    bytes: [u8; PAIR_NAME_BYTES],
    len: usize,
}

impl PairName {
    /// The name.
    pub fn as_str(&self) -> &str {
        str::from_utf8(&self.bytes[..self.len]).unwrap_or_default()
    }
}

impl FromStr for PairName {
    type Err = String;

    /// Case does not count, spaces are written as `-`.
    fn from_str(text: &str) -> Result<Self, String> {
        let name = text.trim().to_lowercase().replace(char::is_whitespace, "-");
        let is_plain = |c: char| c.is_alphanumeric() || "-_.".contains(c);
        if name.is_empty() || name.len() > PAIR_NAME_BYTES || !name.chars().all(is_plain) {
            return Err(format!(
                "{text:?} is no name of a pair: letters, digits, - _ and ., at most {PAIR_NAME_BYTES} bytes"
            ));
        }
        let mut bytes = [0; PAIR_NAME_BYTES];
        bytes[..name.len()].copy_from_slice(name.as_bytes());
        Ok(Self { bytes, len: name.len() })
    }
}

impl fmt::Display for PairName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for PairName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_folded_and_bounded() {
        let name = |text: &str| text.parse::<PairName>().map(|n| n.to_string());
        assert_eq!(name("Main Entrance").as_deref(), Ok("main-entrance"));
        assert_eq!(name(" Süd_2 ").as_deref(), Ok("süd_2"));
        assert!(name(&"x".repeat(PAIR_NAME_BYTES)).is_ok());
        for wrong in ["", "  ", "a,b", "a@b", &"x".repeat(PAIR_NAME_BYTES + 1)] {
            assert!(name(wrong).is_err(), "{wrong:?}");
        }
    }
}
