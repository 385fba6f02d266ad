//! Culling.

/// Objects of one block that are in view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleBlock {
    /// Position of the block.
    pub block: u32,
    /// Bit per lane; never 0.
    pub mask: u16,
}
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CullOptions {
    pub min_size_px: f32,
}
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CullReport {
    pub visited_nodes: usize,
    pub tested_objects: usize,
}
#[derive(Clone, Debug, Default)]
pub struct BlockTree {}
impl BlockTree {
    pub fn update(&mut self, _o: &mut crate::scene::Objects) {}
    pub fn cull(
        &self,
        objects: &crate::scene::Objects,
        lens: &crate::view::Lens,
        _: &CullOptions,
        visible: &mut Vec<VisibleBlock>,
    ) -> CullReport {
        for (b, block) in objects.blocks().iter().enumerate() {
            let mut mask = 0;
            for lane in 0..16 {
                if block.live >> lane & 1 == 1 && lens.frustum.sees(&block.sphere(lane)) {
                    mask |= 1 << lane;
                }
            }
            if mask != 0 {
                visible.push(VisibleBlock { block: b as u32, mask });
            }
        }
        CullReport::default()
    }
}
