//! Select: from candidates to one level each. The policies behind one interface.
//!
//! Hysteresis and dwell belong here and nowhere else: a selector is told what was wanted of each candidate in the last
//! frame, and for how long.

mod fixed;
mod funkhouser_sequin;
mod menu;
mod predictive;
mod reactive;
mod screen_size;
mod steadiness;
mod sweep;

pub use fixed::{Coarsest, Finest};
pub use funkhouser_sequin::FunkhouserSequin;
pub use predictive::{Predictive, PredictiveOptions};
pub use reactive::{Reactive, ReactiveOptions};
pub use screen_size::{Measure, ScreenSize, ScreenSizeOptions};
pub use steadiness::Steadiness;

use crate::frame::{
    Account, Budget, Candidate, Candidates, Cause, Deferral, FrameId, Memory, Remembered, SelectReport,
    Timing,
};
use crate::knapsack::FixedSum;
use crate::rate::{self, CostModel, TableRates, cost_us};
use crate::scene::Objects;
use crate::table::Level;

/// All that a selector is told about a frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// Which frame it is.
    pub id: FrameId,
    /// The objects; their ids break ties.
    pub objects: &'a Objects,
    /// What is in view.
    pub candidates: &'a Candidates,
    /// What the levels of each table cost and are worth.
    pub rates: &'a TableRates,
    /// How the cost of an object follows from its geometry and its area.
    pub model: &'a CostModel,
    /// What the frame may cost.
    pub budget: Budget,
    /// What frames have been measured to take.
    pub timing: Timing,
    /// Objects that may be left out and are worth less than this, in px² per µs, are no candidates: see
    /// [`Selector::floor`]. 0 where everything in view is one.
    pub floor: f64,
    /// What is remembered of earlier frames.
    pub memory: &'a dyn Memory,
    /// How many threads the policy may use (feature `rayon`); they must not change what it chooses.
    pub threads: usize,
}

impl Frame<'_> {
    /// Candidate `i`. Where candidates are not [detailed](Candidates::is_detailed) its details are worked out, which
    /// takes some 50 ns.
    pub fn candidate(&self, i: usize) -> Candidate {
        let c = self.candidates;
        if c.is_detailed() {
            return c.get(i);
        }
        let run = c.ends.partition_point(|g| g.end <= i);
        rate::details(self.objects, self.rates, &c.ends[run].lens, c.slot_of(i), c.weight[i])
    }

    /// A copy of the candidates with all details.
    pub fn detailed(&self) -> Candidates {
        let mut detailed = self.candidates.clone();
        detailed.clear_details();
        (0..self.candidates.len()).for_each(|i| detailed.push_details(self.candidate(i)));
        detailed
    }

    /// Predicted time of candidate `i` at `level`; 0 when not drawn.
    pub fn cost_us(&self, i: usize, level: Level) -> f64 {
        cost_us(self.model, self.rates, &self.candidate(i), level)
    }

    /// Benefit of candidate `i` at `level` in px²; 0 when not drawn.
    pub fn benefit(&self, i: usize, level: Level) -> f64 {
        self.benefit_of(&self.candidate(i), level)
    }

    /// The cheapest choice of candidate `i`.
    pub fn minimum(&self, i: usize) -> Level {
        self.minimum_of(&self.candidate(i))
    }

    fn benefit_of(&self, candidate: &Candidate, level: Level) -> f64 {
        f64::from(candidate.weight) * f64::from(self.rates.accuracy(candidate.table, level))
    }

    fn minimum_of(&self, candidate: &Candidate) -> Level {
        self.rates.minimum(candidate.table, candidate.allowed)
    }

    /// How long what was wanted of candidate `i` in the last frame has been wanted; 0 where nothing was.
    pub fn age_ms(&self, i: usize) -> u32 {
        self.remembered(i).age_ms
    }

    /// What the policy owes to candidate `i`: nothing where no accounts are kept.
    pub fn account(&self, i: usize) -> Account {
        self.remembered(i).account
    }

    fn remembered(&self, i: usize) -> Remembered {
        let recall = || self.memory.recall(self.candidates.group_of(i), self.candidates.slot_of(i));
        if self.candidates.previous(i).is_some() { recall() } else { Remembered::default() }
    }

    /// What breaks ties between candidates: the object's id, then the group. The lower goes first.
    pub fn key(&self, i: usize) -> u128 {
        let id = self.objects.id_of(self.candidates.slot_of(i) as usize).unwrap_or_default();
        u128::from(id.0) << 32 | u128::from(self.candidates.group_of(i).0)
    }

    /// Cost and benefit of a selection, and by how much the minimum choice exceeds the budget.
    pub fn report(&self, levels: &[Level]) -> SelectReport {
        let [mut cost, mut benefit, mut least] = [FixedSum::default(); 3];
        for (i, &level) in levels.iter().enumerate() {
            let candidate = self.candidate(i);
            let cost_us = |level| cost_us(self.model, self.rates, &candidate, level);
            cost.add(cost_us(level));
            benefit.add(self.benefit_of(&candidate, level));
            least.add(cost_us(self.minimum_of(&candidate)));
        }
        SelectReport {
            cost_us: cost.value(),
            benefit: benefit.value(),
            infeasible_us: (least.value() - self.budget.select_us).max(0.0),
            ..SelectReport::default()
        }
    }
}

/// What a selector has to be told about candidates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Needs {
    /// Weights; details now and then, through [`Frame::candidate`].
    Weights,
    /// Weights and projected diameters ([`Candidates::size_px`]).
    Sizes,
    /// All columns.
    #[default]
    Details,
}

/// A policy: fills in one level per candidate.
///
/// Levels must lie in the candidate's allowed range, or be [`Level::NOT_DRAWN`] where that range ends in it. The same
/// frames must yield the same levels, whatever the order of slots.
pub trait Selector: Send {
    /// What the selector reads of candidates. Candidates may come with more.
    fn needs(&self) -> Needs {
        Needs::Details
    }

    /// Chooses. `levels` has one entry per candidate: what was wanted in the last frame, and anything for a candidate
    /// that has just come into view.
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport;

    /// What the next frame's objects have to be worth at most, in px² per µs, to be left out for certain where they may
    /// be; 0 for a policy that cannot tell. They are not even looked at then, whole regions of them at a time.
    fn floor(&self) -> f64 {
        0.0
    }

    /// Why candidate `i` is at `level`, which it could be finer than: the budget (or the size) unless the policy knows
    /// of another reason. `frame` is the frame that was selected last.
    fn cause(&self, frame: &Frame<'_>, i: usize, level: Level) -> Cause {
        let _ = (frame, i, level);
        Cause::Budget
    }

    /// Candidates of the last selection, in any order, for which the policy has chosen another level than it wants
    /// shown for now. The next frame starts from what was chosen ([`Candidates::place`]), and [`Frame::account`] tells
    /// for how long something has been owed. `None` from a policy that has no use for accounts.
    fn deferred(&self) -> Option<&[Deferral]> {
        None
    }

    /// Forgets everything learnt from earlier frames.
    fn reset(&mut self) {}

    /// A copy with all its memory, for snapshots.
    fn boxed_clone(&self) -> Box<dyn Selector>;
}

impl Clone for Box<dyn Selector> {
    fn clone(&self) -> Self {
        self.boxed_clone()
    }
}
