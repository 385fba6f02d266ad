//! Knapsack instances from disk: the text is [`Instance::from_json`]'s, the errors name the file.

use std::path::Path;

use super::{FileError, disk};
use crate::knapsack::Instance;

impl Instance {
    /// Reads a JSON instance, UTF-8 with or without a byte order mark.
    ///
    /// # Errors
    /// A file that cannot be read, is not text, or is no instance: with class and item where one of them is at fault.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::from_bytes(&disk::read_bytes(path)?, &path.display().to_string())
    }

    /// [`Instance::read`] of bytes; `file` names them in errors.
    ///
    /// # Errors
    /// Those of [`Instance::read`], but for the reading.
    pub fn from_bytes(bytes: &[u8], file: &str) -> Result<Self, FileError> {
        Self::from_json(disk::text_of(bytes, file)?)
            .map_err(|error| FileError::whole(file, error.to_string()))
    }
}
