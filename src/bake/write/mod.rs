//! What a bake leaves behind: [`obj()`] for a level by itself, [`mod@glb`] for all levels of an object or a scene, and
//! [`sheet`] for people.
//!
//! Everything is made in memory; whoever asks for it puts it on disk. The same meshes give the same bytes.

pub mod glb;
pub mod obj;
pub mod sheet;

pub use glb::{Glb, GlbError, glb};
pub use obj::obj;

use super::Mesh;
use super::geomorph::Geomorph;
use super::impostor::Impostor;

/// A level as it is written.
#[derive(Clone, Copy, Debug)]
pub struct LevelOut<'a> {
    /// What it draws, which may be nothing.
    pub mesh: &'a Mesh,
    /// `None` where nobody measured it.
    pub measured: Option<Measured>,
    /// The share of the image, ≥ 0, from which on the level is shown, as `MSFT_screencoverage` has it.
    pub coverage: Option<f32>,
    /// What share of the object's benefit the level has, from 0 to 1; `None` where nobody worked it out.
    pub accuracy: Option<f32>,
    /// How it turns into the next coarser level. In a GLB a morph target; other files have no place for it.
    pub geomorph: Option<&'a Geomorph>,
    /// The impostor whose quads the mesh is: a GLB says all of it, with the mesh.
    pub impostor: Option<&'a Impostor>,
    /// What a contact sheet shows, where that is not the mesh: [`Impostor::seen`].
    pub picture: Option<&'a Mesh>,
}

impl<'a> LevelOut<'a> {
    /// A level of which nothing is known but its mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self {
            mesh,
            measured: None,
            coverage: None,
            accuracy: None,
            geomorph: None,
            impostor: None,
            picture: None,
        }
    }
}

/// How far a level is from level 0, in object units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measured {
    /// The greatest bound of this and all finer levels: what the runtime projects.
    pub error: f32,
    /// The proved bound on the Hausdorff distance of this level.
    pub hausdorff: f64,
    /// The root mean square distance.
    pub rms: f64,
}
