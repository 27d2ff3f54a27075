//! Rows of bits, one a cell: unions through tables of four rows, pulls, counts, mirrored matrices.

use super::lanes::{LANES, Lanes, Vector, transpose};

/// Tables of 32 cells: 16 KiB at two cache lines a row.
const HALF_WORD_TABLES: usize = 8;

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

/// One level on for some trees: the rows of the frontier, through tables that stay in the nearest cache
/// while all trees read them.
#[inline(always)]
pub(super) fn push<V: Vector, const K: usize>(
    tables: &[[Lanes; K]],
    trees: &mut [[[Lanes; K]; 3]],
    pushed: &[u32],
) {
    for &tree in pushed {
        trees[tree as usize][2] = [Lanes::default(); K];
    }
    for (half, tables) in tables.chunks_exact(HALF_WORD_TABLES * 16).enumerate() {
        let tables = tables.as_chunks::<16>().0;
        for &tree in pushed {
            let [frontier, _, next] = &mut trees[tree as usize];
            let mut bits = (frontier[half / 16].0[half / 2 % 8] >> (32 * (half % 2))) as u32;
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
    for &tree in pushed {
        let [frontier, unseen, next] = &mut trees[tree as usize];
        for k in 0..K {
            V::load(&next[k]).and(V::load(&unseen[k])).store(&mut frontier[k]);
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
pub(super) fn mirror(rows: &mut [Lanes], stride: usize, words: usize) {
    let mut block = [0u64; 64];
    for r in 0..words {
        for c in r..words {
            let mut any = 0;
            for (i, word) in block.iter_mut().enumerate() {
                *word = rows[(r * 64 + i) * stride + c / 8].0[c % 8];
                any |= *word;
            }
            if any == 0 {
                continue;
            }
            transpose(&mut block);
            for (i, word) in block.iter().enumerate() {
                rows[(c * 64 + i) * stride + r / 8].0[r % 8] |= word;
            }
        }
    }
}
