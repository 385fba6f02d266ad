//! In what order objects are laid into slots.

use std::cmp::Reverse;
use std::ops::Range;

use super::node::is_tame;
use super::value::{KeptSlopes, worth};
use crate::bounds::Sphere;
use crate::scene::{BLOCK, ObjectId, Objects};

/// Lists spheres so that near ones are next to each other.
pub(super) trait SpatialOrder {
    /// Indices of the spheres, which must be finite and far from overflow.
    fn order(&mut self, spheres: &[Sphere]) -> &[u32];
}

/// Finds an arrangement in which objects that are near each other and of one class share a block, from nothing but the
/// objects: the slots that they are in, or the order in which they came, make no difference.
#[derive(Clone, Default)]
pub(super) struct Arranger<S> {
    /// Occupied slots by kind, and by id among themselves.
    ranked: Vec<(Kind, ObjectId, u32)>,
    /// Bounds of one kind, by rank.
    spheres: Vec<Sphere>,
    spatial: S,
    slots: Vec<u32>,
}

/// Kinds of objects that should not share a block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Live, and never left out for its worth.
    Needed,
    /// Live, and may be left out: the higher the class, the less it is worth. A floor passes over blocks of what is
    /// worth little from near on, and would have to look into every block if some of its objects were worth much.
    Skippable(Reverse<i16>),
    /// Live, but beyond boxes.
    Untame,
    Absent,
}

impl<S: SpatialOrder> Arranger<S> {
    /// The occupied ones of `slots` in the order in which they should be arranged. Worth is taken at these slopes.
    pub fn arrange(&mut self, objects: &Objects, slots: Range<usize>, slopes: &KeptSlopes) -> &[u32] {
        self.rank(objects, slots, slopes);
        self.slots.clear();
        for run in self.ranked.chunk_by(|a, b| a.0 == b.0) {
            match run[0].0 {
                Kind::Needed | Kind::Skippable(_) => {
                    self.spheres.clear();
                    self.spheres.extend(run.iter().map(|&(_, _, slot)| sphere(objects, slot)));
                    let order = self.spatial.order(&self.spheres);
                    self.slots.extend(order.iter().map(|&i| run[i as usize].2));
                }
                Kind::Untame | Kind::Absent => self.slots.extend(run.iter().map(|&(_, _, slot)| slot)),
            }
        }
        &self.slots
    }

    fn rank(&mut self, objects: &Objects, slots: Range<usize>, slopes: &KeptSlopes) {
        let occupied = slots.filter_map(|slot| Some((objects.id_of(slot)?, slot as u32)));
        self.ranked.clear();
        self.ranked.extend(occupied.map(|(id, slot)| (kind_of(objects, slot, slopes), id, slot)));
        self.ranked.sort_unstable();
    }
}

fn kind_of(objects: &Objects, slot: u32, slopes: &KeptSlopes) -> Kind {
    let (index, lane) = (slot as usize / BLOCK, slot as usize % BLOCK);
    let block = &objects.blocks()[index];
    let has = |mask: u16| mask & (1 << lane) != 0;
    if !has(block.live) {
        Kind::Absent
    } else if !is_tame(&block.sphere(lane)) {
        Kind::Untame
    } else if !has(block.skippable) {
        Kind::Needed
    } else {
        let worth = worth(objects, index, lane, Some(slopes.of(block.table[lane])));
        Kind::Skippable(Reverse(class_of(worth)))
    }
}

/// Worths of a class are within a factor of 2 of each other: the radii of equal objects within 1.4. A wider class is
/// worth its floor in a wider ring around the eye, and all of it in that ring has to be tested; a narrower one has
/// fewer objects to fill blocks that are near each other.
fn class_of(worth: f64) -> i16 {
    (worth.to_bits() >> 52) as i16 - 1023
}

fn sphere(objects: &Objects, slot: u32) -> Sphere {
    objects.blocks()[slot as usize / BLOCK].sphere(slot as usize % BLOCK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_spans_a_factor_of_two() {
        assert_eq!([1.0, 1.99, 2.0, 4.0, 0.99, 0.5, 0.49].map(class_of), [0, 0, 1, 2, -1, -1, -2]);
        assert_eq!([class_of(0.0), class_of(f64::MAX)], [-1023, 1023]);
    }
}
