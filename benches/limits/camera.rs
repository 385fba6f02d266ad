//! Cameras, and a camera made ready for a frame: what the baselines cull and rate by.

use crate::scene::Scene;

/// Height and width of the image in pixels.
pub const VIEWPORT_PX: [f32; 2] = [1920.0, 1080.0];
/// Distance of the near plane.
pub const NEAR: f32 = 0.1;

/// A camera that looks along the diagonal of the ground, a quarter turn wide and a quarter turn high.
#[derive(Clone, Copy)]
pub struct Camera {
    pub eye: [f32; 3],
    pub far: f32,
}

/// Metres that the camera moves per frame: a fast drive.
const STEP: f32 = 0.5;
/// Frames until the camera is back where it started.
const ROUND: usize = 64;

impl Camera {
    /// Before a corner, so that everything is in view.
    pub fn of_all() -> Self {
        Self { eye: [-70.0, 20.0, -70.0], far: f32::INFINITY }
    }

    /// In a corner, with so far a far plane that a share of the ground, up to a half, is in view.
    pub fn of_share(scene: &Scene, share: f32) -> Self {
        Self { eye: [0.0, 10.0, 0.0], far: share.sqrt() * scene.side }
    }

    /// In the middle of everything, without a far plane: about a quarter is in view.
    pub fn in_the_middle(scene: &Scene) -> Self {
        Self { eye: [scene.side / 2.0, 10.0, scene.side / 2.0], far: f32::INFINITY }
    }

    /// The camera in a frame of its way forth and back.
    pub fn at_frame(self, frame: usize) -> Self {
        let frame = frame % ROUND;
        let way = frame.min(ROUND - frame) as f32 * (STEP * std::f32::consts::FRAC_1_SQRT_2);
        let [x, y, z] = self.eye;
        Self { eye: [x + way, y, z + way], ..self }
    }

    /// The box around what is in view, least corner first, with so much `room` around it. The window is as wide and
    /// as high as it is far.
    ///
    /// Without room a box query misses spheres that are outside a corner of the view and that a test plane by plane
    /// lets pass; with 2.7 times the largest radius it misses none.
    pub fn aabb(&self, room: f32) -> [[f32; 3]; 2] {
        let across = self.far * std::f32::consts::SQRT_2;
        let [x, y, z] = self.eye;
        let (least, most) = ([x, y - self.far, z], [x + across, y + self.far, z + across]);
        [least.map(|c| c - room), most.map(|c| c + room)]
    }
}

/// A camera made ready for a frame. The numbers are those of the crate under test, so that all decide alike.
pub struct Lens {
    /// Normals and offsets; inside is not negative.
    pub planes: [[f32; 4]; 6],
    pub eye: [f32; 3],
    /// Projected area of a sphere of radius 1 at distance 1.
    pub unit_px2: f32,
    pub viewport_px2: f32,
}

impl Lens {
    /// Whether some of a sphere may be in view.
    #[inline]
    pub fn sees(&self, [x, y, z, radius]: [f32; 4]) -> bool {
        self.planes.iter().all(|[a, b, c, d]| a * x + b * y + c * z + d >= -radius)
    }

    /// Projected area in px² times importance.
    #[inline]
    pub fn weight(&self, [x, y, z, radius]: [f32; 4], importance: f32) -> f32 {
        let [dx, dy, dz] = [x - self.eye[0], y - self.eye[1], z - self.eye[2]];
        let distance2 = (dx * dx + dy * dy + dz * dz).max(NEAR * NEAR);
        let radius2 = radius * radius;
        let area_px2 = (radius2 * self.unit_px2 / distance2).min(self.viewport_px2);
        let area_px2 = if distance2 <= radius2 { self.viewport_px2 } else { area_px2 };
        area_px2 * importance
    }
}
