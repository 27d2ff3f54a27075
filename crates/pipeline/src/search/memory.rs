//! What a search remembers of itself, so that a job that was killed goes on where it was.
//!
//! The search asks the same again for the same study, so it is enough to keep what its vectors were worth, in
//! order: told again instead of measured again, they lead to the same state and the same bytes. A row that does
//! not belong to the vector asked for ends the remembering; the first batch is always measured and compared, so
//! that what another build of the program measured differently is not believed.
//!
//! Under a budget of seconds a search asks by its pace as well. Each row then says how many evaluations were thought
//! to fit when it was asked for, and how many seconds had gone when it was known: both are told again instead of read
//! from the clock, and what was spent before a kill counts.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use sha2::{Digest, Sha256};

use crate::job::{Input, Keep};
use enfilade_config::{Settings, Twin};
use enfilade_search::Evaluation;

/// What a remembered search starts with; followed by its key.
const HEAD: &[u8] = b"enfilade.search/1\n";
/// What was measured is kept this often; a kill costs no more than that.
const KEEP_EVERY: Duration = Duration::from_millis(200);
/// Bytes of a row's check.
const CHECK_BYTES: usize = 8;
/// Bytes of a row's pace: evaluations thought to fit, seconds gone.
const PACE_BYTES: usize = 16;

/// How far a search under a budget of seconds had come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pace {
    /// Evaluations that were thought to fit into the budget, when a batch was asked for.
    pub fit: u64,
    /// Seconds gone, when its worth was known.
    pub spent_secs: f64,
}

/// Seconds that a round has spent, those before a kill included.
pub(crate) struct Clock {
    /// When the clock was last set, and what it said then.
    set: (Instant, f64),
    /// What it said when the search began.
    begun_secs: f64,
}

impl Clock {
    /// Runs from `started`; the search begins now.
    pub(crate) fn new(started: Instant) -> Self {
        Self { set: (started, 0.0), begun_secs: started.elapsed().as_secs_f64() }
    }

    /// What it says.
    pub(crate) fn spent_secs(&self) -> f64 {
        self.set.1 + self.set.0.elapsed().as_secs_f64()
    }

    /// From now on it goes on from there.
    pub(crate) fn set(&mut self, spent_secs: f64) {
        self.set = (Instant::now(), spent_secs);
    }

    /// So many seconds were spent on something else since the search began: they say nothing of its pace.
    pub(crate) fn pause(&mut self, secs: f64) {
        self.begun_secs += secs;
    }

    /// Seconds an evaluation has taken on average, of so many.
    pub(crate) fn secs_each(&self, done: u64) -> f64 {
        (self.spent_secs() - self.begun_secs).max(0.0) / done.max(1) as f64
    }

    /// How many evaluations will fit into the time left, at the pace so far, after that many.
    pub(crate) fn fit(&self, done: u64, budget_secs: f64, together: u64) -> u64 {
        let spent = self.spent_secs();
        let rate = done as f64 / (spent - self.begun_secs).max(1e-6);
        done + ((rate * (budget_secs - spent).max(0.0)) as u64).max(2 * together)
    }
}

/// See the module.
pub(crate) struct Memory {
    key: [u8; 32],
    /// Values of an evaluation, without its violation.
    values: usize,
    /// Remembered from an earlier start, in order.
    rows: VecDeque<Vec<u8>>,
    is_first: bool,
    /// Measured or told again since what was last kept.
    fresh: Vec<u8>,
    kept: Option<Instant>,
}

impl Memory {
    /// What `input.earlier` says of the same study, with that many objectives.
    pub(crate) fn new(input: &Input<'_>, settings: &Settings, values: usize) -> Self {
        let key = key(input, settings);
        let row = CHECK_BYTES + PACE_BYTES + 8 * (values + 1);
        let rows = input.earlier.strip_prefix(HEAD).and_then(|b| b.strip_prefix(&key[..]));
        let rows = rows.map_or_else(VecDeque::new, |b| b.chunks_exact(row).map(<[u8]>::to_vec).collect());
        Self { key, values, rows, is_first: true, fresh: Vec::new(), kept: None }
    }

    /// The pace of the batch that is asked for next, where it is remembered.
    pub(crate) fn pace(&self) -> Option<Pace> {
        let row = if self.is_first { None } else { self.rows.front() };
        row.and_then(|r| pace_of(&r[CHECK_BYTES..]))
    }

    /// What these vectors are worth, where that is remembered of all of them.
    pub(crate) fn recall(&mut self, asked: &[Vec<f64>]) -> Option<Vec<Evaluation>> {
        if self.is_first || self.rows.is_empty() {
            return None;
        }
        let known = asked.iter().zip(&self.rows).map(|(p, row)| self.read(p, row));
        let known: Option<Vec<Evaluation>> =
            if asked.len() > self.rows.len() { None } else { known.collect() };
        if known.is_none() {
            self.rows.clear();
            return None;
        }
        for row in self.rows.drain(..asked.len()) {
            self.fresh.extend(row);
        }
        known
    }

    /// Takes in what vectors were found to be worth.
    pub(crate) fn learn(&mut self, asked: &[Vec<f64>], told: &[Evaluation], pace: Pace) {
        let rows: Vec<Vec<u8>> = asked.iter().zip(told).map(|(p, e)| self.row(p, e, pace)).collect();
        if std::mem::take(&mut self.is_first) {
            // Measured in another time, and worth the same?
            let is_so = |(old, told): (&Vec<u8>, (&Vec<f64>, &Evaluation))| {
                let pace = pace_of(&old[CHECK_BYTES..]).unwrap_or_default();
                *old == self.row(told.0, told.1, pace)
            };
            let is_same =
                self.rows.len() >= rows.len() && self.rows.iter().zip(asked.iter().zip(told)).all(is_so);
            self.rows.drain(..if is_same { rows.len() } else { self.rows.len() });
        }
        self.fresh.extend(rows.into_iter().flatten());
    }

    /// What is to be kept now, if anything: not while old rows are told again, which are kept already.
    pub(crate) fn keep(&mut self) -> Option<Keep> {
        let is_soon = self.kept.is_some_and(|t| t.elapsed() < KEEP_EVERY);
        if is_soon || !self.rows.is_empty() || self.fresh.is_empty() {
            return None;
        }
        let is_anew = self.kept.replace(Instant::now()).is_none();
        let mut bytes = if is_anew { [HEAD, &self.key].concat() } else { Vec::new() };
        bytes.append(&mut self.fresh);
        Some(Keep { is_anew, bytes })
    }

    fn row(&self, at: &[f64], told: &Evaluation, pace: Pace) -> Vec<u8> {
        let mut bytes = [pace.fit.to_le_bytes(), pace.spent_secs.to_le_bytes()].concat();
        bytes.extend(told.values.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend(told.violation.to_le_bytes());
        let mut out = check(&self.key, at, &bytes).to_vec();
        out.extend(bytes);
        out
    }

    fn read(&self, at: &[f64], row: &[u8]) -> Option<Evaluation> {
        let (mark, bytes) = row.split_at_checked(CHECK_BYTES)?;
        let worth = bytes.get(PACE_BYTES..)?;
        let numbers = worth.chunks_exact(8).filter_map(|b| b.try_into().ok().map(f64::from_le_bytes));
        let mut values: Vec<f64> = numbers.collect();
        let violation = values.pop()?;
        let fits = values.len() == self.values && *mark == check(&self.key, at, bytes);
        fits.then_some(Evaluation { values, violation, at: None })
    }
}

fn pace_of(bytes: &[u8]) -> Option<Pace> {
    let (fit, rest) = bytes.split_first_chunk()?;
    let spent = rest.first_chunk()?;
    Some(Pace { fit: u64::from_le_bytes(*fit), spent_secs: f64::from_le_bytes(*spent) })
}

/// What a row's check is made of: study, vector, pace and worth, bit for bit.
fn check(key: &[u8; 32], at: &[f64], worth: &[u8]) -> [u8; CHECK_BYTES] {
    let mut hash = Sha256::new();
    hash.update(key);
    at.iter().for_each(|v| hash.update(v.to_le_bytes()));
    hash.update(worth);
    let digest: [u8; 32] = hash.finalize().into();
    std::array::from_fn(|i| digest[i])
}

/// Everything that decides what a search asks and is told.
fn key(input: &Input<'_>, settings: &Settings) -> [u8; 32] {
    let mut hash = Sha256::new();
    let text = serde_json::to_string(settings).unwrap_or_default();
    for part in [enfilade_config::VERSION, input.file(), input.sha256(), &text] {
        hash.update(part);
        hash.update([0]);
    }
    let data = settings.beside.buffers.values().map(AsRef::as_ref);
    for part in settings.beside.twin.iter().map(Twin::bytes).chain(data) {
        hash.update(part);
    }
    hash.finalize().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_config::Partial;

    fn settings() -> Settings {
        Settings::new(Partial::default()).unwrap()
    }

    fn told(values: [f64; 2], violation: f64) -> Evaluation {
        Evaluation { values: values.into(), violation, at: None }
    }

    fn batches() -> Vec<(Vec<Vec<f64>>, Vec<Evaluation>)> {
        let first = (vec![vec![0.0, 0.5]], vec![told([1.0, f64::NAN], 0.0)]);
        let more = (1..6).map(f64::from).map(|i| {
            let asked = vec![vec![i, -0.0], vec![0.1 * i, 0.5]];
            (asked, vec![told([i, 1.0 / i], 0.0), told([0.2, 0.3], 0.1 * i)])
        });
        std::iter::once(first).chain(more).collect()
    }

    fn paces() -> impl Iterator<Item = Pace> {
        (0..).map(|i| Pace { fit: 40 + i, spent_secs: 0.25 * i as f64 })
    }

    fn bits(e: &[Evaluation]) -> Vec<u64> {
        e.iter().flat_map(|e| e.values.iter().chain([&e.violation])).map(|v| v.to_bits()).collect()
    }

    /// All that a search over these batches would have kept.
    fn kept(settings: &Settings) -> Vec<u8> {
        let input = Input::new("plan.dxf", b"bytes", 1);
        let mut memory = Memory::new(&input, settings, 2);
        let all = batches();
        all.iter().zip(paces()).for_each(|((asked, told), pace)| memory.learn(asked, told, pace));
        memory.keep().map_or(Vec::new(), |k| k.bytes)
    }

    /// How many batches are told again from these bytes, and what is kept of the search then.
    fn replay(earlier: &[u8], bytes: &[u8], settings: &Settings) -> (usize, Vec<u8>) {
        let input = Input::new("plan.dxf", bytes, 1).going_on_from(earlier);
        let mut memory = Memory::new(&input, settings, 2);
        let mut recalled = 0;
        for ((asked, told), pace) in batches().into_iter().zip(paces()) {
            let remembered = memory.pace();
            match memory.recall(&asked) {
                Some(found) => {
                    assert_eq!(bits(&found), bits(&told));
                    assert_eq!(remembered, Some(pace));
                    recalled += 1;
                }
                None => memory.learn(&asked, &told, pace),
            }
        }
        (recalled, memory.keep().unwrap().bytes)
    }

    /// Cut at every byte: whole batches are told again, the rest is measured, and the same is kept as before.
    #[test]
    fn what_was_measured_before_a_kill_is_told_again() {
        let settings = settings();
        let whole = kept(&settings);
        let mut seen = Vec::new();
        for cut in 0..=whole.len() {
            let (recalled, again) = replay(&whole[..cut], b"bytes", &settings);
            assert_eq!(again, whole, "cut at {cut}");
            seen.push(recalled);
        }
        assert!(seen.is_sorted());
        assert_eq!((seen[0], *seen.last().unwrap()), (0, batches().len() - 1));
    }

    /// Another drawing, other settings, a flipped bit, or other measures at the start: nothing of it is believed.
    #[test]
    fn what_does_not_belong_is_measured() {
        let settings = settings();
        let whole = kept(&settings);
        assert_eq!(replay(&whole, b"other", &settings).0, 0);
        assert_eq!(replay(&whole, b"bytes", &Settings { seed: 9, ..settings.clone() }).0, 0);
        let threads = Settings { threads: Some(3), ..settings.clone() };
        assert_eq!(replay(&whole, b"bytes", &threads).0, batches().len() - 1);
        for at in [HEAD.len() + 32, HEAD.len() + 32 + 48 * 2 + 3, HEAD.len() + 32 + 48 * 2 + CHECK_BYTES] {
            let mut torn = whole.clone();
            torn[at] ^= 1;
            let (recalled, again) = replay(&torn, b"bytes", &settings);
            assert!(recalled < batches().len() - 1);
            assert_eq!(again, whole);
        }
    }

    /// What was spent before a kill is spent, and the last of a budget still takes two batches.
    #[test]
    fn a_clock_goes_on_where_it_was() {
        let mut clock = Clock::new(Instant::now());
        assert!(clock.fit(100, 1e9, 2) > 1_000_000);
        clock.set(1e6);
        assert!(clock.spent_secs() >= 1e6);
        assert_eq!(clock.fit(100, 1e6, 2), 104);
    }

    /// The first batch takes its own time at every start; that is no reason to forget the rest.
    #[test]
    fn the_time_of_the_first_batch_does_not_matter() {
        let whole = kept(&settings());
        let input = Input::new("plan.dxf", b"bytes", 1).going_on_from(&whole);
        let mut memory = Memory::new(&input, &settings(), 2);
        let all = batches();
        assert_eq!(memory.pace(), None, "nothing is believed before the first batch");
        memory.learn(&all[0].0, &all[0].1, Pace { fit: 7, spent_secs: 99.0 });
        assert_eq!(memory.pace(), paces().nth(1));
        assert!(memory.recall(&all[1].0).is_some());
    }
}
