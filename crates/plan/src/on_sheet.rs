//! What is drawn and written at a place of a sheet.

use std::ops::RangeInclusive;

use glam::DVec2;

use super::axes::swing::LEAF_M;
use super::by_place::{ByPlace, Entities, area, gap, is_in, wider};
use super::parallels::{Piece, pieces};
use super::view_names::{Title, is_of_elevations, is_of_title_block, title_of};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Shape, Text};
use enfilade_cad::names::base_name;
use enfilade_cad::plane::{box_of, distance_to_segment};
use enfilade_cad::roles::{Role, role_by_name};

/// Titles are looked for this far around a drawing, metres.
const TITLE_M: f64 = 4.0;

/// Legends, key plans and title blocks are smaller than this share of the largest drawing.
const BESIDE_SHARE: f64 = 0.4;

/// Lines that end nearer to others than this are closed, metres.
const SAME_M: f64 = 0.01;

/// A sheet by place. All boxes in drawing units.
pub struct OnSheet<'d> {
    drawing: &'d Drawing,
    pub metres_per_unit: f64,
    entities: Entities<'d>,
    texts: ByPlace,
    /// What each text says as a title.
    titles: Vec<Option<Title>>,
    /// Texts that say how high floors lie, by their numbers.
    heights: Vec<usize>,
    /// Straight pieces of walls.
    lines: Vec<Piece>,
    line_places: ByPlace,
    /// Layers of the entities that draw them.
    layers: Vec<&'d str>,
}

impl<'d> OnSheet<'d> {
    pub fn new(drawing: &'d Drawing, walls: &[&'d Entity], metres_per_unit: f64) -> Self {
        let lines = pieces(walls.iter().copied());
        let mut titles: Vec<Option<Title>> = drawing.texts.iter().map(|t| title_of(&t.text)).collect();
        let heights = heights(&drawing.texts, &titles, metres_per_unit);
        heights.iter().for_each(|t| titles[*t] = Some(Title::NoPlan));
        Self {
            drawing,
            metres_per_unit,
            entities: Entities::new(drawing.entities.iter()),
            texts: ByPlace::new(drawing.texts.iter().map(|t| [t.at, t.at]).collect()),
            titles,
            heights,
            layers: walls.iter().map(|w| base_name(&w.layer)).collect(),
            line_places: ByPlace::new(lines.iter().map(|p| [p.a.min(p.b), p.a.max(p.b)]).collect()),
            lines,
        }
    }

    /// How far round a drawing its title stands, drawing units.
    fn reach(&self) -> f64 {
        TITLE_M / self.metres_per_unit
    }

    /// The texts in a box or beside it, by their numbers.
    fn texts_by(&self, extent: &[DVec2; 2]) -> impl Iterator<Item = (usize, &'d Text)> {
        let reach = self.reach();
        // A little more, for what is lost in rounding.
        let near = self.texts.touching(&wider(extent, 1.01 * reach));
        let near = near.into_iter().map(|t| (t, &self.drawing.texts[t]));
        let extent = *extent;
        near.filter(move |(_, t)| gap(&extent, &[t.at, t.at]) <= reach)
    }

    /// Whether a title stands in a drawing's box or beside it.
    pub fn has_title_by(&self, extent: &[DVec2; 2]) -> bool {
        self.texts_by(extent).any(|(t, _)| self.titles[t].is_some())
    }

    /// Whether it is said in a box or beside it that something there is no plan.
    pub fn says_no_plan_by(&self, extent: &[DVec2; 2]) -> bool {
        let is_no_plan = |t: usize| matches!(self.titles[t], Some(Title::NoPlan | Title::Beside));
        self.texts_by(extent).any(|(t, text)| is_no_plan(t) || is_of_title_block(&text.text))
    }

    /// The title of every drawing, if one stands in it or beside it: the nearest pairs first, each title for one drawing.
    pub fn titles(&self, boxes: &[[DVec2; 2]]) -> Vec<Option<(Title, String)>> {
        let boxes: Vec<[DVec2; 2]> = boxes.iter().map(|b| self.entities.tight(b)).collect();
        let largest = boxes.iter().map(area).fold(0.0, f64::max);
        let is_small = |b: usize| area(&boxes[b]) < BESIDE_SHARE * largest;
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        for (b, extent) in boxes.iter().enumerate() {
            let titled = self
                .texts_by(extent)
                .filter(|(t, _)| self.titles[*t].is_some_and(|title| title != Title::Beside || is_small(b)));
            near.extend(titled.map(|(t, text)| (gap(extent, &[text.at, text.at]), b, t)));
        }
        // Where two drawings are as near, it stands under one of them.
        let texts = &self.drawing.texts;
        let is_over = |b: usize, t: usize| texts[t].at.y > boxes[b][0].midpoint(boxes[b][1]).y;
        near.sort_by(|p, q| p.0.total_cmp(&q.0).then(is_over(p.1, p.2).cmp(&is_over(q.1, q.2))));
        let mut out = vec![None; boxes.len()];
        let mut is_taken = vec![false; texts.len()];
        // What tells of heights says more of the drawing it stands by than any name.
        for &t in &self.heights {
            let by = near.iter().find(|n| n.2 == t).map(|n| n.1);
            by.into_iter().for_each(|b| out[b] = Some((Title::NoPlan, first_line(&texts[t]))));
            is_taken[t] = true;
        }
        for (_, b, t) in near {
            if out[b].is_none() && !is_taken[t] {
                is_taken[t] = true;
                out[b] = self.titles[t].map(|kind| (kind, first_line(&texts[t])));
            }
        }
        for b in (0..boxes.len()).filter(|b| is_small(*b)) {
            if out[b].is_none() {
                out[b] = self.title_block(&boxes[b]).map(|words| (Title::Beside, words));
            }
        }
        out
    }

    /// The layer on which most of the walls in a box are drawn, where it is named after elevations.
    pub fn elevation(&self, extent: &[DVec2; 2]) -> Option<&'d str> {
        let is_in = is_in(extent);
        let inside = self.line_places.touching(extent).into_iter().map(|i| &self.lines[i]);
        let inside: Vec<&str> =
            inside.filter(|p| is_in(&p.a) && is_in(&p.b)).map(|p| self.layers[p.entity]).collect();
        let layer = *inside.iter().find(|l| is_of_elevations(l))?;
        (2 * inside.iter().filter(|l| is_of_elevations(l)).count() > inside.len()).then_some(layer)
    }

    /// What stands in a box that only the title of a whole sheet says.
    pub fn title_block(&self, extent: &[DVec2; 2]) -> Option<String> {
        let texts = self.texts.touching(extent).into_iter().map(|t| &self.drawing.texts[t]);
        texts.into_iter().find(|t| is_of_title_block(&t.text)).map(first_line)
    }

    /// Whether all lines of walls in a box at least `size_m` wide end at others, and none is a door there.
    pub fn is_closed(&self, extent: &[DVec2; 2], size_m: f64) -> bool {
        let tight = self.entities.tight(extent);
        if ((tight[1] - tight[0]) * self.metres_per_unit).min_element() < size_m {
            return false;
        }
        let is_in = is_in(extent);
        let inside = self.line_places.touching(extent).into_iter();
        let is_own = |i: usize| is_in(&self.lines[i].a) && is_in(&self.lines[i].b);
        let same = SAME_M / self.metres_per_unit;
        let ends_at = |i: usize, p: DVec2| {
            let others = self.line_places.touching(&wider(&[p, p], 2.0 * same));
            let mut others = others.into_iter().filter(|j| *j != i && is_own(*j)).map(|j| self.lines[j]);
            others.any(|q| distance_to_segment(p, [q.a, q.b]) <= same)
        };
        inside.filter(|i| is_own(*i)).all(|i| ends_at(i, self.lines[i].a) && ends_at(i, self.lines[i].b))
            && !self.inside(extent).any(|e| self.swings(e) || is_named_door(e))
    }

    /// How many swings of doors are drawn in a box.
    pub fn swings_in(&self, extent: &[DVec2; 2]) -> usize {
        self.inside(extent).filter(|e| self.swings(e)).count()
    }

    fn inside(&self, extent: &[DVec2; 2]) -> impl Iterator<Item = &'d Entity> {
        let is_in = is_in(extent);
        self.entities.touching(extent).filter(move |e| is_in(&middle(&e.shape)))
    }

    fn swings(&self, e: &Entity) -> bool {
        matches!(e.shape, Shape::Arc { radius, .. } if LEAF_M.contains(&(radius * self.metres_per_unit)))
    }
}

fn is_named_door(e: &Entity) -> bool {
    let mut named = e.blocks.iter().map(String::as_str).chain([e.layer.as_str()]);
    named.any(|n| role_by_name(n).0 == Role::Door)
}

/// Names of floors that stand over one another in a column, as far apart as floors do: beside sections and elevations they
/// say how high each lies. By the numbers of the texts.
fn heights(texts: &[Text], titles: &[Option<Title>], metres_per_unit: f64) -> Vec<usize> {
    let names_floor = |t: &usize| {
        matches!(titles[*t], Some(Title::Plan | Title::GroundFloor | Title::Outside | Title::Services))
    };
    let named: Vec<usize> = (0..texts.len()).filter(names_floor).collect();
    let at = |t: usize| texts[t].at * metres_per_unit;
    let is_next = |a: usize, b: usize| {
        let by = at(b) - at(a);
        by.x.abs() <= COLUMN_M && STOREY_M.contains(&by.y)
    };
    let above = |t: usize| named.iter().copied().find(|n| is_next(t, *n));
    let mut out = Vec::new();
    for &lowest in &named {
        let column: Vec<usize> = std::iter::successors(Some(lowest), |t| above(*t)).collect();
        if column.len() >= FLOORS_MIN {
            out.extend(column);
        }
    }
    // The ground is named a little aside.
    let is_by = |t: &usize| out.iter().any(|o| at(*o).distance(at(*t)) <= ASIDE_M);
    let mut all: Vec<usize> = named.iter().copied().filter(is_by).collect();
    all.sort_unstable();
    all
}

/// Names in a column start no farther from one another, metres.
const COLUMN_M: f64 = 0.5;
/// Heights of storeys, metres: plans that stand over one another on a sheet are farther apart.
const STOREY_M: RangeInclusive<f64> = 2.2..=4.5;
/// What stands so near to a column of names is one of them, metres.
const ASIDE_M: f64 = 3.0;
/// Two names may be those of two small plans.
const FLOORS_MIN: usize = 3;

/// The middle of a shape's box.
pub fn middle(shape: &Shape) -> DVec2 {
    box_of(control_points(shape).into_iter()).map_or(DVec2::ZERO, |b| (b[0] + b[1]) / 2.0)
}

fn first_line(text: &Text) -> String {
    text.text.trim().lines().next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_cad::drawing::SourceRef;

    /// Two plans one above the other, each with its title below it: the lower one lies nearer to the title of the upper.
    #[test]
    fn a_title_is_that_of_one_drawing() {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "TEXT".into(), layer: "0".into() };
        let text = |words: &str, y: f64| Text {
            source: source.clone(),
            layer: "0".into(),
            at: DVec2::new(4.0, y),
            text: words.into(),
        };
        let boxes = [[0.0, 9.0], [12.0, 21.0]].map(|[lo, hi]| [DVec2::new(0.0, lo), DVec2::new(14.0, hi)]);
        let named = |texts: &[(&str, f64)]| {
            let texts = texts.iter().map(|(words, y)| text(words, *y)).collect();
            let drawing = Drawing { texts, ..Drawing::of(Vec::new()) };
            OnSheet::new(&drawing, &[], 1.0)
                .titles(&boxes)
                .into_iter()
                .map(|t| t.map_or(String::new(), |t| t.1))
                .collect::<Vec<_>>()
        };
        let both = named(&[("GROUND FLOOR", -2.5), ("UPPER FLOOR", 11.0)]);
        assert_eq!(both, ["GROUND FLOOR", "UPPER FLOOR"]);
        assert_eq!(named(&[("UPPER FLOOR", 11.0)]), ["", "UPPER FLOOR"]);
        assert_eq!(named(&[("GROUND FLOOR", -2.5), ("UPPER FLOOR", 10.5)]), both, "as near to both");
    }

    /// Floors named over one another, as high as floors are, say that a section stands there; two of them, or plans one above
    /// the other, do not.
    #[test]
    fn names_of_heights_stand_by_a_section() {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "TEXT".into(), layer: "0".into() };
        let names = ["GROUND FLOOR LEVEL", "FIRST FLOOR LEVEL", "ROOF LEVEL"];
        let says = |count: usize, step: f64| {
            let text = |(i, words): (usize, &&str)| Text {
                source: source.clone(),
                layer: "0".into(),
                at: DVec2::new(0.1 * i as f64, step * i as f64),
                text: (*words).into(),
            };
            let texts = names.iter().take(count).enumerate().map(text).collect();
            let drawing = Drawing { texts, ..Drawing::of(Vec::new()) };
            OnSheet::new(&drawing, &[], 1.0).says_no_plan_by(&[DVec2::ZERO, DVec2::new(12.0, 9.0)])
        };
        assert!(says(3, 2.6));
        assert!(!says(2, 2.6));
        assert!(!says(3, 12.0));
    }
}
