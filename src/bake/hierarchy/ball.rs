//! Spheres around spheres.

use glam::DVec3;

use crate::bounds::Sphere;

/// A sphere in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ball {
    pub(super) center: DVec3,
    pub(super) radius: f64,
}

/// Room for rounding, as a share of the radius.
const ROUNDING: f64 = 1e-12;

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
            Self { center, radius: radius * (1.0 + ROUNDING) }
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

    fn ball() -> impl Strategy<Value = Ball> {
        (-9.0..9.0, -9.0..9.0, -9.0..9.0, 0.0..9.0)
            .prop_map(|(x, y, z, radius)| Ball { center: DVec3::new(x, y, z), radius })
    }

    fn holds(a: Ball, b: Ball) -> bool {
        a.center.distance(b.center) + b.radius <= a.radius + 1e-9
    }

    proptest! {
        #[test]
        fn a_ball_holds_what_it_is_around((a, b) in (ball(), ball())) {
            let both = a.with(b);
            prop_assert!(holds(both, a) && holds(both, b));
            prop_assert!(both.radius <= 0.5 * (a.center.distance(b.center) + a.radius + b.radius).max(2.0 * a.radius.max(b.radius)) + 1e-9);
            prop_assert!(holds(Ball::of(&both.sphere()), both));
        }
    }
}
