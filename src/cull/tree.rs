//! An implicit tree over the blocks, and keeping it up to date.

use std::ops::Range;

use super::boxes::Boxes;
#[cfg(feature = "bvh")]
use super::bvh::Hierarchy as Global;
#[cfg(not(feature = "bvh"))]
use super::morton::Curve as Global;
use super::node::{Limits, Node};
use super::order::Arranger;
use super::repair::Repairs;
use super::value::{Floor, KeptSlopes};
use crate::scene::{BLOCK, Objects};

/// Children of a node. 4 to 16 are sensible: fewer make the tree higher, more make its boxes coarser.
pub(super) const FAN_OUT: usize = 8;

/// A store of no more blocks than this is never re-arranged. From 0 up; larger saves the sort of a scene that is
/// tested in a microsecond anyway, and leaves larger scenes unsorted.
const SMALL_BLOCKS: usize = 4;

/// By how much a store has to grow after an order, or how many times its objects its slots have to be, before it is
/// ordered anew as a whole. Above 1; smaller orders more often, larger leaves more of the objects to repairs.
const OUTGROWN: usize = 2;

/// Blocks whose worth is brought to newly expected slopes in an update: about 0.2 ms of work.
const REPRICED_BLOCKS: usize = 1024;

/// By how much two slopes may come to differ from how they compared when the nodes' worth was made, before it is made
/// anew. Above 1; smaller renews more often, larger passes over less.
const DRIFT: f64 = 1.5;

/// Boxes over the blocks of one [`Objects`], as an implicit tree: level 0 has a node per block, every level above
/// one per 8 below, and the last a single root. Kept for as long as the objects are; one per store.
///
/// Memory: about 4.5 bytes per object; 260 more, or 70 without the feature `bvh`, while all objects are ordered.
#[derive(Clone, Default)]
pub struct BlockTree {
    /// Node `i` of a level is over nodes `8 i .. 8 i + 8` of the level before.
    levels: Vec<Siblings>,
    /// Live bits per block: what accepting a subtree copies.
    live: Vec<u16>,
    /// The revision of the objects that the nodes stand for.
    revision: u64,
    /// How many objects were last ordered; `None` before the first time.
    ordered: Option<usize>,
    /// The slopes that the nodes' worth is kept at, but for nodes from block `repriced` on.
    slopes: KeptSlopes,
    /// The slopes of those.
    former: KeptSlopes,
    repriced: usize,
    pub(super) repairs: Repairs,
    stale: Vec<u32>,
}

/// The nodes of a level: their boxes in groups of siblings, and what else is known of them, which is only looked at
/// where a limit is open.
#[derive(Clone, Default)]
pub(super) struct Siblings {
    boxes: Vec<Boxes>,
    pub limits: Vec<Limits>,
}

impl Siblings {
    pub fn node(&self, index: usize) -> Node {
        Node { aabb: self.boxes[index / FAN_OUT].get(index % FAN_OUT), limits: self.limits[index] }
    }

    fn set(&mut self, index: usize, node: &Node) {
        self.boxes[index / FAN_OUT].set(index % FAN_OUT, &node.aabb);
        self.limits[index] = node.limits;
    }

    /// The node over group `group`.
    fn over(&self, group: usize) -> Node {
        let nodes = group * FAN_OUT..((group + 1) * FAN_OUT).min(self.limits.len());
        nodes.fold(Node::EMPTY, |node, index| node.union(&self.node(index)))
    }

    /// Makes room for so many nodes; new ones are empty.
    fn resize(&mut self, len: usize) {
        for index in len..self.limits.len() {
            self.set(index, &Node::EMPTY);
        }
        self.limits.resize(len, Node::EMPTY.limits);
        self.boxes.resize(len.div_ceil(FAN_OUT), Boxes::EMPTY);
    }
}

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UpdateReport {
    /// Blocks whose boxes were renewed.
    pub blocks_refitted: usize,
    /// Objects that were laid into other slots, [repairing](BlockTree::update) the order.
    pub objects_repaired: usize,
    /// Whether all objects were re-arranged.
    pub reordered: bool,
}

impl BlockTree {
    /// A tree over nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Brings the tree up to date: renews the boxes of the blocks that changed and of those above them, and keeps the
    /// objects arranged so that near ones share a block.
    ///
    /// The first update of all but tiny stores arranges all objects, and so does one of a store that has doubled since
    /// or has become half empty: about 1 µs per object, as [`BlockTree::rearrange`]. All others repair the order where
    /// it has suffered most, a thousand objects or two at a time: about a millisecond, and more only where so many
    /// blocks changed that renewing their boxes takes four times as long.
    ///
    /// Cost otherwise: nothing when nothing changed, else one look at every block's revision, and 0.1 to 0.2 µs per
    /// changed block. Nothing is allocated but for blocks that are new, and while arranging all.
    pub fn update(&mut self, objects: &mut Objects) -> UpdateReport {
        if self.is_outgrown(objects) {
            return self.rearrange(objects);
        }
        if self.is_fresh(objects) && !self.is_repricing() && !self.repairs.is_pending {
            return UpdateReport::default();
        }
        let mut report = UpdateReport { blocks_refitted: self.refit(objects), ..UpdateReport::default() };
        if self.ordered.is_some() {
            report.objects_repaired = self.repair(objects, report.blocks_refitted);
        }
        if report.objects_repaired > 0 {
            report.blocks_refitted += self.refit(objects);
            self.settle_repairs();
        }
        report
    }

    /// Arranges all objects anew, whatever their state, and brings the tree up to date: for after loading.
    ///
    /// Cost: about 1 µs per object.
    pub fn rearrange(&mut self, objects: &mut Objects) -> UpdateReport {
        let slots = 0..objects.blocks().len() * BLOCK;
        objects.reorder(Arranger::<Global>::default().arrange(objects, slots, &self.slopes));
        self.ordered = Some(objects.len());
        let blocks_refitted = self.refit(objects);
        self.settle_all();
        UpdateReport { blocks_refitted, objects_repaired: 0, reordered: true }
    }

    /// Tells the tree which slopes floors will have: [`ValueFloor::best_slope`](super::ValueFloor). Their common scale
    /// is of no matter, only how they compare; a tree that is told nothing assumes that all tables are alike. No answer
    /// depends on it, only how much is passed over untested. To be called whenever slopes change.
    ///
    /// Cost: a nanosecond per table. Where two have come to compare differently by half, the next updates renew what is
    /// kept, some 0.2 ms each; until then culling keeps to bounds that hold for the old slopes and the new.
    pub fn expect_slopes(&mut self, best_slope: &[f32]) {
        if self.is_repricing() || self.slopes.are_alike(best_slope, DRIFT) {
            return;
        }
        std::mem::swap(&mut self.slopes, &mut self.former);
        self.slopes.keep(best_slope);
        self.repriced = 0;
    }

    /// Whether the tree stands for the objects as they are.
    pub(super) fn is_fresh(&self, objects: &Objects) -> bool {
        self.revision == objects.revision() && self.live.len() == objects.blocks().len()
    }

    /// The level of the root.
    pub(super) fn height(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    pub(super) fn boxes(&self, level: usize, group: usize) -> &Boxes {
        &self.levels[level].boxes[group]
    }

    pub(super) fn limits(&self, level: usize, index: usize) -> &Limits {
        &self.levels[level].limits[index]
    }

    /// How many nodes there are in a group.
    pub(super) fn siblings(&self, level: usize, group: usize) -> usize {
        FAN_OUT.min(self.levels[level].limits.len() - group * FAN_OUT)
    }

    /// Least and greatest ratio of worth at the slopes of a floor to worth as it is kept.
    pub(super) fn worth_ratios(&self, floor: &Floor<'_>, tables: usize) -> [f64; 2] {
        let now = floor.ratios(&self.slopes, tables);
        if !self.is_repricing() {
            return now;
        }
        let former = floor.ratios(&self.former, tables);
        [now[0].min(former[0]), now[1].max(former[1])]
    }

    /// The nodes of a level, which repairs work on.
    pub(super) fn level(&self, level: usize) -> &Siblings {
        &self.levels[level]
    }

    pub(super) fn kept_slopes(&self) -> &KeptSlopes {
        &self.slopes
    }

    fn is_repricing(&self) -> bool {
        self.repriced < self.live.len()
    }

    pub(super) fn live(&self) -> &[u16] {
        &self.live
    }

    fn is_outgrown(&self, objects: &Objects) -> bool {
        let slots = objects.blocks().len() * BLOCK;
        let is_sparse = slots > OUTGROWN * objects.len() + SMALL_BLOCKS * BLOCK;
        let has_grown = self.ordered.is_none_or(|ordered| objects.len() > OUTGROWN * ordered);
        objects.blocks().len() > SMALL_BLOCKS && (is_sparse || has_grown)
    }

    /// Renews the nodes of the blocks that changed, then level by level those above. Returns how many blocks.
    fn refit(&mut self, objects: &Objects) -> usize {
        let repricing = self.is_repricing();
        let until = if repricing { self.repriced + REPRICED_BLOCKS } else { usize::MAX };
        self.shape(objects.blocks().len());
        self.find_stale(objects, self.repriced..until);
        self.repriced = until;
        let refitted = self.stale.len();
        for &index in &self.stale {
            let node = Node::of_block(objects, index as usize, &self.slopes);
            self.levels[0].set(index as usize, &node);
            self.live[index as usize] = objects.blocks()[index as usize].live;
        }
        for level in 1..self.levels.len() {
            self.stale.iter_mut().for_each(|index| *index /= FAN_OUT as u32);
            self.stale.dedup();
            self.refit_level(level);
        }
        self.revision = objects.revision();
        refitted
    }

    /// Lists the blocks that changed since the last refit, and those of `also`, in ascending order.
    fn find_stale(&mut self, objects: &Objects, also: Range<usize>) {
        self.stale.clear();
        let revisions = objects.block_revisions().iter().enumerate();
        let newer = revisions.filter(|&(at, &revision)| revision > self.revision || also.contains(&at));
        self.stale.extend(newer.map(|(index, _)| index as u32));
    }

    fn refit_level(&mut self, level: usize) {
        let (below, above) = self.levels.split_at_mut(level);
        for &index in &self.stale {
            above[0].set(index as usize, &below[level - 1].over(index as usize));
        }
    }

    /// Makes room for so many blocks. A node that is new has a new block below it, so that the refit will reach it.
    fn shape(&mut self, blocks: usize) {
        self.live.resize(blocks, 0);
        let (mut level, mut len) = (0, blocks);
        loop {
            if level == self.levels.len() {
                self.levels.push(Siblings::default());
            }
            self.levels[level].resize(len);
            level += 1;
            if len <= 1 {
                break;
            }
            len = len.div_ceil(FAN_OUT);
        }
        self.levels.truncate(level);
    }
}
