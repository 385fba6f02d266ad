//! A surface made ready for measuring: in double precision, checked, and findable.

use glam::{DVec3, Vec3};

use super::bvh::Bvh;
use super::sampling::Place;
use super::{DeviationError, Flaw};
use crate::bake::surface::Surface;

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

/// The referenced vertices and the triangles of a surface, relative to an origin of its neighbourhood.
///
/// Differences of `f32` are exact in `f64` or as precise as their size, so that a mesh far from its origin is measured
/// as well as one around it.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Corners of triangles, in the order of the tree.
    pub corners: Vec<[DVec3; 3]>,
    /// The same as numbers of vertices; vertices at the same place are one.
    pub triangles: Vec<[u32; 3]>,
    pub vertex_count: usize,
    /// Beyond each edge, from corner k to k + 1, a triangle that has this edge the other way round, or [`NONE`].
    pub neighbours: Vec<[u32; 3]>,
    pub bvh: Bvh,
    /// For each triangle its index in the surface.
    pub order: Vec<u32>,
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
        let (triangles, vertex_count) = welded(surface, &order);
        let neighbours = neighbours(&triangles);
        let (min, max) = extremes(corners.as_flattened());
        let (diagonal, reach) = ((max - min).length(), max.abs().max(min.abs()).max_element());
        Ok(Self { corners, triangles, vertex_count, neighbours, bvh, order, diagonal, reach })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// Where a place is; from the first corner on, so that in a triangle that is a point it is that point.
    pub(super) fn point(&self, place: &Place) -> DVec3 {
        let [a, b, c] = self.corners[place.triangle];
        a + (b - a) * place.weights[1] + (c - a) * place.weights[2]
    }
}

/// A point near the surface that `f32` represents: its first vertex.
pub(super) fn origin(surface: &Surface) -> DVec3 {
    let first = surface.triangles.first().and_then(|triangle| surface.positions.get(triangle[0] as usize));
    first.copied().filter(|position| position.is_finite()).unwrap_or(Vec3::ZERO).as_dvec3()
}

pub(super) fn check(surface: &Surface) -> Result<(), DeviationError> {
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

/// The triangles in `order`, their vertices numbered by place, and how many places there are. O(n log n).
fn welded(surface: &Surface, order: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let mut used = vec![false; surface.positions.len()];
    surface.triangles.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
    let mut vertices: Vec<u32> =
        (0..).zip(&used).filter(|&(_, &used)| used).map(|(vertex, _)| vertex).collect();
    // Adding zero makes one zero of the two.
    let key = |vertex: u32| (surface.positions[vertex as usize] + 0.0).to_array().map(f32::to_bits);
    vertices.sort_unstable_by_key(|&vertex| key(vertex));
    let mut numbers = vec![NONE; surface.positions.len()];
    let mut count = 0;
    for same in vertices.chunk_by(|&a, &b| key(a) == key(b)) {
        same.iter().for_each(|&vertex| numbers[vertex as usize] = count);
        count += 1;
    }
    let number = |&vertex: &u32| numbers[vertex as usize];
    (order.iter().map(|&i| surface.triangles[i as usize].each_ref().map(number)).collect(), count as usize)
}

/// A side of a triangle: its ends, the lower first, and the triangle and corner that it starts from.
struct Side {
    ends: [u32; 2],
    rises: bool,
    triangle: u32,
    corner: u8,
}

/// For every side the first triangle that has it the other way round. O(n log n).
fn neighbours(triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let side = |triangle: u32, corners: &[u32; 3], corner: u8| {
        let [a, b] = [corner, (corner + 1) % 3].map(|k| corners[usize::from(k)]);
        Side { ends: [a.min(b), a.max(b)], rises: a < b, triangle, corner }
    };
    let all = (0..).zip(triangles).flat_map(|(i, corners)| [0, 1, 2].map(|k| side(i, corners, k)));
    let mut sides: Vec<Side> = all.collect();
    sides.sort_unstable_by_key(|side| (side.ends, side.triangle, side.corner));
    let mut neighbours = vec![[NONE; 3]; triangles.len()];
    for edge in sides.chunk_by(|a, b| a.ends == b.ends) {
        let first = [false, true].map(|rises| edge.iter().find(|side| side.rises == rises));
        for side in edge {
            let opposite = first[usize::from(!side.rises)];
            neighbours[side.triangle as usize][usize::from(side.corner)] =
                opposite.map_or(NONE, |s| s.triangle);
        }
    }
    neighbours
}

/// The smallest and the largest coordinates; zeros without points.
fn extremes(points: &[DVec3]) -> (DVec3, DVec3) {
    let start = points.first().copied().unwrap_or(DVec3::ZERO);
    points.iter().fold((start, start), |(min, max), &point| (min.min(point), max.max(point)))
}
