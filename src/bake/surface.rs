//! Geometry without attributes.

use glam::Vec3;

/// Triangles of positions, counter-clockwise; what is simplified and measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// In object units. Some may be used by no triangle.
    pub positions: Vec<Vec3>,
    /// Indices into the positions.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// The corners of a triangle.
    ///
    /// # Panics
    /// Where `triangle` or what it points at is out of range.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|p| self.positions[p as usize])
    }
}
