//! Culling without a tree.

use super::lanes::Cull;
use super::{CullOptions, CullReport, VisibleBlock};
use crate::scene::Objects;
use crate::view::Lens;

/// Culls by testing every object. `visible` is overwritten, in ascending order of block; nothing is allocated once
/// its capacity is as large as the number of blocks.
///
/// Cost: linear in the objects, 2 to 9 ns for each.
pub fn linear(
    objects: &Objects,
    lens: &Lens,
    options: &CullOptions,
    visible: &mut Vec<VisibleBlock>,
) -> CullReport {
    let mut cull = Cull::new(objects, lens, options, visible);
    for block in 0..objects.blocks().len() {
        cull.test(block, cull.tests());
    }
    cull.report
}
