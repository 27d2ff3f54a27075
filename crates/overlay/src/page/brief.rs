//! The brief of rooms, checked for the present layout.

use super::super::html::Html;
use super::super::result::RoundResult;

/// Every item with its places; nothing where nothing was asked.
pub(super) fn brief(html: &mut Html, result: &RoundResult) {
    if result.brief.is_empty() {
        return;
    }
    html.raw("<section>\n<h2>The brief of rooms</h2>\n<ul>\n");
    for item in &result.brief {
        html.open("li", &[]);
        for (k, line) in item.lines().iter().enumerate() {
            if k > 0 {
                html.raw("<br>");
            }
            html.words(line.trim());
        }
        html.close("li");
    }
    html.raw("</ul>\n</section>\n");
}
