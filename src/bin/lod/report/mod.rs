//! A comparison as files.

use std::fs;
use std::path::Path;

use anyhow::Context;
use lod_budget::files::write_atomically;
use lod_budget::sim::Comparison;

use crate::compare::Summary;

/// The page to open.
pub const HTML: &str = "report.html";

/// Writes everything to `folder`, each file as a whole.
pub fn write(folder: &Path, summary: &Summary, _comparison: &Comparison) -> anyhow::Result<()> {
    fs::create_dir_all(folder).with_context(|| format!("{}: it cannot be made", folder.display()))?;
    write_atomically(&folder.join("comparison.json"), serde_json::to_string_pretty(summary)?.as_bytes())?;
    Ok(())
}
