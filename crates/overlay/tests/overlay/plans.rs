//! Plans to draw: made here, or read from the reference drawings where those are at hand.

use std::path::PathBuf;

use enfilade_overlay::picture::{Cell, PlanPicture, RegionKind, RegionOutline, Stroke, StrokeKind};

/// The folder with reference drawings, if this machine has it.
pub fn shared() -> Option<PathBuf> {
    let beside = || enfilade_fixtures::repository("../shared");
    let folder = std::env::var_os("ENFILADE_SHARED").map_or_else(beside, PathBuf::from);
    folder.is_dir().then_some(folder)
}

/// With `ENFILADE_LOOK=DIR` writes what a test drew there, to be looked at.
pub fn look(name: &str, bytes: &[u8]) {
    if let Some(folder) = std::env::var_os("ENFILADE_LOOK") {
        std::fs::write(PathBuf::from(folder).join(name), bytes).unwrap();
    }
}

/// Width, height and pixels of an RGB picture.
pub fn pixels(png: &[u8]) -> (usize, usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut rgb).unwrap();
    (info.width as usize, info.height as usize, rgb.as_chunks::<3>().0.to_vec())
}

pub fn stroke(points: &[[f64; 2]], kind: StrokeKind) -> Stroke {
    Stroke { points: points.to_vec(), closed: false, filled: false, kind }
}

pub fn solid(points: &[[f64; 2]], kind: StrokeKind) -> Stroke {
    Stroke { points: points.to_vec(), closed: true, filled: true, kind }
}

/// A hall of that size in metres with two thick partitions, a column, a ghost and a moved wall.
pub fn hall(wide: f64, high: f64) -> PlanPicture {
    use StrokeKind::{Before, Fixed, Ignored, Movable, Moved, Opening};
    let at = |x: f64, y: f64| [x * wide, y * high];
    let bar = |x: f64, y0: f64, y1: f64, kind| {
        let t = 0.08;
        let [lo, hi] = [at(x, y0), at(x, y1)];
        solid(&[[lo[0] - t, lo[1]], [lo[0] + t, lo[1]], [hi[0] + t, hi[1]], [hi[0] - t, hi[1]]], kind)
    };
    let outer = Stroke { closed: true, ..stroke(&[at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.)], Fixed) };
    let strokes = vec![
        outer,
        bar(0.3, 0.0, 0.4, Fixed),
        bar(0.3, 0.6, 1.0, Movable),
        stroke(&[at(0.3, 0.4), at(0.3, 0.6)], Opening),
        bar(0.65, 0.2, 0.8, Before),
        bar(0.72, 0.2, 0.8, Moved),
        solid(&[at(0.48, 0.46), at(0.52, 0.46), at(0.52, 0.54), at(0.48, 0.54)], Fixed),
        stroke(&[at(0.05, 0.1), at(0.12, 0.2), at(0.2, 0.1)], Ignored),
    ];
    let ring = |x0, y0, x1, y1| vec![at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)];
    let regions = vec![
        RegionOutline { points: ring(0.02, 0.05, 0.28, 0.95), kind: RegionKind::Query },
        RegionOutline { points: ring(0.32, 0.05, 0.98, 0.95), kind: RegionKind::Reference },
        RegionOutline { points: ring(0.6, 0.15, 0.7, 0.85), kind: RegionKind::Move },
        RegionOutline { points: ring(0.46, 0.42, 0.54, 0.58), kind: RegionKind::Keep },
    ];
    PlanPicture { strokes, regions, bounds: [[0.0, 0.0], [wide, high]], ..PlanPicture::default() }
}

/// About `count` cells over the hall; a fifth of them has no value.
pub fn cells(wide: f64, high: f64, count: f64) -> (Vec<Cell>, f64) {
    let spacing = (wide * high / count).sqrt();
    let (cols, rows) = ((wide / spacing) as usize, (high / spacing) as usize);
    let cell = |c: usize, r: usize| {
        let centre = [(c as f64 + 0.5) * spacing, (r as f64 + 0.5) * spacing];
        let (x, y) = (centre[0] / wide, centre[1] / high);
        let value = 40.0 + 30.0 * (7.0 * x).sin() * (5.0 * y).cos() + 10.0 * x;
        Cell { centre, value: (x < 0.8).then_some(value) }
    };
    let all = (0..cols.max(1)).flat_map(|c| (0..rows.max(1)).map(move |r| (c, r)));
    (all.map(|(c, r)| cell(c, r)).collect(), spacing)
}

/// Lines and closed outlines of an ASCII DXF by layer, nothing else understood.
pub fn dxf_lines(text: &str) -> Vec<(String, Stroke)> {
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let mut out: Vec<(String, Stroke)> = Vec::new();
    let mut kind = "";
    for pair in lines.chunks_exact(2) {
        let (code, value) = (pair[0], pair[1]);
        if code == "0" {
            kind = value;
            if matches!(kind, "LINE" | "LWPOLYLINE") {
                out.push((String::new(), stroke(&[], StrokeKind::Fixed)));
            }
            continue;
        }
        let (true, Some((layer, s))) = (matches!(kind, "LINE" | "LWPOLYLINE"), out.last_mut()) else {
            continue;
        };
        match code {
            "8" => *layer = value.to_owned(),
            "10" | "11" => s.points.push([value.parse().unwrap(), 0.0]),
            "20" | "21" => s.points.last_mut().unwrap()[1] = value.parse().unwrap(),
            "70" if kind == "LWPOLYLINE" => s.closed = value.parse::<i32>().unwrap() & 1 == 1,
            _ => {}
        }
    }
    out
}

/// The reference maze with its markers and the degree of its query cells at 1 m.
pub fn maze() -> Option<(PlanPicture, Vec<Cell>)> {
    let folder = shared()?.join("reference");
    let text = std::fs::read_to_string(folder.join("maze_a.dxf")).ok()?;
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("maze_a.vertices.json")).ok()?).ok()?;
    let mut picture = PlanPicture::default();
    for (layer, s) in dxf_lines(&text) {
        let kind = match layer.as_str() {
            "EF-QUERY" => RegionKind::Query,
            "EF-REFERENCE" => RegionKind::Reference,
            "EF-MOVE" => RegionKind::Move,
            _ => {
                picture.strokes.push(s);
                continue;
            }
        };
        picture.regions.push(RegionOutline { points: s.points, kind });
    }
    picture.bounds = picture.extent();
    let per_vertex = &json["per_vertex"];
    let mut cells: Vec<Cell> = Vec::new();
    for (xy, degree) in per_vertex["xy"].as_array()?.iter().zip(per_vertex["degree"].as_array()?) {
        let centre = [xy[0].as_f64()?, xy[1].as_f64()?];
        cells.push(Cell { centre, value: degree.as_f64() });
    }
    for c in 0..20 {
        for r in 0..20 {
            let centre = [0.47 + f64::from(c), 0.37 + f64::from(r)];
            if !cells.iter().any(|k| (k.centre[0] - centre[0]).hypot(k.centre[1] - centre[1]) < 0.1) {
                cells.push(Cell { centre, value: None });
            }
        }
    }
    Some((picture, cells))
}

/// A building of 900 cells with a column of depthmapX's values.
pub fn building(column: &str) -> Option<(PlanPicture, Vec<Cell>)> {
    let folder = shared()?.join("reference/depthmapx-n900");
    let text = std::fs::read_to_string(folder.join("plan.dxf")).ok()?;
    let strokes: Vec<Stroke> = dxf_lines(&text).into_iter().map(|(_, s)| s).collect();
    let mut picture = PlanPicture { strokes, ..PlanPicture::default() };
    picture.bounds = picture.extent();
    let table = std::fs::read_to_string(folder.join("cells.csv")).ok()?;
    let mut rows = table.lines();
    let at = rows.next()?.split(',').position(|name| name == column)?;
    let cell = |row: &str| {
        let fields: Vec<&str> = row.split(',').collect();
        Some(Cell {
            centre: [fields[1].parse().ok()?, fields[2].parse().ok()?],
            value: fields[at].parse().ok(),
        })
    };
    Some((picture, rows.filter_map(cell).collect()))
}
