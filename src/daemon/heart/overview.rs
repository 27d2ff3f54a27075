//! The daemon's overview, `enfilade.daemon/1`: what it watches, works on, waits for, and what failed.

use super::*;

impl Heart {
    pub(super) fn overview(&self, is_leaving: bool) -> Value {
        let name = |p: &Path| p.display().to_string();
        let roots: Vec<Value> = self
            .roots
            .iter()
            .map(|r| json!({"root": name(&r.path), "watched": r.how, "is_offline": r.is_offline}))
            .collect();
        let failed = self.failed.iter().take(MAX_LISTED);
        let failed: Vec<Value> =
            failed.map(|(p, problem)| json!({"drawing": name(p), "problem": problem})).collect();
        let ignored: Vec<Value> =
            self.ignored.iter().map(|(p, why)| json!({"file": name(p), "why": why})).collect();
        let cancelled = self.cancelled.iter().take(MAX_LISTED).map(|p| name(p)).collect::<Vec<_>>();
        let rules: Vec<Value> =
            builtin_ignores().iter().map(|r| json!({"glob": r.glob, "why": r.why})).collect();
        json!({
            "schema": "enfilade.daemon/1",
            "state": if is_leaving { "stopped" } else { "running" },
            "host": host_name(),
            "pid": std::process::id(),
            "since": self.since,
            "roots": roots,
            "running": self.running.as_ref().map(|r| name(&r.what.drawing)),
            "waiting": self.queue.iter().take(MAX_LISTED).map(|w| name(&w.drawing)).collect::<Vec<_>>(),
            "waiting_count": self.queue.len(),
            "settling_count": self.settle.pending_count(),
            "done_count": self.done_count,
            "failed": failed,
            "failed_count": self.failed.len(),
            "cancelled": cancelled,
            "cancelled_count": self.cancelled.len(),
            "ignored": ignored,
            "ignored_count": self.ignored_count,
            "ignore_rules": rules,
        })
    }
}
