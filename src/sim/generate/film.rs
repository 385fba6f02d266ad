//! Camera paths from storyboards.

use glam::{DVec3, Quat};

use super::angle::sin_cos_deg;
use super::dice::Dice;
use crate::files::{CameraPath, Pose};

/// Where the camera is to be at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    time_s: f64,
    /// x, y, z in metres, heading and pitch in degrees.
    state: [f64; 5],
}

/// A key of a storyboard. Headings are a compass': 0 looks north (−z), 90 east (+x); a positive pitch looks up.
pub(super) const fn key(time_s: f64, [x, y, z]: [f64; 3], heading_deg: f64, pitch_deg: f64) -> Key {
    Key { time_s, state: [x, y, z, heading_deg, pitch_deg] }
}

/// How a storyboard is filmed.
pub(super) struct Film<'a> {
    /// Name of the path.
    pub name: &'a str,
    /// Poses per second.
    pub hz: u32,
    /// How far the view wanders while the camera moves, in degrees. A camera at rest is still to the last bit.
    pub sway_deg: f64,
    /// Continuous shots, each a list of keys in order of time; from one to the next the camera jumps.
    pub shots: &'a [&'a [Key]],
}

impl Film<'_> {
    /// Samples the shots.
    ///
    /// # Panics
    /// A storyboard whose times do not grow is a mistake in this crate.
    pub fn shoot(&self, seed: u64) -> CameraPath {
        let mut hand = Hand::new(seed, self.sway_deg);
        let poses = self.shots.iter().flat_map(|keys| self.shot(keys, &mut hand)).collect();
        CameraPath::new(self.name, poses).expect("storyboards are in order of time")
    }

    fn shot(&self, keys: &[Key], hand: &mut Hand) -> Vec<Pose> {
        let step_s = 1.0 / f64::from(self.hz);
        let curve = Curve::through(keys);
        let (first, last) = (keys[0].time_s, keys[keys.len() - 1].time_s);
        let count = ((last - first) / step_s).round() as u32;
        let poses = (0..count).map(|i| {
            let time_s = first + f64::from(i) * step_s;
            let before = curve.at(time_s - step_s);
            let now = curve.at(time_s);
            let speed = distance(&before, &now) / step_s;
            pose(time_s, hand.held(now, time_s, speed))
        });
        poses.collect()
    }
}

fn distance(a: &[f64; 5], b: &[f64; 5]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

/// Positions are rounded to millimetres, times to a tenth of one, rotations to a millionth.
fn pose(time_s: f64, [x, y, z, heading, pitch]: [f64; 5]) -> Pose {
    let round = |x: f64, steps: f64| (x * steps).round() / steps;
    let (sin_y, cos_y) = sin_cos_deg(-heading / 2.0);
    let (sin_x, cos_x) = sin_cos_deg(pitch / 2.0);
    let [x_q, y_q, z_q, w_q] =
        [cos_y * sin_x, sin_y * cos_x, -sin_y * sin_x, cos_y * cos_x].map(|c| round(c, 1e6) as f32);
    Pose {
        time_s: round(time_s, 1e4),
        position: DVec3::new(round(x, 1e3), round(y, 1e3), round(z, 1e3)),
        rotation: Quat::from_xyzw(x_q, y_q, z_q, w_q),
    }
}

/// A smooth curve through keys that never overshoots: where two keys agree, the camera rests. Piecewise cubic, slopes
/// by Fritsch and Butland, "A Method for Constructing Local Monotone Piecewise Cubic Interpolants", 1984; flat at
/// both ends.
struct Curve<'a> {
    keys: &'a [Key],
    slopes: Vec<[f64; 5]>,
}

impl<'a> Curve<'a> {
    fn through(keys: &'a [Key]) -> Self {
        let mut slopes = vec![[0.0; 5]; keys.len()];
        for (slope, three) in slopes[1..].iter_mut().zip(keys.windows(3)) {
            *slope = std::array::from_fn(|i| monotone_slope(three, i));
        }
        Self { keys, slopes }
    }

    /// The state at a time, held at both ends.
    fn at(&self, time_s: f64) -> [f64; 5] {
        let after = self.keys.partition_point(|k| k.time_s <= time_s);
        if after == 0 || after == self.keys.len() {
            return self.keys[after.saturating_sub(1)].state;
        }
        let (a, b) = (self.keys[after - 1], self.keys[after]);
        let span = b.time_s - a.time_s;
        let u = (time_s - a.time_s) / span;
        std::array::from_fn(|i| {
            let (p, q) = (a.state[i], b.state[i]);
            let (dp, dq) = (self.slopes[after - 1][i] * span, self.slopes[after][i] * span);
            p + u * (dp + u * (3.0 * (q - p) - 2.0 * dp - dq + u * (2.0 * (p - q) + dp + dq)))
        })
    }
}

fn monotone_slope(three: &[Key], i: usize) -> f64 {
    let h = [three[1].time_s - three[0].time_s, three[2].time_s - three[1].time_s];
    let rise =
        [(three[1].state[i] - three[0].state[i]) / h[0], (three[2].state[i] - three[1].state[i]) / h[1]];
    if rise[0] * rise[1] <= 0.0 {
        return 0.0;
    }
    3.0 * (h[0] + h[1]) / ((2.0 * h[1] + h[0]) / rise[0] + (h[1] + 2.0 * h[0]) / rise[1])
}

/// Who carries the camera: looks about and bobs at a walk, is steady at rest.
struct Hand {
    sway: Vec<[f64; 2]>,
}

/// The view wanders to a new direction so often.
const SWAY_S: f64 = 0.75;

impl Hand {
    fn new(seed: u64, sway_deg: f64) -> Self {
        let mut dice = Dice::new(seed, 9);
        let mut towards = || [dice.between(-sway_deg, sway_deg), dice.between(-sway_deg, sway_deg) / 2.0];
        Self { sway: (0..97).map(|_| towards()).collect() }
    }

    fn held(&self, [x, y, z, heading, pitch]: [f64; 5], time_s: f64, speed: f64) -> [f64; 5] {
        let gait = speed.min(1.0);
        let (whole, part) = ((time_s / SWAY_S).floor(), time_s / SWAY_S - (time_s / SWAY_S).floor());
        let [from, to] = [0, 1].map(|i| self.sway[(whole as usize + i) % self.sway.len()]);
        let ease = part * part * (3.0 - 2.0 * part);
        let off = |i: usize| gait * (from[i] + (to[i] - from[i]) * ease);
        let bob = 0.015 * gait * sin_cos_deg(time_s * 1.8 * 360.0).0;
        [x, y + bob, z, heading + off(0), pitch + off(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const ROUND: &[Key] = &[
        key(0.0, [0.0, 1.7, 0.0], 0.0, 0.0),
        key(4.0, [0.0, 1.7, -6.0], 90.0, 0.0),
        key(8.0, [0.0, 1.7, -6.0], 90.0, 0.0),
        key(10.0, [4.0, 1.7, -6.0], 90.0, -20.0),
    ];

    fn film() -> Film<'static> {
        Film { name: "round", hz: 20, sway_deg: 1.0, shots: &[ROUND] }
    }

    #[test]
    fn a_heading_is_a_compass_heading() {
        let looks =
            |heading, pitch| pose(0.0, [0.0, 0.0, 0.0, heading, pitch]).rotation.normalize() * Vec3::NEG_Z;
        assert!((looks(0.0, 0.0) - Vec3::NEG_Z).length() < 1e-5);
        assert!((looks(90.0, 0.0) - Vec3::X).length() < 1e-5);
        assert!((looks(180.0, 0.0) - Vec3::Z).length() < 1e-5);
        assert!(looks(90.0, 30.0).y > 0.49);
    }

    #[test]
    fn the_camera_rests_where_two_keys_agree() {
        let path = film().shoot(1);
        let at = |time_s: f64| path.poses()[(time_s * 20.0) as usize];
        assert_eq!((at(4.5).position, at(4.5).rotation), (at(7.5).position, at(7.5).rotation));
        assert_ne!(at(2.0).rotation, at(2.1).rotation);
    }

    #[test]
    fn a_curve_passes_its_keys_and_never_overshoots() {
        let curve = Curve::through(ROUND);
        assert!(ROUND.iter().all(|k| curve.at(k.time_s) == k.state));
        let within = |t: i32| {
            let [x, _, z, heading, _] = curve.at(f64::from(t) / 100.0);
            (0.0..=4.0).contains(&x) && (-6.0..=0.0).contains(&z) && (0.0..=90.0).contains(&heading)
        };
        assert!((-100..1200).all(within));
    }
}
