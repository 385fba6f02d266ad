//! Spatial order by a bounding-volume hierarchy. The only file that names obvhs.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::{PlocBuilder, SortPrecision};

use super::order::SpatialOrder;
use crate::bounds::Sphere;

/// Greatest room given to a sphere at random before building, relative to its coordinates: above 1e-6, so that it
/// survives rounding; larger blurs the order of what is nearer than that.
///
/// The builder (PLOC, D. Meister and J. Bittner, "Parallel locally-ordered clustering for bounding volume hierarchy
/// construction", 2018) merges neighbours that choose each other. Where all distances are the same, as in a row of
/// lamp posts or a crowd in one place, all choose the next one, a pass merges a single pair, and building becomes
/// quadratic: random room unties them.
const ROOM: f32 = 1e-5;

/// Points at the origin are given room as if they were so large: above 1e-13, so that areas do not underflow.
const SPECK: f32 = 1e-12;

/// Neighbours on either side that a cluster looks for its partner among. 1 to 32; from 6 on, culling gains less than
/// noise, and building takes longer.
const SEARCH_DISTANCE: usize = 6;

/// Orders spheres as the leaves of their hierarchy, depth first. Keeps its buffers.
#[derive(Clone, Default)]
pub(super) struct Hierarchy {
    builder: PlocBuilder,
    bvh: Bvh2,
    stack: Vec<u32>,
    order: Vec<u32>,
}

impl SpatialOrder for Hierarchy {
    fn order(&mut self, spheres: &[Sphere]) -> &[u32] {
        let leaves = &mut self.builder.current_nodes;
        leaves.clear();
        leaves.extend(spheres.iter().zip(0..).map(|(s, index)| Bvh2Node::new(roomy(s, index), 1, index)));
        let cube = cube_around(leaves);
        self.bvh.reset_for_reuse(spheres.len(), None);
        self.builder.build_ploc_from_leaves::<SEARCH_DISTANCE, false>(
            &mut self.bvh,
            cube,
            SortPrecision::U64,
            0,
        );
        self.list_leaves();
        &self.order
    }
}

impl Hierarchy {
    /// Lists the leaves depth first, left before right.
    fn list_leaves(&mut self) {
        self.order.clear();
        self.stack.clear();
        self.stack.extend(self.bvh.nodes.first().map(|_| 0));
        while let Some(index) = self.stack.pop() {
            let node = &self.bvh.nodes[index as usize];
            match node.is_leaf() {
                true => self.order.push(node.first_index),
                false => self.stack.extend([node.first_index + 1, node.first_index]),
            }
        }
    }
}

/// A cube from the least corner on, a hair larger than the leaves. The builder starts from the Morton order of the
/// box that it is given: in a cube, a cell is as long in every direction, where the box of a flat city has cells as
/// flat as itself and blocks twice as long.
fn cube_around(leaves: &[Bvh2Node]) -> Aabb {
    let around = leaves.iter().fold(Aabb::empty(), |around, leaf| around.union(leaf.aabb()));
    Aabb { min: around.min, max: around.min + around.diagonal().max_element() * 1.0001 }
}

/// The sphere's box with room at random, by its index.
fn roomy(sphere: &Sphere, index: u32) -> Aabb {
    let center = Vec3A::from(sphere.center);
    let scale = sphere.center.abs().max_element() + sphere.radius + SPECK;
    let half = Vec3A::splat(sphere.radius + scale * (ROOM * scatter(index)));
    Aabb { min: center - half, max: center + half }
}

/// A number from 0 to 1 that looks random: Knuth's multiplicative hash.
fn scatter(index: u32) -> f32 {
    (index.wrapping_mul(2_654_435_769) >> 8) as f32 / (1 << 24) as f32
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::cull::morton;

    fn ball(x: f32, z: f32) -> Sphere {
        Sphere::new(Vec3::new(x, 0.0, z), 0.25)
    }

    /// Summed half-area of the boxes around sixteen spheres at a time.
    fn area(spheres: &[Sphere], order: &[u32]) -> f32 {
        let boxes = order.chunks(16).map(|chunk| {
            let empty = crate::bounds::Aabb::EMPTY;
            chunk.iter().fold(empty, |aabb, &i| aabb.union(spheres[i as usize].aabb()))
        });
        boxes.map(|aabb| aabb.half_area()).sum()
    }

    #[test]
    fn none_and_one_are_ordered() {
        let mut spatial = Hierarchy::default();
        assert!(spatial.order(&[]).is_empty());
        assert_eq!(spatial.order(&[Sphere::default()]), [0]);
        assert!(spatial.order(&[]).is_empty());
    }

    #[test]
    fn every_sphere_is_listed_once_and_neighbours_lie_together() {
        let scattered = |i: u32| ball(100.0 * scatter(i), 100.0 * scatter(i.wrapping_mul(i) ^ 0x5bd1_e995));
        let spheres: Vec<Sphere> = (0..4096).map(scattered).collect();
        let order = Hierarchy::default().order(&spheres).to_vec();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..4096));
        let as_given: Vec<u32> = (0..4096).collect();
        let along_curve = area(&spheres, morton::Curve::default().order(&spheres));
        assert!(area(&spheres, &order) < 1.1 * along_curve);
        assert!(area(&spheres, &order) < 0.2 * area(&spheres, &as_given));
    }

    #[test]
    fn a_buffer_that_was_used_before_changes_nothing() {
        let spheres: Vec<Sphere> = (0..500).map(|i| ball((i * 37 % 101) as f32, (i % 13) as f32)).collect();
        let mut spatial = Hierarchy::default();
        let fresh = spatial.order(&spheres).to_vec();
        spatial.order(&spheres[..200]);
        assert_eq!(spatial.order(&spheres), fresh);
    }
}
