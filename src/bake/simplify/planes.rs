//! Sums of squared distances to planes, and where they are least.

use std::ops::{Add, AddAssign};

use glam::{DMat3, DVec3};

use super::link::others;
use super::workpiece::Workpiece;

/// How much leaving a border counts, compared with leaving the surface.
const BORDER: f64 = 10.0;

/// A weighted sum of squared distances to planes: `vᵀAv + 2bᵀv + c` (M. Garland, P. Heckbert, "Surface simplification
/// using quadric error metrics", 1997), and the weight of the surface that they are of.
///
/// In double precision throughout and seen from one origin for all, which is good to about 1e-8 of the distance from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Planes {
    square: DMat3,
    linear: DVec3,
    constant: f64,
    /// Area that the planes are of, weighted and as it is.
    area: f64,
    plain_area: f64,
}

/// How stiffly the best place is held at the one to start from, as a share of all curvature: enough to stay on flat
/// parts and straight creases, too little to show elsewhere.
const STIFFNESS: f64 = 1e-4;

impl Planes {
    /// No error, at the origin for `glam`'s matrices are the identity by default.
    pub(super) const NONE: Self =
        Self { square: DMat3::ZERO, linear: DVec3::ZERO, constant: 0.0, area: 0.0, plain_area: 0.0 };

    /// The plane of a triangle, counted by its area times a weight.
    pub(super) fn of([a, b, c]: [DVec3; 3], weight: f64) -> Self {
        let across = (b - a).cross(c - a);
        let plain_area = 0.5 * across.length();
        let area = weight * plain_area;
        Self { area, plain_area, ..Self::upright(across.normalize_or_zero(), a, area) }
    }

    /// A plane that is no part of the surface, by its unit normal and a point on it.
    pub(super) fn upright(normal: DVec3, through: DVec3, weight: f64) -> Self {
        let offset = -normal.dot(through);
        let square = weight * DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
        Self { square, linear: weight * offset * normal, constant: weight * offset * offset, ..Self::NONE }
    }

    /// The plane through a border that stands upright on its triangle.
    pub(super) fn at_border([a, b, c]: [DVec3; 3], [p, q]: [DVec3; 2], weight: f64) -> Self {
        let normal = (b - a).cross(c - a).cross(q - p).normalize_or_zero();
        Self::upright(normal, p, BORDER * weight * p.distance_squared(q))
    }

    /// Per vertex, the planes of its triangles and borders.
    pub(super) fn of_vertices(piece: &Workpiece) -> Vec<Self> {
        let mut planes = vec![Self::NONE; piece.positions.len()];
        for triangle in 0..piece.triangles.len() as u32 {
            let plane = Self::of(piece.places(triangle), piece.weight(triangle));
            piece.triangles[triangle as usize].iter().for_each(|&v| planes[v as usize] += plane);
        }
        for vertex in piece.vertices() {
            for &triangle in piece.fans.of(vertex) {
                for end in others(piece.triangles[triangle as usize], vertex) {
                    if piece.at_edge(vertex, end).count() != 2 {
                        let ends = [piece.place(vertex), piece.place(end)];
                        let upright = Self::at_border(piece.places(triangle), ends, piece.weight(triangle));
                        planes[vertex as usize] += upright;
                    }
                }
            }
        }
        planes
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

    /// The mean weight of the surface; 1 where there is none.
    pub(super) fn weight(&self) -> f64 {
        if self.plain_area > 0.0 { self.area / self.plain_area } else { 1.0 }
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
            plain_area: self.plain_area + other.plain_area,
        }
    }
}

impl AddAssign for Planes {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle in the plane z = `height`.
    fn flat(height: f64, weight: f64) -> Planes {
        Planes::of([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, height)), weight)
    }

    #[test]
    fn the_distance_is_the_root_of_the_mean_square_by_area_and_weight() {
        let sum = flat(0.0, 3.0) + flat(1.0, 1.0);
        assert!((sum.at(DVec3::new(5.0, 7.0, 2.0)) - 13.0).abs() < 1e-12);
        assert!((sum.distance_at(DVec3::Z * 2.0) - (13.0f64 / 4.0).sqrt()).abs() < 1e-12);
        assert_eq!(
            (sum.weight(), Planes::NONE.weight(), Planes::NONE.distance_at(DVec3::ONE)),
            (2.0, 1.0, 0.0)
        );
    }

    #[test]
    fn the_least_is_between_planes_and_near_where_one_stands_on_them() {
        let near = DVec3::new(-4.0, 9.0, 0.5);
        let least = (flat(0.0, 3.0) + flat(1.0, 1.0)).least(near);
        assert!(least.distance(DVec3::new(-4.0, 9.0, 0.25)) < 1e-3, "{least}");
        assert_eq!(Planes::NONE.least(near), near);
    }

    #[test]
    fn a_border_is_held_sideways_and_not_along_or_up() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let border = Planes::at_border(corners, [DVec3::ZERO, DVec3::X], 1.0);
        assert_eq!((border.at(DVec3::new(3.0, 0.0, 2.0)), border.at(DVec3::Y * 2.0)), (0.0, 4.0 * BORDER));
    }
}
