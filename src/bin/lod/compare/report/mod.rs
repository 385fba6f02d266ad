//! A comparison as files: numbers for programs, a page and plots for people.

mod curves;
mod frame_time;
mod frames;
mod html;
mod style;

use std::fs;
use std::path::Path;

use anyhow::Context;
use lod_budget::files::write_atomically;
use lod_budget::sim::Comparison;

use crate::compare::summary::Summary;

/// The page to open.
pub const HTML: &str = "report.html";

/// The plots, as SVG.
struct Plots {
    frame_time: String,
    time_over_budget: String,
    gain_over_bound: String,
}

/// Makes the folder, before the long work whose results go there.
pub fn make(folder: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("{}: it cannot be made", folder.display()))
}

/// Writes everything to `folder`, each file as a whole.
pub fn write(folder: &Path, summary: &Summary, comparison: &Comparison) -> anyhow::Result<()> {
    let plots = Plots {
        frame_time: frame_time::svg(summary, comparison)?,
        time_over_budget: curves::time_over_budget(summary, comparison)?,
        gain_over_bound: curves::gain_over_bound(summary, comparison)?,
    };
    let files = [
        ("comparison.json", serde_json::to_string_pretty(summary)?.into_bytes()),
        ("frames.csv", frames::csv(summary, comparison)?),
        (HTML, html::page(summary, &plots).into_bytes()),
        ("frame_time.svg", plots.frame_time.into_bytes()),
        ("time_over_budget.svg", plots.time_over_budget.into_bytes()),
        ("gain_over_bound.svg", plots.gain_over_bound.into_bytes()),
    ];
    for (name, bytes) in files {
        write_atomically(&folder.join(name), &bytes)?;
    }
    Ok(())
}
