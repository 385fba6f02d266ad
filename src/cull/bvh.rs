//! Spatial order by a bounding-volume hierarchy. The only file that names obvhs.

use glam::Vec3A;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

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

/// Orders spheres as the leaves of their hierarchy, depth first. Keeps its buffers.
#[derive(Clone, Default)]
pub(super) struct SpatialOrder {
    boxes: Vec<Aabb>,
    builder: PlocBuilder,
    bvh: Bvh2,
    stack: Vec<u32>,
    order: Vec<u32>,
}

impl SpatialOrder {
    /// Indices of the spheres, near ones next to each other. The spheres must be finite and far from overflow.
    pub fn order(&mut self, spheres: &[Sphere]) -> &[u32] {
        self.boxes.clear();
        self.boxes.extend(spheres.iter().zip(0..).map(|(sphere, index)| roomy(sphere, index)));
        self.build();
        self.list_leaves();
        &self.order
    }

    fn build(&mut self) {
        let mut indices = std::mem::take(&mut self.bvh.primitive_indices);
        indices.clear();
        indices.extend(0..self.boxes.len() as u32);
        self.builder.build_with_bvh(
            &mut self.bvh,
            PlocSearchDistance::Low,
            &self.boxes,
            indices,
            SortPrecision::U64,
            0,
        );
    }

    /// Lists the primitives depth first, left before right.
    fn list_leaves(&mut self) {
        self.order.clear();
        self.stack.clear();
        self.stack.extend(self.bvh.nodes.first().map(|_| 0));
        while let Some(index) = self.stack.pop() {
            let node = &self.bvh.nodes[index as usize];
            let first = node.first_index;
            if node.is_leaf() {
                let leaf = first as usize..(first + node.prim_count) as usize;
                self.order.extend_from_slice(&self.bvh.primitive_indices[leaf]);
            } else {
                self.stack.extend([first + 1, first]);
            }
        }
    }
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
