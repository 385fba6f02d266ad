//! The frame that simplification works in: around the origin, about one unit wide, in double precision.

use glam::{DVec3, Vec3};

/// From object space to the frame and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    centre: DVec3,
    /// Object units per unit of the frame.
    size: f64,
}

impl Frame {
    /// The frame in which the box around these points has its longest side from −½ to ½.
    pub(super) fn around(points: impl Iterator<Item = Vec3>) -> Self {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = points.map(Vec3::as_dvec3).fold(empty, |(min, max), p| (min.min(p), max.max(p)));
        let size = (max - min).max_element();
        if size > 0.0 {
            return Self { centre: min.midpoint(max), size };
        }
        Self { centre: if min.is_finite() { min } else { DVec3::ZERO }, size: 1.0 }
    }

    pub(super) fn enter(&self, position: Vec3) -> DVec3 {
        (position.as_dvec3() - self.centre) / self.size
    }

    pub(super) fn leave(&self, place: DVec3) -> Vec3 {
        (place * self.size + self.centre).as_vec3()
    }

    /// A length, in object units.
    pub(super) fn leave_length(&self, length: f64) -> f32 {
        (length * self.size) as f32
    }
}
