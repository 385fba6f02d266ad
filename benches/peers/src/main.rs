//! What others do with the same scene and the same knapsacks: `docs/peers.md` says what is measured and how.
//!
//! ```text
//! benches/peers/run.sh
//! benches/peers/run.sh --quick
//! ```
//!
//! Only a whole run writes `docs/peers.md` and `docs/peers.csv`. A peer that cannot be measured has a row that says
//! why.

#[cfg(feature = "bevy")]
mod bevy;
mod camera;
mod highs;
mod knapsack;
#[path = "../../limits/machine.rs"]
mod machine;
mod ours;
mod peer;
mod plan;
mod race;
mod report;
mod scene;
mod three;
mod tool;

use std::io;
use std::process::ExitCode;
use std::time::Instant;

use plan::Plan;
use report::Report;
use scene::Scene;

fn main() -> ExitCode {
    let plan = match Plan::of(std::env::args().skip(1)) {
        Ok(plan) => plan,
        Err(why) => {
            eprintln!("peers: {why}");
            return ExitCode::from(2);
        }
    };
    match run(&plan) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("peers: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Measures, prints, and writes what is worth keeping.
fn run(plan: &Plan) -> io::Result<()> {
    let (mut report, start) = (Report::default(), Instant::now());
    let progress = |what: &str| eprintln!("peers: {:4.0} s, {what}", start.elapsed().as_secs_f64());
    for (name, version) in locked_versions() {
        report.fact(name, version);
    }
    if let Some(load) = load() {
        report.fact("load before the run", &load);
    }
    for &objects in plan.sizes {
        progress(&format!("{objects} objects"));
        frames(objects, plan, &mut report)?;
    }
    let scene = Scene::scatter(knapsack::SCENE_OBJECTS);
    for &classes in plan.classes {
        progress(&format!("{classes} classes"));
        knapsacks(&scene, classes, plan, &mut report)?;
    }
    progress("done");
    println!("{}", report.tables());
    if plan.whole { report.write(&tool::home().join("../../docs")) } else { Ok(()) }
}

fn frames(objects: usize, plan: &Plan, report: &mut Report) -> io::Result<()> {
    let scene = Scene::scatter(objects);
    let race = race::race(&scene, plan)?;
    for (name, version) in &race.versions {
        report.fact(name, version);
    }
    report.frames(&scene, &race.last, race.rows);
    Ok(())
}

fn knapsacks(scene: &Scene, classes: usize, plan: &Plan, report: &mut Report) -> io::Result<()> {
    let start = camera::walk(scene, plan.frames)[0];
    let instance = knapsack::instance(scene, &start, classes);
    report.knapsacks(knapsack::ours(&instance, plan.limit_s));
    let (rows, version) = highs::rows(&instance, plan.limit_s)?;
    report.knapsacks(rows);
    if let Some(version) = version {
        report.fact("HiGHS", &version);
    }
    Ok(())
}

/// How many programs wanted a core in the last minute, as far as the system tells: with more than there are cores,
/// times are too long.
fn load() -> Option<String> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    Some(text.split_whitespace().next()?.to_owned())
}

/// The crates that are measured, as the lock file has them.
fn locked_versions() -> impl Iterator<Item = (&'static str, &'static str)> {
    let packages = include_str!("../Cargo.lock").split("[[package]]");
    let field = |package: &'static str, name: &str| {
        let line = package.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "))?;
        Some(line.trim_matches('"'))
    };
    let named = packages.filter_map(move |p| Some((field(p, "name")?, field(p, "version")?)));
    named.filter(|(name, _)| ["lod-budget", "bevy_camera"].contains(name))
}
