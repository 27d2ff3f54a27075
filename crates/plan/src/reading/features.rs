//! What the classifier knows of every piece: measures of the piece, of its neighbours, of what it belongs to, and of
//! what names say. All lengths in metres under the scene's hypothesis of the unit.

use std::collections::HashMap;

use glam::DVec2;
use rayon::prelude::*;

use super::scene::{Arc, CELL_M, Family, NONE, Piece, Scene, Thing, bounds};
use enfilade_cad::roles::Role;

/// Sine of the angle up to which pieces are parallel.
const PARALLEL_SIN: f64 = 0.035;

/// Ends nearer than this meet, metres: drawing errors of a few millimetres.
const MEET_M: f64 = 0.006;

/// Distances of faces that may be a wall's, metres (Neufert: 6 cm boards to 50 cm masonry).
const WALL_M: [f64; 2] = [0.05, 0.52];

/// Stands for a distance to nothing.
const FAR_M: f64 = 9.0;

/// How far gaps in a line are looked over, metres: a double door or a window front.
const GAP_M: f64 = 3.0;

/// Radii and sweeps of what may be the swing of a door, metres.
const SWING_M: [f64; 2] = [0.35, 1.7];
const SWING_RAD: [f64; 2] = [0.5, 3.3];

/// Most neighbours that a piece hangs together with by itself; more hang together by theirs.
const TOUCHING_MAX: usize = 12;

/// Roles whose names are told to the classifier.
pub const NAMED: [Role; 15] = [
    Role::Wall,
    Role::LowWall,
    Role::Glazing,
    Role::Column,
    Role::Door,
    Role::Window,
    Role::Stair,
    Role::Furniture,
    Role::Text,
    Role::Dimension,
    Role::Hatch,
    Role::Grid,
    Role::Site,
    Role::Roof,
    Role::Room,
];

/// What is seen round one piece.
#[derive(Clone, Debug)]
struct Seen {
    nearest: f64,
    overlap: f64,
    ratio: f64,
    same_thing: bool,
    same_group: bool,
    across: f64,
    beyond: f64,
    counts: [u16; 4],
    covered: f64,
    meets: [u16; 2],
    tees: [u16; 2],
    corners: u16,
    onto: u16,
    gaps: [f64; 2],
    hinge: f64,
    tip: f64,
    leaf: f64,
    crowd: u16,
    crowd_m: f64,
    touching: Vec<u32>,
}

/// What the features of the pieces of a scene are made from.
pub struct Features<'s> {
    scene: &'s Scene,
    seen: Vec<Seen>,
    usual: f64,
    component_of: Vec<u32>,
    components: Vec<Component>,
    groups: Vec<Shares>,
    layers: Vec<Shares>,
    beside: Beside,
    near: Near<'s>,
}

/// Lines that hang together by their ends.
#[derive(Clone, Default)]
struct Component {
    pieces: u32,
    length: f64,
    arcs: u32,
    extent: Option<[DVec2; 2]>,
}

impl<'s> Features<'s> {
    /// Looks at a scene.
    pub fn new(scene: &'s Scene) -> Self {
        let swings = Swings::new(scene);
        let seen: Vec<Seen> =
            (0..scene.pieces.len()).into_par_iter().map(|i| look(scene, &swings, i as u32)).collect();
        let (component_of, components) = components(scene, &seen);
        Self {
            scene,
            usual: usual_gap(scene, &seen),
            component_of,
            components,
            groups: Shares::of(scene, &seen, scene.groups.len(), |t| t.group),
            layers: Shares::of(scene, &seen, scene.layers.len(), |t| t.layer),
            beside: Beside::new(scene, &seen),
            near: Near::new(scene),
            seen,
        }
    }

    /// The features of one piece, in the order of [`Self::names`].
    pub fn row(&self, piece: usize) -> Vec<f32> {
        let scene = self.scene;
        let p = &scene.pieces[piece];
        let thing = &scene.things[p.thing as usize];
        let (group, layer) = (thing.group as usize, thing.layer as usize);
        let mut row = Row(Vec::with_capacity(128));
        of_piece(&mut row, p, &self.seen[piece], self.usual);
        of_thing(&mut row, scene, thing, p);
        of_component(&mut row, scene, &self.components[self.component_of[piece] as usize]);
        self.near.add(&mut row, p);
        self.beside.add(&mut row, p);
        of_family(&mut row, scene, &scene.groups[group], &self.groups[group]);
        of_family(&mut row, scene, &scene.layers[layer], &self.layers[layer]);
        let size = scene.extent[1] - scene.extent[0];
        row.add(scene.pieces.len() as f64);
        row.add(size.max_element());
        row.add(size.min_element());
        row.add(scene.groups.len() as f64);
        row.add(scene.layers.len() as f64);
        of_names(&mut row, scene, thing);
        row.0
    }

    /// Names of the features in their order.
    pub fn names() -> Vec<String> {
        let own = "length is_arc radius sweep skew nearest overlap ratio same_thing same_group across beyond regular \
                   n05 n15 n30 n60 covered nearest_by_usual usual meets_min meets_max tees_min tees_max corners onto \
                   free gap_min gap_max hinge tip leaf crowd crowd_m thing_pieces closed thing_long thing_short filled \
                   thing_length share_of_thing is_circle arc_radius arc_sweep dashed_depth in_block block_long \
                   block_short block_pieces block_arcs block_copies block_length comp_pieces comp_long comp_short \
                   comp_share comp_arcs text_near text_digit texts_2m in_fill beside_min beside_next beside_max";
        let family =
            "pieces share mean_length arcs paired aligned closed long free texts fills nearest regular";
        let mut out: Vec<String> = own.split_whitespace().map(Into::into).collect();
        for of in ["group", "layer"] {
            out.extend(family.split_whitespace().map(|f| format!("{of}_{f}")));
        }
        out.extend("all_pieces all_long all_short all_groups all_layers".split(' ').map(Into::into));
        for of in ["layer", "block"] {
            out.extend(NAMED.iter().map(|r| format!("name_{of}_{r:?}")));
        }
        out
    }
}

struct Row(Vec<f32>);

impl Row {
    fn add(&mut self, value: f64) {
        self.0.push(value as f32);
    }

    fn flag(&mut self, is_so: bool) {
        self.0.push(f32::from(u8::from(is_so)));
    }
}

/// What may be swings of doors, by place.
struct Swings {
    arcs: Vec<(Arc, [DVec2; 2])>,
    cells: HashMap<[i64; 2], Vec<u32>>,
}

impl Swings {
    const CELL_M: f64 = 2.0;

    fn new(scene: &Scene) -> Self {
        let is_swing = |arc: &Arc| {
            (SWING_M[0]..=SWING_M[1]).contains(&arc.radius)
                && (SWING_RAD[0]..=SWING_RAD[1]).contains(&arc.sweep_rad)
        };
        let of = |t: &Thing| {
            let arc = t.arc.filter(is_swing)?;
            let own = &scene.pieces[t.pieces.start as usize..t.pieces.end as usize];
            Some((arc, [own.first()?.a, own.last()?.b]))
        };
        let own = scene.things.iter().filter_map(of);
        let in_lines = scene.pieces.iter().filter(|p| scene.things[p.thing as usize].pieces.len() > 1);
        let in_lines = in_lines.filter_map(|p| Some((p.arc.filter(is_swing)?, [p.a, p.b])));
        let arcs: Vec<(Arc, [DVec2; 2])> = own.chain(in_lines).collect();
        let mut cells: HashMap<[i64; 2], Vec<u32>> = HashMap::new();
        for (i, (arc, _)) in arcs.iter().enumerate() {
            cells.entry(Self::cell(arc.centre)).or_default().push(i as u32);
        }
        Self { arcs, cells }
    }

    fn cell(p: DVec2) -> [i64; 2] {
        [p.x, p.y].map(|v| (v / Self::CELL_M).floor() as i64)
    }

    /// Distance to the nearest hinge and tip from either end, and how much longer or shorter than the nearest swing's
    /// radius the piece is, as a share.
    fn look(&self, p: &Piece) -> [f64; 3] {
        let mut out = [FAR_M; 3];
        let [c, r] = Self::cell(p.middle());
        for (c, r) in (c - 1..=c + 1).flat_map(|c| (r - 1..=r + 1).map(move |r| (c, r))) {
            for i in self.cells.get(&[c, r]).into_iter().flatten() {
                let (arc, tips) = &self.arcs[*i as usize];
                let hinge = [p.a, p.b].map(|e| e.distance(arc.centre));
                let hinge = hinge[0].min(hinge[1]);
                if hinge < out[0] {
                    out[0] = hinge;
                    out[2] = (p.length - arc.radius).abs() / arc.radius;
                }
                let tip = tips.iter().flat_map(|t| [p.a, p.b].map(|e| e.distance(*t)));
                out[1] = tip.fold(out[1], f64::min);
            }
        }
        out
    }
}

/// A parallel neighbour.
struct Parallel {
    offset: f64,
    overlap: f64,
    index: u32,
}

/// Everything near a piece.
fn look(scene: &Scene, swings: &Swings, i: u32) -> Seen {
    let p = &scene.pieces[i as usize];
    let near = neighbours(scene, p, i);
    let along = p.along();
    let across = along.perp();
    let mut parallels: Vec<Parallel> = Vec::new();
    let (mut meets, mut tees) = ([0u16; 2], [0u16; 2]);
    let (mut corners, mut onto, mut crowd, mut crowd_m) = (0, 0, 0, 0.0);
    let mut touching = Vec::new();
    for j in near {
        let q = &scene.pieces[j as usize];
        crowd += 1;
        crowd_m += q.length.min(2.0 * CELL_M);
        let mut touches = false;
        for (k, e) in [p.a, p.b].into_iter().enumerate() {
            if q.a.distance(e) <= MEET_M || q.b.distance(e) <= MEET_M {
                meets[k] += 1;
                touches = true;
                corners += u16::from(along.dot(q.along()).abs() < 0.1);
            } else if q.arc.is_none() && off_line(q, e) <= MEET_M {
                tees[k] += 1;
                touches = true;
            }
        }
        if !touches && p.arc.is_none() && [q.a, q.b].iter().any(|e| off_line(p, *e) <= MEET_M) {
            onto += 1;
            touches = true;
        }
        if touches && touching.len() < TOUCHING_MAX {
            touching.push(j);
        }
        let is_parallel =
            p.arc.is_none() && q.arc.is_none() && along.perp_dot(q.along()).abs() < PARALLEL_SIN;
        if is_parallel {
            let offset = across.dot(q.middle() - p.a);
            let (s, t) = (along.dot(q.a - p.a), along.dot(q.b - p.a));
            let overlap = p.length.min(s.max(t)) - s.min(t).max(0.0);
            if offset.abs() > 0.002 && offset.abs() <= CELL_M && overlap >= 0.3 * p.length.min(q.length) {
                parallels.push(Parallel { offset, overlap, index: j });
            }
        }
    }
    let [hinge, tip, leaf] = swings.look(p);
    let mut seen = Seen {
        nearest: FAR_M,
        overlap: 0.0,
        ratio: 0.0,
        same_thing: false,
        same_group: false,
        across: FAR_M,
        beyond: FAR_M,
        counts: [0; 4],
        covered: 0.0,
        meets,
        tees,
        corners,
        onto,
        gaps: [FAR_M; 2],
        hinge,
        tip,
        leaf,
        crowd,
        crowd_m,
        touching,
    };
    if p.arc.is_none() {
        add_parallels(scene, p, &mut parallels, &mut seen);
        seen.gaps = gaps(scene, p, i);
    }
    seen
}

fn add_parallels(scene: &Scene, p: &Piece, parallels: &mut [Parallel], seen: &mut Seen) {
    parallels.sort_by(|x, y| x.offset.abs().total_cmp(&y.offset.abs()).then(x.index.cmp(&y.index)));
    let thing = &scene.things[p.thing as usize];
    let Some(first) = parallels.first() else { return };
    let q = &scene.pieces[first.index as usize];
    seen.nearest = first.offset.abs();
    seen.overlap = (first.overlap / p.length).min(1.0);
    seen.ratio = p.length.min(q.length) / p.length.max(q.length);
    seen.same_thing = q.thing == p.thing;
    seen.same_group = scene.things[q.thing as usize].group == thing.group;
    let is_same_side = |x: &&Parallel| (x.offset > 0.0) == (first.offset > 0.0);
    let other = parallels.iter().find(|x| !is_same_side(x));
    seen.across = other.map_or(FAR_M, |x| x.offset.abs());
    let next = parallels.iter().filter(is_same_side).find(|x| x.offset.abs() > seen.nearest + 0.004);
    seen.beyond = next.map_or(FAR_M, |x| x.offset.abs());
    for (count, reach) in seen.counts.iter_mut().zip([0.05, 0.15, 0.3, 0.6]) {
        *count = parallels.iter().take_while(|x| x.offset.abs() <= reach).count() as u16;
    }
    let is_wall = |x: &&Parallel| (WALL_M[0]..=WALL_M[1]).contains(&x.offset.abs());
    seen.covered = (parallels.iter().filter(is_wall).map(|x| x.overlap).sum::<f64>() / p.length).min(1.0);
}

/// Distance from a straight piece's inside; far beyond its ends.
fn off_line(q: &Piece, e: DVec2) -> f64 {
    let along = q.along();
    let s = along.dot(e - q.a);
    if (0.0..=q.length).contains(&s) { along.perp_dot(e - q.a).abs() } else { f64::INFINITY }
}

/// Pieces near one, each once, ascending.
fn neighbours(scene: &Scene, p: &Piece, i: u32) -> Vec<u32> {
    let mut near = Vec::new();
    let steps = (p.length / scene.cell()).ceil().max(1.0) as usize;
    for k in 0..=steps {
        let at = match p.arc {
            None => p.a.lerp(p.b, k as f64 / steps as f64),
            Some(arc) => {
                let turn = arc.sweep_rad * k as f64 / steps as f64;
                arc.centre + DVec2::from_angle(turn).rotate(p.a - arc.centre)
            }
        };
        scene.around(at, |j| near.push(j));
    }
    near.sort_unstable();
    near.dedup();
    near.retain(|j| *j != i);
    near
}

/// How far a line goes on beyond either end, the smaller first.
fn gaps(scene: &Scene, p: &Piece, i: u32) -> [f64; 2] {
    let along = p.along();
    let mut out = [FAR_M; 2];
    for (k, (from, out_of)) in [(p.b, along), (p.a, -along)].into_iter().enumerate() {
        let steps = (GAP_M / scene.cell()).ceil() as usize;
        for s in 0..=steps {
            let at = from + out_of * (s as f64 * scene.cell()).min(GAP_M);
            scene.at(at, |j| {
                let q = &scene.pieces[j as usize];
                if j == i || q.arc.is_some() || along.perp_dot(q.along()).abs() > PARALLEL_SIN {
                    return;
                }
                let (d, e) = (q.a - from, q.b - from);
                let is_in_line = along.perp_dot(d).abs() <= 0.01 && along.perp_dot(e).abs() <= 0.02;
                let gap = out_of.dot(d).min(out_of.dot(e));
                if is_in_line && gap >= -MEET_M && gap < out[k] && gap <= GAP_M {
                    out[k] = gap.max(0.0);
                }
            });
            if out[k] < FAR_M {
                break;
            }
        }
    }
    [out[0].min(out[1]), out[0].max(out[1])]
}

fn components(scene: &Scene, seen: &[Seen]) -> (Vec<u32>, Vec<Component>) {
    let mut root: Vec<u32> = (0..seen.len() as u32).collect();
    fn find(root: &mut [u32], mut i: u32) -> u32 {
        while root[i as usize] != i {
            root[i as usize] = root[root[i as usize] as usize];
            i = root[i as usize];
        }
        i
    }
    let join = |root: &mut Vec<u32>, i: u32, j: u32| {
        let (a, b) = (find(root, i), find(root, j));
        root[a.max(b) as usize] = a.min(b);
    };
    for (i, s) in seen.iter().enumerate() {
        s.touching.iter().for_each(|j| join(&mut root, i as u32, *j));
    }
    for t in &scene.things {
        (t.pieces.start + 1..t.pieces.end).for_each(|i| join(&mut root, i - 1, i));
    }
    let mut components = vec![Component::default(); seen.len()];
    let of: Vec<u32> = (0..seen.len() as u32).map(|i| find(&mut root, i)).collect();
    for (i, p) in scene.pieces.iter().enumerate() {
        let c = &mut components[of[i] as usize];
        c.pieces += 1;
        c.length += p.length;
        c.arcs += u32::from(p.arc.is_some());
        c.extent = bounds(c.extent.into_iter().flatten().chain([p.a, p.b]));
    }
    (of, components)
}

/// The distance at which most length has its other face, metres, in steps of a centimetre; 0.15 where nothing has.
fn usual_gap(scene: &Scene, seen: &[Seen]) -> f64 {
    let mut sums = [0.0; 60];
    for (p, s) in scene.pieces.iter().zip(seen).filter(|(_, s)| s.nearest >= WALL_M[0] && s.nearest < 0.595) {
        sums[(s.nearest * 100.0).round() as usize] += p.length.min(4.0);
    }
    let most = (0..60).max_by(|i, j| sums[*i].total_cmp(&sums[*j]).then(j.cmp(i))).unwrap_or(15);
    if sums[most] > 0.0 { most as f64 / 100.0 } else { 0.15 }
}

/// Shares of the pieces of a family.
#[derive(Clone, Default)]
struct Shares {
    length: f64,
    paired: f64,
    aligned: f64,
    closed: f64,
    free: f64,
    ends: f64,
    nearest: f64,
    regular: f64,
}

impl Shares {
    fn of(scene: &Scene, seen: &[Seen], count: usize, family: impl Fn(&Thing) -> u32) -> Vec<Self> {
        let mut out = vec![Self::default(); count];
        for (p, s) in scene.pieces.iter().zip(seen) {
            let thing = &scene.things[p.thing as usize];
            let o = &mut out[family(thing) as usize];
            o.length += p.length;
            o.paired += p.length * s.covered;
            o.aligned += if p.arc.is_none() && skew(p) < 0.01 { p.length } else { 0.0 };
            o.closed += if thing.is_closed { p.length } else { 0.0 };
            o.ends += 2.0;
            o.free += free_ends(s);
            o.nearest += p.length * s.nearest;
            o.regular += p.length * regular(s).min(1.0);
        }
        out
    }
}

/// How far a piece is from running along or across the drawing: the smaller of sine and cosine.
fn skew(p: &Piece) -> f64 {
    let d = p.along().abs();
    d.min_element()
}

fn free_ends(s: &Seen) -> f64 {
    (0..2).filter(|k| s.meets[*k] == 0 && s.tees[*k] == 0).count() as f64
}

/// How far from even the distances to the next two lines on one side are, as a share.
fn regular(s: &Seen) -> f64 {
    if s.beyond >= FAR_M { FAR_M } else { (s.beyond - 2.0 * s.nearest).abs() / s.nearest }
}

fn of_piece(row: &mut Row, p: &Piece, s: &Seen, usual: f64) {
    row.add(p.length);
    row.flag(p.arc.is_some());
    row.add(p.arc.map_or(0.0, |a| a.radius));
    row.add(p.arc.map_or(0.0, |a| a.sweep_rad));
    row.add(skew(p));
    row.add(s.nearest);
    row.add(s.overlap);
    row.add(s.ratio);
    row.flag(s.same_thing);
    row.flag(s.same_group);
    row.add(s.across);
    row.add(s.beyond);
    row.add(regular(s));
    s.counts.iter().for_each(|c| row.add(f64::from(*c)));
    row.add(s.covered);
    row.add(s.nearest / usual);
    row.add(usual);
    for ends in [s.meets, s.tees] {
        row.add(f64::from(ends[0].min(ends[1])));
        row.add(f64::from(ends[0].max(ends[1])));
    }
    row.add(f64::from(s.corners));
    row.add(f64::from(s.onto));
    row.add(free_ends(s));
    s.gaps.iter().for_each(|g| row.add(*g));
    row.add(s.hinge);
    row.add(s.tip);
    row.add(s.leaf);
    row.add(f64::from(s.crowd));
    row.add(s.crowd_m);
}

fn of_thing(row: &mut Row, scene: &Scene, t: &Thing, p: &Piece) {
    let size = t.extent[1] - t.extent[0];
    row.add(f64::from(t.pieces.end - t.pieces.start));
    row.flag(t.is_closed);
    row.add(size.max_element());
    row.add(size.min_element());
    let ground = size.element_product();
    row.add(if ground > 0.0 { t.area / ground } else { 0.0 });
    row.add(t.length);
    row.add(p.length / t.length);
    row.flag(t.is_circle);
    row.add(t.arc.map_or(0.0, |a| a.radius));
    row.add(t.arc.map_or(0.0, |a| a.sweep_rad));
    row.add(f64::from(t.depth));
    row.flag(t.block != NONE);
    let none = Family::default();
    let block = scene.blocks.get(t.block as usize).unwrap_or(&none);
    let size = block.extent.map_or(DVec2::ZERO, |[lo, hi]| hi - lo);
    row.add(size.max_element());
    row.add(size.min_element());
    row.add(f64::from(block.pieces));
    row.add(f64::from(block.arcs));
    row.add(f64::from(block.copies));
    row.add(block.length / scene.length);
}

fn of_component(row: &mut Row, scene: &Scene, c: &Component) {
    let size = c.extent.map_or(DVec2::ZERO, |[lo, hi]| hi - lo);
    row.add(f64::from(c.pieces));
    row.add(size.max_element());
    row.add(size.min_element());
    row.add(c.length / scene.length);
    row.add(f64::from(c.arcs) / f64::from(c.pieces));
}

fn of_family(row: &mut Row, scene: &Scene, f: &Family, s: &Shares) {
    let length = s.length.max(f64::MIN_POSITIVE);
    let size = f.extent.map_or(DVec2::ZERO, |[lo, hi]| hi - lo);
    row.add(f64::from(f.pieces));
    row.add(f.length / scene.length);
    row.add(s.length / f64::from(f.pieces.max(1)));
    row.add(f64::from(f.arcs) / f64::from(f.pieces.max(1)));
    row.add(s.paired / length);
    row.add(s.aligned / length);
    row.add(s.closed / length);
    row.add(size.max_element() / (scene.extent[1] - scene.extent[0]).max_element().max(f64::MIN_POSITIVE));
    row.add(s.free / s.ends.max(1.0));
    row.add(f64::from(f.texts));
    row.add(f64::from(f.fills));
    row.add(s.nearest / length);
    row.add(s.regular / length);
}

fn of_names(row: &mut Row, scene: &Scene, t: &Thing) {
    let layer = scene.layers[t.layer as usize].role;
    let block = scene.blocks.get(t.block as usize).and_then(|b| b.role);
    for role in [layer, block] {
        NAMED.iter().for_each(|r| row.flag(role == Some(*r)));
    }
}

/// Texts and filled areas near a piece.
struct Near<'s> {
    scene: &'s Scene,
    texts: HashMap<[i64; 2], Vec<u32>>,
    fills: HashMap<[i64; 2], Vec<u32>>,
}

impl<'s> Near<'s> {
    /// Side of a cell, metres; larger areas are not asked.
    const CELL_M: f64 = 2.0;
    const AREA_CELLS_MAX: i64 = 400;

    fn new(scene: &'s Scene) -> Self {
        let mut out = Self { scene, texts: HashMap::new(), fills: HashMap::new() };
        for (i, (at, _)) in scene.texts.iter().enumerate() {
            out.texts.entry(Self::cell(*at)).or_default().push(i as u32);
        }
        for (i, ring) in scene.fills.iter().enumerate() {
            let Some([lo, hi]) = bounds(ring.iter().copied()).map(|b| b.map(Self::cell)) else { continue };
            if (hi[0] - lo[0] + 1).saturating_mul(hi[1] - lo[1] + 1) > Self::AREA_CELLS_MAX {
                continue;
            }
            for (c, r) in (lo[0]..=hi[0]).flat_map(|c| (lo[1]..=hi[1]).map(move |r| (c, r))) {
                out.fills.entry([c, r]).or_default().push(i as u32);
            }
        }
        out
    }

    fn cell(p: DVec2) -> [i64; 2] {
        [p.x, p.y].map(|v| (v / Self::CELL_M).floor() as i64)
    }

    fn add(&self, row: &mut Row, p: &Piece) {
        let middle = p.middle();
        let [c, r] = Self::cell(middle);
        let (mut nearest, mut is_digit, mut count) = (FAR_M, false, 0);
        for (c, r) in (c - 1..=c + 1).flat_map(|c| (r - 1..=r + 1).map(move |r| (c, r))) {
            for i in self.texts.get(&[c, r]).into_iter().flatten() {
                let (at, digit) = self.scene.texts[*i as usize];
                let d = at.distance(middle);
                count += u32::from(d <= Self::CELL_M);
                if d < nearest {
                    (nearest, is_digit) = (d, digit);
                }
            }
        }
        row.add(nearest);
        row.flag(is_digit);
        row.add(f64::from(count));
        // A hand beside the line on either side.
        let across = p.along().perp() * 0.03;
        let sides = [middle + across, middle - across].into_iter().filter(|q| {
            let fills = self.fills.get(&Self::cell(*q)).into_iter().flatten().take(32);
            fills.into_iter().any(|i| encloses(&self.scene.fills[*i as usize], *q))
        });
        row.add(sides.count() as f64);
    }
}

fn encloses(ring: &[DVec2], p: DVec2) -> bool {
    let mut is_in = false;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
            is_in = !is_in;
        }
    }
    is_in
}

/// How much looks like a wall to the left, right, above and below, in bands: what lies inside a plan has walls all
/// round.
struct Beside {
    origin: DVec2,
    band: f64,
    cols: usize,
    rows: usize,
    /// Running sums along each row and along each column.
    by_row: Vec<u32>,
    by_col: Vec<u32>,
}

impl Beside {
    const BANDS_MAX: f64 = 400.0;

    fn new(scene: &Scene, seen: &[Seen]) -> Self {
        let [lo, hi] = scene.extent;
        let size = hi - lo;
        let band = 1.0_f64.max(size.max_element() / Self::BANDS_MAX);
        let count = |s: f64| (s / band) as usize + 1;
        let (cols, rows) = (count(size.x), count(size.y));
        let mut is_wall = vec![false; cols * rows];
        let mut out = Self { origin: lo, band, cols, rows, by_row: Vec::new(), by_col: Vec::new() };
        for (p, s) in scene.pieces.iter().zip(seen).filter(|(p, s)| s.covered > 0.5 && p.length > 0.3) {
            let steps = (p.length / band).ceil().max(1.0) as usize;
            for k in 0..=steps {
                let [c, r] = out.cell(p.a.lerp(p.b, k as f64 / steps as f64));
                is_wall[c * rows + r] |= s.regular_or_wall();
            }
        }
        out.by_col = vec![0; (cols + 1) * (rows + 1)];
        out.by_row = vec![0; (cols + 1) * (rows + 1)];
        for c in 0..cols {
            for r in 0..rows {
                let wall = u32::from(is_wall[c * rows + r]);
                out.by_col[c * (rows + 1) + r + 1] = out.by_col[c * (rows + 1) + r] + wall;
                out.by_row[(c + 1) * (rows + 1) + r] = out.by_row[c * (rows + 1) + r] + wall;
            }
        }
        out
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let k = |v: f64, n: usize| ((v / self.band).max(0.0) as usize).min(n - 1);
        let d = p - self.origin;
        [k(d.x, self.cols), k(d.y, self.rows)]
    }

    fn add(&self, row: &mut Row, p: &Piece) {
        let [c, r] = self.cell(p.middle());
        let n = self.rows + 1;
        let below = self.by_col[c * n + r];
        let above = self.by_col[c * n + self.rows] - self.by_col[c * n + r + 1];
        let left = self.by_row[c * n + r];
        let right = self.by_row[self.cols * n + r] - self.by_row[(c + 1) * n + r];
        let mut all = [below, above, left, right];
        all.sort_unstable();
        row.add(f64::from(all[0]));
        row.add(f64::from(all[1]));
        row.add(f64::from(all[3]));
    }
}

impl Seen {
    /// Whether its neighbours are a wall's other face rather than one of many even lines.
    fn regular_or_wall(&self) -> bool {
        self.counts[3] <= 4 && self.nearest <= WALL_M[1]
    }
}
