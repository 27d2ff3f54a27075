//! Filled areas that a building work cuts: what fills a wall ends at its opening.

use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::single::SingleFloatOverlay;

use super::additions::{Writer, count_splice};
use super::boundary::{Piece, boundary, quad};
use super::fields::{Fields, own_pairs};
use super::header::Header;
use super::patch::{Editor, tokens_of};
use super::poche::{FILLS, PIECES_MAX};
use super::tokens::Tokens;
use crate::own_layers::is_own;
use crate::splice::Splice;
use enfilade_report::Error;

/// Flags of an outline: the outer one, a polyline.
const OUTLINE_FLAGS: i32 = 3;

/// Where a wall is filled: a point inside it, and one beside either face. A floor is filled beside it too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// In the middle of the stretch, drawing units.
    pub inside: DVec2,
    /// Beside its faces.
    pub beside: [DVec2; 2],
}

/// Records of the filled areas of model space with straight sides that fill a wall at a place.
///
/// # Errors
/// As [`patch`](super::patch::patch).
pub fn fills_at(file: &str, bytes: &[u8], at: Probe) -> Result<Vec<usize>, Error> {
    let tokens = &tokens_of(file, bytes)?;
    let page = Header::read(tokens).page(tokens);
    let is_fill = |r: &usize| FILLS.contains(&tokens.name(*r));
    let is_foreign = |r: &usize| {
        let fields = Fields::of(tokens, *r);
        fields.index(67).is_none() && !fields.value(8).is_some_and(|l| is_own(&page.decode(l)))
    };
    let fills = |r: &usize| {
        let Some(rings) = rings(tokens, *r) else { return false };
        holds(&rings, at.inside) && !at.beside.iter().any(|b| holds(&rings, *b))
    };
    Ok(tokens
        .section(b"ENTITIES")
        .unwrap_or(0..0)
        .filter(|r| is_fill(r) && is_foreign(r) && fills(r))
        .collect())
}

/// Outlines of a filled area that has straight sides alone.
fn rings(tokens: &Tokens<'_>, record: usize) -> Option<Vec<Vec<[f64; 2]>>> {
    if tokens.name(record) != b"HATCH" {
        let corners = quad(tokens, record);
        let at = |k: usize| corners.get(k).and_then(|c| c.point(tokens)).map(<[f64; 2]>::from);
        let mut ring: Vec<[f64; 2]> = [0, 1, 3, 2].into_iter().filter_map(at).collect();
        ring.dedup();
        return (ring.len() > 2).then_some(vec![ring]);
    }
    let found = boundary(tokens, record, PIECES_MAX)?;
    let corner = |piece: &Piece| match *piece {
        Piece::Corner { at, bulge } => at.point(tokens).filter(|_| bulge == 0.0),
        Piece::Line { start, .. } => start.point(tokens),
        Piece::Arc { .. } | Piece::Curve => None,
    };
    let ring = |outline: &Vec<Piece>| -> Option<Vec<[f64; 2]>> {
        outline.iter().map(|p| corner(p).map(<[f64; 2]>::from)).collect()
    };
    found.outlines.iter().map(ring).collect()
}

/// Whether a point lies inside, by the even-odd rule.
fn holds(rings: &[Vec<[f64; 2]>], p: DVec2) -> bool {
    let crosses = |a: [f64; 2], b: [f64; 2]| {
        (a[1] > p.y) != (b[1] > p.y) && p.x < a[0] + (p.y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    let of = |ring: &Vec<[f64; 2]>| {
        (0..ring.len()).filter(|&k| crosses(ring[k], ring[(k + 1) % ring.len()])).count()
    };
    rings.iter().map(of).sum::<usize>() % 2 == 1
}

impl Editor<'_, '_> {
    /// What stays of a filled area outside a stretch; nothing: it goes to the layer of what is demolished.
    pub(super) fn refill(&mut self, gone: &[DVec2; 4], writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        if !FILLS.contains(&self.tokens.name(self.record)) {
            return Err(self.fault("it is no filled area"));
        }
        let fields = Fields::of(self.tokens, self.record);
        if self.is_mirrored(&fields)? {
            return Err(self.fault("it is drawn in a plane that is turned over"));
        }
        let rings = rings(self.tokens, self.record);
        let rings = rings.ok_or_else(|| self.fault("its outline is round where it would be cut"))?;
        let gone: Vec<[f64; 2]> = gone.iter().copied().map(<[f64; 2]>::from).collect();
        let left: Vec<Vec<[f64; 2]>> =
            rings.overlay(&vec![gone], OverlayRule::Difference, FillRule::EvenOdd).concat();
        self.listen(left.iter().flatten().map(|p| DVec2::from(*p)))?;
        if left.is_empty() {
            return self.drop();
        }
        if self.tokens.name(self.record) == b"HATCH" {
            self.outlines(&left, writer)
        } else {
            self.solids(&left, writer)
        }
    }

    /// Replaces the outlines of a HATCH.
    fn outlines(&mut self, rings: &[Vec<[f64; 2]>], writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        let index =
            |code: i32| own_pairs(self.tokens, self.record).find(|(_, p)| p.code == code).map(|(i, _)| i);
        let (Some(first), Some(style)) = (index(91), index(75)) else {
            return Err(self.fault("it has no outlines"));
        };
        writer.int(91, rings.len() as i32);
        for ring in rings {
            writer.int(92, OUTLINE_FLAGS);
            writer.int(72, 0);
            writer.int(73, 1);
            writer.int(93, ring.len() as i32);
            for [x, y] in ring {
                writer.float(10, *x);
                writer.float(20, *y);
            }
            writer.int(97, 0);
        }
        let (start, end) = (self.tokens.pair_start(first), self.tokens.pair_start(style));
        let with = writer.take();
        self.out.push((self.record, Splice { start, end, with }));
        // It no longer follows the lines that it was made of.
        let tied = index(71).filter(|i| self.tokens.integer(&self.tokens.pairs[*i]) == Some(1));
        if let Some(splice) = tied.and_then(|i| count_splice(self.tokens, i, -1)) {
            self.out.push((self.record, splice));
        }
        Ok(())
    }

    /// Pieces of three or four corners: the first in its own record, the others behind it.
    fn solids(&mut self, rings: &[Vec<[f64; 2]>], writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        if rings.iter().any(|r| r.len() > 4) {
            return Err(self.fault("what stays of it has more than four corners"));
        }
        let corners = |ring: &[[f64; 2]]| -> [DVec2; 4] {
            let at = |k: usize| DVec2::from(ring[k.min(ring.len() - 1)]);
            [at(0), at(1), at(3), at(2)]
        };
        let Some((first, others)) = rings.split_first() else { return Ok(()) };
        self.points(&corners(first))?;
        let kind = String::from_utf8_lossy(self.tokens.name(self.record)).into_owned();
        for ring in others {
            self.begin(&kind, self.record, writer);
            self.subclass(self.record, "AcDbTrace", writer);
            for (k, p) in corners(ring).into_iter().enumerate() {
                writer.float(10 + k as i32, p.x);
                writer.float(20 + k as i32, p.y);
                writer.float(30 + k as i32, 0.0);
            }
        }
        self.put_behind(writer);
        Ok(())
    }
}
