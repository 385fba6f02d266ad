//! Whole scenes: a glTF file in, the same scene with levels out.
//!
//! [`Scene::open`] reads a scene and says which [`Part`]s of it should have levels; whoever bakes makes them, in any
//! order; [`Scene::write`] adds them. Everything that is in the file stays there, by its index and name: nodes,
//! materials, images, animations, extras. What is new comes after it.
//!
//! **What gets levels**: every mesh that the scene shows, once, however many nodes show it. Left alone, and told of in
//! [`Scene::left`], are those that have levels (`MSFT_lod`, or siblings called `_LOD0`, `_LOD1` and so on), that a skin
//! or morph targets move, that have points or lines, that are drawn by `EXT_mesh_gpu_instancing`, or have hardly any
//! triangles. Other scenes of the file are left as they are.
//!
//! **How**: a node that shows such a mesh stays level 0, with its index and its mesh. Its `MSFT_lod` names new nodes,
//! placed alike and called `NAME_LOD1` and so on, which are no part of the scene; `extras.MSFT_screencoverage` says from
//! which coverage on each level is shown. What was measured of a level is in the `extras` of its mesh: `lod_error`,
//! `lod_hausdorff`, `lod_rms` and `lod_accuracy`. A node that has more to it than a place and a mesh (children, a camera,
//! extensions, an animation) hands its mesh down to a new child, since all that is below level 0 belongs to it.
//! `extras.lod_max_distance`, where an author said how far one level is seen, is repeated for each: where the object ends
//! is the author's to say.
//!
//! **Chunks**: a mesh much larger than its neighbours is in view near and far at once, and no level of it is right. It
//! is [split](super::split): each chunk is an object of its own, a child of the node that showed the whole, and fits its
//! neighbours at every mix of levels. Taken to be so is a mesh that ([`Chunks::Large`])
//! - has more than twice as many triangles as a chunk,
//! - reaches four times as far as half of the objects that are shown beside it, and
//! - is at least a quarter as large as the whole scene, and so about as large as one sees far.
//!
//! The whole mesh stays in the file, though no node shows it any more.
//!
//! ```no_run
//! use lod_budget::bake::chain::{Plan, quietly};
//! use lod_budget::bake::scene::{Options, Scene};
//! use lod_budget::bake::write::LevelOut;
//!
//! let bytes = std::fs::read("town.glb")?;
//! let scene = Scene::open(&bytes, "town.glb", None, &Options::default())?;
//! let mut chains = Vec::new();
//! for part in scene.parts() {
//!     chains.push(part.bake(&Plan::default(), &mut quietly)?);
//! }
//! let levels: Vec<Vec<LevelOut>> =
//!     chains.iter().map(|chain| chain.levels.iter().map(|level| LevelOut::new(&level.mesh)).collect()).collect();
//! std::fs::write("town_lods.glb", scene.write(&levels)?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod document;
mod embed;
mod large;
mod levels;
mod names;
mod nodes;
mod survey;

use std::ops::ControlFlow;
use std::path::Path;

use glam::DMat4;

use self::document::Document;
use super::chain::{BakeError, Chain, LeftOut, Plan, Progress, Reason};
use super::finding::Finding;
use super::read::MeshError;
use super::read::gltf::Source;
use super::simplify::Target;
use super::split::{self, Chunk};
use super::write::LevelOut;

/// What is done to a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Which meshes become chunks.
    pub chunks: Chunks,
    /// A mesh with fewer triangles gets no levels.
    pub least_triangles: usize,
}

impl Default for Options {
    /// What is large in chunks; nothing of fewer than 8 triangles.
    fn default() -> Self {
        Self { chunks: Chunks::Large(split::Options::default()), least_triangles: 8 }
    }
}

/// Which meshes become chunks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chunks {
    /// None.
    Never,
    /// Those much larger than their neighbours, as the [module](self) says.
    Large(split::Options),
    /// All with more triangles than a chunk may have.
    All(split::Options),
}

/// A mesh that is to have levels: one of the file's, or a chunk of one.
#[derive(Clone, Debug)]
pub struct Part {
    /// What the mesh is called, and which chunk it is.
    pub name: String,
    /// The mesh, and which of its positions have to stay. A mesh that is not split is a chunk by itself. Its groups are
    /// called after the numbers of the primitives they were; levels have to keep that.
    pub chunk: Chunk,
    /// How many nodes show it.
    pub instances: usize,
    /// Whether it is one of several.
    pub is_chunk: bool,
}

impl Part {
    /// Makes its levels as [`Plan::bake`] does, those that fit its neighbours.
    ///
    /// # Errors
    /// As [`Plan::bake`].
    pub fn bake(
        &self,
        plan: &Plan,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Chain, BakeError> {
        let mut chain = plan.bake_locked(&self.chunk.mesh, &self.chunk.locked, progress)?;
        let fitting = chain.levels.iter().take_while(|level| self.chunk.check(&level.mesh).is_ok()).count();
        let misfits = chain.levels.drain(fitting..).map(|level| {
            let triangles = level.triangles();
            LeftOut { target: Target::triangles(triangles), triangles, reason: Reason::Misfit }
        });
        chain.left_out.extend(misfits);
        Ok(chain)
    }
}

/// Something that is shown and gets no levels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Left {
    /// The node and its mesh.
    pub place: String,
    /// Why.
    pub reason: &'static str,
}

/// What was odd about a mesh.
#[derive(Clone, Debug)]
pub struct Odd {
    /// The mesh.
    pub place: String,
    /// What it was.
    pub finding: Finding,
}

/// A scene, and what of it is to have levels.
pub struct Scene<'a> {
    source: Source<'a>,
    document: Document,
    parts: Vec<Part>,
    subjects: Vec<Subject>,
    left: Vec<Left>,
    odd: Vec<Odd>,
}

/// A mesh of the file that gets levels.
struct Subject {
    mesh: usize,
    /// The nodes that show it.
    nodes: Vec<usize>,
    /// Of it, in [`Scene::parts`].
    parts: std::ops::Range<usize>,
}

impl<'a> Scene<'a> {
    /// Reads a scene: `file` names it in errors, `folder` is where its buffers and images are.
    ///
    /// # Errors
    /// What [`read::gltf`](super::read::gltf) refuses, with node, mesh and primitive.
    pub fn open(
        bytes: &'a [u8],
        file: &'a str,
        folder: Option<&'a Path>,
        options: &Options,
    ) -> Result<Self, MeshError> {
        let source = Source::open(bytes, file, folder)?;
        let document = Document::parse(source.json()).map_err(|rule| whole(&source, rule))?;
        let mut scene = Self {
            source,
            document,
            parts: Vec::new(),
            subjects: Vec::new(),
            left: Vec::new(),
            odd: Vec::new(),
        };
        scene.survey(options)?;
        Ok(scene)
    }

    /// Whether the file is a scene and not one mesh: several nodes that show one, or levels by nodes.
    ///
    /// # Errors
    /// As [`Scene::open`].
    pub fn is_one(bytes: &[u8], file: &str, folder: Option<&Path>) -> Result<bool, MeshError> {
        Ok(Source::open(bytes, file, folder)?.shown()?.len() > 1)
    }

    /// What is to have levels. No two are the same.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What is shown and stays as it is.
    pub fn left(&self) -> &[Left] {
        &self.left
    }

    /// What was odd, and put right in the coarser levels, and in the finest ones of chunks.
    pub fn odd(&self) -> &[Odd] {
        &self.odd
    }

    /// The scene with levels, as GLB, with all buffers in it. `levels` has those of each part, finest first, in the order
    /// of the parts; a part with no more than one gets none.
    ///
    /// # Errors
    /// More or fewer lists than parts; levels that are no meshes, have groups of other names than the part's, or, of a
    /// chunk, do not fit the neighbours ([`Chunk::check`]); more than 4 GiB in all.
    pub fn write(self, levels: &[Vec<LevelOut<'_>>]) -> Result<Vec<u8>, MeshError> {
        levels::write(self, levels)
    }
}

/// Where a node shows a mesh.
struct Place {
    node: usize,
    mesh: usize,
    world: DMat4,
}

fn whole(source: &Source<'_>, rule: impl Into<String>) -> MeshError {
    MeshError { file: source.file().to_owned(), place: None, rule: rule.into() }
}

fn at(source: &Source<'_>, place: impl Into<String>, rule: impl Into<String>) -> MeshError {
    MeshError { file: source.file().to_owned(), place: Some(place.into()), rule: rule.into() }
}
