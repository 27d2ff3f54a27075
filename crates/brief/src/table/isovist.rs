//! The polygon seen.

use super::Row;
use crate::column::{DEGREES, DRIFT_ANGLE, Heading};
use crate::{Entry, Growth, Measure, Source, Wording};

pub(super) const ROWS: &[Row] = &[
    Row {
        column: Some(Heading {
            name: "Isovist Area",
            unit: "m²",
            meaning: "The area that can be seen from here.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistArea,
            words: Wording {
                key: "isovist-area",
                plain: "Area seen",
                technical: "isovist area",
                unit: "m²",
                meaning: "The area of the floor that can be seen from a spot.",
                more_less: ["more is seen", "less is seen"],
            },
            better: None,
            definition: "*A*",
            origin: "Benedikt 1979",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Isovist Compactness",
            unit: "share",
            meaning: "How round the visible area is: 1 for a circle, low for a long or ragged one.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistCompactness,
            words: Wording {
                key: "isovist-compactness",
                plain: "Roundness of the view",
                technical: "isovist compactness",
                unit: "",
                meaning: "How close what can be seen from a spot comes to a circle: 1 is a circle, a long corridor is near 0.",
                more_less: ["rounder views", "longer views"],
            },
            better: None,
            definition: "4π*A* / *P*², from 0 to 1",
            origin: "depthmapX",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row::column(
        DRIFT_ANGLE,
        DEGREES,
        "The direction, anticlockwise from the right, in which most of the visible area lies.",
    ),
    Row {
        column: Some(Heading {
            name: "Isovist Drift Magnitude",
            unit: "m",
            meaning: "How far the middle of the visible area is from here: 0 at the centre of a room.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistDrift,
            words: Wording {
                key: "isovist-drift",
                plain: "Drift of the view",
                technical: "isovist drift magnitude",
                unit: "m",
                meaning: "How far the middle of what is seen lies from the spot: large at an edge that looks into the open.",
                more_less: ["views drift more", "views drift less"],
            },
            better: None,
            definition: "distance to the centroid of the polygon",
            origin: "depthmapX",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading { name: "Isovist Max Radial", unit: "m", meaning: "The longest view." }),
        measure: Some(Entry {
            measure: Measure::IsovistMaxRadial,
            words: Wording {
                key: "isovist-max-radial",
                plain: "Longest view",
                technical: "isovist max radial",
                unit: "m",
                meaning: "How far one can see from a spot at most.",
                more_less: ["farther views", "shorter views"],
            },
            better: None,
            definition: "farthest point of *P*",
            origin: "Benedikt 1979",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Isovist Min Radial",
            unit: "m",
            meaning: "The distance to the nearest wall.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistMinRadial,
            words: Wording {
                key: "isovist-min-radial",
                plain: "Nearest wall",
                technical: "isovist min radial",
                unit: "m",
                meaning: "How far the nearest wall is from a spot.",
                more_less: ["more room around", "less room around"],
            },
            better: None,
            definition: "nearest point of *P*",
            origin: "Benedikt 1979",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Isovist Occlusivity",
            unit: "m",
            meaning: "The length of the visible area's edges that are not walls: beyond them there is more to discover.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistOcclusivity,
            words: Wording {
                key: "isovist-occlusivity",
                plain: "Hidden edges",
                technical: "isovist occlusivity",
                unit: "m",
                meaning: "The length of the edges behind which something is hidden: how much a view promises.",
                more_less: ["more behind corners", "less behind corners"],
            },
            better: None,
            definition: "length of *P* that is no wall",
            origin: "Benedikt 1979",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
    Row {
        column: Some(Heading {
            name: "Isovist Perimeter",
            unit: "m",
            meaning: "The length of the outline of the visible area.",
        }),
        measure: Some(Entry {
            measure: Measure::IsovistPerimeter,
            words: Wording {
                key: "isovist-perimeter",
                plain: "Outline of the view",
                technical: "isovist perimeter",
                unit: "m",
                meaning: "The length of the outline of what can be seen from a spot.",
                more_less: ["longer outline", "shorter outline"],
            },
            better: None,
            definition: "*P*",
            origin: "Benedikt 1979",
            source: Source::Isovist,
            growth: Growth::Fixed,
        }),
    },
];
