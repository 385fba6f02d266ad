//! The knapsacks of the scene, and the solvers of the crate and of HiGHS on them.
//!
//! An instance is what a frame has to choose from: the first so many objects in view of the scene of 100 000, a class
//! each, with its four levels as items. Costs are those of the cost model in microseconds, benefits are projected
//! area times accuracy, and the budget is two fifths of the way from the least to the most that the classes can cost.

use std::time::Instant;

use cpu_time::ThreadTime;
use glam::{DVec3, Vec3};
use lod_budget::Sphere;
use lod_budget::knapsack::{Instance, Item, Solution, capped, exact, greedy};

use crate::camera::{Bound, Camera};
use crate::ours;
use crate::scene::{LEVELS, Scene};

/// Objects of the scene that instances are taken from.
pub const SCENE_OBJECTS: usize = 100_000;
/// Steps after which `capped` gives up its proof.
const CAP_STEPS: u64 = 100_000;
/// Times that what is fast is run; the fastest counts.
const REPEATS: usize = 5;

/// What a solver came to. Gains are benefit beyond that of the coarsest levels.
pub struct Solved {
    /// The processor's.
    pub time_s: f64,
    /// Gain of its choice, added up by this side; a relaxation has none.
    pub gain: Option<f64>,
    /// No choice within the budget gains more, says the solver; infinite where it says nothing.
    pub bound: f64,
    /// Whether it says that its choice is the best.
    pub proved: bool,
    /// By how much its choice exceeds the budget, as a fraction.
    pub excess: f64,
}

/// A row of the table: a solver on an instance, or why it was not measured.
pub struct Row {
    pub solver: &'static str,
    pub classes: usize,
    pub outcome: Result<Solved, String>,
}

/// The knapsack of the first objects that a camera sees.
pub fn instance(scene: &Scene, camera: &Camera, classes: usize) -> Instance {
    let lens = ours::view(camera).lens(DVec3::ZERO);
    let seen = camera.in_view(scene, Bound::Sphere).take(classes).map(|instance| {
        let kind = scene.kind(instance);
        let area_px2 = lens.area_px2(&Sphere::new(Vec3::from_array(instance.center), kind.radius));
        let prices_us = ours::prices_us(kind);
        std::array::from_fn(|level| Item {
            cost: prices_us[level],
            benefit: f64::from(area_px2) * f64::from(kind.accuracies[level]),
        })
    });
    let classes: Vec<[Item; LEVELS]> = seen.collect();
    let sum = |level: usize| classes.iter().map(|class| class[level].cost).sum::<f64>();
    let (least, most) = (sum(LEVELS - 1), sum(0));
    Instance::new(least + 0.4 * (most - least), classes).expect("finite amounts that are not negative")
}

/// The crate's solvers.
pub fn ours(instance: &Instance, limit_s: f64) -> Vec<Row> {
    let proof = |instance: &Instance| {
        let start = Instant::now();
        exact(instance, &mut || start.elapsed().as_secs_f64() >= limit_s)
    };
    let row = |solver, repeats, solve: &dyn Fn(&Instance) -> Solution| Row {
        solver,
        classes: instance.len(),
        outcome: fastest(instance, repeats, solve),
    };
    vec![
        row("lod-budget, greedy", REPEATS, &greedy),
        row("lod-budget, capped at 100 000 steps", REPEATS, &|i| capped(i, CAP_STEPS)),
        row("lod-budget, exact", 1, &proof),
    ]
}

fn fastest(
    instance: &Instance,
    repeats: usize,
    solve: &dyn Fn(&Instance) -> Solution,
) -> Result<Solved, String> {
    let timed = |_| {
        let start = ThreadTime::now();
        let solution = solve(instance);
        (start.elapsed().as_secs_f64(), solution)
    };
    let runs = (0..repeats).map(timed);
    let (time_s, solution) = runs.min_by(|a, b| a.0.total_cmp(&b.0)).ok_or("it was not run")?;
    let bound = solution.upper_bound.ok_or("the budget cannot be met")?;
    Ok(Solved { proved: solution.optimal, ..Solved::of(instance, time_s, bound, Some(&solution.choice)) })
}

impl Solved {
    /// Adds up what a choice costs and gains, whatever its solver says. The bound is of the whole benefit.
    pub fn of(instance: &Instance, time_s: f64, bound: f64, choice: Option<&[u32]>) -> Self {
        let [_, least] = sum(instance.classes().map(|class| class[LEVELS - 1]));
        let chosen = choice
            .map(|choice| sum(instance.classes().zip(choice).map(|(class, &item)| class[item as usize])));
        let excess = chosen.map_or(0.0, |[cost, _]| (cost / instance.budget() - 1.0).max(0.0));
        let gain = chosen.map(|[_, benefit]| benefit - least);
        Self { time_s, gain, bound: bound - least, proved: false, excess }
    }

    /// The share of a finite bound that is not gained.
    pub fn short_of(&self, bound: f64) -> Option<f64> {
        self.gain.filter(|_| bound.is_finite()).map(|gain| (bound - gain) / bound)
    }
}

/// Cost and benefit of all.
fn sum(items: impl Iterator<Item = Item>) -> [f64; 2] {
    items.fold([0.0; 2], |[cost, benefit], item| [cost + item.cost, benefit + item.benefit])
}
