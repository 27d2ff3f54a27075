//! The daemon's overview, `enfilade.daemon/1`: what it watches, and what of one root it works on, waits for, and what failed.

use super::*;

impl Heart {
    pub(super) fn overview(&self, root: &Root, is_leaving: bool) -> Value {
        let name = |p: &Path| p.display().to_string();
        let is_own = |p: &Path| p.starts_with(&root.path);
        let running: Vec<String> =
            self.running.iter().map(|r| &*r.what.drawing).filter(|p| is_own(p)).map(name).collect();
        let waiting: Vec<&Path> = self.queue.iter().map(|w| &*w.drawing).filter(|p| is_own(p)).collect();
        let cancelled: Vec<&PathBuf> = self.cancelled.iter().filter(|p| is_own(p)).collect();
        let failed: Vec<_> = self.failed.iter().filter(|(p, _)| is_own(p)).collect();
        let roots: Vec<Value> = self
            .roots
            .iter()
            .map(|r| json!({"root": name(&r.path), "watched": r.how, "is_offline": r.is_offline}))
            .collect();
        let failed_listed: Vec<Value> = failed
            .iter()
            .take(MAX_LISTED)
            .map(|(p, problem)| json!({"drawing": name(p), "problem": problem}))
            .collect();
        let ignored: Vec<Value> =
            root.ignored.iter().map(|(p, why)| json!({"file": name(p), "why": why})).collect();
        let rules: Vec<Value> =
            builtin_ignores().iter().map(|r| json!({"glob": r.glob, "why": r.why})).collect();
        json!({
            "schema": "enfilade.daemon/1",
            "state": if is_leaving { "stopped" } else { "running" },
            "host": host_name(),
            "pid": std::process::id(),
            "since": self.since,
            "roots": roots,
            "running": running.first(),
            "all_running": running,
            "waiting": waiting.iter().take(MAX_LISTED).map(|p| name(p)).collect::<Vec<_>>(),
            "waiting_count": waiting.len(),
            "settling_count": self.settle.pending_count(),
            "done_count": root.done_count,
            "failed": failed_listed,
            "failed_count": failed.len(),
            "cancelled": cancelled.iter().take(MAX_LISTED).map(|p| name(p)).collect::<Vec<_>>(),
            "cancelled_count": cancelled.len(),
            "ignored": ignored,
            "ignored_count": root.ignored_count,
            "ignore_rules": rules,
        })
    }
}
