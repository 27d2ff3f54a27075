//! Whose turn it is: short drawings before long ones, within a number of jobs and the memory for all of them.
//!
//! Times and sizes are values here, so that the tests play whole days of a daemon without a clock. How long a drawing
//! takes is known from its last job, else guessed by its size; a job that takes longer than [`SHORT`] is long from then
//! on, whatever was guessed. What a job takes is processor time: on a machine that others keep busy a short drawing is
//! short all the same. One place is always left to short drawings.

use std::time::Duration;

/// A job that takes more processor time is long: a house takes 5 to 25 s by default, a floor of a hospital some minutes.
pub(super) const SHORT: Duration = Duration::from_secs(30);
/// A long drawing that has waited so long goes before short ones.
pub(super) const WAITED: Duration = Duration::from_secs(600);
/// So many bytes of a drawing take a second, where nothing better is known: what is large waits a little for what is small.
const BYTES_A_SECOND: u64 = 20_000;
/// A job takes up to so many times the bytes of its drawing.
const MEMORY_BY_BYTES: u64 = 10;
/// The memory for all jobs has so many shares. A job has one; one that needs more is done again with all but one.
const SHARES: u64 = 4;

/// What there is for all jobs together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    /// Jobs at once, at least one.
    pub jobs: usize,
    /// Bytes for all of them; `None`: not known.
    pub memory: Option<u64>,
    /// Bytes for one of them at most.
    pub job_memory: Option<u64>,
}

impl Room {
    /// The memory of an ordinary job.
    fn share(&self) -> Option<u64> {
        let share = self.memory.map(|all| all / SHARES);
        share.map(|s| self.job_memory.map_or(s, |most| most.min(s))).or(self.job_memory)
    }

    /// The most memory that a job gets.
    fn most(&self) -> Option<u64> {
        let most = self.memory.map(|all| all - all / SHARES);
        self.job_memory.map(|asked| most.map_or(asked, |m| asked.min(m))).or(most)
    }

    /// The memory for a drawing of so many bytes; `is_hungry`: a share was too little for it.
    pub(super) fn memory_for(&self, bytes: u64, is_hungry: bool) -> Option<u64> {
        let is_large = self.share().is_some_and(|s| bytes.saturating_mul(MEMORY_BY_BYTES) > s);
        if is_hungry || is_large { self.most() } else { self.share() }
    }

    fn holds(&self, busy: &[Busy], more: Option<u64>) -> bool {
        let taken = busy.iter().filter_map(|b| b.memory).fold(0, u64::saturating_add);
        // A job that may take more than there is runs alone.
        let is_within = self.memory.is_none_or(|all| taken.saturating_add(more.unwrap_or(0)) <= all);
        is_within || busy.is_empty()
    }
}

/// How much processor time a drawing will take.
pub(super) fn estimate(bytes: u64, earlier: Option<Duration>) -> Duration {
    earlier.unwrap_or_else(|| Duration::from_secs(bytes / BYTES_A_SECOND))
}

/// A drawing that waits and may begin.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Wish {
    pub takes: Duration,
    pub waited: Duration,
    pub memory: Option<u64>,
}

impl Wish {
    fn is_long(&self) -> bool {
        self.takes > SHORT
    }
}

/// A job that runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Busy {
    pub takes: Duration,
    /// Processor time.
    pub worked: Duration,
    pub memory: Option<u64>,
    /// Whether it was told to end.
    pub is_ending: bool,
}

impl Busy {
    fn is_long(&self) -> bool {
        self.takes > SHORT || self.worked > SHORT
    }
}

/// Which of those that wait, in their order, begins now.
pub(super) fn next(waiting: &[Wish], busy: &[Busy], room: &Room) -> Option<usize> {
    if busy.len() >= room.jobs.max(1) {
        return None;
    }
    let fits = |i: &usize| room.holds(busy, waiting[*i].memory);
    let longs = busy.iter().filter(|b| b.is_long()).count();
    let may_be_long = longs + 1 < room.jobs || room.jobs <= 1;
    let long = waiting.iter().position(Wish::is_long).filter(|_| may_be_long);
    if let Some(old) = long.filter(|i| waiting[*i].waited >= WAITED) {
        if fits(&old) {
            return Some(old);
        }
        // Its memory becomes free in time only where few begin meanwhile.
        if busy.len() > longs {
            return None;
        }
    }
    let shorts = (0..waiting.len()).filter(|i| !waiting[*i].is_long() && fits(i));
    // Of those that take the same time the first.
    shorts.min_by_key(|i| waiting[*i].takes.as_secs()).or(long.filter(fits))
}

/// Which job ends, to begin again later, as all that run are long and something short waits for a place.
pub(super) fn gives_way(waiting: &[Wish], busy: &[Busy], room: &Room) -> Option<usize> {
    let is_stuck = room.jobs > 1
        && busy.iter().all(|b| b.is_long() && !b.is_ending)
        && waiting.iter().any(|w| !w.is_long())
        && next(waiting, busy, room).is_none();
    let youngest = (0..busy.len()).min_by_key(|i| busy[*i].worked);
    youngest.filter(|_| is_stuck && !busy.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GB: u64 = 1 << 30;

    /// A drawing of the script: when it comes, what its size says, what it takes alone.
    #[derive(Clone, Copy)]
    struct Sheet {
        comes: u64,
        guessed: u64,
        takes: u64,
        memory: u64,
    }

    struct Going {
        sheet: usize,
        worked: f64,
        memory: u64,
    }

    fn wish(sheet: &Sheet, known: Option<u64>, now: f64) -> Wish {
        Wish {
            takes: Duration::from_secs(known.unwrap_or(sheet.guessed)),
            waited: Duration::from_secs_f64(now - sheet.comes as f64),
            memory: Some(sheet.memory),
        }
    }

    fn busy(going: &Going, sheet: &Sheet, known: Option<u64>) -> Busy {
        Busy {
            takes: Duration::from_secs(known.unwrap_or(sheet.guessed)),
            worked: Duration::from_secs_f64(going.worked),
            memory: Some(going.memory),
            is_ending: false,
        }
    }

    /// Plays the drawings second by second on jobs that share the processor; a long job gives nearly all of it to
    /// short ones, and others leave only a share of it. When each was begun, the last time, and done.
    fn play(sheets: &[Sheet], room: &Room, left: f64) -> [Vec<f64>; 2] {
        const STEP: f64 = 0.25;
        let [mut begun, mut done] = [(); 2].map(|()| vec![f64::NAN; sheets.len()]);
        let mut waiting: Vec<usize> = Vec::new();
        let mut known: Vec<Option<u64>> = vec![None; sheets.len()];
        let mut going: Vec<Going> = Vec::new();
        let mut now = 0.0;
        while done.iter().any(|d| d.is_nan()) {
            let comes = |i: &usize| (sheets[*i].comes as f64 - now).abs() < STEP / 2.0;
            waiting.extend((0..sheets.len()).filter(comes));
            loop {
                let wishes: Vec<Wish> = waiting.iter().map(|i| wish(&sheets[*i], known[*i], now)).collect();
                let runs: Vec<Busy> =
                    going.iter().map(|g| busy(g, &sheets[g.sheet], known[g.sheet])).collect();
                if let Some(i) = next(&wishes, &runs, room) {
                    let sheet = waiting.remove(i);
                    let memory = sheets[sheet].memory;
                    begun[sheet] = now;
                    going.push(Going { sheet, worked: 0.0, memory });
                } else if let Some(i) = gives_way(&wishes, &runs, room) {
                    let gone = going.remove(i);
                    known[gone.sheet] = Some(gone.worked as u64 + 1);
                    waiting.push(gone.sheet);
                } else {
                    break;
                }
            }
            assert!(going.len() <= room.jobs);
            let held: u64 = going.iter().map(|g| g.memory).sum();
            assert!(room.memory.is_none_or(|all| held <= all) || going.len() == 1, "{held}");
            let is_long = |g: &Going| busy(g, &sheets[g.sheet], known[g.sheet]).is_long();
            let weights: Vec<f64> = going.iter().map(|g| if is_long(g) { 0.1 } else { 1.0 }).collect();
            let sum: f64 = weights.iter().sum();
            for (g, w) in going.iter_mut().zip(&weights) {
                g.worked += left * STEP * w / sum;
            }
            now += STEP;
            going.retain(|g| {
                let is_over = g.worked >= sheets[g.sheet].takes as f64;
                if is_over {
                    done[g.sheet] = now;
                }
                !is_over
            });
            assert!(now < 1e5, "somebody starves: {done:?}");
        }
        [begun, done]
    }

    fn room(jobs: usize) -> Room {
        Room { jobs, memory: Some(16 * GB), job_memory: None }
    }

    fn sheets(count: usize, guessed: u64, takes: u64) -> Vec<Sheet> {
        vec![Sheet { comes: 0, guessed, takes, memory: GB }; count]
    }

    /// 20 at once of which three are heavy, guessed rightly or wrongly, wherever they stand in the order: the small ones
    /// are done within twice the time that they would take without them, also where others keep the machine busy.
    #[test]
    fn heavy_drawings_hold_up_no_small_ones() {
        let last = |done: &[f64], small: &[usize]| small.iter().map(|i| done[*i]).fold(0.0, f64::max);
        for (takes, left) in [(8, 1.0), (30, 1.0), (8, 0.2), (30, 0.2)] {
            let small = sheets(17, 1, takes);
            let alone = last(&play(&small, &room(2), left)[1], &(0..17).collect::<Vec<_>>());
            for jobs in [2, 3, 4] {
                for guessed in [0, 300] {
                    for at in [0, 8, 17] {
                        let mut all = small.clone();
                        all.splice(at..at, sheets(3, guessed, 500));
                        let small: Vec<usize> = (0..20).filter(|i| !(at..at + 3).contains(i)).collect();
                        let done = last(&play(&all, &room(jobs), left)[1], &small);
                        let of = (takes, left, jobs, guessed, at);
                        assert!(done <= 2.0 * alone, "{of:?}: {done} s instead of {alone} s");
                    }
                }
            }
        }
    }

    /// 20,000 lines take 1.7 MB: large enough to be held back, where nothing is known of it.
    #[test]
    fn what_is_large_is_thought_long() {
        let takes = estimate(1_700_000, None);
        assert!(takes > SHORT && estimate(100_000, None) <= SHORT);
        assert_eq!(estimate(1_700_000, Some(SHORT / 2)), SHORT / 2, "the last job knows better");
        let wish = |takes| Wish { takes, ..Wish::default() };
        let (large, small) = (wish(SHORT), wish(Duration::from_millis(10)));
        assert_eq!(next(&[large, small, small], &[], &room(2)), Some(1));
        let long = Busy { takes, ..Busy::default() };
        assert_eq!(
            next(&[wish(takes), wish(takes)], &[long], &room(2)),
            None,
            "a place is left to short ones"
        );
    }

    /// Small ones that come while heavy ones run are begun at once, within twice their own time, as soon as the heavy ones
    /// are known to be so: each after its first [`SHORT`].
    #[test]
    fn what_comes_later_does_not_wait_for_what_is_heavy() {
        for guessed in [0, 300] {
            let mut all = sheets(3, guessed, 400);
            all.extend((1..=10).map(|i| Sheet { comes: 80 + 40 * i, guessed: 1, takes: 4, memory: GB }));
            let [_, done] = play(&all, &room(2), 1.0);
            for (sheet, done) in all.iter().zip(&done).skip(3) {
                let took = done - sheet.comes as f64;
                assert!(took <= 8.5, "{guessed}: {took} s instead of 4 s");
            }
        }
    }

    /// Short drawings without end starve no long one, however much memory it needs.
    #[test]
    fn long_drawings_have_their_turn() {
        for memory in [GB, 12 * GB] {
            let mut all = vec![Sheet { comes: 0, guessed: 100, takes: 100, memory }];
            all.extend((0..1500).map(|i| Sheet { comes: i, guessed: 1, takes: 2, memory: 4 * GB }));
            let [begun, done] = play(&all, &room(4), 1.0);
            assert!(begun[0] < WAITED.as_secs_f64() + 60.0, "{memory}: {}", begun[0]);
            assert!(done.iter().all(|d| d.is_finite()));
        }
    }

    /// Jobs never hold more memory than there is for all; what needs more than a share is done with all but one.
    #[test]
    fn memory_is_shared() {
        let room = Room { jobs: 8, memory: Some(16 * GB), job_memory: None };
        assert_eq!(room.memory_for(1_000_000, false), Some(4 * GB));
        assert_eq!(room.memory_for(1_000_000, true), Some(12 * GB));
        assert_eq!(room.memory_for(GB, false), Some(12 * GB));
        let asked = Room { job_memory: Some(GB), ..room };
        assert_eq!((asked.memory_for(1, false), asked.memory_for(1, true)), (Some(GB), Some(GB)));
        let unknown = Room { memory: None, ..room };
        assert_eq!(unknown.memory_for(GB, true), None);
        let wish = |memory| [Wish { memory: Some(memory), ..Wish::default() }];
        let busy = [Busy { memory: Some(4 * GB), ..Busy::default() }; 3];
        assert_eq!(next(&wish(4 * GB), &busy, &room), Some(0));
        assert_eq!(next(&wish(5 * GB), &busy, &room), None);
        assert_eq!(next(&wish(100 * GB), &[], &room), Some(0), "alone it is begun all the same");
    }

    /// One job at a time is what one asked for: nothing gives way.
    #[test]
    fn one_at_a_time_ends_none() {
        let busy = [Busy { worked: 3 * SHORT, ..Busy::default() }];
        assert_eq!(gives_way(&[Wish::default()], &busy, &room(1)), None);
        assert_eq!(gives_way(&[Wish::default()], &[busy[0]; 2], &room(2)), Some(0));
        let ending = Busy { is_ending: true, ..busy[0] };
        assert_eq!(gives_way(&[Wish::default()], &[busy[0], ending], &room(2)), None);
    }
}
