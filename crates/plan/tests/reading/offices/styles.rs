//! How offices draw: a plan to a drawing.

use enfilade_cad::drawing::{Drawing, Editable, Entity, Format, Layer, Shape, SourceRef, Unit, Vertex};
use enfilade_plan::axes::{Drawn, Face, Mark, Role, paths_of};
use glam::DVec2;

use super::Dice;
use super::plans::{Arc, Column, Kind, Plan, Wall};

/// How walls are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// One line in the middle of each wall.
    CentreLines,
    /// Two faces, joints cleaned up, ends capped.
    FacePairs,
    /// Two faces that run through one another at the joints.
    Uncleaned,
    /// Each wall a closed outline.
    Outlines,
    /// All walls that touch one outline.
    Merged,
    /// Faces as polylines of two points; curves too.
    Exploded,
    /// Faces as lines, curves as traced splines.
    Splines,
    /// Faces with a line of plaster inside each.
    Finish,
    /// Faces drawn through doors and windows, with lines across at the jambs.
    Through,
}

/// All styles.
pub const STYLES: [Style; 9] = [
    Style::CentreLines,
    Style::FacePairs,
    Style::Uncleaned,
    Style::Outlines,
    Style::Merged,
    Style::Exploded,
    Style::Splines,
    Style::Finish,
    Style::Through,
];

/// Layer names of walls, columns, doors, windows.
pub const LAYERS: [[&str; 4]; 6] = [
    ["A-WALL", "A-COLS", "A-DOOR", "A-GLAZ"],
    ["Wände 1.OG", "Stützen", "Türen", "Fenster"],
    ["MURS_PORTEURS", "POTEAUX", "PORTES", "FENETRES"],
    ["muri", "pilastri", "porte", "finestre"],
    ["壁", "柱", "建具", "窓"],
    ["xref-OG1$0$A-WALL", "xref-OG1$0$A-COLS", "xref-OG1$0$A-DOOR", "xref-OG1$0$A-GLAZ"],
];

const MM: Unit = Unit { name: "mm", metres: 0.001 };

/// Units drawn in, and what the file says: right, wrong, nothing.
pub const UNITS: [(f64, Option<Unit>); 5] = [
    (0.001, Some(MM)),
    (0.01, Some(MM)),
    (1.0, None),
    (0.0254, Some(MM)),
    (0.001, Some(Unit { name: "in", metres: 0.0254 })),
];

/// How an office draws.
#[derive(Clone, Copy, Debug)]
pub struct Office {
    pub style: Style,
    /// Slips of the hand: duplicates, splits, gaps and overshoots of up to 15 mm.
    pub noise: bool,
    /// Which of [`LAYERS`].
    pub layers: usize,
    /// Doors and windows as blocks.
    pub blocks: bool,
    /// Metres in a drawing unit.
    pub unit_m: f64,
    /// What the file says the unit is.
    pub declared: Option<Unit>,
}

impl Office {
    pub fn new(style: Style, noise: bool) -> Self {
        Self { style, noise, layers: 0, blocks: false, unit_m: 0.001, declared: Some(MM) }
    }
}

/// Draws a plan.
pub fn draw(plan: &Plan, office: &Office, seed: u64) -> Drawing {
    let mut sheet = Sheet { entities: Vec::new(), office: *office };
    let mut dice = Dice::new(seed);
    let corners = Corners::new(plan, 0.0);
    match office.style {
        Style::CentreLines => centre_lines(plan, &mut sheet),
        Style::FacePairs => faces(plan, &corners, true, &mut sheet),
        Style::Uncleaned => uncleaned(plan, &mut sheet),
        Style::Outlines => outlines(plan, &corners, &mut sheet),
        Style::Merged => merged(plan, &corners, &mut sheet),
        Style::Exploded | Style::Splines => faces(plan, &corners, true, &mut sheet),
        Style::Through => through(plan, &corners, &mut sheet),
        Style::Finish => {
            faces(plan, &corners, true, &mut sheet);
            faces(plan, &Corners::new(plan, 0.015), false, &mut sheet);
        }
    }
    columns(plan, &mut sheet);
    if office.style == Style::Exploded {
        sheet.explode(true);
    }
    if office.style == Style::Splines {
        sheet.explode(false);
    }
    if office.noise {
        sheet.spoil(&mut dice);
    }
    furnish(plan, &mut sheet);
    sheet.drawing(plan)
}

/// What the understanding gets if layers are read rightly.
pub fn drawn(drawing: &Drawing, office: &Office) -> Drawn {
    let names = LAYERS[office.layers];
    let mut out = Drawn::default();
    let mut wall = 0;
    for (i, e) in drawing.entities.iter().enumerate() {
        let paths = paths_of(&e.shape, |p| p * office.unit_m);
        let at = names.iter().position(|n| *n == e.layer).unwrap_or(4);
        if at < 2 {
            let is_closed = matches!(e.shape, Shape::Circle { .. } | Shape::Polyline { closed: true, .. });
            out.faces.extend(paths.into_iter().enumerate().map(|(part, path)| Face {
                wall,
                part: part as u32,
                path,
                role: if at == 0 { Role::Wall } else { Role::Column },
                is_closed,
                width_m: 0.0,
            }));
            wall += 1;
        } else {
            let role = [Role::Door, Role::Window, Role::Unknown][at - 2];
            let group = if e.blocks.is_empty() { i as u32 } else { 1_000_000 + e.source.record as u32 };
            out.marks.push(Mark { paths, role, group, is_named: true });
        }
    }
    out
}

/// Number of a block insert and the block's name.
type Insert = (usize, &'static str);

/// Entities being drawn, metres until they become a drawing.
struct Sheet {
    entities: Vec<(usize, Shape, Option<Insert>)>,
    office: Office,
}

impl Sheet {
    fn add(&mut self, layer: usize, shape: Shape) {
        self.entities.push((layer, shape, None));
    }

    fn way(&mut self, layer: usize, way: Arc) {
        if way.a.distance(way.b) > 1e-9 {
            self.add(layer, shape_of(way));
        }
    }

    /// Lines as polylines of two points; arcs as their chords, apart or in one polyline.
    fn explode(&mut self, lines: bool) {
        for (layer, shape, insert) in std::mem::take(&mut self.entities) {
            match &shape {
                Shape::Line { a, b } if lines => {
                    self.entities.push((layer, polyline(&[*a, *b]), insert));
                }
                Shape::Arc { .. } => {
                    let points = chords(&shape);
                    if lines {
                        for w in points.windows(2) {
                            self.entities.push((layer, polyline(w), insert));
                        }
                    } else {
                        self.entities.push((layer, polyline(&points), insert));
                    }
                }
                _ => self.entities.push((layer, shape, insert)),
            }
        }
    }

    /// Duplicates, splits with overlap, gaps and overshoots, clicks on the spot.
    fn spoil(&mut self, dice: &mut Dice) {
        let mut out = Vec::new();
        for (layer, shape, insert) in std::mem::take(&mut self.entities) {
            let ends = match &shape {
                Shape::Line { a, b } => Some([*a, *b]),
                Shape::Polyline { vertices, closed: false } if vertices.len() == 2 => {
                    Some([vertices[0].at, vertices[1].at])
                }
                _ => None,
            };
            let again = |p: DVec2, q: DVec2| match &shape {
                Shape::Line { .. } => Shape::Line { a: p, b: q },
                _ => polyline(&[p, q]),
            };
            match ends {
                Some([a, b]) if a.distance(b) > 0.7 && dice.chance(0.7) => {
                    let u = (b - a).normalize();
                    let (p, q) = (a + u * dice.between(-0.015, 0.015), b + u * dice.between(-0.015, 0.015));
                    if dice.chance(0.3) {
                        let m = p.lerp(q, dice.between(0.3, 0.7));
                        out.push((layer, again(p, m + u * dice.between(0.0, 0.1)), insert));
                        out.push((layer, again(q, m - u * dice.between(-0.01, 0.1)), insert));
                    } else {
                        out.push((layer, again(p, q), insert));
                    }
                    if dice.chance(0.1) {
                        out.push((layer, again(q, p), insert));
                    }
                }
                _ => {
                    if dice.chance(0.1) {
                        out.push((layer, shape.clone(), insert));
                    }
                    out.push((layer, shape, insert));
                }
            }
            if dice.chance(0.02) {
                let p = DVec2::new(dice.between(40.0, 50.0), dice.between(-25.0, -15.0));
                out.push((layer, Shape::Line { a: p, b: p }, None));
            }
        }
        self.entities = out;
    }

    fn drawing(self, plan: &Plan) -> Drawing {
        let names = LAYERS[self.office.layers];
        let scale = 1.0 / self.office.unit_m;
        let mut layers: Vec<Layer> = Vec::new();
        let mut entities = Vec::new();
        for (i, (layer, shape, insert)) in self.entities.into_iter().enumerate() {
            let name = names[layer].to_string();
            if !layers.iter().any(|l| l.name == name) {
                layers.push(Layer { name: name.clone(), is_off: false, is_frozen: false, is_locked: false });
            }
            let record = insert.map_or(i, |(n, _)| 100_000 + n);
            entities.push(Entity {
                source: SourceRef {
                    record,
                    handle: Some(format!("{:X}", 0x100 + i)),
                    line: 100 + 20 * i,
                    kind: kind_of(&shape, insert.is_some()).into(),
                    layer: name.clone(),
                },
                layer: name,
                shape: scaled(&shape, scale),
                editable: match insert {
                    Some(_) => Editable::WithInsert { turnable: true },
                    None => Editable::Free,
                },
                blocks: insert.map(|(_, name)| name.to_string()).into_iter().collect(),
                origin: Default::default(),
            });
        }
        Drawing {
            file: format!("{}.dxf", plan.name),
            format: Format::Dxf,
            version: "AC1027 (2013)".into(),
            declared_unit: self.office.declared,
            declared_unit_words: self
                .office
                .declared
                .map_or("no $INSUNITS".into(), |u| format!("$INSUNITS {}", u.name)),
            layers,
            ..Drawing::of(entities)
        }
    }
}

fn kind_of(shape: &Shape, is_insert: bool) -> &'static str {
    match shape {
        _ if is_insert => "INSERT",
        Shape::Line { .. } => "LINE",
        Shape::Polyline { .. } => "LWPOLYLINE",
        Shape::Arc { .. } => "ARC",
        Shape::Circle { .. } => "CIRCLE",
    }
}

fn polyline(points: &[DVec2]) -> Shape {
    Shape::Polyline {
        vertices: points.iter().map(|p| Vertex { at: *p, bulge: 0.0 }).collect(),
        closed: false,
    }
}

fn shape_of(way: Arc) -> Shape {
    if way.is_line() {
        return Shape::Line { a: way.a, b: way.b };
    }
    let c = way.centre();
    let (from, to) = if way.bulge > 0.0 { (way.a, way.b) } else { (way.b, way.a) };
    Shape::Arc {
        centre: c,
        radius: way.radius(),
        start_rad: (from - c).to_angle(),
        end_rad: (to - c).to_angle(),
    }
}

fn chords(shape: &Shape) -> Vec<DVec2> {
    let Shape::Arc { centre, radius, start_rad, end_rad } = shape else { return Vec::new() };
    let sweep = (end_rad - start_rad).rem_euclid(std::f64::consts::TAU);
    // Within 5 mm, as CAD programs trace.
    let step = 2.0 * (1.0 - 0.005 / radius).acos();
    let n = (sweep / step).ceil().max(1.0) as usize;
    (0..=n).map(|k| *centre + DVec2::from_angle(start_rad + sweep * k as f64 / n as f64) * *radius).collect()
}

fn scaled(shape: &Shape, f: f64) -> Shape {
    match shape {
        Shape::Line { a, b } => Shape::Line { a: *a * f, b: *b * f },
        Shape::Polyline { vertices, closed } => Shape::Polyline {
            vertices: vertices.iter().map(|v| Vertex { at: v.at * f, bulge: v.bulge }).collect(),
            closed: *closed,
        },
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            Shape::Arc { centre: *centre * f, radius: radius * f, start_rad: *start_rad, end_rad: *end_rad }
        }
        Shape::Circle { centre, radius } => Shape::Circle { centre: *centre * f, radius: radius * f },
    }
}

fn way_of(plan: &Plan, w: &Wall) -> Arc {
    Arc::new(plan.nodes[w.nodes[0]], plan.nodes[w.nodes[1]], w.bulge)
}

/// Where the sides of walls meet: `at[wall][end][side]`, side 0 left, 1 right from end 0 to end 1.
struct Corners {
    at: Vec<[[DVec2; 2]; 2]>,
    /// Wall ends at each node, anticlockwise.
    around: Vec<Vec<(usize, usize)>>,
}

impl Corners {
    /// Sides moved `inset` towards the middle of the wall.
    fn new(plan: &Plan, inset: f64) -> Self {
        let mut around: Vec<Vec<(usize, usize)>> = vec![Vec::new(); plan.nodes.len()];
        for (i, w) in plan.walls.iter().enumerate() {
            around[w.nodes[0]].push((i, 0));
            around[w.nodes[1]].push((i, 1));
        }
        let out = |(w, e): (usize, usize)| {
            let way = way_of(plan, &plan.walls[w]);
            if e == 0 { way.ahead(0.0) } else { -way.ahead(1.0) }
        };
        for ends in &mut around {
            ends.sort_by(|a, b| out(*a).to_angle().total_cmp(&out(*b).to_angle()));
        }
        let mut at = vec![[[DVec2::ZERO; 2]; 2]; plan.walls.len()];
        for (n, ends) in around.iter().enumerate() {
            for (k, i) in ends.iter().enumerate() {
                let j = ends[(k + 1) % ends.len()];
                let node = plan.nodes[n];
                // The left of i and the right of j, seen outwards.
                let half = |w: usize| plan.walls[w].thickness / 2.0 - inset;
                let p = node + out(*i).perp() * half(i.0);
                let q = node - out(j).perp() * half(j.0);
                if *i == j {
                    at[i.0][i.1][i.1] = p;
                    at[i.0][i.1][1 - i.1] = q;
                    continue;
                }
                let sides = [side(plan, *i, half(i.0)), side(plan, j, -half(j.0))];
                let corner = crossing(sides, [p, q], node);
                at[i.0][i.1][i.1] = corner;
                at[j.0][j.1][1 - j.1] = corner;
            }
        }
        Self { at, around }
    }
}

/// A line (point, direction) or circle (centre, radius).
enum Side {
    Line(DVec2, DVec2),
    Circle(DVec2, f64),
}

/// The side of a wall end `left` metres to the left, seen outwards.
fn side(plan: &Plan, (w, e): (usize, usize), left: f64) -> Side {
    let way = way_of(plan, &plan.walls[w]);
    let left = if e == 0 { left } else { -left };
    if way.is_line() {
        let u = way.ahead(0.0);
        return Side::Line(way.a + u.perp() * left, u);
    }
    Side::Circle(way.centre(), way.radius() - left * way.bulge.signum())
}

fn crossing(sides: [Side; 2], beside: [DVec2; 2], node: DVec2) -> DVec2 {
    let found: Vec<DVec2> = match &sides {
        [Side::Line(p, u), Side::Line(q, v)] if u.perp_dot(*v).abs() > 1e-6 => {
            vec![*p + *u * ((*q - *p).perp_dot(*v) / u.perp_dot(*v))]
        }
        [Side::Line(p, u), Side::Circle(c, r)] | [Side::Circle(c, r), Side::Line(p, u)] => {
            let foot = *p + *u * (*c - *p).dot(*u);
            let half = (r * r - foot.distance_squared(*c)).max(0.0).sqrt();
            vec![foot + *u * half, foot - *u * half]
        }
        [Side::Circle(c, r), Side::Circle(d, q)] => {
            let apart = c.distance(*d);
            let along = (apart * apart + r * r - q * q) / (2.0 * apart);
            let u = (*d - *c) / apart;
            let half = (r * r - along * along).max(0.0).sqrt();
            vec![*c + u * along + u.perp() * half, *c + u * along - u.perp() * half]
        }
        _ => vec![beside[0]],
    };
    found.into_iter().min_by(|a, b| a.distance(node).total_cmp(&b.distance(node))).unwrap()
}

fn centre_lines(plan: &Plan, sheet: &mut Sheet) {
    for w in &plan.walls {
        sheet.way(0, way_of(plan, w));
    }
}

/// Left and right faces of all walls as ways.
fn sides(plan: &Plan, corners: &Corners) -> Vec<Arc> {
    let mut out = Vec::new();
    for (i, w) in plan.walls.iter().enumerate() {
        let way = way_of(plan, w);
        for s in 0..2 {
            out.push(way.beside(corners.at[i][0][s], corners.at[i][1][s]));
        }
    }
    out
}

fn faces(plan: &Plan, corners: &Corners, caps: bool, sheet: &mut Sheet) {
    let mut ways = sides(plan, corners);
    // A face that goes on straight is one line.
    while let Some((i, j, joined)) = straight_on(&ways) {
        ways[i] = joined;
        ways.remove(j);
    }
    ways.into_iter().for_each(|w| sheet.way(0, w));
    if caps {
        for ends in corners.around.iter().filter(|e| e.len() == 1) {
            let [l, r] = corners.at[ends[0].0][ends[0].1];
            sheet.way(0, Arc::new(l, r, 0.0));
        }
    }
}

/// Faces over the gaps, but for passages.
fn through(plan: &Plan, corners: &Corners, sheet: &mut Sheet) {
    let mut ways = sides(plan, corners);
    for g in plan.gaps.iter().filter(|g| g.kind != Kind::Passage) {
        let way = Arc::new(plan.nodes[g.nodes[0]], plan.nodes[g.nodes[1]], g.bulge);
        for side in [-0.5, 0.5] {
            let at = |s: f64| way.at(s) + way.ahead(s).perp() * g.thickness * side;
            ways.push(way.beside(at(0.0), at(1.0)));
        }
    }
    while let Some((i, j, joined)) = straight_on(&ways) {
        ways[i] = joined;
        ways.remove(j);
    }
    ways.into_iter().for_each(|w| sheet.way(0, w));
    for ends in corners.around.iter().filter(|e| e.len() == 1) {
        let [l, r] = corners.at[ends[0].0][ends[0].1];
        sheet.way(0, Arc::new(l, r, 0.0));
    }
}

fn straight_on(ways: &[Arc]) -> Option<(usize, usize, Arc)> {
    for (i, p) in ways.iter().enumerate() {
        for (j, q) in ways.iter().enumerate() {
            if i != j && p.is_line() && q.is_line() && p.length() > 1e-9 && q.length() > 1e-9 {
                for (a, b) in [(p.a, p.b), (p.b, p.a)] {
                    for (c, d) in [(q.a, q.b), (q.b, q.a)] {
                        let on =
                            b.distance(c) < 1e-7 && (b - a).normalize().dot((d - c).normalize()) > 1.0 - 1e-9;
                        if on && p.bulge == q.bulge {
                            return Some((i, j, Arc::new(a, d, 0.0)));
                        }
                    }
                }
            }
        }
    }
    None
}

/// Two lines per wall from the far face of one neighbour to the far face of the other.
fn uncleaned(plan: &Plan, sheet: &mut Sheet) {
    let corners = Corners::new(plan, 0.0);
    for (i, w) in plan.walls.iter().enumerate() {
        let way = way_of(plan, w);
        if !way.is_line() {
            for s in 0..2 {
                sheet.way(0, way.beside(corners.at[i][0][s], corners.at[i][1][s]));
            }
            continue;
        }
        let u = way.ahead(0.0);
        let more = |e: usize| {
            let others = corners.around[w.nodes[e]].iter().filter(|o| o.0 != i);
            let straight = |o: &&(usize, usize)| {
                let v = way_of(plan, &plan.walls[o.0]);
                v.is_line() && v.ahead(0.0).perp_dot(u).abs() > 0.3
            };
            others.filter(straight).map(|o| plan.walls[o.0].thickness / 2.0).fold(0.0, f64::max)
        };
        let (a, b) = (way.a - u * more(0), way.b + u * more(1));
        let h = u.perp() * w.thickness / 2.0;
        sheet.way(0, Arc::new(a + h, b + h, 0.0));
        sheet.way(0, Arc::new(a - h, b - h, 0.0));
        for (e, p) in [(0, a), (1, b)] {
            if corners.around[w.nodes[e]].len() == 1 {
                sheet.way(0, Arc::new(p - h, p + h, 0.0));
            }
        }
    }
}

/// For each wall end the wall end that goes on straight behind the node.
fn partners(plan: &Plan, corners: &Corners) -> Vec<[Option<(usize, usize)>; 2]> {
    let mut out = vec![[None; 2]; plan.walls.len()];
    let dir = |(w, e): (usize, usize)| {
        let way = way_of(plan, &plan.walls[w]);
        if e == 0 { way.ahead(0.0) } else { -way.ahead(1.0) }
    };
    for ends in &corners.around {
        let mut paired = false;
        for i in ends {
            for j in ends {
                let like = plan.walls[i.0].bulge == 0.0
                    && plan.walls[j.0].bulge == 0.0
                    && plan.walls[i.0].thickness == plan.walls[j.0].thickness;
                if !paired && i.0 < j.0 && like && dir(*i).dot(dir(*j)) < -1.0 + 1e-9 {
                    out[i.0][i.1] = Some(*j);
                    out[j.0][j.1] = Some(*i);
                    paired = true;
                }
            }
        }
    }
    out
}

fn outlines(plan: &Plan, corners: &Corners, sheet: &mut Sheet) {
    let partners = partners(plan, corners);
    let mut done = vec![false; plan.walls.len()];
    for i in 0..plan.walls.len() {
        if done[i] {
            continue;
        }
        // To the first wall of the row, then along it.
        let mut first = (i, 0);
        while let Some(next) = partners[first.0][first.1] {
            first = (next.0, 1 - next.1);
        }
        let mut last = (first.0, 1 - first.1);
        done[first.0] = true;
        while let Some(next) = partners[last.0][last.1] {
            done[next.0] = true;
            last = (next.0, 1 - next.1);
        }
        // Seen from the first end to the last.
        let left = |(w, e): (usize, usize), is_first: bool| {
            let forward = if is_first { e == 0 } else { e == 1 };
            corners.at[w][e][usize::from(!forward)]
        };
        let right = |(w, e): (usize, usize), is_first: bool| {
            let forward = if is_first { e == 0 } else { e == 1 };
            corners.at[w][e][usize::from(forward)]
        };
        let way = way_of(plan, &plan.walls[i]);
        let bulge = |a: DVec2, b: DVec2| if way.is_line() { 0.0 } else { way.beside(a, b).bulge };
        let (a, b) = (left(first, true), left(last, false));
        let (c, d) = (right(last, false), right(first, true));
        let mut vertices = vec![Vertex { at: a, bulge: bulge(a, b) }, Vertex { at: b, bulge: 0.0 }];
        vertices.extend(star(plan, corners, &partners, last).map(|at| Vertex { at, bulge: 0.0 }));
        vertices.push(Vertex { at: c, bulge: -bulge(d, c) });
        vertices.push(Vertex { at: d, bulge: 0.0 });
        vertices.extend(star(plan, corners, &partners, first).map(|at| Vertex { at, bulge: 0.0 }));
        sheet.add(0, Shape::Polyline { vertices, closed: true });
    }
}

/// The node itself where three or more walls meet and none goes on straight.
fn star(
    plan: &Plan,
    corners: &Corners,
    partners: &[[Option<(usize, usize)>; 2]],
    (w, e): (usize, usize),
) -> Option<DVec2> {
    let node = plan.walls[w].nodes[e];
    let ends = &corners.around[node];
    (ends.len() > 2 && ends.iter().all(|x| partners[x.0][x.1].is_none())).then(|| plan.nodes[node])
}

fn merged(plan: &Plan, corners: &Corners, sheet: &mut Sheet) {
    // Side 1 (right) is walked from end 0 to end 1, side 0 (left) back.
    let mut done = vec![[false; 2]; plan.walls.len()];
    for start in 0..2 * plan.walls.len() {
        let (mut w, mut s) = (start / 2, start % 2);
        if done[w][s] {
            continue;
        }
        let mut vertices: Vec<Vertex> = Vec::new();
        while !done[w][s] {
            done[w][s] = true;
            let (from, to) = if s == 1 { (0, 1) } else { (1, 0) };
            let (a, b) = (corners.at[w][from][s], corners.at[w][to][s]);
            let way = way_of(plan, &plan.walls[w]);
            let bulge = match (way.is_line(), s) {
                (true, _) => 0.0,
                (_, 1) => way.beside(a, b).bulge,
                _ => -way.beside(b, a).bulge,
            };
            push(&mut vertices, Vertex { at: a, bulge });
            push(&mut vertices, Vertex { at: b, bulge: 0.0 });
            let ends = &corners.around[plan.walls[w].nodes[to]];
            let k = ends.iter().position(|x| *x == (w, to)).unwrap();
            let next = ends[(k + 1) % ends.len()];
            (w, s) = (next.0, if next.1 == 0 { 1 } else { 0 });
        }
        if vertices.len() > 1 && vertices[0].at.distance(vertices[vertices.len() - 1].at) < 1e-9 {
            vertices.pop();
        }
        sheet.add(0, Shape::Polyline { vertices, closed: true });
    }
}

fn push(vertices: &mut Vec<Vertex>, v: Vertex) {
    if let Some(last) = vertices.last_mut()
        && last.at.distance(v.at) < 1e-9
    {
        last.bulge = v.bulge;
        return;
    }
    let n = vertices.len();
    if n >= 2 && vertices[n - 2].bulge == 0.0 && vertices[n - 1].bulge == 0.0 {
        let (p, q) = (vertices[n - 2].at, vertices[n - 1].at);
        if (q - p).normalize().dot((v.at - q).normalize()) > 1.0 - 1e-12 {
            vertices[n - 1] = v;
            return;
        }
    }
    vertices.push(v);
}

fn columns(plan: &Plan, sheet: &mut Sheet) {
    for c in &plan.columns {
        match c {
            Column::Round { centre, radius } => {
                sheet.add(1, Shape::Circle { centre: *centre, radius: *radius });
            }
            Column::Box { corners } if matches!(sheet.office.style, Style::Exploded | Style::FacePairs) => {
                for (i, p) in corners.iter().enumerate() {
                    sheet.way(1, Arc::new(*p, corners[(i + 1) % corners.len()], 0.0));
                }
            }
            Column::Box { corners } => {
                let vertices = corners.iter().map(|p| Vertex { at: *p, bulge: 0.0 }).collect();
                sheet.add(1, Shape::Polyline { vertices, closed: true });
            }
        }
    }
}

/// Doors with leaf and swing, windows with their panes.
fn furnish(plan: &Plan, sheet: &mut Sheet) {
    for (n, g) in plan.gaps.iter().enumerate() {
        let way = Arc::new(plan.nodes[g.nodes[0]], plan.nodes[g.nodes[1]], g.bulge);
        let first = sheet.entities.len();
        let name = match g.kind {
            Kind::Passage => continue,
            Kind::Door => {
                let hinge = way.a + way.ahead(0.0).perp() * g.thickness / 2.0;
                let (radius, start) = (way.a.distance(way.b), (way.b - way.a).to_angle());
                let end_rad = start + std::f64::consts::FRAC_PI_2;
                sheet.add(2, Shape::Arc { centre: hinge, radius, start_rad: start, end_rad });
                sheet.add(2, Shape::Line { a: hinge, b: hinge + DVec2::from_angle(end_rad) * radius });
                "DOOR_90"
            }
            Kind::Window => {
                for share in [-0.5, -0.1, 0.1, 0.5] {
                    let h = |s: f64| way.ahead(s).perp() * g.thickness * share;
                    sheet.way(3, way.beside(way.a + h(0.0), way.b + h(1.0)));
                }
                "WINDOW-2"
            }
        };
        if sheet.office.blocks {
            sheet.entities[first..].iter_mut().for_each(|e| e.2 = Some((n, name)));
        }
    }
}
