//! One small building of two storeys, as a model: `pavilion.dxf`, `pavilion.ifc` and `pavilion.glb` show it.

use super::dxf::{Point, Sheet, Version};

/// Height of walls, metres.
pub const HEIGHT: f64 = 3.0;

/// Height of the eyes above the floor at which the drawing is cut, metres.
const CUT: f64 = 1.5;

/// A hole in a wall.
#[derive(Clone, Copy)]
pub struct Opening {
    /// From the wall's start to the near edge, along the wall.
    pub at: f64,
    pub width: f64,
    pub sill: f64,
    pub height: f64,
    pub is_door: bool,
}

/// A straight wall on its centre line, or (where as long as thick) a column.
#[derive(Clone)]
pub struct Wall {
    pub name: &'static str,
    pub from: Point,
    pub to: Point,
    pub thickness: f64,
    pub height: f64,
    pub openings: Vec<Opening>,
    /// What may move, in the words of `EF-MOVE`.
    pub moves: Option<&'static str>,
    pub is_column: bool,
}

/// A room.
pub struct Space {
    pub name: &'static str,
    pub low: Point,
    pub high: Point,
    pub is_query: bool,
    pub is_reference: bool,
}

/// A storey.
pub struct Storey {
    pub name: &'static str,
    pub floor: f64,
    pub walls: Vec<Wall>,
    pub spaces: Vec<Space>,
}

impl Wall {
    /// Length of the centre line.
    pub fn length(&self) -> f64 {
        (self.to.0 - self.from.0).hypot(self.to.1 - self.from.1)
    }

    /// Direction of the centre line.
    pub fn direction(&self) -> Point {
        ((self.to.0 - self.from.0) / self.length(), (self.to.1 - self.from.1) / self.length())
    }

    /// What stands of it at a height: stretches along the centre line.
    pub fn stretches(&self, height: f64) -> Vec<[f64; 2]> {
        let mut out = Vec::new();
        let mut at = 0.0;
        for o in self.openings.iter().filter(|o| o.sill < height && o.sill + o.height > height) {
            out.push([at, o.at]);
            at = o.at + o.width;
        }
        out.push([at, self.length()]);
        out
    }
}

fn door(at: f64, width: f64) -> Opening {
    Opening { at, width, sill: 0.0, height: 2.1, is_door: true }
}

fn window(at: f64, width: f64) -> Opening {
    Opening { at, width, sill: 0.9, height: 1.3, is_door: false }
}

fn wall(name: &'static str, from: Point, to: Point, thickness: f64, openings: Vec<Opening>) -> Wall {
    Wall { name, from, to, thickness, height: HEIGHT, openings, moves: None, is_column: false }
}

fn screen(name: &'static str, from: Point, to: Point, moves: &'static str) -> Wall {
    Wall { height: 2.4, moves: Some(moves), ..wall(name, from, to, 0.16, vec![]) }
}

fn column(name: &'static str, (x, y): Point) -> Wall {
    Wall { is_column: true, ..wall(name, (x - 0.2, y), (x + 0.2, y), 0.4, vec![]) }
}

/// 18 × 12 m, outer walls 300 mm, their joints butt.
fn outer(front: Vec<Opening>) -> Vec<Wall> {
    let windows = || vec![window(2.0, 1.6), window(8.0, 1.6), window(14.0, 1.6)];
    vec![
        wall("south", (0.0, 0.15), (18.0, 0.15), 0.3, front),
        wall("north", (0.0, 11.85), (18.0, 11.85), 0.3, windows()),
        wall("west", (0.15, 0.3), (0.15, 11.7), 0.3, vec![window(2.0, 1.2)]),
        wall("east", (17.85, 0.3), (17.85, 11.7), 0.3, vec![window(7.0, 1.2)]),
    ]
}

/// The building from the ground up.
pub fn storeys() -> [Storey; 2] {
    let mut ground = outer(vec![window(2.0, 1.6), door(8.0, 1.8), window(14.0, 1.6)]);
    ground.extend([
        wall("hall", (7.0, 0.3), (7.0, 11.7), 0.2, vec![door(1.2, 1.4), door(9.0, 1.0)]),
        Wall {
            moves: Some("y -1m 1m"),
            ..wall("cloakroom", (0.3, 7.5), (6.9, 7.5), 0.16, vec![door(2.6, 1.0)])
        },
        screen("screen-1", (2.0, 4.0), (5.0, 4.0), "x -1m 1m; y -1.2m 1.5m"),
        screen("screen-2", (10.0, 3.2), (14.0, 3.2), "x -1.5m 1.5m; rotate -25 25"),
        screen("screen-3", (15.2, 7.2), (15.2, 9.6), "x -1.5m 1.2m"),
        screen("screen-4", (9.6, 8.2), (12.4, 8.2), "rotate -40 40"),
        column("column-1", (12.5, 5.9)),
        column("column-2", (9.5, 5.9)),
    ]);
    let mut upper = outer(vec![window(2.0, 1.6), window(8.0, 1.6), window(14.0, 1.6)]);
    upper.extend([
        wall("gallery", (0.3, 6.0), (17.7, 6.0), 0.2, vec![door(4.0, 1.4), door(12.0, 1.4)]),
        screen("screen-5", (6.0, 3.0), (9.0, 3.0), "x -2m 2m; y -1m 1m"),
    ]);
    let inside = |name, low, high, is_query, is_reference| Space { name, low, high, is_query, is_reference };
    [
        Storey {
            name: "Ground floor",
            floor: 0.0,
            walls: ground,
            spaces: vec![
                inside("Foyer", (0.3, 0.3), (6.9, 11.7), false, true),
                inside("Gallery", (7.1, 0.3), (17.7, 11.7), true, true),
            ],
        },
        Storey {
            name: "Upper floor",
            floor: 3.2,
            walls: upper,
            spaces: vec![inside("Upper gallery", (0.3, 0.3), (17.7, 11.7), false, false)],
        },
    ]
}

/// The ground floor as a drawing, cut at the height of the eyes.
pub fn drawing() -> String {
    let mut s = Sheet::new(Version::R2010, Some(6));
    for (name, colour) in [("A-WALL", 7), ("A-COLS", 8), ("EF-QUERY", 5), ("EF-REFERENCE", 3), ("EF-MOVE", 1)]
    {
        s.layer(name, colour);
    }
    let [ground, _] = storeys();
    for w in &ground.walls {
        let (d, half) = (w.direction(), w.thickness / 2.0);
        let corner = |along: f64, across: f64| {
            (w.from.0 + d.0 * along - d.1 * across, w.from.1 + d.1 * along + d.0 * across)
        };
        let layer = if w.is_column { "A-COLS" } else { "A-WALL" };
        for [a, b] in w.stretches(CUT) {
            s.ring(layer, &[corner(a, -half), corner(b, -half), corner(b, half), corner(a, half)]);
        }
        if let Some(moves) = w.moves {
            let (lo, hi) = (corner(-0.02, -half - 0.1), corner(w.length() + 0.02, half + 0.1));
            let (x0, x1) = (lo.0.min(hi.0), lo.0.max(hi.0));
            let (y0, y1) = (lo.1.min(hi.1), lo.1.max(hi.1));
            s.rectangle("EF-MOVE", (x0, y0), (x1, y1));
            s.text("EF-MOVE", (x0 + 0.03, y0 + 0.03), 0.05, &format!("name {}; {moves}", w.name));
        }
    }
    for space in &ground.spaces {
        for (is, layer) in [(space.is_query, "EF-QUERY"), (space.is_reference, "EF-REFERENCE")] {
            if is {
                s.rectangle(layer, space.low, space.high);
            }
        }
    }
    s.write()
}
