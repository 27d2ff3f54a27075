//! Doors that another element closes: a lining, a second leaf of the wall without an opening of its own.

use glam::DVec2;

use super::{Closing, ElementCut, Product, Reader, Why};
use crate::region::{Region, Rule};
use enfilade_report::Report;

/// What stands so near before a door, metres, leaves no way round it.
const BEFORE_M: f64 = 0.15;

/// Classes that stop sight unless somebody says otherwise.
const STOPS_SIGHT: [&str; 2] = ["IfcWall", "IfcColumn"];

/// What reaches so little of that into it does so by rounding.
const THIN_SHARE: f64 = 0.01;

/// Share of a door's width from which on what stands before it closes it: beside a narrower thing somebody sees through.
const COVERED_MIN: f64 = 0.8;

/// A door in its wall: where it is, which way the wall runs, and how far it reaches across.
struct Doorway<'a> {
    region: &'a Region,
    along: DVec2,
}

impl Doorway<'_> {
    /// None where nothing tells how the wall runs.
    fn of<'a>(closing: &'a Closing<'_>, wall: &Region) -> Option<Doorway<'a>> {
        let long = long_side(&wall.clone().combine(&closing.region, Rule::Union))?;
        let corners = closing.region.box_along()?;
        let sides = [corners[1] - corners[0], corners[3] - corners[0]].map(DVec2::try_normalize);
        let along = sides.into_iter().flatten().max_by(|a, b| turn(*a, long).total_cmp(&turn(*b, long)))?;
        Some(Doorway { region: &closing.region, along })
    }

    /// Least and greatest of what a region has in a direction.
    fn reach(region: &Region, way: DVec2) -> [f64; 2] {
        let all = region.points().map(|p| p.dot(way));
        all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    }

    /// The share of its width that a region covers at most just before either face, `near` file units deep.
    fn share_covered(&self, by: &Region, near: f64) -> f64 {
        let across = self.along.perp();
        let ([from, to], [low, high]) =
            (Self::reach(self.region, self.along), Self::reach(self.region, across));
        let covered = [[low - near, low], [high, high + near]].map(|[below, above]| {
            let corners = [[from, below], [to, below], [to, above], [from, above]];
            let strip = Region::ring(corners.map(|[s, t]| (self.along * s + across * t).to_array()).to_vec());
            let inside = by.clone().combine(&strip, Rule::Intersection);
            let thick = thickness(&inside, across);
            if thick > near * THIN_SHARE { inside.area() / thick } else { 0.0 }
        });
        covered.into_iter().fold(0.0, f64::max) / (to - from).max(f64::MIN_POSITIVE)
    }
}

/// How far a region reaches in a direction.
fn thickness(region: &Region, way: DVec2) -> f64 {
    let [low, high] = Doorway::reach(region, way);
    high - low
}

/// How nearly two directions are one, whichever way they point.
fn turn(a: DVec2, b: DVec2) -> f64 {
    a.dot(b).abs()
}

/// The direction of the longer side of the box round a region.
fn long_side(region: &Region) -> Option<DVec2> {
    let corners = region.box_along()?;
    let [a, b] = [corners[1] - corners[0], corners[3] - corners[0]];
    (if a.length() >= b.length() { a } else { b }).try_normalize()
}

impl<'b> Reader<'b, '_, '_> {
    /// Says which doors something stands before that closes them for sight.
    pub(super) fn state_covered(
        &self,
        shown: &[&'b Product],
        cuts: &[Result<ElementCut<'b>, Why>],
        report: &mut Report,
    ) {
        let near = BEFORE_M / self.b.geo.metres;
        let all: Vec<(&Product, &ElementCut<'b>, [DVec2; 2])> = shown
            .iter()
            .zip(cuts)
            .filter(|(p, _)| STOPS_SIGHT.iter().any(|class| p.class.starts_with(class)))
            .filter_map(|(p, cut)| {
                let cut = cut.as_ref().ok()?;
                Some((*p, cut, cut.region.extent()?))
            })
            .collect();
        for (wall, cut, _) in &all {
            for door in cut.closings.iter().filter(|c| c.of.class == "IfcDoor") {
                let (Some([low, high]), Some(doorway)) =
                    (door.region.extent(), Doorway::of(door, &cut.region))
                else {
                    continue;
                };
                let is_near =
                    |[from, to]: [DVec2; 2]| from.cmple(high + near).all() && to.cmpge(low - near).all();
                let mut others =
                    all.iter().filter(|(other, _, extent)| other.id != wall.id && is_near(*extent));
                let covers = |(_, other, _): &&(&Product, &ElementCut<'b>, [DVec2; 2])| {
                    doorway.share_covered(&other.region, near) >= COVERED_MIN
                };
                if let Some((other, ..)) = others.find(covers) {
                    let text = format!(
                        "found {} before door {} of {}, expected an opening in it too; nobody sees through that door",
                        called(other),
                        called(door.of),
                        called(wall)
                    );
                    report.warn("ifc-door-covered", self.b.place(door.of), text);
                }
            }
        }
    }
}

/// An element as messages name it: by its name, else by its number.
fn called(p: &Product) -> String {
    if p.name.trim().is_empty() { format!("#{}", p.id) } else { format!("\"{}\"", p.name.trim()) }
}
