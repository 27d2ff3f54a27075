//! How the users of each format say what moves and what stays, in the words of their own program.

use crate::drawing::Format;
use crate::own_layers::{KEEP, MOVE};

/// The words for marks of one format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Marking {
    /// Where moves are stated: `EF-MOVE`.
    pub moves: &'static str,
    /// What says of something that it stays.
    pub keeps: &'static str,
    /// The region in which everything stays.
    pub kept_region: &'static str,
    /// What to do so that something moves, as an order.
    pub order: &'static str,
    /// What makes more walls move.
    pub more: &'static str,
}

const DXF: Marking = Marking {
    moves: MOVE,
    keeps: KEEP,
    kept_region: KEEP,
    order: "draw a closed polyline on layer EF-MOVE round the wall ends that may move, with a text inside it such as \
            `x -1m 1m; y -1m 1m`",
    more: "EF-MOVE boxes round more walls",
};

const IFC: Marking = Marking {
    moves: "Pset_Enfilade",
    keeps: "Keep in Pset_Enfilade",
    kept_region: "a space with Keep in Pset_Enfilade",
    order: "give the walls that may move a property set Pset_Enfilade, with a text such as `x -1m 1m; y -1m 1m` as its \
            property Move",
    more: "a Move in Pset_Enfilade on more walls",
};

const GLTF: Marking = Marking {
    moves: "extras.enfilade",
    keeps: "keep in extras.enfilade",
    kept_region: "a space with keep in extras.enfilade",
    order: "give the nodes that may move `\"extras\": {\"enfilade\": {\"move\": \"x -1m 1m; y -1m 1m\"}}`",
    more: "a move in extras.enfilade of more nodes",
};

impl Format {
    /// How its users say what moves and what stays.
    pub fn marking(self) -> &'static Marking {
        match self {
            Self::Dxf => &DXF,
            Self::Ifc => &IFC,
            Self::Gltf | Self::Glb => &GLTF,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_words_of_its_own() {
        for format in [Format::Dxf, Format::Ifc, Format::Gltf, Format::Glb] {
            let words = format.marking();
            assert_eq!(Format::named(format.name()), Some(format));
            let all = [words.moves, words.keeps, words.kept_region, words.order, words.more];
            let is_layer = |t: &&str| t.contains("EF-") || t.contains("polyline");
            assert_eq!(all.iter().any(is_layer), format == Format::Dxf, "{words:?}");
            assert!(words.order.contains(words.moves) || matches!(format, Format::Gltf | Format::Glb));
        }
    }
}
