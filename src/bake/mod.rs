//! Bake: from meshes to tables of levels that can be trusted.
//!
//! [`simplify`] makes the levels; [`shapes`] makes meshes to try it on.

pub mod shapes;
pub mod simplify;

mod surface;

pub use surface::Surface;
