//! Camera paths: poses over time, and the motion between them.

use std::fmt;

use glam::{DVec3, Quat};
use serde::Serialize;

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
///
/// Between two poses the camera moves evenly, except across a [`Break`], where it rests at the earlier pose until
/// the time of the later one.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    name: String,
    poses: Vec<Pose>,
    breaks: Vec<Break>,
    dropped: usize,
}

/// Two neighbouring poses that no motion connects.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Break {
    /// Position of the pose after the break.
    pub pose: usize,
    /// Time of the pose before the break.
    pub time_s: f64,
    /// Time between the two.
    pub duration_s: f64,
    /// Distance between the two, in world units.
    pub distance: f64,
    /// Why no motion is assumed.
    pub kind: BreakKind,
}

/// Why no motion is assumed between two poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum BreakKind {
    /// Nothing was recorded for too long.
    Gap,
    /// The camera was put somewhere else.
    Jump,
}

/// Longest time without a pose that is still motion, by default. Longer: dropouts of a tracker are glided over;
/// shorter: sparse recordings fall apart.
const MAX_GAP_S: f64 = 1.0;

/// A gap is also this many times the median interval, so that paths of few poses far apart stay whole.
const GAP_INTERVALS: f64 = 10.0;

/// Slower than this (world units per second) is motion whatever the rest of the path does: faster than a racing kart
/// (51 m/s in the recordings this was chosen on), slower than being put 60 m away within a tenth of a second.
const JUMP_SPEED: f64 = 60.0;

/// A jump is also this many times the median speed, so that paths of fast aircraft stay whole.
const JUMP_SPEEDS: f64 = 10.0;

/// Shorter than this (world units) is no jump: time stamps a hair apart make a great speed of a small jitter.
const JUMP_DISTANCE: f64 = 1.0;

impl CameraPath {
    /// Checks and keeps `poses`; rotations are normalised.
    ///
    /// # Errors
    /// Without a pose, with a number that is not finite, a rotation of no length, or a time that does not grow.
    pub fn new(name: impl Into<String>, poses: Vec<Pose>) -> Result<Self, PathError> {
        let name = name.into();
        match broken_pose(&poses) {
            Some((pose, rule)) => Err(PathError { path: name, pose, rule }),
            None => {
                let poses = poses.into_iter().map(normalised).collect();
                Ok(Self { name, poses, breaks: Vec::new(), dropped: 0 }.with_max_gap_s(MAX_GAP_S))
            }
        }
    }

    /// The path, with its breaks found anew: two poses more than `max_gap_s` (default 1) and more than 10 median
    /// intervals apart are a gap. A jump needs more than 60 world units per second, more than 10 times the median
    /// speed, and more than one world unit.
    #[must_use]
    pub fn with_max_gap_s(mut self, max_gap_s: f64) -> Self {
        self.breaks = find_breaks(&self.poses, max_gap_s);
        self
    }

    /// The path, with a note of how many poses its reader left out.
    pub(super) fn with_dropped(self, dropped: usize) -> Self {
        Self { dropped, ..self }
    }

    /// Name, for reports.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The poses, in order of time; never empty.
    pub fn poses(&self) -> &[Pose] {
        &self.poses
    }

    /// Where no motion connects two poses, in order of time.
    pub fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    /// How many poses its reader left out because the time of the one before was repeated.
    pub fn dropped(&self) -> usize {
        self.dropped
    }

    /// Time of the first pose.
    pub fn start_s(&self) -> f64 {
        self.poses[0].time_s
    }

    /// Time of the last pose.
    pub fn end_s(&self) -> f64 {
        self.poses[self.poses.len() - 1].time_s
    }

    /// Time from the first pose to the last.
    pub fn duration_s(&self) -> f64 {
        self.end_s() - self.start_s()
    }

    /// Distance travelled, in world units; breaks are not travelled.
    pub fn length(&self) -> f64 {
        self.steps().map(|(earlier, later)| earlier.position.distance(later.position)).sum()
    }

    /// The greatest mean speed between two neighbouring poses, in world units per second; breaks do not count.
    pub fn top_speed(&self) -> f64 {
        self.steps().map(|(earlier, later)| speed(earlier, later)).fold(0.0, f64::max)
    }

    /// Neighbouring poses that motion connects.
    fn steps(&self) -> impl Iterator<Item = (&Pose, &Pose)> {
        (1..self.poses.len()).filter(|&i| !self.is_break(i)).map(|i| (&self.poses[i - 1], &self.poses[i]))
    }

    fn is_break(&self, later: usize) -> bool {
        self.breaks.binary_search_by_key(&later, |b| b.pose).is_ok()
    }

    /// The pose at any time: the first pose before the path begins (or where `time_s` is not a number), the last one
    /// after it ends. O(log n).
    ///
    /// Positions are interpolated linearly. Rotations go the shorter way by normalised linear interpolation: it takes
    /// no trigonometry, so that every machine finds the same pose; over the few degrees between recorded poses it
    /// differs from even turning by less than the recording's noise (0.03° in a turn of 30°, 2.3° in one of 120°).
    pub fn sample(&self, time_s: f64) -> Pose {
        let next = self.poses.partition_point(|p| p.time_s <= time_s);
        let earlier = self.poses[next.saturating_sub(1)];
        match self.poses.get(next) {
            Some(later) if next > 0 && !self.is_break(next) => between(&earlier, later, time_s),
            _ => Pose { time_s, ..earlier },
        }
    }
}

fn between(earlier: &Pose, later: &Pose, time_s: f64) -> Pose {
    let t = (time_s - earlier.time_s) / (later.time_s - earlier.time_s);
    let position = earlier.position * (1.0 - t) + later.position * t;
    Pose { time_s, position, rotation: nlerp(earlier.rotation, later.rotation, t) }
}

/// In plain double-precision sums, because the order in which a vector unit adds depends on the machine.
fn nlerp(a: Quat, b: Quat, t: f64) -> Quat {
    let (a, b) = (wide(a), wide(b));
    let dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    let (from, to) = if dot < 0.0 { (1.0 - t, -t) } else { (1.0 - t, t) };
    unit([0, 1, 2, 3].map(|i| a[i] * from + b[i] * to))
}

fn wide(q: Quat) -> [f64; 4] {
    q.to_array().map(f64::from)
}

fn length_squared([x, y, z, w]: [f64; 4]) -> f64 {
    x * x + y * y + z * z + w * w
}

fn unit(q: [f64; 4]) -> Quat {
    let length = length_squared(q).sqrt();
    Quat::from_array(q.map(|c| (c / length) as f32))
}

/// A rotation that is of unit length already stays as it is, to the bit: paths survive being written and read.
fn normalised(pose: Pose) -> Pose {
    let q = wide(pose.rotation);
    let is_unit = (length_squared(q) - 1.0).abs() < 1e-6;
    Pose { rotation: if is_unit { pose.rotation } else { unit(q) }, ..pose }
}

fn speed(earlier: &Pose, later: &Pose) -> f64 {
    earlier.position.distance(later.position) / (later.time_s - earlier.time_s)
}

fn find_breaks(poses: &[Pose], max_gap_s: f64) -> Vec<Break> {
    let pairs = || poses.windows(2).map(|pair| (&pair[0], &pair[1]));
    let median_s = median(pairs().map(|(earlier, later)| later.time_s - earlier.time_s));
    let median_speed = median(pairs().map(|(earlier, later)| speed(earlier, later)));
    let found = pairs().enumerate().map(|(i, (earlier, later))| {
        let duration_s = later.time_s - earlier.time_s;
        let distance = earlier.position.distance(later.position);
        let is_gap = duration_s > max_gap_s.max(GAP_INTERVALS * median_s);
        let fast = JUMP_SPEED.max(JUMP_SPEEDS * median_speed);
        let is_jump = distance > JUMP_DISTANCE && distance > fast * duration_s;
        let kind = if is_gap { BreakKind::Gap } else { BreakKind::Jump };
        let found = Break { pose: i + 1, time_s: earlier.time_s, duration_s, distance, kind };
        (is_gap || is_jump).then_some(found)
    });
    found.flatten().collect()
}

/// The upper median; 0 of nothing.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

fn broken_pose(poses: &[Pose]) -> Option<(usize, &'static str)> {
    if poses.is_empty() {
        return Some((0, "it must have at least one pose"));
    }
    let later = |i: usize| i == 0 || poses[i - 1].time_s < poses[i].time_s;
    poses.iter().enumerate().find_map(|(i, pose)| {
        if let Some(rule) = broken_numbers(pose) {
            Some((i, rule))
        } else if !later(i) {
            Some((i, "its time must be later than the one before"))
        } else {
            None
        }
    })
}

/// What is wrong with a pose on its own.
pub(super) fn broken_numbers(pose: &Pose) -> Option<&'static str> {
    if !pose.time_s.is_finite() || !pose.position.is_finite() || !pose.rotation.is_finite() {
        Some("its numbers must be finite")
    } else if length_squared(wide(pose.rotation)) < 1e-12 {
        Some("its rotation must have a length")
    } else {
        None
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(time_s: f64, x: f64) -> Pose {
        Pose { time_s, position: DVec3::new(x, 0.0, 0.0), rotation: Quat::IDENTITY }
    }

    fn path(poses: Vec<Pose>) -> CameraPath {
        CameraPath::new("walk", poses).expect("a good path")
    }

    /// A walk of 1 unit per second at 10 poses a second, with poses moved and delayed from some pose on.
    fn broken_walk(from: usize, delay_s: f64, distance: f64) -> CameraPath {
        let pose = |i: usize| {
            let (t, x) = (i as f64 * 0.1, i as f64 * 0.1);
            if i < from { at(t, x) } else { at(t + delay_s, x + distance) }
        };
        path((0..50).map(pose).collect())
    }

    #[test]
    fn poses_are_held_before_the_first_and_after_the_last() {
        let p = path(vec![at(1.0, 5.0), at(2.0, 7.0)]);
        assert_eq!(p.sample(-3.0).position.x, 5.0);
        assert_eq!(p.sample(1.5).position.x, 6.0);
        assert_eq!(p.sample(2.0).position.x, 7.0);
        assert_eq!(p.sample(1e300).position.x, 7.0);
        assert_eq!(p.sample(f64::NAN).position.x, 5.0);
        assert_eq!((p.start_s(), p.end_s(), p.duration_s()), (1.0, 2.0, 1.0));
    }

    #[test]
    fn a_gap_is_held_not_glided_over() {
        let p = broken_walk(20, 3.0, 0.5);
        let kinds: Vec<_> = p.breaks().iter().map(|b| (b.pose, b.kind)).collect();
        assert_eq!(kinds, [(20, BreakKind::Gap)]);
        assert_eq!(p.sample(3.0).position.x, p.poses()[19].position.x);
        assert_eq!(p.sample(p.poses()[20].time_s).position, p.poses()[20].position);
        assert!((p.length() - 4.8).abs() < 1e-9, "{}", p.length());
        assert!(p.clone().with_max_gap_s(5.0).breaks().is_empty());
    }

    #[test]
    fn a_jump_is_held_until_the_later_pose() {
        let p = broken_walk(20, 0.0, 62.8);
        let kinds: Vec<_> = p.breaks().iter().map(|b| (b.pose, b.kind)).collect();
        assert_eq!(kinds, [(20, BreakKind::Jump)]);
        assert_eq!(p.sample(1.95).position.x, p.poses()[19].position.x);
        assert!(p.top_speed() < 1.1, "{}", p.top_speed());
    }

    #[test]
    fn key_frames_far_apart_and_fast_flights_are_whole() {
        assert!(path((0..6).map(|i| at(f64::from(i) * 10.0, f64::from(i))).collect()).breaks().is_empty());
        assert!(
            path((0..60).map(|i| at(f64::from(i) * 0.1, f64::from(i) * 30.0)).collect()).breaks().is_empty()
        );
    }

    #[test]
    fn a_jitter_between_close_time_stamps_is_no_jump() {
        assert!(path(vec![at(0.0, 0.0), at(1e-6, 0.01), at(1.0, 0.02)]).breaks().is_empty());
    }

    #[test]
    fn rotations_take_the_shorter_way() {
        let half = Quat::from_rotation_y(1.0);
        let poses = |b: Quat| vec![at(0.0, 0.0), Pose { rotation: b, ..at(1.0, 0.0) }];
        let (plain, negated) = (path(poses(half)).sample(0.5), path(poses(-half)).sample(0.5));
        assert_eq!(plain.rotation, negated.rotation);
        assert!(plain.rotation.angle_between(Quat::from_rotation_y(0.5)) < 1e-3);
    }

    #[test]
    fn a_path_that_is_not_in_order_is_refused() {
        let refused = CameraPath::new("walk", vec![at(1.0, 0.0), at(1.0, 0.0)]).expect_err("no time passes");
        assert_eq!(
            refused.to_string(),
            "camera path 'walk', pose 1: its time must be later than the one before"
        );
        assert!(CameraPath::new("walk", vec![]).is_err());
        let flat = Pose { rotation: Quat::from_array([0.0; 4]), ..at(0.0, 0.0) };
        assert!(CameraPath::new("walk", vec![flat]).is_err());
    }

    /// The pose at a time, found by looking at every pair of poses.
    fn slow_sample(path: &CameraPath, time_s: f64) -> DVec3 {
        let poses = path.poses();
        for (i, pair) in poses.windows(2).enumerate() {
            if pair[0].time_s <= time_s && time_s < pair[1].time_s {
                let held = path.breaks().iter().any(|b| b.pose == i + 1);
                let t =
                    if held { 0.0 } else { (time_s - pair[0].time_s) / (pair[1].time_s - pair[0].time_s) };
                return pair[0].position.lerp(pair[1].position, t);
            }
        }
        if time_s < poses[0].time_s { poses[0].position } else { poses[poses.len() - 1].position }
    }

    proptest! {
        #[test]
        fn sampling_equals_looking_at_every_pair(
            steps in prop::collection::vec((0.01f64..3.0, -200.0f64..200.0), 1..40),
            when in -1.0f64..60.0,
        ) {
            let mut now = 0.0;
            let poses = steps.iter().map(|&(dt, x)| { now += dt; at(now, x) }).collect();
            let p = path(poses);
            let (fast, slow) = (p.sample(when), slow_sample(&p, when));
            prop_assert!((fast.position - slow).length() < 1e-6, "{fast:?} {slow:?}");
            let length = f64::from(fast.rotation.length());
            prop_assert!((length - 1.0).abs() < 1e-6);
        }
    }
}
