//! Every frame of every policy, as CSV.

use lod_budget::sim::{Comparison, FrameRow};

use crate::compare::summary::Summary;

const COLUMNS: [&str; 15] = [
    "policy",
    "frame",
    "time_s",
    "frame_ms",
    "predicted_ms",
    "budget_ms",
    "coarsest_ms",
    "finest_ms",
    "visible",
    "switches",
    "reversals",
    "benefit_px2",
    "gain_over_bound",
    "gap",
    "assumed_tables",
];

/// One line per policy and frame; `time_s` is the time on the path. What a frame has not is left empty.
pub fn csv(summary: &Summary, comparison: &Comparison) -> anyhow::Result<Vec<u8>> {
    let mut csv = csv::Writer::from_writer(Vec::new());
    csv.write_record(COLUMNS)?;
    for result in &comparison.policies {
        for (frame, row) in result.rows.iter().enumerate() {
            csv.write_record(fields(summary, result.policy.name(), frame, row))?;
        }
    }
    Ok(csv.into_inner()?)
}

fn fields(summary: &Summary, policy: &str, frame: usize, row: &FrameRow) -> [String; 15] {
    let ms = |us: f64| format!("{:.6}", us / 1e3);
    let fraction = |f: Option<f64>| f.map(|f| format!("{f:.9}")).unwrap_or_default();
    [
        policy.to_owned(),
        frame.to_string(),
        format!("{:.4}", frame as f64 / summary.camera.fps),
        ms(row.time_us),
        ms(row.predicted_us),
        ms(summary.budget_ms * 1e3),
        ms(row.coarsest_us),
        ms(row.finest_us),
        row.visible.to_string(),
        row.switches.to_string(),
        row.reversals.to_string(),
        format!("{:.3}", row.benefit),
        fraction(row.gain_over_bound),
        fraction(row.gap),
        summary.assumed_tables.to_string(),
    ]
}
