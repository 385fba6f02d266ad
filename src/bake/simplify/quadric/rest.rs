//! What is left of a vertex's fan when the vertex becomes one with another, several triangles at once.
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

/// Some triangles of a vertex.
#[derive(Clone, Copy, Default)]
struct Block {
    /// Where the side across from the vertex starts and ends, seen along the triangle's direction.
    start: [Column; 3],
    end: [Column; 3],
    /// Where the triangle once faced.
    facing: [Column; 3],
}

/// The triangles of a vertex but for those that go.
#[derive(Default)]
pub(super) struct Rest {
    /// Where the vertex is.
    from: DVec3,
    /// Room for more triangles than there are.
    blocks: Vec<Block>,
    len: usize,
}

impl Rest {
    /// Empties it for a vertex that is at a place, with room for so many triangles.
    pub(super) fn clear(&mut self, from: DVec3, room: usize) {
        (self.from, self.len) = (from, 0);
        if self.blocks.len() * LANES <= room {
            self.blocks.resize(room / LANES + 1, Block::default());
        }
    }

    /// Adds a triangle, or only makes as if: nobody can predict which triangles stay.
    #[inline]
    pub(super) fn add_if(&mut self, stays: bool, [start, end]: [DVec3; 2], facing: Facing) {
        let (block, lane) = (&mut self.blocks[self.len / LANES], self.len % LANES);
        block.start.set(lane, start);
        block.end.set(lane, end);
        block.facing.set(lane, facing.normal());
        self.len += usize::from(stays);
    }

    /// Whether all triangles may follow the vertex to a place.
    #[inline]
    pub(super) fn may_go(&self, to: DVec3, guard: Guard) -> bool {
        kernel::run(MayGo { rest: self, to, guard })
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

struct MayGo<'a> {
    rest: &'a Rest,
    to: DVec3,
    guard: Guard,
}

impl Kernel for MayGo<'_> {
    type Sum = bool;

    #[inline(always)]
    fn run(self) -> bool {
        self.rest.blocks().all(|(block, len)| {
            let mut may = [true; LANES];
            for (lane, may) in may.iter_mut().enumerate() {
                let side = [block.start.at(lane), block.end.at(lane)];
                *may = self.guard.allows(self.rest.from, self.to, side, block.facing.at(lane));
            }
            !may[..len].contains(&false)
        })
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
            triangles in prop::collection::vec(triangle(), 0..20),
            [from, to, facing, place] in [point(), point(), point(), point()],
        ) {
            let (mut rest, guard) = (Rest::default(), Guard::new(0.2, 0.02));
            let facing = Facing::new(facing);
            rest.clear(from, triangles.len());
            for &(side, stays) in &triangles {
                rest.add_if(stays, side, facing);
            }
            let staying = || triangles.iter().filter(|(_, stays)| *stays);
            let mut all = staying().map(|(side, _)| guard.allows(from, to, *side, facing.normal()));
            prop_assert_eq!(rest.may_go(to, guard), all.all(|may| may));
            let each = staying().map(|([p, q], _)| distance2(place, [to, *p, *q], f64::INFINITY));
            prop_assert_eq!(rest.distance2(to, place), each.fold(place.distance_squared(to), f64::min));
        }
    }
}
