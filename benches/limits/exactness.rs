//! The rows `gap_*`, `small_exact` and `n100_proved`: how good the answers are. Counts, not times: they repeat.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::knapsack_exactness;
use crate::ours::FrameSolver;
use crate::plan::{Plan, SEED};
use crate::report::Findings;

const INSTANCES: usize = 1_000;
/// Rows, and how many classes the instances have.
const GAPS: [(&str, usize); 3] = [("gap_1k", 1_000), ("gap_10k", 10_000), ("gap_100k", 100_000)];
/// Exhaustive search goes up to so many classes.
const SMALL: usize = 16;
const MEDIUM: usize = 100;
/// Above so many classes fewer instances are enough.
const MANY: usize = 10_000;
/// The frame loop's solver stops filling where little is left, to save passes.
const FRAME_SOLVER: &str = "The frame loop's solver: worst (bound − benefit) ÷ bound";

/// One level of a table: how true it is, and what it costs.
#[derive(Clone, Copy)]
pub struct Choice {
    pub value: f32,
    pub units: u64,
}

/// An instance of the knapsack: tables, and classes of a table and a weight.
pub struct Problem {
    pub tables: Vec<Vec<Choice>>,
    pub classes: Vec<(u32, f32)>,
    pub budget: u64,
}

/// What a solver says: a level for each class, and what no choice is better than.
pub struct Answer {
    pub choice: Vec<u8>,
    pub bound: f64,
}

impl Problem {
    /// At random: two to six levels, weights of three orders of magnitude, a budget anywhere on the way from the
    /// least to the most.
    fn random(dice: &mut Pcg64, classes: usize, tables: usize) -> Self {
        let tables: Vec<Vec<Choice>> = (0..tables).map(|_| table(dice)).collect();
        let weight = |dice: &mut Pcg64| 10f32.powf(dice.random_range(0.0f32..3.0));
        let class = |_| (dice.random_range(0..tables.len() as u32), weight(dice));
        let classes: Vec<(u32, f32)> = (0..classes).map(class).collect();
        let mut problem = Self { tables, classes, budget: 0 };
        let (least, most) = (problem.total(|levels| levels - 1), problem.total(|_| 0));
        problem.budget = least + ((most - least) as f64 * dice.random_range(0.05..0.95)) as u64;
        problem
    }

    fn total(&self, pick: fn(usize) -> usize) -> u64 {
        (0..self.classes.len()).map(|i| self.item(i, pick(self.levels(i).len())).0).sum()
    }

    /// The levels of a class, finest first.
    pub fn levels(&self, class: usize) -> &[Choice] {
        &self.tables[self.classes[class].0 as usize]
    }

    /// Cost and benefit of a level of a class.
    pub fn item(&self, class: usize, level: usize) -> (u64, f64) {
        let choice = self.levels(class)[level];
        (choice.units, f64::from(self.classes[class].1) * f64::from(choice.value))
    }

    fn sums(&self, choice: &[u8]) -> (u64, f64) {
        let items = choice.iter().enumerate().map(|(class, &level)| self.item(class, usize::from(level)));
        items.fold((0, 0.0), |sum, item| (sum.0 + item.0, sum.1 + item.1))
    }
}

fn table(dice: &mut Pcg64) -> Vec<Choice> {
    let levels = dice.random_range(2..=6);
    let mut units = dice.random_range(2_000.0f64..60_000.0);
    let mut missing = dice.random_range(0.001f32..0.02);
    let mut level = || {
        let choice = Choice { value: 1.0 - missing.min(0.99), units: 200 + units as u64 };
        units *= dice.random_range(0.2..0.6);
        missing *= dice.random_range(1.5f32..3.5);
        choice
    };
    (0..levels).map(|_| level()).collect()
}

pub fn measure(plan: &Plan, findings: &mut Findings) {
    for (row, classes) in GAPS.into_iter().filter(|(row, _)| plan.wants(row)) {
        let instances = plan.rounds(if classes > MANY { INSTANCES / 10 } else { INSTANCES });
        findings.row(row, Some(knapsack_exactness::gap(classes, instances as u64)));
        findings.note(row, format!("{instances} instances"));
        let name = format!("{classes} classes");
        findings.more(FRAME_SOLVER, &name, worst_gap(instances / 10, classes).ok());
    }
    if plan.wants("small_exact") {
        findings.row("small_exact", Some(knapsack_exactness::small_exact(INSTANCES as u64)));
        findings.more(
            FRAME_SOLVER,
            "share solved exactly, 1 to 16 classes",
            Some(share(INSTANCES, is_exact)),
        );
    }
    if plan.wants("n100_proved") {
        findings.row("n100_proved", Some(knapsack_exactness::proved(MEDIUM, INSTANCES as u64)));
        findings.note("n100_proved", format!("within {} steps", knapsack_exactness::CAP_STEPS));
    }
}

/// The largest certified gap, (bound − benefit) ÷ bound, that the frame loop's solver leaves.
fn worst_gap(instances: usize, classes: usize) -> Result<f64, String> {
    let mut dice = Pcg64::seed_from_u64(SEED);
    let mut solver = FrameSolver::default();
    let mut worst = 0.0f64;
    for _ in 0..instances {
        let problem = Problem::random(&mut dice, classes, 256);
        let answer = solver.solve(&problem);
        let (units, benefit) = problem.sums(&answer.choice);
        if units > problem.budget {
            return Err(format!("a choice costs {units} of {}", problem.budget));
        }
        worst = worst.max((answer.bound - benefit) / answer.bound);
    }
    Ok(worst)
}

fn share(instances: usize, mut holds: impl FnMut(&mut Pcg64) -> bool) -> f64 {
    let mut dice = Pcg64::seed_from_u64(SEED);
    (0..instances).filter(|_| holds(&mut dice)).count() as f64 / instances as f64
}

/// Whether the frame loop's solver finds what an exhaustive search finds, on an instance of up to sixteen classes.
fn is_exact(dice: &mut Pcg64) -> bool {
    let classes = dice.random_range(1..=SMALL);
    let problem = Problem::random(dice, classes, classes);
    let answer = FrameSolver::default().solve(&problem);
    let (units, benefit) = problem.sums(&answer.choice);
    units <= problem.budget && benefit >= optimum(&problem) * (1.0 - 1e-12)
}

/// The benefit of the best choice: every sum of cost and benefit that no other dominates, class by class.
fn optimum(problem: &Problem) -> f64 {
    let mut sums = vec![(0u64, 0.0f64)];
    for class in 0..problem.classes.len() {
        let levels = 0..problem.levels(class).len();
        let items: Vec<(u64, f64)> = levels.map(|level| problem.item(class, level)).collect();
        let longer = sums.iter().flat_map(|s| items.iter().map(|i| (s.0 + i.0, s.1 + i.1)));
        let mut longer: Vec<(u64, f64)> = longer.filter(|s| s.0 <= problem.budget).collect();
        longer.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        let mut best = f64::NEG_INFINITY;
        longer.retain(|s| {
            let is_better = s.1 > best;
            best = best.max(s.1);
            is_better
        });
        sums = longer;
    }
    sums.last().map_or(0.0, |s| s.1)
}
