//! A comparison on the terminal: what was compared, a row per policy, and what to make of it.

use lod_budget::files::{Break, BreakKind};
use lod_budget::rate::CostModel;

use super::columns::{Column, TIME, WORTH, ms};
use super::summary::{PolicyRow, Summary};
use crate::text::{self, counted, percent, plain, significant};

/// The whole of it, as wide as the terminal is.
pub fn of(summary: &Summary) -> String {
    let mut text = head(summary) + "\n";
    for columns in layout(text::columns()) {
        text += &table(summary, &columns);
        text += "\n";
    }
    notes(summary).iter().fold(text, |text, note| text + note + "\n")
}

fn head(s: &Summary) -> String {
    facts(s).map(|(name, words)| format!("{name:<8}{words}\n")).concat()
}

/// What was compared on.
pub fn facts(s: &Summary) -> [(&'static str, String); 4] {
    let (objects, tables) = (counted(s.objects, "object"), counted(s.tables, "table"));
    let frames = counted(s.frames, "frame");
    let origin = if s.default_budget { " (the default for this scene, path and machine)" } else { "" };
    [
        ("Scene", format!("{}: {objects}, {tables}{}", plain(&s.scene), assumed(s))),
        ("Path", format!("{}: {:.1} s, {frames} at {} Hz", plain(&s.path), s.path_duration_s, s.camera.fps)),
        ("Machine", format!("{}, seed {}: {}", s.machine, s.seed, model(&s.cost_model.actual))),
        ("Budget", format!("{} ms{origin}", significant(s.budget_ms, 4))),
    ]
}

/// What must be said wherever levels were assumed.
fn assumed(s: &Summary) -> String {
    match s.assume_levels {
        None => String::new(),
        Some(n) => {
            format!("; levels ASSUMED, up to {n}, for {} without levels", counted(s.assumed_tables, "table"))
        }
    }
}

/// What drawing takes.
pub fn model(model: &CostModel) -> String {
    let ns = |us: f64| significant(us * 1e3, 3);
    format!(
        "draw {} µs, vertex {} ns, triangle {} ns, pixel {} ns",
        significant(model.draw_us, 3),
        ns(model.vertex_us),
        ns(model.triangle_us),
        ns(model.pixel_us)
    )
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
    let names = columns.iter().map(|c| format!("{}\n{}", c.name, c.unit));
    let headings: Vec<String> = std::iter::once("policy".to_owned()).chain(names).collect();
    let row = |p: &PolicyRow| {
        let values = columns.iter().map(|c| (c.value)(summary, p));
        std::iter::once(p.policy.to_owned()).chain(values).collect()
    };
    let rows: Vec<Vec<String>> = summary.policies.iter().map(row).collect();
    text::table(&headings, &rows)
}

/// What to make of it, a sentence or two each.
pub fn notes(s: &Summary) -> Vec<String> {
    let mut notes = vec![budget_note(s)];
    if !s.path_breaks.is_empty() {
        notes.push(break_note(&s.path_breaks));
    }
    if let Some(scale) = s.policies.iter().find_map(|p| p.scale) {
        let scale = significant(f64::from(scale), 3);
        notes.push(format!("In hindsight, static multiplies every size by {scale}."));
    }
    if s.policies.iter().filter(|p| p.competes()).count() > 1 {
        notes.push(format!("Best in {}.", best_note(&s.policies)));
    }
    notes
}

/// In how many frames the budget cannot be met, and by how much.
fn budget_note(s: &Summary) -> String {
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
fn break_note(breaks: &[Break]) -> String {
    let widest = |kind, name, width: fn(&Break) -> f64, unit| {
        let found: Vec<&Break> = breaks.iter().filter(|b| b.kind == kind).collect();
        let widest = found.iter().map(|b| width(b)).fold(0.0, f64::max);
        let first_s = found.first()?.time_s;
        Some(format!(
            "{} (the first at {first_s:.1} s, the widest {widest:.1} {unit})",
            counted(found.len(), name)
        ))
    };
    let gaps = widest(BreakKind::Gap, "gap", |b| b.duration_s, "s");
    let jumps = widest(BreakKind::Jump, "jump", |b| b.distance, "units");
    let kinds: Vec<String> = gaps.into_iter().chain(jumps).collect();
    format!("The path has {}; the camera waits before each.", kinds.join(" and "))
}

/// What policies can be best in, and how it is scored: lower is better.
type Contest = (&'static str, fn(&PolicyRow) -> f64);

const CONTESTS: [Contest; 5] = [
    ("tracking", |p| p.metrics.tracking_over_budget),
    ("misses", |p| p.metrics.missed),
    ("longest frame", |p| p.metrics.max_over_budget),
    ("gain", |p| -p.metrics.gain_over_bound),
    ("switches", |p| p.metrics.switches_per_object_second),
];

/// Who was best in what, the ends of the scale left out.
fn best_note(policies: &[PolicyRow]) -> String {
    let best = |(name, score): Contest| {
        let competing = || policies.iter().filter(|p| p.competes());
        let least = competing().map(score).fold(f64::INFINITY, f64::min);
        let winners: Vec<&str> = competing().filter(|p| score(p) <= least).map(|p| p.policy).collect();
        format!("{name}: {}", winners.join(" and "))
    };
    CONTESTS.map(best).join("; ")
}
