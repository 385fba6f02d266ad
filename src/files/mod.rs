//! What comes from disk: scenes, camera paths. Readers refuse what is malformed with an error that names the file,
//! the object and the rule it breaks; nothing is half-read.

mod path;
mod scene;

pub use path::{CameraPath, PathError, Pose};
pub use scene::Scene;
