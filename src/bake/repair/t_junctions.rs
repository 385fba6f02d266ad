//! Border vertices within border edges.

use glam::{DVec3, Vec3};

use super::place_of;
use crate::bake::finding::{Defect, Finding};
use crate::bounds::Aabb;

/// A vertex lies on an edge if it is no further from it than this part of the diagonal of all.
const TOLERANCE: f64 = 1e-6;

/// How many border vertices may be looked at: about a second. Long edges along many vertices reach it.
const EFFORT: u64 = 1 << 26;

/// Counts the ends of border edges that lie within another border edge, each once. Edges are pairs of positions, which
/// must be finite.
pub(super) fn find(positions: &[Vec3], borders: &[[u32; 2]]) -> Finding {
    let mut found = Finding::none(Defect::TJunction);
    let tree = Tree::of(positions, borders);
    let bounds = Aabb::around(borders.as_flattened().iter().map(|&p| positions[p as usize]));
    let mut search = Search {
        tree: &tree,
        tolerance: bounds.max.as_dvec3().distance(bounds.min.as_dvec3()) * TOLERANCE,
        effort: EFFORT,
        known: vec![false; positions.len()],
    };
    for &edge in borders {
        search.visit(Segment::of(positions, edge), 0..tree.vertices.len(), 0, (0.0, 1.0), &mut |vertex| {
            found.add(|| place_of(positions[vertex as usize]));
        });
    }
    found.is_complete = search.effort > 0;
    found
}

/// A k-d tree without pointers (Bentley, *Multidimensional binary search trees*, 1975): the middle of a range splits it
/// along x, y, z in turn.
struct Tree {
    vertices: Vec<u32>,
    points: Vec<DVec3>,
}

impl Tree {
    fn of(positions: &[Vec3], borders: &[[u32; 2]]) -> Self {
        let mut vertices = borders.as_flattened().to_vec();
        vertices.sort_unstable();
        vertices.dedup();
        split(&mut vertices, positions, 0);
        let points = vertices.iter().map(|&v| positions[v as usize].as_dvec3()).collect();
        Self { vertices, points }
    }
}

fn split(vertices: &mut [u32], positions: &[Vec3], axis: usize) {
    if vertices.len() < 2 {
        return;
    }
    let key = |v: &u32| positions[*v as usize][axis];
    let middle = vertices.len() / 2;
    vertices.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    let (low, high) = vertices.split_at_mut(middle);
    split(low, positions, (axis + 1) % 3);
    split(&mut high[1..], positions, (axis + 1) % 3);
}

struct Segment {
    ends: [u32; 2],
    from: DVec3,
    along: DVec3,
}

impl Segment {
    fn of(positions: &[Vec3], ends: [u32; 2]) -> Self {
        let [from, to] = ends.map(|p| positions[p as usize].as_dvec3());
        Self { ends, from, along: to - from }
    }

    /// Whether the point is near the segment and not near its ends.
    fn holds(&self, point: DVec3, tolerance: f64) -> bool {
        let t = (point - self.from).dot(self.along) / self.along.length_squared();
        let near = |p: DVec3| p.distance_squared(point) <= tolerance * tolerance;
        t > 0.0
            && t < 1.0
            && near(self.from + self.along * t)
            && !near(self.from)
            && !near(self.from + self.along)
    }

    /// The part of `(from, to)` of the segment that is on one side of a plane, `sign` times the coordinate below the
    /// limit. Empty where `from > to`.
    fn clipped(&self, (from, to): (f64, f64), axis: usize, sign: f64, limit: f64) -> (f64, f64) {
        let (start, slope) = (sign * self.from[axis] - limit, sign * self.along[axis]);
        if slope == 0.0 {
            return if start <= 0.0 { (from, to) } else { (1.0, 0.0) };
        }
        let crossing = -start / slope;
        if slope > 0.0 { (from, to.min(crossing)) } else { (from.max(crossing), to) }
    }
}

struct Search<'a> {
    tree: &'a Tree,
    tolerance: f64,
    effort: u64,
    known: Vec<bool>,
}

impl Search<'_> {
    /// Looks at the vertices of a range that the part of the segment comes near.
    fn visit(
        &mut self,
        segment: Segment,
        range: std::ops::Range<usize>,
        axis: usize,
        part: (f64, f64),
        found: &mut impl FnMut(u32),
    ) {
        let mut waiting = vec![(range, axis, part)];
        while let Some((range, axis, part)) = waiting.pop() {
            if range.is_empty() || part.0 > part.1 || self.effort == 0 {
                continue;
            }
            self.effort -= 1;
            let middle = range.start + range.len() / 2;
            let (vertex, point) = (self.tree.vertices[middle], self.tree.points[middle]);
            let is_new = !self.known[vertex as usize] && !segment.ends.contains(&vertex);
            if is_new && segment.holds(point, self.tolerance) {
                self.known[vertex as usize] = true;
                found(vertex);
            }
            let low = segment.clipped(part, axis, 1.0, point[axis] + self.tolerance);
            let high = segment.clipped(part, axis, -1.0, self.tolerance - point[axis]);
            waiting.push((middle + 1..range.end, (axis + 1) % 3, high));
            waiting.push((range.start..middle, (axis + 1) % 3, low));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Against all pairs.
        #[test]
        fn the_tree_finds_what_all_pairs_find(
            points in prop::collection::vec(prop::array::uniform3(0i8..5), 2..30),
            edges in prop::collection::vec((0usize..100, 0usize..100), 0..40),
        ) {
            let mut points: Vec<Vec3> = points.iter().map(|p| Vec3::from(p.map(f32::from))).collect();
            points.sort_by_key(|p| p.to_array().map(f32::to_bits));
            points.dedup();
            let n = points.len();
            let edges: Vec<[u32; 2]> = edges.into_iter().map(|(a, b)| [(a % n) as u32, (b % n) as u32])
                .filter(|[a, b]| a != b).collect();
            let is_within = |v: u32, edge: &[u32; 2]| {
                !edge.contains(&v) && Segment::of(&points, *edge).holds(points[v as usize].as_dvec3(), 1e-6)
            };
            let is_end = |v: &u32| edges.as_flattened().contains(v);
            let expected = (0..n as u32).filter(is_end).filter(|&v| edges.iter().any(|e| is_within(v, e))).count();
            prop_assert_eq!(find(&points, &edges).count, expected);
        }
    }
}
