//! Lengths, areas and volumes that a file states.

use std::ops::Range;

use super::building::Building;

/// A stated quantity that differs by a smaller share from that of the outline is the outline's.
const SAME_SHARE: f64 = 0.005;

/// A length, an area or a volume that the file states.
pub(super) struct Stated {
    /// Of the length: 1, 2 or 3.
    pub power: i32,
    /// In the file's units.
    pub value: f64,
    /// Where the value stands.
    pub slot: Range<usize>,
    /// What it is called.
    pub name: String,
}

impl Stated {
    /// What a quantity states, if it is one of these.
    pub fn of(b: &Building<'_, '_>, quantity: u64) -> Option<Self> {
        let power = match &*b.step.keyword(quantity) {
            "IFCQUANTITYLENGTH" => 1,
            "IFCQUANTITYAREA" => 2,
            "IFCQUANTITYVOLUME" => 3,
            _ => return None,
        };
        let args = b.step.args(quantity);
        let (value, slot) = args.get(3).and_then(|a| Some((a.number()?, a.span.clone())))?;
        let name = args.first().and_then(|a| b.step.text(a)).unwrap_or_default();
        Some(Self { power, value, slot, name })
    }
}

/// Whether a stated value is one of the outline's, in units of the file or in metres.
pub(super) fn is_same(stated: f64, own: f64, metres: f64) -> bool {
    [1.0, metres].iter().any(|unit| (stated - own * unit).abs() <= SAME_SHARE * own * unit)
}
