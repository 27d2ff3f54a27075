//! Settings of the daemon: the `[watch]` table.

use serde::{Deserialize, Serialize};

use super::bad;
use enfilade_report::Error;

/// Range of the daemon's waits, seconds.
pub const WAIT_SECS: [f64; 2] = [0.0, 1e6];
/// Range of the time between two looks at everything, seconds: more often the disk would never rest.
pub const LOOK_SECS: [f64; 2] = [0.1, 1e6];
/// Range of the time a job may take, seconds.
pub const JOB_SECS: [f64; 2] = [1.0, 1e6];
/// Most jobs at the same time.
pub const JOBS_MAX: usize = 64;
/// Least memory of a job, MB: with less not even the program starts.
pub const JOB_MEMORY_MIN_MB: u64 = 32;
/// Most levels of folders below a root.
pub const DEPTH_MAX: usize = 64;

/// Settings of the daemon.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
#[allow(missing_docs)] // see `enfilade init`
pub struct WatchTable {
    pub quiet_secs: Option<f64>,
    pub network_quiet_secs: Option<f64>,
    pub grace_secs: Option<f64>,
    pub max_wait_secs: Option<f64>,
    pub rescan_secs: Option<f64>,
    pub poll_secs: Option<f64>,
    pub poll: Option<bool>,
    pub depth: Option<usize>,
    pub ignore: Option<Vec<String>>,
    pub newest_first: Option<bool>,
    /// Results go below this folder where the place beside the drawing cannot be written.
    pub fallback: Option<String>,
    pub jobs: Option<usize>,
    pub memory_mb: Option<u64>,
    pub read_limit_secs: Option<f64>,
    pub job_limit_secs: Option<f64>,
    pub job_memory_mb: Option<u64>,
}

impl WatchTable {
    /// Whether every number is in its range.
    ///
    /// # Errors
    /// [`Error::Usage`] names the key, what was found and what is expected.
    pub fn check(&self) -> Result<(), Error> {
        let secs = [
            ("quiet-secs", self.quiet_secs, WAIT_SECS),
            ("network-quiet-secs", self.network_quiet_secs, WAIT_SECS),
            ("grace-secs", self.grace_secs, WAIT_SECS),
            ("max-wait-secs", self.max_wait_secs, WAIT_SECS),
            ("rescan-secs", self.rescan_secs, LOOK_SECS),
            ("poll-secs", self.poll_secs, LOOK_SECS),
            ("read-limit-secs", self.read_limit_secs, JOB_SECS),
            ("job-limit-secs", self.job_limit_secs, JOB_SECS),
        ];
        for (key, found, [lo, hi]) in secs {
            if let Some(v) = found.filter(|v| !(lo..=hi).contains(v)) {
                return Err(bad(key, &v.to_string(), &format!("seconds from {lo} to {hi}")));
            }
        }
        if let Some(v) = self.depth.filter(|v| *v > DEPTH_MAX) {
            return Err(bad("depth", &v.to_string(), &format!("levels from 0 to {DEPTH_MAX}")));
        }
        if let Some(v) = self.jobs.filter(|v| !(1..=JOBS_MAX).contains(v)) {
            return Err(bad("jobs", &v.to_string(), &format!("jobs at once, from 1 to {JOBS_MAX}")));
        }
        for (key, found) in [("memory-mb", self.memory_mb), ("job-memory-mb", self.job_memory_mb)] {
            if let Some(v) = found.filter(|v| *v < JOB_MEMORY_MIN_MB) {
                return Err(bad(key, &v.to_string(), &format!("{JOB_MEMORY_MIN_MB} or more")));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Partial;

    fn said(key: &str, value: &str) -> Option<String> {
        let text = format!("[watch]\n{key} = {value}\n");
        Partial::from_toml("enfilade.toml", &text).err().map(|e| e.to_string())
    }

    fn is_refused(key: &str, value: &str) {
        let said = said(key, value).unwrap_or_default();
        assert!(
            said.starts_with("enfilade.toml:2: ") && said.contains("expected"),
            "{key} = {value}: {said}"
        );
    }

    #[test]
    fn numbers_out_of_their_ranges_are_named_with_their_line() {
        for (key, [lo, hi]) in [
            ("quiet-secs", WAIT_SECS),
            ("network-quiet-secs", WAIT_SECS),
            ("grace-secs", WAIT_SECS),
            ("max-wait-secs", WAIT_SECS),
            ("rescan-secs", LOOK_SECS),
            ("poll-secs", LOOK_SECS),
            ("read-limit-secs", JOB_SECS),
            ("job-limit-secs", JOB_SECS),
        ] {
            let wrong = [lo - 0.01, hi + 1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
            wrong.into_iter().for_each(|v| is_refused(key, &format!("{v:?}").to_lowercase()));
            [lo, hi].into_iter().for_each(|v| assert_eq!(said(key, &format!("{v:?}")), None, "{key} = {v}"));
        }
        is_refused("depth", &(DEPTH_MAX + 1).to_string());
        is_refused("jobs", "0");
        is_refused("jobs", &(JOBS_MAX + 1).to_string());
        is_refused("memory-mb", &(JOB_MEMORY_MIN_MB - 1).to_string());
        is_refused("job-memory-mb", &(JOB_MEMORY_MIN_MB - 1).to_string());
        assert_eq!(said("depth", &DEPTH_MAX.to_string()), None);
        assert_eq!(said("job-memory-mb", &JOB_MEMORY_MIN_MB.to_string()), None);
    }
}
