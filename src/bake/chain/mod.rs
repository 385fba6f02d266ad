//! From a mesh to its levels and their LOD table.
//!
//! A [`Plan`] says how: with which method, where to make levels ([`Stops`]) and where to end ([`Limits`]); a [`Preset`]
//! is a plan for a kind of object. [`Plan::bake`] simplifies from the original and *measures* every level against it.
//! Nothing that a method believes of itself gets into a table.
//!
//! ```
//! use lod_budget::bake::chain::{Accuracy, Plan, quietly};
//! use lod_budget::bake::shapes;
//!
//! let knot = shapes::torus_knot(200, 20).into();
//! let chain = Plan::default().bake(&knot, &mut quietly)?;
//! let table = chain.table(Accuracy::default())?;
//! assert!(table.levels().len() > 3 && table.lint().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod appearance;
mod error;
mod lineage;
mod measure;
mod plan;
mod preset;
mod search;
mod stops;
pub(in crate::bake) mod table;

pub use appearance::{Appearance, Look};
pub use error::BakeError;
pub use lineage::Lineage;
pub use measure::ChainLevel;
pub use plan::{Plan, Progress, quietly};
pub use preset::Preset;
pub use stops::{Length, Limits, Stops};
pub use table::Accuracy;

use super::deviation;
use super::geomorph::{Geomorph, GeomorphError};
use super::mesh::Mesh;
use super::simplify::Target;

/// The levels of a mesh, measured.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Finest first; level 0 is the mesh itself. Never empty, at most [`MAX_LEVELS`](crate::table::MAX_LEVELS).
    pub levels: Vec<ChainLevel>,
    /// How many positions of the mesh no triangle uses. They are left out of every level.
    pub unreferenced: usize,
    /// The levels that were asked for and are not there.
    pub left_out: Vec<LeftOut>,
}

impl Chain {
    /// The chain of levels that somebody else made, each measured against the first.
    ///
    /// # Errors
    /// No level; what cannot be measured.
    pub fn of_levels(levels: Vec<Mesh>, measure: &deviation::Options) -> Result<Self, BakeError> {
        measure::chain(levels, measure)
    }

    /// How a level turns into a coarser one, or into itself. It ends in exactly that level where the chain was baked by
    /// a method that takes vertices to vertices: all but [`Method::Decimate`], which fills holes anew, and
    /// [`Method::Cluster`] between two levels that are both coarser than level 0, since its grids do not nest. O(n log n).
    ///
    /// # Errors
    /// Levels that the chain does not have or that are in the wrong order; meshes that somebody has broken since.
    ///
    /// [`Method::Decimate`]: crate::bake::simplify::Method::Decimate
    /// [`Method::Cluster`]: crate::bake::simplify::Method::Cluster
    pub fn geomorph(&self, finer: usize, coarser: usize) -> Result<Geomorph, GeomorphError> {
        lineage::geomorph(&self.levels, finer, coarser)
    }

    /// The geomorph of each level into the next: one fewer than there are levels.
    ///
    /// # Errors
    /// As [`Chain::geomorph`].
    pub fn geomorphs(&self) -> Result<Vec<Geomorph>, GeomorphError> {
        (1..self.levels.len()).map(|coarser| self.geomorph(coarser - 1, coarser)).collect()
    }
}

/// A level that was asked for and is not there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// What was asked for.
    pub target: Target,
    /// The triangles that the method came to.
    pub triangles: usize,
    /// Why it would be of no use.
    pub reason: Reason,
}

/// Why a level is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// It has as many triangles as the finer one, or saves fewer than [`Limits::least_gain`] asks for.
    NotCoarser,
    /// It is farther from level 0 than [`Limits::most_error`], or a level before it is.
    TooFar,
    /// Nothing is left of it.
    Empty,
    /// It, or a level before it, does not fit the other chunks of its mesh.
    Misfit,
}
