//! The points of a surface that are nearest to a point.

use glam::{DVec3, Vec3};

use super::DeviationError;
use super::bvh::Nearest;
use super::facet::nearest_weights;
use super::shape::{self, Shape};
use crate::bake::surface::Surface;

/// Triangles are equally near to a point where their distances differ by less than this share of the largest
/// coordinate: what positions in single precision can tell apart.
const SAME: f64 = 1e-7;

/// A surface on which points are looked for.
pub(in crate::bake) struct Finder {
    origin: DVec3,
    shape: Shape,
    /// Of the surface's triangles.
    normals: Vec<DVec3>,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::bake) struct Spot {
    /// The triangle, as the surface numbers them.
    pub triangle: usize,
    /// How much of each corner there is in it: ≥ 0, with a sum of 1.
    pub weights: [f64; 3],
    /// How far it is, in object units.
    pub distance: f64,
    /// Where it is.
    pub place: Vec3,
    /// The longest side of the triangle, in object units.
    pub side: f64,
}

impl Finder {
    /// Prepares a surface; O(n log n). `None` where it has no triangle.
    ///
    /// # Errors
    /// [`DeviationError`], for a surface that is none.
    pub fn new(surface: &Surface) -> Result<Option<Self>, DeviationError> {
        let origin = shape::origin(surface);
        shape::check(surface)?;
        if surface.triangles.is_empty() {
            return Ok(None);
        }
        let shape = Shape::new(surface, origin)?;
        let normals = shape.corners.iter().map(|[a, b, c]| (b - a).cross(c - a)).collect();
        Ok(Some(Self { origin, shape, normals }))
    }

    /// The nearest point, which is on one of the triangles that face the way of `normal` if one of those is hardly
    /// farther: by no more than half the longest side of the nearest triangle. So a point of a thin plate goes to its
    /// own side. Without a normal, which is zero, the nearest of all.
    pub fn nearest(&self, point: Vec3, normal: DVec3) -> Spot {
        let at = point.as_dvec3() - self.origin;
        let nearest = self.shape.bvh.nearest(at, 0);
        let faces = |t: u32| self.normals[t as usize].dot(normal) > 0.0;
        if normal == DVec3::ZERO || faces(nearest.triangle) {
            return self.spot(nearest.triangle, at);
        }
        let farthest = nearest.distance2.sqrt() + 0.5 * self.side(nearest.triangle);
        let bound = Nearest { distance2: farthest * farthest, ..nearest };
        self.spot(self.shape.bvh.nearer(at, bound, faces).triangle, at)
    }

    /// The nearest points of all triangles that are as near as any, in no order that means anything but always the same.
    pub fn touching(&self, point: Vec3) -> Vec<Spot> {
        let at = point.as_dvec3() - self.origin;
        let nearest = self.shape.bvh.nearest(at, 0);
        let most = nearest.distance2.sqrt() + SAME * self.shape.reach.max(at.abs().max_element());
        let mut spots = Vec::new();
        self.shape.bvh.each_within(at, most * most, |triangle| spots.push(self.spot(triangle, at)));
        spots
    }

    fn spot(&self, triangle: u32, at: DVec3) -> Spot {
        let corners = &self.shape.corners[triangle as usize];
        let weights = nearest_weights(corners, at);
        let place: DVec3 = corners.iter().zip(weights).map(|(&corner, weight)| corner * weight).sum();
        Spot {
            triangle: self.shape.order[triangle as usize] as usize,
            weights,
            distance: at.distance(place),
            place: (place + self.origin).as_vec3(),
            side: self.side(triangle),
        }
    }

    fn side(&self, triangle: u32) -> f64 {
        let [a, b, c] = self.shape.corners[triangle as usize];
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }
}
