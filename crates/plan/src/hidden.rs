//! What a CAD program does not show.

use std::collections::BTreeSet;

use enfilade_cad::drawing::{Drawing, Entity, Layer};

/// Layers that are off or frozen.
pub struct Hidden<'a> {
    frozen: BTreeSet<&'a str>,
    off: BTreeSet<&'a str>,
}

impl<'a> Hidden<'a> {
    /// By the drawing's table.
    pub fn new(drawing: &'a Drawing) -> Self {
        let names = |pick: fn(&Layer) -> bool| {
            drawing.layers.iter().filter(|l| pick(l)).map(|l| l.name.as_str()).collect()
        };
        Self { frozen: names(|l| l.is_frozen), off: names(|l| l.is_off) }
    }

    /// Whether what lies on a layer is hidden.
    pub fn layer(&self, name: &str) -> bool {
        self.frozen.contains(name) || self.off.contains(name)
    }

    /// As a CAD program shows it: off hides the entity's own layer; a frozen layer hides what is on it
    /// and every block inserted on it.
    pub fn entity(&self, e: &Entity) -> bool {
        self.layer(&e.layer) || self.frozen.contains(e.source.layer.as_str())
    }
}
