//! What a trial comes to.

use super::trial::FrameRow;

/// Frame times, noise included.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FrameMs {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub std: f64,
    /// Median.
    pub p50: f64,
    /// 95th percentile.
    pub p95: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Maximum.
    pub max: f64,
}

/// How well a policy did over a path. Fractions are of frames, and every frame counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Metrics {
    /// Frame times.
    pub frame_ms: FrameMs,
    /// Standard deviation of the frame time ÷ budget.
    pub std_over_budget: f64,
    /// Root mean square of (time − target) ÷ budget, the target being the budget held between what the frame costs at
    /// least and at most.
    pub tracking_over_budget: f64,
    /// Largest time ÷ the larger of the budget and what the frame costs at least.
    pub max_over_budget: f64,
    /// Fraction of frames over 1.05 times the larger of the budget and what they cost at least.
    pub missed: f64,
    /// Fraction of frames that cost more than the budget at least.
    pub infeasible: f64,
    /// Mean predicted time ÷ budget.
    pub budget_used: f64,
    /// Mean gain over the cheapest choice ÷ the certified bound of it at the true cost that was spent.
    pub gain_over_bound: f64,
    /// Changes of level per object in view and second.
    pub switches_per_object_second: f64,
    /// Changes back within a second, per object in view and second.
    pub reversals_per_object_second: f64,
    /// Mean number of objects in view.
    pub visible_mean: f64,
}

/// A frame misses when it takes more than this times what it may.
const MISS: f64 = 1.05;

impl Metrics {
    /// Sums up a trial at a budget, at so many frames per second. All zero without frames.
    pub fn of(rows: &[FrameRow], budget_us: f64, fps: f64) -> Self {
        if rows.is_empty() {
            return Self::default();
        }
        let mean = |value: &dyn Fn(&FrameRow) -> f64| rows.iter().map(value).sum::<f64>() / rows.len() as f64;
        let allowed_us = |r: &FrameRow| budget_us.max(r.coarsest_us);
        let frame_ms = frame_ms(rows);
        let object_seconds = rows.iter().map(|r| r.visible as f64).sum::<f64>() / fps;
        let per_object_second =
            |count: usize| if object_seconds > 0.0 { count as f64 / object_seconds } else { 0.0 };
        let gains: Vec<f64> = rows.iter().filter_map(|r| r.gain_over_bound).collect();
        Self {
            frame_ms,
            std_over_budget: frame_ms.std * 1e3 / budget_us,
            tracking_over_budget: mean(&|r| square(r.time_us - target_us(r, budget_us))).sqrt() / budget_us,
            max_over_budget: rows.iter().map(|r| r.time_us / allowed_us(r)).fold(0.0, f64::max),
            missed: mean(&|r| fraction(r.time_us > MISS * allowed_us(r))),
            infeasible: mean(&|r| fraction(r.coarsest_us > budget_us)),
            budget_used: mean(&|r| r.predicted_us) / budget_us,
            // From 0.0 on, because the sum of nothing is −0.
            gain_over_bound: gains.iter().fold(0.0, |sum, gain| sum + gain) / gains.len().max(1) as f64,
            switches_per_object_second: per_object_second(rows.iter().map(|r| r.switches).sum()),
            reversals_per_object_second: per_object_second(rows.iter().map(|r| r.reversals).sum()),
            visible_mean: mean(&|r| r.visible as f64),
        }
    }
}

/// The budget held between what the frame costs at least and at most.
pub(super) fn target_us(row: &FrameRow, budget_us: f64) -> f64 {
    budget_us.min(row.finest_us).max(row.coarsest_us)
}

fn square(x: f64) -> f64 {
    x * x
}

fn fraction(counts: bool) -> f64 {
    f64::from(u8::from(counts))
}

fn frame_ms(rows: &[FrameRow]) -> FrameMs {
    let mut times: Vec<f64> = rows.iter().map(|r| r.time_us / 1e3).collect();
    times.sort_unstable_by(f64::total_cmp);
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    let variance = times.iter().map(|t| square(t - mean)).sum::<f64>() / times.len() as f64;
    let percentile = |p: f64| times[((times.len() as f64 * p).ceil() as usize).clamp(1, times.len()) - 1];
    FrameMs {
        mean,
        std: variance.sqrt(),
        p50: percentile(0.5),
        p95: percentile(0.95),
        p99: percentile(0.99),
        max: percentile(1.0),
    }
}
