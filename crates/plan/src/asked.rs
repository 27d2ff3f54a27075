//! What the user asks of rooms on layers of ours: exits, what is to be seen, what is not.

use std::collections::BTreeSet;

use super::curve;
use super::frame::Frame;
use enfilade_cad::drawing::Drawing;
use enfilade_cad::own_layers::{self, EXIT, HIDE, SEE, pair_of};
use enfilade_engine::geometry::PointUm;

/// What a mark asks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AskedKind {
    /// Here one leaves the building.
    Exit,
    /// The ground inside is seen from rooms of this name or kind.
    See(String),
    /// It is not seen from there.
    Hide(String),
}

/// A mark of the brief of rooms.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AskedMark {
    /// What it asks.
    pub kind: AskedKind,
    /// Corners, drawing frame, micrometres.
    pub points: Vec<PointUm>,
    /// Whether they close.
    pub is_closed: bool,
}

/// The marks of a drawing but those of some records, which belong to drawings that are not read.
pub(super) fn read(drawing: &Drawing, unused: &BTreeSet<usize>, frame: &Frame) -> Vec<AskedMark> {
    let used = drawing.entities.iter().filter(|e| !unused.contains(&e.source.record));
    let mark = |e: &enfilade_cad::drawing::Entity| {
        let kind = kind_of(own_layers::bare(&e.layer))?;
        let trace = curve::trace(&e.shape, frame);
        let is_ring =
            trace.is_closed || trace.points.len() > 3 && trace.points.first() == trace.points.last();
        let is_ground = kind == AskedKind::Exit || is_ring && trace.points.len() > 2;
        let is_drawn = trace.points.len() > 1 && is_ground;
        is_drawn.then_some(AskedMark { kind, points: trace.points, is_closed: is_ring })
    };
    used.filter_map(mark).collect()
}

fn kind_of(layer: &str) -> Option<AskedKind> {
    if layer.eq_ignore_ascii_case(EXIT) {
        return Some(AskedKind::Exit);
    }
    // Names of layers hold no blanks in some programs.
    let from = |kind: &str| pair_of(layer, kind).map(|name| name.replace(['-', '_'], " "));
    from(SEE).map(AskedKind::See).or_else(|| from(HIDE).map(AskedKind::Hide))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_say_what_is_asked() {
        let see = |of: &str| Some(AskedKind::See(of.into()));
        for (layer, kind) in [
            ("EF-EXIT", Some(AskedKind::Exit)),
            ("ef-see-Hall", see("hall")),
            ("EF-SEE-Living-Room", see("living room")),
            ("EF-HIDE:bath", Some(AskedKind::Hide("bath".into()))),
            ("EF-SEE", None),
            ("EF-KEEP", None),
        ] {
            assert_eq!(kind_of(layer), kind, "{layer}");
        }
    }
}
