//! What is shown from a direction.

use glam::DVec3;

use super::frame::View;
use super::{Facing, Frame, Impostor, Kind, Octahedron};

/// A frame that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Its index.
    pub frame: usize,
    /// How much it counts, above 1e-9, of a sum of 1. The share in the blend for octahedral impostors; of
    /// cross-quads, all of which are shown, what each covers on the screen.
    pub weight: f64,
}

impl Impostor {
    /// The frames that are shown to a viewer in this direction from the middle, which may have any length: the first that
    /// counts most first. Outside of what is valid, those that are nearest to it.
    pub fn sights(&self, direction: DVec3) -> Vec<Sight> {
        let direction = direction.normalize_or(self.front);
        let mut sights: Vec<Sight> = match self.kind {
            Kind::Billboard { .. } => vec![Sight { frame: self.billboard_frame(direction), weight: 1.0 }],
            Kind::CrossQuads { .. } => shares(&self.frames, direction),
            Kind::Octahedral { frames, hemisphere } => {
                let map = Octahedron::new(frames, hemisphere);
                let three = map.frames(self.basis().local(direction));
                three.into_iter().map(|(frame, weight)| Sight { frame, weight }).collect()
            }
        };
        sights.retain(|sight| sight.weight > LEAST_WEIGHT);
        sights.sort_by(|a, b| b.weight.total_cmp(&a.weight).then(a.frame.cmp(&b.frame)));
        sights
    }

    /// The part of the yaw that a direction is in.
    fn billboard_frame(&self, direction: DVec3) -> usize {
        let half = self.validity.yaw_deg.to_radians();
        let (yaw, _) = self.basis().angles(direction);
        let part = (yaw + half) / (2.0 * half) * self.frames.len() as f64;
        (part.max(0.0) as usize).min(self.frames.len() - 1)
    }

    /// Where in object space a frame shows a point of object space to a viewer in this direction from the middle.
    ///
    /// # Panics
    /// Where there is no such frame.
    pub fn placed(&self, frame: usize, point: DVec3, direction: DVec3) -> DVec3 {
        let frame = &self.frames[frame];
        let quad = self.quad(frame, direction.normalize_or(self.front));
        self.center + quad.lift(frame.view().flat(point - self.center))
    }

    /// Across what a frame is shown to a viewer in this direction, which is a unit vector.
    pub(super) fn quad(&self, frame: &Frame, direction: DVec3) -> View {
        let basis = self.basis();
        match self.kind {
            Kind::CrossQuads { .. } | Kind::Octahedral { .. } => frame.view(),
            Kind::Billboard { facing: Facing::Viewer, .. } => basis.view(direction),
            Kind::Billboard { facing: Facing::Axis, .. } => {
                let (yaw, _) = basis.angles(direction);
                basis.view(basis.direction(yaw, 0.0))
            }
        }
    }

    /// How much the quad that faces a direction best shows of itself, from 0, edge on, to 1.
    pub fn facing(&self, direction: DVec3) -> f64 {
        let direction = direction.normalize_or(self.front);
        match self.kind {
            Kind::CrossQuads { .. } => {
                self.frames.iter().map(|frame| frame.direction.dot(direction).abs()).fold(0.0, f64::max)
            }
            Kind::Billboard { facing: Facing::Axis, .. } => self.basis().across(direction).length(),
            _ => 1.0,
        }
    }
}

/// Rounding alone makes such weights: of frames beyond the edge that a direction is on, as all from below a hemisphere
/// are.
const LEAST_WEIGHT: f64 = 1e-9;

/// What each quad covers, of all that they cover together.
fn shares(frames: &[Frame], direction: DVec3) -> Vec<Sight> {
    let seen = |frame: &Frame| frame.direction.dot(direction).abs() * polygon_area(frame);
    let all: f64 = frames.iter().map(seen).sum();
    (0..).zip(frames).map(|(i, frame)| Sight { frame: i, weight: seen(frame) / all }).collect()
}

/// Of its outline, in square object units.
pub(super) fn polygon_area(frame: &Frame) -> f64 {
    let next = frame.outline.iter().cycle().skip(1);
    frame.outline.iter().zip(next).map(|(a, b)| 0.5 * a.perp_dot(*b)).sum()
}
