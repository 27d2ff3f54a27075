//! From a study to what the overlay shows: strokes, cells, result entries.

use glam::DVec2;

use crate::measure::seen::Seen;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::understand::building;
use crate::understand::rooms::Room;
use crate::understand::sensed::Sensed;
use crate::understand::senses::of_entity;
use crate::understand::understood::Understood;
use crate::write::maps::Map;
use enfilade_cad::bearing;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Addition, Format, Mark, Shape, SourceRef, Vertex, place_in};
use enfilade_cad::plane::box_of;
use enfilade_config::Penalty;
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Segment, Side, UM_PER_M, side_of_ring};
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_overlay::measure::{counts_cells, wording};
use enfilade_overlay::picture::{
    FloorShape, PlanPicture, RegionKind, RegionOutline, Stroke, StrokeKind, bounds_of,
};
use enfilade_overlay::result::{
    self, Change, Counts, ElementRef, Input, LayerEntry, MoveEntry, MoveKind, Numbers, RegionEntry, UnitEntry,
};
use enfilade_plan::axes::{Opening, OpeningKind, THICKNESSES};
use enfilade_plan::curve::Trace;
use enfilade_plan::floor::Area;
use enfilade_plan::kinds::RoomKind;
use enfilade_plan::markers::Kind;
use enfilade_plan::structure::{face_handles, handle_at};
use enfilade_plan::{Plan, Wall};
use enfilade_report::{Report, counted};

impl Map {
    /// What a legend says: the measure with its technical term and its pair.
    pub fn title(self) -> String {
        let words = wording(self.measure.name());
        let title =
            words.map_or(self.measure.name().to_string(), |w| format!("{} ({})", w.plain, w.technical));
        self.pair.map_or(title.clone(), |pair| format!("{title}: {pair}"))
    }

    /// The unit in which people are told its values.
    pub fn unit(self) -> &'static str {
        wording(self.measure.name()).map_or("", |w| w.unit)
    }

    /// What its values are multiplied by to be in this unit: cells are told as area.
    pub fn factor(self, study: &Study) -> f64 {
        if counts_cells(self.measure.name()) { study.spacing_m * study.spacing_m } else { 1.0 }
    }
}

/// The plan as drawn; walls that may move are marked.
pub fn picture(base: &Understood) -> PlanPicture {
    let stroke = |(w, wall): (usize, &enfilade_plan::Wall)| {
        let movable = base.moves.walls.binary_search(&(w as u32)).is_ok();
        let kind = if movable { StrokeKind::Movable } else { StrokeKind::Fixed };
        stroke_of(&base.plan, &wall.trace, wall.is_solid, kind)
    };
    let strokes = base.plan.walls.iter().enumerate().map(stroke).chain(decided_strokes(&base.plan));
    let strokes: Vec<Stroke> = strokes.collect();
    let regions = regions(&base.plan);
    let points =
        strokes.iter().flat_map(|s| s.points.clone()).chain(regions.iter().flat_map(|r| r.points.clone()));
    let north_deg = base.plan.north_deg;
    PlanPicture { bounds: bounds_of(points), strokes, regions, north_deg, ..PlanPicture::default() }
}

/// What decided works take away and what they build.
fn decided_strokes(plan: &Plan) -> impl Iterator<Item = Stroke> {
    let of = |t: &Trace, kind| stroke_of(plan, t, t.is_closed, kind);
    plan.decided.iter().flat_map(move |d| {
        let gone = d.demolished.iter().map(move |t| of(t, StrokeKind::Demolished));
        gone.chain(d.built.iter().map(move |t| of(t, StrokeKind::Built)))
    })
}

/// How much of a piece that is stretched is shown as moving, from the end that moves; metres of a person.
const STRETCH_SHOWN_M: f64 = 0.6;

/// A wall that stays or moves with all its corners is one stroke; of others each piece is one, and of a piece that is
/// stretched what lies at the end that moves.
fn wall_strokes(base: &Understood, w: usize) -> Vec<Stroke> {
    let wall = &base.plan.walls[w];
    let moves = |c: u32| base.moves.handles().any(|h| *h == (w as u32, c));
    let corners = base.graph.control_nodes[w].len() as u32;
    let is_moving = base.moves.walls.binary_search(&(w as u32)).is_ok();
    let moving = if is_moving { (0..corners).filter(|c| moves(*c)).count() as u32 } else { 0 };
    if moving == 0 || moving == corners || corners < 3 && wall.trace.points.len() != 2 {
        let kind = if moving == 0 { StrokeKind::Fixed } else { StrokeKind::Movable };
        return vec![stroke_of(&base.plan, &wall.trace, wall.is_solid, kind)];
    }
    let mut control = 0;
    let at = |p: PointUm| base.plan.frame.plan_from_um(p);
    let mut out = Vec::new();
    for (i, j, s) in wall.trace.segments() {
        control = wall.trace.control[i].unwrap_or(control);
        let is_straight = wall.trace.control[i].is_some() && wall.trace.control[j].is_some();
        let ends = [at(s.a), at(s.b)];
        match [control, (control + 1) % corners].map(moves) {
            [true, true] => out.push(piece(ends, StrokeKind::Movable)),
            [true, false] if is_straight => out.extend(stretched(ends, base.plan.human_scale)),
            [false, true] if is_straight => out.extend(stretched([ends[1], ends[0]], base.plan.human_scale)),
            _ => out.push(piece(ends, StrokeKind::Fixed)),
        }
    }
    out
}

/// The ground that a wall drawn as a wide polyline covers, piece by piece.
fn wide_strokes(plan: &Plan, wall: &Wall) -> Vec<Stroke> {
    let of = |s: Segment| {
        let points = wall.ground(s)?.map(|p| plan.frame.plan_from_um(p).to_array()).to_vec();
        Some(Stroke { points, closed: true, filled: true, kind: StrokeKind::Fixed })
    };
    wall.trace.segments().filter_map(|(_, _, s)| of(s)).collect()
}

fn piece(ends: [DVec2; 2], kind: StrokeKind) -> Stroke {
    Stroke { points: ends.map(|p| p.to_array()).to_vec(), closed: false, filled: false, kind }
}

/// A piece of which the first end moves: what of it is shown as moving, and the rest.
fn stretched([a, b]: [DVec2; 2], human_scale: f64) -> Vec<Stroke> {
    let reach = STRETCH_SHOWN_M * human_scale;
    if a.distance(b) <= reach {
        return vec![piece([a, b], StrokeKind::Movable)];
    }
    let to = a + (b - a).normalize() * reach;
    vec![piece([a, to], StrokeKind::Movable), piece([to, b], StrokeKind::Fixed)]
}

/// Walls less sure than this are shown as doubtful.
const SURE: f32 = 0.6;

/// The floor with what each room is called and how large it is.
fn floor_shapes(base: &Understood, sensed: &Sensed, rooms: &[Room]) -> Vec<FloorShape> {
    let Some(floor) = &sensed.floor else { return Vec::new() };
    let is_measured = base.plan.markers.query.is_empty().then_some(true);
    let at = |p: &PointUm| base.plan.frame.plan_from_um(*p).to_array();
    let shape = |area: &Area, words: Vec<String>, is_measured: Option<bool>| FloorShape {
        rings: std::iter::once(&area.outline)
            .chain(&area.holes)
            .map(|r| r.iter().map(at).collect())
            .collect(),
        at: at(&area.at),
        words,
        is_measured,
    };
    let size = |area: &Area| format!("{:.1} m²", area.area_m2);
    let room = |(k, room): (usize, &Room)| {
        let size = format!("{}: {}", k + 1, size(&room.area));
        let words = room.name.iter().cloned().chain(kind_words(room)).chain([size]);
        shape(&room.area, words.collect(), is_measured)
    };
    let rooms = rooms.iter().enumerate().map(room);
    let left = floor.left_out.iter().filter(|_| is_measured.is_some());
    rooms.chain(left.map(|a| shape(a, vec![size(a)], Some(false)))).collect()
}

/// What a room is for, in a word or two; nothing where that is unknown, or its name says the same.
fn kind_words(room: &Room) -> Option<String> {
    let found = &room.found;
    let is_same = room.name.as_ref().is_some_and(|n| n.to_lowercase().contains(found.kind.name()));
    let kind = match found.kind {
        RoomKind::Other => return None,
        _ if is_same => "",
        kind => kind.name(),
    };
    let words =
        [kind, if found.is_sure { "" } else { "?" }, if found.is_private() { " private" } else { "" }];
    Some(words.concat().trim().to_owned()).filter(|w| !w.is_empty())
}

/// The plan as understood: also its floor, its openings, what is doubtful and what was left out.
pub(crate) fn check_picture(base: &Understood, sensed: &Sensed, rooms: &[Room]) -> PlanPicture {
    let mut out = picture(base);
    out.floor = floor_shapes(base, sensed, rooms);
    let is_pane = |w: usize| sensed.panes.contains_key(&base.entities[w]);
    let is_doubtful =
        |w: &usize| !is_pane(*w) && of_entity(&base.plan, base.entities[*w], true).confidence < SURE;
    let doubtful = (0..base.plan.walls.len()).filter(is_doubtful).map(|w| &base.plan.walls[w]);
    let doubtful: Vec<Stroke> =
        doubtful.map(|w| stroke_of(&base.plan, &w.trace, false, StrokeKind::Doubtful)).collect();
    let strokes = |w: usize| match is_pane(w) {
        false => wall_strokes(base, w),
        true => vec![stroke_of(&base.plan, &base.plan.walls[w].trace, false, StrokeKind::Window)],
    };
    out.strokes = (0..base.plan.walls.len()).flat_map(strokes).collect();
    out.strokes.extend(base.plan.walls.iter().flat_map(|w| wide_strokes(&base.plan, w)));
    out.strokes.extend(decided_strokes(&base.plan));
    let scale = base.plan.human_scale;
    for opening in &base.axes.openings {
        let kind = match opening.kind {
            OpeningKind::Passage => StrokeKind::Opening,
            _ if !base.openings.is_empty() => continue,
            OpeningKind::Door => StrokeKind::Door,
            OpeningKind::Window => StrokeKind::Window,
        };
        // Where outlines of rooms touch, no wall stands between them.
        let ground = uncut_ground(&base.plan, opening).filter(|_| opening.kind != OpeningKind::Passage);
        let is_ground = ground.is_some();
        let points = ground.map_or_else(|| opening.jambs.map(|j| j.at).to_vec(), |ring| ring.to_vec());
        let points = points.into_iter().map(|p| (p * scale).to_array()).collect();
        out.strokes.push(Stroke { points, closed: is_ground, filled: is_ground, kind });
    }
    let kind = |is_glass: bool| if is_glass { StrokeKind::Window } else { StrokeKind::Ignored };
    let left_out = base.left_out.iter();
    out.strokes.extend(left_out.map(|(t, is_glass)| stroke_of(&base.plan, t, false, kind(*is_glass))));
    let named = base.openings.iter().map(|o| {
        let kind = if o.is_door { StrokeKind::Door } else { StrokeKind::Window };
        stroke_of(&base.plan, &o.outline, stands_in_wall(&base.plan, &o.outline), kind)
    });
    out.strokes.extend(named);
    out.strokes.extend(doubtful);
    out
}

/// The ground of an opening in walls that are drawn through it, across all of their faces: it is looked through, so no wall
/// is shown there. Metres of a person.
fn uncut_ground(plan: &Plan, opening: &Opening) -> Option<[DVec2; 4]> {
    let [a, b] = opening.jambs.map(|j| j.at);
    let across = (b - a).try_normalize()?.perp();
    let faces = opening.through.iter().flat_map(|f| face_handles(plan, *f)).map(|h| handle_at(plan, h));
    let [lo, hi] = box_of(faces.map(|p| DVec2::new(0.0, (p - a).dot(across))))?.map(|p| p.y);
    (hi > lo).then(|| [a + across * lo, b + across * lo, b + across * hi, a + across * hi])
}

/// Whether what closes an opening stands in a solid wall that the file does not cut there.
fn stands_in_wall(plan: &Plan, outline: &Trace) -> bool {
    let count = outline.points.len().max(1) as i64;
    let middle = [0, 1].map(|k| outline.points.iter().map(|p| p[k]).sum::<i64>() / count);
    let solids = plan.walls.iter().filter(|w| w.is_solid && w.trace.is_closed);
    solids.into_iter().any(|w| side_of_ring(&w.trace.points, middle) == Side::Inside)
}

/// Doors and windows: those that the file calls so, else those understood.
fn doors_and_windows(base: &Understood) -> [u64; 2] {
    if !base.openings.is_empty() {
        return [true, false].map(|is_door| building::count(&base.openings, is_door));
    }
    let of = |kind| base.axes.openings.iter().filter(|o| o.kind == kind).count() as u64;
    [OpeningKind::Door, OpeningKind::Window].map(of)
}

/// What was understood, in words; with the doors and windows that the file calls so instead of those understood.
fn statements(base: &Understood) -> Vec<String> {
    let [doors, windows] = doors_and_windows(base);
    let passages = base.axes.openings.iter().filter(|o| o.kind == OpeningKind::Passage);
    let passages = passages.filter(|o| !building::is_named(o, &base.openings, &base.plan)).count();
    let told = |s: &String| match s.split_once(" understood; ") {
        Some((walls, _)) if !base.openings.is_empty() => {
            format!(
                "{walls} understood; {}, {}, {}",
                counted(doors, "door"),
                counted(windows, "window"),
                counted(passages as u64, "passage")
            )
        }
        _ if s.starts_with(THICKNESSES) => base.axes.thickness_words(base.plan.human_scale),
        _ => s.clone(),
    };
    let structure = bearing::words(&base.plan.bearing);
    base.axes.statements.iter().map(told).chain(structure).collect()
}

/// A trace as it is shown.
pub(crate) fn stroke_of(plan: &Plan, trace: &Trace, solid: bool, kind: StrokeKind) -> Stroke {
    let points = trace.points.iter().map(|p| plan.frame.plan_from_um(*p).to_array()).collect();
    Stroke { points, closed: trace.is_closed, filled: solid, kind }
}

fn regions(plan: &Plan) -> Vec<RegionOutline> {
    let outline = |region: &Region, kind| {
        let points = region.outline().iter().map(|p| plan.frame.plan_from_um(*p).to_array()).collect();
        RegionOutline { points, kind }
    };
    let marks = &plan.markers;
    let query = marks.query.iter().chain(marks.pairs.iter().flat_map(|p| &p.query));
    let reference = marks.reference.iter().chain(marks.pairs.iter().flat_map(|p| &p.reference));
    let mut out: Vec<RegionOutline> = query.map(|r| outline(r, RegionKind::Query)).collect();
    out.extend(reference.map(|r| outline(r, RegionKind::Reference)));
    out.extend(marks.keep.iter().map(|r| outline(r, RegionKind::Keep)));
    out.extend(marks.groups.iter().map(|g| outline(&g.outline, RegionKind::Move)));
    out
}

/// Plan frame to drawing units for everything that is added to a file.
pub fn to_drawing_units(plan: &Plan, additions: Vec<Addition>) -> Vec<Addition> {
    let point = |p: glam::DVec2| plan.frame.file_from_plan(p);
    let convert = |mark| match mark {
        Mark::Path { points, closed } => {
            Mark::Path { points: points.into_iter().map(point).collect(), closed }
        }
        Mark::Fill { corners } => Mark::Fill { corners: corners.map(point) },
        Mark::Text { at, height, text } => {
            Mark::Text { at: point(at), height: height / plan.frame.metres_per_unit, text }
        }
    };
    additions.into_iter().map(|a| Addition { mark: convert(a.mark), ..a }).collect()
}

/// `element` of result.json.
pub fn element(format: Format, source: &SourceRef) -> ElementRef {
    element_of(format, source.handle.clone(), source.record)
}

/// `element` of result.json for a record and its handle.
pub fn element_of(format: Format, handle: Option<String>, record: usize) -> ElementRef {
    match format {
        Format::Dxf => ElementRef::Dxf { handle, record: record as u64 },
        Format::Gltf | Format::Glb => {
            ElementRef::Gltf { path: handle.unwrap_or_else(|| format!("/nodes/{record}")) }
        }
        Format::Ifc => ElementRef::Ifc { global_id: handle.unwrap_or_default(), id: record as u64 },
    }
}

/// `moves` of result.json.
pub fn move_entries(base: &Understood) -> Vec<MoveEntry> {
    let entry = |p: &enfilade_moves::Parameter| {
        let group = &base.moves.groups[p.group];
        let mut walls: Vec<u32> = group.handles.iter().map(|h| h.0).collect();
        walls.dedup();
        let walls = walls.into_iter().map(|w| &base.plan.walls[w as usize].source);
        let mut elements: Vec<ElementRef> = Vec::new();
        for source in walls.chain(group.slots.iter().map(|s| &base.plan.slots[*s].source)) {
            let e = element(base.plan.format, source);
            if !elements.contains(&e) {
                elements.push(e);
            }
        }
        let kind = match p.clause.kind {
            Kind::X => MoveKind::X,
            Kind::Y => MoveKind::Y,
            Kind::Along(_) => MoveKind::Along,
            Kind::Rotate(_) => MoveKind::Rotate,
            Kind::Scale(_) => MoveKind::Scale,
        };
        let direction_deg = if let Kind::Along(rad) = p.clause.kind { Some(rad.to_degrees()) } else { None };
        MoveEntry {
            name: p.group_name.clone(),
            kind,
            lower: p.clause.lower,
            upper: p.clause.upper,
            unit: p.clause.unit.clone(),
            direction_deg,
            elements,
            geometry: crate::understand::fits::geometry_mark(base, p.group),
        }
    };
    base.moves.parameters.iter().map(entry).collect()
}

/// `changes` of one candidate: axis points in metres of the drawing frame.
pub fn changes(base: &Understood, layout: &Layout) -> Vec<Change> {
    let metres = |shape: &Shape| -> Vec<[f64; 2]> {
        let um = |p: glam::DVec2| -> PointUm { base.plan.frame.um_from_file(p) };
        control_points(shape).into_iter().map(|p| um(p).map(|v| v as f64 / 1e6)).collect()
    };
    let change = |source: &SourceRef, from: &Shape, to: &Shape, follows: bool| Change {
        element: element(base.plan.format, source),
        host_id: None,
        from: metres(from),
        to: metres(to),
        follows,
    };
    let changed = layout.walls.iter().filter(|w| w.is_rebuilt());
    let walls = changed.map(|m| {
        let wall = &base.plan.walls[m.wall as usize];
        change(&wall.source, &wall.shape, &m.shape, false)
    });
    let slid = (0..base.plan.slots.len()).filter_map(|slot| {
        let (s, shift) = (&base.plan.slots[slot], layout.slid(slot)?);
        let ring = |shift: DVec2| {
            let vertices = s.outline.iter().map(|p| Vertex { at: *p + shift, bulge: 0.0 }).collect();
            Shape::Polyline { vertices, closed: true }
        };
        Some(change(&s.source, &ring(DVec2::ZERO), &ring(shift), false))
    });
    let fittings = base.fittings.iter().filter(|f| !layout.slides(&base.plan, f.source.record));
    let fittings = fittings.filter_map(|f| match carried(&base.plan, f, layout) {
        Carried::Moves(shape, _) => Some(change(&f.source, &f.shape, &shape, true)),
        Carried::Stays | Carried::Stale(_) => None,
    });
    walls.chain(slid).chain(fittings).collect()
}

/// `input` of result.json.
pub fn input(plan: &Plan, read: &crate::job::Input<'_>) -> Input {
    Input {
        path: read.path.into(),
        sha256: read.sha256().into(),
        content: read.content(),
        format: plan.format.name().into(),
        unit: plan.unit.unit.name.into(),
        unit_reason: plan.unit.reason.clone(),
        north_deg: plan.north_deg,
    }
}

/// `counts` of result.json.
pub fn counts(study: &Study, edges: u64) -> Counts {
    let lattice = &study.lattice;
    Counts {
        vertices: lattice.cells.len() as u64,
        query: lattice.query.len() as u64,
        covered: study.initial.seen.covered.len() as u64,
        reference: lattice.is_reference.iter().filter(|r| **r).count() as u64,
        edges,
        walls: study.all_pieces().len() as u64,
    }
}

/// Measures of a layout by name: the means, then what else was asked for.
pub fn mean_numbers(study: &Study, worth: &Worth) -> Numbers {
    let of = |seen: &Seen, name: &str| {
        let m = &seen.means;
        [("degree", m.degree), ("depth", m.depth), ("entropy", m.entropy)]
            .map(|(key, v)| (format!("{key}{name}"), v))
    };
    let mut out = Numbers(of(&worth.seen, "").to_vec());
    out.0.push(("degree_all".to_owned(), worth.seen.means.degree_all));
    for (pair, seen) in study.pairs().iter().zip(&worth.pairs) {
        out.0.extend(of(seen, &format!("@{}", pair.name)));
    }
    for (aim, v) in study.aims.iter().zip(&worth.aims) {
        if out.get(&aim.to_string()).is_none() {
            out.0.push((aim.to_string(), *v));
        }
    }
    out
}

/// Half the widths of the 95 % intervals of the means that are estimated, by the name of the mean.
pub fn mean_half_widths(study: &Study) -> Numbers {
    let pairs = study.pairs().iter().zip(&study.initial.pairs).map(|(p, s)| (format!("@{}", p.name), s));
    let all = std::iter::once((String::new(), &study.initial.seen)).chain(pairs);
    let of = |(name, seen): (String, &Seen)| {
        let [depth, entropy] = seen.estimated.as_ref()?.half_widths;
        Some([(format!("depth{name}"), depth), (format!("entropy{name}"), entropy)])
    };
    Numbers(all.filter_map(of).flatten().collect())
}

/// Penalties of a layout by name.
pub fn penalty_numbers(worth: &Worth) -> Numbers {
    let mut out = Numbers::of([
        ("clearance_m2", worth.clearance_m2),
        ("wall_length_m", worth.penalties[1]),
        ("alignment", worth.penalties[2]),
        ("overlap", worth.penalties[3]),
        ("disconnection", worth.disconnection),
    ]);
    out.0.extend(worth.passages_m.first().map(|v| ("passage_m".to_owned(), *v)));
    if !worth.rooms_m2.is_empty() {
        out.0.push(("room_area_m2".to_owned(), worth.penalty(Penalty::RoomArea)));
    }
    out
}

/// `enfilade.check/2` but for its reading.
pub fn check(base: &Understood, report: &Report) -> result::CheckResult {
    let plan = &base.plan;
    let marks = &plan.markers;
    let regions = [("query", &marks.query), ("reference", &marks.reference), ("keep", &marks.keep)];
    let region = |kind: &str, r: &Region| RegionEntry {
        kind: kind.into(),
        area_m2: crate::measure::spacing::region_m2(r),
        place: String::new(),
        pair: None,
    };
    let mut shown: Vec<RegionEntry> =
        regions.iter().flat_map(|(kind, list)| list.iter().map(|r| region(kind, r))).collect();
    for pair in &marks.pairs {
        let of = |kind, r| RegionEntry { pair: Some(pair.name.clone()), ..region(kind, r) };
        shown.extend(pair.query.iter().map(|r| of("query", r)));
        shown.extend(pair.reference.iter().map(|r| of("reference", r)));
    }
    for g in &marks.groups {
        let place = place_in(&plan.file, &g.source).to_string();
        shown.push(RegionEntry {
            kind: "move".into(),
            area_m2: crate::measure::spacing::region_m2(&g.outline),
            place,
            pair: None,
        });
    }
    let [doors, windows] = doors_and_windows(base);
    result::CheckResult {
        schema: result::CHECK_SCHEMA.into(),
        file: plan.file.clone(),
        format: plan.format.name().into(),
        version: plan.version.clone(),
        unit: UnitEntry {
            name: plan.unit.unit.name.into(),
            metres: plan.unit.unit.metres,
            reason: plan.unit.reason.clone(),
        },
        walls: plan.walls.len() as u64,
        wall_elements: plan.walls.len() as u64,
        walls_understood: base.axes.edges.len() as u64,
        openings: (doors + windows).max(base.axes.openings.len() as u64),
        doors,
        windows,
        columns: base.axes.columns() as u64,
        solids: plan.walls.iter().filter(|w| w.is_solid).count() as u64,
        regions: shown,
        moves: move_entries(base),
        layers: plan
            .layers
            .iter()
            .map(|l| LayerEntry {
                name: l.name.clone(),
                entities: l.entities as u64,
                taken_as: l.role.into(),
                reason: l.why.clone(),
            })
            .collect(),
        statements: statements(base),
        building: None,
        storeys: Vec::new(),
        problems: report.problems.iter().map(Into::into).collect(),
        reading: None,
    }
}

/// Points of a file in metres of the drawing frame.
pub(crate) fn metres(plan: &Plan, points: &[DVec2]) -> Vec<[f64; 2]> {
    points.iter().map(|p| plan.frame.um_from_file(*p).map(|v| v as f64 / UM_PER_M)).collect()
}

pub(crate) fn lattice_centre(study: &Study) -> [f64; 2] {
    study.lattice.origin_um.map(|v| v as f64 / 1e6)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::understand::understood;
    use enfilade_config::{Partial, Settings};
    use enfilade_fixtures::corridor::{corners, drawing, line, polyline};

    /// A door drawn over a wall whose lines go on under it is seen through: its ground is that of the whole wall.
    #[test]
    fn no_wall_is_shown_across_a_door_in_an_uncut_wall() {
        let swing = "0|ARC|8|DOORS|10|4.1|20|2.0|40|0.9|50|0|51|90|";
        let rings = [[0.0, 0.0, 10.1, 7.0], [0.2, 0.2, 4.0, 6.8], [4.1, 0.2, 9.9, 6.8]];
        let walls: String = rings.iter().map(|r| polyline("WALLS", &corners(*r), true)).collect();
        let text = drawing(&(walls + &line("DOORS", [4.1, 2.0, 5.0, 2.0]) + swing));
        let mut report = Report::default();
        let settings = Settings::new(Partial::default()).unwrap();
        let read = enfilade_cad::read("plan.dxf", text.as_bytes(), &Default::default(), &mut report).unwrap();
        let base = understood(&read, &settings, &mut report).unwrap();
        let shown = check_picture(&base, &Sensed::new(&base, &settings), &[]);
        let door = shown.strokes.iter().find(|s| s.kind == StrokeKind::Door).unwrap();
        let [lo, hi] = bounds_of(door.points.iter().copied());
        let size = [hi[0] - lo[0], hi[1] - lo[1]].map(|m| (m * 100.0).round() as i64);
        assert!(door.filled && size == [10, 90], "{door:?}");
    }

    /// A façade along which a partition slides is not shown as moving from end to end.
    #[test]
    fn a_stretched_piece_moves_at_its_end() {
        for (length, scale, expected) in [(5.0, 1.0, 0.6), (5.0, 0.1, 0.06), (0.5, 1.0, 0.5)] {
            let ends = [DVec2::new(1.0, 2.0), DVec2::new(1.0, 2.0 + length)];
            let strokes = stretched(ends, scale);
            let length_of = |kind: StrokeKind| -> f64 {
                let of_kind = strokes.iter().filter(|s| s.kind == kind);
                of_kind.map(|s| DVec2::from(s.points[0]).distance(DVec2::from(s.points[1]))).sum()
            };
            assert!((length_of(StrokeKind::Movable) - expected).abs() < 1e-12, "{length} {scale}");
            assert!((length_of(StrokeKind::Fixed) - (length - expected)).abs() < 1e-12, "{length} {scale}");
            assert_eq!(strokes[0].points[0], ends[0].to_array(), "from the end that moves");
        }
    }
}
