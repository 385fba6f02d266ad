//! How far a point is from a triangle: fast, for distances that order things. Those that are told are measured by
//! `deviation`.

use glam::DVec3;

/// The squared distance from `point` to the nearest point of a triangle, or `least` if that is less or the triangle has
/// no area.
#[inline]
pub(super) fn distance2(point: DVec3, [a, b, c]: [DVec3; 3], least: f64) -> f64 {
    let (side, last, from_a) = (b - a, c - a, point - a);
    let across = side.cross(last);
    let across2 = across.length_squared();
    let height2 = from_a.dot(across).powi(2) / across2;
    let beyond_side = side.cross(from_a).dot(across);
    let beyond_last = from_a.cross(last).dot(across);
    if (beyond_side >= 0.0) & (beyond_last >= 0.0) & (beyond_side + beyond_last <= across2) {
        least.min(height2)
    } else if height2 < least {
        [(from_a, side), (point - b, c - b), (from_a, last)]
            .iter()
            .map(|&(from_start, side)| distance2_to_side(from_start, side))
            .fold(least, f64::min)
    } else {
        least
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
            let distance = distance2(p, corners, f64::INFINITY).sqrt();
            prop_assert!(distance <= nearest + 1e-9 && nearest <= distance + 4.0 / f64::from(STEPS));
        }
    }
}
