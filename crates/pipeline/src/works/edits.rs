//! The changes of a file that make a building work, or the words of the side-car that decide it where the file cannot hold
//! it.

use std::collections::BTreeSet;

use glam::DVec2;

use super::cuts::{holds, meets, parts};
use super::fitted;
use crate::understand::building::NamedOpening;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{
    Addition, Drawing, Edit, Editable, EntityWork, Filling, Format, Mark, Shape, Vertex,
};
use enfilade_cad::dxf::{Probe, fills_at};
use enfilade_cad::own_layers::{DEMOLISHED, DEMOLISHED_RGB};
use enfilade_cad::plane::is_inside_ring;
use enfilade_config::WorkTable;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::axes::Opening;
use enfilade_plan::{DrawnBy, Plan, Wall as Drawn};
use enfilade_works::change::Quad;
use enfilade_works::walls::{BESIDE_M, Wall, cover_m};
use enfilade_works::{PARTITION_M, Work, WorkKind};

/// How a work is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Written {
    /// Changes of the file.
    pub edits: Vec<Edit>,
    /// What was demolished, on a layer of its own.
    pub additions: Vec<Addition>,
    /// What the side-car decides instead.
    pub tables: Vec<WorkTable>,
}

impl Written {
    fn add(&mut self, record: usize, work: EntityWork) {
        self.edits.push(Edit::Work { record, work });
    }
}

/// How works are written into their drawing, all at once: a line that two of them cut is cut twice. Why it cannot hold them,
/// where it cannot.
pub(super) fn written(
    base: &Understood,
    (drawing, bytes): (&Drawing, &[u8]),
    walls: &[Wall],
    works: &[&Work],
) -> Result<Written, String> {
    match base.plan.format {
        Format::Dxf => in_drawing(base, (drawing, bytes), walls, works),
        Format::Ifc => in_building(base, walls, works),
        Format::Gltf | Format::Glb => in_scene(base, walls, works),
    }
}

/// Lines end at the jambs, the rest and the jambs are new, what goes as a whole changes its layer.
fn in_drawing(
    base: &Understood,
    (drawing, bytes): (&Drawing, &[u8]),
    walls: &[Wall],
    works: &[&Work],
) -> Result<Written, String> {
    let plan = &base.plan;
    let gone: Vec<Quad> = works.iter().flat_map(|w| w.change.demolished.iter().copied()).collect();
    let mut out = Written::default();
    for work in works {
        let fitting = fitted::fitting(base, drawing, walls, work);
        if work.kind == WorkKind::Glaze && fitting.is_none() {
            return Err("the drawing shows no window whose like could be drawn".into());
        }
        out.edits.extend(fitting);
    }
    let mut jambs: Vec<Segment> = works.iter().flat_map(|w| w.change.built.iter().copied()).collect();
    let own = works.iter().flat_map(|w| &w.walls).flat_map(|w| &walls[w.0].records);
    let mut like = own.copied().next();
    let mut multilines: BTreeSet<usize> = BTreeSet::new();
    for wall in plan.walls.iter().filter(|w| meets(w, &gone)) {
        // All lines of a multiline are cut with one of them.
        let is_multiline = wall.source.kind == "MLINE" && !matches!(wall.editable, Editable::No(_));
        if is_multiline && !multilines.insert(wall.source.record) {
            continue;
        }
        if matches!(wall.drawn_by, DrawnBy::Mark(_)) || wall.editable != Editable::Free && !is_multiline {
            return Err(format!("{} on layer {:?} cannot be cut", wall.source.kind, wall.source.layer));
        }
        let (record, parts) = (wall.source.record, parts(plan, wall, &gone, &mut jambs)?);
        if parts.is_empty() {
            out.add(record, EntityWork::Drop);
        } else {
            like = Some(record);
            out.add(record, EntityWork::Cut { parts });
        }
    }
    let doors: BTreeSet<usize> = works.iter().flat_map(|w| doors(base, drawing, w)).collect();
    for record in doors {
        out.add(record, EntityWork::Drop);
    }
    if let Some(record) = like.filter(|_| !jambs.is_empty()) {
        let at = |p: PointUm| plan.frame.written(plan.frame.file_from_um(p));
        let shapes = jambs.iter().map(|s| Shape::Line { a: at(s.a), b: at(s.b) }).collect();
        out.add(record, EntityWork::Build { shapes });
    }
    for quad in &gone {
        for record in fills_at(&plan.file, bytes, probe(plan, quad)).unwrap_or_default() {
            out.add(record, EntityWork::Void { gone: in_file(plan, quad), filling: Filling::Gone });
        }
    }
    out.additions.extend(works.iter().flat_map(|w| outlines(base, walls, w)).map(|o| demolished(plan, o)));
    Ok(out)
}

/// What stands in the opening that a work makes.
pub(super) fn filling(work: &Work) -> Filling {
    match work.kind {
        WorkKind::Door | WorkKind::Rehang => Filling::Door,
        WorkKind::Glaze => Filling::Glass,
        WorkKind::Remove | WorkKind::End => Filling::Gone,
        _ => Filling::Nothing,
    }
}

/// An opening voids its wall, with a leaf or a pane where it has one; what goes as a whole says so; new walls stand where
/// others are closed.
fn in_building(base: &Understood, walls: &[Wall], works: &[&Work]) -> Result<Written, String> {
    let mut out = Written::default();
    for work in works {
        add_in_building(&mut out, base, walls, work)?;
    }
    Ok(out)
}

/// As in a building; what hangs where a wall goes or where another opening comes leaves the scene too.
fn in_scene(base: &Understood, walls: &[Wall], works: &[&Work]) -> Result<Written, String> {
    let mut out = in_building(base, walls, works)?;
    let mut dropped: BTreeSet<usize> = out.edits.iter().filter(|e| is_drop(e)).map(Edit::record).collect();
    for work in works {
        let left = match work.kind {
            WorkKind::Remove => named_in(base, &work.change.demolished),
            WorkKind::Widen => hung(base, work),
            _ => BTreeSet::new(),
        };
        for record in left {
            if dropped.insert(record) {
                out.add(record, EntityWork::Drop);
            }
        }
    }
    Ok(out)
}

fn is_drop(edit: &Edit) -> bool {
    matches!(edit, Edit::Work { work: EntityWork::Drop, .. })
}

/// Records of the doors and windows in what goes.
fn named_in(base: &Understood, gone: &[Quad]) -> BTreeSet<usize> {
    let middle = |o: &NamedOpening| {
        let points = o.outline.points.iter().map(|p| base.plan.frame.plan_from_um(*p));
        enfilade_cad::plane::box_of(points).map(|[lo, hi]| base.plan.frame.um_from_plan(lo.midpoint(hi)))
    };
    let goes = |o: &&NamedOpening| middle(o).is_some_and(|p| gone.iter().any(|q| holds(q, p)));
    base.openings.iter().filter(goes).map(|o| o.record).filter(|r| !is_of_wall(base, *r)).collect()
}

fn add_in_building(out: &mut Written, base: &Understood, walls: &[Wall], work: &Work) -> Result<(), String> {
    let (plan, gone, before) = (&base.plan, &work.change.demolished, out.edits.len());
    let records: BTreeSet<usize> = work.walls.iter().flat_map(|w| &walls[w.0].records).copied().collect();
    for record in &records {
        let own: Vec<&Drawn> = plan.walls.iter().filter(|w| w.source.record == *record).collect();
        let goes = |w: &&Drawn| w.trace.points.iter().all(|p| gone.iter().any(|q| holds(q, *p)));
        if work.kind == WorkKind::Remove && own.iter().all(goes) {
            out.add(*record, EntityWork::Drop);
            continue;
        }
        for quad in gone.iter().filter(|q| own.iter().any(|w| meets(w, std::slice::from_ref(*q)))) {
            out.add(*record, EntityWork::Void { gone: in_file(plan, quad), filling: filling(work) });
        }
    }
    let like = like(base, walls, work).or(records.first().copied());
    if let (Some([a, b]), Some(record)) = (built_axis(base, work), like) {
        let off = (b - a).normalize_or_zero().perp() * (thickness_m(base, walls, work) / 2.0);
        let corner = |p: DVec2| Vertex { at: plan.frame.written(plan.frame.file_from_plan(p)), bulge: 0.0 };
        let vertices = [a - off, b - off, b + off, a + off].map(corner).to_vec();
        out.add(record, EntityWork::Build { shapes: vec![Shape::Polyline { vertices, closed: true }] });
        for record in hung(base, work) {
            out.add(record, EntityWork::Drop);
        }
    }
    match out.edits.len() == before {
        true => Err("no element of the building stands there".into()),
        false => Ok(()),
    }
}

/// Thickness of the wall that a work changes or builds, metres of the plan.
pub(super) fn thickness_m(base: &Understood, walls: &[Wall], work: &Work) -> f64 {
    match work.kind {
        WorkKind::Add => PARTITION_M * base.plan.human_scale,
        _ => work.walls.first().map_or(0.0, |w| walls[w.0].thickness_m),
    }
}

/// The wall whose like a new partition is: the nearest one as thick that is no structure.
fn like(base: &Understood, walls: &[Wall], work: &Work) -> Option<usize> {
    let (thickness, middle) = (thickness_m(base, walls, work), work.stretch[0].midpoint(work.stretch[1]));
    let is_like = |w: &&Wall| {
        w.bearing.is_none() && (w.thickness_m - thickness).abs() < LEAST_M * base.plan.human_scale
    };
    let all = walls.iter().filter(|_| work.kind == WorkKind::Add).filter(is_like);
    let far = |w: &Wall| w.point(w.length_m / 2.0, 0.0).distance(middle);
    all.min_by(|a, b| far(a).total_cmp(&far(b))).and_then(|w| w.records.first().copied())
}

/// The axis of what is walled up or built, plan frame.
pub(super) fn built_axis(base: &Understood, work: &Work) -> Option<[DVec2; 2]> {
    match work.kind {
        WorkKind::Close | WorkKind::Add => Some(work.stretch),
        WorkKind::Rehang => {
            let old = base.axes.openings.get(work.opening?)?;
            Some(old.jambs.map(|j| j.at * base.plan.human_scale))
        }
        _ => None,
    }
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
    base.openings.iter().filter(is_there).map(|o| o.record).filter(|r| !is_of_wall(base, *r)).collect()
}

/// Whether a wall has this record: a door that moves with its wall is no element of its own.
fn is_of_wall(base: &Understood, record: usize) -> bool {
    base.plan.walls.iter().any(|w| w.source.record == record)
}

/// Records of what a drawing shows of the doors that stand where a wall goes or is closed.
fn doors(base: &Understood, drawing: &Drawing, work: &Work) -> BTreeSet<usize> {
    let goes = |(k, opening): &(usize, &Opening)| match work.kind {
        WorkKind::Remove => {
            let middle = base.plan.frame.um_from_plan(opening.centre * base.plan.human_scale);
            work.change.demolished.iter().any(|q| holds(q, middle))
        }
        WorkKind::Close | WorkKind::Rehang | WorkKind::Widen => work.opening == Some(*k),
        _ => false,
    };
    let openings = base.axes.openings.iter().enumerate().filter(goes);
    openings.flat_map(|(_, o)| fitted::shown(base, drawing, o)).map(|e| e.source.record).collect()
}

fn in_file(plan: &Plan, quad: &Quad) -> [DVec2; 4] {
    quad.map(|p| plan.frame.written(plan.frame.file_from_um(p)))
}

/// Outlines of what a work demolishes, with the faces that it had, plan frame: where there was an opening, nothing goes.
pub(super) fn outlines(base: &Understood, walls: &[Wall], work: &Work) -> Vec<[DVec2; 4]> {
    let scale = base.plan.human_scale;
    let thickness_m = work.walls.iter().map(|w| walls[w.0].thickness_m).fold(0.0, f64::max);
    let cover = cover_m(&base.plan, thickness_m);
    let open = work.opening.filter(|_| work.kind == WorkKind::Widen).and_then(|k| base.axes.openings.get(k));
    let open = open.map(|o| o.jambs.map(|j| j.at * scale));
    let pieces = work.change.demolished.iter().flat_map(|quad| {
        let [a, b, _, d] = quad.map(|p| base.plan.frame.plan_from_um(p));
        let (along, length) = ((b - a).normalize_or_zero(), a.distance(b));
        let kept = open.map(|jambs| jambs.map(|p| (p - a).dot(along).clamp(0.0, length)));
        let [from, to] = kept.map_or([length; 2], |[p, q]| [p.min(q), p.max(q)]);
        let across = (d - a).normalize_or_zero() * cover;
        let piece = move |[s, e]: [f64; 2]| {
            [a + along * s + across, a + along * e + across, d + along * e - across, d + along * s - across]
        };
        [[0.0, from], [to, length]].into_iter().filter(|[s, e]| e - s > LEAST_M * scale).map(piece)
    });
    pieces.collect()
}

/// Shorter pieces of wall do not count, metres of a person: a slip of the hand at a jamb.
const LEAST_M: f64 = 0.01;

/// What was demolished as an outline.
fn demolished(plan: &Plan, outline: [DVec2; 4]) -> Addition {
    let points = outline.map(|p| plan.frame.written(plan.frame.file_from_plan(p))).to_vec();
    let mark = Mark::Path { points, closed: true };
    Addition { layer: DEMOLISHED.into(), rgb: DEMOLISHED_RGB, mark }
}

/// Where a wall is filled, and where a floor is: beside its faces, as far as rooms are looked for.
fn probe(plan: &Plan, quad: &Quad) -> Probe {
    let [a, b, c, d] = quad.map(|p| plan.frame.plan_from_um(p));
    let (right, left) = ((a + b) / 2.0, (c + d) / 2.0);
    let out = (left - right).normalize_or_zero() * (BESIDE_M * plan.human_scale);
    let [inside, right, left] =
        [(right + left) / 2.0, right - out, left + out].map(|p| plan.frame.file_from_plan(p));
    Probe { inside, beside: [right, left] }
}

/// A work as tables of the side-car.
pub(super) fn beside(base: &Understood, walls: &[Wall], work: &Work) -> Vec<WorkTable> {
    let plan = &base.plan;
    let (kind, text) = match work.kind {
        WorkKind::Remove | WorkKind::End => ("remove", None),
        WorkKind::Door | WorkKind::Rehang => ("open", Some("door".to_owned())),
        WorkKind::Glaze => ("open", Some("glass".to_owned())),
        _ => ("open", None),
    };
    let gone = work.change.demolished.iter().map(|q| WorkTable {
        kind: kind.into(),
        points: in_file(plan, q).map(<[f64; 2]>::from).to_vec(),
        text: text.clone(),
    });
    let new = built_axis(base, work).map(|axis| WorkTable {
        kind: "new".into(),
        points: axis.map(|p| plan.frame.written(plan.frame.file_from_plan(p)).into()).to_vec(),
        text: Some(thickness_m(base, walls, work) / plan.human_scale)
            .filter(|m| *m > 0.0)
            .map(|m| format!("{m:.3}m")),
    });
    gone.chain(new).collect()
}
