//! Rows of bits, one a cell: unions through tables of four rows, pulls, counts, mirrored matrices.

use super::lanes::{LANES, Lanes, Vector, transpose};

/// Tables that are read at a time, of one cache line a row: 16 KiB.
const TABLES: usize = 16;

/// Cache lines of the next frontiers that are made at a time: 20 KiB.
const NEXT_LANES: usize = 320;

/// For every four rows the unions of all 16 choices of them.
#[inline(always)]
pub(super) fn fill_tables<V: Vector, const K: usize>(rows: &[[Lanes; K]], tables: &mut Vec<Lanes>) {
    tables.resize(rows.len() * 4 * K, Lanes::default());
    let choices: &mut [[[Lanes; K]; 16]] = tables.as_chunks_mut().0.as_chunks_mut().0;
    for (four, table) in rows.as_chunks::<4>().0.iter().zip(choices) {
        for choice in 1..16usize {
            let row = &four[choice.trailing_zeros() as usize];
            for k in 0..K {
                let both = V::load(&table[choice & (choice - 1)][k]).or(V::load(&row[k]));
                both.store(&mut table[choice][k]);
            }
        }
    }
}

/// Buffers of [`push`].
#[derive(Default)]
pub(super) struct PushRoom {
    /// Frontiers of some trees, word by word.
    bits: Vec<u64>,
    next: Vec<Lanes>,
}

/// One level on for some trees: the rows of the frontier, through tables. A few tables and the next frontiers of
/// some trees at a time, so that both stay in the nearest cache.
#[inline(always)]
pub(super) fn push<V: Vector, const K: usize>(
    tables: &[[Lanes; K]],
    trees: &mut [[[Lanes; K]; 2]],
    pushed: &[u32],
    room: &mut PushRoom,
) {
    let (most_trees, tables_each) = (NEXT_LANES / K, (TABLES / K).next_power_of_two().min(16));
    room.next.resize(most_trees * K, Lanes::default());
    room.bits.resize(most_trees * K * 8, 0);
    let next: &mut [[Lanes; K]] = room.next.as_chunks_mut().0;
    for block in pushed.chunks(most_trees) {
        for (i, &tree) in block.iter().enumerate() {
            for w in 0..K * 8 {
                room.bits[w * most_trees + i] = trees[tree as usize][0][w / 8].0[w % 8];
            }
            next[i] = [Lanes::default(); K];
        }
        for (part, tables) in tables.chunks_exact(tables_each * 16).enumerate() {
            let (word, shift) = (part * tables_each / 16, part * tables_each % 16 * 4);
            let bits = &room.bits[word * most_trees..][..block.len()];
            add_rows::<V, K>(tables.as_chunks().0, bits, shift, next);
        }
        for (i, &tree) in block.iter().enumerate() {
            let [frontier, unseen] = &mut trees[tree as usize];
            for k in 0..K {
                V::load(&next[i][k]).and(V::load(&unseen[k])).store(&mut frontier[k]);
            }
        }
    }
}

/// Adds to each of `next` the rows that its bits from `shift` on choose from some tables.
#[inline(always)]
fn add_rows<V: Vector, const K: usize>(
    tables: &[[[Lanes; K]; 16]],
    bits: &[u64],
    shift: usize,
    next: &mut [[Lanes; K]],
) {
    let mine = u64::MAX >> (64 - 4 * tables.len());
    for (&word, next) in bits.iter().zip(next) {
        let mut bits = word >> shift & mine;
        if bits == 0 {
            continue;
        }
        let mut sum = [V::zero(); K];
        for k in 0..K {
            sum[k] = V::load(&next[k]);
        }
        for table in tables {
            let choice = &table[(bits & 15) as usize];
            for k in 0..K {
                sum[k] = sum[k].or(V::load(&choice[k]));
            }
            bits >>= 4;
        }
        for k in 0..K {
            sum[k].store(&mut next[k]);
        }
    }
}

/// Unseen cells beside the frontier, by their own rows.
#[inline(always)]
pub(super) fn pull<V: Vector, const K: usize>(
    rows: &[[Lanes; K]],
    frontier: &[Lanes; K],
    unseen: &[Lanes; K],
) -> [Lanes; K] {
    let mut new = [Lanes::default(); K];
    for k in 0..K {
        for w in 0..8 {
            let mut bits = unseen[k].0[w];
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let row = &rows[k * LANES + w * 64 + bit as usize];
                let mut shared = V::zero();
                for i in 0..K {
                    shared = shared.or(V::load(&row[i]).and(V::load(&frontier[i])));
                }
                new[k].0[w] |= u64::from(!shared.is_zero()) << bit;
            }
        }
    }
    new
}

/// Adds to `member` what can be reached from the cells in `todo`, and takes it off `left`. Over as soon as
/// nothing is left.
#[inline(always)]
pub(super) fn flood(rows: &[Lanes], member: &mut [Lanes], todo: &mut [u64], left: &mut [u64]) {
    let stride = member.len();
    // The next cell is taken from the next word: far from the last one, which sees much the same.
    let mut w = 0;
    let mut empty = 0;
    while empty < todo.len() {
        w = if w + 1 < todo.len() { w + 1 } else { 0 };
        if todo[w] == 0 {
            empty += 1;
            continue;
        }
        empty = 0;
        let cell = w * 64 + todo[w].trailing_zeros() as usize;
        todo[w] &= todo[w] - 1;
        let mut any = 0;
        for (i, row) in rows[cell * stride..][..stride].iter().enumerate() {
            for j in 0..8 {
                let new = row.0[j] & !member[i].0[j];
                member[i].0[j] |= new;
                todo[i * 8 + j] |= new;
                left[i * 8 + j] &= !new;
                any |= left[i * 8 + j];
            }
        }
        if any == 0 {
            return;
        }
    }
}

pub(super) fn set(row: &mut [Lanes], cell: usize) {
    row[cell / LANES].set(cell % LANES);
}

// Plain loops: closures would not be compiled for the caller's instruction set.
#[inline(always)]
pub(super) fn count_bits(row: &[Lanes]) -> u32 {
    let mut sum = 0;
    for lanes in row {
        for word in lanes.0 {
            sum += word.count_ones();
        }
    }
    sum
}

/// Bits of `was` that are bare and not in `now`.
#[inline(always)]
pub(super) fn lost_bits(was: &[Lanes], now: &[Lanes], bare: &[Lanes]) -> u32 {
    let mut sum = 0;
    for ((was, now), bare) in was.iter().zip(now).zip(bare) {
        for w in 0..8 {
            sum += (was.0[w] & bare.0[w] & !now.0[w]).count_ones();
        }
    }
    sum
}

#[inline(always)]
pub(super) fn shared_bits(a: &[Lanes], b: &[Lanes]) -> u32 {
    let mut sum = 0;
    for (a, b) in a.iter().zip(b) {
        for w in 0..8 {
            sum += (a.0[w] & b.0[w]).count_ones();
        }
    }
    sum
}

/// Makes a matrix that holds bits only right of its diagonal symmetric; `words` of a row are in use.
#[inline(always)]
pub(super) fn mirror(rows: &mut [Lanes], stride: usize, words: usize) {
    let mut block = [0u64; 64];
    for r in 0..words {
        for c in r..words {
            let mut any = 0;
            let from = rows[r * 64 * stride..][..64 * stride].chunks_exact(stride);
            for (word, row) in block.iter_mut().zip(from) {
                *word = row[c / 8].0[c % 8];
                any |= *word;
            }
            if any == 0 {
                continue;
            }
            transpose(&mut block);
            let to = rows[c * 64 * stride..][..64 * stride].chunks_exact_mut(stride);
            for (word, row) in block.iter().zip(to) {
                row[r / 8].0[r % 8] |= word;
            }
        }
    }
}
