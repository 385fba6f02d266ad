//! In what order objects are laid into slots.

use super::node::is_tame;
use crate::bounds::Sphere;
use crate::scene::{BLOCK, ObjectId, Objects};

#[cfg(feature = "bvh")]
use super::bvh::SpatialOrder;
#[cfg(not(feature = "bvh"))]
use super::morton::SpatialOrder;

/// Finds an arrangement in which objects that are near each other share a block, from nothing but the objects: the
/// slots that they are in, or the order in which they came, make no difference.
#[derive(Clone, Default)]
pub(super) struct Arranger {
    /// Occupied slots by rank: tame live objects, live ones that are beyond boxes, and those that are not live; by
    /// id among themselves.
    ranked: Vec<(Rank, ObjectId, u32)>,
    /// Bounds of the tame ones, by rank.
    spheres: Vec<Sphere>,
    spatial: SpatialOrder,
    slots: Vec<u32>,
}

/// Kinds of objects that should not share a block.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Tame,
    Untame,
    Absent,
}

impl Arranger {
    /// The occupied slots in the order in which they should be arranged.
    pub fn arrange(&mut self, objects: &Objects) -> &[u32] {
        self.rank(objects);
        let tame = self.ranked.partition_point(|&(rank, ..)| rank == Rank::Tame);
        self.spheres.clear();
        self.spheres.extend(self.ranked[..tame].iter().map(|&(_, _, slot)| sphere(objects, slot)));
        let order = self.spatial.order(&self.spheres);
        self.slots.clear();
        self.slots.extend(order.iter().map(|&i| self.ranked[i as usize].2));
        self.slots.extend(self.ranked[tame..].iter().map(|&(_, _, slot)| slot));
        &self.slots
    }

    fn rank(&mut self, objects: &Objects) {
        let slots = 0..(objects.blocks().len() * BLOCK) as u32;
        let occupied = slots.filter_map(|slot| Some((objects.id_of(slot as usize)?, slot)));
        self.ranked.clear();
        self.ranked.extend(occupied.map(|(id, slot)| (rank_of(objects, slot), id, slot)));
        self.ranked.sort_unstable();
    }
}

fn rank_of(objects: &Objects, slot: u32) -> Rank {
    let (block, lane) = (&objects.blocks()[slot as usize / BLOCK], slot as usize % BLOCK);
    if block.live & (1 << lane) == 0 {
        Rank::Absent
    } else if is_tame(&block.sphere(lane)) {
        Rank::Tame
    } else {
        Rank::Untame
    }
}

fn sphere(objects: &Objects, slot: u32) -> Sphere {
    objects.blocks()[slot as usize / BLOCK].sphere(slot as usize % BLOCK)
}
