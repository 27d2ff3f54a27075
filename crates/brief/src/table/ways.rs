//! Walking and turning, lines of sight, and steps from chosen points.

use super::Row;
use crate::column::{
    ANGULAR_NODE_COUNT, ANGULAR_STEP_DEPTH, Heading, METRIC_NODE_COUNT, METRIC_STEP_LENGTH, METRIC_STEP_TURN,
    VISUAL_STEP_DEPTH,
};
use crate::{Entry, Growth, Measure, Source, Wording};

pub(super) const ROWS: &[Row] = &[
    Row {
        column: Some(Heading {
            name: "Metric Mean Shortest-Path Turn",
            unit: "right angles",
            meaning: "How much one turns on the shortest way to a cell, on average; shortest as below. Where several ways are equally short, depthmapX's Metric Mean Shortest-Path Angle may be that of another: single cells differ by up to 3 %, whole plans by 0.1 %.",
        }),
        measure: Some(Entry {
            measure: Measure::MetricAngle,
            words: Wording {
                key: "metric-angle",
                plain: "Turning on the shortest ways",
                technical: "metric mean shortest-path angle",
                unit: "right angles",
                meaning: "How much one turns on the shortest ways to the other spots, on average.",
                more_less: ["more turning", "less turning"],
            },
            better: None,
            definition: "mean turn on them",
            origin: "depthmapX",
            source: Source::Metric,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Metric Mean Shortest-Path Distance",
            unit: "m",
            meaning: "The length of the shortest way to a cell, on average. Ways turn at centres of cells alone and are kept one a cell, as in depthmapX, and only at those next to a wall, so this is an upper bound: on coarse lattices single cells were found 8 % too long, whole plans within 2 %.",
        }),
        measure: Some(Entry {
            measure: Measure::MetricDistance,
            words: Wording {
                key: "metric-distance",
                plain: "Walking distance",
                technical: "metric mean shortest-path distance",
                unit: "m",
                meaning: "How far it is to walk to the other spots, on average.",
                more_less: ["longer ways", "shorter ways"],
            },
            better: None,
            definition: "mean length of the shortest ways",
            origin: "depthmapX",
            source: Source::Metric,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Metric Mean Straight-Line Distance",
            unit: "m",
            meaning: "The distance to a cell as the crow flies, on average.",
        }),
        measure: Some(Entry {
            measure: Measure::MetricStraight,
            words: Wording {
                key: "metric-straight",
                plain: "Distance as the crow flies",
                technical: "metric mean straight-line distance",
                unit: "m",
                meaning: "How far the other spots that can be reached are in a straight line, on average.",
                more_less: ["farther apart", "nearer together"],
            },
            better: None,
            definition: "mean straight distance",
            origin: "depthmapX",
            source: Source::Metric,
            growth: Growth::Fixed,
        }),
    },
    Row::column(METRIC_NODE_COUNT, "cells", "How many cells the mean was taken over, this one included."),
    Row {
        column: Some(Heading {
            name: "Angular Mean Depth",
            unit: "right angles",
            meaning: "How much one has to turn at least on the way to a cell, on average. Ways turn at centres of cells alone and one is kept a cell, as in depthmapX, and only at those next to a wall, so this is an upper bound: on coarse lattices single cells were found 13 % too high, whole plans within 2 %.",
        }),
        measure: Some(Entry {
            measure: Measure::AngularDepth,
            words: Wording {
                key: "angular-depth",
                plain: "Turning",
                technical: "angular mean depth",
                unit: "right angles",
                meaning: "How much one has to turn to get to the other spots, on average, on the straightest ways.",
                more_less: ["more turning", "less turning"],
            },
            better: None,
            definition: "mean of the least turns",
            origin: "depthmapX",
            source: Source::Angular,
            growth: Growth::Fixed,
        }),
    },
    Row::column(ANGULAR_NODE_COUNT, "cells", "How many cells the mean was taken over, this one included."),
    Row {
        column: Some(Heading {
            name: "Angular Total Depth",
            unit: "right angles",
            meaning: "The least turns to all cells, added up: an upper bound, as the mean is.",
        }),
        measure: Some(Entry {
            measure: Measure::AngularTotal,
            words: Wording {
                key: "angular-total",
                plain: "Turning in all",
                technical: "angular total depth",
                unit: "right angles",
                meaning: "How much one has to turn to get to every other spot, added up.",
                more_less: ["more turning", "less turning"],
            },
            better: None,
            definition: "sum of the least turns",
            origin: "depthmapX",
            source: Source::Angular,
            growth: Growth::Sum,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Sight Lines Through",
            unit: "lines",
            meaning: "How many lines of sight between two other cells pass here: high where many look through, as in a doorway or an axis. depthmapX's Through vision counts each both ways and leaves diagonal lines out.",
        }),
        measure: Some(Entry {
            measure: Measure::ThroughVision,
            words: Wording {
                key: "through-vision",
                plain: "Views passing over",
                technical: "through vision",
                unit: "sight lines",
                meaning: "How many lines of sight pass over a spot: high where people are in everybody's view.",
                more_less: ["more views pass", "fewer views pass"],
            },
            better: None,
            definition: "lines of sight between others that pass",
            origin: "depthmapX",
            source: Source::Through,
            growth: Growth::Lines,
        }),
    },
    Row::column(
        VISUAL_STEP_DEPTH,
        "steps",
        "How many steps, each as far as one sees, it takes from the chosen points.",
    ),
    Row::column(
        METRIC_STEP_TURN,
        "right angles",
        "How much one turns on the shortest way from the chosen points.",
    ),
    Row::column(METRIC_STEP_LENGTH, "m", "The length of the shortest way from the chosen points."),
    Row::column(
        ANGULAR_STEP_DEPTH,
        "right angles",
        "How much one has to turn at least from the chosen points.",
    ),
];
