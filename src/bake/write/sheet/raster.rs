//! Which triangle a sample shows: a depth buffer over a square of samples.
//!
//! Corners are put on a grid of 256 steps a sample and tested in integers, as graphics cards do, so that triangles that
//! share an edge leave no gap between them (Pineda, *A parallel algorithm for polygon rasterization*, 1988). A sample
//! on an edge belongs to both.

use glam::DVec3;

use super::camera::Camera;
use crate::bake::mesh::Mesh;

/// What each sample shows, row by row from the top.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    /// Samples each way.
    pub(super) side: usize,
    /// Or [`NOTHING`].
    pub(super) triangle: Vec<u32>,
    /// In samples towards the viewer; −∞ where there is nothing.
    pub(super) depth: Vec<f32>,
}

/// The triangle that is none.
pub(super) const NOTHING: u32 = u32::MAX;

/// Steps of the grid in a sample.
const STEPS: i64 = 256;

/// Corners farther out, in steps, are pulled in, so that products stay within 64 bits. Nothing of a mesh that fits its
/// camera is, not even from near.
const FARTHEST: i64 = 1 << 29;

impl Frame {
    /// What the camera sees of the mesh. Of triangles equally near, the first.
    pub(super) fn of(mesh: &Mesh, camera: &Camera) -> Self {
        let samples = camera.side * camera.side;
        let (triangle, depth) = (vec![NOTHING; samples], vec![f32::NEG_INFINITY; samples]);
        let mut frame = Self { side: camera.side, triangle, depth };
        let places: Vec<DVec3> = mesh.positions.iter().map(|&p| camera.place(p)).collect();
        for triangle in 0..mesh.triangles.len() {
            let corners = mesh.corners(triangle).map(|p| places[p as usize]);
            if let Some(facet) = Facet::of(corners) {
                frame.draw(triangle as u32, &facet);
            }
        }
        frame
    }

    fn draw(&mut self, triangle: u32, facet: &Facet) {
        let ([left, right], [top, bottom]) = (facet.span(0, self.side), facet.span(1, self.side));
        for y in top..bottom {
            for x in left..right {
                let Some(weights) = facet.weights(x, y) else { continue };
                let depth = facet.depth(weights);
                let sample = y * self.side + x;
                if depth > self.depth[sample] {
                    (self.depth[sample], self.triangle[sample]) = (depth, triangle);
                }
            }
        }
    }
}

/// A triangle on the grid.
#[derive(Clone, Debug)]
pub(super) struct Facet {
    corners: [[i64; 2]; 3],
    depths: [f64; 3],
    /// Twice the area in steps; above 0 where the front, which is counter-clockwise, is seen.
    area: i64,
}

impl Facet {
    /// `None` for a triangle that is seen edge on, or is too small for the grid.
    pub(super) fn of(corners: [DVec3; 3]) -> Option<Self> {
        // What is no number becomes 0.
        let step = |x: f64| ((x * STEPS as f64).round() as i64).clamp(-FARTHEST, FARTHEST);
        let on_grid = corners.map(|c| [step(c.x), step(c.y)]);
        let [a, b, c] = on_grid;
        let area = -doubled_area(a, b, c);
        (area != 0).then_some(Self { corners: on_grid, depths: corners.map(|c| c.z), area })
    }

    pub(super) fn is_front(&self) -> bool {
        self.area > 0
    }

    /// The samples, along an axis, whose centres may be inside.
    fn span(&self, axis: usize, side: usize) -> [usize; 2] {
        let [a, b, c] = self.corners.map(|c| c[axis]);
        let first = (a.min(b).min(c) - STEPS / 2).div_euclid(STEPS);
        let last = (a.max(b).max(c) - STEPS / 2).div_euclid(STEPS) + 1;
        [first, last].map(|at| at.clamp(0, side as i64) as usize)
    }

    /// How much each corner counts at the centre of a sample, with a sum of 1; `None` outside.
    pub(super) fn weights(&self, x: usize, y: usize) -> Option<[f64; 3]> {
        let at = [x, y].map(|x| x as i64 * STEPS + STEPS / 2);
        let [a, b, c] = self.corners;
        let sign = -self.area.signum();
        let parts =
            [doubled_area(at, b, c), doubled_area(a, at, c), doubled_area(a, b, at)].map(|part| part * sign);
        let whole = self.area.abs() as f64;
        parts.iter().all(|&part| part >= 0).then(|| parts.map(|part| part as f64 / whole))
    }

    fn depth(&self, weights: [f64; 3]) -> f32 {
        weights.iter().zip(self.depths).map(|(w, depth)| w * depth).sum::<f64>() as f32
    }

    /// How far each edge is from the corner across it, in samples.
    pub(super) fn heights(&self) -> [f64; 3] {
        let [a, b, c] = self.corners.map(|[x, y]| glam::DVec2::new(x as f64, y as f64));
        [b.distance(c), c.distance(a), a.distance(b)].map(|edge| self.area.abs() as f64 / edge / STEPS as f64)
    }
}

/// Above 0 where the corners are clockwise on a page whose y points down.
fn doubled_area([ax, ay]: [i64; 2], [bx, by]: [i64; 2], [cx, cy]: [i64; 2]) -> i64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIDE: usize = 24;

    fn drawn(facets: &[[DVec3; 3]]) -> Frame {
        let (triangle, depth) = (vec![NOTHING; SIDE * SIDE], vec![f32::NEG_INFINITY; SIDE * SIDE]);
        let mut frame = Frame { side: SIDE, triangle, depth };
        for (i, facet) in facets.iter().enumerate() {
            if let Some(facet) = Facet::of(*facet) {
                frame.draw(i as u32, &facet);
            }
        }
        frame
    }

    fn at(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    #[test]
    fn a_half_square_covers_half_its_samples() {
        let frame = drawn(&[[at(0.0, 0.0, 0.0), at(0.0, 10.0, 0.0), at(10.0, 0.0, 0.0)]]);
        for y in 0..SIDE {
            let row = &frame.triangle[y * SIDE..][..SIDE];
            let covered = row.iter().filter(|&&t| t == 0).count();
            assert_eq!(covered, 10_usize.saturating_sub(y), "row {y}");
        }
    }

    #[test]
    fn the_nearer_one_is_seen_and_the_first_of_equals() {
        let facet = |z: f64| [at(0.0, 0.0, z), at(0.0, 30.0, z), at(30.0, 0.0, z)];
        let frame = drawn(&[facet(1.0), facet(2.0), facet(2.0), facet(0.0)]);
        assert!(frame.triangle.iter().all(|&t| t == 1 || t == NOTHING));
        assert_eq!(frame.depth[0], 2.0);
    }

    #[test]
    fn fronts_are_counter_clockwise_to_the_eye() {
        let (a, b, c) = (at(0.0, 10.0, 0.0), at(10.0, 10.0, 0.0), at(0.0, 0.0, 0.0));
        assert!(Facet::of([a, b, c]).is_some_and(|f| f.is_front()), "y points down");
        assert!(Facet::of([a, c, b]).is_some_and(|f| !f.is_front()));
        assert!(Facet::of([a, b, b]).is_none());
    }

    #[test]
    fn what_is_far_out_or_no_number_does_no_harm() {
        let strange = [f64::NAN, f64::INFINITY, -1e300, 1e300, 12.0];
        for x in strange {
            for y in strange {
                drawn(&[[at(x, y, x), at(y, 3.0, 0.0), at(2.0, x, 1.0)]]);
            }
        }
    }

    proptest! {
        /// Against half planes in floating point, for corners on the grid, where those are exact as well.
        #[test]
        fn coverage_is_what_half_planes_say(corners in prop::array::uniform6(-64..448_i32)) {
            let [ax, ay, bx, by, cx, cy] = corners.map(|c| f64::from(c) / 16.0);
            let triangle = [at(ax, ay, 0.0), at(bx, by, 0.0), at(cx, cy, 0.0)];
            let frame = drawn(&[triangle]);
            let cross = |p: DVec3, q: DVec3, r: DVec3| (q - p).cross(r - p).z;
            let area = cross(triangle[0], triangle[1], triangle[2]);
            for (i, &seen) in frame.triangle.iter().enumerate() {
                let p = at((i % SIDE) as f64 + 0.5, (i / SIDE) as f64 + 0.5, 0.0);
                let inside = (0..3).all(|k| cross(triangle[k], triangle[(k + 1) % 3], p) * area >= 0.0);
                prop_assert_eq!(seen == 0, inside && area != 0.0);
            }
        }

        /// A fan of any corners around a point within leaves no gap.
        #[test]
        fn neighbours_leave_no_gap(
            x in 1.0..23.0,
            y in 1.0..23.0,
            turns in prop::collection::btree_set(0..1000_u32, 3..9),
        ) {
            let hub = at(x, y, 0.0);
            let rim: Vec<DVec3> = turns.iter().map(|&turn| {
                let angle = f64::from(turn) * std::f64::consts::TAU / 1000.0;
                hub + at(angle.cos(), angle.sin(), 0.0) * 1e4
            }).collect();
            let widest = turns.iter().zip(turns.iter().cycle().skip(1)).map(|(a, b)| (b + 1000 - a) % 1000).max();
            prop_assume!(widest.is_some_and(|gap| gap < 490));
            let fan: Vec<_> = (0..rim.len()).map(|i| [hub, rim[i], rim[(i + 1) % rim.len()]]).collect();
            prop_assert!(drawn(&fan).triangle.iter().all(|&t| t != NOTHING));
        }
    }
}
