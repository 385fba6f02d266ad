//! A sheet of pixels, each set or not.

/// Rows of pixels, 64 to a word; what is left of the last word of a row is not set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mask {
    columns: usize,
    words_per_row: usize,
    words: Vec<u64>,
}

impl Mask {
    pub(super) fn new(columns: usize, rows: usize) -> Self {
        let words_per_row = columns.div_ceil(64);
        Self { columns, words_per_row, words: vec![0; words_per_row * rows] }
    }

    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    pub(super) fn rows(&self) -> usize {
        self.words.len() / self.words_per_row.max(1)
    }

    /// Sets a run of a row, both ends included, as far as it is on the sheet.
    pub(super) fn set(&mut self, row: usize, first: usize, last: usize) {
        let last = last.min(self.columns - 1);
        let words = &mut self.words[row * self.words_per_row..];
        let (from, to) = (u64::MAX << (first % 64), u64::MAX >> (63 - last % 64));
        if first / 64 == last / 64 {
            words[first / 64] |= from & to;
        } else if first < last {
            words[first / 64] |= from;
            words[first / 64 + 1..last / 64].fill(u64::MAX);
            words[last / 64] |= to;
        }
    }

    pub(super) fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Whether every pixel that is set here is set in `other`, of the same size.
    pub(super) fn is_within(&self, other: &Self) -> bool {
        self.words.iter().zip(&other.words).all(|(word, of)| word & !of == 0)
    }

    /// The same of one row.
    pub(super) fn is_row_within(&self, other: &Self, row: usize) -> bool {
        self.row(row).iter().zip(other.row(row)).all(|(word, of)| word & !of == 0)
    }

    /// The columns of a row whose pixels are set, ascending.
    pub(super) fn in_row(&self, row: usize) -> impl Iterator<Item = usize> {
        let bits = |(i, &word): (usize, &u64)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 64 * i + bit)
        };
        self.row(row).iter().enumerate().filter(|&(_, &word)| word != 0).flat_map(bits)
    }

    fn row(&self, row: usize) -> &[u64] {
        &self.words[row * self.words_per_row..][..self.words_per_row]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_set_and_nothing_else(
            columns in 1_usize..200, runs in prop::collection::vec((0_usize..3, 0_usize..220, 0_usize..220), 0..8)
        ) {
            let mut mask = Mask::new(columns, 3);
            let mut slow = vec![vec![false; columns]; 3];
            for (row, a, b) in runs {
                let (first, last) = (a.min(b).min(columns - 1), a.max(b));
                mask.set(row, first, last);
                slow[row].iter_mut().take(last + 1).skip(first).for_each(|pixel| *pixel = true);
            }
            for (row, slow) in slow.iter().enumerate() {
                let expected: Vec<usize> = (0..columns).filter(|&column| slow[column]).collect();
                prop_assert_eq!(mask.in_row(row).collect::<Vec<_>>(), expected);
            }
            prop_assert_eq!(mask.count(), slow.concat().iter().filter(|&&set| set).count());
        }
    }

    #[test]
    fn what_is_within_is_within() {
        let [mut less, mut more] = [Mask::new(70, 2), Mask::new(70, 2)];
        less.set(1, 60, 66);
        more.set(1, 50, 69);
        assert!(less.is_within(&more) && !more.is_within(&less) && less.is_within(&less));
        assert!(more.is_row_within(&less, 0) && !more.is_row_within(&less, 1));
    }
}
