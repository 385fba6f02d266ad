//! The floor of every row: a streaming read of 16 bytes per object.

use std::hint::black_box;

/// Sixteen bytes of each object.
pub struct Stream(Vec<u32>);

const LANES: usize = 64;

impl Stream {
    pub fn of(objects: usize) -> Self {
        Self((0..objects as u32 * 4).collect())
    }

    /// Reads everything once. The sums are independent, so that memory is what it waits for.
    pub fn read(&self) {
        let mut sums = [0u32; LANES];
        let rows = black_box(&self.0).chunks_exact(LANES);
        rows.for_each(|row| sums.iter_mut().zip(row).for_each(|(sum, x)| *sum = sum.wrapping_add(*x)));
        black_box(sums);
    }
}
