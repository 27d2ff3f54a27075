//! Who sees whom, and the views it takes to get somewhere.

use super::Row;
use crate::column::{Heading, MEAN_DEPTH_INTERVAL, VISUAL_ENTROPY};
use crate::{Entry, Growth, Measure, Sense, Source, Wording};

pub(super) const ROWS: &[Row] = &[
    Row {
        column: Some(Heading {
            name: "Connectivity",
            unit: "cells",
            meaning: "How many other cells can be seen from here.",
        }),
        measure: Some(Entry {
            measure: Measure::Connectivity,
            words: Wording {
                key: "connectivity",
                plain: "Visibility of everything",
                technical: "connectivity",
                unit: "m² seen",
                meaning: "How much of everything that is measured can be seen from a spot.",
                more_less: ["more is seen", "less is seen"],
            },
            better: None,
            definition: "*k* × cell area",
            origin: "Turner 2001",
            source: Source::Forest,
            growth: Growth::Cells,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Point First Moment",
            unit: "m",
            meaning: "The distances to all cells seen, added up: large where the view is wide and far.",
        }),
        measure: Some(Entry {
            measure: Measure::FirstMoment,
            words: Wording {
                key: "first-moment",
                plain: "Sum of distances seen",
                technical: "point first moment",
                unit: "m",
                meaning: "The distances to all cells seen, added up: large where the view is wide and far.",
                more_less: ["wider views", "narrower views"],
            },
            better: None,
            definition: "Σ *r_i*",
            origin: "depthmapX",
            source: Source::Graph,
            growth: Growth::Sum,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Point Second Moment",
            unit: "m²",
            meaning: "The squares of the distances to all cells seen, added up: far views count most.",
        }),
        measure: Some(Entry {
            measure: Measure::SecondMoment,
            words: Wording {
                key: "second-moment",
                plain: "Sum of squared distances seen",
                technical: "point second moment",
                unit: "m²",
                meaning: "The squares of the distances to all cells seen, added up: far views count most.",
                more_less: ["farther views", "shorter views"],
            },
            better: None,
            definition: "Σ *r_i*²",
            origin: "depthmapX",
            source: Source::Graph,
            growth: Growth::Sum,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Clustering Coefficient",
            unit: "share",
            meaning: "How much of what is seen from here sees each other. 1: one open room. Low: a junction from which parts are seen that do not see each other.",
        }),
        measure: Some(Entry {
            measure: Measure::Clustering,
            words: Wording {
                key: "clustering",
                plain: "Enclosure",
                technical: "clustering coefficient",
                unit: "",
                meaning: "The share of the spots seen from here that also see each other. High: a room of its own. Low: a crossing where views part.",
                more_less: ["more enclosed", "more open"],
            },
            better: None,
            definition: "pairs of seen cells that see each other / all such pairs, from 0 to 1",
            origin: "Turner 2001",
            source: Source::Graph,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Control",
            unit: "",
            meaning: "Whether this spot sees cells that see little themselves: high where one place watches over many secluded ones.",
        }),
        measure: Some(Entry {
            measure: Measure::Control,
            words: Wording {
                key: "control",
                plain: "Control",
                technical: "control",
                unit: "",
                meaning: "Whether a spot sees places that see little themselves: high where one place watches over many secluded ones.",
                more_less: ["watches over more", "watches over less"],
            },
            better: None,
            definition: "Σ 1 / *k* of each cell seen",
            origin: "Turner 2001",
            source: Source::Graph,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Controllability",
            unit: "share",
            meaning: "What is seen from here as a share of all that is seen from there: low where one is easily watched from elsewhere.",
        }),
        measure: Some(Entry {
            measure: Measure::Controllability,
            words: Wording {
                key: "controllability",
                plain: "Controllability",
                technical: "controllability",
                unit: "",
                meaning: "What is seen from a spot as a share of all that is seen from there: low where one is easily watched from elsewhere.",
                more_less: ["harder to watch", "easier to watch"],
            },
            better: None,
            definition: "*k* / cells within two steps, with this one, from 0 to 1",
            origin: "Turner 2001",
            source: Source::Graph,
            growth: Growth::Fixed,
        }),
    },
    Row::column(
        VISUAL_ENTROPY,
        "bits",
        "How evenly the space is spread over the steps it takes to reach it.",
    ),
    Row {
        column: Some(Heading {
            name: "Visual Integration [HH]",
            unit: "",
            meaning: "How few steps, each as far as one sees, it takes to reach everything, made comparable between plans of different size. High: central. Low: remote.",
        }),
        measure: Some(Entry {
            measure: Measure::Integration,
            words: Wording {
                key: "integration",
                plain: "Integration",
                technical: "integration HH",
                unit: "HH",
                meaning: "How close a spot is to all others, counted in views and made comparable between plans of different size.",
                more_less: ["better connected", "more remote"],
            },
            better: Some(Sense::Max),
            definition: "*D* / *RA*, *RA* = 2 (*d* − 1) / (*N* − 2), *D* = 2 (*N* (log₂((*N* + 2)/3) − 1) + 1) / ((*N* − 1)(*N* − 2))",
            origin: "Hillier 1984",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Integration [P-value]",
            unit: "",
            meaning: "The same, made comparable by another formula.",
        }),
        measure: Some(Entry {
            measure: Measure::IntegrationPValue,
            words: Wording {
                key: "integration-p-value",
                plain: "Integration (P-value)",
                technical: "integration by the P-value",
                unit: "",
                meaning: "Integration, made comparable between plans by another formula.",
                more_less: ["better connected", "more remote"],
            },
            better: None,
            definition: "2 (*N* − log₂ *N* − 1) / ((*N* − 1)(*N* − 2)) / *RA*",
            origin: "depthmapX",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Integration [Tekl]",
            unit: "",
            meaning: "The same, made comparable by Teklenburg's formula.",
        }),
        measure: Some(Entry {
            measure: Measure::IntegrationTekl,
            words: Wording {
                key: "integration-tekl",
                plain: "Integration (Tekl)",
                technical: "integration by Teklenburg's formula",
                unit: "",
                meaning: "Integration, made comparable between plans by Teklenburg's formula.",
                more_less: ["better connected", "more remote"],
            },
            better: None,
            definition: "ln((*N* − 2)/2) / ln(*T* − *N* + 1)",
            origin: "Teklenburg 1993",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Mean Depth",
            unit: "steps",
            meaning: "How many steps, each as far as one sees, it takes on average to reach a cell.",
        }),
        measure: Some(Entry {
            measure: Measure::MeanDepth,
            words: Wording {
                key: "mean-depth",
                plain: "Steps",
                technical: "mean depth",
                unit: "steps",
                meaning: "How many straight views one after the other it takes from a spot to the others, on average: one more than the turns on the way.",
                more_less: ["more turns", "fewer turns"],
            },
            better: Some(Sense::Min),
            definition: "*d*",
            origin: "Hillier 1984",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
    Row::column(
        MEAN_DEPTH_INTERVAL,
        "steps",
        "Half the width of the interval that holds the mean depth in about 95 of 100 cases, where it was estimated from some cells of its area (Student's factor by how many; where all say the same, as if one more were a step off). −1: from one of several, which says nothing of the others.",
    ),
    Row {
        column: Some(Heading {
            name: "Visual Node Count",
            unit: "cells",
            meaning: "How many cells can be reached at all, this one included: the size of the area the cell belongs to.",
        }),
        measure: Some(Entry {
            measure: Measure::Reach,
            words: Wording {
                key: "reach",
                plain: "Reach",
                technical: "node count",
                unit: "m²",
                meaning: "How much of the plan can be reached from a spot at all.",
                more_less: ["more is reached", "less is reached"],
            },
            better: None,
            definition: "(*N* − 1) × cell area",
            origin: "Turner 2001",
            source: Source::Forest,
            growth: Growth::Cells,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Visual Relativised Entropy",
            unit: "bits",
            meaning: "How far the spread over steps differs from what the mean depth alone would lead one to expect.",
        }),
        measure: Some(Entry {
            measure: Measure::RelativisedEntropy,
            words: Wording {
                key: "relativised-entropy",
                plain: "Unexpected spread",
                technical: "relativised entropy",
                unit: "bits",
                meaning: "How far the spread of the space over the views differs from what the mean depth leads one to expect.",
                more_less: ["less as expected", "more as expected"],
            },
            better: None,
            definition: "Σ *p_j* log₂ (*p_j* / *q_j*), *q_j* = *d^j* e^−*d* / (*j* + 1)!",
            origin: "depthmapX",
            source: Source::Forest,
            growth: Growth::Fixed,
        }),
    },
];
