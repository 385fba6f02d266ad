//! Cuts a mesh into chunks that can each have a level of their own, without a crack between them.
//!
//! A track or a terrain is in view as a whole, near and far at once, so that no level of it is right. In chunks, what is
//! near is fine and what is far is coarse. Triangles are never cut: each is in exactly one chunk.
//!
//! # Why there is no crack
//! Positions that several chunks use are *locked* ([`Chunk::locked`]): all levels of all these chunks have them, bit by
//! bit. That is enough. A level is made by contractions, which take vertices to vertices and triangles to triangles, or
//! to nothing where corners meet: a simplicial map. Chunks agree about where locked vertices go, namely nowhere; no other
//! vertex has more than one chunk. So the levels of all chunks, in whatever mix, are the image of the whole mesh under
//! one simplicial map; and a map of that kind commutes with taking the border (J. Munkres, *Elements of Algebraic
//! Topology*, 1984, lemma 12.1). The border of every mix is therefore what the mesh's own border has become. A mesh
//! without border has mixes without border: neither a crack nor a T-junction. Where a mesh has a border, the edges that
//! chunks share are no part of it and stay as they are, unless an edge of the border is contracted onto one, as it may be
//! where no topology is preserved.
//!
//! The same holds of methods that fill holes anew, since a patch has the border of what it replaces. It does not hold of
//! one that moves or drops locked positions: [`Chunk::check`] looks at a level, whoever made it, and [`open_edges`] at a
//! mix.
//!
//! ```
//! use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, quietly};
//! use lod_budget::bake::split::{Options, open_edges, split};
//! use lod_budget::bake::shapes;
//!
//! let knot = shapes::torus_knot(100, 16).into();
//! let chunks = split(&knot, &Options { triangles: 1_000, ..Options::default() });
//! let mut mix = Vec::new();
//! for (i, chunk) in chunks.iter().enumerate() {
//!     let target = Target::triangles(chunk.mesh.triangles.len() >> i);
//!     let task = Task { locked: &chunk.locked, ..Task::new(&chunk.mesh, target) };
//!     mix.push(GarlandHeckbert::default().simplify(&task, &mut quietly)?.mesh);
//! }
//! assert!(open_edges(&mix.iter().collect::<Vec<_>>()).is_empty());
//! # Ok::<(), lod_budget::bake::simplify::SimplifyError>(())
//! ```

mod border;
mod cut;
mod parts;

pub use border::open_edges;

use super::Mesh;

/// Into what a mesh is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The most triangles of a chunk, ≥ 1. Fewer make more draws, and more of their vertices are locked: of a chunk of n
    /// triangles, some 2·√n edges are on its border and stay.
    pub triangles: usize,
    /// A part whose longest side is no longer than this share of the mesh's is not cut further, however many triangles it
    /// has: a statue in a landscape. From 0 to 1.
    pub share: f32,
}

impl Default for Options {
    /// 4096 triangles, of which a hundred or two cannot go; nothing smaller than a fiftieth.
    fn default() -> Self {
        Self { triangles: 4096, share: 0.02 }
    }
}

/// A part of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// Its triangles in their old order, with the positions, wedges and groups that they use.
    pub mesh: Mesh,
    /// Per position, whether another chunk uses it too: what [`Task::locked`](super::simplify::Task::locked) has to be.
    pub locked: Vec<bool>,
    /// Per triangle, which one of the whole mesh it is; ascending.
    pub triangles: Vec<u32>,
    /// The sides of its triangles that are an edge of another chunk as well, as positions, in the triangle's direction;
    /// sorted.
    pub border: Vec<[u32; 2]>,
}

/// Cuts a mesh along the middle of its longest side, and again, until all parts keep to the options: compact parts of
/// about as many triangles each. A mesh without triangles has no chunks. O(n log n).
///
/// # Panics
/// Where the mesh does not pass [`Mesh::check`].
pub fn split(mesh: &Mesh, options: &Options) -> Vec<Chunk> {
    let parts = parts::parts(mesh, options);
    cut::chunks(mesh, &parts)
}
