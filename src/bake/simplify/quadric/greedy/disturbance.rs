//! What a contraction means for the choices of others.

use super::choice::Choice;
use super::mark;
use crate::bake::simplify::queue::Queue;

/// A contraction, and the choices of all vertices.
pub(super) struct Disturbance<'a> {
    /// What was contracted.
    pub(super) edge: [u32; 2],
    pub(super) marks: &'a mut [u8],
    pub(super) choices: &'a [Choice],
    pub(super) queue: &'a mut Queue,
}

impl Disturbance<'_> {
    /// Has two neighbours in a triangle choose again, or only the first: where every edge has as many triangles in either
    /// direction the second is the first of another.
    #[inline]
    pub(super) fn reach_side(&mut self, [next, last]: [u32; 2], reaches_both: bool) {
        self.reach(next);
        if reaches_both {
            self.reach(last);
        }
    }

    /// Has a neighbour choose again, when its turn comes, if its choice is one of the two or if it had to settle for one.
    /// Any other choice is still its cheapest, since what has changed only became dearer.
    #[inline]
    pub(super) fn reach(&mut self, neighbour: u32) {
        let marks = &mut self.marks[neighbour as usize];
        let choice = self.choices[neighbour as usize];
        let [kept, gone] = self.edge.map(|end| choice.partner() == end);
        *marks |= mark::DIRTY * u8::from(kept | gone | (*marks & mark::SETTLED != 0));
        if *marks & (mark::IDLE | mark::DIRTY) == mark::IDLE | mark::DIRTY {
            *marks &= !mark::IDLE;
            self.queue.push(choice.cost(), neighbour);
        }
    }
}
