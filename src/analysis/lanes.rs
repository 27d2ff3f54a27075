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

/// Comparisons of a row of a tile at once.
pub(super) trait Rows {
    /// Bit `i`: `a[i] < b[i]`.
    fn less(a: &[f32; ROW], b: &[f32; ROW]) -> u32;
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
}

/// Rows become columns: bit `j` of word `i` changes places with bit `i` of word `j`.
pub(super) fn transpose(m: &mut [u64; 64]) {
    let mut width = 32;
    let mut mask = 0x0000_0000_ffff_ffff_u64;
    while width != 0 {
        let mut k = 0;
        while k < 64 {
            let swap = ((m[k] >> width) ^ m[k + width]) & mask;
            m[k] ^= swap << width;
            m[k + width] ^= swap;
            k = (k + width + 1) & !width;
        }
        width >>= 1;
        mask ^= mask << width;
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
}

/// The instruction sets of x86-64 that are worth a path of their own.
#[cfg(target_arch = "x86_64")]
pub(super) mod x86 {
    // SAFETY of every block here: the intrinsics need AVX2 or AVX-512F, and these types are only used by
    // kernels entered through `dispatch`, which asks the processor first. Loads and stores go through
    // references to 64 aligned bytes, or to eight numbers.
    #![allow(unsafe_code)]

    use std::arch::x86_64::*;

    use super::{Lanes, ROW, Rows, Vector};

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
    }
}

/// Which kernels this processor can run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Path {
    /// 512-bit registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 256-bit registers.
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
            if is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("popcnt")
            {
                paths.push(Self::Avx512);
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt") {
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

#[cfg(test)]
mod tests {
    use super::*;

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
