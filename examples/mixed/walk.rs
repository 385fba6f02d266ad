//! The way of the camera: over the hills, down into the forest, to the camp, and up again.

use std::error::Error;

use glam::{Mat3, Quat, Vec2, Vec3};
use lod_budget::files::{CameraPath, Pose};

use crate::ground::Ground;

/// Where the camera is at a time, how high above the ground, and what place it looks at.
struct Station {
    time_s: f32,
    at: Vec2,
    above_m: f32,
    towards: Vec2,
}

const fn station(time_s: f32, at: [f32; 2], above_m: f32, towards: [f32; 2]) -> Station {
    Station { time_s, at: Vec2::from_array(at), above_m, towards: Vec2::from_array(towards) }
}

/// The middle of the camp.
pub const CAMP: Vec2 = Vec2::new(40.0, -30.0);

const STATIONS: [Station; 8] = [
    station(0.0, [-240.0, 230.0], 70.0, [0.0, 0.0]),
    station(6.0, [-160.0, 150.0], 50.0, [0.0, 0.0]),
    station(10.0, [-110.0, 95.0], 2.0, [0.0, 20.0]),
    station(20.0, [-20.0, 15.0], 1.8, CAMP.to_array()),
    station(25.0, [28.0, -20.0], 1.7, CAMP.to_array()),
    station(28.0, [28.0, -20.0], 1.7, [60.0, -26.0]),
    station(31.0, [30.0, -22.0], 1.7, [-200.0, -150.0]),
    station(40.0, [120.0, 60.0], 110.0, [-100.0, -60.0]),
];

/// Poses a second.
const RATE: u16 = 10;

pub fn over(ground: &Ground) -> Result<CameraPath, Box<dyn Error>> {
    let end_s = STATIONS[STATIONS.len() - 1].time_s;
    let times = (0..=end_s as u16 * RATE).map(|i| f32::from(i) / f32::from(RATE));
    Ok(CameraPath::new("mixed", times.map(|time_s| pose(ground, time_s)).collect())?)
}

fn pose(ground: &Ground, time_s: f32) -> Pose {
    let next = STATIONS.iter().position(|s| s.time_s > time_s).unwrap_or(STATIONS.len() - 1);
    let (from, to) = (&STATIONS[next - 1], &STATIONS[next]);
    let share = ((time_s - from.time_s) / (to.time_s - from.time_s)).min(1.0);
    let eased = share * share * (3.0 - 2.0 * share);
    let above = Vec3::Y * (from.above_m + (to.above_m - from.above_m) * eased);
    let eye = ground.place(from.at.lerp(to.at, eased)) + above;
    let target = ground.place(from.towards.lerp(to.towards, eased)) + Vec3::Y;
    Pose { time_s: f64::from(time_s), position: eye.as_dvec3(), rotation: facing(target - eye) }
}

/// Looks that way, upright.
fn facing(direction: Vec3) -> Quat {
    let forward = direction.normalize_or(Vec3::NEG_Z);
    let right = forward.cross(Vec3::Y).normalize_or(Vec3::X);
    Quat::from_mat3(&Mat3::from_cols(right, right.cross(forward), -forward))
}
