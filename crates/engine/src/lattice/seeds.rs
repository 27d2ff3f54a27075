//! The region that a flood from seed points reaches, and what to say of seeds that start none.

use super::{Field, Ground, ON_WALL};
use crate::geometry::{PointUm, Segment, Side, segments_touch, side_of_ring};
use enfilade_report::{Error, Place, Report};

impl Field {
    /// Whether a seed lies outside the box round all walls.
    fn has_seed_outside(ground: &Ground<'_>) -> bool {
        let ends = || ground.fixed.iter().chain(ground.movable).flat_map(|w| [w.a, w.b]);
        let is_beyond =
            |seed: &PointUm, k: usize| ends().all(|p| p[k] < seed[k]) || ends().all(|p| p[k] > seed[k]);
        ground.seeds_um.iter().any(|seed| is_beyond(seed, 0) || is_beyond(seed, 1))
    }

    /// What the seeds reach. Seeds that start nowhere are told.
    ///
    /// # Errors
    /// [`Error::Input`] where none starts anywhere, with the reason of each.
    pub(super) fn flood_from_seeds(
        &self,
        ground: &Ground<'_>,
        report: &mut Report,
    ) -> Result<Vec<bool>, Error> {
        let (mut starts, mut bad) = (Vec::new(), Vec::new());
        for (i, seed) in ground.seeds_um.iter().enumerate() {
            match self.start_of(*seed, ground) {
                Ok(cell) => starts.push(cell),
                Err(why) => {
                    let name =
                        ground.seed_names.get(i).map_or_else(|| format!("number {}", i + 1), Clone::clone);
                    bad.push(format!("--seed-point {name} {why}"));
                }
            }
        }
        let place = || Place::file(ground.file);
        if starts.is_empty() {
            let text = format!(
                "{}; nothing was measured; a seed is a point of the floor, beside no wall: move it into the room",
                bad.join("; ")
            );
            return Err(Error::input("seed-on-wall", place(), text));
        }
        for why in bad {
            report.warn(
                "seed-on-wall",
                place(),
                format!("{why}; it is left out, the flood starts from the others"),
            );
        }
        let reached = self.flood(starts.into_iter());
        let border = |c: usize, r: usize| c == 0 || r == 0 || c + 1 == self.cols || r + 1 == self.rows;
        let leaks = (0..self.cols).any(|c| (0..self.rows).any(|r| border(c, r) && reached[self.index(c, r)]));
        if leaks {
            let text = if Self::has_seed_outside(ground) {
                "a seed point lies outside the walls, and the flood from there fills the drawing's box; move --seed-point \
                 into the building or draw EF-QUERY"
            } else {
                "the flood from the seed point fills the drawing's box: it starts outside the building, or leaves it through \
                 a gap; move --seed-point, close the outline or draw EF-QUERY"
            };
            report.warn("seed-leaks", Place::file(ground.file), text);
        }
        Ok(reached)
    }

    /// The cell that a seed starts from: the nearest of the four round it that no wall parts from it, or of all four
    /// ([`Ground::seeds_by_cell`]).
    fn start_of(&self, seed: PointUm, ground: &Ground<'_>) -> Result<(usize, usize), &'static str> {
        let walls = || ground.fixed.iter().chain(ground.movable);
        if walls().any(|w| segments_touch(Segment { a: seed, b: seed }, *w)) {
            return Err("lies on a wall");
        }
        if ground.fixed_solids.iter().any(|ring| side_of_ring(ring, seed) != Side::Outside) {
            return Err("lies inside a wall or a column");
        }
        let low = [0, 1].map(|k| (seed[k] - self.origin_um[k]).div_euclid(self.spacing_um));
        let round = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[dx, dy]| [low[0] + dx, low[1] + dy]);
        let cells = round.into_iter().filter_map(|[c, r]| {
            let (c, r) = (usize::try_from(c).ok()?, usize::try_from(r).ok()?);
            (c < self.cols && r < self.rows).then_some((c, r))
        });
        let distance = |&(c, r): &(usize, usize)| {
            let at = self.centre(c, r);
            [0, 1].map(|k| i128::from(at[k] - seed[k]).pow(2)).iter().sum::<i128>()
        };
        let is_free = |&(c, r): &(usize, usize)| {
            let way = Segment { a: seed, b: self.centre(c, r) };
            let is_parted = || !ground.seeds_by_cell && walls().any(|w| segments_touch(way, *w));
            self.flags[self.index(c, r)] & ON_WALL == 0 && !is_parted()
        };
        let start = cells.filter(is_free).min_by_key(distance);
        start.ok_or("has a wall between itself and every cell beside it, at this spacing")
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice;
    use super::super::tests::{M, ground, ring};
    use super::*;

    #[test]
    fn why_a_flood_fills_the_box_is_told() {
        let walls = ring(&[[0, 0], [9 * M, 0], [9 * M, 5 * M], [0, 5 * M]]);
        let said = |walls: &[Segment], seed: PointUm| {
            let (mut report, seeds_um) = (Report::default(), [seed]);
            let _ = lattice(&Ground { seeds_um: &seeds_um, ..ground(walls) }, &mut report);
            report.problems.iter().map(ToString::to_string).collect::<String>()
        };
        assert_eq!(said(&walls, [4 * M, 2 * M]), "");
        assert!(said(&walls, [20 * M, 2 * M]).contains("lies outside the walls"));
        assert!(said(&walls, [-M, 2 * M]).contains("lies outside the walls"));
        assert!(said(&walls[..3], [4 * M, 2 * M]).contains("leaves it through a gap"));
    }

    /// A seed on a wall, in one, or hemmed in is named with the reason; others go on without it.
    #[test]
    fn seeds_that_start_nowhere_are_named() {
        let mut walls = ring(&[[0, 0], [9 * M, 0], [9 * M, 5 * M], [0, 5 * M]]);
        walls.push(Segment { a: [4 * M, 0], b: [4 * M, 5 * M] });
        let solids = [vec![[6 * M, M], [7 * M, M], [7 * M, 2 * M], [6 * M, 2 * M]]];
        let found = |seeds: &[PointUm]| {
            let mut report = Report::default();
            let names: Vec<String> = seeds.iter().map(|s| format!("{},{}", s[0] / M, s[1] / M)).collect();
            let ground =
                Ground { seeds_um: seeds, seed_names: &names, fixed_solids: &solids, ..ground(&walls) };
            let cells = lattice(&ground, &mut report).map(|l| l.cells.len());
            let said = report.problems.iter().map(ToString::to_string).collect::<String>();
            (cells.map_err(|e| e.to_string()), said)
        };
        assert_eq!(found(&[[M, M]]), (Ok(20), String::new()));
        let refused = found(&[[4 * M, 2 * M]]).0.unwrap_err();
        assert!(refused.contains("--seed-point 4,2 lies on a wall; nothing was measured"), "{refused}");
        let refused = found(&[[6 * M + 1, M + 1], [0, 0]]).0.unwrap_err();
        assert!(
            refused.contains("--seed-point 6,1 lies inside a wall or a column; --seed-point 0,0 lies on"),
            "{refused}"
        );
        let (cells, said) = found(&[[M, M], [4 * M, 2 * M]]);
        assert_eq!(cells, Ok(20));
        assert!(said.contains("--seed-point 4,2 lies on a wall; it is left out"), "{said}");
        // Nearer to a cell beyond the wall than to its own side's.
        assert_eq!(found(&[[4 * M - M / 1000, 2 * M]]).0, Ok(20));
    }
}
