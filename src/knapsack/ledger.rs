//! The exact books of one instance: its amounts as integers, its budget on the same grid, and solutions with their
//! sums.

use super::dyadic::{Grid, LOWEST_UNIT, Number, WideSum};
use super::{Instance, Item, Solution};

/// The grids on which costs and benefits are integers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grids {
    cost: Grid,
    benefit: Grid,
}

impl Grids {
    pub fn of(instance: &Instance) -> Self {
        let terms = 2 * instance.len() + 2;
        let items = instance.items().iter();
        Self {
            cost: Grid::of(items.clone().map(|item| item.cost), terms),
            benefit: Grid::of(items.map(|item| item.benefit), terms),
        }
    }

    /// The bits that any sum over the classes takes, sign included.
    pub fn bits(&self) -> u32 {
        self.cost.bits.max(self.benefit.bits)
    }
}

/// Exact cost and benefit of a choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Totals<T> {
    pub cost: T,
    pub benefit: T,
}

/// A bound on every choice's benefit, rounded up.
#[derive(Clone, Copy, Debug)]
pub(crate) enum UpperBound {
    /// Known to be met: no choice reports more than the one at hand.
    Met(f64),
    /// Met only if the reported benefit reaches it.
    Open(f64),
}

/// An instance seen through integers of type `T`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ledger<'a, T> {
    pub instance: &'a Instance,
    pub cost_unit: i32,
    pub benefit_unit: i32,
    /// The largest multiple of the cost unit within the budget, or the sum of the largest costs where that is less.
    pub budget: T,
}

impl<'a, T: Number> Ledger<'a, T> {
    pub fn new(instance: &'a Instance, grids: Grids) -> Self {
        let (cost_unit, benefit_unit) = (grids.cost.unit, grids.benefit.unit);
        let largest =
            |class: &[Item]| T::floor(class.iter().map(|item| item.cost).fold(0.0, f64::max), cost_unit);
        let most = instance.classes().fold(T::ZERO, |sum, class| sum + largest(class));
        let enough = instance.budget() >= most.to_f64_up(cost_unit);
        let budget = if enough { most } else { T::floor(instance.budget(), cost_unit) };
        Self { instance, cost_unit, benefit_unit, budget }
    }

    pub fn cost(&self, item: Item) -> T {
        T::floor(item.cost, self.cost_unit)
    }

    pub fn benefit(&self, item: Item) -> T {
        T::floor(item.benefit, self.benefit_unit)
    }

    pub fn item(&self, class: usize, index: u32) -> Item {
        self.instance.class(class)[index as usize]
    }

    pub fn totals(&self, choice: &[u32]) -> Totals<T> {
        let chosen = choice.iter().enumerate().map(|(class, &index)| self.item(class, index));
        let start = Totals { cost: T::ZERO, benefit: T::ZERO };
        chosen.fold(start, |sum, item| Totals {
            cost: sum.cost + self.cost(item),
            benefit: sum.benefit + self.benefit(item),
        })
    }

    /// A feasible solution; `upper_bound` is rounded up.
    pub fn solution(&self, choice: Vec<u32>, totals: Totals<T>, lambda: f64, bound: UpperBound) -> Solution {
        let benefit = totals.benefit.to_f64(self.benefit_unit);
        let reached = totals.benefit.to_f64_up(self.benefit_unit);
        let (upper_bound, optimal) = match bound {
            UpperBound::Met(bound) => (bound.max(reached), true),
            UpperBound::Open(bound) => (bound.max(reached), bound <= benefit),
        };
        let gap = if optimal { 0.0 } else { (upper_bound - benefit) / upper_bound };
        Solution {
            choice,
            cost: totals.cost.to_f64(self.cost_unit),
            benefit,
            upper_bound: Some(upper_bound),
            gap: Some(gap),
            lambda,
            feasible: true,
            optimal,
            shortfall: 0.0,
            steps: 0,
        }
    }

    /// The answer where even the cheapest choice exceeds the budget.
    pub fn infeasible(&self, choice: Vec<u32>) -> Solution {
        let totals = self.totals(&choice);
        Solution {
            cost: totals.cost.to_f64(self.cost_unit),
            benefit: totals.benefit.to_f64(self.benefit_unit),
            upper_bound: None,
            gap: None,
            lambda: f64::INFINITY,
            feasible: false,
            optimal: false,
            shortfall: excess(self.instance, &choice),
            choice,
            steps: 0,
        }
    }
}

/// By how much a choice exceeds the budget, on the finest grid there is: the budget may have lower bits than any cost.
fn excess(instance: &Instance, choice: &[u32]) -> f64 {
    let wide = |value| WideSum::floor(value, LOWEST_UNIT);
    let costs = instance.classes().zip(choice).map(|(class, &index)| wide(class[index as usize].cost));
    (costs.fold(WideSum::ZERO, |sum, cost| sum + cost) - wide(instance.budget())).to_f64(LOWEST_UNIT)
}

/// The cheapest item of each class; of equally cheap ones the best, then the first.
pub(crate) fn cheapest(instance: &Instance) -> Vec<u32> {
    instance.classes().map(cheapest_of).collect()
}

fn cheapest_of(class: &[Item]) -> u32 {
    let mut best = 0;
    for (i, item) in class.iter().enumerate().skip(1) {
        let so_far: Item = class[best];
        if item.cost < so_far.cost || (item.cost == so_far.cost && item.benefit > so_far.benefit) {
            best = i;
        }
    }
    best as u32
}
