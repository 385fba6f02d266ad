//! The cut that a camera asks for, kept up to date.
//!
//! M. Duchaineau et al., "ROAMing terrain: real-time optimally adapting meshes", 1997: of two queues one has what
//! could be split, largest error first, the other what could be contracted, least error first. What is too much is
//! contracted, what is wrong is split while there is room, and room is made as long as that takes less than it gives.

mod front;
mod heap;
mod sight;

use std::sync::Arc;

use front::Front;
use heap::Heap;
use sight::{Motion, Sight};

use super::Hierarchy;
use crate::view::{Lens, View};

/// How many operations an update tries to make room for in vain.
const TRIES: usize = 8;

/// What a cut may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The most triangles. Below [`Hierarchy::base_triangles`] the base is shown all the same.
    pub triangles: usize,
    /// What is off by less on the screen, in px, is not split, and contracted where it is less by the hysteresis as well;
    /// 0 to use all triangles.
    pub enough_px: f32,
    /// The most splits and contractions in one update, those apart that the number of triangles asks for. Fewer spread
    /// the work of a sudden turn over several frames.
    pub changes: usize,
    /// By how much the error of a split has to be above that of the contraction that makes room for it, as a share, ≥ 0.
    /// Less follows the camera closer, more is steadier; below a quarter, what is known of errors is too vague to be
    /// steady while the camera moves.
    pub hysteresis: f32,
}

impl Budget {
    /// So many triangles, all of them used; as many changes as it takes; a hysteresis of a quarter.
    pub const fn triangles(triangles: usize) -> Self {
        Self { triangles, enough_px: 0.0, changes: usize::MAX, hysteresis: 0.25 }
    }
}

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Operations undone.
    pub splits: usize,
    /// Those among them that stood in the way of another.
    pub forced: usize,
    /// Operations done.
    pub merges: usize,
    /// Operations whose error on the screen was worked out.
    pub evaluated: usize,
    /// Triangles now.
    pub triangles: usize,
    /// What is off farthest in view is off by at most this, in px of the first view, 0 without a view: by its distance
    /// as [`Lens::unit_px`] has it. Towards the corners of a wide window the projection stretches that further.
    pub max_error_px: f32,
    /// Whether nothing more would change if the camera stood still.
    pub is_settled: bool,
    /// Views that were left out because they cannot be used.
    pub broken_views: usize,
}

/// A cut through a [`Hierarchy`]: what is shown of it, and what is known for the next frame. It takes some 26 bytes per
/// vertex of the mesh and 100 per triangle shown; there can be several of one hierarchy.
///
/// Triangles are in slots without holes, so that slots are an index buffer over [`Hierarchy::positions`]; an update
/// tells which slots have changed.
#[derive(Clone, Debug)]
pub struct Cut {
    hierarchy: Arc<Hierarchy>,
    front: Front,
    sight: Sight,
    /// Operations whose node is active, largest error first.
    splits: Heap,
    /// Operations that could be done, least error first. Some may have become impossible since.
    merges: Heap,
    /// All of both, by when to look at them again.
    by_travel: Heap,
    by_turn: Heap,
    /// The budget that the cut is settled for, as long as views stay.
    settled: Option<Budget>,
    report: Report,
    /// Operations that wait for those above them, those that were split for one or gave room, and per operation whether it is
    /// either: what a cascade needs must not make room for it.
    waiting: Vec<u32>,
    done: Vec<u32>,
    is_held: Vec<bool>,
    /// What there was no room for, as long as nothing has changed since.
    refused: Vec<u32>,
    around: Vec<u32>,
}

impl Cut {
    /// The coarsest cut; O(n).
    pub fn new(hierarchy: Arc<Hierarchy>) -> Self {
        let operations = hierarchy.parts().operations.len();
        let heap = || Heap::new(operations);
        let mut cut = Self {
            front: Front::coarsest(&hierarchy),
            sight: Sight::default(),
            splits: heap(),
            merges: heap(),
            by_travel: heap(),
            by_turn: heap(),
            settled: None,
            report: Report::default(),
            waiting: Vec::new(),
            done: Vec::new(),
            is_held: vec![false; operations],
            refused: Vec::new(),
            around: Vec::new(),
            hierarchy,
        };
        let is_root = |o: &u32| cut.front.is_active(cut.hierarchy.node(*o));
        let roots: Vec<u32> = (0..operations as u32).filter(is_root).collect();
        roots.into_iter().for_each(|operation| cut.await_split(operation));
        cut
    }

    /// What it is a cut of.
    pub fn hierarchy(&self) -> &Arc<Hierarchy> {
        &self.hierarchy
    }

    /// The triangles, as nodes of the hierarchy, counter-clockwise: an index buffer over [`Hierarchy::positions`].
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.front.slots()
    }

    /// Per triangle, which of [`Parts::triangles`](super::Parts::triangles) it has become of: its material is that one's.
    pub fn origins(&self) -> &[u32] {
        self.front.triangles()
    }

    /// The slots whose triangles are not what they were before the last update, ascending. Slots beyond the number of
    /// triangles are gone without being told.
    pub fn changed(&self) -> &[u32] {
        self.front.changed()
    }

    /// What the last update did.
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// Whether a node is a corner of the cut.
    pub fn is_active(&self, node: u32) -> bool {
        self.front.is_active(node)
    }

    /// The largest error of an operation that is done and the least of one that could be: what the next split is worth
    /// and what the next contraction takes, in px of the first view.
    pub fn brink_px(&mut self) -> (Option<f32>, Option<f32>) {
        let scale = self.sight.first().map_or(0.0, |lens| lens.scale_px);
        let split = self.worst().map(|(px, _)| px * scale);
        (split, self.mildest().map(|(px, _)| px * scale))
    }

    /// Brings the cut up to date. Views are in the coordinates of the hierarchy; where there are several, what counts is
    /// the one in which an error is largest. Takes some microseconds per change and per operation that is looked at
    /// again: nothing at all when neither views nor budget have changed since the cut settled.
    ///
    /// A view that cannot be used is left out and counted. Without any, the cut stays, but for what is too much.
    pub fn update(&mut self, views: &[View], budget: &Budget) -> Report {
        let usable = || views.iter().filter(|view| view.check().is_ok());
        self.front.forget_changes();
        self.report = Report { broken_views: views.len() - usable().count(), ..Report::default() };
        let motion = self.sight.renew(usable());
        if motion != Motion::Still || self.settled != Some(*budget) {
            self.look_again(motion);
            self.shrink(budget);
            let is_settled = self.sight.is_empty() || self.exchange(budget) && self.relax(budget);
            self.settled = is_settled.then_some(*budget);
            self.front.sort_changes();
        }
        self.report.triangles = self.triangles().len();
        self.report.max_error_px = self.brink_px().0.unwrap_or(0.0);
        self.report.is_settled = self.settled.is_some();
        self.report
    }

    pub(super) fn lens(&self) -> Option<&Lens> {
        self.sight.first()
    }

    /// Contracts what is least worth its triangles while there are too many.
    fn shrink(&mut self, budget: &Budget) {
        while self.triangles().len() > budget.triangles {
            let Some((_, operation)) = self.mildest() else { break };
            self.merge(operation);
        }
    }

    /// Splits what is worst, and contracts what is mildest to make room for it. Where there is none, what is next worst
    /// may need less. Returns whether it came to its end.
    fn exchange(&mut self, budget: &Budget) -> bool {
        let enough = self.enough(budget);
        let mut aside = Vec::new();
        let mut is_done = true;
        while let Some((error, worst)) = self.worst().filter(|&(error, _)| error > enough) {
            is_done = self.report.splits + self.report.merges < budget.changes;
            if !is_done || aside.len() == TRIES {
                break;
            }
            if !self.split_all(worst, error / (1.0 + budget.hysteresis), budget) {
                aside.extend(self.splits.remove(worst).map(|key| (key, worst)));
                if self.triangles().len() >= budget.triangles {
                    break;
                }
            }
        }
        self.put_back(&aside);
        is_done
    }

    /// What was refused is still to be split, unless that or the contrary has come about.
    fn put_back(&mut self, aside: &[(u64, u32)]) {
        for &(key, operation) in aside {
            if self.front.is_active(self.hierarchy.node(operation)) && self.splits.key(operation).is_none() {
                self.splits.set(operation, key);
            }
        }
    }

    /// Contracts what is more than good enough. Returns whether it came to its end.
    fn relax(&mut self, budget: &Budget) -> bool {
        let enough = self.enough(budget);
        while let Some((least, operation)) = self.mildest() {
            if least * (1.0 + budget.hysteresis) >= enough {
                break;
            }
            if self.report.splits + self.report.merges >= budget.changes {
                return false;
            }
            self.merge(operation);
        }
        true
    }

    /// The priority below which nothing needs to be split.
    fn enough(&self, budget: &Budget) -> f32 {
        self.sight.first().map_or(f32::INFINITY, |lens| budget.enough_px / lens.scale_px)
    }

    /// The operation that is most in need of a split.
    fn worst(&self) -> Option<(f32, u32)> {
        self.splits.first().map(|(key, operation)| (f32::from_bits(!key as u32), operation))
    }

    /// The operation that is done at the least error.
    fn mildest(&mut self) -> Option<(f32, u32)> {
        while let Some((key, operation)) = self.merges.first() {
            if self.front.may_merge(&self.hierarchy, operation) {
                return Some((f32::from_bits(key as u32), operation));
            }
            self.drop(operation);
        }
        None
    }

    /// Splits an operation after all that stand in its way, and makes room for them where it costs less than `mild`.
    /// Takes back the splits when that is not enough.
    fn split_all(&mut self, operation: u32, mild: f32, budget: &Budget) -> bool {
        if self.refused.contains(&operation) && self.milder_than(mild).is_none() {
            return false;
        }
        let before = self.report;
        let refused = std::mem::take(&mut self.refused);
        self.hold(operation);
        while let Some(&next) = self.waiting.last() {
            let blocker = self.front.blocker(&self.hierarchy, next);
            if let Some(blocker) = blocker.and_then(|node| self.hierarchy.maker(node)) {
                self.hold(blocker);
            } else if self.triangles().len() + self.hierarchy.going(next).len() <= budget.triangles {
                self.split(next);
                self.waiting.pop();
                self.done.push(next);
            } else if let Some(other) = self.milder_than(mild) {
                self.merge(other);
                self.done.push(other);
            } else {
                self.give_up(before);
                self.refused = refused;
                self.refused.push(operation);
                return false;
            }
        }
        self.report.forced += self.report.splits - before.splits - 1;
        self.release();
        // All others are below it, and can only be done after it.
        self.await_merge(operation);
        true
    }

    /// The operation that could be done at the least error, if that is less.
    fn milder_than(&mut self, error: f32) -> Option<u32> {
        self.mildest().filter(|&(least, _)| least < error).map(|(_, operation)| operation)
    }

    /// Has an operation wait to be split; what would contract its node must not come before.
    fn hold(&mut self, operation: u32) {
        self.waiting.push(operation);
        self.is_held[operation as usize] = true;
        if let Some(parent) = self.hierarchy.parent(self.hierarchy.node(operation)) {
            self.drop(parent);
        }
    }

    fn release(&mut self) {
        for operation in self.waiting.drain(..).chain(self.done.drain(..)) {
            self.is_held[operation as usize] = false;
        }
    }

    /// Undoes what was done in vain, last things first.
    fn give_up(&mut self, before: Report) {
        let (mut done, waiting) = (std::mem::take(&mut self.done), std::mem::take(&mut self.waiting));
        done.iter().chain(&waiting).for_each(|&operation| self.is_held[operation as usize] = false);
        while let Some(operation) = done.pop() {
            let node = self.hierarchy.node(operation);
            if self.front.is_active(node) {
                self.hierarchy.parent(node).into_iter().for_each(|parent| self.drop(parent));
                self.split(operation);
                self.await_merge(operation);
            } else {
                self.merge(operation);
            }
        }
        waiting.iter().for_each(|&operation| self.await_merges_around(self.hierarchy.node(operation)));
        self.report = Report { evaluated: self.report.evaluated, ..before };
        (self.done, self.waiting) = (done, waiting);
        self.waiting.clear();
    }

    /// Splits an operation that is held and has no blocker.
    fn split(&mut self, operation: u32) {
        self.front.split(&self.hierarchy, operation);
        self.refused.clear();
        self.report.splits += 1;
        self.drop(operation);
        for end in self.hierarchy.operation(operation).ends {
            if let Some(maker) = self.hierarchy.maker(end) {
                self.await_split(maker);
            }
        }
    }

    fn merge(&mut self, operation: u32) {
        self.front.merge(&self.hierarchy, operation);
        self.refused.clear();
        self.report.merges += 1;
        for end in self.hierarchy.operation(operation).ends {
            self.hierarchy.maker(end).into_iter().for_each(|maker| self.drop(maker));
        }
        match self.merges.remove(operation) {
            Some(key) => self.splits.set(operation, !key & u64::from(u32::MAX)),
            None => self.await_split(operation),
        }
        self.await_merges_around(self.hierarchy.node(operation));
    }

    /// What became possible because a node came to be.
    fn await_merges_around(&mut self, node: u32) {
        let mut around = std::mem::take(&mut self.around);
        around.push(node);
        around.extend(self.front.neighbours(node));
        // Those whose triangles went may be no neighbours any more.
        let maker = self.hierarchy.maker(node);
        around.extend(maker.into_iter().flat_map(|maker| self.hierarchy.apexes(maker)));
        around.sort_unstable();
        around.dedup();
        for node in around.drain(..) {
            let parent = if self.is_to_be_split(node) { None } else { self.hierarchy.parent(node) };
            if let Some(parent) = parent {
                let is_known = self.is_held[parent as usize] || self.merges.key(parent).is_some();
                if !is_known && self.front.may_merge(&self.hierarchy, parent) {
                    self.await_merge(parent);
                }
            }
        }
        self.around = around;
    }

    fn is_to_be_split(&self, node: u32) -> bool {
        self.hierarchy.maker(node).is_some_and(|maker| self.is_held[maker as usize])
    }

    fn await_merge(&mut self, operation: u32) {
        let priority = self.look_at(operation);
        self.merges.set(operation, u64::from(priority.to_bits()));
    }

    fn await_split(&mut self, operation: u32) {
        let priority = self.look_at(operation);
        self.splits.set(operation, u64::from(!priority.to_bits()));
    }

    /// What an operation is worth now; puts it on the agenda.
    fn look_at(&mut self, operation: u32) -> f32 {
        let look = self.sight.look(self.hierarchy.operation(operation));
        self.report.evaluated += 1;
        self.by_travel.set(operation, look.until_travel.to_bits());
        self.by_turn.set(operation, look.until_turn.to_bits());
        look.priority
    }

    /// An operation can neither be split nor done.
    fn drop(&mut self, operation: u32) {
        for heap in [&mut self.splits, &mut self.merges, &mut self.by_travel, &mut self.by_turn] {
            heap.remove(operation);
        }
    }

    /// Looks at all that the camera's motion may have changed.
    fn look_again(&mut self, motion: Motion) {
        if motion == Motion::Cut {
            let mut all: Vec<u32> = self.by_travel.operations().collect();
            all.sort_unstable();
            all.into_iter().for_each(|operation| self.renew(operation));
        }
        while let Some(operation) = self.overdue() {
            self.renew(operation);
        }
    }

    /// An operation whose error may be larger by now than is known.
    fn overdue(&self) -> Option<u32> {
        let due = |heap: &Heap, now: f64| {
            heap.first().filter(|&(key, _)| key < now.to_bits()).map(|(_, operation)| operation)
        };
        due(&self.by_travel, self.sight.travel).or_else(|| due(&self.by_turn, self.sight.turn))
    }

    fn renew(&mut self, operation: u32) {
        let bits = self.look_at(operation).to_bits();
        if self.splits.key(operation).is_some() {
            self.splits.set(operation, u64::from(!bits));
        } else {
            self.merges.set(operation, u64::from(bits));
        }
    }
}
