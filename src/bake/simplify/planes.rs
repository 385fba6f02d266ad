//! Sums of squared distances to planes, and where they are least.

use std::ops::{Add, AddAssign};

use glam::{DMat3, DVec3};

/// A weighted sum of squared distances to planes: `vᵀAv + 2bᵀv + c` (M. Garland, P. Heckbert, "Surface simplification
/// using quadric error metrics", 1997), and the weight of the surface that they are of.
///
/// In double precision throughout and seen from one origin for all, which is good to about 1e-8 of the distance from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Planes {
    square: DMat3,
    linear: DVec3,
    constant: f64,
    /// Weighted area that the planes are of.
    pub(super) area: f64,
}

/// How stiffly the best place is held at the one to start from, as a share of all curvature: enough to stay on flat
/// parts and straight creases, too little to show elsewhere.
const STIFFNESS: f64 = 1e-4;

impl Planes {
    /// No error, at the origin for `glam`'s matrices are the identity by default.
    pub(super) const NONE: Self = Self { square: DMat3::ZERO, linear: DVec3::ZERO, constant: 0.0, area: 0.0 };

    /// The plane of a triangle, counted by its area times a weight.
    pub(super) fn of([a, b, c]: [DVec3; 3], weight: f64) -> Self {
        let across = (b - a).cross(c - a);
        let area = 0.5 * weight * across.length();
        Self { area, ..Self::upright(across.normalize_or_zero(), a, area) }
    }

    /// A plane that is no part of the surface, by its unit normal and a point on it.
    pub(super) fn upright(normal: DVec3, through: DVec3, weight: f64) -> Self {
        let offset = -normal.dot(through);
        let square = weight * DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Self { square, linear: weight * offset * normal, constant: weight * offset * offset, area: 0.0 }
    }

    /// The sum at a place, ≥ 0.
    pub(super) fn at(&self, place: DVec3) -> f64 {
        let sum = place.dot(self.square * place + 2.0 * self.linear) + self.constant;
        sum.max(0.0)
    }

    /// The root mean square of the distance at a place; 0 where nothing counts.
    pub(super) fn distance_at(&self, place: DVec3) -> f64 {
        if self.area > 0.0 { (self.at(place) / self.area).sqrt() } else { 0.0 }
    }

    /// The place where the sum is least, not far from `near` without a reason; `near` if nothing counts.
    pub(super) fn least(&self, near: DVec3) -> DVec3 {
        let weight = self.square.x_axis.x + self.square.y_axis.y + self.square.z_axis.z;
        let stiff = self.square + DMat3::from_diagonal(DVec3::splat(STIFFNESS * weight));
        let place = near - stiff.inverse() * (self.square * near + self.linear);
        if place.is_finite() { place } else { near }
    }
}

impl Add for Planes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            square: self.square + other.square,
            linear: self.linear + other.linear,
            constant: self.constant + other.constant,
            area: self.area + other.area,
        }
    }
}

impl AddAssign for Planes {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
