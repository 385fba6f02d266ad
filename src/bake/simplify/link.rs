//! The link condition: which edges may be contracted without changing the topology.
//!
//! T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev, "Topology preserving edge contraction", 1999.

use std::hint::select_unpredictable;

use super::fans::Fans;

/// A set of vertices that is emptied in no time, and knows which of them were counted.
pub(super) struct Stamps {
    /// `now` for those that are in, one more for those that were counted, less for the others.
    stamps: Vec<u32>,
    /// Even.
    now: u32,
}

impl Stamps {
    pub(super) fn new(vertices: usize) -> Self {
        Self { stamps: vec![0; vertices], now: 0 }
    }

    /// Empties the set.
    #[inline]
    pub(super) fn clear(&mut self) {
        self.now = self.now.wrapping_add(2);
        if self.now == 0 {
            self.stamps.fill(0);
            self.now = 2;
        }
    }

    #[inline]
    fn insert(&mut self, vertex: u32) {
        self.stamps[vertex as usize] = self.now;
    }

    #[inline]
    fn contains(&self, vertex: u32) -> bool {
        self.stamps[vertex as usize] >= self.now
    }

    /// Counts a vertex: says whether it is in and was not counted yet.
    #[inline]
    fn count(&mut self, vertex: u32) -> bool {
        let stamp = &mut self.stamps[vertex as usize];
        let is_first = *stamp == self.now;
        *stamp += u32::from(is_first);
        is_first
    }
}

/// The two corners of a triangle that are not `vertex`, in its direction. Without branches: nobody can predict which
/// corner a vertex is.
#[inline]
pub(super) fn others(triangle: [u32; 3], vertex: u32) -> [u32; 2] {
    let [a, b, c] = triangle;
    let (is_a, is_b) = (a == vertex, b == vertex);
    let next = select_unpredictable(is_a, b, select_unpredictable(is_b, c, a));
    let last = select_unpredictable(is_a, c, select_unpredictable(is_b, a, b));
    [next, last]
}

/// Per end of an edge and triangle of its fan, in its order, the [other](others) corners.
pub(super) type Rings = [Vec<[u32; 2]>; 2];

/// Triangles and the fans of their vertices.
#[derive(Clone, Copy)]
pub(super) struct Complex<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) fans: &'a Fans,
}

impl Complex<'_> {
    fn ring(self, vertex: u32) -> impl Iterator<Item = [u32; 2]> {
        self.fans.of(vertex).iter().map(move |&t| others(self.triangles[t as usize], vertex))
    }

    /// How many triangles use both. Walks around the one that has fewer.
    pub(super) fn triangles_at(self, a: u32, b: u32) -> usize {
        let (a, b) = if self.fans.of(b).len() < self.fans.of(a).len() { (b, a) } else { (a, b) };
        self.ring(a).filter(|pair| pair.contains(&b)).count()
    }

    /// Finds what is around both ends of an edge.
    #[inline]
    pub(super) fn find_rings(self, edge: [u32; 2], rings: &mut Rings) {
        for (vertex, ring) in edge.into_iter().zip(rings) {
            ring.clear();
            ring.extend(self.ring(vertex));
        }
    }

    /// Whether contracting an edge keeps the topology. `rings` are those of the ends. `at_border` says that both are on
    /// edges that have not exactly two triangles. Costs as much as a walk around both.
    ///
    /// The neighbours that both have must be the far corners of the triangles at the edge, no two of them may make a
    /// triangle with each, and the edge itself must be at the border if both ends are.
    pub(super) fn may_contract(
        self,
        [a, b]: [u32; 2],
        rings: &Rings,
        at_border: bool,
        stamps: &mut Stamps,
    ) -> bool {
        let (mut at_edge, mut last) = (0, a);
        stamps.clear();
        for &[p, q] in &rings[0] {
            stamps.insert(p);
            stamps.insert(q);
            at_edge += usize::from((p == b) | (q == b));
            last = if p == b { q } else { last };
            last = if q == b { p } else { last };
        }
        let closes_border = at_border && at_edge == 2;
        let is_alone = at_edge == 1 && self.triangles_at(a, last) == 1 && self.triangles_at(b, last) == 1;
        at_edge > 0 && !closes_border && !is_alone && shares_only(rings, at_edge, stamps)
    }
}

/// Whether two ends of an edge, the neighbours of the first of which are stamped, share so many neighbours and no side of
/// a triangle. Without branches but for the rare: nobody can predict them.
fn shares_only([first, second]: &Rings, neighbours: usize, stamps: &mut Stamps) -> bool {
    let (mut shared, mut sides) = (0, 0);
    for &[p, q] in second {
        shared += usize::from(stamps.count(p)) + usize::from(stamps.count(q));
        sides += usize::from(stamps.contains(p) & stamps.contains(q));
    }
    shared == neighbours && (sides == 0 || !second.iter().any(|&[p, q]| has_side(first, p, q)))
}

/// Whether a vertex makes a triangle with two others, either way around.
fn has_side(ring: &[[u32; 2]], p: u32, q: u32) -> bool {
    ring.iter().any(|&pair| pair == [p, q] || pair == [q, p])
}
