//! Culling with the tree.

use super::lanes::{ALL_PLANES, Cull, DISTANCE, OpenTests, SIZE, VALUE, length, size_px};
use super::linear::linear_above;
use super::node::{Limits, reach};
use super::tree::{BlockTree, FAN_OUT};
use super::value::ValueFloor;
use super::{CullOptions, CullReport, VisibleBlock};
use crate::bounds::Aabb;
use crate::scene::Objects;
use crate::view::{Lens, SLACK};

impl BlockTree {
    /// Culls the objects that the tree was last [updated](BlockTree::update) for. `visible` is overwritten, in
    /// ascending order of block; nothing is allocated once its capacity is as large as the number of blocks.
    ///
    /// The answer is that of [`linear`](super::linear), always. It falls back to that where the tree cannot help: when
    /// objects have changed since the update, and for a lens that is not made of numbers: that of a view which
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
        self.cull_above(objects, lens, options, &ValueFloor::NONE, visible)
    }

    /// [`BlockTree::cull`] that passes over what is worth too little, subtree by subtree: the answer of
    /// [`linear_above`].
    ///
    /// Cost: that of [`BlockTree::cull`], less what is passed over, plus a nanosecond per slope. Subtrees are passed
    /// over by the slopes that the tree was [told](BlockTree::expect_slopes) to expect; the farther the floor's are
    /// from those, the fewer.
    pub fn cull_above(
        &self,
        objects: &Objects,
        lens: &Lens,
        options: &CullOptions,
        floor: &ValueFloor<'_>,
        visible: &mut Vec<VisibleBlock>,
    ) -> CullReport {
        if !self.is_fresh(objects) || !is_sound(lens) {
            return linear_above(objects, lens, options, floor, visible);
        }
        let cull = Cull::new(objects, lens, options, floor, visible);
        let open = cull.tests();
        let tables = if open & VALUE == 0 { 0 } else { objects.tables().len() };
        let mut traversal = Traversal { tree: self, ratios: self.worth_ratios(&cull.floor, tables), cull };
        if !objects.blocks().is_empty() {
            traversal.visit(self.height(), 0, open);
        }
        traversal.cull.report
    }
}

/// Whether boxes can be compared with the lens.
fn is_sound(lens: &Lens) -> bool {
    lens.eye.is_finite()
        && lens.frustum.planes.iter().all(|plane| plane.normal.is_finite() && !plane.offset.is_nan())
}

/// What a node's summary says of the objects below it, as far as limits go.
enum Verdict {
    /// All are beyond their draw distance.
    TooFar,
    /// All are too small.
    TooSmall,
    /// All are worth too little.
    WorthTooLittle,
    /// All pass the limits that are not in the mask.
    Open(OpenTests),
}

struct Traversal<'a> {
    tree: &'a BlockTree,
    /// Least and greatest ratio of worth to worth as the tree keeps it.
    ratios: [f64; 2],
    cull: Cull<'a>,
}

impl Traversal<'_> {
    /// Looks at the siblings of group `group` of a level.
    fn visit(&mut self, level: usize, group: usize, open: OpenTests) {
        let boxes = self.tree.boxes(level, group);
        let crossed = boxes.crossed(&self.cull.lens.frustum, open & ALL_PLANES);
        self.cull.report.nodes_visited += self.tree.siblings(level, group) as u64;
        let mut rest = crossed.inside;
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let index = group * FAN_OUT + lane;
            let planes = crossed.planes[lane] as OpenTests;
            match open & !ALL_PLANES {
                0 => self.enter(level, index, planes),
                limits => self.limit(level, index, &boxes.get(lane), limits, planes),
            }
        }
    }

    /// Settles, by a node's summary, the open limits that it can settle, and goes on with the others.
    fn limit(&mut self, level: usize, index: usize, aabb: &Aabb, limits: OpenTests, planes: OpenTests) {
        let node = self.tree.limits(level, index);
        let live = u64::from(node.live);
        match self.judge(node, aabb, limits) {
            Verdict::TooFar => self.cull.report.too_far += live,
            Verdict::TooSmall => self.cull.report.too_small += live,
            Verdict::WorthTooLittle => self.cull.report.worth_too_little += live,
            Verdict::Open(limits) => self.enter(level, index, limits | planes),
        }
    }

    /// Goes on below a node some of which may be visible.
    fn enter(&mut self, level: usize, index: usize, open: OpenTests) {
        match (open, level) {
            (0, _) => self.accept(level, index),
            (_, 0) => self.cull.test(index, self.tree.live()[index], open),
            _ => self.visit(level - 1, index, open),
        }
    }

    /// Yields all live objects below a node.
    fn accept(&mut self, level: usize, index: usize) {
        let live = u64::from(self.tree.limits(level, index).live);
        self.cull.report.objects_accepted += live;
        self.cull.report.visible += live;
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

    fn judge(&self, node: &Limits, aabb: &Aabb, limits: OpenTests) -> Verdict {
        let lens = self.cull.lens;
        let [near, far] = reach(aabb, lens.eye).map(length);
        let mut open = 0;
        if limits & DISTANCE != 0 {
            if near > node.reach[1] {
                return Verdict::TooFar;
            }
            open |= if far <= node.reach[0] { 0 } else { DISTANCE };
        }
        let [nearest, farthest] = [near, far].map(|distance| projection_distance(lens, distance));
        if limits & SIZE != 0 {
            let least = self.cull.min_size_px;
            if size_px(lens, node.size[1], nearest) < least {
                return Verdict::TooSmall;
            }
            open |= if size_px(lens, node.size[0], farthest) >= least { 0 } else { SIZE };
        }
        if limits & VALUE != 0 {
            let floor = &self.cull.floor;
            let [least, most] = [0, 1].map(|i| node.worth[i] * self.ratios[i]);
            if floor.is_above(most, nearest) && (!lens.perspective || is_outside(aabb, lens, near)) {
                return Verdict::WorthTooLittle;
            }
            open |= if floor.is_below(least, farthest) { 0 } else { VALUE };
        }
        Verdict::Open(open)
    }
}

/// Whether the eye, as far from the box as `near`, is in no sphere in it, rounding taken into account.
fn is_outside(aabb: &Aabb, lens: &Lens, near: f32) -> bool {
    let extent = aabb.min.abs().max(aabb.max.abs()).max(lens.eye.abs()).max_element();
    near > extent * (4.0 * SLACK)
}

/// The distance that a size is taken at, from the true one: as [`Lens::distance`].
fn projection_distance(lens: &Lens, distance: f32) -> f32 {
    if lens.perspective { distance.max(lens.near) } else { 1.0 }
}
