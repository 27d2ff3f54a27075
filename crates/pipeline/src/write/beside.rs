//! The side-car of an option: what says how its file is read, and over which floor it was measured. With it `analyse` of the
//! file repeats what the round claims, to the last digit.

use std::collections::{BTreeMap, BTreeSet};

use crate::accept::unit_words;
use crate::job::Job;
use crate::measure::study::Study;
use crate::read::storey::key_read;
use crate::write::made::Made;
use crate::write::show::lattice_centre;
use enfilade_config::{Partial, RegionTable, SETTINGS_VERSION};
use enfilade_engine::Lattice;
use enfilade_report::{Error, OutFile, Place};

/// A corner of cells: the lower left one of the cell of that number.
type Corner = [i32; 2];

/// The side-cars of options, beside their files.
///
/// # Errors
/// Where a table cannot be written, which no reading can lead to.
pub(crate) fn side_cars(
    Job { input, settings }: Job<'_>,
    study: &Study,
    made: &[&Made],
) -> Result<Vec<OutFile>, Error> {
    let of_storey = key_read(input, settings);
    let [moved, built] = [false, true].map(|is_built| floors(study, is_built));
    let side_car = |m: &&Made| {
        let regions = if m.built.is_some() { &built } else { &moved };
        let tables = m.built.iter().flat_map(|b| b.tables.iter().cloned());
        let said = Partial {
            version: Some(SETTINGS_VERSION),
            unit: Some(unit_words(study.base.plan.unit.unit)),
            wall_layer: some(&settings.wall_layers),
            query_layer: settings.query_layer.clone(),
            reference_layer: settings.reference_layer.clone(),
            view: settings.view.clone(),
            level: Some(settings.level),
            spacing: Some(study.spacing_m),
            lattice_centre: Some(lattice_centre(study)),
            storey: settings.storey.clone(),
            over_stairs: settings.over_stairs.then_some(true),
            of_storey: of_storey.clone(),
            query: settings.query.clone(),
            accept_missing_eof: Some(settings.accept_missing_eof),
            reading: settings.reading.clone(),
            brief: settings.brief_text(),
            regions: settings.regions.iter().chain(regions).cloned().collect(),
            works: settings.works.iter().cloned().chain(tables).collect(),
            ..Partial::default()
        };
        let failed = |e: toml::ser::Error| {
            Error::usage("side-car", Place::default(), format!("{e}; nothing was written"))
        };
        let mut table = toml::Table::try_from(said).map_err(failed)?;
        table.retain(|_, value| value.as_array().is_none_or(|list| !list.is_empty()));
        let text = format!(
            "# Written by `enfilade run`: how this option is read, and the floor over which it was measured.\n{}",
            toml::to_string(&table).map_err(failed)?
        );
        Ok(OutFile::new(format!("{}.enfilade.toml", m.name), text))
    };
    made.iter().map(side_car).collect()
}

fn some(list: &[String]) -> Option<Vec<String>> {
    (!list.is_empty()).then(|| list.to_vec())
}

/// The measured floor as regions, where no region says where people are or what they see. Where walls are cut, nobody is
/// measured who stands in a wall of the present layout.
fn floors(study: &Study, is_built: bool) -> Vec<RegionTable> {
    let (markers, lattice) = (&study.base.plan.markers, &study.lattice);
    let is_query = |i: &usize| lattice.query.binary_search(&(*i as u32)).is_ok();
    let blind: BTreeSet<u32> =
        if is_built { study.initial_obstacles().blind.into_iter().collect() } else { BTreeSet::new() };
    let all = (0..lattice.cells.len()).filter(|i| !blind.contains(&(*i as u32)));
    let cells = |which: Vec<usize>| which.into_iter().map(|i| lattice.cells[i]).collect::<BTreeSet<_>>();
    let mut out = Vec::new();
    if markers.query.is_empty() {
        out.extend(tables(study, "query", &cells(all.clone().filter(is_query).collect())));
    }
    if markers.reference.is_empty() {
        out.extend(tables(study, "reference", &cells(all.filter(|i| lattice.is_reference[*i]).collect())));
    }
    out
}

fn tables(study: &Study, kind: &str, cells: &BTreeSet<Corner>) -> Vec<RegionTable> {
    let place = |c: &Corner| study.base.plan.frame.file_from_um(corner_um(&study.lattice, *c)).to_array();
    let table = |ring: Vec<Corner>| RegionTable {
        kind: kind.into(),
        pair: None,
        points: ring.iter().map(place).collect(),
    };
    outlines(cells).into_iter().map(table).collect()
}

/// Where a corner of cells lies, drawing frame: half a cell from the centres, so that rounding takes none in or out.
fn corner_um(lattice: &Lattice, corner: Corner) -> [i64; 2] {
    let at = |k: usize| {
        lattice.origin_um[k] + i64::from(corner[k]) * lattice.spacing_um - lattice.spacing_um.div_euclid(2)
    };
    [at(0), at(1)]
}

/// The outlines of a set of cells, each one ring: a hole is reached by a cut that leads there and back on the same way.
fn outlines(cells: &BTreeSet<Corner>) -> Vec<Vec<Corner>> {
    let (mut outer, holes): (Vec<_>, Vec<_>) = rings(cells).into_iter().partition(|r| doubled_area(r) > 0);
    for hole in holes {
        let at = hole[0];
        let holders = (0..outer.len()).filter(|i| is_round(&outer[*i], at));
        let Some(holder) = holders.min_by_key(|i| doubled_area(&outer[*i])) else { continue };
        let ring = &mut outer[holder];
        // Along the borders of cells: on a slanting cut could lie somebody who is not meant.
        let start = ring[0];
        let corner = [start[0], at[1]];
        ring.extend([start, corner]);
        ring.extend(hole);
        ring.extend([at, corner, start]);
    }
    outer
}

/// The borders of a set of cells, cells on the left: outlines counter-clockwise, holes clockwise.
fn rings(cells: &BTreeSet<Corner>) -> Vec<Vec<Corner>> {
    let mut next: BTreeMap<Corner, Vec<Corner>> = BTreeMap::new();
    for &[i, j] in cells {
        let sides = [
            ([i, j - 1], [i, j], [i + 1, j]),
            ([i + 1, j], [i + 1, j], [i + 1, j + 1]),
            ([i, j + 1], [i + 1, j + 1], [i, j + 1]),
            ([i - 1, j], [i, j + 1], [i, j]),
        ];
        for (_, from, to) in sides.into_iter().filter(|(beside, _, _)| !cells.contains(beside)) {
            next.entry(from).or_default().push(to);
        }
    }
    let mut out = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let (mut ring, mut at) = (vec![start], start);
        while let Some(to) = step(&mut next, at).filter(|to| *to != start) {
            ring.push(to);
            at = to;
        }
        out.push(straight(&ring));
    }
    out
}

/// Takes a side that begins at a corner; `None` where none is left.
fn step(next: &mut BTreeMap<Corner, Vec<Corner>>, at: Corner) -> Option<Corner> {
    let sides = next.get_mut(&at)?;
    let to = sides.pop();
    if sides.is_empty() {
        next.remove(&at);
    }
    to
}

/// A ring without the corners at which it goes straight on.
fn straight(ring: &[Corner]) -> Vec<Corner> {
    let n = ring.len();
    let turns = |i: &usize| {
        let [a, b, c] = [ring[(i + n - 1) % n], ring[*i], ring[(i + 1) % n]];
        (b[0] - a[0]) * (c[1] - b[1]) != (b[1] - a[1]) * (c[0] - b[0])
    };
    (0..n).filter(turns).map(|i| ring[i]).collect()
}

fn doubled_area(ring: &[Corner]) -> i64 {
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    sides.map(|(a, b)| i64::from(a[0]) * i64::from(b[1]) - i64::from(b[0]) * i64::from(a[1])).sum()
}

/// Whether a ring goes round the cell outside of which a hole has this corner, or touches it there.
fn is_round(ring: &[Corner], at: Corner) -> bool {
    // A hole's corner lies on no side of the ring unless the two touch: just beside it is clear.
    let (x, y) = (f64::from(at[0]) + 0.25, f64::from(at[1]) + 0.5);
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed = sides.filter(|(a, b)| {
        let (lo, hi) = (f64::from(a[1].min(b[1])), f64::from(a[1].max(b[1])));
        a[0] == b[0] && lo < y && y < hi && f64::from(a[0]) > x
    });
    crossed.count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether a cell's centre lies within a ring, even-odd, as regions are read.
    fn holds(ring: &[Corner], [i, j]: Corner) -> bool {
        is_round(ring, [i, j])
    }

    proptest! {
        /// Every cell lies within exactly one outline, and no other does.
        #[test]
        fn outlines_hold_the_cells_and_no_others(cells in proptest::collection::btree_set((0..7_i32, 0..7_i32), 1..45)) {
            let cells: BTreeSet<Corner> = cells.into_iter().map(|(i, j)| [i, j]).collect();
            let outlines = outlines(&cells);
            // Nobody stands on a line along the borders of cells.
            let sides = outlines.iter().flat_map(|r| r.iter().zip(r.iter().cycle().skip(1)));
            let is_straight = |(a, b): (&Corner, &Corner)| a[0] == b[0] || a[1] == b[1];
            prop_assert!(sides.clone().all(is_straight), "{:?}", outlines);
            for i in -1..8 {
                for j in -1..8 {
                    let held = outlines.iter().filter(|r| holds(r, [i, j])).count();
                    prop_assert_eq!(held % 2, usize::from(cells.contains(&[i, j])), "{} {} {:?}", i, j, outlines);
                    prop_assert!(held <= 1, "{} {} {:?}", i, j, outlines);
                }
            }
        }
    }
}
