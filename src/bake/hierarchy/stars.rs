//! Triangles around vertices, while vertices become one.

/// No corner.
const NONE: u32 = u32::MAX;

/// Triangles of vertices. Corner `i` of triangle `t` is number `3 t + i`; the corners at a vertex are a linked list.
pub(super) struct Stars {
    triangles: Vec<[u32; 3]>,
    next: Vec<u32>,
    heads: Vec<u32>,
}

impl Stars {
    pub(super) fn new(vertices: usize, triangles: Vec<[u32; 3]>) -> Self {
        let mut heads = vec![NONE; vertices];
        let corners = (0u32..).zip(triangles.as_flattened());
        let next = corners.map(|(c, &vertex)| std::mem::replace(&mut heads[vertex as usize], c)).collect();
        Self { triangles, next, heads }
    }

    pub(super) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    /// The triangles at a vertex, in no order.
    pub(super) fn of(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let some = |corner: u32| (corner != NONE).then_some(corner);
        let corners =
            std::iter::successors(some(self.heads[vertex as usize]), move |&c| some(self.next[c as usize]));
        corners.map(|corner| corner / 3)
    }

    /// Makes the triangles of `gone` ones of `kept`. Those that use both go.
    pub(super) fn contract(&mut self, kept: u32, gone: u32) {
        let both: Vec<u32> = self.of(gone).filter(|&t| self.corners(t).contains(&kept)).collect();
        for &triangle in &both {
            (0..3).for_each(|i| self.unlink(3 * triangle + i));
        }
        let mut corner = std::mem::replace(&mut self.heads[gone as usize], NONE);
        while corner != NONE {
            let next = self.next[corner as usize];
            self.triangles[corner as usize / 3][corner as usize % 3] = kept;
            self.next[corner as usize] = std::mem::replace(&mut self.heads[kept as usize], corner);
            corner = next;
        }
    }

    /// Takes a corner out of the list of its vertex.
    fn unlink(&mut self, corner: u32) {
        let vertex = self.triangles[corner as usize / 3][corner as usize % 3];
        let after = self.next[corner as usize];
        let mut link = &mut self.heads[vertex as usize];
        while *link != corner {
            let at = *link as usize;
            link = &mut self.next[at];
        }
        *link = after;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_uses_both_goes_and_the_rest_is_handed_over() {
        let mut stars = Stars::new(5, vec![[0, 1, 2], [1, 3, 2], [0, 2, 4]]);
        stars.contract(0, 1);
        let around = |v| {
            let mut around: Vec<u32> = stars.of(v).collect();
            around.sort_unstable();
            around
        };
        assert_eq!((around(0), around(1), around(2), around(3)), (vec![1, 2], vec![], vec![1, 2], vec![1]));
        assert_eq!(stars.corners(1), [0, 3, 2]);
    }
}
