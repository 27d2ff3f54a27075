//! What can be asked of a layout: the measures, their names and what each is computed from.

/// What an objective measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Measure {
    /// Neighbours within the region of reference.
    Degree,
    /// Tree depth.
    Depth,
    /// Entropy of the levels, bits.
    Entropy,
    /// Mean depth of the vertices reached.
    MeanDepth,
    /// Vertices reached.
    Reach,
    /// All neighbours, in either region.
    Connectivity,
    /// Integration by the D-value (Hillier and Hanson).
    Integration,
    /// Integration by the P-value.
    IntegrationPValue,
    /// Integration by Teklenburg's formula.
    IntegrationTekl,
    /// Relativised entropy, bits.
    RelativisedEntropy,
    /// Area of the isovist, m².
    IsovistArea,
    /// Perimeter of the isovist, m.
    IsovistPerimeter,
    /// Compactness of the isovist, 0 to 1.
    IsovistCompactness,
    /// Occlusivity of the isovist, m.
    IsovistOcclusivity,
    /// Distance from the cell to the centroid of its isovist, m.
    IsovistDrift,
    /// Farthest point of the isovist, m.
    IsovistMaxRadial,
    /// Nearest point of the isovist's outline, m.
    IsovistMinRadial,
    /// Clustering coefficient, 0 to 1.
    Clustering,
    /// Control.
    Control,
    /// Controllability, 0 to 1.
    Controllability,
    /// Σ of the distances to all neighbours, m.
    FirstMoment,
    /// Σ of their squares, m².
    SecondMoment,
    /// Mean length of the shortest ways to all others, m.
    MetricDistance,
    /// Mean turning on those ways; 1 is a right angle.
    MetricAngle,
    /// Mean length of the straight lines to all others, m.
    MetricStraight,
    /// Mean turning on the straightest ways; 1 is a right angle.
    AngularDepth,
    /// Their sum.
    AngularTotal,
    /// Sight lines that pass over the cell.
    ThroughVision,
    /// The composite `score`.
    Score,
    /// Σ of the weighted penalties.
    Penalty,
}

/// What a measure is computed from; it decides what it costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The levels of the breadth-first trees, which every layout has: free.
    Forest,
    /// The polygon seen from every cell of the region of query.
    Isovist,
    /// The visibility graph, stored whole: neighbours of neighbours.
    Graph,
    /// The shortest ways through it, from every cell.
    Metric,
    /// The straightest ways through it, from every cell.
    Angular,
    /// All its sight lines, cell by cell.
    Through,
    /// The layout as a whole.
    Layout,
}

impl Source {
    /// Whether the visibility graph has to be stored whole.
    pub fn is_of_graph(self) -> bool {
        matches!(self, Self::Graph | Self::Metric | Self::Angular | Self::Through)
    }

    /// Why a layout takes longer to measure, in plain words; `None` where it does not.
    pub fn cost(self) -> Option<&'static str> {
        match self {
            Self::Forest | Self::Layout => None,
            Self::Isovist => Some("draws the polygon seen from every cell"),
            Self::Graph => Some("stores who sees whom and compares the neighbours of neighbours"),
            Self::Metric => Some("walks the shortest ways from every cell to every other"),
            Self::Angular => Some("walks the straightest ways from every cell to every other"),
            Self::Through => Some("follows every line of sight cell by cell"),
        }
    }
}

/// Every measure with its name in settings and files.
const NAMES: [(Measure, &str); 30] = [
    (Measure::Degree, "degree"),
    (Measure::Depth, "depth"),
    (Measure::Entropy, "entropy"),
    (Measure::MeanDepth, "mean-depth"),
    (Measure::Reach, "reach"),
    (Measure::Connectivity, "connectivity"),
    (Measure::Integration, "integration"),
    (Measure::IntegrationPValue, "integration-p-value"),
    (Measure::IntegrationTekl, "integration-tekl"),
    (Measure::RelativisedEntropy, "relativised-entropy"),
    (Measure::IsovistArea, "isovist-area"),
    (Measure::IsovistPerimeter, "isovist-perimeter"),
    (Measure::IsovistCompactness, "isovist-compactness"),
    (Measure::IsovistOcclusivity, "isovist-occlusivity"),
    (Measure::IsovistDrift, "isovist-drift"),
    (Measure::IsovistMaxRadial, "isovist-max-radial"),
    (Measure::IsovistMinRadial, "isovist-min-radial"),
    (Measure::Clustering, "clustering"),
    (Measure::Control, "control"),
    (Measure::Controllability, "controllability"),
    (Measure::FirstMoment, "first-moment"),
    (Measure::SecondMoment, "second-moment"),
    (Measure::MetricDistance, "metric-distance"),
    (Measure::MetricAngle, "metric-angle"),
    (Measure::MetricStraight, "metric-straight"),
    (Measure::AngularDepth, "angular-depth"),
    (Measure::AngularTotal, "angular-total"),
    (Measure::ThroughVision, "through-vision"),
    (Measure::Score, "score"),
    (Measure::Penalty, "penalty"),
];

impl Measure {
    /// By what power of the spacing a value must be multiplied to be the same on a finer lattice: what counts cells or
    /// adds them up grows with their number, and sight lines over a cell with the square of it, over its width.
    pub fn power_of_spacing(self) -> i32 {
        match self {
            Self::Degree | Self::Connectivity | Self::Reach => 2,
            Self::FirstMoment | Self::SecondMoment | Self::AngularTotal => 2,
            Self::ThroughVision => 3,
            _ => 0,
        }
    }

    /// The three measures of the paper.
    pub const MEAN: [Self; 3] = [Self::Degree, Self::Depth, Self::Entropy];

    /// Name as in settings and files.
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(m, _)| *m == self).map_or("", |(_, name)| name)
    }

    /// All names that settings may say, separated by commas.
    pub fn all_names() -> String {
        NAMES.map(|(_, name)| name).join(", ")
    }

    pub(super) fn by_name(name: &str) -> Option<Self> {
        NAMES.iter().find(|(_, n)| *n == name).map(|(m, _)| *m)
    }

    /// Whether every cell has a value of it.
    pub fn is_of_cells(self) -> bool {
        self.source() != Source::Layout
    }

    /// What it is computed from.
    pub fn source(self) -> Source {
        match self {
            Self::Degree
            | Self::Depth
            | Self::Entropy
            | Self::MeanDepth
            | Self::Reach
            | Self::Connectivity
            | Self::Integration
            | Self::IntegrationPValue
            | Self::IntegrationTekl
            | Self::RelativisedEntropy => Source::Forest,
            Self::IsovistArea
            | Self::IsovistPerimeter
            | Self::IsovistCompactness
            | Self::IsovistOcclusivity
            | Self::IsovistDrift
            | Self::IsovistMaxRadial
            | Self::IsovistMinRadial => Source::Isovist,
            Self::Clustering
            | Self::Control
            | Self::Controllability
            | Self::FirstMoment
            | Self::SecondMoment => Source::Graph,
            Self::MetricDistance | Self::MetricAngle | Self::MetricStraight => Source::Metric,
            Self::AngularDepth | Self::AngularTotal => Source::Angular,
            Self::ThroughVision => Source::Through,
            Self::Score | Self::Penalty => Source::Layout,
        }
    }

    /// The column of a measure of the stored graph, by depthmapX's name.
    pub fn column(self) -> Option<&'static str> {
        Some(match self {
            Self::Clustering => "Visual Clustering Coefficient",
            Self::Control => "Visual Control",
            Self::Controllability => "Visual Controllability",
            Self::FirstMoment => "Point First Moment",
            Self::SecondMoment => "Point Second Moment",
            Self::MetricDistance => "Metric Mean Shortest-Path Distance",
            Self::MetricAngle => "Metric Mean Shortest-Path Turn",
            Self::MetricStraight => "Metric Mean Straight-Line Distance",
            Self::AngularDepth => "Angular Mean Depth",
            Self::AngularTotal => "Angular Total Depth",
            Self::ThroughVision => "Sight Lines Through",
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_measure_has_a_name_and_a_source() {
        for (measure, name) in NAMES {
            assert_eq!((measure.name(), Measure::by_name(name)), (name, Some(measure)));
            assert_eq!(measure.source().is_of_graph(), measure.column().is_some(), "{name}");
        }
        let mut names = NAMES.map(|n| n.1).to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), NAMES.len());
    }
}
