//! Directions of errors, in four bytes.

use glam::Vec3;

/// The directions that an error may have: a cone to both sides of an axis.
///
/// What is wrong by a millimetre along the line of sight is hardly seen, what is wrong across it is seen in full.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cone {
    /// The axis in 127ths.
    axis: [i8; 3],
    /// Sine of the half angle in 255ths; 255 is every direction.
    spread: u8,
}

/// What rounding the axis to 127ths may turn it by, as a sine.
const AXIS_ROUNDING: f32 = 0.007;

impl Cone {
    /// Every direction.
    pub const EVERY: Self = Self { axis: [0; 3], spread: u8::MAX };

    /// Around an axis of unit length, by the sine of the half angle: never narrower than that. An axis that is none
    /// has every direction.
    pub fn new(axis: Vec3, sine: f32) -> Self {
        let rounded = (axis * 127.0).round();
        let is_exact = rounded.length_squared() == 127.0 * 127.0 && rounded / 127.0 == axis;
        let spread = ((sine + if is_exact { 0.0 } else { AXIS_ROUNDING }) * 255.0).ceil();
        if !(axis.is_normalized() && spread < 255.0) {
            return Self::EVERY;
        }
        Self { axis: rounded.to_array().map(|x| x as i8), spread: spread.max(0.0) as u8 }
    }

    /// As four bytes: the axis, then the spread.
    pub fn to_bytes(self) -> [u8; 4] {
        let [x, y, z] = self.axis.map(|x| x as u8);
        [x, y, z, self.spread]
    }

    /// From [`Cone::to_bytes`]; any bytes are a cone.
    pub fn from_bytes([x, y, z, spread]: [u8; 4]) -> Self {
        let axis = [x, y, z].map(|x| x as i8);
        if axis == [0; 3] { Self::EVERY } else { Self { axis, spread } }
    }

    /// The greatest sine of an angle between a direction of the cone and one that is at most `sine` (of an angle below
    /// a right one) away from `sight`, a vector of unit length; 1 where there is no saying. Of + − × ÷ √ alone.
    pub(super) fn largest_sine(self, sight: Vec3, sine: f32) -> f32 {
        if self.spread == u8::MAX || !(0.0..1.0).contains(&sine) {
            return 1.0;
        }
        let axis = Vec3::from_array(self.axis.map(f32::from));
        let cosine = (axis.dot(sight).abs() / axis.length_squared().sqrt()).min(1.0);
        let (wide, beyond) = (f32::from(self.spread) / 255.0, sine);
        let (wide_cos, beyond_cos) = (other_side(wide), other_side(beyond));
        let sum = wide * beyond_cos + wide_cos * beyond;
        let sum_cos = wide_cos * beyond_cos - wide * beyond;
        let reaches_across = sum_cos <= 0.0 || cosine <= sum;
        let most = other_side(cosine) * sum_cos + cosine * sum;
        if reaches_across { 1.0 } else { (most + ROUNDING).min(1.0) }
    }
}

/// Room for rounding in [`Cone::largest_sine`]; a square root of a difference near 0 loses half of the digits.
const ROUNDING: f32 = 1e-3;

/// The cosine of a sine between 0 and 1, and the other way round.
pub(super) fn other_side(x: f32) -> f32 {
    (1.0 - x * x).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn direction() -> impl Strategy<Value = Vec3> {
        let side = -1.0f32..1.0;
        (side.clone(), side.clone(), side)
            .prop_map(|(x, y, z)| Vec3::new(x, y, z))
            .prop_filter("no direction", |v| v.length() > 0.1)
            .prop_map(Vec3::normalize)
    }

    /// `axis` turned towards `other` by an angle.
    fn turned(axis: Vec3, other: Vec3, angle: f32) -> Vec3 {
        let side = (other - axis * axis.dot(other)).normalize_or_zero();
        axis * angle.cos() + side * angle.sin()
    }

    proptest! {
        #[test]
        fn no_direction_of_the_cone_has_a_larger_sine(
            (axis, sight, a, b) in (direction(), direction(), direction(), direction()),
            (wide, beyond) in (0.0f32..1.5, 0.0f32..1.5),
            (s, t) in (0.0f32..1.0, 0.0f32..1.0),
        ) {
            let most = Cone::new(axis, wide.sin()).largest_sine(sight, beyond.sin());
            let (error, seen) = (turned(axis, a, wide * s), turned(sight, b, beyond * t));
            prop_assert!(error.cross(seen).length() <= most + 1e-5);
        }
    }

    #[test]
    fn upright_errors_are_not_seen_from_above() {
        let up = Cone::new(Vec3::Z, 0.0);
        assert!(up.largest_sine(Vec3::NEG_Z, 0.0) < 0.01);
        assert!(up.largest_sine(Vec3::X, 0.0) > 0.999);
        assert!((up.largest_sine(Vec3::new(0.6, 0.0, -0.8), 0.0) - 0.6).abs() < 0.01);
        assert_eq!(Cone::new(Vec3::ZERO, 0.0), Cone::EVERY);
        assert_eq!(Cone::new(Vec3::NAN, 0.0), Cone::EVERY);
        assert_eq!(Cone::from_bytes(up.to_bytes()), up);
    }
}
