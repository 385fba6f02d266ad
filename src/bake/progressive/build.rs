//! From a mesh to its progressive mesh.

use std::ops::ControlFlow;

use super::Progressive;
use super::file::head::MOST_UVS;
use super::marks::Marks;
use super::trail::Trail;
use super::write::Writer;
use crate::bake::Mesh;
use crate::bake::chain::BakeError;
use crate::bake::deviation;
use crate::bake::simplify::{GarlandHeckbert, Progress, Seen, SimplifyError, Stopped, Target, Task};

/// How to make a progressive mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// How to contract.
    pub method: GarlandHeckbert,
    /// Where the base mesh is. It has a triangle in any case.
    pub base: Target,
    /// How many prefixes are measured while the number of triangles halves; between them, bounds are what is known
    /// without measuring, three to ten times too large on scanned meshes. 0 to measure none, which is as much faster as
    /// errors are larger.
    pub marks_per_halving: u32,
    /// How closely they are measured.
    pub measure: deviation::Options,
}

/// Nobody asks for the mean: samples are there to find where to look for the maximum.
const FEW_SAMPLES: usize = 1 << 12;

impl Default for Options {
    /// Down to where the method ends, with 4 marks while triangles halve.
    fn default() -> Self {
        Self {
            method: GarlandHeckbert::default(),
            base: Target::triangles(0),
            marks_per_halving: 4,
            measure: deviation::Options { max_samples: FEW_SAMPLES, ..deviation::Options::default() },
        }
    }
}

impl Progressive {
    /// Makes a progressive mesh. It takes as long as simplifying, half as long again to look on, and the measurements.
    ///
    /// Triangles that use a position twice, positions that nothing uses and wedges that look the same are the
    /// original's alone: no prefix has them.
    ///
    /// # Errors
    /// A mesh that cannot be simplified or measured, or has no triangle that uses three positions; more than 255 sets of
    /// texture coordinates; what `progress` says.
    pub fn build(
        mesh: &Mesh,
        options: &Options,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Self, BakeError> {
        if mesh.uvs.len() > MOST_UVS {
            return Err(BakeError::Plan(
                "there must not be more than 255 sets of texture coordinates".into(),
            ));
        }
        let task = Task::new(mesh, options.base);
        task.mesh.check().map_err(|rule| BakeError::Simplify(SimplifyError::Mesh(rule)))?;
        let mut marks = Marks::new(mesh, options)?;
        let mut follow = |seen: &Seen, contractions: usize| marks.follow(seen, contractions);
        let mut trail = Trail::new(mesh, &mut follow);
        if options.method.attend(&task, &mut trail, progress)? == Stopped::Cancelled {
            return Err(BakeError::Cancelled);
        }
        let walked = trail.walked();
        let errors = marks.errors(&walked)?;
        let bytes = Writer::new(mesh, walked, &errors).write().map_err(BakeError::Plan)?;
        let read = Self::from_bytes(bytes, &mesh.name);
        read.map(|(mesh, _)| mesh).map_err(|error| BakeError::Plan(error.to_string()))
    }
}
