//! Edge contraction in the order of the quadric error.
//!
//! M. Garland, P. Heckbert, "Surface simplification using quadric error metrics", SIGGRAPH 1997. The error of a vertex
//! is the sum of squared distances to the planes of the triangles that were contracted into it, weighted by their
//! areas; the edge whose contraction costs least goes first. Attributes add to the error as in `layer.rs`. Where we
//! depart from the paper:
//! - the best place is held near the middle of the edge by a weak spring, so that flat and straight parts are no
//!   special case (see [`Placement::Optimal`]);
//! - on what bulges vertices go a little further to the outside than the quadric says (see [`Placement::Balanced`]);
//! - among contractions that cost next to nothing the shorter edge goes first, so that flat parts keep good triangles;
//! - costs lie between the sum and the mean of squared distances, and know of tips (see [`Cost::Balanced`]);
//! - a contraction that would turn a triangle over or make it a sliver is refused instead of made dearer;
//! - the queue is lazy: errors only grow, so an edge whose surroundings changed is looked at again when it comes up,
//!   not before (J. Cohen, D. Manocha, M. Olano, "Simplifying polygonal models using successive mappings", 1997).

mod cost;
mod distance;
mod edges;
mod form;
mod greedy;
mod guard;
mod layer;
mod layers;
mod pairs;
mod patch;
mod placement;
mod record;
mod rest;

pub use cost::Cost;
pub(in crate::bake) use greedy::witness::{Seen, Witness};
pub use layers::Attributes;
pub use placement::Placement;
pub use record::Contraction;

use std::ops::ControlFlow;

use super::{Progress, Simplified, Simplifier, SimplifyError, Stopped, Target, Task};
use greedy::Greedy;
use record::Record;

/// Whether contractions may change the topology.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Topology {
    /// Closed stays closed, manifold stays manifold, and no hole, handle or part appears or goes. Nor does what is
    /// between held seams.
    #[default]
    Preserved,
    /// Holes may close, handles and small parts may collapse, edges of more than two triangles may come, when it is their
    /// turn: at a price that stands for what the quadrics do not know.
    Free,
}

/// Edge contraction by quadric error: the best of the methods in most respects, at some 2 µs per triangle that goes.
///
/// Do not take it for foliage, where what counts is how much of the view is covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GarlandHeckbert {
    /// Where contracted vertices go.
    pub placement: Placement,
    /// What orders contractions.
    pub cost: Cost,
    /// Whether holes may close, and the like.
    pub topology: Topology,
    /// Vertices that are closer than this in the original mesh, in object units, may be contracted without an edge
    /// between them, which lets parts grow together; 0 for edges alone. Needs [`Topology::Free`], without which it does
    /// nothing. A vertex is paired with the eight nearest of those that share no triangle with it, and with any for which
    /// it is among their eight.
    pub pairs: f32,
    /// How much moving away from a border counts, compared with moving away from the surface, ≥ 0. Edges of more than
    /// two triangles are no borders: the surface does not end there.
    pub border: f32,
    /// How much attributes count.
    pub attributes: Attributes,
    /// How much moving away from a seam counts, compared with moving away from the surface, ≥ 0: where materials,
    /// textures or colours meet. Where attributes are ignored seams are too.
    pub seam: f32,
    /// Least cosine of the angle by which one contraction may turn a triangle, in [0, 1].
    pub least_turn: f32,
    /// Least shape of a triangle that had a better one: 1 is equilateral, 0 has no area.
    pub least_shape: f32,
}

impl Default for GarlandHeckbert {
    fn default() -> Self {
        Self {
            placement: Placement::Balanced,
            cost: Cost::Balanced,
            topology: Topology::Preserved,
            pairs: 0.0,
            border: 10.0,
            attributes: Attributes::default(),
            seam: 1.0,
            least_turn: 0.2,
            least_shape: 0.02,
        }
    }
}

impl GarlandHeckbert {
    /// Simplifies as [`Simplifier::simplify`] does and tells every contraction, in order. Triangles that used both of
    /// its vertices go with it.
    ///
    /// # Errors
    /// As [`Simplifier::simplify`].
    pub fn record(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Simplified, Vec<Contraction>), SimplifyError> {
        let mut record = Record::default();
        let (greedy, stopped) = self.run_before(task, &mut record, progress)?;
        let simplified = greedy.finish(stopped);
        Ok((simplified, record.contractions))
    }

    /// Simplifies as [`Simplifier::simplify`] does while somebody looks on.
    pub(in crate::bake) fn attend(
        &self,
        task: &Task,
        witness: &mut dyn Witness,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Stopped, SimplifyError> {
        self.run_before(task, witness, progress).map(|(_, stopped)| stopped)
    }

    fn run_before<'a>(
        &'a self,
        task: &'a Task<'a>,
        witness: &'a mut dyn Witness,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<(Greedy<'a>, Stopped), SimplifyError> {
        task.check()?;
        let mut greedy = Greedy::new(self, task);
        greedy.witness = Some(witness);
        greedy.tell(|witness, seen| witness.begin(seen));
        let stopped = greedy.run(task.target, progress);
        Ok((greedy, stopped))
    }
}

impl Simplifier for GarlandHeckbert {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        task.check()?;
        let mut greedy = Greedy::new(self, task);
        let stopped = greedy.run(task.target, progress);
        Ok(greedy.finish(stopped))
    }

    /// Every level goes on from the one before, unless its target is finer: a whole chain costs as much as its last level.
    fn chain(
        &self,
        task: &Task,
        targets: &[Target],
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Vec<Simplified>, SimplifyError> {
        task.check()?;
        let mut greedy = Greedy::new(self, task);
        let mut chain = Vec::with_capacity(targets.len());
        let mut last = Target { triangles: usize::MAX, error: 0.0 };
        for &target in targets {
            if target.triangles > last.triangles || target.error < last.error {
                greedy = Greedy::new(self, task);
            }
            let stopped = greedy.run(target, progress);
            chain.push(greedy.finish(stopped));
            if stopped == Stopped::Cancelled {
                break;
            }
            last = target;
        }
        Ok(chain)
    }
}
