//! Vertex hierarchies: from a mesh and a record of its simplification to a [`Hierarchy`], and its file.
//!
//! [`build`] follows the record and works out how far off each operation is at most, around what, and which way. What
//! operations move the surface by adds up (`overlay.rs`). A height field (all of whose triangles face one of the axes'
//! directions) is measured along that axis, against the mesh itself (`ground.rs`), and operations that would turn a
//! triangle of it away from there go elsewhere on their edge, or are left out with all that rest on them.
//!
//! ```
//! use std::sync::Arc;
//!
//! use glam::{Quat, Vec2, Vec3};
//! use lod_budget::View;
//! use lod_budget::bake::simplify::{GarlandHeckbert, quietly};
//! use lod_budget::bake::{hierarchy, shapes};
//! use lod_budget::hierarchy::{Budget, Cut};
//!
//! let terrain = shapes::terrain(40, 1).into();
//! let hierarchy = hierarchy::of(&terrain, &GarlandHeckbert::default(), &mut quietly)?;
//! let mut cut = Cut::new(Arc::new(hierarchy));
//! let camera = View::perspective(1.0, Vec2::new(1920.0, 1080.0)).at(Vec3::new(0.5, -0.1, 0.3), Quat::from_rotation_x(1.0));
//! let report = cut.update(&[camera], &Budget::triangles(500));
//! assert!(report.triangles <= 500 && report.is_settled);
//! # Ok::<(), lod_budget::bake::hierarchy::BuildError>(())
//! ```

mod ball;
mod cones;
mod error;
mod file;
mod follow;
mod ground;
mod leaves;
mod overlay;
mod stars;
mod upright;

use std::ops::ControlFlow;

pub use error::{BuildError, ReadError};
pub use file::{from_bytes, read, to_bytes};

use super::Mesh;
use super::simplify::{Contraction, GarlandHeckbert, Progress, Target, Task};
use crate::hierarchy::Hierarchy;
use follow::Follow;
use upright::Upright;

/// The hierarchy of a mesh, contracted as far as the method goes. A height field is contracted flattened: what matters
/// then is how far its heights are off, and where triangles face from above.
///
/// # Errors
/// What [`GarlandHeckbert::record`] and [`build`] refuse.
pub fn of(
    mesh: &Mesh,
    method: &GarlandHeckbert,
    progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
) -> Result<Hierarchy, BuildError> {
    mesh.check().map_err(BuildError::Mesh)?;
    let record = |mesh: &Mesh, progress| method.record(&Task::new(mesh, Target::triangles(0)), progress);
    let Some(upright) = Upright::of_mesh(mesh) else {
        return build(mesh, &record(mesh, progress)?.1);
    };
    let (flat, scale) = upright.flattened(mesh);
    let (_, contractions) = record(&flat, progress)?;
    let raised: Vec<Contraction> = contractions.into_iter().map(|c| upright.raised(c, scale)).collect();
    build(mesh, &raised)
}

/// The hierarchy of a mesh and a record of contractions of its positions, in order. Triangles that use a position twice
/// and positions without a triangle are left out, attributes play no part. Some 5 µs per contraction.
///
/// # Errors
/// A mesh that breaks a rule of [`Mesh::check`], a contraction that names what is not there (any more), and numbers
/// too large for single precision.
pub fn build(mesh: &Mesh, record: &[Contraction]) -> Result<Hierarchy, BuildError> {
    mesh.check().map_err(BuildError::Mesh)?;
    let mut follow = Follow::new(mesh)?;
    for (index, contraction) in record.iter().enumerate() {
        follow.check(contraction).map_err(|rule| BuildError::Record { index, rule })?;
        follow.contract(contraction);
    }
    Ok(Hierarchy::new(follow.finish())?)
}
