//! Surfaces as binary PLY, which everybody reads, in single precision, which all of them keep.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use lod_budget::bake::Surface;

/// Writes positions and triangles, used or not.
pub fn write(path: &Path, surface: &Surface) -> io::Result<()> {
    let mut file = BufWriter::new(File::create(path)?);
    let (vertices, faces) = (surface.positions.len(), surface.triangles.len());
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\n\
         element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )?;
    for coordinate in surface.positions.iter().flat_map(|p| p.to_array()) {
        file.write_all(&coordinate.to_le_bytes())?;
    }
    for triangle in &surface.triangles {
        file.write_all(&[3])?;
        for vertex in triangle {
            file.write_all(&vertex.to_le_bytes())?;
        }
    }
    file.flush()
}
