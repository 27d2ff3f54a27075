//! The bytes of a part: whole numbers seven bits a byte, the lowest first, and values as they are, the lowest byte first.

use crate::measure::known::Print;
use enfilade_engine::walked::{Part, Rows};

/// What the bytes of a part start with.
const HEAD: &[u8] = b"enfilade.part/1\n";

/// What a part has of one lattice.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scene {
    pub print: Print,
    pub vertices: usize,
    pub part: Part,
}

pub(super) fn written(scenes: &[Scene]) -> Vec<u8> {
    let mut out = HEAD.to_vec();
    put(&mut out, scenes.len() as u64);
    for scene in scenes {
        out.extend(scene.print);
        put(&mut out, scene.vertices as u64);
        let part = &scene.part;
        put_rows(&mut out, &part.trees, |out, levels| {
            put(out, levels.len() as u64);
            levels.iter().for_each(|n| put(out, u64::from(*n)));
        });
        put_rows(&mut out, &part.metric, |out, row| put_values(out, row));
        put_rows(&mut out, &part.angular, |out, row| put_values(out, row));
        put_rows(&mut out, &part.isovists, |out, row| put_values(out, row));
        put(&mut out, part.through.len() as u64);
        part.through.iter().for_each(|n| put(&mut out, *n));
    }
    out
}

/// Nothing where they are no part, or not a whole one.
pub(super) fn read(bytes: &[u8]) -> Option<Vec<Scene>> {
    let mut left = bytes.strip_prefix(HEAD)?;
    let from = &mut left;
    let count = take(from)?;
    let scenes: Option<Vec<Scene>> = (0..count).map(|_| scene(from)).collect();
    scenes.filter(|_| from.is_empty())
}

fn scene(from: &mut &[u8]) -> Option<Scene> {
    let print = *from.split_off(..32)?.first_chunk()?;
    let vertices = u32::try_from(take(from)?).ok()? as usize;
    let number = |from: &mut &[u8]| u32::try_from(take(from)?).ok();
    let trees = rows(from, |from| {
        let depth = take(from)?;
        (0..depth).map(|_| number(from)).collect()
    })?;
    let (metric, angular, isovists) = (rows(from, values)?, rows(from, values)?, rows(from, values)?);
    let counts = take(from)?;
    let through: Option<Vec<u64>> = (0..counts).map(|_| take(from)).collect();
    Some(Scene { print, vertices, part: Part { trees, metric, angular, isovists, through: through? } })
}

fn put(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn take(from: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = *from.split_off_first()?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(number);
        }
    }
    None
}

fn put_values(out: &mut Vec<u8>, row: &[f64]) {
    row.iter().for_each(|value| out.extend(value.to_le_bytes()));
}

fn values<const K: usize>(from: &mut &[u8]) -> Option<[f64; K]> {
    let mut row = [0.0; K];
    for value in &mut row {
        *value = f64::from_le_bytes(*from.split_off(..8)?.first_chunk()?);
    }
    Some(row)
}

/// Vertices ascend: each is written as how far it is beyond the one before.
fn put_rows<T>(out: &mut Vec<u8>, rows: &Rows<T>, each: impl Fn(&mut Vec<u8>, &T)) {
    put(out, rows.len() as u64);
    let mut before = 0;
    for (v, row) in rows {
        put(out, u64::from(*v - before));
        before = *v;
        each(out, row);
    }
}

fn rows<T>(from: &mut &[u8], each: impl Fn(&mut &[u8]) -> Option<T>) -> Option<Rows<T>> {
    let count = take(from)?;
    let mut before = 0u32;
    let row = |_| {
        before = before.checked_add(u32::try_from(take(from)?).ok()?)?;
        Some((before, each(from)?))
    };
    (0..count).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_read_as_it_was_written_or_not_at_all() {
        let part = Part {
            trees: vec![(0, vec![]), (3, vec![1, 200, 70_000]), (9, vec![u32::MAX])],
            metric: vec![(2, [-0.0, f64::NAN, 1e-300, 0.1])],
            angular: vec![(7, [-1.0, 1.0, 2.5])],
            isovists: vec![(1, [0.5; 8]), (300, [1.0; 8])],
            through: vec![0, u64::MAX, 5],
        };
        let scenes = [
            Scene { print: [7; 32], vertices: 301, part },
            Scene { print: [8; 32], vertices: 0, part: Part::default() },
        ];
        let bytes = written(&scenes);
        let again = read(&bytes).unwrap();
        assert_eq!(written(&again), bytes);
        assert_eq!((again[0].part.trees.clone(), again.len()), (scenes[0].part.trees.clone(), 2));
        for end in 0..bytes.len() {
            assert!(read(&bytes[..end]).is_none(), "{end}");
        }
        assert!(read(&[&bytes[..], &[0]].concat()).is_none());
        let mut huge = HEAD.to_vec();
        put(&mut huge, u64::MAX);
        assert!(read(&huge).is_none());
    }
}
