//! A triangle cut along the edges of the surface below it.

use glam::{DVec2, DVec3};

use super::facet::Facet;
use super::shape::{NONE, Shape};

/// Cells reach this share of the largest coordinate across their edges: more than rounding can make them fall short.
const OVERLAP: f64 = 4e-15;

/// A triangle whose height is a smaller share of its base is not laid over anything.
const THINNEST: f64 = 0.02;

/// No more corners than a triangle has after three cuts, and two to spare.
pub(super) const MOST_CORNERS: usize = 8;

/// A convex polygon in the plane.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [DVec2; MOST_CORNERS],
    count: usize,
}

impl Polygon {
    fn new(corners: &[DVec2]) -> Self {
        let mut polygon = Self { corners: [DVec2::ZERO; MOST_CORNERS], count: 0 };
        corners.iter().for_each(|&corner| polygon.push(corner));
        polygon
    }

    fn push(&mut self, corner: DVec2) {
        if self.count < MOST_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    fn corners(&self) -> &[DVec2] {
        &self.corners[..self.count]
    }

    /// What lies on the inner side of `edge` (I. Sutherland, G. Hodgman, "Reentrant polygon clipping", 1974).
    fn clipped(&self, edge: &Edge) -> Self {
        let mut inside = Self::new(&[]);
        let Some(&last) = self.corners().last() else { return inside };
        let (mut before, mut depth_before) = (last, edge.depth(last) + edge.overlap);
        for &corner in self.corners() {
            let depth = edge.depth(corner) + edge.overlap;
            if (depth < 0.0) != (depth_before < 0.0) {
                inside.push(before + (corner - before) * (depth_before / (depth_before - depth)));
            }
            if depth >= 0.0 {
                inside.push(corner);
            }
            (before, depth_before) = (corner, depth);
        }
        inside
    }

    fn doubled_area(&self) -> f64 {
        let corners = self.corners();
        (2..corners.len()).map(|k| (corners[k - 1] - corners[0]).perp_dot(corners[k] - corners[0])).sum()
    }
}

/// An edge of a triangle's shadow; depths and the overlap are scaled by its length.
#[derive(Clone, Copy, Debug)]
struct Edge {
    start: DVec2,
    along: DVec2,
    overlap: f64,
}

impl Edge {
    fn new(start: DVec2, end: DVec2, overlap: f64) -> Self {
        let along = end - start;
        Self { start, along, overlap: overlap * (along.x.abs() + along.y.abs()) }
    }

    /// How far inside a point is, negative outside.
    fn depth(&self, point: DVec2) -> f64 {
        self.along.perp_dot(point - self.start)
    }

    /// Whether something of the `whole` beyond this edge is to be reached through it from the `cell`.
    ///
    /// Where the two share no more of the edge than a point, another edge leads there.
    fn is_crossed(&self, whole: &Polygon, cell: &Polygon) -> bool {
        if !whole.corners().iter().any(|&corner| self.depth(corner) < -2.0 * self.overlap) {
            return false;
        }
        let on_edge = cell.corners().iter().filter(|&&corner| self.depth(corner) <= self.overlap);
        let places = on_edge.map(|&corner| self.along.dot(corner - self.start));
        let (first, last) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        last - first > 4.0 * self.overlap
    }
}

/// A convex part of a triangle, and the triangle of the other surface below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub triangle: u32,
    corners: [DVec3; MOST_CORNERS],
    count: usize,
}

impl Cell {
    pub(super) fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }
}

/// Lays triangles of one surface over another one.
///
/// From a triangle below it goes on across every edge that the triangle above crosses. When that has come to an end and
/// every edge had a neighbour on its other side, the shadows of what was visited cover the triangle: a boundary of the
/// covered part would be an edge that was not crossed.
pub(super) struct Overlay<'a> {
    below: &'a Shape,
    /// For each triangle below, the round in which it was last visited.
    visited: Vec<u32>,
    round: u32,
    waiting: Vec<u32>,
    overlap: f64,
}

/// The triangle above, in its own plane.
struct Plane {
    origin: DVec3,
    axes: [DVec3; 2],
    whole: Polygon,
}

impl Plane {
    /// The plane of a triangle; `None` of a needle.
    fn new(corners: &[DVec3; 3]) -> Option<Self> {
        let facet = Facet::new(*corners);
        let (origin, axes) = facet.frame();
        let mut plane = Self { origin, axes, whole: Polygon::new(&[]) };
        plane.whole = Polygon::new(&corners.map(|corner| plane.shadow(corner)));
        (facet.slenderness() > THINNEST).then_some(plane)
    }

    fn shadow(&self, point: DVec3) -> DVec2 {
        let offset = point - self.origin;
        DVec2::new(offset.dot(self.axes[0]), offset.dot(self.axes[1]))
    }

    fn lift(&self, point: DVec2) -> DVec3 {
        self.origin + self.axes[0] * point.x + self.axes[1] * point.y
    }

    /// The edges of a triangle's shadow, the inside to their left, where it is seen from the side that `turned` says;
    /// `None` where it is seen from the other side or edge-on.
    fn edges(&self, corners: &[DVec3; 3], turned: bool, overlap: f64) -> Option<[Edge; 3]> {
        let shadow = corners.map(|corner| self.shadow(corner));
        let edges = [0, 1, 2].map(|k| {
            let (start, end) = (shadow[k], shadow[(k + 1) % 3]);
            if turned { Edge::new(end, start, overlap) } else { Edge::new(start, end, overlap) }
        });
        let thick = |k: usize| edges[k].depth(shadow[(k + 2) % 3]) > 4.0 * edges[k].overlap;
        (0..3).all(thick).then_some(edges)
    }

    fn cell(&self, triangle: u32, polygon: &Polygon) -> Cell {
        let corners = polygon.corners.map(|corner| self.lift(corner));
        Cell { triangle, corners, count: polygon.count }
    }
}

impl<'a> Overlay<'a> {
    pub(super) fn new(below: &'a Shape, reach: f64) -> Self {
        let visited = vec![0; below.corners.len()];
        Self { below, visited, round: 0, waiting: Vec::new(), overlap: OVERLAP * reach }
    }

    /// Calls `visit` with cells that together cover the triangle with these `corners`, beginning with the triangle
    /// below that is named; returns how many.
    ///
    /// `None` where cells cannot be shown to cover it: at borders, folds and vertical walls below, for needles, and
    /// beyond `most` cells.
    pub(super) fn lay(
        &mut self,
        corners: &[DVec3; 3],
        start: u32,
        most: usize,
        mut visit: impl FnMut(&Cell),
    ) -> Option<usize> {
        let plane = Plane::new(corners)?;
        let turned = plane.edges(&self.below.corners[start as usize], false, self.overlap).is_none();
        let (mut cells, mut area) = (0, 0.0);
        self.begin(start);
        while let Some(triangle) = self.waiting.pop() {
            let edges = plane.edges(&self.below.corners[triangle as usize], turned, self.overlap)?;
            let polygon = edges.iter().fold(plane.whole, |polygon, edge| polygon.clipped(edge));
            for (edge, &neighbour) in edges.iter().zip(&self.below.neighbours[triangle as usize]) {
                if edge.is_crossed(&plane.whole, &polygon) {
                    self.enter((neighbour != NONE).then_some(neighbour)?);
                }
            }
            visit(&plane.cell(triangle, &polygon));
            cells += 1;
            area += polygon.doubled_area();
            if cells > most {
                return None;
            }
        }
        (area > 0.5 * plane.whole.doubled_area()).then_some(cells)
    }

    fn begin(&mut self, start: u32) {
        self.round = self.round.wrapping_add(1);
        self.waiting.clear();
        self.enter(start);
    }

    fn enter(&mut self, triangle: u32) {
        if self.visited[triangle as usize] != self.round {
            self.visited[triangle as usize] = self.round;
            self.waiting.push(triangle);
        }
    }
}
