//! The way of the camera.

use std::f32::consts::TAU;

use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::View;
use lod_budget::bake::Surface;

/// A round over a terrain, at a fortieth of its width above the ground at most.
pub struct Flight {
    low: Vec3,
    high: Vec3,
}

impl Flight {
    pub fn over(surface: &Surface) -> Self {
        let (low, high) = surface
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        Self { low, high }
    }

    /// The view after a share of the round.
    pub fn view(&self, share: f32) -> View {
        let (eye, ahead) = (self.place(share), self.place(share + 0.04));
        let forward = (ahead - eye - Vec3::Z * 0.3 * (ahead - eye).length()).normalize();
        let right = forward.cross(Vec3::Z).normalize();
        let rotation = Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward));
        let size = (self.high - self.low).length();
        let view = View::perspective(1.0, Vec2::new(1920.0, 1080.0)).at(eye, rotation);
        View { near: 1e-3 * size, far: 2.0 * size, ..view }
    }

    /// On a round that winds in and out.
    fn place(&self, share: f32) -> Vec3 {
        let size = self.high - self.low;
        let reach = 0.3 + 0.1 * (3.0 * TAU * share).sin();
        let at = Vec2::from_angle(TAU * share) * reach;
        let middle = 0.5 * (self.low + self.high);
        Vec3::new(middle.x + at.x * size.x, middle.y + at.y * size.y, self.high.z + 0.01 * size.x)
    }
}
