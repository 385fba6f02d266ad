//! Culling without a tree.

use super::lanes::Cull;
use super::value::ValueFloor;
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
    linear_above(objects, lens, options, &ValueFloor::NONE, visible)
}

/// [`linear`] that passes over what is worth too little.
pub fn linear_above(
    objects: &Objects,
    lens: &Lens,
    options: &CullOptions,
    floor: &ValueFloor<'_>,
    visible: &mut Vec<VisibleBlock>,
) -> CullReport {
    let mut cull = Cull::new(objects, lens, options, floor, visible);
    for (index, block) in objects.blocks().iter().enumerate() {
        cull.test(index, block.live, cull.tests());
    }
    cull.report
}
