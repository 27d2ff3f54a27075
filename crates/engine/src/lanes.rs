//! 512 bits, one a root: the word of the breadth-first forest, in the widest registers there are.

/// One bit for each of 512 roots; a cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C, align(64))]
pub(super) struct Lanes(pub [u64; 8]);

/// Roots that are walked at once.
pub(super) const LANES: usize = 512;

impl Lanes {
    pub fn set(&mut self, lane: usize) {
        self.0[lane >> 6] |= 1 << (lane & 63);
    }

    pub fn clear(&mut self, lane: usize) {
        self.0[lane >> 6] &= !(1 << (lane & 63));
    }

    pub fn get(&self, lane: usize) -> u64 {
        self.0[lane >> 6] >> (lane & 63) & 1
    }
}

/// Registers that hold [`Lanes`]. Every implementation gives the same bits.
pub(super) trait Vector: Copy {
    fn load(from: &Lanes) -> Self;
    fn store(self, to: &mut Lanes);
    fn or(self, other: Self) -> Self;
    fn xor(self, other: Self) -> Self;
    fn and(self, other: Self) -> Self;
    /// `self & !other`.
    fn without(self, other: Self) -> Self;
    fn is_zero(self) -> bool;
    /// The bits of a word under the ones of a mask, next to each other from bit 0 on.
    fn gather(word: u64, mask: u64) -> u64;
    /// The union of the words whose keys have a bit of a mask; as many keys as words, in fours.
    fn union_by(words: &[u64], keys: &[u64], mask: u64) -> u64;

    fn zero() -> Self {
        Self::load(&Lanes([0; 8]))
    }

    /// Adds three bits a lane: `(carry, sum)`.
    #[inline(always)]
    fn add(self, b: Self, c: Self) -> (Self, Self) {
        let half = self.xor(b);
        (self.and(b).or(half.and(c)), half.xor(c))
    }
}

/// Cells of a row of a tile.
pub(super) const ROW: usize = 8;

/// The first bit of the next row of eight that has any, and the row, which is taken off.
#[inline(always)]
pub(super) fn next_row(bits: &mut u64) -> Option<(u32, u32)> {
    if *bits == 0 {
        return None;
    }
    let row = bits.trailing_zeros() & !7;
    let cells = (*bits >> row) as u32 & 0xff;
    *bits &= !(0xff << row);
    Some((row, cells))
}

/// The mask of a tile in a row of the graph, tiles asked for in ascending order.
#[inline(always)]
pub(super) fn known_in((tiles, masks): (&[u32], &[u64]), tile: u32, next: &mut usize) -> u64 {
    while *next < tiles.len() && tiles[*next] < tile {
        *next += 1;
    }
    if tiles.get(*next) == Some(&tile) { masks[*next] } else { 0 }
}

/// The least of what was offered to a row of eight: what it costs, who offers it, and by which list; and the second least.
#[derive(Clone, Copy)]
pub(super) struct Least {
    pub cost: [f32; ROW],
    pub second: [f32; ROW],
    pub by: [u32; ROW],
    pub list: [u32; ROW],
}

/// An offer to a row of eight: who offers, to those with which list, what more it costs, and which list follows.
#[derive(Clone, Copy)]
pub(super) struct Offer {
    pub by: u32,
    pub of: u32,
    pub length: f32,
    pub list: u32,
}

/// Comparisons of a row of a tile at once, or of eight roots.
pub(super) trait Rows {
    /// Bit `i`: `a[i] < b[i]`.
    fn less(a: &[f32; ROW], b: &[f32; ROW]) -> u32;
    /// The same in double precision.
    fn less_wide(a: &[f64; ROW], b: &[f32; ROW]) -> u32;
    /// Bit `i`: `a[i] == b`.
    fn same(a: &[u32; ROW], b: u32) -> u32;
    /// Takes in an offer by one with these costs and lists.
    fn take_in(least: &mut Least, costs: &[f32; ROW], lists: &[u32; ROW], offer: Offer);
    /// Writes `first` plus the number of every one of eight bits, without a branch, and whatever behind them.
    fn list(bits: u32, first: u32, to: &mut [u32; ROW]);
}

impl Rows for Portable {
    #[inline(always)]
    fn less(a: &[f32; ROW], b: &[f32; ROW]) -> u32 {
        let mut less = 0;
        for i in 0..ROW {
            less |= u32::from(a[i] < b[i]) << i;
        }
        less
    }
    #[inline(always)]
    fn less_wide(a: &[f64; ROW], b: &[f32; ROW]) -> u32 {
        let mut less = 0;
        for i in 0..ROW {
            less |= u32::from(a[i] < f64::from(b[i])) << i;
        }
        less
    }
    #[inline(always)]
    fn same(a: &[u32; ROW], b: u32) -> u32 {
        a.iter().enumerate().fold(0, |same, (i, a)| same | u32::from(*a == b) << i)
    }
    #[inline(always)]
    fn take_in(least: &mut Least, costs: &[f32; ROW], lists: &[u32; ROW], offer: Offer) {
        for i in 0..ROW {
            let new = if lists[i] == offer.of { costs[i] + offer.length } else { f32::INFINITY };
            let old = least.cost[i];
            let is_less = new < old;
            let more = if is_less { old } else { new };
            least.second[i] = if more < least.second[i] { more } else { least.second[i] };
            least.cost[i] = if is_less { new } else { old };
            least.by[i] = if is_less { offer.by } else { least.by[i] };
            least.list[i] = if is_less { offer.list } else { least.list[i] };
        }
    }
    #[inline(always)]
    fn list(bits: u32, first: u32, to: &mut [u32; ROW]) {
        let mut count = 0;
        for i in 0..ROW {
            to[count & (ROW - 1)] = first + i as u32;
            count += (bits >> i & 1) as usize;
        }
    }
}

/// Rows become columns: bit `j` of word `i` changes places with bit `i` of word `j`.
#[inline(always)]
pub(super) fn transpose(m: &mut [u64; 64]) {
    swap_blocks::<32>(m, 0x0000_0000_ffff_ffff);
    swap_blocks::<16>(m, 0x0000_ffff_0000_ffff);
    swap_blocks::<8>(m, 0x00ff_00ff_00ff_00ff);
    swap_blocks::<4>(m, 0x0f0f_0f0f_0f0f_0f0f);
    swap_blocks::<2>(m, 0x3333_3333_3333_3333);
    swap_blocks::<1>(m, 0x5555_5555_5555_5555);
}

/// Of every square of `2 * WIDTH` words and bits, the two quarters off its diagonal change places.
#[inline(always)]
fn swap_blocks<const WIDTH: usize>(m: &mut [u64; 64], mask: u64) {
    let mut squares: &mut [u64] = m;
    while squares.len() >= 2 * WIDTH {
        let (square, rest) = squares.split_at_mut(2 * WIDTH);
        let (low, high) = square.split_at_mut(WIDTH);
        for i in 0..WIDTH {
            let swap = ((low[i] >> WIDTH) ^ high[i]) & mask;
            low[i] ^= swap << WIDTH;
            high[i] ^= swap;
        }
        squares = rest;
    }
}

/// Plain words, for every machine.
#[derive(Clone, Copy)]
pub(super) struct Portable([u64; 8]);

impl Portable {
    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(u64, u64) -> u64) -> Self {
        let mut out = self.0;
        for (a, b) in out.iter_mut().zip(other.0) {
            *a = f(*a, b);
        }
        Self(out)
    }
}

impl Vector for Portable {
    #[inline(always)]
    fn load(from: &Lanes) -> Self {
        Self(from.0)
    }
    #[inline(always)]
    fn store(self, to: &mut Lanes) {
        to.0 = self.0;
    }
    #[inline(always)]
    fn or(self, other: Self) -> Self {
        self.zip(other, |a, b| a | b)
    }
    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        self.zip(other, |a, b| a ^ b)
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self.zip(other, |a, b| a & b)
    }
    #[inline(always)]
    fn without(self, other: Self) -> Self {
        self.zip(other, |a, b| a & !b)
    }
    #[inline(always)]
    fn is_zero(self) -> bool {
        self.0.iter().fold(0, |a, b| a | b) == 0
    }
    #[inline(always)]
    fn gather(word: u64, mut mask: u64) -> u64 {
        let (mut gathered, mut count) = (0, 0);
        while mask != 0 {
            let first = mask.trailing_zeros();
            let run = (!(mask >> first)).trailing_zeros();
            let ones = u64::MAX >> (64 - run);
            gathered |= (word >> first & ones) << count;
            count += run;
            mask &= !(ones << first);
        }
        gathered
    }
    #[inline(always)]
    fn union_by(words: &[u64], keys: &[u64], mask: u64) -> u64 {
        let mut union = 0;
        for (word, key) in words.iter().zip(keys) {
            union |= word & u64::from(key & mask != 0).wrapping_neg();
        }
        union
    }
}

/// The instruction sets of x86-64 that are worth a path of their own.
#[cfg(target_arch = "x86_64")]
pub(super) mod x86 {
    // SAFETY of every block here: the intrinsics need AVX2, BMI2 or AVX-512F, and these types are only used by
    // kernels entered through `dispatch`, which asks the processor first. Loads and stores go through
    // references to 64 aligned bytes, or to eight numbers.
    #![allow(unsafe_code)]

    use std::arch::x86_64::*;

    use super::{Lanes, Least, Offer, ROW, Rows, Vector};

    /// [`Vector::union_by`] for both: words are seldom more than a few fours.
    #[inline(always)]
    fn union_of_fours(words: &[u64], keys: &[u64], mask: u64) -> u64 {
        unsafe {
            let mask = _mm256_set1_epi64x(mask as i64);
            let mut union = _mm256_setzero_si256();
            for (words, keys) in words.as_chunks::<4>().0.iter().zip(keys.as_chunks::<4>().0) {
                let met = _mm256_and_si256(_mm256_loadu_si256(keys.as_ptr().cast()), mask);
                let none = _mm256_cmpeq_epi64(met, _mm256_setzero_si256());
                let words = _mm256_loadu_si256(words.as_ptr().cast());
                union = _mm256_or_si256(union, _mm256_andnot_si256(none, words));
            }
            let half = _mm_or_si128(_mm256_castsi256_si128(union), _mm256_extracti128_si256::<1>(union));
            (_mm_cvtsi128_si64(half) | _mm_extract_epi64::<1>(half)) as u64
        }
    }

    #[derive(Clone, Copy)]
    pub struct Avx512(__m512i);

    impl Vector for Avx512 {
        #[inline(always)]
        fn load(from: &Lanes) -> Self {
            Self(unsafe { _mm512_load_si512(from.0.as_ptr().cast()) })
        }
        #[inline(always)]
        fn store(self, to: &mut Lanes) {
            unsafe { _mm512_store_si512(to.0.as_mut_ptr().cast(), self.0) }
        }
        #[inline(always)]
        fn or(self, other: Self) -> Self {
            Self(unsafe { _mm512_or_si512(self.0, other.0) })
        }
        #[inline(always)]
        fn xor(self, other: Self) -> Self {
            Self(unsafe { _mm512_xor_si512(self.0, other.0) })
        }
        #[inline(always)]
        fn and(self, other: Self) -> Self {
            Self(unsafe { _mm512_and_si512(self.0, other.0) })
        }
        #[inline(always)]
        fn without(self, other: Self) -> Self {
            Self(unsafe { _mm512_andnot_si512(other.0, self.0) })
        }
        #[inline(always)]
        fn is_zero(self) -> bool {
            unsafe { _mm512_test_epi64_mask(self.0, self.0) == 0 }
        }
        #[inline(always)]
        fn gather(word: u64, mask: u64) -> u64 {
            unsafe { _pext_u64(word, mask) }
        }
        #[inline(always)]
        fn union_by(words: &[u64], keys: &[u64], mask: u64) -> u64 {
            union_of_fours(words, keys, mask)
        }
        #[inline(always)]
        fn add(self, b: Self, c: Self) -> (Self, Self) {
            unsafe {
                let carry = _mm512_ternarylogic_epi64::<0xe8>(self.0, b.0, c.0);
                (Self(carry), Self(_mm512_ternarylogic_epi64::<0x96>(self.0, b.0, c.0)))
            }
        }
    }

    #[derive(Clone, Copy)]
    pub struct Avx2(__m256i, __m256i);

    impl Rows for Avx2 {
        #[inline(always)]
        fn less(a: &[f32; ROW], b: &[f32; ROW]) -> u32 {
            unsafe {
                let (a, b) = (_mm256_loadu_ps(a.as_ptr()), _mm256_loadu_ps(b.as_ptr()));
                _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b)) as u32
            }
        }
        #[inline(always)]
        fn less_wide(a: &[f64; ROW], b: &[f32; ROW]) -> u32 {
            let half = |a: &[f64], b: &[f32]| unsafe {
                let (a, b) = (_mm256_loadu_pd(a.as_ptr()), _mm256_cvtps_pd(_mm_loadu_ps(b.as_ptr())));
                _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b)) as u32
            };
            half(&a[..4], &b[..4]) | half(&a[4..], &b[4..]) << 4
        }
        #[inline(always)]
        fn same(a: &[u32; ROW], b: u32) -> u32 {
            unsafe {
                let same =
                    _mm256_cmpeq_epi32(_mm256_loadu_si256(a.as_ptr().cast()), _mm256_set1_epi32(b as i32));
                _mm256_movemask_ps(_mm256_castsi256_ps(same)) as u32
            }
        }
        #[inline(always)]
        fn take_in(least: &mut Least, costs: &[f32; ROW], lists: &[u32; ROW], offer: Offer) {
            let all = |value: u32| unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(value as i32)) };
            unsafe {
                let lists = _mm256_loadu_si256(lists.as_ptr().cast());
                let made = _mm256_cmpeq_epi32(lists, _mm256_set1_epi32(offer.of as i32));
                let new = _mm256_add_ps(_mm256_loadu_ps(costs.as_ptr()), _mm256_set1_ps(offer.length));
                let new = _mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), new, _mm256_castsi256_ps(made));
                let old = _mm256_loadu_ps(least.cost.as_ptr());
                let is_less = _mm256_cmp_ps::<_CMP_LT_OQ>(new, old);
                let second = _mm256_loadu_ps(least.second.as_ptr());
                let by = _mm256_blendv_ps(_mm256_loadu_ps(least.by.as_ptr().cast()), all(offer.by), is_less);
                let list =
                    _mm256_blendv_ps(_mm256_loadu_ps(least.list.as_ptr().cast()), all(offer.list), is_less);
                _mm256_storeu_ps(least.second.as_mut_ptr(), _mm256_min_ps(_mm256_max_ps(new, old), second));
                _mm256_storeu_ps(least.cost.as_mut_ptr(), _mm256_min_ps(new, old));
                _mm256_storeu_ps(least.by.as_mut_ptr().cast(), by);
                _mm256_storeu_ps(least.list.as_mut_ptr().cast(), list);
            }
        }
        #[inline(always)]
        fn list(bits: u32, first: u32, to: &mut [u32; ROW]) {
            unsafe {
                let bytes = _pdep_u64(u64::from(bits), 0x0101_0101_0101_0101) * 0xff;
                let ones = _pext_u64(0x0706_0504_0302_0100, bytes);
                let ones = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(ones as i64));
                let all = _mm256_add_epi32(ones, _mm256_set1_epi32(first as i32));
                _mm256_storeu_si256(to.as_mut_ptr().cast(), all);
            }
        }
    }

    impl Vector for Avx2 {
        #[inline(always)]
        fn load(from: &Lanes) -> Self {
            let at: *const __m256i = from.0.as_ptr().cast();
            unsafe { Self(_mm256_load_si256(at), _mm256_load_si256(at.add(1))) }
        }
        #[inline(always)]
        fn store(self, to: &mut Lanes) {
            let at: *mut __m256i = to.0.as_mut_ptr().cast();
            unsafe {
                _mm256_store_si256(at, self.0);
                _mm256_store_si256(at.add(1), self.1);
            }
        }
        #[inline(always)]
        fn or(self, other: Self) -> Self {
            unsafe { Self(_mm256_or_si256(self.0, other.0), _mm256_or_si256(self.1, other.1)) }
        }
        #[inline(always)]
        fn xor(self, other: Self) -> Self {
            unsafe { Self(_mm256_xor_si256(self.0, other.0), _mm256_xor_si256(self.1, other.1)) }
        }
        #[inline(always)]
        fn and(self, other: Self) -> Self {
            unsafe { Self(_mm256_and_si256(self.0, other.0), _mm256_and_si256(self.1, other.1)) }
        }
        #[inline(always)]
        fn without(self, other: Self) -> Self {
            unsafe { Self(_mm256_andnot_si256(other.0, self.0), _mm256_andnot_si256(other.1, self.1)) }
        }
        #[inline(always)]
        fn is_zero(self) -> bool {
            unsafe {
                let any = _mm256_or_si256(self.0, self.1);
                _mm256_testz_si256(any, any) == 1
            }
        }
        #[inline(always)]
        fn gather(word: u64, mask: u64) -> u64 {
            unsafe { _pext_u64(word, mask) }
        }
        #[inline(always)]
        fn union_by(words: &[u64], keys: &[u64], mask: u64) -> u64 {
            union_of_fours(words, keys, mask)
        }
    }
}

/// Which kernels this processor can run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// 512-bit registers: AVX-512 F and DQ, and what [`Path::Avx2`] has.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 256-bit registers: AVX2, BMI1, BMI2 and POPCNT.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Plain words.
    Portable,
}

impl Path {
    /// Widest first.
    pub fn available() -> Vec<Self> {
        let mut paths = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            let has_bits = is_x86_feature_detected!("popcnt")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2");
            let has_avx2 = has_bits && is_x86_feature_detected!("avx2");
            if has_avx2 && is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512dq") {
                paths.push(Self::Avx512);
            }
            if has_avx2 {
                paths.push(Self::Avx2);
            }
        }
        paths.push(Self::Portable);
        paths
    }

    /// The widest.
    pub fn best() -> Self {
        Self::available()[0]
    }
}

/// The `walk` of a walker with a `walk_in` that is generic over [`Rows`]: as wide as the processor of `paths` allows. Rows of
/// eight are those of AVX2 under AVX-512 too, which then compiles the rest of the walk.
macro_rules! walk_by_rows {
    ($(#[$doc:meta])* $($name:ident: $type:ty),*) => {
        $(#[$doc])*
        pub fn walk(&mut self, paths: &Paths<'_>, $($name: $type),*) {
            match paths.path {
                // SAFETY: a path is only made for a processor that has its instructions.
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code)]
                $crate::lanes::Path::Avx512 => unsafe { self.walk_avx512(paths, $($name),*) },
                #[cfg(target_arch = "x86_64")]
                #[allow(unsafe_code)]
                $crate::lanes::Path::Avx2 => unsafe { self.walk_avx2(paths, $($name),*) },
                $crate::lanes::Path::Portable => self.walk_in::<$crate::lanes::Portable>(paths, $($name),*),
            }
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
        fn walk_avx512(&mut self, paths: &Paths<'_>, $($name: $type),*) {
            self.walk_in::<$crate::lanes::x86::Avx2>(paths, $($name),*);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
        fn walk_avx2(&mut self, paths: &Paths<'_>, $($name: $type),*) {
            self.walk_in::<$crate::lanes::x86::Avx2>(paths, $($name),*);
        }
    };
}
pub(super) use walk_by_rows;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_path_gathers_the_same_bits() {
        let word = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ i.rotate_left(31);
        let masks = (0..200).map(word).chain([0, u64::MAX, 1, 1 << 63, 0xff00]);
        for (i, mask) in masks.enumerate() {
            let bits = word(i as u64 + 7);
            let places: Vec<u32> = (0..64).filter(|k| mask >> k & 1 == 1).collect();
            let expected =
                places.iter().enumerate().fold(0, |sum, (to, from)| sum | (bits >> from & 1) << to);
            assert_eq!(Portable::gather(bits, mask), expected);
            #[cfg(target_arch = "x86_64")]
            if Path::available().contains(&Path::Avx2) {
                assert_eq!(x86::Avx2::gather(bits, mask), expected);
            }
        }
    }

    #[test]
    fn transpose_swaps_rows_and_columns() {
        let word = |i: u64| i.wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(i as u32 * 7);
        let before: [u64; 64] = std::array::from_fn(|i| word(i as u64 + 1));
        let mut after = before;
        transpose(&mut after);
        for (i, row) in before.iter().enumerate() {
            for (j, column) in after.iter().enumerate() {
                assert_eq!(row >> j & 1, column >> i & 1);
            }
        }
    }
}
