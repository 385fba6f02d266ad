//! A hundred thousand tiny knapsacks against every choice there is, the greedy against a twin without any cleverness,
//! cuts at every step, and the gaps that are claimed.

use std::cmp::Ordering;
use std::ops::Range;

use lod_budget::knapsack::{Effort, Instance, Item, Solution, capped, exact, greedy, greedy_within};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

#[path = "../benches/knapsack_exactness/mod.rs"]
mod knapsack_exactness;

/// Amounts as integers; the instance has them divided by `unit`, a power of two.
#[derive(Clone, Debug)]
struct Whole {
    unit: f64,
    budget: i128,
    classes: Vec<Vec<[i128; 2]>>,
}

impl Whole {
    fn instance(&self) -> Instance {
        let real = |amount: i128| amount as f64 / self.unit;
        let item = |&[cost, benefit]: &[i128; 2]| Item { cost: real(cost), benefit: real(benefit) };
        let classes = self.classes.iter().map(|class| class.iter().map(item).collect::<Vec<_>>());
        Instance::new(real(self.budget), classes).expect("amounts are finite and not negative")
    }

    fn sums(&self, choice: &[u32]) -> [i128; 2] {
        let chosen = self.classes.iter().zip(choice).map(|(class, &i)| class[i as usize]);
        chosen.fold([0, 0], |sum, item| [sum[0] + item[0], sum[1] + item[1]])
    }

    /// The most benefit within the budget, by trying every choice; `None` where none fits.
    fn best(&self) -> Option<i128> {
        let mut sums = vec![[0, 0]];
        for class in &self.classes {
            let with = |sum: [i128; 2]| class.iter().map(move |item| [sum[0] + item[0], sum[1] + item[1]]);
            sums = sums.into_iter().flat_map(with).collect();
        }
        sums.iter().filter(|sum| sum[0] <= self.budget).map(|sum| sum[1]).max()
    }

    fn least(&self) -> i128 {
        self.classes.iter().map(|class| class.iter().map(|item| item[0]).min().unwrap_or(0)).sum()
    }

    /// What must hold of every answer, however early it was cut.
    fn check(&self, solution: &Solution, best: Option<i128>) -> i128 {
        let [cost, benefit] = self.sums(&solution.choice);
        assert_eq!(solution.choice.len(), self.classes.len());
        assert_eq!(
            [solution.cost, solution.benefit],
            [cost, benefit].map(|sum| sum as f64 / self.unit),
            "{self:?}"
        );
        assert_eq!(solution.feasible, best.is_some(), "{self:?}");
        let Some(best) = best else {
            assert_eq!(
                (cost, solution.optimal, solution.upper_bound),
                (self.least(), false, None),
                "{self:?}"
            );
            return benefit;
        };
        let bound = solution.upper_bound.expect("a feasible answer has a bound");
        assert!(cost <= self.budget, "over budget: {self:?}");
        assert!(bound * self.unit >= best as f64, "{solution:?}: bound too low for {best}: {self:?}");
        assert!(!solution.optimal || benefit as f64 == best as f64, "not optimal: {self:?}");
        assert!(solution.gap.is_some_and(|gap| (0.0..=1.0).contains(&gap)), "{self:?}");
        benefit
    }

    /// Every solver, cut and uncut.
    fn check_solvers(&self, random: &mut Pcg64) {
        let (instance, best) = (self.instance(), self.best());
        let textbook = self.check(&greedy_within(&instance, Effort::TEXTBOOK), best);
        let repaired = self.check(&greedy(&instance), best);
        let proved = exact(&instance, &mut || false);
        assert_eq!(proved.optimal, best.is_some());
        let proved = self.check(&proved, best);
        let steps = random.random_range(0..40);
        for cut in [greedy_within(&instance, Effort { steps, ..Effort::default() }), capped(&instance, steps)]
        {
            assert!(cut.steps <= steps);
            self.check(&cut, best);
        }
        if let Some(best) = best {
            assert!(textbook <= repaired && repaired <= proved && best <= 2 * textbook, "{self:?}");
            assert_eq!(proved as f64, best as f64, "{self:?}");
        }
    }
}

/// One to six classes of one to five items, and a budget: often that of the cheapest choice, one unit less, or nothing.
fn tiny(random: &mut Pcg64, unit: f64, mut amount: impl FnMut(&mut Pcg64) -> i128) -> Whole {
    let classes = random.random_range(1..=6);
    let mut class = || {
        let items = random.random_range(1..=5);
        (0..items).map(|_| [amount(random), amount(random)]).collect()
    };
    let classes = (0..classes).map(|_| class()).collect();
    let mut whole = Whole { unit, budget: 0, classes };
    let most: i128 =
        whole.classes.iter().map(|class| class.iter().map(|item| item[0]).max().unwrap_or(0)).sum();
    let (least, extra) = (whole.least(), most - whole.least());
    // Rounded to what an f64 holds, downwards.
    let part = |share: f64| on_f64(least + (extra as f64 * share) as i128);
    whole.budget = match random.random_range(0..8) {
        0 => on_f64(least),
        1 => on_f64((least - 1).max(0)),
        2 => 0,
        _ => part(random.random_range(0.0..1.1)),
    };
    whole
}

/// The largest number of 53 digits that is not above.
fn on_f64(amount: i128) -> i128 {
    let beyond = (128 - amount.leading_zeros()).saturating_sub(53);
    amount >> beyond << beyond
}

fn check_tiny(seeds: Range<u64>, unit: f64, amount: impl Fn(&mut Pcg64) -> i128) {
    for seed in seeds {
        let mut random = Pcg64::seed_from_u64(seed);
        let whole = tiny(&mut random, unit, &amount);
        whole.check_solvers(&mut random);
    }
}

/// Zero costs, duplicates, equal slopes, dominated items and dents in the hull come up all the time.
#[test]
fn small_integers() {
    check_tiny(0..50_000, 1.0, |random| random.random_range(0..10));
}

/// From 2⁻²⁰ to 2⁴⁰, about 1e-6 to 1e12, evenly over the magnitudes; one in eight is nothing.
#[test]
fn six_orders_below_one_and_twelve_above() {
    check_tiny(0..25_000, (1u64 << 40) as f64, |random| {
        let digits = random.random_range(1i128..1 << 20);
        if random.random_range(0..8) == 0 { 0 } else { digits << random.random_range(1..60) }
    });
}

/// Sums take more than 128 bits with their margins.
#[test]
fn ranges_beyond_any_machine_integer() {
    check_tiny(0..10_000, (1u64 << 60) as f64, |random| {
        random.random_range(1i128..1 << 20) << random.random_range(0..102)
    });
}

/// Benefits that are nearly the costs: slopes lie so close that repair and search have much to choose from.
#[test]
fn strongly_correlated() {
    for seed in 0..20_000 {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut whole = tiny(&mut random, 1.0, |random| random.random_range(0..1000));
        for item in whole.classes.iter_mut().flatten() {
            item[1] = item[0] + item[1] % 8;
        }
        whole.check_solvers(&mut random);
    }
}

/// The textbook's greedy as it is told: no hulls but the steepest item to go to, no sorting but the steepest step next.
struct Twin<'a> {
    whole: &'a Whole,
    /// Items that fit beside the cheapest of all others, by class.
    fitting: Vec<Vec<u32>>,
}

impl<'a> Twin<'a> {
    fn new(whole: &'a Whole) -> Self {
        let room = whole.budget - whole.least();
        let fitting = whole.classes.iter().map(|class| {
            let least = class.iter().map(|item| item[0]).min().unwrap_or(0);
            (0..class.len() as u32).filter(|&i| class[i as usize][0] - least <= room).collect()
        });
        Self { whole, fitting: fitting.collect() }
    }

    fn cheapest(&self) -> Vec<u32> {
        let key = |class: &[[i128; 2]], i: u32| (class[i as usize][0], -class[i as usize][1], i);
        let cheapest =
            |class: &Vec<[i128; 2]>| (0..class.len() as u32).min_by_key(|&i| key(class, i)).unwrap_or(0);
        self.whole.classes.iter().map(cheapest).collect()
    }

    /// From an item of a class to the one that the steepest step leads to, of equally steep ones the nearest, then the
    /// first.
    fn next(&self, class: usize, from: u32) -> Option<u32> {
        let items = &self.whole.classes[class];
        let step = |to: u32| difference(items[from as usize], items[to as usize]);
        let onward = self.fitting[class].iter().copied().filter(|&to| step(to)[0] > 0 && step(to)[1] > 0);
        let order =
            |&a: &u32, &b: &u32| steeper(step(a), step(b)).then(step(a)[0].cmp(&step(b)[0])).then(a.cmp(&b));
        onward.min_by(order)
    }

    /// Takes steps from `choice`, always the steepest of those that classes may take next, in passing over what does
    /// not fit. Returns the first that did not.
    fn climb(&self, choice: &mut [u32], mut closed: Vec<bool>) -> Option<(usize, u32)> {
        let mut critical = None;
        loop {
            let open = (0..choice.len()).filter(|&class| !closed[class]);
            let steps = open.filter_map(|class| Some((class, self.next(class, choice[class])?)));
            let step = |&(class, to): &(usize, u32)| {
                let items = &self.whole.classes[class];
                difference(items[choice[class] as usize], items[to as usize])
            };
            let Some((class, to)) = steps.min_by(|a, b| steeper(step(a), step(b)).then(a.0.cmp(&b.0))) else {
                return critical;
            };
            let cost = self.whole.sums(choice)[0] + step(&(class, to))[0];
            if cost <= self.whole.budget {
                choice[class] = to;
            } else {
                closed[class] = true;
                critical = critical.or(Some((class, to)));
            }
        }
    }

    fn solve(&self) -> Vec<u32> {
        let none = vec![false; self.whole.classes.len()];
        let mut filled = self.cheapest();
        let Some((class, to)) = self.climb(&mut filled, none.clone()) else { return filled };
        let mut rival = self.cheapest();
        rival[class] = to;
        self.climb(&mut rival, none);
        if self.whole.sums(&rival)[1] > self.whole.sums(&filled)[1] { rival } else { filled }
    }
}

fn difference(from: [i128; 2], to: [i128; 2]) -> [i128; 2] {
    [to[0] - from[0], to[1] - from[1]]
}

/// Steeper steps first: benefit per cost, by cross-multiplication.
fn steeper(a: [i128; 2], b: [i128; 2]) -> Ordering {
    (b[1] * a[0]).cmp(&(a[1] * b[0]))
}

fn equals_twin(whole: &Whole) {
    let fast = greedy_within(&whole.instance(), Effort::TEXTBOOK);
    if fast.feasible {
        let slow = Twin::new(whole).solve();
        assert_eq!(fast.choice, slow, "{whole:?}");
        assert_eq!(whole.sums(&fast.choice), [fast.cost, fast.benefit].map(|sum| (sum * whole.unit) as i128));
    }
}

#[test]
fn the_greedy_is_the_textbooks_in_levels_cost_and_benefit() {
    for seed in 0..20_000 {
        let mut random = Pcg64::seed_from_u64(seed);
        equals_twin(&tiny(&mut random, 1.0, |random| random.random_range(0..10)));
        equals_twin(&tiny(&mut random, 1024.0, |random| random.random_range(0..1 << 30)));
    }
}

#[test]
fn the_greedy_is_the_textbooks_for_hundreds_of_objects() {
    for seed in 0..20 {
        let instance = knapsack_exactness::instance(150, seed);
        let unit = (1u64 << 30) as f64;
        let whole = |amount: f64| (amount * unit) as i128;
        let classes =
            instance.classes().map(|class| class.iter().map(|i| [i.cost, i.benefit].map(whole)).collect());
        equals_twin(&Whole { unit, budget: whole(instance.budget()), classes: classes.collect() });
    }
}

#[test]
fn cut_at_any_step_the_answer_holds() {
    let instance = knapsack_exactness::instance(30, 7);
    let best = exact(&instance, &mut || false);
    let uncut = greedy(&instance);
    for steps in (0..400).chain((400..uncut.steps + 2000).step_by(97)) {
        let effort = Effort { steps, ..Effort::default() };
        for cut in [greedy_within(&instance, effort), capped(&instance, steps)] {
            assert!(cut.feasible && cut.cost <= instance.budget() && cut.steps <= steps);
            assert!(cut.benefit <= best.benefit && cut.upper_bound >= Some(best.benefit));
            assert!(!cut.optimal || cut.benefit == best.benefit);
        }
        assert_eq!(greedy_within(&instance, effort), greedy_within(&instance, effort));
    }
    assert_eq!(greedy_within(&instance, Effort { steps: uncut.steps, ..Effort::default() }), uncut);
    assert_eq!(capped(&instance, u64::MAX), best);
}

/// Seen in a search that was cut before the greedy's second step: what the relaxation takes had not been looked at.
#[test]
fn a_cut_before_the_relaxation_claims_nothing() {
    let classes: [&[(f64, f64)]; 3] = [&[(6.0, 8.0), (5.0, 4.0)], &[(3.0, 6.0), (6.0, 7.0)], &[(0.0, 9.0)]];
    let classes = classes.map(|class| class.iter().copied().map(Item::from).collect::<Vec<_>>());
    let instance = Instance::new(12.0, classes).expect("a valid instance");
    for steps in 0..9 {
        let cut = capped(&instance, steps);
        assert!(cut.upper_bound >= Some(24.0) && (!cut.optimal || cut.benefit == 24.0), "{cut:?}");
    }
}

#[test]
fn a_steep_step_after_the_cut_leaves_a_finite_bound() {
    let classes =
        [[(0.0, 0.0), (5e-324, 1e300)], [(0.0, 0.0), (1e300, 1.0)]].map(|class| class.map(Item::from));
    let instance = Instance::new(1e300, classes).expect("finite amounts");
    let cut = greedy_within(&instance, Effort { steps: 0, ..Effort::default() });
    assert!(
        !cut.optimal && cut.upper_bound.is_some_and(f64::is_finite) && cut.gap.is_some_and(|gap| gap < 1.0)
    );
    assert_eq!(greedy(&instance).choice, [1, 0], "5e-324 is too much beside 1e300");
}

#[test]
fn the_gaps_that_are_claimed() {
    assert!(knapsack_exactness::gap(1_000, 40) <= 1e-4);
    assert!(knapsack_exactness::gap(10_000, 4) <= 1e-6);
    assert_eq!(knapsack_exactness::small_exact(16), 1.0);
    assert!(knapsack_exactness::proved(100, 100) >= 0.85);
}
