//! The inner loops of the surrogate, eight lanes wide.
//!
//! Plain Rust without fused multiply-add: every machine gives the same bits, with wide registers or
//! without. Where the processor has AVX2 the same code is compiled for it.

/// Values worked on together.
pub(super) const LANES: usize = 8;

macro_rules! dispatched {
    ($(#[$doc:meta])* $name:ident, $body:ident, ($($arg:ident: $type:ty),*) $(-> $out:ty)?) => {
        $(#[$doc])*
        #[allow(unsafe_code)]
        pub(super) fn $name($($arg: $type),*) $(-> $out)? {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2")]
                fn wide($($arg: $type),*) $(-> $out)? {
                    $body($($arg),*)
                }
                if std::arch::is_x86_feature_detected!("avx2") {
                    // SAFETY: the processor has AVX2, asked for one line above; that is all `wide` needs.
                    return unsafe { wide($($arg),*) };
                }
            }
            $body($($arg),*)
        }
    };
}

dispatched!(
    /// Dot product over the length of `a`.
    dot, dot_body, (a: &[f64], b: &[f64]) -> f64
);
dispatched!(
    /// `to += factor · of`, over the length of `to`.
    add_multiple, add_multiple_body, (to: &mut [f64], factor: f64, of: &[f64])
);
dispatched!(
    /// Radial functions into `out`: cubes of distances, and of the differences in each coordinate. `[squares, cubes]`
    /// hold both for a point, `moved` by how much coordinates move away from it and their differences there, `shift`
    /// the square of that way; each slice is a multiple of [`LANES`] long. Returns the least squared distance.
    radials, radials_body, (from: [&[f64]; 2], moved: &[(f64, &[f64])], shift: f64, out: &mut [f64]) -> f64
);

#[inline(always)]
fn dot_body(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (head_a, tail_a) = a.as_chunks::<LANES>();
    let (head_b, tail_b) = b[..a.len()].as_chunks::<LANES>();
    for (x, y) in head_a.iter().zip(head_b) {
        for l in 0..LANES {
            lanes[l] += x[l] * y[l];
        }
    }
    let tail: f64 = tail_a.iter().zip(tail_b).map(|(x, y)| x * y).sum();
    let halves = [lanes[0] + lanes[4], lanes[1] + lanes[5], lanes[2] + lanes[6], lanes[3] + lanes[7]];
    (halves[0] + halves[2]) + (halves[1] + halves[3]) + tail
}

#[inline(always)]
fn add_multiple_body(to: &mut [f64], factor: f64, of: &[f64]) {
    to.iter_mut().zip(of).for_each(|(t, &o)| *t += factor * o);
}

#[inline(always)]
fn radials_body(from: [&[f64]; 2], moved: &[(f64, &[f64])], shift: f64, out: &mut [f64]) -> f64 {
    let mut least = [f64::INFINITY; LANES];
    let [squares, cubes] = from.map(|slice| slice.as_chunks::<LANES>().0);
    let (out, _) = out.as_chunks_mut::<LANES>();
    for (c, ((square, cube), out)) in squares.iter().zip(cubes).zip(out).enumerate() {
        let (mut square, mut cube) = (*square, *cube);
        for &(step, column) in moved {
            let column = &column[c * LANES..][..LANES];
            for l in 0..LANES {
                let (before, after) = (column[l].abs(), (column[l] + step).abs());
                square[l] += 2.0 * step * column[l];
                cube[l] += after * after * after - before * before * before;
            }
        }
        for l in 0..LANES {
            let s = (square[l] + shift).max(0.0);
            least[l] = least[l].min(s);
            out[l] = s * s.sqrt() + cube[l];
        }
    }
    least.into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_and_narrow_give_the_same_bits() {
        let a: Vec<f64> = (0..83).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let b: Vec<f64> = (0..83).map(|i| (f64::from(i) * 1.3).cos()).collect();
        assert_eq!(dot(&a, &b).to_bits(), dot_body(&a, &b).to_bits());
        let (mut x, mut y) = ([0.0; 80], [0.0; 80]);
        let squares: Vec<f64> = a[..80].iter().map(|v| v * v + 1.0).collect();
        let cubes = [0.5; 80];
        let moved = [(0.125, &b[..80]), (-0.25, &a[..80])];
        let least = radials([&squares, &cubes], &moved, 0.125, &mut x);
        assert_eq!(least.to_bits(), radials_body([&squares, &cubes], &moved, 0.125, &mut y).to_bits());
        assert_eq!(x.map(f64::to_bits), y.map(f64::to_bits));
        let far = squares.iter().zip(&b).zip(&a).map(|((s, b), a)| s + 0.25 * b - 0.5 * a + 0.125);
        let alone = |v: f64, step: f64| (v + step).abs().powi(3) - v.abs().powi(3);
        let alone = a.iter().zip(&b).map(|(&a, &b)| 0.5 + alone(b, 0.125) + alone(a, -0.25));
        assert!(far.zip(alone).zip(x).all(|((far, alone), out)| (far.powf(1.5) + alone - out).abs() < 1e-12));
    }
}
