//! Whose word counts for what is visible: the runtime's culling, the caller's, or both.

use crate::cull::{BlockTree, CullOptions, CullReport, ValueFloor, VisibleBlock};
use crate::rate::Seen;
use crate::scene::{BLOCK, ObjectId, Objects};

/// What is visible in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility<'a> {
    /// What the runtime's culling finds.
    #[default]
    Computed,
    /// What the runtime's culling finds, but for these: objects that the caller knows to be occluded.
    Without(&'a [ObjectId]),
    /// Exactly these, where they exist, are not hidden and have a finite bound: the caller's own culling. The order
    /// does not matter.
    Given(&'a [ObjectId]),
}

/// Fills in what is visible through the lens of `seen`.
pub(super) fn find(
    tree: &BlockTree,
    objects: &Objects,
    options: &CullOptions,
    floor: &ValueFloor<'_>,
    visibility: Visibility<'_>,
    seen: &mut Seen,
) -> CullReport {
    seen.visible.clear();
    match visibility {
        Visibility::Computed => tree.cull_above(objects, &seen.lens, options, floor, &mut seen.visible),
        Visibility::Without(hidden) => {
            let report = tree.cull_above(objects, &seen.lens, options, floor, &mut seen.visible);
            hidden
                .iter()
                .filter_map(|&id| objects.slot_of(id))
                .for_each(|slot| hide(&mut seen.visible, slot));
            seen.visible.retain(|v| v.mask != 0);
            report
        }
        Visibility::Given(ids) => {
            let slots = ids.iter().filter_map(|&id| objects.slot_of(id));
            seen.visible.extend(slots.map(block_of));
            gather(objects, &mut seen.visible);
            CullReport::default()
        }
    }
}

fn block_of(slot: usize) -> VisibleBlock {
    VisibleBlock { block: (slot / BLOCK) as u32, mask: 1 << (slot % BLOCK) }
}

fn hide(visible: &mut [VisibleBlock], slot: usize) {
    let hidden = block_of(slot);
    if let Ok(at) = visible.binary_search_by_key(&hidden.block, |v| v.block) {
        visible[at].mask &= !hidden.mask;
    }
}

/// Merges single objects in any order into ascending blocks of live ones.
fn gather(objects: &Objects, visible: &mut Vec<VisibleBlock>) {
    visible.sort_unstable_by_key(|v| v.block);
    visible.dedup_by(|later, kept| {
        let same = later.block == kept.block;
        kept.mask |= if same { later.mask } else { 0 };
        same
    });
    visible.iter_mut().for_each(|v| v.mask &= objects.blocks()[v.block as usize].live);
    visible.retain(|v| v.mask != 0);
}
