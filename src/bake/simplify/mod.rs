//! Simplify: from a mesh to one of fewer triangles. All methods are behind one interface, [`Simplifier`].
//!
//! | method | what it does | take it for |
//! |---|---|---|
//! | [`GarlandHeckbert`] | contracts edges in the order of their quadric error | nearly everything |
//! | [`Melax`] | moves vertices onto neighbours by length times bend | a half or a quarter of the triangles, on old vertices |
//! | [`Cluster`] | joins the vertices of each cell of a grid | speed, whatever the input; far vistas |
//! | [`AdaptiveCluster`] | joins connected vertices of octree cells, as large as the error allows | speed, with seams, thin parts and joints kept |
//! | [`Decimate`] | takes vertices out and fills the holes | scans and isosurfaces, on old vertices |
//! | [`TriangleCollapse`] | contracts triangles in the order of their quadric error | even meshes, few and large steps |
//! | [`CellCollapse`] | joins the vertices of octree cells one cell after another | crowds of small parts: rubble, foliage |
//!
//! [`Method`] has them by name, as they are by default.
//!
//! A method says how far off it believes the result to be. That is an estimate, good for ordering and stopping; what
//! the runtime is told of a level has to be measured.
//!
//! # Example
//! ```
//! use lod_budget::bake::shapes;
//! use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, quietly};
//!
//! let knot = shapes::torus_knot(200, 20).into();
//! let half = Task::new(&knot, Target::triangles(4_000));
//! let simplified = GarlandHeckbert::default().simplify(&half, &mut quietly)?;
//! assert_eq!(simplified.mesh.triangles.len(), 4_000);
//! # Ok::<(), lod_budget::bake::simplify::SimplifyError>(())
//! ```

mod cell;
mod cluster;
mod decimate;
mod error;
mod fans;
mod link;
mod melax;
mod method;
mod order;
mod planes;
mod quadric;
mod queue;
mod rebuild;
mod star;
mod steps;
mod triangle;
mod workpiece;

pub use cell::CellCollapse;
pub use cluster::{AdaptiveCluster, Cluster, Representative};
pub use decimate::Decimate;
pub use error::SimplifyError;
pub use melax::Melax;
pub use method::{Method, UnknownMethod};
pub use quadric::{Attributes, Contraction, Cost, GarlandHeckbert, Placement, Topology};
pub(in crate::bake) use quadric::{Seen, Witness};
pub use triangle::TriangleCollapse;

use std::ops::ControlFlow;

use super::Mesh;

/// A way of simplifying.
pub trait Simplifier {
    /// Simplifies until the target is met or nothing more can be done, and asks `progress` every few thousand steps
    /// whether to go on. The same task has the same result.
    ///
    /// Triangles that use a position twice are dropped first, positions without a triangle last.
    ///
    /// # Errors
    /// A task that breaks a rule of [`Task`].
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError>;

    /// Simplifies to several targets, each from the task's mesh: as many calls of [`Simplifier::simplify`], unless the
    /// method knows better. The task's own target plays no part. Ends early, with what there is, when `progress` says
    /// so.
    ///
    /// # Errors
    /// As [`Simplifier::simplify`].
    fn chain(
        &self,
        task: &Task,
        targets: &[Target],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<Simplified>, SimplifyError> {
        let mut chain: Vec<Simplified> = Vec::with_capacity(targets.len());
        for &target in targets {
            chain.push(self.simplify(&Task { target, ..*task }, progress)?);
            if chain.last().is_some_and(|level| level.stopped == Stopped::Cancelled) {
                break;
            }
        }
        Ok(chain)
    }
}

/// What to simplify, and how far.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The mesh, which must pass [`Mesh::check`]. All positions that a triangle uses must be finite; there may be up to
    /// 2²⁸ triangles.
    pub mesh: &'a Mesh,
    /// When to stop.
    pub target: Target,
    /// Per position, whether it must stay where it is, bit by bit; empty when all may move.
    pub locked: &'a [bool],
    /// Per triangle, how much its error counts, finite and ≥ 0: 1 as usual, more to keep detail, less to give it up
    /// first; empty when all count 1.
    pub weights: &'a [f32],
}

impl<'a> Task<'a> {
    /// The task of simplifying all of `mesh` alike.
    pub const fn new(mesh: &'a Mesh, target: Target) -> Self {
        Self { mesh, target, locked: &[], weights: &[] }
    }

    /// Refuses a task that breaks a rule, naming the first offence.
    fn check(&self) -> Result<(), SimplifyError> {
        let Mesh { positions, triangles, wedges, .. } = self.mesh;
        let fits = |given: usize, needed: usize| given == 0 || given == needed;
        if triangles.len() > MAX_TRIANGLES || positions.len().max(wedges.len()) > u32::MAX as usize {
            return Err(SimplifyError::TooLarge { triangles: triangles.len() });
        }
        if !fits(self.locked.len(), positions.len()) {
            return Err(SimplifyError::Locked { given: self.locked.len(), vertices: positions.len() });
        }
        if !fits(self.weights.len(), triangles.len()) {
            return Err(SimplifyError::Weights { given: self.weights.len(), triangles: triangles.len() });
        }
        if let Some(triangle) = self.weights.iter().position(|w| !(w.is_finite() && *w >= 0.0)) {
            return Err(SimplifyError::Weight { triangle });
        }
        self.mesh.check().map_err(SimplifyError::Mesh)?;
        // What is not used may be anything, but mostly there is nothing to look for.
        if positions.iter().all(|p| p.is_finite()) {
            return Ok(());
        }
        (0..triangles.len()).try_for_each(|triangle| self.check_triangle(triangle))
    }

    fn check_triangle(&self, triangle: usize) -> Result<(), SimplifyError> {
        let is_finite = |&vertex: &u32| self.mesh.positions[vertex as usize].is_finite();
        match self.mesh.corners(triangle).into_iter().find(|vertex| !is_finite(vertex)) {
            Some(vertex) => Err(SimplifyError::NotFinite { triangle, vertex }),
            None => Ok(()),
        }
    }

    /// The triangles that use three positions, and which these are.
    fn proper_triangles(&self) -> (Vec<u32>, Vec<[u32; 3]>) {
        let all = (0..self.mesh.triangles.len()).map(|t| (t as u32, self.mesh.corners(t)));
        all.filter(|&(_, [a, b, c])| a != b && b != c && c != a).unzip()
    }

    fn is_locked(&self, vertex: usize) -> bool {
        self.locked.get(vertex).is_some_and(|&l| l)
    }

    fn weight(&self, triangle: usize) -> f64 {
        self.weights.get(triangle).map_or(1.0, |&w| f64::from(w))
    }
}

/// Most triangles a task may have, so that the lists of triangles around vertices fit 32-bit offsets as they grow.
const MAX_TRIANGLES: usize = 1 << 28;

/// When to stop: as soon as there are so few triangles, or before a step would cost more than the error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Go on while there are more triangles than this.
    pub triangles: usize,
    /// Take no step whose estimated error is above this, in object units.
    pub error: f32,
}

impl Target {
    /// So many triangles, whatever the error.
    pub const fn triangles(triangles: usize) -> Self {
        Self { triangles, error: f32::INFINITY }
    }

    /// As few triangles as an error allows, in object units.
    pub const fn error(error: f32) -> Self {
        Self { triangles: 0, error }
    }
}

/// How far a simplification has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Triangles at the start.
    pub from: usize,
    /// Triangles now.
    pub triangles: usize,
    /// Triangles asked for.
    pub target: usize,
}

/// The progress callback of somebody who does not care.
pub fn quietly(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// A simplified mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Simplified {
    /// What is left, without positions and wedges that no triangle uses. Triangles are in the order of those they were,
    /// so that groups are still runs.
    pub mesh: Mesh,
    /// Per position, the old position that it stems from: the one at its very place if there is one.
    pub origins: Vec<u32>,
    /// Per wedge, the old wedge that it stems from: its attributes are that one's, unless the method works out others.
    pub wedge_origins: Vec<u32>,
    /// Per old position, the position that it became; [`Simplified::GONE`] if all its triangles went.
    pub heirs: Vec<u32>,
    /// The largest error of a step, as the method estimates it, in object units. No bound of the deviation.
    pub error: f32,
    /// Why it stopped.
    pub stopped: Stopped,
}

impl Simplified {
    /// The heir of an old position that has none.
    pub const GONE: u32 = u32::MAX;
}

/// Why a simplification stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// There are as few triangles as asked for.
    Triangles,
    /// Every further step would cost too much, or is forbidden.
    Exhausted,
    /// The progress callback said so.
    Cancelled,
}
