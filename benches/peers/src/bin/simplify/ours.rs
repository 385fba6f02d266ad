//! lod-budget.

use std::error::Error;
use std::time::Duration;

use lod_budget::bake::simplify::{GarlandHeckbert, Simplifier, Target, Task, Topology, quietly};
use lod_budget::bake::{Mesh, Surface};

use crate::timed;

/// As it is by default.
pub fn preserving_topology(
    surface: &Surface,
    triangles: usize,
) -> Result<(Surface, Duration), Box<dyn Error>> {
    simplify(&GarlandHeckbert::default(), surface, triangles)
}

/// Holes may close, and the like, as they may with VTK and MeshLab.
pub fn of_any_topology(surface: &Surface, triangles: usize) -> Result<(Surface, Duration), Box<dyn Error>> {
    simplify(&GarlandHeckbert { topology: Topology::Free, ..Default::default() }, surface, triangles)
}

fn simplify(
    method: &GarlandHeckbert,
    surface: &Surface,
    triangles: usize,
) -> Result<(Surface, Duration), Box<dyn Error>> {
    let mesh = Mesh::from(surface.clone());
    let task = Task::new(&mesh, Target::triangles(triangles));
    let (simplified, time) = timed(|| method.simplify(&task, &mut quietly));
    Ok((simplified?.mesh.surface(), time))
}
