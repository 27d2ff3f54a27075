//! Where XCLIP bounds what an INSERT shows: the SPATIAL_FILTER that its extension dictionary names.
//!
//! A filter states its boundary in coordinates of its own, the way there from the world, and the way from the world into
//! the block as the INSERT stood when it was clipped. An INSERT that moves takes its boundary along.

use std::collections::HashMap;

use glam::{DAffine2, DVec2};

use super::fields::{Fields, handle_of, own_pairs, point_slots};
use super::tokens::Tokens;
use crate::plane::{box_of, distance_to_segment, is_inside_ring, ring_area};

/// What is this near to a boundary, in parts of its largest coordinate, lies on it.
const ON_BOUNDARY: f64 = 1e-9;

/// Numbers of a filter's two matrices of three rows and four columns.
const MATRIX_NUMBERS: usize = 12;

/// The part of the plane that a clipped INSERT shows.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Clip {
    /// Corners of the boundary.
    pub ring: Vec<DVec2>,
    /// Whether what lies outside is shown instead of what lies inside.
    pub is_inverted: bool,
}

impl Clip {
    /// The same through a map.
    pub fn mapped(&self, map: &DAffine2) -> Self {
        Self { ring: self.ring.iter().map(|p| map.transform_point2(*p)).collect(), ..*self }
    }

    /// The sides of the boundary.
    pub fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let next = self.ring.iter().cycle().skip(1);
        self.ring.iter().zip(next).map(|(a, b)| [*a, *b])
    }

    /// Whether a point is shown; those on the boundary are.
    pub fn shows(&self, p: DVec2) -> bool {
        let largest = self.ring.iter().map(|q| q.abs().max_element()).fold(0.0, f64::max);
        is_inside_ring(&self.ring, p) != self.is_inverted
            || self.sides().any(|side| distance_to_segment(p, side) <= ON_BOUNDARY * largest)
    }

    /// The part of a box within which something can be shown.
    pub fn limited(&self, [lo, hi]: [DVec2; 2]) -> Option<[DVec2; 2]> {
        let Some([from, to]) = box_of(self.ring.iter().copied()).filter(|_| !self.is_inverted) else {
            return Some([lo, hi]);
        };
        let (lo, hi) = (lo.max(from), hi.min(to));
        lo.cmple(hi).all().then_some([lo, hi])
    }
}

/// The clips of a file by the records of their INSERTs, in coordinates of the blocks that these show; for a boundary that
/// cannot be read the reason. A clip that is switched off hides nothing and gives no outline.
pub(super) fn clips(
    tokens: &Tokens<'_>,
    inserts: impl Iterator<Item = usize>,
) -> HashMap<usize, Result<Clip, &'static str>> {
    let Some(objects) = Objects::of(tokens) else { return HashMap::new() };
    let one = |insert: usize| Some((insert, objects.clip(objects.filter_of(insert)?).transpose()?));
    inserts.filter_map(one).collect()
}

/// The objects of a file that has filters, by handle.
struct Objects<'t, 'a> {
    tokens: &'t Tokens<'a>,
    by_handle: HashMap<String, usize>,
}

impl<'t, 'a> Objects<'t, 'a> {
    fn of(tokens: &'t Tokens<'a>) -> Option<Self> {
        let section = tokens.section(b"OBJECTS")?;
        section.clone().any(|r| tokens.name(r) == b"SPATIAL_FILTER").then(|| {
            let named = section.filter_map(|r| Some((bare(&handle_of(tokens, r)?), r)));
            Self { tokens, by_handle: named.collect() }
        })
    }

    fn by_handle(&self, value: &[u8]) -> Option<usize> {
        self.by_handle.get(&bare(&String::from_utf8_lossy(value))).copied()
    }

    /// The filter of an INSERT.
    fn filter_of(&self, insert: usize) -> Option<usize> {
        let filters = self.entry(self.dictionary_of(insert)?, b"ACAD_FILTER")?;
        let filter = self.entry(filters, b"SPATIAL")?;
        (self.tokens.name(filter) == b"SPATIAL_FILTER").then_some(filter)
    }

    /// The extension dictionary of a record.
    fn dictionary_of(&self, record: usize) -> Option<usize> {
        let mut pairs = self.tokens.record(record).iter();
        pairs.find(|p| p.code == 102 && self.tokens.value(p) == b"{ACAD_XDICTIONARY")?;
        self.by_handle(self.tokens.value(pairs.next().filter(|p| matches!(p.code, 350 | 360))?))
    }

    /// What a dictionary has under a name.
    fn entry(&self, dictionary: usize, name: &[u8]) -> Option<usize> {
        let mut pairs = self.tokens.record(dictionary).iter();
        pairs.find(|p| p.code == 3 && self.tokens.value(p).eq_ignore_ascii_case(name))?;
        self.by_handle(self.tokens.value(pairs.next().filter(|p| matches!(p.code, 350 | 360))?))
    }

    /// What a filter bounds; nothing where it is switched off.
    fn clip(&self, filter: usize) -> Result<Option<Clip>, &'static str> {
        let switch = Fields::of(self.tokens, filter).pair(71).and_then(|p| self.tokens.integer(p));
        if switch == Some(0) {
            return Ok(None);
        }
        let block_from_clip = self.block_from_clip(filter)?;
        let points = point_slots(self.tokens, filter, 10).into_iter().map(|(x, y)| {
            let number = |index: usize| self.tokens.number(&self.tokens.pairs[index]);
            Some(DVec2::new(number(x)?, number(y?)?)).filter(|p| p.is_finite())
        });
        let points = points.collect::<Option<Vec<DVec2>>>().ok_or("a point of it is no pair of numbers")?;
        let inner = self.inverted(filter);
        let is_inverted = inner.is_some();
        let own = ring_of(&points);
        // A program that knows no inverted clips is given the outer boundary with a slit to the inner one.
        let ring = match inner.map(|points| ring_of(&points)).filter(|inner| inner.len() > 2) {
            Some(inner) if size(&inner) < size(&own) => inner,
            _ => own,
        };
        let clip = Clip { ring, is_inverted }.mapped(&block_from_clip);
        if clip.ring.len() < 3 || ring_area(&clip.ring) == 0.0 || !clip.ring.iter().all(|p| p.is_finite()) {
            return Err("it encloses nothing");
        }
        Ok(Some(clip))
    }

    /// Coordinates of a filter's boundary to those of the block.
    fn block_from_clip(&self, filter: usize) -> Result<DAffine2, &'static str> {
        let numbers = own_pairs(self.tokens, filter).filter(|(_, p)| p.code == 40);
        let numbers: Vec<f64> = numbers.filter_map(|(_, p)| self.tokens.number(p)).collect();
        // The distance of a front plane, where it has one, stands before the matrices.
        let first = numbers.len().checked_sub(2 * MATRIX_NUMBERS).filter(|first| *first < 2);
        let both = &numbers[first.ok_or("its two matrices are not there")?..];
        let [block_from_world, clip_from_world] =
            [&both[..MATRIX_NUMBERS], &both[MATRIX_NUMBERS..]].map(seen_from_above);
        let map = block_from_world * clip_from_world.inverse();
        let is_flat = map.is_finite() && map.matrix2.determinant() != 0.0;
        is_flat.then_some(map).ok_or("its matrices do not lie in the plane of the plan")
    }

    /// The inner boundary of an inverted clip, as far as it is stated.
    fn inverted(&self, filter: usize) -> Option<Vec<DVec2>> {
        let data = self.entry(self.dictionary_of(filter)?, b"ACAD_XREC_ROUNDTRIP")?;
        let mut pairs = self.tokens.record(data).iter();
        pairs.find(|p| p.code == 102 && self.tokens.value(p) == b"ACAD_INVERTEDCLIP_ROUNDTRIP")?;
        let mut own = pairs.take_while(|p| p.code != 102).peekable();
        let mut points = Vec::new();
        while let Some(x) = own.next() {
            let y = own.peek().filter(|y| x.code == 10 && y.code == 20);
            let both = self.tokens.number(x).zip(y.and_then(|y| self.tokens.number(y)));
            points.extend(both.map(|(x, y)| DVec2::new(x, y)).filter(|p| p.is_finite()));
        }
        Some(points)
    }
}

/// A handle without the zeros that some programs write before it.
fn bare(handle: &str) -> String {
    handle.trim_start_matches('0').to_ascii_uppercase()
}

/// The corners of a boundary: two points are those of a rectangle.
fn ring_of(points: &[DVec2]) -> Vec<DVec2> {
    match points {
        [a, b] => vec![*a, DVec2::new(b.x, a.y), *b, DVec2::new(a.x, b.y)],
        [rest @ .., last] if rest.first() == Some(last) => rest.to_vec(),
        all => all.to_vec(),
    }
}

/// Area of the box round a ring.
fn size(ring: &[DVec2]) -> f64 {
    box_of(ring.iter().copied()).map_or(0.0, |[lo, hi]| (hi - lo).element_product())
}

/// What a matrix of rows of four does to x and y.
fn seen_from_above(rows: &[f64]) -> DAffine2 {
    let column = |i: usize| DVec2::new(rows[i], rows[4 + i]);
    DAffine2::from_cols(column(0), column(1), column(3))
}
