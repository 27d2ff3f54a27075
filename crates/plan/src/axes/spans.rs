//! Intervals on a line: what is left when others are taken away.

/// From, to; from < to.
pub type Span = [f64; 2];

/// What a metre has of the smallest lengths that are told apart.
const HAIRS_PER_M: f64 = 1e7;

/// A length to a tenth of a micrometre: what differs by less is one, so that equal walls are understood in the same
/// way wherever they stand, though their coordinates carry other errors of rounding there.
pub fn tidy(length_m: f64) -> f64 {
    (length_m * HAIRS_PER_M).round() / HAIRS_PER_M
}

/// Length, to a tenth of a micrometre.
pub fn length(s: Span) -> f64 {
    tidy(s[1] - s[0])
}

/// What two spans share, if it has a length.
pub fn overlap(a: Span, b: Span) -> Option<Span> {
    let out = [a[0].max(b[0]), a[1].min(b[1])];
    (length(out) > 0.0).then_some(out)
}

/// `from` without `taken` (in any order), pieces in order.
pub fn without(from: Span, taken: &[Span]) -> Vec<Span> {
    let mut out = vec![from];
    for t in taken {
        out = out.into_iter().flat_map(|s| cut(s, *t)).flatten().collect();
    }
    out
}

fn cut(s: Span, t: Span) -> [Option<Span>; 2] {
    if overlap(s, t).is_none() {
        return [Some(s), None];
    }
    [[s[0], t[0]], [t[1], s[1]]].map(|left| (length(left) > 0.0).then_some(left))
}

/// How much of `s` the spans cover together.
pub fn covered(s: Span, by: &[Span]) -> f64 {
    length(s) - without(s, by).into_iter().map(length).sum::<f64>()
}

/// Spans that touch within `gap` joined, in order.
pub fn joined(mut spans: Vec<Span>, gap: f64) -> Vec<Span> {
    spans.sort_by(|a, b| tidy(a[0]).total_cmp(&tidy(b[0])));
    let mut out: Vec<Span> = Vec::new();
    for s in spans {
        match out.last_mut() {
            Some(last) if s[0] <= last[1] + gap => last[1] = last[1].max(s[1]),
            _ => out.push(s),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_cut_and_joined() {
        assert_eq!(without([0.0, 10.0], &[[8.0, 12.0], [2.0, 3.0]]), [[0.0, 2.0], [3.0, 8.0]]);
        assert_eq!(without([0.0, 1.0], &[[-1.0, 2.0]]), Vec::<Span>::new());
        assert!((covered([0.0, 4.0], &[[1.0, 2.0], [1.5, 3.0]]) - 2.0).abs() < 1e-12);
        assert_eq!(joined(vec![[2.0, 3.0], [0.0, 1.99]], 0.02), [[0.0, 3.0]]);
        assert_eq!(overlap([0.0, 1.0], [1.0, 2.0]), None);
    }
}
