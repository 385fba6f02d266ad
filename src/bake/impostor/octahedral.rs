//! The octahedral map: directions as points of a square, and the grid of frames on it.
//!
//! Q. Meyer et al., "On floating-point normal vectors", 2010, project the sphere onto an octahedron and unfold that to a
//! square; Z. Cigolle et al., "A survey of efficient representations for independent unit vectors", 2014, have it for
//! the hemisphere, too. On every face of the octahedron the map is linear up to length, so that what is inside a
//! triangle of the square is inside the triangle of great circles between its corners. The grid's triangles must not
//! bend over an edge of the octahedron for that: hence an odd number of points each way, and diagonals that go along
//! with the edges.

use glam::{DVec2, DVec3};

/// A square grid of directions, which are given along right, up and front.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Octahedron {
    side: u32,
    hemisphere: bool,
}

impl Octahedron {
    /// `side` directions each way, made odd and at least 3; those from above alone, or all.
    ///
    /// On the whole sphere, directions from below are at the border of the square, where it is folded: those are there
    /// twice, and the one right from below four times.
    pub fn new(side: u32, hemisphere: bool) -> Self {
        Self { side: side.max(3) | 1, hemisphere }
    }

    /// Where a direction of any length is on the square from (−1, −1) to (1, 1). Directions from below are on the border
    /// of a hemisphere, and what has no direction is as from above.
    pub fn encode(&self, direction: DVec3) -> DVec2 {
        let up = if self.hemisphere { direction.y.max(0.0) } else { direction.y };
        let flat = DVec2::new(direction.x, direction.z);
        let length = flat.x.abs() + flat.y.abs() + up.abs();
        if !(length > 0.0 && length.is_finite()) {
            return DVec2::ZERO;
        }
        let on_face = flat / length;
        if self.hemisphere {
            DVec2::new(on_face.x + on_face.y, on_face.x - on_face.y)
        } else if up < 0.0 {
            folded(on_face)
        } else {
            on_face
        }
    }

    /// The point of the octahedron |x| + |y| + |z| = 1 that a point of the square stands for.
    pub fn on_octahedron(&self, at: DVec2) -> DVec3 {
        let flat = if self.hemisphere { DVec2::new(at.x + at.y, at.x - at.y) * 0.5 } else { at };
        let up = 1.0 - flat.x.abs() - flat.y.abs();
        let flat = if up < 0.0 { folded(flat) } else { flat };
        let up = if self.hemisphere { up.max(0.0) } else { up };
        DVec3::new(flat.x, up, flat.y)
    }

    /// The unit vector that a point of the square stands for.
    pub fn decode(&self, at: DVec2) -> DVec3 {
        // No point of an octahedron is its middle.
        self.on_octahedron(at).normalize()
    }

    /// The direction of a frame; frames are counted row by row.
    ///
    /// # Panics
    /// Where there is no such frame.
    pub fn direction(&self, frame: usize) -> DVec3 {
        let side = self.side as usize;
        assert!(frame < side * side, "there are {} frames, not {frame}", side * side);
        self.decode(DVec2::new(self.coordinate(frame % side), self.coordinate(frame / side)))
    }

    fn coordinate(&self, at: usize) -> f64 {
        let cells = f64::from(self.side - 1);
        (2.0 * at as f64 - cells) / cells
    }

    /// The three frames around a direction and how much each counts: weights ≥ 0 with a sum of 1. The direction is
    /// inside the triangle between them.
    pub fn frames(&self, direction: DVec3) -> [(usize, f64); 3] {
        let cells = self.side as usize - 1;
        let at = (self.encode(direction) + 1.0) * 0.5 * cells as f64;
        let cell = |x: f64| (x.floor().max(0.0) as usize).min(cells - 1);
        let (column, row) = (cell(at.x), cell(at.y));
        let within = |x: f64, cell: usize| (x - cell as f64).clamp(0.0, 1.0);
        let (x, y) = (within(at.x, column), within(at.y, row));
        let corner = |right: usize, up: usize| (row + up) * self.side as usize + column + right;
        let (low, high) = (corner(0, 0), corner(1, 1));
        let (right, up) = (corner(1, 0), corner(0, 1));
        match (self.rises(column, row), x >= y, x + y <= 1.0) {
            (true, true, _) => [(low, 1.0 - x), (right, x - y), (high, y)],
            (true, false, _) => [(low, 1.0 - y), (up, y - x), (high, x)],
            (false, _, true) => [(low, 1.0 - x - y), (right, x), (up, y)],
            (false, _, false) => [(high, x + y - 1.0), (right, 1.0 - y), (up, 1.0 - x)],
        }
    }

    /// Whether a cell is cut from low to high: with the fold of the octahedron that goes through its quarter.
    fn rises(&self, column: usize, row: usize) -> bool {
        let middle = (self.side as usize - 1) / 2;
        ((column >= middle) == (row >= middle)) == self.hemisphere
    }

    /// All triangles of the grid.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let side = self.side as usize;
        let cells = (0..side - 1).flat_map(move |row| (0..side - 1).map(move |column| (column, row)));
        cells.flat_map(move |(column, row)| {
            let low = row * side + column;
            let (right, up, high) = (low + 1, low + side, low + side + 1);
            if self.rises(column, row) {
                [[low, right, high], [low, up, high]]
            } else {
                [[low, right, up], [high, right, up]]
            }
        })
    }

    /// Whether a frame is at the border of the square: of a hemisphere, on the horizon.
    pub(super) fn is_border(&self, frame: usize) -> bool {
        let side = self.side as usize;
        [frame % side, frame / side].iter().any(|&at| at == 0 || at == side - 1)
    }
}

/// The outer triangles of the square, over the diagonals to the inner ones and back.
fn folded(at: DVec2) -> DVec2 {
    let sign = |x: f64| if x < 0.0 { -1.0 } else { 1.0 };
    DVec2::new((1.0 - at.y.abs()) * sign(at.x), (1.0 - at.x.abs()) * sign(at.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = DVec3> {
        let part = -1.0..1.0_f64;
        prop::array::uniform3(part)
            .prop_map(DVec3::from_array)
            .prop_filter("a direction", |d| d.length() > 1e-3)
    }

    proptest! {
        #[test]
        fn directions_come_back(d in direction(), side in 3..31_u32) {
            for hemisphere in [false, true] {
                let d = if hemisphere { DVec3::new(d.x, d.y.abs(), d.z) } else { d };
                let map = Octahedron::new(side, hemisphere);
                let at = map.encode(d);
                prop_assert!(at.abs().max_element() <= 1.0 + 1e-15);
                prop_assert!(map.decode(at).distance(d.normalize()) < 1e-12);
            }
        }

        /// The direction is a sum of those of its frames, with weights that are not negative.
        #[test]
        fn a_direction_is_inside_the_triangle_of_its_frames(d in direction(), side in 3..31_u32) {
            for hemisphere in [false, true] {
                let d = if hemisphere { DVec3::new(d.x, d.y.abs(), d.z) } else { d };
                let map = Octahedron::new(side, hemisphere);
                let frames = map.frames(d);
                prop_assert!(frames.iter().all(|&(_, weight)| weight >= 0.0));
                prop_assert!((frames.iter().map(|&(_, weight)| weight).sum::<f64>() - 1.0).abs() < 1e-12);
                let corner = |frame| { let at: DVec3 = map.direction(frame); at / at.abs().element_sum() };
                let mean: DVec3 = frames.iter().map(|&(frame, weight)| weight * corner(frame)).sum();
                prop_assert!(mean.normalize().distance(d.normalize()) < 1e-9);
                prop_assert!(map.triangles().any(|t| frames.iter().all(|(frame, _)| t.contains(frame))));
            }
        }
    }

    #[test]
    fn the_middle_is_above_and_the_corners_below_or_on_the_horizon() {
        for side in [3, 9] {
            let (whole, half) = (Octahedron::new(side, false), Octahedron::new(side, true));
            let middle = (side * side / 2) as usize;
            assert_eq!((whole.direction(middle), half.direction(middle)), (DVec3::Y, DVec3::Y));
            assert_eq!(whole.direction(0), -DVec3::Y);
            assert!((0..middle).filter(|&f| half.is_border(f)).all(|f| half.direction(f).y.abs() < 1e-15));
        }
    }

    #[test]
    fn what_is_below_a_hemisphere_is_taken_from_the_horizon() {
        let map = Octahedron::new(9, true);
        let (below, level) = (DVec3::new(0.4, -0.5, -0.3), DVec3::new(0.4, 0.0, -0.3));
        assert_eq!(map.encode(below), map.encode(level));
        let counting = map.frames(below).into_iter().filter(|&(_, weight)| weight > 1e-12);
        assert!(counting.map(|(frame, _)| frame).all(|frame| map.is_border(frame)));
        assert!(map.decode(map.encode(-DVec3::Y)).is_finite());
    }
}
