//! What keeps levels still, and what it costs: every rule over every motion, on one machine under the same noise.
//!
//! ```text
//! cargo run --release --features sim --example stability
//! cargo run --release --features sim --example stability -- SCENE PATH [LEVELS]
//! ```
//!
//! Without arguments it takes the bundled scenes and four motions made from their paths. With them it takes a scene
//! file (JSON, GLB, glTF) and a camera path (CSV, TUM) as they are; `LEVELS` gives every mesh without levels so many.
//! Prints Markdown. What the columns mean is in docs/stability.md.

mod delay;
mod motions;
mod rules;

use std::error::Error;
use std::path::Path;

use delay::{Delays, Watched};
use lod_budget::CostModel;
use lod_budget::files::{CameraPath, Scene};
use lod_budget::runtime::RuntimeOptions;
use lod_budget::select::Coarsest;
use lod_budget::sim::generate::Recipe;
use lod_budget::sim::{Bounds, Camera, FrameRow, Machine, Metrics, Reference, Trial};
use motions::Motion;

/// The machine's own factors and its noise.
const SEED: u64 = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [] => Recipe::ALL.into_iter().try_for_each(bundled),
        [scene, path] => study(&Scene::read(Path::new(scene))?, &CameraPath::read(Path::new(path))?),
        [scene, path, levels] => {
            let mut scene = Scene::read(Path::new(scene))?;
            scene.assume_levels(levels.parse()?)?;
            study(&scene, &CameraPath::read(Path::new(path))?)
        }
        _ => Err("usage: stability [SCENE PATH [LEVELS]]".into()),
    }
}

fn bundled(recipe: Recipe) -> Result<(), Box<dyn Error>> {
    let (scene, path) = (recipe.scene(recipe.bundled_seed()), recipe.path(recipe.bundled_seed()));
    Motion::ALL.into_iter().try_for_each(|motion| study(&scene, &motion.along(&path)?))
}

/// Prints a table: a row per rule.
fn study(scene: &Scene, path: &CameraPath) -> Result<(), Box<dyn Error>> {
    let machine = Machine::default_for(&scene.tables, &CostModel::default(), SEED);
    let camera = Camera::default();
    camera.check(path)?;
    let trial = Trial::new(scene, path, &machine, camera, RuntimeOptions::default())?;
    let references = trial.references()?;
    let budget_us = middle_us(&references);
    let least = trial.run(Box::new(Coarsest), budget_us, Bounds::Skip, &references, &mut || ())?;
    println!("\n### {}, {}\n", scene.name, path.name());
    println!("{} frames, budget {:.3} ms\n", references.len(), budget_us / 1e3);
    println!(
        "| rule | switches | reversals | fewer | gain | benefit | tracking | missed | delay, by benefit |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    let mut first = None;
    for (name, rule) in rules::all()? {
        let (watched, log) = Watched::new(rule, camera.fps)?;
        let rows = trial.run(Box::new(watched), budget_us, Bounds::Certify, &references, &mut || ())?;
        let outcome = Outcome::of(&rows, &least, budget_us, camera.fps, Delays::of(&log));
        println!("| {name} {}", outcome.row(first.get_or_insert(outcome)));
    }
    Ok(())
}

/// The median over frames of the cost two fifths of the way from the least to the most.
fn middle_us(references: &[Reference]) -> f64 {
    let between = |r: &Reference| r.coarsest_us + 0.4 * (r.finest_us - r.coarsest_us);
    let mut budgets: Vec<f64> = references.iter().map(between).collect();
    budgets.sort_unstable_by(f64::total_cmp);
    budgets[budgets.len() / 2].max(1.0)
}

/// What a rule comes to over a path.
#[derive(Clone, Copy)]
struct Outcome {
    metrics: Metrics,
    /// Benefit beyond that of the cheapest picture, summed over frames, in px².
    benefit: f64,
    delays: Delays,
}

impl Outcome {
    fn of(rows: &[FrameRow], least: &[FrameRow], budget_us: f64, fps: f64, delays: Delays) -> Self {
        let benefit = rows.iter().zip(least).map(|(row, least)| row.benefit - least.benefit).sum();
        Self { metrics: Metrics::of(rows, budget_us, fps), benefit, delays }
    }

    /// The cells of its row, beside the rule that everything is compared with.
    fn row(&self, first: &Self) -> String {
        let (m, base) = (&self.metrics, &first.metrics);
        let ratio = |a: f64, b: f64| if b > 0.0 { format!("{:.4}", a / b) } else { "–".into() };
        let fewer = match m.reversals_per_object_second {
            some if some > 0.0 => format!("{:.1}×", base.reversals_per_object_second / some),
            _ => "–".into(),
        };
        let Delays { each_s, by_benefit_s } = self.delays;
        let gain = ratio(m.gain_over_bound, base.gain_over_bound);
        format!(
            "| {:.4} | {:.4} | {fewer} | {gain} | {} | {:.4} | {:.4} | {each_s:.2} s, {by_benefit_s:.2} s |",
            m.switches_per_object_second,
            m.reversals_per_object_second,
            ratio(self.benefit, first.benefit),
            m.tracking_over_budget,
            m.missed,
        )
    }
}
