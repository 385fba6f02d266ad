//! Vertex clustering: a grid over the mesh, and a vertex for each of its cells.

mod adaptive;
pub(super) mod cloud;
mod octree;
mod uniform;

pub use adaptive::AdaptiveCluster;
pub use uniform::{Cluster, Representative};
