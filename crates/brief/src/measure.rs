//! What can be asked of a layout: the measures and what each is computed from.

use super::Entry;
use super::table::ENTRIES;

/// What an objective measures, in the order in which settings name them. [`crate::TABLE`] has a row of each.
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

    /// What it costs beyond the trees, in a word or two; `None` where that is nothing.
    pub fn cost_in_short(self) -> Option<&'static str> {
        match self {
            Self::Forest | Self::Layout => None,
            Self::Isovist => Some("a polygon a cell"),
            Self::Graph => Some("the whole graph"),
            Self::Metric | Self::Angular => Some("all ways"),
            Self::Through => Some("every line"),
        }
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

/// How the values of a measure grow as cells become smaller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Growth {
    /// Not at all.
    Fixed,
    /// They count cells, which people are told as area: with their number.
    Cells,
    /// They add cells up: with their number.
    Sum,
    /// They count sight lines over a cell: with the square of the number of cells, over the width of one.
    Lines,
}

impl Measure {
    /// The three measures of the paper.
    pub const MEAN: [Self; 3] = [Self::Degree, Self::Depth, Self::Entropy];

    /// What the table says of it.
    pub fn entry(self) -> &'static Entry {
        ENTRIES[self as usize]
    }

    /// Name as in settings and files.
    pub fn name(self) -> &'static str {
        self.entry().words.key
    }

    /// All names that settings may say, separated by commas.
    pub fn all_names() -> String {
        ENTRIES.map(|e| e.words.key).join(", ")
    }

    /// The measure of a name; `None` if no measure has it.
    pub fn by_name(name: &str) -> Option<Self> {
        ENTRIES.iter().find(|e| e.words.key == name).map(|e| e.measure)
    }

    /// What it is computed from.
    pub fn source(self) -> Source {
        self.entry().source
    }

    /// Whether every cell has a value of it.
    pub fn is_of_cells(self) -> bool {
        self.source() != Source::Layout
    }

    /// By what power of the spacing a value must be multiplied to be the same on a finer lattice.
    pub fn power_of_spacing(self) -> i32 {
        match self.entry().growth {
            Growth::Fixed => 0,
            Growth::Cells | Growth::Sum => 2,
            Growth::Lines => 3,
        }
    }

    /// The name of its column in the table of cells; `None` for what is of the layout as a whole.
    pub fn column(self) -> Option<&'static str> {
        super::rows().find(|row| row.measure.is_some_and(|e| e.measure == self))?.column.map(|c| c.name)
    }
}
