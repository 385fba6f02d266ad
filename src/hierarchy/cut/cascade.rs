//! A split with all that stands in its way, and the room for it.
//!
//! A vertex can be split when it is younger than all its neighbours, now and before triangles went; those that are
//! younger have to be split before (J. El-Sana, A. Varshney, "Generalized view-dependent simplification", 1999). Room is made while the cascade runs;
//! where that is not enough, all of it is undone.

use super::look::Way;
use super::{Budget, Cut, Report};

/// What is on its way, empty between cascades.
#[derive(Clone, Debug, Default)]
pub(super) struct Cascade {
    /// Operations that wait for those above them, those that were split for one or gave room, and per operation whether it
    /// is either: what a cascade needs must not make room for it.
    waiting: Vec<u32>,
    done: Vec<u32>,
    is_held: Vec<bool>,
    /// What there was no room for, as long as nothing has changed since.
    refused: Vec<u32>,
    above: Vec<u32>,
}

impl Cascade {
    pub(super) fn new(operations: usize) -> Self {
        Self { is_held: vec![false; operations], ..Self::default() }
    }
}

impl Cut {
    /// Splits an operation after all that stand in its way, and makes room for them where it costs less than `mild`.
    /// Takes back the splits when that is not enough.
    pub(super) fn split_all(&mut self, operation: u32, mild: f32, budget: &Budget) -> bool {
        if self.cascade.refused.contains(&operation) && self.milder_than(mild).is_none() {
            return false;
        }
        let before = self.report;
        let refused = std::mem::take(&mut self.cascade.refused);
        self.hold(operation);
        while let Some(&next) = self.cascade.waiting.last() {
            let blocker = self.front.blocker(&self.hierarchy, next);
            if let Some(blocker) = blocker.and_then(|node| self.hierarchy.maker(node)) {
                self.hold(blocker);
            } else if self.triangles().len() + self.hierarchy.going(next).len() <= budget.triangles {
                self.split(next);
                self.cascade.waiting.pop();
                self.cascade.done.push(next);
            } else if let Some(other) = self.milder_than(mild) {
                self.merge(other);
                self.cascade.done.push(other);
            } else {
                self.give_up(before);
                self.cascade.refused = refused;
                self.cascade.refused.push(operation);
                return false;
            }
        }
        self.report.forced += self.report.splits - before.splits - 1;
        self.release();
        // All others are below it, and can only be done after it.
        self.candidates.add(&self.hierarchy, operation, Way::Merge);
        true
    }

    /// The operation that could be done at the least error, if that is less.
    fn milder_than(&mut self, error: f32) -> Option<u32> {
        self.mildest().filter(|&(least, _)| least < error).map(|(_, operation)| operation)
    }

    /// Has an operation wait to be split; what would contract its node must not come before.
    fn hold(&mut self, operation: u32) {
        self.cascade.waiting.push(operation);
        self.cascade.is_held[operation as usize] = true;
        if let Some(parent) = self.hierarchy.parent(self.hierarchy.node(operation)) {
            self.candidates.drop(parent);
        }
    }

    fn release(&mut self) {
        let Cascade { waiting, done, is_held, .. } = &mut self.cascade;
        for operation in waiting.drain(..).chain(done.drain(..)) {
            is_held[operation as usize] = false;
        }
    }

    /// Undoes what was done in vain, last things first.
    fn give_up(&mut self, before: Report) {
        let mut done = std::mem::take(&mut self.cascade.done);
        let waiting = std::mem::take(&mut self.cascade.waiting);
        for &operation in done.iter().chain(&waiting) {
            self.cascade.is_held[operation as usize] = false;
        }
        while let Some(operation) = done.pop() {
            let node = self.hierarchy.node(operation);
            if self.front.is_active(node) {
                self.hierarchy.parent(node).into_iter().for_each(|parent| self.candidates.drop(parent));
                self.split(operation);
                self.candidates.add(&self.hierarchy, operation, Way::Merge);
            } else {
                self.merge(operation);
            }
        }
        waiting.iter().for_each(|&operation| self.await_merges_around(self.hierarchy.node(operation)));
        self.report = before;
        (self.cascade.done, self.cascade.waiting) = (done, waiting);
        self.cascade.waiting.clear();
    }

    /// Splits an operation that is held and has no blocker.
    fn split(&mut self, operation: u32) {
        self.front.split(&self.hierarchy, operation);
        self.cascade.refused.clear();
        self.report.splits += 1;
        self.candidates.drop(operation);
        for end in self.hierarchy.operation(operation).ends {
            if let Some(maker) = self.hierarchy.maker(end) {
                self.candidates.add(&self.hierarchy, maker, Way::Split);
            }
        }
    }

    /// Does an operation that can be done.
    pub(super) fn merge(&mut self, operation: u32) {
        self.front.merge(&self.hierarchy, operation);
        self.cascade.refused.clear();
        self.report.merges += 1;
        for end in self.hierarchy.operation(operation).ends {
            self.hierarchy.maker(end).into_iter().for_each(|maker| self.candidates.drop(maker));
        }
        self.candidates.turn_to_split(&self.hierarchy, operation);
        self.await_merges_around(self.hierarchy.node(operation));
    }

    /// What became possible because a node came to be.
    fn await_merges_around(&mut self, node: u32) {
        let mut above = std::mem::take(&mut self.cascade.above);
        // Those whose triangles went with it may be no neighbours any more.
        let apexes = self.hierarchy.maker(node).map_or(&[][..], |maker| self.hierarchy.apexes(maker));
        let around = self.front.around(node).chain([node]).chain(apexes.iter().copied());
        for node in around.filter(|&node| !self.is_to_be_split(node)) {
            above.extend(self.hierarchy.parent(node).filter(|parent| !above.contains(parent)));
        }
        for operation in above.drain(..) {
            let is_known =
                self.cascade.is_held[operation as usize] || self.candidates.may_be_merged(operation);
            if !is_known && self.front.may_merge(&self.hierarchy, operation) {
                self.candidates.add(&self.hierarchy, operation, Way::Merge);
            }
        }
        self.cascade.above = above;
    }

    fn is_to_be_split(&self, node: u32) -> bool {
        self.hierarchy.maker(node).is_some_and(|maker| self.cascade.is_held[maker as usize])
    }
}
