//! What is left of two vertices' fans when the vertices become one, several triangles at once.
//!
//! Whether a contraction may be taken, and how far from the ends its result is, is asked of every triangle around it.
//! The triangles are kept in columns here, four of each number at a time, for loops without branches that are compiled
//! to vectors. The same operations in the same order as for one triangle give the same answers.

use glam::DVec3;

use super::distance::distance2;
use super::guard::{Facing, Guard};
use crate::kernel::{self, Kernel};

/// How many triangles there are to a block: those of one vector of 256 bits.
const LANES: usize = 4;

/// A number of each triangle of a block.
type Column = [f64; LANES];

/// A triangle at an end of an edge.
pub(super) struct Neighbour {
    /// Whether it is left when the ends become one.
    pub(super) stays: bool,
    /// Where its side across from the end starts and ends, seen along its direction.
    pub(super) side: [DVec3; 2],
    /// Where it once faced.
    pub(super) facing: Facing,
}

/// Some triangles.
#[derive(Clone, Copy, Default)]
struct Block {
    start: [Column; 3],
    end: [Column; 3],
    facing: [Facing; LANES],
}

/// The triangles of an end of an edge but for those that go.
#[derive(Default)]
pub(super) struct Rest {
    /// Where the end is.
    from: DVec3,
    /// Room for more triangles than there are.
    blocks: Vec<Block>,
    len: usize,
}

impl Rest {
    /// Makes it that of an end that is at a place and has such triangles.
    #[inline]
    pub(super) fn fill(&mut self, from: DVec3, fan: impl ExactSizeIterator<Item = Neighbour>) {
        if self.blocks.len() * LANES <= fan.len() {
            self.blocks.resize(fan.len() / LANES + 1, Block::default());
        }
        let mut len = 0;
        for Neighbour { stays, side: [start, end], facing } in fan {
            // Or only as if: nobody can predict which triangles stay.
            let (block, lane) = (&mut self.blocks[len / LANES], len % LANES);
            block.start.set(lane, start);
            block.end.set(lane, end);
            block.facing[lane] = facing;
            len += usize::from(stays);
        }
        (self.from, self.len) = (from, len);
    }

    /// If all triangles of both ends may follow them to a place: how far, squared, each end is from what its own become,
    /// or from that place where none is nearer.
    #[inline]
    pub(super) fn follow(ends: &[Self; 2], to: DVec3, guard: Guard) -> Option<[f64; 2]> {
        kernel::run(Follow { ends, to, guard })
    }

    /// The squared distance of a place from what the triangles become when the vertex goes to `to`; from `to` itself
    /// where no triangle is nearer.
    #[inline]
    pub(super) fn distance2(&self, to: DVec3, place: DVec3) -> f64 {
        kernel::run(Distance2 { rest: self, to, place })
    }

    /// The blocks that are in use, and how many triangles of each.
    #[inline(always)]
    fn blocks(&self) -> impl Iterator<Item = (&Block, usize)> {
        let left = (0..self.len).step_by(LANES).map(|first| self.len - first);
        self.blocks.iter().zip(left.map(|left| left.min(LANES)))
    }
}

/// Vectors in columns.
trait Columns {
    fn set(&mut self, lane: usize, vector: DVec3);
    fn at(&self, lane: usize) -> DVec3;
}

impl Columns for [Column; 3] {
    #[inline(always)]
    fn set(&mut self, lane: usize, vector: DVec3) {
        for (column, number) in self.iter_mut().zip(vector.to_array()) {
            column[lane] = number;
        }
    }

    #[inline(always)]
    fn at(&self, lane: usize) -> DVec3 {
        DVec3::new(self[0][lane], self[1][lane], self[2][lane])
    }
}

struct Follow<'a> {
    ends: &'a [Rest; 2],
    to: DVec3,
    guard: Guard,
}

impl Kernel for Follow<'_> {
    type Sum = Option<[f64; 2]>;

    #[inline(always)]
    fn run(self) -> Self::Sum {
        let [first, second] = self.ends;
        Some([self.end(first)?, self.end(second)?])
    }
}

impl Follow<'_> {
    #[inline(always)]
    fn end(&self, end: &Rest) -> Option<f64> {
        let mut may = [true; LANES];
        let mut least = [end.from.distance_squared(self.to); LANES];
        for (block, len) in end.blocks() {
            for lane in 0..LANES {
                let side = [block.start.at(lane), block.end.at(lane)];
                let allows = self.guard.allows(end.from, self.to, side, block.facing[lane].normal());
                may[lane] &= allows | (lane >= len);
                let other = distance2(end.from, [self.to, side[0], side[1]], least[lane]);
                least[lane] = if lane < len { other } else { least[lane] };
            }
        }
        let [a, b, c, d] = may;
        (a & b & c & d).then(|| least.into_iter().fold(f64::INFINITY, f64::min))
    }
}

struct Distance2<'a> {
    rest: &'a Rest,
    to: DVec3,
    place: DVec3,
}

impl Kernel for Distance2<'_> {
    type Sum = f64;

    #[inline(always)]
    fn run(self) -> f64 {
        let mut least = [self.place.distance_squared(self.to); LANES];
        for (block, len) in self.rest.blocks() {
            for (lane, least) in least.iter_mut().enumerate() {
                let corners = [self.to, block.start.at(lane), block.end.at(lane)];
                let other = distance2(self.place, corners, *least);
                *least = if lane < len { other } else { *least };
            }
        }
        least.into_iter().fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    /// The side of a triangle across from the vertex, which may have no length, and whether the triangle stays.
    fn triangle() -> impl Strategy<Value = ([DVec3; 2], bool)> {
        let side = prop_oneof![9 => [point(), point()], 1 => point().prop_map(|p| [p, p])];
        (side, prop::bool::weighted(0.8))
    }

    proptest! {
        #[test]
        fn many_triangles_are_what_each_is_alone(
            fans in prop::array::uniform2(prop::collection::vec(triangle(), 0..12)),
            ends in [point(), point()],
            [to, facing, place] in [point(), point(), point()],
        ) {
            let (mut rest, guard) = (<[Rest; 2]>::default(), Guard::new(0.2, 0.02));
            let facing = Facing::new(facing);
            let neighbour = |&(side, stays): &([DVec3; 2], bool)| Neighbour { stays, side, facing };
            for ((rest, fan), &end) in rest.iter_mut().zip(&fans).zip(&ends) {
                rest.fill(end, fan.iter().map(neighbour));
            }

            let staying = |end: usize| fans[end].iter().filter(|(_, stays)| *stays).map(|(side, _)| *side);
            let distance = |end, place: DVec3| {
                let each = staying(end).map(|[p, q]| distance2(place, [to, p, q], f64::INFINITY));
                each.fold(place.distance_squared(to), f64::min)
            };
            let may = |end: usize| staying(end).all(|side| guard.allows(ends[end], to, side, facing.normal()));
            let own = [distance(0, ends[0]), distance(1, ends[1])];
            prop_assert_eq!(Rest::follow(&rest, to, guard), (may(0) && may(1)).then_some(own));
            let distances = rest.each_ref().map(|rest| rest.distance2(to, place));
            prop_assert_eq!(distances, [distance(0, place), distance(1, place)]);
        }
    }
}
