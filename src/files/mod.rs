//! What comes from disk: scenes, camera paths, knapsacks. Readers refuse what is malformed with an error that names the
//! file, the object and the rule it breaks; nothing is half-read, and nothing half-written is left behind.
//!
//! | to read | call | format |
//! |---|---|---|
//! | a scene | [`Scene::read`] | [`scene_json`] (the project's own), [`gltf`] |
//! | a camera path | [`CameraPath::read`] | [`path_files`] (CSV or TUM text) |
//! | a knapsack | [`Instance::read`](crate::knapsack::Instance::read) | JSON, `{"budget": B, "classes": [[[cost, benefit], …], …]}` |
//! | whatever it is, to be told what is in it | [`inspect()`] | all of them |
//!
//! Each reader is also there over bytes, given the name that errors shall call them by: [`Scene::from_json`],
//! [`Scene::from_gltf`], [`CameraPath::from_text`].

mod assume_levels;
mod disk;
mod error;
pub mod gltf;
pub mod inspect;
mod instance;
mod json;
mod path;
pub mod path_files;
mod scene;
pub mod scene_json;

pub use disk::write_atomically;
pub use error::FileError;
pub use inspect::{Inspection, inspect};
pub use path::{Break, BreakKind, CameraPath, PathError, Pose};
pub use scene::Scene;

use crate::table::TableError;

/// A refused table, with the file it came from.
fn of_table(error: TableError, file: &str) -> FileError {
    let level = error.level.map(|level| format!(", {level}")).unwrap_or_default();
    FileError::at(file, format!("table '{}'{level}", error.table), error.rule)
}
