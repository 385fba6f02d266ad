//! Inspect.
use super::FileError;
/// Inspection.
pub struct Inspection;
/// Inspect.
pub fn inspect(path: &std::path::Path) -> Result<Inspection, FileError> { Err(FileError::whole(path.display().to_string(), "not yet")) }
