//! Culling.

/// Objects of one block that are in view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleBlock {
    /// Position of the block.
    pub block: u32,
    /// Bit per lane; never 0.
    pub mask: u16,
}
