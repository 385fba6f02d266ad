//! Where to put the vertex that an edge is contracted to.

use glam::DVec3;

use super::form::Quadric;

/// Where to put the vertex that an edge is contracted to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// Where the error is least. Falls back to the best of the end points and the middle where that is far away.
    #[default]
    Optimal,
    /// At the end point of less error: the result's vertices are some of the old ones, attributes and all.
    Endpoint,
    /// Half way between the end points.
    Midpoint,
    /// At the mean of the end points, weighted by the area that was contracted into each.
    Average,
}

/// How stiffly the best place is held at the middle of the edge, as a share of all curvature. Higher gives away precision
/// on gently curved surfaces; lower lets vertices slide about on flat ones.
const STIFFNESS: f64 = 1e-6;

/// How far from the middle of the edge the best place may be, in lengths of the edge.
const REACH: f64 = 1.0;

/// One end of an edge, or what it is contracted to.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertex {
    /// Where it is, in the unit cube.
    pub(super) place: DVec3,
    /// The error of moving it.
    pub(super) quadric: Quadric,
}

/// The place, and its error, which is never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) place: DVec3,
    pub(super) error: f64,
}

impl Spot {
    #[inline]
    pub(super) fn new(place: DVec3, quadric: &Quadric) -> Self {
        Self { place, error: quadric.at(place).max(0.0) }
    }

    /// The one of less error, the first where they are equal.
    fn better(self, other: Self) -> Self {
        if other.error < self.error { other } else { self }
    }
}

impl Placement {
    /// Where the edge from `a` to `b`, whose quadrics sum up to `sum`, goes.
    #[inline]
    pub(super) fn spot(self, a: &Vertex, b: &Vertex, sum: &Quadric) -> Spot {
        match self {
            Self::Optimal => optimal(a.place, b.place, sum),
            Self::Endpoint => Spot::new(a.place, sum).better(Spot::new(b.place, sum)),
            Self::Midpoint => Spot::new(a.place.midpoint(b.place), sum),
            Self::Average => Spot::new(average(a, b), sum),
        }
    }
}

#[inline]
fn optimal(a: DVec3, b: DVec3, sum: &Quadric) -> Spot {
    let middle = a.midpoint(b);
    let in_reach = |p: &DVec3| p.distance_squared(middle) <= REACH * REACH * a.distance_squared(b);
    match sum.least(middle, STIFFNESS).filter(in_reach) {
        Some(place) => Spot::new(place, sum),
        None => on_edge(a, b, sum),
    }
}

/// The best of the end points and of the lowest point between them.
fn on_edge(a: DVec3, b: DVec3, sum: &Quadric) -> Spot {
    let (middle, along) = (a.midpoint(b), b - a);
    let share = -sum.slope(middle).dot(along) / sum.curvature(along);
    let inside = if share.abs() <= 0.5 { middle + share * along } else { middle };
    Spot::new(inside, sum).better(Spot::new(a, sum)).better(Spot::new(b, sum))
}

fn average(a: &Vertex, b: &Vertex) -> DVec3 {
    let share = b.quadric.area / (a.quadric.area + b.quadric.area);
    if share.is_finite() { a.place.lerp(b.place, share) } else { a.place.midpoint(b.place) }
}
