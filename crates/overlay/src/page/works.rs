//! What building works would bring: the list that every round has, with its picture.

use super::super::built::SHOWS_PRIVATE;
use super::super::html::Html;
use super::super::measure::{plain_name, trimmed};
use super::super::options::told_measures;
use super::super::result::RoundResult;
use super::super::works::{WorkEntry, WorksResult};
use super::cards::change;
use super::{Fitted, wanted};

/// Works that are listed, allowed and forbidden.
const SHOWN: [usize; 2] = [5, 3];

/// The list, with its picture where one is drawn; nothing where no work was measured.
pub(super) fn works(html: &mut Html, input: &Fitted<'_>) {
    let Some(works) = input.input.works else { return };
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
    html.element("p", &[], &works.proof()).raw("\n</div>\n");
    if let Some(png) = input.works {
        html.raw("<figure>\n").picture(png, "sheet", "Each wall in the colour of the best opening in it");
        let caption = "Each wall in the colour of the best opening in it; grey: not allowed.";
        html.element("figcaption", &[], caption).raw("</figure>\n");
    }
    html.raw("</div>\n</section>\n");
}

/// What works together bring for what they cost: a row a point.
pub(super) fn front(html: &mut Html, result: &RoundResult) {
    if result.front.len() < 2 {
        return;
    }
    let keys = told_measures(result);
    html.raw("<section>\n<h2>What more works bring</h2>\n<p class=\"note\">");
    html.text("From the cheapest works to those that show most: of all that were counted, none brings as much for less wall. ");
    html.words(&format!("To take one: `enfilade accept {} --point NUMBER`.", result.input.argument()));
    html.raw("</p>\n<div class=\"scroll\"><table class=\"options\">\n<thead><tr>");
    for heading in ["Point".into(), "Works".into()].into_iter().chain(keys.iter().map(|k| plain_name(k))) {
        html.element("th", &[("scope", "col")], &heading);
    }
    html.element("th", &[("scope", "col")], "Wall").raw("</tr></thead>\n<tbody>\n");
    for point in &result.front {
        html.raw("<tr>").element("th", &[("scope", "row")], &point.point.to_string());
        let option = point.option.map_or_else(String::new, |n| format!(" (option {n})"));
        let private = if point.shows_private { format!(". {SHOWS_PRIVATE}") } else { String::new() };
        html.element("td", &[], &format!("{}{option}{private}", point.words));
        for key in &keys {
            html.raw("<td>");
            if let (Some(from), Some(now)) = (result.initial.mean.get(key), point.mean.get(key)) {
                change(html, (from, now), &point.gain, (key, wanted(result, key)));
            }
            html.raw("</td>");
        }
        html.raw("<td>").text(&trimmed(point.effort.length_m(), 1)).raw("\u{a0}m</td></tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n</section>\n");
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
