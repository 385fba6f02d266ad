//! A surface made ready for measuring: in double precision, checked, and findable.

use glam::{DVec3, Vec3};

use super::bvh::Bvh;
use super::{DeviationError, Flaw};
use crate::bake::surface::Surface;

/// The referenced vertices and the triangles of a surface, relative to an origin of its neighbourhood.
///
/// Differences of `f32` are exact in `f64` or as precise as their size, so that a mesh far from its origin is measured as
/// well as one around it.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Corners of triangles, in the order of the tree.
    pub corners: Vec<[DVec3; 3]>,
    /// The same as numbers of vertices, from 0 in the order in which they appear.
    pub triangles: Vec<[u32; 3]>,
    pub vertex_count: usize,
    pub bvh: Bvh,
    /// The length of the bounding box's diagonal.
    pub diagonal: f64,
    /// The largest coordinate, without its sign.
    pub reach: f64,
}

impl Shape {
    pub(super) fn new(surface: &Surface, origin: DVec3) -> Result<Self, DeviationError> {
        check(surface)?;
        let place = |&vertex: &u32| surface.positions[vertex as usize].as_dvec3() - origin;
        let corners: Vec<[DVec3; 3]> =
            surface.triangles.iter().map(|triangle| triangle.each_ref().map(place)).collect();
        let (bvh, order) = Bvh::new(&corners);
        let corners: Vec<[DVec3; 3]> = order.iter().map(|&i| corners[i as usize]).collect();
        let (triangles, vertex_count) = renumbered(surface, &order);
        let (min, max) = extremes(corners.as_flattened());
        let (diagonal, reach) = ((max - min).length(), max.abs().max(min.abs()).max_element());
        Ok(Self { corners, triangles, vertex_count, bvh, diagonal, reach })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }
}

/// A point near the surface that `f32` represents: its first vertex.
pub(super) fn origin(surface: &Surface) -> DVec3 {
    let first = surface.triangles.first().and_then(|triangle| surface.positions.get(triangle[0] as usize));
    first.copied().filter(|position| position.is_finite()).unwrap_or(Vec3::ZERO).as_dvec3()
}

fn check(surface: &Surface) -> Result<(), DeviationError> {
    if surface.triangles.len() > i32::MAX as usize {
        return Err(DeviationError::TooManyTriangles);
    }
    for (triangle, corners) in surface.triangles.iter().enumerate() {
        for &vertex in corners {
            let flaw = match surface.positions.get(vertex as usize) {
                None => Flaw::NoSuchVertex { vertex, vertices: surface.positions.len() },
                Some(position) if !position.is_finite() => Flaw::NotFinite { vertex },
                Some(_) => continue,
            };
            return Err(DeviationError::Triangle { triangle, flaw });
        }
    }
    Ok(())
}

/// The triangles in `order`, their vertices numbered as they appear, and how many those are.
fn renumbered(surface: &Surface, order: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let mut numbers = vec![u32::MAX; surface.positions.len()];
    let mut count = 0;
    let mut number = |&vertex: &u32| {
        let number = &mut numbers[vertex as usize];
        if *number == u32::MAX {
            *number = count;
            count += 1;
        }
        *number
    };
    let triangles =
        order.iter().map(|&i| surface.triangles[i as usize].each_ref().map(&mut number)).collect();
    (triangles, count as usize)
}

/// The smallest and the largest coordinates; zeros without points.
fn extremes(points: &[DVec3]) -> (DVec3, DVec3) {
    let start = points.first().copied().unwrap_or(DVec3::ZERO);
    points.iter().fold((start, start), |(min, max), &point| (min.min(point), max.max(point)))
}
