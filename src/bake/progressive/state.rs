//! A mesh that vertices are split in: arrays that grow at their ends, and the fans of its vertices.

use glam::Vec3;

use super::file::head::Counts;
use super::split::{Split, Undo};

/// The end of a list, and no vertex.
pub(super) const NONE: u32 = u32::MAX;

/// Most triangles there may be: a corner is a number of 32 bits.
pub(super) const MOST_TRIANGLES: usize = 1 << 28;

/// A prefix of a progressive mesh.
///
/// A split appends vertices, wedges and triangles and changes what is around its vertex; nothing ever moves. A corner
/// has the number 3 · triangle + corner. The corners at a vertex, its *fan*, are a list from the highest number to the
/// lowest, so that it is the same list however the prefix was come by, and a record can say "the second of them".
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    /// Words per wedge.
    pub(super) width: usize,
    /// How many groups there are.
    pub(super) kinds: usize,
    pub(super) positions: Vec<Vec3>,
    /// Per wedge, its position.
    pub(super) wedges: Vec<u32>,
    /// Per wedge, the words of its attributes.
    pub(super) rows: Vec<u32>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Per triangle.
    pub(super) groups: Vec<u32>,
    /// Per position, its first corner.
    heads: Vec<u32>,
    /// Per corner, the next one at its position.
    next: Vec<u32>,
}

impl State {
    /// Without anything, for wedges of so many words in so many groups.
    pub(super) fn new(width: usize, kinds: usize) -> Self {
        Self { width, kinds, ..Self::default() }
    }

    pub(super) fn push_position(&mut self, position: Vec3) {
        self.positions.push(position);
        self.heads.push(NONE);
    }

    /// Adds a triangle of wedges that are there, of three positions.
    pub(super) fn push_triangle(&mut self, wedges: [u32; 3], group: u32) {
        for (corner, wedge) in (self.next.len() as u32..).zip(wedges) {
            let head = &mut self.heads[self.wedges[wedge as usize] as usize];
            self.next.push(std::mem::replace(head, corner));
        }
        self.triangles.push(wedges);
        self.groups.push(group);
    }

    fn pop_triangle(&mut self) {
        let Some(wedges) = self.triangles.pop() else { return };
        self.groups.pop();
        let first = 3 * self.triangles.len();
        for (next, wedge) in self.next[first..].iter().zip(wedges) {
            self.heads[self.wedges[wedge as usize] as usize] = *next;
        }
        self.next.truncate(first);
    }

    pub(super) fn counts(&self) -> Counts {
        let (positions, wedges) = (self.positions.len(), self.wedges.len());
        Counts { positions, wedges, triangles: self.triangles.len() }
    }

    /// The corners at a position, the highest first.
    pub(super) fn fan(&self, position: u32) -> impl Iterator<Item = u32> {
        let some = |corner: u32| (corner != NONE).then_some(corner);
        std::iter::successors(some(self.heads[position as usize]), move |&at| some(self.next[at as usize]))
    }

    /// The wedge of a corner.
    #[inline]
    pub(super) fn wedge(&self, corner: u32) -> u32 {
        self.triangles.as_flattened()[corner as usize]
    }

    /// The wedge of the corner that comes so many corners after one in its triangle.
    #[inline]
    pub(super) fn wedge_after(&self, corner: u32, steps: u32) -> u32 {
        let (triangle, at) = (corner / 3, corner % 3);
        self.triangles[triangle as usize][((at + steps) % 3) as usize]
    }

    pub(super) fn row(&self, wedge: u32) -> &[u32] {
        &self.rows[wedge as usize * self.width..][..self.width]
    }

    /// Splits a vertex, as a split says that fits. O(fan).
    pub(super) fn apply(&mut self, split: &Split, undo: Option<&mut Undo>) {
        if let Some(undo) = undo {
            undo.keep(self, split);
        }
        let new = self.positions.len() as u32;
        if split.parent != NONE {
            self.positions[split.parent as usize] = split.place;
        }
        split.positions.iter().for_each(|&position| self.push_position(position));
        self.wedges.extend_from_slice(&split.wedges);
        let (changed, added) = split.rows.split_at(split.changed.len() * self.width);
        self.rows.extend_from_slice(added);
        for (i, change) in split.changed.iter().enumerate() {
            let at = change.wedge as usize;
            self.rows[at * self.width..][..self.width]
                .copy_from_slice(&changed[i * self.width..][..self.width]);
            self.wedges[at] = if change.moves { new } else { self.wedges[at] };
        }
        for &(corner, wedge) in &split.corners {
            self.triangles.as_flattened_mut()[corner as usize] = wedge;
        }
        if split.parent != NONE && !split.positions.is_empty() {
            self.part(split.parent, new);
        }
        for (&triangle, &group) in split.triangles.iter().zip(&split.groups) {
            self.push_triangle(triangle, group);
        }
    }

    /// Moves the corners at one position whose wedges are at another to that one, which has none. Both keep their
    /// order.
    fn part(&mut self, from: u32, to: u32) {
        let mut at = self.heads[from as usize];
        let mut ends = [NONE; 2];
        (self.heads[from as usize], self.heads[to as usize]) = (NONE, NONE);
        while at != NONE {
            let position = self.wedges[self.wedge(at) as usize];
            let end = &mut ends[usize::from(position == to)];
            match *end {
                NONE => self.heads[position as usize] = at,
                last => self.next[last as usize] = at,
            }
            *end = at;
            at = self.next[at as usize];
        }
        for end in ends.into_iter().filter(|&end| end != NONE) {
            self.next[end as usize] = NONE;
        }
    }

    /// Gives one position the corners of another, too, in order.
    fn join(&mut self, to: u32, from: u32) {
        let (mut a, mut b) = (self.heads[to as usize], self.heads[from as usize]);
        let mut last = NONE;
        while a != NONE || b != NONE {
            let takes_first = b == NONE || a != NONE && a > b;
            let side = if takes_first { &mut a } else { &mut b };
            let corner = *side;
            *side = self.next[corner as usize];
            match last {
                NONE => self.heads[to as usize] = corner,
                last => self.next[last as usize] = corner,
            }
            last = corner;
        }
        if last != NONE {
            self.next[last as usize] = NONE;
        }
    }

    /// Takes the last split back. O(fan).
    pub(super) fn undo(&mut self, undo: &mut Undo) {
        let Some(step) = undo.steps.pop() else { return };
        (0..step.triangles).for_each(|_| self.pop_triangle());
        let first_new = self.positions.len() - step.positions as usize;
        if step.parent != NONE && step.positions > 0 {
            self.join(step.parent, first_new as u32);
        }
        for (corner, wedge) in undo.corners.drain(undo.corners.len() - step.corners as usize..).rev() {
            self.triangles.as_flattened_mut()[corner as usize] = wedge;
        }
        for _ in 0..step.changed {
            let Some((wedge, position)) = undo.changed.pop() else { break };
            let at = undo.rows.len() - self.width;
            self.rows[wedge as usize * self.width..][..self.width].copy_from_slice(&undo.rows[at..]);
            undo.rows.truncate(at);
            self.wedges[wedge as usize] = position;
        }
        if step.parent != NONE {
            self.positions[step.parent as usize] = step.place;
        }
        self.positions.truncate(first_new);
        self.heads.truncate(first_new);
        self.wedges.truncate(self.wedges.len() - step.wedges as usize);
        self.rows.truncate(self.wedges.len() * self.width);
    }
}
