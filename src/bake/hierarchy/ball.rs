//! Spheres around points.

use glam::DVec3;

use crate::bounds::Sphere;

/// A sphere in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    center: DVec3,
    radius: f64,
}

impl Ball {
    /// Around points: from the middle of their box.
    pub(super) fn around(points: impl Iterator<Item = DVec3> + Clone) -> Self {
        let (low, high) = points
            .clone()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let center = 0.5 * (low + high);
        Self { center, radius: points.map(|p| p.distance(center)).fold(0.0, f64::max) }
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
            let sphere = Ball::around(points.iter().copied()).sphere();
            let reach = |p: &DVec3| p.distance(sphere.center.as_dvec3());
            prop_assert!(points.iter().all(|p| reach(p) <= f64::from(sphere.radius)));
        }
    }
}
