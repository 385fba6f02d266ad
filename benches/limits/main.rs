//! How close the frame loop comes to what the machine can do: `docs/limits.md` says what is measured and how.
//!
//! ```text
//! RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench --bench limits
//! cargo bench --bench limits -- --quick
//! cargo bench --bench limits -- --only warm_vs_sort
//! ```
//!
//! Only a whole run writes `docs/limits.csv`, `docs/limits.md` and `docs/growth.svg`. Exit status 1 when a row
//! was refused because its answers are wrong, 2 when the arguments are.

mod agreement;
mod baselines;
mod camera;
mod crowd;
mod culls;
mod exactness;
mod frames;
mod general;
mod growth;
#[path = "../knapsack_exactness/mod.rs"]
mod knapsack_exactness;
mod machine;
mod more;
mod ours;
mod plan;
mod race;
mod report;
mod scene;
mod stream;
mod warm;

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use plan::Plan;
use report::{Failure, Findings};

fn main() -> ExitCode {
    let plan = match Plan::of(std::env::args().skip(1)) {
        Ok(plan) => plan,
        Err(why) => {
            eprintln!("limits: {why}");
            return ExitCode::from(2);
        }
    };
    match run(&plan) {
        Ok(findings) => told(&findings),
        Err(failure) => {
            eprintln!("limits: {failure}");
            ExitCode::FAILURE
        }
    }
}

/// Measures, prints, and writes what is worth keeping.
fn run(plan: &Plan) -> Result<Findings, Failure> {
    let (mut findings, start) = (Findings::default(), Instant::now());
    let progress = |what: &str| eprintln!("limits: {:4.0} s, {what}", start.elapsed().as_secs_f64());
    progress("everything in view");
    warm::measure(plan, &mut findings);
    progress("culling");
    culls::measure(plan, &mut findings);
    progress("a fifth in view");
    frames::measure(plan, &mut findings);
    progress("growth");
    let points = growth::measure(plan, &mut findings);
    progress("costs of two stages");
    general::measure(plan, &mut findings);
    progress("exactness");
    exactness::measure(plan, &mut findings);
    progress("more");
    more::measure(plan, &mut findings);
    progress("done");
    println!("{}{}", findings.table(plan), findings.more_tables());
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    if plan.is_whole() && findings.refused().next().is_none() {
        findings.write(plan, &docs)?;
        growth::plot(&points, &docs.join("growth.svg"))?;
    }
    Ok(findings)
}

fn told(findings: &Findings) -> ExitCode {
    let refused = findings.refused().inspect(|(name, why)| eprintln!("limits: {name} is refused: {why}"));
    if refused.count() > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
