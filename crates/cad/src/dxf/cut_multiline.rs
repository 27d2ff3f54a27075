//! MLINE that are cut: each part is a multiline of its own, the first in the record that was there.

use std::ops::Range;

use glam::DVec2;

use super::additions::Writer;
use super::cut::LOOK;
use super::fields::{Fields, own_pairs};
use super::patch::Editor;
use super::tokens::Pair;
use crate::drawing::{Shape, Vertex};
use crate::plane::distance_to_segment;
use crate::splice::Splice;
use enfilade_report::Error;

/// A part's corner lies on a line of the multiline within this share of the path's length.
const ON_LINE: f64 = 1e-6;

/// Flag of a closed path.
const CLOSED: i64 = 2;

/// A corner of the path as written.
struct Corner {
    /// Its pairs.
    pairs: Range<usize>,
    at: DVec2,
    mitre: DVec2,
    /// By line, how far along the mitre it passes.
    offsets: Vec<f64>,
}

impl Corner {
    fn of_line(&self, line: usize) -> DVec2 {
        self.at + self.mitre * self.offsets[line]
    }
}

/// A corner of a part.
enum At {
    /// One of the path.
    Corner(usize),
    /// A new end on the stretch that begins at a corner.
    Stretch(usize, DVec2),
}

/// A multiline.
struct Path {
    corners: Vec<Corner>,
    is_closed: bool,
    /// Pairs before the first corner.
    head: Vec<usize>,
}

impl Path {
    fn stretches(&self) -> usize {
        if self.is_closed { self.corners.len() } else { self.corners.len() - 1 }
    }

    /// Both ends of a stretch, of the path or of one of its lines.
    fn ends(&self, stretch: usize, of: impl Fn(&Corner) -> DVec2) -> [DVec2; 2] {
        [stretch, (stretch + 1) % self.corners.len()].map(|i| of(&self.corners[i]))
    }

    /// Where on the path the corners of a part of one of its lines are; `None` where they lie on no line.
    fn places(&self, vertices: &[Vertex]) -> Option<Vec<At>> {
        let lines = self.corners[0].offsets.len();
        let length: f64 =
            (0..self.stretches()).map(|i| self.ends(i, |c| c.at)).map(|[a, b]| a.distance(b)).sum();
        let near = ON_LINE * length;
        let place = |line: usize, p: DVec2| {
            let own = |c: &Corner| c.of_line(line);
            if let Some(i) = self.corners.iter().position(|c| own(c).distance(p) <= near) {
                return Some(At::Corner(i));
            }
            let is_on = |i: &usize| distance_to_segment(p, self.ends(*i, own)) <= near;
            let stretch = (0..self.stretches()).find(is_on)?;
            let [a, b] = self.ends(stretch, |c| c.at);
            let along = (b - a).try_normalize()?;
            Some(At::Stretch(stretch, a + along * (p - a).dot(along)))
        };
        (0..lines).find_map(|line| vertices.iter().map(|v| place(line, v.at)).collect())
    }
}

impl Editor<'_, '_> {
    /// What stays of a multiline; `parts` are pieces of one of its lines.
    pub(super) fn multiline_anew(
        &mut self,
        parts: &[Shape],
        writer: &mut Writer<'_, '_>,
    ) -> Result<(), Error> {
        let path = self.path()?;
        let mut all = Vec::new();
        for part in parts {
            let Shape::Polyline { vertices, .. } = part else {
                return Err(self.fault("its part is no path"));
            };
            let places = path.places(vertices).filter(|p| p.len() > 1);
            all.push(places.ok_or_else(|| self.fault("a part of it lies on none of its lines"))?);
        }
        let points = parts.iter().flat_map(crate::curve::control_points);
        self.listen(points.collect::<Vec<_>>())?;
        let Some((first, others)) = all.split_first() else { return Err(self.fault("nothing of it stays")) };
        for places in others {
            self.begin("MLINE", self.record, writer);
            self.subclass(self.record, "AcDbMline", writer);
            self.path_like(&path, places, writer);
        }
        self.put_behind(writer);
        let (Some(head), Some(last)) = (path.head.first(), path.corners.last()) else {
            return Err(self.fault("it has no corners"));
        };
        let (start, end) = (self.tokens.pair_start(*head), self.tokens.pair_start(last.pairs.end));
        self.path_like(&path, first, writer);
        let with = writer.take();
        self.out.push((self.record, Splice { start, end, with }));
        Ok(())
    }

    fn path(&self) -> Result<Path, Error> {
        let fields = Fields::of(self.tokens, self.record);
        let own: Vec<(usize, &Pair)> = own_pairs(self.tokens, self.record).collect();
        let starts: Vec<usize> = (0..own.len()).filter(|k| own[*k].1.code == 11).collect();
        let flags = fields.index(71).and_then(|i| self.tokens.integer(&self.tokens.pairs[i])).unwrap_or(0);
        let Some(first) = starts.first() else { return Err(self.fault("it has no corners")) };
        // How it looks, and what it is, stands before its style.
        let is_before =
            |(_, p): &(usize, &Pair)| LOOK.contains(&p.code) || matches!(p.code, 0 | 5 | 100 | 330);
        let before = own[..*first].iter().rposition(is_before).map_or(0, |k| k + 1);
        let head: Vec<usize> = own[before..*first].iter().map(|p| p.0).collect();
        let mut corners = Vec::new();
        for (k, start) in starts.iter().enumerate() {
            let end = starts.get(k + 1).copied().unwrap_or(own.len());
            let mut corner = Corner {
                pairs: own[*start].0..own[end - 1].0 + 1,
                at: DVec2::ZERO,
                mitre: DVec2::ZERO,
                offsets: Vec::new(),
            };
            let mut is_first = false;
            for (index, pair) in &own[*start..end] {
                match pair.code {
                    11 => corner.at.x = self.number(*index)?,
                    21 => corner.at.y = self.number(*index)?,
                    13 => corner.mitre.x = self.number(*index)?,
                    23 => corner.mitre.y = self.number(*index)?,
                    74 => {
                        is_first = true;
                        if self.tokens.integer(pair).is_none_or(|n| n > 2) {
                            return Err(self.fault("it has breaks already"));
                        }
                    }
                    41 if is_first => {
                        corner.offsets.push(self.number(*index)?);
                        is_first = false;
                    }
                    _ => {}
                }
            }
            corners.push(corner);
        }
        let are_alike = corners.iter().all(|c| c.offsets.len() == corners[0].offsets.len());
        if corners.len() < 2 || !are_alike || corners[0].offsets.is_empty() {
            return Err(self.fault("its corners are not alike"));
        }
        Ok(Path { corners, is_closed: flags & CLOSED != 0, head })
    }

    /// All that is written from the style on, for a part of the path.
    fn path_like(&self, path: &Path, places: &[At], writer: &mut Writer<'_, '_>) {
        let at = |place: &At| match place {
            At::Corner(i) => path.corners[*i].at,
            At::Stretch(_, p) => *p,
        };
        for index in &path.head {
            let pair = &self.tokens.pairs[*index];
            match pair.code {
                10 => writer.float(10, at(&places[0]).x),
                20 => writer.float(20, at(&places[0]).y),
                71 => writer.int(71, (self.tokens.integer(pair).unwrap_or(0) & !CLOSED) as i32),
                72 => writer.int(72, places.len() as i32),
                _ => writer.raw(pair.code, self.tokens.raw(pair)),
            }
        }
        for place in places {
            match place {
                At::Corner(i) => {
                    for pair in &self.tokens.pairs[path.corners[*i].pairs.clone()] {
                        writer.raw(pair.code, self.tokens.raw(pair));
                    }
                }
                At::Stretch(stretch, p) => self.end(path, *stretch, *p, writer),
            }
        }
    }

    /// A new end, across a stretch.
    fn end(&self, path: &Path, stretch: usize, at: DVec2, writer: &mut Writer<'_, '_>) {
        let corner = &path.corners[stretch];
        let [a, b] = path.ends(stretch, |c| c.at);
        let along = (b - a).normalize_or_zero();
        let side = if corner.mitre.dot(along.perp()) < 0.0 { -1.0 } else { 1.0 };
        let across = along.perp() * side;
        let z = |code: i32| self.tokens.pairs[corner.pairs.clone()].iter().find(|p| p.code == code);
        for (code, v) in [(11, at), (12, along), (13, across)] {
            writer.float(code, v.x);
            writer.float(code + 10, v.y);
            if let Some(pair) = z(code + 20) {
                writer.raw(code + 20, self.tokens.raw(pair));
            }
        }
        for offset in &corner.offsets {
            writer.int(74, 2);
            writer.float(41, (corner.mitre * *offset).dot(across));
            writer.float(41, 0.0);
            writer.int(75, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Edit, EntityWork};
    use crate::dxf::{ReadOptions, patch, read};
    use enfilade_report::Report;

    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

    /// A corner at x and y with its mitre, and two lines a decimetre to either side.
    fn corner([x, y]: [f64; 2], mitre: [f64; 2]) -> String {
        let far = 0.1 / mitre[0].abs().max(mitre[1].abs());
        let line = |offset: f64| format!("74|2|41|{offset}|41|0|75|0|");
        format!("11|{x}|21|{y}|31|0|12|1|22|0|32|0|13|{}|23|{}|33|0|", mitre[0], mitre[1])
            + &line(far)
            + &line(-far)
    }

    fn text(flags: i32, corners: &[String]) -> Vec<u8> {
        let count = corners.len();
        let head = format!("2|STANDARD|340|18|40|1|70|0|71|{flags}|72|{count}|73|2|10|0|20|0|");
        let text = format!(
            "0|SECTION|2|ENTITIES|0|MLINE|5|2F3|100|AcDbEntity|8|A-WALL|62|3|100|AcDbMline|{head}{}0|ENDSEC|0|EOF|",
            corners.concat()
        );
        text.replace('|', "\n").into_bytes()
    }

    /// All lines that are drawn, without those of which the drawing has more than the corners.
    fn lines(bytes: &[u8]) -> Vec<Vec<[f64; 2]>> {
        let drawing = read("a.dxf", bytes, &ReadOptions::default(), &mut Report::default()).unwrap();
        let points = |s: &Shape| crate::curve::control_points(s).iter().map(DVec2::to_array).collect();
        drawing.entities.iter().map(|e| points(&e.shape)).collect()
    }

    fn cut(bytes: &[u8], parts: &[&[[f64; 2]]]) -> Vec<Vec<[f64; 2]>> {
        let drawing = read("a.dxf", bytes, &ReadOptions::default(), &mut Report::default()).unwrap();
        let shape = |points: &&[[f64; 2]]| Shape::Polyline {
            vertices: points.iter().map(|p| Vertex { at: DVec2::from(*p), bulge: 0.0 }).collect(),
            closed: false,
        };
        let work = EntityWork::Cut { parts: parts.iter().map(shape).collect() };
        let edits = [Edit::Work { record: drawing.entities[0].source.record, work }];
        let written = patch("a.dxf", bytes, &edits, &[]).unwrap();
        let said = String::from_utf8(written.clone()).unwrap();
        assert_eq!(said.matches("\nMLINE\n").count(), parts.len());
        assert_eq!(said.matches("\n62\n3\n").count(), parts.len(), "each as coloured");
        lines(&written)
    }

    fn assert_alike(found: &[Vec<[f64; 2]>], wanted: &[&[[f64; 2]]]) {
        assert_eq!(found.len(), wanted.len(), "{found:?}");
        for (f, w) in found.iter().zip(wanted) {
            let is_near = f.len() == w.len()
                && f.iter().zip(*w).all(|(p, q)| DVec2::from(*p).distance(DVec2::from(*q)) < 1e-9);
            assert!(is_near, "{f:?} {w:?}");
        }
    }

    #[test]
    fn a_path_with_a_corner_is_two_paths_after_a_cut() {
        let path = [
            corner([0.0, 0.0], [0.0, 1.0]),
            corner([4.0, 0.0], [-HALF, HALF]),
            corner([4.0, 3.0], [-1.0, 0.0]),
        ];
        let bytes = text(1, &path);
        let found = cut(&bytes, &[&[[0.0, -0.1], [1.0, -0.1]], &[[2.0, -0.1], [4.1, -0.1], [4.1, 3.0]]]);
        let wanted: [&[[f64; 2]]; 4] = [
            &[[0.0, 0.1], [1.0, 0.1]],
            &[[0.0, -0.1], [1.0, -0.1]],
            &[[2.0, 0.1], [3.9, 0.1], [3.9, 3.0]],
            &[[2.0, -0.1], [4.1, -0.1], [4.1, 3.0]],
        ];
        assert_alike(&found, &wanted);
    }

    #[test]
    fn a_ring_that_is_cut_is_open() {
        let ring = [
            corner([0.0, 0.0], [HALF, HALF]),
            corner([4.0, 0.0], [-HALF, HALF]),
            corner([4.0, 3.0], [-HALF, -HALF]),
            corner([0.0, 3.0], [HALF, -HALF]),
        ];
        let part = [[2.0, 0.1], [3.9, 0.1], [3.9, 2.9], [0.1, 2.9], [0.1, 0.1], [1.0, 0.1]];
        let outer = [[2.0, -0.1], [4.1, -0.1], [4.1, 3.1], [-0.1, 3.1], [-0.1, -0.1], [1.0, -0.1]];
        assert_alike(&cut(&text(3, &ring), &[&part]), &[&part, &outer]);
    }

    #[test]
    fn what_is_no_part_of_it_is_refused() {
        let path = [corner([0.0, 0.0], [0.0, 1.0]), corner([4.0, 0.0], [0.0, 1.0])];
        let bytes = text(1, &path);
        let beside = Shape::Polyline {
            vertices: [[0.0, 0.2], [1.0, 0.2]].map(|p| Vertex { at: DVec2::from(p), bulge: 0.0 }).to_vec(),
            closed: false,
        };
        let drawing = read("a.dxf", &bytes, &ReadOptions::default(), &mut Report::default()).unwrap();
        let record = drawing.entities[0].source.record;
        let edits = [Edit::Work { record, work: EntityWork::Cut { parts: vec![beside] } }];
        let said = patch("a.dxf", &bytes, &edits, &[]).unwrap_err().to_string();
        assert!(said.contains("lies on none of its lines"), "{said}");
    }
}
