//! Culling with the tree.

use super::lanes::{ALL_PLANES, Cull, DISTANCE, OpenTests, SIZE, length, size_px};
use super::linear::linear;
use super::node::Node;
use super::tree::{BlockTree, FAN_OUT};
use super::{CullOptions, CullReport, VisibleBlock};
use crate::scene::Objects;
use crate::view::{Frustum, Lens};

impl BlockTree {
    /// Culls the objects that the tree was last [updated](BlockTree::update) for. `visible` is overwritten, in
    /// ascending order of block; nothing is allocated once its capacity is as large as the number of blocks.
    ///
    /// The answer is that of [`linear`], always. It falls back to that where the tree cannot help: when objects have
    /// changed since the update, and for a lens that is not made of numbers: that of a view which
    /// [`View::check`](crate::view::View::check) refuses, or of an eye too far from the objects' origin for an `f32`.
    ///
    /// Cost: linear in the boxes and objects at the border of the view, plus a few bytes per visible block.
    pub fn cull(
        &self,
        objects: &Objects,
        lens: &Lens,
        options: &CullOptions,
        visible: &mut Vec<VisibleBlock>,
    ) -> CullReport {
        if !self.is_fresh(objects) || !is_sound(lens) {
            return linear(objects, lens, options, visible);
        }
        let mut traversal = Traversal { tree: self, cull: Cull::new(objects, lens, options, visible) };
        if !objects.blocks().is_empty() {
            traversal.visit(self.height(), 0, traversal.cull.tests());
        }
        traversal.cull.report
    }
}

/// Whether boxes can be compared with the lens.
fn is_sound(lens: &Lens) -> bool {
    lens.eye.is_finite()
        && lens.frustum.planes.iter().all(|plane| plane.normal.is_finite() && !plane.offset.is_nan())
}

/// What a node's summary says of the objects below it.
enum Verdict {
    /// None is in view.
    Outside,
    /// All are beyond their draw distance.
    TooFar,
    /// All are too small.
    TooSmall,
    /// All pass the tests that are not in the mask.
    Open(OpenTests),
}

struct Traversal<'a> {
    tree: &'a BlockTree,
    cull: Cull<'a>,
}

impl Traversal<'_> {
    fn visit(&mut self, level: usize, index: usize, open: OpenTests) {
        let node = self.tree.node(level, index);
        self.cull.report.nodes_visited += 1;
        match judge(node, self.cull.lens, self.cull.min_size_px, open) {
            Verdict::Outside => {}
            Verdict::TooFar => self.cull.report.too_far += u64::from(node.live),
            Verdict::TooSmall => self.cull.report.too_small += u64::from(node.live),
            Verdict::Open(0) => self.accept(level, index, node.live),
            Verdict::Open(open) if level == 0 => self.cull.test(index, open),
            Verdict::Open(open) => {
                for child in self.tree.children(level, index) {
                    self.visit(level - 1, child, open);
                }
            }
        }
    }

    /// Yields all live objects below a node.
    fn accept(&mut self, level: usize, index: usize, live: u32) {
        self.cull.report.objects_accepted += u64::from(live);
        self.cull.report.visible += u64::from(live);
        let width = FAN_OUT.pow(level as u32);
        let mut first = index * width;
        let masks = &self.tree.live()[first..];
        let masks = &masks[..width.min(masks.len())];
        for run in masks.split(|&mask| mask == 0) {
            let blocks = first as u32..(first + run.len()) as u32;
            let run_blocks = blocks.zip(run).map(|(block, &mask)| VisibleBlock { block, mask });
            self.cull.visible.extend(run_blocks);
            first += run.len() + 1;
        }
    }
}

/// Settles, by the node's summary, the open tests that it can settle.
fn judge(node: &Node, lens: &Lens, min_size_px: f32, open: OpenTests) -> Verdict {
    if node.live == 0 {
        return Verdict::Outside;
    }
    let Some(planes) = open_planes(node, &lens.frustum, open) else {
        return Verdict::Outside;
    };
    let limits = open & (SIZE | DISTANCE);
    if limits == 0 {
        return Verdict::Open(planes);
    }
    judge_limits(node, lens, min_size_px, limits, planes)
}

fn open_planes(node: &Node, frustum: &Frustum, open: OpenTests) -> Option<OpenTests> {
    let planes = open & ALL_PLANES;
    if planes == 0 || !node.is_tame() { Some(planes) } else { frustum.crossed(&node.aabb, planes) }
}

fn judge_limits(
    node: &Node,
    lens: &Lens,
    min_size_px: f32,
    limits: OpenTests,
    mut open: OpenTests,
) -> Verdict {
    let [near, far] = node.reach(lens.eye).map(length);
    if limits & DISTANCE != 0 {
        if near > node.longest {
            return Verdict::TooFar;
        }
        open |= if far <= node.shortest { 0 } else { DISTANCE };
    }
    if limits & SIZE != 0 {
        if size_px(lens, node.largest, projection_distance(lens, near)) < min_size_px {
            return Verdict::TooSmall;
        }
        let all_large = size_px(lens, node.smallest, projection_distance(lens, far)) >= min_size_px;
        open |= if all_large { 0 } else { SIZE };
    }
    Verdict::Open(open)
}

/// The distance that a size is taken at, from the true one: as [`Lens::distance`].
fn projection_distance(lens: &Lens, distance: f32) -> f32 {
    if lens.perspective { distance.max(lens.near) } else { 1.0 }
}
