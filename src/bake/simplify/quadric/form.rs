//! The quadric error of a point: a quadratic form, which is the weighted sum of squared distances to planes.

use std::ops::{Add, AddAssign};

use glam::DVec3;

/// `Q(v) = vᵀAv + 2bᵀv + c`, where A is symmetric and positive semidefinite, and the area that went into it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Quadric {
    /// Diagonal of A: xx, yy, zz.
    diagonal: DVec3,
    /// The rest of A: yz, zx, xy.
    mixed: DVec3,
    /// b.
    linear: DVec3,
    /// c.
    constant: f64,
    /// Sum of the weights of planes that are part of the surface; those that only constrain do not count.
    pub(super) area: f64,
}

impl Quadric {
    /// `weight` times the squared distance to the plane through `point` with the unit normal `normal`.
    pub(super) fn plane(normal: DVec3, point: DVec3, weight: f64) -> Self {
        let distance = -normal.dot(point);
        Self {
            diagonal: weight * normal * normal,
            mixed: weight * DVec3::new(normal.y * normal.z, normal.z * normal.x, normal.x * normal.y),
            linear: weight * distance * normal,
            constant: weight * distance * distance,
            area: weight,
        }
    }

    /// The same, but no part of the surface.
    pub(super) fn constraint(self) -> Self {
        Self { area: 0.0, ..self }
    }

    /// `A·v`.
    #[inline]
    fn times(&self, v: DVec3) -> DVec3 {
        let (d, m) = (self.diagonal, self.mixed);
        DVec3::new(
            d.x * v.x + m.z * v.y + m.y * v.z,
            m.z * v.x + d.y * v.y + m.x * v.z,
            m.y * v.x + m.x * v.y + d.z * v.z,
        )
    }

    /// The error at `v`, which rounding may make slightly negative.
    #[inline]
    pub(super) fn at(&self, v: DVec3) -> f64 {
        v.dot(self.times(v) + 2.0 * self.linear) + self.constant
    }

    /// Half the gradient at `v`.
    #[inline]
    pub(super) fn slope(&self, v: DVec3) -> DVec3 {
        self.times(v) + self.linear
    }

    /// How steep the form is along `v`: `vᵀAv`.
    #[inline]
    pub(super) fn curvature(&self, v: DVec3) -> f64 {
        v.dot(self.times(v))
    }

    /// The point where `Q(v) + stiffness·tr(A)·|v − near|²` is least; `None` if A is 0. Takes some 50 operations.
    ///
    /// With no stiffness that is the least of Q itself, which is no single point on planes and along straight creases
    /// and far away where they are nearly so. With a little the point does not leave `near` without a reason.
    #[inline]
    pub(super) fn least(&self, near: DVec3, stiffness: f64) -> Option<DVec3> {
        let d = self.diagonal + stiffness * self.diagonal.element_sum();
        let m = self.mixed;
        let cofactors = DVec3::new(d.y * d.z - m.x * m.x, d.z * d.x - m.y * m.y, d.x * d.y - m.z * m.z);
        let mixed = DVec3::new(m.y * m.z - m.x * d.x, m.z * m.x - m.y * d.y, m.x * m.y - m.z * d.z);
        let determinant = d.x * cofactors.x + m.z * mixed.z + m.y * mixed.y;
        let inverse = Self { diagonal: cofactors, mixed, ..Self::default() };
        let step = inverse.times(self.slope(near)) / determinant;
        step.is_finite().then(|| near - step)
    }
}

impl Add for Quadric {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            diagonal: self.diagonal + other.diagonal,
            mixed: self.mixed + other.mixed,
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            area: self.area + other.area,
        }
    }
}

impl AddAssign for Quadric {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
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
        fn the_error_is_the_sum_of_squared_distances(
            planes in prop::collection::vec((point(), point(), 0.1..2.0f64), 1..9),
            v in point(),
        ) {
            let (mut sum, mut quadric) = (0.0, Quadric::default());
            for (normal, through, weight) in planes {
                let normal = normal.normalize_or(DVec3::X);
                sum += weight * normal.dot(v - through).powi(2);
                quadric += Quadric::plane(normal, through, weight);
            }
            prop_assert!((quadric.at(v) - sum).abs() < 1e-12 * (1.0 + sum));
        }

        #[test]
        fn no_point_nearby_is_lower_than_the_least(
            corner in point(), tilt in point(), step in point(), near in point(),
        ) {
            let normals = [DVec3::X, DVec3::Y + 0.5 * tilt, DVec3::Z - 0.5 * tilt];
            let planes = normals.map(|n| Quadric::plane(n.normalize(), corner, 1.0));
            let sum = planes[0] + planes[1] + planes[2];
            let least = sum.least(near, 0.0).expect("three planes meet");
            prop_assert!(sum.at(least) <= sum.at(least + step) + 1e-9);
        }
    }

    #[test]
    fn on_a_plane_the_least_is_the_foot_of_where_one_stands() {
        let plane = Quadric::plane(DVec3::Z, DVec3::new(9.0, 9.0, 1.0), 3.0);
        let foot = plane.least(DVec3::new(2.0, -1.0, 1.5), 1e-6).expect("there is a plane");
        assert!(foot.distance(DVec3::new(2.0, -1.0, 1.0)) < 1e-5, "{foot}");
        assert_eq!(Quadric::default().least(DVec3::ONE, 1e-6), None);
    }

    #[test]
    fn constraints_have_no_area() {
        let plane = Quadric::plane(DVec3::Y, DVec3::ZERO, 2.0);
        assert_eq!((plane.area, plane.constraint().area, plane.constraint().at(DVec3::Y)), (2.0, 0.0, 2.0));
    }
}
