//! Control meshes from files.

use std::path::Path;

use super::ControlMesh;
use crate::bake::finding::Finding;
use crate::bake::read::{self, Format, MeshError, Origins};

/// A control mesh as a file has it, welded.
#[derive(Clone, Debug)]
pub struct ControlFile {
    /// The control mesh.
    pub mesh: ControlMesh,
    /// Where its faces come from.
    pub origins: Origins,
    /// What was odd.
    pub findings: Vec<Finding>,
}

/// The file at `path`: the polygons of OBJ as they are ([`read::obj::read_control`]), the triangles of the other formats
/// as [`read::load`] has them.
///
/// # Errors
/// What the format's reader refuses, and a file without a face that can be used.
pub fn load(path: &Path) -> Result<ControlFile, MeshError> {
    let file = path.display().to_string();
    if Format::guess(&[], &file) != Some(Format::Obj) {
        let read = read::load(path)?;
        let mesh = ControlMesh::from(&read.mesh);
        return Ok(ControlFile { mesh, origins: read.origins, findings: read.findings });
    }
    let whole = |rule: String| MeshError { file: file.clone(), place: None, rule };
    let bytes = std::fs::read(path).map_err(|e| whole(format!("it cannot be read: {e}")))?;
    let read = read::obj::read_control(&bytes, &file)?;
    if read.mesh.ends.is_empty() {
        return Err(whole("it must have a face that can be used".to_owned()));
    }
    Ok(read)
}
