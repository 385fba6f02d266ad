//! Whether several vertices may become one.

use glam::DVec3;

use super::link::others;
use super::workpiece::Workpiece;

/// What is around a set of vertices: the triangles that use any of them.
pub(super) struct Star {
    /// Ascending.
    set: Vec<u32>,
    triangles: Vec<u32>,
}

impl Star {
    pub(super) fn new(piece: &Workpiece, set: &[u32]) -> Self {
        let mut triangles: Vec<u32> = set.iter().flat_map(|&v| piece.fans.of(v)).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        let mut set = set.to_vec();
        set.sort_unstable();
        Self { set, triangles }
    }

    /// The triangles that stay when the set becomes one, and their corners in the set.
    fn staying(&self, piece: &Workpiece) -> impl Iterator<Item = (u32, u32)> {
        self.triangles.iter().filter_map(|&t| {
            let mut inside =
                piece.triangles[t as usize].into_iter().filter(|v| self.set.binary_search(v).is_ok());
            inside.next().filter(|_| inside.next().is_none()).map(|corner| (t, corner))
        })
    }

    /// Whether the triangles that stay keep their direction if the set goes to a place: none turns by more than the
    /// angle of that cosine. Those without area may do anything.
    pub(super) fn turns_nothing(&self, piece: &Workpiece, place: DVec3, least_turn: f32) -> bool {
        let least = f64::from(least_turn.clamp(0.0, 1.0));
        self.staying(piece).all(|(triangle, corner)| {
            let [p, q] = others(piece.triangles[triangle as usize], corner).map(|v| piece.place(v));
            let [before, after] = [piece.place(corner), place].map(|at| (p - at).cross(q - at));
            let turn = before.normalize_or_zero().dot(after.normalize_or_zero());
            before == DVec3::ZERO || turn > 0.0 && turn >= least
        })
    }

    /// Whether the topology stays as it is if the set becomes one: the star is a disc, and what is around it is one
    /// cycle of three sides at least, or at a border one path. That is the link condition for more than an edge.
    pub(super) fn is_disc(&self, piece: &Workpiece) -> bool {
        let mut link: Vec<[u32; 2]> = Vec::new();
        for (triangle, corner) in self.staying(piece) {
            let [p, q] = others(piece.triangles[triangle as usize], corner);
            link.extend([[p, q], [q, p]]);
        }
        link.sort_unstable();
        is_one_line(&link) && self.euler(piece) == 1 && self.ends_in(piece, &link)
    }

    /// Vertices − edges + triangles.
    fn euler(&self, piece: &Workpiece) -> isize {
        let corners = || self.triangles.iter().map(|&t| piece.triangles[t as usize]);
        let vertices = count(corners().flatten().collect());
        let sides = corners().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
        let edges = count(sides.map(|(a, b)| (a.min(b), a.max(b))).collect());
        vertices as isize - edges as isize + self.triangles.len() as isize
    }

    /// Whether all vertices around the set are on the line around it, which is sorted.
    fn ends_in(&self, piece: &Workpiece, link: &[[u32; 2]]) -> bool {
        let corners = self.triangles.iter().flat_map(|&t| piece.triangles[t as usize]);
        let mut around = corners.filter(|v| self.set.binary_search(v).is_err());
        around.all(|v| link.binary_search_by_key(&v, |side| side[0]).is_ok())
    }
}

/// How many different things there are.
fn count<T: Ord>(mut things: Vec<T>) -> usize {
    things.sort_unstable();
    things.dedup();
    things.len()
}

/// Whether sides, given both ways and sorted, are one path, or one cycle of at least three.
fn is_one_line(sides: &[[u32; 2]]) -> bool {
    let ends = |v: u32| {
        let first = sides.partition_point(|side| side[0] < v);
        &sides[first..sides.partition_point(|side| side[0] <= v)]
    };
    let Some(&[any, _]) = sides.first() else { return false };
    let start = sides.iter().map(|side| side[0]).find(|&v| ends(v).len() == 1).unwrap_or(any);
    let (mut from, mut at, mut walked) = (u32::MAX, start, 0);
    while walked <= sides.len() {
        let next = match *ends(at) {
            [[_, a]] if a != from || walked == 0 => a,
            [[_, a], [_, b]] if a != b => {
                if a == from {
                    b
                } else {
                    a
                }
            }
            _ => break,
        };
        (from, at) = (at, next);
        walked += 1;
        if at == start {
            break;
        }
    }
    2 * walked == sides.len() && (at != start || walked >= 3)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether sides are one line, put in as they are.
    fn is_line(sides: &[[u32; 2]]) -> bool {
        let mut both: Vec<[u32; 2]> = sides.iter().flat_map(|&[a, b]| [[a, b], [b, a]]).collect();
        both.sort_unstable();
        is_one_line(&both)
    }

    #[test]
    fn a_line_is_a_path_or_a_cycle_and_nothing_more() {
        assert!(is_line(&[[3, 1]]) && is_line(&[[3, 1], [7, 3]]));
        assert!(is_line(&[[3, 1], [7, 3], [1, 7]]) && is_line(&[[0, 1], [2, 3], [1, 2], [3, 0]]));
        assert!(!is_line(&[]) && !is_line(&[[1, 2], [1, 2]]), "nothing, and the same twice");
        assert!(!is_line(&[[0, 1], [2, 3]]) && !is_line(&[[0, 1], [0, 2], [0, 3]]), "two, and a fork");
        assert!(!is_line(&[[0, 1], [1, 2], [2, 0], [3, 4]]) && !is_line(&[[0, 1], [1, 2], [2, 0], [2, 3]]));
    }
}
