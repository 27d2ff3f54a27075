//! Pairs of faces: two runs that face each other at a wall's thickness are the sides of a strip of wall.
//!
//! Between neighbouring parallel runs lie *cells*, of wall or of air. A face has wall on one side and air
//! on the other, so cells of wall are chosen thinnest first (thicknesses that the drawing has much of
//! before others), and a cell next to a chosen one is air, or a layer of finish if it is thin.

use glam::DVec2;

use super::Drawn;
use super::carrier::Carrier;
use super::cell::Cell;
use super::near::Buckets;
use super::rows;
use super::runs::Run;
use super::solids::{Known, Solids};
use super::spans::{self, Span};
use crate::sizes::{
    COLLINEAR_M, CONCENTRIC_M, ERROR_GAP_M, FINISH_MAX_M, LAYER_MAX_M, LAYERED_MAX_M, SKEW_RAD,
    THICKNESS_MAX_M, THICKNESS_MIN_M, THICKNESS_USUAL_M,
};

/// Width of the bins in which thicknesses are counted.
const BIN_M: f64 = 0.01;
/// A thickness with at least this share of all facing length is one that the drawing has much of.
const COMMON_SHARE: f64 = 0.08;
/// A rare large thickness needs at least this share of all facing length.
const THICK_SHARE: f64 = 0.04;
/// A layer follows at least this share of the wall beside it.
const LAYER_COVER: f64 = 0.6;
/// A stub of wall is at least this long for its thickness.
const STUB_ASPECT: f64 = 0.2;
/// No strip is shorter.
const SHORTEST_M: f64 = 0.01;
/// No strip is shorter as well as thinner: the steps of a reveal with its finish are no walls. Stubs beside doors begin at
/// 0.07 m.
const SMALLEST_M: f64 = 0.065;
/// The thinnest strip between two lines by themselves: a pane.
const PANE_MIN_M: f64 = 0.006;
/// The shortest pane.
const PANE_LENGTH_M: f64 = 0.3;

/// A stretch of wall between two faces.
#[derive(Clone, Debug)]
pub struct Strip {
    pub carrier: Carrier,
    pub span: Span,
    pub thickness: f64,
    /// Runs on the positive and on the negative side of the carrier.
    pub sides: [u32; 2],
    /// Further runs of the positive and of the negative side.
    pub more: [Vec<u32>; 2],
    /// Runs between them.
    pub inner: Vec<u32>,
}

/// Runs and the strips between them.
#[derive(Debug)]
pub struct Paired {
    pub runs: Vec<Run>,
    pub strips: Vec<Strip>,
    /// Per run the spans that are a side or a layer of a strip.
    pub used: Vec<Vec<Span>>,
    /// Runs that close a strip's end or lie across it.
    pub is_cap: Vec<bool>,
    /// Runs that stand in rows of equal lines.
    pub in_row: Vec<bool>,
    pub thicknesses: Vec<(f64, f64)>,
}

/// Finds the strips of wall among runs.
pub fn pair(drawn: &Drawn, runs: Vec<Run>) -> Paired {
    let mut cells = cells(&runs);
    let lengths: Vec<f64> = runs.iter().map(Run::length).collect();
    let in_row = rows::find(&lengths, &cells);
    cells.retain(|c| c.runs.iter().all(|r| !in_row[*r as usize]));
    let solids = Solids::new(drawn);
    for c in &mut cells {
        c.known = known_of(&solids, drawn, &runs, c);
    }
    cells.retain(|c| c.known != Known::Air || c.t <= ERROR_GAP_M);
    let mut choice = Choice::new(&runs, &cells);
    let order = choice.order();
    // The end of a stub faces the far side of the wall that it stands at: a wall is taken along its length first.
    for (is_along, aspect) in [(true, 1.0), (false, STUB_ASPECT)] {
        let known = order.iter().filter(|c| cells[**c].known == Known::Wall);
        for c in known.filter(|c| !is_along || is_as_long(cells[**c].span, cells[**c].t)) {
            choice.take(*c, aspect);
        }
        choice.mark_caps();
    }
    for c in order.iter().filter(|c| is_as_long(cells[**c].span, cells[**c].t)) {
        choice.take(*c, 1.0);
    }
    choice.mark_caps();
    for c in &order {
        choice.take(*c, STUB_ASPECT);
    }
    choice.mark_caps();
    choice.add_layers();
    choice.add_panes();
    let (made, used, is_cap) = (choice.made, choice.wall, choice.is_cap);
    let strips: Vec<Strip> = made.iter().map(|m| strip_of(&runs, m)).collect();
    let used = used.into_iter().map(|[a, b]| a.into_iter().chain(b).collect()).collect();
    let thicknesses = thicknesses(&strips);
    Paired { runs, strips, used, is_cap, in_row, thicknesses }
}

/// Whether a span has a length, as far as drawing by hand tells: a stub as long as it is thick counts as such wherever
/// it stands.
fn is_as_long(span: Span, length: f64) -> bool {
    spans::length(span) >= length - COLLINEAR_M
}

fn cells(runs: &[Run]) -> Vec<Cell> {
    let mut buckets = Buckets::new(2.0 * THICKNESS_MAX_M);
    let traces: Vec<Vec<DVec2>> = runs.iter().map(|r| r.carrier.points(r.span)).collect();
    for (i, t) in traces.iter().enumerate() {
        buckets.add(i as u32, t);
    }
    let mut out = Vec::new();
    for (i, r) in runs.iter().enumerate() {
        let mut facing: [Vec<Cell>; 2] = [Vec::new(), Vec::new()];
        for j in buckets.along(&traces[i], THICKNESS_MAX_M) {
            if j as usize != i
                && let Some(c) = facing_cell(i as u32, r, j, &runs[j as usize])
            {
                facing[c.side[0]].push(c);
            }
        }
        for mut side in facing {
            side.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.runs[1].cmp(&b.runs[1])));
            let mut seen: Vec<Span> = Vec::new();
            for c in side {
                if i < c.runs[1] as usize {
                    let open = spans::without(c.span, &seen);
                    out.extend(open.into_iter().map(|span| Cell { span, ..c.clone() }));
                }
                seen.push(c.span);
            }
        }
    }
    out
}

fn known_of(solids: &Solids, drawn: &Drawn, runs: &[Run], c: &Cell) -> Known {
    let [p, q] = c.runs.map(|r| &runs[r as usize]);
    let s = (c.span[0] + c.span[1]) / 2.0;
    let here = p.carrier.at(s);
    let there = q.carrier.s_of(here);
    solids.between(drawn, here.midpoint(q.carrier.at(there)), [(p, s), (q, there)])
}

fn facing_cell(i: u32, p: &Run, j: u32, q: &Run) -> Option<Cell> {
    if p.role != q.role {
        return None;
    }
    match (p.carrier, q.carrier) {
        (Carrier::Line { dir: u, .. }, Carrier::Line { dir: v, .. }) => {
            if u.perp_dot(v).abs() > SKEW_RAD {
                return None;
            }
        }
        (Carrier::Circle { centre: c, .. }, Carrier::Circle { centre: d, .. }) => {
            if c.distance(d) > CONCENTRIC_M {
                return None;
            }
        }
        _ => return None,
    }
    let on_p = p.carrier.span_of(&q.carrier, q.span);
    let span = spans::overlap(p.span, on_p)?;
    let middle = (span[0] + span[1]) / 2.0;
    let foot = q.carrier.at(q.carrier.s_of(p.carrier.at(middle)));
    let offset = spans::tidy(p.carrier.offset_of(foot));
    if !(COLLINEAR_M..=THICKNESS_MAX_M).contains(&offset.abs()) {
        return None;
    }
    let back = q.carrier.offset_of(p.carrier.at(middle));
    let side = [usize::from(offset < 0.0), usize::from(back < 0.0)];
    Some(Cell { runs: [i, j], side, span, t: offset.abs(), known: Known::Nothing })
}

/// A strip as chosen: outer runs with the side on which the strip lies.
#[derive(Clone, Debug)]
struct Made {
    /// The run on whose carrier `span` counts, and the other side's run.
    runs: [u32; 2],
    side: [usize; 2],
    base: u32,
    span: Span,
    inner: Vec<u32>,
    /// Further runs of each side, where layers are interrupted.
    more: [Vec<u32>; 2],
    t: f64,
}

struct Choice<'a> {
    runs: &'a [Run],
    cells: &'a [Cell],
    /// Cells beside each run and side.
    beside: Vec<[Vec<u32>; 2]>,
    /// Per run and side: where wall lies.
    wall: Vec<[Vec<Span>; 2]>,
    bins: Vec<f64>,
    total: f64,
    made: Vec<Made>,
    is_cap: Vec<bool>,
}

impl<'a> Choice<'a> {
    fn new(runs: &'a [Run], cells: &'a [Cell]) -> Self {
        let mut beside: Vec<[Vec<u32>; 2]> = vec![Default::default(); runs.len()];
        let mut bins = vec![0.0; (THICKNESS_MAX_M / BIN_M) as usize + 3];
        let mut total = 0.0;
        for (c, cell) in cells.iter().enumerate() {
            for k in 0..2 {
                beside[cell.runs[k] as usize][cell.side[k]].push(c as u32);
            }
            let length = spans::length(cell.span);
            if cell.t >= THICKNESS_MIN_M && length > 1.5 * cell.t {
                bins[(cell.t / BIN_M) as usize] += length;
                total += length;
            }
        }
        Self {
            runs,
            cells,
            beside,
            wall: vec![Default::default(); runs.len()],
            bins,
            total,
            made: Vec::new(),
            is_cap: vec![false; runs.len()],
        }
    }

    /// Share of the facing length that has about this thickness.
    fn share(&self, t: f64) -> f64 {
        let b = (t / BIN_M) as usize;
        let sum: f64 = self.bins[b.saturating_sub(1)..(b + 2).min(self.bins.len())].iter().sum();
        if self.total > 0.0 { sum / self.total } else { 0.0 }
    }

    /// Cells that may be wall, the likeliest first.
    fn order(&self) -> Vec<usize> {
        let may_be_wall =
            |c: &Cell| c.t >= THICKNESS_MIN_M && (c.t <= THICKNESS_USUAL_M || self.share(c.t) >= THICK_SHARE);
        let may_be_wall = |c: &Cell| may_be_wall(c) && !self.is_finish(c);
        let mut out: Vec<usize> = (0..self.cells.len()).filter(|c| may_be_wall(&self.cells[*c])).collect();
        let key = |c: usize| {
            let cell = &self.cells[c];
            let rare = self.share(cell.t) < COMMON_SHARE;
            (rare, (cell.t / 0.002).round() as i64)
        };
        out.sort_by(|a, b| {
            let longer = spans::length(self.cells[*b].span).total_cmp(&spans::length(self.cells[*a].span));
            key(*a).cmp(&key(*b)).then(longer).then(a.cmp(b))
        });
        out
    }

    /// Whether a thin cell is the finish of a wall that has the same on its other side: then neither is a wall by itself.
    fn is_finish(&self, c: &Cell) -> bool {
        let overlaps = |from: u32, span: Span, to: &Cell| {
            spans::overlap(self.on(from, span, to.runs[0]), to.span).is_some()
        };
        let beyond = |c: &Cell, k: usize| self.beside[c.runs[k] as usize][1 - c.side[k]].iter();
        let cell = |d: &u32| &self.cells[*d as usize];
        let has_twin = |core: &Cell, k: usize| {
            beyond(core, k)
                .map(cell)
                .any(|e| (e.t - c.t).abs() < COLLINEAR_M && overlaps(core.runs[0], core.span, e))
        };
        c.t <= FINISH_MAX_M
            && (0..2).any(|k| {
                let cores = beyond(c, k).map(cell).filter(|d| d.t > c.t && d.t <= THICKNESS_USUAL_M);
                cores.filter(|d| overlaps(c.runs[0], c.span, d)).any(|d| {
                    // On from the core's other side.
                    let far = usize::from(d.runs[0] == c.runs[k]);
                    has_twin(d, far)
                })
            })
    }

    /// A span of the first run on another run.
    fn on(&self, from: u32, span: Span, to: u32) -> Span {
        self.runs[to as usize].carrier.span_of(&self.runs[from as usize].carrier, span)
    }

    /// What of a cell is still free to be wall.
    fn open(&self, cell: &Cell) -> Vec<Span> {
        let [i, j] = cell.runs;
        let mut taken: Vec<Span> = self.wall[i as usize].iter().flatten().copied().collect();
        let there = self.on(i, cell.span, j);
        let on_j = self.wall[j as usize].iter().flatten().filter(|s| spans::overlap(**s, there).is_some());
        taken.extend(on_j.map(|s| self.on(j, *s, i)));
        spans::without(cell.span, &taken)
    }

    fn take(&mut self, c: usize, aspect: f64) {
        let cell = self.cells[c].clone();
        if cell.runs.iter().any(|r| self.is_cap[*r as usize]) {
            return;
        }
        for span in self.open(&cell) {
            let length = spans::length(span);
            let is_one = length >= SHORTEST_M && length.max(cell.t) >= SMALLEST_M;
            if is_as_long(span, aspect * cell.t) && is_one {
                self.make(&cell, span);
            }
        }
    }

    fn make(&mut self, cell: &Cell, span: Span) {
        let [i, j] = cell.runs;
        let mut made = Made {
            runs: cell.runs,
            side: cell.side,
            base: i,
            span,
            inner: Vec::new(),
            more: Default::default(),
            t: cell.t,
        };
        let there = self.on(i, span, j);
        self.wall[i as usize][cell.side[0]].push(span);
        self.wall[j as usize][cell.side[1]].push(there);
        while self.grow(&mut made, FINISH_MAX_M) {}
        self.made.push(made);
    }

    /// Takes in a layer beside the strip, up to `max_m` thick, with nothing of wall behind it. The layer
    /// may be interrupted, so that several runs bound it.
    fn grow(&mut self, made: &mut Made, max_m: f64) -> bool {
        for k in 0..2 {
            let edges: Vec<u32> = std::iter::once(made.runs[k]).chain(made.more[k].iter().copied()).collect();
            let mut layer: Vec<(f64, f64, u32, usize)> = Vec::new();
            for edge in &edges {
                self.layers_at(made, *edge, made.side[k], max_m, &mut layer);
            }
            layer.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
            let Some(t) = layer.first().map(|l| l.0) else { continue };
            layer.retain(|l| l.0 - t < COLLINEAR_M);
            let shared: f64 = layer.iter().map(|l| l.1).sum();
            if shared < LAYER_COVER * spans::length(made.span) {
                continue;
            }
            layer.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.2.cmp(&b.2)));
            for l in &layer {
                let there = self.on(made.base, made.span, l.2);
                self.wall[l.2 as usize][l.3].push(there);
            }
            made.inner.extend(edges);
            (made.runs[k], made.side[k]) = (layer[0].2, layer[0].3);
            made.more[k] = layer[1..].iter().map(|l| l.2).collect();
            made.t += t;
            return true;
        }
        false
    }

    /// Layers beyond one run of a strip: thickness, shared length, far run, its side.
    fn layers_at(
        &self,
        made: &Made,
        edge: u32,
        side: usize,
        max_m: f64,
        out: &mut Vec<(f64, f64, u32, usize)>,
    ) {
        let here = self.on(made.base, made.span, edge);
        for c in &self.beside[edge as usize][1 - side] {
            let cell = &self.cells[*c as usize];
            let me = usize::from(cell.runs[1] == edge);
            let far = cell.runs[1 - me];
            let beside = if me == 0 { cell.span } else { self.on(cell.runs[0], cell.span, edge) };
            let Some(shared) = spans::overlap(beside, here) else { continue };
            let there = self.on(edge, shared, far);
            let is_free = |w: &Vec<Span>| w.iter().all(|s| spans::overlap(*s, there).is_none());
            if cell.t <= max_m
                && made.t + cell.t <= LAYERED_MAX_M
                && self.wall[far as usize].iter().all(is_free)
            {
                out.push((cell.t, spans::length(shared), far, cell.side[1 - me]));
            }
        }
    }

    fn add_layers(&mut self) {
        let mut made = std::mem::take(&mut self.made);
        for m in &mut made {
            while self.grow(m, LAYER_MAX_M.min(0.75 * m.t)) {}
        }
        self.made = made;
    }

    /// Thin pairs that are no layer of anything: panes, boards.
    fn add_panes(&mut self) {
        for c in 0..self.cells.len() {
            let cell = self.cells[c].clone();
            let is_pane = (PANE_MIN_M..THICKNESS_MIN_M).contains(&cell.t);
            let is_free =
                |r: &u32| !self.is_cap[*r as usize] && self.wall[*r as usize].iter().all(Vec::is_empty);
            if is_pane && cell.runs.iter().all(is_free) {
                for span in self.open(&cell) {
                    if spans::length(span) >= PANE_LENGTH_M {
                        self.make(&cell, span);
                    }
                }
            }
        }
    }

    /// Finds the runs that close an end of a strip or lie across it.
    fn mark_caps(&mut self) {
        let strips: Vec<Strip> = self.made.iter().map(|m| strip_of(self.runs, m)).collect();
        let mut buckets = Buckets::new(1.0);
        for (i, s) in strips.iter().enumerate() {
            buckets.add(i as u32, &s.carrier.points(s.span));
        }
        for (r, run) in self.runs.iter().enumerate() {
            if self.is_cap[r] || run.length() > 1.1 * THICKNESS_MAX_M || !run.carrier.is_line() {
                continue;
            }
            let is_used = spans::covered(run.span, &self.wall[r].concat()) > 0.5 * run.length();
            let middle = run.carrier.at((run.span[0] + run.span[1]) / 2.0);
            let near = buckets.near(middle - 0.1, middle + 0.1);
            self.is_cap[r] = !is_used && near.iter().any(|s| is_across(run, middle, &strips[*s as usize]));
        }
    }
}

fn is_across(run: &Run, middle: DVec2, strip: &Strip) -> bool {
    let s = strip.carrier.s_of(middle);
    let ends = run.ends().map(|e| strip.carrier.offset_of(e));
    let across = ends[0].max(ends[1]) - ends[0].min(ends[1]);
    let half = strip.thickness / 2.0;
    s > strip.span[0] - ERROR_GAP_M - half
        && s < strip.span[1] + ERROR_GAP_M + half
        && strip.carrier.offset_of(middle).abs() < half / 2.0 + COLLINEAR_M
        && (across - strip.thickness).abs() < ERROR_GAP_M + 0.1 * strip.thickness
        && across > 0.7 * run.length()
}

fn strip_of(runs: &[Run], made: &Made) -> Strip {
    let base = &runs[made.base as usize].carrier;
    let [p, q] = made.runs.map(|r| runs[r as usize].carrier);
    let foot = |c: &Carrier, s: f64| c.at(c.s_of(base.at(s)));
    let ends = made.span.map(|s| foot(&p, s).midpoint(foot(&q, s)));
    let (carrier, span) = match (p, q) {
        (Carrier::Circle { centre, radius, base_rad }, Carrier::Circle { radius: other, .. }) => {
            let carrier = Carrier::Circle { centre, radius: (radius + other) / 2.0, base_rad };
            (carrier, carrier.span_of(base, made.span))
        }
        _ => (Carrier::line(ends[0], ends[1]), [0.0, ends[0].distance(ends[1])]),
    };
    let middle = (made.span[0] + made.span[1]) / 2.0;
    let upper = carrier.offset_of(foot(&p, middle)) > 0.0;
    let sides = if upper { made.runs } else { [made.runs[1], made.runs[0]] };
    let thickness = spans::tidy(foot(&p, middle).distance(foot(&q, middle)));
    let [a, b] = made.more.clone();
    let more = if upper { [a, b] } else { [b, a] };
    Strip { carrier, span, thickness, sides, more, inner: made.inner.clone() }
}

/// Thicknesses with how much wall has them; what differs by less than a centimetre is one.
fn thicknesses(strips: &[Strip]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = strips.iter().map(|s| (s.thickness, spans::length(s.span))).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (t, l) in all {
        match out.last_mut() {
            Some((mean, sum)) if t - *mean < BIN_M => {
                *mean = (*mean * *sum + t * l) / (*sum + l);
                *sum += l;
            }
            _ => out.push((t, l)),
        }
    }
    out
}
