//! MLINE: several lines drawn along one path, as many programs draw a wall with both its faces.

use glam::DVec2;

use super::curves::polyline;
use super::entity::{Body, Skip, as_a_whole};
use super::fields::{Fields, own_pairs};
use super::reader::Reader;
use crate::drawing::Editable;
use enfilade_report::Error;

/// Most lines of one multiline; the programs that draw them allow as many.
const ELEMENTS_MAX: usize = 16;

/// A corner of the path.
#[derive(Default)]
struct Corner {
    at: DVec2,
    /// In which the lines meet at the corner.
    mitre: DVec2,
    /// Per line: how far along the mitre it passes, then where along it it begins, stops, begins again …
    lines: Vec<Vec<f64>>,
}

impl Reader<'_, '_> {
    /// The lines of a multiline, each between its breaks. They are computed from its path and move as a whole.
    pub(super) fn multiline(&self, fields: &Fields<'_, '_>) -> Result<Result<Vec<Body>, Skip>, Error> {
        let corners = match self.corners(fields)? {
            Ok(corners) => corners,
            Err(skip) => return Ok(Err(skip)),
        };
        let is_closed = self.int(fields, 71, 0)? & 2 != 0;
        let lines = 0..corners[0].lines.len();
        let pieces = lines.flat_map(|line| pieces(&corners, line, is_closed));
        let whole = as_a_whole(self.extrusion(fields)?);
        // A straight one without breaks can change its length too.
        let is_straight = corners.len() == 2 && !is_closed;
        let has_breaks = corners.iter().flat_map(|c| &c.lines).any(|line| line.len() > 2);
        let editable = match whole {
            Editable::WithInsert { turnable: true } if is_straight && !has_breaks => {
                let length = corners[0].at.distance(corners[1].at);
                Editable::Wall { ends: [vec![0], vec![1]], free: [length; 2] }
            }
            other => other,
        };
        let bodies = pieces
            .map(|(points, is_ring)| self.checked(Body::Shape(polyline(points, is_ring), editable.clone())));
        Ok(bodies.collect())
    }

    /// The corners of its path as written; groups 11, 13, 74 and 41 in their order.
    fn corners(&self, fields: &Fields<'_, '_>) -> Result<Result<Vec<Corner>, Skip>, Error> {
        let mut corners: Vec<Corner> = Vec::new();
        let mut awaited = 0;
        for (_, pair) in own_pairs(self.tokens, fields.record) {
            if pair.code == 11 {
                corners.push(Corner::default());
            }
            let Some(corner) = corners.last_mut() else { continue };
            match pair.code {
                11 => corner.at.x = self.number(pair, fields.record)?,
                21 => corner.at.y = self.number(pair, fields.record)?,
                13 => corner.mitre.x = self.number(pair, fields.record)?,
                23 => corner.mitre.y = self.number(pair, fields.record)?,
                74 => {
                    awaited = self.tokens.integer(pair).and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
                    corner.lines.push(Vec::new());
                }
                41 => match corner.lines.last_mut().filter(|line| line.len() < awaited) {
                    Some(line) => line.push(self.number(pair, fields.record)?),
                    None => return Ok(Err(bad("found a group 41 that no group 74 counts".into()))),
                },
                _ => {}
            }
        }
        Ok(self.checked_corners(corners))
    }

    fn checked_corners(&self, corners: Vec<Corner>) -> Result<Vec<Corner>, Skip> {
        let (count, limit) = (corners.len(), self.limits.max_vertices);
        if !(2..=limit).contains(&count) {
            return Err(bad(format!("its corners, found {count}, expected 2 to {limit}")));
        }
        let lines = corners[0].lines.len();
        if !(1..=ELEMENTS_MAX).contains(&lines) || corners.iter().any(|c| c.lines.len() != lines) {
            return Err(bad(format!(
                "its lines, found {lines} at the first corner, expected 1 to {ELEMENTS_MAX} at each"
            )));
        }
        Ok(corners)
    }
}

fn bad(text: String) -> Skip {
    ("dxf-bad-multiline", format!("{text}; left out of the plan, kept in the file"))
}

/// One line of a multiline, cut where it has breaks: each piece with whether it is closed.
fn pieces(corners: &[Corner], line: usize, is_closed: bool) -> Vec<(Vec<DVec2>, bool)> {
    let at = |c: &Corner| c.at + c.mitre * c.lines[line].first().copied().unwrap_or(0.0);
    let count = corners.len();
    let stretches = if is_closed { count } else { count - 1 };
    let has_breaks = corners[..stretches].iter().any(|c| c.lines[line].len() > 2);
    if !has_breaks {
        return vec![(corners.iter().map(at).collect(), is_closed)];
    }
    let mut out: Vec<(Vec<DVec2>, bool)> = Vec::new();
    for i in 0..stretches {
        let (a, b) = (at(&corners[i]), at(&corners[(i + 1) % count]));
        let (along, length) = ((b - a).normalize_or_zero(), a.distance(b));
        let marks = corners[i].lines[line].iter().skip(1).map(|s| s.clamp(0.0, length));
        let mut marks: Vec<f64> = marks.collect();
        if marks.len() % 2 == 1 {
            marks.push(length);
        }
        for drawn in marks.chunks(2).filter(|d| d[1] > d[0]) {
            // At the corner itself, without the rounding of the way there: the next stretch goes on from it.
            let (from, to) =
                (a + along * drawn[0], if drawn[1] == length { b } else { a + along * drawn[1] });
            match out.last_mut().filter(|(piece, _)| drawn[0] == 0.0 && piece.last() == Some(&from)) {
                Some((piece, _)) => piece.push(to),
                None => out.push((vec![from, to], false)),
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Drawing, Edit, RigidMotion, Shape};
    use crate::dxf::{ReadOptions, patch, read};
    use enfilade_report::Report;

    /// A corner at x and y with its mitre, and the numbers of each of its lines.
    fn corner([x, y]: [f64; 2], [u, v]: [f64; 2], lines: &[&[f64]]) -> String {
        let mut out = format!("11|{x}|21|{y}|31|0|12|1|22|0|32|0|13|{u}|23|{v}|33|0|");
        for line in lines {
            out += &format!(
                "74|{}|{}75|0|",
                line.len(),
                line.iter().map(|v| format!("41|{v}|")).collect::<String>()
            );
        }
        out
    }

    fn text(flags: i32, corners: &str) -> String {
        let text = format!(
            "0|SECTION|2|ENTITIES|0|LINE|8|0|10|0|20|0|11|1|21|0|0|MLINE|5|2F3|8|A-WALL|40|1|70|0|71|{flags}|10|0|20|0|\
             {corners}0|ENDSEC|0|EOF|"
        );
        text.replace('|', "\n")
    }

    /// What a drawing of this multiline is read as, and the codes of what is said of it.
    fn drawn(flags: i32, corners: &str) -> (Drawing, Vec<&'static str>) {
        let mut report = Report::default();
        let drawing =
            read("a.dxf", text(flags, corners).as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        (drawing, report.problems.iter().map(|p| p.code).filter(|c| c.starts_with("dxf-bad")).collect())
    }

    /// The points of each of its lines, with whether it is closed.
    fn lines(drawing: &Drawing) -> Vec<(Vec<[f64; 2]>, bool)> {
        let own = drawing.entities.iter().filter(|e| e.source.kind == "MLINE");
        own.map(|e| match &e.shape {
            Shape::Polyline { vertices, closed } => {
                (vertices.iter().map(|v| v.at.to_array()).collect(), *closed)
            }
            other => panic!("{other:?}"),
        })
        .collect()
    }

    /// As another library draws the same multilines.
    #[test]
    fn both_faces_are_drawn_and_move_as_a_whole() {
        let faces: &[&[f64]] = &[&[0.075, 0.0], &[-0.075, 0.0]];
        let mitred: &[&[f64]] = &[&[0.106_066_017_177_982_13, 0.0], &[-0.106_066_017_177_982_13, 0.0]];
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let (path, said) = drawn(
            1,
            &[
                corner([6.0, 0.0], [-1.0, 0.0], faces),
                corner([6.0, 5.0], [-half, half], mitred),
                corner([9.0, 5.0], [0.0, 1.0], faces),
            ]
            .concat(),
        );
        let found = lines(&path);
        let wanted =
            [[[5.925, 0.0], [5.925, 5.075], [9.0, 5.075]], [[6.075, 0.0], [6.075, 4.925], [9.0, 4.925]]];
        assert_eq!(found.len(), 2);
        for ((points, is_closed), wanted) in found.iter().zip(&wanted) {
            let off = points.iter().zip(wanted).map(|(p, w)| (p[0] - w[0]).hypot(p[1] - w[1]));
            assert!(points.len() == 3 && !is_closed && off.fold(0.0, f64::max) < 1e-12, "{points:?}");
        }
        assert_eq!(said, Vec::<&str>::new());
        let mut own = path.entities.iter().filter(|e| e.source.kind == "MLINE");
        assert!(own.all(|e| e.editable == Editable::WithInsert { turnable: true }));
    }

    /// All that is written of it goes along: where it starts, its corners, the ways of its stretches and mitres.
    #[test]
    fn what_is_moved_reads_as_moved() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let faces: &[&[f64]] = &[&[0.1, 0.0], &[-0.1, 0.0]];
        let corners = [
            corner([0.0, 0.0], [0.0, 1.0], faces),
            corner([4.0, 0.0], [-half, half], &[&[0.2, 0.0, 1.0, 2.0], &[-0.2, 0.0]]),
            corner([4.0, 3.0], [-1.0, 0.0], faces),
        ]
        .concat();
        for turn_rad in [0.0, 0.4] {
            let motion = RigidMotion { turn_rad, shift: DVec2::new(0.75, -0.5) };
            let (before, bytes) = (drawn(1, &corners).0, text(1, &corners).into_bytes());
            let record = before.entities.iter().find(|e| e.source.kind == "MLINE").unwrap().source.record;
            let edits = [Edit::Insert { record, motion }];
            let written = patch("a.dxf", &bytes, &edits, &[]).unwrap();
            let after = read("a.dxf", &written, &ReadOptions::default(), &mut Report::default()).unwrap();
            let (was, is) = (lines(&before), lines(&after));
            assert_eq!(was.len(), is.len());
            let turn = DVec2::from_angle(turn_rad);
            for (was, is) in was.iter().zip(&is) {
                for (p, q) in was.0.iter().zip(&is.0) {
                    let meant = turn.rotate(DVec2::from(*p)) + motion.shift;
                    assert!(meant.distance(DVec2::from(*q)) < 1e-9, "{meant} {q:?}");
                }
            }
            let text = String::from_utf8(written).unwrap();
            assert!(text.contains("\n10\n0.75\n20\n-0.5\n"), "where it starts: {text}");
            let way = format!("\n12\n{}", turn.x);
            assert!(text.contains(way.trim_end_matches(".0")), "{way}: {text}");
        }
    }

    /// A straight one changes its length at either end, alone and while it moves; one with a corner does not.
    #[test]
    fn a_straight_one_changes_its_length() {
        let faces: &[&[f64]] = &[&[0.1, 0.0], &[-0.1, 0.0]];
        let corners = corner([1.0, 2.0], [0.0, 1.0], faces) + &corner([5.0, 2.0], [0.0, 1.0], faces);
        let (before, bytes) = (drawn(1, &corners).0, text(1, &corners).into_bytes());
        let own: Vec<_> = before.entities.iter().filter(|e| e.source.kind == "MLINE").collect();
        let can = Editable::Wall { ends: [vec![0], vec![1]], free: [4.0; 2] };
        assert!(own.len() == 2 && own.iter().all(|e| e.editable == can), "{own:?}");
        let (record, by) = (own[0].source.record, [0.5, -0.25]);
        for turn_rad in [None, Some(0.0), Some(0.3)] {
            let motion = turn_rad.map(|turn_rad| RigidMotion { turn_rad, shift: DVec2::new(-3.0, 0.5) });
            let moved = motion.map(|motion| Edit::Insert { record, motion });
            let edits: Vec<Edit> = moved.into_iter().chain([Edit::Ends { record, by }]).collect();
            let written = patch("a.dxf", &bytes, &edits, &[]).unwrap();
            let after = read("a.dxf", &written, &ReadOptions::default(), &mut Report::default()).unwrap();
            for (was, is) in lines(&before).iter().zip(&lines(&after)) {
                for ((p, q), by) in was.0.iter().zip(&is.0).zip(by) {
                    let p = DVec2::from(*p) + DVec2::X * by;
                    let meant = motion.map_or(p, |m| DVec2::from_angle(m.turn_rad).rotate(p) + m.shift);
                    assert!(meant.distance(DVec2::from(*q)) < 1e-9, "{turn_rad:?}: {meant} {q:?}");
                }
            }
        }
    }

    #[test]
    fn a_closed_path_is_a_ring_and_breaks_are_left_open() {
        let at = |x: f64, y: f64, line: &[f64]| corner([x, y], [0.0, 0.0], &[line]);
        let ring = [at(0.0, 0.0, &[0.0, 0.0]), at(4.0, 0.0, &[0.0, 0.0]), at(4.0, 3.0, &[0.0, 0.0])].concat();
        assert_eq!(lines(&drawn(3, &ring).0), [(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]], true)]);
        // Drawn from 0 to 1 and from 2 on, round the corner, up to 1 of the second stretch.
        let broken = [
            at(0.0, 0.0, &[0.0, 0.0, 1.0, 2.0]),
            at(4.0, 0.0, &[0.0, 0.0, 1.0, 3.0]),
            at(4.0, 3.0, &[0.0, 0.0]),
        ];
        let wanted =
            [(vec![[0.0, 0.0], [1.0, 0.0]], false), (vec![[2.0, 0.0], [4.0, 0.0], [4.0, 1.0]], false)];
        assert_eq!(lines(&drawn(1, &broken.concat()).0), wanted);
    }

    #[test]
    fn what_cannot_be_drawn_is_named_and_left_out() {
        let at = |line: &[&[f64]]| corner([0.0, 0.0], [0.0, 1.0], line);
        let far = corner([1e30, 0.0], [0.0, 1.0], &[&[0.0]]);
        let crowd: Vec<&[f64]> = vec![&[0.0]; ELEMENTS_MAX + 1];
        let most: Vec<&[f64]> = vec![&[0.0]; ELEMENTS_MAX];
        for (corners, codes) in [
            (String::new(), vec!["dxf-bad-multiline"]),
            (at(&[&[0.0]]), vec!["dxf-bad-multiline"]),
            ([at(&[&[0.0]]), at(&[])].concat(), vec!["dxf-bad-multiline"]),
            ([at(&crowd), at(&crowd)].concat(), vec!["dxf-bad-multiline"]),
            ([at(&[&[0.0]]), far].concat(), vec!["dxf-bad-coordinate"]),
            ([at(&[&[0.0]]), at(&[&[0.0]]).replace("74|1", "74|0")].concat(), vec!["dxf-bad-multiline"]),
        ] {
            let (drawing, said) = drawn(1, &corners);
            assert_eq!((lines(&drawing).len(), said), (0, codes), "{corners}");
        }
        assert_eq!(lines(&drawn(1, &[at(&most), at(&most)].concat()).0).len(), ELEMENTS_MAX);
    }
}
