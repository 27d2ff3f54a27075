//! `report.html`: one file that opens from disk, loads nothing and works without scripts.

mod brief;
mod cards;
mod overview;
mod plots;
mod tables;
mod works;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use enfilade_brief::Measure;
use sha2::{Digest, Sha256};

pub use overview::{RoundCard, overview_html};

use super::canvas::shrink_png;
use super::html::Html;
use super::measure::{fixed, number, plain_name, sentence_case, short, wordings};
use super::result::{Candidate, RoundResult, Sense};
use super::works::WorksResult;
use enfilade_cad::drawing::Format;

/// Pictures of a page take at most this many bytes; above it all are halved in size until they fit,
/// so that the page can still be sent by mail.
pub const MAX_PICTURE_BYTES: usize = 18 << 20;
/// Pictures are not reduced below this side, px.
const SMALLEST_PICTURE_PX: u32 = 400;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// One picture of a layout: a measure and its heat map.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// Name of the measure in result.json, or `score`.
    pub measure: &'a str,
    /// The heat map.
    pub png: &'a [u8],
}

/// A layout that was measured on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArchivePoint {
    /// What is plotted, in the order of [`ReportInput::archive_axes`].
    pub values: Vec<f64>,
    /// Which candidate it became, from 0.
    pub candidate: Option<usize>,
    /// Whether no other layout is as good in everything and better in something.
    pub is_front: bool,
}

/// Everything the page shows.
#[derive(Clone, Debug)]
pub struct ReportInput<'a> {
    /// result.json.
    pub result: &'a RoundResult,
    /// Number of the round, from 1.
    pub round: u64,
    /// Pictures of the present layout; their measures are the tabs.
    pub present: Vec<View<'a>>,
    /// Pictures of the candidates, in the order of result.json.
    pub candidates: Vec<Vec<View<'a>>>,
    /// Pictures of the best layout found.
    pub best: Vec<View<'a>>,
    /// All options superimposed.
    pub diversity: Option<&'a [u8]>,
    /// How the search went on.
    pub convergence: Option<&'a [u8]>,
    /// What was understood of the drawing.
    pub understood: Option<&'a [u8]>,
    /// The brief of rooms on the present layout.
    pub brief_picture: Option<&'a [u8]>,
    /// What building works would bring.
    pub works: Option<&'a WorksResult>,
    /// Its picture.
    pub works_picture: Option<&'a [u8]>,
    /// Names of the values of the archive: measures, `score`, penalties.
    pub archive_axes: Vec<String>,
    /// Layouts measured on the way; may be a sample.
    pub archive: Vec<ArchivePoint>,
    /// The command that makes the same again.
    pub command: &'a str,
    /// Name and version of the program.
    pub program: &'a str,
}

/// Writes the report page.
pub fn report_html(input: &ReportInput<'_>) -> String {
    let shrunk = Shrunk::to_fit(input);
    let fitted = shrunk.input(input);
    let mut html = Html::default();
    head(&mut html, &title(input));
    html.raw("<body>\n");
    cards::radios(&mut html, &fitted);
    html.raw("<main>\n");
    header(&mut html, input);
    tables::questions(&mut html, input.result);
    tables::options(&mut html, input.result);
    // Where there is no option, works are what the round has to say.
    let has_options = !input.result.candidates.is_empty();
    if !has_options {
        works::works(&mut html, &fitted);
    }
    cards::stage(&mut html, &fitted);
    cards::grid(&mut html, &fitted);
    works::front(&mut html, input.result);
    if has_options {
        works::works(&mut html, &fitted);
    }
    brief::brief(&mut html, &fitted);
    tables::numbers(&mut html, input.result);
    tables::thresholds(&mut html, input.result);
    tables::moves(&mut html, input.result);
    pictures(&mut html, &fitted);
    plots::search(&mut html, &fitted);
    plots::lineage(&mut html, input.result);
    tables::problems(&mut html, input);
    tables::repeat(&mut html, input);
    glossary(&mut html, input);
    html.raw("</main>\n<footer><p>Made by ").text(input.program);
    html.raw(". This page is one file: it loads nothing and sends nothing.</p></footer>\n<script>");
    html.raw(SCRIPT).raw("</script>\n</body>\n</html>\n");
    html.into_string()
}

/// The content security policy of our pages: nothing but what they carry.
pub fn content_security_policy() -> String {
    let hash = STANDARD.encode(Sha256::digest(SCRIPT.as_bytes()));
    format!(
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{hash}'; \
         base-uri 'none'; form-action 'none'"
    )
}

fn head(html: &mut Html, title: &str) {
    html.raw("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    html.open("meta", &[("http-equiv", "Content-Security-Policy"), ("content", &content_security_policy())]);
    html.raw("\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    html.raw("<meta name=\"color-scheme\" content=\"light dark\">\n");
    html.element("title", &[], title);
    html.raw("<style>\n").raw(STYLE).raw("</style>\n</head>\n");
}

/// File name without folders.
fn file_name(path: &str) -> &str {
    path.rsplit(['/', '\\']).next().unwrap_or(path)
}

/// File name without folders and ending.
fn drawing_name(path: &str) -> &str {
    let file = file_name(path);
    file.rsplit_once('.').map_or(file, |(stem, _)| if stem.is_empty() { file } else { stem })
}

fn title(input: &ReportInput<'_>) -> String {
    format!("{} · round {} · Enfilade", drawing_name(&input.result.input.path), input.round)
}

fn header(html: &mut Html, input: &ReportInput<'_>) {
    let result = input.result;
    html.raw("<header>\n<p class=\"eyebrow\">Enfilade <span>·</span> round ").text(&input.round.to_string());
    html.raw("</p>\n").element("h1", &[], drawing_name(&result.input.path));
    html.open("p", &[("class", "lead")])
        .words(&cards::prose(&lead(result)))
        .words(&best_work(input))
        .close("p");
    html.raw("<dl class=\"facts\">\n");
    let counts = &result.counts;
    let cells = format!(
        "{} cells of {} m, {} of them measured",
        fixed(counts.vertices as f64, 0),
        short(result.spacing_m),
        fixed(counts.query.saturating_sub(counts.covered) as f64, 0)
    );
    // The time it took stands in result.json alone: the page is the same for the same seed.
    let searched = match result.evaluations {
        1 => "1 layout".to_owned(),
        n => format!("{} layouts", fixed(n as f64, 0)),
    };
    let facts = [
        // Its folder may be moved with its rounds: what it is called does not change.
        ("Drawing", file_name(&result.input.path).to_owned()),
        ("Unit", format!("{} ({})", result.input.unit, result.input.unit_reason)),
        ("Measured on", cells),
        ("Walls", fixed(counts.walls as f64, 0)),
        ("Searched", format!("{searched}; {}", result.stopped_by)),
    ];
    let searched = usize::from(result.evaluations == 0);
    for (term, text) in &facts[..facts.len() - searched] {
        html.raw("<div>").element("dt", &[], term).element("dd", &[], text).raw("</div>\n");
    }
    html.raw("</dl>\n</header>\n");
}

/// Where there is no option, the best building work; else nothing.
fn best_work(input: &ReportInput<'_>) -> String {
    let works = input.works.filter(|_| input.result.candidates.is_empty());
    let best = works.and_then(|w| Some((w, *w.different(true, 1).first()?)));
    best.map_or_else(String::new, |(works, work)| {
        format!(" {}: {}. See below.", works.title(work), WorksResult::gain_words(work))
    })
}

/// The outcome in one or two sentences.
fn lead(result: &RoundResult) -> String {
    let Some(best) = result.candidates.first() else {
        if !result.questions.is_empty() {
            return "The present layout was measured. No option was made, because the reading of the drawing is unsure: \
                    answer the questions below."
                .into();
        }
        if !result.moves.is_empty() && result.best.is_some() {
            return format!(
                "No layout gains enough to be an option. The best found is better than the present one: `accept {} best` takes it ({}).",
                file_name(&result.input.path),
                result.stopped_by
            );
        }
        if !result.moves.is_empty() {
            return format!(
                "The present layout was measured; no better layout was found ({}).",
                result.stopped_by
            );
        }
        let said = |code: &str| result.problems.iter().any(|p| p.code == code);
        let words = Format::named(&result.input.format).unwrap_or(Format::Dxf).marking();
        let why = if said("moves-unread") {
            "Nothing moves, because no mark of what may move can be used as it stands: what is wrong with each stands \
             below. Correct them, or take them away and walls move by default."
                .into()
        } else if said("moves-elsewhere") {
            "Nothing moves on this storey, because what may move is said of other storeys alone.".into()
        } else if said("move-kept") {
            format!("Nothing moves, because {} holds what may.", words.kept_region)
        } else {
            format!("Nothing in the drawing may move yet: {}, then save.", words.order)
        };
        return format!("The present layout was measured. {why}");
    };
    if result.problems.iter().any(|p| p.code == "none-better") {
        return "No layout is better than the present one. The best of them is shown.".into();
    }
    let count = result.candidates.len();
    let kept = result.candidates.iter().filter(|c| c.within_threshold).count();
    let gains = gains_of(result, best);
    let is_lowered = result.problems.iter().any(|p| p.code == "thresholds-lowered");
    let lowered = if is_lowered { ", which were lowered so that the options differ" } else { "" };
    let all = match (kept, count) {
        (_, 1) => String::new(),
        (k, n) if k == n => format!(" All of them keep within the thresholds{lowered}."),
        (k, n) => format!(" {k} of {n} keep within the thresholds{lowered}."),
    };
    let options =
        if count == 1 { "One other layout".to_owned() } else { format!("{} other layouts", spelled(count)) };
    let broken: Vec<String> = (1..)
        .zip(&result.candidates)
        .filter(|(_, c)| !c.explanation.breaks.is_empty())
        .map(|(i, _)| i.to_string())
        .collect();
    let broken = match broken.as_slice() {
        [] => String::new(),
        some => format!(
            " {} pinned and kept though {} what is asked for now.",
            if some.len() == 1 {
                format!("Option {} is", some[0])
            } else {
                format!("Options {} are", super::words::listed(some, "and"))
            },
            if some.len() == 1 { "it breaks" } else { "they break" }
        ),
    };
    // What was pinned stands first, whatever it gains; the others follow by what they gain.
    let pinned = result.pinned_count();
    let free = result.candidates.get(pinned);
    let kept = match pinned {
        1 => format!("Option 1 was pinned: {gains}."),
        n => format!("Options 1 to {n} were pinned; the first: {gains}."),
    };
    let gains = match (pinned, free) {
        (0, _) => format!("Option 1 gains most in all: {gains}."),
        (_, None) => kept,
        (n, Some(first)) => format!(
            "{kept} Of those that were not, option {} gains most in all: {}.",
            n + 1,
            gains_of(result, first)
        ),
    };
    format!("{options} for this plan. {gains}{all}{broken}")
}

/// What an option gains: what was confirmed, where something was.
fn gains_of(result: &RoundResult, option: &Candidate) -> String {
    if option.gain.is_empty() {
        super::words::gains(&result.initial.mean, &option.mean)
    } else {
        super::words::confirmed(&result.initial.mean, &option.gain)
    }
}

fn spelled(count: usize) -> String {
    let words = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine", "Ten"];
    words.get(count).map_or_else(|| count.to_string(), |w| (*w).to_owned())
}

/// Whether more of a measure is wanted: by its objective, else by its weight in the score, else by habit;
/// `None` if nobody can say.
pub(super) fn wanted(result: &RoundResult, key: &str) -> Option<Sense> {
    if let Some(objective) = result.objectives.iter().find(|o| o.name == key) {
        return Some(objective.sense);
    }
    match weight(result, key) {
        Some(w) if w > 0.0 => Some(Sense::Max),
        Some(w) if w < 0.0 => Some(Sense::Min),
        _ => usual_sense(super::measure::parts(key).0),
    }
}

/// Whether the options were judged by their score: else it is a number on another scale, of penalties most of all.
fn is_by_score(result: &RoundResult) -> bool {
    result.objectives.iter().any(|o| o.name == "score")
}

/// Weight of a measure in the score, where the settings list one (`score: [[name, weight], …]`).
fn weight(result: &RoundResult, key: &str) -> Option<f64> {
    let weights = result.settings.get("score")?.as_array()?;
    weights.iter().find(|pair| pair[0] == key)?[1].as_f64()
}

/// Whether more of a measure is wanted as a rule.
fn usual_sense(key: &str) -> Option<Sense> {
    match key {
        "mean_depth" | "disconnection" | "overlap" | "clearance_m2" | "alignment" => Some(Sense::Min),
        _ => Measure::by_name(key)?.entry().better,
    }
}

/// Two plans side by side: all options superimposed, and what was understood.
fn pictures(html: &mut Html, input: &Fitted<'_>) {
    let shown = [
        (input.diversity, "How far the options lie apart", "All options drawn over the present layout"),
        (input.understood, "What was understood of the drawing", "Walls, regions and moves as understood"),
    ];
    if shown.iter().all(|(png, ..)| png.is_none()) {
        return;
    }
    html.raw("<section class=\"pair\">\n");
    for (i, (png, heading, alt)) in shown.into_iter().enumerate() {
        let Some(png) = png else { continue };
        html.raw("<figure>\n").element("h2", &[], heading).picture(png, "sheet", alt);
        if i == 0 {
            html.element("figcaption", &[], &distances(input.input.result));
        }
        html.raw("</figure>\n");
    }
    html.raw("</section>\n");
}

fn distances(result: &RoundResult) -> String {
    let (Some(min), Some(mean)) = (result.diversity.min_distance, result.diversity.mean_distance) else {
        return String::new();
    };
    let most = (result.moves.len() as f64).sqrt();
    format!(
        "The two most alike stand {} apart, on average {}; {} would be the most that {} moves allow.",
        number(min),
        number(mean),
        number(most),
        result.moves.len()
    )
}

fn glossary(html: &mut Html, input: &ReportInput<'_>) {
    let result = input.result;
    let mean = result.initial.mean.0.iter().map(|(name, _)| name.as_str());
    let penalty = result.initial.penalty.0.iter().map(|(name, _)| name.as_str());
    let used: Vec<&str> = mean.chain(penalty).chain(input.present.iter().map(|v| v.measure)).collect();
    html.raw("<section>\n<h2>What the words mean</h2>\n<dl class=\"glossary\">\n");
    for w in wordings().filter(|w| used.contains(&w.key)) {
        html.raw("<div><dt>").text(w.plain).raw(" <small>").text(w.technical).raw("</small></dt>");
        html.element("dd", &[], w.meaning).raw("</div>\n");
    }
    html.raw("</dl>\n");
    super::glossary::explained(html);
    html.raw("</section>\n");
}

/// Name of a candidate, from 0.
pub(super) fn option_name(i: usize) -> String {
    format!("Option {}", i + 1)
}

/// Name of a measure with its technical term: `Visibility`, `degree`.
pub(super) fn names(key: &str) -> (String, String) {
    if key.ends_with(super::measure::CHANGE) {
        return (plain_name(key), String::new());
    }
    let technical = super::measure::wording(super::measure::parts(key).0).map_or(key, |w| w.technical);
    let is_same = sentence_case(technical) == plain_name(key);
    let technical = if is_same { String::new() } else { technical.to_owned() };
    (plain_name(key), technical)
}

/// The pictures in the size in which they fit the page.
struct Shrunk {
    present: Vec<Vec<u8>>,
    candidates: Vec<Vec<Vec<u8>>>,
    best: Vec<Vec<u8>>,
    others: [Option<Vec<u8>>; 5],
}

/// The page's input with the pictures to embed.
struct Fitted<'a> {
    input: &'a ReportInput<'a>,
    present: Vec<View<'a>>,
    candidates: Vec<Vec<View<'a>>>,
    best: Vec<View<'a>>,
    diversity: Option<&'a [u8]>,
    convergence: Option<&'a [u8]>,
    understood: Option<&'a [u8]>,
    works: Option<&'a [u8]>,
    brief: Option<&'a [u8]>,
}

impl Fitted<'_> {
    /// The measures that have pictures: of the present layout, then those of changes alone.
    fn tabs(&self) -> Vec<&str> {
        let mut out: Vec<&str> = self.present.iter().map(|v| v.measure).collect();
        for view in self.candidates.iter().flatten() {
            if !out.contains(&view.measure) {
                out.push(view.measure);
            }
        }
        out
    }
}

impl Shrunk {
    /// Halves all pictures until they fit [`MAX_PICTURE_BYTES`]; a picture that cannot be decoded
    /// stays as it is.
    fn to_fit(input: &ReportInput<'_>) -> Self {
        let own = |views: &[View<'_>]| views.iter().map(|v| v.png.to_vec()).collect::<Vec<_>>();
        let mut all = Self {
            present: own(&input.present),
            candidates: input.candidates.iter().map(|c| own(c)).collect(),
            best: own(&input.best),
            others: [
                input.diversity,
                input.convergence,
                input.understood,
                input.works_picture,
                input.brief_picture,
            ]
            .map(|p| p.map(<[u8]>::to_vec)),
        };
        let mut may_shrink = true;
        while may_shrink && all.pictures().map(|p| p.len()).sum::<usize>() > MAX_PICTURE_BYTES {
            may_shrink = false;
            for png in all.pictures() {
                if let Some(smaller) = shrink_png(png, SMALLEST_PICTURE_PX) {
                    *png = smaller;
                    may_shrink = true;
                }
            }
        }
        all
    }

    fn pictures(&mut self) -> impl Iterator<Item = &mut Vec<u8>> {
        self.present
            .iter_mut()
            .chain(self.candidates.iter_mut().flatten())
            .chain(&mut self.best)
            .chain(self.others.iter_mut().flatten())
    }

    fn input<'a>(&'a self, input: &'a ReportInput<'a>) -> Fitted<'a> {
        let views = |views: &'a [View<'a>], pngs: &'a [Vec<u8>]| -> Vec<View<'a>> {
            views.iter().zip(pngs).map(|(v, png)| View { measure: v.measure, png }).collect()
        };
        let [diversity, convergence, understood, works, brief] = self.others.each_ref().map(|p| p.as_deref());
        Fitted {
            input,
            present: views(&input.present, &self.present),
            candidates: input.candidates.iter().zip(&self.candidates).map(|(v, p)| views(v, p)).collect(),
            best: views(&input.best, &self.best),
            diversity,
            convergence,
            understood,
            works,
            brief,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::encode_png;
    use super::super::html::png_size;
    use super::*;

    /// A picture that does not compress.
    fn noise(side: u32) -> Vec<u8> {
        let mut state = 1u32;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let rgb: Vec<u8> = (0..side * side * 3).map(|_| next()).collect();
        encode_png(side, side, &rgb).unwrap()
    }

    #[test]
    fn pictures_too_large_for_a_page_are_halved() {
        let (png, result) = (noise(1600), RoundResult::default());
        let view = View { measure: "degree", png: &png };
        let input = ReportInput {
            result: &result,
            round: 1,
            present: vec![view],
            candidates: vec![vec![view], vec![view]],
            best: Vec::new(),
            diversity: None,
            convergence: None,
            understood: None,
            works: None,
            works_picture: None,
            brief_picture: None,
            archive_axes: Vec::new(),
            archive: Vec::new(),
            command: "",
            program: "",
        };
        assert!(3 * png.len() > MAX_PICTURE_BYTES);
        let mut shrunk = Shrunk::to_fit(&input);
        assert!(shrunk.pictures().all(|p| png_size(p) == Some([800, 800])));
        assert!(shrunk.pictures().map(|p| p.len()).sum::<usize>() <= MAX_PICTURE_BYTES);
        let one = ReportInput { candidates: Vec::new(), ..input };
        assert!(Shrunk::to_fit(&one).pictures().all(|p| *p == png));
    }

    #[test]
    fn a_drawing_is_called_by_its_name() {
        let cases = [("a/b/plan.dxf", "plan"), (r"C:\x\plan.v2.ifc", "plan.v2"), (".dxf", ".dxf"), ("", "")];
        for (path, name) in cases {
            assert_eq!(drawing_name(path), name);
        }
    }
}
