//! What a builder would refuse of a layout, whatever it gains.

use crate::understand::pieces::Pieces;
use crate::understand::understood::Understood;
use enfilade_config::{Held, Method, Penalty, Settings};
use enfilade_moves::Layout;
use enfilade_moves::opened::{Joints, Opened};
use enfilade_moves::struck::Struck;
use enfilade_penalties::{Overlap, Passage, WallPiece};
use enfilade_plan::dots;

/// A way this much narrower is none, metres: turned corners are rounded.
const NARROWER_M: f64 = 0.001;

/// One thing that is wrong with a layout, and between whom; walls are indices into the walls of the plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fault {
    /// A joint opens.
    Opened(Opened),
    /// Two walls run through each other.
    Crossing([u32; 2]),
    /// A way between two walls is too narrow.
    Narrow([u32; 2]),
    /// A thing is struck, by its record.
    Struck(usize),
}

impl Fault {
    /// The word that permits it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Opened(_) => "open-joints",
            Self::Crossing(_) => "crossings",
            Self::Narrow(_) => "narrow-ways",
            Self::Struck(_) => "things",
        }
    }
}

/// What is wrong with a layout where nobody said that it may be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faults {
    /// By how much joints that are closed as drawn are open, metres in all.
    pub opened_m: f64,
    /// By how much ways are below the width of a passage, or narrower than drawn, metres in all.
    pub narrowed_m: f64,
    /// How many things walls are moved into.
    pub struck: usize,
    /// How many walls shrink to a point: a file holds no such wall.
    pub vanished: usize,
}

impl Faults {
    /// All in one number, 0 where there are none.
    pub fn sum(&self) -> f64 {
        self.opened_m + self.narrowed_m + (self.struck + self.vanished) as f64
    }

    /// What is wrong, in words.
    pub fn words(&self) -> Vec<String> {
        let of = |is_wrong: bool, words: &str| is_wrong.then(|| words.to_owned());
        [
            of(self.opened_m > 0.0, "that joints stay closed"),
            of(self.narrowed_m > 0.0, "that ways stay wide enough"),
            of(self.struck > 0, "that walls keep off what stands in rooms"),
            of(self.vanished > 0, "that no wall shrinks to a point"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// Whether layouts are held to what a builder would refuse: all moves are, marked ones too, unless the user takes the
/// search as it is.
pub(crate) fn is_gated(base: &Understood, settings: &Settings) -> bool {
    base.moves.are_default || !settings.raw && settings.method != Method::Paper
}

/// What finds them: nothing where it is allowed, but for walls that shrink to a point, which no file holds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Guards {
    joints: Option<Joints>,
    narrow: Option<Passage>,
    things: Option<Struck>,
}

impl Guards {
    /// For the moves of a drawing, its walls as `pieces`.
    pub fn new(base: &Understood, pieces: &[WallPiece], settings: &Settings) -> Self {
        if settings.raw || !is_gated(base, settings) {
            return Self::default();
        }
        let allow = settings.allow;
        let is_stated = settings.limits.iter().any(|l| l.held == Held::Penalty(Penalty::Passage));
        let mut out = Self::whole(base, pieces);
        out.joints = out.joints.filter(|_| !allow.open_joints);
        out.narrow = out.narrow.filter(|_| !allow.narrow_ways && !is_stated);
        out.things = out.things.filter(|_| !allow.things);
        out
    }

    /// All of them.
    pub fn whole(base: &Understood, pieces: &[WallPiece]) -> Self {
        let Understood { plan, moves, fittings, .. } = base;
        let drawn = enfilade_penalties::Layout { pieces };
        Self {
            joints: Some(Joints::new(plan, moves)),
            narrow: Some(Passage::new(&drawn, PASSAGE_WIDTH_M * plan.human_scale, None)),
            things: Some(Struck::new(plan, moves, fittings)),
        }
    }

    /// The faults of a layout, given also as its pieces.
    pub fn faults(
        &self,
        base: &Understood,
        layout: &Layout,
        pieces: &enfilade_penalties::Layout<'_>,
    ) -> Faults {
        let narrowed_m = self.narrow.as_ref().map_or(0.0, |n| n.measure_m(pieces));
        Faults {
            opened_m: self.joints.as_ref().map_or(0.0, |j| j.opened_m(&base.plan, layout)),
            narrowed_m: if narrowed_m > NARROWER_M { narrowed_m } else { 0.0 },
            struck: self.things.as_ref().map_or(0, |t| t.by(&base.plan, layout).len()),
            vanished: vanished(base, layout),
        }
    }
}

/// A wall that is not longer has no length, metres: corners are written to the micrometre.
const POINT_M: f64 = 0.001;

/// How many walls a layout leaves no length.
fn vanished(base: &Understood, layout: &Layout) -> usize {
    let reach = POINT_M / base.plan.unit.unit.metres;
    let was_longer = |w: u32| !dots::is_within(&base.plan.walls[w as usize].shape, reach);
    layout.walls.iter().filter(|w| dots::is_within(&w.shape, reach) && was_longer(w.wall)).count()
}

impl Guards {
    /// What is wrong with a layout, one by one, and what `crossings` finds where it is not allowed; of what is shared by two
    /// walls, only where `holds` for both.
    pub fn found(
        &self,
        (base, pieces, crossings): (&Understood, &Pieces, Option<&Overlap>),
        layout: &Layout,
        holds: &dyn Fn([u32; 2]) -> bool,
    ) -> Vec<Fault> {
        let placed = pieces.placed(base, layout);
        let now = enfilade_penalties::Layout { pieces: &placed };
        let walls = |(pair, by_m): ([usize; 2], f64)| (pair.map(|p| pieces.walls[p]), by_m);
        // Less than so much in all is rounding.
        let pairs = |all: Vec<([usize; 2], f64)>, free_m: f64| {
            let held: Vec<_> = all.into_iter().map(walls).filter(|(pair, _)| holds(*pair)).collect();
            let is_some = held.iter().map(|p| p.1).sum::<f64>() > free_m;
            held.into_iter().filter(move |_| is_some).map(|(pair, _)| pair)
        };
        let of_record = |r: usize| base.plan.walls.iter().position(|w| w.source.record == r);
        let joined = |o: &Opened| match [of_record(o.record), of_record(o.other)] {
            [Some(a), Some(b)] => holds([a as u32, b as u32]),
            _ => true,
        };
        let opened = self.joints.as_ref().map_or_else(Vec::new, |j| j.opened(&base.plan, layout));
        let crossing = crossings.map_or_else(Vec::new, |o| o.pairs_m(&now));
        let narrow = self.narrow.as_ref().map_or_else(Vec::new, |n| n.pairs_m(&now));
        let struck = self.things.as_ref().map(|t| t.by(&base.plan, layout)).unwrap_or_default();
        let mut out: Vec<Fault> = opened.into_iter().filter(joined).map(Fault::Opened).collect();
        out.extend(pairs(crossing, CROSSING_FREE_M).map(Fault::Crossing));
        out.extend(pairs(narrow, NARROWER_M).map(Fault::Narrow));
        out.extend(struck.into_iter().map(Fault::Struck));
        out
    }
}

/// Corners that are written to the micrometre and mitred anew may run through each other by so much, metres.
pub(crate) const CROSSING_FREE_M: f64 = 0.02;

/// Width below which the passage penalty counts, metres: a door that a wheelchair passes.
pub const PASSAGE_WIDTH_M: f64 = 0.9;
