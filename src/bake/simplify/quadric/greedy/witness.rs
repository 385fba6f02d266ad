//! Looking on while vertices are contracted.

use glam::Vec3;

use super::{GONE, Greedy};

/// Somebody who looks on. Vertices and triangles go by the method's own numbers, which are in the order of a curve
/// through space.
pub(in crate::bake) trait Witness {
    /// Before the first contraction.
    fn begin(&mut self, seen: &Seen);

    /// Right before a contraction.
    fn before(&mut self, seen: &Seen, kept: u32, gone: u32);

    /// Right after it.
    fn after(&mut self, seen: &Seen, kept: u32, gone: u32);
}

/// What there is to see.
pub(in crate::bake) struct Seen<'g, 'a> {
    pub(super) greedy: &'g Greedy<'a>,
}

impl<'g> Seen<'g, '_> {
    /// Per vertex, the position of the task's mesh that it was.
    pub(in crate::bake) fn vertices(&self) -> &'g [u32] {
        &self.greedy.order
    }

    /// Per triangle, the triangle of the task's mesh that it was.
    pub(in crate::bake) fn old_triangles(&self) -> &'g [u32] {
        &self.greedy.old_triangles
    }

    /// The corners of a triangle, which are vertices; none once it is gone.
    pub(in crate::bake) fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        Some(self.greedy.triangles[triangle as usize]).filter(|&corners| corners != GONE)
    }

    /// How many triangles are left.
    pub(in crate::bake) fn live(&self) -> usize {
        self.greedy.live
    }

    /// The triangles around a vertex, in no particular order.
    pub(in crate::bake) fn fan(&self, vertex: u32) -> &'g [u32] {
        self.greedy.fans.of(vertex)
    }

    /// Where a vertex is, in object units.
    pub(in crate::bake) fn position(&self, vertex: u32) -> Vec3 {
        self.greedy.position(vertex)
    }

    /// The largest error of a contraction so far, as the method estimates it, in object units.
    pub(in crate::bake) fn error(&self) -> f32 {
        self.greedy.in_units(self.greedy.error)
    }

    /// The position of the task's mesh that a vertex stems from by now.
    pub(in crate::bake) fn origin(&self, vertex: u32) -> u32 {
        self.greedy.origins[vertex as usize]
    }

    /// What tells the corners of a vertex apart, but for their tangents: equal for those that look the same.
    pub(in crate::bake) fn look(&self, triangle: u32, corner: usize) -> [u32; 3] {
        self.greedy.layers.as_ref().map_or([0; 3], |layers| layers.look(triangle as usize, corner))
    }

    /// The normal, the texture coordinates of all sets and the colour of a look, those that the mesh has, one after
    /// the other.
    pub(in crate::bake) fn values(&self, look: [u32; 3]) -> impl Iterator<Item = f32> + use<'g> {
        self.greedy.layers.iter().flat_map(move |layers| layers.finished(look))
    }
}
