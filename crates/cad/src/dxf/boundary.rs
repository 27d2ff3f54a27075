//! Outlines of filled areas, with the places of their points in the file.

use glam::DVec2;

use super::fields::own_pairs;
use super::tokens::Tokens;

/// Indices of the pairs that hold the x and the y of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct At {
    /// Group 10 to 13.
    pub x: usize,
    /// Group 20 to 23.
    pub y: usize,
}

impl At {
    /// The point as written.
    pub fn point(self, tokens: &Tokens<'_>) -> Option<DVec2> {
        let value = |index: usize| tokens.number(&tokens.pairs[index]);
        Some(DVec2::new(value(self.x)?, value(self.y)?))
    }
}

/// A part of one outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Piece {
    /// A vertex, with the bulge of what begins there.
    Corner { at: At, bulge: f64 },
    /// A straight edge.
    Line { start: At, end: At },
    /// A circular edge; its angles in degrees, anticlockwise unless said otherwise.
    Arc { centre: At, radius: f64, angles_deg: [f64; 2], is_clockwise: bool },
    /// An edge of another kind.
    Curve,
}

/// The outlines of a HATCH one after another, and the points from which it was filled.
#[derive(Debug, Default)]
pub(super) struct Boundary {
    /// Outlines, each by its pieces.
    pub outlines: Vec<Vec<Piece>>,
    /// Points that lie inside.
    pub seeds: Vec<At>,
}

/// Corners of a SOLID or TRACE in the order of the file: 10, 11, 12, 13.
pub(super) fn quad(tokens: &Tokens<'_>, record: usize) -> Vec<At> {
    let index = |code: i32| own_pairs(tokens, record).find(|(_, p)| p.code == code).map(|(i, _)| i);
    (10..14).filter_map(|code| Some(At { x: index(code)?, y: index(code + 10)? })).collect()
}

/// What bounds the HATCH at `record`; `None` where a value cannot be read, or it has more pieces than `pieces_max`.
pub(super) fn boundary(tokens: &Tokens<'_>, record: usize, pieces_max: usize) -> Option<Boundary> {
    let mut reader = Reading { tokens, found: Boundary::default(), edge: Edge::default(), x: None };
    let mut part = Part::Head;
    for (index, pair) in own_pairs(tokens, record) {
        part = match (part, pair.code) {
            (Part::Head, 91) => Part::Between,
            (Part::Between | Part::Polyline | Part::Edges, 92) => {
                reader.close();
                reader.found.outlines.push(Vec::new());
                let is_polyline = tokens.number(pair)? as i64 & 2 != 0;
                if is_polyline { Part::Polyline } else { Part::Edges }
            }
            (Part::Between | Part::Polyline | Part::Edges, 75) => {
                reader.close();
                Part::Style
            }
            (Part::Polyline, code) => {
                reader.vertex(index, code)?;
                part
            }
            // Within a spline it counts points; those edges are only counted anyway.
            (Part::Edges, 97) if reader.edge.kind != SPLINE => {
                reader.close();
                Part::Between
            }
            (Part::Edges, code) => {
                reader.edge(index, code)?;
                part
            }
            (Part::Style, 98) => Part::Seeds,
            (Part::Seeds, code) => {
                if let Some(at) = reader.point(index, code, 10) {
                    reader.found.seeds.push(at);
                }
                part
            }
            _ => part,
        };
        if reader.found.outlines.iter().map(Vec::len).sum::<usize>() > pieces_max {
            return None;
        }
    }
    reader.close();
    Some(reader.found)
}

/// Kinds of edges, group 72.
const LINE: i64 = 1;
const ARC: i64 = 2;
const SPLINE: i64 = 4;

/// Where in a HATCH a pair stands.
#[derive(Clone, Copy)]
enum Part {
    Head,
    Between,
    Polyline,
    Edges,
    Style,
    Seeds,
}

/// The edge that is being read; kind 0: none.
#[derive(Default)]
struct Edge {
    kind: i64,
    points: [Option<At>; 2],
    radius: f64,
    angles_deg: [f64; 2],
    is_clockwise: bool,
}

struct Reading<'t, 'a> {
    tokens: &'t Tokens<'a>,
    found: Boundary,
    edge: Edge,
    x: Option<(i32, usize)>,
}

impl Reading<'_, '_> {
    fn number(&self, index: usize) -> Option<f64> {
        self.tokens.number(&self.tokens.pairs[index])
    }

    /// The point at groups `x_code` and ten more, once both have come.
    fn point(&mut self, index: usize, code: i32, x_code: i32) -> Option<At> {
        if code == x_code {
            self.x = Some((code, index));
            return None;
        }
        let (_, x) = self.x.filter(|(of, _)| code == x_code + 10 && *of == x_code)?;
        self.x = None;
        Some(At { x, y: index })
    }

    fn vertex(&mut self, index: usize, code: i32) -> Option<()> {
        let at = self.point(index, code, 10);
        let bulge = if code == 42 { Some(self.number(index)?) } else { None };
        if matches!(code, 10 | 20) {
            self.number(index)?;
        }
        let outline = self.found.outlines.last_mut()?;
        if let Some(at) = at {
            outline.push(Piece::Corner { at, bulge: 0.0 });
        }
        if let (Some(new), Some(Piece::Corner { bulge, .. })) = (bulge, outline.last_mut()) {
            *bulge = new;
        }
        Some(())
    }

    fn edge(&mut self, index: usize, code: i32) -> Option<()> {
        match code {
            72 => {
                self.close();
                self.edge.kind = self.number(index)? as i64;
            }
            10 | 20 if matches!(self.edge.kind, LINE | ARC) => {
                self.number(index)?;
                self.edge.points[0] = self.point(index, code, 10).or(self.edge.points[0]);
            }
            11 | 21 if self.edge.kind == LINE => {
                self.number(index)?;
                self.edge.points[1] = self.point(index, code, 11).or(self.edge.points[1]);
            }
            40 => self.edge.radius = self.number(index)?,
            50 => self.edge.angles_deg[0] = self.number(index)?,
            51 => self.edge.angles_deg[1] = self.number(index)?,
            73 => self.edge.is_clockwise = self.number(index)? == 0.0,
            _ => {}
        }
        Some(())
    }

    /// Puts the edge that was being read at the end of its outline.
    fn close(&mut self) {
        let Edge { kind, points, radius, angles_deg, is_clockwise } = std::mem::take(&mut self.edge);
        self.x = None;
        let piece = match (kind, points) {
            (0, _) => return,
            (LINE, [Some(start), Some(end)]) => Piece::Line { start, end },
            (ARC, [Some(centre), _]) => Piece::Arc { centre, radius, angles_deg, is_clockwise },
            _ => Piece::Curve,
        };
        if let Some(outline) = self.found.outlines.last_mut() {
            outline.push(piece);
        }
    }
}
