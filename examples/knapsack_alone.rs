//! The knapsack without graphics: how often to animate each skeleton of a crowd, within one budget of processor time.
//!
//! ```text
//! cargo run --example knapsack_alone --no-default-features
//! ```
//!
//! Any choice of "one of several, cost against benefit, within one budget" has this form: shadow map sizes, physics
//! rates, splat counts. The feedback stage can be had alone as well, and closes the loop here.

use std::error::Error;

use lod_budget::feedback::{Feedback, FeedbackOptions, Prediction};
use lod_budget::frame::{FrameId, FrameTime};
use lod_budget::knapsack::{Instance, Item, Solution, exact, greedy};
use lod_budget::rate::CostModel;

const BUDGET_US: f64 = 1_000.0;
/// What posing a bone was once measured to take, and what it takes on this machine.
const BONE_US: f64 = 0.5;
const MACHINE: f64 = 1.4;
/// Updates of the pose in so many frames: each frame, every second, … never.
const PERIODS: [Option<u32>; 5] = [Some(1), Some(2), Some(4), Some(8), None];

fn main() -> Result<(), Box<dyn Error>> {
    let crowd: Vec<Skeleton> = (0..120).map(Skeleton::new).collect();
    // The cost of a frame is known as a whole, so one coefficient of 1 is all the model there is, and it is kept.
    let model =
        CostModel { draw_us: 1.0, vertex_us: 0.0, triangle_us: 0.0, pixel_us: 0.0, ..CostModel::default() };
    let options = FeedbackOptions { prior_deviation: 0.0, ..FeedbackOptions::default() };
    let mut feedback = Feedback::new(options, model)?;
    let mut timers: Vec<FrameTime> = Vec::new();

    println!("frame  budget_us  cost_us  measured_us  every 1, 2, 4, 8 frames, never  gap");
    for frame in 1..=60 {
        feedback.measure(timers.iter().rev().nth(1).copied().as_slice());
        let budget = feedback.budget(BUDGET_US);
        let instance = rates(&crowd, budget.select_us, frame)?;
        let solution = greedy(&instance);

        let id = FrameId(frame);
        let drivers = [solution.cost, 0.0, 0.0, 0.0];
        feedback.expect(Prediction { frame: id, drivers, model_us: solution.cost, churn: 0.0, usable: true });
        let measured_us = solution.cost * MACHINE;
        timers.push(FrameTime::busy(id, measured_us as f32));
        if frame % 6 == 1 {
            let counts = format!("{:?}", histogram(&solution));
            let (budget_us, cost_us) = (budget.select_us, solution.cost);
            let gap = solution.gap.unwrap_or(f64::NAN);
            println!(
                "{frame:>5} {budget_us:>10.1} {cost_us:>8.1} {measured_us:>12.1}  {counts:<29} {gap:.1e}"
            );
        }
    }
    prove(&crowd[..16])
}

/// Somebody to be animated.
struct Skeleton {
    bones: u32,
    distance: f64,
    /// How fast the limbs go; a fast walk shows a low rate more.
    speed: f64,
}

impl Skeleton {
    fn new(i: u32) -> Self {
        let distance = 3.0 + f64::from(i * 37 % 120) * 0.7;
        Self { bones: 20 + i * 13 % 60, distance, speed: 0.5 + f64::from(i % 4) * 0.5 }
    }

    /// One item per rate. The average time per frame is the cost; what the eye would miss without it is the benefit.
    fn rates(&self, frame: u64) -> [Item; PERIODS.len()] {
        let distance = (self.distance - 0.02 * frame as f64).max(1.0);
        let size = 1.0 / (distance * distance);
        PERIODS.map(|period| match period {
            Some(period) => {
                let cost = BONE_US * f64::from(self.bones) / f64::from(period);
                let smoothness = 1.0 / (1.0 + 0.2 * self.speed * f64::from(period - 1));
                Item { cost, benefit: size * smoothness }
            }
            None => Item { cost: 0.0, benefit: 0.0 },
        })
    }
}

fn rates(crowd: &[Skeleton], budget_us: f64, frame: u64) -> Result<Instance, Box<dyn Error>> {
    Ok(Instance::new(budget_us, crowd.iter().map(|skeleton| skeleton.rates(frame)))?)
}

/// How many skeletons go at each rate.
fn histogram(solution: &Solution) -> [usize; PERIODS.len()] {
    let mut counts = [0; PERIODS.len()];
    solution.choice.iter().for_each(|&item| counts[item as usize] += 1);
    counts
}

/// For a handful of skeletons the optimum can be proved; with a crowd the greedy answer is as good as that.
fn prove(few: &[Skeleton]) -> Result<(), Box<dyn Error>> {
    let instance = rates(few, 60.0, 0)?;
    let (quick, best) = (greedy(&instance), exact(&instance, &mut || false));
    println!(
        "{} skeletons in 60 µs: greedy {:.6}, at most {:.6}; the optimum is {:.6} ({}).",
        few.len(),
        quick.benefit,
        quick.upper_bound.unwrap_or(f64::NAN),
        best.benefit,
        if best.optimal { "proved" } else { "not proved" },
    );
    assert!(quick.benefit <= best.benefit && quick.upper_bound >= Some(best.benefit));
    Ok(())
}
