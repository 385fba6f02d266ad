//! What a triangle must not become when a corner of it moves.

use glam::DVec3;

/// Which triangles a contraction may make.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guard {
    /// Least cosine of the angle by which a triangle may turn, squared; ≥ 0.
    turn: f64,
    /// Least shape that a triangle may get unless it had a worse one, squared.
    shape: f64,
}

/// Where a triangle of the original faces, to a hundredth: its unit normal in 127ths.
///
/// Turns that are each allowed add up, in the end to a triangle on its back; what it once was does not move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Facing(u32);

impl Facing {
    /// Of a unit normal, or of 0, which is no direction at all.
    pub(super) fn new(normal: DVec3) -> Self {
        let [x, y, z] = (127.0 * normal).to_array().map(|x| (x + 0.5_f64.copysign(x)) as i8 as u8);
        Self(u32::from_le_bytes([x, y, z, 0]))
    }

    /// The normal, in 127ths.
    #[inline(always)]
    pub(super) fn normal(self) -> DVec3 {
        // Shifts are what wide vectors have.
        let from = |bit: u32| f64::from((self.0 << (24 - bit)) as i32 >> 24);
        DVec3::new(from(0), from(8), from(16))
    }
}

/// The share of its shape, squared, that a sliver has to keep when it changes. A cylinder is all slivers, and some get
/// thinner as others go: with 1 it would never have a level. With 0 slivers would become needles.
const SLIVER_KEEPS: f64 = 0.5;

impl Guard {
    pub(super) fn new(turn: f32, shape: f32) -> Self {
        let squared = |x: f32| f64::from(x.clamp(0.0, 1.0)).powi(2);
        Self { turn: squared(turn), shape: squared(shape) }
    }

    /// Whether the triangle of the corners `from`, `p` and `q` may become that of `to`, `p` and `q`, which once faced
    /// along `facing`, of whatever length. A triangle without area may become anything.
    #[inline(always)]
    pub(super) fn allows(&self, from: DVec3, to: DVec3, [p, q]: [DVec3; 2], facing: DVec3) -> bool {
        let (side, old, new) = (q - p, p - from, p - to);
        let (before, after) = (old.cross(side), new.cross(side));
        let (turn, sizes) = (before.dot(after), (before.length_squared(), after.length_squared()));
        let is_upright = after.dot(facing) >= 0.0;
        let keeps_direction = (turn > 0.0) & (turn * turn >= self.turn * sizes.0 * sizes.1) & is_upright;
        let sides = |a: DVec3| side.length_squared() + a.length_squared() + (a + side).length_squared();
        let (spread, spread_before) = (sides(new), sides(old));
        let is_shapely = 12.0 * sizes.1 >= self.shape * spread * spread;
        let was_no_better =
            sizes.1 * spread_before * spread_before >= SLIVER_KEEPS * sizes.0 * spread * spread;
        (keeps_direction & (is_shapely | was_no_better)) | (sizes.0 == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_4;

    use super::*;

    /// Whether the corner (0, 1) of a triangle over (±1, 0) may go there.
    fn may_go(guard: Guard, x: f64, y: f64, z: f64) -> bool {
        guard.allows(DVec3::Y, DVec3::new(x, y, z), [DVec3::NEG_X, DVec3::X], DVec3::ZERO)
    }

    #[test]
    fn triangles_neither_turn_over_nor_lose_their_shape() {
        let guard = Guard::new(0.5, 0.1);
        assert!(may_go(guard, 0.5, 0.8, 0.0) && may_go(guard, 0.0, 0.51, 0.5));
        assert!(!may_go(guard, 0.0, -1.0, 0.0) && !may_go(guard, 0.0, 0.4, 1.0), "turned");
        assert!(!may_go(guard, 0.0, 0.05, 0.0) && !may_go(guard, 30.0, 1.0, 0.0), "slivers");
        assert!(may_go(Guard::new(0.0, 0.0), 0.0, 0.001, 1.0));
    }

    #[test]
    fn a_facing_is_the_normal_to_a_hundredth() {
        for normal in [DVec3::NEG_X, DVec3::Z, DVec3::new(0.48, -0.6, 0.64), DVec3::new(-0.64, 0.48, -0.6)] {
            let found = Facing::new(normal).normal() / 127.0;
            assert!((found - normal).abs().max_element() < 0.01, "{normal}: {found}");
        }
        assert_eq!(Facing::new(DVec3::ZERO).normal(), DVec3::ZERO);
    }

    /// Half a right angle at a time, seen from above, which is where the triangle faces.
    #[test]
    fn turns_do_not_add_up_to_more_than_a_right_angle() {
        let guard = Guard::new(0.5, 0.1);
        let tip = |eighths: f64| DVec3::new(0.0, (eighths * FRAC_PI_4).cos(), (eighths * FRAC_PI_4).sin());
        let upwards = Facing::new(DVec3::Z);
        let may_turn =
            |from: f64, to: f64| guard.allows(tip(from), tip(to), [DVec3::NEG_X, DVec3::X], upwards.normal());
        assert!(may_turn(0.0, 1.0) && may_turn(1.0, 1.9) && may_turn(2.9, 1.9));
        assert!(!may_turn(1.9, 2.9) && !may_turn(1.9, 2.1));
    }

    #[test]
    fn slivers_may_get_better_and_what_has_no_area_may_become_anything() {
        let guard = Guard::new(0.5, 0.5);
        let allows = |from, to| guard.allows(from, to, [DVec3::NEG_X, DVec3::X], DVec3::Z);
        assert!(allows(DVec3::Y * 0.01, DVec3::Y * 0.02));
        assert!(allows(DVec3::Y * 0.02, DVec3::Y * 0.019) && !allows(DVec3::Y * 0.02, DVec3::Y * 0.01));
        assert!(allows(DVec3::ZERO, DVec3::NEG_Y));
    }
}
