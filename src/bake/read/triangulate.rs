//! Polygons into triangles.

use std::collections::VecDeque;

use glam::{DVec2, DVec3, Vec3};

/// Cuts polygons: convex ones into a fan about their first corner, others by clipping ears (Meisters, *Polygons have
/// ears*, 1975; the bookkeeping after Eberly, *Triangulation by ear clipping*, 2002).
///
/// A polygon in space is seen along its normal by Newell (Sutherland, Sproull & Schumacker 1974). Polygons that cut
/// themselves or have no area get as many triangles as others, which then overlap or have no area.
pub(in crate::bake) struct Triangulator {
    /// How many more tests of a corner against an ear may be made.
    effort: u64,
    ring: Ring,
}

/// Of one file: about ten seconds. Every corner may block every ear, so a concave polygon takes quadratic time; one
/// of a thousand corners takes a thousandth of this.
const EFFORT: u64 = 1 << 31;

impl Default for Triangulator {
    fn default() -> Self {
        Self { effort: EFFORT, ring: Ring::default() }
    }
}

/// The polygons of the file are too much work.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::bake) struct TooConcave;

impl Triangulator {
    /// Calls `emit` with the corners of each triangle: n − 2 of them, that run the way the polygon does. Positions may
    /// be infinite or no number.
    pub(in crate::bake) fn cut(
        &mut self,
        polygon: &[Vec3],
        mut emit: impl FnMut([u32; 3]),
    ) -> Result<(), TooConcave> {
        if polygon.len() > 3 && self.ring.project(polygon) && !self.ring.is_convex() {
            return self.ring.clip(&mut self.effort, emit);
        }
        (2..polygon.len() as u32).for_each(|i| emit([0, i - 1, i]));
        Ok(())
    }
}

/// The corners that are left, in a ring.
#[derive(Default)]
struct Ring {
    points: Vec<DVec2>,
    next: Vec<u32>,
    previous: Vec<u32>,
    gone: Vec<bool>,
    /// Corners that may lie within an ear: those that are not convex. Convex ones are weeded out as they are met.
    blocking: Vec<u32>,
}

impl Ring {
    /// Lays the polygon into the plane it is closest to, counter-clockwise. False where it has no normal.
    fn project(&mut self, polygon: &[Vec3]) -> bool {
        let origin = polygon[0].as_dvec3();
        let at = |i: usize| polygon[i % polygon.len()].as_dvec3() - origin;
        let normal: DVec3 = (0..polygon.len()).map(|i| at(i).cross(at(i + 1))).sum();
        let axis = normal.abs().max_position();
        if !normal.is_finite() || normal[axis] == 0.0 {
            return false;
        }
        let (u, v) = if normal[axis] > 0.0 { (axis + 1, axis + 2) } else { (axis + 2, axis + 1) };
        let flat = |i| DVec2::new(at(i)[u % 3], at(i)[v % 3]);
        self.points.clear();
        self.points.extend((0..polygon.len()).map(flat));
        true
    }

    fn is_convex(&mut self) -> bool {
        let n = self.points.len();
        (0..n).all(|i| turn(self.points[(i + n - 1) % n], self.points[i], self.points[(i + 1) % n]) > 0.0)
    }

    fn clip(&mut self, effort: &mut u64, mut emit: impl FnMut([u32; 3])) -> Result<(), TooConcave> {
        self.close();
        let mut left = self.points.len();
        let mut waiting: VecDeque<u32> = (0..left as u32).collect();
        let (mut last, mut searches) = (0, 0);
        while left > 3 {
            let ear = match waiting.pop_front() {
                Some(corner) if self.gone[corner as usize] || !self.is_ear(corner, effort)? => continue,
                Some(ear) => ear,
                // A polygon that does not cut itself has an ear left; one look at all corners again, but not for ever.
                None if searches < MOST_SEARCHES => {
                    searches += 1;
                    waiting.extend((0..self.points.len() as u32).filter(|&i| !self.gone[i as usize]));
                    continue;
                }
                None => last,
            };
            emit(self.around(ear));
            let [before, _, after] = self.remove(ear);
            waiting.extend([before, after]);
            last = after;
            left -= 1;
        }
        emit(self.around(last_left(&self.gone)));
        Ok(())
    }

    fn close(&mut self) {
        let n = self.points.len() as u32;
        self.next = (1..n).chain([0]).collect();
        self.previous = [n - 1].into_iter().chain(0..n - 1).collect();
        self.gone = vec![false; n as usize];
        self.blocking = (0..n).filter(|&i| self.turn_at(i) <= 0.0).collect();
    }

    fn around(&self, corner: u32) -> [u32; 3] {
        [self.previous[corner as usize], corner, self.next[corner as usize]]
    }

    fn turn_at(&self, corner: u32) -> f64 {
        let [a, b, c] = self.around(corner).map(|i| self.points[i as usize]);
        turn(a, b, c)
    }

    /// Whether the corner is convex and no other corner lies in its triangle.
    fn is_ear(&mut self, corner: u32, effort: &mut u64) -> Result<bool, TooConcave> {
        if self.turn_at(corner) <= 0.0 {
            return Ok(false);
        }
        let triangle = self.around(corner).map(|i| self.points[i as usize]);
        let mut at = 0;
        while let Some(&other) = self.blocking.get(at) {
            *effort = effort.checked_sub(1).ok_or(TooConcave)?;
            if self.gone[other as usize] || self.turn_at(other) > 0.0 {
                self.blocking.swap_remove(at);
            } else if holds(triangle, self.points[other as usize]) {
                return Ok(false);
            } else {
                at += 1;
            }
        }
        Ok(true)
    }

    /// Takes the corner out. Its neighbours may have turned into blocking ones where it was no ear.
    fn remove(&mut self, corner: u32) -> [u32; 3] {
        let [before, corner, after] = self.around(corner);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.gone[corner as usize] = true;
        for i in [before, after] {
            if self.turn_at(i) <= 0.0 && !self.blocking.contains(&i) {
                self.blocking.push(i);
            }
        }
        [before, corner, after]
    }
}

/// How often all corners are looked at again where no ear is known.
const MOST_SEARCHES: u32 = 8;

/// The first corner of a ring of three.
fn last_left(gone: &[bool]) -> u32 {
    gone.iter().position(|&gone| !gone).map_or(0, |i| i as u32 + 1).saturating_sub(1)
}

/// Twice the signed area: above 0 where a, b, c turn left.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - b)
}

/// Whether the triangle or its border holds the point. Points on a corner of it are let pass: polygons with a hole are
/// written with a bridge, whose ends come twice.
fn holds([a, b, c]: [DVec2; 3], p: DVec2) -> bool {
    let inside = turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    inside && p != a && p != b && p != c
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cut(polygon: &[Vec3]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        Triangulator::default().cut(polygon, |t| triangles.push(t)).expect("little work");
        triangles
    }

    fn flat(points: &[[f32; 2]]) -> Vec<Vec3> {
        points.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect()
    }

    fn area([a, b, c]: [Vec3; 3]) -> f32 {
        (b - a).truncate().perp_dot((c - a).truncate()) * 0.5
    }

    /// The areas of the triangles.
    fn areas(polygon: &[Vec3]) -> Vec<f32> {
        cut(polygon).into_iter().map(|t| area(t.map(|i| polygon[i as usize]))).collect()
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        assert_eq!(cut(&flat(&[[0., 0.], [1., 0.], [2., 1.], [0., 1.]])), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(cut(&flat(&[[0., 0.], [1., 0.], [2., 1.]])), [[0, 1, 2]]);
        assert!(cut(&flat(&[[0., 0.], [1., 0.]])).is_empty() && cut(&[]).is_empty());
    }

    #[test]
    fn a_concave_polygon_has_no_triangle_outside() {
        let arrow = flat(&[[0., 0.], [2., 1.], [0., 2.], [1., 1.]]);
        assert_eq!(areas(&arrow).into_iter().fold(0.0, |sum, a| sum + a.abs()), 1.0);
        let comb = flat(&[[0., 0.], [5., 0.], [5., 3.], [4., 1.], [3., 3.], [2., 1.], [1., 3.], [0., 1.]]);
        assert!(areas(&comb).iter().all(|&a| a > 0.0));
    }

    #[test]
    fn corners_in_a_line_give_no_flat_triangle() {
        let square = flat(&[[0., 0.], [1., 0.], [2., 0.], [2., 2.], [1., 2.], [0., 2.]]);
        assert_eq!(areas(&square).len(), 4);
        assert!(areas(&square).iter().all(|&a| a > 0.0), "{:?}", areas(&square));
    }

    #[test]
    fn a_hole_with_a_bridge_stays_open() {
        let ring = flat(&[
            [0., 0.],
            [4., 0.],
            [4., 4.],
            [0., 4.],
            [0., 0.],
            [1., 1.],
            [1., 3.],
            [3., 3.],
            [3., 1.],
            [1., 1.],
        ]);
        let areas = areas(&ring);
        assert_eq!((areas.len(), areas.iter().sum::<f32>()), (8, 12.0));
        assert!(areas.iter().all(|&a| a >= 0.0), "{areas:?}");
    }

    #[test]
    fn a_polygon_that_goes_round_and_round_ends() {
        let square = [[0., 0.], [1., 0.], [1., 1.], [0., 1.]];
        let wound = flat(&square.repeat(60));
        assert_eq!(cut(&wound).len(), 238);
        let eight = flat(&[[0., 0.], [2., 2.], [2., 0.], [0., 2.], [1., 5.]]);
        assert_eq!(cut(&eight).len(), 3);
        assert_eq!(cut(&[Vec3::NAN; 7]).len(), 5);
        assert_eq!(cut(&[Vec3::MAX, Vec3::MIN, Vec3::MAX, Vec3::ZERO, Vec3::X]).len(), 3);
    }

    #[test]
    fn too_much_work_is_refused() {
        let zigzag = (0..100).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0));
        let polygon: Vec<Vec3> = zigzag.chain([Vec3::new(50.0, 90.0, 0.0)]).collect();
        let mut poor = Triangulator { effort: 10, ..Triangulator::default() };
        assert_eq!(poor.cut(&polygon, |_| ()), Err(TooConcave));
    }

    proptest! {
        /// Stars about the origin do not cut themselves: all triangles run the same way and fill the polygon.
        #[test]
        fn stars_are_filled_exactly(radii in prop::collection::vec(0.1f32..10.0, 5..60), axis in 0usize..3) {
            let angle = |i: usize| i as f32 / radii.len() as f32 * std::f32::consts::TAU;
            let star: Vec<Vec3> = radii.iter().enumerate().map(|(i, r)| {
                let mut p = [0.25; 3];
                p[(axis + 1) % 3] = r * angle(i).cos();
                p[(axis + 2) % 3] = r * angle(i).sin();
                Vec3::from(p)
            }).collect();
            let doubled = |[a, b, c]: [Vec3; 3]| (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3())[axis];
            let whole: f64 = (0..star.len()).map(|i| {
                star[i].as_dvec3().cross(star[(i + 1) % star.len()].as_dvec3())[axis]
            }).sum();
            let parts: Vec<f64> = cut(&star).into_iter().map(|t| doubled(t.map(|i| star[i as usize]))).collect();
            prop_assert_eq!(parts.len(), star.len() - 2);
            prop_assert!(parts.iter().all(|&a| a >= -1e-9), "{:?}", parts);
            prop_assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-6 * whole);
        }

        #[test]
        fn any_polygon_gets_all_its_triangles(points in prop::collection::vec(prop::array::uniform3(-2i8..3), 3..40)) {
            let polygon: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
            let triangles = cut(&polygon);
            prop_assert_eq!(triangles.len(), polygon.len() - 2);
            prop_assert!(triangles.iter().flatten().all(|&i| (i as usize) < polygon.len()));
        }
    }
}
