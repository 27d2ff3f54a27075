//! The brief of rooms, checked for the present layout.

use super::super::brief_item::{BriefItem, sign};
use super::super::html::Html;
use super::super::result::RoundResult;
use super::{Fitted, option_name};

/// A tick or a cross for every item in every layout.
fn table(html: &mut Html, result: &RoundResult) {
    let options = result.candidates.iter().enumerate().map(|(i, c)| (option_name(i), &c.brief));
    let layouts: Vec<(String, &Vec<BriefItem>)> = std::iter::once(("Now".to_owned(), &result.brief))
        .chain(options)
        .filter(|(_, items)| !items.is_empty())
        .collect();
    html.raw("<div class=\"scroll\"><table class=\"options\">\n<thead><tr>");
    for heading in std::iter::once("Asked").chain(layouts.iter().map(|l| l.0.as_str())) {
        html.element("th", &[("scope", "col")], heading);
    }
    html.raw("</tr></thead>\n<tbody>\n");
    for item in &result.brief {
        html.raw("<tr>").element("th", &[("scope", "row")], &item.ask);
        for (_, items) in &layouts {
            let own = items.iter().find(|i| i.id == item.id);
            html.element("td", &[], own.map_or("", |i| sign(&i.verdict)));
        }
        html.raw("</tr>\n");
    }
    html.raw("</tbody>\n</table></div>\n");
}

/// Every item with its places, on the plan where pictures are drawn; nothing where nothing was asked.
pub(super) fn brief(html: &mut Html, input: &Fitted<'_>) {
    let result = input.input.result;
    if result.brief.is_empty() {
        return;
    }
    html.raw("<section>\n<h2>The brief of rooms</h2>\n");
    table(html, result);
    html.raw("<h3>The present layout, place by place</h3>\n<ul>\n");
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
    html.raw("</ul>\n");
    if let Some(png) = input.brief {
        html.raw("<figure>\n").picture(png, "sheet", "Each place of the brief in the colour of its verdict");
        let caption = "Green: holds. Orange: cannot be told from a plan. Red: does not hold. In the drawing each item has a layer, EF-BRIEF-1 and so on.";
        html.element("figcaption", &[], caption).raw("</figure>\n");
    }
    html.raw("</section>\n");
}
