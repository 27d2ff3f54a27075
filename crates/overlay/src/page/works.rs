//! What building works would bring: the list that every round has, with its picture.

use super::super::html::Html;
use super::super::works::{WorkEntry, WorksResult};
use super::Fitted;

/// Works that are listed, allowed and forbidden.
const SHOWN: [usize; 2] = [5, 3];

/// The list and its picture; nothing where no work was measured.
pub(super) fn works(html: &mut Html, input: &Fitted<'_>) {
    let (Some(works), Some(png)) = (input.input.works, input.works) else { return };
    html.raw("<section>\n<h2>What one building work would bring</h2>\n<div class=\"pair\">\n<div>\n");
    let [allowed, forbidden] = [true, false].map(|is| works.different(is, SHOWN[usize::from(!is)]));
    if !allowed.is_empty() {
        list(html, works, &allowed, "ol");
        let how = format!("To have one drawn: `{}`.", works.making("NUMBER"));
        html.raw("<p>").words(&how).raw("</p>\n");
    }
    if !forbidden.is_empty() {
        html.raw("<h3>What the rules hold back</h3>\n");
        list(html, works, &forbidden, "ul");
    }
    html.element("p", &[], &works.proof()).raw("\n</div>\n<figure>\n");
    html.picture(png, "sheet", "Each wall in the colour of the best opening in it");
    html.element("figcaption", &[], "Each wall in the colour of the best opening in it; grey: not allowed.");
    html.raw("</figure>\n</div>\n</section>\n");
}

fn list(html: &mut Html, works: &WorksResult, of: &[&WorkEntry], tag: &'static str) {
    html.raw("<").raw(tag).raw(">\n");
    for work in of {
        // By the number under which it is made, which is that of the whole list.
        let id = work.id.to_string();
        html.open("li", &[("value", id.as_str())][..usize::from(tag == "ol")]);
        html.words(&format!("{}.", works.line(work))).close("li");
    }
    html.raw("</").raw(tag).raw(">\n");
}
