//! The camera: in the middle of the ground, without a limit to how far it sees, so that about a quarter is in view.

use crate::scene::{Instance, Scene};

/// Width and height of the image.
pub const VIEWPORT_PX: [f32; 2] = [1920.0, 1080.0];
/// Vertical field of view: 60°.
pub const FOV_Y: f32 = std::f32::consts::FRAC_PI_3;
/// Distance of the near plane, metres.
pub const NEAR: f32 = 0.1;
/// Pixels per tangent: what a metre looks like at a distance of one.
pub const SCALE_PX: f32 = VIEWPORT_PX[1] / (2.0 * TAN_Y);
/// Tangent of 30°.
const TAN_Y: f32 = 0.577_350_26;
/// Metres and radians that the camera moves per frame: a fast walk that turns.
const STEP: f32 = 0.05;
const TURN: f32 = 0.002;
/// Above the ground, metres.
const EYE_HEIGHT: f32 = 10.0;

/// A camera that stands upright.
#[derive(Clone, Copy)]
pub struct Camera {
    pub eye: [f32; 3],
    /// Turned left from −Z, radians.
    pub yaw: f32,
    /// Distance of the far plane, beyond everything, since some peers want one.
    pub far: f32,
}

/// What stands for an object in the test against the view.
#[derive(Clone, Copy, PartialEq)]
pub enum Bound {
    /// The sphere of its radius.
    Sphere,
    /// The upright cube around that sphere.
    Cube,
}

impl Bound {
    pub fn name(self) -> &'static str {
        match self {
            Self::Sphere => "sphere",
            Self::Cube => "cube",
        }
    }

    /// How far a bound of such a radius reaches along a normal.
    fn reach(self, normal: [f64; 3], radius: f64) -> f64 {
        match self {
            Self::Sphere => radius,
            Self::Cube => radius * normal.iter().map(|n| n.abs()).sum::<f64>(),
        }
    }
}

/// A walk forth and back: so many frames, the last beside the first.
pub fn walk(scene: &Scene, frames: usize) -> Vec<Camera> {
    let step = |frame: usize| frame.min(frames - frame) as f32;
    (0..frames).map(|frame| Camera::on_the_way(scene.side, step(frame))).collect()
}

impl Camera {
    fn on_the_way(side: f32, steps: f32) -> Self {
        let (middle, way) = (side / 2.0, STEP * steps);
        Self { eye: [middle - way, EYE_HEIGHT, middle - way], yaw: 0.7 + TURN * steps, far: 2.0 * side }
    }

    /// The objects whose bound is not wholly outside a plane of the view: one by one, in double precision.
    pub fn in_view<'a>(&self, scene: &'a Scene, bound: Bound) -> impl Iterator<Item = &'a Instance> {
        let planes = self.planes();
        scene.instances.iter().filter(move |i| planes.iter().all(|p| p.admits(scene, i, bound)))
    }

    /// Left, right, top, bottom and near; nothing is too far.
    fn planes(&self) -> [Plane; 5] {
        let tan_y = f64::from(TAN_Y);
        let tan_x = tan_y * f64::from(VIEWPORT_PX[0] / VIEWPORT_PX[1]);
        [
            self.plane([1.0, 0.0, -tan_x], 0.0),
            self.plane([-1.0, 0.0, -tan_x], 0.0),
            self.plane([0.0, -1.0, -tan_y], 0.0),
            self.plane([0.0, 1.0, -tan_y], 0.0),
            self.plane([0.0, 0.0, -1.0], f64::from(NEAR)),
        ]
    }

    /// A plane with this normal as the camera sees it, so far before the eye.
    fn plane(&self, [x, y, z]: [f64; 3], ahead: f64) -> Plane {
        let (sin, cos) = f64::from(self.yaw).sin_cos();
        let length = (x * x + y * y + z * z).sqrt();
        let normal = [x * cos + z * sin, y, z * cos - x * sin].map(|n| n / length);
        Plane { normal, offset: -dot(normal, self.eye) - ahead }
    }
}

/// Inside is not negative.
struct Plane {
    normal: [f64; 3],
    offset: f64,
}

impl Plane {
    fn admits(&self, scene: &Scene, instance: &Instance, bound: Bound) -> bool {
        let radius = f64::from(scene.kind(instance).radius);
        dot(self.normal, instance.center) + self.offset >= -bound.reach(self.normal, radius)
    }
}

fn dot(normal: [f64; 3], point: [f32; 3]) -> f64 {
    normal.into_iter().zip(point).map(|(n, p)| n * f64::from(p)).sum()
}
