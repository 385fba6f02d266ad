//! A glTF file as whoever adds to it needs it: its JSON, its bytes, and its meshes one by one.

use std::path::Path;

use glam::DMat4;

use super::document::{self, Document};
use super::nodes::{self, Placed};
use super::primitive::{self, Assembly};
use super::{MeshError, MeshFile, Refused};
use crate::gltf::parts;

/// An open file.
pub(in crate::bake) struct Source<'a> {
    file: &'a str,
    folder: Option<&'a Path>,
    text: &'a [u8],
    document: Document<'a>,
}

/// A mesh that the scene shows.
pub(in crate::bake) struct Shown {
    pub(in crate::bake) node: usize,
    pub(in crate::bake) mesh: usize,
    /// From the mesh's own units to the scene's.
    pub(in crate::bake) world: DMat4,
}

impl<'a> Source<'a> {
    /// As [`read`](super::read).
    pub(in crate::bake) fn open(
        bytes: &'a [u8],
        file: &'a str,
        folder: Option<&'a Path>,
    ) -> Result<Self, MeshError> {
        let document = Document::open(bytes, folder).map_err(|refused| refused.within(file))?;
        let (text, _) = parts(bytes).map_err(|rule| Refused::whole(rule).within(file))?;
        Ok(Self { file, folder, text, document })
    }

    /// What errors call the file.
    pub(in crate::bake) fn file(&self) -> &'a str {
        self.file
    }

    pub(in crate::bake) fn json(&self) -> &'a [u8] {
        self.text
    }

    /// The bytes of every buffer.
    pub(in crate::bake) fn buffers(&self) -> Result<Vec<&[u8]>, MeshError> {
        let bytes = self.document.buffers().enumerate().map(|(i, buffer)| {
            buffer.map_err(|rule| Refused::at(format!("buffer {i}"), format!("it {rule}")).within(self.file))
        });
        bytes.collect()
    }

    /// The bytes of a file beside this one; `None` for data in the text and for what cannot be read.
    pub(in crate::bake) fn file_beside(&self, uri: &str) -> Option<Vec<u8>> {
        if uri.starts_with("data:") { None } else { document::from_disk(uri, self.folder).ok() }
    }

    /// What the scene shows, depth first, without coarser levels.
    pub(in crate::bake) fn shown(&self) -> Result<Vec<Shown>, MeshError> {
        let placed = nodes::placed(&self.document).map_err(|refused| refused.within(self.file))?;
        let shown = |Placed { mesh, node, world }: Placed| Some(Shown { node: node?, mesh, world });
        Ok(placed.into_iter().filter_map(shown).collect())
    }

    /// A mesh in its own units, a group for each of its primitives, of which none may be of points or lines.
    pub(in crate::bake) fn mesh(&self, mesh: usize) -> Result<MeshFile, MeshError> {
        let limit = primitive::triangle_limit(&self.document);
        let name = self.document.mesh_name(mesh);
        let mut assembly = Assembly::new(&self.document, name, "mesh", limit);
        assembly.add(&Placed::alone(mesh)).map_err(|refused| refused.within(self.file))?;
        Ok(assembly.into_file())
    }
}
