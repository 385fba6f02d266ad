//! The optimum, proved: deepening on the gap.
//!
//! At the critical price λ every class has a best item, the base, and every other item a *loss*. What a choice lacks to
//! the Lagrangian bound, its gap, is the sum of its losses plus λ times the room it leaves: nothing in it is negative.
//! So the choices with a gap up to some level are few, and if any exist, the best of them is the optimum. Levels rise
//! until one does.
//!
//! - [`prices`]: base, losses and the bound. [`surcharge`]: a tighter bound where benefit = cost + a few constants.
//! - [`group`]: lists of partial choices with dominance, pruned by [`relief`], the linear relaxation of the classes
//!   outside.
//! - Two lists meet in the middle; when they are full, a third is tried against both (enough where choices that meet
//!   the bound abound, as in subset sums), and [`quarters`] proves a level in the memory of four short lists.

mod group;
mod prices;
mod quarters;
mod relief;
mod surcharge;

use self::group::{Group, Halt, best_pair};
use self::prices::{PricedClass, Prices};
use self::quarters::{Half, meet};
use self::relief::{Edges, Relief};
use super::dyadic::{Number, WideSum};
use super::greedy::{Effort, Quick, quick};
use super::ledger::{Grids, Ledger, Totals, UpperBound};
use super::meter::Meter;
use super::{Instance, Solution};

/// Solves to proved optimality, or as far as `stop` and a gigabyte of memory allow.
///
/// `stop` is polled several times a second and ends the search when it returns true; the best known choice then comes
/// back with an honest upper bound and `optimal: false`. The same happens, without being asked, where a level's choices
/// are too many to hold; polls never change what is found otherwise.
///
/// Milliseconds for uncorrelated, weakly correlated and level-of-detail instances of 400 classes; seconds for subset
/// sums and constant surcharges up to 1e12. Exponential in the root of (level · choices per unit of loss) at worst:
/// hardest are large amounts whose benefits differ from the costs by comparatively little, on no common grid.
///
/// After D. Pisinger, "A minimal algorithm for the multiple-choice knapsack problem", 1995 (expanding core, dominance,
/// linear bounds of states), and E. Horowitz, S. Sahni, "Computing partitions with applications to the knapsack
/// problem", 1974 (two lists). Departs from both by bounding the gap instead of starting from an incumbent.
pub fn exact(instance: &Instance, stop: &mut dyn FnMut() -> bool) -> Solution {
    solve(instance, Capacity::default(), u64::MAX, stop)
}

/// [`exact`], cut after `steps`: for a frame that has a hundred classes or so and time for a proof.
///
/// A step is a hull step looked at or a partial choice made, some ten nanoseconds each; the count, and so the answer,
/// is the same on every machine. Hulls, their order and the losses at λ are not counted: O(n log n) for n items.
/// However few the steps, the answer is within the budget and its bound holds, and it is no worse than that of
/// [`greedy_within`](super::greedy_within) as many. Of a hundred level-of-detail classes of five, 100 000 steps prove
/// more than nine instances in ten.
pub fn capped(instance: &Instance, steps: u64) -> Solution {
    solve(instance, Capacity::default(), steps, &mut || false)
}

/// The greedy, then the search with the steps that it left over.
fn solve(instance: &Instance, capacity: Capacity, steps: u64, stop: &mut dyn FnMut() -> bool) -> Solution {
    let quick = quick(instance, Effort { steps, ..Effort::default() });
    let grids = Grids::of(instance);
    let meter = &mut Meter::new(steps - quick.solution.steps, stop);
    match grids.bits() {
        _ if quick.relaxation.is_none() => quick.solution,
        0..=64 => search(&Ledger::<i64>::new(instance, grids), quick, capacity, meter),
        65..=128 => search(&Ledger::<i128>::new(instance, grids), quick, capacity, meter),
        _ => search(&Ledger::<WideSum>::new(instance, grids), quick, capacity, meter),
    }
}

/// What the search may hold and how long it may try.
#[derive(Clone, Copy, Debug)]
struct Capacity {
    /// States of 32 bytes that each of the two lists may hold, and each of the four.
    list: usize,
    /// States of the third list before and after a proof in four lists was tried: each costs a pass over the other two.
    third: [usize; 2],
    /// Combinations of one half that may be held for the other to be streamed past.
    held: u64,
    /// Combinations worth streaming for a proof at once.
    eager: u64,
    /// Combinations worth streaming for the next level.
    patient: u64,
}

impl Default for Capacity {
    /// About a gigabyte, and minutes at the very worst.
    fn default() -> Self {
        Self { list: 1 << 21, third: [1 << 6, 1 << 12], held: 1 << 24, eager: 1 << 30, patient: 1 << 34 }
    }
}

/// The best choice so far and what is known about better ones.
struct Search<'a, T> {
    ledger: &'a Ledger<'a, T>,
    prices: Prices<T>,
    edges: Edges,
    choice: Vec<u32>,
    totals: Totals<T>,
    /// The largest gap of a choice better than the best.
    limit: f64,
    /// No choice has a benefit above this.
    bound: T,
    capacity: Capacity,
    /// The longest list of the last level.
    states: usize,
}

impl<T: Number> Search<'_, T> {
    /// Whether no choice reports a higher benefit.
    fn proved(&self) -> bool {
        let unit = self.ledger.benefit_unit;
        self.bound <= self.totals.benefit || self.bound.to_f64(unit) <= self.totals.benefit.to_f64(unit)
    }

    fn gap_to_beat(&self) -> f64 {
        self.prices.gap(self.totals.benefit + self.prices.benefit_step)
    }

    fn offer(&mut self, choice: Vec<u32>) {
        let totals = self.ledger.totals(&choice);
        if totals.cost <= self.ledger.budget && totals.benefit > self.totals.benefit {
            (self.choice, self.totals) = (choice, totals);
            self.limit = self.gap_to_beat();
        }
    }

    /// Looks at every choice with a gap up to `level`.
    ///
    /// Two lists grow towards each other, the shorter one first, and are joined after each class. Once one is full, a
    /// third list of the classes left is tried against both: complete where it holds all of them, else a search for a
    /// better choice.
    fn explore(&mut self, level: f64, meter: &mut Meter<'_>) -> Result<(), Halt> {
        let classes = std::mem::take(&mut self.prices.classes);
        let mut halves = [Group::new(), Group::new()];
        let mut sides = vec![Side::Open; classes.len()];
        let mut result = Ok(());
        for at in 0..classes.len() {
            if !self.matters(&classes[at], level) {
                break;
            }
            let side = usize::from(halves[1].states.len() < halves[0].states.len());
            sides[at] = [Side::Left, Side::Right][side];
            let relief = self.relief(|other| sides[other] != sides[at], meter);
            let (cap, list) = (self.cap(level), self.capacity.list);
            result = relief.and_then(|relief| {
                halves[side].extend(&self.prices, &classes[at], &relief, cap, list, meter)
            });
            if result.is_err() {
                sides[at] = Side::Open;
                break;
            }
            self.join(&halves, None);
        }
        if result == Err(Halt::Full) {
            result = self.sweep(&classes, &mut sides, &halves, level, self.capacity.third[0], meter);
        }
        if result == Err(Halt::Full) {
            result = self.quarters(&classes, f64::INFINITY, self.capacity.eager, meter);
        }
        if result == Err(Halt::Full) {
            result = self.quarters(&classes, level, self.capacity.patient, meter);
        }
        if result == Err(Halt::Full) {
            for side in sides.iter_mut().filter(|side| **side == Side::Third) {
                *side = Side::Open;
            }
            result = self.sweep(&classes, &mut sides, &halves, level, self.capacity.third[1], meter);
        }
        self.states = halves.iter().map(|half| half.states.len()).max().unwrap_or(1);
        self.prices.classes = classes;
        result
    }

    /// The gap above which nothing is of interest.
    fn cap(&self, level: f64) -> f64 {
        level.min(self.limit)
    }

    fn matters(&self, class: &PricedClass<T>, level: f64) -> bool {
        !self.proved() && class.alternatives[0].loss <= self.cap(level) * (1.0 + 1e-9)
    }

    /// What the classes that are `open` can give, a step for each of their hulls' edges.
    fn relief(&self, open: impl Fn(usize) -> bool, meter: &mut Meter<'_>) -> Result<Relief, Halt> {
        let edges = self.edges.len() as u64;
        if meter.spend(edges) {
            Ok(Relief::of(self.prices.lambda, &self.edges, open))
        } else {
            Err(Halt::Stopped)
        }
    }

    /// Joins both halves, around a state of the third list if given, and keeps the result where it is better.
    fn join(&mut self, halves: &[Group<T>; 2], third: Option<(&Group<T>, usize)>) {
        let middle =
            third.map_or(Totals { cost: T::ZERO, benefit: T::ZERO }, |(group, i)| group.states[i].totals());
        let Some((a, b)) = best_pair(&halves[0].states, &halves[1].states, self.prices.room - middle.cost)
        else {
            return;
        };
        let gain = halves[0].states[a].benefit + halves[1].states[b].benefit + middle.benefit;
        if self.prices.totals.benefit + gain > self.totals.benefit {
            let mut choice = self.prices.base.clone();
            halves[0].write(a, &mut choice);
            halves[1].write(b, &mut choice);
            if let Some((group, i)) = third {
                group.write(i, &mut choice);
            }
            self.offer(choice);
        }
    }

    fn sweep(
        &mut self,
        classes: &[PricedClass<T>],
        sides: &mut [Side],
        halves: &[Group<T>; 2],
        level: f64,
        tries: usize,
        meter: &mut Meter<'_>,
    ) -> Result<(), Halt> {
        let mut third = Group::new();
        let mut result = Ok(());
        for at in 0..classes.len() {
            if sides[at] != Side::Open || !self.matters(&classes[at], level) {
                continue;
            }
            sides[at] = Side::Third;
            let relief = self.relief(|other| sides[other] != Side::Third, meter);
            let cap = self.cap(level);
            result = relief
                .and_then(|relief| third.extend(&self.prices, &classes[at], &relief, cap, tries, meter));
            if result.is_err() {
                break;
            }
        }
        let mut order: Vec<usize> = (0..third.states.len()).collect();
        order.sort_by(|&a, &b| third.states[a].loss.total_cmp(&third.states[b].loss));
        for i in order {
            if third.states[i].loss > self.limit || self.proved() {
                break;
            }
            let pairs = halves.iter().map(|half| half.states.len() as u64).sum();
            if !meter.spend(pairs) {
                return Err(Halt::Stopped);
            }
            self.join(halves, Some((&third, i)));
        }
        if self.proved() { Ok(()) } else { result }
    }

    /// Looks at every choice with a gap up to `level` in the memory of four short lists.
    fn quarters(
        &mut self,
        classes: &[PricedClass<T>],
        level: f64,
        work_limit: u64,
        meter: &mut Meter<'_>,
    ) -> Result<(), Halt> {
        let matter = classes.iter().take_while(|class| self.matters(class, level)).count();
        let sides: Vec<usize> = (0..classes.len()).map(|at| if at < matter { at % 4 } else { 4 }).collect();
        let mut groups = [Group::new(), Group::new(), Group::new(), Group::new()];
        for at in 0..matter {
            let side = sides[at];
            let open = |other: usize| other > at || sides[other] != side;
            let relief = self.relief(open, meter)?;
            groups[side].extend(
                &self.prices,
                &classes[at],
                &relief,
                self.cap(level),
                self.capacity.list,
                meter,
            )?;
        }
        let [a, b, c, d] = &groups;
        let halves = [Half::new(a, b), Half::new(c, d)];
        let limit = self.cap(level) * (1.0 + 1e-9);
        let work: u64 = halves.iter().map(|half| half.count(limit)).sum();
        if work > work_limit || halves.iter().any(|half| half.count(limit / 2.0) > self.capacity.held) {
            return Err(Halt::Full);
        }
        for (held, streamed, floor) in [(0, 1, -1.0), (1, 0, limit / 2.0)] {
            let limit = limit.min(self.cap(level) * (1.0 + 1e-9));
            let floor = if floor < 0.0 { floor } else { limit / 2.0 };
            let to_beat = self.totals.benefit - self.prices.totals.benefit;
            let prices = self.prices.clone();
            meet(&prices, [&halves[held], &halves[streamed]], floor, limit, to_beat, meter, &mut |x, y| {
                let mut choice = self.prices.base.clone();
                for (pair, half) in [(x, &halves[held]), (y, &halves[streamed])] {
                    half.first.write(pair.at[0] as usize, &mut choice);
                    half.second.write(pair.at[1] as usize, &mut choice);
                }
                self.offer(choice);
                (self.totals.benefit - self.prices.totals.benefit, self.cap(level))
            })?;
        }
        self.settle(level);
        Ok(())
    }

    /// What is left once every choice with a gap up to `level` is known.
    fn settle(&mut self, level: f64) {
        let above = (level * (1.0 + 1e-10)).max(f64::MIN_POSITIVE);
        let rest = if level >= self.limit { self.totals.benefit } else { self.prices.benefit_at(above) };
        self.bound = self.bound.min(rest);
    }

    /// The number of states grows like the exponential of the level's root: this factor asks for about five times as
    /// many.
    fn growth(&self) -> f64 {
        let magnitude = (self.states.max(10) as f64).ln();
        ((magnitude + 5f64.ln()) / magnitude).powi(2).min(2.0)
    }

    /// The largest gap up to `level`, and worth a look, that a choice can have.
    fn next_level(&self, level: f64) -> f64 {
        let beyond = self.prices.benefit_at(level.min(self.limit) * (1.0 + 1e-10));
        self.prices.gap(beyond + self.prices.benefit_step).max(self.prices.gap(self.bound))
    }
}

/// Where a class is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    Open,
    Left,
    Right,
    Third,
}

fn search<T: Number>(
    ledger: &Ledger<'_, T>,
    quick: Quick,
    capacity: Capacity,
    meter: &mut Meter<'_>,
) -> Solution {
    let Some(relaxation) = quick.relaxation else { return quick.solution };
    let prices = Prices::new(ledger, relaxation);
    let edges = Edges::of(&prices.classes);
    let totals = ledger.totals(&quick.solution.choice);
    let linear = prices.benefit_at(0.0);
    let bound = surcharge::bound(&prices).map_or(linear, |bound| bound.min(linear));
    let choice = quick.solution.choice;
    let mut search = Search { ledger, prices, edges, choice, totals, limit: 0.0, bound, capacity, states: 1 };
    search.limit = search.gap_to_beat();
    let mut level = search.next_level(first_level(&search));
    while !search.proved() {
        if search.explore(level, meter).is_err() {
            break;
        }
        search.settle(level);
        level = search.next_level(level * search.growth());
    }
    let bound = search.bound.to_f64_up(ledger.benefit_unit);
    let bound = if search.proved() { UpperBound::Met(bound) } else { UpperBound::Open(bound) };
    let solution = ledger.solution(search.choice, search.totals, quick.solution.lambda, bound);
    Solution { steps: quick.solution.steps + meter.made(), ..solution }
}

fn first_level<T: Number>(search: &Search<'_, T>) -> f64 {
    let mut losses: Vec<f64> =
        search.prices.classes.iter().flat_map(|class| class.alternatives.iter().map(|a| a.loss)).collect();
    losses.sort_by(f64::total_cmp);
    let few = losses.get(20).copied().unwrap_or(f64::MAX);
    let benefit = search.totals.benefit.to_f64(search.ledger.benefit_unit);
    few.max(benefit * f64::EPSILON / 2.0).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::super::Item;
    use super::*;
    use proptest::prelude::*;

    fn best_of_all(classes: &[Vec<(u32, u32)>], budget: u32) -> Option<u32> {
        let mut sums = vec![(0, 0)];
        for class in classes {
            sums = sums.iter().flat_map(|&(c, b)| class.iter().map(move |&(d, e)| (c + d, b + e))).collect();
        }
        sums.into_iter().filter(|sum| sum.0 <= budget).map(|sum| sum.1).max()
    }

    /// Benefits close to the costs: all losses are small and all lists long.
    fn hard_class() -> impl Strategy<Value = Vec<(u32, u32)>> {
        prop::collection::vec((0u32..60, 0u32..6).prop_map(|(cost, extra)| (cost, cost + extra)), 1..5)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Lists of a few states send even small instances through the third list and the four lists.
        #[test]
        fn every_path_finds_the_optimum(
            classes in prop::collection::vec(hard_class(), 1..8),
            budget in 0u32..300,
            list in 1usize..40,
            third in 0usize..4,
            held in 0u64..100,
        ) {
            let items = classes.iter().map(|class| {
                class.iter().map(|&(cost, benefit)| Item { cost: cost.into(), benefit: benefit.into() }).collect::<Vec<_>>()
            });
            let instance = Instance::new(budget.into(), items).expect("a valid instance");
            let capacity = Capacity { list, third: [third, 4], held, eager: held, patient: 10 * held };
            let solution = solve(&instance, capacity, u64::MAX, &mut || false);
            let best = best_of_all(&classes, budget);
            prop_assert_eq!(solution.feasible, best.is_some());
            let Some(best) = best.map(f64::from) else { return Ok(()) };
            prop_assert!(solution.benefit <= best && solution.cost <= f64::from(budget));
            prop_assert!(solution.upper_bound.is_some_and(|bound| bound >= best));
            prop_assert!(!solution.optimal || solution.benefit == best);
        }
    }

    #[test]
    fn a_stopped_search_is_honest() {
        let class = |i: u32| {
            [0u32, 7, 13, 29]
                .map(|k| Item { cost: f64::from(k * i % 97), benefit: f64::from(k * i % 97) * 1.5 })
        };
        let instance = Instance::new(1001.5, (1..60).map(class)).expect("a valid instance");
        let stopped = solve(&instance, Capacity { list: 3, ..Capacity::default() }, u64::MAX, &mut || true);
        let proved = exact(&instance, &mut || false);
        assert!(proved.optimal);
        assert!(stopped.benefit <= proved.benefit && stopped.upper_bound >= Some(proved.benefit));
    }
}
