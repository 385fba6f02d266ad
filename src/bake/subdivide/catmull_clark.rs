//! Quads and any polygons: E. Catmull, J. Clark, *Recursively generated B-spline surfaces on arbitrary topological
//! meshes*, 1978.

use super::net::{Edge, Net};
use super::scheme::{Value, ring_sums};

/// Cuts every face of n corners into n quads. Quad `i` starts at corner `i`.
pub(super) fn refine(net: &Net) -> Net {
    let (vertices, cuts) = (net.sharpness.len() as u32, net.edges.len() as u32);
    let mut edges: Vec<Edge> = net.halves().collect();
    let (mut corners, mut edge_of) = (Vec::new(), Vec::new());
    for face in 0..net.face_count() {
        let (span, centre) = (net.span(face), vertices + cuts + face as u32);
        let mut before = span.end - 1;
        for corner in span {
            let (vertex, cut, last) = (net.corners[corner], net.edge_of[corner], net.edge_of[before]);
            edges.push(Edge::new([vertices + cut, centre], 0.0));
            corners.extend([vertex, vertices + cut, centre, vertices + last]);
            let spoke = |corner: usize| 2 * cuts + corner as u32;
            edge_of.extend([net.end_at(cut, vertex), spoke(corner), spoke(before), net.end_at(last, vertex)]);
            before = corner;
        }
    }
    let ends = (1..=net.corners.len() as u32).map(|face| 4 * face).collect();
    let new = cuts as usize + net.face_count();
    let sharpness = net.worn_sharpness().chain(std::iter::repeat_n(0.0, new)).collect();
    Net::new(ends, corners, edge_of, edges, sharpness)
}

/// Per face, the mean of its corners.
pub(super) fn centroids<T: Value>(net: &Net, values: &[T]) -> Vec<T> {
    let centroid = |face: usize| {
        let corners = net.face(face);
        let sum = corners.iter().fold(T::default(), |sum, &corner| sum + values[corner as usize]);
        sum * (1.0 / corners.len() as f64)
    };
    (0..net.face_count()).map(centroid).collect()
}

/// Where every vertex goes as if it were smooth: (n − 2)/n of itself, and 1/n of the means of its neighbours and of its
/// faces' centroids.
pub(super) fn smooth_vertices<T: Value>(net: &Net, values: &[T], centroids: &[T]) -> Vec<T> {
    let faces = face_sums(net, centroids);
    let point = |(vertex, ring): (usize, T)| {
        let n = f64::from(net.valence[vertex].max(1));
        values[vertex] * ((n - 2.0) / n) + (ring + faces[vertex]) * (1.0 / (n * n))
    };
    ring_sums(net, values).into_iter().enumerate().map(point).collect()
}

/// Where every vertex of a net of quads ends as if it were smooth: n² of itself, 4 of each neighbour and 1 of each
/// corner across a quad, of n(n + 5) (M. Halstead, M. Kass, T. DeRose, "Efficient, fair interpolation using
/// Catmull-Clark surfaces", 1993). Corners across are four centroids less the rest of each quad.
pub(super) fn smooth_limits<T: Value>(net: &Net, values: &[T]) -> Vec<T> {
    let faces = face_sums(net, &centroids(net, values));
    let limit = |(vertex, ring): (usize, T)| {
        let n = f64::from(net.valence[vertex].max(1));
        (values[vertex] * (n * n - n) + ring * 2.0 + faces[vertex] * 4.0) * (1.0 / (n * n + 5.0 * n))
    };
    ring_sums(net, values).into_iter().enumerate().map(limit).collect()
}

/// The point on an edge between two faces: the mean of its ends and their centroids.
pub(super) fn smooth_edge<T: Value>(values: &[T], centroids: &[T], edge: &Edge) -> T {
    let [a, b] = edge.ends.map(|end| values[end as usize]);
    let [c, d] = edge.faces.map(|face| centroids[face as usize]);
    (a + b + c + d) * 0.25
}

/// Per vertex, the sum over its faces.
fn face_sums<T: Value>(net: &Net, centroids: &[T]) -> Vec<T> {
    let mut sums = vec![T::default(); net.sharpness.len()];
    for (face, &centroid) in centroids.iter().enumerate() {
        for &corner in net.face(face) {
            sums[corner as usize] = sums[corner as usize] + centroid;
        }
    }
    sums
}
