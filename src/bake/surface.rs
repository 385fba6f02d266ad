//! The geometry of a mesh alone, for simplification and measuring.

use glam::Vec3;

/// Triangles over shared positions. Positions that no triangle names are no part of the surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Vertices, in object units.
    pub positions: Vec<Vec3>,
    /// Indices into the positions, counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}
