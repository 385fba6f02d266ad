//! How near the knapsack's answers are to the optimum: pure functions of a number of classes and a number of instances.
//!
//! `#[path = "knapsack_exactness/mod.rs"] mod knapsack_exactness;` includes it.
//!
//! Instances are classes of five levels whose costs shrink by a random factor from each to the next and whose benefits
//! shrink by a power of it, so that nearly all levels are on the hull and slopes spread over decades; the budget lies
//! anywhere between 5 % and 90 % of the way from the least cost to the most. Amounts are multiples of 2⁻³⁰, so that
//! sums of a few are exact.

use lod_budget::knapsack::{Instance, Item, Solution, capped, greedy};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Steps within which a proof counts for [`proved`].
pub const CAP_STEPS: u64 = 100_000;

/// The worst certified gap of [`greedy`] over instances of `classes` classes, one per seed from 0: (bound − benefit) ÷
/// bound, the whole benefit and not only that above the cheapest choice.
pub fn gap(classes: usize, seeds: u64) -> f64 {
    solved(classes, seeds, greedy).filter_map(|solution| solution.gap).fold(0.0, f64::max)
}

/// The share of instances of 1 to 16 classes in which [`capped`] finds what exhaustive search finds.
pub fn small_exact(seeds: u64) -> f64 {
    let instances = (0..seeds).map(|seed| instance(1 + seed as usize % 16, seed));
    let equal = instances.filter(|i| capped(i, CAP_STEPS).benefit == exhaustive(i)).count();
    equal as f64 / seeds as f64
}

/// The share of instances that [`capped`] proves within [`CAP_STEPS`].
pub fn proved(classes: usize, seeds: u64) -> f64 {
    solved(classes, seeds, |i| capped(i, CAP_STEPS)).filter(|solution| solution.optimal).count() as f64
        / seeds as f64
}

fn solved(
    classes: usize,
    seeds: u64,
    solve: impl Fn(&Instance) -> Solution,
) -> impl Iterator<Item = Solution> {
    (0..seeds).map(move |seed| solve(&instance(classes, seed)))
}

/// The instance of a seed.
pub fn instance(classes: usize, seed: u64) -> Instance {
    let mut random = Pcg64::seed_from_u64(seed);
    let classes: Vec<[Item; 5]> = (0..classes).map(|_| levels(&mut random)).collect();
    let sum = |level: usize| classes.iter().map(|class| class[level].cost).sum::<f64>();
    let budget = on_grid(sum(4) + random.random_range(0.05..0.9) * (sum(0) - sum(4)));
    Instance::new(budget, classes).expect("amounts are finite and not negative")
}

/// Levels of an object, the finest first: costs in microseconds, benefits in square pixels.
fn levels(random: &mut Pcg64) -> [Item; 5] {
    let (mut cost, mut benefit) =
        (10f64.powf(random.random_range(0.0..2.0)), 10f64.powf(random.random_range(1.0..5.0)));
    let power = random.random_range(0.15..0.6);
    [(); 5].map(|()| {
        let level = Item { cost: on_grid(cost), benefit: on_grid(benefit) };
        let share: f64 = random.random_range(0.2..0.6);
        (cost, benefit) = (cost * share, benefit * share.powf(power));
        level
    })
}

fn on_grid(amount: f64) -> f64 {
    (amount * GRID).round() / GRID
}

const GRID: f64 = (1u64 << 30) as f64;

/// The best benefit within the budget among all choices. Those of half of the classes are listed by cost, each with the
/// best benefit so far; the other half's look up what they leave.
fn exhaustive(instance: &Instance) -> f64 {
    let classes: Vec<&[Item]> = instance.classes().collect();
    let (first, second) = classes.split_at(classes.len() / 2);
    let mut held = all_choices(first);
    held.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let mut best = 0.0;
    for sum in &mut held {
        best = sum.benefit.max(best);
        sum.benefit = best;
    }
    let joined = all_choices(second).into_iter().filter_map(|sum| {
        let fitting = held.partition_point(|other| sum.cost + other.cost <= instance.budget());
        Some(sum.benefit + held[..fitting].last()?.benefit)
    });
    joined.fold(0.0, f64::max)
}

fn all_choices(classes: &[&[Item]]) -> Vec<Item> {
    classes.iter().fold(vec![Item::default()], |sums, class| {
        let with =
            |sum: Item, item: &Item| Item { cost: sum.cost + item.cost, benefit: sum.benefit + item.benefit };
        sums.iter().flat_map(|&sum| class.iter().map(move |item| with(sum, item))).collect()
    })
}
