//! The geometry of a mesh alone: what simplification and measuring work on.

use glam::Vec3;

/// Triangles over positions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions, in object units.
    pub positions: Vec<Vec3>,
    /// Indices into [`Surface::positions`], counter-clockwise.
    pub triangles: Vec<[u32; 3]>,
}
