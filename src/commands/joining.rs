//! `join`: one long search on many machines. `jobs --seeds` lists the searches, `run-job` does each, and what they found
//! together begins one more.

use super::listing::{TRY_AGAIN, hand_lines, jobs_in, numbers};
use crate::batch::Job;
use crate::cli::JoinArgs;
use enfilade_report::{Error, Place, complain, counted};

/// Searches of one drawing, storey and settings, with what each found.
struct Joined {
    search_id: String,
    first: Job,
    found: Vec<Vec<Vec<f64>>>,
}

pub(super) fn join(args: &JoinArgs) -> Result<u8, Error> {
    let list = jobs_in(&args.list, args.results.as_deref(), "jobs-list")?;
    if let Some(part) = list.iter().find(|l| l.job.part.is_some()) {
        let text =
            format!("line {}: is a part of an analysis, which `merge` joins; nothing was joined", part.line);
        return Err(Error::input("jobs-list", Place::file(args.list.to_string_lossy()), text));
    }
    let (mut all, mut missing): (Vec<Joined>, Vec<(usize, &str)>) = Default::default();
    for listed in &list {
        let Some(options) = listed.job.options_found() else {
            missing.push((listed.line, &listed.text));
            continue;
        };
        let search_id = listed.job.search_id();
        match all.iter_mut().find(|j| j.search_id == search_id) {
            Some(joined) => joined.found.push(options),
            None => all.push(Joined { search_id, first: listed.job.clone(), found: vec![options] }),
        }
    }
    if let Some(to) = &args.missing {
        let lines: String = missing.iter().map(|(_, text)| format!("{text}\n")).collect();
        hand_lines(Some(to), &lines, None)?;
    }
    if !missing.is_empty() {
        let lines: Vec<u32> = missing.iter().map(|(line, _)| *line as u32).collect();
        complain(format_args!(
            "error: {} of {} not done, or damaged: do {} {} of the list with `run-job` (--missing writes them); nothing was \
             joined",
            counted(missing.len() as u64, "search"),
            list.len(),
            if lines.len() == 1 { "line" } else { "lines" },
            numbers(&lines)
        ));
        return Ok(TRY_AGAIN);
    }
    if let Some(empty) = all.iter().find(|j| j.found.iter().all(Vec::is_empty)) {
        let text = "none of these searches found an option, and none would begin with more than they knew; nothing was joined";
        return Err(Error::input("jobs-list", Place::file(empty.first.name()), text));
    }
    let mut lines = String::new();
    for joined in &all {
        lines.push_str(&joined.first.joined(&joined.found).to_line()?);
        lines.push('\n');
    }
    hand_lines(args.output.as_deref(), &lines, (!args.quiet).then_some("job"))?;
    Ok(0)
}
