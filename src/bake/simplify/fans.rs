//! Which triangles use a vertex, kept while vertices merge.

/// Per vertex, the triangles that use it (its *fan*), in one array: a list grows by moving to the end of the array.
///
/// Lists get room for a power of two, so all moves of a list together cost and leave behind no more than its last
/// length.
pub(super) struct Fans {
    spans: Vec<Span>,
    triangles: Vec<u32>,
}

/// Where a list is, how long it is, and how long it may become there.
#[derive(Clone, Copy, Default)]
struct Span {
    start: u32,
    len: u32,
    room: u32,
}

impl Fans {
    /// The fans of so many vertices. O(vertices + triangles).
    pub(super) fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut spans = vec![Span::default(); vertices];
        for &corner in triangles.as_flattened() {
            spans[corner as usize].room += 1;
        }
        let mut start = 0;
        for span in &mut spans {
            span.start = start;
            start += span.room;
        }
        let mut fans = Self { spans, triangles: vec![0; start as usize] };
        for (triangle, corners) in (0..).zip(triangles) {
            for &corner in corners {
                fans.add(corner, triangle);
            }
        }
        fans
    }

    /// Adds a triangle to a list that has room.
    fn add(&mut self, vertex: u32, triangle: u32) {
        let span = &mut self.spans[vertex as usize];
        self.triangles[(span.start + span.len) as usize] = triangle;
        span.len += 1;
    }

    /// The triangles around a vertex, in no particular but always the same order.
    #[inline]
    pub(super) fn of(&self, vertex: u32) -> &[u32] {
        let span = self.spans[vertex as usize];
        &self.triangles[span.start as usize..][..span.len as usize]
    }

    /// Takes one triangle out.
    pub(super) fn remove(&mut self, vertex: u32, triangle: u32) {
        let span = &mut self.spans[vertex as usize];
        let list = &mut self.triangles[span.start as usize..][..span.len as usize];
        if let Some(at) = list.iter().position(|&t| t == triangle) {
            list[at] = list[list.len() - 1];
            span.len -= 1;
        }
    }

    /// Gives a vertex another list.
    pub(super) fn replace(&mut self, vertex: u32, list: &[u32]) {
        let span = &mut self.spans[vertex as usize];
        if list.len() > span.room as usize {
            span.room = list.len().next_power_of_two() as u32;
            span.start = self.triangles.len() as u32;
            self.triangles.resize(self.triangles.len() + span.room as usize, 0);
        }
        span.len = list.len() as u32;
        self.triangles[span.start as usize..][..list.len()].copy_from_slice(list);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_what_was_put_in_and_not_taken_out() {
        let mut fans = Fans::new(5, &[[0, 1, 2], [0, 2, 3]]);
        assert_eq!((fans.of(0), fans.of(1), fans.of(4)), (&[0, 1][..], &[0][..], &[][..]));
        fans.remove(0, 0);
        fans.remove(0, 7);
        fans.replace(1, &[5, 6, 7]);
        fans.replace(2, &[8]);
        assert_eq!((fans.of(0), fans.of(1), fans.of(2)), (&[1][..], &[5, 6, 7][..], &[8][..]));
        fans.replace(1, &[1, 2, 3, 4]);
        assert_eq!((fans.of(1), fans.of(3)), (&[1, 2, 3, 4][..], &[1][..]));
    }
}
