//! HiGHS by its Python package `highspy`: the script is `highs/solve.py`; this side hands it an instance in the format
//! that `lod solve` reads.

use std::io;
use std::path::{Path, PathBuf};

use lod_budget::knapsack::Instance;
use serde::Deserialize;
use serde_json::json;

use crate::knapsack::{Row, Solved};
use crate::tool;

/// What the script answers.
#[derive(Deserialize)]
struct Answer {
    version: String,
    relaxation: Run,
    default_gap: Run,
    proof: Run,
}

#[derive(Deserialize)]
struct Run {
    time_s: f64,
    bound: Option<f64>,
    choice: Option<Vec<u32>>,
    proved: bool,
}

/// Picks a run out of an answer.
type Pick = fn(&Answer) -> &Run;

const SOLVERS: [(&str, Pick); 3] = [
    ("HiGHS, linear relaxation", |answer| &answer.relaxation),
    ("HiGHS, integers, default gap of 1e-4", |answer| &answer.default_gap),
    ("HiGHS, integers, no gap", |answer| &answer.proof),
];

/// A row for each way to ask HiGHS, and its version.
pub fn rows(instance: &Instance, limit_s: f64) -> io::Result<(Vec<Row>, Option<String>)> {
    let folder = tempfile::tempdir()?;
    let file = folder.path().join("instance.json");
    std::fs::write(&file, json(instance))?;
    let script = tool::home().join("highs/solve.py");
    let answer: Result<Answer, String> = tool::ask(&python(), &[script, file, limit_s.to_string().into()]);
    let row = |(solver, run): (_, Pick)| Row {
        solver,
        classes: instance.len(),
        outcome: answer.as_ref().map(|answer| run(answer).solved(instance)).map_err(Clone::clone),
    };
    let version = answer.as_ref().ok().map(|answer| answer.version.clone());
    Ok((SOLVERS.into_iter().map(row).collect(), version))
}

impl Run {
    fn solved(&self, instance: &Instance) -> Solved {
        let bound = self.bound.unwrap_or(f64::INFINITY);
        let solved = Solved::of(instance, self.time_s, bound, self.choice.as_deref());
        Solved { proved: self.proved, ..solved }
    }
}

/// The Python that `run.sh` has prepared, or whichever is there.
fn python() -> PathBuf {
    let own = tool::home().join(".venv/bin/python");
    if own.is_file() { own } else { Path::new("python3").to_owned() }
}

fn json(instance: &Instance) -> String {
    let classes: Vec<Vec<[f64; 2]>> = instance
        .classes()
        .map(|class| class.iter().map(|item| [item.cost, item.benefit]).collect())
        .collect();
    json!({"format": "lod-knapsack", "version": 1, "budget": instance.budget(), "classes": classes})
        .to_string()
}
