//! How close the frame loop comes to what the machine can do: `docs/limits.md` says what is measured and how.
//!
//! ```text
//! RUSTFLAGS="-C target-cpu=x86-64-v3" cargo bench --bench limits
//! cargo bench --bench limits -- --quick
//! cargo bench --bench limits -- --only warm_vs_sort
//! ```
//!
//! Only a whole run writes `docs/limits.csv`, `docs/limits.md` and `docs/growth.svg`. Exit status 1 when a row was refused
//! because its answers are wrong, 2 when the arguments are.

mod agreement;
mod baselines;
mod camera;
mod crowd;
mod culls;
mod exactness;
mod frames;
mod general;
mod growth;
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
    let mut findings = Findings::default();
    warm::measure(plan, &mut findings);
    culls::measure(plan, &mut findings);
    frames::measure(plan, &mut findings);
    let points = growth::measure(plan, &mut findings);
    general::measure(plan, &mut findings);
    exactness::measure(plan, &mut findings);
    more::measure(plan, &mut findings);
    println!("{}{}", findings.table(), findings.more_tables());
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    if plan.is_whole() && findings.refused().next().is_none() {
        findings.write(&docs)?;
        growth::plot(&points, &docs.join("growth.svg"))?;
    }
    Ok(findings)
}

fn told(findings: &Findings) -> ExitCode {
    let refused = findings.refused().inspect(|(name, why)| eprintln!("limits: {name} is refused: {why}"));
    if refused.count() > 0 { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
