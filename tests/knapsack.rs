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
