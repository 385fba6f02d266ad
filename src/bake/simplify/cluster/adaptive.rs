//! Clusters of an octree, as fine as the surface needs.
//!
//! After A. Willmott, "Rapid simplification of multi-attribute meshes", High Performance Graphics 2011, whose aims these
//! are: clusters that keep thin parts, seams of attributes and what moves with different joints. The means are our own:
//! - cells are as large as the quadric error of their vertex allows, as in E. Shaffer, M. Garland, "Efficient adaptive
//!   simplification of massive meshes", 2001, instead of all alike;
//! - only vertices that edges connect within the cell are joined, so that the two sides of a thin wall, and parts that
//!   are close to each other, stay two; a thin part goes when the error is as large as it is thin;
//! - cells that hold vertices of different dominant joints count as wrong by their whole diagonal;
//! - how large the error may be follows from the target: every triangle goes at some error, known from the start.

use std::ops::ControlFlow;

use super::cloud::{Cloud, Clusters};
use super::octree::Octree;
use crate::bake::simplify::{Progress, Simplified, Simplifier, SimplifyError, Task};

/// The connected vertices of an octree's cell become one, small cells where the surface is curved and large ones where it
/// is flat: nearly as fast as a uniform grid, at half the error and less. Keeps seams, thin parts and joints apart.
///
/// A target of triangles is met to within those that one cell takes with it. Weights make cells smaller; they have no
/// part in the error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdaptiveCluster {}

impl Simplifier for AdaptiveCluster {
    fn simplify(
        &self,
        task: &Task,
        progress: &mut dyn FnMut(Progress) -> ControlFlow<()>,
    ) -> Result<Simplified, SimplifyError> {
        task.check()?;
        let cloud = Cloud::new(task);
        let is_cancelled = progress(cloud.progress(cloud.triangles.len())).is_break();
        if is_cancelled || cloud.triangles.len() <= task.target.triangles {
            let clusters = cloud.singles();
            return Ok(cloud.finish(&clusters, 0.0, is_cancelled));
        }
        let (clusters, error) = adapt(&cloud);
        Ok(cloud.finish(&clusters, error, false))
    }
}

/// The smallest cells that meet the target of triangles, or else the largest that the error allows; and their error.
fn adapt(cloud: &Cloud) -> (Clusters, f32) {
    let octree = Octree::new(cloud);
    let mut ends = octree.ends_of_triangles(cloud);
    let target = cloud.task.target.triangles.min(ends.len() - 1);
    // Largest first: those before the target stay, and the one at the target goes, with all that go at the same error.
    let (_, &mut at, _) = ends.select_nth_unstable_by(target, |a, b| b.total_cmp(a));
    octree.cut(cloud, at)
}
