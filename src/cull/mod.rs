//! Which objects a view sees: the first stage of a frame.
//!
//! An object is *visible* when it is live (not hidden, its bound finite), its sphere passes
//! [`Frustum::sees`](crate::view::Frustum::sees), it is no farther from the eye than its draw distance, and, where
//! [`CullOptions::min_size_px`] asks for it, large enough on the screen. A [`ValueFloor`] passes over what the
//! selection would leave out anyway. Two ways to the same answer, bit for bit:
//!
//! - [`linear`] tests every object. It needs nothing kept and is the oracle of the tests.
//! - [`BlockTree`] keeps boxes over the blocks and passes over what is wholly in or out of view. It has to be
//!   [updated](BlockTree::update) when objects change, and it re-arranges their slots.
//!
//! Take [`linear`] for a few hundred objects, for a store that is culled only a few times (the first update costs as
//! much as 70 to 150 scans), or where more than one object in fifty moves in every frame and a single view asks. Take
//! the tree otherwise. Scan ÷ tree in time, for a city seen from its corner (`cargo bench --bench cull`; one machine,
//! so take the trend from it):
//!
//! | objects | 2 % in view | 20 % | all |
//! |---|---|---|---|
//! | 1 000 | 3 | 1.7 | 2 |
//! | 10 000 | 13 | 4 | 7 |
//! | 100 000 | 45 | 11 | 13 |
//! | 1 000 000 | 220 | 54 | 48 |
//!
//! The ratios are those of an earlier tree; today's takes about half its time. At a million objects and with cold
//! caches it takes a twelfth (2 % in view) to a third (20 %) of the time of reading 16 bytes per object, and a box
//! query on obvhs' own hierarchy takes 80 times as long or longer. With the feature `bvh` the objects are arranged by a
//! hierarchy that obvhs builds; without it along a Morton curve, which takes about half as long to arrange and tests up
//! to a fifth more blocks.
//!
//! Objects that may be left out for their worth are arranged by classes of it, and by place within a class: a floor
//! that leaves 90 000 of a million objects then tests 30 000 one by one. Culling them by view alone takes twice as
//! long, so that all other objects are arranged by place alone.
//!
//! Where objects move, the order is repaired a thousand objects or two at a time. With a million objects of which one
//! in a hundred moves, an update takes 4 ms, of which repairs are half a millisecond; with all of them in motion 6 to
//! 11 ms, and telling the store their new places takes 300.
//!
//! The idea of culling whole groups by their bounds is J. Clark's ("Hierarchical geometric models for visible
//! surface algorithms", 1976); that a plane which a box is wholly inside of need not be tried again below is from
//! U. Assarsson and T. Möller ("Optimized view frustum culling algorithms for bounding boxes", 2000). Here the size
//! and the draw distance are tests like the planes, settled in the same mask.

mod boxes;
mod lanes;
mod linear;
mod morton;
mod node;
mod order;
mod repair;
mod traverse;
mod tree;
mod value;

#[cfg(feature = "bvh")]
mod bvh;

use std::ops::AddAssign;

pub use linear::{linear, linear_above};
pub use tree::{BlockTree, UpdateReport};
pub use value::ValueFloor;

/// The visible objects of one block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VisibleBlock {
    /// Index into [`Objects::blocks`](crate::scene::Objects::blocks).
    pub block: u32,
    /// Bit per lane, at least one of them set.
    pub mask: u16,
}

/// What is left out besides the objects out of view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CullOptions {
    /// Contribution cull: an object is left out when a sphere of its radius times its bias has a projected diameter
    /// below this. Only a number above 0 has an effect.
    pub min_size_px: f32,
}

/// What culling did, in plain counts; reports of several views add up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CullReport {
    /// Boxes of the tree that were looked at.
    pub nodes_visited: u64,
    /// Blocks whose objects were tested one by one.
    pub blocks_tested: u64,
    /// Live objects that were tested one by one.
    pub objects_tested: u64,
    /// Live objects that were taken with all of their subtree, untested.
    pub objects_accepted: u64,
    /// Objects that are visible.
    pub visible: u64,
    /// Objects left out for their size. [`linear`] counts those in view alone; the tree also those of a subtree
    /// that it left out for its size, in view or not.
    pub too_small: u64,
    /// Objects left out for their draw distance, counted like `too_small`; an object that is both counts here.
    pub too_far: u64,
    /// Objects passed over because drawing them is worth less than the floor, counted like `too_small`; an object that
    /// is too far or too small counts there.
    pub worth_too_little: u64,
}

impl AddAssign for CullReport {
    fn add_assign(&mut self, other: Self) {
        self.nodes_visited += other.nodes_visited;
        self.blocks_tested += other.blocks_tested;
        self.objects_tested += other.objects_tested;
        self.objects_accepted += other.objects_accepted;
        self.visible += other.visible;
        self.too_small += other.too_small;
        self.too_far += other.too_far;
        self.worth_too_little += other.worth_too_little;
    }
}
