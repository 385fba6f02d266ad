//! Where vertices end.

use super::Scheme;
use super::net::{Net, Rule};
use super::scheme::Value;

/// A star that has not come to rest in so many subdivisions: its vertices are a billionth of the way from the end.
const MOST_STEPS: usize = 100;

/// Where the vertices of a net come to lie in the limit. Catmull and Clark's scheme needs a net of quads.
///
/// By masks where there are any. What is semi-sharp, and a smooth vertex at which a crease ends, has none that knew of
/// the sharp edges: there the faces at the vertex are subdivided by themselves, as what goes on in them depends on
/// nothing else, until a mask will do or they have shrunk to a point. That takes about 0.1 ms for each of them.
pub(super) fn limits<T: Value>(scheme: Scheme, net: &Net, values: &[T]) -> Vec<T> {
    let mut ends = scheme.limit_masks(net, values);
    let open = unmasked(net);
    for (vertex, faces) in faces_at(net, &open) {
        let (star, old) = star(net, vertex, &faces);
        let near: Vec<T> = old.iter().map(|&vertex| values[vertex as usize]).collect();
        ends[vertex as usize] = followed(scheme, star, near);
    }
    ends
}

/// Subdivides the star of vertex 0 until it is known where that ends.
fn followed<T: Value>(scheme: Scheme, mut net: Net, mut values: Vec<T>) -> T {
    for _ in 0..MOST_STEPS {
        if !unmasked(&net)[0] {
            return scheme.limit_masks(&net, &values)[0];
        }
        (net, values) = closer(scheme, &net, &values);
    }
    values[0]
}

/// The star of vertex 0 after one more subdivision, its faces in the order of those they come from.
pub(super) fn closer<T: Value>(scheme: Scheme, net: &Net, values: &[T]) -> (Net, Vec<T>) {
    let (net, values) = (scheme.refine(net), scheme.points(net, values));
    let faces: Vec<u32> =
        (0..net.face_count() as u32).filter(|&face| net.face(face as usize).contains(&0)).collect();
    let (star, old) = star(&net, 0, &faces);
    (star, old.iter().map(|&vertex| values[vertex as usize]).collect())
}

/// Per vertex, whether masks do not say where it ends.
pub(super) fn unmasked(net: &Net) -> Vec<bool> {
    let rules = net.rules(f32::MAX);
    let fades = |sharpness: f32| sharpness > 0.0 && sharpness.is_finite();
    let mut open: Vec<bool> = net.sharpness.iter().map(|&sharpness| fades(sharpness)).collect();
    for edge in net.edges.iter().filter(|edge| edge.sharpness > 0.0) {
        for end in edge.ends {
            open[end as usize] |= fades(edge.sharpness) || rules[end as usize] == Rule::Smooth;
        }
    }
    open
}

/// The vertices that are marked, and the faces of each.
fn faces_at(net: &Net, marked: &[bool]) -> Vec<(u32, Vec<u32>)> {
    let mut sides: Vec<(u32, u32)> = Vec::new();
    for face in 0..net.face_count() {
        let corners = net.face(face).iter().filter(|&&vertex| marked[vertex as usize]);
        sides.extend(corners.map(|&vertex| (vertex, face as u32)));
    }
    sides.sort_unstable();
    let of_one = |same: &[(u32, u32)]| (same[0].0, same.iter().map(|&(_, face)| face).collect());
    sides.chunk_by(|a, b| a.0 == b.0).map(of_one).collect()
}

/// The net of a vertex's faces, in which it is vertex 0, and which vertices of the old net the others are.
pub(super) fn star(net: &Net, vertex: u32, faces: &[u32]) -> (Net, Vec<u32>) {
    let spans = || faces.iter().map(|&face| net.span(face as usize));
    let mut others: Vec<u32> =
        spans().flatten().map(|corner| net.corners[corner]).filter(|&v| v != vertex).collect();
    others.sort_unstable();
    others.dedup();
    let old: Vec<u32> = std::iter::once(vertex).chain(others).collect();
    // All but the first are in order, and all corners are among them.
    let number = |v: u32| if v == vertex { 0 } else { old[1..].partition_point(|&o| o < v) as u32 + 1 };
    let corners: Vec<u32> = spans().flatten().map(|corner| number(net.corners[corner])).collect();
    let ends = spans().scan(0, |end, span| {
        *end += span.len() as u32;
        Some(*end)
    });
    let mut star = Net::of_faces(old.len(), ends.collect(), corners);
    for (corner, same) in spans().flatten().enumerate() {
        let edge = &mut star.edges[star.edge_of[corner] as usize];
        edge.sharpness = edge.sharpness.max(net.edges[net.edge_of[same] as usize].sharpness);
    }
    star.sharpness[0] = net.sharpness[vertex as usize];
    (star, old)
}
