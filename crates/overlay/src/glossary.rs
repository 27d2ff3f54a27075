//! Every measure of a cell, by the name of its column, in plain words.

use super::html::Html;

/// One column: its name, what a unit of it is, what it tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name of the column, without the radius.
    pub name: &'static str,
    /// What one unit is; empty for plain numbers.
    pub unit: &'static str,
    /// In plain words.
    pub meaning: &'static str,
}

/// Unit of a direction.
pub const DEGREES: &str = "°";

const fn entry(name: &'static str, unit: &'static str, meaning: &'static str) -> Entry {
    Entry { name, unit, meaning }
}

/// In the order of the families: sight, the views it takes, the visible area, walking, turning.
pub const ENTRIES: &[Entry] = &[
    entry("Connectivity", "cells", "How many other cells can be seen from here."),
    entry(
        "Point First Moment",
        "m",
        "The distances to all cells seen, added up: large where the view is wide and far.",
    ),
    entry(
        "Point Second Moment",
        "m²",
        "The squares of the distances to all cells seen, added up: far views count most.",
    ),
    entry(
        "Visual Clustering Coefficient",
        "share",
        "How much of what is seen from here sees each other. 1: one open room. Low: a junction from which parts are seen that do not see each other.",
    ),
    entry(
        "Visual Control",
        "",
        "Whether this spot sees cells that see little themselves: high where one place watches over many secluded ones.",
    ),
    entry(
        "Visual Controllability",
        "share",
        "What is seen from here as a share of all that is seen from there: low where one is easily watched from elsewhere.",
    ),
    entry("Visual Entropy", "bits", "How evenly the space is spread over the steps it takes to reach it."),
    entry(
        "Visual Integration [HH]",
        "",
        "How few steps, each as far as one sees, it takes to reach everything, made comparable between plans of different size. High: central. Low: remote.",
    ),
    entry("Visual Integration [P-value]", "", "The same, made comparable by another formula."),
    entry("Visual Integration [Tekl]", "", "The same, made comparable by Teklenburg's formula."),
    entry(
        "Visual Mean Depth",
        "steps",
        "How many steps, each as far as one sees, it takes on average to reach a cell.",
    ),
    entry(
        "Visual Mean Depth CI95",
        "steps",
        "Half the width of the interval that holds the mean depth in about 95 of 100 cases, where it was estimated from some cells of its area (Student's factor by how many; where all say the same, as if one more were a step off). −1: from one of several, which says nothing of the others.",
    ),
    entry(
        "Visual Node Count",
        "cells",
        "How many cells can be reached at all, this one included: the size of the area the cell belongs to.",
    ),
    entry(
        "Visual Relativised Entropy",
        "bits",
        "How far the spread over steps differs from what the mean depth alone would lead one to expect.",
    ),
    entry("Isovist Area", "m²", "The area that can be seen from here."),
    entry(
        "Isovist Compactness",
        "share",
        "How round the visible area is: 1 for a circle, low for a long or ragged one.",
    ),
    entry(
        "Isovist Drift Angle",
        DEGREES,
        "The direction, anticlockwise from the right, in which most of the visible area lies.",
    ),
    entry(
        "Isovist Drift Magnitude",
        "m",
        "How far the middle of the visible area is from here: 0 at the centre of a room.",
    ),
    entry("Isovist Max Radial", "m", "The longest view."),
    entry("Isovist Min Radial", "m", "The distance to the nearest wall."),
    entry(
        "Isovist Occlusivity",
        "m",
        "The length of the visible area's edges that are not walls: beyond them there is more to discover.",
    ),
    entry("Isovist Perimeter", "m", "The length of the outline of the visible area."),
    entry(
        "Metric Mean Shortest-Path Turn",
        "right angles",
        "How much one turns on the shortest way to a cell, on average; shortest as below. Where several ways are equally short, depthmapX's Metric Mean Shortest-Path Angle may be that of another: single cells differ by up to 3 %, whole plans by 0.1 %.",
    ),
    entry(
        "Metric Mean Shortest-Path Distance",
        "m",
        "The length of the shortest way to a cell, on average. Ways turn at centres of cells alone and are kept one a cell, as in depthmapX, and only at those next to a wall, so this is an upper bound: on coarse lattices single cells were found 8 % too long, whole plans within 2 %.",
    ),
    entry("Metric Mean Straight-Line Distance", "m", "The distance to a cell as the crow flies, on average."),
    entry("Metric Node Count", "cells", "How many cells the mean was taken over, this one included."),
    entry(
        "Angular Mean Depth",
        "right angles",
        "How much one has to turn at least on the way to a cell, on average. Ways turn at centres of cells alone and one is kept a cell, as in depthmapX, and only at those next to a wall, so this is an upper bound: on coarse lattices single cells were found 13 % too high, whole plans within 2 %.",
    ),
    entry("Angular Node Count", "cells", "How many cells the mean was taken over, this one included."),
    entry(
        "Angular Total Depth",
        "right angles",
        "The least turns to all cells, added up: an upper bound, as the mean is.",
    ),
    entry(
        "Sight Lines Through",
        "lines",
        "How many lines of sight between two other cells pass here: high where many look through, as in a doorway or an axis. depthmapX's Through vision counts each both ways and leaves diagonal lines out.",
    ),
    entry(
        "Visual Step Depth",
        "steps",
        "How many steps, each as far as one sees, it takes from the chosen points.",
    ),
    entry(
        "Metric Step Shortest-Path Turn",
        "right angles",
        "How much one turns on the shortest way from the chosen points.",
    ),
    entry("Metric Step Shortest-Path Length", "m", "The length of the shortest way from the chosen points."),
    entry("Angular Step Depth", "right angles", "How much one has to turn at least from the chosen points."),
    entry("Degree", "cells", "How much of the region of reference can be seen from here."),
    entry("Depth", "steps", "How many steps, each as far as one sees, it takes to the farthest cell."),
    entry(
        "Entropy",
        "bits",
        "How evenly the space is spread over the steps it takes to reach it; 0 where nothing is seen.",
    ),
];

/// Why a cell may have no value, or one that cannot be compared.
pub const CUT_OFF: &str = "Cells that no view joins to the rest have the values of their own area: its size is their Visual \
    Node Count. −1 stands where a measure has no value: a cell that sees no other (under a wall, or walled in alone) has no \
    depth and no integration, nor has an area all of which is seen at once any integration; a cell that cannot be reached \
    from the chosen points has no step depth.";

/// What a cell without a value of a column is called.
pub fn no_value(column: &str) -> &'static str {
    match column {
        c if c.contains("Step") => "cannot be reached from there",
        c if c.starts_with("Visual Integration") => "no value: all seen at once, or nothing",
        c if c.starts_with("Isovist") => "under a wall",
        c if c.starts_with("Metric") || c.starts_with("Angular") => "under a wall, or reaches no other cell",
        _ => "under a wall, or sees too few cells",
    }
}

/// The entry of a column, its radius left out.
pub fn entry_of(column: &str) -> Option<&'static Entry> {
    let is_it = |e: &&Entry| {
        column.strip_prefix(e.name).is_some_and(|rest| {
            rest.is_empty() || rest.strip_prefix(" R").is_some_and(|radius| radius.parse::<f64>().is_ok())
        })
    };
    ENTRIES.iter().find(is_it)
}

/// The folded part of the page that explains every column.
pub(super) fn columns(html: &mut Html) {
    html.raw("<details id=\"measures\"><summary>Every measure of a cell, in plain words</summary>\n");
    html.element("p", &[("class", "note")], CUT_OFF).raw("\n<dl class=\"glossary\">\n");
    for e in ENTRIES {
        html.raw("<div><dt>").text(e.name).raw(" <small>").text(e.unit).raw("</small></dt>");
        html.element("dd", &[], e.meaning).raw("</div>\n");
    }
    html.raw("</dl>\n</details>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_radius_does_not_matter() {
        assert_eq!(entry_of("Visual Node Count R3").map(|e| e.name), Some("Visual Node Count"));
        assert_eq!(entry_of("Metric Node Count R1.5").map(|e| e.name), Some("Metric Node Count"));
        assert_eq!(entry_of("Visual Mean Depth CI95").map(|e| e.name), Some("Visual Mean Depth CI95"));
        assert_eq!(entry_of("Visual Node Count Range"), None);
    }

    /// A measured cell without a value is not called unmeasured.
    #[test]
    fn why_a_cell_has_no_value() {
        let reached = "cannot be reached from there";
        assert_eq!(no_value("Visual Step Depth"), reached);
        assert_eq!(no_value("Metric Step Shortest-Path Length"), reached);
        assert!(no_value("Visual Integration [HH] R3").contains("all seen at once"));
        assert!(ENTRIES.iter().all(|e| no_value(e.name) != "not measured"));
    }

    #[test]
    fn what_is_least_is_an_upper_bound() {
        for name in ["Angular Mean Depth", "Angular Total Depth", "Metric Mean Shortest-Path Distance"] {
            assert!(entry_of(name).unwrap().meaning.contains("upper bound"), "{name}");
        }
        for (name, worst) in [("Angular Mean Depth", "13 %"), ("Metric Mean Shortest-Path Distance", "8 %")] {
            let meaning = entry_of(name).unwrap().meaning;
            assert!(meaning.contains(&format!("single cells were found {worst}")), "{meaning}");
            assert!(!meaning.contains("at most") && meaning.contains("next to a wall"), "{meaning}");
        }
    }

    /// Depth has one unit, on maps, in tables and here.
    #[test]
    fn depth_is_counted_in_steps() {
        assert_eq!(crate::measure::wording("depth").map(|w| w.unit), Some("steps"));
        let depths = ENTRIES.iter().filter(|e| e.name.contains("Depth") && !e.name.starts_with("Angular"));
        depths.for_each(|e| assert_eq!(e.unit, "steps", "{}", e.name));
        assert!(ENTRIES.iter().all(|e| e.unit != "views"));
    }

    #[test]
    fn the_page_says_all_of_it() {
        let mut html = Html::default();
        columns(&mut html);
        let page = html.into_string();
        assert!(page.contains("id=\"measures\""));
        assert_eq!(page.matches("<dt>").count(), ENTRIES.len());
    }
}
