//! The exact distance from a point to a triangle, whatever the triangle's shape.

use glam::DVec3;

/// A triangle laid out in its own plane: its longest side is the base, from 0 to `base` on the first axis; the apex
/// lies over `foot`, `height` up the second.
///
/// With axes of unit length, distances are off by a few units in the last place of the larger of the triangle and the
/// distance itself, however thin the triangle: barycentric formulas (C. Ericson, "Real-Time Collision Detection",
/// 2005, 5.1.5) divide by the area and lose needles. A segment is a facet without height, a point one without base.
#[derive(Clone, Copy, Debug)]
pub(super) struct Facet {
    corner: DVec3,
    along: DVec3,
    across: DVec3,
    base: f64,
    foot: f64,
    height: f64,
    /// One over the squared lengths of the sides that rise from the base's start and end; 0 for a side without length.
    left: f64,
    right: f64,
}

impl Facet {
    pub(super) fn new(corners: [DVec3; 3]) -> Self {
        let [start, end, apex] = longest_side_first(corners);
        let (base, side) = (end - start, apex - start);
        let along = base.try_normalize().unwrap_or(DVec3::X);
        let across = perpendicular(side, along);
        let (base, foot, height) = (base.length(), side.dot(along), side.dot(across).max(0.0));
        let (left, right) = (inverse_square(foot, height), inverse_square(base - foot, height));
        Self { corner: start, along, across, base, foot, height, left, right }
    }

    pub(super) fn area(&self) -> f64 {
        0.5 * self.base * self.height
    }

    /// Height over base; 0 without a base.
    pub(super) fn slenderness(&self) -> f64 {
        if self.base > 0.0 { self.height / self.base } else { 0.0 }
    }

    /// A corner, and unit vectors along the base and towards the apex: what is counter-clockwise stays so.
    pub(super) fn frame(&self) -> (DVec3, [DVec3; 2]) {
        (self.corner, [self.along, self.across])
    }

    /// The squared distance from `point` to the nearest point of the triangle.
    #[inline]
    pub(super) fn distance2(&self, point: DVec3) -> f64 {
        let offset = point - self.corner;
        let (x, y) = (offset.dot(self.along), offset.dot(self.across));
        let away = offset - self.along * x - self.across * y;
        away.length_squared() + self.distance2_in_plane(x, y)
    }

    /// Whether a point of the plane is inside.
    #[inline]
    fn holds(&self, x: f64, y: f64) -> bool {
        let in_box = x >= 0.0 && x <= self.base && y >= 0.0 && y <= self.height;
        let beyond_left = x * self.height < y * self.foot;
        let beyond_right = (self.base - x) * self.height < y * (self.base - self.foot);
        in_box && !beyond_left && !beyond_right
    }

    fn distance2_in_plane(&self, x: f64, y: f64) -> f64 {
        if self.holds(x, y) {
            return 0.0;
        }
        let from_base = square(x - x.clamp(0.0, self.base)) + y * y;
        let from_left = from_side([x, y], [self.foot, self.height], self.left);
        let from_right = from_side([x - self.base, y], [self.foot - self.base, self.height], self.right);
        from_base.min(from_left).min(from_right)
    }
}

/// How much of each corner there is in the point of a triangle that is nearest to `point`: three numbers ≥ 0 with a sum
/// of 1, but for rounding. In a needle they tell as much of a place as there is to tell.
pub(super) fn nearest_weights(corners: &[DVec3; 3], point: DVec3) -> [f64; 3] {
    let first = longest_side(corners);
    let weights = Facet::new(*corners).nearest_weights(point);
    std::array::from_fn(|k| weights[(k + 3 - first) % 3])
}

impl Facet {
    /// The weights of base's start, its end, and the apex.
    fn nearest_weights(&self, point: DVec3) -> [f64; 3] {
        let offset = point - self.corner;
        let [x, y] = [offset.dot(self.along), offset.dot(self.across)];
        if self.holds(x, y) && self.height > 0.0 {
            let apex = y / self.height;
            let end = ((x - apex * self.foot) / self.base).clamp(0.0, 1.0 - apex);
            return [1.0 - apex - end, end, apex];
        }
        let base = if self.base > 0.0 { (x / self.base).clamp(0.0, 1.0) } else { 0.0 };
        let left = along_side([x, y], [self.foot, self.height], self.left);
        let right = along_side([x - self.base, y], [self.foot - self.base, self.height], self.right);
        let sides = [[1.0 - base, base, 0.0], [1.0 - left, 0.0, left], [0.0, 1.0 - right, right]];
        let far = |[_, end, apex]: [f64; 3]| {
            square(x - end * self.base - apex * self.foot) + square(y - apex * self.height)
        };
        sides.into_iter().fold(sides[0], |best, side| if far(side) < far(best) { side } else { best })
    }
}

/// The corners in their cyclic order, such that no side is longer than the first.
fn longest_side_first(corners: [DVec3; 3]) -> [DVec3; 3] {
    let first = longest_side(&corners);
    std::array::from_fn(|k| corners[(first + k) % 3])
}

/// The corner from which the longest side leads to the next; the first of equals.
fn longest_side([a, b, c]: &[DVec3; 3]) -> usize {
    let (ab, bc, ca) = (a.distance_squared(*b), b.distance_squared(*c), c.distance_squared(*a));
    if ab >= bc && ab >= ca {
        0
    } else if bc >= ca {
        1
    } else {
        2
    }
}

/// The unit vector at a right angle to `along`, on the side of `side`; any where `side` is parallel but for rounding.
///
/// Projected twice, as part of what is left of a needle's side is rounding after the first time. What the second time
/// takes most of was nothing but rounding ("twice is enough": B. N. Parlett, "The Symmetric Eigenvalue Problem", 1980).
fn perpendicular(side: DVec3, along: DVec3) -> DVec3 {
    let once = (side - along * side.dot(along)).try_normalize();
    let twice = once.map(|v| v - along * v.dot(along)).filter(|v| v.length_squared() > 0.5);
    twice.map_or_else(|| along.any_orthonormal_vector(), DVec3::normalize)
}

fn inverse_square(x: f64, y: f64) -> f64 {
    let inverse = (x * x + y * y).recip();
    if inverse.is_finite() { inverse } else { 0.0 }
}

fn square(x: f64) -> f64 {
    x * x
}

/// The squared distance from a point to the segment from the origin to `end`, whose squared length is 1 ÷ `inverse`.
fn from_side([x, y]: [f64; 2], end: [f64; 2], inverse: f64) -> f64 {
    let t = along_side([x, y], end, inverse);
    square(x - t * end[0]) + square(y - t * end[1])
}

/// How far along that segment the nearest of its points is, from 0 to 1.
#[inline]
fn along_side([x, y]: [f64; 2], end: [f64; 2], inverse: f64) -> f64 {
    ((x * end[0] + y * end[1]) * inverse).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from)
    }

    proptest! {
        /// Seen from over or beside a point of the triangle, with the height that is left to an apex near the base.
        #[test]
        fn distance_is_that_to_the_nearest_point_however_thin_the_triangle(
            a in point(), b in point(), c in point(), p in point(), along in 0.0..1.0_f64, thin in 0.0..17.0_f64, weights in point()
        ) {
            let foot = a.lerp(b, along);
            let corners = [a, b, foot.lerp(c, 10.0_f64.powf(-thin))];
            let facet = Facet::new(corners);
            let distance = facet.distance2(p).sqrt();
            let weights = (weights.abs() + 1e-9) / (weights.abs() + 1e-9).element_sum();
            let within = corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z;
            prop_assert!(facet.distance2(within).sqrt() < 2e-15);
            prop_assert!(distance <= p.distance(within) + 2e-15);
            // No point of a triangle is farther from its longest side than its height is long.
            let base = (0..200).map(|k| p.distance(a.lerp(b, f64::from(k) / 199.0))).fold(f64::INFINITY, f64::min);
            prop_assert!(distance >= base - 2e-2 - c.distance(foot) * 10.0_f64.powf(-thin));
        }

        #[test]
        fn weights_are_those_of_the_nearest_point(a in point(), b in point(), c in point(), p in point(), thin in 0.0..17.0_f64) {
            for corners in [[a, b, c], [a, b, a.lerp(b, 0.3).lerp(c, 10.0_f64.powf(-thin))], [b, b, c], [c, c, c]] {
                let weights = nearest_weights(&corners, p);
                let place: DVec3 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum();
                prop_assert!(weights.iter().all(|&weight| weight >= 0.0));
                prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                prop_assert!((place.distance(p) - Facet::new(corners).distance2(p).sqrt()).abs() < 1e-14);
            }
        }

        #[test]
        fn corners_in_any_order_make_the_same_triangle(a in point(), b in point(), c in point(), p in point()) {
            let all = [[a, b, c], [b, c, a], [c, a, b], [a, c, b]].map(|corners| Facet::new(corners).distance2(p));
            prop_assert!(all.iter().all(|d| (d.sqrt() - all[0].sqrt()).abs() < 1e-14));
        }
    }

    /// What is left of a side that is all but parallel is rounding, and may point along the base.
    #[test]
    fn a_segment_in_any_direction_has_axes_at_a_right_angle() {
        for k in 0..2000 {
            let t = f64::from(k);
            let (a, b) = (DVec3::new(t.sin(), 0.1, t.cos()), DVec3::new(0.3, (1.7 * t).sin(), 0.5));
            for corners in [[a, b, b], [a, b, a], [a, a, b], [a, b, a.lerp(b, 0.3)]] {
                let (_, [along, across]) = Facet::new(corners).frame();
                assert!(
                    along.dot(across).abs() < 1e-15 && (across.length() - 1.0).abs() < 1e-15,
                    "{corners:?}"
                );
            }
        }
    }

    #[test]
    fn a_frame_keeps_the_turn() {
        let facet = Facet::new([DVec3::ZERO, DVec3::Y, DVec3::X * 3.0]);
        let (_, [along, across]) = facet.frame();
        assert!(along.cross(across).distance(DVec3::NEG_Z) < 1e-15);
        assert!((facet.area() - 1.5).abs() < 1e-15 && facet.slenderness() > 0.0);
    }
}
