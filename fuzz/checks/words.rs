//! Any bytes as what stands beside drawings: settings, a job of a batch, a result. No panic, and what was understood
//! is understood the same way when it is written again.

use enfilade::batch::{Job, seeds};
use enfilade_config::{Partial, Settings};
use enfilade_overlay::result::{RoundResult, to_json};

/// Panics where the bytes show a fault; whether they could be read.
pub fn check(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let _ = seeds(&text);
    let settings = Partial::from_toml("fuzz.toml", &text).map(|partial| {
        let _ = Settings::new(partial.clone().over(Partial::default()));
        let json = serde_json::to_value(&partial).ok();
        let again: Option<Partial> = json.clone().and_then(|j| serde_json::from_value(j).ok());
        assert_eq!(again.and_then(|p| serde_json::to_value(p).ok()), json, "settings for a job's process");
    });
    let as_words = Partial { objective: Some(text.to_string()), ..Partial::default() };
    let words = Settings::new(as_words).map(|s| {
        let again = Partial { objective: Some(s.objective_text()), ..Partial::default() };
        assert!(Settings::new(again).is_ok_and(|a| a.objective_text() == s.objective_text()));
    });
    let rules = [
        Partial { score: Some(text.to_string()), ..Partial::default() },
        Partial { penalty: Some(text.to_string()), ..Partial::default() },
        Partial { limit: Some(text.to_string()), ..Partial::default() },
    ];
    let rules = rules.map(|p| Settings::new(p).is_ok());
    let job = Job::from_json(&text).map(|job| {
        let line = job.to_line().unwrap_or_else(|e| panic!("a job that was read cannot be written: {e}"));
        assert!(Job::from_json(&line).is_ok_and(|again| again.name() == job.name()));
    });
    let result = serde_json::from_str::<RoundResult>(&text).map(|r| assert!(to_json(&r).is_ok()));
    settings.is_ok() || words.is_ok() || job.is_ok() || result.is_ok() || rules.contains(&true)
}
