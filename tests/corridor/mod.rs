//! A house of two rows of rooms along a corridor, drawn in many ways.

// Every suite uses some of it.
#![allow(dead_code)]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;

/// Lower left and upper right corner, metres.
pub type Rect = [f64; 4];

/// Width and depth of the house, metres.
pub const SIZE: [f64; 2] = [14.0, 9.0];

/// Outer walls and partitions.
const WALLS: [Rect; 11] = [
    [0.0, 0.0, 14.0, 0.3],
    [0.0, 8.7, 14.0, 9.0],
    [0.0, 0.0, 0.3, 9.0],
    [13.7, 0.0, 14.0, 9.0],
    [0.3, 3.9, 13.7, 4.0],
    [0.3, 5.6, 13.7, 5.7],
    [4.95, 0.3, 5.05, 3.9],
    [9.45, 0.3, 9.55, 3.9],
    [3.95, 5.7, 4.05, 8.7],
    [7.95, 5.7, 8.05, 8.7],
    [10.95, 5.7, 11.05, 8.7],
];

/// The windows, all 1.5 m wide, in the walls along x.
pub const WINDOWS: [Rect; 7] = [
    [1.5, 0.0, 3.0, 0.3],
    [6.0, 0.0, 7.5, 0.3],
    [10.5, 0.0, 12.0, 0.3],
    [1.0, 8.7, 2.5, 9.0],
    [5.0, 8.7, 6.5, 9.0],
    [8.8, 8.7, 10.3, 9.0],
    [11.7, 8.7, 13.2, 9.0],
];

/// A door: its opening, the hinge, where the leaf closes, and to which side it opens.
pub struct Door {
    pub opening: Rect,
    pub hinge: [f64; 2],
    pub tip: [f64; 2],
    pub side: [f64; 2],
}

impl Door {
    pub fn width(&self) -> f64 {
        (self.tip[0] - self.hinge[0]).hypot(self.tip[1] - self.hinge[1])
    }

    /// Where its leaf ends when it is turned by a share of a quarter turn.
    pub fn leaf_end(&self, share: f64) -> [f64; 2] {
        let (sin, cos) = (share * std::f64::consts::FRAC_PI_2).sin_cos();
        [0, 1]
            .map(|k| self.hinge[k] + cos * (self.tip[k] - self.hinge[k]) + sin * self.width() * self.side[k])
    }

    /// Points along its swing.
    pub fn swing(&self, chords: usize) -> Vec<[f64; 2]> {
        (0..=chords).map(|k| self.leaf_end(k as f64 / chords as f64)).collect()
    }
}

/// Seven doors of the corridor and the entrance.
pub fn doors() -> Vec<Door> {
    let along_x = |x: f64, up: bool| {
        let (y, face, side) = if up { ([5.6, 5.7], 5.7, 1.0) } else { ([3.9, 4.0], 3.9, -1.0) };
        let opening = [x, y[0], x + 0.9, y[1]];
        Door { opening, hinge: [x, face], tip: [x + 0.9, face], side: [0.0, side] }
    };
    let mut out: Vec<Door> = [2.0, 7.0, 11.0].map(|x| along_x(x, false)).into();
    out.extend([1.5, 5.5, 9.0, 12.0].map(|x| along_x(x, true)));
    let opening = [0.0, 4.3, 0.3, 5.3];
    out.push(Door { opening, hinge: [0.3, 4.3], tip: [0.3, 5.3], side: [1.0, 0.0] });
    out
}

fn holds(r: &Rect, x: f64, y: f64) -> bool {
    (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&y)
}

/// The faces of the walls with all openings cut out, each from corner to corner.
pub fn faces() -> Vec<Rect> {
    let doors = doors().into_iter().map(|d| d.opening);
    let cuts: Vec<Rect> = WINDOWS.into_iter().chain(doors).collect();
    let ticks = |k: usize| {
        let mut out: Vec<f64> = WALLS.iter().chain(&cuts).flat_map(|r| [r[k], r[k + 2]]).collect();
        out.sort_by(f64::total_cmp);
        out.dedup();
        out
    };
    let (xs, ys) = (ticks(0), ticks(1));
    let is_solid = |i: usize, j: usize| {
        let middle = |t: &[f64], k: usize| {
            let (a, b) = (k.checked_sub(1).and_then(|k| t.get(k)), t.get(k));
            a.zip(b).map(|(a, b)| f64::midpoint(*a, *b))
        };
        let Some((x, y)) = middle(&xs, i).zip(middle(&ys, j)) else { return false };
        WALLS.iter().any(|w| holds(w, x, y)) && !cuts.iter().any(|c| holds(c, x, y))
    };
    let mut out: Vec<Rect> = Vec::new();
    let mut add = |piece: Rect, goes_on: bool| match out.last_mut() {
        Some(last) if goes_on => [last[2], last[3]] = [piece[2], piece[3]],
        _ => out.push(piece),
    };
    // Side of wall: +1 on the far side of a line, -1 on the near one, 0 where it is no face.
    let side = |far: bool, near: bool| i32::from(far) - i32::from(near);
    for (j, y) in ys.iter().enumerate() {
        let at = |i: usize| side(is_solid(i, j + 1), is_solid(i, j));
        for i in (1..xs.len()).filter(|i| at(*i) != 0) {
            add([xs[i - 1], *y, xs[i], *y], at(i - 1) == at(i));
        }
    }
    for (i, x) in xs.iter().enumerate() {
        let at = |j: usize| side(is_solid(i + 1, j), is_solid(i, j));
        for j in (1..ys.len()).filter(|j| at(*j) != 0) {
            add([*x, ys[j - 1], *x, ys[j]], at(j - 1) == at(j));
        }
    }
    out
}

pub fn line(layer: &str, [x0, y0, x1, y1]: Rect) -> String {
    format!("0|LINE|8|{layer}|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
}

pub fn polyline(layer: &str, points: &[[f64; 2]], closed: bool) -> String {
    let head = format!("0|LWPOLYLINE|8|{layer}|90|{}|70|{}|", points.len(), u8::from(closed));
    points.iter().fold(head, |mut out, [x, y]| {
        write!(out, "10|{x}|20|{y}|").unwrap();
        out
    })
}

pub fn corners([x0, y0, x1, y1]: Rect) -> [[f64; 2]; 4] {
    [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

pub fn arc(layer: &str, door: &Door) -> String {
    let turn = |p: [f64; 2]| (p[1] - door.hinge[1]).atan2(p[0] - door.hinge[0]).to_degrees();
    let (from, to) = (turn(door.tip), turn(door.leaf_end(1.0)));
    let [from, to] = if (to - from).rem_euclid(360.0) < 180.0 { [from, to] } else { [to, from] };
    let ([x, y], r) = (door.hinge, door.width());
    format!("0|ARC|8|{layer}|10|{x}|20|{y}|40|{r}|50|{from}|51|{to}|")
}

/// The leaf as a line, turned by a share of a quarter turn.
pub fn leaf(layer: &str, door: &Door, share: f64) -> String {
    let ([x0, y0], [x1, y1]) = (door.hinge, door.leaf_end(share));
    line(layer, [x0, y0, x1, y1])
}

/// The walls as lines.
pub fn walls(layer: &str) -> String {
    faces().into_iter().map(|f| line(layer, f)).collect()
}

/// Three lines in every window.
pub fn panes(layer: &str) -> String {
    let of = |[x0, y0, x1, y1]: Rect| {
        [y0, f64::midpoint(y0, y1), y1].map(|y| line(layer, [x0, y, x1, y])).concat()
    };
    WINDOWS.into_iter().map(of).collect()
}

/// An arc and a line for every door.
pub fn swings(layer: &str) -> String {
    doors().iter().map(|d| arc(layer, d) + &leaf(layer, d, 1.0)).collect()
}

/// A drawing in metres.
pub fn drawing(entities: &str) -> String {
    let text = format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|6|0|ENDSEC|0|SECTION|2|ENTITIES|{entities}0|ENDSEC|0|EOF|"
    );
    text.replace('|', "\n")
}
