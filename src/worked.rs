//! How much this process has worked. A limit of reading counts that and not the clock: a machine that is busy with other
//! programs ends nothing.

use std::time::{Duration, Instant};

/// What waits, for a disk or for others, may take so many times its limit by the clock.
pub const WAITS_MAX: u32 = 10;

/// Work since a moment.
#[derive(Clone, Copy, Debug)]
pub struct Work {
    clock: Instant,
    worked: Duration,
}

impl Work {
    /// From now on.
    pub fn begin() -> Self {
        Self { clock: Instant::now(), worked: worked() }
    }

    /// By the clock.
    pub fn elapsed(&self) -> Duration {
        self.clock.elapsed()
    }

    /// Processor time since then, on all cores together.
    pub fn worked(&self) -> Duration {
        worked().saturating_sub(self.worked)
    }

    /// Whether this process has worked so long since then, on all cores together, or has waited [`WAITS_MAX`] times as
    /// long.
    pub fn is_over(&self, limit: Duration) -> bool {
        self.worked() >= limit || self.elapsed() >= limit.saturating_mul(WAITS_MAX)
    }
}

/// Processor time of this process.
#[cfg(unix)]
fn worked() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.try_into().unwrap_or_default())
}

/// Where the system is not asked for it: the clock.
#[cfg(not(unix))]
fn worked() -> Duration {
    static BEGAN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGAN.get_or_init(Instant::now).elapsed()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_is_no_work() {
        let since = Work::begin();
        std::thread::sleep(Duration::from_millis(20));
        assert!(!since.is_over(Duration::from_secs(60)));
        assert!(since.is_over(since.elapsed() / (2 * WAITS_MAX)), "so many times as long by the clock");
        let busy = Work::begin();
        let mut sum = 0u64;
        while !busy.is_over(Duration::from_millis(30)) {
            sum = std::hint::black_box(sum.wrapping_mul(31).wrapping_add(1));
        }
        assert!(busy.elapsed() >= Duration::from_millis(5), "{sum}");
    }
}
