//! The numbers of a policy, as the terminal and the report show them.

use super::summary::{PolicyRow, Summary};
use crate::text::{decimals_for, fixed, percent};

/// One number of every policy.
pub struct Column {
    pub name: &'static str,
    pub unit: &'static str,
    pub meaning: &'static str,
    pub value: fn(&Summary, &PolicyRow) -> String,
}

/// How long frames take.
pub const TIME: [Column; 8] = [
    Column {
        name: "mean",
        unit: "ms",
        meaning: "Mean frame time, noise included, as are all times here.",
        value: |s, p| ms(s, p.metrics.frame_ms.mean),
    },
    Column {
        name: "std",
        unit: "ms",
        meaning: "Standard deviation of the frame time.",
        value: |s, p| ms(s, p.metrics.frame_ms.std),
    },
    Column {
        name: "p50",
        unit: "ms",
        meaning: "Median frame time.",
        value: |s, p| ms(s, p.metrics.frame_ms.p50),
    },
    Column {
        name: "p95",
        unit: "ms",
        meaning: "95 % of frames take no longer.",
        value: |s, p| ms(s, p.metrics.frame_ms.p95),
    },
    Column {
        name: "p99",
        unit: "ms",
        meaning: "99 % of frames take no longer.",
        value: |s, p| ms(s, p.metrics.frame_ms.p99),
    },
    Column {
        name: "max",
        unit: "ms",
        meaning: "The longest frame.",
        value: |s, p| ms(s, p.metrics.frame_ms.max),
    },
    Column {
        name: "std",
        unit: "% budget",
        meaning: "Standard deviation of the frame time ÷ budget. A path whose frames cannot all meet the budget \
                  keeps it high whatever the policy.",
        value: |_, p| percent(p.metrics.std_over_budget, 1),
    },
    Column {
        name: "missed",
        unit: "% frames",
        meaning: "Frames that take more than 1.05 times the budget, or, where the coarsest levels alone exceed the \
                  budget, more than 1.05 times what those take.",
        value: |_, p| percent(p.metrics.missed, 2),
    },
];

/// How well time is kept and spent.
pub const WORTH: [Column; 6] = [
    Column {
        name: "tracking",
        unit: "% budget",
        meaning: "Root mean square of (time − target) ÷ budget; a frame's target is the budget held between what the \
                  frame takes at all coarsest and at all finest levels.",
        value: |_, p| percent(p.metrics.tracking_over_budget, 2),
    },
    Column {
        name: "max",
        unit: "× budget",
        meaning: "The longest frame in multiples of the budget, or of what its coarsest levels take where that is more.",
        value: |_, p| fixed(p.metrics.max_over_budget, 2),
    },
    Column {
        name: "used",
        unit: "% budget",
        meaning: "Mean time that the runtime predicted ÷ budget.",
        value: |_, p| percent(p.metrics.budget_used, 1),
    },
    Column {
        name: "gain",
        unit: "% bound",
        meaning: "Benefit over the coarsest choice ÷ the certified upper bound of it at the time that the policy itself \
                  spent: how well it spends, whatever it spends.",
        value: |_, p| percent(p.metrics.gain_over_bound, 2),
    },
    Column {
        name: "switches",
        unit: "/object s",
        meaning: "Changes of level per object in view and second.",
        value: |_, p| fixed(p.metrics.switches_per_object_second, 3),
    },
    Column {
        name: "reversals",
        unit: "/object s",
        meaning: "Changes back within a second to the level before, per object in view and second.",
        value: |_, p| fixed(p.metrics.reversals_per_object_second, 3),
    },
];

/// Milliseconds, as fine as the budget is.
pub fn ms(s: &Summary, value: f64) -> String {
    fixed(value, decimals_for(s.budget_ms, 4))
}
