//! The textbook solver: the linear relaxation's greedy on convex hulls, with fill and repair, and at least half of the
//! optimum.

use super::attempt::Attempt;
use super::dyadic::{Number, WideSum};
use super::ledger::{Grids, Ledger, UpperBound, cheapest};
use super::meter::Meter;
use super::relaxation::{Relaxation, sorted_steps};
use super::{Instance, Solution};

/// How much work [`greedy_within`] may do beyond building hulls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Hull steps looked at and partial choices made by the repair, at most.
    pub steps: u64,
    /// Items that the repair may exchange for the chosen ones: those whose slopes are nearest to λ. 0 for the
    /// textbook's greedy alone.
    pub exchanges: usize,
    /// Partial choices that each of the repair's two lists may hold. More of them close the gap further, and cost time
    /// in proportion.
    pub states: usize,
}

impl Effort {
    /// The greedy alone: no limit and no repair.
    pub const TEXTBOOK: Self = Self { steps: u64::MAX, exchanges: 0, states: 0 };
}

impl Default for Effort {
    /// No limit on the steps, and a repair of some ten thousand of them: at a thousand classes nearly as good as the
    /// optimum.
    fn default() -> Self {
        Self { steps: u64::MAX, exchanges: 64, states: 512 }
    }
}

/// [`greedy_within`] the default effort: what to take where nothing speaks against it.
pub fn greedy(instance: &Instance) -> Solution {
    greedy_within(instance, Effort::default())
}

/// Solves by the slopes of the classes' upper hulls, steepest first.
///
/// 1. Items that do not fit even with every other class at its cheapest are dropped, *before* hulls are built.
/// 2. All classes start at their cheapest item. Hull steps are taken in order of (slope descending, class ascending,
///    cost ascending); a step that does not fit is skipped, its class takes no later step, and the rest go on.
/// 3. The first step that did not fit is the critical one. A second attempt takes its item first and then goes through
///    the steps again; the better attempt is kept, on a tie the first.
/// 4. What is left of the budget is spent by exchanging a few items with slopes near the critical one, λ, and by taking
///    steps again.
///
/// The benefit is at least half of the optimum: the linear optimum is at most the first attempt up to the critical step
/// plus that step, and each attempt holds one of the two (Kellerer, Pferschy, Pisinger, *Knapsack Problems*, 2004, ch.
/// 11). The upper bound is that linear optimum, g(λ). Slopes, sums and fits are exact. O(n log n) for n items: it sorts
/// all of them, so it is not the one for every frame.
///
/// Anytime: cut by `effort.steps`, at the same place on every machine, the answer is within the budget wherever any is
/// and its bound holds; the half is promised once 2 and 3 are through. Finding the cheapest items and the steepest
/// steps is not counted and takes O(n + s log s) for s steps.
pub fn greedy_within(instance: &Instance, effort: Effort) -> Solution {
    quick(instance, effort).solution
}

/// An answer, and the relaxation that it comes from: `None` where there is nothing left to search, or the effort ended
/// before λ was known.
#[derive(Clone, Debug)]
pub(super) struct Quick {
    pub solution: Solution,
    pub relaxation: Option<Relaxation>,
}

/// [`greedy_within`] for a search that goes on from there.
pub(super) fn quick(instance: &Instance, effort: Effort) -> Quick {
    let grids = Grids::of(instance);
    let mut never = || false;
    let mut meter = Meter::new(effort.steps, &mut never);
    let mut quick = if grids.bits() <= i128::BITS {
        solve(&Ledger::<i128>::new(instance, grids), effort, &mut meter)
    } else {
        solve(&Ledger::<WideSum>::new(instance, grids), effort, &mut meter)
    };
    quick.solution.steps = meter.made();
    quick
}

fn solve<T: Number>(ledger: &Ledger<'_, T>, effort: Effort, meter: &mut Meter<'_>) -> Quick {
    let start = Attempt::new(ledger, cheapest(ledger.instance));
    if start.totals.cost > ledger.budget {
        return Quick { solution: ledger.infeasible(start.choice), relaxation: None };
    }
    let steps = sorted_steps(ledger, &start.choice, start.totals.cost, meter.left());
    let mut filled = start.clone();
    let Some(edge) = filled.walk(&steps, meter) else {
        let solution = ledger.solution(filled.choice, filled.totals, 0.0, UpperBound::Met(0.0));
        return Quick { solution, relaxation: None };
    };
    let relaxation = edge.relaxation(&start.choice, &steps);
    let mut best = start.rival(edge.step, &steps, meter).better_than(filled);
    if effort.exchanges > 0 {
        best.repair(&relaxation, &steps, effort, meter);
    }
    let solution = ledger.solution(best.choice, best.totals, relaxation.lambda, edge.linear_bound(ledger));
    let open = !solution.optimal && edge.is_critical(ledger);
    Quick { solution, relaxation: open.then_some(relaxation) }
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
