//! glTF.
use super::{FileError, Scene};
impl Scene {
    /// Reads.
    pub fn from_gltf(_bytes: &[u8], file: &str) -> Result<Self, FileError> {
        Err(FileError::whole(file, "not yet"))
    }
}
