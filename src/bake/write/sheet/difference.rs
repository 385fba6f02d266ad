//! Where two pictures of the same place differ most.

use super::raster::{Frame, NOTHING};

/// Cells each way that differences are gathered in.
const CELLS: usize = 64;

/// A difference in depth counts for no more than this share of the frame, as does something that only one shows: one
/// thing that went is not to outweigh many that moved.
const MOST: f32 = 0.05;

/// The upper left corner of the square of `window` samples in which the frames, equally large, differ most; of equals
/// the first. In the middle where they do not differ.
pub(super) fn greatest(a: &Frame, b: &Frame, window: usize) -> [usize; 2] {
    let cell = a.side.div_ceil(CELLS);
    let mut sums = vec![0.0; CELLS * CELLS];
    for sample in 0..a.triangle.len() {
        let (x, y) = (sample % a.side / cell, sample / a.side / cell);
        sums[y * CELLS + x] += f64::from(difference(a, b, sample));
    }
    let (width, places) = (window / cell, a.side.saturating_sub(window) / cell + 1);
    let mut most = (0.0, [a.side.saturating_sub(window) / 2; 2]);
    for y in 0..places {
        for x in 0..places {
            let rows =
                (y..(y + width).min(CELLS)).map(|y| &sums[y * CELLS + x..y * CELLS + (x + width).min(CELLS)]);
            let sum: f64 = rows.flatten().sum();
            if sum > most.0 {
                most = (sum, [x * cell, y * cell]);
            }
        }
    }
    most.1
}

/// In samples.
fn difference(a: &Frame, b: &Frame, sample: usize) -> f32 {
    let most = MOST * a.side as f32;
    match (a.triangle[sample], b.triangle[sample]) {
        (NOTHING, NOTHING) => 0.0,
        (NOTHING, _) | (_, NOTHING) => most,
        _ => (a.depth[sample] - b.depth[sample]).abs().min(most),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(side: usize, depth: impl Fn(usize, usize) -> Option<f32>) -> Frame {
        let depths: Vec<_> = (0..side * side).map(|i| depth(i % side, i / side)).collect();
        let triangle = depths.iter().map(|d| d.map_or(NOTHING, |_| 0)).collect();
        Frame { side, triangle, depth: depths.into_iter().map(|d| d.unwrap_or(f32::NEG_INFINITY)).collect() }
    }

    #[test]
    fn the_window_holds_what_differs() {
        let flat = frame(128, |_, _| Some(0.0));
        let dented = frame(128, |x, y| Some(if x / 8 == 11 && y / 8 == 3 { 1.0 } else { 0.0 }));
        let [x, y] = greatest(&flat, &dented, 32);
        assert!((x..x + 32).contains(&88) && (x..x + 32).contains(&95), "{x}");
        assert!((y..y + 32).contains(&24) && (y..y + 32).contains(&31), "{y}");
        let holed = frame(128, |x, y| (x > 4 || y > 4).then_some(0.0));
        assert_eq!(greatest(&flat, &holed, 32), [0, 0]);
    }

    #[test]
    fn equal_pictures_are_looked_at_in_the_middle() {
        for side in [1, 7, 64, 100, 640] {
            let flat = frame(side, |x, _| (x > 3).then_some(0.0));
            let window = side / 4;
            assert_eq!(greatest(&flat, &flat, window), [(side - window) / 2; 2]);
        }
    }
}
