//! The exact distance from every pixel to the nearest one that is set.

use super::mask::Mask;

/// Distances to the pixels of a mask, row by row, exact in whole numbers.
///
/// A. Meijster, J. Roerdink, W. Hesselink, "A general algorithm for computing distance transforms in linear time", 2000:
/// distances along columns first, and in each row the lower envelope of the parabolas that they stand for.
pub(super) struct Distances {
    columns: usize,
    /// For each pixel the distance to the nearest one that is set in its column; farther than any where none is.
    along_column: Vec<u32>,
    /// The parabolas of the envelope: the column of each, and where it begins to be lowest.
    envelope: Vec<(i64, i64)>,
    row: Vec<u32>,
}

impl Distances {
    /// Distances to a mask of at least one pixel and at most 2¹⁴ rows and columns. O(pixels).
    pub(super) fn new(mask: &Mask) -> Self {
        let (columns, rows) = (mask.columns(), mask.rows());
        let mut along_column = vec![(columns + rows) as u32; columns * rows];
        for row in 0..rows {
            mask.in_row(row).for_each(|column| along_column[row * columns + column] = 0);
        }
        for row in 1..rows {
            let (before, after) = along_column.split_at_mut(row * columns);
            spread(&before[(row - 1) * columns..], &mut after[..columns]);
        }
        for row in (1..rows).rev() {
            let (before, after) = along_column.split_at_mut(row * columns);
            spread(&after[..columns], &mut before[(row - 1) * columns..]);
        }
        Self { columns, along_column, envelope: Vec::new(), row: vec![0; columns] }
    }

    /// The squared distances from the pixels of a row. O(columns).
    pub(super) fn of_row(&mut self, row: usize) -> &[u32] {
        let heights = &self.along_column[row * self.columns..][..self.columns];
        let height2 = |column: i64| i64::from(heights[column as usize]).pow(2);
        self.envelope.clear();
        for column in 0..self.columns as i64 {
            // The first column from which on the new parabola is lower than that of `other`.
            let from = |other: i64| {
                let rise = column * column - other * other + height2(column) - height2(other);
                rise.div_euclid(2 * (column - other)) + 1
            };
            while self.envelope.last().is_some_and(|&(other, start)| from(other) <= start) {
                self.envelope.pop();
            }
            let start = self.envelope.last().map_or(0, |&(other, _)| from(other));
            if start < self.columns as i64 {
                self.envelope.push((column, start));
            }
        }
        let ends = self.envelope.iter().skip(1).map(|&(_, start)| start).chain([self.columns as i64]);
        for (&(column, start), end) in self.envelope.iter().zip(ends) {
            for x in start..end {
                self.row[x as usize] = ((x - column).pow(2) + height2(column)) as u32;
            }
        }
        &self.row
    }
}

/// Takes on distances from the row beside, one more for the step.
fn spread(from: &[u32], to: &mut [u32]) {
    to.iter_mut().zip(from).for_each(|(distance, &beside)| *distance = (*distance).min(beside + 1));
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn distances_are_those_to_the_nearest_of_all(
            columns in 1_usize..90, rows in 1_usize..30, set in prop::collection::vec(any::<prop::sample::Index>(), 1..40)
        ) {
            let mut mask = Mask::new(columns, rows);
            let places = set.iter().map(|index| index.index(columns * rows));
            let set: Vec<(usize, usize)> = places.map(|place| (place % columns, place / columns)).collect();
            set.iter().for_each(|&(x, y)| mask.set(y, x, x));
            let mut distances = Distances::new(&mask);
            for y in 0..rows {
                let row = distances.of_row(y);
                for (x, &found) in row.iter().enumerate() {
                    let nearest = set.iter().map(|&(a, b)| a.abs_diff(x).pow(2) + b.abs_diff(y).pow(2)).min();
                    prop_assert_eq!(Some(found as usize), nearest);
                }
            }
        }
    }
}
