//! An implicit tree over the blocks, and keeping it up to date.

use super::boxes::Boxes;
use super::node::{Limits, Node};
use super::order::Arranger;
use super::value::KeptSlopes;
use crate::scene::Objects;

/// Children of a node. 4 to 16 are sensible: fewer make the tree higher, more make its boxes coarser.
pub(super) const FAN_OUT: usize = 8;

/// A store of no more blocks than this is never re-arranged. From 0 up; larger saves the sort of a scene that is
/// tested in a microsecond anyway, and leaves larger scenes unsorted.
const SMALL_BLOCKS: usize = 4;

/// Share of the objects that may be out of order (holes, and objects that came since the last order) before the
/// tree re-arranges them. 0 to 1; smaller keeps boxes tight and slots full, larger sorts less often.
const DISORDER: f64 = 0.1;

/// Growth of the blocks' summed half-area since the last order at which the tree re-arranges. Above 1; smaller keeps
/// boxes tight while objects move, larger sorts less often. A frame's cost grows about as the area does.
const GROWTH: f32 = 2.0;

/// Updates with changes that have to pass after an order before growth alone may ask for another. From 0 up; smaller
/// sorts a scene in full motion more often, larger lets it be culled with worse boxes for longer.
const REST: u32 = 32;

/// Boxes over the blocks of one [`Objects`], as an implicit tree: level 0 has a node per block, every level above
/// one per 8 below, and the last a single root. Kept for as long as the objects are; one per store.
///
/// Memory: about 3.5 bytes per object, and what arranging keeps for the next time: 260 more with the feature `bvh`, 70
/// without it, until [`BlockTree::shrink`].
#[derive(Clone, Default)]
pub struct BlockTree {
    /// Node `i` of a level is over nodes `8 i .. 8 i + 8` of the level before.
    levels: Vec<Siblings>,
    /// Live bits per block: what accepting a subtree copies.
    live: Vec<u16>,
    /// The revision of the objects that the nodes stand for.
    revision: u64,
    /// The root's area after the last order; `None` before the first.
    ordered_area: Option<f32>,
    /// Updates with changes since the last order.
    since_order: u32,
    /// The slopes that the nodes' worth is kept at.
    slopes: KeptSlopes,
    arranger: Arranger,
    stale: Vec<u32>,
}

/// The nodes of a level: their boxes in groups of siblings, and what else is known of them, which is only looked at
/// where a limit is open.
#[derive(Clone, Default)]
struct Siblings {
    boxes: Vec<Boxes>,
    limits: Vec<Limits>,
}

impl Siblings {
    fn node(&self, index: usize) -> Node {
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
    /// Whether the objects were re-arranged; their slots have changed then.
    pub reordered: bool,
}

impl BlockTree {
    /// A tree over nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Brings the tree up to date: renews the boxes of the blocks that changed and of those above them, and, when it
    /// pays, re-arranges the objects so that near ones share a block. The first update of all but tiny stores does.
    ///
    /// Cost: nothing when nothing changed, else one look at every block's revision, 0.1 to 0.5 µs per changed block,
    /// and when re-arranging about 1 µs per object. Nothing is allocated but for blocks that are new, and while
    /// re-arranging.
    pub fn update(&mut self, objects: &mut Objects) -> UpdateReport {
        if self.is_fresh(objects) {
            return UpdateReport::default();
        }
        self.since_order = self.since_order.saturating_add(1);
        let mut report = UpdateReport::default();
        if !self.is_disordered(objects) {
            report.blocks_refitted = self.refit(objects);
        }
        if self.is_disordered(objects) || self.has_grown(objects) {
            self.order(objects);
            report.blocks_refitted += self.refit(objects);
            report.reordered = true;
            self.ordered_area = Some(self.area());
        }
        report
    }

    /// Gives back the memory that re-arranging keeps for the next time.
    pub fn shrink(&mut self) {
        self.arranger = Arranger::default();
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

    pub(super) fn slopes(&self) -> &KeptSlopes {
        &self.slopes
    }

    pub(super) fn live(&self) -> &[u16] {
        &self.live
    }

    fn area(&self) -> f32 {
        self.levels.last().and_then(|top| top.limits.first()).map_or(0.0, |root| root.area)
    }

    fn is_disordered(&self, objects: &Objects) -> bool {
        let limit = DISORDER * objects.len() as f64;
        is_worth_ordering(objects) && (self.ordered_area.is_none() || objects.disorder() as f64 > limit)
    }

    fn has_grown(&self, objects: &Objects) -> bool {
        let rested = self.since_order > REST;
        is_worth_ordering(objects) && rested && self.ordered_area.is_some_and(|a| self.area() > GROWTH * a)
    }

    fn order(&mut self, objects: &mut Objects) {
        objects.reorder(self.arranger.arrange(objects, &self.slopes));
        self.since_order = 0;
    }

    /// Renews the nodes of the blocks that changed, then level by level those above. Returns how many blocks.
    fn refit(&mut self, objects: &Objects) -> usize {
        self.shape(objects.blocks().len());
        self.find_stale(objects);
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

    /// Lists the blocks that changed since the last refit, in ascending order.
    fn find_stale(&mut self, objects: &Objects) {
        self.stale.clear();
        let revisions = objects.block_revisions().iter().enumerate();
        let newer = revisions.filter(|&(_, &revision)| revision > self.revision);
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

fn is_worth_ordering(objects: &Objects) -> bool {
    objects.blocks().len() > SMALL_BLOCKS
}
