//! The page that lists the rounds of a drawing.

use super::super::html::Html;
use super::super::measure::{number, plain_name};
use super::super::result::Numbers;
use super::cards::{delta, prose};
use super::{drawing_name, head, usual_sense};

/// One round on the overview.
#[derive(Clone, Debug)]
pub struct RoundCard<'a> {
    /// Number, from 1.
    pub round: u64,
    /// Drawing it started from.
    pub drawing: &'a str,
    /// Where its report lies, relative to the overview: `round-01/report.html`.
    pub href: &'a str,
    /// A picture of its drawing.
    pub png: Option<&'a [u8]>,
    /// Means of the layout it started from.
    pub mean: &'a Numbers,
    /// What its first option does.
    pub words: &'a str,
    /// Which option was accepted, from 1.
    pub accepted: Option<u64>,
}

/// Writes the overview: every round with its picture, its measures against the first round, and a link
/// to its report.
pub fn overview_html(drawing: &str, rounds: &[RoundCard<'_>], program: &str) -> String {
    let mut html = Html::default();
    let name = drawing_name(drawing);
    head(&mut html, &format!("{name} · Enfilade"));
    html.raw("<body>\n<main>\n<header>\n<p class=\"eyebrow\">Enfilade</p>\n").element("h1", &[], name);
    let lead = match rounds.len() {
        0 => "No round has been made yet.".to_owned(),
        1 => "One round so far.".to_owned(),
        n => format!("{n} rounds so far, the newest last."),
    };
    html.element("p", &[("class", "lead")], &lead).raw("</header>\n<section class=\"rounds\">\n");
    for round in rounds {
        card(&mut html, round, rounds[0].mean);
    }
    html.raw("</section>\n</main>\n<footer><p>Made by ")
        .text(program)
        .raw("</p></footer>\n</body>\n</html>\n");
    html.into_string()
}

fn card(html: &mut Html, round: &RoundCard<'_>, first: &Numbers) {
    let heading = format!("Round {}", round.round);
    html.raw("<article class=\"card\">\n<h3>").open("a", &[("href", round.href)]).text(&heading);
    html.raw("</a> <small>").text(round.drawing).raw("</small></h3>\n");
    if let Some(png) = round.png {
        html.raw("<div class=\"views\">").picture(
            png,
            "",
            &format!("{heading}: the drawing it started from"),
        );
        html.raw("</div>\n");
    }
    html.raw("<dl class=\"gains\">\n");
    for (key, value) in &round.mean.0 {
        html.raw("<div>").element("dt", &[], &plain_name(key)).raw("<dd>").text(&number(*value)).raw(" ");
        if let Some(from) = first.get(key).filter(|_| round.round > 1) {
            delta(html, from, *value, usual_sense(key));
        }
        html.raw("</dd></div>\n");
    }
    html.raw("</dl>\n").element("p", &[("class", "words")], &prose(round.words));
    if let Some(n) = round.accepted {
        html.element("p", &[("class", "badge met")], &format!("✓ option {n} was accepted"));
    }
    html.raw("</article>\n");
}
