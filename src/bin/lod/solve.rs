//! `lod solve`: one multiple-choice knapsack.

use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use lod_budget::knapsack::{Instance, Solution, exact, greedy};

use crate::text;

/// Solve one knapsack: choose one item of every class, as much benefit as the budget allows.
///
/// INSTANCE is JSON: {"budget": B, "classes": [[[cost, benefit], …], …]}. A budget that cannot be met is an answer, not
/// an error: the cheapest choice, and by how much it exceeds the budget.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct Args {
    /// The instance, a JSON file; - reads standard input
    #[arg(value_name = "INSTANCE")]
    file: PathBuf,
    /// Search until the optimum is proved, however long that takes
    #[arg(long)]
    exact: bool,
    /// Give up the search for the optimum after so many seconds, with the best choice so far
    #[arg(long, value_name = "SECONDS", requires = "exact", value_parser = seconds)]
    limit_s: Option<Duration>,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Examples:
  lod solve instance.json
  lod solve instance.json --exact --limit-s 10 --json
  echo '{\"budget\": 3, \"classes\": [[[1, 2], [3, 5]]]}' | lod solve -";

pub fn run(args: &Args, out: &mut dyn Write) -> anyhow::Result<()> {
    let instance = read(&args.file)?;
    let solution = solve(&instance, args);
    if args.json {
        writeln!(out, "{}", serde_json::to_string(&solution)?)?;
    } else {
        write!(out, "{}", in_words(&instance, &solution))?;
    }
    Ok(())
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|s| Duration::try_from_secs_f64(s).ok());
    seconds.ok_or_else(|| "must be a number of seconds, not negative".to_owned())
}

fn read(file: &Path) -> anyhow::Result<Instance> {
    if file.as_os_str() != "-" {
        return Ok(Instance::read(file)?);
    }
    let mut bytes = Vec::new();
    io::stdin().read_to_end(&mut bytes).context("standard input: it cannot be read")?;
    Ok(Instance::from_bytes(&bytes, "standard input")?)
}

fn solve(instance: &Instance, args: &Args) -> Solution {
    if !args.exact {
        return greedy(instance);
    }
    let start = Instant::now();
    exact(instance, &mut || args.limit_s.is_some_and(|limit| start.elapsed() >= limit))
}

/// More indices than this are for programs.
const CHOICES_SHOWN: usize = 100;

fn in_words(instance: &Instance, solution: &Solution) -> String {
    let mut text = format!(
        "Instance   {}, {}, budget {}\nCost       {}\nBenefit    {}\n",
        counted_classes(instance.len()),
        text::counted(instance.items().len(), "item"),
        instance.budget(),
        solution.cost,
        solution.benefit,
    );
    match (solution.upper_bound, solution.gap) {
        (Some(bound), Some(gap)) => {
            let proved = if solution.optimal { "optimal, proved" } else { "not proved optimal" };
            text += &format!("Bound      {bound}\nGap        {gap:.3e} ({proved})\n");
        }
        _ => {
            text += &format!("Infeasible the cheapest choice exceeds the budget by {}\n", solution.shortfall);
        }
    }
    text += &format!("Choice     {}\n", choice_in_words(&solution.choice));
    text
}

fn counted_classes(n: usize) -> String {
    if n == 1 { "1 class".to_owned() } else { format!("{} classes", text::count(n as u64)) }
}

fn choice_in_words(choice: &[u32]) -> String {
    let shown: Vec<String> = choice.iter().take(CHOICES_SHOWN).map(u32::to_string).collect();
    match choice.len() {
        0 => "nothing to choose".to_owned(),
        n if n > CHOICES_SHOWN => format!("{} … (all {n} with --json)", shown.join(" ")),
        _ => shown.join(" "),
    }
}
