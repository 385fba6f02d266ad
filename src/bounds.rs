//! Bounding volumes, in object or world units.

use glam::Vec3;

/// A bounding sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sphere {
    /// Centre.
    pub center: Vec3,
    /// Radius, ≥ 0.
    pub radius: f32,
}

impl Sphere {
    /// The sphere around `center`.
    pub const fn new(center: Vec3, radius: f32) -> Self {
        Self { center, radius }
    }

    /// Whether all four numbers are finite and the radius is not negative.
    pub fn is_valid(&self) -> bool {
        self.center.is_finite() && self.radius.is_finite() && self.radius >= 0.0
    }

    /// The smallest box around the sphere.
    pub fn aabb(&self) -> Aabb {
        Aabb { min: self.center - self.radius, max: self.center + self.radius }
    }
}

/// An axis-aligned bounding box. The empty box has `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The box that holds nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`; [`Aabb::EMPTY`] without points.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Half the surface area, the measure that a bounding-volume hierarchy is judged by; 0 when empty.
    pub fn half_area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let e = self.max - self.min;
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The sphere through the corners: never smaller than the box.
    pub fn sphere(&self) -> Sphere {
        if self.is_empty() {
            return Sphere::default();
        }
        let center = self.min * 0.5 + self.max * 0.5;
        Sphere::new(center, (self.max - center).length().max((center - self.min).length()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sphere_of_a_box_holds_its_corners() {
        let b = Aabb::around([Vec3::new(-1.0, 2.0, 3.0), Vec3::new(4.0, -5.0, 6.0)]);
        let s = b.sphere();
        assert!((b.min - s.center).length() <= s.radius && (b.max - s.center).length() <= s.radius);
    }

    #[test]
    fn an_empty_box_has_no_area_and_a_point_for_a_sphere() {
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(Aabb::around([]).sphere(), Sphere::default());
    }
}
