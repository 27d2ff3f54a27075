//! Borders of a sheet with their title block, drawn on the layer that was taken as walls because no other was named so.

use std::collections::BTreeSet;

use glam::DVec2;

use super::curve::control_points;
use super::drawing::{Drawing, Entity};
use super::parallels::{Piece, pieces};
use super::view_names::says_scale_or_author;
use super::{box_of, distance_to_segment};
use crate::report::{Place, Report};

/// Points this near, as a share of the longer side of the border, are one.
const SAME_SHARE: f64 = 1e-4;

/// Most borders one in another: the edge of the paper, the margin, one more.
const BORDERS_MAX: usize = 3;

/// A border within another keeps this far from it at most, as a share of the longer side: from three sides equally, and
/// from the one where the sheet is bound.
const MARGIN_SHARE: f64 = 0.04;
const BOUND_SHARE: f64 = 0.08;

/// Fewest straight pieces that must be left: without them the border is the building.
const REST_MIN: usize = 8;

/// Most pieces that hang on a border: more, and it is a building's outer wall.
const ATTACHED_MAX: usize = 400;

/// Longer and shorter sides of sheets, ISO 216 and 5457, millimetres.
const SHEETS_MM: &[[f64; 2]] =
    &[[1189.0, 841.0], [841.0, 594.0], [594.0, 420.0], [420.0, 297.0], [297.0, 210.0]];

/// Scales of drawings, but for powers of ten.
const SCALES: &[f64] = &[1.0, 1.25, 1.5, 2.0, 2.5, 5.0, 7.5];

/// How exactly a border is a sheet at a scale.
const SHEET_SHARE: f64 = 0.002;

/// Takes borders of the sheet, and what hangs on them, out of `walls` (indices of the drawing's entities) and says so.
///
/// A border is a rectangle round all that is left, to which nothing of that is joined. One is taken for a border only if it
/// is a sheet at a scale of drawings or if a title block hangs on it; those in it at a margin are then borders too.
pub(super) fn leave_out(drawing: &Drawing, walls: &mut Vec<usize>, report: &mut Report) {
    let mut left = walls.clone();
    let mut outer: Option<[DVec2; 2]> = None;
    let (mut is_sheet, mut why) = (false, String::new());
    for _ in 0..BORDERS_MAX {
        let entities: Vec<&Entity> = left.iter().map(|i| &drawing.entities[*i]).collect();
        let Some(border) = Border::find(&entities) else { break };
        if outer.is_some_and(|o| !has_margin(o, border.extent)) {
            break;
        }
        if let Some(words) = title(drawing, &border) {
            (is_sheet, why) = (true, format!("; a title block with {words:?} hangs on it"));
        }
        if outer.is_none() && is_paper(border.extent[1] - border.extent[0]) {
            is_sheet = true;
        }
        outer = Some(border.extent);
        let inside = |i: &usize| !border.takes(*i, entities[*i]);
        left = (0..left.len()).filter(inside).map(|i| left[i]).collect();
    }
    if !is_sheet {
        return;
    }
    let text = format!(
        "{} lines draw the border of a sheet and what hangs on it{why}; left out of the walls, --wall-layer takes them in",
        walls.len() - left.len()
    );
    report.info("sheet-border", Place::file(&drawing.file), text);
    *walls = left;
}

/// A rectangle round everything, and what hangs on it.
pub(super) struct Border {
    extent: [DVec2; 2],
    /// Its entities and those joined to it, by their places in the list.
    entities: BTreeSet<usize>,
    /// Boxes of what hangs together without the border itself.
    pub blocks: Vec<[DVec2; 2]>,
    same: f64,
}

impl Border {
    /// Looks for one round everything.
    pub fn find(entities: &[&Entity]) -> Option<Self> {
        let pieces = pieces(entities.iter().copied());
        let extent = box_of(entities.iter().flat_map(|e| control_points(&e.shape)))?;
        let [lo, hi] = extent;
        let same = SAME_SHARE * (hi - lo).max_element();
        let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
        let is_side = |p: &Piece, k: usize| {
            let side = [corners[k], corners[(k + 1) % 4]];
            let runs = |a: DVec2, b: DVec2| a.distance(side[0]) <= same && b.distance(side[1]) <= same;
            runs(p.a, p.b) || runs(p.b, p.a)
        };
        let sides: Vec<usize> =
            (0..pieces.len()).filter(|i| (0..4).any(|k| is_side(&pieces[*i], k))).collect();
        let is_closed = (0..4).all(|k| sides.iter().any(|i| is_side(&pieces[*i], k)));
        if !is_closed {
            return None;
        }
        let is_free = vec![true; pieces.len()];
        let attached = joined(&pieces, sides.clone(), is_free, same)?;
        let mut free = vec![false; pieces.len()];
        attached.iter().for_each(|i| free[*i] = true);
        sides.iter().for_each(|i| free[*i] = false);
        let mut blocks = Vec::new();
        for i in &attached {
            if free[*i] {
                let block = joined(&pieces, vec![*i], free.clone(), same)?;
                block.iter().for_each(|j| free[*j] = false);
                blocks.extend(box_of(block.iter().flat_map(|j| [pieces[*j].a, pieces[*j].b])));
            }
        }
        let own: BTreeSet<usize> = attached.iter().map(|i| pieces[*i].entity).collect();
        let rest = pieces.iter().filter(|p| !own.contains(&p.entity)).count();
        (rest >= REST_MIN).then_some(Self { extent, entities: own, blocks, same })
    }

    /// Whether an entity belongs to the border, or is drawn in its title block.
    pub fn takes(&self, index: usize, e: &Entity) -> bool {
        let is_in = |b: &[DVec2; 2]| {
            let points = control_points(&e.shape);
            points.iter().all(|p| p.cmpge(b[0] - self.same).all() && p.cmple(b[1] + self.same).all())
        };
        self.entities.contains(&index) || self.blocks.iter().any(is_in)
    }
}

/// The pieces that hang together with some, ascending; `None` for too many. Of those that are not free only the first count.
fn joined(pieces: &[Piece], first: Vec<usize>, mut is_free: Vec<bool>, same: f64) -> Option<Vec<usize>> {
    first.iter().for_each(|i| is_free[*i] = false);
    let (mut out, mut next) = (first.clone(), first);
    while let Some(i) = next.pop() {
        let p = &pieces[i];
        let touches = |q: &Piece| {
            let near = |v: DVec2, s: &Piece| distance_to_segment(v, [s.a, s.b]) <= same;
            near(p.a, q) || near(p.b, q) || near(q.a, p) || near(q.b, p)
        };
        for j in 0..pieces.len() {
            if is_free[j] && touches(&pieces[j]) {
                is_free[j] = false;
                out.push(j);
                next.push(j);
            }
        }
        if out.len() > ATTACHED_MAX {
            return None;
        }
    }
    out.sort_unstable();
    Some(out)
}

/// Whether a rectangle lies in another as the margin does on the paper.
fn has_margin(outer: [DVec2; 2], inner: [DVec2; 2]) -> bool {
    let longer = (outer[1] - outer[0]).max_element();
    let (low, high) = (inner[0] - outer[0], outer[1] - inner[1]);
    let mut margins = [low.x, low.y, high.x, high.y].map(|m| m / longer);
    margins.sort_by(f64::total_cmp);
    let [least, _, third, bound] = margins;
    least > SAME_SHARE && third <= MARGIN_SHARE && third - least <= SHEET_SHARE && bound <= BOUND_SHARE
}

/// Whether a rectangle is a sheet of paper at a scale, in any decimal unit.
fn is_paper(size: DVec2) -> bool {
    let (longer, shorter) = (size.max_element(), size.min_element());
    SHEETS_MM.iter().any(|[l, s]| {
        let scale = longer / l;
        let digits = scale / 10f64.powf(scale.log10().floor());
        let is_scale = SCALES.iter().chain(&[10.0]).any(|k| (digits / k - 1.0).abs() <= SHEET_SHARE);
        is_scale && (shorter / (s * scale) - 1.0).abs() <= SHEET_SHARE
    })
}

/// What a title block that hangs on a border says: a scale, or a word that stands in no room.
fn title(drawing: &Drawing, border: &Border) -> Option<String> {
    let is_in = |p: DVec2| border.blocks.iter().any(|[lo, hi]| p.cmpge(*lo).all() && p.cmple(*hi).all());
    let found = drawing.texts.iter().find(|t| is_in(t.at) && says_scale_or_author(&t.text))?;
    Some(found.text.trim().lines().next().unwrap_or_default().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drawing::{Editable, Shape, SourceRef};

    #[test]
    fn sheets_are_known_by_their_sides() {
        for (size, expected) in [
            ([21_000.0, 14_850.0], true), // A3 at 1:50, millimetres
            ([29.7, 42.0], true),         // A3 at 1:100, metres
            ([84.1, 59.4], true),         // A1 at 1:100
            ([30.0, 20.0], false),
            ([42.0, 30.0], false),
            ([35.64, 25.2], false), // A4 at 1:120
        ] {
            assert_eq!(is_paper(DVec2::from(size)), expected, "{size:?}");
        }
    }

    #[test]
    fn a_margin_is_even_but_where_the_sheet_is_bound() {
        let paper = [DVec2::ZERO, DVec2::new(420.0, 297.0)];
        for (inner, expected) in [
            ([[20.0, 10.0], [410.0, 287.0]], true),
            ([[10.0, 10.0], [410.0, 287.0]], true),
            ([[10.0, 25.0], [410.0, 280.0]], false),
            ([[40.0, 10.0], [410.0, 287.0]], false),
            ([[30.0, 30.0], [390.0, 267.0]], false),
            ([[0.0, 0.0], [420.0, 297.0]], false),
        ] {
            assert_eq!(has_margin(paper, inner.map(DVec2::from)), expected, "{inner:?}");
        }
    }

    fn line(a: [f64; 2], b: [f64; 2]) -> Entity {
        Entity {
            source: SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: "0".into() },
            layer: "0".into(),
            shape: Shape::Line { a: DVec2::from(a), b: DVec2::from(b) },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        }
    }

    /// A3 at 1:100 round `rest` loose lines, with `attached` ticks on its lower side and `inner` margins in it.
    fn sheet(inner: usize, attached: usize, rest: usize) -> Drawing {
        let mut all = Vec::new();
        for k in 0..=inner {
            let m = k as f64;
            let c = [[m, m], [42.0 - m, m], [42.0 - m, 29.7 - m], [m, 29.7 - m]];
            all.extend((0..4).map(|i| line(c[i], c[(i + 1) % 4])));
        }
        let step = |i: usize, n: usize| 0.5 + 41.0 * i as f64 / n as f64;
        all.extend((0..attached).map(|i| line([step(i, attached), 0.0], [step(i, attached), 0.3])));
        all.extend((0..rest).map(|i| line([20.0, 10.0 + 0.5 * i as f64], [22.0, 10.0 + 0.5 * i as f64])));
        Drawing::of(all)
    }

    fn left(drawing: &Drawing) -> usize {
        let mut walls: Vec<usize> = (0..drawing.entities.len()).collect();
        leave_out(drawing, &mut walls, &mut Report::default());
        walls.len()
    }

    #[test]
    fn a_border_has_enough_in_it_and_not_too_much_on_it() {
        assert_eq!(left(&sheet(0, 0, REST_MIN)), REST_MIN);
        assert_eq!(left(&sheet(0, 0, REST_MIN - 1)), REST_MIN + 3, "a building of its own");
        assert_eq!(left(&sheet(0, ATTACHED_MAX - 4, 20)), 20);
        assert_eq!(left(&sheet(0, ATTACHED_MAX - 3, 20)), ATTACHED_MAX + 21);
        assert_eq!(left(&sheet(BORDERS_MAX - 1, 0, 20)), 20);
        assert_eq!(left(&sheet(BORDERS_MAX, 0, 20)), 24, "one more rectangle is no border");
    }
}
