//! How open the sky is above what is seen: hollows are darker than ridges.
//!
//! What rises around a sample is told from the depth buffer alone (Mittring, *Finding next gen: CryEngine 2*, 2007).
//! What rises by more than three times its distance is something in front, and hides nothing.

use super::raster::Frame;

/// How far neighbours are looked for, as shares of the frame. Small ones find creases, large ones make shadows soft.
const REACHES: [f32; 3] = [0.012, 0.03, 0.07];

/// In which neighbours are looked for. More take longer, fewer leave streaks.
const DIRECTIONS: usize = 6;

/// How dark hidden sky is. Above 1, because flat ground with a wall beside it has half its sky hidden at most.
const DARKNESS: f32 = 1.6;

/// A rise by less than this share of the distance hides nothing: the slope of a facet is no hollow.
const LEAST_RISE: f32 = 0.15;

/// Where to look for neighbours.
pub(super) struct Sky {
    /// Steps to the right and downwards, and how long they are. The four samples of a pixel look in different
    /// directions, which their mean evens out.
    steps: [Vec<(isize, isize, f32)>; 4],
}

impl Sky {
    pub(super) fn of(side: usize) -> Self {
        let step = |reach: f32, turns: f32| {
            let (sin, cos) = (turns * std::f32::consts::TAU).sin_cos();
            ((reach * cos).round() as isize, (reach * sin).round() as isize, reach)
        };
        let steps = |quarter: u8| {
            let turns = |direction: usize| (direction as f32 + f32::from(quarter) / 4.0) / DIRECTIONS as f32;
            let reaches = REACHES.iter().map(|share| (share * side as f32).max(1.0));
            reaches.flat_map(|reach| (0..DIRECTIONS).map(move |d| step(reach, turns(d)))).collect()
        };
        Self { steps: [0, 1, 2, 3].map(steps) }
    }

    /// From 0 to 1, for a sample that shows something.
    pub(super) fn open(&self, frame: &Frame, sample: usize) -> f32 {
        let (x, y) = (sample % frame.side, sample / frame.side);
        let steps = &self.steps[x % 2 * 2 + y % 2];
        let hidden = |&(right, down, reach): &(isize, isize, f32)| {
            let (x, y) = (x.checked_add_signed(right)?, y.checked_add_signed(down)?);
            let depth = frame.depth.get(y * frame.side + x).filter(|_| x < frame.side)?;
            let rise = (depth - frame.depth[sample]) / reach;
            (rise < 3.0).then_some((rise - LEAST_RISE).clamp(0.0, 1.0))
        };
        let share = steps.iter().filter_map(hidden).sum::<f32>() / steps.len() as f32;
        (1.0 - DARKNESS * share).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(depth: impl Fn(usize, usize) -> f32) -> Frame {
        let side = 200;
        let depth: Vec<f32> = (0..side * side).map(|i| depth(i % side, i / side)).collect();
        Frame { side, triangle: vec![0; depth.len()], depth }
    }

    fn open_at(frame: &Frame, x: usize, y: usize) -> f32 {
        Sky::of(frame.side).open(frame, y * frame.side + x)
    }

    #[test]
    fn a_valley_is_darker_than_its_slopes_and_they_than_the_ridge() {
        let valley = frame(|x, _| (x as f32 - 100.0).abs());
        assert!(open_at(&valley, 100, 100) < open_at(&valley, 130, 100) - 0.1);
        let ridge = frame(|x, _| -(x as f32 - 100.0).abs());
        assert_eq!(open_at(&ridge, 100, 100), 1.0);
    }

    #[test]
    fn flat_ground_and_what_stands_far_in_front_of_it_are_in_the_open() {
        let flat = frame(|_, _| 5.0);
        for at in [0, 100, 199] {
            assert_eq!(open_at(&flat, at, at), 1.0);
        }
        let wall = frame(|x, _| if x < 100 { 0.0 } else { 1e4 });
        assert_eq!(open_at(&wall, 99, 100), 1.0);
        let nothing_beside = frame(|x, _| if x < 100 { 0.0 } else { f32::NEG_INFINITY });
        assert_eq!(open_at(&nothing_beside, 99, 100), 1.0);
    }
}
