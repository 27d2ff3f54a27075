//! The region of reference, which every table of cells has, and the layout as a whole.

use super::Row;
use crate::column::Heading;
use crate::{Entry, Growth, Measure, Sense, Source, Wording};

pub(super) const ROWS: &[Row] = &[
    Row {
        column: Some(Heading {
            name: "Degree",
            unit: "cells",
            meaning: "How much of the region of reference can be seen from here.",
        }),
        measure: Some(Entry {
            measure: Measure::Degree,
            words: Wording {
                key: "degree",
                plain: "Visibility",
                technical: "degree",
                unit: "m² seen",
                meaning: "The floor of the region of reference that can be seen from a spot. High: open, overlooked, easy to find. Low: secluded.",
                more_less: ["more is seen", "less is seen"],
            },
            better: Some(Sense::Max),
            definition: "*k* within the reference region × cell area",
            origin: "µDOME",
            source: Source::Forest,
            growth: Growth::Cells,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Depth",
            unit: "steps",
            meaning: "How many steps, each as far as one sees, it takes to the farthest cell.",
        }),
        measure: Some(Entry {
            measure: Measure::Depth,
            words: Wording {
                key: "depth",
                plain: "Most steps",
                technical: "tree depth",
                unit: "steps",
                meaning: "How many straight views one after the other it takes to reach the farthest corner from a spot. Fewer steps: fewer turns, easier to reach.",
                more_less: ["more turns", "fewer turns"],
            },
            better: Some(Sense::Min),
            definition: "last level with a cell",
            origin: "µDOME",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Entropy",
            unit: "bits",
            meaning: "How evenly the space is spread over the steps it takes to reach it; 0 where nothing is seen.",
        }),
        measure: Some(Entry {
            measure: Measure::Entropy,
            words: Wording {
                key: "entropy",
                plain: "Evenness",
                technical: "entropy",
                unit: "bits",
                meaning: "How evenly the space is spread over those steps. High: it opens up in even portions, so that each decision on the way is alike. Low: almost everything lies at one distance, with bottlenecks or too many choices at once.",
                more_less: ["opens up more evenly", "less evenly spread"],
            },
            better: Some(Sense::Max),
            definition: "−Σ *p_j* log₂ *p_j*, *p_j* = *n_j* / Σ *n_j*",
            origin: "µDOME, Turner 2001",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: None,
        measure: Some(Entry {
            measure: Measure::Score,
            words: Wording {
                key: "score",
                plain: "Score",
                technical: "weighted sum",
                unit: "",
                meaning: "The weighted sum of the relative gains over the present layout, less the penalties. The present layout gains nothing over itself, so its score is that of its penalties.",
                more_less: ["", ""],
            },
            better: Some(Sense::Max),
            definition: "Σ weight × relative gain − penalties",
            origin: "µDOME",
            source: Source::Layout,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: None,
        measure: Some(Entry {
            measure: Measure::Penalty,
            words: Wording {
                key: "penalty",
                plain: "Penalty",
                technical: "penalty",
                unit: "",
                meaning: "The penalties of a layout, each times its weight, added up.",
                more_less: ["", ""],
            },
            better: Some(Sense::Min),
            definition: "[Σ weight × penalty](limits.md)",
            origin: "µDOME",
            source: Source::Layout,
            growth: Growth::Fixed,
        }),
    },
];
