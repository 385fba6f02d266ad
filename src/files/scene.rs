//! A scene as it is read or generated: tables and objects, not yet in the hot store.

use std::path::Path;

use super::{FileError, disk};
use crate::scene::{Object, ObjectError, Objects};
use crate::table::LodTable;

/// Tables, and objects that refer to them by position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Name, for reports.
    pub name: String,
    /// LOD tables; [`crate::scene::TableId`] is the position here.
    pub tables: Vec<LodTable>,
    /// Objects, with unique ids.
    pub objects: Vec<Object>,
}

impl Scene {
    /// The scene in a hot store, tables in the same order.
    ///
    /// # Errors
    /// The first object that [`Objects::insert`] refuses.
    pub fn to_objects(&self) -> Result<Objects, ObjectError> {
        let mut store = Objects::new();
        for table in &self.tables {
            store.add_table(table.clone())?;
        }
        for object in &self.objects {
            store.insert(*object)?;
        }
        Ok(store)
    }

    /// Reads a scene file; its extension says which kind: `.json` ([`crate::files::scene_json`]), `.glb` or `.gltf`
    /// ([`crate::files::gltf`]).
    ///
    /// # Errors
    /// A file that cannot be read, of an unknown kind, or malformed.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let file = path.display().to_string();
        match disk::extension(path).as_str() {
            "json" => Self::from_json(&disk::read_bytes(path)?, &file),
            "glb" | "gltf" => Self::from_gltf(&disk::read_bytes(path)?, &file),
            _ => Err(FileError::whole(file, "a scene must be a .json, .glb or .gltf file")),
        }
    }

    /// Writes the scene as JSON, replacing the file as a whole.
    ///
    /// # Errors
    /// What [`Scene::to_json`] or the file system refuses; an older file is then as it was.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        let named = |e: FileError| FileError { file: path.display().to_string(), ..e };
        disk::write_atomically(path, self.to_json().map_err(named)?.as_bytes())
    }
}
