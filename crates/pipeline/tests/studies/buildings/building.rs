//! A small exhibition house, written three times: as IFC, as binary glTF and as DXF.

use std::fmt::Write as _;

/// Height of every wall, metres.
const HEIGHT: f64 = 3.0;

/// What fills a hole in a wall.
#[derive(Clone, Copy, PartialEq)]
pub enum Filling {
    /// A door down to the floor.
    Door,
    /// A window above a sill.
    Window,
}

/// A hole in a wall.
#[derive(Clone, Copy)]
pub struct Hole {
    /// Where it begins along the wall, metres.
    pub from: f64,
    /// How wide it is.
    pub width: f64,
    /// From which height to which.
    pub heights: [f64; 2],
    /// What fills it.
    pub filling: Filling,
}

/// A straight wall.
pub struct Wall {
    /// Its name.
    pub name: &'static str,
    /// Ends of its axis, metres.
    pub ends: [[f64; 2]; 2],
    /// Thickness.
    pub thickness: f64,
    /// Holes, in order.
    pub holes: Vec<Hole>,
    /// What may move, as in `Pset_Enfilade`.
    pub moves: Option<&'static str>,
}

impl Wall {
    fn length(&self) -> f64 {
        let [a, b] = self.ends;
        (b[0] - a[0]).hypot(b[1] - a[1])
    }

    fn direction(&self) -> [f64; 2] {
        let ([a, b], l) = (self.ends, self.length());
        [(b[0] - a[0]) / l, (b[1] - a[1]) / l]
    }

    /// A point by its place along and beside the axis.
    fn at(&self, along: f64, beside: f64) -> [f64; 2] {
        let (a, d) = (self.ends[0], self.direction());
        [a[0] + d[0] * along - d[1] * beside, a[1] + d[1] * along + d[0] * beside]
    }

    /// Boxes that the wall is made of: along from, to; height from, to.
    fn boxes(&self) -> Vec<[f64; 4]> {
        let mut out = Vec::new();
        let mut from = 0.0;
        for h in &self.holes {
            out.push([from, h.from, 0.0, HEIGHT]);
            if h.heights[0] > 0.0 {
                out.push([h.from, h.from + h.width, 0.0, h.heights[0]]);
            }
            out.push([h.from, h.from + h.width, h.heights[1], HEIGHT]);
            from = h.from + h.width;
        }
        out.push([from, self.length(), 0.0, HEIGHT]);
        out
    }
}

/// The house: a hall of 14 by 8 metres with a store, two screens and a column.
pub fn house() -> Vec<Wall> {
    let door = |from: f64| Hole { from, width: 1.0, heights: [0.0, 2.1], filling: Filling::Door };
    let window = |from: f64| Hole { from, width: 1.5, heights: [0.9, 2.2], filling: Filling::Window };
    let wall = |name, ends, thickness, holes| Wall { name, ends, thickness, holes, moves: None };
    let screen =
        |name, ends, moves| Wall { name, ends, thickness: 0.15, holes: Vec::new(), moves: Some(moves) };
    vec![
        wall("South", [[0.0, 0.15], [14.0, 0.15]], 0.3, vec![door(6.0), window(10.0)]),
        wall("East", [[13.85, 0.3], [13.85, 7.7]], 0.3, vec![window(2.0)]),
        wall("North", [[14.0, 7.85], [0.0, 7.85]], 0.3, vec![window(3.0), window(9.0)]),
        wall("West", [[0.15, 7.7], [0.15, 0.3]], 0.3, Vec::new()),
        wall("Store", [[4.0, 0.3], [4.0, 7.7]], 0.2, vec![door(3.0)]),
        screen("Screen A", [[6.0, 4.5], [9.0, 4.5]], "x -1 1; y -1 1; rotate -30 30"),
        screen("Screen B", [[11.0, 2.5], [11.0, 5.0]], "x -1 1; y -1 1"),
    ]
}

/// Corners of the column.
const COLUMN: [[f64; 2]; 4] = [[9.8, 6.3], [10.2, 6.3], [10.2, 6.7], [9.8, 6.7]];

/// Corners of the hall, where is measured.
pub const HALL: [[f64; 2]; 4] = [[4.1, 0.3], [13.7, 0.3], [13.7, 7.7], [4.1, 7.7]];

/// 22 characters as a GlobalId has, by number.
fn global_id(n: usize) -> String {
    format!("2EnfiladeHouse0000{n:04}")
}

/// The instances of an IFC file as they come.
#[derive(Default)]
struct Step {
    text: String,
    next: usize,
    global: usize,
}

impl Step {
    fn add(&mut self, instance: &str) -> usize {
        self.next += 1;
        let _ = writeln!(self.text, "#{}={instance};", self.next);
        self.next
    }

    fn root(&mut self, class: &str, rest: &str) -> usize {
        self.global += 1;
        let id = global_id(self.global);
        self.add(&format!("{class}('{id}',$,{rest})"))
    }

    fn point(&mut self, p: &[f64]) -> usize {
        let list: Vec<String> = p.iter().map(|v| real(*v)).collect();
        self.add(&format!("IFCCARTESIANPOINT(({}))", list.join(",")))
    }

    fn direction(&mut self, p: &[f64]) -> usize {
        let list: Vec<String> = p.iter().map(|v| real(*v)).collect();
        self.add(&format!("IFCDIRECTION(({}))", list.join(",")))
    }

    /// A placement in another, in millimetres, turned to a direction.
    fn placed(&mut self, parent: Option<usize>, at: [f64; 3], x: [f64; 2]) -> usize {
        let (p, z) = (self.point(&at.map(|v| v * 1e3)), self.direction(&[0.0, 0.0, 1.0]));
        let x = self.direction(&[x[0], x[1], 0.0]);
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{p},#{z},#{x})"));
        let parent = parent.map_or("$".into(), |n| format!("#{n}"));
        self.add(&format!("IFCLOCALPLACEMENT({parent},#{axes})"))
    }

    /// A body: a rectangle from x = 0, or a ring of corners, extruded upwards.
    fn body(&mut self, context: usize, ring: &[[f64; 2]], height: f64) -> usize {
        let mut points: Vec<usize> = ring.iter().map(|p| self.point(&p.map(|v| v * 1e3))).collect();
        points.push(points[0]);
        let line = self.add(&format!("IFCPOLYLINE({})", refs(&points)));
        let profile = self.add(&format!("IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{line})"));
        let (o, z) = (self.point(&[0.0, 0.0, 0.0]), self.direction(&[0.0, 0.0, 1.0]));
        let axes = self.add(&format!("IFCAXIS2PLACEMENT3D(#{o},$,$)"));
        let solid =
            self.add(&format!("IFCEXTRUDEDAREASOLID(#{profile},#{axes},#{z},{})", real(height * 1e3)));
        let shape = self.add(&format!("IFCSHAPEREPRESENTATION(#{context},'Body','SweptSolid',(#{solid}))"));
        self.add(&format!("IFCPRODUCTDEFINITIONSHAPE($,$,(#{shape}))"))
    }
}

fn real(v: f64) -> String {
    let v = (v * 1e9).round() / 1e9 + 0.0;
    let text = format!("{v}");
    if text.contains('.') { text } else { format!("{text}.") }
}

fn refs(list: &[usize]) -> String {
    let list: Vec<String> = list.iter().map(|n| format!("#{n}")).collect();
    format!("({})", list.join(","))
}

/// The walls as IFC4, millimetres.
pub fn ifc(walls: &[Wall]) -> String {
    let mut s = Step::default();
    let millimetre = s.add("IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.)");
    let radian = s.add("IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.)");
    let units = s.add(&format!("IFCUNITASSIGNMENT((#{millimetre},#{radian}))"));
    let origin = s.point(&[0.0, 0.0, 0.0]);
    let axes = s.add(&format!("IFCAXIS2PLACEMENT3D(#{origin},$,$)"));
    let context = s.add(&format!("IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#{axes},$)"));
    let project = s.root("IFCPROJECT", &format!("'House',$,$,$,$,(#{context}),#{units}"));
    let site_at = s.placed(None, [0.0; 3], [1.0, 0.0]);
    let site = s.root("IFCSITE", &format!("'Site',$,$,#{site_at},$,$,.ELEMENT.,$,$,$,$,$"));
    let house_at = s.placed(Some(site_at), [0.0; 3], [1.0, 0.0]);
    let house = s.root("IFCBUILDING", &format!("'House',$,$,#{house_at},$,$,.ELEMENT.,$,$,$"));
    let floor_at = s.placed(Some(house_at), [0.0; 3], [1.0, 0.0]);
    let floor = s.root("IFCBUILDINGSTOREY", &format!("'Ground floor',$,$,#{floor_at},$,$,.ELEMENT.,0."));
    s.root("IFCRELAGGREGATES", &format!("$,$,#{project},(#{site})"));
    s.root("IFCRELAGGREGATES", &format!("$,$,#{site},(#{house})"));
    s.root("IFCRELAGGREGATES", &format!("$,$,#{house},(#{floor})"));
    let mut inside = Vec::new();
    for wall in walls {
        inside.extend(ifc_wall(&mut s, wall, context, floor_at));
    }
    let column_at = s.placed(Some(floor_at), [0.0; 3], [1.0, 0.0]);
    let body = s.body(context, &COLUMN, HEIGHT);
    inside.push(s.root("IFCCOLUMN", &format!("'Column',$,$,#{column_at},#{body},'900',.COLUMN.")));
    s.root("IFCRELCONTAINEDINSPATIALSTRUCTURE", &format!("$,$,{},#{floor}", refs(&inside)));
    let hall_at = s.placed(Some(floor_at), [0.0; 3], [1.0, 0.0]);
    let body = s.body(context, &HALL, HEIGHT);
    let hall =
        s.root("IFCSPACE", &format!("'1',$,$,#{hall_at},#{body},'Gallery hall',.ELEMENT.,.INTERNAL.,$"));
    s.root("IFCRELAGGREGATES", &format!("$,$,#{floor},(#{hall})"));
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('ViewDefinition [ReferenceView]'),'2;1');\n\
         FILE_NAME('house.ifc','2026-01-01T00:00:00',(''),(''),'','','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\n\
         DATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
        s.text
    )
}

/// One wall with its openings; what the storey contains.
fn ifc_wall(s: &mut Step, wall: &Wall, context: usize, floor_at: usize) -> Vec<usize> {
    let (a, d, t) = (wall.ends[0], wall.direction(), wall.thickness / 2.0);
    let at = s.placed(Some(floor_at), [a[0], a[1], 0.0], d);
    let l = wall.length();
    let body = s.body(context, &[[0.0, -t], [l, -t], [l, t], [0.0, t]], HEIGHT);
    let tag = 100 + s.global;
    let id = s.root("IFCWALL", &format!("'{}',$,$,#{at},#{body},'{tag}',.SOLIDWALL.", wall.name));
    let mut out = vec![id];
    for hole in &wall.holes {
        let height = hole.heights[1] - hole.heights[0];
        let hole_at = s.placed(Some(at), [hole.from, 0.0, hole.heights[0]], [1.0, 0.0]);
        let (w, depth) = (hole.width, t + 0.1);
        let ring = [[0.0, -depth], [w, -depth], [w, depth], [0.0, depth]];
        let body = s.body(context, &ring, height);
        let opening = s.root("IFCOPENINGELEMENT", &format!("$,$,$,#{hole_at},#{body},$,.OPENING."));
        s.root("IFCRELVOIDSELEMENT", &format!("$,$,#{id},#{opening}"));
        let fill_at = s.placed(Some(hole_at), [0.0; 3], [1.0, 0.0]);
        let body = s.body(context, &[[0.0, -0.03], [w, -0.03], [w, 0.03], [0.0, 0.03]], height);
        let (class, kind) = match hole.filling {
            Filling::Door => ("IFCDOOR", ".DOOR.,.SINGLE_SWING_LEFT.,$"),
            Filling::Window => ("IFCWINDOW", ".WINDOW.,.SINGLE_PANEL.,$"),
        };
        let (h, w, tag) = (real(height * 1e3), real(w * 1e3), 500 + s.global);
        let filler = s.root(class, &format!("$,$,$,#{fill_at},#{body},'{tag}',{h},{w},{kind}"));
        s.root("IFCRELFILLSELEMENT", &format!("$,$,#{opening},#{filler}"));
        out.push(filler);
    }
    if let Some(moves) = wall.moves {
        let p = s.add(&format!("IFCPROPERTYSINGLEVALUE('Move',$,IFCTEXT('{moves}'),$)"));
        let set = s.root("IFCPROPERTYSET", &format!("'Pset_Enfilade',$,(#{p})"));
        s.root("IFCRELDEFINESBYPROPERTIES", &format!("$,$,(#{id}),#{set}"));
    }
    out
}

/// The walls as glTF 2.0 in its binary container: a node a wall, metres, y up.
pub fn glb(walls: &[Wall]) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let (mut nodes, mut meshes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut mesh = |name: String, boxes: Vec<[[f64; 2]; 4]>, heights: Vec<[f64; 2]>, extras: Option<&str>| {
        let mut points: Vec<[f32; 3]> = Vec::new();
        let mut triangles: Vec<u16> = Vec::new();
        for (ring, [lo, hi]) in boxes.iter().zip(&heights) {
            let base = points.len() as u16;
            for z in [lo, hi] {
                points.extend(ring.iter().map(|p| [p[0] as f32, *z as f32, -p[1] as f32]));
            }
            let quads = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
            for [a, b, c, d] in quads {
                triangles.extend([a, b, c, a, c, d].map(|i| base + i));
            }
        }
        let bound =
            |k: usize, pick: fn(f32, f32) -> f32| points.iter().map(|p| p[k]).reduce(pick).unwrap_or(0.0);
        let (lo, hi) = ([0, 1, 2].map(|k| bound(k, f32::min)), [0, 1, 2].map(|k| bound(k, f32::max)));
        let start = bin.len();
        bin.extend(points.iter().flatten().flat_map(|v| v.to_le_bytes()));
        let middle = bin.len();
        bin.extend(triangles.iter().flat_map(|v| v.to_le_bytes()));
        let end = bin.len();
        while !bin.len().is_multiple_of(4) {
            bin.push(0);
        }
        let n = views.len();
        views.push(serde_json::json!({"buffer": 0, "byteOffset": start, "byteLength": middle - start, "target": 34962}));
        views.push(serde_json::json!({"buffer": 0, "byteOffset": middle, "byteLength": end - middle, "target": 34963}));
        accessors.push(serde_json::json!({"bufferView": n, "componentType": 5126, "count": points.len(), "type": "VEC3", "min": lo, "max": hi}));
        accessors.push(serde_json::json!({"bufferView": n + 1, "componentType": 5123, "count": triangles.len(), "type": "SCALAR"}));
        meshes.push(serde_json::json!({"primitives": [{"attributes": {"POSITION": n}, "indices": n + 1}]}));
        let mut node = serde_json::json!({"name": name, "mesh": meshes.len() - 1});
        if let Some(moves) = extras {
            node["extras"] = serde_json::json!({"enfilade": {"move": moves}});
        }
        nodes.push(node);
    };
    for wall in walls {
        let (boxes, t) = (wall.boxes(), wall.thickness / 2.0);
        let ring = |b: &[f64; 4]| [wall.at(b[0], -t), wall.at(b[1], -t), wall.at(b[1], t), wall.at(b[0], t)];
        let rings = boxes.iter().map(ring).collect();
        mesh(
            format!("IfcWall/{}", wall.name),
            rings,
            boxes.iter().map(|b| [b[2], b[3]]).collect(),
            wall.moves,
        );
    }
    mesh("IfcColumn/Column".into(), vec![COLUMN], vec![[0.0, HEIGHT]], None);
    let list: Vec<usize> = (0..nodes.len()).collect();
    let json = serde_json::json!({
        "asset": {"version": "2.0", "generator": "Enfilade samples"},
        "scene": 0, "scenes": [{"nodes": list}], "nodes": nodes, "meshes": meshes,
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": bin.len()}],
    });
    let mut text = json.to_string().into_bytes();
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    let total = 12 + 8 + text.len() + 8 + bin.len();
    let mut out = b"glTF".to_vec();
    for word in [2, total as u32, text.len() as u32, 0x4E4F_534A] {
        out.extend(word.to_le_bytes());
    }
    out.extend(text);
    for word in [bin.len() as u32, 0x004E_4942] {
        out.extend(word.to_le_bytes());
    }
    out.extend(bin);
    out
}

/// What of the walls stands at a height, as closed outlines on the layer WALL; drawing unit metre.
pub fn dxf(walls: &[Wall], height: f64) -> String {
    let mut rings: Vec<[[f64; 2]; 4]> = Vec::new();
    for wall in walls {
        let t = wall.thickness / 2.0;
        let cut = wall.boxes().into_iter().filter(|b| b[2] <= height && height <= b[3]);
        rings.extend(cut.map(|b| [wall.at(b[0], -t), wall.at(b[1], -t), wall.at(b[1], t), wall.at(b[0], t)]));
    }
    rings.push(COLUMN);
    let mut out = String::from(
        "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n",
    );
    for ring in rings {
        out.push_str("0\nLWPOLYLINE\n8\nWALL\n90\n4\n70\n1\n");
        for [x, y] in ring {
            let _ = write!(out, "10\n{x}\n20\n{y}\n");
        }
    }
    out.push_str("0\nENDSEC\n0\nEOF\n");
    out
}
