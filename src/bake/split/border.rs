//! Whether levels fit together: edges by the coordinates of their ends, whatever mesh they are in.

use glam::Vec3;

use super::Chunk;
use super::cut::sides;
use crate::bake::Mesh;
use crate::bake::weld::bits;

/// A side of a triangle: the bits of where it starts and ends.
type Side = [[u32; 3]; 2];

impl Chunk {
    /// Whether a level of this chunk fits every level of its neighbours: it has the sides of [`Chunk::border`], as often
    /// as the chunk has, and no triangle more at any of these edges. O(n log n).
    ///
    /// # Errors
    /// The ends of the first edge at which it has more or fewer triangles.
    pub fn check(&self, level: &Mesh) -> Result<(), [Vec3; 2]> {
        let found = sides_of(level);
        let mut wanted: Vec<Side> =
            self.border.iter().map(|side| side.map(|p| bits(self.mesh.positions[p as usize]))).collect();
        wanted.extend(wanted.clone().into_iter().map(|[a, b]| [b, a]));
        wanted.sort_unstable();
        wanted.dedup();
        let expected = sides_of(&self.mesh);
        let differs = |side: &&Side| count(&found, side) != count(&expected, side);
        wanted.iter().find(differs).map_or(Ok(()), |side| Err(side.map(place)))
    }
}

/// The border of several meshes as one surface: each side of a triangle that no other triangle has the opposite of, by
/// the coordinates of its ends, sorted. Empty for a surface that is closed. O(n log n).
///
/// An edge at which more triangles lead one way than the other is in it once for each that is left over.
pub fn open_edges(meshes: &[&Mesh]) -> Vec<[Vec3; 2]> {
    let mut all: Vec<Side> = meshes.iter().flat_map(|mesh| sides_of(mesh)).collect();
    all.sort_unstable();
    let mut open = Vec::new();
    for same in all.chunk_by(|a, b| a == b) {
        let [a, b] = same[0];
        let left_over = same.len().saturating_sub(count(&all, &[b, a]));
        open.extend(std::iter::repeat_n([a, b].map(place), left_over));
    }
    open
}

/// All sides of triangles but those without length, sorted.
fn sides_of(mesh: &Mesh) -> Vec<Side> {
    let places: Vec<[u32; 3]> = mesh.positions.iter().map(|&p| bits(p)).collect();
    let of_triangle = |t| sides(mesh.corners(t)).map(|side| side.map(|p| places[p as usize]));
    let mut all: Vec<Side> =
        (0..mesh.triangles.len()).flat_map(of_triangle).filter(|[a, b]| a != b).collect();
    all.sort_unstable();
    all
}

/// How often a side is among sorted ones.
fn count(sides: &[Side], side: &Side) -> usize {
    sides.partition_point(|s| s <= side) - sides.partition_point(|s| s < side)
}

fn place(bits: [u32; 3]) -> Vec3 {
    Vec3::from_array(bits.map(f32::from_bits))
}
