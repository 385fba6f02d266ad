//! `lod compare`: every policy over a scene and a camera path on a simulated machine.

mod columns;
mod given;
mod report;
mod summary;
mod words;

use std::io::Write;
use std::num::NonZero;
use std::path::PathBuf;
use std::thread;

use anyhow::anyhow;
use clap::ValueEnum;
use glam::Vec2;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use lod_budget::runtime::RuntimeOptions;
use lod_budget::sim::{Camera, CompareOptions, Comparison, Machine, Policy, Progress, compare};

use given::Given;
use summary::Summary;

/// Compare policies: each one chooses the levels of the same scene along the same camera path, on the same simulated
/// machine, under the same budget.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Args {
    /// building, city or forest (made on the spot), or a .json, .glb or .gltf file
    #[arg(default_value = "building")]
    scene: String,
    /// Camera path, CSV or TUM text [default: the one that belongs to the scene: NAME.csv beside NAME.json]
    #[arg(long, value_name = "FILE")]
    path: Option<PathBuf>,
    /// Machine to simulate
    #[arg(long, value_enum, default_value = "default")]
    machine: MachineKind,
    /// Frame budget in milliseconds [default: the median over frames of coarsest + 0.4 · (finest − coarsest)]
    #[arg(long, value_name = "MS", value_parser = positive)]
    budget_ms: Option<f64>,
    /// Policies, separated by commas [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = policy)]
    policies: Vec<Policy>,
    /// Seed of the machine: how far it is from what the runtime expects, and the noise of its frames
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Give every mesh without levels up to N of them, level 0 included, each with half the triangles
    #[arg(long, value_name = "N")]
    assume_levels: Option<usize>,
    /// Write frames.csv, comparison.json, plots and report.html to this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    lens: Lens,
}

/// The camera along the path.
#[derive(clap::Args)]
#[command(next_help_heading = "Camera")]
struct Lens {
    /// Frames per second of path time, whatever frames take
    #[arg(long, value_name = "HZ", default_value_t = 60.0)]
    fps: f64,
    /// Vertical field of view in degrees
    #[arg(long, value_name = "DEG", default_value_t = 60.0)]
    fov: f32,
    /// Width and height of the image in pixels
    #[arg(long, value_name = "WxH", default_value = "1920x1080", value_parser = viewport)]
    viewport: Vec2,
    /// Distance of the near plane
    #[arg(long, value_name = "DIST", default_value_t = 0.1)]
    near: f32,
    /// Distance of the far plane
    #[arg(long, value_name = "DIST", default_value_t = 1000.0)]
    far: f32,
}

const EXAMPLES: &str = "\
Examples:
  lod compare
  lod compare city --policies static,predictive --budget-ms 8 --out report
  lod compare town.glb --path drive.csv --assume-levels 5
  lod compare forest --json > forest.json

Policies:
  coarsest, finest    every object at its cheapest choice, or at its finest level
  static-default      by size in the image, thresholds as they are
  static              the same times one factor for the whole path, the best in hindsight
  reactive            by size in the image, steered by measured frame times
  funkhouser-sequin   the incremental knapsack rule of 1993
  predictive          the knapsack under the predicted time, with a certificate

Machines:
  default             coefficients 30 % below to 40 % above what the runtime expects,
                      assets off by about 10 %, frame noise of 3 %, measured 2 frames late
  ideal               exactly as the runtime expects, without noise";

#[derive(Clone, Copy, ValueEnum)]
enum MachineKind {
    /// Off from what the runtime expects, and noisy
    Default,
    /// Exactly what the runtime expects
    Ideal,
}

pub fn run(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let given = Given::load(&args.scene, args.path.as_deref(), args.assume_levels)?;
    let machine = machine(args, &given);
    if let Some(folder) = &args.out {
        report::make(folder)?;
    }
    let comparison = compare_all(args, &given, &machine)?;
    let summary = Summary::of(&given, &machine, &args.setting(), &comparison);
    if let Some(folder) = &args.out {
        report::write(folder, &summary, &comparison)?;
    }
    if args.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&summary)?)?;
    } else {
        write!(out, "{}", words::of(&summary))?;
        if let Some(folder) = &args.out {
            writeln!(out, "Report  {}", folder.join(report::HTML).display())?;
        }
    }
    Ok(())
}

/// What was asked for beside scene and path.
struct Setting {
    seed: u64,
    camera: Camera,
    budget_us: Option<f64>,
}

impl Args {
    fn setting(&self) -> Setting {
        let Lens { fps, fov, viewport, near, far } = self.lens;
        let camera = Camera { fps, fov_deg: fov, viewport_px: viewport, near, far };
        Setting { seed: self.seed, camera, budget_us: self.budget_ms.map(|ms| ms * 1e3) }
    }

    /// Each policy once, in the order given.
    fn policies(&self) -> Vec<Policy> {
        if self.policies.is_empty() {
            return Policy::ALL.to_vec();
        }
        let first = |(i, policy): (usize, &Policy)| (!self.policies[..i].contains(policy)).then_some(*policy);
        self.policies.iter().enumerate().filter_map(first).collect()
    }
}

fn machine(args: &Args, given: &Given) -> Machine {
    let (tables, prior) = (&given.scene.tables, RuntimeOptions::default().cost);
    match args.machine {
        MachineKind::Default => Machine::default_for(tables, &prior, args.seed),
        MachineKind::Ideal => Machine::ideal_for(tables, &prior),
    }
}

fn compare_all(args: &Args, given: &Given, machine: &Machine) -> anyhow::Result<Comparison> {
    let Setting { camera, budget_us, .. } = args.setting();
    let options = CompareOptions {
        camera,
        budget_us,
        policies: args.policies(),
        threads: thread::available_parallelism().map_or(1, NonZero::get),
        ..CompareOptions::default()
    };
    let bar = progress_bar(args.json)?;
    let advance = |Progress { policy, done, total }| {
        bar.set_length(total as u64);
        bar.set_position(done as u64);
        bar.set_message(policy.name());
    };
    let comparison = compare(&given.scene, &given.path, machine, &options, &advance);
    bar.finish_and_clear();
    comparison.map_err(|e| anyhow!("{}: {e}", given.scene_label()))
}

/// On standard error, and there only where it is a terminal.
fn progress_bar(hidden: bool) -> anyhow::Result<ProgressBar> {
    let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {eta} left  {msg:17}")?;
    Ok(ProgressBar::with_draw_target(Some(1), target).with_style(style))
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|&x: &f64| x.is_finite() && x > 0.0);
    number.ok_or_else(|| "must be a positive number".to_owned())
}

fn policy(name: &str) -> Result<Policy, String> {
    let known = || Policy::ALL.map(Policy::name).join(", ");
    Policy::named(name.trim()).ok_or_else(|| format!("must be one of {}", known()))
}

/// Images have at most so many pixels along a side.
const MOST_PIXELS: u32 = 65_536;

fn viewport(text: &str) -> Result<Vec2, String> {
    let side = |side: &str| side.parse().ok().filter(|px| (1..=MOST_PIXELS).contains(px));
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((side(w)?, side(h)?)));
    let (width, height) = sides.ok_or("must be WIDTHxHEIGHT in pixels, such as 1920x1080")?;
    Ok(Vec2::new(width as f32, height as f32))
}
