//! Triangles: C. Loop, *Smooth subdivision surfaces based on triangles*, 1987.

use super::net::{Edge, Net};
use super::scheme::{Value, ring_sums};

/// Cuts every triangle into four.
pub(super) fn refine(net: &Net) -> Net {
    let (vertices, halves) = (net.sharpness.len() as u32, 2 * net.edges.len() as u32);
    let mut edges: Vec<Edge> = net.halves().collect();
    let (mut corners, mut edge_of) = (Vec::new(), Vec::new());
    for (face, (around, cut)) in
        net.corners.as_chunks::<3>().0.iter().zip(net.edge_of.as_chunks::<3>().0).enumerate()
    {
        let middles = cut.map(|edge| vertices + edge);
        // Edge `i` of the triangle in the middle cuts off corner `i`.
        let inner = [0, 1, 2].map(|i| halves + 3 * face as u32 + i);
        for i in 0..3 {
            let before = (i + 2) % 3;
            edges.push(Edge::new([middles[before], middles[i]], 0.0));
            corners.extend([around[i], middles[i], middles[before]]);
            edge_of.extend([net.end_at(cut[i], around[i]), inner[i], net.end_at(cut[before], around[i])]);
        }
        corners.extend(middles);
        edge_of.extend([inner[1], inner[2], inner[0]]);
    }
    let ends = (1..=4 * net.face_count() as u32).map(|face| 3 * face).collect();
    let sharpness = net.worn_sharpness().chain(net.edges.iter().map(|_| 0.0)).collect();
    Net::new(ends, corners, edge_of, edges, sharpness)
}

/// How far a vertex of so many neighbours moves towards their mean: 5/8 − (3/8 + cos(2π/n)/4)².
pub(super) fn pull(valence: u32) -> f64 {
    let half = 0.375 + 0.25 * (std::f64::consts::TAU / f64::from(valence)).cos();
    0.625 - half * half
}

/// Where every vertex goes as if it were smooth.
pub(super) fn smooth_vertices<T: Value>(net: &Net, values: &[T]) -> Vec<T> {
    towards_ring(net, values, pull)
}

/// Where every vertex ends as if it were smooth: the left eigenvector of the subdivision (Loop 1987), which gives each
/// neighbour 1 and the vertex 3n / (8 · pull).
pub(super) fn smooth_limits<T: Value>(net: &Net, values: &[T]) -> Vec<T> {
    towards_ring(net, values, |valence| 1.0 / (1.0 + 0.375 / pull(valence)))
}

/// Every vertex, moved by a share of its way to the mean of its neighbours.
fn towards_ring<T: Value>(net: &Net, values: &[T], share: impl Fn(u32) -> f64) -> Vec<T> {
    let sums = ring_sums(net, values);
    let moved = |(vertex, sum): (usize, T)| {
        let valence = net.valence[vertex].max(1);
        let share = share(valence);
        values[vertex] * (1.0 - share) + sum * (share / f64::from(valence))
    };
    sums.into_iter().enumerate().map(moved).collect()
}

/// The point on an edge between two faces: 3/8 of its ends, 1/8 of the corners across.
pub(super) fn smooth_edge<T: Value>(net: &Net, values: &[T], edge: &Edge) -> T {
    let [a, b] = edge.ends.map(|end| values[end as usize]);
    let [c, d] = across(net, edge).map(|corner| values[corner as usize]);
    (a + b) * 0.375 + (c + d) * 0.125
}

/// The corners of an edge's two triangles that are none of its ends.
pub(super) fn across(net: &Net, edge: &Edge) -> [u32; 2] {
    edge.faces.map(|face| {
        let corners = net.face(face as usize);
        // A triangle has three different corners, of which an edge has two.
        corners.iter().copied().find(|corner| !edge.ends.contains(corner)).unwrap_or(corners[0])
    })
}
