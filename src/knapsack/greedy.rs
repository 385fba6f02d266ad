//! The textbook solver: the linear relaxation's greedy on convex hulls, with fill, and at least half of the optimum.

use std::cmp::Ordering;

use super::dyadic::{Number, WideSum};
use super::hull::{Step, compare_slopes, upper_hull_of};
use super::ledger::{Grids, Ledger, Totals, UpperBound, cheapest};
use super::{Instance, Solution};

/// Solves by the slopes of the classes' upper hulls, steepest first.
///
/// 1. Items that do not fit even with every other class at its cheapest are dropped, *before* hulls are built.
/// 2. All classes start at their cheapest item. Hull steps are taken in order of (slope descending, class ascending, cost ascending); a
///    step that does not fit is skipped, its class takes no later step, and the rest go on.
/// 3. The first step that did not fit is the critical one. A second attempt takes its item first and then goes through the steps again;
///    the better attempt is the answer, on a tie the first.
///
/// The benefit is at least half of the optimum: the linear optimum is at most the first attempt up to the critical step plus that step, and each
/// attempt holds one of the two (Kellerer, Pferschy, Pisinger, *Knapsack Problems*, 2004, ch. 11). The upper bound is that linear optimum,
/// g(λ) at the critical slope λ. Slopes, sums and fits are exact. O(n log n) for n items; sorts all of them, so it is the
/// twin that faster solvers are tested against rather than the one for every frame.
pub fn greedy(instance: &Instance) -> Solution {
    let grids = Grids::of(instance);
    if grids.bits() <= i128::BITS {
        solve(&Ledger::<i128>::new(instance, grids))
    } else {
        solve(&Ledger::<WideSum>::new(instance, grids))
    }
}

fn solve<T: Number>(ledger: &Ledger<'_, T>) -> Solution {
    let start = Attempt::new(ledger, cheapest(ledger.instance));
    if start.totals.cost > ledger.budget {
        return ledger.infeasible(start.choice);
    }
    let steps = sorted_steps(ledger, &start);
    let mut filled = start.clone();
    let Some(critical) = filled.walk(&steps) else {
        return ledger.solution(filled.choice, filled.totals, 0.0, UpperBound::Met(0.0));
    };
    let mut forced = start;
    forced.switch(critical.step.class, critical.step.to);
    forced.walk(&steps);
    let better = if forced.totals.benefit > filled.totals.benefit { forced } else { filled };
    let (slope, bound) = (critical.slope(ledger), critical.linear_bound(ledger));
    ledger.solution(better.choice, better.totals, slope, bound)
}

/// The integer part of the linear relaxation's optimum: every step steeper than the critical one taken.
#[derive(Clone, Debug)]
pub(crate) struct Relaxation {
    pub choice: Vec<u32>,
    /// The slope of the step that the budget cuts; 0 when none is cut.
    pub lambda: f64,
}

/// Solves the linear relaxation; `None` when nothing is feasible.
pub(crate) fn relax<T: Number>(ledger: &Ledger<'_, T>) -> Option<Relaxation> {
    let mut attempt = Attempt::new(ledger, cheapest(ledger.instance));
    if attempt.totals.cost > ledger.budget {
        return None;
    }
    for step in sorted_steps(ledger, &attempt) {
        if attempt.with(step.class, step.to).cost > ledger.budget {
            return Some(Relaxation { choice: attempt.choice, lambda: step.geometry(ledger).slope() });
        }
        attempt.switch(step.class, step.to);
    }
    Some(Relaxation { choice: attempt.choice, lambda: 0.0 })
}

/// A step from one item of a class's hull to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HullStep {
    pub class: u32,
    pub from: u32,
    pub to: u32,
}

impl HullStep {
    pub fn geometry<T: Number>(&self, ledger: &Ledger<'_, T>) -> Step {
        let class = self.class as usize;
        Step { from: ledger.item(class, self.from), to: ledger.item(class, self.to) }
    }
}

/// The hull steps of all classes, steepest first; of equal slopes the lower class, then the cheaper step.
fn sorted_steps<T: Number>(ledger: &Ledger<'_, T>, start: &Attempt<'_, T>) -> Vec<HullStep> {
    let mut steps = Vec::with_capacity(ledger.instance.items().len());
    let mut hull = Vec::new();
    for (class, items) in ledger.instance.classes().enumerate() {
        let others = start.totals.cost - ledger.cost(items[start.choice[class] as usize]);
        upper_hull_of(items, |&item| others + ledger.cost(item) <= ledger.budget, &mut hull);
        steps.extend(hull.windows(2).map(|ends| HullStep {
            class: class as u32,
            from: ends[0],
            to: ends[1],
        }));
    }
    // Steps of one class are in order already, and the sort is stable.
    steps.sort_by(|a, b| steeper_first(a.geometry(ledger), b.geometry(ledger)).then(a.class.cmp(&b.class)));
    steps
}

fn steeper_first(a: Step, b: Step) -> Ordering {
    compare_slopes(b, a)
}

/// A choice under construction.
#[derive(Clone, Debug)]
struct Attempt<'a, T> {
    ledger: &'a Ledger<'a, T>,
    choice: Vec<u32>,
    totals: Totals<T>,
}

impl<'a, T: Number> Attempt<'a, T> {
    fn new(ledger: &'a Ledger<'a, T>, choice: Vec<u32>) -> Self {
        let totals = ledger.totals(&choice);
        Self { ledger, choice, totals }
    }

    /// Totals once `class` has chosen `item`.
    fn with(&self, class: u32, item: u32) -> Totals<T> {
        let old = self.ledger.item(class as usize, self.choice[class as usize]);
        let new = self.ledger.item(class as usize, item);
        Totals {
            cost: self.totals.cost - self.ledger.cost(old) + self.ledger.cost(new),
            benefit: self.totals.benefit - self.ledger.benefit(old) + self.ledger.benefit(new),
        }
    }

    fn switch(&mut self, class: u32, item: u32) {
        self.totals = self.with(class, item);
        self.choice[class as usize] = item;
    }

    /// Takes every step that starts where its class stands and fits; returns the first that did not fit.
    ///
    /// A class whose step was skipped never again stands where one of its steps starts: it is blocked.
    fn walk(&mut self, steps: &[HullStep]) -> Option<Critical<T>> {
        let mut critical = None;
        for &step in steps.iter() {
            if self.choice[step.class as usize] != step.from {
                continue;
            }
            if self.with(step.class, step.to).cost <= self.ledger.budget {
                self.switch(step.class, step.to);
            } else if critical.is_none() {
                critical = Some(Critical { step, before: self.totals });
            }
        }
        critical
    }
}

/// The step that the budget cuts, and the totals of all steeper ones.
#[derive(Clone, Copy, Debug)]
struct Critical<T> {
    step: HullStep,
    before: Totals<T>,
}

impl<T: Number> Critical<T> {
    fn slope(&self, ledger: &Ledger<'_, T>) -> f64 {
        self.step.geometry(ledger).slope()
    }

    /// The linear relaxation's optimum, rounded up: the steeper steps and the part of this one that fits. Met where no part fits:
    /// the totals before it are the optimum.
    fn linear_bound(&self, ledger: &Ledger<'_, T>) -> UpperBound {
        let Step { from, to } = self.step.geometry(ledger);
        let room = ledger.budget - self.before.cost;
        if room == T::ZERO {
            return UpperBound::Met(0.0);
        }
        let run = ledger.cost(to) - ledger.cost(from);
        let rise = ledger.benefit(to) - ledger.benefit(from);
        let part = (room.to_f64_up(ledger.cost_unit) / run.to_f64_down(ledger.cost_unit)).next_up().min(1.0);
        let gain = (part * rise.to_f64_up(ledger.benefit_unit)).next_up();
        UpperBound::Open((self.before.benefit.to_f64_up(ledger.benefit_unit) + gain).next_up())
    }
}

#[cfg(test)]
mod tests {
    use super::super::Item;
    use super::*;

    fn instance(budget: f64, classes: &[&[(f64, f64)]]) -> Instance {
        let classes = classes.iter().map(|class| class.iter().copied().map(Item::from).collect::<Vec<_>>());
        Instance::new(budget, classes).expect("a valid instance")
    }

    #[test]
    fn the_1993_counterexample_is_solved() {
        let solution = greedy(&instance(
            346.8607,
            &[
                &[(0.1136, 0.4652), (1.7599, 5.0387), (18.8952, 34.5056), (346.7490, 618.5195)],
                &[(0.1086, 0.3795), (0.3057, 0.6621), (5.2287, 2.1120), (21.4700, 6.1775)],
            ],
        ));
        assert_eq!(solution.choice, [3, 0]);
        assert!((solution.benefit - 618.899).abs() < 1e-9);
    }

    #[test]
    fn a_large_item_behind_a_steep_small_one_is_found_by_the_second_attempt() {
        let solution = greedy(&instance(10.0, &[&[(0.0, 0.0), (1.0, 2.0)], &[(0.0, 0.0), (10.0, 10.0)]]));
        assert_eq!((solution.choice, solution.benefit), (vec![0, 1], 10.0));
        assert_eq!(solution.lambda, 1.0);
        assert_eq!(solution.upper_bound.map(f64::floor), Some(11.0));
    }

    #[test]
    fn fill_goes_on_behind_a_step_that_does_not_fit() {
        let solution = greedy(&instance(
            3.0,
            &[&[(0.0, 0.0), (2.0, 20.0)], &[(0.0, 0.0), (2.0, 4.0)], &[(0.0, 0.0), (1.0, 1.0)]],
        ));
        assert_eq!(solution.choice, [1, 0, 1]);
        assert!(!solution.optimal && solution.feasible);
    }

    #[test]
    fn infeasible_is_an_answer() {
        let solution = greedy(&instance(1.5, &[&[(5.0, 9.0), (1.0, 1.0)], &[(1.0, 2.0), (1.0, 3.0)]]));
        assert_eq!((solution.choice, solution.cost, solution.benefit), (vec![1, 1], 2.0, 4.0));
        assert_eq!((solution.feasible, solution.optimal, solution.shortfall), (false, false, 0.5));
        assert_eq!((solution.upper_bound, solution.gap, solution.lambda), (None, None, f64::INFINITY));
    }

    #[test]
    fn a_shortfall_below_every_cost_is_seen() {
        let solution = greedy(&instance(1.0f64.next_down(), &[&[(1.0, 1.0)]]));
        assert_eq!((solution.feasible, solution.shortfall), (false, f64::EPSILON / 2.0));
        let sum = [0.1, 0.2, 0.3].map(|cost| [Item { cost, benefit: 1.0 }]);
        assert!(
            !greedy(&Instance::new(0.6, sum).expect("valid")).feasible,
            "0.1 + 0.2 + 0.3 exceeds 0.6 by 2^-55"
        );
    }

    #[test]
    fn nothing_to_choose_and_nothing_to_spend() {
        let empty = greedy(&instance(0.0, &[]));
        assert_eq!(
            (empty.choice.len(), empty.cost, empty.upper_bound, empty.gap),
            (0, 0.0, Some(0.0), Some(0.0))
        );
        let free = greedy(&instance(0.0, &[&[(0.0, 3.0), (0.0, 4.0), (1.0, 9.0)]]));
        assert_eq!((free.choice, free.optimal, free.feasible), (vec![1], true, true));
    }

    #[test]
    fn any_finite_range_is_summed_exactly() {
        let far: &[(f64, f64)] = &[(0.0, 1.0), (1e300, 2.0)];
        let over = greedy(&instance(1e300, &[far, &[(5e-324, 0.0)]]));
        assert_eq!(over.choice, [0, 0], "1e300 + 5e-324 exceeds the budget");
        let level = greedy(&instance(1e300, &[far, &[(0.0, 0.0), (1e-300, 1e-300)]]));
        assert_eq!((level.choice, level.cost), (vec![1, 0], 1e300));
    }
}
