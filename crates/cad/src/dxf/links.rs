//! What hangs on an entity: annotation that does not follow it, and its id in the host program.

use std::collections::HashSet;

use glam::DVec2;

use super::ReadOptions;
use super::blocks::Blocks;
use super::fields::{handle_of, own_pairs};
use super::header::Header;
use super::limits::Limits;
use super::opened::Place;
use super::patch::tokens_of;
use super::poche::{Following, following, left_on_faces};
use super::reader::Reader;
use super::tokens::{Tokens, shown, tokenize};
use crate::drawing::{Drawing, Edit, Entity, Shape, SourceRef};
use crate::own_layers::is_own;
use crate::plane::distance_to_segment;
use enfilade_report::{Error, Report};

/// Distance, in parts of the moved entities' largest coordinate, at which a point still is "on" one.
const ON_ENTITY: f64 = 1e-7;

/// Kinds whose drawn picture does not follow what they refer to.
const ANNOTATION: [&[u8]; 7] = [
    b"DIMENSION",
    b"ARC_DIMENSION",
    b"LARGE_RADIAL_DIMENSION",
    b"LEADER",
    b"MULTILEADER",
    b"MLEADER",
    b"HATCH",
];

/// A corner of a fill lies this near to the faces that it fills, in parts of the fill's own width.
const FILL_INSET: f64 = 0.5;

/// What hangs on moved entities.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tied {
    /// Filled areas that go along, in file order.
    pub following: Vec<Following>,
    /// What keeps its bytes and may be stale, in file order.
    pub stale: Vec<SourceRef>,
}

/// What hangs on the entities that `edits` change in `drawing`. HATCH, SOLID and TRACE whose corners all lie on their shapes
/// or on what stands go along, but none of the records `held`. Stale are dimensions, leaders and hatches that refer to one by
/// handle (associative) or by a defining point on its shape, and what else fills the ground between them: SOLID, TRACE, HATCH
/// and wide polylines all of whose corners lie at such shapes, and closed polylines with several corners on what moves away:
/// the outlines of rooms. They stand in model space, or in a block where one of the changed
/// entities does.
///
/// `metres`: those of a drawing unit; the outline of a room that lies on what moves and cannot follow is stale.
///
/// # Errors
/// [`Error::Input`] where the bytes are no DXF.
pub fn tied(
    file: &str,
    bytes: &[u8],
    drawing: &Drawing,
    edits: &[Edit],
    (held, metres): (&HashSet<usize>, f64),
) -> Result<Tied, Error> {
    let tokens = tokens_of(file, bytes)?;
    let (following, left) = following(&tokens, drawing, edits, (held, metres));
    let records: HashSet<usize> = edits.iter().map(Edit::record).collect();
    let goes: HashSet<usize> = following.iter().map(|f| f.edit.record()).collect();
    let mut stale = stale(file, &tokens, drawing, &records)?;
    stale.extend(left_on_faces(drawing, edits, held).cloned());
    let rooms = drawing.entities.iter().filter(|e| e.insert().is_none() && left.contains(&e.source.record));
    stale.extend(rooms.map(|e| e.source.clone()));
    stale.sort_by_key(|s| s.record);
    stale.dedup_by_key(|s| s.record);
    stale.retain(|s| !goes.contains(&s.record) && !is_own(&s.layer));
    Ok(Tied { following, stale })
}

/// What refers to `records` or fills the ground between them and keeps its bytes.
fn stale(
    file: &str,
    tokens: &Tokens<'_>,
    drawing: &Drawing,
    records: &HashSet<usize>,
) -> Result<Vec<SourceRef>, Error> {
    let page = Header::read(tokens).page(tokens);
    let shapes = drawing.entities.iter().filter(|e| records.contains(&e.source.record)).map(|e| &e.shape);
    let outline = Outline::of(shapes);
    let handles: HashSet<String> =
        records.iter().filter(|&&r| r < tokens.records.len()).filter_map(|&r| handle_of(tokens, r)).collect();
    let associated = associated_dimensions(tokens, &handles);
    let section = tokens.section(b"ENTITIES").unwrap_or(0..0);
    // Of the blocks only where something is changed there.
    let defined = tokens.section(b"BLOCKS").filter(|d| records.iter().any(|r| d.contains(r))).unwrap_or(0..0);
    let (header, mut unsaid) = (Header::read(tokens), Report::default());
    let options = ReadOptions::default();
    let mut reader = Reader::new(file, tokens, &header, &options, &mut unsaid);
    let blocks = if defined.is_empty() { None } else { Some(Blocks::find(&reader)?) };
    let mut refers = |record: usize| {
        handle_of(tokens, record).is_some_and(|handle| associated.contains(&handle))
            || own_pairs(tokens, record)
                .any(|(_, p)| matches!(p.code, 330..=349) && handles.contains(&upper(tokens.value(p))))
            || {
                let place = blocks.as_ref().filter(|_| defined.contains(&record));
                let place = place.map(|blocks| Place::of(&mut reader, blocks, record));
                let points = defining_points(tokens, record);
                match place {
                    None => points.into_iter().any(|p| outline.holds(p)),
                    Some(place) => {
                        place.is_some_and(|place| points.into_iter().any(|p| outline.holds(place.at(p))))
                    }
                }
            }
    };
    let found = defined.clone().chain(section).filter(|&r| ANNOTATION.contains(&tokens.name(r)) && refers(r));
    let mut out: Vec<SourceRef> = found
        .map(|record| SourceRef {
            record,
            handle: handle_of(tokens, record),
            line: tokens.source_line(record),
            kind: shown(tokens.name(record)),
            layer: own_pairs(tokens, record)
                .find(|(_, p)| p.code == 8)
                .map_or_else(|| "0".into(), |(_, p)| page.decode(tokens.value(p))),
        })
        .collect();
    let fills = fills(drawing, records).filter(|(fill, reach)| {
        let points = corners(&fill.shape);
        !points.is_empty() && points.iter().all(|p| outline.distance(*p) <= *reach)
    });
    out.extend(fills.map(|(fill, _)| fill.source.clone()));
    out.sort_by_key(|s| s.record);
    out.dedup_by_key(|s| s.record);
    Ok(out)
}

/// What fills ground and is none of `records`, with how far the faces that it fills lie from its corners at most: filled
/// outlines, and polylines as wide as a wall.
fn fills<'d>(drawing: &'d Drawing, records: &HashSet<usize>) -> impl Iterator<Item = (&'d Entity, f64)> {
    let across = |e: &Entity| {
        let points = corners(&e.shape);
        let sides = (0..points.len()).map(|i| points[i].distance(points[(i + 1) % points.len()]));
        sides.filter(|side| *side > 0.0).fold(f64::INFINITY, f64::min)
    };
    let filled = drawing.fills.iter().map(move |e| (e, FILL_INSET * across(e)));
    let wide = drawing.entities.iter().filter_map(|e| Some((e, *drawing.widths.get(&e.source.record)?)));
    let wide = wide.map(|(e, width)| (e, (0.5 + FILL_INSET) * width));
    let others: HashSet<usize> = records.clone();
    filled.chain(wide).filter(move |(e, _)| !others.contains(&e.source.record))
}

fn corners(shape: &Shape) -> Vec<DVec2> {
    match shape {
        Shape::Line { a, b } => vec![*a, *b],
        Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
        Shape::Circle { .. } | Shape::Arc { .. } => Vec::new(),
    }
}

fn upper(value: &[u8]) -> String {
    String::from_utf8_lossy(value).to_ascii_uppercase()
}

/// Handles that a DIMASSOC object ties to one of `handles`: its 330 are dimensions, its 331 geometry.
fn associated_dimensions(tokens: &Tokens<'_>, handles: &HashSet<String>) -> HashSet<String> {
    let mut out = HashSet::new();
    for record in tokens.section(b"OBJECTS").unwrap_or(0..0) {
        if tokens.name(record) != b"DIMASSOC" {
            continue;
        }
        let values = |code: i32| {
            own_pairs(tokens, record)
                .filter(move |(_, p)| p.code == code)
                .map(|(_, p)| upper(tokens.value(p)))
        };
        if values(331).any(|handle| handles.contains(&handle)) {
            out.extend(values(330));
        }
    }
    out
}

/// Points that tie a record to geometry: extension line origins of a dimension, the tip of a leader,
/// corners of a hatch boundary.
fn defining_points(tokens: &Tokens<'_>, record: usize) -> Vec<DVec2> {
    let name = tokens.name(record);
    if matches!(name, b"MULTILEADER" | b"MLEADER") {
        return tips(tokens, record);
    }
    let codes: &[i32] = match name {
        b"LEADER" => &[10],
        b"HATCH" => &[10, 11],
        _ => &[13, 14, 15, 16],
    };
    let mut out: Vec<DVec2> = Vec::new();
    let mut is_boundary = name != b"HATCH";
    let mut open = None;
    for (_, pair) in own_pairs(tokens, record) {
        match pair.code {
            91 => is_boundary = true,
            75 if name == b"HATCH" => is_boundary = false,
            code if is_boundary && codes.contains(&code) => open = Some((code, tokens.number(pair))),
            code => {
                if let Some((x_code, Some(x))) = open
                    && code == x_code + 10
                    && let Some(y) = tokens.number(pair)
                {
                    out.push(DVec2::new(x, y));
                    open = None;
                }
            }
        }
    }
    if name == b"LEADER" {
        out.truncate(1);
    }
    out
}

/// The points of a MULTILEADER's lines: they stand in the lists of lines in its context data, between `LEADER_LINE{` and `}`.
fn tips(tokens: &Tokens<'_>, record: usize) -> Vec<DVec2> {
    let (mut out, mut is_line, mut x) = (Vec::new(), false, None);
    for pair in tokens.record(record) {
        match pair.code {
            304 => is_line = tokens.value(pair).starts_with(b"LEADER_LINE"),
            305 => is_line = false,
            10 if is_line => x = tokens.number(pair),
            20 if is_line => {
                let y = tokens.number(pair);
                out.extend(x.take().zip(y).map(|(x, y)| DVec2::new(x, y)));
            }
            _ => {}
        }
    }
    out
}

/// The straight pieces and centres of shapes.
struct Outline {
    pieces: Vec<[DVec2; 2]>,
    tolerance: f64,
}

impl Outline {
    fn of<'s>(shapes: impl Iterator<Item = &'s Shape>) -> Self {
        let mut pieces: Vec<[DVec2; 2]> = Vec::new();
        for shape in shapes {
            match shape {
                Shape::Line { a, b } => pieces.push([*a, *b]),
                Shape::Polyline { vertices, closed } => {
                    pieces.extend(vertices.windows(2).map(|w| [w[0].at, w[1].at]));
                    if let ([first, ..], [.., last], true) = (&vertices[..], &vertices[..], *closed) {
                        pieces.push([last.at, first.at]);
                    }
                }
                Shape::Circle { centre, .. } => pieces.push([*centre, *centre]),
                Shape::Arc { centre, radius, start_rad, end_rad } => {
                    let end = |angle: &f64| *centre + *radius * DVec2::from_angle(*angle);
                    pieces.extend([end(start_rad), end(end_rad), *centre].map(|p| [p, p]));
                }
            }
        }
        let largest = pieces.iter().flatten().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        Self { pieces, tolerance: largest * ON_ENTITY }
    }

    fn holds(&self, p: DVec2) -> bool {
        self.distance(p) <= self.tolerance
    }

    fn distance(&self, p: DVec2) -> f64 {
        self.pieces.iter().map(|s| distance_to_segment(p, *s)).fold(f64::INFINITY, f64::min)
    }
}

/// The id that a host program wrote into the XDATA of each of `records`: the first string of
/// application `ENFILADE` (our plugins), else the element id of `REVIT` (1070 = 1, then the id as 1071,
/// 1000 or 1005). `None` for a record without one, and throughout for bytes that are no DXF.
pub fn host_ids(bytes: &[u8], records: &[usize]) -> Vec<Option<String>> {
    let Ok(tokens) = tokenize(bytes, &Limits::default()) else { return vec![None; records.len()] };
    let id = |&record: &usize| {
        (record < tokens.records.len())
            .then(|| own_id(&tokens, record).or_else(|| revit_id(&tokens, record)))?
    };
    records.iter().map(id).collect()
}

/// XDATA values of one application as text.
fn xdata<'t>(
    tokens: &'t Tokens<'_>,
    record: usize,
    application: &'t [u8],
) -> impl Iterator<Item = (i32, String)> + 't {
    let pairs = tokens.record(record).iter();
    let after = pairs.skip_while(move |p| !(p.code == 1001 && tokens.value(p) == application)).skip(1);
    after.take_while(|p| p.code >= 1000 && p.code != 1001).map(|p| {
        let text = tokens.integer(p).map(|i| i.to_string());
        (p.code, text.unwrap_or_else(|| String::from_utf8_lossy(tokens.value(p)).into_owned()))
    })
}

fn own_id(tokens: &Tokens<'_>, record: usize) -> Option<String> {
    xdata(tokens, record, b"ENFILADE").find(|(code, _)| *code == 1000).map(|(_, id)| id)
}

fn revit_id(tokens: &Tokens<'_>, record: usize) -> Option<String> {
    let mut values =
        xdata(tokens, record, b"REVIT").skip_while(|(code, value)| !(*code == 1070 && value == "1"));
    values.next()?;
    values.find(|(code, _)| matches!(code, 1000 | 1005 | 1071)).map(|(_, id)| id)
}
