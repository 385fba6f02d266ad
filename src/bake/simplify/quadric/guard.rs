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

impl Guard {
    pub(super) fn new(turn: f32, shape: f32) -> Self {
        let squared = |x: f32| f64::from(x.clamp(0.0, 1.0)).powi(2);
        Self { turn: squared(turn), shape: squared(shape) }
    }

    /// Whether the triangle of the corners `from`, `p` and `q` may become that of `to`, `p` and `q`. A triangle without
    /// area may become anything.
    #[inline]
    pub(super) fn allows(&self, from: DVec3, to: DVec3, p: DVec3, q: DVec3) -> bool {
        let (side, old, new) = (q - p, p - from, p - to);
        let (before, after) = (old.cross(side), new.cross(side));
        let (turn, sizes) = (before.dot(after), (before.length_squared(), after.length_squared()));
        let keeps_direction = (turn > 0.0) & (turn * turn >= self.turn * sizes.0 * sizes.1);
        let sides = |a: DVec3| side.length_squared() + a.length_squared() + (a + side).length_squared();
        let spread = sides(new);
        let is_shapely = 12.0 * sizes.1 >= self.shape * spread * spread;
        let was_worse = || sizes.1 * sides(old).powi(2) >= sizes.0 * spread * spread;
        keeps_direction && (is_shapely || was_worse()) || sizes.0 == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether the corner (0, 1) of a triangle over (±1, 0) may go there.
    fn may_go(guard: Guard, x: f64, y: f64, z: f64) -> bool {
        guard.allows(DVec3::Y, DVec3::new(x, y, z), DVec3::NEG_X, DVec3::X)
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
    fn slivers_may_get_better_and_what_has_no_area_may_become_anything() {
        let guard = Guard::new(0.5, 0.5);
        let (p, q) = (DVec3::NEG_X, DVec3::X);
        assert!(guard.allows(DVec3::Y * 0.01, DVec3::Y * 0.02, p, q));
        assert!(!guard.allows(DVec3::Y * 0.02, DVec3::Y * 0.01, p, q));
        assert!(guard.allows(DVec3::ZERO, DVec3::NEG_Y, p, q));
    }
}
