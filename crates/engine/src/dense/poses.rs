//! Shadows of moving walls that stand where they stood in layouts before: cached by pose, and combined.
//!
//! Most layouts of a search leave most walls where other layouts had them. A chain of segments that comes a second time in
//! the same place is cast once for all; from then on its shadow is read. What is new is cast on what is left.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::{Dense, Moving};
use crate::geometry::Segment;

/// Words that the shadows of one lattice in one thread hold, at most, 2 MiB: some dozens of chains on a small plan.
const WORDS_MAX: usize = 1 << 18;

/// Chains remembered to have come once.
const ONCE_MAX: usize = 1024;

/// Segments of a chain, at most: a longer one seldom comes as a whole again.
const CHAIN_MAX: usize = 16;

/// What is left of every viewer's upper half plane behind one chain of segments.
pub(super) struct Pose {
    spans: Vec<Span>,
    words: Vec<u64>,
}

/// The lines of a view in which something is hidden, and where their words begin.
#[derive(Clone, Copy, Default)]
struct Span {
    start: u32,
    line: u16,
    lines: u16,
}

/// See the module page. Buffers of one lattice in one thread.
#[derive(Default)]
pub(super) struct Poses {
    /// Whose views they are.
    of: Option<u64>,
    kept: BTreeMap<Vec<Segment>, (u64, Arc<Pose>)>,
    once: BTreeSet<Vec<Segment>>,
    clock: u64,
    words: usize,
}

/// A layout's segments by what is known of them.
#[derive(Default)]
pub(super) struct Sorted<'a> {
    /// Shadows that are read.
    pub known: Vec<Arc<Pose>>,
    /// Chains whose shadows are made and kept, with what they are known by.
    pub again: Vec<(Vec<Segment>, &'a [Moving])>,
    /// Segments that are cast on what is left.
    pub new: Vec<Moving>,
}

impl Poses {
    /// Looks up the chains of a layout of the one that has this id; what is known of another is forgotten.
    pub fn sort<'a>(&mut self, of: u64, segments: &'a [Moving]) -> Sorted<'a> {
        if self.of != Some(of) {
            *self = Self { of: Some(of), ..Self::default() };
        }
        self.clock += 1;
        let mut out = Sorted::default();
        for chain in segments.chunk_by(are_joined).flat_map(|c| c.chunks(CHAIN_MAX)) {
            let key = key(chain);
            if let Some((used, pose)) = self.kept.get_mut(&key) {
                *used = self.clock;
                out.known.push(Arc::clone(pose));
            } else if self.once.remove(&key) {
                out.again.push((key, chain));
            } else {
                if self.once.len() >= ONCE_MAX {
                    self.once.clear();
                }
                self.once.insert(key);
                out.new.extend_from_slice(chain);
            }
        }
        out
    }

    /// Keeps what was made of a chain; what was not used for longest goes.
    pub fn keep(&mut self, key: Vec<Segment>, pose: Pose) -> Arc<Pose> {
        let pose = Arc::new(pose);
        self.words += pose.size();
        // The same chain may stand twice in a layout.
        if let Some((_, before)) = self.kept.insert(key, (self.clock, Arc::clone(&pose))) {
            self.words -= before.size();
        }
        while self.words > WORDS_MAX {
            let oldest = self.kept.iter().min_by_key(|(_, (used, _))| *used).map(|(key, _)| key.clone());
            let Some((_, gone)) = oldest.and_then(|key| self.kept.remove(&key)) else { break };
            self.words -= gone.size();
        }
        pose
    }
}

impl Pose {
    /// Nothing yet, with room for so many viewers.
    pub fn with_room(viewers: usize) -> Self {
        Self { spans: Vec::with_capacity(viewers), words: Vec::new() }
    }

    /// Takes what is `left` of the next viewer's view under the `fixed` walls; both in the order of a view, see
    /// `Dense::view_words`.
    #[inline(always)]
    pub fn add(&mut self, dense: &Dense, fixed: &[u64], left: &[u64]) {
        let stride = dense.line_stride();
        let (mut first, mut end) = (stride, 0);
        for (f, l) in fixed.chunks_exact(stride).zip(left.chunks_exact(stride)) {
            for line in 0..stride {
                if f[line] != l[line] {
                    first = first.min(line);
                    end = end.max(line + 1);
                }
            }
        }
        let lines = end.saturating_sub(first);
        self.spans.push(Span { start: self.words.len() as u32, line: first as u16, lines: lines as u16 });
        for l in left.chunks_exact(stride) {
            self.words.extend_from_slice(&l[first.min(end)..end]);
        }
    }

    /// Takes off a viewer's view what the chain hides; `stride` words of it are one word of every line.
    #[inline(always)]
    pub fn shade(&self, viewer: usize, stride: usize, view: &mut [u64]) {
        let Span { start, line, lines } = self.spans[viewer];
        let (mut at, line, lines) = (start as usize, line as usize, lines as usize);
        if lines == 0 {
            return;
        }
        for view in view.chunks_exact_mut(stride) {
            for (word, kept) in view[line..line + lines].iter_mut().zip(&self.words[at..at + lines]) {
                *word &= kept;
            }
            at += lines;
        }
    }

    fn size(&self) -> usize {
        self.spans.len() + self.words.len()
    }
}

fn key(chain: &[Moving]) -> Vec<Segment> {
    chain.iter().map(|m| m.exact).collect()
}

/// Whether one segment ends where the next does.
fn are_joined(a: &Moving, b: &Moving) -> bool {
    let (a, b) = (a.exact, b.exact);
    a.a == b.a || a.a == b.b || a.b == b.a || a.b == b.b
}
