//! glTF 2.0, as `.gltf` with its buffers or `.glb`.
//!
//! [`read`] makes one mesh of the default scene (else the first, else all nodes without a parent, else all meshes as
//! they are): every primitive of every node, moved to where the node puts it, each a group with its material's name.
//! A node that mirrors turns its triangles over, so that they stay counter-clockwise. A skinned mesh stays where its
//! joints expect it, as the specification says, and its joints are those of its own skin. Coarser levels (`MSFT_lod`)
//! are left out. [`read_meshes`] gives every mesh of the file by itself, once, in its own units.
//!
//! Positions, normals, tangents, eight sets of texture coordinates, the first set of colours, joints and weights are
//! read, from floats or integers, sparse or not. Points and lines, morph targets and further sets are passed over.
//! Where one primitive has an attribute and another has not, the other's is zero, or white.
//!
//! The vocabulary is the `gltf` crate's; accessors are read here, because that crate takes sizes and counts on trust.
//! Refused are accessors and indices out of range, and required extensions that change geometry (Draco, meshopt).
//! Nodes and primitives may repeat what is in the file, but not into more triangles than the file has bytes, or 2²⁰
//! where that is more; long names count as triangles.

mod accessor;
mod document;
mod nodes;
mod primitive;
mod source;

pub(in crate::bake) use self::source::Source;

use std::path::Path;

use self::document::Document;
use self::nodes::Placed;
use self::primitive::Assembly;
use super::{MeshError, MeshFile, Refused, stem};

/// Reads everything that the scene shows as one mesh; `file` names it in errors, `folder` is where its buffers are.
///
/// # Errors
/// What the [module](self) says, with the node, mesh and primitive; buffers that are other files where there is no
/// folder.
pub fn read(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<MeshFile, MeshError> {
    let read = || {
        let document = Document::open(bytes, folder)?;
        let limit = primitive::triangle_limit(&document);
        let mut assembly = Assembly::new(&document, stem(file), "node", limit);
        for placed in nodes::placed(&document)? {
            assembly.add(&placed)?;
        }
        Ok(assembly.into_file())
    };
    read().map_err(|refused: Refused| refused.within(file))
}

/// Reads every mesh of the file by itself, in the file's order and called as the file calls it.
///
/// # Errors
/// As [`read`].
pub fn read_meshes(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<Vec<MeshFile>, MeshError> {
    let read = || {
        let document = Document::open(bytes, folder)?;
        let mut left = primitive::triangle_limit(&document);
        let mut files = Vec::new();
        for mesh in 0..document.meshes.len() {
            let mut assembly = Assembly::new(&document, document.mesh_name(mesh), "mesh", left);
            assembly.add(&Placed::alone(mesh))?;
            left = assembly.left();
            files.push(assembly.into_file());
        }
        Ok(files)
    };
    read().map_err(|refused: Refused| refused.within(file))
}

#[cfg(test)]
mod tests;
