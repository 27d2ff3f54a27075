//! Every measure of a cell, by the name of its column, in plain words.

use enfilade_brief::{Heading, columns};

use super::html::Html;

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

/// What the table says of a column, its radius left out.
pub fn entry_of(column: &str) -> Option<&'static Heading> {
    let is_it = |e: &&Heading| {
        column.strip_prefix(e.name).is_some_and(|rest| {
            rest.is_empty() || rest.strip_prefix(" R").is_some_and(|radius| radius.parse::<f64>().is_ok())
        })
    };
    columns().find(is_it)
}

/// The folded part of the page that explains every column.
pub(super) fn explained(html: &mut Html) {
    html.raw("<details id=\"measures\"><summary>Every measure of a cell, in plain words</summary>\n");
    html.element("p", &[("class", "note")], CUT_OFF).raw("\n<dl class=\"glossary\">\n");
    for e in columns() {
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
        assert!(columns().all(|e| no_value(e.name) != "not measured"));
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
        let depths = columns().filter(|e| e.name.contains("Depth") && !e.name.starts_with("Angular"));
        depths.for_each(|e| assert_eq!(e.unit, "steps", "{}", e.name));
        assert!(columns().all(|e| e.unit != "views"));
    }

    #[test]
    fn the_page_says_all_of_it() {
        let mut html = Html::default();
        explained(&mut html);
        let page = html.into_string();
        assert!(page.contains("id=\"measures\""));
        assert_eq!(page.matches("<dt>").count(), columns().count());
    }
}
