//! Camera paths: poses over time.

use std::fmt;

use glam::{DVec3, Quat};

/// Where the camera is at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Time in seconds; the first pose of a path need not be at 0.
    pub time_s: f64,
    /// Position in the world.
    pub position: DVec3,
    /// Rotation from camera to world; the camera looks along −Z with +Y up. Of unit length.
    pub rotation: Quat,
}

/// Poses in order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    name: String,
    poses: Vec<Pose>,
}

impl CameraPath {
    /// Checks and keeps `poses`; rotations are normalised.
    ///
    /// # Errors
    /// Without a pose, with a number that is not finite, a rotation of no length, or a time that does not grow.
    pub fn new(name: impl Into<String>, poses: Vec<Pose>) -> Result<Self, PathError> {
        let name = name.into();
        match broken_pose(&poses) {
            Some((pose, rule)) => Err(PathError { path: name, pose, rule }),
            None => Ok(Self { name, poses: poses.into_iter().map(normalised).collect() }),
        }
    }

    /// Name, for reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The poses, in order of time; never empty.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }
}

fn broken_pose(poses: &[Pose]) -> Option<(usize, &'static str)> {
    if poses.is_empty() {
        return Some((0, "it must have at least one pose"));
    }
    let later = |i: usize| i == 0 || poses[i - 1].time_s < poses[i].time_s;
    poses.iter().enumerate().find_map(|(i, pose)| {
        if !pose.time_s.is_finite() || !pose.position.is_finite() || !pose.rotation.is_finite() {
            Some((i, "its numbers must be finite"))
        } else if pose.rotation.length_squared() < 1e-12 {
            Some((i, "its rotation must have a length"))
        } else if !later(i) {
            Some((i, "its time must be later than the one before"))
        } else {
            None
        }
    })
}

fn normalised(pose: Pose) -> Pose {
    Pose { rotation: pose.rotation.normalize(), ..pose }
}

/// Why a path was refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathError {
    /// The name of the path.
    pub path: String,
    /// Position of the pose at fault.
    pub pose: usize,
    /// The rule it breaks.
    pub rule: &'static str,
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "camera path '{}', pose {}: {}", self.path, self.pose, self.rule)
    }
}

impl std::error::Error for PathError {}
