//! The cut that a camera asks for, kept up to date.
//!
//! M. Duchaineau et al., "ROAMing terrain: real-time optimally adapting meshes", 1997: of two queues one has what
//! could be split, largest error first, the other what could be contracted, least error first. What is too much is
//! contracted, what is wrong is split while there is room, and room is made as long as that takes less than it gives.

mod agenda;
mod budget;
mod candidates;
mod cascade;
mod front;
mod heap;
mod look;
mod sight;

use std::sync::Arc;

pub use budget::{Budget, Report};
use candidates::Candidates;
use cascade::Cascade;
use front::Front;
use look::{Brink, Way};

use super::Hierarchy;
use crate::view::{Lens, View};

/// How many operations an update tries to make room for in vain.
const TRIES: usize = 8;

/// A cut through a [`Hierarchy`]: what is shown of it, and what is known for the next frame. It takes some 40 bytes per
/// vertex of the mesh and 100 per triangle shown; there can be several of one hierarchy.
///
/// Triangles are in slots without holes, so that slots are an index buffer over [`Hierarchy::positions`]; an update
/// tells which slots have changed.
#[derive(Clone, Debug)]
pub struct Cut {
    hierarchy: Arc<Hierarchy>,
    front: Front,
    candidates: Candidates,
    cascade: Cascade,
    /// The budget that the cut is settled for, as long as views stay.
    settled: Option<Budget>,
    report: Report,
}

impl Cut {
    /// The coarsest cut; O(n).
    pub fn new(hierarchy: Arc<Hierarchy>) -> Self {
        let operations = hierarchy.parts().operations.len();
        let front = Front::coarsest(&hierarchy);
        let mut candidates = Candidates::new(&hierarchy);
        let is_root = |&o: &u32| front.is_active(hierarchy.node(o));
        (0..operations as u32)
            .filter(is_root)
            .for_each(|operation| candidates.add(&hierarchy, operation, Way::Split));
        Self {
            front,
            candidates,
            cascade: Cascade::new(operations),
            settled: None,
            report: Report::default(),
            hierarchy,
        }
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
        let scale = self.lens().map_or(0.0, |lens| lens.scale_px);
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
        let has_moved = self.candidates.follow(&self.hierarchy, usable());
        if has_moved || self.settled != Some(*budget) {
            self.shrink(budget);
            let is_settled = self.lens().is_none() || self.exchange(budget) && self.relax(budget);
            self.settled = is_settled.then_some(*budget);
            self.front.sort_changes();
        }
        let Brink { split, .. } = self.candidates.remember_brink(&self.hierarchy, &self.front);
        self.report.max_error_px = split * self.lens().map_or(0.0, |lens| lens.scale_px);
        self.report.triangles = self.triangles().len();
        self.report.evaluated = self.candidates.evaluated;
        self.report.is_settled = self.settled.is_some();
        self.report
    }

    pub(super) fn lens(&self) -> Option<&Lens> {
        self.candidates.lens()
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
                aside.extend(self.candidates.take_split(worst).map(|key| (key, worst)));
                if self.triangles().len() >= budget.triangles {
                    break;
                }
            }
        }
        self.put_back(&aside);
        is_done
    }

    /// What was refused is still to be split, unless that or the contrary has come about.
    fn put_back(&mut self, aside: &[(u32, u32)]) {
        for &(key, operation) in aside {
            if self.front.is_active(self.hierarchy.node(operation)) {
                self.candidates.put_back_split(operation, key);
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
        self.lens().map_or(f32::INFINITY, |lens| budget.enough_px / lens.scale_px)
    }

    /// The operation that is most in need of a split.
    fn worst(&mut self) -> Option<(f32, u32)> {
        self.candidates.worst(&self.hierarchy)
    }

    /// The operation that is done at the least error.
    fn mildest(&mut self) -> Option<(f32, u32)> {
        self.candidates.mildest(&self.hierarchy, &self.front)
    }
}
