//! The quadric error of a point: a quadratic form, which is the weighted sum of squared distances to planes.

use std::ops::Add;

use glam::{DVec3, Vec3};

/// `Q(v) = vᵀAv + 2bᵀv + c`, where A is symmetric and positive semidefinite, seen from some origin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Form {
    /// Diagonal of A: xx, yy, zz.
    diagonal: DVec3,
    /// The rest of A: yz, zx, xy.
    mixed: DVec3,
    /// b.
    linear: DVec3,
    /// c.
    constant: f64,
}

/// A form as it is kept, in one cache line: seen from the vertex it belongs to.
///
/// A takes double precision, or squared distances would drown in rounding where triangles are small and nearly flat.
/// The rest does not: seen from its own vertex, b and c are as small as the error itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(super) struct Quadric {
    diagonal: [f64; 3],
    mixed: [f64; 3],
    linear: [f32; 3],
    constant: f32,
}

impl Quadric {
    /// `weight` times the squared distance to the plane through the vertex with the unit normal `normal`.
    #[inline]
    pub(super) fn plane(n: DVec3, weight: f64) -> Self {
        let (diagonal, mixed) = (weight * n * n, weight * DVec3::new(n.y * n.z, n.z * n.x, n.x * n.y));
        Self { diagonal: diagonal.to_array(), mixed: mixed.to_array(), ..Self::default() }
    }

    /// Adds what [`Quadric::plane`] is.
    #[inline]
    pub(super) fn add_plane(&mut self, n: DVec3, weight: f64) {
        let plane = Self::plane(n, weight);
        for i in 0..3 {
            self.diagonal[i] += plane.diagonal[i];
            self.mixed[i] += plane.mixed[i];
        }
    }

    /// Some of its bits, for who wants it in the cache.
    #[inline]
    pub(super) fn bits(&self) -> u32 {
        self.constant.to_bits()
    }

    #[inline]
    pub(super) fn form(&self) -> Form {
        Form {
            diagonal: DVec3::from_array(self.diagonal),
            mixed: DVec3::from_array(self.mixed),
            linear: Vec3::from_array(self.linear).as_dvec3(),
            constant: f64::from(self.constant),
        }
    }
}

impl Form {
    /// `weight` times the square of the linear function with that slope, and that value at the origin.
    #[inline]
    pub(super) fn square(slope: DVec3, value: f64, weight: f64) -> Self {
        let along = weight * slope;
        let mixed = DVec3::new(along.y * slope.z, along.z * slope.x, along.x * slope.y);
        Self { diagonal: along * slope, mixed, linear: value * along, constant: weight * value * value }
    }

    #[inline]
    pub(super) fn pack(&self) -> Quadric {
        Quadric {
            diagonal: self.diagonal.to_array(),
            mixed: self.mixed.to_array(),
            linear: self.linear.as_vec3().to_array(),
            constant: self.constant as f32,
        }
    }

    /// The same form seen from another origin.
    #[inline(always)]
    pub(super) fn seen_from(&self, origin: DVec3) -> Self {
        let along = self.times(origin);
        let constant = self.constant + origin.dot(along + 2.0 * self.linear);
        Self { linear: self.linear + along, constant, ..*self }
    }

    /// `A·v`.
    #[inline(always)]
    pub(super) fn times(&self, v: DVec3) -> DVec3 {
        let (d, m) = (self.diagonal, self.mixed);
        DVec3::new(
            d.x * v.x + m.z * v.y + m.y * v.z,
            m.z * v.x + d.y * v.y + m.x * v.z,
            m.y * v.x + m.x * v.y + d.z * v.z,
        )
    }

    /// The error at `v`, which rounding may make slightly negative.
    #[inline(always)]
    pub(super) fn at(&self, v: DVec3) -> f64 {
        v.dot(self.times(v) + 2.0 * self.linear) + self.constant
    }

    /// Half the gradient at `v`.
    #[inline(always)]
    pub(super) fn slope(&self, v: DVec3) -> DVec3 {
        self.times(v) + self.linear
    }

    /// How steep the form is along `v`: `vᵀAv`.
    #[inline]
    pub(super) fn curvature(&self, v: DVec3) -> f64 {
        v.dot(self.times(v))
    }

    /// The weight of all planes together: the trace of A.
    #[inline(always)]
    pub(super) fn weight(&self) -> f64 {
        self.diagonal.element_sum()
    }

    /// The point where `Q(v) + stiffness·tr(A)·|v − near|²` is least; not finite if A is 0. Takes some 50 operations.
    ///
    /// With no stiffness that is the least of Q itself, which is no single point on planes and along straight creases
    /// and far away where they are nearly so. With a little the point does not leave `near` without a reason.
    #[inline(always)]
    pub(super) fn least(&self, near: DVec3, stiffness: f64) -> DVec3 {
        let d = self.diagonal + stiffness * self.weight();
        let m = self.mixed;
        let cofactors = DVec3::new(d.y * d.z - m.x * m.x, d.z * d.x - m.y * m.y, d.x * d.y - m.z * m.z);
        let mixed = DVec3::new(m.y * m.z - m.x * d.x, m.z * m.x - m.y * d.y, m.x * m.y - m.z * d.z);
        let determinant = d.x * cofactors.x + m.z * mixed.z + m.y * mixed.y;
        let inverse = Self { diagonal: cofactors, mixed, ..Self::default() };
        near - inverse.times(self.slope(near)) / determinant
    }
}

impl Add for Form {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            mixed: self.mixed + other.mixed,
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    /// The form of a plane through a point, seen from the origin.
    fn plane(normal: DVec3, through: DVec3, weight: f64) -> Form {
        Quadric::plane(normal, weight).form().seen_from(-through)
    }

    proptest! {
        #[test]
        fn the_error_is_the_sum_of_squared_distances_wherever_it_is_seen_from(
            planes in prop::collection::vec((point(), point(), 0.1..2.0f64), 1..9),
            (v, origin) in (point(), point()),
        ) {
            let (mut sum, mut form) = (0.0, Form::default());
            for (normal, through, weight) in planes {
                let normal = normal.normalize_or(DVec3::X);
                sum += weight * normal.dot(v - through).powi(2);
                form = form + plane(normal, through, weight);
            }
            let near = 1e-12 * (1.0 + sum);
            prop_assert!((form.at(v) - sum).abs() < near);
            prop_assert!((form.seen_from(origin).at(v - origin) - sum).abs() < near);
        }

        #[test]
        fn a_packed_form_is_the_same_to_single_precision_of_the_error(
            (normal, through, v) in (point(), point(), point()),
        ) {
            let form = plane(normal.normalize_or(DVec3::X), through * 1e-3, 1.0);
            prop_assert!((form.pack().form().at(v) - form.at(v)).abs() < 1e-9);
        }

        #[test]
        fn no_point_nearby_is_lower_than_the_least(
            (corner, tilt, step, near) in (point(), point(), point(), point()),
        ) {
            let normals = [DVec3::X, DVec3::Y + 0.5 * tilt, DVec3::Z - 0.5 * tilt];
            let planes = normals.map(|n| plane(n.normalize(), corner, 1.0));
            let sum = planes[0] + planes[1] + planes[2];
            let least = sum.least(near, 0.0);
            prop_assert!(sum.at(least) <= sum.at(least + step) + 1e-9);
        }
    }

    #[test]
    fn on_a_plane_the_least_is_the_foot_of_where_one_stands() {
        let plane = plane(DVec3::Z, DVec3::new(9.0, 9.0, 1.0), 3.0);
        let foot = plane.least(DVec3::new(2.0, -1.0, 1.5), 1e-6);
        assert!(foot.distance(DVec3::new(2.0, -1.0, 1.0)) < 1e-5, "{foot}");
        assert!(!Form::default().least(DVec3::ONE, 1e-6).is_finite());
        assert_eq!(plane.weight(), 3.0);
    }

    #[test]
    fn a_quadric_is_one_cache_line() {
        assert_eq!((size_of::<Quadric>(), align_of::<Quadric>()), (64, 64));
    }
}
