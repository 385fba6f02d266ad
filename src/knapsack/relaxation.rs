//! The linear relaxation: hull steps in order of slope, and what it bounds.

use std::cmp::Ordering;

use super::dyadic::Number;
use super::hull::{Step, compare_slopes, upper_hull_of};
use super::ledger::{Ledger, Totals, UpperBound};

/// A step from one item of a class's hull to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct HullStep {
    /// Rounded.
    slope: f64,
    pub class: u32,
    pub from: u32,
    pub to: u32,
    /// Steps before it on the hull.
    rank: u32,
}

/// Slopes this far apart, relatively, differ without their roundings as well: three of ½ ε each.
const CLEAR: f64 = 8.0 * f64::EPSILON;

impl HullStep {
    fn geometry<T: Number>(&self, ledger: &Ledger<'_, T>) -> Step {
        let class = self.class as usize;
        Step { from: ledger.item(class, self.from), to: ledger.item(class, self.to) }
    }

    /// Steeper first; of equal slopes the lower class, then the cheaper step.
    fn order<T: Number>(&self, other: &Self, ledger: &Ledger<'_, T>) -> Ordering {
        let (steeper, flatter) = (self.slope.max(other.slope), self.slope.min(other.slope));
        if steeper - flatter > steeper * CLEAR && flatter > 1e-290 && steeper < 1e290 {
            return other.slope.total_cmp(&self.slope);
        }
        let slopes = compare_slopes(other.geometry(ledger), self.geometry(ledger));
        slopes.then(self.class.cmp(&other.class)).then(self.rank.cmp(&other.rank))
    }
}

/// The hull steps of all classes in order: the first `limit` of them and one more. Items that do not fit beside the
/// `cheapest` choice of all other classes, which costs `least` in all, are left out before hulls are built.
pub(super) fn sorted_steps<T: Number>(
    ledger: &Ledger<'_, T>,
    cheapest: &[u32],
    least: T,
    limit: u64,
) -> Vec<HullStep> {
    let mut steps = Vec::with_capacity(ledger.instance.items().len());
    let mut hull = Vec::new();
    for (class, items) in ledger.instance.classes().enumerate() {
        let others = least - ledger.cost(items[cheapest[class] as usize]);
        upper_hull_of(items, |&item| others + ledger.cost(item) <= ledger.budget, &mut hull);
        steps.extend(hull.windows(2).zip(0..).map(|(ends, rank)| {
            let [from, to] = [ends[0], ends[1]];
            let slope = Step { from: items[from as usize], to: items[to as usize] }.slope();
            HullStep { slope, class: class as u32, from, to, rank }
        }));
    }
    let order = |a: &HullStep, b: &HullStep| a.order(b, ledger);
    if limit < steps.len() as u64 {
        steps.select_nth_unstable_by(limit as usize, order);
        steps.truncate(limit as usize + 1);
    }
    steps.sort_unstable_by(order);
    steps
}

/// The integer part of the linear relaxation's optimum: every step steeper than the critical one taken.
#[derive(Clone, Debug)]
pub(super) struct Relaxation {
    pub choice: Vec<u32>,
    /// The slope of the critical step.
    pub lambda: f64,
}

/// Where the budget, or the effort, ends: a step, and the totals of all steeper ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge<T> {
    /// Steps before it.
    pub at: usize,
    pub step: HullStep,
    pub before: Totals<T>,
}

impl<T: Number> Edge<T> {
    pub fn relaxation(&self, cheapest: &[u32], steps: &[HullStep]) -> Relaxation {
        let mut choice = cheapest.to_vec();
        for step in &steps[..self.at] {
            choice[step.class as usize] = step.to;
        }
        Relaxation { choice, lambda: self.step.slope }
    }

    /// Whether it is the budget that ends here.
    pub fn is_critical(&self, ledger: &Ledger<'_, T>) -> bool {
        let Step { from, to } = self.step.geometry(ledger);
        self.before.cost - ledger.cost(from) + ledger.cost(to) > ledger.budget
    }

    /// The linear relaxation's optimum, rounded up: the steeper steps and, at the slope of this one, what there is room
    /// for. Met where there is no room: the totals before it are the optimum.
    pub fn linear_bound(&self, ledger: &Ledger<'_, T>) -> UpperBound {
        let Step { from, to } = self.step.geometry(ledger);
        let room = ledger.budget - self.before.cost;
        if room == T::ZERO {
            return UpperBound::Met(0.0);
        }
        let run = ledger.cost(to) - ledger.cost(from);
        let rise = ledger.benefit(to) - ledger.benefit(from);
        let part = (room.to_f64_up(ledger.cost_unit) / run.to_f64_down(ledger.cost_unit)).next_up();
        let gain = (part * rise.to_f64_up(ledger.benefit_unit)).next_up();
        let bound = (self.before.benefit.to_f64_up(ledger.benefit_unit) + gain).next_up();
        // All benefits together are finite, whatever rounding makes of the slope.
        UpperBound::Open(bound.min(f64::MAX))
    }
}
