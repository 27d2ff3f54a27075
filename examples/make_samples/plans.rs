//! The plans themselves. Every line was made up for this project; coordinates are in drawing units.

use super::dxf::{Point, Sheet, Version};
use super::{building, gltf, ifc};

const METRE: Option<u32> = Some(6);
const CENTIMETRE: Option<u32> = Some(5);
const MILLIMETRE: Option<u32> = Some(4);
const INCH: Option<u32> = Some(1);

const NOTE: &str = "A-ANNO-TEXT";
const QUERY: &str = "EF-QUERY";
const REFERENCE: &str = "EF-REFERENCE";
const MOVE: &str = "EF-MOVE";
const KEEP: &str = "EF-KEEP";

/// All samples: file name and contents.
pub fn all() -> Vec<(&'static str, Vec<u8>)> {
    let drawings = [
        ("gallery.dxf", gallery()),
        ("office.dxf", office()),
        ("museum-hall.dxf", museum_hall()),
        ("station.dxf", station()),
        ("maze.dxf", maze()),
        ("library.dxf", library()),
        ("marker-template.dxf", marker_template()),
        ("pavilion.dxf", building::drawing()),
        ("pavilion.ifc", ifc::building(false)),
    ];
    let texts = drawings.into_iter().map(|(name, text)| (name, text.into_bytes()));
    texts.chain([("pavilion.glb", gltf::building())]).collect()
}

/// A sheet with the walls' layer and ours.
fn sheet(version: Version, insunits: Option<u32>, wall_layer: &'static str) -> Sheet {
    let mut sheet = Sheet::new(version, insunits);
    sheet.layer(wall_layer, 7);
    sheet.layer(NOTE, 8);
    for (name, colour) in [(QUERY, 5), (REFERENCE, 3), (MOVE, 1), (KEEP, 8)] {
        sheet.layer(name, colour);
    }
    sheet
}

/// A movable group: the box that encloses its nodes, and the words inside.
fn movable(sheet: &mut Sheet, low: Point, high: Point, height: f64, words: &str) {
    sheet.rectangle(MOVE, low, high);
    sheet.text(MOVE, (low.0 + 0.4 * height, low.1 + 0.4 * height), height, words);
}

/// The outline of a thick free-standing wall, `long` from left to right, as one closed polyline.
fn slab(sheet: &mut Sheet, layer: &'static str, centre: Point, long: f64, thick: f64, is_upright: bool) {
    let (dx, dy) = if is_upright { (thick / 2.0, long / 2.0) } else { (long / 2.0, thick / 2.0) };
    sheet.rectangle(layer, (centre.0 - dx, centre.1 - dy), (centre.0 + dx, centre.1 + dy));
}

/// A small art gallery, walls as single lines, metres.
fn gallery() -> String {
    let wall = "A-WALL";
    let mut s = sheet(Version::R2010, METRE, wall);
    s.text(NOTE, (0.0, 13.01), 0.3, "Small gallery. Screens and doors may move:");
    s.text(NOTE, (0.0, 12.5), 0.3, "where do visitors see far, but not all at once?");
    s.lines(wall, &[(5.4, 0.0), (18.0, 0.0), (18.0, 12.0), (0.0, 12.0), (0.0, 0.0), (3.0, 0.0)]);
    s.line(wall, (7.0, 0.0), (7.0, 2.6));
    s.line(wall, (7.0, 4.4), (7.0, 12.0));
    s.line(wall, (7.0, 6.5), (11.0, 6.5));
    s.line(wall, (12.8, 6.5), (18.0, 6.5));
    s.line(wall, (2.0, 4.5), (5.0, 4.5));
    s.line(wall, (1.8, 8.6), (5.2, 8.6));
    s.line(wall, (10.0, 3.2), (14.0, 3.2));
    s.line(wall, (15.2, 8.2), (15.2, 10.6));
    s.line(wall, (9.6, 9.2), (12.2, 9.2));
    movable(&mut s, (1.6, 4.1), (5.4, 4.9), 0.13, "name screen-1; x -1 1; y -1.2 1.5");
    movable(&mut s, (1.4, 8.2), (5.6, 9.0), 0.13, "name screen-2; y -1.2 1.8; rotate -40 40");
    movable(&mut s, (9.6, 2.8), (14.4, 3.6), 0.13, "name screen-3; x -2 2; y -1.2 1.8; rotate -30 30");
    movable(&mut s, (14.8, 7.8), (15.6, 11.0), 0.13, "name screen-4; x -1.5 1.5; rotate -90 90");
    movable(&mut s, (9.2, 8.8), (12.6, 9.6), 0.13, "name screen-5; x -1 1.2; y -1 1");
    movable(&mut s, (6.7, 2.3), (7.3, 4.7), 0.13, "name door-west; y -1.6 1.2");
    movable(&mut s, (10.7, 6.2), (13.1, 6.8), 0.13, "name door-north; x -2.4 3");
    s.rectangle(QUERY, (0.5, 0.4), (6.5, 3.2));
    s.rectangle(REFERENCE, (0.2, 0.2), (17.8, 11.8));
    s.write()
}

/// An office floor, millimetres, partitions as outlines, markers as MTEXT.
fn office() -> String {
    let wall = "WALLS";
    let mut s = sheet(Version::R2010, MILLIMETRE, wall);
    s.text(
        NOTE,
        (0.0, 1.68e+04),
        400.0,
        "Office floor. The reception (circle) should have the open plan in view.",
    );
    s.rectangle(wall, (0.0, 0.0), (30000.0, 16000.0));
    let doors =
        [(2450.0, 3550.0), (8700.0, 9800.0), (14700.0, 15800.0), (20450.0, 21550.0), (26450.0, 27550.0)];
    let mut from = 0.0;
    for (left, right) in doors {
        s.line(wall, (from, 9000.0), (left, 9000.0));
        from = right;
    }
    s.line(wall, (from, 9000.0), (30000.0, 9000.0));
    for x in [6000.0, 12500.0, 18000.0, 24000.0] {
        s.line(wall, (x, 9000.0), (x, 16000.0));
    }
    s.lines(wall, &[(26500.0, 0.0), (26500.0, 2800.0), (27700.0, 2800.0)]);
    s.line(wall, (28900.0, 2800.0), (30000.0, 2800.0));
    let mut group = |low: Point, high: Point, words: &str| {
        s.rectangle(MOVE, low, high);
        s.mtext(MOVE, (low.0 + 80.0, high.1 - 80.0), 160.0, high.0 - low.0 - 160.0, words);
    };
    group((2150.0, 8600.0), (3850.0, 9400.0), "name door-1; x -1200 900");
    group((8400.0, 8600.0), (10100.0, 9400.0), "name door-2; x -900 1200");
    group((20150.0, 8600.0), (21850.0, 9400.0), "name door-4; x -1.2m 1.2m");
    group((5600.0, 8600.0), (6400.0, 16400.0), "name wall-1-2; x -800 800");
    group((17600.0, 8600.0), (18400.0, 16400.0), "name wall-3-4; x -1m 1m");
    group((7000.0, 4500.0), (11000.0, 5500.0), "name partition-1; x -1500 1500; y -1500 1500");
    group((14500.0, 2000.0), (15500.0, 6000.0), "name partition-2; x -1500 1500; rotate -45 45");
    group((19000.0, 4700.0), (23000.0, 5700.0), "name partition-3; x -1000 1000; y -1500 1500");
    group((24600.0, 3600.0), (25600.0, 7600.0), "name partition-4; x -1500 1000; rotate -90 45");
    slab(&mut s, wall, (9000.0, 5000.0), 3200.0, 120.0, false);
    slab(&mut s, wall, (15000.0, 4000.0), 3200.0, 120.0, true);
    slab(&mut s, wall, (21000.0, 5200.0), 3200.0, 120.0, false);
    slab(&mut s, wall, (25100.0, 5600.0), 3200.0, 120.0, true);
    s.rectangle(KEEP, (26200.0, -300.0), (30300.0, 3100.0));
    s.circle(QUERY, (3000.0, 4500.0), 2200.0);
    s.write()
}

/// A museum hall, inches, round columns, walls for hanging as outlines.
fn museum_hall() -> String {
    let wall = "A-WALL";
    let mut s = sheet(Version::R2010, INCH, wall);
    s.layer("A-COLS", 9);
    s.text(NOTE, (0.0, 990.0), 16.0, "Museum hall, 120 x 80 ft, in inches: six hanging walls, two ways in.");
    s.lines(wall, &[(504.0, 0.0), (0.0, 0.0), (0.0, 960.0), (1440.0, 960.0), (1440.0, 0.0), (936.0, 0.0)]);
    s.line(wall, (0.0, 240.0), (300.0, 240.0));
    s.line(wall, (444.0, 240.0), (996.0, 240.0));
    s.line(wall, (1140.0, 240.0), (1440.0, 240.0));
    for y in [420.0, 780.0] {
        for k in 0..5 {
            s.circle("A-COLS", (240.0 + 240.0 * f64::from(k), y), 12.0);
        }
    }
    let hanging = [
        ("wall-a", (120.0, 600.0), true),
        ("wall-b", (360.0, 600.0), false),
        ("wall-c", (600.0, 600.0), true),
        ("wall-d", (840.0, 600.0), false),
        ("wall-e", (1080.0, 600.0), true),
        ("wall-f", (1300.0, 600.0), true),
    ];
    for (name, (x, y), is_upright) in hanging {
        slab(&mut s, wall, (x, y), 168.0, 8.0, is_upright);
        let (dx, dy) = if is_upright { (16.0, 96.0) } else { (96.0, 16.0) };
        let words = format!("name {name}; x -5ft 5ft; y -6ft 6ft; rotate -45 45");
        movable(&mut s, (x - dx, y - dy), (x + dx, y + dy), 5.0, &words);
    }
    movable(&mut s, (288.0, 228.0), (456.0, 252.0), 5.0, "name opening-west; x -200 200");
    movable(&mut s, (984.0, 228.0), (1152.0, 252.0), 5.0, "name opening-east; x -200 200");
    s.rectangle(QUERY, (120.0, 20.0), (624.0, 220.0));
    s.rectangle(QUERY, (816.0, 20.0), (1320.0, 220.0));
    s.rectangle(REFERENCE, (12.0, 252.0), (1428.0, 948.0));
    s.write()
}

/// A station level of about 10,000 square metres, metres, with query regions for three rounds.
fn station() -> String {
    let wall = "WALLS";
    let mut s = sheet(Version::R2010, METRE, wall);
    for (name, colour) in [("COLUMNS", 9), ("QUERY-ROUND-2", 4), ("QUERY-ROUND-3", 6)] {
        s.layer(name, colour);
    }
    s.text(
        NOTE,
        (0.0, 69.22),
        1.6,
        "Station level. Where people stand: round 1 at the entrances (EF-QUERY),",
    );
    s.text(
        NOTE,
        (0.0, 66.5),
        1.6,
        "round 2 at the gates (QUERY-ROUND-2), round 3 at the stairs (QUERY-ROUND-3).",
    );
    let outline = [
        (0.0, 8.0),
        (12.0, 0.0),
        (156.0, 0.0),
        (168.0, 8.0),
        (168.0, 56.0),
        (156.0, 64.0),
        (12.0, 64.0),
        (0.0, 56.0),
    ];
    s.ring(wall, &outline);
    for y in [16.5, 47.5] {
        for k in 0..11 {
            let x = 14.5 + 14.0 * f64::from(k);
            s.rectangle("COLUMNS", (x - 0.6, y - 0.6), (x + 0.6, y + 0.6));
        }
    }
    // Stairs down to the platforms: three sides, open to the gates.
    for (open, end) in [(66.5, 80.5), (102.5, 88.5)] {
        for y in [10.5, 28.5, 48.5] {
            s.path(wall, &[(open, y), (end, y), (end, y + 5.0), (open, y + 5.0)]);
        }
    }
    // Two gate lines with two passages each.
    for (name, x) in [("west", 52.5), ("east", 116.5)] {
        for (from, to) in [(0.0, 18.5), (23.5, 40.5), (45.5, 64.0)] {
            s.line(wall, (x, from), (x, to));
        }
        for (part, y) in [("south", 18.5), ("north", 40.5)] {
            let words = format!("name gate-{name}-{part}; y -8 8");
            movable(&mut s, (x - 0.6, y - 0.6), (x + 0.6, y + 5.6), 0.45, &words);
        }
    }
    let kiosks = [
        ("kiosk-1", 24.5, 32.5),
        ("kiosk-2", 40.5, 26.5),
        ("kiosk-3", 128.5, 32.5),
        ("kiosk-4", 144.5, 38.5),
    ];
    for (name, x, y) in kiosks {
        slab(&mut s, wall, (x, y), 6.0, 0.8, false);
        let words = format!("name {name}; x -6 6; y -8 8");
        movable(&mut s, (x - 3.6, y - 1.2), (x + 3.6, y + 1.2), 0.45, &words);
    }
    let screens = [
        ("screen-1", 32.5, 42.5),
        ("screen-2", 84.5, 23.5),
        ("screen-3", 84.5, 41.5),
        ("screen-4", 136.5, 22.5),
    ];
    for (name, x, y) in screens {
        s.line(wall, (x - 4.0, y), (x + 4.0, y));
        let words = format!("name {name}; x -6 6; rotate -60 60");
        movable(&mut s, (x - 4.6, y - 1.2), (x + 4.6, y + 1.2), 0.45, &words);
    }
    for x in [2.5, 159.5] {
        s.rectangle(QUERY, (x, 20.2), (x + 6.0, 43.8));
    }
    for x in [46.8, 54.2, 110.8, 118.2] {
        s.rectangle("QUERY-ROUND-2", (x, 16.2), (x + 4.0, 47.8));
    }
    for x in [62.2, 102.8] {
        s.rectangle("QUERY-ROUND-3", (x, 10.2), (x + 4.0, 54.8));
    }
    s.ring(REFERENCE, &outline.map(|(x, y)| (84.0 + 0.997 * (x - 84.0), 32.0 + 0.99 * (y - 32.0))));
    s.write()
}

/// A maze with fourteen doors that slide, metres but without a unit, R12.
fn maze() -> String {
    let wall = "WALLS";
    let mut s = sheet(Version::R12, None, wall);
    s.text(NOTE, (0.0, 18.1), 0.35, "Maze. Fourteen doors slide along their walls.");
    let (side, spine, corridor, door) = (18.0, 9.0, 2.2, 1.8);
    s.rectangle(wall, (0.0, 0.0), (side, 8.0 * corridor));
    s.line(wall, (spine, 0.0), (spine, 15.6));
    s.line(wall, (spine, 17.4), (spine, 8.0 * corridor));
    let doors_at = [[1.2, 13.4], [6.0, 9.9], [2.6, 15.3], [5.4, 11.6], [0.6, 14.6], [6.3, 10.4], [3.1, 12.7]];
    for (k, row) in doors_at.iter().enumerate() {
        let y = ((k + 1) as f64 * corridor * 10.0).round() / 10.0;
        for (half, &x) in row.iter().enumerate() {
            let (left, right) = (spine * half as f64, spine * (half + 1) as f64);
            s.line(wall, (left, y), (x, y));
            s.line(wall, (x + door, y), (right, y));
            let reach = |to: f64| (to * 10.0).round() / 10.0;
            let words = format!("x {} {}", reach(left + 0.4 - x), reach(right - 0.4 - door - x));
            movable(&mut s, (x - 0.15, y - 0.4), (x + door + 0.15, y + 0.4), 0.25, &words);
        }
    }
    s.rectangle(QUERY, (0.3, 0.3), (4.1, 1.9));
    s.rectangle(QUERY, (13.9, 0.3), (17.7, 1.9));
    s.rectangle(REFERENCE, (0.1, 0.1), (17.9, 17.5));
    s.write()
}

/// A library without a single marker, centimetres: shelves, screens and doors for the default moves.
fn library() -> String {
    let wall = "WAND";
    let mut s = Sheet::new(Version::R2010, CENTIMETRE);
    s.layer(wall, 7);
    s.layer(NOTE, 8);
    s.text(NOTE, (0.0, 1540.0), 36.0, "Library, drawn as any office would: no markers of ours.");
    s.rectangle(wall, (0.0, 0.0), (2400.0, 1500.0));
    s.line(wall, (900.0, 0.0), (900.0, 560.0));
    s.line(wall, (900.0, 740.0), (900.0, 1500.0));
    s.line(wall, (900.0, 900.0), (1500.0, 900.0));
    s.line(wall, (1680.0, 900.0), (2400.0, 900.0));
    for y in [300.0, 600.0, 900.0, 1200.0] {
        slab(&mut s, wall, (450.0, y), 400.0, 40.0, false);
    }
    for x in [1250.0, 1650.0, 2050.0] {
        slab(&mut s, wall, (x, 420.0), 400.0, 40.0, true);
    }
    s.line(wall, (1250.0, 1200.0), (1500.0, 1200.0));
    s.line(wall, (1900.0, 1100.0), (1900.0, 1300.0));
    s.write()
}

/// Every marker and every clause once, in a plan that runs.
fn marker_template() -> String {
    let wall = "A-WALL";
    let mut s = sheet(Version::R2010, METRE, wall);
    s.rectangle(wall, (0.0, 0.0), (24.0, 14.0));
    let screens = [
        (3.0, 10.0, "name both-ways; x -1.5 2; y -1 1"),
        (9.0, 10.0, "name along-a-line; along 30 -1 1"),
        (15.0, 10.0, "name about-its-centre; rotate -45 45"),
        (21.0, 10.0, "name about-a-point; rotate -15 15 about 21,12"),
        (3.0, 5.0, "name longer-shorter; scale 0.6 1.4"),
        (9.0, 5.0, "name scaled-from-a-point; scale 0.8 1.2 about 8,5"),
        (15.0, 5.0, "name in-other-units; x -150mm 0.5m; y -2ft 1ft"),
    ];
    for (x, y, words) in screens {
        s.line(wall, (x - 1.0, y), (x + 1.0, y));
        s.rectangle(MOVE, (x - 1.4, y - 0.5), (x + 1.4, y + 0.5));
        s.mtext(MOVE, (x - 1.3, y - 0.1), 0.12, 2.6, words);
    }
    s.lines(wall, &[(20.0, 4.0), (22.0, 4.0), (22.0, 6.0)]);
    s.rectangle(KEEP, (19.5, 3.5), (22.5, 6.5));
    s.circle(QUERY, (3.0, 1.8), 1.2);
    s.rectangle(QUERY, (7.0, 0.8), (11.0, 2.8));
    s.rectangle(REFERENCE, (0.3, 0.3), (23.7, 13.7));
    s.mtext(NOTE, (24.8, 13.8), 0.3, 20.0, LEGEND);
    s.write()
}

const LEGEND: &str = "MARKERS OF ENFILADE\\P\
    Draw on these layers, in any CAD program. Closed polylines; for regions circles too.\\P\\P\
    EF-QUERY: where people stand whose view counts. Several are united.\\P\
    EF-REFERENCE: what should be seen and reached. Several are united.\\P\
    Neither drawn: both are the interior. One drawn: the other is the interior.\\P\\P\
    EF-MOVE: encloses the wall ends, junctions or columns that move together.\\P\
    A text inside says how, clauses separated by semicolons, each with its bounds;\\P\
    0 is as drawn (scale: 1).\\P\
    x -1.5 2: to the right\\P\
    y -1 1: up the sheet\\P\
    along 30 -1 1: along a direction, degrees anticlockwise\\P\
    rotate -15 15: degrees anticlockwise about the group's centre\\P\
    rotate -15 15 about 21,12: about a point\\P\
    scale 0.8 1.2 about 8,5: away from a point\\P\
    name screen-1: what the report calls it\\P\
    Lengths are drawing units unless a unit follows: 150mm 20cm 2m 5in 2ft\\P\\P\
    EF-KEEP: nothing inside moves.";
