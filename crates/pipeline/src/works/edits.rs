//! The changes of a file that make a building work, or the words of the side-car that decide it where the file cannot hold
//! it.

use std::collections::BTreeSet;

use glam::DVec2;

use super::fitted;
use crate::understand::building::NamedOpening;
use crate::understand::understood::Understood;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Filling, Format, Mark, Shape, Vertex};
use enfilade_cad::dxf::{Probe, fills_at};
use enfilade_cad::own_layers::DEMOLISHED;
use enfilade_cad::plane::is_inside_ring;
use enfilade_config::WorkTable;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::{DrawnBy, Plan, Wall as Drawn};
use enfilade_works::change::{Quad, inside};
use enfilade_works::walls::{COVER_M, Wall};
use enfilade_works::{Work, WorkKind};

/// Yellow of what is demolished in conversion plans.
const DEMOLISHED_RGB: [u8; 3] = [0xf2, 0xb5, 0x00];
/// A cut face whose ends lie nearer than this to those of a jamb is that jamb, micrometres.
const SAME_UM: f64 = 2_000.0;
/// Shares of a piece below which a part of it is none.
const SHARE_MIN: f64 = 1e-9;

/// How a work is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Written {
    /// Changes of the file.
    pub edits: Vec<Edit>,
    /// What was demolished, on a layer of its own.
    pub additions: Vec<Addition>,
    /// What the side-car decides instead.
    pub tables: Vec<WorkTable>,
    /// Why it does.
    pub why: Option<String>,
}

/// How a work is written into its drawing: by edits where the drawing can hold it, else as a decided work of the side-car.
pub(super) fn written(
    base: &Understood,
    (drawing, bytes): (&Drawing, &[u8]),
    walls: &[Wall],
    work: &Work,
) -> Written {
    let made = match base.plan.format {
        Format::Dxf => in_drawing(base, (drawing, bytes), walls, work),
        Format::Ifc => in_building(base, walls, work),
        Format::Gltf | Format::Glb => Err("openings are not cut into meshes".into()),
    };
    made.unwrap_or_else(|why| beside(&base.plan, walls, work, why))
}

/// A work as the side-car decides it, and why it does.
pub(super) fn beside(plan: &Plan, walls: &[Wall], work: &Work, why: String) -> Written {
    Written { tables: decided(plan, walls, work), why: Some(why), ..Written::default() }
}

/// Lines end at the jambs, the rest and the jambs are new, what goes as a whole changes its layer.
fn in_drawing(
    base: &Understood,
    (drawing, bytes): (&Drawing, &[u8]),
    walls: &[Wall],
    work: &Work,
) -> Result<Written, String> {
    let plan = &base.plan;
    let mut out = Written::default();
    match work.kind {
        WorkKind::Glaze => {
            let panes = fitted::panes(base, drawing, walls, work);
            out.edits.push(panes.ok_or("the drawing shows no window whose like could be drawn")?);
        }
        WorkKind::Door | WorkKind::Rehang => out.edits.extend(fitted::leaf(base, drawing, walls, work)),
        _ => {}
    }
    let mut jambs: Vec<Segment> = work.change.built.clone();
    let mut like = None;
    for wall in plan.walls.iter().filter(|w| meets(w, &work.change.demolished)) {
        if let (DrawnBy::Mark(_), _)
        | (_, Editable::No(_) | Editable::WithInsert { .. } | Editable::Wall { .. }) =
            (wall.drawn_by, &wall.editable)
        {
            let what = format!("{} on layer {:?} cannot be cut", wall.source.kind, wall.source.layer);
            return Err(what);
        }
        let parts = parts(plan, wall, &work.change.demolished, &mut jambs)?;
        let record = wall.source.record;
        like = like.or(Some(record).filter(|_| !parts.is_empty()));
        let gone = work.change.demolished[0].map(|p| plan.frame.file_from_um(p));
        out.edits.push(match parts.is_empty() {
            true => Edit::Drop { record },
            false => Edit::Cut { record, gone, parts, filling: Filling::Nothing },
        });
    }
    for record in doors(base, drawing, work)? {
        if out.edits.iter().all(|e| e.record() != record || matches!(e, Edit::Build { .. })) {
            out.edits.push(Edit::Drop { record });
        }
    }
    let own = || work.walls.iter().flat_map(|w| &walls[w.0].records).copied().next();
    if let Some(record) = like.or_else(own).filter(|_| !jambs.is_empty()) {
        let at = |p: PointUm| plan.frame.file_from_um(p);
        let shapes: Vec<Shape> = jambs.iter().map(|s| Shape::Line { a: at(s.a), b: at(s.b) }).collect();
        out.edits.push(Edit::Build { record, shapes });
    }
    for record in fills(base, bytes, work) {
        let gone = work.change.demolished[0].map(|p| plan.frame.file_from_um(p));
        if out.edits.iter().all(|e| e.record() != record) {
            out.edits.push(cut_whole(record, gone, Filling::Nothing));
        }
    }
    out.additions = work.change.demolished.iter().map(|q| demolished(plan, q)).collect();
    Ok(out)
}

/// A cut of which the file knows itself what stays.
fn cut_whole(record: usize, gone: [DVec2; 4], filling: Filling) -> Edit {
    Edit::Cut { record, gone, parts: Vec::new(), filling }
}

/// An opening voids its wall, with a leaf or a pane where it has one; what goes as a whole says so; new walls stand where
/// others are closed.
fn in_building(base: &Understood, walls: &[Wall], work: &Work) -> Result<Written, String> {
    let plan = &base.plan;
    let file = |q: &Quad| q.map(|p| plan.frame.file_from_um(p));
    let mut out = Written::default();
    let filling = match work.kind {
        WorkKind::Door | WorkKind::Rehang => Filling::Door,
        WorkKind::Glaze => Filling::Glass,
        WorkKind::Remove | WorkKind::End => Filling::Gone,
        _ => Filling::Nothing,
    };
    let records: BTreeSet<usize> = work.walls.iter().flat_map(|w| &walls[w.0].records).copied().collect();
    for record in &records {
        let own: Vec<&Drawn> = plan.walls.iter().filter(|w| w.source.record == *record).collect();
        let is_gone =
            |w: &&Drawn| w.trace.points.iter().all(|p| work.change.demolished.iter().any(|q| holds(q, *p)));
        if work.kind == WorkKind::Remove && own.iter().all(is_gone) {
            out.edits.push(Edit::Drop { record: *record });
            continue;
        }
        let met =
            work.change.demolished.iter().filter(|q| own.iter().any(|w| meets(w, std::slice::from_ref(*q))));
        out.edits.extend(met.map(|q| cut_whole(*record, file(q), filling)));
    }
    let body = walled_up(plan, walls, work);
    if let (Some(body), Some(record)) = (&body, records.first()) {
        let vertices = body.map(|p| Vertex { at: plan.frame.file_from_plan(p), bulge: 0.0 }).to_vec();
        out.edits
            .push(Edit::Build { record: *record, shapes: vec![Shape::Polyline { vertices, closed: true }] });
        for record in hung(base, work) {
            out.edits.push(Edit::Drop { record });
        }
    }
    match out.edits.is_empty() {
        true => Err("no element of the building stands there".into()),
        false => Ok(out),
    }
}

/// The body of what is walled up or built, plan frame.
fn walled_up(plan: &Plan, walls: &[Wall], work: &Work) -> Option<[DVec2; 4]> {
    let half = work.walls.first().map_or(0.0, |w| walls[w.0].thickness_m / 2.0);
    let [a, b] = match work.kind {
        WorkKind::Close | WorkKind::Add => work.stretch,
        // Two faces of what is walled up are built, and two jambs that are shorter.
        WorkKind::Rehang => {
            let at = |p: PointUm| plan.frame.plan_from_um(p);
            let faces = work.change.built.iter().map(|s| [at(s.a), at(s.b)]);
            let mut long: Vec<[DVec2; 2]> = faces.filter(|[p, q]| p.distance(*q) > 2.1 * half).collect();
            let (p, q) = (long.pop()?, long.pop()?);
            [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0]
        }
        _ => return None,
    };
    let off = (b - a).try_normalize()?.perp() * half;
    (half > 0.0).then_some([a - off, b - off, b + off, a + off])
}

/// Records of the doors that a building has in the opening that is walled up.
fn hung(base: &Understood, work: &Work) -> BTreeSet<usize> {
    let opening = work.opening.and_then(|k| base.axes.openings.get(k));
    let Some(opening) = opening else { return BTreeSet::new() };
    let middle = opening.centre * base.plan.human_scale;
    let is_there = |o: &&NamedOpening| {
        let ring: Vec<DVec2> = o.outline.points.iter().map(|p| base.plan.frame.plan_from_um(*p)).collect();
        is_inside_ring(&ring, middle)
    };
    base.openings.iter().filter(is_there).map(|o| o.record).collect()
}

/// Whether a wall's line has a length in what goes.
fn meets(wall: &Drawn, gone: &[Quad]) -> bool {
    wall.trace.segments().any(|(_, _, s)| gone.iter().any(|q| inside(s, q).is_some()))
}

/// Whether a corner of a wall lies in what goes, or on its rim.
fn holds(gone: &Quad, p: PointUm) -> bool {
    let at = |p: PointUm| DVec2::new(p[0] as f64, p[1] as f64);
    let [a, b, _, d] = gone.map(at);
    [b - a, d - a].into_iter().all(|side| {
        let along = (at(p) - a).dot(side.normalize_or_zero());
        (-SAME_UM..=side.length() + SAME_UM).contains(&along)
    })
}

/// The parts of a line that stay, as shares of its length, ascending.
fn outside(s: Segment, gone: &[Quad]) -> Vec<[f64; 2]> {
    let mut spans: Vec<[f64; 2]> = gone.iter().filter_map(|q| inside(s, q)).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut from, mut out) = (0.0, Vec::new());
    for [lo, hi] in spans {
        if lo - from > SHARE_MIN {
            out.push([from, lo]);
        }
        from = f64::max(from, hi);
    }
    if 1.0 - from > SHARE_MIN {
        out.push([from, 1.0]);
    }
    out
}

/// What stays of a wall's line, drawing units. An outline that is cut through is closed along its jambs, which are then no
/// lines of their own.
fn parts(plan: &Plan, wall: &Drawn, gone: &[Quad], jambs: &mut Vec<Segment>) -> Result<Vec<Shape>, String> {
    let um = |p: DVec2| plan.frame.um_from_file(p);
    let stays = |a: DVec2, b: DVec2| outside(Segment { a: um(a), b: um(b) }, gone);
    let at = |a: DVec2, b: DVec2, t: f64| {
        if t == 0.0 {
            a
        } else if t == 1.0 {
            b
        } else {
            a + (b - a) * t
        }
    };
    match &wall.shape {
        Shape::Line { a, b } => {
            let part = |[from, to]: [f64; 2]| Shape::Line { a: at(*a, *b, from), b: at(*a, *b, to) };
            Ok(stays(*a, *b).into_iter().map(part).collect())
        }
        Shape::Polyline { vertices, closed } => {
            let count = vertices.len();
            let pieces = if *closed { count } else { count.saturating_sub(1) };
            let mut chains: Vec<Vec<Vertex>> = Vec::new();
            let mut is_open = false;
            for k in 0..pieces {
                let (v, w) = (vertices[k], vertices[(k + 1) % count]);
                let spans = match v.bulge == 0.0 {
                    true => stays(v.at, w.at),
                    // The trace of a bulge has pieces of its own; one that is met is not cut.
                    false if is_bulge_met(plan, wall, k, gone) => {
                        return Err(format!("{} is round where it would be cut", wall.source.kind));
                    }
                    false => vec![[0.0, 1.0]],
                };
                is_open = is_open && spans.first().is_some_and(|s| s[0] == 0.0);
                for [from, to] in spans {
                    let bulge = v.bulge;
                    if !(is_open && from == 0.0) {
                        chains.push(vec![Vertex { at: at(v.at, w.at, from), bulge }]);
                    } else if let Some(last) = chains.last_mut().and_then(|c| c.last_mut()) {
                        last.bulge = bulge;
                    }
                    if let Some(chain) = chains.last_mut() {
                        chain.push(Vertex { at: at(v.at, w.at, to), bulge: 0.0 });
                    }
                    is_open = to == 1.0;
                }
            }
            let wraps = *closed && is_open && chains.len() > 1 && chains[0][0].at == vertices[0].at;
            if let Some(mut last) = chains.pop_if(|_| wraps) {
                last.pop();
                last.append(&mut chains[0]);
                chains[0] = last;
            }
            let one = |chain: Vec<Vertex>| {
                let ends = [chain[0].at, chain[chain.len() - 1].at].map(um);
                let jamb = jambs.iter().position(|j| *closed && chain.len() > 2 && is_same(*j, ends));
                jamb.map(|j| jambs.remove(j));
                Shape::Polyline { vertices: chain, closed: jamb.is_some() }
            };
            Ok(chains.into_iter().map(one).collect())
        }
        Shape::Arc { .. } | Shape::Circle { .. } => Err(format!("{} is round", wall.source.kind)),
    }
}

/// Whether what goes meets the round piece that begins at a vertex.
fn is_bulge_met(plan: &Plan, wall: &Drawn, piece: usize, gone: &[Quad]) -> bool {
    let points = control_points(&wall.shape);
    let ends = [piece, (piece + 1) % points.len()].map(|k| plan.frame.um_from_file(points[k]));
    let ring = &wall.trace.points;
    let Some(start) = ring.iter().position(|p| *p == ends[0]) else { return true };
    let mut met = false;
    for k in 0..ring.len() {
        let (a, b) = (ring[(start + k) % ring.len()], ring[(start + k + 1) % ring.len()]);
        met |= gone.iter().any(|q| inside(Segment { a, b }, q).is_some());
        if b == ends[1] {
            break;
        }
    }
    met
}

fn is_same(s: Segment, [p, q]: [PointUm; 2]) -> bool {
    let near = |a: PointUm, b: PointUm| ((a[0] - b[0]) as f64).hypot((a[1] - b[1]) as f64) <= SAME_UM;
    near(s.a, p) && near(s.b, q) || near(s.a, q) && near(s.b, p)
}

/// Records of the doors that stand where a wall goes or is closed.
fn doors(base: &Understood, drawing: &Drawing, work: &Work) -> Result<BTreeSet<usize>, String> {
    let mut out = BTreeSet::new();
    let is_all = matches!(work.kind, WorkKind::Remove);
    let is_own = matches!(work.kind, WorkKind::Close | WorkKind::Rehang | WorkKind::Widen);
    for (k, opening) in base.axes.openings.iter().enumerate() {
        let middle = base.plan.frame.um_from_plan(opening.centre * base.plan.human_scale);
        let is_in = |q: &Quad| inside(Segment { a: middle, b: [middle[0] + 1, middle[1] + 1] }, q).is_some();
        let goes = is_all && work.change.demolished.iter().any(is_in) || is_own && work.opening == Some(k);
        if !goes {
            continue;
        }
        for mark in &opening.marks {
            let entity = base.marked.get(*mark as usize).and_then(|e| drawing.entities.get(*e));
            let Some(entity) = entity else { return Err("its door is not found again".into()) };
            out.insert(entity.source.record);
        }
    }
    Ok(out)
}

/// What was demolished as an outline, with the faces that it had.
fn demolished(plan: &Plan, quad: &Quad) -> Addition {
    let [a, b, c, d] = quad.map(|p| plan.frame.file_from_um(p));
    let cover = COVER_M * plan.human_scale / plan.frame.metres_per_unit;
    let across = (d - a).try_normalize().unwrap_or_default() * cover;
    let points = vec![a + across, b + across, c - across, d - across];
    let mark = Mark::Path { points, closed: true };
    Addition { layer: DEMOLISHED.into(), rgb: DEMOLISHED_RGB, mark }
}

/// How far beside its faces it is looked whether a wall alone is filled, metres of a person.
const BESIDE_M: f64 = 0.15;

/// Records of what fills the wall where it goes; what cannot be cut stays as it is.
fn fills(base: &Understood, bytes: &[u8], work: &Work) -> Vec<usize> {
    let plan = &base.plan;
    let probe = |q: &Quad| {
        let [a, b, c, d] = q.map(|p| plan.frame.plan_from_um(p));
        let (right, left) = ((a + b) / 2.0, (c + d) / 2.0);
        let out = (left - right).normalize_or_zero() * (BESIDE_M * plan.human_scale);
        let [inside, right, left] =
            [(right + left) / 2.0, right - out, left + out].map(|p| plan.frame.file_from_plan(p));
        Probe { inside, beside: [right, left] }
    };
    let probes: Vec<Probe> = work.change.demolished.iter().map(probe).collect();
    let mut found = fills_at(&plan.file, bytes, &probes).unwrap_or_default();
    let gone = work.change.demolished.first().map(|q| q.map(|p| plan.frame.file_from_um(p)));
    found.retain(|record| {
        let edit = gone.map(|gone| cut_whole(*record, gone, Filling::Nothing));
        edit.is_some_and(|e| enfilade_cad::dxf::patch(&plan.file, bytes, &[e], &[]).is_ok())
    });
    found
}

/// The work as tables of the side-car.
fn decided(plan: &Plan, walls: &[Wall], work: &Work) -> Vec<WorkTable> {
    let file = |p: DVec2| <[f64; 2]>::from(plan.frame.file_from_plan(p));
    let quad = |q: &Quad| q.map(|p| <[f64; 2]>::from(plan.frame.file_from_um(p))).to_vec();
    let (kind, text) = match work.kind {
        WorkKind::Remove | WorkKind::End => ("remove", None),
        WorkKind::Door | WorkKind::Rehang => ("open", Some("door".to_owned())),
        WorkKind::Glaze => ("open", Some("glass".to_owned())),
        _ => ("open", None),
    };
    let gone = work.change.demolished.iter();
    let mut out: Vec<WorkTable> =
        gone.map(|q| WorkTable { kind: kind.into(), points: quad(q), text: text.clone() }).collect();
    let thickness_m = work.walls.first().map_or(0.1, |w| walls[w.0].thickness_m / plan.human_scale);
    let text = (thickness_m > 0.0).then(|| format!("{thickness_m:.3}m"));
    let mut wall = |[a, b]: [DVec2; 2]| {
        out.push(WorkTable { kind: "new".into(), points: vec![file(a), file(b)], text: text.clone() });
    };
    match work.kind {
        WorkKind::Close | WorkKind::Add => wall(work.stretch),
        WorkKind::Rehang => {
            // The faces of what is walled up lie on both sides of its axis.
            let faces: Vec<[DVec2; 2]> =
                work.change.built.iter().map(|s| [s.a, s.b].map(|p| plan.frame.plan_from_um(p))).collect();
            let long = faces.iter().filter(|[a, b]| a.distance(*b) > 2.0 * thickness_m * plan.human_scale);
            let long: Vec<_> = long.collect();
            if let [p, q] = long[..] {
                wall([(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0]);
            }
        }
        _ => {}
    }
    out
}
