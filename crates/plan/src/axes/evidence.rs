//! Evidence: what the drawing shows in a gap of a wall, and what that makes of it.

use glam::DVec2;

use super::axis::Spare;
use super::carrier::Carrier;
use super::near::Buckets;
use super::spans::{self, Span};
use super::swing::{LEAF_M, Swing};
use super::{Drawn, Mark, OpeningKind, Path, Role, Shown};
use crate::sizes::{COLLINEAR_M, ERROR_GAP_M, FINISH_MAX_M, FRAME_M, PASSAGE_MAX_M};
use enfilade_cad::plane::is_inside_ring;

/// Share of the gap that a window line runs along.
pub const PANE_COVER: f64 = 0.6;
/// Shares of the gap that one of two or three sashes takes, and that they take together.
const SASH_SHARE: [f64; 2] = [0.3, 0.7];
/// See [`SASH_SHARE`].
const SASHES_COVER: f64 = 0.8;
/// Share of the gap that the leaves of a folding door reach along, on one side of it.
const FOLDED_COVER: f64 = 0.25;
/// Share of the gap that a door known by its layer or block alone reaches along.
const DOOR_COVER: f64 = 0.4;
const BAY_REACH_SHARE: f64 = 1.2;
/// Half the width in which things lie in the gap of a wall drawn as one line.
const SINGLE_HALF_M: f64 = 0.21;

/// All that may be evidence, by place.
pub struct Evidence<'a> {
    pub drawn: &'a Drawn,
    spares: &'a [Spare],
    marks_near: Buckets,
    spares_near: Buckets,
}

impl<'a> Evidence<'a> {
    pub fn new(drawn: &'a Drawn, spares: &'a [Spare]) -> Self {
        let (mut marks_near, mut spares_near) = (Buckets::new(1.0), Buckets::new(1.0));
        for (i, m) in drawn.marks.iter().enumerate() {
            m.paths.iter().for_each(|p| marks_near.add(i as u32, &trace(p)));
        }
        for (i, s) in spares.iter().enumerate() {
            spares_near.add(i as u32, &s.carrier.points(s.span));
        }
        Self { drawn, spares, marks_near, spares_near }
    }

    /// What is drawn in a gap.
    pub fn look(&self, carrier: &Carrier, thickness: f64, gap: Span) -> Seen {
        let band = Band {
            carrier: *carrier,
            gap,
            half: if thickness > 0.0 { thickness / 2.0 } else { SINGLE_HALF_M },
        };
        let around = carrier.points(gap);
        let mut seen = Seen { gap_m: spans::length(gap), ..Seen::default() };
        for m in self.marks_near.along(&around, band.half + LEAF_M.end()) {
            let mark = &self.drawn.marks[m as usize];
            if seen.look_at(mark, &band) {
                seen.marks.push(m);
            }
        }
        let groups: Vec<u32> = seen.marks.iter().map(|m| self.drawn.marks[*m as usize].group).collect();
        for m in self.marks_near.along(&around, band.half + 2.0 * LEAF_M.end()) {
            let mark = &self.drawn.marks[m as usize];
            if groups.contains(&mark.group) {
                seen.marks.push(m);
                // A leaf beside the frame of its block.
                if mark.role == Role::Door {
                    seen.door_spans.extend(mark.paths.iter().filter_map(|p| band.reach_of(p)));
                }
            }
        }
        for m in self.bay(&around, &band) {
            seen.window_spans.push(gap);
            seen.window = seen.window.max(Some(self.drawn.marks[m as usize].is_named));
            seen.marks.push(m);
        }
        seen.marks.sort_unstable();
        seen.marks.dedup();
        for s in self.spares_near.along(&around, band.half + LEAF_M.end()) {
            let spare = &self.spares[s as usize];
            let path = path_of(spare);
            let is_swing = band.has_swing(&path);
            seen.swing |= is_swing;
            seen.panes |= band.has_pane(&path, ERROR_GAP_M) && !spare.is_cap;
            if is_swing || (!spare.is_cap && band.holds(&path)) {
                // Of a run of lines those that lie in the gap as a whole: others go on along the wall.
                let is_in = |f: &&u32| is_swing || band.holds_whole(&self.drawn.faces[**f as usize].path);
                seen.faces.extend(spare.faces.iter().filter(is_in));
            }
        }
        seen.faces.sort_unstable();
        seen.faces.dedup();
        seen
    }

    /// What is a bay window before a gap: pieces of windows and glass that hang together from one jamb to the other.
    fn bay(&self, around: &[DVec2], band: &Band) -> Vec<u32> {
        let middle = band.carrier.at((band.gap[0] + band.gap[1]) / 2.0);
        let reach = BAY_REACH_SHARE * spans::length(band.gap);
        let is_glass = |m: &u32| {
            let mark = &self.drawn.marks[*m as usize];
            let mut points = mark.paths.iter().flat_map(trace);
            matches!(mark.role, Role::Window | Role::Glazing) && points.all(|p| p.distance(middle) <= reach)
        };
        let near = self.marks_near.along(around, band.half + LEAF_M.end());
        let ends_of = |m: u32| {
            let paths = &self.drawn.marks[m as usize].paths;
            (m, paths.iter().flat_map(Path::ends).collect::<Vec<DVec2>>())
        };
        let mut rest: Vec<(u32, Vec<DVec2>)> = near.into_iter().filter(is_glass).map(ends_of).collect();
        let mut out = Vec::new();
        while let Some(first) = rest.pop() {
            let mut chain = vec![first];
            let mut from = 0;
            while let Some((_, ends)) = chain.get(from).cloned() {
                let hangs =
                    |o: &[DVec2]| o.iter().any(|p| ends.iter().any(|q| p.distance(*q) <= ERROR_GAP_M));
                chain.extend(rest.extract_if(.., |(_, other)| hangs(other.as_slice())));
                from += 1;
            }
            let at_jamb = |k: usize| chain.iter().flat_map(|c| &c.1).any(|p| band.is_at_jamb(*p, k));
            if at_jamb(0) && at_jamb(1) {
                out.extend(chain.iter().map(|c| c.0));
            }
        }
        out
    }
}

/// A span from two values in any order.
pub fn ordered(a: f64, b: f64) -> Span {
    [a.min(b), a.max(b)]
}

/// Points along a path.
pub fn trace(path: &Path) -> Vec<DVec2> {
    let (carrier, span) = Carrier::of(path);
    if span[1] - span[0] < 1e-9 || !carrier.at(span[0]).is_finite() {
        return vec![path.ends()[0]];
    }
    carrier.points(span)
}

fn path_of(spare: &Spare) -> Path {
    let [a, b] = spare.span.map(|s| spare.carrier.at(s));
    match spare.carrier {
        Carrier::Line { .. } => Path::Line { a, b },
        Carrier::Circle { centre, radius, base_rad } => Path::Arc {
            centre,
            radius,
            start_rad: base_rad + spare.span[0] / radius,
            sweep_rad: spans::length(spare.span) / radius,
        },
    }
}

/// The place of a gap in its wall.
pub struct Band {
    pub carrier: Carrier,
    pub gap: Span,
    pub half: f64,
}

impl Band {
    /// Whether a point lies in the gap or at most `more` beside it.
    pub fn has(&self, p: DVec2, more: f64) -> bool {
        let s = self.carrier.s_of(p);
        s > self.gap[0] - more
            && s < self.gap[1] + more
            && self.carrier.offset_of(p).abs() <= self.half + more
    }

    /// Whether a point lies at the first or the second jamb.
    fn is_at_jamb(&self, p: DVec2, jamb: usize) -> bool {
        (self.carrier.s_of(p) - self.gap[jamb]).abs() <= FINISH_MAX_M
            && self.carrier.offset_of(p).abs() <= self.half + FINISH_MAX_M
    }

    /// Whether the middle of a piece lies in the gap, or just beside the wall's faces. Just beyond a jamb lies what fills the
    /// next gap: its frame.
    fn holds(&self, path: &Path) -> bool {
        let points = trace(path);
        let n = points.len() / 2;
        let middle = if points.len() == 2 { points[0].midpoint(points[1]) } else { points[n] };
        let s = self.carrier.s_of(middle);
        self.has(middle, ERROR_GAP_M) && (self.gap[0]..=self.gap[1]).contains(&s)
    }

    /// The same of a piece that lies in the gap as a whole; a face of the wall may have its middle there too.
    fn holds_whole(&self, path: &Path) -> bool {
        let is_in = |s: f64| (self.gap[0] - FRAME_M..=self.gap[1] + FRAME_M).contains(&s);
        self.holds(path) && path.ends().iter().all(|e| is_in(self.carrier.s_of(*e)))
    }

    /// Whether a piece lies on a jamb, across the wall: it closes a window beside the gap as well as one in it.
    fn is_on_jamb(&self, path: &Path) -> bool {
        let along = path.ends().map(|e| self.carrier.s_of(e));
        matches!(path, Path::Line { .. })
            && self.gap.iter().any(|jamb| along.iter().all(|s| (s - jamb).abs() <= ERROR_GAP_M))
    }

    /// What a piece reaches along the gap.
    fn reach_of(&self, path: &Path) -> Option<Span> {
        let along = trace(path).into_iter().map(|p| self.carrier.s_of(p));
        let (from, to) = along.fold((f64::MAX, f64::MIN), |b, s| (b.0.min(s), b.1.max(s)));
        spans::overlap([from, to], self.gap)
    }

    /// A line along the wall through most of the gap, at most `beside` its faces.
    fn has_pane(&self, path: &Path, beside: f64) -> bool {
        let ends = path.ends();
        if ends.iter().any(|e| self.carrier.offset_of(*e).abs() > self.half + beside) {
            return false;
        }
        let s = ordered(self.carrier.s_of(ends[0]), self.carrier.s_of(ends[1]));
        let shared = spans::overlap(s, self.gap).map_or(0.0, spans::length);
        let is_straight = matches!(path, Path::Line { .. }) == self.carrier.is_line();
        is_straight
            && shared >= PANE_COVER * spans::length(self.gap)
            && spans::length(s) < 1.6 * spans::length(self.gap)
    }

    /// What a sash reaches along the gap: a line along the wall, over about half of it.
    fn sash(&self, path: &Path) -> Option<Span> {
        let Path::Line { a, b } = *path else { return None };
        let is_within = [a, b].iter().all(|p| self.carrier.offset_of(*p).abs() <= self.half + COLLINEAR_M);
        let gap_m = spans::length(self.gap);
        let reach = self.reach_of(path).filter(|_| is_within)?;
        (SASH_SHARE[0] * gap_m..=SASH_SHARE[1] * gap_m).contains(&spans::length(reach)).then_some(reach)
    }

    /// An arc about a hinge at a jamb that closes the gap, alone or with its twin.
    fn has_swing(&self, path: &Path) -> bool {
        let Some(swing) = Swing::of_any_size(path) else { return false };
        let Swing { hinge, radius, .. } = swing;
        let width = spans::length(self.gap);
        let s = self.carrier.s_of(hinge);
        let at_jamb = self.gap.iter().any(|g| (g - s).abs() <= FRAME_M);
        let closes = |e: &DVec2| {
            let to = self.carrier.s_of(*e);
            self.has(*e, FRAME_M) && (to - s).abs() > 0.9 * radius
        };
        at_jamb
            && swing.tips().iter().any(closes)
            && self.carrier.offset_of(hinge).abs() <= self.half + FRAME_M
            && radius > 0.35 * width
            && radius < 1.15 * width + 0.05
    }
}

/// What was found in a gap.
#[derive(Debug, Default)]
pub struct Seen {
    pub swing: bool,
    gap_m: f64,
    /// Whether parts of doors lie in it, and whether names call them so.
    door: Option<bool>,
    /// What parts of doors reach along the gap.
    door_spans: Vec<Span>,
    /// The same of windows.
    window: Option<bool>,
    /// What windows reach along the gap.
    window_spans: Vec<Span>,
    panes: bool,
    /// What pieces along the wall that are sashes by their length reach along the gap.
    sash_spans: Vec<Span>,
    /// Indices of [`Drawn::marks`] that belong to the opening.
    pub marks: Vec<u32>,
    /// Indices of [`Drawn::faces`] that lie in it.
    pub faces: Vec<u32>,
}

/// Whether the leaves of a folding door stand before a gap: bent, with both ends at one face of the wall.
fn folds(mark: &Mark, band: &Band) -> bool {
    let [first, .., last] = mark.paths[..] else { return false };
    let is_bent = mark.paths.iter().all(|p| matches!(p, Path::Line { .. }));
    let [from, to] = [first.ends()[0], last.ends()[1]];
    let along = ordered(band.carrier.s_of(from), band.carrier.s_of(to));
    let shared = spans::overlap(along, band.gap).map_or(0.0, spans::length);
    let reach = band.half + FRAME_M;
    is_bent
        && [from, to].iter().all(|p| band.carrier.offset_of(*p).abs() <= reach)
        && shared >= FOLDED_COVER * spans::length(band.gap)
}

/// Whether a door is drawn round the middle of a gap: its frame is let into the jambs and stands before both faces.
fn encloses(mark: &Mark, band: &Band) -> bool {
    let ring: Vec<DVec2> = mark.paths.iter().map(|p| p.ends()[0]).collect();
    let middle = band.carrier.at((band.gap[0] + band.gap[1]) / 2.0);
    ring.len() > 2
        && mark.paths.iter().all(|p| matches!(p, Path::Line { .. }))
        && is_inside_ring(&ring, middle)
}

impl Seen {
    /// Takes a mark as evidence; whether it belongs to the opening.
    fn look_at(&mut self, mark: &Mark, band: &Band) -> bool {
        let swing = mark.paths.iter().any(|p| band.has_swing(p));
        let closes = |p: &Path| {
            mark.role == Role::Door
                && matches!(p, Path::Arc { .. })
                && p.ends().iter().any(|e| band.has(*e, ERROR_GAP_M))
        };
        let inside = mark.paths.iter().any(|p| band.holds(p) || closes(p))
            || mark.role == Role::Door && (folds(mark, band) || encloses(mark, band));
        // Outlines of rooms and furniture run just beside a wall's faces.
        let panes = mark.paths.iter().any(|p| band.has_pane(p, COLLINEAR_M));
        self.sash_spans.extend(mark.paths.iter().filter_map(|p| band.sash(p)));
        let shows_window = mark.paths.iter().any(|p| band.holds(p) && !band.is_on_jamb(p));
        self.swing |= swing;
        if mark.role == Role::Door && (inside || swing) {
            self.door_spans.extend(mark.paths.iter().filter_map(|p| band.reach_of(p)));
        }
        if matches!(mark.role, Role::Window | Role::Glazing) && shows_window {
            self.window_spans.extend(mark.paths.iter().filter_map(|p| band.reach_of(p)));
        }
        match mark.role {
            Role::Door if inside || swing => self.door = self.door.max(Some(mark.is_named)),
            Role::Window | Role::Glazing if shows_window => {
                self.window = self.window.max(Some(mark.is_named));
            }
            Role::Unknown if panes => {
                self.panes = true;
                return true;
            }
            _ => return swing || inside,
        };
        true
    }

    /// What the opening is, and what shows it.
    pub fn verdict(&self) -> (OpeningKind, Shown) {
        let by = |is_named: bool| if is_named { Shown::Name } else { Shown::Shape };
        let reach_m = |of: &Vec<Span>| -> f64 {
            spans::joined(of.clone(), ERROR_GAP_M).into_iter().map(spans::length).sum()
        };
        if self.swing {
            return (OpeningKind::Door, Shown::Swing);
        }
        let doors_m = reach_m(&self.door_spans);
        if let Some(is_named) = self.door.filter(|_| doors_m >= DOOR_COVER * self.gap_m) {
            return (OpeningKind::Door, by(is_named));
        }
        // Beyond the end of a wide gap another wall may begin that has nothing to do with the window.
        let is_filled = self.gap_m <= PASSAGE_MAX_M || reach_m(&self.window_spans) >= PANE_COVER * self.gap_m;
        let has_sashes = reach_m(&self.sash_spans) >= SASHES_COVER * self.gap_m;
        if let Some(is_named) = self.window.filter(|_| is_filled) {
            let shown = if has_sashes && !is_named { Shown::Sashes } else { by(is_named) };
            return (OpeningKind::Window, shown);
        }
        if self.panes {
            return (OpeningKind::Window, if has_sashes { Shown::Sashes } else { Shown::Panes });
        }
        (OpeningKind::Passage, Shown::Nothing)
    }
}
