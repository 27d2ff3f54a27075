//! The report page and result.json.

use enfilade_overlay::result::{RoundResult, to_json};
use enfilade_overlay::{RoundCard, overview_html, report_html};

use super::plans::look;
use super::sample;

#[test]
fn the_page_carries_everything_and_loads_nothing() {
    let sample = sample::Sample::new();
    let page = report_html(&sample.input());
    look("report.html", page.as_bytes());
    look("result.json", to_json(&sample.result).unwrap().as_bytes());
    assert!(!page.contains("<img src=x"), "a layer name became markup");
    assert!(page.contains("&lt;img src=x onerror=alert(1)&gt;"));
    assert!(page.contains("Zero in every layout: cut-off space."));
    assert!(page.contains("900 cells of 1.33 m, 892 of them measured"), "eight stand under walls");
    for loads in ["http://", "https://", "url(", "<link", "@import", "src=\"//"] {
        assert!(!page.contains(loads), "the page loads something: {loads}");
    }
    assert_eq!(page.matches("<img class=\"v ").count(), 18);
    assert_eq!(page.matches("alt=\"\"").count(), 2, "only the stage waits for its pictures");
    assert!(page.contains(&sample.input().command.replace('"', "&quot;")));
    let dots = page.matches("<circle class=\"dot\"").count();
    assert_eq!(dots, 3 * 500, "a larger archive is thinned, in each of three pictures");
    assert_eq!(page, report_html(&sample.input()));
    assert!(!page.contains("Büro/"), "a round says where its drawing lay, which may be moved");
}

#[test]
fn a_result_reads_back_as_it_was_written() {
    let sample = sample::Sample::new();
    let text = to_json(&sample.result).unwrap();
    let back: RoundResult = serde_json::from_str(&text).unwrap();
    assert_eq!(back, sample.result);
    assert_eq!(to_json(&back).unwrap(), text);
}

#[test]
fn a_plan_without_moves_still_has_a_page() {
    let sample = sample::Sample::new();
    let mut result = sample.result.clone();
    result.moves.clear();
    result.candidates.clear();
    result.objectives.clear();
    result.lineage.clear();
    result.evaluations = 0;
    let mut input = sample.input();
    input.result = &result;
    input.candidates.clear();
    input.archive.clear();
    (input.diversity, input.convergence) = (None, None);
    let page = report_html(&input);
    look("report-no-moves.html", page.as_bytes());
    assert!(page.contains("EF-MOVE") && !page.contains("class=\"stage\""));
}

#[test]
fn the_overview_links_to_every_round() {
    let sample = sample::Sample::new();
    let input = sample.input();
    let card = |round: u64, href, accepted| RoundCard {
        round,
        drawing: sample::HOSTILE,
        href,
        png: Some(input.present[0].png),
        mean: if round == 1 { &sample.result.lineage[0].mean } else { &sample.result.initial.mean },
        words: &sample.result.candidates[0].words,
        accepted,
    };
    let rounds = [card(1, "round-01/report.html", Some(3)), card(2, "round-02/report.html", None)];
    let page = overview_html("Büro/hôtel-particulier.dxf", &rounds, "Enfilade 0.1.0");
    look("overview.html", page.as_bytes());
    assert!(page.contains("href=\"round-01/report.html\"") && page.contains("option 3 was accepted"));
    assert!(!page.contains("<img src=x"));
}

#[test]
fn a_long_table_of_moves_is_folded() {
    let sample = sample::Sample::new();
    let mut result = sample.result.clone();
    let page = |result: &RoundResult| {
        let mut input = sample.input();
        input.result = result;
        report_html(&input)
    };
    assert!(!page(&result).contains("<summary>7 moves"));
    result.moves = result.moves.iter().cycle().take(31).cloned().collect();
    assert!(page(&result).contains("<summary>31 moves"));
}

#[test]
fn a_missing_picture_leaves_the_others_under_their_tabs() {
    let sample = sample::Sample::new();
    let mut input = sample.input();
    let last = input.candidates[1].remove(0);
    assert_eq!(last.measure, "degree");
    let page = report_html(&input);
    assert_eq!(page.matches("<p class=\"v v0 missing\">").count(), 1);
    let second = page.split("data-layout=\"1\"").nth(1).unwrap();
    let alt = "class=\"v v1\" alt=\"Option 2: heat map of most steps";
    assert!(second.split("</article>").next().unwrap().contains(alt));
}
