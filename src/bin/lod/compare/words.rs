//! A comparison on the terminal: what was compared, a row per policy, and what to make of it.

use std::fmt::Write;

use lod_budget::files::{Break, BreakKind};

use super::summary::{PolicyRow, Summary};
use crate::text::{self, counted, percent, plain, significant};

/// The whole of it, as wide as the terminal is.
pub fn of(summary: &Summary) -> String {
    let mut text = head(summary) + "\n";
    for columns in layout(text::columns()) {
        text += &table(summary, &columns);
        text += "\n";
    }
    text + &notes(summary)
}

fn head(s: &Summary) -> String {
    let mut text = String::new();
    let mut line = |name: &str, words: String| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:<8}{words}");
    };
    let (objects, tables) = (counted(s.objects, "object"), counted(s.tables, "table"));
    line("Scene", format!("{}: {objects}, {tables}{}", plain(&s.scene), assumed(s)));
    let frames = counted(s.frames, "frame");
    line("Path", format!("{}: {:.1} s, {frames} at {} Hz", plain(&s.path), s.path_duration_s, s.camera.fps));
    line("Machine", machine(s));
    let origin = if s.default_budget { " (the default for this scene, path and machine)" } else { "" };
    line("Budget", format!("{} ms{origin}", significant(s.budget_ms, 4)));
    text
}

/// What must be said wherever levels were assumed.
pub fn assumed(s: &Summary) -> String {
    match s.assume_levels {
        None => String::new(),
        Some(n) => {
            format!("; levels ASSUMED, up to {n}, for {} without levels", counted(s.assumed_tables, "table"))
        }
    }
}

fn machine(s: &Summary) -> String {
    let model = s.cost_model.actual;
    let ns = |us: f64| significant(us * 1e3, 3);
    format!(
        "{}, seed {}: draw {} µs, vertex {} ns, triangle {} ns, pixel {} ns",
        s.machine,
        s.seed,
        significant(model.draw_us, 3),
        ns(model.vertex_us),
        ns(model.triangle_us),
        ns(model.pixel_us)
    )
}

/// A column: its heading, and its text for a policy.
struct Column {
    heading: &'static str,
    value: fn(&Summary, &PolicyRow) -> String,
}

const fn column(heading: &'static str, value: fn(&Summary, &PolicyRow) -> String) -> Column {
    Column { heading, value }
}

const TIME: [Column; 8] = [
    column("mean\nms", |s, p| ms(s, p.metrics.frame_ms.mean)),
    column("std\nms", |s, p| ms(s, p.metrics.frame_ms.std)),
    column("p50\nms", |s, p| ms(s, p.metrics.frame_ms.p50)),
    column("p95\nms", |s, p| ms(s, p.metrics.frame_ms.p95)),
    column("p99\nms", |s, p| ms(s, p.metrics.frame_ms.p99)),
    column("max\nms", |s, p| ms(s, p.metrics.frame_ms.max)),
    column("std\n% budget", |_, p| percent(p.metrics.std_over_budget, 1)),
    column("missed\n% frames", |_, p| percent(p.metrics.missed, 2)),
];

const WORTH: [Column; 6] = [
    column("tracking\n% budget", |_, p| percent(p.metrics.tracking_over_budget, 2)),
    column("max\n× budget", |_, p| format!("{:.2}", p.metrics.max_over_budget)),
    column("used\n% budget", |_, p| percent(p.metrics.budget_used, 1)),
    column("gain\n% bound", |_, p| percent(p.metrics.gain_over_bound, 2)),
    column("switches\n/object s", |_, p| format!("{:.3}", p.metrics.switches_per_object_second)),
    column("reversals\n/object s", |_, p| format!("{:.4}", p.metrics.reversals_per_object_second)),
];

fn ms(s: &Summary, value: f64) -> String {
    format!("{value:.*}", text::decimals_for(s.budget_ms, 4))
}

/// A terminal as wide as this takes all columns in one table.
const WIDE: usize = 140;

/// The tables that fit: one, or two for narrow terminals. What is no terminal is as wide as it takes.
fn layout(columns: Option<usize>) -> Vec<Vec<&'static Column>> {
    match columns {
        Some(width) if width < WIDE => vec![TIME.iter().collect(), WORTH.iter().collect()],
        _ => vec![TIME.iter().chain(&WORTH).collect()],
    }
}

fn table(summary: &Summary, columns: &[&Column]) -> String {
    let headings: Vec<&str> = std::iter::once("policy\n").chain(columns.iter().map(|c| c.heading)).collect();
    let row = |p: &PolicyRow| {
        let values = columns.iter().map(|c| (c.value)(summary, p));
        std::iter::once(p.policy.to_owned()).chain(values).collect()
    };
    let rows: Vec<Vec<String>> = summary.policies.iter().map(row).collect();
    text::table(&headings, &rows)
}

fn notes(s: &Summary) -> String {
    let mut text = format!("{}\n", budget_note(s));
    if !s.path_breaks.is_empty() {
        text += &format!("{}\n", break_note(&s.path_breaks));
    }
    if let Some(scale) = s.policies.iter().find_map(|p| p.scale) {
        text +=
            &format!("In hindsight, static multiplies every size by {}.\n", significant(f64::from(scale), 3));
    }
    if s.policies.iter().filter(|p| p.competes()).count() > 1 {
        text += &format!("Best in {}.\n", best_note(&s.policies));
    }
    text
}

/// In how many frames the budget cannot be met, and by how much.
pub fn budget_note(s: &Summary) -> String {
    match s.infeasible_frames {
        0 => "The budget can be met in every frame.".to_owned(),
        frames => format!(
            "In {} ({} %) the coarsest levels alone exceed the budget: by {} ms on average, {} ms at most.",
            counted(frames, "frame"),
            percent(frames as f64 / s.frames as f64, 1),
            ms(s, s.shortfall_ms.mean),
            ms(s, s.shortfall_ms.max)
        ),
    }
}

/// Where the camera was held because no motion connects two poses.
pub fn break_note(breaks: &[Break]) -> String {
    let of_kind = |kind, name| {
        let found: Vec<&Break> = breaks.iter().filter(|b| b.kind == kind).collect();
        let first = found.first()?;
        let longest = found.iter().map(|b| b.duration_s).fold(0.0, f64::max);
        let farthest = found.iter().map(|b| b.distance).fold(0.0, f64::max);
        Some(format!(
            "{} (first at {:.1} s, longest {longest:.1} s, farthest {farthest:.1} m)",
            counted(found.len(), name),
            first.time_s
        ))
    };
    let kinds = [of_kind(BreakKind::Gap, "gap"), of_kind(BreakKind::Jump, "jump")];
    let kinds: Vec<String> = kinds.into_iter().flatten().collect();
    format!("The path has {}; the camera waits before each.", kinds.join(" and "))
}

/// What policies can be best in: lower is better.
const CONTESTS: [(&str, fn(&PolicyRow) -> f64); 5] = [
    ("tracking", |p| p.metrics.tracking_over_budget),
    ("misses", |p| p.metrics.missed),
    ("longest frame", |p| p.metrics.max_over_budget),
    ("gain", |p| -p.metrics.gain_over_bound),
    ("switches", |p| p.metrics.switches_per_object_second),
];

/// Who was best in what, the ends of the scale left out.
pub fn best_note(policies: &[PolicyRow]) -> String {
    let best = |(name, score): (&str, fn(&PolicyRow) -> f64)| {
        let competing = || policies.iter().filter(|p| p.competes());
        let least = competing().map(score).fold(f64::INFINITY, f64::min);
        let winners: Vec<&str> = competing().filter(|p| score(p) <= least).map(|p| p.policy).collect();
        format!("{name}: {}", winners.join(" and "))
    };
    CONTESTS.map(best).join("; ")
}
