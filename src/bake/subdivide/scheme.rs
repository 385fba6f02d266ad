//! What both schemes have in common: values on a net, and the rules of creases.

use std::ops::{Add, Mul};

use super::net::{Edge, Net, Rule};
use super::{Scheme, catmull_clark, loops};

/// What is subdivided: a position, a texture coordinate, a colour.
pub(super) trait Value: Copy + Default + Add<Output = Self> + Mul<f64, Output = Self> {}

impl<T: Copy + Default + Add<Output = T> + Mul<f64, Output = T>> Value for T {}

impl Scheme {
    /// The net of the next subdivision.
    pub(super) fn refine(self, net: &Net) -> Net {
        match self {
            Self::Loop => loops::refine(net),
            Self::CatmullClark => catmull_clark::refine(net),
        }
    }

    /// The values at the vertices of [`Scheme::refine`]'s net.
    ///
    /// Smooth vertices and edges as the scheme has them. On creases and borders the cubic B-spline of the vertices
    /// there: edges are halved, vertices keep 3/4 (H. Hoppe et al., "Piecewise smooth surface reconstruction", 1994).
    /// What is sharp for a part of this subdivision is so much between sharp and smooth (T. DeRose, M. Kass, T. Truong,
    /// "Subdivision surfaces in character animation", 1998).
    pub(super) fn points<T: Value>(self, net: &Net, values: &[T]) -> Vec<T> {
        let centroids = self.face_points(net, values);
        let smooth = match self {
            Self::Loop => loops::smooth_vertices(net, values),
            Self::CatmullClark => catmull_clark::smooth_vertices(net, values, &centroids),
        };
        let smooth_edge = |edge: &Edge| match self {
            Self::Loop => loops::smooth_edge(net, values, edge),
            Self::CatmullClark => catmull_clark::smooth_edge(values, &centroids, edge),
        };
        let mut points = vertex_points(net, values, &smooth);
        points.extend(net.edges.iter().map(|edge| edge_point(values, edge, smooth_edge)));
        points.extend(centroids);
        points
    }

    /// The values at the same vertices where nothing is smoothed: the faces as they are, cut.
    pub(super) fn flat_points<T: Value>(self, net: &Net, values: &[T]) -> Vec<T> {
        let middles = net.edges.iter().map(|edge| middle(values, edge));
        values.iter().copied().chain(middles).chain(self.face_points(net, values)).collect()
    }

    /// Where the vertices come to lie in the limit, if what is sharp is so for ever and no crease ends in a smooth vertex.
    /// Catmull and Clark's needs a net of quads. On a crease it is (1, 4, 1) / 6, as on any uniform cubic B-spline.
    pub(super) fn limit_masks<T: Value>(self, net: &Net, values: &[T]) -> Vec<T> {
        let smooth = match self {
            Self::Loop => loops::smooth_limits(net, values),
            Self::CatmullClark => catmull_clark::smooth_limits(net, values),
        };
        let rules = net.rules(f32::MAX);
        let limit = |vertex: usize| match rules[vertex] {
            Rule::Smooth => smooth[vertex],
            Rule::Crease(others) => along(values, vertex, others, 1.0 / 6.0),
            Rule::Corner => values[vertex],
        };
        (0..values.len()).map(limit).collect()
    }

    fn face_points<T: Value>(self, net: &Net, values: &[T]) -> Vec<T> {
        match self {
            Self::Loop => Vec::new(),
            Self::CatmullClark => catmull_clark::centroids(net, values),
        }
    }
}

fn vertex_points<T: Value>(net: &Net, values: &[T], smooth: &[T]) -> Vec<T> {
    let (now, next, fading) = (net.rules(0.0), net.rules(1.0), net.fading());
    let point = |vertex: usize| {
        let by = |rule: Rule| match rule {
            Rule::Smooth => smooth[vertex],
            Rule::Crease(others) => along(values, vertex, others, 0.125),
            Rule::Corner => values[vertex],
        };
        match now[vertex] == next[vertex] {
            true => by(now[vertex]),
            false => by(now[vertex]) * fading[vertex] + by(next[vertex]) * (1.0 - fading[vertex]),
        }
    };
    (0..values.len()).map(point).collect()
}

fn edge_point<T: Value>(values: &[T], edge: &Edge, smooth: impl Fn(&Edge) -> T) -> T {
    if edge.sharpness >= 1.0 {
        return middle(values, edge);
    }
    let sharp = f64::from(edge.sharpness);
    middle(values, edge) * sharp + smooth(edge) * (1.0 - sharp)
}

fn middle<T: Value>(values: &[T], edge: &Edge) -> T {
    let [a, b] = edge.ends.map(|end| values[end as usize]);
    (a + b) * 0.5
}

/// A vertex of a curve, its two neighbours counting `share` each.
fn along<T: Value>(values: &[T], vertex: usize, [a, b]: [u32; 2], share: f64) -> T {
    values[vertex] * (1.0 - 2.0 * share) + (values[a as usize] + values[b as usize]) * share
}

/// Per vertex, the sum of its neighbours' values.
pub(super) fn ring_sums<T: Value>(net: &Net, values: &[T]) -> Vec<T> {
    let mut sums = vec![T::default(); values.len()];
    for edge in &net.edges {
        let [a, b] = edge.ends.map(|end| end as usize);
        (sums[a], sums[b]) = (sums[a] + values[b], sums[b] + values[a]);
    }
    sums
}
