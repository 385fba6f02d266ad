//! The knapsack solvers against exhaustive search, and proofs of hard instances.

use lod_budget::knapsack::{Instance, Item, Solution, exact, greedy};
use proptest::prelude::*;

/// The best choice by trying all of them, summed in integers: amounts are multiples of `unit`.
struct Exhaustive {
    benefit: Option<i128>,
    least_cost: i128,
}

fn exhaustive(instance: &Instance, units: f64) -> Exhaustive {
    let whole = |value: f64| {
        let scaled = value * units;
        assert!(scaled.fract() == 0.0 && scaled < 1e30, "{value} is not on the test's grid");
        scaled as i128
    };
    let mut sums = vec![(0i128, 0i128)];
    for class in instance.classes() {
        sums = sums
            .iter()
            .flat_map(|&(cost, benefit)| {
                class.iter().map(move |i| (cost + whole(i.cost), benefit + whole(i.benefit)))
            })
            .collect();
    }
    let budget = whole(instance.budget());
    Exhaustive {
        benefit: sums.iter().filter(|sum| sum.0 <= budget).map(|sum| sum.1).max(),
        least_cost: sums.iter().map(|sum| sum.0).min().unwrap_or(0),
    }
}

/// What must hold of any solver's answer.
fn check(
    instance: &Instance,
    solution: &Solution,
    truth: &Exhaustive,
    units: f64,
) -> Result<(), TestCaseError> {
    let chosen: Vec<Item> =
        instance.classes().zip(&solution.choice).map(|(class, &i)| class[i as usize]).collect();
    prop_assert_eq!(chosen.len(), instance.len());
    let exact_sum =
        |amount: fn(&Item) -> f64| chosen.iter().map(|item| (amount(item) * units) as i128).sum::<i128>();
    let (cost, benefit) = (exact_sum(|item| item.cost), exact_sum(|item| item.benefit));
    prop_assert_eq!(solution.cost, cost as f64 / units);
    prop_assert_eq!(solution.benefit, benefit as f64 / units);
    prop_assert_eq!(solution.feasible, truth.benefit.is_some());
    let Some(best) = truth.benefit else {
        prop_assert_eq!(cost, truth.least_cost);
        prop_assert_eq!((solution.upper_bound, solution.gap, solution.optimal), (None, None, false));
        prop_assert_eq!(solution.shortfall, (cost - (instance.budget() * units) as i128) as f64 / units);
        return Ok(());
    };
    prop_assert!(cost as f64 <= instance.budget() * units);
    prop_assert!(benefit <= best && best <= 2 * benefit);
    let (bound, gap) = (solution.upper_bound.unwrap_or(-1.0), solution.gap.unwrap_or(-1.0));
    prop_assert!(bound * units >= best as f64);
    prop_assert!((0.0..1.0).contains(&gap));
    prop_assert_eq!(solution.optimal, gap == 0.0);
    prop_assert!(!solution.optimal || benefit as f64 >= best as f64);
    prop_assert_eq!(solution.shortfall, 0.0);
    Ok(())
}

fn check_both(instance: &Instance, units: f64) -> Result<(), TestCaseError> {
    let truth = exhaustive(instance, units);
    check(instance, &greedy(instance), &truth, units)?;
    let proved = exact(instance, &mut || false);
    check(instance, &proved, &truth, units)?;
    prop_assert!(proved.optimal || !proved.feasible);
    prop_assert_eq!(proved.benefit, truth.benefit.map_or(proved.benefit, |best| best as f64 / units));
    Ok(())
}

/// Small integers: zeros, duplicates, equal slopes, dominated and non-concave items all come up often.
fn small_class() -> impl Strategy<Value = Vec<Item>> {
    prop::collection::vec(
        (0u32..12, 0u32..12).prop_map(|(cost, benefit)| Item { cost: cost.into(), benefit: benefit.into() }),
        1..6,
    )
}

/// Multiples of 2^-40 from about 1e-6 to about 1e12, spread over the magnitudes.
fn wide_amount() -> impl Strategy<Value = f64> {
    (20u32..80, 1u64..1 << 20)
        .prop_map(|(shift, mantissa)| (u128::from(mantissa) << shift >> 20) as f64 / GRID)
}

const GRID: f64 = (1u64 << 40) as f64;

fn wide_class() -> impl Strategy<Value = Vec<Item>> {
    prop::collection::vec((wide_amount(), wide_amount()).prop_map(Item::from), 1..5)
}

fn cheapest_cost(classes: &[Vec<Item>]) -> f64 {
    classes.iter().map(|class| class.iter().map(|item| item.cost).fold(f64::INFINITY, f64::min)).sum()
}

fn build(budget: f64, classes: &[Vec<Item>]) -> Instance {
    Instance::new(budget, classes).expect("strategies yield valid instances")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn small_instances_equal_exhaustive_search(classes in prop::collection::vec(small_class(), 0..7), budget in 0u32..50) {
        check_both(&build(budget.into(), &classes), 1.0)?;
    }

    #[test]
    fn the_edge_of_feasibility_is_sharp(classes in prop::collection::vec(small_class(), 1..6), offset in -1i32..=1) {
        let budget = (cheapest_cost(&classes) + f64::from(offset)).max(0.0);
        check_both(&build(budget, &classes), 1.0)?;
    }

    #[test]
    fn wide_ranges_equal_exhaustive_search(classes in prop::collection::vec(wide_class(), 1..7), budget in wide_amount()) {
        check_both(&build(budget, &classes), GRID)?;
    }

    #[test]
    fn one_class_takes_its_best_fitting_item(class in wide_class(), budget in wide_amount()) {
        check_both(&build(budget, &[class]), GRID)?;
    }
}

/// A small generator, so that the instances never change (G. L. Steele, D. Lea, C. H. Flood, "Fast splittable
/// pseudorandom number generators", 2014).
struct SplitMix(u64);

impl SplitMix {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number from 1 to `range`.
    fn whole(&mut self, range: f64) -> f64 {
        1.0 + (self.unit() * range).floor()
    }
}

/// Classes of `items` items each; the budget lies half-way between the cheapest and the dearest choice.
fn generate(
    classes: usize,
    items: usize,
    mut item: impl FnMut(&mut SplitMix, usize) -> (f64, f64),
) -> Instance {
    let mut random = SplitMix(classes as u64);
    let classes: Vec<Vec<Item>> =
        (0..classes).map(|_| (0..items).map(|i| Item::from(item(&mut random, i))).collect()).collect();
    let dearest: f64 =
        classes.iter().map(|class| class.iter().map(|item| item.cost).fold(0.0, f64::max)).sum();
    build(((dearest + cheapest_cost(&classes)) / 2.0).floor(), &classes)
}

/// Proves the instance and holds the proof against the contract; returns the benefit.
fn prove(instance: &Instance) -> f64 {
    let (quick, proved) = (greedy(instance), exact(instance, &mut || false));
    assert!(proved.optimal && proved.feasible && proved.gap == Some(0.0));
    assert!(proved.cost <= instance.budget());
    assert!(quick.benefit <= proved.benefit && Some(proved.benefit) <= quick.upper_bound);
    let sum: f64 = instance.classes().zip(&proved.choice).map(|(class, &i)| class[i as usize].benefit).sum();
    assert!((sum - proved.benefit).abs() <= 1e-9 * sum);
    proved.benefit
}

#[test]
fn the_1993_counterexample_is_proved() {
    let first = [(0.1136, 0.4652), (1.7599, 5.0387), (18.8952, 34.5056), (346.7490, 618.5195)];
    let second = [(0.1086, 0.3795), (0.3057, 0.6621), (5.2287, 2.1120), (21.4700, 6.1775)];
    let instance = build(346.8607, &[first.map(Item::from).to_vec(), second.map(Item::from).to_vec()]);
    assert_eq!(format!("{:.2}", greedy(&instance).benefit), "618.90");
    assert_eq!(format!("{:.2}", prove(&instance)), "618.90");
}

#[test]
fn uncorrelated_and_weakly_correlated_instances_of_400_classes_are_proved() {
    for range in [1e3, 1e12] {
        prove(&generate(400, 10, |random, _| (random.whole(range), random.whole(range))));
        prove(&generate(400, 10, |random, _| {
            let cost = random.whole(range);
            (cost, (cost + (random.unit() - 0.5) * range / 5.0).max(0.0).floor())
        }));
    }
}

#[test]
fn subset_sums_meet_the_budget_exactly() {
    for range in [1e3, 1e6, 1e12] {
        let instance = generate(100, 5, |random, _| {
            let cost = random.whole(range);
            (cost, cost)
        });
        assert_eq!(prove(&instance), instance.budget());
    }
}

#[test]
fn constant_surcharges_are_proved() {
    let instance = generate(400, 5, |random, i| {
        let cost = random.whole(1e9);
        if i == 0 { (0.0, 0.0) } else { (cost, cost + 10.0) }
    });
    assert_eq!(
        prove(&instance),
        instance.budget() + 4000.0,
        "every class takes a surcharge, and the budget is spent"
    );
}

#[test]
fn levels_of_detail_are_proved() {
    let mut triangles = 0.0f64;
    let mut weight = 0.0;
    prove(&generate(400, 8, |random, level| {
        if level == 0 {
            triangles = 1000.0 + random.whole(200_000.0);
            weight = 1.0 / (1e-3 + random.unit().powi(2));
        } else {
            triangles = (triangles / 2.0).ceil();
        }
        (triangles, weight * (1.0 - 0.5 / triangles))
    }));
}

#[test]
fn an_exhausted_patience_leaves_an_honest_bound() {
    let instance = generate(60, 6, |random, _| {
        let cost = random.whole(1e12);
        (cost, cost + random.unit() * 20.0)
    });
    let mut polls = 0;
    let stopped = exact(&instance, &mut || {
        polls += 1;
        polls > 40
    });
    assert!(!stopped.optimal && stopped.feasible && stopped.cost <= instance.budget());
    assert!(stopped.upper_bound.is_some_and(|bound| bound > stopped.benefit));
    assert!(stopped.benefit >= greedy(&instance).benefit);
}
