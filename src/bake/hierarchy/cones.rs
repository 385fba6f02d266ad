//! Cones around cones.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use crate::hierarchy::Cone;

/// Directions to both sides of an axis of unit length, up to an angle from it; from a right angle on, all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spread {
    axis: DVec3,
    angle: f64,
}

impl Spread {
    pub(super) const EVERY: Self = Self { axis: DVec3::Z, angle: FRAC_PI_2 };

    /// One direction and the opposite one.
    pub(super) fn along(axis: DVec3) -> Self {
        Self { axis, angle: 0.0 }
    }

    /// The narrowest around both.
    pub(super) fn with(self, other: Self) -> Self {
        let side = if self.axis.dot(other.axis) < 0.0 { -other.axis } else { other.axis };
        let apart = self.axis.cross(side).length().atan2(self.axis.dot(side));
        if apart + other.angle <= self.angle {
            self
        } else if apart + self.angle <= other.angle {
            other
        } else {
            self.towards(side, 0.5 * (apart + self.angle + other.angle), apart)
        }
    }

    /// Up to `angle`, turned towards `side` so far that its own far edge is where it was.
    fn towards(self, side: DVec3, angle: f64, apart: f64) -> Self {
        if angle >= FRAC_PI_2 {
            return Self::EVERY;
        }
        let turn = angle - self.angle;
        let axis = (self.axis * (apart - turn).sin() + side * turn.sin()).normalize_or_zero();
        Self { axis, angle: angle + ROUNDING }
    }

    pub(super) fn cone(self) -> Cone {
        if self.angle >= FRAC_PI_2 {
            return Cone::EVERY;
        }
        Cone::new(self.axis.as_vec3().normalize_or_zero(), self.angle.sin() as f32)
    }
}

/// Room for rounding, in radians.
const ROUNDING: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn spread() -> impl Strategy<Value = Spread> {
        let side = || -1.0..1.0;
        (side(), side(), side(), 0.0..1.4)
            .prop_map(|(x, y, z, angle)| Spread { axis: DVec3::new(x, y, z).normalize_or(DVec3::X), angle })
    }

    fn holds(a: Spread, b: Spread) -> bool {
        let apart = a.axis.dot(b.axis).abs().min(1.0).acos();
        a.angle >= FRAC_PI_2 || apart + b.angle <= a.angle + 1e-6
    }

    proptest! {
        #[test]
        fn a_cone_holds_what_it_is_around((a, b) in (spread(), spread())) {
            let both = a.with(b);
            prop_assert!(holds(both, a) && holds(both, b), "{both:?}");
        }
    }
}
