//! Every policy over one scene and path on one machine, under the same budget and the same noise.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::machine::Machine;
use super::metrics::Metrics;
use super::threads::in_parallel;
use super::trial::{Bounds, Camera, FrameRow, Reference, Trial};
use crate::files::{CameraPath, Scene};
use crate::frame::OptionsError;
use crate::runtime::RuntimeOptions;
use crate::scene::ObjectError;
use crate::select::{
    Coarsest, Finest, FunkhouserSequin, Predictive, Reactive, ScreenSize, ScreenSizeOptions, Selector,
};

/// A policy that can be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Every object at its cheapest choice.
    Coarsest,
    /// Every object at its finest level.
    Finest,
    /// Screen size with thresholds nobody tuned.
    StaticDefault,
    /// Screen size with the one size multiplier for the whole path that tracks the budget best, chosen in hindsight.
    Static,
    /// Screen size steered by the measured frame time.
    Reactive,
    /// The incremental rule of 1993.
    FunkhouserSequin,
    /// The knapsack under the predicted time.
    Predictive,
}

impl Policy {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 7] = [
        Self::Coarsest,
        Self::Finest,
        Self::StaticDefault,
        Self::Static,
        Self::Reactive,
        Self::FunkhouserSequin,
        Self::Predictive,
    ];

    /// The policy of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|policy| policy.name() == name)
    }

    /// The name in reports and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarsest => "coarsest",
            Self::Finest => "finest",
            Self::StaticDefault => "static-default",
            Self::Static => "static",
            Self::Reactive => "reactive",
            Self::FunkhouserSequin => "funkhouser-sequin",
            Self::Predictive => "predictive",
        }
    }

    /// The selector, for policies that need no hindsight.
    fn selector(self, scale: f32) -> Result<Box<dyn Selector>, OptionsError> {
        Ok(match self {
            Self::Coarsest => Box::new(Coarsest),
            Self::Finest => Box::new(Finest),
            Self::StaticDefault => Box::new(ScreenSize::default()),
            Self::Static => Box::new(ScreenSize::new(ScreenSizeOptions { scale, ..Default::default() })?),
            Self::Reactive => Box::new(Reactive::new(Default::default())?),
            Self::FunkhouserSequin => Box::new(FunkhouserSequin::default()),
            Self::Predictive => Box::new(Predictive::default()),
        })
    }
}

/// What to compare under.
#[derive(Clone, Debug)]
pub struct CompareOptions {
    /// The camera along the path.
    pub camera: Camera,
    /// The budget; the default is the median over frames of coarsest + 0.4 · (finest − coarsest).
    pub budget_us: Option<f64>,
    /// Policies, in the order of the report.
    pub policies: Vec<Policy>,
    /// Runtime options: the same for every policy.
    pub runtime: RuntimeOptions,
    /// How many threads to run on; results do not depend on it.
    pub threads: usize,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            budget_us: None,
            policies: Policy::ALL.to_vec(),
            runtime: RuntimeOptions::default(),
            threads: 1,
        }
    }
}

/// How one policy did.
#[derive(Clone, Debug)]
pub struct PolicyResult {
    /// Which.
    pub policy: Policy,
    /// The size multiplier that hindsight chose, for [`Policy::Static`].
    pub scale: Option<f32>,
    /// Summary.
    pub metrics: Metrics,
    /// Frame by frame.
    pub rows: Vec<FrameRow>,
}

/// How all policies did.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The budget of every frame.
    pub budget_us: f64,
    /// What each frame costs at least and at most.
    pub references: Vec<Reference>,
    /// One per policy.
    pub policies: Vec<PolicyResult>,
}

impl Comparison {
    /// Mean and largest amount by which frames that cannot meet the budget exceed it at their cheapest; 0 without any.
    pub fn shortfall_us(&self) -> (f64, f64) {
        let over = self.references.iter().map(|r| r.coarsest_us - self.budget_us).filter(|&s| s > 0.0);
        let (count, sum, most) =
            over.fold((0, 0.0, 0.0), |(n, sum, most): (usize, f64, f64), s| (n + 1, sum + s, most.max(s)));
        (if count > 0 { sum / count as f64 } else { 0.0 }, most)
    }
}

/// Why a comparison could not be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompareError {
    /// An object that cannot be stored.
    Object(ObjectError),
    /// An option out of its range.
    Options(OptionsError),
}

impl std::fmt::Display for CompareError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Object(e) => e.fmt(f),
            Self::Options(e) => e.fmt(f),
        }
    }
}

impl std::error::Error for CompareError {}

impl From<ObjectError> for CompareError {
    fn from(e: ObjectError) -> Self {
        Self::Object(e)
    }
}

impl From<OptionsError> for CompareError {
    fn from(e: OptionsError) -> Self {
        Self::Options(e)
    }
}

/// How far a comparison has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is being run; several at a time on several threads.
    pub policy: Policy,
    /// Frames done, over all runs.
    pub done: usize,
    /// Frames in all, as far as is known.
    pub total: usize,
}

/// Runs every policy over the path. `progress` is told of every frame, from whichever thread ran it.
///
/// # Errors
/// An object that cannot be stored, or an option out of its range.
pub fn compare(
    scene: &Scene,
    path: &CameraPath,
    machine: &Machine,
    options: &CompareOptions,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Comparison, CompareError> {
    options.camera.check(path)?;
    let trial = Trial::new(scene, path, machine, options.camera, options.runtime)?;
    let references = trial.references()?;
    let budget_us = match options.budget_us {
        Some(budget_us) if budget_us > 0.0 && budget_us.is_finite() => budget_us,
        Some(_) => Err(OptionsError { option: "budget", rule: "must be finite and positive" })?,
        None => default_budget_us(&references),
    };
    let frames = options.policies.iter().map(|&p| references.len() * runs_of(p)).sum();
    let done = AtomicUsize::new(0);
    let runs =
        Runs { trial: &trial, references: &references, budget_us, options, done: &done, frames, progress };
    let policies = runs.all()?;
    Ok(Comparison { budget_us, references, policies })
}

/// The median over frames of coarsest + 0.4 · (finest − coarsest); a microsecond where nothing is ever in view.
fn default_budget_us(references: &[Reference]) -> f64 {
    let between = |r: &Reference| r.coarsest_us + 0.4 * (r.finest_us - r.coarsest_us);
    let mut budgets: Vec<f64> = references.iter().map(between).collect();
    budgets.sort_unstable_by(f64::total_cmp);
    let (low, high) = (budgets[(budgets.len() - 1) / 2], budgets[budgets.len() / 2]);
    ((low + high) / 2.0).max(1.0)
}

/// Trials of one comparison.
struct Runs<'a> {
    trial: &'a Trial<'a>,
    references: &'a [Reference],
    budget_us: f64,
    options: &'a CompareOptions,
    /// Frames done and frames in all.
    done: &'a AtomicUsize,
    frames: usize,
    progress: &'a (dyn Fn(Progress) + Sync),
}

/// Multipliers that hindsight tries first, as powers of two.
const COARSE: [f64; 12] = [-14.0, -12.0, -10.0, -8.0, -6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0, 8.0];
/// How often it then halves the distance to the neighbours of the best.
const HALVINGS: usize = 6;

/// How many trials a policy takes.
fn runs_of(policy: Policy) -> usize {
    match policy {
        Policy::Static => COARSE.len() + 2 * HALVINGS + 1,
        _ => 1,
    }
}

impl Runs<'_> {
    fn all(&self) -> Result<Vec<PolicyResult>, OptionsError> {
        let policies = &self.options.policies;
        let scale = match policies.contains(&Policy::Static) {
            true => Some(self.scale_in_hindsight()?),
            false => None,
        };
        let scale_of = |policy| scale.filter(|_| policy == Policy::Static);
        let run = |&policy: &Policy| self.policy(policy, scale_of(policy));
        in_parallel(policies, self.options.threads, run).into_iter().collect()
    }

    fn policy(&self, policy: Policy, scale: Option<f32>) -> Result<PolicyResult, OptionsError> {
        let rows = self.rows(policy, scale.unwrap_or(1.0), Bounds::Certify)?;
        Ok(PolicyResult { policy, scale, metrics: self.metrics(&rows), rows })
    }

    fn metrics(&self, rows: &[FrameRow]) -> Metrics {
        Metrics::of(rows, self.budget_us, self.options.camera.fps)
    }

    fn rows(&self, policy: Policy, scale: f32, bounds: Bounds) -> Result<Vec<FrameRow>, OptionsError> {
        let mut tick = || {
            let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
            (self.progress)(Progress { policy, done, total: self.frames });
        };
        self.trial.run(policy.selector(scale)?, self.budget_us, bounds, self.references, &mut tick)
    }

    /// The multiplier of the smallest tracking: powers of four first, then ever closer around the best.
    fn scale_in_hindsight(&self) -> Result<f32, OptionsError> {
        let mut best = self.best_of(Tracked { tracking: f64::INFINITY, exponent: 0.0 }, &COARSE)?;
        let mut step = 1.0;
        for _ in 0..HALVINGS {
            best = self.best_of(best, &[best.exponent - step, best.exponent + step])?;
            step /= 2.0;
        }
        Ok(best.exponent.exp2() as f32)
    }

    /// The best of `best` and these powers of two; the earlier one of equals.
    fn best_of(&self, best: Tracked, exponents: &[f64]) -> Result<Tracked, OptionsError> {
        let tracked = in_parallel(exponents, self.options.threads, |&exponent| self.tracked(exponent));
        tracked.into_iter().try_fold(best, |best, next| {
            let next = next?;
            Ok(if next.tracking < best.tracking { next } else { best })
        })
    }

    fn tracked(&self, exponent: f64) -> Result<Tracked, OptionsError> {
        let rows = self.rows(Policy::Static, exponent.exp2() as f32, Bounds::Skip)?;
        Ok(Tracked { tracking: self.metrics(&rows).tracking_over_budget, exponent })
    }
}

/// How well a size multiplier of 2^`exponent` tracks the budget.
#[derive(Clone, Copy, Debug)]
struct Tracked {
    tracking: f64,
    exponent: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::generate::scatter;
    use glam::{DVec3, Quat};

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let scene = scatter(200, 3);
        let pose = |i: u32| crate::files::Pose {
            time_s: f64::from(i) / 20.0,
            position: DVec3::new(0.0, 2.0, 20.0 - f64::from(i)),
            rotation: Quat::IDENTITY,
        };
        let path = CameraPath::new("walk", (0..8).map(pose).collect()).expect("a good path");
        let machine = Machine::default_for(&scene.tables, &RuntimeOptions::default().cost, 1);
        let run = |threads| {
            let options = CompareOptions { threads, ..CompareOptions::default() };
            let (told, total) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let comparison = compare(&scene, &path, &machine, &options, &|p| {
                told.fetch_max(p.done, Ordering::Relaxed);
                total.store(p.total, Ordering::Relaxed);
            });
            (comparison.expect("it runs"), told.into_inner(), total.into_inner())
        };
        let ((one, told, total), (three, told_three, _)) = (run(1), run(3));
        assert_eq!((one.references.len(), total % 22), (22, 0));
        assert_eq!((told, told_three), (total, total));
        for (a, b) in one.policies.iter().zip(&three.policies) {
            assert_eq!((a.policy, a.scale, a.metrics), (b.policy, b.scale, b.metrics));
            assert_eq!(a.rows, b.rows);
        }
    }
}
