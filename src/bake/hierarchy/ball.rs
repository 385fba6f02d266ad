//! Spheres around points and spheres.

use glam::DVec3;

use crate::bounds::Sphere;

/// A sphere in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    pub(super) fn of(sphere: &Sphere) -> Self {
        Self { center: sphere.center.as_dvec3(), radius: f64::from(sphere.radius) }
    }

    /// Around points: from the middle of their box.
    pub(super) fn around(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let (low, high) = points
            .clone()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let center = 0.5 * (low + high);
        Self { center, radius: points.map(|p| p.distance(center)).fold(0.0, f64::max) }
    }

    /// The smallest around both.
    pub(super) fn with(self, other: Self) -> Self {
        let apart = self.center.distance(other.center);
        if apart + other.radius <= self.radius {
            self
        } else if apart + self.radius <= other.radius {
            other
        } else {
            let radius = 0.5 * (apart + self.radius + other.radius);
            let center = self.center.lerp(other.center, (radius - self.radius) / apart);
            Self { center, radius }
        }
    }

    /// In single precision, none the smaller.
    pub(super) fn sphere(self) -> Sphere {
        let center = self.center.as_vec3();
        let moved = center.as_dvec3().distance(self.center);
        Sphere::new(center, ((self.radius + moved) as f32).next_up())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_sphere_holds_what_it_is_around(
            points in prop::collection::vec((-9.0..9.0f64, -9.0..9.0f64, -9.0..9.0f64), 1..9),
        ) {
            let points: Vec<DVec3> = points.into_iter().map(DVec3::from).collect();
            let (some, others) = points.split_at(points.len().div_ceil(2));
            let others = if others.is_empty() { some } else { others };
            let around = |points: &[DVec3]| Ball::around(points.iter().copied());
            let sphere = around(some).with(around(others)).sphere();
            let reach = |p: &DVec3| p.distance(sphere.center.as_dvec3());
            prop_assert!(points.iter().all(|p| reach(p) <= f64::from(sphere.radius)));
        }
    }
}
