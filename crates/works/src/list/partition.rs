//! What is done to a partition as a whole: it goes, its doors grow, are walled up, or hang elsewhere.

use std::collections::BTreeMap;

use enfilade_brief::WorkKind;

use super::{Finder, Pair, Run, WIDTHS_M, Work, Works, best, same};
use crate::blocked::blocked_m;
use crate::change::Change;
use crate::counts::{STEP_M, Shows, counts};
use crate::marks::Word;
use crate::rooms::RoomId;
use crate::rule::Rule;
use crate::walls::{Chain, Wall, WallEnd, WallId, is_way};
use enfilade_engine::geometry::Segment;

impl Finder<'_> {
    /// What is done to a whole partition: it goes, its doors grow, close, or hang elsewhere.
    pub(super) fn in_chain(&self, chain: &Chain) -> Works {
        let mut out = Works::default();
        let line = self.line(chain);
        self.removed(chain, &line, &mut out);
        for &opening in &chain.openings {
            self.changed_opening(chain, &line, opening, &mut out);
        }
        out
    }

    /// A chain as one wall: from its first end to its last.
    fn line(&self, chain: &Chain) -> Wall {
        let walls = self.site.walls;
        let [(a, ae), (b, be)] = chain.ends;
        let end_of = |w: WallId, e: usize| {
            let wall = &walls[w.0];
            (wall.point(if e == 0 { 0.0 } else { wall.length_m }, 0.0), wall.ends[e])
        };
        let ((at, first), (to, last)) = (end_of(a, ae), end_of(b, be));
        let thickness_m = chain.walls.iter().map(|w| walls[w.0].thickness_m).fold(0.0, f64::max);
        Wall {
            at,
            along: (to - at).normalize_or(walls[a.0].along),
            length_m: at.distance(to),
            thickness_m,
            ends: [first, last],
            ..walls[a.0].clone()
        }
    }

    fn removed(&self, chain: &Chain, line: &Wall, out: &mut Works) {
        let plan = self.site.present.plan;
        let keep = |end: WallEnd| if let WallEnd::Joint(reach) = end { reach } else { -0.05 * self.scale() };
        let stretch = [keep(line.ends[0]), line.length_m - keep(line.ends[1])];
        if stretch[1] - stretch[0] < WIDTHS_M[0] * self.scale() || !self.is_between_rooms(line, stretch) {
            return;
        }
        let Some(pair) = self.main_pair(line, stretch) else { return };
        let through = self.site.present.through(line, stretch);
        let ends = stretch.map(|t| line.point(t, 0.0));
        let word = self.word(WorkKind::Remove, stretch[1] - stretch[0], ends, &chain.walls);
        let mut forbidden_by = word.rules(self.rules(&chain.walls, pair));
        if through.iter().any(|t| t.shows == Shows::Openly)
            && word != Word::Granted
            && !forbidden_by.iter().any(|r| matches!(r, Rule::Private(_)))
        {
            forbidden_by.push(Rule::ShowsPrivate);
        }
        let open: f64 =
            chain.openings.iter().map(|o| self.site.axes.openings[*o].width_m * self.scale()).sum();
        let length = stretch[1] - stretch[0];
        // Where it met other walls, their faces are made good; an end at an opening leaves nothing.
        let is_met = line.ends.map(|end| matches!(end, WallEnd::Joint(_)));
        let built = line.jambs(plan, stretch).into_iter().zip(is_met).filter(|(_, met)| *met);
        out.tried += 1;
        out.legal += usize::from(forbidden_by.is_empty());
        out.works.push(Work {
            kind: WorkKind::Remove,
            walls: chain.walls.clone(),
            opening: None,
            stretch: ends,
            width_m: length,
            rooms: pair,
            change: Change {
                demolished: vec![line.quad(plan, stretch)],
                built: built.map(|(jamb, _)| jamb).collect(),
            },
            demolished_m: length - open,
            built_m: 0.0,
            gained: through.iter().map(|t| i64::from(t.weight)).sum(),
            shows_through_doors: through.iter().any(|t| t.shows == Shows::ThroughDoors),
            forbidden_by,
        });
    }

    /// The pair of rooms that most of a stretch has; none where a private one or none stands at any of it.
    fn main_pair(&self, line: &Wall, [from, to]: [f64; 2]) -> Option<Pair> {
        let p = &self.site.present;
        let steps = ((to - from) / (STEP_M * self.scale())).ceil().max(1.0) as usize;
        let mut counted: BTreeMap<Pair, usize> = BTreeMap::new();
        for i in 0..steps {
            let at = from + (to - from) * (i as f64 + 0.5) / steps as f64;
            *counted.entry(line.rooms_at(p.plan, p.rooms, at)).or_default() += 1;
        }
        let is_private = |r: &Option<RoomId>| r.is_some_and(|r| p.rooms[r.0].kind.is_private());
        let rank = |pair: &Pair, n: usize| (pair.iter().any(Option::is_none), pair.iter().any(is_private), n);
        // A short piece at a private room forbids the whole.
        let worst = counted.iter().filter(|(_, n)| **n * 10 > steps).max_by_key(|(pair, n)| rank(pair, **n));
        worst.map(|(pair, _)| *pair)
    }

    fn changed_opening(&self, chain: &Chain, line: &Wall, index: usize, out: &mut Works) {
        let (scale, plan) = (self.scale(), self.site.present.plan);
        let opening = &self.site.axes.openings[index];
        if !is_way(opening.kind) {
            return;
        }
        let along = |p: glam::DVec2| (p * scale - line.at).dot(line.along);
        let [mut from, mut to] = opening.jambs.map(|j| along(j.at));
        if from > to {
            (from, to) = (to, from);
        }
        let Some(pair) = self.pair(line, [from, to]) else { return };
        self.widened(chain, line, (index, [from, to]), pair, out);
        let [Some(a), Some(b)] = pair else { return };
        let faces = |v: f64| Segment {
            a: plan.frame.um_from_plan(line.point(from, v)),
            b: plan.frame.um_from_plan(line.point(to, v)),
        };
        let half = line.thickness_m / 2.0;
        let mut built = vec![faces(half)];
        if half > 0.0 {
            built.push(faces(-half));
        }
        let change = Change { demolished: Vec::new(), built };
        let present = &self.site.present;
        let lost = present.gained(&present.difference(&change));
        let ways = |r: RoomId| self.ways(r);
        let last: Vec<Rule> = [a, b].into_iter().filter(|r| ways(*r) <= 1).map(Rule::LastDoor).collect();
        let ends = [line.point(from, 0.0), line.point(to, 0.0)];
        let forbidden_by = self.word(WorkKind::Close, to - from, ends, &chain.walls).rules(last);
        out.tried += 1;
        out.legal += usize::from(forbidden_by.is_empty());
        out.works.push(Work {
            kind: WorkKind::Close,
            walls: chain.walls.clone(),
            opening: Some(index),
            stretch: ends,
            width_m: to - from,
            rooms: pair,
            change: change.clone(),
            demolished_m: 0.0,
            built_m: to - from,
            gained: lost,
            shows_through_doors: false,
            forbidden_by,
        });
        self.rehung(chain, (index, [from, to]), pair, (&change, lost), out);
    }

    /// Doors and passages of a room.
    fn ways(&self, room: RoomId) -> usize {
        let p = &self.site.present;
        let (axes, scale) = (self.site.axes, self.scale());
        let off = |o: &enfilade_plan::axes::Opening| {
            let [a, b] = o.jambs.map(|j| j.at * scale);
            let across = (b - a).normalize_or_zero().perp() * (o.thickness_m / 2.0 + 0.25) * scale;
            let middle = a.midpoint(b);
            [middle + across, middle - across]
                .map(|q| crate::rooms::room_at(p.rooms, p.plan.frame.um_from_plan(q)))
        };
        axes.openings.iter().filter(|o| is_way(o.kind)).filter(|o| off(o).contains(&Some(room))).count()
    }

    fn widened(&self, chain: &Chain, line: &Wall, at: (usize, [f64; 2]), pair: Pair, out: &mut Works) {
        let (index, [from, to]) = at;
        let (scale, plan) = (self.scale(), self.site.present.plan);
        // Wall that may go to either side: up to what is kept at the far end of the piece beside the opening.
        let limits = self.limits(chain, line, [from, to]);
        if limits[1] - limits[0] < to - from + 0.2 * scale {
            return;
        }
        let through = self.site.present.through(line, limits);
        let blocked = blocked_m(plan, line);
        for width_m in self.widths_m().into_iter().filter(|w| *w > to - from + 0.15 * scale) {
            let step_m = STEP_M * scale;
            let least = (to - width_m).max(limits[0]);
            // From the present jamb on in whole steps, so that one side can stay.
            let first = from - ((from - least) / step_m + 1e-6).floor() * step_m;
            let most = from.min(limits[1] - width_m);
            if most < first - 1e-9 {
                continue;
            }
            let places = ((most - first) / step_m + 1e-6).floor() as usize + 1;
            let found = counts(&through, first, step_m, places, width_m);
            let by_default = self.rules(&chain.walls, pair);
            let stretch_of = |k: usize| [0.0, width_m].map(|t| first + k as f64 * step_m + t);
            let word = |k: usize| {
                let ends = stretch_of(k).map(|t| line.point(t, 0.0));
                self.word(WorkKind::Widen, width_m, ends, &chain.walls)
            };
            let words: Vec<(Word, bool)> =
                (0..places).map(|k| (word(k), self.is_blocked(&blocked, stretch_of(k)))).collect();
            let rules = |(word, is_blocked): (Word, bool)| {
                word.rules(by_default.iter().copied().chain(is_blocked.then_some(Rule::Blocked)).collect())
            };
            let is_legal = |k: &usize| {
                let is_seen = words[*k].0 != Word::Granted && found.openly[*k] > 0;
                rules(words[*k]).is_empty() && !is_seen
            };
            out.tried += places;
            out.legal += (0..places).filter(is_legal).count();
            // What a mark allows stands before what none does.
            let Some(chosen) = words.iter().min().copied() else { continue };
            let (ks, word): (Vec<usize>, Word) =
                ((0..places).filter(|k| words[*k] == chosen).collect(), chosen.0);
            let Some((k, shows)) = best(&found, &ks) else { continue };
            let stretch = stretch_of(k);
            let mut forbidden_by = rules(chosen);
            if shows == Shows::Openly
                && word != Word::Granted
                && !forbidden_by.iter().any(|r| matches!(r, Rule::Private(_)))
            {
                forbidden_by.push(Rule::ShowsPrivate);
            }
            out.works.push(Work {
                kind: WorkKind::Widen,
                walls: chain.walls.clone(),
                opening: Some(index),
                stretch: stretch.map(|t| line.point(t, 0.0)),
                width_m,
                rooms: pair,
                change: Change {
                    demolished: vec![line.quad(plan, stretch)],
                    built: line.jambs(plan, stretch).to_vec(),
                },
                demolished_m: width_m - (to - from),
                built_m: 0.0,
                gained: found.gained[k] as i64,
                shows_through_doors: shows == Shows::ThroughDoors,
                forbidden_by,
            });
        }
    }

    /// Between where and where an opening may grow.
    fn limits(&self, chain: &Chain, line: &Wall, [from, to]: [f64; 2]) -> [f64; 2] {
        let scale = self.scale();
        let mut limits = [from, to];
        for w in &chain.walls {
            let wall = &self.site.walls[w.0];
            let mut ends = [0.0, wall.length_m].map(|t| (wall.point(t, 0.0) - line.at).dot(line.along));
            let is_turned = ends[0] > ends[1];
            if is_turned {
                ends.swap(0, 1);
            }
            let free = wall.free(scale);
            let free = if is_turned { [wall.length_m - free[1], wall.length_m - free[0]] } else { free };
            let near = 0.05 * scale;
            if (ends[1] - from).abs() < near {
                limits[0] = (ends[0] + free[0]).min(from);
            }
            if (ends[0] - to).abs() < near {
                limits[1] = (ends[0] + free[1]).max(to);
            }
        }
        limits
    }

    /// A door that goes to another place of its wall.
    fn rehung(
        &self,
        chain: &Chain,
        (index, [from, to]): (usize, [f64; 2]),
        pair: Pair,
        (closed, lost): (&Change, i64),
        out: &mut Works,
    ) {
        let plan = self.site.present.plan;
        let width_m = to - from;
        let mut found: Option<Work> = None;
        for id in &chain.walls {
            let wall = &self.site.walls[id.0];
            let [lo, hi] = wall.free(self.scale());
            if hi - lo < width_m {
                continue;
            }
            let through = self.site.present.through(wall, [lo, hi]);
            let step_m = STEP_M * self.scale();
            let places = ((hi - lo - width_m) / step_m + 1e-6).floor() as usize + 1;
            let all = counts(&through, lo, step_m, places, width_m);
            let run = Run { wall, from_m: lo, step_m, width_m };
            let blocked = blocked_m(plan, wall);
            let is_place = |k: &usize| {
                let stretch = run.stretch(*k);
                !self.is_blocked(&blocked, stretch) && self.pair(wall, stretch).is_some_and(|p| same(p, pair))
            };
            let ks: Vec<usize> = (0..places).filter(is_place).collect();
            out.tried += ks.len();
            let Some(k) = ks.into_iter().max_by_key(|k| (all.gained[*k], usize::MAX - k)) else { continue };
            let stretch = run.stretch(k);
            let opened = Change {
                demolished: vec![wall.quad(plan, stretch)],
                built: wall.jambs(plan, stretch).to_vec(),
            };
            let work = Work {
                kind: WorkKind::Rehang,
                walls: vec![*id],
                opening: Some(index),
                stretch: stretch.map(|t| wall.point(t, 0.0)),
                width_m,
                rooms: pair,
                change: opened.and(closed),
                demolished_m: width_m,
                built_m: width_m,
                gained: lost + all.gained[k] as i64,
                shows_through_doors: false,
                forbidden_by: Vec::new(),
            };
            if found.as_ref().is_none_or(|f| f.gained < work.gained) {
                found = Some(work);
            }
        }
        let Some(mut work) = found else { return };
        self.judge_rehung(&mut work, &chain.walls);
        out.legal += usize::from(work.forbidden_by.is_empty());
        out.works.push(work);
    }

    /// A re-hung door is measured as a whole: what both doors show is not their sum. A private room keeps its door, but no
    /// more of it may be seen.
    fn judge_rehung(&self, work: &mut Work, walls: &[WallId]) {
        let p = &self.site.present;
        let difference = p.difference(&work.change);
        work.gained = p.gained(&difference);
        let rules = self.rules(walls, work.rooms).into_iter().filter(|r| !matches!(r, Rule::Private(_)));
        let word = self.word(WorkKind::Rehang, work.width_m, work.stretch, walls);
        work.forbidden_by = word.rules(rules.collect());
        if word != Word::Granted && p.gained_private(&difference) > 0 {
            work.forbidden_by.push(Rule::ShowsPrivate);
        }
    }
}
