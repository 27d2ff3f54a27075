//! Shares of what begins at every vertex by itself, for several machines; and trees that were walked in them.

/// One of several shares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// From 0, below `count`.
    number: u32,
    count: u32,
}

impl Share {
    /// The only one.
    pub const WHOLE: Self = Self { number: 0, count: 1 };

    /// Share `number`, from 0, of `count`; none where there is no such share.
    pub fn new(number: u32, count: u32) -> Option<Self> {
        (number < count).then_some(Self { number, count })
    }

    /// All of so many.
    pub fn all(count: u32) -> impl Iterator<Item = Self> {
        (0..count).map(move |number| Self { number, count })
    }

    /// Whether what belongs to no other is this one's.
    pub(super) fn is_first(self) -> bool {
        self.number == 0
    }

    /// Its items of a list: the shares follow each other, and none has two more than another.
    pub(super) fn of<T>(self, all: &[T]) -> &[T] {
        let end = |shares: u32| (all.len() as u128 * u128::from(shares) / u128::from(self.count)) as usize;
        &all[end(self.number)..end(self.number + 1)]
    }
}

/// Breadth-first trees that were walked, as vertices per level.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Trees(Vec<Option<Vec<u32>>>);

impl Trees {
    /// By vertex; none where no tree was walked.
    pub fn new(by_vertex: Vec<Option<Vec<u32>>>) -> Self {
        Self(by_vertex)
    }

    /// Vertices on level 1, 2, … of the tree of a vertex; none where it was not walked.
    pub fn levels(&self, v: u32) -> Option<&[u32]> {
        self.0.get(v as usize)?.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_all_of_a_list_once() {
        for (items, count) in [(0, 1), (1, 3), (10, 3), (64, 64), (7, 2)] {
            let list: Vec<usize> = (0..items).collect();
            let shares: Vec<&[usize]> = Share::all(count).map(|s| s.of(&list)).collect();
            assert_eq!(shares.concat(), list);
            let sizes = shares.iter().map(|s| s.len());
            assert!(sizes.clone().max().unwrap() - sizes.min().unwrap() <= 1);
        }
        assert_eq!((Share::new(2, 2), Share::new(0, 1)), (None, Some(Share::WHOLE)));
    }
}
