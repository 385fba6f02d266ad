//! How far a point is from a triangle: fast, for distances that order things. Those that are told are measured by
//! `deviation`.

use glam::DVec3;

/// The squared distance from `point` to the nearest point of a triangle, or `least` if that is less or the triangle has
/// no area. Without branches.
#[inline(always)]
pub(super) fn distance2(point: DVec3, [a, b, c]: [DVec3; 3], least: f64) -> f64 {
    let (side, last, from_a) = (b - a, c - a, point - a);
    let across = side.cross(last);
    let across2 = across.length_squared();
    let height = from_a.dot(across);
    let beyond_side = side.cross(from_a).dot(across);
    let beyond_last = from_a.cross(last).dot(across);
    let is_above = (beyond_side >= 0.0) & (beyond_last >= 0.0) & (beyond_side + beyond_last <= across2);
    let to_sides = [(from_a, side), (point - b, c - b), (from_a, last)]
        .map(|(from_start, side)| distance2_to_side(from_start, side));
    let to_border = lesser(lesser(to_sides[0], to_sides[1]), to_sides[2]);
    lesser(least, if is_above { height * height / across2 } else { to_border })
}

/// The lesser of two numbers, the first if the second is none.
#[inline(always)]
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// The squared distance of a point to a segment, both seen from the segment's start.
#[inline(always)]
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
