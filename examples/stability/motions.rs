//! Motions made from a path.

use glam::{DVec3, Quat, Vec3};
use lod_budget::files::{CameraPath, PathError, Pose};

/// How a path is followed.
#[derive(Clone, Copy)]
pub enum Motion {
    /// As it is.
    Path,
    /// In the hand, in the middle of the path: ±1 cm and ±0.1° about a place, anew every sixtieth of a second.
    Jitter,
    /// The middle twentieth of the path, twenty times as slow.
    SlowDrift,
    /// All of it, four times as fast.
    FastDrive,
}

const FPS: f64 = 60.0;
const JITTER_S: f64 = 20.0;
const JITTER_M: f64 = 0.01;
const JITTER_DEG: f32 = 0.1;

impl Motion {
    /// In the order of tables.
    pub const ALL: [Self; 4] = [Self::Jitter, Self::SlowDrift, Self::Path, Self::FastDrive];

    fn name(self) -> &'static str {
        match self {
            Self::Path => "as it is",
            Self::Jitter => "jitter",
            Self::SlowDrift => "slow drift",
            Self::FastDrive => "fast drive",
        }
    }

    /// The path that comes of it.
    pub fn along(self, path: &CameraPath) -> Result<CameraPath, PathError> {
        let (start_s, all_s) = (path.start_s(), path.duration_s());
        let middle_s = start_s + 0.5 * all_s;
        let name = format!("{} {}", path.name(), self.name());
        match self {
            Self::Path => Ok(path.clone()),
            Self::Jitter => resampled(name, JITTER_S, |k, _| shaken(path.sample(middle_s), k)),
            Self::SlowDrift => {
                resampled(name, all_s, |_, time_s| path.sample(middle_s + (time_s - 0.5 * all_s) / 20.0))
            }
            Self::FastDrive => resampled(name, all_s / 4.0, |_, time_s| path.sample(start_s + 4.0 * time_s)),
        }
    }
}

/// The poses that `pose` yields of each frame's number and time.
fn resampled(
    name: String,
    duration_s: f64,
    pose: impl Fn(usize, f64) -> Pose,
) -> Result<CameraPath, PathError> {
    let frames = (duration_s * FPS) as usize + 1;
    let times = (0..frames).map(|k| (k, k as f64 / FPS));
    CameraPath::new(name, times.map(|(k, time_s)| Pose { time_s, ..pose(k, time_s) }).collect())
}

/// The pose, put off by as much as the `k`th point of an additive recurrence says (M. Roberts, "The unreasonable
/// effectiveness of quasirandom sequences", 2018): in six dimensions, so that no two axes move together.
fn shaken(pose: Pose, k: usize) -> Pose {
    // The root of x⁷ = x + 1.
    const ROOT: f64 = 1.112_775_684_278_705_5;
    let [x, y, z, pitch, yaw, roll] =
        std::array::from_fn(|d| 2.0 * (ROOT.powi(-1 - d as i32) * k as f64).fract() - 1.0);
    let turn = Vec3::new(pitch as f32, yaw as f32, roll as f32) * JITTER_DEG.to_radians();
    Pose {
        position: pose.position + DVec3::new(x, y, z) * JITTER_M,
        rotation: pose.rotation * Quat::from_scaled_axis(turn),
        ..pose
    }
}
