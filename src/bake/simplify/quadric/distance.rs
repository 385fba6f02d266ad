//! How far a point is from a triangle: fast, for distances that order things. Those that are told are measured by
//! `deviation`.

use glam::DVec3;

/// The squared distance from `point` to the nearest point of a triangle; not a number for one without area.
#[inline]
pub(super) fn distance2(point: DVec3, corners: [DVec3; 3]) -> f64 {
    let [a, b, c] = corners;
    let across = (b - a).cross(c - a);
    let sides = [(a, b - a), (b, c - b), (c, a - c)];
    let is_inside = |(start, side): &(DVec3, DVec3)| side.cross(point - *start).dot(across) >= 0.0;
    if sides.iter().all(is_inside) {
        (point - a).dot(across).powi(2) / across.length_squared()
    } else {
        sides
            .iter()
            .map(|&(start, side)| distance2_to_side(point - start, side))
            .fold(f64::INFINITY, f64::min)
    }
}

/// The squared distance of a point to a segment, both seen from the segment's start.
#[inline]
fn distance2_to_side(point: DVec3, side: DVec3) -> f64 {
    let share = (point.dot(side) / side.length_squared()).clamp(0.0, 1.0);
    point.distance_squared(share * side)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn no_point_of_the_triangle_is_nearer_and_one_is_as_near(p in point(), corners in [point(), point(), point()]) {
            let across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            prop_assume!(across.length() > 0.05);
            const STEPS: u32 = 64;
            let weights = (0..=STEPS).flat_map(|i| (0..=STEPS - i).map(move |j| [i, j, STEPS - i - j]));
            let places = weights.map(|w| (0..3).map(|k| f64::from(w[k]) / f64::from(STEPS) * corners[k]).sum::<DVec3>());
            let nearest = places.map(|q| p.distance(q)).fold(f64::INFINITY, f64::min);
            let distance = distance2(p, corners).sqrt();
            prop_assert!(distance <= nearest + 1e-9 && nearest <= distance + 4.0 / f64::from(STEPS));
        }
    }
}
