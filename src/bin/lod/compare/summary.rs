//! What a comparison comes to: the object that `--json` prints, and that every other output is made from.

use lod_budget::files::Break;
use lod_budget::rate::CostModel;
use lod_budget::runtime::RuntimeOptions;
use lod_budget::sim::{Comparison, Machine, Metrics, PolicyResult};
use serde::Serialize;

use super::{Given, Setting};

/// A comparison in numbers. Its keys are an interface: they are added to, never renamed.
#[derive(Serialize)]
pub struct Summary {
    pub scene: String,
    pub path: String,
    pub machine: &'static str,
    pub budget_ms: f64,
    pub frames: usize,
    pub seed: u64,
    pub policies: Vec<PolicyRow>,
    /// `null` where the scene was made on the spot.
    pub scene_file: Option<String>,
    pub path_file: Option<String>,
    pub objects: usize,
    pub tables: usize,
    /// What `--assume-levels` was given.
    pub assume_levels: Option<usize>,
    pub assumed_tables: usize,
    /// Whether the budget is the one that follows from scene, path and machine.
    pub default_budget: bool,
    pub infeasible_frames: usize,
    /// Over the frames whose coarsest levels exceed the budget.
    pub shortfall_ms: Shortfall,
    pub path_duration_s: f64,
    pub path_breaks: Vec<Break>,
    pub camera: CameraRow,
    pub cost_model: CostModels,
    pub measured_after_frames: usize,
}

/// How one policy did.
#[derive(Serialize)]
pub struct PolicyRow {
    pub policy: &'static str,
    #[serde(flatten)]
    pub metrics: Metrics,
    /// Of `static`: the factor on every size that hindsight chose.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<f32>,
}

/// By how much frames that cannot meet the budget exceed it at their cheapest.
#[derive(Serialize)]
pub struct Shortfall {
    pub mean: f64,
    pub max: f64,
}

/// The camera along the path.
#[derive(Serialize)]
pub struct CameraRow {
    pub fps: f64,
    pub fov_deg: f32,
    pub viewport_px: [f32; 2],
    pub near: f32,
    pub far: f32,
}

/// µs per draw call, vertex, triangle and pixel.
#[derive(Serialize)]
pub struct CostModels {
    /// What the runtime expects before it has measured anything.
    pub prior: CostModel,
    /// What the machine takes, before each asset's own factor.
    #[serde(rename = "true")]
    pub actual: CostModel,
}

impl Summary {
    pub fn of(given: &Given, machine: &Machine, setting: &Setting, comparison: &Comparison) -> Self {
        let file = |file: &Option<std::path::PathBuf>| file.as_ref().map(|f| f.display().to_string());
        let (mean, max) = comparison.shortfall_us();
        let infeasible = comparison.references.iter().filter(|r| r.coarsest_us > comparison.budget_us);
        Self {
            scene: given.scene.name.clone(),
            path: given.path.name().to_owned(),
            machine: machine.name(),
            budget_ms: comparison.budget_us / 1e3,
            frames: comparison.references.len(),
            seed: setting.seed,
            policies: comparison.policies.iter().map(PolicyRow::of).collect(),
            scene_file: file(&given.scene_file),
            path_file: file(&given.path_file),
            objects: given.scene.objects.len(),
            tables: given.scene.tables.len(),
            assume_levels: given.assume_levels,
            assumed_tables: given.assumed_tables,
            default_budget: setting.budget_us.is_none(),
            infeasible_frames: infeasible.count(),
            shortfall_ms: Shortfall { mean: mean / 1e3, max: max / 1e3 },
            path_duration_s: given.path.duration_s(),
            path_breaks: given.path.breaks().to_vec(),
            camera: CameraRow::of(setting),
            cost_model: CostModels { prior: RuntimeOptions::default().cost, actual: *machine.model() },
            measured_after_frames: machine.latency(),
        }
    }
}

impl PolicyRow {
    fn of(result: &PolicyResult) -> Self {
        Self { policy: result.policy.name(), metrics: result.metrics, scale: result.scale }
    }

    /// Whether it is a policy rather than an end of the scale.
    pub fn competes(&self) -> bool {
        !matches!(self.policy, "coarsest" | "finest")
    }
}

impl CameraRow {
    fn of(setting: &Setting) -> Self {
        let camera = setting.camera;
        Self {
            fps: camera.fps,
            fov_deg: camera.fov_deg,
            viewport_px: camera.viewport_px.to_array(),
            near: camera.near,
            far: camera.far,
        }
    }
}
