//! The drawings: a stage with a before/after slider, and all layouts side by side.

use super::super::html::Html;
use super::super::measure::{CHANGE, number, parts, percent_change, plain_name, wording};
use super::super::result::{Candidate, Gains, Numbers, Sense};
use super::super::words::{gain_words, listed};
use super::{Fitted, View, is_by_score, names, option_name, wanted};

/// The switches of the page: which measure is shown, which option is compared. They stand before
/// everything they switch, so that style rules alone can react; their labels stand where they are used.
pub fn radios(html: &mut Html, input: &Fitted<'_>) {
    let tabs = input.tabs();
    for (m, measure) in tabs.iter().enumerate() {
        radio(html, "measure", m, &format!("Show {}", plain_name(measure)));
    }
    if has_stage(input) {
        for o in 0..input.candidates.len() {
            radio(html, "option", o, &format!("Compare option {}", o + 1));
        }
    }
    html.raw("<style>\n");
    for m in 0..tabs.len() {
        let m = m.to_string();
        html.raw("#measure").text(&m).raw(":checked~main .v:not(.v").text(&m).raw("){display:none}\n");
    }
    for group in ["measure", "option"] {
        let count = if group == "measure" { tabs.len() } else { input.candidates.len() };
        for i in 0..count {
            let id = format!("{group}{i}");
            html.raw("#").text(&id).raw(":checked~main .for-").text(&id);
            html.raw("{color:var(--ink);border-color:var(--accent)}\n");
            html.raw("#").text(&id).raw(":focus-visible~main .for-").text(&id);
            html.raw("{outline:2px solid var(--accent);outline-offset:3px}\n");
        }
    }
    html.raw("</style>\n");
}

fn radio(html: &mut Html, group: &'static str, i: usize, label: &str) {
    let (id, value) = (format!("{group}{i}"), i.to_string());
    let first = [("checked", "")];
    let base = [
        ("type", "radio"),
        ("class", "switch"),
        ("name", group),
        ("id", &id),
        ("value", &value),
        ("aria-label", label),
    ];
    let mut attributes = base.to_vec();
    if i == 0 {
        attributes.extend(first);
    }
    html.open("input", &attributes).raw("\n");
}

fn tabs(html: &mut Html, input: &Fitted<'_>) {
    html.raw("<div class=\"tabs\">\n");
    for (m, measure) in input.tabs().into_iter().enumerate() {
        let (plain, technical) = names(measure);
        let id = format!("measure{m}");
        html.open("label", &[("for", &id), ("class", &format!("for-{id}"))]).text(&plain);
        if !technical.is_empty() {
            html.raw(" <small>").text(&technical).raw("</small>");
        }
        html.raw("</label>\n");
    }
    html.raw("</div>\n");
}

fn has_stage(input: &Fitted<'_>) -> bool {
    !input.present.is_empty() && !input.candidates.is_empty()
}

/// The large comparison; the script fills it from the cards, without script it is not shown.
pub fn stage(html: &mut Html, input: &Fitted<'_>) {
    if !has_stage(input) {
        return;
    }
    html.raw("<section class=\"compare\" aria-label=\"Before and after\">\n");
    tabs(html, input);
    html.raw(
        "<p class=\"sides\"><span>Present layout</span><span class=\"right\">Option 1</span></p>\n\
         <div class=\"stage\"><img class=\"before\" alt=\"\"><img class=\"after\" alt=\"\">\
         <span class=\"cut\" aria-hidden=\"true\"></span>\
         <input type=\"range\" min=\"0\" max=\"100\" value=\"50\" step=\"0.5\" \
         aria-label=\"Before and after: left is the present layout, right the option\"></div>\n\
         <div class=\"choices\">\n",
    );
    for o in 0..input.candidates.len() {
        let id = format!("option{o}");
        html.element("label", &[("for", &id), ("class", &format!("for-{id}"))], &option_name(o));
    }
    html.raw("</div>\n<p class=\"caption\" aria-live=\"polite\"></p>\n</section>\n");
}

/// All layouts side by side, the present one first.
pub fn grid(html: &mut Html, input: &Fitted<'_>) {
    let is_alone = input.input.result.candidates.is_empty();
    let heading = if is_alone { "The present layout" } else { "Side by side" };
    html.raw("<section>\n").element("h2", &[], heading);
    tabs(html, input);
    html.open("div", &[("class", if is_alone { "grid alone" } else { "grid" })]).raw("\n");
    let result = input.input.result;
    let tabs = input.tabs();
    open_card(html, "present", "Present layout", &tabs, &input.present);
    html.raw("<p class=\"words\">As drawn.</p>\n");
    measures(html, input, None);
    html.raw("</article>\n");
    if let Some(best) = &result.best {
        let builds = result.candidates.iter().any(|c| !c.works.is_empty());
        let name = if builds { "Best layout that only moves" } else { "Best layout found" };
        open_card(html, "best", name, &tabs, &input.best);
        details(html, &prose(&best.words));
        measures(html, input, Some((&best.mean, &best.gain)));
        html.open("p", &[("class", "note")]);
        html.element("a", &[("href", &best.file)], &best.file).close("p");
        html.raw("</article>\n");
    }
    for (o, candidate) in result.candidates.iter().enumerate() {
        let views = input.candidates.get(o).map_or(&[][..], |v| v);
        open_card(html, &o.to_string(), &option_name(o), &tabs, views);
        details(html, &prose(&candidate.words));
        measures(html, input, Some((&candidate.mean, &candidate.gain)));
        if let Some(score) = candidate.score.filter(|_| is_by_score(result)) {
            html.raw("<p class=\"note\">Score ").text(&number(score)).raw("</p>\n");
        }
        if o < result.pinned_count() {
            html.raw("<p class=\"badge\">pinned</p>\n");
        }
        badge(html, candidate);
        html.open("p", &[("class", "note")]);
        html.element("a", &[("href", &candidate.file)], &candidate.file).close("p");
        html.raw("</article>\n");
    }
    html.raw("</div>\n</section>\n");
}

/// What changes and why that is better, folded.
fn details(html: &mut Html, words: &str) {
    html.raw("<details><summary>What changes, and why it is better</summary>");
    html.element("p", &[("class", "words")], words).raw("</details>\n");
}

/// Opens the card of a layout with one picture a tab; a measure without a picture has an empty one.
fn open_card(html: &mut Html, layout: &str, name: &str, tabs: &[&str], views: &[View<'_>]) {
    let id = format!("card-{layout}");
    html.open("article", &[("class", "card"), ("id", &id), ("data-layout", layout)]);
    html.element("h3", &[], name).raw("<div class=\"views\">\n");
    for (m, tab) in tabs.iter().enumerate() {
        let class = format!("v v{m}");
        let (plain, technical) = names(tab);
        match views.iter().find(|v| v.measure == *tab) {
            Some(view) => {
                let alt = format!("{name}: heat map of {} ({technical}) over the plan", plain.to_lowercase());
                html.picture(view.png, &class, &alt);
            }
            None => {
                let why = if tab.ends_with(CHANGE) {
                    "as drawn: nothing changes"
                } else {
                    "no picture of this measure"
                };
                html.element("p", &[("class", &format!("{class} missing"))], why);
            }
        }
    }
    html.raw("</div>\n");
}

/// Words for a page: a number is not parted from its per cent sign at the end of a line.
pub fn prose(words: &str) -> String {
    words.replace(" %", "\u{a0}%")
}

/// The measures that have pictures, with their change over the present layout: what was confirmed, where something was.
fn measures(html: &mut Html, input: &Fitted<'_>, layout: Option<(&Numbers, &Gains)>) {
    let result = input.input.result;
    html.raw("<dl class=\"gains\">\n");
    for view in &input.present {
        let key = view.measure;
        let Some(from) = result.initial.mean.get(key) else { continue };
        let Some(now) = layout.map_or(Some(from), |(mean, _)| mean.get(key)) else { continue };
        html.raw("<div>").element("dt", &[], &plain_name(key)).raw("<dd>");
        html.text(&number(result.told(key, now)));
        let unit = wording(parts(key).0).map_or("", |w| w.bare_unit());
        html.text(if unit.is_empty() { "" } else { "\u{a0}" }).text(unit);
        if let Some((_, gains)) = layout {
            html.raw(" ");
            change(html, (from, now), gains, (key, wanted(result, key)));
        }
        html.raw("</dd></div>\n");
    }
    html.raw("</dl>\n");
}

/// The confirmed change of a measure, coloured only where it is sure; where others were confirmed and this one was not, the
/// change that was measured, in no colour; where nothing was confirmed, as [`delta`].
pub fn change(html: &mut Html, (from, to): (f64, f64), gains: &Gains, (key, sense): (&str, Option<Sense>)) {
    match gains.get(key) {
        Some(gain) => {
            let class = match (gain.low > 0.0, gain.high < 0.0) {
                (true, _) => "delta good",
                (_, true) => "delta bad",
                _ => "delta",
            };
            html.open("span", &[("class", class)]).text(&prose(&gain_words(key, gain))).raw("</span>");
        }
        None if gains.is_empty() => delta(html, from, to, sense),
        None => delta(html, from, to, None),
    }
}

/// A change with its sign, told apart by colour, arrow and word whether it is wanted.
pub fn delta(html: &mut Html, from: f64, to: f64, sense: Option<Sense>) {
    let text = percent_change(from, to).unwrap_or_else(|| match number(to - from).as_str() {
        "0" => "±0".to_owned(),
        less if less.starts_with('−') => less.to_owned(),
        more => format!("+{more}"),
    });
    let better = match sense {
        _ if text.starts_with('±') => None,
        Some(Sense::Max) => Some(to > from),
        Some(Sense::Min) => Some(to < from),
        None => None,
    };
    let class = match better {
        Some(true) => "delta good",
        Some(false) => "delta bad",
        None => "delta",
    };
    html.open("span", &[("class", class)]).text(&text);
    match better {
        Some(true) => html.raw("<span class=\"sr\"> better</span>"),
        Some(false) => html.raw("<span class=\"sr\"> worse</span>"),
        None => html,
    };
    html.raw("</span>");
}

fn badge(html: &mut Html, candidate: &Candidate) {
    let breaks = &candidate.explanation.breaks;
    if !breaks.is_empty() {
        // Pinned: what it breaks says more than a threshold, which it may well keep.
        html.element("p", &[("class", "badge missed")], &format!("✗ breaks {}", listed(breaks, "and")));
    } else if candidate.within_threshold {
        html.raw("<p class=\"badge met\">✓ within the thresholds</p>\n");
    } else {
        html.raw("<p class=\"badge missed\">✗ misses a threshold</p>\n");
    }
}
