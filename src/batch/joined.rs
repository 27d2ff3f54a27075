//! The searches of one drawing, joined: one more job, which begins with what they found.

use super::{Job, RESULT};
use crate::store::{led_to, read_own};
use enfilade_config::Partial;
use enfilade_overlay::result::RoundResult;

/// Layouts that a joined search begins with, at most: the first options of all searches before the second ones. They are the
/// first that it measures, and on large plans it measures 130 in all: most of them are to be new.
const KNOWN_MAX: usize = 32;

impl Job {
    /// What two searches have in common that can be joined: all but the seed, and what was known before.
    pub fn search_id(&self) -> String {
        Self { settings: without_seed(&self.settings), part: None, ..self.clone() }.id_of()
    }

    /// The parameters of the options that this job found, the best first; none while it is not done.
    pub fn options_found(&self) -> Option<Vec<Vec<f64>>> {
        let folder = led_to(&self.out).join(&self.id).join(RESULT);
        self.finished_in(&folder)?;
        let result: RoundResult =
            serde_json::from_slice(&read_own(&folder.join("result.json")).ok()?).ok()?;
        Some(result.candidates.into_iter().map(|c| c.parameters).collect())
    }

    /// The job that begins with what some searches found; with the seed of this one.
    pub fn joined(&self, found: &[Vec<Vec<f64>>]) -> Self {
        let most = found.iter().map(Vec::len).max().unwrap_or(0);
        let half = self.settings.evaluations.map_or(KNOWN_MAX as u64, |all| all / 2);
        let room = KNOWN_MAX.min(usize::try_from(half).unwrap_or(KNOWN_MAX));
        let mut known: Vec<Vec<f64>> = Vec::new();
        for layout in (0..most).flat_map(|rank| found.iter().filter_map(move |options| options.get(rank))) {
            if known.len() < room && !known.contains(layout) {
                known.push(layout.clone());
            }
        }
        let settings =
            Partial { seed: self.settings.seed, warm: Some(known), ..without_seed(&self.settings) };
        let mut job = Self { settings, ..self.clone() };
        job.id = job.id_of();
        job
    }
}

fn without_seed(settings: &Partial) -> Partial {
    Partial { seed: None, warm: None, warm_moves: Vec::new(), ..settings.clone() }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn the_first_options_of_all_searches_come_first_and_each_once() {
        let job = |seed: u64, members: usize| {
            let settings = Partial { seed: Some(seed), members: Some(members), ..Partial::default() };
            Job::new(Path::new("plan.dxf"), b"abc", settings, Path::new("out"), false).unwrap()
        };
        assert_eq!(job(1, 5).search_id(), job(2, 5).search_id());
        assert_ne!(job(1, 5).search_id(), job(1, 4).search_id());
        let of = |all: &[f64]| all.iter().map(|v| vec![*v]).collect::<Vec<_>>();
        let joined = job(3, 5).joined(&[of(&[1.0, 2.0, 3.0]), of(&[]), of(&[2.0, 4.0])]);
        assert_eq!(joined.settings.warm, Some(of(&[1.0, 2.0, 4.0, 3.0])));
        assert_eq!(joined.settings.seed, Some(3));
        assert_eq!(joined.search_id(), job(1, 5).search_id());
        assert_eq!(Job::from_json(&joined.to_line().unwrap()).unwrap(), joined);
        let many = (0..100).map(|i| of(&[f64::from(i)])).collect::<Vec<_>>();
        assert_eq!(job(3, 5).joined(&many).settings.warm.map(|w| w.len()), Some(KNOWN_MAX));
        let mut few = job(3, 5);
        few.settings.evaluations = Some(10);
        assert_eq!(few.joined(&many).settings.warm.map(|w| w.len()), Some(5));
    }
}
